//! The visible part of a light in closed form.

use glam::DVec3;

use super::blocker::{Blockers, Effect, Outline, Target};
use super::contour::{self, Circle};
use super::pieces::{Buffers, Pieces};
use super::source::{Receiver, Seen};

/// A light in more pieces than these is not cut any further.
const MOST_PIECES: usize = 1024;

/// Buffers that one thread uses again and again.
#[derive(Clone, Debug, Default)]
pub struct Scratch {
    pieces: Pieces,
    buffers: Buffers,
    planes: Vec<DVec3>,
}

impl Scratch {
    /// Starts with these polygons, given by their corners relative to the receiver.
    pub(super) fn start<'a>(&mut self, polygons: impl Iterator<Item = &'a [DVec3]>) {
        self.pieces.start(polygons);
    }
}

/// Which surfaces may be between a receiver and a light.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Cover<'c> {
    /// None, for certain.
    Clear,
    /// These primitives and no others.
    Few(&'c [u32]),
    /// Nobody knows.
    Unknown,
}

/// The configuration factor of the part of a light that the given primitives don't hide and that is above the receiver's horizons; `None` if
/// it has no closed form with these, or too many pieces.
pub(super) fn visible_factor(
    receiver: &Receiver,
    seen: &Seen,
    blockers: &Blockers,
    candidates: &[u32],
    outline: Outline,
    scratch: &mut Scratch,
) -> Option<f64> {
    let corners = seen.corners();
    scratch.start(core::iter::once(corners));
    scratch.pieces.keep(receiver.normal, &mut scratch.buffers);
    if receiver.geometric != receiver.normal {
        scratch.pieces.keep(receiver.geometric, &mut scratch.buffers);
    }
    let target = Target { normal: seen.normal, distance: seen.distance, corners };
    remaining(receiver, &target, seen.circle.as_ref(), blockers, candidates, outline, scratch)
}

/// The configuration factor of what is left of the pieces in `scratch`, and of that within a circle, when all candidates are cut out.
pub(super) fn remaining(
    receiver: &Receiver,
    target: &Target<'_>,
    circle: Option<&Circle>,
    blockers: &Blockers,
    candidates: &[u32],
    outline: Outline,
    scratch: &mut Scratch,
) -> Option<f64> {
    let Scratch { pieces, buffers, planes } = scratch;
    for candidate in candidates {
        if pieces.is_empty() {
            return Some(0.0);
        }
        let blocker = blockers.get(*candidate)?;
        match blocker.cone(receiver.position, receiver.contact, target, outline, planes) {
            Effect::None => {}
            Effect::Cone => pieces.subtract(planes, buffers),
            Effect::Unknown => return None,
        }
        if pieces.len() > MOST_PIECES {
            return None;
        }
    }
    let sum = match circle {
        None => pieces.iter().map(|piece| contour::polygon(piece, receiver.normal)).sum(),
        Some(circle) => pieces.iter().map(|piece| circle.part(piece, receiver.normal)).sum(),
    };
    Some(contour::factor(sum))
}

/// The configuration factor of a light that nothing blocks, clipped at the receiver's horizons.
pub(super) fn unblocked_factor(receiver: &Receiver, seen: &Seen, scratch: &mut Scratch) -> f64 {
    let nothing = Blockers::default();
    visible_factor(receiver, seen, &nothing, &[], Outline::Inscribed(3), scratch).unwrap_or(0.0)
}
