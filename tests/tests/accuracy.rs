//! The accuracy table: every public numeric function is measured, every figure is within its tolerance, and the committed table is current.
#![allow(clippy::unwrap_used, reason = "the input is constant")]

extern crate alloc;

use alloc::collections::BTreeSet;
use std::path::Path;
use std::sync::LazyLock;

use spectral_tests::accuracy::gauge::{Axis, Choice, Gauge, Unit};
use spectral_tests::accuracy::table::{ENTRIES, EXEMPT, Reason};
use spectral_tests::accuracy::wide::{Wide, wide};
use spectral_tests::accuracy::{Measured, measure, report, scan};

static MEASURED: LazyLock<Vec<Measured>> = LazyLock::new(|| measure(""));

#[test]
fn errors_are_within_their_tolerances_and_tolerances_near_the_errors() {
    let complaints: Vec<_> = MEASURED.iter().flat_map(Measured::complaints).collect();
    assert!(complaints.is_empty(), "\n{}", complaints.join("\n"));
}

#[test]
fn the_committed_table_is_current() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(report::PATH);
    let committed = std::fs::read_to_string(path).unwrap();
    let current = report::markdown(&MEASURED).unwrap();
    for (committed, current) in committed.lines().zip(current.lines()) {
        assert_eq!(committed, current, "write it anew: cargo run --release -p spectral-tests --bin accuracy_table");
    }
    assert_eq!(committed.len(), current.len());
}

#[test]
fn every_public_function_is_measured_or_exempt() {
    let functions = scan::public_functions().unwrap();
    assert!(functions.len() > 300, "{} functions: the scan has missed some", functions.len());
    let mut listed = BTreeSet::new();
    let exempt = EXEMPT.iter().flat_map(|(_, names)| names.iter().copied());
    for name in ENTRIES.iter().map(|entry| entry.name).chain(exempt) {
        assert!(functions.contains_key(name), "there is no public function {name}");
        assert!(listed.insert(name), "{name} is listed twice");
    }
    let missing = scan::unlisted().unwrap();
    assert!(missing.is_empty(), "neither measured nor exempt: {missing:#?}");
    for (reason, names) in EXEMPT {
        assert!(!names.is_empty());
        if let Reason::By(name) = reason {
            assert!(ENTRIES.iter().any(|entry| entry.name == *name), "{name} is to stand for {names:?}");
        }
    }
}

/// Against mpmath: tests/peers/elementary_reference.py.
#[test]
fn the_oracles_arithmetic_has_thirty_digits() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("data/elementary.csv");
    let text = std::fs::read_to_string(path).unwrap();
    let mut rows = 0;
    for line in text.lines().filter(|line| !line.starts_with('#') && !line.starts_with("function")) {
        let cells: Vec<_> = line.split(',').collect();
        let [x, y, high, low] = [1, 2, 3, 4].map(|i| cells[i].parse::<f64>().unwrap());
        let (a, b) = (Wide::from(x), Wide::from(y));
        let got = match cells[0] {
            "sqrt" => a.sqrt(),
            "cbrt" => a.cbrt(),
            "exp" => a.exp(),
            "exp_m1" => a.exp_m1(),
            "ln" => a.ln(),
            "sin" => a.sin(),
            "cos" => a.cos(),
            "tan" => a.tan(),
            "asin" => a.asin(),
            "acos" => a.acos(),
            "atan" => a.atan(),
            "atan2" => a.atan2(b),
            "hypot" => a.hypot(b),
            "powf" => a.powf(b),
            other => unreachable!("{other}"),
        };
        let error = ((got - high) - low).abs().to_f64();
        // Arguments of exp up to 300 cost two digits and a half, those of sine and cosine near multiples of π/2 some, too.
        assert!(error <= 2e-29 * high.abs() + 1e-31, "{line}: off by {error:e}");
        rows += 1;
    }
    assert!(rows >= 200, "{rows}");
    assert!(((Wide::decimal("-12.5e-3") * 80.0) + 1.0).to_f64().abs() <= 1e-31);
}

/// A function that is wrong by a known amount in one place is found out, there.
#[test]
fn gauges_find_what_is_wrong() {
    let measured = |unit, function: &dyn Fn(f64) -> f64| {
        let mut gauge = Gauge::new(unit, 1);
        let axis = Axis::linear("x", 1.0, 4.0).edges(&[2.0]);
        gauge.each(&[axis], |gauge, [x]: [f64; 1]| gauge.compare(function(x), wide(x)));
        gauge.found()
    };
    assert!(measured(Unit::Ulp, &|x| x).worst == 0.0);
    let off = measured(Unit::Ulp, &|x| if x == 2.0_f64.next_down() { x.next_down().next_down() } else { x });
    assert!(off.worst == 2.0 && off.choice == Choice::Edge && off.point == [2.0_f64.next_down()], "{off:?}");
    assert!(measured(Unit::Ulp, &|x| if x > 3.9 { f64::NAN } else { x }).worst.is_infinite());
    let relative = measured(Unit::Relative, &|x| x * 1.25).worst;
    assert!((relative - 0.25).abs() <= 1e-12, "{relative}");
}
