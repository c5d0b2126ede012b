//! Where flat surfaces end, and how much of a kernel is on them.

use alloc::collections::{BTreeMap, BTreeSet};
use core::f64::consts::TAU;
use std::collections::HashMap;

use glam::{DVec2, DVec3};

use super::kernel::Kernel;
use crate::scene::{Geometry, Mesh};

/// Adjacent triangles whose normals differ by less (in radians) are in one plane.
const FLAT: f64 = 1e-3;
/// Adjacent triangles whose normals differ by less are one curved surface; by more, two with an edge between them.
const CREASE: f64 = 20.0 * core::f64::consts::PI / 180.0;
/// Points may be this share of a mesh's size off their plane.
const OFF_PLANE: f64 = 1e-5;
/// A kernel's share inside is at least this: the tip of a corner of 4°.
const LEAST: f64 = 0.01;
/// Points are moved by this share of the kernel's radius.
const NUDGE: f64 = 1e-9;
/// The nodes and weights of Gauss and Legendre's rule for four points, on [−1, 1].
const GAUSS: [(f64, f64); 4] = [
    (-0.861_136_311_594_052_6, 0.347_854_845_137_453_85),
    (-0.339_981_043_584_856_26, 0.652_145_154_862_546_1),
    (0.339_981_043_584_856_26, 0.652_145_154_862_546_1),
    (0.861_136_311_594_052_6, 0.347_854_845_137_453_85),
];

/// The flat faces of a scene's shapes.
#[derive(Clone, Debug, Default)]
pub(crate) struct Extents {
    shapes: Vec<Faces>,
}

/// The flat faces of a shape.
#[derive(Clone, Debug, Default)]
struct Faces {
    faces: Vec<Face>,
    /// The face of each triangle of a mesh, `None` for those of curved surfaces; empty for other shapes.
    of_triangles: Vec<Option<u32>>,
}

/// A flat surface and its outline: that of a rectangle or disk, or of all triangles of a mesh that are in one plane and face the same way.
#[derive(Clone, Debug)]
pub(crate) struct Face {
    origin: DVec3,
    u: DVec3,
    v: DVec3,
    /// How far its points are from its plane at most, in scene units.
    thickness: f64,
    outline: Outline,
}

#[derive(Clone, Debug)]
enum Outline {
    /// Its edges, with the surface on their left.
    Polygon(Vec<[DVec2; 2]>),
    /// A circle about the origin, by its radius.
    Circle(f64),
}

impl Extents {
    /// The faces of shapes, in the order in which they are numbered.
    pub(crate) fn new<'a>(shapes: impl IntoIterator<Item = &'a Geometry>) -> Self {
        Self { shapes: shapes.into_iter().map(Faces::new).collect() }
    }

    /// The face that a primitive of a shape (a triangle of a mesh, by its index there) is part of; `None` for curved surfaces, and for
    /// triangles that belong to one: whose neighbours' normals differ by less than 20°.
    pub(crate) fn face(&self, shape: u32, primitive: u32) -> Option<&Face> {
        let shape = self.shapes.get(shape as usize)?;
        let face = match shape.of_triangles.as_slice() {
            [] => 0,
            triangles => (*triangles.get(primitive as usize)?)?,
        };
        shape.faces.get(face as usize)
    }
}

impl Face {
    /// In the plane of two perpendicular unit vectors.
    const fn new(origin: DVec3, [u, v]: [DVec3; 2], thickness: f64, outline: Outline) -> Self {
        Self { origin, u, v, thickness, outline }
    }

    /// A point's coordinates in the plane, in scene units.
    pub(crate) fn place(&self, position: [f32; 3]) -> DVec2 {
        let from = DVec3::from_array(position.map(f64::from)) - self.origin;
        DVec2::new(from.dot(self.u), from.dot(self.v))
    }

    /// The unit normal of the plane.
    pub(crate) fn normal(&self) -> DVec3 {
        self.u.cross(self.v)
    }

    /// How far points of the face are from its plane at most, but for rounding; in scene units.
    pub(crate) const fn thickness(&self) -> f64 {
        self.thickness
    }

    /// The distance from a point (as of [`place`](Self::place)) of the face to its outline: disks of smaller radius are inside.
    pub(crate) fn clearance(&self, point: DVec2) -> f64 {
        match &self.outline {
            Outline::Circle(radius) => (radius - point.length()).max(0.0),
            Outline::Polygon(edges) => {
                edges.iter().map(|edge| distance2(*edge, point)).fold(f64::INFINITY, f64::min).sqrt()
            }
        }
    }

    /// The share of a kernel about a point (as of [`place`](Self::place)) of the face, with a radius in scene units, that is on the face.
    ///
    /// The point's being on the wrong side of the outline by rounding makes no difference. Exact to 1e-8 for polygons, to 1e-6 for disks
    /// (1e-3 with [`Kernel::Cone`]); at least 0.01.
    pub(crate) fn mass(&self, kernel: Kernel, point: DVec2, radius: f64) -> f64 {
        // On a corner the angles of its edges have no meaning, beside it they have.
        let point = point + DVec2::new(NUDGE, 0.7 * NUDGE) * radius;
        let missing = match &self.outline {
            Outline::Circle(rim) => beyond_circle(kernel, point.length() / radius, rim / radius),
            Outline::Polygon(edges) => {
                let relative = |[a, b]: [DVec2; 2]| [(a - point) / radius, (b - point) / radius];
                edges.iter().map(|edge| beyond_edge(kernel, relative(*edge))).sum()
            }
        };
        // From outside the edges go around the point once less.
        let mass = if missing < -1e-9 { -missing } else { 1.0 - missing };
        mass.clamp(LEAST, 1.0)
    }
}

/// What an edge takes of the kernel: the part beyond it of the sector that it spans, as far as it is in the unit disk.
fn beyond_edge(kernel: Kernel, [a, b]: [DVec2; 2]) -> f64 {
    let along = (b - a).normalize_or_zero();
    let h = a.perp_dot(along);
    if !(h.abs() < 1.0) {
        return 0.0;
    }
    let half = (1.0 - h * h).sqrt();
    let (from, to) = (a.dot(along).max(-half), b.dot(along).min(half));
    if !(from < to) {
        return 0.0;
    }
    let angle = (h * (to - from)).atan2(h * h + from * to);
    angle / TAU - h * (kernel.mean_along(h, to) - kernel.mean_along(h, from))
}

/// What is beyond a circle of radius `rim`, from a point at a distance from its centre, of a kernel of radius 1.
fn beyond_circle(kernel: Kernel, distance: f64, rim: f64) -> f64 {
    let distance = distance.min(rim);
    if rim - distance >= 1.0 {
        return 0.0;
    }
    // The arc in the disk, seen from the circle's centre: ± `half` about the direction to the point.
    let cosine = (distance * distance + rim * rim - 1.0) / (2.0 * distance * rim);
    let half = if cosine > -1.0 { cosine.min(1.0).acos() } else { core::f64::consts::PI };
    let angle = (rim * half.sin()).atan2(rim * half.cos() - distance);
    let integrand = |phi: f64| {
        let cosine = phi.cos();
        let t2 = distance * distance + rim * rim - 2.0 * distance * rim * cosine;
        kernel.mean_within(t2.clamp(0.0, 1.0)) * rim * (rim - distance * cosine)
    };
    2.0 * (angle / TAU - integral(half, integrand))
}

/// ∫ f from 0 to `end`, in four pieces.
fn integral(end: f64, f: impl Fn(f64) -> f64) -> f64 {
    let half = end / 8.0;
    let piece = |middle: f64| GAUSS.iter().map(|(node, weight)| weight * f(middle + half * node)).sum::<f64>();
    [1.0, 3.0, 5.0, 7.0].map(|odd| piece(half * odd)).iter().sum::<f64>() * half
}

fn distance2([a, b]: [DVec2; 2], point: DVec2) -> f64 {
    let (edge, from) = (b - a, point - a);
    let t = (from.dot(edge) / edge.length_squared()).clamp(0.0, 1.0);
    (from - edge * t).length_squared()
}

impl Faces {
    fn new(shape: &Geometry) -> Self {
        match shape {
            Geometry::Rectangle { center, half_u, half_v, .. } => {
                let axes = [half_u.normalize_or_zero(), half_v.normalize_or_zero()];
                let (x, y) = (half_u.length(), half_v.length());
                let corners = [(-x, -y), (x, -y), (x, y), (-x, y)].map(|(x, y)| DVec2::new(x, y));
                let edges = (0..4).map(|i| [corners[i], corners[(i + 1) % 4]]).collect();
                Self::one(Face::new(*center, axes, 0.0, Outline::Polygon(edges)))
            }
            Geometry::Disk { center, radius, normal } => {
                let (u, v) = normal.any_orthonormal_pair();
                Self::one(Face::new(*center, [u, v], 0.0, Outline::Circle(*radius)))
            }
            Geometry::Sphere { .. } => Self::default(),
            Geometry::Mesh(mesh) => Self::of_mesh(mesh),
        }
    }

    fn one(face: Face) -> Self {
        Self { faces: vec![face], of_triangles: Vec::new() }
    }

    fn of_mesh(mesh: &Mesh) -> Self {
        let topology = Topology::new(mesh);
        let planes = topology.planes(mesh);
        let mut members: BTreeMap<u32, Vec<usize>> = BTreeMap::new();
        for (triangle, plane) in planes.iter().enumerate() {
            if let Some(plane) = plane {
                members.entry(*plane).or_default().push(triangle);
            }
        }
        let mut of_triangles = vec![None; planes.len()];
        let mut faces = Vec::new();
        for (number, triangles) in (0..).zip(members.values()) {
            triangles.iter().for_each(|triangle| of_triangles[*triangle] = Some(number));
            faces.push(topology.face(mesh, triangles));
        }
        Self { faces, of_triangles }
    }
}

/// How the triangles of a mesh hang together, by the positions of their corners.
struct Topology {
    /// Corners, the same number for the same position.
    corners: Vec<[u32; 3]>,
    normals: Vec<DVec3>,
    /// The largest extent along an axis.
    size: f64,
}

impl Topology {
    fn new(mesh: &Mesh) -> Self {
        let mut numbers = HashMap::new();
        let mut number = |position: DVec3| {
            let next = numbers.len();
            #[allow(clippy::cast_possible_truncation, reason = "there are at most as many as vertices")]
            let next = next as u32;
            // Adding 0 makes −0 the same as 0.
            *numbers.entry((position + 0.0).to_array().map(f64::to_bits)).or_insert(next)
        };
        let count = mesh.triangles.len();
        let corners = (0..count).map(|t| mesh.corners(t).map(&mut number)).collect();
        let normals = (0..count).map(|t| mesh.face_cross(t).normalize_or_zero()).collect();
        let low = mesh.positions.iter().copied().fold(DVec3::INFINITY, DVec3::min);
        let high = mesh.positions.iter().copied().fold(DVec3::NEG_INFINITY, DVec3::max);
        Self { corners, normals, size: (high - low).max_element().max(0.0) }
    }

    /// A number for each triangle, the same for those in one plane; `None` for those of curved surfaces.
    fn planes(&self, mesh: &Mesh) -> Vec<Option<u32>> {
        let pairs = self.adjacent();
        let mut groups = Groups::new(self.corners.len());
        for (a, b, angle) in &pairs {
            if *angle < FLAT {
                groups.join(*a, *b);
            }
        }
        let roots: Vec<usize> = (0..self.corners.len()).map(|triangle| groups.root(triangle)).collect();
        let mut is_curved = vec![false; roots.len()];
        for (a, b, angle) in &pairs {
            if *angle >= FLAT && *angle < CREASE {
                is_curved[roots[*a]] = true;
                is_curved[roots[*b]] = true;
            }
        }
        for (triangle, root) in roots.iter().enumerate() {
            is_curved[*root] |= self.off_plane(mesh, *root, triangle) > OFF_PLANE * self.size;
        }
        // Parts that don't touch are one face if they are in one plane.
        let mut planes = HashMap::new();
        let plane = |root: &usize| {
            #[allow(clippy::cast_possible_truncation, reason = "triangles are numbered by 32 bits")]
            let number = *planes.entry(self.plane(mesh, *root)).or_insert(*root as u32);
            (!is_curved[*root]).then_some(number)
        };
        roots.iter().map(plane).collect()
    }

    /// Pairs of triangles that share an edge, with the angle between their normals.
    fn adjacent(&self) -> Vec<(usize, usize, f64)> {
        let mut edges: BTreeMap<(u32, u32), Vec<usize>> = BTreeMap::new();
        for (triangle, [a, b, c]) in self.corners.iter().enumerate() {
            for (from, to) in [(a, b), (b, c), (c, a)] {
                edges.entry((*from, *to)).or_default().push(triangle);
            }
        }
        let mut pairs = Vec::new();
        for ((from, to), triangles) in &edges {
            for other in edges.get(&(*to, *from)).into_iter().flatten().filter(|_| from < to) {
                let angle = |triangle: usize| self.normals[triangle].angle_between(self.normals[*other]);
                pairs.extend(triangles.iter().map(|triangle| (*triangle, *other, angle(*triangle))));
            }
        }
        pairs
    }

    /// How far the corners of a triangle are from the plane of another.
    fn off_plane(&self, mesh: &Mesh, plane: usize, triangle: usize) -> f64 {
        let [origin, ..] = mesh.corners(plane);
        let off = |corner: DVec3| (corner - origin).dot(self.normals[plane]).abs();
        mesh.corners(triangle).map(off).into_iter().fold(0.0, f64::max)
    }

    /// The plane of a triangle, rounded.
    fn plane(&self, mesh: &Mesh, triangle: usize) -> [i64; 4] {
        let normal = self.normals[triangle];
        let [corner, ..] = mesh.corners(triangle);
        #[allow(clippy::cast_possible_truncation, reason = "what is too large for it is in other planes anyway")]
        let rounded = |x: f64, step: f64| (x / step).round() as i64;
        let [x, y, z] = normal.to_array().map(|x| rounded(x, FLAT));
        [x, y, z, rounded(corner.dot(normal), 2.0 * OFF_PLANE * self.size)]
    }

    /// The face that some triangles, all in one plane, make together.
    fn face(&self, mesh: &Mesh, triangles: &[usize]) -> Face {
        let largest = |a: &&usize, b: &&usize| mesh.face_cross(**a).length().total_cmp(&mesh.face_cross(**b).length());
        let plane = triangles.iter().max_by(largest).copied().unwrap_or_default();
        let (u, v) = self.normals[plane].any_orthonormal_pair();
        let mut known = BTreeSet::new();
        let mut is_new = |triangle: &&usize| {
            let mut corners = self.corners[**triangle];
            corners.sort_unstable();
            known.insert(corners)
        };
        let [origin, ..] = mesh.corners(plane);
        let flat = |corner: DVec3| DVec2::new((corner - origin).dot(u), (corner - origin).dot(v));
        // Edges between two of the triangles go both ways, and vanish.
        let mut edges: BTreeMap<(u32, u32), (i32, [DVec2; 2])> = BTreeMap::new();
        for triangle in triangles.iter().filter(&mut is_new) {
            let (numbers, points) = (self.corners[*triangle], mesh.corners(*triangle).map(flat));
            for (i, j) in [(0, 1), (1, 2), (2, 0)] {
                let (a, b) = (numbers[i], numbers[j]);
                let key = (a.min(b), a.max(b));
                let edge = if a < b { [points[i], points[j]] } else { [points[j], points[i]] };
                edges.entry(key).or_insert((0, edge)).0 += if a < b { 1 } else { -1 };
            }
        }
        let outline = edges.into_values().filter(|(count, _)| *count != 0);
        let outline = outline.map(|(count, [a, b])| if count > 0 { [a, b] } else { [b, a] }).collect();
        let thickness = triangles.iter().map(|t| self.off_plane(mesh, plane, *t)).fold(0.0, f64::max);
        Face::new(origin, [u, v], thickness, Outline::Polygon(outline))
    }
}

/// Disjoint sets of triangles, each known by its first.
struct Groups(Vec<usize>);

impl Groups {
    fn new(count: usize) -> Self {
        Self((0..count).collect())
    }

    fn root(&mut self, mut triangle: usize) -> usize {
        while self.0[triangle] != triangle {
            self.0[triangle] = self.0[self.0[triangle]];
            triangle = self.0[triangle];
        }
        triangle
    }

    fn join(&mut self, a: usize, b: usize) {
        let (a, b) = (self.root(a), self.root(b));
        self.0[a.max(b)] = a.min(b);
    }
}

#[cfg(test)]
mod tests {
    use core::f64::consts::PI;

    use glam::{DVec2, DVec3};

    use super::{Extents, Face};
    use crate::photon::kernel::Kernel;
    use crate::scene::{Geometry, Mesh};

    fn mesh(positions: &[[f64; 3]], triangles: &[[u32; 3]]) -> Geometry {
        let positions = positions.iter().copied().map(DVec3::from_array).collect();
        Geometry::Mesh(Mesh { positions, normals: None, triangles: triangles.to_vec() })
    }

    const RINGS: i32 = 600;

    /// Which share of rings about a point is where `inside` says, from the inner to the outer.
    fn shares(point: DVec2, radius: f64, inside: impl Fn(DVec2) -> bool) -> Vec<f64> {
        let spokes = 1200;
        let share = |ring: i32| {
            let t = (f64::from(ring) + 0.5) / f64::from(RINGS) * radius;
            let angle = |spoke: i32| (f64::from(spoke) + 0.5) / f64::from(spokes) * 2.0 * PI;
            let is_in = |spoke: i32| inside(point + DVec2::from_angle(angle(spoke)) * t);
            (0..spokes).map(|spoke| f64::from(u8::from(is_in(spoke)))).sum::<f64>() / f64::from(spokes)
        };
        (0..RINGS).map(share).collect()
    }

    /// The mass of a kernel on shares of rings, by the midpoint rule.
    fn midpoint(kernel: Kernel, shares: &[f64]) -> f64 {
        let ring = |(ring, share): (i32, &f64)| {
            let t = (f64::from(ring) + 0.5) / f64::from(RINGS);
            #[allow(clippy::cast_possible_truncation, reason = "as it is used")]
            let value = f64::from(kernel.value((t * t) as f32));
            value * share * 2.0 * PI * t / f64::from(RINGS)
        };
        (0..).zip(shares).map(ring).sum()
    }

    /// Compares the masses about points of a face with those of quadrature, whose error is a step of its grid at most.
    fn check(face: &Face, points: &[[f32; 3]], inside: impl Fn(DVec2) -> bool) {
        for (point, radius) in points.iter().flat_map(|point| [0.05, 0.4, 1.5, 6.0].map(|radius| (point, radius))) {
            let place = face.place(*point);
            assert!(inside(place), "{point:?}");
            let shares = shares(place, radius, &inside);
            for kernel in Kernel::ALL {
                let (mass, reference) = (face.mass(kernel, place, radius), midpoint(kernel, &shares));
                assert!(
                    (mass - reference.max(0.01)).abs() <= 2e-3,
                    "{kernel:?} {point:?} {radius}: {mass} {reference}"
                );
                if radius <= face.clearance(place) {
                    assert!((mass - 1.0).abs() <= 1e-8);
                }
            }
        }
    }

    #[test]
    fn masses_on_rectangles_are_those_of_quadrature() {
        let [half_u, half_v] = [DVec3::new(0.0, 1.0, 0.0), DVec3::new(0.0, 0.0, -2.0)];
        let shape = Geometry::Rectangle { center: DVec3::new(3.0, 1.0, 0.5), half_u, half_v, normal: DVec3::X };
        let extents = Extents::new([&shape]);
        let face = extents.face(0, 0).unwrap();
        let inside = |p: DVec2| p.x.abs() <= 1.0 && p.y.abs() <= 2.0;
        check(face, &[[3.0, 1.0, 0.5], [3.0, 1.9, 0.5], [3.0, 1.99, 2.4], [3.0, 0.25, -1.25]], inside);
        // On the outline and just beyond it, a half and a quarter.
        for off in [0.0, 1e-7, -1e-7] {
            let edge = face.mass(Kernel::Epanechnikov, DVec2::new(1.0 + off, 0.0), 0.5);
            let corner = face.mass(Kernel::Cone, DVec2::new(1.0 + off, 2.0 + off), 0.5);
            assert!((edge - 0.5).abs() <= 1e-6 && (corner - 0.25).abs() <= 1e-6, "{edge} {corner}");
        }
        assert_eq!(face.clearance(DVec2::new(0.5, 0.0)), 0.5);
    }

    #[test]
    fn masses_on_disks_are_those_of_quadrature() {
        let shape = Geometry::Disk { center: DVec3::new(0.0, 2.0, 0.0), radius: 1.2, normal: DVec3::Y };
        let extents = Extents::new([&shape]);
        let face = extents.face(0, 0).unwrap();
        let points = [[0.0, 2.0, 0.0], [0.3, 2.0, 0.4], [0.0, 2.0, 1.19], [-1.0, 2.0, 0.6]];
        check(face, &points, |p| p.length() <= 1.2);
        // A large disk's rim is straight.
        let large = Extents::new([&Geometry::Disk { center: DVec3::ZERO, radius: 1e6, normal: DVec3::Z }]);
        let half = large.face(0, 0).unwrap().mass(Kernel::Epanechnikov, DVec2::new(1e6, 0.0), 1.0);
        assert!((half - 0.5).abs() <= 1e-6, "{half}");
    }

    #[test]
    fn coplanar_triangles_are_one_face_whatever_its_form() {
        // An L of three squares, of which one meets the others along half an edge each; and an island.
        let positions = [
            [0.0, 0.0, 1.0],
            [2.0, 0.0, 1.0],
            [2.0, 1.0, 1.0],
            [0.0, 1.0, 1.0],
            [1.0, 1.0, 1.0],
            [1.0, 2.0, 1.0],
            [0.0, 2.0, 1.0],
            [4.0, 0.0, 1.0],
            [5.0, 0.0, 1.0],
            [5.0, 1.0, 1.0],
            [4.0, 1.0, 1.0],
        ];
        let triangles = [[0, 1, 2], [0, 2, 3], [3, 4, 5], [3, 5, 6], [7, 8, 9], [7, 9, 10], [7, 9, 10]];
        let extents = Extents::new([&mesh(&positions, &triangles)]);
        let face = extents.face(0, 0).unwrap();
        for triangle in 1..7 {
            assert!(core::ptr::eq(face, extents.face(0, triangle).unwrap()));
        }
        assert!(extents.face(0, 7).is_none() && extents.face(1, 0).is_none());
        let place = |x: f32, y: f32| face.place([x, y, 1.0]);
        let [origin, x, y] = [place(0.0, 0.0), place(1.0, 0.0) - place(0.0, 0.0), place(0.0, 1.0) - place(0.0, 0.0)];
        let inside = |p: DVec2| {
            let (a, b) = ((p - origin).dot(x), (p - origin).dot(y));
            let within = |x: [f64; 2], y: [f64; 2]| a >= x[0] && a <= x[1] && b >= y[0] && b <= y[1];
            within([0.0, 2.0], [0.0, 1.0]) || within([0.0, 1.0], [1.0, 2.0]) || within([4.0, 5.0], [0.0, 1.0])
        };
        check(face, &[[0.9, 0.9, 1.0], [1.5, 0.5, 1.0], [0.5, 1.05, 1.0], [4.2, 0.2, 1.0], [1.9, 0.95, 1.0]], inside);
    }

    #[test]
    fn sharp_edges_part_faces_and_blunt_ones_do_not() {
        // A prism about z with caps.
        let prism = |sides: u32| {
            let angle = |i: u32| f64::from(i) / f64::from(sides) * 2.0 * PI;
            let ring = (0..sides).flat_map(|i| [0.0, 1.0].map(|z| [angle(i).cos(), angle(i).sin(), z]));
            let positions: Vec<_> = ring.collect();
            let next = |i: u32| (i + 1) % sides;
            let side = |i: u32| [[2 * i, 2 * next(i), 2 * next(i) + 1], [2 * i, 2 * next(i) + 1, 2 * i + 1]];
            let cap = |i: u32| [[0, 2 * next(i), 2 * i], [1, 2 * i + 1, 2 * next(i) + 1]];
            let triangles: Vec<_> = (0..sides).flat_map(side).chain((1..sides - 1).flat_map(cap)).collect();
            mesh(&positions, &triangles)
        };
        let (box_, cylinder) = (prism(4), prism(60));
        let extents = Extents::new([&box_, &cylinder]);
        assert_eq!(extents.shapes[0].faces.len(), 6);
        assert!(extents.shapes[0].of_triangles.iter().all(Option::is_some));
        assert_eq!(extents.shapes[1].faces.len(), 2);
        assert!((0..120).all(|side| extents.face(1, side).is_none()) && extents.face(1, 120).is_some());
        let cap = extents.face(1, 121).unwrap();
        assert!((cap.clearance(cap.place([0.0, 0.0, 1.0])) - (PI / 60.0).cos()).abs() <= 1e-12);
        assert!(cap.normal().z.abs() >= 1.0 - 1e-12 && cap.thickness() <= 1e-12);
        let sphere = Geometry::Sphere { center: DVec3::ZERO, radius: 1.0, inward: false, axis: DVec3::Z };
        assert!(Extents::new([&sphere]).face(0, 0).is_none());
    }
}
