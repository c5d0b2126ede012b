//! Properties of configuration factors: limits, invariances, additivity, continuity; fixed seeds and counts.
#![allow(clippy::unwrap_used, reason = "the input is constant")]
#![allow(clippy::cast_possible_truncation, reason = "rounding to single precision is meant")]

use core::f64::consts::{FRAC_1_SQRT_2, PI, TAU};

use disk_sampling::{
    Disk, Receiver, Sphere, disk_configuration_factor, disk_irradiance_vector, polygon_configuration_factor,
    sphere_configuration_factor,
};
use spectral_tests::statistics::Rng;

type Vector = [f64; 3];

const UP: Vector = [0.0, 0.0, 1.0];

fn magnitude(rng: &mut Rng, low: f64, high: f64) -> f64 {
    10_f64.powf(low + (high - low) * rng.unit())
}

fn dot(a: Vector, b: Vector) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// The factor of the disk of radius 1 at the origin that shines upwards.
fn unit_disk(position: Vector, normal: Vector) -> f64 {
    let disk = Disk::new([0.0; 3], UP, 1.0).unwrap();
    disk_configuration_factor(&disk, &Receiver::new(position, normal).unwrap())
}

fn sphere(distance: f64, normal: Vector) -> f64 {
    let sphere = Sphere::new([0.0, 0.0, distance], 1.0).unwrap();
    sphere_configuration_factor(&sphere, &Receiver::new([0.0; 3], normal).unwrap())
}

/// A receiver somewhere over the disk's plane, close to it and far, with any normal.
fn place(rng: &mut Rng) -> (Vector, Vector) {
    let (h, rho, turn) = (magnitude(rng, -3.0, 2.0), magnitude(rng, -2.0, 2.0), TAU * rng.unit());
    ([rho * turn.cos(), rho * turn.sin(), h], Receiver::new([0.0; 3], rng.direction()).unwrap().normal())
}

/// A rotation by its three columns.
fn rotation(rng: &mut Rng) -> [Vector; 3] {
    let disk = Disk::new([0.0; 3], rng.direction(), 1.0).unwrap();
    let [u, v] = disk.frame();
    [u, v, disk.normal()]
}

fn rotated([u, v, w]: [Vector; 3], x: Vector) -> Vector {
    core::array::from_fn(|i| u[i] * x[0] + v[i] * x[1] + w[i] * x[2])
}

#[test]
fn no_light_behind_and_in_the_plane() {
    for x in [0.0, 0.5, 1.0, 2.0] {
        assert_eq!(unit_disk([x, 0.0, -1e-300], UP.map(|z| -z)), 0.0);
        assert_eq!(unit_disk([x, 0.0, -1.0], UP), 0.0);
    }
    for normal in [UP, [0.0, 0.0, -1.0], [-1.0, 0.0, 0.0], [-0.6, 0.0, -0.8]] {
        assert_eq!(unit_disk([1.5, 0.0, 0.0], normal), 0.0);
        assert_eq!(unit_disk([1.0 + f64::EPSILON, 0.0, 0.0], normal), 0.0);
    }
    let disk = Disk::new([0.0; 3], UP, 1.0).unwrap();
    assert_eq!(disk_irradiance_vector(&disk, [0.0, 0.0, -1.0]), [0.0; 3]);
    assert_eq!(disk_irradiance_vector(&disk, [3.0, 0.0, 0.0]), [0.0; 3]);
    let square = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
    for x in [0.5, 1.0, 2.0] {
        assert_eq!(polygon_configuration_factor([x, 0.5, 0.0], [0.6, 0.0, 0.8], &square), 0.0);
    }
    assert_eq!(polygon_configuration_factor([0.5, 0.5, 1.0], UP.map(|z| -z), &square[..2]), 0.0);
}

/// On the disk the light fills half of space, on the rim a quarter; a little above it is the same to first order in the height.
#[test]
fn contact() {
    let mut rng = Rng::new(21);
    for _ in 0..300 {
        let normal = Receiver::new([0.0; 3], rng.direction()).unwrap().normal();
        let half = 0.5 * (1.0 - normal[2]);
        // The rim's normal is x: light comes from where x < 0 and z < 0. Lambert's formula for its two half planes, cut.
        let quarter = lune([-normal[0], normal[1], -normal[2]]);
        for (position, expected) in [([0.3, 0.2, 0.0], half), ([0.0; 3], half), ([1.0, 0.0, 0.0], quarter)] {
            let found = unit_disk(position, normal);
            assert!((found - expected).abs() <= 1e-14, "{position:?} {normal:?}: {found}, not {expected}");
            for height in [1e-300, 1e-30, 1e-15, 1e-9, 1e-6] {
                let found = unit_disk([position[0], position[1], height], normal);
                assert!(
                    (found - expected).abs() <= 1e-14 + 10.0 * height,
                    "{position:?} {height:e} {normal:?}: {found}, not {expected}"
                );
            }
        }
        let on_sphere = sphere(1.0, normal);
        assert!((on_sphere - 0.5 * (1.0 + normal[2])).abs() <= 1e-14, "{normal:?}: {on_sphere}");
        // A gap δ hides a band of √(2 δ) over the tangent plane.
        assert!((sphere(1.0 + 1e-12, normal) - on_sphere).abs() <= 2e-12_f64.sqrt());
        assert_eq!(sphere(0.999, normal), 1.0);
        assert_eq!(sphere(0.0, normal), 1.0);
    }
}

/// The factor of the directions x > 0, z > 0: cos-weighted, by the fan of horizons; n any unit vector.
fn lune(n: Vector) -> f64 {
    // The wedge's edges are ±y. Its faces z = 0 (x > 0) and x = 0 (z > 0) are half circles, cut where n·ω = 0.
    let arc = |toward: Vector, inward: f64| {
        // Directions cos f y + sin f `toward`, f in (0, π): n·ω = a cos f + b sin f > 0.
        let (a, b) = (n[1], dot(n, toward));
        let zero = (-a).atan2(b).rem_euclid(PI);
        let starts_lit = a > 0.0 || (a == 0.0 && b > 0.0);
        let lit = if starts_lit { zero } else { PI - zero };
        let end = [zero.cos() * 1.0, zero.sin()];
        (lit * inward, core::array::from_fn(|i| end[0] * [0.0, 1.0, 0.0][i] + end[1] * toward[i]))
    };
    let (floor, first): (f64, Vector) = arc([1.0, 0.0, 0.0], n[2]);
    let (wall, second): (f64, Vector) = arc([0.0, 0.0, 1.0], n[0]);
    let cosine = dot(first, second).clamp(-1.0, 1.0);
    // The horizon's own arc inside the wedge runs from one end to the other.
    (floor + wall + cosine.acos()) / TAU
}

/// F(n) − F(−n) is the component of the irradiance vector, whatever the horizon cuts.
#[test]
fn both_sides_make_the_vector() {
    let mut rng = Rng::new(22);
    let disk = Disk::new([0.0; 3], UP, 1.0).unwrap();
    for _ in 0..5000 {
        let (position, normal) = place(&mut rng);
        let vector = disk_irradiance_vector(&disk, position);
        let difference = unit_disk(position, normal) - unit_disk(position, normal.map(|x| -x));
        let length = dot(vector, vector).sqrt();
        assert!(
            (difference - dot(vector, normal)).abs() <= 1e-13 * length.max(difference.abs()),
            "{position:?} {normal:?}"
        );
    }
}

/// Powers of two leave every bit.
#[test]
fn scale_invariance() {
    let mut rng = Rng::new(23);
    for _ in 0..2000 {
        let (position, normal) = place(&mut rng);
        let centre = rng.direction();
        let corners: [Vector; 3] = [0; 3].map(|_| rng.direction());
        let factors = |scale: f64| {
            let receiver = Receiver::new(position.map(|x| x * scale), normal).unwrap();
            let centre = centre.map(|x| x * scale);
            let disk = Disk::new(centre, [0.0, 0.6, 0.8], scale).unwrap();
            let sphere = Sphere::new(centre, 0.25 * scale).unwrap();
            let corners = corners.map(|c| c.map(|x| x * scale));
            [
                disk_configuration_factor(&disk, &receiver),
                sphere_configuration_factor(&sphere, &receiver),
                polygon_configuration_factor(receiver.position(), normal, &corners),
            ]
        };
        let one = factors(1.0).map(f64::to_bits);
        for exponent in [-300, -3, 1, 60, 300] {
            assert_eq!(factors(2_f64.powi(exponent)).map(f64::to_bits), one, "2^{exponent} {position:?} {normal:?}");
        }
    }
}

#[test]
fn rotation_invariance() {
    let mut rng = Rng::new(24);
    let mut lit = 0;
    for _ in 0..3000 {
        let (position, normal) = place(&mut rng);
        let turn = rotation(&mut rng);
        let receiver = Receiver::new(rotated(turn, position), rotated(turn, normal)).unwrap();
        let disk = Disk::new([0.0; 3], rotated(turn, UP), 1.0).unwrap();
        let (found, expected) = (disk_configuration_factor(&disk, &receiver), unit_disk(position, normal));
        // Rounding the turned coordinates tilts everything by ε, which near the plane and near the rim is much of the cone.
        let view = position[2].min((position[0].hypot(position[1]) - 1.0).abs().hypot(position[2]));
        let tolerance = 5e-14 * (1.0 + dot(position, position)) / (view * view);
        assert!(
            (found - expected).abs() <= tolerance.min(1e-3) * expected.max(1e-3),
            "{position:?} {normal:?}: {found}, {expected}"
        );
        lit += u32::from(expected > 0.0);
    }
    assert!(lit > 1000, "{lit}");
}

/// The disk is between its inscribed and circumscribed polygon, and both come close.
#[test]
fn polygons_enclose_the_disk() {
    const SIDES: u32 = 512;
    let mut rng = Rng::new(25);
    let corners = |radius: f64| -> Vec<Vector> {
        (0..SIDES)
            .map(|i| f64::from(i) * TAU / f64::from(SIDES))
            .map(|t| [radius * t.cos(), radius * t.sin(), 0.0])
            .collect()
    };
    let (inner, outer) = (corners(1.0), corners(1.0 / (PI / f64::from(SIDES)).cos()));
    let mut lit = 0;
    for _ in 0..400 {
        let (position, normal) = place(&mut rng);
        let factor = unit_disk(position, normal);
        let [low, high] = [&inner, &outer].map(|corners| polygon_configuration_factor(position, normal, corners));
        let slack = 1e-11 * high;
        assert!(low - slack <= factor && factor <= high + slack, "{low:e} {factor:e} {high:e} {position:?} {normal:?}");
        if factor > 1e-3 && position[2] > 0.1 {
            assert!((high - low) / factor <= 0.02, "{low} {high}");
            lit += 1;
        }
    }
    assert!(lit > 40, "{lit}");
}

/// Cutting a polygon changes nothing in sum, whichever way each part is computed.
#[test]
fn polygons_add_up() {
    let mut rng = Rng::new(26);
    let mut lit = 0;
    for _ in 0..3000 {
        let (position, normal) = place(&mut rng);
        let [a, b] = [0; 2].map(|_| magnitude(&mut rng, -2.0, 1.0));
        let split = a * rng.unit();
        let quad = |from: f64, to: f64| [[from, -b, 0.0], [to, -b, 0.0], [to, b, 0.0], [from, b, 0.0]];
        let factor = |corners: &[Vector]| polygon_configuration_factor(position, normal, corners);
        let whole = factor(&quad(0.0, a));
        let parts = factor(&quad(0.0, split)) + factor(&quad(split, a));
        assert!((whole - parts).abs() <= 2e-12 * whole, "{whole:e} {parts:e} {position:?} {normal:?} {a} {b} {split}");
        let mut turned = quad(0.0, a);
        turned.reverse();
        assert!((factor(&turned) - whole).abs() <= 2e-12 * whole);
        lit += u32::from(whole > 0.0);
    }
    assert!(lit > 1000, "{lit}");
}

/// From one representable receiver to the next nothing jumps: not where the closed form gives way to the integral, where the horizon
/// touches the rim, on the rim's axis, or where a sphere begins to be cut.
#[test]
fn no_jumps() {
    let mut rng = Rng::new(27);
    let step = |x: f64, up: bool| if up { x.next_up() } else { x.next_down() };
    let mut small = 0;
    for i in 0..20_000_u32 {
        let (mut position, normal) = place(&mut rng);
        position[2] = position[2].max(0.05);
        if i % 8 == 0 {
            (position[0], position[1]) = (1.0, 0.0);
        }
        let here = unit_disk(position, normal);
        let axis = (i % 3) as usize;
        let mut moved = position;
        moved[axis] = step(moved[axis], i % 2 == 0);
        // The largest change of a factor by a turn or a shift over the distance is of order one, thus of its root where it is small.
        let bound = |f: f64| 2e-12 * f + 4.0 * f64::EPSILON * f.sqrt() / position[2].min(1.0);
        let jump = (unit_disk(moved, normal) - here).abs();
        assert!(jump <= bound(here.max(1e-28)), "{position:?} {normal:?}: {here:e} jumps by {jump:e}");
        let mut tilted = normal;
        tilted[axis] = step(tilted[axis], i % 2 == 0);
        let jump = (sphere(1.0 + position[2], tilted) - sphere(1.0 + position[2], normal)).abs();
        assert!(jump <= bound(sphere(1.0 + position[2], normal).max(1e-28)), "{position:?} {normal:?} {jump:e}");
        small += u32::from(here > 0.0 && here < 1e-3);
    }
    assert!(small > 2000, "{small}");
}

/// Single precision agrees with double precision at the same coordinates.
#[test]
fn precisions_agree() {
    let mut rng = Rng::new(28);
    let mut lit = 0;
    for _ in 0..4000 {
        let (position, normal) = place(&mut rng);
        let position = position.map(|x| x as f32);
        let receiver = Receiver::new(position, normal.map(|x| x as f32)).unwrap();
        let single =
            f64::from(disk_configuration_factor(&Disk::new([0.0_f32; 3], [0.0, 0.0, 1.0], 1.0).unwrap(), &receiver));
        // The same direction: normalised once more in double precision.
        let double = unit_disk(position.map(f64::from), receiver.normal().map(f64::from));
        assert!((single - double).abs() <= 1e-5 * double + 1e-25, "{receiver:?}: {single:e} {double:e}");
        lit += u32::from(double > 0.0);
    }
    assert!(lit > 2000, "{lit}");
}

/// Nothing that the shapes take gives NaN, a negative factor or more than one.
#[test]
fn extreme_input() {
    let lengths = [0.0, f64::MIN_POSITIVE, 1e-160, 1e-20, 1.0, 1e20, 1e150, 1e300, f64::MAX];
    for x in lengths {
        for z in lengths {
            for radius in &lengths[1..] {
                for normal in [UP, [0.0, 0.0, -1.0], [-FRAC_1_SQRT_2, 0.0, -FRAC_1_SQRT_2], [-1.0, 0.0, 0.0]] {
                    let receiver = Receiver::new([x, 0.0, z], normal).unwrap();
                    let disk = Disk::new([0.0; 3], UP, *radius).unwrap();
                    let ball = Sphere::new([0.0; 3], *radius).unwrap();
                    let corners = [[-radius, 0.0, 0.0], [*radius, 0.0, 0.0], [0.0, *radius, 0.0]];
                    let factors = [
                        disk_configuration_factor(&disk, &receiver),
                        sphere_configuration_factor(&ball, &receiver),
                        polygon_configuration_factor(receiver.position(), normal, &corners),
                    ];
                    for factor in factors {
                        assert!(
                            (0.0..=1.0 + 4.0 * f64::EPSILON).contains(&factor),
                            "{x:e} {z:e} {radius:e} {normal:?}: {factors:?}"
                        );
                    }
                }
            }
        }
    }
}

/// So far away that squares of angles underflow, cut by the horizon: a number, and next to nothing; 1e-20 is where accuracy is promised from.
#[test]
fn far_shapes_at_the_horizon_have_finite_factors() {
    let mut rng = Rng::new(5);
    for _ in 0..20_000 {
        let exponent = -25.0 + 7.0 * rng.unit();
        let size = 10_f64.powf(exponent);
        let centre = [1.0, 0.3 * rng.unit(), size * (2.0 * rng.unit() - 1.0)].map(|c| c as f32);
        let receiver = Receiver::new([0.0_f32; 3], [0.0, 0.0, 1.0]).unwrap();
        let most = 2.0 * (size * size) as f32 + 1e-20;
        let ball = sphere_configuration_factor(&Sphere::new(centre, size as f32).unwrap(), &receiver);
        assert!((0.0..=most).contains(&ball), "{ball:e} of a sphere of radius {size:e}");
        let towards = rng.direction().map(|c| c as f32);
        let disk = disk_configuration_factor(&Disk::new(centre, towards, size as f32).unwrap(), &receiver);
        assert!((0.0..=most).contains(&disk), "{disk:e} of a disk of radius {size:e}");
    }
}

/// The same where one that was found by fuzzing was not a number.
#[test]
fn the_farthest_spheres_at_the_horizon_have_finite_factors() {
    let cases = [
        ([1.375e22, 1.781_25e9, 0.013_977_264], 0.423_392_1, [3e-43, 0.003_906_309_6, 0.0], [0.0, 0.0, 1.0]),
        (
            [0.011_718_929, 0.419_607_85, 108.417_97],
            0.427_435_73,
            [-6.462_348_5e-27, 0.0, 1.558_593_7e22],
            [1.0, 3.258_427_7e-10, 0.0],
        ),
    ];
    for (centre, radius, position, normal) in cases {
        let receiver = Receiver::<f32>::new(position, normal).unwrap();
        let factor = sphere_configuration_factor(&Sphere::new(centre, radius).unwrap(), &receiver);
        assert!((0.0..=1e-40).contains(&factor), "{factor:e}");
    }
}
