//! Solutions on parts of the spectrum, with bounds.
//!
//! On a cell with measure dν, and with mean reflectances μ, the mean radiosity X̄ solves (I − μK) X̄ = μ h, where h is the irradiance of
//! what the lamp sends out. The true mean is within r of it, and ‖X − X̄‖ ≤ n in the norm of ν, where
//!
//! - (I − sup ρ K) n = ‖δ‖ (h + K X̄), because X − X̄ = (I − ρK)⁻¹ δ (h + K X̄) with δ = ρ − μ, and (I − ρK)⁻¹ grows with ρ;
//! - (I − μK) r = ‖δ‖ K n, because ∫X dν − X̄ = (I − μK)⁻¹ ∫δ K(X − X̄) dν.
//!
//! Two [bounds](Above) of solutions hold for all three channels, with the greatest ‖δ‖, X̄ and μ of any; they need no more than a bound of X̄,
//! so that values are solved for last, on those cells alone that are good enough. What iteration and rounding leave of values is at most the
//! largest residual times A, for any A with A − sup ρ K A ≥ 1.

use rayon::prelude::*;
use spectral_core::adaptive::Mode;

use super::cell::{Cell, LEAST_SHARE, Part, Row};
use super::coarse::Coarse;
use super::majorant::{Above, ROUNDING};
use super::solve::{Solved, System};
use super::transport::{Buffer, Transport};
use crate::spectral::Factor;

/// Columns of values that are solved for together, and cells whose bounds are.
const COLUMNS: usize = 48;
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
    /// For each reflectance, the area of its leaves.
    pub(super) shares: Vec<f64>,
    /// Groups of leaves, and the index of the reflectance of each.
    pub(super) coarse: Coarse,
    pub(super) of_groups: Vec<usize>,
    /// For each leaf, at most how much the error of a solution is for a residual of 1, and K times that. Infinite where there is no bound.
    pub(super) amplification: Vec<f64>,
    pub(super) amplified: Vec<f64>,
    pub(super) bounces: Option<u32>,
}

/// Told how often a number was carried through the operator, and of the values of each block of cells.
pub(super) type Told<'w> = dyn FnMut(usize, Option<(&[Cell], &[Column], &Values<'_>)>) + 'w;

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
}

impl<'t> Field<'t> {
    /// Finds the amplification for reflectances of at most `greatest`.
    pub(super) fn amplify(&mut self, greatest: &[f64], buffer: &mut Buffer) {
        let rows = |surface: &[usize]| surface.iter().map(|s| [greatest[*s]]).collect::<Vec<_>>();
        let above = Above { amplification: &[], amplified: &[], ..self.above() };
        let ones = vec![[1.0]; self.surface.len()];
        let found = above.solve(&ones, &rows(&self.surface), &rows(&self.of_groups), buffer);
        self.amplification = found.values.into_flattened();
        self.amplified = found.irradiance.into_flattened();
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
        }
    }

    /// Reflected radiosity on some cells: for each of them, the rows of all leaves.
    pub(super) fn solve(&self, mode: Mode, cells: &[Cell], work: &mut Work<'_>) -> Vec<Vec<Row>> {
        let mut rows = match (self.bounces, mode) {
            (Some(count), _) => {
                return in_blocks(cells, LANES).flat_map(|block| self.reflect(mode, block, count, work)).collect();
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
        let mut blocks: Vec<&[Cell]> = in_blocks(cells, most).collect();
        let found: Vec<(Vec<Vec<Row>>, usize)> = if let [block] = blocks[..] {
            vec![self.bounds(block, &mut work.buffer)]
        } else {
            blocks.par_drain(..).map(|block| self.bounds(block, &mut Buffer::default())).collect()
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

    /// A number of the lamps, for each leaf and column.
    pub(super) fn of_lamps(&self, cells: &[Cell], columns: &[Column], number: impl Fn(&Lit) -> &[f64]) -> Vec<f64> {
        let lamps: Vec<&[f64]> = columns.iter().map(|(cell, _)| number(&self.lamps[cells[*cell].lamp])).collect();
        let mut rows = Vec::with_capacity(self.surface.len() * lamps.len());
        (0..self.surface.len()).for_each(|leaf| rows.extend(lamps.iter().map(|lamp| lamp[leaf])));
        rows
    }

    /// Solves for the values of some cells, which are put into their rows; norms and radii then cover what iteration and rounding leave.
    ///
    /// One channel of all cells comes first where they are many, as the others are near to interpolations of that.
    pub(super) fn settle(&self, mode: Mode, cells: &[Cell], mut rows: Vec<&mut Vec<Row>>, work: &mut Work<'_>) {
        let parts = self.parts(cells);
        let all = 0..cells.len();
        let mut columns: Vec<Column> = all.clone().map(|cell| (cell, FIRST)).collect();
        let of_cell = |cell: usize| [X, Z, COMMON].map(|channel| (cell, channel));
        let others: Vec<Column> =
            all.flat_map(of_cell).filter(|(_, channel)| *channel != COMMON || mode == Mode::Paper).collect();
        let mut left = vec![0.0; cells.len()];
        let mut known =
            Solved { reflected: Vec::new(), irradiance: Vec::new(), steps: 0, passes: 0, residual: Vec::new() };
        if cells.len() < MANY {
            columns.extend(&others);
        }
        let stages = if cells.len() < MANY { vec![columns] } else { vec![columns, others] };
        for (stage, columns) in stages.into_iter().enumerate() {
            let mut found = Vec::new();
            for columns in in_blocks(&columns, COLUMNS) {
                let values = self.values(cells, &parts, columns, (stage > 0).then_some(&known), work);
                values.put(mode, columns, &mut rows, &mut left);
                if stage == 0 {
                    found.push(values.solved);
                }
            }
            if stage == 0 {
                known = Solved::side_by_side(found);
            }
        }
        if mode == Mode::Certified {
            for (rows, left) in rows.into_iter().zip(left) {
                // What is left is in all channels alike, whatever their shares.
                let left = left / LEAST_SHARE;
                for (row, amplification) in rows.iter_mut().zip(&self.amplification) {
                    row.norm += amplification * left;
                    row.radius += amplification * left;
                }
            }
        }
    }

    /// Solves for some columns.
    fn values<'f>(
        &'f self,
        cells: &[Cell],
        parts: &[Vec<Part>],
        columns: &[Column],
        known: Option<&Solved>,
        work: &mut Work<'_>,
    ) -> Values<'f> {
        let system = System {
            transport: self.transport,
            width: columns.len(),
            reflectance: self.reflectance(parts, columns),
            direct: self.of_lamps(cells, columns, |lamp| &lamp.direct),
            lit: self.of_lamps(cells, columns, |lamp| &lamp.all),
            largest_sum: self.largest_sum,
        };
        let start = known.map(|known| {
            let mixed: Vec<_> = columns.iter().map(|column| self.mixed(cells, parts, *column)).collect();
            [&known.reflected, &known.irradiance].map(|rows| mixed_rows(rows, cells.len(), &mixed))
        });
        let solved = system.solve_from(start.as_ref(), work.tolerance, &mut work.buffer);
        let values = Values { system, solved };
        (work.report)(values.solved.passes, Some((cells, columns, &values)));
        values
    }

    /// The shares of three cells' first channels in a column: of its own cell's, and of its neighbours' under the same lamp, so that
    /// reflectances are as near as may be.
    fn mixed(&self, cells: &[Cell], parts: &[Vec<Part>], (cell, channel): Column) -> [(usize, f64); 3] {
        let place = |cell: usize| cells[cell].node.limits::<f64>()[0];
        let others = || (0..cells.len()).filter(|other| cells[*other].lamp == cells[cell].lamp);
        let below = others().filter(|o| place(*o) < place(cell)).max_by(|a, b| place(*a).total_cmp(&place(*b)));
        let above = others().filter(|o| place(*o) > place(cell)).min_by(|a, b| place(*a).total_cmp(&place(*b)));
        let [below, above] = [below, above].map(|other| other.unwrap_or(cell));
        // The least squares of what is missing.
        let (mut matrix, mut right) = ([0.0; 3], [0.0; 2]);
        for (part, weight) in parts.iter().zip(&self.shares) {
            let own = mean(&part[cell], FIRST);
            let [b, a] = [below, above].map(|other| mean(&part[other], FIRST) - own);
            let missing = mean(&part[cell], channel) - own;
            matrix = [matrix[0] + weight * b * b, matrix[1] + weight * a * b, matrix[2] + weight * a * a];
            right = [right[0] + weight * b * missing, right[1] + weight * a * missing];
        }
        let small = 1e-9 * (matrix[0] + matrix[2]) + f64::MIN_POSITIVE;
        let [bb, ab, aa] = [matrix[0] + small, matrix[1], matrix[2] + small];
        let determinant = bb * aa - ab * ab;
        let [b, a] = [(right[0] * aa - right[1] * ab) / determinant, (right[1] * bb - right[0] * ab) / determinant];
        let [b, a] = if b.abs() <= 1.0 && a.abs() <= 1.0 { [b, a] } else { [0.0; 2] };
        [(cell, 1.0 - a - b), (below, b), (above, a)]
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
        let of = |surface: &[usize], number: &dyn Fn(&Part) -> f64| -> Vec<[f64; W]> {
            let known: Vec<[f64; W]> =
                parts.iter().map(|parts| core::array::from_fn(|cell| number(&parts[cell]))).collect();
            surface.iter().map(|surface| known[*surface]).collect()
        };
        let above = self.above();
        let mut passes = 0;
        let mut least = |source: &[[f64; W]], number: &dyn Fn(&Part) -> f64| {
            let found = above.solve(source, &of(&self.surface, number), &of(&self.of_groups, number), buffer);
            passes += found.passes;
            found
        };
        let times = |a: &[[f64; W]], b: &[[f64; W]]| -> Vec<[f64; W]> {
            a.iter().zip(b).map(|(a, b)| core::array::from_fn(|i| a[i] * b[i])).collect()
        };
        let lamps: [&[f64]; W] = core::array::from_fn(|cell| &*self.lamps[cells[cell].lamp].all);
        let mut light: Vec<[f64; W]> = (0..self.surface.len()).map(|leaf| lamps.map(|lamp| lamp[leaf].abs())).collect();
        let once = least(&times(&light, &of(&self.surface, &|part| part.most)), &|part| part.most);
        for (light, more) in light.iter_mut().zip(&once.irradiance) {
            *light = core::array::from_fn(|i| light[i] + more[i]);
        }
        let deviation = of(&self.surface, &|part| part.deviation);
        let norm = least(&times(&light, &deviation), &|part| part.high);
        let radius = least(&times(&norm.irradiance, &deviation), &|part| part.most);
        let row = |leaf: usize, cell: usize| Row {
            value: parts[self.surface[leaf]][cell].mean.map(|mean| mean * light[leaf][cell]),
            norm: norm.values[leaf][cell],
            radius: radius.values[leaf][cell],
        };
        let rows = (0..W).map(|cell| (0..self.surface.len()).map(|leaf| row(leaf, cell)).collect()).collect();
        (rows, passes)
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

impl Values<'_> {
    /// Puts the values of some columns into rows, and notes what iteration and rounding leave as a residual of each cell.
    fn put(&self, mode: Mode, columns: &[Column], rows: &mut [&mut Vec<Row>], left: &mut [f64]) {
        let Self { system, solved } = self;
        let width = system.width;
        let mut largest = vec![0.0_f64; width];
        let all = solved.reflected.chunks(width).zip(solved.irradiance.chunks(width)).zip(system.lit.chunks(width));
        for (leaf, ((values, irradiance), lit)) in all.enumerate() {
            for (value, (cell, channel)) in values.iter().zip(columns) {
                let row = &mut rows[*cell][leaf];
                *row.value.get_mut(*channel).unwrap_or(&mut row.norm) = *value;
            }
            for ((largest, k), h) in largest.iter_mut().zip(irradiance).zip(lit) {
                *largest = largest.max((k + h).abs());
            }
        }
        if mode == Mode::Certified {
            for (((cell, _), residual), largest) in columns.iter().zip(&solved.residual).zip(&largest) {
                left[*cell] = left[*cell].max(residual + ROUNDING * largest);
            }
        }
    }
}

/// A mean of a part: of a channel, or of all.
fn mean(part: &Part, channel: usize) -> f64 {
    part.mean.get(channel).copied().unwrap_or(part.common)
}

/// Sums of three columns each, with factors.
fn mixed_rows(rows: &[f64], width: usize, columns: &[[(usize, f64); 3]]) -> Vec<f64> {
    let mut mixed = vec![0.0; rows.len() / width.max(1) * columns.len()];
    mixed.par_chunks_mut(columns.len().max(1)).zip(rows.par_chunks(width.max(1))).for_each(|(to, from)| {
        for (to, column) in to.iter_mut().zip(columns) {
            *to = column.iter().map(|(cell, share)| share * from[*cell]).sum();
        }
    });
    mixed
}

/// Parts of nearly equal length, of up to `most`.
fn in_blocks<T>(all: &[T], most: usize) -> impl Iterator<Item = &[T]> {
    let count = all.len().div_ceil(most);
    let place = move |block: usize| block * all.len() / count;
    (0..count).map(move |block| &all[place(block)..place(block + 1)])
}
