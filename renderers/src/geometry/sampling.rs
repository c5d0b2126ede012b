//! Well-distributed points in the unit square, and maps from there to disks, triangles and hemispheres.
//!
//! Points are Owen-scrambled Sobol points (B. Burley, "Practical Hash-based Owen Scrambling", *JCGT* 9(4), 2020): any
//! power-of-two run of them is a (0, 2)-sequence, and each is a pure function of pixel seed, index and dimension, so
//! that the result doesn't depend on the order or number of threads. Maps come as `square_to_…`, its inverse, and the
//! density; all are pure and keep area, so that equal weights stay equal.

use core::f32::consts::{FRAC_1_PI, FRAC_PI_2, FRAC_PI_4};

use glam::{Vec2, Vec3A};

/// The points of one pixel or of one estimate, told apart from others by a seed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SobolSequence {
    seed: u32,
}

impl SobolSequence {
    /// The sequence with this seed.
    #[must_use]
    pub const fn new(seed: u32) -> Self {
        Self { seed: mix(seed) }
    }

    /// The sequence of a pixel, for the seed of the whole picture.
    #[must_use]
    pub const fn for_pixel(x: u32, y: u32, seed: u32) -> Self {
        Self { seed: combine(combine(mix(seed), x), y) }
    }

    /// Point `index` of the two-dimensional sequence number `dimension`, each coordinate a multiple of 2⁻²⁴ in [0, 1).
    ///
    /// Sequences of different dimensions are shuffled and scrambled independently, so that pairs of them fill four
    /// dimensions without correlation, but no better than random points do. There are 2³² points.
    #[must_use]
    pub fn point(&self, index: u32, dimension: u32) -> [f32; 2] {
        let seed = combine(self.seed, dimension);
        let shuffled = scramble(index, seed);
        [scramble(shuffled.reverse_bits(), combine(seed, 0)), scramble(sobol_second(shuffled), combine(seed, 1))]
            .map(to_unit)
    }
}

/// The second Sobol coordinate of a point; the first is the index with its bits reversed.
pub(crate) const fn sobol_second(index: u32) -> u32 {
    // The direction numbers are the rows of Pascal's triangle modulo 2, which shifts and sums form all at once.
    let mut x = index;
    x ^= (x & 0xaaaa_aaaa) >> 1;
    x ^= (x & 0xcccc_cccc) >> 2;
    x ^= (x & 0xf0f0_f0f0) >> 4;
    x ^= (x & 0xff00_ff00) >> 8;
    x ^= (x & 0xffff_0000) >> 16;
    x.reverse_bits()
}

/// Owen's nested uniform scrambling: every bit is flipped or not by a hash of the bits above it.
pub(crate) const fn scramble(x: u32, seed: u32) -> u32 {
    permute(x.reverse_bits(), seed).reverse_bits()
}

/// A permutation in which each bit depends only on those below it: Laine & Karras (2011) with N. Vegdahl's constants
/// ("Building a Better LK Hash", 2021), whose bits are far closer to independent.
const fn permute(x: u32, seed: u32) -> u32 {
    let x = x ^ x.wrapping_mul(0x3d20_adea);
    let x = x.wrapping_add(seed);
    let x = x.wrapping_mul((seed >> 16) | 1);
    let x = x ^ x.wrapping_mul(0x0552_6c56);
    x ^ x.wrapping_mul(0x53a2_2864)
}

/// A bijective hash of 32 bits (C. Wellons, "Prospecting for Hash Functions", 2018: `lowbias32`).
const fn mix(x: u32) -> u32 {
    let x = (x ^ (x >> 16)).wrapping_mul(0x7feb_352d);
    let x = (x ^ (x >> 15)).wrapping_mul(0x846c_a68b);
    x ^ (x >> 16)
}

pub(crate) const fn combine(seed: u32, value: u32) -> u32 {
    mix(seed ^ mix(value.wrapping_add(0x9e37_79b9)))
}

#[allow(clippy::cast_precision_loss, reason = "24 bits fit")]
fn to_unit(x: u32) -> f32 {
    (x >> 8) as f32 * (f32::EPSILON / 2.0)
}

/// The unit disk from the unit square, keeping area and neighbourhoods (P. Shirley & K. Chiu, "A Low Distortion Map
/// Between Disk and Square", 1997).
#[must_use]
pub fn square_to_disk(u: [f32; 2]) -> Vec2 {
    let (x, y) = (2.0 * u[0] - 1.0, 2.0 * u[1] - 1.0);
    if x == 0.0 && y == 0.0 {
        return Vec2::ZERO;
    }
    let (radius, angle) =
        if x.abs() > y.abs() { (x, FRAC_PI_4 * (y / x)) } else { (y, FRAC_PI_2 - FRAC_PI_4 * (x / y)) };
    Vec2::from_angle(angle) * radius
}

/// The inverse of [`square_to_disk`].
#[must_use]
pub fn disk_to_square(point: Vec2) -> [f32; 2] {
    let radius = point.length();
    // The azimuth from the middle of the quarter that the point is in, −1 to 1.
    let (x, y) = if point.x.abs() > point.y.abs() {
        let along = radius.copysign(point.x);
        (along, along * ((point.y / point.x).atan() / FRAC_PI_4))
    } else {
        let along = radius.copysign(point.y);
        let ratio = if point.y == 0.0 { 0.0 } else { point.x / point.y };
        (along * (ratio.atan() / FRAC_PI_4), along)
    };
    [x, y].map(|v| ((v + 1.0) / 2.0).clamp(0.0, 1.0))
}

/// The density of [`square_to_disk`] per unit area: 1/π inside the unit disk, 0 outside.
#[must_use]
pub fn square_to_disk_pdf(point: Vec2) -> f32 {
    if point.length_squared() <= 1.0 { FRAC_1_PI } else { 0.0 }
}

/// The barycentric weights of the second and third vertex of a triangle from the unit square, keeping area (E. Heitz,
/// "A Low-Distortion Map Between Triangle and Square", 2019): they are in [0, 1] and their sum is at most 1.
#[must_use]
pub fn square_to_triangle(u: [f32; 2]) -> [f32; 2] {
    let [x, y] = u;
    if y > x { [x / 2.0, y - x / 2.0] } else { [x - y / 2.0, y / 2.0] }
}

/// The inverse of [`square_to_triangle`].
#[must_use]
pub fn triangle_to_square(weights: [f32; 2]) -> [f32; 2] {
    let [x, y] = weights;
    if y > x { [2.0 * x, y + x] } else { [x + y, 2.0 * y] }
}

/// The density of [`square_to_triangle`] in the plane of the two weights: 2 inside the triangle, 0 outside. Per unit
/// area of a triangle it is 1/area.
#[must_use]
pub fn square_to_triangle_pdf(weights: [f32; 2]) -> f32 {
    let [x, y] = weights;
    if x >= 0.0 && y >= 0.0 && x + y <= 1.0 { 2.0 } else { 0.0 }
}

/// A direction of the hemisphere around +z, with a density proportional to the cosine (Malley's method).
#[must_use]
pub fn square_to_cosine_hemisphere(u: [f32; 2]) -> Vec3A {
    let point = square_to_disk(u);
    Vec3A::new(point.x, point.y, (1.0 - point.length_squared()).max(0.0).sqrt())
}

/// The inverse of [`square_to_cosine_hemisphere`], for unit vectors with z ≥ 0.
#[must_use]
pub fn cosine_hemisphere_to_square(direction: Vec3A) -> [f32; 2] {
    disk_to_square(Vec2::new(direction.x, direction.y))
}

/// The density of [`square_to_cosine_hemisphere`] per steradian: cos θ/π above the horizon, 0 below.
#[must_use]
pub fn square_to_cosine_hemisphere_pdf(direction: Vec3A) -> f32 {
    direction.z.max(0.0) * FRAC_1_PI
}
