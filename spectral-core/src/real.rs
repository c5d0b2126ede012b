//! The scalar trait behind every numeric type of this crate: [`Real`], sealed, for `f32` and `f64`.
//!
//! It is the only door to elementary functions, and behind it is `libm` in every build, so that the same input gives
//! the same bits on every target and no feature flag changes a number.

use core::fmt::{Debug, Display};
use core::ops::{Add, AddAssign, Div, DivAssign, Mul, MulAssign, Neg, Sub, SubAssign};

mod sealed {
    pub trait Sealed {}
    impl Sealed for f32 {}
    impl Sealed for f64 {}
}

/// A binary floating-point scalar, `f32` or `f64`.
///
/// Elementary functions are those of `libm`: `sqrt` and `cbrt` are correctly rounded, the others are within 1 ULP of the exact
/// value (`atan2`: 1.1) for arguments in their domain, and return NaN outside it, as IEEE 754 asks.
pub trait Real:
    sealed::Sealed
    + Copy
    + Default
    + Debug
    + Display
    + PartialEq
    + PartialOrd
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + AddAssign
    + SubAssign
    + MulAssign
    + DivAssign
    + Send
    + Sync
    + 'static
{
    /// Zero.
    const ZERO: Self;
    /// One.
    const ONE: Self;
    /// One half.
    const HALF: Self;
    /// Two.
    const TWO: Self;
    /// The circle constant π.
    const PI: Self;
    /// The distance from 1 to the next larger number (2⁻²³ or 2⁻⁵²).
    const EPSILON: Self;
    /// The smallest positive normal number.
    const MIN_POSITIVE: Self;
    /// The largest finite number.
    const MAX: Self;
    /// Positive infinity.
    const INFINITY: Self;

    /// The number nearest to `value`; ±∞ beyond the range.
    fn from_f64(value: f64) -> Self;
    /// The same number in `f64`, exactly.
    fn to_f64(self) -> f64;
    /// The number nearest to `value`.
    fn from_usize(value: usize) -> Self;
    /// The integer part of a number in `0 ..= usize::MAX`; 0 for NaN and negative numbers, saturating above.
    fn to_usize(self) -> usize;
    /// The samples of a built-in table in this precision.
    fn samples(table: &crate::tables::Samples) -> &'static [Self];

    /// Absolute value.
    fn abs(self) -> Self;
    /// The largest integer not above `self`.
    fn floor(self) -> Self;
    /// Square root.
    fn sqrt(self) -> Self;
    /// Cube root, of either sign.
    fn cbrt(self) -> Self;
    /// Natural exponential.
    fn exp(self) -> Self;
    /// `exp(self) − 1`, accurate near zero.
    fn exp_m1(self) -> Self;
    /// Natural logarithm.
    fn ln(self) -> Self;
    /// `self` raised to `power`.
    fn powf(self, power: Self) -> Self;
    /// Sine of an angle in radians.
    fn sin(self) -> Self;
    /// Cosine of an angle in radians.
    fn cos(self) -> Self;
    /// Tangent of an angle in radians.
    fn tan(self) -> Self;
    /// Arc sine in radians.
    fn asin(self) -> Self;
    /// Arc cosine in radians.
    fn acos(self) -> Self;
    /// Arc tangent in radians.
    fn atan(self) -> Self;
    /// The angle in radians of the point (`x`, `self`), in (−π, π].
    fn atan2(self, x: Self) -> Self;
    /// `√(self² + other²)` without undue overflow or underflow.
    fn hypot(self, other: Self) -> Self;

    /// The largest power of two not above a positive normal number; 0 for 0 and positive subnormal numbers.
    #[doc(hidden)]
    fn binade(self) -> Self;
    /// `self` to the power of −⅓ within 4 %, for a positive normal number: read off its bits. Some number otherwise.
    #[doc(hidden)]
    fn reciprocal_cbrt_estimate(self) -> Self;

    /// Whether the number is neither infinite nor NaN.
    fn is_finite(self) -> bool;
    /// Whether this is not a number.
    fn is_nan(self) -> bool;

    /// The smaller of two numbers; `other` when either is NaN.
    #[inline]
    fn min(self, other: Self) -> Self {
        if self < other { self } else { other }
    }
    /// The larger of two numbers; `other` when either is NaN.
    #[inline]
    fn max(self, other: Self) -> Self {
        if self > other { self } else { other }
    }
    /// `self` limited to `low ..= high`; `low` for NaN.
    #[inline]
    fn clamp(self, low: Self, high: Self) -> Self {
        self.max(low).min(high)
    }
}

macro_rules! implement {
    ($float:ty, $exponent:literal, $estimate:expr, $samples:ident, $floor:path, $sqrt:path, $cbrt:path, $exp:path, $expm1:path, $log:path, $pow:path,
     $sin:path, $cos:path, $tan:path, $asin:path, $acos:path, $atan:path, $atan2:path, $hypot:path) => {
        impl Real for $float {
            const ZERO: Self = 0.0;
            const ONE: Self = 1.0;
            const HALF: Self = 0.5;
            const TWO: Self = 2.0;
            #[allow(clippy::cast_possible_truncation, reason = "rounding π to the type is what is meant")]
            const PI: Self = core::f64::consts::PI as Self;
            const EPSILON: Self = <$float>::EPSILON;
            const MIN_POSITIVE: Self = <$float>::MIN_POSITIVE;
            const MAX: Self = <$float>::MAX;
            const INFINITY: Self = <$float>::INFINITY;

            #[inline]
            #[allow(clippy::cast_possible_truncation, reason = "documented as rounding to nearest")]
            fn from_f64(value: f64) -> Self {
                value as Self
            }
            #[inline]
            #[allow(clippy::cast_lossless, reason = "the same code serves both types")]
            fn to_f64(self) -> f64 {
                self as f64
            }
            #[inline]
            #[allow(clippy::cast_precision_loss, reason = "documented as rounding to nearest")]
            fn from_usize(value: usize) -> Self {
                value as Self
            }
            #[inline]
            #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "documented as saturating")]
            fn to_usize(self) -> usize {
                self as usize
            }
            #[inline]
            fn samples(table: &crate::tables::Samples) -> &'static [Self] {
                table.$samples
            }
            #[inline]
            fn abs(self) -> Self {
                <$float>::abs(self)
            }
            #[inline]
            fn floor(self) -> Self {
                $floor(self)
            }
            #[inline]
            fn sqrt(self) -> Self {
                $sqrt(self)
            }
            #[inline]
            fn cbrt(self) -> Self {
                $cbrt(self)
            }
            #[inline]
            fn exp(self) -> Self {
                $exp(self)
            }
            #[inline]
            fn exp_m1(self) -> Self {
                $expm1(self)
            }
            #[inline]
            fn ln(self) -> Self {
                $log(self)
            }
            #[inline]
            fn powf(self, power: Self) -> Self {
                $pow(self, power)
            }
            #[inline]
            fn sin(self) -> Self {
                $sin(self)
            }
            #[inline]
            fn cos(self) -> Self {
                $cos(self)
            }
            #[inline]
            fn tan(self) -> Self {
                $tan(self)
            }
            #[inline]
            fn asin(self) -> Self {
                $asin(self)
            }
            #[inline]
            fn acos(self) -> Self {
                $acos(self)
            }
            #[inline]
            fn atan(self) -> Self {
                $atan(self)
            }
            #[inline]
            fn atan2(self, x: Self) -> Self {
                $atan2(self, x)
            }
            #[inline]
            fn hypot(self, other: Self) -> Self {
                $hypot(self, other)
            }
            #[inline]
            fn binade(self) -> Self {
                Self::from_bits(self.to_bits() & $exponent)
            }
            #[inline]
            fn reciprocal_cbrt_estimate(self) -> Self {
                Self::from_bits($estimate(self.to_bits()))
            }
            #[inline]
            fn is_finite(self) -> bool {
                <$float>::is_finite(self)
            }
            #[inline]
            fn is_nan(self) -> bool {
                <$float>::is_nan(self)
            }
        }
    };
}

/// A number's exponent and the leading bits of its mantissa, read as one integer, are nearly a logarithm: a third of it is
/// the cube root's. The constant is that of the reciprocal, four thirds of the exponent of 1, less what makes the largest
/// errors to both sides equal.
fn single_estimate(bits: u32) -> u32 {
    0x54a1_f000_u32.wrapping_sub(bits / 3)
}

/// As [`single_estimate`], of the upper half of the bits; a product instead of the quotient suits vector instructions.
fn double_estimate(bits: u64) -> u64 {
    let third = ((bits >> 32) * 0x5555_5556) >> 32;
    0x553e_e800_u64.wrapping_sub(third) << 32
}

implement!(
    f32,
    0x7f80_0000,
    single_estimate,
    single,
    libm::floorf,
    libm::sqrtf,
    libm::cbrtf,
    libm::expf,
    libm::expm1f,
    libm::logf,
    libm::powf,
    libm::sinf,
    libm::cosf,
    libm::tanf,
    libm::asinf,
    libm::acosf,
    libm::atanf,
    libm::atan2f,
    libm::hypotf
);
implement!(
    f64,
    0x7ff0_0000_0000_0000,
    double_estimate,
    double,
    libm::floor,
    libm::sqrt,
    libm::cbrt,
    libm::exp,
    libm::expm1,
    libm::log,
    libm::pow,
    libm::sin,
    libm::cos,
    libm::tan,
    libm::asin,
    libm::acos,
    libm::atan,
    libm::atan2,
    libm::hypot
);
