//! Reflectances on parts of the spectrum, seen by an observer in the light of a lamp.
//!
//! Radiosity is linear in each lamp's spectrum E(λ), whatever lines that has; what a patch sends back, relative to E, depends on reflectances
//! alone, which are smooth. So each part of the domain has the measures dν = E ā dλ for ā = x̄, ȳ, z̄: products of lamp and colour-matching
//! function are leaves, integrated exactly, and what is split adaptively are the reflectances.

use spectral_core::Observer;
use spectral_core::adaptive::Mode;
use spectral_core::interval::{Domain, Interval, Node, Weight, node_count, nodes};
use spectral_core::spectrum::{PiecewiseLinear, Spectrum};

use crate::spectral::{Factor, Palette, Y_INTEGRAL};

/// How deep the domain may be split: 2⁸ parts of 1.6 nm.
pub(super) const DEPTH: u8 = 8;
/// Variances below this share of the squared maximum are rounding.
const VARIANCE_ROUNDING: f64 = 1e-13;
/// What rounding may cost a product or a sum, as a share of it.
const ROUNDING: f64 = 1e-13;

/// A reflectance on a part of the domain.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Part {
    /// Its mean ∫ρ dν / ∫dν in each channel.
    pub(super) mean: [f64; 3],
    /// The mean in all channels, by Iehl and Péroche's eq. 1 with E ā in place of ā.
    pub(super) common: f64,
    /// At least √(∫(ρ − mean)² dν / ∫dν) in any channel.
    pub(super) deviation: f64,
    /// At least the greatest mean, and the greatest value.
    pub(super) most: f64,
    pub(super) high: f64,
}

/// A part of the domain under one lamp.
#[derive(Clone, Debug)]
pub(super) struct Cell {
    /// Which lamp.
    pub(super) lamp: usize,
    pub(super) node: Node,
    /// ∫dν = ∫Eā over the part, over ∫ȳ.
    mass: [f64; 3],
    /// For each leaf of the palette, what it is as a reflectance.
    parts: Vec<Part>,
}

/// What is kept of a spectrum relative to the lamp's on a cell.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Row {
    /// ∫S dν / ∫dν in each channel, nearly.
    pub(super) value: [f64; 3],
    /// Certified: at least √(∫(S − value)² dν / ∫dν) in any channel. First order: the mean of all channels.
    pub(super) norm: f64,
    /// Certified: how far any of `value` may be off. Not used by the first order.
    pub(super) radius: f64,
}

impl Row {
    pub(super) fn new([x, y, z, norm, radius]: [f64; 5]) -> Self {
        Self { value: [x, y, z], norm, radius }
    }

    pub(super) const fn numbers(&self) -> [f64; 5] {
        let [x, y, z] = self.value;
        [x, y, z, self.norm, self.radius]
    }

    /// The spectrum times a number that isn't negative.
    pub(super) fn times(&self, factor: f64) -> Self {
        Self::new(self.numbers().map(|v| v * factor))
    }
}

impl Cell {
    /// What a reflectance's spectrum is here.
    pub(super) fn part(&self, factor: Factor) -> Part {
        let known = factor.leaf.and_then(|leaf| self.parts.get(leaf as usize));
        let one = Part { mean: [1.0; 3], common: 1.0, deviation: 0.0, most: 1.0, high: 1.0 };
        let part = known.copied().unwrap_or(one);
        let times = |v: f64| v * factor.scale;
        Part {
            mean: part.mean.map(times),
            common: times(part.common),
            deviation: times(part.deviation),
            most: times(part.most),
            high: times(part.high),
        }
    }

    /// A spectrum times a reflectance.
    ///
    /// With δ = ρ − mean: |∫ρS − mean·value| ≤ mean·radius + ‖δ‖ ‖S − value‖, and
    /// ‖ρS − mean·value‖ ≤ sup ρ ‖S − value‖ + ‖δ‖ value, all over ∫dν.
    pub(super) fn reflected(mode: Mode, part: &Part, row: &Row) -> Row {
        let value: [f64; 3] = core::array::from_fn(|a| part.mean[a] * row.value[a]);
        if mode != Mode::Certified {
            return Row { value, norm: part.common * row.norm, radius: 0.0 };
        }
        let most = row.value.iter().fold(0.0, |m: f64, v| m.max(v.abs()));
        let up = 1.0 + ROUNDING;
        Row {
            value,
            norm: (part.high * row.norm + part.deviation * most) * up,
            radius: (part.most * row.radius + part.deviation * row.norm) * up + ROUNDING * part.most * most,
        }
    }

    /// Tristimulus values of a radiance and how far they may be off: certain in the certified mode, an estimate otherwise.
    pub(super) fn colour(&self, mode: Mode, row: &Row) -> ([f64; 3], [f64; 3]) {
        let times = |v: [f64; 3]| core::array::from_fn(|a| v[a] * self.mass[a]);
        let first = core::array::from_fn(|a| (row.value[a] - row.norm).abs());
        match mode {
            Mode::Paper => (times([row.norm; 3]), times(first)),
            Mode::Corrected => (times(row.value), times(first)),
            Mode::Certified => {
                let most = row.value.iter().fold(0.0, |m: f64, v| m.max(v.abs()));
                // Where little is seen in a channel, that little is less exact.
                let rounding = ROUNDING * most * self.mass.iter().fold(0.0, |m: f64, v| m.max(*v));
                (times(row.value), core::array::from_fn(|a| self.mass[a] * row.radius + rounding))
            }
        }
    }
}

/// The spectra of a palette, ready for integration over parts of the domain.
pub(super) struct Spectra<'p> {
    leaves: Vec<PiecewiseLinear<'p, f64>>,
    domain: Domain<'p, f64>,
}

/// Room for the weights of a domain.
pub(super) type Weights = Vec<Weight<f64>>;

impl<'p> Spectra<'p> {
    pub(super) fn new(palette: &'p Palette, weights: &'p mut Weights) -> Result<Self, String> {
        weights.resize(node_count(DEPTH), Weight::default());
        let domain = Domain::build(Observer::cie_1931_2deg(), DEPTH, weights).map_err(|e| e.to_string())?;
        let leaves = palette.leaves().iter().map(|(leaf, _)| leaf.spectrum()).collect::<Result<_, _>>()?;
        Ok(Self { leaves, domain })
    }

    /// A part under a lamp, or `None` where that sends nothing that is seen.
    pub(super) fn cell(&self, lamp: usize, light: Option<u32>, node: Node) -> Option<Cell> {
        let light = light.and_then(|leaf| self.leaves.get(leaf as usize)).map(|s| s as &dyn Spectrum<f64>);
        let integrals = |more: &[&dyn Spectrum<f64>]| -> [f64; 3] {
            let factors: Vec<_> = light.into_iter().chain(more.iter().copied()).collect();
            let product = Interval::of_product(&factors, &self.domain, node, &Interval::zero());
            product.tristimulus(&self.domain.weight(node))
        };
        let mass = integrals(&[]);
        if !mass.iter().any(|m| *m > 0.0) {
            return None;
        }
        let part = |leaf: &PiecewiseLinear<'_, f64>| {
            let Interval { low, high, .. } = Interval::of_spectrum(leaf, &self.domain, node);
            let (firsts, seconds) = (integrals(&[leaf]), integrals(&[leaf, leaf]));
            let mean: [f64; 3] =
                core::array::from_fn(|a| if mass[a] > 0.0 { (firsts[a] / mass[a]).clamp(low, high) } else { f64::NAN });
            let weighted = |v: [f64; 3]| v.iter().zip(mass).map(|(v, m)| v * m).sum::<f64>();
            let common = (weighted(firsts) / weighted(mass)).clamp(low, high);
            let mut variance = 0.0_f64;
            for a in (0..3).filter(|a| mass[*a] > 0.0) {
                let exact = seconds[a] / mass[a] - mean[a] * mean[a];
                // Neither can a variance be more than this, whatever rounding does where there is hardly any light.
                let most = (high - mean[a]) * (mean[a] - low);
                variance = variance.max(exact.min(most.max(0.0)));
            }
            // Nothing depends on the mean in a channel that sees nothing.
            let mean = mean.map(|m| if m.is_nan() { common } else { m });
            let most = mean.iter().fold(common, |m: f64, v| m.max(*v)) * (1.0 + ROUNDING);
            Part { mean, common, deviation: (variance + VARIANCE_ROUNDING * high * high).sqrt(), most, high }
        };
        let parts = self.leaves.iter().map(part).collect();
        Some(Cell { lamp, node, mass: mass.map(|m| m.max(0.0) / Y_INTEGRAL), parts })
    }

    /// The greatest value of a reflectance in the visible domain.
    pub(super) fn greatest(&self, factor: Factor) -> f64 {
        self.high(factor, Node::ROOT)
    }

    /// Whether all these reflectances reach 1 somewhere in one of the smallest parts.
    pub(super) fn reflects_all(&self, factors: &[Factor]) -> bool {
        let smallest = nodes(DEPTH).filter(|node| node.level() == DEPTH);
        let all = |node: Node| factors.iter().all(|factor| self.high(*factor, node) >= 1.0);
        !factors.is_empty() && smallest.into_iter().any(all)
    }

    fn high(&self, factor: Factor, node: Node) -> f64 {
        let leaf = factor.leaf.and_then(|leaf| self.leaves.get(leaf as usize));
        factor.scale * leaf.map_or(1.0, |leaf| Interval::of_spectrum(leaf, &self.domain, node).high)
    }
}
