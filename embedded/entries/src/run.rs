//! Arguments, digest and clock of one entry point.

use spectral_core::Real;

/// What an entry point is run with: a source of arguments, a digest of results, and a clock around the calls.
#[derive(Debug)]
pub struct Run {
    state: u32,
    digest: u64,
    results: u32,
    clock: fn() -> u32,
    ticks: u64,
    calls: u32,
}

/// Offset basis and prime of FNV-1a, 64 bits.
const BASIS: u64 = 0xcbf2_9ce4_8422_2325;
const PRIME: u64 = 0x0000_0100_0000_01b3;

impl Run {
    /// A run whose calls are timed by a clock that counts upwards and wraps at 32 bits.
    #[must_use]
    pub const fn new(clock: fn() -> u32) -> Self {
        Self { state: 0x9e37_79b9, digest: BASIS, results: 0, clock, ticks: 0, calls: 0 }
    }

    /// FNV-1a over the bits of all results so far, as `f64` (which holds every `f32`), with one NaN for all.
    #[must_use]
    pub const fn digest(&self) -> u64 {
        self.digest
    }

    /// The number of results so far.
    #[must_use]
    pub const fn results(&self) -> u32 {
        self.results
    }

    /// Ticks of the clock within calls, and the number of calls.
    #[must_use]
    pub const fn time(&self) -> (u64, u32) {
        (self.ticks, self.calls)
    }

    /// Runs `function` between two readings of the clock.
    #[inline]
    pub fn time_call<T>(&mut self, function: impl FnOnce() -> T) -> T {
        let start = (self.clock)();
        // What it works on is unknown before this point: nothing is computed ahead of the clock.
        let function = core::hint::black_box(function);
        let result = core::hint::black_box(function());
        let end = (self.clock)();
        self.ticks += u64::from(end.wrapping_sub(start));
        self.calls += 1;
        result
    }

    /// A whole number, any of 32 bits (xorshift).
    #[inline(never)]
    pub fn bits(&mut self) -> u32 {
        self.state ^= self.state << 13;
        self.state ^= self.state >> 17;
        self.state ^= self.state << 5;
        self.state
    }

    /// A whole number below `end`, which is above 0.
    ///
    /// The optimiser learns nothing of it: what it is used for must hold for every number.
    #[inline(never)]
    pub fn below(&mut self, end: u32) -> u32 {
        let [.., a, b, c, d] = (u64::from(self.bits()) * u64::from(end)).to_le_bytes();
        core::hint::black_box(u32::from_le_bytes([a, b, c, d]))
    }

    /// Any number of 8 bits.
    pub fn byte(&mut self) -> u8 {
        let [byte, ..] = core::hint::black_box(self.bits()).to_le_bytes();
        byte
    }

    /// Any number of 16 bits, small ones as often as large ones.
    pub fn short(&mut self) -> u16 {
        let [low, high, shift, _] = core::hint::black_box(self.bits()).to_le_bytes();
        u16::from_le_bytes([low, high]) >> (shift & 15)
    }

    /// As [`below`](Self::below), as a length or an index.
    pub fn index(&mut self, end: u32) -> usize {
        core::hint::black_box(self.below(end) as usize)
    }

    /// A number in [0, 1), one of 2²⁴, so that both precisions get the same.
    pub fn unit<R: Real>(&mut self) -> R {
        R::from_f64(f64::from(self.bits() >> 8) / 16_777_216.0)
    }

    /// A number in [`low`, `high`).
    pub fn within<R: Real>(&mut self, low: f64, high: f64) -> R {
        let unit = f64::from(self.bits() >> 8) / 16_777_216.0;
        R::from_f64(low + (high - low) * unit)
    }

    /// As many numbers in [`low`, `high`).
    pub fn array<R: Real, const N: usize>(&mut self, low: f64, high: f64) -> [R; N] {
        let mut values = [R::ZERO; N];
        for value in &mut values {
            *value = self.within(low, high);
        }
        values
    }

    /// A direction of length 1 above the plane z = 0, or on both sides of it.
    pub fn direction<R: Real>(&mut self, is_above: bool) -> [R; 3] {
        let z: R = if is_above { self.within(0.02, 1.0) } else { self.within(-1.0, 1.0) };
        let angle: R = self.within(-3.0, 3.0);
        let radius = (R::ONE - z * z).max(R::ZERO).sqrt();
        [radius * angle.cos(), radius * angle.sin(), z]
    }

    /// Takes a result into the digest.
    #[inline(never)]
    pub fn put<R: Real>(&mut self, value: R) {
        let value = value.to_f64();
        self.put_bits(if value.is_nan() { 0x7ff8_0000_0000_0000 } else { value.to_bits() });
    }

    /// Takes results into the digest.
    pub fn put_all<R: Real>(&mut self, values: &[R]) {
        for &value in values {
            self.put(value);
        }
    }

    /// Takes a whole number into the digest, such as a count or the number of a variant.
    #[inline(never)]
    pub fn put_bits(&mut self, bits: u64) {
        for byte in bits.to_le_bytes() {
            self.digest = (self.digest ^ u64::from(byte)).wrapping_mul(PRIME);
        }
        self.results += 1;
    }

    /// Takes text into the digest, as one result.
    pub fn put_text(&mut self, text: &str) {
        for byte in text.bytes() {
            self.digest = (self.digest ^ u64::from(byte)).wrapping_mul(PRIME);
        }
        self.results += 1;
    }

    /// Takes a result that may be absent, or refused, into the digest.
    pub fn put_option<T>(&mut self, value: Option<T>, put: impl FnOnce(&mut Self, T)) {
        match value {
            Some(value) => put(self, value),
            None => self.put_bits(0),
        }
    }
}
