//! Estimates to a requested relative error: 10 000 random receivers, shadows, extremes, refusals.
#![allow(clippy::unwrap_used, reason = "the input is constant")]
#![allow(clippy::print_stdout, reason = "the tables are results")]

use core::f64::consts::TAU;

use disk_sampling::estimate::{
    Aim, Estimate, EstimateError, Panel, Request, Response, Status, integrate, ratio, ratio_of_parts,
};
use disk_sampling::partition::{Method, Partition, Subsource};
use disk_sampling::{Disk, Receiver, disk_configuration_factor, polygon_configuration_factor};
use spectral_core::Real;
use spectral_tests::statistics::Rng;

const RECEIVERS: usize = 10_000;
const REQUESTS: [f64; 3] = [1e-2, 1e-3, 1e-4];

fn disk() -> Disk<f64> {
    Disk::new([0.0; 3], [0.0, 0.0, 1.0], 1.0).unwrap()
}

/// Heights from a thousandth to ten radii, feet under the disk, close to the rim on either side, or anywhere up to four
/// radii away; normals in all directions, so that the horizon cuts many disks; what receives less than 1e-7 is drawn
/// again.
fn receiver(rng: &mut Rng) -> Receiver<f64> {
    loop {
        let height = 10.0_f64.powf(4.0 * rng.unit() - 3.0);
        let kind = rng.unit();
        let foot = if kind < 1.0 / 3.0 {
            rng.unit().sqrt()
        } else if kind < 2.0 / 3.0 {
            let gap = 10.0_f64.powf(2.5 * rng.unit() - 3.0);
            if rng.unit() < 0.5 { (1.0 - gap).abs() } else { 1.0 + gap }
        } else {
            4.0 * rng.unit()
        };
        let (sin, cos) = (TAU * rng.unit()).sin_cos();
        let receiver = Receiver::new([foot * cos, foot * sin, height], rng.direction()).unwrap();
        if disk_configuration_factor(&disk(), &receiver) >= 1e-7 {
            return receiver;
        }
    }
}

fn request(relative_error: f64, strata: usize) -> Request<f64> {
    Request { relative_error, max_samples: 1_000_000, strata }
}

type Emission = fn(&Aim<f64>) -> f64;

/// Lights that shine the same everywhere, with the cosine, and unevenly.
const EMISSIONS: [(&str, Emission); 3] =
    [("uniform", |_| 1.0), ("cosine", |aim| aim.cosine), ("slanted", |aim| 1.0 + 0.5 * aim.on_disk[0])];

fn run(
    receiver: &Receiver<f64>,
    emission: Emission,
    request: &Request<f64>,
    panels: &mut [Panel<f64>],
) -> Estimate<f64> {
    integrate(&disk(), receiver, request, panels, |aim| Response::unoccluded(emission(aim))).unwrap()
}

/// Sum over parts of weight times kernel times emission.
fn plain_sum(receiver: &Receiver<f64>, emission: Emission, samples: impl Iterator<Item = ([f64; 2], f64)>) -> f64 {
    let p = receiver.position();
    let term = |([x, y], weight): ([f64; 2], f64)| {
        let away = [x - p[0], y - p[1], -p[2]];
        let square: f64 = away.iter().map(|x| x * x).sum();
        let towards: f64 = away.iter().zip(receiver.normal()).map(|(a, b)| a * b).sum();
        let aim = Aim { on_disk: [x, y], point: [x, y, 0.0], cosine: p[2] / square.sqrt() };
        weight * towards.max(0.0) * p[2] / (square * square) * emission(&aim)
    };
    samples.map(term).sum()
}

/// Share of receivers outside the request, and mean number of samples.
#[derive(Default)]
struct Tally {
    outside: u32,
    samples: usize,
    worst: f64,
    count: u32,
}

impl Tally {
    fn add(&mut self, error: f64, request: f64, samples: usize) {
        self.outside += u32::from(!(error <= request));
        self.samples += samples;
        self.worst = self.worst.max(error);
        self.count += 1;
    }

    fn share(&self) -> f64 {
        f64::from(self.outside) / f64::from(self.count)
    }

    fn mean(&self) -> f64 {
        f64::from(u32::try_from(self.samples).unwrap()) / f64::from(self.count)
    }
}

/// The reference for emissions without a closed form, by far more slices than the estimates under test take.
fn reference(receiver: &Receiver<f64>, index: usize, panels: &mut [Panel<f64>]) -> f64 {
    if index == 0 {
        disk_configuration_factor(&disk(), receiver)
    } else {
        run(receiver, EMISSIONS[index].1, &request(1e-7, 3), panels).value
    }
}

#[test]
fn requested_errors_are_met_at_random_receivers() {
    let mut rng = Rng::new(10_000);
    let mut panels = vec![Panel::default(); 1024];
    let receivers: Vec<_> = (0..RECEIVERS).map(|_| receiver(&mut rng)).collect();
    for (index, (name, emission)) in EMISSIONS.into_iter().enumerate() {
        // The full number for the light with a closed form; the others' reference takes long.
        let some = if index == 0 { &receivers[..] } else { &receivers[..RECEIVERS / 5] };
        let references: Vec<_> = some.iter().map(|r| reference(r, index, &mut panels)).collect();
        for relative in REQUESTS {
            let mut tally = Tally::default();
            for (receiver, exact) in some.iter().zip(&references) {
                let estimate = run(receiver, emission, &request(relative, 1), &mut panels);
                assert_eq!(estimate.status, Status::Met);
                tally.add((estimate.value / exact - 1.0).abs(), relative, estimate.samples);
            }
            println!(
                "{name:8} requested {relative:.0e}: outside {:.2} %, worst {:.1e}, samples {:.1}",
                100.0 * tally.share(),
                tally.worst,
                tally.mean()
            );
            assert!(tally.share() <= if index == 0 { 0.0 } else { 5e-3 }, "{name} {relative}");
            assert!(tally.mean() <= if index == 0 { 12.0 } else { 300.0 }, "{name} {relative}");
        }
        compare(some, &references, emission);
    }
}

/// The four methods, and the cubature, with equal numbers of samples everywhere.
fn compare(receivers: &[Receiver<f64>], references: &[f64], emission: Emission) {
    let parts = |method, depth| Partition::full(method, depth).unwrap();
    for (columns, depths) in [([6, 5], "64 / 96"), ([8, 7], "256 / 384"), ([10, 9], "1024 / 1536")] {
        for method in Method::ALL {
            let depth = if matches!(method, Method::Square | Method::MappedSquare) { columns[0] } else { columns[1] };
            let samples: Vec<_> =
                parts(method, depth).map(|part| (part.hits(), part.position(), part.weight())).collect();
            let hits = samples.iter().filter(|s| s.0).map(|s| (s.1, s.2));
            print_shares(&format!("{method:?} {depths}"), receivers, references, emission, hits);
        }
        let cubature = parts(Method::EqualAreaHexagon, columns[1]).map(|part: Subsource<f64>| part.cubature());
        let worst = print_shares(&format!("cubature {depths}"), receivers, references, emission, cubature);
        // All of them fail often: none of these numbers is enough close to the disk.
        assert!(worst > 0.05);
    }
}

fn print_shares(
    name: &str,
    receivers: &[Receiver<f64>],
    references: &[f64],
    emission: Emission,
    samples: impl Iterator<Item = ([f64; 2], f64)>,
) -> f64 {
    let samples: Vec<_> = samples.collect();
    let mut tallies = REQUESTS.map(|_| Tally::default());
    for (receiver, exact) in receivers.iter().zip(references) {
        let error = (plain_sum(receiver, emission, samples.iter().copied()) / exact - 1.0).abs();
        for (tally, relative) in tallies.iter_mut().zip(REQUESTS) {
            tally.add(error, relative, samples.len());
        }
    }
    let shares = tallies.each_ref().map(|tally| format!("{:5.1} %", 100.0 * tally.share())).join("  ");
    println!("  {name:30} outside 1 %, 0.1 %, 0.01 %: {shares}");
    tallies[0].share()
}

/// Independent: the cubature on the equal-area hexagon with 24 576 samples, for receivers whose horizon does not cut
/// the disk.
#[test]
fn references_agree_with_the_cubature() {
    let mut rng = Rng::new(6);
    let mut panels = vec![Panel::default(); 1024];
    let samples: Vec<_> =
        Partition::<f64>::full(Method::EqualAreaHexagon, 13).unwrap().map(|part| part.cubature()).collect();
    let mut count = 0;
    while count < 200 {
        let receiver = receiver(&mut rng);
        let (p, n) = (receiver.position(), receiver.normal());
        let clear = n[0].hypot(n[1]) + n[0] * p[0] + n[1] * p[1] + n[2] * p[2] < 0.0;
        let whole = -(n[0] * p[0] + n[1] * p[1] + n[2] * p[2]) > n[0].hypot(n[1]);
        if p[2] < 0.2 || !(clear || whole) {
            continue;
        }
        count += 1;
        for (index, (_, emission)) in EMISSIONS.into_iter().enumerate() {
            let expected = plain_sum(&receiver, emission, samples.iter().copied());
            let found = reference(&receiver, index, &mut panels);
            assert!((found / expected - 1.0).abs() <= 1e-6, "{index} {receiver:?}: {found} {expected}");
        }
    }
}

/// A half plane or a convex polygon of half planes a x + b y ≤ c of the disk that is not in shadow.
type Edges = Vec<[f64; 3]>;

fn visibility(edges: &Edges, [x, y]: [f64; 2]) -> f64 {
    if edges.iter().all(|[a, b, c]| a * x + b * y <= *c) { 1.0 } else { 0.0 }
}

/// The disk as a polygon of 8000 corners, cut (Sutherland and Hodgman).
fn lit_polygon(edges: &Edges) -> Vec<[f64; 3]> {
    let mut corners: Vec<[f64; 2]> =
        (0..8000).map(|i| (TAU * (f64::from(i) + 0.5) / 8000.0).sin_cos().into()).collect();
    for [a, b, c] in edges {
        let above = |p: [f64; 2]| a * p[0] + b * p[1] - c;
        let mut cut = Vec::new();
        for (index, p) in corners.iter().enumerate() {
            let q = corners[(index + 1) % corners.len()];
            let (d, e) = (above(*p), above(q));
            if d <= 0.0 {
                cut.push(*p);
            }
            if (d <= 0.0) != (e <= 0.0) {
                let t = d / (d - e);
                cut.push([p[0] + t * (q[0] - p[0]), p[1] + t * (q[1] - p[1])]);
            }
        }
        corners = cut;
    }
    corners.into_iter().map(|[x, y]| [x, y, 0.0]).collect()
}

/// A receiver, a shadow, the unoccluded and the true configuration factor.
type Case = (Receiver<f64>, Edges, f64, f64);

/// At least a tenth of the light arrives, so that what is lit is not too small to be seen.
fn shadow_case(rng: &mut Rng, edges: u32) -> Case {
    loop {
        let receiver = receiver(rng);
        let turn = TAU * rng.unit();
        let edges: Edges = (0..edges)
            .map(|i| turn + TAU * f64::from(i) / f64::from(edges))
            .map(|angle| [angle.cos(), angle.sin(), 0.9 * rng.unit() - 0.2])
            .collect();
        let exact = disk_configuration_factor(&disk(), &receiver);
        let lit = polygon_configuration_factor(receiver.position(), receiver.normal(), &lit_polygon(&edges));
        if lit > 0.1 * exact {
            return (receiver, edges, exact, lit);
        }
    }
}

fn shadowed<'a>(edges: &'a Edges) -> impl FnMut(&Aim<f64>) -> Response<f64> + 'a {
    |aim| Response { emission: 1.0, visibility: visibility(edges, aim.on_disk) }
}

#[test]
fn shadows_are_followed() {
    let mut panels = vec![Panel::default(); 1024];
    for (edges, allowed) in [(1, [0.02, 0.02]), (2, [0.02, 0.02]), (3, [0.03, 0.1])] {
        let mut rng = Rng::new(31);
        let cases: Vec<_> = (0..500).map(|_| shadow_case(&mut rng, edges)).collect();
        for ((relative, strata), allowed) in REQUESTS.into_iter().zip([2, 4]).zip(allowed) {
            let mut tally = Tally::default();
            for (receiver, edges, exact, lit) in &cases {
                let request = request(relative, strata);
                let estimate = ratio(&disk(), receiver, *exact, &request, &mut panels, shadowed(edges)).unwrap();
                tally.add((estimate.value / lit - 1.0).abs(), relative, estimate.samples);
            }
            println!(
                "{edges} edges, requested {relative:.0e}: outside {:.1} %, worst {:.1e}, samples {:.0}",
                100.0 * tally.share(),
                tally.worst,
                tally.mean()
            );
            assert!(tally.share() <= allowed, "{edges} {relative}: {}", tally.share());
        }
        for depth in [3, 5, 7, 9] {
            let mut tallies = [Tally::default(), Tally::default()];
            for (receiver, edges, exact, lit) in &cases {
                let parts = Partition::full(Method::EqualAreaHexagon, depth).unwrap();
                let (value, samples) = ratio_of_parts(parts, &disk(), receiver, *exact, shadowed(edges)).unwrap();
                for (tally, relative) in tallies.iter_mut().zip(REQUESTS) {
                    tally.add((value / lit - 1.0).abs(), relative, samples);
                }
            }
            println!(
                "  equal-area hexagon {:4}: outside 1 %, 0.1 %: {:.1} %, {:.1} %",
                Method::EqualAreaHexagon.parts(depth),
                100.0 * tallies[0].share(),
                100.0 * tallies[1].share()
            );
        }
    }
}

#[test]
fn unoccluded_receivers_are_exact() {
    let mut rng = Rng::new(9);
    let mut panels = [Panel::default(); 32];
    for _ in 0..2000 {
        let receiver = receiver(&mut rng);
        let exact = disk_configuration_factor(&disk(), &receiver);
        // What the light sends does not matter for the ratio, as long as it arrives.
        let respond = |aim: &Aim<f64>| Response::unoccluded(0.1 + aim.cosine + aim.on_disk[0].abs());
        let estimate = ratio(&disk(), &receiver, exact, &request(1e-3, 1), &mut panels, respond).unwrap();
        assert!((estimate.value / exact - 1.0).abs() <= 8.0 * f64::EPSILON, "{receiver:?} {estimate:?}");
        assert_eq!(estimate.status, Status::Met);
        for depth in [3, 6] {
            let parts = Partition::full(Method::EqualAreaHexagon, depth).unwrap();
            let (value, samples) = ratio_of_parts(parts, &disk(), &receiver, exact, respond).unwrap();
            assert!(samples == 0 || (value / exact - 1.0).abs() <= 8.0 * f64::EPSILON);
        }
    }
}

#[test]
fn limits_are_kept_and_reported() {
    let receiver = Receiver::new([0.3, 0.2, 0.5], [0.3, 0.1, -1.0]).unwrap();
    let edges = vec![[0.6, 0.8, 0.1], [-0.8, 0.6, 0.3]];
    let exact = disk_configuration_factor(&disk(), &receiver);
    let run = |request: &Request<f64>, panels: &mut [Panel<f64>]| {
        ratio(&disk(), &receiver, exact, request, panels, shadowed(&edges)).unwrap()
    };
    let best = run(&request(1e-6, 2), &mut vec![Panel::default(); 4096]);
    assert_eq!(best.status, Status::Met);
    let few = run(&request(1e-5, 1), &mut [Panel::default(); 2]);
    assert_eq!(few.status, Status::Panels);
    let short = run(&Request { max_samples: 100, ..request(1e-6, 1) }, &mut [Panel::default(); 64]);
    assert_eq!(short.status, Status::Samples);
    for estimate in [few, short] {
        assert!((estimate.value - best.value).abs() <= estimate.error && estimate.error <= exact, "{estimate:?}");
    }
    assert!(short.samples <= 200);
}

#[test]
fn darkness_and_the_far_side_are_zero() {
    let mut panels = [Panel::default(); 16];
    let bright = |_: &Aim<f64>| Response::unoccluded(1.0);
    for (position, normal) in [
        ([0.0, 0.0, -1.0], [0.0, 0.0, 1.0]),
        ([0.0, 0.0, 1.0], [0.0, 0.0, 1.0]),
        ([5.0, 0.0, 0.0], [-1.0, 0.0, 0.0]),
        ([5.0, 0.0, 1.0], [1.0, 0.0, 0.0]),
    ] {
        let receiver = Receiver::new(position, normal).unwrap();
        let estimate = integrate(&disk(), &receiver, &request(1e-3, 1), &mut panels, bright).unwrap();
        assert_eq!((estimate.value, estimate.samples, estimate.status), (0.0, 0, Status::Met));
    }
    let receiver = Receiver::new([0.0, 0.0, 1.0], [0.0, 0.0, -1.0]).unwrap();
    let dark = |_: &Aim<f64>| Response { emission: 1.0, visibility: 0.0 };
    assert_eq!(ratio(&disk(), &receiver, 0.5, &request(1e-3, 1), &mut panels, dark).unwrap().value, 0.0);
}

#[test]
fn bad_input_is_refused() {
    let receiver = Receiver::new([0.0, 0.0, 1.0], [0.0, 0.0, -1.0]).unwrap();
    let mut panels = [Panel::default(); 2];
    let mut run = |request: &Request<f64>, exact: f64, response: f64, panels_used: usize| {
        let respond = |_: &Aim<f64>| Response::unoccluded(response);
        ratio(&disk(), &receiver, exact, request, &mut panels[..panels_used], respond).map(|e| e.value)
    };
    for relative in [0.0, -1.0, 1.0, f64::NAN, f64::INFINITY] {
        assert_eq!(run(&request(relative, 1), 0.5, 1.0, 2), Err(EstimateError::RelativeError));
    }
    for exact in [-1.0, f64::NAN, f64::INFINITY] {
        assert_eq!(run(&request(0.1, 1), exact, 1.0, 2), Err(EstimateError::Exact));
    }
    for response in [-1.0, f64::NAN, f64::INFINITY] {
        assert_eq!(run(&request(0.1, 1), 0.5, response, 2), Err(EstimateError::Response));
    }
    assert_eq!(run(&request(0.1, 3), 0.5, 1.0, 2), Err(EstimateError::NoPanels));
    assert_eq!(run(&request(0.1, 1), 0.5, 1.0, 0), Err(EstimateError::NoPanels));
    assert_eq!(run(&request(0.1, 2), 0.5, 1.0, 2), Ok(0.5));
    for error in [EstimateError::RelativeError, EstimateError::NoPanels, EstimateError::Exact, EstimateError::Response]
    {
        assert!(!error.to_string().is_empty() && !error.to_string().contains('\n'));
    }
}

/// The error of an estimate in `R` against the same in `f64` with a hundredth of the requested error.
fn check_extreme<R: Real>(disk_radius: f64, position: [f64; 3], normal: [f64; 3], relative: f64) {
    let real = |v: [f64; 3]| v.map(R::from_f64);
    let (Ok(disk), Ok(receiver)) = (
        Disk::<R>::new([R::ZERO; 3], real([0.0, 0.0, 1.0]), R::from_f64(disk_radius)),
        Receiver::<R>::new(real(position), real(normal)),
    ) else {
        return;
    };
    let request = Request { relative_error: R::from_f64(relative), max_samples: 20_000, strata: 1 };
    let mut panels = [Panel::default(); 64];
    let mut points = 0_u32;
    let estimate = integrate(&disk, &receiver, &request, &mut panels, |aim| {
        let [x, y] = aim.on_disk;
        points += u32::from(x.hypot(y) <= R::ONE + R::from_f64(1e-5));
        assert!(aim.cosine >= R::ZERO && aim.cosine <= R::ONE + R::from_f64(1e-5), "{disk_radius} {position:?}");
        Response::unoccluded(R::ONE + aim.cosine)
    })
    .unwrap();
    assert_eq!(usize::try_from(points).unwrap(), estimate.samples, "{disk_radius} {position:?}");
    let factor = disk_configuration_factor(&disk, &receiver).to_f64();
    let value = estimate.value.to_f64();
    // Emission is between 1 and 2.
    assert!(
        value >= factor * (1.0 - 1e-5) && value <= 2.0 * factor * (1.0 + 1e-5),
        "{disk_radius} {position:?}: {estimate:?}"
    );
}

#[test]
fn extremes_stay_finite_and_in_bounds() {
    let mut rng = Rng::new(12);
    let edge = [0.0, 5e-324, 1e-310, 1e-45, 1e-38, 1e-20, 1e-6, 1e-3, 1.0, 1e3, 1e6, 1e19, 1e38, 1e150, 1e300];
    for radius in [1e-300, 1e-38, 1e-20, 1e-6, 1.0, 1e6, 1e20, 1e38, 1e300] {
        for foot in edge {
            for height in edge {
                for _ in 0..4 {
                    let (sin, cos) = (TAU * rng.unit()).sin_cos();
                    let position = [foot * cos, foot * sin, height];
                    let normal = rng.direction();
                    check_extreme::<f64>(radius, position, normal, 1e-3);
                    check_extreme::<f32>(radius, position, normal, 1e-2);
                }
                for normal in [[0.0, 0.0, -1.0], [1.0, 0.0, 0.0], [0.0, 1e-30, -1.0], [-1.0, 0.0, 1e-12]] {
                    check_extreme::<f64>(radius, [foot, 0.0, height], normal, 1e-3);
                    check_extreme::<f32>(radius, [foot, 0.0, height], normal, 1e-2);
                }
            }
        }
    }
}

/// Ratios of height to radius from 1e-6 to 1e6: single precision against double.
#[test]
fn single_precision_agrees_with_double() {
    let mut rng = Rng::new(21);
    let (mut worst, mut outside) = (0.0_f64, 0_u32);
    for _ in 0..3000 {
        let height = 10.0_f64.powf(12.0 * rng.unit() - 6.0);
        let foot = height.max(1.0) * 2.0 * rng.unit();
        let (position, normal) = ([foot, 0.0, height].map(narrow), rng.direction().map(narrow));
        let wide = Receiver::new(position.map(f64::from), normal.map(f64::from)).unwrap();
        let exact = disk_configuration_factor(&disk(), &wide);
        if !(exact > 1e-20) {
            continue;
        }
        let narrow_disk = Disk::<f32>::new([0.0; 3], [0.0, 0.0, 1.0], 1.0).unwrap();
        let receiver = Receiver::new(position, normal).unwrap();
        let request = Request { relative_error: 1e-2_f32, max_samples: 20_000, strata: 1 };
        let mut panels = [Panel::default(); 64];
        let cosine = |aim: &Aim<f32>| Response::unoccluded(1.0 + aim.cosine);
        let found = integrate(&narrow_disk, &receiver, &request, &mut panels, cosine).unwrap();
        let mut panels = vec![Panel::default(); 256];
        let emission: Emission = |aim| 1.0 + aim.cosine;
        let expected = run(&wide, emission, &self::request(1e-5, 2), &mut panels).value;
        let error = (f64::from(found.value) / expected - 1.0).abs();
        worst = worst.max(error);
        outside += u32::from(!(error <= 1e-2));
    }
    println!("single precision: worst {worst:.1e}, outside {outside} of 3000");
    assert!(outside <= 15 && worst <= 0.1);
}

#[allow(clippy::cast_possible_truncation, reason = "rounding is what is meant")]
fn narrow(x: f64) -> f32 {
    x as f32
}
