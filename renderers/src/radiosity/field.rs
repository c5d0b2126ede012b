//! Solutions on parts of the spectrum, with bounds.
//!
//! On a cell with measure dν, and with mean reflectances μ, the mean radiosity X̄ solves (I − μK) X̄ = μ h, where h is the irradiance of
//! what the lamp sends out. The true mean is within r of it, and ‖X − X̄‖ ≤ n in the norm of ν, where
//!
//! - (I − sup ρ K) n = ‖δ‖ (h + K X̄), because X − X̄ = (I − ρK)⁻¹ δ (h + K X̄) with δ = ρ − μ, and (I − ρK)⁻¹ grows with ρ;
//! - (I − μK) r = ‖δ‖ K n, because ∫X dν − X̄ = (I − μK)⁻¹ ∫δ K(X − X̄) dν.
//!
//! Two solutions bound all three channels, with the greatest ‖δ‖, X̄ and μ of any. What iteration and rounding leave is at most the largest
//! residual times y / min(y − sup ρ K y), for any y for which that is positive (L. Collatz, Math. Z. 48, 1942).

use spectral_core::adaptive::Mode;

use super::cell::{Cell, LEAST_SHARE, Part, Row};
use super::solve::{Solved, System};
use super::transport::{Buffer, Transport};
use crate::spectral::Factor;

/// Cells whose values are solved for together, at most 16 numbers; and cells whose bounds are.
const CELLS: usize = 5;
const BLOCK: usize = 15;
/// Relative error of bounds, and of the bound of what iteration leaves.
const BOUND_TOLERANCE: f64 = 1e-2;
/// What rounding may leave as a residual, as a share of the largest value: some hundred terms of any one irradiance.
const ROUNDING: f64 = 1e-13;

/// What one lamp's spectrum gives, for a spectrum of 1: radiosity sent out, irradiance from lights without area, all irradiance.
#[derive(Clone, Debug, Default)]
pub(super) struct Lit {
    pub(super) emitted: Vec<f64>,
    pub(super) direct: Vec<f64>,
    pub(super) all: Vec<f64>,
}

/// A transport between surfaces that are lit.
#[derive(Clone, Debug)]
pub(super) struct Field<'t> {
    pub(super) transport: &'t Transport,
    /// For each leaf, the index of its reflectance.
    pub(super) surface: Vec<usize>,
    pub(super) reflectances: Vec<Factor>,
    pub(super) lamps: Vec<Lit>,
    pub(super) largest_sum: f64,
    /// For each leaf, at most how much the error of a solution is for a residual of 1.
    pub(super) amplification: Vec<f64>,
    pub(super) bounces: Option<u32>,
}

/// Told how often a number was carried through the operator, and of the values of each block of cells.
pub(super) type Told<'w> = dyn FnMut(usize, Option<(&[Cell], &Values<'_>)>) + 'w;

/// Room and aims for solutions, and who is told of them.
pub(super) struct Work<'w> {
    pub(super) tolerance: f64,
    pub(super) buffer: Buffer,
    pub(super) report: &'w mut Told<'w>,
}

/// The values of a block of cells, for reports.
pub(super) struct Values<'f> {
    pub(super) system: System<'f>,
    pub(super) solved: Solved,
    pub(super) irradiance: Vec<f64>,
}

/// A cell's rows, and what iteration and rounding leave as a residual of the values.
struct Known {
    rows: Vec<Row>,
    left: f64,
}

/// For how many cells the mean of all channels is solved for.
const fn more(mode: Mode, cells: usize) -> usize {
    if matches!(mode, Mode::Paper) { cells } else { 0 }
}

impl<'t> Field<'t> {
    /// Finds the amplification for reflectances of at most `greatest`; infinite where there is no bound.
    pub(super) fn amplify(&mut self, greatest: &[f64], buffer: &mut Buffer) {
        let sums = self.transport.row_sums(buffer);
        let reflectance = self.surface.iter().map(|surface| greatest[*surface]).collect();
        let direct = vec![0.0; sums.len()];
        let system = System {
            transport: self.transport,
            width: 1,
            reflectance,
            direct,
            lit: sums,
            largest_sum: self.largest_sum,
        };
        // y = 1 + X solves y − ρKy = 1 but for the residual.
        let solved = system.solve(BOUND_TOLERANCE, buffer);
        let least = 1.0 - solved.residual[0] - ROUNDING;
        let positive = least > 0.0 && solved.reflected.iter().all(|x| *x >= 0.0);
        let bound = |x: &f64| if positive { (1.0 + x) / least } else { f64::INFINITY };
        self.amplification = solved.reflected.iter().map(bound).collect();
    }

    /// Reflected radiosity on some cells: for each of them, the rows of all leaves.
    pub(super) fn solve(&self, mode: Mode, cells: &[Cell], work: &mut Work<'_>) -> Vec<Vec<Row>> {
        let mut rows = Vec::new();
        for block in cells.chunks(BLOCK) {
            rows.extend(match self.bounces {
                Some(count) => self.reflect(mode, block, count, work),
                None => self.block(mode, block, work),
            });
        }
        rows
    }

    /// The cells' parts, for each reflectance.
    fn parts(&self, cells: &[Cell]) -> Vec<Vec<Part>> {
        self.reflectances.iter().map(|factor| cells.iter().map(|cell| cell.part(*factor)).collect()).collect()
    }

    /// Numbers for all leaves, row by row, from the parts of a leaf's reflectance.
    fn rows(&self, parts: &[Vec<Part>], width: usize, row: impl Fn(usize, &[Part], &mut Vec<f64>)) -> Vec<f64> {
        let mut rows = Vec::with_capacity(self.surface.len() * width);
        for (leaf, surface) in self.surface.iter().enumerate() {
            row(leaf, &parts[*surface], &mut rows);
        }
        rows
    }

    /// A number of the lamps, three times for each cell, then once more where the mean of all channels is solved for.
    pub(super) fn of_lamps(&self, mode: Mode, cells: &[Cell], number: impl Fn(&Lit) -> &[f64]) -> Vec<f64> {
        let lamps: Vec<&[f64]> = cells.iter().map(|cell| number(&self.lamps[cell.lamp])).collect();
        let lamps = &lamps;
        let row = |leaf: usize| {
            let thrice = lamps.iter().flat_map(move |lamp| [lamp[leaf]; 3]);
            thrice.chain(lamps[..more(mode, lamps.len())].iter().map(move |lamp| lamp[leaf]))
        };
        (0..self.surface.len()).flat_map(row).collect()
    }

    fn block(&self, mode: Mode, cells: &[Cell], work: &mut Work<'_>) -> Vec<Vec<Row>> {
        let at_once = if mode == Mode::Paper { CELLS - 1 } else { CELLS };
        let mut known = Vec::new();
        for cells in cells.chunks(at_once) {
            self.values(mode, cells, work, &mut known);
        }
        if mode == Mode::Certified {
            self.bounds(cells, &mut known, work);
        }
        known.into_iter().map(|known| known.rows).collect()
    }

    /// The values of some cells; in place of norms, the greatest irradiance in any channel where it is needed for them.
    fn values(&self, mode: Mode, cells: &[Cell], work: &mut Work<'_>, known: &mut Vec<Known>) {
        let parts = self.parts(cells);
        let more = more(mode, cells.len());
        let width = 3 * cells.len() + more;
        let means = |_: usize, parts: &[Part], row: &mut Vec<f64>| {
            parts.iter().for_each(|part| row.extend(part.mean));
            row.extend(parts[..more].iter().map(|part| part.common));
        };
        let system = System {
            transport: self.transport,
            width,
            reflectance: self.rows(&parts, width, means),
            direct: self.of_lamps(mode, cells, |lamp| &lamp.direct),
            lit: self.of_lamps(mode, cells, |lamp| &lamp.all),
            largest_sum: self.largest_sum,
        };
        let solved = system.solve(work.tolerance, &mut work.buffer);
        let mut irradiance = vec![0.0; solved.reflected.len()];
        self.transport.apply(&solved.reflected, &mut irradiance, width, &mut work.buffer);
        let values = Values { system, solved, irradiance };
        (work.report)((values.solved.steps + 1) * width, Some((cells, &values)));
        let Values { system, solved, irradiance } = &values;
        let arriving = |i: usize| (irradiance[i] + system.lit[i]).abs();
        // The greatest of three components.
        let greatest = |of: &dyn Fn(usize) -> f64, first: usize| (first..first + 3).map(of).fold(0.0, f64::max);
        for cell in 0..cells.len() {
            let row = |leaf: usize| {
                let first = leaf * width + 3 * cell;
                let at = &solved.reflected[first..];
                let norm = match mode {
                    Mode::Paper => solved.reflected[leaf * width + 3 * cells.len() + cell],
                    Mode::Corrected => 0.0,
                    Mode::Certified => greatest(&arriving, first),
                };
                Row { value: [at[0], at[1], at[2]], norm, radius: 0.0 }
            };
            let rows: Vec<Row> = (0..self.surface.len()).map(row).collect();
            let largest = rows.iter().fold(0.0, |m: f64, row| m.max(row.norm));
            let left = greatest(&|i| solved.residual[i], 3 * cell) + ROUNDING * largest;
            known.push(Known { rows, left });
        }
    }

    /// Norms and radii.
    fn bounds(&self, cells: &[Cell], known: &mut [Known], work: &mut Work<'_>) {
        let parts = self.parts(cells);
        let left: Vec<f64> = known.iter().map(|known| known.left).collect();
        let ratio = |above: f64, below: f64| if below > 0.0 { above / below } else { 0.0 };
        let light = |leaf: usize, cell: usize, part: &Part| {
            let most = known[cell].rows[leaf].norm + self.amplification[leaf] * left[cell];
            ratio(part.deviation, part.high) * most
        };
        // What is left is in all channels alike, whatever their shares.
        let all: Vec<f64> = left.iter().map(|left| left / LEAST_SHARE).collect();
        let norm = self.bound(&parts, &|part| part.high, &light, &all, work);
        let mut spread = vec![0.0; norm.len()];
        self.transport.apply(&norm, &mut spread, cells.len(), &mut work.buffer);
        // No less than what the source is divided by: a bound all the same.
        let most = |part: &Part| part.most.max(part.deviation);
        let light = |leaf: usize, cell: usize, part: &Part| {
            ratio(part.deviation, most(part)) * spread[leaf * cells.len() + cell]
        };
        let radius = self.bound(&parts, &most, &light, &all, work);
        for (cell, known) in known.iter_mut().enumerate() {
            for (leaf, row) in known.rows.iter_mut().enumerate() {
                row.norm = norm[leaf * cells.len() + cell];
                row.radius = radius[leaf * cells.len() + cell];
            }
        }
    }

    /// At least the solution X = ρ (light + K X) for each leaf and cell, and what a residual of `left` makes.
    fn bound(
        &self,
        parts: &[Vec<Part>],
        reflectance: &dyn Fn(&Part) -> f64,
        light: &dyn Fn(usize, usize, &Part) -> f64,
        left: &[f64],
        work: &mut Work<'_>,
    ) -> Vec<f64> {
        let width = left.len();
        let lit = self.rows(parts, width, |leaf, parts, row| {
            row.extend(parts.iter().enumerate().map(|(cell, part)| light(leaf, cell, part)));
        });
        let system = System {
            transport: self.transport,
            width,
            reflectance: self.rows(parts, width, |_, parts, row| row.extend(parts.iter().map(reflectance))),
            direct: Vec::new(),
            lit,
            largest_sum: self.largest_sum,
        };
        let mut found = system.solve(BOUND_TOLERANCE, &mut work.buffer);
        (work.report)((found.steps + 1) * width, None);
        for (row, amplification) in found.reflected.chunks_mut(width).zip(&self.amplification) {
            for ((value, residual), left) in row.iter_mut().zip(&found.residual).zip(left) {
                *value = value.max(0.0) + amplification * (residual + left);
            }
        }
        found.reflected
    }

    /// A limited number of reflections, one after the other.
    fn reflect(&self, mode: Mode, cells: &[Cell], count: u32, work: &mut Work<'_>) -> Vec<Vec<Row>> {
        let parts = self.parts(cells);
        let lamps: Vec<&[f64]> = cells.iter().map(|cell| &*self.lamps[cell.lamp].all).collect();
        let light = |leaf: usize, cell: usize| {
            let light = lamps[cell][leaf];
            Row { value: [light; 3], norm: if mode == Mode::Certified { 0.0 } else { light }, radius: 0.0 }
        };
        let row = |rows: &[f64], place: usize| Row::new(core::array::from_fn(|i| rows[place + i]));
        let width = 5 * cells.len();
        let (mut rows, mut irradiance) = (vec![0.0; self.surface.len() * width], vec![0.0; self.surface.len() * width]);
        for _ in 0..count {
            self.transport.apply(&rows, &mut irradiance, width, &mut work.buffer);
            (work.report)(width, None);
            for (leaf, surface) in self.surface.iter().enumerate() {
                for (cell, part) in parts[*surface].iter().enumerate() {
                    let place = leaf * width + 5 * cell;
                    let from = row(&irradiance, place).numbers();
                    let light = light(leaf, cell).numbers();
                    let arriving = Row::new(core::array::from_fn(|i| from[i] + light[i]));
                    rows[place..][..5].copy_from_slice(&Cell::reflected(mode, part, &arriving).numbers());
                }
            }
        }
        let of = |cell: usize| (0..self.surface.len()).map(move |leaf| leaf * width + 5 * cell);
        (0..cells.len()).map(|cell| of(cell).map(|place| row(&rows, place)).collect()).collect()
    }
}
