//! Rendering a scene to pictures: the loop over pixels, the same for every spectral representation.

mod between;
mod gather;
mod passes;
mod photons;
mod spectra;

use core::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

use crate::geometry::Filter;
use crate::image::{MAX_PIXELS, Picture, ScalarMap};
use crate::path;
use crate::radiosity::Representation;
use crate::scene::{self, Scene};
use crate::spectral::{IntervalMemory, IntervalSettings, Intervals, Palette, Resolver, SharedIntervals, Steering};
use crate::whitted::{RenderError, Whitted};

pub use between::BetweenReport;
pub(crate) use between::build as build_radiosity;
pub use gather::{Between, GatherOptions, GatherReport};
use passes::{Frame, Pixels};
use photons::Thrower;
pub use photons::{FluxShares, PhotonCount, PhotonOptions, PhotonReport};
use spectra::Represented;
pub use spectra::Spectra;
pub(crate) use spectra::{bilinear, prefiltered};

/// How light is gathered.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Renderer {
    /// Direct light, mirrors and glass, with a constant ambient term: [`crate::whitted`].
    #[default]
    Whitted,
    /// The same, with all light between diffuse surfaces: [`crate::radiosity`].
    Radiosity,
    /// The same, with light by way of mirrors and glass: [`crate::photon`].
    PhotonMap,
    /// All light, by paths at random: [`crate::path`].
    Path,
}

impl core::fmt::Display for Renderer {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str(match self {
            Self::Whitted => "whitted",
            Self::Radiosity => "radiosity",
            Self::PhotonMap => "photon-map",
            Self::Path => "path",
        })
    }
}

/// How a scene is to be rendered.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Options {
    /// How light is gathered.
    pub renderer: Renderer,
    /// How spectra are represented.
    pub spectra: Spectra,
    /// Image size in pixels; `None`: the scene's.
    pub size: Option<[u32; 2]>,
    /// Camera rays per pixel; `None`: the scene's.
    pub samples: Option<u32>,
    /// Seed of the sample positions; `None`: the scene's.
    pub seed: Option<u64>,
    /// How light between surfaces is found, by renderers that do.
    pub between: BetweenOptions,
    /// How light by way of mirrors and glass is found, by the one that does.
    pub photons: PhotonOptions,
    /// How the same renderer finds light between surfaces by final gathers, if it does.
    pub gather: GatherOptions,
    /// What decides which lights paths look for and which rays go on; `None`: the default for paths, and for the other renderers that rays
    /// by mirrors and glass go on whatever these reflect.
    pub steering: Option<Steering>,
}

/// How [`Renderer::Radiosity`] and [`Renderer::PhotonMap`] find light between surfaces.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BetweenOptions {
    /// The relative error of indirect irradiance that is aimed at.
    pub accuracy: f64,
    /// Whether light is gathered for every camera ray anew instead of being interpolated on surfaces.
    pub exact: bool,
}

impl Default for BetweenOptions {
    fn default() -> Self {
        Self { accuracy: 0.02, exact: false }
    }
}

/// The variance of a pixel's mean over all its samples: the square of its standard error.
#[derive(Clone, Debug)]
pub struct Variance {
    /// That of linear Rec. 709 components.
    pub rgb: Picture,
    /// That of the luminance Y.
    pub luminance: ScalarMap,
}

/// A rendered picture, with what is known of each pixel.
#[derive(Clone, Debug)]
pub struct Rendering {
    /// Linear Rec. 709, Y = 1 for a flat radiance of 1.
    pub picture: Picture,
    /// Intervals (bins, components) that each pixel took.
    pub intervals: ScalarMap,
    /// The bound of ΔE*ab of each pixel's colour before it is rounded to `f32`; `None` for representations without one.
    pub delta_e: Option<ScalarMap>,
    /// The part of the bound that is an estimate of deferred paths' errors.
    pub path_delta_e: Option<ScalarMap>,
    /// What a standard error of the light found by photons counts for in each pixel, a ΔE*ab: not part of the bound.
    pub photon_delta_e: Option<ScalarMap>,
    /// The variance of each pixel, of renderers that sample at random; `None` of a single sample.
    pub variance: Option<Variance>,
    /// Camera rays per pixel.
    pub samples: u32,
    /// Rays traced from the eye, reflected and refracted ones included; shadow rays are counted by the path tracer alone.
    pub rays: u64,
    /// Time for all pixels, without reading the scene and preparing its spectra.
    pub seconds: f64,
    /// Time for preparing: the hierarchy, and the spectra on intervals or bins.
    pub preparation_seconds: f64,
    /// What became of the light between surfaces, by renderers that find it.
    pub between: Option<BetweenReport>,
    /// What became of the photons, by the renderer that throws some.
    pub photons: Option<PhotonReport>,
    /// What became of the light between surfaces, by renderers that gather it from photons.
    pub gather: Option<GatherReport>,
}

/// Is told how far rendering is; from any thread.
pub trait Watch: Sync {
    /// Something begins that takes so many steps.
    fn stage(&self, name: &str, steps: u64);
    /// So many steps more are done.
    fn add(&self, steps: u64);
}

/// Takes the spectra of pixels, from any thread.
pub trait SpectrumSink: Sync {
    /// Column and row of a pixel, and its spectrum: a number for each bin of the representation, in the unit of the lights' radiance.
    ///
    /// Renderers that average several pictures say so by a share below 1: a pixel's spectrum is the sum of shares times spectra.
    fn pixel(&self, at: [usize; 2], spectrum: &[f64], share: f64);
}

/// Pixels alone are watched.
struct Pixelwise<'p> {
    progress: &'p (dyn Fn(usize) + Sync),
    in_pixels: AtomicBool,
}

impl Watch for Pixelwise<'_> {
    fn stage(&self, name: &str, _: u64) {
        self.in_pixels.store(name == LAST_STAGE, Ordering::Relaxed);
    }
    fn add(&self, steps: u64) {
        if self.in_pixels.load(Ordering::Relaxed) {
            (self.progress)(usize::try_from(steps).unwrap_or(usize::MAX));
        }
    }
}

/// The stage in which pixels are made.
const LAST_STAGE: &str = "render";

/// Renders a scene on all threads of the current rayon pool. `progress` is told how many pixels have been finished, from any thread.
///
/// The result doesn't depend on the number of threads.
///
/// # Errors
/// What the scene asks for and this renderer can't do.
pub fn render(scene: &Scene, options: &Options, progress: &(dyn Fn(usize) + Sync)) -> Result<Rendering, RenderError> {
    render_watched(scene, options, &Pixelwise { progress, in_pixels: AtomicBool::new(false) })
}

/// The same; `watch` is told of stages and, in the last one, of the pixels that have been finished.
///
/// # Errors
/// What the scene asks for and this renderer can't do.
pub fn render_watched(scene: &Scene, options: &Options, watch: &dyn Watch) -> Result<Rendering, RenderError> {
    render_into(scene, options, watch, None)
}

/// The same, with the spectra of all pixels.
///
/// # Errors
/// What the scene asks for and this renderer can't do; spectra that aren't bins or wavelengths; the path tracer, which keeps none.
pub fn render_spectra(
    scene: &Scene,
    options: &Options,
    watch: &dyn Watch,
    sink: &dyn SpectrumSink,
) -> Result<Rendering, RenderError> {
    if !matches!(options.spectra, Spectra::Uniform(_) | Spectra::Wavelengths(_)) {
        return Err(RenderError::new(format!(
            "pixels have spectra with bins or wavelengths, not with {}",
            options.spectra
        )));
    }
    if options.renderer == Renderer::Path {
        return Err(RenderError::new(
            "the path tracer keeps colours, not spectra: choose whitted, radiosity or photon-map",
        ));
    }
    render_into(scene, options, watch, Some(sink))
}

fn render_into(
    scene: &Scene,
    options: &Options,
    watch: &dyn Watch,
    sink: Option<&dyn SpectrumSink>,
) -> Result<Rendering, RenderError> {
    let size = options.size.unwrap_or([scene.film.width, scene.film.height]);
    check_area(size)?;
    if options.renderer == Renderer::Path {
        watch.stage(LAST_STAGE, u64::from(size[0]) * u64::from(size[1]));
        return path::render(scene, options, path::Run::default(), &|pixels| watch.add(pixels as u64));
    }
    let start = Instant::now();
    let mut palette = Palette::default();
    let whitted = Whitted::new(scene, size, &mut palette)?;
    let whitted = match options.steering {
        Some(steering) => whitted.steered(steering.paths, &palette),
        None => whitted,
    };
    let frame = Frame {
        size: size.map(|s| s as usize),
        samples: options.samples.unwrap_or(scene.sampler.sample_count).max(1),
        seed: options.seed.unwrap_or(scene.sampler.seed),
        filter: filter(scene.film.filter)?,
        scene: &whitted,
        order: options.spectra.factor_order(),
        white: options.spectra.white(),
        indirect: None,
        thrower: None,
        watch,
        sink,
    };
    let (size, samples) = (frame.size, frame.samples);
    let has_photons = options.renderer == Renderer::PhotonMap;
    let emission = has_photons.then(|| photons::emission(scene, &whitted, &palette, frame.seed));
    let thrower = match &emission {
        Some(emission) => Some(Thrower::new((scene, &whitted), emission, &options.photons, watch)?),
        None => None,
    };
    let frame = Frame { thrower: thrower.as_ref(), ..frame };
    let (mut between, mut gather) = (None, None);
    let (pixels, bounded) = match options.light_between() {
        Between::Radiosity => {
            let (pixels, bounded, report) = between::render(scene, options, frame, palette, watch)?;
            between = Some(report);
            (pixels, bounded)
        }
        Between::Gather => {
            let (pixels, report) = gather::render(scene, options, frame, palette, watch)?;
            gather = Some(report);
            (pixels, false)
        }
        Between::Ambient => {
            let work = Ambient { frame: &frame, palette: &palette, start };
            options.spectra.apply(scene, &palette, work)?
        }
    };
    let photons = pixels.photons.clone();
    let rendering = pixels.into_rendering(size, samples, bounded).map_err(|e| RenderError::new(e.to_string()))?;
    let photon_delta_e = rendering.photon_delta_e.filter(|_| photons.is_some());
    Ok(Rendering { between, photons, gather, photon_delta_e, ..rendering })
}

impl Options {
    /// Where light between surfaces comes from.
    const fn light_between(&self) -> Between {
        match self.renderer {
            Renderer::Radiosity => Between::Radiosity,
            Renderer::PhotonMap => self.photons.between,
            Renderer::Whitted | Renderer::Path => Between::Ambient,
        }
    }
}

/// Whitted's ray tracing with an ambient term; whether it has a bound goes with the pixels.
struct Ambient<'a> {
    frame: &'a Frame<'a>,
    palette: &'a Palette,
    start: Instant,
}

impl Represented for Ambient<'_> {
    type Output = (Pixels, bool);

    fn with_intervals(self, settings: IntervalSettings) -> Result<Self::Output, RenderError> {
        let mut memory = IntervalMemory::default();
        let shared = SharedIntervals::new(self.palette, settings, &mut memory).map_err(RenderError::new)?;
        Ok((self.frame.trace(self.start, || Intervals::new(&shared)), true))
    }

    fn with<R: Resolver>(
        self,
        _: &dyn Representation,
        new_resolver: impl Fn() -> R + Sync,
    ) -> Result<Self::Output, RenderError> {
        Ok((self.frame.trace(self.start, new_resolver), false))
    }
}

/// Refuses pictures that could not be kept, before time is spent on them.
pub(crate) fn check_area([width, height]: [u32; 2]) -> Result<(), RenderError> {
    let pixels = u64::from(width) * u64::from(height);
    if (1..=MAX_PIXELS as u64).contains(&pixels) {
        return Ok(());
    }
    Err(RenderError::new(format!("a picture of {width} × {height} is not from 1 to {MAX_PIXELS} pixels")))
}

pub(crate) fn filter(filter: scene::Filter) -> Result<Filter, RenderError> {
    match filter {
        scene::Filter::Box => Filter::constant(0.5),
        scene::Filter::Tent { radius } => Filter::tent(radius),
        scene::Filter::Gaussian { stddev } => Filter::gaussian(stddev),
    }
    .map_err(|e| RenderError::new(e.to_string()))
}

/// A picture's number: finite, since files keep no others; NaN, of infinite light, is black, under a bound that says so.
#[allow(clippy::cast_possible_truncation, reason = "pictures are kept in f32")]
pub(crate) fn single(value: f64) -> f32 {
    let limit = f64::from(f32::MAX);
    if value.is_nan() { 0.0 } else { value.clamp(-limit, limit) as f32 }
}

/// A bound in a map: rounded upwards, the largest finite number for no bound at all.
fn single_above(bound: f64) -> f32 {
    let rounded = single(bound);
    if bound.is_nan() {
        f32::MAX
    } else if f64::from(rounded) < bound {
        rounded.next_up().min(f32::MAX)
    } else {
        rounded
    }
}
