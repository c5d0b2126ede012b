//! How spectra rise or fall along a part of the domain.

use spectral_core::interval::Node;

use super::cell::{LEAST_SHARE, Part, ROUNDING, VARIANCE_ROUNDING};
use super::moments::{LeafMoments, Moments};

/// The ramp φ of a part of the domain: linear in λ, from −1 to 1, less its mean in each channel.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Ramp {
    /// At least its norm √(∫φ² dν / ∫dν) in each channel, over the root of the channel's share.
    pub(super) norm: [f64; 3],
    /// The mean in all channels is the sum of theirs times these weights.
    pub(super) weights: [f64; 3],
    /// How far the mean in each channel, before it is taken off, is from that.
    pub(super) offset: [f64; 3],
}

impl Ramp {
    /// The greatest norm.
    pub(super) fn most(&self) -> f64 {
        self.norm.iter().fold(0.0, |m: f64, n| m.max(*n))
    }

    /// The greatest offset.
    pub(super) fn farthest(&self) -> f64 {
        self.offset.iter().fold(0.0, |m: f64, o| m.max(o.abs()))
    }
}

/// Moments of what is linear on a part.
pub(super) struct Line {
    mass: [f64; 3],
    /// The line's mean in each channel, as it is integrated: from −1 to 1 over all of the domain.
    means: [f64; 3],
    /// Half the part's width, where the whole domain has 1.
    half: f64,
    /// The mean of the part's own line, and at least its variance.
    centres: [f64; 3],
    variances: [f64; 3],
}

impl Line {
    pub(super) fn new(node: Node, moments: &Moments) -> Self {
        let ([first, last], [from, to]) = (Node::ROOT.limits::<f64>(), node.limits::<f64>());
        let half = (to - from) / (last - first);
        let middle = (to + from - last - first) / (last - first);
        let [firsts, seconds] = moments.lines;
        let mass = moments.mass.map(|m| m.max(0.0));
        let of = |a: usize| {
            if !(mass[a] > 0.0) {
                return [middle, 0.0, 0.0];
            }
            let (mean, square) = (firsts[a] / mass[a], seconds[a] / mass[a]);
            let centre = ((mean - middle) / half).clamp(-1.0, 1.0);
            let exact = (square - 2.0 * middle * mean + middle * middle) / (half * half) - centre * centre;
            // Nor can it be more than this where there is hardly any light.
            let variance = exact.min(1.0 - centre * centre).max(0.0) + VARIANCE_ROUNDING / (half * half);
            [mean, centre, variance]
        };
        let found: [[f64; 3]; 3] = core::array::from_fn(of);
        let [means, centres, variances] = core::array::from_fn(|i| core::array::from_fn(|a| found[a][i]));
        Self { mass, means, half, centres, variances }
    }

    /// The ramp, from the share of each channel.
    pub(super) fn ramp(&self, share: [f64; 3]) -> Ramp {
        // Squares of what is tiny would underflow.
        let most = self.mass.iter().fold(0.0, |most: f64, m| most.max(*m));
        let squares = self.mass.map(|m| (m / most).powi(2));
        let sum: f64 = squares.iter().sum();
        let weights = squares.map(|square| square / sum);
        let centre: f64 = self.centres.iter().zip(weights).map(|(c, w)| c * w).sum();
        // Nothing is seen of a spectrum in a channel without mass.
        let offset = core::array::from_fn(|a| if self.mass[a] > 0.0 { self.centres[a] - centre } else { 0.0 });
        let norm = core::array::from_fn(|a| (self.variances[a] / share[a]).sqrt() * (1.0 + ROUNDING));
        Ramp { norm, weights, offset }
    }

    /// Finds the slope of a part whose deviations are known, and what it leaves.
    ///
    /// With the variance V of ρ: ‖δ − cφ‖² = V − 2c cov + c² var, and ‖δφ − cov‖² = ‖δφ‖² − cov² ≤ sup φ² V − cov². The slope makes the former
    /// least in the sum of all channels.
    pub(super) fn incline(
        &self,
        part: &mut Part,
        moments: &LeafMoments,
        deviations: [f64; 3],
        (share, ramp): ([f64; 3], &Ramp),
    ) {
        let unsure = VARIANCE_ROUNDING * part.high / self.half;
        let covariance: [f64; 3] = core::array::from_fn(|a| {
            if !(self.mass[a] > 0.0) {
                return 0.0;
            }
            let most = deviations[a] * self.variances[a].sqrt();
            ((moments.sloped[a] / self.mass[a] - part.mean[a] * self.means[a]) / self.half).clamp(-most, most)
        });
        let total = |of: [f64; 3]| of.iter().zip(self.mass).map(|(v, m)| v * m).sum::<f64>();
        let slope = total(covariance) / total(self.variances);
        let slope = if slope.is_finite() { slope } else { 0.0 };
        let greatest = |of: &dyn Fn(usize) -> f64| (0..3).fold(0.0, |m: f64, a| m.max(of(a)));
        let up = 1.0 + ROUNDING;
        let rest = |a: usize| {
            let (square, cov) = (deviations[a] * deviations[a], covariance[a]);
            let left = square - 2.0 * slope * cov + slope * slope * self.variances[a] + 2.0 * slope.abs() * unsure;
            (left.max(0.0) / share[a]).sqrt() * up
        };
        let product = |a: usize| {
            let (greatest, cov) = ((1.0 + self.centres[a].abs()) * deviations[a], covariance[a].abs());
            ((greatest * greatest - cov * cov + 2.0 * cov * unsure).max(0.0).sqrt() + unsure) / share[a].sqrt() * up
        };
        part.rest = greatest(&rest);
        part.product = greatest(&product);
        part.skew = greatest(&|a| ramp.norm[a] * ((slope * ramp.offset[a]).abs() + (part.mean[a] - part.common).abs()));
        (part.slope, part.covariance, part.unsure) = (slope, covariance, unsure / LEAST_SHARE);
    }
}
