//! Spectra on an interval of wavelengths: a mean, a first-order colour error, and bounds on all that these leave out.
//!
//! Iehl and Péroche (2000) keep of a spectrum S on an interval only its mean m (their eq. 1) and signed errors
//! `e_a = ∫(S − m) ā` (eq. 2), and drop the integral ∫(S₁−m₁)(S₂−m₂) ā of a product. An [`Interval`] also keeps what bounds that
//! integral, so that the tristimulus values of any sum, scaling, product or Schlick reflection of spectra are known with a
//! radius that holds.
//!
//! With the per-channel mean `μ_a = m + e_a/I_a` (I_a = ∫ā), the second-order term of a product is known, too:
//! ∫S₁S₂ā = I_a μ₁μ₂ + ∫(S₁−μ₁)(S₂−μ₂) ā, and what is left is a covariance, bounded by Cauchy–Schwarz from the norms, or
//! from the range of one factor and the absolute deviation of the other, whichever is less.
//!
//! Every operator rounds its bounds outwards, so that they hold for the computed numbers, in `f32` and in `f64`. Where numbers
//! underflow, the bounds still hold, and are of the size of the least normal number; where they overflow, radii become infinite or
//! NaN, never too small. A spectrum's own values are taken to be exact to a few ε, which piecewise linear ones are as long as
//! they don't change sign between two nodes. [`Interval`]'s own bounds concern one interval; [`crate::adaptive`] sums them over the visible domain.

mod domain;
mod pyramid;

pub use domain::{BuildError, Domain, FIRST_WAVELENGTH, LAST_WAVELENGTH, MAX_DEPTH, Node, Weight, node_count, nodes};
pub use pyramid::Pyramid;

use crate::Real;
use crate::array::zip;

/// What is kept of a spectrum S on one interval, with ā running over x̄, ȳ, z̄ and I_a = ∫ā.
///
/// In the spectrum's own unit U (say W m⁻² sr⁻¹ nm⁻¹ or 1): `mean`, `low` and `high` in U, `error`, `absolute` and `radius` in
/// U nm, `norm` in U nm^½.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Interval<R> {
    /// The mean m = Σ_a I_a ∫Sā / Σ_a I_a² (Iehl–Péroche eq. 1).
    pub mean: R,
    /// The signed first-order error `e_a = ∫(S − m) ā` (Iehl–Péroche eq. 2), so that ∫Sā ≈ m I_a + e_a.
    pub error: [R; 3],
    /// At least the weighted norm about the channel's mean, (∫(S − μ_a)² ā)^½.
    pub norm: [R; 3],
    /// At least the weighted absolute deviation ∫|S − μ_a| ā.
    pub absolute: [R; 3],
    /// At most the least value of S on the interval.
    pub low: R,
    /// At least the greatest value of S on the interval.
    pub high: R,
    /// How far the true ∫Sā can be from m I_a + e_a; rounding alone for a spectrum that was integrated exactly.
    pub radius: [R; 3],
}

/// Relative slack that covers the rounding of one operator's bounds, in units of ε.
const SLACK: f64 = 16.0;

/// The relative error of a [`Weight`]'s I_a in units of ε: interpolation of ā (2), a piece's formula (1), the table rounded to the type
/// (½) and the compensated sum (2), with some to spare.
const WEIGHT_ROUNDING: f64 = 8.0;

#[inline]
fn outward<R: Real>() -> R {
    R::ONE + R::from_f64(SLACK) * R::EPSILON
}

#[inline]
fn each<R: Real>(f: impl FnMut(usize) -> R) -> [R; 3] {
    core::array::from_fn(f)
}

impl<R: Real> Interval<R> {
    /// A spectrum that has the same value all over the interval; the radius covers the rounding of the weight.
    pub fn constant(value: R, weight: &Weight<R>) -> Self {
        Self::zero().shifted(value, weight)
    }

    /// The spectrum 0.
    pub fn zero() -> Self {
        let none = [R::ZERO; 3];
        Self { mean: R::ZERO, error: none, norm: none, absolute: none, low: R::ZERO, high: R::ZERO, radius: none }
    }

    /// The deviation s = sup |S − m|, at least.
    pub fn deviation(&self) -> R {
        (self.high - self.mean).max(self.mean - self.low) * outward()
    }

    /// The tristimulus values of zeroth order, m I_a: what Iehl and Péroche take as the value.
    #[inline]
    pub fn mean_tristimulus(&self, weight: &Weight<R>) -> [R; 3] {
        weight.integral.map(|integral| self.mean * integral)
    }

    /// The tristimulus values of first order, m I_a + e_a, within [`radius`](Self::radius) of the true ones.
    #[inline]
    pub fn tristimulus(&self, weight: &Weight<R>) -> [R; 3] {
        zip(weight.integral, self.error, |integral, error| self.mean * integral + error)
    }

    /// The greatest |S| on the interval, at least.
    #[inline]
    fn magnitude(&self) -> R {
        self.low.abs().max(self.high.abs())
    }

    /// Half the width of S's range, at least.
    #[inline]
    fn half_range(&self) -> R {
        (self.high - self.low) * R::HALF + R::TWO * R::EPSILON * (self.low.abs() + self.high.abs())
    }

    /// The radius with what rounding can add to m I_a + e_a in one operator, and a margin for underflow.
    #[inline]
    fn rounded(&self, weight: &Weight<R>, a: usize) -> R {
        let size = (self.mean * weight.integral[a]).abs() + self.error[a].abs();
        self.radius[a] * outward() + (R::from_f64(4.0) * R::EPSILON * size + R::MIN_POSITIVE)
    }

    fn with_rounding(self, weight: &Weight<R>) -> Self {
        Self { radius: each(|a| self.rounded(weight, a)), ..self }
    }

    /// S₁ + S₂: exact in all five quantities but for rounding (Iehl–Péroche A.1).
    #[inline]
    pub fn sum(&self, other: &Self, weight: &Weight<R>) -> Self {
        let up = outward::<R>();
        let total = Self {
            mean: self.mean + other.mean,
            error: each(|a| self.error[a] + other.error[a]),
            norm: each(|a| (self.norm[a] + other.norm[a]) * up),
            absolute: each(|a| (self.absolute[a] + other.absolute[a]) * up),
            low: self.low + other.low,
            high: self.high + other.high,
            radius: each(|a| self.radius[a] + other.radius[a]),
        };
        // Terms of opposite sign may cancel: the rounding is of the size of the terms, not of the total.
        let lost = |a: usize| {
            let i = weight.integral[a];
            (self.mean.abs() + other.mean.abs()) * i + self.error[a].abs() + other.error[a].abs()
        };
        let radius = each(|a| total.radius[a] * up + (R::TWO * R::EPSILON * lost(a) + R::MIN_POSITIVE));
        total.widened(self.magnitude() + other.magnitude()).with_radius(radius)
    }

    /// c S for any finite c: exact but for rounding (Iehl–Péroche A.1).
    #[inline]
    pub fn scale(&self, factor: R, weight: &Weight<R>) -> Self {
        let size = factor.abs();
        let up = outward::<R>();
        let (p, q) = (self.low * factor, self.high * factor);
        Self {
            mean: self.mean * factor,
            error: each(|a| self.error[a] * factor),
            norm: each(|a| self.norm[a] * size * up + R::MIN_POSITIVE),
            absolute: each(|a| self.absolute[a] * size * up + R::MIN_POSITIVE),
            low: p.min(q),
            high: p.max(q),
            radius: each(|a| self.radius[a] * size),
        }
        .widened(self.magnitude() * size)
        .with_rounding(weight)
    }

    /// Schlick's spectral term S + (1 − S) f, for a Fresnel factor f = (1 − u)⁵ in [0, 1] (Iehl–Péroche §3.1, A.1).
    #[inline]
    pub fn schlick(&self, fresnel: R, weight: &Weight<R>) -> Self {
        self.scale(R::ONE - fresnel, weight).shifted(fresnel, weight)
    }

    /// S + c, where ∫cā = c I_a is as exact as the weight is.
    fn shifted(&self, shift: R, weight: &Weight<R>) -> Self {
        let size = self.magnitude() + shift.abs();
        let doubt = R::from_f64(WEIGHT_ROUNDING) * R::EPSILON * shift.abs();
        Self {
            mean: self.mean + shift,
            low: self.low + shift,
            high: self.high + shift,
            radius: each(|a| self.radius[a] + doubt * weight.integral[a]),
            ..*self
        }
        .widened(size)
        .with_rounding(weight)
    }

    /// S₁ S₂ with the bounds of all that the first order leaves out: a radius that holds.
    ///
    /// `e_a` includes the known second-order term e₁e₂/I_a. The rest is the covariance ∫(S₁−μ₁)(S₂−μ₂) ā, at most the least of
    /// n₁n₂, h₁l₂ and h₂l₁ (h: half the range of values, l: absolute deviation).
    #[inline]
    pub fn product(&self, other: &Self, weight: &Weight<R>) -> Self {
        let (low, high) = range_product(self, other);
        let (sup1, sup2) = (self.magnitude(), other.magnitude());
        let (half1, half2) = (self.half_range(), other.half_range());
        let up = outward::<R>();
        let mut result = Self { mean: self.mean * other.mean, low, high, ..Self::zero() }.widened(sup1 * sup2);
        let half = result.half_range();
        for a in 0..3 {
            let (i, inverse, root) = (weight.integral[a], weight.inverse[a], weight.root[a]);
            let (e1, e2) = (self.error[a], other.error[a]);
            let (r1, r2) = (self.radius[a], other.radius[a]);
            // At least |μ|, also where m and e/I cancel.
            let lost = R::from_f64(4.0) * R::EPSILON;
            let mean1 = (self.mean + e1 * inverse).abs() + lost * self.mean.abs();
            let mean2 = (other.mean + e2 * inverse).abs() + lost * other.mean.abs();
            result.error[a] = self.mean * e2 + other.mean * e1 + e1 * e2 * inverse;

            let covariance =
                (self.norm[a] * other.norm[a]).min(half1 * other.absolute[a]).min(half2 * self.absolute[a]);
            let size = mean1 * mean2 * i;
            let rounding = R::from_f64(6.0 + WEIGHT_ROUNDING)
                * R::EPSILON
                * (size + (self.mean * e2).abs() + (other.mean * e1).abs() + (e1 * e2 * inverse).abs());
            let radius = (mean1 * r2 + mean2 * r1 + r1 * r2 * inverse + covariance) * up + (rounding + R::MIN_POSITIVE);

            // |μ| of the true spectra, for the spread of the product.
            let true1 = sup1.min(mean1 + r1 * inverse);
            let true2 = sup2.min(mean2 + r2 * inverse);
            let norm = (sup1 * other.norm[a] + true2 * self.norm[a])
                .min(sup2 * self.norm[a] + true1 * other.norm[a])
                .min(half * root);
            let absolute = ((sup1 * other.absolute[a] + true2 * self.absolute[a])
                .min(sup2 * self.absolute[a] + true1 * other.absolute[a])
                + covariance)
                .min(norm * root);
            result.norm[a] = norm * up + R::MIN_POSITIVE;
            result.absolute[a] = absolute * up + R::MIN_POSITIVE;
            result.radius[a] = radius;
        }
        result
    }

    /// S₁ S₂ to first order alone, as Iehl and Péroche have it (A.1): m = m₁m₂, `e_a` = m₁e₂ + m₂e₁; the other fields are not used.
    #[inline]
    pub fn product_first_order(&self, other: &Self) -> Self {
        Self {
            mean: self.mean * other.mean,
            error: zip(self.error, other.error, |first, second| self.mean * second + other.mean * first),
            ..Self::zero()
        }
    }

    /// c S to first order alone; the other fields are not used.
    #[inline]
    pub fn scale_first_order(&self, factor: R) -> Self {
        Self { mean: self.mean * factor, error: self.error.map(|e| e * factor), ..Self::zero() }
    }

    /// S₁ + S₂ to first order alone; the other fields are not used.
    #[inline]
    pub fn sum_first_order(&self, other: &Self) -> Self {
        let error = zip(self.error, other.error, |first, second| first + second);
        Self { mean: self.mean + other.mean, error, ..Self::zero() }
    }

    /// Schlick's spectral term to first order alone; the other fields are not used.
    #[inline]
    pub fn schlick_first_order(&self, fresnel: R) -> Self {
        let mut scaled = self.scale_first_order(R::ONE - fresnel);
        scaled.mean += fresnel;
        scaled
    }

    /// The range with what rounding of numbers of this size can have cost it.
    #[inline]
    fn widened(mut self, size: R) -> Self {
        let margin = R::TWO * R::EPSILON * size + R::MIN_POSITIVE;
        self.low -= margin;
        self.high += margin;
        self
    }

    #[inline]
    fn with_radius(self, radius: [R; 3]) -> Self {
        Self { radius, ..self }
    }
}

/// The range of a product of two ranges.
#[inline]
fn range_product<R: Real>(first: &Interval<R>, second: &Interval<R>) -> (R, R) {
    if first.low >= R::ZERO && second.low >= R::ZERO {
        return (first.low * second.low, first.high * second.high);
    }
    let (p, q) = (first.low * second.low, first.low * second.high);
    let (s, t) = (first.high * second.low, first.high * second.high);
    (p.min(q).min(s).min(t), p.max(q).max(s).max(t))
}
