//! Spectra for colours: sigmoids, emissions and Smits's, in 106 bits.

use spectral_core::colour::RgbSpace;
use spectral_core::spectrum::Uniform;
use spectral_core::tables::{BinTable, illuminants, observers, smits};
use spectral_core::upsampling::smits::Basis;
use spectral_core::upsampling::{Emission, LightUpsampler, Sigmoid, Upsampler};
use spectral_core::{Real, Spectrum};

use super::colour::to_rec_709;
use super::prefilter::RANGE;
use crate::accuracy::gauge::{Axis, Gauge};
use crate::accuracy::lines::{Polyline, integral};
use crate::accuracy::wide::{Wide, apply, wide, wides};

/// ½ + u/(2√(1 + u²)), without the difference.
fn sigmoid_of(u: Wide) -> Wide {
    let root = (u.squared() + 1.0).sqrt();
    let low = 0.5 / (root * (root + u.abs()));
    if u < 0.0 { low } else { 1.0 - low }
}

/// A sigmoid's argument at a wavelength, and the sum of its terms' magnitudes.
fn polynomial(c: [Wide; 3], wavelength: Wide) -> [Wide; 2] {
    let z = (wavelength - 580.0) / 200.0;
    [c[0] + z * (c[1] + z * c[2]), c[0].abs() + z.abs() * (c[1].abs() + z.abs() * c[2].abs())]
}

fn sigmoids() -> [Axis; 3] {
    ["c₀", "c₁", "c₂"].map(|name| Axis::signed(name, 1e-3, 30.0).list(&[1.0]))
}

/// How much larger the terms of U are than U.
fn growth([u, size]: [Wide; 2]) -> Wide {
    size / u.abs().max(Wide::from(1e-3)) + 1.0
}

/// The sigmoid itself.
pub fn sigmoid_smooth<R: Real>(gauge: &mut Gauge) {
    let [a, b, c] = sigmoids();
    let axes = [a, b, c, Axis::linear("λ", 360.0, 830.0).edges(&[580.0])];
    gauge.each(&axes, |gauge, [a, b, c, w]: [R; 4]| {
        let Some(sigmoid) = Sigmoid::new([a, b, c]) else { return gauge.require(false) };
        let u = polynomial(wides([a, b, c]), wide(w));
        let exact = sigmoid_of(u[0]);
        gauge.compare_to(sigmoid.smooth(w), exact, exact * growth(u));
    });
}

/// Linear between nodes of 5 nm.
pub fn sigmoid_segment<R: Real>(gauge: &mut Gauge) {
    let [a, b, c] = sigmoids();
    let axes = [a, b, c, Axis::linear("λ", 360.0, 829.9).edges(&[580.0])];
    gauge.each(&axes, |gauge, [a, b, c, w]: [R; 4]| {
        let Some(sigmoid) = Sigmoid::new([a, b, c]) else { return gauge.require(false) };
        let start = (w.to_f64() / 5.0).floor() * 5.0;
        let at = |w: f64| {
            let u = polynomial(wides([a, b, c]), w.into());
            (sigmoid_of(u[0]), growth(u))
        };
        let ((first, g), (last, h)) = (at(start), at(start + 5.0));
        let share = (wide(w) - start) / 5.0;
        let exact = first + (last - first) * share;
        gauge.compare_to(sigmoid.segment(w).first, exact, first * g * (1.0 - share) + last * h * share);
    });
}

/// The same value everywhere.
pub fn sigmoid_grey<R: Real>(gauge: &mut Gauge) {
    let axis = Axis::log("value", 1e-30, 1.0).list(&[0.18, 1e-6]).edges(&[0.5]);
    gauge.each(&[axis], |gauge, [v]: [R; 1]| gauge.compare(Sigmoid::grey(v).smooth(R::from_f64(500.0)), wide(v)));
}

/// Coefficients of λ², λ and 1, in `f64`.
pub fn nanometre_coefficients<R: Real>(gauge: &mut Gauge) {
    gauge.each(&sigmoids(), |gauge, c: [R; 3]| {
        let Some(sigmoid) = Sigmoid::new(c) else { return gauge.require(false) };
        let [c0, c1, c2] = wides(c);
        let (p, q) = (c2 / 40_000.0, c1 / 200.0);
        let exact = [p, q - p * 1160.0, c0 - q * 580.0 + p * 336_400.0];
        let sizes = [p.abs(), q.abs() + p.abs() * 1160.0, c0.abs() + q.abs() * 580.0 + p.abs() * 336_400.0];
        for ((got, exact), size) in sigmoid.nanometre_coefficients().into_iter().zip(exact).zip(sizes) {
            if size > 0.0 {
                gauge.compare_to(got, exact, size);
            }
        }
    });
}

/// Relative linear sRGB of a reflectance under D65: the light's own colour is (1, 1, 1).
fn seen(weights: &[[Wide; 3]], line: impl Fn(usize) -> Wide) -> [Wide; 3] {
    let mut sums = [[Wide::ZERO; 3]; 2];
    for (node, weight) in weights.iter().enumerate() {
        let value = line(node);
        for a in 0..3 {
            sums[0][a] += weight[a] * value;
            sums[1][a] += weight[a];
        }
    }
    let to_rgb = to_rec_709();
    let [own, white] = sums.map(|xyz| apply(&to_rgb, xyz));
    core::array::from_fn(|c| own[c] / white[c])
}

/// ∫ h L ā for the hat functions at 380, 385, …, 780 nm.
fn hats(light: &Polyline) -> Vec<[Wide; 3]> {
    let cmf = Polyline::of_observer(&observers::CIE_1931_2);
    let hat =
        |node: f64| Polyline::new(vec![node - 5.0, node, node + 5.0], vec![Wide::ZERO, Wide::ONE, Wide::ZERO], false);
    let weight = |i: usize| {
        let node = 380.0 + 5.0 * i as f64;
        let (hat, limits) = (hat(node), [(node - 5.0).max(380.0), (node + 5.0).min(780.0)]);
        cmf.each_ref().map(|cmf| integral(&[&hat, light, cmf], limits))
    };
    (0..81).map(weight).collect()
}

fn nodes<R: Real>(sigmoid: &Sigmoid<R>) -> impl Fn(usize) -> Wide {
    let coefficients = wides(sigmoid.coefficients());
    move |i| sigmoid_of(polynomial(coefficients, (380.0 + 5.0 * i as f64).into())[0])
}

/// The colour of a sigmoid.
pub fn upsampler_colour<R: Real>(gauge: &mut Gauge) {
    let weights = hats(&Polyline::of_table(&illuminants::D65, false));
    let Ok(upsampler) = Upsampler::<R>::d65(&RgbSpace::REC_709) else { return gauge.require(false) };
    gauge.effort(0.2);
    gauge.each(&sigmoids(), |gauge, c: [R; 3]| {
        let Some(sigmoid) = Sigmoid::new(c) else { return gauge.require(false) };
        for (got, exact) in upsampler.colour(&sigmoid).into_iter().zip(seen(&weights, nodes(&sigmoid))) {
            gauge.compare_to(got, exact, Wide::from(0.75));
        }
    });
}

fn colours() -> [Axis; 3] {
    ["R", "G", "B"].map(|name| Axis::linear(name, 0.0, 1.0).list(&[0.5, 0.02]))
}

/// How far the exact colour of the sigmoid found is from the colour asked for.
pub fn upsampler_reflectance<R: Real>(gauge: &mut Gauge) {
    let weights = hats(&Polyline::of_table(&illuminants::D65, false));
    let Ok(upsampler) = Upsampler::<R>::d65(&RgbSpace::REC_709) else { return gauge.require(false) };
    gauge.effort(0.2);
    gauge.each(&colours(), |gauge, rgb: [R; 3]| {
        let Ok(sigmoid) = upsampler.reflectance(rgb) else { return gauge.require(false) };
        for (exact, wanted) in seen(&weights, nodes(&sigmoid)).into_iter().zip(rgb) {
            gauge.record((exact - wide(wanted)).abs().to_f64());
        }
    });
}

type Emitter<R> = LightUpsampler<Uniform<'static, R>, R>;

/// Emissions for colours, with D65 at the nodes.
fn each_emission<R: Real>(
    gauge: &mut Gauge,
    axes: &[Axis; 3],
    mut measure: impl FnMut(&mut Gauge, &Emitter<R>, &Emission<Uniform<'static, R>, R>, [R; 3], [Wide; 3]),
) {
    let light = Polyline::of_table(&illuminants::D65, false);
    let flat = Polyline::new(vec![300.0, 900.0], vec![Wide::ONE; 2], true);
    let weights: Vec<[Wide; 3]> = hats(&flat)
        .into_iter()
        .enumerate()
        .map(|(i, weight)| weight.map(|w| w * light.value((380.0 + 5.0 * i as f64).into())))
        .collect();
    let Ok(upsampler) = LightUpsampler::d65(&RgbSpace::REC_709) else { return gauge.require(false) };
    gauge.effort(0.1);
    gauge.each(axes, |gauge, rgb: [R; 3]| {
        let Ok(emission) = upsampler.emission(rgb) else { return gauge.require(false) };
        let most = rgb.into_iter().fold(Wide::ZERO, |m, c| m.max(wide(c)));
        let exact = seen(&weights, nodes(emission.sigmoid())).map(|c| c * most * 2.0);
        measure(gauge, &upsampler, &emission, rgb, exact);
    });
}

/// How far the exact colour of an emission is from the colour asked for.
pub fn emission<R: Real>(gauge: &mut Gauge) {
    each_emission(gauge, &colours(), |gauge, _: &Emitter<R>, _, rgb, exact| {
        for (exact, wanted) in exact.into_iter().zip(rgb) {
            gauge.record((exact - wide(wanted)).abs().to_f64());
        }
    });
}

/// The colour of an emission.
pub fn emission_colour<R: Real>(gauge: &mut Gauge) {
    each_emission(gauge, &colours(), |gauge, upsampler: &Emitter<R>, emission, _, exact| {
        for (got, exact) in upsampler.colour(emission).into_iter().zip(exact) {
            gauge.compare_to(got, exact, Wide::from(0.75));
        }
    });
}

/// Values of an emission between nodes: its scale times sigmoid and light.
pub fn emission_segment<R: Real>(gauge: &mut Gauge) {
    let light = Polyline::of_table(&illuminants::D65, false);
    each_emission(gauge, &colours(), |gauge, _: &Emitter<R>, emission, _, _| {
        let wavelength = 380.0 + 400.0 * gauge.rng().unit();
        let w = R::from_f64(wavelength);
        let start = (w.to_f64() / 5.0).floor() * 5.0;
        let at = |w: f64| {
            let u = polynomial(wides(emission.sigmoid().coefficients()), w.into());
            let value = sigmoid_of(u[0]) * light.value(w.into()) * wide(emission.scale());
            (value, value * growth(u))
        };
        let ((first, g), (last, h)) = (at(start), at(start + 5.0));
        let share = (wide(w) - start) / 5.0;
        let exact = first + (last - first) * share;
        if exact > 0.0 {
            gauge.compare_to(emission.segment(w).first, exact, g * (1.0 - share) + h * share);
        }
    });
}

/// The factor that makes luminances those of RGB.
pub fn emission_scale<R: Real>(gauge: &mut Gauge) {
    let (light, cmf) = (Polyline::of_table(&illuminants::D65, false), Polyline::of_observer(&observers::CIE_1931_2));
    let wavelengths: Vec<f64> = (0..81).map(|i| 380.0 + 5.0 * f64::from(i)).collect();
    let values = wavelengths.iter().map(|w| light.value((*w).into())).collect();
    let coarse = Polyline::new(wavelengths, values, true);
    let unit = integral(&[&cmf[1]], RANGE) / integral(&[&coarse, &cmf[1]], RANGE);
    each_emission(gauge, &colours(), |gauge, _: &Emitter<R>, emission, rgb, _| {
        let most = rgb.into_iter().fold(Wide::ZERO, |m, c| m.max(wide(c)));
        gauge.compare(emission.scale(), most * 2.0 * unit);
    });
}

/// Smits 1999: white, a secondary and a primary colour, none of them negative.
pub fn smits_spectrum<R: Real>(gauge: &mut Gauge) {
    let axes = ["R", "G", "B"].map(|name| Axis::linear(name, 0.0, 1.0).list(&[0.5]));
    let basis = Basis::<R>::reflectances();
    let column = |table: &BinTable, bin: usize| Wide::from(table.samples.double[bin]);
    gauge.each(&axes, |gauge, rgb: [R; 3]| {
        let Ok(found) = basis.spectrum(rgb) else { return gauge.require(false) };
        let mut order = [0, 1, 2];
        order.sort_by(|a, b| rgb[*a].to_f64().total_cmp(&rgb[*b].to_f64()));
        let [low, middle, high] = order.map(|i| wide(rgb[i]));
        let secondary = [&smits::CYAN, &smits::MAGENTA, &smits::YELLOW][order[0]];
        let primary = [&smits::RED, &smits::GREEN, &smits::BLUE][order[2]];
        for (bin, got) in found.values().into_iter().enumerate() {
            let exact = low * column(&smits::WHITE, bin)
                + (middle - low) * column(secondary, bin)
                + (high - middle) * column(primary, bin);
            gauge.compare_to(got, exact, high.max(wide(R::MIN_POSITIVE)));
        }
    });
}

/// Bins from 380 nm, 34 nm wide.
pub fn bins_segment<R: Real>(gauge: &mut Gauge) {
    let colour = [0.2, 0.5, 0.3].map(R::from_f64);
    let Ok(bins) = Basis::<R>::reflectances().spectrum(colour) else { return gauge.require(false) };
    let edges: Vec<f64> = (0..=10).map(|i| 380.0 + 34.0 * f64::from(i)).collect();
    gauge.each(&[Axis::linear("λ", 300.0, 900.0).edges(&edges)], |gauge, [w]: [R; 1]| {
        let bin = ((w.to_f64() - 380.0) / 34.0).floor().clamp(0.0, 9.0) as usize;
        gauge.compare(bins.segment(w).first, wide(bins.values()[bin]));
    });
}
