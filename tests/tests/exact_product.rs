//! Products that are integrated exactly on one interval, against dense integration.
#![allow(clippy::unwrap_used, reason = "a test stops at the first thing that should not be")]

use spectral_core::expression::Op;
use spectral_core::interval::{Domain, Interval, Node, Weight, node_count};
use spectral_core::spectrum::{Outside, PiecewiseLinear};
use spectral_core::{Observer, Real, Spectrum};
use spectral_tests::dense::{Beyond, Dense, Polyline, cie_1931};
use spectral_tests::generators::Draw;

const DEPTH: u8 = 8;

/// Nodes at irregular distances, with spikes; from outside the domain to beyond it.
fn nodes<R: Real>(draw: &mut Draw<'_>) -> (Vec<R>, Vec<R>) {
    let mut wavelengths = vec![R::from_f64(draw.between(300.0, 390.0))];
    while let Some(last) = wavelengths.last().filter(|w| w.to_f64() < 790.0) {
        wavelengths.push(R::from_f64(last.to_f64() + draw.magnitude(0.01, 60.0)));
    }
    let values = wavelengths.iter().map(|_| R::from_f64(draw.magnitude(1e-3, 1.0))).collect();
    (wavelengths, values)
}

fn agrees_with_dense_integration<R: Real>(seed: u64) {
    let mut draw = Draw::new(seed);
    let mut weights = vec![Weight::default(); node_count(DEPTH)];
    let domain = Domain::<R>::build(Observer::cie_1931_2deg(), DEPTH, &mut weights).unwrap();
    let observer = cie_1931().unwrap();
    for _ in 0..300 {
        let count = draw.index(1..9);
        let drawn: Vec<_> = (0..count).map(|_| nodes::<R>(&mut draw)).collect();
        let spectra: Vec<_> = drawn.iter().map(|(w, v)| PiecewiseLinear::new(w, v, Outside::Hold).unwrap()).collect();
        let factors: Vec<&dyn Spectrum<R>> = spectra.iter().map(|s| s as &dyn Spectrum<R>).collect();
        let level = draw.index(0..9);
        let node = Node::new(u8::try_from(level).unwrap(), u16::try_from(draw.index(0..1 << level)).unwrap()).unwrap();
        let found = Interval::of_product(&factors, &domain, node, &Interval::zero());

        let truths: Vec<_> = drawn
            .iter()
            .map(|(w, v)| {
                let pairs: Vec<_> = w.iter().zip(v).map(|(w, v)| (w.to_f64(), v.to_f64())).collect();
                Polyline::new(&pairs, Beyond::Hold)
            })
            .collect();
        let lines: Vec<_> = truths.iter().collect();
        let dense = Dense::new(&observer, &lines, node.limits::<f64>(), 6);
        let mut ops = vec![Op::Leaf(0)];
        for leaf in 1..count {
            ops.extend([Op::Leaf(u32::try_from(leaf).unwrap()), Op::<R>::Product]);
        }
        let truth = dense.integrate(&ops);
        let xyz = found.tristimulus(&domain.weight(node));
        for a in 0..3 {
            let (radius, error) = (found.radius[a].to_f64(), truth.error[a]);
            let off = (xyz[a].to_f64() - truth.xyz[a]).abs();
            assert!(off <= radius + error, "{count} factors on {node:?}, channel {a}: {off} > {radius}");
            // The radius is that of rounding alone: the weight of one product, not an estimate of its spread.
            let size = truth.xyz.iter().sum::<f64>();
            assert!(radius <= 1e3 * R::EPSILON.to_f64() * size + 1e-30, "{radius} of {size}");
        }
    }
}

#[test]
fn products_are_exact_in_both_precisions() {
    agrees_with_dense_integration::<f64>(11);
    agrees_with_dense_integration::<f32>(12);
}

#[test]
fn more_factors_than_are_integrated_exactly_leave_the_estimate() {
    let mut weights = vec![Weight::default(); node_count(0)];
    let domain = Domain::<f64>::build(Observer::cie_1931_2deg(), 0, &mut weights).unwrap();
    let flat = PiecewiseLinear::new(&[300.0, 800.0], &[0.5, 0.5], Outside::Hold).unwrap();
    let factors = [&flat as &dyn Spectrum<f64>; 9];
    let estimate = Interval { mean: 0.25, ..Interval::zero() };
    assert_eq!(Interval::of_product(&factors, &domain, Node::ROOT, &estimate), estimate);
    let exact = Interval::of_product(&factors[..8], &domain, Node::ROOT, &estimate);
    assert!((exact.mean - 0.5_f64.powi(8)).abs() <= 16.0 * f64::EPSILON);
}
