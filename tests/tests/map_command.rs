//! `spectral map`, and `spectral render --spectral-exr --hdr`: what they answer, what they refuse, and what they leave behind.
#![allow(clippy::unwrap_used, reason = "helpers of tests fail by panicking")]

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use renderers::image::{read_channels, read_exr, read_hdr, read_png, read_spectral_exr};
use serde_json::Value;
use spectral_tests::program;

fn folder(name: &str) -> PathBuf {
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join("map_command").join(name);
    let _ = fs::remove_dir_all(&path);
    fs::create_dir_all(&path).unwrap();
    path
}

fn run(arguments: &[&str]) -> Output {
    Command::new(program::spectral(env!("CARGO_TARGET_TMPDIR"))).args(arguments).output().unwrap()
}

fn json(arguments: &[&str]) -> Value {
    let output = run(&[arguments, &["--json"]].concat());
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}

/// Exit code 2 and one line on stderr, nothing on stdout.
fn refused(arguments: &[&str]) -> String {
    let output = run(arguments);
    let said = String::from_utf8(output.stderr).unwrap();
    assert_eq!(
        (output.status.code(), output.stdout.len(), said.lines().count()),
        (Some(2), 0, 1),
        "{arguments:?}: {said}"
    );
    said
}

fn names(folder: &Path) -> Vec<String> {
    let mut names: Vec<_> =
        fs::read_dir(folder).unwrap().map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

#[test]
fn answers_with_numbers_and_files() {
    let folder = folder("answers");
    let out = folder.to_str().unwrap();
    let answer = json(&[
        "map",
        "cornell-box-lamp",
        "--quantity",
        "ra,cct",
        "--quantity",
        "illuminance,ra",
        "--size",
        "40x30",
        "--out",
        out,
    ]);
    assert_eq!(answer["quantity"], "ra");
    assert_eq!(answer["maps"].as_array().unwrap().len(), 3);
    for map in answer["maps"].as_array().unwrap() {
        let [min, mean, max, median] = ["min", "mean", "max", "median"].map(|key| map[key].as_f64().unwrap());
        assert!(min <= mean && mean <= max && min <= median && median <= max, "{map}");
        assert!((0.0..1.0).contains(&map["share_without_value"].as_f64().unwrap()));
    }
    for key in ["min", "max", "mean", "median", "unit", "of", "seconds", "renderer", "step"] {
        assert!(!answer[key].is_null(), "{key}");
    }
    let files: Vec<&str> = answer["files"].as_array().unwrap().iter().map(|f| f.as_str().unwrap()).collect();
    assert_eq!(files.len(), 4);
    assert_eq!(names(&folder).len(), 4);
    // The picture is magnified and has a legend.
    let picture = read_png(Path::new(files[0])).unwrap();
    assert!(picture.width() > 40 && picture.height() > 30);
    // The lamp lights itself not at all: no colour there.
    let values = read_channels(Path::new(files[3])).unwrap();
    assert_eq!(values.size, [40, 30]);
    let channels: Vec<_> = values.channels.iter().map(|(name, _)| name.as_str()).collect();
    assert_eq!(channels, ["cct", "illuminance", "ra"]);
    let ra = &values.channels[2].1;
    let missing = ra.pixels().iter().filter(|value| value.is_nan()).count();
    let share = answer["share_without_value"].as_f64().unwrap();
    assert!(
        missing > 0 && (share * 1200.0 - f64::from(u32::try_from(missing).unwrap())).abs() <= 1e-9,
        "{missing} {share}"
    );
}

#[test]
fn bad_input_is_refused_in_one_line() {
    let folder = folder("refused");
    let out = folder.join("out");
    let empty = folder.join("empty.xml");
    fs::write(
        &empty,
        "<scene version='3.0.0'><integrator type='direct'/><sensor type='perspective'><float name='fov' value='40'/></sensor>
        <emitter type='point'><spectrum name='intensity' value='1'/></emitter></scene>",
    )
    .unwrap();
    let broken = folder.join("broken.exr");
    fs::write(&broken, b"\x76\x2f\x31\x01nonsense").unwrap();
    let (empty, broken) = (empty.to_str().unwrap(), broken.to_str().unwrap());
    for (arguments, said) in [
        (
            &["cri-room", "--quantity", "lumen"][..],
            "one of illuminance, luminance, cct, duv, ra, cri00, acv, sy, melanopic",
        ),
        (&["cri-room", "--quantity", "ra,,cct"], "no such quantity"),
        (&["cri-room"], "--quantity <QUANTITY>"),
        (&["--quantity", "ra"], "required"),
        (&[empty, "--quantity", "ra"], "the scene has no surfaces, so that there is nothing to map"),
        (&["nowhere.xml", "--quantity", "ra"], "nowhere.xml"),
        (&["cri-room", "--quantity", "illuminance", "--of", "radiance"], "illuminance is not a quantity of radiance"),
        (&["cri-room", "--quantity", "ra,cct", "--range", "0:100"], "--range is for one quantity"),
        (&["cri-room", "--quantity", "ra", "--range", "100:0"], "expected LO:HI"),
        (&["cri-room", "--quantity", "ra", "--range", "nan:1"], "expected LO:HI"),
        (&["cri-room", "--quantity", "ra", "--range", "0:100", "--log"], "--log needs a --range above 0"),
        (&["cri-room", "--quantity", "duv", "--log"], "--log is not for duv"),
        (&["cri-room", "--quantity", "ra", "--spp", "0"], "--spp must be from 1"),
        (&["cri-room", "--quantity", "ra", "--step", "2"], "invalid value '2' for '--step <NM>'"),
        (&["cri-room", "--quantity", "ra", "--renderer", "path"], "possible values: whitted, radiosity"),
        (&["cri-room", "--quantity", "ra", "--renderer", "whitted", "--exact"], "are for light between surfaces"),
        (&["cri-room", "--from", broken, "--quantity", "ra"], "cannot be used with"),
        (&["--from", broken, "--quantity", "ra"], "broken.exr"),
        (&["--from", "nowhere.exr", "--quantity", "ra"], "nowhere.exr"),
    ] {
        let all = [&["map"], arguments, &["--size", "8x8", "--out", out.to_str().unwrap()]].concat();
        let all = if arguments.contains(&"--from") {
            [&["map"], arguments, &["--out", out.to_str().unwrap()]].concat()
        } else {
            all
        };
        let line = refused(&all);
        assert!(line.contains(said), "{arguments:?}: {line}");
        assert!(!out.exists(), "{arguments:?} left a folder");
    }
    for (arguments, said) in [
        (&["--spectral-exr", "7nm"][..], "expected a step that divides 400 nm"),
        (&["--spectral-exr", "0"], "expected a step that divides 400 nm"),
        (&["--spectral-exr", "--renderer", "path"], "--spectral-exr is not for --renderer path"),
    ] {
        let line = refused(&[&["render", "--size", "8x8"], arguments].concat());
        assert!(line.contains(said), "{arguments:?}: {line}");
    }
}

/// What is rendered is mapped from the file as from the scene; the preview is the picture.
#[test]
fn stored_spectra_give_the_scene_s_map() {
    let folder = folder("stored");
    let out = folder.to_str().unwrap();
    let common = ["cornell-box-lamp", "--size", "24x24", "--out", out];
    let rendered = json(&[&["render", "--spectral-exr", "1nm", "--hdr", "--spp", "1"], &common[..]].concat());
    let file = |suffix: &str| {
        let files = rendered["files"].as_array().unwrap().iter().map(|f| f.as_str().unwrap());
        files.filter(|f| f.ends_with(suffix)).map(PathBuf::from).next().unwrap()
    };
    let stored = read_spectral_exr(&file("-spectral.exr")).unwrap();
    assert_eq!(stored.picture.wavelengths().len(), 401);
    assert_eq!(stored.preview.unwrap(), read_exr(&file("interval.exr")).unwrap().picture);
    let (hdr, picture) = (read_hdr(&file(".hdr")).unwrap(), read_exr(&file("interval.exr")).unwrap().picture);
    for (a, b) in hdr.pixels().iter().zip(picture.pixels()) {
        let largest = b.iter().copied().fold(0.0, f32::max);
        assert!(a.iter().zip(b).all(|(a, b)| (a - b.max(0.0)).abs() <= largest / 128.0));
    }
    let spectral = file("-spectral.exr");
    let from = json(&["map", "--from", spectral.to_str().unwrap(), "--quantity", "cct,luminance", "--out", out]);
    let of = json(
        &[&["map", "--quantity", "cct,luminance", "--of", "radiance", "--spp", "1", "--step", "1"], &common[..]]
            .concat(),
    );
    // Pixels at edges see other places through the scene's own filter.
    for index in 0..2 {
        let median = |answer: &Value| answer["maps"][index]["median"].as_f64().unwrap();
        assert!(
            (median(&from) - median(&of)).abs() <= 0.05 * median(&of),
            "{} {}",
            from["maps"][index],
            of["maps"][index]
        );
    }
    assert!(from["renderer"].is_null() && from["step"] == 1);
}

/// Where the disk is full, or a file may not grow, nothing is left behind, and the line names the file.
#[test]
#[cfg(target_os = "linux")]
fn a_full_disk_leaves_no_partial_files() {
    let folder = folder("full");
    let program = program::spectral(env!("CARGO_TARGET_TMPDIR")).to_str().unwrap();
    // Files of at most 8 blocks of 1024 bytes; the signal for more is ignored, so that writing fails.
    let script = "trap '' XFSZ; ulimit -f 8; exec \"$0\" \"$@\"";
    for arguments in [
        &["map", "cornell-box-lamp", "--quantity", "illuminance", "--size", "96x96"][..],
        &["render", "cornell-box-lamp", "--spectral-exr", "--spp", "1", "--size", "96x96"],
    ] {
        let output = Command::new("bash")
            .args(["-c", script, program])
            .args(arguments)
            .args(["--out", folder.to_str().unwrap()])
            .output()
            .unwrap();
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(2), "{said}");
        assert!(said.lines().count() == 1 && said.contains("cornell-box-lamp-"), "{said}");
        assert_eq!(names(&folder), Vec::<String>::new(), "{arguments:?}");
    }
}
