//! Light by way of mirrors and glass, as photons: what is asked for, and what became of it.

use std::time::Instant;

use super::{Between, Watch};
use crate::photon::{BandReport, Bundle, Choice, Density, Emission, Kernel, Maps, Rethrow, Settings};
use crate::scene::Scene;
use crate::spectral::Palette;
use crate::whitted::{RenderError, Whitted};

/// How [`Renderer::PhotonMap`](super::Renderer::PhotonMap) finds light by way of mirrors and glass.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PhotonOptions {
    /// How many photons meet mirrors and glass.
    pub count: PhotonCount,
    /// The most photons within the distance at which one counts.
    pub nearest: usize,
    /// The largest distance at which photons count, in scene units; `None`: a fortieth of the scene's diagonal.
    pub radius: Option<f64>,
    /// How photons count by their distance.
    pub kernel: Kernel,
    /// Whether that distance is chosen by the errors that come of it; otherwise it is that of the farthest of the nearest photons.
    pub adaptive: bool,
    /// At which wavelengths photons that depend on them are thrown.
    pub bundle: Bundle,
    /// How photons that depend on the wavelength are found at all wavelengths.
    pub rethrow: Rethrow,
    /// How often photons are thrown anew, with camera rays of their own; the picture is the mean. Memory is that of one pass.
    pub passes: u32,
    /// Where light between surfaces comes from.
    pub between: Between,
}

/// How many photons there are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PhotonCount {
    /// As many as meet mirrors and glass.
    Count(u64),
    /// As many as it takes for this relative error of an estimate, root mean square over where they land, expected from a trial with some.
    Error(f64),
}

impl Default for PhotonOptions {
    fn default() -> Self {
        Self {
            count: PhotonCount::Count(200_000),
            nearest: 50,
            radius: None,
            kernel: Kernel::default(),
            adaptive: true,
            bundle: Bundle::default(),
            rethrow: Rethrow::default(),
            passes: 1,
            between: Between::default(),
        }
    }
}

/// The most memory that photons may take, in bytes.
const MOST_BYTES: u64 = 4 << 30;

/// The part of the scene's diagonal that the largest distance at which photons count is.
const RADIUS: f64 = 1.0 / 40.0;

/// What became of the photons of the last pass, for reports.
#[derive(Clone, Debug, PartialEq)]
pub struct PhotonReport {
    /// Photons that met mirrors or glass.
    pub emitted: u64,
    /// Photons kept whose way was the same for all waves.
    pub even: usize,
    /// Paths whose way depends on the wavelength.
    pub dispersed: usize,
    /// The maps of bands of wavelengths that were made, wider ones first: that of all waves alone unless maps are made for bands.
    pub bands: Vec<BandReport>,
    /// The wavelengths in nm at which dispersed paths were thrown, if photons are interpolated between; none if each was followed at one of its own.
    pub keys: Vec<f64>,
    /// Bytes of all maps and paths.
    pub bytes: usize,
    /// Time for emission and for the first maps.
    pub seconds: f64,
    /// Shares of the luminous flux that met mirrors and glass: kept, escaped, absorbed, too deep, and in dispersed paths.
    pub flux: FluxShares,
    /// Lights that see no mirror or glass, by their numbers.
    pub idle_lights: Vec<usize>,
}

/// Where the luminous flux went that met mirrors and glass: shares of it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FluxShares {
    /// On surfaces that scatter light.
    pub kept: f64,
    /// Out of the scene.
    pub escaped: f64,
    /// In media, in mirrors and on black surfaces.
    pub absorbed: f64,
    /// After too many reflections and refractions.
    pub too_deep: f64,
    /// Into media in which light behaves differently by wavelength.
    pub dispersed: f64,
    /// What Russian roulette took, less what it added: 0 on average.
    pub roulette: f64,
    /// What shading normals took by bending light, less what they added: the other shares make 1 with it.
    pub bent: f64,
    /// What is missing for 1: rounding.
    pub missing: f64,
}

impl PhotonReport {
    /// What became of the photons of some maps, which were made in so many seconds.
    pub(super) fn new(maps: &Maps<'_>, idle_lights: Vec<usize>, seconds: f64) -> Self {
        let (emitted, even, dispersed) = maps.counts();
        let account = maps.account();
        let share = |flux: f64| if account.emitted > 0.0 { flux / account.emitted } else { 0.0 };
        Self {
            emitted,
            even,
            dispersed,
            bands: maps.bands(),
            keys: maps.keys().to_vec(),
            bytes: maps.bytes(),
            seconds,
            flux: FluxShares {
                kept: share(account.deposited),
                escaped: share(account.escaped),
                absorbed: share(account.media + account.mirrors + account.boundaries + account.black),
                too_deep: share(account.too_deep),
                dispersed: share(account.waiting),
                roulette: share(account.roulette),
                bent: -share(account.bent),
                missing: share(account.missing()),
            },
            idle_lights,
        }
    }
}

/// Photons for as many passes as are asked for.
pub(super) struct Thrower<'s> {
    scene: (&'s Scene, &'s Whitted),
    emission: &'s Emission<'s>,
    density: Density,
    options: PhotonOptions,
    count: u64,
    first: Option<Maps<'s>>,
    /// Time for the first pass' photons.
    seconds: f64,
}

/// The beams of a scene.
pub(super) fn emission<'s>(data: &Scene, scene: &'s Whitted, palette: &Palette, seed: u64) -> Emission<'s> {
    #[allow(clippy::cast_possible_truncation, reason = "a hashed seed")]
    let settings = Settings { seed: (seed ^ (seed >> 32)) as u32, ..Settings::default() };
    Emission::new(data, scene, palette, settings)
}

impl<'s> Thrower<'s> {
    /// Finds how many photons a pass has.
    pub(super) fn new(
        scene: (&'s Scene, &'s Whitted),
        emission: &'s Emission<'s>,
        options: &PhotonOptions,
        watch: &dyn Watch,
    ) -> Result<Self, RenderError> {
        let density = density(options, scene.1)?;
        let start = Instant::now();
        let mut thrower = Self { scene, emission, density, options: *options, count: TRIAL, first: None, seconds: 0.0 };
        match options.count {
            PhotonCount::Count(count) => thrower.count = count,
            PhotonCount::Error(error) => thrower.find_count(error, watch)?,
        }
        check_memory(thrower.count, emission)?;
        if thrower.first.is_none() {
            thrower.first = Some(thrower.pass(0, watch));
        }
        thrower.seconds = start.elapsed().as_secs_f64();
        Ok(thrower)
    }

    /// Throws ever more photons until an error is met, and keeps these; refuses errors that no number of photons meets.
    fn find_count(&mut self, error: f64, watch: &dyn Watch) -> Result<(), RenderError> {
        let least = self.density.least_error();
        if !(error > least) {
            return Err(unreachable_error(error, least, self.density.count, "however many there are"));
        }
        let mut before = f64::INFINITY;
        loop {
            let maps = self.pass(0, watch);
            let found = maps.error();
            if !(found > error) {
                self.first = Some(maps);
                return Ok(());
            }
            // Where estimates have all the photons they may take, more of them help no more.
            if found < NEAR_LEAST * least && found > STANDSTILL * before {
                return Err(unreachable_error(error, found, self.density.count, "and more photons hardly change that"));
            }
            before = found;
            self.count = more(self.count, found / error);
            check_memory(self.count, self.emission)?;
        }
    }

    /// Lights that see no mirror or glass.
    pub(super) fn idle_lights(&self) -> Vec<usize> {
        self.emission.idle_lights()
    }

    /// The maps of the first pass, and how long they took in seconds.
    pub(super) fn first(&self) -> (Option<&Maps<'s>>, f64) {
        (self.first.as_ref(), self.seconds)
    }

    pub(super) fn passes(&self) -> u32 {
        self.options.passes.max(1)
    }

    /// The maps of a pass, independent of those of all others. The squares of their radii go down such that the mean over all passes
    /// converges (Knaus and Zwicker 2011, equation 12): r²ₙ₊₁ = r²ₙ (n + α)/(n + 1).
    pub(super) fn pass(&self, pass: u32, watch: &dyn Watch) -> Maps<'s> {
        watch.stage("photons", self.emission.attempts(self.count));
        let progress = |steps| watch.add(steps);
        let photons: (_, _, &(dyn Fn(u64) + Sync)) = (self.count, pass, &progress);
        let shrink = (1..=pass).map(|n| (f64::from(n) + SHRINKING) / (f64::from(n) + 1.0)).product::<f64>().sqrt();
        #[allow(clippy::cast_possible_truncation, reason = "as precise as radii")]
        let density = (self.density, shrink as f32);
        Maps::new(self.scene, self.emission, photons, density, (self.options.bundle, self.options.rethrow))
    }
}

/// How slowly radii go down: α of Knaus and Zwicker, for which variance and squared bias go down alike.
const SHRINKING: f64 = 2.0 / 3.0;

/// Photons of a trial.
const TRIAL: u64 = 1 << 15;

/// How many photons it takes to make an error so many times less: errors go down by the cube root of the number, as of estimates whose
/// radius balances variance and bias. At most 64 times as many at once, and at least a quarter more.
#[allow(clippy::cast_precision_loss, clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "an estimate")]
fn more(count: u64, times: f64) -> u64 {
    (count as f64 * (1.1 * times).powi(3).clamp(1.25, 64.0)) as u64
}

/// An error stands still if more photons leave more than this share of it, and it is not farther than this from the least one.
const STANDSTILL: f64 = 0.98;
const NEAR_LEAST: f64 = 1.5;

/// What must be aimed at for an error, relative to it: estimates with an adaptive radius are not the best everywhere.
const AIM: f64 = 0.6;

/// Says why an error can't be met by estimates from so many photons, which keep another one, and what to do.
#[allow(
    clippy::cast_precision_loss,
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "about as many, in words"
)]
fn unreachable_error(error: f64, kept: f64, count: usize, why: &str) -> RenderError {
    // Errors go down with the root of the number.
    let enough = (count as f64 * (kept / (AIM * error)).powi(2)).ceil() as u64;
    RenderError::new(format!(
        "an error of {:.3} % (--photon-error) can't be met: estimates from {count} photons keep {:.1} %, {why}; \
         let them take about {enough} (--nearest), or allow a larger error",
        100.0 * error,
        100.0 * kept,
    ))
}

/// Refuses what would take too much memory.
fn check_memory(count: u64, emission: &Emission<'_>) -> Result<(), RenderError> {
    let bytes = emission.bytes_for(count);
    if bytes > MOST_BYTES {
        let gigabytes = |bytes: u64| bytes.div_ceil(1 << 30);
        let text = format!(
            "{count} photons would take {} GiB; at most {} GiB are allowed",
            gigabytes(bytes),
            gigabytes(MOST_BYTES)
        );
        return Err(RenderError::new(text));
    }
    Ok(())
}

fn density(options: &PhotonOptions, scene: &Whitted) -> Result<Density, RenderError> {
    let [low, high] = scene.world().bounds();
    let diagonal = f64::from((high - low).length());
    let radius = options.radius.unwrap_or(RADIUS * diagonal);
    #[allow(clippy::cast_possible_truncation, reason = "as precise as coordinates")]
    let density = Density {
        kernel: options.kernel,
        count: options.nearest,
        radius: radius as f32,
        choice: if options.adaptive { Density::default().choice } else { Choice::Count },
    };
    density.check().map_err(|e| RenderError::new(e.to_string()))?;
    Ok(density)
}
