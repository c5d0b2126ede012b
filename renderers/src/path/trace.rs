//! One path after the other from the eye: light is looked for at every surface, in two ways that are weighted against each other.

use glam::DVec3;

use super::carrier::{Carrier, unit_48};
use super::light::{End, Towards};
use super::scatter::{Scattered, Scatterer};
use super::{PathTracer, Paths, Strategy};
use crate::direct::power_heuristic;
use crate::direct::{Receiver, single};
use crate::geometry::sampling::SobolSequence;
use crate::geometry::{Hit, Ray};
use crate::material::{Dielectric, Material, mirror_factors};
use crate::spectral::MEAN_WAVELENGTH;
use crate::whitted::{boundary, mirror_ray, receiver};

/// Paths go on with this probability at most once they may end.
const MOST_LIKELY: f64 = 0.95;

/// Where it isn't known yet which wavelength counts, each way out of a dispersive boundary is taken at least so often: at some wavelengths
/// there may be light in it.
const LEAST_LIKELY: f64 = 0.1;

/// Two-dimensional point sets of a path: one for the pixel's filter, one for the wavelength, then for each segment those of [`Vertex`].
const OF_CAMERA: u32 = 0;
const OF_WAVELENGTH: u32 = 1;
const FIRST_VERTEX: u32 = 2;
const EACH_VERTEX: u32 = 4;

/// The random numbers of one path.
#[derive(Clone, Copy, Debug)]
pub(super) struct Points {
    pub(super) sequence: SobolSequence,
    pub(super) index: u32,
}

/// What the point sets of a path's vertex are for.
#[derive(Clone, Copy, Debug)]
enum Vertex {
    Light = 0,
    OnLight = 1,
    Direction = 2,
    /// The first number says whether the path goes on, the second which part of a material it takes.
    Survival = 3,
}

impl Points {
    /// Where on the film.
    pub(super) fn camera(&self) -> [f32; 2] {
        self.sequence.point(self.index, OF_CAMERA)
    }

    fn wavelength(&self) -> [f32; 2] {
        self.sequence.point(self.index, OF_WAVELENGTH)
    }

    fn vertex(&self, segment: u32, set: Vertex) -> [f32; 2] {
        let dimension = segment.wrapping_mul(EACH_VERTEX).wrapping_add(FIRST_VERTEX + set as u32);
        self.sequence.point(self.index, dimension)
    }
}

/// Where a path is.
#[derive(Clone, Copy, Debug)]
struct State {
    ray: Ray,
    /// Segments from the eye, this one included.
    segment: u32,
    /// The way's length counts for absorption by the interior of this shape.
    interior: Option<u32>,
    /// The square of the index of the medium that the path is in, relative to the eye's.
    index2: f64,
    /// How this segment was chosen; `None` if it couldn't be otherwise.
    chosen: Option<Chosen>,
    met: Met,
}

/// What a path from the eye has met.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Met {
    Nothing,
    /// One surface that scatters, and nothing before it.
    Scatterer,
    /// That, then mirrors and smooth boundaries alone: where it ends on a light, it is a caustic seen directly.
    Specular,
    /// Anything else.
    More,
}

impl Met {
    /// After one surface more, which scattered into a solid angle or not.
    const fn then(self, scatters: bool) -> Self {
        match (self, scatters) {
            (Self::Nothing, true) => Self::Scatterer,
            (Self::Scatterer | Self::Specular, false) => Self::Specular,
            _ => Self::More,
        }
    }
}

/// A direction that was chosen from a solid angle.
#[derive(Clone, Copy, Debug)]
struct Chosen {
    position: DVec3,
    normal: DVec3,
    density: f64,
}

/// Traces paths, and counts rays.
#[derive(Debug)]
pub(super) struct Walk<'s> {
    scene: &'s PathTracer,
    rays: u64,
}

impl<'s> Walk<'s> {
    pub(super) const fn new(scene: &'s PathTracer) -> Self {
        Self { scene, rays: 0 }
    }

    /// All rays traced, shadow rays included.
    pub(super) const fn rays(&self) -> u64 {
        self.rays
    }

    /// Follows one path from the eye and leaves its light with the carrier.
    pub(super) fn path(&mut self, ray: Ray, points: Points, carrier: &mut impl Carrier) {
        carrier.start(points.wavelength());
        let settings = self.scene.settings;
        if settings.max_depth == Some(0) {
            return;
        }
        let mut state = State { ray, segment: 1, interior: None, index2: 1.0, chosen: None, met: Met::Nothing };
        while let Some(next) = self.segment(&state, points, carrier) {
            if next.segment > settings.rr_depth && !self.survives(&next, points, carrier) {
                return;
            }
            state = next;
        }
    }

    /// Whether a path goes on: as likely as its light counts, and then it counts the more.
    fn survives(&self, state: &State, points: Points, carrier: &mut impl Carrier) -> bool {
        let likely = (carrier.strength(self.scene.steering.paths) * state.index2).min(MOST_LIKELY);
        let [u, _] = points.vertex(state.segment - 1, Vertex::Survival);
        if f64::from(u) < likely {
            carrier.scale(1.0 / likely);
            true
        } else {
            false
        }
    }

    /// One segment: the light that it ends on, the light that reaches its end directly, and how the path goes on.
    fn segment(&mut self, state: &State, points: Points, carrier: &mut impl Carrier) -> Option<State> {
        self.rays += 1;
        let direction = state.ray.direction.as_dvec3().normalize_or_zero();
        let Some(hit) = self.scene.world.closest_hit(&state.ray) else {
            self.leaves_scene(state, direction, carrier);
            return None;
        };
        let surface = self.scene.surfaces.get(hit.shape as usize)?;
        self.absorb(state, &hit, carrier);
        let left_out = self.scene.paths == Paths::WithoutCaustics && state.met == Met::Specular;
        if let (Some(emission), true, false) = (surface.emission, hit.front, left_out) {
            let density = |c: &Chosen| self.scene.lights.density(c.position, &hit);
            let weight = self.weight_of_found(state.chosen.as_ref(), density);
            carrier.gather(&[(None, 1.0)], emission, weight);
        }
        if self.scene.settings.max_depth.is_some_and(|most| state.segment >= most) {
            return None;
        }
        let next = State { segment: state.segment + 1, chosen: None, met: state.met.then(false), ..*state };
        match surface.material.side(hit.front)? {
            Material::Mirror(factors) => {
                let cosine = -direction.dot(receiver(&hit).normal);
                carrier.multiply(&mirror_factors(factors, cosine).map(|(factor, share)| (Some(factor), share)));
                Some(State { ray: mirror_ray(&hit, direction), ..next })
            }
            Material::Dielectric(dielectric) => {
                let [_, lobe] = points.vertex(state.segment, Vertex::Survival);
                dielectric_step(&hit, direction, dielectric, f64::from(lobe), next, carrier)
            }
            material => {
                let receiver = receiver(&hit);
                let (scatterer, factor) = Scatterer::new(material, &receiver, surface.frame(&hit), -direction)?;
                if factor.is_some() {
                    carrier.multiply(&[(factor, 1.0)]);
                }
                let next = self.scatter(&scatterer, &receiver, next, points, carrier)?;
                Some(State { met: state.met.then(next.chosen.is_some()), ..next })
            }
        }
    }

    /// The light of the environment.
    fn leaves_scene(&self, state: &State, direction: DVec3, carrier: &mut impl Carrier) {
        if let Some(radiance) = self.scene.lights.environment() {
            let density = |c: &Chosen| self.scene.lights.environment_density(c.normal, direction);
            let weight = self.weight_of_found(state.chosen.as_ref(), density);
            carrier.gather(&[(None, 1.0)], radiance, weight);
        }
    }

    /// The weight of light that a path came upon, which might have been looked for with a density.
    fn weight_of_found(&self, chosen: Option<&Chosen>, density: impl Fn(&Chosen) -> f64) -> f64 {
        match (chosen, self.scene.strategy) {
            (None, _) | (_, Strategy::Scattering) => 1.0,
            (_, Strategy::Lights) => 0.0,
            (Some(chosen), Strategy::Both) => power_heuristic(chosen.density, density(chosen)),
        }
    }

    /// The path's light after its way through the medium it is in: what it leaves from inside, or else what it entered last.
    fn absorb(&self, state: &State, hit: &Hit, carrier: &mut impl Carrier) {
        let medium = |shape: u32| match self.scene.surfaces.get(shape as usize).map(|s| &s.material) {
            Some(Material::Dielectric(medium)) => Some(medium),
            _ => None,
        };
        let left = if hit.front { None } else { medium(hit.shape) };
        let Some(medium) = left.or_else(|| medium(state.interior?)) else { return };
        let distance = f64::from((hit.position - state.ray.origin).length());
        match medium.absorbs_evenly() {
            None => {}
            Some(true) => carrier.scale(medium.remaining(distance, 0.0)),
            Some(false) => carrier.multiply_by(&|wavelength| medium.remaining(distance, wavelength)),
        }
    }

    /// Light looked for, then a direction chosen, at a surface that scatters.
    fn scatter(
        &mut self,
        scatterer: &Scatterer<'_>,
        receiver: &Receiver,
        next: State,
        points: Points,
        carrier: &mut impl Carrier,
    ) -> Option<State> {
        let vertex = |set| points.vertex(next.segment - 1, set);
        let choice = unit_48(vertex(Vertex::Light));
        if let Some(towards) = self.scene.lights.towards(receiver, choice, vertex(Vertex::OnLight)) {
            self.look_for(&towards, receiver, scatterer, carrier);
        }
        let [_, lobe] = vertex(Vertex::Survival);
        let Scattered { direction, terms, density } = scatterer.sample(f64::from(lobe), vertex(Vertex::Direction))?;
        carrier.multiply(terms_of(&terms));
        let Receiver { position, normal, .. } = *receiver;
        let chosen = density.map(|density| Chosen { position, normal, density });
        Some(State { ray: receiver.point.ray(single(direction)), chosen, ..next })
    }

    /// Gathers the light of a direction to a light, if nothing is in the way.
    fn look_for(
        &mut self,
        light: &Towards,
        receiver: &Receiver,
        scatterer: &Scatterer<'_>,
        carrier: &mut impl Carrier,
    ) {
        let Some((terms, density)) = scatterer.evaluate(light.direction) else { return };
        let weight = match (light.density, self.scene.strategy) {
            (None, _) | (_, Strategy::Lights) => 1.0,
            (_, Strategy::Scattering) => return,
            (Some(looked), Strategy::Both) => power_heuristic(looked, density),
        };
        self.rays += 1;
        let world = &self.scene.world;
        let hidden = match &light.end {
            End::Surface(point) => world.occluded(&receiver.point, point),
            End::Point(point) => world.occluded_point(&receiver.point, *point),
            End::Infinity => world.occluded_direction(&receiver.point, single(light.direction)),
        };
        if !hidden {
            carrier.gather(terms_of(&terms), light.factor, weight * light.weight);
        }
    }
}

/// The first term alone where there is no second one.
fn terms_of(terms: &super::scatter::Terms) -> &[super::carrier::Term] {
    if terms[1].1 == 0.0 { &terms[..1] } else { terms }
}

/// Reflection or refraction at a smooth boundary.
fn dielectric_step(
    hit: &Hit,
    direction: DVec3,
    dielectric: &Dielectric,
    lobe: f64,
    next: State,
    carrier: &mut impl Carrier,
) -> Option<State> {
    let known = if dielectric.has_constant_index() { Some(MEAN_WAVELENGTH) } else { carrier.wavelength() };
    let interior = if hit.front { next.interior } else { Some(hit.shape) };
    let mirrored = State { ray: mirror_ray(hit, direction), interior, ..next };
    if let Some(wavelength) = known {
        let (share, refracted) = boundary(dielectric, hit, direction, wavelength);
        if lobe < share || refracted.is_none() {
            carrier.multiply(&[(Some(dielectric.reflectance), 1.0)]);
            return Some(mirrored);
        }
        return Some(refract(hit, refracted?, dielectric, wavelength, next, carrier));
    }
    let likely = boundary(dielectric, hit, direction, MEAN_WAVELENGTH).0.clamp(LEAST_LIKELY, 1.0 - LEAST_LIKELY);
    if lobe < likely {
        carrier.multiply(&[(Some(dielectric.reflectance), 1.0 / likely)]);
        carrier.multiply_by(&|wavelength| boundary(dielectric, hit, direction, wavelength).0);
        return Some(mirrored);
    }
    let wavelength = carrier.choose_wavelength();
    let (share, refracted) = boundary(dielectric, hit, direction, wavelength);
    let refracted = refracted?;
    carrier.scale((1.0 - share) / (1.0 - likely));
    Some(refract(hit, refracted, dielectric, wavelength, next, carrier))
}

/// Goes on behind a boundary, where radiance is larger by the square of the relative index.
fn refract(
    hit: &Hit,
    onward: DVec3,
    dielectric: &Dielectric,
    wavelength: f64,
    next: State,
    carrier: &mut impl Carrier,
) -> State {
    let relative = dielectric.relative_index(wavelength);
    let index2 = if hit.front { relative * relative } else { 1.0 / (relative * relative) };
    carrier.multiply(&[(Some(dielectric.transmittance), 1.0 / index2)]);
    let interior = hit.front.then_some(hit.shape);
    State { ray: hit.point().ray(single(onward)), interior, index2: next.index2 * index2, ..next }
}
