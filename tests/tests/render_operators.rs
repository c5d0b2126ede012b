//! What three components cost in colour: the Cornell box by every operator against spectra, under many lights.
//!
//! The reference is `uniform:401`, which has the same rays (`uniform:4000` for the lines of sodium).
#![allow(clippy::panic, clippy::unwrap_used, reason = "helpers of tests fail by panicking")]
#![allow(clippy::print_stdout, reason = "the figures behind the verdict are shown with --nocapture")]

use renderers::image::Picture;
use renderers::render::{Options, Spectra, render};
use renderers::report::Table;
use renderers::scene::{Emitter, Scene, SpectrumKind, builtin, parse_spectrum_file};
use renderers::spectral::IntervalSettings;
use spectral_core::colour::rgb::{WHITE, linear_rgb_to_xyz};
use spectral_core::colour::{RgbSpace, delta_e_00, xyz_to_lab};
use spectral_core::spectrum::{Outside, Spectrum};
use spectral_core::tables::find_light;
use spectral_core::upsampling::LightUpsampler;

const SIDE: u32 = 64;

/// A light sampled at whole nanometres.
fn table(light: &impl Spectrum<f64>) -> SpectrumKind {
    let wavelengths: Vec<f64> = (360..=830).map(f64::from).collect();
    let values = wavelengths.iter().map(|w| light.value(*w)).collect();
    SpectrumKind::Table { wavelengths, values }
}

fn light(name: &str) -> SpectrumKind {
    match name {
        "cyan" => {
            let lights = LightUpsampler::<_, f64>::d65(&RgbSpace::REC_709).unwrap();
            table(&lights.emission([0.0, 1.0, 1.0]).unwrap())
        }
        "sodium" => {
            let text = include_str!("../../renderers/scenes/spectra/sodium_low_pressure.spd");
            parse_spectrum_file("sodium_low_pressure.spd", text).unwrap()
        }
        _ => table(&find_light(name).unwrap().spectrum::<f64>(Outside::Zero)),
    }
}

/// The Cornell box under another light of the same luminance.
fn cornell_box(name: &str) -> Scene {
    let mut scene = builtin::load("cornell-box", &[]).unwrap();
    if name == "D65" {
        return scene;
    }
    let radiance = scene.emitters.iter().find_map(|emitter| match emitter {
        Emitter::Area { radiance, .. } => Some(*radiance),
        _ => None,
    });
    let known = &mut scene.spectra[radiance.unwrap().0].kind;
    let other = light(name);
    *known = other.scaled(known.photometric() / other.photometric());
    scene
}

fn picture(scene: &Scene, spectra: Spectra) -> Picture {
    let options = Options { spectra, size: Some([SIDE, SIDE]), samples: Some(4), ..Options::default() };
    render(scene, &options, &|_| {}).unwrap().picture
}

/// Mean and 95th percentile of ΔE00, relative to the white of Rec. 709 at Y = 1.
fn difference(first: &Picture, second: &Picture) -> [f64; 2] {
    let lab = |pixel: &[f32; 3]| xyz_to_lab(linear_rgb_to_xyz(pixel.map(f64::from)), WHITE);
    let mut all: Vec<f64> =
        first.pixels().iter().zip(second.pixels()).map(|(a, b)| delta_e_00(lab(a), lab(b))).collect();
    all.sort_by(f64::total_cmp);
    [all.iter().sum::<f64>() / f64::from(SIDE * SIDE), all[all.len() * 95 / 100]]
}

const OPERATORS: [Spectra; 4] = [Spectra::Rgb, Spectra::RgbPrefiltered, Spectra::Bilinear, Spectra::Smits];

#[test]
fn what_each_operator_costs_in_colour() {
    let interval = Spectra::Interval(IntervalSettings::default());
    let ways: Vec<Spectra> = OPERATORS.into_iter().chain([interval]).collect();
    let mut headings = vec!["light".to_owned()];
    headings.extend(ways.iter().map(ToString::to_string));
    let mut shown = Table::new(headings);
    for name in ["D65", "A", "FL11", "LED-B3", "sodium", "cyan"] {
        let scene = cornell_box(name);
        let truth = picture(&scene, Spectra::Uniform(if name == "sodium" { 4000 } else { 401 }));
        let errors: Vec<[f64; 2]> = ways.iter().map(|way| difference(&picture(&scene, *way), &truth)).collect();
        let mut row = vec![name.to_owned()];
        row.extend(errors.iter().map(|[mean, p95]| format!("{mean:.3} / {p95:.3}")));
        shown.row(row);
        let [rgb, prefiltered, bilinear, smits, intervals] = errors[..] else { panic!("five ways") };
        // Direct diffuse light is what prefiltering makes exact; pictures are f32.
        assert!(prefiltered[1] <= 0.02, "{name}: {prefiltered:?}");
        assert!(intervals[1] <= 1.0, "{name}: {intervals:?}");
        if name == "D65" {
            assert!(rgb[1] <= 0.02, "{rgb:?}"); // f32, and what 401 bins leave
        } else {
            assert!(rgb[0] > 10.0 * prefiltered[0], "{name}: {rgb:?} {prefiltered:?}");
            // A quarter less under A, half under sodium.
            assert!(bilinear[0] < 0.8 * rgb[0] && bilinear[1] < 0.8 * rgb[1], "{name}: {rgb:?} {bilinear:?}");
            assert!(smits[0] < 1.5 * rgb[0], "{name}: {rgb:?} {smits:?}");
        }
    }
    println!("mean / 95th percentile of ΔE00 to spectra, direct light in the Cornell box\n{shown}");
}

#[test]
fn under_white_the_bilinear_picture_is_the_classical_one() {
    let scene = cornell_box("D65");
    let [bilinear, classical] = [Spectra::Bilinear, Spectra::Rgb].map(|spectra| picture(&scene, spectra));
    let pairs = bilinear.pixels().as_flattened().iter().zip(classical.pixels().as_flattened());
    let largest = pairs.map(|(a, b)| f64::from((a - b).abs())).fold(0.0, f64::max);
    println!("bilinear to classical under white: {largest:.1e}");
    assert!(largest <= 1e-6);
    assert!(classical.pixels().iter().any(|pixel| pixel[0] > 0.1));
}

/// The red wall of figure 4 of Granier and Damez: at the left edge of the picture, half-way up.
#[test]
fn under_cyan_the_red_wall_keeps_its_red() {
    let scene = cornell_box("cyan");
    let red = |spectra| {
        let picture = picture(&scene, spectra);
        let wall = (SIDE / 4..SIDE * 3 / 4).map(|row| picture.pixels()[(row * SIDE + 3) as usize][0]);
        wall.sum::<f32>() / f32::from(u16::try_from(SIDE / 2).unwrap())
    };
    let [truth, bilinear, classical] = [Spectra::Uniform(401), Spectra::Bilinear, Spectra::Rgb].map(red);
    println!("red of the red wall under cyan: {truth:.5}, bilinear {bilinear:.5}, classical {classical:.5}");
    // The classical product has none of it.
    assert!(classical.abs() <= 1e-5);
    assert!(truth > 0.01 && (bilinear - truth).abs() <= 0.75 * truth, "{bilinear} {truth}");
}
