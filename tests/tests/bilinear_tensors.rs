//! The tensors themselves: the printed one, and the estimation that reproduces it.
#![allow(clippy::unwrap_used, clippy::needless_range_loop, reason = "helpers of tests; indices as in the formulae")]

use spectral_core::bilinear::{EstimateError, ISO_RGB_PRINTED, Tensor, estimate, estimate_rgb};
use spectral_core::colour::RgbSpace;

type Matrices = [[[f64; 3]; 3]; 3];

fn number(i: usize) -> f64 {
    f64::from(u32::try_from(i).unwrap())
}

fn largest_difference(a: &Matrices, b: &Matrices) -> f64 {
    let pairs = a.as_flattened().as_flattened().iter().zip(b.as_flattened().as_flattened());
    pairs.fold(0.0, |worst, (a, b)| if (a - b).abs() <= worst { worst } else { (a - b).abs() })
}

fn assert_coherent(matrices: &Matrices, tolerance: f64) {
    for row in 0..3 {
        for column in 0..3 {
            let sum: f64 = matrices.iter().map(|m| m[row][column]).sum();
            let unit = if row == column { 1.0 } else { 0.0 };
            assert!((sum - unit).abs() <= tolerance, "{row} {column} {sum}");
        }
    }
    for channel in 0..3 {
        for d in 0..3 {
            for e in 0..3 {
                assert_eq!(matrices[d][channel][e].to_bits(), matrices[e][channel][d].to_bits());
            }
        }
    }
}

/// `published`: Granier and Damez 2004, section 5.3. The recipe that was used is not printed; this one comes nearest.
#[test]
fn the_printed_tensor_is_reproduced_from_the_tables() {
    let found = estimate_rgb::<f64>(&RgbSpace::REC_709).unwrap();
    let matrices = found.tensor.matrices();
    assert!(largest_difference(&matrices, &ISO_RGB_PRINTED) <= 3e-4);
    assert_coherent(&matrices, 1e-12);
    // The adjustment is not a formality.
    let adjustment = largest_difference(&found.raw, &matrices);
    assert!((0.05..0.1).contains(&adjustment), "{adjustment}");
}

#[test]
fn the_printed_tensor_is_kept() {
    let iso = Tensor::<f64>::iso_rgb();
    assert!(largest_difference(&iso.matrices(), &ISO_RGB_PRINTED) <= 3e-10);
    assert_coherent(&iso.matrices(), 1e-12);
    let read = Tensor::from_matrices(&ISO_RGB_PRINTED, 1e-9).unwrap();
    assert!(largest_difference(&read.matrices(), &ISO_RGB_PRINTED) <= 3e-10);
    assert_coherent(&read.matrices(), 1e-12);
}

/// Half a unit of the twelfth decimal, and rounding.
#[test]
fn the_constants_are_those_that_are_estimated() {
    let cases = [
        (RgbSpace::REC_709, Tensor::<f64>::rec_709()),
        (RgbSpace::REC_2020, Tensor::rec_2020()),
        (RgbSpace::ACESCG, Tensor::acescg()),
    ];
    for (space, constant) in cases {
        let double = estimate_rgb::<f64>(&space).unwrap().tensor;
        for (a, b) in double.transfer().as_flattened().iter().zip(constant.transfer().as_flattened()) {
            assert!((a - b).abs() <= 5.1e-13, "{a} {b}");
        }
        assert_coherent(&double.matrices(), 1e-12);
        let single = estimate_rgb::<f32>(&space).unwrap().tensor;
        for (a, b) in double.transfer().as_flattened().iter().zip(single.transfer().as_flattened()) {
            assert!((a - f64::from(*b)).abs() <= 1e-7, "{a} {b}");
        }
    }
}

/// Functions whose coefficients are known in closed form: boxes that don't overlap have the classical product.
#[test]
fn functions_that_do_not_overlap_have_no_transfer() {
    // Wide boxes between single ramps; the ramps of neighbours are a node apart.
    let node =
        |i: usize| core::array::from_fn(|c| if (c * 2000 + 1..c * 2000 + 1999).contains(&i) { 3.0_f64 } else { 0.0 });
    let found = estimate(6000, node).unwrap();
    for k in found.tensor.transfer().as_flattened() {
        assert!(k.abs() <= 1e-3, "{k}");
    }
    // Exactly: of a trapezium with ramps of one step and total integral 1 the diagonal is ⟨b²,b̄⟩ = M² ∫b̄³.
    let (plateau, height) = (1997.0, 1.0 / 1998.0);
    let square = height * height * (plateau + 2.0 / 3.0);
    let cube = height * height * height * (plateau + 2.0 / 4.0);
    for c in 0..3 {
        assert!((found.raw[c][c][c] - cube / (square * square)).abs() <= 1e-12);
    }
}

/// Neither the step nor the scale of a function matters, and the order of the channels follows that of the functions.
#[test]
fn scale_and_order_are_followed() {
    let bump = |i: usize, centre: f64, width: f64| (-((number(i) - centre) / width).powi(2)).exp();
    let node = |i: usize| [bump(i, 60.0, 12.0), bump(i, 40.0, 11.0), bump(i, 20.0, 8.0)];
    let plain = estimate(81, node).unwrap().tensor.matrices();
    let scaled = estimate(81, |i| {
        let [r, g, b] = node(i);
        [1e-20 * r, 1e20 * g, 7.0 * b]
    });
    assert!(largest_difference(&plain, &scaled.unwrap().tensor.matrices()) <= 1e-12);
    let turned = estimate(81, |i| {
        let [r, g, b] = node(i);
        [g, b, r]
    });
    let turned = turned.unwrap().tensor.matrices();
    for e in 0..3 {
        for c in 0..3 {
            for d in 0..3 {
                let moved = turned[(e + 2) % 3][(c + 2) % 3][(d + 2) % 3];
                assert!((plain[e][c][d] - moved).abs() <= 1e-12);
            }
        }
    }
}

#[test]
fn functions_that_cannot_serve_are_refused() {
    let good = |i: usize| [1.0, number(i), number(i) * number(i)];
    assert_eq!(estimate(1, good).unwrap_err(), EstimateError::TooFewNodes { count: 1 });
    let nan = |i: usize| if i == 3 { [1.0, f64::NAN, 0.0] } else { good(i) };
    assert_eq!(estimate(9, nan).unwrap_err(), EstimateError::Node { index: 3 });
    assert_eq!(estimate(9, |i| [1.0, number(i), -1.0]).unwrap_err(), EstimateError::Integral { channel: 2 });
    assert_eq!(estimate(9, |i| [1.0, 0.0 * number(i), 1.0]).unwrap_err(), EstimateError::Integral { channel: 1 });
    assert_eq!(estimate(9, |i| [1.0, 1.0 + number(i), 3.0]).unwrap_err(), EstimateError::Dependent);
    assert!(estimate(9, good).is_ok());
}
