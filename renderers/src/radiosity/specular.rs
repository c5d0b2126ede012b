//! Mirrors and glass on the ways of light between surfaces.
//!
//! Where patches exchange light, glass is not there at all, and a mirror is a diffuse surface that reflects as much: the total of the light
//! is nearly right, where it goes is not. Rays that look for the light at a place follow mirrors and glass as they are.

use super::mesh::tessellated;
use crate::direct::surface;
use crate::geometry::glam::DVec3;
use crate::geometry::sampling::SobolSequence;
use crate::geometry::{Hit, Ray, World};
use crate::material::{Dielectric, Material, mirror_factors};
use crate::scene::{BsdfId, BsdfKind, Geometry, Scene, Shape};
use crate::spectral::{Factor, MEAN_WAVELENGTH};
use crate::whitted::{Whitted, boundary, mirror_ray, receiver};

/// The most reflections and refractions of a ray: what is left then is lost.
const MOST_BOUNDARIES: u32 = 16;
/// The most spectra that tint a ray's light, and bits for each.
const MOST_SPECTRA: u32 = 8;
const BITS: u32 = 16;

/// What a shape is for rays between surfaces; in this order their primitives are numbered.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Kind {
    /// Patches: also a polyhedron that stands for a round shape with a mirror on one of its sides only.
    Patches,
    /// Flat, with a mirror on a side at least.
    Flat,
    /// Round, a mirror.
    Round,
    /// A smooth boundary of transparent media: no patches, and it blocks nothing.
    Clear,
}

impl Kind {
    fn new(scene: &Scene, shape: &Shape) -> Self {
        let is_specular =
            |id: BsdfId| matches!(scene.bsdf(id).kind, BsdfKind::Conductor { .. } | BsdfKind::Dielectric { .. });
        let [any, all] = match scene.bsdf(shape.bsdf).kind {
            BsdfKind::TwoSided { front, back } => {
                let [front, back] = [front, back].map(is_specular);
                [front || back, front && back]
            }
            _ => [is_specular(shape.bsdf); 2],
        };
        let is_round = matches!(shape.geometry, Geometry::Disk { .. } | Geometry::Sphere { .. });
        match scene.bsdf(shape.bsdf).kind {
            BsdfKind::Dielectric { .. } if shape.emitter.is_none() => Self::Clear,
            _ if any && !is_round => Self::Flat,
            _ if all => Self::Round,
            _ => Self::Patches,
        }
    }
}

/// The shapes of a scene by their kind, otherwise in order; with their numbers.
pub(super) fn in_order(scene: &Scene) -> Vec<(Kind, u32, &Shape)> {
    let mut shapes: Vec<_> =
        (0..).zip(&scene.shapes).map(|(number, shape)| (Kind::new(scene, shape), number, shape)).collect();
    shapes.sort_by_key(|(kind, ..)| *kind);
    shapes
}

/// Spectra that light is multiplied by on its way: leaves of the palette, in the order in which a ray met them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Tint(u128);

impl Tint {
    pub(crate) const fn is_none(self) -> bool {
        self.0 == 0
    }

    /// The same with one more; `None` if there are too many, or more leaves than can be numbered.
    fn and(self, leaf: u32) -> Option<Self> {
        let used = (u128::BITS - self.0.leading_zeros()).div_ceil(BITS);
        let number = u16::try_from(leaf + 1).ok().filter(|_| used < MOST_SPECTRA)?;
        Some(Self(self.0 | u128::from(number) << (used * BITS)))
    }

    /// The leaves, from the place where the ray began.
    pub(crate) fn leaves(self) -> impl DoubleEndedIterator<Item = u32> {
        let number = move |place: u32| self.0 >> (place * BITS) & u128::from(u16::MAX);
        (0..MOST_SPECTRA).map(number).filter_map(|n| u32::try_from(n).ok()?.checked_sub(1))
    }
}

/// Where a ray ends.
#[derive(Clone, Copy, Debug)]
pub(crate) struct End {
    pub(crate) hit: Hit,
    /// The unit vector along which it came.
    pub(crate) direction: DVec3,
    /// What of the light from there arrives, but for spectra.
    pub(crate) weight: f64,
    pub(crate) tint: Tint,
    /// Whether it met a mirror or glass on its way.
    pub(crate) bent: bool,
}

/// A scene with mirrors or glass, for rays between surfaces.
pub(super) struct Specular<'w> {
    whitted: &'w Whitted,
    /// Patches as in the solution, with the same numbers of primitives; mirrors and glass as they are.
    world: World,
    /// Choices between reflection and refraction.
    choices: SobolSequence,
}

/// A ray under way.
struct Way<'w> {
    ray: Ray,
    direction: DVec3,
    weight: f64,
    tint: Tint,
    /// What it is inside of.
    interior: Option<&'w Dielectric>,
}

impl<'w> Specular<'w> {
    /// `None` for scenes without mirrors and glass.
    pub(super) fn new(scene: &Scene, whitted: &'w Whitted) -> Option<Self> {
        let shapes = in_order(scene);
        if shapes.iter().all(|(kind, ..)| *kind == Kind::Patches) {
            return None;
        }
        let surface = |(kind, number, shape): &(Kind, u32, &Shape)| match kind {
            Kind::Patches => (*number, tessellated(&shape.geometry).0),
            Kind::Flat | Kind::Round | Kind::Clear => (*number, surface(&shape.geometry)),
        };
        let surfaces: Vec<_> = shapes.iter().map(surface).collect();
        // Whatever is refused was refused before.
        let world = World::new(&surfaces).ok()?;
        Some(Self { whitted, world, choices: SobolSequence::new(0) })
    }

    /// Follows the ray with this number: see [`follow`].
    pub(super) fn follow(&self, ray: Ray, number: u32) -> Option<End> {
        follow((self.whitted, &self.world), &self.choices, ray, number)
    }
}

/// Follows the ray with this number through mirrors and glass of a world, whose shapes have the numbers of the scene's, to whatever else it
/// meets. At each boundary it is reflected or refracted, at 587.56 nm, by a choice that is the same for equal numbers.
pub(crate) fn follow(
    (whitted, world): (&Whitted, &World),
    choices: &SobolSequence,
    ray: Ray,
    number: u32,
) -> Option<End> {
    let direction = ray.direction.as_dvec3();
    let mut way = Way { ray, direction, weight: 1.0, tint: Tint::default(), interior: None };
    for boundary in 0..=MOST_BOUNDARIES {
        let hit = world.closest_hit(&way.ray)?;
        way.direction = way.ray.direction.as_dvec3().normalize_or_zero();
        let material = whitted.material(&hit);
        way.absorb(&hit, material);
        let choice = || f64::from(choices.point(number, boundary)[0]);
        match material {
            Some(Material::Mirror(factors)) => way.reflect(&hit, factors, choice())?,
            Some(Material::Dielectric(glass)) => way.cross(&hit, glass, choice())?,
            _ => {
                let Way { direction, weight, tint, .. } = way;
                return Some(End { hit, direction, weight, tint, bent: boundary > 0 });
            }
        }
    }
    None
}

impl<'w> Way<'w> {
    /// Leaves what is not absorbed up to a hit: by what is left there from inside, whatever was entered before.
    fn absorb(&mut self, hit: &Hit, material: Option<&'w Material>) {
        let medium = match material {
            Some(Material::Dielectric(glass)) if !hit.front => Some(&**glass),
            _ => self.interior,
        };
        if let Some(medium) = medium {
            let distance = f64::from((hit.position - self.ray.origin).length());
            self.weight *= medium.remaining(distance, MEAN_WAVELENGTH);
        }
    }

    /// Multiplies its light; `None` if nothing is left, or too much to be remembered.
    fn times(&mut self, factor: Factor) -> Option<()> {
        self.weight *= factor.scale;
        if let Some(leaf) = factor.leaf {
            self.tint = self.tint.and(leaf)?;
        }
        (self.weight > 0.0).then_some(())
    }

    /// At a mirror: between the two factors that are known for angles nearby, it chooses.
    fn reflect(&mut self, hit: &Hit, factors: &[Factor], choice: f64) -> Option<()> {
        let cosine = -self.direction.dot(receiver(hit).normal);
        let [(factor, share), (other, _)] = mirror_factors(factors, cosine);
        self.times(if choice < share { factor } else { other })?;
        self.ray = mirror_ray(hit, self.direction);
        Some(())
    }

    /// At a boundary of transparent media.
    fn cross(&mut self, hit: &Hit, glass: &'w Dielectric, choice: f64) -> Option<()> {
        let (share, refracted) = boundary(glass, hit, self.direction, MEAN_WAVELENGTH);
        match refracted.filter(|_| choice >= share) {
            Some(onward) => {
                self.times(glass.transmittance)?;
                self.interior = hit.front.then_some(glass);
                self.ray = hit.point().ray(onward.as_vec3a());
            }
            None => {
                self.times(glass.reflectance)?;
                self.interior = if hit.front { self.interior } else { Some(glass) };
                self.ray = mirror_ray(hit, self.direction);
            }
        }
        Some(())
    }
}
