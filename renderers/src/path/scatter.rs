//! How surfaces scatter light: values, directions chosen by importance, and their densities.

use core::f64::consts::{PI, TAU};

use glam::DVec3;
use spectral_core::schlick::{Schlick, schlick_fresnel};

use super::carrier::Term;
use crate::direct::Receiver;
use crate::geometry::sampling::square_to_cosine_hemisphere;
use crate::material::Material;
use crate::spectral::Factor;

/// A surface that scatters light into a solid angle.
#[derive(Clone, Copy, Debug)]
pub(super) struct Scatterer {
    normal: DVec3,
    geometric: DVec3,
    tangent: DVec3,
    bitangent: DVec3,
    /// Unit vector to the eye.
    view: DVec3,
    model: Model,
}

#[derive(Clone, Copy, Debug)]
enum Model {
    Diffuse,
    Schlick { model: Schlick<f64>, reflectance: Factor, roughness: f64, isotropy: f64 },
}

/// A sum of two factors with their shares.
pub(super) type Terms = [Term; 2];

/// Light that goes on in a chosen direction.
#[derive(Clone, Copy, Debug)]
pub(super) struct Scattered {
    /// Unit vector from the surface.
    pub(super) direction: DVec3,
    /// BRDF times cosine over density.
    pub(super) terms: Terms,
    /// Density per steradian; `None` for a mirror's one direction.
    pub(super) density: Option<f64>,
}

const NOTHING: Term = (None, 0.0);

impl Scatterer {
    /// What a material does where it was hit, seen along `view` (a unit vector to the eye), and the factor that all of its light is
    /// multiplied by besides; `None` for materials that send light in one or two directions only.
    pub(super) fn new(material: &Material, receiver: &Receiver, view: DVec3) -> Option<(Self, Option<Factor>)> {
        let (tangent, bitangent) = receiver.normal.any_orthonormal_pair();
        let (model, factor) = match material {
            Material::Diffuse(reflectance) => (Model::Diffuse, Some(*reflectance)),
            Material::Schlick { reflectance, roughness, isotropy } => {
                let (reflectance, roughness, isotropy) = (*reflectance, *roughness, *isotropy);
                let model = Schlick::new(roughness, isotropy)?;
                (Model::Schlick { model, reflectance, roughness, isotropy }, None)
            }
            Material::Mirror(_) | Material::Dielectric(_) | Material::TwoSided(_) => return None,
        };
        let Receiver { normal, geometric, .. } = *receiver;
        Some((Self { normal, geometric, tangent, bitangent, view, model }, factor))
    }

    /// BRDF times cosine for light from a direction (a unit vector to it), and the density per steradian with which [`sample`](Self::sample)
    /// chooses it.
    pub(super) fn evaluate(&self, direction: DVec3) -> Option<(Terms, f64)> {
        let cosine = direction.dot(self.normal);
        if !(cosine > 0.0 && direction.dot(self.geometric) > 0.0) {
            return None;
        }
        match self.model {
            Model::Diffuse => Some(([(None, cosine / PI), NOTHING], cosine / PI)),
            Model::Schlick { model, reflectance, roughness, isotropy } => {
                let half = (direction + self.view).try_normalize()?;
                let [t, u] = [self.normal, direction].map(|d| d.dot(half).clamp(0.0, 1.0));
                let v = self.view.dot(self.normal).clamp(0.0, 1.0);
                let w = (half - self.normal * half.dot(self.normal)).normalize_or(self.tangent).dot(self.tangent);
                let value = cosine * model.geometric(t, v, cosine.min(1.0), w);
                let fresnel = schlick_fresnel(u);
                let [diffuse, glossy, _] = model.weights();
                let lobe = if glossy > 0.0 { half_density(roughness, isotropy, t, w) / (4.0 * u) } else { 0.0 };
                let density = diffuse * cosine / PI + if lobe.is_finite() { glossy * lobe } else { 0.0 };
                let terms = [(Some(reflectance), value * (1.0 - fresnel)), (None, value * fresnel)];
                (density > 0.0).then_some((terms, density))
            }
        }
    }

    /// A direction that light comes from, chosen by importance: `lobe` in [0, 1) says by which part of the model. `None` where none comes from.
    pub(super) fn sample(&self, lobe: f64, u: [f32; 2]) -> Option<Scattered> {
        let direction = match self.model {
            Model::Diffuse => self.cosine(u),
            Model::Schlick { model, reflectance, roughness, isotropy } => {
                let [diffuse, glossy, specular] = model.weights();
                if lobe < glossy {
                    let half = self.to_world(square_to_half(roughness, isotropy, u));
                    half * (2.0 * half.dot(self.view)) - self.view
                } else if lobe < glossy + diffuse || specular <= 0.0 {
                    self.cosine(u)
                } else {
                    return Some(self.mirror(reflectance));
                }
            }
        };
        let direction = direction.try_normalize()?;
        let (terms, density) = self.evaluate(direction)?;
        let terms = terms.map(|(factor, share)| (factor, share / density));
        Some(Scattered { direction, terms, density: Some(density) })
    }

    fn cosine(&self, u: [f32; 2]) -> DVec3 {
        self.to_world(square_to_cosine_hemisphere(u).as_dvec3())
    }

    /// The ideal specular part of Schlick's model, which is chosen as often as its weight.
    fn mirror(&self, reflectance: Factor) -> Scattered {
        let cosine = self.view.dot(self.normal);
        let fresnel = schlick_fresnel(cosine);
        let terms = [(Some(reflectance), 1.0 - fresnel), (None, fresnel)];
        Scattered { direction: self.normal * (2.0 * cosine) - self.view, terms, density: None }
    }

    fn to_world(&self, local: DVec3) -> DVec3 {
        self.tangent * local.x + self.bitangent * local.y + self.normal * local.z
    }
}

/// A half vector around +z with the density [`half_density`]: t² = a / (r + (1 − r) a) as Schlick (1994) has it, and tan φ = tan ψ / p.
fn square_to_half(roughness: f64, isotropy: f64, u: [f32; 2]) -> DVec3 {
    let [a, b] = u.map(f64::from);
    // 1 − a is never 0, so that no direction is at the horizon for certain.
    let a = 1.0 - a;
    let t2 = (a / (roughness + (1.0 - roughness) * a)).clamp(0.0, 1.0);
    let (sin, cos) = (TAU * b).sin_cos();
    let azimuth = glam::DVec2::new(isotropy * cos, sin).normalize_or(glam::DVec2::X);
    let across = (1.0 - t2).sqrt();
    DVec3::new(across * azimuth.x, across * azimuth.y, t2.sqrt())
}

/// t Z(t) A(w)² / π: the density of half vectors per steradian.
fn half_density(roughness: f64, isotropy: f64, t: f64, w: f64) -> f64 {
    let (t2, w2, p2) = (t * t, w * w, isotropy * isotropy);
    let below = (1.0 - t2) + roughness * t2;
    let azimuth2 = isotropy / (p2 - p2 * w2 + w2);
    t * roughness / (below * below) * azimuth2 / PI
}
