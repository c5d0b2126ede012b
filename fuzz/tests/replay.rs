//! The seeds of every fuzz target and a fixed number of their mutations, replayed without a fuzzer.

use std::fs;
use std::path::Path;

use renderers::scene::{Source, builtin};
use spectral_tests::statistics::Rng;

/// Inputs longer than this only take time.
const LONGEST: usize = 1 << 14;

/// Pieces of text that parsers trip over.
const WORDS: [&str; 24] = [
    "nan",
    "inf",
    "-1",
    "0",
    "1e308",
    "1e-308",
    "1e999",
    "-0",
    "65537",
    "4294967296",
    "value=\"0\"",
    "<ref id=\"a\"/>",
    "$",
    "\"",
    "/>",
    "<",
    "&lt;",
    "\0",
    "\u{feff}",
    "é",
    "400:0.5, 500:1",
    "N-BK7",
    "f 1 2 3\n",
    "#",
];

fn seeds(target: &str) -> Vec<Vec<u8>> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("seeds").join(target);
    let mut files: Vec<_> = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    files.sort();
    files.iter().map(|file| fs::read(file).unwrap()).collect()
}

fn below(rng: &mut Rng, limit: usize) -> usize {
    usize::try_from(rng.bits() % limit.max(1) as u64).unwrap()
}

/// One small change.
fn mutate(rng: &mut Rng, bytes: &mut Vec<u8>, others: &[Vec<u8>]) {
    let place = below(rng, bytes.len());
    let end = (place + 1 + below(rng, 16)).min(bytes.len());
    match below(rng, 10) {
        0..3 => other_number(rng, bytes, place),
        3 if !bytes.is_empty() => bytes[place] ^= 1 << below(rng, 8),
        4 if !bytes.is_empty() => bytes[place] = rng.bits() as u8,
        5 if !bytes.is_empty() => drop(bytes.drain(place..end)),
        6 => bytes.insert(place, rng.bits() as u8),
        7 => drop(bytes.splice(place..place, WORDS[below(rng, WORDS.len())].bytes())),
        8 if !bytes.is_empty() => {
            let copy = bytes[place..end].to_vec();
            drop(bytes.splice(place..place, copy));
        }
        _ => {
            let other = &others[below(rng, others.len())];
            let from = below(rng, other.len());
            let to = (from + below(rng, 64)).min(other.len());
            drop(bytes.splice(place..end.max(place), other[from..to].iter().copied()));
        }
    }
    bytes.truncate(LONGEST);
}

/// Another number in place of the first digit from `place` on: most of it is read as before.
fn other_number(rng: &mut Rng, bytes: &mut Vec<u8>, place: usize) {
    let Some(offset) = bytes[place.min(bytes.len())..].iter().position(u8::is_ascii_digit) else { return };
    let digit = place + offset;
    let numbers = ["0", "1", "2", "5", "9", "-", ".", "e", "1e3", "1e-9"];
    drop(bytes.splice(digit..=digit, numbers[below(rng, numbers.len())].bytes()));
}

/// Runs a target on its seeds and on mutations of them, naming the input if it panics.
fn replay(target: fn(&[u8]), seeds: &[Vec<u8>], mutations: u32, seed: u64) {
    assert!(seeds.len() >= 4, "the seeds are lost");
    let run = |input: &[u8]| {
        if std::panic::catch_unwind(|| target(input)).is_err() {
            panic!("found by this input:\n{}", input.escape_ascii());
        }
    };
    seeds.iter().for_each(|input| run(input));
    let mut rng = Rng::new(seed);
    for _ in 0..mutations {
        let mut input = seeds[below(&mut rng, seeds.len())].clone();
        for _ in 0..=below(&mut rng, 4) {
            mutate(&mut rng, &mut input, seeds);
        }
        run(&input);
    }
}

#[test]
fn scene_xml() {
    let mut inputs = seeds("scene_xml");
    inputs.extend(builtin::names().filter_map(builtin::source).filter_map(|source| match source {
        Source::Memory { xml, .. } => Some(xml.into_bytes()),
        Source::Disk(_) => None,
    }));
    replay(spectral_fuzz::scene_xml, &inputs, 4_000, 1);
}

#[test]
fn spectrum_file() {
    replay(spectral_fuzz::spectrum_file, &seeds("spectrum_file"), 100_000, 2);
}

#[test]
fn ies_file() {
    replay(spectral_fuzz::ies_file, &seeds("ies_file"), 50_000, 5);
}

#[test]
fn ldt_file() {
    replay(spectral_fuzz::ldt_file, &seeds("ldt_file"), 50_000, 6);
}

#[test]
fn radiance() {
    replay(spectral_fuzz::radiance, &seeds("radiance"), 300_000, 7);
}

#[test]
fn expression() {
    let mut inputs = seeds("expression");
    // Any bytes are an expression.
    let mut rng = Rng::new(3);
    inputs.extend((0..64).map(|_| (0..48).map(|_| rng.bits() as u8).collect::<Vec<_>>()));
    replay(spectral_fuzz::expression, &inputs, 10_000, 4);
}

#[test]
fn light_file() {
    replay(spectral_fuzz::light_file, &seeds("light_file"), 50_000, 8);
}

#[test]
fn points_file() {
    replay(spectral_fuzz::points_file, &seeds("points_file"), 50_000, 9);
}

#[test]
fn readings_file() {
    replay(spectral_fuzz::readings_file, &seeds("readings_file"), 50_000, 10);
}

#[test]
fn answers_file() {
    replay(spectral_fuzz::answers_file, &seeds("answers_file"), 20_000, 11);
}

/// Targets that make numbers of any bytes: random ones are replayed, too.
fn replay_numbers(name: &str, target: fn(&[u8]), mutations: u32) {
    let mut inputs = seeds(name);
    let mut rng = Rng::new(12);
    inputs.extend((0..256).map(|_| (0..96).map(|_| rng.bits() as u8).collect::<Vec<_>>()));
    replay(target, &inputs, mutations, 13);
}

#[test]
fn numbers_of_colours() {
    replay_numbers("colour", spectral_fuzz::colour, 20_000);
    replay_numbers("bilinear", spectral_fuzz::bilinear, 20_000);
    replay_numbers("upsampling", spectral_fuzz::upsampling, 2_000);
}

#[test]
fn numbers_of_spectra() {
    replay_numbers("spectra", spectral_fuzz::spectra, 10_000);
    replay_numbers("operators", spectral_fuzz::operators, 2_000);
}

#[test]
fn numbers_of_lights() {
    replay_numbers("cct", spectral_fuzz::cct, 2_000);
    replay_numbers("light", spectral_fuzz::light, 500);
}

#[test]
fn numbers_of_reflection() {
    replay_numbers("brdf", spectral_fuzz::brdf, 20_000);
    replay_numbers("boundary", spectral_fuzz::boundary, 20_000);
}

#[test]
fn numbers_of_disks() {
    replay_numbers("partition", spectral_fuzz::partition, 20_000);
    replay_numbers("disk_map", spectral_fuzz::disk_map, 20_000);
    replay_numbers("factor", spectral_fuzz::factor, 10_000);
    replay_numbers("estimate", spectral_fuzz::estimate, 1_000);
}

#[test]
fn every_target_is_replayed() {
    let here = include_str!("replay.rs");
    let targets = Path::new(env!("CARGO_MANIFEST_DIR")).join("fuzz_targets");
    let mut count = 0;
    for entry in fs::read_dir(targets).unwrap() {
        let file = entry.unwrap().file_name().into_string().unwrap();
        let name = file.strip_suffix(".rs").unwrap();
        let is_replayed = [format!("seeds(\"{name}\")"), format!("replay_numbers(\"{name}\",")]
            .iter()
            .any(|call| here.contains(call));
        assert!(is_replayed, "{name}");
        count += 1;
    }
    assert!(count >= 23, "{count} targets");
}
