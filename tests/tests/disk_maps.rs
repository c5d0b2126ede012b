//! Maps between square, hexagon and disk: densities by chi-square, inverses, Jacobians, the rim.
#![allow(clippy::unwrap_used, reason = "the input is constant")]

use core::f64::consts::{PI, TAU};

use disk_sampling::{
    disk_to_hexagon, disk_to_square, disk_to_square_elliptical, disk_to_square_polar, hexagon_to_disk,
    hexagon_to_disk_pdf, square_to_disk, square_to_disk_elliptical, square_to_disk_elliptical_pdf, square_to_disk_pdf,
    square_to_disk_polar, square_to_disk_polar_pdf,
};
use spectral_tests::statistics::{ChiSquare, Rng};

const SAMPLES: u32 = 200_000;
const RINGS: usize = 16;
const TURNS: usize = 24;
const SIGNIFICANCE: f64 = 1e-3;
/// The number of chi-square tests in this file that are expected to pass, for Šidák's correction.
const TESTS: u32 = 4;

/// Counts samples in cells of squared radius and angle, against the density integrated over them by 32 × 32 midpoints.
fn chi_square(mut sample: impl FnMut() -> [f64; 2], pdf: impl Fn([f64; 2]) -> f64) -> ChiSquare {
    let mut observed = vec![0; RINGS * TURNS];
    for _ in 0..SAMPLES {
        let [x, y] = sample();
        let (ring, turn) = (x * x + y * y, y.atan2(x) / TAU + 0.5);
        observed[cell(ring, RINGS) * TURNS + cell(turn, TURNS)] += 1;
    }
    let steps = 32;
    let mut expected = vec![0.0; RINGS * TURNS];
    for (index, value) in expected.iter_mut().enumerate() {
        for i in 0..steps * steps {
            let at = |index: usize, step: usize, count: usize| {
                (number(index) + (number(step) + 0.5) / number(steps)) / number(count)
            };
            let radius = at(index / TURNS, i / steps, RINGS).sqrt();
            let angle = TAU * (at(index % TURNS, i % steps, TURNS) - 0.5);
            *value += pdf([radius * angle.cos(), radius * angle.sin()]);
        }
        *value *= f64::from(SAMPLES) * PI / number(RINGS * TURNS * steps * steps);
    }
    ChiSquare::new(&observed, &expected)
}

fn number(x: usize) -> f64 {
    f64::from(u32::try_from(x).unwrap())
}

#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a cell")]
fn cell(x: f64, count: usize) -> usize {
    ((x * number(count)) as usize).min(count - 1)
}

type Map = fn([f64; 2]) -> [f64; 2];
type Pdf = fn([f64; 2]) -> f64;

const MAPS: [(&str, Map, Pdf, Map); 3] = [
    ("concentric", square_to_disk, square_to_disk_pdf, disk_to_square),
    ("elliptical", square_to_disk_elliptical, square_to_disk_elliptical_pdf, disk_to_square_elliptical),
    ("polar", square_to_disk_polar, square_to_disk_polar_pdf, disk_to_square_polar),
];

/// Uniform on the hexagon, by rejection from the square around it.
fn hexagon(rng: &mut Rng) -> [f64; 2] {
    let side = (TAU / (3.0 * 3.0_f64.sqrt())).sqrt();
    loop {
        let [x, y] = [rng.unit(), rng.unit()].map(|u| side * (2.0 * u - 1.0));
        let apothem = side * 0.75_f64.sqrt();
        if y.abs() <= apothem && 0.75_f64.sqrt() * x.abs() + 0.5 * y.abs() <= apothem {
            return [x, y];
        }
    }
}

#[test]
fn samples_follow_their_densities() {
    let mut rng = Rng::new(2024);
    for (name, map, pdf, _) in MAPS {
        let result = chi_square(|| map([rng.unit(), rng.unit()]), pdf);
        println!("{name}: {result}");
        assert!(result.accepts(SIGNIFICANCE, TESTS), "{name}: {result}");
    }
    let result = chi_square(|| hexagon_to_disk(hexagon(&mut rng)), hexagon_to_disk_pdf);
    println!("hexagon: {result}");
    assert!(result.accepts(SIGNIFICANCE, TESTS), "hexagon: {result}");
    // The mapped square is not uniform, and the test sees it.
    let wrong = chi_square(|| square_to_disk_elliptical([rng.unit(), rng.unit()]), square_to_disk_pdf);
    assert!(!wrong.accepts(SIGNIFICANCE, 1000));
}

#[test]
fn inverses_come_back() {
    let mut rng = Rng::new(5);
    for _ in 0..20_000 {
        let point = [rng.unit(), rng.unit()];
        for (name, map, _, inverse) in MAPS {
            let back = inverse(map(point));
            let error = (back[0] - point[0]).abs().max((back[1] - point[1]).abs());
            // The elliptical map folds towards the corners, where its inverse loses half of the digits.
            let tolerance = if name == "elliptical" { 4.0 * f64::EPSILON.sqrt() } else { 16.0 * f64::EPSILON };
            assert!(error <= tolerance, "{name} {point:?} {back:?}");
        }
        let point = hexagon(&mut rng);
        let back = disk_to_hexagon(hexagon_to_disk(point));
        assert!(
            (back[0] - point[0]).abs().max((back[1] - point[1]).abs()) <= 16.0 * f64::EPSILON,
            "{point:?} {back:?}"
        );
    }
}

/// The density is 1 over the Jacobian determinant by central differences.
#[test]
fn densities_are_jacobians() {
    let mut rng = Rng::new(6);
    for _ in 0..2000 {
        let at = [0.02 + 0.96 * rng.unit(), 0.02 + 0.96 * rng.unit()];
        // Away from the lines on which the maps have creases.
        if (at[0] - at[1]).abs() < 1e-3 || (at[0] + at[1] - 1.0).abs() < 1e-3 {
            continue;
        }
        for (name, map, pdf, _) in MAPS {
            let h = 1e-5;
            let slope = |axis: usize| {
                let (mut up, mut down) = (at, at);
                up[axis] += h;
                down[axis] -= h;
                let (up, down) = (map(up), map(down));
                [(up[0] - down[0]) / (2.0 * h), (up[1] - down[1]) / (2.0 * h)]
            };
            let (du, dv) = (slope(0), slope(1));
            let jacobian = (du[0] * dv[1] - du[1] * dv[0]).abs();
            assert!((jacobian * pdf(map(at)) - 1.0).abs() <= 1e-6, "{name} {at:?}");
        }
    }
}

#[test]
fn rim_centre_and_outside_are_defined() {
    for (name, map, pdf, inverse) in MAPS {
        assert_eq!(pdf([0.8, 0.7]), 0.0, "{name}");
        assert_eq!(pdf([f64::NAN, 0.0]), 0.0, "{name}");
        assert!(inverse([0.0, 0.0]).iter().all(|x| x.is_finite()), "{name}");
        for i in 0..=64 {
            for corner in
                [[0.0, number(i) / 64.0], [1.0, number(i) / 64.0], [number(i) / 64.0, 0.0], [number(i) / 64.0, 1.0]]
            {
                let [x, y] = map(corner);
                assert!(x.hypot(y) <= 1.0 + 4.0 * f64::EPSILON, "{name} {corner:?}");
            }
        }
    }
    assert_eq!(hexagon_to_disk([0.0_f64, 0.0]), [0.0, 0.0]);
    assert_eq!(disk_to_hexagon([0.0_f64, 0.0]), [0.0, 0.0]);
    assert!((square_to_disk_elliptical_pdf([0.0_f64, 0.0]) - 0.25).abs() <= f64::EPSILON);
}
