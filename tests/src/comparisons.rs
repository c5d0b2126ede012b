//! Many comparisons of estimates with their expectations, judged together.

use crate::light_tracing::Estimate;
use crate::statistics::upper_gamma;

/// The probability that one of a test's comparisons fails by chance.
pub const SIGNIFICANCE: f64 = 0.01;

/// Collects comparisons, then judges all of them together: z-tests with Šidák's correction.
#[derive(Debug, Default)]
pub struct Comparisons(Vec<Comparison>);

#[derive(Debug)]
struct Comparison {
    text: String,
    z: f64,
    /// The standard error relative to what is expected.
    noise: f64,
}

impl Comparisons {
    /// An estimate and its expectation, which is known to `tolerance`.
    ///
    /// # Panics
    /// If the estimate isn't finite.
    #[track_caller]
    pub fn add(&mut self, name: impl ToString, found: Estimate, expected: f64, tolerance: f64) {
        let name = name.to_string();
        assert!(found.mean.is_finite() && found.error.is_finite(), "{name}: {found:?}");
        let z = found.z(expected, tolerance);
        let text = format!("{name}: {found:?}, expected {expected}, z = {z:.2}");
        self.0.push(Comparison { text, z, noise: found.error / expected.abs() });
    }

    /// How many there are.
    #[must_use]
    pub fn count(&self) -> usize {
        self.0.len()
    }

    /// Every comparison must pass, and none may be so noisy that it says nothing: a standard error of more than `noise` is refused.
    ///
    /// # Panics
    /// If one doesn't, or there is none.
    #[track_caller]
    #[allow(clippy::cast_precision_loss, reason = "counts are small")]
    pub fn judge(&self, noise: f64) {
        assert!(!self.0.is_empty());
        let least = 1.0 - (1.0 - SIGNIFICANCE).powf(1.0 / self.0.len() as f64);
        for Comparison { text, z, noise: error } in &self.0 {
            let p = upper_gamma(0.5, z * z / 2.0);
            assert!(p >= least, "{text}: p = {p:.2e}, less than {least:.2e}");
            assert!(*error <= noise, "{text}: standard error of {error}");
        }
    }
}
