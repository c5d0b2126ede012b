//! The surfaces a [`World`](super::World) is built from: triangle meshes, parallelograms, disks and spheres.

use glam::{DVec3, Vec3A};

use super::GeometryError;

/// The largest coordinate accepted, in scene units: the cubes of lengths that the triangle test forms stay finite.
pub const MAX_COORDINATE: f32 = 1e12;

/// Areas below this fraction of the product of the edge lengths are zero to the rounding of `f64`.
const RELATIVE_ZERO_AREA: f64 = 4.0 * f64::EPSILON;

/// An indexed triangle mesh, in scene units; the front of a triangle sees its vertices counter-clockwise.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// Vertex positions.
    pub positions: Vec<Vec3A>,
    /// Three vertex indices a triangle.
    pub triangles: Vec<[u32; 3]>,
    /// One normal a vertex (any length but zero), interpolated for shading; empty: the geometric normals are used.
    pub normals: Vec<Vec3A>,
}

impl Mesh {
    /// The mesh with vertex normals that are the mean of the adjacent faces' normals weighted by their angles
    /// (Thürmer & Wüthrich 1998). A vertex without such a mean keeps the normal of one of its faces, an unused one +z.
    #[must_use]
    pub fn with_smooth_normals(mut self) -> Self {
        let mut sums = vec![DVec3::ZERO; self.positions.len()];
        let mut fallback = vec![DVec3::Z; self.positions.len()];
        for triangle in &self.triangles {
            let corner = triangle.map(|i| self.positions.get(i as usize).map(|p| p.as_dvec3()));
            let [Some(a), Some(b), Some(c)] = corner else { continue };
            let normal = (b - a).cross(c - a).normalize_or_zero();
            for (index, (p, q, r)) in triangle.iter().zip([(a, b, c), (b, c, a), (c, a, b)]) {
                sums[*index as usize] += normal * (q - p).angle_between(r - p);
                fallback[*index as usize] = normal;
            }
        }
        let smooth =
            |(sum, face): (&DVec3, &DVec3)| sum.try_normalize().unwrap_or(*face).as_vec3a();
        self.normals = sums.iter().zip(&fallback).map(smooth).collect();
        self
    }

    /// The mesh without vertex normals, so that every face is shaded flat.
    #[must_use]
    pub fn with_face_normals(mut self) -> Self {
        self.normals.clear();
        self
    }

    fn check(&self, surface: usize) -> Result<(), GeometryError> {
        for (element, position) in self.positions.iter().enumerate() {
            check_coordinates(*position, surface, element)?;
        }
        if !self.normals.is_empty() && self.normals.len() != self.positions.len() {
            return Err(GeometryError::BadNormals { surface, element: self.normals.len() });
        }
        for (element, normal) in self.normals.iter().enumerate() {
            if normal.as_dvec3().try_normalize().is_none() {
                return Err(GeometryError::BadNormals { surface, element });
            }
        }
        for (element, triangle) in self.triangles.iter().enumerate() {
            let corner = triangle.map(|i| self.positions.get(i as usize).map(|p| p.as_dvec3()));
            let [Some(a), Some(b), Some(c)] = corner else {
                return Err(GeometryError::BadIndex { surface, element });
            };
            check_area(b - a, c - a, surface, element)?;
        }
        Ok(())
    }
}

/// The parallelogram `corner + u·edge_u + v·edge_v` for u, v ∈ [0, 1], in scene units; its front is where
/// `edge_u × edge_v` points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parallelogram {
    /// The corner at u = v = 0.
    pub corner: Vec3A,
    /// The edge along which u goes from 0 to 1.
    pub edge_u: Vec3A,
    /// The edge along which v goes from 0 to 1.
    pub edge_v: Vec3A,
}

impl Parallelogram {
    /// The four corners in order around the edge, rounded once to `f32`: the vertices that rays are tested against.
    #[must_use]
    pub fn corners(&self) -> [Vec3A; 4] {
        let [p, u, v] = [self.corner, self.edge_u, self.edge_v].map(Vec3A::as_dvec3);
        [self.corner, (p + u).as_vec3a(), (p + u + v).as_vec3a(), (p + v).as_vec3a()]
    }
}

/// The disk or ellipse `centre + a·axis_u + b·axis_v` for a² + b² ≤ 1, in scene units; its front is where
/// `axis_u × axis_v` points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Disk {
    /// The centre.
    pub centre: Vec3A,
    /// A radius, from the centre to the rim.
    pub axis_u: Vec3A,
    /// The conjugate radius; for a disk of the same length as the other and perpendicular to it.
    pub axis_v: Vec3A,
}

impl Disk {
    /// The round disk whose front faces along `normal` (of any length but zero).
    #[must_use]
    pub fn new(centre: Vec3A, normal: Vec3A, radius: f32) -> Self {
        let (u, v) = normal.normalize_or(Vec3A::Z).any_orthonormal_pair();
        Self { centre, axis_u: u * radius, axis_v: v * radius }
    }
}

/// A sphere, in scene units; its front is the outside, or the inside when `inward`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sphere {
    /// The centre.
    pub centre: Vec3A,
    /// The radius; positive.
    pub radius: f32,
    /// Whether the normals point to the centre.
    pub inward: bool,
}

/// One surface of a scene.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Surface {
    /// A triangle mesh: as many primitives as triangles.
    Mesh(Mesh),
    /// A parallelogram: one primitive.
    Parallelogram(Parallelogram),
    /// A disk or ellipse: one primitive.
    Disk(Disk),
    /// A sphere: one primitive.
    Sphere(Sphere),
}

impl Surface {
    /// Refuses NaN, infinite and huge coordinates, wrong indices and zero areas; `surface` is what errors will name.
    ///
    /// # Errors
    /// A [`GeometryError`] with the indices of the first fault.
    pub fn check(&self, surface: usize) -> Result<(), GeometryError> {
        match self {
            Self::Mesh(mesh) => mesh.check(surface),
            Self::Parallelogram(p) => {
                p.corners().iter().try_for_each(|x| check_coordinates(*x, surface, 0))?;
                check_area(p.edge_u.as_dvec3(), p.edge_v.as_dvec3(), surface, 0)?;
                let [a, b, c, d] = p.corners().map(Vec3A::as_dvec3);
                check_area(b - a, c - a, surface, 0)?;
                check_area(c - a, d - a, surface, 0)
            }
            Self::Disk(disk) => {
                for x in [disk.centre, disk.axis_u, disk.axis_v] {
                    check_coordinates(x, surface, 0)?;
                }
                check_area(disk.axis_u.as_dvec3(), disk.axis_v.as_dvec3(), surface, 0)
            }
            Self::Sphere(sphere) => {
                check_coordinates(sphere.centre, surface, 0)?;
                check_coordinates(Vec3A::splat(sphere.radius), surface, 0)?;
                if sphere.radius > 0.0 {
                    Ok(())
                } else {
                    Err(GeometryError::ZeroArea { surface, element: 0 })
                }
            }
        }
    }
}

fn check_coordinates(x: Vec3A, surface: usize, element: usize) -> Result<(), GeometryError> {
    if x.abs().cmple(Vec3A::splat(MAX_COORDINATE)).all() {
        Ok(())
    } else {
        Err(GeometryError::BadCoordinate { surface, element })
    }
}

fn check_area(u: DVec3, v: DVec3, surface: usize, element: usize) -> Result<(), GeometryError> {
    let area = u.cross(v).length();
    if area > RELATIVE_ZERO_AREA * u.length() * v.length() {
        Ok(())
    } else {
        Err(GeometryError::ZeroArea { surface, element })
    }
}
