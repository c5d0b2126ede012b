//! The bilinear product and its inverse.

use spectral_core::Real;
use spectral_core::bilinear::{Divisor, Tensor};

use crate::numbers::{Numbers, assert_finite};

/// Multiplies and divides colours by tensors made of the bytes and by the built-in ones.
pub fn bilinear(bytes: &[u8]) {
    check::<f64>(&mut Numbers::new(bytes));
    check::<f32>(&mut Numbers::new(bytes));
}

fn check<R: Real>(numbers: &mut Numbers) {
    let tensor = match numbers.below(6) {
        0 => Tensor::iso_rgb(),
        1 => Tensor::rec_709(),
        2 => Tensor::rec_2020(),
        3 => Tensor::acescg(),
        4 => {
            let any = core::array::from_fn(|_| numbers.any_vector::<R, 3>());
            let finite = any.as_flattened().iter().all(|k| k.is_finite());
            let made = Tensor::new(any);
            assert_eq!(made.is_ok(), finite);
            return;
        }
        _ => Tensor::new(core::array::from_fn(|_| numbers.vector_within::<R, 3>(10.0))).expect("finite numbers"),
    };
    let [c, d] = core::array::from_fn(|_| colour::<R>(numbers));
    products(&tensor, c, d);
    alpha(&tensor, numbers);
    if let Ok(divisor) = tensor.divisor(numbers.any_vector()) {
        assert!(divisor.condition() >= R::ONE - R::from_f64(8.0) * R::EPSILON, "{}", divisor.condition());
    }
    if let Ok(divisor) = tensor.divisor(d) {
        division(&tensor, &divisor, c, d);
    }
}

/// A colour whose products neither overflow nor underflow.
fn colour<R: Real>(numbers: &mut Numbers) -> [R; 3] {
    let any: [R; 3] = numbers.vector_within(1e9);
    any.map(|component| if component.abs().to_f64() >= 1e-9 { component } else { R::ZERO })
}

/// The largest magnitude of a component.
fn size<R: Real>(colour: [R; 3]) -> f64 {
    colour.iter().fold(0.0, |most, c| most.max(c.abs().to_f64()))
}

/// The sum of the magnitudes of all coefficients.
fn gain<R: Real>(tensor: &Tensor<R>) -> f64 {
    1.0 + 4.0 * tensor.transfer().as_flattened().iter().map(|k| k.abs().to_f64()).sum::<f64>()
}

fn products<R: Real>(tensor: &Tensor<R>, c: [R; 3], d: [R; 3]) {
    let product = tensor.product(c, d);
    assert_finite(&product, "product");
    let most = 16.0 * R::EPSILON.to_f64() * gain(tensor) * size(c) * size(d) + 16.0 * R::MIN_POSITIVE.to_f64();
    let near = |a: [R; 3], b: [R; 3], what: &str| {
        assert!(a.iter().zip(&b).all(|(a, b)| (*a - *b).abs().to_f64() <= most), "{what}: {a:?}, {b:?} ± {most}");
    };
    near(product, tensor.product(d, c), "order");
    near(product, tensor.reflection(d).apply(c), "reflection");
    let grey = [d[0]; 3];
    assert_eq!(tensor.product(c, grey), c.map(|x| x * d[0]), "grey is a factor");
}

fn alpha<R: Real>(tensor: &Tensor<R>, numbers: &mut Numbers) {
    let alpha: [R; 3] = numbers.vector_within(1e3);
    if let Ok(changed) = tensor.with_alpha(alpha) {
        assert_finite(changed.transfer().as_flattened(), "coefficients");
    }
    if let Ok(scaled) = tensor.scaled(core::array::from_fn(|_| numbers.positive::<R>(2))) {
        assert_finite(scaled.transfer().as_flattened(), "coefficients");
    }
}

/// C ⊗ D ⊘ D is C, as well as the condition allows.
fn division<R: Real>(tensor: &Tensor<R>, divisor: &Divisor<R>, c: [R; 3], d: [R; 3]) {
    let back = divisor.quotient(tensor.product(c, d));
    let most = 16.0 * R::EPSILON.to_f64() * divisor.condition().to_f64() * size(c).max(size(back));
    assert!(back.iter().zip(&c).all(|(a, b)| (*a - *b).abs().to_f64() <= most), "{back:?} for {c:?} ± {most}");
}
