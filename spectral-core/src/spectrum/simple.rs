//! A constant, and a spectrum times a number.

use super::{Segment, Spectrum, SpectrumError};
use crate::Real;

/// The same value at every wavelength: equal energy, grey.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Constant<R>(R);

impl<R: Real> Constant<R> {
    /// A spectrum of one value.
    ///
    /// # Errors
    /// [`SpectrumError::Value`] with index 0 when the value isn't finite.
    pub fn new(value: R) -> Result<Self, SpectrumError> {
        if value.is_finite() { Ok(Self(value)) } else { Err(SpectrumError::Value { index: 0 }) }
    }
}

impl<R: Real> Spectrum<R> for Constant<R> {
    fn segment(&self, _: R) -> Segment<R> {
        Segment { end: R::INFINITY, first: self.0, last: self.0 }
    }
}

/// A spectrum times a number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scaled<S, R> {
    spectrum: S,
    factor: R,
}

impl<R: Real, S: Spectrum<R>> Scaled<S, R> {
    /// `factor` times `spectrum`. Products are rounded once; they may overflow or underflow as any product.
    ///
    /// # Errors
    /// [`SpectrumError::Value`] with index 0 when the factor isn't finite.
    pub fn new(spectrum: S, factor: R) -> Result<Self, SpectrumError> {
        if factor.is_finite() { Ok(Self { spectrum, factor }) } else { Err(SpectrumError::Value { index: 0 }) }
    }
}

impl<R: Real, S: Spectrum<R>> Spectrum<R> for Scaled<S, R> {
    fn segment(&self, wavelength: R) -> Segment<R> {
        let Segment { end, first, last } = self.spectrum.segment(wavelength);
        Segment { end, first: first * self.factor, last: last * self.factor }
    }

    fn value(&self, wavelength: R) -> R {
        self.spectrum.value(wavelength) * self.factor
    }
}
