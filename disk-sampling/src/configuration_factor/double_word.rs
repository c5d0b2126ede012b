//! Unevaluated sums of two numbers: twice the precision, for differences that would lose all their digits.
//!
//! Dekker, "A floating-point technique for extending the available precision", Numer. Math. 18 (1971); the sums and products
//! are those of Joldes, Muller and Popescu, "Tight and rigorous error bounds for basic building blocks of double-word arithmetic",
//! ACM Trans. Math. Softw. 44(2) (2017), relative error a few ε².

use core::ops::{Add, Mul, Neg, Sub};

use spectral_core::Real;

use crate::vector::Vector;

/// `high` + `low`, where `high` is the nearest number to the sum.
#[derive(Clone, Copy, Debug)]
pub(super) struct DoubleWord<R> {
    high: R,
    low: R,
}

impl<R: Real> DoubleWord<R> {
    /// `a` + `b` exactly.
    pub(super) fn sum(a: R, b: R) -> Self {
        let high = a + b;
        let b_part = high - a;
        Self { high, low: (a - (high - b_part)) + (b - b_part) }
    }

    /// `a` · `b` exactly, while neither it nor its last bit leaves the range.
    pub(super) fn product(a: R, b: R) -> Self {
        let high = a * b;
        let ((a1, a2), (b1, b2)) = (split(a), split(b));
        Self { high, low: ((a1 * b1 - high) + a1 * b2 + a2 * b1) + a2 * b2 }
    }

    /// Times a power of two, exactly.
    pub(super) fn scaled(self, power: R) -> Self {
        Self { high: self.high * power, low: self.low * power }
    }

    /// The nearest number.
    pub(super) fn value(self) -> R {
        self.high
    }

    /// `a` + `b` where |a| is not below |b|.
    fn ordered_sum(a: R, b: R) -> Self {
        let high = a + b;
        Self { high, low: b - (high - a) }
    }
}

impl<R: Real> From<R> for DoubleWord<R> {
    fn from(high: R) -> Self {
        Self { high, low: R::ZERO }
    }
}

impl<R: Real> Neg for DoubleWord<R> {
    type Output = Self;
    fn neg(self) -> Self {
        Self { high: -self.high, low: -self.low }
    }
}

impl<R: Real> Add for DoubleWord<R> {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        let (s, t) = (Self::sum(self.high, other.high), Self::sum(self.low, other.low));
        let v = Self::ordered_sum(s.high, s.low + t.high);
        Self::ordered_sum(v.high, t.low + v.low)
    }
}

impl<R: Real> Sub for DoubleWord<R> {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl<R: Real> Mul for DoubleWord<R> {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        let p = Self::product(self.high, other.high);
        Self::ordered_sum(p.high, p.low + (self.high * other.low + self.low * other.high))
    }
}

impl<R: Real> Mul<R> for DoubleWord<R> {
    type Output = Self;
    fn mul(self, other: R) -> Self {
        let p = Self::product(self.high, other);
        Self::ordered_sum(p.high, p.low + self.low * other)
    }
}

/// Two halves of half the digits each, with sum `a` (Veltkamp).
fn split<R: Real>(a: R) -> (R, R) {
    // 2²⁷ + 1 for 53 digits, 2¹² + 1 for 24.
    let factor = R::from_f64(if R::EPSILON.to_f64() < 1e-10 { 134_217_729.0 } else { 4097.0 });
    let c = factor * a;
    let high = c - (c - a);
    (high, a - high)
}

pub(super) type WideVector<R> = [DoubleWord<R>; 3];

/// a − b exactly.
pub(super) fn wide_difference<R: Real>(a: Vector<R>, b: Vector<R>) -> WideVector<R> {
    core::array::from_fn(|i| DoubleWord::sum(a[i], -b[i]))
}

pub(super) fn widened<R: Real>(a: Vector<R>) -> WideVector<R> {
    a.map(DoubleWord::from)
}

pub(super) fn wide_dot<R: Real>(a: WideVector<R>, b: WideVector<R>) -> DoubleWord<R> {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub(super) fn wide_cross<R: Real>(a: WideVector<R>, b: WideVector<R>) -> WideVector<R> {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}
