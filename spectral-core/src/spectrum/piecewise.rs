//! Spectra given at nodes: any increasing wavelengths, or equal steps.

use super::grid::{Grid, Place};
use super::{Outside, Segment, Spectrum, SpectrumError};
use crate::Real;

/// A piecewise linear spectrum through values at increasing wavelengths in nm, borrowed from the caller.
///
/// Values between nodes are `v₀ + (v₁ − v₀)(λ − λ₀)/(λ₁ − λ₀)`: exact at nodes and where neighbours are equal, never
/// negative between values that aren't, elsewhere within 4 EPSILON of the larger neighbour. Values may be of either
/// sign, up to half the largest number. Outside the nodes, [`Outside`] decides. At the last node itself,
/// [`value`](Spectrum::value) is that node's value, while [`segment`](Spectrum::segment) starts the piece beyond it.
///
/// ```
/// use spectral_core::spectrum::{Outside, PiecewiseLinear, Spectrum};
/// let filter = PiecewiseLinear::new(&[400.0, 500.0, 700.0], &[0.0, 0.8, 0.4], Outside::Zero)?;
/// assert_eq!(filter.value(600.0), 0.6000000000000001);
/// assert_eq!(filter.value(750.0), 0.0);
/// # Ok::<(), spectral_core::spectrum::SpectrumError>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct PiecewiseLinear<'a, R> {
    wavelengths: &'a [R],
    values: &'a [R],
    outside: Outside,
}

impl<'a, R: Real> PiecewiseLinear<'a, R> {
    /// A spectrum through `values` at `wavelengths` in nm.
    ///
    /// # Errors
    /// The lengths differ, there are fewer than two nodes, a wavelength or value isn't finite, or the wavelengths
    /// don't increase strictly: the error names the first node at fault.
    pub fn new(wavelengths: &'a [R], values: &'a [R], outside: Outside) -> Result<Self, SpectrumError> {
        if wavelengths.len() != values.len() {
            return Err(SpectrumError::LengthMismatch { wavelengths: wavelengths.len(), values: values.len() });
        }
        let (Some(&first), Some(&last), 2..) = (wavelengths.first(), wavelengths.last(), wavelengths.len()) else {
            return Err(SpectrumError::TooFewNodes { count: wavelengths.len() });
        };
        if let Some(index) = wavelengths.iter().position(|w| !w.is_finite()) {
            return Err(SpectrumError::Wavelength { index });
        }
        if let Some(before) = wavelengths.windows(2).position(|pair| !matches!(pair, [a, b] if a < b)) {
            return Err(SpectrumError::Order { index: before + 1 });
        }
        if !(last - first).is_finite() {
            return Err(SpectrumError::Range);
        }
        check_finite(values)?;
        Ok(Self { wavelengths, values, outside })
    }

    /// The spectrum of a built-in table, whose validity the tests assert.
    pub(crate) const fn from_table(wavelengths: &'a [R], values: &'a [R], outside: Outside) -> Self {
        Self { wavelengths, values, outside }
    }

    /// The wavelengths of the nodes in nm.
    #[must_use]
    pub const fn wavelengths(&self) -> &'a [R] {
        self.wavelengths
    }

    /// The values at the nodes.
    #[must_use]
    pub const fn values(&self) -> &'a [R] {
        self.values
    }

    /// Refuses a spectrum with a value below zero, for those that must be non-negative: powers, reflectances.
    ///
    /// # Errors
    /// [`SpectrumError::Negative`] with the first such node.
    pub fn check_non_negative(&self) -> Result<(), SpectrumError> {
        check_non_negative(self.values)
    }

    fn locate(&self, wavelength: R) -> Place<R> {
        let above = self.wavelengths.partition_point(|&node| node <= wavelength);
        match (above.checked_sub(1).and_then(|index| self.wavelengths.get(index)), self.wavelengths.get(above)) {
            (Some(&start), Some(&end)) => Place::Between { index: above - 1, start, end },
            (None, Some(&first)) => Place::Below(first),
            (_, None) => Place::Above,
        }
    }
}

impl<R: Real> Spectrum<R> for PiecewiseLinear<'_, R> {
    fn segment(&self, wavelength: R) -> Segment<R> {
        self.locate(wavelength).segment(wavelength, self.values.len(), self.outside, |index| node(self.values, index))
    }

    fn value(&self, wavelength: R) -> R {
        match (self.wavelengths.last(), self.values.last()) {
            (Some(&last), Some(&value)) if wavelength == last => value,
            _ => self.segment(wavelength).first,
        }
    }
}

/// A piecewise linear spectrum through values at equal steps of wavelength in nm, borrowed from the caller.
///
/// Node i is at `first` + i · `step`, rounded. Accuracy and the behaviour outside and at the last node are those of
/// [`PiecewiseLinear`].
#[derive(Clone, Copy, Debug)]
pub struct Uniform<'a, R> {
    grid: Grid<R>,
    values: &'a [R],
    outside: Outside,
}

impl<'a, R: Real> Uniform<'a, R> {
    /// A spectrum through `values` at `first`, `first` + `step`, … in nm.
    ///
    /// # Errors
    /// There are fewer than two values, one isn't finite (the error has its index), `first` isn't finite, the last
    /// wavelength isn't, or `step` is not positive and finite or so small that nodes coincide in `R`.
    pub fn new(first: R, step: R, values: &'a [R], outside: Outside) -> Result<Self, SpectrumError> {
        let grid = Grid::new(first, step, values.len())?;
        check_finite(values)?;
        Ok(Self { grid, values, outside })
    }

    /// The spectrum of a built-in table, whose validity the tests assert.
    pub(crate) const fn from_table(first: R, step: R, values: &'a [R], outside: Outside) -> Self {
        Self { grid: Grid { first, step, count: values.len() }, values, outside }
    }

    /// Wavelength of the first node in nm.
    #[must_use]
    pub const fn first(&self) -> R {
        self.grid.first
    }

    /// Distance between nodes in nm.
    #[must_use]
    pub const fn step(&self) -> R {
        self.grid.step
    }

    /// The values at the nodes.
    #[must_use]
    pub const fn values(&self) -> &'a [R] {
        self.values
    }

    /// Refuses a spectrum with a value below zero, for those that must be non-negative: powers, reflectances.
    ///
    /// # Errors
    /// [`SpectrumError::Negative`] with the first such node.
    pub fn check_non_negative(&self) -> Result<(), SpectrumError> {
        check_non_negative(self.values)
    }
}

impl<R: Real> Spectrum<R> for Uniform<'_, R> {
    fn segment(&self, wavelength: R) -> Segment<R> {
        self.grid
            .locate(wavelength)
            .segment(wavelength, self.values.len(), self.outside, |index| node(self.values, index))
    }

    fn value(&self, wavelength: R) -> R {
        let last = self.values.len().saturating_sub(1);
        if wavelength == self.grid.node(last) { node(self.values, last) } else { self.segment(wavelength).first }
    }
}

fn node<R: Real>(values: &[R], index: usize) -> R {
    values.get(index).copied().unwrap_or(R::ZERO)
}

fn check_finite<R: Real>(values: &[R]) -> Result<(), SpectrumError> {
    let fault = values.iter().position(|value| !value.is_finite());
    fault.map_or(Ok(()), |index| Err(SpectrumError::Value { index }))
}

fn check_non_negative<R: Real>(values: &[R]) -> Result<(), SpectrumError> {
    let fault = values.iter().position(|&value| value < R::ZERO);
    fault.map_or(Ok(()), |index| Err(SpectrumError::Negative { index }))
}
