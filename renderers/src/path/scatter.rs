//! How surfaces scatter light: values, directions chosen by importance, and their densities.

use core::f64::consts::PI;

use glam::DVec3;
use spectral_core::brdf::{Brdf, Schlick};
use spectral_core::fresnel;

use super::carrier::Term;
use crate::direct::Receiver;
use crate::frame::Frame;
use crate::geometry::sampling::square_to_cosine_hemisphere;
use crate::material::{Glossy, Lobe, Material};
use crate::spectral::Factor;

/// How often a lobe over a Lambertian base is chosen.
const GLOSSY_SHARE: f64 = 0.5;

/// A surface that scatters light into a solid angle.
#[derive(Clone, Copy, Debug)]
pub(super) struct Scatterer<'m> {
    frame: Frame,
    normal: DVec3,
    geometric: DVec3,
    /// Unit vector to the eye, and the same in the frame.
    view: DVec3,
    local_view: [f64; 3],
    model: Model<'m>,
}

#[derive(Clone, Copy, Debug)]
enum Model<'m> {
    Diffuse,
    Schlick {
        model: Schlick<f64>,
        reflectance: Factor,
    },
    /// A lobe over a Lambertian base, if there is one.
    Layered {
        base: Option<Factor>,
        lobe: Glossy<'m>,
        specular: Factor,
    },
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

impl<'m> Scatterer<'m> {
    /// What a material does where it was hit, seen along `view` (a unit vector to the eye), and the factor that all of its light is
    /// multiplied by besides; `None` for materials that send light in one or two directions only, and for black ones. `frame` has the
    /// surface's axes, where the material needs them.
    pub(super) fn new(
        material: &'m Material,
        receiver: &Receiver,
        frame: Option<Frame>,
        view: DVec3,
    ) -> Option<(Self, Option<Factor>)> {
        let Receiver { normal, geometric, .. } = *receiver;
        let (model, factor) = match (material, material.lobes()) {
            (Material::Schlick { reflectance, roughness, isotropy }, _) => {
                let model = Schlick::new(*roughness, *isotropy).ok()?;
                (Model::Schlick { model, reflectance: *reflectance }, None)
            }
            (_, [Some((factor, Lobe::Lambert)), None]) => (Model::Diffuse, Some(factor)),
            (_, [base, Some((specular, Lobe::Glossy(lobe)))]) => {
                (Model::Layered { base: base.map(|(factor, _)| factor), lobe, specular }, None)
            }
            _ => return None,
        };
        let frame = frame.unwrap_or_else(|| Frame::new(normal, normal.any_orthonormal_pair().0));
        Some((Self { frame, normal, geometric, view, local_view: frame.to_local(view), model }, factor))
    }

    /// BRDF times cosine for light from a direction (a unit vector to it), and the density per steradian with which [`sample`](Self::sample)
    /// chooses it.
    pub(super) fn evaluate(&self, direction: DVec3) -> Option<(Terms, f64)> {
        let cosine = direction.dot(self.normal);
        if !(cosine > 0.0 && direction.dot(self.geometric) > 0.0) {
            return None;
        }
        let light = || self.frame.to_local(direction);
        let (terms, density) = match self.model {
            Model::Diffuse => ([(None, cosine / PI), NOTHING], cosine / PI),
            Model::Schlick { model, reflectance } => {
                let [_, _, specular] = model.weights();
                let (light, view) = (light(), self.local_view);
                let value = cosine * model.evaluate(light, view);
                let half = (direction + self.view).try_normalize()?;
                let white = fresnel::schlick_factor(direction.dot(half).clamp(0.0, 1.0));
                let terms = [(Some(reflectance), value * (1.0 - white)), (None, value * white)];
                (terms, (1.0 - specular) * model.pdf(light, view))
            }
            Model::Layered { base, lobe, specular } => {
                let (light, view) = (light(), self.local_view);
                let share = glossy_share(base);
                let diffuse = base.map_or(NOTHING, |factor| (Some(factor), cosine / PI));
                let density = share * lobe.pdf(light, view) + (1.0 - share) * cosine / PI;
                ([(Some(specular), cosine * lobe.evaluate(light, view)), diffuse], density)
            }
        };
        (density > 0.0 && density.is_finite()).then_some((terms, density))
    }

    /// A direction that light comes from, chosen by importance: `lobe` in [0, 1) says by which part of the model. `None` where none comes from.
    pub(super) fn sample(&self, lobe: f64, u: [f32; 2]) -> Option<Scattered> {
        let direction = match self.model {
            Model::Diffuse => self.cosine(u),
            Model::Schlick { model, reflectance } => {
                let [_, _, specular] = model.weights();
                if lobe < specular {
                    return Some(self.mirror(reflectance));
                }
                let rest = (lobe - specular) / (1.0 - specular);
                self.frame.to_world(model.sample(self.local_view, three(u, rest))?.direction)
            }
            Model::Layered { base, lobe: glossy, .. } => {
                let share = glossy_share(base);
                if lobe < share {
                    self.frame.to_world(glossy.sample(self.local_view, three(u, lobe / share))?.direction)
                } else {
                    self.cosine(u)
                }
            }
        };
        let direction = direction.try_normalize()?;
        let (terms, density) = self.evaluate(direction)?;
        let terms = terms.map(|(factor, share)| (factor, share / density));
        Some(Scattered { direction, terms, density: Some(density) })
    }

    fn cosine(&self, u: [f32; 2]) -> DVec3 {
        self.frame.to_world(square_to_cosine_hemisphere(u).as_dvec3().to_array())
    }

    /// The ideal specular part of Schlick's model, which is chosen as often as its weight.
    fn mirror(&self, reflectance: Factor) -> Scattered {
        let cosine = self.view.dot(self.normal);
        let white = fresnel::schlick_factor(cosine);
        let terms = [(Some(reflectance), 1.0 - white), (None, white)];
        Scattered { direction: self.normal * (2.0 * cosine) - self.view, terms, density: None }
    }
}

const fn glossy_share(base: Option<Factor>) -> f64 {
    if base.is_some() { GLOSSY_SHARE } else { 1.0 }
}

fn three([a, b]: [f32; 2], c: f64) -> [f64; 3] {
    [f64::from(a), f64::from(b), c]
}
