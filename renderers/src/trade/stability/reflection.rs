//! Glossy reflection towards grazing angles and towards mirrors; boundaries of glass.

use core::f64::consts::PI;

use spectral_core::Real;
use spectral_core::brdf::{Brdf as _, Variant, Ward};
use spectral_core::fresnel;

use super::{Sweep, by_name, domain, powers, steps};
use crate::brdf::albedo;
use crate::trade::plan::Random;

/// All sweeps of reflection.
pub(super) fn sweeps(quick: bool) -> Result<Vec<Sweep>, String> {
    let [single, double] = [of::<f32>("f32", steps(quick)), of::<f64>("f64", steps(quick))];
    Ok(by_name(single.into_iter().chain(double)))
}

/// A view at a height over the horizon in radians.
fn view<R: Real>(height: f64) -> [R; 3] {
    [R::from_f64(height.cos()), R::ZERO, R::from_f64(height.sin())]
}

/// How far the largest weight of samples is above 1.
fn excess<R: Real>(alpha: f64, height: f64) -> Option<f64> {
    let model = Ward::new(Variant::Balanced, R::from_f64(alpha), R::from_f64(alpha)).ok()?;
    let mut random = Random::new(7, 0);
    let weights = (0..256).map(|_| {
        let u = [(); 3].map(|()| R::from_f64(random.unit()));
        model.sample(view(height), u).map_or(f64::NAN, |sample| sample.weight.to_f64())
    });
    // NaN stays NaN.
    let largest = weights.fold(0.0, |m: f64, w| if w > m || w.is_nan() { w } else { m });
    Some(if largest.is_nan() { largest } else { (largest - 1.0).max(0.0) })
}

fn of<R: Real>(kind: &str, steps: i32) -> Vec<Sweep> {
    let single = kind == "f32";
    let epsilon = R::EPSILON.to_f64();
    let weight = "brdf: the weight of a sample of the balanced model is at most 1, for all angles and any roughness (rounding: 8 ε)";
    let grazing = Sweep::new(
        [
            "largest weight of samples over grazing angles, α = 0.1",
            kind,
            "height over the horizon (rad)",
            "excess over 1",
        ],
        domain([1e-30, 1.0], 8.0 * epsilon, weight),
        &powers(-30, 0, steps),
        |height| excess::<R>(0.1, height),
    );
    let rough = Sweep::new(
        ["largest weight of samples over roughness, at 1°", kind, "roughness α", "excess over 1"],
        domain([1e-6, 100.0], 8.0 * epsilon, weight),
        &powers(-8, 3, steps),
        |alpha| excess::<R>(alpha, f64::to_radians(1.0)),
    );
    let quadrature = |alpha: f64, height: f64| {
        let degrees = 90.0 - height.to_degrees();
        let truth = albedo(Variant::Balanced, [alpha; 2], [degrees, 0.0]).ok()?.value;
        let model = Ward::new(Variant::Balanced, R::from_f64(alpha), R::from_f64(alpha)).ok()?;
        Some((model, truth))
    };
    // Single precision has no accuracy of its own documented here.
    let stated = |range, tolerance, source| if single { None } else { domain(range, tolerance, source) };
    let by_rule = "Ward::albedo_by_quadrature: within 2e-5 relative (f64; α from 0.01 to 1, θ to 89°)";
    let one_degree = f64::to_radians(1.0);
    let albedo_grazing = Sweep::new(
        ["albedo by quadrature over grazing angles, α = 0.1", kind, "height over the horizon (rad)", "relative error"],
        stated([one_degree, PI / 2.0], 2e-5, by_rule),
        &powers(-6, 0, steps.min(2)),
        |height| quadrature(0.1, height).map(|(m, truth)| m.albedo_by_quadrature(view(height)).to_f64() / truth - 1.0),
    );
    let albedo_rough = Sweep::new(
        ["albedo by quadrature over roughness, at 30°", kind, "roughness α", "relative error"],
        stated([0.01, 1.0], 2e-5, by_rule),
        &powers(-6, 1, steps.min(2)),
        |alpha| {
            let height = PI / 6.0;
            quadrature(alpha, height).map(|(m, truth)| m.albedo_by_quadrature(view(height)).to_f64() / truth - 1.0)
        },
    );
    let fit = "Ward::albedo of the balanced model, isotropic and with α ≤ 1: by a fit within 2e-4";
    let fitted = Sweep::new(
        ["fitted albedo over grazing angles, α = 0.1", kind, "height over the horizon (rad)", "relative error"],
        domain([1e-6, PI / 2.0], 2e-4, fit),
        &powers(-6, 0, steps.min(2)),
        |height| quadrature(0.1, height).map(|(m, truth)| m.albedo(view(height)).to_f64() / truth - 1.0),
    );
    let fitted_rough = Sweep::new(
        ["fitted albedo over roughness, at 30°", kind, "roughness α", "relative error"],
        domain([1e-6, 1.0], 2e-4, fit),
        &powers(-6, 0, steps.min(2)),
        |alpha| quadrature(alpha, PI / 6.0).map(|(m, truth)| m.albedo(view(PI / 6.0)).to_f64() / truth - 1.0),
    );
    let boundary = Sweep::new(
        ["reflectance of glass over grazing angles", kind, "cosine of incidence", "error"],
        None,
        &powers(-30, 0, steps),
        |cosine| {
            Some(fresnel::dielectric(R::from_f64(cosine), R::from_f64(1.5))?.0.to_f64() - reflectance(cosine, 1.5))
        },
    );
    vec![grazing, rough, albedo_grazing, albedo_rough, fitted, fitted_rough, boundary]
}

/// Fresnel's reflectance by the squares of tangents and sines of angles, written another way.
fn reflectance(cosine: f64, eta: f64) -> f64 {
    let g = (eta * eta - 1.0 + cosine * cosine).sqrt();
    let s = (g - cosine) / (g + cosine);
    let p = (cosine * (g + cosine) - 1.0) / (cosine * (g - cosine) + 1.0);
    0.5 * s * s * (1.0 + p * p)
}
