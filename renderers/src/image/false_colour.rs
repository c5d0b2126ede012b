//! Maps of numbers drawn in false colour, with a legend.

use super::canvas::{position, whole};
use super::contours::{contours, smoothed};
use super::{Anchor, Canvas, ImageError, Palette, Raster, Rgb8, ScalarMap, Scale, Tick, ticks};
use spectral_core::colour::{linear_rgb_to_xyz, srgb8_to_linear_rgb};
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
    /// What a number that is not finite says: it is grey then, and the legend names it; `None`: nothing, and it is magenta.
    pub missing: Option<&'a str>,
    /// Whether lines are drawn at the legend's numbers, labelled where there is room.
    pub contours: bool,
    /// Parts of the picture that these lines don't cross, such as surfaces: a number for each pixel.
    pub parts: Option<&'a Raster<u32>>,
    /// A line below the picture; empty for none.
    pub caption: &'a str,
    /// The height of capitals in pixels, by which margins go.
    pub text: f32,
}

/// Numbers that are not finite.
const NOT_A_NUMBER: Rgb8 = [255, 0, 255];
const GROUND: Rgb8 = [255, 255, 255];
const INK: Rgb8 = [30, 30, 30];

/// Pixels where there is no value: a grey that is lighter than that of any palette.
const MISSING: Rgb8 = [222, 222, 222];

/// Height of capitals.
const TEXT: f32 = 10.0;
/// In heights of capitals.
const MARGIN: f32 = 1.6;
const HEADING: f32 = 2.4;
const BAR: f32 = 2.2;
/// Smaller pictures are magnified, a whole number of times, up to this size.
const SHOWN: usize = 256;

impl<'a> FalseColour<'a> {
    /// A continuous linear map in [`Palette::Viridis`] from `low` to `high`.
    #[must_use]
    pub fn new(title: &'a str, low: f64, high: f64) -> Self {
        Self {
            title,
            range: (low, high),
            scale: Scale::Linear,
            levels: Levels::Continuous,
            palette: Palette::Viridis,
            missing: None,
            contours: false,
            parts: None,
            caption: "",
            text: TEXT,
        }
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
    /// Numbers that are not finite are magenta, which no palette has, unless they mean something. Pictures under 256 pixels are magnified a
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
        let [margin, heading] = [MARGIN, HEADING].map(|length| whole(length * self.text));
        let bar_left = margin + width + margin;
        let words = [self.title, self.caption].map(|words| whole(Canvas::text_width(words, self.text)));
        let needed = (bar_left + legend.width()).max(2 * margin + words[0].max(words[1]));
        let top = heading + margin;
        let foot = if self.caption.is_empty() { margin } else { margin + heading };
        let mut canvas = Canvas::new(needed, top + bar_height + foot, GROUND)?;
        canvas.text(self.title, [position(margin), position(heading)], self.text, Anchor::Start, INK);
        canvas.picture(&map.map(|&value| legend.colour(f64::from(value))), margin, top, magnification);
        if self.contours {
            legend.draw_contours(&mut canvas, (map, self.parts), [margin, top], magnification);
        }
        let below = position(top + bar_height + foot) - 1.4 * self.text;
        canvas.text(self.caption, [position(margin), below], self.text, Anchor::Start, INK);
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

/// A palette laid over a scale, with marks.
struct Legend {
    scale: Scale,
    low: f64,
    high: f64,
    /// One colour for each equal part of the scale.
    colours: Vec<Rgb8>,
    ticks: Vec<Tick>,
    /// What numbers that are not finite say, and their colour.
    missing: Option<String>,
    /// The height of capitals.
    text: f32,
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
        let some_missing = map.pixels().iter().any(|value| !value.is_finite());
        legend.missing = style.missing.map(|words| if some_missing { words.to_owned() } else { String::new() });
        Ok(legend)
    }

    fn graded(style: &FalseColour<'_>, count: usize) -> Result<Self, ImageError> {
        let (low, high) = style.range;
        style.scale.check(low, high)?;
        let ticks = ticks(style.scale, low, high, 6);
        let colours = style.palette.steps(count);
        Ok(Self { scale: style.scale, low, high, colours, ticks, missing: None, text: style.text })
    }

    /// Each whole number in the middle of its part of the scale.
    fn integers(style: &FalseColour<'_>, low: f64, high: f64) -> Result<Self, ImageError> {
        let (bottom, top) = (low.round() - 0.5, high.round() + 0.5);
        Scale::Linear.check(bottom, top)?;
        let limit = position(MANY);
        if top - bottom > f64::from(limit) {
            let ticks = ticks(Scale::Linear, bottom, top, 6).into_iter().filter(|t| t.value.fract() == 0.0).collect();
            let colours = style.palette.steps(SMOOTH);
            let (scale, low, high, text) = (Scale::Linear, bottom, top, style.text);
            return Ok(Self { scale, low, high, colours, ticks, missing: None, text });
        }
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "between 1 and 16")]
        let count = (top - bottom) as usize;
        let ticks = (0..count)
            .map(|k| bottom + 0.5 + f64::from(position(k)))
            .map(|value| Tick { value, label: format!("{value:.0}") })
            .collect();
        let (scale, colours, text) = (Scale::Linear, style.palette.steps(count), style.text);
        Ok(Self { scale, low: bottom, high: top, colours, ticks, missing: None, text })
    }

    /// Labels the ends of the scale with ≤ and ≥ where numbers of the map lie beyond them.
    fn mark_cut_ends(&mut self, map: &ScalarMap) {
        let Some((least, largest)) = extremes(map) else { return };
        let near = |value: f64, end: f64, scale: Scale, low, high| {
            (scale.fraction(value, low, high) - scale.fraction(end, low, high)).abs() < 0.07
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
            return if self.missing.is_some() { MISSING } else { NOT_A_NUMBER };
        }
        let count = self.colours.len();
        let part = self.scale.fraction(value, self.low, self.high).clamp(0.0, 1.0) * f64::from(position(count));
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "between 0 and the count")]
        let index = (part as usize).min(count - 1);
        self.colours.get(index).copied().unwrap_or(NOT_A_NUMBER)
    }

    fn width(&self) -> usize {
        let labels = self.ticks.iter().map(|tick| tick.label.as_str()).chain(self.missing.as_deref());
        let text = labels.map(|label| Canvas::text_width(label, self.text)).fold(0.0, f32::max);
        whole((BAR + 1.0 + MARGIN) * self.text + text)
    }

    /// The bar, low at the bottom, with its marks.
    fn draw(&self, canvas: &mut Canvas, left: usize, top: usize, height: usize) {
        let (x, y, text) = (position(left), position(top), self.text);
        let height = match self.missing.as_deref() {
            None | Some("") => height,
            Some(words) => {
                // Below the bar.
                let box_top = y + position(height) - BAR * text;
                canvas.rectangle([x, box_top, BAR * text, BAR * text], MISSING);
                canvas.text(words, [x + (BAR + 0.9) * text, box_top + 1.6 * text], text, Anchor::Start, INK);
                height.saturating_sub(whole((BAR + 1.2) * text)).max(1)
            }
        };
        for row in 0..height {
            let fraction = (f64::from(position(height - row)) - 0.5) / f64::from(position(height));
            let colour = self.colour(self.scale.value(fraction, self.low, self.high));
            canvas.rectangle([x, position(top + row), BAR * text, 1.0], colour);
        }
        let (width, height) = (BAR * text, position(height));
        let frame = [[x, y], [x + width, y], [x + width, y + height], [x, y + height], [x, y]];
        canvas.lines(&frame, 1.0, INK);
        for tick in &self.ticks {
            #[allow(clippy::cast_possible_truncation, reason = "a coordinate in pixels")]
            let down = (1.0 - self.scale.fraction(tick.value, self.low, self.high)) as f32 * height;
            canvas.lines(&[[x + width, y + down], [x + width + 0.4 * text, y + down]], 1.0, INK);
            canvas.text(&tick.label, [x + width + 0.9 * text, y + down + 0.5 * text], text, Anchor::Start, INK);
        }
    }

    /// Lines at the marks within the scale, with their numbers; `corner` is where the map begins.
    fn draw_contours(
        &self,
        canvas: &mut Canvas,
        (map, parts): (&ScalarMap, Option<&Raster<u32>>),
        corner: [usize; 2],
        magnification: usize,
    ) {
        let [left, top] = corner.map(position);
        let scale = position(magnification);
        let jump = self.jump();
        let smooth = smoothed(map, parts, 0.5 * jump);
        let ends = [left, top, left + scale * position(map.width()), top + scale * position(map.height())];
        let (mut taken, mut labels) = (Vec::new(), Vec::new());
        for tick in self.ticks.iter().filter(|tick| self.low < tick.value && tick.value < self.high) {
            let ground = self.colour(tick.value);
            let ink = if is_light(ground) { INK } else { GROUND };
            let lines = contours(&smooth, parts, tick.value, jump);
            let lines =
                lines.iter().map(|line| line.iter().map(|[x, y]| [left + scale * x, top + scale * y]).collect());
            let lines: Vec<Vec<[f32; 2]>> = lines.collect();
            lines.iter().for_each(|line| canvas.lines(line, 0.09 * self.text, ink));
            let size = [Canvas::text_width(&tick.label, 0.85 * self.text), 0.85 * self.text];
            for line in &lines {
                if let Some(place) = label_place(line, size, ends, &taken) {
                    taken.push(place);
                    labels.push((place, tick, [ground, ink]));
                }
            }
        }
        // After all lines, so that none crosses a number.
        for ([x, y, width, height], tick, [ground, ink]) in labels {
            canvas.rectangle([x, y, width, height], ground);
            let baseline = [x + 0.5 * width, y + 0.5 * (height + 0.85 * self.text)];
            canvas.text(&tick.label, baseline, 0.85 * self.text, Anchor::Middle, ink);
        }
    }

    /// By how much neighbours on one surface differ at most.
    fn jump(&self) -> f64 {
        JUMP * (self.high - self.low)
    }
}

/// Neighbours that differ by more than this share of the scale are of different objects.
const JUMP: f64 = 0.12;
/// How far labels stay from each other, in heights of capitals, and how long a line must be in widths of its label.
const APART: f32 = 4.0;
const LONG: f32 = 3.0;

/// Where the number of a line may stand: left, top, width and height, with the line in the middle; the place nearest to the line's middle
/// that is within the map and far from others.
fn label_place(line: &[[f32; 2]], [width, height]: [f32; 2], ends: [f32; 4], taken: &[[f32; 4]]) -> Option<[f32; 4]> {
    let length: f32 = line.windows(2).map(|pair| (pair[1][0] - pair[0][0]).hypot(pair[1][1] - pair[0][1])).sum();
    let [width, tall] = [width + 0.8 * height, 1.7 * height];
    if length < LONG * width {
        return None;
    }
    let apart = APART * height;
    let fits = |index: usize| {
        let [x, y] = *line.get(index)?;
        let place = [x - 0.5 * width, y - 0.5 * tall, width, tall];
        let inside = place[0] >= ends[0] + 2.0
            && place[1] >= ends[1] + 2.0
            && place[0] + width <= ends[2] - 2.0
            && place[1] + tall <= ends[3] - 2.0;
        let free = taken.iter().all(|other| {
            place[0] > other[0] + other[2] + apart
                || other[0] > place[0] + width + apart
                || place[1] > other[1] + other[3] + apart
                || other[1] > place[1] + tall + apart
        });
        (inside && free).then_some(place)
    };
    let middle = line.len() / 2;
    (0..=middle).flat_map(|off| [middle.checked_sub(off), Some(middle + off)]).flatten().find_map(fits)
}

/// Whether dark ink shows better on a colour.
fn is_light(colour: Rgb8) -> bool {
    let [_, luminance, _] = linear_rgb_to_xyz(srgb8_to_linear_rgb::<f64>(colour));
    luminance > 0.2
}

/// A number with three significant digits, plain where that is short.
fn short(value: f64) -> String {
    let magnitude = value.abs();
    if magnitude != 0.0 && !(1e-3..1e6).contains(&magnitude) {
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
