//! The elliptic cone that a disk or a sphere fills, cut by the horizon.
//!
//! In the frame (ξ, η, ζ) of its principal axes a cone is (ξ / tan β)² + (η / tan α)² ≤ ζ², ζ ≥ 0, with half angles β ≤ α. Its rim
//! is x(t) = (sin β cos α cos t, sin α cos β sin t, cos α cos β), finite for every half angle up to 90°, and the horizon cuts it
//! where n·x(t) = M (cos(t − t₀) − cos ω) changes sign.

use spectral_core::Real;

use super::gauss::integrate;
use crate::vector::{Vector, cross, dot, length};

/// Half angles of an elliptic cone by their sines and cosines.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cone<R> {
    /// Sine and cosine of β, along ξ.
    pub(super) narrow: [R; 2],
    /// Sine and cosine of α, along η.
    pub(super) wide: [R; 2],
}

impl<R: Real> Cone<R> {
    /// The length of the irradiance vector, which points along ζ: sin α sin β.
    pub(super) fn irradiance(&self) -> R {
        self.narrow[0] * self.wide[0]
    }

    /// The configuration factor to an element of normal `n` (in the cone's frame) whose horizon cuts the cone. `chord` is
    /// M sin ω, half of what the horizon spans of x(t).
    pub(super) fn cut(&self, n: Vector<R>, chord: R) -> R {
        let below = n[2] > R::ZERO;
        let whole = if below { n[2] * self.irradiance() } else { R::ZERO };
        // More than half is visible: the whole less what the opposite element sees, which has the other sign.
        let n = if below { n.map(|x| -x) } else { n };
        // The cone's symmetry lets the rest work in one quadrant.
        let cut = Cut::new(*self, [n[0].abs(), n[1].abs(), n[2].abs()], chord);
        let (sum, difference) = cut.closed_form();
        let factor = whole + difference;
        if factor * R::from_f64(CANCELLATION) >= sum {
            return factor;
        }
        whole + if self.narrow[0] >= self.narrow[1] { cut.by_azimuth() } else { cut.by_planes() }
    }
}

/// How much smaller than its terms the closed form may come out: 5 bits are lost at most.
const CANCELLATION: f64 = 32.0;

/// The smaller part of a cone, cut by a horizon above the axis: n = (n_ξ, n_η, −n_ζ), all of `n` ≥ 0.
struct Cut<R> {
    n: Vector<R>,
    /// sin β cos α, sin α cos β, cos α cos β: the semi-axes of the rim and its height.
    axes: Vector<R>,
    cone: Cone<R>,
    /// cos² β − cos² α = sin² α − sin² β.
    eccentricity2: R,
    amplitude: R,
    /// ω with its cosine and sine.
    half_angle: R,
    cosine: R,
    sine: R,
    /// t₀ with its cosine and sine.
    middle: R,
    middle_cosine: R,
    middle_sine: R,
}

impl<R: Real> Cut<R> {
    fn new(cone: Cone<R>, n: Vector<R>, chord: R) -> Self {
        let ([sin_b, cos_b], [sin_a, cos_a]) = (cone.narrow, cone.wide);
        let axes = [sin_b * cos_a, sin_a * cos_b, cos_a * cos_b];
        let level = axes[2] * n[2];
        let amplitude = level.hypot(chord);
        let (x, y) = (axes[0] * n[0], axes[1] * n[1]);
        let m = x.hypot(y);
        let (middle_cosine, middle_sine) = if m > R::ZERO { (x / m, y / m) } else { (R::ONE, R::ZERO) };
        Self {
            n,
            axes,
            cone,
            eccentricity2: ((cos_b - cos_a) * (cos_b + cos_a)).max(R::ZERO),
            amplitude,
            half_angle: chord.atan2(level),
            cosine: level / amplitude,
            sine: chord / amplitude,
            middle: y.atan2(x),
            middle_cosine,
            middle_sine,
        }
    }

    /// cos t and sin t at t = t₀ + the angle of the given cosine and sine.
    fn turned(&self, [c, s]: [R; 2]) -> [R; 2] {
        let (c0, s0) = (self.middle_cosine, self.middle_sine);
        [c0 * c - s0 * s, s0 * c + c0 * s]
    }

    fn rim(&self, [c, s]: [R; 2]) -> Vector<R> {
        [self.axes[0] * c, self.axes[1] * s, self.axes[2]]
    }

    /// The contour integral over arc and chord, ∮ n·(x × dx) / (2π x²): the sum of the terms' sizes, and the factor.
    fn closed_form(&self) -> (R, R) {
        let ([sin_b, cos_b], [sin_a, cos_a]) = (self.cone.narrow, self.cone.wide);
        let first = self.turned([self.cosine, -self.sine]);
        let last = self.turned([self.cosine, self.sine]);
        let (x, y) = (self.rim(first), self.rim(last));
        let chord = length(cross(x, y)).atan2(dot(x, y));
        // ∫ dt / x², ∫ cos t dt / x², ∫ sin t dt / x² over the arc, each times its factor.
        // Errors of both ends cancel to first order as long as all terms work from the same rounded ends.
        let (cosines, sines) = (first[0] * last[0], first[1] * last[1]);
        let round = (cos_a * cos_b * (last[1] * first[0] - first[1] * last[0]))
            .atan2(cos_a * cos_a * cosines + cos_b * cos_b * sines)
            * self.n[2]
            * sin_a
            * sin_b;
        let e2 = self.eccentricity2;
        let e = e2.sqrt();
        let along = e_quotient(
            e,
            (e * cos_a * (last[1] - first[1])).atan2(cos_a * cos_a + e2 * sines),
            (last[1] - first[1]) / cos_a,
        ) * self.n[0]
            * sin_a
            * cos_b
            * cos_b;
        let slope = cos_b * (first[0] - last[0]) / (cos_b * cos_b - e2 * cosines);
        let across = if e * slope < R::HALF {
            e_quotient(e, atanh(e * slope), slope)
        } else {
            // cos β − e cos t, with e² = cos² β − cos² α.
            let gap = |[c, s]: [R; 2]| {
                if c > R::ZERO { (cos_a * cos_a + e2 * s * s) / (cos_b + e * c) } else { cos_b - e * c }
            };
            let opposite = |[c, s]: [R; 2]| [-c, s];
            R::HALF * (gap(opposite(first)) / gap(first) * (gap(last) / gap(opposite(last)))).ln() / e
        } * self.n[1]
            * sin_b
            * cos_a
            * cos_a;
        let arc = round + along + across;
        let scale = R::HALF / R::PI;
        // Both ends of a short arc are known to ε, not to ε times its length.
        (scale * (chord + arc.abs() + sin_a), scale * (chord - arc))
    }

    /// ∫ sin² e dψ / 2π over the azimuth ψ, with e the elevation of the rim above the horizon.
    fn by_azimuth(&self) -> R {
        let [b, a, k] = self.axes;
        let pole = R::from_f64(0.7) * self.cone.wide[1] / self.cone.narrow[1];
        let distance = |t: R| {
            let near = (t + self.middle).abs().min((R::PI - self.middle - t).abs());
            near.hypot(pole)
        };
        let integrand = |t: R| {
            let [c, s] = self.turned([t.cos(), t.sin()]);
            let x = self.rim([c, s]);
            let height = R::TWO
                * self.amplitude
                * (R::HALF * (self.half_angle + t)).sin()
                * (R::HALF * (self.half_angle - t)).sin();
            let turn = a * b * self.n[2] + k * (a * self.n[0] * c + b * self.n[1] * s);
            let (height2, x2) = (height * height, dot(x, x));
            height2 / x2 * (turn / (x2 - height2))
        };
        integrate(-self.half_angle, self.half_angle, distance, integrand) * R::HALF / R::PI
    }

    /// ∫ sin φ (∫ cos² γ dγ) dφ / π over the planes through the direction of the chord: φ the plane's angle to the horizon, γ the
    /// angle within it; the inner integral in closed form, the outer one over the arc.
    fn by_planes(&self) -> R {
        let [b, a, k] = self.axes;
        let (c0, s0) = (self.middle_cosine, self.middle_sine);
        let p = b * b * s0 * s0 + a * a * c0 * c0;
        let slope = s0 * c0 * self.eccentricity2;
        let ab = a * b;
        let rim_pole = self.cone.wide[1] / self.cone.narrow[1];
        let x = p.sqrt() * k / ab;
        let axis_pole = x / R::ONE.hypot(x);
        let to_axis = self.cosine.atan2(self.sine);
        // The variable u = ω − τ runs from the chord to the far end of the arc.
        let distance = |u: R| {
            let tau = self.half_angle - u;
            let rim = (tau - self.middle).abs().min((R::PI - self.middle - tau).abs()).hypot(rim_pole);
            rim.min((to_axis + u).hypot(axis_pole))
        };
        let integrand = |u: R| {
            let rise = R::TWO * (self.half_angle - R::HALF * u).sin() * (R::HALF * u).sin();
            let v = self.cosine + rise;
            let w = (self.half_angle - u).sin();
            let d2 = p * k * k + v * v * ab * ab;
            let d = d2.sqrt();
            rise * w * (p / (d2 * d)) * squared_cosine(v * slope, p * w, d)
        };
        integrate(R::ZERO, self.half_angle, distance, integrand) * k * ab * self.amplitude / R::PI
    }
}

/// ∫ cos² γ dγ between the angles whose tangents are (m ∓ w) / d.
fn squared_cosine<R: Real>(m: R, w: R, d: R) -> R {
    let (low, high) = ((m - w) / d, (m + w) / d);
    let gap = R::TWO * w / d;
    let product = low * high;
    let g = ((R::ONE + low * low) * (R::ONE + high * high)).sqrt();
    let angle = gap.atan2(R::ONE + product);
    let sine = gap / g;
    // 1 + cos of the sum of both angles.
    let sum = if product > R::ONE {
        let s = low + high;
        s * s / (g * (g + product - R::ONE))
    } else {
        R::ONE + (R::ONE - product) / g
    };
    R::HALF * (angle_minus_sine(angle, sine) + sine * sum)
}

/// x − sin x, `sine` being sin x.
fn angle_minus_sine<R: Real>(x: R, sine: R) -> R {
    let x2 = x * x;
    if x2 > R::from_f64(0.25) {
        return x - sine;
    }
    let mut term = x * x2 / R::from_f64(6.0);
    let mut sum = term;
    for k in [20.0, 42.0, 72.0, 110.0, 156.0, 210.0] {
        term = -term * x2 / R::from_f64(k);
        sum += term;
    }
    sum
}

/// `value` / `e`, or its limit where e is zero.
fn e_quotient<R: Real>(e: R, value: R, limit: R) -> R {
    if e > R::ZERO { value / e } else { limit }
}

/// Inverse hyperbolic tangent of values in [0, 1/2].
fn atanh<R: Real>(w: R) -> R {
    let x = R::TWO * w / (R::ONE - w);
    let u = R::ONE + x;
    // Kahan's ln(1 + x).
    let log = if u == R::ONE { x } else { u.ln() * (x / (u - R::ONE)) };
    R::HALF * log
}
