//! The colour-rendering index of CIE 13.3-1995.

use super::{Rendering, indices};
use crate::Real;
use crate::adaptation::VonKries;
use crate::cct::xyz_to_uv;
use crate::colour::delta_e_ab;
use crate::lanes::Lanes;
use crate::summation::Illuminated;

/// R_a and the special indices R_i of CIE 13.3-1995: von Kries adaptation in CIE 1960 (u, v), CIE 1964 U\*V\*W\*,
/// R_i = 100 − 4.6 ΔE; R_a is the mean of the first eight.
///
/// In `f32` the general index of the built-in lights is within 5e-4 of that in `f64`; black bodies, which rate 100, are within
/// 3e-3. Where a chromaticity is not defined
/// (a sample that reflects nothing of the light) indices are NaN or infinite; of a light without Z, such as a red line, c of
/// the reference light is taken for all samples. See [`light`](crate::light) for what
/// is refused before.
#[must_use]
pub fn cie_13_3<R: Real, const M: usize>(test: &Illuminated<R, M>, reference: &Illuminated<R, M>) -> Rendering<R, M> {
    let reference_uv = xyz_to_uv(reference.white);
    let adaptation = VonKries::new(test.white, reference.white);
    let adapted = test.samples.map(|xyz| {
        let [u, v] = adaptation.apply(xyz.map(|c| Lanes([c])));
        [u.0[0], v.0[0], xyz[1]]
    });
    // The adapted white of the test light is that of the reference light by construction.
    let test_colours = adapted.map(|[u, v, y]| uniform([u, v], y, reference_uv));
    let reference_colours = reference.samples.map(|xyz| uniform(xyz_to_uv(xyz), xyz[1], reference_uv));
    let differences = core::array::from_fn(|i| delta_e_ab(test_colours[i], reference_colours[i]));
    let (special, general) = indices(&differences, 4.6, 8);
    Rendering {
        test: *test,
        reference: *reference,
        adapted,
        test_colours,
        reference_colours,
        differences,
        special,
        general,
    }
}

/// CIE 1964 W\*, U\*, V\*: W\* = 25 (100 Y)^⅓ − 17, U\* = 13 W\* (u − u₀), V\* = 13 W\* (v − v₀).
pub(super) fn uniform<R: Real>([u, v]: [R; 2], y: R, [u0, v0]: [R; 2]) -> [R; 3] {
    let lightness = R::from_f64(25.0) * (R::from_f64(100.0) * y).cbrt() - R::from_f64(17.0);
    let scale = R::from_f64(13.0) * lightness;
    [lightness, scale * (u - u0), scale * (v - v0)]
}
