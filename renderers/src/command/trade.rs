//! `spectral trade`: what accuracy costs.

use std::path::PathBuf;
use std::process::ExitCode;

use clap::Args;
use renderers::progress::Progress;
use renderers::trade::{self, Request, Watch};

use super::{Answer, Failure};

/// What `spectral trade` takes.
#[derive(Debug, Args)]
pub(super) struct Arguments {
    /// Families by name: spectral, disk, radiosity, photons, brdf, precision, lights, and stability, sweeps to the extremes; all without.
    #[arg(value_name = "FAMILY")]
    families: Vec<String>,
    /// About a minute instead of half an hour: fewer settings, rounds and pixels.
    #[arg(long)]
    quick: bool,
    /// The sweeps to the extremes alone: the same as the family stability.
    #[arg(long)]
    stability: bool,
    /// Folder for tables, plots, conclusions and what has been measured; made if it isn't there.
    #[arg(long, value_name = "DIR", default_value = "out/trade")]
    out: PathBuf,
    /// Measure anew what is kept in the folder from before.
    #[arg(long)]
    fresh: bool,
}

/// A bar for all tasks.
#[derive(Default)]
struct Bar(Option<Progress>);

impl Watch for Bar {
    fn task(&mut self, name: &str) {
        if let Some(bar) = &self.0 {
            bar.note(name);
        }
    }
    fn add(&mut self, steps: u64) {
        if let Some(bar) = &self.0 {
            bar.add(steps);
        }
    }
    fn total(&mut self, steps: u64) {
        self.0 = Some(Progress::new("trade", steps));
    }
}

impl Arguments {
    /// The answer, and 1 if a sweep leaves its tolerance within its domain.
    pub(super) fn run(self) -> Result<(Answer, ExitCode), Failure> {
        let mut families = self.families;
        if self.stability {
            families.push(trade::STABILITY.to_owned());
        }
        let request = Request { families, quick: self.quick, folder: self.out, fresh: self.fresh };
        let account = trade::run(&request, &mut Bar::default())?;
        let code = if account.passed() { ExitCode::SUCCESS } else { ExitCode::from(1) };
        Ok((Answer { text: account.text(), json: serde_json::to_value(&account)? }, code))
    }
}
