//! Spectra on intervals that were split for one scene, as rows of numbers.

use spectral_core::adaptive::Mode;

use super::cell::{Cell, Row};
use super::representation::{Representation, Tristimulus};
use crate::spectral::Factor;

/// The numbers of a cell: three values; by Iehl and Péroche the mean of all channels, too; for the certified mode slope, norm and radius.
pub(super) const fn numbers(mode: Mode) -> usize {
    match mode {
        Mode::Corrected => 3,
        Mode::Paper => 4,
        Mode::Certified => Row::NUMBERS,
    }
}

/// Spectra as means on intervals, for each lamp's spectrum by itself: first the three channels' means on all intervals, then by mode the mean
/// of all channels on each, or all slopes, then all norms and then all radii.
#[derive(Clone, Debug)]
pub(super) struct IntervalRows {
    pub(super) mode: Mode,
    /// For each lamp, its leaf of the palette.
    pub(super) lamps: Vec<Option<u32>>,
    pub(super) cells: Vec<Cell>,
}

impl IntervalRows {
    /// The numbers of a cell in a row.
    fn at(&self, row: &[f64], cell: usize) -> Row {
        let count = self.cells.len();
        let number = |index: usize| row.get(index).copied().unwrap_or(0.0);
        Row {
            value: core::array::from_fn(|a| number(3 * cell + a)),
            slope: if self.mode == Mode::Certified { number(3 * count + cell) } else { 0.0 },
            norm: number(if self.mode == Mode::Certified { 4 * count + cell } else { 3 * count + cell }),
            radius: number(5 * count + cell),
        }
    }

    pub(super) fn put(&self, row: &mut [f64], cell: usize, numbers: &Row) {
        let count = self.cells.len();
        row[3 * cell..][..3].copy_from_slice(&numbers.value);
        match self.mode {
            Mode::Corrected => {}
            Mode::Paper => row[3 * count + cell] = numbers.norm,
            Mode::Certified => {
                row[3 * count + cell] = numbers.slope;
                row[4 * count + cell] = numbers.norm;
                row[5 * count + cell] = numbers.radius;
            }
        }
    }
}

impl Representation for IntervalRows {
    /// One number, which is 0, where there is no light.
    fn width(&self) -> usize {
        (numbers(self.mode) * self.cells.len()).max(1)
    }

    /// Relative to the spectrum of its lamp, a light is a number; a spectrum that is no lamp's gives 0.
    fn light(&self, factor: Factor, row: &mut [f64]) {
        row.fill(0.0);
        for (index, cell) in self.cells.iter().enumerate() {
            if self.lamps.get(cell.lamp) == Some(&factor.leaf) {
                let norm = if self.mode == Mode::Certified { 0.0 } else { factor.scale };
                self.put(row, index, &Row { value: [factor.scale; 3], norm, ..Row::default() });
            }
        }
    }

    fn reflect(&self, factor: Factor, row: &mut [f64]) {
        for (index, cell) in self.cells.iter().enumerate() {
            let reflected = cell.reflected(self.mode, &cell.part(factor), &self.at(row, index));
            self.put(row, index, &reflected);
        }
    }

    fn colour(&self, leaves: &[u32], row: &[f64]) -> Tristimulus {
        let mut sum = Tristimulus::default();
        for (index, cell) in self.cells.iter().enumerate() {
            let mut light = self.at(row, index);
            for leaf in leaves.iter().rev() {
                let part = cell.part(Factor { scale: 1.0, leaf: Some(*leaf) });
                light = cell.reflected(self.mode, &part, &light);
            }
            let (value, radius) = cell.colour(self.mode, &light);
            sum.value = core::array::from_fn(|a| sum.value[a] + value[a]);
            sum.radius = core::array::from_fn(|a| sum.radius[a] + radius[a]);
        }
        if self.mode == Mode::Corrected {
            // The first-order error isn't kept: it is in the value.
            sum.radius = [0.0; 3];
        }
        sum
    }

    fn intervals(&self) -> usize {
        self.cells.len()
    }

    fn values(&self) -> usize {
        (3 * self.cells.len()).max(1)
    }

    fn linear(&self) -> usize {
        let slopes = if self.mode == Mode::Certified { self.cells.len() } else { 0 };
        self.values() + slopes
    }

    fn is_diagonal(&self) -> bool {
        self.mode != Mode::Certified
    }
}
