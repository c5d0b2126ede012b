//! Schlick's model at surfaces.

use glam::DVec3;
use spectral_core::brdf::Schlick;
use spectral_core::fresnel;

use super::{Path, Worker, receiver};
use crate::direct::{Part, Receiver};
use crate::geometry::Hit;
use crate::spectral::{Factor, Radiance};

impl Worker<'_> {
    /// Schlick's model: S(u) = C + (1 − C) f becomes (1 − f) C + f, two products for each light.
    pub(super) fn schlick(
        &mut self,
        hit: &Hit,
        direction: DVec3,
        path: Path,
        reflectance: Factor,
        (model, roughness): (&Schlick<f64>, f64),
        radiance: &mut Radiance,
    ) {
        let scene = self.scene;
        let receiver = receiver(hit);
        let view = -direction;
        let (tangent, _) = receiver.normal.any_orthonormal_pair();
        let [_, glossy, specular] = model.weights();
        let least = if glossy > 0.0 { glossy_level(roughness) } else { 0 };
        let coloured = self.times(path, reflectance);
        for (number, light) in scene.lights.iter().enumerate() {
            let (mut coloured_share, mut white_share) = (0.0, 0.0);
            self.illuminate(number, &receiver, least, |part| {
                let (geometric, fresnel) = schlick_terms(model, &receiver, view, tangent, &part);
                coloured_share += part.irradiance * geometric * (1.0 - fresnel);
                white_share += part.irradiance * geometric * fresnel;
            });
            self.add(Path { weight: coloured.weight * coloured_share, ..coloured }, light.factor(), radiance);
            self.add(Path { weight: path.weight * white_share, ..path }, light.factor(), radiance);
        }
        self.indirect(hit, Path { weight: coloured.weight * (1.0 - specular), ..coloured }, radiance);
        if specular > 0.0 {
            let fresnel = fresnel::schlick_factor(view.dot(receiver.normal));
            let shares = [(Some(reflectance), specular * (1.0 - fresnel)), (None, specular * fresnel)];
            self.mirror(hit, direction, path, &shares, radiance);
        }
    }
}

/// A glossy surface looks at a light in at least 4 to this power parts: the narrower its lobe, the more.
fn glossy_level(roughness: f64) -> u32 {
    match roughness {
        r if r < 0.1 => 4,
        r if r < 0.3 => 3,
        r if r < 0.6 => 2,
        _ => 1,
    }
}

/// The geometric term and Fresnel factor of Schlick's model for one part of a light.
pub(super) fn schlick_terms(
    model: &Schlick<f64>,
    receiver: &Receiver,
    view: DVec3,
    tangent: DVec3,
    part: &Part,
) -> (f64, f64) {
    let half = (part.direction + view).normalize_or_zero();
    let across = half - receiver.normal * half.dot(receiver.normal);
    let v = view.dot(receiver.normal).clamp(0.0, 1.0);
    let v_light = part.direction.dot(receiver.normal).clamp(0.0, 1.0);
    let t = half.dot(receiver.normal).clamp(0.0, 1.0);
    let w = across.normalize_or(tangent).dot(tangent);
    let u = half.dot(part.direction).clamp(0.0, 1.0);
    (model.geometric(t, v, v_light, w), fresnel::schlick_factor(u))
}
