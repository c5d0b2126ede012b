//! What the photon map costs: intervals chosen by pixels against tracing for fixed wavelengths, and nothing where there is no caustic.
//!
//! A table of figure 5's kind, by scene: `cargo test --release -p spectral-tests --test photon_adaptivity -- --ignored --nocapture`.
#![allow(clippy::panic, clippy::unwrap_used, reason = "helpers of tests fail by panicking")]
#![allow(clippy::print_stdout, reason = "figures for who runs a test with --nocapture")]

use renderers::photon::{Bundle, Rethrow};
use renderers::render::{Between, Options, PhotonCount, PhotonOptions, Renderer, Rendering, Spectra, render};
use renderers::scene::{Scene, builtin};
use spectral_core::colour::rgb::{WHITE, linear_rgb_to_xyz};
use spectral_core::colour::{delta_e_00, xyz_to_lab};

fn load(name: &str, parameters: &[(&str, &str)]) -> Scene {
    let parameters: Vec<_> = parameters.iter().map(|(n, v)| ((*n).to_owned(), (*v).to_owned())).collect();
    builtin::load(name, &parameters).unwrap()
}

fn options(count: u64, side: u32) -> Options {
    let photons =
        PhotonOptions { count: PhotonCount::Count(count), between: Between::Ambient, ..PhotonOptions::default() };
    Options {
        renderer: Renderer::PhotonMap,
        size: Some([side; 2]),
        samples: Some(4),
        seed: Some(1),
        photons,
        ..Options::default()
    }
}

/// The photons in the maps of all bands.
fn stored(rendering: &Rendering) -> usize {
    rendering.photons.as_ref().unwrap().bands.iter().map(|band| band.photons).sum()
}

/// Mean ΔE00 of two pictures.
fn difference(a: &Rendering, b: &Rendering) -> f64 {
    let lab = |rgb: &[f32; 3]| xyz_to_lab(linear_rgb_to_xyz(rgb.map(f64::from)), WHITE);
    let pairs = a.picture.pixels().iter().zip(b.picture.pixels());
    let differences: Vec<f64> = pairs.map(|(a, b)| delta_e_00(lab(a), lab(b))).collect();
    #[allow(clippy::cast_precision_loss, reason = "pixels")]
    let mean = differences.iter().sum::<f64>() / differences.len() as f64;
    mean
}

/// Rays and pictures are Whitted's where nothing is specular, and the rays are where no index depends on the wavelength.
#[test]
fn pixels_without_caustics_cost_what_whitted_costs() {
    let compare = |name, parameters: &[(&str, &str)]| {
        let scene = load(name, parameters);
        [Renderer::PhotonMap, Renderer::Whitted]
            .map(|renderer| render(&scene, &Options { renderer, ..options(20_000, 48) }, &|_| {}).unwrap())
    };
    let [photons, whitted] = compare("cornell-box", &[]);
    assert_eq!((photons.rays, photons.picture.pixels()), (whitted.rays, whitted.picture.pixels()));
    assert_eq!(photons.intervals.pixels(), whitted.intervals.pixels());
    let report = photons.photons.unwrap();
    assert_eq!((report.emitted, report.even, report.dispersed, report.bands.len()), (0, 0, 0, 0));
    for (name, parameters) in [("cornell-box-glass", &[][..]), ("caustic-ring-mirror", &[])] {
        let [photons, whitted] = compare(name, parameters);
        println!("{name}: {} rays, {} with Whitted", photons.rays, whitted.rays);
        assert_eq!(photons.rays, whitted.rays, "{name}");
        let report = photons.photons.unwrap();
        assert!(report.even > 1000 && report.dispersed == 0 && report.bands.is_empty(), "{name}");
    }
}

/// What is asserted of a row of the table: rays from the eye, and how many maps of photons.
struct Row {
    rays: u64,
    maps: usize,
}

fn rows(scene: &Scene, base: &Options) -> [Row; 3] {
    let reference = render(scene, &Options { spectra: Spectra::Uniform(160), ..*base }, &|_| {}).unwrap();
    // Fixed wavelengths are traced one by one, as renderers without intervals do.
    let single = PhotonOptions { bundle: Bundle::Single, rethrow: Rethrow::Traced, ..base.photons };
    let ways = [(Spectra::default(), base.photons), (Spectra::Uniform(61), single), (Spectra::Uniform(81), single)];
    ways.map(|(spectra, photons)| {
        let found = render(scene, &Options { spectra, photons, ..*base }, &|_| {}).unwrap();
        let report = found.photons.as_ref().unwrap();
        println!(
            "{spectra}, {:?}: {} rays, {} photons in {} maps, {:.2} s ({:.2} s for photons), ΔE00 {:.3}",
            photons.rethrow,
            found.rays,
            stored(&found),
            report.bands.len(),
            found.seconds + found.preparation_seconds,
            report.seconds,
            difference(&found, &reference)
        );
        Row { rays: found.rays, maps: report.bands.len() }
    })
}

/// Intervals that pixels ask for take fewer rays than wavelengths that are all traced, and no more maps: these have all about as many photons.
#[test]
fn intervals_take_less_than_tracing_all_wavelengths() {
    let [intervals, fewer, more] = rows(&load("cornell-box-glass", &[("glass", "N-BK7")]), &options(20_000, 48));
    assert!(2 * intervals.rays <= fewer.rays && fewer.rays < more.rays);
    assert!(intervals.maps <= fewer.maps && intervals.maps <= more.maps);
}

/// The table, at the size of pictures.
#[test]
#[ignore = "minutes"]
fn table_of_intervals_against_wavelengths() {
    for (name, parameters) in [("cornell-box-glass", &[("glass", "N-BK7")][..]), ("caustic-ring", &[]), ("prism", &[])]
    {
        println!("{name}");
        let [intervals, fewer, more] = rows(&load(name, parameters), &options(60_000, 96));
        assert!(intervals.rays <= fewer.rays && intervals.rays <= more.rays, "{name}");
    }
}
