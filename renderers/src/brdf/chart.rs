//! Line charts in a frame.

use crate::image::{Anchor, Canvas, Rgb8, Scale, ticks};

pub(super) const GROUND: Rgb8 = [255, 255, 255];
pub(super) const INK: Rgb8 = [30, 30, 30];
const GRID: Rgb8 = [222, 222, 222];
/// The height of capitals.
pub(super) const TEXT: f32 = 13.0;

/// A chart area, and the ranges of its axes. What is drawn beyond the range of y is cut off.
pub(super) struct Axes {
    /// Left, top, width, height.
    pub(super) frame: [f32; 4],
    pub(super) x: [f64; 2],
    pub(super) y: [f64; 2],
}

impl Axes {
    pub(super) fn point(&self, x: f64, y: f64) -> [f32; 2] {
        let [left, top, width, height] = self.frame;
        let across = Scale::Linear.fraction(x, self.x[0], self.x[1]);
        let up = Scale::Linear.fraction(y, self.y[0], self.y[1]);
        [left + pixels(across) * width, top + height - pixels(up) * height]
    }

    /// Frame, grid, numbers and titles; `marks` are the numbers wanted on x and y.
    pub(super) fn draw(&self, canvas: &mut Canvas, titles: [&str; 2], marks: [usize; 2]) {
        let [left, top, width, height] = self.frame;
        for tick in ticks(Scale::Linear, self.x[0], self.x[1], marks[0]) {
            let [x, _] = self.point(tick.value, self.y[0]);
            canvas.lines(&[[x, top], [x, top + height]], 1.0, GRID);
            canvas.text(&tick.label, [x, top + height + 22.0], TEXT, Anchor::Middle, INK);
        }
        for tick in ticks(Scale::Linear, self.y[0], self.y[1], marks[1]) {
            let [_, y] = self.point(self.x[0], tick.value);
            canvas.lines(&[[left, y], [left + width, y]], 1.0, GRID);
            canvas.text(&tick.label, [left - 8.0, y + 5.0], TEXT, Anchor::End, INK);
        }
        canvas.lines(&[[left, top], [left, top + height], [left + width, top + height]], 1.4, INK);
        canvas.text(titles[0], [left + 0.5 * width, top + height + 46.0], TEXT, Anchor::Middle, INK);
        canvas.text_upwards(titles[1], [left - 64.0, top + 0.5 * height], TEXT, Anchor::Middle, INK);
    }

    /// A curve through points of increasing x, cut off where it leaves the range of y.
    pub(super) fn curve(&self, canvas: &mut Canvas, points: &[[f64; 2]], colour: Rgb8) {
        let mut run: Vec<[f32; 2]> = Vec::new();
        for pair in points.windows(2) {
            let Some([first, last]) = self.cut([pair[0], pair[1]]) else { continue };
            let [first, last] = [first, last].map(|[x, y]| self.point(x, y));
            if run.last() != Some(&first) {
                canvas.lines(&run, 2.2, colour);
                run = vec![first];
            }
            run.push(last);
        }
        canvas.lines(&run, 2.2, colour);
    }

    /// The part of a line within the range of y.
    fn cut(&self, [a, b]: [[f64; 2]; 2]) -> Option<[[f64; 2]; 2]> {
        let [low, high] = self.y;
        if !(a[1].min(b[1]) <= high && a[1].max(b[1]) >= low) {
            return None;
        }
        let at = |end: [f64; 2]| {
            let y = end[1].clamp(low, high);
            let share = if end[1] == y { return end } else { (y - a[1]) / (b[1] - a[1]) };
            [a[0] + share * (b[0] - a[0]), y]
        };
        Some([at(a), at(b)])
    }

    /// A dot with a pale rim, so that it shows on lines.
    pub(super) fn dot(&self, canvas: &mut Canvas, [x, y]: [f64; 2], colour: Rgb8) {
        let at = self.point(x, y);
        canvas.lines(&[at, at], 9.0, GROUND);
        canvas.lines(&[at, at], 6.5, colour);
    }
}

/// One line of a legend.
pub(super) fn legend(canvas: &mut Canvas, [x, y]: [f32; 2], text: &str, colour: Rgb8) {
    canvas.lines(&[[x, y], [x + 26.0, y]], 2.6, colour);
    canvas.text(text, [x + 34.0, y + 5.0], TEXT, Anchor::Start, INK);
}

#[allow(clippy::cast_possible_truncation, reason = "pixel positions")]
fn pixels(value: f64) -> f32 {
    value as f32
}
