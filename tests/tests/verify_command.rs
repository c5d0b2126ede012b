//! `spectral verify` as a program: lists, judges, exports, scores, and says what is wrong with its input.
#![allow(clippy::unwrap_used, clippy::expect_used, reason = "tests stop at the first thing that should not be")]

use std::path::PathBuf;
use std::process::{Command, Output};

use renderers::luminaire::{LuminousIntensity, PhotometricFile};
use renderers::verify::{Reduction, Work, cases};
use serde_json::Value;
use spectral_tests::program::spectral;

const KEYS: [&str; 9] =
    ["name", "quantity", "reference", "computed", "relative_error", "tolerance", "pass", "samples", "seconds"];

fn verify(arguments: &[&str]) -> Output {
    let program = spectral(env!("CARGO_TARGET_TMPDIR"));
    Command::new(program).arg("verify").args(arguments).output().expect("the program runs")
}

fn json(output: &Output) -> Value {
    serde_json::from_slice(&output.stdout).expect("one JSON object")
}

fn scratch(name: &str) -> PathBuf {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("verify_command").join(name);
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).unwrap();
    folder
}

#[test]
fn the_tables_of_disks_are_reproduced() {
    let output = verify(&["disk.", "--json"]);
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stdout));
    let found = json(&output);
    let rows = found["cases"].as_array().unwrap();
    assert_eq!(rows.len(), 5 + 2 * 2 + 2 * 12 + 3 * (12 + 7));
    for row in rows {
        assert!(KEYS.iter().all(|key| row.get(key).is_some()), "{row}");
        assert_eq!((row["status"].as_str(), row["pass"].as_bool()), (Some("pass"), Some(true)), "{row}");
        assert!(row["samples"].as_u64().unwrap() >= 6 && row["seconds"].as_f64().unwrap() > 0.0);
        let (reference, computed) = (row["reference"].as_f64().unwrap(), row["computed"].as_f64().unwrap());
        let error = row["relative_error"].as_f64().unwrap();
        assert!((error - (computed / reference - 1.0)).abs() <= 1e-12);
        assert!(error.abs() <= row["tolerance"].as_f64().unwrap());
    }
    assert_eq!(found["passed"].as_u64(), Some(rows.len() as u64));
}

#[test]
fn no_case_fails_and_few_are_skipped() {
    let output = verify(&["--json"]);
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stdout));
    let found = json(&output);
    for row in found["cases"].as_array().unwrap() {
        let name = row["name"].as_str().unwrap();
        let expected = match name {
            _ if name.starts_with("furnace.sphere") => "skipped",
            _ if name.starts_with("cie-171.4") || name.ends_with(".cie") => "informative",
            _ => "pass",
        };
        assert_eq!(row["status"], expected, "{row}");
        assert_eq!(row["pass"].as_bool(), (expected == "pass").then_some(true), "{row}");
        assert_eq!(row["reason"].is_string(), expected != "pass", "{row}");
    }
    let count = |key: &str| found[key].as_u64().unwrap();
    let all = count("passed") + count("failed") + count("skipped") + count("informative");
    assert_eq!(all, found["cases"].as_array().unwrap().len() as u64);
}

/// Photometric files of isotropic lamps give what the isotropic stand-ins give, but now the measured limits decide.
#[test]
fn photometry_from_files_is_judged() {
    let folder = scratch("photometry");
    for (number, lumens) in (1..).zip([2182.0, 2196.0, 2203.0, 2182.0]) {
        let lamp = LuminousIntensity::isotropic(lumens / (4.0 * core::f64::consts::PI)).unwrap();
        let text = PhotometricFile::new(lamp, "isotropic").to_ies();
        std::fs::write(folder.join(format!("cfl-{number}.ies")), text).unwrap();
    }
    let rows = |arguments: &[&str]| {
        let output = verify(&[&["cie-171.4.4", "cie-171.4.5.mean", "--json"], arguments].concat());
        (output.status.code(), json(&output)["cases"].as_array().unwrap().clone())
    };
    let (code, stand_in) = rows(&[]);
    assert_eq!(code, Some(0));
    let (code, from_files) = rows(&["--photometry", folder.to_str().unwrap()]);
    let mut judged = 0;
    for (file, stand_in) in from_files.iter().zip(&stand_in) {
        let name = file["name"].as_str().unwrap();
        let decides = name.starts_with("cie-171.4.4") && !name.ends_with(".measurement");
        assert_eq!(file["pass"].is_boolean(), decides, "{file}");
        assert_eq!(stand_in["status"], "informative");
        judged += usize::from(decides);
        let [a, b] = [file, stand_in].map(|row| row["computed"].as_f64().unwrap());
        assert!((a / b - 1.0).abs() <= 2e-3, "{name}: {a} {b}");
    }
    assert_eq!(judged, 1 + 49);
    assert_eq!(code, Some(i32::from(from_files.iter().any(|row| row["pass"] == false))));
    let refused = |folder: &std::path::Path, part: &str| {
        let output = verify(&["cie-171.4.4", "--photometry", folder.to_str().unwrap()]);
        let said = String::from_utf8(output.stderr).unwrap();
        assert!(output.status.code() == Some(2) && said.lines().count() == 1 && said.contains(part), "{said}");
    };
    refused(&folder.join("none"), "no such folder");
    std::fs::write(folder.join("cfl-3.ies"), "IESNA:LM-63-2002\nTILT=NONE\nnothing\n").unwrap();
    refused(&folder, "cfl-3.ies:3");
    std::fs::remove_file(folder.join("cfl-3.ies")).unwrap();
    refused(&folder, "cfl-3.ies or .ldt is missing");
    for number in [1, 2, 4] {
        std::fs::remove_file(folder.join(format!("cfl-{number}.ies"))).unwrap();
    }
    refused(&folder, "no photometric files");
}

#[test]
fn single_checks_and_groups_are_selected() {
    let names = |arguments: &[&str]| -> Vec<String> {
        let found = json(&verify(&[arguments, &["--json"]].concat()));
        found["cases"].as_array().unwrap().iter().map(|row| row["name"].as_str().unwrap().to_owned()).collect()
    };
    assert_eq!(names(&["disk.table-2.2.hexagon-96"]), ["disk.table-2.2.hexagon-96"]);
    assert_eq!(names(&["cie-171.5.6.1.A"]), ["cie-171.5.6.1.A", "cie-171.5.6.1.A.printed"]);
    assert_eq!(names(&["--list", "point.cosine", "flux"]), ["point.cosine", "flux.black-room"]);
    let unknown = verify(&["cie-172"]);
    assert_eq!(unknown.status.code(), Some(2));
    let said = String::from_utf8_lossy(&unknown.stderr).into_owned();
    assert_eq!(said, "spectral: no case is named \"cie-172\" or begins so (spectral verify --list)\n");
}

/// Answers with every reference of the recomputed kind, times a factor, in the form that `--score` takes.
fn perfect(factor: f64) -> String {
    let mut text = String::from("case,point,value\n");
    for case in cases(None).iter().filter(|case| case.work == Work::Direct) {
        for (index, point) in case.points.iter().enumerate() {
            let own = |reduction: &Reduction| match reduction {
                Reduction::Point { index: own, scale } if *own == index => Some(*scale),
                _ => None,
            };
            let found = case.checks.iter().find_map(|check| Some(check.reference / own(&check.reduction)?));
            if let Some(value) = found {
                text += &format!("{},{},{}\n", case.name, point.name, value * factor);
            }
        }
    }
    text
}

#[test]
fn answers_of_others_are_scored() {
    let folder = scratch("score");
    let file = folder.join("results.csv");
    let path = file.to_str().unwrap();
    std::fs::write(&file, perfect(1.0)).unwrap();
    let good = verify(&["--score", path, "--json"]);
    assert_eq!(good.status.code(), Some(0), "{}", String::from_utf8_lossy(&good.stdout));
    let found = json(&good);
    let rows = found["cases"].as_array().unwrap();
    assert!(found["passed"].as_u64().unwrap() > 150 && found["failed"].as_u64() == Some(0));
    // What has no answer is neither passed nor failed.
    let skipped: Vec<_> = rows.iter().filter(|row| row["status"] == "skipped").collect();
    assert_eq!(Some(skipped.len() as u64), found["skipped"].as_u64());
    assert!(skipped.iter().all(|row| row["pass"].is_null() && row["computed"].is_null() && row["reason"].is_string()));
    assert!(skipped.iter().any(|row| row["name"] == "cie-171.5.6.1.A"));
    assert!(skipped.iter().any(|row| row["name"] == "disk.table-2.1.hexagon-96"));

    std::fs::write(&file, perfect(1.01)).unwrap();
    let bad = verify(&["--score", path, "area", "point", "disk-light"]);
    assert_eq!(bad.status.code(), Some(1));
    assert!(String::from_utf8_lossy(&bad.stdout).contains("FAIL"));
}

#[test]
fn bad_answers_are_refused_with_their_line() {
    let folder = scratch("refused");
    let file = folder.join("results.csv");
    for (text, expected) in [
        ("case,point,value\npoint.cosine,0\n", "results.csv:2: case,point,value expected, but there are 2 cells"),
        ("point.cosine,0,1\npoint.cosine,7,1\n", "results.csv:2: the case has no point \"7\""),
        ("point.cosine,0,inf\n", "results.csv:1: \"inf\" is not a finite number"),
        ("", "results.csv: no answers"),
    ] {
        std::fs::write(&file, text).unwrap();
        let output = verify(&["--score", file.to_str().unwrap()]);
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(output.status.code() == Some(2) && output.stdout.is_empty(), "{text:?}: {said}");
        assert!(said.contains(expected) && said.lines().count() == 1, "{text:?}: {said}");
    }
    let missing = verify(&["--score", folder.join("none.csv").to_str().unwrap()]);
    assert_eq!(missing.status.code(), Some(2));
}

#[test]
fn cases_are_exported_for_others() {
    let folder = scratch("export");
    let output = verify(&["--export", folder.to_str().unwrap(), "--json"]);
    assert_eq!(output.status.code(), Some(0));
    let files = json(&output)["files"].as_array().unwrap().len();
    let scenes: Vec<_> = cases(None).into_iter().filter(|case| case.work.is_scene()).collect();
    let mut count = 2;
    for case in &scenes {
        let own = folder.join(&case.name);
        let points = std::fs::read_to_string(own.join("points.txt")).unwrap();
        assert_eq!(points.lines().count(), case.points.len());
        for (line, point) in points.lines().zip(&case.points) {
            let numbers: Vec<f64> = line.split(' ').map(|number| number.parse().unwrap()).collect();
            assert_eq!(numbers, [point.position, point.normal].concat());
        }
        let xml = std::fs::read_to_string(own.join("scene.xml")).unwrap();
        assert_eq!((xml.matches("radiancemeter").count(), xml.matches("$place").count()), (1, 2));
        let places = std::fs::read_to_string(own.join("places.txt")).unwrap();
        assert_eq!(places.lines().count(), case.points.len());
        // Radiance's lights don't reflect: the furnace is not for it.
        assert_eq!(own.join("scene.rad").exists(), !case.name.starts_with("furnace"));
        count += if own.join("scene.rad").exists() { 4 } else { 3 };
    }
    assert_eq!(files, count);
    let readme = std::fs::read_to_string(folder.join("README.md")).unwrap();
    assert!(scenes.iter().all(|case| readme.contains(&format!("`{}`", case.name))));
    let all = std::fs::read_to_string(folder.join("points.csv")).unwrap();
    assert_eq!(all.lines().count(), 1 + scenes.iter().map(|case| case.points.len()).sum::<usize>());
}
