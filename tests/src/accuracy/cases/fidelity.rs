//! Colour fidelity and gamut, R_f and R_g, in 106 bits.

use spectral_core::Real;
use spectral_core::colour_rendering as rendering;
use spectral_core::light::{self, FidelityMeter};
use spectral_core::spectrum::RadiationConstant;
use spectral_core::summation::{DirectColours, TestColours};
use spectral_core::tables::observers;

use super::lights::{
    Colour, GRID, LAMPS, Lit, N, Sums, black_body, daylight_power, exact_light, lights, locus, nearest, reflectances,
    uv,
};
use crate::accuracy::gauge::{Axis, Gauge};
use crate::accuracy::wide::{Wide, apply, inverse, wide};

/// CAM02-UCS in the conditions of CIE 224 (CIE 159:2004; Luo, Cui and Li 2006).
fn cam02(white: Colour, xyz: Colour) -> Colour {
    let d = Wide::decimal;
    let row = |texts: [&str; 3]| texts.map(Wide::decimal);
    let cat = [
        row(["0.7328", "0.4296", "-0.1624"]),
        row(["-0.7036", "1.6975", "0.0061"]),
        row(["0.0030", "0.0136", "0.9834"]),
    ];
    let hpe = [row(["0.38971", "0.68898", "-0.07868"]), row(["-0.22981", "1.18340", "0.04641"]), row(["0", "0", "1"])];
    let k = 1.0 / Wide::from(501.0);
    let level = k.powi(4) * 500.0 / 5.0 + (1.0 - k.powi(4)).squared() * Wide::from(500.0).cbrt() / 10.0;
    let induction = d("0.725") * Wide::from(5.0).powf(d("0.2"));
    let base = d("1.48") + d("0.2").sqrt();
    let scale = apply(&cat, white);
    let respond = |xyz: Colour| {
        let cones = apply(&cat, xyz);
        let adapted = core::array::from_fn(|i| cones[i] / scale[i] * 100.0);
        apply(&hpe, apply(&inverse(&cat), adapted)).map(|c| {
            let power = (level * c.abs() / 100.0).powf(d("0.42"));
            let compressed = power * 400.0 / (power + d("27.13"));
            (if c < 0.0 { -compressed } else { compressed }) + d("0.1")
        })
    };
    let achromatic = |[r, g, b]: Colour| (r * 2.0 + g + b / 20.0 - d("0.305")) * induction;
    let [r, g, b] = respond(xyz);
    let (x, y) = (r - g * 12.0 / 11.0 + b / 11.0, (r + g - b * 2.0) / 9.0);
    let hue = y.atan2(x);
    let eccentricity = ((hue + 2.0).cos() + d("3.8")) / 4.0;
    let t = Wide::from(50_000.0) / 13.0 * induction * eccentricity * x.hypot(y) / (r + g + b * 21.0 / 20.0);
    let lightness = (achromatic([r, g, b]) / achromatic(respond(white))).powf(d("0.69") * base) * 100.0;
    let contrast = (d("1.64") - d("0.29").powf(d("0.2"))).powf(d("0.73"));
    let chroma = t.powf(d("0.9")) * (lightness / 100.0).sqrt() * contrast;
    let colourfulness = chroma * level.sqrt().sqrt();
    let compressed = (d("0.0228") * colourfulness + 1.0).ln() / d("0.0228");
    let lightness = d("1.7") * lightness / (d("0.007") * lightness + 1.0);
    [lightness, compressed * hue.cos(), compressed * hue.sin()]
}

/// R_f and R_g.
fn exact_fidelity(test: &Lit, reference: &Lit) -> [Wide; 2] {
    let place = |lit: &Lit| lit.samples.iter().map(|xyz| cam02(lit.white, *xyz)).collect::<Vec<_>>();
    let (a, b) = (place(test), place(reference));
    let difference =
        |(p, q): (&Colour, &Colour)| (0..3).fold(Wide::ZERO, |sum, i| sum + (p[i] - q[i]).squared()).sqrt();
    let sum = a.iter().zip(&b).map(difference).fold(Wide::ZERO, |sum, d| sum + d);
    let linear = 100.0 - Wide::decimal("6.73") * sum / a.len() as f64;
    let rf = ((linear / 10.0).exp() + 1.0).ln() * 10.0;
    let mut corners = [[[Wide::ZERO; 2]; 16]; 2];
    let mut counts = [0.0; 16];
    for (p, q) in a.iter().zip(&b) {
        let turn = q[2].atan2(q[1]) / (Wide::PI * 2.0);
        let turn = if turn < 0.0 { turn + 1.0 } else { turn };
        let sector = (turn * 16.0).to_f64() as usize % 16;
        counts[sector] += 1.0;
        for (corners, colour) in corners.iter_mut().zip([p, q]) {
            corners[sector][0] += colour[1];
            corners[sector][1] += colour[2];
        }
    }
    let area = |corners: &[[Wide; 2]; 16]| {
        let at = |s: usize| corners[s % 16].map(|sum| sum / counts[s % 16]);
        (0..16).fold(Wide::ZERO, |sum, s| sum + at(s)[0] * at(s + 1)[1] - at(s)[1] * at(s + 1)[0])
    };
    [rf, area(&corners[0]) / area(&corners[1]) * 100.0]
}

/// R_f and R_g from given tristimulus values.
pub fn fidelity<R: Real>(gauge: &mut Gauge) {
    gauge.note(LAMPS);
    let (observer, samples) =
        (GRID.observer::<R>(&observers::CIE_1964_10), rendering::colour_evaluation_samples::<R>());
    let colours = DirectColours::new(GRID, &observer, &samples);
    let (narrow, sums) = (Sums::new(), Sums::of(&observers::CIE_1964_10));
    for light in lights::<R>() {
        let exact = exact_light(&light);
        let Some((temperature, _)) = nearest(&narrow, uv(narrow.xyz(&exact))) else { return gauge.require(false) };
        let reference = blended(&sums, temperature);
        let reference = core::array::from_fn(|i| R::from_f64(reference[i].to_f64()));
        let (Some(test), Some(reference)) = (colours.illuminate(&light), colours.illuminate(&reference)) else {
            return gauge.require(false);
        };
        let (found, exact) =
            (rendering::fidelity(&test, &reference), exact_fidelity(&Lit::of(&test), &Lit::of(&reference)));
        gauge.compare(found.rf, exact[0]);
        gauge.compare(found.rg, exact[1]);
    }
}

/// A black body to 4000 K, daylight from 5000 K, a blend of equal luminances between.
fn blended(wide_sums: &Sums, temperature: Wide) -> Vec<Wide> {
    let of = |power: Vec<Wide>| {
        let y = wide_sums.xyz(&power)[1];
        power.into_iter().map(|p| p / y).collect::<Vec<_>>()
    };
    let share = (temperature - 4000.0) / 1000.0;
    if share <= 0.0 {
        return of(black_body(temperature));
    }
    let day = of(daylight_power(temperature));
    if share >= 1.0 {
        return day;
    }
    of(black_body(temperature)).into_iter().zip(day).map(|(p, d)| p * (1.0 - share) + d * share).collect()
}

/// The blend.
pub fn fidelity_reference<R: Real>(gauge: &mut Gauge) {
    gauge.effort(0.1);
    let (locus, observer) = (locus::<R>(), GRID.observer::<R>(&observers::CIE_1964_10));
    let sums = Sums::of(&observers::CIE_1964_10);
    let axes = [Axis::linear("T", 1000.0, 25_000.0).edges(&[4000.0, 5000.0]).list(&[4500.0])];
    gauge.each(&axes, |gauge, [t]: [R; 1]| {
        let Some(found) = rendering::fidelity_reference(t, GRID, &locus, &observer) else {
            return gauge.require(false);
        };
        let exact = blended(&sums, wide(t));
        let largest = exact.iter().fold(Wide::ZERO, |m, x| m.max(*x));
        for (got, exact) in found.into_iter().zip(exact) {
            gauge.compare_to(got, exact, largest);
        }
    });
}

/// Calls for each lamp with exact R_f and R_g.
fn each_fidelity<R: Real>(gauge: &mut Gauge, mut measure: impl FnMut(&[R; N]) -> Option<[R; 2]>) {
    gauge.note(LAMPS);
    let (narrow, sums) = (Sums::new(), Sums::of(&observers::CIE_1964_10));
    let samples = reflectances(&rendering::colour_evaluation_samples::<f64>());
    for light in lights::<R>() {
        let exact = exact_light(&light);
        let Some((temperature, _)) = nearest(&narrow, uv(narrow.xyz(&exact))) else { return gauge.require(false) };
        let reference = Lit::new(&sums, &blended(&sums, temperature), &samples);
        let exact = exact_fidelity(&Lit::new(&sums, &exact, &samples), &reference);
        let Some(found) = measure(&light) else { return gauge.require(false) };
        for (got, exact) in found.into_iter().zip(exact) {
            gauge.compare(got, exact);
        }
    }
}

/// R_f and R_g of a lamp.
pub fn measure_fidelity<R: Real>(gauge: &mut Gauge) {
    each_fidelity(gauge, |lamp: &[R; N]| {
        let found = light::measure_fidelity(GRID, lamp, RadiationConstant::Its1990).ok()??;
        Some([found.rf, found.rg])
    });
}

/// R_f and R_g of a lamp, prepared.
pub fn fidelity_meter<R: Real>(gauge: &mut Gauge) {
    let meter = Box::new(FidelityMeter::<R, N>::new(GRID, RadiationConstant::Its1990));
    each_fidelity(gauge, |lamp: &[R; N]| {
        let found = meter.measure(lamp).ok()??;
        Some([found.rf, found.rg])
    });
}
