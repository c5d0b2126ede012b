//! Colour-matching functions.

use crate::Real;
use crate::array::zip;
use crate::spectrum::interpolate;
use crate::tables::{ObserverTable, observers};

/// The colour-matching functions x̄, ȳ, z̄ of an observer, linear between equidistant nodes and 0 outside them.
#[derive(Clone, Copy, Debug)]
pub struct Observer<'a, R> {
    first: R,
    step: R,
    columns: [&'a [R]; 3],
    count: usize,
}

/// Why colour-matching functions were refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum ObserverError {
    /// The first or last wavelength is not finite, or the step is not positive and finite, or too small to tell the nodes apart in
    /// the number type.
    Grid,
    /// The three columns differ in length or have fewer than two nodes.
    Length,
    /// A node is negative, infinite or NaN.
    Value {
        /// Which of x̄, ȳ, z̄ (0, 1, 2).
        channel: usize,
        /// Which node, from 0.
        index: usize,
    },
}

impl core::fmt::Display for ObserverError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Grid => {
                write!(f, "the wavelength grid of the observer is not increasing and finite")
            }
            Self::Length => write!(f, "the columns of the observer differ in length or have fewer than two nodes"),
            Self::Value { channel, index } => {
                write!(f, "node {index} of channel {channel} of the observer is negative or not finite")
            }
        }
    }
}

impl core::error::Error for ObserverError {}

impl<'a, R: Real> Observer<'a, R> {
    /// An observer from columns x̄, ȳ, z̄ of equidistant nodes: `first` and `step` in nm.
    ///
    /// # Errors
    /// [`ObserverError`] says which value is not one of a colour-matching function.
    pub fn new(first: R, step: R, columns: [&'a [R]; 3]) -> Result<Self, ObserverError> {
        let [x, y, z] = columns;
        if !first.is_finite() || !step.is_finite() || step <= R::ZERO {
            return Err(ObserverError::Grid);
        }
        if x.len() < 2 || x.len() != y.len() || x.len() != z.len() {
            return Err(ObserverError::Length);
        }
        let observer = Self { first, step, columns, count: x.len() };
        // Two roundings a node: distinct, and `cell` guesses within one node, when a step is several ULPs.
        let coarsest = first.abs().max(observer.last().abs()) * R::EPSILON;
        if !(step >= coarsest * R::from_usize(4)) {
            return Err(ObserverError::Grid);
        }
        for (channel, column) in columns.iter().enumerate() {
            if let Some(index) = column.iter().position(|v| !(v.is_finite() && *v >= R::ZERO)) {
                return Err(ObserverError::Value { channel, index });
            }
        }
        Ok(observer)
    }

    /// The wavelength of the last node.
    fn last(&self) -> R {
        self.wavelength(self.count.saturating_sub(1))
    }

    /// The wavelength of a node.
    #[inline]
    fn wavelength(&self, index: usize) -> R {
        self.first + self.step * R::from_usize(index)
    }

    /// The colour-matching functions at the node `index`; zeros outside the table.
    #[inline]
    fn node(&self, index: usize) -> [R; 3] {
        self.columns.map(|column| column.get(index).copied().unwrap_or(R::ZERO))
    }

    /// The cell of the table that starts at or holds `wavelength`: where it ends, and the linear functions in it.
    ///
    /// The end is above `wavelength` for every finite wavelength.
    #[inline]
    pub(crate) fn cell(&self, wavelength: R) -> (R, impl Fn(R) -> [R; 3] + use<R>) {
        let inside = wavelength >= self.first && wavelength < self.last();
        let (end, start, nodes) = if inside {
            let mut index = ((wavelength - self.first) / self.step).to_usize();
            // The quotient may have been rounded across a node.
            if index > 0 && self.wavelength(index) > wavelength {
                index -= 1;
            } else if self.wavelength(index + 1) <= wavelength {
                index += 1;
            }
            let nodes = [self.node(index), self.node(index + 1)];
            (self.wavelength(index + 1), self.wavelength(index), nodes)
        } else {
            let end = if wavelength < self.first { self.first } else { R::INFINITY };
            // Nothing is interpolated outside: any start serves.
            (end, wavelength, [[R::ZERO; 3]; 2])
        };
        let at = move |position: R| {
            let [first, second] = nodes;
            let (below, above) = (position - start, end - position);
            zip(first, second, |first, second| interpolate(first, second, below, above))
        };
        (end, at)
    }

    /// x̄, ȳ, z̄ at a wavelength in nm; zeros outside the table and for NaN.
    pub fn value(&self, wavelength: R) -> [R; 3] {
        if wavelength == self.last() {
            return self.node(self.count.saturating_sub(1));
        }
        if wavelength.is_finite() { self.cell(wavelength).1(wavelength) } else { [R::ZERO; 3] }
    }
}

impl<R: Real> Observer<'static, R> {
    /// The CIE 1931 2° standard observer at 1 nm, 360–830 nm (ISO/CIE 11664-1:2019).
    pub fn cie_1931_2deg() -> Self {
        Self::of_table(&observers::CIE_1931_2)
    }

    /// The CIE 1964 10° standard observer at 1 nm, 360–830 nm (ISO/CIE 11664-1:2019).
    pub fn cie_1964_10deg() -> Self {
        Self::of_table(&observers::CIE_1964_10)
    }

    fn of_table(table: &ObserverTable) -> Self {
        let columns = table.columns.each_ref().map(R::samples);
        let count = columns.iter().map(|c: &&[R]| c.len()).min().unwrap_or(0).max(1);
        let [first, step] = [table.first, table.step].map(|v| R::from_f64(f64::from(v)));
        Self { first, step, columns, count }
    }
}
