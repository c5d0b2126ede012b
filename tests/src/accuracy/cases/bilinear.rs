//! Bilinear products of three components, in 106 bits.

use spectral_core::bilinear::{self, Tensor};
use spectral_core::colour::RgbSpace;
use spectral_core::tables::observers;
use spectral_core::{Observer, Real};

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
