//! What accuracy costs, measured: for each family of methods a curve of time, counted work and error, and how far the
//! extremes of its input may go.
//!
//! Errors are always taken against truth: a closed form, an exact integral, a far finer representation of the same thing,
//! or many paths whose own noise is stated. Times are medians over rounds in which the settings of a task take turns, so
//! that a busy machine slows them alike; work on one core is timed piece by piece, of each the least of three repeats.
//! Beside time, each run counts work that is the same on every machine, and [`Curve::agreement`] says where the two
//! measures disagree. [`Curve`] marks the Pareto front by both.
//!
//! [`run`] measures, draws and writes; what has been measured is kept in the folder after each round, so that an
//! interrupted account goes on where it was.

mod account;
mod brdf;
mod conclusions;
mod curve;
mod disk;
mod global;
mod lights;
mod penumbra;
mod photons;
mod picture;
mod plan;
mod plot;
mod precision;
mod products;
mod radiosity;
mod spectra;
pub mod stability;
mod store;
mod table;

use std::path::{Path, PathBuf};

pub use account::{Account, Watch, run};
pub use curve::{Agreement, Budget, Curve, Point, pareto_front};
use plan::Plan;

/// What an account is asked for.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Request {
    /// Names of [`families`], in any order; none for all of them.
    pub families: Vec<String>,
    /// About a minute instead of half an hour: fewer settings, rounds and items.
    pub quick: bool,
    /// The folder for runs and results.
    pub folder: PathBuf,
    /// Whether runs that are kept there are forgotten.
    pub fresh: bool,
}

/// Why an account could not be made: one line.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TradeError(String);

impl TradeError {
    fn new(text: impl Into<String>) -> Self {
        Self(text.into())
    }

    fn io(path: &Path, error: &std::io::Error) -> Self {
        Self(format!("{}: {error}", path.display()))
    }
}

impl core::fmt::Display for TradeError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str(&self.0)
    }
}

impl core::error::Error for TradeError {}

/// A family of methods that do the same.
#[derive(Clone, Copy, Debug)]
pub struct Family {
    /// What it is called on the command line.
    pub name: &'static str,
    /// What it is about.
    pub about: &'static str,
    plans: fn(bool) -> Vec<Plan>,
}

/// The name of the sweeps to the extremes, which are selected like a family.
pub const STABILITY: &str = "stability";

const FAMILIES: [Family; 7] = [
    Family { name: "spectral", about: "representations of spectra, by pixels' colours", plans: spectra::plans },
    Family { name: "disk", about: "disk lights by subdivision and on request", plans: disk::plans },
    Family { name: "radiosity", about: "light between surfaces", plans: radiosity::plans },
    Family { name: "photons", about: "caustics by photons", plans: photons::plans },
    Family { name: "brdf", about: "sampling of glossy reflection", plans: brdf::plans },
    Family { name: "precision", about: "f32 against f64", plans: precision::plans },
    Family { name: "lights", about: "light samples and rays in a pixel", plans: lights::plans },
];

/// All families, in the order in which they are measured.
#[must_use]
pub const fn families() -> &'static [Family] {
    &FAMILIES
}

/// The families that names stand for, and whether the sweeps to the extremes are among them.
fn select(names: &[String]) -> Result<(Vec<Family>, bool), TradeError> {
    if names.is_empty() {
        return Ok((FAMILIES.to_vec(), true));
    }
    let is_known = |name: &&String| *name == STABILITY || FAMILIES.iter().any(|f| f.name == **name);
    if let Some(unknown) = names.iter().find(|name| !is_known(name)) {
        let known: Vec<_> = FAMILIES.iter().map(|f| f.name).chain([STABILITY]).collect();
        return Err(TradeError::new(format!("no family is called {unknown:?}; there are {}", known.join(", "))));
    }
    let families = FAMILIES.iter().filter(|f| names.iter().any(|n| n == f.name)).copied().collect();
    Ok((families, names.iter().any(|n| n == STABILITY)))
}
