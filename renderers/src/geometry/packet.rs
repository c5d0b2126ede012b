//! Four pairs of triangles tested at once, watertight: S. Woop, C. Benthin & I. Wald, "Watertight Ray/Triangle
//! Intersection", *Journal of Computer Graphics Techniques* 2(1), 2013.
//!
//! Edge functions of a shared edge are the same numbers with opposite signs in both triangles, and rounding never turns
//! a sign, so that no ray slips between them; where one rounds to zero it is formed again, exactly, in `f64`. The
//! distance gets an error bound (Pharr, Jakob & Humphreys, *Physically Based Rendering*, 4th ed., section 6.8.7); where
//! that leaves open whether a hit is within the ray's range, the distance is found again in `f64` from the vertices.

use glam::{DVec3, Vec3A, Vec4};

use super::ray::{NO_PRIMITIVE, Ray};

/// Half a unit in the last place, relative: the rounding error of one operation.
const UNIT: f32 = f32::EPSILON / 2.0;

/// The bound γₙ = n·u / (1 − n·u) of the relative error after n roundings.
const fn gamma(n: f32) -> f32 {
    n * UNIT / (1.0 - n * UNIT)
}

/// Two triangles that share an edge: vertices 0, 1, 2 and 0, 2, 3. One without partner has vertex 2 again as vertex 3.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pair {
    pub(super) vertices: [Vec3A; 4],
    pub(super) halves: [Half; 2],
}

impl Pair {
    /// The vertices of one half.
    pub(super) fn triangle(&self, half: usize) -> [Vec3A; 3] {
        let [a, b, c, d] = self.vertices;
        if half == 0 { [a, b, c] } else { [a, c, d] }
    }
}

/// One triangle of a pair.
#[derive(Clone, Copy, Debug)]
pub(super) struct Half {
    /// Index of its primitive; [`NO_PRIMITIVE`] for a missing partner.
    pub(super) primitive: u32,
    /// Its first vertex is the one with this number in the triangle it was made from.
    pub(super) rotation: u32,
}

impl Half {
    /// What a triangle without partner has in the place of one.
    pub(super) const MISSING: Self = Self { primitive: NO_PRIMITIVE, rotation: 0 };
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
    #[inline(always)]
    pub(super) fn new<const KZ: usize>(ray: Ray) -> Self {
        let direction = ray.direction.to_array();
        let z = direction[KZ];
        let (shear_x, shear_y) = (direction[(KZ + 1) % 3] / z, direction[(KZ + 2) % 3] / z);
        Self { ray, origin: ray.origin.to_array(), shear_x, shear_y, scale: 1.0 / z }
    }
}

/// Which triangle of a packet a ray hits, and where, to `f32` accuracy.
#[derive(Clone, Copy, Debug)]
pub(super) struct PacketHit {
    pub(super) t: f32,
    pub(super) lane: usize,
    pub(super) half: usize,
    /// Barycentric weights, not normalised; all of one sign.
    pub(super) weights: [f32; 3],
}

/// Four pairs of triangles; places that are not needed repeat the last one.
#[derive(Clone, Copy, Debug)]
pub(super) struct Packet {
    /// Vertex, axis, lane.
    vertices: [[Vec4; 3]; 4],
    /// Half, lane.
    primitives: [[u32; 4]; 2],
}

/// The triangles of one half of a packet, as a ray sees them.
struct View {
    sheared: [[Vec4; 2]; 3],
    z: [Vec4; 3],
    edges: [Vec4; 3],
    /// The lanes that the line of the ray passes through, or nearly so.
    inside: u32,
}

/// Where the line of a ray meets triangles, and which of the meetings are within its range.
struct Distances {
    t: Vec4,
    certain: u32,
    possible: u32,
}

impl Packet {
    /// Packs one to four pairs; `None` for none.
    pub(super) fn new(pairs: &[Pair]) -> Option<Self> {
        let last = pairs.last()?;
        let lane = |i: usize| pairs.get(i).unwrap_or(last);
        let gather = |vertex: usize, axis: usize| {
            let [a, b, c, d] = [0, 1, 2, 3].map(|i| lane(i).vertices[vertex][axis]);
            Vec4::new(a, b, c, d)
        };
        let vertices = [0, 1, 2, 3].map(|vertex| [0, 1, 2].map(|axis| gather(vertex, axis)));
        let primitives = [0, 1].map(|half| [0, 1, 2, 3].map(|i| lane(i).halves[half].primitive));
        Some(Self { vertices, primitives })
    }

    /// Index of the primitive in a lane; [`NO_PRIMITIVE`] for a missing partner.
    pub(super) fn primitive(&self, half: usize, lane: usize) -> u32 {
        self.primitives[half & 1][lane & 3]
    }

    /// The vertices of the triangle in a lane.
    pub(super) fn triangle(&self, half: usize, lane: usize) -> [Vec3A; 3] {
        let numbers = if half == 0 { [0, 1, 2] } else { [0, 2, 3] };
        numbers.map(|i| Vec3A::from_array([0, 1, 2].map(|axis| self.vertices[i][axis][lane & 3])))
    }

    /// The vertices of the pair in a lane.
    pub(super) fn quad(&self, lane: usize) -> [Vec3A; 4] {
        [0, 1, 2, 3].map(|i| Vec3A::from_array([0, 1, 2].map(|axis| self.vertices[i][axis][lane & 3])))
    }

    /// The primitives and vertices of all its triangles, the missing ones included, once each.
    pub(super) fn triangles(&self) -> impl Iterator<Item = (u32, [Vec3A; 3])> {
        let repeated = |lane: usize| {
            lane > 0 && [0, 1].map(|half| self.primitives[half][lane] == self.primitives[half][lane - 1]) == [true; 2]
        };
        let lanes = (0..4).filter(move |lane| !repeated(*lane));
        lanes.flat_map(|lane| [0, 1].map(|half| (self.primitives[half][lane], self.triangle(half, lane))))
    }

    /// The nearest hit with 0 ≤ t < `t_max`, for a ray prepared for axis `KZ`.
    #[inline(always)]
    pub(super) fn closest<const KZ: usize>(&self, ray: &Sheared, t_max: f32) -> Option<PacketHit> {
        let [first, second] = self.views::<KZ>(ray)?;
        let mut best = None;
        let mut t_max = t_max;
        if first.inside != 0 {
            self.closest_of_half(&first, ray, 0, &mut t_max, &mut best);
        }
        if second.inside != 0 {
            self.closest_of_half(&second, ray, 1, &mut t_max, &mut best);
        }
        best
    }

    #[inline(always)]
    fn closest_of_half(&self, view: &View, ray: &Sheared, half: usize, t_max: &mut f32, best: &mut Option<PacketHit>) {
        let found = view.distances(ray, *t_max);
        let mut lanes = found.possible;
        while lanes != 0 {
            let lane = lanes.trailing_zeros() as usize & 3;
            lanes &= lanes - 1;
            if ray.ray.exclude.contains(&self.primitive(half, lane)) {
                continue;
            }
            if found.certain >> lane & 1 != 0 {
                let t = found.t[lane];
                if t < *t_max {
                    *t_max = t;
                    *best = Some(PacketHit { t, lane, half, weights: view.edges.map(|e| e[lane]) });
                }
            } else if let Some(hit) = self.decide(view, ray, *t_max, half, lane) {
                *t_max = hit.t;
                *best = Some(hit);
            }
        }
    }

    /// Whether there is any hit with 0 ≤ t < `t_max`, for a ray prepared for axis `KZ`.
    #[inline(always)]
    pub(super) fn any<const KZ: usize>(&self, ray: &Sheared, t_max: f32) -> bool {
        let Some([first, second]) = self.views::<KZ>(ray) else { return false };
        (first.inside != 0 && self.any_of_half(&first, ray, 0, t_max))
            || (second.inside != 0 && self.any_of_half(&second, ray, 1, t_max))
    }

    #[inline(always)]
    fn any_of_half(&self, view: &View, ray: &Sheared, half: usize, t_max: f32) -> bool {
        let found = view.distances(ray, t_max);
        let mut lanes = found.possible;
        while lanes != 0 {
            let lane = lanes.trailing_zeros() as usize & 3;
            lanes &= lanes - 1;
            if ray.ray.exclude.contains(&self.primitive(half, lane)) {
                continue;
            }
            if found.certain >> lane & 1 != 0 || self.decide(view, ray, t_max, half, lane).is_some() {
                return true;
            }
        }
        false
    }

    /// The edge functions of all eight triangles; `None` if the line of the ray misses them all.
    #[inline(always)]
    fn views<const KZ: usize>(&self, ray: &Sheared) -> Option<[View; 2]> {
        let axis = |vertex: usize, k: usize| self.vertices[vertex][k % 3] - Vec4::splat(ray.origin[k % 3]);
        let z = [0, 1, 2, 3].map(|vertex| axis(vertex, KZ));
        let shear = |vertex: usize| {
            let x = axis(vertex, KZ + 1) - ray.shear_x * z[vertex];
            let y = axis(vertex, KZ + 2) - ray.shear_y * z[vertex];
            [x, y]
        };
        let [a, b, c, d] = [shear(0), shear(1), shear(2), shear(3)];
        let edge = |p: [Vec4; 2], q: [Vec4; 2]| q[0] * p[1] - q[1] * p[0];
        let (ab, bc, cd, da, ca) = (edge(a, b), edge(b, c), edge(c, d), edge(d, a), edge(c, a));
        let inside = |u: Vec4, v: Vec4, w: Vec4| {
            let both = u.min(v).min(w).cmplt(Vec4::ZERO) & u.max(v).max(w).cmpgt(Vec4::ZERO);
            0b1111 & !both.bitmask()
        };
        let (first, second) = (inside(bc, ca, ab), inside(cd, da, -ca));
        (first | second != 0).then(|| {
            [
                View { sheared: [a, b, c], z: [z[0], z[1], z[2]], edges: [bc, ca, ab], inside: first },
                View { sheared: [a, c, d], z: [z[0], z[2], z[3]], edges: [cd, da, -ca], inside: second },
            ]
        })
    }

    /// Decides exactly about one triangle.
    #[cold]
    #[inline(never)]
    #[allow(clippy::cast_possible_truncation, reason = "the results are wanted in f32")]
    fn decide(&self, view: &View, ray: &Sheared, t_max: f32, half: usize, lane: usize) -> Option<PacketHit> {
        let [a, b, c] = view.sheared.map(|p| (f64::from(p[0][lane]), f64::from(p[1][lane])));
        let edge = |p: (f64, f64), q: (f64, f64)| q.0 * p.1 - q.1 * p.0;
        let edges = [edge(b, c), edge(c, a), edge(a, b)];
        let (negative, positive) = (edges.iter().any(|e| *e < 0.0), edges.iter().any(|e| *e > 0.0));
        if negative == positive {
            return None;
        }
        let exact = Exact::new(&ray.ray, self.triangle(half, lane));
        // A ray that starts on the triangle hits it only if it enters through its front.
        let within = exact.t > 0.0 || (exact.t == 0.0 && exact.slope < 0.0);
        let t = exact.t.abs() as f32;
        let weights = exact.weights.map(|w| w as f32);
        (within && exact.t < f64::from(t_max)).then_some(PacketHit { t, lane, half, weights })
    }
}

impl View {
    #[inline(always)]
    fn distances(&self, ray: &Sheared, t_max: f32) -> Distances {
        let [u, v, w] = self.edges;
        let z = &self.z;
        let inverse = Vec4::splat(ray.scale) / (u + v + w);
        let t = (u * z[0] + v * z[1] + w * z[2]) * inverse;
        let error = self.distance_error() * inverse.abs();
        let (low, high, t_max) = (t - error, t + error, Vec4::splat(t_max));
        let certain = low.cmpgt(Vec4::ZERO) & high.cmplt(t_max);
        // Negated, so that a distance which is not a number (seen edge-on) is looked at again.
        let out_of_range = high.cmplt(Vec4::ZERO) | low.cmpge(t_max);
        let zero = u.cmpeq(Vec4::ZERO) | v.cmpeq(Vec4::ZERO) | w.cmpeq(Vec4::ZERO);
        let possible = self.inside & !out_of_range.bitmask();
        Distances { t, certain: certain.bitmask() & !zero.bitmask(), possible }
    }

    /// The bound of the distances' absolute error, times the determinant, without the scale of the shear.
    #[inline(always)]
    fn distance_error(&self) -> Vec4 {
        let largest = |p: Vec4, q: Vec4, r: Vec4| p.abs().max(q.abs()).max(r.abs());
        let [a, b, c] = &self.sheared;
        let max_edge = largest(self.edges[0], self.edges[1], self.edges[2]);
        let max_z = largest(self.z[0], self.z[1], self.z[2]);
        let max_x = largest(a[0], b[0], c[0]);
        let max_y = largest(a[1], b[1], c[1]);
        let error_x = gamma(5.0) * (max_x + max_z);
        let error_y = gamma(5.0) * (max_y + max_z);
        let error_edge = 2.0 * (gamma(2.0) * max_x * max_y + error_y * max_x + error_x * max_y);
        // The last term is that of z itself, whose error is γ₃ of its maximum.
        3.0 * max_z * (gamma(3.0) * max_edge + error_edge + gamma(3.0) * max_edge)
    }
}

/// The meeting of a ray with a triangle that it is known to hit, from the vertices in `f64`.
pub(super) struct Exact {
    /// Ray parameter.
    t: f64,
    /// The normal's component along the ray: negative when the ray enters through the front.
    slope: f64,
    /// Barycentric weights, none negative, sum 1.
    pub(super) weights: [f64; 3],
}

impl Exact {
    /// Weights that rounding made negative are set to zero; a triangle seen exactly edge-on is met at its centroid.
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
        let slope = normal.dot(direction);
        Self { t: distance(direction, normal.dot(a) / slope, offset), slope, weights }
    }
}

/// The ray parameter where the plane is met, unless rounding put that far from the point `offset` of the triangle.
fn distance(direction: DVec3, plane: f64, offset: DVec3) -> f64 {
    let interpolated = offset.dot(direction) / direction.length_squared();
    let tolerance = 1e-3 * offset.length() / direction.length();
    if (plane - interpolated).abs() <= tolerance { plane } else { interpolated }
}
