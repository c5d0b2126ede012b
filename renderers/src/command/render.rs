//! `spectral render`: a scene to pictures.

use std::path::{Path, PathBuf};
use std::sync::RwLock;

use clap::{Args, ValueEnum};
use renderers::image::{FalseColour, ImageError, Picture, ScalarMap, Scale, write_exr, write_hdr, write_png};
use renderers::path;
use renderers::progress::Progress;
use renderers::render::{self, BetweenOptions, BetweenReport, Options, Rendering, Spectra, Watch};
use renderers::report::{ChartLabels, Histogram, Table};
use renderers::scene::{self, Scene, builtin};
use renderers::spectral::{Functional, IntervalSettings, Steering};
use serde_json::json;
use spectral_core::adaptive::Mode;
use spectral_core::colour::rgb::linear_rgb_to_xyz;

use super::gather::{self, GatherArguments};
use super::photons::{self, PhotonArguments};
use super::spectral_exr::{Channels, Spectral, parse_channels};
use super::{Answer, Failure};

/// The most pixels along a side, and rays in a pixel, that are taken for meant.
const MAX_SIDE: u32 = 16_384;
pub(super) const MAX_SAMPLES: u32 = 65_536;

/// Bins of spectra that paths carry, by default: 4.9 nm each.
const PATH_BINS: usize = 81;

/// What `spectral render` takes.
#[derive(Debug, Args)]
pub(super) struct Arguments {
    /// A Mitsuba 3 XML file or the name of a built-in scene (`spectral scene` lists them).
    #[arg(default_value = builtin::DEFAULT)]
    scene: String,
    /// How light is gathered.
    #[arg(long, value_enum, default_value_t = Renderer::Whitted)]
    renderer: Renderer,
    /// How spectra are represented: interval (the default; not for path), uniform:N (N equal bins; path's default is uniform:81),
    /// or three components: rgb (their naive product), rgb-prefiltered (for the dominant light), bilinear (or bilinear:R,G,B, with α, the
    /// transfer into each), smits (made into spectra).
    #[arg(long, value_parser = parse_spectra)]
    spectra: Option<Representation>,
    /// How errors of intervals are taken; certified by default.
    #[arg(long, value_enum)]
    bound: Option<Bound>,
    /// The ΔE*ab that each pixel's bound must meet; 1 by default.
    #[arg(long, value_name = "DE", allow_negative_numbers = true)]
    threshold: Option<f64>,
    /// Image size; the scene's by default.
    #[arg(long, value_name = "WxH", value_parser = parse_size)]
    size: Option<[u32; 2]>,
    /// Camera rays per pixel; the scene's by default.
    #[arg(long, value_name = "N")]
    spp: Option<u32>,
    /// Seed of the sample positions; the scene's by default.
    #[arg(long, value_name = "N")]
    seed: Option<u64>,
    /// What the PNG picture is multiplied by, and what thresholds and bounds take white by; scenes in cd and lm want some hundreds. The EXR stays as it
    /// is.
    #[arg(long, value_name = "FACTOR", default_value_t = 1.0)]
    exposure: f32,
    /// The relative error of light between surfaces that radiosity aims at; 0.02 by default.
    #[arg(long, value_name = "SHARE", allow_negative_numbers = true)]
    accuracy: Option<f64>,
    /// Gather light between surfaces for every camera ray instead of interpolating it.
    #[arg(long)]
    exact: bool,
    /// What decides which lights are looked for and which rays go on: brightness (∫σȳ), constant (∫σ) or intensity (max σ) of lights' spectra,
    /// and after a comma that of the reflectances met, which is the intensity by default.
    #[arg(long, value_name = "LIGHTS[,PATHS]", value_parser = parse_steering)]
    steering: Option<Steering>,
    #[command(flatten)]
    photons: PhotonArguments,
    #[command(flatten)]
    gather: GatherArguments,
    /// Path tracing goes on from this file if it is there, up to --spp samples altogether, and keeps its state in it.
    #[arg(long, value_name = "FILE")]
    resume: Option<PathBuf>,
    /// Write the picture as a Radiance file, too: linear RGB with a common exponent, negative values cut off.
    #[arg(long)]
    hdr: bool,
    /// Write spectral radiances, W/(m² sr nm), as an EXR in the layout of Fichet et al. 2021, too: at every so many nm from 380 to 780 (5nm if
    /// nothing is said; lights with finer tables by means over as many nm), or N means over equal parts of 380–780 nm. With --spectra uniform:N it
    /// has those N means; other spectra are rendered besides.
    #[arg(long, value_name = "STEPnm|N", value_parser = parse_channels, num_args = 0..=1, default_missing_value = "5nm")]
    spectral_exr: Option<Channels>,
    /// Folder for the pictures; made if it isn't there.
    #[arg(long, value_name = "DIR", default_value = "out")]
    out: PathBuf,
    /// Values for the scene's parameters ($name in the file).
    #[arg(short = 'D', value_name = "NAME=VALUE", value_parser = parse_define)]
    define: Vec<(String, String)>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Renderer {
    /// Direct light, mirrors and glass, with a constant ambient term.
    Whitted,
    /// The same, with all light between diffuse surfaces.
    Radiosity,
    /// The same, with light by way of mirrors and glass, as photons.
    PhotonMap,
    /// All light, without bias, by paths at random: the ground truth.
    Path,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Representation {
    Interval,
    Uniform(usize),
    Rgb,
    RgbPrefiltered,
    Bilinear,
    BilinearAlpha([f64; 3]),
    Smits,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Bound {
    Paper,
    Corrected,
    Certified,
}

fn parse_spectra(text: &str) -> Result<Representation, String> {
    let alpha = || -> Option<[f64; 3]> {
        let parts = text.strip_prefix("bilinear:")?.split(',').map(str::parse).collect::<Result<Vec<_>, _>>().ok()?;
        parts.try_into().ok()
    };
    let uniform = || text.strip_prefix("uniform:")?.parse().ok().filter(|n| (1..=4000).contains(n));
    match text {
        "interval" => Ok(Representation::Interval),
        "rgb" => Ok(Representation::Rgb),
        "rgb-prefiltered" => Ok(Representation::RgbPrefiltered),
        "bilinear" => Ok(Representation::Bilinear),
        "smits" => Ok(Representation::Smits),
        _ => uniform().map(Representation::Uniform).or_else(|| alpha().map(Representation::BilinearAlpha)).ok_or_else(|| {
            "expected interval, rgb, rgb-prefiltered, bilinear, bilinear:R,G,B with the transfer into each, smits or uniform:N with N from 1 \
             to 4000"
                .to_owned()
        }),
    }
}

fn parse_steering(text: &str) -> Result<Steering, String> {
    let function = |name: &str| {
        [Functional::Brightness, Functional::Constant, Functional::Intensity]
            .into_iter()
            .find(|f| f.to_string() == name)
    };
    let (lights, paths) = text.split_once(',').unwrap_or((text, "intensity"));
    let steering = function(lights).zip(function(paths)).map(|(lights, paths)| Steering { lights, paths });
    steering.ok_or_else(|| "expected brightness, constant or intensity, or two of them with a comma between".to_owned())
}

pub(super) fn parse_size(text: &str) -> Result<[u32; 2], String> {
    let side = |s: &str| s.parse().ok().filter(|n| (1..=MAX_SIDE).contains(n));
    let size = text.split_once('x').and_then(|(w, h)| Some([side(w)?, side(h)?]));
    size.ok_or_else(|| format!("expected WIDTHxHEIGHT, each from 1 to {MAX_SIDE}"))
}

pub(super) fn parse_define(text: &str) -> Result<(String, String), String> {
    let (name, value) = text.split_once('=').ok_or("expected NAME=VALUE")?;
    Ok((name.to_owned(), value.to_owned()))
}

impl Arguments {
    pub(super) fn run(self) -> Result<Answer, Failure> {
        self.run_watched(&Bars::default())
    }

    /// The same; `watch` is told how far it is.
    pub(super) fn run_watched(self, watch: &dyn Watch) -> Result<Answer, Failure> {
        let options = self.options()?;
        let scene = self.load()?;
        make_folder(&self.out)?;
        let warnings = super::warn(&scene);
        let spectral = self.spectral(&scene, &options)?;
        let rendering = match &self.resume {
            Some(file) if self.renderer == Renderer::Path => {
                let [width, height] = options.size.unwrap_or([scene.film.width, scene.film.height]);
                watch.stage("render", u64::from(width) * u64::from(height));
                let run = path::Run { state: Some(file), ..path::Run::default() };
                path::render(&scene, &options, run, &|pixels| watch.add(pixels as u64))
            }
            _ => match &spectral {
                Some(spectral) if spectral.spectra == options.spectra => {
                    render::render_spectra(&scene, &options, watch, spectral)
                }
                _ => render::render_watched(&scene, &options, watch),
            },
        }
        .map_err(|e| Failure(format!("{}: {e}", self.scene)))?;
        if let Some(spectral) = spectral.as_ref().filter(|spectral| spectral.spectra != options.spectra) {
            let options = Options { spectra: spectral.spectra, ..options };
            render::render_spectra(&scene, &options, watch, spectral)
                .map_err(|e| Failure(format!("{}: {e}", self.scene)))?;
        }
        let report = Report { warnings, ..Report::new(&scene, &options, &rendering, self.threshold()) };
        let mut files = self.write(&report, &rendering)?;
        if let Some(spectral) = spectral {
            files.push(self.out.join(format!("{}-spectral.exr", self.stem(&report))));
            spectral.write(files.last().unwrap_or(&self.out), &rendering.picture, &report.renderer)?;
        }
        Ok(report.answer(&files))
    }

    /// A place for the spectra of pixels, if they are wanted.
    fn spectral(&self, scene: &Scene, options: &Options) -> Result<Option<Spectral>, Failure> {
        let Some(channels) = self.spectral_exr else { return Ok(None) };
        if self.renderer == Renderer::Path {
            return Err(Failure(
                "--spectral-exr is not for --renderer path, which keeps colours, not spectra".to_owned(),
            ));
        }
        let size = options.size.unwrap_or([scene.film.width, scene.film.height]).map(|s| s as usize);
        Ok(Some(Spectral::new(channels.spectra(options.spectra), size)?))
    }

    fn options(&self) -> Result<Options, Failure> {
        let threshold = self.threshold();
        if !(threshold > 0.0 && threshold.is_finite()) {
            return Err(Failure(format!("--threshold must be positive and finite, not {threshold}")));
        }
        if (self.bound.is_some() || self.threshold.is_some()) && self.representation() != Representation::Interval {
            return Err(Failure("--bound and --threshold are for --spectra interval".to_owned()));
        }
        if let Some(spp) = self.spp.filter(|n| !(1..=MAX_SAMPLES).contains(n)) {
            return Err(Failure(format!("--spp must be from 1 to {MAX_SAMPLES}, not {spp}")));
        }
        if self.resume.is_some() && self.renderer != Renderer::Path {
            return Err(Failure(
                "--resume is for --renderer path: other renderers have no samples to add to".to_owned(),
            ));
        }
        if !(self.exposure > 0.0 && self.exposure.is_finite()) {
            return Err(ImageError::Exposure(self.exposure).into());
        }
        // What the exposure makes white.
        let white = 1.0 / f64::from(self.exposure);
        let mode = match self.bound {
            Some(Bound::Paper) => Mode::Paper,
            Some(Bound::Corrected) => Mode::Corrected,
            Some(Bound::Certified) | None => Mode::Certified,
        };
        let spectra = match self.representation() {
            Representation::Interval => Spectra::Interval(IntervalSettings { mode, threshold, white }),
            Representation::Uniform(count) => Spectra::Uniform(count),
            Representation::Rgb => Spectra::Rgb,
            Representation::RgbPrefiltered => Spectra::RgbPrefiltered,
            Representation::Bilinear => Spectra::Bilinear,
            Representation::BilinearAlpha(alpha) => Spectra::BilinearAlpha(alpha),
            Representation::Smits => Spectra::Smits,
        };
        let renderer = match self.renderer {
            Renderer::Whitted => render::Renderer::Whitted,
            Renderer::Radiosity => render::Renderer::Radiosity,
            Renderer::PhotonMap => render::Renderer::PhotonMap,
            Renderer::Path => render::Renderer::Path,
        };
        let photons = self.photons.options(self.renderer == Renderer::PhotonMap)?;
        let has_light_between = match self.renderer {
            Renderer::Radiosity => true,
            Renderer::PhotonMap => photons.between != render::Between::Ambient,
            Renderer::Whitted | Renderer::Path => false,
        };
        if (self.accuracy.is_some() || self.exact) && !has_light_between {
            return Err(Failure(
                "--accuracy and --exact are for renderers that find light between surfaces".to_owned(),
            ));
        }
        let accuracy = self.accuracy.unwrap_or(BetweenOptions::default().accuracy);
        let between = BetweenOptions { accuracy, exact: self.exact };
        let gather = self.gather.options(photons.between == render::Between::Gather)?;
        let (size, samples, seed) = (self.size, self.spp, self.seed);
        let steering = self.steering;
        Ok(Options { renderer, spectra, size, samples, seed, between, photons, gather, steering })
    }

    /// The threshold asked for, or the default.
    fn threshold(&self) -> f64 {
        self.threshold.unwrap_or(1.0)
    }

    /// The representation asked for, or the renderer's default.
    fn representation(&self) -> Representation {
        self.spectra.unwrap_or(match self.renderer {
            Renderer::Whitted | Renderer::Radiosity | Renderer::PhotonMap => Representation::Interval,
            Renderer::Path => Representation::Uniform(PATH_BINS),
        })
    }

    /// A built-in scene if there is one of this name, else a file.
    fn load(&self) -> Result<Scene, Failure> {
        if builtin::source(&self.scene).is_some() {
            return Ok(builtin::load(&self.scene, &self.define)?);
        }
        Ok(scene::load(&scene::Source::disk(&self.scene), &self.define)?)
    }

    /// What files are named after.
    fn stem(&self, report: &Report) -> String {
        let bound = match (self.representation(), self.bound) {
            (Representation::Interval, Some(Bound::Paper)) => "-paper",
            (Representation::Interval, Some(Bound::Corrected)) => "-corrected",
            _ => "",
        };
        let renderer = match self.renderer {
            Renderer::Whitted => "",
            Renderer::Radiosity => "-radiosity",
            Renderer::PhotonMap => "-photon-map",
            Renderer::Path => "-path",
        };
        format!("{}{renderer}-{}{bound}", report.scene, report.spectra.replace(':', ""))
    }

    /// Writes all pictures and returns their names.
    fn write(&self, report: &Report, rendering: &Rendering) -> Result<Vec<PathBuf>, Failure> {
        let stem = self.stem(report);
        let mut files = Vec::new();
        let mut file = |suffix: &str| {
            files.push(self.out.join(format!("{stem}{suffix}")));
            files.last().cloned().unwrap_or_default()
        };
        write_png(&file(".png"), &rendering.picture, self.exposure)?;
        let mut channels = vec![("intervals", &rendering.intervals)];
        channels.extend(rendering.delta_e.as_ref().map(|map| ("delta_e.bound", map)));
        channels.extend(rendering.path_delta_e.as_ref().map(|map| ("delta_e.path", map)));
        channels.extend(rendering.photon_delta_e.as_ref().map(|map| ("delta_e.photons", map)));
        write_exr(&file(".exr"), &rendering.picture, &channels, &[])?;
        if self.hdr {
            write_hdr(&file(".hdr"), &rendering.picture)?;
        }
        if let Some(variance) = &rendering.variance {
            write_exr(&file("-variance.exr"), &variance.rgb, &[("Y", &variance.luminance)], &[])?;
        }
        if let Some(bound) = &rendering.delta_e {
            FalseColour::counts("Intervals", &rendering.intervals)
                .write_png(&file("-intervals.png"), &rendering.intervals)?;
            FalseColour::new("Bound of ΔE*ab", 0.0, self.threshold()).write_png(&file("-bound.png"), bound)?;
            let title = format!("Intervals per pixel, threshold {}", self.threshold());
            let labels = ChartLabels { title: &title, values: "intervals", counts: "pixels" };
            report.intervals.write_png(&file("-interval-histogram.png"), &labels, Scale::Linear)?;
            if let Some(errors) = &report.errors {
                let title = format!("Bound of ΔE*ab per pixel, threshold {}", self.threshold());
                let labels = ChartLabels { title: &title, values: "bound of ΔE*ab", counts: "pixels" };
                errors.write_png(&file("-bound-histogram.png"), &labels, Scale::Linear)?;
            }
        }
        Ok(files)
    }
}

pub(super) fn make_folder(folder: &Path) -> Result<(), Failure> {
    std::fs::create_dir_all(folder).map_err(|e| Failure(format!("{}: {e}", folder.display())))
}

/// A progress bar for each stage.
#[derive(Default)]
pub(super) struct Bars(RwLock<Option<Progress>>);

impl Watch for Bars {
    fn stage(&self, name: &str, steps: u64) {
        if let Ok(mut bar) = self.0.write() {
            // The old one is wiped before the new one appears.
            *bar = None;
            *bar = Some(Progress::new(name, steps));
        }
    }

    fn add(&self, steps: u64) {
        if let Ok(bar) = self.0.read() {
            bar.iter().for_each(|bar| bar.add(steps));
        }
    }
}

/// What a rendering is summed up to.
struct Report {
    scene: String,
    renderer: String,
    spectra: String,
    size: [usize; 2],
    seconds: [f64; 2],
    rays: u64,
    samples: u32,
    /// Mean over pixels of the luminance and of its standard error.
    noise: Option<[f64; 2]>,
    intervals: Histogram,
    interval_mean: f64,
    interval_max: f64,
    /// Mean and maximum of the bound, of its part that comes of deferred paths, and the share of pixels above the threshold.
    bound: Option<[f64; 4]>,
    errors: Option<Histogram>,
    threshold: f64,
    steering: Option<String>,
    between: Option<BetweenReport>,
    gather: Option<render::GatherReport>,
    photons: Option<photons::Summary>,
    warnings: Vec<String>,
}

impl Report {
    fn new(scene: &Scene, options: &Options, rendering: &Rendering, threshold: f64) -> Self {
        let [interval_mean, interval_max] = mean_and_max(&rendering.intervals);
        let bound = rendering.delta_e.as_ref().map(|map| {
            let [mean, max] = mean_and_max(map);
            let [path, _] = rendering.path_delta_e.as_ref().map_or([0.0; 2], mean_and_max);
            let above = map.pixels().iter().filter(|e| !(f64::from(**e) <= threshold)).count();
            #[allow(clippy::cast_precision_loss, reason = "a share of pixels")]
            let share = above as f64 / map.pixels().len() as f64;
            [mean, max, path, share]
        });
        let errors = rendering
            .delta_e
            .as_ref()
            .and_then(|map| Histogram::of_values(map.pixels().iter().map(|e| f64::from(*e)), 0.0, threshold, 24).ok());
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "whole numbers of intervals")]
        let counts = rendering.intervals.pixels().iter().map(|n| *n as usize);
        Self {
            scene: scene.name.clone(),
            renderer: options.renderer.to_string(),
            spectra: options.spectra.to_string(),
            size: [rendering.picture.width(), rendering.picture.height()],
            seconds: [rendering.seconds, rendering.preparation_seconds],
            rays: rendering.rays,
            samples: rendering.samples,
            noise: rendering.variance.as_ref().map(|v| noise(&rendering.picture, v)),
            intervals: Histogram::of_counts(counts),
            interval_mean,
            interval_max,
            bound,
            errors,
            threshold,
            steering: options.steering.map(|steering| steering.to_string()),
            between: rendering.between,
            gather: rendering.gather,
            photons: photons::Summary::new(rendering),
            warnings: Vec::new(),
        }
    }

    fn answer(&self, files: &[PathBuf]) -> Answer {
        Answer { text: self.text(files), json: self.json(files) }
    }

    fn text(&self, files: &[PathBuf]) -> String {
        let mut table = Table::new(["quantity", "value"]);
        let [width, height] = self.size;
        table.row(["scene".to_owned(), self.scene.clone()]);
        table.row(["spectra".to_owned(), self.spectra.clone()]);
        if let Some(steering) = &self.steering {
            table.row(["steering: lights, paths".to_owned(), steering.replace(',', ", ")]);
        }
        table.row(["size".to_owned(), format!("{width} × {height}")]);
        table.row(["seconds (preparation)".to_owned(), format!("{:.3} ({:.3})", self.seconds[0], self.seconds[1])]);
        if let Some([luminance, error]) = self.noise {
            table.row(["samples per pixel".to_owned(), self.samples.to_string()]);
            table.row(["rays, with shadow rays".to_owned(), self.rays.to_string()]);
            table.row(["luminance, mean".to_owned(), format!("{luminance:.5}")]);
            table.row(["standard error of a pixel's, mean".to_owned(), format!("{error:.5}")]);
        } else {
            table.row(["rays, shadow rays not counted".to_owned(), self.rays.to_string()]);
        }
        if let Some(between) = &self.between {
            let radiosity = &between.radiosity;
            let [build, solve, gather] = between.seconds;
            table.row(["patches, links".to_owned(), format!("{}, {}", radiosity.patches, radiosity.links)]);
            table.row(["iterations".to_owned(), radiosity.iterations.to_string()]);
            table.row(["residual".to_owned(), format!("{:.1e}", radiosity.residual)]);
            table.row(["energy balance".to_owned(), format!("{:.1e}", radiosity.energy_balance)]);
            table.row(["gathers".to_owned(), between.gathers.to_string()]);
            table.row(["seconds: build, solve, gather".to_owned(), format!("{build:.3}, {solve:.3}, {gather:.3}")]);
        }
        if let Some(report) = &self.gather {
            gather::rows(report, &mut table);
        }
        if let Some(photons) = &self.photons {
            photons.rows(&mut table);
        }
        table.row(["intervals, mean".to_owned(), format!("{:.2}", self.interval_mean)]);
        table.row(["intervals, maximum".to_owned(), format!("{}", self.interval_max)]);
        if let Some([mean, max, path, above]) = self.bound {
            let shown = if mean < 1e6 { format!("{mean:.3}") } else { format!("{mean:.1e}") };
            table.row(["bound of ΔE*ab, mean".to_owned(), shown]);
            let shown = if max < 1e6 { format!("{max:.3}") } else { format!("{max:.1e}") };
            table.row(["bound of ΔE*ab, maximum".to_owned(), shown]);
            if path > 0.0 {
                table.row(["of it estimated, from refracted paths, mean".to_owned(), format!("{path:.3}")]);
            }
            table.row([format!("pixels above {}", self.threshold), format!("{:.2} %", 100.0 * above)]);
        }
        let mut text = table.to_string();
        if self.bound.is_some() {
            text += "\nintervals per pixel\n";
            text += &self.intervals.to_text(40);
            if let Some(errors) = &self.errors {
                text += "\nbound of ΔE*ab per pixel\n";
                text += &errors.to_text(40);
            }
        }
        if let Some(photons) = &self.photons {
            text += &photons.text();
        }
        text += "\n";
        for file in files {
            text += &format!("{}\n", file.display());
        }
        text
    }

    fn json(&self, files: &[PathBuf]) -> serde_json::Value {
        let [width, height] = self.size;
        let bound = self.bound.map(|[mean, max, path, above]| {
            json!({ "mean": mean, "max": max, "path_mean": path, "share_above_threshold": above })
        });
        let between = self.between.as_ref().map(|between| {
            let radiosity = &between.radiosity;
            let [build, solve, gather] = between.seconds;
            json!({
                "patches": radiosity.patches,
                "links": radiosity.links,
                "iterations": radiosity.iterations,
                "residual": radiosity.residual,
                "energy_balance": radiosity.energy_balance,
                "gathers": between.gathers,
                "seconds": { "build": build, "solve": solve, "gather": gather, "trace": self.seconds[0] },
            })
        });
        json!({
            "scene": self.scene,
            "renderer": self.renderer,
            "spectra": self.spectra,
            "steering": self.steering,
            "width": width,
            "height": height,
            "seconds": self.seconds[0],
            "preparation_seconds": self.seconds[1],
            "samples": self.samples,
            "luminance_mean": self.noise.map(|[luminance, _]| luminance),
            "luminance_standard_error_mean": self.noise.map(|[_, error]| error),
            "rays": self.rays,
            "intervals": {
                "mean": self.interval_mean,
                "max": self.interval_max,
                "histogram": self.intervals.counts(),
            },
            "delta_e_bound": bound,
            "delta_e_bound_histogram": self.errors.as_ref().map(Histogram::counts),
            "pixels_outside_bound_histogram": self.errors.as_ref().map(Histogram::outside),
            "radiosity": between,
            "gather": self.gather.as_ref().map(|report| gather::json(report, self.seconds[0])),
            "photon_map": self.photons.as_ref().map(photons::Summary::json),
            "warnings": self.warnings,
            "files": files,
        })
    }
}

/// Mean over pixels of the luminance and of its standard error.
fn noise(picture: &Picture, variance: &render::Variance) -> [f64; 2] {
    #[allow(clippy::cast_precision_loss, reason = "a count of pixels")]
    let count = picture.pixels().len() as f64;
    let luminance = picture.pixels().iter().map(|p| linear_rgb_to_xyz(p.map(f64::from))[1]).sum::<f64>();
    let error = variance.luminance.pixels().iter().map(|v| f64::from(*v).sqrt()).sum::<f64>();
    [luminance / count, error / count]
}

pub(super) fn mean_and_max(map: &ScalarMap) -> [f64; 2] {
    let values = || map.pixels().iter().map(|v| f64::from(*v));
    #[allow(clippy::cast_precision_loss, reason = "a count of pixels")]
    let count = map.pixels().len() as f64;
    [values().sum::<f64>() / count, values().fold(0.0, f64::max)]
}
