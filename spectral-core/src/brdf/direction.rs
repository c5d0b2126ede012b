//! Directions in a surface's frame.

use super::BrdfError;
use crate::Real;

/// The unit vector along `vector`, to rounding; any scale, from subnormal to the largest numbers.
///
/// # Errors
/// [`BrdfError::Direction`] for a vector that is zero, infinite or NaN.
pub fn direction<R: Real>(vector: [R; 3]) -> Result<[R; 3], BrdfError> {
    let largest = vector.iter().fold(R::ZERO, |m, x| m.max(x.abs()));
    if !vector.iter().all(|x| x.is_finite()) || !(largest > R::ZERO) {
        return Err(BrdfError::Direction);
    }
    let scaled = vector.map(|x| x / largest);
    let length = dot(scaled, scaled).sqrt();
    Ok(scaled.map(|x| x / length))
}

/// The smallest cosine that the models tell from zero, ε² (1.4·10⁻¹⁴ in `f32`, 4.9·10⁻³² in `f64`): small enough for what
/// it replaces to be rounding, large enough for its square's reciprocal to be finite.
pub(super) fn floor<R: Real>() -> R {
    R::EPSILON * R::EPSILON
}

/// The direction if it is above the surface, its cosine not below [`floor`]; `None` also if a component is NaN or above 2.
#[inline]
pub(super) fn above<R: Real>(direction: [R; 3]) -> Option<[R; 3]> {
    let [x, y, z] = direction;
    let usable = x.abs() <= R::TWO && y.abs() <= R::TWO && z > R::ZERO && z <= R::TWO;
    usable.then(|| [x, y, z.max(floor())])
}

#[inline]
pub(super) fn dot<R: Real>(a: [R; 3], b: [R; 3]) -> R {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// The slope of the half vector of two directions above the surface, and the sum of their cosines.
///
/// Each component of the sum is rounded once, so that the slope is accurate to 1 ε however near to the horizon.
#[inline]
pub(super) fn half_slope<R: Real>(light: [R; 3], view: [R; 3]) -> ([R; 2], R) {
    let height = light[2] + view[2];
    ([(light[0] + view[0]) / height, (light[1] + view[1]) / height], height)
}

/// −ln(1 − p) for p in [0, 1), accurate also for small p (Kahan's way: the rounding of 1 − p divides out).
#[inline]
pub(super) fn minus_ln_1m<R: Real>(p: R) -> R {
    let rest = R::ONE - p;
    let removed = R::ONE - rest;
    if removed > R::ZERO { -rest.ln() * (p / removed) } else { p }
}

/// A random number limited to [0, 1 − ε/2].
#[inline]
pub(super) fn unit<R: Real>(u: R) -> R {
    u.clamp(R::ZERO, R::ONE - R::EPSILON * R::HALF)
}
