//! The largest CIELAB difference over a box of tristimulus values.

use crate::Real;
use crate::colour::lab_f;

/// Weights of L*, a* and b* in terms of the differences of f: ΔL* = 116 Δf(Y), Δa* = 500 (Δf(X) − Δf(Y)), Δb* = 200 (Δf(Y) − Δf(Z)).
const LAB_SCALE: [f64; 3] = [116.0, 500.0, 200.0];

/// The rounding of a bound in units of ε, relative to the weighted f's that it is the difference of: of each f, 1¾ for itself and its
/// argument; two of them; and the rest for the differences and the root.
const ROUNDING: f64 = 8.0;

/// How a colour's bound depends on its radius.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ColourBound<R> {
    /// The largest ΔE*ab between the colour and any other of the box.
    pub delta_e: R,
    /// How much ΔE*ab grows with each component of the radius, to first order, up to a common positive factor.
    pub gradient: [R; 3],
}

/// The largest ΔE*ab between the colour `xyz` and any colour of the box `xyz ± radius`, for the white point `white` (all in
/// one unit).
///
/// CIELAB's f is monotone in each channel and ΔE*ab² is convex in (f(X), f(Y), f(Z)), so the maximum is at one of the box's
/// eight corners; rounding is covered. Domain: `white` positive, `radius` not negative; a NaN or infinity among the
/// numbers gives +∞.
pub fn delta_e_bound<R: Real>(xyz: [R; 3], radius: [R; 3], white: [R; 3]) -> ColourBound<R> {
    let mut centre = [R::ZERO; 3];
    let mut down = [R::ZERO; 3];
    let mut up = [R::ZERO; 3];
    let mut size = [R::ZERO; 3];
    let mut slope = [R::ZERO; 3];
    for a in 0..3 {
        let inverse = R::ONE / white[a];
        // A box one part in 1/ε wider than asked for: the corners' own rounding.
        let reach = radius[a] + R::TWO * R::EPSILON * (xyz[a].abs() + radius[a]);
        let (low, high) = (lab_f((xyz[a] - reach) * inverse), lab_f((xyz[a] + reach) * inverse));
        centre[a] = lab_f(xyz[a] * inverse);
        down[a] = low - centre[a];
        up[a] = high - centre[a];
        size[a] = low.abs().max(high.abs()).max(lab_offset());
        slope[a] = lab_slope(centre[a]) * inverse;
    }
    let [lightness, red_green, yellow_blue] = LAB_SCALE.map(R::from_f64);
    let corner = |y: R| {
        let x = (down[0] - y).abs().max((up[0] - y).abs());
        let z = (y - down[2]).abs().max((y - up[2]).abs());
        square(lightness * y) + square(red_green * x) + square(yellow_blue * z)
    };
    let largest = corner(down[1]).max(corner(up[1])).sqrt();
    let rounding = lightness * size[1] + red_green * (size[0] + size[1]) + yellow_blue * (size[1] + size[2]);
    let margin = R::from_f64(ROUNDING) * R::EPSILON;
    let delta_e = largest * (R::ONE + margin) + margin * rounding;

    let u: [R; 3] = core::array::from_fn(|a| slope[a] * radius[a]);
    let a = square(red_green) * (u[0] + u[1]);
    let b = square(yellow_blue) * (u[1] + u[2]);
    let gradient = [slope[0] * a, slope[1] * (square(lightness) * u[1] + a + b), slope[2] * b];
    // The sum also meets a NaN that comparisons have let slip.
    let certain = (delta_e + rounding).is_finite() && is_white(white);
    ColourBound { delta_e: if certain { delta_e } else { R::INFINITY }, gradient }
}

/// At least [`delta_e_bound`]'s ΔE*ab, and monotone but for rounding: it grows with each radius and with any common scale of
/// `xyz` and `radius`, and falls as `xyz` grows alone.
///
/// Each channel counts with its greater, downward difference, and the channels with opposite signs. Domain: as
/// [`delta_e_bound`]'s, with `xyz` not negative.
pub fn delta_e_majorant<R: Real>(xyz: [R; 3], radius: [R; 3], white: [R; 3]) -> R {
    majorant(xyz, radius, white, ROUNDING)
}

/// At least [`delta_e_majorant`] of the same colour at every smaller scale, to the last bit.
pub(crate) fn delta_e_majorant_up_to<R: Real>(xyz: [R; 3], radius: [R; 3], white: [R; 3]) -> R {
    // Rounding may have made this one too small, and the other one too great.
    majorant(xyz, radius, white, 3.0 * ROUNDING)
}

fn majorant<R: Real>(xyz: [R; 3], radius: [R; 3], white: [R; 3], rounding: f64) -> R {
    let margin = R::from_f64(rounding) * R::EPSILON;
    let mut fall = [R::ZERO; 3];
    let mut size = [R::ZERO; 3];
    for a in 0..3 {
        let inverse = R::ONE / white[a];
        let reach = radius[a] + R::TWO * R::EPSILON * (xyz[a].abs() + radius[a]);
        let centre = lab_f(xyz[a] * inverse);
        let low = lab_f((xyz[a] - reach) * inverse);
        fall[a] = centre - low;
        size[a] = centre.abs().max(low.abs()).max(lab_offset());
    }
    let [lightness, red_green, yellow_blue] = LAB_SCALE.map(R::from_f64);
    let [x, y, z] = fall;
    let largest = (square(lightness * y) + square(red_green * (x + y)) + square(yellow_blue * (y + z))).sqrt();
    let total = lightness * size[1] + red_green * (size[0] + size[1]) + yellow_blue * (size[1] + size[2]);
    let bound = largest * (R::ONE + margin) + margin * total;
    if bound.is_finite() && is_white(white) { bound } else { R::INFINITY }
}

/// Whether all tristimulus values are positive and finite.
#[inline]
fn is_white<R: Real>(white: [R; 3]) -> bool {
    white.iter().all(|w| *w > R::ZERO && w.is_finite())
}

/// f(0) = 4/29: f's rounding error is relative to at least this much, also where f vanishes, at negative values.
#[inline]
fn lab_offset<R: Real>() -> R {
    R::from_f64(4.0 / 29.0)
}

#[inline]
fn square<R: Real>(x: R) -> R {
    x * x
}

/// The derivative of CIELAB's f, from the value of f: 1/(3 f²) above f = 6/29, and the linear part's 841/108 below.
#[inline]
fn lab_slope<R: Real>(f: R) -> R {
    let junction = R::from_f64(6.0 / 29.0);
    let f = f.max(junction);
    R::ONE / (R::from_f64(3.0) * f * f)
}
