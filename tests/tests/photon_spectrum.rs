//! Spectra of a prism's beam on a wall, by photons: each wavelength is where Snell's law puts it, no bands show, and photons interpolated
//! between wavelengths are those that are traced.
#![allow(clippy::panic, clippy::unwrap_used, reason = "helpers of tests fail by panicking")]
#![allow(clippy::print_stdout, reason = "figures for who runs a test with --nocapture")]

use core::f64::consts::PI;

use renderers::geometry::glam::DVec3;
use renderers::photon::{Bundle, Rethrow};
use renderers::render::{Between, Options, PhotonCount, PhotonOptions, Renderer, Spectra, render};
use renderers::scene::{Scene, builtin};
use renderers::spectral::Y_INTEGRAL;
use spectral_core::Observer;
use spectral_core::colour::rgb::WHITE;
use spectral_core::colour::{delta_e_00, xyz_to_lab};
use spectral_core::dispersion::{Dispersion, Glass};
use spectral_tests::bodies;
use spectral_tests::light_tracing::Estimate;
use spectral_tests::receiver::{REFLECTANCE, Receiver};
use spectral_tests::snell::Prism;

/// Where the wall is behind its edge.
const WALL: f64 = 8.0;
/// Where along the left face light comes in.
const SLIT: [f64; 2] = [0.8, 0.86];
const GLASS: &str = "N-SF11";
/// The radius of estimates.
const RADIUS: f64 = 0.02;
/// Pictures are strips along the spectrum.
const SIZE: [u32; 2] = [96, 12];

/// A narrow beam of parallel light through a prism onto a wall, which shows the spectrum along columns.
struct Bench {
    apex: f64,
    /// The length of the prism's faces.
    length: f64,
    incidence: f64,
    glass: Glass<f64>,
    receiver: Receiver,
}

impl Bench {
    /// With a length of 2, light that is reflected twice within the prism, and is not dispersed then, falls on the wall at 0.09 from the middle
    /// (1 % of all); with 3 it falls elsewhere, and fluxes have more noise.
    fn new(length: f64) -> Self {
        let receiver = Receiver {
            centre: DVec3::new(WALL, -4.7, 0.0),
            normal: DVec3::NEG_X,
            down: DVec3::Z,
            half: 0.72,
            eye: 1.0,
        };
        let [apex, incidence] = [50.0_f64, 48.0].map(f64::to_radians);
        Self { apex, length, incidence, glass: Glass::find(GLASS).unwrap(), receiver }
    }

    fn prism(&self, wavelength: f64) -> Prism {
        Prism { apex: self.apex, index: self.glass.index(wavelength) }
    }

    /// Where a ray meets the wall, from the receiver's middle.
    fn place(&self, wavelength: f64, entry: f64) -> f64 {
        self.prism(wavelength).height(entry, self.incidence, WALL).unwrap() - self.receiver.centre.y
    }

    /// Blockers close to the left face leave the slit open, and keep the wall dark otherwise.
    fn scene(&self, light: &str) -> Scene {
        let direction = self.incidence - self.apex / 2.0;
        let way = DVec3::new(direction.cos(), direction.sin(), 0.0);
        // Along the plane of the slit, across the beam.
        let across = DVec3::new(-way.y, way.x, 0.0);
        let foot = |entry: f64| {
            let [x, y] = self.prism(500.0).face(-1.0, entry);
            DVec3::new(x, y, 0.0)
        };
        let origin = foot(SLIT[0]) - way * 3.0;
        let text = |v: DVec3| format!("{}, {}, {}", v.x, v.y, v.z);
        let blocker = |side: f64, entry: f64| {
            // Its edge is where the ray to this end of the slit passes.
            let ahead = foot(entry);
            let edge = ahead - way * (ahead - origin).dot(way);
            let centre = edge + across * (side * 6.0);
            format!(
                "<shape type='rectangle'><transform name='to_world'><scale x='2' y='6'/><lookat origin='{}' target='{}' up='{}'/></transform>
                <bsdf type='diffuse'><spectrum name='reflectance' value='0'/></bsdf></shape>",
                text(centre),
                text(centre - way),
                text(across)
            )
        };
        let body = format!(
            "<emitter type='directional'><vector name='direction' x='{}' y='{}' z='0'/><spectrum name='irradiance' value='{light}'/></emitter>
            <shape type='obj'><string name='filename' value='prism.obj'/><boolean name='face_normals' value='true'/>
            <bsdf type='dielectric'><string name='int_ior' value='{GLASS}'/><float name='ext_ior' value='1'/></bsdf></shape>{}{}",
            way.x,
            way.y,
            blocker(1.0, SLIT[0]),
            blocker(-1.0, SLIT[1])
        );
        let mesh = bodies::prism(Prism { apex: self.apex, index: 1.0 }, self.length);
        self.receiver.scene(&body, &[("prism.obj", &mesh)]).unwrap()
    }

    /// Closed form: the irradiance in XYZ of flat light between two wavelengths, mean over each of some columns. Each wavelength lights a strip
    /// evenly, which has what both boundaries pass; light reflected within the prism goes elsewhere.
    fn truth(&self, columns: u32, [from, to]: [f64; 2]) -> Vec<[f64; 3]> {
        const FINE: f64 = 8.0;
        let observer = Observer::<f64>::cie_1931_2deg();
        let half = self.receiver.half;
        let width = 2.0 * half / f64::from(columns);
        let mut sums = vec![[0.0; 3]; columns as usize];
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "some thousands of steps")]
        let steps = ((to - from) * FINE).round() as u32;
        for wavelength in (0..steps).map(|k| from + (f64::from(k) + 0.5) / FINE) {
            let [a, b] = SLIT.map(|entry| self.place(wavelength, entry) + half);
            let [low, high] = [a.min(b), a.max(b)];
            let share = self.prism(wavelength).ray(1.0, self.incidence).unwrap().share;
            let irradiance = share * (SLIT[1] - SLIT[0]) * self.incidence.cos() / (high - low);
            let value = observer.value(wavelength).map(|v| v * irradiance / (Y_INTEGRAL * FINE));
            for (column, sum) in (0..columns).zip(&mut sums) {
                let start = f64::from(column) * width;
                let part = ((start + width).min(high) - start.max(low)).max(0.0) / width;
                *sum = core::array::from_fn(|c| sum[c] + part * value[c]);
            }
        }
        sums
    }
}

fn options(photons: PhotonOptions) -> Options {
    let photons =
        PhotonOptions { radius: Some(RADIUS), nearest: 1000, adaptive: false, between: Between::Ambient, ..photons };
    Options { size: Some(SIZE), samples: Some(4), photons, ..Options::default() }
}

/// The flux of a profile's part, and its centroid.
fn moments(profile: &[[f64; 3]], place: impl Fn(f64) -> f64, [from, to]: [f64; 2]) -> [f64; 2] {
    let columns = profile.iter().zip(0_u32..).map(|(xyz, column)| (xyz.iter().sum::<f64>(), f64::from(column)));
    let (mut sum, mut moment) = (0.0, 0.0);
    for (value, column) in columns {
        let [start, end] = [place(column), place(column + 1.0)];
        let value = value * (end.min(to) - start.max(from)).max(0.0);
        sum += value;
        moment += value * f64::midpoint(start.max(from), end.min(to));
    }
    [sum, moment / sum]
}

/// Closed form, at ten wavelengths: where a prism's light falls on a wall, and how much of it; red is turned least.
#[test]
fn a_prisms_light_is_where_its_closed_form_says() {
    /// Columns of the closed form.
    const FINE: u32 = 3600;
    let bench = Bench::new(2.0);
    let half = bench.receiver.half;
    let mut before = f64::NEG_INFINITY;
    for from in [410.0, 430.0, 450.0, 500.0, 530.0, 560.0, 590.0, 620.0, 650.0, 680.0] {
        let to = from + 10.0;
        let scene = bench.scene(&format!("{}:0, {from}:1, {to}:1, {}:0", from - 1e-6, to + 1e-6));
        let window = [bench.place(from, SLIT[1]) - RADIUS, bench.place(to, SLIT[0]) + RADIUS];
        let truth = bench.truth(FINE, [from, to]);
        let expected = moments(&truth, |column| (2.0 * column / f64::from(FINE) - 1.0) * half, window);
        let found = |seed| {
            let photons = PhotonOptions { count: PhotonCount::Count(10_000), ..PhotonOptions::default() };
            let settings = Options { spectra: Spectra::Uniform(40), seed: Some(seed), ..options(photons) };
            let (map, _) = bench.receiver.caustics(&scene, &settings).unwrap();
            moments(&map.profile(&(-half..half)), |column| map.place(column), window)
        };
        let found: Vec<[f64; 2]> = (0..4).map(found).collect();
        let [flux, place] = [0, 1].map(|k| Estimate::of(&found.iter().map(|f| f[k]).collect::<Vec<_>>()));
        let [excess, error] = [flux.mean / expected[0] - 1.0, flux.error / expected[0]];
        println!(
            "{from}–{to} nm: flux {:+.3} ± {:.3} %, place {:.4} ± {:.4}, expected {:.4}",
            100.0 * excess,
            100.0 * error,
            place.mean,
            place.error,
            expected[1]
        );
        assert!(excess.abs() <= 0.005 + 3.0 * error && error <= 0.005, "{from}: {excess} ± {error}");
        assert!((place.mean - expected[1]).abs() <= RADIUS / 10.0, "{from}: {place:?}, not {}", expected[1]);
        assert!(place.mean > before, "{from}: {place:?} after {before}");
        before = place.mean;
    }
}

/// What Epanechnikov's kernel makes of a profile: along one axis it is 8/(3π R) (1 − x²/R²)^1.5.
fn blurred(profile: &[[f64; 3]], column: f64) -> Vec<[f64; 3]> {
    let reach = (RADIUS / column).ceil();
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "some columns")]
    let reach = reach as usize;
    let weight = |offset: usize| {
        #[allow(clippy::cast_precision_loss, reason = "some columns")]
        let x = (offset as f64 - reach as f64) * column / RADIUS;
        (1.0 - x * x).max(0.0).powf(1.5)
    };
    let total: f64 = (0..=2 * reach).map(weight).sum();
    let at = |middle: usize| {
        let mut sum = [0.0; 3];
        for offset in 0..=2 * reach {
            let Some(xyz) = (middle + offset).checked_sub(reach).and_then(|k| profile.get(k)) else { continue };
            sum = core::array::from_fn(|c| sum[c] + weight(offset) / total * xyz[c]);
        }
        sum
    };
    (0..profile.len()).map(at).collect()
}

/// The mean of every so many columns.
fn binned(profile: &[[f64; 3]], width: usize) -> Vec<[f64; 3]> {
    #[allow(clippy::cast_precision_loss, reason = "some columns")]
    let mean =
        |part: &[[f64; 3]]| core::array::from_fn(|c| part.iter().map(|xyz| xyz[c]).sum::<f64>() / part.len() as f64);
    profile.chunks(width).map(mean).collect()
}

/// Second differences of chromaticity along columns that have some light: what bands have much of, and smooth spectra little.
fn second_differences(profile: &[[f64; 3]]) -> f64 {
    let squares = profile.windows(3).map(|p| (0..3).map(|c| (p[0][c] - 2.0 * p[1][c] + p[2][c]).powi(2)).sum::<f64>());
    squares.sum::<f64>().sqrt()
}

fn size(profile: &[[f64; 3]]) -> f64 {
    profile.iter().flatten().map(|v| v * v).sum::<f64>().sqrt()
}

fn minus(a: &[[f64; 3]], b: &[[f64; 3]]) -> Vec<[f64; 3]> {
    a.iter().zip(b).map(|(a, b)| core::array::from_fn(|c| a[c] - b[c])).collect()
}

/// How bright the light is where its spectrum is flat: with that, the spectrum on the wall is about as bright as white paper in a picture.
const BRIGHT: f64 = 25.0;

/// ΔE00 along a profile, of pictures of a surface of the receiver's reflectance.
fn differences(a: &[[f64; 3]], b: &[[f64; 3]]) -> Vec<f64> {
    let lab = |xyz: &[f64; 3]| xyz_to_lab(xyz.map(|v| v * BRIGHT * REFLECTANCE / PI), WHITE);
    a.iter().zip(b).map(|(a, b)| delta_e_00(lab(a), lab(b))).collect()
}

/// What a way to make a spectrum is like.
struct Quality {
    /// Second differences of what is not in the closed form, relative to those of the closed form.
    bands: f64,
    /// The mean ΔE00 to it.
    difference: f64,
}

fn quality(bench: &Bench, truth: &[[f64; 3]], spectra: Spectra, (count, bundle): (u64, Bundle)) -> Quality {
    let half = bench.receiver.half;
    let photons = PhotonOptions { count: PhotonCount::Count(count), bundle, ..PhotonOptions::default() };
    let scene = bench.scene(&BRIGHT.to_string());
    let (map, report) = bench.receiver.caustics(&scene, &Options { spectra, ..options(photons) }).unwrap();
    let found: Vec<_> = map.profile(&(-half..half)).iter().map(|xyz| xyz.map(|v| v / BRIGHT)).collect();
    let differences = differences(&found, truth);
    #[allow(clippy::cast_precision_loss, reason = "some columns")]
    let difference = differences.iter().sum::<f64>() / differences.len() as f64;
    let bands = second_differences(&minus(&found, truth)) / second_differences(truth);
    let most = differences.into_iter().fold(0.0, f64::max);
    println!(
        "{spectra} {bundle:?}: bands {bands:.3}, ΔE00 {difference:.2}, at most {most:.2}; {} maps",
        report.bands.len()
    );
    Quality { bands, difference }
}

/// For each of some representations: how strong bands may be with wavelengths of their own for photons, and how far colours may be off.
fn assert_smooth(count: u64, cases: &[(Spectra, f64, f64)]) {
    /// Parts of a column in the closed form.
    const FINE: u8 = 20;
    let bench = Bench::new(3.0);
    let columns = SIZE[0] * u32::from(FINE);
    let truth = bench.truth(columns, [380.0, 780.0]);
    let truth = binned(&blurred(&truth, 2.0 * bench.receiver.half / f64::from(columns)), usize::from(FINE));
    for &(spectra, bands, difference) in cases {
        let [continuous, single] =
            [Bundle::Continuous, Bundle::Single].map(|bundle| quality(&bench, &truth, spectra, (count, bundle)));
        assert!(continuous.bands <= bands && continuous.difference <= difference, "{spectra}");
        // The control: the measure finds bands where there are some.
        assert!(
            single.bands >= 5.0 * continuous.bands && single.difference >= 3.0 * continuous.difference,
            "{spectra}"
        );
    }
}

/// Closed form: photons that have wavelengths of their own make a smooth spectrum at the threshold 1, however intervals lie; those at one
/// wavelength for each interval make bands. Bins that are narrower than the bands of maps have none either.
#[test]
fn no_bands_show_in_a_prisms_spectrum() {
    assert_smooth(50_000, &[(Spectra::default(), 0.75, 0.75), (Spectra::Uniform(80), 0.4, 0.5)]);
}

/// The same with more photons and other bins: `cargo test --release -p spectral-tests --test photon_spectrum -- --ignored`, 2 min.
#[test]
#[ignore = "two minutes"]
fn no_bands_show_with_many_photons() {
    let uniform = [(16, 0.7, 2.0), (41, 0.25, 0.4), (63, 0.25, 0.3), (80, 0.25, 0.3)];
    let uniform = uniform.map(|(bins, bands, difference)| (Spectra::Uniform(bins), bands, difference));
    assert_smooth(200_000, &[&[(Spectra::default(), 0.4, 0.5)][..], &uniform].concat());
}

/// What photons interpolated between wavelengths make of a scene is what traced ones make: the difference, with the same paths, is far less than
/// the noise, and there is none in the mean. Estimates have one radius: by themselves they choose one for all wavelengths, by which they spread light.
#[test]
fn interpolated_photons_are_those_that_are_traced() {
    const SEEDS: u32 = 4;
    for (name, glass) in [("cornell-box-glass", "N-BK7"), ("prism", "SF10")] {
        let scene = builtin::load(name, &[("glass".to_owned(), glass.to_owned())]).unwrap();
        let picture = |rethrow, seed| {
            let photons = PhotonOptions {
                count: PhotonCount::Count(20_000),
                rethrow,
                nearest: 1 << 20,
                adaptive: false,
                between: Between::Ambient,
                ..PhotonOptions::default()
            };
            let spectra = Spectra::Uniform(20);
            let settings = Options {
                spectra,
                seed: Some(seed),
                size: Some([48; 2]),
                samples: Some(4),
                photons,
                ..Options::default()
            };
            let of = |renderer| render(&scene, &Options { renderer, ..settings }, &|_| {}).unwrap();
            let [whole, direct] = [Renderer::PhotonMap, Renderer::Whitted].map(of);
            let keys = whole.photons.unwrap().keys.len();
            // Through the sphere one wavelength says where light of all lands.
            assert!((keys > 1) == (rethrow == Rethrow::Interpolated && name == "prism"), "{name}: {keys}");
            let pairs = whole.picture.pixels().iter().zip(direct.picture.pixels());
            pairs.map(|(a, b)| core::array::from_fn(|c| f64::from(a[c]) - f64::from(b[c]))).collect::<Vec<[f64; 3]>>()
        };
        let mut ratios = vec![];
        let (mut traced_sum, mut difference_sum, mut squares) = (vec![[0.0; 3]; 48 * 48], vec![[0.0; 3]; 48 * 48], 0.0);
        for seed in (0..SEEDS).map(u64::from) {
            let [interpolated, traced] = [Rethrow::Interpolated, Rethrow::Traced].map(|rethrow| picture(rethrow, seed));
            let flux = |picture: &[[f64; 3]]| picture.iter().flatten().sum::<f64>();
            ratios.push(flux(&interpolated) / flux(&traced));
            squares += size(&traced).powi(2);
            let difference = minus(&interpolated, &traced);
            for (sum, part) in [(&mut traced_sum, &traced), (&mut difference_sum, &difference)] {
                sum.iter_mut().zip(part).for_each(|(s, p)| *s = core::array::from_fn(|c| s[c] + p[c]));
            }
        }
        let count = f64::from(SEEDS);
        // The variance of all pixels' light together, from the scatter between seeds.
        let noise = ((squares - size(&traced_sum).powi(2) / count) / (count - 1.0) / count).sqrt();
        let difference = size(&difference_sum) / count;
        let ratio = Estimate::of(&ratios);
        println!("{name}: difference {:.3} of the noise of the mean, flux {ratio:?}", difference / noise);
        assert!(difference <= 0.3 * noise, "{name}: {difference} {noise}");
        assert!((ratio.mean - 1.0).abs() <= 1e-3 + 4.0 * ratio.error && ratio.error <= 2e-3, "{name}: {ratio:?}");
    }
}
