//! Colours by adaptive intervals, with a bound.

use std::collections::HashMap;

use spectral_core::Observer;
use spectral_core::adaptive::{Mode, Piece, Status, Target, evaluate};
use spectral_core::bound::delta_e_bound;
use spectral_core::colour::rgb;
use spectral_core::expression::{Op, Order, Program, Sources};
use spectral_core::interval::{BuildError, Domain, Interval, Node, Pyramid, Weight, node_count, nodes};
use spectral_core::spectrum::{PiecewiseLinear, Spectrum};
use spectral_core::subdivision::{Stage, Subdivision};

use super::radiance::PairBuild;
use super::{Band, Colour, Deferred, Monomial, Monomials, Palette, Radiance, Resolver, Tracer, Y_INTEGRAL, normalised};

/// How deep the visible domain may be split: 2⁸ parts of 1.6 nm. Products on the deepest parts are integrated exactly.
const DEPTH: u8 = 8;
/// The most intervals of one colour.
const MAX_PIECES: usize = 512;
/// Subdivisions are recorded for colours up to this luminance, relative to white; brighter ones are evaluated afresh.
const BRIGHTEST: f64 = 64.0;
/// How many products on intervals, and how many subdivisions, each thread keeps: 10 MB, and about as much.
const MAX_KEPT: usize = 1 << 16;
const MAX_RECORDED: usize = 1 << 13;
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
}

impl<'a> SharedIntervals<'a> {
    /// Integrates all spectra of a palette.
    ///
    /// # Errors
    /// A text that says what is wrong with which leaf.
    pub fn new(
        palette: &'a Palette,
        settings: IntervalSettings,
        memory: &'a mut IntervalMemory,
    ) -> Result<Self, String> {
        let count = node_count(DEPTH);
        memory.weights.resize(count, Weight::default());
        memory.intervals.resize(palette.leaves().len(), vec![Interval::zero(); count]);
        let domain = Domain::build(Observer::cie_1931_2deg(), DEPTH, &mut memory.weights)
            .map_err(|e: BuildError| e.to_string())?;
        let (mut pyramids, mut spectra) = (Vec::new(), Vec::new());
        for ((leaf, _), buffer) in palette.leaves().iter().zip(&mut memory.intervals) {
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

/// A recorded subdivision of one monomial.
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
    recorded: HashMap<Monomial, Recorded, PairBuild>,
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
        monomial: Monomial,
        node: Node,
    ) -> Interval<f64> {
        let compute = || shared.product(monomials.leaves(monomial), node, &shared.domain.weight(node));
        if self.kept.len() >= MAX_KEPT {
            self.kept.clear();
        }
        #[allow(clippy::cast_possible_truncation, reason = "below 2¹³")]
        let place = node.position() as u32;
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
    fn scaled(&mut self, monomials: &Monomials, monomial: Monomial, scale: f64) -> Option<Colour> {
        if !self.recorded.contains_key(&monomial) {
            if self.recorded.len() >= MAX_RECORDED {
                self.recorded.clear();
            }
            let recorded = self.record(monomials, monomial);
            self.recorded.insert(monomial, recorded);
        }
        let recorded = self.recorded.get(&monomial).filter(|r| scale <= r.largest)?;
        let subdivision = Subdivision::from_stages(&recorded.stages, self.shared.white, recorded.status);
        let found = subdivision.at_scale(scale);
        Some(Colour {
            xyz: normalised(found.xyz),
            radius: normalised(found.radius),
            delta_e: found.delta_e,
            intervals: found.intervals,
            ..Colour::DARK
        })
    }

    fn record(&mut self, monomials: &Monomials, monomial: Monomial) -> Recorded {
        let shared = self.shared;
        let root = self.products.get(shared, monomials, monomial, Node::ROOT);
        let [_, luminance, _] = root.tristimulus(&shared.domain.weight(Node::ROOT));
        let largest = BRIGHTEST * shared.white[1] / luminance.abs().max(f64::MIN_POSITIVE);
        let mut stages = vec![Stage::default(); MAX_PIECES];
        let mut sources = Single { shared, monomials, monomial, products: &mut self.products };
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
    fn general(&mut self, radiance: &Radiance, tracer: &mut dyn Tracer) -> Colour {
        let shared = self.shared;
        self.ops.clear();
        let weights = radiance.terms().iter().map(|(_, w)| *w).chain(radiance.deferred().iter().map(|(_, _, w)| *w));
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
        let mut sources = Pixel::new((shared, &mut self.products), radiance, tracer);
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
        match (radiance.terms(), radiance.deferred()) {
            ([], []) => Colour { intervals: 1, ..Colour::default() },
            ([(monomial, scale)], []) => {
                let found = self.scaled(tracer.monomials(), *monomial, *scale);
                found.unwrap_or_else(|| self.general(radiance, tracer))
            }
            _ => self.general(radiance, tracer),
        }
    }
}

/// One product as the source of a program.
struct Single<'p, 'a> {
    shared: &'a SharedIntervals<'a>,
    monomials: &'p Monomials,
    monomial: Monomial,
    products: &'p mut Products,
}

impl Sources<f64> for Single<'_, '_> {
    fn leaf(&self, _: u32, _: Node) -> Option<&Interval<f64>> {
        None
    }
    fn deferred(&mut self, _: u32, node: Node) -> Option<Interval<f64>> {
        Some(self.products.get(self.shared, self.monomials, self.monomial, node))
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
    radiance: &'p Radiance,
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

/// What is known of deferred light on intervals.
type ByNode<T> = HashMap<(u32, u32), T, PairBuild>;

#[allow(clippy::cast_possible_truncation, reason = "below 2¹³")]
const fn key(deferred: Deferred, node: Node) -> (u32, u32) {
    (deferred.0, node.position() as u32)
}

/// Deferred light on an interval, and what its tristimulus values may be off by.
struct Served {
    light: Radiance,
    estimate: [f64; 3],
}

impl<'p, 'a> Pixel<'p, 'a> {
    fn new(
        (shared, products): (&'a SharedIntervals<'a>, &'p mut Products),
        radiance: &'p Radiance,
        tracer: &'p mut dyn Tracer,
    ) -> Self {
        let (traced, is_steady, path_radii) = (ByNode::default(), ByNode::default(), ByNode::default());
        Self { shared, radiance, tracer, products, traced, is_steady, path_radii, total: None }
    }

    /// Deferred light traced for the middle wavelength of an interval, once.
    fn trace(&mut self, deferred: Deferred, node: Node) -> &Radiance {
        let (tracer, shared) = (&mut self.tracer, self.shared);
        self.traced.entry(key(deferred, node)).or_insert_with(|| tracer.trace(deferred, shared.band(node)))
    }

    /// A sum of traced light.
    fn combined(&mut self, deferred: Deferred, parts: &[(Node, f64)]) -> Radiance {
        let mut sum = Radiance::default();
        for (node, share) in parts {
            for (monomial, weight) in self.trace(deferred, *node).terms() {
                sum.add(*monomial, share * weight);
            }
        }
        sum
    }

    /// The light of the whole domain: that of its halves, by their parts of the eye's sensitivity.
    fn whole(&mut self, deferred: Deferred) -> Radiance {
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
        let radiance = self.radiance;
        let mut total = self.colour(radiance, Node::ROOT);
        for (deferred, _, scale) in radiance.deferred() {
            let whole = self.whole(*deferred);
            let part = self.colour(&whole, Node::ROOT);
            total = core::array::from_fn(|a| total[a] + scale * part[a]);
        }
        self.total = Some(total);
        total
    }

    /// Deferred light, which counts for so much, for an interval: from the widest interval around it that it changes steadily in.
    fn serve(&mut self, deferred: Deferred, node: Node, scale: f64) -> Served {
        if node == Node::ROOT {
            let light = self.whole(deferred);
            let estimate = halves(node).map(|half| self.difference(deferred, &light, half));
            return Served { light, estimate: core::array::from_fn(|a| estimate[0][a] + estimate[1][a]) };
        }
        let mut ancestors: Vec<Node> = core::iter::successors(node.parent(), |node| node.parent()).collect();
        while let Some(wider) = ancestors.pop() {
            if self.is_steady(deferred, wider, scale) {
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
    fn difference(&mut self, deferred: Deferred, other: &Radiance, node: Node) -> [f64; 3] {
        let own = self.trace(deferred, node).clone();
        let [own, other] = [&own, other].map(|light| self.colour(light, node));
        core::array::from_fn(|a| (own[a] - other[a]).abs())
    }

    /// The light of an interval by the parabola of a wider one. It may be off by as much as the parabola is bent, and by half of what it changes
    /// within the interval.
    fn interpolated(&mut self, deferred: Deferred, wider: Node, node: Node) -> Served {
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

    /// Whether light that counts for so much is on a line, near enough, at the middles of an interval and its halves. Three that differ much,
    /// as in a prism's spectrum, may be on a line by chance: then all that they differ by counts.
    fn is_steady(&mut self, deferred: Deferred, node: Node, scale: f64) -> bool {
        if let Some(known) = self.is_steady.get(&key(deferred, node)) {
            return *known;
        }
        let [first, last] = halves(node);
        let [a, b, c] = self.shared.bend(node);
        let bend = self.combined(deferred, &[(first, a), (node, b), (last, c)]);
        let mut estimate = self.colour(&bend, node).map(|e| (e * scale).abs());
        let change = self.combined(deferred, &[(first, -1.0), (last, 1.0)]);
        let own = self.combined(deferred, &[(node, 1.0)]);
        let [change, own] = [&change, &own].map(|light| self.colour(light, node).map(|e| (e * scale).abs()));
        if (0..3).any(|a| change[a] > UNEVEN * own[a]) {
            estimate = core::array::from_fn(|a| estimate[a].max(change[a]));
        }
        #[allow(clippy::cast_precision_loss, reason = "a pixel has fewer")]
        let paths = self.radiance.deferred().len() as f64;
        let allowed = PATH_SHARE * self.shared.settings.threshold * self.share(node) / paths;
        let is_steady = delta_e_bound(self.total(), estimate, self.shared.white).delta_e <= allowed;
        self.is_steady.insert(key(deferred, node), is_steady);
        is_steady
    }

    /// Products of spectra on an interval.
    fn sum(&mut self, light: &Radiance, node: Node) -> Interval<f64> {
        let weight = self.shared.domain.weight(node);
        let monomials = self.tracer.monomials();
        let mut sum = Interval::zero();
        for (monomial, scale) in light.terms() {
            let product = self.products.get(self.shared, monomials, *monomial, node);
            sum = match self.shared.order() {
                Order::First => sum.sum_first_order(&product.scale_first_order(*scale)),
                Order::Certified => sum.sum(&product.scale(*scale, &weight), &weight),
            };
        }
        sum
    }

    fn colour(&mut self, light: &Radiance, node: Node) -> [f64; 3] {
        let weight = self.shared.domain.weight(node);
        self.sum(light, node).tristimulus(&weight)
    }

    /// The total of the path estimates over a subdivision; `None` when no light is deferred.
    fn path_radius(&self, nodes: impl Iterator<Item = Node>) -> Option<[f64; 3]> {
        if self.radiance.deferred().is_empty() {
            return None;
        }
        let mut total = [0.0; 3];
        for node in nodes {
            for (deferred, _, weight) in self.radiance.deferred() {
                if let Some(radius) = self.path_radii.get(&key(*deferred, node)) {
                    total = core::array::from_fn(|a| total[a] + weight * radius[a]);
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
        if let Some((monomial, _)) = self.radiance.terms().get(place) {
            return Some(self.products.get(self.shared, self.tracer.monomials(), *monomial, node));
        }
        let (deferred, monomial, scale) = *self.radiance.deferred().get(place - self.radiance.terms().len())?;
        let Served { light, estimate } = self.serve(deferred, node, scale);
        let mut light = self.sum(&light, node);
        self.path_radii.insert(key(deferred, node), estimate);
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
        let through = self.products.get(self.shared, self.tracer.monomials(), monomial, node);
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

/// What paths change with, about in proportion: Cauchy's index does.
fn measure(wavelength: f64) -> f64 {
    1.0 / (wavelength * wavelength)
}
