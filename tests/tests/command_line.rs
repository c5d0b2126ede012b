//! The `spectral` command as it is called: bad input is one line and exit code 2, good input gives what was promised,
//! and the number of threads changes nothing.
#![allow(clippy::panic, clippy::unwrap_used, reason = "helpers of tests fail by panicking")]

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use renderers::image::read_exr;
use renderers::scene::builtin;
use serde_json::Value;
use spectral_tests::program;

/// Runs the command in a folder.
fn spectral(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(program::spectral(env!("CARGO_TARGET_TMPDIR")))
        .args(arguments)
        .current_dir(folder)
        .env("RUST_BACKTRACE", "0")
        .output()
        .unwrap()
}

/// An empty folder of this name for a test.
fn fresh(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("command_line").join(name);
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).unwrap();
    folder
}

/// All files in a folder and those below.
fn files_in(folder: &Path) -> Vec<PathBuf> {
    let Ok(entries) = fs::read_dir(folder) else { return Vec::new() };
    let paths = entries.map(|entry| entry.unwrap().path());
    paths.flat_map(|path| if path.is_dir() { files_in(&path) } else { vec![path] }).collect()
}

/// Whether bad input was refused: exit code 2, nothing on stdout and one line on stderr with all the parts, no file in `out`.
#[track_caller]
fn assert_refused(folder: &Path, arguments: &[&str], parts: &[&str]) {
    let Output { status, stdout, stderr } = spectral(folder, arguments);
    let (stdout, stderr) = (String::from_utf8(stdout).unwrap(), String::from_utf8(stderr).unwrap());
    assert_eq!(status.code(), Some(2), "{arguments:?}: {stderr}");
    assert_eq!(stdout, "", "{arguments:?}");
    assert!(stderr.ends_with('\n') && stderr.lines().count() == 1, "{arguments:?}: {stderr:?}");
    assert!(stderr.starts_with("spectral: ") && stderr.len() > 14, "{arguments:?}: {stderr}");
    assert!(!stderr.contains("panicked"), "{arguments:?}: {stderr}");
    for part in parts {
        assert!(stderr.contains(part), "{arguments:?}: {part:?} is not in {stderr}");
    }
    assert_eq!(files_in(&folder.join("out")), Vec::<PathBuf>::new(), "{arguments:?}");
}

const SENSOR: &str = "<sensor type='perspective'><float name='fov' value='40'/></sensor>";

/// A scene with a good sensor on line 2 and `body` from line 3 on.
fn scene(body: &str) -> String {
    format!("<scene version='3.0.0'>\n{SENSOR}\n{body}\n</scene>\n")
}

fn reflectance(spectrum: &str) -> String {
    scene(&format!("<shape type='sphere'>\n<bsdf type='diffuse'>\n{spectrum}</bsdf></shape>"))
}

#[test]
fn bad_scenes_are_refused_by_file_and_line() {
    let folder = fresh("bad_scenes");
    for (name, text) in [
        ("nan.spd", "400 0.1\n500 nan\n"),
        ("infinite.spd", "400 0.1\n500 inf\n"),
        ("negative.spd", "400 0.1\n410 0.2\n420 -0.2\n"),
        ("unsorted.spd", "# a heading\n400 0.1\n390 0.2\n"),
        ("flat.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n"),
        ("good.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"),
    ] {
        fs::write(folder.join(name), text).unwrap();
    }
    fs::write(folder.join("latin.xml"), b"<scene version='3.0.0'>\xe9</scene>").unwrap();
    let file = |name: &str| reflectance(&format!("<spectrum name='reflectance' filename='{name}'/>"));
    let area = |shape: &str| scene(&format!("<shape type='rectangle'>\n{shape}\n<emitter type='area'/></shape>"));
    let film = "<float name='fov' value='40'/><film type='hdrfilm'>\n<integer name='width' value='0'/></film>";
    let rows = [
        (String::new(), "bad.xml:1: malformed XML"),
        ("<scene version='3.0.0'>\n<film>\n</scene>".into(), "bad.xml:3: malformed XML"),
        (scene("<thing/>"), "bad.xml:3: <thing>: not supported"),
        (scene("<shape type='ply'/>"), "bad.xml:3: <shape>: "),
        (scene("<bsdf type='diffuse'>\n<float name='colour' value='1'/></bsdf>"), "bad.xml:4: <float>: "),
        (reflectance("<spectrum name='reflectance' value='400:0.1, 500:nan'/>"), "bad.xml:5: <spectrum>: "),
        (reflectance("<spectrum name='reflectance' value='400:0.1, 500:-1'/>"), "bad.xml:5: <spectrum>: "),
        (reflectance("<spectrum name='reflectance' value='400:0.1, 390:0.2'/>"), "bad.xml:5: <spectrum>: "),
        (reflectance("<spectrum name='reflectance' value='400:0.1, 500:1.5'/>"), "bad.xml:5: <spectrum>: "),
        (file("nan.spd"), "nan.spd:2: "),
        (file("infinite.spd"), "infinite.spd:2: "),
        (file("negative.spd"), "negative.spd:3: "),
        (file("unsorted.spd"), "unsorted.spd:3: "),
        (file("missing.spd"), "bad.xml:5: <spectrum>: cannot read \"missing.spd\""),
        (scene("<shape type='obj'>\n<string name='filename' value='missing.obj'/></shape>"), "bad.xml:4: "),
        (scene("<shape type='obj'>\n<string name='filename' value='flat.obj'/></shape>"), "flat.obj:4: "),
        (area("<transform name='to_world'><scale x='0'/></transform>"), "bad.xml:4: <"),
        (area("<transform name='to_world'><matrix value='0 0 0 0 0 0 0 0 0'/></transform>"), "bad.xml:4: <"),
        (scene("<shape type='sphere'>\n<float name='radius' value='0'/><emitter type='area'/></shape>"), "bad.xml:4: "),
        (format!("<scene version='3.0.0'>\n<sensor type='perspective'>\n{film}</sensor></scene>"), "bad.xml:4: "),
        ("<scene version='3.0.0'>\n</scene>".into(), "bad.xml:1: <scene>: the scene has no <sensor>"),
        (
            scene("<integrator type='whitted'>\n<integer name='max_depth' value='257'/></integrator>"),
            "bad.xml:4: <integer>: \"max_depth\" must be between 0 and 256",
        ),
        (scene("<shape type='disk'/>\n<emitter type='constant'/>"), "bad.xml: constant (bad.xml:4): "),
        (
            scene("<shape type='obj'>\n<string name='filename' value='good.obj'/><emitter type='area'/></shape>"),
            "(bad.xml:3): ",
        ),
    ];
    for (text, part) in rows {
        fs::write(folder.join("bad.xml"), text).unwrap();
        assert_refused(&folder, &["render", "bad.xml", "--size", "4x4", "--json"], &[part]);
    }
    assert_refused(&folder, &["render", "latin.xml"], &["latin.xml: the scene is not UTF-8"]);
    assert_refused(&folder, &["render", "missing.xml"], &["missing.xml: cannot read"]);
    assert_refused(&folder, &["render", "."], &[".: cannot read"]);
    assert_refused(&folder, &["render", "two\nlines.xml"], &["two lines.xml: cannot read"]);
}

#[test]
fn wrong_arguments_are_refused() {
    let folder = fresh("wrong_arguments");
    fs::write(folder.join("file"), "").unwrap();
    let rows: [(&[&str], &str); 43] = [
        (&[], "requires a subcommand"),
        (&["draw"], "'draw'"),
        (&["rendr"], "similar"),
        (&["render", "cornell-box", "more"], "'more'"),
        (&["render", "--sise", "4x4"], "--sise"),
        (&["render", "--size"], "--size"),
        (&["render", "--size", "0x4"], "'0x4'"),
        (&["render", "--size", "4x0"], "'4x0'"),
        (&["render", "--size", "4"], "'4'"),
        (&["render", "--size", "4x4x4"], "'4x4x4'"),
        (&["render", "--size", "-4x4"], "-4"),
        (&["render", "--size", "99999x4"], "'99999x4'"),
        (&["render", "--size", "16384x16384"], "16384 × 16384"),
        (&["render", "--spp", "0"], "--spp"),
        (&["render", "--spp", "1.5"], "'1.5'"),
        (&["render", "--seed", "x"], "'x'"),
        (&["render", "--spectra", "hexadecimal"], "'hexadecimal'"),
        (&["render", "--spectra", "uniform"], "'uniform'"),
        (&["render", "--spectra", "uniform:0"], "'uniform:0'"),
        (&["render", "--spectra", "uniform:1e9"], "'uniform:1e9'"),
        (&["render", "--renderer", "magic"], "'magic'"),
        (&["render", "--bound", "loose"], "'loose'"),
        (&["render", "--threshold", "0"], "--threshold must be positive"),
        (&["render", "--threshold=-1"], "--threshold must be positive"),
        (&["render", "--threshold", "nan"], "--threshold must be positive"),
        (&["render", "--threshold", "inf"], "--threshold must be positive"),
        (&["render", "--threshold", "one"], "'one'"),
        (&["render", "--spectra", "rgb", "--threshold", "2"], "--bound and --threshold are for --spectra interval"),
        (&["render", "--renderer", "path", "--bound", "paper"], "--bound and --threshold are for --spectra interval"),
        (&["render", "--accuracy", "0.1"], "--accuracy and --exact are for renderers that find light between surfaces"),
        (
            &["render", "--renderer", "path", "--exact"],
            "--accuracy and --exact are for renderers that find light between surfaces",
        ),
        (&["render", "--photons", "9"], "are for --renderer photon-map"),
        (&["render", "--renderer", "radiosity", "--resume", "state"], "--resume is for --renderer path"),
        (&["render", "--threads", "0"], "--threads must be from 1"),
        (&["render", "--threads", "-1"], "-1"),
        (&["render", "-D", "spp"], "'spp'"),
        (&["render", "-D", "nothing=3"], "nothing"),
        (&["render", "--size", "4x4", "--out", "file"], "file: "),
        (&["render", "--size", "4x4", "--out", "file/below"], "file/below: "),
        (&["compare"], "<FIRST>"),
        (&["compare", "file", "missing.exr"], "file: "),
        (&["compare", "missing.exr", "file"], "missing.exr: "),
        (&["scene", "nothing"], "nothing: no built-in scene"),
    ];
    for (arguments, part) in rows {
        assert_refused(&folder, arguments, &[part]);
    }
}

#[test]
fn compare_refuses_what_it_cannot_compare() {
    let folder = fresh("compare_refuses");
    for size in ["4x4", "4x5"] {
        render(&folder, &["cornell-box", "--size", size, "--spp", "1", "--spectra", "rgb", "--out", size]);
    }
    let (a, b) = ("4x4/cornell-box-rgb.exr", "4x5/cornell-box-rgb.exr");
    assert_refused(&folder, &["compare", a, b, "--out", "out"], &[a, b, "4 × 5"]);
    for exposure in ["0", "nan", "inf"] {
        assert_refused(&folder, &["compare", a, a, "--exposure", exposure, "--out", "out"], &["exposure"]);
    }
    fs::write(folder.join("cut.exr"), &fs::read(folder.join(a)).unwrap()[..200]).unwrap();
    assert_refused(&folder, &["compare", a, "cut.exr", "--out", "out"], &["cut.exr: "]);
    assert_refused(&folder, &["compare", a, a, "--out", a], &[a]);
}

/// The one JSON object that a good run prints, with nothing on stderr, which is no terminal here.
#[track_caller]
fn answer(folder: &Path, arguments: &[&str]) -> Value {
    let Output { status, stdout, stderr } = spectral(folder, arguments);
    assert_eq!(status.code(), Some(0), "{arguments:?}: {}", String::from_utf8_lossy(&stderr));
    assert_eq!(String::from_utf8(stderr).unwrap(), "", "{arguments:?}");
    let value: Value = serde_json::from_slice(&stdout).unwrap();
    assert!(value.is_object(), "{arguments:?}: {value}");
    value
}

#[track_caller]
fn render(folder: &Path, arguments: &[&str]) -> Value {
    answer(folder, &[&["render", "--json"], arguments].concat())
}

/// The files that a run says it wrote: they are there, and they are all there is.
#[track_caller]
fn assert_files(folder: &Path, out: &str, found: &Value) {
    let named = found["files"].as_array().unwrap().iter().map(|file| folder.join(file.as_str().unwrap()));
    let mut named: Vec<_> = named.collect();
    let mut there = files_in(&folder.join(out));
    named.sort();
    there.sort();
    assert_eq!(named, there);
    assert!(there.iter().all(|file| fs::metadata(file).unwrap().len() > 100));
}

#[test]
fn a_rendering_reports_what_it_did() {
    let folder = fresh("report");
    for (spectra, name) in [("interval", "interval"), ("uniform:31", "uniform31"), ("rgb", "rgb")] {
        let size = ["--size", "20x10", "--spp", "2", "--spectra", spectra, "--out", name];
        let found = render(&folder, &size);
        assert_eq!(found["renderer"], "whitted");
        assert_eq!(found["spectra"], spectra);
        assert_eq!((&found["width"], &found["height"]), (&20.into(), &10.into()));
        assert!(found["seconds"].as_f64().unwrap() > 0.0);
        // Without mirrors, all rays are the camera's.
        assert_eq!(found["rays"], 20 * 10 * 2);
        let histogram = found["intervals"]["histogram"].as_array().unwrap();
        let pixels: u64 = histogram.iter().map(|count| count.as_u64().unwrap()).sum();
        assert_eq!(pixels, 200, "{spectra}");
        let [mean, max] = ["mean", "max"].map(|key| found["intervals"][key].as_f64().unwrap());
        assert!(1.0 <= mean && mean <= max, "{spectra}: {mean}, {max}");
        if spectra == "interval" {
            let [mean, max] = ["mean", "max"].map(|key| found["delta_e_bound"][key].as_f64().unwrap());
            assert!(0.0 < mean && mean < max && max <= 1.0, "{mean}, {max}");
        } else {
            assert!(found["delta_e_bound"].is_null(), "{spectra} has no bound");
        }
        assert_files(&folder, name, &found);
        let stem = format!("{name}/cornell-box-{name}");
        let picture = read_exr(&folder.join(format!("{stem}.exr"))).unwrap().picture;
        assert_eq!((picture.width(), picture.height()), (20, 10));
    }
}

#[test]
fn a_picture_compared_with_itself_differs_by_nothing() {
    let folder = fresh("compare");
    render(&folder, &["--size", "16x16", "--spp", "1", "--out", "."]);
    render(&folder, &["--size", "16x16", "--spp", "1", "--spectra", "rgb", "--out", "."]);
    let (a, b) = ("cornell-box-interval.exr", "cornell-box-rgb.exr");
    let same = answer(&folder, &["compare", a, a, "--out", "same", "--json"]);
    assert_eq!(same["delta_e00"], serde_json::json!({ "mean": 0.0, "p95": 0.0, "max": 0.0 }));
    assert_eq!(same["relative_brightness"], serde_json::json!({ "min": 0.0, "max": 0.0 }));
    assert_files(&folder, "same", &same);
    let other = answer(&folder, &["compare", a, b, "--out", "other", "--json"]);
    assert!(other["delta_e00"]["mean"].as_f64().unwrap() > 0.1, "{other}");
    assert_files(&folder, "other", &other);
}

#[test]
fn people_get_tables_help_and_version() {
    let folder = fresh("people");
    let run = |arguments: &[&str]| {
        let Output { status, stdout, stderr } = spectral(&folder, arguments);
        assert_eq!((status.code(), stderr.as_slice()), (Some(0), &b""[..]), "{arguments:?}");
        String::from_utf8(stdout).unwrap()
    };
    assert!(run(&["--help"]).contains("Usage: spectral"));
    assert!(run(&["render", "--help"]).contains("Usage: spectral render"));
    assert_eq!(run(&["--version"]), format!("spectral {}\n", env!("CARGO_PKG_VERSION")));
    assert_eq!(run(&["scene"]).lines().collect::<Vec<_>>(), builtin::names().collect::<Vec<_>>());
    let shown = run(&["render", "--size", "8x8", "--spp", "1"]);
    for part in ["cornell-box", "8 × 8", "bound of ΔE*ab", "out/cornell-box-interval.exr"] {
        assert!(shown.contains(part), "{part:?} is not in\n{shown}");
    }
}

#[test]
fn an_exported_scene_renders_as_the_built_in_one() {
    let folder = fresh("export");
    answer(&folder, &["scene", "cornell-box-sodium", "--export", "files", "--json"]);
    let pixels = |scene: &str, out: &str| {
        let found = render(&folder, &[scene, "-D", "resolution=8", "-D", "spp=2", "--out", out]);
        read_exr(&folder.join(found["files"][1].as_str().unwrap())).unwrap()
    };
    assert_eq!(pixels("cornell-box-sodium", "built-in"), pixels("files/cornell-box-sodium.xml", "exported"));
}

/// Every channel of every scene, bit for bit.
#[test]
fn the_number_of_threads_changes_nothing() {
    let folder = fresh("threads");
    for scene in builtin::names() {
        for spectra in ["interval", "uniform:31", "rgb"] {
            let bits = |threads: &str| {
                let options = ["--size", "37x33", "--spp", "2", "--threads", threads, "--out", threads];
                render(&folder, &[&[scene, "--spectra", spectra], &options[..]].concat());
                let name = format!("{threads}/{scene}-{}.exr", spectra.replace(':', ""));
                let file = read_exr(&folder.join(name)).unwrap();
                let colours = file.picture.pixels().iter().flatten().map(|value| value.to_bits()).collect::<Vec<_>>();
                let others = file.channels.into_iter();
                let others =
                    others.map(|(name, map)| (name, map.pixels().iter().map(|v| v.to_bits()).collect::<Vec<_>>()));
                (colours, others.collect::<Vec<_>>())
            };
            let (one, three) = (bits("1"), bits("3"));
            assert!(one.0.iter().any(|bits| *bits != 0), "{scene}, {spectra}: the picture is black");
            assert!(one == three, "{scene}, {spectra}: the picture depends on the number of threads");
        }
    }
}

/// Between two mirrors that face each other a path is as long as may be.
#[test]
fn the_longest_paths_fit_on_the_stack() {
    let folder = fresh("mirrors");
    let mirror = |turn: u32, z: i32| {
        format!(
            "<shape type='rectangle'><transform name='to_world'><rotate y='1' angle='{turn}'/><translate z='{z}'/>
            </transform><bsdf type='conductor'/></shape>"
        )
    };
    let text = format!(
        "<scene version='3.0.0'><integrator type='whitted'><integer name='max_depth' value='256'/></integrator>
        <sensor type='perspective'><float name='fov' value='1e-4'/></sensor>{}{}</scene>",
        mirror(180, 1),
        mirror(0, -1)
    );
    fs::write(folder.join("mirrors.xml"), text).unwrap();
    let found = render(&folder, &["mirrors.xml", "--size", "2x2", "--spp", "1", "--threads", "1"]);
    assert_eq!(found["rays"], 4 * 257);
}

#[test]
fn a_picture_that_cannot_be_written_leaves_no_part_of_itself() {
    let folder = fresh("unwritable");
    fs::create_dir_all(folder.join("pictures/cornell-box-rgb.exr")).unwrap();
    let wanted = ["render", "--size", "4x4", "--spectra", "rgb", "--out", "pictures"];
    assert_refused(&folder, &wanted, &["pictures/cornell-box-rgb.exr: "]);
    let left = files_in(&folder);
    assert_eq!(left, [folder.join("pictures/cornell-box-rgb.png")], "complete pictures alone");
}
