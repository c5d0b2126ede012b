//! Sampling of glossy reflection: albedos by some numbers of samples against quadrature.

use alloc::rc::Rc;
use core::f64::consts::PI;

use spectral_core::brdf::{Brdf as _, Variant, Ward};

use super::plan::{Plan, Random, Run, Setting, count, rms_and_worst, timed_items};
use crate::brdf::albedo;

/// A way to draw directions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Way {
    /// Antithetic half vectors, none rejected.
    Antithetic,
    /// Ward's half vectors: some fall below the horizon.
    HalfVector,
    /// In proportion to the cosine.
    Cosine,
    /// Evenly over the hemisphere.
    Even,
}

const WAYS: [(Way, &str, bool); 4] = [
    (Way::Antithetic, "sample", true),
    (Way::HalfVector, "sample_half_vector", false),
    (Way::Cosine, "cosine", false),
    (Way::Even, "even", false),
];

/// Polar angles of the view in degrees.
const ANGLES: [f64; 6] = [0.0, 30.0, 60.0, 75.0, 85.0, 89.0];
/// Estimates of each setting in a round, each with other random numbers.
const TRIALS: u64 = 32;

/// A model, a view and the albedo.
struct Case {
    model: Ward<f64>,
    view: [f64; 3],
    truth: f64,
}

/// All tasks.
pub(super) fn plans(quick: bool) -> Vec<Plan> {
    let tasks: [(&'static str, Variant, [f64; 2], &str); 4] = [
        ("balanced", Variant::Balanced, [0.2, 0.2], "the balanced model, α = 0.2"),
        ("anisotropic", Variant::Balanced, [0.05, 0.3], "the balanced model, α = 0.05 and 0.3"),
        ("ward-duer", Variant::WardDuer, [0.2, 0.2], "Dür's model, α = 0.2"),
        ("neumann", Variant::WardNeumann, [0.2, 0.2], "Neumann's model, α = 0.2"),
    ];
    let wanted = tasks.into_iter().filter(|(name, ..)| !quick || *name == "balanced");
    wanted.map(|(name, variant, alpha, about)| plan(name, variant, alpha, about, quick)).collect()
}

fn plan(name: &'static str, variant: Variant, alpha: [f64; 2], about: &str, quick: bool) -> Plan {
    Plan {
        name,
        title: format!("albedo of {about}, six angles from 0° to 89°"),
        error: "relative error, RMS",
        operations: "samples",
        truth: "adaptive quadrature to 1e-9 of the albedo".to_owned(),
        floor: 1e-9,
        rounds: if quick { 3 } else { 9 },
        weight: if quick { 2.0 } else { 15.0 },
        build: Box::new(move || {
            let cases = Rc::new(cases(variant, alpha)?);
            let counts: &[u32] = if quick { &[4, 64, 1024] } else { &[1, 4, 16, 64, 256, 1024, 4096] };
            let mut all = Vec::new();
            for (way, name, own) in WAYS {
                all.extend(counts.iter().map(|n| sampling(&cases, way, name, own, *n)));
            }
            let own = Rc::clone(&cases);
            all.push(closed(
                "albedo_by_quadrature",
                512.0,
                move || own.iter().map(|case| case.model.albedo_by_quadrature(case.view)).collect(),
                &cases,
            ));
            if variant == Variant::Balanced && alpha[0] == alpha[1] {
                let own = Rc::clone(&cases);
                let fit = move || own.iter().map(|case| case.model.albedo(case.view)).collect();
                all.push(closed("albedo (fit)", 1.0, fit, &cases));
            }
            Ok(all)
        }),
    }
}

fn cases(variant: Variant, [u, v]: [f64; 2]) -> Result<Vec<Case>, String> {
    let model = Ward::new(variant, u, v).map_err(|e| e.to_string())?;
    let case = |degrees: &f64| {
        let truth = albedo(variant, [u, v], [*degrees, 30.0]).map_err(|e| e.to_string())?.value;
        let (sine, cosine) = degrees.to_radians().sin_cos();
        let turn = f64::to_radians(30.0);
        Ok(Case { model, view: [sine * turn.cos(), sine * turn.sin(), cosine], truth })
    };
    ANGLES.iter().map(case).collect()
}

fn sampling(cases: &Rc<Vec<Case>>, way: Way, name: &'static str, own: bool, samples: u32) -> Setting {
    let cases = Rc::clone(cases);
    Setting::new(format!("{name} × {samples}"), name, own, move |round| {
        let mut random = Random::new(u64::from(samples) << 8 | way as u64, round);
        let items: Vec<&Case> = cases.iter().flat_map(|case| (0..TRIALS).map(move |_| case)).collect();
        let chunk = (256 / samples as usize).clamp(1, 32);
        let (found, seconds) = timed_items(
            &items,
            chunk,
            || (),
            |(), case| {
                let sum: f64 = (0..samples).map(|_| weight(case, way, &mut random)).sum();
                sum / f64::from(samples) / case.truth - 1.0
            },
        );
        let [error, worst] = rms_and_worst(found.iter().copied());
        Ok(Run { seconds: seconds / count(found.len()), operations: f64::from(samples), error, worst })
    })
}

/// What a sample counts for; the mean is the albedo.
fn weight(case: &Case, way: Way, random: &mut Random) -> f64 {
    let u = [random.unit(), random.unit(), random.unit()];
    let (model, view) = (&case.model, case.view);
    let about_normal = |z: f64| {
        let across = (1.0 - z * z).max(0.0).sqrt();
        let (sine, cosine) = (2.0 * PI * u[1]).sin_cos();
        [across * cosine, across * sine, z]
    };
    match way {
        Way::Antithetic => model.sample(view, u).map_or(0.0, |sample| sample.weight),
        Way::HalfVector => model.sample_half_vector(view, [u[0], u[1]]).map_or(0.0, |sample| sample.weight),
        Way::Cosine => PI * model.evaluate(about_normal((1.0 - u[0]).sqrt()), view),
        Way::Even => 2.0 * PI * u[0] * model.evaluate(about_normal(u[0]), view),
    }
}

/// A setting without random numbers.
fn closed(
    name: &'static str,
    operations: f64,
    mut of: impl FnMut() -> Vec<f64> + 'static,
    cases: &Rc<Vec<Case>>,
) -> Setting {
    const REPEATS: usize = 50;
    let cases = Rc::clone(cases);
    Setting::new(name, name, true, move |_| {
        let (mut found, seconds) = timed_items(&[(); REPEATS], 5, || (), |(), ()| of());
        let found = found.pop().unwrap_or_default();
        let [error, worst] = rms_and_worst(found.iter().zip(cases.iter()).map(|(f, case)| f / case.truth - 1.0));
        Ok(Run { seconds: seconds / count(REPEATS * found.len()), operations, error, worst })
    })
}
