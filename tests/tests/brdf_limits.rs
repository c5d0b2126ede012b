//! Reflectance models where numbers end: at the horizon, for very smooth surfaces, for input that isn't a direction.
#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "a test stops at what should not be, and prints what it measured"
)]

use core::f64::consts::PI;

use spectral_core::Real;
use spectral_core::brdf::{Brdf, BrdfError, Glossy, Lambert, Schlick, Variant, Ward, direction};

fn models<R: Real>() -> Vec<(String, Box<dyn Brdf<R>>)> {
    let r = R::from_f64;
    let mut models: Vec<(String, Box<dyn Brdf<R>>)> = vec![("lambert".into(), Box::new(Lambert))];
    for (alpha, beta) in
        [(1e-6, 1e-6), (1e-4, 1e-4), (1e-4, 1.0), (0.1, 0.1), (1.0, 0.2), (100.0, 100.0), (100.0, 1e-6)]
    {
        for variant in Variant::ALL {
            let model = Ward::new(variant, r(alpha), r(beta)).unwrap();
            models.push((format!("{model:?}"), Box::new(model)));
            let glossy = Glossy::new(r(0.25), r(0.75), model).unwrap();
            models.push((format!("{glossy:?}"), Box::new(glossy)));
        }
    }
    for roughness in [R::ZERO, R::MIN_POSITIVE, R::EPSILON * r(1.5), r(1e-4), r(0.3), r(0.7), R::ONE] {
        for isotropy in [R::MIN_POSITIVE, r(1e-4), r(0.5), R::ONE] {
            let model = Schlick::new(roughness, isotropy).unwrap();
            models.push((format!("{model:?}"), Box::new(model)));
        }
    }
    models
}

/// Cosines from 1 to the smallest number there is.
fn directions<R: Real>() -> Vec<[R; 3]> {
    let r = R::from_f64;
    let least = R::MIN_POSITIVE * R::EPSILON;
    let cosines =
        [R::ONE, r(0.5), r(1e-3), R::EPSILON, (R::PI * R::HALF).cos().abs(), r(1e-13), R::MIN_POSITIVE, least];
    let mut directions = Vec::new();
    for z in cosines {
        for phi in [0.0, 0.7, PI, PI + 0.7, 1.5] {
            let s = ((R::ONE - z) * (R::ONE + z)).sqrt();
            directions.push([s * r(phi).cos(), s * r(phi).sin(), z]);
        }
    }
    directions
}

fn good<R: Real>(x: R) -> bool {
    x >= R::ZERO && x <= R::MAX
}

fn at_the_horizon<R: Real>() {
    let half_ulp = R::ONE - R::EPSILON * R::HALF;
    let numbers = [R::ZERO, R::MIN_POSITIVE, R::EPSILON, R::from_f64(0.3), R::HALF, R::from_f64(0.9), half_ulp];
    let directions = directions::<R>();
    for (name, model) in &models::<R>() {
        for view in &directions {
            let albedo = model.albedo(*view);
            assert!(good(albedo), "{name} {view:?}: albedo {albedo}");
            for light in &directions {
                let (value, pdf) = (model.evaluate(*light, *view), model.pdf(*light, *view));
                assert!(good(value) && good(pdf), "{name} {light:?} {view:?}: {value} {pdf}");
                assert!(value == model.evaluate(*view, *light), "{name}");
                let u = model.invert(*light, *view).unwrap();
                assert!(u.iter().all(|x| *x >= R::ZERO && *x < R::ONE), "{name} {light:?} {view:?}: {u:?}");
            }
            for i in 0..numbers.len().pow(3) {
                let u = [numbers[i % 7], numbers[i / 7 % 7], numbers[i / 49]];
                let s = model.sample(*view, u).unwrap();
                let length = s.direction.iter().fold(R::ZERO, |sum, x| sum + *x * *x);
                let unit = (length - R::ONE).abs() <= R::from_f64(64.0) * R::EPSILON;
                assert!(unit && s.direction[2] > R::ZERO, "{name} {view:?} {u:?}: {s:?}");
                assert!(good(s.pdf) && good(s.weight), "{name} {view:?} {u:?}: {s:?}");
            }
        }
    }
}

#[test]
fn everything_is_finite_at_the_horizon_in_single_precision() {
    at_the_horizon::<f32>();
}

#[test]
fn everything_is_finite_at_the_horizon_in_double_precision() {
    at_the_horizon::<f64>();
}

fn junk<R: Real>() {
    let nan = R::from_f64(f64::NAN);
    let good_view = [R::ZERO, R::ZERO, R::ONE];
    let values = [R::ZERO, -R::ZERO, R::MIN_POSITIVE, R::ONE, -R::ONE, R::MAX, -R::MAX, R::INFINITY, -R::INFINITY, nan];
    for (name, model) in &models::<R>() {
        for i in 0..values.len().pow(3) {
            let vector = [values[i % 10], values[i / 10 % 10], values[i / 100]];
            let above = vector[2] > R::ZERO && vector.iter().all(|x| x.abs() <= R::TWO);
            for (light, view) in [(vector, good_view), (good_view, vector), (vector, vector)] {
                let (value, pdf) = (model.evaluate(light, view), model.pdf(light, view));
                assert!(good(value) && good(pdf), "{name} {light:?} {view:?}: {value} {pdf}");
                assert!(above || (value == R::ZERO && pdf == R::ZERO && model.invert(light, view).is_none()));
            }
            assert_eq!(model.sample(vector, [R::HALF; 3]).is_some(), above, "{name} {vector:?}");
            assert!(good(model.albedo(vector)), "{name} {vector:?}");
            // Random numbers that aren't.
            let s = model.sample(good_view, vector).unwrap();
            assert!(good(s.pdf) && good(s.weight) && s.direction[2] > R::ZERO, "{name} {vector:?}: {s:?}");
        }
    }
}

#[test]
fn input_that_is_no_direction_reflects_nothing() {
    junk::<f32>();
    junk::<f64>();
}

/// At 90° and a roughness of 10⁻⁴, values are what they should be: 0 beside the mirror direction, large in it.
#[test]
fn very_smooth_surfaces_at_ninety_degrees() {
    for variant in Variant::ALL {
        let model = Ward::new(variant, 1e-4_f32, 1e-4).unwrap();
        let view = [1.0, 0.0, 1e-6_f32];
        assert!(model.evaluate([-1.0, 0.0, 1e-6], view) > 1e6);
        assert_eq!(model.evaluate([0.0, 1.0, 1e-6], view), 0.0);
        assert_eq!(model.evaluate([0.0, 0.0, 1.0], view), 0.0);
    }
    let balanced = Ward::new(Variant::Balanced, 1e-4_f32, 1e-4).unwrap();
    assert!((balanced.albedo([1.0, 0.0, f32::MIN_POSITIVE]) - 1.0).abs() <= 3e-4);
    // The lowest view that there is counts as one of ε²: 1/(4παβ ε⁴), or the largest number.
    let (lowest, floor) = (f32::MIN_POSITIVE, f32::EPSILON * f32::EPSILON);
    let peak = balanced.evaluate([-1.0, 0.0, lowest], [1.0, 0.0, lowest]);
    assert!((peak * (4.0 * core::f32::consts::PI * 1e-8 * floor) * floor - 1.0).abs() <= 1e-5, "{peak}");
    let smoother = Ward::new(Variant::Balanced, 1e-6_f32, 1e-6).unwrap();
    assert_eq!(smoother.evaluate([-1.0, 0.0, lowest], [1.0, 0.0, lowest]), f32::MAX);
}

#[test]
fn bad_parameters_are_refused() {
    for bad in [0.0, -0.1, 1e-7, 101.0, f64::NAN, f64::INFINITY, f64::MIN_POSITIVE / 2.0] {
        assert_eq!(Ward::new(Variant::Ward, bad, 0.1), Err(BrdfError::Roughness));
        assert_eq!(Ward::new(Variant::Balanced, 0.1, bad), Err(BrdfError::Roughness));
    }
    let model = Ward::new(Variant::Balanced, 0.1, 0.1).unwrap();
    for bad in [-1e-9, 1.000_001, f64::NAN, f64::INFINITY] {
        assert_eq!(Glossy::new(bad, 0.1, model), Err(BrdfError::Reflectance));
        assert_eq!(Glossy::new(0.1, bad, model), Err(BrdfError::Reflectance));
    }
    assert_eq!(Glossy::new(0.6, 0.5, model), Err(BrdfError::Energy));
    assert!(Glossy::new(0.7, 0.3, model).is_ok() && Glossy::new(0.9, 0.1, model).is_ok());
    for bad in [-0.1, 1.1, f64::NAN] {
        assert_eq!(Schlick::new(bad, 1.0), Err(BrdfError::Roughness));
        assert_eq!(Schlick::new(0.1, bad), Err(BrdfError::Isotropy));
    }
    assert_eq!(Schlick::new(0.1, 0.0), Err(BrdfError::Isotropy));
    for bad in [[0.0; 3], [f64::NAN, 0.0, 1.0], [f64::INFINITY, 0.0, 1.0]] {
        assert_eq!(direction(bad), Err(BrdfError::Direction));
    }
    for scale in [f64::MIN_POSITIVE / 1e10, 1.0, f64::MAX / 4.0] {
        let unit = direction([3.0 * scale, 0.0, 4.0 * scale]).unwrap();
        assert!((unit[0] - 0.6).abs() <= 1e-6 && (unit.iter().map(|x| x * x).sum::<f64>() - 1.0).abs() <= 1e-15);
    }
}

#[test]
fn names_are_read_back() {
    for variant in Variant::ALL {
        assert_eq!(variant.to_string().parse(), Ok(variant));
    }
    assert_eq!("Ward".parse::<Variant>(), Err(BrdfError::Name));
    for error in [BrdfError::Roughness, BrdfError::Reflectance, BrdfError::Energy, BrdfError::Isotropy, BrdfError::Name]
    {
        assert!(!error.to_string().contains('\n'));
    }
}
