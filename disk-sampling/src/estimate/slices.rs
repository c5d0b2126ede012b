//! A disk as a receiver sees it, cut into slices: the coordinates in which its illuminance is smooth.
//!
//! Planes through the receiver that contain the direction in which receiver's and disk's planes meet cut the disk in
//! parallel chords; the horizon is one of them. Let τ be the angle of such a plane, δ its angle from the plane through
//! the disk's topmost point, ξ the angle within it. Then cosθ cosθ′/d² dA = cos(τ − τₙ) cos²ξ dξ dτ, with τₙ the
//! direction of the receiver's normal: smooth however near the disk is, zero along the horizon, and elementary in ξ.
//! With δ = D sin²(χ/2) the chords' lengths are smooth in χ as well. Everything is measured from the nearer end, so
//! that nothing cancels for far, near or grazing receivers.

use spectral_core::Real;

use crate::shape::{Disk, Receiver};

/// The visible part of a disk.
#[derive(Clone, Copy, Debug)]
pub(super) struct Slices<R> {
    /// The receiver along the chords and across them, in radii, and its height.
    along: R,
    /// From the receiver's foot point to the topmost and the bottommost point.
    top: R,
    bottom: R,
    height: R,
    /// n·d at the topmost and the bottommost point, and its growth across.
    cosine_top: R,
    cosine_bottom: R,
    growth: R,
    /// The part of n·d that is the same everywhere.
    lift: R,
    /// The angle D between the planes through both.
    opening: R,
    /// The largest χ: π, or where the horizon is.
    pub(super) end: R,
    /// Whether the receiver was raised because it is at the rim.
    pub(super) is_blurred: bool,
    /// Unit vector across the chords, towards the top, in the disk's frame.
    across: [R; 2],
}

/// One chord.
#[derive(Clone, Copy, Debug)]
pub(super) struct Slice<R> {
    /// Its ends along itself from the receiver's foot, and from the disk's middle.
    ends: [R; 2],
    half: R,
    /// Its distance from the receiver; the place across from the disk's middle.
    distance: R,
    pub(super) across: R,
    /// The angle that it subtends, and ∫ cos²ξ dξ over it.
    angle: R,
    measure: R,
    /// cosθ′ at the point nearest to the receiver, the height over the distance.
    pub(super) slant: R,
    /// ∫ cosθ cosθ′/(π d²) over the chord, per unit of χ.
    pub(super) mass: R,
}

impl<R: Real> Slices<R> {
    /// The part of `disk` above the horizon of `receiver`; `None` when there is nothing, behind or in the plane of
    /// either, or when the squared distance overflows. A receiver less than ε² radii over the disk's plane, or on the
    /// disk itself, is taken to be that high; within 1024 ε radii of the rim, it is taken to be that much over it.
    pub(super) fn new(disk: &Disk<R>, receiver: &Receiver<R>) -> Option<Self> {
        let [x, y, height] = disk.local(receiver.position());
        let [nx, ny, nz] = disk.direction(receiver.normal());
        // So close to the rim, where it is differs from chord to chord by rounding.
        let blur = R::from_f64(1024.0) * R::EPSILON;
        let at_rim = (x.hypot(y) - R::ONE).abs() <= blur;
        let is_blurred = at_rim && height < blur;
        let floor = if at_rim { blur } else { R::EPSILON * R::EPSILON };
        let is_over = height > R::ZERO || (height == R::ZERO && x.hypot(y) <= R::ONE + blur);
        let height = if is_over { height.max(floor) } else { height };
        let limit = R::MAX.sqrt() * R::from_f64(0.01);
        if !(height > R::ZERO && x.abs().max(y.abs()).max(height) < limit) {
            return None;
        }
        let growth = nx.hypot(ny);
        let across = if growth > R::ZERO { [nx / growth, ny / growth] } else { towards(x, y) };
        let foot = x * across[0] + y * across[1];
        let along = y * across[0] - x * across[1];
        let (top, bottom) = (R::ONE - foot, -(R::ONE + foot));
        let cosine_top = growth * top - nz * height;
        let cosine_bottom = growth * bottom - nz * height;
        if !(cosine_top > R::ZERO) {
            return None;
        }
        let opening = (R::TWO * height).atan2(height * height + (foot - R::ONE) * (foot + R::ONE));
        let end = if cosine_bottom >= R::ZERO {
            R::PI
        } else {
            let horizon = cosine_top.atan2(nz * top + growth * height);
            R::TWO * (horizon / opening).min(R::ONE).sqrt().asin()
        };
        Some(Self {
            along,
            top,
            bottom,
            height,
            cosine_top,
            cosine_bottom,
            growth,
            lift: nz * height,
            opening,
            is_blurred,
            end,
            across,
        })
    }

    /// The chord at χ in [0, `end`].
    pub(super) fn at(&self, chi: R) -> Slice<R> {
        let (sin, cos) = ((chi * R::HALF).sin(), (chi * R::HALF).cos());
        // From the nearer end: how far the chord is from it, and from the foot.
        let is_upper = cos * cos >= R::HALF;
        let (share, away) = if is_upper { (sin * sin, self.top) } else { (cos * cos, -self.bottom) };
        let (depth, from_foot) = turned(self.opening * share, away, self.height);
        let side = if is_upper { R::ONE } else { -R::ONE };
        let (offset, across) = (side * from_foot, side * (R::ONE - depth));
        let cosine = if from_foot.abs() < depth {
            self.growth * offset - self.lift
        } else if is_upper {
            self.cosine_top - self.growth * depth
        } else {
            self.cosine_bottom + self.growth * depth
        };
        let half = (depth * (R::TWO - depth)).max(R::ZERO).sqrt();
        let distance = norm(offset, self.height);
        let ends = [-half - self.along, half - self.along];
        let reach = ends.map(|end| norm(end, distance));
        let angle = (R::TWO * half * distance).atan2(distance * distance + ends[0] * ends[1]);
        let slant = self.height / distance;
        let mut slice = Slice { ends, half, distance, across, angle, slant, measure: R::ZERO, mass: R::ZERO };
        slice.measure = slice.measure_between(ends, reach, angle);
        let turn = self.opening * sin * cos;
        slice.mass = (cosine / distance).max(R::ZERO) * slice.measure * turn / R::PI;
        slice
    }

    /// A point across and along a chord, in the disk's frame.
    pub(super) fn point(&self, across: R, along: R) -> [R; 2] {
        let [a, b] = self.across;
        [a * across - b * along, b * across + a * along]
    }
}

/// The unit vector from the middle to the receiver's foot: the chords across it are seen from the front.
fn towards<R: Real>(x: R, y: R) -> [R; 2] {
    let length = x.hypot(y);
    if length > R::ZERO { [x / length, y / length] } else { [R::ONE, R::ZERO] }
}

/// Where a ray from height `height` over a line meets it, after it is turned by `angle` from a point of the line at
/// `away` from the foot towards the foot: how far from that point, in [0, 2], and how far from the foot on its side.
/// Each is free of cancellation where it is small.
fn turned<R: Real>(angle: R, away: R, height: R) -> (R, R) {
    let reach = norm(away, height);
    let (sin, cos) = (angle.sin(), angle.cos());
    let below = height * cos + away * sin;
    let moved = (reach * (reach * sin / below)).clamp(R::ZERO, R::TWO);
    let near = height * ((away * cos - height * sin) / below);
    (moved, if near.abs() < moved { near } else { away - moved })
}

/// √(x² + y²) for numbers whose squares do not overflow; not less than either where squares underflow.
fn norm<R: Real>(x: R, y: R) -> R {
    (x * x + y * y).sqrt().max(x.abs()).max(y.abs())
}

impl<R: Real> Slice<R> {
    /// ∫ cos²ξ dξ = (Δ + sinΔ cosΣ)/2 = (Δ − sinΔ)/2 + sinΔ cos²(Σ/2), with Δ and Σ the difference and the sum of the
    /// limits.
    fn measure_between(&self, ends: [R; 2], reach: [R; 2], angle: R) -> R {
        let (sin, cos) =
            ([ends[0] / reach[0], ends[1] / reach[1]], [self.distance / reach[0], self.distance / reach[1]]);
        let sum_cos = cos[0] * cos[1] - sin[0] * sin[1];
        let sum_sin = sin[0] * cos[1] + cos[0] * sin[1];
        // 1 + cosΣ, without cancellation.
        let one_plus = if sum_cos < R::ZERO { sum_sin * sum_sin / (R::ONE - sum_cos) } else { R::ONE + sum_cos };
        let sine = angle.sin();
        R::HALF * (minus_sine(angle, sine) + sine * one_plus)
    }

    /// ∫ cos²ξ dξ between two fractions of the chord's angle, over that of the whole chord.
    pub(super) fn share(&self, from: R, to: R) -> R {
        if from <= R::ZERO && to >= R::ONE {
            return R::ONE;
        }
        let ends = [self.along(from).1, self.along(to).1];
        let reach = ends.map(|end| norm(end, self.distance));
        self.measure_between(ends, reach, (to - from) * self.angle) / self.measure
    }

    /// The point at a fraction of the angle: from the disk's middle, and from the receiver's foot.
    fn along(&self, fraction: R) -> (R, R) {
        let is_upper = fraction > R::HALF;
        let (share, away) = if is_upper { (R::ONE - fraction, self.ends[1]) } else { (fraction, -self.ends[0]) };
        let (inward, from_foot) = turned(self.angle * share, away, self.distance);
        let inward = inward.min(R::TWO * self.half);
        if is_upper { (self.half - inward, from_foot) } else { (inward - self.half, -from_foot) }
    }

    /// The fraction of the angle at a point `along` from the disk's middle; outside [0, 1] beyond the ends.
    pub(super) fn fraction(&self, along: R) -> R {
        let from_foot = self.ends[0] + self.half + along;
        let turn =
            (self.distance * (self.half + along)).atan2(self.distance * self.distance + from_foot * self.ends[0]);
        turn / self.angle
    }

    /// Across and along from the disk's middle, and cosξ, at a fraction of the angle.
    pub(super) fn sample(&self, fraction: R) -> ([R; 2], R) {
        let (along, from_foot) = self.along(fraction);
        ([self.across, along], self.distance / norm(from_foot, self.distance))
    }
}

/// x − sin x for x in [0, π].
fn minus_sine<R: Real>(x: R, sine: R) -> R {
    if x > R::HALF {
        return x - sine;
    }
    let y = x * x;
    let term = |n: f64, rest: R| R::ONE - y / R::from_f64(n) * rest;
    x * y / R::from_f64(6.0) * term(20.0, term(42.0, term(72.0, term(110.0, term(156.0, term(210.0, R::ONE))))))
}
