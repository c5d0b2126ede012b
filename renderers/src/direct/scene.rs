//! From a scene's data to what direct light needs.

use glam::DVec3;

use super::source::{Flat, Shape, Source, single};
use crate::geometry::{self, Disk, GeometryError, Parallelogram, Sphere, Surface, World};
use crate::scene::{self, Geometry, Scene};

/// The surfaces of a scene for rays; shapes are numbered as in the scene.
///
/// # Errors
/// What [`World::new`] refuses.
pub fn world(scene: &Scene) -> Result<World, GeometryError> {
    let surfaces: Vec<_> = (0..).zip(&scene.shapes).map(|(number, shape)| (number, surface(&shape.geometry))).collect();
    World::new(&surfaces)
}

/// The sources that the front of a shape is made of; `first` is the number of its first primitive. `None` for spheres that shine inwards.
#[must_use]
pub fn sources(shape: &scene::Shape, first: u32) -> Option<Vec<Source>> {
    let one = |shape| Some(vec![Source { shape, primitive: first }]);
    match &shape.geometry {
        Geometry::Rectangle { center, half_u, half_v, normal } => {
            one(Shape::Rectangle(Flat { centre: *center, u: *half_u, v: *half_v, normal: *normal }))
        }
        Geometry::Disk { center, radius, normal } => {
            let (u, v): (DVec3, DVec3) = normal.any_orthonormal_pair();
            one(Shape::Disk(Flat { centre: *center, u: u * *radius, v: v * *radius, normal: *normal }))
        }
        Geometry::Sphere { center, radius, inward: false, .. } => {
            one(Shape::Sphere { centre: *center, radius: *radius })
        }
        Geometry::Sphere { inward: true, .. } => None,
        Geometry::Mesh(mesh) => {
            let triangle = |(primitive, i)| Source { shape: Shape::Triangle(mesh.corners(i)), primitive };
            Some((first..).zip(0..mesh.triangles.len()).map(triangle).collect())
        }
    }
}

#[allow(clippy::cast_possible_truncation, reason = "rays are traced in f32")]
pub(crate) fn surface(geometry: &Geometry) -> Surface {
    match geometry {
        Geometry::Rectangle { center, half_u, half_v, normal } => {
            // The front is where the edges' cross product points.
            let (u, v) = if half_u.cross(*half_v).dot(*normal) >= 0.0 { (half_u, half_v) } else { (half_v, half_u) };
            Surface::Parallelogram(Parallelogram {
                corner: single(*center - *u - *v),
                edge_u: single(*u * 2.0),
                edge_v: single(*v * 2.0),
            })
        }
        Geometry::Disk { center, radius, normal } => {
            Surface::Disk(Disk::new(single(*center), single(*normal), *radius as f32))
        }
        Geometry::Sphere { center, radius, inward, .. } => {
            Surface::Sphere(Sphere { centre: single(*center), radius: *radius as f32, inward: *inward })
        }
        Geometry::Mesh(mesh) => Surface::Mesh(geometry::Mesh {
            positions: mesh.positions.iter().map(|p| single(*p)).collect(),
            triangles: mesh.triangles.clone(),
            normals: mesh.normals.iter().flatten().map(|n| single(*n)).collect(),
        }),
    }
}
