//! Dielectrics that enclose no medium are told of by name, and by nothing but a warning.
#![allow(clippy::panic, clippy::unwrap_used, reason = "helpers of tests fail by panicking")]

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use renderers::scene::{Flaw, Scene, Source, load};
use serde_json::Value;
use spectral_tests::program;

const SENSOR: &str = "<sensor type='perspective'><float name='fov' value='40'/>
<transform name='to_world'><lookat origin='0 0 9' target='0 0 0' up='0 1 0'/></transform></sensor>";
const GLASS: &str = "<bsdf type='dielectric'/>";

/// A tetrahedron, its front outside: each face in its own words, as files with normals or texture coordinates have them.
const CORNERS: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n";
const FACES: [&str; 4] = ["f 1 3 2\n", "f 1 2 4\n", "f 1 4 3\n", "f 2 3 4\n"];

fn scene(body: &str) -> String {
    format!("<scene version='3.0.0'>{SENSOR}\n{body}</scene>")
}

fn read(body: &str, obj: &str) -> Scene {
    let source = Source::text("s.xml", scene(body)).with_asset("body.obj", obj);
    load(&source, &[]).unwrap_or_else(|error| panic!("{error}"))
}

/// What is said of a mesh of glass.
fn flaw(obj: &str, properties: &str) -> Option<Flaw> {
    let shape =
        format!("<shape type='obj' id='body'><string name='filename' value='body.obj'/>{properties}{GLASS}</shape>");
    let warnings = read(&shape, obj).warnings();
    assert!(warnings.len() <= 1);
    warnings.first().map(|warning| {
        assert_eq!(warning.shape, "body (s.xml:3)");
        warning.flaw
    })
}

#[test]
fn closed_bodies_give_no_warning() {
    let whole = CORNERS.to_owned() + &FACES.concat();
    let flat = "<boolean name='face_normals' value='true'/>";
    let turned =
        "<transform name='to_world'><scale x='-3' y='1e-4'/><rotate z='1' angle='33'/><translate x='100'/></transform>";
    assert_eq!(flaw(&whole, ""), None);
    assert_eq!(flaw(&whole, flat), None);
    // A mirroring turns the corners' order round, and what was outside with it.
    assert_eq!(flaw(&whole, turned), Some(Flaw::InsideOut));
    assert_eq!(flaw(&whole, &format!("{turned}<boolean name='flip_normals' value='true'/>")), None);
    for shape in ["sphere", "cube"] {
        assert_eq!(read(&format!("<shape type='{shape}'>{GLASS}</shape>"), "").warnings(), []);
    }
    // Each face with vertices of its own, by its texture coordinates.
    let seams = "vt 0 0\nvt 1 1\nvt 0 1\nvt 1 0\n";
    let corner = |face: &str, vt: usize| face.replace(" 1", &format!(" 1/{vt}")).replace(" 2", &format!(" 2/{vt}"));
    let faces: String = FACES.iter().enumerate().map(|(i, face)| corner(face, i + 1)).collect();
    assert_eq!(flaw(&format!("{CORNERS}{seams}{faces}"), ""), None);
    // Zeros of both signs, and two bodies that share an edge.
    let second = "v -1 -0 -0\nv -0 -1 0\nv 0 0 1\nv -0 -0 -0\nf 8 6 5\nf 8 5 7\nf 8 7 6\nf 5 6 7\n";
    assert_eq!(flaw(&(whole.clone() + second), ""), None);
}

#[test]
fn open_twisted_flat_and_inverted_meshes_are_told_apart() {
    let faces = |list: [&str; 4]| CORNERS.to_owned() + &list.concat();
    let [a, b, c, d] = FACES;
    assert_eq!(flaw(&faces([a, b, c, ""]), ""), Some(Flaw::Open { edges: 3 }));
    assert_eq!(flaw(&faces([a, "", "", ""]), ""), Some(Flaw::Open { edges: 3 }));
    assert_eq!(flaw(&faces([a, b, c, "f 4 3 2\n"]), ""), Some(Flaw::TwoFaced { edges: 3 }));
    assert_eq!(flaw(&faces(["f 2 3 1\n", "f 4 2 1\n", "f 3 4 1\n", "f 4 3 2\n"]), ""), Some(Flaw::InsideOut));
    assert_eq!(flaw(&faces([a, b, c, d]), "<boolean name='flip_normals' value='true'/>"), Some(Flaw::InsideOut));
    // A sheet with two sides, far from the origin and askew, where rounding leaves it some volume.
    let sheet = "v 0 0 0\nv 1 0 0.1\nv 1 1 0.3\nv 0 1 0.2\nf 1 2 3 4\nf 1 4 3\nf 1 3 2\n";
    let away =
        "<transform name='to_world'><rotate x='1' y='2' z='3' angle='77'/><translate x='1000' y='7'/></transform>";
    assert_eq!(flaw(sheet, ""), Some(Flaw::ZeroVolume));
    assert_eq!(flaw(sheet, away), Some(Flaw::ZeroVolume));
    // A pane of a thousandth is a body.
    let pane = "<transform name='to_world'><scale x='1' y='1' z='0.001'/><translate x='10'/></transform>";
    assert_eq!(flaw(&faces(FACES), pane), None);
}

#[test]
fn shapes_without_an_inside_are_told_of_and_opaque_ones_are_not() {
    let shapes = format!(
        "<bsdf type='dielectric' id='glass'/>
        <shape type='rectangle' id='pane'><ref id='glass'/></shape>
        <shape type='disk'>{GLASS}</shape>
        <shape type='sphere' id='bubble'><boolean name='flip_normals' value='true'/><ref id='glass'/></shape>
        <shape type='rectangle'/><shape type='disk'><bsdf type='conductor'/></shape>
        <shape type='obj'><string name='filename' value='body.obj'/></shape>"
    );
    let warnings: Vec<_> =
        read(&shapes, &(CORNERS.to_owned() + FACES[0])).warnings().iter().map(ToString::to_string).collect();
    let flat = "is flat and encloses nothing: light enters its medium and never leaves it";
    assert_eq!(
        warnings,
        [
            format!("pane (s.xml:4): the dielectric {flat}"),
            format!("disk (s.xml:5): the dielectric {flat}"),
            "bubble (s.xml:6): the dielectric is inside out: its medium is the space around it".to_owned(),
        ]
    );
}

fn spectral(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(program::spectral(env!("CARGO_TARGET_TMPDIR"))).args(arguments).current_dir(folder).output().unwrap()
}

/// Both commands go on, say it on stderr, a line for each shape, and give the same in JSON.
#[test]
fn commands_warn_and_go_on() {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("scene_warnings");
    std::fs::create_dir_all(&folder).unwrap();
    let light = "<emitter type='point'><point name='position' x='0' y='0' z='5'/></emitter><shape type='sphere'/>";
    let pane =
        format!("<shape type='rectangle' id='pane'>{GLASS}</shape>\n<shape type='disk' id='lid'>{GLASS}</shape>");
    std::fs::write(folder.join("odd.xml"), scene(&(light.to_owned() + &pane))).unwrap();
    std::fs::write(folder.join("good.xml"), scene(light)).unwrap();
    std::fs::write(folder.join("points.csv"), "x,y,z,nx,ny,nz\n0,0,3,0,0,1\n").unwrap();
    let render: &[&str] = &["render", "odd.xml", "--size", "8x8", "--spp", "1", "--json"];
    let illuminance: &[&str] = &["illuminance", "odd.xml", "--points", "points.csv", "--json"];
    for arguments in [render, illuminance] {
        let Output { status, stdout, stderr } = spectral(&folder, arguments);
        let stderr = String::from_utf8(stderr).unwrap();
        assert_eq!(status.code(), Some(0), "{arguments:?}: {stderr}");
        let answer: Value = serde_json::from_slice(&stdout).unwrap();
        let told: Vec<_> = answer["warnings"].as_array().unwrap().iter().map(|w| w.as_str().unwrap()).collect();
        assert_eq!(
            stderr.lines().collect::<Vec<_>>(),
            told.iter().map(|w| format!("warning: {w}")).collect::<Vec<_>>()
        );
        assert!(
            told.len() == 2 && told[0].starts_with("pane (odd.xml:3): ") && told[1].starts_with("lid (odd.xml:4): ")
        );
        let good: Vec<_> = arguments.iter().map(|a| if *a == "odd.xml" { "good.xml" } else { *a }).collect();
        let Output { stdout, stderr, .. } = spectral(&folder, &good);
        let answer: Value = serde_json::from_slice(&stdout).unwrap();
        assert!(answer["warnings"] == serde_json::json!([]) && stderr.is_empty());
    }
}
