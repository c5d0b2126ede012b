//! Reflectances on parts of the spectrum, seen by an observer in the light of a lamp.
//!
//! Radiosity is linear in each lamp's spectrum E(λ), whatever lines that has; what a patch sends back, relative to E, depends on reflectances
//! alone, which are smooth. So each part of the domain has the measures dν = E ā dλ for ā = x̄, ȳ, z̄: products of lamp and colour-matching
//! function are leaves, integrated exactly, and what is split adaptively are the reflectances.
//!
//! On a part of the domain a spectrum is its mean in each channel, plus a slope, one for all channels, times the part's ramp φ, plus a rest that
//! is bounded. φ is linear in λ, from −1 to 1 less its mean in the channel, so that it doesn't change means. The product of two spectra has the
//! product of their means and slopes; where both rise or fall, their covariance adds to the mean. That is of the second order in the part's
//! width; rests, and what they and the slopes of two spectra leave between them, are bounded by norms, and count in a mean by the third order.

use rayon::prelude::*;
use spectral_core::Observer;
use spectral_core::adaptive::Mode;
use spectral_core::interval::{MAX_DEPTH, Node, node_count, nodes};
use spectral_core::spectrum::{PiecewiseLinear, Spectrum};

use super::moments::{Leaf, LeafMoments, Moments};
use super::ramp::{Line, Ramp};
use crate::spectral::{Factor, Palette, Role, Tabulated, Y_INTEGRAL};

/// How deep the domain may be split: 2¹² parts of 0.1 nm, because what reflects nearly all light only around one wavelength has
/// a resonance there.
pub(super) const DEPTH: u8 = MAX_DEPTH;
/// Down to this level, 64 parts, integrals are tabulated; those of greater parts are sums.
const TABULATED: u8 = 6;
/// Nodes that one task integrates over.
const NODES: usize = 16;
/// Variances below this share of the squared maximum are rounding.
pub(super) const VARIANCE_ROUNDING: f64 = 1e-13;
/// What rounding may cost a product or a sum, as a share of it.
pub(super) const ROUNDING: f64 = 1e-13;
/// Deviations below this share of the maximum are of rounding alone.
const CONSTANT: f64 = 1e-6;
/// The least share of a channel in a radius: what iteration and rounding leave in any channel is multiplied by the inverse.
pub(super) const LEAST_SHARE: f64 = 0.01;

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
    /// What the [ramp](Cell) is multiplied by.
    pub(super) slope: f64,
    /// ∫ρφ dν / ∫dν in each channel, and at least how far rounding puts it off, over the least share.
    pub(super) covariance: [f64; 3],
    pub(super) unsure: f64,
    /// At least the norm of ρ − mean − slope φ in any channel, over the root of its [share](Cell).
    pub(super) rest: f64,
    /// At least the same of (ρ − mean) φ less its mean.
    pub(super) product: f64,
    /// About the same of φ times what one slope for all channels leaves of the slope that light of slope 1 has when it is reflected.
    pub(super) skew: f64,
}

/// A part of the domain under one lamp.
#[derive(Clone, Debug)]
pub(super) struct Cell {
    /// Which lamp.
    pub(super) lamp: usize,
    pub(super) node: Node,
    /// ∫dν = ∫Eā over the part, over ∫ȳ.
    mass: [f64; 3],
    /// For each channel, at least the square of any reflectance's deviation there over its greatest in any channel: norms are less by the
    /// root of this, and radii by this, as both deviations of a covariance are.
    share: [f64; 3],
    /// For each leaf of the palette, what it is as a reflectance; lights count as 1.
    parts: Vec<Part>,
    pub(super) ramp: Ramp,
}

/// What is kept of a spectrum relative to the lamp's on a cell.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Row {
    /// ∫S dν / ∫dν in each channel, nearly.
    pub(super) value: [f64; 3],
    /// Certified: what the cell's [ramp](Cell) is multiplied by. Not used by the first order.
    pub(super) slope: f64,
    /// Certified: at least √(∫(S − value − slope φ)² dν / ∫dν) in any channel. First order: the mean of all channels.
    pub(super) norm: f64,
    /// Certified: how far any of `value` may be off, but for the [share](Cell) of the channel. Not used by the first order.
    pub(super) radius: f64,
}

impl Row {
    pub(super) const NUMBERS: usize = 6;

    pub(super) fn new([x, y, z, slope, norm, radius]: [f64; Self::NUMBERS]) -> Self {
        Self { value: [x, y, z], slope, norm, radius }
    }

    pub(super) const fn numbers(&self) -> [f64; Self::NUMBERS] {
        let [x, y, z] = self.value;
        [x, y, z, self.slope, self.norm, self.radius]
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
        let part = known.copied().unwrap_or(ONE);
        let times = |v: f64| v * factor.scale;
        Part {
            mean: part.mean.map(times),
            common: times(part.common),
            deviation: times(part.deviation),
            most: times(part.most),
            high: times(part.high),
            slope: times(part.slope),
            covariance: part.covariance.map(times),
            unsure: times(part.unsure),
            rest: times(part.rest),
            product: times(part.product),
            skew: times(part.skew),
        }
    }

    /// A spectrum times a reflectance.
    ///
    /// With δ = ρ − mean = slope φ + ε and S = value + s φ + R up to the radius, ρS has the mean mean·value + cov s, but for δR; and
    /// ρS − that is (slope value + mean s) φ + ε value + (δφ − cov) s + ρR. So a radius becomes mean·radius + ‖δ‖ ‖R‖, and the rest's norm
    /// sup ρ ‖R‖ + ‖ε‖ value + ‖δφ − cov‖ |s| and ‖φ‖ times what one slope for all channels is off.
    pub(super) fn reflected(&self, mode: Mode, part: &Part, row: &Row) -> Row {
        if mode != Mode::Certified {
            let value = core::array::from_fn(|a| part.mean[a] * row.value[a]);
            return Row { value, norm: part.common * row.norm, ..Row::default() };
        }
        let value: [f64; 3] = core::array::from_fn(|a| part.mean[a] * row.value[a] + part.covariance[a] * row.slope);
        let mean: f64 = row.value.iter().zip(self.ramp.weights).map(|(v, w)| v * w).sum();
        let slope = part.slope * mean + part.common * row.slope;
        let off = |a: usize| (part.slope * row.value[a] + part.mean[a] * row.slope - slope).abs() * self.ramp.norm[a];
        let off = (0..3).fold(0.0, |m: f64, a| m.max(off(a)));
        let most = row.value.iter().fold(0.0, |m: f64, v| m.max(v.abs()));
        // What rounding may do to a value, and to a slope as a norm.
        let size = part.high * (most + row.slope.abs());
        let up = 1.0 + ROUNDING;
        Row {
            value,
            slope,
            norm: (part.high * row.norm + part.rest * most + part.product * row.slope.abs() + off) * up
                + ROUNDING * self.ramp.most() * (part.slope.abs() * most + size),
            radius: (part.most * row.radius + part.deviation * row.norm) * up
                + part.unsure * row.slope.abs()
                + ROUNDING / LEAST_SHARE * size,
        }
    }

    /// Adds the [colours](Self::colour) of rows of radiosity, and how far they may be off, to those of other cells.
    pub(super) fn add_colours(&self, mode: Mode, rows: &[Row], sums: &mut [[[f64; 3]; 2]]) {
        for (row, [xyz, radius]) in rows.iter().zip(sums) {
            let (value, around) = self.colour(mode, row);
            *xyz = sum(*xyz, value);
            *radius = sum(*radius, around);
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
                (times(row.value), core::array::from_fn(|a| self.mass[a] * self.share[a] * row.radius + rounding))
            }
        }
    }
}

/// The spectra of a palette, ready for integration over parts of the domain.
pub(super) struct Spectra<'p> {
    leaves: Vec<Leaf<'p>>,
    /// Whether second moments are needed, too.
    deviations: bool,
    /// The greatest value of each leaf in the visible domain; lights count as 1.
    greatest: Vec<f64>,
    /// For each lamp, moments on all nodes down to [`TABULATED`].
    tables: Vec<Vec<Moments>>,
}

fn sum(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    core::array::from_fn(|i| a[i] + b[i])
}

impl<'p> Spectra<'p> {
    /// Without `deviations`, parts have none.
    pub(super) fn new(palette: &'p Palette, deviations: bool) -> Result<Self, String> {
        let leaf = |(leaf, role): &'p (Tabulated, Role)| Ok::<_, String>((leaf.spectrum()?, *role));
        let leaves = palette.leaves().iter().map(leaf).collect::<Result<Vec<_>, _>>()?;
        let greatest = |(leaf, role): &Leaf<'_>| if *role == Role::Light { 1.0 } else { range(leaf, Node::ROOT)[1] };
        let greatest = leaves.iter().map(greatest).collect();
        Ok(Self { leaves, deviations, greatest, tables: Vec::new() })
    }

    /// Integrates all products with these lamps' spectra.
    pub(super) fn tabulate(&mut self, lamps: &[Option<u32>]) {
        self.tables = lamps.iter().map(|lamp| self.table(*lamp)).collect();
    }

    fn table(&self, lamp: Option<u32>) -> Vec<Moments> {
        let finest: Vec<Node> = nodes(TABULATED).filter(|node| node.level() == TABULATED).collect();
        let finest = finest.into_par_iter().with_min_len(NODES);
        let mut table: Vec<Moments> = finest.map(|node| self.integrated(lamp, node)).collect();
        // From the last node to the first, as children come after their parents.
        table.reverse();
        for pair in (0..node_count(TABULATED - 1)).map(|pair| 2 * pair) {
            let both = table[pair + 1].over_both(&table[pair]);
            table.push(both);
        }
        table.reverse();
        table
    }

    fn integrated(&self, lamp: Option<u32>, node: Node) -> Moments {
        let lamp = lamp.and_then(|leaf| self.leaves.get(leaf as usize)).map(|(lamp, _)| lamp);
        Moments::new(&Observer::cie_1931_2deg(), lamp, &self.leaves, node, !self.deviations)
    }

    /// A part under a lamp, or `None` where that sends nothing that is seen.
    pub(super) fn cell(&self, lamp: usize, light: Option<u32>, node: Node) -> Option<Cell> {
        let known = self.tables.get(lamp).and_then(|table| table.get(node.position()));
        let integrated = known.is_none().then(|| self.integrated(light, node));
        let moments = known.or(integrated.as_ref())?;
        let Moments { mass, leaves, .. } = moments;
        if !mass.iter().any(|m| *m > 0.0) {
            return None;
        }
        let mut share = [LEAST_SHARE; 3];
        let mut part = |(moments, (_, role)): (&LeafMoments, &(PiecewiseLinear<'_, f64>, Role))| {
            if *role == Role::Light {
                return (ONE, [0.0; 3]);
            }
            let (mut part, deviations) = self.part(moments, *mass);
            if part.deviation <= CONSTANT * part.high {
                // Of rounding alone, which is no less in one channel than in another.
                part.deviation /= LEAST_SHARE.sqrt();
                return (part, deviations);
            }
            for (share, deviation) in share.iter_mut().zip(deviations) {
                *share = share.max((deviation / part.deviation).powi(2).min(1.0));
            }
            (part, deviations)
        };
        let found: Vec<(Part, [f64; 3])> = leaves.iter().zip(&self.leaves).map(&mut part).collect();
        let line = Line::new(node, moments);
        let ramp = if self.deviations { line.ramp(share) } else { Ramp::default() };
        let inclined = |(((mut part, deviations), moments), (_, role)): (((Part, [f64; 3]), _), &(_, Role))| {
            if self.deviations && *role != Role::Light {
                line.incline(&mut part, moments, deviations, (share, &ramp));
            }
            part
        };
        let parts = found.into_iter().zip(leaves).zip(&self.leaves).map(inclined).collect();
        Some(Cell { lamp, node, mass: mass.map(|m| m.max(0.0) / Y_INTEGRAL), share, parts, ramp })
    }

    /// A reflectance on a part, and at least its deviation in each channel.
    fn part(&self, moments: &LeafMoments, mass: [f64; 3]) -> (Part, [f64; 3]) {
        let LeafMoments { firsts, seconds, range: [low, high], .. } = *moments;
        let weighted = |v: [f64; 3]| v.iter().zip(mass).map(|(v, m)| v * m).sum::<f64>();
        let common = (weighted(firsts) / weighted(mass)).clamp(low, high);
        // Nothing depends on the mean in a channel that sees nothing.
        let mean: [f64; 3] =
            core::array::from_fn(|a| if mass[a] > 0.0 { (firsts[a] / mass[a]).clamp(low, high) } else { common });
        let deviations: [f64; 3] = core::array::from_fn(|a| {
            if !self.deviations {
                return 0.0;
            }
            let exact = if mass[a] > 0.0 { seconds[a] / mass[a] - mean[a] * mean[a] } else { 0.0 };
            // Neither can a variance be more than this, whatever rounding does where there is hardly any light.
            let most = (high - mean[a]) * (mean[a] - low);
            (exact.min(most).max(0.0) + VARIANCE_ROUNDING * high * high).sqrt()
        });
        let greatest = |v: [f64; 3]| v.iter().fold(0.0, |m: f64, v| m.max(*v)) * (1.0 + ROUNDING);
        let (deviation, most) = (greatest(deviations), greatest(mean).max(common));
        // As without a slope.
        (Part { mean, common, deviation, most, high, rest: deviation, ..Part::default() }, deviations)
    }

    /// The greatest value of a reflectance in the visible domain.
    pub(super) fn greatest(&self, factor: Factor) -> f64 {
        factor.scale * factor.leaf.and_then(|leaf| self.greatest.get(leaf as usize)).map_or(1.0, |greatest| *greatest)
    }

    /// Whether all these reflectances reach 1 somewhere in one of the smallest parts.
    pub(super) fn reflects_all(&self, factors: &[Factor]) -> bool {
        if factors.iter().any(|factor| !(self.greatest(*factor) >= 1.0)) {
            return false;
        }
        let high = |factor: &Factor, node: Node| {
            let leaf = factor.leaf.and_then(|leaf| self.leaves.get(leaf as usize));
            factor.scale * leaf.map_or(1.0, |(leaf, _)| range(leaf, node)[1])
        };
        let mut smallest = nodes(DEPTH).filter(|node| node.level() == DEPTH);
        !factors.is_empty() && smallest.any(|node| factors.iter().all(|factor| high(factor, node) >= 1.0))
    }
}

/// The reflectance 1.
const ONE: Part = Part {
    mean: [1.0; 3],
    common: 1.0,
    deviation: 0.0,
    most: 1.0,
    high: 1.0,
    slope: 0.0,
    covariance: [0.0; 3],
    unsure: 0.0,
    rest: 0.0,
    product: 0.0,
    skew: 0.0,
};

/// At most the least and at least the greatest value on a part.
pub(super) fn range(spectrum: &PiecewiseLinear<'_, f64>, node: Node) -> [f64; 2] {
    let [from, to] = node.limits::<f64>();
    let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
    let mut note = |value: f64| (low, high) = (low.min(value), high.max(value));
    let mut position = from;
    while position < to {
        let segment = spectrum.segment(position);
        note(segment.first);
        if segment.end <= to {
            note(segment.last);
        } else {
            note(spectrum.value(to));
        }
        position = segment.end;
    }
    around([low, high])
}

/// A range with what rounding may have cost it.
pub(super) fn around([low, high]: [f64; 2]) -> [f64; 2] {
    let margin = ROUNDING * high.abs().max(low.abs());
    [low - margin, high + margin]
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "tests fail by panicking")]
mod tests {
    use spectral_core::Observer;
    use spectral_core::adaptive::Mode;
    use spectral_core::interval::Node;
    use spectral_core::spectrum::Spectrum as _;

    use super::{Row, Spectra};
    use crate::spectral::{Factor, Palette, Role, Tabulated};

    /// Wavelengths, and light as the three channels see it there, over a part.
    fn dense(light: &Tabulated, node: Node) -> Vec<(f64, [f64; 3])> {
        const COUNT: u32 = 4000;
        let ([from, to], observer) = (node.limits::<f64>(), Observer::<f64>::cie_1931_2deg());
        let light = light.spectrum().unwrap();
        let at = |index: u32| from + (to - from) * (f64::from(index) + 0.5) / f64::from(COUNT);
        (0..COUNT).map(at).map(|w| (w, observer.value(w).map(|a| a * light.value(w)))).collect()
    }

    fn mean(points: &[(f64, [f64; 3])], channel: usize, of: impl Fn(f64) -> f64) -> f64 {
        let (sum, mass) = points
            .iter()
            .fold((0.0, 0.0), |(sum, mass), (w, seen)| (sum + seen[channel] * of(*w), mass + seen[channel]));
        sum / mass
    }

    /// Light that is reflected by five surfaces in turn, whose spectra rise, fall and have peaks, is within its row's bounds on parts of all sizes
    /// in all channels; radii fall by the third power of the width.
    #[test]
    fn reflected_light_is_within_its_bounds() {
        let mut palette = Palette::default();
        let lamp =
            Tabulated { wavelengths: vec![380.0, 520.0, 545.0, 570.0, 780.0], values: vec![0.2, 1.0, 4.0, 1.0, 2.0] };
        let surfaces = [
            Tabulated { wavelengths: vec![380.0, 780.0], values: vec![0.05, 0.95] },
            Tabulated { wavelengths: vec![380.0, 600.0, 780.0], values: vec![0.9, 0.3, 0.25] },
            Tabulated::sampled(|w| 0.1 + 0.8 * (-((w - 560.0) / 60.0).powi(2)).exp()),
            Tabulated::sampled(|w| 0.5 + 0.4 * (w / 45.0).sin()),
        ];
        let light = palette.leaf(lamp.clone(), 1.0, Role::Light);
        let factors: Vec<Factor> =
            surfaces.iter().map(|surface| palette.leaf(surface.clone(), 1.0, Role::Reflectance)).collect();
        let spectra = Spectra::new(&palette, true).unwrap();
        let mut radii = Vec::new();
        let mut node = Node::ROOT;
        for right in [false, true, true, false, true, false] {
            let cell = spectra.cell(0, light.leaf, node).unwrap();
            let points = dense(&lamp, node);
            let [from, to] = node.limits::<f64>();
            let ramp = |w: f64| (2.0 * w - from - to) / (to - from);
            let mut row = Row { value: [1.0; 3], ..Row::default() };
            let mut so_far = Vec::new();
            for index in [0, 1, 2, 3, 0] {
                so_far.push(surfaces[index].spectrum().unwrap());
                row = cell.reflected(Mode::Certified, &cell.part(factors[index]), &row);
                let spectrum = |w: f64| so_far.iter().map(|s| s.value(w)).product::<f64>();
                for a in 0..3 {
                    let off = (mean(&points, a, spectrum) - row.value[a]).abs();
                    let known = cell.share[a] * row.radius;
                    assert!(off <= known + 1e-6, "{node:?}, {}, {a}: {off} > {known}", so_far.len());
                    let centre = mean(&points, a, ramp);
                    let rest = |w: f64| (spectrum(w) - row.value[a] - row.slope * (ramp(w) - centre)).powi(2);
                    let (norm, known) = (mean(&points, a, rest).sqrt(), cell.share[a].sqrt() * row.norm);
                    assert!(norm <= known + 1e-6, "{node:?}, {}, {a}: {norm} > {known}", so_far.len());
                }
            }
            radii.push(row.radius);
            node = node.children().unwrap()[usize::from(right)];
        }
        // Halving twice: 64 times for the third power, 16 for the second.
        let ratios: Vec<f64> = radii.iter().zip(&radii[2..]).map(|(wide, narrow)| wide / narrow).collect();
        assert!(ratios[2..].iter().all(|ratio| *ratio > 25.0), "{radii:?} {ratios:?}");
    }
}
