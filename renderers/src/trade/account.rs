//! Measuring task by task, in rounds, and writing what was found.

use std::path::PathBuf;

use serde::Serialize;

use super::curve::{Curve, Point};
use super::plan::{Plan, Run, rms_and_worst};
use super::stability::{self, Sweep};
use super::store::{Record, Store};
use super::{Family, Request, TradeError, conclusions, plot, select, table};

/// What was found.
#[derive(Clone, Debug, Serialize)]
pub struct Account {
    /// The program that measured.
    pub program: String,
    /// Whether it was the quick account.
    pub quick: bool,
    /// Curves of all families that were asked for.
    pub curves: Vec<Curve>,
    /// Sweeps to the extremes.
    pub stability: Vec<Sweep>,
    /// Tasks whose runs were all kept from before.
    pub reused: Vec<String>,
    /// The files that were written.
    pub files: Vec<PathBuf>,
}

impl Account {
    /// Whether no sweep leaves its tolerance within its documented domain.
    #[must_use]
    pub fn passed(&self) -> bool {
        self.stability.iter().all(|sweep| sweep.pass != Some(false))
    }

    /// The account as text: tables and conclusions.
    #[must_use]
    pub fn text(&self) -> String {
        table::text(self)
    }
}

/// Is told how far the account is.
pub trait Watch {
    /// A task begins.
    fn task(&mut self, name: &str);
    /// So much more is done, in about milliseconds of all that [`Watch::total`] said.
    fn add(&mut self, steps: u64);
    /// How much there is to do.
    fn total(&mut self, steps: u64);
}

/// Steps for a weight in seconds.
#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a few hours at most")]
fn steps(seconds: f64) -> u64 {
    (1000.0 * seconds).ceil() as u64
}

/// About how long the sweeps take.
const STABILITY_WEIGHT: [f64; 2] = [60.0, 15.0];

/// Measures what is asked for, or takes it from what is kept, and writes tables, plots and conclusions.
///
/// # Errors
/// A family that doesn't exist, a task that can't be done, or a file that can't be written.
pub fn run(request: &Request, watch: &mut dyn Watch) -> Result<Account, TradeError> {
    let (families, with_stability) = select(&request.families)?;
    let store = Store::open(&request.folder, request.fresh)?;
    let plans: Vec<(Family, Vec<Plan>)> = families.iter().map(|f| (*f, (f.plans)(request.quick))).collect();
    let extremes = if with_stability { STABILITY_WEIGHT[usize::from(request.quick)] } else { 0.0 };
    let measured: f64 = plans.iter().flat_map(|(_, plans)| plans).map(|plan| plan.weight).sum();
    watch.total(steps(measured + extremes));
    let mut account = Account {
        program: store.program().to_owned(),
        quick: request.quick,
        curves: Vec::new(),
        stability: Vec::new(),
        reused: Vec::new(),
        files: Vec::new(),
    };
    for (family, plans) in plans {
        let first = account.curves.len();
        for plan in plans {
            let (curve, reused) = measure(&family, plan, request.quick, &store, watch)?;
            if reused {
                account.reused.push(curve.name.clone());
            }
            account.files.push(write_plot(&store, &curve.name, &[&curve])?);
            account.curves.push(curve);
        }
        let curves: Vec<&Curve> = account.curves[first..].iter().collect();
        account.files.push(write_plot(&store, family.name, &curves)?);
        account.files.push(store.write_text(&format!("{}.csv", family.name), &table::csv(&curves))?);
    }
    if with_stability {
        let (sweeps, reused) = stability::measure(request.quick, &store, watch, steps(extremes))?;
        if reused {
            account.reused.push(super::STABILITY.to_owned());
        }
        account.stability = sweeps;
        let path = store.folder().join("stability.png");
        plot::sweeps(&account.stability, &path).map_err(|e| TradeError::new(e.to_string()))?;
        account.files.push(path);
        account.files.push(store.write_text("stability.csv", &table::sweeps_csv(&account.stability))?);
    }
    account.files.push(store.write_text("index.html", &conclusions::page(&account))?);
    let json = serde_json::to_string_pretty(&account).map_err(|e| TradeError::new(e.to_string()))?;
    account.files.push(store.write_text("account.json", &json)?);
    Ok(account)
}

fn write_plot(store: &Store, name: &str, curves: &[&Curve]) -> Result<PathBuf, TradeError> {
    let path = store.folder().join(format!("{name}.png"));
    plot::curves(curves, &path).map_err(|e| TradeError::new(e.to_string()))?;
    Ok(path)
}

/// Runs the rounds of a task that are missing; whether none was.
fn measure(
    family: &Family,
    mut plan: Plan,
    quick: bool,
    store: &Store,
    watch: &mut dyn Watch,
) -> Result<(Curve, bool), TradeError> {
    let name = format!("{}.{}", family.name, plan.name);
    let file = format!("{name}{}", if quick { ".quick" } else { "" });
    watch.task(&name);
    let key = store.key(&format!("{name}, {}, {} rounds, {}", plan.title, plan.rounds, plan.truth));
    let kept: Option<Record> = store.load(&file, &key);
    let is_complete = kept.as_ref().is_some_and(|record| record.rounds >= plan.rounds);
    let whole = steps(plan.weight);
    if let (Some(record), true) = (&kept, is_complete) {
        watch.add(whole);
        return Ok((curve(family, &name, &plan, record), true));
    }
    let failed = |setting: &str, why: &str| TradeError::new(format!("{name}, {setting}: {why}"));
    let build = core::mem::replace(&mut plan.build, Box::new(|| Ok(Vec::new())));
    let mut settings = build().map_err(|why| failed("truth", &why))?;
    let listed: Vec<_> = settings.iter().map(|s| (s.name.clone(), s.method.to_owned(), s.own)).collect();
    let mut record = kept.filter(|r| r.settings() == listed).unwrap_or_else(|| Record::new(&key, listed));
    let each = whole / (plan.rounds * settings.len().max(1)) as u64;
    while record.rounds < plan.rounds {
        let mut round: Vec<(String, Run)> = Vec::new();
        for setting in &mut settings {
            let run = (setting.run)(record.rounds as u64).map_err(|why| failed(&setting.name, &why))?;
            round.push((setting.name.clone(), run));
            watch.add(each);
        }
        record.add(round);
        store.save(&file, &record)?;
    }
    Ok((curve(family, &name, &plan, &record), false))
}

fn curve(family: &Family, name: &str, plan: &Plan, record: &Record) -> Curve {
    let point = |(setting, method, own): &(String, String, bool)| point(setting, method, *own, &record.runs(setting));
    let mut curve = Curve {
        name: name.to_owned(),
        family: family.name.to_owned(),
        title: plan.title.clone(),
        error: plan.error.to_owned(),
        operations: plan.operations.to_owned(),
        truth: plan.truth.clone(),
        floor: plan.floor,
        rounds: record.rounds,
        points: record.settings().iter().map(point).collect(),
        agreement: super::Agreement::default(),
        budgets: Vec::new(),
    };
    curve.judge();
    curve
}

fn point(setting: &str, method: &str, own: bool, runs: &[Run]) -> Point {
    let mut seconds: Vec<f64> = runs.iter().map(|run| run.seconds).collect();
    seconds.sort_by(f64::total_cmp);
    let at = |part: usize| seconds.get((seconds.len().saturating_sub(1) * part + 2) / 4).copied().unwrap_or(f64::MAX);
    let [error, _] = rms_and_worst(runs.iter().map(|run| run.error));
    let [_, worst] = rms_and_worst(runs.iter().map(|run| run.worst));
    let operations = runs.iter().map(|run| run.operations).sum::<f64>() / super::plan::count(runs.len());
    Point {
        setting: setting.to_owned(),
        method: method.to_owned(),
        own,
        seconds: at(2),
        seconds_spread: [at(1), at(3)],
        operations,
        error,
        worst,
        front_seconds: false,
        front_operations: false,
    }
}
