//! An unbiased path tracer: the ground truth that other renderers are judged by, not a product of its own.
//!
//! Radiance is estimated by paths from the eye. At every surface that scatters, light is looked for in a direction to a light and found in a
//! direction chosen by the material, and both are weighted by Veach's power heuristic, so that no light counts twice. A path carries the
//! whole spectrum, as means over bins, until it is refracted where the index depends on the wavelength; from there it
//! carries one wavelength. Paths end at random, and those that go on count the more.
//!
//! `max_depth` and `rr_depth` of a scene's `path` integrator have Mitsuba's meaning: the longest path in segments, and how many
//! scatterings later than which paths may end at random. With other integrators, paths are unlimited. The ambient term, which stands for
//! indirect light, is left out. Light from points and parallel light isn't found through glass or by mirrors: only lights with an area can be.
//!
//! Random numbers are Owen-scrambled Sobol points, padded to as many dimensions as there are; runs of 64 samples are scrambled
//! independently, so that the variance of a pixel can be told from its runs. Every sample is a pure function of pixel, number and seed, and
//! sums are in the order of the numbers: the result doesn't depend on the number of threads, nor on where a rendering was interrupted.

mod carrier;
mod film;
mod light;
mod probe;
mod scatter;
mod state;
mod trace;
mod triple;

use core::sync::atomic::{AtomicU64, Ordering};
use core::time::Duration;
use std::path::Path;
use std::time::Instant;

use rayon::prelude::*;
use spectral_core::colour::rgb::xyz_to_linear_rgb;

use crate::direct;
use crate::frame::{Frame as SurfaceFrame, Parametrisation};
use crate::geometry::sampling::SobolSequence;
use crate::geometry::{Camera, Filter, Hit, World};
use crate::image::{ImageError, Raster};
use crate::material::Material;
use crate::render::{Options, Rendering, Spectra, Variance, bilinear, check_area, filter, prefiltered, single};
use crate::scene::{Emitter, Integrator, Scene};
use crate::spectral::{Components, Factor, Palette, Role, Steering, UniformBins};
use crate::whitted::{RenderError, camera};
use carrier::{Carrier, Rows};
use film::{Pixel, RUN};
use light::Lights;
pub use probe::{Probe, Sampled};
use state::Identity;
use trace::{Points, Walk};
use triple::Triple;

/// Pixels that a thread renders at a time.
const CHUNK: usize = 64;

/// The most pixels: their sums take 1.75 GiB.
const MOST_PIXELS: u64 = 1 << 24;

/// How often the state is saved.
const SAVE_EVERY: Duration = Duration::from_secs(60);

/// How lights are found. All ways have the same mean, but for lights without area, which are always looked for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Strategy {
    /// Looked for and come upon, each weighted.
    #[default]
    Both,
    /// Looked for alone.
    Lights,
    /// Come upon alone.
    Scattering,
}

/// Which paths count.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Paths {
    /// All of them.
    #[default]
    All,
    /// All but caustics that are seen directly: paths L S⁺ D E, along which the light of a surface that shines (L) meets one or more
    /// mirrors and smooth boundaries (S), then one surface that scatters it into a solid angle (D), and from there the eye.
    ///
    /// This is what light tracing finds by connecting particles to the eye: its picture of these paths and this one add up to the whole.
    /// Caustics seen in mirrors or through glass (L S⁺ D S⁺ E), caustics' light scattered once more (L S⁺ D … D E), and what the environment
    /// shines through glass and by mirrors, still count here.
    WithoutCaustics,
}

/// How far paths go.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Settings {
    max_depth: Option<u32>,
    rr_depth: u32,
}

/// Mitsuba's default.
const RR_DEPTH: u32 = 5;

impl Settings {
    const fn new(integrator: Integrator) -> Self {
        match integrator {
            Integrator::Path { max_depth, rr_depth } => Self { max_depth, rr_depth },
            _ => Self { max_depth: None, rr_depth: RR_DEPTH },
        }
    }
}

/// What a shape does with light.
#[derive(Clone, Debug)]
struct Surface {
    material: Material,
    /// The radiance of its front.
    emission: Option<Factor>,
    /// Where its material has axes, what they are.
    parametrisation: Option<Parametrisation>,
}

/// A scene made ready for tracing paths.
#[derive(Debug)]
pub struct PathTracer {
    world: World,
    camera: Camera,
    /// For each shape, what it does.
    surfaces: Vec<Surface>,
    lights: Lights,
    settings: Settings,
    strategy: Strategy,
    paths: Paths,
    steering: Steering,
}

impl PathTracer {
    /// Makes a scene ready; its spectra are added to the palette.
    ///
    /// # Errors
    /// Whatever this renderer can't do.
    pub fn new(scene: &Scene, size: [u32; 2], palette: &mut Palette) -> Result<Self, RenderError> {
        Self::steered(scene, size, palette, Steering::default())
    }

    /// The same with lights and ends of paths chosen otherwise: the mean is the same, the noise isn't.
    ///
    /// # Errors
    /// Whatever this renderer can't do.
    pub fn steered(
        scene: &Scene,
        size: [u32; 2],
        palette: &mut Palette,
        steering: Steering,
    ) -> Result<Self, RenderError> {
        let world = direct::world(scene).map_err(|e| RenderError::new(e.to_string()))?;
        let mut surfaces = Vec::new();
        for (number, shape) in scene.shapes.iter().enumerate() {
            let material = Material::new(scene, shape.bsdf, palette)?;
            let first = world.primitives(number).start;
            let parametrisation = material.has_axes().then(|| Parametrisation::new(&shape.geometry, first));
            surfaces.push(Surface { material, emission: None, parametrisation });
        }
        for emitter in &scene.emitters {
            if let Emitter::Area { shape, radiance } = emitter
                && let Some(surface) = surfaces.get_mut(shape.0)
            {
                surface.emission = Some(palette.factor(scene.spectrum(*radiance), Role::Light));
            }
        }
        let lights = Lights::new(scene, &world, palette, steering.lights)?;
        let settings = Settings::new(scene.integrator);
        let (strategy, paths) = (Strategy::default(), Paths::default());
        Ok(Self { camera: camera(scene, size)?, world, surfaces, lights, settings, strategy, paths, steering })
    }
}

impl Surface {
    /// The axes at a hit, if the material has some.
    fn frame(&self, hit: &Hit) -> Option<SurfaceFrame> {
        self.parametrisation.as_ref().map(|parametrisation| parametrisation.frame(hit))
    }
}

/// How a path-traced rendering runs.
#[derive(Clone, Copy, Debug, Default)]
pub struct Run<'a> {
    /// How lights are found.
    pub strategy: Strategy,
    /// Which paths count.
    pub paths: Paths,
    /// The file that keeps what has been rendered. If it is there, the rendering goes on from it, up to the number of samples asked for
    /// altogether; it is written about every minute and at the end, and is always complete.
    pub state: Option<&'a Path>,
}

/// Renders a scene by path tracing, as [`render`](crate::render::render) does, with more to choose.
///
/// # Errors
/// What the scene asks for and this renderer can't do; adaptive intervals; a state file of something else.
pub fn render(
    scene: &Scene,
    options: &Options,
    run: Run<'_>,
    progress: &(dyn Fn(usize) + Sync),
) -> Result<Rendering, RenderError> {
    let start = Instant::now();
    let size = options.size.unwrap_or([scene.film.width, scene.film.height]);
    check_area(size)?;
    check_memory(size)?;
    let mut palette = Palette::default();
    let steering = options.steering.unwrap_or_default();
    let tracer = PathTracer::steered(scene, size, &mut palette, steering)?;
    let tracer = PathTracer { strategy: run.strategy, paths: run.paths, ..tracer };
    let seed = options.seed.unwrap_or(scene.sampler.seed);
    let size = size.map(|s| s as usize);
    // A run that is steered otherwise has other samples.
    let spectra = match options.steering {
        Some(steering) if steering != Steering::default() => format!("{}/{steering}", options.spectra),
        _ => options.spectra.to_string(),
    };
    let frame = Frame {
        identity: Identity { scene: state::digest(scene), size, seed, spectra, paths: run.paths },
        samples: options.samples.unwrap_or(scene.sampler.sample_count).max(1),
        filter: filter(scene.film.filter)?,
        tracer: &tracer,
        state: run.state,
        start,
        progress,
    };
    let with_bins = |bins: UniformBins| frame.render(|| Rows::new(&bins), bins.len());
    let with_components = |components: Components| frame.render(|| Triple::new(&components), 3);
    match options.spectra {
        Spectra::Interval(_) => Err(RenderError::new(
            "the path tracer has no adaptive intervals: choose uniform:N, rgb, rgb-prefiltered, bilinear or smits",
        )),
        Spectra::Uniform(count) => with_bins(UniformBins::new(&palette, count).map_err(RenderError::new)?),
        Spectra::Wavelengths(step) => with_bins(UniformBins::at_wavelengths(&palette, step).map_err(RenderError::new)?),
        Spectra::Smits => with_bins(UniformBins::smits(&palette).map_err(RenderError::new)?),
        Spectra::Rgb => with_components(Components::naive(&palette).map_err(RenderError::new)?),
        Spectra::RgbPrefiltered => with_components(prefiltered(scene, &palette)?),
        Spectra::Bilinear | Spectra::BilinearAlpha(_) => with_components(bilinear(options.spectra, &palette)?),
    }
}

/// Refuses pictures whose sums would take too much memory.
fn check_memory([width, height]: [u32; 2]) -> Result<(), RenderError> {
    let pixels = u64::from(width) * u64::from(height);
    if pixels <= MOST_PIXELS {
        return Ok(());
    }
    let gigabytes = (pixels * size_of::<Pixel>() as u64).div_ceil(1 << 30);
    Err(RenderError::new(format!(
        "path tracing {width} × {height} pixels takes {gigabytes} GiB: at most {MOST_PIXELS} pixels are allowed"
    )))
}

/// What all threads share.
struct Frame<'s> {
    identity: Identity,
    samples: u32,
    filter: Filter,
    tracer: &'s PathTracer,
    state: Option<&'s Path>,
    start: Instant,
    progress: &'s (dyn Fn(usize) + Sync),
}

impl Frame<'_> {
    fn render<C: Carrier + Send>(
        &self,
        carrier: impl Fn() -> C + Sync,
        components: usize,
    ) -> Result<Rendering, RenderError> {
        let (mut pixels, first) = self.begin()?;
        let preparation_seconds = self.start.elapsed().as_secs_f64();
        let (traced, mut saved) = (Instant::now(), Instant::now());
        let done = AtomicU64::new(0);
        let (mut next, mut rays) = (first, 0);
        while next < self.samples {
            let end = self.samples.min((next / RUN + 1) * RUN);
            rays += self.pass(&mut pixels, [next, end], &carrier, |samples| self.report(&done, samples, first));
            next = end;
            if next < self.samples && saved.elapsed() >= SAVE_EVERY {
                self.save(&pixels, next)?;
                saved = Instant::now();
            }
        }
        if first < self.samples {
            self.save(&pixels, self.samples)?;
        }
        let seconds = [traced.elapsed().as_secs_f64(), preparation_seconds];
        self.picture(&pixels, components, rays, seconds).map_err(|e| RenderError::new(e.to_string()))
    }

    /// All pixels, and how many samples they have.
    fn begin(&self) -> Result<(Vec<Pixel>, u32), RenderError> {
        let [width, height] = self.identity.size;
        let found = self.state.map_or(Ok(None), |path| state::read(path, &self.identity))?;
        let (pixels, samples) = found.unwrap_or_else(|| (vec![Pixel::default(); width * height], 0));
        if samples <= self.samples {
            return Ok((pixels, samples));
        }
        let file = self.state.unwrap_or_else(|| Path::new("")).display();
        Err(RenderError::new(format!(
            "{file}: has {samples} samples per pixel already, more than the {} asked for",
            self.samples
        )))
    }

    fn save(&self, pixels: &[Pixel], samples: u32) -> Result<(), RenderError> {
        self.state.map_or(Ok(()), |path| state::write(path, &self.identity, pixels, samples))
    }

    /// Tells of whole pixels as shares of all samples are done.
    #[allow(clippy::cast_possible_truncation, reason = "at most the number of pixels")]
    fn report(&self, done: &AtomicU64, samples: u64, first: u32) {
        let each = u64::from(self.samples - first);
        let before = done.fetch_add(samples, Ordering::Relaxed);
        (self.progress)(((before + samples) / each - before / each) as usize);
    }

    /// Samples `from`… of all pixels, within one run; returns the rays traced.
    fn pass<C: Carrier + Send>(
        &self,
        pixels: &mut [Pixel],
        [from, to]: [u32; 2],
        carrier: &(impl Fn() -> C + Sync),
        report: impl Fn(u64) + Sync,
    ) -> u64 {
        let [width, _] = self.identity.size;
        let seed = run_seed(self.identity.seed, from / RUN);
        let trace = |carrier: &mut C, chunk: usize, pixels: &mut [Pixel]| {
            let mut walk = Walk::new(self.tracer);
            for (number, pixel) in (chunk * CHUNK..).zip(pixels.iter_mut()) {
                let [x, y] = [number % width, number / width];
                for sample in from..to {
                    pixel.add(sample, self.sample([x, y], seed, sample, &mut walk, carrier));
                }
            }
            report(pixels.len() as u64 * u64::from(to - from));
            walk.rays()
        };
        let chunks = pixels.par_chunks_mut(CHUNK).enumerate();
        chunks.map_init(carrier, |carrier, (chunk, pixels)| trace(carrier, chunk, pixels)).sum()
    }

    /// XYZ of one sample of a pixel.
    #[allow(clippy::cast_precision_loss, clippy::cast_possible_truncation, reason = "pixel coordinates")]
    fn sample(
        &self,
        [x, y]: [usize; 2],
        seed: u32,
        sample: u32,
        walk: &mut Walk<'_>,
        carrier: &mut impl Carrier,
    ) -> [f64; 3] {
        let sequence = SobolSequence::for_pixel(x as u32, y as u32, seed);
        let points = Points { sequence, index: sample % RUN };
        let [dx, dy] = self.filter.square_to_offset(points.camera());
        let film = [x as f64 + 0.5 + f64::from(dx), y as f64 + 0.5 + f64::from(dy)].map(|c| c as f32);
        let ray = self.tracer.camera.ray(film[0], film[1]);
        walk.path(ray, points, carrier);
        carrier.xyz()
    }

    fn picture(
        &self,
        pixels: &[Pixel],
        components: usize,
        rays: u64,
        [seconds, preparation_seconds]: [f64; 2],
    ) -> Result<Rendering, ImageError> {
        let [width, height] = self.identity.size;
        let pixel = |x: usize, y: usize| &pixels[y * width + x];
        let variances = Raster::from_fn(width, height, |x, y| pixel(x, y).variance(self.samples).unwrap_or_default())?;
        let variance = (self.samples >= 2).then(|| Variance {
            rgb: variances.map(|[r, g, b, _]| [*r, *g, *b].map(single)),
            luminance: variances.map(|[_, _, _, y]| single(*y)),
        });
        #[allow(clippy::cast_precision_loss, reason = "at most some thousand")]
        let intervals = variances.map(|_| components as f32);
        Ok(Rendering {
            between: None,
            picture: Raster::from_fn(width, height, |x, y| {
                xyz_to_linear_rgb(pixel(x, y).mean(self.samples)).map(single)
            })?,
            intervals,
            delta_e: None,
            path_delta_e: None,
            photon_delta_e: None,
            photons: None,
            gather: None,
            variance,
            samples: self.samples,
            rays,
            seconds,
            preparation_seconds,
        })
    }
}

/// The seed of a run's point sets (Steele, Lea and Flood 2014, `SplitMix64`).
#[allow(clippy::cast_possible_truncation, reason = "the upper half of a hash")]
const fn run_seed(seed: u64, run: u32) -> u32 {
    let x = seed.wrapping_add((run as u64 + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15));
    let x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    ((x ^ (x >> 31)) >> 32) as u32
}
