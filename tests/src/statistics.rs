//! Statistics for the tests of samplers: a seeded generator and Pearson's chi-square test.

use core::fmt;

/// Cells expected to get fewer samples than this are pooled, as the chi-square approximation needs.
const MIN_EXPECTED: f64 = 5.0;

/// A small pseudo-random generator (Steele, Lea & Flood 2014, SplitMix64), for reproducible test input.
#[derive(Clone, Debug)]
pub struct Rng(u64);

impl Rng {
    /// The generator with this seed.
    #[must_use]
    pub const fn new(seed: u64) -> Self {
        Self(seed)
    }

    /// The next 64 random bits.
    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let x = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        x ^ (x >> 31)
    }

    /// Uniform in [0, 1), a multiple of 2⁻⁵³.
    #[allow(clippy::cast_precision_loss, reason = "53 bits fit")]
    pub fn unit(&mut self) -> f64 {
        (self.bits() >> 11) as f64 * (f64::EPSILON / 2.0)
    }

    /// Uniform in [0, 1), a multiple of 2⁻²⁴.
    #[allow(clippy::cast_precision_loss, reason = "24 bits fit")]
    pub fn unit_f32(&mut self) -> f32 {
        (self.bits() >> 40) as f32 * (f32::EPSILON / 2.0)
    }

    /// A unit vector, uniform on the sphere.
    pub fn direction(&mut self) -> [f64; 3] {
        let z = 2.0 * self.unit() - 1.0;
        let (sin, cos) = (core::f64::consts::TAU * self.unit()).sin_cos();
        let r = (1.0 - z * z).max(0.0).sqrt();
        [r * cos, r * sin, z]
    }
}

/// The outcome of a chi-square test.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ChiSquare {
    /// Pearson's statistic.
    pub statistic: f64,
    /// Degrees of freedom: cells after pooling, less one.
    pub degrees: usize,
    /// The probability of a statistic at least this large if the samples follow the expectation; 0 where samples fell
    /// in a cell that can have none.
    pub p_value: f64,
}

impl ChiSquare {
    /// Compares counts with expected counts of the same sum (to 1 %; otherwise the p-value is 0). Cells with less than
    /// five expected samples are pooled.
    #[must_use]
    pub fn new(observed: &[u64], expected: &[f64]) -> Self {
        let impossible = observed.iter().zip(expected).any(|(o, e)| *e <= 0.0 && *o > 0);
        let (mut statistic, mut cells, mut pooled) = (0.0, 0_usize, (0.0, 0.0));
        let mut add = |o: f64, e: f64| {
            statistic += (o - e).powi(2) / e;
            cells += 1;
        };
        for (o, e) in observed.iter().zip(expected).map(|(o, e)| (to_f64(*o), *e)) {
            if e >= MIN_EXPECTED {
                add(o, e);
            } else {
                pooled = (pooled.0 + o, pooled.1 + e);
            }
        }
        if pooled.1 >= MIN_EXPECTED {
            add(pooled.0, pooled.1);
        }
        let degrees = cells.saturating_sub(1);
        let total = to_f64(observed.iter().sum());
        let same_sum = (total - expected.iter().sum::<f64>()).abs() <= 0.01 * total;
        let usable = observed.len() == expected.len() && same_sum && !impossible && degrees > 0;
        let p_value = if usable { upper_gamma(to_f64(degrees as u64) / 2.0, statistic / 2.0) } else { 0.0 };
        Self { statistic, degrees, p_value }
    }

    /// Whether the samples may follow the expectation, when this is one of `tests` independent tests that together
    /// should fail by chance with probability `significance` (Šidák's correction).
    #[must_use]
    pub fn accepts(&self, significance: f64, tests: u32) -> bool {
        self.p_value >= 1.0 - (1.0 - significance).powf(1.0 / f64::from(tests))
    }
}

impl fmt::Display for ChiSquare {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "χ² = {:.1} with {} degrees of freedom, p = {:.3e}", self.statistic, self.degrees, self.p_value)
    }
}

#[allow(clippy::cast_precision_loss, reason = "counts of samples are far below 2⁵³")]
fn to_f64(count: u64) -> f64 {
    count as f64
}

/// The regularised upper incomplete gamma function Q(a, x) for a > 0, x ≥ 0, to about 10⁻¹² relative: the power series
/// below x = a + 1, Lentz's continued fraction above (Abramowitz & Stegun 6.5.29, 6.5.31).
#[must_use]
pub fn upper_gamma(a: f64, x: f64) -> f64 {
    if x <= 0.0 {
        return 1.0;
    }
    let scale = (a * x.ln() - x - ln_gamma(a)).exp();
    if x < a + 1.0 { 1.0 - scale * lower_series(a, x) } else { scale * upper_fraction(a, x) }
}

fn lower_series(a: f64, x: f64) -> f64 {
    let (mut term, mut sum, mut n) = (1.0 / a, 1.0 / a, a);
    while term > sum * f64::EPSILON {
        n += 1.0;
        term *= x / n;
        sum += term;
    }
    sum
}

fn upper_fraction(a: f64, x: f64) -> f64 {
    const TINY: f64 = 1e-300;
    let (mut b, mut c) = (x + 1.0 - a, 1.0 / TINY);
    let mut d = 1.0 / b;
    let mut h = d;
    for i in 1..100_000_u32 {
        let i = f64::from(i);
        let numerator = i * (a - i);
        b += 2.0;
        d = 1.0 / nonzero(numerator * d + b, TINY);
        c = nonzero(b + numerator / c, TINY);
        h *= d * c;
        if (d * c - 1.0).abs() <= f64::EPSILON {
            break;
        }
    }
    h
}

fn nonzero(x: f64, tiny: f64) -> f64 {
    if x.abs() < tiny { tiny } else { x }
}

/// ln Γ(x) for x > 0, by Stirling's series (Abramowitz & Stegun 6.1.41) after shifting x above 20; absolute error about
/// 10⁻¹⁴·|result|.
#[must_use]
pub fn ln_gamma(mut x: f64) -> f64 {
    let mut shift = 1.0;
    let mut log_shift = 0.0;
    while x < 20.0 {
        shift *= x;
        x += 1.0;
    }
    log_shift -= f64::ln(shift);
    let y = 1.0 / (x * x);
    let series = (1.0 / 12.0 - y * (1.0 / 360.0 - y * (1.0 / 1260.0 - y * (1.0 / 1680.0)))) / x;
    log_shift + (x - 0.5) * x.ln() - x + 0.5 * core::f64::consts::TAU.ln() + series
}

#[cfg(test)]
mod tests {
    use super::{ChiSquare, Rng, ln_gamma, upper_gamma};

    #[test]
    fn ln_gamma_matches_factorials_and_the_half_integers() {
        let mut factorial = 1.0_f64;
        for n in 1..30_u32 {
            assert!((ln_gamma(f64::from(n)) - factorial.ln()).abs() <= 1e-13 * (1.0 + factorial.ln()));
            factorial *= f64::from(n);
        }
        assert!((ln_gamma(0.5) - core::f64::consts::PI.sqrt().ln()).abs() <= 1e-14);
    }

    /// Published: critical values of the chi-square distribution (Abramowitz & Stegun, table 26.8).
    #[test]
    fn the_p_value_matches_published_critical_values() {
        for (degrees, critical, p) in [
            (1.0, 3.841_46, 0.05),
            (2.0, 9.210_34, 0.01),
            (5.0, 20.515_0, 0.001),
            (10.0, 2.558_21, 0.99),
            (30.0, 50.892_2, 0.01),
            (100.0, 124.342, 0.05),
        ] {
            let computed = upper_gamma(degrees / 2.0, critical / 2.0);
            assert!((computed / p - 1.0).abs() <= 1e-4, "{degrees}: {computed}");
        }
    }

    /// Independent: Q(1, x) = exp(−x), on both sides of the switch between series and fraction.
    #[test]
    fn the_p_value_matches_the_exponential() {
        for x in [0.1, 1.0, 1.9, 2.1, 10.0, 100.0] {
            assert!((upper_gamma(1.0, x) / f64::exp(-x) - 1.0).abs() <= 1e-12);
        }
    }

    #[test]
    fn uniform_samples_pass_and_skewed_ones_fail() {
        let mut rng = Rng::new(1);
        let (mut fair, mut skewed) = ([0_u64; 50], [0_u64; 50]);
        for _ in 0..100_000 {
            let x = rng.unit();
            let cell = |x: f64| (0..49_u8).filter(|i| x >= f64::from(i + 1) / 50.0).count();
            fair[cell(x)] += 1;
            skewed[cell(x.powf(1.05))] += 1;
        }
        let expected = [2_000.0; 50];
        assert!(ChiSquare::new(&fair, &expected).accepts(0.01, 1));
        assert!(!ChiSquare::new(&skewed, &expected).accepts(0.01, 1000));
    }

    #[test]
    fn impossible_samples_and_wrong_totals_are_rejected() {
        assert!(!ChiSquare::new(&[50, 50, 1], &[50.0, 50.0, 0.0]).accepts(0.01, 1));
        assert!(!ChiSquare::new(&[50, 50], &[60.0, 60.0]).accepts(0.01, 1));
        assert!(ChiSquare::new(&[50, 50], &[50.0, 50.0]).accepts(0.01, 1));
    }
}
