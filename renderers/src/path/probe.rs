//! The samplers by themselves, for tests: what a place on a surface chooses, and with which density.

use glam::DVec3;

use super::PathTracer;
use super::light::End;
use super::scatter::Scatterer;
use crate::direct::{Receiver, single};
use crate::geometry::Ray;

/// A place on a surface of a scene, as paths meet it.
#[derive(Clone, Copy, Debug)]
pub struct Probe<'s> {
    tracer: &'s PathTracer,
    receiver: Receiver,
    scatterer: Option<Scatterer<'s>>,
}

/// A direction that a sampler chose.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sampled {
    /// Unit vector from the surface.
    pub direction: DVec3,
    /// Density per steradian, as the sampler states it; `None` for directions that couldn't be otherwise.
    pub density: Option<f64>,
    /// What it counts for: for lights radiance over density and 0 where something is in the way, for materials the sum of the terms of BRDF
    /// times cosine over density.
    pub weight: f64,
}

impl PathTracer {
    /// The place where a ray from `origin` along `direction` meets a surface that scatters, seen along it; `None` if it meets none.
    #[must_use]
    pub fn probe(&self, origin: DVec3, direction: DVec3) -> Option<Probe<'_>> {
        let direction = direction.try_normalize()?;
        let hit = self.world.closest_hit(&Ray::new(single(origin), single(direction)))?;
        let surface = self.surfaces.get(hit.shape as usize)?;
        let receiver = crate::whitted::receiver(&hit);
        let material = surface.material.side(hit.front)?;
        let scatterer =
            Scatterer::new(material, &receiver, surface.frame(&hit), -direction).map(|(scatterer, _)| scatterer);
        Some(Probe { tracer: self, receiver, scatterer })
    }
}

impl Probe<'_> {
    /// The unit shading normal on the side that was seen.
    #[must_use]
    pub const fn normal(&self) -> DVec3 {
        self.receiver.normal
    }

    /// A direction to a light: `choice` in [0, 1) says to which, `u` in [0, 1)² where to.
    #[must_use]
    pub fn sample_light(&self, choice: f64, u: [f32; 2]) -> Option<Sampled> {
        let towards = self.tracer.lights.towards(&self.receiver, choice, u)?;
        let (world, from) = (&self.tracer.world, &self.receiver.point);
        let hidden = match &towards.end {
            End::Surface(point) => world.occluded(from, point),
            End::Point(point) => world.occluded_point(from, *point),
            End::Infinity => world.occluded_direction(from, single(towards.direction)),
        };
        let weight = if hidden { 0.0 } else { towards.weight };
        Some(Sampled { direction: towards.direction, density: towards.density, weight })
    }

    /// The density per steradian with which paths take [`sample_light`](Self::sample_light) to choose a direction, as known to one that
    /// was chosen otherwise: that of the first light in this direction.
    #[must_use]
    pub fn light_density(&self, direction: DVec3) -> f64 {
        let lights = &self.tracer.lights;
        match self.tracer.world.closest_hit(&self.receiver.point.ray(single(direction))) {
            Some(hit) if hit.front => lights.density(self.receiver.position, &hit),
            Some(_) => 0.0,
            None => lights.environment_density(self.receiver.normal, direction),
        }
    }

    /// A direction chosen by the material: `lobe` in [0, 1) says by which part of its model.
    #[must_use]
    pub fn sample_material(&self, lobe: f64, u: [f32; 2]) -> Option<Sampled> {
        let scattered = self.scatterer?.sample(lobe, u)?;
        let weight = scattered.terms.iter().map(|(_, share)| share).sum();
        Some(Sampled { direction: scattered.direction, density: scattered.density, weight })
    }

    /// The sum of the terms of BRDF times cosine, and the density per steradian with which
    /// [`sample_material`](Self::sample_material) chooses a direction; zeros where it doesn't.
    #[must_use]
    pub fn material(&self, direction: DVec3) -> [f64; 2] {
        let found = self.scatterer.and_then(|s| s.evaluate(direction));
        found.map_or([0.0; 2], |(terms, density)| [terms.iter().map(|(_, share)| share).sum(), density])
    }
}
