//! Integrals over an angle, without cancellation.

use spectral_core::Real;

/// ∫ cos² γ dγ between the angles of the given tangents, which differ by `gap`.
pub(super) fn squared_cosine<R: Real>([low, high]: [R; 2], gap: R) -> R {
    let product = low * high;
    let g = ((R::ONE + low * low) * (R::ONE + high * high)).sqrt();
    let angle = gap.atan2(R::ONE + product);
    let sine = gap / g;
    // 1 + cos of the sum of both angles.
    let sum = if product > R::ONE {
        let s = low + high;
        s * s / (g * (g + product - R::ONE))
    } else {
        R::ONE + (R::ONE - product) / g
    };
    R::HALF * (angle_minus_sine(angle, sine) + sine * sum)
}

/// x − sin x, `sine` being sin x.
fn angle_minus_sine<R: Real>(x: R, sine: R) -> R {
    let x2 = x * x;
    if x2 > R::from_f64(0.25) {
        return x - sine;
    }
    let mut term = x * x2 / R::from_f64(6.0);
    let mut sum = term;
    for k in [20.0, 42.0, 72.0, 110.0, 156.0, 210.0] {
        term = -term * x2 / R::from_f64(k);
        sum += term;
    }
    sum
}
