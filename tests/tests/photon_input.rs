//! `spectral render --renderer photon-map` as it is called: what it answers, what it refuses, and scenes without light for it.
#![allow(clippy::panic, clippy::unwrap_used, reason = "helpers of tests fail by panicking")]

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use renderers::render::{Between, Options, PhotonCount, PhotonOptions, Renderer, Rendering, Spectra, render};
use renderers::scene::{Scene, builtin};
use serde_json::Value;
use spectral_tests::program;

fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("photon_input").join(name);
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).unwrap();
    folder
}

fn run(folder: &Path, scene: &str, arguments: &str) -> Output {
    let mut command = Command::new(program::spectral(env!("CARGO_TARGET_TMPDIR")));
    command.args(["render", scene, "--renderer", "photon-map", "--size", "16x16", "--between", "ambient"]);
    command.args(arguments.split_whitespace()).current_dir(folder).env("RUST_BACKTRACE", "0").output().unwrap()
}

fn answer(folder: &Path, scene: &str, arguments: &str) -> Value {
    let output = run(folder, scene, &format!("{arguments} --json"));
    assert!(output.status.success() && output.stderr.is_empty(), "{scene} {arguments}: {output:?}");
    serde_json::from_slice(&output.stdout).unwrap()
}

fn refusal(arguments: &str) -> String {
    let output = run(&folder("refused"), "caustic-ring-mirror", arguments);
    assert!(!output.status.success() && output.stdout.is_empty(), "{arguments}: {output:?}");
    String::from_utf8(output.stderr).unwrap()
}

/// A lamp above a floor, with something else.
fn written(folder: &Path, body: &str) -> String {
    let xml = format!(
        "<scene version='3.0.0'><integrator type='path'/>
        <sensor type='perspective'><float name='fov' value='40'/>
        <transform name='to_world'><lookat origin='0, 4, -12' target='0, 0, 0' up='0, 1, 0'/></transform></sensor>
        <shape type='rectangle'><transform name='to_world'><rotate x='1' angle='90'/><translate y='5'/></transform>
        <emitter type='area'><spectrum name='radiance' value='4'/></emitter></shape>{body}</scene>"
    );
    fs::write(folder.join("scene.xml"), xml).unwrap();
    "scene.xml".to_owned()
}

const FLOOR: &str = "<shape type='rectangle'><transform name='to_world'><rotate x='1' angle='-90'/><scale value='5'/></transform></shape>";
const BALL: &str = "<shape type='sphere'><point name='center' x='0' y='2' z='0'/><bsdf type='dielectric'>
    <float name='int_ior' value='1.5'/><float name='ext_ior' value='1'/></bsdf></shape>";

fn notes(answer: &Value) -> Vec<String> {
    answer["photon_map"]["notes"].as_array().unwrap().iter().map(|n| n.as_str().unwrap().to_owned()).collect()
}

#[test]
fn counts_out_of_range_are_refused() {
    let none = refusal("--photons 0");
    assert!(none.contains("--photons") && none.contains('0'), "{none}");
    for many in ["99999999999", "18446744073709551615"] {
        let text = refusal(&format!("--photons {many}"));
        assert!(text.contains(many) && text.contains("GiB"), "{text}");
    }
    let text = refusal("--photons 1000000000");
    assert!(text.contains("GiB"), "{text}");
    for (arguments, name) in [
        ("--photons -1", "photons"),
        ("--photon-error 0", "photon-error"),
        ("--photon-error NaN", "photon-error"),
        ("--nearest 0", "nearest"),
        ("--nearest 1", "2 photons"),
        ("--radius 0", "radius"),
        ("--radius inf", "radius"),
        ("--kernel gauss", "kernel"),
    ] {
        let text = refusal(arguments);
        assert!(text.contains(name), "{arguments}: {text}");
    }
}

/// Estimates from n photons with a kernel of roughness R have a standard error of √(R/n) at least: 16.3 % for 50 and Epanechnikov's 4/3, 14.1 %
/// for the constant kernel.
#[test]
fn errors_that_no_number_of_photons_meets_are_refused_at_once() {
    for (arguments, least) in [
        ("--photon-error 0.1", "16.3 %"),
        ("--photon-error 0.163", "16.3 %"),
        ("--photon-error 0.14 --kernel constant", "14.1 %"),
        ("--photon-error 0.001 --nearest 1000", "3.7 %"),
    ] {
        let output = run(&folder("unreachable"), "caustic-ring-mirror", arguments);
        assert_eq!(output.status.code(), Some(2), "{arguments}: {output:?}");
        let text = String::from_utf8(output.stderr).unwrap();
        for words in [least, "--nearest", "--photon-error"] {
            assert!(text.contains(words), "{arguments}: {text}");
        }
        assert!(output.stdout.is_empty() && text.trim_end().lines().count() == 1, "{arguments}: {text}");
    }
    // What is above is met.
    let map = &answer(&folder("reachable"), "caustic-ring-mirror", "--photon-error 0.15 --nearest 400")["photon_map"];
    assert!(map["emitted"].as_u64().unwrap() > 1000, "{map}");
}

#[test]
fn scenes_without_anything_for_photons_are_drawn_with_a_note() {
    let folder = folder("without");
    for (name, body, light_sees) in [
        ("no mirror", FLOOR.to_owned(), false),
        // A ball below the floor, where no light comes.
        ("hidden glass", format!("{FLOOR}{}", BALL.replace("y='2'", "y='-2'")), false),
        ("all escape", BALL.to_owned(), true),
        ("a ball", format!("{FLOOR}{BALL}"), true),
    ] {
        let scene = written(&folder, &body);
        let answer = answer(&folder, &scene, "--photons 2000");
        let map = &answer["photon_map"];
        assert_eq!(!notes(&answer).is_empty(), !light_sees, "{name}: {map}");
        assert_eq!(map["emitted"].as_u64().unwrap() > 0, light_sees, "{name}: {map}");
        let share = |key: &str| map["flux"][key].as_f64().unwrap();
        if name == "all escape" {
            // All but what comes back to the lamp.
            assert!(share("escaped") > 0.98, "{map}");
        }
        if light_sees {
            let all: f64 =
                ["kept", "escaped", "absorbed", "too_deep", "dispersed", "roulette", "bent"].map(share).iter().sum();
            assert!((all - 1.0).abs() <= 1e-9, "{name}: {map}");
        }
    }
}

/// What is known of every scene's photons, under these names.
#[test]
fn the_answer_has_its_keys() {
    let folder = folder("keys");
    let answer = answer(&folder, "caustic-ring", "--photons 3000 --spectra uniform:8");
    let map = answer["photon_map"].as_object().unwrap();
    let mut keys: Vec<_> = map.keys().map(String::as_str).collect();
    keys.sort_unstable();
    assert_eq!(
        keys,
        [
            "bands",
            "bytes",
            "delta_e",
            "dispersed_paths",
            "emitted",
            "flux",
            "idle_lights",
            "kept",
            "keys_nm",
            "notes",
            "seconds"
        ]
    );
    assert!(map["dispersed_paths"].as_u64().unwrap() > 1000 && map["bytes"].as_u64().unwrap() > 10_000);
    let bands = map["bands"].as_array().unwrap();
    assert!(!bands.is_empty());
    for band in bands {
        let [from, to] = [0, 1].map(|k| band["nm"][k].as_f64().unwrap());
        assert!(380.0 <= from && from < to && to <= 780.0 && band["photons"].as_u64().unwrap() > 0, "{band}");
    }
    assert!(map["delta_e"]["max"].as_f64().unwrap() > map["delta_e"]["mean"].as_f64().unwrap());
    // Options of photons are for photons alone.
    let mut command = Command::new(program::spectral(env!("CARGO_TARGET_TMPDIR")));
    let output = command.args(["render", "--photons", "10"]).current_dir(&folder).output().unwrap();
    assert!(!output.status.success() && String::from_utf8_lossy(&output.stderr).contains("--renderer photon-map"));
}

fn picture(scene: &Scene, spectra: Spectra, threads: usize) -> Rendering {
    let photons =
        PhotonOptions { count: PhotonCount::Count(20_000), between: Between::Ambient, ..PhotonOptions::default() };
    let options = Options {
        renderer: Renderer::PhotonMap,
        spectra,
        size: Some([32; 2]),
        samples: Some(2),
        photons,
        ..Options::default()
    };
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
    pool.install(|| render(scene, &options, &|_| {})).unwrap()
}

#[test]
fn pictures_do_not_depend_on_threads() {
    for (name, spectra) in [
        ("cornell-box-glass", Spectra::Uniform(8)),
        ("caustic-ring", Spectra::default()),
        ("caustic-ring-mirror", Spectra::Uniform(8)),
        ("prism", Spectra::default()),
    ] {
        let scene = builtin::load(name, &[]).unwrap();
        let [one, three] = [1, 3].map(|threads| picture(&scene, spectra, threads));
        assert!(one.picture == three.picture && one.intervals == three.intervals, "{name}");
        assert!(one.photon_delta_e == three.photon_delta_e && one.delta_e == three.delta_e, "{name}");
        let [one, three] = [one, three].map(|r| r.photons.unwrap());
        assert_eq!(
            (one.emitted, one.even, one.dispersed, one.flux),
            (three.emitted, three.even, three.dispersed, three.flux)
        );
        assert_eq!((one.bands, one.keys), (three.bands, three.keys), "{name}");
    }
}
