//! Reflectance models of the Ward family as formulae: the vector form, the trigonometric form, symmetry, the values that the
//! thesis derives from them.
#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "a test stops at what should not be, and prints what it measured"
)]
#![allow(clippy::cast_possible_truncation, reason = "small counts, and single precision on purpose")]

mod brdf_support;

use core::f64::consts::{FRAC_PI_2, PI, TAU};

use brdf_support::{cast, log_uniform, upper, vector, ward};
use spectral_core::brdf::{Brdf, Schlick, Variant, Ward};
use spectral_tests::accuracy::wide::Wide;
use spectral_tests::statistics::Rng;

const PAIRS: u32 = 1_000_000;

/// exp(−x)'s relative error is x's absolute one. Up to this exponent times ratio of the roughnesses (values down to e⁻¹⁰⁰ of
/// the peak at a ratio of 10), an angle's sine and cosine, correct to ε, leave 10⁻¹².
const LIMIT: f64 = 1000.0;

/// A model and the angles of two directions: anywhere, within 10⁻⁷ of grazing (one, both), of the mirror direction, of both.
struct Case {
    model: Ward<f64>,
    light: [f64; 2],
    view: [f64; 2],
}

impl Case {
    fn draw(rng: &mut Rng, kind: u32) -> Self {
        let variant = Variant::ALL[(rng.bits() % 4) as usize];
        let alpha = log_uniform(rng, 1e-3, 1.0);
        let beta = (alpha * log_uniform(rng, 0.1, 10.0)).clamp(1e-3, 1.0);
        let anywhere = |rng: &mut Rng| (1.0 - rng.unit()).acos();
        let grazing = |rng: &mut Rng| FRAC_PI_2 - log_uniform(rng, 1e-13, 1e-7);
        let mut view = [anywhere(rng), TAU * rng.unit()];
        let mut light = [anywhere(rng), TAU * rng.unit()];
        let near = |rng: &mut Rng| (2.0 * rng.unit() - 1.0) * 1e-7;
        if matches!(kind % 6, 1 | 2 | 5) {
            view[0] = grazing(rng);
        }
        if matches!(kind % 6, 2 | 5) {
            light[0] = grazing(rng);
        }
        if matches!(kind % 6, 3 | 4) {
            light[0] = (view[0] + near(rng)).abs().min(FRAC_PI_2);
        }
        if matches!(kind % 6, 3..=5) {
            light[1] = view[1] + if view[1] < PI { PI } else { -PI } + near(rng);
        }
        if kind % 6 == 4 {
            // Where the exponential is neither 0 nor 1.
            light[0] = (view[0] + (2.0 * rng.unit() - 1.0) * alpha).abs().min(FRAC_PI_2 - 1e-9);
        }
        if kind % 6 == 2 {
            // So near to grazing, only a twist of about this much leaves the half vector a slope of about the roughness.
            let twist = alpha.max(beta) * (light[0].cos() + view[0].cos());
            light[1] = view[1] + if view[1] < PI { PI } else { -PI } + (2.0 * rng.unit() - 1.0) * twist;
        }
        Self { model: ward(variant, alpha, beta), light, view }
    }
}

fn wide_vector([theta, phi]: [f64; 2]) -> [Wide; 3] {
    let (sin, cos) = Wide::from(theta).sin_cos();
    let (sin_phi, cos_phi) = Wide::from(phi).sin_cos();
    [sin * cos_phi, sin * sin_phi, cos]
}

/// The vector form (2.34), and those of the other variants, in double-word arithmetic; with the exponent.
fn exact(model: &Ward<f64>, light: [Wide; 3], view: [Wide; 3]) -> (f64, f64) {
    let sum: [Wide; 3] = core::array::from_fn(|i| light[i] + view[i]);
    let [alpha, beta] = model.alpha().map(Wide::from);
    let (x, y) = (sum[0] / alpha, sum[1] / beta);
    let z2 = sum[2] * sum[2];
    let exponent = (x * x + y * y) / z2;
    let cosines = light[2] * view[2];
    let factor = match model.variant() {
        Variant::Balanced => ((sum[0] * sum[0] + sum[1] * sum[1] + z2) / (z2 * z2)).to_f64(),
        Variant::WardDuer => (0.25 / cosines).to_f64(),
        Variant::Ward => 0.25 / cosines.to_f64().sqrt(),
        Variant::WardNeumann => 0.25 / light[2].to_f64().max(view[2].to_f64()),
    };
    let peak = (1.0 / (Wide::PI * alpha * beta)).to_f64();
    (peak * (-exponent).exp().to_f64() * factor, exponent.to_f64())
}

/// Relative error against what is exact; 0 where it is too small to be a normal number, and is found to be small.
fn relative(found: f64, exact: f64) -> f64 {
    let tiny = f64::MIN_POSITIVE / f64::EPSILON;
    if exact < tiny { if found <= 2.0 * tiny { 0.0 } else { f64::INFINITY } } else { (found / exact - 1.0).abs() }
}

fn row(errors: [f64; 6]) -> String {
    errors.map(|e| format!("{e:.1e}")).join(" ")
}

/// The trigonometric form for angles, the vector form for vectors, each against the vector form in double-word arithmetic
/// for the same angles or vectors: so both are the same function, within 10⁻¹².
///
/// They can't be compared directly everywhere: an angle near π/2 has a cosine of 10⁻⁷ ± 10⁻¹⁶, and so has a vector's z.
#[test]
fn both_forms_are_the_same_function() {
    let mut rng = Rng::new(0x2_26);
    let (mut by_angle, mut by_vector) = ([0.0_f64; 6], [0.0_f64; 6]);
    let (mut relevant, mut within, mut total) = (0_u32, 0_u32, 0_u32);
    for kind in 0..PAIRS {
        let case = Case::draw(&mut rng, kind);
        let slot = (kind % 6) as usize;
        let (light, view) = (wide_vector(case.light), wide_vector(case.view));
        if light[2].to_f64() <= 0.0 || view[2].to_f64() <= 0.0 {
            continue;
        }
        let (truth, exponent) = exact(&case.model, light, view);
        relevant += u32::from(exponent < 50.0);
        total += 1;
        let error = relative(case.model.trigonometric(case.light, case.view), truth);
        let [alpha, beta] = case.model.alpha();
        let stretched = exponent * (alpha / beta).max(beta / alpha);
        let bound = f64::max(1e-12, 4.0 * f64::EPSILON * stretched);
        assert!(error <= bound, "{:?} {:?} {:?}: {error:e}, exponent {exponent}", case.model, case.light, case.view);
        if stretched <= LIMIT {
            by_angle[slot] = by_angle[slot].max(error);
            within += 1;
        }

        let (light, view) = (light.map(Wide::to_f64), view.map(Wide::to_f64));
        let (truth, _) = exact(&case.model, light.map(Wide::from), view.map(Wide::from));
        let error = relative(case.model.evaluate(light, view), truth);
        by_vector[slot] = by_vector[slot].max(error);
        assert!(error <= 1e-12, "{:?} {light:?} {view:?}: {error:e}, exponent {exponent}", case.model);
    }
    println!("largest relative errors (anywhere, one grazing, both, mirror, near it, both grazing and mirror)");
    println!(
        "trigonometric {}\nvector {}; exponent below 50 for {relevant} of {total},
 below {LIMIT} over the ratio of roughnesses for {within}",
        row(by_angle),
        row(by_vector)
    );
    assert!(2 * relevant >= total && total >= PAIRS / 10 * 9);
    assert!(by_angle.into_iter().chain(by_vector).all(|e| e <= 1e-12));
}

/// Directly against each other, within what the rounding of a vector's components amounts to.
#[test]
fn forms_agree_directly_as_far_as_vectors_are_exact() {
    let mut rng = Rng::new(0x2_34);
    let (mut tight, mut worst) = (0_u32, 0.0_f64);
    for kind in 0..PAIRS {
        let case = Case::draw(&mut rng, kind);
        let (light, view) = (vector(case.light[0], case.light[1]), vector(case.view[0], case.view[1]));
        if light[2] <= 0.0 || view[2] <= 0.0 {
            continue;
        }
        let (_, exponent) = exact(&case.model, light.map(Wide::from), view.map(Wide::from));
        let least = case.model.alpha()[0].min(case.model.alpha()[1]);
        let low = light[2].min(view[2]);
        // Of the half vector's slope over the roughness, and of f's logarithm: twice its root times that, and that squared.
        let slope = 2.0 * f64::EPSILON / least / (light[2] + view[2]);
        let formula = f64::EPSILON * (8.0 + 8.0 * exponent + 1.0 / low);
        let rounding = formula + slope * (2.0 * exponent.sqrt() + slope);
        let angle = case.model.trigonometric(case.light, case.view);
        let error = relative(case.model.evaluate(light, view), angle);
        assert!(
            error <= rounding + 1e-15 || rounding > 0.01,
            "{:?} {:?} {:?}: {error:e}",
            case.model,
            case.light,
            case.view
        );
        if rounding <= 1e-12 {
            tight += 1;
            worst = worst.max(error);
        }
    }
    println!("{tight} pairs in which vectors are exact to 10⁻¹²: largest difference {worst:.1e}");
    assert!(worst <= 1e-12 && tight >= PAIRS / 5);
}

#[test]
fn is_reciprocal_to_the_bit() {
    let mut rng = Rng::new(13);
    for i in 0..100_000_usize {
        let (light, view) = (upper(&mut rng), upper(&mut rng));
        let model = ward(Variant::ALL[i % 4], log_uniform(&mut rng, 1e-3, 1.0), log_uniform(&mut rng, 1e-3, 1.0));
        assert_eq!(model.evaluate(light, view).to_bits(), model.evaluate(view, light).to_bits());
        let angles = [[light[2].acos(), 6.0 * rng.unit()], [view[2].acos(), 6.0 * rng.unit()]];
        let forth = model.trigonometric(angles[0], angles[1]);
        assert_eq!(forth.to_bits(), model.trigonometric(angles[1], angles[0]).to_bits());
        let schlick = Schlick::new(rng.unit(), 1.0 - rng.unit()).unwrap();
        assert_eq!(schlick.evaluate(light, view).to_bits(), schlick.evaluate(view, light).to_bits());
    }
}

/// (2.27): at the mirror direction the balanced model, Ward's and Dür's are 1/(4παβ cos²θ), 1/(4παβ cos θ) for Neumann's and Ward's.
#[test]
fn has_the_closed_form_at_the_mirror_direction() {
    for degrees in [0.0, 10.0, 45.0, 80.0, 89.0, 89.999_999] {
        let (theta, phi) = (f64::to_radians(degrees), 0.7);
        let view = vector(theta, phi);
        let mirror = [-view[0], -view[1], view[2]];
        for variant in Variant::ALL {
            let power = if matches!(variant, Variant::Balanced | Variant::WardDuer) { 2 } else { 1 };
            let known = 1.0 / (4.0 * PI * 0.03 * view[2].powi(power));
            let value = ward(variant, 0.1, 0.3).evaluate(mirror, view);
            assert!(relative(value, known) <= 8.0 * f64::EPSILON, "{variant} {degrees}: {value} {known}");
        }
    }
}

/// (B.1)–(B.3), in the plane of incidence.
#[test]
fn peaks_where_appendix_b_says() {
    let step = 1e-6;
    for (alpha, beta, phi) in [(0.1_f64, 0.1_f64, 0.0_f64), (0.2, 0.2, 1.0), (0.3, 0.1, 0.4), (0.05, 0.2, 2.0)] {
        let model = ward(Variant::Balanced, alpha, beta);
        for degrees in [5.0, 30.0, 60.0, 80.0] {
            let theta = f64::to_radians(degrees);
            let q = (phi.cos() / alpha).powi(2) + (phi.sin() / beta).powi(2);
            let printed = |t: f64| {
                let slope = (t.sin() - theta.sin()) / (t.cos() + theta.cos());
                let below = (t.cos() + theta.cos()).powi(4);
                (-q * slope * slope).exp() / (PI * alpha * beta) * 2.0 * (1.0 + (t + theta).cos()) / below
            };
            let value = |t: f64| model.trigonometric([theta, phi], [t, phi + PI]);
            for t in [0.1, 0.5, 1.0, theta, 1.5] {
                assert!((value(t) - printed(t)).abs() <= 1e-12 * printed(t), "B.1 at {t}");
            }
            let slope = (value(theta + step) - value(theta - step)) / (2.0 * step);
            let b2 = theta.sin() / theta.cos().powi(3) / (4.0 * PI * alpha * beta);
            // Central differences: h²·f‴/6 and rounding over h.
            assert!((slope / b2 - 1.0).abs() <= 1e-6, "B.2 at {degrees}: {slope} {b2}");
            let power = |t: f64| value(t) * t.cos();
            let flat = (power(theta + step) - power(theta - step)) / (2.0 * step);
            assert!(flat.abs() <= 1e-6 * b2, "B.3 at {degrees}: {flat}");
            let highest = power(theta);
            let below = (0..9_000_u32).map(|i| f64::from(i) * 1e-2).map(f64::to_radians);
            assert!(below.clone().all(|t| power(t) <= highest * (1.0 + 1e-14)), "{degrees}");
            // f itself has its peak beyond θ, seen from the normal.
            let peak = below.max_by(|a, b| value(*a).total_cmp(&value(*b))).unwrap();
            assert!(peak > theta, "{degrees}: {peak}");
        }
    }
}

/// Single precision is double precision for the same vectors, but for rounding: 12 ε and the exponent's share.
#[test]
fn single_precision_is_close_to_double() {
    let mut rng = Rng::new(32);
    let mut worst = 0.0_f64;
    for i in 0..200_000_u32 {
        let case = Case::draw(&mut rng, i);
        let (light, view) = (vector(case.light[0], case.light[1]), vector(case.view[0], case.view[1]));
        let (light, view) = (cast::<f32>(light), cast::<f32>(view));
        let [alpha, beta] = case.model.alpha().map(|a| a as f32);
        let single = Ward::new(case.model.variant(), alpha, beta).unwrap();
        let double = ward(case.model.variant(), f64::from(alpha), f64::from(beta));
        if light[2] <= 1e-12 || view[2] <= 1e-12 {
            continue;
        }
        let (light64, view64) = (light.map(f64::from), view.map(f64::from));
        let (_, exponent) = exact(&double, light64.map(Wide::from), view64.map(Wide::from));
        let truth = double.evaluate(light64, view64);
        if exponent > 60.0 {
            // Below the smallest normal number, the exponential is rounded to a multiple of 1.4·10⁻⁴⁵, and its product with
            // the peak again.
            let area = core::f64::consts::PI * f64::from(alpha) * f64::from(beta);
            let coarse = if exponent < 200.0 { 0.75e-45 * (1.0 + area) * exponent.exp() * truth } else { 0.0 };
            let value = f64::from(single.evaluate(light, view));
            assert!(
                value <= 1.001 * truth + coarse + 1.5e-45,
                "{:?} {light:?} {view:?}: {value:e} {truth:e} {exponent}",
                case.model
            );
            continue;
        }
        let error = f64::from(single.evaluate(light, view)) / truth - 1.0;
        let units = error.abs() / (f64::from(f32::EPSILON) * (1.0 + exponent));
        worst = worst.max(units);
        assert!(units <= 12.0, "{:?} {light:?} {view:?}: {units} at exponent {exponent}", case.model);
    }
    println!("largest error in single precision: {worst:.2} ε (1 + exponent)");
}
