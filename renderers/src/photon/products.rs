//! Products of spectra that one thread meets, and how they get their numbers among all [`Spectra`].

use std::collections::HashMap;

use super::Spectra;
use crate::spectral::PairBuild;

/// Products that extend those of [`Spectra`]: numbers from `known` on are this table's own.
#[derive(Clone, Debug)]
pub(super) struct Products {
    known: u32,
    /// A product and one more leaf, which was met later on the way from the light.
    own: Vec<(u32, u32)>,
    numbers: HashMap<(u32, u32), u32, PairBuild>,
}

impl Products {
    /// Products that extend these.
    pub(super) fn of(spectra: &Spectra) -> Self {
        let known = u32::try_from(spectra.len()).unwrap_or(u32::MAX);
        Self { known, own: Vec::new(), numbers: HashMap::default() }
    }

    /// A product times a leaf.
    pub(super) fn times(&mut self, product: u32, leaf: Option<u32>) -> u32 {
        let Some(leaf) = leaf else { return product };
        let next = self.known + u32::try_from(self.own.len()).unwrap_or(0);
        *self.numbers.entry((product, leaf)).or_insert_with(|| {
            self.own.push((product, leaf));
            next
        })
    }

    /// Adds the products to the table of all, in the order in which they were met.
    pub(super) fn into_spectra(self, spectra: &mut Spectra) -> Renumbered {
        let mut renumbered = Renumbered { known: self.known, numbers: Vec::with_capacity(self.own.len()) };
        for (product, leaf) in self.own {
            let before = spectra.leaves(renumbered.number(product)).iter().rev().copied();
            let from_light: Vec<u32> = before.chain([leaf]).collect();
            renumbered.numbers.push(spectra.number(&from_light));
        }
        renumbered
    }
}

/// The numbers that a thread's products have among all.
#[derive(Clone, Debug)]
pub(super) struct Renumbered {
    known: u32,
    numbers: Vec<u32>,
}

impl Renumbered {
    pub(super) fn number(&self, product: u32) -> u32 {
        let own = product.checked_sub(self.known).and_then(|own| self.numbers.get(own as usize));
        own.copied().unwrap_or(product)
    }
}

#[cfg(test)]
mod tests {
    use super::Products;
    use crate::photon::Spectra;

    #[test]
    fn products_of_threads_become_one_table() {
        let mut spectra = Spectra::default();
        let first = spectra.number(&[4]);
        let tables = [[7, 9], [9, 7]].map(|leaves| {
            let mut products = Products::of(&spectra);
            let product = leaves.iter().fold(first, |product, leaf| products.times(product, Some(*leaf)));
            assert_eq!(products.times(first, Some(leaves[0])), product - 1);
            assert_eq!(products.times(product, None), product);
            (products, product)
        });
        for ((products, product), leaves) in tables.into_iter().zip([[9, 7, 4], [7, 9, 4]]) {
            let renumbered = products.into_spectra(&mut spectra);
            assert_eq!(spectra.leaves(renumbered.number(product)), leaves);
            assert_eq!(renumbered.number(first), first);
        }
        assert_eq!(spectra.len(), 6);
    }
}
