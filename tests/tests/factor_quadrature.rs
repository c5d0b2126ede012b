//! Configuration factors against adaptive quadrature over area and solid angle (independent).
#![allow(clippy::unwrap_used, reason = "the input is constant")]

use disk_sampling::{
    Disk, Receiver, Sphere, disk_configuration_factor, disk_parallel_factor, disk_perpendicular_factor,
    on_axis_disk_factor, polygon_configuration_factor, rectangle_parallel_factor, rectangle_perpendicular_factor,
    sphere_configuration_factor,
};
use spectral_tests::quadrature::{disk_factor, sphere_factor, triangle_factor};
use spectral_tests::statistics::Rng;

const TOLERANCE: f64 = 1e-12;

fn magnitude(rng: &mut Rng, low: f64, high: f64) -> f64 {
    10_f64.powf(low + (high - low) * rng.unit())
}

fn close(found: f64, expected: f64, what: &dyn core::fmt::Debug) -> bool {
    assert!((found - expected).abs() <= TOLERANCE * expected, "{what:?}: {found:e}, quadrature {expected:e}");
    expected > 0.0
}

#[test]
fn disks() {
    let mut rng = Rng::new(11);
    let mut lit = 0;
    for _ in 0..400 {
        let (h, rho, around): (f64, f64, f64) =
            (magnitude(&mut rng, -2.0, 3.0), magnitude(&mut rng, -2.0, 2.0), core::f64::consts::TAU * rng.unit());
        let p = [rho * around.cos(), rho * around.sin(), h];
        let receiver = Receiver::new(p, rng.direction()).unwrap();
        let disk = Disk::new([0.0; 3], [0.0, 0.0, 1.0], 1.0).unwrap();
        let expected = disk_factor([0.0; 3], [0.0, 0.0, 1.0], 1.0, p, receiver.normal());
        // Slivers as small as these are left to the table: rounding the angle at the horizon costs quadrature its digits.
        if expected == 0.0 || expected > 1e-3 * on_axis_disk_factor(1.0, h.hypot(rho)) {
            lit += u32::from(close(disk_configuration_factor(&disk, &receiver), expected, &receiver));
        }
    }
    assert!(lit > 150, "{lit}");
}

#[test]
fn spheres() {
    let mut rng = Rng::new(12);
    let mut lit = 0;
    for _ in 0..400 {
        let (distance, toward) = (1.0 + magnitude(&mut rng, -3.0, 2.0), rng.direction());
        let receiver = Receiver::new([0.0; 3], rng.direction()).unwrap();
        let centre = toward.map(|x| x * distance);
        let sphere = Sphere::new(centre, 1.0).unwrap();
        let expected = sphere_factor(centre, 1.0, [0.0; 3], receiver.normal());
        if expected == 0.0 || expected > 1e-3 / (distance * distance) {
            lit += u32::from(close(sphere_configuration_factor(&sphere, &receiver), expected, &(centre, receiver)));
        }
    }
    assert!(lit > 150, "{lit}");
}

#[test]
fn triangles() {
    let mut rng = Rng::new(13);
    let mut lit = 0;
    for _ in 0..200 {
        let far = magnitude(&mut rng, -0.3, 3.0);
        let (toward, receiver) = (rng.direction(), rng.direction());
        let corners = core::array::from_fn(|_| {
            let corner = rng.direction();
            core::array::from_fn(|i| corner[i] + far * toward[i])
        });
        let heights = corners.map(|c: [f64; 3]| (0..3).map(|i| c[i] * receiver[i]).sum::<f64>());
        if heights.iter().all(|h| *h > 0.0) {
            let receiver = Receiver::new([0.0; 3], receiver).unwrap().normal();
            let expected = triangle_factor([0.0; 3], receiver, corners);
            lit += u32::from(close(polygon_configuration_factor([0.0; 3], receiver, &corners), expected, &corners));
        }
    }
    assert!(lit > 40, "{lit}");
}

/// Formulas as printed, where they don't cancel, and the general form at the same place.
#[test]
fn named_cases() {
    for (r, h, a) in [(1.0, 1.0, 2.0), (0.4, 3.55, 0.9), (2.0, 0.5, 2.5), (1.0, 10.0, 1.0)] {
        let (b, c): (f64, f64) = (h * h + a * a + r * r, h * h + a * a - r * r);
        let root = (b * b - 4.0 * r * r * a * a).sqrt();
        let (parallel, perpendicular) = (0.5 * (1.0 - c / root), h / (2.0 * a) * (b / root - 1.0));
        assert!((disk_parallel_factor(r, h, a) - parallel).abs() <= 1e-14);
        assert!((disk_perpendicular_factor(r, h, a) - perpendicular).abs() <= 1e-14);
    }
    for (r, h) in [(1.0, 1.0), (1e-6, 1.0), (1e6, 1.0), (0.4, 3.55)] {
        let expected: f64 = r * r / (r * r + h * h);
        assert!((on_axis_disk_factor(r, h) / expected - 1.0).abs() <= 4.0 * f64::EPSILON);
        assert!((disk_parallel_factor(r, h, 0.0) / expected - 1.0).abs() <= 8.0 * f64::EPSILON);
    }
    // Half of a disk is in front of an element that looks across its axis.
    let half = disk_factor([0.0, 0.0, 0.5], [0.0, 0.0, -1.0], 1.0, [0.0; 3], [-1.0, 0.0, 0.0]);
    assert!((disk_perpendicular_factor(1.0, 0.5, 0.0) / half - 1.0).abs() <= TOLERANCE);
    assert_eq!(disk_parallel_factor(0.0, 1.0, 0.0), 0.0);
}

/// Thesis eq. 1.2 and 1.3 as polygons; low and narrow rectangles too.
#[test]
fn rectangles() {
    let mut rng = Rng::new(14);
    for _ in 0..300 {
        let [a, b, h] = [0; 3].map(|_| magnitude(&mut rng, -4.0, 2.0));
        let ceiling = [[0.0, 0.0, h], [a, 0.0, h], [a, b, h], [0.0, b, h]];
        let expected = polygon_configuration_factor([0.0; 3], [0.0, 0.0, 1.0], &ceiling);
        close(rectangle_parallel_factor(a, b, h), expected, &(a, b, h));
        let wall = [[h, 0.0, 0.0], [h, b, 0.0], [h, b, a], [h, 0.0, a]];
        let expected = polygon_configuration_factor([0.0; 3], [0.0, 0.0, 1.0], &wall);
        close(rectangle_perpendicular_factor(a, b, h), expected, &(a, b, h));
    }
    // Closed values: an infinite quadrant overhead, and a square as wide and high as it is far.
    assert!((rectangle_parallel_factor(1.0, 1.0, 0.0) - 0.25_f64).abs() <= f64::EPSILON);
    let square =
        (0.5 / core::f64::consts::PI) * (core::f64::consts::FRAC_PI_4 - 0.5_f64.sqrt() * 0.5_f64.sqrt().atan());
    assert!((rectangle_perpendicular_factor(1.0, 1.0, 1.0) - square).abs() <= f64::EPSILON);
}
