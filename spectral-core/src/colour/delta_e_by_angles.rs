//! ΔE00 by angles, step by step as the standard has it: `independent` of the form without them.

use crate::Real;

/// ΔE00 with the parametric factors `[k_L, k_C, k_H]`.
pub(super) fn delta_e_00_weighted<R: Real>(first: [R; 3], second: [R; 3], [k_l, k_c, k_h]: [R; 3]) -> R {
    let stretch = chroma_stretch(first, second);
    let (p, q) = (Polar::new(first, stretch), Polar::new(second, stretch));
    let hue = Hue::between(&p, &q);

    let mean_lightness = (first[0] + second[0]) * R::HALF;
    let mean_chroma = (p.chroma + q.chroma) * R::HALF;
    let offset = mean_lightness - R::from_f64(50.0);
    let square = offset * offset;
    let s_l = R::ONE + R::from_f64(0.015) * square / (R::from_f64(20.0) + square).sqrt();
    let s_c = R::ONE + R::from_f64(0.045) * mean_chroma;
    let s_h = R::ONE + R::from_f64(0.015) * mean_chroma * hue_dependence(hue.mean);

    let lightness = (second[0] - first[0]) / (k_l * s_l);
    let chroma = (q.chroma - p.chroma) / (k_c * s_c);
    let hue_difference = hue.difference / (k_h * s_h);
    let rotation = rotation(hue.mean, mean_chroma);
    let square =
        lightness * lightness + chroma * chroma + hue_difference * hue_difference + rotation * chroma * hue_difference;
    // The quadratic form is positive definite (|rotation| < 2), so that only rounding can take it below zero; and `max`
    // keeps NaN when it is the second operand.
    R::ZERO.max(square).sqrt()
}

/// A colour's a′, b′, chroma C′ and hue h′ in degrees, in [0°, 360°].
struct Polar<R> {
    a: R,
    b: R,
    chroma: R,
    hue: R,
}

impl<R: Real> Polar<R> {
    /// Equations 5 to 7.
    fn new([_, a, b]: [R; 3], stretch: R) -> Self {
        let a = a * stretch;
        let chroma = a.hypot(b);
        // The hue of a grey is 0 by convention; atan2 would tell −0 from 0.
        let angle = if chroma == R::ZERO { R::ZERO } else { degrees(b.atan2(a)) };
        let hue = if angle < R::ZERO { angle + R::from_f64(360.0) } else { angle };
        Self { a, b, chroma, hue }
    }
}

/// The hue difference ΔH′, in units of chroma, and the mean hue in degrees.
struct Hue<R> {
    difference: R,
    mean: R,
}

impl<R: Real> Hue<R> {
    /// Equations 10, 11 and 14.
    fn between(p: &Polar<R>, q: &Polar<R>) -> Self {
        if p.chroma == R::ZERO || q.chroma == R::ZERO {
            return Self { difference: R::ZERO, mean: p.hue + q.hue };
        }
        let turn = R::from_f64(360.0);
        let (angle, sum) = (q.hue - p.hue, p.hue + q.hue);
        // Whether the hues are at most 180° apart is read from the sign of the cross product: rounded angles of opposite
        // hues may differ by a little more or less than 180°, and the formula jumps there.
        let cross = p.a * q.b - q.a * p.b;
        let near = if angle < R::ZERO { cross <= R::ZERO } else { cross >= R::ZERO };
        let (angle, sum) = match (near, angle > R::ZERO, sum < turn) {
            (true, _, _) => (angle, sum),
            (false, true, true) => (angle - turn, sum + turn),
            (false, true, false) => (angle - turn, sum - turn),
            (false, false, true) => (angle + turn, sum + turn),
            (false, false, false) => (angle + turn, sum - turn),
        };
        let scale = p.chroma.sqrt() * q.chroma.sqrt();
        Self { difference: R::TWO * scale * radians(angle * R::HALF).sin(), mean: sum * R::HALF }
    }
}

/// 1 + G: the stretch of the a\* axis near grey (equations 2 to 5).
fn chroma_stretch<R: Real>(first: [R; 3], second: [R; 3]) -> R {
    let chroma = (first[1].hypot(first[2]) + second[1].hypot(second[2])) * R::HALF;
    R::ONE + R::HALF * (R::ONE - saturation(chroma))
}

/// √(C⁷ / (C⁷ + 25⁷)), as 1 / √(1 + (25/C)⁷) so that large chromas do not overflow.
fn saturation<R: Real>(chroma: R) -> R {
    let ratio = R::from_f64(25.0) / chroma;
    let cube = ratio * ratio * ratio;
    R::ONE / (R::ONE + cube * cube * ratio).sqrt()
}

/// T (equation 15), of the mean hue in degrees.
fn hue_dependence<R: Real>(hue: R) -> R {
    let wave = |amplitude: f64, multiple: f64, phase: f64| {
        R::from_f64(amplitude) * radians(R::from_f64(multiple) * hue + R::from_f64(phase)).cos()
    };
    R::ONE - wave(0.17, 1.0, -30.0) + wave(0.24, 2.0, 0.0) + wave(0.32, 3.0, 6.0) - wave(0.20, 4.0, -63.0)
}

/// The coupling `R_T` of chroma and hue differences among blues (equations 16, 17 and 21).
fn rotation<R: Real>(mean_hue: R, mean_chroma: R) -> R {
    let distance = (mean_hue - R::from_f64(275.0)) / R::from_f64(25.0);
    let angle = R::from_f64(60.0) * (-(distance * distance)).exp();
    -(R::TWO * saturation(mean_chroma) * radians(angle).sin())
}

fn radians<R: Real>(degrees: R) -> R {
    degrees * (R::PI / R::from_f64(180.0))
}

fn degrees<R: Real>(radians: R) -> R {
    radians * (R::from_f64(180.0) / R::PI)
}
