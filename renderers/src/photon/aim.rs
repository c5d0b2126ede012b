//! Rays from lights, each with its flux: what one attempt to send a photon stands for.

use core::f64::consts::{PI, TAU};

use glam::{DVec3, Vec3A};

use super::target::{Ball, Facet};
use crate::direct::{Blockers, Cover, Flat, Light, Receiver, Scratch, Shape, Source, Surroundings, single};
use crate::geometry::sampling::square_to_disk;
use crate::geometry::{Ray, SurfacePoint, World};

/// Facets nearer to a light than this part of its width and height aren't cut any finer.
const NEAR: f64 = 0.5;

/// A ray from a light towards its target.
#[derive(Clone, Copy, Debug)]
pub(super) struct Aim {
    pub(super) ray: Ray,
    /// Its flux for a light factor of 1: cos θ dA dω over the density of such rays.
    pub(super) flux: f64,
    /// The primitive that it must meet first.
    pub(super) primitive: u32,
}

/// A light in its world.
#[derive(Clone, Copy, Debug)]
pub(super) struct Lamp<'s> {
    pub(super) light: &'s Light,
    pub(super) world: &'s World,
}

/// Where light comes from, as seen from a place: the ray from there, and the irradiance across it over the density.
type Arriving = (Ray, DVec3, f64);

impl Lamp<'_> {
    /// A ray towards a sphere: the first two numbers say in which direction, the others from where on the light.
    pub(super) fn aim_at_ball(self, ball: &Ball, [s, t, p, q]: [f64; 4]) -> Option<Aim> {
        let (ray, flux) = match self.light {
            Light::Area { source, .. } => {
                let (from, normal, area) = place(&source.shape, ball, [p, q])?;
                let (direction, solid_angle) = match cone(ball, from) {
                    Some(height) => towards(ball, from, height, [s, t]),
                    None => (cosine_hemisphere(normal, [s, t]), f64::INFINITY),
                };
                let cosine = direction.dot(normal);
                let flux = if solid_angle.is_finite() { cosine * solid_angle } else { PI } * area;
                (leaving(source, from, normal, direction), flux)
            }
            Light::Point { position, .. } => {
                let (direction, solid_angle) = to_ball_around(ball, *position, [s, t]);
                (Ray::new(single(*position), single(direction)), solid_angle)
            }
            Light::Luminaire { luminaire, .. } => {
                let (direction, solid_angle) = to_ball_around(ball, luminaire.position, [s, t]);
                (Ray::new(single(luminaire.position), single(direction)), solid_angle * luminaire.candela(direction))
            }
            Light::Directional { direction, .. } => {
                let (x, y) = direction.any_orthonormal_pair();
                let [a, b] = disk([s, t]);
                let through = ball.centre + (x * a + y * b) * ball.radius;
                (self.parallel(through, *direction), PI * ball.radius * ball.radius)
            }
        };
        (flux > 0.0).then_some(Aim { ray, flux, primitive: ball.primitive })
    }

    /// A ray to a point of a facet, and its flux for each unit of the facet's area.
    pub(super) fn aim_at_facet(self, facet: &Facet, to: DVec3, u: [f64; 2]) -> Option<Aim> {
        let (ray, direction, across) = match self.light {
            Light::Area { source, .. } => from_source(source, facet, to, u)?,
            Light::Point { position, .. } => from_point(*position, to, 1.0)?,
            Light::Luminaire { luminaire, .. } => {
                from_point(luminaire.position, to, luminaire.candela(to - luminaire.position))?
            }
            Light::Directional { direction, .. } => (self.parallel(to, *direction), *direction, 1.0),
        };
        let flux = across * facet.normal.dot(direction).abs();
        (flux > 0.0).then_some(Aim { ray, flux, primitive: facet.primitive })
    }

    /// The irradiance at a point of a facet, of both sides together, for a light factor of 1 and nothing in the way.
    pub(super) fn irradiance(self, facet: &Facet, at: DVec3, scratch: &mut Scratch) -> f64 {
        if !matches!(self.light, Light::Area { .. }) {
            return self.aim_at_facet(facet, at, [0.5; 2]).map_or(0.0, |aim| aim.flux);
        }
        let around = Surroundings { world: self.world, blockers: &Blockers::default() };
        let mut sum = 0.0;
        for normal in [facet.normal, -facet.normal] {
            let receiver = Receiver::new(at, normal, self.world);
            self.light.illuminate(around, &receiver, 0, || Cover::Clear, scratch, |part| sum += part.irradiance);
        }
        sum
    }

    /// A ray of parallel light through a point, from before everything.
    fn parallel(self, through: DVec3, direction: DVec3) -> Ray {
        let [low, high] = self.world.bounds().map(Vec3A::as_dvec3);
        let corner = DVec3::select(direction.cmpgt(DVec3::ZERO), low, high);
        let before = (through - corner).dot(direction).max(0.0) + 1e-3 * (high - low).length();
        Ray::new(single(through - direction * before), single(direction))
    }

    /// How far one may go from a point before the light looks very different; infinite for parallel light.
    pub(super) fn scale(self, point: DVec3) -> f64 {
        match self.light {
            Light::Area { source, .. } => distance(&source.shape, point).max(near_distance(&source.shape)),
            Light::Point { position, .. } => position.distance(point),
            Light::Luminaire { luminaire, .. } => luminaire.position.distance(point),
            Light::Directional { .. } => f64::INFINITY,
        }
    }
}

/// The way from a point of intensity 1 times a number.
fn from_point(position: DVec3, to: DVec3, intensity: f64) -> Option<Arriving> {
    let way = to - position;
    let direction = way.try_normalize()?;
    Some((Ray::new(single(position), single(direction)), direction, intensity / way.length_squared()))
}

/// The way from a place on a light with an area; where that is near, from where a direction leads to it.
fn from_source(source: &Source, facet: &Facet, to: DVec3, u: [f64; 2]) -> Option<Arriving> {
    let (from, normal, across) = match &source.shape {
        Shape::Sphere { centre, radius } => {
            let ball = Ball { centre: *centre, radius: *radius, primitive: source.primitive };
            let (back, solid_angle) = towards(&ball, to, cone(&ball, to)?, u);
            let from = entry(&ball, to, back);
            (from, (from - *centre) / *radius, solid_angle)
        }
        shape => {
            let (flat, area) = flat(shape)?;
            let height = flat.normal.dot(to - flat.centre);
            // Where the flux of places on the light would exceed that of directions.
            if area * height > PI * distance(shape, to).powi(3) {
                near(shape, facet, to, u)?
            } else {
                let (from, normal) = (on_flat(shape, u)?, flat.normal);
                let way = to - from;
                let squared = way.length_squared();
                (from, normal, area * normal.dot(way) / (squared * squared.sqrt()))
            }
        }
    };
    let direction = (to - from).try_normalize()?;
    (direction.dot(normal) > 0.0).then(|| (leaving(source, from, normal, direction), direction, across))
}

/// The place on a flat light in a direction from a facet, of both its sides where the light is on both, distributed as the cosine; and the
/// irradiance across the direction over the density.
fn near(shape: &Shape, facet: &Facet, to: DVec3, [s, t]: [f64; 2]) -> Option<(DVec3, DVec3, f64)> {
    let (flat, _) = flat(shape)?;
    let height = facet.normal.dot(flat.centre - to);
    let extent = facet.normal.dot(flat.u).abs() + facet.normal.dot(flat.v).abs();
    let (side, s, sides) = if height.abs() >= extent {
        (facet.normal * height.signum(), s, 1.0)
    } else if s < 0.5 {
        (facet.normal, 2.0 * s, 2.0)
    } else {
        (-facet.normal, 2.0 * s - 1.0, 2.0)
    };
    let back = cosine_hemisphere(side, [s, t]);
    let distance = flat.normal.dot(flat.centre - to) / flat.normal.dot(back);
    let from = to + back * distance;
    let within = distance > 0.0 && is_within(shape, from);
    within.then(|| (from, flat.normal, sides * PI / back.dot(side).max(f64::MIN_POSITIVE)))
}

fn is_within(shape: &Shape, point: DVec3) -> bool {
    let coordinates = |flat: &Flat| {
        let offset = point - flat.centre;
        [flat.u, flat.v].map(|axis| axis.dot(offset) / axis.length_squared())
    };
    match shape {
        Shape::Rectangle(flat) => coordinates(flat).iter().all(|x| x.abs() <= 1.0),
        Shape::Disk(flat) => coordinates(flat).iter().map(|x| x * x).sum::<f64>() <= 1.0,
        _ => false,
    }
}

/// A flat light's frame and its area.
fn flat(shape: &Shape) -> Option<(Flat, f64)> {
    match shape {
        Shape::Rectangle(flat) => Some((*flat, 4.0 * flat.u.cross(flat.v).length())),
        Shape::Disk(flat) => Some((*flat, PI * flat.u.cross(flat.v).length())),
        _ => None,
    }
}

/// A place on a flat light, evenly over its area.
fn on_flat(shape: &Shape, u: [f64; 2]) -> Option<DVec3> {
    match shape {
        Shape::Rectangle(flat) => Some(flat.at(u.map(|u| 2.0 * u - 1.0))),
        Shape::Disk(flat) => Some(flat.at(disk(u))),
        _ => None,
    }
}

/// A place on a light, its unit normal, and 1 over the density by area. Of spheres, only the part that may light the target is chosen
/// from, in proportion to how far it is from that part's rim.
fn place(shape: &Shape, target: &Ball, u: [f64; 2]) -> Option<(DVec3, DVec3, f64)> {
    let Shape::Sphere { centre, radius } = shape else {
        let (flat, area) = flat(shape)?;
        return Some((on_flat(shape, u)?, flat.normal, area));
    };
    let way = target.centre - *centre;
    let distance = way.length();
    let axis = way.try_normalize().unwrap_or(DVec3::Z);
    let rim =
        if distance > 0.0 { (radius - target.radius) / distance } else { (radius - target.radius) * f64::INFINITY };
    let rim = if rim < 1.0 { rim.max(-1.0) } else { return None };
    let above = (1.0 - rim) * u[0].sqrt();
    let height = rim + above;
    let normal = around(axis, height, u[1]);
    let area = PI * radius * radius * (1.0 - rim) * (1.0 - rim) / above;
    area.is_finite().then_some((*centre + normal * *radius, normal, area))
}

/// The ray that leaves a light.
fn leaving(source: &Source, from: DVec3, normal: DVec3, direction: DVec3) -> Ray {
    SurfacePoint::new(single(from), single(normal)).on(source.primitive).ray(single(direction))
}

/// The distance below which facets aren't cut any finer.
fn near_distance(shape: &Shape) -> f64 {
    match shape {
        Shape::Sphere { radius, .. } => NEAR * radius,
        shape => flat(shape).map_or(0.0, |(flat, _)| NEAR * (flat.u.length() + flat.v.length())),
    }
}

/// How near a light comes to a point, at least.
fn distance(shape: &Shape, point: DVec3) -> f64 {
    match shape {
        Shape::Sphere { centre, radius } => (centre.distance(point) - radius).max(0.0),
        Shape::Rectangle(flat) | Shape::Disk(flat) => {
            let offset = point - flat.centre;
            let nearest =
                [flat.u, flat.v].map(|axis| axis * (axis.dot(offset) / axis.length_squared()).clamp(-1.0, 1.0));
            (offset - nearest[0] - nearest[1]).length()
        }
        _ => 0.0,
    }
}

/// 1 − cos θ of the cone in which a sphere is seen, without cancellation; `None` from within.
fn cone(ball: &Ball, from: DVec3) -> Option<f64> {
    let sine2 = ball.radius * ball.radius / (ball.centre - from).length_squared();
    (sine2 < 1.0).then(|| sine2 / (1.0 + (1.0 - sine2).sqrt()))
}

/// A direction to a sphere, evenly over the cone of such directions, and its solid angle.
fn towards(ball: &Ball, from: DVec3, height: f64, u: [f64; 2]) -> (DVec3, f64) {
    let axis = (ball.centre - from).normalize_or_zero();
    // By the concentric map, which keeps neighbours together: areas of the disk are fractions of the cone's solid angle.
    let [a, b] = disk(u);
    let squared = a * a + b * b;
    let fall = squared * height;
    let across = (height * (2.0 - fall)).max(0.0).sqrt();
    let (x, y) = axis.any_orthonormal_pair();
    ((axis * (1.0 - fall) + (x * a + y * b) * across).normalize(), TAU * height)
}

/// The same, evenly over all directions from within.
fn to_ball_around(ball: &Ball, from: DVec3, u: [f64; 2]) -> (DVec3, f64) {
    match cone(ball, from) {
        Some(height) => towards(ball, from, height, u),
        None => (around(DVec3::Z, 1.0 - 2.0 * u[0], u[1]), 2.0 * TAU),
    }
}

/// Where a direction first meets a sphere.
fn entry(ball: &Ball, from: DVec3, direction: DVec3) -> DVec3 {
    let middle = (ball.centre - from).dot(direction);
    let foot = from + direction * middle - ball.centre;
    let near = middle - (ball.radius * ball.radius - foot.length_squared()).max(0.0).sqrt();
    ball.centre + (from + direction * near - ball.centre).normalize_or(-direction) * ball.radius
}

/// The unit vector at a height along an axis, at an azimuth in turns.
fn around(axis: DVec3, height: f64, turns: f64) -> DVec3 {
    let (sin, cos) = (TAU * turns).sin_cos();
    let (x, y) = axis.any_orthonormal_pair();
    axis * height + (x * cos + y * sin) * (1.0 - height * height).max(0.0).sqrt()
}

/// A direction of the hemisphere around a unit vector, with a density proportional to the cosine.
fn cosine_hemisphere(axis: DVec3, u: [f64; 2]) -> DVec3 {
    let [a, b] = disk(u);
    let (x, y) = axis.any_orthonormal_pair();
    x * a + y * b + axis * (1.0 - a * a - b * b).max(0.0).sqrt()
}

#[allow(clippy::cast_possible_truncation, reason = "the map is f32")]
fn disk(u: [f64; 2]) -> [f64; 2] {
    square_to_disk(u.map(|u| u as f32)).as_dvec2().to_array()
}
