//! A pixel's radiance as a sum of products of spectra.

use core::hash::{BuildHasherDefault, Hasher};
use std::collections::HashMap;

use super::Factor;

/// A hasher for keys of two small numbers that nobody chooses to collide: each is mixed in by a rotation and a multiplication
/// (as in the hash tables of Firefox).
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct PairHasher(u64);

impl Hasher for PairHasher {
    fn finish(&self) -> u64 {
        // Tables look at the highest and at the lowest bits.
        self.0 ^ (self.0 >> 32)
    }

    fn write(&mut self, bytes: &[u8]) {
        for byte in bytes {
            self.write_u32(u32::from(*byte));
        }
    }

    fn write_u32(&mut self, number: u32) {
        // 2⁶⁴ over the golden ratio, made odd.
        self.0 = (self.0.rotate_left(5) ^ u64::from(number)).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    }
}

/// Builds [`PairHasher`]s.
pub(crate) type PairBuild = BuildHasherDefault<PairHasher>;

/// A product of leaves, by its number among [`Monomials`]; the default is the empty product, 1.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Monomial(u32);

impl Monomial {
    /// The number, from 0 for the empty product.
    pub const fn index(self) -> usize {
        self.0 as usize
    }

    /// The same, for keys of hash tables.
    pub(crate) const fn number(self) -> u32 {
        self.0
    }
}

/// Whether the order of a product's factors matters.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum FactorOrder {
    /// It doesn't: spectra are multiplied wavelength by wavelength. Factors are kept in increasing order.
    #[default]
    Free,
    /// It does, as for operators that aren't associative: factors are kept as they are met, from the eye to the light.
    Kept,
}

/// All products met so far: each gets one number, however its factors are ordered where that doesn't matter.
#[derive(Clone, Debug)]
pub struct Monomials {
    order: FactorOrder,
    factors: Vec<Vec<u32>>,
    products: HashMap<(u32, u32), u32, PairBuild>,
    numbers: HashMap<Vec<u32>, u32>,
}

impl Monomials {
    /// The empty product alone.
    pub fn new(order: FactorOrder) -> Self {
        Self {
            order,
            factors: vec![Vec::new()],
            products: HashMap::default(),
            numbers: HashMap::from([(Vec::new(), 0)]),
        }
    }

    /// How many products have been met, the empty one included.
    #[allow(clippy::len_without_is_empty, reason = "the empty product is always there")]
    pub fn len(&self) -> usize {
        self.factors.len()
    }

    /// The product of a monomial and a leaf.
    pub fn times_leaf(&mut self, monomial: Monomial, leaf: u32) -> Monomial {
        if let Some(known) = self.products.get(&(monomial.0, leaf)) {
            return Monomial(*known);
        }
        let mut factors = self.factors[monomial.index()].clone();
        let place = match self.order {
            FactorOrder::Free => factors.partition_point(|f| *f <= leaf),
            FactorOrder::Kept => factors.len(),
        };
        factors.insert(place, leaf);
        let next = u32::try_from(self.factors.len()).unwrap_or(u32::MAX);
        let number = *self.numbers.entry(factors.clone()).or_insert(next);
        if number == next {
            self.factors.push(factors);
        }
        self.products.insert((monomial.0, leaf), number);
        Monomial(number)
    }

    /// The product of two monomials.
    pub fn product(&mut self, first: Monomial, second: Monomial) -> Monomial {
        let mut product = first;
        for place in 0..self.factors[second.index()].len() {
            product = self.times_leaf(product, self.factors[second.index()][place]);
        }
        product
    }

    /// The product of a weighted monomial and a factor.
    pub fn times(&mut self, monomial: Monomial, weight: f64, factor: Factor) -> (Monomial, f64) {
        let product = factor.leaf.map_or(monomial, |leaf| self.times_leaf(monomial, leaf));
        (product, weight * factor.scale)
    }

    /// The leaves of a monomial, in increasing order or from the eye to the light.
    pub fn leaves(&self, monomial: Monomial) -> &[u32] {
        &self.factors[monomial.index()]
    }
}

/// Light whose path depends on the wavelength, by its number in the pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Deferred(pub u32);

/// Light from other surfaces, whose spectrum is no product of the palette's, by its number in the pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Gathered(pub u32);

/// A sum of weighted products of spectra, of deferred light and of gathered light.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Radiance {
    terms: Vec<(Monomial, f64)>,
    deferred: Vec<(Deferred, Monomial, f64)>,
    gathered: Vec<(Gathered, Monomial, f64)>,
}

impl Radiance {
    /// The terms whose paths don't depend on the wavelength, each product once.
    pub fn terms(&self) -> &[(Monomial, f64)] {
        &self.terms
    }

    /// The deferred light, each with what it is multiplied by.
    pub fn deferred(&self) -> &[(Deferred, Monomial, f64)] {
        &self.deferred
    }

    /// The gathered light, each with what it is multiplied by.
    pub fn gathered(&self) -> &[(Gathered, Monomial, f64)] {
        &self.gathered
    }

    /// Adds a product of spectra.
    pub fn add(&mut self, monomial: Monomial, weight: f64) {
        if weight == 0.0 {
            return;
        }
        match self.terms.iter_mut().find(|(known, _)| *known == monomial) {
            Some((_, sum)) => *sum += weight,
            None => self.terms.push((monomial, weight)),
        }
    }

    /// Adds deferred light times a product of spectra.
    pub fn defer(&mut self, deferred: Deferred, monomial: Monomial, weight: f64) {
        if weight != 0.0 {
            self.deferred.push((deferred, monomial, weight));
        }
    }

    /// Adds gathered light times a product of spectra.
    pub fn gather(&mut self, gathered: Gathered, monomial: Monomial, weight: f64) {
        if weight != 0.0 {
            self.gathered.push((gathered, monomial, weight));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{FactorOrder, Monomial, Monomials};

    #[test]
    fn the_order_of_factors_is_kept_where_it_matters() {
        for (order, expected) in [(FactorOrder::Free, [1, 2, 2, 7]), (FactorOrder::Kept, [7, 2, 1, 2])] {
            let mut monomials = Monomials::new(order);
            let mut of =
                |leaves: &[u32]| leaves.iter().fold(Monomial::default(), |m, leaf| monomials.times_leaf(m, *leaf));
            let (near, far) = (of(&[7, 2]), of(&[1, 2]));
            let product = monomials.product(near, far);
            assert_eq!(monomials.leaves(product), expected);
            let other = monomials.product(far, near);
            assert_eq!(product == other, order == FactorOrder::Free);
        }
    }
}
