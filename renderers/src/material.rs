//! Surfaces' materials, with their spectra as factors of rendering expressions.

use spectral_core::dispersion::{Dispersion, Glass};
use spectral_core::spectrum::Spectrum;
use spectral_core::tables;

use crate::scene::{BsdfId, BsdfKind, ConductorFresnel, Ior, Metal, Scene, SpectrumId};
use crate::spectral::{Factor, Palette, Role, Tabulated};
use crate::whitted::RenderError;

/// At how many angles of incidence a metal's reflectance is tabulated; linear in between, within 10⁻³ for metals in the visible.
const METAL_ANGLES: usize = 48;

/// What a surface does with light.
#[derive(Clone, Debug)]
pub(crate) enum Material {
    /// Lambertian.
    Diffuse(Factor),
    /// Schlick's model: spectral factor C, roughness, isotropy.
    Schlick { reflectance: Factor, roughness: f64, isotropy: f64 },
    /// A mirror: one factor for each angle of incidence, from grazing (cos θ = 0) to normal, at cos θ = (k/(n−1))².
    Mirror(Vec<Factor>),
    /// A smooth boundary of transparent media.
    Dielectric(Box<Dielectric>),
    /// One material for each side.
    TwoSided(Box<[Material; 2]>),
}

/// A smooth boundary of transparent media; the interior is behind the normal.
#[derive(Clone, Debug)]
pub(crate) struct Dielectric {
    interior: Index,
    exterior: Index,
    /// Factors on reflected and on refracted light.
    pub(crate) reflectance: Factor,
    pub(crate) transmittance: Factor,
    absorption: Option<Index>,
}

/// A number that may depend on the wavelength.
#[derive(Clone, Debug)]
enum Index {
    Constant(f64),
    Glass(Glass<f64>),
    Spectrum(Tabulated),
}

impl Index {
    fn new(scene: &Scene, ior: &Ior) -> Result<Self, RenderError> {
        Ok(match ior {
            Ior::Constant(value) => Self::Constant(*value),
            Ior::Glass(name) => Self::Glass(
                Glass::find(name).ok_or_else(|| RenderError::new(format!("there is no built-in glass {name:?}")))?,
            ),
            Ior::Spectrum(id) => Self::of_spectrum(scene, *id),
        })
    }

    fn of_spectrum(scene: &Scene, id: SpectrumId) -> Self {
        let mut palette = Palette::default();
        let factor = palette.factor(scene.spectrum(id), Role::Reflectance);
        match factor.leaf.and_then(|leaf| palette.leaves().get(leaf as usize)) {
            None => Self::Constant(factor.scale),
            Some((shape, _)) => Self::Spectrum(shape.scaled(factor.scale)),
        }
    }

    fn at(&self, wavelength: f64) -> f64 {
        match self {
            Self::Constant(value) => *value,
            Self::Glass(glass) => glass.index(wavelength),
            Self::Spectrum(table) => table.spectrum().map_or(0.0, |s| s.value(wavelength)),
        }
    }

    const fn is_constant(&self) -> bool {
        matches!(self, Self::Constant(_))
    }
}

impl Dielectric {
    /// Whether light behaves alike at all wavelengths, but for the constant factors.
    pub(crate) fn is_wavelength_free(&self) -> bool {
        self.interior.is_constant()
            && self.exterior.is_constant()
            && self.absorption.as_ref().is_none_or(Index::is_constant)
    }

    /// Whether light goes the same way at all wavelengths.
    pub(crate) fn has_constant_index(&self) -> bool {
        self.interior.is_constant() && self.exterior.is_constant()
    }

    /// Whether the interior absorbs the same at all wavelengths; `None` if it is clear.
    pub(crate) fn absorbs_evenly(&self) -> Option<bool> {
        self.absorption.as_ref().map(Index::is_constant)
    }

    /// Interior index relative to exterior at a wavelength in nm.
    pub(crate) fn relative_index(&self, wavelength: f64) -> f64 {
        self.interior.at(wavelength) / self.exterior.at(wavelength)
    }

    /// What remains of light after a way through the interior.
    pub(crate) fn remaining(&self, distance: f64, wavelength: f64) -> f64 {
        self.absorption.as_ref().map_or(1.0, |a| (-a.at(wavelength) * distance).exp())
    }
}

impl Material {
    pub(crate) fn new(scene: &Scene, id: BsdfId, palette: &mut Palette) -> Result<Self, RenderError> {
        let mut reflectance = |spectrum: SpectrumId| palette.factor(scene.spectrum(spectrum), Role::Reflectance);
        Ok(match &scene.bsdf(id).kind {
            BsdfKind::Diffuse { reflectance: spectrum } => Self::Diffuse(reflectance(*spectrum)),
            BsdfKind::Schlick { reflectance: spectrum, roughness, isotropy } => {
                Self::Schlick { reflectance: reflectance(*spectrum), roughness: *roughness, isotropy: *isotropy }
            }
            BsdfKind::Conductor { fresnel, specular_reflectance } => {
                let weight = reflectance(*specular_reflectance);
                mirror(scene, fresnel, weight, palette)
            }
            BsdfKind::Dielectric { int_ior, ext_ior, specular_reflectance, specular_transmittance, absorption } => {
                Self::Dielectric(Box::new(Dielectric {
                    interior: Index::new(scene, int_ior)?,
                    exterior: Index::new(scene, ext_ior)?,
                    reflectance: reflectance(*specular_reflectance),
                    transmittance: reflectance(*specular_transmittance),
                    absorption: absorption.map(|a| Index::of_spectrum(scene, a)),
                }))
            }
            BsdfKind::TwoSided { front, back } => {
                Self::TwoSided(Box::new([Self::new(scene, *front, palette)?, Self::new(scene, *back, palette)?]))
            }
        })
    }

    /// The material on the side that was hit; `None` where a one-sided one is black.
    pub(crate) fn side(&self, front: bool) -> Option<&Self> {
        match self {
            Self::TwoSided(sides) => Some(&sides[usize::from(!front)]),
            Self::Dielectric(_) => Some(self),
            _ => front.then_some(self),
        }
    }
}

/// A metal: its Fresnel reflectance times a factor, tabulated over the angle of incidence.
fn mirror(scene: &Scene, fresnel: &ConductorFresnel, weight: Factor, palette: &mut Palette) -> Material {
    let (n, k) = match fresnel {
        ConductorFresnel::Perfect => return Material::Mirror(vec![weight]),
        ConductorFresnel::Metal(metal) => {
            let table = match metal {
                Metal::Au => &tables::metals::AU,
                Metal::Ag => &tables::metals::AG,
                Metal::Cu => &tables::metals::CU,
                Metal::Al => &tables::metals::AL,
            };
            let (n, k) = (table.n::<f64>(), table.k::<f64>());
            (Tabulated::sampled(|w| n.value(w)), Tabulated::sampled(|w| k.value(w)))
        }
        ConductorFresnel::Spectra { eta, k } => {
            let sample = |id| {
                let index = Index::of_spectrum(scene, id);
                Tabulated::sampled(|w| index.at(w))
            };
            (sample(*eta), sample(*k))
        }
    };
    let shape = weight.leaf.and_then(|leaf| palette.leaves().get(leaf as usize)).map(|(s, _)| s.clone());
    let factors = (0..METAL_ANGLES).map(|angle| {
        let cosine = metal_cosine(angle);
        let values = n.values.iter().zip(&k.values).map(|(n, k)| conductor_reflectance(cosine, *n, *k)).collect();
        let metal = Tabulated { wavelengths: n.wavelengths.clone(), values };
        let reflectance = shape.as_ref().map_or(metal.clone(), |s| s.times(&metal));
        palette.leaf(reflectance, weight.scale, Role::Reflectance)
    });
    Material::Mirror(factors.collect())
}

#[allow(clippy::cast_precision_loss, reason = "angles are few")]
fn metal_cosine(angle: usize) -> f64 {
    let t = angle as f64 / (METAL_ANGLES - 1) as f64;
    t * t
}

/// The two neighbouring factors of a mirror at a cosine of incidence, with their weights.
#[allow(clippy::cast_sign_loss, clippy::cast_possible_truncation, reason = "a place in the table, floored")]
pub(crate) fn mirror_factors(factors: &[Factor], cosine: f64) -> [(Factor, f64); 2] {
    let none = Factor { scale: 0.0, leaf: None };
    if factors.len() < METAL_ANGLES {
        return [(factors.first().copied().unwrap_or(none), 1.0), (none, 0.0)];
    }
    let last = METAL_ANGLES - 2;
    let cell = ((cosine.clamp(0.0, 1.0).sqrt() * metal_last()) as usize).min(last);
    let (from, to) = (metal_cosine(cell), metal_cosine(cell + 1));
    let t = ((cosine - from) / (to - from)).clamp(0.0, 1.0);
    [(factors[cell], 1.0 - t), (factors[cell + 1], t)]
}

#[allow(clippy::cast_precision_loss, reason = "angles are few")]
const fn metal_last() -> f64 {
    (METAL_ANGLES - 1) as f64
}

/// Fresnel reflectance of a conductor with index n + i k in air for unpolarised light (Born and Wolf §14.2).
pub(crate) fn conductor_reflectance(cosine: f64, n: f64, k: f64) -> f64 {
    let (c2, s2) = (cosine * cosine, 1.0 - cosine * cosine);
    let t = n * n - k * k - s2;
    let a2_b2 = (t * t + 4.0 * n * n * k * k).sqrt();
    let a = ((a2_b2 + t) / 2.0).max(0.0).sqrt();
    let s = (a2_b2 + c2 - 2.0 * a * cosine) / (a2_b2 + c2 + 2.0 * a * cosine);
    let p = s * (c2 * a2_b2 + s2 * s2 - 2.0 * a * cosine * s2) / (c2 * a2_b2 + s2 * s2 + 2.0 * a * cosine * s2);
    (s + p) / 2.0
}

/// Fresnel reflectance of a dielectric boundary for unpolarised light, and the cosine of refraction; `None` for total
/// reflection. `eta` is the index behind the boundary relative to the one before it.
pub(crate) fn dielectric_fresnel(cosine: f64, eta: f64) -> Option<(f64, f64)> {
    let sine2 = (1.0 - cosine * cosine) / (eta * eta);
    if sine2 >= 1.0 {
        return None;
    }
    let refracted = (1.0 - sine2).sqrt();
    let s = (cosine - eta * refracted) / (cosine + eta * refracted);
    let p = (eta * cosine - refracted) / (eta * cosine + refracted);
    Some(((s * s + p * p) / 2.0, refracted))
}

#[cfg(test)]
mod tests {
    use super::{METAL_ANGLES, conductor_reflectance, dielectric_fresnel, metal_cosine};

    #[test]
    fn fresnel_meets_its_closed_forms() {
        // Normal incidence, grazing incidence, Brewster's angle for p (half of s remains), total reflection.
        let (r, c) = dielectric_fresnel(1.0, 1.5).unwrap();
        assert!((r - 0.04).abs() <= 1e-15 && (c - 1.0).abs() <= 1e-15);
        assert!((dielectric_fresnel(0.0, 1.5).unwrap().0 - 1.0).abs() <= 1e-15);
        let brewster = (1.0_f64 / (1.0 + 1.5 * 1.5)).sqrt();
        let s = (1.0_f64 - 2.25) / (1.0 + 2.25);
        assert!((dielectric_fresnel(brewster, 1.5).unwrap().0 - s * s / 2.0).abs() <= 1e-15);
        assert!(dielectric_fresnel(0.5, 1.0 / 1.5).is_none());
        // A conductor at normal incidence, and as a dielectric where k = 0.
        let normal = ((0.2_f64 - 1.0).powi(2) + 9.0) / ((0.2_f64 + 1.0).powi(2) + 9.0);
        assert!((conductor_reflectance(1.0, 0.2, 3.0) - normal).abs() <= 1e-15);
        assert!((conductor_reflectance(0.3, 1.5, 0.0) - dielectric_fresnel(0.3, 1.5).unwrap().0).abs() <= 1e-14);
    }

    #[test]
    fn a_metals_reflectance_is_nearly_linear_between_its_angles() {
        // Gold and aluminium at the ends of the visible range.
        for (n, k) in [(1.66, 1.94), (0.14, 4.5), (0.44, 4.6), (2.8, 8.5)] {
            for angle in 0..METAL_ANGLES - 1 {
                let (from, to) = (metal_cosine(angle), metal_cosine(angle + 1));
                for step in 1..10 {
                    let t = f64::from(step) / 10.0;
                    let exact = conductor_reflectance(from + (to - from) * t, n, k);
                    let linear = conductor_reflectance(from, n, k) * (1.0 - t) + conductor_reflectance(to, n, k) * t;
                    assert!((exact - linear).abs() <= 1e-3, "{n} {k} {from}: {exact} {linear}");
                }
            }
        }
    }
}
