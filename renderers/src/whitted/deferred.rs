//! What is found of deferred light: for some waves, at all of them, and the light between surfaces in it.

use super::refraction::Interface;
use super::{Between, Later, Path, Worker};
use crate::spectral::{Band, Deferred, Gathered, MEAN_WAVELENGTH, Monomial, Monomials, Radiance, Tracer};

impl Worker<'_> {
    /// Adds light times a path's products and weight; what is deferred in it stays so.
    pub(super) fn add_product(&mut self, light: &Radiance, by: Path, radiance: &mut Radiance) {
        self.add_found(light, by, radiance);
        for (deferred, monomial, weight) in light.deferred() {
            let product = self.monomials.product(by.monomial, *monomial);
            radiance.defer(*deferred, product, by.weight * weight);
        }
    }

    /// The same, what is deferred for some waves.
    pub(super) fn add_for(&mut self, band: Band, light: &Radiance, by: Path, radiance: &mut Radiance) {
        self.add_found(light, by, radiance);
        for (deferred, monomial, weight) in light.deferred() {
            let inner = self.expand(deferred.0 as usize, band);
            let product = self.monomials.product(by.monomial, *monomial);
            self.add_product(&inner, Path { monomial: product, weight: by.weight * weight, ..by }, radiance);
        }
    }

    /// The same of what is not deferred.
    fn add_found(&mut self, light: &Radiance, by: Path, radiance: &mut Radiance) {
        for (monomial, weight) in light.terms() {
            let product = self.monomials.product(by.monomial, *monomial);
            radiance.add(product, by.weight * weight);
        }
        for (gathered, monomial, weight) in light.gathered() {
            let product = self.monomials.product(by.monomial, *monomial);
            radiance.gather(*gathered, product, by.weight * weight);
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

impl Tracer for Worker<'_> {
    fn monomials(&self) -> &Monomials {
        &self.monomials
    }

    fn trace(&mut self, deferred: Deferred, band: Band) -> Radiance {
        self.expand(deferred.0 as usize, band)
    }

    fn lines(
        &mut self,
        deferred: Deferred,
        (by, weight): (Monomial, f64),
        steps: &[u16],
        add: &mut dyn FnMut(Monomial, &[f64]),
    ) -> bool {
        let Some(Later::Curve(curve)) = self.deferred.get(deferred.0 as usize) else { return false };
        let is_known = steps.contains(&curve.steps());
        let mut scaled = Vec::new();
        for (monomial, weights) in curve.terms().filter(|_| is_known) {
            scaled.clear();
            scaled.extend(weights.iter().map(|w| weight * w));
            add(self.monomials.product(by, monomial), &scaled);
        }
        is_known
    }

    fn trace_gathered(&mut self, deferred: Deferred) -> Radiance {
        let number = deferred.0 as usize;
        if let Some(Later::Boundary(interface)) = self.deferred.get(number).cloned() {
            self.prepare(number, &interface, Band::single(MEAN_WAVELENGTH));
        }
        self.gathered(number)
    }

    fn row(&self, gathered: Gathered) -> &[f64] {
        let Between::Asked(indirect) = &self.between else { return &[] };
        self.rows.chunks(indirect.width().max(1)).nth(gathered.0 as usize).unwrap_or_default()
    }
}

#[cfg(test)]
mod tests {
    use crate::geometry::Hit;
    use crate::geometry::sampling::SobolSequence;
    use crate::scene::builtin;
    use crate::spectral::{Band, FactorOrder, Palette, Radiance, Tracer};
    use crate::whitted::{Whitted, Worker};

    const SIDE: u16 = 24;

    /// Where light between surfaces is asked for, if the sphere is of a glass; deferred light is traced at these wavelengths, too.
    fn noted(glass: &str, wavelengths: &[f64]) -> Vec<Hit> {
        let scene = builtin::load("cornell-box-glass", &[("glass".to_owned(), glass.to_owned())]).unwrap();
        let mut palette = Palette::default();
        let whitted = Whitted::new(&scene, [u32::from(SIDE); 2], &mut palette).unwrap();
        let mut worker = Worker::new(&whitted, FactorOrder::Free).noting();
        for pixel in 0..SIDE * SIDE {
            let [x, y] = [pixel % SIDE, pixel / SIDE];
            let mut radiance = Radiance::default();
            worker.start_pixel(SobolSequence::for_pixel(x.into(), y.into(), 0));
            worker.sample(f64::from(x) + 0.5, f64::from(y) + 0.5, 1.0, &mut radiance);
            for (deferred, _, _) in radiance.deferred() {
                worker.trace_gathered(*deferred);
                wavelengths.iter().for_each(|wavelength| drop(worker.trace(*deferred, Band::single(*wavelength))));
            }
        }
        worker.into_noted()
    }

    /// What is seen behind glass is asked for once, as behind glass of the same index at all wavelengths, however often it is traced.
    #[test]
    fn light_between_surfaces_is_asked_for_once() {
        let [still, once, often] = [noted("1.5168", &[]), noted("N-BK7", &[]), noted("N-BK7", &[450.0, 587.5618])];
        assert!(still.len() > usize::from(SIDE * SIDE), "{}", still.len());
        assert!(
            once.len() == still.len() && often.len() == still.len(),
            "{} {} {}",
            still.len(),
            once.len(),
            often.len()
        );
        for (own, other) in still.iter().zip(&often) {
            assert!(own.shape == other.shape && own.position.distance(other.position) <= 1e-3, "{own:?} {other:?}");
        }
    }
}
