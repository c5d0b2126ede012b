//! Photons of a leaf that move with the wavelength, side by side.

use core::ops::Range;

use glam::Vec3A;

use super::kernel::Kernel;
use super::map::{LEAF, Region};
use super::motion::Motion;
use super::{Photon, curves};

/// In how many steps light is found at a place while photons move by the radius within which they count, and in how many at most: a power of two.
/// Across Epanechnikov's kernel, (1 − x²)^(3/2), light of photons that follow each other evenly is even then but for 4 %; in one step it would change by
/// 30 %, and show in a prism's spectrum.
const STEPS: f32 = 2.0;
const MOST_STEPS: u16 = 128;

/// Rounding of places, relative to their coordinates, and of ends of steps.
const ROUNDING: f32 = 8.0 * f32::EPSILON;
const PART: f32 = 1e-3;

/// Where the photons of a leaf are between the first key (0) and the last (1).
#[derive(Clone, Copy, Debug)]
pub(super) struct Ways {
    /// Where they are at the middles of their ways, by axis, and how far they would go from 0 to 1; in scene units.
    place: [[f32; LEAF]; 3],
    way: [[f32; LEAF]; 3],
    /// Their fluxes there, and by how much they would change from 0 to 1.
    flux: [f32; LEAF],
    change: [f32; LEAF],
    /// From these middles to where their ways begin.
    begin: [f32; LEAF],
    /// The end of a step at which each begins; how much of the photon is there, and how many steps it has, with how much there is at its end.
    first: [u8; LEAF],
    at_first: [f32; LEAF],
    until: [f32; LEAF],
    /// The most steps that one of them has, and from which to which end of a step any begins.
    most: u16,
    begins: [u16; 2],
    /// The box around all at the first key, and by how much its limits change up to the last: there is none outside on the way.
    low: [Vec3A; 2],
    high: [Vec3A; 2],
    /// The product of spectra that their fluxes are multiplied by, if it is the same.
    pub(super) spectrum: Option<u32>,
    /// In how many even steps from 0 to 1 their light is found.
    pub(super) steps: u16,
    /// Whether all begin and end together.
    pub(super) are_together: bool,
}

/// Where light is wanted of photons that move, and how far they count there, in scene units.
#[derive(Clone, Copy, Debug)]
pub(super) struct About<'r> {
    pub(super) region: &'r Region,
    pub(super) radius: f32,
    pub(super) kernel: Kernel,
}

/// Coefficients by how far photons are from the middles of their ways: of the squares of their distances from a place over the radius, of their heights
/// above its plane, and of their fluxes over the radius' square.
struct Course {
    square: [[f32; LEAF]; 3],
    height: [[f32; LEAF]; 2],
    flux: [[f32; LEAF]; 2],
    /// Whether all are in the place's plane, wherever they are on their ways.
    is_flat: bool,
}

impl Ways {
    /// Those of as many photons, which count within a radius, in at least so many steps.
    #[allow(clippy::cast_possible_truncation, reason = "at most the most steps")]
    pub(super) fn new(photons: &[Photon], motions: &[Motion], radius: f32, least: u16) -> Self {
        let none = [0.0; LEAF];
        let spectrum = photons.first().map(|photon| photon.spectrum);
        let mut ways = Self {
            place: [none; 3],
            way: [none; 3],
            flux: none,
            change: none,
            begin: none,
            first: [0; LEAF],
            at_first: none,
            // Nowhere.
            until: none,
            most: 0,
            begins: [u16::MAX, 0],
            low: [Vec3A::INFINITY; 2],
            high: [Vec3A::NEG_INFINITY; 2],
            spectrum: spectrum.filter(|first| photons.iter().all(|photon| photon.spectrum == *first)),
            steps: steps_of(motions, radius).max(least),
            are_together: motions.iter().all(|motion| Some(motion.limits) == motions.first().map(|first| first.limits)),
        };
        for (i, (photon, motion)) in photons.iter().zip(motions).enumerate().take(LEAF) {
            let (place, flux, middle) = motion.halfway(photon);
            let axes = ways.place.iter_mut().zip(&mut ways.way);
            for ((own, way), (place, all)) in axes.zip(place.into_iter().zip(motion.position)) {
                (own[i], way[i]) = (place, all);
            }
            (ways.flux[i], ways.change[i]) = (flux, motion.flux);
            for (end, at) in [0.0, 1.0].into_iter().enumerate() {
                let place = Vec3A::from_array(place) + Vec3A::from_array(motion.position) * (at - middle);
                (ways.low[end], ways.high[end]) = (ways.low[end].min(place), ways.high[end].max(place));
            }
            let [first, last] = motion.limits.map(|limit| step_at(limit, ways.steps));
            ways.begin[i] = f32::from(first) / f32::from(ways.steps) - middle;
            ways.first[i] = first as u8;
            // Half of it: the other half is where another goes on, so that lines through what is there at the ends of steps have all of it.
            ways.at_first[i] = if first == 0 { 1.0 } else { 0.5 };
            ways.until[i] = f32::from(last - first) + if last == ways.steps { 1.0 } else { 0.5 };
            ways.most = ways.most.max(last - first);
            ways.begins = [ways.begins[0].min(first), ways.begins[1].max(first)];
        }
        (ways.low[1], ways.high[1]) = (ways.low[1] - ways.low[0], ways.high[1] - ways.high[0]);
        ways
    }

    /// Those of some ends of steps, from one to another (that not included), at which photons may be within a distance of a place.
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "limited to the steps")]
    pub(super) fn nodes_near(&self, position: [f32; 3], distance: f32, [first, end]: [u16; 2]) -> [u16; 2] {
        let position = Vec3A::from_array(position);
        let distance = Vec3A::splat(distance + ROUNDING * (distance + position.abs().max_element()));
        let (mut from, mut to) = (0.0_f32, 1.0_f32);
        // What must not be negative, at the first key and how much more at the last.
        for (room, more) in
            [(position + distance - self.low[0], -self.low[1]), (self.high[0] + distance - position, self.high[1])]
        {
            let at = -room / more;
            let (rising, falling) = (more.cmpgt(Vec3A::ZERO), more.cmplt(Vec3A::ZERO));
            from = from.max(Vec3A::select(rising, at, Vec3A::ZERO).max_element());
            to = to.min(Vec3A::select(falling, at, Vec3A::ONE).min_element());
            if (room.cmplt(Vec3A::ZERO) & !rising & !falling).any() {
                return [first, first];
            }
        }
        let steps = f32::from(self.steps);
        let [from, to] = [(from * steps - PART).ceil().max(f32::from(first)), (to * steps + PART).floor() + 1.0];
        let to = to.min(f32::from(end));
        if from < to { [from as u16, to as u16] } else { [first, first] }
    }

    /// The end of a step at which a photon's way begins.
    pub(super) fn first(&self, lane: usize) -> u16 {
        u16::from(self.first[lane])
    }

    /// How much of each photon there is so many steps after its way began.
    #[inline]
    pub(super) fn present(&self, step: f32) -> [f32; LEAF] {
        let mut present = [0.0; LEAF];
        for (present, (at_first, until)) in present.iter_mut().zip(self.at_first.iter().zip(&self.until)) {
            *present = at_most(at_first + step, 1.0) * at_least(at_most(until - step, 1.0), 0.0);
        }
        present
    }

    /// About a place.
    #[inline]
    fn course(&self, about: About<'_>) -> Course {
        let About { region: Region { position: p, normal: n, thickness, .. }, radius, .. } = about;
        let by_area = 1.0 / (radius * radius);
        let ([x, y, z], [u, v, w]) = (&self.place, &self.way);
        let none = [0.0; LEAF];
        let mut course = Course { square: [none; 3], height: [none; 2], flux: [none; 2], is_flat: true };
        let mut highest = none;
        for i in 0..LEAF {
            let (d, way) = ([x[i] - p[0], y[i] - p[1], z[i] - p[2]], [u[i], v[i], w[i]]);
            let dot = |a: [f32; 3], b: [f32; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
            course.square[0][i] = dot(d, d) * by_area;
            course.square[1][i] = 2.0 * dot(d, way) * by_area;
            course.square[2][i] = dot(way, way) * by_area;
            course.height[0][i] = dot(*n, d);
            course.height[1][i] = dot(*n, way);
            course.flux[0][i] = self.flux[i] * by_area;
            course.flux[1][i] = self.change[i] * by_area;
            highest[i] = course.height[0][i].abs() + course.height[1][i].abs();
        }
        course.is_flat = highest.iter().fold(true, |is_flat, height| is_flat & (*height <= *thickness));
        course
    }

    /// Adds rows of the irradiances of all photons at a place. Each row is a step further on their ways, the first as many steps from where they
    /// begin as is returned. What is asked for, from one end of a step to another (that not included), is among it.
    pub(super) fn light(&self, about: About<'_>, [first, end]: [u16; 2], found: &mut Vec<[f32; LEAF]>) -> u16 {
        let course = self.course(about);
        let [earliest, latest] = self.begins;
        let steps = first.saturating_sub(latest)..end.saturating_sub(earliest).min(self.most + 1);
        let start = steps.start;
        // A kernel that is known where it is evaluated is so for several photons at once.
        match about.kernel {
            Kernel::Constant => self.rows(about, &course, steps, |t2| Kernel::Constant.within(t2), found),
            Kernel::Cone => self.rows(about, &course, steps, |t2| Kernel::Cone.within(t2), found),
            Kernel::Epanechnikov => self.rows(about, &course, steps, |t2| Kernel::Epanechnikov.within(t2), found),
            Kernel::Biweight => self.rows(about, &course, steps, |t2| Kernel::Biweight.within(t2), found),
            Kernel::Triweight => self.rows(about, &course, steps, |t2| Kernel::Triweight.within(t2), found),
        }
        start
    }

    /// The kernel is that of the square of the distance over the radius, up to 1.
    #[inline]
    fn rows(
        &self,
        about: About<'_>,
        course: &Course,
        steps: Range<u16>,
        kernel: impl Fn(f32) -> f32,
        found: &mut Vec<[f32; LEAF]>,
    ) {
        let About { region: Region { thickness, slope, .. }, radius, .. } = about;
        let (thickness2, slope2) = (thickness * thickness, slope * slope * (radius * radius));
        let ([a, b, c], [h, k], [flux, change]) = (&course.square, &course.height, &course.flux);
        for step in steps {
            let step = f32::from(step);
            let since = step / f32::from(self.steps);
            let (present, mut light) = (self.present(step), [0.0; LEAF]);
            for i in 0..LEAF {
                let t = self.begin[i] + since;
                let t2 = a[i] + t * (b[i] + t * c[i]);
                let flux = at_least(flux[i] + t * change[i], 0.0) * present[i];
                let value = flux * kernel(at_least(at_most(t2, 1.0), 0.0));
                light[i] = if t2 <= 1.0 { value } else { 0.0 };
            }
            if !course.is_flat {
                for i in 0..LEAF {
                    let t = self.begin[i] + since;
                    let (height, t2) = (h[i] + t * k[i], at_least(a[i] + t * (b[i] + t * c[i]), 0.0));
                    light[i] = if height * height <= thickness2 + slope2 * t2 { light[i] } else { 0.0 };
                }
            }
            found.push(light);
        }
    }
}

/// The larger of two numbers; the second for NaN. In one instruction, other than that of the standard library.
#[inline]
fn at_least(x: f32, least: f32) -> f32 {
    if x > least { x } else { least }
}

/// The smaller of two numbers; the second for NaN.
#[inline]
fn at_most(x: f32, most: f32) -> f32 {
    if x < most { x } else { most }
}

/// In how many even steps from 0 to 1 light of photons is found that count within a radius: as many as nine in ten ask for by their speeds, and all
/// ways end at the end of one.
fn steps_of(motions: &[Motion], radius: f32) -> u16 {
    let mut speeds: Vec<f32> = motions.iter().map(|motion| motion.speed() / radius).collect();
    let widths = motions.iter().map(|motion| motion.limits[1] - motion.limits[0]);
    let shortest = widths.filter(|width| *width > 0.0).fold(1.0, f32::min);
    let steps = (STEPS * curves::of_nine_in_ten(&mut speeds)).max(1.0 / shortest).ceil();
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "within limits")]
    let steps = steps.clamp(1.0, f32::from(MOST_STEPS)) as u16;
    steps.next_power_of_two()
}

/// The end of a step that a limit is.
#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "at most the most steps")]
fn step_at(limit: f32, steps: u16) -> u16 {
    (limit.clamp(0.0, 1.0) * f32::from(steps)).round() as u16
}
