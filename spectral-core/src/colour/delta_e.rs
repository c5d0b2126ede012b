//! Colour differences between two CIELAB colours: ΔE\*ab (1976) and ΔE00 (CIEDE2000).

use crate::Real;

/// The CIE 1976 colour difference ΔE\*ab of two colours (L\*, a\*, b\*).
///
/// The Euclidean distance. Exactly symmetric; 0 for equal colours; accurate to 3 ε relative, the colours being
/// taken as exact. Differences whose square overflows (above 1e19 in `f32`, 1e154 in `f64`) give ∞, those whose square
/// underflows (below 1e-19, 1e-154) lose accuracy or give 0. NaN in, NaN out.
///
/// Source: ISO/CIE 11664-4:2019, equation 13.
#[inline]
#[must_use]
pub fn delta_e_ab<R: Real>(first: [R; 3], second: [R; 3]) -> R {
    let [l, a, b] = [second[0] - first[0], second[1] - first[1], second[2] - first[2]];
    (l * l + a * a + b * b).sqrt()
}

/// The CIEDE2000 colour difference ΔE00 of two colours (L\*, a\*, b\*), with k_L = k_C = k_H = 1.
///
/// Fitted to differences of surface colours up to about 5 units; larger values order colours, no more. Symmetric to
/// rounding. The formula jumps where two hues are 180° apart, by up to a few percent; exactly opposite hues take the
/// branch that the standard prescribes, and elsewhere `f32` is within 1e-4 + 1e-5 ΔE00 of `f64` for colours with |a\*|,
/// |b\*| ≤ 128. Finite for |a\*|, |b\*| up to 1e9 in `f32`, 1e100 in `f64`. NaN in, NaN out.
///
/// Source: CIE 142-2001, ISO/CIE 11664-6:2014, in the form of Sharma, Wu and Dalal, "The CIEDE2000 color-difference
/// formula: implementation notes, supplementary test data, and mathematical observations", Color Research and
/// Application 30 (2005), 21–30, equations 2 to 22.
///
/// ```
/// use spectral_core::colour::delta_e_00;
/// let difference: f64 = delta_e_00([50.0, 2.6772, -79.7751], [50.0, 0.0, -82.7485]);
/// assert!((difference - 2.0425).abs() <= 5e-5);
/// ```
#[inline]
#[must_use]
pub fn delta_e_00<R: Real>(first: [R; 3], second: [R; 3]) -> R {
    delta_e_00_weighted(first, second, [R::ONE; 3])
}

/// [`delta_e_00`] with the parametric factors (k_L, k_C, k_H) of the viewing conditions, which must be positive;
/// textiles are often compared with k_L = 2.
#[must_use]
pub fn delta_e_00_weighted<R: Real>(first: [R; 3], second: [R; 3], [k_l, k_c, k_h]: [R; 3]) -> R {
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

/// R_T: the coupling of chroma and hue differences among blues (equations 16, 17 and 21).
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

#[cfg(test)]
#[allow(clippy::float_cmp, reason = "exact values are what is stated")]
mod tests {
    use super::*;
    use crate::colour::in_precision;

    /// `published`: Sharma, Wu and Dalal 2005, table 1: two colours and ΔE00 rounded to four decimals.
    #[rustfmt::skip]
    const SHARMA: [([f64; 3], [f64; 3], f64); 34] = [
        ([50.0, 2.677_2, -79.775_1], [50.0, 0.0, -82.748_5], 2.042_5),
        ([50.0, 3.157_1, -77.280_3], [50.0, 0.0, -82.748_5], 2.861_5),
        ([50.0, 2.836_1, -74.02], [50.0, 0.0, -82.748_5], 3.441_2),
        ([50.0, -1.380_2, -84.281_4], [50.0, 0.0, -82.748_5], 1.0),
        ([50.0, -1.184_8, -84.800_6], [50.0, 0.0, -82.748_5], 1.0),
        ([50.0, -0.900_9, -85.521_1], [50.0, 0.0, -82.748_5], 1.0),
        ([50.0, 0.0, 0.0], [50.0, -1.0, 2.0], 2.366_9),
        ([50.0, -1.0, 2.0], [50.0, 0.0, 0.0], 2.366_9),
        ([50.0, 2.49, -0.001], [50.0, -2.49, 0.000_9], 7.179_2),
        ([50.0, 2.49, -0.001], [50.0, -2.49, 0.001], 7.179_2),
        ([50.0, 2.49, -0.001], [50.0, -2.49, 0.001_1], 7.219_5),
        ([50.0, 2.49, -0.001], [50.0, -2.49, 0.001_2], 7.219_5),
        ([50.0, -0.001, 2.49], [50.0, 0.000_9, -2.49], 4.804_5),
        ([50.0, -0.001, 2.49], [50.0, 0.001, -2.49], 4.804_5),
        ([50.0, -0.001, 2.49], [50.0, 0.001_1, -2.49], 4.746_1),
        ([50.0, 2.5, 0.0], [50.0, 0.0, -2.5], 4.306_5),
        ([50.0, 2.5, 0.0], [73.0, 25.0, -18.0], 27.149_2),
        ([50.0, 2.5, 0.0], [61.0, -5.0, 29.0], 22.897_7),
        ([50.0, 2.5, 0.0], [56.0, -27.0, -3.0], 31.903),
        ([50.0, 2.5, 0.0], [58.0, 24.0, 15.0], 19.453_5),
        ([50.0, 2.5, 0.0], [50.0, 3.173_6, 0.585_4], 1.0),
        ([50.0, 2.5, 0.0], [50.0, 3.297_2, 0.0], 1.0),
        ([50.0, 2.5, 0.0], [50.0, 1.863_4, 0.575_7], 1.0),
        ([50.0, 2.5, 0.0], [50.0, 3.259_2, 0.335], 1.0),
        ([60.257_4, -34.009_9, 36.267_7], [60.462_6, -34.175_1, 39.438_7], 1.264_4),
        ([63.010_9, -31.096_1, -5.866_3], [62.818_7, -29.794_6, -4.086_4], 1.263),
        ([61.290_1, 3.719_6, -5.390_1], [61.429_2, 2.248, -4.962], 1.873_1),
        ([35.083_1, -44.116_4, 3.793_3], [35.023_2, -40.071_6, 1.590_1], 1.864_5),
        ([22.723_3, 20.090_4, -46.694], [23.033_1, 14.973, -42.561_9], 2.037_3),
        ([36.461_2, 47.858, 18.385_2], [36.271_5, 50.506_5, 21.223_1], 1.414_6),
        ([90.802_7, -2.083_1, 1.441], [91.152_8, -1.643_5, 0.044_7], 1.444_1),
        ([90.925_7, -0.540_6, -0.920_8], [88.638_1, -0.898_5, -0.723_9], 1.538_1),
        ([6.774_7, -0.290_8, -2.424_7], [5.871_4, -0.098_5, -2.228_6], 0.637_7),
        ([2.077_6, 0.079_5, -1.135], [0.903_3, -0.063_6, -0.551_4], 0.908_2),
    ];

    #[test]
    fn reproduces_the_published_pairs() {
        for (first, second, expected) in SHARMA {
            for (p, q) in [(first, second), (second, first)] {
                let actual = delta_e_00(p, q);
                assert!((actual - expected).abs() <= 1e-4, "{p:?} {q:?}: {actual}, published {expected}");
            }
        }
    }

    #[test]
    fn single_precision_reproduces_the_published_pairs() {
        for (first, second, expected) in SHARMA {
            let actual = f64::from(delta_e_00::<f32>(in_precision(first), in_precision(second)));
            // The colours themselves move by up to 4e-6 when rounded.
            assert!((actual - expected).abs() <= 1e-4, "{first:?} {second:?}: {actual}, published {expected}");
        }
    }

    /// A fixed sequence of colours in L\* 0…100, a\* and b\* −128…128, each representable in `f32`.
    fn colours(count: u32) -> impl Iterator<Item = [f64; 3]> {
        let mut state = 1_u64;
        let mut unit = move || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            f64::from(u16::try_from(state >> 48).unwrap()) / 65_536.0
        };
        (0..count)
            .map(move |_| [100.0 * unit(), 256.0 * unit() - 128.0, 256.0 * unit() - 128.0])
            .map(|lab| lab.map(|c| f64::from(f32::from_f64(c))))
    }

    #[test]
    fn single_precision_is_as_accurate_as_stated() {
        for (first, second) in colours(100_000).zip(colours(100_007).skip(7)) {
            // Near opposite hues the formula jumps.
            if near_opposite(first, second) {
                continue;
            }
            let exact = delta_e_00(first, second);
            let single = f64::from(delta_e_00::<f32>(in_precision(first), in_precision(second)));
            assert!((single - exact).abs() <= 1e-4 + 1e-5 * exact, "{first:?} {second:?}: {single}, exact {exact}");
        }
    }

    fn near_opposite([_, a, b]: [f64; 3], [_, c, d]: [f64; 3]) -> bool {
        let (cross, dot) = (a * d - b * c, a * c + b * d);
        dot < 0.0 && cross.abs() <= 1e-3 * dot.abs()
    }

    /// `independent`: `delta_E` of colour-science 0.4.7, methods CIE 1976 and CIE 2000, on large differences.
    #[test]
    fn agrees_with_colour_science_far_apart() {
        let cases = [
            ([61.29, 3.7, -5.39], [35.08, -44.12, 3.79], 55.299_085_887_562_37, 39.669_667_635_036_84),
            ([20.0, 60.0, -90.0], [22.0, 55.0, -70.0], 20.712_315_177_207_98, 6.143_658_375_562_895),
            ([97.0, -30.0, 80.0], [60.0, 40.0, -80.0], 178.518_906_561_742_08, 84.330_718_035_811_23),
        ];
        for (first, second, ab, ciede) in cases {
            assert!((delta_e_ab(first, second) - ab).abs() <= 4.0 * f64::EPSILON * ab);
            assert!((delta_e_00(first, second) - ciede).abs() <= 1e-12 * ciede);
        }
    }

    #[test]
    fn equal_colours_do_not_differ() {
        for lab in [[0.0; 3], [-0.0; 3], [50.0, -0.0, 0.0], [100.0, -80.0, 1e-320], [1e9, -1e9, 1e9]] {
            assert_eq!(delta_e_ab(lab, lab), 0.0);
            assert_eq!(delta_e_00(lab, lab), 0.0);
        }
    }

    #[test]
    fn a_grey_has_no_hue() {
        // A hue read from the signs of zeros would move the mean hue of these pairs.
        let chromatic = [50.0, 10.0, 20.0];
        let expected = delta_e_00([50.0, 0.0, 0.0], chromatic);
        for grey in [[50.0, -0.0, 0.0], [50.0, 0.0, -0.0], [50.0, -0.0, -0.0]] {
            assert_eq!(delta_e_00(grey, chromatic), expected);
        }
    }

    #[test]
    fn weights_divide_each_part() {
        let doubled = delta_e_00_weighted([40.0, 0.0, 0.0], [60.0, 0.0, 0.0], [2.0, 1.0, 1.0_f64]);
        let single = delta_e_00([40.0, 0.0, 0.0], [60.0, 0.0, 0.0]);
        assert!((single - 20.0).abs() <= 1e-13, "S_L is 1 at L* = 50");
        assert_eq!(doubled, single / 2.0);
    }

    #[test]
    fn huge_and_not_finite_values() {
        let huge = delta_e_00([50.0, 1e9, -1e9_f32], [50.0, -1e9, 1e9]);
        assert!(huge.is_finite() && huge > 0.0, "{huge}");
        let huge = delta_e_00([50.0, 1e100, -1e100_f64], [50.0, -1e100, 1e100]);
        assert!(huge.is_finite() && huge > 0.0, "{huge}");
        assert_eq!(delta_e_ab([1e200, 0.0, 0.0], [0.0; 3]), f64::INFINITY);
        for position in 0..3 {
            for bad in [f64::NAN, f64::INFINITY] {
                let mut lab = [50.0, 10.0, 10.0];
                lab[position] = bad;
                assert!(!delta_e_ab(lab, [50.0; 3]).is_finite());
                assert!(!delta_e_00(lab, [50.0; 3]).is_finite(), "{lab:?}: {}", delta_e_00(lab, [50.0; 3]));
            }
        }
    }
}
