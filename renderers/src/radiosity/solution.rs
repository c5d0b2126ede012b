//! The radiosity of all patches.

use alloc::sync::Arc;

use super::gather;
use super::mesh::Side;
use super::polish::Polished;
use super::representation::{Representation, light};
use super::{Radiosity, Report};

/// The radiosity of all patches of a scene, for some components of the spectrum.
#[derive(Clone, Debug)]
pub struct Solution<'r> {
    pub(super) radiosity: &'r Radiosity,
    /// What the numbers mean.
    pub(super) representation: Arc<dyn Representation + Send + 'r>,
    pub(super) width: usize,
    /// Reflected radiosity of all nodes, row by row.
    pub(super) nodes: Vec<f64>,
    /// For each node, the mean over the components of its radiosity relative to the scene's mean.
    pub(super) levels: Vec<f64>,
    /// For each node, the largest range of a component among its leaves, relative to the scene's mean.
    pub(super) spreads: Vec<f64>,
    pub(super) lights: Lights,
    pub(super) polished: Polished,
    pub(super) report: Report,
    /// Reflected radiosity of the patches as it was solved for, row by row: no light is lost. Empty where that is what nodes have.
    pub(super) solved: Vec<f64>,
}

/// The components of what radiosity is made from, row by row.
#[derive(Clone, Debug, Default)]
pub(super) struct Lights {
    /// Radiosity that each side sends out by itself.
    pub(super) emission: Vec<f64>,
    /// Of each source.
    pub(super) sources: Vec<f64>,
}

impl Lights {
    pub(super) fn new(radiosity: &Radiosity, representation: &dyn Representation) -> Self {
        let width = representation.width();
        let shine =
            |side: &Side| side.emission.map_or_else(|| vec![0.0; width], |radiance| light(representation, radiance));
        let emission = radiosity.patches.sides.iter().flat_map(shine);
        Self {
            emission: emission.map(|e| core::f64::consts::PI * e).collect(),
            sources: radiosity.sources.iter().flat_map(|source| light(representation, source.spectrum)).collect(),
        }
    }
}

impl<'r> Solution<'r> {
    pub(super) fn new(
        radiosity: &'r Radiosity,
        representation: Arc<dyn Representation + Send + 'r>,
        reflected: &[f64],
        mut report: Report,
    ) -> Self {
        let (width, values) = (representation.width(), representation.values());
        let transport = &radiosity.transport;
        let mut nodes = Vec::new();
        transport.pull(reflected, width, |_| 1.0, &mut nodes);
        let area: f64 = transport.areas.iter().sum();
        let mut means = vec![0.0; width];
        for (row, a) in reflected.chunks(width).zip(&transport.areas) {
            means.iter_mut().zip(row).for_each(|(m, b)| *m += b * a / area);
        }
        let relative = |value: f64, mean: f64| if mean > 0.0 { value / mean } else { 0.0 };
        #[allow(clippy::cast_precision_loss, reason = "components are few")]
        let level = |row: &[f64]| {
            row[..values].iter().zip(&means).map(|(b, m)| relative(b.abs(), *m)).sum::<f64>() / values as f64
        };
        let levels = nodes.chunks(width).map(level).collect();
        let spreads = spreads(radiosity, [width, values], &nodes, &means, relative);
        let lights = Lights::new(radiosity, &*representation);
        report.row_bytes = size_of_val(&*nodes);
        let polished = Polished::default();
        let solved = Vec::new();
        Self { radiosity, representation, width, nodes, levels, spreads, lights, polished, report, solved }
    }

    /// What the numbers of a row mean.
    pub fn representation(&self) -> &(dyn Representation + 'r) {
        &*self.representation
    }

    /// How many numbers a row has.
    pub const fn width(&self) -> usize {
        self.width
    }

    /// Patches, links, convergence and balance.
    pub const fn report(&self) -> &Report {
        &self.report
    }

    /// The relative error to be expected: several times what was aimed at, as has been measured, and that of the iteration.
    pub(super) fn relative_error(&self) -> f64 {
        let accuracy = self.radiosity.settings.accuracy;
        let measured = match (self.report.uncertain_links > 0, self.report.points > 0) {
            // Without points, patches of one radiosity.
            (true, false) => (0.5 * accuracy.sqrt()).max(6.0 * accuracy),
            (true, true) => 3.0 * accuracy,
            // Patches of one radiosity under an uneven light leave an error in proportion to their size.
            (false, _) if self.report.closed < 1.0 => (0.3 * accuracy.sqrt()).max(3.0 * accuracy),
            (false, _) => 3.0 * accuracy,
        };
        let far = if self.radiosity.patches.clusters.is_empty() { 0.0 } else { gather::TOLERANCE * accuracy };
        measured + far + self.report.iteration_error
    }

    /// Reflected radiosity of each patch in the unit of the lights' radiance times sr, with the patch's area: one value for each component.
    pub fn patches(&self) -> impl Iterator<Item = (&[f64], f64)> {
        let transport = &self.radiosity.transport;
        let row = |(index, leaf): (usize, &u32)| {
            let (rows, place) =
                if self.solved.is_empty() { (&self.nodes, *leaf as usize) } else { (&self.solved, index) };
            &rows[place * self.width..][..self.width]
        };
        transport.leaves.iter().enumerate().map(row).zip(transport.areas.iter().copied())
    }
}

/// Ranges of relative radiosity among the leaves of each node, and of each cluster after them.
fn spreads(
    radiosity: &Radiosity,
    [width, values]: [usize; 2],
    nodes: &[f64],
    means: &[f64],
    relative: impl Fn(f64, f64) -> f64,
) -> Vec<f64> {
    let (tree, clusters) = (&radiosity.patches.nodes, &radiosity.patches.clusters);
    let rows = tree.len() + clusters.len();
    let mut spreads = vec![0.0_f64; rows];
    for component in 0..values {
        let mut range = vec![[f64::INFINITY, f64::NEG_INFINITY]; rows];
        let both =
            |range: &[[f64; 2]], [a, b]: [usize; 2]| [range[a][0].min(range[b][0]), range[a][1].max(range[b][1])];
        for (index, node) in tree.iter().enumerate().rev() {
            range[index] = match node.children() {
                None => [relative(nodes[index * width + component], means[component]); 2],
                Some(children) => both(&range, children),
            };
        }
        for (index, cluster) in clusters.iter().enumerate().rev() {
            range[tree.len() + index] = both(&range, cluster.children.map(|child| radiosity.patches.row(child)));
        }
        spreads.iter_mut().zip(&range).for_each(|(spread, [low, high])| *spread = spread.max(high - low));
    }
    spreads
}
