//! Spectra, and their integrals with colour-matching functions.

use spectral_core::spectrum::{
    Constant, Daylight, Line, Lines, Outside, PiecewiseLinear, Planck, RadiationConstant, Rounding, Scaled, Uniform,
};
use spectral_core::tables::{self, UniformTable, illuminants, observers};
use spectral_core::{Observer, Real, Spectrum, tristimulus};

use crate::accuracy::gauge::{Axis, Gauge};
use crate::accuracy::lines::{Polyline, integral};
use crate::accuracy::wide::{Wide, wide, wides};

/// Seven nodes at irregular distances, in quarters of nm, and values of no sign.
const WAVELENGTHS: [f64; 7] = [380.0, 401.25, 450.0, 451.0, 520.75, 700.5, 779.0];
const VALUES: [f64; 7] = [0.125, 0.8, 0.05, 0.9, 0.9, 0.001, 0.3];

fn wavelength(edges: &[f64]) -> Axis {
    Axis::linear("λ", 350.0, 800.0).edges(edges)
}

/// A spectrum's value, the start of its segment, and that segments advance.
fn measure<R: Real>(gauge: &mut Gauge, edges: &[f64], spectrum: &impl Spectrum<R>, exact: impl Fn(Wide) -> Wide) {
    gauge.each(&[wavelength(edges)], |gauge, [w]: [R; 1]| {
        gauge.compare(spectrum.value(w), exact(wide(w)));
        gauge.require(spectrum.segment(w).end > w);
    });
}

/// The start and the end of the segment at a wavelength; `exact` is continuous but at the ends of the nodes.
fn measure_segment<R: Real>(
    gauge: &mut Gauge,
    edges: &[f64],
    spectrum: &impl Spectrum<R>,
    exact: impl Fn(Wide) -> Wide,
) {
    let last = edges.iter().fold(0.0_f64, |m, x| m.max(*x));
    gauge.each(&[wavelength(edges)], |gauge, [w]: [R; 1]| {
        let segment = spectrum.segment(w);
        gauge.require(segment.end > w);
        // At the last node the segment is the one beyond it.
        if wide(w) != last {
            gauge.compare(segment.first, exact(wide(w)));
        }
        let end = segment.end.to_f64();
        if end.is_finite() && end > edges[0] {
            gauge.compare(segment.last, exact(end.into()));
        }
    });
}

fn samples<R: Real>() -> ([R; 7], [R; 7], Polyline) {
    let (wavelengths, values) = (WAVELENGTHS.map(R::from_f64), VALUES.map(R::from_f64));
    (wavelengths, values, Polyline::new(WAVELENGTHS.to_vec(), wides(values).to_vec(), true))
}

/// Irregular nodes.
pub fn piecewise_value<R: Real>(gauge: &mut Gauge) {
    let (wavelengths, values, line) = samples::<R>();
    let Ok(spectrum) = PiecewiseLinear::new(&wavelengths, &values, Outside::Hold) else { return gauge.require(false) };
    measure(gauge, &WAVELENGTHS, &spectrum, |w| line.value(w));
}

/// Irregular nodes.
pub fn piecewise_segment<R: Real>(gauge: &mut Gauge) {
    let (wavelengths, values, line) = samples::<R>();
    let Ok(spectrum) = PiecewiseLinear::new(&wavelengths, &values, Outside::Hold) else { return gauge.require(false) };
    measure_segment(gauge, &WAVELENGTHS, &spectrum, |w| line.value(w));
}

fn uniform<R: Real>(values: &[R; 7]) -> Option<(Uniform<'_, R>, Vec<f64>, Polyline)> {
    let nodes: Vec<f64> = (0..7).map(|i| 385.0 + 62.5 * f64::from(i)).collect();
    let spectrum = Uniform::new(R::from_f64(385.0), R::from_f64(62.5), values, Outside::Hold).ok()?;
    Some((spectrum, nodes.clone(), Polyline::new(nodes, wides(*values).to_vec(), true)))
}

/// Equal steps.
pub fn uniform_value<R: Real>(gauge: &mut Gauge) {
    let (_, values, _) = samples::<R>();
    let Some((spectrum, nodes, line)) = uniform(&values) else { return gauge.require(false) };
    measure(gauge, &nodes, &spectrum, |w| line.value(w));
}

/// Equal steps.
pub fn uniform_segment<R: Real>(gauge: &mut Gauge) {
    let (_, values, _) = samples::<R>();
    let Some((spectrum, nodes, line)) = uniform(&values) else { return gauge.require(false) };
    measure_segment(gauge, &nodes, &spectrum, |w| line.value(w));
}

/// One value.
pub fn constant_segment<R: Real>(gauge: &mut Gauge) {
    let Ok(spectrum) = Constant::new(R::from_f64(0.7)) else { return gauge.require(false) };
    measure(gauge, &[500.0], &spectrum, |_| wide(R::from_f64(0.7)));
}

/// A spectrum times a number.
fn scaled<R: Real>(values: &[R; 7]) -> Option<(Scaled<Uniform<'_, R>, R>, Vec<f64>, Polyline)> {
    let (spectrum, nodes, line) = uniform(values)?;
    Some((Scaled::new(spectrum, R::from_f64(0.3)).ok()?, nodes, line))
}

/// A spectrum times a number.
pub fn scaled_value<R: Real>(gauge: &mut Gauge) {
    let (_, values, _) = samples::<R>();
    let Some((spectrum, nodes, line)) = scaled(&values) else { return gauge.require(false) };
    measure(gauge, &nodes, &spectrum, |w| line.value(w) * wide(R::from_f64(0.3)));
}

/// A spectrum times a number.
pub fn scaled_segment<R: Real>(gauge: &mut Gauge) {
    let (_, values, _) = samples::<R>();
    let Some((spectrum, nodes, line)) = scaled(&values) else { return gauge.require(false) };
    measure_segment(gauge, &nodes, &spectrum, |w| line.value(w) * wide(R::from_f64(0.3)));
}

/// A triangle whose corners are as the documentation rounds them.
fn triangle<R: Real>(centre: R, width: R, power: R) -> impl Fn(Wide) -> Wide {
    let half = width * R::HALF;
    let (low, centre, high) = (wide(centre - half), wide(centre), wide(centre + half));
    let peak = wide(power) * 2.0 / (high - low);
    move |w| {
        if w <= low || w >= high {
            Wide::ZERO
        } else if w < centre {
            peak * ((w - low) / (centre - low))
        } else {
            peak * ((high - w) / (high - centre))
        }
    }
}

/// A line at 589.3 nm, 3.7 nm wide.
pub fn line_segment<R: Real>(gauge: &mut Gauge) {
    let [centre, width, power] = [589.3, 3.7, 2.3].map(R::from_f64);
    let Ok(line) = Line::new(centre, width, power) else { return gauge.require(false) };
    measure(gauge, &[587.45, 589.3, 591.15, 588.0, 590.7], &line, triangle(centre, width, power));
}

/// The largest value.
pub fn line_peak<R: Real>(gauge: &mut Gauge) {
    let axes = [Axis::linear("centre", 300.0, 900.0), Axis::log("width", 0.1, 50.0), Axis::log("power", 1e-3, 1e3)];
    gauge.each(&axes, |gauge, [centre, width, power]: [R; 3]| {
        let Ok(line) = Line::new(centre, width, power) else { return gauge.require(false) };
        gauge.compare(line.peak(), triangle(centre, width, power)(wide(centre)));
    });
}

const CENTRES: [f64; 3] = [450.0, 452.5, 600.0];
const POWERS: [f64; 3] = [1.0, 0.3, 2.0];
const CORNERS: [f64; 9] = [445.0, 450.0, 455.0, 447.5, 452.5, 457.5, 595.0, 600.0, 605.0];

fn lines<R: Real>(each: impl FnOnce(&Lines<'_, R>, &dyn Fn(Wide) -> Wide)) {
    let (centres, powers, width) = (CENTRES.map(R::from_f64), POWERS.map(R::from_f64), R::from_f64(10.0));
    if let Ok(lines) = Lines::new(&centres, &powers, width) {
        let parts: [_; 3] = core::array::from_fn(|i| triangle(centres[i], width, powers[i]));
        each(&lines, &|w| parts.iter().fold(Wide::ZERO, |sum, part| sum + part(w)));
    }
}

/// Three lines, two of which overlap.
pub fn lines_value<R: Real>(gauge: &mut Gauge) {
    lines::<R>(|lines, exact| measure(gauge, &CORNERS, lines, exact));
}

/// Three lines, two of which overlap.
pub fn lines_segment<R: Real>(gauge: &mut Gauge) {
    lines::<R>(|lines, exact| measure_segment(gauge, &CORNERS, lines, exact));
}

/// 2 h c² λ⁻⁵/(exp(c₂/(λT)) − 1) of the SI's exact h, c and k, with λ in nm; and c₂/(λT).
fn planck(wavelength: Wide, temperature: Wide, c2: Wide) -> (Wide, Wide) {
    let (h, c) = (Wide::decimal("6.62607015e-34"), Wide::from(299_792_458.0));
    let metres = wavelength * Wide::decimal("1e-9");
    let argument = c2 / (metres * temperature);
    (h * c * c * 2.0 / metres.powi(5) / argument.exp_m1() * Wide::decimal("1e-9"), argument)
}

/// c₂ of 2019 to its ten digits, as the core has it.
fn c2() -> Wide {
    Wide::decimal("1.438776877e-2")
}

/// Planck's law.
pub fn planck_radiance<R: Real>(gauge: &mut Gauge) {
    let axes = [Axis::log("λ", 30.0, 1e9).list(&[555.0]), Axis::log("T", 30.0, 1e6).list(&[2856.0, 6500.0])];
    gauge.each(&axes, |gauge, [w, t]: [R; 2]| {
        let Ok(body) = Planck::new(t, RadiationConstant::Si2019) else { return gauge.require(false) };
        let (exact, argument) = planck(wide(w), wide(t), c2());
        if exact > R::MIN_POSITIVE.to_f64() {
            gauge.compare_to(body.radiance(w), exact, exact * (argument + 1.0));
        }
    });
}

/// Linear between whole nanometres.
pub fn planck_segment<R: Real>(gauge: &mut Gauge) {
    let axes = [Axis::linear("λ", 380.0, 780.0).edges(&[500.0]), Axis::log("T", 1000.0, 25_000.0)];
    gauge.each(&axes, |gauge, [w, t]: [R; 2]| {
        let Ok(body) = Planck::new(t, RadiationConstant::Si2019) else { return gauge.require(false) };
        let start = w.to_f64().floor();
        let [(first, argument), (last, _)] = [start, start + 1.0].map(|w| planck(w.into(), wide(t), c2()));
        let exact = first + (last - first) * (wide(w) - start);
        gauge.compare_to(body.segment(w).first, exact, exact * (argument + 1.0));
    });
}

/// x, y, M₁, M₂ of CIE 15:2004, section 3.
pub(super) fn daylight(temperature: Wide) -> ([Wide; 2], [Wide; 2]) {
    let d = Wide::decimal;
    let inverse = 1000.0 / temperature;
    let x = if temperature <= 7000.0 {
        d("-4.6070") * inverse.powi(3) + d("2.9678") * inverse.squared() + d("0.09911") * inverse + d("0.244063")
    } else {
        d("-2.0064") * inverse.powi(3) + d("1.9018") * inverse.squared() + d("0.24748") * inverse + d("0.237040")
    };
    let y = d("-3.000") * x * x + d("2.870") * x - d("0.275");
    let m = d("0.0241") + d("0.2562") * x - d("0.7341") * y;
    let m1 = (d("-1.3515") - d("1.7703") * x + d("5.9114") * y) / m;
    let m2 = (d("0.0300") - d("31.4424") * x + d("30.0717") * y) / m;
    ([x, y], [m1, m2])
}

fn temperature() -> Axis {
    Axis::linear("T", 4000.0, 25_000.0).edges(&[7000.0]).list(&[5000.0, 6500.0])
}

/// Chromaticities of daylight.
pub fn daylight_chromaticity<R: Real>(gauge: &mut Gauge) {
    gauge.each(&[temperature()], |gauge, [t]: [R; 1]| {
        let Ok(light) = Daylight::new(t, Rounding::None) else { return gauge.require(false) };
        gauge.compare_all(light.chromaticity(), daylight(wide(t)).0);
    });
}

/// M₁ and M₂, which pass through zero: in ULP of 1.
pub fn daylight_factors<R: Real>(gauge: &mut Gauge) {
    gauge.each(&[temperature()], |gauge, [t]: [R; 1]| {
        let Ok(light) = Daylight::new(t, Rounding::None) else { return gauge.require(false) };
        for (got, exact) in light.factors().into_iter().zip(daylight(wide(t)).1) {
            gauge.compare_to(got, exact, Wide::ONE.max(exact.abs()));
        }
    });
}

/// Temperatures times 1.4388/1.4380.
pub fn daylight_nominal<R: Real>(gauge: &mut Gauge) {
    gauge.each(&[Axis::linear("T", 4000.0, 24_900.0).list(&[6500.0])], |gauge, [t]: [R; 1]| {
        let Ok(light) = Daylight::nominal(t, Rounding::None) else { return gauge.require(false) };
        gauge.compare_all(light.chromaticity(), daylight(wide(t) * 14_388.0 / 14_380.0).0);
    });
}

/// S₀ + M₁S₁ + M₂S₂, in ULP of the three terms.
fn measure_daylight<R: Real>(gauge: &mut Gauge, value: impl Fn(&Daylight<R>, R) -> R) {
    let basis =
        [&tables::daylight::S0, &tables::daylight::S1, &tables::daylight::S2].map(|t| Polyline::of_table(t, false));
    let wavelength = Axis::linear("λ", 300.0, 829.9).edges(&[380.0, 560.0, 780.0]);
    gauge.each(&[wavelength, temperature()], |gauge, [w, t]: [R; 2]| {
        let Ok(light) = Daylight::new(t, Rounding::None) else { return gauge.require(false) };
        let [m1, m2] = daylight(wide(t)).1;
        let [a, b, c] = basis.each_ref().map(|line| line.value(wide(w)));
        let scale = a.abs() + (m1.abs() + 1.0) * b.abs() + (m2.abs() + 1.0) * c.abs();
        gauge.compare_to(value(&light, w), a + m1 * b + m2 * c, scale);
    });
}

/// The spectrum of daylight.
pub fn daylight_value<R: Real>(gauge: &mut Gauge) {
    measure_daylight::<R>(gauge, Spectrum::value);
}

/// The spectrum of daylight.
pub fn daylight_segment<R: Real>(gauge: &mut Gauge) {
    measure_daylight::<R>(gauge, |light, w| light.segment(w).first);
}

/// x̄, ȳ, z̄ between the table's nodes.
pub fn observer_value<R: Real>(gauge: &mut Gauge) {
    gauge.note("1931 and 1964");
    let both =
        [(Observer::cie_1931_2deg(), &observers::CIE_1931_2), (Observer::cie_1964_10deg(), &observers::CIE_1964_10)];
    for (observer, table) in both {
        let lines = Polyline::of_observer(table);
        let axis = Axis::linear("λ", 350.0, 840.0).edges(&[360.0, 555.0, 830.0]);
        gauge.each(&[axis], |gauge, [w]: [R; 1]| {
            for (got, line) in observer.value(w).into_iter().zip(&lines) {
                gauge.compare(got, line.value(wide(w)));
            }
        });
    }
}

/// Lights of all kinds, with lines and without.
pub(super) const LIGHTS: [&UniformTable; 5] = [
    &illuminants::D65,
    &illuminants::A,
    &tables::fluorescent::FL2,
    &tables::fluorescent::FL11,
    &tables::high_pressure::HP1,
];

/// ∫ S ā over any part of the spectrum, for non-negative spectra.
pub fn integrals<R: Real>(gauge: &mut Gauge) {
    gauge.note("D65, A, FL2, FL11, HP1");
    gauge.effort(0.05);
    let (observer, lines) = (Observer::<R>::cie_1931_2deg(), Polyline::of_observer(&observers::CIE_1931_2));
    for table in LIGHTS {
        let (spectrum, light) = (table.spectrum::<R>(Outside::Zero), Polyline::of_table(table, false));
        let limits =
            [Axis::linear("from", 380.0, 600.0).list(&[500.0]), Axis::log("width", 0.01, 180.0).list(&[180.0])];
        gauge.each(&limits, |gauge, [from, width]: [R; 2]| {
            let to = from + width;
            let exact = lines.each_ref().map(|cmf| integral(&[&light, cmf], [from.to_f64(), to.to_f64()]));
            gauge.compare_all(tristimulus(&observer, &spectrum, from, to), exact);
        });
    }
}
