//! Places that are seen through boundaries at which wavelengths part: what diffuse surfaces look like there is found once.
//!
//! At another wavelength, the same way through a body ends somewhat beside the place where it ended at the first. As long as that is less than a
//! part of what one pixel sees there, it can't be told from the same place: only how much of the light comes through is the wavelength's own. How
//! much a pixel sees is found by two rays through its neighbours' middles that take the same reflections and refractions, at one wavelength: so
//! it counts, too, what curved bodies magnify.

use glam::DVec3;

use super::refraction::Interface;
use super::{Path, Worker};
use crate::direct::single;
use crate::geometry::{Hit, Ray};
use crate::spectral::{Band, Radiance};

/// The part of a pixel, times the share of the light that comes that way, by which a place may be off.
const SAME: f64 = 0.25;

/// The share of the light that a way must have for neighbouring pixels to be looked at.
const LEAST_SHARE: f64 = 0.02;

/// How many pixels before a surface neighbouring rays start: those that meet it at a slant meet it earlier.
const BEFORE: f64 = 16.0;

/// The cosine of normals on the same part of a surface: they differ by less than 8°.
pub(super) const LEAST_COSINE: f32 = 0.99;

/// The way of a path that has met no boundary since it was deferred.
pub(super) const ROOT: u32 = 1;

/// A way that goes on by reflection (0) or refraction (1).
pub(super) const fn branch(from: u32, way: u32) -> u32 {
    from.rotate_left(1).wrapping_mul(0x9e37_79b1) ^ way
}

/// The deferred light that is being followed, and what it counts for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Followed {
    pub(super) number: usize,
    pub(super) weight: f64,
}

/// A place on a diffuse surface, and the way that leads there.
#[derive(Clone, Debug)]
pub(super) struct Place {
    followed: usize,
    branch: u32,
    hit: Hit,
    /// What it looks like, times this weight.
    light: Radiance,
    weight: f64,
    /// The standard errors of that.
    noise: Radiance,
    /// Where neighbouring pixels' rays come to by the same way, from here.
    steps: [Option<DVec3>; 2],
}

/// Where a ray of a neighbouring pixel comes to.
#[derive(Clone, Copy, Debug)]
pub(super) struct Neighbour {
    branch: u32,
    hit: Hit,
}

impl Place {
    /// Whether another place is on the same part of the same surface.
    fn is_beside(&self, hit: &Hit) -> bool {
        is_on_the_same(&self.hit, hit)
    }

    /// How far another place is, in pixels; without neighbours, in sizes of a pixel if nothing magnifies.
    fn pixels_to(&self, hit: &Hit, pixel: f64) -> f64 {
        let offset = (hit.position - self.hit.position).as_dvec3();
        match self.steps {
            [Some(a), Some(b)] => {
                let [aa, ab, bb] = [a.dot(a), a.dot(b), b.dot(b)];
                let [x, y] = [offset.dot(a), offset.dot(b)];
                let determinant = aa * bb - ab * ab;
                let [s, t] = [x * bb - y * ab, y * aa - x * ab].map(|d| d / determinant);
                s.hypot(t)
            }
            [Some(step), None] | [None, Some(step)] => offset.length() / step.length(),
            [None, None] => offset.length() / pixel,
        }
    }
}

fn is_on_the_same(a: &Hit, b: &Hit) -> bool {
    a.shape == b.shape
        && a.front == b.front
        && a.geometric_normal.dot(b.geometric_normal) >= LEAST_COSINE
        && a.shading_normal.dot(b.shading_normal) >= LEAST_COSINE
}

impl Worker<'_> {
    /// Adds what a diffuse surface looks like that was met by a way through boundaries.
    pub(super) fn seen(&mut self, hit: &Hit, direction: DVec3, (path, band): (Path, Band), radiance: &mut Radiance) {
        let Some(Followed { number, weight }) = self.followed else { return };
        if !(path.weight > 0.0) {
            return;
        }
        let share = path.weight / weight;
        let pixel = self.scene.pixel_angle * path.length;
        let is_same = |place: &Place| {
            place.followed == number
                && place.branch == path.branch
                && place.is_beside(hit)
                && place.pixels_to(hit, pixel) * share <= SAME
        };
        let known = self.places.iter().position(is_same).unwrap_or_else(|| {
            let of_the_way = |place: &&Place| place.followed == number && place.branch == path.branch;
            let steps = self.places.iter().find(of_the_way).map_or([None; 2], |place| place.steps);
            let unit = Path { monomial: crate::spectral::Monomial::default(), band: None, ..path };
            let mut light = Radiance::default();
            let before = core::mem::take(&mut self.noise);
            self.scatter(hit, direction, unit, &mut light);
            let noise = core::mem::replace(&mut self.noise, before);
            let (branch, weight) = (path.branch, path.weight);
            self.places.push(Place { followed: number, branch, hit: *hit, light, weight, noise, steps });
            self.places.len() - 1
        });
        let (light, weight, noise) = match self.places.get_mut(known) {
            Some(place) => (core::mem::take(&mut place.light), place.weight, core::mem::take(&mut place.noise)),
            None => return,
        };
        if !self.is_preparing {
            let share = self.noise_share(Some(band)) * path.weight / weight;
            for (monomial, error) in noise.terms() {
                self.noise.add(self.monomials.product(path.monomial, *monomial), share * error);
            }
        }
        self.add_for(band, &light, Path { weight: path.weight / weight, ..path }, radiance);
        if let Some(place) = self.places.get_mut(known) {
            place.light = light;
            place.noise = noise;
        }
    }

    /// Adds light times a path's products and weight, what is deferred in it for some waves.
    pub(super) fn add_for(&mut self, band: Band, light: &Radiance, by: Path, radiance: &mut Radiance) {
        for (monomial, weight) in light.terms() {
            let product = self.monomials.product(by.monomial, *monomial);
            radiance.add(product, by.weight * weight);
        }
        for (gathered, monomial, weight) in light.gathered() {
            let product = self.monomials.product(by.monomial, *monomial);
            radiance.gather(*gathered, product, by.weight * weight);
        }
        for (deferred, monomial, weight) in light.deferred() {
            let inner = self.expand(deferred.0 as usize, band);
            let product = self.monomials.product(by.monomial, *monomial);
            self.add_product(&inner, Path { monomial: product, weight: by.weight * weight, ..by }, radiance);
        }
    }

    /// Follows deferred light at the wavelength that light between surfaces is gathered for, before it is asked for at any other, so that what
    /// is seen doesn't depend on which are asked for first.
    pub(super) fn prepare(&mut self, number: usize, interface: &Interface, band: Band) {
        if self.prepared.iter().any(|(known, _)| *known == number) {
            return;
        }
        let was_preparing = core::mem::replace(&mut self.is_preparing, true);
        // Bodies within sight of each other are prepared on the way.
        self.prepared.push((number, Radiance::default()));
        let light = self.expand_boundary(number, interface, band);
        self.is_preparing = was_preparing;
        if let Some((_, gathered)) = self.prepared.iter_mut().find(|(known, _)| *known == number) {
            *gathered = light;
        }
        if !matches!(self.between, super::Between::Noted(_)) && !interface.path.scattered {
            self.look_beside(number, interface, band);
        }
    }

    /// The light between surfaces in deferred light.
    pub(super) fn gathered(&mut self, number: usize) -> Radiance {
        self.prepared
            .iter()
            .find(|(known, _)| *known == number)
            .map_or_else(Radiance::default, |(_, light)| light.clone())
    }

    /// Finds how much the pixel sees of each place.
    fn look_beside(&mut self, number: usize, interface: &Interface, band: Band) {
        let (u, v) = interface.direction.any_orthonormal_pair();
        for (place, across) in [u, v].into_iter().enumerate() {
            let was = self.beside.replace(Vec::new());
            self.beside(number, interface, across, band);
            let found = core::mem::replace(&mut self.beside, was).unwrap_or_default();
            for known in self.places.iter_mut().filter(|known| known.followed == number) {
                let same = |n: &&Neighbour| n.branch == known.branch && is_on_the_same(&n.hit, &known.hit);
                let step = found.iter().find(same).map(|n| (n.hit.position - known.hit.position).as_dvec3());
                known.steps[place] = step;
            }
        }
    }

    /// Follows the ray of a pixel beside, from shortly before the boundary that the pixel's own met.
    fn beside(&mut self, number: usize, interface: &Interface, across: DVec3, band: Band) {
        let Interface { hit, direction, path, .. } = interface;
        let pixel = self.scene.pixel_angle * path.length;
        let place = hit.position.as_dvec3() + across * pixel;
        let eye = hit.position.as_dvec3() - *direction * path.length;
        let onward = (place - eye).normalize_or_zero();
        let ray = Ray::new(single(place - onward * (BEFORE * pixel).min(0.5 * path.length)), single(onward));
        self.rays += 1;
        let Some(met) = self.scene.world.closest_hit(&ray) else { return };
        if met.shape != hit.shape || met.front != hit.front {
            return;
        }
        let least = (LEAST_SHARE * path.weight).max(path.least);
        let beside =
            Interface { hit: met, direction: onward, reflected: Radiance::default(), path: Path { least, ..*path } };
        self.expand_boundary(number, &beside, band);
    }
}

impl Neighbour {
    pub(super) const fn new(branch: u32, hit: Hit) -> Self {
        Self { branch, hit }
    }
}
