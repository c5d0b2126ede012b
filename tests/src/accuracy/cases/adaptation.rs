//! Chromatic adaptation in 106 bits.

use spectral_core::Real;
use spectral_core::adaptation::{Adaptation, BRADFORD, Cie1994, Cie1994Conditions, VON_KRIES, von_kries_uv};
use spectral_core::colour::{self, xyz};

use super::lights::Colour;
use crate::accuracy::gauge::{Axis, Gauge};
use crate::accuracy::wide::{Wide, apply, inverse, wides};

fn whites<R: Real>() -> [[R; 3]; 4] {
    [xyz::WHITE_D65, xyz::WHITE_A, xyz::WHITE_E, [1.0, 1.0, 0.15]].map(colour::in_precision)
}

/// Calls for each pair of whites with their cone responses.
fn each_adaptation<R: Real>(mut each: impl FnMut([R; 3], [R; 3])) {
    for from in whites() {
        for to in whites() {
            each(from, to);
        }
    }
}

fn exact_matrix(matrix: &[[f64; 3]; 3]) -> [Colour; 3] {
    matrix.map(|row| row.map(Wide::from))
}

/// M⁻¹ diag(ρ′/ρ) M XYZ.
pub(super) fn scaled(matrix: &[[f64; 3]; 3], from: Colour, to: Colour, xyz: Colour) -> Colour {
    let m = exact_matrix(matrix);
    let (before, after, cones) = (apply(&m, from), apply(&m, to), apply(&m, xyz));
    apply(&inverse(&m), core::array::from_fn(|i| cones[i] * after[i] / before[i]))
}

pub(super) fn colours() -> [Axis; 3] {
    ["X", "Y", "Z"].map(|name| Axis::linear(name, 0.0, 1.2).list(&[0.5]))
}

fn measure_adaptation<R: Real>(
    gauge: &mut Gauge,
    matrix: &[[f64; 3]; 3],
    make: impl Fn([R; 3], [R; 3]) -> Adaptation<R>,
) {
    gauge.effort(0.2);
    gauge.note("between D65, A, E and a yellow light");
    each_adaptation(|from: [R; 3], to| {
        let adaptation = make(from, to);
        gauge.each(&colours(), |gauge, xyz: [R; 3]| {
            let exact = scaled(matrix, wides(from), wides(to), wides(xyz));
            for (got, exact) in adaptation.apply(xyz).into_iter().zip(exact) {
                gauge.compare_to(got, exact, Wide::from(1.5));
            }
        });
    });
}

/// Bradford's.
pub fn bradford<R: Real>(gauge: &mut Gauge) {
    measure_adaptation::<R>(gauge, &BRADFORD, Adaptation::bradford);
}

/// Von Kries's.
pub fn von_kries<R: Real>(gauge: &mut Gauge) {
    measure_adaptation::<R>(gauge, &VON_KRIES, Adaptation::von_kries);
}

/// CIE 13.3's, equations of its section on adaptation.
pub(super) fn adapted_uv(sample: [Wide; 2], test: [Wide; 2], reference: [Wide; 2]) -> [Wide; 2] {
    let d = Wide::decimal;
    let ratios = |[u, v]: [Wide; 2]| [(4.0 - u - v * 10.0) / v, (d("1.708") * v + d("0.404") - d("1.481") * u) / v];
    let ([c_s, d_s], [c_t, d_t], [c_r, d_r]) = (ratios(sample), ratios(test), ratios(reference));
    let (c, e) = (c_r / c_t * c_s, d_r / d_t * d_s);
    let below = d("16.518") + d("1.481") * c - e;
    [(d("10.872") + d("0.404") * c - e * 4.0) / below, d("5.520") / below]
}

/// Chromaticities between fluorescent lamps' and the locus.
pub fn von_kries_uv_case<R: Real>(gauge: &mut Gauge) {
    let axes = [
        Axis::linear("u", 0.15, 0.35),
        Axis::linear("v", 0.27, 0.36),
        Axis::linear("u_t", 0.19, 0.27),
        Axis::linear("v_t", 0.30, 0.35),
        Axis::linear("u_r", 0.19, 0.27),
        Axis::linear("v_r", 0.30, 0.35),
    ];
    gauge.each(&axes, |gauge, [a, b, c, d, e, f]: [R; 6]| {
        let exact = adapted_uv(wides([a, b]), wides([c, d]), wides([e, f]));
        for (got, exact) in von_kries_uv([a, b], [c, d], [e, f]).into_iter().zip(exact) {
            gauge.compare_to(got, exact, Wide::from(0.375));
        }
    });
}

/// CIE 109-1994 at 1000 lux, Y_o = 20, n = 1 (Nayatani, Sobagaki and Hashimoto 1997; CIE 109, section 3).
pub(super) fn nayatani(from: Colour, to: Colour, xyz: Colour) -> Colour {
    let d = Wide::decimal;
    let m = exact_matrix(&VON_KRIES);
    let (percent, noise) = (20.0, Wide::ONE);
    let xi = [from, to].map(|white| apply(&m, white).map(|c| c / white[1]));
    let luminance = Wide::from(20.0 * 1000.0) / (Wide::PI * 100.0);
    let beta_1 = |r: Wide| {
        let power = r.powf(d("0.4495"));
        (d("6.469") + d("6.362") * power) / (d("6.469") + power)
    };
    let beta_2 = |r: Wide| {
        let power = r.powf(d("0.5128"));
        d("0.7844") * (d("8.414") + d("8.091") * power) / (d("8.414") + power)
    };
    let beta = xi.map(|[r, g, b]| [beta_1(r * luminance), beta_1(g * luminance), beta_2(b * luminance)]);
    let part = |field: usize, cone: usize, share: f64| {
        let x = xi[field][cone];
        ((x * percent + noise) / (x * 20.0 + noise)).powf(beta[field][cone] * share / 3.0)
    };
    let k = part(0, 0, 2.0) / part(1, 0, 2.0) * part(0, 1, 1.0) / part(1, 1, 1.0);
    let cones = apply(&m, xyz.map(|c| c * 100.0));
    let adapted = core::array::from_fn(|i| {
        let ratio = (cones[i] + noise) / (xi[0][i] * percent + noise);
        let level = xi[1][i] * percent + noise;
        let power = if ratio > 0.0 { ratio.powf(beta[0][i] / beta[1][i]) } else { Wide::ZERO };
        level * k.powf(1.0 / beta[1][i]) * power - noise
    });
    apply(&inverse(&m), adapted).map(|c| c / 100.0)
}

/// CIE 109's non-linear transform.
pub fn cie_1994<R: Real>(gauge: &mut Gauge) {
    gauge.effort(0.1);
    gauge.note("between D65, A, E and a yellow light, background 0.2, 1000 lux");
    each_adaptation(|from: [R; 3], to| {
        // The same conditions in both precisions: 0.2 isn't a binary number.
        let conditions = Cie1994Conditions { background: R::from_f64(0.2), ..Cie1994Conditions::default() };
        let transform = Cie1994::new(from, to, &conditions);
        gauge.each(&colours(), |gauge, xyz: [R; 3]| {
            let exact = nayatani(wides(from), wides(to), wides(xyz));
            for (got, exact) in transform.apply(xyz).into_iter().zip(exact) {
                gauge.compare_to(got, exact, Wide::from(1.5));
            }
        });
    });
}
