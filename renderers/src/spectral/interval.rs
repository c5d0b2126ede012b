//! Colours by adaptive intervals, with a bound.

use std::collections::HashMap;

use spectral_core::Observer;
use spectral_core::adaptive::{Mode, Piece, Status, Target, evaluate};
use spectral_core::bound::delta_e_bound;
use spectral_core::colour::rgb;
use spectral_core::expression::{Op, Order, Program, Sources};
use spectral_core::interval::{BuildError, Domain, Interval, Node, Pyramid, Weight, node_count};
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
    /// The ΔE*ab to reach in each pixel, relative to the white of Rec. 709 at Y = 1.
    pub threshold: f64,
}

impl Default for IntervalSettings {
    fn default() -> Self {
        Self { mode: Mode::Certified, threshold: 1.0 }
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
        Ok(Self { domain, pyramids, spectra, settings, white: rgb::WHITE.map(|w| w * Y_INTEGRAL) })
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
        let mut sources = Pixel { shared, radiance, tracer, products: &mut self.products, traced: HashMap::new() };
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

/// A pixel's radiance as the sources of a program: first its products, then its deferred light.
struct Pixel<'p, 'a> {
    shared: &'a SharedIntervals<'a>,
    radiance: &'p Radiance,
    tracer: &'p mut dyn Tracer,
    products: &'p mut Products,
    traced: HashMap<(Deferred, Node), Traced>,
}

/// Deferred light traced for one interval.
struct Traced {
    radiance: Radiance,
    /// How far its path may put the interval's tristimulus values off, estimated; `None` while it has not been asked for.
    path_radius: Option<[f64; 3]>,
}

impl Pixel<'_, '_> {
    /// Traces deferred light for an interval, once.
    fn trace(&mut self, deferred: Deferred, node: Node) {
        if !self.traced.contains_key(&(deferred, node)) {
            let radiance = self.tracer.trace(deferred, band(&self.shared.domain, node));
            self.traced.insert((deferred, node), Traced { radiance, path_radius: None });
        }
    }

    /// Light that was traced for one interval, on that or another interval.
    fn traced_on(&mut self, deferred: Deferred, traced_for: Node, node: Node) -> Interval<f64> {
        self.trace(deferred, traced_for);
        let weight = self.shared.domain.weight(node);
        let monomials = self.tracer.monomials();
        let mut sum = Interval::zero();
        if let Some(traced) = self.traced.get(&(deferred, traced_for)) {
            for (monomial, scale) in traced.radiance.terms() {
                let product = self.products.get(self.shared, monomials, *monomial, node);
                sum = match self.shared.order() {
                    Order::First => sum.sum_first_order(&product.scale_first_order(*scale)),
                    Order::Certified => sum.sum(&product.scale(*scale, &weight), &weight),
                };
            }
        }
        sum
    }

    fn colour(&mut self, deferred: Deferred, traced_for: Node, node: Node) -> [f64; 3] {
        let weight = self.shared.domain.weight(node);
        self.traced_on(deferred, traced_for, node).tristimulus(&weight)
    }

    /// How far the path traced for an interval may be off for the waves in it: the change that the last halving made, or
    /// for the whole domain the change that the next one would make.
    fn path_estimate(&mut self, deferred: Deferred, node: Node) -> [f64; 3] {
        let own = self.colour(deferred, node, node);
        let other = if let Some(parent) = node.parent() {
            self.colour(deferred, parent, node)
        } else {
            let mut sum = [0.0; 3];
            for half in node.children().into_iter().flatten() {
                let part = self.colour(deferred, half, half);
                sum = core::array::from_fn(|a| sum[a] + part[a]);
            }
            sum
        };
        core::array::from_fn(|a| (own[a] - other[a]).abs())
    }

    /// The total of the path estimates over a subdivision; `None` when no light is deferred.
    fn path_radius(&self, nodes: impl Iterator<Item = Node>) -> Option<[f64; 3]> {
        if self.radiance.deferred().is_empty() {
            return None;
        }
        let mut total = [0.0; 3];
        for node in nodes {
            for (deferred, _, weight) in self.radiance.deferred() {
                if let Some(radius) = self.traced.get(&(*deferred, node)).and_then(|t| t.path_radius) {
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
        let (deferred, monomial, _) = *self.radiance.deferred().get(place - self.radiance.terms().len())?;
        let mut light = self.traced_on(deferred, node, node);
        let estimate = self.path_estimate(deferred, node);
        if let Some(traced) = self.traced.get_mut(&(deferred, node)) {
            traced.path_radius = Some(estimate);
        }
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
