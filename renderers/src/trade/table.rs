//! The account as tables: for a terminal and as CSV.

use super::account::Account;
use super::conclusions;
use super::curve::{Curve, Point};
use super::stability::Sweep;
use crate::report::Table;

/// All tables, and what follows from them.
pub(super) fn text(account: &Account) -> String {
    let mut text = String::new();
    for curve in &account.curves {
        text += &format!(
            "{}: {}\ntruth: {}\n{} rounds; front: t by time, o by {}\n",
            curve.name, curve.title, curve.truth, curve.rounds, curve.operations
        );
        text += &format!("{}\n", curve_table(curve));
        for sentence in conclusions::of_curve(curve) {
            text += &format!("- {sentence}\n");
        }
        text += "\n";
    }
    if !account.stability.is_empty() {
        text += &format!("stability at the extremes\n{}\n", sweep_table(&account.stability));
        let failed = account.stability.iter().filter(|s| s.pass == Some(false)).count();
        let judged = account.stability.iter().filter(|s| s.pass.is_some()).count();
        text += &format!("{judged} sweeps judged, {failed} leave their tolerance within the documented domain\n\n");
    }
    for file in &account.files {
        text += &format!("{}\n", file.display());
    }
    text
}

fn curve_table(curve: &Curve) -> Table {
    let mut table =
        Table::new(["setting", "seconds", "± %", curve.operations.as_str(), curve.error.as_str(), "worst", "front"]);
    for point in &curve.points {
        table.row([
            point.setting.clone(),
            figure(point.seconds),
            format!("{:.0}", spread(point)),
            figure(point.operations),
            figure(point.error),
            figure(point.worst),
            front(point),
        ]);
    }
    table
}

/// Half the distance of the quartiles in per cent of the median.
fn spread(point: &Point) -> f64 {
    let [low, high] = point.seconds_spread;
    if point.seconds > 0.0 { 50.0 * (high - low) / point.seconds } else { 0.0 }
}

fn front(point: &Point) -> String {
    let mark = |on: bool, mark: &'static str| if on { mark } else { "" };
    format!("{}{}", mark(point.front_seconds, "t"), mark(point.front_operations, "o"))
}

/// Three digits, in plain notation where that is short.
pub(super) fn figure(value: f64) -> String {
    let size = value.abs();
    if value == 0.0 {
        "0".to_owned()
    } else if !(1e-3..1e6).contains(&size) {
        format!("{value:.2e}")
    } else if size >= 100.0 {
        format!("{value:.0}")
    } else if size >= 10.0 {
        format!("{value:.1}")
    } else if size >= 1.0 {
        format!("{value:.2}")
    } else {
        format!("{value:.4}")
    }
}

/// Whether sweeps keep what is documented.
pub(super) fn sweep_table(sweeps: &[Sweep]) -> Table {
    let mut table =
        Table::new(["sweep", "type", "domain", "tolerance", "worst within", "error stays below from", "to", "result"]);
    for sweep in sweeps {
        let domain = sweep.domain.as_ref();
        let reach = sweep.reach.map(|reach| reach.map(figure));
        let [from, to] = reach.unwrap_or_else(|| ["-".to_owned(), "-".to_owned()]);
        table.row([
            sweep.name.clone(),
            sweep.precision.clone(),
            domain.map_or("none stated".to_owned(), |d| format!("{} to {}", figure(d.range[0]), figure(d.range[1]))),
            domain.map_or("-".to_owned(), |d| figure(d.tolerance)),
            sweep.worst.map_or("-".to_owned(), figure),
            from,
            to,
            match sweep.pass {
                Some(true) => "pass".to_owned(),
                Some(false) => "FAIL".to_owned(),
                None => "shown only".to_owned(),
            },
        ]);
    }
    table
}

/// Curves as comma-separated values, a point a line.
pub(super) fn csv(curves: &[&Curve]) -> String {
    let mut text = String::from(
        "curve,setting,method,own,seconds,seconds_first_quartile,seconds_last_quartile,operations,error,worst,front_seconds,front_operations\n",
    );
    for curve in curves {
        for p in &curve.points {
            let [low, high] = p.seconds_spread;
            text += &format!(
                "{},{},{},{},{:e},{low:e},{high:e},{:e},{:e},{:e},{},{}\n",
                quoted(&curve.name),
                quoted(&p.setting),
                quoted(&p.method),
                p.own,
                p.seconds,
                p.operations,
                p.error,
                p.worst,
                p.front_seconds,
                p.front_operations
            );
        }
    }
    text
}

/// Sweeps as comma-separated values, a place a line.
pub(super) fn sweeps_csv(sweeps: &[Sweep]) -> String {
    let mut text = String::from("sweep,precision,axis,place,error,within_domain,tolerance\n");
    for sweep in sweeps {
        for &[place, error] in &sweep.points {
            let domain = sweep.domain.as_ref();
            let within = domain.is_some_and(|d| d.contains(place));
            let tolerance = domain.map_or(String::new(), |d| format!("{:e}", d.tolerance));
            let (name, axis) = (quoted(&sweep.name), quoted(&sweep.axis));
            text += &format!("{name},{},{axis},{place:e},{error:e},{within},{tolerance}\n", sweep.precision);
        }
    }
    text
}

/// A field of CSV (RFC 4180).
fn quoted(field: &str) -> String {
    if field.contains([',', '"', '\n']) { format!("\"{}\"", field.replace('"', "\"\"")) } else { field.to_owned() }
}
