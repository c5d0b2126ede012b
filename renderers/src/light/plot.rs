//! A sheet for a light: its spectrum and that of the reference light, its chromaticity, and the test samples under both.

use std::path::Path;

use spectral_core::adaptation::Adaptation;
use spectral_core::cct::{PlanckianLocus, xyz_to_uv};
use spectral_core::colour::{linear_rgb_to_srgb8, rgb, xyz_to_linear_rgb};
use spectral_core::colour_rendering::Rendering;
use spectral_core::spectrum::RadiationConstant;
use spectral_core::summation::SumGrid;
use spectral_core::tables::observers::CIE_1931_2;

use super::LightReport;
use crate::image::chart::{Axes, GROUND, INK, legend};
use crate::image::{Anchor, Canvas, ImageError, Rgb8};

const WIDTH: usize = 1200;
const HEIGHT: usize = 800;
const LIGHT: Rgb8 = [200, 30, 30];
const REFERENCE: Rgb8 = [60, 90, 190];
const TEXT: f32 = 11.0;

/// Draws the sheet of a light as PNG.
///
/// Samples are drawn as an adapted eye sees them, in sRGB: each square has the test light on its left half and the reference
/// light on its right, both adapted to D65 by the linear Bradford transform; colours outside sRGB are clipped.
///
/// # Errors
/// [`ImageError::Io`] when the file can't be written.
pub fn plot(report: &LightReport, path: &Path) -> Result<(), ImageError> {
    let mut canvas = Canvas::new(WIDTH, HEIGHT, GROUND)?;
    canvas.text(&title(report), [40.0, 34.0], 15.0, Anchor::Start, INK);
    spectra(&mut canvas, report);
    chromaticity(&mut canvas, report);
    samples(&mut canvas, report);
    canvas.write_png(path)
}

fn title(report: &LightReport) -> String {
    let name = Path::new(&report.light).file_name().map_or_else(String::new, |n| n.to_string_lossy().into_owned());
    let worth = if report.cct_status == "valid" { String::new() } else { format!(" ({})", report.cct_status) };
    let index = report.ra.map_or_else(String::new, |ra| format!(", Ra {ra:.1}"));
    format!("{name}: {:.0} K{worth}, Duv {:+.4}{index}", report.cct, report.duv)
}

fn spectra(canvas: &mut Canvas, report: &LightReport) {
    let stages = &report.stages;
    let all = stages.light.iter().chain(stages.reference.iter().flatten());
    let top = all.copied().fold(0.0, f64::max);
    let axes = Axes { frame: [100.0, 70.0, 560.0, 300.0], x: [380.0, 780.0], y: [0.0, 1.05], text: TEXT };
    axes.draw(canvas, ["wavelength (nm)", "relative spectral power"], [6; 2]);
    let mut curve = |samples: &[f64], thickness: f32, colour: Rgb8| {
        let wavelengths =
            (0_u32..).map(|index| f64::from(report.grid.first) + f64::from(index) * f64::from(report.grid.step));
        let points: Vec<_> = wavelengths.zip(samples).map(|(nm, power)| axes.point(nm, power / top)).collect();
        canvas.lines(&points, thickness, colour);
    };
    if let Some(reference) = &stages.reference {
        curve(reference, 1.5, REFERENCE);
    }
    curve(&stages.light, 2.0, LIGHT);
    legend(canvas, [470.0, 84.0], ("light", TEXT), LIGHT);
    if let Some(reference) = &report.reference {
        let text = format!("{} {:.0} K", reference.kind, reference.temperature);
        legend(canvas, [470.0, 104.0], (&text, TEXT), REFERENCE);
    }
}

fn chromaticity(canvas: &mut Canvas, report: &LightReport) {
    let axes = Axes { frame: [780.0, 70.0, 380.0, 300.0], x: [0.0, 0.65], y: [0.0, 0.42], text: TEXT };
    axes.draw(canvas, ["u (CIE 1960)", "v (CIE 1960)"], [6; 2]);
    let grid = SumGrid::CIE_1NM;
    let observer = grid.observer::<f64>(&CIE_1931_2);
    // From 400 to 700 nm; beyond, the locus stands still.
    let mut outline: Vec<_> =
        observer[20..=320].iter().map(|&xyz| xyz_to_uv(xyz)).map(|[u, v]| axes.point(u, v)).collect();
    outline.extend(outline.first().copied());
    canvas.lines(&outline, 1.2, INK);
    let locus = PlanckianLocus::new(grid, &observer, RadiationConstant::Its1990);
    let uv = |temperature: f64| {
        let [u, v] = locus.uv(temperature);
        axes.point(u, v)
    };
    let planckian: Vec<_> = (1..=100).map(|step| uv(1e6 / (10.0 * f64::from(step)))).collect();
    canvas.lines(&planckian, 1.5, REFERENCE);
    for temperature in [1000.0, 2000.0, 4000.0, 10_000.0] {
        let [x, y] = uv(temperature);
        canvas.lines(&[[x, y - 4.0], [x, y + 4.0]], 1.2, REFERENCE);
        // Below the locus where it is level, to its right where it is steep.
        let at = if temperature < 2500.0 { [x - 8.0, y + 18.0] } else { [x + 8.0, y + 14.0] };
        canvas.text(&format!("{temperature:.0} K"), at, 8.0, Anchor::Start, REFERENCE);
    }
    let [x, y] = axes.point(report.uv[0], report.uv[1]);
    canvas.lines(&[[x - 7.0, y], [x + 7.0, y]], 2.0, LIGHT);
    canvas.lines(&[[x, y - 7.0], [x, y + 7.0]], 2.0, LIGHT);
}

fn samples(canvas: &mut Canvas, report: &LightReport) {
    let stages = &report.stages;
    let note = "samples: left half under the light, right half under the reference; below, the special indices";
    canvas.text(note, [40.0, 452.0], TEXT, Anchor::Start, INK);
    match (&stages.munsell, &stages.colorchecker) {
        (Some(munsell), Some(checker)) => {
            row(canvas, 484.0, "CIE 13.3, TCS01-14", munsell, report.r.as_ref().map(<[f64; 14]>::as_slice));
            row(canvas, 664.0, "ColorChecker and skin", checker, None);
        }
        _ => canvas.text("no reference light at this colour temperature", [40.0, 500.0], TEXT, Anchor::Start, INK),
    }
}

/// A row of samples, with R_i, if given, and CRI00_i below.
fn row<const M: usize>(canvas: &mut Canvas, top: f32, name: &str, rendering: &Rendering<f64, M>, ri: Option<&[f64]>) {
    const SIDE: f32 = 72.0;
    canvas.text(name, [40.0, top], TEXT, Anchor::Start, INK);
    let white = rgb::WHITE;
    let (test, reference) =
        (Adaptation::bradford(rendering.test.white, white), Adaptation::bradford(rendering.reference.white, white));
    let mut left = 100.0;
    for sample in 0..M {
        let colours =
            [test.apply(rendering.test.samples[sample]), reference.apply(rendering.reference.samples[sample])];
        for (half, xyz) in [0.0, 0.5].into_iter().zip(colours) {
            let colour = linear_rgb_to_srgb8(xyz_to_linear_rgb(xyz));
            canvas.rectangle([left + half * SIDE, top + 14.0, 0.5 * SIDE, SIDE], colour);
        }
        let middle = left + 0.5 * SIDE;
        let index = format!("{:.1}", rendering.special[sample]);
        let mut line = top + SIDE + 34.0;
        if let Some(ri) = ri.and_then(|ri| ri.get(sample)) {
            canvas.text(&format!("{ri:.1}"), [middle, line], TEXT, Anchor::Middle, INK);
            line += 20.0;
        }
        canvas.text(&index, [middle, line], TEXT, Anchor::Middle, INK);
        left += SIDE + 4.0;
    }
    let mut line = top + SIDE + 34.0;
    if ri.is_some() {
        canvas.text("Ri", [40.0, line], TEXT, Anchor::Start, INK);
        line += 20.0;
    }
    canvas.text("CRI00", [40.0, line], TEXT, Anchor::Start, INK);
}
