//! Configuration factors over distances, radii and grazing angles.

use disk_sampling::estimate::{Aim, Panel, Request, Response, integrate};
use disk_sampling::{
    Disk, Receiver, Sphere, disk_configuration_factor, disk_parallel_factor, on_axis_disk_factor,
    polygon_configuration_factor, sphere_configuration_factor,
};
use spectral_core::Real;

use super::{Sweep, by_name, domain, powers, steps};

/// All sweeps of configuration factors.
pub(super) fn sweeps(quick: bool) -> Result<Vec<Sweep>, String> {
    let [single, double] = [of::<f32>("f32", steps(quick)), of::<f64>("f64", steps(quick))];
    Ok(by_name(single.into_iter().chain(double)))
}

const DISK: &str = "disk_configuration_factor: radii from 1e-6 to 1e6 times the distance from the plane, any distance from the axis in that range, \
                    factors from 1e-60 (f32: 1e-20)";
const SPHERE: &str = "sphere_configuration_factor: distances from the surface down to 1e-9 (f32: 1e-5) radii, factors from 1e-60 (f32: 1e-20)";

fn of<R: Real>(kind: &str, steps: i32) -> Vec<Sweep> {
    let single = kind == "f32";
    let tolerance = if single { 1e-5 } else { 1e-12 };
    let relative = "relative error";
    // What the type holds counts, not what it was rounded from.
    let held = |x: f64| R::from_f64(x).to_f64();
    let fits = move |x: &f64| {
        let x = R::from_f64(*x);
        x.is_finite() && x >= R::MIN_POSITIVE
    };
    let wide: Vec<f64> = powers(-30, 30, steps).into_iter().filter(fits).collect();
    let factor = move |disk: ([f64; 3], [f64; 3], f64), receiver: ([f64; 3], [f64; 3])| {
        let cast = |v: [f64; 3]| v.map(R::from_f64);
        let disk = Disk::new(cast(disk.0), cast(disk.1), R::from_f64(disk.2)).ok()?;
        let receiver = Receiver::new(cast(receiver.0), cast(receiver.1)).ok()?;
        Some(disk_configuration_factor(&disk, &receiver).to_f64())
    };
    let up = ([0.0; 3], [0.0, 0.0, 1.0]);
    let axis = Sweep::new(
        ["disk on its axis over distance", kind, "distance over radius", relative],
        domain([1e-6, 1e6], tolerance, DISK),
        &wide,
        |h| Some(factor(([0.0, 0.0, h], [0.0, 0.0, -1.0], 1.0), up)? / on_axis(held(h)) - 1.0),
    );
    let formula = Sweep::new(
        ["on_axis_disk_factor over distance", kind, "distance over radius", relative],
        domain([1e-6, 1e6], 4.0 * R::EPSILON.to_f64(), "on_axis_disk_factor: 4 ε"),
        &wide,
        |h| Some(on_axis_disk_factor(R::ONE, R::from_f64(h)).to_f64() / on_axis(held(h)) - 1.0),
    );
    let scaled = Sweep::new(
        ["disk on its axis over the unit of length", kind, "radius = distance", relative],
        domain([1e-30, 1e30], tolerance, "disk_configuration_factor: everything that Disk and Receiver take"),
        &wide,
        |s| Some(factor(([0.0, 0.0, s], [0.0, 0.0, -1.0], s), up)? / 0.5 - 1.0),
    );
    let last = if single { 1e5 } else { 1e6 };
    let beside = Sweep::new(
        ["disk beside its axis over distance", kind, "distance from the axis over radius", relative],
        domain([1e-6, last], tolerance, DISK),
        &wide,
        |a| Some(disk_parallel_factor(R::ONE, R::ONE, R::from_f64(a)).to_f64() / parallel(held(a)) - 1.0),
    );
    let tilted = Sweep::new(
        ["disk over its height over the horizon", kind, "sine of the height", relative],
        domain(
            [1e-6, 1.0],
            tolerance,
            "disk_configuration_factor: clipped at the receiver's horizon, factors from 1e-60 (f32: 1e-20)",
        ),
        &powers(if single { -6 } else { -15 }, 0, steps),
        |sine| {
            // So small that the disk stays above the horizon: as a point, but for (r/h)² / 4.
            let radius = held(sine * 1e-3);
            let normal = [(1.0 - sine * sine).max(0.0).sqrt(), 0.0, sine].map(held);
            let length = normal.iter().map(|x| x * x).sum::<f64>().sqrt();
            let truth = radius * radius / (1.0 + radius * radius) * normal[2] / length;
            Some(factor(([0.0, 0.0, 1.0], [0.0, 0.0, -1.0], radius), ([0.0; 3], normal))? / truth - 1.0)
        },
    );
    let sphere = |radius: f64, distance: f64| {
        let sphere = Sphere::new([R::ZERO, R::ZERO, R::from_f64(distance)], R::from_f64(radius)).ok()?;
        let receiver = Receiver::new([R::ZERO; 3], [R::ZERO, R::ZERO, R::ONE]).ok()?;
        Some(sphere_configuration_factor(&sphere, &receiver).to_f64())
    };
    let far = if single { 1e10 } else { 1e30 };
    let away = Sweep::new(
        ["sphere over distance", kind, "distance over radius", relative],
        domain([1.0, far], tolerance, SPHERE),
        &wide.iter().copied().filter(|d| *d > 1.0).collect::<Vec<_>>(),
        |d| Some(sphere(1.0, d)? * held(d) * held(d) - 1.0),
    );
    let near = Sweep::new(
        ["sphere over the distance from its surface", kind, "distance from the surface over radius", relative],
        domain([if single { 1e-5 } else { 1e-9 }, 1.0], tolerance, SPHERE),
        &powers(if single { -6 } else { -14 }, 0, steps),
        |gap| {
            let d = held(1.0 + gap);
            Some(sphere(1.0, d)? * d * d - 1.0)
        },
    );
    let square = Sweep::new(
        ["square over the unit of length", kind, "side = distance", relative],
        domain([1e-30, 1e30], tolerance, POLYGON),
        &wide,
        |s| {
            let half = R::from_f64(s) * R::HALF;
            let h = R::from_f64(s);
            let corners = [[half, half, h], [-half, half, h], [-half, -half, h], [half, -half, h]];
            let found = polygon_configuration_factor([R::ZERO; 3], [R::ZERO, R::ZERO, R::ONE], &corners).to_f64();
            let truth = crate::verify::oracle::parallel_rectangle([-0.5, 0.5], [-0.5, 0.5], 1.0);
            Some(found / truth - 1.0)
        },
    );
    vec![axis, formula, scaled, beside, tilted, away, near, square, requested::<R>(kind, steps)]
}

const POLYGON: &str = "polygon_configuration_factor: 1e-12 (f32: 1e-5) whatever its size, distance and tilt";

/// 1/(1 + h²).
fn on_axis(h: f64) -> f64 {
    let sine = 1.0 / h.hypot(1.0);
    sine * sine
}

/// A facing element at distance 1 from the plane of a unit disk and `a` from its axis: ½ (1 − X/√(X² + 4)), X = a², without its differences.
fn parallel(a: f64) -> f64 {
    let x = a * a;
    let root = x.hypot(2.0);
    2.0 / (root * (root + x))
}

/// Light in proportion to the cosine, on the axis at a distance of a radius: ⅔ (1 − 2^−³ᐟ²), to a requested error, over its radiance.
fn requested<R: Real>(kind: &str, steps: i32) -> Sweep {
    const ERROR: f64 = 1e-3;
    let truth = 2.0 / 3.0 * (1.0 - 0.5_f64.powf(1.5));
    let source = "estimate::integrate: to a requested relative error for any emission that is not negative and finite";
    Sweep::new(
        ["disk to a requested error over radiance", kind, "radiance along the axis", "relative error"],
        domain([1e-30, 1e30], ERROR, source),
        &powers(-30, 30, steps),
        |scale| {
            let disk = Disk::new([R::ZERO, R::ZERO, R::ONE], [R::ZERO, R::ZERO, -R::ONE], R::ONE).ok()?;
            let receiver = Receiver::new([R::ZERO; 3], [R::ZERO, R::ZERO, R::ONE]).ok()?;
            let request = Request { relative_error: R::from_f64(ERROR), max_samples: 100_000, strata: 1 };
            let mut panels = vec![Panel::default(); 64];
            let emission = R::from_f64(scale);
            let respond = |aim: &Aim<R>| Response::unoccluded(emission * aim.cosine);
            let found = integrate(&disk, &receiver, &request, &mut panels, respond).ok()?;
            Some(found.value.to_f64() / emission.to_f64() / truth - 1.0)
        },
    )
}
