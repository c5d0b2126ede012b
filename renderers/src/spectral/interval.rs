//! Colours by adaptive intervals, with a bound.

use std::collections::HashMap;

use spectral_core::Observer;
use spectral_core::adaptive::{Mode, Piece, Status, Target, evaluate};
use spectral_core::bound::delta_e_bound;
use spectral_core::colour::rgb;
use spectral_core::expression::{Op, Order, Program, Sources};
use spectral_core::interval::{BuildError, Domain, Interval, Node, Pyramid, Weight, node_count, nodes};
use spectral_core::spectrum::{PiecewiseLinear, Spectrum};
use spectral_core::subdivision::{Scaled, Stage, Subdivision};

use super::hats::{Hat, Lines, STEPS, hats, measure};
use super::radiance::PairBuild;
use super::{
    Band, Colour, Deferred, Monomial, Monomials, Palette, Radiance, Resolver, Tabulated, Tracer, Y_INTEGRAL, normalised,
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

/// The part of the threshold that all paths of a pixel together may take before they are traced for narrower intervals.
const PATH_SHARE: f64 = 0.5;

/// Light of an interval's halves that differs by more than this share of the whole is uneven.
const UNEVEN: f64 = 0.5;

/// A pixel's radiance as the sources of a program: first its products, then its deferred light.
///
/// Paths change less from wavelength to wavelength than spectra do, and steadily. So deferred light is traced for the halves of the domain and
/// for its middle; where a line in 1/λ² through the halves' light meets that in the middle, all intervals have theirs by the parabola through
/// the three. Where it doesn't, the same is tried with each half, and so on. How far light may be off is estimated for each interval, and
/// enters the bound.
struct Pixel<'p, 'a> {
    shared: &'a SharedIntervals<'a>,
    terms: &'p [(Term, f64)],
    groups: &'p [Group],
    tracer: &'p mut dyn Tracer,
    products: &'p mut Products,
    /// Light that was traced for the middle wavelengths of intervals.
    traced: ByNode<Radiance>,
    /// Whether light for the parts of an interval can be interpolated between that of itself and its halves.
    is_steady: ByNode<bool>,
    /// How far the interval's tristimulus values may be off by the path that was traced.
    path_radii: ByNode<[f64; 3]>,
    /// About the pixel's tristimulus values, once they have been asked for.
    total: Option<[f64; 3]>,
}

/// Deferred light that is seen through the same product of spectra, each with what it is multiplied by: it is taken together, as parts of it may
/// change where their sum doesn't.
struct Group {
    number: u32,
    through: Monomial,
    parts: Vec<(Deferred, f64)>,
}

/// A pixel's products, those of lines among them, and the groups of the rest of its deferred light.
fn parts(radiance: &Radiance, tracer: &mut dyn Tracer) -> (Vec<(Term, f64)>, Vec<Group>) {
    let mut terms: Vec<(Term, f64)> = radiance.terms().iter().map(|(m, weight)| ((*m, None), *weight)).collect();
    let mut lines: Vec<Lines> = Vec::new();
    let mut groups: Vec<Group> = Vec::new();
    for (deferred, through, weight) in radiance.deferred() {
        let mut add = |monomial: Monomial, weights: &[f64]| {
            let steps = u16::try_from(weights.len()).unwrap_or(0).saturating_sub(1);
            let own =
                Lines { monomial, steps, ends: core::array::from_fn(|end| weights.get(end).copied().unwrap_or(0.0)) };
            match lines.iter_mut().find(|known| known.monomial == monomial) {
                Some(known) => *known = known.plus(own),
                None => lines.push(own),
            }
        };
        if tracer.lines(*deferred, (*through, *weight), &STEPS, &mut add) {
            continue;
        }
        match groups.iter_mut().find(|group| group.through == *through) {
            Some(group) => match group.parts.iter_mut().find(|(known, _)| known == deferred) {
                Some((_, sum)) => *sum += weight,
                None => group.parts.push((*deferred, *weight)),
            },
            None => {
                let number = u32::try_from(groups.len()).unwrap_or(u32::MAX);
                groups.push(Group { number, through: *through, parts: vec![(*deferred, *weight)] });
            }
        }
    }
    for Lines { monomial, steps, ends } in lines {
        terms.extend(Hat::all(steps).zip(ends).map(|(hat, weight)| ((monomial, Some(hat)), weight)));
    }
    (terms, groups)
}

/// What is known of groups of deferred light on intervals.
type ByNode<T> = HashMap<(u32, u32), T, PairBuild>;

#[allow(clippy::cast_possible_truncation, reason = "below 2¹³")]
const fn key(group: &Group, node: Node) -> (u32, u32) {
    (group.number, node.position() as u32)
}

/// Deferred light on an interval, and what its tristimulus values may be off by.
struct Served {
    light: Radiance,
    estimate: [f64; 3],
}

impl<'p, 'a> Pixel<'p, 'a> {
    fn new(
        (shared, products): (&'a SharedIntervals<'a>, &'p mut Products),
        (terms, groups): (&'p [(Term, f64)], &'p [Group]),
        tracer: &'p mut dyn Tracer,
    ) -> Self {
        let (traced, is_steady, path_radii) = (ByNode::default(), ByNode::default(), ByNode::default());
        Self { shared, terms, groups, tracer, products, traced, is_steady, path_radii, total: None }
    }

    /// Deferred light traced for the middle wavelength of an interval, once.
    fn trace(&mut self, deferred: &Group, node: Node) -> &Radiance {
        let (tracer, shared) = (&mut self.tracer, self.shared);
        self.traced.entry(key(deferred, node)).or_insert_with(|| {
            let mut sum = Radiance::default();
            for (deferred, scale) in &deferred.parts {
                for (monomial, weight) in tracer.trace(*deferred, shared.band(node)).terms() {
                    sum.add(*monomial, scale * weight);
                }
            }
            sum
        })
    }

    /// A sum of traced light.
    fn combined(&mut self, deferred: &Group, parts: &[(Node, f64)]) -> Radiance {
        let mut sum = Radiance::default();
        for (node, share) in parts {
            for (monomial, weight) in self.trace(deferred, *node).terms() {
                sum.add(*monomial, share * weight);
            }
        }
        sum
    }

    /// The light of the whole domain: that of its halves, by their parts of the eye's sensitivity.
    fn whole(&mut self, deferred: &Group) -> Radiance {
        let parts = halves(Node::ROOT).map(|half| (half, self.share(half)));
        self.combined(deferred, &parts)
    }

    /// The part of the eye's sensitivity that an interval has.
    fn share(&self, node: Node) -> f64 {
        let sensitivity = |node: Node| self.shared.domain.weight(node).integral.iter().sum::<f64>();
        sensitivity(node) / sensitivity(Node::ROOT)
    }

    /// About the pixel's tristimulus values.
    fn total(&mut self) -> [f64; 3] {
        if let Some(total) = self.total {
            return total;
        }
        let own = self.sum(self.terms.iter().copied(), Node::ROOT);
        let mut total = own.tristimulus(&self.shared.domain.weight(Node::ROOT));
        for group in self.groups {
            let whole = self.whole(group);
            let part = self.colour(&whole, Node::ROOT);
            total = core::array::from_fn(|a| total[a] + part[a]);
        }
        self.total = Some(total);
        total
    }

    /// Deferred light for an interval: from the widest interval around it that it changes steadily in.
    fn serve(&mut self, deferred: &Group, node: Node) -> Served {
        if node == Node::ROOT {
            let light = self.whole(deferred);
            let estimate = halves(node).map(|half| self.difference(deferred, &light, half));
            return Served { light, estimate: core::array::from_fn(|a| estimate[0][a] + estimate[1][a]) };
        }
        let mut ancestors: Vec<Node> = core::iter::successors(node.parent(), |node| node.parent()).collect();
        while let Some(wider) = ancestors.pop() {
            if self.is_steady(deferred, wider) {
                return self.interpolated(deferred, wider, node);
            }
        }
        let before = match node.parent() {
            Some(parent) if parent != Node::ROOT => self.trace(deferred, parent).clone(),
            _ => self.whole(deferred),
        };
        let estimate = self.difference(deferred, &before, node);
        Served { light: self.trace(deferred, node).clone(), estimate }
    }

    /// How far the light traced for an interval is from other light there.
    fn difference(&mut self, deferred: &Group, other: &Radiance, node: Node) -> [f64; 3] {
        let own = self.trace(deferred, node).clone();
        let [own, other] = [&own, other].map(|light| self.colour(light, node));
        core::array::from_fn(|a| (own[a] - other[a]).abs())
    }

    /// The light of an interval by the parabola of a wider one. It may be off by as much as the parabola is bent, and by half of what it changes
    /// within the interval.
    fn interpolated(&mut self, deferred: &Group, wider: Node, node: Node) -> Served {
        let at = |wavelength: f64| self.shared.parabola(wider, wavelength);
        let own = at(self.shared.band(node).wavelength);
        let [first, last] = halves(node).map(|half| at(self.shared.band(half).wavelength));
        let change: [f64; 3] = core::array::from_fn(|k| 0.5 * (last[k] - first[k]));
        let bend = self.shared.bend(wider);
        let [first, last] = halves(wider);
        let [mut light, change, bend] =
            [own, change, bend].map(|[a, b, c]| self.combined(deferred, &[(first, a), (wider, b), (last, c)]));
        light.keep_positive();
        let [change, bend] = [change, bend].map(|light| self.colour(&light, node));
        Served { light, estimate: core::array::from_fn(|a| change[a].abs() + bend[a].abs()) }
    }

    /// Whether light is on a line, near enough, at the middles of an interval and its halves. Three that differ much,
    /// as in a prism's spectrum, may be on a line by chance: then all that they differ by counts.
    fn is_steady(&mut self, deferred: &Group, node: Node) -> bool {
        if let Some(known) = self.is_steady.get(&key(deferred, node)) {
            return *known;
        }
        let [first, last] = halves(node);
        let [a, b, c] = self.shared.bend(node);
        let bend = self.combined(deferred, &[(first, a), (node, b), (last, c)]);
        let mut estimate = self.colour(&bend, node).map(f64::abs);
        let change = self.combined(deferred, &[(first, -1.0), (last, 1.0)]);
        let own = self.combined(deferred, &[(node, 1.0)]);
        let [change, own] = [&change, &own].map(|light| self.colour(light, node).map(f64::abs));
        if (0..3).any(|a| change[a] > UNEVEN * own[a]) {
            estimate = core::array::from_fn(|a| estimate[a].max(change[a]));
        }
        #[allow(clippy::cast_precision_loss, reason = "a pixel has fewer")]
        let groups = self.groups.len() as f64;
        let allowed = PATH_SHARE * self.shared.settings.threshold * self.share(node) / groups;
        let is_steady = delta_e_bound(self.total(), estimate, self.shared.white).delta_e <= allowed;
        self.is_steady.insert(key(deferred, node), is_steady);
        is_steady
    }

    /// Products of spectra on an interval.
    fn sum(&mut self, terms: impl Iterator<Item = (Term, f64)>, node: Node) -> Interval<f64> {
        let weight = self.shared.domain.weight(node);
        let monomials = self.tracer.monomials();
        let mut sum = Interval::zero();
        for (term, scale) in terms {
            let product = self.products.get(self.shared, monomials, term, node);
            sum = match self.shared.order() {
                Order::First => sum.sum_first_order(&product.scale_first_order(scale)),
                Order::Certified => sum.sum(&product.scale(scale, &weight), &weight),
            };
        }
        sum
    }

    /// Light on an interval.
    fn light(&mut self, light: &Radiance, node: Node) -> Interval<f64> {
        self.sum(light.terms().iter().map(|(monomial, weight)| ((*monomial, None), *weight)), node)
    }

    fn colour(&mut self, light: &Radiance, node: Node) -> [f64; 3] {
        self.light(light, node).tristimulus(&self.shared.domain.weight(node))
    }

    /// The total of the path estimates over a subdivision; `None` when no light is deferred.
    fn path_radius(&self, nodes: impl Iterator<Item = Node>) -> Option<[f64; 3]> {
        if self.groups.is_empty() {
            return None;
        }
        let mut total = [0.0; 3];
        for node in nodes {
            for group in self.groups {
                if let Some(radius) = self.path_radii.get(&key(group, node)) {
                    total = core::array::from_fn(|a| total[a] + radius[a]);
                }
            }
        }
        Some(total)
    }
}

impl Sources<f64> for Pixel<'_, '_> {
    fn leaf(&self, _: u32, _: Node) -> Option<&Interval<f64>> {
        None
    }

    fn deferred(&mut self, id: u32, node: Node) -> Option<Interval<f64>> {
        let place = id as usize;
        if let Some((term, _)) = self.terms.get(place) {
            return Some(self.products.get(self.shared, self.tracer.monomials(), *term, node));
        }
        let group = self.groups.get(place - self.terms.len())?;
        let Served { light, estimate } = self.serve(group, node);
        let mut light = self.light(&light, node);
        self.path_radii.insert(key(group, node), estimate);
        match self.shared.order() {
            // Without a radius of its own, the first order counts the path's error with the spectrum's.
            Order::First => {
                light.error = core::array::from_fn(|a| light.error[a] + estimate[a].copysign(light.error[a]));
            }
            Order::Certified => {
                light.radius = core::array::from_fn(|a| light.radius[a] + estimate[a]);
            }
        }
        let weight = self.shared.domain.weight(node);
        let through = self.products.get(self.shared, self.tracer.monomials(), (group.through, None), node);
        Some(match self.shared.order() {
            Order::First => light.product_first_order(&through),
            Order::Certified => light.product(&through, &weight),
        })
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
