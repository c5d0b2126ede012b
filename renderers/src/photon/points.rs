//! The random numbers of photons: well-distributed points in four dimensions for where they start, and numbers for their decisions.

use crate::geometry::sampling::{SobolSequence, combine, scramble, sobol_second};

/// 2⁻³² and 2⁻²⁴.
const UNIT: f64 = 1.0 / 4_294_967_296.0;
const UNIT_24: f64 = 1.0 / 16_777_216.0;

/// The directions of the third and the fourth Sobol coordinate (S. Joe and F. Y. Kuo, "Constructing Sobol sequences with better
/// two-dimensional projections", 2008: degree 2, a = 1, m = 1, 3 and degree 3, a = 1, m = 1, 3, 1).
const THIRD: [u32; 32] = directions([1, 3, 0], 2, 1);
const FOURTH: [u32; 32] = directions([1, 3, 1], 3, 1);

/// The direction numbers of a primitive polynomial of a degree, by Sobol's recurrence.
const fn directions(first: [u32; 3], degree: usize, a: u32) -> [u32; 32] {
    let mut v = [0; 32];
    let mut i = 0;
    while i < 32 {
        if i < degree {
            v[i] = first[i] << (31 - i);
        } else {
            v[i] = v[i - degree] ^ (v[i - degree] >> degree);
            let mut k = 1;
            while k < degree {
                if (a >> (degree - 1 - k)) & 1 == 1 {
                    v[i] ^= v[i - k];
                }
                k += 1;
            }
        }
        i += 1;
    }
    v
}

/// The random numbers of one beam in one pass: a pure function of seed, pass, beam and the number of the emission.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Points {
    seed: u32,
    decisions: SobolSequence,
}

impl Points {
    pub(super) const fn new(seed: u32, pass: u32, beam: u32) -> Self {
        let seed = combine(combine(combine(0x70_686f, seed), pass), beam);
        Self { seed, decisions: SobolSequence::new(combine(seed, 4)) }
    }

    /// A point of an Owen-scrambled Sobol sequence in four dimensions, each coordinate in [0, 1).
    pub(super) fn place(&self, index: u32) -> [f64; 4] {
        let shuffled = scramble(index, self.seed);
        let sobol = [shuffled.reverse_bits(), sobol_second(shuffled), sum(&THIRD, shuffled), sum(&FOURTH, shuffled)];
        let mut dimension = 0;
        sobol.map(|x| {
            dimension += 1;
            f64::from(scramble(x, combine(self.seed, dimension))) * UNIT
        })
    }

    /// A number of an emission's branch: of the same branch of emissions that follow each other, they do, too.
    pub(super) const fn number(&self, index: u32, branch: u32) -> u32 {
        index.wrapping_add(combine(self.seed, branch))
    }

    /// A number in [0, 1) for a decision of an emission's branch; well distributed over the emissions.
    pub(super) fn decision(&self, index: u32, branch: u32, purpose: Purpose) -> f64 {
        let [high, low] = self.decisions.point(index, combine(branch, purpose as u32)).map(f64::from);
        high + low * UNIT_24
    }
}

/// What a number is for.
#[derive(Clone, Copy, Debug)]
pub(super) enum Purpose {
    /// Whether an emission counts, or has its flux given to others.
    Start,
    /// Which of the ways on are followed.
    Survival,
    /// Which factor of a mirror counts.
    Factor,
}

/// One coordinate of a Sobol point.
fn sum(directions: &[u32; 32], mut index: u32) -> u32 {
    let mut x = 0;
    while index != 0 {
        x ^= directions[(index.trailing_zeros() & 31) as usize];
        index &= index - 1;
    }
    x
}

#[cfg(test)]
mod tests {
    use super::Points;

    /// Of 2¹² points of a (t, 4)-sequence in base 2 with t ≤ 3 (the sum of the polynomials' degrees less one), each box of volume
    /// 2⁻⁹ has exactly 8, whatever the scrambling.
    #[test]
    fn points_fill_four_dimensions_evenly() {
        for (seed, shape) in
            [[3, 2, 2, 2], [0, 0, 5, 4], [9, 0, 0, 0], [0, 3, 0, 6], [2, 2, 2, 3]].into_iter().enumerate()
        {
            let points = Points::new(u32::try_from(seed).unwrap(), 3, 1);
            let mut counts = vec![0; 512];
            for index in 0..4096 {
                let cell = points.place(index).iter().zip(shape).fold(0, |cell, (u, bits)| {
                    assert!((0.0..1.0).contains(u));
                    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "the cell's number")]
                    let digit = (u * f64::from(1 << bits)) as usize;
                    (cell << bits) | digit
                });
                counts[cell] += 1;
            }
            assert!(counts.iter().all(|count| *count == 8), "{shape:?}: {counts:?}");
        }
    }

    #[test]
    fn passes_and_beams_have_points_of_their_own() {
        let first = Points::new(1, 0, 0);
        for other in [Points::new(1, 1, 0), Points::new(1, 0, 1), Points::new(2, 0, 0)] {
            assert!((0..64).all(|i| first.place(i) != other.place(i)));
        }
    }
}
