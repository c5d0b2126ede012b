//! Rendering a scene to pictures: the loop over pixels, the same for every spectral representation.

mod between;
mod photons;

use core::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::Mutex;
use std::time::Instant;

use spectral_core::adaptive::Mode;
use spectral_core::bilinear::Tensor;
use spectral_core::bound::delta_e_bound;
use spectral_core::colour::{delta_e_ab, rgb, xyz_to_lab};

use rayon::prelude::*;

use crate::geometry::sampling::SobolSequence;
use crate::geometry::{Filter, Hit};
use crate::image::{ImageError, MAX_PIXELS, Picture, Raster, ScalarMap};
use crate::path;
use crate::scene::{self, Scene};
use crate::spectral::{
    Band, Colour, ComponentResolver, Components, FactorOrder, IntervalMemory, IntervalSettings, Intervals, Palette,
    Radiance, Resolver, Role, SharedIntervals, Tracer, Uniform, UniformBins, Y_INTEGRAL,
};
use crate::whitted::{Caustics, Indirect, RenderError, Whitted, Worker};

pub use between::BetweenReport;
use photons::Thrower;
pub use photons::{FluxShares, PhotonCount, PhotonOptions, PhotonReport};

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
    /// The same with this much transferred into red, green and blue: α of Granier and Damez 2004, section 6.2.
    BilinearAlpha([f64; 3]),
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
            Self::Bilinear | Self::BilinearAlpha(_) => FactorOrder::Kept,
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
            Self::BilinearAlpha([r, g, b]) => write!(f, "bilinear:{r},{g},{b}"),
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
    /// How light between surfaces is found, by renderers that do.
    pub between: BetweenOptions,
    /// How light by way of mirrors and glass is found, by the one that does.
    pub photons: PhotonOptions,
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
}

/// Is told how far rendering is; from any thread.
pub trait Watch: Sync {
    /// Something begins that takes so many steps.
    fn stage(&self, name: &str, steps: u64);
    /// So many steps more are done.
    fn add(&self, steps: u64);
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
    let size = options.size.unwrap_or([scene.film.width, scene.film.height]);
    check_area(size)?;
    if options.renderer == Renderer::Path {
        watch.stage(LAST_STAGE, u64::from(size[0]) * u64::from(size[1]));
        return path::render(scene, options, path::Run::default(), &|pixels| watch.add(pixels as u64));
    }
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
        indirect: None,
        thrower: None,
        watch,
    };
    let (size, samples) = (frame.size, frame.samples);
    let has_photons = options.renderer == Renderer::PhotonMap;
    let emission = has_photons.then(|| photons::emission(scene, &whitted, &palette, frame.seed));
    let thrower = match &emission {
        Some(emission) => Some(Thrower::new((scene, &whitted), emission, &options.photons, watch)?),
        None => None,
    };
    let frame = Frame { thrower: thrower.as_ref(), ..frame };
    let (pixels, bounded, between) = if options.has_light_between() {
        let (pixels, bounded, report) = between::render(scene, options, frame, palette, watch)?;
        (pixels, bounded, Some(report))
    } else {
        let (pixels, bounded) = ambient(scene, options, &frame, &palette, start)?;
        (pixels, bounded, None)
    };
    let photons = pixels.photons.clone();
    let rendering = pixels.into_rendering(size, samples, bounded).map_err(|e| RenderError::new(e.to_string()))?;
    let photon_delta_e = rendering.photon_delta_e.filter(|_| photons.is_some());
    Ok(Rendering { between, photons, photon_delta_e, ..rendering })
}

impl Options {
    /// Whether light between surfaces takes the place of the ambient term.
    fn has_light_between(&self) -> bool {
        match self.renderer {
            Renderer::Radiosity => true,
            Renderer::PhotonMap => self.photons.between,
            Renderer::Whitted | Renderer::Path => false,
        }
    }
}

/// Whitted's ray tracing with an ambient term.
fn ambient(
    scene: &Scene,
    options: &Options,
    frame: &Frame<'_>,
    palette: &Palette,
    start: Instant,
) -> Result<(Pixels, bool), RenderError> {
    Ok(match options.spectra {
        Spectra::Interval(settings) => {
            let mut memory = IntervalMemory::default();
            let shared = SharedIntervals::new(palette, settings, &mut memory).map_err(RenderError::new)?;
            (frame.trace(start, || Intervals::new(&shared)), true)
        }
        Spectra::Uniform(count) => {
            let bins = UniformBins::new(palette, count).map_err(RenderError::new)?;
            (frame.trace(start, || Uniform::new(&bins)), false)
        }
        Spectra::Rgb => {
            let components = Components::naive(palette).map_err(RenderError::new)?;
            (frame.trace(start, || ComponentResolver::new(&components)), false)
        }
        Spectra::RgbPrefiltered => {
            let components = prefiltered(scene, palette)?;
            (frame.trace(start, || ComponentResolver::new(&components)), false)
        }
        Spectra::Bilinear | Spectra::BilinearAlpha(_) => {
            let components = bilinear(options.spectra, palette)?;
            (frame.trace(start, || ComponentResolver::new(&components)), false)
        }
        Spectra::Smits => {
            let bins = UniformBins::smits(palette).map_err(RenderError::new)?;
            (frame.trace(start, || Uniform::new(&bins)), false)
        }
    })
}

/// Components for the bilinear product, with the transfer that is asked for.
pub(crate) fn bilinear(spectra: Spectra, palette: &Palette) -> Result<Components, RenderError> {
    let tensor = match spectra {
        Spectra::BilinearAlpha(alpha) => {
            Tensor::rec_709().with_alpha(alpha).map_err(|e| RenderError::new(e.to_string()))?
        }
        _ => Tensor::rec_709(),
    };
    Components::bilinear(palette, &tensor).map_err(RenderError::new)
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
    /// Light between surfaces, in place of the ambient term.
    indirect: Option<&'s dyn Indirect>,
    /// Throws photons, for light by way of mirrors and glass.
    thrower: Option<&'s Thrower<'s>>,
    watch: &'s dyn Watch,
}

/// The most places that the camera sees which light between surfaces is prepared for.
const MOST_SEEN: usize = 1 << 18;

/// The colours of all pixels, row by row.
#[derive(Default)]
struct Pixels {
    colours: Vec<Colour>,
    rays: u64,
    seconds: f64,
    preparation_seconds: f64,
    photons: Option<PhotonReport>,
}

impl Frame<'_> {
    /// Where the camera sees surfaces that light between them matters for: through the middles of pixels, of every one or, in large
    /// pictures, of some.
    #[allow(clippy::cast_precision_loss, reason = "pixel coordinates")]
    fn seen(&self) -> Vec<Hit> {
        let [width, height] = self.size;
        let mut stride = 1;
        while width.div_ceil(stride) * height.div_ceil(stride) > MOST_SEEN {
            stride += 1;
        }
        let row = |y: usize| {
            let mut worker = Worker::new(self.scene, self.order).noting();
            for x in (0..width).step_by(stride) {
                let middle = |p: usize| (p as f64) + stride as f64 / 2.0;
                let mut radiance = Radiance::default();
                worker.start_pixel(self.points(x, y));
                worker.sample(middle(x), middle(y), 1.0, &mut radiance);
                for (deferred, _, _) in radiance.deferred() {
                    worker.trace(*deferred, Band::single(587.5618));
                }
            }
            worker.into_noted()
        };
        let rows: Vec<usize> = (0..height).step_by(stride).collect();
        rows.into_par_iter().flat_map_iter(row).collect()
    }

    /// Renders all passes, each with photons of its own if there are any, and takes the mean.
    fn trace<R: Resolver>(&self, start: Instant, new_resolver: impl Fn() -> R + Sync) -> Pixels {
        let Some(thrower) = self.thrower else { return self.trace_pass((0, None), start, &new_resolver) };
        let (mut mean, mut throwing) = (Mean::default(), 0.0);
        let mut photons = None;
        for pass in 0..thrower.passes() {
            let thrown = Instant::now();
            let maps = thrower.pass(pass, self.watch);
            throwing += thrown.elapsed().as_secs_f64();
            mean.add(self.trace_pass((pass, Some(&maps)), start, &new_resolver));
            photons = Some(PhotonReport::new(&maps, thrower.idle_lights(), throwing));
        }
        Pixels { photons, ..mean.into_pixels() }
    }

    /// Renders all tiles, each by whichever thread is free; each thread has one resolver.
    fn trace_pass<R: Resolver>(
        &self,
        (pass, caustics): (u32, Option<&dyn Caustics>),
        start: Instant,
        new_resolver: &(impl Fn() -> R + Sync),
    ) -> Pixels {
        let preparation_seconds = start.elapsed().as_secs_f64();
        let traced = Instant::now();
        self.watch.stage(LAST_STAGE, (self.size[0] * self.size[1]) as u64);
        let [width, height] = self.size;
        let across = width.div_ceil(TILE);
        let tiles = across * height.div_ceil(TILE);
        let next = AtomicUsize::new(0);
        let shared = Mutex::new((vec![Colour::default(); width * height], 0_u64));
        rayon::broadcast(|_| {
            let mut worker = Worker::new(self.scene, self.order);
            if let Some(indirect) = self.indirect {
                worker = worker.with_indirect(indirect);
            }
            if let Some(caustics) = caustics {
                worker = worker.with_caustics(caustics);
            }
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
                    colours.push(self.pixel([x, y], pass, &mut worker, &mut resolver));
                }
                if let Ok(mut shared) = shared.lock() {
                    for (row, y) in colours.chunks(right - left).zip(top..bottom) {
                        shared.0[y * width + left..y * width + right].copy_from_slice(row);
                    }
                }
                self.watch.add(colours.len() as u64);
            }
            if let Ok(mut shared) = shared.lock() {
                shared.1 += worker.rays();
            }
        });
        let (colours, rays) = shared.into_inner().unwrap_or_default();
        Pixels { colours, rays, seconds: traced.elapsed().as_secs_f64(), preparation_seconds, photons: None }
    }

    /// The random numbers of a pixel.
    #[allow(clippy::cast_possible_truncation, reason = "a hashed seed; pictures are smaller")]
    const fn points(&self, x: usize, y: usize) -> SobolSequence {
        let seed = (self.seed ^ (self.seed >> 32)) as u32;
        SobolSequence::for_pixel(x as u32, y as u32, seed)
    }

    /// One pixel: all its camera rays in one expression, evaluated once.
    #[allow(clippy::cast_precision_loss, reason = "pixel coordinates")]
    fn pixel<R: Resolver>(&self, [x, y]: [usize; 2], pass: u32, worker: &mut Worker<'_>, resolver: &mut R) -> Colour {
        let mut radiance = Radiance::default();
        let weight = 1.0 / f64::from(self.samples);
        let points = self.points(x, y);
        worker.start_pixel(points);
        let first = pass.wrapping_mul(self.samples);
        worker.skip_samples(first);
        for sample in first..first.saturating_add(self.samples) {
            let [dx, dy] = self.filter.square_to_offset(points.point(sample, 0)).map(f64::from);
            worker.sample(x as f64 + 0.5 + dx, y as f64 + 0.5 + dy, weight, &mut radiance);
        }
        let colour = resolver.resolve(&radiance, worker);
        Colour { photon_delta_e: noise(colour.xyz, worker, resolver), ..colour }
    }
}

/// The ΔE*ab that the colour changes by with a standard error more of the light that photons found, of each product by itself.
fn noise<R: Resolver>(xyz: [f64; 3], worker: &mut Worker<'_>, resolver: &mut R) -> f64 {
    let noise = worker.take_noise();
    if noise.terms().is_empty() {
        return 0.0;
    }
    let mut squares = [0.0; 3];
    for (monomial, error) in noise.terms() {
        let mut one = Radiance::default();
        one.add(*monomial, *error);
        let part = resolver.resolve(&one, worker).xyz;
        squares = core::array::from_fn(|a| squares[a] + part[a] * part[a]);
    }
    let more = core::array::from_fn(|a| xyz[a] + squares[a].sqrt());
    delta_e_ab(xyz_to_lab(xyz, rgb::WHITE), xyz_to_lab(more, rgb::WHITE))
}

/// The mean of passes.
#[derive(Default)]
struct Mean {
    sum: Option<Pixels>,
    passes: u32,
}

impl Mean {
    fn add(&mut self, pass: Pixels) {
        self.passes += 1;
        let Some(sum) = &mut self.sum else {
            self.sum = Some(pass);
            return;
        };
        sum.rays += pass.rays;
        sum.seconds += pass.seconds;
        for (sum, colour) in sum.colours.iter_mut().zip(pass.colours) {
            *sum = Colour {
                xyz: core::array::from_fn(|a| sum.xyz[a] + colour.xyz[a]),
                radius: core::array::from_fn(|a| sum.radius[a] + colour.radius[a]),
                delta_e: sum.delta_e + colour.delta_e,
                path_delta_e: sum.path_delta_e + colour.path_delta_e,
                // Passes are independent.
                photon_delta_e: sum.photon_delta_e.hypot(colour.photon_delta_e),
                intervals: sum.intervals.max(colour.intervals),
            };
        }
    }

    fn into_pixels(self) -> Pixels {
        let mut pixels = self.sum.unwrap_or_default();
        if self.passes < 2 {
            return pixels;
        }
        let share = 1.0 / f64::from(self.passes);
        for colour in &mut pixels.colours {
            let [xyz, radius] = [colour.xyz, colour.radius].map(|v| v.map(|v| v * share));
            let [scaled, box_size, white] = [xyz, radius, rgb::WHITE].map(|v| v.map(|v| v * Y_INTEGRAL));
            *colour = Colour {
                xyz,
                radius,
                // The box of the mean is the mean of the boxes.
                delta_e: delta_e_bound(scaled, box_size, white).delta_e,
                path_delta_e: colour.path_delta_e * share,
                photon_delta_e: colour.photon_delta_e * share,
                intervals: colour.intervals,
            };
        }
        pixels
    }
}

impl Pixels {
    fn into_rendering(self, [width, height]: [usize; 2], samples: u32, bounded: bool) -> Result<Rendering, ImageError> {
        let raster = Raster::from_pixels(width, height, self.colours)?;
        Ok(Rendering {
            picture: raster.map(|c| rgb::xyz_to_linear_rgb(c.xyz).map(single)),
            #[allow(clippy::cast_precision_loss, reason = "at most some hundred")]
            intervals: raster.map(|c| c.intervals as f32),
            delta_e: bounded.then(|| raster.map(|c| single_above(c.delta_e))),
            path_delta_e: bounded.then(|| raster.map(|c| single_above(c.path_delta_e))),
            photon_delta_e: Some(raster.map(|c| single_above(c.photon_delta_e))),
            variance: None,
            samples,
            rays: self.rays,
            seconds: self.seconds,
            preparation_seconds: self.preparation_seconds,
            between: None,
            photons: None,
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
