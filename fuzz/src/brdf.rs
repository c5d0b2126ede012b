//! Reflectance models and smooth boundaries.

use spectral_core::Real;
use spectral_core::brdf::{Brdf, Glossy, Lambert, Schlick, Variant, Ward, direction};
use spectral_core::dispersion::{Cauchy, Dispersion, Sellmeier};
use spectral_core::fresnel;

use crate::numbers::{Numbers, assert_finite, assert_in};

/// Evaluates, samples and inverts a model for directions made of the bytes.
pub fn brdf(bytes: &[u8]) {
    model::<f64>(&mut Numbers::new(bytes));
    model::<f32>(&mut Numbers::new(bytes));
}

/// Fresnel's formulae and dispersion for any numbers.
pub fn boundary(bytes: &[u8]) {
    fresnel_formulae::<f64>(&mut Numbers::new(bytes));
    fresnel_formulae::<f32>(&mut Numbers::new(bytes));
    glass::<f64>(&mut Numbers::new(bytes));
    glass::<f32>(&mut Numbers::new(bytes));
}

fn model<R: Real>(numbers: &mut Numbers) {
    let kind = numbers.below(8);
    let roughness: [R; 2] = [numbers.positive(7), numbers.positive(7)];
    match kind {
        0..4 => {
            let Ok(ward) = Ward::new(Variant::ALL[kind], roughness[0], roughness[1]) else { return };
            check(&ward, numbers, kind == 3);
        }
        4 | 5 => {
            let [r, p] = numbers.units::<R, 2>();
            let Ok(schlick) = Schlick::new(r, p) else { return };
            check(&schlick, numbers, false);
        }
        6 => {
            let Ok(ward) = Ward::new(Variant::Balanced, roughness[0], roughness[1]) else { return };
            let [diffuse, specular] = numbers.units::<R, 2>();
            let Ok(glossy) = Glossy::new(diffuse, specular, ward) else { return };
            check(&glossy, numbers, false);
        }
        _ => check::<R>(&Lambert, numbers, true),
    }
}

/// What every model promises, and, where it `conserves` energy, that no sample's weight is above 1.
fn check<R: Real>(model: &impl Brdf<R>, numbers: &mut Numbers, conserves: bool) {
    // Whatever comes in, a finite number comes out.
    let any = [numbers.any_vector::<R, 3>(), numbers.any_vector()];
    assert_in(model.evaluate(any[0], any[1]), 0.0, f64::MAX, "value");
    assert_in(model.pdf(any[0], any[1]), 0.0, f64::MAX, "density");
    let directions = [numbers.vector_within::<R, 3>(1e30), numbers.vector_within(1e30)].map(direction);
    let [Ok(light), Ok(view)] = directions else { return };
    let value = model.evaluate(light, view);
    assert_in(value, 0.0, f64::MAX, "value");
    assert_eq!(value, model.evaluate(view, light), "reciprocity");
    assert_in(model.pdf(light, view), 0.0, f64::MAX, "density");
    let above = |d: [R; 3]| d[2] > R::ZERO;
    assert!(above(light) && above(view) || value == R::ZERO);

    let sample = model.sample(view, numbers.units());
    assert_eq!(sample.is_some(), above(view));
    if let Some(sample) = sample {
        assert!(above(sample.direction), "{sample:?}");
        let [x, y, z] = sample.direction.map(R::to_f64);
        assert!((x.hypot(y).hypot(z) - 1.0).abs() <= 8.0 * R::EPSILON.to_f64(), "{sample:?}");
        assert_in(sample.pdf, 0.0, f64::MAX, "density");
        let most = if conserves { 1.0 + 8.0 * R::EPSILON.to_f64() } else { f64::MAX };
        assert_in(sample.weight, 0.0, most, "weight");
    }
    let numbers = model.invert(light, view);
    assert_eq!(numbers.is_some(), above(light) && above(view));
    if let Some(numbers) = numbers {
        numbers.iter().for_each(|u| assert_in(*u, 0.0, 1.0, "inverse"));
    }
}

fn fresnel_formulae<R: Real>(numbers: &mut Numbers) {
    let [cosine, a, b]: [R; 3] = numbers.any_vector();
    for factor in [fresnel::schlick_factor(cosine), fresnel::ward_factor(cosine)] {
        assert!(cosine.is_nan() || (factor >= R::ZERO && factor <= R::ONE), "{factor} at {cosine}");
    }
    if !cosine.is_nan() && !a.is_nan() {
        assert_in(fresnel::schlick(a, cosine), 0.0, 1.0, "Schlick");
        assert_in(fresnel::ward(a, cosine), 0.0, 1.0, "Ward");
    }
    let cosine: R = numbers.unit();
    let real_eta = a.to_f64() >= 1e-9 && a.to_f64() <= 1e9;
    if let Some((reflectance, refracted)) = fresnel::dielectric(cosine, a).filter(|_| real_eta) {
        assert_in(reflectance, 0.0, 1.0 + 8.0 * R::EPSILON.to_f64(), "dielectric");
        assert_in(refracted, 0.0, 1.0, "cosine of refraction");
    }
    let [n, k] = [a.abs(), b.abs()];
    if n.to_f64() >= 1e-9 && n.to_f64() <= 1e9 && k.to_f64() <= 1e9 {
        assert_in(fresnel::conductor(cosine, n, k), 0.0, 1.0, "conductor");
    }
}

fn glass<R: Real>(numbers: &mut Numbers) {
    let valid = [R::from_f64(300.0), R::from_f64(1000.0)];
    let any: R = numbers.any();
    let terms = core::array::from_fn(|_| if numbers.byte() < 64 { [R::ZERO; 2] } else { numbers.vector_within(1e3) });
    if let Ok(glass) = Sellmeier::new(terms, valid) {
        index(&glass, any, valid);
    }
    if let Ok(glass) = Cauchy::new(numbers.any(), numbers.any(), valid) {
        index(&glass, any, valid);
    }
}

fn index<R: Real>(glass: &impl Dispersion<R>, any: R, valid: [R; 2]) {
    for wavelength in [any, valid[0], valid[1], R::from_f64(555.5)] {
        let (n, slope) = (glass.index(wavelength), glass.derivative(wavelength));
        assert!(n > R::ZERO, "index {n} at {wavelength}");
        assert_finite(&[n, slope], "index");
    }
}
