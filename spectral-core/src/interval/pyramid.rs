//! A spectrum on all parts of the visible domain, down to a depth.

use super::{BuildError, Domain, Interval, Node, Weight, node_count, nodes};
use crate::Real;
use crate::integrate::{MAX_FACTORS, ProductIntegrals, Sum, for_each_piece, product_integrals};
use crate::spectrum::Spectrum;

/// The rounding of an exactly integrated ∫Sā in units of ε ∫|S|ā: interpolation at the ends of a piece (4), the
/// piece's own formula (6), tables rounded to the type (2) and the compensated sums (2), with some to spare.
const LEAF_ROUNDING: f64 = 24.0;

/// The [`Interval`] of a spectrum on every part of the visible domain down to a depth, each integrated exactly on its own.
#[derive(Clone, Copy, Debug)]
pub struct Pyramid<'a, R> {
    nodes: &'a [Interval<R>],
    depth: u8,
}

impl<'a, R: Real> Pyramid<'a, R> {
    /// Integrates a spectrum over all parts into the caller's buffer of at least [`node_count`]`(domain.depth())` entries.
    ///
    /// # Errors
    /// [`BuildError::BufferTooSmall`], and [`BuildError::NotFinite`] when the spectrum or an integral of it is not finite.
    pub fn build<S: Spectrum<R> + ?Sized>(
        spectrum: &S,
        domain: &Domain<'_, R>,
        buffer: &'a mut [Interval<R>],
    ) -> Result<Self, BuildError> {
        let needed = node_count(domain.depth());
        let entries = buffer.get_mut(..needed).ok_or(BuildError::BufferTooSmall { needed })?;
        for (node, entry) in nodes(domain.depth()).zip(entries.iter_mut()) {
            *entry = Interval::of_spectrum(spectrum, domain, node);
            let sums = [entry.mean, entry.low, entry.high].into_iter().chain(entry.error).chain(entry.norm);
            if !sums.chain(entry.radius).all(R::is_finite) {
                return Err(BuildError::NotFinite);
            }
        }
        Ok(Self { nodes: entries, depth: domain.depth() })
    }

    /// The spectrum on a part of the domain; `None` below the depth.
    #[must_use]
    #[inline]
    pub fn get(&self, node: Node) -> Option<&'a Interval<R>> {
        self.nodes.get(node.position())
    }

    /// The deepest level.
    #[must_use]
    pub const fn depth(&self) -> u8 {
        self.depth
    }
}

impl<R: Real> Interval<R> {
    /// A spectrum on one part of the domain, integrated exactly.
    ///
    /// Where the spectrum is not finite, so are some of the fields.
    pub fn of_spectrum<S: Spectrum<R> + ?Sized>(spectrum: &S, domain: &Domain<'_, R>, node: Node) -> Self {
        let weight = domain.weight(node);
        let [from, to] = node.limits();
        let mut values = [Sum::<R>::default(); 3];
        let mut sizes = [Sum::<R>::default(); 3];
        let (mut low, mut high) = (R::INFINITY, -R::INFINITY);
        for_each_piece(domain.observer(), spectrum, from, to, |piece| {
            for a in 0..3 {
                values[a].add(piece.integral(a));
                sizes[a].add(piece.magnitude(a));
            }
            low = low.min(piece.value[0]).min(piece.value[1]);
            high = high.max(piece.value[0]).max(piece.value[1]);
        });
        let values = values.map(Sum::value);
        let rounding = R::from_f64(LEAF_ROUNDING) * R::EPSILON;
        let mean = mean(&values, &weight);
        let size = low.abs().max(high.abs());
        let (norm, absolute) = spread(spectrum, domain, node, &values, size);
        Self {
            mean,
            error: core::array::from_fn(|a| values[a] - mean * weight.integral[a]),
            norm: core::array::from_fn(|a| {
                norm[a] * (R::ONE + rounding) + (rounding * size * weight.root[a] + R::MIN_POSITIVE)
            }),
            absolute: core::array::from_fn(|a| {
                absolute[a] * (R::ONE + rounding) + (rounding * size * weight.integral[a] + R::MIN_POSITIVE)
            }),
            low: low - (rounding * size + R::MIN_POSITIVE),
            high: high + (rounding * size + R::MIN_POSITIVE),
            radius: sizes.map(|s| rounding * s.value()),
        }
        // In a channel that sees little of S, m I_a and e_a are far greater than their sum.
        .with_rounding(&weight)
    }
}

impl<R: Real> Interval<R> {
    /// A product of spectra on one part of the domain, integrated exactly instead of estimated from its factors: the radius is
    /// that of rounding alone.
    ///
    /// `estimate` is the product by the operators, which bounds the spread. Up to eight factors; with more, the
    /// estimate is returned as it is. Takes some 20 ns for each factor and nanometre on a desktop
    /// machine: worth it where the operators' radius is too large and the part can't be split.
    pub fn of_product(factors: &[&dyn Spectrum<R>], domain: &Domain<'_, R>, node: Node, estimate: &Self) -> Self {
        if factors.len() > MAX_FACTORS {
            return *estimate;
        }
        let weight = domain.weight(node);
        let [from, to] = node.limits();
        let ProductIntegrals { values, sizes, growth } = product_integrals(domain.observer(), factors, from, to);
        let rounding = R::from_f64(LEAF_ROUNDING) * R::EPSILON * R::from_usize(factors.len() + 1);
        let mean = mean(&values, &weight);
        Self {
            mean,
            error: core::array::from_fn(|a| values[a] - mean * weight.integral[a]),
            radius: core::array::from_fn(|a| rounding * sizes[a] + R::MIN_POSITIVE * growth * weight.integral[a]),
            ..*estimate
        }
        .with_rounding(&weight)
    }
}

/// Iehl–Péroche eq. 1; 0 where the observer sees nothing.
fn mean<R: Real>(values: &[R; 3], weight: &Weight<R>) -> R {
    let mut above = R::ZERO;
    let mut below = R::ZERO;
    for (value, i) in values.iter().zip(weight.integral) {
        above += *value * i;
        below += i * i;
    }
    if below > R::ZERO { above / below } else { R::ZERO }
}

/// The norms and absolute deviations about the channels' means, of a spectrum with values up to `size`.
fn spread<R: Real, S: Spectrum<R> + ?Sized>(
    spectrum: &S,
    domain: &Domain<'_, R>,
    node: Node,
    values: &[R; 3],
    size: R,
) -> ([R; 3], [R; 3]) {
    let unit = size.max(R::MIN_POSITIVE);
    let weight = domain.weight(node);
    let [from, to] = node.limits();
    let centre: [R; 3] = core::array::from_fn(|a| values[a] * weight.inverse[a]);
    let mut squares = [Sum::<R>::default(); 3];
    let mut absolutes = [Sum::<R>::default(); 3];
    for_each_piece(domain.observer(), spectrum, from, to, |piece| {
        for a in 0..3 {
            squares[a].add(piece.square(a, centre[a], unit));
            absolutes[a].add(piece.absolute(a, centre[a]));
        }
    });
    (squares.map(|s| s.value().max(R::ZERO).sqrt() * unit), absolutes.map(|s| s.value().max(R::ZERO)))
}
