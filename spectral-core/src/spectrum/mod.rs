//! Spectra as functions of wavelength: piecewise linear on any increasing grid.
//!
//! Ground truth is defined, not sampled: a spectrum is a piecewise linear function of the wavelength in nm, with jumps
//! allowed at its nodes, and integrals of its products with the colour-matching functions (piecewise linear, too) are
//! exact but for rounding.

mod daylight;
mod error;
mod grid;
mod line;
mod piecewise;
mod planck;
mod simple;

use crate::Real;
pub use daylight::{Daylight, Rounding};
pub use error::SpectrumError;
pub(crate) use grid::interpolate;
pub use line::{Line, Lines};
pub use piecewise::{PiecewiseLinear, Uniform};
pub use planck::{Planck, RadiationConstant};
pub use simple::{Constant, Scaled};

/// What a sampled spectrum is outside its nodes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Outside {
    /// Zero, with a jump at the first and last node.
    #[default]
    Zero,
    /// The value of the nearest node.
    Hold,
}

/// One linear piece of a spectrum, from the wavelength it was asked for to `end`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Segment<R> {
    /// Wavelength in nm where the piece ends; above the wavelength asked for, possibly infinite when the piece is
    /// constant.
    pub end: R,
    /// The value where the piece starts (the right-hand limit there).
    pub first: R,
    /// The value where the piece ends (the left-hand limit there); equal to `first` when `end` is infinite.
    pub last: R,
}

/// A function of wavelength in nm, piecewise linear.
pub trait Spectrum<R: Real> {
    /// The linear piece that starts at `wavelength` in nm: the spectrum is linear from there to the piece's end.
    ///
    /// `segment(w).end > w` for every finite `w`, so that a walk over the pieces advances.
    fn segment(&self, wavelength: R) -> Segment<R>;

    /// The value at a wavelength in nm.
    fn value(&self, wavelength: R) -> R {
        self.segment(wavelength).first
    }
}

impl<R: Real, S: Spectrum<R> + ?Sized> Spectrum<R> for &S {
    fn segment(&self, wavelength: R) -> Segment<R> {
        (**self).segment(wavelength)
    }
    fn value(&self, wavelength: R) -> R {
        (**self).value(wavelength)
    }
}
