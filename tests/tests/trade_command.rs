//! `spectral trade` as a program and as a library: what it says, that it goes on where it was, and that its checks can fail.
#![allow(clippy::unwrap_used, clippy::expect_used, reason = "tests stop at the first thing that should not be")]

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use proptest::prelude::*;
use renderers::trade::stability::{Domain, Sweep};
use renderers::trade::{families, pareto_front};
use serde_json::{Value, json};
use spectral_tests::program::spectral;

fn trade(folder: &Path, arguments: &[&str]) -> Output {
    let program = spectral(env!("CARGO_TARGET_TMPDIR"));
    let mut command = Command::new(program);
    command.args(["trade", "--quick", "--out"]).arg(folder).args(arguments);
    command.output().expect("the program runs")
}

fn account(folder: &Path, arguments: &[&str]) -> Value {
    let output = trade(folder, &[arguments, &["--json"]].concat());
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).expect("one JSON object")
}

fn scratch(name: &str) -> PathBuf {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("trade_command").join(name);
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).unwrap();
    folder
}

fn read(path: &Path) -> Value {
    serde_json::from_slice(&fs::read(path).unwrap()).unwrap()
}

fn write(path: &Path, value: &Value) {
    fs::write(path, value.to_string()).unwrap();
}

/// By the definition: nobody is at most as large in both and less in one.
fn naive_front(pairs: &[[f64; 2]]) -> Vec<bool> {
    let beaten = |p: &[f64; 2]| pairs.iter().any(|q| q[0] <= p[0] && q[1] <= p[1] && q != p);
    pairs.iter().map(|p| p.iter().all(|v| !v.is_nan()) && !beaten(p)).collect()
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 2000, failure_persistence: None, ..ProptestConfig::default() })]

    /// Few different numbers, so that many pairs tie.
    #[test]
    fn fronts_are_those_of_the_definition(pairs in prop::collection::vec((0..6_i32, -3..4_i32, 0..12_u32), 0..24)) {
        let number = |(cost, error, kind): (i32, i32, u32)| match kind {
            0 => [f64::NAN, f64::from(error)],
            1 => [f64::from(cost), f64::NAN],
            2 => [f64::INFINITY, f64::from(error)],
            3 => [-0.0, f64::from(error)],
            _ => [f64::from(cost), f64::from(error)],
        };
        let pairs: Vec<[f64; 2]> = pairs.into_iter().map(number).collect();
        prop_assert_eq!(pareto_front(&pairs), naive_front(&pairs));
    }

    /// The front falls all along, and everything is met by it.
    #[test]
    fn fronts_cover_everything(pairs in prop::collection::vec((0.0..1.0_f64, 0.0..1.0_f64), 1..40)) {
        let pairs: Vec<[f64; 2]> = pairs.into_iter().map(|(a, b)| [a, b]).collect();
        let flags = pareto_front(&pairs);
        let mut front: Vec<[f64; 2]> = pairs.iter().zip(&flags).filter(|(_, on)| **on).map(|(p, _)| *p).collect();
        front.sort_by(|a, b| a[0].total_cmp(&b[0]));
        prop_assert!(!front.is_empty());
        prop_assert!(front.windows(2).all(|w| w[0] == w[1] || w[0][1] > w[1][1]));
        prop_assert!(pairs.iter().all(|p| front.iter().any(|f| f[0] <= p[0] && f[1] <= p[1])));
    }
}

#[test]
fn families_are_listed_for_who_asks_for_another() {
    let output = trade(&scratch("unknown"), &["disk", "discs"]);
    let said = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(2));
    assert!(said.lines().count() == 1 && said.contains("\"discs\""), "{said}");
    assert!(families().iter().all(|family| said.contains(family.name)) && said.contains("stability"), "{said}");
}

#[test]
fn a_folder_that_cannot_be_made_is_refused() {
    let file = scratch("file").join("plain");
    fs::write(&file, "").unwrap();
    let output = trade(&file, &["brdf"]);
    let said = String::from_utf8(output.stderr).unwrap();
    assert!(output.status.code() == Some(2) && said.lines().count() == 1 && said.contains("plain"), "{said}");
}

/// One family alone, as an account that was interrupted after it; then, with a round of it missing, the rest.
#[test]
fn an_account_goes_on_where_it_was() {
    let folder = scratch("resumed");
    let first = account(&folder, &["brdf"]);
    check_curves(&first, &["brdf.balanced"]);
    check_csv(&folder.join("brdf.csv"), &first["curves"][0]);
    assert_eq!(first["reused"], json!([]));

    let kept = folder.join("runs/brdf.balanced.quick.json");
    let whole = read(&kept);
    let mut cut = whole.clone();
    for runs in cut["runs"].as_object_mut().unwrap().values_mut() {
        runs.as_array_mut().unwrap().pop();
    }
    cut["rounds"] = json!(whole["rounds"].as_u64().unwrap() - 1);
    write(&kept, &cut);
    let second = account(&folder, &["precision", "brdf"]);
    let names = ["brdf.balanced", "precision.products", "precision.indices", "precision.closed-forms"];
    check_curves(&second, &names);
    assert_eq!(second["reused"], json!([]));
    let mended = read(&kept);
    assert_eq!(mended["rounds"], whole["rounds"]);
    for (setting, runs) in cut["runs"].as_object().unwrap() {
        let (old, new) = (runs.as_array().unwrap(), mended["runs"][setting].as_array().unwrap());
        assert!(new.len() == old.len() + 1 && new.starts_with(old), "{setting}");
    }

    let third = account(&folder, &["brdf", "precision"]);
    assert_eq!(third["reused"], json!(names));
    assert_eq!(third["curves"], second["curves"]);
    let fresh = account(&folder, &["brdf", "--fresh"]);
    assert_eq!(fresh["reused"], json!([]));
    assert_ne!(fresh["curves"][0]["points"], third["curves"][0]["points"]);

    for file in fs::read_dir(&folder).unwrap() {
        let name = file.unwrap().file_name().into_string().unwrap();
        assert!(!name.contains(".part"), "{name} was left behind");
    }
}

fn check_curves(account: &Value, names: &[&str]) {
    let curves = account["curves"].as_array().unwrap();
    assert_eq!(curves.iter().map(|c| c["name"].as_str().unwrap()).collect::<Vec<_>>(), names);
    for curve in curves {
        let points = curve["points"].as_array().unwrap();
        let of = |point: &Value, key: &str| point[key].as_f64().unwrap_or(f64::NAN);
        let floor = curve["floor"].as_f64().unwrap();
        for (cost, flag) in [("seconds", "front_seconds"), ("operations", "front_operations")] {
            let pairs: Vec<[f64; 2]> = points.iter().map(|p| [of(p, cost), of(p, "error").max(floor)]).collect();
            assert!(pairs.iter().all(|p| p[0] > 0.0 && p[1].is_finite()), "{curve}");
            let flags: Vec<bool> = points.iter().map(|p| p[flag].as_bool().unwrap()).collect();
            assert_eq!(flags, naive_front(&pairs), "{}", curve["name"]);
        }
        for point in points {
            assert!(
                point["setting"].is_string() && of(point, "error") <= of(point, "worst") * (1.0 + 1e-12),
                "{point}"
            );
        }
        check_order_of_measures(curve);
    }
    let files = account["files"].as_array().unwrap();
    assert!(files.iter().all(|f| fs::metadata(f.as_str().unwrap()).unwrap().len() > 0));
    assert!(files.iter().any(|f| f.as_str().unwrap().ends_with("index.html")));
}

/// Pairs that are said to have another order by counted work have it.
fn check_order_of_measures(curve: &Value) {
    let points = curve["points"].as_array().unwrap();
    let find = |name: &Value| points.iter().find(|p| p["setting"] == *name).unwrap();
    let mut reversed = 0;
    for fast in points {
        for slow in points {
            let apart = fast["seconds_spread"][1].as_f64() < slow["seconds_spread"][0].as_f64();
            reversed += usize::from(apart && fast["operations"].as_f64() > slow["operations"].as_f64());
        }
    }
    let said = curve["agreement"]["reversed"].as_array().unwrap();
    assert_eq!(said.len(), reversed);
    for pair in said {
        let [fast, slow] = [find(&pair[0]), find(&pair[1])];
        assert!(fast["seconds"].as_f64() < slow["seconds"].as_f64(), "{pair}");
    }
}

fn check_csv(path: &Path, curve: &Value) {
    let text = fs::read_to_string(path).unwrap();
    let mut lines = text.lines();
    let headings: Vec<&str> = lines.next().unwrap().split(',').collect();
    let column = |name: &str| headings.iter().position(|h| *h == name).unwrap();
    let points = curve["points"].as_array().unwrap();
    assert_eq!(lines.clone().count(), points.len());
    for (line, point) in lines.zip(points) {
        // No setting of this family needs quotes.
        let fields: Vec<&str> = line.split(',').collect();
        assert_eq!(fields.len(), headings.len(), "{line}");
        assert_eq!(fields[column("setting")], point["setting"].as_str().unwrap());
        for name in ["seconds", "operations", "error", "worst"] {
            assert_eq!(fields[column(name)].parse::<f64>().unwrap(), point[name].as_f64().unwrap(), "{line}");
        }
        assert_eq!(fields[column("front_seconds")] == "true", point["front_seconds"].as_bool().unwrap());
    }
}

/// Nothing leaves its documented domain; a number that does, put among what is kept, makes the program fail.
#[test]
fn sweeps_pass_and_sabotage_fails() {
    let folder = scratch("stability");
    let found = account(&folder, &["--stability"]);
    let sweeps = found["stability"].as_array().unwrap();
    assert!(sweeps.iter().filter(|s| s["pass"] == true).count() >= 30, "{}", sweeps.len());
    for axis in ["radiance", "distance", "grazing", "width of a line", "roughness", "absorb"] {
        assert!(sweeps.iter().any(|s| s["name"].as_str().unwrap().contains(axis)), "{axis}");
    }
    let kept = folder.join("runs/stability.quick.json");
    let mut sabotaged = read(&kept);
    let parts = sabotaged["parts"].as_array_mut().unwrap();
    let sweeps = parts.iter_mut().flat_map(|part| part[1].as_array_mut().unwrap());
    let sweep = sweeps.into_iter().find(|s| s["name"] == "disk on its axis over distance" && s["precision"] == "f64");
    let points = sweep.unwrap()["points"].as_array_mut().unwrap();
    let point = points.iter_mut().find(|p| (p[0].as_f64().unwrap() - 1.0).abs() <= 1e-9).unwrap();
    point[1] = json!(2e-12);
    write(&kept, &sabotaged);
    let output = trade(&folder, &["stability"]);
    let said = String::from_utf8(output.stdout).unwrap();
    assert_eq!(output.status.code(), Some(1), "{said}");
    let failed: Vec<&str> = said.lines().filter(|line| line.ends_with("FAIL")).collect();
    assert!(failed.len() == 1 && failed[0].starts_with("disk on its axis over distance"), "{said}");
}

#[test]
fn sweeps_judge_what_is_documented() {
    let places: Vec<f64> = (-6..=6).map(|k| 10.0_f64.powi(k)).collect();
    let sweep = |range: Option<[f64; 2]>, error: &dyn Fn(f64) -> Option<f64>| {
        let domain = range.map(|range| Domain { range, tolerance: 1e-9, source: "a test".to_owned() });
        Sweep::new(["test", "f64", "place", "error"], domain, &places, error)
    };
    let growing = |x: f64| Some(1e-12 * x * x);
    let within = sweep(Some([1e-3, 10.0]), &growing);
    assert_eq!((within.pass, within.reach), (Some(true), Some([1e-6, 10.0])));
    assert_eq!(sweep(Some([1e-3, 100.0]), &growing).pass, Some(false));
    assert_eq!(sweep(None, &growing).pass, None);
    // What isn't a number, is infinite, or was never looked at is wrong.
    assert_eq!(sweep(Some([1e-3, 10.0]), &|x| Some(if x == 1.0 { f64::NAN } else { 0.0 })).pass, Some(false));
    assert_eq!(sweep(Some([1e-3, 10.0]), &|_| Some(f64::INFINITY)).pass, Some(false));
    assert_eq!(sweep(Some([1e-3, 10.0]), &|_| None).pass, Some(false));
    // A refused place is no error; its neighbours count.
    assert_eq!(sweep(Some([1e-3, 10.0]), &|x| (x > 1e-2).then_some(0.0)).pass, Some(true));
}
