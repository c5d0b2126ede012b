//! The density of photons about a point.

use core::f64::consts::PI;
use core::fmt;

use glam::DVec2;

use super::Photon;
use super::extent::Face;
use super::footprints::Footprint;
use super::kernel::Kernel;
use super::map::{Near, PhotonMap, Region};

/// Radii that are compared, each √2 times the next: the smallest has a 2¹⁵th of the area.
const LEVELS: usize = 16;
/// A radius with fewer photons (if they were as dense everywhere) is not looked at: its estimate says little.
const FEWEST: usize = 12;
/// Coordinates are known to this share of themselves: photons closer to each other can't be told apart.
const RESOLUTION: f32 = 1e-6;
/// The least radius, in scene units: the inverse of its square is finite.
const LEAST_RADIUS: f32 = 1e-15;
/// The sine of the angle up to which photons count about a point of a curved surface: it may turn by 40° within the radius.
const SLOPE: f32 = 0.35;

/// How irradiance is estimated from photons.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Density {
    /// How photons count by their distance.
    pub(crate) kernel: Kernel,
    /// The radius is the distance to this one of the nearest photons, at least 2; if it's adaptive, at most.
    pub(crate) count: usize,
    /// The largest radius, in scene units; positive, may be infinite. None is below 1e-15, and 1e-6 times the largest coordinate of the point.
    pub(crate) radius: f32,
    /// How the radius is chosen.
    pub(crate) choice: Choice,
}

/// How the radius of an estimate is chosen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Choice {
    /// By the number of photons alone, as Iehl and Péroche do.
    Count,
    /// The largest of nested radii whose estimate agrees with those of all smaller ones (Lepski 1991): two estimates may differ by
    /// √(c² + 2 ln q) times the standard deviation of their difference, q being the ratio of their areas: the more a smaller radius would
    /// scatter, the less often is it taken by mistake. c is positive. Where irradiance is uniform and 50 to 800 photons are looked at, 2.5 adds
    /// some 5 % to the standard deviation, and a bias of less than 1 %.
    Agreement(f32),
}

impl Default for Density {
    /// Epanechnikov's kernel, at most 50 photons (as in the paper) at any distance, and an adaptive radius.
    fn default() -> Self {
        Self { kernel: Kernel::default(), count: 50, radius: f32::INFINITY, choice: Choice::Agreement(2.5) }
    }
}

/// Why settings are refused.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub(crate) enum DensityError {
    /// The number of photons.
    Count(usize),
    /// The largest radius.
    Radius(f32),
    /// The agreement asked for.
    Agreement(f32),
}

impl fmt::Display for DensityError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Count(count) => write!(f, "density is estimated from 2 photons or more, not {count}"),
            Self::Radius(radius) => write!(f, "the radius of photons must be positive, not {radius}"),
            Self::Agreement(bound) => write!(f, "the agreement of radii must be a positive number, not {bound}"),
        }
    }
}

impl core::error::Error for DensityError {}

/// A point of a surface.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Place<'a> {
    /// In scene units.
    pub(crate) position: [f32; 3],
    /// The unit geometric normal, on the side that is looked at; zero if it isn't known.
    pub(crate) normal: [f32; 3],
    /// The shape and its side, as [`surface`](super::surface) numbers them.
    pub(crate) surface: u32,
    /// The flat face that it is on; `None` on curved surfaces.
    pub(crate) face: Option<&'a Face>,
}

impl Place<'_> {
    /// Whether a photon comes from above the horizon: those that come from below that of a curved surface belong to other parts of it. All do where the
    /// horizon isn't known.
    pub(crate) fn sees(&self, photon: &Photon) -> bool {
        self.face.is_some() || self.normal == [0.0; 3] || dot(photon.direction, self.normal) > 0.0
    }
}

/// What the photons about a point say of its irradiance; to be used again and again, as it owns memory.
#[derive(Clone, Debug, Default)]
pub(crate) struct Estimate {
    near: Vec<Near>,
    weights: Vec<f32>,
    brightness: Vec<f32>,
    /// The estimate: the sum of weights times brightness, per square scene unit.
    pub(crate) value: f64,
    /// Its standard deviation if photons are independent, in the same unit. Of photons that low-discrepancy points threw it is a bound that
    /// is not reached.
    pub(crate) standard_error: f64,
    /// How much of the estimate is there because the density is not the same all over the kernel, in the same unit and with its sign: what
    /// noise doesn't explain of the difference to a smaller radius.
    pub(crate) bias: f64,
    /// The radius, in scene units; 0 if nothing was found. The mean of radii, by their flux, where photons have their own.
    pub(crate) radius: f32,
    /// Where photons have their own radii, the sums of squared contributions, and of weights times fluxes and these times radii.
    variance: f64,
    radii: [f64; 2],
}

impl Estimate {
    /// The photons that count, by their index in the map, with their weights per square scene unit: the irradiance is the sum of weights
    /// times fluxes.
    pub(crate) fn photons(&self) -> impl Iterator<Item = (u32, f32)> {
        self.near.iter().map(|near| near.photon).zip(self.weights.iter().copied())
    }

    /// The standard error over the value; 0 if nothing was found.
    pub(crate) fn relative_error(&self) -> f64 {
        if self.value > 0.0 { self.standard_error / self.value } else { 0.0 }
    }

    /// Notes how bright the photons found are: those from below the horizon of a curved surface are dark.
    fn look(&mut self, map: &PhotonMap, place: &Place<'_>, brightness: impl Fn(&Photon) -> f32) {
        for near in &self.near {
            let photon = &map.photons()[near.photon as usize];
            self.brightness.push(if place.sees(photon) { brightness(photon) } else { 0.0 });
        }
    }

    /// What each photon's contribution is multiplied by for its part of the error: the squares of these parts add up to that of the standard
    /// error and the bias together.
    pub(crate) fn error_of_a_photon(&self) -> f64 {
        if self.standard_error > 0.0 { (1.0 + (self.bias / self.standard_error).powi(2)).sqrt() } else { 0.0 }
    }

    /// What the error grows by if it has another part, in the unit of the estimate.
    pub(super) fn error_with(&self, part: f64) -> f64 {
        let squares = self.standard_error * self.standard_error + self.bias * self.bias;
        if squares > 0.0 { (1.0 + part * part / squares).sqrt() } else { 1.0 }
    }

    /// Adds a photon by its number, its weight, what its flux is worth and that flux, and how far it counts with which relative bias.
    pub(super) fn add(&mut self, photon: u32, weight: f32, (brightness, flux): (f32, f32), (radius, bias): (f32, f32)) {
        if !(weight > 0.0) {
            return;
        }
        self.near.push(Near { distance2: 0.0, photon });
        self.weights.push(weight);
        self.brightness.push(brightness);
        let contribution = f64::from(weight) * f64::from(brightness);
        self.value += contribution;
        self.variance += contribution * contribution;
        self.bias += contribution * f64::from(bias);
        let light = f64::from(weight) * f64::from(flux);
        self.radii = [self.radii[0] + light, self.radii[1] + light * f64::from(radius)];
    }

    /// The mean of the radii of all photons added, by their flux; 0 if there is none.
    #[allow(clippy::cast_possible_truncation, reason = "a mean of numbers of this size")]
    pub(super) fn mean_radius(&self) -> f32 {
        let [light, radii] = self.radii;
        if light > 0.0 { (radii / light) as f32 } else { 0.0 }
    }

    /// Multiplies all weights: nothing is added after that.
    #[allow(clippy::cast_possible_truncation, reason = "as precise as weights")]
    pub(super) fn finish(&mut self, scale: f64) {
        self.weights.iter_mut().for_each(|weight| *weight *= scale as f32);
        (self.value, self.bias) = (self.value * scale, self.bias * scale);
        self.standard_error = self.variance.sqrt() * scale;
        self.radius = self.mean_radius();
    }

    /// Forgets all photons.
    pub(super) fn clear(&mut self) {
        self.near.clear();
        self.weights.clear();
        self.brightness.clear();
        (self.value, self.standard_error, self.bias, self.radius) = (0.0, 0.0, 0.0, 0.0);
        (self.variance, self.radii) = (0.0, [0.0; 2]);
    }
}

/// The largest coordinate of a place.
fn coordinate_of(place: &Place<'_>) -> f32 {
    place.position.iter().fold(0.0, |most, x| most.max(x.abs()))
}

/// The smallest radius about a place.
fn smallest_at(place: &Place<'_>) -> f32 {
    (RESOLUTION * coordinate_of(place)).max(LEAST_RADIUS)
}

impl Density {
    /// Refuses settings outside their domains.
    ///
    /// # Errors
    /// The first [`DensityError`].
    pub(crate) fn check(&self) -> Result<(), DensityError> {
        if self.count < 2 {
            return Err(DensityError::Count(self.count));
        }
        if !(self.radius > 0.0) {
            return Err(DensityError::Radius(self.radius));
        }
        match self.choice {
            Choice::Agreement(bound) if !(bound > 0.0 && bound.is_finite()) => Err(DensityError::Agreement(bound)),
            _ => Ok(()),
        }
    }

    /// Estimates the irradiance at a place from the photons of its surface: each of those nearer than the radius r at the distance d counts
    /// for its flux times K(d/r) / (r² m), m being the kernel's share on the face ([`Face::mass`]).
    ///
    /// `brightness` is what a photon's flux is worth, not negative, for the choice of the radius and for the value and errors stated. The
    /// photon that defines the radius doesn't count itself: so the estimate is without bias where the density is uniform, also where the
    /// largest radius ends the search. Photons that come from below the horizon of a curved surface have the weight 0. If more photons than
    /// `count` are nearer than the smallest radius, all of them count.
    pub(crate) fn estimate(
        &self,
        map: &PhotonMap,
        place: &Place<'_>,
        brightness: impl Fn(&Photon) -> f32,
        estimate: &mut Estimate,
    ) {
        if let Some((levels, level)) = self.look_around(map, (place, None), brightness, estimate) {
            estimate.bias = levels.bias(level);
            self.weigh(estimate, levels.mass_of(place, self.kernel, level), levels.radius2(level));
        }
    }

    /// How far photons count about one of them, by its number and place: as an estimate there from all others has it.
    #[allow(clippy::cast_possible_truncation, reason = "as precise as positions")]
    pub(super) fn footprint(
        &self,
        map: &PhotonMap,
        (place, own): (&Place<'_>, u32),
        brightness: impl Fn(&Photon) -> f32,
        estimate: &mut Estimate,
    ) -> Footprint {
        let Some((levels, level)) = self.look_around(map, (place, Some(own)), brightness, estimate) else {
            return self.alone();
        };
        let (value, bias) = (levels.values[level], levels.bias(level));
        let bias = if value > 0.0 { (bias / value) as f32 } else { 0.0 };
        // As if the face went on: where photons are evenly dense, all count equally far, beside an edge too.
        let is_widest = levels.is_widest && level == 0;
        let share = if is_widest { 1.0 } else { levels.mass_of(place, Kernel::Constant, level) };
        let radius = (levels.radius2(level) * share).sqrt() as f32;
        Footprint { radius: radius.max(smallest_at(place)), bias }
    }

    /// How far photons count that are alone.
    pub(super) fn alone(&self) -> Footprint {
        Footprint { radius: if self.radius.is_finite() { self.radius.max(LEAST_RADIUS) } else { 0.0 }, bias: 0.0 }
    }

    /// Finds the photons about a place, but for one, and chooses between radii; `None` if there are none.
    fn look_around(
        &self,
        map: &PhotonMap,
        (place, without): (&Place<'_>, Option<u32>),
        brightness: impl Fn(&Photon) -> f32,
        estimate: &mut Estimate,
    ) -> Option<(Levels, usize)> {
        estimate.clear();
        let smallest = smallest_at(place);
        let region = region_of(place, self.radius.max(smallest));
        let find = |region: &Region, count: usize, near: &mut Vec<Near>| {
            map.nearest(place.surface, region, count.saturating_add(usize::from(without.is_some())), near);
            near.retain(|near| Some(near.photon) != without);
            near.truncate(count);
        };
        find(&region, self.count, &mut estimate.near);
        let last = estimate.near.last()?;
        let reaches = estimate.near.len() == self.count || region.radius.is_infinite();
        let square = |radius: f32| f64::from(radius) * f64::from(radius);
        let mut radius2 = if reaches { f64::from(last.distance2) } else { square(region.radius) };
        if radius2 < square(smallest) {
            radius2 = square(smallest);
            find(&Region { radius: smallest, ..region }, usize::MAX, &mut estimate.near);
        }
        estimate.look(map, place, brightness);
        let levels = Levels::new(estimate, place, [radius2, square(smallest)], !reaches);
        let level = match self.choice {
            Choice::Count => 0,
            Choice::Agreement(bound) => levels.choose(f64::from(bound)),
        };
        Some((levels, level))
    }

    /// The kernel's share on the face of a place, for a radius in scene units.
    pub(super) fn mass_within(&self, place: &Place<'_>, radius: f64) -> f64 {
        place.face.map_or(1.0, |face| {
            let point = face.place(place.position);
            if radius > face.clearance(point) { face.mass(self.kernel, point, radius) } else { 1.0 }
        })
    }

    /// The relative standard error of estimates from [`count`](Self::count) photons where irradiance is uniform, however dense photons are.
    #[allow(clippy::cast_precision_loss, reason = "a count")]
    pub(crate) fn least_error(&self) -> f64 {
        (self.kernel.roughness() / self.count as f64).sqrt()
    }

    /// The distance within which half of the photons have as many others as an estimate takes at most, in scene units: by some of them.
    pub(crate) fn usual_radius(&self, map: &PhotonMap) -> f32 {
        const SOME: usize = 512;
        let mut near = Vec::new();
        let stride = map.len().div_ceil(SOME).max(1);
        let radius_of = |photon: &Photon| {
            map.nearest(photon.surface, &Region::ball(photon.position, self.radius), self.count, &mut near);
            near.last().map_or(0.0, |last| last.distance2.sqrt())
        };
        let mut radii: Vec<f32> = map.photons().iter().step_by(stride).map(radius_of).collect();
        let middle = radii.len() / 2;
        if radii.is_empty() { 0.0 } else { *radii.select_nth_unstable_by(middle, f32::total_cmp).1 }
    }

    /// Gives the photons their weights, for the square of a radius and the kernel's share on the face.
    fn weigh(&self, estimate: &mut Estimate, mass: f64, radius2: f64) {
        let counts = estimate.near.partition_point(|near| f64::from(near.distance2) < radius2);
        estimate.near.truncate(counts);
        let scale = 1.0 / (radius2 * mass);
        let (mut value, mut variance) = (0.0, 0.0);
        for (near, brightness) in estimate.near.iter().zip(&estimate.brightness) {
            #[allow(clippy::cast_possible_truncation, reason = "at most 1, and a number of this size")]
            let weight = (f64::from(self.kernel.value((f64::from(near.distance2) / radius2) as f32)) * scale) as f32;
            estimate.weights.push(weight);
            let contribution = f64::from(weight) * f64::from(*brightness);
            value += contribution;
            variance += contribution * contribution;
        }
        (estimate.value, estimate.standard_error) = (value, variance.sqrt());
        #[allow(clippy::cast_possible_truncation, reason = "as precise as the photons' positions")]
        let radius = radius2.sqrt() as f32;
        estimate.radius = radius;
    }
}

/// Where the photons are that count for a place: near the plane of a face, or near the tangent plane in proportion to their distance.
pub(super) fn region_of(place: &Place<'_>, radius: f32) -> Region {
    let rounding = 16.0 * f32::EPSILON * coordinate_of(place);
    let Place { position, normal, .. } = *place;
    #[allow(clippy::cast_possible_truncation, reason = "lengths and unit vectors")]
    match place.face {
        Some(face) => {
            let normal = face.normal().to_array().map(|x| x as f32);
            Region { position, normal, radius, thickness: rounding + 2.0 * face.thickness() as f32, slope: 0.0 }
        }
        None => Region { position, normal, radius, thickness: rounding, slope: SLOPE },
    }
}

fn dot(a: [f32; 3], b: [f32; 3]) -> f32 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// Estimates with Epanechnikov's kernel for nested radii, from the largest (level 0) down, each with half the area of the one before.
struct Levels {
    /// The square of the largest radius.
    radius2: f64,
    count: usize,
    /// The estimates.
    values: [f64; LEVELS],
    /// The sum of squared fluxes over that of fluxes: the flux of a photon, if all were alike.
    fluxes: [f64; LEVELS],
    /// π r² times the kernel's share on the face.
    areas: [f64; LEVELS],
    point: DVec2,
    /// The distance to the end of the face.
    clearance: f64,
    /// Whether the largest radius is that which is allowed, not that of a number of photons.
    is_widest: bool,
}

impl Levels {
    /// From the photons found, from near to far, and their brightness, with the squares of the largest and smallest radius.
    fn new(estimate: &Estimate, place: &Place<'_>, [radius2, smallest2]: [f64; 2], is_widest: bool) -> Self {
        let point = place.face.map_or(DVec2::ZERO, |face| face.place(place.position));
        let clearance = place.face.map_or(f64::INFINITY, |face| face.clearance(point));
        let [values, fluxes, areas] = [[0.0; LEVELS]; 3];
        let mut levels = Self { radius2, count: 1, values, fluxes, areas, point, clearance, is_widest };
        let photons = estimate.near.len();
        while levels.count < LEVELS && photons >> levels.count >= FEWEST && levels.radius2(levels.count) >= smallest2 {
            levels.count += 1;
        }
        levels.fill(estimate, place);
        levels
    }

    fn fill(&mut self, estimate: &Estimate, place: &Place<'_>) {
        let mut photons = estimate.near.iter().zip(&estimate.brightness).peekable();
        let (mut sum, mut moment, mut squares) = (0.0, 0.0, 0.0);
        for level in (0..self.count).rev() {
            let radius2 = self.radius2(level);
            while let Some((near, brightness)) = photons.next_if(|(near, _)| f64::from(near.distance2) < radius2) {
                let brightness = f64::from(*brightness);
                sum += brightness;
                moment += brightness * f64::from(near.distance2);
                squares += brightness * brightness;
            }
            self.areas[level] = PI * radius2 * self.mass_of(place, Kernel::Epanechnikov, level);
            self.values[level] = 2.0 * (sum - moment / radius2) / self.areas[level];
            self.fluxes[level] = if sum > 0.0 { squares / sum } else { 0.0 };
        }
    }

    /// The square of a level's radius.
    fn radius2(&self, level: usize) -> f64 {
        #[allow(clippy::cast_possible_truncation, clippy::cast_possible_wrap, reason = "a few levels")]
        let exponent = -(level as i32);
        self.radius2 * 2.0_f64.powi(exponent)
    }

    /// A kernel's share on the face.
    fn mass_of(&self, place: &Place<'_>, kernel: Kernel, level: usize) -> f64 {
        let radius = self.radius2(level).sqrt();
        match place.face {
            Some(face) if radius > self.clearance => face.mass(kernel, self.point, radius),
            _ => 1.0,
        }
    }

    /// The largest radius that agrees with all smaller ones.
    fn choose(&self, bound: f64) -> usize {
        let agrees = |level: usize| (level + 1..self.count).all(|smaller| self.agree(level, smaller, bound));
        (0..self.count).find(|level| agrees(*level)).unwrap_or(0)
    }

    /// Whether the difference of a smaller radius' estimate to a larger one's is noise.
    ///
    /// If the density were that of the larger one, the number of photons that the smaller one is worth would have a Poisson distribution,
    /// whose root has a standard deviation of ½ (Anscombe 1948); and their difference that of the smaller one times 1 − ρ, ρ being the ratio
    /// of the areas, as follows from the kernel's integrals.
    fn agree(&self, larger: usize, smaller: usize, bound: f64) -> bool {
        let flux = self.fluxes[larger] * Kernel::Epanechnikov.roughness();
        if !(flux > 0.0) {
            return true;
        }
        let photons = |level: usize| self.values[level] * self.areas[smaller] / flux;
        let root = |level: usize| (photons(level) + 0.375).max(0.0).sqrt();
        let ratio = self.radius2(smaller) / self.radius2(larger);
        let bound = (bound * bound - 2.0 * ratio.ln()).sqrt();
        2.0 * (root(smaller) - root(larger)).abs() <= bound * (1.0 - ratio)
    }

    /// The bias at a level, by Richardson's extrapolation: it goes with the square of the radius. Its standard deviation is √2 times that of
    /// the estimate, as [`agree`](Self::agree) has it, and is taken off.
    fn bias(&self, level: usize) -> f64 {
        if level + 1 >= self.count {
            return 0.0;
        }
        let bias = 2.0 * (self.values[level] - self.values[level + 1]);
        let variance =
            Kernel::Epanechnikov.roughness() * self.values[level] * self.fluxes[level] / self.areas[level] * 2.0;
        (bias * bias - variance).max(0.0).sqrt().copysign(bias)
    }
}

#[cfg(test)]
pub(super) mod tests;
