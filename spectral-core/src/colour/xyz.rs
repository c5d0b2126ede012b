//! Tristimulus values of the CIE 1931 standard observer: white points, and the chromaticity form xyY.

use crate::Real;

/// XYZ of CIE standard illuminant D65, relative to Y = 1.
///
/// Source: ASTM E308-01. The sum of the CIE tables at 1 nm over 360–830 nm rounds to the same digits; CIE
/// 15:2004 prints (0.9504, 1, 1.0888).
///
/// The white of linear sRGB is another one, see [`rgb::WHITE`](super::rgb::WHITE): it is defined by a chromaticity of
/// four digits and differs in Z by 2e-4.
pub const WHITE_D65: [f64; 3] = [0.950_47, 1.0, 1.088_83];

/// XYZ of CIE illuminant D50, relative to Y = 1.
///
/// Source: ASTM E308-01. The sum of the CIE tables at 1 nm is (0.96424, 1, 0.82513); CIE 15:2004 prints
/// (0.9642, 1, 0.8251).
pub const WHITE_D50: [f64; 3] = [0.964_22, 1.0, 0.825_21];

/// XYZ of CIE standard illuminant A, relative to Y = 1.
///
/// Source: ASTM E308-01. The sum at 1 nm of the illuminant's defining formula rounds to the same digits; CIE
/// 15:2004 prints (1.0985, 1, 0.3558).
pub const WHITE_A: [f64; 3] = [1.098_50, 1.0, 0.355_85];

/// XYZ of the equal-energy illuminant E, by definition of the colour-matching functions.
pub const WHITE_E: [f64; 3] = [1.0, 1.0, 1.0];

/// Chromaticity and luminance (x, y, Y) of tristimulus values (X, Y, Z).
///
/// x = X / (X + Y + Z), y = Y / (X + Y + Z); Y is handed on unchanged. Accurate to 2 ε relative to |x| and |y| when
/// X, Y, Z ≥ 0.
///
/// `None` where a chromaticity is not defined: when the sum is 0 (black), not finite, or so large that it overflows,
/// when a component is NaN, or when a chromaticity overflows. Real lights have X + Y + Z > 0; a negative sum is divided by
/// like any other.
///
/// Source: CIE 15:2018.
///
/// ```
/// use spectral_core::colour::{xyz_to_xyy, xyz::WHITE_E};
/// assert_eq!(xyz_to_xyy(WHITE_E), Some([1.0 / 3.0, 1.0 / 3.0, 1.0]));
/// assert_eq!(xyz_to_xyy([0.0_f64; 3]), None);
/// ```
#[inline]
#[must_use]
pub fn xyz_to_xyy<R: Real>([x, y, z]: [R; 3]) -> Option<[R; 3]> {
    let sum = x + y + z;
    if sum == R::ZERO || !sum.is_finite() {
        return None;
    }
    let [x, chroma_y] = [x / sum, y / sum];
    (x.is_finite() && chroma_y.is_finite()).then_some([x, chroma_y, y])
}

/// Tristimulus values (X, Y, Z) of chromaticity and luminance (x, y, Y).
///
/// X = x Y / y, Z = (1 − x − y) Y / y. Zero luminance is black whatever the chromaticity. Accurate to 3 ε relative to
/// X and to (1 + |x| + |y|) Y / y, respectively.
///
/// `None` when y = 0 and Y ≠ 0 (no finite colour has it), when an argument is not finite, and when the result
/// overflows.
///
/// Source: CIE 15:2018.
///
/// ```
/// use spectral_core::colour::xyy_to_xyz;
/// assert_eq!(xyy_to_xyz([0.25, 0.5, 2.0_f64]), Some([1.0, 2.0, 1.0]));
/// assert_eq!(xyy_to_xyz([0.25, 0.0, 2.0_f64]), None);
/// ```
#[inline]
#[must_use]
pub fn xyy_to_xyz<R: Real>([x, y, luminance]: [R; 3]) -> Option<[R; 3]> {
    if !(x.is_finite() && y.is_finite() && luminance.is_finite()) {
        return None;
    }
    if luminance == R::ZERO {
        return Some([R::ZERO; 3]);
    }
    let (red, blue) = (x / y * luminance, (R::ONE - x - y) / y * luminance);
    (red.is_finite() && blue.is_finite()).then_some([red, luminance, blue])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn assert_close(actual: [f64; 3], expected: [f64; 3], tolerance: f64) {
        for (a, e) in actual.iter().zip(expected) {
            assert!((a - e).abs() <= tolerance, "{actual:?} is not {expected:?} within {tolerance}");
        }
    }

    /// `published`: chromaticities of CIE 15:2004, table T.3, to half a unit of the fourth digit; the fifth depends on the
    /// range and the step of the sums, which differ between editions.
    #[test]
    fn white_points_have_the_published_chromaticities() {
        let published = [
            (WHITE_A, [0.447_58, 0.407_45]),
            (WHITE_D50, [0.345_67, 0.358_51]),
            (WHITE_D65, [0.312_72, 0.329_03]),
            (WHITE_E, [0.333_33, 0.333_33]),
        ];
        for (white, [x, y]) in published {
            let xyy = xyz_to_xyy(white).unwrap();
            assert_close(xyy, [x, y, 1.0], 5e-5);
        }
    }

    /// `independent`: sums of the CIE tables (A: its formula) times the colour-matching functions at 1 nm over
    /// 360–830 nm, by a separate script. Of D50 ASTM prints another fourth digit of Z.
    #[test]
    fn white_points_are_the_integrals_of_their_illuminants() {
        assert_close(WHITE_A, [1.098_503_38, 1.0, 0.355_849_39], 5e-6);
        assert_close(WHITE_D65, [0.950_468_57, 1.0, 1.088_829_73], 5e-6);
        assert_close(WHITE_D50, [0.964_237_95, 1.0, 0.825_129_00], 1e-4);
    }

    #[test]
    fn chromaticity_and_back_is_the_identity_to_rounding() {
        for magnitude in [1e-300, 1e-12, 1.0, 1e12, 1e300] {
            for direction in [[0.2, 0.3, 0.9], [1.0, 1e-6, 0.0], [0.0, 1.0, 0.0], [0.3, 0.4, -0.1]] {
                let xyz = direction.map(|c| c * magnitude);
                let back = xyy_to_xyz(xyz_to_xyy(xyz).unwrap()).unwrap();
                // Z is formed from 1 − x − y, so its error is relative to the sum of all three.
                let scale: f64 = xyz.iter().map(|c| c.abs()).sum();
                assert_close(back, xyz, 16.0 * f64::EPSILON * scale);
            }
        }
    }

    #[test]
    fn undefined_chromaticities_are_refused() {
        for xyz in [
            [0.0, 0.0, 0.0],
            [-0.0, 0.0, -0.0],
            [1.0, -1.0, 0.0],
            [f64::NAN, 1.0, 1.0],
            [1.0, f64::INFINITY, 1.0],
            [f64::MAX, f64::MAX, f64::MAX],
        ] {
            assert_eq!(xyz_to_xyy(xyz), None, "{xyz:?}");
        }
        assert!(xyz_to_xyy([f64::from_bits(1); 3]).is_some(), "subnormal numbers have a chromaticity");
    }

    #[test]
    fn colours_that_do_not_exist_are_refused() {
        for xyy in [
            [0.3, 0.0, 1.0],
            [0.3, f64::from_bits(1), 1.0],
            [f64::NAN, 0.3, 1.0],
            [0.3, f64::NAN, 0.0],
            [0.3, 0.3, f64::INFINITY],
            [1e300, 1e-300, 1.0],
        ] {
            assert_eq!(xyy_to_xyz(xyy), None, "{xyy:?}");
        }
        assert_eq!(xyy_to_xyz([0.3, 0.0, 0.0_f32]), Some([0.0; 3]), "zero luminance is black");
    }
}
