//! A map in a few numbers.

use crate::image::ScalarMap;

/// What the pixels with a value have in common, and why others have none.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Statistics {
    /// The least value; NaN if there is none.
    pub min: f64,
    /// The largest one.
    pub max: f64,
    /// The mean over pixels.
    pub mean: f64,
    /// The median over pixels.
    pub median: f64,
    /// Pixels altogether.
    pub pixels: usize,
    /// Pixels without a value.
    pub without_value: usize,
    /// Those among them that see no surface.
    pub without_surface: usize,
    /// Those among them without light.
    pub without_light: usize,
}

impl Statistics {
    pub(super) fn new(map: &ScalarMap, [without_surface, without_light]: [usize; 2]) -> Self {
        let mut values: Vec<f32> = map.pixels().iter().copied().filter(|value| value.is_finite()).collect();
        values.sort_by(f32::total_cmp);
        let pixels = map.pixels().len();
        let without_value = pixels - values.len();
        let at = |index: usize| values.get(index).map_or(f64::NAN, |value| f64::from(*value));
        let count = values.len();
        #[allow(clippy::cast_precision_loss, reason = "a number of pixels")]
        let mean = values.iter().map(|value| f64::from(*value)).sum::<f64>() / count as f64;
        Self {
            min: at(0),
            max: at(count.wrapping_sub(1)),
            mean,
            median: 0.5 * (at(count.wrapping_sub(1) / 2) + at(count / 2)),
            pixels,
            without_value,
            without_surface: without_surface.min(without_value),
            without_light: without_light.min(without_value),
        }
    }

    /// The share of pixels without a value.
    #[must_use]
    #[allow(clippy::cast_precision_loss, reason = "a share of pixels")]
    pub fn share_without_value(&self) -> f64 {
        self.without_value as f64 / self.pixels.max(1) as f64
    }
}

/// The values at two quantiles from 0 to 1; `None` of a map without values.
pub(super) fn quantiles(map: &ScalarMap, shares: [f64; 2]) -> Option<[f64; 2]> {
    let mut values: Vec<f32> = map.pixels().iter().copied().filter(|value| value.is_finite()).collect();
    let last = values.len().checked_sub(1)?;
    #[allow(
        clippy::cast_precision_loss,
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "an index of a pixel"
    )]
    let places = shares.map(|share| (share.clamp(0.0, 1.0) * last as f64).round() as usize);
    Some(places.map(|place| f64::from(*values.select_nth_unstable_by(place.min(last), f32::total_cmp).1)))
}
