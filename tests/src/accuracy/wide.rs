//! Numbers of twice `f64`'s precision with elementary functions: what the accuracy table is measured against.
//!
//! Sums and products are those of T. J. Dekker, *A Floating-Point Technique for Extending the Available Precision* (1971), and D. E. Knuth; the
//! functions are Taylor series after halving, and Newton's steps on them. All are within about 10⁻³⁰ relative, which a test compares with values of
//! mpmath. Nothing of it is shared with the core.

use core::cmp::Ordering;
use core::ops::{Add, AddAssign, Div, Mul, Neg, Sub};

use spectral_core::Real;

/// A number as the unevaluated sum of two `f64`, the second at most half a unit in the last place of the first.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Wide {
    high: f64,
    low: f64,
}

fn two_sum(a: f64, b: f64) -> Wide {
    let high = a + b;
    let part = high - a;
    Wide { high, low: (a - (high - part)) + (b - part) }
}

fn quick_sum(a: f64, b: f64) -> Wide {
    let high = a + b;
    Wide { high, low: b - (high - a) }
}

fn two_product(a: f64, b: f64) -> Wide {
    let high = a * b;
    Wide { high, low: a.mul_add(b, -high) }
}

/// ln 2.
const LN_2: Wide = Wide { high: core::f64::consts::LN_2, low: 2.319_046_813_846_299_6e-17 };

impl Wide {
    /// Zero.
    pub const ZERO: Self = Self { high: 0.0, low: 0.0 };
    /// One.
    pub const ONE: Self = Self { high: 1.0, low: 0.0 };
    /// The circle constant π.
    pub const PI: Self = Self { high: core::f64::consts::PI, low: 1.224_646_799_147_353_2e-16 };

    /// The decimal number that a text stands for, such as `0.00287989916` or `-1.25e-3`; NaN for anything else.
    #[must_use]
    pub fn decimal(text: &str) -> Self {
        let (digits, power) = text.split_once('e').unwrap_or((text, "0"));
        let Ok(mut exponent) = power.parse::<i32>() else { return f64::NAN.into() };
        let (negative, digits) = digits.strip_prefix('-').map_or((false, digits), |rest| (true, rest));
        let mut value = Self::ZERO;
        let mut fraction = false;
        for byte in digits.bytes() {
            match byte {
                b'.' => fraction = true,
                b'0'..=b'9' => {
                    value = value * 10.0 + f64::from(byte - b'0');
                    exponent -= i32::from(fraction);
                }
                _ => return f64::NAN.into(),
            }
        }
        let power = Self::from(10.0).powi(exponent.unsigned_abs());
        let value = if exponent < 0 { value / power } else { value * power };
        if negative { -value } else { value }
    }

    /// The nearest `f64`.
    #[must_use]
    pub const fn to_f64(self) -> f64 {
        self.high
    }

    /// Whether the number is neither infinite nor NaN.
    #[must_use]
    pub const fn is_finite(self) -> bool {
        self.high.is_finite()
    }

    /// The number times a power of two.
    #[must_use]
    pub fn scaled(self, power_of_two: f64) -> Self {
        Self { high: self.high * power_of_two, low: self.low * power_of_two }
    }

    /// Absolute value.
    #[must_use]
    pub fn abs(self) -> Self {
        if self.high < 0.0 { -self } else { self }
    }

    /// The smaller one.
    #[must_use]
    pub fn min(self, other: Self) -> Self {
        if other < self { other } else { self }
    }

    /// The larger one.
    #[must_use]
    pub fn max(self, other: Self) -> Self {
        if other > self { other } else { self }
    }

    /// The square.
    #[must_use]
    pub fn squared(self) -> Self {
        self * self
    }

    /// A whole power.
    #[must_use]
    pub fn powi(self, power: u32) -> Self {
        let (mut result, mut square, mut left) = (Self::ONE, self, power);
        while left > 0 {
            if left % 2 == 1 {
                result = result * square;
            }
            square = square * square;
            left /= 2;
        }
        result
    }

    /// Square root.
    #[must_use]
    pub fn sqrt(self) -> Self {
        if !(self.high > 0.0 && self.high.is_finite()) {
            return self.high.sqrt().into();
        }
        let root = self.high.sqrt();
        let rest = self - two_product(root, root);
        quick_sum(root, rest.high / (2.0 * root))
    }

    /// Cube root, of either sign.
    #[must_use]
    pub fn cbrt(self) -> Self {
        let root = self.high.cbrt();
        if root == 0.0 || !root.is_finite() {
            return root.into();
        }
        let square = two_product(root, root);
        let rest = self - square * root;
        quick_sum(root, 0.0) + rest / (square * 3.0)
    }

    /// exp(self) − 1 for small numbers: a series for the number over 2⁸, and doubling.
    fn exp_m1_small(self) -> Self {
        const HALVINGS: u32 = 8;
        let x = self.scaled(0.5_f64.powi(8));
        let mut sum = Self::ONE;
        for n in (2..=12).rev() {
            sum = Self::ONE + x * sum / f64::from(n);
        }
        let mut value = x * sum;
        for _ in 0..HALVINGS {
            value = value.scaled(2.0) + value.squared();
        }
        value
    }

    /// Natural exponential.
    #[must_use]
    pub fn exp(self) -> Self {
        if !(self.high > -745.0) {
            return if self.high.is_nan() { self } else { Self::ZERO };
        }
        if self.high > 709.7 {
            return f64::INFINITY.into();
        }
        let twos = (self.high / LN_2.high).round();
        let rest = self - LN_2 * twos;
        // In two steps: a power of two may be subnormal where the result is.
        let half = (twos / 2.0).floor();
        (rest.exp_m1_small() + 1.0).scaled(half.exp2()).scaled((twos - half).exp2())
    }

    /// exp(self) − 1.
    #[must_use]
    pub fn exp_m1(self) -> Self {
        if self.high.abs() < 0.4 { self.exp_m1_small() } else { self.exp() - 1.0 }
    }

    /// Natural logarithm.
    #[must_use]
    pub fn ln(self) -> Self {
        if !(self.high > 0.0 && self.high.is_finite()) {
            return self.high.ln().into();
        }
        if (self.high - 1.0).abs() < 0.1 {
            // 2 artanh((x − 1)/(x + 1)).
            let s = (self - 1.0) / (self + 1.0);
            let square = s.squared();
            let mut sum = Self::ZERO;
            for n in (0..16).rev() {
                sum = sum * square + Self::ONE / f64::from(2 * n + 1);
            }
            return (s * sum).scaled(2.0);
        }
        let first = self.high.ln();
        let rest = self * Self::from(-first).exp() - 1.0;
        rest - rest.squared().scaled(0.5) + first
    }

    /// `self` raised to `power`, for positive numbers.
    #[must_use]
    pub fn powf(self, power: Self) -> Self {
        (self.ln() * power).exp()
    }

    /// Sine and cosine of an angle in radians, below about 10⁹.
    #[must_use]
    pub fn sin_cos(self) -> (Self, Self) {
        const HALVINGS: u32 = 5;
        if self.high.abs() < 1e-100 {
            return (self, Self::ONE); // squares would underflow
        }
        // π/2 in three parts.
        let parts = [1.570_796_326_794_896_6, 6.123_233_995_736_766e-17, -1.497_384_904_859_169_8e-33];
        let turns = (self.high / parts[0]).round();
        let rest = parts.iter().fold(self, |rest, part| rest - two_product(turns, *part));
        let x = rest.scaled(0.5_f64.powi(5));
        let square = x.squared();
        let (mut sin, mut versine) = (Self::ONE, Self::ONE);
        for n in (1..=9).rev() {
            let n = f64::from(2 * n);
            sin = Self::ONE - square * sin / (n * (n + 1.0));
            versine = Self::ONE - square * versine / ((n + 1.0) * (n + 2.0));
        }
        let (mut sin, mut versine) = (x * sin, square.scaled(0.5) * versine);
        for _ in 0..HALVINGS {
            (sin, versine) = ((sin * (Self::ONE - versine)).scaled(2.0), sin.squared().scaled(2.0));
        }
        let cos = Self::ONE - versine;
        match turns.rem_euclid(4.0) {
            t if t < 0.5 => (sin, cos),
            t if t < 1.5 => (cos, -sin),
            t if t < 2.5 => (-sin, -cos),
            _ => (-cos, sin),
        }
    }

    /// Sine.
    #[must_use]
    pub fn sin(self) -> Self {
        self.sin_cos().0
    }

    /// Cosine.
    #[must_use]
    pub fn cos(self) -> Self {
        self.sin_cos().1
    }

    /// Tangent.
    #[must_use]
    pub fn tan(self) -> Self {
        let (sin, cos) = self.sin_cos();
        sin / cos
    }

    /// The angle of the point (`x`, `self`), in (−π, π].
    #[must_use]
    pub fn atan2(self, x: Self) -> Self {
        let first = self.high.atan2(x.high);
        let size = self.high.abs().max(x.high.abs());
        if size == 0.0 || !size.is_finite() {
            return first.into();
        }
        let (sin, cos) = Self::from(first).sin_cos();
        let (across, along) = (self * cos - x * sin, x * cos + self * sin);
        across / along + first
    }

    /// Arc tangent.
    #[must_use]
    pub fn atan(self) -> Self {
        self.atan2(Self::ONE)
    }

    /// Arc sine.
    #[must_use]
    pub fn asin(self) -> Self {
        self.atan2(((Self::ONE - self) * (Self::ONE + self)).sqrt())
    }

    /// Arc cosine.
    #[must_use]
    pub fn acos(self) -> Self {
        ((Self::ONE - self) * (Self::ONE + self)).sqrt().atan2(self)
    }

    /// √(self² + other²).
    #[must_use]
    pub fn hypot(self, other: Self) -> Self {
        let size = self.high.abs().max(other.high.abs());
        if size == 0.0 || !size.is_finite() {
            return size.into();
        }
        // A power of two near the larger one keeps squares in range.
        let scale = f64::from_bits(size.to_bits() & 0x7ff0_0000_0000_0000);
        if scale == 0.0 {
            return size.into();
        }
        let (a, b) = (self / scale, other / scale);
        (a.squared() + b.squared()).sqrt().scaled(scale)
    }
}

impl From<f64> for Wide {
    fn from(high: f64) -> Self {
        Self { high, low: 0.0 }
    }
}

/// A number of the core, exactly.
#[must_use]
pub fn wide<R: Real>(value: R) -> Wide {
    value.to_f64().into()
}

/// A vector of the core, exactly.
#[must_use]
pub fn wides<R: Real, const N: usize>(values: [R; N]) -> [Wide; N] {
    values.map(wide)
}

/// The inner product.
#[must_use]
pub fn dot<const N: usize>(a: [Wide; N], b: [Wide; N]) -> Wide {
    a.into_iter().zip(b).fold(Wide::ZERO, |sum, (a, b)| sum + a * b)
}

/// The cross product.
#[must_use]
pub fn cross([a, b, c]: [Wide; 3], [x, y, z]: [Wide; 3]) -> [Wide; 3] {
    [b * z - c * y, c * x - a * z, a * y - b * x]
}

/// A matrix times a vector.
#[must_use]
pub fn apply(matrix: &[[Wide; 3]; 3], vector: [Wide; 3]) -> [Wide; 3] {
    matrix.map(|row| dot(row, vector))
}

/// The inverse of a matrix, by cofactors.
#[must_use]
pub fn inverse([a, b, c]: &[[Wide; 3]; 3]) -> [[Wide; 3]; 3] {
    let (x, y, z) = (cross(*b, *c), cross(*c, *a), cross(*a, *b));
    let determinant = dot(*a, x);
    core::array::from_fn(|i| [x[i] / determinant, y[i] / determinant, z[i] / determinant])
}

/// The product of two matrices.
#[must_use]
pub fn product(a: &[[Wide; 3]; 3], b: &[[Wide; 3]; 3]) -> [[Wide; 3]; 3] {
    a.map(|row| core::array::from_fn(|j| dot(row, [b[0][j], b[1][j], b[2][j]])))
}

impl Add for Wide {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        let (high, low) = (two_sum(self.high, other.high), two_sum(self.low, other.low));
        if !high.high.is_finite() {
            return high.high.into();
        }
        let sum = quick_sum(high.high, high.low + low.high);
        quick_sum(sum.high, sum.low + low.low)
    }
}

impl Neg for Wide {
    type Output = Self;
    fn neg(self) -> Self {
        Self { high: -self.high, low: -self.low }
    }
}

impl Sub for Wide {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Mul for Wide {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        let product = two_product(self.high, other.high);
        if !product.high.is_finite() {
            return product.high.into();
        }
        quick_sum(product.high, product.low + (self.high * other.low + self.low * other.high))
    }
}

impl Div for Wide {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        let first = self.high / other.high;
        if !first.is_finite() || first == 0.0 {
            return first.into();
        }
        let rest = self - other * first;
        let second = rest.high / other.high;
        let rest = rest - other * second;
        quick_sum(first, second) + rest.high / other.high
    }
}

macro_rules! with_f64 {
    ($($operator:ident $function:ident),*) => {$(
        impl $operator<f64> for Wide {
            type Output = Self;
            fn $function(self, other: f64) -> Self {
                self.$function(Self::from(other))
            }
        }
        impl $operator<Wide> for f64 {
            type Output = Wide;
            fn $function(self, other: Wide) -> Wide {
                Wide::from(self).$function(other)
            }
        }
    )*};
}
with_f64!(Add add, Sub sub, Mul mul, Div div);

impl AddAssign for Wide {
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl PartialOrd for Wide {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        match self.high.partial_cmp(&other.high) {
            Some(Ordering::Equal) => self.low.partial_cmp(&other.low),
            order => order,
        }
    }
}

impl PartialEq<f64> for Wide {
    fn eq(&self, other: &f64) -> bool {
        *self == Self::from(*other)
    }
}

impl PartialOrd<f64> for Wide {
    fn partial_cmp(&self, other: &f64) -> Option<Ordering> {
        self.partial_cmp(&Self::from(*other))
    }
}
