//! Gauss–Legendre rules.

use std::sync::LazyLock;

/// The largest rule.
pub(super) const MOST: usize = 24;

/// A Gauss–Legendre rule on [0, 1]: exact for polynomials of degree 2n − 1.
#[derive(Debug)]
pub(super) struct Rule {
    /// Pairs of a node and its weight; the weights add up to 1.
    pub(super) points: Vec<(f64, f64)>,
}

static RULES: LazyLock<Vec<Rule>> = LazyLock::new(|| (1..=MOST).map(Rule::new).collect());

/// The rule with `count` nodes, clamped to 1 … [`MOST`].
pub(super) fn rule(count: usize) -> &'static Rule {
    &RULES[count.clamp(1, MOST) - 1]
}

/// How many nodes integrate over a stretch, to a relative error `tolerance`, a function that is analytic but for points whose ellipse
/// about the stretch has the sum of half axes `ellipse` (> 1), in units of half its length: the error falls as `ellipse`^−2n.
#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "clamped to a small positive number")]
pub(super) fn nodes_for(ellipse: f64, tolerance: f64) -> usize {
    let count = -tolerance.ln() / (2.0 * ellipse.max(1.0).ln());
    if count <= 1000.0 { count.ceil().max(1.0) as usize } else { 1000 }
}

impl Rule {
    #[allow(clippy::cast_precision_loss, reason = "small numbers")]
    fn new(count: usize) -> Self {
        let n = count as f64;
        let point = |i: usize| {
            // Tricomi's first guess, then Newton's iteration.
            let mut x = ((i as f64 + 0.75) / (n + 0.5) * core::f64::consts::PI).cos();
            let mut slope = 1.0;
            for _ in 0..8 {
                let (value, derivative) = legendre(count, x);
                x -= value / derivative;
                slope = derivative;
            }
            ((1.0 - x) / 2.0, 1.0 / ((1.0 - x * x) * slope * slope))
        };
        Self { points: (0..count).map(point).collect() }
    }
}

/// The Legendre polynomial of a degree (at least 1) and its derivative.
#[allow(clippy::cast_precision_loss, reason = "small numbers")]
fn legendre(degree: usize, x: f64) -> (f64, f64) {
    let (mut before, mut value) = (1.0, x);
    for k in 2..=degree {
        let k = k as f64;
        (before, value) = (value, ((2.0 * k - 1.0) * x * value - (k - 1.0) * before) / k);
    }
    let n = degree as f64;
    (value, n * (before - x * value) / (1.0 - x * x))
}

#[cfg(test)]
mod tests {
    use super::{MOST, rule};

    #[test]
    fn integrates_polynomials_of_its_degree() {
        for count in 1..=MOST {
            for degree in [0, 1, count, 2 * count - 1] {
                let power = i32::try_from(degree).unwrap();
                let sum: f64 = rule(count).points.iter().map(|(x, w)| w * x.powi(power)).sum();
                let exact = 1.0 / f64::from(power + 1);
                assert!((sum - exact).abs() <= 1e-14, "{count} {degree}: {sum} {exact}");
            }
        }
    }
}
