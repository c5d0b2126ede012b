//! How errors of the photon map fall with the number of photons, and which of its estimates are right on average.
#![allow(clippy::panic, clippy::unwrap_used, reason = "helpers of tests fail by panicking")]
#![allow(clippy::print_stdout, reason = "figures for who runs a test with --nocapture")]

use core::f64::consts::PI;

use renderers::render::{Between, Options, PhotonCount, PhotonOptions, Spectra};
use renderers::scene::Scene;
use spectral_tests::light_tracing::Estimate;
use spectral_tests::receiver::Receiver;
use spectral_tests::snell::{Focus, Lens, Plate, Way};

/// Pixels along a side.
const SIDE: u32 = 32;

fn down(body: &str) -> String {
    format!(
        "<emitter type='directional'><vector name='direction' x='0' y='-1' z='0'/><spectrum name='irradiance' value='1'/></emitter>{body}"
    )
}

const GLASS: &str =
    "<bsdf type='dielectric'><float name='int_ior' value='1.5'/><float name='ext_ior' value='1'/></bsdf>";

fn photons(count: u32, radius: f64) -> PhotonOptions {
    PhotonOptions {
        count: PhotonCount::Count(u64::from(count)),
        radius: Some(radius),
        nearest: 1 << 24,
        adaptive: false,
        between: Between::Ambient,
        ..PhotonOptions::default()
    }
}

fn options(photons: PhotonOptions, seed: u64) -> Options {
    Options {
        spectra: Spectra::Uniform(1),
        size: Some([SIDE; 2]),
        samples: Some(16),
        seed: Some(seed),
        photons,
        ..Options::default()
    }
}

/// A receiver behind a ball, in parallel light, and its irradiance in closed form.
struct Ball {
    receiver: Receiver,
    scene: Scene,
    /// The mean over each pixel, and whether it counts: around the axis, where irradiance is infinite, and near the edge it doesn't.
    truth: Vec<Option<f64>>,
}

impl Ball {
    fn new() -> Self {
        const FINE: u32 = 8;
        const STEPS: u32 = 400;
        let receiver = Receiver::floor(-2.0, 1.0, 0.8);
        let scene = receiver.scene(&down(&format!("<shape type='sphere'>{GLASS}</shape>")), &[]).unwrap();
        let focus = Focus { lens: Lens::Ball, radius: 1.0, index: 1.5, distance: 2.0 };
        let ways: Vec<Way> = (0..6).map(Way::Through).chain([Way::Reflected]).collect();
        // The flux within circles.
        let step = 1.5 / f64::from(STEPS);
        let within = |k: u32| ways.iter().map(|way| focus.flux(*way, f64::from(k.max(1)) * step)).sum::<f64>();
        let flux: Vec<f64> = (0..=STEPS).map(within).collect();
        #[allow(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            clippy::cast_precision_loss,
            reason = "steps"
        )]
        let irradiance = |r: f64| {
            let k = ((r / step) as usize).min(STEPS as usize - 1);
            (flux[k + 1] - flux[k]) / (PI * step * step * (2 * k + 1) as f64)
        };
        let pixel = 2.0 / f64::from(SIDE);
        let truth = (0..SIDE * SIDE).map(|n| {
            let at =
                |number: u32, part: u32| (f64::from(number) + (f64::from(part) + 0.5) / f64::from(FINE)) * pixel - 1.0;
            let middle = [n % SIDE, n / SIDE].map(|k| (f64::from(k) + 0.5) * pixel - 1.0);
            let is_fit = (0.4..0.8).contains(&middle[0].hypot(middle[1]));
            let parts = (0..FINE * FINE).map(|p| irradiance(at(n % SIDE, p % FINE).hypot(at(n / SIDE, p / FINE))));
            is_fit.then(|| parts.sum::<f64>() / f64::from(FINE * FINE))
        });
        Self { receiver, scene, truth: truth.collect() }
    }

    fn irradiance(&self, photons: PhotonOptions, seed: u64) -> Vec<f64> {
        let (map, _) = self.receiver.caustics(&self.scene, &options(photons, seed)).unwrap();
        map.pixels().iter().map(|xyz| xyz[1]).collect()
    }

    /// Root mean square over pixels of relative differences.
    fn error(&self, a: &[f64], b: impl Fn(usize) -> Option<f64>) -> f64 {
        let (mut squares, mut count) = (0.0, 0.0_f64);
        for (k, truth) in self.truth.iter().enumerate() {
            let (Some(truth), Some(b)) = (truth, b(k)) else { continue };
            squares += ((a[k] - b) / truth).powi(2);
            count += 1.0;
        }
        (squares / count).sqrt()
    }

    /// The error against the closed form, over some seeds.
    fn against_truth(&self, photons: PhotonOptions, seeds: u32) -> f64 {
        let square = |seed| self.error(&self.irradiance(photons, u64::from(seed)), |k| self.truth[k]).powi(2);
        ((0..seeds).map(square).sum::<f64>() / f64::from(seeds)).sqrt()
    }

    /// The standard deviation, from pairs of seeds.
    fn scatter(&self, photons: PhotonOptions, pairs: u32) -> f64 {
        let square = |pair: u32| {
            let [a, b] = [0, 1].map(|k| self.irradiance(photons, u64::from(2 * pair + k)));
            self.error(&a, |k| Some(b[k])).powi(2) / 2.0
        };
        ((0..pairs).map(square).sum::<f64>() / f64::from(pairs)).sqrt()
    }
}

/// The slope of a line through the logarithms.
fn slope(points: &[(f64, f64)]) -> f64 {
    let logs: Vec<[f64; 2]> = points.iter().map(|(x, y)| [x.ln(), y.ln()]).collect();
    #[allow(clippy::cast_precision_loss, reason = "a few points")]
    let mean = [0, 1].map(|k: usize| logs.iter().map(|p| p[k]).sum::<f64>() / logs.len() as f64);
    let moment = |a: usize, b: usize| logs.iter().map(|p| (p[a] - mean[a]) * (p[b] - mean[b])).sum::<f64>();
    moment(0, 1) / moment(0, 0)
}

fn measured(name: &str, counts: &[u32], error: impl Fn(u32) -> f64) -> f64 {
    let points: Vec<(f64, f64)> = counts.iter().map(|count| (f64::from(*count), error(*count))).collect();
    let slope = slope(&points);
    println!("{name}: {points:.5?}, slope {slope:.3}");
    slope
}

/// The photons of an estimate for which variance and the square of the bias go down alike.
#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a positive number")]
fn nearest(count: u32) -> usize {
    (0.5 * f64::from(count).powf(2.0 / 3.0)) as usize
}

/// With a radius that stays, the scatter falls faster than with independent photons, n^−½, and not faster than n^−1, which low-discrepancy points
/// have at best but for logarithms.
#[test]
fn scatter_falls_with_the_number_of_photons() {
    let ball = Ball::new();
    let found = measured("fixed radius", &[1000, 4000, 16_000, 64_000], |count| ball.scatter(photons(count, 0.1), 3));
    assert!((-1.0..=-0.5).contains(&found), "{found}");
}

/// With the n^⅔ nearest of n independent photons, the scatter goes with n^−⅓. Radii of photons go with the inverse root of the density, for which the
/// bias is that of the radius' fourth power (Abramson, "On Bandwidth Variation in Kernel Estimates — A Square Root Law", 1982), n^−⅔, where it is
/// that of the square with radii of places, n^−⅓. Low-discrepancy points scatter less: errors go down between these. The adaptive estimate may
/// choose as many photons, or fewer.
#[test]
fn errors_of_the_nearest_photons_fall_with_their_number() {
    let ball = Ball::new();
    for adaptive in [false, true] {
        let found = measured(&format!("nearest, adaptive: {adaptive}"), &[2000, 8000, 32_000, 128_000], |count| {
            ball.against_truth(PhotonOptions { nearest: nearest(count), adaptive, ..photons(count, 1.0) }, 3)
        });
        let measured = if adaptive { -0.38 } else { -0.51 };
        assert!((found - measured).abs() <= 0.06, "{adaptive}: {found}");
    }
}

/// Over passes, the squares of radii go down as (n + ⅔)/(n + 1) (Knaus and Zwicker 2011): their mean, with which the bias goes, as n^−⅓ in the end,
/// and so does the scatter.
#[test]
fn errors_fall_over_passes() {
    const PASSES: [u32; 4] = [1, 4, 16, 64];
    let squares = |passes: u32| {
        let next = |square: &mut f64, n: u32| {
            let now = *square;
            *square *= (f64::from(n) + 2.0 / 3.0) / (f64::from(n) + 1.0);
            Some(now)
        };
        (1..=passes).scan(1.0, next).sum::<f64>() / f64::from(passes)
    };
    let expected = slope(&PASSES.map(|passes| (f64::from(passes), squares(passes))));
    let late = slope(&[1 << 16, 1 << 20].map(|passes| (f64::from(passes), squares(passes))));
    assert!((late + 1.0 / 3.0).abs() <= 0.005, "{late}");
    let ball = Ball::new();
    // Few photons and a large radius: bias is most of the error.
    let found =
        measured("passes", &PASSES, |passes| ball.against_truth(PhotonOptions { passes, ..photons(2000, 0.3) }, 2));
    println!("passes: slope of the mean square of radii {expected:.3}");
    assert!((found - expected).abs() <= 0.04, "{found}, not {expected}");
}

/// Closed form: light through a plate. The mean over seeds is right, whether all of the plate is lit or a slit of it, however radii are chosen: they
/// belong to photons, and all light of a photon is there once.
#[test]
fn estimates_are_right_on_average() {
    const SEEDS: u64 = 24;
    let cube = format!(
        "<shape type='cube'><transform name='to_world'><scale x='4' y='0.25' z='4'/></transform>{GLASS}</shape>"
    );
    let shade = |x: f64| {
        format!(
            "<shape type='rectangle'><transform name='to_world'><rotate x='1' angle='-90'/><scale value='5'/>
            <translate x='{x}' y='2'/></transform></shape>"
        )
    };
    let slit = format!("{}{}", shade(-5.1), shade(5.05));
    let receiver = Receiver::floor(-1.2, 1.0, 0.2);
    let passes = Plate { thickness: 0.5, index: 1.5, absorption: 0.0 }.shares(0.0)[0];
    for (name, body, width) in [("plate", cube.clone(), 2.0), ("slit", cube + &slit, 0.15)] {
        let scene = receiver.scene(&down(&body), &[]).unwrap();
        for (count, adaptive, nearest) in [
            (1000, false, 1 << 24),
            (5000, false, 1 << 24),
            (20_000, false, 1 << 24),
            (20_000, true, 50),
            (20_000, true, 400),
            (20_000, false, 50),
        ] {
            let flux = |seed| {
                let photons = PhotonOptions { adaptive, nearest, ..photons(count, 0.3) };
                let (map, _) =
                    receiver.caustics(&scene, &Options { samples: Some(1), ..options(photons, seed) }).unwrap();
                map.flux()[1] / (2.0 * width * passes)
            };
            let found = Estimate::of(&(0..SEEDS).map(flux).collect::<Vec<_>>());
            let excess = found.mean - 1.0;
            println!(
                "{name}: {count} photons, {nearest} nearest, adaptive: {adaptive}: {:+.3} ± {:.3} %",
                100.0 * excess,
                100.0 * found.error
            );
            // Student's t of 23 degrees of freedom is beyond 3.8 once in a thousand times.
            assert!(excess.abs() <= 3.8 * found.error && found.error <= 0.012, "{name} {count}: {found:?}");
        }
    }
}
