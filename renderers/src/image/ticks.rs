//! Round numbers along a scale.

use super::ImageError;

/// How numbers are laid along an axis.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Scale {
    /// Equal differences have equal lengths.
    #[default]
    Linear,
    /// Equal ratios have equal lengths; both ends must be positive.
    Logarithmic,
}

impl Scale {
    /// Where `value` lies between `low` (0) and `high` (1); outside [0, 1] beyond them.
    ///
    /// On a logarithmic scale numbers that are not positive are at −∞. NaN gives NaN.
    #[must_use]
    pub fn fraction(self, value: f64, low: f64, high: f64) -> f64 {
        match self {
            Self::Linear => (value - low) / (high - low),
            Self::Logarithmic if value <= 0.0 => f64::NEG_INFINITY,
            Self::Logarithmic => (value / low).ln() / (high / low).ln(),
        }
    }

    /// The value at a fraction of the way from `low` to `high`: the inverse of [`Scale::fraction`].
    #[must_use]
    pub fn value(self, fraction: f64, low: f64, high: f64) -> f64 {
        match self {
            Self::Linear => low + fraction * (high - low),
            Self::Logarithmic => low * (high / low).powf(fraction),
        }
    }

    /// Refuses limits that no such scale can have.
    pub(crate) fn check(self, low: f64, high: f64) -> Result<(), ImageError> {
        let positive = self == Self::Linear || low > 0.0;
        if low < high && (high - low).is_finite() && positive { Ok(()) } else { Err(ImageError::Range { low, high }) }
    }
}

/// A mark on an axis.
#[derive(Clone, Debug, PartialEq)]
pub struct Tick {
    /// The number that it marks.
    pub value: f64,
    /// The number as text, with the digits that tell it from its neighbours.
    pub label: String,
}

/// Round numbers from `low` to `high`, about `count` of them (at most twice as many on a linear scale).
///
/// Linear: multiples of 1, 2 or 5 times a power of ten. Logarithmic: powers of ten, with their 2- and 5-fold if they
/// alone would be few; over less than a factor of ten, as linear. Empty if the limits are not finite and increasing.
#[must_use]
pub fn ticks(scale: Scale, low: f64, high: f64, count: usize) -> Vec<Tick> {
    if scale.check(low, high).is_err() {
        return Vec::new();
    }
    match scale {
        Scale::Logarithmic if high / low >= 10.0 => logarithmic(low, high, count),
        _ => linear(low, high, count),
    }
}

fn linear(low: f64, high: f64, count: usize) -> Vec<Tick> {
    #[allow(clippy::cast_precision_loss, reason = "a small count")]
    let (step, decade) = round_step((high - low) / count.max(1) as f64);
    let slack = 1e-9 * step;
    let first = ((low - slack) / step).ceil();
    (0..=2 * count + 2)
        .map(|k| {
            #[allow(clippy::cast_precision_loss, reason = "a small count")]
            let multiple = first + k as f64;
            multiple * step
        })
        .take_while(|&value| value <= high + slack)
        .map(|value| Tick { value, label: label(value, decade, low.abs().max(high.abs())) })
        .collect()
}

/// The least of 1, 2, 5 times a power of ten that is not below `step`, and the power's exponent.
fn round_step(step: f64) -> (f64, i32) {
    #[allow(clippy::cast_possible_truncation, reason = "an exponent of f64 is below 400")]
    let decade = step.log10().floor() as i32;
    for factor in [1.0, 2.0, 5.0] {
        let rounded = factor * 10.0_f64.powi(decade);
        if rounded >= step * (1.0 - 1e-9) {
            return (rounded, decade);
        }
    }
    (10.0_f64.powi(decade + 1), decade + 1)
}

/// A number rounded to the given decade, in scientific notation where plain digits would be long.
fn label(value: f64, decade: i32, largest: f64) -> String {
    let decimals = usize::try_from(-decade).unwrap_or(0);
    // Zero has no sign, and a multiple of the step that rounds to it is zero.
    let value = if value.abs() < 0.5 * 10.0_f64.powi(decade) { 0.0 } else { value };
    match (decimals > 4 || largest >= 1e6, value == 0.0) {
        (false, _) => format!("{value:.decimals$}"),
        (true, true) => "0".to_owned(),
        (true, false) => {
            let digits = usize::try_from(exponent(value) - decade).unwrap_or(0);
            format!("{value:.digits$e}")
        }
    }
}

#[allow(clippy::cast_possible_truncation, reason = "an exponent of f64 is below 400")]
fn exponent(value: f64) -> i32 {
    (value.abs().log10() + 1e-9).floor() as i32
}

fn logarithmic(low: f64, high: f64, count: usize) -> Vec<Tick> {
    let (first, last) = (exponent(low), exponent(high));
    let decades = usize::try_from(last - first).unwrap_or(0) + 1;
    let factors: &[f64] = if 2 * decades <= count { &[1.0, 2.0, 5.0] } else { &[1.0] };
    let stride = decades.div_ceil(count.max(1));
    (first..=last)
        .step_by(stride)
        .flat_map(|decade| factors.iter().map(move |factor| (factor * 10.0_f64.powi(decade), decade)))
        .filter(|&(value, _)| value >= low * (1.0 - 1e-9) && value <= high * (1.0 + 1e-9))
        .map(|(value, decade)| Tick { value, label: label(value, decade, value) })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(scale: Scale, low: f64, high: f64, count: usize) -> Vec<String> {
        ticks(scale, low, high, count).into_iter().map(|tick| tick.label).collect()
    }

    #[test]
    fn linear_ticks_are_round() {
        assert_eq!(labels(Scale::Linear, 0.0, 1.0, 5), ["0.0", "0.2", "0.4", "0.6", "0.8", "1.0"]);
        assert_eq!(labels(Scale::Linear, -3.0, 11.0, 4), ["0", "5", "10"]);
        assert_eq!(labels(Scale::Linear, -0.03, 0.03, 3), ["-0.02", "0.00", "0.02"]);
        assert_eq!(labels(Scale::Linear, 0.0, 3e-7, 3), ["0", "1e-7", "2e-7", "3e-7"]);
        assert_eq!(labels(Scale::Linear, 0.0, 2e7, 4), ["0", "5e6", "1.0e7", "1.5e7", "2.0e7"]);
    }

    #[test]
    fn logarithmic_ticks_are_powers_of_ten() {
        assert_eq!(labels(Scale::Logarithmic, 0.5, 200.0, 4), ["1", "10", "100"]);
        assert_eq!(labels(Scale::Logarithmic, 1.0, 100.0, 8), ["1", "2", "5", "10", "20", "50", "100"]);
        assert_eq!(labels(Scale::Logarithmic, 1e-8, 1e-2, 3), ["1e-8", "1e-5", "0.01"]);
        assert_eq!(labels(Scale::Logarithmic, 2.0, 8.0, 3), ["2", "4", "6", "8"]);
    }

    #[test]
    fn impossible_scales_have_no_ticks() {
        for (low, high) in [(1.0, 1.0), (2.0, 1.0), (f64::NAN, 1.0), (0.0, f64::INFINITY), (-f64::MAX, f64::MAX)] {
            assert!(ticks(Scale::Linear, low, high, 5).is_empty());
        }
        assert!(ticks(Scale::Logarithmic, 0.0, 1.0, 5).is_empty());
        assert!(ticks(Scale::Logarithmic, -1.0, 1.0, 5).is_empty());
    }

    #[test]
    fn every_scale_gets_ticks_within_it() {
        for scale in [Scale::Linear, Scale::Logarithmic] {
            for low in [1e-300, 1e-5, 0.3, 7.0, 1e200] {
                for ratio in [1.1, 3.0, 40.0, 1e9] {
                    let (low, high) = (low, low * ratio);
                    let marks = ticks(scale, low, high, 5);
                    assert!((1..=12).contains(&marks.len()), "{scale:?} {low:e} {high:e}: {marks:?}");
                    for tick in marks {
                        let fraction = scale.fraction(tick.value, low, high);
                        assert!((-1e-6..=1.0 + 1e-6).contains(&fraction));
                    }
                }
            }
        }
    }

    #[test]
    fn fraction_and_value_are_inverse() {
        for scale in [Scale::Linear, Scale::Logarithmic] {
            for fraction in [-0.5, 0.0, 0.25, 1.0, 1.5] {
                let back = scale.fraction(scale.value(fraction, 0.2, 70.0), 0.2, 70.0);
                assert!((back - fraction).abs() <= 1e-14);
            }
        }
        assert_eq!(Scale::Logarithmic.fraction(0.0, 1.0, 2.0), f64::NEG_INFINITY);
        assert!(Scale::Logarithmic.fraction(f64::NAN, 1.0, 2.0).is_nan());
    }
}
