//! Convex polygons as a point sees them, and what is left of them when convex cones are cut out.
//!
//! A polygon is a list of directions from the point, of about unit length; cones are bounded by planes through the point. So a piece is
//! cut without ever being projected, and nothing happens at infinity.

use glam::DVec3;

/// Sines below this are 0: rounding of directions and planes, with room to spare. What is narrower is dropped, so that cones that
/// share an edge leave nothing between them.
const TOLERANCE: f64 = 1e-13;
/// Directions shorter than this are made of unit length again.
const SHORT: f64 = 0.25;

/// Disjoint convex polygons around a point, their corners in order.
#[derive(Clone, Debug, Default)]
pub(super) struct Pieces {
    corners: Vec<DVec3>,
    ends: Vec<usize>,
}

/// Buffers for [`Pieces::subtract`].
#[derive(Clone, Debug, Default)]
pub(super) struct Buffers {
    next: Pieces,
    rest: Vec<DVec3>,
    inside: Vec<DVec3>,
    heights: Vec<f64>,
}

/// How a polygon lies to a plane.
enum Side {
    Inside,
    Outside,
    Both,
}

impl Pieces {
    /// Forgets everything and starts with polygons given by their corners relative to the point; none of them may be zero.
    pub(super) fn start<'a>(&mut self, polygons: impl Iterator<Item = &'a [DVec3]>) {
        self.clear();
        for corners in polygons {
            self.corners.extend(corners.iter().copied().map(DVec3::normalize_or_zero));
            self.ends.push(self.corners.len());
        }
    }

    /// The polygons.
    pub(super) fn iter(&self) -> impl Iterator<Item = &[DVec3]> {
        let starts = core::iter::once(0).chain(self.ends.iter().copied());
        starts.zip(&self.ends).filter_map(|(start, end)| self.corners.get(start..*end))
    }

    /// How many there are.
    pub(super) fn len(&self) -> usize {
        self.ends.len()
    }

    /// Whether nothing is left.
    pub(super) fn is_empty(&self) -> bool {
        self.ends.is_empty()
    }

    fn clear(&mut self) {
        self.corners.clear();
        self.ends.clear();
    }

    fn push(&mut self, piece: &[DVec3]) {
        self.corners.extend_from_slice(piece);
        self.ends.push(self.corners.len());
    }

    fn truncate(&mut self, count: usize) {
        self.ends.truncate(count);
        self.corners.truncate(self.ends.last().copied().unwrap_or(0));
    }

    /// Keeps what is on the inner side of a plane with unit normal `plane`.
    pub(super) fn keep(&mut self, plane: DVec3, buffers: &mut Buffers) {
        let Buffers { next, inside, heights, .. } = buffers;
        next.clear();
        for piece in self.iter() {
            match side(piece, plane, heights) {
                Side::Inside => next.push(piece),
                Side::Outside => {}
                Side::Both => {
                    inside.clear();
                    split(piece, heights, inside, &mut Vec::new());
                    next.push(inside);
                }
            }
        }
        core::mem::swap(self, next);
    }

    /// Cuts out the cone on the inner side of all planes, given by their unit normals; whether it met anything.
    pub(super) fn subtract(&mut self, cone: &[DVec3], buffers: &mut Buffers) -> bool {
        let Buffers { next, rest, inside, heights } = buffers;
        next.clear();
        let mut meets = false;
        for piece in self.iter() {
            let is_apart = |plane: &DVec3| piece.iter().all(|corner| plane.dot(*corner) <= TOLERANCE);
            if cone.iter().any(is_apart) {
                next.push(piece);
                continue;
            }
            let before = next.len();
            let mut is_apart = false;
            rest.clear();
            rest.extend_from_slice(piece);
            for plane in cone {
                match side(rest, *plane, heights) {
                    Side::Inside => {}
                    Side::Outside => {
                        // It was apart after all: it stays in one piece.
                        next.truncate(before);
                        next.push(piece);
                        is_apart = true;
                        break;
                    }
                    Side::Both => {
                        inside.clear();
                        split(rest, heights, inside, &mut next.corners);
                        next.ends.push(next.corners.len());
                        core::mem::swap(rest, inside);
                    }
                }
            }
            meets |= !is_apart;
        }
        core::mem::swap(self, next);
        meets
    }
}

/// Where a polygon is, with its corners' heights over the plane.
fn side(piece: &[DVec3], plane: DVec3, heights: &mut Vec<f64>) -> Side {
    heights.clear();
    heights.extend(piece.iter().map(|corner| plane.dot(*corner)));
    let low = heights.iter().fold(f64::INFINITY, |low, height| low.min(*height));
    let high = heights.iter().fold(f64::NEG_INFINITY, |high, height| high.max(*height));
    if high <= TOLERANCE {
        Side::Outside
    } else if low >= -TOLERANCE {
        Side::Inside
    } else {
        Side::Both
    }
}

/// Adds the parts of a polygon on both sides of a plane to `inside` and `outside`. Corners on the plane belong to both.
fn split(piece: &[DVec3], heights: &[f64], inside: &mut Vec<DVec3>, outside: &mut Vec<DVec3>) {
    let (Some(last), Some(height)) = (piece.last(), heights.last()) else { return };
    let (mut before, mut height_before) = (*last, *height);
    for (corner, height) in piece.iter().zip(heights) {
        let crosses = height.abs() > TOLERANCE && height_before.abs() > TOLERANCE;
        if crosses && (*height > 0.0) != (height_before > 0.0) {
            let crossing = before + (*corner - before) * (height_before / (height_before - height));
            let crossing = if crossing.length_squared() < SHORT { crossing.normalize_or_zero() } else { crossing };
            inside.push(crossing);
            outside.push(crossing);
        }
        if *height >= -TOLERANCE {
            inside.push(*corner);
        }
        if *height <= TOLERANCE {
            outside.push(*corner);
        }
        (before, height_before) = (*corner, *height);
    }
}
