//! Scaling by powers of two, which changes no digit.

use spectral_core::Real;

/// A power of two within a factor of two of 1 / `size`; None for zero, infinity and NaN.
pub(super) fn power_of_two<R: Real>(size: R) -> Option<R> {
    if !(size > R::ZERO && size.is_finite()) {
        return None;
    }
    let exponent = size.to_f64().to_bits() >> 52;
    // Keeps the scale itself finite and normal in both precisions.
    let (low, high) = if R::EPSILON.to_f64() < 1e-10 { (1, 2044) } else { (1023 - 126, 1023 + 125) };
    Some(R::from_f64(f64::from_bits((2046 - exponent.clamp(low, high)) << 52)))
}
