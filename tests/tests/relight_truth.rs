//! Relighting as in figure 7 of Granier and Damez (2004), from a light of (0.4, 0.9, 1.0) to one of (1.0, 0.9, 0.1), of pictures
//! that are rendered spectrally under both lights, so that the right answer is known.
#![allow(clippy::panic, clippy::unwrap_used, reason = "helpers of tests fail by panicking")]
#![allow(clippy::print_stdout, reason = "the table of errors, shown with --nocapture")]

use std::fs;
use std::path::Path;

use renderers::compare::{CompareOptions, Comparison, difference};
use renderers::image::{Picture, read_exr, write_exr};
use renderers::relight::relight;
use renderers::render::{Options, Spectra, render};
use renderers::scene::{self, Scene, Source, builtin};
use spectral_core::bilinear::Tensor;
use spectral_core::colour::{RgbSpace, rgb};
use spectral_core::spectrum::{Outside, PiecewiseLinear, Spectrum};
use spectral_core::upsampling::LightUpsampler;
use spectral_core::{Observer, tristimulus};

const SKY: [f64; 3] = [0.4, 0.9, 1.0];
const YELLOW: [f64; 3] = [1.0, 0.9, 0.1];

/// A light's spectrum, linear between values at 5 nm, with its values.
struct Light(Vec<f64>, Vec<f64>);

impl Light {
    fn new(value: impl Fn(f64) -> f64) -> Self {
        let wavelengths: Vec<f64> = (0..=80).map(|i| 380.0 + 5.0 * f64::from(i)).collect();
        let values = wavelengths.iter().map(|w| value(*w)).collect();
        Self(wavelengths, values)
    }

    /// Smooth: a sigmoid times D65.
    fn smooth(colour: [f64; 3]) -> Self {
        let emission = LightUpsampler::d65(&RgbSpace::REC_709).unwrap().emission(colour).unwrap();
        Self::new(|wavelength| emission.value(wavelength))
    }

    /// Of three bands, as a lamp of red, green and blue diodes mixes it.
    fn three_bands(colour: [f64; 3]) -> Self {
        let band = |peak: f64, width: f64| Self::new(move |w| (-0.5 * ((w - peak) / width).powi(2)).exp());
        let bands = [band(625.0, 9.0), band(525.0, 14.0), band(460.0, 10.0)];
        let colours = bands.each_ref().map(Self::colour);
        let weights = solve(core::array::from_fn(|row| colours.map(|c| c[row])), colour);
        assert!(weights.iter().all(|w| *w > 0.0), "{weights:?}");
        let values = (0..bands[0].0.len()).map(|i| bands.iter().zip(weights).map(|(b, w)| w * b.1[i]).sum());
        Self(bands[0].0.clone(), values.collect())
    }

    /// As a picture has it: Y is 1 for a flat radiance of 1.
    fn colour(&self) -> [f64; 3] {
        let spectrum = PiecewiseLinear::new(&self.0, &self.1, Outside::Zero).unwrap();
        let observer = Observer::cie_1931_2deg();
        let flat = PiecewiseLinear::new(&[380.0, 780.0], &[1.0, 1.0], Outside::Zero).unwrap();
        let unit = tristimulus(&observer, &flat, 380.0, 780.0)[1];
        rgb::xyz_to_linear_rgb(tristimulus(&observer, &spectrum, 380.0, 780.0).map(|c| c / unit))
    }

    fn shining_in(&self, name: &str) -> Scene {
        let Some(Source::Memory { name, xml, assets }) = builtin::source(name) else { panic!("not built in") };
        let spectrum = |scale: f64| {
            let pairs: Vec<_> = self.0.iter().zip(&self.1).map(|(w, v)| format!("{w}:{}", scale * v)).collect();
            format!("<spectrum name=\"radiance\" value=\"{}\"/>", pairs.join(", "))
        };
        // Lights are written as <spectrum type="d65" name="radiance"> <float name="scale" value="…"/> </spectrum>.
        let mut pieces = xml.split("<spectrum type=\"d65\" name=\"radiance\">");
        let mut changed = pieces.next().unwrap().to_owned();
        for piece in pieces {
            let (scale, rest) = piece.split_once("</spectrum>").unwrap();
            changed += &spectrum(scale.split('"').nth(3).unwrap().parse().unwrap());
            changed += rest;
        }
        assert!(changed != xml && !changed.contains("d65"));
        let xml = changed;
        scene::load(&Source::Memory { name, xml, assets }, &[]).unwrap()
    }
}

/// The solution of three linear equations, by Cramer's rule.
fn solve(matrix: [[f64; 3]; 3], right: [f64; 3]) -> [f64; 3] {
    let determinant = |[a, b, c]: [[f64; 3]; 3]| {
        a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0]) + a[2] * (b[0] * c[1] - b[1] * c[0])
    };
    core::array::from_fn(|column| {
        let mut changed = matrix;
        changed.iter_mut().zip(right).for_each(|(row, r)| row[column] = r);
        determinant(changed) / determinant(matrix)
    })
}

fn truth(scene: &Scene) -> Picture {
    let options =
        Options { spectra: Spectra::Uniform(401), size: Some([96, 96]), samples: Some(4), ..Options::default() };
    render(scene, &options, &|_| {}).unwrap().picture
}

fn error(relit: &Picture, right: &Picture) -> Comparison {
    difference(relit, right, &CompareOptions::default()).unwrap().statistics()
}

/// The errors of doing nothing, of the classical and of the bilinear operator, from file to file.
fn errors(label: &str, scene: &str, light: impl Fn([f64; 3]) -> Light) -> [Comparison; 3] {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("relight_truth").join(label);
    fs::create_dir_all(&folder).unwrap();
    let [before, right] = [SKY, YELLOW].map(|colour| {
        let light = light(colour);
        for (own, wanted) in light.colour().into_iter().zip(colour) {
            assert!((own - wanted).abs() <= 6e-4, "{own} for {wanted}");
        }
        truth(&light.shining_in(scene))
    });
    let [input, output] = ["before.exr", "after.exr"].map(|name| folder.join(name));
    write_exr(&input, &before, &[], &[]).unwrap();
    write_exr(&folder.join("right.exr"), &right, &[], &[]).unwrap();
    let relit = |tensor, name: &str| {
        relight(&input, &output, &tensor, [SKY, YELLOW], &mut |_, _| {}).unwrap();
        fs::copy(&output, folder.join(name)).unwrap();
        error(&read_exr(&output).unwrap().picture, &right)
    };
    let all =
        [error(&before, &right), relit(Tensor::classical(), "classical.exr"), relit(Tensor::rec_709(), "bilinear.exr")];
    for (name, found) in ["none", "classical", "bilinear"].iter().zip(&all) {
        let d = found.delta_e00;
        println!("{label:<24} {name:<10} mean {:7.3}  p95 {:7.3}  max {:7.3}", d.mean, d.p95, d.max);
    }
    all
}

/// Mean and 95th percentile of ΔE00 that an operator may have, and the factor by which the other one must have more of both.
fn assert_errors(label: &str, scene: &str, light: impl Fn([f64; 3]) -> Light, limits: [f64; 2], factor: f64) {
    let [none, classical, bilinear] = errors(label, scene, light).map(|found| found.delta_e00);
    assert!(bilinear.mean <= limits[0] && bilinear.p95 <= limits[1], "{label}: {bilinear:?}");
    assert!(factor * bilinear.mean <= classical.mean, "{label}: {bilinear:?}, {classical:?}");
    assert!(factor * bilinear.p95 <= classical.p95, "{label}: {bilinear:?}, {classical:?}");
    // Without relighting, the pictures are nothing alike: there is something to be right about.
    assert!(4.0 * classical.mean <= none.mean, "{label}: {classical:?}, {none:?}");
}

// Measured at 128² pixels: bilinear 0.70 and 3.4, classical 1.95 and 9.2.
#[test]
fn a_box_under_smooth_lights() {
    assert_errors("cornell-box-smooth", "cornell-box", Light::smooth, [0.8, 3.7], 2.5);
}

// Bilinear 1.07 and 5.7, classical 3.44 and 17.3.
#[test]
fn a_box_under_lights_of_three_bands() {
    assert_errors("cornell-box-bands", "cornell-box", Light::three_bands, [1.2, 6.3], 2.5);
}

// Bilinear 1.42 and 4.7, classical 2.58 and 9.1.
#[test]
fn saturated_paints_under_smooth_lights() {
    assert_errors("cornell-box-paper-smooth", "cornell-box-paper", Light::smooth, [1.6, 5.2], 1.7);
}
