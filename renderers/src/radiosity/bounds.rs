//! How far off the colours of patches may be, and which cells of the spectrum to split for that.

use alloc::collections::BinaryHeap;
use core::cmp::Reverse;

use rayon::prelude::*;
use spectral_core::adaptive::Mode;
use spectral_core::bound::{ColourBound, delta_e_bound};
use spectral_core::interval::Node;

use super::cell::{Cell, DEPTH, Row};
use super::slopes::Slopes;
use crate::spectral::IntervalSettings;

/// The most cells.
pub(super) const MOST_CELLS: usize = 512;
/// What splitting by patches aims at, as a share of the threshold, and what an estimate may be at most.
const AIM: f64 = 0.95;
const ESTIMATED: f64 = 0.97;
/// Leaves whose colours are found by one task.
const CHUNK: usize = 128;

/// A cell with the radiosity of all leaves of a field.
#[derive(Clone, Debug)]
pub(super) struct Known {
    pub(super) cell: Cell,
    pub(super) rows: Vec<Row>,
    /// What norms were found for, until values are known.
    pub(super) slopes: Slopes,
    /// Whether the values are solved for; until then they are estimates.
    pub(super) settled: bool,
}

impl Known {
    pub(super) fn is(&self, place: (usize, Node)) -> bool {
        (self.cell.lamp, self.cell.node) == place
    }
}

/// The colour of what a leaf reflects, and how far that may be off.
fn sum(mode: Mode, cells: &[Known], leaf: usize) -> [[f64; 3]; 2] {
    let parts = cells.iter().map(|known| seen(mode, known, leaf));
    parts.fold([[0.0; 3]; 2], |[xyz, radius], (value, around)| {
        [core::array::from_fn(|a| xyz[a] + value[a]), core::array::from_fn(|a| radius[a] + around[a])]
    })
}

/// The bound of that colour.
pub(super) fn bound(settings: &IntervalSettings, cells: &[Known], leaf: usize) -> ColourBound<f64> {
    let [xyz, radius] = sum(settings.mode, cells, leaf);
    delta_e_bound(xyz, radius, settings.white())
}

/// What one cell has of both.
pub(super) fn seen(mode: Mode, known: &Known, leaf: usize) -> ([f64; 3], [f64; 3]) {
    known.cell.colour(mode, &known.rows[leaf].times(core::f64::consts::FRAC_1_PI))
}

/// What all patches reflect, how far that may be off, and the bounds of the difference in colour.
pub(super) struct Bounds {
    mode: Mode,
    white: [f64; 3],
    sums: Vec<[[f64; 3]; 2]>,
    pub(super) delta_e: Vec<f64>,
}

impl Bounds {
    pub(super) fn new(settings: &IntervalSettings, cells: &[Known]) -> Self {
        let (mode, white) = (settings.mode, settings.white());
        let leaves = cells.first().map_or(0, |known| known.rows.len());
        let (mut sums, mut delta_e) = (vec![[[0.0; 3]; 2]; leaves], vec![0.0; leaves]);
        let chunks = sums.par_chunks_mut(CHUNK).zip(delta_e.par_chunks_mut(CHUNK)).enumerate();
        chunks.for_each(|(chunk, (sums, delta_e))| {
            for known in cells {
                known.cell.add_colours(mode, &known.rows[chunk * CHUNK..][..sums.len()], sums);
            }
            for ([xyz, radius], delta_e) in sums.iter_mut().zip(delta_e) {
                // Radiosity is π times radiance.
                [*xyz, *radius] = [*xyz, *radius].map(|sum| sum.map(|v| v * core::f64::consts::FRAC_1_PI));
                *delta_e = delta_e_bound(*xyz, *radius, white).delta_e;
            }
        });
        Self { mode, white, sums, delta_e }
    }

    /// The bound of a leaf's colour if these cells' radii were a quarter.
    fn of_leaf(&self, leaf: usize, cells: &[Known], split: &[usize]) -> ColourBound<f64> {
        const LEFT: f64 = 0.25;
        let [xyz, mut radius] = self.sums[leaf];
        for index in split {
            let (_, around) = seen(self.mode, &cells[*index], leaf);
            radius.iter_mut().zip(around).for_each(|(r, part)| *r -= (1.0 - LEFT) * part);
        }
        delta_e_bound(xyz, radius.map(|r| r.max(0.0)), self.white)
    }

    /// The cells that the bounds of patches need split: none if these are at or under the threshold, or no smaller part would help.
    pub(super) fn places_to_split(&self, cells: &[Known], threshold: f64, share: f64) -> Vec<(usize, Node)> {
        #[allow(
            clippy::cast_precision_loss,
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "cells are few"
        )]
        let some = ((cells.len() as f64 * share) as usize).max(1);
        let most = some.min(MOST_CELLS.saturating_sub(cells.len()));
        // Values that are solved for are a little less than estimates, so that the same radius counts for more.
        let enough = if cells.iter().all(|known| known.settled) { threshold } else { ESTIMATED * threshold };
        if self.delta_e.iter().all(|bound| *bound <= enough) {
            return Vec::new();
        }
        let chosen = self.split(cells, AIM * threshold, most);
        chosen.into_iter().map(|index| (cells[index].cell.lamp, cells[index].cell.node)).collect()
    }

    /// The cells to split so that all patches' bounds come down to `aim`, if a half's radius is an eighth: mass is proportional to width, and a
    /// covariance to its square. No more than `most`, those first that the worst patches need most.
    fn split(&self, cells: &[Known], aim: f64, most: usize) -> Vec<usize> {
        let mut chosen: Vec<usize> = Vec::new();
        // Bounds only fall as cells are chosen: those of patches that aren't the worst needn't be known exactly. They aren't negative, so that
        // their bits are in order.
        let entry = |leaf: usize, bound: f64, when: usize| (bound.to_bits(), Reverse(leaf), when);
        let all: Vec<_> = self.delta_e.iter().enumerate().map(|(leaf, bound)| entry(leaf, *bound, 0)).collect();
        let mut worst = BinaryHeap::from(all);
        while chosen.len() < most {
            let Some((bound, Reverse(leaf), when)) = worst.pop() else { break };
            let now = self.of_leaf(leaf, cells, &chosen);
            if when < chosen.len() {
                worst.push(entry(leaf, now.delta_e, chosen.len()));
                continue;
            }
            if f64::from_bits(bound) <= aim {
                break;
            }
            let score = |index: &usize| {
                let (_, radius) = seen(self.mode, &cells[*index], leaf);
                radius.iter().zip(now.gradient).map(|(r, g)| r * g).sum::<f64>()
            };
            let open = |index: &usize| !chosen.contains(index) && cells[*index].cell.node.level() < DEPTH;
            let Some(index) = (0..cells.len()).filter(open).max_by(|a, b| score(a).total_cmp(&score(b))) else { break };
            chosen.push(index);
            // Looked at again as one of those that aren't known exactly.
            worst.push(entry(leaf, now.delta_e, 0));
        }
        chosen
    }
}
