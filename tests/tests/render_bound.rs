//! The bound of ΔE*ab that comes with every pixel, against renderings by uniform bins of the same rays.
//!
//! The reference is `uniform:401`; what its own bins put it off by is measured, as its largest difference to
//! `uniform:4000`: 0.005 for the continuous lights, 1.7 for the lines of sodium, which therefore have a finer reference too.
#![allow(clippy::panic, clippy::unwrap_used, reason = "helpers of tests fail by panicking")]
#![allow(clippy::print_stdout, reason = "the figures behind the verdict are shown with --nocapture")]

use renderers::image::Picture;
use renderers::render::{Options, Renderer, Rendering, Spectra, render};
use renderers::scene::{Emitter, Scene, SpectrumKind, builtin};
use renderers::spectral::IntervalSettings;
use spectral_core::adaptive::Mode;
use spectral_core::colour::rgb::{WHITE, linear_rgb_to_xyz};
use spectral_core::colour::{delta_e_ab, xyz_to_lab};

const SIDE: u32 = 96;
const SAMPLES: u32 = 4;
const THRESHOLDS: [f64; 3] = [0.3, 1.0, 3.0];

fn rendering(name: &str, samples: u32, spectra: Spectra) -> Rendering {
    let scene = builtin::load(name, &[]).unwrap();
    let options = Options { spectra, size: Some([SIDE, SIDE]), samples: Some(samples), ..Options::default() };
    render(&scene, &options, &|_| {}).unwrap()
}

fn by_intervals(name: &str, samples: u32, mode: Mode, threshold: f64) -> Rendering {
    rendering(name, samples, Spectra::Interval(IntervalSettings { mode, threshold, white: 1.0 }))
}

/// ΔE*ab at each pixel, relative to the white of Rec. 709 at Y = 1.
fn differences(first: &Picture, second: &Picture) -> Vec<f64> {
    let lab = |pixel: &[f32; 3]| xyz_to_lab(linear_rgb_to_xyz(pixel.map(f64::from)), WHITE);
    first.pixels().iter().zip(second.pixels()).map(|(a, b)| delta_e_ab(lab(a), lab(b))).collect()
}

fn largest(values: &[f64]) -> f64 {
    values.iter().copied().fold(0.0, f64::max)
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / f64::from(SIDE * SIDE)
}

/// A picture by uniform bins.
struct Reference {
    name: &'static str,
    picture: Picture,
    /// The largest ΔE*ab to the picture by the finer bins.
    discretisation: f64,
}

impl Reference {
    fn new(name: &'static str, [bins, finer]: [usize; 2]) -> Self {
        let [picture, fine] = [bins, finer].map(|bins| rendering(name, SAMPLES, Spectra::Uniform(bins)).picture);
        let discretisation = largest(&differences(&picture, &fine));
        println!("{name}: uniform:{bins} is within {discretisation:.4} of uniform:{finer}");
        Self { name, picture, discretisation }
    }

    /// The bound and the difference to the reference at each pixel.
    fn judge(&self, mode: Mode, threshold: f64) -> Vec<(f64, f64)> {
        let found = by_intervals(self.name, SAMPLES, mode, threshold);
        let pairs: Vec<_> = bounds(&found).into_iter().zip(differences(&found.picture, &self.picture)).collect();
        let (bounds, errors): (Vec<_>, Vec<_>) = pairs.iter().copied().unzip();
        let [bound, most_bound, error, most_error] = [mean(&bounds), largest(&bounds), mean(&errors), largest(&errors)];
        println!(
            "{}, {mode:?}, {threshold}: bound {bound:.3} to {most_bound:.3}, error {error:.4} to {most_error:.4}",
            self.name
        );
        pairs
    }

    fn broken(&self, pairs: &[(f64, f64)]) -> usize {
        pairs.iter().filter(|(bound, error)| !(*error <= bound + self.discretisation)).count()
    }

    /// The certified bound holds at every pixel, and is at or under the threshold.
    fn assert_certified(&self) {
        for threshold in THRESHOLDS {
            let pairs = self.judge(Mode::Certified, threshold);
            assert_eq!(self.broken(&pairs), 0, "{}, {threshold}: pixels off by more than their bound", self.name);
            let above = pairs.iter().filter(|(bound, _)| !(*bound <= threshold)).count();
            assert_eq!(above, 0, "{}: pixels with a bound above {threshold}", self.name);
        }
    }
}

fn bounds(rendering: &Rendering) -> Vec<f64> {
    rendering.delta_e.as_ref().unwrap().pixels().iter().map(|bound| f64::from(*bound)).collect()
}

#[test]
fn the_certified_bound_holds_and_meets_the_threshold() {
    for name in ["cornell-box", "cornell-box-sodium", "cornell-box-lamp", "cornell-box-paper"] {
        Reference::new(name, [401, 4000]).assert_certified();
    }
}

/// Under the lines, 401 bins are coarser than what the bound promises.
#[test]
fn the_certified_bound_holds_under_sodium_for_a_fine_reference() {
    let reference = Reference::new("cornell-box-sodium", [4000, 40_000]);
    reference.assert_certified();
    assert!(reference.discretisation <= 0.3 * THRESHOLDS[0], "{}", reference.discretisation);
}

/// The control: a bound that drops products' second order is seen to be broken by the same test.
#[test]
fn the_papers_bound_breaks_under_sodium() {
    let reference = Reference::new("cornell-box-sodium", [401, 4000]);
    for threshold in THRESHOLDS {
        let broken = reference.broken(&reference.judge(Mode::Paper, threshold));
        println!("the paper's bound {threshold} is broken at {broken} pixels");
        assert!(broken >= (SIDE * SIDE / 20) as usize, "{threshold}: {broken}");
    }
}

/// Refracted paths make the bound an estimate: it is reported, the mean error keeps the threshold, and pixels without such
/// paths are bounded as ever.
#[test]
fn with_dispersion_the_bound_is_an_estimate() {
    let name = "cornell-box-spheres";
    let [coarse, fine] = [401, 1203].map(|bins| rendering(name, 1, Spectra::Uniform(bins)).picture);
    for threshold in THRESHOLDS {
        let found = by_intervals(name, 1, Mode::Certified, threshold);
        let errors = differences(&found.picture, &coarse);
        let paths = found.path_delta_e.as_ref().unwrap().pixels();
        let discretisations = differences(&coarse, &fine);
        let discretisation =
            discretisations.iter().zip(paths).filter(|(_, path)| **path == 0.0).map(|(d, _)| *d).fold(0.0, f64::max);
        let (mut deferred, mut off) = (0, 0);
        for ((error, bound), path) in errors.iter().zip(bounds(&found)).zip(paths) {
            if *path > 0.0 {
                deferred += 1;
                off += u32::from(!(*error <= bound));
            } else {
                assert!(*error <= bound + discretisation, "{threshold}: {error} above {bound}");
            }
        }
        println!(
            "{name}, {threshold}: error {:.4} to {:.3}; refracted pixels: {deferred}, {off} above their estimate; discretisation elsewhere {discretisation:.4}",
            mean(&errors),
            largest(&errors)
        );
        assert!(mean(&errors) <= threshold);
        assert!(deferred > 100 && f64::from(off) <= 0.05 * f64::from(deferred), "{threshold}: {off} of {deferred}");
    }
}

/// Iehl and Péroche split 80 % of the Cornell box's pixels into 6 or 7 intervals at a threshold of 3 (their figure 8).
#[test]
fn four_certified_intervals_serve_four_pixels_of_five_under_d65() {
    for name in ["cornell-box", "cornell-box-paper"] {
        let found = by_intervals(name, SAMPLES, Mode::Certified, 3.0);
        let few = found.intervals.pixels().iter().filter(|count| **count <= 4.0).count();
        assert!(10 * few >= 8 * found.intervals.pixels().len(), "{name}: {few}");
        assert!(largest(&bounds(&found)) <= 3.0, "{name}");
    }
}

/// A scene whose lights are scaled.
fn dimmed(name: &str, factor: f64) -> Scene {
    let mut scene = builtin::load(name, &[]).unwrap();
    let radiances: Vec<_> = scene
        .emitters
        .iter()
        .filter_map(|emitter| if let Emitter::Area { radiance, .. } = emitter { Some(*radiance) } else { None })
        .collect();
    for radiance in radiances {
        match &mut scene.spectra[radiance.0].kind {
            SpectrumKind::Table { values, .. } => values.iter_mut().for_each(|v| *v *= factor),
            SpectrumKind::D65 { scale } => *scale *= factor,
            other => panic!("{name} has another light: {other:?}"),
        }
    }
    scene
}

/// What is white decides what a difference is: a scene in other units takes the same intervals to the same bounds.
#[test]
fn thresholds_are_relative_to_white() {
    const FACTOR: f64 = 1.0 / 64.0;
    let mean = |rendering: &Rendering| {
        rendering.intervals.pixels().iter().map(|count| f64::from(*count)).sum::<f64>() / f64::from(SIDE * SIDE)
    };
    for renderer in [Renderer::Whitted, Renderer::Radiosity] {
        for name in ["cornell-box", "cornell-box-lamp"] {
            let by = |scene: &Scene, white: f64| {
                let spectra = Spectra::Interval(IntervalSettings { white, ..IntervalSettings::default() });
                let options =
                    Options { renderer, spectra, size: Some([SIDE, SIDE]), samples: Some(1), ..Options::default() };
                render(scene, &options, &|_| {}).unwrap()
            };
            let dim = dimmed(name, FACTOR);
            let [bright, same, careless] = [by(&dimmed(name, 1.0), 1.0), by(&dim, FACTOR), by(&dim, 1.0)];
            let apart = bounds(&bright).iter().zip(bounds(&same)).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            println!("{name}, {renderer:?}: {} intervals, {} if white is too bright", mean(&same), mean(&careless));
            assert!(apart <= 1e-6, "{name}, {renderer:?}: {apart}");
            assert_eq!(bright.intervals.pixels(), same.intervals.pixels(), "{name}, {renderer:?}");
            assert!(mean(&careless) < mean(&same), "{name}, {renderer:?}");
        }
    }
}
