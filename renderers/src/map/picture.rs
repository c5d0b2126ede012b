//! How maps are drawn and written.

use std::path::Path;

use super::{Map, Of, Quantity};
use crate::image::{FalseColour, ImageError, Palette, ScalarMap, Scale, ticks, write_exr_channels};

/// How maps are drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Style {
    /// The numbers at the ends of the palette; `None`: around those of 99 % of the pixels.
    pub range: Option<[f64; 2]>,
    /// How numbers are laid between them.
    pub scale: Scale,
    /// Whether lines of equal value are left out.
    pub plain: bool,
}

impl Map {
    /// Writes the map as a PNG in false colour: heading with the unit, legend, lines of equal value with their numbers, and the least, the
    /// mean and the largest value. Where there is no value it is light grey.
    ///
    /// # Errors
    /// [`ImageError::Range`] of a range that isn't one for the scale; [`ImageError::Io`].
    pub fn write_png(&self, path: &Path, style: &Style) -> Result<(), ImageError> {
        let title = self.title();
        let caption = self.caption();
        let [low, high] = self.range(style);
        let palette = if self.quantity == Quantity::Duv { Palette::CoolWarm } else { Palette::Cividis };
        let drawing = FalseColour {
            scale: style.scale,
            palette,
            missing: Some("no value"),
            contours: !style.plain,
            parts: self.surfaces.as_deref(),
            caption: &caption,
            text: text_height(&self.values),
            ..FalseColour::new(&title, low, high)
        };
        drawing.write_png(path, &self.values)
    }

    /// The quantity with its unit, and what it is measured of where there is a choice.
    fn title(&self) -> String {
        let unit = match self.quantity.unit(self.of) {
            "" => String::new(),
            unit => format!(" ({unit})"),
        };
        let of = match (self.quantity.is_luminous(), self.of) {
            (true, _) => "",
            (false, Of::Irradiance) => ", light on surfaces",
            (false, Of::Radiance) => ", light to the camera",
        };
        format!("{}{unit}{of}", self.quantity.title())
    }

    /// The least, the mean and the largest value, and how many pixels have none.
    fn caption(&self) -> String {
        let found = &self.statistics;
        if found.without_value == found.pixels {
            return "no pixel has a value".to_owned();
        }
        let number = |value: f64| format_number(value, found.min.abs().max(found.max.abs()));
        let [min, mean, max] = [found.min, found.mean, found.max].map(number);
        let rest = match found.share_without_value() {
            0.0 => String::new(),
            share => format!("    no value {:.1} %", 100.0 * share),
        };
        format!("min {min}    mean {mean}    max {max}{rest}")
    }

    /// The ends of the palette.
    fn range(&self, style: &Style) -> [f64; 2] {
        if let Some(range) = style.range {
            return range;
        }
        let [low, high] = self.usual_range().unwrap_or([0.0, 1.0]);
        if self.quantity == Quantity::Duv {
            // Neutral on the locus.
            let limit = low.abs().max(high.abs()).max(1e-4);
            return rounded([-limit, limit]);
        }
        if style.scale == Scale::Logarithmic {
            // Dark corners would take most of it.
            let low = low.max(1e-4 * high);
            return if low > 0.0 && low < high { [low, high] } else { [0.5 * high.max(1e-30), 2.0 * high.max(1e-30)] };
        }
        // What is the same everywhere isn't made to look uneven.
        let least = 1e-3 * low.abs().max(high.abs()).max(1e-30);
        if high - low < least {
            let middle = 0.5 * (low + high);
            return [middle - least, middle + least];
        }
        rounded([low, high])
    }
}

/// A range with round ends that are not far from given ones.
fn rounded([low, high]: [f64; 2]) -> [f64; 2] {
    let marks = ticks(Scale::Linear, low - (high - low), high + (high - low), 30);
    let below = marks.iter().rev().find(|mark| mark.value <= low);
    let above = marks.iter().find(|mark| mark.value >= high);
    [below.map_or(low, |mark| mark.value), above.map_or(high, |mark| mark.value)]
}

/// Four significant digits of the largest number of a map.
fn format_number(value: f64, largest: f64) -> String {
    if !(1e-3..1e6).contains(&largest) {
        return format!("{value:.3e}");
    }
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "from 0 to 6")]
    let digits = (3.0 - largest.log10().floor()).clamp(0.0, 6.0) as usize;
    format!("{value:.digits$}")
}

/// Letters that can be read when the picture is half as large.
#[allow(clippy::cast_precision_loss, reason = "a picture's side")]
fn text_height(map: &ScalarMap) -> f32 {
    (map.width().max(map.height()) as f32 / 36.0).clamp(10.0, 40.0)
}

/// Writes the values of some maps as `OpenEXR`, each under its quantity's name; NaN where there is none.
///
/// # Errors
/// [`ImageError::Io`]; [`ImageError::Name`] if a quantity is there twice.
pub fn write_values(path: &Path, maps: &[Map]) -> Result<(), ImageError> {
    let channels: Vec<(&str, &ScalarMap)> = maps.iter().map(|map| (map.quantity.name(), &map.values)).collect();
    let units: Vec<_> = maps
        .iter()
        .map(|map| (format!("unit.{}", map.quantity), format!("{} {}", map.quantity.unit(map.of), map.of)))
        .collect();
    let units: Vec<_> = units.iter().map(|(name, unit)| (name.as_str(), unit.trim_start())).collect();
    write_exr_channels(path, &channels, &units)
}
