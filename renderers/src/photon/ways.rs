//! Photons of a leaf that move with the wavelength, side by side.

use super::kernel::Kernel;
use super::map::{LEAF, Region};
use super::motion::{Motion, presence};
use super::{Photon, curves};

/// In how many steps light is found at a place while photons move by the radius within which they count, and in how many at most: a power of two.
const STEPS: f32 = 2.0;
const MOST_STEPS: u16 = 128;

/// Where the photons of a leaf are between the first key (0) and the last (1).
#[derive(Clone, Copy, Debug)]
pub(super) struct Ways {
    /// Where they are at the middles of their ways, by axis, and how far they would go from 0 to 1; in scene units.
    place: [[f32; LEAF]; 3],
    way: [[f32; LEAF]; 3],
    /// Their fluxes there, and by how much they would change from 0 to 1.
    flux: [f32; LEAF],
    change: [f32; LEAF],
    /// Where these middles are, and from where to where they are there.
    middle: [f32; LEAF],
    limits: [[f32; LEAF]; 2],
    /// The product of spectra that their fluxes are multiplied by, if it is the same.
    pub(super) spectrum: Option<u32>,
    /// In how many even steps their light is found.
    pub(super) steps: u16,
    /// Whether all are there from the first key to the last.
    pub(super) are_whole: bool,
}

/// Where light is wanted of photons that move, and how far they count there, in scene units.
#[derive(Clone, Copy, Debug)]
pub(super) struct About<'r> {
    pub(super) region: &'r Region,
    pub(super) radius: f32,
    pub(super) kernel: Kernel,
}

/// Coefficients by how far photons are from the middles of their ways: of the squares of their distances from a place, and of their heights above its plane.
struct Course {
    square: [[f32; LEAF]; 3],
    height: [[f32; LEAF]; 2],
}

impl Ways {
    /// Those of as many photons, which count within a radius, in at least so many steps.
    pub(super) fn new(photons: &[Photon], motions: &[Motion], radius: f32, least: u16) -> Self {
        let none = [0.0; LEAF];
        let first = photons.first().map(|photon| photon.spectrum);
        let mut ways = Self {
            place: [none; 3],
            way: [none; 3],
            flux: none,
            change: none,
            middle: none,
            // Nowhere.
            limits: [[f32::INFINITY; LEAF], none],
            spectrum: first.filter(|first| photons.iter().all(|photon| photon.spectrum == *first)),
            steps: 1,
            are_whole: motions.iter().all(|motion| motion.bounds() == [f32::NEG_INFINITY, f32::INFINITY]),
        };
        let (mut speeds, mut shortest) = (Vec::with_capacity(LEAF), 1.0_f32);
        for (i, (photon, motion)) in photons.iter().zip(motions).enumerate() {
            let (place, flux, middle) = motion.halfway(photon);
            let axes = ways.place.iter_mut().zip(&mut ways.way);
            for ((own, way), (place, all)) in axes.zip(place.into_iter().zip(motion.position)) {
                (own[i], way[i]) = (place, all);
            }
            (ways.flux[i], ways.change[i], ways.middle[i]) = (flux, motion.flux, middle);
            let [from, to] = motion.bounds();
            (ways.limits[0][i], ways.limits[1][i]) = (from, to);
            let [from, to] = motion.limits;
            shortest = if to > from { shortest.min(to - from) } else { shortest };
            speeds.push(motion.speed() / radius);
        }
        // Fluxes change from key to key, too, where photons hardly move; and all ways end at the end of a step.
        let steps = (STEPS * curves::of_nine_in_ten(&mut speeds)).max(1.0 / shortest).ceil();
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "within limits")]
        let steps = (steps.clamp(1.0, f32::from(MOST_STEPS)) as u16).next_power_of_two();
        ways.steps = steps.max(least);
        ways
    }

    /// How much there is of each photon at the end of a step.
    pub(super) fn present(&self, node: u16) -> [f32; LEAF] {
        let ([from, to], at) = (&self.limits, f32::from(node) / f32::from(self.steps));
        core::array::from_fn(|i| presence(at, from[i], to[i]))
    }

    /// About a place.
    fn course(&self, region: &Region) -> Course {
        let Region { position: p, normal: n, .. } = *region;
        let ([x, y, z], [u, v, w]) = (&self.place, &self.way);
        let mut course = Course { square: [[0.0; LEAF]; 3], height: [[0.0; LEAF]; 2] };
        for i in 0..LEAF {
            let (d, way) = ([x[i] - p[0], y[i] - p[1], z[i] - p[2]], [u[i], v[i], w[i]]);
            let dot = |a: [f32; 3], b: [f32; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
            course.square[0][i] = dot(d, d);
            course.square[1][i] = 2.0 * dot(d, way);
            course.square[2][i] = dot(way, way);
            course.height[0][i] = dot(n, d);
            course.height[1][i] = dot(n, way);
        }
        course
    }

    /// The irradiances of all photons at a place, at the ends of steps from one to another, that not included; one list for each is added.
    pub(super) fn light(&self, about: About<'_>, [first, end]: [u16; 2], found: &mut Vec<[f32; LEAF]>) {
        let course = self.course(about.region);
        // A kernel that is known where it is evaluated is so for several photons at once.
        let mut each = |light: &dyn Fn(f32) -> [f32; LEAF]| {
            found.extend((first..end).map(|node| light(f32::from(node) / f32::from(self.steps))));
        };
        match about.kernel {
            Kernel::Constant => each(&|at| self.at(about, &course, at, |t2| Kernel::Constant.within(t2))),
            Kernel::Cone => each(&|at| self.at(about, &course, at, |t2| Kernel::Cone.within(t2))),
            Kernel::Epanechnikov => each(&|at| self.at(about, &course, at, |t2| Kernel::Epanechnikov.within(t2))),
            Kernel::Biweight => each(&|at| self.at(about, &course, at, |t2| Kernel::Biweight.within(t2))),
            Kernel::Triweight => each(&|at| self.at(about, &course, at, |t2| Kernel::Triweight.within(t2))),
        }
    }

    /// The kernel is that of the square of the distance over the radius, up to 1.
    #[inline]
    fn at(&self, about: About<'_>, course: &Course, at: f32, kernel: impl Fn(f32) -> f32) -> [f32; LEAF] {
        let About { region: Region { thickness, slope, .. }, radius, .. } = about;
        let (thickness2, slope2, by_area) = (thickness * thickness, slope * slope, 1.0 / (radius * radius));
        let ([a, b, c], [h, k], [from, to], middle) = (&course.square, &course.height, &self.limits, &self.middle);
        let mut light = [0.0; LEAF];
        for i in 0..LEAF {
            let t = at - middle[i];
            let distance2 = (a[i] + t * (b[i] + t * c[i])).max(0.0);
            let height = h[i] + t * k[i];
            let flux = (self.flux[i] + t * self.change[i]).max(0.0) * presence(at, from[i], to[i]);
            let t2 = distance2 * by_area;
            let counts = (t2 <= 1.0) & (height * height <= thickness2 + slope2 * distance2);
            let value = flux * by_area * kernel(t2.min(1.0));
            light[i] = if counts { value } else { 0.0 };
        }
        light
    }
}
