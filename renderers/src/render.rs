//! Rendering a scene to pictures: the loop over pixels, the same for every spectral representation.

use core::sync::atomic::{AtomicUsize, Ordering};
use std::sync::Mutex;
use std::time::Instant;

use spectral_core::adaptive::Mode;
use spectral_core::bilinear::Tensor;
use spectral_core::colour::rgb;

use crate::geometry::Filter;
use crate::geometry::sampling::SobolSequence;
use crate::image::{ImageError, MAX_PIXELS, Picture, Raster, ScalarMap};
use crate::path;
use crate::scene::{self, Scene};
use crate::spectral::{
    Colour, ComponentResolver, Components, FactorOrder, IntervalMemory, IntervalSettings, Intervals, Palette, Radiance,
    Resolver, Role, SharedIntervals, Tracer, Uniform, UniformBins,
};
use crate::whitted::{RenderError, Whitted, Worker};

/// Pixels along the side of the squares that threads take in turn.
const TILE: usize = 16;

/// Products of spectra that a thread remembers. Metals that mirror each other make ever new ones.
const MAX_MONOMIALS: usize = 1 << 15;

/// How light is gathered.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Renderer {
    /// Direct light, mirrors and glass, with a constant ambient term: [`crate::whitted`].
    #[default]
    Whitted,
    /// All light, by paths at random: [`crate::path`].
    Path,
}

impl core::fmt::Display for Renderer {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str(match self {
            Self::Whitted => "whitted",
            Self::Path => "path",
        })
    }
}

/// How spectra are represented.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Spectra {
    /// Adaptive intervals with a colour bound.
    Interval(IntervalSettings),
    /// Equal bins over 380–780 nm.
    Uniform(usize),
    /// The naive product of three components.
    Rgb,
    /// The product of three components, those of materials filtered for the light that is the strongest in the scene.
    RgbPrefiltered,
    /// The bilinear product of three components.
    Bilinear,
    /// Spectra of ten bins, made of three components.
    Smits,
}

impl Default for Spectra {
    /// Intervals with a certified bound of ΔE*ab 1.
    fn default() -> Self {
        Self::Interval(IntervalSettings { mode: Mode::Certified, threshold: 1.0 })
    }
}

impl Spectra {
    /// Whether products of spectra may be reordered.
    const fn factor_order(&self) -> FactorOrder {
        match self {
            Self::Bilinear => FactorOrder::Kept,
            Self::Interval(_) | Self::Uniform(_) | Self::Rgb | Self::RgbPrefiltered | Self::Smits => FactorOrder::Free,
        }
    }
}

impl core::fmt::Display for Spectra {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Interval(_) => write!(f, "interval"),
            Self::Uniform(count) => write!(f, "uniform:{count}"),
            Self::Rgb => write!(f, "rgb"),
            Self::RgbPrefiltered => write!(f, "rgb-prefiltered"),
            Self::Bilinear => write!(f, "bilinear"),
            Self::Smits => write!(f, "smits"),
        }
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
}

/// Renders a scene on all threads of the current rayon pool. `progress` is told how many pixels have been finished, from any thread.
///
/// The result doesn't depend on the number of threads.
///
/// # Errors
/// What the scene asks for and this renderer can't do.
pub fn render(scene: &Scene, options: &Options, progress: &(dyn Fn(usize) + Sync)) -> Result<Rendering, RenderError> {
    let size = options.size.unwrap_or([scene.film.width, scene.film.height]);
    check_area(size)?;
    match options.renderer {
        Renderer::Whitted => whitted(scene, options, size, progress),
        Renderer::Path => path::render(scene, options, path::Run::default(), progress),
    }
}

/// Whitted's ray tracing.
fn whitted(
    scene: &Scene,
    options: &Options,
    size: [u32; 2],
    progress: &(dyn Fn(usize) + Sync),
) -> Result<Rendering, RenderError> {
    let start = Instant::now();
    let mut palette = Palette::default();
    let whitted = Whitted::new(scene, size, &mut palette)?;
    let frame = Frame {
        size: size.map(|s| s as usize),
        samples: options.samples.unwrap_or(scene.sampler.sample_count).max(1),
        seed: options.seed.unwrap_or(scene.sampler.seed),
        filter: filter(scene.film.filter)?,
        scene: &whitted,
        order: options.spectra.factor_order(),
        progress,
    };
    let (pixels, prepared) = match options.spectra {
        Spectra::Interval(settings) => {
            let mut memory = IntervalMemory::default();
            let shared = SharedIntervals::new(&palette, settings, &mut memory).map_err(RenderError::new)?;
            (frame.trace(start, || Intervals::new(&shared)), true)
        }
        Spectra::Uniform(count) => {
            let bins = UniformBins::new(&palette, count).map_err(RenderError::new)?;
            (frame.trace(start, || Uniform::new(&bins)), false)
        }
        Spectra::Rgb => {
            let components = Components::naive(&palette).map_err(RenderError::new)?;
            (frame.trace(start, || ComponentResolver::new(&components)), false)
        }
        Spectra::RgbPrefiltered => {
            let components = prefiltered(scene, &palette)?;
            (frame.trace(start, || ComponentResolver::new(&components)), false)
        }
        Spectra::Bilinear => {
            let components = Components::bilinear(&palette, &Tensor::rec_709()).map_err(RenderError::new)?;
            (frame.trace(start, || ComponentResolver::new(&components)), false)
        }
        Spectra::Smits => {
            let bins = UniformBins::smits(&palette).map_err(RenderError::new)?;
            (frame.trace(start, || Uniform::new(&bins)), false)
        }
    };
    pixels.into_rendering(&frame, prepared).map_err(|e| RenderError::new(e.to_string()))
}

/// Components filtered for the light with the largest luminous flux.
pub(crate) fn prefiltered(scene: &Scene, palette: &Palette) -> Result<Components, RenderError> {
    let Some(spectrum) = scene.dominant_light() else {
        return Err(RenderError::new("rgb-prefiltered needs a light, and the scene has none"));
    };
    let spectrum = scene.spectrum(spectrum);
    let mut own = Palette::default();
    own.factor(spectrum, Role::Light);
    let light = own.leaves().first().map(|(light, _)| light.clone());
    let light = light.ok_or_else(|| RenderError::new("the dominant light has no spectrum"))?;
    Components::prefiltered(palette, &light)
        .map_err(|e| RenderError::new(format!("rgb-prefiltered, {}: {e}", spectrum.label)))
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

/// What all threads share.
struct Frame<'s> {
    size: [usize; 2],
    samples: u32,
    seed: u64,
    filter: Filter,
    scene: &'s Whitted,
    order: FactorOrder,
    progress: &'s (dyn Fn(usize) + Sync),
}

/// The colours of all pixels, row by row.
struct Pixels {
    colours: Vec<Colour>,
    rays: u64,
    seconds: f64,
    preparation_seconds: f64,
}

impl Frame<'_> {
    /// Renders all tiles, each by whichever thread is free; each thread has one resolver.
    fn trace<R: Resolver>(&self, start: Instant, new_resolver: impl Fn() -> R + Sync) -> Pixels {
        let preparation_seconds = start.elapsed().as_secs_f64();
        let traced = Instant::now();
        let [width, height] = self.size;
        let across = width.div_ceil(TILE);
        let tiles = across * height.div_ceil(TILE);
        let next = AtomicUsize::new(0);
        let shared = Mutex::new((vec![Colour::default(); width * height], 0_u64));
        rayon::broadcast(|_| {
            let mut worker = Worker::new(self.scene, self.order);
            let mut resolver = new_resolver();
            let mut colours = Vec::with_capacity(TILE * TILE);
            loop {
                let tile = next.fetch_add(1, Ordering::Relaxed);
                if tile >= tiles {
                    break;
                }
                let (left, top) = (tile % across * TILE, tile / across * TILE);
                let (right, bottom) = ((left + TILE).min(width), (top + TILE).min(height));
                colours.clear();
                for (x, y) in (top..bottom).flat_map(|y| (left..right).map(move |x| (x, y))) {
                    if worker.monomials().len() > MAX_MONOMIALS {
                        // What is known of products is forgotten with their numbers; colours don't depend on it.
                        worker.forget();
                        resolver = new_resolver();
                    }
                    colours.push(self.pixel(x, y, &mut worker, &mut resolver));
                }
                if let Ok(mut shared) = shared.lock() {
                    for (row, y) in colours.chunks(right - left).zip(top..bottom) {
                        shared.0[y * width + left..y * width + right].copy_from_slice(row);
                    }
                }
                (self.progress)(colours.len());
            }
            if let Ok(mut shared) = shared.lock() {
                shared.1 += worker.rays();
            }
        });
        let (colours, rays) = shared.into_inner().unwrap_or_default();
        Pixels { colours, rays, seconds: traced.elapsed().as_secs_f64(), preparation_seconds }
    }

    /// One pixel: all its camera rays in one expression, evaluated once.
    #[allow(clippy::cast_precision_loss, clippy::cast_possible_truncation, reason = "pixel coordinates; a hashed seed")]
    fn pixel<R: Resolver>(&self, x: usize, y: usize, worker: &mut Worker<'_>, resolver: &mut R) -> Colour {
        let mut radiance = Radiance::default();
        let weight = 1.0 / f64::from(self.samples);
        let seed = (self.seed ^ (self.seed >> 32)) as u32;
        let points = SobolSequence::for_pixel(x as u32, y as u32, seed);
        worker.start_pixel(points);
        for sample in 0..self.samples {
            let [dx, dy] = self.filter.square_to_offset(points.point(sample, 0)).map(f64::from);
            worker.sample(x as f64 + 0.5 + dx, y as f64 + 0.5 + dy, weight, &mut radiance);
        }
        resolver.resolve(&radiance, worker)
    }
}

impl Pixels {
    fn into_rendering(self, frame: &Frame<'_>, bounded: bool) -> Result<Rendering, ImageError> {
        let [width, height] = frame.size;
        let raster = Raster::from_pixels(width, height, self.colours)?;
        Ok(Rendering {
            picture: raster.map(|c| rgb::xyz_to_linear_rgb(c.xyz).map(single)),
            #[allow(clippy::cast_precision_loss, reason = "at most some hundred")]
            intervals: raster.map(|c| c.intervals as f32),
            delta_e: bounded.then(|| raster.map(|c| single_above(c.delta_e))),
            path_delta_e: bounded.then(|| raster.map(|c| single_above(c.path_delta_e))),
            variance: None,
            samples: frame.samples,
            rays: self.rays,
            seconds: self.seconds,
            preparation_seconds: self.preparation_seconds,
        })
    }
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
