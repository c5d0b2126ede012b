//! Adaptive evaluation of a rendering expression: the visible domain is split where the colour error is, until a
//! perceptual bound is met (Iehl–Péroche appendix A.1, A.2).

use crate::Real;
use crate::bound::{ColourBound, delta_e_bound};
use crate::expression::{ExpressionError, Order, Program, Sources};
use crate::interval::{Domain, Interval, Node, Weight};
use crate::threshold_table::ThresholdTable;

/// How an interval's tristimulus values and their error are taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mode {
    /// Iehl and Péroche: value m I, error |e|; a product's ∫(S₁−m₁)(S₂−m₂) ā is dropped, so that the bound may be broken.
    Paper,
    /// Value m I + e, refined as in `Paper`: the first-order error is known, so it is used. The bound is the same estimate.
    Corrected,
    /// Value m I + e with the second-order term and a radius that holds: the bound is one.
    Certified,
}

impl Mode {
    /// The operators that the mode needs.
    pub const fn order(self) -> Order {
        match self {
            Self::Paper | Self::Corrected => Order::First,
            Self::Certified => Order::Certified,
        }
    }

    /// An interval's contribution to the colour and to its radius.
    #[inline]
    fn contribution<R: Real>(self, interval: &Interval<R>, weight: &Weight<R>) -> ([R; 3], [R; 3]) {
        match self {
            Self::Paper => (interval.mean_tristimulus(weight), interval.error.map(R::abs)),
            Self::Corrected => (interval.tristimulus(weight), interval.error.map(R::abs)),
            Self::Certified => (interval.tristimulus(weight), interval.radius),
        }
    }
}

/// What an evaluation aims at.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Target<R> {
    /// How errors are taken.
    pub mode: Mode,
    /// The ΔE*ab to reach.
    pub threshold: R,
    /// The tristimulus values ∫Wā of the white point, in the expression's unit times nm.
    pub white: [R; 3],
}

/// One part of the visible domain with its contribution to the colour.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Piece<R> {
    /// The part.
    pub node: Node,
    /// Its contribution to ∫Sā.
    pub xyz: [R; 3],
    /// How far off that contribution may be.
    pub radius: [R; 3],
}

/// How an evaluation ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Status {
    /// The bound is at or under the threshold.
    Reached,
    /// All that is worth splitting is at the deepest level; the bound holds but is above the threshold.
    DepthExhausted,
    /// The buffer for pieces is full; the bound holds but is above the threshold.
    PiecesExhausted,
}

/// The result of an adaptive evaluation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Evaluation<R> {
    /// The tristimulus values ∫Sā, in the expression's unit times nm.
    pub xyz: [R; 3],
    /// How far each may be off: certain in [`Mode::Certified`], an estimate otherwise.
    pub radius: [R; 3],
    /// The largest ΔE*ab within that radius.
    pub delta_e: R,
    /// How many intervals the visible domain was split into.
    pub intervals: usize,
    /// Whether the threshold was met.
    pub status: Status,
}

/// A colour with its radius, summed over the pieces.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Total<R> {
    pub(crate) xyz: [R; 3],
    pub(crate) radius: [R; 3],
}

/// The total over all pieces; the radius covers the rounding of the sum.
fn total<R: Real>(pieces: &[Piece<R>]) -> Total<R> {
    let mut xyz = [R::ZERO; 3];
    let mut radius = [R::ZERO; 3];
    let mut size = [R::ZERO; 3];
    for piece in pieces {
        for a in 0..3 {
            xyz[a] += piece.xyz[a];
            radius[a] += piece.radius[a];
            size[a] += piece.xyz[a].abs();
        }
    }
    let terms = R::from_usize(pieces.len() + 2) * R::EPSILON;
    for a in 0..3 {
        radius[a] = radius[a] * (R::ONE + terms) + size[a] * terms;
    }
    Total { xyz, radius }
}

/// What to do next with the pieces.
enum Step {
    Split(usize),
    Stop(Status),
}

/// The piece that contributes most to the bound, if splitting it can still help.
///
/// `met` tells whether a radius meets the threshold: once the pieces at the deepest level alone exceed it and the others count
/// for less than a quarter of them, more pieces would not be worth their cost.
fn choose<R: Real>(pieces: &[Piece<R>], gradient: [R; 3], depth: u8, room: bool, met: impl Fn([R; 3]) -> bool) -> Step {
    let mut best = None;
    let mut most = R::ZERO;
    let (mut fixed, mut free) = (R::ZERO, R::ZERO);
    let mut fixed_radius = [R::ZERO; 3];
    for (place, piece) in pieces.iter().enumerate() {
        let score = dot(gradient, piece.radius);
        if piece.node.level() >= depth {
            fixed += score;
            fixed_radius = core::array::from_fn(|a| fixed_radius[a] + piece.radius[a]);
            continue;
        }
        free += score;
        // A score that is not a number comes of an overflow: such a piece is split first.
        if score > most || (score.is_nan() && best.is_none()) {
            most = score;
            best = Some(place);
        }
    }
    let hopeless = fixed > R::from_f64(4.0) * free && !met(fixed_radius);
    match best {
        Some(place) if !hopeless => {
            if room {
                Step::Split(place)
            } else {
                Step::Stop(Status::PiecesExhausted)
            }
        }
        _ => Step::Stop(Status::DepthExhausted),
    }
}

#[inline]
fn dot<R: Real>(a: [R; 3], b: [R; 3]) -> R {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// When a subdivision is good enough.
pub(crate) trait Criterion<R: Real> {
    /// The bound of a total from so many pieces, and whether it is good enough.
    fn check(&mut self, total: &Total<R>, pieces: usize) -> (ColourBound<R>, bool);
    /// Whether a radius around a colour would be good enough.
    fn met(&self, xyz: [R; 3], radius: [R; 3]) -> bool;
}

impl<R: Real> Criterion<R> for &Target<R> {
    fn check(&mut self, total: &Total<R>, _: usize) -> (ColourBound<R>, bool) {
        let bound = delta_e_bound(total.xyz, total.radius, self.white);
        (bound, bound.delta_e <= self.threshold)
    }
    fn met(&self, xyz: [R; 3], radius: [R; 3]) -> bool {
        delta_e_bound(xyz, radius, self.white).delta_e <= self.threshold
    }
}

/// The paper's own criterion (A.3): no cube root is taken until the end.
struct ByTable<'a, R> {
    table: &'a ThresholdTable<'a, R>,
}

impl<R: Real> Criterion<R> for ByTable<'_, R> {
    fn check(&mut self, total: &Total<R>, _: usize) -> (ColourBound<R>, bool) {
        let reached = self.table.accepts(total.xyz, total.radius);
        let delta_e = if reached { self.table.threshold() } else { R::INFINITY };
        (ColourBound { delta_e, gradient: self.table.inverse_white() }, reached)
    }
    fn met(&self, xyz: [R; 3], radius: [R; 3]) -> bool {
        self.table.accepts(xyz, radius)
    }
}

/// Splits the visible domain until the criterion is met.
pub(crate) fn refine<R: Real>(
    mode: Mode,
    domain: &Domain<'_, R>,
    pieces: &mut [Piece<R>],
    mut integrand: impl FnMut(Node, &Weight<R>) -> Result<Interval<R>, ExpressionError>,
    mut criterion: impl Criterion<R>,
) -> Result<Evaluation<R>, ExpressionError> {
    let mut piece = |node: Node| {
        let weight = domain.weight(node);
        let interval = integrand(node, &weight)?;
        let (xyz, radius) = mode.contribution(&interval, &weight);
        Ok::<_, ExpressionError>(Piece { node, xyz, radius })
    };
    *pieces.first_mut().ok_or(ExpressionError::NoPieces)? = piece(Node::ROOT)?;
    let mut count = 1;
    loop {
        let used = pieces.get(..count).unwrap_or_default();
        let sum = total(used);
        let (ColourBound { delta_e, gradient }, reached) = criterion.check(&sum, count);
        let step = if reached {
            Step::Stop(Status::Reached)
        } else {
            choose(used, gradient, domain.depth(), count < pieces.len(), |r| criterion.met(sum.xyz, r))
        };
        let place = match step {
            Step::Split(place) => place,
            Step::Stop(status) => {
                return Ok(Evaluation { xyz: sum.xyz, radius: sum.radius, delta_e, intervals: count, status });
            }
        };
        let halves = used.get(place).and_then(|p| p.node.children());
        if let Some([left, right]) = halves {
            let (left, right) = (piece(left)?, piece(right)?);
            if let Some(slot) = pieces.get_mut(place) {
                *slot = left;
            }
            if let Some(slot) = pieces.get_mut(count) {
                *slot = right;
            }
            count += 1;
        }
    }
}

/// Evaluates a program over the visible domain: splits the interval that contributes most to the colour bound until the bound is
/// at or under the threshold, or nothing is left to split.
///
/// `stack` needs [`Program::stack_size`] entries; `pieces` limits the number of intervals. The first entries of `pieces` hold
/// the subdivision afterwards, [`Evaluation::intervals`] of them, in no particular order.
///
/// # Errors
/// As [`Program::evaluate`]'s, and [`ExpressionError::NoPieces`] for an empty buffer.
pub fn evaluate<R: Real, S: Sources<R> + ?Sized>(
    program: &Program<'_, R>,
    domain: &Domain<'_, R>,
    target: &Target<R>,
    sources: &mut S,
    stack: &mut [Interval<R>],
    pieces: &mut [Piece<R>],
) -> Result<Evaluation<R>, ExpressionError> {
    let order = target.mode.order();
    refine(target.mode, domain, pieces, |node, weight| program.evaluate(node, weight, order, sources, stack), target)
}

/// As [`evaluate`], with the paper's table of tolerances in XYZ (A.3) instead of the bound in CIELAB: no cube root is taken.
///
/// The evaluation's `delta_e` is the table's threshold where it was met, and +∞ elsewhere. The tolerance of a cell serves its most
/// sensitive colour, so that more intervals may be needed than with [`evaluate`].
///
/// # Errors
/// As [`evaluate`]'s.
pub fn evaluate_by_table<R: Real, S: Sources<R> + ?Sized>(
    program: &Program<'_, R>,
    domain: &Domain<'_, R>,
    mode: Mode,
    table: &ThresholdTable<'_, R>,
    sources: &mut S,
    stack: &mut [Interval<R>],
    pieces: &mut [Piece<R>],
) -> Result<Evaluation<R>, ExpressionError> {
    let order = mode.order();
    let criterion = ByTable { table };
    refine(mode, domain, pieces, |node, weight| program.evaluate(node, weight, order, sources, stack), criterion)
}
