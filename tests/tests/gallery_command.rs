//! `spectral gallery`: a page whose links lead somewhere, pictures that are rendered once, and failures that stop nothing else.
#![allow(clippy::unwrap_used, reason = "helpers of tests fail by panicking")]

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use serde_json::Value;
use spectral_tests::program::spectral;

const SCRATCH: &str = env!("CARGO_TARGET_TMPDIR");

/// An empty place for a test's files.
fn folder(name: &str) -> PathBuf {
    let folder = Path::new(SCRATCH).join("gallery").join(name);
    if folder.exists() {
        fs::remove_dir_all(&folder).unwrap();
    }
    fs::create_dir_all(&folder).unwrap();
    folder
}

fn gallery(out: &Path, arguments: &[&str]) -> Output {
    let out = format!("--out={}", out.display());
    Command::new(spectral(SCRATCH)).args(["gallery", "--quick", "--json", &out]).args(arguments).output().unwrap()
}

fn answer(output: &Output) -> Value {
    serde_json::from_slice(&output.stdout).unwrap()
}

/// What a page's attributes of a name hold.
fn attributes<'p>(page: &'p str, name: &str) -> Vec<&'p str> {
    let start = format!("{name}=\"");
    page.split(&start).skip(1).map(|rest| rest.split('"').next().unwrap()).collect()
}

/// All files below a folder.
fn files(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    entries.flat_map(|path| if path.is_dir() { files(&path) } else { vec![path] }).collect()
}

#[test]
fn a_page_is_made_once_and_what_is_missing_again() {
    let out = folder("resumed").join("page");
    let first = gallery(&out, &["furnace", "cornell-box"]);
    assert_eq!(first.status.code(), Some(0), "{}", String::from_utf8_lossy(&first.stderr));
    // Silence where standard error is no terminal.
    assert!(first.stderr.is_empty());
    let found = answer(&first);
    assert_eq!((&found["rendered"], &found["found"]), (&8.into(), &0.into()));
    assert_eq!(found["failed"], Value::Array(Vec::new()));
    assert!(files(&out).iter().all(|file| file.extension().is_some_and(|e| e != "part")));

    let page = fs::read_to_string(out.join("index.html")).unwrap();
    assert!(page.starts_with("<!DOCTYPE html>") && page.trim_end().ends_with("</html>"));
    let (pictures, links) = (attributes(&page, " src"), attributes(&page, " href"));
    // 8 pictures, 6 maps of differences, and intervals' map and histogram twice.
    assert_eq!(pictures.len(), 8 + 6 + 4);
    for link in pictures.iter().chain(&links) {
        match link.strip_prefix('#') {
            Some(id) => assert!(page.contains(&format!(" id=\"{id}\"")), "{link}"),
            None => assert!(out.join(link).is_file(), "{link}"),
        }
    }
    assert_eq!(attributes(&page, " alt").len(), pictures.len());

    let stamp = |name: &str| fs::metadata(out.join(name)).unwrap().modified().unwrap();
    let picture = "cornell-box/rgb/cornell-box-rgb.exr";
    let before = stamp(picture);
    let again = answer(&gallery(&out, &["furnace", "cornell-box"]));
    assert_eq!((&again["rendered"], &again["found"]), (&0.into(), &8.into()));
    assert_eq!(stamp(picture), before);

    // What an interrupted run has left counts only if it is complete.
    fs::remove_file(out.join("cornell-box/smits/cornell-box-smits.png")).unwrap();
    fs::remove_file(out.join("furnace/interval/record.json")).unwrap();
    fs::write(out.join("cornell-box/bilinear/record.json"), "{ \"arguments\":").unwrap();
    let mended = answer(&gallery(&out, &["furnace", "cornell-box"]));
    assert_eq!((&mended["rendered"], &mended["found"]), (&3.into(), &5.into()));

    let fresh = answer(&gallery(&out, &["furnace", "--fresh"]));
    assert_eq!((&fresh["rendered"], &fresh["found"]), (&2.into(), &0.into()));
}

#[test]
fn a_scene_that_fails_stops_nothing_else() {
    let out = folder("failed");
    fs::write(out.join("furnace"), "not a folder").unwrap();
    let output = gallery(&out, &["furnace", "cie-171-5-8"]);
    assert_eq!(output.status.code(), Some(1), "{}", String::from_utf8_lossy(&output.stderr));
    let found = answer(&output);
    assert_eq!(found["rendered"], 2);
    let failed = found["failed"].as_array().unwrap();
    assert_eq!(failed.len(), 2);
    for failure in failed {
        assert_eq!(failure["scene"], "furnace");
        assert!(failure["error"].as_str().unwrap().contains("furnace"), "{failure}");
    }
    let page = fs::read_to_string(out.join("index.html")).unwrap();
    assert!(page.contains("class=\"failed\"") && page.contains("cie-171-5-8/interval/"));
}

#[test]
fn unknown_scenes_are_refused_before_anything_is_written() {
    let out = folder("unknown").join("page");
    let output = gallery(&out, &["furnace", "fornace"]);
    assert_eq!(output.status.code(), Some(2));
    let said = String::from_utf8_lossy(&output.stderr);
    assert_eq!(said.lines().count(), 1);
    assert!(said.contains("\"fornace\"") && said.contains("furnace, lounge") && said.contains("office"), "{said}");
    assert!(output.stdout.is_empty() && !out.exists());
}
