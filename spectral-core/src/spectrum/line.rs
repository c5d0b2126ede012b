//! Narrow spectral lines.

use super::{Segment, Spectrum, SpectrumError};
use crate::Real;

/// A spectral line: a narrow triangle whose integral over wavelength is the line's power.
///
/// The base is `width` nm wide around the centre in nm, the peak is `2 power / width` (power per nm), and the line is
/// zero outside. The ends of the base are rounded to `R`; the peak is chosen for the rounded base, so that the integral
/// is `power` within 2 EPSILON.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Line<R> {
    low: R,
    centre: R,
    high: R,
    peak: R,
}

impl<R: Real> Line<R> {
    /// A line at `centre` nm of base `width` nm and of the given power.
    ///
    /// # Errors
    /// `centre` or `power` isn't finite, `power` is negative, or `width` isn't positive and finite or too narrow for
    /// `R` (the three corners must differ); indices are 0.
    pub fn new(centre: R, width: R, power: R) -> Result<Self, SpectrumError> {
        let line = Self::triangle(centre, width, power);
        if !centre.is_finite() {
            return Err(SpectrumError::Wavelength { index: 0 });
        }
        let corners_differ = line.low < line.centre && line.centre < line.high;
        if !(width > R::ZERO && corners_differ && (line.high - line.low).is_finite()) {
            return Err(SpectrumError::Width { index: 0 });
        }
        if power < R::ZERO {
            return Err(SpectrumError::Negative { index: 0 });
        }
        if !(power.is_finite() && line.peak.is_finite()) {
            return Err(SpectrumError::Value { index: 0 });
        }
        Ok(line)
    }

    fn triangle(centre: R, width: R, power: R) -> Self {
        let half = width * R::HALF;
        let (low, high) = (centre - half, centre + half);
        Self { low, centre, high, peak: R::TWO * power / (high - low) }
    }

    /// Where the line peaks, in nm.
    #[must_use]
    pub const fn centre(&self) -> R {
        self.centre
    }

    /// The largest value, at the centre.
    #[must_use]
    pub const fn peak(&self) -> R {
        self.peak
    }
}

impl<R: Real> Spectrum<R> for Line<R> {
    fn segment(&self, wavelength: R) -> Segment<R> {
        let flat = |end| Segment { end, first: R::ZERO, last: R::ZERO };
        if wavelength < self.low {
            flat(self.low)
        } else if wavelength < self.centre {
            let first = self.peak * ((wavelength - self.low) / (self.centre - self.low));
            Segment { end: self.centre, first, last: self.peak }
        } else if wavelength < self.high {
            let first = self.peak * ((self.high - wavelength) / (self.high - self.centre));
            Segment { end: self.high, first, last: R::ZERO }
        } else {
            flat(R::INFINITY)
        }
    }
}

/// A line spectrum: the sum of [`Line`]s of one base width, at wavelengths and with powers borrowed from the caller.
///
/// Lines may overlap and come in any order. A query costs one step a line.
#[derive(Clone, Copy, Debug)]
pub struct Lines<'a, R> {
    centres: &'a [R],
    powers: &'a [R],
    width: R,
}

impl<'a, R: Real> Lines<'a, R> {
    /// Lines at `centres` in nm with the given powers, each of base `width` nm.
    ///
    /// # Errors
    /// The lengths differ, or a line is refused as by [`Line::new`]: the error has its index.
    pub fn new(centres: &'a [R], powers: &'a [R], width: R) -> Result<Self, SpectrumError> {
        if centres.len() != powers.len() {
            return Err(SpectrumError::LengthMismatch { wavelengths: centres.len(), values: powers.len() });
        }
        for (index, (&centre, &power)) in centres.iter().zip(powers).enumerate() {
            Line::new(centre, width, power).map_err(|error| at(error, index))?;
        }
        Ok(Self { centres, powers, width })
    }

    /// The lines.
    pub fn iter(&self) -> impl Iterator<Item = Line<R>> + 'a {
        let width = self.width;
        self.centres.iter().zip(self.powers).map(move |(&centre, &power)| Line::triangle(centre, width, power))
    }
}

/// The error of one line as that of line `index`.
fn at(error: SpectrumError, index: usize) -> SpectrumError {
    match error {
        SpectrumError::Wavelength { .. } => SpectrumError::Wavelength { index },
        SpectrumError::Width { .. } => SpectrumError::Width { index },
        SpectrumError::Negative { .. } => SpectrumError::Negative { index },
        SpectrumError::Value { .. } => SpectrumError::Value { index },
        other => other,
    }
}

impl<R: Real> Spectrum<R> for Lines<'_, R> {
    fn segment(&self, wavelength: R) -> Segment<R> {
        let (mut end, mut first) = (R::INFINITY, R::ZERO);
        for line in self.iter() {
            let piece = line.segment(wavelength);
            end = end.min(piece.end);
            first += piece.first;
        }
        // Triangles are continuous: the limit at the end is the value there.
        let last = if end.is_finite() { self.value(end) } else { R::ZERO };
        Segment { end, first, last }
    }

    fn value(&self, wavelength: R) -> R {
        self.iter().fold(R::ZERO, |sum, line| sum + line.value(wavelength))
    }
}
