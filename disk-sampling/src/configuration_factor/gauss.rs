//! Gauss–Legendre rule with panels that shrink towards the integrand's poles.

use spectral_core::Real;

/// The positive nodes on [−1, 1] and their weights, n = 6 and 12 (Abramowitz & Stegun, table 25.4; recomputed to 20 digits).
const SIX: [(f64, f64); 3] = [
    (0.238_619_186_083_196_9, 0.467_913_934_572_691),
    (0.661_209_386_466_264_5, 0.360_761_573_048_138_6),
    (0.932_469_514_203_152, 0.171_324_492_379_170_35),
];
const TWELVE: [(f64, f64); 6] = [
    (0.125_233_408_511_468_9, 0.249_147_045_813_402_7),
    (0.367_831_498_998_180_2, 0.233_492_536_538_354_6),
    (0.587_317_954_286_617_5, 0.203_167_426_723_065_73),
    (0.769_902_674_194_304_7, 0.160_078_328_543_346_42),
    (0.904_117_256_370_474_8, 0.106_939_325_995_319_07),
    (0.981_560_634_246_719_2, 0.047_175_336_386_511_41),
];

/// Panels at most: two approaches to poles as near as the last digit, by a factor of 0.4 a panel, need fewer.
const PANELS: usize = 160;

/// ∫ `integrand` over [0, `end`], when the nearest pole is `distance`(x) from x in the complex plane, or farther.
///
/// The poles of each panel are at least 2.8 half lengths from its middle: 12 nodes err by about
/// (2.8 + √(2.8² − 1))⁻²⁴ ≈ 10⁻¹⁷ of the integrand's size around it. 6 nodes do as well with poles at 24 half lengths (for
/// `f32` at 5.6).
pub(super) fn integrate<R: Real>(end: R, distance: impl Fn(R) -> R, integrand: impl Fn(R) -> R) -> R {
    // A panel can be 1.1 distances long where poles fall behind, and 0.52 where they come up.
    let (receding, nearing) = (R::from_f64(1.1), R::from_f64(0.52));
    let (reach, far) = (R::from_f64(1.4), R::from_f64(if R::EPSILON.to_f64() > 1e-10 { 2.8 } else { 12.0 }));
    let shortest = end * R::EPSILON;
    let mut sum = R::ZERO;
    let mut start = R::ZERO;
    for _ in 0..PANELS {
        let rest = end - start;
        let near = distance(start);
        let long = rest.min(receding * near);
        let step = if distance(start + R::HALF * long) >= reach * long { long } else { nearing * near };
        let length = rest.min(step.max(shortest));
        let six = distance(start + R::HALF * length) >= far * length;
        sum += if six { panel(&SIX, start, length, &integrand) } else { panel(&TWELVE, start, length, &integrand) };
        if length >= rest {
            break;
        }
        start += length;
    }
    sum
}

/// ∫ `integrand` over [`start`, `start` + `length`] by one rule.
fn panel<R: Real>(nodes: &[(f64, f64)], start: R, length: R, integrand: &impl Fn(R) -> R) -> R {
    let half = R::HALF * length;
    let middle = start + half;
    let mut sum = R::ZERO;
    for &(node, weight) in nodes {
        let offset = half * R::from_f64(node);
        sum += R::from_f64(weight) * (integrand(middle - offset) + integrand(middle + offset));
    }
    sum * half
}

/// ∫ `integrand` over [0, 1] by six nodes.
pub(super) fn integrate_smooth<R: Real>(integrand: impl Fn(R) -> R) -> R {
    panel(&SIX, R::ZERO, R::ONE, &integrand)
}
