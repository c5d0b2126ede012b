//! Sigmoids of quadratic polynomials.

use crate::Real;
use crate::spectrum::{Outside, Segment, Spectrum, interpolate};

/// Distance in nm between the nodes of a [`Sigmoid`] as a spectrum.
const STEP: usize = 5;
/// First and last node in nm.
const ENDS: [usize; 2] = [360, 830];

/// A smooth reflectance in [0, 1]: a sigmoid of a quadratic polynomial in wavelength.
///
/// ρ(λ) = ½ + U / (2 √(1 + U²)), U = c₀ + c₁ z + c₂ z², z = (λ − 580 nm) / 200 nm, which is [`smooth`](Self::smooth). As a
/// [`Spectrum`] it is *defined* as linear between its values at 360, 365, …, 830 nm, and held outside, so that it is
/// piecewise linear like every other spectrum.
///
/// Low reflectances are as accurate, relatively, as high ones: values at nodes are within 4 ε (1 + κ) relative, with κ how
/// much larger the terms of U are than U.
///
/// Source: Jakob and Hanika, A Low-Dimensional Function Space for Efficient Spectral Upsampling, 2019, equations 3–4.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sigmoid<R> {
    coefficients: [R; 3],
}

impl<R: Real> Sigmoid<R> {
    /// A sigmoid from c₀, c₁, c₂; `None` when one isn't finite.
    #[must_use]
    pub fn new(coefficients: [R; 3]) -> Option<Self> {
        coefficients.iter().all(|c| c.is_finite()).then_some(Self { coefficients })
    }

    /// The same value in [0, 1] at every wavelength; 0 and 1 are exact. Values outside are moved to the nearer end, NaN to 0.
    #[must_use]
    pub fn grey(value: R) -> Self {
        Self { coefficients: [argument(value), R::ZERO, R::ZERO] }
    }

    pub(super) const fn known(coefficients: [R; 3]) -> Self {
        Self { coefficients }
    }

    /// c₀, c₁ and c₂, in z = (λ − 580 nm) / 200 nm.
    #[must_use]
    pub const fn coefficients(&self) -> [R; 3] {
        self.coefficients
    }

    /// The coefficients of λ², λ and 1 with λ in nm, in `f64`: as in the paper, and in renderers that use its tables.
    #[must_use]
    pub fn nanometre_coefficients(&self) -> [f64; 3] {
        let [c0, c1, c2] = self.coefficients.map(R::to_f64);
        let (quadratic, linear) = (c2 / 4e4, c1 / 200.0);
        [quadratic, linear - 1160.0 * quadratic, c0 - 580.0 * linear + 336_400.0 * quadratic]
    }

    /// The sigmoid itself at a wavelength in nm, without interpolation.
    ///
    /// The piecewise linear spectrum differs from it by at most 0.003 for colours of sRGB with components in [0.1, 0.9], and by at
    /// most 0.03 for those on the faces of the cube, where sigmoids are steepest.
    #[inline]
    #[must_use]
    pub fn smooth(&self, wavelength: R) -> R {
        sigmoid(polynomial(self.coefficients, position(wavelength)))
    }
}

/// z of a wavelength in nm.
#[inline]
pub(super) fn position<R: Real>(wavelength: R) -> R {
    (wavelength - R::from_f64(580.0)) / R::from_f64(200.0)
}

#[inline]
pub(super) fn polynomial<R: Real>([c0, c1, c2]: [R; 3], z: R) -> R {
    c0 + z * (c1 + z * c2)
}

/// ½ + u / (2 √(1 + u²)), accurate relative to the result where that is small.
#[inline]
fn sigmoid<R: Real>(u: R) -> R {
    let root = (R::ONE + u * u).sqrt();
    let low = R::HALF / (root * (root + u.abs()));
    if u < R::ZERO { low } else { R::ONE - low }
}

/// The sigmoid at u and its derivative, 1 / (2 (1 + u²)^(3/2)).
#[inline]
pub(super) fn sigmoid_and_slope<R: Real>(u: R) -> [R; 2] {
    let root = (R::ONE + u * u).sqrt();
    let inverse = R::ONE / root;
    let low = R::HALF * inverse / (root + u.abs());
    [if u < R::ZERO { low } else { R::ONE - low }, R::HALF * inverse * inverse * inverse]
}

/// The u for which the sigmoid is `value`: (v − ½) / √(v (1 − v)); so large at 0 and 1 that the sigmoid is exactly that.
pub(super) fn argument<R: Real>(value: R) -> R {
    // Its square overflows.
    let far = R::TWO * R::MAX.sqrt();
    if value >= R::ONE {
        far
    } else if value > R::ZERO {
        (value - R::HALF) / (value.sqrt() * (R::ONE - value).sqrt())
    } else {
        -far
    }
}

impl<R: Real> Spectrum<R> for Sigmoid<R> {
    fn segment(&self, wavelength: R) -> Segment<R> {
        between_nodes(wavelength, |node| self.smooth(node), Outside::Hold)
    }
}

/// The linear piece from `wavelength` on, of a function whose values at the nodes are given.
pub(super) fn between_nodes<R: Real>(wavelength: R, value: impl Fn(R) -> R, outside: Outside) -> Segment<R> {
    let [first, last] = ENDS.map(R::from_usize);
    let flat = |end, node| {
        let held = if outside == Outside::Hold { value(node) } else { R::ZERO };
        Segment { end, first: held, last: held }
    };
    if wavelength < first {
        return flat(first, first);
    }
    if wavelength >= last || wavelength.is_nan() {
        return flat(R::INFINITY, last);
    }
    // Rounding is monotone, so that the quotient of a wavelength below a node is never above that node's; it may be equal.
    let step = R::from_usize(STEP);
    let mut start = (wavelength / step).floor() * step;
    if start > wavelength {
        start -= step;
    }
    let end = start + step;
    let (low, high) = (value(start), value(end));
    Segment { end, first: interpolate(low, high, wavelength - start, end - wavelength), last: high }
}
