//! `spectral brdf`: what it answers, and the files and options that it refuses.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use renderers::brdf::{linoleum, parse_readings};
use renderers::image::read_png;
use serde_json::Value;
use spectral_tests::program;

fn spectral(arguments: &[&str]) -> Output {
    Command::new(program::spectral(env!("CARGO_TARGET_TMPDIR"))).args(arguments).output().unwrap()
}

fn json(arguments: &[&str]) -> Value {
    let output = spectral(&[&["--json"], arguments].concat());
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    assert!(output.stderr.is_empty());
    serde_json::from_slice(&output.stdout).unwrap()
}

fn text(arguments: &[&str]) -> String {
    let output = spectral(arguments);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

/// The one line of a refusal, which leaves with 2.
fn refused(arguments: &[&str]) -> String {
    let output = spectral(arguments);
    let line = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(2), "{arguments:?}: {line}");
    assert!(output.stdout.is_empty() && line.lines().count() == 1, "{line}");
    line.trim_end().to_owned()
}

fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("brdf_command").join(name);
    std::fs::create_dir_all(&folder).unwrap();
    folder
}

fn file(name: &str, content: &str) -> String {
    let path = folder("data").join(name);
    std::fs::write(&path, content).unwrap();
    path.display().to_string()
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap()
}

/// The built-in table with one reading a row.
fn long_form() -> String {
    let mut text = "theta_v_deg,phi_v_deg,value,theta_l_deg,phi_l_deg\n".to_owned();
    for reading in linoleum().unwrap() {
        let ([theta_l, phi_l], [theta_v, phi_v]) = (reading.light, reading.view);
        text += &format!("{theta_v},{phi_v},{},{theta_l},{phi_l}\n", reading.value);
    }
    text
}

#[test]
fn a_fit_has_its_keys() {
    let fit = json(&["brdf", "fit", "--model", "balanced"]);
    // Published: table 2.3.
    assert!((number(&fit["rho_s"]) - 0.04982).abs() <= 0.5e-5);
    assert!((number(&fit["alpha"]) - 0.03172).abs() <= 0.5e-5);
    assert!((number(&fit["residual"]) - 0.9241).abs() <= 0.5e-4);
    assert_eq!(fit["parameters"], serde_json::json!(["rho_s", "alpha"]));
    for key in ["standard_errors", "covariance", "correlation"] {
        assert_eq!(fit[key].as_array().unwrap().len(), 2, "{key}");
    }
    assert!(number(&fit["condition_number"]) >= 1.0 && number(&fit["iterations"]) >= 1.0);
    assert!(number(&fit["starts_agreeing"]) <= number(&fit["starts"]));
    assert_eq!(fit["determined"], true);
    assert_eq!(fit["incidences"].as_array().unwrap().len(), 6);
    assert_eq!(fit["readings"].as_array().unwrap().len(), 222);
    assert_eq!((&fit["model"], &fit["data"], &fit["loss"]), (&"balanced".into(), &"linoleum".into(), &"linear".into()));
    assert_eq!(number(&fit["without_horizon"]["readings"]), 216.0);
    let cut = json(&["brdf", "fit", "--model", "balanced", "--max-view-angle", "89"]);
    for key in ["rho_s", "alpha", "residual"] {
        assert_eq!(cut[key], fit["without_horizon"][key], "{key}");
    }
    assert!(cut["without_horizon"].is_null());
}

#[test]
fn all_models_stand_beside_each_other() {
    let all = json(&["brdf", "fit", "linoleum", "--model", "all"]);
    let fits = all["fits"].as_array().unwrap();
    let names: Vec<_> = fits.iter().map(|fit| fit["model"].as_str().unwrap()).collect();
    assert_eq!(names, ["ward", "ward-duer", "ward-neumann", "balanced"]);
    // Published: 2.8846 and 0.9241.
    assert!((number(&fits[1]["residual"]) / number(&fits[3]["residual"]) - 3.1215).abs() <= 5e-4);
    let shown = text(&["brdf", "fit", "--model", "all"]);
    for name in names {
        assert!(shown.lines().any(|line| line.starts_with(name)), "{name}: {shown}");
    }
    assert!(shown.contains("the fit hangs on 6 views at 90°"), "{shown}");
}

#[test]
fn both_forms_of_a_file_are_read() {
    let expected = json(&["brdf", "fit", "--model", "ward"]);
    let long = file("long.csv", &long_form());
    let commented =
        file("commented.csv", &("\u{feff}# measured\r\n\r\n".to_owned() + &long_form().replace('\n', " # x\r\n")));
    for path in [long, commented] {
        let found = json(&["brdf", "fit", &path, "--model", "ward", "--reflectance", "0.175"]);
        assert_eq!((&found["rho_s"], &found["alpha"]), (&expected["rho_s"], &expected["alpha"]));
    }
    let gaps = parse_readings("f", "theta_v_deg,inc25,inc60.5\n10,,0.5\n20,0.25,\n").unwrap();
    assert_eq!(
        gaps.iter().map(|r| (r.light[0], r.view[0], r.value)).collect::<Vec<_>>(),
        [(60.5, 10.0, 0.5), (25.0, 20.0, 0.25)]
    );
    assert_eq!(gaps.iter().map(|r| r.line).collect::<Vec<_>>(), [2, 3]);
}

#[test]
fn a_file_of_its_own_gets_its_reflectance_fitted() {
    let path = file("own.csv", &long_form());
    let found = json(&["brdf", "fit", &path, "--model", "balanced"]);
    assert_eq!(found["reflectance_fitted"], true);
    assert_eq!(found["parameters"], serde_json::json!(["reflectance", "rho_s", "alpha"]));
    let fitted = json(&["brdf", "fit", "--model", "balanced", "--reflectance", "fit"]);
    assert_eq!(fitted["rho_s"], found["rho_s"]);
    // A parameter more can't fit worse.
    assert!(number(&found["residual"]) < 0.9241);
}

#[test]
fn bad_files_are_refused_with_their_line() {
    let table = |rows: &str| format!("theta_v_deg,inc25,inc35\n{rows}");
    let long = |rows: &str| format!("theta_l,phi_l,theta_v,phi_v,value\n{rows}");
    for (name, content, line, words) in [
        ("columns", table("0,1,2\n5,1\n"), 3, "2 columns, where the heading has 3"),
        ("nan", table("0,1,nan\n"), 2, "not finite"),
        ("infinite", long("25,0,inf,0,1\n"), 2, "not finite"),
        ("word", table("0,1,x\n"), 2, "not a number"),
        ("negative", long("# c\n\n25,0,30,0,-1\n"), 4, "negative"),
        ("view", table("90.5,1,2\n"), 2, "not in [0°, 90°]"),
        ("below", long("25,0,-5,0,1\n"), 2, "not in [0°, 90°]"),
        ("light", long("90,0,5,0,1\n"), 2, "not in [0°, 90°)"),
        ("heading_light", "theta_v_deg,inc90\n0,1\n".to_owned(), 1, "not in [0°, 90°)"),
        ("heading", "a,b\n1,2\n".to_owned(), 1, "no column theta_l"),
        ("no_heading", "0,1,2\n5,1,2\n".to_owned(), 1, "no column theta_l"),
        ("twice", "theta_l,phi_l,theta_v,phi_v,value,value\n".to_owned(), 1, "more than one column value"),
        ("unknown", "theta_l,phi_l,theta_v,phi_v,value,x\n".to_owned(), 1, "unknown column"),
    ] {
        let path = file(&format!("{name}.csv"), &content);
        let said = refused(&["brdf", "fit", &path, "--model", "ward"]);
        assert!(said.contains(&format!("{path}:{line}: ")) && said.contains(words), "{name}: {said}");
    }
    for (name, content, words) in [
        ("empty", String::new(), "no readings"),
        ("only_heading", table(""), "no readings"),
        ("one_row", long("25,0,25,180,1\n"), "1 readings for 3 parameters"),
        ("three_rows", long("25,0,25,180,1\n25,0,26,180,1\n25,0,27,180,1\n"), "3 readings for 3 parameters"),
    ] {
        let path = file(&format!("{name}.csv"), &content);
        let said = refused(&["brdf", "fit", &path, "--model", "ward"]);
        assert!(said.contains(&path) && said.contains(words), "{name}: {said}");
    }
    let missing = folder("data").join("missing.csv").display().to_string();
    assert!(refused(&["brdf", "fit", &missing, "--model", "ward"]).contains(&missing));
}

#[test]
fn bad_options_are_refused() {
    for (arguments, words) in [
        (&["fit"][..], "--model"),
        (&["fit", "--model", "phong"], "'phong'"),
        (&["fit", "--model", "ward", "--reflectance", "1.5"], "(0, 1]"),
        (&["fit", "--model", "ward", "--reflectance", "0"], "(0, 1]"),
        (&["fit", "--model", "ward", "--reflectance", "NaN"], "(0, 1]"),
        (&["fit", "--model", "ward", "--reflectance", "x"], "(0, 1] or fit"),
        (&["fit", "--model", "ward", "--loss", "cauchy", "--loss-scale", "-1"], "positive"),
        (&["fit", "--model", "ward", "--max-view-angle", "-1"], "negative"),
        (&["fit", "--model", "ward", "--max-view-angle", "NaN"], "negative"),
        (&["albedo", "--model", "ward"], "--alpha"),
        (&["albedo", "--model", "ward", "--alpha", "0"], "roughness"),
        (&["albedo", "--model", "ward", "--alpha", "-0.1"], "roughness"),
        (&["albedo", "--model", "ward", "--alpha", "NaN"], "roughness"),
        (&["albedo", "--model", "ward", "--alpha", "0.1", "--alpha-v", "0"], "roughness"),
        (&["albedo", "--model", "ward", "--alpha", "0.1,0.2", "--alpha-v", "0.3"], "2 values of --alpha"),
        (&["albedo", "--model", "ward", "--alpha", "0.1", "--theta", "0:90:1"], "TO < 90"),
        (&["albedo", "--model", "ward", "--alpha", "0.1", "--theta", "5:1:1"], "FROM ≤ TO"),
        (&["albedo", "--model", "ward", "--alpha", "0.1", "--theta", "0:89:0"], "positive STEP"),
        (&["albedo", "--model", "ward", "--alpha", "0.1", "--theta", "0:89:1e-9"], "more than 10000 angles"),
        (&["albedo", "--model", "ward", "--alpha", "0.1", "--theta", "0:89"], "FROM:TO:STEP"),
        (&["albedo", "--model", "ward", "--alpha", "0.1", "--phi", "inf"], "finite"),
    ] {
        let said = refused(&[&["brdf"], arguments].concat());
        assert!(said.contains(words), "{arguments:?}: {said}");
    }
}

#[test]
fn an_albedo_has_its_keys() {
    let one = json(&["brdf", "albedo", "--model", "balanced", "--alpha", "0.1", "--theta", "0:60:30"]);
    assert_eq!(one["theta_deg"], serde_json::json!([0.0, 30.0, 60.0]));
    let albedo: Vec<_> = one["albedo"].as_array().unwrap().iter().map(number).collect();
    assert_eq!(albedo.len(), 3);
    assert!(albedo.iter().all(|&a| a > 0.95 && a <= 1.0), "{albedo:?}");
    let all = json(&["brdf", "albedo", "--model", "all", "--alpha", "0.1,0.2", "--theta", "89:89.9:0.1"]);
    assert_eq!(all["theta_deg"].as_array().unwrap().len(), 10);
    assert_eq!(all["curves"].as_array().unwrap().len(), 10);
    assert!(all["curves"].as_array().unwrap().iter().all(|curve| curve["albedo"].as_array().unwrap().len() == 10));
    let sampled = json(&["brdf", "albedo", "--model", "ward", "--alpha", "0.1", "--alpha-v", "0.3", "--phi", "90"]);
    let turned = json(&["brdf", "albedo", "--model", "ward", "--alpha", "0.3", "--alpha-v", "0.1"]);
    for (a, b) in sampled["albedo"].as_array().unwrap().iter().zip(turned["albedo"].as_array().unwrap()) {
        assert!((number(a) - number(b)).abs() <= 1e-8);
    }
    let marked = text(&["brdf", "albedo", "--model", "ward-duer", "--alpha", "0.1", "--theta", "80:89:9"]);
    let marks: Vec<_> =
        marked.lines().filter(|line| line.trim_start().starts_with('8')).map(|line| line.ends_with(">1")).collect();
    assert_eq!(marks, [false, true], "{marked}");
}

#[test]
fn pictures_are_drawn() {
    let out = folder("pictures");
    let out = out.display().to_string();
    for arguments in [
        &["brdf", "fit", "--model", "all", "--out", &out][..],
        &["brdf", "albedo", "--model", "balanced", "--alpha", "0.1", "--theta", "0:1:1", "--out", &out],
    ] {
        let answer = json(arguments);
        let path = PathBuf::from(answer["files"][0].as_str().unwrap());
        let picture = read_png(&path).unwrap();
        assert!(picture.width() == 1500 && picture.height() > 500);
        // The balanced model's vermilion, and ink.
        let near = |colour: [f32; 3]| {
            let like = |pixel: &&[f32; 3]| pixel.iter().zip(colour).all(|(a, b)| (a - b).abs() < 0.02);
            picture.pixels().iter().filter(like).count()
        };
        assert!(near([0.665, 0.112, 0.0]) > 200 && near([0.013, 0.013, 0.013]) > 200, "{}", path.display());
    }
}
