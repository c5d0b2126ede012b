//! Albedos by quadrature over slopes, denser than the core's.

use spectral_core::Real;
use spectral_core::brdf::{Brdf, Lambert};

use super::reflectance::{Half, Model, direction, glossy, schlicks, wards};
use crate::accuracy::gauge::Gauge;
use crate::accuracy::wide::{Wide, wide, wides};
use crate::dense::gauss_legendre;

/// Azimuths of half a turn, and points along each.
const AZIMUTHS: usize = 48;
const POINTS: usize = 20;

/// The rules for both.
struct Rules([Vec<[f64; 2]>; 2]);

impl Rules {
    fn new() -> Self {
        Self([AZIMUTHS, POINTS].map(gauss_legendre))
    }

    /// ∫ f cos θ dω: the mean weight of slopes, ∫ dF ∫ (w(s) + w(−s))/2 dψ/π, with the points dense towards the horizon.
    fn albedo(&self, model: &Model, view: [Wide; 3]) -> Wide {
        let [around, along] = &self.0;
        let [a, b] = model.stretch();
        // From where the slope is across the view to where it is again: weights aren't smooth there.
        let start = (-(a * view[0])).atan2(b * view[1]);
        let mut total = Wide::ZERO;
        for [node, weight] in around {
            let (sin, cos) = (start + Wide::PI * *node).sin_cos();
            total += over_slopes(model, view, [a * cos, b * sin], along) * *weight;
        }
        total * 0.5
    }
}

/// ∫ (w(s) + w(−s)) dF along the azimuth of a stretched one.
fn over_slopes(model: &Model, view: [Wide; 3], [x, y]: [Wide; 2], rule: &[[f64; 2]]) -> Wide {
    let length = x.hypot(y);
    let azimuth = [x / length, y / length];
    let along = azimuth[0] * view[0] + azimuth[1] * view[1];
    let far = (along.abs() + along.hypot(view[2])) / view[2];
    let mut total = Wide::ZERO;
    for side in [1.0, -1.0] {
        let end = if along * side > 0.0 { far } else { 1.0 / far };
        // Where both cosines are equal Neumann's model has a kink.
        let kink = (along * side / view[2]).max(Wide::ZERO).min(end);
        for limits in [[Wide::ZERO, kink], [kink, end]] {
            total += part(model, view, azimuth.map(|c| c * side), length, limits, rule);
        }
    }
    total
}

/// ∫ w dF between two lengths of slopes, along an azimuth.
fn part(
    model: &Model,
    view: [Wide; 3],
    azimuth: [Wide; 2],
    length: Wide,
    [from, to]: [Wide; 2],
    rule: &[[f64; 2]],
) -> Wide {
    let (low, high) = (model.chart(from, length), model.chart(to, length));
    if !(high > low) {
        return Wide::ZERO;
    }
    let mut sum = Wide::ZERO;
    for [node, weight] in rule {
        // Towards the end by the square: weights go to zero there as roots at worst.
        let rest = 1.0 - *node;
        let (epsilon, density) = model.unchart(low + (high - low) * (1.0 - rest * rest), length);
        let slope = azimuth.map(|c| c * epsilon);
        sum += model.weight(&Half::reflected(slope, view)) * density * (weight * 2.0 * rest);
    }
    sum * (high - low)
}

/// Six polar angles up to 75°, each at a random azimuth.
fn measure<R: Real>(gauge: &mut Gauge, function: impl Fn([R; 3]) -> R, exact: impl Fn([Wide; 3]) -> Wide) {
    for polar in [0.0, 0.3, 0.6, 0.9, 1.1, 1.3] {
        let azimuth = 6.0 * gauge.rng().unit();
        gauge.special(&[polar, azimuth]);
        let view = direction(R::from_f64(polar), R::from_f64(azimuth));
        gauge.compare(function(view), exact(wides(view)));
    }
}

const VIEWS: &str = "θ_v = 0, 0.3, 0.6, 0.9, 1.1, 1.3";

/// Ward's family by quadrature.
pub fn ward_by_quadrature<R: Real>(gauge: &mut Gauge) {
    gauge.note(VIEWS);
    gauge.note("all variants; α, β = 0.1, 0.1; 0.02, 0.3; 1, 0.5");
    let rules = Rules::new();
    wards(|ward, model| measure::<R>(gauge, |v| ward.albedo_by_quadrature(v), |v| rules.albedo(&model, v)));
}

/// Ward's family, the balanced isotropic one by its fit.
pub fn ward<R: Real>(gauge: &mut Gauge) {
    gauge.note(VIEWS);
    gauge.note("all variants; α, β = 0.1, 0.1; 0.02, 0.3; 1, 0.5");
    let rules = Rules::new();
    wards(|ward, model| measure::<R>(gauge, |v| ward.albedo(v), |v| rules.albedo(&model, v)));
}

/// Schlick's model.
pub fn schlick<R: Real>(gauge: &mut Gauge) {
    gauge.note(VIEWS);
    gauge.note("r, p = 0.02, 1; 0.1, 0.5; 0.3, 0.2; 0.5, 1; 0.8, 0.7; 1, 1");
    let rules = Rules::new();
    schlicks(|schlick, model, [diffuse, glossy]| {
        let exact = |v: [Wide; 3]| if glossy > 0.0 { diffuse + glossy * rules.albedo(&model, v) } else { diffuse };
        measure::<R>(gauge, |v| schlick.albedo(v), exact);
    });
}

/// A coat over a body.
pub fn glossy_albedo<R: Real>(gauge: &mut Gauge) {
    gauge.note(VIEWS);
    gauge.note("balanced, α = 0.2, ρ_d = 0.3, ρ_s = 0.5");
    let rules = Rules::new();
    let Some((brdf, model, [diffuse, specular])) = glossy::<R>() else { return gauge.require(false) };
    measure::<R>(gauge, |v| brdf.albedo(v), |v| diffuse + specular * rules.albedo(&model, v));
}

/// 1.
pub fn lambert<R: Real>(gauge: &mut Gauge) {
    gauge.note(VIEWS);
    measure::<R>(gauge, |v| Lambert.albedo(v), |_| Wide::ONE);
    gauge.require(wide(Lambert.albedo([R::ZERO, R::ZERO, -R::ONE])) == 0.0);
}
