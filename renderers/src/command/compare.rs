//! `spectral compare`: how far two pictures are apart.

use std::path::PathBuf;

use clap::Args;
use renderers::compare::{CompareOptions, compare};
use renderers::report::Table;

use super::{Answer, Failure};

/// What `spectral compare` takes.
#[derive(Debug, Args)]
pub(super) struct Arguments {
    /// The picture that is judged, `OpenEXR` or PNG.
    first: PathBuf,
    /// The picture it is compared with, of the same size.
    second: PathBuf,
    /// The factor on both pictures that makes diffuse white Y = 1.
    #[arg(long, value_name = "FACTOR", default_value_t = 1.0, allow_negative_numbers = true)]
    exposure: f32,
    /// Folder for the false-colour maps; made if it isn't there.
    #[arg(long, value_name = "DIR", default_value = "out/compare")]
    out: PathBuf,
}

impl Arguments {
    pub(super) fn run(self) -> Result<Answer, Failure> {
        let options = CompareOptions { exposure: self.exposure, ..CompareOptions::default() };
        let found = compare(&self.first, &self.second, &self.out, &options)?;
        let mut table = Table::new(["quantity", "value"]);
        table.row(["ΔE00, mean".to_owned(), format!("{:.4}", found.delta_e00.mean)]);
        table.row(["ΔE00, 95th percentile".to_owned(), format!("{:.4}", found.delta_e00.p95)]);
        table.row(["ΔE00, maximum".to_owned(), format!("{:.4}", found.delta_e00.max)]);
        let brightness = &found.relative_brightness;
        table.row(["relative brightness, least".to_owned(), format!("{:+.4} %", 100.0 * brightness.min)]);
        table.row(["relative brightness, greatest".to_owned(), format!("{:+.4} %", 100.0 * brightness.max)]);
        let mut text = table.to_string() + "\n";
        for file in &found.files {
            text += &format!("{}\n", file.display());
        }
        Ok(Answer { text, json: serde_json::to_value(&found)? })
    }
}
