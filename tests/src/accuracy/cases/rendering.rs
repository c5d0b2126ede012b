//! Colour rendering by the reference light: CIE 13.3, CRI00 and R96, in 106 bits.

use spectral_core::Real;
use spectral_core::adaptation::BRADFORD;
use spectral_core::colour::xyz;
use spectral_core::colour_rendering::{self as rendering, Cri00, ReferenceKind, ReferenceLight, Rendering};
use spectral_core::summation::{DirectColours, Illuminated, TestColours};

use super::adaptation::{adapted_uv, nayatani, scaled};
use super::colour::{ciede2000, lab};
use super::lights::{
    Colour, GRID, LAMPS, Lit, Sums, black_body, daylight_power, exact_light, lights, locus, nearest, observer, uv,
};
use crate::accuracy::gauge::{Axis, Gauge};
use crate::accuracy::wide::{Wide, wide};

/// R_i of CIE 13.3.
pub(super) fn special_13_3(test: &Lit, reference: &Lit) -> Vec<Wide> {
    let (from, to) = (uv(test.white), uv(reference.white));
    let lightness = |y: Wide| (y * 100.0).cbrt() * 25.0 - 17.0;
    let point = |[u, v]: [Wide; 2], y: Wide| {
        let w = lightness(y);
        [w, w * 13.0 * (u - to[0]), w * 13.0 * (v - to[1])]
    };
    // The printed constants: the adapted white of the test light is the reference's, by definition.
    let each = |(t, r): (&Colour, &Colour)| {
        let (a, b) = (point(adapted_uv(uv(*t), from, to), t[1]), point(uv(*r), r[1]));
        let square = (0..3).fold(Wide::ZERO, |sum, i| sum + (a[i] - b[i]).squared());
        100.0 - Wide::decimal("4.6") * square.sqrt()
    };
    test.samples.iter().zip(&reference.samples).map(each).collect()
}

pub(super) fn special_cri00(test: &Lit, reference: &Lit, factor: f64) -> Vec<Wide> {
    let colour = |xyz: Colour| lab(xyz, reference.white);
    let each = |(t, r): (&Colour, &Colour)| {
        let adapted = scaled(&BRADFORD, test.white, reference.white, *t);
        100.0 - ciede2000(colour(*r), colour(adapted), [Wide::ONE; 3]).0 * factor
    };
    test.samples.iter().zip(&reference.samples).map(each).collect()
}

fn special_r96(test: &Lit, reference: &Lit, factor: f64) -> Vec<Wide> {
    let white = xyz::WHITE_D65.map(Wide::from);
    let each = |(t, r): (&Colour, &Colour)| {
        let (a, b) = (lab(nayatani(test.white, white, *t), white), lab(nayatani(reference.white, white, *r), white));
        let square = (0..3).fold(Wide::ZERO, |sum, i| sum + (a[i] - b[i]).squared());
        100.0 - square.sqrt() * factor
    };
    test.samples.iter().zip(&reference.samples).map(each).collect()
}

pub(super) fn mean(values: &[Wide], count: usize) -> Wide {
    values.iter().take(count).fold(Wide::ZERO, |sum, x| sum + *x) / count as f64
}

/// What rendering is measured with: the reference that the light's own temperature asks for.
pub(super) fn reference_of(sums: &Sums, light: &[Wide]) -> Option<Vec<Wide>> {
    let (temperature, _) = nearest(sums, uv(sums.xyz(light)))?;
    Some(if temperature < 5000.0 { black_body(temperature) } else { daylight_power(temperature) })
}

fn compare_rendering<R: Real, const M: usize>(
    gauge: &mut Gauge,
    found: &Rendering<R, M>,
    special: &[Wide],
    averaged: usize,
) {
    for (got, exact) in found.special.into_iter().zip(special) {
        gauge.compare(got, *exact);
    }
    gauge.compare(found.general, mean(special, averaged));
}

/// Both lights of each test lamp with the Munsell samples, as the core sees them.
fn each_munsell<R: Real>(
    gauge: &mut Gauge,
    mut measure: impl FnMut(&mut Gauge, &Illuminated<R, 14>, &Illuminated<R, 14>),
) {
    gauge.note(LAMPS);
    let (observer, samples) = (observer::<R>(), rendering::munsell_samples::<R>());
    let colours = DirectColours::new(GRID, &observer, &samples);
    let sums = Sums::new();
    for light in lights::<R>() {
        let Some(reference) = reference_of(&sums, &exact_light(&light)) else { return gauge.require(false) };
        let reference = core::array::from_fn(|i| R::from_f64(reference[i].to_f64()));
        let (Some(test), Some(reference)) = (colours.illuminate(&light), colours.illuminate(&reference)) else {
            return gauge.require(false);
        };
        measure(gauge, &test, &reference);
    }
}

/// R_i and R_a from given tristimulus values.
pub fn cie_13_3<R: Real>(gauge: &mut Gauge) {
    each_munsell(gauge, |gauge, test: &Illuminated<R, 14>, reference| {
        let special = special_13_3(&Lit::of(test), &Lit::of(reference));
        compare_rendering(gauge, &rendering::cie_13_3(test, reference), &special, 8);
    });
}

/// CRI00 from given tristimulus values.
pub fn cri00<R: Real>(gauge: &mut Gauge) {
    each_munsell(gauge, |gauge, test: &Illuminated<R, 14>, reference| {
        let special = special_cri00(&Lit::of(test), &Lit::of(reference), 9.097);
        compare_rendering(gauge, &rendering::cri00(test, reference, &Cri00::MUNSELL), &special, 8);
    });
}

/// R96 from given tristimulus values.
pub fn r96<R: Real>(gauge: &mut Gauge) {
    each_munsell(gauge, |gauge, test: &Illuminated<R, 14>, reference| {
        let special = special_r96(&Lit::of(test), &Lit::of(reference), rendering::R96C);
        compare_rendering(gauge, &rendering::r96(test, reference, rendering::R96C), &special, 14);
    });
}

/// The reference light on the grid.
pub fn reference_spectrum<R: Real>(gauge: &mut Gauge) {
    gauge.effort(0.1);
    let locus = locus::<R>();
    let axes = [Axis::linear("T", 1000.0, 25_000.0).edges(&[5000.0]).list(&[6500.0])];
    gauge.each(&axes, |gauge, [t]: [R; 1]| {
        let Some(light) = ReferenceLight::for_temperature(t) else { return gauge.require(false) };
        let planckian = light.kind == ReferenceKind::Planckian;
        gauge.require(planckian == (t.to_f64() < 5000.0));
        let exact = if planckian { black_body(wide(t)) } else { daylight_power(wide(t)) };
        let Some(found) = light.spectrum(GRID, &locus) else { return gauge.require(false) };
        let largest = exact.iter().fold(Wide::ZERO, |m, x| m.max(*x));
        for (got, exact) in found.into_iter().zip(exact) {
            gauge.compare_to(got, exact, largest);
        }
    });
}
