//! The spectrum of the light that falls on what each pixel sees.

use core::f64::consts::PI;

use rayon::prelude::*;
use spectral_core::action::MAXIMUM_LUMINOUS_EFFICACY;
use spectral_core::{Observer, tristimulus};

use super::Layer;
use super::meter::{Found, Measure, NOTHING};
use crate::geometry::Hit;
use crate::geometry::sampling::SobolSequence;
use crate::radiosity::{Caustics, Field, FieldSettings, Radiosity, Solution};
use crate::render::{BetweenOptions, Spectra, Watch};
use crate::scene::Scene;
use crate::spectral::{Factor, FactorOrder, Palette, UniformBins};
use crate::whitted::{Indirect, RenderError, Whitted, Worker, receiver};

/// Bins of the spectra that tell where light is gathered, as in pictures.
const GUIDE_BINS: usize = 12;

/// What the camera rays of every pixel meet first.
pub(super) struct Seen {
    size: [usize; 2],
    /// Camera rays of a pixel.
    pub(super) samples: u32,
    /// Row by row, all of a pixel one after the other.
    hits: Vec<Option<Hit>>,
}

impl Seen {
    /// Traces one ray through the middle of each pixel, or `samples` well-distributed ones.
    #[allow(clippy::cast_precision_loss, clippy::cast_possible_truncation, reason = "pixel coordinates, a hashed seed")]
    pub(super) fn new(whitted: &Whitted, size: [usize; 2], samples: u32, seed: u64) -> Self {
        let [width, height] = size;
        let seed = (seed ^ (seed >> 32)) as u32;
        let row = |y: usize| {
            (0..width).flat_map(move |x| {
                let points = SobolSequence::for_pixel(x as u32, y as u32, seed);
                (0..samples).map(move |sample| {
                    let [u, v] = if samples == 1 { [0.5; 2] } else { points.point(sample, 0) };
                    whitted.world().closest_hit(&whitted.camera().ray(x as f32 + u, y as f32 + v))
                })
            })
        };
        Self { size, samples, hits: (0..height).into_par_iter().flat_map_iter(row).collect() }
    }

    /// The places that a pixel sees.
    fn hits(&self, pixel: usize) -> impl Iterator<Item = &Hit> {
        let samples = self.samples as usize;
        self.hits[pixel * samples..][..samples].iter().flatten()
    }

    /// A number of the flat part of a surface that a pixel sees; 0 for none. Round surfaces are one part.
    pub(super) fn part(&self, pixel: usize) -> u32 {
        let Some(hit) = self.hits(pixel).next() else { return 0 };
        let is_flat = hit.planar && hit.geometric_normal.dot(hit.shading_normal) > 1.0 - 1e-5;
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "from 0 to 200")]
        let coarse = |c: f32| if is_flat { (100.0 * c + 100.5) as u32 } else { 0 };
        let n = hit.geometric_normal;
        let direction = [n.x, n.y, n.z].into_iter().fold(0, |all, c| all * 202 + coarse(c));
        1 + hit.shape.wrapping_mul(8_242_408).wrapping_add(direction)
    }

    /// Whether a pixel sees a surface.
    pub(super) fn sees(&self, pixel: usize) -> bool {
        self.hits(pixel).next().is_some()
    }
}

/// What the light of a layer is made from.
pub(super) struct Job<'s> {
    pub(super) scene: &'s Scene,
    pub(super) whitted: &'s Whitted,
    pub(super) palette: &'s Palette,
    /// Light between surfaces; the scene's ambient term stands for it without.
    pub(super) radiosity: Option<&'s Radiosity>,
    pub(super) between: BetweenOptions,
    pub(super) seen: &'s Seen,
    pub(super) watch: &'s dyn Watch,
}

impl Job<'_> {
    /// The values of all pixels, pixel by pixel, and what became of each.
    pub(super) fn measure(&self, layer: &Layer) -> Result<(Vec<f32>, Vec<Found>), RenderError> {
        let bins = match layer.spectra {
            Spectra::Wavelengths(step) => UniformBins::at_wavelengths(self.palette, step),
            _ => UniformBins::new(self.palette, super::LUMINOUS_BINS),
        }
        .map_err(RenderError::new)?;
        let exact = match layer.spectra {
            Spectra::Wavelengths(_) => None,
            _ => Some(self.luminous_integrals()?),
        };
        let [_, luminous, _] = bins.weights();
        let measure = layer.measure(luminous);
        let light = Light { whitted: self.whitted, bins: &bins, exact: exact.as_deref(), indirect: None };
        let Some(radiosity) = self.radiosity else { return Ok(self.pixels(layer, &light, &*measure)) };
        let guide = UniformBins::new(self.palette, GUIDE_BINS).map_err(RenderError::new)?;
        let refused = |error: crate::radiosity::RadiosityError| RenderError::new(error.to_string());
        let solution = radiosity.solve(&bins).map_err(refused)?;
        let guide = radiosity.solve(&guide).map_err(refused)?;
        let field = self.field([&solution, &guide]);
        Ok(self.pixels(layer, &Light { indirect: Some(&field), ..light }, &*measure))
    }

    /// Light between surfaces.
    fn field<'f>(&'f self, solutions: [&'f Solution<'f>; 2]) -> Field<'f> {
        self.watch.stage("light between surfaces", Field::STEPS);
        let BetweenOptions { accuracy, exact } = self.between;
        let settings = FieldSettings { accuracy, exact, caustics: Caustics::LeftOut };
        let hits: Vec<Hit> = self.seen.hits.iter().flatten().copied().collect();
        Field::new(self.scene, self.whitted, solutions, settings, &hits, &|steps| self.watch.add(steps))
    }

    /// ∫Sȳ of each leaf in nm times its unit, exact.
    fn luminous_integrals(&self) -> Result<Vec<f64>, RenderError> {
        let observer = Observer::cie_1931_2deg();
        let integral = |leaf: &crate::spectral::Tabulated| -> Result<f64, String> {
            let [_, y, _] = tristimulus(&observer, &leaf.spectrum()?, 380.0, 780.0);
            Ok(y)
        };
        self.palette.leaves().iter().map(|(leaf, _)| integral(leaf)).collect::<Result<_, _>>().map_err(RenderError::new)
    }

    fn pixels(&self, layer: &Layer, light: &Light<'_>, measure: &dyn Measure) -> (Vec<f32>, Vec<Found>) {
        let [width, height] = self.seen.size;
        let count = layer.quantities.len();
        let mut values = vec![NOTHING; width * height * count];
        let mut found = vec![Found::Nowhere; width * height];
        self.watch.stage("map", height as u64);
        let rows = values.par_chunks_mut(width * count).zip(found.par_chunks_mut(width)).enumerate();
        rows.for_each_init(
            || light.worker(),
            |worker, (y, (values, found))| {
                for (x, (values, found)) in values.chunks_mut(count).zip(found).enumerate() {
                    *found = light.measure(worker, self.seen.hits(y * width + x), measure, values);
                }
                self.watch.add(1);
            },
        );
        (values, found)
    }
}

/// What light is made of.
#[derive(Clone, Copy)]
struct Light<'s> {
    whitted: &'s Whitted,
    bins: &'s UniformBins,
    /// ∫Sȳ of each leaf, where the luminous integral alone counts.
    exact: Option<&'s [f64]>,
    indirect: Option<&'s dyn Indirect>,
}

/// The buffers of a thread.
struct Buffers<'s> {
    worker: Worker<'s>,
    spectrum: Vec<f64>,
    row: Vec<f64>,
}

impl<'s> Light<'s> {
    fn worker(&self) -> Buffers<'s> {
        let zeros = vec![0.0; self.bins.len()];
        Buffers { worker: Worker::new(self.whitted, FactorOrder::Free), spectrum: zeros.clone(), row: zeros }
    }

    /// Measures the mean of the light at some places.
    fn measure<'h>(
        &self,
        buffers: &mut Buffers<'_>,
        hits: impl Iterator<Item = &'h Hit>,
        measure: &dyn Measure,
        values: &mut [f32],
    ) -> Found {
        buffers.spectrum.fill(0.0);
        let (mut places, mut direct) = (0_u32, 0.0);
        for hit in hits {
            direct += self.add(buffers, hit);
            places += 1;
        }
        if places == 0 {
            return Found::Nowhere;
        }
        let share = 1.0 / f64::from(places);
        buffers.spectrum.iter_mut().for_each(|s| *s *= share);
        let Some(_) = self.exact else { return measure.measure(&buffers.spectrum, values) };
        // The spectrum has the light between surfaces alone.
        let found = measure.measure(&buffers.spectrum, values);
        let lux = MAXIMUM_LUMINOUS_EFFICACY * direct * share;
        #[allow(clippy::cast_possible_truncation, reason = "maps are kept in f32")]
        values.iter_mut().for_each(|value| *value = (f64::from(*value) + lux) as f32);
        if lux > 0.0 { Found::Light } else { found }
    }

    /// Adds the light at a place to the spectrum, or returns ∫Eȳ of what is known of it exactly.
    fn add(&self, buffers: &mut Buffers<'_>, hit: &Hit) -> f64 {
        let direct = buffers.worker.direct(&receiver(hit));
        let mut exact = 0.0;
        for (irradiance, light) in direct.iter().zip(self.whitted.lights()) {
            exact += self.add_light(buffers, light.factor(), *irradiance);
        }
        match self.indirect {
            Some(indirect) => {
                buffers.row.fill(0.0);
                indirect.irradiance(hit, &mut buffers.row);
                buffers.spectrum.iter_mut().zip(&buffers.row).for_each(|(s, r)| *s += r);
            }
            None => {
                for ambient in self.whitted.ambient() {
                    exact += self.add_light(buffers, *ambient, PI);
                }
            }
        }
        exact
    }

    fn add_light(&self, buffers: &mut Buffers<'_>, factor: Factor, irradiance: f64) -> f64 {
        let weight = factor.scale * irradiance;
        let Some(leaf) = factor.leaf else { return 0.0 };
        if weight == 0.0 {
            return 0.0;
        }
        if let Some(exact) = self.exact {
            return weight * exact.get(leaf as usize).copied().unwrap_or(0.0);
        }
        let means = self.bins.means(leaf).unwrap_or_default();
        buffers.spectrum.iter_mut().zip(means).for_each(|(s, m)| *s += weight * m);
        0.0
    }
}
