//! Photons that pass a place as the wavelength changes.

use super::map::{LEAF, PhotonMap, Region, Tree, WAITING, square};
use super::motion::Motion;

/// The ways of a map's photons, each a straight line, in boxes: a hierarchy over the leaves of the map's trees.
#[derive(Clone, Debug, Default)]
pub(super) struct Ways {
    leaves: Vec<Leaf>,
    /// For the node that parts two leaves the boxes of both its parts, by the index of the second leaf.
    nodes: Vec<[Box3; 2]>,
}

/// The middles of consecutive photons' ways, by axis, their halves from there on, and the inverse square of these, at most [`LARGEST`];
/// infinite middles beyond the last photon of a tree.
#[derive(Clone, Copy, Debug)]
struct Leaf {
    middle: [[f32; LEAF]; 3],
    half: [[f32; LEAF]; 3],
    inverse: [f32; LEAF],
}

/// Keeps products with it finite: so short a half is no way at all.
const LARGEST: f32 = 1e30;

/// The least and the largest coordinates.
#[derive(Clone, Copy, Debug)]
struct Box3 {
    low: [f32; 3],
    high: [f32; 3],
}

impl Box3 {
    const EMPTY: Self = Self { low: [f32::INFINITY; 3], high: [f32::NEG_INFINITY; 3] };

    fn with(self, other: Self) -> Self {
        Self {
            low: core::array::from_fn(|i| self.low[i].min(other.low[i])),
            high: core::array::from_fn(|i| self.high[i].max(other.high[i])),
        }
    }

    /// The square of the distance from a point.
    fn distance2(&self, p: [f32; 3]) -> f32 {
        square(core::array::from_fn(|i| (self.low[i] - p[i]).max(p[i] - self.high[i]).max(0.0)))
    }
}

impl Ways {
    /// Those of the photons of a map, in its order.
    pub(super) fn new(map: &PhotonMap, motions: &[Motion]) -> Self {
        let (mut ways, mut boxes) = (Self::default(), Vec::new());
        for tree in map.trees() {
            for photons in tree.leaves_photons() {
                let mut leaf =
                    Leaf { middle: [[f32::INFINITY; LEAF]; 3], half: [[0.0; LEAF]; 3], inverse: [0.0; LEAF] };
                let mut around = Box3::EMPTY;
                let known = map.photons()[photons.clone()].iter().zip(motions.get(photons).unwrap_or_default());
                for (i, (photon, motion)) in known.enumerate() {
                    let (middle, half) = motion.middle(photon);
                    for axis in 0..3 {
                        (leaf.middle[axis][i], leaf.half[axis][i]) = (middle[axis], half[axis]);
                    }
                    leaf.inverse[i] = (1.0 / square(half)).min(LARGEST);
                    // The ends as the search has them, and a little rounding.
                    let slack = 4.0 * f32::EPSILON * middle.iter().fold(0.0, |most: f32, x| most.max(x.abs()));
                    around = around.with(Box3 {
                        low: core::array::from_fn(|i| middle[i] - half[i].abs() - slack),
                        high: core::array::from_fn(|i| middle[i] + half[i].abs() + slack),
                    });
                }
                ways.leaves.push(leaf);
                boxes.push(around);
            }
        }
        ways.nodes.resize(ways.leaves.len(), [Box3::EMPTY; 2]);
        for tree in map.trees() {
            ways.fill(&boxes, tree.leaves.start, tree.leaves.end);
        }
        ways
    }

    fn fill(&mut self, boxes: &[Box3], first: usize, end: usize) -> Box3 {
        if end - first <= 1 {
            return boxes.get(first).copied().unwrap_or(Box3::EMPTY);
        }
        let middle = usize::midpoint(first, end);
        let parts = [self.fill(boxes, first, middle), self.fill(boxes, middle, end)];
        self.nodes[middle] = parts;
        parts[0].with(parts[1])
    }

    /// Calls with the numbers of photons whose ways come into a region of a surface, in an order that depends on the map and the region alone.
    pub(super) fn passing(&self, map: &PhotonMap, surface: u32, region: &Region, mut call: impl FnMut(u32)) {
        let Some(tree) = map.tree(surface) else { return };
        let limit = (region.radius * region.radius).clamp(0.0, f32::MAX);
        let mut branch = tree.leaves.start..tree.leaves.end;
        let mut waiting = [(0, 0); WAITING];
        let mut depth = 0;
        loop {
            while branch.len() > 1 {
                let middle = usize::midpoint(branch.start, branch.end);
                match self.nodes[middle].map(|part| part.distance2(region.position) <= limit) {
                    [true, true] => {
                        waiting[depth] = (middle, branch.end);
                        depth += 1;
                        branch.end = middle;
                    }
                    [true, false] => branch.end = middle,
                    [false, true] => branch.start = middle,
                    [false, false] => branch.end = branch.start,
                }
            }
            if !branch.is_empty() {
                self.scan(tree, branch.start, (region, limit), &mut call);
            }
            if depth == 0 {
                return;
            }
            depth -= 1;
            branch = waiting[depth].0..waiting[depth].1;
        }
    }

    /// Calls with the photons of a leaf whose ways come into a region.
    fn scan(&self, tree: &Tree, number: usize, (region, limit): (&Region, f32), call: &mut impl FnMut(u32)) {
        let Region { position: p, normal: n, thickness, slope, .. } = *region;
        let Leaf { middle: [x, y, z], half: [u, v, w], inverse } = &self.leaves[number];
        let mut mask = 0_u32;
        for i in 0..LEAF {
            let d = [x[i] - p[0], y[i] - p[1], z[i] - p[2]];
            let half = [u[i], v[i], w[i]];
            let along = d[0] * half[0] + d[1] * half[1] + d[2] * half[2];
            // To the nearest point of the way.
            let t = (-along * inverse[i]).clamp(-1.0, 1.0);
            let d = [d[0] + t * half[0], d[1] + t * half[1], d[2] + t * half[2]];
            let distance2 = square(d);
            let height = n[0] * d[0] + n[1] * d[1] + n[2] * d[2];
            let counts = (distance2 <= limit) & (height * height <= thickness * thickness + slope * slope * distance2);
            mask |= u32::from(counts) << i;
        }
        let first = tree.first_of(number);
        while mask != 0 {
            call(first + mask.trailing_zeros());
            mask &= mask - 1;
        }
    }

    pub(super) const fn bytes(&self) -> usize {
        size_of::<Leaf>() * self.leaves.capacity() + size_of::<[Box3; 2]>() * self.nodes.capacity()
    }
}

#[cfg(test)]
mod tests {
    use super::Ways;
    use crate::photon::map::Region;
    use crate::photon::motion::Motion;
    use crate::photon::random::Random;
    use crate::photon::{Photon, PhotonMap};

    /// Found are all photons whose ways come near a place, and no others, by trying points of each.
    #[test]
    fn all_that_pass_are_found() {
        let mut random = Random::new(5);
        let mut next = |size: f32| [0; 2].map(|_| size * (random.next() * 2.0 - 1.0));
        let mut photons = Vec::new();
        let mut motions = Vec::new();
        for number in 0..3000_u32 {
            let ([x, y], size) = (next(1.0), [0.0, 1e-20, 0.01, 0.3][number as usize % 4]);
            let [u, v] = next(size);
            photons.push(Photon { position: [x, y, 0.0], flux: 1.0, surface: number % 3, ..Photon::default() });
            motions.push(Motion::new([u, v, 0.0], 0.0, 0.25, [0.1, 0.7]));
        }
        let map = PhotonMap::new(photons.clone());
        let in_order: Vec<Motion> = map.origins().iter().map(|origin| motions[*origin as usize]).collect();
        let ways = Ways::new(&map, &in_order);
        for place in 0..60_u32 {
            let [x, y] = next(1.2);
            let radius = [0.0, 0.01, 0.1, 3.0][place as usize % 4];
            let region = Region { normal: [0.0, 0.0, 1.0], ..Region::ball([x, y, 0.0], radius) };
            let mut found = Vec::new();
            ways.passing(&map, place % 3, &region, |number| found.push(map.origins()[number as usize]));
            found.sort_unstable();
            assert!(found.windows(2).all(|pair| pair[0] < pair[1]));
            assert!(found.iter().all(|number| photons[*number as usize].surface == place % 3));
            let distance = |number: &u32| {
                let (photon, motion) = (&photons[*number as usize], &motions[*number as usize]);
                let at = |step: u16| {
                    let t = 0.1 + 0.6 * f32::from(step) / 2000.0;
                    let p: [f32; 2] = core::array::from_fn(|i| photon.position[i] + motion.way()[i] * (t - 0.25));
                    (p[0] - x).hypot(p[1] - y)
                };
                (0..=2000).map(at).fold(f32::INFINITY, f32::min)
            };
            let own = (0..3000).filter(|number| photons[*number as usize].surface == place % 3);
            for number in own {
                let (is_found, distance) = (found.contains(&number), distance(&number));
                assert!(is_found == (distance <= radius) || (distance - radius).abs() <= 1e-3, "{number} {distance}");
            }
        }
    }
}
