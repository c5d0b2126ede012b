//! RGB spaces with any primaries and white.

use super::rgb::{invert, rgb_to_xyz_matrix, transform};
use crate::Real;

/// A linear RGB space: the chromaticities (x, y) of its primaries and of the white R = G = B, for which R = 1 has Y = 1.
///
/// ```
/// use spectral_core::colour::RgbSpace;
/// let [x, y, z] = RgbSpace::REC_2020.to_xyz([1.0, 1.0, 1.0_f64]);
/// assert!((y - 1.0).abs() <= 1e-15 && (x / (x + y + z) - 0.3127).abs() <= 1e-15);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RgbSpace {
    primaries: [[f64; 2]; 3],
    white: [f64; 2],
    to_xyz: [[f64; 3]; 3],
    from_xyz: [[f64; 3]; 3],
}

/// Why an [`RgbSpace`] was refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum RgbSpaceError {
    /// A chromaticity is not finite, or its y is 0.
    Chromaticity,
    /// The primaries lie on one line, or white on a line through two of them.
    Degenerate,
}

impl core::fmt::Display for RgbSpaceError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str(match self {
            Self::Chromaticity => "a chromaticity of the RGB space is not finite, or its y is 0",
            Self::Degenerate => "the primaries lie on one line, or white on a line through two of them",
        })
    }
}

impl core::error::Error for RgbSpaceError {}

impl RgbSpace {
    /// Linear Rec. ITU-R BT.709 and linear sRGB (IEC 61966-2-1), white D65.
    pub const REC_709: Self = Self::known(super::rgb::PRIMARIES, super::rgb::WHITE_CHROMATICITY);
    /// Linear Rec. ITU-R BT.2020-2, white D65.
    pub const REC_2020: Self =
        Self::known([[0.708, 0.292], [0.170, 0.797], [0.131, 0.046]], super::rgb::WHITE_CHROMATICITY);
    /// ACEScg: AP1 primaries and the white of ACES (Academy S-2014-004).
    pub const ACESCG: Self = Self::known([[0.713, 0.293], [0.165, 0.830], [0.128, 0.044]], [0.321_68, 0.337_67]);

    /// The "sharp" primaries that Ward and Eydelberg-Vileshin (2002) recommend for prefiltered rendering, white of equal energy: they lie
    /// outside the spectral locus, and most lights have positive components.
    pub const SHARP: Self = Self::known([[0.6898, 0.3206], [0.0736, 0.9003], [0.1166, 0.0374]], [1.0 / 3.0, 1.0 / 3.0]);

    const fn known(primaries: [[f64; 2]; 3], white: [f64; 2]) -> Self {
        let to_xyz = rgb_to_xyz_matrix(primaries, white);
        Self { primaries, white, to_xyz, from_xyz: invert(to_xyz) }
    }

    /// A space from the chromaticities (x, y) of red, green, blue and white.
    ///
    /// # Errors
    /// [`RgbSpaceError`] where the matrix between RGB and XYZ or its inverse would not be finite.
    pub fn new(primaries: [[f64; 2]; 3], white: [f64; 2]) -> Result<Self, RgbSpaceError> {
        let well_defined = |[x, y]: [f64; 2]| x.is_finite() && y.is_finite() && y != 0.0;
        if !(primaries.into_iter().all(well_defined) && well_defined(white)) {
            return Err(RgbSpaceError::Chromaticity);
        }
        let space = Self::known(primaries, white);
        let entries = space.to_xyz.as_flattened().iter().chain(space.from_xyz.as_flattened());
        if !entries.copied().all(|entry| entry.abs() <= 1e12) {
            return Err(RgbSpaceError::Degenerate);
        }
        Ok(space)
    }

    /// The chromaticities (x, y) of red, green and blue.
    #[must_use]
    pub const fn primaries(&self) -> [[f64; 2]; 3] {
        self.primaries
    }

    /// XYZ of the white R = G = B = 1, from its chromaticity.
    #[must_use]
    pub const fn white(&self) -> [f64; 3] {
        let [x, y] = self.white;
        [x / y, 1.0, (1.0 - x - y) / y]
    }

    /// XYZ, relative to Y = 1 for white, of linear RGB; defined for all numbers.
    #[inline]
    #[must_use]
    pub fn to_xyz<R: Real>(&self, rgb: [R; 3]) -> [R; 3] {
        transform(&self.to_xyz, rgb)
    }

    /// Linear RGB of XYZ; a colour outside the gamut has a negative component, which is kept.
    #[inline]
    #[must_use]
    pub fn from_xyz<R: Real>(&self, xyz: [R; 3]) -> [R; 3] {
        transform(&self.from_xyz, xyz)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `published`: the luminance coefficients of BT.709-6 and BT.2020-2, four digits, and of S-2014-004, ten.
    #[test]
    fn luminance_coefficients_are_the_standards() {
        let cases = [
            (RgbSpace::REC_709, [0.2126, 0.7152, 0.0722], 5e-5),
            (RgbSpace::REC_2020, [0.2627, 0.6780, 0.0593], 5e-5),
            (RgbSpace::ACESCG, [0.272_228_716_8, 0.674_081_765_8, 0.053_689_517_4], 6e-11),
        ];
        for (space, published, tolerance) in cases {
            for (actual, published) in space.to_xyz[1].iter().zip(published) {
                assert!((actual - published).abs() <= tolerance, "{actual} {published}");
            }
        }
    }

    #[test]
    fn rec_709_is_the_space_of_the_rgb_module() {
        assert_eq!(RgbSpace::REC_709.to_xyz, super::super::rgb::RGB_TO_XYZ);
        assert_eq!(RgbSpace::REC_709.from_xyz, super::super::rgb::XYZ_TO_RGB);
    }

    #[test]
    fn spaces_without_an_inverse_are_refused() {
        let white = [0.3, 0.3];
        let line = [[0.1, 0.1], [0.3, 0.3], [0.5, 0.5]];
        assert_eq!(RgbSpace::new(line, white), Err(RgbSpaceError::Degenerate));
        let edge = [[0.6, 0.3], [0.0, 0.3], [0.15, 0.06]];
        assert_eq!(RgbSpace::new(edge, white), Err(RgbSpaceError::Degenerate));
        for bad in [f64::NAN, f64::INFINITY, 0.0] {
            let primaries = [[0.64, 0.33], [0.3, bad], [0.15, 0.06]];
            assert_eq!(RgbSpace::new(primaries, white), Err(RgbSpaceError::Chromaticity));
            let primaries = super::super::rgb::PRIMARIES;
            assert_eq!(RgbSpace::new(primaries, [0.3, bad]), Err(RgbSpaceError::Chromaticity));
        }
    }
}
