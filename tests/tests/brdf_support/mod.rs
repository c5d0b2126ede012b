//! What the tests of reflectance models share: directions, models and random numbers.
#![allow(dead_code, reason = "each test uses a part")]

use core::f64::consts::TAU;

use spectral_core::Real;
use spectral_core::brdf::{Variant, Ward};
use spectral_tests::statistics::Rng;

/// The unit vector of a polar and an azimuthal angle in radians.
pub(crate) fn vector(theta: f64, phi: f64) -> [f64; 3] {
    [theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos()]
}

/// A vector in another precision.
pub(crate) fn cast<R: Real>(v: [f64; 3]) -> [R; 3] {
    v.map(R::from_f64)
}

/// A direction above the surface, uniform in solid angle.
pub(crate) fn upper(rng: &mut Rng) -> [f64; 3] {
    let z = (1.0 - rng.unit()).max(1e-12);
    let phi = TAU * rng.unit();
    let r = ((1.0 - z) * (1.0 + z)).sqrt();
    [r * phi.cos(), r * phi.sin(), z]
}

pub(crate) fn numbers(rng: &mut Rng) -> [f64; 3] {
    [rng.unit(), rng.unit(), rng.unit()]
}

/// Uniform in the logarithm between two numbers.
pub(crate) fn log_uniform(rng: &mut Rng, low: f64, high: f64) -> f64 {
    low * (high / low).powf(rng.unit())
}

pub(crate) fn ward(variant: Variant, alpha: f64, beta: f64) -> Ward<f64> {
    Ward::new(variant, alpha, beta).unwrap()
}

/// The light that the half vector of this slope reflects the view to.
pub(crate) fn reflect(view: [f64; 3], slope: [f64; 2]) -> [f64; 3] {
    let length2 = 1.0 + slope[0] * slope[0] + slope[1] * slope[1];
    let h = [slope[0], slope[1], 1.0];
    let along = h[0] * view[0] + h[1] * view[1] + view[2];
    core::array::from_fn(|i| 2.0 * along / length2 * h[i] - view[i])
}

/// Steradians of lights per unit of slope area: 4 (v·h) cos³δ.
pub(crate) fn jacobian(view: [f64; 3], slope: [f64; 2]) -> f64 {
    let length2 = 1.0 + slope[0] * slope[0] + slope[1] * slope[1];
    4.0 * (slope[0] * view[0] + slope[1] * view[1] + view[2]) / (length2 * length2)
}
