//! What is said to the reader of a terminal: aligned tables and histograms, the latter also as pictures.

use crate::image::{Anchor, Canvas, ImageError, Palette, Rgb8, Scale, Tick, ticks};
use core::fmt;
use serde::Serialize;
use std::path::Path;

/// A table in plain text: numbers to the right, words to the left.
///
/// ```
/// use renderers::report::Table;
/// let mut table = Table::new(["patch", "intervals"]);
/// table.row(["dark skin", "2"]);
/// table.row(["cyan", "11"]);
/// assert_eq!(
///     table.to_string(),
///     "patch      intervals\n\
///      ---------  ---------\n\
///      dark skin          2\n\
///      cyan              11\n"
/// );
/// ```
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Table {
    headings: Vec<String>,
    rows: Vec<Vec<String>>,
}

impl Table {
    /// A table without rows.
    pub fn new<S: Into<String>>(headings: impl IntoIterator<Item = S>) -> Self {
        Self { headings: headings.into_iter().map(Into::into).collect(), rows: Vec::new() }
    }

    /// Adds a row; cells that are missing stay empty, cells beyond the last heading get none.
    pub fn row<S: Into<String>>(&mut self, cells: impl IntoIterator<Item = S>) -> &mut Self {
        self.rows.push(cells.into_iter().map(Into::into).collect());
        self
    }

    /// Whether all cells of a column are numbers (or empty, or a dash), a unit after them allowed.
    fn is_numeric(&self, column: usize) -> bool {
        let mut cells = self.rows.iter().filter_map(|row| row.get(column)).filter(|cell| !cell.is_empty());
        let number = |cell: &String| {
            let rest = cell.trim_start_matches(['+', '-', '−', '–', '<', '>', '≤', '≥', ' ', '.']);
            rest.is_empty() || rest.starts_with(|c: char| c.is_ascii_digit())
        };
        cells.clone().next().is_some() && cells.all(number)
    }
}

impl fmt::Display for Table {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let count = self.rows.iter().map(Vec::len).fold(self.headings.len(), usize::max);
        let cell = |row: &[String], column: usize| row.get(column).cloned().unwrap_or_default();
        let lines = || core::iter::once(&self.headings).chain(&self.rows);
        let columns: Vec<(usize, bool)> = (0..count)
            .map(|column| {
                let width = lines().map(|row| cell(row, column).chars().count()).max().unwrap_or(0);
                (width, self.is_numeric(column))
            })
            .collect();
        let write_row = |f: &mut fmt::Formatter<'_>, row: &[String]| {
            let cells = columns.iter().enumerate().map(|(column, &(width, numeric))| {
                let text = cell(row, column);
                if numeric { format!("{text:>width$}") } else { format!("{text:<width$}") }
            });
            writeln!(f, "{}", cells.collect::<Vec<_>>().join("  ").trim_end())
        };
        write_row(f, &self.headings)?;
        write_row(f, &columns.iter().map(|&(width, _)| "-".repeat(width)).collect::<Vec<_>>())?;
        self.rows.iter().try_for_each(|row| write_row(f, row))
    }
}

/// The largest number of bins of a histogram.
pub const MAX_BINS: usize = 4096;

/// How often values fall into the parts of a range.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Histogram {
    /// Where the first bin starts.
    low: f64,
    /// The width of a bin.
    step: f64,
    /// Whether bin k stands for the whole number k.
    whole: bool,
    /// The number of values in each bin.
    counts: Vec<u64>,
    /// The number of values in no bin, NaN included.
    outside: u64,
}

impl Histogram {
    /// A histogram of whole numbers from 0: bin k counts the values k.
    ///
    /// It has as many bins as the largest value asks for, at most [`MAX_BINS`]; what is larger is counted as outside.
    pub fn of_counts(values: impl IntoIterator<Item = usize>) -> Self {
        let mut histogram = Self { low: -0.5, step: 1.0, whole: true, counts: Vec::new(), outside: 0 };
        for value in values {
            if value >= MAX_BINS {
                histogram.outside += 1;
                continue;
            }
            if value >= histogram.counts.len() {
                histogram.counts.resize(value + 1, 0);
            }
            histogram.counts[value] += 1;
        }
        histogram
    }

    /// A histogram of numbers in `bins` equal parts of [`low`, `high`); `high` itself counts into the last part.
    ///
    /// # Errors
    /// [`ImageError::Range`] if the limits are not finite and increasing, or if there are no or too many bins.
    pub fn of_values(
        values: impl IntoIterator<Item = f64>,
        low: f64,
        high: f64,
        bins: usize,
    ) -> Result<Self, ImageError> {
        Scale::Linear.check(low, high)?;
        if bins == 0 || bins > MAX_BINS {
            return Err(ImageError::Range { low, high });
        }
        let (mut counts, mut outside) = (vec![0; bins], 0);
        for value in values {
            match bin(Scale::Linear.fraction(value, low, high), bins) {
                Some(index) => counts[index] += 1,
                None => outside += 1,
            }
        }
        Ok(Self { low, step: (high - low) / size(bins), whole: false, counts, outside })
    }

    /// The number of values in each bin.
    #[must_use]
    pub fn counts(&self) -> &[u64] {
        &self.counts
    }

    /// The number of values in no bin, NaN included.
    #[must_use]
    pub fn outside(&self) -> u64 {
        self.outside
    }

    /// The number of all values, those outside included.
    #[must_use]
    pub fn total(&self) -> u64 {
        self.counts.iter().sum::<u64>() + self.outside
    }

    /// The share of all values, in [0, 1], that is in the bins from the first to this one; 0 when there are no values.
    #[must_use]
    pub fn share_up_to(&self, bin: usize) -> f64 {
        let counted: u64 = self.counts.iter().take(bin.saturating_add(1)).sum();
        share(counted, self.total())
    }

    /// Where a bin starts.
    fn start(&self, bin: usize) -> f64 {
        self.low + self.step * size(bin)
    }

    /// The bins from the first to the last that is not empty.
    fn filled(&self) -> core::ops::Range<usize> {
        let first = self.counts.iter().position(|&count| count > 0).unwrap_or(0);
        let last = self.counts.iter().rposition(|&count| count > 0).map_or(0, |last| last + 1);
        first..last.max(first)
    }

    /// The histogram as text: a line for each bin from the first to the last that is not empty, with its count, its
    /// share, the share up to and with it, and a bar of at most `width` characters.
    ///
    /// More than 40 bins are put together so that there are at most 40 lines.
    #[must_use]
    pub fn to_text(&self, width: usize) -> String {
        let filled = self.filled();
        let group = filled.len().div_ceil(40).max(1);
        let lines: Vec<(usize, u64)> = filled
            .clone()
            .step_by(group)
            .map(|first| (first, self.counts[first..(first + group).min(filled.end)].iter().sum()))
            .collect();
        let largest = lines.iter().map(|&(_, count)| count).max().unwrap_or(0);
        let mut table = Table::new([if self.whole { "value" } else { "from" }, "count", "share", "up to", ""]);
        for (first, count) in lines {
            table.row([
                self.label(first, group),
                count.to_string(),
                percent(share(count, self.total())),
                percent(self.share_up_to(first + group - 1)),
                "#".repeat(bar_length(count, largest, width)),
            ]);
        }
        if self.outside > 0 {
            table.row(["outside".to_owned(), self.outside.to_string(), percent(share(self.outside, self.total()))]);
        }
        table.to_string()
    }

    fn label(&self, first: usize, group: usize) -> String {
        if !self.whole {
            let decimals = decimals(self.step);
            return format!("{:.decimals$}", self.start(first));
        }
        if group == 1 { first.to_string() } else { format!("{first}–{}", first + group - 1) }
    }

    /// Draws the histogram as a bar chart, 640 × 400 pixels, and writes it as PNG.
    ///
    /// On a logarithmic scale the axis starts at ½, so that a bin with a single value can be seen.
    ///
    /// # Errors
    /// [`ImageError::Io`].
    pub fn write_png(&self, path: &Path, labels: &ChartLabels<'_>, scale: Scale) -> Result<(), ImageError> {
        Chart::new(self, scale)?.draw(labels)?.write_png(path)
    }
}

/// The texts of a chart.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ChartLabels<'a> {
    /// The heading.
    pub title: &'a str,
    /// What the values are, with their unit.
    pub values: &'a str,
    /// What is counted.
    pub counts: &'a str,
}

/// A bin's index from the fraction of the range, both ends included; `None` outside and for NaN.
fn bin(fraction: f64, bins: usize) -> Option<usize> {
    if !(0.0..=1.0).contains(&fraction) {
        return None;
    }
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "between 0 and the number of bins")]
    let index = (fraction * size(bins)) as usize;
    Some(index.min(bins - 1))
}

#[allow(clippy::cast_precision_loss, reason = "numbers of bins")]
fn size(count: usize) -> f64 {
    count as f64
}

#[allow(clippy::cast_precision_loss, reason = "numbers of pixels are far below 2^53")]
fn share(count: u64, total: u64) -> f64 {
    if total == 0 { 0.0 } else { count as f64 / total as f64 }
}

fn percent(share: f64) -> String {
    format!("{:.2} %", 100.0 * share)
}

/// The decimals that tell multiples of a step apart.
fn decimals(step: f64) -> usize {
    let digits = (2.0 - step.log10()).floor().clamp(0.0, 17.0);
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "between 0 and 17")]
    let digits = digits as usize;
    digits
}

/// The length of a bar; at least 1 for a count that is not 0.
fn bar_length(count: u64, largest: u64, width: usize) -> usize {
    let length = share(count, largest) * size(width);
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "between 0 and the width")]
    let length = length.round() as usize;
    if count > 0 { length.max(1) } else { 0 }
}

const GROUND: Rgb8 = [255, 255, 255];
const INK: Rgb8 = [30, 30, 30];
const GRID: Rgb8 = [225, 225, 225];
const WIDTH: f32 = 640.0;
const HEIGHT: f32 = 400.0;
/// The plot's left, top, right and bottom edge.
const PLOT: [f32; 4] = [84.0, 48.0, 624.0, 344.0];
const TEXT: f32 = 10.0;

/// A histogram laid out on a page.
struct Chart<'h> {
    histogram: &'h Histogram,
    bins: core::ops::Range<usize>,
    scale: Scale,
    /// The ends of the axis of counts.
    counts: (f64, f64),
}

impl<'h> Chart<'h> {
    fn new(histogram: &'h Histogram, scale: Scale) -> Result<Self, ImageError> {
        let mut bins = histogram.filled();
        if bins.is_empty() {
            bins = 0..1;
        }
        #[allow(clippy::cast_precision_loss, reason = "numbers of pixels are far below 2^53")]
        let largest = histogram.counts.iter().copied().max().unwrap_or(0).max(1) as f64;
        let counts = match scale {
            Scale::Linear => (0.0, 1.05 * largest),
            Scale::Logarithmic => (0.5, 1.5 * largest),
        };
        scale.check(counts.0, counts.1)?;
        Ok(Self { histogram, bins, scale, counts })
    }

    #[allow(clippy::cast_possible_truncation, reason = "coordinates in pixels")]
    fn x(&self, value: f64) -> f32 {
        let (low, high) = (self.histogram.start(self.bins.start), self.histogram.start(self.bins.end));
        PLOT[0] + (PLOT[2] - PLOT[0]) * Scale::Linear.fraction(value, low, high) as f32
    }

    #[allow(clippy::cast_possible_truncation, reason = "coordinates in pixels")]
    fn y(&self, count: f64) -> f32 {
        let fraction = self.scale.fraction(count, self.counts.0, self.counts.1).clamp(0.0, 1.0);
        PLOT[3] - (PLOT[3] - PLOT[1]) * fraction as f32
    }

    fn draw(&self, labels: &ChartLabels<'_>) -> Result<Canvas, ImageError> {
        let mut canvas = Canvas::new(640, 400, GROUND)?;
        canvas.text(labels.title, [PLOT[0], 28.0], 12.0, Anchor::Start, INK);
        self.draw_count_axis(&mut canvas, labels.counts);
        self.draw_bars(&mut canvas);
        self.draw_value_axis(&mut canvas, labels.values);
        let [left, top, right, bottom] = PLOT;
        canvas.lines(&[[left, top], [left, bottom], [right, bottom]], 1.5, INK);
        Ok(canvas)
    }

    fn draw_count_axis(&self, canvas: &mut Canvas, label: &str) {
        for tick in ticks(self.scale, self.counts.0, self.counts.1, 8)
            .iter()
            .filter(|tick| tick.value >= 1.0 || tick.value == 0.0)
        {
            let y = self.y(tick.value);
            canvas.lines(&[[PLOT[0], y], [PLOT[2], y]], 1.0, GRID);
            canvas.text(&tick.label, [PLOT[0] - 8.0, y + 0.5 * TEXT], TEXT, Anchor::End, INK);
        }
        canvas.text_upwards(label, [22.0, 0.5 * (PLOT[1] + PLOT[3])], TEXT, Anchor::Middle, INK);
    }

    fn draw_bars(&self, canvas: &mut Canvas) {
        let colour = Palette::Viridis.colour(0.4);
        for bin in self.bins.clone() {
            let count = self.histogram.counts.get(bin).copied().unwrap_or(0);
            if count == 0 {
                continue;
            }
            let (left, right) = (self.x(self.histogram.start(bin)), self.x(self.histogram.start(bin + 1)));
            // A gap between bars that are wide enough for one.
            let gap = if right - left >= 4.0 { 1.0 } else { 0.0 };
            #[allow(clippy::cast_precision_loss, reason = "numbers of pixels are far below 2^53")]
            let top = self.y(count as f64).min(PLOT[3] - 1.0);
            canvas.rectangle([left + 0.5 * gap, top, (right - left - gap).max(0.5), PLOT[3] - top], colour);
        }
    }

    fn draw_value_axis(&self, canvas: &mut Canvas, label: &str) {
        for tick in self.value_ticks() {
            let x = self.x(tick.value);
            canvas.lines(&[[x, PLOT[3]], [x, PLOT[3] + 4.0]], 1.0, INK);
            canvas.text(&tick.label, [x, PLOT[3] + 20.0], TEXT, Anchor::Middle, INK);
        }
        canvas.text(label, [0.5 * (PLOT[0] + PLOT[2]), HEIGHT - 14.0], TEXT, Anchor::Middle, INK);
        if self.histogram.outside > 0 {
            let text = format!("{} outside", self.histogram.outside);
            canvas.text(&text, [WIDTH - 16.0, 28.0], TEXT, Anchor::End, INK);
        }
    }

    fn value_ticks(&self) -> Vec<Tick> {
        let histogram = self.histogram;
        if histogram.whole && self.bins.len() <= 20 {
            let tick = |bin: usize| Tick { value: size(bin), label: bin.to_string() };
            return self.bins.clone().map(tick).collect();
        }
        let marks = ticks(Scale::Linear, histogram.start(self.bins.start), histogram.start(self.bins.end), 8);
        marks.into_iter().filter(|tick| !histogram.whole || tick.value.fract() == 0.0).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_of_numbers_are_right_aligned() {
        let mut table = Table::new(["name", "ΔE", "n"]);
        table.row(["über", "-0.5", "–"]).row(["x", "12.25 %"]).row(["", "", "3"]);
        assert_eq!(
            table.to_string(),
            "name       ΔE  n\n----  -------  -\nüber     -0.5  –\nx     12.25 %\n               3\n"
        );
    }

    #[test]
    fn a_row_may_be_longer_than_the_headings() {
        let mut table = Table::new(["a"]);
        table.row(["1", "word"]);
        assert_eq!(table.to_string(), "a\n-  ----\n1  word\n");
        assert_eq!(Table::new(["only"]).to_string(), "only\n----\n");
    }

    #[test]
    fn whole_numbers_are_counted_each() {
        let histogram = Histogram::of_counts([3, 1, 3, 3, usize::MAX]);
        assert_eq!(histogram.counts(), [0, 1, 0, 3]);
        assert_eq!((histogram.outside(), histogram.total()), (1, 5));
        assert_eq!([0, 1, 2, 3, 9].map(|bin| histogram.share_up_to(bin)), [0.0, 0.2, 0.2, 0.8, 0.8]);
        let text = histogram.to_text(6);
        let lines: Vec<_> = text.lines().collect();
        assert_eq!(lines[2], "1            1  20.00 %  20.00 %  ##");
        assert_eq!(lines[4], "3            3  60.00 %  80.00 %  ######");
        assert_eq!(lines[5], "outside      1  20.00 %");
    }

    #[test]
    fn numbers_are_counted_into_equal_parts() {
        let values = [0.0, 0.24, 0.25, 0.99, 1.0, 1.01, -0.01, f64::NAN, f64::INFINITY];
        let histogram = Histogram::of_values(values, 0.0, 1.0, 4).unwrap();
        assert_eq!(histogram.counts(), [2, 1, 0, 2]);
        assert_eq!(histogram.outside(), 4);
        assert!(histogram.to_text(10).contains("0.75"));
    }

    #[test]
    fn many_bins_are_put_together_in_text() {
        let text = Histogram::of_counts(0..1000).to_text(20);
        assert!((40..=43).contains(&text.lines().count()), "{text}");
        assert!(text.contains("0–24 ") && text.contains("975–999"), "{text}");
    }

    #[test]
    fn impossible_histograms_are_refused() {
        for (low, high, bins) in
            [(0.0, 0.0, 4), (1.0, 0.0, 4), (f64::NAN, 1.0, 4), (0.0, 1.0, 0), (0.0, 1.0, MAX_BINS + 1)]
        {
            assert!(Histogram::of_values([0.5], low, high, bins).is_err());
        }
    }

    #[test]
    fn an_empty_histogram_is_drawn() {
        let labels = ChartLabels { title: "", values: "", counts: "" };
        for histogram in [Histogram::of_counts([]), Histogram::of_values([], 0.0, 1.0, 3).unwrap()] {
            assert_eq!(histogram.to_text(10).lines().count(), 2);
            assert_eq!(histogram.share_up_to(0), 0.0);
            for scale in [Scale::Linear, Scale::Logarithmic] {
                assert!(Chart::new(&histogram, scale).unwrap().draw(&labels).is_ok());
            }
        }
    }

    #[test]
    fn bars_are_as_high_as_their_counts() {
        let histogram = Histogram::of_counts([0, 0, 1, 1, 1, 1]);
        let chart = Chart::new(&histogram, Scale::Linear).unwrap();
        let height = |count: f64| PLOT[3] - chart.y(count);
        assert!((height(4.0) - 2.0 * height(2.0)).abs() <= 1e-3);
        let chart = Chart::new(&histogram, Scale::Logarithmic).unwrap();
        assert!((chart.y(1.0) - chart.y(2.0) - (chart.y(2.0) - chart.y(4.0))).abs() <= 1e-3);
        assert!(chart.y(1.0) < PLOT[3] - 10.0, "a single value can be seen");
    }
}
