//! The integral over a triangle whose terms are all of one sign, for where Lambert's sum cancels.

use spectral_core::Real;

use super::angle::squared_cosine;
use super::gauss::{integrate, integrate_smooth};
use crate::vector::{Vector, add, cross, dot, length, scale, subtract};

/// A corner of a triangle, as seen from the receiver.
#[derive(Clone, Copy, Debug)]
pub(super) struct Corner<R> {
    pub(super) position: Vector<R>,
    /// The way to it from a point that all corners share. It is given apart from the position, so that triangles far smaller than
    /// their distance, and far larger ones, keep their shape.
    pub(super) offset: Vector<R>,
    /// The height over the horizon, or another linear function.
    pub(super) value: R,
}

impl<R: Real> Corner<R> {
    /// The point on the way to `end`, `share` of it from here and `rest` from there.
    fn toward(&self, end: &Self, share: R, rest: R, value: R) -> Self {
        let (from, side, way) = if share < rest {
            (self, subtract(end.offset, self.offset), share)
        } else {
            (end, subtract(self.offset, end.offset), rest)
        };
        let step = scale(side, way);
        Self { position: add(from.position, step), offset: add(from.offset, step), value }
    }

    /// Where the way to `end`, on the other side of the horizon, meets it: the point and the shares of the way before and after.
    fn meet_horizon(&self, end: &Self) -> (Self, R, R) {
        let range = self.value - end.value;
        let (share, rest) = (self.value / range, -end.value / range);
        (self.toward(end, share, rest, R::ZERO), share, rest)
    }
}

/// 1/(π A) ∫ H(x) dA / x⁴ over the part of a triangle of area A where H ≥ 0, H being the linear function of the corners' values.
///
/// Times A h, with h the height of the origin over the triangle's plane, it is the configuration factor, if H is the height over
/// the horizon.
pub(super) fn clipped_mean<R: Real>(corners: [Corner<R>; 3]) -> R {
    let above = corners.iter().filter(|c| c.value > R::ZERO).count();
    // The corner that is alone on its side of the horizon comes first; the others keep their sense.
    let alone = |c: &Corner<R>| (c.value > R::ZERO) == (above == 1);
    let [a, b, c] = corners;
    let [a, b, c] = if alone(&a) {
        [a, b, c]
    } else if alone(&b) {
        [b, c, a]
    } else {
        [c, a, b]
    };
    match above {
        0 => R::ZERO,
        1 => {
            let ((ab, s, _), (ac, t, _)) = (a.meet_horizon(&b), a.meet_horizon(&c));
            s * t * mean([a, ab, ac])
        }
        2 => {
            let ((ab, s, rest), (ac, _, t)) = (a.meet_horizon(&b), a.meet_horizon(&c));
            rest * mean([ab, b, c]) + s * t * mean([ab, c, ac])
        }
        _ => mean(corners),
    }
}

/// 1/(π A) ∫ H(x) dA / x⁴ over a triangle.
///
/// It is swept by lines of equal H: the integral along a line is in closed form, the one across the lines by Gauss's rule with panels
/// that shrink towards the poles.
pub(super) fn mean<R: Real>(corners: [Corner<R>; 3]) -> R {
    let [low, middle, high] = sorted(corners);
    let range = high.value - low.value;
    let (share, rest) = if range > R::ZERO {
        ((middle.value - low.value) / range, (high.value - middle.value) / range)
    } else {
        (R::HALF, R::HALF)
    };
    let level = low.toward(&high, share, rest, middle.value);
    share * wedge(&low, &middle, &level) + rest * wedge(&high, &middle, &level)
}

fn sorted<R: Real>([a, b, c]: [Corner<R>; 3]) -> [Corner<R>; 3] {
    let (a, b) = if b.value < a.value { (b, a) } else { (a, b) };
    let (b, c) = if c.value < b.value { (c, b) } else { (b, c) };
    let (a, b) = if b.value < a.value { (b, a) } else { (a, b) };
    [a, b, c]
}

/// The same over the triangle from `apex` to the line of equal value from `first` to `second`.
fn wedge<R: Real>(apex: &Corner<R>, first: &Corner<R>, second: &Corner<R>) -> R {
    let sides = [subtract(first.offset, apex.offset), subtract(second.offset, apex.offset)];
    let across = subtract(second.offset, first.offset);
    let [slope, reach1, reach2] = [length(cross(sides[0], across)), length(sides[0]), length(sides[1])];
    // The poles are where the line meets the foot of the origin's perpendicular, and where its ends are at no distance.
    let distance = |[x, y]: [Vector<R>; 2]| {
        let ends = (length(x) / reach1).min(length(y) / reach2);
        let line = length(cross(nearer(x, y), across)) / slope;
        // NaN, from 0/0, gives way.
        line.min(ends)
    };
    // Half of the way from each end, so that whichever comes close to the origin keeps its accuracy.
    let outward = |s: R| [add(apex.position, scale(sides[0], s)), add(apex.position, scale(sides[1], s))];
    let inward = |s: R| [subtract(first.position, scale(sides[0], s)), subtract(second.position, scale(sides[1], s))];
    let rise = first.value - apex.value;
    let near = integrate(
        R::HALF,
        |s| distance(outward(s)),
        |s| s * (apex.value + rise * s) * along_line(outward(s), scale(across, s)),
    );
    let far = integrate(
        R::HALF,
        |s| distance(inward(s)),
        |s| (R::ONE - s) * (first.value - rise * s) * along_line(inward(s), scale(across, R::ONE - s)),
    );
    R::TWO / R::PI * (near + far)
}

fn nearer<R: Real>(x: Vector<R>, y: Vector<R>) -> Vector<R> {
    if dot(x, x) < dot(y, y) { x } else { y }
}

/// ∫₀¹ dt / z⁴ on the way z = x + t `across` from x to y.
fn along_line<R: Real>([x, y]: [Vector<R>; 2], across: Vector<R>) -> R {
    let gap = length(across);
    let far = R::from_f64(40.0);
    if dot(x, x).min(dot(y, y)) > far * (gap * gap) {
        return integrate_smooth(|t| {
            let z = add(x, scale(across, t));
            let z2 = dot(z, z);
            R::ONE / (z2 * z2)
        });
    }
    let q = length(cross(nearer(x, y), across)) / gap;
    let tangents = [dot(x, across) / (gap * q), dot(y, across) / (gap * q)];
    squared_cosine(tangents, gap / q) / (q * q * q * gap)
}
