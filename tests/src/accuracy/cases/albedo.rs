//! Albedos by quadrature over slopes, denser than the core's.

use spectral_core::Real;
use spectral_core::brdf::{Brdf, Lambert};

use super::reflectance::{Half, Model, direction, glossy, schlicks, wards};
use crate::accuracy::gauge::{Axis, Gauge};
use crate::accuracy::wide::{Wide, wide, wides};
use crate::dense::gauss_legendre;

/// Azimuths of half a turn, and points along each.
const AZIMUTHS: usize = 64;
const POINTS: usize = 20;

/// ∫ f cos θ dω: the mean weight of slopes, ∫ dF ∫ (w(s) + w(−s))/2 dψ/π, with the points dense towards the horizon.
fn albedo(model: &Model, view: [Wide; 3], rule: &[[f64; 2]]) -> Wide {
    let mut total = Wide::ZERO;
    for k in 0..AZIMUTHS {
        let psi = Wide::PI * ((k as f64 + 0.5) / AZIMUTHS as f64);
        let (sin, cos) = psi.sin_cos();
        let [a, b] = model.stretch();
        let (x, y) = (a * cos, b * sin);
        let length = x.hypot(y);
        let azimuth = [x / length, y / length];
        let along = azimuth[0] * view[0] + azimuth[1] * view[1];
        let far = (along.abs() + along.hypot(view[2])) / view[2];
        for side in [1.0, -1.0] {
            let end = if along * side > 0.0 { far } else { 1.0 / far };
            // Where both cosines are equal Neumann's model has a kink.
            let kink = (along * side / view[2]).max(Wide::ZERO).min(end);
            total += part(model, view, azimuth, side, length, [Wide::ZERO, kink], rule);
            total += part(model, view, azimuth, side, length, [kink, end], rule);
        }
    }
    total / (2.0 * AZIMUTHS as f64)
}

/// ∫ w dF between two lengths of slopes, along an azimuth.
fn part(
    model: &Model,
    view: [Wide; 3],
    azimuth: [Wide; 2],
    side: f64,
    length: Wide,
    [from, to]: [Wide; 2],
    rule: &[[f64; 2]],
) -> Wide {
    let (low, high) = (model.chart(from, length), model.chart(to, length));
    let mut sum = Wide::ZERO;
    for [node, weight] in rule {
        // Towards the end by the square: weights go to zero there as roots at worst.
        let rest = 1.0 - *node;
        let (epsilon, density) = model.unchart(low + (high - low) * (1.0 - rest * rest), length);
        let slope = azimuth.map(|c| c * epsilon * side);
        sum += model.weight(&Half::reflected(slope, view)) * density * (weight * 2.0 * rest);
    }
    sum * (high - low)
}

fn views() -> [Axis; 2] {
    [Axis::linear("θ_v", 0.0, 1.3).list(&[0.5]), Axis::linear("φ_v", 0.1, 3.0)]
}

fn measure<R: Real>(gauge: &mut Gauge, function: impl Fn([R; 3]) -> R, exact: impl Fn([Wide; 3]) -> Wide) {
    gauge.effort(0.002);
    gauge.few(6);
    gauge.each(&views(), |gauge, [polar, azimuth]: [R; 2]| {
        let view = direction(polar, azimuth);
        gauge.compare(function(view), exact(wides(view)));
    });
}

/// Ward's family by quadrature.
pub fn ward_by_quadrature<R: Real>(gauge: &mut Gauge) {
    gauge.note("all variants; α, β = 0.1, 0.1; 0.02, 0.3; 1, 0.5");
    let rule = gauss_legendre(POINTS);
    wards(|ward, model| measure::<R>(gauge, |v| ward.albedo_by_quadrature(v), |v| albedo(&model, v, &rule)));
}

/// Ward's family, the balanced isotropic one by its fit.
pub fn ward<R: Real>(gauge: &mut Gauge) {
    gauge.note("all variants; α, β = 0.1, 0.1; 0.02, 0.3; 1, 0.5");
    let rule = gauss_legendre(POINTS);
    wards(|ward, model| measure::<R>(gauge, |v| ward.albedo(v), |v| albedo(&model, v, &rule)));
}

/// Schlick's model.
pub fn schlick<R: Real>(gauge: &mut Gauge) {
    gauge.note("r, p = 0.02, 1; 0.1, 0.5; 0.3, 0.2; 0.5, 1; 0.8, 0.7; 1, 1");
    let rule = gauss_legendre(POINTS);
    schlicks(|schlick, model, [diffuse, glossy]| {
        let exact = |v: [Wide; 3]| if glossy > 0.0 { diffuse + glossy * albedo(&model, v, &rule) } else { diffuse };
        measure::<R>(gauge, |v| schlick.albedo(v), exact);
    });
}

/// A coat over a body.
pub fn glossy_albedo<R: Real>(gauge: &mut Gauge) {
    gauge.note("balanced, α = 0.2, ρ_d = 0.3, ρ_s = 0.5");
    let rule = gauss_legendre(POINTS);
    let Some((brdf, model, [diffuse, specular])) = glossy::<R>() else { return gauge.require(false) };
    measure::<R>(gauge, |v| brdf.albedo(v), |v| diffuse + specular * albedo(&model, v, &rule));
}

/// 1.
pub fn lambert<R: Real>(gauge: &mut Gauge) {
    measure::<R>(gauge, |v| Lambert.albedo(v), |_| Wide::ONE);
    gauge.require(wide(Lambert.albedo([R::ZERO, R::ZERO, -R::ONE])) == 0.0);
}
