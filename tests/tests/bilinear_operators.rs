//! Properties of the bilinear product and quotient, in both precisions, for colours of any size.
#![allow(
    clippy::float_cmp,
    clippy::unwrap_used,
    clippy::cast_possible_truncation,
    clippy::needless_range_loop,
    reason = "exact values are what is stated; helpers of tests; indices as in the formulae"
)]

use spectral_core::Real;
use spectral_core::bilinear::{AlphaError, DivisorError, Tensor, TensorError};
use spectral_tests::generators::Draw;

const CASES: usize = 20_000;

fn tensors<R: Real>() -> [Tensor<R>; 5] {
    [Tensor::iso_rgb(), Tensor::rec_709(), Tensor::rec_2020(), Tensor::acescg(), Tensor::classical()]
}

/// The magnitudes of the components of two colours; products must be in the range of the type.
struct Sizes {
    first: [f64; 2],
    second: [f64; 2],
}

const F64: [Sizes; 1] = [Sizes { first: [1e-30, 1e30], second: [1e-30, 1e30] }];
/// In `f32` products go from 1e-36 to 1e36.
const F32: [Sizes; 3] = [
    Sizes { first: [1e-18, 1e18], second: [1e-18, 1e18] },
    Sizes { first: [1e-30, 1e30], second: [1e-6, 1e6] },
    Sizes { first: [1e-6, 1e6], second: [1e-30, 1e30] },
];

/// Components of one magnitude, or of all magnitudes, some zero, some negative, some pure.
fn colour<R: Real>(draw: &mut Draw, [low, high]: [f64; 2]) -> [R; 3] {
    let magnitude = draw.magnitude(low, high);
    let (spread, pure) = (draw.once_in(4), draw.once_in(10).then(|| draw.index(0..3)));
    core::array::from_fn(|c| {
        let size = if spread { draw.magnitude(low, high) } else { magnitude * draw.unit() };
        let sign = if draw.once_in(8) { -1.0 } else { 1.0 };
        let on = pure.map_or(!draw.once_in(12), |only| only == c);
        R::from_f64(if on { sign * size } else { 0.0 })
    })
}

/// The exact size of the terms of a product: |C_c D_c| + Σ |k| (|C_d| + |C_e|)(|D_d| + |D_e|).
fn size<R: Real>(tensor: &Tensor<R>, c: [R; 3], d: [R; 3]) -> [f64; 3] {
    let (c, d) = (c.map(|v| v.to_f64().abs()), d.map(|v| v.to_f64().abs()));
    let pairs = [[0, 1], [1, 2], [2, 0]];
    core::array::from_fn(|channel| {
        let terms = pairs.iter().zip(tensor.transfer()[channel]);
        let terms = terms.map(|([p, q], k)| k.to_f64().abs() * (c[*p] + c[*q]) * (d[*p] + d[*q]));
        c[channel] * d[channel] + terms.sum::<f64>()
    })
}

fn bits<R: Real>(colour: [R; 3]) -> [u64; 3] {
    colour.map(|c| c.to_f64().to_bits())
}

fn both(check: impl Fn(&mut Draw, &Sizes, bool)) {
    let mut draw = Draw::new(0x5eed);
    for _ in 0..CASES {
        F64.iter().for_each(|sizes| check(&mut draw, sizes, true));
        F32.iter().for_each(|sizes| check(&mut draw, sizes, false));
    }
}

/// Runs a generic check for both precisions.
macro_rules! in_both_precisions {
    ($check:ident) => {
        both(|draw, sizes, double| if double { $check::<f64>(draw, sizes) } else { $check::<f32>(draw, sizes) })
    };
}

#[test]
fn the_product_commutes_to_the_bit() {
    fn check<R: Real>(draw: &mut Draw, sizes: &Sizes) {
        let (c, d) = (colour::<R>(draw, sizes.first), colour::<R>(draw, sizes.second));
        for tensor in tensors::<R>() {
            assert_eq!(bits(tensor.product(c, d)), bits(tensor.product(d, c)), "{c:?} {d:?}");
        }
    }
    in_both_precisions!(check);
}

/// The definition, with all 27 coefficients, in `f64`: three roundings in each of the two, and the coefficients themselves.
#[test]
fn the_product_is_the_sum_over_27_coefficients() {
    fn check<R: Real>(draw: &mut Draw, sizes: &Sizes) {
        let (c, d) = (colour::<R>(draw, sizes.first), colour::<R>(draw, sizes.second));
        for tensor in tensors::<R>() {
            let (actual, size) = (tensor.product(c, d), size(&tensor, c, d));
            let matrices = Tensor::new(tensor.transfer().map(|row| row.map(Real::to_f64))).unwrap().matrices();
            let [reflected, light] = [d, c].map(|colour| colour.map(Real::to_f64));
            for channel in 0..3 {
                let mut sum = 0.0;
                for e in 0..3 {
                    for f in 0..3 {
                        sum += matrices[e][channel][f] * light[e] * reflected[f];
                    }
                }
                let tolerance = 4.0 * (R::EPSILON.to_f64() + 8.0 * f64::EPSILON) * size[channel];
                let tolerance = tolerance + 8.0 * R::MIN_POSITIVE.to_f64();
                assert!((actual[channel].to_f64() - sum).abs() <= tolerance, "{c:?} {d:?}");
            }
        }
    }
    in_both_precisions!(check);
}

/// 4 ε for each product, one rounding of the sum of colours, one of the sum of products.
#[test]
fn the_product_distributes_over_sums() {
    fn check<R: Real>(draw: &mut Draw, sizes: &Sizes) {
        let a = colour::<R>(draw, sizes.first);
        let [b, c] = [(); 2].map(|()| colour::<R>(draw, sizes.second));
        let sum = core::array::from_fn(|i| b[i] + c[i]);
        let magnitudes = core::array::from_fn(|i| b[i].abs() + c[i].abs());
        for tensor in tensors::<R>() {
            let (whole, parts) = (tensor.product(a, sum), [tensor.product(a, b), tensor.product(a, c)]);
            let size = size(&tensor, a, magnitudes);
            for channel in 0..3 {
                let parts = parts[0][channel].to_f64() + parts[1][channel].to_f64();
                let tolerance = 9.0 * R::EPSILON.to_f64() * size[channel] + 16.0 * R::MIN_POSITIVE.to_f64();
                assert!((whole[channel].to_f64() - parts).abs() <= tolerance, "{a:?} {b:?} {c:?}");
            }
        }
    }
    in_both_precisions!(check);
}

#[test]
fn white_scales_to_the_bit() {
    fn check<R: Real>(draw: &mut Draw, sizes: &Sizes) {
        let (c, [white, ..]) = (colour::<R>(draw, sizes.first), colour::<R>(draw, sizes.second));
        for tensor in tensors::<R>() {
            assert_eq!(
                bits(tensor.product(c, [white; 3])),
                bits(c.map(|component| component * white)),
                "{c:?} {white}"
            );
        }
    }
    in_both_precisions!(check);
}

#[test]
fn without_transfer_the_product_is_the_classical_one_to_the_bit() {
    fn check<R: Real>(draw: &mut Draw, sizes: &Sizes) {
        let (c, d) = (colour::<R>(draw, sizes.first), colour::<R>(draw, sizes.second));
        let classical = [0, 1, 2].map(|i| c[i] * d[i]);
        assert_eq!(bits(Tensor::classical().product(c, d)), bits(classical), "{c:?} {d:?}");
        let tensor = Tensor::<R>::iso_rgb().with_alpha([R::ZERO; 3]).unwrap();
        assert_eq!(bits(tensor.product(c, d)), bits(classical), "{c:?} {d:?}");
        let one = Tensor::<R>::iso_rgb().with_alpha([R::HALF, R::ZERO, R::ONE]).unwrap();
        assert_eq!(one.product(c, d)[1].to_f64().to_bits(), classical[1].to_f64().to_bits(), "{c:?} {d:?}");
    }
    in_both_precisions!(check);
}

#[test]
fn a_reflection_matrix_does_what_the_product_does() {
    fn check<R: Real>(draw: &mut Draw, sizes: &Sizes) {
        let (c, d) = (colour::<R>(draw, sizes.first), colour::<R>(draw, sizes.second));
        for tensor in tensors::<R>() {
            let (matrix, product) = (tensor.reflection(c).apply(d), tensor.product(c, d));
            let size = size(&tensor, c, d);
            for channel in 0..3 {
                // Both are within 4 ε of the exact product.
                let tolerance = 8.0 * R::EPSILON.to_f64() * size[channel] + 16.0 * R::MIN_POSITIVE.to_f64();
                assert!((matrix[channel] - product[channel]).abs().to_f64() <= tolerance, "{c:?} {d:?}");
            }
        }
    }
    in_both_precisions!(check);
}

#[test]
fn a_quotient_undoes_a_product_within_the_condition_number() {
    fn check<R: Real>(draw: &mut Draw, sizes: &Sizes) {
        let (c, d) = (colour::<R>(draw, sizes.first), colour::<R>(draw, sizes.second));
        let largest = |v: [R; 3]| v.into_iter().fold(0.0_f64, |m, v| m.max(v.to_f64().abs()));
        for tensor in tensors::<R>() {
            let Ok(divisor) = tensor.divisor(d) else { continue };
            let condition = divisor.condition().to_f64();
            assert!(condition >= 0.999, "{condition}");
            let back = divisor.quotient(tensor.product(c, d));
            // What the product lost where it underflowed comes back divided by the divisor.
            let lost = 16.0 * R::MIN_POSITIVE.to_f64() / largest(d) * condition;
            let tolerance = 16.0 * condition * (R::EPSILON.to_f64() * largest(c) + lost);
            for (back, c) in back.into_iter().zip(c) {
                assert!((back - c).abs().to_f64() <= tolerance, "{c:?} {d:?} {back:?} {condition:e}");
            }
        }
    }
    in_both_precisions!(check);
}

#[test]
fn pure_colours_divide() {
    fn check<R: Real>() {
        for tensor in [Tensor::<R>::iso_rgb(), Tensor::rec_709(), Tensor::rec_2020(), Tensor::acescg()] {
            for pure in [0, 1, 2] {
                let mut colour = [R::ZERO; 3];
                colour[pure] = R::from_f64(0.7);
                let divisor = tensor.divisor(colour).unwrap();
                assert!(divisor.condition() <= R::from_f64(300.0), "{colour:?} {}", divisor.condition());
                let c = [0.1, 0.5, 0.2].map(R::from_f64);
                for (back, c) in divisor.quotient(tensor.product(colour, c)).into_iter().zip(c) {
                    assert!((back - c).abs() <= R::from_f64(8.0) * R::EPSILON * divisor.condition(), "{back} {c}");
                }
                assert_eq!(Tensor::classical().divisor(colour), Err(DivisorError::Singular));
            }
        }
    }
    check::<f32>();
    check::<f64>();
}

#[test]
fn divisors_are_refused_by_type() {
    let iso = Tensor::<f64>::iso_rgb();
    assert_eq!(iso.divisor([0.0; 3]), Err(DivisorError::Singular));
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        assert_eq!(iso.divisor([0.5, bad, 0.5]), Err(DivisorError::NotFinite));
    }
    assert_eq!(iso.divisor([0.3; 3]).unwrap().condition(), 1.0);
    // A red with a little green: between two colours for which the determinant has unlike signs there is a singular one.
    let at = |t: f64| [1.0, t, 0.0];
    let determinant = |colour| {
        let [a, b, c]: [[f64; 3]; 3] = iso.reflection(colour).matrix();
        a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0]) + a[2] * (b[0] * c[1] - b[1] * c[0])
    };
    let (mut low, mut high) = (0.0, 1.0);
    assert!(determinant(at(low)) * determinant(at(high)) < 0.0);
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        if determinant(at(middle)) * determinant(at(high)) < 0.0 { low = middle } else { high = middle }
    }
    let refused = [low, high].into_iter().filter(|t| iso.divisor(at(*t)) == Err(DivisorError::Singular)).count();
    let condition = iso.divisor(at(high)).map_or(f64::INFINITY, |d| d.condition());
    assert!(refused > 0 || condition >= 1e13, "{low} {condition:e}");
    let single = [low, high].map(|t| t as f32).map(|t| Tensor::<f32>::iso_rgb().divisor([1.0, t, 0.0]));
    assert!(single.iter().all(|d| d.is_err() || d.is_ok_and(|d| d.condition() >= 1e5)), "{single:?}");
}

#[test]
fn relighting_is_division_then_product() {
    let iso = Tensor::<f64>::iso_rgb();
    let (blue, yellow) = ([0.4, 0.9, 1.0], [1.0, 0.9, 0.1]);
    let from = iso.divisor(blue).unwrap();
    let relight = from.relighting(&iso, yellow);
    let mut draw = Draw::new(7);
    for _ in 0..1000 {
        let pixel = core::array::from_fn(|_| draw.magnitude(1e-4, 1e4));
        let [expected, actual] = [iso.product(from.quotient(pixel), yellow), relight.apply(pixel)];
        let largest = pixel.into_iter().fold(0.0_f64, f64::max);
        for (actual, expected) in actual.iter().zip(expected) {
            assert!((actual - expected).abs() <= 32.0 * from.condition() * f64::EPSILON * largest, "{pixel:?}");
        }
    }
}

#[test]
fn alpha_sets_what_is_transferred() {
    let iso = Tensor::<f64>::iso_rgb();
    let alpha = [0.0, 0.3, 1.0];
    let controlled = iso.with_alpha(alpha).unwrap();
    let (matrices, printed) = (controlled.matrices(), iso.matrices());
    for channel in 0..3 {
        let beta = alpha[channel] / (1.0 - printed[channel][channel][channel]);
        for e in 0..3 {
            for d in 0..3 {
                let own = d == channel && e == channel;
                let expected = if own { 1.0 - alpha[channel] } else { beta * printed[e][channel][d] };
                assert!((matrices[e][channel][d] - expected).abs() <= 16.0 * f64::EPSILON * (1.0 + beta));
            }
        }
    }
    for (found, alpha) in controlled.alpha().iter().zip(alpha) {
        assert!((found - alpha).abs() <= 8.0 * f64::EPSILON);
    }
    // The tensor's own α changes nothing but rounding.
    let same = iso.with_alpha(iso.alpha()).unwrap();
    for (a, b) in same.transfer().as_flattened().iter().zip(iso.transfer().as_flattened()) {
        assert!((a - b).abs() <= 4.0 * f64::EPSILON * b.abs());
    }
}

/// Half the α is half the way from the classical product: no jump at 0.
#[test]
fn the_passage_to_the_classical_product_is_smooth() {
    let iso = Tensor::<f64>::iso_rgb();
    let (c, d) = ([0.1, 1.0, 0.7], [0.6, 0.2, 0.05]);
    let classical = Tensor::classical().product(c, d);
    let full = iso.product(c, d);
    for step in 0..=20 {
        let part = f64::from(step) / 20.0;
        let product = iso.with_alpha(iso.alpha().map(|a| part * a)).unwrap().product(c, d);
        for channel in 0..3 {
            let expected = classical[channel] + part * (full[channel] - classical[channel]);
            assert!((product[channel] - expected).abs() <= 16.0 * f64::EPSILON, "{part}");
        }
    }
}

#[test]
fn bad_controls_and_tensors_are_refused_by_type() {
    let iso = Tensor::<f64>::iso_rgb();
    for bad in [-1e-300, f64::NAN, f64::INFINITY] {
        assert_eq!(iso.with_alpha([0.1, bad, 0.1]), Err(AlphaError::Value { channel: 1 }));
    }
    assert_eq!(Tensor::classical().with_alpha([0.0, 0.0, 0.1_f32]), Err(AlphaError::NoTransfer { channel: 2 }));
    assert_eq!(Tensor::<f64>::rec_2020().with_alpha([0.1; 3]), Err(AlphaError::NoTransfer { channel: 0 }));
    assert_eq!(Tensor::<f64>::rec_2020().with_alpha([0.0; 3]), Ok(Tensor::classical().scaled([-0.0; 3]).unwrap()));
    assert_eq!(Tensor::new([[0.0, f64::NAN, 0.0]; 3]), Err(TensorError::NotFinite));
    assert_eq!(iso.scaled([1.0, f64::INFINITY, 1.0]), Err(TensorError::NotFinite));
    let good = iso.matrices();
    assert!(Tensor::from_matrices(&good, 1e-15).is_ok());
    let mut matrices = good;
    matrices[0][2][1] += 1e-6;
    assert_eq!(Tensor::from_matrices(&matrices, 1e-7), Err(TensorError::Asymmetric { channel: 2, pair: [0, 1] }));
    assert!(Tensor::from_matrices(&matrices, 2e-6).is_ok());
    let mut matrices = good;
    matrices[1][2][1] += 1e-6;
    assert_eq!(Tensor::from_matrices(&matrices, 1e-7), Err(TensorError::Incoherent { channel: 2, column: 1 }));
    assert!(Tensor::from_matrices(&matrices, f64::NAN).is_err());
    matrices[2][0][0] = f64::INFINITY;
    assert_eq!(Tensor::from_matrices(&matrices, 1.0), Err(TensorError::NotFinite));
}
