//! Colours by adaptive intervals, with a bound.

mod pixel;

use std::collections::HashMap;

use spectral_core::Observer;
use spectral_core::adaptive::{Mode, Piece, Status, Target, evaluate};
use spectral_core::bound::delta_e_bound;
use spectral_core::colour::rgb;
use spectral_core::expression::{Op, Order, Program, Sources};
use spectral_core::interval::{BuildError, Domain, Interval, Node, Pyramid, Weight, node_count, nodes};
use spectral_core::spectrum::{PiecewiseLinear, Spectrum};
use spectral_core::subdivision::{Scaled, Stage, Subdivision};

use self::pixel::{Group, Pixel, parts};
use super::hats::{Hat, STEPS, hats, measure};
use super::radiance::PairBuild;
use super::{
    Band, Colour, Monomial, Monomials, Palette, Radiance, Resolver, Tabulated, Tracer, Y_INTEGRAL, normalised,
};

/// How deep the visible domain may be split: 2⁸ parts of 1.6 nm. Products on the deepest parts are integrated exactly.
const DEPTH: u8 = 8;
/// The most intervals of one colour.
const MAX_PIECES: usize = 512;
/// Subdivisions are recorded for colours up to this luminance, relative to white; brighter ones are evaluated afresh.
const BRIGHTEST: f64 = 64.0;
/// How many products on intervals, and how many subdivisions, each thread keeps: 10 MB, and about as much.
const MAX_KEPT: usize = 1 << 16;
const MAX_RECORDED: usize = 1 << 13;
/// Sums of more products are evaluated together.
const MOST_SUMMED: usize = 12;
/// A colour of which nothing is known.
const UNKNOWN: Colour = Colour { radius: [f64::INFINITY; 3], delta_e: f64::INFINITY, intervals: 1, ..Colour::DARK };

/// What the interval representation aims at.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct IntervalSettings {
    /// How errors are taken.
    pub mode: Mode,
    /// The ΔE*ab to reach in each pixel.
    pub threshold: f64,
    /// The luminance Y of white, whose chromaticity is that of Rec. 709: 1 over what a picture is multiplied by to be looked at; positive and finite.
    pub white: f64,
}

impl IntervalSettings {
    /// The tristimulus values of white, Y = 1 for a flat radiance of 1.
    pub(crate) fn white(&self) -> [f64; 3] {
        rgb::WHITE.map(|w| w * self.white)
    }
}

impl Default for IntervalSettings {
    /// A certified bound of ΔE*ab 1 below a white of Y = 1.
    fn default() -> Self {
        Self { mode: Mode::Certified, threshold: 1.0, white: 1.0 }
    }
}

/// The scene's spectra on intervals, for all threads.
#[derive(Clone, Debug)]
pub struct SharedIntervals<'a> {
    domain: Domain<'a, f64>,
    pyramids: Vec<Pyramid<'a, f64>>,
    spectra: Vec<PiecewiseLinear<'a, f64>>,
    settings: IntervalSettings,
    white: [f64; 3],
    /// For each interval.
    bands: Vec<Band>,
}

/// The memory of [`SharedIntervals`].
#[derive(Clone, Debug, Default)]
pub struct IntervalMemory {
    weights: Vec<Weight<f64>>,
    intervals: Vec<Vec<Interval<f64>>>,
    hats: Vec<Tabulated>,
}

/// A product of spectra in a pixel: for light that is the same at all wavelengths, or what a hat has of it.
type Term = (Monomial, Option<Hat>);

impl<'a> SharedIntervals<'a> {
    /// Integrates all spectra of a palette, and the hats.
    ///
    /// # Errors
    /// A text that says what is wrong with which leaf.
    pub fn new(
        palette: &'a Palette,
        settings: IntervalSettings,
        memory: &'a mut IntervalMemory,
    ) -> Result<Self, String> {
        let count = node_count(DEPTH);
        let IntervalMemory { weights, intervals, hats: all_hats } = memory;
        *all_hats = hats();
        weights.resize(count, Weight::default());
        intervals.resize(palette.leaves().len() + all_hats.len(), vec![Interval::zero(); count]);
        let domain = Domain::build(Observer::cie_1931_2deg(), DEPTH, weights).map_err(|e: BuildError| e.to_string())?;
        let (mut pyramids, mut spectra) = (Vec::new(), Vec::new());
        let leaves = palette.leaves().iter().map(|(leaf, _)| leaf).chain(&*all_hats);
        for (leaf, buffer) in leaves.zip(intervals) {
            let spectrum = leaf.spectrum()?;
            pyramids.push(Pyramid::build(&spectrum, &domain, buffer).map_err(|e| e.to_string())?);
            spectra.push(spectrum);
        }
        let bands = nodes(DEPTH).map(|node| band(&domain, node)).collect();
        Ok(Self { domain, pyramids, spectra, settings, white: settings.white().map(|w| w * Y_INTEGRAL), bands })
    }

    /// The waves of an interval.
    fn band(&self, node: Node) -> Band {
        self.bands.get(node.position()).copied().unwrap_or_else(|| band(&self.domain, node))
    }

    /// The measure 1/λ² at the middles of an interval's first half, of itself and of its last half.
    fn measures(&self, node: Node) -> [f64; 3] {
        let [first, last] = halves(node);
        [first, node, last].map(|node| measure(self.band(node).wavelength))
    }

    /// What light at the middles of an interval's first half, of itself and of its last half is multiplied by for that at a wavelength, by the
    /// parabola in 1/λ² through them.
    fn parabola(&self, node: Node, wavelength: f64) -> [f64; 3] {
        let ([a, b, c], x) = (self.measures(node), measure(wavelength));
        [
            (x - b) * (x - c) / ((a - b) * (a - c)),
            (x - a) * (x - c) / ((b - a) * (b - c)),
            (x - a) * (x - b) / ((c - a) * (c - b)),
        ]
    }

    /// The same for how far the one in the middle is from the line through the other two.
    fn bend(&self, node: Node) -> [f64; 3] {
        let [a, b, c] = self.measures(node);
        [(b - c) / (c - a), 1.0, (a - b) / (c - a)]
    }

    fn order(&self) -> Order {
        self.settings.mode.order()
    }

    /// The leaf that a hat is: these follow the palette's.
    #[allow(clippy::cast_possible_truncation, reason = "leaves are numbered by 32 bits")]
    fn leaf_of(&self, Hat(number): Hat) -> u32 {
        let hats = STEPS.iter().map(|steps| u32::from(steps + 1)).sum::<u32>();
        self.pyramids.len() as u32 - hats + number
    }

    /// A product of spectra on an interval.
    fn product(&self, leaves: &[u32], node: Node, weight: &Weight<f64>) -> Interval<f64> {
        let mut factors = leaves.iter().filter_map(|leaf| self.pyramids.get(*leaf as usize)?.get(node));
        let Some(first) = factors.next() else { return Interval::constant(1.0, weight) };
        let product = factors.fold(*first, |product, factor| match self.order() {
            Order::First => product.product_first_order(factor),
            Order::Certified => product.product(factor, weight),
        });
        if node.level() < DEPTH || leaves.len() < 2 {
            return product;
        }
        let spectra: Vec<&dyn Spectrum<f64>> =
            leaves.iter().filter_map(|leaf| Some(self.spectra.get(*leaf as usize)? as &dyn Spectrum<f64>)).collect();
        Interval::of_product(&spectra, &self.domain, node, &product)
    }
}

/// A recorded subdivision of one term.
#[derive(Clone, Debug)]
struct Recorded {
    stages: Vec<Stage<f64>>,
    status: Status,
    largest: f64,
}

/// Colours by adaptive intervals: the buffers and caches of one thread.
pub struct Intervals<'a> {
    shared: &'a SharedIntervals<'a>,
    stack: Vec<Interval<f64>>,
    pieces: Vec<Piece<f64>>,
    ops: Vec<Op<f64>>,
    products: Products,
    recorded: HashMap<(u32, u32), Recorded, PairBuild>,
}

/// Products of spectra on intervals, kept for reuse: at most [`MAX_KEPT`], then they are forgotten.
#[derive(Clone, Debug, Default)]
struct Products {
    kept: HashMap<(u32, u32), Interval<f64>, PairBuild>,
}

impl Products {
    fn get(
        &mut self,
        shared: &SharedIntervals<'_>,
        monomials: &Monomials,
        (monomial, hat): Term,
        node: Node,
    ) -> Interval<f64> {
        let compute = || {
            let (leaves, weight) = (monomials.leaves(monomial), shared.domain.weight(node));
            match hat {
                None => shared.product(leaves, node, &weight),
                Some(hat) => shared.product(&[leaves, &[shared.leaf_of(hat)]].concat(), node, &weight),
            }
        };
        if self.kept.len() >= MAX_KEPT {
            self.kept.clear();
        }
        #[allow(clippy::cast_possible_truncation, reason = "below 2¹³")]
        let place = node.position() as u32 | Hat::code(hat) << 16;
        *self.kept.entry((monomial.number(), place)).or_insert_with(compute)
    }
}

impl<'a> Intervals<'a> {
    /// Empty caches on shared spectra.
    pub fn new(shared: &'a SharedIntervals<'a>) -> Self {
        Self {
            shared,
            stack: Vec::new(),
            pieces: vec![Piece::default(); MAX_PIECES],
            ops: Vec::new(),
            products: Products::default(),
            recorded: HashMap::default(),
        }
    }

    /// A single product: read from its recorded subdivision; `None` when it is brighter than that was recorded for.
    ///
    /// What is recorded doesn't depend on the pixels met before, so that colours don't depend on the order of pixels.
    fn scaled(&mut self, monomials: &Monomials, term: Term, scale: f64) -> Option<Scaled<f64>> {
        let key = (term.0.number(), Hat::code(term.1));
        if !self.recorded.contains_key(&key) {
            if self.recorded.len() >= MAX_RECORDED {
                self.recorded.clear();
            }
            let recorded = self.record(monomials, term);
            self.recorded.insert(key, recorded);
        }
        let recorded = self.recorded.get(&key).filter(|r| scale >= 0.0 && scale <= r.largest)?;
        let subdivision = Subdivision::from_stages(&recorded.stages, self.shared.white, recorded.status);
        Some(subdivision.at_scale(scale))
    }

    /// A sum of few products, each from its own subdivision; `None` if that is not good enough.
    fn summed(&mut self, monomials: &Monomials, terms: &[(Term, f64)]) -> Option<Colour> {
        if terms.len() > MOST_SUMMED {
            return None;
        }
        let (mut xyz, mut radius, mut size, mut intervals) = ([0.0; 3], [0.0; 3], [0.0; 3], 0);
        // As many times as bright, each has the intervals that make the sum good enough, about.
        #[allow(clippy::cast_precision_loss, reason = "a few")]
        let (count, times) = (terms.len() as f64, terms.len().next_power_of_two() as f64);
        for (term, scale) in terms {
            let found = self.scaled(monomials, *term, times * scale)?;
            xyz = core::array::from_fn(|a| xyz[a] + found.xyz[a] / times);
            size = core::array::from_fn(|a| size[a] + found.xyz[a].abs() / times);
            radius = core::array::from_fn(|a| radius[a] + found.radius[a] / times);
            intervals = intervals.max(found.intervals);
        }
        // Twice the rounding of so many sums.
        let rounding = 2.0 * f64::EPSILON * count;
        let radius = core::array::from_fn(|a| radius[a] * (1.0 + rounding) + rounding * size[a]);
        let delta_e = delta_e_bound(xyz, radius, self.shared.white).delta_e;
        let (xyz, radius) = (normalised(xyz), normalised(radius));
        (delta_e <= self.shared.settings.threshold).then_some(Colour {
            xyz,
            radius,
            delta_e,
            intervals,
            ..Colour::DARK
        })
    }

    fn record(&mut self, monomials: &Monomials, term: Term) -> Recorded {
        let shared = self.shared;
        let root = self.products.get(shared, monomials, term, Node::ROOT);
        let [_, luminance, _] = root.tristimulus(&shared.domain.weight(Node::ROOT));
        let largest = BRIGHTEST * shared.white[1] / luminance.abs().max(f64::MIN_POSITIVE);
        let mut stages = vec![Stage::default(); MAX_PIECES];
        let mut sources = Single { shared, monomials, term, products: &mut self.products };
        let ops = [Op::Deferred(0)];
        self.stack.resize(1, Interval::zero());
        let (count, status) = Program::new(&ops)
            .and_then(|program| {
                Subdivision::record(
                    &program,
                    &shared.domain,
                    shared.settings.mode,
                    shared.settings.threshold,
                    shared.white,
                    largest,
                    &mut sources,
                    &mut self.stack,
                    &mut self.pieces,
                    &mut stages,
                )
            })
            .map_or((0, Status::DepthExhausted), |s| (s.stages().len(), s.status()));
        stages.truncate(count);
        stages.shrink_to_fit();
        Recorded { stages, status, largest }
    }

    /// Any sum: evaluated afresh.
    fn general(&mut self, (terms, groups): (&[(Term, f64)], &[Group]), tracer: &mut dyn Tracer) -> Colour {
        let shared = self.shared;
        self.ops.clear();
        let weights = terms.iter().map(|(_, w)| *w).chain(groups.iter().map(|_| 1.0));
        for (number, weight) in (0_u32..).zip(weights) {
            self.ops.extend([Op::Deferred(number), Op::Scale(weight)]);
            if number > 0 {
                self.ops.push(Op::Sum);
            }
        }
        // A weight that is not finite, of a light too bright for numbers: nothing is known.
        let Ok(program) = Program::new(&self.ops) else { return UNKNOWN };
        self.stack.resize(program.stack_size(), Interval::zero());
        let target = Target { mode: shared.settings.mode, threshold: shared.settings.threshold, white: shared.white };
        let mut sources = Pixel::new((shared, &mut self.products), (terms, groups), tracer);
        let result = evaluate(&program, &shared.domain, &target, &mut sources, &mut self.stack, &mut self.pieces);
        let Ok(found) = result else {
            return UNKNOWN;
        };
        let nodes = self.pieces.iter().take(found.intervals).map(|p| p.node);
        let path = sources.path_radius(nodes);
        Colour {
            xyz: normalised(found.xyz),
            radius: normalised(found.radius),
            delta_e: found.delta_e,
            path_delta_e: path.map_or(0.0, |r| delta_e_bound(found.xyz, r, shared.white).delta_e),
            photon_delta_e: 0.0,
            intervals: found.intervals,
        }
    }
}

impl Resolver for Intervals<'_> {
    fn tolerance(&self) -> f64 {
        self.shared.settings.threshold
    }

    fn resolve(&mut self, radiance: &Radiance, tracer: &mut dyn Tracer) -> Colour {
        let general = |known: &mut Self, tracer: &mut dyn Tracer| {
            let (terms, groups) = parts(radiance, tracer);
            if terms.is_empty() && groups.is_empty() {
                return Colour { intervals: 1, ..Colour::DARK };
            }
            let are_lines = groups.is_empty() && terms.iter().any(|((_, hat), _)| hat.is_some());
            let summed = if are_lines { known.summed(tracer.monomials(), &terms) } else { None };
            summed.unwrap_or_else(|| known.general((&terms, &groups), tracer))
        };
        match (radiance.terms(), radiance.deferred()) {
            ([], []) => Colour { intervals: 1, ..Colour::default() },
            ([(monomial, scale)], []) => match self.scaled(tracer.monomials(), (*monomial, None), *scale) {
                Some(found) => Colour {
                    xyz: normalised(found.xyz),
                    radius: normalised(found.radius),
                    delta_e: found.delta_e,
                    intervals: found.intervals,
                    ..Colour::DARK
                },
                None => general(self, tracer),
            },
            _ => general(self, tracer),
        }
    }
}

/// One product as the source of a program.
struct Single<'p, 'a> {
    shared: &'a SharedIntervals<'a>,
    monomials: &'p Monomials,
    term: Term,
    products: &'p mut Products,
}

impl Sources<f64> for Single<'_, '_> {
    fn leaf(&self, _: u32, _: Node) -> Option<&Interval<f64>> {
        None
    }
    fn deferred(&mut self, _: u32, node: Node) -> Option<Interval<f64>> {
        Some(self.products.get(self.shared, self.monomials, self.term, node))
    }
}

/// The halves of an interval; the deepest is its own.
fn halves(node: Node) -> [Node; 2] {
    node.children().unwrap_or([node; 2])
}

/// The waves of an interval, for which stands its centroid, weighted by x̄ + ȳ + z̄ where these are not 0.
fn band(domain: &Domain<'_, f64>, node: Node) -> Band {
    const STEPS: u32 = 16;
    let [from, to] = node.limits::<f64>();
    let (mut moment, mut total) = (0.0, 0.0);
    for step in 0..STEPS {
        let wavelength = from + (to - from) * (f64::from(step) + 0.5) / f64::from(STEPS);
        let sensitivity: f64 = domain.observer().value(wavelength).iter().sum();
        moment += sensitivity * wavelength;
        total += sensitivity;
    }
    let wavelength = if total > 0.0 { moment / total } else { (from + to) / 2.0 };
    Band { wavelength, limits: [from, to] }
}

#[cfg(test)]
mod tests;
