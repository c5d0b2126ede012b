//! Shafts: everything that could block the way between two convex bodies (E. A. Haines & J. R. Wallace, "Shaft Culling for Efficient
//! Ray-Cast Radiosity", *Photorealistic Rendering in Computer Graphics*, 1991).
//!
//! Haines and Wallace join the silhouettes of two boxes, axis by axis. Here the ends are convex polygons as they stand, and the shaft is
//! bounded by the planes that support both ends at an edge of one of them: their convex hull, however they are turned.
//!
//! A shaft that is clear is certainly so: what is left out lies, whole, on the far side of a plane that no ray of the shaft crosses.
//! Planes are moved outwards by [`MARGIN`], which is more than the offsets of rays at their ends. Two kinds of plane have no margin,
//! or surfaces that touch could never be told apart: those of the ends themselves, as rays start and end in front of them (what is
//! coplanar with an end, or behind it, doesn't block); and the plane of a possible blocker, if both ends are on one side of it (a
//! wall that stands on the edge of a floor doesn't shade that floor from a light before the wall).

use glam::{DVec3, Vec3A, Vec4};

use super::bvh::Bvh;
use super::packet::Packet;
use super::ray::NO_PRIMITIVE;
use super::round::Round;

/// How far outside the hull blockers are still taken to be in the way, relative to its largest coordinate: rays leave the hull by
/// less than 32 units in the last place.
const MARGIN: f64 = 64.0 * f32::EPSILON as f64;
/// Relative rounding of plane equations in `f64`, with room to spare.
const ROUNDING: f64 = 1e-13;
/// Relative rounding of a product of two vectors in `f64`.
const DOT_ROUNDING: f64 = 4.0 * f64::EPSILON;
/// Relative rounding of the test of a box, in `f32`.
const BOX_ROUNDING: f64 = 16.0 * f32::EPSILON as f64;
/// Triangles flatter than this have no plane to speak of: twice the area over the product of two sides.
const FLAT: f64 = 1e-5;
/// Rays to a polygonal end are offset from it by at least so many units in the last place.
const CLEARANCE: f64 = 4.0;

/// One end of a [`Shaft`]: a convex body that rays start from or go to.
#[derive(Clone, Debug, PartialEq)]
pub struct ShaftEnd {
    corners: Vec<DVec3>,
    edges: Vec<[u8; 2]>,
    /// The normal of a flat end, on the side where its rays are.
    normal: Option<DVec3>,
    /// Height of rays above a flat end, at least, in units of the last place of its coordinates.
    clearance: f64,
    primitive: u32,
}

impl ShaftEnd {
    /// A convex planar polygon, its corners in order, that receives or sends light on the side of the unit `normal`. Rays end at
    /// points made by [`SurfacePoint::new`](super::SurfacePoint::new) from points within it, and primitive `primitive` blocks none
    /// of them ([`NO_PRIMITIVE`] if there is none).
    #[must_use]
    pub fn polygon(corners: &[DVec3], normal: DVec3, primitive: u32) -> Self {
        Self::flat(corners.to_vec(), normal, CLEARANCE, primitive)
    }

    /// Anything within an axis-aligned box. Rays end at points made by [`SurfacePoint::new`](super::SurfacePoint::new), and primitive
    /// `primitive` blocks none of them.
    #[must_use]
    pub fn within(low: DVec3, high: DVec3, primitive: u32) -> Self {
        let axis = |i: u8, bit: u8, a: f64, b: f64| if i >> bit & 1 == 0 { a } else { b };
        let corner = |i| DVec3::new(axis(i, 0, low.x, high.x), axis(i, 1, low.y, high.y), axis(i, 2, low.z, high.z));
        let edges = (0..8_u8).flat_map(|i| [1, 2, 4].map(|bit| [i, i ^ bit])).filter(|[a, b]| a < b);
        Self { corners: (0..8).map(corner).collect(), edges: edges.collect(), normal: None, clearance: 0.0, primitive }
    }

    fn flat(corners: Vec<DVec3>, normal: DVec3, clearance: f64, primitive: u32) -> Self {
        let count = u8::try_from(corners.len()).unwrap_or(u8::MAX);
        let edges = (0..count).map(|i| [i, (i + 1) % count]).collect();
        Self { corners, edges, normal: Some(normal), clearance, primitive }
    }

    /// The part of a planar primitive within a box; `None` if there is none. The box is taken a little wider, so that the part holds
    /// every point of the primitive whose `f32` coordinates are in the box.
    pub(super) fn part(corners: &[Vec3A], normal: DVec3, [low, high]: [DVec3; 2], primitive: u32) -> Option<Self> {
        let scale = corners.iter().fold(0.0_f32, |scale, c| scale.max(c.abs().max_element()));
        let wider = DVec3::splat(2.0 * f64::from(f32::EPSILON) * f64::from(scale));
        let mut part: Vec<DVec3> = corners.iter().map(|c| c.as_dvec3()).collect();
        for axis in [DVec3::X, DVec3::Y, DVec3::Z] {
            part = clip(&part, axis, (low - wider).dot(axis));
            part = clip(&part, -axis, -(high + wider).dot(axis));
        }
        (part.len() >= 3).then(|| Self::flat(part, normal, 0.0, primitive))
    }

    /// The part of a flat end above the horizon of another flat one, if that is a part and not all of it or nothing.
    fn cut_by_horizon(&self, other: &Self) -> Option<Self> {
        let (own, normal) = (self.normal?, other.normal?);
        let horizon = other.least(normal);
        if self.least(normal) >= horizon {
            return None;
        }
        let part = clip(&self.corners, normal, horizon);
        (part.len() >= 3).then(|| Self::flat(part, own, self.clearance, self.primitive))
    }

    /// The least value of a linear function on it.
    fn least(&self, normal: DVec3) -> f64 {
        self.corners.iter().fold(f64::INFINITY, |least, c| least.min(c.dot(normal)))
    }

    /// The smallest of its points' largest coordinates, or less.
    fn smallest(&self) -> f64 {
        let low = self.corners.iter().fold(DVec3::INFINITY, |low, c| low.min(*c));
        let high = self.corners.iter().fold(DVec3::NEG_INFINITY, |high, c| high.max(*c));
        low.max(-high).max_element().max(0.0)
    }
}

/// The part of a convex polygon where x·axis ≥ `least` (Sutherland & Hodgman 1974).
fn clip(polygon: &[DVec3], axis: DVec3, least: f64) -> Vec<DVec3> {
    let mut part = Vec::with_capacity(polygon.len() + 1);
    let Some(last) = polygon.last() else { return part };
    let (mut before, mut height_before) = (*last, last.dot(axis) - least);
    for corner in polygon {
        let height = corner.dot(axis) - least;
        if (height_before < 0.0) != (height < 0.0) {
            part.push(before + (*corner - before) * (height_before / (height_before - height)));
        }
        if height >= 0.0 {
            part.push(*corner);
        }
        (before, height_before) = (*corner, height);
    }
    part
}

/// No ray of the shaft meets anything that is, whole, where x·`normal` ≤ `least`.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Plane {
    normal: DVec3,
    least: f64,
}

/// The same for boxes, in `f32`.
#[derive(Clone, Copy, Debug, PartialEq)]
struct BoxPlane {
    normal: Vec3A,
    least: f32,
}

/// Everything between two convex bodies, for [`World::shaft_is_clear`](super::World::shaft_is_clear).
#[derive(Clone, Debug, PartialEq)]
pub struct Shaft {
    corners: Vec<DVec3>,
    planes: Vec<Plane>,
    box_planes: Vec<BoxPlane>,
    low: Vec3A,
    high: Vec3A,
    /// The largest coordinate of the corners.
    scale: f64,
    exclude: [u32; 2],
}

impl Shaft {
    /// The shaft of all segments between two bodies that leave and reach flat ones on the side of their normals.
    #[must_use]
    pub fn between(from: &ShaftEnd, to: &ShaftEnd) -> Self {
        // What is below the horizon of the other end sends nothing there.
        let (cut_from, cut_to) = (from.cut_by_horizon(to), to.cut_by_horizon(from));
        let (from, to) = (cut_from.as_ref().unwrap_or(from), cut_to.as_ref().unwrap_or(to));
        let corners: Vec<DVec3> = from.corners.iter().chain(&to.corners).copied().collect();
        let scale = corners.iter().fold(0.0, |scale: f64, c| scale.max(c.abs().max_element()));
        let margin = MARGIN * scale;
        let mut planes = Vec::with_capacity(from.edges.len() + to.edges.len() + 2);
        planes.extend(end_plane(from, scale));
        planes.extend(end_plane(to, scale));
        for (one, other) in [(from, to), (to, from)] {
            let supporting = one.edges.iter().filter_map(|edge| supporting_normal(one, *edge, other));
            planes.extend(supporting.map(|normal| {
                let least = from.least(normal).min(to.least(normal));
                Plane { normal, least: least - margin }
            }));
        }
        let low = corners.iter().fold(DVec3::INFINITY, |low, c| low.min(*c)) - margin;
        let high = corners.iter().fold(DVec3::NEG_INFINITY, |high, c| high.max(*c)) + margin;
        let slack = BOX_ROUNDING * scale;
        let box_planes =
            planes.iter().map(|p| BoxPlane { normal: p.normal.as_vec3a(), least: single(p.least - slack) });
        Self {
            box_planes: box_planes.collect(),
            corners,
            planes,
            low: low.as_vec3a(),
            high: high.as_vec3a(),
            scale,
            exclude: [from.primitive, to.primitive],
        }
    }

    /// Whether nothing in the hierarchy is in the way.
    pub(super) fn is_clear(&self, bvh: &Bvh) -> bool {
        !bvh.any_item(
            |low, high| self.meets_boxes(low, high),
            |packet| self.is_blocked_by_packet(packet),
            |round, primitive| !self.exclude.contains(&primitive) && !self.misses_round(round),
        )
    }

    /// The primitives in the hierarchy that may be in the way, in increasing order; `None` if there are more than `most`,
    /// or round ones and `flat` asks for none.
    pub(super) fn blockers(&self, bvh: &Bvh, most: usize, flat: bool) -> Option<Vec<u32>> {
        let found = core::cell::RefCell::new(Vec::new());
        let overflows = bvh.any_item(
            |low, high| self.meets_boxes(low, high),
            |packet| {
                let mut found = found.borrow_mut();
                found.extend(self.blocking_triangles(packet));
                found.len() > 2 * most
            },
            |round, primitive| {
                if self.exclude.contains(&primitive) || self.misses_round(round) {
                    return false;
                }
                let mut found = found.borrow_mut();
                found.push(primitive);
                flat || found.len() > 2 * most
            },
        );
        let mut found = found.into_inner();
        // Both halves of a parallelogram have its number.
        found.sort_unstable();
        found.dedup();
        (!overflows && found.len() <= most).then_some(found)
    }

    /// Which of four boxes may have something in them that is in the way.
    #[inline]
    fn meets_boxes(&self, low: &[Vec4; 3], high: &[Vec4; 3]) -> u32 {
        // What is outside the shaft's own box doesn't matter.
        let low: [Vec4; 3] = core::array::from_fn(|axis| low[axis].max(Vec4::splat(self.low[axis])));
        let high: [Vec4; 3] = core::array::from_fn(|axis| high[axis].min(Vec4::splat(self.high[axis])));
        let mut meets = low[0].cmple(high[0]) & low[1].cmple(high[1]) & low[2].cmple(high[2]);
        for plane in &self.box_planes {
            let n = plane.normal.to_array();
            let furthest = |axis: usize| if n[axis] > 0.0 { high[axis] * n[axis] } else { low[axis] * n[axis] };
            meets &= (furthest(0) + furthest(1) + furthest(2)).cmpgt(Vec4::splat(plane.least));
        }
        meets.bitmask()
    }

    fn is_blocked_by_packet(&self, packet: &Packet) -> bool {
        self.blocking_triangles(packet).next().is_some()
    }

    /// The primitives of a packet's triangles that may be in the way.
    fn blocking_triangles(&self, packet: &Packet) -> impl Iterator<Item = u32> {
        let blocking = packet.triangles().filter(|(primitive, triangle)| {
            *primitive != NO_PRIMITIVE && !self.exclude.contains(primitive) && !self.misses_triangle(*triangle)
        });
        blocking.map(|(primitive, _)| primitive)
    }

    /// Whether a triangle is certainly not in the way.
    fn misses_triangle(&self, triangle: [Vec3A; 3]) -> bool {
        let [a, b, c] = triangle;
        if a.max(b).max(c).cmplt(self.low).any() || a.min(b).min(c).cmpgt(self.high).any() {
            return true;
        }
        let size = f64::from(a.abs().max(b.abs()).max(c.abs()).max_element());
        let [a, b, c] = triangle.map(Vec3A::as_dvec3);
        let furthest = |n: DVec3| a.dot(n).max(b.dot(n)).max(c.dot(n));
        if self.is_beyond_a_plane(size, furthest) {
            return true;
        }
        let (u, v) = (b - a, c - a);
        let (normal, product) = (u.cross(v), u.length() * v.length());
        normal.length() >= FLAT * product && self.is_on_one_side(a, normal, ROUNDING * product * (size + self.scale))
    }

    /// Whether a round surface is certainly not in the way.
    fn misses_round(&self, round: &Round) -> bool {
        let [low, high] = round.bounds();
        if high.cmplt(self.low).any() || low.cmpgt(self.high).any() {
            return true;
        }
        let size = f64::from(low.abs().max(high.abs()).max_element());
        let on_one_side = |(point, normal)| self.is_on_one_side(point, normal, ROUNDING * (size + self.scale));
        self.is_beyond_a_plane(size, |n| round.furthest(n)) || round.plane().is_some_and(on_one_side)
    }

    /// Whether a body, of which the largest coordinate and the largest value of linear functions are given, is beyond one plane.
    fn is_beyond_a_plane(&self, size: f64, furthest: impl Fn(DVec3) -> f64) -> bool {
        let rounding = DOT_ROUNDING * size;
        self.planes.iter().any(|plane| furthest(plane.normal) + rounding <= plane.least)
    }

    /// Whether both ends are on one side of a plane, or touch it.
    fn is_on_one_side(&self, point: DVec3, normal: DVec3, tolerance: f64) -> bool {
        let heights = self.corners.iter().map(|c| (*c - point).dot(normal));
        let (low, high) = heights.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(x), h.max(x)));
        low >= -tolerance || high <= tolerance
    }
}

/// The plane of a flat end: rays are above it, at one end by their offset, at the other because they come from above the horizon.
fn end_plane(end: &ShaftEnd, scale: f64) -> Option<Plane> {
    let normal = end.normal?;
    // Offsets are along the normal and proportional to the sum of its components.
    let units = end.clearance * f64::from(f32::EPSILON) * normal.abs().element_sum();
    let clearance = (units * end.smallest()).max(ROUNDING * scale);
    Some(Plane { normal, least: end.least(normal) + clearance })
}

/// The inward unit normal of the plane through an edge of one body that supports the other; `None` for an edge without length. Any
/// normal makes a valid plane: this one makes the tightest.
fn supporting_normal(one: &ShaftEnd, edge: [u8; 2], other: &ShaftEnd) -> Option<DVec3> {
    let [a, b] = edge.map(|i| one.corners[i as usize]);
    let along = b - a;
    let inner = one.corners.iter().fold(DVec3::ZERO, |sum, c| sum + (*c - a));
    let through = |c: DVec3| {
        let normal = along.cross(c - a);
        if normal.dot(inner) < 0.0 { -normal } else { normal }
    };
    let (first, rest) = other.corners.split_first()?;
    let mut normal = through(*first);
    for corner in rest {
        if (*corner - a).dot(normal) < 0.0 {
            normal = through(*corner);
        }
    }
    normal.try_normalize()
}

#[allow(clippy::cast_possible_truncation, reason = "rounded with slack")]
fn single(x: f64) -> f32 {
    x as f32
}
