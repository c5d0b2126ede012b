//! Line charts in a frame.

use super::{Anchor, Canvas, Rgb8, Scale, ticks};

pub(crate) const GROUND: Rgb8 = [255, 255, 255];
pub(crate) const INK: Rgb8 = [30, 30, 30];
const GRID: Rgb8 = [222, 222, 222];

/// A chart area, and the ranges of its axes. What is drawn beyond the range of y is cut off.
pub(crate) struct Axes {
    /// Left, top, width, height.
    pub(crate) frame: [f32; 4],
    pub(crate) x: [f64; 2],
    pub(crate) y: [f64; 2],
    /// The height of capitals, by which distances go.
    pub(crate) text: f32,
}

impl Axes {
    pub(crate) fn point(&self, x: f64, y: f64) -> [f32; 2] {
        let [left, top, width, height] = self.frame;
        let across = Scale::Linear.fraction(x, self.x[0], self.x[1]);
        let up = Scale::Linear.fraction(y, self.y[0], self.y[1]);
        [left + pixels(across) * width, top + height - pixels(up) * height]
    }

    /// Frame, grid, numbers and titles; `marks` are the numbers wanted on x and y.
    pub(crate) fn draw(&self, canvas: &mut Canvas, titles: [&str; 2], marks: [usize; 2]) {
        let [left, top, width, height] = self.frame;
        let text = self.text;
        for tick in ticks(Scale::Linear, self.x[0], self.x[1], marks[0]) {
            let [x, _] = self.point(tick.value, self.y[0]);
            canvas.lines(&[[x, top], [x, top + height]], 1.0, GRID);
            canvas.text(&tick.label, [x, top + height + 1.7 * text], text, Anchor::Middle, INK);
        }
        for tick in ticks(Scale::Linear, self.y[0], self.y[1], marks[1]) {
            let [_, y] = self.point(self.x[0], tick.value);
            canvas.lines(&[[left, y], [left + width, y]], 1.0, GRID);
            canvas.text(&tick.label, [left - 0.6 * text, y + 0.38 * text], text, Anchor::End, INK);
        }
        canvas.lines(&[[left, top], [left, top + height], [left + width, top + height]], 0.11 * text, INK);
        canvas.text(titles[0], [left + 0.5 * width, top + height + 3.5 * text], text, Anchor::Middle, INK);
        canvas.text_upwards(titles[1], [left - 4.8 * text, top + 0.5 * height], text, Anchor::Middle, INK);
    }

    /// A curve through points of increasing x, cut off where it leaves the range of y.
    pub(crate) fn curve(&self, canvas: &mut Canvas, points: &[[f64; 2]], colour: Rgb8) {
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
    pub(crate) fn dot(&self, canvas: &mut Canvas, [x, y]: [f64; 2], colour: Rgb8) {
        let at = self.point(x, y);
        canvas.lines(&[at, at], 9.0, GROUND);
        canvas.lines(&[at, at], 6.5, colour);
    }
}

/// One line of a legend, and the height of its capitals.
pub(crate) fn legend(canvas: &mut Canvas, [x, y]: [f32; 2], (words, text): (&str, f32), colour: Rgb8) {
    canvas.lines(&[[x, y], [x + 2.0 * text, y]], 0.2 * text, colour);
    canvas.text(words, [x + 2.6 * text, y + 0.38 * text], text, Anchor::Start, INK);
}

#[allow(clippy::cast_possible_truncation, reason = "pixel positions")]
fn pixels(value: f64) -> f32 {
    value as f32
}
