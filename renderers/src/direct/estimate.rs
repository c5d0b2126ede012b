//! Visible configuration factors to a requested accuracy, with what is known of their error.

use super::adaptive::{Probe, Share, visible_share};
use super::blocker::{Blockers, Outline};
use super::cells::shaft_end;
use super::light::Surroundings;
use super::source::{Receiver, Seen, Source};
use super::visible::{Scratch, unblocked_factor, visible_factor};
use crate::geometry::{Shaft, ShaftEnd};

/// With more surfaces in the way than these, shadow rays cost less than closed forms.
pub(super) const MOST_BLOCKERS: usize = 256;
/// Corners of the polygons that round blockers are taken between.
const OUTLINES: [u32; 4] = [12, 36, 108, 324];
/// What closed forms are off by: relative to the light as a whole, and relative to the hemisphere.
const ROUNDING: f64 = 1e-12;
const ROUNDING_OF_HEMISPHERE: f64 = 4.0 * f64::EPSILON;
/// Shadow rays to one light, at most.
pub(super) const MOST_RAYS: u64 = 400_000;

/// How a factor was found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Way {
    /// Nothing is in the way, or all of the light is below a horizon.
    Unblocked,
    /// Blockers were cut out exactly.
    Exact,
    /// Round blockers were taken between polygons: the error is a bound.
    Bounded,
    /// By shadow rays: the error is an estimate, three standard deviations.
    Sampled,
}

/// The configuration factor of the visible part of a light: its irradiance over π times its radiance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// The factor.
    pub factor: f64,
    /// Its error, of the same unit.
    pub error: f64,
    /// Shadow rays.
    pub rays: u64,
    /// How it was found.
    pub way: Way,
}

impl Estimate {
    /// A light that isn't seen at all.
    pub const NOTHING: Self = Self { factor: 0.0, error: 0.0, rays: 0, way: Way::Unblocked };

    fn closed(factor: f64, unblocked: f64, way: Way) -> Self {
        let rounding = if unblocked > 0.0 { ROUNDING * unblocked + ROUNDING_OF_HEMISPHERE } else { 0.0 };
        Self { factor, error: rounding, rays: 0, way }
    }

    /// The visible share of a factor.
    pub(super) fn sampled(unblocked: f64, share: Share) -> Self {
        let Self { error, .. } = Self::closed(0.0, unblocked, Way::Sampled);
        let factor = unblocked * share.value;
        Self { factor, error: error + unblocked * share.error, rays: share.rays, way: Way::Sampled }
    }
}

/// The configuration factor of the part of a light that a receiver sees, to a relative accuracy.
///
/// Closed forms wherever at most 256 surfaces may be in the way: to rounding if they are polygons, within a bound if some are disks
/// or spheres; shadow rays elsewhere. The error says when the accuracy was not reached.
///
/// Surfaces that touch the receiver ([`contact`](Receiver::contact)) hide nothing. Sources that are pierced by other surfaces are cut where
/// those are flat; a light within a sphere of another surface is left to shadow rays.
#[must_use]
pub fn visible_configuration_factor(
    source: &Source,
    around: Surroundings<'_>,
    receiver: &Receiver,
    accuracy: f64,
    scratch: &mut Scratch,
) -> Estimate {
    let Some(seen) = Seen::new(&source.shape, receiver.position) else { return Estimate::NOTHING };
    let unblocked = unblocked_factor(receiver, &seen, scratch);
    if !(unblocked > 0.0) {
        return Estimate::NOTHING;
    }
    let from = ShaftEnd::polygon(&[receiver.position], receiver.geometric, receiver.point.primitive);
    let shaft = Shaft::between(&from, &shaft_end(source));
    let candidates = around.world.shaft_blockers(&shaft, MOST_BLOCKERS, false);
    let closed = candidates.and_then(|mut candidates| {
        candidates.sort_by(|a, b| around.world.area(*b).total_cmp(&around.world.area(*a)));
        among(&candidates, &seen, unblocked, around, receiver, accuracy, scratch)
    });
    closed.unwrap_or_else(|| {
        let share = visible_share(&Probe::new(around.world, receiver, source), accuracy, MOST_RAYS);
        Estimate::sampled(unblocked, share)
    })
}

/// The visible factor among candidates that may be in the way; `None` if it has no closed form.
fn among(
    candidates: &[u32],
    seen: &Seen,
    unblocked: f64,
    around: Surroundings<'_>,
    receiver: &Receiver,
    accuracy: f64,
    scratch: &mut Scratch,
) -> Option<Estimate> {
    if candidates.is_empty() {
        return Some(Estimate::closed(unblocked, unblocked, Way::Unblocked));
    }
    between_outlines(candidates, unblocked, around.blockers, accuracy, |outline| {
        visible_factor(receiver, seen, around.blockers, candidates, outline, scratch)
    })
}

/// The visible factor where round blockers are taken between polygons, with ever more corners until the accuracy is reached.
pub(super) fn between_outlines(
    candidates: &[u32],
    unblocked: f64,
    blockers: &Blockers,
    accuracy: f64,
    mut factor: impl FnMut(Outline) -> Option<f64>,
) -> Option<Estimate> {
    if candidates.iter().all(|primitive| blockers.is_flat_sided(*primitive)) {
        return Some(Estimate::closed(factor(Outline::Inscribed(3))?, unblocked, Way::Exact));
    }
    let mut best = None;
    for count in OUTLINES {
        let (Some(most), Some(least)) = (factor(Outline::Inscribed(count)), factor(Outline::Circumscribed(count)))
        else {
            break;
        };
        // The circle is a third of the way from the outer polygon to the inner one.
        let value = least + (most - least) / 3.0;
        let rounding = Estimate::closed(value, unblocked, Way::Bounded);
        let found = Estimate { error: rounding.error + (most - value).max(value - least), ..rounding };
        best = Some(found);
        if found.error <= accuracy * value {
            break;
        }
    }
    best
}
