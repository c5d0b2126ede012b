//! Mirrors and glass as what lights aim at.

use glam::{DVec3, Vec3A};

use super::trace::mirrored;
use crate::direct::single;
use crate::geometry::World;
use crate::geometry::sampling::square_to_disk;
use crate::material::Material;
use crate::scene::{Geometry, Shape};

/// A shape with a mirror or glass on one of its sides.
#[derive(Clone, Debug)]
pub(super) struct Target {
    pub(super) body: Body,
    /// How much of the light is mirrored or let through on the front and on the back.
    pub(super) sides: [f64; 2],
}

/// What a target is made of.
#[derive(Clone, Debug)]
pub(super) enum Body {
    /// A sphere.
    Ball(Ball),
    /// Everything else.
    Facets(Vec<Facet>),
}

/// A sphere as rays see it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ball {
    pub(super) centre: DVec3,
    pub(super) radius: f64,
    pub(super) primitive: u32,
}

/// A flat primitive as rays see it: its points are `corner` + a `u` + b `v`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Facet {
    pub(super) corner: DVec3,
    pub(super) u: DVec3,
    pub(super) v: DVec3,
    pub(super) normal: DVec3,
    pub(super) area: f64,
    pub(super) primitive: u32,
    outline: Outline,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Outline {
    Triangle,
    Parallelogram,
    Disk,
}

impl Target {
    /// The shape with this number in the scene; `None` if nothing of it is a mirror or glass.
    pub(super) fn new(shape: &Shape, number: usize, material: &Material, world: &World) -> Option<Self> {
        let sides = [true, false].map(|front| material.side(front).map_or(0.0, mirrored));
        if sides == [0.0; 2] {
            return None;
        }
        let first = world.primitives(number).start;
        Some(Self { body: Body::new(&shape.geometry, first), sides })
    }

    /// The share of light that is mirrored or let through on a side.
    pub(super) fn side(&self, front: bool) -> f64 {
        self.sides[usize::from(!front)]
    }
}

impl Body {
    fn new(geometry: &Geometry, first: u32) -> Self {
        match geometry {
            Geometry::Sphere { center, radius, .. } => {
                #[allow(clippy::cast_possible_truncation, reason = "rays see it rounded")]
                let radius = f64::from(*radius as f32);
                Self::Ball(Ball { centre: rounded(*center), radius, primitive: first })
            }
            Geometry::Rectangle { center, half_u, half_v, normal } => {
                let corner = rounded(*center - *half_u - *half_v);
                let [u, v] = [half_u, half_v].map(|half| rounded(*half * 2.0));
                Self::facet(corner, u, v, *normal, first, Outline::Parallelogram)
            }
            Geometry::Disk { center, radius, normal } => {
                let (u, v) = single(*normal).normalize_or(Vec3A::Z).any_orthonormal_pair();
                let [u, v] = [u, v].map(|axis| axis.as_dvec3() * *radius);
                Self::facet(rounded(*center), u, v, *normal, first, Outline::Disk)
            }
            Geometry::Mesh(mesh) => {
                let triangle = |(primitive, number): (u32, usize)| {
                    let [a, b, c] = mesh.corners(number).map(rounded);
                    Facet::new(a, b - a, c - a, DVec3::ZERO, primitive, Outline::Triangle)
                };
                Self::Facets((first..).zip(0..mesh.triangles.len()).map(triangle).collect())
            }
        }
    }

    fn facet(corner: DVec3, u: DVec3, v: DVec3, normal: DVec3, primitive: u32, outline: Outline) -> Self {
        Self::Facets(vec![Facet::new(corner, u, v, normal, primitive, outline)])
    }
}

impl Facet {
    /// `towards` says to which side the normal points; where it is zero, that is `u` × `v`.
    fn new(corner: DVec3, u: DVec3, v: DVec3, towards: DVec3, primitive: u32, outline: Outline) -> Self {
        let cross = u.cross(v);
        let share = match outline {
            Outline::Triangle => 0.5,
            Outline::Parallelogram => 1.0,
            Outline::Disk => core::f64::consts::PI,
        };
        let normal = cross.normalize_or_zero() * if cross.dot(towards) < 0.0 { -1.0 } else { 1.0 };
        Self { corner, u, v, normal, area: cross.length() * share, primitive, outline }
    }

    /// The point for a point of the unit square: areas are all magnified alike.
    #[allow(clippy::cast_possible_truncation, reason = "the map to the disk is f32")]
    pub(super) fn at(&self, [s, t]: [f64; 2]) -> DVec3 {
        let [a, b] = match self.outline {
            Outline::Parallelogram => [s, t],
            // Heitz 2019, as `square_to_triangle`.
            Outline::Triangle if t > s => [s / 2.0, t - s / 2.0],
            Outline::Triangle => [s - t / 2.0, t / 2.0],
            Outline::Disk => square_to_disk([s as f32, t as f32]).as_dvec2().to_array(),
        };
        self.corner + self.u * a + self.v * b
    }

    /// An upper bound of the diameter of a part that is so large a square of the unit square.
    pub(super) fn diameter(&self, square: f64) -> f64 {
        let stretch = if self.outline == Outline::Disk { 3.0 } else { 1.0 };
        (self.u.length() + self.v.length()) * stretch * square
    }
}

/// The point as rays see it.
fn rounded(point: DVec3) -> DVec3 {
    single(point).as_dvec3()
}
