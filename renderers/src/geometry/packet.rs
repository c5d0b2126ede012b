//! Four triangles tested at once, watertight: S. Woop, C. Benthin & I. Wald, "Watertight Ray/Triangle Intersection",
//! *Journal of Computer Graphics Techniques* 2(1), 2013.
//!
//! Edge functions of a shared edge are the same numbers with opposite signs in both triangles, and rounding never turns
//! a sign, so that no ray slips between them; where one rounds to zero it is formed again, exactly, in `f64`. The
//! distance gets an error bound (Pharr, Jakob & Humphreys, section 6.8.7); where that leaves open whether a hit is
//! within the ray's range it is found again in `f64` from the vertices.

use glam::{DVec3, Vec3A, Vec4};

use super::ray::Ray;

/// The bit of [`Packet::tags`] that marks the second half of a parallelogram.
pub(super) const SECOND_HALF: u32 = 1 << 31;

/// Half a unit in the last place, relative: the rounding error of one operation.
const UNIT: f32 = f32::EPSILON / 2.0;

/// The bound γₙ = n·u / (1 − n·u) of the relative error after n roundings.
const fn gamma(n: f32) -> f32 {
    n * UNIT / (1.0 - n * UNIT)
}

/// A ray with what the triangle test derives from it once: the shear that takes its direction to an axis.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sheared {
    pub(super) ray: Ray,
    origin: [f32; 3],
    shear_x: f32,
    shear_y: f32,
    scale: f32,
}

impl Sheared {
    /// Prepares a ray whose direction is longest along axis `KZ`.
    pub(super) fn new<const KZ: usize>(ray: Ray) -> Self {
        let direction = ray.direction.to_array();
        let z = direction[KZ];
        let (shear_x, shear_y) = (direction[(KZ + 1) % 3] / z, direction[(KZ + 2) % 3] / z);
        Self { ray, origin: ray.origin.to_array(), shear_x, shear_y, scale: 1.0 / z }
    }
}

/// Which triangle of a packet a ray hits, and where: `f32` accuracy, enough to order hits.
#[derive(Clone, Copy, Debug)]
pub(super) struct PacketHit {
    pub(super) t: f32,
    pub(super) lane: usize,
}

/// Four triangles; places that are not needed repeat the last one.
#[derive(Clone, Copy, Debug)]
pub(super) struct Packet {
    /// Vertex, axis, lane.
    vertices: [[Vec4; 3]; 3],
    /// Index of the primitive of each lane, with [`SECOND_HALF`].
    tags: [u32; 4],
}

/// What the edge functions and the distance are made of, for the lanes that are inside or need another look.
struct Candidates {
    sheared: [[Vec4; 2]; 3],
    edges: [Vec4; 3],
    t: Vec4,
    t_error: Vec4,
    possible: u32,
}

impl Packet {
    /// Packs one to four triangles, given as vertices and tag; `None` for none.
    pub(super) fn new(triangles: &[([Vec3A; 3], u32)]) -> Option<Self> {
        let last = triangles.last()?;
        let lane = |i: usize| triangles.get(i).unwrap_or(last);
        let gather = |vertex: usize, axis: usize| {
            Vec4::new(
                lane(0).0[vertex][axis],
                lane(1).0[vertex][axis],
                lane(2).0[vertex][axis],
                lane(3).0[vertex][axis],
            )
        };
        let vertices = [0, 1, 2].map(|vertex| [0, 1, 2].map(|axis| gather(vertex, axis)));
        Some(Self { vertices, tags: [0, 1, 2, 3].map(|i| lane(i).1) })
    }

    /// Index of the primitive in a lane.
    pub(super) fn primitive(&self, lane: usize) -> u32 {
        self.tags[lane & 3] & !SECOND_HALF
    }

    /// Whether the lane holds the second half of a parallelogram.
    pub(super) fn is_second_half(&self, lane: usize) -> bool {
        self.tags[lane & 3] & SECOND_HALF != 0
    }

    /// The vertices of the triangle in a lane.
    pub(super) fn triangle(&self, lane: usize) -> [Vec3A; 3] {
        self.vertices.map(|v| Vec3A::new(v[0][lane & 3], v[1][lane & 3], v[2][lane & 3]))
    }

    /// The nearest hit with 0 ≤ t < `t_max`, for a ray prepared for the same axis.
    #[inline(always)]
    pub(super) fn closest<const KZ: usize>(
        &self,
        ray: &Sheared,
        mut t_max: f32,
    ) -> Option<PacketHit> {
        let found = self.candidates::<KZ>(ray, t_max)?;
        let mut best = None;
        let mut lanes = found.possible;
        while lanes != 0 {
            let lane = lanes.trailing_zeros() as usize;
            lanes &= lanes - 1;
            if let Some(t) = self.accept(&found, ray, t_max, lane) {
                best = Some(PacketHit { t, lane });
                t_max = t;
            }
        }
        best
    }

    /// Whether there is any hit with 0 ≤ t < `t_max`, for a ray prepared for the same axis.
    #[inline(always)]
    pub(super) fn any<const KZ: usize>(&self, ray: &Sheared, t_max: f32) -> bool {
        let Some(found) = self.candidates::<KZ>(ray, t_max) else { return false };
        (0..4).any(|lane| {
            found.possible >> lane & 1 != 0 && self.accept(&found, ray, t_max, lane).is_some()
        })
    }

    #[inline(always)]
    fn candidates<const KZ: usize>(&self, ray: &Sheared, t_max: f32) -> Option<Candidates> {
        let axis =
            |vertex: usize, k: usize| self.vertices[vertex][k % 3] - Vec4::splat(ray.origin[k % 3]);
        let z = [axis(0, KZ), axis(1, KZ), axis(2, KZ)];
        let shear = |vertex: usize| {
            let x = axis(vertex, KZ + 1) - ray.shear_x * z[vertex];
            let y = axis(vertex, KZ + 2) - ray.shear_y * z[vertex];
            [x, y]
        };
        let [a, b, c] = [shear(0), shear(1), shear(2)];
        let u = c[0] * b[1] - c[1] * b[0];
        let v = a[0] * c[1] - a[1] * c[0];
        let w = b[0] * a[1] - b[1] * a[0];
        let least = u.min(v).min(w);
        let greatest = u.max(v).max(w);
        let outside = least.cmplt(Vec4::ZERO) & greatest.cmpgt(Vec4::ZERO);
        if outside.bitmask() == 0b1111 {
            return None;
        }
        let inverse = Vec4::splat(ray.scale) / (u + v + w);
        let t = (u * z[0] + v * z[1] + w * z[2]) * inverse;
        let t_error = distance_error(&[a, b, c], &z, greatest.max(-least)) * inverse.abs();
        // Negated, so that a distance which is not a number (seen edge-on) is looked at again.
        let out_of_range =
            (t + t_error).cmplt(Vec4::ZERO) | (t - t_error).cmpge(Vec4::splat(t_max));
        let possible = 0b1111 & !(outside | out_of_range).bitmask();
        (possible != 0).then_some(Candidates {
            sheared: [a, b, c],
            edges: [u, v, w],
            t,
            t_error,
            possible,
        })
    }

    /// The distance to the triangle of one lane, if it is really hit within the range.
    #[inline(always)]
    fn accept(&self, found: &Candidates, ray: &Sheared, t_max: f32, lane: usize) -> Option<f32> {
        if ray.ray.exclude.contains(&self.primitive(lane)) {
            return None;
        }
        let (t, error) = (found.t[lane], found.t_error[lane]);
        let no_zero = found.edges.iter().all(|e| e[lane] != 0.0);
        if no_zero && t - error > 0.0 && t + error < t_max {
            return Some(t);
        }
        self.accept_exactly(found, ray, t_max, lane)
    }

    #[cold]
    #[inline(never)]
    #[allow(clippy::cast_possible_truncation, reason = "the distance is wanted in f32")]
    fn accept_exactly(
        &self,
        found: &Candidates,
        ray: &Sheared,
        t_max: f32,
        lane: usize,
    ) -> Option<f32> {
        let [a, b, c] = found.sheared.map(|p| (f64::from(p[0][lane]), f64::from(p[1][lane])));
        let edge = |p: (f64, f64), q: (f64, f64)| p.0 * q.1 - p.1 * q.0;
        let edges = [edge(c, b), edge(a, c), edge(b, a)];
        let (negative, positive) = (edges.iter().any(|e| *e < 0.0), edges.iter().any(|e| *e > 0.0));
        if negative == positive {
            return None;
        }
        let exact = Refined::new(&ray.ray, self.triangle(lane));
        let starts_on_it = exact.t == 0.0;
        let entered = exact.normal.dot(ray.ray.direction.as_dvec3()) < 0.0;
        let within = if starts_on_it { entered } else { exact.t > 0.0 };
        (within && exact.t < f64::from(t_max)).then_some(exact.t as f32)
    }
}

/// The bound of |t| error times the determinant (unscaled).
#[inline(always)]
fn distance_error(sheared: &[[Vec4; 2]; 3], z: &[Vec4; 3], max_edge: Vec4) -> Vec4 {
    let largest = |a: Vec4, b: Vec4, c: Vec4| a.abs().max(b.abs()).max(c.abs());
    let [a, b, c] = sheared;
    let max_z = largest(z[0], z[1], z[2]);
    let max_x = largest(a[0], b[0], c[0]);
    let max_y = largest(a[1], b[1], c[1]);
    let error_z = gamma(3.0) * max_z;
    let error_x = gamma(5.0) * (max_x + max_z);
    let error_y = gamma(5.0) * (max_y + max_z);
    let error_edge = 2.0 * (gamma(2.0) * max_x * max_y + error_y * max_x + error_x * max_y);
    3.0 * (gamma(3.0) * max_edge * max_z + error_edge * max_z + error_z * max_edge)
}

/// The meeting of a ray and a triangle that it is known to hit, in `f64`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Refined {
    /// Ray parameter.
    pub(super) t: f64,
    /// Barycentric weights of the three vertices, none negative, sum 1.
    pub(super) weights: [f64; 3],
    /// The normal (v₁ − v₀) × (v₂ − v₀), twice the area long.
    pub(super) normal: DVec3,
}

impl Refined {
    /// Weights that are negative by rounding are set to zero; a triangle seen exactly edge-on is met at its centroid.
    pub(super) fn new(ray: &Ray, triangle: [Vec3A; 3]) -> Self {
        let origin = ray.origin.as_dvec3();
        let direction = ray.direction.as_dvec3();
        let [a, b, c] = triangle.map(|v| v.as_dvec3() - origin);
        let normal = (b - a).cross(c - a);
        let volumes = [c.cross(b), a.cross(c), b.cross(a)].map(|n| n.dot(direction));
        let sign = if volumes.iter().sum::<f64>() < 0.0 { -1.0 } else { 1.0 };
        let clamped = volumes.map(|v| (v * sign).max(0.0));
        let sum: f64 = clamped.iter().sum();
        let weights = if sum > 0.0 { clamped.map(|v| v / sum) } else { [1.0 / 3.0; 3] };
        let offset = a * weights[0] + b * weights[1] + c * weights[2];
        Self { t: distance(direction, normal, a, offset), weights, normal }
    }
}

/// Ray parameter of the plane through `a`, kept within rounding of the point `offset` of the triangle.
fn distance(direction: DVec3, normal: DVec3, a: DVec3, offset: DVec3) -> f64 {
    let interpolated = offset.dot(direction) / direction.length_squared();
    let plane = normal.dot(a) / normal.dot(direction);
    let tolerance = 1e-3 * offset.length() / direction.length();
    if (plane - interpolated).abs() <= tolerance { plane } else { interpolated }
}
