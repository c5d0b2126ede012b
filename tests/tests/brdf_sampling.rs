//! Sampling of reflectance models against their densities; inversion; what sampling without rejection gains.
#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "a test stops at what should not be, and prints what it measured"
)]
#![allow(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    clippy::cast_precision_loss,
    reason = "small counts, and single precision on purpose"
)]

mod brdf_support;

use core::f64::consts::{FRAC_PI_2, TAU};

use brdf_support::{cast, jacobian, log_uniform, numbers, reflect, upper, vector, ward};
use spectral_core::brdf::{Brdf, Glossy, Lambert, Sample, Schlick, Variant, Ward};
use spectral_tests::dense::gauss_legendre;
use spectral_tests::statistics::{ChiSquare, Rng};

const SAMPLES: u32 = 40_000;
const SIGNIFICANCE: f64 = 1e-4;
/// Cells of scaled slope and of azimuth.
const RADIAL: usize = 14;
const AROUND: usize = 16;

/// Polar angles of views in degrees.
const ANGLES: [f64; 6] = [0.0, 30.0, 60.0, 80.0, 89.0, 89.99];

/// A chart of lights: the slope of the half vector over a scale along each axis is y (cos ψ, sin ψ); cells are equal parts
/// of ψ and of p = y/(1 + y), so that lobes with any tail fit.
struct Chart {
    view: [f64; 3],
    scale: [f64; 2],
}

impl Chart {
    /// y/(1 + y), in [0, 1), and the turn of ψ, in [0, 1).
    fn place(&self, light: [f64; 3]) -> [f64; 2] {
        let height = light[2] + self.view[2];
        let [x, y]: [f64; 2] = core::array::from_fn(|i| (light[i] + self.view[i]) / height / self.scale[i]);
        let length = x.hypot(y);
        [length / (1.0 + length), (y.atan2(x) / TAU).rem_euclid(1.0)]
    }

    /// The light of a place, and steradians per unit of place area; `None` below the horizon.
    fn light(&self, [p, turn]: [f64; 2]) -> Option<([f64; 3], f64)> {
        let y = p / (1.0 - p);
        let (sin, cos) = (TAU * turn).sin_cos();
        let slope = [y * cos * self.scale[0], y * sin * self.scale[1]];
        let light = reflect(self.view, slope);
        let area = self.scale[0] * self.scale[1] * y * TAU / ((1.0 - p) * (1.0 - p));
        (light[2] > 0.0).then(|| (light, jacobian(self.view, slope) * area))
    }

    /// p beyond which an azimuth's lights are below the horizon.
    fn horizon(&self, turn: f64) -> f64 {
        let (sin, cos) = (TAU * turn).sin_cos();
        let unit = [cos * self.scale[0], sin * self.scale[1]];
        let length = unit[0].hypot(unit[1]);
        let along = (unit[0] * self.view[0] + unit[1] * self.view[1]) / length;
        let root = along.hypot(self.view[2]);
        let y = if along > 0.0 { (along + root) / self.view[2] } else { self.view[2] / (root - along) } / length;
        y / (1.0 + y)
    }

    /// ∫ pdf dω over each cell.
    fn expected(&self, pdf: impl Fn([f64; 3]) -> f64) -> Vec<f64> {
        let (fine, coarse) = (gauss_legendre(24), gauss_legendre(16));
        let mut cells = vec![0.0; RADIAL * AROUND];
        // The azimuth perpendicular to the view, where lights change from near the horizon to far, is a limit of pieces.
        let across = ((self.scale[0] * self.view[0]).atan2(-self.scale[1] * self.view[1]) / TAU).rem_euclid(0.5);
        for column in 0..AROUND {
            let ends = [column, column + 1].map(|i| i as f64 / AROUND as f64);
            let middle = [across, across + 0.5].into_iter().find(|m| *m > ends[0] && *m < ends[1]);
            let pieces = middle.map_or_else(|| vec![(ends[0], ends[1])], |m| vec![(m, ends[0]), (m, ends[1])]);
            for (from, to) in pieces {
                for &[node, weight] in &fine {
                    // Graded towards the first end.
                    let turn = from + (to - from) * node.powi(3);
                    let weight = (to - from).abs() * 3.0 * node * node * weight;
                    self.column(turn, weight, &pdf, &coarse, &mut cells[column..]);
                }
            }
        }
        cells
    }

    /// Adds an azimuth's share of the cells of its column.
    fn column(&self, turn: f64, weight: f64, pdf: &impl Fn([f64; 3]) -> f64, rule: &[[f64; 2]], cells: &mut [f64]) {
        let horizons = [self.horizon(turn), self.horizon(turn + 0.5)];
        for row in 0..RADIAL {
            let mut limits = vec![row as f64 / RADIAL as f64, (row + 1) as f64 / RADIAL as f64];
            limits.extend(horizons.iter().filter(|h| **h > limits[0] && **h < limits[1]).copied().collect::<Vec<_>>());
            limits.sort_by(f64::total_cmp);
            for pair in limits.windows(2) {
                for &[node, w] in rule {
                    let p = pair[0] + (pair[1] - pair[0]) * node;
                    if let Some((light, area)) = self.light([p, turn]) {
                        cells[row * AROUND] += (pair[1] - pair[0]) * w * weight * pdf(light) * area;
                    }
                }
            }
        }
    }
}

/// Tests a sampler whose density integrates to the probability of `Some`; `rejected` samples are a cell of their own.
fn chi_square(
    chart: &Chart,
    pdf: impl Fn([f64; 3]) -> f64,
    mut sample: impl FnMut() -> Option<[f64; 3]>,
) -> (ChiSquare, f64) {
    let mut expected = chart.expected(pdf);
    let mass: f64 = expected.iter().sum();
    let mut observed = vec![0_u64; RADIAL * AROUND + 1];
    for _ in 0..SAMPLES {
        let cell = sample().map_or(RADIAL * AROUND, |light| {
            let [p, turn] = chart.place(light);
            let row = ((p * RADIAL as f64) as usize).min(RADIAL - 1);
            row * AROUND + ((turn * AROUND as f64) as usize).min(AROUND - 1)
        });
        observed[cell] += 1;
    }
    expected.push((1.0 - mass).max(0.0));
    // A density that integrates to 1 leaves nothing for the last cell but the quadrature's error.
    if (mass - 1.0).abs() <= 1e-4 {
        expected[RADIAL * AROUND] = 0.0;
    }
    expected.iter_mut().for_each(|e| *e *= f64::from(SAMPLES));
    (ChiSquare::new(&observed, &expected), mass)
}

fn wards() -> Vec<Ward<f64>> {
    let roughness = [(0.001, 0.001), (0.02, 0.02), (0.15, 0.15), (0.5, 0.5), (1.0, 1.0), (0.3, 0.05), (0.01, 0.4)];
    Variant::ALL.into_iter().flat_map(|v| roughness.map(|(a, b)| ward(v, a, b))).collect()
}

fn views() -> Vec<[f64; 3]> {
    ANGLES.into_iter().map(|d| vector(f64::to_radians(d), 0.7)).collect()
}

/// Accepts all tests together at the level of [`SIGNIFICANCE`].
fn verdict(name: &str, results: &[(String, ChiSquare)]) {
    let least = results.iter().map(|(_, c)| c.p_value).fold(1.0, f64::min);
    println!("{name}: {} tests, least p {least:.2e}", results.len());
    let count = u32::try_from(results.len()).unwrap();
    for (case, result) in results {
        assert!(result.accepts(SIGNIFICANCE, count), "{name} {case}: {result}");
    }
}

#[test]
fn antithetic_half_vectors_follow_their_density() {
    let (mut rng, mut results) = (Rng::new(1), Vec::new());
    for model in wards() {
        for view in views() {
            let chart = Chart { view, scale: model.alpha() };
            let draw = || model.sample(view, numbers(&mut rng)).map(|s| s.direction);
            let (result, mass) = chi_square(&chart, |light| model.pdf(light, view), draw);
            assert!((mass - 1.0).abs() <= 1e-4, "{model:?} {view:?}: {mass}");
            results.push((format!("{model:?} {view:?}"), result));
        }
    }
    verdict("antithetic", &results);
}

#[test]
fn wards_half_vectors_follow_their_density() {
    let (mut rng, mut results) = (Rng::new(2), Vec::new());
    for model in wards().into_iter().filter(|m| m.variant() == Variant::Balanced) {
        for view in views() {
            let chart = Chart { view, scale: model.alpha() };
            let draw = || model.sample_half_vector(view, [rng.unit(), rng.unit()]).map(|s| s.direction);
            let (result, _) = chi_square(&chart, |light| model.half_vector_pdf(light, view), draw);
            results.push((format!("{model:?} {view:?}"), result));
        }
    }
    verdict("Ward's", &results);
}

/// A model, and the scale of its half vectors' slopes.
type Named = (String, Box<dyn Brdf<f64>>, [f64; 2]);

#[test]
fn the_other_models_follow_their_density() {
    let (mut rng, mut results) = (Rng::new(3), Vec::new());
    let mut models: Vec<Named> = vec![("lambert".into(), Box::new(Lambert), [1.0; 2])];
    for (roughness, isotropy) in [(0.0, 0.5), (0.02, 1.0), (0.2, 0.3), (0.45, 1.0), (0.7, 0.2), (1.0, 1.0)] {
        let scale = f64::max(roughness, 0.01).sqrt();
        let model = Schlick::new(roughness, isotropy).unwrap();
        models.push((format!("{model:?}"), Box::new(model), [scale; 2]));
    }
    for (diffuse, specular) in [(0.5, 0.5), (0.1, 0.0), (0.0, 0.0), (0.0, 0.9)] {
        let model = Glossy::new(diffuse, specular, ward(Variant::WardDuer, 0.2, 0.3)).unwrap();
        models.push((format!("{model:?}"), Box::new(model), [0.3; 2]));
    }
    for (name, model, scale) in &models {
        for view in views() {
            let chart = Chart { view, scale: *scale };
            let draw = || model.sample(view, numbers(&mut rng)).map(|s| s.direction);
            let (result, mass) = chi_square(&chart, |light| model.pdf(light, view), draw);
            assert!((mass - 1.0).abs() <= 2e-3, "{name} {view:?}: {mass}");
            results.push((format!("{name} {view:?}"), result));
        }
    }
    verdict("others", &results);
}

/// Negative control: a density of a slightly different roughness is found out.
#[test]
fn a_wrong_density_fails() {
    let mut rng = Rng::new(4);
    let (model, other) = (ward(Variant::Balanced, 0.15, 0.15), ward(Variant::Balanced, 0.16, 0.15));
    let view = vector(1.0, 0.7);
    let chart = Chart { view, scale: model.alpha() };
    let draw = || model.sample(view, numbers(&mut rng)).map(|s| s.direction);
    let (result, _) = chi_square(&chart, |light| other.pdf(light, view), draw);
    assert!(!result.accepts(SIGNIFICANCE, 1000), "{result}");
}

/// f cos θ against weight · pdf, and pdf against itself, relative to what the light's distance from the horizon leaves.
fn consistent(model: &dyn Brdf<f64>, view: [f64; 3], sample: Sample<f64>, density: f64, epsilon: f64) -> bool {
    let low = sample.direction[2].min(view[2]);
    let tolerance = 1e4 * epsilon / low.min(1.0);
    if sample.pdf * 1e-12 > f64::MAX || tolerance > 0.1 {
        return true;
    }
    let value = model.evaluate(sample.direction, view) * sample.direction[2];
    let product = sample.weight * sample.pdf;
    (density / sample.pdf - 1.0).abs() <= tolerance && (value - product).abs() <= tolerance * value
}

#[test]
fn samples_agree_with_evaluation_density_and_inverse() {
    let mut rng = Rng::new(5);
    let mut checked = 0_u32;
    for i in 0..100_000_usize {
        let view = upper(&mut rng);
        let (alpha, beta) = (log_uniform(&mut rng, 0.05, 1.0), log_uniform(&mut rng, 0.05, 1.0));
        let model = ward(Variant::ALL[i % 4], alpha, beta);
        let schlick = Schlick::new(0.05 + 0.95 * rng.unit(), 0.1 + 0.9 * rng.unit()).unwrap();
        let glossy = Glossy::new(0.4, 0.6, model).unwrap();
        let models: [&dyn Brdf<f64>; 4] = [&model, &schlick, &glossy, &Lambert];
        for model in models {
            let sample = model.sample(view, numbers(&mut rng)).unwrap();
            let light = sample.direction;
            let length = light.iter().map(|x| x * x).sum::<f64>();
            assert!((length - 1.0).abs() <= 1e-13 && light[2] > 0.0, "{light:?}");
            assert!(consistent(model, view, sample, model.pdf(light, view), f64::EPSILON), "{i} {view:?} {sample:?}");
            let u = model.invert(light, view).unwrap();
            assert!(u.iter().all(|x| (0.0..1.0).contains(x)), "{u:?}");
            let again = model.sample(view, u).unwrap();
            let distance = (0..3).map(|k| (again.direction[k] - light[k]).powi(2)).sum::<f64>().sqrt();
            // u near 1 is a coarse measure of a lobe's tail.
            let tail = f64::EPSILON / (1.0 - u[0]);
            if view[2] > 1e-3 && light[2] > 1e-6 {
                checked += 1;
                assert!(distance <= 1e-9 + 10.0 * tail, "{i} {view:?} {light:?} {u:?}: {distance:e}");
            }
        }
        if let Some(sample) = model.sample_half_vector(view, [rng.unit(), rng.unit()]) {
            let density = model.half_vector_pdf(sample.direction, view);
            assert!(consistent(&model, view, sample, density, f64::EPSILON), "half {i} {view:?} {sample:?}");
        }
    }
    assert!(checked > 350_000, "{checked}");
}

/// The bound that the module's documentation proves.
#[test]
fn weights_of_the_balanced_model_are_at_most_one() {
    let mut rng = Rng::new(6);
    let mut highest = [0.0_f64; 2];
    for i in 0..1_000_000_u32 {
        let theta = if i % 2 == 0 { (1.0 - rng.unit()).acos() } else { FRAC_PI_2 - log_uniform(&mut rng, 1e-12, 1e-2) };
        let view = vector(theta, TAU * rng.unit());
        let variant = if i % 3 == 0 { Variant::WardNeumann } else { Variant::Balanced };
        let model = ward(variant, log_uniform(&mut rng, 1e-4, 100.0), log_uniform(&mut rng, 1e-4, 100.0));
        let u = numbers(&mut rng);
        let weight = model.sample(view, u).unwrap().weight;
        highest[0] = highest[0].max(weight);
        let [alpha, beta] = model.alpha();
        let single = Ward::new(variant, alpha as f32, beta as f32).unwrap();
        let weight = f64::from(single.sample(cast(view), cast(u)).unwrap().weight);
        highest[1] = highest[1].max(weight);
    }
    println!("highest weight {:.17} in f64, {:.9} in f32", highest[0], highest[1]);
    assert!(highest[0] <= 1.0 + 4.0 * f64::EPSILON && highest[1] <= 1.0 + 4.0 * f64::from(f32::EPSILON));
}

/// (2.21) with the arc tangents, and the weights as printed: (2.23), (2.32).
#[test]
fn half_vectors_and_weights_are_those_printed() {
    let mut rng = Rng::new(7);
    for _ in 0..20_000 {
        let (alpha, beta, view) = (log_uniform(&mut rng, 0.01, 1.0), log_uniform(&mut rng, 0.01, 1.0), upper(&mut rng));
        let [s, t] = [rng.unit(), rng.unit()];
        let phi = (beta * (TAU * t).sin()).atan2(alpha * (TAU * t).cos());
        let q = (phi.cos() / alpha).powi(2) + (phi.sin() / beta).powi(2);
        let delta = (-(-s).ln_1p() / q).sqrt().atan();
        let slope = [delta.tan() * phi.cos(), delta.tan() * phi.sin()];
        let light = reflect(view, slope);
        if light[2].abs() < 1e-9 {
            continue;
        }
        for variant in [Variant::Balanced, Variant::WardDuer] {
            let found = ward(variant, alpha, beta).sample_half_vector(view, [s, t]);
            assert_eq!(found.is_some(), light[2] > 0.0);
            let Some(found) = found else { continue };
            let (vz, lz) = (view[2], light[2]);
            let cosine: f64 = (0..3).map(|i| view[i] * light[i]).sum();
            let weight = match variant {
                Variant::Balanced => 2.0 / (1.0 + vz / lz),
                _ => (lz + vz).powi(3) / (4.0 * vz * (1.0 + cosine)),
            };
            let scale = 1e-13 / lz.min(vz).min(1.0 + cosine);
            assert!((found.weight / weight - 1.0).abs() <= 10.0 * scale, "{variant} {} {weight}", found.weight);
            assert!((0..3).all(|i| (found.direction[i] - light[i]).abs() <= 1e-12), "{:?} {light:?}", found.direction);
        }
    }
}

/// Mean and variance of weights, rejected samples counting 0, by midpoints of a fine grid of numbers.
fn moments(mut weight: impl FnMut([f64; 2]) -> f64) -> [f64; 2] {
    let (n, m) = (400_u32, 400_u32);
    let mut sums = [0.0; 2];
    for i in 0..n {
        for j in 0..m {
            let w = weight([(f64::from(i) + 0.5) / f64::from(n), (f64::from(j) + 0.5) / f64::from(m)]);
            sums[0] += w;
            sums[1] += w * w;
        }
    }
    let [mean, square] = sums.map(|s| s / f64::from(n * m));
    [mean, square - mean * mean]
}

/// Variance of the estimate of the albedo per sample: Ward's sampling with (2.32) and rejection, against antithetic
/// half vectors.
#[test]
fn antithetic_half_vectors_vary_less() {
    println!("alpha theta   albedo  rejected  variance (2.32)  antithetic  ratio");
    let (mut smallest, mut grazing) = (f64::INFINITY, f64::INFINITY);
    for alpha in [0.02, 0.1, 0.3, 1.0] {
        for degrees in [10.0, 45.0, 70.0, 80.0, 85.0, 89.0, 89.9] {
            let model = ward(Variant::Balanced, alpha, alpha);
            let view = vector(f64::to_radians(degrees), 0.3);
            let mut rejected = 0_u32;
            let [mean, old] = moments(|u| {
                let sample = model.sample_half_vector(view, u);
                rejected += u32::from(sample.is_none());
                sample.map_or(0.0, |s| s.weight)
            });
            let [again, new] = moments(|[a, b]| model.sample(view, [a, b, 0.5]).unwrap().weight);
            assert!((mean - again).abs() <= 3e-3, "{mean} {again}");
            println!(
                "{alpha:5} {degrees:5} {again:8.5} {:8.2}% {old:16.3e} {new:11.3e} {:6.1}",
                f64::from(rejected) / 1600.0,
                old / new
            );
            smallest = smallest.min(old / new);
            if degrees >= 85.0 && alpha >= 0.1 {
                grazing = grazing.min(old / new);
            }
        }
    }
    println!("least ratio {smallest:.2}, from 85° on for a roughness of 0.1 and more {grazing:.1}");
    assert!(smallest >= 1.0 && grazing >= 4.0);
}
