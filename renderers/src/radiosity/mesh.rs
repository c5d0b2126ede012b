//! Patches: the scene's diffuse and shining surfaces as convex polygons, each the root of a tree of halves.

use glam::{DVec3, Vec3A};

use spectral_core::brdf::Schlick;

use super::Others;
use super::cluster::{self, Cluster, clusters};
use super::error::RadiosityError;
use super::polygon::{MOST_PATCH_CORNERS, Polygon};
use super::specular::{self, Kind};
use crate::geometry::{Mesh, NO_PRIMITIVE, Parallelogram, Surface, World};
use crate::material::mean_mirror;
use crate::scene::{BsdfId, BsdfKind, Emitter, Geometry, Scene, Shape};
use crate::spectral::{Factor, Palette, Role};

/// No children.
pub(super) const LEAF: u32 = u32::MAX;
/// Corners of the regular polygon, of the disk's area, that stands for a disk.
const DISK_CORNERS: u32 = 24;
/// How often the faces of an icosahedron are split in four to make the polyhedron, of the sphere's area, that stands for a sphere.
const SPHERE_LEVELS: u32 = 2;
/// Surfaces nearer to each other than this share of their radii are in contact as far as light and shadow go.
const CLOSE: f64 = 0.1;
/// Lengths below this share of the scene's largest coordinate are 0.
pub(super) const RELATIVE_SLACK: f64 = 1e-10;

/// What one side of a surface does.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Side {
    pub(super) reflectance: Factor,
    /// Its radiance, if it shines.
    pub(super) emission: Option<Factor>,
    /// Whether it is a mirror, which counts as diffuse where light is exchanged between patches.
    pub(super) mirror: bool,
}

/// How a patch is split.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Cut {
    /// Across its longest edge.
    Longest,
    /// Across an edge.
    Across(u8),
    /// A triangle's corner is cut off.
    Corner(u8),
}

/// A patch or a group of them.
#[derive(Clone, Copy, Debug)]
pub(super) struct Node {
    pub(super) polygon: Polygon,
    /// The index of its [`Side`].
    pub(super) side: u32,
    /// The primitive that it is a part of.
    pub(super) primitive: u32,
    /// The first of its two halves, or [`LEAF`].
    pub(super) child: u32,
}

/// All patches, halves after what they are halves of.
#[derive(Clone, Debug)]
pub(super) struct Patches {
    pub(super) nodes: Vec<Node>,
    pub(super) sides: Vec<Side>,
    /// How many of the nodes, the first, are roots.
    pub(super) roots: usize,
    /// Groups of roots, parents before their children; none where roots are few.
    pub(super) clusters: Vec<Cluster>,
    /// The roots that shine.
    pub(super) lamps: Vec<u32>,
    /// What blocks: every surface but clear ones. Primitives of shapes with mirrors come last.
    pub(super) world: World,
    /// The first primitive of each shape of the scene; [`NO_PRIMITIVE`] for those that don't block.
    pub(super) starts: Vec<u32>,
    /// The polygon of each primitive of the world, or of the face that it is a triangle of.
    pub(super) blockers: Vec<Polygon>,
    /// The first primitive of the face that each primitive is a part of.
    pub(super) face: Vec<u32>,
    /// Lengths below this are 0.
    pub(super) slack: f64,
}

impl Node {
    pub(super) const fn children(&self) -> Option<[usize; 2]> {
        if self.child == LEAF { None } else { Some([self.child as usize, self.child as usize + 1]) }
    }
}

impl Patches {
    /// Makes patches of a scene; its spectra are added to the palette.
    pub(super) fn new(scene: &Scene, others: Others, palette: &mut Palette) -> Result<Self, RadiosityError> {
        let mut surfaces = Vec::new();
        let (mut blockers, mut face, mut sides, mut faces) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        let mut starts = vec![NO_PRIMITIVE; scene.shapes.len()];
        for (number, shape) in blocking(scene, others) {
            let (surface, polygons) = tessellated(&shape.geometry);
            if let Some(start) = starts.get_mut(number as usize) {
                *start = u32::try_from(blockers.len()).unwrap_or(NO_PRIMITIVE);
            }
            let extent = polygons.iter().flatten().flat_map(Polygon::corners);
            let extent = extent.fold(0.0_f64, |extent, c| extent.max(c.abs().max_element()));
            surfaces.push((number, surface));
            let of_shape = sides_of(scene, shape, others, palette)?;
            let first = sides.len();
            sides.extend(of_shape.iter().map(|(side, _)| *side));
            let polygons: Option<Vec<Polygon>> = polygons.into_iter().collect();
            let polygons = polygons.ok_or_else(|| RadiosityError::Degenerate { label: shape.label.clone() })?;
            for (polygon, count) in joined(&polygons, RELATIVE_SLACK * extent) {
                let primitive = u32::try_from(blockers.len()).unwrap_or(NO_PRIMITIVE);
                for (place, (_, front)) in of_shape.iter().enumerate() {
                    let side = u32::try_from(first + place).unwrap_or(u32::MAX);
                    faces.push((if *front { polygon } else { polygon.flipped() }, side, primitive));
                }
                blockers.extend(core::iter::repeat_n(polygon, count));
                face.extend(core::iter::repeat_n(primitive, count));
            }
        }
        let world = World::new(&surfaces).map_err(RadiosityError::Geometry)?;
        let [low, high] = world.bounds();
        let slack = RELATIVE_SLACK * f64::from(low.abs().max(high.abs()).max_element());
        let mut nodes = Vec::new();
        let neighbours = Neighbours { world: &world, blockers: &blockers, face: &face, slack };
        for (polygon, side, primitive) in faces {
            for polygon in neighbours.cut(polygon, primitive) {
                nodes.push(Node { polygon, side, primitive, child: LEAF });
            }
        }
        let clusters = clusters(&nodes, &sides);
        let shines = |root: &u32| sides[nodes[*root as usize].side as usize].emission.is_some();
        let lamps = (0..).take(nodes.len()).filter(shines).collect();
        Ok(Self { roots: nodes.len(), clusters, lamps, nodes, sides, world, starts, blockers, face, slack })
    }

    /// The area of a patch or of a cluster, by its number.
    pub(super) fn area(&self, number: u32) -> f64 {
        cluster::index(number).map_or_else(|| self.nodes[number as usize].polygon.area, |c| self.clusters[c].area)
    }

    /// Bytes of patches and clusters.
    pub(super) fn bytes(&self) -> usize {
        size_of_val(&*self.nodes) + size_of_val(&*self.clusters)
    }

    /// The number among all patches and clusters, which come after these.
    pub(super) fn row(&self, number: u32) -> usize {
        cluster::index(number).map_or(number as usize, |c| self.nodes.len() + c)
    }

    /// Gives a patch halves, if it has none; false if it is too small for that.
    pub(super) fn split(&mut self, node: usize) -> bool {
        self.split_by(node, Cut::Longest)
    }

    /// The same with a cut that is chosen.
    pub(super) fn split_by(&mut self, node: usize, cut: Cut) -> bool {
        let parent = self.nodes[node];
        if parent.child != LEAF {
            return true;
        }
        let least = 16.0 * self.slack;
        let halves = match cut {
            Cut::Longest => parent.polygon.halves(),
            Cut::Across(edge) => parent.polygon.halves_across(edge.into()),
            Cut::Corner(corner) => parent.polygon.corner_and_rest(corner.into()),
        };
        let Some(halves) = halves.filter(|halves| halves.iter().all(|h| h.radius > least)) else { return false };
        let Ok(child) = u32::try_from(self.nodes.len()) else { return false };
        self.nodes.extend(halves.map(|polygon| Node { polygon, child: LEAF, ..parent }));
        self.nodes[node].child = child;
        true
    }

    /// The patches without halves, in order.
    pub(super) fn leaves(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.nodes.len()).filter(|n| self.nodes[*n].child == LEAF)
    }
}

/// Whether a surface reflects diffusely, be it nothing at all.
pub(super) fn is_diffuse_somewhere(scene: &Scene) -> bool {
    let diffuse = |id: BsdfId| {
        matches!(scene.bsdf(id).kind, BsdfKind::Diffuse { .. } | BsdfKind::Schlick { .. } | BsdfKind::Ward { .. })
    };
    scene.shapes.iter().any(|shape| match scene.bsdf(shape.bsdf).kind {
        BsdfKind::TwoSided { front, back } => diffuse(front) || diffuse(back),
        _ => diffuse(shape.bsdf),
    })
}

/// What a shape does on the sides that reflect or shine, each with whether it is the front.
fn sides_of(
    scene: &Scene,
    shape: &Shape,
    others: Others,
    palette: &mut Palette,
) -> Result<Vec<(Side, bool)>, RadiosityError> {
    let [front, back] = match &scene.bsdf(shape.bsdf).kind {
        BsdfKind::TwoSided { front, back } => [Some(*front), Some(*back)],
        _ => [Some(shape.bsdf), None],
    };
    let is_mirror = |id: Option<BsdfId>| id.is_some_and(|id| matches!(scene.bsdf(id).kind, BsdfKind::Conductor { .. }));
    let mirrors = [front, back].map(is_mirror);
    let mut reflectance = |id: Option<BsdfId>| match id.map(|id| scene.bsdf(id)) {
        None => Ok(Factor { scale: 0.0, leaf: None }),
        Some(bsdf) => match &bsdf.kind {
            BsdfKind::Diffuse { reflectance } => Ok(palette.factor(scene.spectrum(*reflectance), Role::Reflectance)),
            _ if others == Others::Refused => Err(RadiosityError::Material { label: bsdf.label.clone() }),
            BsdfKind::Schlick { reflectance, roughness, isotropy } => {
                let specular = Schlick::new(*roughness, *isotropy).map_or(0.0, |model| model.weights()[2]);
                let all = palette.factor(scene.spectrum(*reflectance), Role::Reflectance);
                Ok(Factor { scale: all.scale * (1.0 - specular), ..all })
            }
            BsdfKind::Ward { diffuse_reflectance, .. } => {
                Ok(palette.factor(scene.spectrum(*diffuse_reflectance), Role::Reflectance))
            }
            BsdfKind::Conductor { fresnel, specular_reflectance } => {
                let weight = palette.factor(scene.spectrum(*specular_reflectance), Role::Reflectance);
                Ok(mean_mirror(scene, fresnel, weight, palette))
            }
            _ => Ok(Factor { scale: 0.0, leaf: None }),
        },
    };
    let (front, back) = (reflectance(front)?, reflectance(back)?);
    let emission = match shape.emitter.map(|id| scene.emitter(id)) {
        Some(Emitter::Area { radiance, .. }) => Some(palette.factor(scene.spectrum(*radiance), Role::Light)),
        _ => None,
    };
    let sides = [
        (Side { reflectance: front, emission, mirror: mirrors[0] }, true),
        (Side { reflectance: back, emission: None, mirror: mirrors[1] }, false),
    ];
    Ok(sides.into_iter().filter(|(side, _)| side.reflectance.scale > 0.0 || side.emission.is_some()).collect())
}

/// The shapes that block light between patches, in the order of their primitives.
fn blocking(scene: &Scene, others: Others) -> impl Iterator<Item = (u32, &Shape)> {
    let kinds = specular::in_order(scene).into_iter();
    let blocks = move |(kind, ..): &(Kind, u32, &Shape)| others == Others::Refused || *kind != Kind::Clear;
    kinds.filter(blocks).map(|(_, number, shape)| (number, shape))
}

/// A shape as the ray kernel takes it, and a polygon for each of its primitives.
pub(super) fn tessellated(geometry: &Geometry) -> (Surface, Vec<Option<Polygon>>) {
    match geometry {
        Geometry::Rectangle { center, half_u, half_v, normal } => {
            let (u, v) = if half_u.cross(*half_v).dot(*normal) >= 0.0 { (half_u, half_v) } else { (half_v, half_u) };
            let corners = [*center - *u - *v, *center + *u - *v, *center + *u + *v, *center - *u + *v];
            let surface = Surface::Parallelogram(Parallelogram {
                corner: corners[0].as_vec3a(),
                edge_u: (*u * 2.0).as_vec3a(),
                edge_v: (*v * 2.0).as_vec3a(),
            });
            (surface, vec![Polygon::new(&corners, *normal)])
        }
        Geometry::Disk { center, radius, normal } => triangulated(disk(*center, *radius, *normal)),
        Geometry::Sphere { center, radius, inward, .. } => triangulated(sphere(*center, *radius, *inward)),
        Geometry::Mesh(mesh) => triangulated((mesh.positions.clone(), mesh.triangles.clone())),
    }
}

/// Polygons, with two triangles that follow each other as one if they are halves of a convex quadrilateral; with how many each is made of.
fn joined(polygons: &[Polygon], slack: f64) -> Vec<(Polygon, usize)> {
    let (mut result, mut rest) = (Vec::new(), polygons);
    while let Some((one, others)) = rest.split_first() {
        let both = others.first().and_then(|other| quadrilateral(one, other, slack));
        let count = if both.is_some() { 2 } else { 1 };
        result.push((both.unwrap_or(*one), count));
        rest = &rest[count..];
    }
    result
}

/// Two triangles with a common edge as one convex quadrilateral, if they are in one plane.
fn quadrilateral(one: &Polygon, other: &Polygon, slack: f64) -> Option<Polygon> {
    let ([a, b, c], [d, e, f]) =
        (<[DVec3; 3]>::try_from(one.corners()).ok()?, <[DVec3; 3]>::try_from(other.corners()).ok()?);
    let turns = |[a, b, c]: [DVec3; 3]| [[a, b, c], [b, c, a], [c, a, b]];
    for [a, b, c] in turns([a, b, c]) {
        for [d, e, f] in turns([d, e, f]) {
            // The edge from a to b is the other's from e to d.
            let flat = (f - a).dot(one.normal).abs() <= slack && one.normal.dot(other.normal) > 0.5;
            let corners = [a, f, b, c];
            let turn = |i: usize| {
                let [x, y, z] = [0, 1, 2].map(|k| corners[(i + k) % 4]);
                (y - x).cross(z - y).dot(one.normal) > 1e-3 * (y - x).length() * (z - y).length()
            };
            if a == e && b == d && flat && (0..4).all(turn) {
                return Polygon::new(&corners, one.normal);
            }
        }
    }
    None
}

fn triangulated((positions, triangles): (Vec<DVec3>, Vec<[u32; 3]>)) -> (Surface, Vec<Option<Polygon>>) {
    let polygon = |corners: [DVec3; 3]| {
        let [a, b, c] = corners;
        Polygon::new(&corners, (b - a).cross(c - a).try_normalize()?)
    };
    let polygons = triangles.iter().map(|t| polygon(t.map(|i| positions[i as usize]))).collect();
    let positions: Vec<Vec3A> = positions.iter().map(|p| p.as_vec3a()).collect();
    (Surface::Mesh(Mesh { positions, triangles, normals: Vec::new() }), polygons)
}

/// A regular polygon of the disk's area, as triangles about its centre.
fn disk(centre: DVec3, radius: f64, normal: DVec3) -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let (u, v) = normal.any_orthonormal_pair();
    let step = core::f64::consts::TAU / f64::from(DISK_CORNERS);
    let reach = radius * (step / step.sin()).sqrt();
    let rim = (0..DISK_CORNERS).map(|i| {
        let (sine, cosine) = (step * f64::from(i)).sin_cos();
        centre + (u * cosine + v * sine) * reach
    });
    let triangles = (0..DISK_CORNERS).map(|i| [0, i + 1, (i + 1) % DISK_CORNERS + 1]).collect();
    (core::iter::once(centre).chain(rim).collect(), triangles)
}

/// A polyhedron of the sphere's area.
fn sphere(centre: DVec3, radius: f64, inward: bool) -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let (mut positions, mut triangles) = icosahedron();
    for _ in 0..SPHERE_LEVELS {
        let mut middles = std::collections::HashMap::new();
        let mut finer = Vec::with_capacity(4 * triangles.len());
        for [a, b, c] in triangles {
            let mut middle = |i: u32, j: u32| {
                *middles.entry((i.min(j), i.max(j))).or_insert_with(|| {
                    positions.push((positions[i as usize] + positions[j as usize]).normalize());
                    u32::try_from(positions.len() - 1).unwrap_or(0)
                })
            };
            let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
            finer.extend([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]);
        }
        triangles = finer;
    }
    let corner = |i: u32| positions[i as usize];
    let area: f64 =
        triangles.iter().map(|&[a, b, c]| (corner(b) - corner(a)).cross(corner(c) - corner(a)).length()).sum();
    let scale = radius * (8.0 * core::f64::consts::PI / area).sqrt();
    let positions = positions.iter().map(|p| centre + *p * scale).collect();
    if inward {
        triangles.iter_mut().for_each(|t| t.swap(1, 2));
    }
    (positions, triangles)
}

/// Unit vertices, and faces that run anticlockwise seen from outside.
pub(super) fn icosahedron() -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let golden = f64::midpoint(1.0, 5.0_f64.sqrt());
    let mut positions = Vec::new();
    for (a, b) in [(1.0, golden), (-1.0, golden), (1.0, -golden), (-1.0, -golden)] {
        positions.extend([DVec3::new(0.0, a, b), DVec3::new(a, b, 0.0), DVec3::new(b, 0.0, a)]);
    }
    let positions: Vec<DVec3> = positions.into_iter().map(DVec3::normalize).collect();
    let neighbours = |i: usize, j: usize| positions[i].dot(positions[j]) > 0.4;
    let mut triangles = Vec::new();
    for i in 0..12 {
        for j in (i + 1..12).filter(|j| neighbours(i, *j)) {
            for k in (j + 1..12).filter(|k| neighbours(i, *k) && neighbours(j, *k)) {
                let volume = positions[i].dot(positions[j].cross(positions[k]));
                let [a, b, c] = if volume > 0.0 { [i, j, k] } else { [i, k, j] };
                triangles.push([a, b, c].map(|x| u32::try_from(x).unwrap_or(0)));
            }
        }
    }
    (positions, triangles)
}

/// Where surfaces touch or pass through others, these are cut, so that no patch has light on one side and shadow on the other of a wall
/// that stands on it (D. R. Baum, S. Mann, K. P. Smith & J. M. Winget, "Making radiosity usable", SIGGRAPH 1991).
struct Neighbours<'b> {
    world: &'b World,
    blockers: &'b [Polygon],
    face: &'b [u32],
    slack: f64,
}

impl Neighbours<'_> {
    /// The faces that may touch a polygon, in order of where along x they begin.
    fn near(&self, polygon: &Polygon) -> Vec<usize> {
        let wider = CLOSE * polygon.radius + self.slack;
        let low = polygon.corners().iter().fold(DVec3::INFINITY, |low, c| low.min(*c)) - wider;
        let high = polygon.corners().iter().fold(DVec3::NEG_INFINITY, |high, c| high.max(*c)) + wider;
        // Boxes are rounded to the precision of rays.
        let rounding = Vec3A::splat(2.0 * f32::EPSILON) * low.as_vec3a().abs().max(high.as_vec3a().abs());
        let found = self.world.primitives_near(low.as_vec3a() - rounding, high.as_vec3a() + rounding);
        let begin = |index: usize| (self.blockers[index].centre.x - self.blockers[index].radius, index);
        let mut near: Vec<(f64, usize)> =
            found.iter().filter_map(|p| self.face.get(*p as usize)).map(|face| begin(*face as usize)).collect();
        near.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        near.dedup();
        near.into_iter().map(|(_, index)| index).collect()
    }

    /// The pieces of a polygon, which is or was on a primitive.
    fn cut(&self, polygon: Polygon, primitive: u32) -> Vec<Polygon> {
        let mut pieces = vec![polygon];
        for index in self.near(&polygon) {
            let other = &self.blockers[index];
            let apart = (other.centre - polygon.centre).length() > other.radius + polygon.radius + self.slack;
            if index != primitive as usize && !apart {
                for segment in self.contact(&polygon, other) {
                    pieces = pieces.iter().flat_map(|piece| self.cut_along(piece, segment)).collect();
                }
            }
        }
        pieces.into_iter().flat_map(few_corners).collect()
    }

    /// The segments of a polygon's plane that another polygon touches.
    fn contact(&self, polygon: &Polygon, other: &Polygon) -> Vec<[DVec3; 2]> {
        let height = |x: DVec3| {
            let height = (x - polygon.centre).dot(polygon.normal);
            if height.abs() <= self.slack { 0.0 } else { height }
        };
        // What is parallel and as good as in contact, such as a lamp under a ceiling, parts light from shadow along its outline.
        let near = other.corners().iter().all(|c| height(*c).abs() <= CLOSE * other.radius.min(polygon.radius));
        if near {
            let flat = |c: DVec3| c - polygon.normal * height(c);
            return other.edges().map(|edge| edge.map(flat)).collect();
        }
        let mut ends: Vec<DVec3> = Vec::new();
        for [a, b] in other.edges() {
            let (from, to) = (height(a), height(b));
            if from == 0.0 {
                ends.push(a);
            } else if from * to < 0.0 {
                ends.push(a + (b - a) * (from / (from - to)));
            }
        }
        match ends[..] {
            [a, b] => vec![[a, b]],
            _ => Vec::new(),
        }
    }

    /// One or two pieces.
    fn cut_along(&self, piece: &Polygon, [a, b]: [DVec3; 2]) -> Vec<Polygon> {
        let Some(along) = (b - a).try_normalize() else { return vec![*piece] };
        // The part of the segment inside the piece.
        let (mut from, mut to) = (0.0_f64, (b - a).length());
        for [c, d] in piece.edges() {
            let inward = piece.normal.cross(d - c).normalize_or_zero();
            let (height, slope) = ((a - c).dot(inward) - self.slack, along.dot(inward));
            if slope.abs() * (to - from) <= self.slack {
                if height <= 0.0 {
                    return vec![*piece];
                }
            } else if slope > 0.0 {
                from = from.max(-height / slope);
            } else {
                to = to.min(-height / slope);
            }
        }
        if to - from <= self.slack {
            return vec![*piece];
        }
        let across = piece.normal.cross(along);
        match (piece.above(a, across, self.slack), piece.above(a, -across, self.slack)) {
            (Some(one), Some(other)) => vec![one, other],
            _ => vec![*piece],
        }
    }
}

/// Halves until there are few enough corners.
pub(super) fn few_corners(polygon: Polygon) -> Vec<Polygon> {
    if polygon.corners().len() <= MOST_PATCH_CORNERS {
        return vec![polygon];
    }
    polygon.halves().map_or_else(|| vec![polygon], |halves| halves.into_iter().flat_map(few_corners).collect())
}
