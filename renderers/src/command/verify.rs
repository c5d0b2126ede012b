//! `spectral verify`: the analytic bench.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::Args;
use renderers::progress::Progress;
use renderers::report::Table;
use renderers::verify::{self, Answers, Case, Outcome, Provenance, Status};
use serde_json::json;

use super::{Answer, Failure};

/// What `spectral verify` takes.
#[derive(Debug, Args)]
pub(super) struct Arguments {
    /// Cases or groups by the beginning of their names, such as cie-171.5.6 or disk.table-2.1; all without.
    ///
    /// Cases that are named are shown number by number.
    #[arg(value_name = "CASE")]
    cases: Vec<String>,
    /// List the cases with what they are about.
    #[arg(long, conflicts_with_all = ["export", "score"])]
    list: bool,
    /// Write the cases as scenes for Mitsuba 3 and Radiance, with their points, into this folder.
    #[arg(long, value_name = "DIR", conflicts_with = "score")]
    export: Option<PathBuf>,
    /// Judge the answers of another program: a file of lines case,point,value.
    #[arg(long, value_name = "RESULTS")]
    score: Option<PathBuf>,
    /// Photometric files of CIE 171:2006 cases 4.1-4.6: cfl-1.ies to cfl-4.ies, opal-1.ies ..., ssr-1.ies ... (or
    /// .ldt).
    #[arg(long, value_name = "DIR")]
    photometry: Option<PathBuf>,
}

impl Arguments {
    /// The answer, and 1 if a check failed.
    pub(super) fn run(self) -> Result<(Answer, ExitCode), Failure> {
        let all = verify::cases(self.photometry()?);
        let selected = self.select(&all)?;
        if self.list {
            return Ok((list(&selected), ExitCode::SUCCESS));
        }
        if let Some(folder) = &self.export {
            return Ok((export(&selected, folder)?, ExitCode::SUCCESS));
        }
        let answers = self.score.as_deref().map(|file| Answers::read(file, &all)).transpose()?;
        let progress = Progress::new("verify", selected.len() as u64);
        let mut results = Vec::new();
        for case in &selected {
            let answers = match &answers {
                Some(answers) => answers.of(case),
                None => verify::solve(case),
            };
            let mut outcomes = case.judge(&answers);
            outcomes.retain(|outcome| self.wants(case, outcome));
            results.push((case, outcomes));
            progress.add(1);
        }
        drop(progress);
        let failed = results.iter().flat_map(|(_, outcomes)| outcomes).any(|outcome| outcome.status == Status::Fail);
        let code = if failed { ExitCode::from(1) } else { ExitCode::SUCCESS };
        Ok((show(&results, !self.cases.is_empty()), code))
    }

    fn photometry(&self) -> Result<Option<&Path>, Failure> {
        let folder = self.photometry.as_deref();
        match folder {
            Some(folder) if !folder.is_dir() => {
                return Err(Failure(format!("{}: no such folder", folder.display())));
            }
            Some(folder) => verify::check_photometry(folder).map_err(Failure)?,
            None => {}
        }
        Ok(folder)
    }

    /// The cases whose names, or the names of whose checks, begin as asked.
    fn select(&self, all: &[Case]) -> Result<Vec<Case>, Failure> {
        let matches = |case: &Case, asked: &str| {
            case.name.starts_with(asked) || case.checks.iter().any(|check| case.row_name(check).starts_with(asked))
        };
        if let Some(unknown) = self.cases.iter().find(|asked| !all.iter().any(|case| matches(case, asked))) {
            return Err(Failure(format!("no case is named {unknown:?} or begins so (spectral verify --list)")));
        }
        let wanted = |case: &&Case| self.cases.is_empty() || self.cases.iter().any(|asked| matches(case, asked));
        Ok(all.iter().filter(wanted).cloned().collect())
    }

    /// Whether a check belongs to what was asked for: all of a case, or single ones of it.
    fn wants(&self, case: &Case, outcome: &Outcome) -> bool {
        self.cases.is_empty()
            || self.cases.iter().any(|asked| case.name.starts_with(asked) || outcome.name.starts_with(asked.as_str()))
    }
}

fn list(cases: &[Case]) -> Answer {
    let mut table = Table::new(["case", "points", "checks", "about"]);
    for case in cases {
        let (points, checks) = (case.points.len().to_string(), case.checks.len().to_string());
        table.row([case.name.clone(), points, checks, case.about.clone()]);
    }
    let entry = |case: &Case| json!({ "name": case.name, "about": case.about, "points": case.points.len(), "checks": case.checks.len() });
    let json = json!({ "cases": cases.iter().map(entry).collect::<Vec<_>>() });
    Answer { text: table.to_string(), json }
}

fn export(cases: &[Case], folder: &Path) -> Result<Answer, Failure> {
    let files = verify::export(cases, folder)?;
    let names: Vec<_> = files.iter().map(|file| file.display().to_string()).collect();
    let text = format!("{} files in {}; see README.md there", names.len(), folder.display());
    Ok(Answer { text, json: json!({ "files": names }) })
}

/// Numbers of outcomes by their end.
#[derive(Clone, Copy, Default)]
struct Count {
    passed: usize,
    failed: usize,
    skipped: usize,
    informative: usize,
}

impl Count {
    fn of<'a>(outcomes: impl IntoIterator<Item = &'a Outcome>) -> Self {
        let mut count = Self::default();
        for outcome in outcomes {
            *match outcome.status {
                Status::Pass => &mut count.passed,
                Status::Fail => &mut count.failed,
                Status::Skipped => &mut count.skipped,
                Status::Informative => &mut count.informative,
            } += 1;
        }
        count
    }

    fn to_line(self) -> String {
        let Self { passed, failed, skipped, informative } = self;
        format!("{passed} passed, {failed} failed, {skipped} skipped, {informative} shown only")
    }
}

fn show(results: &[(&Case, Vec<Outcome>)], in_detail: bool) -> Answer {
    let count = Count::of(results.iter().flat_map(|(_, outcomes)| outcomes));
    let mut text = String::new();
    if in_detail {
        for (case, outcomes) in results {
            text += &format!("{}: {}\n{}{}\n\n", case.name, case.about, details(case, outcomes), worst_line(outcomes));
        }
    } else {
        text = summary(results);
    }
    text += &format!("{}\n", count.to_line());
    let cases: Vec<_> = results.iter().flat_map(|(_, outcomes)| outcomes).collect();
    let json = json!({
        "cases": cases, "passed": count.passed, "failed": count.failed, "skipped": count.skipped,
        "informative": count.informative
    });
    Answer { text, json }
}

/// One line for each case, then the checks that failed and the reasons for what was skipped.
fn summary(results: &[(&Case, Vec<Outcome>)]) -> String {
    let mut table = Table::new([
        "case",
        "checks",
        "passed",
        "failed",
        "skipped",
        "shown only",
        "worst error",
        "tolerance",
        "time",
        "note",
    ]);
    let mut failures = Table::new(HEADINGS);
    let mut any_failed = false;
    for (case, outcomes) in results {
        let count = Count::of(outcomes);
        let (error, tolerance) = match worst(outcomes) {
            Some(outcome) => (percent(outcome.relative_error), allowed(outcome.tolerance)),
            None => (String::new(), String::new()),
        };
        // Checks of the same point share its time.
        let name = |outcome: &Outcome| outcome.name.trim_end_matches(".printed").trim_end_matches(".cie").to_owned();
        let mut seen = std::collections::HashSet::new();
        let seconds: f64 = outcomes.iter().filter(|o| seen.insert(name(o))).filter_map(|outcome| outcome.seconds).sum();
        let timed = outcomes.iter().any(|outcome| outcome.seconds.is_some());
        let reason = outcomes.iter().find(|outcome| outcome.pass.is_none()).and_then(|outcome| outcome.reason.clone());
        table.row([
            case.name.clone(),
            outcomes.len().to_string(),
            count.passed.to_string(),
            count.failed.to_string(),
            count.skipped.to_string(),
            count.informative.to_string(),
            error,
            tolerance,
            if timed { duration(seconds) } else { String::new() },
            reason.unwrap_or_default(),
        ]);
        for outcome in outcomes.iter().filter(|outcome| outcome.status == Status::Fail) {
            any_failed = true;
            failures.row(cells(&outcome.name, outcome));
        }
    }
    if any_failed { format!("{table}\n{failures}\n") } else { format!("{table}\n") }
}

const HEADINGS: [&str; 8] = ["check", "reference", "computed", "error", "tolerance", "samples", "time", "result"];

fn details(case: &Case, outcomes: &[Outcome]) -> String {
    let quantities: alloc::collections::BTreeSet<_> = outcomes.iter().map(|outcome| outcome.quantity).collect();
    let mut table = Table::new(HEADINGS);
    for outcome in outcomes {
        let own = outcome.name.strip_prefix(&case.name).map_or("", |name| name.trim_start_matches('.'));
        table.row(cells(if own.is_empty() { "–" } else { own }, outcome));
    }
    format!("{}\n{table}", quantities.into_iter().collect::<Vec<_>>().join("; "))
}

fn cells(name: &str, outcome: &Outcome) -> [String; 8] {
    let (error, tolerance) = if outcome.reference == 0.0 {
        (
            outcome.computed.map_or_else(String::new, |value| format!("{value:+.1e}")),
            format!("{:.1e}", outcome.tolerance),
        )
    } else {
        (percent(outcome.relative_error), allowed(outcome.tolerance))
    };
    let result = match (outcome.status, &outcome.reason) {
        (Status::Pass, _) => "pass".to_owned(),
        (Status::Fail, _) => "FAIL".to_owned(),
        (Status::Skipped, reason) => format!("skipped: {}", reason.as_deref().unwrap_or_default()),
        (Status::Informative, reason) => format!("information: {}", reason.as_deref().unwrap_or_default()),
    };
    [
        name.to_owned(),
        significant(outcome.reference),
        outcome.computed.map_or_else(String::new, significant),
        error,
        tolerance,
        outcome.samples.map_or_else(String::new, |samples| samples.to_string()),
        outcome.seconds.map_or_else(String::new, duration),
        result,
    ]
}

/// The judged outcome that uses most of its tolerance; of those with an unrounded reference, where there are any.
fn worst(outcomes: &[Outcome]) -> Option<&Outcome> {
    let used = |outcome: &Outcome| match (outcome.computed, outcome.relative_error) {
        (_, Some(error)) => error.abs() / outcome.tolerance,
        (Some(value), None) => value.abs() / outcome.tolerance,
        _ => 0.0,
    };
    let judged = || outcomes.iter().filter(|outcome| outcome.pass.is_some());
    let unrounded = judged().filter(|outcome| matches!(outcome.provenance, Provenance::Recomputed(_)));
    let most = |a: &&Outcome, b: &&Outcome| used(a).total_cmp(&used(b));
    unrounded.max_by(most).or_else(|| judged().max_by(most))
}

fn worst_line(outcomes: &[Outcome]) -> String {
    let Some(outcome) = worst(outcomes) else { return "nothing was judged".to_owned() };
    let error = outcome.relative_error.map_or_else(|| "0".to_owned(), |error| percent(Some(error)));
    format!("worst: {} with {error} (tolerance {})", outcome.name, allowed(outcome.tolerance))
}

/// Eight significant digits.
fn significant(value: f64) -> String {
    if value == 0.0 || !value.is_finite() {
        return format!("{value}");
    }
    #[allow(clippy::cast_possible_truncation, reason = "the exponent of a finite number")]
    let decimals = (7 - value.abs().log10().floor() as i32).clamp(0, 12);
    #[allow(clippy::cast_sign_loss, reason = "not negative")]
    let decimals = decimals as usize;
    format!("{value:.decimals$}")
}

fn percent(share: Option<f64>) -> String {
    share.map_or_else(String::new, |share| {
        let share = share * 100.0;
        if share != 0.0 && share.abs() < 1e-3 { format!("{share:+.1e} %") } else { format!("{share:+.3} %") }
    })
}

/// A tolerance in per cent.
fn allowed(share: f64) -> String {
    percent(Some(share)).trim_start_matches('+').to_owned()
}

fn duration(seconds: f64) -> String {
    if seconds < 1e-3 {
        format!("{:.1} µs", seconds * 1e6)
    } else if seconds < 1.0 {
        format!("{:.1} ms", seconds * 1e3)
    } else {
        format!("{seconds:.2} s")
    }
}
