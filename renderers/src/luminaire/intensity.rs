//! Candela in C-planes × γ, interpolated bilinearly, and the flux of the interpolant in closed form.

use core::f64::consts::{FRAC_PI_2, PI, TAU};
use core::fmt;

pub(super) const PLANES: &str = "C-planes: 0 alone, 0 to 90, 0 to 180, 90 to 270 or 0 to 360";
pub(super) const GAMMAS: &str = "γ: 0 to 90, 90 to 180 or 0 to 180";

/// Luminous intensity in cd as a function of direction: C and γ as the [module](super) defines them.
///
/// Tables are interpolated bilinearly in C and γ; where γ is outside the table (a table of 0 to 90° has no upper half)
/// the intensity is 0. All intensities are finite and not negative, and so is the flux.
#[derive(Clone, Debug, PartialEq)]
pub struct LuminousIntensity(Form);

#[derive(Clone, Debug, PartialEq)]
enum Form {
    /// The same in every direction.
    Isotropic(f64),
    /// I cos γ in the lower half.
    Lambertian(f64),
    Table(Table),
}

#[derive(Clone, Debug, PartialEq)]
struct Table {
    symmetry: Symmetry,
    planes: Vec<f64>,
    gammas: Vec<f64>,
    /// Plane by plane.
    candela: Vec<f64>,
}

/// What a table's C-planes say of those it leaves out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Symmetry {
    /// One plane, C0: the same in all.
    Axial,
    /// Planes 0 to 90: mirrored by C0–C180 and C90–C270.
    Quadrant,
    /// Planes 0 to 180: mirrored by C0–C180.
    AboutC0,
    /// Planes 90 to 270: mirrored by C90–C270.
    AboutC90,
    /// Planes 0 to 360.
    None,
}

/// A value of a table, by index.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    /// Angle of a C-plane.
    Plane(usize),
    /// Angle γ.
    Gamma(usize),
    /// Intensity: of the plane, at γ.
    Candela(usize, usize),
}

/// Why numbers are no luminous intensity distribution.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum IntensityError {
    /// There must be one intensity for each plane and γ.
    Counts {
        /// Planes times angles γ.
        expected: usize,
        /// How many intensities there are.
        found: usize,
    },
    /// NaN or infinity; for single values without a table the place is `Candela(0, 0)`.
    NotFinite {
        /// Where.
        place: Place,
        /// The value.
        value: f64,
    },
    /// A negative intensity or flux.
    Negative {
        /// Where.
        place: Place,
        /// The value.
        value: f64,
    },
    /// Angles must increase.
    NotIncreasing {
        /// Where.
        place: Place,
        /// The angle, degrees.
        value: f64,
        /// The angle before it.
        before: f64,
    },
    /// The planes are of no [`Symmetry`].
    PlaneRange {
        /// First plane, degrees; NaN if there is none.
        first: f64,
        /// Last plane, degrees.
        last: f64,
    },
    /// γ goes neither from 0 to 90, nor from 90 to 180, nor from 0 to 180.
    GammaRange {
        /// First angle, degrees; NaN if there is none.
        first: f64,
        /// Last angle, degrees.
        last: f64,
    },
    /// The total flux leaves the range of numbers, or is zero where it must not.
    Flux,
}

impl fmt::Display for IntensityError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Counts { expected, found } => write!(f, "{found} intensities where {expected} are needed"),
            Self::NotFinite { value, .. } => write!(f, "{value} is not finite"),
            Self::Negative { value, .. } => write!(f, "negative intensity {value}"),
            Self::NotIncreasing { value, before, .. } => {
                write!(f, "{value} is not above {before}, the angle before it")
            }
            Self::PlaneRange { first, last } => write!(f, "{first} to {last} is no range of planes ({PLANES})"),
            Self::GammaRange { first, last } => write!(f, "{first} to {last} is no range of angles ({GAMMAS})"),
            Self::Flux => f.write_str("the luminous flux is zero or leaves the range of numbers"),
        }
    }
}

impl core::error::Error for IntensityError {}

impl LuminousIntensity {
    /// The same intensity `candela` in every direction: an idealised point source of flux 4π I.
    ///
    /// # Errors
    /// If it is negative or its flux is not finite.
    pub fn isotropic(candela: f64) -> Result<Self, IntensityError> {
        check_candela(Place::Candela(0, 0), candela)?;
        Self::checked(Form::Isotropic(candela))
    }

    /// I(γ) = I₀ cos γ below the horizontal and 0 above, with I₀ = `candela`: an idealised small flat source that faces
    /// down, of flux π I₀.
    ///
    /// # Errors
    /// If it is negative or its flux is not finite.
    pub fn lambertian(candela: f64) -> Result<Self, IntensityError> {
        check_candela(Place::Candela(0, 0), candela)?;
        Self::checked(Form::Lambertian(candela))
    }

    /// A table: `planes` (C) and `gammas` in degrees, increasing, and `candela` plane by plane.
    ///
    /// The planes are one of the ranges of [`Symmetry`], γ goes from 0 or 90 to 90 or 180. Of planes 0 to 360, the last one
    /// is approached from below but C = 360 itself is read as C = 0.
    ///
    /// # Errors
    /// Whatever breaks these rules, negative and non-finite values, and a flux that is not finite.
    pub fn table(planes: Vec<f64>, gammas: Vec<f64>, candela: Vec<f64>) -> Result<Self, IntensityError> {
        check_increasing(&planes, Place::Plane)?;
        check_increasing(&gammas, Place::Gamma)?;
        let ends = |angles: &[f64]| (angles.first().copied(), angles.last().copied());
        let number = |end: Option<f64>| end.unwrap_or(f64::NAN);
        let (first, last) = ends(&planes);
        let symmetry = Symmetry::of(&planes);
        let symmetry = symmetry.ok_or(IntensityError::PlaneRange { first: number(first), last: number(last) })?;
        let (first, last) = ends(&gammas);
        if !matches!((first, last), (Some(0.0), Some(90.0 | 180.0)) | (Some(90.0), Some(180.0))) {
            return Err(IntensityError::GammaRange { first: number(first), last: number(last) });
        }
        let expected = planes.len().saturating_mul(gammas.len());
        if candela.len() != expected {
            return Err(IntensityError::Counts { expected, found: candela.len() });
        }
        for (index, value) in candela.iter().enumerate() {
            check_candela(Place::Candela(index / gammas.len(), index % gammas.len()), *value)?;
        }
        Self::checked(Form::Table(Table { symmetry, planes, gammas, candela }))
    }

    fn checked(form: Form) -> Result<Self, IntensityError> {
        let result = Self(form);
        if result.flux().is_finite() { Ok(result) } else { Err(IntensityError::Flux) }
    }

    /// How the C-planes repeat.
    #[must_use]
    pub const fn symmetry(&self) -> Symmetry {
        match &self.0 {
            Form::Table(table) => table.symmetry,
            _ => Symmetry::Axial,
        }
    }

    /// The table's C-planes in degrees, angles γ in degrees, and candela plane by plane; `None` for the idealised sources.
    #[must_use]
    pub fn as_table(&self) -> Option<(&[f64], &[f64], &[f64])> {
        match &self.0 {
            Form::Table(table) => Some((&table.planes, &table.gammas, &table.candela)),
            _ => None,
        }
    }

    /// Intensity in cd at C and γ in degrees. C may be any finite angle; γ outside the table gives 0, and NaN or
    /// infinity gives NaN.
    #[must_use]
    pub fn candela(&self, c: f64, gamma: f64) -> f64 {
        if !(c.is_finite() && gamma.is_finite()) {
            return f64::NAN;
        }
        match &self.0 {
            Form::Isotropic(candela) if (0.0..=180.0).contains(&gamma) => *candela,
            Form::Lambertian(candela) if (0.0..=90.0).contains(&gamma) => candela * gamma.to_radians().cos().max(0.0),
            Form::Table(table) => table.candela(c, gamma),
            _ => 0.0,
        }
    }

    /// Intensity in cd along a direction in the luminaire's frame, of any length; NaN or infinity in it gives NaN, and the
    /// zero vector stands for straight up.
    #[must_use]
    pub fn candela_towards(&self, [x, y, z]: [f64; 3]) -> f64 {
        let c = y.atan2(x).to_degrees();
        // Two arguments keep the digits near the vertical that an arc cosine would lose.
        self.candela(c, x.hypot(y).atan2(-z).to_degrees())
    }

    /// Total luminous flux in lm: ∫ I dω, exact for the interpolant but for rounding (some 10⁻¹⁴, relative).
    #[must_use]
    pub fn flux(&self) -> f64 {
        self.zonal_flux(0.0, 180.0)
    }

    /// Luminous flux in lm between two angles γ in degrees, clamped to 0 to 180; 0 if they don't increase. Exact as
    /// [`flux`](Self::flux) is.
    #[must_use]
    pub fn zonal_flux(&self, from: f64, to: f64) -> f64 {
        let (low, high) = (from.max(0.0), to.min(180.0));
        if !(low < high) {
            return 0.0;
        }
        match &self.0 {
            Form::Isotropic(candela) => {
                let (middle, half) = middle_and_half(low, high);
                4.0 * PI * candela * middle.sin() * half.sin()
            }
            Form::Lambertian(candela) => {
                let (a, b) = (low.to_radians().min(FRAC_PI_2), high.to_radians().min(FRAC_PI_2));
                // sin² b − sin² a
                PI * candela * (b - a).sin() * (b + a).sin()
            }
            Form::Table(table) => table.zonal_flux(low, high),
        }
    }

    /// The greatest intensity in cd.
    #[must_use]
    pub fn peak(&self) -> f64 {
        match &self.0 {
            Form::Isotropic(candela) | Form::Lambertian(candela) => *candela,
            Form::Table(table) => table.candela.iter().copied().fold(0.0, f64::max),
        }
    }

    /// The distribution times `factor`.
    ///
    /// # Errors
    /// If the factor is negative or not finite, or the flux leaves the range of numbers.
    pub fn scaled(&self, factor: f64) -> Result<Self, IntensityError> {
        check_candela(Place::Candela(0, 0), factor)?;
        Self::checked(match &self.0 {
            Form::Isotropic(candela) => Form::Isotropic(candela * factor),
            Form::Lambertian(candela) => Form::Lambertian(candela * factor),
            Form::Table(table) => {
                Form::Table(Table { candela: table.candela.iter().map(|v| v * factor).collect(), ..table.clone() })
            }
        })
    }

    /// The distribution scaled so that its flux is `lumen`.
    ///
    /// # Errors
    /// If that is negative or not finite, or if the distribution has no flux, or too small or large a one.
    pub fn with_flux(&self, lumen: f64) -> Result<Self, IntensityError> {
        check_candela(Place::Candela(0, 0), lumen)?;
        let factor = lumen / self.flux();
        if !factor.is_finite() {
            return Err(IntensityError::Flux);
        }
        let result = self.scaled(factor)?;
        let error = (result.flux() - lumen).abs();
        if error <= 1e-9 * lumen { Ok(result) } else { Err(IntensityError::Flux) }
    }

    /// The same function as a table of planes 0 to 360, for those who know no symmetry; idealised sources get one value each
    /// degree, so that a Lambertian one is within 4·10⁻⁵ of its peak.
    #[must_use]
    pub fn expanded(&self) -> Self {
        let table = self.tabulated();
        let Form::Table(table) = &table.0 else { return table };
        if table.symmetry == Symmetry::None {
            return self.clone();
        }
        let planes = table.expanded_planes();
        let candela = planes.iter().flat_map(|c| table.gammas.iter().map(|g| table.candela(*c, *g))).collect();
        Self(Form::Table(Table { symmetry: Symmetry::None, planes, gammas: table.gammas.clone(), candela }))
    }

    /// This as a table: itself if it is one; idealised sources get one plane with a value each degree.
    #[must_use]
    pub fn tabulated(&self) -> Self {
        let last = match &self.0 {
            Form::Table(_) => return self.clone(),
            Form::Isotropic(_) => 180,
            Form::Lambertian(_) => 90,
        };
        let gammas: Vec<f64> = (0..=last).map(f64::from).collect();
        let candela = gammas.iter().map(|gamma| self.candela(0.0, *gamma)).collect();
        Self(Form::Table(Table { symmetry: Symmetry::Axial, planes: vec![0.0], gammas, candela }))
    }
}

fn check_candela(place: Place, value: f64) -> Result<(), IntensityError> {
    if !value.is_finite() {
        Err(IntensityError::NotFinite { place, value })
    } else if value < 0.0 {
        Err(IntensityError::Negative { place, value })
    } else {
        Ok(())
    }
}

fn check_increasing(angles: &[f64], place: fn(usize) -> Place) -> Result<(), IntensityError> {
    for (index, &value) in angles.iter().enumerate() {
        if !value.is_finite() {
            return Err(IntensityError::NotFinite { place: place(index), value });
        }
        if let Some(&before) = index.checked_sub(1).and_then(|i| angles.get(i))
            && value <= before
        {
            return Err(IntensityError::NotIncreasing { place: place(index), value, before });
        }
    }
    Ok(())
}

impl Symmetry {
    /// The symmetry that planes stand for, by the first and the last.
    fn of(planes: &[f64]) -> Option<Self> {
        match (*planes.first()?, *planes.last()?) {
            (0.0, 0.0) => Some(Self::Axial),
            (0.0, 90.0) => Some(Self::Quadrant),
            (0.0, 180.0) => Some(Self::AboutC0),
            (90.0, 270.0) => Some(Self::AboutC90),
            (0.0, 360.0) => Some(Self::None),
            _ => None,
        }
    }

    /// The plane in the table that stands for plane `c`.
    fn fold(self, c: f64) -> f64 {
        // A tiny negative angle is rounded up to a whole turn.
        let c = if c.rem_euclid(360.0) < 360.0 { c.rem_euclid(360.0) } else { 0.0 };
        match self {
            Self::Axial => 0.0,
            Self::None => c,
            Self::AboutC0 => c.min(360.0 - c),
            Self::Quadrant => {
                let half = c.min(360.0 - c);
                half.min(180.0 - half)
            }
            Self::AboutC90 if c < 90.0 => 180.0 - c,
            Self::AboutC90 if c > 270.0 => 540.0 - c,
            Self::AboutC90 => c,
        }
    }

    /// How often the planes of the table go round.
    const fn copies(self) -> f64 {
        match self {
            Self::Axial | Self::None => 1.0,
            Self::AboutC0 | Self::AboutC90 => 2.0,
            Self::Quadrant => 4.0,
        }
    }
}

impl Table {
    fn candela(&self, c: f64, gamma: f64) -> f64 {
        let Some((row, t)) = locate(&self.gammas, gamma) else { return 0.0 };
        let Some((plane, s)) = locate(&self.planes, self.symmetry.fold(c)) else { return 0.0 };
        let along = |plane: usize| {
            let values = self.plane(plane);
            mix(values[row], values[(row + 1).min(values.len() - 1)], t)
        };
        if s == 0.0 { along(plane) } else { mix(along(plane), along(plane + 1), s) }
    }

    fn plane(&self, plane: usize) -> &[f64] {
        let rows = self.gammas.len();
        &self.candela[plane * rows..(plane + 1) * rows]
    }

    fn zonal_flux(&self, low: f64, high: f64) -> f64 {
        let per_angle: Vec<f64> = (0..self.planes.len()).map(|plane| self.plane_flux(plane, low, high)).collect();
        if let [only] = per_angle[..] {
            return TAU * only;
        }
        let pairs = per_angle.windows(2).zip(self.planes.windows(2));
        let sum: f64 = pairs.map(|(f, c)| (f[0] + f[1]) / 2.0 * (c[1] - c[0]).to_radians()).sum();
        self.symmetry.copies() * sum
    }

    /// ∫ I sin γ dγ of one plane over part of its angles.
    fn plane_flux(&self, plane: usize, low: f64, high: f64) -> f64 {
        let cells = self.gammas.windows(2).zip(self.plane(plane).windows(2));
        cells
            .map(|(gamma, candela)| {
                let (from, to) = (gamma[0].max(low), gamma[1].min(high));
                if from >= to {
                    return 0.0;
                }
                let at = |g: f64| mix(candela[0], candela[1], (g - gamma[0]) / (gamma[1] - gamma[0]));
                linear_times_sine([at(from), at(to)], from, to)
            })
            .sum()
    }

    fn expanded_planes(&self) -> Vec<f64> {
        let (mirrors, turned): (&[f64], &[f64]) = match self.symmetry {
            Symmetry::Axial => return vec![0.0, 360.0],
            Symmetry::None => (&[], &[]),
            Symmetry::AboutC0 => (&[360.0], &[]),
            Symmetry::AboutC90 => (&[180.0, 540.0], &[]),
            Symmetry::Quadrant => (&[180.0, 360.0], &[180.0]),
        };
        // C0 need not be a node of planes 90 to 270.
        let mut all = vec![0.0, 360.0];
        all.extend(&self.planes);
        all.extend(mirrors.iter().flat_map(|m| self.planes.iter().map(move |c| m - c)));
        all.extend(turned.iter().flat_map(|t| self.planes.iter().map(move |c| t + c)));
        all.retain(|c| (0.0..=360.0).contains(c));
        all.sort_by(f64::total_cmp);
        all.dedup();
        all
    }
}

/// The cell that an angle is in and the fraction of it that is passed; the last node is the start of a cell of its own.
fn locate(angles: &[f64], angle: f64) -> Option<(usize, f64)> {
    let index = angles.partition_point(|a| *a <= angle).checked_sub(1)?;
    match angles.get(index + 1) {
        Some(next) => Some((index, (angle - angles[index]) / (next - angles[index]))),
        None => (angle == angles[index]).then_some((index, 0.0)),
    }
}

/// Linear interpolation, exact at both ends.
fn mix(a: f64, b: f64, t: f64) -> f64 {
    a * (1.0 - t) + b * t
}

/// Middle and half width of an interval in degrees, in radians.
fn middle_and_half(from: f64, to: f64) -> (f64, f64) {
    ((from + to).to_radians() / 2.0, (to - from).to_radians() / 2.0)
}

/// ∫ I sin γ dγ for I linear from `ends[0]` to `ends[1]` between two angles in degrees.
///
/// With middle m and half width t: (I₀ + I₁) sin m sin t + (I₁ − I₀) cos m (sin t / t − cos t).
fn linear_times_sine(ends: [f64; 2], from: f64, to: f64) -> f64 {
    let (middle, half) = middle_and_half(from, to);
    (ends[0] + ends[1]) * middle.sin() * half.sin() + (ends[1] - ends[0]) * middle.cos() * sinc_less_cosine(half)
}

/// sin t / t − cos t without cancellation: Σ (−1)^(k+1) 2k t^(2k) / (2k + 1)! for small t.
fn sinc_less_cosine(t: f64) -> f64 {
    if t.abs() >= 0.25 {
        return t.sin() / t - t.cos();
    }
    let s = t * t;
    s * (1.0 / 3.0 + s * (-1.0 / 30.0 + s * (1.0 / 840.0 + s * (-1.0 / 45_360.0 + s / 3_991_680.0))))
}
