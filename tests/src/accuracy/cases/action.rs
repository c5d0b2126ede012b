//! Action spectra and their projections onto the colour-matching functions, in 106 bits.

use spectral_core::Real;
use spectral_core::action::{ActionSpectra, CIRCADIAN_XYZ, Projection, RADIANCE_RGB_TO_XYZ, Weighting};
use spectral_core::spectrum::Outside;
use spectral_core::summation::tristimulus_sum;
use spectral_core::tables::{self, UniformTable};

use super::adaptation::colours;
use super::lights::{Colour, GRID, LAMPS, N, Sums, exact_light, lights, observer, sampled};
use crate::accuracy::gauge::Gauge;
use crate::accuracy::lines::Polyline;
use crate::accuracy::wide::{Wide, apply, dot, inverse, wide, wides};

/// Luminous efficacy, a_cv, photosynthesis and α-opic ratios.
pub fn action<R: Real>(gauge: &mut Gauge) {
    gauge.note(LAMPS);
    let (spectra, observer, sums) = (ActionSpectra::<R, N>::new(GRID), observer::<R>(), Sums::new());
    let table = |table: &UniformTable| sampled(&Polyline::of_table(table, false));
    let (pas, melanopic) = (table(&tables::action::PAS), table(&tables::alpha_opic::MELANOPIC));
    for light in lights::<R>() {
        let exact = exact_light(&light);
        let [x, y, z] = sums.xyz(&exact);
        let total = |weights: &[Wide]| exact.iter().zip(weights).fold(Wide::ZERO, |sum, (a, b)| sum + *a * *b);
        let Some(found) = spectra.measure(&light, tristimulus_sum(&observer, &light), R::ONE) else {
            return gauge.require(false);
        };
        let [a, b, c] = CIRCADIAN_XYZ.map(Wide::from);
        let efficacy = Wide::decimal("683.002");
        gauge.compare(found.luminous_efficacy, efficacy * y / total(&[Wide::ONE; N]));
        gauge.compare_to(found.acv, (a * x + b * y + c * z) / y, (b * y + c * z) / y);
        gauge.compare(found.sy, total(&pas) * 5.0);
        gauge.compare(found.sy_ratio, total(&pas) / y);
        let ratio = total(&melanopic) / y / efficacy * 1000.0;
        gauge.compare(found.alpha_opic.efficacy[4], ratio);
        gauge.compare(found.alpha_opic.melanopic_der(), ratio / Wide::decimal("1.3262"));
    }
}

fn weighting<R: Real>() -> Weighting<R, N> {
    Weighting::new(GRID, &tables::alpha_opic::MELANOPIC.spectrum::<R>(Outside::Zero))
}

/// Ω of a light.
pub fn weighting_apply<R: Real>(gauge: &mut Gauge) {
    gauge.note(LAMPS);
    let weighting = weighting::<R>();
    for light in lights::<R>() {
        let terms = weighting.weights().iter().zip(&light).map(|(w, s)| wide(*w) * wide(*s));
        gauge.compare(weighting.apply(&light), terms.fold(Wide::ZERO, |sum, x| sum + x) * 5.0);
    }
}

/// The projection by the Gramian matrix of the rounded functions.
fn projected<R: Real>(observer: &[[R; 3]; N], weighting: &Weighting<R, N>) -> (Colour, Wide) {
    let column = |a: usize| observer.iter().map(move |cmf| wide(cmf[a])).collect::<Vec<_>>();
    let columns = [column(0), column(1), column(2)];
    let weights: Vec<Wide> = weighting.weights().iter().map(|w| wide(*w)).collect();
    let inner = |a: &[Wide], b: &[Wide]| a.iter().zip(b).fold(Wide::ZERO, |sum, (a, b)| sum + *a * *b);
    let gram = core::array::from_fn(|i| core::array::from_fn(|j| inner(&columns[i], &columns[j])));
    let k = apply(&inverse(&gram), core::array::from_fn(|i| inner(&columns[i], &weights)));
    let rest: Vec<Wide> = (0..N).map(|n| weights[n] - dot(k, [columns[0][n], columns[1][n], columns[2][n]])).collect();
    (k, (inner(&rest, &rest) / inner(&weights, &weights)).sqrt())
}

/// k_x, k_y, k_z of the melanopic function.
pub fn projection<R: Real>(gauge: &mut Gauge) {
    gauge.note("the melanopic function at 5 nm");
    let (observer, weighting) = (observer::<R>(), weighting::<R>());
    let (k, residual) = projected(&observer, &weighting);
    let Some(found) = Projection::new(&observer, &weighting) else { return gauge.require(false) };
    gauge.compare_all(found.coefficients, k);
    gauge.compare(found.residual, residual);
}

/// Ψ of tristimulus values, in ULP of its terms.
pub fn projection_apply<R: Real>(gauge: &mut Gauge) {
    let Some(found) = Projection::new(&observer::<R>(), &weighting::<R>()) else { return gauge.require(false) };
    gauge.each(&colours(), |gauge, xyz: [R; 3]| {
        let terms: Colour = core::array::from_fn(|i| wide(found.coefficients[i]) * wide(xyz[i]));
        let size = terms.map(Wide::abs);
        gauge.compare_to(found.apply(xyz), terms[0] + terms[1] + terms[2], size[0] + size[1] + size[2]);
    });
}

/// (r, g, b) of Ψ, in ULP of their terms.
pub fn projection_rgb<R: Real>(gauge: &mut Gauge) {
    gauge.note("the melanopic function at 5 nm, Radiance's primaries");
    let Some(found) = Projection::new(&observer::<R>(), &weighting::<R>()) else { return gauge.require(false) };
    for (channel, got) in found.rgb(&RADIANCE_RGB_TO_XYZ).into_iter().enumerate() {
        let terms: Colour = core::array::from_fn(|i| wide(found.coefficients[i]) * RADIANCE_RGB_TO_XYZ[i][channel]);
        let size = terms.map(Wide::abs);
        gauge.compare_to(got, terms[0] + terms[1] + terms[2], size[0] + size[1] + size[2]);
    }
}

/// (Ψ − Ω)/Ω.
pub fn projection_error<R: Real>(gauge: &mut Gauge) {
    gauge.note(LAMPS);
    let (observer, weighting) = (observer::<R>(), weighting::<R>());
    let Some(found) = Projection::new(&observer, &weighting) else { return gauge.require(false) };
    for light in lights::<R>() {
        let exact = exact_light(&light);
        let sum = |weight: &dyn Fn(usize) -> Wide| (0..N).fold(Wide::ZERO, |sum, n| sum + weight(n) * exact[n]);
        let omega = sum(&|n| wide(weighting.weights()[n]));
        let psi = sum(&|n| dot(wides(found.coefficients), wides(observer[n])));
        gauge.compare_to(found.relative_error(&observer, &weighting, &light), (psi - omega) / omega, Wide::ONE);
    }
}
