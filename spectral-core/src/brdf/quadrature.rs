//! The albedo by quadrature over the slopes of half vectors.

use super::antithetic::{Axis, Lobe};
use crate::Real;

/// Positive nodes and weights of the Gauss–Legendre rule of 16 points on [−1, 1] (Abramowitz & Stegun, table 25.4).
const GAUSS: [(f64, f64); 8] = [
    (0.095_012_509_837_637_44, 0.189_450_610_455_068_64),
    (0.281_603_550_779_258_9, 0.182_603_415_044_923_64),
    (0.458_016_777_657_227_37, 0.169_156_519_395_002_65),
    (0.617_876_244_402_643_8, 0.149_595_988_816_576_7),
    (0.755_404_408_355_003, 0.124_628_971_255_534_07),
    (0.865_631_202_387_831_8, 0.095_158_511_682_492_6),
    (0.944_575_023_073_232_6, 0.062_253_523_938_647_456),
    (0.989_400_934_991_649_9, 0.027_152_459_411_754_176),
];

/// ∫ f over [a, b] by the rule of 16 points.
fn gauss<R: Real>(a: R, b: R, mut f: impl FnMut(R) -> R) -> R {
    let (middle, half) = ((a + b) * R::HALF, (b - a) * R::HALF);
    let mut sum = R::ZERO;
    for (node, weight) in GAUSS {
        let step = half * R::from_f64(node);
        sum += R::from_f64(weight) * (f(middle - step) + f(middle + step));
    }
    sum * half
}

/// The same with points graded towards `a`: near the horizon, the weights there change within the distance from 0.
fn graded<R: Real>(a: R, b: R, mut f: impl FnMut(R) -> R) -> R {
    let length = b - a;
    gauss(R::ZERO, R::ONE, |t| R::TWO * t * f(a + length * t * t)) * length
}

/// ∫∫ (w(s) + w(−s))/2 dF dψ/π over half a turn, w = 0 below the horizon, in the lobe's smooth coordinate.
///
/// The azimuth is counted from where it is perpendicular to the view and graded towards it: near the horizon the weights
/// change there within an angle of about cos θ over the roughness.
pub(super) fn albedo<R: Real, L: Lobe<R>>(lobe: &L, view: [R; 3]) -> R {
    let [a, b] = lobe.stretch();
    let across = (a * view[0]).atan2(-(b * view[1]));
    let steepness = (a * view[0]).hypot(b * view[1]) / view[2];
    let grade = (R::TWO + steepness).ln();
    let quarter = |sign: R| {
        gauss(R::ZERO, R::ONE, |g| {
            let rise = (grade * g).exp_m1() / grade.exp_m1();
            let slope = grade * (grade * g).exp() / grade.exp_m1();
            let psi = across + sign * rise * R::PI * R::HALF;
            slope * over_slopes(lobe, &Axis::new(lobe, view, [psi.cos(), psi.sin()]))
        })
    };
    // Mirror-symmetric about the plane of the view if isotropic.
    if a == b { quarter(R::ONE) } else { (quarter(R::ONE) + quarter(-R::ONE)) * R::HALF }
}

/// ∫ (w(s) + w(−s))/2 dF along an azimuth, in pieces: both slopes reflect above the horizon, then one; what is typical
/// is integrated in closed form.
fn over_slopes<R: Real, L: Lobe<R>>(lobe: &L, axis: &Axis<R>) -> R {
    let horizon = axis.horizon();
    let split = lobe.chart(R::ONE / horizon / axis.spread);
    let end = lobe.chart(horizon / axis.spread);
    let typical = lobe.typical_weight();
    let at = |x: R| {
        let (y, density) = lobe.unchart(x);
        let epsilon = y * axis.spread;
        density * ((axis.weight(lobe, epsilon) + axis.weight(lobe, -epsilon)) * R::HALF - typical)
    };
    let pieces = if lobe.has_kink() {
        // At ε = c/v_z, which is below the horizon's.
        let kink = lobe.chart(axis.along.abs() / axis.view_z / axis.spread);
        let (low, high) = (split.min(kink), split.max(kink));
        gauss(R::ZERO, low, at) + gauss(low, high, at) + graded(high, end, at)
    } else {
        gauss(R::ZERO, split, at) + graded(split, end, at)
    };
    typical * lobe.cumulative(lobe.unchart(end).0) + pieces
}
