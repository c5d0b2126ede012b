//! Disk lights at the edges of what is documented: limits that belong to a domain, parts below the horizon, light from afar, small holes.
#![allow(clippy::unwrap_used, reason = "the input is constant")]

use core::f64::consts::PI;

use disk_sampling::estimate::{Aim, EstimateError, Panel, Request, Response, Status, integrate, ratio, ratio_of_parts};
use disk_sampling::partition::{Label, Method, Partition, Subsource};
use disk_sampling::{
    Disk, Receiver, Sphere, disk_configuration_factor, disk_to_square_polar, hexagon_to_disk_pdf,
    polygon_configuration_factor, sphere_configuration_factor, square_to_disk_elliptical_pdf, square_to_disk_pdf,
    square_to_disk_polar_pdf,
};
use spectral_tests::statistics::Rng;

fn disk() -> Disk<f64> {
    Disk::new([0.0; 3], [0.0, 0.0, 1.0], 1.0).unwrap()
}

fn request(relative_error: f64, max_samples: usize) -> Request<f64> {
    Request { relative_error, max_samples, strata: 1 }
}

#[test]
fn the_rim_belongs_to_the_disk() {
    let densities: [fn([f64; 2]) -> f64; 3] = [square_to_disk_pdf, square_to_disk_polar_pdf, hexagon_to_disk_pdf];
    for pdf in densities {
        for point in [[1.0, 0.0], [0.0, -1.0], [0.6, 0.8], [1.0_f64.next_up(), 0.0]] {
            assert!((pdf(point) * PI - 1.0).abs() <= 2.0 * f64::EPSILON, "{point:?}");
        }
        assert_eq!(pdf([1.0 + 1e-12, 0.0]), 0.0);
    }
    let whole = Subsource::<f64>::new(Method::Hexagon, Label::root(Method::Hexagon));
    assert_eq!(whole.sample(1.0, [1.0, 0.0]), ([1.0, 0.0], true));
}

#[test]
fn turns_are_below_one() {
    for below in [f64::MIN_POSITIVE, 1e-300, 1e-20, 1e-17, 1e-16] {
        let [_, v] = disk_to_square_polar([1.0, -below]);
        assert!((1.0 - f64::EPSILON..1.0).contains(&v), "{below}: {v}");
    }
}

/// At the images of the corners the density is without bound, and limited to 1/(8 ε).
#[test]
fn the_elliptical_density_is_limited_at_the_corners() {
    let corner = 0.5_f64.sqrt();
    for x in [corner.next_down(), corner, corner.next_up()] {
        for y in [corner.next_down(), corner, corner.next_up()] {
            for [x, y] in [[x, y], [-x, y], [x, -y], [-x, -y]] {
                let density = square_to_disk_elliptical_pdf([x, y]);
                let most = 1.0 / (8.0 * f64::EPSILON) * (1.0 + 1e-7);
                assert!((1e6..=most).contains(&density), "{x} {y}: {density}");
            }
        }
    }
}

/// A part is divided while its size over the distance is above the threshold, not where both are equal.
#[test]
fn a_part_of_just_the_threshold_is_not_divided() {
    for method in Method::ALL {
        let extent = Subsource::<f64>::new(method, Label::root(method)).extent();
        let parts = |threshold| Partition::adaptive(method, 6, &disk(), [0.0, 0.0, 1.0], threshold).unwrap().count();
        assert_eq!(parts(extent), 1, "{method:?}");
        assert!(parts(extent.next_down()) > 1, "{method:?}");
    }
}

/// Against the sums that its documentation states.
#[test]
fn parts_below_the_horizon_are_not_asked() {
    let mut rng = Rng::new(31);
    for _ in 0..200 {
        let position = [2.0 * rng.unit() - 1.0, 2.0 * rng.unit() - 1.0, 0.1 + rng.unit()];
        let receiver = Receiver::new(position, [rng.unit() - 0.5, rng.unit() - 0.5, 0.4 * rng.unit() - 0.3]).unwrap();
        let exact = disk_configuration_factor(&disk(), &receiver);
        let respond = |[x, y]: [f64; 2]| Response { emission: 1.0 + y, visibility: if x > 0.1 { 1.0 } else { 0.25 } };
        let (mut above, mut lit, mut full) = (0, 0.0, 0.0);
        for part in Partition::full(Method::Hexagon, 6).unwrap().filter(Subsource::hits) {
            let [x, y] = part.position();
            let away = [x - position[0], y - position[1], -position[2]];
            let square: f64 = away.iter().map(|x| x * x).sum();
            let cosine: f64 = away.iter().zip(receiver.normal()).map(|(a, n)| a * n).sum();
            if cosine > 0.0 {
                let Response { emission, visibility } = respond([x, y]);
                let kernel = part.weight() * cosine * position[2] / (square * square);
                above += 1;
                full += kernel * emission;
                lit += kernel * emission * visibility;
            }
        }
        let parts = Partition::full(Method::Hexagon, 6).unwrap();
        let (value, samples) = ratio_of_parts(parts, &disk(), &receiver, exact, |aim| respond(aim.on_disk)).unwrap();
        assert_eq!(samples, above, "{receiver:?}");
        let expected = if above > 0 { exact * lit / full } else { 0.0 };
        assert!((value - expected).abs() <= 1e-13 * exact, "{receiver:?}: {value} {expected}");
    }
}

#[test]
fn parts_refuse_what_estimates_refuse() {
    let receiver = |z: f64| Receiver::new([0.0, 0.0, z], [0.0, 0.0, -1.0]).unwrap();
    let run = |receiver: &Receiver<f64>, exact, emission, visibility| {
        let parts = Partition::full(Method::EqualAreaHexagon, 3).unwrap();
        ratio_of_parts(parts, &disk(), receiver, exact, |_| Response { emission, visibility })
    };
    assert_eq!(run(&receiver(1.0), 0.5, 2.0, 1.0), Ok((0.5, 24)));
    assert_eq!(run(&receiver(1.0), 0.5, 0.0, 1.0), Ok((0.0, 24)));
    assert_eq!(run(&receiver(-1.0), 0.5, 1.0, 1.0), Ok((0.0, 0)));
    assert_eq!(run(&receiver(0.0), 0.5, 1.0, 1.0), Ok((0.0, 0)));
    for bad in [-1.0, f64::NAN, f64::INFINITY] {
        assert_eq!(run(&receiver(1.0), bad, 1.0, 1.0), Err(EstimateError::Exact));
        assert_eq!(run(&receiver(1.0), 0.5, bad, 1.0), Err(EstimateError::Response));
        assert_eq!(run(&receiver(1.0), 0.5, 1.0, bad), Err(EstimateError::Response));
    }
}

/// So far away that squares of distances overflow, the centre stands for the disk.
#[test]
fn from_afar_the_centre_counts() {
    let receiver = Receiver::new([0.0, 0.0, 1e153], [0.0, 0.0, -1.0]).unwrap();
    let factor = disk_configuration_factor(&disk(), &receiver);
    assert!((factor / 1e-306 - 1.0).abs() <= 1e-12, "{factor:e}");
    let mut panels = [Panel::default(); 4];
    let mut run = |exact: Option<f64>, emission, visibility| {
        let respond = |aim: &Aim<f64>| {
            assert_eq!((aim.on_disk, aim.point, aim.cosine), ([0.0; 2], [0.0; 3], 1.0));
            Response { emission, visibility }
        };
        let found = match exact {
            Some(exact) => ratio(&disk(), &receiver, exact, &request(0.1, 100), &mut panels, respond),
            None => integrate(&disk(), &receiver, &request(0.1, 100), &mut panels, respond),
        };
        found.map(|found| {
            assert_eq!((found.samples, found.status, found.error), (1, Status::Met, 0.0));
            found.value
        })
    };
    assert_eq!(run(None, 2.0, 0.5), Ok(factor));
    assert_eq!(run(Some(3.0), 2.0, 0.5), Ok(1.5));
    // What sends nothing is dark, whatever its value should have been.
    assert_eq!(run(Some(3.0), 0.0, 1.0), Ok(0.0));
    assert_eq!(run(None, f64::NAN, 1.0), Err(EstimateError::Response));
    assert_eq!(run(Some(3.0), 1.0, -1.0), Err(EstimateError::Response));
}

/// Few samples of many edges: coarse rules have weights of either sign, but a share is a share.
#[test]
fn no_more_than_all_of_the_light_arrives() {
    let mut rng = Rng::new(5);
    let mut panels = [Panel::default(); 8];
    for case in 0..20_000 {
        let position = [1.4 * rng.unit() - 0.7, 1.4 * rng.unit() - 0.7, 0.02 + rng.unit()];
        let receiver = Receiver::new(position, rng.direction()).unwrap();
        let exact = disk_configuration_factor(&disk(), &receiver);
        if !(exact > 1e-6) {
            continue;
        }
        let (turn, pitch, phase) = (6.0 * rng.unit(), 1.0 + 8.0 * rng.unit(), 6.0 * rng.unit());
        let bars = |[x, y]: [f64; 2]| {
            let wave = (pitch * (x * turn.cos() + y * turn.sin()) + phase).sin();
            if wave > 0.7 { 0.0 } else { 1.0 }
        };
        // Light that is uneven makes weights uneven, too.
        let respond =
            |aim: &Aim<f64>| Response { emission: (4.0 * (aim.on_disk[0] - 0.3)).exp(), visibility: bars(aim.on_disk) };
        let found = ratio(&disk(), &receiver, exact, &request(0.9, 9), &mut panels, respond).unwrap();
        assert!(found.value >= 0.0 && found.value <= exact, "{case}: {found:?} of {exact}");
    }
}

/// Where 3 × 3 samples see only darkness, 9 × 9 follow: a hole of a 25th of the disk's area holds three of these in the mean.
#[test]
fn holes_that_the_first_samples_miss_are_looked_for() {
    let mut rng = Rng::new(8);
    let mut panels = [Panel::default(); 64];
    let (mut found, mut cases) = (0, 0);
    for _ in 0..400 {
        let receiver = Receiver::new([0.0, 0.0, 2.0], [0.0, 0.0, -1.0]).unwrap();
        let (turn, off) = (6.3 * rng.unit(), 0.7 * rng.unit().sqrt());
        let hole = [off * turn.cos(), off * turn.sin()];
        let respond = |aim: &Aim<f64>| Response {
            emission: 1.0,
            visibility: if (aim.on_disk[0] - hole[0]).hypot(aim.on_disk[1] - hole[1]) < 0.2 { 1.0 } else { 0.0 },
        };
        let exact = disk_configuration_factor(&disk(), &receiver);
        let value = ratio(&disk(), &receiver, exact, &request(0.01, 100_000), &mut panels, respond).unwrap().value;
        cases += 1;
        found += u32::from(value > 0.0);
    }
    assert!(f64::from(found) >= 0.9 * f64::from(cases), "{found} of {cases}");
}

/// A blind that lets seven tenths through has an edge as one has that lets nothing through, which matters less: it takes fewer samples.
#[test]
fn edges_of_half_shadows_are_followed() {
    let mut rng = Rng::new(14);
    let mut panels = vec![Panel::default(); 512];
    let (mut samples, mut cases) = ([0_usize; 2], 0);
    for _ in 0..100 {
        let receiver = Receiver::new([rng.unit() - 0.5, rng.unit() - 0.5, 0.2 + rng.unit()], [0.1, 0.2, -1.0]).unwrap();
        let exact = disk_configuration_factor(&disk(), &receiver);
        let (turn, off) = (6.3 * rng.unit(), rng.unit() - 0.5);
        cases += 1;
        for (behind, samples) in [0.0, 0.7].into_iter().zip(&mut samples) {
            let respond = |aim: &Aim<f64>| {
                let side = aim.on_disk[0] * turn.cos() + aim.on_disk[1] * turn.sin();
                Response { emission: 1.0, visibility: if side > off { behind } else { 1.0 } }
            };
            *samples +=
                ratio(&disk(), &receiver, exact, &request(1e-3, 100_000), &mut panels, respond).unwrap().samples;
        }
    }
    assert!(4 * samples[1] <= 3 * samples[0], "{samples:?} in {cases} cases");
}

/// On a sphere the factor is (1 + cos θ)/2, which is next to nothing where the element faces away: sin² θ / (2 − 2 cos θ).
#[test]
fn elements_on_a_sphere_that_face_away_are_exact() {
    let sphere = Sphere::new([0.0; 3], 1.0).unwrap();
    for sine in [0.5_f64, 1e-1, 1e-3, 1e-5, 1e-7] {
        let cosine = (1.0 - sine * sine).sqrt();
        for (away, expected) in [(cosine, 0.5 * sine * sine / (1.0 + cosine)), (-cosine, 0.5 * (1.0 + cosine))] {
            let receiver = Receiver::new([1.0, 0.0, 0.0], [away, sine, 0.0]).unwrap();
            let found: f64 = sphere_configuration_factor(&sphere, &receiver);
            assert!((found / expected - 1.0).abs() <= 1e-12, "{sine} {away}: {found:e} {expected:e}");
        }
    }
}

#[test]
fn points_whose_distance_overflows_have_places() {
    let disk = Disk::new([-1.5e308, 0.0, 0.0], [0.0, 0.0, 1.0], 1e308).unwrap();
    let [x, y, z]: [f64; 3] = disk.local([1.5e308, 0.0, 0.0]);
    assert!((x.hypot(y) - 3.0).abs() <= 1e-15 && z == 0.0, "{x} {y} {z}");
    let [u, v] = disk.frame();
    assert!((x * u[0] + y * v[0] - 3.0).abs() <= 1e-15);
}

/// Corners that are given more than once change nothing, whichever formula is taken: near, far, and cut by the horizon.
#[test]
fn repeated_corners_change_nothing() {
    for (size, height, normal) in [
        (1.0, 1.0, [0.0, 0.0, 1.0]),
        (1e-6, 1.0, [0.0, 0.0, 1.0]),
        (1.0, 1e9, [0.6, 0.0, 0.8]),
        (1.0, 1e-4, [1.0, 0.0, 0.0]),
    ] {
        let corners = [[-0.3, -0.4], [0.7, -0.3], [0.5, 0.6], [-0.4, 0.5]].map(|[x, y]| [size * x, size * y, height]);
        let factor = |corners: &[[f64; 3]]| polygon_configuration_factor([0.0; 3], normal, corners);
        let once = factor(&corners);
        assert!(once > 0.0);
        for place in 0..4 {
            for times in 1..4 {
                let mut more = corners.to_vec();
                more.splice(place..place, core::iter::repeat_n(corners[place], times));
                let found = factor(&more);
                assert!((found / once - 1.0).abs() <= 1e-12, "{size} {height}, {place}: {found:e} {once:e}");
            }
        }
    }
}
