//! `spectral light`: what it answers, and the files that it refuses.
#![allow(clippy::unwrap_used, clippy::cast_sign_loss, clippy::cast_possible_truncation, reason = "helpers of tests")]

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use renderers::light::{LightReport, parse_csv, parse_spdx, report};
use serde_json::Value;
use spectral_core::tables::{find_light, lights};
use spectral_tests::program;

fn spectral(arguments: &[&str]) -> Output {
    Command::new(program::spectral(env!("CARGO_TARGET_TMPDIR"))).args(arguments).output().unwrap()
}

fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("light_command").join(name);
    std::fs::create_dir_all(&folder).unwrap();
    folder
}

fn csv_of(name: &str, separator: &str, decimal: &str) -> String {
    let table = find_light(name).unwrap();
    let mut text = format!("# a comment\nwavelength{separator}power\n\n");
    for (index, power) in table.samples.double.iter().enumerate() {
        let wavelength = usize::from(table.first) + usize::from(table.step) * index;
        text += &format!("{wavelength}{separator}{power} # nm\n").replace('.', decimal);
    }
    text
}

fn spdx_of(name: &str) -> String {
    let table = find_light(name).unwrap();
    let mut text = "<?xml version=\"1.0\"?>\n<IESTM2714 xmlns=\"http://www.ies.org/iestm2714\" version=\"1.0\">\n\
                    <Header><Description>lamp</Description></Header>\n<SpectralDistribution>\n\
                    <SpectralQuantity>relative</SpectralQuantity>\n"
        .to_owned();
    for (index, power) in table.samples.double.iter().enumerate() {
        let wavelength = usize::from(table.first) + usize::from(table.step) * index;
        text += &format!("<SpectralData wavelength=\"{wavelength}\">{power}</SpectralData>\n");
    }
    text + "</SpectralDistribution>\n</IESTM2714>\n"
}

fn report_of(text: &str) -> LightReport {
    let table = if text.starts_with('<') { parse_spdx("f", text) } else { parse_csv("f", text) };
    report("f", &table.unwrap()).unwrap()
}

#[test]
fn every_form_of_a_file_gives_the_same_report() {
    let plain = report_of(&csv_of("FL2", ",", "."));
    assert!((plain.ra.unwrap() - 64.158).abs() <= 5e-4);
    assert_eq!(plain.grid.step, 5);
    for text in [
        csv_of("FL2", ";", "."),
        csv_of("FL2", ";", ","),
        csv_of("FL2", "\t", "."),
        csv_of("FL2", "\t", ","),
        csv_of("FL2", "  ", "."),
        csv_of("FL2", " , ", "."),
        csv_of("FL2", ",", ".").replace('\n', "\r\n"),
        spdx_of("FL2"),
    ] {
        assert_eq!(report_of(&text), plain, "{}", &text[..60]);
    }
}

#[test]
fn other_steps_are_brought_to_one_nanometre() {
    let flat = |step: f64, last: f64| {
        let count = (last - 380.0) / step;
        (0..=count.round() as u32).map(|i| format!("{},1\n", 380.0 + step * f64::from(i))).collect::<String>()
    };
    let reference = report_of(&flat(1.0, 780.0));
    assert_eq!((reference.grid.step, reference.grid.from), (1, "the table's own samples"));
    for (step, from) in [(2.0, "linear interpolation"), (10.0, "linear interpolation"), (2.5, "linear interpolation")] {
        let found = report_of(&flat(step, 780.0));
        assert_eq!((found.grid.step, found.grid.from), (1, from));
        assert!((found.ra.unwrap() - reference.ra.unwrap()).abs() <= 1e-10, "{step} nm");
    }
    // Finer tables are averaged; at the ends half a nanometre is missing.
    let fine = report_of(&flat(0.25, 780.0));
    assert_eq!(fine.grid.from, "means over 1 nm of a finer table");
    assert!((fine.ra.unwrap() - reference.ra.unwrap()).abs() <= 1e-3);
    assert!((fine.power - 400.0).abs() <= 1e-9, "the mean keeps the power: {}", fine.power);
}

/// A narrow line between the nanometres keeps its power when the table is fine.
#[test]
fn a_fine_line_keeps_its_power() {
    let found = report_of("380,0\n546.2,0\n546.3,10\n546.4,0\n780,0\n");
    assert!((found.power - 1.0).abs() <= 1e-9, "{}", found.power);
    assert_eq!(found.cct_status, "far-from-locus");
}

/// A file, the line to be named (0: none), and a part of the message.
const BAD: [(&str, u32, &str); 21] = [
    ("", 1, "no samples"),
    ("# only a comment\n", 1, "no samples"),
    ("nm,power\n", 1, "no samples"),
    ("500,1\n", 1, "at least two"),
    ("500,1\n490,1\n", 2, "not above the one before"),
    ("500,1\n500,1\n", 2, "there twice"),
    ("nm,power\n500,1\n\n510,nan\n", 4, "power is not finite"),
    ("500,1\n510,inf\n", 2, "power is not finite"),
    ("500,1\nNaN,1\n", 2, "wavelength is not finite"),
    ("500,1\n510,-1e-9\n", 2, "negative"),
    ("-5,1\n510,1\n", 1, "not positive"),
    ("500,1\n510\n", 2, "1 columns"),
    ("500,1,2\n510,1,2\n", 1, "3 columns"),
    ("nm,power\nagain,power\n500,1\n", 2, "not a number"),
    ("500,one\n510,1\n", 1, "not a number"),
    ("# infrared\n900,1\n910,1\n", 2, "misses the visible range"),
    ("0.5,1\n0.6,1\n", 1, "misses the visible range"),
    ("<a>\n<b>\n</a>", 3, "expected 'b' tag"),
    ("<IESTM2714/>", 1, "<SpectralDistribution>"),
    ("<a><SpectralDistribution>\n<SpectralData>1</SpectralData></SpectralDistribution></a>", 2, "no wavelength"),
    (
        "<a><SpectralDistribution>\n<SpectralQuantity>reflectance</SpectralQuantity></SpectralDistribution></a>",
        2,
        "not that of a light",
    ),
];

#[test]
fn bad_files_are_refused_with_their_line() {
    for (text, line, part) in BAD {
        let error = if text.starts_with('<') { parse_spdx("lamp.csv", text) } else { parse_csv("lamp.csv", text) };
        let error = error.expect_err(text);
        let shown = error.to_string();
        assert_eq!(error.line, line, "{shown}");
        assert!(shown.contains(part), "{shown}");
        assert!(shown.starts_with(&format!("lamp.csv:{line}: ")) && !shown.contains('\n'), "{shown}");
    }
}

#[test]
fn a_dark_light_is_refused() {
    let table = parse_csv("f", "400,0\n700,0\n").unwrap();
    assert!(report("f", &table).is_err());
}

/// Keys that programs rely on.
const KEYS: [&str; 17] = [
    "cct",
    "duv",
    "xy",
    "luminous_efficacy",
    "ra",
    "r",
    "r96a_c",
    "r96a_tcc_lab",
    "cri00_munsell",
    "cri00_munsell_i",
    "cri00_colorchecker",
    "cri00_colorchecker_i",
    "acv",
    "sy",
    "melanopic_der",
    "rf",
    "rg",
];

#[test]
fn every_built_in_light_has_a_report_with_all_keys() {
    for table in lights() {
        let found = report(table.name, &table.into()).unwrap();
        let json = serde_json::to_value(&found).unwrap();
        for key in KEYS {
            assert!(json.get(key).is_some(), "{}: {key}", table.name);
        }
        assert!(found.rf.is_some_and(|rf| rf > 0.0 && rf <= 100.001), "{}: {:?}", table.name, found.rf);
    }
}

#[test]
fn the_program_answers_and_refuses() {
    let output = spectral(&["light", "FL2", "--json"]);
    assert!(output.status.success());
    let json: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert!((json["ra"].as_f64().unwrap() - 64.158).abs() <= 5e-4);
    assert_eq!(json["r"].as_array().unwrap().len(), 14);
    assert_eq!(json["cri00_colorchecker_i"].as_array().unwrap().len(), 10);

    let list = spectral(&["light", "--list"]);
    assert!(String::from_utf8(list.stdout).unwrap().contains("FL3.15"));

    let folder = folder("program");
    let (sheet, bad) = (folder.join("fl11.png"), folder.join("bad.csv"));
    let drawn = spectral(&["light", "FL11", "--plot", sheet.to_str().unwrap()]);
    assert!(drawn.status.success());
    assert!(std::fs::read(&sheet).unwrap().starts_with(b"\x89PNG"));

    std::fs::write(&bad, "400,1\n390,1\n").unwrap();
    let shown = bad.to_str().unwrap();
    for (arguments, part) in [
        (vec!["light", shown], ":2: the wavelength 390 nm is not above"),
        (vec!["light", "no-such-light"], "no built-in light"),
        (vec!["light"], "required"),
        (vec!["light", folder.to_str().unwrap()], "directory"),
    ] {
        let output = spectral(&arguments);
        let message = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {message}");
        assert!(message.contains(part), "{message}");
        assert!(output.stdout.is_empty());
    }
}
