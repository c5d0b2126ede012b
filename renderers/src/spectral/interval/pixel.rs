//! A pixel's light as the sources of a program: products, light on lines, and what is traced for intervals.

use alloc::rc::Rc;
use std::collections::HashMap;

use spectral_core::bound::delta_e_bound;
use spectral_core::expression::{Order, Sources};
use spectral_core::interval::{Interval, Node};

use super::super::hats::{Hat, Lines, STEPS};
use super::super::{Deferred, Monomial, PairBuild, Radiance, Tracer};
use super::{Products, SharedIntervals, Term, halves};

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
pub(super) struct Pixel<'p, 'a> {
    shared: &'a SharedIntervals<'a>,
    terms: &'p [(Term, f64)],
    groups: &'p [Group],
    tracer: &'p mut dyn Tracer,
    products: &'p mut Products,
    /// Light that was traced for the middle wavelengths of intervals.
    traced: ByNode<Rc<Radiance>>,
    /// That of the whole domain, as its halves have it.
    wholes: ByNode<Rc<Radiance>>,
    /// The same with that of the halves.
    threes: ByNode<Rc<Three>>,
    /// Whether light for the parts of an interval can be interpolated between that of itself and its halves.
    is_steady: ByNode<bool>,
    /// How far the interval's tristimulus values may be off by the path that was traced.
    path_radii: ByNode<[f64; 3]>,
    /// About the pixel's tristimulus values, once they have been asked for.
    total: Option<[f64; 3]>,
}

/// Deferred light that is seen through the same product of spectra, each with what it is multiplied by: it is taken together, as parts of it may
/// change where their sum doesn't.
pub(super) struct Group {
    number: u32,
    through: Monomial,
    parts: Vec<(Deferred, f64)>,
}

/// A pixel's products, those of lines among them, and the groups of the rest of its deferred light.
pub(super) fn parts(radiance: &Radiance, tracer: &mut dyn Tracer) -> (Vec<(Term, f64)>, Vec<Group>) {
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

/// Three lights: products of spectra, each with what it counts for in each of them.
type Three = [(Monomial, [f64; 3])];

/// What is known of groups of deferred light on intervals.
type ByNode<T> = HashMap<(u32, u32), T, PairBuild>;

#[allow(clippy::cast_possible_truncation, reason = "below 2¹³")]
const fn key(group: &Group, node: Node) -> (u32, u32) {
    (group.number, node.position() as u32)
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

impl<'p, 'a> Pixel<'p, 'a> {
    pub(super) fn new(
        (shared, products): (&'a SharedIntervals<'a>, &'p mut Products),
        (terms, groups): (&'p [(Term, f64)], &'p [Group]),
        tracer: &'p mut dyn Tracer,
    ) -> Self {
        Self {
            shared,
            terms,
            groups,
            tracer,
            products,
            traced: ByNode::default(),
            wholes: ByNode::default(),
            threes: ByNode::default(),
            is_steady: ByNode::default(),
            path_radii: ByNode::default(),
            total: None,
        }
    }

    /// Deferred light traced for the middle wavelength of an interval, once.
    fn trace(&mut self, deferred: &Group, node: Node) -> Rc<Radiance> {
        let (tracer, shared) = (&mut self.tracer, self.shared);
        let traced = self.traced.entry(key(deferred, node)).or_insert_with(|| {
            let mut sum = Radiance::default();
            for (deferred, scale) in &deferred.parts {
                for (monomial, weight) in tracer.trace(*deferred, shared.band(node)).terms() {
                    sum.add(*monomial, scale * weight);
                }
            }
            sum.into()
        });
        Rc::clone(traced)
    }

    /// The light of the whole domain: that of its halves, by their parts of the eye's sensitivity.
    fn whole(&mut self, deferred: &Group) -> Rc<Radiance> {
        let key = key(deferred, Node::ROOT);
        if let Some(known) = self.wholes.get(&key) {
            return Rc::clone(known);
        }
        // What is found for all waves may do for some of them.
        self.trace(deferred, Node::ROOT);
        let mut sum = Radiance::default();
        for half in halves(Node::ROOT) {
            let share = self.share(half);
            for (monomial, weight) in self.trace(deferred, half).terms() {
                sum.add(*monomial, share * weight);
            }
        }
        Rc::clone(self.wholes.entry(key).or_insert(sum.into()))
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

    /// Deferred light for an interval, and what its tristimulus values may be off by: from the widest interval around it that it changes steadily in.
    fn serve(&mut self, deferred: &Group, node: Node) -> (Interval<f64>, [f64; 3]) {
        if node == Node::ROOT {
            let light = self.whole(deferred);
            let estimate = halves(node).map(|half| self.difference(deferred, &light, half));
            return (self.light(&light, node), core::array::from_fn(|a| estimate[0][a] + estimate[1][a]));
        }
        if let Some(wider) = self.steady_around(deferred, node) {
            return self.interpolated(deferred, wider, node);
        }
        let before = match node.parent() {
            Some(parent) if parent != Node::ROOT => self.trace(deferred, parent),
            _ => self.whole(deferred),
        };
        let estimate = self.difference(deferred, &before, node);
        let own = self.trace(deferred, node);
        (self.light(&own, node), estimate)
    }

    /// The widest interval around another that light changes steadily in.
    fn steady_around(&mut self, deferred: &Group, node: Node) -> Option<Node> {
        let parent = node.parent()?;
        self.steady_around(deferred, parent).or_else(|| self.is_steady(deferred, parent).then_some(parent))
    }

    /// How far the light traced for an interval is from other light there.
    fn difference(&mut self, deferred: &Group, other: &Radiance, node: Node) -> [f64; 3] {
        let own = self.trace(deferred, node);
        let [own, other] = [&*own, other].map(|light| self.colour(light, node));
        core::array::from_fn(|a| (own[a] - other[a]).abs())
    }

    /// Light traced for the middles of an interval's first half, of itself and of its last half: what each product counts for.
    fn three(&mut self, deferred: &Group, node: Node) -> Rc<Three> {
        if let Some(known) = self.threes.get(&key(deferred, node)) {
            return Rc::clone(known);
        }
        let [first, last] = halves(node);
        let mut terms: Vec<(Monomial, [f64; 3])> = Vec::new();
        for (place, node) in [first, node, last].into_iter().enumerate() {
            for (monomial, weight) in self.trace(deferred, node).terms() {
                match terms.iter_mut().find(|(known, _)| known == monomial) {
                    Some((_, weights)) => weights[place] = *weight,
                    None => {
                        let weights = core::array::from_fn(|i| if i == place { *weight } else { 0.0 });
                        terms.push((*monomial, weights));
                    }
                }
            }
        }
        Rc::clone(self.threes.entry(key(deferred, node)).or_insert(terms.into()))
    }

    /// The light of an interval by the parabola of a wider one. It may be off by as much as the parabola is bent, and by half of what it changes
    /// within the interval.
    fn interpolated(&mut self, deferred: &Group, wider: Node, node: Node) -> (Interval<f64>, [f64; 3]) {
        let at = |wavelength: f64| self.shared.parabola(wider, wavelength);
        let own = at(self.shared.band(node).wavelength);
        let [first, last] = halves(node).map(|half| at(self.shared.band(half).wavelength));
        let change: [f64; 3] = core::array::from_fn(|k| 0.5 * (last[k] - first[k]));
        let bend = self.shared.bend(wider);
        let three = self.three(deferred, wider);
        let terms = three.iter().map(|(monomial, weights)| ((*monomial, None), dot(own, *weights)));
        // Extrapolated, light may be negative.
        let light = self.sum(terms.filter(|(_, weight)| *weight > 0.0), node);
        let [change, bend] = self.colours(&three, [change, bend], node);
        (light, core::array::from_fn(|a| change[a].abs() + bend[a].abs()))
    }

    /// Colours on an interval of sums of three lights.
    fn colours<const N: usize>(&mut self, three: &Three, sums: [[f64; 3]; N], node: Node) -> [[f64; 3]; N] {
        let weight = self.shared.domain.weight(node);
        let mut colours = [[0.0; 3]; N];
        for (monomial, weights) in three {
            let product = self.products.get(self.shared, self.tracer.monomials(), (*monomial, None), node);
            let xyz = product.tristimulus(&weight);
            for (colour, sum) in colours.iter_mut().zip(sums) {
                let times = dot(sum, *weights);
                *colour = core::array::from_fn(|a| colour[a] + times * xyz[a]);
            }
        }
        colours
    }

    /// Whether light is on a line, near enough, at the middles of an interval and its halves. Three that differ much,
    /// as in a prism's spectrum, may be on a line by chance: then all that they differ by counts.
    fn is_steady(&mut self, deferred: &Group, node: Node) -> bool {
        if let Some(known) = self.is_steady.get(&key(deferred, node)) {
            return *known;
        }
        let three = self.three(deferred, node);
        let sums = [self.shared.bend(node), [-1.0, 0.0, 1.0], [0.0, 1.0, 0.0]];
        let [mut estimate, change, own] = self.colours(&three, sums, node).map(|colour| colour.map(f64::abs));
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
    pub(super) fn path_radius(&self, nodes: impl Iterator<Item = Node>) -> Option<[f64; 3]> {
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
        let (mut light, estimate) = self.serve(group, node);
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
