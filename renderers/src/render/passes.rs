//! Passes over all pixels, each with camera rays and photons of its own, and their mean.

use core::sync::atomic::{AtomicUsize, Ordering};
use std::sync::Mutex;
use std::time::Instant;

use rayon::prelude::*;
use spectral_core::bound::delta_e_bound;
use spectral_core::colour::{delta_e_ab, rgb, xyz_to_lab};

use super::photons::Thrower;
use super::{LAST_STAGE, PhotonReport, Rendering, SpectrumSink, Watch, single, single_above};
use crate::geometry::sampling::SobolSequence;
use crate::geometry::{Filter, Hit};
use crate::image::{ImageError, Raster};
use crate::spectral::{Colour, FactorOrder, Radiance, Resolver, Tracer, Y_INTEGRAL};
use crate::whitted::{Caustics, Indirect, Whitted, Worker};

/// Pixels along the side of the squares that threads take in turn.
const TILE: usize = 16;

/// Products of spectra that a thread remembers. Metals that mirror each other make ever new ones.
const MAX_MONOMIALS: usize = 1 << 15;

/// What all threads share.
pub(super) struct Frame<'s> {
    pub(super) size: [usize; 2],
    pub(super) samples: u32,
    pub(super) seed: u64,
    pub(super) filter: Filter,
    pub(super) scene: &'s Whitted,
    pub(super) order: FactorOrder,
    /// What colour differences are relative to.
    pub(super) white: [f64; 3],
    /// Light between surfaces, in place of the ambient term.
    pub(super) indirect: Option<&'s dyn Indirect>,
    /// Throws photons, for light by way of mirrors and glass.
    pub(super) thrower: Option<&'s Thrower<'s>>,
    pub(super) watch: &'s dyn Watch,
    /// Takes the spectra of pixels.
    pub(super) sink: Option<&'s dyn SpectrumSink>,
}

/// The most places that the camera sees which light between surfaces is prepared for.
const MOST_SEEN: usize = 1 << 18;

/// The colours of all pixels, row by row.
#[derive(Default)]
pub(super) struct Pixels {
    colours: Vec<Colour>,
    rays: u64,
    seconds: f64,
    preparation_seconds: f64,
    pub(super) photons: Option<PhotonReport>,
}

impl Frame<'_> {
    /// Where the camera sees surfaces that light between them matters for: through the middles of pixels, of every one or, in large
    /// pictures, of some.
    #[allow(clippy::cast_precision_loss, reason = "pixel coordinates")]
    pub(super) fn seen(&self) -> Vec<Hit> {
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
                    worker.trace_gathered(*deferred);
                }
            }
            worker.into_noted()
        };
        let rows: Vec<usize> = (0..height).step_by(stride).collect();
        rows.into_par_iter().flat_map_iter(row).collect()
    }

    /// Renders all passes, each with photons of its own if there are any, and takes the mean.
    pub(super) fn trace<R: Resolver>(&self, start: Instant, new_resolver: impl Fn() -> R + Sync) -> Pixels {
        let Some(thrower) = self.thrower else { return self.trace_pass((0, None), start, &new_resolver) };
        let (first, mut throwing) = thrower.first();
        let (mut mean, mut photons) = (Mean::default(), None);
        for pass in 0..thrower.passes() {
            let thrown = Instant::now();
            let own = (pass > 0).then(|| thrower.pass(pass, self.watch));
            if own.is_some() {
                throwing += thrown.elapsed().as_secs_f64();
            }
            let Some(maps) = own.as_ref().or(first) else { continue };
            mean.add(self.trace_pass((pass, Some(maps)), start, &new_resolver));
            photons = Some(PhotonReport::new(maps, thrower.idle_lights(), throwing));
        }
        Pixels { photons, ..mean.into_pixels(self.white) }
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
            let mut resolver = new_resolver();
            let mut worker = Worker::new(self.scene, self.order).with_tolerance(resolver.tolerance());
            if let Some(indirect) = self.indirect {
                worker = worker.with_indirect(indirect);
            }
            if let Some(caustics) = caustics {
                worker = worker.with_caustics(caustics);
            }
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

    /// How many passes there are.
    fn passes(&self) -> f64 {
        self.thrower.map_or(1.0, |thrower| f64::from(thrower.passes()))
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
        if let Some(sink) = self.sink {
            sink.pixel([x, y], resolver.spectrum(), 1.0 / self.passes());
        }
        Colour { photon_delta_e: noise((colour.xyz, self.white), worker, resolver), ..colour }
    }
}

/// The ΔE*ab that the colour changes by with a standard error more of the light that photons found, of each product by itself.
fn noise<R: Resolver>((xyz, white): ([f64; 3], [f64; 3]), worker: &mut Worker<'_>, resolver: &mut R) -> f64 {
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
    delta_e_ab(xyz_to_lab(xyz, white), xyz_to_lab(more, white))
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

    fn into_pixels(self, white: [f64; 3]) -> Pixels {
        let mut pixels = self.sum.unwrap_or_default();
        if self.passes < 2 {
            return pixels;
        }
        let share = 1.0 / f64::from(self.passes);
        for colour in &mut pixels.colours {
            let [xyz, radius] = [colour.xyz, colour.radius].map(|v| v.map(|v| v * share));
            let [scaled, box_size, white] = [xyz, radius, white].map(|v| v.map(|v| v * Y_INTEGRAL));
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
    pub(super) fn into_rendering(
        self,
        [width, height]: [usize; 2],
        samples: u32,
        bounded: bool,
    ) -> Result<Rendering, ImageError> {
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
            gather: None,
        })
    }
}
