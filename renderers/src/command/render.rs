//! `spectral render`: a scene to pictures.

use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use renderers::image::{FalseColour, ScalarMap, write_exr, write_png};
use renderers::render::{Options, Rendering, Spectra, render};
use renderers::scene::{self, Scene, builtin};
use renderers::spectral::IntervalSettings;
use spectral_core::adaptive::Mode;

use super::{Answer, Failure};

/// The most pixels along a side, and rays in a pixel, that are taken for meant.
const MAX_SIDE: u32 = 16_384;
const MAX_SAMPLES: u32 = 65_536;

/// What `spectral render` takes.
#[derive(Debug, Args)]
pub(super) struct Arguments {
    /// A Mitsuba 3 XML file or the name of a built-in scene (`spectral scene` lists them).
    #[arg(default_value = builtin::DEFAULT)]
    scene: String,
    /// How light is gathered.
    #[arg(long, value_enum, default_value_t = Renderer::Whitted)]
    renderer: Renderer,
    /// How spectra are represented: interval, uniform:N (N equal bins) or rgb (naive product of components).
    #[arg(long, default_value = "interval", value_parser = parse_spectra)]
    spectra: Representation,
    /// How errors of intervals are taken.
    #[arg(long, value_enum, default_value_t = Bound::Certified)]
    bound: Bound,
    /// The ΔE*ab that each pixel's bound must meet.
    #[arg(long, value_name = "DE", default_value_t = 1.0)]
    threshold: f64,
    /// Image size; the scene's by default.
    #[arg(long, value_name = "WxH", value_parser = parse_size)]
    size: Option<[u32; 2]>,
    /// Camera rays per pixel; the scene's by default.
    #[arg(long, value_name = "N")]
    spp: Option<u32>,
    /// Seed of the sample positions; the scene's by default.
    #[arg(long, value_name = "N")]
    seed: Option<u64>,
    /// Folder for the pictures; made if it isn't there.
    #[arg(long, value_name = "DIR", default_value = "out")]
    out: PathBuf,
    /// Values for the scene's parameters ($name in the file).
    #[arg(short = 'D', value_name = "NAME=VALUE", value_parser = parse_define)]
    define: Vec<(String, String)>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Renderer {
    Whitted,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Representation {
    Interval,
    Uniform(usize),
    Rgb,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Bound {
    Paper,
    Corrected,
    Certified,
}

fn parse_spectra(text: &str) -> Result<Representation, String> {
    let uniform = || text.strip_prefix("uniform:")?.parse().ok().filter(|n| (1..=4000).contains(n));
    match text {
        "interval" => Ok(Representation::Interval),
        "rgb" => Ok(Representation::Rgb),
        _ => uniform()
            .map(Representation::Uniform)
            .ok_or_else(|| "expected interval, rgb or uniform:N with N from 1 to 4000".to_owned()),
    }
}

fn parse_size(text: &str) -> Result<[u32; 2], String> {
    let side = |s: &str| s.parse().ok().filter(|n| (1..=MAX_SIDE).contains(n));
    let size = text.split_once('x').and_then(|(w, h)| Some([side(w)?, side(h)?]));
    size.ok_or_else(|| format!("expected WIDTHxHEIGHT, each from 1 to {MAX_SIDE}"))
}

fn parse_define(text: &str) -> Result<(String, String), String> {
    let (name, value) = text.split_once('=').ok_or("expected NAME=VALUE")?;
    Ok((name.to_owned(), value.to_owned()))
}

impl Arguments {
    pub(super) fn run(self) -> Result<Answer, Failure> {
        let options = self.options()?;
        let scene = self.load()?;
        let pixels = options.size.map_or([scene.film.width, scene.film.height], |s| s);
        let _ = pixels;
        let rendering = render(&scene, &options, &|_| {})
            .map_err(|e| Failure(format!("{}: {e}", self.scene)))?;
        let files = self.write(&scene, &options, &rendering)?;
        Ok(answer(&scene, &options, &rendering, &files))
    }

    fn options(&self) -> Result<Options, Failure> {
        if !(self.threshold > 0.0 && self.threshold.is_finite()) {
            return Err(Failure(format!("--threshold must be positive and finite, not {}", self.threshold)));
        }
        if let Some(spp) = self.spp.filter(|n| !(1..=MAX_SAMPLES).contains(n)) {
            return Err(Failure(format!("--spp must be from 1 to {MAX_SAMPLES}, not {spp}")));
        }
        let mode = match self.bound {
            Bound::Paper => Mode::Paper,
            Bound::Corrected => Mode::Corrected,
            Bound::Certified => Mode::Certified,
        };
        let spectra = match self.spectra {
            Representation::Interval => Spectra::Interval(IntervalSettings { mode, threshold: self.threshold }),
            Representation::Uniform(count) => Spectra::Uniform(count),
            Representation::Rgb => Spectra::Rgb,
        };
        let Renderer::Whitted = self.renderer;
        Ok(Options { spectra, size: self.size, samples: self.spp, seed: self.seed })
    }

    /// A built-in scene if there is one of this name, else a file.
    fn load(&self) -> Result<Scene, Failure> {
        if builtin::source(&self.scene).is_some() {
            return Ok(builtin::load(&self.scene, &self.define)?);
        }
        Ok(scene::load(&scene::Source::disk(&self.scene), &self.define)?)
    }

    fn write(&self, scene: &Scene, options: &Options, rendering: &Rendering) -> Result<Vec<PathBuf>, Failure> {
        std::fs::create_dir_all(&self.out).map_err(|e| Failure(format!("{}: {e}", self.out.display())))?;
        let stem = format!("{}-{}", scene.name, options.spectra.to_string().replace(':', ""));
        let path = |suffix: &str| self.out.join(format!("{stem}{suffix}"));
        let mut files = vec![path(".png"), path(".exr")];
        write_png(&files[0], &rendering.picture, 1.0)?;
        write_exr(&files[1], &rendering.picture, &channels(rendering), &[])?;
        if let Some(bound) = &rendering.delta_e {
            files.push(path("-intervals.png"));
            FalseColour::counts("intervals", &rendering.intervals).write_png(&path("-intervals.png"), &rendering.intervals)?;
            files.push(path("-bound.png"));
            FalseColour::new("bound of ΔE*ab", 0.0, self.threshold).write_png(&path("-bound.png"), bound)?;
        }
        Ok(files)
    }
}

fn channels(rendering: &Rendering) -> Vec<(&'static str, &ScalarMap)> {
    let mut channels = vec![("intervals", &rendering.intervals)];
    channels.extend(rendering.delta_e.as_ref().map(|map| ("deltaE.bound", map)));
    channels
}

fn answer(scene: &Scene, options: &Options, rendering: &Rendering, files: &[PathBuf]) -> Answer {
    let counts: Vec<f64> = rendering.intervals.pixels().iter().map(|n| f64::from(*n)).collect();
    let mean = |v: &[f64]| v.iter().sum::<f64>() / v.len() as f64;
    let max = |v: &[f64]| v.iter().copied().fold(0.0, f64::max);
    let text = format!("{} {} {:.3}s prep {:.3}s rays {} intervals mean {:.3} max {}", scene.name, options.spectra, rendering.seconds, rendering.preparation_seconds, rendering.rays, mean(&counts), max(&counts));
    let _ = files;
    Answer { text, json: serde_json::json!({}) }
}
