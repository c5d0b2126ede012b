//! Disk lights: subdivisions to a depth, a cubature on them, requested errors, and the closed form.

use alloc::rc::Rc;
use core::f64::consts::PI;

use disk_sampling::estimate::{Aim, Panel, Request, Response, integrate, ratio};
use disk_sampling::partition::{Method, Partition};
use disk_sampling::{Disk, Receiver, disk_configuration_factor};

use super::plan::{Plan, Random, Run, Setting, count, rms_and_worst, timed_items};
use crate::verify::oracle;

/// What the light does.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Light {
    /// The same in all directions and places.
    Even,
    /// In proportion to the cosine at the light.
    Cosine,
    /// Even, but seen only at x above this, in the disk's coordinates: behind a straight edge.
    Beyond(f64),
}

impl Light {
    fn response(self, aim: &Aim<f64>) -> Response<f64> {
        match self {
            Self::Even => Response::unoccluded(1.0),
            Self::Cosine => Response::unoccluded(aim.cosine),
            Self::Beyond(edge) => Response { emission: 1.0, visibility: if aim.point[0] > edge { 1.0 } else { 0.0 } },
        }
    }
}

/// A disk, where it is seen from, and what arrives there in truth.
struct Scene {
    disk: Disk<f64>,
    receivers: Vec<(Receiver<f64>, f64)>,
    light: Light,
    /// How often all receivers are computed in a run, so that it takes long enough to be timed.
    repeats: usize,
}

const UP: [f64; 3] = [0.0, 0.0, 1.0];
const DOWN: [f64; 3] = [0.0, 0.0, -1.0];
const ORIGIN: [f64; 3] = [0.0; 3];

/// All tasks.
pub(super) fn plans(quick: bool) -> Vec<Plan> {
    let axis = "r²/(r² + h²), exact";
    let mut all = vec![
        plan("axis", "on the axis, r = 0.4, h = 3.55", axis, quick, || on_axis(0.4, 3.55)),
        plan("near", "on the axis, r = h = 1", axis, quick, || on_axis(1.0, 1.0)),
        plan(
            "receivers",
            "receivers around a disk, from 0.15 to 10 radii away, tilted, grazing and cut by their horizon",
            "Lambert's contour integral along the rim, by quadrature to rounding",
            quick,
            || around(Light::Even),
        ),
        plan(
            "cosine",
            "light in proportion to the cosine, receivers that see all of the disk",
            "Gauss's rule on 96 × 192 points in polar coordinates",
            quick,
            || around(Light::Cosine),
        ),
        plan(
            "edge",
            "half of the disk behind a straight edge, receivers that see all of it otherwise",
            "the contour integral along arc and chord",
            quick,
            || around(Light::Beyond(0.2)),
        ),
    ];
    if quick {
        all.retain(|plan| plan.name != "axis");
    }
    all
}

fn plan(
    name: &'static str,
    title: &str,
    truth: &str,
    quick: bool,
    scene: impl FnOnce() -> Result<Scene, String> + 'static,
) -> Plan {
    Plan {
        name,
        title: title.to_owned(),
        error: "relative error, RMS",
        operations: "points of the light",
        truth: truth.to_owned(),
        floor: 1e-12,
        rounds: if quick { 3 } else { 7 },
        weight: if quick { 1.5 } else { 20.0 },
        build: Box::new(move || Ok(settings(&Rc::new(scene()?), quick))),
    }
}

fn on_axis(radius: f64, height: f64) -> Result<Scene, String> {
    let disk = Disk::new([0.0, 0.0, height], DOWN, radius).map_err(|e| e.to_string())?;
    let receiver = Receiver::new(ORIGIN, UP).map_err(|e| e.to_string())?;
    let truth = radius * radius / (radius * radius + height * height);
    Ok(Scene { disk, receivers: vec![(receiver, truth)], light: Light::Even, repeats: 200 })
}

/// Receivers at random below a disk of radius 1 that shines down from the origin.
fn around(light: Light) -> Result<Scene, String> {
    const RECEIVERS: usize = 200;
    let disk = Disk::new(ORIGIN, DOWN, 1.0).map_err(|e| e.to_string())?;
    let mut random = Random::new(1, 0);
    let mut receivers = Vec::new();
    while receivers.len() < RECEIVERS {
        let height = 0.15 * (10.0_f64 / 0.15).powf(random.unit());
        let position = [random.between(-2.0, 2.0), random.between(-2.0, 2.0), -height];
        let (z, turn) = (random.between(-0.3, 1.0), random.between(0.0, 2.0 * PI));
        let across = (1.0 - z * z).sqrt();
        let normal = [across * turn.cos(), across * turn.sin(), z];
        let sees_all = oracle::sees_all_of_a_disk(ORIGIN, DOWN, 1.0, position, normal);
        if light != Light::Even && !sees_all {
            continue;
        }
        let truth = match light {
            Light::Even => oracle::disk(ORIGIN, DOWN, 1.0, position, normal),
            Light::Cosine => by_polar_rule(position, normal),
            Light::Beyond(edge) => oracle::disk_beyond(ORIGIN, 1.0, edge, position, normal),
        };
        // Slivers of light would be all that a relative error shows.
        if truth > 1e-4 {
            receivers.push((Receiver::new(position, normal).map_err(|e| e.to_string())?, truth));
        }
    }
    Ok(Scene { disk, receivers, light, repeats: 1 })
}

/// (1/π) ∫ cos θ cos² θ′ / d² dA over the unit disk that shines down.
fn by_polar_rule(position: [f64; 3], normal: [f64; 3]) -> f64 {
    const AROUND: u32 = 192;
    let radial = oracle::gauss_legendre(96);
    let mut sum = 0.0;
    for &(r, weight) in &radial {
        for k in 0..AROUND {
            let angle = 2.0 * PI * (f64::from(k) + 0.5) / f64::from(AROUND);
            let to = [r * angle.cos() - position[0], r * angle.sin() - position[1], -position[2]];
            let d2: f64 = to.iter().map(|x| x * x).sum();
            let cosine = (to[0] * normal[0] + to[1] * normal[1] + to[2] * normal[2]) / d2.sqrt();
            let at_light = to[2] / d2.sqrt();
            sum += weight * r * cosine * at_light * at_light / d2;
        }
    }
    sum * 2.0 * PI / f64::from(AROUND) / PI
}

fn settings(scene: &Rc<Scene>, quick: bool) -> Vec<Setting> {
    let mut all = Vec::new();
    let depths: &[u32] = if quick { &[2, 6, 10] } else { &[1, 2, 3, 4, 5, 6, 8, 10, 12] };
    for (method, name, own) in [
        (Method::Square, "square", false),
        (Method::MappedSquare, "mapped square", false),
        (Method::Hexagon, "hexagon", false),
        (Method::EqualAreaHexagon, "equal-area hexagon", true),
    ] {
        // Two depths of triangles are one level.
        let differs = |depth: &&u32| own_levels(method) || depth.is_multiple_of(2) || **depth == 1;
        for depth in depths.iter().filter(differs) {
            all.push(by_parts(scene, name, own, (method, *depth, false)));
        }
    }
    let weighted: &[u32] = if quick { &[6, 10] } else { &[6, 8, 10, 12] };
    for depth in weighted {
        all.push(by_parts(scene, "weighted hexagon", true, (Method::EqualAreaHexagon, *depth, true)));
    }
    let errors: &[f64] = if quick { &[1e-1, 1e-2, 1e-3] } else { &[1e-1, 3e-2, 1e-2, 3e-3, 1e-3, 1e-4, 1e-5, 1e-6] };
    // An edge could slip between the points of a single stratum, and takes many.
    let errors = if matches!(scene.light, Light::Beyond(_)) { &errors[..errors.len().min(6)] } else { errors };
    all.extend(errors.iter().map(|error| on_request(scene, *error)));
    if scene.light == Light::Even {
        let own = Rc::clone(scene);
        all.push(Setting::new("closed form", "closed form", true, move |_| {
            run(&own, |scene, receiver| (disk_configuration_factor(&scene.disk, receiver), 1))
        }));
    }
    all
}

/// Whether every depth of a method is a level of its own.
const fn own_levels(method: Method) -> bool {
    matches!(method, Method::Square | Method::MappedSquare)
}

/// Computes all receivers, each with its number of points.
fn run(scene: &Scene, of: impl Fn(&Scene, &Receiver<f64>) -> (f64, usize)) -> Result<Run, String> {
    let all = scene.receivers.len();
    let items: Vec<usize> = (0..all * scene.repeats).map(|item| item % all).collect();
    let (mut found, seconds) = timed_items(&items, 10, || (), |(), item| of(scene, &scene.receivers[*item].0));
    found.truncate(all);
    let errors = found.iter().zip(&scene.receivers).map(|((value, _), (_, truth))| value / truth - 1.0);
    let [error, worst] = rms_and_worst(errors);
    let all = count(all);
    let points = found.iter().map(|(_, points)| count(*points)).sum::<f64>() / all;
    Ok(Run { seconds: seconds / count(scene.repeats) / all, operations: points, error, worst })
}

fn by_parts(
    scene: &Rc<Scene>,
    name: &'static str,
    own: bool,
    (method, depth, weighted): (Method, u32, bool),
) -> Setting {
    let scene = Rc::clone(scene);
    let parts = method.parts(depth);
    Setting::new(format!("{name}, depth {depth} ({parts})"), name, own, move |_| {
        run(&scene, |scene, receiver| sum_of_parts(scene, receiver, method, depth, weighted))
    })
}

/// A Σ w f V cos θ cos θ′ / (π d²) over the parts of a subdivision.
fn sum_of_parts(scene: &Scene, receiver: &Receiver<f64>, method: Method, depth: u32, weighted: bool) -> (f64, usize) {
    let (disk, mut sum, mut points) = (&scene.disk, 0.0, 0);
    let (to, facing) = (disk.local(receiver.position()), disk.direction(receiver.normal()));
    for part in Partition::<f64>::full(method, depth).into_iter().flatten() {
        points += 1;
        if !part.hits() {
            continue;
        }
        let (on_disk, weight) = if weighted { part.cubature() } else { (part.position(), part.weight()) };
        let away = [on_disk[0] - to[0], on_disk[1] - to[1], -to[2]];
        let d2 = away[0] * away[0] + away[1] * away[1] + away[2] * away[2];
        let received = away[0] * facing[0] + away[1] * facing[1] + away[2] * facing[2];
        if received > 0.0 && to[2] > 0.0 {
            let aim = Aim { on_disk, point: disk.point(on_disk), cosine: to[2] / d2.sqrt() };
            let response = scene.light.response(&aim);
            sum += weight * response.emission * response.visibility * received * to[2] / (d2 * d2);
        }
    }
    (sum, points)
}

fn on_request(scene: &Rc<Scene>, error: f64) -> Setting {
    let scene = Rc::clone(scene);
    let strata = if matches!(scene.light, Light::Beyond(_)) { 4 } else { 1 };
    let mut panels = vec![Panel::default(); 2048];
    Setting::new(format!("requested error {error}"), "requested error", true, move |_| {
        let request = Request { relative_error: error, max_samples: 1 << 18, strata };
        let panels = core::cell::RefCell::new(&mut panels);
        run(&scene, |scene, receiver| {
            let respond = |aim: &Aim<f64>| scene.light.response(aim);
            let panels = &mut **panels.borrow_mut();
            let found = if matches!(scene.light, Light::Beyond(_)) {
                let exact = disk_configuration_factor(&scene.disk, receiver);
                ratio(&scene.disk, receiver, exact, &request, panels, respond)
            } else {
                integrate(&scene.disk, receiver, &request, panels, respond)
            };
            found.map_or((f64::NAN, 0), |found| (found.value, found.samples.max(1)))
        })
    })
}
