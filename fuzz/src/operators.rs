//! Interval operators on spectra of any shape, against integrals by Gauss's rule.

use std::sync::OnceLock;

use spectral_core::interval::{Domain, Interval, MAX_DEPTH, Node, Weight, node_count, nodes};
use spectral_core::spectrum::{Outside, PiecewiseLinear};
use spectral_core::{Observer, Real};

use crate::numbers::Numbers;

/// Parts of 25 nm.
const DEPTH: u8 = 4;
/// Gauss–Legendre with three nodes is exact to degree 5: four linear factors and a colour-matching function.
const NODES: [(f64, f64); 3] =
    [(0.0, 8.0 / 9.0), (-0.774_596_669_241_483_4, 5.0 / 9.0), (0.774_596_669_241_483_4, 5.0 / 9.0)];

/// Applies operators to two spectra made of the bytes, on one part of the visible domain: the exact integrals must be within the
/// radius, and the range must hold all values.
pub fn operators(bytes: &[u8]) {
    static DOUBLE: OnceLock<Domain<'static, f64>> = OnceLock::new();
    static SINGLE: OnceLock<Domain<'static, f32>> = OnceLock::new();
    check(DOUBLE.get_or_init(domain), &mut Numbers::new(bytes), 1e100);
    check(SINGLE.get_or_init(domain), &mut Numbers::new(bytes), 1e9);
}

/// The memory is never given back.
fn domain<R: Real>() -> Domain<'static, R> {
    const { assert!(DEPTH <= MAX_DEPTH) }
    let weights = vec![Weight::default(); node_count(DEPTH)].leak();
    Domain::build(Observer::cie_1931_2deg(), DEPTH, weights).expect("a domain")
}

/// An exact function of wavelength at a point, with all terms taken by magnitude beside it.
type Exact<'a> = Box<dyn Fn(f64) -> (f64, f64) + 'a>;

fn check<R: Real>(domain: &Domain<'static, R>, numbers: &mut Numbers, range: f64) {
    let node = nodes(DEPTH).nth(numbers.below(node_count(DEPTH))).expect("a node");
    let weight = domain.weight(node);
    let (first, second) = (Table::decode(numbers), Table::decode(numbers));
    let operands = [first.interval(domain, node), second.interval(domain, node)];
    let edges: Vec<f64> = first.wavelengths.iter().chain(&second.wavelengths).map(|w| w.to_f64()).collect();

    let (mut result, mut exact) = (operands[0], first.exact());
    let mut degree = 1;
    for step in 0..4 {
        if step > 0 && numbers.is_empty() {
            break;
        }
        let before = exact;
        match numbers.byte() % 5 {
            0 => {
                result = result.sum(&operands[1], &weight);
                let other = second.exact();
                exact = Box::new(move |w| {
                    let ((a, am), (b, bm)) = (before(w), other(w));
                    (a + b, am + bm)
                });
            }
            1 => {
                let factor: R = numbers.within(1e6);
                result = result.scale(factor, &weight);
                let factor = factor.to_f64();
                exact = Box::new(move |w| {
                    let (a, am) = before(w);
                    (a * factor, am * factor.abs())
                });
            }
            2 => {
                let fresnel: R = numbers.unit();
                result = result.schlick(fresnel, &weight);
                let f = fresnel.to_f64();
                exact = Box::new(move |w| {
                    let (a, am) = before(w);
                    (a * (1.0 - f) + f, am * (1.0 - f) + f)
                });
            }
            _ if degree < 4 => {
                degree += 1;
                result = result.product(&operands[1], &weight);
                let other = second.exact();
                exact = Box::new(move |w| {
                    let ((a, am), (b, bm)) = (before(w), other(w));
                    (a * b, am * bm)
                });
            }
            _ => exact = before,
        }
        judge(&result, &weight, &truth(domain, node, &edges, &*exact), range);
    }
}

/// A spectrum of a few nodes, somewhere about the visible domain.
struct Table<R> {
    wavelengths: Vec<R>,
    values: Vec<R>,
}

impl<R: Real> Table<R> {
    fn decode(numbers: &mut Numbers) -> Self {
        let count = 2 + numbers.below(6);
        let mut wavelength = 340.0 + f64::from(numbers.byte());
        let (mut wavelengths, mut values) = (Vec::new(), Vec::new());
        // One sign: a spectrum that changes it between nodes is outside of what the bounds promise.
        let scale: R = numbers.positive(3);
        for _ in 0..count {
            wavelengths.push(R::from_f64(wavelength));
            values.push(scale * numbers.within::<R>(1e3).abs());
            wavelength += 0.25 * (1.0 + f64::from(numbers.byte()));
        }
        Self { wavelengths, values }
    }

    fn spectrum(&self) -> PiecewiseLinear<'_, R> {
        PiecewiseLinear::new(&self.wavelengths, &self.values, Outside::Hold).expect("a spectrum")
    }

    fn interval(&self, domain: &Domain<'_, R>, node: Node) -> Interval<R> {
        Interval::of_spectrum(&self.spectrum(), domain, node)
    }

    /// The same function in `f64`.
    fn exact(&self) -> Exact<'static> {
        let wavelengths: Vec<f64> = self.wavelengths.iter().map(|w| w.to_f64()).collect();
        let values: Vec<f64> = self.values.iter().map(|v| v.to_f64()).collect();
        Box::new(move |w| {
            let after = wavelengths.partition_point(|x| *x <= w);
            let value = match (after.checked_sub(1), wavelengths.get(after)) {
                (None, _) => values[0],
                (Some(before), None) => values[before],
                (Some(before), Some(end)) => {
                    let t = (w - wavelengths[before]) / (end - wavelengths[before]);
                    values[before] * (1.0 - t) + values[after] * t
                }
            };
            (value, value.abs())
        })
    }
}

struct Truth {
    xyz: [f64; 3],
    /// How far rounding may have put them off.
    rounding: [f64; 3],
    range: [f64; 2],
    magnitude: f64,
}

/// The integrals between all places where something bends.
fn truth<R: Real>(domain: &Domain<'_, R>, node: Node, edges: &[f64], exact: &dyn Fn(f64) -> (f64, f64)) -> Truth {
    let [from, to] = node.limits::<f64>();
    let first = from.ceil() as u32;
    let mut cuts: Vec<f64> = (first..=to as u32).map(f64::from).collect();
    cuts.extend(edges.iter().copied().filter(|e| *e > from && *e < to));
    cuts.extend([from, to]);
    cuts.sort_by(f64::total_cmp);
    let observer = domain.observer();
    let mut truth =
        Truth { xyz: [0.0; 3], rounding: [0.0; 3], range: [f64::INFINITY, f64::NEG_INFINITY], magnitude: 0.0 };
    for pair in cuts.windows(2).filter(|pair| pair[0] < pair[1]) {
        let (middle, half) = ((pair[0] + pair[1]) / 2.0, (pair[1] - pair[0]) / 2.0);
        // Linear between whole nanometres, from the values there.
        let ends = [middle.floor(), middle.floor() + 1.0];
        let [low, high] = ends.map(|end| observer.value(R::from_f64(end)).map(R::to_f64));
        for (place, share) in NODES {
            let w = middle + half * place;
            let (value, majorant) = exact(w);
            let t = w - ends[0];
            for a in 0..3 {
                let sensitivity = share * half * (low[a] * (1.0 - t) + high[a] * t);
                truth.xyz[a] += sensitivity * value;
                truth.rounding[a] += sensitivity * majorant;
            }
            truth.range = [truth.range[0].min(value), truth.range[1].max(value)];
            truth.magnitude = truth.magnitude.max(majorant);
        }
    }
    truth.rounding = truth.rounding.map(|r| 1e4 * f64::EPSILON * r + 1e-290);
    truth
}

fn judge<R: Real>(result: &Interval<R>, weight: &Weight<R>, truth: &Truth, range: f64) {
    let found = result.tristimulus(weight).map(R::to_f64);
    for (a, found) in found.into_iter().enumerate() {
        let (error, radius) = ((found - truth.xyz[a]).abs(), result.radius[a].to_f64());
        // Out of range, radii are infinite or NaN, never too small.
        assert!(!(error > radius + truth.rounding[a]), "channel {a}: {error} off with radius {radius}: {result:?}");
        if truth.magnitude <= range {
            assert!(found.is_finite() && radius.is_finite() && radius >= 0.0, "{result:?}");
            assert!(result.norm[a] >= R::ZERO && result.absolute[a] >= R::ZERO, "{result:?}");
        }
    }
    let slack = 1e4 * f64::EPSILON * truth.magnitude + 1e-290;
    let ends = [result.low.to_f64(), result.high.to_f64()];
    assert!(!(ends[0] > truth.range[0] + slack) && !(ends[1] < truth.range[1] - slack), "{ends:?}, {:?}", truth.range);
}
