//! Arithmetic on `W` numbers at once: written once, used for one value and for several in lockstep.
//!
//! Every operation is a loop of fixed length without branches, which compilers turn into vector instructions; no lane
//! depends on another, so that results are the same bits for every `W` and every target.

use core::ops::{Add, Div, Mul, Neg, Sub};

use crate::Real;

/// `W` numbers.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Lanes<R, const W: usize>(pub(crate) [R; W]);

impl<R: Real, const W: usize> Lanes<R, W> {
    pub(crate) const ZERO: Self = Self([R::ZERO; W]);

    /// The same constant in all lanes.
    #[inline(always)]
    pub(crate) fn constant(value: f64) -> Self {
        Self([R::from_f64(value); W])
    }

    /// The same number in all lanes.
    #[inline(always)]
    pub(crate) fn all(value: R) -> Self {
        Self([value; W])
    }

    #[inline(always)]
    pub(crate) fn map(mut self, f: impl Fn(R) -> R) -> Self {
        for lane in &mut self.0 {
            *lane = f(*lane);
        }
        self
    }

    #[inline(always)]
    fn zip(mut self, other: Self, f: impl Fn(R, R) -> R) -> Self {
        for (lane, other) in self.0.iter_mut().zip(other.0) {
            *lane = f(*lane, other);
        }
        self
    }

    #[inline(always)]
    pub(crate) fn sqrt(self) -> Self {
        self.map(R::sqrt)
    }

    #[inline(always)]
    pub(crate) fn abs(self) -> Self {
        self.map(R::abs)
    }

    /// The smaller one in each lane; that of `other` when one is NaN.
    #[inline(always)]
    pub(crate) fn lesser(self, other: Self) -> Self {
        self.zip(other, R::min)
    }

    /// `yes` where a lane is above `limit`, else `no`.
    #[inline(always)]
    pub(crate) fn if_above(self, limit: R, yes: Self, no: Self) -> Self {
        let mut chosen = no;
        for ((chosen, yes), lane) in chosen.0.iter_mut().zip(yes.0).zip(self.0) {
            *chosen = if lane > limit { yes } else { *chosen };
        }
        chosen
    }

    /// Σ cₖ xᵏ from pairs of coefficients of even and odd powers, which are summed apart: that halves the chain of dependent
    /// operations.
    #[inline(always)]
    pub(crate) fn polynomial(self, pairs: &[[f64; 2]]) -> Self {
        let square = self * self;
        let (mut even, mut odd) = (Self::ZERO, Self::ZERO);
        for &[first, second] in pairs.iter().rev() {
            even = even * square + Self::constant(first);
            odd = odd * square + Self::constant(second);
        }
        even + self * odd
    }

    /// Cube roots of positive normal numbers, within 1 ε; 0 for 0, NaN for NaN, anything for negative numbers, subnormal
    /// ones and infinities.
    ///
    /// Not correctly rounded and not monotone, other than [`Real::cbrt`], but without branches or tables. An estimate r of
    /// t^(−⅓) from the exponent is improved by two steps of the binomial series of (1 − e)^(−⅓) with e = 1 − t r³, and
    /// t r² by one of Newton's.
    #[inline(always)]
    pub(crate) fn cbrt(self) -> Self {
        let [one, third] = [1.0, 1.0 / 3.0].map(Self::constant);
        let rest = |r: Self| one - self * r * (r * r);
        let r = self.map(R::reciprocal_cbrt_estimate);
        let e = rest(r);
        let r = r + r * e * (third + e * (Self::constant(2.0 / 9.0) + e * Self::constant(14.0 / 81.0)));
        let e = rest(r);
        let r = r + r * e * (third + e * Self::constant(2.0 / 9.0));
        let square = r * r;
        let root = self * square;
        root - (root * root * root - self) * (square * third)
    }
}

macro_rules! elementwise {
    ($($trait:ident $method:ident),*) => {$(
        impl<R: Real, const W: usize> $trait for Lanes<R, W> {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                self.zip(other, R::$method)
            }
        }
    )*};
}

elementwise!(Add add, Sub sub, Mul mul, Div div);

impl<R: Real, const W: usize> Neg for Lanes<R, W> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        self.map(R::neg)
    }
}

#[cfg(test)]
#[allow(clippy::float_cmp, reason = "exact values are what is stated")]
mod tests {
    use super::*;

    /// `independent`: the correctly rounded roots of `libm`.
    fn worst_cube_root<R: Real>() -> f64 {
        let mut worst: f64 = 0.0;
        // Mantissas all over two octaves of three, at several scales.
        for scale in [1e-30, 1e-3, 1.0, 1e4, 1e30] {
            for step in 0..300_000 {
                let t = R::from_f64(scale * (1.0 + 7.0 * f64::from(step) / 300_000.0));
                let exact = t.cbrt().to_f64();
                let [root] = Lanes([t]).cbrt().0;
                worst = worst.max((root.to_f64() - exact).abs() / (exact * R::EPSILON.to_f64()));
            }
        }
        worst
    }

    #[test]
    fn cube_roots_are_as_accurate_as_stated() {
        // Half a unit for the rounding of `libm`'s comes on top.
        assert!(worst_cube_root::<f64>() <= 1.5, "{}", worst_cube_root::<f64>());
        assert!(worst_cube_root::<f32>() <= 1.5, "{}", worst_cube_root::<f32>());
    }

    #[test]
    fn zero_and_nan_stay() {
        assert_eq!(Lanes([0.0, 0.0_f64]).cbrt().0, [0.0; 2]);
        assert_eq!(Lanes([0.0_f32]).cbrt().0, [0.0]);
        assert!(Lanes([f64::NAN]).cbrt().0[0].is_nan() && Lanes([f32::NAN]).cbrt().0[0].is_nan());
    }

    #[test]
    fn a_lane_does_not_depend_on_the_others() {
        let values: [f64; 8] = core::array::from_fn(|lane| 0.01 + 0.3 * f64::from(u8::try_from(lane).unwrap()));
        let polynomial = [[1.0, 0.5], [-0.25, 3.0]];
        for (lane, value) in values.into_iter().enumerate() {
            assert_eq!(Lanes(values).cbrt().0[lane], Lanes([value]).cbrt().0[0]);
            assert_eq!(Lanes(values).polynomial(&polynomial).0[lane], Lanes([value]).polynomial(&polynomial).0[0]);
        }
        assert_eq!(Lanes([2.0]).polynomial(&polynomial).0, [1.0 + 0.5 * 2.0 - 0.25 * 4.0 + 3.0 * 8.0]);
    }
}
