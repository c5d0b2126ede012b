//! Random numbers for tests.

/// `SplitMix64` (Steele, Lea and Flood 2014).
pub(super) struct Random(u64);

impl Random {
    pub(super) const fn new(seed: u64) -> Self {
        Self(seed)
    }

    /// A number in [0, 1), a multiple of 2⁻²⁴.
    #[allow(clippy::cast_precision_loss, reason = "24 bits")]
    pub(super) const fn next(&mut self) -> f32 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 40) as f32 / 16_777_216.0
    }

    /// Three numbers in [−1, 1).
    pub(super) fn vector(&mut self) -> [f32; 3] {
        core::array::from_fn(|_| 2.0 * self.next() - 1.0)
    }
}
