//! The spectra of light that surfaces have reflected, as products.

use std::collections::HashMap;

use crate::radiosity::Representation;
use crate::spectral::{Factor, Tabulated, Y_INTEGRAL};

/// A light's spectrum (none: flat) and reflectances, in the order in which light met them where that matters.
type Shade = (Option<u32>, Vec<u32>);

/// Products of a light's spectrum and reflectances, each with a number.
#[derive(Clone, Debug, Default)]
pub(crate) struct Shades {
    products: Vec<Shade>,
    numbers: HashMap<Shade, u32>,
}

impl Shades {
    /// The number of a product.
    pub(super) fn number(&mut self, light: Option<u32>, reflectances: &[u32]) -> u32 {
        let next = u32::try_from(self.products.len()).unwrap_or(u32::MAX);
        let shade = (light, reflectances.to_vec());
        let number = *self.numbers.entry(shade.clone()).or_insert(next);
        if number == next {
            self.products.push(shade);
        }
        number
    }

    /// How many products there are.
    pub(crate) fn len(&self) -> usize {
        self.products.len()
    }

    /// All products in the order of their numbers.
    pub(super) fn iter(&self) -> impl Iterator<Item = (Option<u32>, &[u32])> {
        self.products.iter().map(|(light, leaves)| (*light, leaves.as_slice()))
    }

    /// Writes the row of a product. A number that is none gives 0.
    pub(super) fn row(&self, number: u32, representation: &dyn Representation, row: &mut [f64]) {
        let Some((light, reflectances)) = self.products.get(number as usize) else {
            row.fill(0.0);
            return;
        };
        representation.light(Factor { scale: 1.0, leaf: *light }, row);
        for leaf in reflectances {
            representation.reflect(Factor { scale: 1.0, leaf: Some(*leaf) }, row);
        }
    }
}

/// The mean of a spectrum under the sum of the colour-matching functions, relative to a flat spectrum of 1: blue counts as much as red.
pub(super) fn mean(leaf: &Tabulated) -> f64 {
    let observer = spectral_core::Observer::cie_1931_2deg();
    let all = |spectrum| spectral_core::tristimulus(&observer, &spectrum, 380.0, 780.0).iter().sum::<f64>();
    // The functions have integrals that differ by less than a thousandth.
    leaf.spectrum().map_or(0.0, all) / (3.0 * Y_INTEGRAL)
}
