//! Colour rendering: how far the colours of test samples under a light are from those under a reference light.
//!
//! Three generations of the index, and the fidelity index of CIE 224:
//!
//! | index | samples | reference | adaptation | space | difference |
//! |---|---|---|---|---|---|
//! | [`cie_13_3`]: R_a, R_i | TCS01–14 | by CCT | von Kries in (u, v) | CIE 1964 U\*V\*W\* | Euclidean |
//! | [`r96`]: R96_a(c) | ColorChecker, skin | nearest of six | CIE 1994 to D65 | CIELAB | ΔE\*ab |
//! | [`r96`]: R96(TCC/LAB)_a | the same | by CCT | CIE 1994 to D65 | CIELAB | ΔE\*ab |
//! | [`cri00`]: CRI00 | either | by CCT | linear Bradford | CIELAB | ΔE00 |
//! | [`fidelity`]: R_f, R_g | 99 CES | by CCT, blended | CIECAM02 | CAM02-UCS | Euclidean |
//!
//! Everything works on tristimulus values ([`Illuminated`]), so that any set of samples
//! serves. Each result keeps its stages, so that a deviation can be traced.

mod cam02;
mod cri;
mod cri00;
mod eight;
mod fidelity;
mod r96;
mod reference;
mod reference_table;
mod samples;

pub use cri::cie_13_3;
pub use cri00::{Cri00, cri00};
pub(crate) use eight::{EightSamples, EightSums, Products, ReferenceColours, general_indices};
pub use fidelity::{Fidelity, fidelity, fidelity_reference};
pub use r96::{R96_REFERENCES, R96_TCC_LAB, R96C, nearest_r96_reference, r96};
pub use reference::{ReferenceKind, ReferenceLight};
pub(crate) use reference_table::{PIECE_COUNT, ReferencePiece, interpolated, piece_of};
pub use samples::{colorchecker_samples, colour_evaluation_samples, munsell_samples};

use crate::Real;
use crate::summation::Illuminated;

/// A colour-rendering index of `M` samples with all its stages.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rendering<R, const M: usize> {
    /// The light and the samples under it.
    pub test: Illuminated<R, M>,
    /// The reference light and the samples under it.
    pub reference: Illuminated<R, M>,
    /// The samples under the test light, adapted: XYZ; for CIE 13.3 u′, v′ and Y.
    pub adapted: [[R; 3]; M],
    /// The samples under the test light in the index's colour space: L\*, a\*, b\*, or W\*, U\*, V\*.
    pub test_colours: [[R; 3]; M],
    /// The samples under the reference light in the index's colour space.
    pub reference_colours: [[R; 3]; M],
    /// The colour difference of each sample.
    pub differences: [R; M],
    /// The special index of each sample: 100 − c ΔE.
    pub special: [R; M],
    /// The general index: the mean of the first special indices, as many as the method averages.
    pub general: R,
}

/// 100 − c ΔE for each sample, and the mean of the first `averaged`.
fn indices<R: Real, const M: usize>(differences: &[R; M], factor: f64, averaged: usize) -> ([R; M], R) {
    let special = differences.map(|difference| R::from_f64(100.0) - R::from_f64(factor) * difference);
    let count = averaged.min(M);
    let mut sum = R::ZERO;
    for &index in special.iter().take(count) {
        sum += index;
    }
    (special, sum / R::from_usize(count))
}
