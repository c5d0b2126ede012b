//! Light sources with an area, and what receives their light.

use glam::{DVec3, Vec3A};

use super::blocker::cap;
use super::contour::Circle;
use crate::geometry::{NO_PRIMITIVE, SurfacePoint, World};

/// How near surfaces must be to a receiver to touch it, relative to the largest coordinate.
const CONTACT: f64 = 1e-9;

/// A surface element that receives light.
#[derive(Clone, Copy, Debug)]
pub struct Receiver {
    /// Where shadow rays start.
    pub point: SurfacePoint,
    /// Its position.
    pub position: DVec3,
    /// The unit shading normal on the side that receives.
    pub normal: DVec3,
    /// The unit geometric normal on that side: nothing comes from below it.
    pub geometric: DVec3,
    /// A bound of the position's error: surfaces so near are touched and hide nothing.
    pub contact: f64,
}

impl Receiver {
    /// A receiver of its own among surfaces, at a position, with a unit normal. What is within 10⁻⁹ of the largest coordinate there is, is
    /// touched.
    #[must_use]
    pub fn new(position: DVec3, normal: DVec3, world: &World) -> Self {
        let [low, high] = world.bounds().map(Vec3A::as_dvec3);
        let size = position.abs().max(low.abs()).max(high.abs()).max_element();
        #[allow(clippy::cast_possible_truncation, reason = "shadow rays are f32")]
        let error = 8.0 * f32::EPSILON * size as f32;
        let point = SurfacePoint { position: single(position), error, normal: single(normal), primitive: NO_PRIMITIVE };
        Self { point, position, normal, geometric: normal, contact: CONTACT * size }
    }
}

/// A flat shape `centre` + x `u` + y `v`; the front is where `normal` points.
#[derive(Clone, Copy, Debug)]
pub struct Flat {
    /// The middle.
    pub centre: DVec3,
    /// Half the width.
    pub u: DVec3,
    /// Half the height.
    pub v: DVec3,
    /// Unit normal of the side that shines.
    pub normal: DVec3,
}

impl Flat {
    /// The point at x, y, which are from −1 to 1 for rectangles.
    #[must_use]
    pub fn at(&self, [x, y]: [f64; 2]) -> DVec3 {
        self.centre + self.u * x + self.v * y
    }
}

/// The shape of a light; it shines with the same radiance everywhere and in every direction.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub enum Shape {
    /// The points with x, y from −1 to 1.
    Rectangle(Flat),
    /// The points with x² + y² ≤ 1; u and v must be perpendicular and of equal length.
    Disk(Flat),
    /// A triangle, anticlockwise as seen from the side that shines.
    Triangle([DVec3; 3]),
    /// The outside of a sphere.
    Sphere {
        /// The centre.
        centre: DVec3,
        /// The radius.
        radius: f64,
    },
}

/// A light with an area.
#[derive(Clone, Copy, Debug)]
pub struct Source {
    /// The shape.
    pub shape: Shape,
    /// The light's own primitive in the world, which doesn't block it, or [`NO_PRIMITIVE`].
    pub primitive: u32,
}

/// A light as seen from a receiver: the outline of its visible side, relative to the receiver.
#[derive(Clone, Copy, Debug)]
pub(super) struct Seen {
    corners: [DVec3; 4],
    count: usize,
    /// Unit normal away from the receiver, and distance, of the outline's plane.
    pub(super) normal: DVec3,
    pub(super) distance: f64,
    /// The round light within the corners.
    pub(super) circle: Option<Circle>,
}

/// How far from a disk's middle the sides of the square around it are, in radii: the square doesn't touch it.
const AROUND: f64 = 1.0625;

impl Seen {
    /// The light as seen from a position; `None` from behind, within its plane, or within a sphere.
    pub(super) fn new(shape: &Shape, position: DVec3) -> Option<Self> {
        match shape {
            Shape::Rectangle(flat) => {
                let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]].map(|c| flat.at(c) - position);
                let normal = -flat.normal;
                let distance = normal.dot(flat.centre - position);
                (distance > 0.0).then_some(Self { corners, count: 4, normal, distance, circle: None })
            }
            Shape::Triangle([a, b, c]) => {
                let normal = (*c - *a).cross(*b - *a).try_normalize()?;
                let distance = normal.dot(*a - position);
                let corners = [*a - position, *b - position, *c - position, *c - position];
                (distance > 0.0).then_some(Self { corners, count: 3, normal, distance, circle: None })
            }
            Shape::Disk(flat) => {
                let (centre, normal) = (flat.centre - position, -flat.normal);
                let distance = normal.dot(centre);
                Self::round(Circle { centre, u: flat.u, v: flat.v, normal, distance })
            }
            Shape::Sphere { centre, radius } => {
                let centre = *centre - position;
                if centre.length() > *radius { Self::round(cap(centre, *radius)) } else { None }
            }
        }
    }

    fn round(circle: Circle) -> Option<Self> {
        let Circle { centre, u, v, normal, distance } = circle;
        let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]]
            .map(|[x, y]: [f64; 2]| centre + u * (AROUND * x) + v * (AROUND * y));
        (distance > 0.0).then_some(Self { corners, count: 4, normal, distance, circle: Some(circle) })
    }

    /// The middle of the light.
    pub(super) fn middle(&self) -> DVec3 {
        match (&self.circle, self.count) {
            (Some(circle), _) => circle.centre,
            (None, 3) => (self.corners[0] + self.corners[1] + self.corners[2]) / 3.0,
            (None, _) => (self.corners[0] + self.corners[2]) / 2.0,
        }
    }

    /// Corners of the light's polygon, or around the round light.
    pub(super) fn corners(&self) -> &[DVec3] {
        self.corners.get(..self.count).unwrap_or_default()
    }
}

/// The vector in the precision of rays.
pub(crate) fn single(v: DVec3) -> Vec3A {
    v.as_vec3a()
}
