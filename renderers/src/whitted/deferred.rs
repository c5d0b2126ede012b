//! What is found of deferred light: for some waves, and the light between surfaces in it.

use super::refraction::Interface;
use super::{Between, Path, Worker};
use crate::spectral::{Band, Radiance};

impl Worker<'_> {
    /// Adds light times a path's products and weight, what is deferred in it for some waves.
    pub(super) fn add_for(&mut self, band: Band, light: &Radiance, by: Path, radiance: &mut Radiance) {
        for (monomial, weight) in light.terms() {
            let product = self.monomials.product(by.monomial, *monomial);
            radiance.add(product, by.weight * weight);
        }
        for (gathered, monomial, weight) in light.gathered() {
            let product = self.monomials.product(by.monomial, *monomial);
            radiance.gather(*gathered, product, by.weight * weight);
        }
        for (deferred, monomial, weight) in light.deferred() {
            let inner = self.expand(deferred.0 as usize, band);
            let product = self.monomials.product(by.monomial, *monomial);
            self.add_product(&inner, Path { monomial: product, weight: by.weight * weight, ..by }, radiance);
        }
    }

    /// Follows deferred light at the wavelength that light between surfaces is gathered for, before it is asked for at any other, so that what
    /// is seen doesn't depend on which are asked for first.
    pub(super) fn prepare(&mut self, number: usize, interface: &Interface, band: Band) {
        if matches!(self.between, Between::Ambient) || self.prepared.iter().any(|(known, _)| *known == number) {
            return;
        }
        let was_preparing = core::mem::replace(&mut self.is_preparing, true);
        // Bodies within sight of each other are prepared on the way.
        self.prepared.push((number, Radiance::default()));
        let light = self.expand_boundary(interface, band);
        self.is_preparing = was_preparing;
        if let Some((_, gathered)) = self.prepared.iter_mut().find(|(known, _)| *known == number) {
            *gathered = light;
        }
    }

    /// The light between surfaces in deferred light.
    pub(super) fn gathered(&mut self, number: usize) -> Radiance {
        self.prepared
            .iter()
            .find(|(known, _)| *known == number)
            .map_or_else(Radiance::default, |(_, light)| light.clone())
    }
}
