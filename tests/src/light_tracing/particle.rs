//! One particle after the other through mirrors and glass.

use renderers::geometry::glam::DVec3;
use renderers::geometry::{Hit, Ray};
use renderers::scene::{BsdfId, SpectrumId};

use super::surface::{Side, dielectric, metal};
use super::waves::Waves;
use super::{Balance, Landing, LightTracer, single};
use crate::statistics::Rng;

/// Particles that meet more boundaries are given up.
const MOST_BOUNDARIES: u32 = 1000;
/// Media inside each other.
const MOST_MEDIA: usize = 8;

/// The shapes whose insides a particle is in, in the order of entering; more than [`MOST_MEDIA`] are forgotten.
#[derive(Clone, Copy, Debug, Default)]
struct Media {
    shapes: [u32; MOST_MEDIA],
    count: usize,
}

impl Media {
    fn innermost(&self) -> Option<u32> {
        self.shapes[..self.count].last().copied()
    }

    fn enter(&mut self, shape: u32) {
        if self.count < MOST_MEDIA {
            self.shapes[self.count] = shape;
            self.count += 1;
        }
    }

    fn leave(&mut self, shape: u32) {
        let inside = &self.shapes[..self.count];
        // Bodies may be made of several shapes: then it is the last one entered that is left.
        let Some(place) = inside.iter().rposition(|s| *s == shape).or(self.count.checked_sub(1)) else { return };
        self.shapes.copy_within(place + 1..self.count, place);
        self.count -= 1;
    }
}

/// Flux on its way.
#[derive(Clone, Debug)]
pub(super) struct Particle<const W: usize> {
    ray: Ray,
    /// Unit vector.
    direction: DVec3,
    flux: [f64; W],
    /// The wavelength of which alone it has some, if that is so.
    only: Option<usize>,
    specular: u32,
    media: Media,
}

impl<const W: usize> Particle<W> {
    pub(super) fn new(ray: Ray, direction: DVec3, flux: [f64; W]) -> Self {
        let only = (W == 1).then_some(0);
        Self { ray, direction, flux, only, specular: 0, media: Media::default() }
    }

    /// The part of one wavelength.
    fn part(&self, wave: usize) -> Self {
        let flux = core::array::from_fn(|k| if k == wave { self.flux[k] } else { 0.0 });
        Self { flux, only: Some(wave), ..self.clone() }
    }
}

/// Where a particle meets a surface: unit vectors on the side that it comes to.
struct Place<'h> {
    hit: &'h Hit,
    geometric: DVec3,
    shading: DVec3,
}

impl<'h> Place<'h> {
    fn new(hit: &'h Hit) -> Self {
        let side = if hit.front { 1.0 } else { -1.0 };
        Self { hit, geometric: hit.geometric_normal.as_dvec3() * side, shading: hit.shading_normal.as_dvec3() * side }
    }

    /// The factor of the adjoint, where the shading normal isn't the geometric one; `None` for a direction on the wrong side.
    fn bending(&self, direction: DVec3, onward: DVec3, reflected: bool) -> Option<f64> {
        let side = if reflected { 1.0 } else { -1.0 };
        let leaving = side * onward.dot(self.geometric);
        if leaving <= 0.0 {
            return None;
        }
        if self.hit.geometric_normal == self.hit.shading_normal {
            return Some(1.0);
        }
        let cosines = direction.dot(self.shading) * leaving;
        let factor = (cosines / (direction.dot(self.geometric) * onward.dot(self.shading))).abs();
        factor.is_finite().then_some(factor)
    }
}

/// A side of glass.
#[derive(Clone, Copy)]
struct Boundary {
    bsdf: BsdfId,
    factors: [SpectrumId; 2],
    disperses: bool,
}

/// The particles of a batch, and what becomes of them.
pub(super) struct Walk<'w, const W: usize, F> {
    tracer: &'w LightTracer<'w>,
    waves: &'w Waves<W>,
    landed: F,
    /// Parts of split particles that wait.
    waiting: Vec<Particle<W>>,
    balance: Balance,
}

#[allow(clippy::cast_precision_loss, reason = "a few wavelengths")]
fn total<const W: usize>(flux: &[f64; W]) -> f64 {
    flux.iter().sum::<f64>() / W as f64
}

impl<'w, const W: usize, F: FnMut(&Landing<W>)> Walk<'w, W, F> {
    pub(super) fn new(tracer: &'w LightTracer<'w>, waves: &'w Waves<W>, landed: F) -> Self {
        Self { tracer, waves, landed, waiting: Vec::new(), balance: Balance::default() }
    }

    pub(super) fn balance(&self) -> Balance {
        self.balance
    }

    /// Follows a particle, and all that it splits into, to their ends.
    pub(super) fn follow(&mut self, start: Particle<W>, random: &mut Rng) {
        self.balance.emitted += total(&start.flux);
        self.waiting.push(start);
        while let Some(mut particle) = self.waiting.pop() {
            while let Some(next) = self.step(particle, random) {
                particle = next;
            }
        }
    }

    /// One way, and what happens at its end; `None` if nothing goes on there.
    fn step(&mut self, mut particle: Particle<W>, random: &mut Rng) -> Option<Particle<W>> {
        let Some(hit) = self.tracer.world.closest_hit(&particle.ray) else {
            self.balance.escaped += total(&particle.flux);
            return None;
        };
        self.absorb(&mut particle, &hit);
        let place = Place::new(&hit);
        match self.tracer.sides[hit.shape as usize][usize::from(!hit.front)] {
            Side::Black => {
                self.balance.absorbed += total(&particle.flux);
                None
            }
            Side::Diffuse(reflectance) => {
                self.land(&particle, &place, reflectance);
                None
            }
            _ if particle.specular == MOST_BOUNDARIES => self.lose(&particle),
            Side::Mirror { metal, factor } => self.mirror(particle, &place, metal, factor),
            Side::Glass { bsdf, factors, disperses, .. } => {
                self.glass(particle, &place, Boundary { bsdf, factors, disperses }, random)
            }
        }
    }

    fn lose(&mut self, particle: &Particle<W>) -> Option<Particle<W>> {
        self.balance.lost += total(&particle.flux);
        None
    }

    fn land(&mut self, particle: &Particle<W>, place: &Place<'_>, reflectance: SpectrumId) {
        let flux = total(&particle.flux);
        *(if particle.specular > 0 { &mut self.balance.caustic } else { &mut self.balance.direct }) += flux;
        (self.landed)(&Landing {
            shape: place.hit.shape,
            point: place.hit.point(),
            direction: particle.direction,
            normals: [place.geometric, place.shading],
            reflectance: *self.waves.spectrum(reflectance),
            specular: particle.specular,
            flux: particle.flux,
        });
    }

    /// What the medium on the way took.
    fn absorb(&mut self, particle: &mut Particle<W>, hit: &Hit) {
        let Some(shape) = particle.media.innermost() else { return };
        let inside = self.tracer.sides[shape as usize][0];
        let Side::Glass { absorption: Some(absorption), .. } = inside else { return };
        let way = f64::from((hit.position - particle.ray.origin).length());
        let remains = self.waves.spectrum(absorption).map(|a| (-a * way).exp());
        self.multiply(particle, |k| remains[k]);
    }

    /// Multiplies by what remains; the rest is absorbed.
    fn multiply(&mut self, particle: &mut Particle<W>, remains: impl Fn(usize) -> f64) {
        let before = total(&particle.flux);
        particle.flux = core::array::from_fn(|k| particle.flux[k] * remains(k));
        self.balance.absorbed += before - total(&particle.flux);
    }

    fn mirror(
        &mut self,
        mut particle: Particle<W>,
        place: &Place<'_>,
        metallic: Option<BsdfId>,
        factor: SpectrumId,
    ) -> Option<Particle<W>> {
        let cosine = -particle.direction.dot(place.shading);
        let waves = self.waves;
        let factor = waves.spectrum(factor);
        self.multiply(&mut particle, |k| match metallic {
            None => factor[k],
            Some(bsdf) => {
                let [n, kappa] = waves.indices(bsdf.0);
                factor[k] * metal(cosine.clamp(0.0, 1.0), n[k], kappa[k])
            }
        });
        self.reflect(particle, place)
    }

    fn reflect(&mut self, particle: Particle<W>, place: &Place<'_>) -> Option<Particle<W>> {
        let onward = particle.direction - place.shading * (2.0 * particle.direction.dot(place.shading));
        self.go_on(particle, place, onward, true)
    }

    /// Reflects or refracts; a particle that still has several wavelengths splits where these go different ways.
    fn glass(
        &mut self,
        mut particle: Particle<W>,
        place: &Place<'_>,
        boundary: Boundary,
        random: &mut Rng,
    ) -> Option<Particle<W>> {
        if boundary.disperses && particle.only.is_none() {
            for wave in 0..W {
                let part = particle.part(wave);
                let next = if total(&part.flux) > 0.0 { self.glass(part, place, boundary, random) } else { None };
                self.waiting.extend(next);
            }
            return None;
        }
        let [relative, _] = self.waves.indices(boundary.bsdf.0);
        let relative = relative[particle.only.unwrap_or(0)];
        let index = if place.hit.front { relative } else { 1.0 / relative };
        let cosine = (-particle.direction.dot(place.shading)).clamp(0.0, 1.0);
        let [reflects, transmits] = boundary.factors.map(|id| self.waves.spectrum(id));
        match dielectric(cosine, index) {
            Some([share, refracted]) if random.unit() >= share => {
                self.multiply(&mut particle, |k| transmits[k]);
                let onward = particle.direction / index + place.shading * (cosine / index - refracted);
                if place.hit.front {
                    particle.media.enter(place.hit.shape);
                } else {
                    particle.media.leave(place.hit.shape);
                }
                self.go_on(particle, place, onward.normalize_or_zero(), false)
            }
            _ => {
                self.multiply(&mut particle, |k| reflects[k]);
                self.reflect(particle, place)
            }
        }
    }

    fn go_on(
        &mut self,
        mut particle: Particle<W>,
        place: &Place<'_>,
        onward: DVec3,
        reflected: bool,
    ) -> Option<Particle<W>> {
        let Some(factor) = place.bending(particle.direction, onward, reflected) else { return self.lose(&particle) };
        if factor != 1.0 {
            let before = total(&particle.flux);
            particle.flux = particle.flux.map(|f| f * factor);
            self.balance.bent += total(&particle.flux) - before;
        }
        let ray = place.hit.point().ray(single(onward));
        Some(Particle { ray, direction: onward, specular: particle.specular + 1, ..particle })
    }
}
