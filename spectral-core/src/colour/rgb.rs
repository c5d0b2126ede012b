//! Linear RGB with the primaries of Rec. ITU-R BT.709, which are those of sRGB, and sRGB itself (IEC 61966-2-1).
//!
//! Both standards share primaries and white, so that "linear sRGB" and "linear Rec. 709" are the same numbers. Values
//! outside [0, 1] are colours brighter than white or outside the gamut; they are kept until something is quantised.

use crate::Real;

/// The chromaticities (x, y) of the red, green and blue primary (BT.709-6 and IEC 61966-2-1).
pub const PRIMARIES: [[f64; 2]; 3] = [[0.64, 0.33], [0.30, 0.60], [0.15, 0.06]];

/// The chromaticity (x, y) of the white R = G = B: D65, rounded to four digits in both standards.
pub const WHITE_CHROMATICITY: [f64; 2] = [0.3127, 0.3290];

/// XYZ of the white R = G = B = 1, from [`WHITE_CHROMATICITY`]: about (0.95046, 1, 1.08906).
pub const WHITE: [f64; 3] = from_chromaticity(WHITE_CHROMATICITY);

/// The matrix from linear RGB to XYZ, row by row: [`PRIMARIES`] scaled so that R = G = B = 1 is [`WHITE`].
///
/// Computed in `f64` from the chromaticities, not the four-digit matrix that IEC 61966-2-1 prints.
pub const RGB_TO_XYZ: [[f64; 3]; 3] = rgb_to_xyz_matrix(PRIMARIES, WHITE_CHROMATICITY);

/// The matrix from XYZ to linear RGB, row by row: the inverse of [`RGB_TO_XYZ`], computed in `f64`.
pub const XYZ_TO_RGB: [[f64; 3]; 3] = invert(RGB_TO_XYZ);

const fn from_chromaticity([x, y]: [f64; 2]) -> [f64; 3] {
    [x / y, 1.0, (1.0 - x - y) / y]
}

/// The matrix from linear RGB to XYZ, row by row, for any primaries and white, given by their chromaticities (x, y), such
/// that R = G = B = 1 has Y = 1.
///
/// The primaries must not lie on one line, and no y may be 0; otherwise the matrix has infinities or NaN.
#[must_use]
pub const fn rgb_to_xyz_matrix(primaries: [[f64; 2]; 3], white: [f64; 2]) -> [[f64; 3]; 3] {
    let [r, g, b] = primaries;
    let (r, g, b) = (from_chromaticity(r), from_chromaticity(g), from_chromaticity(b));
    let columns = [[r[0], g[0], b[0]], [r[1], g[1], b[1]], [r[2], g[2], b[2]]];
    let scale = product(invert(columns), from_chromaticity(white));
    let mut matrix = columns;
    let mut row = 0;
    while row < 3 {
        matrix[row] = [columns[row][0] * scale[0], columns[row][1] * scale[1], columns[row][2] * scale[2]];
        row += 1;
    }
    matrix
}

const fn product(m: [[f64; 3]; 3], v: [f64; 3]) -> [f64; 3] {
    [
        m[0][0] * v[0] + m[0][1] * v[1] + m[0][2] * v[2],
        m[1][0] * v[0] + m[1][1] * v[1] + m[1][2] * v[2],
        m[2][0] * v[0] + m[2][1] * v[1] + m[2][2] * v[2],
    ]
}

const fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// The inverse of a regular matrix, by its adjugate.
pub(crate) const fn invert(m: [[f64; 3]; 3]) -> [[f64; 3]; 3] {
    let columns = [cross(m[1], m[2]), cross(m[2], m[0]), cross(m[0], m[1])];
    let [p, q, r] = columns;
    let determinant = m[0][0] * p[0] + m[0][1] * p[1] + m[0][2] * p[2];
    [
        [p[0] / determinant, q[0] / determinant, r[0] / determinant],
        [p[1] / determinant, q[1] / determinant, r[1] / determinant],
        [p[2] / determinant, q[2] / determinant, r[2] / determinant],
    ]
}

#[inline]
pub(crate) fn transform<R: Real>(matrix: &[[f64; 3]; 3], [a, b, c]: [R; 3]) -> [R; 3] {
    matrix.map(|[p, q, r]| R::from_f64(p) * a + R::from_f64(q) * b + R::from_f64(r) * c)
}

/// XYZ, relative to Y = 1 for white, of linear RGB.
///
/// A product with [`RGB_TO_XYZ`], defined for all numbers, negative ones included; accurate to 4 ε times the sum of the
/// terms' magnitudes.
///
/// ```
/// use spectral_core::colour::linear_rgb_to_xyz;
/// let [_, luminance, _] = linear_rgb_to_xyz([0.0, 1.0, 0.0_f64]);
/// assert!((luminance - 0.7152).abs() <= 5e-5);
/// ```
#[inline]
#[must_use]
pub fn linear_rgb_to_xyz<R: Real>(rgb: [R; 3]) -> [R; 3] {
    transform(&RGB_TO_XYZ, rgb)
}

/// Linear RGB of XYZ, relative to Y = 1 for white: the inverse of [`linear_rgb_to_xyz`] to rounding.
///
/// Colours outside the gamut have a negative component, which is kept.
#[inline]
#[must_use]
pub fn xyz_to_linear_rgb<R: Real>(xyz: [R; 3]) -> [R; 3] {
    transform(&XYZ_TO_RGB, xyz)
}

/// The sRGB code value in [0, 1] of a linear component in [0, 1].
///
/// V = 12.92 C for C ≤ 0.0031308, and 1.055 C^(1/2.4) − 0.055 above. Above 1 the curve goes on; below 0 it goes on as an
/// odd function, V(−C) = −V(C), as is the habit for extended sRGB. Accurate to 4 ε. ±∞ stays, NaN stays.
///
/// Source: IEC 61966-2-1:1999.
///
/// ```
/// use spectral_core::colour::{decode_srgb, encode_srgb};
/// assert!((encode_srgb(0.18_f64) - 0.461356).abs() <= 5e-7);
/// assert!((decode_srgb(encode_srgb(-0.3_f64)) + 0.3).abs() <= 1e-15);
/// ```
#[must_use]
pub fn encode_srgb<R: Real>(linear: R) -> R {
    let magnitude = linear.abs();
    let code = if magnitude > R::from_f64(0.003_130_8) {
        R::from_f64(1.055) * magnitude.powf(R::from_f64(1.0 / 2.4)) - R::from_f64(0.055)
    } else {
        R::from_f64(12.92) * magnitude
    };
    if linear < R::ZERO { -code } else { code }
}

/// The linear component of an sRGB code value in [0, 1]: the inverse of [`encode_srgb`].
///
/// C = V / 12.92 for V ≤ 0.04045, and ((V + 0.055) / 1.055)^2.4 above; odd below 0. Accurate to 6 ε up to 1, 10 ε
/// up to 100. The standard's constants are rounded: the curves invert each other but for a stretch of 1e-8 where the branches meet,
/// and there to 5e-9.
///
/// Source: IEC 61966-2-1:1999.
#[must_use]
pub fn decode_srgb<R: Real>(code: R) -> R {
    let magnitude = code.abs();
    let linear = if magnitude > R::from_f64(0.040_45) {
        ((magnitude + R::from_f64(0.055)) / R::from_f64(1.055)).powf(R::from_f64(2.4))
    } else {
        magnitude / R::from_f64(12.92)
    };
    if code < R::ZERO { -linear } else { linear }
}

/// The 8-bit code nearest to a code value in [0, 1]: ⌊255 V + ½⌋, limited to 0..=255; 0 for NaN.
///
/// Source: IEC 61966-2-1:1999.
#[must_use]
pub fn quantise_8bit<R: Real>(code: R) -> u8 {
    let scaled = code.clamp(R::ZERO, R::ONE) * R::from_f64(255.0) + R::HALF;
    u8::try_from(scaled.to_usize()).unwrap_or(u8::MAX)
}

/// 8-bit sRGB of linear RGB: clipped to [0, 1], encoded, rounded to nearest; NaN becomes 0.
///
/// ```
/// use spectral_core::colour::linear_rgb_to_srgb8;
/// assert_eq!(linear_rgb_to_srgb8([0.18, -1.0, 9.0_f32]), [118, 0, 255]);
/// ```
#[must_use]
pub fn linear_rgb_to_srgb8<R: Real>(rgb: [R; 3]) -> [u8; 3] {
    rgb.map(|component| quantise_8bit(encode_srgb(component)))
}

/// Linear RGB of 8-bit sRGB; [`linear_rgb_to_srgb8`] takes every code back to itself.
#[must_use]
pub fn srgb8_to_linear_rgb<R: Real>(rgb: [u8; 3]) -> [R; 3] {
    rgb.map(|code| decode_srgb(R::from_f64(f64::from(code)) / R::from_f64(255.0)))
}

#[cfg(test)]
#[allow(clippy::float_cmp, reason = "exact values are what is stated")]
mod tests {
    use super::*;
    use crate::colour::in_precision;

    #[test]
    fn the_matrices_are_inverses_to_rounding() {
        for axis in 0..3 {
            let mut unit = [0.0; 3];
            unit[axis] = 1.0;
            for (back, expected) in product(RGB_TO_XYZ, product(XYZ_TO_RGB, unit)).iter().zip(unit) {
                // Terms of magnitude up to 2, and two roundings in each factor.
                assert!((back - expected).abs() <= 8.0 * f64::EPSILON, "column {axis}: {back}");
            }
        }
    }

    #[test]
    fn a_colour_comes_back_in_both_precisions() {
        for rgb in [[1.0, 1.0, 1.0], [0.0, 0.0, 0.0], [-0.3, 0.9, 12.0], [1e-30, -1e-30, 5e-31]] {
            let magnitude = rgb.iter().fold(0.0_f64, |m, c: &f64| m.max(c.abs()));
            for (back, c) in xyz_to_linear_rgb(linear_rgb_to_xyz(rgb)).iter().zip(rgb) {
                assert!((back - c).abs() <= 32.0 * f64::EPSILON * magnitude);
            }
            let single: [f32; 3] = in_precision(rgb);
            for (back, c) in xyz_to_linear_rgb(linear_rgb_to_xyz(single)).iter().zip(single) {
                assert!(f64::from((back - c).abs()) <= 32.0 * f64::from(f32::EPSILON) * magnitude);
            }
        }
    }

    #[test]
    fn white_is_white() {
        let white = linear_rgb_to_xyz([1.0_f64; 3]);
        for (actual, expected) in white.iter().zip(WHITE) {
            assert!((actual - expected).abs() <= 4.0 * f64::EPSILON);
        }
        for component in xyz_to_linear_rgb(WHITE) {
            assert!((component - 1.0_f64).abs() <= 16.0 * f64::EPSILON);
        }
    }

    /// `published`: the four-digit matrix of IEC 61966-2-1, half a unit of its last digit;
    /// `independent`: `normalised_primary_matrix` of colour-science 0.4.7 from the same chromaticities.
    #[test]
    fn the_matrix_is_the_standards() {
        let published = [[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]];
        let independent = [
            [0.412_390_799_265_959_34, 0.357_584_339_383_877_96, 0.180_480_788_401_834_3],
            [0.212_639_005_871_510_3, 0.715_168_678_767_755_9, 0.072_192_315_360_733_71],
            [0.019_330_818_715_591_82, 0.119_194_779_794_625_95, 0.950_532_152_249_660_6],
        ];
        let actual = RGB_TO_XYZ.as_flattened();
        for ((actual, published), independent) in
            actual.iter().zip(published.as_flattened()).zip(independent.as_flattened())
        {
            assert!((actual - published).abs() <= 5e-5);
            assert!((actual - independent).abs() <= 4.0 * f64::EPSILON);
        }
    }

    /// `independent`: `eotf_inverse_sRGB` and `eotf_sRGB` of colour-science 0.4.7.
    #[test]
    fn transfer_functions_agree_with_colour_science() {
        let cases = [
            (0.0, 0.0, 0.0),
            (0.001, 0.012_920_000_000_000_001, 7.739_938_080_495_357e-5),
            (0.003_130_8, 0.040_449_936, 0.000_242_321_981_424_148_61),
            (0.18, 0.461_356_129_500_441_64, 0.027_211_780_951_381_357),
            (0.5, 0.735_356_983_052_449_5, 0.214_041_140_482_232_55),
            (1.0, 1.0, 1.0),
        ];
        for (value, encoded, decoded) in cases {
            assert!((encode_srgb(value) - encoded).abs() <= 4.0 * f64::EPSILON, "{value}");
            assert!((decode_srgb(value) - decoded).abs() <= 4.0 * f64::EPSILON, "{value}");
        }
    }

    #[test]
    fn transfer_functions_invert_each_other() {
        for k in -3000..=3000 {
            let linear = f64::from(k) / 1000.0;
            let error = (decode_srgb(encode_srgb(linear)) - linear).abs();
            assert!(error <= 10.0 * f64::EPSILON * linear.abs(), "{linear}: {error:e}");
        }
        for k in -1000..=1000 {
            let linear = 0.003_130_8 + f64::from(k) * 1e-9;
            let error = (decode_srgb(encode_srgb(linear)) - linear).abs();
            assert!(error <= 5e-9, "{linear}: {error:e}");
        }
    }

    #[test]
    fn every_8bit_code_comes_back() {
        for code in 0..=u8::MAX {
            assert_eq!(linear_rgb_to_srgb8(srgb8_to_linear_rgb::<f32>([code; 3])), [code; 3]);
            assert_eq!(linear_rgb_to_srgb8(srgb8_to_linear_rgb::<f64>([code; 3])), [code; 3]);
        }
    }

    #[test]
    fn quantisation_rounds_to_nearest_and_clips() {
        let cases = [
            (0.499 / 255.0, 0),
            (0.501 / 255.0, 1),
            (254.499 / 255.0, 254),
            (254.501 / 255.0, 255),
            (1.0, 255),
            (1e300, 255),
            (f64::INFINITY, 255),
            (-0.0, 0),
            (-5.0, 0),
            (f64::from_bits(1), 0),
            (f64::NAN, 0),
        ];
        for (value, code) in cases {
            assert_eq!(quantise_8bit(value), code, "{value}");
        }
    }

    #[test]
    fn not_finite_values_pass_through_the_curves() {
        assert_eq!(encode_srgb(f64::INFINITY), f64::INFINITY);
        assert_eq!(encode_srgb(-f32::INFINITY), -f32::INFINITY);
        assert_eq!(decode_srgb(-f64::INFINITY), -f64::INFINITY);
        assert!(encode_srgb(f64::NAN).is_nan());
        assert!(decode_srgb(f32::NAN).is_nan());
        let subnormal = f64::from_bits(3);
        assert_eq!(encode_srgb(subnormal), 12.92 * subnormal);
    }
}
