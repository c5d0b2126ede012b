//! Pictures of fits and of albedos.

use std::path::Path;

use spectral_core::brdf::Variant;

use super::data::direction;
use super::{Fit, FittedReading};
use crate::image::chart::{Axes, GROUND, INK, legend};
use crate::image::{Anchor, Canvas, ImageError, Rgb8, position, whole};

const DATA: Rgb8 = INK;
/// The height of capitals.
const TEXT: f32 = 13.0;
/// One for each of [`Variant::ALL`], and one for a density. Apart for dichromats, too: after Okabe and Ito (2008).
const COLOURS: [Rgb8; 5] = [[0, 114, 178], [230, 159, 0], [0, 158, 115], [213, 94, 0], [120, 120, 120]];
/// Frame of a small chart, with its numbers and titles.
const PANEL: [f32; 2] = [500.0, 340.0];
const COLUMNS: usize = 3;
/// Directions of light that one picture shows.
const MOST_PANELS: usize = 24;
/// Degrees between the points of curves.
const STEP: f64 = 0.1;

/// Draws readings against fitted models, a small chart with its own scale for each direction of light, as figure 2.16 of
/// the thesis does.
///
/// Across: the polar angle of the view in the plane of incidence, negative on the side of the light. Readings out of this
/// plane are counted, not drawn. All fits must be of the same readings.
///
/// # Errors
/// [`ImageError::Io`] when the file can't be written.
pub fn plot_fits(fits: &[(Variant, Fit)], path: &Path) -> Result<(), ImageError> {
    let readings = fits.first().map_or(&[][..], |(_, fit)| fit.readings.as_slice());
    let groups: Vec<_> = readings.chunk_by(|a, b| incidence(a) == incidence(b)).take(MOST_PANELS).collect();
    let rows = groups.len().div_ceil(COLUMNS);
    let [width, height] = PANEL;
    let heading = 40.0 + 26.0 * position(fits.len().div_ceil(2));
    let mut canvas =
        Canvas::new(whole(width * position(COLUMNS)), whole(heading + height * position(rows.max(1))), GROUND)?;
    for (index, (model, fit)) in fits.iter().enumerate() {
        let place = [40.0 + 740.0 * position(index % 2), 32.0 + 26.0 * position(index / 2)];
        legend(&mut canvas, place, (&summary(fit), TEXT), colour(*model));
    }
    for (index, group) in groups.iter().enumerate() {
        let corner = [width * position(index % COLUMNS), heading + height * position(index / COLUMNS)];
        panel(&mut canvas, corner, group, fits);
    }
    canvas.write_png(path)
}

fn summary(fit: &Fit) -> String {
    let alpha = if fit.alpha_u == fit.alpha_v {
        format!("alpha {:.5}", fit.alpha)
    } else {
        format!("alpha {:.5}, {:.5}", fit.alpha_u, fit.alpha_v)
    };
    format!("{}: rho_s {:.5}, {alpha}, residual {:.4}", fit.model, fit.rho_s, fit.residual)
}

fn incidence(reading: &FittedReading) -> [f64; 2] {
    [reading.theta_l_deg, reading.phi_l_deg]
}

/// The polar angle with a sign; `None` out of the plane of incidence.
fn signed_angle(reading: &FittedReading) -> Option<f64> {
    let turn = (reading.phi_v_deg - reading.phi_l_deg).rem_euclid(360.0);
    let near = |angle: f64| (turn - angle).abs() <= 1e-6;
    if reading.theta_v_deg == 0.0 || near(180.0) {
        return Some(reading.theta_v_deg);
    }
    (near(0.0) || near(360.0)).then_some(-reading.theta_v_deg)
}

fn panel(canvas: &mut Canvas, [left, top]: [f32; 2], group: &[FittedReading], fits: &[(Variant, Fit)]) {
    let Some(first) = group.first() else { return };
    let points: Vec<[f64; 2]> = group.iter().filter_map(|r| Some([signed_angle(r)?, r.value])).collect();
    let span = |low: f64, high: f64| if low < 0.0 { [-90.0, 90.0] } else { [0.0, high] };
    let x = span(points.iter().map(|p| p[0]).fold(0.0, f64::min), 90.0);
    let curves: Vec<_> = fits.iter().map(|(model, fit)| (*model, curve(*model, fit, first, x))).collect();
    // The models may be infinite at the horizon; the data and the highlights say what has to be seen.
    let before_horizon = |p: &&[f64; 2]| p[0].abs() <= 85.0;
    let highest = points.iter().chain(curves.iter().flat_map(|(_, c)| c.iter().filter(before_horizon))).map(|p| p[1]);
    let highest = highest.fold(0.0, f64::max);
    let y = [0.0, if highest > 0.0 { 1.06 * highest } else { 1.0 }];
    let axes = Axes { frame: [left + 92.0, top + 46.0, PANEL[0] - 122.0, PANEL[1] - 112.0], x, y, text: TEXT };
    axes.draw(canvas, ["view angle (°)", "BRDF (1/sr)"], [6, 5]);
    let hidden = group.len() - points.len();
    let note = if hidden == 0 { String::new() } else { format!(", {hidden} out of the plane") };
    let azimuth = if first.phi_l_deg == 0.0 { String::new() } else { format!(", azimuth {}°", first.phi_l_deg) };
    let title = format!("light from {}°{azimuth}{note}", first.theta_l_deg);
    canvas.text(&title, [left + 92.0, top + 32.0], TEXT, Anchor::Start, INK);
    for (model, curve) in &curves {
        axes.curve(canvas, curve, colour(*model));
    }
    for point in points {
        axes.dot(canvas, point, DATA);
    }
}

/// A fit in the plane of incidence.
fn curve(model: Variant, fit: &Fit, at: &FittedReading, [low, high]: [f64; 2]) -> Vec<[f64; 2]> {
    let light = direction(incidence(at));
    let mut points = Vec::new();
    let mut angle = low.max(-90.0 + STEP);
    // The horizon itself is left out: two models are infinite there.
    while angle < high - 0.5 * STEP {
        let view = direction([angle.abs(), at.phi_l_deg + if angle < 0.0 { 0.0 } else { 180.0 }]);
        points.push([angle, fit.evaluate(model, light, view)]);
        angle += STEP;
    }
    points
}

/// An albedo at increasing polar angles, and what to call it.
#[derive(Clone, Debug, PartialEq)]
pub struct AlbedoCurve {
    /// The model; `None` for the density of Ward's sampling.
    pub model: Option<Variant>,
    /// What the legend says.
    pub name: String,
    /// Polar angle of the light in degrees, and albedo.
    pub points: Vec<[f64; 2]>,
}

/// Draws albedos over the whole range of angles and, beside it, those from 80° on, as figures 2.12 and 2.13 of the thesis.
///
/// Curves of one model get different colours. What is above the charts' ranges is cut off: these end a little above 1, or
/// at 1.5 and 3 if an albedo is beyond.
///
/// # Errors
/// [`ImageError::Io`] when the file can't be written.
pub fn plot_albedo(curves: &[AlbedoCurve], path: &Path) -> Result<(), ImageError> {
    let lines = position(curves.len().div_ceil(3));
    let heading = 40.0 + 26.0 * lines;
    let mut canvas = Canvas::new(1500, whole(heading + 560.0), GROUND)?;
    let one_each = curves.iter().enumerate().all(|(i, c)| curves[..i].iter().all(|other| other.model != c.model));
    let colour_of = |index: usize, curve: &AlbedoCurve| match curve.model {
        None => COLOURS[4],
        Some(model) if one_each => colour(model),
        Some(_) => COLOURS[index % COLOURS.len()],
    };
    for (index, curve) in curves.iter().enumerate() {
        let place = [60.0 + 480.0 * position(index % 3), 32.0 + 26.0 * position(index / 3)];
        legend(&mut canvas, place, (&curve.name, TEXT), colour_of(index, curve));
    }
    let frames = [[92.0, heading + 20.0, 620.0, 450.0], [852.0, heading + 20.0, 610.0, 450.0]];
    let values = || curves.iter().flat_map(|curve| &curve.points).map(|point| point[1]);
    let (least, largest) = (values().fold(1.0, f64::min), values().fold(1.0, f64::max));
    let low = if least >= 0.5 { 0.5 } else { 0.0 };
    let tops = if largest <= 1.05 { [1.05; 2] } else { [1.5, 3.0] };
    for ((frame, x), top) in frames.into_iter().zip([[0.0, 90.0], [80.0, 90.0]]).zip(tops) {
        let axes = Axes { frame, x, y: [low, top], text: TEXT };
        axes.draw(&mut canvas, ["light angle (°)", "albedo"], [9, 6]);
        let one = [axes.point(x[0], 1.0), axes.point(x[1], 1.0)];
        canvas.lines(&one, 1.4, INK);
        for (index, curve) in curves.iter().enumerate() {
            let points: Vec<_> = curve.points.iter().filter(|p| p[0] >= x[0] && p[0] <= x[1]).copied().collect();
            axes.curve(&mut canvas, &points, colour_of(index, curve));
        }
    }
    canvas.write_png(path)
}

fn colour(model: Variant) -> Rgb8 {
    let place = Variant::ALL.iter().position(|&other| other == model).unwrap_or(0);
    COLOURS[place]
}
