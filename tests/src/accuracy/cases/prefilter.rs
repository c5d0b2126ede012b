//! Materials prefiltered by the dominant light, in 106 bits.

use spectral_core::colour::RgbSpace;
use spectral_core::prefilter::Prefilter;
use spectral_core::spectrum::Outside;
use spectral_core::tables::{UniformTable, colorchecker, fluorescent, illuminants, observers};
use spectral_core::{Observer, Real};

use super::colour::to_rec_709;
use crate::accuracy::gauge::{Axis, Gauge};
use crate::accuracy::lines::{Polyline, integral};
use crate::accuracy::wide::{Wide, wide, wides};

pub(super) const RANGE: [f64; 2] = [380.0, 780.0];
const LAMPS: [&UniformTable; 3] = [&illuminants::D65, &illuminants::A, &fluorescent::FL2];
const PAINTS: [&UniformTable; 4] =
    [&colorchecker::GREEN, &colorchecker::RED, &colorchecker::BLUE, &colorchecker::DARK_SKIN];

/// Linear Rec. 709 of a product of spectra relative to ∫ȳ, and the sum of the magnitudes it is made of.
fn rgb(factors: &[&Polyline]) -> [[Wide; 2]; 3] {
    let cmf = Polyline::of_observer(&observers::CIE_1931_2);
    let unit = integral(&[&cmf[1]], RANGE);
    let xyz: [Wide; 3] = core::array::from_fn(|a| {
        let all: Vec<&Polyline> = factors.iter().copied().chain([&cmf[a]]).collect();
        integral(&all, RANGE) / unit
    });
    to_rec_709().map(|row| {
        let terms: [Wide; 3] = core::array::from_fn(|i| row[i] * xyz[i]);
        let size = terms.into_iter().fold(Wide::ZERO, |sum, t| sum + t.abs());
        [terms[0] + terms[1] + terms[2], size]
    })
}

/// Calls for each lamp with its prefilter.
fn each_prefilter<R: Real>(
    gauge: &mut Gauge,
    mut measure: impl FnMut(&mut Gauge, &Prefilter<'_, R>, &Polyline, [[Wide; 2]; 3]),
) {
    gauge.note("D65, A, FL2 and four ColorChecker patches, Rec. 709");
    let observer = Observer::<R>::cie_1931_2deg();
    for lamp in LAMPS {
        let (spectrum, line) = (lamp.spectrum::<R>(Outside::Zero), Polyline::of_table(lamp, false));
        match Prefilter::new(&observer, &spectrum, RgbSpace::REC_709) {
            Ok(prefilter) => measure(gauge, &prefilter, &line, rgb(&[&line])),
            Err(_) => gauge.require(false),
        }
    }
}

/// RGB of the dominant light.
pub fn prefilter_new<R: Real>(gauge: &mut Gauge) {
    each_prefilter(gauge, |gauge, prefilter: &Prefilter<'_, R>, _, light| {
        for (got, [exact, size]) in prefilter.light().into_iter().zip(light) {
            gauge.compare_to(got, exact, size);
        }
    });
}

/// ρ_c.
pub fn prefilter_material<R: Real>(gauge: &mut Gauge) {
    each_prefilter(gauge, |gauge, prefilter: &Prefilter<'_, R>, line, light| {
        for paint in PAINTS {
            let got = prefilter.material(&paint.spectrum::<R>(Outside::Hold));
            for (c, [exact, size]) in rgb(&[line, &Polyline::of_table(paint, true)]).into_iter().enumerate() {
                let own = light[c][0];
                gauge.compare_to(got[c], exact / own, (size + exact.abs() * light[c][1] / own) / own);
            }
        }
    });
}

/// RGB of other lights.
pub fn prefilter_other_light<R: Real>(gauge: &mut Gauge) {
    each_prefilter(gauge, |gauge, prefilter: &Prefilter<'_, R>, _, _| {
        for lamp in LAMPS {
            let got = prefilter.other_light(&lamp.spectrum::<R>(Outside::Zero));
            for (got, [exact, size]) in got.into_iter().zip(rgb(&[&Polyline::of_table(lamp, false)])) {
                gauge.compare_to(got, exact, size);
            }
        }
    });
}

/// c Y/RGB_c.
pub fn prefilter_balanced<R: Real>(gauge: &mut Gauge) {
    let axes = ["R", "G", "B"].map(|name| Axis::linear(name, 0.0, 1.0));
    each_prefilter(gauge, |gauge, prefilter: &Prefilter<'_, R>, _, _| {
        let (light, luminance) = (wides(prefilter.light()), wide(prefilter.luminance()));
        gauge.effort(0.1);
        gauge.each(&axes, |gauge, colour: [R; 3]| {
            gauge.compare_all(
                prefilter.balanced(colour),
                core::array::from_fn(|c| wide(colour[c]) * luminance / light[c]),
            );
        });
    });
}
