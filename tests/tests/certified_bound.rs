//! The certified colour bound against dense integration, for random expressions in both precisions.
#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "a test stops at the first thing that should not be, and prints what it counted"
)]

use spectral_core::Real;
use spectral_core::adaptive::Mode;
use spectral_tests::certify::{Tally, run};

/// Runs the cases and prints what was counted.
fn trial<R: Real>(seed: u64, cases: u64, mode: Mode) -> Tally {
    let tally = run::<R>(seed, cases, mode).unwrap();
    println!("{} in {mode:?}: {tally}", core::any::type_name::<R>());
    // Not for nothing: thresholds are met, some bounds are close to the truth, and few overflow.
    assert!(2 * tally.reached >= cases && 100 * tally.unbounded <= cases && tally.closest >= 0.5);
    tally
}

#[test]
fn holds_in_single_precision() {
    assert_eq!(trial::<f32>(1, 50_000, Mode::Certified).violations(), 0);
}

#[test]
fn holds_in_double_precision() {
    assert_eq!(trial::<f64>(2, 50_000, Mode::Certified).violations(), 0);
}

/// The same statements for 10⁷ expressions; `SPECTRAL_CASES` overrides the number for each precision.
#[test]
#[ignore = "long: 10⁷ cases"]
fn holds_for_ten_million_expressions() {
    let cases = std::env::var("SPECTRAL_CASES").map_or(5_000_000, |n| n.parse().unwrap());
    let single = trial::<f32>(0x5eed_0000_0001, cases, Mode::Certified).violations();
    let double = trial::<f64>(0x5eed_0000_0002, cases, Mode::Certified).violations();
    assert_eq!([single, double], [0, 0]);
}

/// Negative control: the same trial finds that the paper's error estimate is not a bound.
#[test]
fn is_broken_by_the_paper_mode() {
    for tally in [trial::<f32>(3, 2_000, Mode::Paper), trial::<f64>(4, 2_000, Mode::Paper)] {
        // Measured: about every fourth case; a hundredth of that would do.
        assert!(tally.failed("bound") >= 100, "{tally}");
        assert!(tally.failed("radius") >= 100, "{tally}");
    }
}
