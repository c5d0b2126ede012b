//! Curves and sweeps as pictures, both axes logarithmic.

use std::path::Path;

use super::curve::{Curve, Point};
use super::stability::Sweep;
use crate::image::chart::{Axes, GROUND, INK, legend};
use crate::image::{Anchor, Canvas, ImageError, Rgb8, Scale, position, ticks, whole};

/// The height of capitals.
const TEXT: f32 = 15.0;
const LEGEND: f32 = 13.0;
const SMALL: f32 = 11.0;
/// Apart for dichromats, too: after Okabe and Ito (2008), with a grey.
const COLOURS: [Rgb8; 8] = [
    [0, 114, 178],
    [213, 94, 0],
    [0, 158, 115],
    [204, 121, 167],
    [230, 159, 0],
    [86, 180, 233],
    [110, 110, 110],
    [150, 130, 20],
];
const GRID: Rgb8 = [222, 222, 222];
const SHADE: Rgb8 = [232, 240, 247];
const WIDTH: usize = 1640;
/// Errors of nothing at all are drawn here.
const LEAST: f64 = 1e-17;

/// A chart area with logarithmic axes.
struct LogAxes {
    axes: Axes,
}

impl LogAxes {
    fn new(frame: [f32; 4], x: [f64; 2], y: [f64; 2]) -> Self {
        Self { axes: Axes { frame, x: x.map(f64::log10), y: y.map(f64::log10), text: TEXT } }
    }

    fn point(&self, [x, y]: [f64; 2]) -> [f32; 2] {
        self.axes.point(x.log10(), y.log10())
    }

    fn draw(&self, canvas: &mut Canvas, titles: [&str; 2]) {
        let ([left, top, width, height], text) = (self.axes.frame, TEXT);
        let range = |limits: [f64; 2]| limits.map(|v| 10.0_f64.powf(v));
        let [x, y] = [range(self.axes.x), range(self.axes.y)];
        for tick in ticks(Scale::Logarithmic, x[0], x[1], 5) {
            let [at, _] = self.point([tick.value, y[0]]);
            canvas.lines(&[[at, top], [at, top + height]], 1.0, GRID);
            canvas.text(&tick.label, [at, top + height + 1.7 * text], text, Anchor::Middle, INK);
        }
        for tick in ticks(Scale::Logarithmic, y[0], y[1], 7) {
            let [_, at] = self.point([x[0], tick.value]);
            canvas.lines(&[[left, at], [left + width, at]], 1.0, GRID);
            canvas.text(&tick.label, [left - 0.6 * text, at + 0.38 * text], text, Anchor::End, INK);
        }
        canvas.lines(&[[left, top], [left, top + height], [left + width, top + height]], 1.6, INK);
        canvas.text(titles[0], [left + 0.5 * width, top + height + 3.6 * text], text, Anchor::Middle, INK);
        canvas.text_upwards(titles[1], [left - 6.4 * text, top + 0.5 * height], text, Anchor::Middle, INK);
    }
}

/// Limits around positive numbers, with some room.
fn limits(values: impl Iterator<Item = f64>, room: f64) -> [f64; 2] {
    let (low, high) = values
        .filter(|v| *v > 0.0 && *v < f64::MAX)
        .fold((f64::INFINITY, 0.0_f64), |(low, high), v| (low.min(v), high.max(v)));
    if low > high {
        return [0.1, 10.0];
    }
    // At least a decade, so that equal costs don't fill the chart with rounding.
    let middle = (low * high).sqrt();
    [(low / room).min(middle / 3.2), (high * room).max(middle * 3.2)]
}

/// Draws curves one below the other: error against time on the left, against counted work on the right.
pub(super) fn curves(all: &[&Curve], path: &Path) -> Result<(), ImageError> {
    let heights: Vec<f32> = all.iter().map(|curve| row_height(curve)).collect();
    let mut canvas = Canvas::new(WIDTH, whole(heights.iter().sum::<f32>().max(100.0)), GROUND)?;
    let mut top = 0.0;
    for (curve, height) in all.iter().zip(&heights) {
        row(&mut canvas, top, curve);
        top += height;
    }
    canvas.write_png(path)
}

/// Methods in the order in which they come.
fn methods(curve: &Curve) -> Vec<(&str, bool)> {
    let mut found: Vec<(&str, bool)> = Vec::new();
    for point in &curve.points {
        if !found.iter().any(|(name, _)| *name == point.method) {
            found.push((&point.method, point.own));
        }
    }
    found
}

const HEADING: f32 = 46.0;
const PANEL: f32 = 400.0;

fn row_height(curve: &Curve) -> f32 {
    HEADING + legend_height(curve) + PANEL + 92.0
}

fn legend_height(curve: &Curve) -> f32 {
    26.0 * position((methods(curve).len() + 1).div_ceil(4)) + 12.0
}

/// Where a panel is, the title of its costs, the costs, and who is on its front.
type Side<'t> = (f32, &'t str, fn(&Point) -> f64, fn(&Point) -> bool);

fn row(canvas: &mut Canvas, top: f32, curve: &Curve) {
    canvas.text(&plain(&format!("{}: {}", curve.name, curve.title)), [40.0, top + 34.0], 16.0, Anchor::Start, INK);
    let methods = methods(curve);
    let place = |index: usize| [110.0 + 375.0 * position(index % 4), top + HEADING + 14.0 + 26.0 * position(index / 4)];
    for (index, (name, own)) in methods.iter().enumerate() {
        let words = if *own { (*name).to_owned() } else { format!("{name} (compared)") };
        legend(canvas, place(index), (&words, LEGEND), COLOURS[index % COLOURS.len()]);
    }
    legend(canvas, place(methods.len()), ("Pareto front", LEGEND), INK);
    let start = top + HEADING + legend_height(curve);
    let panels: [Side<'_>; 2] = [
        (120.0, "seconds", |p| p.seconds, |p| p.front_seconds),
        (940.0, curve.operations.as_str(), |p| p.operations, |p| p.front_operations),
    ];
    for (left, title, cost, on_front) in panels {
        let shown = |p: &Point| [cost(p).clamp(1e-300, 1e300), p.error.clamp(curve.floor.max(LEAST), 1e300)];
        let x = limits(curve.points.iter().map(|p| shown(p)[0]), 1.6);
        let y = limits(curve.points.iter().map(|p| shown(p)[1]), 1.8);
        let axes = LogAxes::new([left, start, 640.0, PANEL], x, y);
        axes.draw(canvas, [title, &curve.error]);
        panel(canvas, &axes, curve, &methods, (&shown, &on_front));
    }
}

type Shown<'f> = (&'f dyn Fn(&Point) -> [f64; 2], &'f dyn Fn(&Point) -> bool);

fn panel(canvas: &mut Canvas, axes: &LogAxes, curve: &Curve, methods: &[(&str, bool)], (shown, front): Shown<'_>) {
    let mut on_front: Vec<&Point> = curve.points.iter().filter(|p| front(p)).collect();
    on_front.sort_by(|a, b| shown(a)[0].total_cmp(&shown(b)[0]));
    // A stair: what can be had for a cost.
    let mut stair: Vec<[f32; 2]> = Vec::new();
    for point in &on_front {
        let at = axes.point(shown(point));
        if let Some(&[_, y]) = stair.last() {
            stair.push([at[0], y]);
        }
        stair.push(at);
    }
    canvas.lines(&stair, 1.6, INK);
    for (index, (name, _)) in methods.iter().enumerate() {
        let colour = COLOURS[index % COLOURS.len()];
        let own: Vec<&Point> = curve.points.iter().filter(|p| p.method == *name).collect();
        let line: Vec<[f32; 2]> = own.iter().map(|p| axes.point(shown(p))).collect();
        canvas.lines(&line, 1.3, colour);
        for point in own {
            let at = axes.point(shown(point));
            if front(point) {
                canvas.lines(&[at, at], 13.0, INK);
            }
            canvas.lines(&[at, at], 8.5, colour);
        }
    }
    labels(canvas, axes, (&curve.points, &on_front), shown);
}

/// Names of settings on the front, as many as find room beside all points.
fn labels(
    canvas: &mut Canvas,
    axes: &LogAxes,
    (all, front): (&[Point], &[&Point]),
    shown: &dyn Fn(&Point) -> [f64; 2],
) {
    let [left, top, width, height] = axes.axes.frame;
    let mark = |point: &Point| {
        let [x, y] = axes.point(shown(point));
        [x - 6.0, y - 6.0, x + 6.0, y + 6.0]
    };
    let mut taken: Vec<[f32; 4]> = all.iter().map(mark).collect();
    for point in front {
        let [x, y] = axes.point(shown(point));
        let length = Canvas::text_width(&point.setting, SMALL);
        let tries =
            [[x + 10.0, y - 7.0], [x + 10.0, y + 17.0], [x - 10.0 - length, y + 17.0], [x - 10.0 - length, y - 7.0]];
        let found = tries.into_iter().find(|[x, y]| {
            let own = [*x - 3.0, *y - SMALL - 3.0, *x + length + 3.0, *y + 4.0];
            let inside = own[0] >= left && own[2] <= left + width && own[1] >= top && own[3] <= top + height;
            inside && taken.iter().all(|o| own[2] < o[0] || own[0] > o[2] || own[3] < o[1] || own[1] > o[3])
        });
        if let Some([x, y]) = found {
            taken.push([x - 3.0, y - SMALL - 3.0, x + length + 3.0, y + 4.0]);
            canvas.rectangle([x - 1.0, y - SMALL - 1.0, length + 2.0, SMALL + 3.0], GROUND);
            canvas.text(&point.setting, [x, y], SMALL, Anchor::Start, INK);
        }
    }
}

const SWEEP: [f32; 2] = [546.0, 420.0];

/// Draws sweeps, those of one name together: the domain shaded, the tolerance as a line.
pub(super) fn sweeps(all: &[Sweep], path: &Path) -> Result<(), ImageError> {
    let groups: Vec<&[Sweep]> = all.chunk_by(|a, b| a.name == b.name).collect();
    let rows = groups.len().div_ceil(3).max(1);
    let mut canvas = Canvas::new(WIDTH, whole(SWEEP[1] * position(rows)), GROUND)?;
    for (index, group) in groups.iter().enumerate() {
        let corner = [SWEEP[0] * position(index % 3), SWEEP[1] * position(index / 3)];
        sweep_panel(&mut canvas, corner, group);
    }
    canvas.write_png(path)
}

fn sweep_panel(canvas: &mut Canvas, [left, top]: [f32; 2], group: &[Sweep]) {
    let Some(first) = group.first() else { return };
    let points = || group.iter().flat_map(|s| &s.points);
    let drawn = |error: f64| if error.is_finite() { error.clamp(LEAST, 1e3) } else { 1e3 };
    let x = limits(points().map(|p| p[0]), 1.0);
    let tolerances = group.iter().filter_map(|s| s.domain.as_ref().map(|d| d.tolerance));
    let y = limits(points().map(|p| drawn(p[1])).chain(tolerances), 3.0);
    let axes = LogAxes::new([left + 112.0, top + 70.0, SWEEP[0] - 140.0, SWEEP[1] - 150.0], x, y);
    if let Some(domain) = &first.domain {
        let [from, to] = domain.range.map(|v| axes.point([v.clamp(x[0], x[1]), y[1]]));
        canvas.rectangle([from[0], from[1], to[0] - from[0], SWEEP[1] - 150.0], SHADE);
    }
    axes.draw(canvas, [&plain(&first.axis), &plain(&first.error)]);
    canvas.text(&plain(&first.name), [left + 30.0, top + 28.0], 11.5, Anchor::Start, INK);
    for (index, sweep) in group.iter().enumerate() {
        let colour = COLOURS[index % COLOURS.len()];
        let at = [left + 100.0 + 150.0 * position(index), top + 50.0];
        legend(canvas, at, (&sweep.precision, 13.0), colour);
        let line: Vec<[f32; 2]> = sweep.points.iter().map(|p| axes.point([p[0], drawn(p[1])])).collect();
        canvas.lines(&line, 2.0, colour);
        if let Some(domain) = &sweep.domain {
            let ends = domain.range.map(|v| axes.point([v.clamp(x[0], x[1]), domain.tolerance]));
            canvas.lines(&ends, 1.0, colour);
        }
    }
}

/// A text in letters that charts have.
fn plain(text: &str) -> String {
    text.replace('α', "alpha").replace('ρ', "rho").replace('−', "-")
}
