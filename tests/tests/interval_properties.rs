//! Intervals where rendering seldom takes them: spectra with values of both signs, and weights as inexact as they may be.
#![allow(clippy::unwrap_used, reason = "a test stops at the first thing that should not be")]

use spectral_core::expression::{Op, Order, Program};
use spectral_core::interval::{Domain, Interval, Node, Pyramid, Weight, node_count, nodes};
use spectral_core::spectrum::{Outside, PiecewiseLinear};
use spectral_core::{Observer, Real};
use spectral_tests::certify::shortfalls;
use spectral_tests::dense::{Beyond, Dense, Polyline, cie_1931};
use spectral_tests::generators::Draw;

const DEPTH: u8 = 6;
/// Leaves of a program.
const LEAVES: usize = 3;

fn with_domain<R: Real>(test: impl FnOnce(&Domain<'_, R>)) {
    let mut weights = vec![Weight::default(); node_count(DEPTH)];
    test(&Domain::build(Observer::cie_1931_2deg(), DEPTH, &mut weights).unwrap());
}

/// Spectra that are zero but for trapezoids at shared places, each of which is up or down; between them is a node at zero, so that none
/// changes its sign within a piece.
fn both_signs<R: Real>(draw: &mut Draw<'_>) -> (Vec<R>, Vec<Vec<R>>) {
    let count = draw.index(1..5);
    let room = 400.0 / f64::from(u32::try_from(count).unwrap());
    let mut wavelengths = vec![R::from_f64(370.0)];
    let mut values = vec![vec![R::ZERO]; LEAVES];
    for place in 0..count {
        let start = 380.0 + room * f64::from(u32::try_from(place).unwrap()) + draw.between(0.1, 0.5) * room;
        let (flank, top) = (draw.between(0.01, 0.1) * room, draw.between(0.02, 0.25) * room);
        wavelengths.extend([0.0, flank, flank + top, 2.0 * flank + top].map(|w| R::from_f64(start + w)));
        // Mostly of one sign in all spectra: what is squared has a mean far from the product of the means.
        let sign = draw.pick(&[-1.0, 1.0]).unwrap();
        for values in &mut values {
            let own = if draw.once_in(4) { -sign } else { sign };
            let height = R::from_f64(own * draw.between(0.8, 1.0));
            values.extend([R::ZERO, height, height, R::ZERO]);
        }
    }
    wavelengths.push(R::from_f64(790.0));
    values.iter_mut().for_each(|values| values.push(R::ZERO));
    (wavelengths, values)
}

/// What an interval keeps holds for spectra of both signs.
fn bounds_hold_for_both_signs<R: Real>(seed: u64, cases: u32) {
    use Op::{Leaf, Product, Scale, Schlick, Sum};
    let programs = [
        vec![Leaf(0), Leaf(1), Product],
        vec![Leaf(0), Leaf(0), Product],
        vec![Leaf(0), Leaf(1), Product, Leaf(2), Product],
        vec![Leaf(0), Leaf(1), Sum, Leaf(2), Product],
        vec![Leaf(0), Scale(R::from_f64(-0.7)), Leaf(1), Product],
        vec![Leaf(0), Schlick(R::from_f64(0.3)), Leaf(1), Product],
        vec![Leaf(0), Leaf(1), Product, Scale(R::from_f64(-1.3)), Leaf(2), Sum],
    ];
    let observer = cie_1931().unwrap();
    with_domain::<R>(|domain| {
        let mut draw = Draw::new(seed);
        for case in 0..cases {
            let (wavelengths, columns) = both_signs::<R>(&mut draw);
            let mut buffers = vec![vec![Interval::zero(); node_count(DEPTH)]; LEAVES];
            let mut pyramids = Vec::new();
            for (values, buffer) in columns.iter().zip(&mut buffers) {
                let spectrum = PiecewiseLinear::new(&wavelengths, values, Outside::Zero).unwrap();
                pyramids.push(Pyramid::build(&spectrum, domain, buffer).unwrap());
            }
            let exact = |values: &Vec<R>| {
                let nodes: Vec<_> = wavelengths.iter().zip(values).map(|(w, v)| (w.to_f64(), v.to_f64())).collect();
                Polyline::new(&nodes, Beyond::Zero)
            };
            let truths: Vec<_> = columns.iter().map(exact).collect();
            let level = draw.index(0..5);
            let index = u16::try_from(draw.index(0..1 << level)).unwrap();
            for node in [Node::ROOT, Node::new(u8::try_from(level).unwrap(), index).unwrap()] {
                let dense = Dense::new(&observer, &truths.iter().collect::<Vec<_>>(), node.limits(), LEAVES + 1);
                let weight = domain.weight(node);
                for ops in &programs {
                    let program = Program::new(ops).unwrap();
                    let mut stack = [Interval::zero(); 3];
                    let found = program
                        .evaluate(node, &weight, Order::Certified, &mut pyramids.as_slice(), &mut stack)
                        .unwrap();
                    let failed = shortfalls(&found, &weight, &dense.moments(ops));
                    assert!(failed.is_empty(), "case {case}, {node:?}, {ops:?}: {failed:?} of {found:?}: {columns:?}");
                }
            }
        }
    });
}

#[test]
fn spreads_and_radii_hold_for_values_of_both_signs() {
    bounds_hold_for_both_signs::<f32>(1, 300);
    bounds_hold_for_both_signs::<f64>(2, 300);
}

/// The integrals of a weight may be 8 ε off, as its documentation says, and what is the same everywhere is as inexact as they are.
fn constants_allow_for_inexact_weights<R: Real>() {
    with_domain::<R>(|domain| {
        for node in nodes(DEPTH) {
            let exact = domain.weight(node);
            for parts in [-7.0, 7.0] {
                let off = R::ONE + R::from_f64(parts) * R::EPSILON;
                let weight = Weight { integral: exact.integral.map(|i| i * off), ..exact };
                for value in [0.3, -0.3, 1.0, 40.0] {
                    let holds = |found: Interval<R>, value: R| {
                        for (a, xyz) in found.tristimulus(&weight).into_iter().enumerate() {
                            let error = (xyz.to_f64() - value.to_f64() * exact.integral[a].to_f64()).abs();
                            assert!(error <= found.radius[a].to_f64(), "{node:?}, {value}, channel {a}");
                            let most = 16.0 * R::EPSILON.to_f64() * xyz.to_f64().abs() + 4.0 * R::MIN_POSITIVE.to_f64();
                            assert!(found.radius[a].to_f64() <= most, "{node:?}, {value}, channel {a}");
                        }
                    };
                    let value = R::from_f64(value);
                    holds(Interval::constant(value, &weight), value);
                    if value >= R::ZERO && value <= R::ONE {
                        holds(Interval::zero().schlick(value, &weight), value);
                    }
                }
            }
        }
    });
}

#[test]
fn constants_are_as_inexact_as_weights_may_be() {
    constants_allow_for_inexact_weights::<f32>();
    constants_allow_for_inexact_weights::<f64>();
}
