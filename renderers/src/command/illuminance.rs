//! `spectral illuminance`: lux at points of a scene.

use core::sync::atomic::{AtomicU64, Ordering};
use std::io::Read as _;
use std::path::{Path, PathBuf};

use clap::Args;
use rayon::prelude::*;
use renderers::illuminance::{
    ColourMeter, IndirectLight, IndirectPart, LightColour, Meter, Nanometres, Point, Reading, Settings,
    SpectralIndirect, parse_points,
};
use renderers::progress::Progress;
use renderers::radiosity::{self, IndirectRadiosity, Radiosity};
use renderers::report::Table;
use renderers::scene::{Scene, Source, builtin, load};
use renderers::spectral::{Palette, UniformBins};
use serde_json::{Value, json};

use super::{Answer, Failure};

/// Wavelengths of the spectra that are shown: from, to, step, nm.
const SPECTRUM: (u16, u16, u16) = (380, 780, 1);

/// Equal bins over the visible range for light between surfaces.
const BINS: usize = 81;
/// Steps of the progress bar.
const STEPS: u32 = 1000;

/// What `spectral illuminance` takes.
#[derive(Debug, Args)]
pub(super) struct Arguments {
    /// A built-in scene or a scene file.
    #[arg(value_name = "SCENE")]
    scene: String,
    /// Positions and normals: x, y, z, nx, ny, nz on each line; - reads standard input.
    #[arg(long, value_name = "FILE")]
    points: PathBuf,
    /// The relative error that is asked for, from 1e-5 to 0.5.
    #[arg(long, value_name = "SHARE", default_value_t = 3e-3)]
    accuracy: f64,
    /// Add colour temperature, R_a and CRI00 of the light that arrives, and its spectrum, W/(m² nm) at every nanometre from 380 to 780.
    #[arg(long)]
    spectral: bool,
    /// Values for the scene's parameters ($name in the file).
    #[arg(short = 'D', value_name = "NAME=VALUE", value_parser = super::render::parse_define)]
    define: Vec<(String, String)>,
}

impl Arguments {
    pub(super) fn run(self) -> Result<Answer, Failure> {
        let scene = self.load()?;
        let points = read_points(&self.points)?;
        let direct = self.meter(&scene, None)?;
        let warnings = super::warn(&scene);
        let mut answer = if *direct.indirect_part() == IndirectPart::NotComputed {
            self.with_radiosity(&scene, &points).or_else(|reason| self.measure(&direct, &points, Some(&reason)))
        } else {
            self.measure(&direct, &points, None)
        }?;
        if let Some(object) = answer.json.as_object_mut() {
            object.insert("warnings".to_owned(), json!(warnings));
        }
        Ok(answer)
    }

    /// Readings with the light between surfaces; or why it can't be computed.
    fn with_radiosity(&self, scene: &Scene, points: &[Point]) -> Result<Answer, String> {
        let (radiosity, palette) = self.radiosity(scene)?;
        let bins = UniformBins::new(&palette, BINS)?;
        let solution = radiosity.solve(&bins).map_err(|error| error.to_string())?;
        let light = IndirectRadiosity::new(&solution, &bins).ok_or("the solution has other components")?;
        let answer = |light: &dyn IndirectLight| {
            let meter = self.meter(scene, Some(light)).map_err(|Failure(reason)| reason)?;
            self.measure(&meter, points, None).map_err(|Failure(reason)| reason)
        };
        if !self.spectral {
            return answer(&light);
        }
        let nanometres = Nanometres::new(&palette)?;
        let spectra = radiosity.solve(&nanometres).map_err(|error| error.to_string())?;
        answer(&SpectralIndirect::new(&light, &spectra).ok_or("the solution has other components")?)
    }

    fn meter<'s>(&self, scene: &'s Scene, indirect: Option<&'s dyn IndirectLight>) -> Result<Meter<'s>, Failure> {
        Meter::new(scene, Settings { accuracy: self.accuracy }, indirect)
            .map_err(|error| Failure(format!("{}: {error}", self.scene)))
    }

    /// Patches and transport for light between surfaces, and the spectra of lights and surfaces; or why it can't be computed.
    fn radiosity(&self, scene: &Scene) -> Result<(Radiosity, Palette), String> {
        let mut palette = Palette::default();
        let settings = radiosity::Settings { accuracy: self.accuracy, ..radiosity::Settings::default() };
        let bar = Progress::new("radiosity", u64::from(STEPS));
        let done = AtomicU64::new(0);
        let advance = |share: f64| {
            #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a share of some steps")]
            let now = (share.clamp(0.0, 1.0) * f64::from(STEPS)) as u64;
            bar.add(now.saturating_sub(done.fetch_max(now, Ordering::Relaxed)));
        };
        let settings = settings.limited_by(scene.integrator);
        let radiosity = Radiosity::new(scene, &settings, &mut palette, &advance).map_err(|error| error.to_string())?;
        Ok((radiosity, palette))
    }

    fn measure(&self, meter: &Meter<'_>, points: &[Point], reason: Option<&str>) -> Result<Answer, Failure> {
        let read = |point: &Point| meter.read(point.position, point.normal);
        let readings = points.par_iter().map(read).collect::<Result<Vec<_>, _>>()?;
        let indirect = match reason {
            Some(reason) => format!("{}: {reason}", meter.indirect_part()),
            None => meter.indirect_part().to_string(),
        };
        let colours: Vec<_> = if self.spectral {
            let colours = ColourMeter::default();
            readings.par_iter().map(|reading| colours.measure(meter, reading)).collect()
        } else {
            Vec::new()
        };
        Ok(Answer {
            text: self.describe(meter, &readings, &colours, &indirect),
            json: self.json(meter, &readings, &colours, &indirect),
        })
    }

    /// A built-in scene if there is one of this name, else a file.
    fn load(&self) -> Result<Scene, Failure> {
        if builtin::source(&self.scene).is_some() {
            return Ok(builtin::load(&self.scene, &self.define)?);
        }
        Ok(load(&Source::disk(&self.scene), &self.define)?)
    }

    fn json(&self, meter: &Meter<'_>, readings: &[Reading], colours: &[Option<LightColour>], indirect: &str) -> Value {
        let points = readings.iter().enumerate().map(|(index, reading)| {
            let mut point = json!({
                "position": reading.position.to_array(),
                "normal": reading.normal.to_array(),
                "lux": reading.lux,
                "direct_lux": reading.direct_lux,
                "indirect_lux": reading.indirect_lux,
                "error": reading.error,
                "samples": reading.samples,
            });
            if let (true, Some(object)) = (self.spectral, point.as_object_mut()) {
                object.insert("spectrum".to_owned(), spectrum(meter, reading).collect());
                object.extend(colour_members(colours.get(index).copied().flatten()));
            }
            point
        });
        let mut all = json!({ "points": points.collect::<Value>(), "indirect": indirect });
        if let (true, Some(object)) = (self.spectral, all.as_object_mut()) {
            object.insert("wavelengths".to_owned(), wavelengths().collect());
        }
        all
    }

    fn describe(
        &self,
        meter: &Meter<'_>,
        readings: &[Reading],
        colours: &[Option<LightColour>],
        indirect: &str,
    ) -> String {
        let colour_headings: &[_] = if self.spectral { &["CCT", "R_a", "CRI00"] } else { &[] };
        let headings = ["x", "y", "z", "nx", "ny", "nz", "lux", "direct", "indirect", "±"];
        let mut table = Table::new(headings.iter().chain(colour_headings).copied());
        let number = |value: f64| format!("{value:.6}").trim_end_matches('0').trim_end_matches('.').to_owned();
        for (index, reading) in readings.iter().enumerate() {
            let place = reading.position.to_array().into_iter().chain(reading.normal.to_array()).map(number);
            let indirect = reading.indirect_lux.map_or_else(|| "?".to_owned(), lux);
            let found = [lux(reading.lux), lux(reading.direct_lux), indirect, format!("{:.1e}", reading.error)];
            table
                .row(place.chain(found).chain(colours.get(index).into_iter().flat_map(|colour| colour_cells(*colour))));
        }
        let text = format!("{table}\n{}\n{}\n", summary(readings), note(meter.indirect_part(), indirect));
        if self.spectral { text + "\n" + &spectra(meter, readings).to_string() } else { text }
    }
}

/// CCT, R_a and CRI00, for people.
fn colour_cells(colour: Option<LightColour>) -> [String; 3] {
    let cell = |value: Option<f64>, digits: usize| value.map_or_else(|| "–".to_owned(), |v| format!("{v:.digits$}"));
    [cell(colour.map(|c| c.cct), 0), cell(colour.and_then(|c| c.ra), 2), cell(colour.and_then(|c| c.cri00_munsell), 2)]
}

/// The colour's members of a point, by the names that `spectral light` has for them; null where they mean nothing.
fn colour_members(colour: Option<LightColour>) -> [(String, Value); 4] {
    let member = |name: &str, value: Option<f64>| (name.to_owned(), json!(value));
    [
        member("cct", colour.map(|c| c.cct)),
        member("duv", colour.map(|c| c.duv)),
        member("ra", colour.and_then(|c| c.ra)),
        member("cri00_munsell", colour.and_then(|c| c.cri00_munsell)),
    ]
}

fn read_points(path: &Path) -> Result<Vec<Point>, Failure> {
    let (name, text) = if path == Path::new("-") {
        let mut text = String::new();
        ("standard input".to_owned(), std::io::stdin().read_to_string(&mut text).map(|_| text))
    } else {
        (path.display().to_string(), std::fs::read_to_string(path))
    };
    let text = text.map_err(|error| Failure(format!("{name}: {error}")))?;
    Ok(parse_points(&name, &text)?)
}

/// An illuminance with six digits.
fn lux(value: f64) -> String {
    let digits = if value > 0.0 { (5.0 - value.log10().floor()).clamp(0.0, 9.0) } else { 0.0 };
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "from 0 to 9")]
    let digits = digits as usize;
    format!("{value:.digits$}")
}

fn summary(readings: &[Reading]) -> String {
    let all = || readings.iter().map(|reading| reading.lux);
    #[allow(clippy::cast_precision_loss, reason = "a number of points")]
    let mean = all().sum::<f64>() / readings.len() as f64;
    let (min, max) = (all().fold(f64::INFINITY, f64::min), all().fold(0.0, f64::max));
    format!("{} points: min {}, mean {}, max {} lx", readings.len(), lux(min), lux(mean), lux(max))
}

fn note(part: &IndirectPart, indirect: &str) -> String {
    let consequence = match part {
        IndirectPart::NotComputed => "; the scene asks for light between surfaces, and lux is the direct part alone",
        _ => "",
    };
    format!("indirect: {indirect}{consequence}")
}

fn wavelengths() -> impl Iterator<Item = u16> {
    let (from, to, step) = SPECTRUM;
    (from..=to).step_by(usize::from(step))
}

fn spectrum<'r>(meter: &'r Meter<'_>, reading: &'r Reading) -> impl Iterator<Item = f64> {
    wavelengths().map(|wavelength| meter.irradiance(reading, f64::from(wavelength)))
}

fn spectra(meter: &Meter<'_>, readings: &[Reading]) -> Table {
    let headings = core::iter::once("nm".to_owned()).chain((1..=readings.len()).map(|i| format!("point {i}")));
    let mut table = Table::new(headings);
    for wavelength in wavelengths() {
        let values = readings.iter().map(|reading| format!("{:.6e}", meter.irradiance(reading, f64::from(wavelength))));
        table.row(core::iter::once(wavelength.to_string()).chain(values));
    }
    table
}
