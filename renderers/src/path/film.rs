//! Sums over the samples of a pixel, and what they say of its noise.

use spectral_core::colour::rgb::xyz_to_linear_rgb;

/// Samples that share one scrambled point set: runs of so many are independent of each other.
pub(super) const RUN: u32 = 64;

/// How many numbers a pixel keeps.
pub(super) const NUMBERS: usize = 14;

/// A pixel's sums.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Pixel {
    /// XYZ of all samples.
    sum: [f64; 3],
    /// XYZ of those in a run that isn't complete.
    run: [f64; 3],
    /// Squares of the samples' linear R, G, B and Y.
    squares: [f64; 4],
    /// Squares of the complete runs' sums of the same.
    run_squares: [f64; 4],
}

fn channels(xyz: [f64; 3]) -> [f64; 4] {
    let [r, g, b] = xyz_to_linear_rgb(xyz);
    [r, g, b, xyz[1]]
}

impl Pixel {
    /// Adds sample number `index`; samples must come in order.
    pub(super) fn add(&mut self, index: u32, xyz: [f64; 3]) {
        for (channel, value) in xyz.iter().enumerate() {
            self.sum[channel] += value;
            self.run[channel] += value;
        }
        add_squares(&mut self.squares, xyz);
        if index % RUN == RUN - 1 {
            add_squares(&mut self.run_squares, self.run);
            self.run = [0.0; 3];
        }
    }

    /// The mean of all samples.
    pub(super) fn mean(&self, samples: u32) -> [f64; 3] {
        self.sum.map(|sum| sum / f64::from(samples))
    }

    /// The variance of the mean, for linear R, G, B and Y; `None` of a single sample.
    ///
    /// From two complete runs on, by the differences between runs: unbiased, since runs are independent. With less, by the differences
    /// between samples, which are more even than independent ones would be: then it is too large rather than too small.
    pub(super) fn variance(&self, samples: u32) -> Option<[f64; 4]> {
        let runs = samples / RUN;
        let (count, squares, sum) = if runs >= 2 {
            let complete = core::array::from_fn(|c| self.sum[c] - self.run[c]);
            (runs, self.run_squares, complete)
        } else {
            (samples, self.squares, self.sum)
        };
        if count < 2 {
            return None;
        }
        let (count, length) = (f64::from(count), if runs >= 2 { f64::from(RUN) } else { 1.0 });
        let sum = channels(sum);
        let of_part = |c: usize| ((squares[c] - sum[c] * sum[c] / count) / (count - 1.0)).max(0.0);
        // Each part has `length` samples: the mean of all samples has that many parts' weight.
        Some(core::array::from_fn(|c| of_part(c) / (length * f64::from(samples))))
    }

    /// All numbers, for the state file.
    pub(super) fn numbers(&self) -> [f64; NUMBERS] {
        let mut numbers = [0.0; NUMBERS];
        let all = self.sum.iter().chain(&self.run).chain(&self.squares).chain(&self.run_squares);
        numbers.iter_mut().zip(all).for_each(|(to, from)| *to = *from);
        numbers
    }

    /// The pixel with these numbers.
    pub(super) fn from_numbers(numbers: &[f64; NUMBERS]) -> Self {
        let mut pixel = Self::default();
        let Self { sum, run, squares, run_squares } = &mut pixel;
        let all = sum.iter_mut().chain(run).chain(squares).chain(run_squares);
        all.zip(numbers).for_each(|(to, from)| *to = *from);
        pixel
    }
}

fn add_squares(squares: &mut [f64; 4], xyz: [f64; 3]) {
    for (square, value) in squares.iter_mut().zip(channels(xyz)) {
        *square += value * value;
    }
}
