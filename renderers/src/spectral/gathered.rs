//! Colours of light that is partly a product of spectra and partly gathered from other surfaces.

use spectral_core::bound::delta_e_bound;

use super::{Colour, Monomial, Radiance, Resolver, Tracer, Y_INTEGRAL};

/// The tristimulus values, Y = 1 for a flat radiance of 1, of a row of some representation times a product of the palette's leaves, from the
/// eye to the light; and how far each may be off.
pub type RowColour<'c> = dyn Fn(&[u32], &[f64]) -> [[f64; 3]; 2] + Sync + 'c;

/// A resolver that adds gathered light to what another one makes of the rest.
///
/// Errors of both parts add up. Gathered light behind a medium with a wavelength-dependent index is taken along the path of one wavelength,
/// 587.56 nm: it is smooth, so that its dispersion shows no more than a prism's does on a wall.
pub struct WithGathered<'c, R> {
    inner: R,
    colour: &'c RowColour<'c>,
    /// The intervals of the representation and white, if it has a bound.
    bounded: Option<(usize, [f64; 3])>,
    /// For each product, the sum of rows.
    sums: Vec<(Monomial, Vec<f64>)>,
    used: usize,
}

impl<'c, R> WithGathered<'c, R> {
    /// A resolver with rows of a representation whose colours `colour` makes, and which has so many intervals if it has a bound, relative to a white's
    /// tristimulus values.
    pub const fn new(inner: R, colour: &'c RowColour<'c>, bounded: Option<(usize, [f64; 3])>) -> Self {
        Self { inner, colour, bounded, sums: Vec::new(), used: 0 }
    }

    fn add(&mut self, monomial: Monomial, weight: f64, row: &[f64]) {
        let used = &mut self.sums[..self.used];
        if let Some((_, sum)) = used.iter_mut().find(|(known, _)| *known == monomial) {
            sum.iter_mut().zip(row).for_each(|(s, r)| *s += weight * r);
            return;
        }
        if self.used == self.sums.len() {
            self.sums.push((monomial, Vec::new()));
        }
        if let Some((own, sum)) = self.sums.get_mut(self.used) {
            *own = monomial;
            sum.clear();
            sum.extend(row.iter().map(|r| weight * r));
        }
        self.used += 1;
    }

    /// Adds up the rows that a radiance refers to.
    fn collect(&mut self, radiance: &Radiance, tracer: &mut dyn Tracer) {
        self.used = 0;
        for (gathered, monomial, weight) in radiance.gathered() {
            self.add(*monomial, *weight, tracer.row(*gathered));
        }
    }

    /// The colour of the collected rows, seen through some more factors.
    fn collected(&mut self, through: &[u32], weight: f64, tracer: &dyn Tracer) -> [[f64; 3]; 2]
    where
        R: Resolver,
    {
        let (mut value, mut radius) = ([0.0; 3], [0.0; 3]);
        let mut leaves = Vec::new();
        for (monomial, sum) in &self.sums[..self.used] {
            leaves.clear();
            leaves.extend_from_slice(through);
            leaves.extend_from_slice(tracer.monomials().leaves(*monomial));
            let [v, r] = (self.colour)(&leaves, sum);
            self.inner.add_gathered(&leaves, sum, weight);
            value = core::array::from_fn(|a| value[a] + v[a]);
            radius = core::array::from_fn(|a| radius[a] + r[a]);
        }
        [value, radius]
    }
}

impl<R: Resolver> Resolver for WithGathered<'_, R> {
    fn tolerance(&self) -> f64 {
        self.inner.tolerance()
    }

    fn resolve(&mut self, radiance: &Radiance, tracer: &mut dyn Tracer) -> Colour {
        let mut colour = self.inner.resolve(radiance, tracer);
        self.collect(radiance, tracer);
        let [mut value, mut radius] = self.collected(&[], 1.0, tracer);
        for (deferred, through, weight) in radiance.deferred() {
            let traced = tracer.trace_gathered(*deferred);
            self.collect(&traced, tracer);
            let through = tracer.monomials().leaves(*through).to_vec();
            let [v, r] = self.collected(&through, *weight, tracer);
            value = core::array::from_fn(|a| value[a] + weight * v[a]);
            radius = core::array::from_fn(|a| radius[a] + weight * r[a]);
        }
        // One rounding for each sum.
        colour.xyz = core::array::from_fn(|a| colour.xyz[a] + value[a]);
        let rounding = |a: usize| 4.0 * f64::EPSILON * (colour.xyz[a].abs() + radius[a]);
        colour.radius = core::array::from_fn(|a| colour.radius[a] + radius[a] + rounding(a));
        if let Some((intervals, white)) = self.bounded {
            colour.intervals += intervals;
            let [xyz, radius] = [colour.xyz, colour.radius].map(|v| v.map(|v| v * Y_INTEGRAL));
            colour.delta_e = delta_e_bound(xyz, radius, white.map(|w| w * Y_INTEGRAL)).delta_e;
        }
        colour
    }

    fn spectrum(&self) -> &[f64] {
        self.inner.spectrum()
    }
}
