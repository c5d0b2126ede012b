//! Solutions on parts of the spectrum, with bounds.
//!
//! On a [cell](Cell) with measure dν, reflectances ρ = μ + δ have means μ, slopes c and rests ε = δ − cφ; h is the irradiance of what the lamp sends
//! out, for a spectrum of 1. The radiosity is X = Z + σφ + R, where slopes σ are the same in all channels, and whatever they are:
//!
//! - values solve (I − μK) Z = μ h + cov Kσ in each channel, with the covariance of ρ and φ: what rises with reflectances is reflected more;
//! - X = ρ(h + KX) then leaves (I − ρK) R = ε H + (δφ − cov) Kσ + φ (cH + μKσ − σ), with H = h + KZ, so that ‖R‖ ≤ n where
//!   (I − sup ρ K) n = ‖ε‖ H + ‖δφ − cov‖ |Kσ| + ‖φ‖ |cH + μKσ − σ|, as (I − ρK)⁻¹ grows with ρ;
//! - the mean of the right side is 0, so that (I − μK) ∫R dν = ∫δ KR dν, and the true mean is within r of Z where (I − μK) r = ‖δ‖ K n.
//!
//! Slopes that nearly solve (I − μK) σ = cH make the last term of n small; n is then of the second order in the cell's width and r of the third.
//! Where they don't help, as in a resonance that the cell doesn't resolve, they are 0, and n is found for ‖δ‖ H.
//!
//! Two [bounds](Above) of solutions hold for all three channels, with the greatest norms and μ of any, and for a source from what light and slopes
//! are in all channels, nearly; they need no values, so that these are solved for last, on those cells alone that are good enough. As r is linear
//! in n, and n in its source, both are then [scaled](Left) by what the source should have been in the worst place.
//!
//! What is solved for is a bound whatever found it: starts, groups and cycles change how soon, not whether. What remains between the numbers and
//! the exact solution of the discrete system, with K, H₀ and ρ as they are stored, is covered in turn:
//!
//! - iteration: Z̃ with the residual q = |Z̃ − μ(h + KZ̃) − cov Kσ| in all leaves is at most q·A from Z, for any A with A − sup ρ K A ≥ 1, as
//!   Z̃ − Z = (I − μK)⁻¹ of that; q is formed anew from K Z̃ and not the one that conjugate gradients carry along;
//! - rounding of K, in H₀, K Z̃ and Kσ, and of the means μ, changes q by no more than these shares of the greatest irradiance, which are added to
//!   it; [`Above`] covers that of its own residuals;
//! - rounding of integrals, products and sums over cells: [`Cell`] adds it to deviations, norms, radii and colours.

use rayon::prelude::*;
use spectral_core::adaptive::Mode;

use super::cell::{Cell, LEAST_SHARE, Part, ROUNDING, Row};
use super::coarse::{Coarse, Factored};
use super::majorant::{Above, Kinds, Majorant};
use super::slopes::{Left, Slopes};
use super::solve::{Solved, System};
use super::start::{Basis, Leaves};
use super::system::{self, Judgement};
use super::transport::{Buffer, Buffers, Transport};
use crate::spectral::Factor;

/// Columns of values that are solved for together, and cells whose bounds are.
const LANES: usize = 8;
/// So many cells have neighbours that are near enough to interpolate between.
const MANY: usize = 6;
/// Cycles for light and for slopes.
const CYCLES: usize = 2;
/// How far off the light of channels may be where sources of norms are found: as a share of it, and of the greatest light.
const NEAR: f64 = 0.01;
const DARK: f64 = 1e-6;

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

/// Norms and radii of a cell, what its values may be, and what its norms were found for.
pub(super) type Estimate = (Vec<Row>, Slopes);

/// Some columns of values.
struct Block<'c> {
    columns: &'c [Column],
    solved: Solved,
    judgement: Judgement,
    /// For each column, the greatest share that its light has of the estimate, and what iteration and rounding leave as a residual. By the
    /// certified mode alone.
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

    /// Whether all that a lamp shines on reflects nothing on a part of the domain, so that radiosity is 0 there.
    pub(super) fn is_dark(&self, cell: &Cell) -> bool {
        let black: Vec<bool> = self.reflectances.iter().map(|factor| cell.part(*factor).high <= 0.0).collect();
        let is_dark = |lit: &Lit| self.surface.iter().zip(&lit.all).all(|(kind, h)| black[*kind] || *h == 0.0);
        self.lamps.get(cell.lamp).is_some_and(is_dark)
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
            (None, _) => vec![(vec![Row::default(); self.surface.len()], Slopes::default()); cells.len()],
        };
        self.settle(mode, cells, rows.iter_mut().map(|(rows, slopes)| (rows, &*slopes)).collect(), work);
        rows.into_iter().map(|(rows, _)| rows).collect()
    }

    /// Norms and radii on some cells by the certified mode, and values that aren't known as well.
    pub(super) fn estimate(&self, cells: &[Cell], work: &mut Work<'_>) -> Vec<Estimate> {
        if !self.is_bounded() {
            let unknown = Row { norm: f64::INFINITY, radius: f64::INFINITY, ..Row::default() };
            return vec![(vec![unknown; self.surface.len()], Slopes::default()); cells.len()];
        }
        let mut blocks: Vec<&[Cell]> = cells.chunks(even(cells.len())).collect();
        let buffers = work.buffers;
        let found: Vec<(Vec<Estimate>, usize)> = if let [block] = blocks[..] {
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

    /// What all leaves receive from the lamps, for each leaf and column, and what counts as if they did: the light of slopes times what a part's
    /// covariance has of its mean.
    fn lit(&self, cells: &[Cell], parts: &[Vec<Part>], columns: &[Column], slopes: &[&Slopes]) -> Vec<f64> {
        let lamps: Vec<&[f64]> = columns.iter().map(|(cell, _)| &*self.lamps[cells[*cell].lamp].all).collect();
        let of = |parts: &Vec<Part>| columns.iter().map(|(cell, channel)| tilt(&parts[*cell], *channel)).collect();
        let tilts: Vec<Vec<f64>> = parts.iter().map(of).collect();
        let slopes: Vec<&Slopes> = columns.iter().map(|(cell, _)| slopes[*cell]).collect();
        let mut rows = Vec::with_capacity(self.surface.len() * lamps.len());
        for (leaf, surface) in self.surface.iter().enumerate() {
            let columns = lamps.iter().zip(&tilts[*surface]).zip(&slopes);
            rows.extend(columns.map(|((lamp, tilt), slopes)| lamp[leaf] + tilt * slopes.irradiance(leaf)));
        }
        rows
    }

    /// Solves for the values of some cells, which are put into their rows; norms and radii then cover what iteration and rounding leave.
    ///
    /// One channel of all cells comes first where these are many, as the others are near to combinations of that.
    pub(super) fn settle(
        &self,
        mode: Mode,
        cells: &[Cell],
        estimates: Vec<(&mut Vec<Row>, &Slopes)>,
        work: &mut Work<'_>,
    ) {
        let (mut rows, slopes): (Vec<_>, Vec<_>) = estimates.into_iter().unzip();
        let parts = self.parts(cells);
        let channels: &[usize] = if mode == Mode::Paper { &[X, FIRST, Z, COMMON] } else { &[X, FIRST, Z] };
        // Where norms have been found, values are nearly known.
        let stages = stages(cells, channels, slopes.iter().all(|slopes| !slopes.leaves.is_empty()));
        let mut left = vec![Left::default(); cells.len()];
        let (mut known, mut blocks) = (None, Vec::new());
        for columns in &stages {
            let basis = known.as_ref().map(|known| self.basis(known));
            let (tolerance, buffers) = (work.tolerance, work.buffers);
            let solve =
                |columns| self.block((mode, cells, &parts, &slopes), columns, (basis.as_ref(), tolerance, buffers));
            let lanes = if stages.len() > 1 { LANES } else { even(columns.len()) };
            let found: Vec<Block<'_>> = columns.par_chunks(lanes).map(solve).collect();
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
                left.cover(rows, (&cells[cell], slopes[cell]), &of_cell(&parts, cell), self);
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
        (mode, cells, parts, slopes): (Mode, &[Cell], &[Vec<Part>], &[&Slopes]),
        columns: &'c [Column],
        (basis, tolerance, buffers): (Option<&Basis<'_>>, f64, &Buffers),
    ) -> Block<'c> {
        let system = System {
            transport: self.transport,
            width: columns.len(),
            reflectance: self.reflectance(parts, columns),
            lit: self.lit(cells, parts, columns, slopes),
            largest_sum: self.largest_sum,
        };
        let start = basis.map(|basis| {
            let factors = |(cell, channel): &Column| {
                let reflectance: Vec<f64> = parts.iter().map(|parts| mean(&parts[*cell], *channel)).collect();
                basis.factors(&reflectance, cells[*cell].lamp)
            };
            basis.combined(&columns.iter().map(factors).collect::<Vec<_>>())
        });
        let start = start.or_else(|| self.estimated(cells, columns, slopes));
        let solved = system.solve_from(start.as_ref(), tolerance, buffers);
        let lamps: Vec<&Lit> = columns.iter().map(|(cell, _)| &self.lamps[cells[*cell].lamp]).collect();
        let part = |leaf: usize, column: usize| {
            let place = leaf * columns.len() + column;
            // What covariances add is reflected, but doesn't arrive.
            let arriving = solved.irradiance[place] + lamps[column].all[leaf];
            let (emitted, direct) = (lamps[column].emitted[leaf], lamps[column].direct[leaf]);
            let leaving = (solved.irradiance[place] + system.lit[place]) * system.reflectance[place];
            system::Part { emitted, direct, arriving, leaving, reflected: solved.reflected[place] }
        };
        let judgement = Judgement::new((&self.transport.areas, self.sums), &solved, &system.amplification(), part);
        let is_bounded = mode == Mode::Certified;
        let left = if is_bounded { self.left(&system, &solved, columns, (cells, parts, slopes)) } else { Vec::new() };
        Block { columns, solved, judgement, left }
    }

    /// What values may be by mean radiosity and slopes, which are the same in all channels, and K times that.
    fn estimated(&self, cells: &[Cell], columns: &[Column], slopes: &[&Slopes]) -> Option<[Vec<f64>; 2]> {
        if columns.iter().any(|(cell, _)| slopes[*cell].leaves.is_empty()) {
            return None;
        }
        let known: Vec<(&[[f64; 5]], f64)> = columns
            .iter()
            .map(|(cell, channel)| {
                let offset = cells[*cell].ramp.offset.get(*channel);
                (&*slopes[*cell].leaves, offset.copied().unwrap_or(0.0))
            })
            .collect();
        let rows = |of: fn(&[f64; 5], f64) -> f64| {
            let mut rows = Vec::with_capacity(self.surface.len() * columns.len());
            (0..self.surface.len())
                .for_each(|leaf| rows.extend(known.iter().map(|(leaves, offset)| of(&leaves[leaf], *offset))));
            rows
        };
        Some([
            rows(|[slope, _, _, mean, _], offset| mean + offset * slope),
            rows(|[_, light, _, _, mean], offset| mean + offset * light),
        ])
    }

    /// For each column, the greatest share that its source of norms has of what these were found for, and what iteration and rounding leave as a
    /// residual.
    ///
    /// Rounding: of K Z, of Kσ and of H₀, which is K of something, too, and of the mean reflectances.
    fn left(
        &self,
        system: &System<'_>,
        solved: &Solved,
        columns: &[Column],
        (cells, parts, slopes): (&[Cell], &[Vec<Part>], &[&Slopes]),
    ) -> Vec<[f64; 2]> {
        let rounding = 2.0 * self.rounding + ROUNDING;
        let width = columns.len();
        let sum = self.largest_sum.max(1.0);
        let of_column = |(column, (cell, channel)): (usize, &Column)| {
            let numbers = |rows: &'_ [f64]| -> f64 {
                rows.iter().skip(column).step_by(width).fold(0.0, |m: f64, v| m.max(v.abs()))
            };
            let (most, lit_most) = (numbers(&solved.reflected), numbers(&system.lit));
            let (cell, slopes, parts) = (&cells[*cell], slopes[*cell], of_cell(parts, *cell));
            let covariance = parts.iter().flat_map(|part| part.covariance).fold(0.0, |m: f64, c| m.max(c.abs()));
            let tilted = covariance * slopes.most();
            let all = &self.lamps[cell.lamp].all;
            let irradiance = solved.irradiance.iter().skip(column).step_by(width).zip(all).map(|(k, h)| k + h);
            let share = match channel {
                0..3 => slopes.share(cell, (&parts, &self.surface), (*channel, rounding * sum), irradiance),
                _ => 0.0,
            };
            [share, solved.residual[column] + rounding * (sum * (most + tilted) + lit_most)]
        };
        columns.iter().enumerate().map(of_column).collect()
    }

    /// Norms and radii, and how often something was carried through the operator.
    fn bounds(&self, cells: &[Cell], buffer: &mut Buffer) -> (Vec<Estimate>, usize) {
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

    fn bounds_of<const W: usize>(&self, cells: &[Cell], buffer: &mut Buffer) -> (Vec<Estimate>, usize) {
        let parts = self.parts(cells);
        let of_kinds = |number: &dyn Fn(&Part) -> f64| -> Vec<[f64; W]> {
            parts.iter().map(|parts| core::array::from_fn(|cell| number(&parts[cell]))).collect()
        };
        let of_groups =
            |numbers: &[[f64; W]]| -> Vec<[f64; W]> { self.of_groups.iter().map(|kind| numbers[*kind]).collect() };
        let above = self.above();
        let times = |rows: &[[f64; W]], numbers: &[[f64; W]]| -> Vec<[f64; W]> {
            let kinds = Kinds { numbers, kind: &self.surface };
            rows.iter().zip(kinds.rows()).map(|(a, b)| core::array::from_fn(|i| a[i] * b[i])).collect()
        };
        let common = of_kinds(&|part| part.common);
        let (reflectance, groups) = (Kinds { numbers: &common, kind: &self.surface }, of_groups(&common));
        let factored = Factored::new(&self.coarse, &groups);
        let lamps: [&[f64]; W] = core::array::from_fn(|cell| &*self.lamps[cells[cell].lamp].all);
        let mut light: Vec<[f64; W]> = (0..self.surface.len()).map(|leaf| lamps.map(|lamp| lamp[leaf])).collect();
        let once = above.near(&times(&light, &common), (reflectance, &groups, &factored), CYCLES, buffer);
        for (light, more) in light.iter_mut().zip(&once.irradiance) {
            *light = core::array::from_fn(|i| (light[i] + more[i]).max(0.0));
        }
        let source = times(&light, &of_kinds(&|part| part.slope));
        let slopes = above.near(&source, (reflectance, &groups, &factored), CYCLES, buffer);
        let (found, sources) = self.sources(cells, &parts, (&light, &once), &slopes);
        let mut passes = once.passes + slopes.passes;
        let mut least = |source: &[[f64; W]], numbers: &[[f64; W]]| {
            let kinds = Kinds { numbers, kind: &self.surface };
            let found = above.solve(source, kinds, &of_groups(numbers), buffer);
            passes += found.passes;
            found
        };
        let norm = least(&sources, &of_kinds(&|part| part.high));
        let deviating = times(&norm.irradiance, &of_kinds(&|part| part.deviation));
        let radius = least(&deviating, &of_kinds(&|part| part.most));
        let estimate = |(cell, slopes): (usize, Slopes)| {
            let ramp = &cells[cell].ramp;
            let row = |(leaf, [slope, k, ..]): (usize, &[f64; 5])| {
                let (part, light) = (&parts[self.surface[leaf]][cell], light[leaf][cell]);
                let value = |a: usize| part.mean[a] * (light + ramp.offset[a] * k) + part.covariance[a] * k;
                Row {
                    value: core::array::from_fn(value),
                    slope: *slope,
                    norm: norm.values[leaf][cell],
                    radius: radius.values[leaf][cell],
                }
            };
            let rows = slopes.leaves.iter().enumerate().map(row).collect();
            (rows, slopes)
        };
        (found.into_iter().enumerate().map(estimate).collect(), passes)
    }

    /// Slopes of some cells, as far as they are of use, and sources of norms from light and slopes.
    fn sources<const W: usize>(
        &self,
        cells: &[Cell],
        parts: &[Vec<Part>],
        (light, once): (&[[f64; W]], &Majorant<W>),
        slopes: &Majorant<W>,
    ) -> (Vec<Slopes>, Vec<[f64; W]>) {
        let mut sources = vec![[0.0; W]; light.len()];
        let of_cell = |cell: usize| {
            let (ramp, parts) = (&cells[cell].ramp, of_cell(parts, cell));
            let (norm, farthest) = (ramp.most(), ramp.farthest());
            let dark = DARK * light.iter().fold(0.0, |m: f64, row| m.max(row[cell]));
            let mut leaves = Vec::with_capacity(light.len());
            let mut totals = [0.0; 2];
            for (leaf, (kind, area)) in self.surface.iter().zip(&self.transport.areas).enumerate() {
                let (part, light) = (parts[*kind], light[leaf][cell]);
                let (slope, k) = (slopes.values[leaf][cell], slopes.irradiance[leaf][cell]);
                let off = (part.slope * light + part.common * k - slope).abs() + NEAR * (part.slope * light).abs();
                let plain = part.deviation * light;
                let found = part.rest * (light + farthest * k.abs())
                    + (part.product + part.skew) * k.abs()
                    + norm * off
                    + part.deviation * dark;
                totals = [totals[0] + area * found, totals[1] + area * plain];
                leaves.push([slope, k, found, once.values[leaf][cell], once.irradiance[leaf][cell]]);
            }
            let flat = !(totals[0] < totals[1]);
            if flat {
                for (([slope, k, found, ..], kind), light) in leaves.iter_mut().zip(&self.surface).zip(light) {
                    [*slope, *k] = [0.0; 2];
                    *found = parts[*kind].deviation * (light[cell] * (1.0 + NEAR) + dark);
                }
            }
            sources.iter_mut().zip(&leaves).for_each(|(source, [_, _, found, ..])| source[cell] = *found);
            Slopes { leaves, flat }
        };
        let found = (0..W).map(of_cell).collect();
        (found, sources)
    }

    /// An irradiance with what rounding of it may have done.
    fn rounded(&self, row: &Row) -> Row {
        let most = row.value.iter().fold(0.0, |m: f64, v| m.max(v.abs()));
        let up = 1.0 + 2.0 * self.rounding;
        let size = most + row.slope.abs();
        Row {
            value: row.value,
            slope: row.slope,
            norm: row.norm * up + self.rounding * size,
            radius: row.radius * up + self.rounding / LEAST_SHARE * size,
        }
    }

    /// A limited number of reflections, one after the other.
    fn reflect(&self, mode: Mode, cells: &[Cell], count: u32, work: &mut Work<'_>) -> Vec<Vec<Row>> {
        let parts = self.parts(cells);
        let lamps: Vec<&[f64]> = cells.iter().map(|cell| &*self.lamps[cell.lamp].all).collect();
        let light = |leaf: usize, cell: usize| {
            let light = lamps[cell][leaf];
            Row { value: [light; 3], norm: if mode == Mode::Certified { 0.0 } else { light }, ..Row::default() }
        };
        let row = |rows: &[f64], place: usize| Row::new(core::array::from_fn(|i| rows[place + i]));
        let width = Row::NUMBERS * cells.len();
        let (mut rows, mut irradiance) = (vec![0.0; self.surface.len() * width], vec![0.0; self.surface.len() * width]);
        for _ in 0..count {
            work.buffers.lend(|buffer| self.transport.apply(&rows, &mut irradiance, width, buffer));
            (work.report)(width, None);
            for (leaf, surface) in self.surface.iter().enumerate() {
                for (cell, part) in parts[*surface].iter().enumerate() {
                    let place = leaf * width + Row::NUMBERS * cell;
                    let from = row(&irradiance, place).numbers();
                    let light = light(leaf, cell).numbers();
                    let arriving = Row::new(core::array::from_fn(|i| from[i] + light[i]));
                    let arriving = if mode == Mode::Certified { self.rounded(&arriving) } else { arriving };
                    rows[place..][..Row::NUMBERS]
                        .copy_from_slice(&cells[cell].reflected(mode, part, &arriving).numbers());
                }
            }
        }
        let of = |cell: usize| (0..self.surface.len()).map(move |leaf| leaf * width + Row::NUMBERS * cell);
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

/// A mean of a part: of a channel, or of all.
fn mean(part: &Part, channel: usize) -> f64 {
    part.mean.get(channel).copied().unwrap_or(part.common)
}

/// What a part's covariance in a channel has of its mean there; a part without a mean has none.
fn tilt(part: &Part, channel: usize) -> f64 {
    match (part.mean.get(channel), part.covariance.get(channel)) {
        (Some(mean), Some(covariance)) if *mean > 0.0 => covariance / mean,
        _ => 0.0,
    }
}

/// The parts of one cell.
fn of_cell(parts: &[Vec<Part>], cell: usize) -> Vec<&Part> {
    parts.iter().map(|parts| &parts[cell]).collect()
}

/// How many of some columns make blocks for an even number of tasks, none of which has much less to do than another.
fn even(count: usize) -> usize {
    count.div_ceil(2 * count.div_ceil(2 * LANES).max(1)).max(2)
}

/// The columns of some cells, in the order of solution: those of a later stage are near to combinations of those of the first, which fill their
/// blocks where they can.
fn stages(cells: &[Cell], channels: &[usize], near: bool) -> Vec<Vec<Column>> {
    let columns = (0..cells.len()).flat_map(|cell| channels.iter().map(move |channel| (cell, *channel)));
    if near || cells.len() < MANY {
        return vec![columns.collect()];
    }
    let full = if cells.len() < LANES { cells.len() } else { cells.len() / LANES * LANES };
    let (first, others) = columns.partition(|(cell, channel)| *channel == FIRST && *cell < full);
    vec![first, others]
}
