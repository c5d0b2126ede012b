//! Whitted's ray tracing with final gathers from a global photon map in place of the ambient term.

use std::time::Instant;

use super::{BetweenOptions, Frame, Options, Pixels, Represented, Watch};
use crate::geometry::Hit;
use crate::photon::{Density, GatherSettings, Gatherer, Global, GlobalSettings};
use crate::radiosity::{self, Mosaic, Representation};
use crate::scene::{Integrator, Scene};
use crate::spectral::{
    IntervalMemory, IntervalSettings, Intervals, Palette, Resolver, SharedIntervals, UniformBins, WithGathered,
};
use crate::whitted::{Indirect, RenderError};

/// Where [`Renderer::PhotonMap`](super::Renderer::PhotonMap) has light between surfaces from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Between {
    /// From [`radiosity`].
    #[default]
    Radiosity,
    /// From a global photon map, by final gathers: [`GatherOptions`].
    Gather,
    /// From the scene's ambient term.
    Ambient,
}

/// How light between surfaces is found by final gathers.
///
/// Photons are sent from all lights in all directions, and are followed by mirrors and glass and from surface to surface, with products of
/// spectra for their light. What surfaces reflect is estimated from those that landed on them, but for light straight from lights, which is known
/// exactly; the rays of a gather find it. As between
/// patches, Schlick's model counts as diffuse but for its specular share, Ward's by its base alone, and wherever
/// the index depends on the wavelength, the way is that at 587.56 nm.
///
/// The estimate is consistent: its errors vanish with more photons and rays. No bound of its spectral errors is known: gathered light
/// has bins, 81 of 4.9 nm with [`Spectra::Interval`](super::Spectra::Interval), and pictures come without bounds. Products of more than 16 reflectances (4 to 16 where
/// a scene has many) count further ones by their means.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct GatherOptions {
    /// How many photons the lights send.
    pub photons: u64,
    /// How many rays a gather has.
    pub rays: u32,
}

impl Default for GatherOptions {
    fn default() -> Self {
        Self { photons: 200_000, rays: 1024 }
    }
}

/// What became of gathered light, for reports.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GatherReport {
    /// Photons that lights sent.
    pub emitted: u64,
    /// Photons that landed on surfaces.
    pub photons: usize,
    /// Products of spectra that they had.
    pub products: usize,
    /// Places where radiosity was estimated.
    pub places: usize,
    /// Gathers that irradiance is interpolated between; 0 if it was gathered for every camera ray.
    pub gathers: usize,
    /// Bytes of places and radiosities.
    pub bytes: usize,
    /// Shares of the emitted light, spectra by their means: absorbed, out of the scene, too often reflected, and what roulette took.
    pub absorbed: f64,
    /// Out of the scene.
    pub gone: f64,
    /// Ended by the limit of reflections.
    pub too_deep: f64,
    /// Taken by roulette: 0 on average.
    pub roulette: f64,
    /// Time for photons and radiosities, and for gathers.
    pub seconds: [f64; 2],
}

/// Photons' irradiance is estimated from so many of them at most.
const NEAREST: usize = 64;
/// The most memory that photons may take, in bytes, and about how many one that is sent takes while maps are made.
const MOST_BYTES: u64 = 4 << 30;
const BYTES: u64 = 600;
/// Bins of gathered light where other light has intervals.
const BINS: usize = 81;

/// Renders a scene; the frame has everything but the light between surfaces.
pub(super) fn render(
    scene: &Scene,
    options: &Options,
    frame: Frame<'_>,
    mut palette: Palette,
    watch: &dyn Watch,
) -> Result<(Pixels, GatherReport), RenderError> {
    let start = Instant::now();
    check(options)?;
    let mosaic = Mosaic::new(scene, &mut palette).map_err(|e| RenderError::new(e.to_string()))?;
    let palette = &palette;
    let job = Job { scene, options, palette, mosaic, frame, start, watch };
    options.spectra.apply(scene, palette, job)
}

/// Refuses what makes no sense, or takes too much memory.
fn check(options: &Options) -> Result<(), RenderError> {
    let BetweenOptions { accuracy, .. } = options.between;
    if !(accuracy > 0.0 && accuracy <= 1.0) {
        return Err(RenderError::new(format!("the accuracy must be in (0, 1], not {accuracy}")));
    }
    let GatherOptions { photons, rays } = options.gather;
    if photons == 0 || rays == 0 {
        return Err(RenderError::new("a gather needs at least one photon and one ray"));
    }
    if photons > MOST_BYTES / BYTES {
        let gigabytes = photons.saturating_mul(BYTES).div_ceil(1 << 30);
        let text =
            format!("{photons} photons would take {gigabytes} GiB; at most {} GiB are allowed", MOST_BYTES >> 30);
        return Err(RenderError::new(text));
    }
    Ok(())
}

/// What is the same for all representations.
struct Job<'s> {
    scene: &'s Scene,
    options: &'s Options,
    palette: &'s Palette,
    mosaic: Mosaic,
    frame: Frame<'s>,
    start: Instant,
    watch: &'s dyn Watch,
}

impl Represented for Job<'_> {
    type Output = (Pixels, GatherReport);

    fn with_intervals(self, settings: IntervalSettings) -> Result<Self::Output, RenderError> {
        let palette = self.palette;
        let mut memory = IntervalMemory::default();
        let shared = SharedIntervals::new(palette, settings, &mut memory).map_err(RenderError::new)?;
        let bins = UniformBins::new(palette, BINS).map_err(RenderError::new)?;
        self.with(&bins, || Intervals::new(&shared))
    }

    fn with<R: Resolver>(
        self,
        representation: &dyn Representation,
        new_resolver: impl Fn() -> R + Sync,
    ) -> Result<Self::Output, RenderError> {
        let Self { scene, options, palette, mut mosaic, frame, start, watch } = self;
        let GatherOptions { photons, rays } = options.gather;
        let (whitted, world) = (frame.scene, frame.scene.world());
        #[allow(clippy::cast_possible_truncation, reason = "a hashed seed")]
        let seed = (frame.seed ^ (frame.seed >> 32)) as u32;
        // What photons brought is reflected where they landed, and again where that is gathered first.
        let limit = limit(scene);
        let settings = GlobalSettings { seed, reflections: limit.map(|l| l.saturating_sub(2)), order: frame.order };
        let global = Global::new(whitted, palette, settings);
        let photons = if limit == Some(0) { 0 } else { photons };
        let density = Density { count: NEAREST, ..Density::default() };
        let settings = GatherSettings { photons, rays, density, seed, twice: limit.is_none_or(|l| l > 1) };
        watch.stage("photons", Gatherer::steps(&global, photons));
        let gatherer = Gatherer::new((scene, whitted), &global, representation, settings, &|steps| watch.add(steps));
        let estimated = start.elapsed().as_secs_f64();
        let BetweenOptions { accuracy, exact } = options.between;
        if !exact {
            let seen = frame.seen();
            watch.stage("light between surfaces", Mosaic::STEPS);
            mosaic.fill((scene, world), &seen, accuracy, &gatherer, &|steps| watch.add(steps));
        }
        let gathered = start.elapsed().as_secs_f64();
        let report = report(&gatherer, photons, mosaic.gathers(), [estimated, gathered - estimated]);
        let colour = |leaves: &[u32], row: &[f64]| {
            let colour = representation.colour(leaves, row);
            [colour.value, colour.radius]
        };
        let luminances = representation.luminances();
        let field = Field { gatherer: &gatherer, mosaic: &mosaic, luminances };
        let frame = Frame { indirect: Some(&field), ..frame };
        Ok((frame.trace(start, || WithGathered::new(new_resolver(), &colour, None)), report))
    }
}

/// The most diffuse reflections of light that reaches a receiver.
fn limit(scene: &Scene) -> Option<u32> {
    match scene.integrator {
        Integrator::Path { .. } => radiosity::Settings::default().limited_by(scene.integrator).bounces,
        _ => None,
    }
}

fn report(gatherer: &Gatherer<'_>, emitted: u64, gathers: usize, seconds: [f64; 2]) -> GatherReport {
    let balance = &gatherer.balance;
    let share = |photons: f64| if balance.emitted > 0.0 { photons / balance.emitted } else { 0.0 };
    GatherReport {
        emitted,
        photons: gatherer.photons,
        products: gatherer.products,
        places: gatherer.places(),
        gathers,
        bytes: gatherer.bytes(),
        absorbed: share(balance.absorbed),
        gone: share(balance.gone),
        too_deep: share(balance.too_deep),
        roulette: share(balance.roulette),
        seconds,
    }
}

/// Gathered light on surfaces.
struct Field<'f, 's> {
    gatherer: &'f Gatherer<'s>,
    mosaic: &'f Mosaic,
    /// What each number of a row is worth in luminance.
    luminances: Vec<f64>,
}

impl Indirect for Field<'_, '_> {
    fn width(&self) -> usize {
        self.gatherer.row_width()
    }

    fn luminances(&self) -> &[f64] {
        &self.luminances
    }

    fn irradiance(&self, hit: &Hit, row: &mut [f64]) {
        if self.mosaic.interpolate(hit, row) {
            return;
        }
        let normal = hit.shading_normal.as_dvec3() * if hit.front { 1.0 } else { -1.0 };
        self.gatherer.irradiance(&hit.point(), normal, row);
    }
}
