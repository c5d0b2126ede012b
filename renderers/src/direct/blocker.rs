//! What may stand between a receiver and a light, and the cone that it hides.

use glam::DVec3;

use super::contour::Circle;
use crate::scene::{Geometry, Scene};

/// Blockers whose plane is so near to the light's, relative to the light's distance, lie in it and hide nothing.
const TOUCH: f64 = 1e-9;

/// A surface of a scene in the precision that the scene gives it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Blocker {
    Triangle([DVec3; 3]),
    Rectangle([DVec3; 4]),
    Disk { centre: DVec3, radius: f64, normal: DVec3 },
    Sphere { centre: DVec3, radius: f64 },
}

/// All surfaces of a scene as blockers, numbered as the primitives of its [`World`](crate::geometry::World).
#[derive(Clone, Debug, Default)]
pub struct Blockers(Vec<Blocker>);

impl Blockers {
    /// The surfaces of a scene.
    #[must_use]
    pub fn new(scene: &Scene) -> Self {
        let mut all = Vec::new();
        for shape in &scene.shapes {
            match &shape.geometry {
                Geometry::Rectangle { center, half_u, half_v, .. } => {
                    let corner = |x: f64, y: f64| *center + *half_u * x + *half_v * y;
                    let corners = [corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)];
                    all.push(Blocker::Rectangle(corners));
                }
                Geometry::Disk { center, radius, normal } => {
                    all.push(Blocker::Disk { centre: *center, radius: *radius, normal: *normal });
                }
                Geometry::Sphere { center, radius, .. } => {
                    all.push(Blocker::Sphere { centre: *center, radius: *radius });
                }
                Geometry::Mesh(mesh) => {
                    all.extend((0..mesh.triangles.len()).map(|i| Blocker::Triangle(mesh.corners(i))));
                }
            }
        }
        Self(all)
    }

    pub(super) fn get(&self, primitive: u32) -> Option<&Blocker> {
        self.0.get(primitive as usize)
    }

    /// Whether a primitive is a polygon.
    pub(super) fn is_flat_sided(&self, primitive: u32) -> bool {
        matches!(self.get(primitive), Some(Blocker::Triangle(_) | Blocker::Rectangle(_)))
    }
}

/// A light's plane as seen from the receiver: its unit normal away from the receiver, its distance, and corners around the light relative
/// to the receiver.
#[derive(Clone, Copy, Debug)]
pub(super) struct Target<'a> {
    pub(super) normal: DVec3,
    pub(super) distance: f64,
    pub(super) corners: &'a [DVec3],
}

/// What a blocker does to a light.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Effect {
    /// Nothing.
    None,
    /// It hides what is within the planes.
    Cone,
    /// It has no exact planes.
    Unknown,
}

/// How a round blocker's outline is taken.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Outline {
    /// By a regular polygon with so many corners within it.
    Inscribed(u32),
    /// By a regular polygon with so many corners around it.
    Circumscribed(u32),
}

impl Blocker {
    /// Fills `planes` with the unit normals of the planes through the receiver at `position` that bound what is hidden of the target; they
    /// point inwards. A blocker whose plane is within `contact` of the receiver touches it and hides nothing: the receiver is on its near side.
    pub(super) fn cone(
        &self,
        position: DVec3,
        contact: f64,
        target: &Target<'_>,
        outline: Outline,
        planes: &mut Vec<DVec3>,
    ) -> Effect {
        planes.clear();
        match self {
            Self::Triangle(corners) => polygon_cone(&corners.map(|c| c - position), contact, target, planes),
            Self::Rectangle(corners) => polygon_cone(&corners.map(|c| c - position), contact, target, planes),
            Self::Disk { centre, radius, normal } => {
                let (u, v) = normal.any_orthonormal_pair();
                let corners = outline.corners(*centre - position, u * *radius, v * *radius);
                polygon_cone(&corners, contact, target, planes)
            }
            Self::Sphere { centre, radius } => {
                let centre = *centre - position;
                let distance = centre.length();
                if (distance - radius).abs() <= contact {
                    // It hides no more than its tangential plane does.
                    return Effect::None;
                }
                if distance < *radius || target.comes_within(centre, *radius) {
                    return Effect::Unknown;
                }
                let Circle { centre, u, v, .. } = cap(centre, *radius);
                polygon_cone(&outline.corners(centre, u, v), contact, target, planes)
            }
        }
    }
}

impl Outline {
    fn corners(self, centre: DVec3, u: DVec3, v: DVec3) -> Vec<DVec3> {
        let (count, stretched) = match self {
            Self::Inscribed(count) => (count, false),
            Self::Circumscribed(count) => (count, true),
        };
        let step = core::f64::consts::TAU / f64::from(count);
        let radius = if stretched { 1.0 / (0.5 * step).cos() } else { 1.0 };
        let corner = |i: u32| {
            let (sin, cos) = (step * f64::from(i)).sin_cos();
            centre + u * (radius * cos) + v * (radius * sin)
        };
        (0..count).map(corner).collect()
    }
}

impl Target<'_> {
    /// A target beyond everything.
    pub(super) const INFINITE: Self = Self { normal: DVec3::ZERO, distance: f64::INFINITY, corners: &[] };

    /// Whether the light's plane comes within a radius of a point, where the light may be.
    fn comes_within(&self, point: DVec3, radius: f64) -> bool {
        if self.corners.is_empty() {
            return false;
        }
        let furthest = self.corners.iter().fold(0.0_f64, |r, c| r.max(c.distance(self.middle())));
        (self.normal.dot(point) - self.distance).abs() < radius && point.distance(self.middle()) < radius + furthest
    }

    fn middle(&self) -> DVec3 {
        #[allow(clippy::cast_precision_loss, reason = "a few corners")]
        let count = self.corners.len() as f64;
        self.corners.iter().sum::<DVec3>() / count
    }
}

/// The circle that bounds the cap of a sphere seen from the origin, which fills the same cone; the origin must be outside.
pub(super) fn cap(centre: DVec3, radius: f64) -> Circle {
    let distance = centre.length();
    let axis = centre / distance;
    let share = radius / distance;
    let (u, v) = axis.any_orthonormal_pair();
    let across = radius * ((1.0 - share) * (1.0 + share)).sqrt();
    let along = distance - radius * share;
    Circle { centre: axis * along, u: u * across, v: v * across, normal: axis, distance: along }
}

fn polygon_cone(corners: &[DVec3], contact: f64, target: &Target<'_>, planes: &mut Vec<DVec3>) -> Effect {
    let [a, b, c, ..] = *corners else { return Effect::None };
    let Some(normal) = (b - a).cross(c - a).try_normalize() else { return Effect::None };
    let signed = normal.dot(a);
    let distance = signed.abs();
    if !(distance > contact) {
        return Effect::None;
    }
    let normal = if signed < 0.0 { -normal } else { normal };
    // What is hidden is beyond the blocker.
    let margin = TOUCH * target.distance;
    let (mut all_before, mut all_beyond) = (true, true);
    for corner in target.corners {
        let beyond = normal.dot(*corner) - distance;
        all_before &= beyond <= margin;
        all_beyond &= beyond >= 0.0;
    }
    // A target without corners is beyond everything.
    if all_before && !target.corners.is_empty() {
        return Effect::None;
    }
    if !all_beyond {
        match (normal * target.distance - target.normal * distance).try_normalize() {
            Some(plane) => planes.push(plane),
            None => return Effect::None,
        }
    }
    let Some(mut before) = corners.last().copied() else { return Effect::None };
    for corner in corners {
        // The same two corners give the same plane, turned round, wherever they meet again.
        if let Some(plane) = before.cross(*corner).try_normalize() {
            planes.push(if signed < 0.0 { -plane } else { plane });
        }
        before = *corner;
    }
    Effect::Cone
}
