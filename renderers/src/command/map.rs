//! `spectral map`: lighting measures in every pixel.

use std::path::{Path, PathBuf};
use std::time::Instant;

use clap::{Args, ValueEnum};
use renderers::image::{Scale, read_spectral_exr};
use renderers::map::{self, Map, MapOptions, Of, Quantity, Style, write_values};
use renderers::render::{self, BetweenOptions};
use renderers::report::Table;
use renderers::scene::{self, Scene, builtin};
use serde_json::{Value, json};

use super::render::{Bars, MAX_SAMPLES, make_folder, parse_define, parse_size};
use super::{Answer, Failure};

/// What `spectral map` takes.
///
/// Each quantity becomes a PNG in false colour, with lines of equal value, and a channel of one EXR, NaN where there is no value: where no surface is
/// seen, where there is no light (illuminance, luminance and sy are 0 there), and outside of a measure's domain (colour temperature and indices: more than
/// 0.05 from the Planckian locus).
#[derive(Debug, Args)]
pub(super) struct Arguments {
    /// A Mitsuba 3 XML file or the name of a built-in scene (`spectral scene` lists them).
    #[arg(required_unless_present = "from", conflicts_with = "from")]
    scene: Option<String>,
    /// Map the radiances of a spectral EXR file instead (`spectral render --spectral-exr` writes them).
    #[arg(
        long,
        value_name = "FILE",
        conflicts_with_all = ["of", "renderer", "size", "spp", "accuracy", "exact", "step", "define"]
    )]
    from: Option<PathBuf>,
    /// What to map, once or more, or separated by commas: illuminance (lx), luminance (cd/m²), cct (K), duv, ra, cri00 (Munsell samples), acv,
    /// sy (W/m²), melanopic (daylight efficacy ratio).
    #[arg(long, value_name = "QUANTITY", required = true, value_delimiter = ',')]
    quantity: Vec<Quantity>,
    /// Of the light that falls on the first surface seen, or of the light that the camera receives; irradiance by default, but for luminance.
    #[arg(long, value_enum)]
    of: Option<Light>,
    /// How light is found: whitted (direct light and the scene's ambient term) or radiosity (all light between diffuse surfaces, too); by default
    /// radiosity for scenes that ask for paths, whitted for all others.
    #[arg(long, value_enum)]
    renderer: Option<Renderer>,
    /// Size of the map; the scene's by default.
    #[arg(long, value_name = "WxH", value_parser = parse_size)]
    size: Option<[u32; 2]>,
    /// Camera rays per pixel, the mean of whose light is measured; by default the middle of each pixel for irradiance, 4 for radiance.
    #[arg(long, value_name = "N")]
    spp: Option<u32>,
    /// The relative error of light between surfaces that radiosity aims at; 0.02 by default.
    #[arg(long, value_name = "SHARE", allow_negative_numbers = true)]
    accuracy: Option<f64>,
    /// Gather light between surfaces for every pixel instead of interpolating it.
    #[arg(long)]
    exact: bool,
    /// Wavelengths of sums for colour measures: every 5 nm or every nanometre; by default 5 if all lights are tables at whole multiples of 5 nm.
    #[arg(long, value_name = "NM", value_parser = ["1", "5"])]
    step: Option<String>,
    /// The numbers at the ends of the palette; by default those of 99 % of the pixels, rounded.
    #[arg(long, value_name = "LO:HI", value_parser = parse_range, allow_hyphen_values = true)]
    range: Option<[f64; 2]>,
    /// A logarithmic palette.
    #[arg(long)]
    log: bool,
    /// Leave out lines of equal value.
    #[arg(long)]
    plain: bool,
    /// Folder for the files; made if it isn't there.
    #[arg(long, value_name = "DIR", default_value = "out")]
    out: PathBuf,
    /// Values for the scene's parameters ($name in the file).
    #[arg(short = 'D', value_name = "NAME=VALUE", value_parser = parse_define)]
    define: Vec<(String, String)>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Light {
    Irradiance,
    Radiance,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Renderer {
    Whitted,
    Radiosity,
}

fn parse_range(text: &str) -> Result<[f64; 2], String> {
    let end = |text: &str| text.parse().ok().filter(|value: &f64| value.is_finite());
    let range = text.split_once(':').and_then(|(low, high)| Some([end(low)?, end(high)?]));
    range.filter(|[low, high]| low < high).ok_or_else(|| "expected LO:HI, two numbers, the lower one first".to_owned())
}

/// Maps and what is to be said of them.
struct Made {
    /// What files are named after.
    stem: String,
    maps: Vec<Map>,
    /// What found the light; `None` of stored spectra.
    renderer: Option<String>,
    step: Option<u16>,
    warnings: Vec<String>,
    start: Instant,
    /// Time for the maps alone.
    measuring: f64,
}

impl Arguments {
    pub(super) fn run(mut self) -> Result<Answer, Failure> {
        let mut known = Vec::new();
        self.quantity.retain(|quantity| {
            !known.contains(quantity) && {
                known.push(*quantity);
                true
            }
        });
        self.check()?;
        let made = match &self.from {
            Some(file) => self.of_file(file)?,
            None => self.of_scene()?,
        };
        let files = self.write(&made)?;
        Ok(answer(&made, &files))
    }

    fn check(&self) -> Result<(), Failure> {
        if self.range.is_some() && self.quantity.len() > 1 {
            return Err(Failure("--range is for one quantity".to_owned()));
        }
        if self.log && self.range.is_some_and(|[low, _]| low <= 0.0) {
            return Err(Failure("--log needs a --range above 0".to_owned()));
        }
        if self.log && self.quantity.contains(&Quantity::Duv) {
            return Err(Failure("--log is not for duv, which has both signs".to_owned()));
        }
        match self.spp.filter(|n| !(1..=MAX_SAMPLES).contains(n)) {
            Some(spp) => Err(Failure(format!("--spp must be from 1 to {MAX_SAMPLES}, not {spp}"))),
            None => Ok(()),
        }
    }

    fn of_file(&self, file: &Path) -> Result<Made, Failure> {
        let start = Instant::now();
        let stored = read_spectral_exr(file)?;
        let read = Instant::now();
        let (maps, step) = map::of_spectra(&stored.picture, &self.quantity)
            .map_err(|error| Failure(format!("{}: {error}", file.display())))?;
        let measuring = read.elapsed().as_secs_f64();
        let stem = file.file_stem().map_or_else(|| "map".to_owned(), |stem| stem.to_string_lossy().into_owned());
        Ok(Made { stem, maps, renderer: None, step: Some(step), warnings: Vec::new(), start, measuring })
    }

    fn of_scene(&self) -> Result<Made, Failure> {
        let start = Instant::now();
        let scene = self.load()?;
        let warnings = super::warn(&scene);
        let bars = Bars::default();
        let made = map::of_scene(&scene, &self.options()?, &bars)
            .map_err(|error| Failure(format!("{}: {error}", self.name())))?;
        drop(bars);
        let name =
            Path::new(self.name()).file_stem().map_or_else(|| "map".to_owned(), |s| s.to_string_lossy().into_owned());
        let renderer = made.renderer.to_string();
        let stem = format!("{name}-{renderer}");
        Ok(Made {
            stem,
            maps: made.maps,
            renderer: Some(renderer),
            step: made.step,
            warnings,
            start,
            measuring: made.seconds,
        })
    }

    fn options(&self) -> Result<MapOptions, Failure> {
        let renderer = self.renderer.map(|renderer| match renderer {
            Renderer::Whitted => render::Renderer::Whitted,
            Renderer::Radiosity => render::Renderer::Radiosity,
        });
        if (self.accuracy.is_some() || self.exact) && renderer == Some(render::Renderer::Whitted) {
            return Err(Failure(
                "--accuracy and --exact are for light between surfaces: --renderer radiosity".to_owned(),
            ));
        }
        let default = BetweenOptions::default();
        Ok(MapOptions {
            quantities: self.quantity.clone(),
            of: self.of.map(|of| match of {
                Light::Irradiance => Of::Irradiance,
                Light::Radiance => Of::Radiance,
            }),
            renderer,
            size: self.size,
            samples: self.spp,
            between: BetweenOptions { accuracy: self.accuracy.unwrap_or(default.accuracy), exact: self.exact },
            step: self.step.as_deref().and_then(|step| step.parse().ok()),
        })
    }

    fn name(&self) -> &str {
        self.scene.as_deref().unwrap_or_default()
    }

    /// A built-in scene if there is one of this name, else a file.
    fn load(&self) -> Result<Scene, Failure> {
        if builtin::source(self.name()).is_some() {
            return Ok(builtin::load(self.name(), &self.define)?);
        }
        Ok(scene::load(&scene::Source::disk(self.name()), &self.define)?)
    }

    /// Writes all files and returns their names.
    fn write(&self, made: &Made) -> Result<Vec<PathBuf>, Failure> {
        make_folder(&self.out)?;
        let style = Style {
            range: self.range,
            scale: if self.log { Scale::Logarithmic } else { Scale::Linear },
            plain: self.plain,
        };
        let mut files = Vec::new();
        for map in &made.maps {
            let of = if made.renderer.is_some() && map.of != map.quantity.default_of() { "-radiance" } else { "" };
            files.push(self.out.join(format!("{}-{}{of}.png", made.stem, map.quantity)));
            map.write_png(files.last().unwrap_or(&self.out), &style)?;
        }
        files.push(self.out.join(format!("{}-map.exr", made.stem)));
        write_values(files.last().unwrap_or(&self.out), &made.maps)?;
        Ok(files)
    }
}

fn answer(made: &Made, files: &[PathBuf]) -> Answer {
    let names: Vec<_> = files.iter().map(|file| file.display().to_string()).collect();
    let maps: Vec<Value> = made.maps.iter().map(map_json).collect();
    let mut all = maps.first().cloned().unwrap_or_else(|| json!({}));
    if let Some(object) = all.as_object_mut() {
        object.insert("maps".to_owned(), Value::Array(maps));
        object.insert("renderer".to_owned(), json!(made.renderer));
        object.insert("step".to_owned(), json!(made.step));
        object.insert("seconds".to_owned(), json!(made.start.elapsed().as_secs_f64()));
        object.insert("map_seconds".to_owned(), json!(made.measuring));
        object.insert("warnings".to_owned(), json!(made.warnings));
        object.insert("files".to_owned(), json!(names));
    }
    let mut table = Table::new(["quantity", "of", "unit", "min", "mean", "median", "max", "no value"]);
    for map in &made.maps {
        let found = &map.statistics;
        let number = |value: f64| if value.is_nan() { "–".to_owned() } else { format!("{value:.5}") };
        let [min, mean, median, max] = [found.min, found.mean, found.median, found.max].map(number);
        let words = [map.quantity.name(), &map.of.to_string(), map.quantity.unit(map.of)].map(str::to_owned);
        let missing = format!("{:.2} %", 100.0 * found.share_without_value());
        table.row(words.into_iter().chain([min, mean, median, max, missing]));
    }
    Answer { text: format!("{table}\n{}", names.join("\n")), json: all }
}

fn map_json(map: &Map) -> Value {
    let found = &map.statistics;
    json!({
        "quantity": map.quantity.name(),
        "of": map.of.to_string(),
        "unit": map.quantity.unit(map.of),
        "width": map.values.width(),
        "height": map.values.height(),
        "min": found.min,
        "max": found.max,
        "mean": found.mean,
        "median": found.median,
        "share_without_value": found.share_without_value(),
        "pixels_without_surface": found.without_surface,
        "pixels_without_light": found.without_light,
        "pixels_outside_domain": found.without_value - found.without_surface - found.without_light,
    })
}
