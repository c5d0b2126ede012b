//! What `spectral render --renderer photon-map` takes besides, and what it says of its photons.

use clap::{Args, ValueEnum};
use renderers::photon;
use renderers::render::{self, PhotonCount, PhotonOptions, PhotonReport, Rendering};
use renderers::report::Table;
use serde_json::json;

use super::Failure;

/// Options of the photon map.
#[derive(Debug, Args)]
pub(super) struct PhotonArguments {
    /// Photons that meet mirrors and glass; 200000 by default.
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    photons: Option<u64>,
    /// As many photons as it takes for this relative error where they land, instead of a number of them.
    #[arg(long, value_name = "SHARE", allow_negative_numbers = true, conflicts_with = "photons")]
    photon_error: Option<f64>,
    /// The most photons within the distance at which one counts; 50 by default.
    #[arg(long, value_name = "N")]
    nearest: Option<usize>,
    /// The largest distance at which photons count, in scene units; a fortieth of the scene's diagonal by default.
    #[arg(long, value_name = "LENGTH", allow_negative_numbers = true)]
    radius: Option<f64>,
    /// How photons count by their distance; epanechnikov by default.
    #[arg(long, value_enum)]
    kernel: Option<Kernel>,
    /// How far photons count; adaptive by default.
    #[arg(long, value_enum)]
    estimate: Option<Estimate>,
    /// At which wavelengths photons that depend on them are thrown: continuous (the default), or at a single one for each band.
    #[arg(long, value_enum)]
    bundle: Option<Bundle>,
    /// How photons that depend on the wavelength are found at all wavelengths; interpolated by default.
    #[arg(long, value_enum)]
    rethrow: Option<Rethrow>,
    /// How often photons are thrown anew, each time with --spp camera rays and a smaller radius; 1 by default.
    #[arg(long, value_name = "N")]
    passes: Option<u32>,
    /// Where light between surfaces comes from; radiosity by default.
    #[arg(long, value_enum)]
    between: Option<Between>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Kernel {
    Constant,
    Cone,
    Epanechnikov,
    Biweight,
    Triweight,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Estimate {
    /// As far as light about them is even, so that variance and bias together are small.
    Adaptive,
    /// As far as the farthest of the nearest photons.
    Nearest,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Bundle {
    /// Spread over the band as the eye is sensitive.
    Continuous,
    /// At one wavelength.
    Single,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Rethrow {
    /// By one search, along ways known from one wavelength, or between a few at which all are traced.
    Interpolated,
    /// Traced for every band that a pixel asks for.
    Traced,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Between {
    /// From radiosity.
    Radiosity,
    /// From a global photon map, by final gathers.
    Gather,
    /// From the scene's ambient term.
    Ambient,
}

impl PhotonArguments {
    /// What is asked for; refused if any of it is for a renderer that isn't.
    pub(super) fn options(&self, is_meant: bool) -> Result<PhotonOptions, Failure> {
        if !is_meant && self.is_given() {
            return Err(Failure(
                "--photons, --photon-error, --nearest, --radius, --kernel, --estimate, --bundle, --rethrow, --passes and --between are for --renderer \
                 photon-map"
                    .to_owned(),
            ));
        }
        let default = PhotonOptions::default();
        Ok(PhotonOptions {
            count: self.count(default.count)?,
            nearest: match self.nearest.unwrap_or(default.nearest) {
                nearest @ 1..=100_000 => nearest,
                nearest => return Err(Failure(format!("--nearest must be from 1 to 100000, not {nearest}"))),
            },
            radius: match self.radius {
                Some(radius) if !(radius > 0.0 && radius.is_finite()) => {
                    return Err(Failure(format!("--radius must be positive and finite, not {radius}")));
                }
                radius => radius,
            },
            kernel: self.kernel.map_or(default.kernel, |kernel| match kernel {
                Kernel::Constant => photon::Kernel::Constant,
                Kernel::Cone => photon::Kernel::Cone,
                Kernel::Epanechnikov => photon::Kernel::Epanechnikov,
                Kernel::Biweight => photon::Kernel::Biweight,
                Kernel::Triweight => photon::Kernel::Triweight,
            }),
            adaptive: self.estimate.map_or(default.adaptive, |estimate| estimate == Estimate::Adaptive),
            bundle: self.bundle.map_or(default.bundle, |bundle| match bundle {
                Bundle::Continuous => photon::Bundle::Continuous,
                Bundle::Single => photon::Bundle::Single,
            }),
            rethrow: self.rethrow.map_or(default.rethrow, |rethrow| match rethrow {
                Rethrow::Interpolated => photon::Rethrow::Interpolated,
                Rethrow::Traced => photon::Rethrow::Traced,
            }),
            passes: match self.passes.unwrap_or(default.passes) {
                passes @ 1..=65_536 => passes,
                passes => return Err(Failure(format!("--passes must be from 1 to 65536, not {passes}"))),
            },
            between: self.between.map_or(default.between, |between| match between {
                Between::Radiosity => render::Between::Radiosity,
                Between::Gather => render::Between::Gather,
                Between::Ambient => render::Between::Ambient,
            }),
        })
    }

    fn count(&self, default: PhotonCount) -> Result<PhotonCount, Failure> {
        match (self.photons, self.photon_error) {
            (Some(0), _) => Err(Failure("--photons must be at least 1, not 0".to_owned())),
            // Absurd counts are refused with the memory that they would take.
            (Some(count), _) => Ok(PhotonCount::Count(count)),
            (None, Some(error)) if error > 0.0 && error < 1.0 => Ok(PhotonCount::Error(error)),
            (None, Some(error)) => Err(Failure(format!("--photon-error must be between 0 and 1, not {error}"))),
            (None, None) => Ok(default),
        }
    }

    const fn is_given(&self) -> bool {
        self.photons.is_some()
            || self.photon_error.is_some()
            || self.nearest.is_some()
            || self.radius.is_some()
            || self.kernel.is_some()
            || self.estimate.is_some()
            || self.bundle.is_some()
            || self.rethrow.is_some()
            || self.passes.is_some()
            || self.between.is_some()
    }
}

/// What became of the photons.
pub(super) struct Summary {
    report: PhotonReport,
    /// Mean and maximum over pixels of what a standard error counts for, ΔE*ab.
    noise: [f64; 2],
}

impl Summary {
    pub(super) fn new(rendering: &Rendering) -> Option<Self> {
        let report = rendering.photons.clone()?;
        let noise = rendering.photon_delta_e.as_ref().map_or([0.0; 2], super::render::mean_and_max);
        Some(Self { report, noise })
    }

    pub(super) fn rows(&self, table: &mut Table) {
        let PhotonReport { emitted, even, dispersed, bytes, seconds, flux, .. } = &self.report;
        table.row(["photons that met mirrors or glass".to_owned(), emitted.to_string()]);
        table.row(["photons kept, alike for all waves".to_owned(), even.to_string()]);
        table.row(["paths that depend on the wavelength".to_owned(), dispersed.to_string()]);
        table.row(["photons' memory".to_owned(), format!("{:.1} MB", megabytes(*bytes))]);
        table.row(["seconds: photons".to_owned(), format!("{seconds:.3}")]);
        let percent = |share: f64| format!("{:.2} %", 100.0 * share);
        table.row(["flux kept".to_owned(), percent(flux.kept)]);
        table.row(["flux in paths that depend on the wavelength".to_owned(), percent(flux.dispersed)]);
        table.row(["flux absorbed".to_owned(), percent(flux.absorbed)]);
        table.row(["flux out of the scene".to_owned(), percent(flux.escaped)]);
        table.row(["flux too deep".to_owned(), percent(flux.too_deep)]);
        let [mean, max] = self.noise;
        table.row(["ΔE*ab of photons' standard error, mean".to_owned(), format!("{mean:.3}")]);
        table.row(["ΔE*ab of photons' standard error, maximum".to_owned(), format!("{max:.3}")]);
    }

    /// Photons by bands of wavelengths, and notes.
    pub(super) fn text(&self) -> String {
        let mut text = String::new();
        if self.report.bands.len() > 1 {
            let mut table = Table::new(["nm", "photons"]);
            for band in &self.report.bands {
                let [from, to] = band.limits;
                table.row([format!("{from:.1}–{to:.1}"), band.photons.to_string()]);
            }
            text += "\nphotons by bands of wavelengths\n";
            text += &table.to_string();
        }
        for note in self.notes() {
            text += &format!("\nnote: {note}\n");
        }
        text
    }

    fn notes(&self) -> Vec<String> {
        let mut notes = Vec::new();
        if !self.report.idle_lights.is_empty() {
            let numbers: Vec<_> = self.report.idle_lights.iter().map(|n| (n + 1).to_string()).collect();
            notes.push(format!("no mirror or glass is seen by light number {}", numbers.join(", ")));
        }
        notes
    }

    pub(super) fn json(&self) -> serde_json::Value {
        let PhotonReport { emitted, even, dispersed, bands, keys, bytes, seconds, flux, idle_lights } = &self.report;
        let [mean, max] = self.noise;
        let bands: Vec<_> = bands.iter().map(|b| json!({ "nm": b.limits, "photons": b.photons })).collect();
        json!({
            "emitted": emitted,
            "kept": even,
            "dispersed_paths": dispersed,
            "bands": bands,
            "keys_nm": keys,
            "bytes": bytes,
            "seconds": seconds,
            "flux": {
                "kept": flux.kept,
                "dispersed": flux.dispersed,
                "absorbed": flux.absorbed,
                "escaped": flux.escaped,
                "too_deep": flux.too_deep,
                "roulette": flux.roulette,
                "bent": flux.bent,
                "missing": flux.missing,
            },
            "idle_lights": idle_lights,
            "delta_e": { "mean": mean, "max": max },
            "notes": self.notes(),
        })
    }
}

#[allow(clippy::cast_precision_loss, reason = "to one decimal")]
fn megabytes(bytes: usize) -> f64 {
    bytes as f64 / 1e6
}
