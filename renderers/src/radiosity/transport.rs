//! The transport operator: light from patches to patches over links between the levels of their trees.

use std::sync::{Mutex, PoisonError};

use rayon::prelude::*;

use super::cluster::Cluster;
use super::coarse::Coarse;
use super::mesh::{Cut, LEAF, Patches};

/// Patches whose light is gathered by one task.
const CHUNK: usize = 256;
/// The most components that are carried through the operator at once.
const WIDEST: usize = 16;

/// Light exchanged between two groups of patches.
#[derive(Clone, Copy, Debug)]
pub(super) struct Link {
    pub(super) p: u32,
    pub(super) q: u32,
    /// ∫∫ cos cos / (π r²), as if nothing blocked.
    pub(super) exchange: f64,
    /// Visible share.
    pub(super) seen: f64,
    /// Whether nothing blocks, for certain.
    pub(super) clear: bool,
    /// How unevenly the light arrives on both.
    pub(super) spread: [Spread; 2],
}

/// How unevenly light arrives on a patch.
#[derive(Clone, Copy, Debug)]
pub(super) struct Spread {
    /// Mean distance of the irradiance from its mean times area, for light of radiosity 1.
    pub(super) flux: f32,
    /// The cut that leaves least of this.
    pub(super) cut: Cut,
}

/// The operator K: radiosity of the leaves to irradiance on the leaves.
#[derive(Clone, Debug)]
pub(super) struct Transport {
    /// Nodes of the leaves, in order.
    pub(super) leaves: Vec<u32>,
    pub(super) areas: Vec<f64>,
    /// Node by node: its first half, and the number of its leaf, where it is one.
    children: Vec<u32>,
    leaf: Vec<u32>,
    /// Each child's share of its parent's area.
    share: Vec<f64>,
    /// Clusters, which come after the patches: the children's rows, and their shares of the area.
    clusters: Vec<([usize; 2], [f64; 2])>,
    starts: Vec<usize>,
    sources: Vec<u32>,
    factors: Vec<f64>,
    /// What K is multiplied by from both sides, leaf by leaf, so that no light is lost in closed spaces.
    pub(super) scale: Vec<f64>,
}

impl Transport {
    /// Of links that carry light.
    pub(super) fn new(patches: &Patches, links: &[Link]) -> Self {
        let carrying = || links.iter().filter(|link| link.seen > 0.0);
        let count = patches.nodes.len();
        let rows = count + patches.clusters.len();
        let mut starts = vec![0; rows + 1];
        for link in carrying() {
            starts[patches.row(link.p) + 1] += 1;
            starts[patches.row(link.q) + 1] += 1;
        }
        for i in 0..rows {
            starts[i + 1] += starts[i];
        }
        let mut next = starts.clone();
        let entries = starts[rows];
        let (mut sources, mut factors) = (vec![0; entries], vec![0.0; entries]);
        for link in carrying() {
            for (to, from) in [(link.p, link.q), (link.q, link.p)] {
                let row = patches.row(to);
                let place = next[row];
                next[row] += 1;
                sources[place] = u32::try_from(patches.row(from)).unwrap_or(LEAF);
                factors[place] = link.exchange * link.seen / patches.area(to);
            }
        }
        let cluster = |c: &Cluster| {
            let [a, b] = c.children.map(|child| patches.area(child));
            (c.children.map(|child| patches.row(child)), [a / (a + b), b / (a + b)])
        };
        let mut result = Self {
            leaves: Vec::new(),
            areas: Vec::new(),
            children: patches.nodes.iter().map(|n| n.child).collect(),
            leaf: vec![LEAF; count],
            share: vec![1.0; count],
            clusters: patches.clusters.iter().map(cluster).collect(),
            starts,
            sources,
            factors,
            scale: Vec::new(),
        };
        for (index, node) in patches.nodes.iter().enumerate() {
            if let Some(children) = node.children() {
                let areas = children.map(|c| patches.nodes[c].polygon.area);
                for (child, area) in children.into_iter().zip(areas) {
                    result.share[child] = area / (areas[0] + areas[1]);
                }
            } else {
                result.leaf[index] = u32::try_from(result.leaves.len()).unwrap_or(LEAF);
                result.leaves.push(u32::try_from(index).unwrap_or(LEAF));
                result.areas.push(node.polygon.area);
            }
        }
        result.scale = vec![1.0; result.leaves.len()];
        result
    }

    /// Row by row: the mean over a group of leaves of K times the indicator of another, where all leaves of any node are of one group.
    /// `None` where there are clusters, which have leaves of several groups.
    pub(super) fn exchanged(&self, group: &[usize], areas: &[f64]) -> Option<Vec<f64>> {
        if !self.clusters.is_empty() {
            return None;
        }
        let (count, nodes) = (areas.len(), self.children.len());
        // The group and the area of each node, and the mean over it of what K is multiplied by.
        let (mut groups, mut sizes) = (vec![0; nodes], vec![0.0; nodes]);
        let mut scale = Vec::new();
        self.pull(&self.scale, 1, |_| 1.0, &mut scale);
        for node in (0..nodes).rev() {
            let child = self.children[node];
            if child == LEAF {
                let leaf = self.leaf[node] as usize;
                (groups[node], sizes[node]) = (group[leaf], self.areas[leaf]);
            } else {
                let child = child as usize;
                (groups[node], sizes[node]) = (groups[child], sizes[child] + sizes[child + 1]);
            }
        }
        let mut between = vec![0.0; count * count];
        for node in 0..nodes {
            let range = self.starts[node]..self.starts[node + 1];
            let received = scale[node] * sizes[node] / areas[groups[node]];
            for (source, factor) in self.sources[range.clone()].iter().zip(&self.factors[range]) {
                let source = *source as usize;
                between[groups[node] * count + groups[source]] += received * factor * scale[source];
            }
        }
        Some(between)
    }

    /// The same between groups of leaves, each as if it had one radiosity.
    pub(super) fn between(coarse: &Coarse) -> Self {
        let count = coarse.count();
        let numbers: Vec<u32> = (0..).take(count).collect();
        Self {
            leaves: numbers.clone(),
            areas: coarse.areas.clone(),
            children: vec![LEAF; count],
            leaf: numbers.clone(),
            share: vec![1.0; count],
            clusters: Vec::new(),
            starts: (0..=count).map(|node| node * count).collect(),
            sources: (0..count).flat_map(|_| numbers.iter().copied()).collect(),
            factors: coarse.between.clone(),
            scale: vec![1.0; count],
        }
    }

    /// How many nodes and clusters there are.
    pub(super) const fn rows(&self) -> usize {
        self.children.len() + self.clusters.len()
    }

    /// Bytes that it takes.
    pub(super) fn bytes(&self) -> usize {
        12 * self.factors.len() + 32 * self.rows() + 20 * self.leaves.len()
    }

    /// At least what rounding may change of any irradiance, as a share of what it would be if all radiosity were positive: twice (1 + u)ⁿ − 1
    /// for sums of n terms, on the way up, of links and on the way down.
    pub(super) fn rounding(&self) -> f64 {
        let most = self.starts.windows(2).map(|row| row[1] - row[0]).max().unwrap_or(0);
        let mut depth = vec![0_usize; self.rows()];
        for (index, (children, _)) in self.clusters.iter().enumerate() {
            children.iter().for_each(|child| depth[*child] = depth[self.children.len() + index] + 1);
        }
        for (node, child) in self.children.iter().enumerate().filter(|(_, child)| **child != LEAF) {
            let below = depth[node] + 1;
            depth[*child as usize..][..2].fill(below);
        }
        let terms = most + 4 * depth.iter().max().unwrap_or(&0) + 8;
        f64::EPSILON * f64::from(u32::try_from(terms).unwrap_or(u32::MAX))
    }

    /// The mean over each node and cluster of `width` values for each leaf, times `scale` of the leaf.
    #[inline(always)]
    pub(super) fn pull(&self, leaves: &[f64], width: usize, scale: impl Fn(usize) -> f64, nodes: &mut Vec<f64>) {
        // All of it is written.
        nodes.resize(self.rows() * width, 0.0);
        for node in (0..self.children.len()).rev() {
            let child = self.children[node];
            if child == LEAF {
                let leaf = self.leaf[node] as usize;
                let scale = scale(leaf);
                let (to, from) = (&mut nodes[node * width..][..width], &leaves[leaf * width..][..width]);
                to.iter_mut().zip(from).for_each(|(t, f)| *t = f * scale);
            } else {
                // Children come after their parents.
                let child = child as usize;
                let (parents, rest) = nodes.split_at_mut(child * width);
                let shares = [self.share[child], self.share[child + 1]];
                let (one, other) = rest[..2 * width].split_at(width);
                let to = &mut parents[node * width..][..width];
                for ((t, a), b) in to.iter_mut().zip(one).zip(other) {
                    *t = shares[0] * a + shares[1] * b;
                }
            }
        }
        for (index, (children, shares)) in self.clusters.iter().enumerate().rev() {
            let row = (self.children.len() + index) * width;
            for k in 0..width {
                let [a, b] = children.map(|child| nodes[child * width + k]);
                nodes[row + k] = shares[0] * a + shares[1] * b;
            }
        }
    }

    /// Irradiance on the leaves from their radiosity, `width` components each.
    pub(super) fn apply(&self, radiosity: &[f64], irradiance: &mut [f64], width: usize, buffer: &mut Buffer) {
        macro_rules! by_width {
            ($($w:literal)*) => {
                match width {
                    $($w => self.apply_rows::<$w>(radiosity.as_chunks().0, irradiance.as_chunks_mut().0, buffer),)*
                    _ => self.apply_many(radiosity, irradiance, width, buffer),
                }
            };
        }
        by_width!(1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16);
    }

    /// The same for more components than sums fit in registers for: some after the others.
    fn apply_many(&self, radiosity: &[f64], irradiance: &mut [f64], width: usize, buffer: &mut Buffer) {
        let (mut from, mut to) = (Vec::new(), Vec::new());
        for first in (0..width).step_by(WIDEST) {
            let some = first..width.min(first + WIDEST);
            from.clear();
            radiosity.chunks(width).for_each(|row| from.extend_from_slice(&row[some.clone()]));
            to.clear();
            to.resize(from.len(), 0.0);
            self.apply(&from, &mut to, some.len(), buffer);
            for (row, values) in irradiance.chunks_mut(width).zip(to.chunks(some.len())) {
                row[some.clone()].copy_from_slice(values);
            }
        }
    }

    /// The same for a number of components that is known in advance.
    pub(super) fn apply_rows<const W: usize>(
        &self,
        radiosity: &[[f64; W]],
        irradiance: &mut [[f64; W]],
        buffer: &mut Buffer,
    ) {
        self.pull(radiosity.as_flattened(), W, |leaf| self.scale[leaf], &mut buffer.radiosity);
        buffer.irradiance.resize(self.rows() * W, 0.0);
        let (from, to) = (buffer.radiosity.as_chunks().0, buffer.irradiance.as_chunks_mut().0);
        if self.rows() <= CHUNK {
            // Too little for more than one thread.
            to.iter_mut().enumerate().for_each(|(node, row)| *row = self.gather(node, from));
        } else {
            to.par_chunks_mut(CHUNK).enumerate().for_each(|(chunk, rows)| {
                for (offset, row) in rows.iter_mut().enumerate() {
                    *row = self.gather(chunk * CHUNK + offset, from);
                }
            });
        }
        self.push(to, irradiance);
    }

    fn gather<const W: usize>(&self, node: usize, from: &[[f64; W]]) -> [f64; W] {
        let mut sums = [0.0; W];
        let range = self.starts[node]..self.starts[node + 1];
        for (source, factor) in self.sources[range.clone()].iter().zip(&self.factors[range]) {
            let row = &from[*source as usize];
            sums.iter_mut().zip(row).for_each(|(t, b)| *t += factor * b);
        }
        sums
    }

    /// Adds the values of clusters and nodes to those of their halves, down to the leaves.
    fn push<const W: usize>(&self, nodes: &mut [[f64; W]], leaves: &mut [[f64; W]]) {
        for (index, (children, _)) in self.clusters.iter().enumerate() {
            let from = nodes[self.children.len() + index];
            for child in children {
                nodes[*child].iter_mut().zip(&from).for_each(|(t, f)| *t += f);
            }
        }
        for node in 0..self.children.len() {
            let child = self.children[node];
            let from = nodes[node];
            if child == LEAF {
                let leaf = self.leaf[node] as usize;
                leaves[leaf] = from.map(|f| f * self.scale[leaf]);
            } else {
                for half in &mut nodes[child as usize..][..2] {
                    half.iter_mut().zip(&from).for_each(|(t, f)| *t += f);
                }
            }
        }
    }

    /// Σ F over each leaf's links: 1 where all it sees are patches.
    pub(super) fn row_sums(&self, buffer: &mut Buffer) -> Vec<f64> {
        let ones = vec![1.0; self.leaves.len()];
        let mut sums = vec![0.0; self.leaves.len()];
        self.apply(&ones, &mut sums, 1, buffer);
        sums
    }
}

/// Room for the values of all nodes.
#[derive(Clone, Debug, Default)]
pub(super) struct Buffer {
    radiosity: Vec<f64>,
    irradiance: Vec<f64>,
}

/// Buffers for tasks that follow each other: room that is new has to be cleared by the system first, which takes as long as a pass.
#[derive(Debug, Default)]
pub(super) struct Buffers(Mutex<Vec<Buffer>>);

impl Buffers {
    /// Does something with a buffer that nobody else has meanwhile.
    pub(super) fn lend<T>(&self, what: impl FnOnce(&mut Buffer) -> T) -> T {
        let all = || self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let mut buffer = all().pop().unwrap_or_default();
        let result = what(&mut buffer);
        all().push(buffer);
        result
    }
}
