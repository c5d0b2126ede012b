//! Photons on surfaces, ordered so that those near a point are found at once.

use core::ops::Range;

use rayon::prelude::*;

use super::Photon;

/// Photons in a leaf: a few vector registers for each coordinate.
pub(super) const LEAF: usize = 16;
/// Leaves whose photons are about as many as an estimate takes.
const FEW_LEAVES: usize = 4;
/// Trees of fewer photons are built by one thread.
const PARALLEL: usize = 4096;
/// Leaves are numbered by 32 bits, so a tree has fewer levels than this.
const DEPTH: usize = 32;
/// Branches that wait in a search at most.
pub(super) const WAITING: usize = DEPTH;
/// Coordinates beyond this are refused: the squares of distances stay finite.
const LARGEST: f32 = 1e12;

/// A photon near a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Near {
    /// The square of its distance, in square scene units.
    pub(crate) distance2: f32,
    /// Its index among [`PhotonMap::photons`].
    pub(crate) photon: u32,
}

impl Near {
    /// Orders by distance, then by index; distances are neither negative nor NaN.
    const fn key(&self) -> u64 {
        (self.distance2.to_bits() as u64) << 32 | self.photon as u64
    }
}

/// The part of space in which photons count for a point: those with distance d ≤ `radius` whose offset h from the point's tangent plane
/// is small, h² ≤ `thickness`² + (`slope` d)².
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Region {
    /// The point, in scene units.
    pub(crate) position: [f32; 3],
    /// The unit normal of its tangent plane; zero if offsets don't matter.
    pub(crate) normal: [f32; 3],
    /// In scene units; may be infinite.
    pub(crate) radius: f32,
    /// Half the thickness of the slab about the plane, in scene units.
    pub(crate) thickness: f32,
    /// The sine of the angle to the plane up to which photons count outside the slab: the more, the more a surface may bend.
    pub(crate) slope: f32,
}

impl Region {
    /// All photons within a distance.
    pub(crate) const fn ball(position: [f32; 3], radius: f32) -> Self {
        Self { position, normal: [0.0; 3], radius, thickness: 0.0, slope: 0.0 }
    }
}

/// Photons by surface, and on each surface as the leaves of a balanced k-d tree (Bentley 1975; Jensen 1996).
///
/// It depends on the photons and their order alone, not on the number of threads. Photons whose position or flux is not a number, infinite
/// or (the coordinates) beyond 10¹² are left out.
#[derive(Clone, Debug, Default)]
pub(crate) struct PhotonMap {
    photons: Vec<Photon>,
    origins: Vec<u32>,
    leaves: Vec<Leaf>,
    /// The node that parts two leaves has the index of the second.
    nodes: Vec<Node>,
    trees: Vec<Tree>,
}

/// Coordinates of consecutive photons, by axis; infinite beyond the last photon of a tree.
type Leaf = [[f32; LEAF]; 3];

/// Photons with `axis` coordinates at most `split` are on its left, at least `split` on its right.
#[derive(Clone, Copy, Debug, Default)]
struct Node {
    split: f32,
    axis: u32,
}

/// The photons of one surface.
#[derive(Clone, Debug)]
pub(super) struct Tree {
    surface: u32,
    photons: Range<usize>,
    pub(super) leaves: Range<usize>,
    low: [f32; 3],
    high: [f32; 3],
}

impl Tree {
    /// The indices of each leaf's photons.
    pub(super) fn leaves_photons(&self) -> impl Iterator<Item = Range<usize>> {
        let (first, end) = (self.photons.start, self.photons.end);
        (0..self.leaves.len()).map(move |leaf| first + leaf * LEAF..(first + (leaf + 1) * LEAF).min(end))
    }

    /// The index of a leaf's first photon.
    #[allow(clippy::cast_possible_truncation, reason = "photons are numbered by 32 bits")]
    pub(super) const fn first_of(&self, leaf: usize) -> u32 {
        (self.photons.start + (leaf - self.leaves.start) * LEAF) as u32
    }
}

/// A photon while the tree is built.
#[derive(Clone, Copy, Debug)]
struct Item {
    position: [f32; 3],
    /// Its index in the list given.
    origin: u32,
}

impl PhotonMap {
    /// The map of some photons, of which there must be fewer than 2³²; the rest is left out.
    pub(crate) fn new(photons: Vec<Photon>) -> Self {
        let mut items = items(&photons);
        let trees = trees(&photons, &items);
        let count = trees.last().map_or(0, |tree| tree.leaves.end);
        let mut map =
            Self { leaves: vec![[[0.0; LEAF]; 3]; count], nodes: vec![Node::default(); count], ..Self::default() };
        map.trees = build_all(trees, &mut items, &mut map.leaves, &mut map.nodes);
        map.origins = items.iter().map(|item| item.origin).collect();
        map.photons = map.origins.par_iter().with_min_len(PARALLEL).map(|origin| photons[*origin as usize]).collect();
        map
    }

    /// How many photons there are.
    pub(crate) fn len(&self) -> usize {
        self.photons.len()
    }

    /// Whether there are none.
    pub(crate) fn is_empty(&self) -> bool {
        self.photons.is_empty()
    }

    /// The photons in the map's order: by surface, and near ones by each other.
    pub(crate) fn photons(&self) -> &[Photon] {
        &self.photons
    }

    /// For each photon its index in the list that the map was made of.
    pub(crate) fn origins(&self) -> &[u32] {
        &self.origins
    }

    /// The memory taken, in bytes.
    pub(crate) fn bytes(&self) -> usize {
        size_of_val(self.photons.as_slice())
            + size_of_val(self.origins.as_slice())
            + size_of_val(self.leaves.as_slice())
            + size_of_val(self.nodes.as_slice())
            + size_of_val(self.trees.as_slice())
    }

    /// Fills `found` with the `count` nearest photons of a surface within a region, from the nearest to the farthest; of those at the same
    /// distance the first in the map's order come first and are taken first. Nothing is found about a point that is not a number.
    pub(crate) fn nearest(&self, surface: u32, region: &Region, count: usize, found: &mut Vec<Near>) {
        self.search(surface, region, count, found);
        Search::shorten(found, count);
        found.sort_unstable_by_key(Near::key);
    }

    /// All photons within the region, in an order that depends on the map and the region alone.
    pub(super) fn within(&self, surface: u32, region: &Region, found: &mut Vec<Near>) {
        self.search(surface, region, usize::MAX, found);
    }

    /// The number of the leaf that a photon is in.
    pub(super) fn leaf_of(&self, photon: u32) -> Option<usize> {
        let photon = photon as usize;
        let tree = self.trees.get(self.trees.partition_point(|tree| tree.photons.end <= photon))?;
        Some(tree.leaves.start + (photon - tree.photons.start) / LEAF)
    }

    fn search(&self, surface: u32, region: &Region, count: usize, found: &mut Vec<Near>) {
        found.clear();
        let Some(tree) = self.tree(surface) else { return };
        let limit = (region.radius * region.radius).clamp(0.0, f32::MAX);
        if count > 0 && limit >= 0.0 {
            Search { map: self, region, count, limit, found }.run(tree);
        }
    }

    /// The photons of a surface.
    pub(super) fn tree(&self, surface: u32) -> Option<&Tree> {
        self.trees.get(self.trees.binary_search_by_key(&surface, |tree| tree.surface).ok()?)
    }

    /// Those of all surfaces.
    pub(super) fn trees(&self) -> &[Tree] {
        &self.trees
    }

    /// The numbers of each leaf's photons, leaf by leaf.
    pub(super) fn leaves_photons(&self) -> impl Iterator<Item = Range<usize>> {
        self.trees.iter().flat_map(Tree::leaves_photons)
    }

    /// That of some photons, and its number, which is nearest to the middle of all.
    #[allow(clippy::cast_precision_loss, clippy::cast_possible_truncation, reason = "few photons, numbered by 32 bits")]
    pub(super) fn middle_of(&self, numbers: Range<usize>) -> Option<(u32, &Photon)> {
        let photons = self.photons.get(numbers.clone())?;
        let sum = photons.iter().fold([0.0; 3], |sum, photon| core::array::from_fn(|i| sum[i] + photon.position[i]));
        let middle = sum.map(|x: f32| x / photons.len() as f32);
        let distance2 = |photon: &Photon| square(core::array::from_fn(|i| photon.position[i] - middle[i]));
        let nearest = |a: &(u32, &Photon), b: &(u32, &Photon)| distance2(a.1).total_cmp(&distance2(b.1));
        (numbers.start as u32..).zip(photons).min_by(nearest)
    }

    /// The leaf among whose photons of a surface a position is; `None` if the surface has none.
    pub(super) fn leaf_at(&self, surface: u32, position: [f32; 3]) -> Option<usize> {
        let mut branch = self.tree(surface)?.leaves.clone();
        while branch.len() > 1 {
            let middle = usize::midpoint(branch.start, branch.end);
            let node = self.nodes[middle];
            if position[node.axis as usize] < node.split {
                branch.end = middle;
            } else {
                branch.start = middle;
            }
        }
        Some(branch.start)
    }

    /// About how far apart photons are that stand for light together, in scene units, for each in the map's order: half the diagonal of the box
    /// of a few leaves around it.
    pub(super) fn spacings(&self) -> Vec<f32> {
        let mut spacings = Vec::with_capacity(self.photons.len());
        for tree in &self.trees {
            let photons = self.photons.get(tree.photons.clone()).unwrap_or_default();
            for few in photons.chunks(FEW_LEAVES * LEAF) {
                let [low, high] = bounds(few.iter().map(|photon| photon.position));
                let spacing = 0.5 * square(core::array::from_fn(|i| high[i] - low[i])).sqrt();
                spacings.extend(few.iter().map(|_| spacing));
            }
        }
        spacings
    }

    /// A bit for each photon of a leaf within a region whose radius is that of this square, and the squares of all distances.
    pub(super) fn distances(&self, leaf: usize, region: &Region, limit: f32) -> ([f32; LEAF], u32) {
        let Region { position: p, normal: n, thickness, slope, .. } = *region;
        let [x, y, z] = &self.leaves[leaf];
        let mut distances = [0.0; LEAF];
        let mut mask = 0_u32;
        for i in 0..LEAF {
            let d = [x[i] - p[0], y[i] - p[1], z[i] - p[2]];
            let distance2 = square(d);
            let height = n[0] * d[0] + n[1] * d[1] + n[2] * d[2];
            let counts = (distance2 <= limit) & (height * height <= thickness * thickness + slope * slope * distance2);
            distances[i] = distance2;
            mask |= u32::from(counts) << i;
        }
        (distances, mask)
    }
}

/// A query under way.
struct Search<'a> {
    map: &'a PhotonMap,
    region: &'a Region,
    count: usize,
    /// Photons beyond this square of a distance don't count.
    limit: f32,
    found: &'a mut Vec<Near>,
}

/// Leaves of a tree with the vector from the query's point to the box that holds them, or to a larger one.
#[derive(Clone, Copy, Debug, Default)]
struct Branch {
    first: usize,
    end: usize,
    offset: [f32; 3],
}

impl Branch {
    /// All of a tree, from a point.
    fn of(tree: &Tree, p: [f32; 3]) -> Self {
        let offset = core::array::from_fn(|i| (tree.low[i] - p[i]).max(p[i] - tree.high[i]).max(0.0));
        Self { first: tree.leaves.start, end: tree.leaves.end, offset }
    }
}

impl Search<'_> {
    fn run(&mut self, tree: &Tree) {
        let p = self.region.position;
        let mut branch = Branch::of(tree, p);
        let mut waiting = [Branch::default(); DEPTH];
        let mut depth = 0;
        if !(square(branch.offset) <= self.limit) {
            return;
        }
        loop {
            while branch.end - branch.first > 1 {
                let middle = usize::midpoint(branch.first, branch.end);
                let node = self.map.nodes[middle];
                let axis = node.axis as usize;
                let beyond = p[axis] - node.split;
                let mut far = branch;
                far.offset[axis] = beyond;
                if beyond < 0.0 {
                    (branch.end, far.first) = (middle, middle);
                } else {
                    (branch.first, far.end) = (middle, middle);
                }
                if square(far.offset) <= self.limit {
                    waiting[depth] = far;
                    depth += 1;
                }
            }
            self.scan(tree, branch.first);
            loop {
                if depth == 0 {
                    return;
                }
                depth -= 1;
                branch = waiting[depth];
                if square(branch.offset) <= self.limit {
                    break;
                }
            }
        }
    }

    /// Adds the photons of a leaf that count.
    fn scan(&mut self, tree: &Tree, leaf: usize) {
        let (distances, mut mask) = self.map.distances(leaf, self.region, self.limit);
        let first = tree.first_of(leaf);
        while mask != 0 {
            let i = mask.trailing_zeros();
            self.found.push(Near { distance2: distances[i as usize], photon: first + i });
            mask &= mask - 1;
        }
        if self.found.len() >= self.count.saturating_mul(2) {
            self.limit = Self::shorten(self.found, self.count).unwrap_or(self.limit);
        }
    }

    /// Keeps the `count` nearest photons if there are more; the square of the distance to the last of them.
    fn shorten(found: &mut Vec<Near>, count: usize) -> Option<f32> {
        if found.len() <= count {
            return None;
        }
        let (_, last, _) = found.select_nth_unstable_by_key(count - 1, Near::key);
        let limit = last.distance2;
        found.truncate(count);
        Some(limit)
    }
}

/// Summed in this order everywhere: no rounding makes a box farther than what it holds.
pub(super) fn square(d: [f32; 3]) -> f32 {
    d[0] * d[0] + d[1] * d[1] + d[2] * d[2]
}

/// The photons that are kept, by surface, each surface's in the order given.
fn items(photons: &[Photon]) -> Vec<Item> {
    let is_kept = |photon: &Photon| photon.flux.is_finite() && photon.position.iter().all(|x| x.abs() <= LARGEST);
    let kept = photons.iter().zip(0..u32::MAX).filter(|(photon, _)| is_kept(photon));
    let mut items: Vec<_> = kept.map(|(photon, origin)| Item { position: photon.position, origin }).collect();
    if !photons.is_sorted_by_key(|photon| photon.surface) {
        items = by_surface(photons, items);
    }
    items
}

/// Items in the order of surfaces, each surface's in the order given: numbers of surfaces are small, so counting is faster than comparing.
fn by_surface(photons: &[Photon], mut items: Vec<Item>) -> Vec<Item> {
    let surface = |item: &Item| photons[item.origin as usize].surface as usize;
    let most = items.iter().map(surface).max().unwrap_or(0);
    if most > items.len() {
        items.sort_by_key(surface);
        return items;
    }
    let mut next = vec![0_usize; most + 2];
    items.iter().for_each(|item| next[surface(item) + 1] += 1);
    for number in 1..next.len() {
        next[number] += next[number - 1];
    }
    let mut sorted = items.clone();
    for item in items {
        let place = &mut next[surface(&item)];
        sorted[*place] = item;
        *place += 1;
    }
    sorted
}

/// The trees for photons that are in the order of surfaces.
fn trees(photons: &[Photon], items: &[Item]) -> Vec<Tree> {
    let surface = |item: &Item| photons[item.origin as usize].surface;
    let mut trees: Vec<Tree> = Vec::new();
    let mut end = 0;
    for chunk in items.chunk_by(|a, b| surface(a) == surface(b)) {
        let first = trees.last().map_or(0, |tree| tree.leaves.end);
        trees.push(Tree {
            surface: surface(&chunk[0]),
            photons: end..end + chunk.len(),
            leaves: first..first + chunk.len().div_ceil(LEAF),
            low: [0.0; 3],
            high: [0.0; 3],
        });
        end += chunk.len();
    }
    trees
}

/// Orders the items of all trees and fills their leaves and nodes.
fn build_all(trees: Vec<Tree>, items: &mut [Item], leaves: &mut [Leaf], nodes: &mut [Node]) -> Vec<Tree> {
    let (mut items, mut leaves, mut nodes) = (items, leaves, nodes);
    let mut parts = Vec::with_capacity(trees.len());
    for tree in trees {
        let part = Part {
            items: items.split_off_mut(..tree.photons.len()).unwrap_or_default(),
            leaves: leaves.split_off_mut(..tree.leaves.len()).unwrap_or_default(),
            nodes: nodes.split_off_mut(..tree.leaves.len()).unwrap_or_default(),
        };
        parts.push((tree, part));
    }
    let build = |(mut tree, part): (Tree, Part)| {
        [tree.low, tree.high] = bounds_of(part.items);
        part.build();
        tree
    };
    parts.into_par_iter().map(build).collect()
}

/// Some leaves of a tree being built, with the items that go there.
struct Part<'a> {
    items: &'a mut [Item],
    leaves: &'a mut [Leaf],
    nodes: &'a mut [Node],
}

impl Part<'_> {
    fn build(self) {
        let Self { items, leaves, nodes } = self;
        if let [leaf] = leaves {
            items.sort_unstable_by_key(|item| item.origin);
            let coordinate = |i: usize, axis: usize| items.get(i).map_or(f32::INFINITY, |item| item.position[axis]);
            *leaf = core::array::from_fn(|axis| core::array::from_fn(|i| coordinate(i, axis)));
            return;
        }
        let axis = widest(bounds_of(items));
        let middle = leaves.len() / 2;
        let (_, pivot, _) = items.select_nth_unstable_by_key(middle * LEAF, |item| order(item, axis));
        #[allow(clippy::cast_possible_truncation, reason = "0, 1 or 2")]
        let node = Node { split: pivot.position[axis], axis: axis as u32 };
        nodes[middle] = node;
        let is_large = items.len() > PARALLEL;
        let (items, right_items) = items.split_at_mut(middle * LEAF);
        let (leaves, right_leaves) = leaves.split_at_mut(middle);
        let (nodes, right_nodes) = nodes.split_at_mut(middle);
        let left = Part { items, leaves, nodes };
        let right = Part { items: right_items, leaves: right_leaves, nodes: right_nodes };
        if is_large {
            rayon::join(|| left.build(), || right.build());
        } else {
            left.build();
            right.build();
        }
    }
}

/// Orders by a coordinate, then as the photons were given.
fn order(item: &Item, axis: usize) -> u64 {
    let bits = item.position[axis].to_bits();
    // Negative numbers have their bits turned, so that all are in order.
    let ordered = if bits >> 31 == 1 { !bits } else { bits | 1 << 31 };
    u64::from(ordered) << 32 | u64::from(item.origin)
}

fn bounds_of(items: &[Item]) -> [[f32; 3]; 2] {
    bounds(items.iter().map(|item| item.position))
}

/// The least and the largest coordinates.
fn bounds(positions: impl Iterator<Item = [f32; 3]>) -> [[f32; 3]; 2] {
    let mut low = [f32::INFINITY; 3];
    let mut high = [f32::NEG_INFINITY; 3];
    for position in positions {
        for axis in 0..3 {
            low[axis] = low[axis].min(position[axis]);
            high[axis] = high[axis].max(position[axis]);
        }
    }
    [low, high]
}

fn widest([low, high]: [[f32; 3]; 2]) -> usize {
    let extent = |axis: usize| high[axis] - low[axis];
    let other = if extent(1) > extent(0) { 1 } else { 0 };
    if extent(2) > extent(other) { 2 } else { other }
}

#[cfg(test)]
mod tests;
