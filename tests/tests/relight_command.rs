//! `spectral relight` as it is called: its answers, what it refuses, threads, and memory.
#![allow(clippy::panic, clippy::unwrap_used, reason = "helpers of tests fail by panicking")]
#![allow(clippy::cast_possible_truncation, reason = "random bytes")]

use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

use renderers::image::{Picture, write_exr};
use serde_json::{Value, json};
use spectral_tests::program;
use spectral_tests::statistics::Rng;

fn fresh(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("relight_command").join(name);
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).unwrap();
    folder
}

fn command(folder: &Path, arguments: &str) -> Command {
    let mut command = Command::new(program::spectral(env!("CARGO_TARGET_TMPDIR")));
    command.arg("relight").args(arguments.split(' ')).current_dir(folder).env("RUST_BACKTRACE", "0");
    command
}

fn run(folder: &Path, arguments: &str) -> Output {
    command(folder, arguments).output().unwrap()
}

fn answer(folder: &Path, arguments: &str) -> Value {
    let output = run(folder, &format!("{arguments} --json"));
    assert!(output.status.success() && output.stderr.is_empty(), "{arguments}: {output:?}");
    serde_json::from_slice(&output.stdout).unwrap()
}

fn varied(width: usize, height: usize) -> Picture {
    let mut rng = Rng::new(3);
    let pixels = (0..width * height).map(|_| core::array::from_fn(|_| 10.0 * rng.unit_f32())).collect();
    Picture::from_pixels(width, height, pixels).unwrap()
}

const LIGHTS: &str = "--from 0.4,0.9,1 --to 1,0.9,0.1";

#[test]
fn the_answer_says_what_was_done() {
    let folder = fresh("answer");
    let picture = varied(31, 18);
    let depth = renderers::image::ScalarMap::filled(31, 18, 2.5).unwrap();
    write_exr(&folder.join("in.exr"), &picture, &[("Z", &depth)], &[]).unwrap();
    let found = answer(&folder, &format!("in.exr out.exr {LIGHTS}"));
    assert!(found["seconds"].as_f64().unwrap() > 0.0 && found["condition"].as_f64().unwrap() > 1.0);
    assert_eq!([&found["pixels"], &found["width"], &found["height"]], [558, 31, 18]);
    assert_eq!([&found["operator"], &found["tensor"]], ["bilinear", "rec709"]);
    assert_eq!([&found["from"], &found["to"]], [&json!([0.4, 0.9, 1.0]), &json!([1.0, 0.9, 0.1])]);
    assert_eq!([&found["kept_channels"], &found["dropped_channels"]], [&json!(["Z"]), &json!([])]);
    assert_eq!(found["files"], json!(["out.exr"]));
    assert!(found["impossible_pixels"].as_u64().unwrap() > 0 && found["negative_pixels"].as_u64().unwrap() > 0);
    assert_eq!(found["limited_pixels"], 0);

    let found = answer(&folder, &format!("in.exr out.hdr {LIGHTS} --operator classical"));
    assert_eq!(
        [&found["operator"], &found["tensor"], &found["alpha"]],
        [&json!("classical"), &Value::Null, &json!([0.0, 0.0, 0.0])]
    );
    assert!((found["condition"].as_f64().unwrap() - 2.5).abs() <= 1e-12, "{found}");
    assert_eq!(found["dropped_channels"], json!(["Z"]));
    assert_eq!([&found["impossible_pixels"], &found["negative_pixels"]], [0, 0]);

    for tensor in ["rec709", "rec2020", "acescg", "iso"] {
        assert_eq!(answer(&folder, &format!("in.exr out.exr {LIGHTS} --tensor {tensor}"))["tensor"], tensor);
    }
    let text = String::from_utf8(run(&folder, &format!("out.hdr out.exr {LIGHTS}")).stdout).unwrap();
    assert!(text.contains("condition number") && text.contains("31 × 18") && text.ends_with("out.exr\n"), "{text}");
}

#[test]
fn alpha_goes_from_the_classical_operator_to_the_tensor() {
    let folder = fresh("alpha");
    write_exr(&folder.join("in.exr"), &varied(9, 9), &[], &[]).unwrap();
    let file = |name: &str, options: &str| {
        answer(&folder, &format!("in.exr {name} {LIGHTS} {options}"));
        fs::read(folder.join(name)).unwrap()
    };
    let classical = file("classical.exr", "--operator classical");
    assert!(file("zero.exr", "--alpha 0,0,0") == classical);
    assert!(file("some.exr", "--alpha 0.1,0,0") != classical);
    let own = &answer(&folder, &format!("in.exr own.exr {LIGHTS}"))["alpha"];
    let again =
        answer(&folder, &format!("in.exr again.exr {LIGHTS} --alpha {}", own.to_string().trim_matches(['[', ']'])));
    assert_eq!(&again["alpha"], own);
}

#[test]
fn bad_input_is_refused_in_a_line() {
    let folder = fresh("refused");
    write_exr(&folder.join("in.exr"), &varied(4, 3), &[], &[]).unwrap();
    let whole = fs::read(folder.join("in.exr")).unwrap();
    fs::write(folder.join("half.exr"), &whole[..whole.len() / 2]).unwrap();
    fs::write(folder.join("half.hdr"), "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 2 +X 2\n0123").unwrap();
    fs::write(folder.join("note.txt"), "hello").unwrap();
    for (arguments, parts) in [
        ("in.exr out.exr --from 1,1,1", &["--to <R,G,B>"][..]),
        ("in.exr out.exr --from 1,1 --to 1,1,1", &["'1,1'", "three finite numbers"]),
        ("in.exr out.exr --from 1,1,1 --to 1,1,1,1", &["'1,1,1,1'", "three finite numbers"]),
        ("in.exr out.exr --from 1,nan,1 --to 1,1,1", &["'1,nan,1'", "three finite numbers"]),
        ("in.exr out.exr --from 1,1,1 --to inf,1,1", &["'inf,1,1'", "three finite numbers"]),
        ("in.exr out.exr --from 0,0,0 --to 1,1,1", &["in.exr", "none of the 12 pixels", "singular"]),
        ("in.exr out.exr --from 0,1,1 --to 1,1,1 --operator classical", &["in.exr", "0,1,1", "singular"]),
        ("in.exr out.exr --from 1,1,1 --to 1,1,1 --alpha -0.1,0,0", &["--alpha", "channel 0 is negative"]),
        ("in.exr out.exr --from 1,1,1 --to 1,1,1 --alpha 0,0,nan", &["'0,0,nan'", "three finite numbers"]),
        ("in.exr out.exr --from 1,1,1 --to 1,1,1 --alpha 0.1,0,0 --tensor rec2020", &["--alpha", "transfers nothing"]),
        ("in.exr out.exr --from 1,1,1 --to 1,1,1 --alpha 0,0,0 --operator classical", &["bilinear operator"]),
        ("in.exr out.exr --from 1,1,1 --to 1,1,1 --tensor iso --operator classical", &["bilinear operator"]),
        ("in.exr out.png --from 1,1,1 --to 1,1,1", &["out.png", ".exr, .hdr or .pic"]),
        ("in.exr none/out.exr --from 1,1,1 --to 1,1,1", &["none/out.exr"]),
        ("none.exr out.exr --from 1,1,1 --to 1,1,1", &["none.exr"]),
        ("note.txt out.exr --from 1,1,1 --to 1,1,1", &["note.txt", "neither"]),
        ("half.exr out.exr --from 1,1,1 --to 1,1,1", &["half.exr"]),
        ("half.hdr out.exr --from 1,1,1 --to 1,1,1", &["half.hdr", "ends too early"]),
    ] {
        let Output { status, stdout, stderr } = run(&folder, arguments);
        let stderr = String::from_utf8(stderr).unwrap();
        assert_eq!(status.code(), Some(2), "{arguments}: {stderr}");
        assert!(stdout.is_empty() && stderr.lines().count() == 1 && stderr.starts_with("spectral: "), "{stderr}");
        for part in parts {
            assert!(stderr.contains(part), "{arguments}: {part:?} is not in {stderr}");
        }
        assert_eq!(fs::read_dir(&folder).unwrap().count(), 4, "{arguments}");
    }
}

/// A Radiance picture of any pixels.
fn write_noise(path: &Path, [width, height]: [usize; 2]) {
    let mut file = std::io::BufWriter::new(fs::File::create(path).unwrap());
    write!(file, "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y {height} +X {width}\n").unwrap();
    let mut rng = Rng::new(5);
    for _ in 0..width * height {
        let [r, g, b, e, ..] = rng.bits().to_le_bytes();
        file.write_all(&[r | 128, g, b, 126 + (e & 7)]).unwrap();
    }
    file.flush().unwrap();
}

#[test]
fn threads_change_no_byte() {
    let folder = fresh("threads");
    write_noise(&folder.join("in.hdr"), [1500, 700]);
    for extension in ["exr", "hdr"] {
        let files = ["1", "2", "7"].map(|threads| {
            let name = format!("out{threads}.{extension}");
            answer(&folder, &format!("in.hdr {name} {LIGHTS} --threads {threads}"));
            fs::read(folder.join(name)).unwrap()
        });
        assert!(files[0] == files[1] && files[0] == files[2], "{extension}");
    }
}

/// The most memory that a command ever held, in MiB.
#[cfg(target_os = "linux")]
fn most_memory(folder: &Path, arguments: &str) -> f64 {
    let mut child = command(folder, arguments).stdout(Stdio::null()).spawn().unwrap();
    let status = PathBuf::from(format!("/proc/{}/status", child.id()));
    let mut most = 0.0;
    loop {
        // The file lacks the line when the process has ended.
        let text = fs::read_to_string(&status).unwrap_or_default();
        let line = text.lines().find_map(|line| line.strip_prefix("VmHWM:"));
        most = line.map_or(most, |line| line.trim().trim_end_matches(" kB").parse::<f64>().unwrap() / 1024.0);
        if let Some(status) = child.try_wait().unwrap() {
            assert!(status.success(), "{arguments}");
            return most;
        }
        std::thread::sleep(core::time::Duration::from_millis(2));
    }
}

#[cfg(target_os = "linux")]
#[test]
fn memory_does_not_grow_with_the_picture() {
    let folder = fresh("memory");
    write_noise(&folder.join("small.hdr"), [1024, 1024]);
    write_noise(&folder.join("large.hdr"), [4096, 4096]);
    for [from, to] in [["hdr", "hdr"], ["hdr", "exr"], ["exr", "hdr"]] {
        let [small, large] = ["small", "large"].map(|size| {
            let lights = "--from 1,0.5,0.2 --to 0.4,0.9,1";
            most_memory(&folder, &format!("{size}.{from} {size}.{to} {lights} --threads 4"))
        });
        println!("{from} to {to}: {small:.1} MiB for 1 megapixel, {large:.1} MiB for 16");
        assert!(small > 1.0 && large <= 200.0 && large <= small + 16.0, "{from} to {to}: {small}, {large} MiB");
    }
}
