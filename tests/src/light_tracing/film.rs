//! Particles seen by the eye: a picture of the paths L S⁺ D E.

use core::f64::consts::PI;

use renderers::geometry::Filter;
use renderers::geometry::glam::{DAffine3, DVec3};
use renderers::image::Raster;
use renderers::render::Variance;
use renderers::scene::{self, Integrator};
use spectral_core::colour::rgb::xyz_to_linear_rgb;

use super::waves::Chooser;
use super::{Balance, Landing, LightTracer, TraceError, random, single};

/// Wavelengths that a particle carries.
const WAVES: usize = 8;

/// The golden section: multiples of it are spread evenly over the unit interval.
const GOLDEN: f64 = 0.618_033_988_749_894_9;

/// A picture of caustics seen directly, which every batch of particles makes better: paths L S⁺ D E.
///
/// Light that comes to the first diffuse surface (D) by way of one or more mirrors and boundaries of glass (S⁺) is connected to the eye by a
/// straight line, if nothing is in the way; neither light that comes straight there, nor caustics in mirrors or through glass, nor their light
/// reflected again. With [`WithoutCaustics`](renderers::path::Paths::WithoutCaustics), path tracing makes a picture of all paths but these.
///
/// XYZ is ∫Lā over 380–780 nm relative to ∫ȳ. Pixels are means over the scene's reconstruction filter. Paths have no more segments than the
/// scene's `path` integrator allows.
#[derive(Debug)]
pub struct Film<'t> {
    tracer: &'t LightTracer<'t>,
    chooser: Chooser,
    view: View,
    seed: u64,
    batches: u64,
    pixels: Vec<Pixel>,
}

/// A pixel's sums over batches: XYZ, and squares of linear R, G, B and Y.
#[derive(Clone, Copy, Debug, Default)]
struct Pixel {
    sum: [f64; 3],
    squares: [f64; 4],
}

fn channels(xyz: [f64; 3]) -> [f64; 4] {
    let [r, g, b] = xyz_to_linear_rgb(xyz);
    [r, g, b, xyz[1]]
}

impl<'t> Film<'t> {
    /// An empty picture.
    ///
    /// # Errors
    /// [`TraceError::Picture`].
    pub fn new(tracer: &'t LightTracer<'t>, size: [u32; 2], seed: u64) -> Result<Self, TraceError> {
        let view = View::new(tracer, size)?;
        let pixels = vec![Pixel::default(); view.size[0] * view.size[1]];
        Ok(Self { tracer, chooser: Chooser::new(), view, seed, batches: 0, pixels })
    }

    /// Traces so many batches more; returns the sum of their balances.
    ///
    /// # Errors
    /// [`TraceError::Spectrum`].
    pub fn add(&mut self, batches: u64) -> Result<Balance, TraceError> {
        // Batches' pictures are kept until they are added up in order.
        let most = 2 * rayon::current_num_threads() as u64;
        let end = self.batches + batches;
        let mut balance = Balance::default();
        while self.batches < end {
            let count = most.min(end - self.batches);
            for (picture, part) in self
                .tracer
                .batches(self.batches, count, |n| self.batch(n))
                .into_iter()
                .collect::<Result<Vec<_>, _>>()?
            {
                balance = balance.plus(part);
                for (pixel, xyz) in self.pixels.iter_mut().zip(picture) {
                    pixel.sum = core::array::from_fn(|c| pixel.sum[c] + xyz[c]);
                    let own = channels(xyz);
                    pixel.squares = core::array::from_fn(|c| pixel.squares[c] + own[c] * own[c]);
                }
            }
            self.batches += count;
        }
        Ok(balance)
    }

    /// The picture of one batch alone.
    fn batch(&self, number: u64) -> Result<(Vec<[f64; 3]>, Balance), TraceError> {
        // Batches share the spectrum out among them evenly: with wavelengths at random, all pixels' colours would be off together.
        #[allow(clippy::cast_precision_loss, reason = "batches are few")]
        let place = (random(!self.seed, 0).unit() + GOLDEN * number as f64).fract();
        let waves = self.chooser.waves::<WAVES>(self.tracer.scene, place)?;
        let mut pixels = vec![[0.0; 3]; self.pixels.len()];
        let balance = self.tracer.batch(&waves, [self.seed, number], |landing: &Landing<WAVES>| {
            let Some((film, factor)) = self.view.connect(self.tracer, landing) else { return };
            let mut xyz = [0.0; 3];
            for (k, observer) in waves.observer().iter().enumerate() {
                let radiance = factor * landing.flux[k] * landing.reflectance[k];
                xyz = core::array::from_fn(|c| xyz[c] + radiance * observer[c]);
            }
            self.view.splat(film, |pixel, weight| {
                pixels[pixel] = core::array::from_fn(|c| pixels[pixel][c] + weight * xyz[c]);
            });
        });
        Ok((pixels, balance))
    }

    /// How many batches it is made of.
    #[must_use]
    pub const fn batches(&self) -> u64 {
        self.batches
    }

    /// The picture in XYZ; NaN without a batch.
    #[must_use]
    pub fn xyz(&self) -> Vec<[f64; 3]> {
        let count = self.count();
        self.pixels.iter().map(|pixel| pixel.sum.map(|s| s / count)).collect()
    }

    /// The variance of the mean, for linear R, G, B and Y, from the differences between batches, of which there must be two.
    #[must_use]
    pub fn variances(&self) -> Vec<[f64; 4]> {
        let count = self.count();
        let of_pixel = |pixel: &Pixel| {
            let sum = channels(pixel.sum);
            let variance = |c: usize| (pixel.squares[c] - sum[c] * sum[c] / count) / ((count - 1.0) * count);
            core::array::from_fn(|c| variance(c).max(0.0))
        };
        self.pixels.iter().map(of_pixel).collect()
    }

    /// The picture in linear Rec. 709, and its variance.
    ///
    /// # Errors
    /// [`TraceError::Picture`] with less than two batches.
    pub fn picture(&self) -> Result<(Raster<[f64; 3]>, Variance), TraceError> {
        let [width, height] = self.view.size;
        if self.batches < 2 {
            return Err(TraceError::Picture);
        }
        let raster = |pixels| Raster::from_pixels(width, height, pixels).map_err(|_| TraceError::Picture);
        let picture = raster(self.xyz().into_iter().map(xyz_to_linear_rgb).collect())?;
        let variances = Raster::from_pixels(width, height, self.variances()).map_err(|_| TraceError::Picture)?;
        #[allow(clippy::cast_possible_truncation, reason = "pictures are f32")]
        let variance = Variance {
            rgb: variances.map(|[r, g, b, _]| [*r as f32, *g as f32, *b as f32]),
            luminance: variances.map(|[.., y]| *y as f32),
        };
        Ok((picture, variance))
    }

    #[allow(clippy::cast_precision_loss, reason = "counts are far below 2⁵³")]
    const fn count(&self) -> f64 {
        self.batches as f64
    }
}

/// The eye: a pinhole.
#[derive(Debug)]
struct View {
    to_local: DAffine3,
    eye: DVec3,
    size: [usize; 2],
    /// The side of a pixel at distance 1.
    pixel: f64,
    filter: Filter,
    /// Mirrors and boundaries on a path at most.
    most: u32,
}

impl View {
    fn new(tracer: &LightTracer<'_>, size: [u32; 2]) -> Result<Self, TraceError> {
        let scene = tracer.scene;
        if size.contains(&0) {
            return Err(TraceError::Picture);
        }
        let filter = match scene.film.filter {
            scene::Filter::Box => Ok(Filter::pixel()),
            scene::Filter::Tent { radius } => Filter::tent(radius),
            scene::Filter::Gaussian { stddev } => Filter::gaussian(stddev),
            _ => return Err(TraceError::Picture),
        };
        let most = match scene.integrator {
            Integrator::Path { max_depth: Some(segments), .. } => segments.saturating_sub(2),
            _ => u32::MAX,
        };
        Ok(Self {
            to_local: scene.camera.to_world.inverse(),
            eye: scene.camera.to_world.translation,
            size: size.map(|s| s as usize),
            pixel: 2.0 * scene.camera.half_width(size[0], size[1]) / f64::from(size[0]),
            filter: filter.map_err(|_| TraceError::Picture)?,
            most,
        })
    }

    /// Where on the film, in pixels, a particle's landing is seen, and for each unit of its flux times the surface's reflectance its radiance
    /// times the area of the film that it is seen on: cos θ / (π d² cos³ α p²), with the angle θ on the surface, the distance d, the angle
    /// α to the camera's axis and the side p of a pixel at distance 1.
    fn connect<const W: usize>(&self, tracer: &LightTracer<'_>, landing: &Landing<W>) -> Option<([f64; 2], f64)> {
        if landing.specular == 0 || landing.specular > self.most {
            return None;
        }
        let place = landing.point.position.as_dvec3();
        let local = self.to_local.transform_point3(place);
        let film = [0, 1].map(|axis: usize| {
            let middle = super::count(self.size[axis]) / 2.0;
            middle - [local.x, local.y][axis] / (local.z * self.pixel)
        });
        let reach = self.filter.radius();
        let outside = |axis: usize| !(-reach..super::count(self.size[axis]) + reach).contains(&film[axis]);
        if local.z <= 0.0 || outside(0) || outside(1) {
            return None;
        }
        let way = self.eye - place;
        let distance2 = way.length_squared();
        let [geometric, shading] = landing.normals;
        let leaving = way.dot(geometric) / distance2.sqrt();
        // Irradiance is by the shading normal, flux by the geometric one.
        let arriving = landing.direction.dot(shading) / landing.direction.dot(geometric);
        if !(leaving > 0.0 && arriving > 0.0) || tracer.world.occluded_point(&landing.point, single(self.eye)) {
            return None;
        }
        let axis = local.z / distance2.sqrt();
        Some((film, arriving * leaving / (PI * distance2 * axis.powi(3) * self.pixel * self.pixel)))
    }

    /// The pixels whose filter reaches a place on the film, with its density there.
    fn splat(&self, film: [f64; 2], mut add: impl FnMut(usize, f64)) {
        let reach = self.filter.radius();
        let range = |axis: usize| {
            // Centres are at halves.
            let first = super::floor((film[axis] - reach - 0.5).ceil().max(0.0));
            let last = super::floor((film[axis] + reach + 0.5).floor().max(0.0));
            first..last.min(self.size[axis])
        };
        for y in range(1) {
            let vertical = self.filter.density(super::count(y) + 0.5 - film[1]);
            for x in range(0) {
                let weight = vertical * self.filter.density(super::count(x) + 0.5 - film[0]);
                if weight > 0.0 {
                    add(y * self.size[0] + x, weight);
                }
            }
        }
    }
}
