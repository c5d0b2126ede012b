//! Refractive indices of transparent materials as functions of wavelength: Sellmeier's and Cauchy's formulas.
//!
//! Coefficients of built-in materials are in [`tables::glasses`](crate::tables::glasses); the indices of metals, which
//! have no such formula, in [`tables::metals`](crate::tables::metals). Wavelengths and indices are relative to vacuum or
//! air as in the source of the coefficients; the difference is below 3·10⁻⁴ in either.

use crate::Real;
use crate::tables::{Formula, GlassTable, find_glass};

/// The helium d line, at which n_d is stated, in nm.
pub const LINE_D: f64 = 587.5618;
/// The hydrogen F line in nm.
pub const LINE_F: f64 = 486.1327;
/// The hydrogen C line in nm.
pub const LINE_C: f64 = 656.2725;

/// Why the coefficients of a dispersion formula were refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum DispersionError {
    /// A coefficient is infinite or NaN.
    Coefficient {
        /// Which one, in the order of the constructor's arrays: B₁, C₁, B₂, … or A, B.
        index: usize,
    },
    /// The range of validity isn't two positive, finite, increasing wavelengths.
    Range,
    /// A resonance, λ² = Cᵢ, lies in the range of validity.
    Resonance {
        /// Which term, from 0.
        index: usize,
    },
    /// The formula may give an index that isn't positive and finite in the range of validity.
    Index,
}

impl core::fmt::Display for DispersionError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match *self {
            Self::Coefficient { index } => {
                write!(f, "dispersion coefficient {index} is not finite")
            }
            Self::Range => f.write_str("the range of validity is not two positive, increasing wavelengths"),
            Self::Resonance { index } => {
                write!(f, "the resonance of term {index} lies in the range of validity")
            }
            Self::Index => f.write_str("the index is not positive and finite over the range of validity"),
        }
    }
}

impl core::error::Error for DispersionError {}

/// A refractive index that depends on the wavelength.
pub trait Dispersion<R: Real> {
    /// The refractive index at a wavelength in nm; held outside [`valid`](Dispersion::valid), at the shortest
    /// wavelength for NaN.
    fn index(&self, wavelength: R) -> R;

    /// The derivative dn/dλ in nm⁻¹ at a wavelength in nm; 0 outside [`valid`](Dispersion::valid), where the index is
    /// held.
    fn derivative(&self, wavelength: R) -> R;

    /// The shortest and the longest wavelength in nm for which the coefficients are stated.
    fn valid(&self) -> [R; 2];

    /// The Abbe number V_d = (n_d − 1) / (n_F − n_C) from the lines at 587.5618, 486.1327 and 656.2725 nm.
    ///
    /// Infinite where there is no dispersion. The difference of indices costs digits: in `f32` about three.
    fn abbe_number(&self) -> R {
        let [d, f, c] = [LINE_D, LINE_F, LINE_C].map(|line| self.index(R::from_f64(line)));
        (d - R::ONE) / (f - c)
    }
}

/// Sellmeier's formula: n² = 1 + Σ Bᵢ λ² / (λ² − Cᵢ), λ in µm, of four terms.
///
/// Accuracy of the index: 8 EPSILON, relative, for the built-in materials over the visible range.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sellmeier<R> {
    /// Bᵢ and Cᵢ of each term.
    terms: [[R; 2]; 4],
    valid: [R; 2],
}

impl<R: Real> Sellmeier<R> {
    /// A material of the given terms [Bᵢ, Cᵢ], Cᵢ in µm², absent ones zero, valid between two wavelengths in nm.
    ///
    /// # Errors
    /// A coefficient isn't finite, the range isn't one, it contains a resonance, or the sum of the least values of the
    /// terms over it leaves n² possibly not positive.
    pub fn new(terms: [[R; 2]; 4], valid: [R; 2]) -> Result<Self, DispersionError> {
        if let Some(index) = terms.as_flattened().iter().position(|c| !c.is_finite()) {
            return Err(DispersionError::Coefficient { index });
        }
        check_range(valid)?;
        let [short, long] = valid.map(square_micrometres);
        let resonant = |[b, c]: [R; 2]| b != R::ZERO && c >= short && c <= long;
        if let Some(index) = terms.iter().position(|&term| resonant(term)) {
            return Err(DispersionError::Resonance { index });
        }
        // Away from its resonance a term is monotone: its least value is at an end.
        let least = |sum, &[b, c]: &[R; 2]| sum + ratio(b, c, short).min(ratio(b, c, long));
        let most = |sum, &[b, c]: &[R; 2]| sum + ratio(b, c, short).max(ratio(b, c, long));
        let (low, high) = (terms.iter().fold(R::ONE, least), terms.iter().fold(R::ONE, most));
        if low > R::ZERO && high.is_finite() { Ok(Self { terms, valid }) } else { Err(DispersionError::Index) }
    }
}

impl<R: Real> Dispersion<R> for Sellmeier<R> {
    fn index(&self, wavelength: R) -> R {
        let [short, long] = self.valid;
        let square = square_micrometres(wavelength.clamp(short, long));
        self.terms.iter().fold(R::ONE, |sum, &[b, c]| sum + ratio(b, c, square)).sqrt()
    }

    fn derivative(&self, wavelength: R) -> R {
        if outside(wavelength, self.valid) {
            return R::ZERO;
        }
        // n dn/dλ = − λ Σ B C / (λ² − C)², per µm.
        let square = square_micrometres(wavelength);
        let slope = self.terms.iter().fold(R::ZERO, |sum, &[b, c]| {
            let distance = square - c;
            if b == R::ZERO { sum } else { sum + b * c / (distance * distance) }
        });
        -(wavelength * R::from_f64(1e-6)) * slope / self.index(wavelength)
    }

    fn valid(&self) -> [R; 2] {
        self.valid
    }
}

/// Cauchy's formula of two terms: n = A + B / λ², λ in µm.
///
/// Accuracy of the index: 3 EPSILON, relative, for B ≥ 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cauchy<R> {
    a: R,
    b: R,
    valid: [R; 2],
}

impl<R: Real> Cauchy<R> {
    /// A material of the given coefficients, `b` in µm², valid between two wavelengths in nm.
    ///
    /// # Errors
    /// A coefficient isn't finite, the range isn't one, or the index at one of its ends isn't positive and finite.
    pub fn new(a: R, b: R, valid: [R; 2]) -> Result<Self, DispersionError> {
        if let Some(index) = [a, b].iter().position(|c| !c.is_finite()) {
            return Err(DispersionError::Coefficient { index });
        }
        check_range(valid)?;
        let material = Self { a, b, valid };
        let acceptable = |wavelength| {
            let index = material.index(wavelength);
            index > R::ZERO && index.is_finite()
        };
        if valid.into_iter().all(acceptable) { Ok(material) } else { Err(DispersionError::Index) }
    }
}

impl<R: Real> Dispersion<R> for Cauchy<R> {
    fn index(&self, wavelength: R) -> R {
        let [short, long] = self.valid;
        self.a + self.b / square_micrometres(wavelength.clamp(short, long))
    }

    fn derivative(&self, wavelength: R) -> R {
        if outside(wavelength, self.valid) {
            return R::ZERO;
        }
        -R::TWO * self.b / (square_micrometres(wavelength) * wavelength)
    }

    fn valid(&self) -> [R; 2] {
        self.valid
    }
}

/// A transparent material of either formula.
///
/// ```
/// use spectral_core::dispersion::{Dispersion, Glass};
/// use spectral_core::tables::glasses::N_BK7;
/// let glass = Glass::<f64>::from_table(&N_BK7);
/// assert!((glass.index(587.5618) - 1.5168).abs() <= 5e-6);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Glass<R> {
    /// By Sellmeier's formula.
    Sellmeier(Sellmeier<R>),
    /// By Cauchy's formula.
    Cauchy(Cauchy<R>),
}

impl<R: Real> Glass<R> {
    /// A built-in material.
    #[must_use]
    pub fn from_table(table: &GlassTable) -> Self {
        let coefficients = R::samples(&table.coefficients);
        let coefficient = |index: usize| coefficients.get(index).copied().unwrap_or(R::ZERO);
        let valid = table.valid.map(|end| R::from_f64(f64::from(end)));
        match table.formula {
            Formula::Sellmeier => {
                let term = |index| [coefficient(2 * index), coefficient(2 * index + 1)];
                Self::Sellmeier(Sellmeier { terms: core::array::from_fn(term), valid })
            }
            Formula::Cauchy => Self::Cauchy(Cauchy { a: coefficient(0), b: coefficient(1), valid }),
        }
    }

    /// The built-in material of the given name, such as `N-BK7`, `water-20C` or `437907`; see
    /// [`find_glass`].
    #[must_use]
    pub fn find(name: &str) -> Option<Self> {
        find_glass(name).map(Self::from_table)
    }
}

impl<R: Real> Dispersion<R> for Glass<R> {
    fn index(&self, wavelength: R) -> R {
        match self {
            Self::Sellmeier(glass) => glass.index(wavelength),
            Self::Cauchy(glass) => glass.index(wavelength),
        }
    }

    fn derivative(&self, wavelength: R) -> R {
        match self {
            Self::Sellmeier(glass) => glass.derivative(wavelength),
            Self::Cauchy(glass) => glass.derivative(wavelength),
        }
    }

    fn valid(&self) -> [R; 2] {
        match self {
            Self::Sellmeier(glass) => glass.valid(),
            Self::Cauchy(glass) => glass.valid(),
        }
    }
}

fn check_range<R: Real>([short, long]: [R; 2]) -> Result<(), DispersionError> {
    let increasing = short > R::ZERO && short < long && long.is_finite();
    if increasing { Ok(()) } else { Err(DispersionError::Range) }
}

fn outside<R: Real>(wavelength: R, [short, long]: [R; 2]) -> bool {
    wavelength < short || wavelength > long || wavelength.is_nan()
}

/// λ² in µm² of a wavelength in nm.
fn square_micrometres<R: Real>(nanometres: R) -> R {
    nanometres * nanometres * R::from_f64(1e-6)
}

/// One term of Sellmeier's sum; an absent one is zero whatever its C.
fn ratio<R: Real>(b: R, c: R, square: R) -> R {
    if b == R::ZERO { R::ZERO } else { b * square / (square - c) }
}
