//! Three components in place of spectra: bilinear products, prefiltered materials, spectra for colours.

use spectral_core::bilinear::{self, Tensor};
use spectral_core::colour::RgbSpace;
use spectral_core::prefilter::Prefilter;
use spectral_core::spectrum::Outside;
use spectral_core::tables::{UniformTable, colorchecker, fluorescent, illuminants, observers, smits};
use spectral_core::upsampling::smits::Basis;
use spectral_core::upsampling::{Emission, LightUpsampler, Sigmoid, Upsampler};
use spectral_core::{Observer, Real, Spectrum};

use super::colour::matrix;
use crate::accuracy::gauge::{Axis, Gauge};
use crate::accuracy::lines::{Polyline, integral};
use crate::accuracy::wide::{Wide, apply, dot, inverse, product as matrix_product, wide, wides};

type Vector = [Wide; 3];
type Matrix = [Vector; 3];

/// k^c_{d,e} as `[e][c][d]`, from nine coefficients off the diagonal: Granier and Damez 2004, equations 5 and 9.
fn coefficients(transfer: Matrix) -> [Matrix; 3] {
    let mut k = [[[Wide::ZERO; 3]; 3]; 3];
    for c in 0..3 {
        for (pair, [d, e]) in [[0, 1], [1, 2], [2, 0]].into_iter().enumerate() {
            k[e][c][d] = transfer[c][pair];
            k[d][c][e] = transfer[c][pair];
        }
        for d in 0..3 {
            let others = (0..3).filter(|e| *e != d).fold(Wide::ZERO, |sum, e| sum + k[e][c][d]);
            k[d][c][d] = (if c == d { Wide::ONE } else { Wide::ZERO }) - others;
        }
    }
    k
}

/// Σ k^c_{d,e} C_d D_e, and the sum of the magnitudes that the core's form has.
fn bilinear_product(k: &[Matrix; 3], c: Vector, d: Vector) -> [[Wide; 2]; 3] {
    core::array::from_fn(|channel| {
        let mut sum = Wide::ZERO;
        for (e, k) in k.iter().enumerate() {
            sum += dot(k[channel], c) * d[e];
        }
        let pairs = [[0, 1], [1, 2], [2, 0]];
        let size = pairs.into_iter().fold((c[channel] * d[channel]).abs(), |sum, [i, j]| {
            sum + (k[j][channel][i] * (c[i] - c[j]) * (d[i] - d[j])).abs()
        });
        [sum, size]
    })
}

fn tensors<R: Real>() -> [Tensor<R>; 3] {
    [Tensor::iso_rgb(), Tensor::rec_709(), Tensor::acescg()]
}

const TENSORS: &str = "ISO RGB, Rec. 709, ACEScg";

fn pairs() -> [Axis; 6] {
    ["C_r", "C_g", "C_b", "D_r", "D_g", "D_b"].map(|name| Axis::linear(name, 0.0, 1.0).list(&[0.5, 0.05]))
}

/// Calls for pairs of colours under each tensor.
fn each_pair<R: Real>(
    gauge: &mut Gauge,
    mut measure: impl FnMut(&mut Gauge, &Tensor<R>, &[Matrix; 3], [R; 3], [R; 3]),
) {
    gauge.note(TENSORS);
    gauge.effort(0.5);
    for tensor in tensors::<R>() {
        let k = coefficients(tensor.transfer().map(wides));
        gauge.each(&pairs(), |gauge, [a, b, c, x, y, z]: [R; 6]| measure(gauge, &tensor, &k, [a, b, c], [x, y, z]));
    }
}

/// C ⊗ D.
pub fn product<R: Real>(gauge: &mut Gauge) {
    each_pair(gauge, |gauge, tensor: &Tensor<R>, k, c, d| {
        for (got, [exact, size]) in tensor.product(c, d).into_iter().zip(bilinear_product(k, wides(c), wides(d))) {
            if size == 0.0 {
                gauge.require(got == R::ZERO);
            } else {
                gauge.compare_to(got, exact, size);
            }
        }
    });
}

/// The matrix of a material: Σ ρ_e K_e.
fn material(k: &[Matrix; 3], rho: Vector) -> Matrix {
    core::array::from_fn(|c| core::array::from_fn(|d| (0..3).fold(Wide::ZERO, |sum, e| sum + k[e][c][d] * rho[e])))
}

/// Entries of the matrix, in ULP of 1.
pub fn reflection<R: Real>(gauge: &mut Gauge) {
    each_pair(gauge, |gauge, tensor: &Tensor<R>, k, _, d| {
        for (got, exact) in tensor.reflection(d).matrix().into_iter().zip(material(k, wides(d))) {
            for (got, exact) in got.into_iter().zip(exact) {
                gauge.compare_to(got, exact, Wide::from(0.75));
            }
        }
    });
}

/// The matrix times a light.
pub fn reflection_apply<R: Real>(gauge: &mut Gauge) {
    each_pair(gauge, |gauge, tensor: &Tensor<R>, _, c, d| {
        let reflection = tensor.reflection(d);
        for (got, row) in reflection.apply(c).into_iter().zip(reflection.matrix()) {
            let terms: Vector = core::array::from_fn(|i| wide(row[i]) * wide(c[i]));
            gauge.compare_to(
                got,
                terms[0] + terms[1] + terms[2],
                terms.map(Wide::abs).into_iter().fold(Wide::ZERO, |s, t| s + t),
            );
        }
    });
}

/// One reflection after another.
pub fn reflection_after<R: Real>(gauge: &mut Gauge) {
    each_pair(gauge, |gauge, tensor: &Tensor<R>, _, c, d| {
        let (first, second) = (tensor.reflection(c), tensor.reflection(d));
        let exact = matrix_product(&second.matrix().map(wides), &first.matrix().map(wides));
        for (got, exact) in second.after(first.matrix()).matrix().into_iter().zip(exact) {
            for (got, exact) in got.into_iter().zip(exact) {
                gauge.compare_to(got, exact, Wide::from(0.75));
            }
        }
    });
}

/// C ⊘ D, in ULP of the largest component times the condition.
pub fn quotient<R: Real>(gauge: &mut Gauge) {
    each_pair(gauge, |gauge, tensor: &Tensor<R>, k, c, d| {
        let Ok(divisor) = tensor.divisor(d) else { return };
        let exact = apply(&inverse(&material(k, wides(d))), wides(c));
        let largest = exact.into_iter().fold(Wide::ZERO, |m, x| m.max(x.abs()));
        // Near a singular divisor nothing is left to compare.
        if divisor.condition().to_f64() * R::EPSILON.to_f64() < 1e-3 {
            for (got, exact) in divisor.quotient(c).into_iter().zip(exact) {
                gauge.compare_to(got, exact, largest * wide(divisor.condition()));
            }
        }
    });
}

/// (X ⊘ D) ⊗ L, in ULP of the matrix's largest entry times the condition.
pub fn relighting<R: Real>(gauge: &mut Gauge) {
    each_pair(gauge, |gauge, tensor: &Tensor<R>, k, c, d| {
        let Ok(divisor) = tensor.divisor(d) else { return };
        let exact = matrix_product(&material(k, wides(c)), &inverse(&material(k, wides(d))));
        let largest = exact.as_flattened().iter().fold(Wide::ZERO, |m, x| m.max(x.abs()));
        if divisor.condition().to_f64() * R::EPSILON.to_f64() < 1e-3 {
            for (got, exact) in divisor.relighting(tensor, c).matrix().into_iter().zip(exact) {
                for (got, exact) in got.into_iter().zip(exact) {
                    gauge.compare_to(got, exact, largest * wide(divisor.condition()));
                }
            }
        }
    });
}

/// ‖|R|‖ ‖R⁻¹‖, relatively.
pub fn divisor<R: Real>(gauge: &mut Gauge) {
    each_pair(gauge, |gauge, tensor: &Tensor<R>, k, _, d| {
        let Ok(divisor) = tensor.divisor(d) else { return };
        let transfer = tensor.transfer().map(wides);
        let [r, g, b] = wides(d);
        let differences = [(r - g).abs(), (g - b).abs(), (b - r).abs()];
        let norm = |rows: [Wide; 3]| rows.into_iter().fold(Wide::ZERO, Wide::max);
        let sizes = core::array::from_fn(|c| wides(d)[c].abs() + dot(transfer[c].map(Wide::abs), differences) * 2.0);
        let back = inverse(&material(k, wides(d))).map(|row| row.into_iter().fold(Wide::ZERO, |s, x| s + x.abs()));
        let exact = norm(sizes) * norm(back);
        // Its own error grows with itself.
        gauge.compare_to(divisor.condition(), exact, exact * exact);
    });
}

/// All 27 coefficients.
pub fn matrices<R: Real>(gauge: &mut Gauge) {
    gauge.note(TENSORS);
    for tensor in tensors::<R>() {
        let exact = coefficients(tensor.transfer().map(wides));
        for (got, exact) in tensor.matrices().as_flattened().iter().zip(exact.as_flattened()) {
            for (got, exact) in got.iter().zip(exact) {
                gauge.compare_to(*got, *exact, Wide::from(0.75));
            }
        }
    }
}

/// The nearest symmetric and coherent coefficients, by their orthogonal complement: what is added to each channel's matrix is r 1ᵀ + 1 rᵀ
/// with multipliers that restore coherence.
fn nearest(k: &[Matrix; 3]) -> Matrix {
    core::array::from_fn(|c| {
        let symmetric = |d: usize, e: usize| (k[e][c][d] + k[d][c][e]) * 0.5;
        let lacking: Vector = core::array::from_fn(|d| {
            let sum = symmetric(d, 0) + symmetric(d, 1) + symmetric(d, 2);
            (if c == d { Wide::ONE } else { Wide::ZERO }) - sum
        });
        // (λ_d + λ_e) with Σ_e (λ_d + λ_e) = lacking_d: 3 λ_d + Σλ = lacking_d, 6 Σλ = Σ lacking.
        let total = (lacking[0] + lacking[1] + lacking[2]) / 6.0;
        let lambda = lacking.map(|l| (l - total) / 3.0);
        [[0, 1], [1, 2], [2, 0]].map(|[d, e]| symmetric(d, e) + lambda[d] + lambda[e])
    })
}

/// Printed matrices, disturbed by up to 10⁻³.
pub fn from_matrices<R: Real>(gauge: &mut Gauge) {
    gauge.note("ISO RGB's matrices, each coefficient moved by up to 0.001");
    for _ in 0..1000 {
        let matrices: [[[R; 3]; 3]; 3] = Tensor::<R>::iso_rgb()
            .matrices()
            .map(|matrix| matrix.map(|row| row.map(|k| k + R::from_f64(2e-3 * (gauge.rng().unit() - 0.5)))));
        let Ok(tensor) = Tensor::from_matrices(&matrices, R::from_f64(0.01)) else { return gauge.require(false) };
        let exact = nearest(&matrices.map(|matrix| matrix.map(wides)));
        for (got, exact) in tensor.transfer().as_flattened().iter().zip(exact.as_flattened()) {
            gauge.compare_to(*got, *exact, Wide::from(0.75));
        }
    }
}

/// 1 − k^c_{c,c}.
pub fn alpha<R: Real>(gauge: &mut Gauge) {
    gauge.note(TENSORS);
    for tensor in tensors::<R>() {
        let k = coefficients(tensor.transfer().map(wides));
        for (c, got) in tensor.alpha().into_iter().enumerate() {
            gauge.compare_to(got, 1.0 - k[c][c][c], Wide::from(0.375));
        }
    }
}

/// Coefficients in proportion to α.
pub fn with_alpha<R: Real>(gauge: &mut Gauge) {
    let axes = ["α_r", "α_g", "α_b"].map(|name| Axis::linear(name, 0.0, 1.0).list(&[0.5]));
    gauge.note("ISO RGB");
    let tensor = Tensor::<R>::iso_rgb();
    let k = coefficients(tensor.transfer().map(wides));
    gauge.each(&axes, |gauge, alpha: [R; 3]| {
        let Ok(found) = tensor.with_alpha(alpha) else { return gauge.require(false) };
        for (c, row) in found.transfer().into_iter().enumerate() {
            let factor = wide(alpha[c]) / (1.0 - k[c][c][c]);
            gauge.compare_all(row, tensor.transfer()[c].map(|k| wide(k) * factor));
        }
    });
}

/// Coefficients times factors.
pub fn scaled<R: Real>(gauge: &mut Gauge) {
    let axes = ["β_r", "β_g", "β_b"].map(|name| Axis::linear(name, -1.0, 2.0).list(&[0.5]));
    gauge.note("ISO RGB");
    let tensor = Tensor::<R>::iso_rgb();
    gauge.each(&axes, |gauge, factors: [R; 3]| {
        let Ok(found) = tensor.scaled(factors) else { return gauge.require(false) };
        for (c, row) in found.transfer().into_iter().enumerate() {
            gauge.compare_all(row, tensor.transfer()[c].map(|k| wide(k) * wide(factors[c])));
        }
    });
}

/// Granier and Damez 2004, section 5.2, with exact integrals of the piecewise linear functions.
fn estimated(functions: [Polyline; 3]) -> Matrix {
    let range = [380.0, 780.0];
    let area: Vector = core::array::from_fn(|c| integral(&[&functions[c]], range));
    let gram = core::array::from_fn(|i| {
        core::array::from_fn(|j| integral(&[&functions[i], &functions[j]], range) / (area[i] * area[j]))
    });
    let dual = inverse(&gram);
    let triple: [Matrix; 3] = core::array::from_fn(|a| {
        core::array::from_fn(|b| {
            core::array::from_fn(|c| {
                let all = [&functions[a], &functions[b], &functions[c]];
                integral(&all, range) / (area[a] * area[b] * area[c])
            })
        })
    });
    let coefficient = |c: usize, d: usize, e: usize| {
        let mut sum = Wide::ZERO;
        for a in 0..3 {
            for b in 0..3 {
                sum += dual[d][a] * dual[e][b] * triple[a][b][c];
            }
        }
        sum
    };
    nearest(&core::array::from_fn(|e| core::array::from_fn(|c| core::array::from_fn(|d| coefficient(c, d, e)))))
}

/// The functions of a space: M diag(W) (x̄/∫x̄, …) at 10 nm.
fn functions(space: &RgbSpace, white: [f64; 2]) -> [Polyline; 3] {
    let cmf = Polyline::of_observer(&observers::CIE_1931_2);
    let wavelengths: Vec<f64> = (0..41).map(|i| 380.0 + 10.0 * f64::from(i)).collect();
    let at = |c: usize| wavelengths.iter().map(|w| cmf[c].value((*w).into())).collect::<Vec<_>>();
    let xyz = [at(0), at(1), at(2)];
    let coarse = xyz.each_ref().map(|values| Polyline::new(wavelengths.clone(), values.clone(), false));
    let area = coarse.each_ref().map(|line| integral(&[line], [380.0, 780.0]));
    let [x, y] = white.map(Wide::from);
    let white = [x / y, Wide::ONE, (1.0 - x - y) / y];
    let to_rgb = inverse(&matrix(space.primaries(), [white[0], white[1], white[2]]));
    let rgb: Vec<Vector> =
        (0..41).map(|i| apply(&to_rgb, core::array::from_fn(|a| xyz[a][i] / area[a] * white[a]))).collect();
    core::array::from_fn(|c| Polyline::new(wavelengths.clone(), rgb.iter().map(|v| v[c]).collect(), false))
}

const ESTIMATED: [(RgbSpace, [f64; 2]); 3] = [
    (RgbSpace::REC_709, [0.3127, 0.3290]),
    (RgbSpace::REC_2020, [0.3127, 0.3290]),
    (RgbSpace::ACESCG, [0.321_68, 0.337_67]),
];

fn compare_transfer<R: Real>(gauge: &mut Gauge, got: &Tensor<R>, exact: Matrix) {
    for (got, exact) in got.transfer().as_flattened().iter().zip(exact.as_flattened()) {
        gauge.compare(*got, *exact);
    }
}

/// Coefficients of three spaces.
pub fn estimate_rgb<R: Real>(gauge: &mut Gauge) {
    gauge.note("Rec. 709, Rec. 2020, ACEScg");
    for (space, white) in ESTIMATED {
        let Ok(found) = bilinear::estimate_rgb::<R>(&space) else { return gauge.require(false) };
        compare_transfer(gauge, &found.tensor, estimated(functions(&space, white)));
    }
}

/// Coefficients of the functions x̄, ȳ, z̄ at 10 nm.
pub fn estimate<R: Real>(gauge: &mut Gauge) {
    gauge.note("x̄, ȳ, z̄ at 10 nm");
    let observer = Observer::<R>::cie_1931_2deg();
    let cmf = Polyline::of_observer(&observers::CIE_1931_2);
    let wavelengths: Vec<f64> = (0..41).map(|i| 380.0 + 10.0 * f64::from(i)).collect();
    let lines = cmf.each_ref().map(|line| {
        let values = wavelengths.iter().map(|w| line.value((*w).into())).collect();
        Polyline::new(wavelengths.clone(), values, false)
    });
    match bilinear::estimate(41, |index| observer.value(R::from_usize(380 + 10 * index))) {
        Ok(found) => compare_transfer(gauge, &found.tensor, estimated(lines)),
        Err(_) => gauge.require(false),
    }
}

fn measure_constant<R: Real>(gauge: &mut Gauge, tensor: &Tensor<R>, (space, white): (RgbSpace, [f64; 2])) {
    gauge.note("against the estimate from the colour-matching functions");
    compare_transfer(gauge, tensor, estimated(functions(&space, white)));
}

/// The constants for Rec. 709.
pub fn rec_709<R: Real>(gauge: &mut Gauge) {
    measure_constant(gauge, &Tensor::<R>::rec_709(), ESTIMATED[0]);
}

/// The constants for Rec. 2020.
pub fn rec_2020<R: Real>(gauge: &mut Gauge) {
    measure_constant(gauge, &Tensor::<R>::rec_2020(), ESTIMATED[1]);
}

/// The constants for ACEScg.
pub fn acescg<R: Real>(gauge: &mut Gauge) {
    measure_constant(gauge, &Tensor::<R>::acescg(), ESTIMATED[2]);
}

const RANGE: [f64; 2] = [380.0, 780.0];
const LAMPS: [&UniformTable; 3] = [&illuminants::D65, &illuminants::A, &fluorescent::FL2];
const PAINTS: [&UniformTable; 4] =
    [&colorchecker::GREEN, &colorchecker::RED, &colorchecker::BLUE, &colorchecker::DARK_SKIN];

/// Linear Rec. 709 of a product of spectra relative to ∫ȳ, and the sum of the magnitudes it is made of.
fn rgb(factors: &[&Polyline]) -> [[Wide; 2]; 3] {
    let cmf = Polyline::of_observer(&observers::CIE_1931_2);
    let unit = integral(&[&cmf[1]], RANGE);
    let xyz: Vector = core::array::from_fn(|a| {
        let all: Vec<&Polyline> = factors.iter().copied().chain([&cmf[a]]).collect();
        integral(&all, RANGE) / unit
    });
    let [x, y] = [0.3127, 0.3290].map(Wide::from);
    let to_rgb = inverse(&matrix(RgbSpace::REC_709.primaries(), [x / y, Wide::ONE, (1.0 - x - y) / y]));
    to_rgb.map(|row| {
        let terms: Vector = core::array::from_fn(|i| row[i] * xyz[i]);
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

/// ½ + u/(2√(1 + u²)), without the difference.
fn sigmoid_of(u: Wide) -> Wide {
    let root = (u.squared() + 1.0).sqrt();
    let low = 0.5 / (root * (root + u.abs()));
    if u < 0.0 { low } else { 1.0 - low }
}

/// A sigmoid's argument at a wavelength, and the sum of its terms' magnitudes.
fn polynomial(c: Vector, wavelength: Wide) -> [Wide; 2] {
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
fn seen(weights: &[[Wide; 3]], line: impl Fn(usize) -> Wide) -> Vector {
    let mut sums = [[Wide::ZERO; 3]; 2];
    for (node, weight) in weights.iter().enumerate() {
        let value = line(node);
        for a in 0..3 {
            sums[0][a] += weight[a] * value;
            sums[1][a] += weight[a];
        }
    }
    let [x, y] = [0.3127, 0.3290].map(Wide::from);
    let to_rgb = inverse(&matrix(RgbSpace::REC_709.primaries(), [x / y, Wide::ONE, (1.0 - x - y) / y]));
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

type Emitter<R> = LightUpsampler<spectral_core::spectrum::Uniform<'static, R>, R>;

/// Emissions for colours, with D65 at the nodes.
fn each_emission<R: Real>(
    gauge: &mut Gauge,
    axes: &[Axis; 3],
    mut measure: impl FnMut(
        &mut Gauge,
        &Emitter<R>,
        &Emission<spectral_core::spectrum::Uniform<'static, R>, R>,
        [R; 3],
        Vector,
    ),
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
    let column = |table: &spectral_core::tables::BinTable, bin: usize| Wide::from(table.samples.double[bin]);
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
