//! How spectra are represented in a solution: components that are multiplied one by one.

use crate::spectral::{Components, Factor, UniformBins};

/// A spectral representation whose components are multiplied one by one.
pub trait Basis: Sync {
    /// How many components there are.
    fn width(&self) -> usize;

    /// The components of a leaf of the palette; `None` if there is no such leaf.
    fn leaf(&self, leaf: u32) -> Option<&[f64]>;
}

impl Basis for UniformBins {
    fn width(&self) -> usize {
        self.len()
    }

    fn leaf(&self, leaf: u32) -> Option<&[f64]> {
        self.means(leaf)
    }
}

impl Basis for Components {
    fn width(&self) -> usize {
        3
    }

    fn leaf(&self, leaf: u32) -> Option<&[f64]> {
        self.components(leaf).map(<[f64; 3]>::as_slice)
    }
}

/// One component alone, of spectra that are flat: their numbers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Flat;

impl Basis for Flat {
    fn width(&self) -> usize {
        1
    }

    fn leaf(&self, _: u32) -> Option<&[f64]> {
        Some(&[1.0])
    }
}

/// Writes components `first`… of a factor.
pub(super) fn components(basis: &dyn Basis, factor: Factor, first: usize, to: &mut [f64]) {
    match factor.leaf.map(|leaf| basis.leaf(leaf)) {
        None => to.fill(factor.scale),
        Some(Some(values)) => to.iter_mut().zip(&values[first..]).for_each(|(t, v)| *t = factor.scale * v),
        Some(None) => to.fill(0.0),
    }
}
