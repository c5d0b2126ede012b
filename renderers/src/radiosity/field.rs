//! Solutions on parts of the spectrum, with bounds.
//!
//! On a cell with measure dν, and with mean reflectances μ, the mean radiosity X̄ solves (I − μK) X̄ = μ h, where h is the irradiance of
//! what the lamp sends out. The true mean is within r of it, and ‖X − X̄‖ ≤ n in the norm of ν, where
//!
//! - (I − sup ρ K) n = ‖δ‖ (h + K X̄), because X − X̄ = (I − ρK)⁻¹ δ (h + K X̄) with δ = ρ − μ, and (I − ρK)⁻¹ grows with ρ;
//! - (I − μK) r = ‖δ‖ K n, because ∫X dν − X̄ = (I − μK)⁻¹ ∫δ K(X − X̄) dν.
//!
//! Two [bounds](Above) of solutions hold for all three channels, with the greatest ‖δ‖, X̄ and μ of any; they need no more than a bound of X̄,
//! so that values are solved for last, on those cells alone that are good enough. As n is linear in h + K X̄, and r in n, both are then lowered
//! by what the light was over-estimated in the worst place.
//!
//! What is solved for is a bound whatever found it: starts, groups and cycles change how soon, not whether. What remains between the numbers and
//! the exact solution of the discrete system, with K, H₀ and ρ as they are stored, is covered in turn:
//!
//! - iteration: X̃ with the residual R = |X̃ − μ(h + KX̃)| in all leaves is at most R·A from X̄, for any A with A − sup ρ K A ≥ 1, as
//!   X̃ − X̄ = (I − μK)⁻¹ of that; R is formed anew from K X̃ and not the one that conjugate gradients carry along;
//! - rounding of K, in H₀ and in K X̃, and of the means μ, changes R by no more than these shares of the greatest irradiance, which are added to
//!   it; [`Above`] covers that of its own residuals;
//! - rounding of integrals, products and sums over cells: [`Cell`] adds it to deviations, norms, radii and colours.

use rayon::prelude::*;
use spectral_core::adaptive::Mode;

use super::cell::{Cell, LEAST_SHARE, Part, ROUNDING, Row};
use super::coarse::Coarse;
use super::majorant::{Above, Kinds, Majorant};
use super::solve::{Solved, System};
use super::start::{Basis, Leaves};
use super::system::{self, Judgement};
use super::transport::{Buffer, Buffers, Transport};
use crate::spectral::Factor;

/// Columns of values that are solved for together, and cells whose bounds are.
const LANES: usize = 8;
/// So many cells have neighbours that are near enough to interpolate between.
const MANY: usize = 6;

/// A cell among some and its channel: x, y, z or [`COMMON`].
pub(super) type Column = (usize, usize);

const X: usize = 0;
const FIRST: usize = 1;
const Z: usize = 2;
/// The mean of all channels.
const COMMON: usize = 3;

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
    /// What each leaf sees of others, ΣF; empty where nobody asks for a balance.
    pub(super) sums: &'t [f64],
    /// Groups of leaves, and the index of the reflectance of each.
    pub(super) coarse: Coarse,
    pub(super) of_groups: Vec<usize>,
    /// For each leaf, at most how much the error of a solution is for a residual of 1, and K times that. Infinite where there is no bound.
    pub(super) amplification: Vec<f64>,
    pub(super) amplified: Vec<f64>,
    /// What rounding may change of an irradiance.
    pub(super) rounding: f64,
    pub(super) bounces: Option<u32>,
}

/// Told how often a number was carried through the operator, and of the balance of each block of values.
pub(super) type Told<'w> = dyn FnMut(usize, Option<&Judgement>) + 'w;

/// Room and aims for solutions, and who is told of them.
pub(super) struct Work<'w> {
    pub(super) tolerance: f64,
    pub(super) buffers: &'w Buffers,
    pub(super) report: &'w mut Told<'w>,
}

/// Some columns of values.
struct Block<'c> {
    columns: &'c [Column],
    solved: Solved,
    judgement: Judgement,
    /// For each column, the greatest share that its light has of the estimate, and what iteration and rounding leave as a residual.
    left: Vec<[f64; 2]>,
}

impl<'t> Field<'t> {
    /// Finds the amplification for reflectances of at most `greatest`.
    pub(super) fn amplify(&mut self, greatest: &[f64], buffer: &mut Buffer) {
        let kinds: Vec<[f64; 1]> = greatest.iter().map(|v| [*v]).collect();
        let of_groups: Vec<[f64; 1]> = self.of_groups.iter().map(|s| kinds[*s]).collect();
        let reflectance = Kinds { numbers: &kinds, kind: &self.surface };
        let above = Above { amplification: &[], amplified: &[], ..self.above() };
        let ones = vec![[1.0]; self.surface.len()];
        let Majorant { values, irradiance, .. } = above.solve(&ones, reflectance, &of_groups, buffer);
        // What is returned is reflected once more, so that A − ρKA ≥ 1 holds but for rounding of that: a share of the largest A.
        let lost = 8.0 * self.rounding * values.as_flattened().iter().fold(0.0, |m: f64, a| m.max(*a));
        let up = if lost <= 0.5 { 1.0 + 2.0 * lost } else { f64::INFINITY };
        let raised = |rows: Vec<[f64; 1]>, up: f64| rows.into_iter().map(|[a]| a * up).collect();
        self.amplification = raised(values, up);
        self.amplified = raised(irradiance, up * (1.0 + 8.0 * self.rounding));
    }

    /// Whether errors are bounded.
    pub(super) fn is_bounded(&self) -> bool {
        self.amplification.iter().chain(&self.amplified).all(|a| a.is_finite())
    }

    fn above(&self) -> Above<'_> {
        Above {
            transport: self.transport,
            coarse: &self.coarse,
            amplification: &self.amplification,
            amplified: &self.amplified,
            rounding: self.rounding,
        }
    }

    /// Reflected radiosity on some cells: for each of them, the rows of all leaves.
    pub(super) fn solve(&self, mode: Mode, cells: &[Cell], work: &mut Work<'_>) -> Vec<Vec<Row>> {
        let mut rows = match (self.bounces, mode) {
            (Some(count), _) => {
                return cells.chunks(LANES).flat_map(|block| self.reflect(mode, block, count, work)).collect();
            }
            (None, Mode::Certified) => self.estimate(cells, work),
            (None, _) => vec![vec![Row::default(); self.surface.len()]; cells.len()],
        };
        self.settle(mode, cells, rows.iter_mut().collect(), work);
        rows
    }

    /// Norms and radii on some cells by the certified mode, and values that aren't known as well.
    pub(super) fn estimate(&self, cells: &[Cell], work: &mut Work<'_>) -> Vec<Vec<Row>> {
        if !self.is_bounded() {
            let unknown = Row { value: [0.0; 3], norm: f64::INFINITY, radius: f64::INFINITY };
            return vec![vec![unknown; self.surface.len()]; cells.len()];
        }
        // More than one task, where there is enough for that.
        let most = cells.len().div_ceil(2).clamp(2, LANES);
        let mut blocks: Vec<&[Cell]> = cells.chunks(most).collect();
        let buffers = work.buffers;
        let found: Vec<(Vec<Vec<Row>>, usize)> = if let [block] = blocks[..] {
            vec![work.buffers.lend(|buffer| self.bounds(block, buffer))]
        } else {
            blocks.par_drain(..).map(|block| buffers.lend(|buffer| self.bounds(block, buffer))).collect()
        };
        (work.report)(found.iter().map(|(_, passes)| passes).sum(), None);
        found.into_iter().flat_map(|(rows, _)| rows).collect()
    }

    /// The cells' parts, for each reflectance.
    fn parts(&self, cells: &[Cell]) -> Vec<Vec<Part>> {
        self.reflectances.iter().map(|factor| cells.iter().map(|cell| cell.part(*factor)).collect()).collect()
    }

    /// Mean reflectances, for each leaf and column.
    fn reflectance(&self, parts: &[Vec<Part>], columns: &[Column]) -> Vec<f64> {
        let of = |parts: &Vec<Part>| columns.iter().map(|(cell, channel)| mean(&parts[*cell], *channel)).collect();
        let known: Vec<Vec<f64>> = parts.iter().map(of).collect();
        let mut rows = Vec::with_capacity(self.surface.len() * columns.len());
        self.surface.iter().for_each(|surface| rows.extend_from_slice(&known[*surface]));
        rows
    }

    /// What all leaves receive from the lamps, for each leaf and column.
    fn lit(&self, cells: &[Cell], columns: &[Column]) -> Vec<f64> {
        let lamps: Vec<&[f64]> = columns.iter().map(|(cell, _)| &*self.lamps[cells[*cell].lamp].all).collect();
        let mut rows = Vec::with_capacity(self.surface.len() * lamps.len());
        (0..self.surface.len()).for_each(|leaf| rows.extend(lamps.iter().map(|lamp| lamp[leaf])));
        rows
    }

    /// Solves for the values of some cells, which are put into their rows; norms and radii then cover what iteration and rounding leave.
    ///
    /// One channel of all cells comes first where these are many, as the others are near to combinations of that.
    pub(super) fn settle(&self, mode: Mode, cells: &[Cell], mut rows: Vec<&mut Vec<Row>>, work: &mut Work<'_>) {
        let parts = self.parts(cells);
        let channels: &[usize] = if mode == Mode::Paper { &[X, FIRST, Z, COMMON] } else { &[X, FIRST, Z] };
        let stages = stages(cells, channels);
        let mut left: Vec<Left> = vec![Left::default(); cells.len()];
        if mode == Mode::Certified && self.is_bounded() {
            left.par_iter_mut().zip(&rows).enumerate().for_each(|(cell, (left, rows))| {
                left.estimate =
                    rows.iter().zip(&self.surface).map(|(row, s)| estimate(&parts[*s][cell], row)).collect();
            });
        }
        let (mut known, mut blocks) = (None, Vec::new());
        for columns in &stages {
            let basis = known.as_ref().map(|known| self.basis(known));
            let (tolerance, buffers) = (work.tolerance, work.buffers);
            let solve = |columns| self.block(cells, &parts, columns, (basis.as_ref(), tolerance, buffers), &left);
            let found: Vec<Block<'_>> = columns.par_chunks(LANES).map(solve).collect();
            found.iter().for_each(|block| (work.report)(block.solved.passes, Some(&block.judgement)));
            if known.is_none() && stages.len() > 1 {
                known = Some(Solved::side_by_side(&found.iter().map(|block| &block.solved).collect::<Vec<_>>()));
            }
            blocks.extend(found);
        }
        for block in &blocks {
            for ((cell, _), [share, residual]) in block.columns.iter().zip(&block.left) {
                left[*cell].note(*share, *residual);
            }
        }
        rows.par_iter_mut().zip(left).enumerate().for_each(|(cell, (rows, left))| {
            blocks.iter().for_each(|block| block.put(cell, rows));
            if mode == Mode::Certified {
                left.cover(rows, self);
            }
        });
    }

    /// Solutions that others are near to.
    fn basis<'s>(&self, known: &'s Solved) -> Basis<'s> {
        let leaves = Leaves { areas: &self.transport.areas, kind: &self.surface, kinds: self.reflectances.len() };
        let lights: Vec<&[f64]> = self.lamps.iter().map(|lamp| &*lamp.all).collect();
        Basis::new(known, leaves, &lights)
    }

    /// Solves for some columns.
    fn block<'c>(
        &self,
        cells: &[Cell],
        parts: &[Vec<Part>],
        columns: &'c [Column],
        (basis, tolerance, buffers): (Option<&Basis<'_>>, f64, &Buffers),
        left: &[Left],
    ) -> Block<'c> {
        let system = System {
            transport: self.transport,
            width: columns.len(),
            reflectance: self.reflectance(parts, columns),
            lit: self.lit(cells, columns),
            largest_sum: self.largest_sum,
        };
        let start = basis.map(|basis| {
            let factors = |(cell, channel): &Column| {
                let reflectance: Vec<f64> = parts.iter().map(|parts| mean(&parts[*cell], *channel)).collect();
                basis.factors(&reflectance, cells[*cell].lamp)
            };
            basis.combined(&columns.iter().map(factors).collect::<Vec<_>>())
        });
        let solved = system.solve_from(start.as_ref(), tolerance, buffers);
        let lamps: Vec<&Lit> = columns.iter().map(|(cell, _)| &self.lamps[cells[*cell].lamp]).collect();
        let part = |leaf: usize, column: usize| {
            let place = leaf * columns.len() + column;
            let arriving = solved.irradiance[place] + system.lit[place];
            let (emitted, direct) = (lamps[column].emitted[leaf], lamps[column].direct[leaf]);
            let leaving = arriving * system.reflectance[place];
            system::Part { emitted, direct, arriving, leaving, reflected: solved.reflected[place] }
        };
        let judgement = Judgement::new((&self.transport.areas, self.sums), &solved, &system.amplification(), part);
        let left = self.left(&system, &solved, columns, left);
        Block { columns, solved, judgement, left }
    }

    /// For each column, the greatest share that its light has of the estimate, and what iteration and rounding leave as a residual.
    ///
    /// Rounding: of K X and of H₀, which is K of something, too, and of the mean reflectances.
    fn left(&self, system: &System<'_>, solved: &Solved, columns: &[Column], left: &[Left]) -> Vec<[f64; 2]> {
        let rounding = 2.0 * self.rounding + ROUNDING;
        let width = columns.len();
        let of_column = |(column, (cell, _)): (usize, &Column)| {
            let number = |rows: &[f64], leaf: usize| rows[leaf * width + column];
            let (mut share, mut most, mut lit_most) = (0.0_f64, 0.0_f64, 0.0_f64);
            for leaf in 0..self.surface.len() {
                let lit = number(&system.lit, leaf);
                most = most.max(number(&solved.reflected, leaf).abs());
                lit_most = lit_most.max(lit.abs());
                if let Some(estimate) = left[*cell].estimate.get(leaf) {
                    share = share.max((number(&solved.irradiance, leaf) + lit) / estimate);
                }
            }
            [share, solved.residual[column] + rounding * (self.largest_sum.max(1.0) * most + lit_most)]
        };
        columns.iter().enumerate().map(of_column).collect()
    }

    /// Norms and radii, and how often something was carried through the operator.
    fn bounds(&self, cells: &[Cell], buffer: &mut Buffer) -> (Vec<Vec<Row>>, usize) {
        match cells.len() {
            0 => (Vec::new(), 0),
            1 => self.bounds_of::<1>(cells, buffer),
            2 => self.bounds_of::<2>(cells, buffer),
            3 => self.bounds_of::<3>(cells, buffer),
            4 => self.bounds_of::<4>(cells, buffer),
            5 => self.bounds_of::<5>(cells, buffer),
            6 => self.bounds_of::<6>(cells, buffer),
            7 => self.bounds_of::<7>(cells, buffer),
            _ => self.bounds_of::<LANES>(cells, buffer),
        }
    }

    fn bounds_of<const W: usize>(&self, cells: &[Cell], buffer: &mut Buffer) -> (Vec<Vec<Row>>, usize) {
        let parts = self.parts(cells);
        let of_kinds = |number: &dyn Fn(&Part) -> f64| -> Vec<[f64; W]> {
            parts.iter().map(|parts| core::array::from_fn(|cell| number(&parts[cell]))).collect()
        };
        let above = self.above();
        let mut passes = 0;
        let mut least = |source: &[[f64; W]], numbers: &[[f64; W]]| {
            let of_groups: Vec<[f64; W]> = self.of_groups.iter().map(|kind| numbers[*kind]).collect();
            let found = above.solve(source, Kinds { numbers, kind: &self.surface }, &of_groups, buffer);
            passes += found.passes;
            found
        };
        let times = |rows: &[[f64; W]], numbers: &[[f64; W]]| -> Vec<[f64; W]> {
            let kinds = Kinds { numbers, kind: &self.surface };
            rows.iter().zip(kinds.rows()).map(|(a, b)| core::array::from_fn(|i| a[i] * b[i])).collect()
        };
        let [most, high, deviation] =
            [of_kinds(&|part| part.most), of_kinds(&|part| part.high), of_kinds(&|part| part.deviation)];
        let lamps: [&[f64]; W] = core::array::from_fn(|cell| &*self.lamps[cells[cell].lamp].all);
        let up = 1.0 + 2.0 * self.rounding;
        let mut light: Vec<[f64; W]> =
            (0..self.surface.len()).map(|leaf| lamps.map(|lamp| lamp[leaf].abs() * up)).collect();
        let once = least(&times(&light, &most), &most);
        for (light, more) in light.iter_mut().zip(&once.irradiance) {
            *light = core::array::from_fn(|i| (light[i] + more[i]) * up);
        }
        let norm = least(&times(&light, &deviation), &high);
        let radius = least(&times(&norm.irradiance, &deviation), &most);
        let mut rows: Vec<Vec<Row>> = (0..W).map(|_| Vec::with_capacity(self.surface.len())).collect();
        let leaves = light.iter().zip(&norm.values).zip(&radius.values).zip(&self.surface);
        for (((light, norm), radius), kind) in leaves {
            for (cell, (rows, part)) in rows.iter_mut().zip(&parts[*kind]).enumerate() {
                let value = part.mean.map(|mean| mean * light[cell]);
                rows.push(Row { value, norm: norm[cell], radius: radius[cell] });
            }
        }
        (rows, passes)
    }

    /// An irradiance with what rounding of it may have done.
    fn rounded(&self, row: &Row) -> Row {
        let most = row.value.iter().fold(0.0, |m: f64, v| m.max(v.abs()));
        let up = 1.0 + 2.0 * self.rounding;
        Row { value: row.value, norm: row.norm * up, radius: row.radius * up + self.rounding / LEAST_SHARE * most }
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
            work.buffers.lend(|buffer| self.transport.apply(&rows, &mut irradiance, width, buffer));
            (work.report)(width, None);
            for (leaf, surface) in self.surface.iter().enumerate() {
                for (cell, part) in parts[*surface].iter().enumerate() {
                    let place = leaf * width + 5 * cell;
                    let from = row(&irradiance, place).numbers();
                    let light = light(leaf, cell).numbers();
                    let arriving = Row::new(core::array::from_fn(|i| from[i] + light[i]));
                    let arriving = if mode == Mode::Certified { self.rounded(&arriving) } else { arriving };
                    rows[place..][..5].copy_from_slice(&Cell::reflected(mode, part, &arriving).numbers());
                }
            }
        }
        let of = |cell: usize| (0..self.surface.len()).map(move |leaf| leaf * width + 5 * cell);
        (0..cells.len()).map(|cell| of(cell).map(|place| row(&rows, place)).collect()).collect()
    }
}

impl Block<'_> {
    /// Puts the values of one cell into its rows.
    fn put(&self, cell: usize, rows: &mut [Row]) {
        for (index, (_, channel)) in self.columns.iter().enumerate().filter(|(_, column)| column.0 == cell) {
            for (row, values) in rows.iter_mut().zip(self.solved.reflected.chunks(self.columns.len())) {
                *row.value.get_mut(*channel).unwrap_or(&mut row.norm) = values[index];
            }
        }
    }
}

/// What is known of a cell's bounds once its values are.
#[derive(Clone, Debug, Default)]
struct Left {
    /// The light on each leaf that norms were found for; infinite where nothing depends on it.
    estimate: Vec<f64>,
    /// The greatest share that the values' light has of that.
    share: f64,
    /// What iteration and rounding leave of values as a residual.
    residual: f64,
}

impl Left {
    fn note(&mut self, share: f64, residual: f64) {
        self.share = self.share.max(share);
        self.residual = self.residual.max(residual);
    }

    /// Norms are linear in the light, and radii in the norms: less of it is known to be needed. Both then cover what is left of values.
    fn cover(&self, rows: &mut [Row], field: &Field<'_>) {
        let Field { amplification, amplified, .. } = field;
        let unsure =
            amplified.iter().zip(&self.estimate).fold(0.0, |m: f64, (a, light)| m.max(a * self.residual / light));
        let share = self.share * (1.0 + ROUNDING + 2.0 * field.rounding) + unsure;
        let share = if share <= 1.0 && !self.estimate.is_empty() { share } else { 1.0 };
        // What is left is in all channels alike, whatever their shares.
        let left = self.residual / LEAST_SHARE;
        for (row, amplification) in rows.iter_mut().zip(amplification) {
            row.norm = share * row.norm + amplification * left;
            row.radius = share * row.radius + amplification * left;
        }
    }
}

/// The light that a row's estimated values are of; infinite where the reflectance doesn't deviate from its mean, and 0 where it isn't known.
fn estimate(part: &Part, row: &Row) -> f64 {
    let channel = (0..3).fold(0, |most, channel| if part.mean[channel] > part.mean[most] { channel } else { most });
    match part.mean[channel] {
        _ if !(part.deviation > 0.0) => f64::INFINITY,
        mean if mean > 0.0 => row.value[channel] / mean,
        _ => 0.0,
    }
}

/// A mean of a part: of a channel, or of all.
fn mean(part: &Part, channel: usize) -> f64 {
    part.mean.get(channel).copied().unwrap_or(part.common)
}

/// The columns of some cells, in the order of solution: those of a later stage are near to combinations of those of the first, which fill their
/// blocks where they can.
fn stages(cells: &[Cell], channels: &[usize]) -> Vec<Vec<Column>> {
    let columns = (0..cells.len()).flat_map(|cell| channels.iter().map(move |channel| (cell, *channel)));
    if cells.len() < MANY {
        return vec![columns.collect()];
    }
    let full = if cells.len() < LANES { cells.len() } else { cells.len() / LANES * LANES };
    let (first, others) = columns.partition(|(cell, channel)| *channel == FIRST && *cell < full);
    vec![first, others]
}
