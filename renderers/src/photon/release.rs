//! Rays that leave a light anywhere and in any direction, each with the same flux.

use core::f64::consts::{PI, TAU};

use glam::{DVec3, Vec3A};

use super::aim::{Lamp, around, cosine_hemisphere, disk, flat, leaving, on_flat};
use crate::direct::{Light, Shape, Source, single};
use crate::geometry::Ray;

impl Lamp<'_> {
    /// All the light's flux for a light factor of 1, in m² sr, sr or m²: of parallel light, that through the sphere about the scene.
    pub(super) fn flux(&self) -> f64 {
        match self.light {
            Light::Area { source, .. } => PI * area(&source.shape),
            Light::Point { .. } => 2.0 * TAU,
            Light::Luminaire { luminaire, .. } => luminaire.intensity().flux(),
            Light::Directional { .. } => {
                let (_, radius) = self.scene();
                PI * radius * radius
            }
        }
    }

    /// The flux that attempts stand for together: of luminaires it is more than [`flux`](Self::flux), as some attempts fail.
    pub(super) fn attempted_flux(&self) -> f64 {
        match self.light {
            Light::Luminaire { luminaire, .. } => 2.0 * TAU * luminaire.intensity().peak(),
            Light::Area { .. } | Light::Point { .. } | Light::Directional { .. } => self.flux(),
        }
    }

    /// A ray, for a point of the unit cube in four dimensions: the first two coordinates say in which direction, the others from where. The last
    /// number decides on attempts, so that rays that succeed carry flux alike; `None` if this one fails.
    pub(super) fn release(&self, u: [f64; 4], decision: f64) -> Option<Ray> {
        let [s, t, p, q] = u;
        match self.light {
            Light::Area { source, .. } => {
                let (from, normal) = place(source, [p, q])?;
                Some(leaving(source, from, normal, cosine_hemisphere(normal, [s, t])))
            }
            Light::Point { position, .. } => Some(Ray::new(single(*position), single(anywhere([s, t])))),
            Light::Luminaire { luminaire, .. } => {
                let direction = anywhere([s, t]);
                let peak = luminaire.intensity().peak();
                let succeeds = decision * peak < luminaire.candela(direction);
                succeeds.then(|| Ray::new(single(luminaire.position), single(direction)))
            }
            Light::Directional { direction, .. } => {
                let (centre, radius) = self.scene();
                let (x, y) = direction.any_orthonormal_pair();
                let [a, b] = disk([s, t]);
                Some(self.parallel(centre + (x * a + y * b) * radius, *direction))
            }
        }
    }

    /// The sphere about the scene's bounds: its centre and radius.
    fn scene(&self) -> (DVec3, f64) {
        let [low, high] = self.world.bounds().map(Vec3A::as_dvec3);
        ((low + high) / 2.0, (high - low).length() / 2.0)
    }
}

/// A direction, evenly over all.
fn anywhere([s, t]: [f64; 2]) -> DVec3 {
    around(DVec3::Z, 1.0 - 2.0 * s, t)
}

/// The area of a light's side that shines.
fn area(shape: &Shape) -> f64 {
    match shape {
        Shape::Sphere { radius, .. } => 2.0 * TAU * radius * radius,
        shape => flat(shape).map_or(0.0, |(_, area)| area),
    }
}

/// A place on a light, evenly over its area, and the normal there.
fn place(source: &Source, u: [f64; 2]) -> Option<(DVec3, DVec3)> {
    match &source.shape {
        Shape::Sphere { centre, radius } => {
            let normal = anywhere(u);
            Some((*centre + normal * *radius, normal))
        }
        shape => Some((on_flat(shape, u)?, flat(shape)?.0.normal)),
    }
}
