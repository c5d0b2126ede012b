//! The visible part of a light in closed form.

use disk_sampling::{Disk, Receiver as Element, disk_configuration_factor, polygon_configuration_factor};
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
    cones: Cones,
}

/// The cones that were last cut out of a light.
#[derive(Clone, Debug, Default)]
pub(super) struct Cones {
    planes: Vec<DVec3>,
    ends: Vec<usize>,
}

impl Cones {
    /// Whether one of them hides what is in a direction.
    pub(super) fn hide(&self, direction: DVec3) -> bool {
        let mut start = 0;
        self.ends.iter().any(|end| {
            let cone = self.planes.get(start..*end).unwrap_or_default();
            start = *end;
            cone.iter().all(|plane| plane.dot(direction) > 0.0)
        })
    }
}

impl Scratch {
    /// The cones that were last cut out, if nothing was left out because nothing was left.
    pub(super) const fn cones(&self) -> &Cones {
        &self.cones
    }

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
    cut(receiver, &target, blockers, candidates, outline, scratch)?;
    if scratch.cones.ends.is_empty() {
        return Some(unblocked_factor(receiver, seen, scratch));
    }
    Some(left(receiver, seen.circle.as_ref(), scratch))
}

/// Cuts all candidates out of the pieces in `scratch`; `None` if one of them has no closed form, or too many pieces are left.
pub(super) fn cut(
    receiver: &Receiver,
    target: &Target<'_>,
    blockers: &Blockers,
    candidates: &[u32],
    outline: Outline,
    scratch: &mut Scratch,
) -> Option<()> {
    let Scratch { pieces, buffers, planes, cones } = scratch;
    cones.planes.clear();
    cones.ends.clear();
    for candidate in candidates {
        if pieces.is_empty() {
            break;
        }
        let blocker = blockers.get(*candidate)?;
        match blocker.cone(receiver.position, receiver.contact, target, outline, planes) {
            Effect::None => {}
            Effect::Cone => {
                if pieces.subtract(planes, buffers) {
                    cones.planes.extend_from_slice(planes);
                    cones.ends.push(cones.planes.len());
                }
            }
            Effect::Unknown => return None,
        }
        if pieces.len() > MOST_PIECES {
            return None;
        }
    }
    Some(())
}

/// The configuration factor of the pieces in `scratch`, or of their parts within a circle.
pub(super) fn left(receiver: &Receiver, circle: Option<&Circle>, scratch: &Scratch) -> f64 {
    let pieces = scratch.pieces.iter();
    contour::factor(match circle {
        None => pieces.map(|piece| contour::polygon(piece, receiver.normal)).sum(),
        Some(circle) => pieces.map(|piece| circle.part(piece, receiver.normal)).sum(),
    })
}

/// The configuration factor of a light that nothing blocks, clipped at the receiver's horizons.
pub(super) fn unblocked_factor(receiver: &Receiver, seen: &Seen, scratch: &mut Scratch) -> f64 {
    if receiver.geometric == receiver.normal {
        return whole_factor(receiver.normal, seen);
    }
    scratch.start(core::iter::once(seen.corners()));
    scratch.pieces.keep(receiver.normal, &mut scratch.buffers);
    scratch.pieces.keep(receiver.geometric, &mut scratch.buffers);
    left(receiver, seen.circle.as_ref(), scratch)
}

/// The configuration factor of a light that nothing blocks, clipped at one horizon. The disk's own closed form keeps its relative accuracy
/// where a sum of edges and arcs cancels: for small and distant lights.
fn whole_factor(normal: DVec3, seen: &Seen) -> f64 {
    let Some(circle) = &seen.circle else {
        let mut corners = [[0.0; 3]; 4];
        let count = seen.corners().len();
        for (array, corner) in corners.iter_mut().zip(seen.corners()) {
            *array = corner.to_array();
        }
        return polygon_configuration_factor([0.0; 3], normal.to_array(), corners.get(..count).unwrap_or_default());
    };
    let disk = Disk::new(circle.centre.to_array(), (-circle.normal).to_array(), circle.u.length());
    let element = Element::new([0.0; 3], normal.to_array());
    match (disk, element) {
        (Ok(disk), Ok(element)) => disk_configuration_factor(&disk, &element),
        _ => 0.0,
    }
}
