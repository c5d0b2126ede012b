//! `spectral illuminance`: what it answers, and what it refuses.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

use serde_json::Value;
use spectral_tests::program;

const SCENE: &str = "<scene version='3.0.0'><default name='depth' value='2'/>
    <integrator type='path'><integer name='max_depth' value='$depth'/></integrator>
    <sensor type='perspective'><float name='fov' value='40'/></sensor>
    <shape type='disk'><transform name='to_world'><rotate x='1' angle='180'/><translate z='1'/></transform>
    <emitter type='area'><spectrum name='radiance' value='1'/></emitter></shape></scene>";

fn file(name: &str, text: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("illuminance_command");
    std::fs::create_dir_all(&folder).unwrap();
    let path = folder.join(name);
    std::fs::write(&path, text).unwrap();
    path
}

fn run(arguments: &[&str], stdin: &str) -> Output {
    let mut command = Command::new(program::spectral(env!("CARGO_TARGET_TMPDIR")));
    command.arg("illuminance").args(arguments).stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut child = command.spawn().unwrap();
    // A program that refuses its arguments doesn't read on.
    let _ = child.stdin.take().unwrap().write_all(stdin.as_bytes());
    child.wait_with_output().unwrap()
}

fn json(arguments: &[&str], stdin: &str) -> Value {
    let output = run(&[arguments, &["--json"]].concat(), stdin);
    assert!(output.status.success() && output.stderr.is_empty(), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}

#[test]
fn answers_points_in_their_order() {
    let scene = file("disk.xml", SCENE);
    let points = file("points.csv", "x,y,z,nx,ny,nz\n0,0,0,0,0,2\n# rim\n1,0,0,0,0,1\n0,0,0,0,0,-1\n");
    let (scene, points) = (scene.to_str().unwrap(), points.to_str().unwrap());
    let answer = json(&[scene, "--points", points], "");
    let all = answer["points"].as_array().unwrap();
    let lux = |i: usize| all[i]["lux"].as_f64().unwrap();
    assert_eq!(all.len(), 3);
    assert!((lux(1) / lux(0) - (1.0 - 1.0 / 5.0_f64.sqrt())).abs() <= 1e-12 && lux(2) == 0.0);
    assert_eq!(all[0]["normal"], serde_json::json!([0.0, 0.0, 1.0]));
    assert_eq!(all[1]["position"], serde_json::json!([1.0, 0.0, 0.0]));
    assert!(all[0]["direct_lux"] == all[0]["lux"] && all[0]["indirect_lux"] == 0.0);
    // From standard input, whatever the number of threads, with spectra.
    let text = std::fs::read_to_string(points).unwrap();
    assert_eq!(json(&[scene, "--points", "-", "--threads", "1"], &text), answer);
    let spectral = json(&[scene, "--points", "-", "--spectral"], &text);
    assert_eq!(spectral["wavelengths"].as_array().unwrap().len(), 401);
    let value = spectral["points"][0]["spectrum"][175].as_f64().unwrap();
    assert!((value - core::f64::consts::FRAC_PI_2).abs() <= 1e-12, "{value}");
    // A flat spectrum is of some 5455 K; where nothing arrives, there is no colour.
    let number = |i: usize, key: &str| spectral["points"][i][key].as_f64();
    assert!((number(0, "cct").unwrap() - 5455.0).abs() <= 5.0 && number(0, "duv").unwrap() < 0.0);
    assert!(number(0, "ra").unwrap() > 90.0 && number(0, "cri00_munsell").unwrap() > 90.0);
    assert!(spectral["points"][2]["cct"].is_null() && spectral["points"][2]["ra"].is_null());
    assert!(answer["points"][0].get("cct").is_none());
    // For people.
    let shown = String::from_utf8(run(&[scene, "--points", points], "").stdout).unwrap();
    assert!(shown.contains("3 points: min 0, mean ") && shown.contains("not asked for"), "{shown}");
}

/// A disk that shines down on a white floor: what the floor sends back to a receiver that looks down from the light's centre.
const LIT_FLOOR: &str = "<scene version='3.0.0'><integrator type='path'><integer name='max_depth' value='3'/></integrator>
    <sensor type='perspective'><float name='fov' value='40'/></sensor>
    <shape type='disk'><transform name='to_world'><scale value='0.01'/><rotate x='1' angle='180'/><translate z='1'/></transform>
    <bsdf type='diffuse'><spectrum name='reflectance' value='0'/></bsdf>
    <emitter type='area'><spectrum name='radiance' value='1'/></emitter></shape>
    <shape type='rectangle'><transform name='to_world'><scale value='40'/></transform>
    <bsdf type='diffuse'><spectrum name='reflectance' value='0.5'/></bsdf></shape></scene>";

#[test]
fn light_between_surfaces_is_found_where_the_scene_asks_for_it() {
    let scene = file("lit_floor.xml", LIT_FLOOR);
    let answer = json(&[scene.to_str().unwrap(), "--points", "-", "--accuracy", "1e-3"], "0,0,2,0,0,-1");
    let point = &answer["points"][0];
    assert!(answer["indirect"] == "radiosity" && point["direct_lux"] == 0.0, "{answer}");
    // With a = 1, b = 2 the heights of light and receiver and I the light's intensity, the floor sends up
    // (the disk itself hides 7e-4 of it) (ρ/π) ∫ I cos⁴/a² · cos⁴/b² dA = ρ I 2 ∫ a² b² s ds / ((s² + a²)² (s² + b²)²), in closed form by x = s².
    let (a2, b2) = (1.0_f64, 4.0_f64);
    let d = b2 - a2;
    let integral = a2 * b2 * ((1.0 / a2 + 1.0 / b2) / (d * d) - 2.0 * (b2 / a2).ln() / (d * d * d));
    let intensity = core::f64::consts::PI * 1e-4 * 683.002 * 106.856_399;
    let expected = 0.5 * intensity * integral;
    let found = point["indirect_lux"].as_f64().unwrap();
    let stated = point["error"].as_f64().unwrap();
    assert!((found - expected).abs() <= stated && stated <= 0.011 * expected, "{found} ± {stated}, exact {expected}");
}

#[test]
fn says_when_indirect_light_is_missing() {
    let floor = "<bsdf type='diffuse'><spectrum name='reflectance' value='0.5'/></bsdf>";
    let mirror = LIT_FLOOR.replace(floor, "<bsdf type='conductor'><string name='material' value='Ag'/></bsdf>");
    let scene = file("mirror.xml", &mirror);
    let arguments = [scene.to_str().unwrap(), "--points", "-"];
    let answer = json(&arguments, "0,0,0.5,0,0,1");
    let point = &answer["points"][0];
    assert!(answer["indirect"].as_str().unwrap().starts_with("not computed: "), "{answer}");
    assert!(point["indirect_lux"] == Value::Null && point["lux"] == point["direct_lux"], "{answer}");
    let shown = String::from_utf8(run(&arguments, "0,0,0.5,0,0,1").stdout).unwrap();
    assert!(shown.contains("indirect: not computed: ") && shown.contains("direct part alone"), "{shown}");
}

#[test]
fn refuses_bad_input_in_one_line() {
    let scene = file("again.xml", SCENE);
    let scene = scene.to_str().unwrap();
    let bad = file("bad.csv", "0,0,0,0,0,1\n0,0,zero,0,0,1\n");
    let bad = bad.to_str().unwrap();
    for (arguments, stdin, said) in [
        (vec![scene, "--points", bad], "", format!("spectral: {bad}:2: \"zero\" is not a finite number\n")),
        (
            vec![scene, "--points", "-"],
            "\n1 2 3",
            "spectral: standard input:2: expected six numbers, x, y, z, nx, ny, nz, and not 3\n".to_owned(),
        ),
        (vec![scene, "--points", "-"], "", "spectral: standard input: no points in it\n".to_owned()),
        (
            vec![scene, "--points", "-"],
            "0,0,1e20,0,0,1",
            "spectral: standard input:1: a coordinate is beyond 1e12\n".to_owned(),
        ),
        (
            vec![scene, "--points", "-", "--accuracy", "0"],
            "0,0,0,0,0,1",
            format!("spectral: {scene}: the accuracy must be from 1e-5 to 0.5, not 0\n"),
        ),
    ] {
        let output = run(&arguments, stdin);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        assert_eq!(String::from_utf8(output.stderr).unwrap(), said);
        assert!(output.stdout.is_empty());
    }
    for arguments in [vec![scene], vec!["no-such-scene", "--points", "-"], vec![scene, "--points", "/no/such/file"]] {
        let output = run(&arguments, "0,0,0,0,0,1");
        assert!(
            output.status.code() == Some(2) && output.stderr.iter().filter(|b| **b == b'\n').count() == 1,
            "{output:?}"
        );
    }
}
