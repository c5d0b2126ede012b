//! Where a wavelength lies among the nodes of a piecewise linear function.

use super::{Outside, Segment, SpectrumError};
use crate::Real;

/// Where a wavelength lies among nodes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Place<R> {
    /// Below the first node, which is given (also for NaN).
    Below(R),
    /// At node `index` or above, and below node `index` + 1.
    Between { index: usize, start: R, end: R },
    /// At the last node or above.
    Above,
}

impl<R: Real> Place<R> {
    /// The linear piece that starts at `wavelength` of the function whose `count` node values are given.
    #[inline]
    pub(crate) fn segment(
        self,
        wavelength: R,
        count: usize,
        outside: Outside,
        value: impl Fn(usize) -> R,
    ) -> Segment<R> {
        let flat = |end, index| {
            let held = match outside {
                Outside::Zero => R::ZERO,
                Outside::Hold => value(index),
            };
            Segment { end, first: held, last: held }
        };
        match self {
            Self::Below(end) => flat(end, 0),
            Self::Above => flat(R::INFINITY, count.saturating_sub(1)),
            Self::Between { index, start, end } => {
                let (first, last) = (value(index), value(index + 1));
                let first = interpolate(first, last, wavelength - start, end - wavelength);
                Segment { end, first, last }
            }
        }
    }
}

/// The value between `first` and `last` at distances `below` from the one and `above` from the other.
///
/// Reckoned from the nearer end: exact at both ends and between equal values, and as accurate relative to the result
/// as to the ends when neither is negative.
#[inline]
pub(crate) fn interpolate<R: Real>(first: R, last: R, below: R, above: R) -> R {
    let (near, far, part) = if below <= above { (first, last, below) } else { (last, first, above) };
    near + (far - near) * (part / (below + above))
}

/// Nodes at equal steps: node i is `first` + i · `step`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Grid<R> {
    pub(crate) first: R,
    pub(crate) step: R,
    pub(crate) count: usize,
}

impl<R: Real> Grid<R> {
    /// A grid of at least two nodes that are finite and distinct in `R`.
    pub(crate) fn new(first: R, step: R, count: usize) -> Result<Self, SpectrumError> {
        let grid = Self { first, step, count };
        if count < 2 {
            return Err(SpectrumError::TooFewNodes { count });
        }
        if !first.is_finite() {
            return Err(SpectrumError::Wavelength { index: 0 });
        }
        if !(step > R::ZERO && step.is_finite()) {
            return Err(SpectrumError::Step);
        }
        let last = grid.node(count - 1);
        if !(last.is_finite() && (last - first).is_finite()) {
            return Err(SpectrumError::Range);
        }
        // Two roundings a node: distinct, and `locate` guesses within one node, when a step is several ULPs.
        let coarsest = first.abs().max(last.abs()) * R::EPSILON;
        if step < coarsest * R::from_usize(4) {
            return Err(SpectrumError::Step);
        }
        Ok(grid)
    }

    /// The wavelength of a node.
    #[inline]
    pub(crate) fn node(&self, index: usize) -> R {
        self.first + self.step * R::from_usize(index)
    }

    /// Where `wavelength` lies.
    #[inline]
    pub(crate) fn locate(&self, wavelength: R) -> Place<R> {
        if self.count < 2 || !(wavelength >= self.first) {
            return Place::Below(self.first);
        }
        if wavelength >= self.node(self.count - 1) {
            return Place::Above;
        }
        let mut index = ((wavelength - self.first) / self.step).to_usize().min(self.count - 2);
        // The guess may be off by rounding; both loops end after one turn at most.
        while index > 0 && self.node(index) > wavelength {
            index -= 1;
        }
        while self.node(index + 1) <= wavelength {
            index += 1;
        }
        Place::Between { index, start: self.node(index), end: self.node(index + 1) }
    }
}
