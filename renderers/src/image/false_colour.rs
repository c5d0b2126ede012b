//! Maps of numbers drawn in false colour, with a legend.

use super::{Anchor, Canvas, ImageError, Palette, Rgb8, ScalarMap, Scale, Tick, ticks};
use std::path::Path;

/// How a palette is divided.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Levels {
    /// Colours change without steps.
    #[default]
    Continuous,
    /// So many colours, each for an equal part of the scale; 16 can still be told apart in the legend.
    Bands(usize),
    /// Numbers are whole: a colour and a label for each if there are at most 16 of them, continuous otherwise.
    Integers,
}

/// What a false-colour picture shows and how.
#[derive(Clone, Debug, PartialEq)]
pub struct FalseColour<'a> {
    /// The quantity, with its unit: the heading of the picture.
    pub title: &'a str,
    /// The numbers at the two ends of the palette; those outside take the end's colour, and the legend says so.
    pub range: (f64, f64),
    /// How numbers are laid between them.
    pub scale: Scale,
    /// How the palette is divided.
    pub levels: Levels,
    /// The colours.
    pub palette: Palette,
}

/// Numbers that are not finite.
const NOT_A_NUMBER: Rgb8 = [255, 0, 255];
const GROUND: Rgb8 = [255, 255, 255];
const INK: Rgb8 = [30, 30, 30];

const MARGIN: usize = 16;
const HEADING: usize = 24;
/// Height of capitals.
const TEXT: f32 = 10.0;
const BAR: usize = 22;
/// Smaller pictures are magnified, a whole number of times, up to this size.
const SHOWN: usize = 256;

impl<'a> FalseColour<'a> {
    /// A continuous linear map in [`Palette::Viridis`] from `low` to `high`.
    #[must_use]
    pub fn new(title: &'a str, low: f64, high: f64) -> Self {
        Self { title, range: (low, high), scale: Scale::Linear, levels: Levels::Continuous, palette: Palette::Viridis }
    }

    /// A map of counts from the least to the largest in `map`.
    #[must_use]
    pub fn counts(title: &'a str, map: &ScalarMap) -> Self {
        let (low, high) = extremes(map).unwrap_or((0.0, 0.0));
        Self { levels: Levels::Integers, ..Self::new(title, low.floor(), high.ceil()) }
    }

    /// A continuous linear map over all the finite numbers in `map`; around a constant, a range of one.
    #[must_use]
    pub fn fitting(title: &'a str, map: &ScalarMap) -> Self {
        let (low, high) = extremes(map).unwrap_or((0.0, 0.0));
        if low < high { Self::new(title, low, high) } else { Self::new(title, low - 0.5, low + 0.5) }
    }

    /// A linear map of signed numbers in [`Palette::CoolWarm`], from −`limit` to `limit`.
    #[must_use]
    pub fn signed(title: &'a str, limit: f64) -> Self {
        Self { palette: Palette::CoolWarm, ..Self::new(title, -limit, limit) }
    }

    /// Writes a map as PNG: heading, picture, and a legend to the right of it.
    ///
    /// Numbers that are not finite are magenta, which no palette has. Pictures under 256 pixels are magnified a
    /// whole number of times.
    ///
    /// # Errors
    /// [`ImageError::Range`] if the range is none for the scale; [`ImageError::Size`] if the drawing would be too large;
    /// [`ImageError::Io`].
    pub fn write_png(&self, path: &Path, map: &ScalarMap) -> Result<(), ImageError> {
        self.draw(map)?.write_png(path)
    }

    /// The drawing that [`FalseColour::write_png`] writes.
    ///
    /// # Errors
    /// As there, but for [`ImageError::Io`].
    pub fn draw(&self, map: &ScalarMap) -> Result<Canvas, ImageError> {
        let legend = Legend::new(self, map)?;
        let magnification = (SHOWN / map.width().max(map.height())).max(1);
        let (width, height) = (map.width() * magnification, map.height() * magnification);
        let bar_height = height.max(SHOWN / 2);
        let bar_left = MARGIN + width + MARGIN;
        let needed = (bar_left + legend.width()).max(2 * MARGIN + pixels(Canvas::text_width(self.title, TEXT)));
        let mut canvas = Canvas::new(needed, HEADING + MARGIN + bar_height + MARGIN, GROUND)?;
        canvas.text(self.title, [position(MARGIN), position(HEADING)], TEXT, Anchor::Start, INK);
        let top = HEADING + MARGIN;
        canvas.picture(&map.map(|&value| legend.colour(f64::from(value))), MARGIN, top, magnification);
        legend.draw(&mut canvas, bar_left, top, bar_height);
        Ok(canvas)
    }
}

/// The least and the largest finite number.
pub(crate) fn extremes(map: &ScalarMap) -> Option<(f64, f64)> {
    let finite = map.pixels().iter().filter(|value| value.is_finite()).map(|&value| f64::from(value));
    finite.fold(None, |range, value| match range {
        None => Some((value, value)),
        Some((low, high)) => Some((low.min(value), high.max(value))),
    })
}

/// A coordinate in pixels; exact for any size that a drawing can have.
#[allow(clippy::cast_precision_loss, reason = "pixels of a drawing are far below 2^24")]
fn position(pixels: usize) -> f32 {
    pixels as f32
}

/// A length in whole pixels, rounded up.
#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "lengths are small and positive")]
fn pixels(length: f32) -> usize {
    length.ceil() as usize
}

/// A palette laid over a scale, with marks.
struct Legend {
    scale: Scale,
    low: f64,
    high: f64,
    /// One colour for each equal part of the scale.
    colours: Vec<Rgb8>,
    ticks: Vec<Tick>,
}

/// Colours of a palette without visible steps.
const SMOOTH: usize = 256;
/// The largest number of single colours in a legend.
const MANY: usize = 16;

impl Legend {
    fn new(style: &FalseColour<'_>, map: &ScalarMap) -> Result<Self, ImageError> {
        let (low, high) = style.range;
        let mut legend = match style.levels {
            Levels::Integers => Self::integers(style, low, high)?,
            Levels::Bands(count) => Self::graded(style, count.max(1))?,
            Levels::Continuous => Self::graded(style, SMOOTH)?,
        };
        legend.mark_cut_ends(map);
        Ok(legend)
    }

    fn graded(style: &FalseColour<'_>, count: usize) -> Result<Self, ImageError> {
        let (low, high) = style.range;
        style.scale.check(low, high)?;
        let ticks = ticks(style.scale, low, high, 6);
        Ok(Self { scale: style.scale, low, high, colours: style.palette.steps(count), ticks })
    }

    /// Each whole number in the middle of its part of the scale.
    fn integers(style: &FalseColour<'_>, low: f64, high: f64) -> Result<Self, ImageError> {
        let (bottom, top) = (low.round() - 0.5, high.round() + 0.5);
        Scale::Linear.check(bottom, top)?;
        let limit = position(MANY);
        if top - bottom > f64::from(limit) {
            let ticks = ticks(Scale::Linear, bottom, top, 6).into_iter().filter(|t| t.value.fract() == 0.0).collect();
            let colours = style.palette.steps(SMOOTH);
            return Ok(Self { scale: Scale::Linear, low: bottom, high: top, colours, ticks });
        }
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "between 1 and 16")]
        let count = (top - bottom) as usize;
        let ticks = (0..count)
            .map(|k| bottom + 0.5 + f64::from(position(k)))
            .map(|value| Tick { value, label: format!("{value:.0}") })
            .collect();
        Ok(Self { scale: Scale::Linear, low: bottom, high: top, colours: style.palette.steps(count), ticks })
    }

    /// Labels the ends of the scale with ≤ and ≥ where numbers of the map lie beyond them.
    fn mark_cut_ends(&mut self, map: &ScalarMap) {
        let Some((least, largest)) = extremes(map) else { return };
        let near = |value: f64, end: f64, scale: Scale, low, high| {
            (scale.fraction(value, low, high) - scale.fraction(end, low, high)).abs() < 0.04
        };
        let (scale, low, high) = (self.scale, self.low, self.high);
        if least < low {
            self.ticks.retain(|tick| !near(tick.value, low, scale, low, high));
            self.ticks.insert(0, Tick { value: low, label: format!("≤ {}", short(low)) });
        }
        if largest > high {
            self.ticks.retain(|tick| !near(tick.value, high, scale, low, high));
            self.ticks.push(Tick { value: high, label: format!("≥ {}", short(high)) });
        }
    }

    fn colour(&self, value: f64) -> Rgb8 {
        // Signs of infinity are numbers beyond the ends only in the scale's own sense (the logarithm of zero).
        if !value.is_finite() {
            return NOT_A_NUMBER;
        }
        let count = self.colours.len();
        let part = self.scale.fraction(value, self.low, self.high).clamp(0.0, 1.0) * f64::from(position(count));
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "between 0 and the count")]
        let index = (part as usize).min(count - 1);
        self.colours.get(index).copied().unwrap_or(NOT_A_NUMBER)
    }

    fn width(&self) -> usize {
        let text = self.ticks.iter().map(|tick| Canvas::text_width(&tick.label, TEXT)).fold(0.0, f32::max);
        BAR + 10 + pixels(text) + MARGIN
    }

    /// The bar, low at the bottom, with its marks.
    fn draw(&self, canvas: &mut Canvas, left: usize, top: usize, height: usize) {
        let (x, y) = (position(left), position(top));
        for row in 0..height {
            let fraction = (f64::from(position(height - row)) - 0.5) / f64::from(position(height));
            let colour = self.colour(self.scale.value(fraction, self.low, self.high));
            canvas.rectangle([x, position(top + row), position(BAR), 1.0], colour);
        }
        let (width, height) = (position(BAR), position(height));
        let frame = [[x, y], [x + width, y], [x + width, y + height], [x, y + height], [x, y]];
        canvas.lines(&frame, 1.0, INK);
        for tick in &self.ticks {
            #[allow(clippy::cast_possible_truncation, reason = "a coordinate in pixels")]
            let down = (1.0 - self.scale.fraction(tick.value, self.low, self.high)) as f32 * height;
            canvas.lines(&[[x + width, y + down], [x + width + 4.0, y + down]], 1.0, INK);
            canvas.text(&tick.label, [x + width + 9.0, y + down + 0.5 * TEXT], TEXT, Anchor::Start, INK);
        }
    }
}

/// A number with three significant digits, plain where that is short.
fn short(value: f64) -> String {
    let magnitude = value.abs();
    if magnitude != 0.0 && !(1e-3..1e5).contains(&magnitude) {
        return format!("{value:.2e}");
    }
    let decimals = if magnitude >= 100.0 {
        0
    } else if magnitude >= 10.0 {
        1
    } else {
        2
    };
    let text = if magnitude < 1.0 { format!("{value:.4}") } else { format!("{value:.decimals$}") };
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(values: &[f32]) -> ScalarMap {
        ScalarMap::from_pixels(values.len(), 1, values.to_vec()).unwrap()
    }

    #[test]
    fn ends_of_the_range_have_the_ends_of_the_palette() {
        let map = row(&[0.0, 10.0]);
        let style = FalseColour::fitting("", &map);
        let legend = Legend::new(&style, &map).unwrap();
        assert_eq!(legend.colour(0.0), Palette::Viridis.colour(0.0));
        assert_eq!(legend.colour(10.0), Palette::Viridis.colour(1.0));
        assert_eq!(legend.colour(f64::NAN), NOT_A_NUMBER);
        assert_eq!(legend.colour(f64::INFINITY), NOT_A_NUMBER);
    }

    #[test]
    fn whole_numbers_have_a_colour_and_a_label_each() {
        let map = row(&[2.0, 3.0, 5.0]);
        let legend = Legend::new(&FalseColour::counts("", &map), &map).unwrap();
        let labels: Vec<_> = legend.ticks.iter().map(|tick| tick.label.as_str()).collect();
        assert_eq!(labels, ["2", "3", "4", "5"]);
        let colours: Vec<_> = (2..=5).map(|k| legend.colour(f64::from(k))).collect();
        assert_eq!(colours, Palette::Viridis.steps(4));
        let single = row(&[7.0, 7.0]);
        assert_eq!(Legend::new(&FalseColour::counts("", &single), &single).unwrap().ticks.len(), 1);
        let many = row(&[0.0, 400.0]);
        let legend = Legend::new(&FalseColour::counts("", &many), &many).unwrap();
        assert_eq!(legend.colours.len(), SMOOTH);
        assert!(legend.ticks.len() >= 3);
    }

    #[test]
    fn sixteen_bands_are_sixteen_colours() {
        let map = row(&[0.0, 1.0]);
        let style = FalseColour { levels: Levels::Bands(16), ..FalseColour::new("", 0.0, 16.0) };
        let legend = Legend::new(&style, &map).unwrap();
        for band in 0..16 {
            let expected = Palette::Viridis.steps(16)[usize::try_from(band).unwrap()];
            assert_eq!(legend.colour(f64::from(band) + 0.01), expected);
            assert_eq!(legend.colour(f64::from(band) + 0.99), expected);
        }
    }

    #[test]
    fn the_legend_says_where_numbers_are_cut() {
        let map = row(&[-3.0, 30.0]);
        let legend = Legend::new(&FalseColour::new("", 0.0, 12.5), &map).unwrap();
        assert_eq!(legend.ticks.first().unwrap().label, "≤ 0");
        assert_eq!(legend.ticks.last().unwrap().label, "≥ 12.5");
        let inside = row(&[1.0, 2.0]);
        let legend = Legend::new(&FalseColour::new("", 0.0, 12.5), &inside).unwrap();
        assert!(legend.ticks.iter().all(|tick| !tick.label.contains(['≤', '≥'])));
    }

    #[test]
    fn impossible_ranges_are_refused() {
        let map = row(&[1.0, 2.0]);
        for (low, high) in [(1.0, 1.0), (2.0, 1.0), (f64::NAN, 1.0), (0.0, f64::INFINITY)] {
            assert!(matches!(FalseColour::new("", low, high).draw(&map), Err(ImageError::Range { .. })));
        }
        let logarithmic = FalseColour { scale: Scale::Logarithmic, ..FalseColour::new("", 0.0, 1.0) };
        assert!(matches!(logarithmic.draw(&map), Err(ImageError::Range { .. })));
    }

    #[test]
    fn a_map_without_numbers_is_drawn() {
        let map = row(&[f32::NAN, f32::INFINITY]);
        assert!(FalseColour::fitting("nothing", &map).draw(&map).is_ok());
        assert!(FalseColour::counts("nothing", &map).draw(&map).is_ok());
    }
}
