//! A uniform environment: the part of the hemisphere over a receiver that nothing hides.

use glam::DVec3;

use super::adaptive::{Probe, visible_share};
use super::blocker::Target;
use super::estimate::{Estimate, MOST_BLOCKERS, MOST_RAYS, between_outlines};
use super::light::Surroundings;
use super::source::Receiver;
use super::visible::{Scratch, cut, left};

/// The configuration factor of the part of a uniform environment that a receiver sees, to a relative accuracy: 1 in the open.
///
/// In closed form in scenes of at most 256 surfaces, by shadow rays in others; see
/// [`visible_configuration_factor`](super::visible_configuration_factor).
#[must_use]
pub fn visible_sky(around: Surroundings<'_>, receiver: &Receiver, accuracy: f64, scratch: &mut Scratch) -> Estimate {
    let count = around.world.len();
    let closed = (count <= MOST_BLOCKERS).then(|| {
        let all: Vec<u32> = (0..).take(count).filter(|p| *p != receiver.point.primitive).collect();
        between_outlines(&all, 1.0, around.blockers, accuracy, |outline| {
            let (x, y) = receiver.normal.any_orthonormal_pair();
            let quarters = [[x, y], [y, -x], [-x, -y], [-y, x]].map(|[a, b]| [a, b, receiver.normal]);
            scratch.start(quarters.iter().map(<[DVec3; 3]>::as_slice));
            cut(receiver, &Target::INFINITE, around.blockers, &all, outline, scratch)?;
            Some(left(receiver, None, scratch))
        })
    });
    closed.flatten().unwrap_or_else(|| {
        let share = visible_share(&Probe::of_sky(around.world, receiver), accuracy, MOST_RAYS);
        Estimate::sampled(1.0, share)
    })
}
