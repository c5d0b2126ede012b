//! Colours and their differences.

use spectral_core::Real;
use spectral_core::colour::{delta_e_00, delta_e_ab, lab_to_xyz, linear_rgb_to_srgb8, xyz_to_lab};

use crate::SpectralRgbSpace;
use crate::boundary::{Outcome, Output, finite, numbers, representable, within};

type Map<R> = fn([R; 3], [R; 3]) -> [R; 3];
type Difference<R> = fn([R; 3], [R; 3]) -> R;

/// A colour relative to a white point.
unsafe fn relative<R: Real>(colour: *const R, white: *const R, found: *mut R, map: Map<R>) -> Outcome {
    let output = Output::at(found.cast::<[R; 3]>())?;
    let (colour, white) = (numbers(colour)?, numbers::<R, 3>(white)?);
    within(white.iter().all(|&value| value > R::ZERO))?;
    let result = map(colour, white);
    representable(&result)?;
    output.put(result)
}

unsafe fn lab_of<R: Real>(xyz: *const R, white: *const R, lab: *mut R) -> Outcome {
    relative(xyz, white, lab, xyz_to_lab)
}

unsafe fn xyz_of<R: Real>(lab: *const R, white: *const R, xyz: *mut R) -> Outcome {
    relative(lab, white, xyz, lab_to_xyz)
}

unsafe fn difference<R: Real>(first: *const R, second: *const R, found: *mut R, of: Difference<R>) -> Outcome {
    let output = Output::at(found)?;
    let result = of(numbers(first)?, numbers(second)?);
    representable(&[result])?;
    output.put(result)
}

unsafe fn difference_ab<R: Real>(first: *const R, second: *const R, delta_e: *mut R) -> Outcome {
    difference(first, second, delta_e, delta_e_ab)
}

unsafe fn difference_00<R: Real>(first: *const R, second: *const R, delta_e: *mut R) -> Outcome {
    difference(first, second, delta_e, delta_e_00)
}

unsafe fn rgb_of<R: Real>(xyz: *const R, space: i32, rgb: *mut R) -> Outcome {
    let output = Output::at(rgb.cast::<[R; 3]>())?;
    let result = SpectralRgbSpace::meaning(space)?.from_xyz(numbers(xyz)?);
    representable(&result)?;
    output.put(result)
}

unsafe fn xyz_of_rgb<R: Real>(rgb: *const R, space: i32, xyz: *mut R) -> Outcome {
    let output = Output::at(xyz.cast::<[R; 3]>())?;
    let result = SpectralRgbSpace::meaning(space)?.to_xyz(numbers(rgb)?);
    representable(&result)?;
    output.put(result)
}

unsafe fn bytes_of<R: Real>(rgb: *const R, bytes: *mut u8) -> Outcome {
    let output = Output::at(bytes.cast::<[u8; 3]>())?;
    let rgb = numbers(rgb)?;
    finite(&rgb)?;
    output.put(linear_rgb_to_srgb8(rgb))
}

macro_rules! exports {
    ($R:ident) => {
        pastey::paste! { mod [<exports_ $R>] {
            use crate::boundary::export;

            export! {
                /// CIELAB (CIE 15:2018) of XYZ relative to a white point, both in one unit.
                ///
                /// @param white 3 numbers above 0
                /// @param[out] lab L*, a*, b*
                /// @return NULL, MISALIGNED, NOT_FINITE; RANGE for a white that is not positive, or a result that overflows
                [<spectral_xyz_to_lab_ $R>] = lab_of(xyz: *const $R, white: *const $R, lab: *mut $R);

                /// XYZ in the unit of the white point, of CIELAB: the inverse of spectral_xyz_to_lab.
                ///
                /// @param white 3 numbers above 0
                /// @return as spectral_xyz_to_lab
                [<spectral_lab_to_xyz_ $R>] = xyz_of(lab: *const $R, white: *const $R, xyz: *mut $R);

                /// The colour difference ΔE*ab of 1976 between two colours in CIELAB.
                ///
                /// @return NULL, MISALIGNED, NOT_FINITE, RANGE when it overflows
                [<spectral_delta_e_ab_ $R>] = difference_ab(first: *const $R, second: *const $R, delta_e: *mut $R);

                /// The colour difference ΔE00 (CIEDE2000) between two colours in CIELAB, with all parametric factors 1.
                ///
                /// @return NULL, MISALIGNED, NOT_FINITE, RANGE when it overflows
                [<spectral_delta_e_00_ $R>] = difference_00(first: *const $R, second: *const $R, delta_e: *mut $R);

                /// Linear components of an RGB space, of XYZ; white has Y = 1 and components 1. They may be negative or above 1.
                ///
                /// @param space a SpectralRgbSpace
                /// @return NULL, MISALIGNED, NOT_FINITE, CODE, RANGE when it overflows
                [<spectral_xyz_to_rgb_ $R>] = rgb_of(xyz: *const $R, space: i32, rgb: *mut $R);

                /// XYZ of linear components: the inverse of spectral_xyz_to_rgb.
                ///
                /// @param space a SpectralRgbSpace
                /// @return as spectral_xyz_to_rgb
                [<spectral_rgb_to_xyz_ $R>] = xyz_of_rgb(rgb: *const $R, space: i32, xyz: *mut $R);

                /// The bytes of sRGB (IEC 61966-2-1) of linear Rec. 709 components, which are limited to [0, 1].
                ///
                /// @param[out] bytes 3 bytes
                /// @return NULL, MISALIGNED, NOT_FINITE
                [<spectral_rgb_to_srgb8_ $R>] = bytes_of(rgb: *const $R, bytes: *mut u8);
            }
        } pub use [<exports_ $R>]::*; }
    };
}
exports!(f32);
exports!(f64);
