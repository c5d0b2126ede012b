//! Lights, as a path looks for them: one is chosen, and a direction to it, with the density of both.

use core::f64::consts::PI;

use glam::{DVec3, Vec3A};

use crate::direct::{Receiver, Shape, single, sources};
use crate::geometry::sampling::{square_to_cosine_hemisphere, square_to_disk, square_to_triangle};
use crate::geometry::{Hit, SurfacePoint, World};
use crate::luminaire::PlacedLuminaire;
use crate::scene::{Emitter, Geometry, Scene, SpectrumId, SpectrumKind};
use crate::spectral::{Factor, Functional, Palette, Role};
use crate::whitted::RenderError;

/// The share of paths that choose among all lights evenly; the others choose by flux, or what is steered by in its place.
const EVENLY: f64 = 0.1;

/// One light: a shape that shines, a triangle of a mesh that does, or a light without area.
#[derive(Clone, Debug)]
struct Light {
    kind: Kind,
    /// Radiance, intensity or irradiance.
    factor: Factor,
    /// How often it is chosen.
    share: f64,
}

#[derive(Clone, Debug)]
enum Kind {
    /// A shape, its area, and its primitive.
    Area {
        shape: Shape,
        area: f64,
        primitive: u32,
    },
    /// A sphere that shines inwards.
    Inside {
        centre: DVec3,
        radius: f64,
    },
    Point(DVec3),
    Luminaire(PlacedLuminaire),
    /// Along this unit vector.
    Directional(DVec3),
    Environment,
}

/// All lights of a scene.
#[derive(Clone, Debug, Default)]
pub(super) struct Lights {
    lights: Vec<Light>,
    /// The shares added up.
    cumulative: Vec<f64>,
    /// For each primitive, its light.
    of_primitive: Vec<Option<u32>>,
    environment: Option<u32>,
}

/// A direction to a light.
#[derive(Clone, Copy, Debug)]
pub(super) struct Towards {
    /// Unit vector.
    pub(super) direction: DVec3,
    pub(super) end: End,
    pub(super) factor: Factor,
    /// The light's part of the estimate: radiance over density for each unit of the factor.
    pub(super) weight: f64,
    /// The density of the direction per steradian, the choice of the light included; `None` for lights without area.
    pub(super) density: Option<f64>,
}

/// Where the way to a light ends.
#[derive(Clone, Copy, Debug)]
pub(super) enum End {
    Surface(SurfacePoint),
    Point(Vec3A),
    Infinity,
}

impl Lights {
    /// The lights of a scene, but for its ambient term, chosen by what `function` says of their spectra, which are added to the palette.
    pub(super) fn new(
        scene: &Scene,
        world: &World,
        palette: &mut Palette,
        function: Functional,
    ) -> Result<Self, RenderError> {
        let mut lights = Self { of_primitive: vec![None; world.len()], ..Self::default() };
        let mut powers = Vec::new();
        for emitter in &scene.emitters {
            lights.add(scene, world, emitter, (palette, function), &mut powers)?;
        }
        lights.share(&powers);
        Ok(lights)
    }

    fn add(
        &mut self,
        scene: &Scene,
        world: &World,
        emitter: &Emitter,
        (palette, function): (&mut Palette, Functional),
        powers: &mut Vec<f64>,
    ) -> Result<(), RenderError> {
        let [low, high] = world.bounds().map(Vec3A::as_dvec3);
        let cross_section = PI * (high - low).length_squared() / 4.0;
        let mut add = |kind: Kind, spectrum: SpectrumId, unit: f64| {
            let data = scene.spectrum(spectrum);
            let factor = palette.factor(data, Role::Light);
            powers.push(unit * power(&data.kind, palette, factor, function));
            self.lights.push(Light { kind, factor, share: 0.0 });
        };
        match emitter {
            Emitter::Area { shape: id, radiance } => {
                let shape = scene
                    .shapes
                    .get(id.0)
                    .ok_or_else(|| RenderError::new("a light belongs to a shape that isn't there"))?;
                let first = world.primitives(id.0).start;
                if let Geometry::Sphere { center, radius, inward: true, .. } = shape.geometry {
                    let area = 4.0 * PI * radius * radius;
                    add(Kind::Inside { centre: center, radius }, *radiance, PI * area);
                }
                for source in sources(shape, first).unwrap_or_default() {
                    let area = area(&source.shape);
                    let kind = Kind::Area { shape: source.shape, area, primitive: source.primitive };
                    add(kind, *radiance, PI * area);
                }
                let numbers = (0..).take(self.lights.len()).skip(self.lights.len() - world.primitives(id.0).len());
                for (primitive, number) in world.primitives(id.0).zip(numbers) {
                    if let Some(light) = self.of_primitive.get_mut(primitive as usize) {
                        *light = Some(number);
                    }
                }
            }
            Emitter::Point { position, intensity } => add(Kind::Point(*position), *intensity, 4.0 * PI),
            Emitter::Luminaire { luminaire, spectrum, .. } => {
                add(Kind::Luminaire(luminaire.clone()), *spectrum, luminaire.intensity().flux());
            }
            Emitter::Directional { direction, irradiance } => {
                add(Kind::Directional(*direction), *irradiance, cross_section);
            }
            Emitter::Constant { radiance, .. } => {
                add(Kind::Environment, *radiance, 4.0 * PI * cross_section);
                self.environment = u32::try_from(self.lights.len() - 1).ok();
            }
            Emitter::Ambient { .. } => {}
        }
        Ok(())
    }

    /// How often each light is chosen.
    #[allow(clippy::cast_precision_loss, reason = "counts of lights")]
    fn share(&mut self, powers: &[f64]) {
        let total: f64 = powers.iter().sum();
        let evenly = 1.0 / powers.len() as f64;
        let mut sum = 0.0;
        for (light, power) in self.lights.iter_mut().zip(powers) {
            let by_power = if total > 0.0 && total.is_finite() { power / total } else { evenly };
            light.share = EVENLY * evenly + (1.0 - EVENLY) * by_power;
            sum += light.share;
            self.cumulative.push(sum);
        }
    }

    /// The factor of the environment's radiance, if there is one.
    pub(super) fn environment(&self) -> Option<Factor> {
        self.environment.and_then(|number| self.lights.get(number as usize)).map(|light| light.factor)
    }

    /// A direction from a receiver to a light: `choice` in [0, 1) says to which, and `u` where to. `None` if the receiver doesn't see it.
    pub(super) fn towards(&self, receiver: &Receiver, choice: f64, u: [f32; 2]) -> Option<Towards> {
        let number = self.cumulative.partition_point(|sum| *sum <= choice).min(self.lights.len().checked_sub(1)?);
        let light = self.lights.get(number)?;
        let (direction, end, weight, density) = light.towards(receiver, u)?;
        let density = density.map(|d| d * light.share);
        Some(Towards { direction, end, factor: light.factor, weight: weight / light.share, density })
    }

    /// The density, per steradian, with which the direction from a position to a hit on a light is chosen; 0 for what is none.
    pub(super) fn density(&self, from: DVec3, hit: &Hit) -> f64 {
        let number = self.of_primitive.get(hit.primitive as usize).copied().flatten();
        let Some(light) = number.and_then(|n| self.lights.get(n as usize)) else { return 0.0 };
        let way = hit.position.as_dvec3() - from;
        light.share * light.density(from, way, hit.geometric_normal.as_dvec3())
    }

    /// The density, per steradian, with which a direction to the environment is chosen.
    pub(super) fn environment_density(&self, normal: DVec3, direction: DVec3) -> f64 {
        let light = self.environment.and_then(|number| self.lights.get(number as usize));
        light.map_or(0.0, |light| light.share * normal.dot(direction).max(0.0) / PI)
    }
}

impl Light {
    /// Direction, end, weight and density.
    fn towards(&self, receiver: &Receiver, u: [f32; 2]) -> Option<(DVec3, End, f64, Option<f64>)> {
        let from = receiver.position;
        match &self.kind {
            Kind::Area { shape: Shape::Sphere { centre, radius }, .. } => {
                let (point, direction, density) = sphere_cone(*centre, *radius, from, u)?;
                let surface = SurfacePoint::new(single(point), single((point - *centre) / *radius));
                Some((direction, End::Surface(surface), 1.0 / density, Some(density)))
            }
            Kind::Area { shape, primitive, .. } => {
                let (point, normal) = place(shape, u)?;
                let surface = SurfacePoint::new(single(point), single(normal)).on(*primitive);
                self.to_place(from, point, normal, surface)
            }
            Kind::Inside { centre, radius } => {
                let outward = square_to_sphere(u);
                let point = *centre + outward * *radius;
                self.to_place(from, point, -outward, SurfacePoint::new(single(point), single(-outward)))
            }
            Kind::Point(position) => {
                let way = *position - from;
                Some((way.try_normalize()?, End::Point(single(*position)), 1.0 / way.length_squared(), None))
            }
            Kind::Luminaire(luminaire) => {
                let way = luminaire.position - from;
                let intensity = luminaire.candela(-way) / way.length_squared();
                Some((way.try_normalize()?, End::Point(single(luminaire.position)), intensity, None))
            }
            Kind::Directional(along) => Some((-*along, End::Infinity, 1.0, None)),
            Kind::Environment => {
                let local = square_to_cosine_hemisphere(u).as_dvec3();
                let (x, y) = receiver.normal.any_orthonormal_pair();
                let direction = (x * local.x + y * local.y + receiver.normal * local.z).normalize();
                let density = direction.dot(receiver.normal) / PI;
                (density > 0.0).then_some((direction, End::Infinity, 1.0 / density, Some(density)))
            }
        }
    }

    /// The way to a place that was chosen evenly over the area.
    fn to_place(
        &self,
        from: DVec3,
        point: DVec3,
        normal: DVec3,
        end: SurfacePoint,
    ) -> Option<(DVec3, End, f64, Option<f64>)> {
        let way = point - from;
        let density = self.density(from, way, normal);
        let usable = density > 0.0 && density.is_finite();
        usable.then(|| (way.normalize_or_zero(), End::Surface(end), 1.0 / density, Some(density)))
    }

    /// The density per steradian of a way to a place with a unit normal; 0 where its front isn't seen.
    fn density(&self, from: DVec3, way: DVec3, normal: DVec3) -> f64 {
        let area = match self.kind {
            Kind::Area { shape: Shape::Sphere { centre, radius }, .. } => {
                return cone(centre, radius, from).map_or(0.0, |height| 1.0 / (2.0 * PI * height));
            }
            Kind::Area { area, .. } => area,
            Kind::Inside { radius, .. } => 4.0 * PI * radius * radius,
            _ => return 0.0,
        };
        let squared = way.length_squared();
        let cosine = -way.dot(normal) / squared.sqrt();
        if cosine > 0.0 { squared / (cosine * area) } else { 0.0 }
    }
}

/// What a function says of a light's spectrum; its brightness in photometric units.
fn power(kind: &SpectrumKind, palette: &Palette, factor: Factor, function: Functional) -> f64 {
    if function == Functional::Brightness {
        return kind.photometric();
    }
    let leaf = factor.leaf.and_then(|leaf| palette.leaves().get(leaf as usize));
    factor.scale * leaf.map_or(1.0, |(spectrum, _)| function.of(spectrum))
}

fn area(shape: &Shape) -> f64 {
    match shape {
        Shape::Rectangle(flat) => 4.0 * flat.u.cross(flat.v).length(),
        Shape::Disk(flat) => PI * flat.u.cross(flat.v).length(),
        Shape::Triangle([a, b, c]) => (*b - *a).cross(*c - *a).length() / 2.0,
        Shape::Sphere { radius, .. } => 4.0 * PI * radius * radius,
    }
}

/// A place on a flat shape, evenly over its area, and its unit normal.
fn place(shape: &Shape, u: [f32; 2]) -> Option<(DVec3, DVec3)> {
    match shape {
        Shape::Rectangle(flat) => Some((flat.at(u.map(|u| 2.0 * f64::from(u) - 1.0)), flat.normal)),
        Shape::Disk(flat) => {
            let point = square_to_disk(u);
            Some((flat.at([f64::from(point.x), f64::from(point.y)]), flat.normal))
        }
        Shape::Triangle([a, b, c]) => {
            let [v, w] = square_to_triangle(u).map(f64::from);
            Some((*a + (*b - *a) * v + (*c - *a) * w, (*b - *a).cross(*c - *a).try_normalize()?))
        }
        Shape::Sphere { .. } => None,
    }
}

/// A direction, evenly over the sphere.
fn square_to_sphere([u, v]: [f32; 2]) -> DVec3 {
    let z = 1.0 - 2.0 * f64::from(u);
    let (sin, cos) = (core::f64::consts::TAU * f64::from(v)).sin_cos();
    let across = (1.0 - z * z).max(0.0).sqrt();
    DVec3::new(across * cos, across * sin, z)
}

/// 1 − cos θ of the cone in which a sphere is seen, without cancellation; `None` from within.
fn cone(centre: DVec3, radius: f64, from: DVec3) -> Option<f64> {
    let sine2 = radius * radius / (centre - from).length_squared();
    (sine2 < 1.0).then(|| sine2 / (1.0 + (1.0 - sine2).sqrt()))
}

/// A point of a sphere's visible part, the unit direction to it, and the direction's density per steradian: evenly over the cone of directions.
fn sphere_cone(centre: DVec3, radius: f64, from: DVec3, [u, v]: [f32; 2]) -> Option<(DVec3, DVec3, f64)> {
    let height = cone(centre, radius, from)?;
    let axis = centre - from;
    let distance = axis.length();
    let axis = axis / distance;
    let fall = f64::from(u) * height;
    let sine2 = fall * (2.0 - fall);
    let (sin, cos) = (core::f64::consts::TAU * f64::from(v)).sin_cos();
    let (x, y) = axis.any_orthonormal_pair();
    let direction = (axis * (1.0 - fall) + (x * cos + y * sin) * sine2.max(0.0).sqrt()).normalize();
    let half_chord = (radius * radius - distance * distance * sine2).max(0.0).sqrt();
    let near = from + direction * (distance * (1.0 - fall) - half_chord);
    let outward = (near - centre).try_normalize()?;
    Some((centre + outward * radius, direction, 1.0 / (2.0 * PI * height)))
}
