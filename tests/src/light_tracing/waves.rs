//! Wavelengths that particles carry, and the scene's spectra there.

use renderers::scene::{BsdfKind, ConductorFresnel, D65_NORMALISATION, Ior, Metal, Scene, SpectrumId, SpectrumKind};
use renderers::spectral::Y_INTEGRAL;
use spectral_core::dispersion::{Dispersion, Glass};
use spectral_core::spectrum::{Outside, Planck, RadiationConstant, Spectrum};
use spectral_core::tables::{self, metals, observers};

use super::TraceError;

/// Where pictures are integrated, in nm.
const VISIBLE: [u16; 2] = [380, 780];

/// Some wavelengths, and everything of a scene that depends on them.
#[derive(Clone, Debug)]
pub struct Waves<const W: usize> {
    /// In nm.
    wavelengths: [f64; W],
    /// For each spectrum of the scene, its values.
    spectra: Vec<[f64; W]>,
    /// For each material its index: of glass relative to its exterior, of metals n and k.
    indices: Vec<[[f64; W]; 2]>,
    /// For each wavelength, what a spectral radiance of 1 adds to X, Y and Z.
    observer: [[f64; 3]; W],
}

impl Waves<1> {
    /// One wavelength in nm; observers don't see it.
    ///
    /// # Errors
    /// [`TraceError::Spectrum`].
    pub fn single(scene: &Scene, wavelength: f64) -> Result<Self, TraceError> {
        Self::new(scene, [wavelength], [[0.0; 3]])
    }
}

impl<const W: usize> Waves<W> {
    fn new(scene: &Scene, wavelengths: [f64; W], observer: [[f64; 3]; W]) -> Result<Self, TraceError> {
        let spectra = (0..scene.spectra.len()).map(|id| try_map(&wavelengths, |w| value(scene, SpectrumId(id), w)));
        let spectra = spectra.collect::<Result<_, _>>()?;
        let of_bsdf = |bsdf: usize| {
            let pairs = try_map(&wavelengths, |w| index(scene, bsdf, w))?;
            Ok([pairs.map(|[n, _]| n), pairs.map(|[_, k]| k)])
        };
        let indices = (0..scene.bsdfs.len()).map(of_bsdf).collect::<Result<_, _>>()?;
        Ok(Self { wavelengths, spectra, indices, observer })
    }

    /// The wavelengths in nm.
    #[must_use]
    pub const fn wavelengths(&self) -> &[f64; W] {
        &self.wavelengths
    }

    pub(super) fn spectrum(&self, id: SpectrumId) -> &[f64; W] {
        &self.spectra[id.0]
    }

    pub(super) fn indices(&self, bsdf: usize) -> &[[f64; W]; 2] {
        &self.indices[bsdf]
    }

    pub(super) const fn observer(&self) -> &[[f64; 3]; W] {
        &self.observer
    }
}

/// The colour-matching functions of CIE 1931, linear between whole nanometres, and how wavelengths are chosen by them: with a density that is
/// constant over each nanometre, and x̄ + ȳ + z̄ on average there.
#[derive(Clone, Debug)]
pub(super) struct Chooser {
    /// For each nanometre, its share of all wavelengths and of those before it.
    sums: Vec<f64>,
}

impl Chooser {
    pub(super) fn new() -> Self {
        let mut sums = vec![0.0];
        for wavelength in VISIBLE[0]..VISIBLE[1] {
            let [from, to] = [wavelength, wavelength + 1].map(|w| sensitivity(w).iter().sum::<f64>());
            sums.push(sums.last().copied().unwrap_or(0.0) + f64::midpoint(from, to));
        }
        let total = sums.last().copied().unwrap_or(1.0);
        sums.iter_mut().for_each(|s| *s /= total);
        Self { sums }
    }

    /// `W` wavelengths, one from each part of equal share; `place` in [0, 1) says where in all of them.
    pub(super) fn waves<const W: usize>(&self, scene: &Scene, place: f64) -> Result<Waves<W>, TraceError> {
        #[allow(clippy::cast_precision_loss, reason = "a few wavelengths")]
        let chosen: [_; W] = core::array::from_fn(|k| self.choose((k as f64 + place) / W as f64));
        #[allow(clippy::cast_precision_loss, reason = "a few wavelengths")]
        let observer = chosen.map(|(wavelength, density)| {
            let scale = 1.0 / (density * W as f64 * Y_INTEGRAL);
            let whole = wavelength.floor();
            let [from, to] = [whole, whole + 1.0].map(|w| sensitivity(floor_u16(w)));
            let part = wavelength - whole;
            core::array::from_fn(|c| scale * (from[c] * (1.0 - part) + to[c] * part))
        });
        Waves::new(scene, chosen.map(|(wavelength, _)| wavelength), observer)
    }

    /// A wavelength and its density per nm.
    fn choose(&self, u: f64) -> (f64, f64) {
        let cell = self.sums.partition_point(|s| *s <= u).clamp(1, self.sums.len() - 1) - 1;
        let share = self.sums[cell + 1] - self.sums[cell];
        let within = ((u - self.sums[cell]) / share).clamp(0.0, 1.0);
        (f64::from(VISIBLE[0]) + super::count(cell) + within, share)
    }
}

#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "wavelengths")]
const fn floor_u16(x: f64) -> u16 {
    x as u16
}

/// x̄, ȳ, z̄ at a whole wavelength.
fn sensitivity(wavelength: u16) -> [f64; 3] {
    let table = &observers::CIE_1931_2;
    table.cmf(usize::from(wavelength.saturating_sub(table.first)))
}

fn try_map<T: Copy + Default, const W: usize>(
    wavelengths: &[f64; W],
    function: impl Fn(f64) -> Result<T, TraceError>,
) -> Result<[T; W], TraceError> {
    let mut values = [T::default(); W];
    for (value, wavelength) in values.iter_mut().zip(wavelengths) {
        *value = function(*wavelength)?;
    }
    Ok(values)
}

/// The value of a spectrum of the scene at a wavelength in nm.
fn value(scene: &Scene, id: SpectrumId, wavelength: f64) -> Result<f64, TraceError> {
    let data = scene.spectrum(id);
    let refuse = || TraceError::Spectrum(data.label.clone());
    Ok(match &data.kind {
        SpectrumKind::Constant(value) => *value,
        SpectrumKind::Table { wavelengths, values } => interpolated(wavelengths, values, wavelength),
        SpectrumKind::D65 { scale } => {
            let table: f64 = tables::illuminants::D65.spectrum(Outside::Zero).value(wavelength);
            scale * table / D65_NORMALISATION
        }
        SpectrumKind::Blackbody { temperature, scale, wavelength_min, wavelength_max } => {
            let planck = Planck::<f64>::new(*temperature, RadiationConstant::Si2019).map_err(|_| refuse())?;
            let shines = (*wavelength_min..=*wavelength_max).contains(&wavelength);
            if shines { scale * planck.radiance(wavelength) } else { 0.0 }
        }
        _ => return Err(refuse()),
    })
}

/// Linear between nodes, 0 outside.
fn interpolated(wavelengths: &[f64], values: &[f64], at: f64) -> f64 {
    let next = wavelengths.partition_point(|w| *w <= at);
    match (next.checked_sub(1).and_then(|i| Some((wavelengths.get(i)?, values.get(i)?))), wavelengths.get(next)) {
        (Some((from, first)), Some(to)) => first + (values[next] - first) * (at - from) / (to - from),
        (Some((last, value)), None) if *last == at => *value,
        _ => 0.0,
    }
}

/// The index of a material at a wavelength: glass relative to its exterior, and 0; metals n and k; nothing of others.
fn index(scene: &Scene, bsdf: usize, wavelength: f64) -> Result<[f64; 2], TraceError> {
    Ok(match &scene.bsdfs[bsdf].kind {
        BsdfKind::Dielectric { int_ior, ext_ior, .. } => {
            [refractive(scene, int_ior, wavelength)? / refractive(scene, ext_ior, wavelength)?, 0.0]
        }
        BsdfKind::Conductor { fresnel: ConductorFresnel::Metal(metal), .. } => {
            let table = match metal {
                Metal::Au => &metals::AU,
                Metal::Ag => &metals::AG,
                Metal::Cu => &metals::CU,
                Metal::Al => &metals::AL,
                other => return Err(TraceError::Spectrum(format!("{other:?}"))),
            };
            [table.n().value(wavelength), table.k().value(wavelength)]
        }
        BsdfKind::Conductor { fresnel: ConductorFresnel::Spectra { eta, k }, .. } => {
            [value(scene, *eta, wavelength)?, value(scene, *k, wavelength)?]
        }
        _ => [0.0; 2],
    })
}

fn refractive(scene: &Scene, ior: &Ior, wavelength: f64) -> Result<f64, TraceError> {
    match ior {
        Ior::Constant(value) => Ok(*value),
        Ior::Glass(name) => {
            let glass = Glass::<f64>::find(name).ok_or_else(|| TraceError::Spectrum(name.clone()))?;
            Ok(glass.index(wavelength))
        }
        Ior::Spectrum(id) => value(scene, *id, wavelength),
        other => Err(TraceError::Spectrum(format!("{other:?}"))),
    }
}
