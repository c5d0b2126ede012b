//! Radiosity at points of each patch, for looking at places: what the operator says of groups of patches, said again of each point.
//!
//! The operator gives all patches of a group the same light over a link. Where something blocks or surfaces touch, the means of patches are
//! off by that, and patches of one radiosity are too coarse for what is near them. So each patch gets three or four points, each with its own
//! list of what it receives from where: configuration factors in closed form, shadows cut out, from groups of patches far away and from parts
//! of near ones, on which radiosity is linear between their points. The fixed point of these lists is found from the operator's solution by
//! Jacobi's iteration.

use glam::{DMat2, DVec2, DVec3};
use rayon::prelude::*;

use super::Solution;
use super::gather::{Entry, Place};
use super::mesh::LEAF;
use super::polygon::Polygon;
use super::view::Points;

/// Groups that count as one at a point change its light by less than this share of the accuracy each.
const SHARE: f64 = 0.1;
/// The standard error that counting far faces by rays may leave at a point, as a share of the accuracy: it is another one at each.
const TOLERANCE: f64 = 0.4;
/// Iteration ends when radiosity changes by less than this share of the accuracy, relative to the mean.
const ENOUGH: f64 = 0.03;
const MOST_STEPS: usize = 50;
/// Points whose lists tell how long lists are.
const SAMPLES: usize = 32;

/// Points on a patch, and how to interpolate between them.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stencil {
    /// The index of the first of its points.
    pub(super) first: u32,
    points: Points,
    /// The mean of the points.
    middle: DVec3,
    axes: [DVec3; 2],
    /// Inverse of the second moments.
    inverse: DMat2,
}

impl Stencil {
    fn new(polygon: &Polygon, first: u32) -> Self {
        let points = Points::on(polygon);
        let middle: DVec3 = points.iter().map(|(x, w)| *x * *w).sum();
        let (u, v) = polygon.normal.any_orthonormal_pair();
        let flat = |x: DVec3| DVec2::new((x - middle).dot(u), (x - middle).dot(v));
        let moments = points.iter().fold(DMat2::ZERO, |sum, (x, w)| {
            let at = flat(*x);
            sum + DMat2::from_cols(at * at.x, at * at.y) * *w
        });
        let inverse = if moments.determinant() > 0.0 { moments.inverse() } else { DMat2::ZERO };
        Self { first, points, middle, axes: [u, v], inverse }
    }

    /// The points' indices, each with what it counts at a place: the plane that is nearest to the values at the points.
    pub(super) fn at(&self, place: DVec3) -> impl Iterator<Item = (u32, f64)> + '_ {
        let flat = |x: DVec3| DVec2::new((x - self.middle).dot(self.axes[0]), (x - self.middle).dot(self.axes[1]));
        let slope = self.inverse * flat(place);
        (self.first..).zip(self.points.iter()).map(move |(index, (x, w))| (index, w * (1.0 + flat(*x).dot(slope))))
    }
}

/// Values at points of all patches.
#[derive(Clone, Debug, Default)]
pub(super) struct Polished {
    /// For each leaf node; none for others.
    stencils: Vec<Stencil>,
    /// For each node the index of its stencil, or [`LEAF`].
    of_node: Vec<u32>,
    /// Reflected radiosity at the points, row by row.
    values: Vec<f64>,
}

impl Polished {
    pub(super) const fn is_empty(&self) -> bool {
        self.stencils.is_empty()
    }

    /// The stencil of a leaf node.
    pub(super) fn stencil(&self, node: usize) -> Option<&Stencil> {
        self.stencils.get(*self.of_node.get(node)? as usize)
    }

    /// The row of a point.
    pub(super) fn row(&self, point: u32, width: usize) -> &[f64] {
        &self.values[point as usize * width..][..width]
    }
}

impl Solution<'_> {
    /// Computes radiosity at points of all patches.
    pub(super) fn polish(&mut self) {
        let patches = &self.radiosity.patches;
        let leaves = &self.radiosity.transport.leaves;
        let mut polished = Polished { of_node: vec![LEAF; patches.nodes.len()], ..Polished::default() };
        let mut places: Vec<(u32, DVec3)> = Vec::new();
        for (index, leaf) in (0..).zip(leaves) {
            let first = u32::try_from(places.len()).unwrap_or(LEAF);
            let stencil = Stencil::new(&patches.nodes[*leaf as usize].polygon, first);
            places.extend(stencil.points.iter().map(|(x, _)| (index, *x)));
            polished.of_node[*leaf as usize] = index;
            polished.stencils.push(stencil);
        }
        for (leaf, _) in &places {
            polished.values.extend(self.row(leaves[*leaf as usize]));
        }
        self.polished = polished;
        let known = &*self;
        if known.list_bytes(&places) > self.radiosity.settings.memory {
            self.polished = Polished::default();
            return;
        }
        let lists: Vec<(Vec<Entry>, Vec<f64>)> =
            places.par_iter().map(|(leaf, x)| known.list(leaves[*leaf as usize], *leaf, *x)).collect();
        self.report.points = places.len();
        self.solved = leaves.iter().flat_map(|leaf| self.row(*leaf)).copied().collect();
        for _ in 0..MOST_STEPS {
            if self.sweep(&lists, &places) <= ENOUGH * self.radiosity.settings.accuracy {
                break;
            }
        }
    }

    /// About how many bytes the lists of all points would take, from some of them.
    fn list_bytes(&self, places: &[(u32, DVec3)]) -> usize {
        let step = (places.len() / SAMPLES).max(1);
        let few: Vec<&(u32, DVec3)> = places.iter().step_by(step).collect();
        let leaves = &self.radiosity.transport.leaves;
        let length = |(leaf, x): &&(u32, DVec3)| self.list(leaves[*leaf as usize], *leaf, *x).0.len();
        let sum: usize = few.par_iter().map(length).sum();
        size_of::<Entry>() * places.len() * (sum / few.len().max(1) + 1)
    }

    fn row(&self, node: u32) -> &[f64] {
        &self.nodes[node as usize * self.width..][..self.width]
    }

    /// What a point of a leaf receives from where, and from lights.
    fn list(&self, node: u32, leaf: u32, point: DVec3) -> (Vec<Entry>, Vec<f64>) {
        let radiosity = self.radiosity;
        let own = &radiosity.patches.nodes[node as usize];
        let place = Place::on(&radiosity.patches, point, own.polygon.normal, own.primitive);
        let mut lit = vec![0.0; self.width];
        let count = radiosity.sources.len();
        let factors = &radiosity.lit[leaf as usize * count..][..count];
        for (factor, row) in factors.iter().zip(self.lights.sources.chunks(self.width)) {
            lit.iter_mut().zip(row).for_each(|(s, l)| *s += factor * l);
        }
        self.add_lamps(&place, &mut lit);
        (self.look(&place, SHARE, TOLERANCE * radiosity.settings.accuracy), lit)
    }

    /// One step; the largest change of a point's radiosity, relative to the mean, averaged over the components.
    fn sweep(&mut self, lists: &[(Vec<Entry>, Vec<f64>)], places: &[(u32, DVec3)]) -> f64 {
        let width = self.width;
        let radiosity = self.radiosity;
        let known = &*self;
        let values: Vec<f64> = lists
            .par_iter()
            .zip(places)
            .flat_map_iter(|((list, lit), (leaf, _))| {
                let mut sum = lit.clone();
                known.add_entries(list, &mut sum);
                let side = radiosity.patches.nodes[radiosity.transport.leaves[*leaf as usize] as usize].side;
                known.reflect(side, &mut sum);
                sum
            })
            .collect();
        let change = self.change(&values);
        self.polished.values = values;
        let mut means = vec![0.0; radiosity.transport.leaves.len() * width];
        for (row, stencil) in means.chunks_mut(width).zip(&self.polished.stencils) {
            for (index, (_, weight)) in (stencil.first..).zip(stencil.points.iter()) {
                let value = self.polished.row(index, width);
                row.iter_mut().zip(value).for_each(|(m, v)| *m += weight * v);
            }
        }
        radiosity.transport.pull(&means, width, |_| 1.0, &mut self.nodes);
        change
    }

    fn change(&self, values: &[f64]) -> f64 {
        let (mut change, mut mean) = (vec![0.0_f64; self.width], vec![0.0; self.width]);
        for (new, old) in values.chunks(self.width).zip(self.polished.values.chunks(self.width)) {
            for (((change, mean), new), old) in change.iter_mut().zip(&mut mean).zip(new).zip(old) {
                *change = change.max((new - old).abs());
                *mean += new;
            }
        }
        #[allow(clippy::cast_precision_loss, reason = "counts")]
        let points = (values.len() / self.width.max(1)) as f64;
        let relative = change.iter().zip(&mean).map(|(c, m)| if *m > 0.0 { c * points / m } else { 0.0 });
        relative.fold(0.0, f64::max)
    }
}
