//! The products of spectra that photons carry.

use std::collections::HashMap;

/// Products of the palette's leaves, each with a number, from 0 for the empty one. Factors are in the order from the eye to the light.
#[derive(Clone, Debug)]
pub(crate) struct Spectra {
    products: Vec<Vec<u32>>,
    numbers: HashMap<Vec<u32>, u32>,
}

impl Default for Spectra {
    fn default() -> Self {
        Self { products: vec![Vec::new()], numbers: HashMap::from([(Vec::new(), 0)]) }
    }
}

impl Spectra {
    /// The number of a product whose factors were met in this order, from the light to the surface.
    pub(crate) fn number(&mut self, from_light: &[u32]) -> u32 {
        let leaves: Vec<u32> = from_light.iter().rev().copied().collect();
        if let Some(known) = self.numbers.get(&leaves) {
            return *known;
        }
        let number = u32::try_from(self.products.len()).unwrap_or(u32::MAX);
        self.products.push(leaves.clone());
        self.numbers.insert(leaves, number);
        number
    }

    /// The factors of a product, from the eye to the light.
    pub(crate) fn leaves(&self, number: u32) -> &[u32] {
        self.products.get(number as usize).map_or(&[], Vec::as_slice)
    }

    /// How many products there are.
    pub(crate) fn len(&self) -> usize {
        self.products.len()
    }
}

#[cfg(test)]
mod tests {
    use super::Spectra;

    #[test]
    fn factors_are_kept_from_the_eye_to_the_light() {
        let mut spectra = Spectra::default();
        let number = spectra.number(&[7, 2, 5]);
        assert_eq!(spectra.leaves(number), [5, 2, 7]);
        assert_eq!(spectra.number(&[7, 2, 5]), number);
        assert_ne!(spectra.number(&[5, 2, 7]), number);
        assert_eq!((spectra.number(&[]), spectra.len()), (0, 3));
    }
}
