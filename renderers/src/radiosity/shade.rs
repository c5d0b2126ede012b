//! The parts of a patch that are seen from a point or along a direction: the shadows of blockers are cut out exactly.

use glam::DVec3;

use super::mesh::{Patches, few_corners};
use super::polygon::Polygon;

/// The most blockers that are cut out.
pub(super) const MOST_BLOCKERS: usize = 64;
/// The most parts.
const MOST_PARTS: usize = 512;

/// Where patches are looked at from, or lit from.
#[derive(Clone, Copy, Debug)]
pub(super) enum Eye {
    At(DVec3),
    /// Far away; light from there travels along this unit vector.
    Along(DVec3),
}

impl Eye {
    /// A vector from the eye to a point.
    fn way(self, to: DVec3) -> DVec3 {
        match self {
            Self::At(position) => to - position,
            Self::Along(direction) => direction,
        }
    }

    /// The unit normal, towards `inside`, of the plane through the eye and an edge; `None` if they make no plane.
    fn plane(self, [a, b]: [DVec3; 2], inside: DVec3) -> Option<DVec3> {
        let along = (b - a).try_normalize()?;
        let normal = along.cross(self.way(a).try_normalize()?);
        if normal.length_squared() <= 1e-24 {
            return None;
        }
        let normal = normal.normalize();
        Some(if normal.dot(inside - a) < 0.0 { -normal } else { normal })
    }
}

/// What a polygon may hide: the inner side of planes, each given by a point and a normal. Without planes it is everything.
#[derive(Clone, Debug)]
pub(super) struct Cone {
    planes: Vec<(DVec3, DVec3)>,
}

impl Cone {
    pub(super) fn new(eye: Eye, blocker: &Polygon) -> Self {
        Self { planes: blocker.edges().filter_map(|edge| Some((edge[0], eye.plane(edge, blocker.centre)?))).collect() }
    }

    /// Whether a part may be in it: none of its planes has all of the part outside.
    pub(super) fn may_reach(&self, part: &Polygon, slack: f64) -> bool {
        let is_outside =
            |(point, normal): &(DVec3, DVec3)| part.corners().iter().all(|c| (*c - *point).dot(*normal) <= slack);
        !self.planes.iter().any(is_outside)
    }
}

impl Patches {
    /// The parts of a polygon that are seen when these primitives, and no others, may be in the way; `None` if there are too many.
    pub(super) fn seen_parts(&self, polygon: &Polygon, eye: Eye, blockers: &[u32]) -> Option<Vec<Polygon>> {
        let mut parts = vec![*polygon];
        for blocker in blockers {
            let face = self.face.get(*blocker as usize)?;
            if face != blocker && blockers.contains(face) {
                continue;
            }
            let blocker = self.blockers.get(*blocker as usize)?;
            // What is behind the polygon doesn't block, nor what is seen edge-on.
            let Some(before) = blocker.above(polygon.centre, polygon.normal, self.slack) else { continue };
            let edge_on = match eye {
                Eye::At(position) => (position - before.centre).dot(before.normal).abs() <= 10.0 * self.slack,
                Eye::Along(direction) => direction.dot(before.normal).abs() <= 1e-12,
            };
            if edge_on {
                continue;
            }
            let shadow = Cone::new(eye, &before);
            if !parts.iter().any(|part| shadow.may_reach(part, self.slack)) {
                continue;
            }
            let mut left = Vec::with_capacity(2 * parts.len());
            for part in &parts {
                if shadow.may_reach(part, self.slack) {
                    self.outside(part, &shadow.planes, &mut left);
                } else {
                    left.push(*part);
                }
            }
            parts = left;
            if parts.is_empty() {
                break;
            }
            if parts.len() > MOST_PARTS {
                return None;
            }
        }
        Some(parts)
    }

    /// Adds what is left of a part outside the cone on the inner side of planes, each given by a point and a normal.
    fn outside(&self, part: &Polygon, cone: &[(DVec3, DVec3)], left: &mut Vec<Polygon>) {
        let before = left.len();
        let mut inside = vec![*part];
        for (point, normal) in cone {
            let mut next = Vec::new();
            for piece in &inside {
                left.extend(piece.above(*point, -*normal, self.slack).into_iter().flat_map(few_corners));
                next.extend(piece.above(*point, *normal, self.slack).into_iter().flat_map(few_corners));
            }
            if next.is_empty() {
                // All of it is outside: it needs no cuts.
                left.truncate(before);
                left.push(*part);
                return;
            }
            inside = next;
        }
    }
}
