//! Whitted's ray tracing with radiosity in place of the ambient term, for all renderers that have it.

use std::time::Instant;

use super::{BetweenOptions, Frame, Options, Pixels, Represented, Spectra, Watch};
use crate::photon::Maps;
use crate::radiosity::{self, Caustics, Field, FieldSettings, Others, Radiosity, Report, Representation, Solution};
use crate::scene::{Integrator, Scene};
use crate::spectral::{
    IntervalMemory, IntervalSettings, Intervals, Palette, Resolver, SharedIntervals, UniformBins, WithGathered,
};
use crate::whitted::RenderError;

/// Bins of the spectra that tell where light is gathered.
const GUIDE_BINS: usize = 12;

/// What became of the light between surfaces, for reports.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BetweenReport {
    /// Patches, links, convergence and balance.
    pub radiosity: Report,
    /// Gathers that indirect light is interpolated between; 0 if it was gathered for every camera ray.
    pub gathers: usize,
    /// Time for patches and links, for the solution and for the gathers.
    pub seconds: [f64; 3],
}

/// Renders a scene; the frame has everything but the light between surfaces.
pub(super) fn render(
    scene: &Scene,
    options: &Options,
    frame: Frame<'_>,
    mut palette: Palette,
    watch: &dyn Watch,
) -> Result<(Pixels, bool, BetweenReport), RenderError> {
    let start = Instant::now();
    let radiosity = build(scene, &options.between, &mut palette, watch)?;
    let built = start.elapsed().as_secs_f64();
    let guide = UniformBins::new(&palette, GUIDE_BINS).map_err(RenderError::new)?;
    let (radiosity, guide, palette) = (&radiosity, &guide, &palette);
    let job = Job { scene, options, radiosity, guide, palette, frame, start, built, watch };
    options.spectra.apply(scene, palette, job)
}

/// Patches and links for light between surfaces: all of it, unless the scene's paths are limited.
pub(crate) fn build(
    scene: &Scene,
    options: &BetweenOptions,
    palette: &mut Palette,
    watch: &dyn Watch,
) -> Result<Radiosity, RenderError> {
    /// Of a share.
    const STEPS: u32 = 1000;
    if !(options.accuracy > 0.0 && options.accuracy <= 1.0) {
        return Err(RenderError::new(format!("the accuracy must be in (0, 1], not {}", options.accuracy)));
    }
    let settings = radiosity::Settings {
        accuracy: options.accuracy,
        others: Others::Simplified,
        points: false,
        ..radiosity::Settings::default()
    };
    let settings = match scene.integrator {
        Integrator::Path { .. } => settings.limited_by(scene.integrator),
        _ => settings,
    };
    watch.stage("patches", u64::from(STEPS));
    let done = core::sync::atomic::AtomicU64::new(0);
    let progress = |share: f64| {
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a share of some steps")]
        let now = (share.clamp(0.0, 1.0) * f64::from(STEPS)) as u64;
        watch.add(now.saturating_sub(done.fetch_max(now, core::sync::atomic::Ordering::Relaxed)));
    };
    Radiosity::new(scene, &settings, palette, &progress).map_err(|e| RenderError::new(e.to_string()))
}

/// What is the same for all representations.
struct Job<'s> {
    scene: &'s Scene,
    options: &'s Options,
    radiosity: &'s Radiosity,
    guide: &'s UniformBins,
    palette: &'s Palette,
    frame: Frame<'s>,
    start: Instant,
    built: f64,
    watch: &'s dyn Watch,
}

impl Represented for Job<'_> {
    type Output = (Pixels, bool, BetweenReport);

    fn with_intervals(self, settings: IntervalSettings) -> Result<Self::Output, RenderError> {
        // Direct and indirect light each have half of the error.
        let settings = IntervalSettings { threshold: settings.threshold / 2.0, ..settings };
        let mut memory = IntervalMemory::default();
        let shared = SharedIntervals::new(self.palette, settings, &mut memory).map_err(RenderError::new)?;
        let solution = self.radiosity.solve_intervals(self.palette, &settings);
        self.trace(&solution.map_err(|e| RenderError::new(e.to_string()))?, || Intervals::new(&shared))
    }

    fn with<R: Resolver>(
        self,
        representation: &dyn Representation,
        new_resolver: impl Fn() -> R + Sync,
    ) -> Result<Self::Output, RenderError> {
        let solution = self.radiosity.solve(representation).map_err(|e| RenderError::new(e.to_string()))?;
        self.trace(&solution, new_resolver)
    }
}

impl Job<'_> {
    fn trace<R: Resolver>(
        self,
        solution: &Solution<'_>,
        new_resolver: impl Fn() -> R + Sync,
    ) -> Result<(Pixels, bool, BetweenReport), RenderError> {
        let Self { scene, options, radiosity, guide, frame, start, built, watch, .. } = self;
        let representation = solution.representation();
        let solved = start.elapsed().as_secs_f64();
        let BetweenOptions { accuracy, exact } = options.between;
        let seen = frame.seen();
        watch.stage("light between surfaces", Field::STEPS);
        let maps = frame.thrower.and_then(|thrower| thrower.first().0);
        let deposits = maps.map(Maps::deposits);
        let caustics = deposits.as_ref().map_or(Caustics::LeftOut, |deposits| Caustics::Given(deposits));
        let settings = FieldSettings { accuracy, exact, caustics };
        let guide = radiosity.solve(guide).map_err(|e| RenderError::new(e.to_string()))?;
        let field = Field::new(scene, frame.scene, [solution, &guide], settings, &seen, &|steps| watch.add(steps));
        let gathered = start.elapsed().as_secs_f64();
        let report = BetweenReport {
            radiosity: *solution.report(),
            gathers: field.gathers(),
            seconds: [built, solved - built, gathered - solved],
        };
        let is_bounded = matches!(options.spectra, Spectra::Interval(_));
        let bounded = is_bounded.then(|| (representation.intervals(), options.spectra.white()));
        let colour = |leaves: &[u32], row: &[f64]| {
            let colour = representation.colour(leaves, row);
            [colour.value, colour.radius]
        };
        let frame = Frame { indirect: Some(&field), ..frame };
        let pixels = frame.trace(start, || WithGathered::new(new_resolver(), &colour, bounded));
        Ok((pixels, is_bounded, report))
    }
}
