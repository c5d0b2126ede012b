//! How accurate the core crates' public functions are: measured against numbers of twice `f64`'s precision, function by function, in both
//! precisions, and held against one table of tolerances.
//!
//! - [`table`]: what is measured, in which unit, and how large the error may be; what isn't, and why;
//! - [`cases`]: how it is measured: domains, and oracles written from the sources of the formulas;
//! - [`gauge`]: points (special values, walks around edges, grids, random) and units;
//! - [`lines`]: exact integrals of piecewise linear functions;
//! - [`wide`]: arithmetic and elementary functions of 106 bits;
//! - [`scan`]: which public functions there are;
//! - [`report`]: the table as Markdown.
//!
//! A public function that is neither measured nor exempt fails the test, and so do a tolerance that is exceeded, one that is more than three
//! times what is measured, and an entry whose function is gone. `cargo run --release -p spectral-tests --bin accuracy_table` writes
//! `tests/ACCURACY.md`.

#![allow(
    clippy::cast_possible_truncation,
    clippy::cast_precision_loss,
    clippy::cast_sign_loss,
    reason = "indices of grids and seeds are small, and conversions of random bits are meant to wrap"
)]
#![allow(clippy::approx_constant, reason = "limits of domains are round numbers")]
#![allow(clippy::needless_range_loop, reason = "formulas with indices are written with them")]
#![allow(clippy::type_complexity, reason = "closures that measure take what is measured")]

pub mod cases;
pub mod gauge;
pub mod lines;
pub mod report;
pub mod scan;
pub mod table;
pub mod wide;

use rayon::prelude::*;

use gauge::{Found, Gauge};
use table::{ENTRIES, Entry};

/// What was found of an entry, in `f32` and in `f64`.
#[derive(Clone, Debug)]
pub struct Measured {
    /// The entry.
    pub entry: &'static Entry,
    /// In `f32` and in `f64`.
    pub found: [Found; 2],
}

/// How many times what is measured a tolerance may be.
pub const SLACK: f64 = 3.0;

impl Measured {
    /// Why the entry fails, if it does.
    #[must_use]
    pub fn complaints(&self) -> Vec<String> {
        let each = ["f32", "f64"].into_iter().zip(&self.found).zip(self.entry.tolerance);
        let complaint = |((precision, found), tolerance): ((&str, &Found), f64)| {
            let name = self.entry.name;
            if !(found.worst <= tolerance) {
                return Some(format!(
                    "{name} ({precision}): {:.3e} exceeds the tolerance {tolerance:.3e} at {:?} ({:?})",
                    found.worst, found.point, found.choice
                ));
            }
            let stale = found.worst * SLACK < tolerance;
            stale
                .then(|| format!("{name} ({precision}): the tolerance {tolerance:.3e} is stale at {:.3e}", found.worst))
        };
        each.filter_map(complaint).collect()
    }
}

/// Measures all entries whose name contains the text.
#[must_use]
pub fn measure(containing: &str) -> Vec<Measured> {
    let chosen: Vec<_> = ENTRIES.iter().filter(|entry| entry.name.contains(containing)).collect();
    let run = |entry: &'static Entry, precision: usize| {
        let mut gauge = Gauge::new(entry.unit, seed(entry.name));
        entry.cases[precision](&mut gauge);
        gauge.found()
    };
    chosen.into_par_iter().map(|entry| Measured { entry, found: [run(entry, 0), run(entry, 1)] }).collect()
}

/// A seed of an entry's own (FNV-1a), so that entries don't depend on each other.
fn seed(name: &str) -> u64 {
    name.bytes().fold(0xcbf2_9ce4_8422_2325, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3))
}
