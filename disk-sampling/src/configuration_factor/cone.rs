//! The elliptic cone that a disk or a sphere fills, cut by the horizon.
//!
//! In the frame (ξ, η, ζ) of its principal axes a cone is (ξ / tan β)² + (η / tan α)² ≤ ζ², ζ ≥ 0, with half angles β ≤ α. Its rim
//! is x(t) = (sin β cos α cos t, sin α cos β sin t, cos α cos β), finite for every half angle up to 90°, and the horizon cuts it
//! where n·x(t) = M (cos(t − t₀) − cos ω) changes sign.

use spectral_core::Real;

use super::angle::squared_cosine;
use super::gauss::integrate;
use super::keeps_digits;
use crate::vector::{Vector, cross, dot, length};

/// Half angles of an elliptic cone by their sines and cosines.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cone<R> {
    /// Sine and cosine of β, along ξ.
    pub(super) narrow: [R; 2],
    /// Sine and cosine of α, along η.
    pub(super) wide: [R; 2],
}

/// A horizon that cuts a cone, t₁ = t₀ − ω and t₂ = t₀ + ω being where it meets the rim.
#[derive(Clone, Copy, Debug)]
pub(super) struct Horizon<R> {
    /// The element's unit normal in the frame (ξ, η, ζ).
    pub(super) normal: Vector<R>,
    /// M sin ω.
    pub(super) chord: R,
    /// M² sin t₁ sin t₂.
    pub(super) ends: R,
}

impl<R: Real> Cone<R> {
    /// The length of the irradiance vector, which points along ζ: sin α sin β.
    pub(super) fn irradiance(&self) -> R {
        self.narrow[0] * self.wide[0]
    }

    /// The configuration factor to an element whose horizon cuts the cone.
    pub(super) fn cut(&self, horizon: &Horizon<R>) -> R {
        if !(self.irradiance() > R::ZERO) {
            return R::ZERO;
        }
        let n = horizon.normal;
        let below = n[2] > R::ZERO;
        let whole = if below { n[2] * self.irradiance() } else { R::ZERO };
        // More than half is visible: the whole less what the opposite element sees, which has the other sign.
        let n = if below { n.map(|x| -x) } else { n };
        // The cone's symmetry lets the rest work in one quadrant.
        let cut = Cut::new(*self, &Horizon { normal: n.map(R::abs), ..*horizon });
        let (sum, difference) = cut.closed_form();
        let factor = whole + difference;
        if keeps_digits(factor, sum) {
            return factor;
        }
        let rest = if self.narrow[0] >= self.narrow[1] { cut.by_azimuth() } else { cut.by_planes() };
        // Squares of angles that underflow leave 0/0 of a part that is next to nothing.
        if rest.is_finite() { whole + rest } else { whole }
    }
}

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
    /// cos t₀ and sin t₀.
    middle_cosine: R,
    middle_sine: R,
    /// Cosine and sine of t₁ and t₂.
    first: [R; 2],
    last: [R; 2],
}

impl<R: Real> Cut<R> {
    fn new(cone: Cone<R>, horizon: &Horizon<R>) -> Self {
        let (n, chord) = (horizon.normal, horizon.chord);
        let ([sin_b, cos_b], [sin_a, cos_a]) = (cone.narrow, cone.wide);
        let axes = [sin_b * cos_a, sin_a * cos_b, cos_a * cos_b];
        let level = axes[2] * n[2];
        let amplitude = level.hypot(chord);
        let (x, y) = (axes[0] * n[0], axes[1] * n[1]);
        let m = x.hypot(y);
        let (middle_cosine, middle_sine) = if m > R::ZERO { (x / m, y / m) } else { (R::ONE, R::ZERO) };
        let (cosine, sine) = (level / amplitude, chord / amplitude);
        let turned = |s: R| [middle_cosine * cosine - middle_sine * s, middle_sine * cosine + middle_cosine * s];
        // The difference sin t₁ from the product: where the rim passes close by, at t = 0, ε is not exact enough. The product itself
        // is known to ε²: where sin t₂ is small, too, that is less than the difference tells.
        let (first, last) = (turned(-sine), turned(sine));
        let is_apart = last[1] * last[1] > R::from_f64(16.0) * R::EPSILON;
        let first = if is_apart { [first[0], horizon.ends / (amplitude * amplitude * last[1])] } else { first };
        Self {
            n,
            axes,
            cone,
            eccentricity2: ((cos_b - cos_a) * (cos_b + cos_a)).max(R::ZERO),
            amplitude,
            half_angle: chord.atan2(level),
            cosine,
            sine,
            middle_cosine,
            middle_sine,
            first,
            last,
        }
    }

    fn rim(&self, [c, s]: [R; 2]) -> Vector<R> {
        [self.axes[0] * c, self.axes[1] * s, self.axes[2]]
    }

    /// The contour integral over arc and chord, ∮ n·(x × dx) / (2π x²): the sum of the terms' sizes, and the factor.
    fn closed_form(&self) -> (R, R) {
        let ([sin_b, cos_b], [sin_a, cos_a]) = (self.cone.narrow, self.cone.wide);
        let (first, last) = (self.first, self.last);
        let (x, y) = (self.rim(first), self.rim(last));
        let chord = length(cross(x, y)).atan2(dot(x, y));
        // ∫ dt / x², ∫ cos t dt / x², ∫ sin t dt / x² over the arc, each times its factor.
        // Errors of both ends cancel to first order as long as all terms work from the same rounded ends.
        let (cosines, sines) = (first[0] * last[0], first[1] * last[1]);
        let round = (cos_a * cos_b * (last[1] * first[0] - first[1] * last[0]).max(R::ZERO))
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

    /// The arc's ends: t = t₀ − ω, and π − t for t = t₀ + ω. Near zero they keep their relative accuracy, as they must: there the
    /// rim passes so close by that x(t) is hardly longer than cos α.
    fn ends(&self) -> [R; 2] {
        [self.first[1].atan2(self.first[0]), self.last[1].atan2(-self.last[0])]
    }

    /// How far the poles of 1 / x(t)² at t = 0 are from the real axis, at least.
    fn rim_pole(&self) -> R {
        self.cone.wide[1] / self.cone.narrow[1]
    }

    /// M (cos(t − t₀) − cos ω) over M, `u` from one of the arc's ends.
    fn rise(&self, u: R) -> R {
        R::TWO * (self.half_angle - R::HALF * u).sin() * (R::HALF * u).sin()
    }

    /// ∫ sin² e dψ / 2π over the azimuth ψ, with e the elevation of the rim above the horizon.
    fn by_azimuth(&self) -> R {
        let [b, a, k] = self.axes;
        let pole = R::from_f64(0.7) * self.rim_pole();
        let half = |n: R, start: R, length: R| {
            let integrand = |t: R, u: R| {
                let [c, s] = [t.cos(), t.sin()];
                let x = self.rim([c, s]);
                let height = self.amplitude * self.rise(u);
                let turn = a * b * self.n[2] + k * (a * n * c + b * self.n[1] * s);
                let (height2, x2) = (height * height, dot(x, x));
                height2 / x2 * (turn / (x2 - height2))
            };
            integrate_from(start, length, |t, _| t.hypot(pole), integrand)
        };
        let [first, last] = self.ends();
        let quarter = R::HALF * R::PI;
        let near = half(self.n[0], first, (quarter - first).min(R::TWO * self.half_angle));
        let far = if last < quarter { half(-self.n[0], last, quarter - last) } else { R::ZERO };
        (near + far) * R::HALF / R::PI
    }

    /// ∫ sin φ (∫ cos² γ dγ) dφ / π over the planes through the direction of the chord: φ the plane's angle to the horizon, γ the
    /// angle within it; the inner integral in closed form, the outer one over half of the arc.
    fn by_planes(&self) -> R {
        let [b, a, k] = self.axes;
        let (c0, s0) = (self.middle_cosine, self.middle_sine);
        let (along, across) = (a * a * c0, b * b * s0);
        let p = across * s0 + along * c0;
        let ab = a * b;
        let rim_pole = self.rim_pole();
        let x = p.sqrt() * k / ab;
        let axis_pole = x / R::ONE.hypot(x);
        let to_axis = self.cosine.atan2(self.sine);
        let [first, last] = self.ends();
        let turned_back = self.last[0] < R::ZERO;
        let end = self.last[1].atan2(self.last[0]);
        // t runs from the chord to the middle of the arc; π − t of the opposite point is as far from its own end.
        let distance = |t: R, u: R| t.abs().min(last + u).hypot(rim_pole).min((to_axis + u).hypot(axis_pole));
        let integrand = |t: R, u: R| {
            let rise = self.rise(u);
            let v = self.cosine + rise;
            let w = (self.half_angle - u).sin();
            let d2 = p * k * k + v * v * ab * ab;
            let d = d2.sqrt();
            let [c, s] = if turned_back {
                let opposite = last + u;
                [-opposite.cos(), opposite.sin()]
            } else {
                [(end - u).cos(), (end - u).sin()]
            };
            let low = along * t.sin() - across * t.cos();
            let high = along * s - across * c;
            rise * (w / d) * (p / d2) * squared_cosine([low / d, high / d], R::TWO * p * w / d)
        };
        integrate_from(first, self.half_angle, distance, integrand) * k * ab * self.amplitude / R::PI
    }
}

/// ∫ `integrand`(t, t − `start`) dt over `length` from `start`, with t near zero as accurate as t − `start` near the start.
fn integrate_from<R: Real>(start: R, length: R, distance: impl Fn(R, R) -> R, integrand: impl Fn(R, R) -> R) -> R {
    if start >= R::ZERO {
        return integrate(length, |u| distance(start + u, u), |u| integrand(start + u, u));
    }
    let before = (-start).min(length);
    let rest = before - R::HALF * before;
    let (back, forth) = (before + start, |x| x - start);
    integrate(R::HALF * before, |u| distance(start + u, u), |u| integrand(start + u, u))
        + integrate(rest, |x| distance(back - x, forth(back - x)), |x| integrand(back - x, forth(back - x)))
        + if length > before {
            integrate(length - before, |t| distance(t, forth(t)), |t| integrand(t, forth(t)))
        } else {
            R::ZERO
        }
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
