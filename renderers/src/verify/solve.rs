//! The cases computed by this project.

use std::time::Instant;

use disk_sampling::estimate::{self, Aim, Panel, Request, Response};
use disk_sampling::partition::{self, Partition, Subsource};
use disk_sampling::{Disk, Receiver};
use spectral_core::action::MAXIMUM_LUMINOUS_EFFICACY;
use spectral_core::{Observer, tristimulus};

use super::case::{Answer, Case, Work};
use super::disk::{Method, Requested, Sampling};
use super::mitsuba;
use super::model::{Light, Shape, Vec3, along, dot};
use crate::illuminance::{IndirectIrradiance, IndirectLight, Meter, Settings};
use crate::radiosity::{self, Flat, Radiosity, Solution};
use crate::scene::{Scene, Source, glam::DVec3, load};
use crate::spectral::Palette;

/// Relative error asked of direct light, half of the least that the cases allow.
const DIRECT_ACCURACY: f64 = 2.5e-4;
/// Relative error asked of reflected light: what the cases of closed rooms allow.
const INDIRECT_ACCURACY: f64 = 1e-3;

/// Answers to a case, one for each point, or why there are none.
///
/// # Errors
/// A line that says what is missing or what went wrong.
pub fn solve(case: &Case) -> Result<Vec<Answer>, String> {
    match &case.work {
        Work::Method(sampling) => {
            case.points.iter().map(|point| by_method(case, *sampling, point.position, point.normal)).collect()
        }
        Work::Misses(sampling) => Ok(vec![misses(*sampling)?]),
        Work::Request(requested) => case.points.iter().map(|point| by_request(case, *requested, point)).collect(),
        Work::Direct => by_meter(case, &scene_of(case)?, None, 0.0),
        Work::Global => globally(case),
    }
}

/// The case as this project's reader has it, luminaires' files included.
fn scene_of(case: &Case) -> Result<Scene, String> {
    let text = mitsuba::own_scene(&case.model, &case.work);
    let mut source = Source::text(format!("{}.xml", case.name), text);
    for (index, light) in case.model.lights.iter().enumerate() {
        if let Light::Photometric { file, .. } = light {
            let bytes = std::fs::read(file).map_err(|error| format!("{}: {error}", file.display()))?;
            source = source.with_asset(mitsuba::luminaire_name(index, file), String::from_utf8_lossy(&bytes));
        }
    }
    load(&source, &[]).map_err(|error| error.to_string())
}

/// Direct and reflected light, the latter by radiosity; the time for solving it is shared by the points.
fn globally(case: &Case) -> Result<Vec<Answer>, String> {
    let start = Instant::now();
    let scene = scene_of(case)?;
    let mut palette = Palette::default();
    let settings = radiosity::Settings { accuracy: INDIRECT_ACCURACY, ..radiosity::Settings::default() };
    let radiosity = Radiosity::new(&scene, &settings, &mut palette, &|_| {}).map_err(|error| error.to_string())?;
    let solution = radiosity.solve(&Flat).map_err(|error| error.to_string())?;
    let grey = Grey { solution, efficacy: efficacy(&palette)? };
    #[allow(clippy::cast_precision_loss, reason = "at most some hundred points")]
    let share = start.elapsed().as_secs_f64() / case.points.len() as f64;
    by_meter(case, &scene, Some(&grey), share)
}

fn by_meter(
    case: &Case,
    scene: &Scene,
    indirect: Option<&dyn IndirectLight>,
    share: f64,
) -> Result<Vec<Answer>, String> {
    let settings = Settings { accuracy: DIRECT_ACCURACY };
    let meter = Meter::new(scene, settings, indirect).map_err(|error| error.to_string())?;
    let read = |point: &super::SensorPoint| {
        let start = Instant::now();
        let reading = meter.read(DVec3::from_array(point.position), DVec3::from_array(point.normal));
        let reading = reading.map_err(|error| error.to_string())?;
        let seconds = Some(share + start.elapsed().as_secs_f64());
        Ok(Answer { illuminance: Some(reading.lux), samples: Some(reading.samples), seconds })
    };
    case.points.iter().map(read).collect()
}

/// Reflected light in scenes where all surfaces are grey and all lights have one spectrum, as in the cases: one
/// component stands for the whole spectrum.
struct Grey<'r> {
    solution: Solution<'r>,
    /// Illuminance for an irradiance of 1 times the lights' spectrum, lx.
    efficacy: f64,
}

impl IndirectLight for Grey<'_> {
    fn name(&self) -> &'static str {
        "radiosity"
    }

    fn irradiance(&self, position: DVec3, normal: DVec3) -> IndirectIrradiance {
        let receiver = Receiver::new(position.to_array(), normal.to_array());
        let found = receiver.map(|receiver| self.solution.indirect(&receiver));
        // The meter has checked the point.
        let irradiance = found.ok().and_then(|components| components.first().copied()).unwrap_or(f64::NAN);
        let lux = irradiance * self.efficacy;
        IndirectIrradiance { lux, error: lux * INDIRECT_ACCURACY, spectrum: None }
    }
}

/// Illuminance for an irradiance of 1 times the one spectrum that the lights have, lx.
fn efficacy(palette: &Palette) -> Result<f64, String> {
    let [(leaf, _)] = palette.leaves() else { return Err("the case has lights of more than one colour".to_owned()) };
    let spectrum = leaf.spectrum()?;
    let [_, y, _] = tristimulus(&Observer::cie_1931_2deg(), &spectrum, 380.0, 780.0);
    Ok(MAXIMUM_LUMINOUS_EFFICACY * y)
}

/// The disk of a case that has one.
fn disk_of(case: &Case) -> Result<(Disk<f64>, f64), String> {
    let mut surfaces = case.model.surfaces.iter();
    let found = surfaces.find_map(|surface| match surface.shape {
        Shape::Disk { centre, normal, radius } => Some((Disk::new(centre, normal, radius), surface.exitance)),
        _ => None,
    });
    let (disk, exitance) = found.ok_or("the case has no disk")?;
    Ok((disk.map_err(|error| error.to_string())?, exitance))
}

fn subdivision(sampling: Sampling) -> Result<Partition<f64>, String> {
    let method = match sampling.method {
        Method::Square => partition::Method::Square,
        Method::MappedSquare => partition::Method::MappedSquare,
        Method::Hexagon => partition::Method::Hexagon,
        Method::EqualAreaHexagon => partition::Method::EqualAreaHexagon,
    };
    let depth = (1..=partition::MAX_DEPTH).find(|&depth| method.parts(depth) == u64::from(sampling.count));
    let depth = depth.ok_or_else(|| format!("no subdivision has {} parts", sampling.count))?;
    Partition::full(method, depth).map_err(|error| error.to_string())
}

/// Illuminance by the samples of a method, nothing in the way: Σ weight · M/π · A cos θ cos θ′ / d².
fn by_method(case: &Case, sampling: Sampling, point: Vec3, normal: Vec3) -> Result<Answer, String> {
    let start = Instant::now();
    let (disk, exitance) = disk_of(case)?;
    let mut sum = 0.0;
    let mut samples = 0;
    for subsource in subdivision(sampling)? {
        samples += 1;
        if subsource.hits() {
            let to = along(disk.point(subsource.position()), -1.0, point);
            let d2 = dot(to, to);
            sum += subsource.weight() * dot(to, normal).max(0.0) * (-dot(to, disk.normal())).max(0.0) / (d2 * d2);
        }
    }
    // M/π · π r²
    let illuminance = exitance * disk.radius() * disk.radius() * sum;
    Ok(Answer { illuminance: Some(illuminance), samples: Some(samples), seconds: Some(start.elapsed().as_secs_f64()) })
}

/// Illuminance to a requested error: behind a screen by the ratio estimator, else by integration without the closed
/// form.
fn by_request(case: &Case, requested: Requested, point: &super::SensorPoint) -> Result<Answer, String> {
    let mut panels = vec![Panel::default(); 4096];
    let start = Instant::now();
    let (disk, exitance) = disk_of(case)?;
    let receiver = Receiver::new(point.position, point.normal).map_err(|error| error.to_string())?;
    // The screen's edge could slip between the points of a single stratum.
    let strata = if requested.seen_beyond.is_some() { 4 } else { 1 };
    let request = Request { relative_error: requested.relative_error, max_samples: 1 << 20, strata };
    let found = match requested.seen_beyond {
        None => estimate::integrate(&disk, &receiver, &request, &mut panels, |_| Response::unoccluded(1.0)),
        Some(x) => {
            let exact = disk_sampling::disk_configuration_factor(&disk, &receiver);
            let seen =
                |aim: &Aim<f64>| Response { emission: 1.0, visibility: if aim.point[0] > x { 1.0 } else { 0.0 } };
            estimate::ratio(&disk, &receiver, exact, &request, &mut panels, seen)
        }
    };
    let found = found.map_err(|error| error.to_string())?;
    Ok(Answer {
        illuminance: Some(exitance * found.value),
        samples: Some(found.samples as u64),
        seconds: Some(start.elapsed().as_secs_f64()),
    })
}

/// The share in per cent of fully jittered samples that miss the disk.
///
/// The random numbers are a Kronecker sequence of the plastic number ρ = 1.3247…, (n/ρ, n/ρ²) mod 1: even, and in no
/// relation to the parts' edges.
fn misses(sampling: Sampling) -> Result<Answer, String> {
    const TRIALS: u32 = 1 << 16;
    const PLASTIC: f64 = 1.324_717_957_244_746;
    let start = Instant::now();
    let random = |n: u32| [1.0 / PLASTIC, 1.0 / (PLASTIC * PLASTIC)].map(|step| (f64::from(n) * step).fract());
    let missed = |part: &Subsource<f64>| (0..TRIALS).filter(|&n| !part.sample(1.0, random(n)).1).count();
    let parts: Vec<_> = subdivision(sampling)?.collect();
    #[allow(clippy::cast_precision_loss, reason = "a few million at most")]
    let [missed, all] = [parts.iter().map(missed).sum::<usize>() as f64, parts.len() as f64];
    let share = 100.0 * missed / (all * f64::from(TRIALS));
    let samples = Some(u64::from(TRIALS) * parts.len() as u64);
    Ok(Answer { illuminance: Some(share), samples, seconds: Some(start.elapsed().as_secs_f64()) })
}
