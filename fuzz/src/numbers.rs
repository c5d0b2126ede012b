//! Numbers from bytes: ordinary ones, and those that arithmetic trips over.

use spectral_core::Real;

/// Numbers that are special in either precision; those beyond a precision's range become its 0 or ∞.
const SPECIAL: [f64; 24] = [
    0.0,
    -0.0,
    1.0,
    -1.0,
    0.5,
    2.0,
    f64::EPSILON,
    f32::EPSILON as f64,
    f64::MIN_POSITIVE,
    f32::MIN_POSITIVE as f64,
    5e-324,
    1e-45,
    f64::MAX,
    f32::MAX as f64,
    -f64::MAX,
    f64::INFINITY,
    f64::NEG_INFINITY,
    f64::NAN,
    1e-8,
    1e8,
    core::f64::consts::PI,
    380.0,
    560.0,
    780.0,
];

/// A reader of bytes that never ends: zeros follow the last one.
pub(crate) struct Numbers<'a> {
    bytes: &'a [u8],
}

impl<'a> Numbers<'a> {
    pub(crate) fn new(bytes: &'a [u8]) -> Self {
        Self { bytes }
    }

    /// Whether all bytes are used up.
    pub(crate) fn is_empty(&self) -> bool {
        self.bytes.is_empty()
    }

    pub(crate) fn byte(&mut self) -> u8 {
        self.array::<1>()[0]
    }

    pub(crate) fn below(&mut self, limit: usize) -> usize {
        usize::from(self.byte()) % limit
    }

    fn array<const N: usize>(&mut self) -> [u8; N] {
        let mut array = [0; N];
        let (taken, rest) = self.bytes.split_at(N.min(self.bytes.len()));
        array[..taken.len()].copy_from_slice(taken);
        self.bytes = rest;
        array
    }

    /// Any number, NaN and the infinities among them.
    pub(crate) fn any<R: Real>(&mut self) -> R {
        match self.byte() % 8 {
            0 => R::from_f64(SPECIAL[self.below(SPECIAL.len())]),
            1 => R::from_f64(f64::from_le_bytes(self.array())),
            2 => R::from_f64(f64::from(f32::from_le_bytes(self.array()))),
            3 => R::from_f64(f64::from(i16::from_le_bytes(self.array())) / 256.0),
            4 => R::from_f64(f64::from(u16::from_le_bytes(self.array())) / 65535.0),
            // 1 and its neighbours, and likewise other small whole numbers.
            5 => {
                let whole = R::from_f64(f64::from(self.byte() % 8));
                whole * (R::ONE + R::EPSILON * R::from_f64(f64::from(i32::from(self.byte() % 9) - 4)))
            }
            _ => self.scaled(60),
        }
    }

    /// ±m · 10^e with |e| up to `decades`.
    fn scaled<R: Real>(&mut self, decades: i32) -> R {
        let decade = i32::from(self.byte()) * (2 * decades + 1) / 256 - decades;
        let [mantissa, sign] = self.array();
        let magnitude = (1.0 + f64::from(mantissa) / 256.0) * 10.0_f64.powi(decade);
        R::from_f64(if sign & 1 == 0 { magnitude } else { -magnitude })
    }

    /// A finite number of magnitude at most `limit`, 0 instead of others.
    pub(crate) fn within<R: Real>(&mut self, limit: f64) -> R {
        let number: R = self.any();
        if number.abs().to_f64() <= limit { number } else { R::ZERO }
    }

    pub(crate) fn vector_within<R: Real, const N: usize>(&mut self, limit: f64) -> [R; N] {
        core::array::from_fn(|_| self.within(limit))
    }

    pub(crate) fn any_vector<R: Real, const N: usize>(&mut self) -> [R; N] {
        core::array::from_fn(|_| self.any())
    }

    /// A number in [0, 1], often near its ends.
    pub(crate) fn unit<R: Real>(&mut self) -> R {
        let number = match self.byte() % 4 {
            0 => self.within::<R>(1.0).abs(),
            1 => R::ONE - self.within::<R>(1.0).abs(),
            _ => R::from_f64(f64::from(u16::from_le_bytes(self.array())) / 65536.0),
        };
        number.max(R::ZERO).min(R::ONE)
    }

    pub(crate) fn units<R: Real, const N: usize>(&mut self) -> [R; N] {
        core::array::from_fn(|_| self.unit())
    }

    /// A positive number with |log₁₀| up to `decades`.
    pub(crate) fn positive<R: Real>(&mut self, decades: i32) -> R {
        self.scaled::<R>(decades).abs()
    }
}

/// Asserts that a number is finite and in a range, saying which one isn't.
#[track_caller]
pub(crate) fn assert_in<R: Real>(number: R, low: f64, high: f64, what: &str) {
    let value = number.to_f64();
    assert!(value >= low && value <= high, "{what}: {value} is not in {low} … {high}");
}

/// Asserts that all numbers are finite.
#[track_caller]
pub(crate) fn assert_finite<R: Real>(numbers: &[R], what: &str) {
    assert!(numbers.iter().all(|number| number.is_finite()), "{what}: {numbers:?}");
}
