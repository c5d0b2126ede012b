//! Products that are integrated exactly on an interval, against dense integration: the radius is that of rounding alone.
#![allow(clippy::unwrap_used, reason = "a test stops at the first thing that should not be")]

use spectral_core::expression::Op;
use spectral_core::interval::{Domain, Interval, Node, Weight, node_count};
use spectral_core::spectrum::{Outside, PiecewiseLinear};
use spectral_core::{Observer, Real, Spectrum};
use spectral_tests::dense::{Beyond, Dense, Polyline, cie_1931};
use spectral_tests::generators::Draw;

const DEPTH: u8 = 10;

/// A random spectrum's nodes: a spike as narrow as 2⁻¹⁰ nm somewhere about the part [from, to], on a smooth curve, in any unit.
fn nodes<R: Real>(draw: &mut Draw<'_>, [from, to]: [f64; 2], unit: f64) -> (Vec<R>, Vec<R>) {
    let width = draw.magnitude(1e-3, 20.0);
    let place = draw.between(from - width, to + width);
    let mut wavelengths: Vec<R> = [370.0, place, place + width, place + 2.0 * width, 790.0].map(R::from_f64).to_vec();
    wavelengths.sort_by(|a, b| a.to_f64().total_cmp(&b.to_f64()));
    wavelengths.dedup();
    let values = wavelengths.iter().map(|_| R::from_f64(unit * draw.unit())).collect();
    (wavelengths, values)
}

/// Checks products of one to eight factors on random parts; returns the greatest radius relative to the integral.
fn products_are_exact<R: Real>(seed: u64, cases: u32) -> f64 {
    let observer = cie_1931().unwrap();
    let mut weights = vec![Weight::default(); node_count(DEPTH)];
    let domain = Domain::build(Observer::cie_1931_2deg(), DEPTH, &mut weights).unwrap();
    let mut draw = Draw::new(seed);
    let mut loosest = 0.0_f64;
    for case in 0..cases {
        let level = draw.index(0..usize::from(DEPTH) + 1);
        let index = u16::try_from(draw.index(0..1 << level)).unwrap();
        let node = Node::new(u8::try_from(level).unwrap(), index).unwrap();
        let count = draw.index(1..9);
        // Units whose product is moderate in the end, but maybe not on the way.
        let extreme = if draw.once_in(4) { draw.magnitude(1e-25, 1e25) } else { 1.0 };
        let unit = |k: usize| if k.is_multiple_of(2) { extreme } else { 1.0 / extreme };
        let columns: Vec<_> = (0..count).map(|k| nodes::<R>(&mut draw, node.limits(), unit(k))).collect();
        let spectra: Vec<_> = columns.iter().map(|(w, v)| PiecewiseLinear::new(w, v, Outside::Zero).unwrap()).collect();
        let factors: Vec<&dyn Spectrum<R>> = spectra.iter().map(|s| s as &dyn Spectrum<R>).collect();
        let found = Interval::of_product(&factors, &domain, node, &Interval::zero());

        let exact = |(w, v): &(Vec<R>, Vec<R>)| {
            let nodes: Vec<_> = w.iter().zip(v).map(|(w, v)| (w.to_f64(), v.to_f64())).collect();
            Polyline::new(&nodes, Beyond::Zero)
        };
        let truths: Vec<_> = columns.iter().map(exact).collect();
        let mut ops = vec![Op::<R>::Leaf(0)];
        for k in 1..count {
            ops.extend([Op::Leaf(u32::try_from(k).unwrap()), Op::Product]);
        }
        let truth = Dense::new(&observer, &truths.iter().collect::<Vec<_>>(), node.limits(), 5).integrate(&ops);
        let xyz = found.tristimulus(&domain.weight(node)).map(R::to_f64);
        for (a, xyz) in xyz.into_iter().enumerate() {
            let (off, radius) = ((xyz - truth.xyz[a]).abs(), found.radius[a].to_f64());
            assert!(off <= radius + truth.error[a], "case {case}: {off:e} > {radius:e}: {columns:?}, {node:?}");
            let size = truth.xyz.into_iter().fold(0.0, f64::max);
            if extreme == 1.0 && size > 0.0 {
                loosest = loosest.max(radius / size);
            }
        }
    }
    loosest
}

#[test]
fn products_of_up_to_eight_factors_are_exact() {
    // 24 ε for each of nine factors, and as much again where a channel sees much more of one interval than another.
    assert!(products_are_exact::<f32>(1, 4_000) <= 432.0 * f64::from(f32::EPSILON));
    assert!(products_are_exact::<f64>(2, 4_000) <= 432.0 * f64::EPSILON);
}
