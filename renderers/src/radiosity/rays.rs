//! Irradiance at any place from the patches, by rays: less exact than closed forms, and a hundred times as fast; and it sees shadows of
//! direct light within patches.

use core::f64::consts::TAU;

use glam::DVec3;

use super::mesh::{LEAF, Patches};
use super::polygon::Polygon;
use super::sight::surface_point;
use super::specular::{End, Specular, Tint};
use crate::geometry::Hit;

/// The share of a turn between neighbouring rays: the golden section.
const GOLDEN: f64 = 0.618_033_988_749_894_9;

/// Finds the part of a patch that a place is on. Patches are in parts for their direct light, and in groups of these for what they receive
/// from each other.
#[derive(Clone, Debug)]
pub(super) struct Lookup {
    /// For each node, and after them for each part of a leaf: the line between its halves, the first half where (x, 1)·line ≤ 0; and the
    /// first half.
    halves: Vec<([f64; 4], u32)>,
    /// For each of them, the number of the part if it is one.
    numbers: Vec<u32>,
    pub(super) parts: Vec<Part>,
    pub(super) groups: Vec<Part>,
    /// For each primitive, the roots on its back and on its front.
    sides: Vec<[Vec<u32>; 2]>,
}

/// A part of a leaf, or a group of parts.
#[derive(Clone, Copy, Debug)]
pub(super) struct Part {
    pub(super) polygon: Polygon,
    /// The node that it is a part of.
    pub(super) node: u32,
    /// The group that it is in.
    pub(super) group: u32,
}

impl Lookup {
    /// Parts of leaves and groups of them have at most these areas.
    pub(super) fn new(patches: &Patches, [largest, largest_group]: [f64; 2]) -> Self {
        let halves = patches.nodes.iter().map(|node| match node.children() {
            None => ([0.0; 4], LEAF),
            Some([first, _]) => (line(&patches.nodes[first].polygon), node.child),
        });
        let mut sides = vec![[Vec::new(), Vec::new()]; patches.blockers.len()];
        for (number, node) in (0..).zip(&patches.nodes[..patches.roots]) {
            let front = patches.blockers[node.primitive as usize].normal.dot(node.polygon.normal) > 0.0;
            sides[node.primitive as usize][usize::from(front)].push(number);
        }
        let mut lookup =
            Self { halves: halves.collect(), numbers: Vec::new(), parts: Vec::new(), groups: Vec::new(), sides };
        lookup.numbers = vec![LEAF; lookup.halves.len()];
        for leaf in patches.leaves() {
            let node = u32::try_from(leaf).unwrap_or(LEAF);
            let part = Part { polygon: patches.nodes[leaf].polygon, node, group: LEAF };
            lookup.add(leaf, part, [largest.min(largest_group), largest_group]);
        }
        lookup
    }

    fn add(&mut self, place: usize, mut part: Part, areas: [f64; 2]) {
        let [largest, largest_group] = areas;
        if part.group == LEAF && part.polygon.area <= largest_group {
            part.group = u32::try_from(self.groups.len()).unwrap_or(LEAF);
            self.groups.push(part);
        }
        if part.polygon.area > largest
            && let Some(halves) = part.polygon.halves()
        {
            let child = self.halves.len();
            self.halves[place] = (line(&halves[0]), u32::try_from(child).unwrap_or(LEAF));
            self.halves.extend([([0.0; 4], LEAF); 2]);
            self.numbers.extend([LEAF; 2]);
            for (offset, polygon) in halves.into_iter().enumerate() {
                self.add(child + offset, Part { polygon, ..part }, areas);
            }
            return;
        }
        if part.group == LEAF {
            // Too small to be split, whatever was asked for.
            part.group = u32::try_from(self.groups.len()).unwrap_or(LEAF);
            self.groups.push(part);
        }
        self.numbers[place] = u32::try_from(self.parts.len()).unwrap_or(LEAF);
        self.parts.push(part);
    }

    /// The number that stands for what a side sends out by itself.
    fn lamp(&self, side: u32) -> u32 {
        u32::try_from(self.parts.len()).unwrap_or(LEAF).saturating_add(side)
    }

    /// The part that was hit.
    pub(super) fn part(&self, patches: &Patches, hit: &Hit) -> Option<u32> {
        let face = *patches.face.get(hit.primitive as usize)?;
        let roots = &self.sides.get(face as usize)?[usize::from(hit.front)];
        let position = hit.position.as_dvec3();
        let mut node = match roots[..] {
            [] => return None,
            [root] => root,
            _ => nearest(patches, roots, position)?,
        };
        loop {
            let ([a, b, c, d], child) = self.halves[node as usize];
            if child == LEAF {
                return self.numbers.get(node as usize).copied();
            }
            let above = a * position.x + b * position.y + c * position.z + d > 0.0;
            node = child + u32::from(above);
        }
    }
}

/// The plane between a first half and the other one, across their own plane.
pub(super) fn line(first: &Polygon) -> [f64; 4] {
    let corners = first.corners();
    let (Some(cut), Some(end)) = (corners.first(), corners.last()) else { return [0.0; 4] };
    // From the end back to the cut, the first half is on the left.
    let inward = first.normal.cross(*cut - *end);
    let [a, b, c] = (-inward).to_array();
    [a, b, c, inward.dot(*cut)]
}

/// The root that a place is in, or is the least outside of.
pub(super) fn nearest(patches: &Patches, roots: &[u32], place: DVec3) -> Option<u32> {
    let mut best = None;
    let mut least = f64::NEG_INFINITY;
    for root in roots {
        let polygon = &patches.nodes[*root as usize].polygon;
        let depth = |[a, b]: [DVec3; 2]| {
            let along = b - a;
            polygon.normal.cross(along).dot(place - a) / along.length()
        };
        let own = polygon.edges().map(depth).fold(f64::INFINITY, f64::min);
        if own > least {
            (best, least) = (Some(*root), own);
            if own >= 0.0 {
                break;
            }
        }
    }
    best
}

/// A part of a patch, or anything with a radiosity, that rays found.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Found {
    /// Its number; after all parts, the numbers of sides stand for what they send out by themselves.
    pub(crate) part: u32,
    /// What its light is multiplied by on its way.
    pub(crate) tint: Tint,
    /// The share of the rays, each times what it leaves of light: the configuration factor where none met mirrors or glass.
    pub(crate) share: f64,
}

/// Where rays from a place go.
#[derive(Clone, Copy)]
pub(super) struct Rays<'r> {
    pub(super) lookup: &'r Lookup,
    pub(super) specular: Option<&'r Specular<'r>>,
    /// Whether lamps count that are found by way of mirrors and glass.
    pub(super) lamps: bool,
    pub(super) count: u32,
}

impl Rays<'_> {
    /// The directions of rays: spread over the hemisphere like the seeds of a sunflower over its disk, so that each stands for an
    /// equal share of the irradiance of an even sky.
    fn directions(&self, normal: DVec3) -> impl Iterator<Item = (u32, DVec3)> + use<> {
        let (u, v) = normal.any_orthonormal_pair();
        let count = self.count;
        (0..count).map(move |index| {
            let squared = (f64::from(index) + 0.5) / f64::from(count);
            let (sine, cosine) = (TAU * (GOLDEN * f64::from(index)).fract()).sin_cos();
            (index, (u * cosine + v * sine) * squared.sqrt() + normal * (1.0 - squared).sqrt())
        })
    }
}

impl Patches {
    /// The parts that rays from a place find.
    pub(super) fn found_by_rays(&self, rays: Rays<'_>, position: DVec3, normal: DVec3, primitive: u32) -> Vec<Found> {
        let point = surface_point(position, normal, primitive);
        let directions = rays.directions(normal).map(|(index, direction)| (index, point.ray(direction.as_vec3a())));
        let count = f64::from(rays.count);
        let Some(specular) = rays.specular else {
            let hits = directions.filter_map(|(_, ray)| rays.lookup.part(self, &self.world.closest_hit(&ray)?));
            let mut hits: Vec<u32> = hits.collect();
            hits.sort_unstable();
            #[allow(clippy::cast_precision_loss, reason = "a count of rays")]
            let share = |same: &[u32]| Found { part: same[0], tint: Tint::default(), share: same.len() as f64 / count };
            return hits.chunk_by(|a, b| a == b).map(share).collect();
        };
        let mut found: Vec<Found> = Vec::with_capacity(rays.count as usize);
        for (index, ray) in directions {
            if let Some(end) = specular.follow(ray, index) {
                self.add_found(rays, &end, &mut found);
            }
        }
        let key = |found: &Found| (found.tint, found.part);
        found.sort_by_key(key);
        let sum = |same: &[Found]| Found { share: same.iter().map(|f| f.share).sum::<f64>() / count, ..same[0] };
        found.chunk_by(|a, b| key(a) == key(b)).map(sum).collect()
    }

    /// Adds what a ray found.
    fn add_found(&self, rays: Rays<'_>, end: &End, found: &mut Vec<Found>) {
        let Some(part) = rays.lookup.part(self, &end.hit) else { return };
        let one = Found { part, tint: end.tint, share: end.weight };
        found.push(one);
        if rays.lamps && end.bent {
            let side = self.nodes[rays.lookup.parts[part as usize].node as usize].side;
            if self.sides[side as usize].emission.is_some() {
                found.push(Found { part: rays.lookup.lamp(side), ..one });
            }
        }
    }
}
