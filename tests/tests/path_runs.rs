//! Path tracing on any number of threads and in any number of runs is the same to the bit; what can't go on is refused.
#![allow(clippy::panic, clippy::unwrap_used, reason = "helpers of tests fail by panicking")]

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use renderers::path::{Paths, Run, render};
use renderers::render::{Options, Renderer, Rendering, Spectra};
use renderers::scene::{Scene, builtin};
use serde_json::Value;
use spectral_tests::program::spectral;

fn scene() -> Scene {
    builtin::load("cornell-box-spheres", &[]).unwrap()
}

fn options(samples: u32) -> Options {
    Options {
        renderer: Renderer::Path,
        spectra: Spectra::Uniform(16),
        size: Some([19, 13]),
        samples: Some(samples),
        seed: Some(5),
        ..Options::default()
    }
}

fn traced(options: &Options, state: Option<&Path>) -> Result<Rendering, String> {
    render(&scene(), options, Run { state, ..Run::default() }, &|_| {}).map_err(|e| e.to_string())
}

#[track_caller]
fn assert_same(a: &Rendering, b: &Rendering) {
    assert_eq!(a.picture, b.picture);
    let [a, b] = [a, b].map(|r| r.variance.as_ref().unwrap());
    assert_eq!((&a.rgb, &a.luminance), (&b.rgb, &b.luminance));
}

fn scratch(name: &str) -> PathBuf {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("path_runs").join(name);
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).unwrap();
    folder
}

#[test]
fn the_picture_does_not_depend_on_the_number_of_threads() {
    let on = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| traced(&options(96), None).unwrap())
    };
    let one = on(1);
    assert!(one.picture.pixels().iter().any(|p| p[0] > 0.1));
    for threads in [2, 3] {
        let other = on(threads);
        assert_same(&one, &other);
        assert_eq!(one.rays, other.rays);
    }
}

#[test]
fn a_rendering_goes_on_as_if_it_had_never_stopped() {
    let folder = scratch("resumed");
    let whole = traced(&options(128), None).unwrap();
    // Stopped between runs of 64 samples, and within them.
    for parts in [&[64, 128][..], &[1, 50, 101, 128]] {
        let state = folder.join(format!("{}.state", parts.len()));
        let last = parts.iter().fold(None, |_, samples| Some(traced(&options(*samples), Some(&state)).unwrap()));
        assert_same(&whole, &last.unwrap());
        // Nothing is left to do.
        let again = traced(&options(128), Some(&state)).unwrap();
        assert_eq!(again.rays, 0);
        assert_same(&whole, &again);
    }
}

#[test]
fn a_state_of_something_else_is_refused_in_a_line() {
    let folder = scratch("refused");
    let state = folder.join("state");
    let given = options(4);
    traced(&given, Some(&state)).unwrap();
    for (options, reason) in [
        (Options { size: Some([13, 19]), ..given }, "is of another image size"),
        (Options { seed: Some(6), ..given }, "is of another seed"),
        (Options { spectra: Spectra::Rgb, ..given }, "is of another representation of spectra"),
        (Options { samples: Some(3), ..given }, "has 4 samples per pixel already, more than the 3 asked for"),
    ] {
        let error = traced(&options, Some(&state)).unwrap_err();
        assert_eq!(error, format!("{}: {reason}", state.display()));
    }
    let run = Run { state: Some(&state), paths: Paths::WithoutCaustics, ..Run::default() };
    let error = render(&scene(), &given, run, &|_| {}).unwrap_err().to_string();
    assert_eq!(error, format!("{}: is of other paths, with or without caustics", state.display()));
    let mut other = scene();
    other.camera.fov += 1e-9;
    let run = Run { state: Some(&state), ..Run::default() };
    let error = render(&other, &given, run, &|_| {}).unwrap_err().to_string();
    assert_eq!(error, format!("{}: is of another scene", state.display()));
    let good = std::fs::read(&state).unwrap();
    let mut flipped = good.clone();
    let middle = good.len() / 2;
    flipped[middle] ^= 1;
    for (bytes, reason) in [
        (&flipped[..], "is damaged"),
        (&good[..good.len() - 1], "is damaged"),
        (&good[..200], "is too short"),
        (&b"something else\n"[..], "is not the state of a path-traced picture"),
        (&b""[..], "is not the state of a path-traced picture"),
    ] {
        std::fs::write(&state, bytes).unwrap();
        assert_eq!(traced(&given, Some(&state)).unwrap_err(), format!("{}: {reason}", state.display()));
    }
}

#[test]
fn one_sample_has_no_variance() {
    assert!(traced(&options(1), None).unwrap().variance.is_none());
    assert!(traced(&options(2), None).unwrap().variance.is_some());
}

/// The variance that a picture states is that of pictures with other seeds.
#[test]
fn the_stated_variance_is_that_of_other_seeds() {
    for samples in [256, 160] {
        let seeds: Vec<Rendering> =
            (0..24).map(|seed| traced(&Options { seed: Some(seed), ..options(samples) }, None).unwrap()).collect();
        let (mut stated, mut found) = (0.0, 0.0);
        for pixel in 0..19 * 13 {
            let values: Vec<f64> = seeds.iter().map(|r| f64::from(r.picture.pixels()[pixel][1])).collect();
            let mean = values.iter().sum::<f64>() / 24.0;
            // Relative to brightness, so that no few pixels decide.
            let weight = 1.0 / (mean * mean + 1e-3);
            found += weight * values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / 23.0;
            let variances = seeds.iter().map(|r| f64::from(r.variance.as_ref().unwrap().rgb.pixels()[pixel][1]));
            stated += weight * variances.sum::<f64>() / 24.0;
        }
        // Each of the 247 pixels has 23 degrees of freedom, and rare bright paths.
        let ratio = stated / found;
        assert!((0.8..1.25).contains(&ratio), "{samples}: {ratio}");
    }
}

fn run(arguments: &[&str]) -> Output {
    Command::new(spectral(env!("CARGO_TARGET_TMPDIR"))).arg("render").args(arguments).output().unwrap()
}

#[test]
fn the_command_writes_picture_variance_and_numbers() {
    let folder = scratch("command");
    let out = folder.to_str().unwrap();
    let small = ["--renderer", "path", "--size", "8x8", "--spp", "8", "--out", out];
    let output = run(&[&small[..], &["--json"]].concat());
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    let found: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(found["renderer"], "path");
    assert_eq!(found["spectra"], "uniform:81");
    assert_eq!(found["samples"], 8);
    let [mean, error] = ["luminance_mean", "luminance_standard_error_mean"].map(|name| found[name].as_f64().unwrap());
    assert!(mean > 0.1 && error > 0.0 && error < mean);
    for file in found["files"].as_array().unwrap() {
        assert!(Path::new(file.as_str().unwrap()).exists());
    }
    let variance = folder.join("cornell-box-path-uniform81-variance.exr");
    let read = renderers::image::read_exr(&variance).unwrap();
    assert!(read.channels.iter().any(|(name, map)| name == "Y" && map.pixels().iter().any(|v| *v > 0.0)));

    for (arguments, reason) in [
        (&["--renderer", "path", "--spectra", "interval"][..], "the path tracer has no adaptive intervals"),
        (&["--resume", "x.state"], "--resume is for --renderer path"),
    ] {
        let output = run(&[arguments, &["--size", "4x4", "--out", out]].concat());
        let said = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{said}");
        assert!(said.contains(reason) && said.trim_end().lines().count() == 1, "{said}");
    }
}
