//! Integrals of reflectances over a part of the domain, in the light of a lamp as an observer sees it.

use spectral_core::Observer;
use spectral_core::interval::Node;
use spectral_core::spectrum::{PiecewiseLinear, Segment, Spectrum};

use super::cell::around;
use crate::spectral::Role;

/// The colour-matching functions are linear between multiples of this, in nm.
const STEP: f64 = 1.0;
/// Abscissae in [0, 1], their distances from 1, and weights of Gauss–Legendre quadrature with three points: exact to degree 5, which is more than
/// the product of a lamp, a colour-matching function and two reflectances has on a piece where all are linear.
const GAUSS: [[f64; 3]; 3] = [
    [0.112_701_665_379_258_31, 0.887_298_334_620_741_7, 0.277_777_777_777_777_8],
    [0.5, 0.5, 0.444_444_444_444_444_4],
    [0.887_298_334_620_741_7, 0.112_701_665_379_258_31, 0.277_777_777_777_777_8],
];

/// Spectra with what they are used for.
pub(super) type Leaf<'p> = (PiecewiseLinear<'p, f64>, Role);

/// The integrals of a lamp's spectrum, with the colour-matching functions, over a part of the domain.
#[derive(Clone, Debug)]
pub(super) struct Moments {
    pub(super) mass: [f64; 3],
    /// The integrals with wavelength, from −1 to 1 over all of the domain, and with its square.
    pub(super) lines: [[f64; 3]; 2],
    pub(super) leaves: Vec<LeafMoments>,
}

/// The integrals with a reflectance, with its square and with its product with wavelength; its least and greatest value. No integrals of lights.
#[derive(Clone, Copy, Debug)]
pub(super) struct LeafMoments {
    pub(super) firsts: [f64; 3],
    pub(super) seconds: [f64; 3],
    pub(super) sloped: [f64; 3],
    pub(super) range: [f64; 2],
}

fn sum(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    core::array::from_fn(|i| a[i] + b[i])
}

/// A sum with what rounding has lost of it (Knuth's two-sum).
#[derive(Clone, Copy, Debug, Default)]
struct Total {
    sum: f64,
    lost: f64,
}

impl Total {
    fn add(&mut self, term: f64) {
        let sum = self.sum + term;
        let back = sum - self.sum;
        self.lost += (self.sum - (sum - back)) + (term - back);
        self.sum = sum;
    }
}

/// Three channels' sums of up to three kinds.
type Totals = [[Total; 3]; 3];

/// Adds the first terms to the first totals.
fn add(totals: &mut [[Total; 3]], terms: [[f64; 3]; 3]) {
    let all = totals.as_flattened_mut().iter_mut().zip(terms.as_flattened());
    all.for_each(|(total, term)| total.add(*term));
}

fn values(totals: &Totals) -> [[f64; 3]; 3] {
    totals.map(|three| three.map(|total| total.sum + total.lost))
}

/// A spectrum along which one goes, piece by piece: what it is linear on is looked up once.
struct Along<'s, 'p> {
    spectrum: &'s PiecewiseLinear<'p, f64>,
    /// From where on it is this segment.
    start: f64,
    segment: Segment<f64>,
    /// The value here.
    value: f64,
}

impl<'s, 'p> Along<'s, 'p> {
    fn new(spectrum: &'s PiecewiseLinear<'p, f64>, start: f64) -> Self {
        let segment = spectrum.segment(start);
        Self { spectrum, start, value: segment.first, segment }
    }

    /// Goes on to a place in this segment: the values before and there.
    fn go(&mut self, to: f64) -> [f64; 2] {
        let from = self.value;
        self.value = value_of(&self.segment, self.start, to);
        let values = [from, self.value];
        if to >= self.segment.end {
            *self = Self::new(self.spectrum, to);
        }
        values
    }
}

impl Moments {
    /// All integrals over a node, exact but for rounding: of a lamp, or of an even light. Those with squares, and with wavelength, are left out
    /// where only first moments are asked for.
    pub(super) fn new(
        observer: &Observer<'_, f64>,
        lamp: Option<&PiecewiseLinear<'_, f64>>,
        leaves: &[Leaf<'_>],
        node: Node,
        only_firsts: bool,
    ) -> Self {
        let kinds = if only_firsts { 1 } else { 3 };
        let ([first, last], [from, to]) = (Node::ROOT.limits::<f64>(), node.limits::<f64>());
        let line = |wavelength: f64| (2.0 * wavelength - first - last) / (last - first);
        let mut of_lamp = Totals::default();
        let nothing = |role: Role| if role == Role::Light { [0.0; 2] } else { [f64::INFINITY, f64::NEG_INFINITY] };
        let mut of_leaves: Vec<(Totals, [f64; 2])> =
            leaves.iter().map(|(_, role)| (Totals::default(), nothing(*role))).collect();
        let mut light = lamp.map(|lamp| Along::new(lamp, from));
        let mut reflectances: Vec<Option<Along<'_, '_>>> =
            leaves.iter().map(|(leaf, role)| (*role != Role::Light).then(|| Along::new(leaf, from))).collect();
        let (mut position, mut before) = (from, observer.value(from));
        while position < to {
            let next = (position / STEP).floor() * STEP + STEP;
            let ends = light.iter().chain(reflectances.iter().flatten()).map(|along| along.segment.end);
            let end = ends.fold(to.min(next), f64::min);
            let after = observer.value(end);
            let points = weighted(end - position, light.as_mut().map(|light| light.go(end)), [before, after]);
            let lines = [line(position), line(end)];
            let within = |[first, last]: [f64; 2], point: usize| first * GAUSS[point][1] + last * GAUSS[point][0];
            let products = |of: &dyn Fn(usize) -> [f64; 3]| {
                let mut terms = [[0.0; 3]; 3];
                for (point, weights) in points.iter().enumerate() {
                    for (terms, value) in terms.iter_mut().zip(of(point)).take(kinds) {
                        terms.iter_mut().zip(weights).for_each(|(t, w)| *t += w * value);
                    }
                }
                terms
            };
            let at = |point: usize| within(lines, point);
            add(&mut of_lamp[..kinds], products(&|point| [1.0, at(point), at(point) * at(point)]));
            for ((totals, [low, high]), along) in of_leaves.iter_mut().zip(&mut reflectances) {
                if let Some(along) = along {
                    let ends = along.go(end);
                    (*low, *high) = (low.min(ends[0]).min(ends[1]), high.max(ends[0]).max(ends[1]));
                    let value = |point: usize| within(ends, point);
                    add(
                        &mut totals[..kinds],
                        products(&|point| [value(point), value(point) * value(point), value(point) * at(point)]),
                    );
                }
            }
            (position, before) = (end, after);
        }
        let [mass, lines @ ..] = values(&of_lamp);
        let leaf = |(totals, range): &(Totals, [f64; 2])| {
            let [firsts, seconds, sloped] = values(totals);
            LeafMoments { firsts, seconds, sloped, range: around(*range) }
        };
        Self { mass, lines, leaves: of_leaves.iter().map(leaf).collect() }
    }

    /// The same over two parts.
    pub(super) fn over_both(&self, other: &Self) -> Self {
        let both = |(a, b): (&LeafMoments, &LeafMoments)| LeafMoments {
            firsts: sum(a.firsts, b.firsts),
            seconds: sum(a.seconds, b.seconds),
            sloped: sum(a.sloped, b.sloped),
            range: [a.range[0].min(b.range[0]), a.range[1].max(b.range[1])],
        };
        let leaves = self.leaves.iter().zip(&other.leaves).map(both).collect();
        let lines = core::array::from_fn(|power| sum(self.lines[power], other.lines[power]));
        Self { mass: sum(self.mass, other.mass), lines, leaves }
    }
}

/// The weights of three points on a piece of some width in each channel, with the light at its ends.
fn weighted(width: f64, light: Option<[f64; 2]>, seen: [[f64; 3]; 2]) -> [[f64; 3]; 3] {
    let ends = light.unwrap_or([1.0; 2]);
    GAUSS.map(|[below, above, weight]| {
        let part = width * weight * (ends[0] * above + ends[1] * below);
        core::array::from_fn(|a| part * (seen[0][a] * above + seen[1][a] * below))
    })
}

/// The value of a linear piece that starts at `start`, at a place in it.
fn value_of(segment: &Segment<f64>, start: f64, place: f64) -> f64 {
    if !segment.end.is_finite() {
        return segment.first;
    }
    let (before, after) = (place - start, segment.end - place);
    (segment.first * after + segment.last * before) / (before + after)
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "tests fail by panicking")]
mod tests {
    use spectral_core::Observer;
    use spectral_core::interval::{Domain, Interval, Node, Weight};
    use spectral_core::spectrum::{Outside, PiecewiseLinear, Spectrum};

    use super::{Moments, STEP};
    use crate::spectral::Role;

    /// Against products of any number of factors, at nodes of all sizes: a lamp with a narrow line and a step, reflectances with nodes between
    /// those of the observer.
    #[test]
    fn moments_are_integrals_of_products() {
        let spectrum = |wavelengths: &'static [f64], values: &'static [f64]| {
            PiecewiseLinear::new(wavelengths, values, Outside::Zero).unwrap()
        };
        let lamp = spectrum(&[380.0, 435.8, 435.81, 435.82, 600.0, 700.25], &[1.0, 2.0, 900.0, 2.0, 0.5, 3.0]);
        let leaves = [
            (spectrum(&[380.0, 435.805, 500.3, 780.0], &[0.1, 0.7, 0.2, 0.9]), Role::Reflectance),
            (spectrum(&[400.0, 700.0], &[0.5, 0.6]), Role::Reflectance),
        ];
        let line = PiecewiseLinear::new(&[380.0, 780.0], &[-1.0, 1.0], Outside::Hold).unwrap();
        let (observer, mut weights) = (Observer::cie_1931_2deg(), [Weight::default(); 1]);
        let domain = Domain::build(Observer::cie_1931_2deg(), 0, &mut weights).unwrap();
        let mut node = Node::ROOT;
        for right in [false, true, false, false, true, false, true, true, false] {
            let found = Moments::new(&observer, Some(&lamp), &leaves, node, false);
            let firsts = Moments::new(&observer, Some(&lamp), &leaves, node, true);
            let close = |found: [f64; 3], factors: &[&dyn Spectrum<f64>]| {
                let integral = |factors: &[&dyn Spectrum<f64>]| {
                    let product = Interval::of_product(factors, &domain, node, &Interval::zero());
                    product.tristimulus(&domain.weight(node))
                };
                let (truth, size) = (integral(factors), integral(&[&lamp]));
                for a in 0..3 {
                    let off = (found[a] - truth[a]).abs();
                    assert!(off <= 1e-13 * size[a].max(size[1]), "{node:?}: {found:?} {truth:?}");
                }
            };
            close(found.mass, &[&lamp]);
            close(found.lines[0], &[&lamp, &line]);
            close(found.lines[1], &[&lamp, &line, &line]);
            for ((leaf, _), moments) in leaves.iter().zip(&found.leaves) {
                close(moments.firsts, &[&lamp, leaf]);
                close(moments.seconds, &[&lamp, leaf, leaf]);
                close(moments.sloped, &[&lamp, leaf, &line]);
                let [low, high] = crate::radiosity::cell::range(leaf, node);
                assert!((moments.range[0] - low).abs() <= 1e-15 && (moments.range[1] - high).abs() <= 1e-15);
            }
            assert_eq!(found.mass, firsts.mass);
            for (moments, alone) in found.leaves.iter().zip(&firsts.leaves) {
                assert_eq!((moments.firsts, moments.range), (alone.firsts, alone.range));
            }
            node = node.children().unwrap()[usize::from(right)];
        }
    }

    /// The observer is linear between multiples of the step, to which its table must agree.
    #[test]
    fn the_observer_is_linear_between_steps() {
        let observer = Observer::<f64>::cie_1931_2deg();
        for index in 0..400 {
            let from = 380.0 + STEP * f64::from(index);
            let [a, b, c] = [0.0, 0.5, 1.0].map(|part| observer.value(from + STEP * part));
            assert!((0..3).all(|i| (2.0 * b[i] - a[i] - c[i]).abs() <= 1e-15), "{from}");
        }
    }
}
