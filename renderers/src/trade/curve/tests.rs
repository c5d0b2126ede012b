//! Curves by hand: what the floor of truth, ties, spreads of time and numbers that are none make of them.

use super::{Agreement, Curve, Point};
use crate::trade::conclusions::of_curve;
use crate::trade::plan::{Run, mean_and_worst, rms_and_worst};
use crate::trade::store::Record;

fn point(setting: &str, own: bool, seconds: f64, operations: f64, error: f64) -> Point {
    Point {
        setting: setting.to_owned(),
        method: if own { "own" } else { "simple" }.to_owned(),
        own,
        seconds,
        seconds_spread: [0.9 * seconds, 1.1 * seconds],
        operations,
        error,
        worst: error,
        front_seconds: false,
        front_operations: false,
    }
}

fn judged(floor: f64, points: Vec<Point>) -> Curve {
    let mut curve = Curve {
        name: "family.task".to_owned(),
        family: "family".to_owned(),
        title: "a task".to_owned(),
        error: "an error".to_owned(),
        operations: "steps".to_owned(),
        truth: "known".to_owned(),
        floor,
        rounds: 1,
        points,
        agreement: Agreement::default(),
        budgets: Vec::new(),
    };
    curve.judge();
    curve
}

fn settings<'a>(front: &[&'a Point]) -> Vec<&'a str> {
    front.iter().map(|point| point.setting.as_str()).collect()
}

/// Below what truth is sure of, nobody is more accurate: the cheaper one is alone on the front, and no budget asks for less.
#[test]
fn errors_below_the_floor_count_as_none() {
    let points = || {
        vec![
            point("coarse", true, 1.0, 1.0, 1e-2),
            point("near", true, 2.0, 2.0, 3e-9),
            point("nearer", true, 3.0, 3.0, 1e-12),
        ]
    };
    let curve = judged(1e-8, points());
    assert_eq!(settings(&curve.front(true)), ["coarse", "near"]);
    assert_eq!(settings(&curve.front(false)), ["coarse", "near"]);
    assert!(!curve.budgets.is_empty() && curve.budgets.iter().all(|budget| budget.error >= 1e-8));
    assert!(curve.budgets.iter().all(|budget| budget.by_seconds != "nearer"));
    let without = judged(0.0, points());
    assert_eq!(settings(&without.front(true)), ["coarse", "near", "nearer"]);
    assert!(without.budgets.iter().any(|budget| budget.by_seconds == "nearer"));
}

/// Of settings of equal work, the one that takes less time is named.
#[test]
fn time_breaks_ties_of_counted_work() {
    let curve = judged(
        0.0,
        vec![
            point("rough", true, 0.5, 1.0, 1.0),
            point("slow", true, 3.0, 8.0, 1e-3),
            point("fast", false, 2.0, 8.0, 1e-3),
        ],
    );
    let finest = curve.budgets.last().expect("errors of less than 1 are kept");
    assert_eq!((finest.by_seconds.as_str(), finest.by_operations.as_str()), ("fast", "fast"));
}

/// Times that overlap order nothing; of those apart, the pairs that counted work orders the other way are listed.
#[test]
fn only_times_apart_are_compared() {
    let curve = judged(
        0.0,
        vec![point("a", true, 1.0, 5.0, 1.0), point("b", true, 1.1, 4.0, 0.5), point("c", true, 9.0, 4.5, 0.1)],
    );
    assert_eq!(curve.agreement.pairs, 2);
    assert_eq!(curve.agreement.reversed, [["a", "c"]]);
}

/// A simpler method whose error is below the floor is met by an own one whose error is, too.
#[test]
fn conclusions_compare_what_the_floor_makes_equal() {
    let points = vec![point("plain", false, 1.0, 1.0, 1e-12), point("bound", true, 4.0, 4.0, 1e-10)];
    let said = of_curve(&judged(1e-8, points.clone())).join(" ");
    assert!(said.contains("this project's own takes 4.0 times as long for that"), "{said}");
    let said = of_curve(&judged(0.0, points)).join(" ");
    assert!(said.contains("nothing of this project's own is as accurate"), "{said}");
}

/// A number that is none is as wrong as can be, wherever it comes, and what is kept of it is the largest number.
#[test]
fn what_is_no_number_is_not_forgotten() {
    for errors in [[f64::NAN, 1.0, 2.0], [1.0, f64::NAN, 2.0], [1.0, 2.0, f64::NAN]] {
        for [mean, worst] in [mean_and_worst(errors), rms_and_worst(errors)] {
            assert!(mean.is_nan() && worst.is_nan(), "{errors:?}: {mean} {worst}");
        }
    }
    assert_eq!(rms_and_worst([3.0, -5.0, 4.0]), [(50.0_f64 / 3.0).sqrt(), 5.0]);
    let mut record = Record::new("key", vec![("setting".to_owned(), "own".to_owned(), true)]);
    let run = Run { seconds: 1.0, operations: 2.0, error: f64::NAN, worst: f64::INFINITY };
    record.add(vec![("setting".to_owned(), run)]);
    let text = serde_json::to_string(&record).expect("a record is plain data");
    let kept: Record = serde_json::from_str(&text).expect("it is read as it was written");
    assert_eq!(kept, record);
    let runs = kept.runs("setting");
    assert_eq!((runs.len(), runs[0].seconds, runs[0].error, runs[0].worst), (1, 1.0, f64::MAX, f64::MAX));
}
