//! What a path carries from the eye: how much of the light at its end counts for the picture, in every component.

use crate::spectral::{Factor, Functional, UniformBins, normalised};

/// A factor, `None` for 1, and its share.
pub(super) type Term = (Option<Factor>, f64);

/// The throughput of a path and the light that it has gathered.
pub(super) trait Carrier {
    /// A new path: all light counts for 1, and none has been gathered. `wavelength` is where it goes when it must choose: in
    /// [0, 1)², the second number for the bits after those of the first.
    fn start(&mut self, wavelength: [f32; 2]);

    /// Multiplies what light counts for by Σ share · factor.
    fn multiply(&mut self, terms: &[Term]);

    /// Multiplies what light counts for by a function of the wavelength in nm.
    fn multiply_by(&mut self, function: &dyn Fn(f64) -> f64);

    /// Multiplies what light counts for by a number.
    fn scale(&mut self, share: f64);

    /// The wavelength in nm of which alone the path still counts, if that is so.
    fn wavelength(&self) -> Option<f64>;

    /// Goes on with one wavelength alone, and returns it.
    fn choose_wavelength(&mut self) -> f64;

    /// Gathers light, times Σ share · factor and a weight.
    fn gather(&mut self, terms: &[Term], light: Factor, weight: f64);

    /// What light of 1 counts for, one number for all components.
    fn strength(&self, function: Functional) -> f64;

    /// Tristimulus values of what has been gathered, Y = 1 for a flat radiance of 1.
    fn xyz(&self) -> [f64; 3];
}

/// Spectra as means over bins.
///
/// A path that must choose takes one wavelength, in each bin as often as the bin matters to the observer and evenly within it, so that a
/// spectrum drawn by dispersion shows no bins.
#[derive(Clone, Debug)]
pub(super) struct Rows<'a> {
    bins: &'a UniformBins,
    /// For each bin, the share of paths whose wavelength is in it, added up to the bin's end.
    choice: Vec<f64>,
    /// What light counts for is `scale` times `row`.
    scale: f64,
    row: Vec<f64>,
    light: Vec<f64>,
    /// Where the path goes when it must choose.
    position: f64,
    /// The bin and wavelength chosen, and how often that bin is.
    chosen: Option<(usize, f64, f64)>,
}

impl<'a> Rows<'a> {
    pub(super) fn new(bins: &'a UniformBins) -> Self {
        let [x, y, z] = bins.weights();
        let weights: Vec<f64> = x.iter().zip(y).zip(z).map(|((x, y), z)| x + y + z).collect();
        let total: f64 = weights.iter().sum();
        let mut sum = 0.0;
        let choice = weights.iter().map(|w| {
            sum += w / total;
            sum
        });
        let choice = choice.collect();
        let (row, light) = (vec![1.0; bins.len()], vec![0.0; bins.len()]);
        Self { bins, choice, scale: 1.0, row, light, position: 0.0, chosen: None }
    }

    /// The bin that the path would choose, how often that is chosen, and where in each bin its wavelength is.
    fn choose(&self) -> (usize, f64, f64) {
        let bin = self.choice.partition_point(|end| *end <= self.position).min(self.choice.len() - 1);
        let start = bin.checked_sub(1).map_or(0.0, |before| self.choice[before]);
        let share = self.choice[bin] - start;
        let within = if share > 0.0 { ((self.position - start) / share).clamp(0.0, 1.0) } else { 0.5 };
        (bin, share, within)
    }

    /// The mean of a sum of factors over a bin.
    fn sum(&self, terms: &[Term], bin: usize) -> f64 {
        terms.iter().map(|(factor, share)| share * factor.map_or(1.0, |f| self.mean(f, bin))).sum()
    }

    /// The mean of a factor over a bin.
    fn mean(&self, factor: Factor, bin: usize) -> f64 {
        let leaf = factor.leaf.and_then(|leaf| self.bins.means(leaf)).and_then(|means| means.get(bin));
        factor.scale * leaf.copied().unwrap_or(1.0)
    }

    fn multiply_row(&mut self, factor: Factor) {
        self.scale *= factor.scale;
        if let Some(means) = factor.leaf.and_then(|leaf| self.bins.means(leaf)) {
            self.row.iter_mut().zip(means).for_each(|(r, m)| *r *= m);
        }
    }
}

impl Carrier for Rows<'_> {
    fn start(&mut self, [first, second]: [f32; 2]) {
        self.scale = 1.0;
        self.row.fill(1.0);
        self.light.fill(0.0);
        self.position = unit_48([first, second]);
        self.chosen = None;
    }

    fn multiply(&mut self, terms: &[Term]) {
        match (self.chosen, terms) {
            (Some((bin, _, _)), _) => self.scale *= self.sum(terms, bin),
            (None, [(factor, share)]) => {
                self.scale *= share;
                if let Some(factor) = factor {
                    self.multiply_row(*factor);
                }
            }
            _ => (0..self.row.len()).for_each(|bin| self.row[bin] *= self.sum(terms, bin)),
        }
    }

    fn multiply_by(&mut self, function: &dyn Fn(f64) -> f64) {
        if let Some((_, wavelength, _)) = self.chosen {
            self.scale *= function(wavelength);
            return;
        }
        let (_, _, within) = self.choose();
        for (value, [from, to]) in self.row.iter_mut().zip(self.bins.limits()) {
            *value *= function(from + (to - from) * within);
        }
    }

    fn scale(&mut self, share: f64) {
        self.scale *= share;
    }

    fn wavelength(&self) -> Option<f64> {
        self.chosen.map(|(_, wavelength, _)| wavelength)
    }

    fn choose_wavelength(&mut self) -> f64 {
        if let Some((_, wavelength, _)) = self.chosen {
            return wavelength;
        }
        let (bin, share, within) = self.choose();
        let [from, to] = self.bins.limits()[bin];
        let wavelength = from + (to - from) * within;
        // A bin that is never chosen doesn't count for the observer.
        self.scale *= if share > 0.0 { self.row[bin] / share } else { 0.0 };
        self.chosen = Some((bin, wavelength, share));
        wavelength
    }

    fn gather(&mut self, terms: &[Term], light: Factor, weight: f64) {
        let weight = weight * self.scale;
        if let Some((bin, _, _)) = self.chosen {
            self.light[bin] += weight * self.sum(terms, bin) * self.mean(light, bin);
            return;
        }
        let [(None, share)] = terms else {
            for bin in 0..self.row.len() {
                self.light[bin] += weight * self.row[bin] * self.sum(terms, bin) * self.mean(light, bin);
            }
            return;
        };
        let weight = weight * share * light.scale;
        let sums = self.light.iter_mut().zip(&self.row);
        match light.leaf.and_then(|leaf| self.bins.means(leaf)) {
            Some(means) => sums.zip(means).for_each(|((sum, r), m)| *sum += weight * (r * m)),
            None => sums.for_each(|(sum, r)| *sum += weight * r),
        }
    }

    fn strength(&self, function: Functional) -> f64 {
        let all = || function.of_bins(self.bins, &self.row);
        self.scale * self.chosen.map_or_else(all, |(_, _, share)| share)
    }

    fn xyz(&self) -> [f64; 3] {
        normalised(self.bins.weights().each_ref().map(|w| w.iter().zip(&self.light).map(|(w, l)| w * l).sum()))
    }
}

/// A number in [0, 1) with the bits of two, of 24 each.
pub(super) fn unit_48([first, second]: [f32; 2]) -> f64 {
    f64::from(first) + f64::from(second) * (f64::from(f32::EPSILON) / 2.0)
}
