//! Intervals over radiance and over the width of lines: does the certified bound hold, and is it reached?

use spectral_core::adaptive::{Evaluation, Mode, Piece, Target, evaluate};
use spectral_core::expression::{Op, Program};
use spectral_core::interval::{Domain, Interval, Pyramid, Weight, node_count};
use spectral_core::spectrum::{Line, Outside, PiecewiseLinear, Spectrum};
use spectral_core::tables::{colorchecker, illuminants};
use spectral_core::{Observer, Real};

use super::{Sweep, by_name, domain, powers, steps};
use crate::trade::plan::count;
use crate::verify::oracle::gauss_legendre;

const DEPTH: u8 = 8;
const THRESHOLD: f64 = 1.0;
/// Lines of a base up to this in nm are as good as at one wavelength: the rest is their squared width.
const NARROW: f64 = 1e-6;

/// All sweeps of intervals.
pub(super) fn sweeps(quick: bool) -> Result<Vec<Sweep>, String> {
    let steps = steps(quick);
    let mut all = radiance::<f32>("f32", steps)?;
    all.extend(radiance::<f64>("f64", steps)?);
    all.push(widths::<f32>("f32", steps)?);
    all.push(widths::<f64>("f64", steps)?);
    Ok(by_name(all))
}

/// The colour of a light on a paint, in one precision.
fn colour<R: Real>(light: &impl Spectrum<R>, paint: &impl Spectrum<R>, white: [R; 3]) -> Result<Evaluation<R>, String> {
    let mut weights = vec![Weight::default(); node_count(DEPTH)];
    let domain = Domain::build(Observer::<R>::cie_1931_2deg(), DEPTH, &mut weights).map_err(|e| e.to_string())?;
    let mut buffers = [vec![Interval::zero(); node_count(DEPTH)], vec![Interval::zero(); node_count(DEPTH)]];
    let [first, second] = &mut buffers;
    let leaves = [
        Pyramid::build(light, &domain, first).map_err(|e| e.to_string())?,
        Pyramid::build(paint, &domain, second).map_err(|e| e.to_string())?,
    ];
    let ops = [Op::Leaf(0), Op::Leaf(1), Op::Product];
    let program = Program::new(&ops).map_err(|e| e.to_string())?;
    let target = Target { mode: Mode::Certified, threshold: R::from_f64(THRESHOLD), white };
    let (mut stack, mut pieces) = ([Interval::zero(); 2], vec![Piece::default(); 512]);
    evaluate(&program, &domain, &target, &mut leaves.as_slice(), &mut stack, &mut pieces).map_err(|e| e.to_string())
}

/// ∫ S₁ S₂ ā of spectra that are linear between the nodes given and whole nanometres.
fn exact(light: &dyn Spectrum<f64>, paint: &dyn Spectrum<f64>, nodes: &[f64]) -> [f64; 3] {
    let mut all: Vec<f64> = (380..=780).map(f64::from).collect();
    all.extend(nodes.iter().filter(|w| **w > 380.0 && **w < 780.0));
    all.sort_by(f64::total_cmp);
    all.dedup();
    let (observer, rule) = (Observer::<f64>::cie_1931_2deg(), gauss_legendre(3));
    let mut sum = [0.0; 3];
    for pair in all.windows(2) {
        for &(node, weight) in &rule {
            let wavelength = pair[0] + (pair[1] - pair[0]) * node;
            let value = light.value(wavelength) * paint.value(wavelength) * weight * (pair[1] - pair[0]);
            let matching = observer.value(wavelength);
            sum = core::array::from_fn(|a| sum[a] + value * matching[a]);
        }
    }
    sum
}

/// How far tristimulus values are off, as a share of the radius that they are said to be within.
fn share<R: Real>(found: &Evaluation<R>, truth: [f64; 3]) -> f64 {
    let one = |a: usize| {
        let (off, radius) = ((found.xyz[a].to_f64() - truth[a]).abs(), found.radius[a].to_f64());
        // An infinite radius, or one that is none, says that nothing is known: it holds.
        if !radius.is_finite() || off <= 0.0 { 0.0 } else { off / radius }
    };
    (0..3).map(one).fold(0.0, |m, s| if s > m || s.is_nan() { s } else { m })
}

fn table<R: Real>(table: &spectral_core::tables::UniformTable) -> (Vec<R>, Vec<R>) {
    let found = crate::trade::products::tabulated(table);
    let cast = |values: Vec<f64>| values.into_iter().map(R::from_f64).collect();
    (cast(found.wavelengths), cast(found.values))
}

/// D65 on green over sixty orders of magnitude of radiance, the white along with it.
fn radiance<R: Real>(kind: &str, steps: i32) -> Result<Vec<Sweep>, String> {
    let ((wavelengths, values), (own, paint)) = (table::<R>(&illuminants::D65), table::<R>(&colorchecker::GREEN));
    let paint = PiecewiseLinear::new(&own, &paint, Outside::Hold).map_err(|e| e.to_string())?;
    let run = |scale: f64| {
        // At 560 nm the radiance is `scale`.
        let scaled: Vec<R> = values.iter().map(|v| *v * R::from_f64(scale / 100.0)).collect();
        let light = PiecewiseLinear::new(&wavelengths, &scaled, Outside::Zero).ok()?;
        let white =
            spectral_core::tristimulus(&Observer::cie_1931_2deg(), &light, R::from_f64(380.0), R::from_f64(780.0));
        let found = colour(&light, &paint, white).ok()?;
        let [nodes, wide] = [&wavelengths, &scaled].map(|v| v.iter().map(|x| x.to_f64()).collect::<Vec<_>>());
        let wide_light = PiecewiseLinear::new(&nodes, &wide, Outside::Zero).ok()?;
        let (own, values): (Vec<f64>, Vec<f64>) = table(&colorchecker::GREEN);
        let values: Vec<f64> = values.iter().map(|v| R::from_f64(*v).to_f64()).collect();
        let wide_paint = PiecewiseLinear::new(&own, &values, Outside::Hold).ok()?;
        Some((found, exact(&wide_light, &wide_paint, &nodes)))
    };
    let places = powers(-30, 30, steps);
    let holds = "spectral_core::interval: bounds hold for the computed numbers, in f32 and in f64, also where numbers underflow; where they \
                 overflow, radii become infinite or NaN, never too small";
    let bound = Sweep::new(
        ["certified bound over radiance", kind, "radiance at 560 nm", "error over radius"],
        domain([1e-30, 1e30], 1.0, holds),
        &places,
        |scale| run(scale).map(|(found, truth)| share(&found, truth)),
    );
    let reached = Sweep::new(
        ["ΔE bound that is reached over radiance", kind, "radiance at 560 nm", "ΔE bound, 1 asked for"],
        None,
        &places,
        |scale| run(scale).map(|(found, _)| found.delta_e.to_f64()),
    );
    let errors = Sweep::new(
        ["error of the certified colour over radiance", kind, "radiance at 560 nm", "relative error of Y"],
        None,
        &places,
        |scale| run(scale).map(|(found, truth)| found.xyz[1].to_f64() / truth[1] - 1.0),
    );
    Ok(vec![bound, reached, errors])
}

/// A line of one unit of power at 589.3 nm on green.
fn widths<R: Real>(kind: &str, steps: i32) -> Result<Sweep, String> {
    let (own, values) = table::<R>(&colorchecker::GREEN);
    let paint = PiecewiseLinear::new(&own, &values, Outside::Hold).map_err(|e| e.to_string())?;
    let (wide_nodes, wide_values): (Vec<f64>, Vec<f64>) =
        (own.iter().map(|x| x.to_f64()).collect(), values.iter().map(|x| x.to_f64()).collect());
    let wide_paint = PiecewiseLinear::new(&wide_nodes, &wide_values, Outside::Hold).map_err(|e| e.to_string())?;
    let source = "spectral_core::interval: bounds hold for the computed numbers; Line::new refuses widths that its type can't hold";
    let places: Vec<f64> = powers(-13, 2, steps);
    Ok(Sweep::new(
        ["certified bound over the width of a line", kind, "width of the line's base (nm)", "error over radius"],
        domain([1e-13, 100.0], 1.0, source),
        &places,
        |width| {
            let centre = R::from_f64(589.3);
            let line = Line::new(centre, R::from_f64(width), R::ONE).ok()?;
            let white = unit_white::<R>();
            let found = colour(&line, &paint, white).ok()?;
            // The triangle that the type really holds: its corners are rounded.
            let half = R::from_f64(width) * R::HALF;
            let corners = [centre - half, centre, centre + half].map(Real::to_f64);
            let peak = line.peak().to_f64();
            if width < NARROW {
                // Nodes of a rule would fall together. The paint and the observer are linear within the line, but for squares of its width.
                let (area, middle) = ((corners[2] - corners[0]) * peak / 2.0, corners.iter().sum::<f64>() / 3.0);
                let matching = Observer::<f64>::cie_1931_2deg().value(middle);
                return Some(share(&found, matching.map(|m| area * wide_paint.value(middle) * m)));
            }
            let triangle = [0.0, peak, 0.0];
            let wide = PiecewiseLinear::new(&corners, &triangle, Outside::Zero).ok()?;
            Some(share(&found, exact(&wide, &wide_paint, &corners)))
        },
    ))
}

/// The white of a line of power 1: that of a flat light of a mean of 1/400 over the visible range.
fn unit_white<R: Real>() -> [R; 3] {
    [1.0; 3].map(|w: f64| R::from_f64(w * crate::spectral::Y_INTEGRAL / count(400)))
}
