//! The transport operator: light from patches to patches over links between the levels of their trees.

use rayon::prelude::*;

use super::cluster::Cluster;
use super::mesh::{Cut, LEAF, Patches};

/// Patches whose light is gathered by one task.
const CHUNK: usize = 256;

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
    pub(super) fn new(patches: &Patches, links: &[Link]) -> Self {
        let count = patches.nodes.len();
        let rows = count + patches.clusters.len();
        let mut starts = vec![0; rows + 1];
        for link in links {
            starts[patches.row(link.p) + 1] += 1;
            starts[patches.row(link.q) + 1] += 1;
        }
        for i in 0..rows {
            starts[i + 1] += starts[i];
        }
        let mut next = starts.clone();
        let (mut sources, mut factors) = (vec![0; 2 * links.len()], vec![0.0; 2 * links.len()]);
        for link in links {
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

    /// The same between groups of leaves, each as if it had one radiosity: `group` of each leaf, below `count`.
    pub(super) fn condensed(&self, group: &[usize], count: usize, buffer: &mut Buffer) -> Self {
        const WIDTH: usize = 16;
        let mut areas = vec![0.0; count];
        group.iter().zip(&self.areas).for_each(|(g, a)| areas[*g] += a);
        // Row by row: the mean over the group of K times the indicator of another group.
        let mut factors = vec![0.0; count * count];
        for first in (0..count).step_by(WIDTH) {
            let width = WIDTH.min(count - first);
            let mut indicator = vec![0.0; group.len() * width];
            for (row, g) in indicator.chunks_mut(width).zip(group) {
                if (first..first + width).contains(g) {
                    row[g - first] = 1.0;
                }
            }
            let mut irradiance = vec![0.0; indicator.len()];
            self.apply(&indicator, &mut irradiance, width, buffer);
            for ((row, g), area) in irradiance.chunks(width).zip(group).zip(&self.areas) {
                let to = &mut factors[g * count + first..][..width];
                to.iter_mut().zip(row).for_each(|(t, h)| *t += h * area / areas[*g]);
            }
        }
        let numbers: Vec<u32> = (0..).take(count).collect();
        Self {
            leaves: numbers.clone(),
            areas,
            children: vec![LEAF; count],
            leaf: numbers.clone(),
            share: vec![1.0; count],
            clusters: Vec::new(),
            starts: (0..=count).map(|node| node * count).collect(),
            sources: (0..count).flat_map(|_| numbers.iter().copied()).collect(),
            factors,
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

    /// The mean over each node and cluster of `width` values for each leaf, times `scale` of the leaf.
    pub(super) fn pull(&self, leaves: &[f64], width: usize, scale: impl Fn(usize) -> f64, nodes: &mut Vec<f64>) {
        nodes.clear();
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
        self.pull(radiosity, width, |leaf| self.scale[leaf], &mut buffer.radiosity);
        buffer.irradiance.clear();
        buffer.irradiance.resize(self.rows() * width, 0.0);
        let from = &buffer.radiosity;
        if self.rows() <= CHUNK {
            // Too little for more than one thread.
            for (node, row) in buffer.irradiance.chunks_mut(width).enumerate() {
                self.gather(node, from, row);
            }
            return self.push(&mut buffer.irradiance, irradiance, width);
        }
        buffer.irradiance.par_chunks_mut(CHUNK * width).enumerate().for_each(|(chunk, rows)| {
            for (offset, row) in rows.chunks_mut(width).enumerate() {
                self.gather(chunk * CHUNK + offset, from, row);
            }
        });
        self.push(&mut buffer.irradiance, irradiance, width);
    }

    fn gather(&self, node: usize, from: &[f64], to: &mut [f64]) {
        let width = to.len();
        let range = self.starts[node]..self.starts[node + 1];
        for (source, factor) in self.sources[range.clone()].iter().zip(&self.factors[range]) {
            let row = &from[*source as usize * width..][..width];
            to.iter_mut().zip(row).for_each(|(t, b)| *t += factor * b);
        }
    }

    /// Adds the values of clusters and nodes to those of their halves, down to the leaves.
    fn push(&self, nodes: &mut [f64], leaves: &mut [f64], width: usize) {
        for (index, (children, _)) in self.clusters.iter().enumerate() {
            let row = (self.children.len() + index) * width;
            for child in children {
                for k in 0..width {
                    nodes[child * width + k] += nodes[row + k];
                }
            }
        }
        for node in 0..self.children.len() {
            let child = self.children[node];
            if child == LEAF {
                let leaf = self.leaf[node] as usize;
                let (to, from) = (&mut leaves[leaf * width..][..width], &nodes[node * width..][..width]);
                to.iter_mut().zip(from).for_each(|(t, f)| *t = f * self.scale[leaf]);
            } else {
                let (parents, rest) = nodes.split_at_mut(child as usize * width);
                let from = &parents[node * width..][..width];
                for half in rest[..2 * width].chunks_mut(width) {
                    half.iter_mut().zip(from).for_each(|(t, f)| *t += f);
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
