//! What `spectral render --between gather` takes besides, and what it says of its gathers.

use clap::Args;
use renderers::render::{GatherOptions, GatherReport};
use renderers::report::Table;
use serde_json::json;

use super::Failure;

/// The most photons and rays that are taken for meant.
const MOST_PHOTONS: u64 = 1_000_000_000;
const MOST_RAYS: u32 = 1 << 20;

/// Options of final gathers.
#[derive(Debug, Args)]
pub(super) struct GatherArguments {
    /// Photons that the lights send for light between surfaces, with --between gather; 200000 by default.
    #[arg(long, value_name = "N")]
    global_photons: Option<u64>,
    /// Rays of a gather, with --between gather; 1024 by default.
    #[arg(long, value_name = "N")]
    gather_rays: Option<u32>,
}

impl GatherArguments {
    /// What is asked for; refused if light isn't gathered.
    pub(super) fn options(&self, is_meant: bool) -> Result<GatherOptions, Failure> {
        if !is_meant && (self.global_photons.is_some() || self.gather_rays.is_some()) {
            return Err(Failure("--global-photons and --gather-rays are for --between gather".to_owned()));
        }
        let default = GatherOptions::default();
        Ok(GatherOptions {
            photons: match self.global_photons.unwrap_or(default.photons) {
                photons @ 1..=MOST_PHOTONS => photons,
                photons => {
                    return Err(Failure(format!("--global-photons must be from 1 to {MOST_PHOTONS}, not {photons}")));
                }
            },
            rays: match self.gather_rays.unwrap_or(default.rays) {
                rays @ 1..=MOST_RAYS => rays,
                rays => return Err(Failure(format!("--gather-rays must be from 1 to {MOST_RAYS}, not {rays}"))),
            },
        })
    }
}

/// What became of gathered light.
pub(super) fn rows(report: &GatherReport, table: &mut Table) {
    let GatherReport { emitted, photons, products, places, gathers, seconds, .. } = report;
    table.row(["photons sent, landed".to_owned(), format!("{emitted}, {photons}")]);
    table.row(["products of spectra".to_owned(), products.to_string()]);
    table.row(["places with a radiosity".to_owned(), places.to_string()]);
    table.row(["gathers".to_owned(), gathers.to_string()]);
    let [photons, gather] = seconds;
    table.row(["seconds: photons, gathers".to_owned(), format!("{photons:.3}, {gather:.3}")]);
    let percent = |share: f64| format!("{:.2} %", 100.0 * share);
    table.row(["global photons' light absorbed".to_owned(), percent(report.absorbed)]);
    table.row(["global photons' light out of the scene".to_owned(), percent(report.gone)]);
    table.row(["global photons' light too often reflected".to_owned(), percent(report.too_deep)]);
}

/// The same, with the time for pixels.
pub(super) fn json(report: &GatherReport, trace: f64) -> serde_json::Value {
    let GatherReport { emitted, photons, products, places, gathers, bytes, .. } = report;
    let [seconds, gather] = report.seconds;
    json!({
        "emitted": emitted,
        "photons": photons,
        "products": products,
        "places": places,
        "gathers": gathers,
        "bytes": bytes,
        "light": {
            "absorbed": report.absorbed,
            "escaped": report.gone,
            "too_deep": report.too_deep,
            "roulette": report.roulette,
        },
        "seconds": { "photons": seconds, "gather": gather, "trace": trace },
    })
}
