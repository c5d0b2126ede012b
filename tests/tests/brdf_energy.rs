//! The albedo of reflectance models: conserved energy, quadrature against sampling and against integration over lights.
#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "a test stops at what should not be, and prints what it measured"
)]
#![allow(clippy::cast_possible_truncation, reason = "small counts, and single precision on purpose")]

mod brdf_support;

use core::f64::consts::{FRAC_PI_2, PI, TAU};

use brdf_support::{cast, jacobian, numbers, reflect, vector, ward};
use spectral_core::brdf::{Brdf, Glossy, Lambert, Schlick, Variant, Ward};
use spectral_tests::dense::gauss_legendre;
use spectral_tests::quadrature::integrate;
use spectral_tests::statistics::Rng;

const GRAZING: f64 = FRAC_PI_2 - 1e-6 * PI / 180.0;

fn angles() -> Vec<f64> {
    let mut angles: Vec<f64> = (0..=89_u32).map(|d| f64::from(d).to_radians()).collect();
    angles.extend([89.5, 89.9, 89.99, 89.999, 89.9999].map(f64::to_radians));
    angles.push(GRAZING);
    angles
}

/// ∫ f cos θ dω over slopes of the half vector by adaptive quadrature, of what `evaluate` returns: shares nothing with
/// the sampler's weights.
fn integrated(model: &impl Brdf<f64>, stretch: [f64; 2], view: [f64; 3]) -> f64 {
    let across = (stretch[0] * view[0]).atan2(-stretch[1] * view[1]);
    let around = |psi: f64| {
        let (sin, cos) = psi.sin_cos();
        let unit = [stretch[0] * cos, stretch[1] * sin];
        let length = unit[0].hypot(unit[1]);
        let along = (unit[0] * view[0] + unit[1] * view[1]) / length;
        // y up to the horizon.
        let end = ((along + along.hypot(view[2])) / view[2] / length).min(6.5);
        let value = |y: f64| {
            let slope = [unit[0] * y, unit[1] * y];
            let light = reflect(view, slope);
            y * model.evaluate(light, view) * light[2].max(0.0) * jacobian(view, slope).max(0.0)
        };
        // √ at the horizon: y = end (1 − t²).
        integrate(&|t: f64| 2.0 * t * end * value(end * (1.0 - t * t)), 0.0, 1.0, 1e-10)
    };
    let graded = |t: f64, from: f64, sign: f64| 3.0 * t * t * around(from + sign * t * t * t * FRAC_PI_2);
    let quarters = [(0.0, 1.0), (0.0, -1.0), (PI, 1.0), (PI, -1.0)];
    let sum: f64 =
        quarters.iter().map(|(turn, sign)| integrate(&|t: f64| graded(t, across + turn, *sign), 0.0, 1.0, 1e-8)).sum();
    sum * FRAC_PI_2 * stretch[0] * stretch[1]
}

#[test]
fn the_balanced_model_conserves_energy() {
    let (mut highest, mut lowest) = (0.0_f64, f64::INFINITY);
    for alpha in [0.001, 0.003, 0.01, 0.03, 0.1, 0.3, 1.0] {
        for ratio in [1.0, 3.0, 10.0, 30.0, 100.0] {
            let model = ward(Variant::Balanced, alpha, alpha / ratio);
            for theta in angles() {
                for phi in [0.0, 0.3, 0.8, 1.2, 1.5, FRAC_PI_2] {
                    let view = vector(theta, phi);
                    for albedo in [model.albedo(view), model.albedo_by_quadrature(view)] {
                        assert!((0.0..=1.0 + 1e-6).contains(&albedo), "{alpha} {ratio} {theta} {phi}: {albedo}");
                        (highest, lowest) = (highest.max(albedo), lowest.min(albedo));
                    }
                }
            }
        }
    }
    println!("albedo of the balanced model from {lowest:.6} to 1 + {:.1e}", highest - 1.0);
    // Not for nothing: smooth surfaces lose nearly nothing.
    assert!(highest >= 1.0 - 1e-4);
}

/// ∫₀^`end` f in decades, for what changes at any scale next to 0.
fn by_decades(end: f64, rule: &[[f64; 2]], f: impl Fn(f64) -> f64) -> f64 {
    let decade = |k: i32| {
        let (from, to) = (if k == 11 { 0.0 } else { 0.1_f64.powi(k + 1) * end }, 0.1_f64.powi(k) * end);
        rule.iter().map(|[x, w]| w * f(from + (to - from) * x)).sum::<f64>() * (to - from)
    };
    (0..12).map(decade).sum()
}

/// As [`integrated`], by a fixed rule that follows lobes to the very horizon.
fn integrated_by_decades(model: &Ward<f64>, view: [f64; 3], rule: &[[f64; 2]]) -> f64 {
    let [alpha, beta] = model.alpha();
    let across = (alpha * view[0]).atan2(-beta * view[1]);
    let around = |psi: f64| {
        let unit = [alpha * psi.cos(), beta * psi.sin()];
        let length = unit[0].hypot(unit[1]);
        let along = (unit[0] * view[0] + unit[1] * view[1]) / length;
        let root = along.hypot(view[2]);
        let horizon = if along > 0.0 { (along + root) / view[2] } else { view[2] / (root - along) };
        by_decades((horizon / length).min(6.5), rule, |y| {
            let slope = [unit[0] * y, unit[1] * y];
            let light = reflect(view, slope);
            y * model.evaluate(light, view) * light[2].max(0.0) * jacobian(view, slope).max(0.0)
        })
    };
    let quarter = |turn: f64, sign: f64| by_decades(FRAC_PI_2, rule, |t| around(across + turn + sign * t));
    (quarter(0.0, 1.0) + quarter(0.0, -1.0) + quarter(PI, 1.0) + quarter(PI, -1.0)) * alpha * beta
}

/// The same of the very values of `evaluate`, integrated without the sampler's weights.
#[test]
fn the_balanced_model_conserves_energy_by_its_values() {
    let (rule, mut highest) = (gauss_legendre(16), 0.0_f64);
    for alpha in [0.001, 0.03, 0.3, 1.0] {
        for ratio in [1.0, 10.0, 100.0] {
            let model = ward(Variant::Balanced, alpha, alpha / ratio);
            for theta in [0.0, 60.0, 85.0, 89.0, 89.9, 89.999, GRAZING.to_degrees()].map(f64::to_radians) {
                for phi in [0.0, 0.9, FRAC_PI_2] {
                    let view = vector(theta, phi);
                    let albedo = integrated_by_decades(&model, view, &rule);
                    assert!(albedo <= 1.0 + 1e-6, "{alpha} {ratio} {theta} {phi}: {albedo}");
                    let quadrature = model.albedo_by_quadrature(view);
                    assert!(
                        (albedo - quadrature).abs() <= 1e-4,
                        "{alpha} {ratio} {theta} {phi}: {albedo} {quadrature}"
                    );
                    highest = highest.max(albedo);
                }
            }
        }
    }
    println!("integrated albedo of the balanced model up to 1 + {:.1e}", highest - 1.0);
}

/// Figures 2.12 and 2.13: the others' violations, as they are.
#[test]
fn of_the_others_only_neumanns_conserves_it() {
    println!("albedo      θ:    0°      45°      80°      85°      89°    89.9°");
    for alpha in [0.01, 0.1, 0.2, 0.5] {
        for variant in Variant::ALL {
            let model = ward(variant, alpha, alpha);
            let row = [0.0, 45.0, 80.0, 85.0, 89.0, 89.9]
                .map(|d| model.albedo_by_quadrature(vector(f64::to_radians(d), 0.0)));
            println!("{variant:>12} {alpha:4} {}", row.map(|a| format!("{a:8.4}")).join(" "));
            let limit = angles().into_iter().map(|t| model.albedo_by_quadrature(vector(t, 0.0)));
            let limit = limit.fold(0.0, |most: f64, a| if a.is_nan() { a } else { most.max(a) });
            match variant {
                Variant::Ward | Variant::WardDuer => assert!(limit > 2.0, "{variant} {alpha}: {limit}"),
                Variant::WardNeumann | Variant::Balanced => assert!(limit <= 1.0 + 1e-6, "{variant} {alpha}: {limit}"),
            }
        }
    }
    // Towards grazing incidence the balanced model's goes to 1 (B.13–B.15), and Neumann's to less than a half.
    for alpha in [0.05, 0.2, 1.0] {
        let view = vector(GRAZING, 0.0);
        assert!((ward(Variant::Balanced, alpha, alpha).albedo_by_quadrature(view) - 1.0).abs() <= 1e-5);
        assert!(ward(Variant::WardNeumann, alpha, alpha).albedo_by_quadrature(view) < 0.5);
    }
}

#[test]
fn quadrature_is_the_integral_over_lights() {
    let mut worst = [0.0_f64; 4];
    for (slot, variant) in Variant::ALL.into_iter().enumerate() {
        for (alpha, beta) in [(0.02, 0.02), (0.1, 0.1), (0.5, 0.5), (1.0, 1.0), (0.1, 0.4), (0.5, 0.01)] {
            let model = ward(variant, alpha, beta);
            for degrees in [0.0, 50.0, 80.0, 89.0] {
                let view = vector(f64::to_radians(degrees), 0.6);
                let truth = integrated(&model, [alpha, beta], view);
                let found = model.albedo_by_quadrature(view);
                let error = (found / truth - 1.0).abs();
                worst[slot] = worst[slot].max(error);
                assert!(error <= 2e-5, "{variant} {alpha} {beta} {degrees}: {found} {truth}");
            }
        }
    }
    println!(
        "relative error of the albedo by quadrature, {:?}: {}",
        Variant::ALL,
        worst.map(|e| format!("{e:.1e}")).join(" ")
    );
}

/// The fit against quadrature, on a grid that isn't the fit's.
#[test]
fn the_fit_is_within_its_bound() {
    let mut worst = 0.0_f64;
    let alphas =
        (0..=200_u32).map(|i| 1e-6_f64.powf(1.0 - f64::from(i) / 200.0)).chain((1..100).map(|i| f64::from(i) / 100.0));
    for alpha in alphas {
        let model = ward(Variant::Balanced, alpha, alpha);
        let single =
            Ward::new(Variant::Balanced, (alpha as f32).clamp(1e-6, 1.0), (alpha as f32).clamp(1e-6, 1.0)).unwrap();
        let cosines =
            (1..=400_u32).map(|i| f64::from(i) / 400.0).chain((1..60).map(|i| 10.0_f64.powf(-f64::from(i) / 6.0)));
        for z in cosines {
            let view = [((1.0 - z) * (1.0 + z)).sqrt(), 0.0, z];
            let truth = model.albedo_by_quadrature(view);
            let error = (model.albedo(view) - truth).abs().max((f64::from(single.albedo(cast(view))) - truth).abs());
            worst = worst.max(error);
            assert!(error <= 2e-4, "{alpha} {z}: {} {truth}", model.albedo(view));
        }
    }
    println!("largest error of the fit: {worst:.2e}");
}

/// Mean weight against quadrature, within z = 4.5 standard errors of each of the comparisons; and what drawing lights
/// uniformly from the hemisphere finds.
#[test]
fn sampling_finds_the_albedo() {
    const SAMPLES: u32 = 100_000;
    let mut rng = Rng::new(0x00a1_bed0);
    let mut check = |name: &str, model: &dyn Brdf<f64>, view: [f64; 3], numerical: f64| {
        let mut sums = [0.0_f64; 4];
        for _ in 0..SAMPLES {
            let weight = model.sample(view, numbers(&mut rng)).unwrap().weight;
            let light = reflect_uniform(&mut rng);
            let uniform = model.evaluate(light, view) * light[2] * TAU;
            for (sum, value) in sums.iter_mut().zip([weight, weight * weight, uniform, uniform * uniform]) {
                *sum += value / f64::from(SAMPLES);
            }
        }
        let albedo = model.albedo(view);
        let error = |mean: f64, square: f64| ((square - mean * mean).max(0.0) / f64::from(SAMPLES)).sqrt();
        let by_weight = (sums[0] - albedo).abs();
        let allowed = 4.5 * error(sums[0], sums[1]) + numerical;
        assert!(by_weight <= allowed, "{name} {view:?}: {} {albedo} {allowed}", sums[0]);
        // A lobe that is large enough to be met by chance.
        if sums[3] < 50.0 * sums[2] * sums[2] {
            assert!(
                (sums[2] - albedo).abs() <= 4.5 * error(sums[2], sums[3]) + numerical,
                "{name} {view:?}: {sums:?} {albedo}"
            );
        }
    };
    for degrees in [0.0, 40.0, 75.0, 88.0, 89.9] {
        let view = vector(f64::to_radians(degrees), 0.4);
        for variant in Variant::ALL {
            for (alpha, beta) in [(0.01, 0.01), (0.1, 0.1), (0.5, 0.5), (0.05, 0.5)] {
                let fitted = if variant == Variant::Balanced && alpha == beta { 2e-4 } else { 2e-5 };
                check(variant.name(), &ward(variant, alpha, beta), view, fitted);
            }
        }
        for (roughness, isotropy) in [(0.0, 1.0), (0.02, 1.0), (0.2, 0.1), (0.5, 1.0), (0.8, 0.3), (1.0, 1.0)] {
            check("schlick", &Schlick::new(roughness, isotropy).unwrap(), view, 1e-4);
        }
        check("glossy", &Glossy::new(0.3, 0.6, ward(Variant::Balanced, 0.2, 0.1)).unwrap(), view, 2e-5);
        check("lambert", &Lambert, view, 0.0);
    }
}

fn reflect_uniform(rng: &mut Rng) -> [f64; 3] {
    let [x, y, z] = rng.direction();
    [x, y, z.abs()]
}
