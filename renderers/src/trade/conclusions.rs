//! What follows from the figures: which method to take at which budget, said by the figures themselves.

use super::account::Account;
use super::curve::{Curve, Point};
use super::table::{figure, sweep_table};

/// Sentences about one curve.
pub(super) fn of_curve(curve: &Curve) -> Vec<String> {
    let mut said = vec![front(curve)];
    said.extend(simpler(curve));
    said.push(own(curve));
    said.push(measures(curve));
    said
}

/// The front by time in words, a method's settings in a row together.
fn front(curve: &Curve) -> String {
    let front = curve.front(true);
    let steps = front.chunk_by(|a, b| a.method == b.method).filter_map(|run| {
        let (first, last) = (run.first()?, run.last()?);
        let one = |p: &Point| format!("{} ({} s, {})", p.setting, figure(p.seconds), figure(p.error));
        Some(if run.len() == 1 { one(first) } else { format!("{} … {}", one(first), one(last)) })
    });
    format!("Best for their time, with {}: {}.", curve.error, steps.collect::<Vec<_>>().join("; then "))
}

/// Where methods that are not this project's own are the better choice.
fn simpler(curve: &Curve) -> Option<String> {
    let front = curve.front(true);
    let others: Vec<&&Point> = front.iter().filter(|p| !p.own).collect();
    let last = others.last()?;
    let mut names: Vec<&str> = Vec::new();
    for point in &others {
        if !names.contains(&point.method.as_str()) {
            names.push(&point.method);
        }
    }
    let reaches = |p: &&Point| p.own && p.error.max(curve.floor) <= last.error.max(curve.floor);
    let best_own = curve.points.iter().filter(reaches).map(|p| p.seconds).fold(f64::INFINITY, f64::min);
    let compared = if best_own.is_finite() {
        format!("this project's own takes {:.1} times as long for that", best_own / last.seconds)
    } else {
        "nothing of this project's own is as accurate".to_owned()
    };
    Some(format!(
        "Simpler methods win at {} of the {} settings on the front: {}; the most accurate of these is {} ({} s, {}), and {compared}.",
        others.len(),
        front.len(),
        names.join(", "),
        last.setting,
        figure(last.seconds),
        figure(last.error),
    ))
}

fn own(curve: &Curve) -> String {
    match curve.own_on_front() {
        [true, true] => "A method of this project's own is on the front by time and by counted work.".to_owned(),
        [true, false] => {
            format!("This project's own methods are on the front by time, but not by {}.", curve.operations)
        }
        [false, true] => {
            format!("This project's own methods are on the front by {}, but NOT by time.", curve.operations)
        }
        [false, false] => "NONE of this project's own methods is on the front.".to_owned(),
    }
}

/// Whether the conclusions hold by counted work, too.
fn measures(curve: &Curve) -> String {
    let disagreeing: Vec<String> = curve
        .budgets
        .iter()
        .filter(|b| b.method_by_seconds != b.method_by_operations)
        .map(|b| format!("{}: {} by time, {} by counted work", figure(b.error), b.by_seconds, b.by_operations))
        .collect();
    let pairs = &curve.agreement;
    let order = format!(
        "{} of {} pairs of settings have the other order by {} than by time",
        pairs.reversed.len(),
        pairs.pairs,
        curve.operations
    );
    if disagreeing.is_empty() {
        format!("Both measures choose the same method for every error; {order}.")
    } else {
        let (shown, more) = (disagreeing.len().min(3), disagreeing.len().saturating_sub(3));
        let rest = if more > 0 { format!(" and {more} more") } else { String::new() };
        format!("The measures choose differently for errors of {}{rest}; {order}.", disagreeing[..shown].join("; "))
    }
}

const STYLE: &str = "body{font:16px/1.45 sans-serif;max-width:64em;margin:2em auto;padding:0 1em}img{max-width:100%}\
table{border-collapse:collapse;font-size:14px}td,th{padding:.15em .7em;border-bottom:1px solid #ddd;text-align:left}pre{font-size:12px;overflow-x:auto}";

/// The page of conclusions.
pub(super) fn page(account: &Account) -> String {
    let kind = if account.quick { " (quick account)" } else { "" };
    let mut page = format!(
        "<!doctype html><html lang=\"en\"><head><meta charset=\"utf-8\"><title>What accuracy costs</title><style>{STYLE}</style></head><body>\n\
        <h1>What accuracy costs{kind}</h1>\n<p>{}. Times are medians over rounds in which settings take turns. All sentences are made from the figures.</p>\n",
        escaped(&account.program)
    );
    let mut family = "";
    for curve in &account.curves {
        if curve.family != family {
            family = &curve.family;
            page += &format!("<h2>{}</h2>\n", escaped(family));
        }
        page += &section(curve);
    }
    if !account.stability.is_empty() {
        page +=
            "<h2>stability at the extremes</h2>\n<p><img src=\"stability.png\" alt=\"Errors over the sweeps\"></p>\n";
        page += &format!("<pre>{}</pre>\n<ul>\n", escaped(&sweep_table(&account.stability).to_string()));
        for sweep in &account.stability {
            if let Some(domain) = &sweep.domain {
                let said = format!("{} ({}): {}", sweep.name, sweep.precision, domain.source);
                page += &format!("<li>{}</li>\n", escaped(&said));
            }
        }
        page += "</ul>\n";
    }
    page + "</body></html>\n"
}

fn section(curve: &Curve) -> String {
    let mut text = format!("<h3>{}: {}</h3>\n<ul>\n", escaped(&curve.name), escaped(&curve.title));
    for sentence in of_curve(curve) {
        text += &format!("<li>{}</li>\n", escaped(&sentence));
    }
    text += &format!("</ul>\n<p>Truth: {}. Rounds: {}.</p>\n", escaped(&curve.truth), curve.rounds);
    text += &format!("<p><img src=\"{0}.png\" alt=\"{0}\"></p>\n", escaped(&curve.name));
    text += &format!(
        "<table><tr><th>{} up to</th><th>take, for least time</th><th>s</th><th>for least work</th><th>{}</th></tr>\n",
        escaped(&curve.error),
        escaped(&curve.operations)
    );
    for b in &curve.budgets {
        text += &format!(
            "<tr><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td></tr>\n",
            figure(b.error),
            escaped(&b.by_seconds),
            figure(b.seconds),
            escaped(&b.by_operations),
            figure(b.operations)
        );
    }
    text + "</table>\n"
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}
