//! Particles leave the lights.

use core::f64::consts::{PI, TAU};

use renderers::geometry::glam::{DVec3, Vec3A};
use renderers::geometry::{Ray, SurfacePoint, World};
use renderers::luminaire::PlacedLuminaire;
use renderers::scene::{Emitter, Geometry, Scene, SpectrumId};

use super::particle::Particle;
use super::surface::Side;
use super::waves::Waves;
use super::{Aim, PARTICLES, Strata, TraceError, single};
use crate::statistics::Rng;

/// The share of particles that choose among all lights evenly; the others choose by flux.
const EVENLY: f64 = 0.1;

/// Where particles start.
#[derive(Clone, Debug)]
enum Origin {
    Rectangle { centre: DVec3, halves: [DVec3; 2], normal: DVec3, primitive: u32 },
    Disk { centre: DVec3, radius: f64, normal: DVec3, primitive: u32 },
    Sphere { centre: DVec3, radius: f64, inward: bool },
    Mesh(Vec<Triangle>),
    Point(DVec3),
    Luminaire(PlacedLuminaire),
    Directional(DVec3),
}

#[derive(Clone, Debug)]
struct Triangle {
    /// Areas of this and of those before it.
    sum: f64,
    corner: DVec3,
    edges: [DVec3; 2],
    primitive: u32,
}

#[derive(Clone, Debug)]
struct Light {
    origin: Origin,
    spectrum: SpectrumId,
    /// Of surfaces; 0 for lights without.
    area: f64,
    /// How often it is chosen, this alone and with those before it.
    share: f64,
    sum: f64,
}

/// A sphere, around mirrors and glass or around everything.
#[derive(Clone, Copy, Debug)]
struct Ball {
    centre: DVec3,
    radius: f64,
}

/// All lights that particles leave, and where these are aimed.
#[derive(Clone, Debug)]
pub(super) struct Lights {
    lights: Vec<Light>,
    /// None: everywhere.
    targets: Vec<Ball>,
    all: Ball,
}

impl Lights {
    pub(super) fn new(scene: &Scene, world: &World, sides: &[[Side; 2]], aim: Aim) -> Result<Self, TraceError> {
        let [low, high] = world.bounds().map(Vec3A::as_dvec3);
        let all = Ball { centre: (low + high) / 2.0, radius: 1.001 * (high - low).length() / 2.0 };
        let specular = |(_, sides): &(_, &[Side; 2])| sides.iter().any(Side::is_specular);
        let targets = match aim {
            Aim::Everywhere => Vec::new(),
            Aim::Specular => {
                scene.shapes.iter().zip(sides).filter(specular).map(|(s, _)| Ball::around(&s.geometry)).collect()
            }
        };
        let mut lights: Vec<Light> = scene.emitters.iter().filter_map(|e| Light::new(scene, world, e)).collect();
        let powers: Vec<f64> = lights.iter().map(|light| light.power(scene, &all)).collect();
        let total: f64 = powers.iter().sum();
        let evenly = 1.0 / super::count(lights.len());
        let mut sum = 0.0;
        for (light, power) in lights.iter_mut().zip(powers) {
            let by_power = if total > 0.0 { power / total } else { evenly };
            light.share = EVENLY * evenly + (1.0 - EVENLY) * by_power;
            sum += light.share;
            light.sum = sum;
        }
        if lights.is_empty() { Err(TraceError::NoLight) } else { Ok(Self { lights, targets, all }) }
    }

    /// A particle from the given cells of places and directions; `None` if it carries nothing.
    pub(super) fn emit<const W: usize>(
        &self,
        waves: &Waves<W>,
        [place, direction]: [[u32; 2]; 2],
        random: &mut Rng,
    ) -> Option<Particle<W>> {
        let choice = random.unit();
        let number = self.lights.partition_point(|light| light.sum <= choice).min(self.lights.len() - 1);
        let light = &self.lights[number];
        let place = Strata::point(place, random);
        let (direction, target) = (Strata::point(direction, random), random.unit());
        let (ray, direction, weight) = match &light.origin {
            Origin::Point(position) => {
                let (direction, density) = self.direction(*position, None, direction, target);
                (Ray::new(single(*position), single(direction)), direction, 1.0 / density)
            }
            Origin::Luminaire(luminaire) => {
                let (direction, density) = self.direction(luminaire.position, None, direction, target);
                let weight = luminaire.candela(direction) / density;
                (Ray::new(single(luminaire.position), single(direction)), direction, weight)
            }
            Origin::Directional(along) => {
                let (start, weight) = self.parallel(*along, place, target);
                (Ray::new(single(start), single(*along)), *along, weight)
            }
            _ => {
                let (position, normal, primitive) = light.place(place, random)?;
                let (direction, density) = self.direction(position, Some(normal), direction, target);
                let surface = SurfacePoint::new(single(position), single(normal));
                let surface = primitive.map_or(surface, |primitive| surface.on(primitive));
                (surface.ray(single(direction)), direction, light.area * direction.dot(normal) / density)
            }
        };
        let weight = weight / (light.share * f64::from(PARTICLES));
        let flux = waves.spectrum(light.spectrum).map(|s| s * weight);
        (weight > 0.0 && flux.iter().any(|f| *f > 0.0)).then(|| Particle::new(ray, direction, flux))
    }

    /// A direction and its density per steradian: in the hemisphere around a normal by the cosine, or evenly in all directions; or evenly over
    /// the cones of the targets that are seen.
    fn direction(&self, from: DVec3, normal: Option<DVec3>, u: [f64; 2], target: f64) -> (DVec3, f64) {
        let count = super::count(self.targets.len());
        let chosen = self.targets.get(super::floor(target * count));
        let direction = match chosen.and_then(|ball| ball.cone(from)) {
            Some((axis, height)) => cone_direction(axis, height, u),
            None => normal.map_or_else(|| cone_direction(DVec3::Z, 2.0, u), |n| cosine_direction(n, u)),
        };
        let plainly = normal.map_or(1.0 / (4.0 * PI), |n| direction.dot(n).max(0.0) / PI);
        if chosen.is_none() {
            return (direction, plainly);
        }
        let density = |ball: &Ball| match ball.cone(from) {
            None => plainly,
            // Rounding may take a direction out of the cone that it was chosen from.
            Some((axis, height)) if 1.0 - direction.dot(axis) <= height * (1.0 + 1e-12) => 1.0 / (TAU * height),
            Some(_) => 0.0,
        };
        (direction, self.targets.iter().map(density).sum::<f64>() / count)
    }

    /// Where a particle of parallel light starts, and the area that it stands for.
    fn parallel(&self, along: DVec3, u: [f64; 2], target: f64) -> (DVec3, f64) {
        let count = super::count(self.targets.len());
        let ball = self.targets.get(super::floor(target * count)).unwrap_or(&self.all);
        let (x, y) = along.any_orthonormal_pair();
        let [a, b] = disk(u);
        let through = ball.centre + (x * a + y * b) * ball.radius;
        let density = |ball: &Ball| {
            let offset = through - ball.centre;
            let across2 = offset.length_squared() - offset.dot(along).powi(2);
            let inside = across2 <= ball.radius * ball.radius * (1.0 + 1e-12);
            if inside { 1.0 / (PI * ball.radius * ball.radius) } else { 0.0 }
        };
        let densities = self.targets.iter().map(density).sum::<f64>();
        let density = if self.targets.is_empty() { density(ball) } else { densities / count };
        let back = (through - self.all.centre).dot(along) + self.all.radius;
        (through - along * back, 1.0 / density)
    }
}

impl Light {
    fn new(scene: &Scene, world: &World, emitter: &Emitter) -> Option<Self> {
        let (origin, spectrum, area) = match emitter {
            Emitter::Area { shape, radiance } => {
                let geometry = &scene.shapes.get(shape.0)?.geometry;
                (Origin::surface(geometry, world.primitives(shape.0).start)?, *radiance, geometry.area())
            }
            Emitter::Point { position, intensity } => (Origin::Point(*position), *intensity, 0.0),
            Emitter::Luminaire { luminaire, spectrum, .. } => (Origin::Luminaire(luminaire.clone()), *spectrum, 0.0),
            Emitter::Directional { direction, irradiance } => (Origin::Directional(*direction), *irradiance, 0.0),
            _ => return None,
        };
        Some(Self { origin, spectrum, area, share: 0.0, sum: 0.0 })
    }

    /// Its luminous flux.
    fn power(&self, scene: &Scene, all: &Ball) -> f64 {
        let unit = match &self.origin {
            Origin::Point(_) => 4.0 * PI,
            Origin::Luminaire(luminaire) => luminaire.intensity().flux(),
            Origin::Directional(_) => PI * all.radius * all.radius,
            _ => PI * self.area,
        };
        unit * scene.spectrum(self.spectrum).kind.photometric()
    }

    /// A place on its surface, evenly over the area, with the normal of the side that shines and the primitive if it is flat.
    fn place(&self, [u, v]: [f64; 2], random: &mut Rng) -> Option<(DVec3, DVec3, Option<u32>)> {
        match &self.origin {
            Origin::Rectangle { centre, halves: [x, y], normal, primitive } => {
                Some((*centre + *x * (2.0 * u - 1.0) + *y * (2.0 * v - 1.0), *normal, Some(*primitive)))
            }
            Origin::Disk { centre, radius, normal, primitive } => {
                let (x, y) = normal.any_orthonormal_pair();
                let [a, b] = disk([u, v]);
                Some((*centre + (x * a + y * b) * *radius, *normal, Some(*primitive)))
            }
            Origin::Sphere { centre, radius, inward } => {
                let outward = cone_direction(DVec3::Z, 2.0, [u, v]);
                Some((*centre + outward * *radius, if *inward { -outward } else { outward }, None))
            }
            Origin::Mesh(triangles) => {
                let at = random.unit() * self.area;
                let Triangle { corner, edges: [a, b], primitive, .. } =
                    triangles.get(triangles.partition_point(|t| t.sum <= at)).or(triangles.last())?;
                let root = u.sqrt();
                let place = *corner + *a * (root * (1.0 - v)) + *b * (root * v);
                Some((place, a.cross(*b).try_normalize()?, Some(*primitive)))
            }
            _ => None,
        }
    }
}

impl Origin {
    fn surface(geometry: &Geometry, primitive: u32) -> Option<Self> {
        Some(match geometry {
            Geometry::Rectangle { center, half_u, half_v, normal } => {
                Self::Rectangle { centre: *center, halves: [*half_u, *half_v], normal: *normal, primitive }
            }
            Geometry::Disk { center, radius, normal } => {
                Self::Disk { centre: *center, radius: *radius, normal: *normal, primitive }
            }
            Geometry::Sphere { center, radius, inward, .. } => {
                Self::Sphere { centre: *center, radius: *radius, inward: *inward }
            }
            Geometry::Mesh(mesh) => {
                let mut sum = 0.0;
                let triangle = |(index, primitive): (usize, u32)| {
                    let [a, b, c] = mesh.corners(index);
                    sum += mesh.face_cross(index).length() / 2.0;
                    Triangle { sum, corner: a, edges: [b - a, c - a], primitive }
                };
                Self::Mesh((0..mesh.triangles.len()).zip(primitive..).map(triangle).collect())
            }
            _ => return None,
        })
    }
}

impl Ball {
    fn around(geometry: &Geometry) -> Self {
        match geometry {
            Geometry::Rectangle { center, half_u, half_v, .. } => {
                Self { centre: *center, radius: (half_u.length_squared() + half_v.length_squared()).sqrt() }
            }
            Geometry::Disk { center, radius, .. } | Geometry::Sphere { center, radius, .. } => {
                Self { centre: *center, radius: *radius }
            }
            Geometry::Mesh(mesh) => {
                let first = mesh.positions.first().copied().unwrap_or_default();
                let corners = mesh.positions.iter().fold([first; 2], |[low, high], p| [low.min(*p), high.max(*p)]);
                let centre = (corners[0] + corners[1]) / 2.0;
                let radius = mesh.positions.iter().map(|p| (*p - centre).length()).fold(0.0, f64::max);
                Self { centre, radius }
            }
            _ => Self { centre: DVec3::ZERO, radius: f64::INFINITY },
        }
        .widened()
    }

    /// A little larger: surfaces are rounded to `f32`.
    fn widened(self) -> Self {
        let rounding = 4.0 * f64::from(f32::EPSILON) * (self.centre.abs().max_element() + self.radius);
        Self { radius: self.radius + rounding, ..self }
    }

    /// The axis of the cone in which it is seen, and 1 − cos of the angle between axis and rim; `None` from within.
    fn cone(&self, from: DVec3) -> Option<(DVec3, f64)> {
        let way = self.centre - from;
        let sine2 = self.radius * self.radius / way.length_squared();
        (sine2 < 1.0).then(|| (way.normalize(), sine2 / (1.0 + (1.0 - sine2).sqrt())))
    }
}

/// Evenly over the directions that are less than an angle from an axis, `height` being 1 − cos of it: 2 for all directions.
fn cone_direction(axis: DVec3, height: f64, [u, v]: [f64; 2]) -> DVec3 {
    let fall = u * height;
    let across = (fall * (2.0 - fall)).max(0.0).sqrt();
    let (sin, cos) = (TAU * v).sin_cos();
    let (x, y) = axis.any_orthonormal_pair();
    (axis * (1.0 - fall) + (x * cos + y * sin) * across).normalize()
}

fn cosine_direction(normal: DVec3, u: [f64; 2]) -> DVec3 {
    let [a, b] = disk(u);
    let (x, y) = normal.any_orthonormal_pair();
    (x * a + y * b + normal * (1.0 - a * a - b * b).max(0.0).sqrt()).normalize()
}

/// Evenly over the unit disk.
fn disk([u, v]: [f64; 2]) -> [f64; 2] {
    let (sin, cos) = (TAU * v).sin_cos();
    let radius = u.sqrt();
    [radius * cos, radius * sin]
}
