//! The world: every surface of a scene, behind one hierarchy.

use core::cmp::Ordering;
use core::ops::Range;

use glam::{DVec3, Vec3A, Vec4};

use super::GeometryError;
use super::bvh::{Bvh, Item, RawHit};
use super::packet::{Exact, Half, PacketHit, Pair};
use super::pairing::pair_up;
use super::ray::{Hit, NO_PRIMITIVE, Ray, SurfacePoint};
use super::round::{DiskFrame, Round};
use super::shaft::{Shaft, ShaftEnd};
use super::surface::{Mesh, Surface};

/// Weights below this many times the smallest allowed are looked at exactly.
const OFF_EDGES: f32 = 16.0;

/// There may be one less.
const MOST_PRIMITIVES: u32 = 1 << 31;

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
    /// With the inverse of its radius, negative if the inside is its front.
    Sphere(f32),
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
    /// For each primitive, the packet and lane that have its vertices.
    places: Vec<Option<(u32, u8)>>,
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
        let bvh = Bvh::build(&parts.items);
        let places = bvh.places(parts.primitives.len());
        Ok(Self {
            bvh,
            primitives: parts.primitives,
            vertex_normals: parts.vertex_normals,
            ranges: parts.ranges,
            places,
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

    /// Whether certainly nothing blocks any of a shaft's rays: those that [`occluded`](Self::occluded) asks about, from points
    /// within one end to points within the other that are above each other's horizon.
    ///
    /// `false` means that something may be in the way. `true` is certain but for rays within some units of the last place of the
    /// horizon of an end, which carry no light, and for those that start or end so near to where another surface touches the
    /// end's edge at less than a right angle: their offset can take them through it.
    #[must_use]
    pub fn shaft_is_clear(&self, shaft: &Shaft) -> bool {
        shaft.is_clear(&self.bvh)
    }

    /// The primitives that may block some of a shaft's rays, in increasing order; `None` if there are more than `most`, or disks and
    /// spheres among them where only `flat` ones will do. All others certainly block none, in the sense of
    /// [`shaft_is_clear`](Self::shaft_is_clear).
    #[must_use]
    pub fn shaft_blockers(&self, shaft: &Shaft, most: usize, flat: bool) -> Option<Vec<u32>> {
        shaft.blockers(&self.bvh, most, flat)
    }

    /// The primitives that may reach into an axis-aligned box, in increasing order: all that do, and some of those beside it.
    #[must_use]
    pub fn primitives_near(&self, low: Vec3A, high: Vec3A) -> Vec<u32> {
        let found = core::cell::RefCell::new(Vec::new());
        self.bvh.any_item(
            |lows, highs| {
                let meets =
                    |axis: usize| lows[axis].cmple(Vec4::splat(high[axis])) & highs[axis].cmpge(Vec4::splat(low[axis]));
                (meets(0) & meets(1) & meets(2)).bitmask()
            },
            |packet| {
                let reaches = |(primitive, [a, b, c]): (u32, [Vec3A; 3])| {
                    let apart = a.min(b).min(c).cmpgt(high) | a.max(b).max(c).cmplt(low);
                    (primitive != NO_PRIMITIVE && !apart.any()).then_some(primitive)
                };
                found.borrow_mut().extend(packet.triangles().filter_map(reaches));
                false
            },
            |_, primitive| {
                found.borrow_mut().push(primitive);
                false
            },
        );
        let mut found = found.into_inner();
        found.sort_unstable();
        found.dedup();
        found
    }

    /// The part of a triangle or parallelogram within an axis-aligned box, seen from the side its normal points to (`front`) or from the
    /// other, as the end of a [`Shaft`]: it holds every point of the primitive whose rounded coordinates are in the box. `None` if
    /// there is no such part, or for other primitives.
    #[must_use]
    pub fn shaft_end(&self, primitive: u32, front: bool, low: DVec3, high: DVec3) -> Option<ShaftEnd> {
        let (packet, lane) = (*self.places.get(primitive as usize)?)?;
        let packet = self.bvh.packet(packet);
        let lane = usize::from(lane);
        let quad = packet.quad(lane);
        let second = packet.primitive(0, lane) != primitive;
        let corners = match self.primitives.get(primitive as usize)?.kind {
            Kind::Parallelogram => quad.to_vec(),
            _ => packet.triangle(usize::from(second), lane).to_vec(),
        };
        let [a, b, c] = [0, 1, 2].map(|i| corners[i].as_dvec3());
        let normal = (b - a).cross(c - a).try_normalize()?;
        ShaftEnd::part(&corners, if front { normal } else { -normal }, [low, high], primitive)
    }

    /// How the unit shading normal at a hit changes for a small step along its surface, to the first order: what the step is multiplied by, so that both
    /// may be derivatives. Zero where surfaces and their shading are flat.
    #[must_use]
    pub fn normal_change(&self, hit: &Hit, step: DVec3) -> DVec3 {
        match self.primitives.get(hit.primitive as usize) {
            Some(Primitive { kind: Kind::Sphere(curvature), .. }) => step * f64::from(*curvature),
            Some(Primitive { normals, .. }) if *normals != NO_PRIMITIVE => {
                self.interpolated_change(hit, *normals, step).unwrap_or(DVec3::ZERO)
            }
            _ => DVec3::ZERO,
        }
    }

    /// The same of a triangle with vertex normals.
    fn interpolated_change(&self, hit: &Hit, normals: u32, step: DVec3) -> Option<DVec3> {
        let (packet, lane) = (*self.places.get(hit.primitive as usize)?)?;
        let packed = self.bvh.packet(packet);
        let half = usize::from(packed.primitive(0, usize::from(lane)) != hit.primitive);
        let turn = self.bvh.detail_of(packet, half, usize::from(lane)).half.rotation as usize;
        let triangle = packed.triangle(half, usize::from(lane));
        let [a, b, c] = [0, 1, 2].map(|i| triangle[(i + 3 - turn) % 3].as_dvec3());
        let normals = self.vertex_normals.get(normals as usize)?.map(Vec3A::as_dvec3);
        let (u, v) = (b - a, c - a);
        let plane = u.cross(v);
        let by_area = plane / plane.length_squared();
        // By how much the weights of the second and the third vertex change.
        let [beta, gamma] = [step.cross(v), u.cross(step)].map(|area| area.dot(by_area));
        let [second, third] = hit.uv.map(f64::from);
        let sum = normals[0] * (1.0 - second - third) + normals[1] * second + normals[2] * third;
        let change = (normals[1] - normals[0]) * beta + (normals[2] - normals[0]) * gamma;
        let unit = sum.try_normalize()?;
        Some((change - unit * unit.dot(change)) / sum.length())
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
        let count = u32::try_from(self.primitives.len()).map_err(|_| GeometryError::TooManyPrimitives)?;
        if self.bvh.is_consistent(count) { Ok(()) } else { Err(GeometryError::BrokenHierarchy) }
    }

    fn refine(&self, ray: &Ray, raw: &RawHit) -> Hit {
        match raw {
            RawHit::Triangle(packet, hit) => self.refine_triangle(ray, *packet, hit),
            RawHit::Round(index, t) => self.refine_round(ray, *index, *t),
        }
    }

    #[allow(clippy::cast_possible_truncation, reason = "the results are wanted in f32")]
    fn refine_triangle(&self, ray: &Ray, packet: u32, hit: &PacketHit) -> Hit {
        let detail = self.bvh.detail(packet, hit);
        let (origin, direction) = (ray.origin.as_dvec3(), ray.direction.as_dvec3());
        let slope = detail.normal.dot(direction);
        let t = (detail.height - detail.normal.dot(origin)) / slope;
        let mut distance = t as f32;
        let mut weights = normalised(hit.weights.map(f32::abs));
        let mut position = (origin + direction * t).as_vec3a();
        // Near an edge, or where the plane is seen edge-on, the position is made from vertices.
        let off_edges = (0..3).all(|i| weights[i] >= OFF_EDGES * detail.least[i]);
        if !off_edges || (distance - hit.t).abs().partial_cmp(&(1e-3 * hit.t)).is_none_or(Ordering::is_gt) {
            let triangle = self.bvh.packet(packet).triangle(hit.half, hit.lane);
            (position, weights) = keep_off_edges(ray, triangle, &detail.least);
            distance = hit.t;
        }
        let record = &self.primitives[detail.half.primitive as usize];
        let turn = detail.half.rotation as usize;
        let geometric_normal = detail.normal.as_vec3a();
        let weights: [f32; 3] = core::array::from_fn(|i| weights[(i + 3 - turn) % 3]);
        let [_, b, c] = weights;
        let uv = match (record.kind, hit.half) {
            (Kind::Parallelogram, 0) => [b + c, c],
            (Kind::Parallelogram, _) => [b, b + c],
            _ => [b, c],
        };
        let interpolated = |normals: &[Vec3A; 3]| {
            let sum = (0..3).fold(Vec3A::ZERO, |sum, i| sum + normals[i] * weights[i]);
            sum.normalize_or(geometric_normal)
        };
        let shading_normal = self.vertex_normals.get(record.normals as usize).map_or(geometric_normal, interpolated);
        Hit {
            t: distance,
            primitive: detail.half.primitive,
            shape: record.shape,
            position,
            error: rounding(position),
            geometric_normal,
            shading_normal,
            uv: uv.map(|x: f32| x.clamp(0.0, 1.0)),
            front: slope < 0.0,
            planar: true,
        }
    }

    #[allow(clippy::cast_possible_truncation, reason = "the results are wanted in f32")]
    fn refine_round(&self, ray: &Ray, index: u32, t: f64) -> Hit {
        let (round, primitive) = self.bvh.round(index);
        let hit = round.hit(ray, t);
        let record = &self.primitives[*primitive as usize];
        let (position, normal) = (hit.position.as_vec3a(), hit.normal.as_vec3a());
        Hit {
            t: t as f32,
            primitive: *primitive,
            shape: record.shape,
            position,
            error: rounding(position),
            geometric_normal: normal,
            shading_normal: normal,
            uv: hit.uv.map(|x| x.clamp(0.0, 1.0) as f32),
            front: hit.normal.dot(ray.direction.as_dvec3()) < 0.0,
            planar: record.kind == Kind::Disk,
        }
    }
}

/// Twice the error of a position that was rounded to `f32` once.
fn rounding(position: Vec3A) -> f32 {
    f32::EPSILON * position.abs().max_element()
}

fn normalised(weights: [f32; 3]) -> [f32; 3] {
    let scale = 1.0 / (weights[0] + weights[1] + weights[2]);
    weights.map(|w| w * scale)
}

/// The meeting point and its weights, moved off the edges of a triangle if it is nearer to one than the rounding of
/// `f32` coordinates: so it is on the right side of what stands on the edge.
#[cold]
#[inline(never)]
#[allow(clippy::cast_possible_truncation, reason = "the results are wanted in f32")]
fn keep_off_edges(ray: &Ray, triangle: [Vec3A; 3], least: &[f32; 3]) -> (Vec3A, [f32; 3]) {
    let exact = Exact::new(ray, triangle).weights;
    let raised: [f64; 3] = core::array::from_fn(|i| exact[i].max(f64::from(least[i])));
    let scale = 1.0 / raised.iter().sum::<f64>();
    let weights = raised.map(|w| w * scale);
    let [a, b, c] = triangle.map(Vec3A::as_dvec3);
    ((a + (b - a) * weights[1] + (c - a) * weights[2]).as_vec3a(), weights.map(|w| w as f32))
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
            Surface::Mesh(mesh) => self.add_mesh(shape, mesh, start)?,
            Surface::Parallelogram(parallelogram) => {
                let vertices = parallelogram.corners();
                let pair = Pair { vertices, halves: [Half { primitive: start, rotation: 0 }; 2] };
                let area = [0, 1].map(|half| area(pair.triangle(half))).iter().sum();
                self.items.push(Item::Triangles(pair));
                self.primitives.push(Primitive { shape, normals: NO_PRIMITIVE, kind: Kind::Parallelogram, area });
            }
            Surface::Disk(disk) => {
                self.add_round(shape, Round::Disk(DiskFrame::new(disk)), Kind::Disk, start);
            }
            Surface::Sphere(sphere) => {
                let curvature = 1.0 / sphere.radius;
                let kind = Kind::Sphere(if sphere.inward { -curvature } else { curvature });
                self.add_round(shape, Round::Sphere(*sphere), kind, start);
            }
        }
        self.ranges.push(start..self.next()?);
        Ok(())
    }

    fn add_mesh(&mut self, shape: u32, mesh: &Mesh, first: u32) -> Result<(), GeometryError> {
        for triangle in &mesh.triangles {
            let mut normals = NO_PRIMITIVE;
            if !mesh.normals.is_empty() {
                normals = u32::try_from(self.vertex_normals.len()).unwrap_or(NO_PRIMITIVE);
                let unit = |i: u32| mesh.normals[i as usize].as_dvec3().normalize().as_vec3a();
                self.vertex_normals.push(triangle.map(unit));
            }
            self.next()?;
            let area = area(triangle.map(|i| mesh.positions[i as usize]));
            self.primitives.push(Primitive { shape, normals, kind: Kind::Triangle, area });
        }
        self.items.extend(pair_up(mesh, first).into_iter().map(Item::Triangles));
        Ok(())
    }

    fn add_round(&mut self, shape: u32, round: Round, kind: Kind, index: u32) {
        self.items.push(Item::Round(round, index));
        self.primitives.push(Primitive { shape, normals: NO_PRIMITIVE, kind, area: round.area() });
    }

    /// The index of the next primitive.
    fn next(&self) -> Result<u32, GeometryError> {
        match u32::try_from(self.primitives.len()) {
            Ok(index) if index < MOST_PRIMITIVES => Ok(index),
            _ => Err(GeometryError::TooManyPrimitives),
        }
    }
}

fn area(triangle: [Vec3A; 3]) -> f64 {
    let [a, b, c] = triangle.map(Vec3A::as_dvec3);
    (b - a).cross(c - a).length() / 2.0
}
