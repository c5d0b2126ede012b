//! How far input may go: sweeps over many orders of magnitude, and whether errors keep what is documented.
//!
//! A [`Sweep`] is one quantity in one precision over one axis. Where a domain and an accuracy are documented, errors within
//! it are judged; beyond it, and where none is documented, they are shown only.

mod lights;
mod pictures;
mod reflection;
mod shapes;
mod spectra;

use serde::{Deserialize, Serialize};

use super::TradeError;
use super::account::Watch;
use super::store::{Keyed, Store};

/// Steps of a decade.
const fn steps(quick: bool) -> i32 {
    if quick { 1 } else { 4 }
}

/// Sweeps in both precisions, those of one name together.
fn by_name(some: impl IntoIterator<Item = Sweep>) -> Vec<Sweep> {
    let mut all: Vec<Sweep> = some.into_iter().collect();
    all.sort_by(|a, b| a.name.cmp(&b.name));
    all
}

/// What is documented about a quantity.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Domain {
    /// From where to where on the axis, both included.
    pub range: [f64; 2],
    /// The largest error there.
    pub tolerance: f64,
    /// Where that is said.
    pub source: String,
}

impl Domain {
    /// Whether a place on the axis is in the domain.
    #[must_use]
    pub fn contains(&self, place: f64) -> bool {
        // Places are powers of ten, which domains are rounded to in other ways.
        let slack = 1e-12;
        place >= self.range[0] * (1.0 - slack) && place <= self.range[1] * (1.0 + slack)
    }
}

/// One quantity's error over one axis.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Sweep {
    /// Quantity and axis.
    pub name: String,
    /// The type of its numbers: `f32` or `f64`.
    pub precision: String,
    /// The axis, with its unit.
    pub axis: String,
    /// What the error is.
    pub error: String,
    /// Places on the axis, increasing, and errors. The largest number stands for an error that is infinite or none.
    pub points: Vec<[f64; 2]>,
    /// What is documented; `None` if nothing is.
    pub domain: Option<Domain>,
    /// The largest error within the domain, if any place is in it.
    pub worst: Option<f64>,
    /// From where to where around the domain's middle (without one, around 1) errors stay within the tolerance, or, where none is
    /// documented, within ten times the median error.
    pub reach: Option<[f64; 2]>,
    /// Whether all errors within the domain are within the tolerance; `None` where nothing is documented.
    pub pass: Option<bool>,
}

impl Sweep {
    /// Sweeps an axis: `error` says how far off the quantity is at a place, or `None` where its input is refused.
    pub fn new(
        [name, precision, axis, error_name]: [&str; 4],
        domain: Option<Domain>,
        places: &[f64],
        mut error: impl FnMut(f64) -> Option<f64>,
    ) -> Self {
        let numbers = |place: &f64| {
            let error = error(*place)?;
            // Also NaN, which is as wrong as can be.
            Some([*place, if error.abs() < f64::MAX { error.abs() } else { f64::MAX }])
        };
        let points: Vec<[f64; 2]> = places.iter().filter_map(numbers).collect();
        let [name, precision, axis, error] = [name, precision, axis, error_name].map(str::to_owned);
        let mut sweep = Self { name, precision, axis, error, points, domain, worst: None, reach: None, pass: None };
        sweep.judge();
        sweep
    }

    /// Finds anew what follows from points and domain.
    ///
    /// A documented domain in which no place was judged fails: nothing was shown.
    pub fn judge(&mut self) {
        let within = |p: &&[f64; 2]| self.domain.as_ref().is_some_and(|d| d.contains(p[0]));
        self.worst = self.points.iter().filter(within).map(|p| p[1]).max_by(f64::total_cmp);
        self.pass = self.domain.as_ref().map(|d| self.worst.is_some_and(|worst| worst <= d.tolerance));
        self.reach = self.find_reach();
    }

    fn find_reach(&self) -> Option<[f64; 2]> {
        let mut errors: Vec<f64> = self.points.iter().map(|p| p[1]).collect();
        errors.sort_by(f64::total_cmp);
        let median = errors.get(errors.len() / 2).copied()?;
        let (limit, middle) = match &self.domain {
            Some(domain) => (domain.tolerance, (domain.range[0].max(1e-300).log10() + domain.range[1].log10()) / 2.0),
            None => (10.0 * median.max(1e-16), 0.0),
        };
        let distance = |p: &[f64; 2]| (p[0].log10() - middle).abs();
        let start =
            (0..self.points.len()).min_by(|a, b| distance(&self.points[*a]).total_cmp(&distance(&self.points[*b])))?;
        let fits = |p: &&[f64; 2]| p[1] <= limit;
        let low = self.points[..=start].iter().rev().take_while(fits).last()?[0];
        let high = self.points[start..].iter().take_while(fits).last()?[0];
        Some([low, high])
    }
}

/// Powers of ten, `steps` to a decade, from 10^`low` to 10^`high`.
fn powers(low: i32, high: i32, steps: i32) -> Vec<f64> {
    (low * steps..=high * steps).map(|k| 10.0_f64.powf(f64::from(k) / f64::from(steps))).collect()
}

/// A documented domain.
fn domain(range: [f64; 2], tolerance: f64, source: &str) -> Option<Domain> {
    Some(Domain { range, tolerance, source: source.to_owned() })
}

/// What is kept of a run.
#[derive(Debug, Serialize, Deserialize)]
struct Kept {
    key: String,
    parts: Vec<(String, Vec<Sweep>)>,
}

impl Keyed for Kept {
    fn key(&self) -> &str {
        &self.key
    }
}

/// Makes the sweeps of a kind.
type Part = fn(bool) -> Result<Vec<Sweep>, String>;

const PARTS: [(&str, Part); 5] = [
    ("spectra", spectra::sweeps),
    ("lights", lights::sweeps),
    ("shapes", shapes::sweeps),
    ("reflection", reflection::sweeps),
    ("pictures", pictures::sweeps),
];

/// All sweeps, and whether they were all kept from before.
pub(super) fn measure(
    quick: bool,
    store: &Store,
    watch: &mut dyn Watch,
    steps: u64,
) -> Result<(Vec<Sweep>, bool), TradeError> {
    let file = if quick { "stability.quick" } else { "stability" };
    let key = store.key("sweeps to the extremes");
    let kept: Option<Kept> = store.load(file, &key);
    let mut kept = kept.unwrap_or(Kept { key, parts: Vec::new() });
    kept.parts.iter_mut().flat_map(|(_, sweeps)| sweeps).for_each(Sweep::judge);
    let mut reused = true;
    for (name, sweeps) in PARTS {
        watch.task(&format!("stability.{name}"));
        if !kept.parts.iter().any(|(known, _)| known == name) {
            reused = false;
            let found = sweeps(quick).map_err(|why| TradeError::new(format!("stability.{name}: {why}")))?;
            kept.parts.push((name.to_owned(), found));
            store.save(file, &kept)?;
        }
        watch.add(steps / PARTS.len() as u64);
    }
    Ok((kept.parts.into_iter().flat_map(|(_, sweeps)| sweeps).collect(), reused))
}
