//! Subdivisions shared by all expressions that differ only in scale.

use crate::Real;
use crate::adaptive::{Criterion, Mode, Piece, Status, Total, refine};
use crate::array::zip;
use crate::bound::{ColourBound, delta_e_bound, delta_e_majorant, delta_e_majorant_up_to};
use crate::expression::{ExpressionError, Program, Sources};
use crate::interval::{Domain, Interval, Weight};

/// One stage of a recorded subdivision: the colour at scale 1 from so many intervals, and up to which scale that is enough.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Stage<R> {
    /// The tristimulus values at scale 1.
    pub xyz: [R; 3],
    /// How far each may be off at scale 1.
    pub radius: [R; 3],
    /// The largest scale at which the bound is at or under the threshold; negative when there is none.
    pub max_scale: R,
}

/// A colour read from a recorded subdivision.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scaled<R> {
    /// The tristimulus values ∫Sā, in the expression's unit times nm.
    pub xyz: [R; 3],
    /// How far each may be off.
    pub radius: [R; 3],
    /// A bound of ΔE*ab within that radius.
    pub delta_e: R,
    /// How many intervals it took.
    pub intervals: usize,
}

/// The stages of an adaptive evaluation at scale 1, from which the evaluation at any scale c ≥ 0 is read.
///
/// CIELAB's differences grow with the scale of a colour and its radius ([`delta_e_majorant`]), so a stage is enough for all
/// scales up to one that is found once, when the subdivision is recorded. A look-up then costs comparisons alone; the bound
/// of the colour found costs six cube roots more. The stage found may have one interval more than a fresh evaluation's, because the
/// majorant is a little above the bound.
#[derive(Clone, Copy, Debug)]
pub struct Subdivision<'a, R> {
    stages: &'a [Stage<R>],
    white: [R; 3],
    status: Status,
}

impl<'a, R: Real> Subdivision<'a, R> {
    /// Evaluates the program at scale 1, stage by stage, into the caller's `stages`, until a stage is enough for every scale up
    /// to `largest`, or `stages` or `pieces` are used up, or nothing is left to split.
    ///
    /// # Errors
    /// As [`crate::adaptive::evaluate`]'s, and [`ExpressionError::NoPieces`] when `stages` is empty.
    #[allow(clippy::too_many_arguments, reason = "buffers are the caller's")]
    pub fn record<S: Sources<R> + ?Sized>(
        program: &Program<'_, R>,
        domain: &Domain<'_, R>,
        mode: Mode,
        threshold: R,
        white: [R; 3],
        largest: R,
        sources: &mut S,
        stack: &mut [Interval<R>],
        pieces: &mut [Piece<R>],
        stages: &'a mut [Stage<R>],
    ) -> Result<Self, ExpressionError> {
        let limit = pieces.len().min(stages.len());
        let pieces = pieces.get_mut(..limit).unwrap_or_default();
        let order = mode.order();
        let recorder = Recorder { stages: &mut *stages, threshold, white, largest };
        let evaluate = |node, weight: &Weight<R>| program.evaluate(node, weight, order, sources, stack);
        let outcome = refine(mode, domain, pieces, evaluate, recorder)?;
        let stages = stages.get(..outcome.intervals).unwrap_or_default();
        Ok(Self { stages, white, status: outcome.status })
    }

    /// A subdivision recorded before, whose stages the caller kept, for the white that it was recorded with.
    pub const fn from_stages(stages: &'a [Stage<R>], white: [R; 3], status: Status) -> Self {
        Self { stages, white, status }
    }

    /// The stages, from one interval on.
    pub const fn stages(&self) -> &'a [Stage<R>] {
        self.stages
    }

    /// Whether the last stage is enough for the largest scale asked for.
    pub const fn status(&self) -> Status {
        self.status
    }

    /// The colour at a scale, from the first stage that is enough, else from the last.
    ///
    /// Without any stage nothing is known: radius and bound are infinite. Domain: `scale` finite and not negative. The bound holds at every scale; it is above the threshold only where the
    /// last stage was not enough.
    #[inline]
    pub fn at_scale(&self, scale: R) -> Scaled<R> {
        let last = self.stages.len().saturating_sub(1);
        let place = self.stages.iter().position(|s| scale <= s.max_scale).unwrap_or(last);
        let Some(stage) = self.stages.get(place) else {
            let (xyz, radius) = ([R::ZERO; 3], [R::INFINITY; 3]);
            return Scaled { xyz, radius, delta_e: R::INFINITY, intervals: 0 };
        };
        let xyz = stage.xyz.map(|v| v * scale);
        let rounding = R::TWO * R::EPSILON;
        let radius = zip(stage.radius, xyz, |radius, value| {
            radius * scale * (R::ONE + rounding) + (rounding * value.abs() + R::MIN_POSITIVE)
        });
        Scaled { xyz, radius, delta_e: delta_e_majorant(xyz, radius, self.white), intervals: place + 1 }
    }
}

/// Writes down each stage, until one is enough for the largest scale.
struct Recorder<'b, R> {
    stages: &'b mut [Stage<R>],
    threshold: R,
    white: [R; 3],
    largest: R,
}

impl<R: Real> Criterion<R> for Recorder<'_, R> {
    fn check(&mut self, total: &Total<R>, pieces: usize) -> (ColourBound<R>, bool) {
        let max_scale = max_scale(total.xyz, total.radius, self.white, self.threshold);
        if let Some(stage) = self.stages.get_mut(pieces.saturating_sub(1)) {
            *stage = Stage { xyz: total.xyz, radius: total.radius, max_scale };
        }
        // Refined for the scale at which the stage is just enough, where nothing underflows.
        let scale = if max_scale > R::ZERO { max_scale } else { R::ONE };
        let [xyz, radius] = [total.xyz, total.radius].map(|v| v.map(|v| v * scale));
        (delta_e_bound(xyz, radius, self.white), max_scale >= self.largest)
    }
    fn met(&self, xyz: [R; 3], radius: [R; 3]) -> bool {
        max_scale(xyz, radius, self.white, self.threshold) >= self.largest
    }
}

/// The largest scale, found from below by bisection of its exponent, at which the majorant is at or under the threshold.
fn max_scale<R: Real>(xyz: [R; 3], radius: [R; 3], white: [R; 3], threshold: R) -> R {
    let enough = |scale: R| {
        let scaled = xyz.map(|v| v * scale);
        // At least what a look-up adds for its own rounding.
        let reach = zip(radius, scaled, |radius, scaled| {
            radius * scale * (R::ONE + R::from_f64(4.0) * R::EPSILON)
                + R::from_f64(4.0) * R::EPSILON * scaled.abs()
                + R::from_f64(4.0) * R::MIN_POSITIVE
        });
        delta_e_majorant_up_to(scaled, reach, white) <= threshold
    };
    let (mut low, mut high) = (R::MIN_POSITIVE, R::MAX);
    if enough(high) {
        return high;
    }
    if !enough(low) {
        return if enough(R::ZERO) { R::ZERO } else { -R::ONE };
    }
    // To within 2⁻²⁴ in `f32` and 2⁻²¹ in `f64`, of ranges of 2⁸ and 2¹¹ binades.
    for _ in 0..32 {
        // Of numbers far apart, the product may overflow or underflow.
        let middle = low.sqrt() * high.sqrt();
        if enough(middle) {
            low = middle;
        } else {
            high = middle;
        }
    }
    low
}
