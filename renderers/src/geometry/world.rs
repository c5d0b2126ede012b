//! The world: every surface of a scene, behind one hierarchy.

use core::ops::Range;

use glam::{DVec3, Vec3A};

use super::GeometryError;
use super::bvh::{Bvh, Item, RawHit};
use super::packet::{Refined, SECOND_HALF};
use super::ray::{Hit, NO_PRIMITIVE, Ray, SurfacePoint};
use super::round::{DiskFrame, Round};
use super::surface::Surface;

/// What is known of a primitive beside its geometry.
#[derive(Clone, Copy, Debug)]
struct Primitive {
    shape: u32,
    /// Index of its three vertex normals, or [`NO_PRIMITIVE`].
    normals: u32,
    kind: Kind,
    area: f64,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Kind {
    Triangle,
    Parallelogram,
    Disk,
    Sphere,
}

/// All surfaces of a scene, ready for rays.
///
/// Primitives are numbered in the order of the surfaces given: one for each triangle of a mesh, one for each other
/// surface. Triangles that share an edge, and the triangles a parallelogram is made of, let no ray through between them.
#[derive(Clone, Debug)]
pub struct World {
    bvh: Bvh,
    primitives: Vec<Primitive>,
    vertex_normals: Vec<[Vec3A; 3]>,
    ranges: Vec<Range<u32>>,
}

impl World {
    /// Builds the world from surfaces, each with the identifier that its hits will carry.
    ///
    /// # Errors
    /// The first fault that [`Surface::check`] finds, or [`GeometryError::TooManyPrimitives`].
    pub fn new(surfaces: &[(u32, Surface)]) -> Result<Self, GeometryError> {
        let mut parts = Parts::default();
        for (index, (shape, surface)) in surfaces.iter().enumerate() {
            surface.check(index)?;
            parts.add(*shape, surface)?;
        }
        let bvh = Bvh::build(&parts.items).ok_or(GeometryError::TooManyPrimitives)?;
        Ok(Self {
            bvh,
            primitives: parts.primitives,
            vertex_normals: parts.vertex_normals,
            ranges: parts.ranges,
        })
    }

    /// The first hit with 0 ≤ t < `t_max`, or `None`. A ray with a NaN hits nothing.
    #[inline]
    #[must_use]
    pub fn closest_hit(&self, ray: &Ray) -> Option<Hit> {
        self.bvh.closest(ray).map(|raw| self.refine(ray, &raw))
    }

    /// Whether anything is hit with 0 ≤ t < `t_max`.
    #[inline]
    #[must_use]
    pub fn any_hit(&self, ray: &Ray) -> bool {
        self.bvh.any(ray)
    }

    /// Whether anything blocks the way between two points on surfaces; those surfaces themselves, at the points, don't.
    #[inline]
    #[must_use]
    pub fn occluded(&self, from: &SurfacePoint, to: &SurfacePoint) -> bool {
        self.bvh.any(&from.ray_between(to))
    }

    /// Whether anything blocks the way from a point on a surface to one on none, such as a point light.
    #[inline]
    #[must_use]
    pub fn occluded_point(&self, from: &SurfacePoint, target: Vec3A) -> bool {
        self.bvh.any(&from.ray_to(target))
    }

    /// Whether anything blocks the way from a point on a surface to infinity, such as a directional light.
    #[inline]
    #[must_use]
    pub fn occluded_direction(&self, from: &SurfacePoint, direction: Vec3A) -> bool {
        self.bvh.any(&from.ray(direction))
    }

    /// The corners of the axis-aligned box around everything, in scene units; both zero for an empty world.
    #[must_use]
    pub fn bounds(&self) -> [Vec3A; 2] {
        self.bvh.bounds()
    }

    /// How many primitives there are.
    #[must_use]
    pub fn len(&self) -> usize {
        self.primitives.len()
    }

    /// Whether there is nothing to hit.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.primitives.is_empty()
    }

    /// The primitives of the surface with this index in the list given to [`new`](Self::new); empty beyond the list.
    #[must_use]
    pub fn primitives(&self, surface: usize) -> Range<u32> {
        self.ranges.get(surface).cloned().unwrap_or(0..0)
    }

    /// The identifier of the surface that a primitive belongs to, if there is such a primitive.
    #[must_use]
    pub fn shape(&self, primitive: u32) -> Option<u32> {
        self.primitives.get(primitive as usize).map(|p| p.shape)
    }

    /// The area of a primitive, in square scene units; 0 if there is none.
    #[must_use]
    pub fn area(&self, primitive: u32) -> f64 {
        self.primitives.get(primitive as usize).map_or(0.0, |p| p.area)
    }

    /// The area of everything, in square scene units.
    #[must_use]
    pub fn total_area(&self) -> f64 {
        self.primitives.iter().map(|p| p.area).sum()
    }

    /// Checks that every primitive is in the hierarchy and that every box holds its contents.
    ///
    /// # Errors
    /// [`GeometryError::BrokenHierarchy`] if not.
    pub fn validate(&self) -> Result<(), GeometryError> {
        let count =
            u32::try_from(self.primitives.len()).map_err(|_| GeometryError::TooManyPrimitives)?;
        if self.bvh.is_consistent(count) { Ok(()) } else { Err(GeometryError::BrokenHierarchy) }
    }

    fn refine(&self, ray: &Ray, raw: &RawHit) -> Hit {
        match *raw {
            RawHit::Triangle(packet, hit) => {
                let packet = self.bvh.packet(packet);
                let second = packet.is_second_half(hit.lane);
                self.refine_triangle(
                    ray,
                    packet.triangle(hit.lane),
                    packet.primitive(hit.lane),
                    second,
                )
            }
            RawHit::Round(index, t) => {
                let (round, primitive) = self.bvh.round(index);
                let hit = round.hit(ray, t);
                self.hit(
                    ray,
                    *primitive,
                    &Precise { t: hit.t, position: hit.position, normal: hit.normal, uv: hit.uv },
                )
            }
        }
    }

    fn refine_triangle(
        &self,
        ray: &Ray,
        triangle: [Vec3A; 3],
        primitive: u32,
        second_half: bool,
    ) -> Hit {
        let refined = Refined::new(ray, triangle);
        let vertices = triangle.map(|v| v.as_dvec3());
        let weights = keep_off_edges(refined.weights, &vertices, refined.normal);
        let [_, b, c] = weights;
        let position =
            vertices[0] + (vertices[1] - vertices[0]) * b + (vertices[2] - vertices[0]) * c;
        let record = &self.primitives[primitive as usize];
        let uv = match (record.kind, second_half) {
            (Kind::Parallelogram, false) => [b + c, c],
            (Kind::Parallelogram, true) => [b, b + c],
            _ => [b, c],
        };
        let precise = Precise { t: refined.t, position, normal: refined.normal.normalize(), uv };
        let mut hit = self.hit(ray, primitive, &precise);
        if let Some(normals) = self.vertex_normals.get(record.normals as usize) {
            let sum = (0..3).fold(DVec3::ZERO, |sum, i| sum + normals[i].as_dvec3() * weights[i]);
            hit.shading_normal = sum.try_normalize().map_or(hit.geometric_normal, |n| n.as_vec3a());
        }
        hit
    }

    #[inline]
    #[allow(clippy::cast_possible_truncation, reason = "the results are wanted in f32")]
    fn hit(&self, ray: &Ray, primitive: u32, precise: &Precise) -> Hit {
        let record = &self.primitives[primitive as usize];
        let position = precise.position.as_vec3a();
        let geometric_normal = precise.normal.as_vec3a();
        Hit {
            t: precise.t as f32,
            primitive,
            shape: record.shape,
            position,
            error: f32::EPSILON * position.abs().max_element(),
            geometric_normal,
            shading_normal: geometric_normal,
            uv: precise.uv.map(|x| x.clamp(0.0, 1.0) as f32),
            front: precise.normal.dot(ray.direction.as_dvec3()) < 0.0,
            planar: record.kind != Kind::Sphere,
        }
    }
}

/// A hit in `f64`.
struct Precise {
    t: f64,
    position: DVec3,
    normal: DVec3,
    uv: [f64; 2],
}

/// Moves a point that is nearer to an edge than the rounding of its `f32` coordinates off that edge, so that it is on
/// the right side of what stands on the edge. `normal` is twice the area long.
fn keep_off_edges(weights: [f64; 3], vertices: &[DVec3; 3], normal: DVec3) -> [f64; 3] {
    let [a, b, c] = *vertices;
    let lengths =
        [(c - b).abs().element_sum(), (a - c).abs().element_sum(), (b - a).abs().element_sum()];
    let size = a.abs().max(b.abs()).max(c.abs()).max_element();
    let error = 2.0 * f64::from(f32::EPSILON) * size;
    let scale = error / normal.abs().max_element();
    let least: [f64; 3] = core::array::from_fn(|i| (lengths[i] * scale).min(0.1));
    if (0..3).all(|i| weights[i] >= least[i]) {
        return weights;
    }
    let raised: [f64; 3] = core::array::from_fn(|i| weights[i].max(least[i]));
    let sum: f64 = raised.iter().sum();
    raised.map(|w| w / sum)
}

/// The parts of a world under construction.
#[derive(Default)]
struct Parts {
    items: Vec<Item>,
    primitives: Vec<Primitive>,
    vertex_normals: Vec<[Vec3A; 3]>,
    ranges: Vec<Range<u32>>,
}

impl Parts {
    fn add(&mut self, shape: u32, surface: &Surface) -> Result<(), GeometryError> {
        let start = self.next()?;
        match surface {
            Surface::Mesh(mesh) => {
                for triangle in &mesh.triangles {
                    let vertices = triangle.map(|i| mesh.positions[i as usize]);
                    let normals = if mesh.normals.is_empty() {
                        NO_PRIMITIVE
                    } else {
                        let index =
                            u32::try_from(self.vertex_normals.len()).unwrap_or(NO_PRIMITIVE);
                        let unit =
                            |i: u32| mesh.normals[i as usize].as_dvec3().normalize().as_vec3a();
                        self.vertex_normals.push(triangle.map(unit));
                        index
                    };
                    let tag = self.next()?;
                    self.items.push(Item::Triangle(vertices, tag));
                    self.primitives.push(Primitive {
                        shape,
                        normals,
                        kind: Kind::Triangle,
                        area: area(vertices),
                    });
                }
            }
            Surface::Parallelogram(parallelogram) => {
                let [a, b, c, d] = parallelogram.corners();
                let halves = [[a, b, c], [a, c, d]];
                self.items.push(Item::Triangle(halves[0], start));
                self.items.push(Item::Triangle(halves[1], start | SECOND_HALF));
                let area = halves.map(area).iter().sum();
                self.primitives.push(Primitive {
                    shape,
                    normals: NO_PRIMITIVE,
                    kind: Kind::Parallelogram,
                    area,
                });
            }
            Surface::Disk(disk) => {
                self.add_round(shape, Round::Disk(DiskFrame::new(disk)), Kind::Disk, start)
            }
            Surface::Sphere(sphere) => {
                self.add_round(shape, Round::Sphere(*sphere), Kind::Sphere, start)
            }
        }
        self.ranges.push(start..self.next()?);
        Ok(())
    }

    fn add_round(&mut self, shape: u32, round: Round, kind: Kind, index: u32) {
        self.items.push(Item::Round(round, index));
        self.primitives.push(Primitive { shape, normals: NO_PRIMITIVE, kind, area: round.area() });
    }

    /// The index of the next primitive.
    fn next(&self) -> Result<u32, GeometryError> {
        match u32::try_from(self.primitives.len()) {
            Ok(index) if index < SECOND_HALF => Ok(index),
            _ => Err(GeometryError::TooManyPrimitives),
        }
    }
}

fn area(triangle: [Vec3A; 3]) -> f64 {
    let [a, b, c] = triangle.map(|v| v.as_dvec3());
    (b - a).cross(c - a).length() / 2.0
}
