//! Lighting measures in the room: a number for every pixel.
//!
//! | quantity | of what falls on the first surface seen | of what the camera receives |
//! |---|---|---|
//! | illuminance | lx | |
//! | luminance | | cd/m² |
//! | colour temperature, Duv, R_a, CRI00, a_cv, SY, melanopic DER | by default | on request |
//!
//! [`of_scene`] takes the light from a scene: direct light as in [`whitted`](crate::whitted), exact where few polygons are in the way, and light
//! between surfaces by [`radiosity`](crate::radiosity). The first surface counts, mirrors, glass and lamps too: the light that falls there.
//! [`of_spectra`] takes it from stored radiances.
//!
//! **Wavelengths.** Luminous quantities are integrals: light is taken by its means over 81 bins and ∫ȳ over each; direct illuminance is exact.
//! All others are sums over a grid, by the rule of `spectral light`: 5 nm, as CIE 13.3-1995 prescribes, where the spectra of all lights are
//! tables at whole multiples of 5 nm, 1 nm otherwise. Spectra are exact at these wavelengths, however often light was reflected.
//!
//! **No value.** Where no surface is seen; where there is no light, for all but the absolute quantities, which are 0 there; and outside of a
//! measure's domain: see [`Quantity`].

mod irradiance;
mod meter;
mod picture;
mod quantity;
mod statistics;
mod stored;

use alloc::sync::Arc;
use std::sync::Mutex;
use std::time::Instant;

use spectral_core::summation::SumGrid;

use crate::image::{ImageError, Raster, ScalarMap};
use crate::render::{self, BetweenOptions, Options, Renderer, Spectra, SpectrumSink, Watch};
use crate::scene::{self, Integrator, Scene};
use crate::spectral::{Palette, Role, is_on_grid};
use crate::whitted::{RenderError, Whitted};
use irradiance::Seen;
use meter::{Colours, Found, Luminous, Measure, NOTHING};
pub use picture::{Style, write_values};
pub use quantity::{Of, Quantity};
pub use statistics::Statistics;
use statistics::quantiles;
pub use stored::of_spectra;

/// Bins of luminous quantities.
const LUMINOUS_BINS: usize = 81;
/// Camera rays in a pixel of a map of radiance, unless asked for.
const RADIANCE_SAMPLES: u32 = 4;

/// How a scene is mapped.
#[derive(Clone, Debug, PartialEq)]
pub struct MapOptions {
    /// What is mapped.
    pub quantities: Vec<Quantity>,
    /// Of which light; `None`: each quantity's [default](Quantity::default_of).
    pub of: Option<Of>,
    /// Whitted or radiosity; `None`: what the scene asks for, see [`renderer`].
    pub renderer: Option<Renderer>,
    /// Size in pixels; `None`: the scene's.
    pub size: Option<[u32; 2]>,
    /// Camera rays in a pixel, the mean of whose light is measured; `None`: the middle of a pixel for irradiance, 4 for radiance.
    pub samples: Option<u32>,
    /// Light between surfaces.
    pub between: BetweenOptions,
    /// Wavelengths of colour measures, every 1 or 5 nm; `None`: what the lights' tables ask for.
    pub step: Option<u16>,
}

/// A quantity in every pixel.
#[derive(Clone, Debug)]
pub struct Map {
    /// What it is.
    pub quantity: Quantity,
    /// Of which light.
    pub of: Of,
    /// A value for each pixel; NaN where there is none.
    pub values: ScalarMap,
    /// The same in a few numbers.
    pub statistics: Statistics,
    /// Which pixels see the same flat part of a surface, by equal numbers, if that is known.
    pub surfaces: Option<Arc<Raster<u32>>>,
}

impl Map {
    fn new(quantity: Quantity, of: Of, values: ScalarMap, found: &[Found]) -> Self {
        let missing = |why: Found| {
            let pixels = values.pixels().iter().zip(found);
            pixels.filter(|(value, found)| value.is_nan() && **found == why).count()
        };
        let statistics = Statistics::new(&values, [missing(Found::Nowhere), missing(Found::Dark)]);
        Self { quantity, of, values, statistics, surfaces: None }
    }

    /// Between which values most pixels lie: 0.5 % are below, 0.5 % above; `None` without values.
    #[must_use]
    pub fn usual_range(&self) -> Option<[f64; 2]> {
        quantiles(&self.values, [0.005, 0.995])
    }
}

/// Maps of a scene, and what they took.
#[derive(Clone, Debug)]
pub struct Maps {
    /// In the order in which they were asked for.
    pub maps: Vec<Map>,
    /// What found the light.
    pub renderer: Renderer,
    /// Wavelengths of colour measures, every so many nm; `None` if there were none.
    pub step: Option<u16>,
    /// Time without reading the scene.
    pub seconds: f64,
}

/// The renderer for what a scene asks for: radiosity for paths of more than two segments, Whitted's for all others.
#[must_use]
pub const fn renderer(scene: &Scene) -> Renderer {
    match scene.integrator {
        Integrator::Path { max_depth: Some(0..=2), .. } => Renderer::Whitted,
        Integrator::Path { .. } => Renderer::Radiosity,
        _ => Renderer::Whitted,
    }
}

/// Maps of a scene, on all threads of the current rayon pool; the result doesn't depend on their number.
///
/// # Errors
/// A scene without surfaces; what the renderer can't do; a quantity that isn't one of the light that is asked for; a step that isn't 1 or 5.
pub fn of_scene(scene: &Scene, options: &MapOptions, watch: &dyn Watch) -> Result<Maps, RenderError> {
    let start = Instant::now();
    if scene.shapes.is_empty() {
        return Err(RenderError::new("the scene has no surfaces, so that there is nothing to map"));
    }
    let renderer = options.renderer.unwrap_or_else(|| renderer(scene));
    if !matches!(renderer, Renderer::Whitted | Renderer::Radiosity) {
        return Err(RenderError::new(format!("maps are made by whitted and radiosity, not by {renderer}")));
    }
    let size = options.size.unwrap_or([scene.film.width, scene.film.height]);
    render::check_area(size)?;
    let mut palette = Palette::default();
    let whitted = Whitted::new(scene, size, &mut palette)?;
    let step = step(&palette, options.step)?;
    let groups = groups(options)?;
    let mut work = Work { scene, options, renderer, size, whitted: &whitted, palette, seen: None, maps: Vec::new() };
    for of in [Of::Irradiance, Of::Radiance] {
        let layers: Vec<Layer> = groups.iter().filter(|(o, _)| *o == of).map(|(_, q)| Layer::new(q, step)).collect();
        match of {
            _ if layers.is_empty() => {}
            Of::Irradiance => work.irradiance(&layers, watch)?,
            Of::Radiance => work.radiance(&layers, watch)?,
        }
    }
    let order = |map: &Map| options.quantities.iter().position(|q| *q == map.quantity);
    work.maps.sort_by_key(order);
    let is_colour = options.quantities.iter().any(|q| !q.is_luminous());
    Ok(Maps { maps: work.maps, renderer, step: is_colour.then_some(step), seconds: start.elapsed().as_secs_f64() })
}

/// The grid that the lights' tables ask for.
fn step(palette: &Palette, asked: Option<u16>) -> Result<u16, RenderError> {
    match asked {
        Some(step @ (1 | 5)) => Ok(step),
        Some(step) => Err(RenderError::new(format!("colour measures are sums at 1 or 5 nm, not at {step}"))),
        None => {
            let mut lights = palette.leaves().iter().filter(|(_, role)| *role == Role::Light);
            Ok(if lights.all(|(light, _)| is_on_grid(light, 5.0)) { 5 } else { 1 })
        }
    }
}

/// Quantities that are measured of the same spectra.
fn groups(options: &MapOptions) -> Result<Vec<(Of, Vec<Quantity>)>, RenderError> {
    let mut groups: Vec<(Of, Vec<Quantity>)> = Vec::new();
    for quantity in &options.quantities {
        let of = options.of.unwrap_or_else(|| quantity.default_of());
        if !quantity.is_of(of) {
            return Err(RenderError::new(format!("{quantity} is not a quantity of {of}")));
        }
        let same = |(o, q): &&mut (Of, Vec<Quantity>)| {
            *o == of && q.first().is_some_and(|q| q.is_luminous() == quantity.is_luminous())
        };
        match groups.iter_mut().find(same) {
            Some((_, known)) if known.contains(quantity) => {}
            Some((_, known)) => known.push(*quantity),
            None => groups.push((of, vec![*quantity])),
        }
    }
    if groups.is_empty() { Err(RenderError::new("no quantity to map")) } else { Ok(groups) }
}

/// Some quantities, and the spectra that they are measured of.
struct Layer {
    quantities: Vec<Quantity>,
    spectra: Spectra,
}

impl Layer {
    fn new(quantities: &[Quantity], step: u16) -> Self {
        let luminous = quantities.first().is_some_and(|q| q.is_luminous());
        let spectra = if luminous { Spectra::Uniform(LUMINOUS_BINS) } else { Spectra::Wavelengths(step) };
        Self { quantities: quantities.to_vec(), spectra }
    }

    /// What makes numbers of spectra; `luminous` are the weights of the bins.
    fn measure(&self, luminous: &[f64]) -> Box<dyn Measure> {
        colours(self.spectra, &self.quantities).unwrap_or_else(|| Box::new(Luminous { weights: luminous.to_vec() }))
    }
}

/// Colour measures on the grid of some spectra, if they have one.
fn colours(spectra: Spectra, quantities: &[Quantity]) -> Option<Box<dyn Measure>> {
    match spectra {
        Spectra::Wavelengths(5) => Some(Box::new(Colours::new(SumGrid::CIE_5NM, quantities))),
        Spectra::Wavelengths(_) => Some(Box::new(Colours::new(SumGrid::CIE_1NM, quantities))),
        _ => None,
    }
}

/// Maps in the making.
struct Work<'s> {
    scene: &'s Scene,
    options: &'s MapOptions,
    renderer: Renderer,
    size: [u32; 2],
    whitted: &'s Whitted,
    palette: Palette,
    /// What the pixels see first.
    seen: Option<Seen>,
    maps: Vec<Map>,
}

impl Work<'_> {
    fn samples(&self, default: u32) -> u32 {
        self.options.samples.unwrap_or(default).max(1)
    }

    /// What the pixels see first.
    fn seen(&mut self, samples: u32) -> Seen {
        let seed = self.scene.sampler.seed;
        match self.seen.take() {
            Some(seen) if seen.samples == samples => seen,
            _ => Seen::new(self.whitted, self.size.map(|s| s as usize), samples, seed),
        }
    }

    fn irradiance(&mut self, layers: &[Layer], watch: &dyn Watch) -> Result<(), RenderError> {
        let seen = self.seen(self.samples(1));
        let radiosity = match self.renderer {
            Renderer::Radiosity => {
                Some(render::build_radiosity(self.scene, &self.options.between, &mut self.palette, watch)?)
            }
            _ => None,
        };
        let mut done = Vec::new();
        for layer in layers {
            let job = irradiance::Job {
                scene: self.scene,
                whitted: self.whitted,
                palette: &self.palette,
                radiosity: radiosity.as_ref(),
                between: self.options.between,
                seen: &seen,
                watch,
            };
            done.push(job.measure(layer)?);
        }
        for (layer, (values, found)) in layers.iter().zip(done) {
            self.add(layer, Of::Irradiance, (&values, &found), &seen)?;
        }
        self.seen = Some(seen);
        Ok(())
    }

    fn radiance(&mut self, layers: &[Layer], watch: &dyn Watch) -> Result<(), RenderError> {
        let samples = self.samples(RADIANCE_SAMPLES);
        let seen = self.seen(1);
        // A map has no use for what a filter takes from far pixels.
        let mut scene = self.scene.clone();
        scene.film.filter = scene::Filter::Box;
        for layer in layers {
            let count = layer.quantities.len();
            let weights = crate::spectral::UniformBins::new(&self.palette, LUMINOUS_BINS).map_err(RenderError::new)?;
            let [_, luminous, _] = weights.weights();
            let pixels = self.size.map(|s| s as usize);
            let sink = Sink {
                width: pixels[0],
                measure: layer.measure(luminous),
                count,
                done: Mutex::new((
                    vec![NOTHING; pixels[0] * pixels[1] * count],
                    vec![Found::Nowhere; pixels[0] * pixels[1]],
                )),
                seen: &seen,
            };
            let options = Options {
                renderer: self.renderer,
                spectra: layer.spectra,
                size: Some(self.size),
                samples: Some(samples),
                between: self.options.between,
                ..Options::default()
            };
            render::render_spectra(&scene, &options, watch, &sink)?;
            let (values, found) = sink.done.into_inner().unwrap_or_default();
            self.add(layer, Of::Radiance, (&values, &found), &seen)?;
        }
        self.seen = Some(seen);
        Ok(())
    }

    /// Takes in the values of a layer, pixel by pixel.
    fn add(&mut self, layer: &Layer, of: Of, done: (&[f32], &[Found]), seen: &Seen) -> Result<(), RenderError> {
        let [width, height] = self.size.map(|s| s as usize);
        let refused = |error: ImageError| RenderError::new(error.to_string());
        let maps = split(&layer.quantities, of, [width, height], done.0, done.1).map_err(refused)?;
        let parts = Arc::new(Raster::from_fn(width, height, |x, y| seen.part(y * width + x)).map_err(refused)?);
        self.maps.extend(maps.into_iter().map(|map| Map { surfaces: Some(Arc::clone(&parts)), ..map }));
        Ok(())
    }
}

/// Maps of values that are stored pixel by pixel.
fn split(
    quantities: &[Quantity],
    of: Of,
    [width, height]: [usize; 2],
    values: &[f32],
    found: &[Found],
) -> Result<Vec<Map>, ImageError> {
    let count = quantities.len().max(1);
    let map = |(index, quantity): (usize, &Quantity)| {
        let own = values.iter().skip(index).step_by(count).copied().collect();
        Ok(Map::new(*quantity, of, ScalarMap::from_pixels(width, height, own)?, found))
    };
    quantities.iter().enumerate().map(map).collect()
}

/// Measures the spectra of a rendering.
struct Sink<'s> {
    width: usize,
    measure: Box<dyn Measure>,
    count: usize,
    done: Mutex<(Vec<f32>, Vec<Found>)>,
    seen: &'s Seen,
}

impl SpectrumSink for Sink<'_> {
    fn pixel(&self, [x, y]: [usize; 2], spectrum: &[f64], _: f64) {
        let index = y * self.width + x;
        let mut values = vec![NOTHING; self.count];
        let measured = self.measure.measure(spectrum, &mut values);
        if measured == Found::Dark && !self.seen.sees(index) {
            return;
        }
        if let Ok(mut done) = self.done.lock() {
            done.0[index * self.count..][..self.count].copy_from_slice(&values);
            done.1[index] = measured;
        }
    }
}
