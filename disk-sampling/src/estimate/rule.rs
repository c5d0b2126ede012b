//! Nested quadrature on [−1, 1]: Gauss's rule of 3 points within Kronrod's of 7 within Patterson's of 15.

use spectral_core::Real;

/// The finest level.
pub(super) const FINEST: usize = 2;

/// How many nodes there are up to each level. Nodes are numbered in the order in which levels add them.
const COUNT: [usize; 3] = [3, 7, 15];

/// Each node not right of the middle with its weights at the three levels, in the order in which levels add them
/// (Patterson 1968, "The optimum addition of points to quadrature formulae"): exact for polynomials of degree 5, 11 and
/// 23.
const NODES: [(f64, [f64; 3]); 8] = [
    (0.0, [8.0 / 9.0, 0.450_916_538_658_474_14, 0.225_510_499_798_206_7]),
    (-0.774_596_669_241_483_4, [5.0 / 9.0, 0.268_488_089_868_333_45, 0.134_415_255_243_784_22]),
    (-0.960_491_268_708_020_3, [0.0, 0.104_656_226_026_467_27, 0.051_603_282_997_079_74]),
    (-0.434_243_749_346_802_57, [0.0, 0.401_397_414_775_962_2, 0.200_628_529_376_989_02]),
    (-0.993_831_963_212_755, [0.0, 0.0, 0.017_001_719_629_940_26]),
    (-0.888_459_232_872_257, [0.0, 0.0, 0.092_927_195_315_124_54]),
    (-0.621_102_946_737_226_4, [0.0, 0.0, 0.171_511_909_136_391_4]),
    (-0.223_386_686_428_966_9, [0.0, 0.0, 0.219_156_858_401_587_5]),
];

/// The numbers of the nodes that a level adds. The first level's are the left one, the middle and the right one.
pub(super) fn added(level: usize) -> core::ops::Range<usize> {
    let count = |level: usize| COUNT.get(level).copied().unwrap_or_default();
    level.checked_sub(1).map_or(0, count)..count(level)
}

/// A node by its number, and its weights at the three levels.
pub(super) fn node<R: Real>(number: usize) -> (R, [R; 3]) {
    let weights = NODES.get(row(number)).map_or([0.0; 3], |node| node.1);
    (R::from_f64(place(number)), weights.map(R::from_f64))
}

/// Where a node is; 0, 1, 2 are left, middle, right, then come pairs.
fn place(number: usize) -> f64 {
    let place = NODES.get(row(number)).map_or(0.0, |node| node.0);
    if number > 0 && number.is_multiple_of(2) { -place } else { place }
}

const fn row(number: usize) -> usize {
    match number {
        1 => 0,
        0 | 2 => 1,
        n if n < NODES_ALL => n.div_ceil(2),
        _ => 0,
    }
}

/// Light as sampled: with visibility, and what it is compared with.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Light<R> {
    pub(super) lit: R,
    pub(super) full: R,
}

impl<R: Real> Light<R> {
    pub(super) fn add(&mut self, other: Self, weight: R) {
        self.lit += weight * other.lit;
        self.full += weight * other.full;
    }

    pub(super) fn scaled(self, factor: R) -> Self {
        Self { lit: self.lit * factor, full: self.full * factor }
    }

    /// lit − ratio · full, the part that is not proportional.
    pub(super) fn excess(self, ratio: R) -> R {
        self.lit - ratio * self.full
    }

    /// lit / full; 0 where there is no light.
    pub(super) fn ratio(self) -> R {
        if self.full > R::ZERO { self.lit / self.full } else { R::ZERO }
    }
}

/// The number of nodes of the finest level.
pub(super) const NODES_ALL: usize = 15;

/// A nested rule for light times a measure whose density is cheap: the density is taken at the nodes of finer levels
/// than light is.
///
/// The integral of light is that of the polynomial through its samples times the measure (product integration): exact
/// for polynomials however uneven the measure is, as far as the finer level integrates it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Nested<R> {
    /// The level that light is known to, and the one that the density is known to.
    pub(super) level: usize,
    density_level: usize,
    nodes: [Node<R>; NODES_ALL],
    /// What follows from the nodes.
    summary: Summary<R>,
}

/// What is known at a node.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Node<R> {
    pub(super) density: R,
    /// The variable that light is smooth in.
    pub(super) place: R,
    /// Two functions that light is likely to vary like.
    pub(super) guides: [R; 2],
    light: Light<R>,
}

impl<R: Real> Node<R> {
    pub(super) fn new(density: R, place: R, guides: [R; 2]) -> Self {
        Self { density, place, guides, light: Light::default() }
    }
}

#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Summary<R> {
    measure: R,
    /// Integrals of light: by the middle alone, and by each level up to the present one.
    integrals: [Light<R>; 4],
    /// Means of lit², lit · full and full² over the present level's nodes.
    squares: [R; 3],
    /// How far the present level is off for the guides, over their variation as the nodes show it.
    guide_error: R,
}

impl<R: Real> Nested<R> {
    /// Adds what is known without light at the nodes of all levels up to one.
    pub(super) fn measure_to(&mut self, level: usize, mut at: impl FnMut(R) -> Node<R>) {
        let known = if self.summary.measure > R::ZERO { COUNT.get(self.density_level).copied() } else { None };
        let count = COUNT.get(level).copied().unwrap_or_default();
        for (number, slot) in self.nodes.iter_mut().enumerate().take(count).skip(known.unwrap_or_default()) {
            *slot = at(node::<R>(number).0);
        }
        self.density_level = level;
        self.summary.measure = self.measure_at(level);
    }

    /// Sets the light of the present level's nodes.
    pub(super) fn set_light(&mut self, number: usize, light: Light<R>) {
        if let Some(slot) = self.nodes.get_mut(number) {
            slot.light = light;
        }
    }

    /// The light of a node.
    pub(super) fn light(&self, number: usize) -> Light<R> {
        self.nodes.get(number).map_or(Light::default(), |node| node.light)
    }

    /// Works out what follows from the present level's light; to be called when all of it is set.
    pub(super) fn summarise(&mut self) {
        let measure = self.measure_at(self.density_level);
        if !(measure > R::ZERO && measure.is_finite()) {
            self.summary = Summary::default();
            return;
        }
        let middle = self.nodes.get(1).copied().unwrap_or_default().light.scaled(measure);
        let mut integrals = [middle; 4];
        let mut weights = [R::ZERO; NODES_ALL];
        for (level, integral) in integrals.iter_mut().skip(1).enumerate().take(self.level + 1) {
            weights = self.weights(level);
            *integral = Light::default();
            for (node, weight) in self.nodes.iter().zip(weights) {
                integral.add(node.light, weight);
            }
        }
        let squares = [
            self.mean_at_nodes(|node| node.light.lit * node.light.lit),
            self.mean_at_nodes(|node| node.light.lit * node.light.full),
            self.mean_at_nodes(|node| node.light.full * node.light.full),
        ];
        let own = (self.measure_at(self.level) / measure - R::ONE).abs();
        let guide_error = own.max(self.guide_error(&weights, 0)).max(self.guide_error(&weights, 1));
        self.summary = Summary { measure, integrals, squares, guide_error };
    }

    /// ∫ dμ over the interval's half.
    pub(super) fn measure(&self) -> R {
        self.summary.measure
    }

    /// The same by any level up to that of the density.
    pub(super) fn measure_at(&self, level: usize) -> R {
        self.masses(level).fold(R::ZERO, |sum, (mass, _)| sum + mass)
    }

    /// Weight times density, and the node, for the nodes of a level.
    fn masses(&self, level: usize) -> impl Iterator<Item = (R, &Node<R>)> {
        let count = COUNT.get(level).copied().unwrap_or_default();
        self.nodes.iter().take(count).enumerate().map(move |(number, at)| {
            let (_, weights) = node::<R>(number);
            (weights.get(level).copied().unwrap_or_default() * at.density, at)
        })
    }

    /// The weights by which light's samples at a level give ∫ light dμ over the interval's half.
    fn weights(&self, level: usize) -> [R; NODES_ALL] {
        let mut weights = [R::ZERO; NODES_ALL];
        let coarse = COUNT.get(level).copied().unwrap_or_default();
        let basis = self.nodes.get(..coarse).unwrap_or_default();
        // Each basis polynomial over its value at its own node.
        let mut own = [R::ONE; NODES_ALL];
        for (index, (node, product)) in basis.iter().zip(&mut own).enumerate() {
            for (other, at) in basis.iter().enumerate() {
                if other != index {
                    *product *= node.place - at.place;
                }
            }
        }
        for (number, (mass, at)) in self.masses(self.density_level).enumerate() {
            if let Some(slot) = weights.get_mut(number).filter(|_| number < coarse) {
                *slot += mass;
                continue;
            }
            let all = basis.iter().fold(mass, |product, node| product * (at.place - node.place));
            for ((node, own), slot) in basis.iter().zip(own).zip(&mut weights) {
                *slot += all / ((at.place - node.place) * own);
            }
        }
        weights
    }

    /// The mean of something over the present level's nodes, by their own masses.
    fn mean_at_nodes(&self, of: impl Fn(&Node<R>) -> R) -> R {
        let (mut sum, mut total) = (R::ZERO, R::ZERO);
        for (mass, node) in self.masses(self.level) {
            sum += mass * of(node);
            total += mass;
        }
        if total > R::ZERO { sum / total } else { R::ZERO }
    }

    /// How far the mean of a guide by these weights is off, over its variation at the present level's nodes.
    fn guide_error(&self, weights: &[R; NODES_ALL], guide: usize) -> R {
        let middle = self.nodes.get(1).copied().unwrap_or_default();
        let value = |node: &Node<R>| {
            node.guides.get(guide).copied().unwrap_or_default() - middle.guides.get(guide).copied().unwrap_or_default()
        };
        let fine = self.masses(self.density_level).fold(R::ZERO, |sum, (mass, node)| sum + mass * value(node));
        let coarse = self.nodes.iter().zip(weights).fold(R::ZERO, |sum, (node, weight)| sum + *weight * value(node));
        let mean = self.mean_at_nodes(value);
        let spread = self.mean_at_nodes(|node| (value(node) - mean) * (value(node) - mean)).max(R::ZERO).sqrt();
        let error = (coarse - fine).abs() / (self.measure_at(self.density_level) * spread);
        if spread > R::ZERO && error.is_finite() { error } else { R::ZERO }
    }

    /// ∫ light dμ over the interval's half.
    pub(super) fn integral(&self) -> Light<R> {
        self.integral_before(0)
    }

    /// The same by the level `steps` below the present one, down to the middle alone.
    fn integral_before(&self, steps: usize) -> Light<R> {
        let index = (self.level + 1).saturating_sub(steps);
        self.summary.integrals.get(index).copied().unwrap_or_default()
    }

    /// How much the excess of light over `ratio` times the full light varies: root of the mean square, times the
    /// measure.
    fn spread(&self, ratio: R) -> R {
        let [ll, lf, ff] = self.summary.squares;
        (ll - R::TWO * ratio * lf + ratio * ratio * ff).max(R::ZERO).sqrt() * self.measure()
    }

    /// How far the integral's excess over `ratio` times the full light may be off. `mismatch` is how far the measure
    /// may be off, relatively; where visibility is mixed, light is less smooth.
    ///
    /// The last change from level to level, times how fast the changes have fallen. The coarsest level has no earlier
    /// change to show for itself: there, it is also at least half the square of the relative variation. To that comes
    /// the variation of light times how far the rule is off for functions of known mean: 1, and the guides.
    pub(super) fn error(&self, ratio: R, mismatch: R, is_mixed: bool) -> R {
        let present = self.integral();
        let size = present.lit.max(ratio * present.full);
        let spread = self.spread(ratio);
        // Sums of squares lose half of the digits.
        let last = self.last_change(ratio);
        if spread <= R::from_f64(4.0) * R::EPSILON.sqrt() * size && last <= R::from_f64(64.0) * R::EPSILON * size {
            return R::ZERO;
        }
        let floor = R::from_f64(if is_mixed { 0.5 } else { 0.1 });
        let error = if self.level == 0 {
            // What is so small that it underflows may be all wrong.
            let relative = if size > spread { spread / size } else { R::ONE };
            reduced(last, size, floor).max(R::HALF * spread * relative.max(R::from_f64(0.4)))
        } else {
            let before = self.integral_before(1).excess(ratio) - self.integral_before(2).excess(ratio);
            reduced(last, before.abs(), floor)
        };
        error + spread * mismatch.max(self.summary.guide_error)
    }

    fn last_change(&self, ratio: R) -> R {
        (self.integral().excess(ratio) - self.integral_before(1).excess(ratio)).abs()
    }

    /// Whether the changes fall so fast that a finer level is worth more than two halves.
    pub(super) fn is_smooth(&self, ratio: R) -> bool {
        if self.level == 0 || self.level == FINEST {
            return self.level == 0;
        }
        let before = (self.integral_before(1).excess(ratio) - self.integral_before(2).excess(ratio)).abs();
        self.last_change(ratio) <= R::from_f64(0.3) * before.max(R::from_f64(0.1) * self.spread(ratio))
    }
}

/// What is left of a change after another one, not less than a given share of it.
fn reduced<R: Real>(last: R, before: R, floor: R) -> R {
    if before > R::ZERO { last * (R::TWO * last / before).clamp(floor, R::ONE) } else { last }
}
