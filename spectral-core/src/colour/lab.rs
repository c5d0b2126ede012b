//! CIE 1976 L\*a\*b\* (CIELAB), and the function f under it, monotone to the last bit.
//!
//! All constants are the exact rational ones of ISO/CIE 11664-4:2019 (δ = 6/29), not the rounded 0.008856 and 903.3
//! of older texts.

use crate::Real;

/// δ = 6/29: f where its two branches meet.
const DELTA: f64 = 6.0 / 29.0;
/// δ³: the argument where the two branches of f meet.
const DELTA_CUBED: f64 = 216.0 / 24_389.0;
/// 1 / (3 δ²): the slope of the linear branch.
const SLOPE: f64 = 841.0 / 108.0;
/// 4/29: f(0).
const OFFSET: f64 = 4.0 / 29.0;

/// The function f of CIELAB, of a tristimulus value relative to that of the white.
///
/// f(t) = t^⅓ for t > δ³, and t / (3δ²) + 4/29 otherwise, with δ = 6/29. The linear branch goes on without limit below
/// zero: f is defined for every number. f(±∞) = ±∞, f(NaN) = NaN.
///
/// **Monotone to the last bit**: a ≤ b implies f(a) ≤ f(b), in `f32` and in `f64`, also where the branches meet. The
/// linear branch is a monotone function rounded twice; `libm`'s cube roots are correctly rounded; and each branch is
/// limited to its side of δ. So the image of an interval is the interval of the images of its ends, and a bound
/// may be taken there.
///
/// **Accuracy**: |computed − exact| ≤ 1.25 ε f(t) for t ≥ 0, and ≤ 1.5 ε (|f(t)| + 4/29) below, with ε the machine
/// epsilon, the argument being taken as exact.
///
/// Source: ISO/CIE 11664-4:2019, equations 4 to 9.
///
/// ```
/// use spectral_core::colour::lab_f;
/// assert_eq!(lab_f(1.0), 1.0);
/// assert_eq!(lab_f(0.0), 4.0 / 29.0);
/// assert_eq!(lab_f(-f32::INFINITY), -f32::INFINITY);
/// ```
#[inline]
#[must_use]
pub fn lab_f<R: Real>(t: R) -> R {
    let delta = R::from_f64(DELTA);
    // The order of the operands matters: `min` and `max` return the second one for NaN.
    if t > R::from_f64(DELTA_CUBED) {
        delta.max(t.cbrt())
    } else {
        delta.min(t * R::from_f64(SLOPE) + R::from_f64(OFFSET))
    }
}

/// The inverse of [`lab_f`].
///
/// f⁻¹(s) = s³ for s > δ, and 3δ² (s − 4/29) otherwise. Defined for every number; s³ overflows to ∞ beyond the cube
/// root of the largest number. Monotone to the last bit, as [`lab_f`] is. Accurate to 2 ε relative for s > δ and to
/// 2 ε 3δ² (|s| + 4/29) below; f⁻¹(f(t)) comes back to 6 ε max(|t|, δ³).
///
/// Source: ISO/CIE 11664-4:2019, annex B.
#[inline]
#[must_use]
pub fn lab_f_inverse<R: Real>(s: R) -> R {
    let delta_cubed = R::from_f64(DELTA_CUBED);
    if s > R::from_f64(DELTA) {
        delta_cubed.max(s * s * s)
    } else {
        delta_cubed.min((s - R::from_f64(OFFSET)) / R::from_f64(SLOPE))
    }
}

/// CIELAB (L\*, a\*, b\*) of tristimulus values, relative to a white.
///
/// L\* = 116 f(Y/Yₙ) − 16, a\* = 500 (f(X/Xₙ) − f(Y/Yₙ)), b\* = 200 (f(Y/Yₙ) − f(Z/Zₙ)), with f as [`lab_f`]. The
/// white is L\* = 100, a\* = b\* = 0, exactly; black is 0, 0, 0 to rounding. Negative tristimulus values are carried on
/// along the linear branch. The white must be positive; with a component 0, infinite or NaN in it, and
/// when tristimulus values are not finite, what comes out is infinite or NaN.
///
/// Accurate to 4 ε times 116, 500 and 200 times the f's.
///
/// Source: ISO/CIE 11664-4:2019, equations 1 to 3.
///
/// ```
/// use spectral_core::colour::{xyz_to_lab, xyz::WHITE_D65};
/// assert_eq!(xyz_to_lab(WHITE_D65, WHITE_D65), [100.0, 0.0, 0.0]);
/// ```
#[inline]
#[must_use]
pub fn xyz_to_lab<R: Real>(xyz: [R; 3], white: [R; 3]) -> [R; 3] {
    let [fx, fy, fz] = [lab_f(xyz[0] / white[0]), lab_f(xyz[1] / white[1]), lab_f(xyz[2] / white[2])];
    [R::from_f64(116.0) * fy - R::from_f64(16.0), R::from_f64(500.0) * (fx - fy), R::from_f64(200.0) * (fy - fz)]
}

/// Tristimulus values of CIELAB (L\*, a\*, b\*), relative to a white: the inverse of [`xyz_to_lab`].
///
/// Defined for every finite L\*a\*b\*, also where no colour is; large values overflow to ±∞.
///
/// Source: ISO/CIE 11664-4:2019, annex B.
#[inline]
#[must_use]
pub fn lab_to_xyz<R: Real>([lightness, a, b]: [R; 3], white: [R; 3]) -> [R; 3] {
    let fy = (lightness + R::from_f64(16.0)) / R::from_f64(116.0);
    let fx = fy + a / R::from_f64(500.0);
    let fz = fy - b / R::from_f64(200.0);
    [lab_f_inverse(fx) * white[0], lab_f_inverse(fy) * white[1], lab_f_inverse(fz) * white[2]]
}

#[cfg(test)]
#[allow(clippy::float_cmp, reason = "exact values are what is stated")]
mod tests {
    use super::*;
    use crate::colour::xyz::WHITE_D65;

    const STEPS: u64 = 1_000_000;

    fn assert_monotone_f64(f: fn(f64) -> f64, centre: f64) {
        let first = centre.to_bits() - STEPS.min(centre.to_bits());
        let mut below = f(f64::from_bits(first));
        for bits in first..first + 2 * STEPS {
            let value = f(f64::from_bits(bits));
            assert!(below <= value, "falls before {:e}", f64::from_bits(bits));
            below = value;
        }
    }

    fn assert_monotone_f32(f: fn(f32) -> f32, bits: core::ops::RangeInclusive<u32>) {
        let mut below = f(f32::from_bits(*bits.start()));
        for bits in bits {
            let value = f(f32::from_bits(bits));
            assert!(below <= value, "falls before {:e}", f32::from_bits(bits));
            below = value;
        }
    }

    #[test]
    fn never_falls_from_one_number_to_the_next() {
        for centre in [0.0, 1e-320, 1e-17, DELTA_CUBED, 0.18, 1.0, 8.0, 1e300] {
            assert_monotone_f64(lab_f, centre);
            assert_monotone_f64(|t| -lab_f(-t), centre);
        }
        for centre in [0.0, 0.1, DELTA, 0.5, 1.0] {
            assert_monotone_f64(lab_f_inverse, centre);
            assert_monotone_f64(|t| -lab_f_inverse(-t), centre);
        }
        let junction = f32::from_f64(DELTA_CUBED).to_bits();
        assert_monotone_f32(lab_f, junction - 1_000_000..=junction + 1_000_000);
        let junction = f32::from_f64(DELTA).to_bits();
        assert_monotone_f32(lab_f_inverse, junction - 1_000_000..=junction + 1_000_000);
    }

    #[test]
    #[ignore = "every f32: under a minute in release"]
    fn never_falls_over_all_single_precision_numbers() {
        let infinity = f32::INFINITY.to_bits();
        assert_monotone_f32(lab_f, 0..=infinity);
        assert_monotone_f32(|t| -lab_f(-t), 0..=infinity);
        assert_monotone_f32(lab_f_inverse, 0..=infinity);
        assert_monotone_f32(|t| -lab_f_inverse(-t), 0..=infinity);
    }

    /// The stated accuracy, with the same function in `f64` as the exact one.
    #[test]
    fn single_precision_is_as_accurate_as_stated() {
        let epsilon = f64::from(f32::EPSILON);
        for k in 0_u32..2_000_000 {
            let t = f32::from_bits(k.wrapping_mul(2_654_435_761) & 0x7fff_ffff);
            if !t.is_finite() {
                continue;
            }
            let exact = lab_f(f64::from(t));
            assert!((f64::from(lab_f(t)) - exact).abs() <= 1.25 * epsilon * exact, "{t:e}");
            let exact = lab_f(-f64::from(t));
            let tolerance = 1.5 * epsilon * (exact.abs() + OFFSET);
            // Beyond the range the result is −∞, as for any product.
            assert!((f64::from(lab_f(-t)) - exact).abs() <= tolerance || lab_f(-t) == -f32::INFINITY, "{:e}", -t);
        }
    }

    #[test]
    fn special_values() {
        assert_eq!(lab_f(0.0), OFFSET);
        assert_eq!(lab_f(-0.0), OFFSET);
        assert_eq!(lab_f(f64::from_bits(1)), OFFSET);
        assert_eq!(lab_f(1e300), 1e100);
        assert_eq!(lab_f(f64::INFINITY), f64::INFINITY);
        assert_eq!(lab_f(-f64::INFINITY), -f64::INFINITY);
        assert!(lab_f(f64::NAN).is_nan());
        assert!(lab_f(f32::NAN).is_nan());
        assert!(lab_f_inverse(f64::NAN).is_nan());
        assert_eq!(lab_f_inverse(f64::INFINITY), f64::INFINITY);
        assert_eq!(lab_f_inverse(-f64::INFINITY), -f64::INFINITY);
        assert_eq!(lab_f_inverse(f64::MAX), f64::INFINITY);
    }

    #[test]
    fn the_inverse_comes_back() {
        for t in [-1e12, -3.0, -0.01, 0.0, 1e-320, 1e-9, 0.008, DELTA_CUBED, 0.009, 0.5, 1.0, 40.0, 1e290] {
            let back = lab_f_inverse(lab_f(t));
            let tolerance = 6.0 * f64::EPSILON * t.abs().max(DELTA_CUBED);
            assert!((back - t).abs() <= tolerance, "{t:e} came back as {back:e}");
        }
    }

    /// `independent`: `XYZ_to_Lab` of colour-science 0.4.7, white (0.95047, 1, 1.08883), which uses the same rational
    /// constants.
    #[test]
    fn agrees_with_colour_science() {
        let cases = [
            ([0.2, 0.12, 0.05], [41.216_120_124_466_91, 50.773_931_171_631_396, 27.028_649_916_043_545]),
            ([0.9, 1.0, 0.3], [100.0, -9.011_444_076_209_074, 69.858_126_496_608_11]),
            ([0.001, 0.002, 0.003], [1.806_592_592_592_593, -3.690_623_138_104_379, -1.176_233_578_618_707]),
            ([1e-6, 0.0, 1e-7], [0.0, 0.004_096_413_898_938, -0.000_143_034_946_448]),
        ];
        for (xyz, expected) in cases {
            let lab = xyz_to_lab(xyz, WHITE_D65);
            for (actual, expected) in lab.iter().zip(expected) {
                // Both sides round, and that side derives its white from a chromaticity.
                assert!((actual - expected).abs() <= 1e-11, "{lab:?}");
            }
            for (back, xyz) in lab_to_xyz(lab, WHITE_D65).iter().zip(xyz) {
                assert!((back - xyz).abs() <= 1e-14);
            }
        }
    }

    #[test]
    fn not_finite_in_not_finite_out() {
        for bad in [f64::NAN, f64::INFINITY, -f64::INFINITY] {
            let lab = xyz_to_lab([0.3, bad, 0.2], WHITE_D65);
            assert!(lab.iter().all(|c| !c.is_finite()), "{lab:?}");
        }
    }
}
