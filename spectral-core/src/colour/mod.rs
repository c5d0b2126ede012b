//! Colour spaces and colour differences, as plain functions on `[R; 3]`.
//!
//! - [`xyz`]: CIE 1931 tristimulus values, chromaticities, white points;
//! - [`lab`]: CIELAB and the function under it, with what an error bound needs to know of it;
//! - [`delta_e`]: the colour differences ΔE\*ab and ΔE00;
//! - [`rgb`]: linear RGB with the primaries of Rec. 709, and sRGB;
//! - [`space`]: linear RGB with any primaries and white: Rec. 2020, ACEScg.
//!
//! Tristimulus values are relative everywhere: Y = 1 is the white that a picture or a sample is seen against, not 100.
//! Chromatic adaptation is in [`crate::adaptation`], correlated colour temperature in [`crate::cct`].

pub mod delta_e;
pub mod lab;
pub mod rgb;
pub mod space;
pub mod xyz;

pub(crate) use delta_e::differences;
pub use delta_e::{delta_e_00, delta_e_00_weighted, delta_e_ab};
pub use lab::{lab_f, lab_f_inverse, lab_to_xyz, xyz_to_lab};
pub use rgb::{
    decode_srgb, encode_srgb, linear_rgb_to_srgb8, linear_rgb_to_xyz, quantise_8bit, srgb8_to_linear_rgb,
    xyz_to_linear_rgb,
};
pub use space::{RgbSpace, RgbSpaceError};
pub use xyz::{xyy_to_xyz, xyz_to_xyy};

use crate::Real;

/// A vector of `f64` constants in the precision at hand, each rounded to nearest.
///
/// ```
/// use spectral_core::colour::{in_precision, xyz::WHITE_D65};
/// let white: [f32; 3] = in_precision(WHITE_D65);
/// assert_eq!(white[1], 1.0);
/// ```
#[inline]
#[must_use]
pub fn in_precision<R: Real>(vector: [f64; 3]) -> [R; 3] {
    vector.map(R::from_f64)
}
