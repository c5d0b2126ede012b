//! Splitting the spectrum until the colour of every patch is known well enough.
//!
//! Where to split is decided in a model of the scene in which all patches of one reflectance have one radiosity: that costs next to
//! nothing. The bounds are those of all patches; where they are above the threshold, what contributes most there is split.

use alloc::sync::Arc;

use rayon::prelude::*;
use spectral_core::adaptive::Mode;
use spectral_core::bound::{ColourBound, delta_e_bound};
use spectral_core::colour::rgb;
use spectral_core::interval::Node;

use super::cell::{Cell, DEPTH, Row, Spectra, Weights};
use super::field::{Field, Lit, Values, Work};
use super::intervals::IntervalRows;
use super::representation::Representation;
use super::solution::Lights;
use super::system::Judged;
use super::transport::{Buffer, Transport};
use super::{Radiosity, RadiosityError, Report, Solution};
use crate::spectral::{Factor, IntervalSettings, Palette};

/// The most cells.
const MOST_CELLS: usize = 512;
/// The most reflectances that the model keeps apart.
const MOST_GROUPS: usize = 64;
/// The most faces that the model keeps apart.
const MOST_FACES: usize = 32;
/// What the model aims at, as a share of the threshold: its patches are means over faces.
const MARGIN: f64 = 0.6;
/// What splitting by patches aims at.
const AIM: f64 = 0.98;
/// How often cells may be split because of what patches need.
const ROUNDS: usize = 12;
/// The error of the model's iteration.
const ROUGH: f64 = 1e-4;

/// A cell with the radiosity of all leaves of a field.
#[derive(Clone, Debug)]
struct Known {
    cell: Cell,
    rows: Vec<Row>,
}

impl Known {
    fn is(&self, place: (usize, Node)) -> bool {
        (self.cell.lamp, self.cell.node) == place
    }
}

/// The colour of what a leaf reflects.
fn bound(mode: Mode, cells: &[Known], leaf: usize) -> ColourBound<f64> {
    let (mut xyz, mut radius) = ([0.0; 3], [0.0; 3]);
    for known in cells {
        let (value, around) = seen(mode, known, leaf);
        xyz = core::array::from_fn(|a| xyz[a] + value[a]);
        radius = core::array::from_fn(|a| radius[a] + around[a]);
    }
    delta_e_bound(xyz, radius, rgb::WHITE)
}

fn seen(mode: Mode, known: &Known, leaf: usize) -> ([f64; 3], [f64; 3]) {
    known.cell.colour(mode, &known.rows[leaf].times(core::f64::consts::FRAC_1_PI))
}

/// A subdivision that is refined in a model of the scene.
struct Plan<'f> {
    field: Field<'f>,
    mode: Mode,
    cells: Vec<Known>,
}

impl Plan<'_> {
    /// The greatest bound of any group of patches.
    fn worst(&self) -> f64 {
        let leaves = 0..self.field.surface.len();
        leaves.map(|leaf| bound(self.mode, &self.cells, leaf).delta_e).fold(0.0, f64::max)
    }

    /// Splits what contributes most to the worst colour until that is good enough.
    fn refine(&mut self, target: f64, spectra: &Spectra<'_>, lamps: &[Option<u32>]) {
        while self.cells.len() < MOST_CELLS {
            let leaves = 0..self.field.surface.len();
            let bounds = leaves.map(|leaf| (bound(self.mode, &self.cells, leaf), leaf));
            let worst = bounds.max_by(|(a, _), (b, _)| a.delta_e.total_cmp(&b.delta_e));
            let Some((worst, leaf)) = worst.filter(|(worst, _)| !(worst.delta_e <= target)) else { return };
            let score = |known: &Known| {
                let (_, radius) = seen(self.mode, known, leaf);
                let score = radius.iter().zip(worst.gradient).map(|(r, g)| r * g).sum::<f64>();
                if score.is_finite() { score } else { f64::INFINITY }
            };
            let open = self.cells.iter().enumerate().filter(|(_, known)| known.cell.node.level() < DEPTH);
            let Some((place, _)) = open.max_by(|(_, a), (_, b)| score(a).total_cmp(&score(b))) else { return };
            let split = self.cells.swap_remove(place).cell;
            self.add(split.lamp, split.node.children().into_iter().flatten(), spectra, lamps);
        }
    }

    /// Splits these cells.
    fn split(&mut self, places: Vec<(usize, Node)>, spectra: &Spectra<'_>, lamps: &[Option<u32>]) {
        self.cells.retain(|known| !places.iter().any(|place| known.is(*place)));
        for (lamp, node) in places {
            self.add(lamp, node.children().into_iter().flatten(), spectra, lamps);
        }
    }

    fn add(
        &mut self,
        lamp: usize,
        nodes: impl IntoIterator<Item = Node>,
        spectra: &Spectra<'_>,
        lamps: &[Option<u32>],
    ) {
        let cells: Vec<Cell> =
            nodes.into_iter().filter_map(|node| spectra.cell(lamp, *lamps.get(lamp)?, node)).collect();
        let mut work = Work { tolerance: ROUGH, buffer: Buffer::default(), report: &mut |_, _| {} };
        // What errors are estimated by is needed here, whatever the rows keep.
        let mode = if self.mode == Mode::Corrected { Mode::Paper } else { self.mode };
        let rows = self.field.solve(mode, &cells, &mut work);
        self.cells.extend(cells.into_iter().zip(rows).map(|(cell, rows)| Known { cell, rows }));
    }
}

/// The cells to split so that all patches' bounds come near to the threshold, if a half's radius is an eighth: mass is proportional to width,
/// and a covariance to its square.
fn split_by_patches(mode: Mode, cells: &[Known], threshold: f64) -> Vec<(usize, Node)> {
    const LEFT: f64 = 0.25;
    let leaves = cells.first().map_or(0, |known| known.rows.len());
    let sums = (0..leaves).into_par_iter().map(|leaf| {
        let parts = cells.iter().map(|known| seen(mode, known, leaf));
        parts.fold([[0.0; 3]; 2], |[xyz, radius], (value, around)| {
            [core::array::from_fn(|a| xyz[a] + value[a]), core::array::from_fn(|a| radius[a] + around[a])]
        })
    });
    let mut sums: Vec<[[f64; 3]; 2]> = sums.collect();
    let mut chosen: Vec<usize> = Vec::new();
    loop {
        let bounds = sums.par_iter().enumerate().map(|(leaf, [xyz, radius])| {
            let ColourBound { delta_e, gradient } = delta_e_bound(*xyz, *radius, rgb::WHITE);
            (delta_e, leaf, gradient)
        });
        let worst = bounds.max_by(|(a, ..), (b, ..)| a.total_cmp(b)).filter(|(worst, ..)| !(*worst <= AIM * threshold));
        let open = |index: &usize| !chosen.contains(index) && cells[*index].cell.node.level() < DEPTH;
        let Some((_, leaf, gradient)) = worst else { break };
        let score = |index: &usize| {
            let (_, radius) = seen(mode, &cells[*index], leaf);
            radius.iter().zip(gradient).map(|(r, g)| r * g).sum::<f64>()
        };
        let Some(index) = (0..cells.len()).filter(open).max_by(|a, b| score(a).total_cmp(&score(b))) else { break };
        sums.par_iter_mut().enumerate().for_each(|(leaf, [_, radius])| {
            let (_, around) = seen(mode, &cells[index], leaf);
            radius.iter_mut().zip(around).for_each(|(r, part)| *r -= (1.0 - LEFT) * part);
        });
        chosen.push(index);
    }
    chosen.into_iter().map(|index| (cells[index].cell.lamp, cells[index].cell.node)).collect()
}

impl Radiosity {
    /// The radiosity of all patches, by parts of the spectrum that are split until the bound of ΔE*ab of what each patch reflects is
    /// at or under the threshold, or no smaller part would help: [`Report::delta_e_bound`] says what was reached.
    ///
    /// Each light spectrum of the scene has a subdivision of its own and is integrated exactly with the colour-matching functions, so that
    /// lines need no fine parts. In the certified mode the bound covers all that the representation leaves out, iteration and rounding: with respect
    /// to the exact solution of the discrete system at every wavelength. It is infinite where no amplification of residuals is known. In the
    /// paper's mode it is an estimate: the sum of all |e| of Iehl and Péroche, where e is the difference between the solutions for the
    /// channel's mean reflectances and for the common ones. The corrected mode leaves the latter out, and estimates for the faces of the scene as a
    /// whole instead of for every patch.
    ///
    /// # Errors
    /// [`RadiosityError::NoSolution`] where the surfaces around a closed space reflect all light of some wavelength, and
    /// [`RadiosityError::Spectrum`] for spectra that can't be integrated.
    pub fn solve_intervals(
        &self,
        palette: &Palette,
        settings: &IntervalSettings,
    ) -> Result<Solution<'_>, RadiosityError> {
        let mut weights = Weights::new();
        let spectra = Spectra::new(palette, &mut weights).map_err(RadiosityError::Spectrum)?;
        let mode = settings.mode;
        let mut buffer = Buffer::default();
        let lamps = self.lamps();
        let field = self.field(&lamps, &spectra, &mut buffer)?;
        let (model, groups) = self.model(&field, &mut buffer);
        // Without an amplification there is no bound to go by.
        let bounded = field.amplification.iter().all(|a| a.is_finite());
        let planned = if bounded { mode } else { Mode::Corrected };
        let mut plan = Plan {
            field: model_field(&field, &model, &groups, &spectra, &mut buffer),
            mode: planned,
            cells: Vec::new(),
        };
        for lamp in 0..lamps.len() {
            plan.add(lamp, [Node::ROOT], &spectra, &lamps);
        }
        let mut report = self.report();
        let mut cells: Vec<Known> = Vec::new();
        let target = if planned == Mode::Corrected { 1.0 } else { MARGIN } * settings.threshold;
        plan.refine(target, &spectra, &lamps);
        for round in 0..ROUNDS {
            cells.retain(|known| plan.cells.iter().any(|planned| planned.is((known.cell.lamp, known.cell.node))));
            let is_new = |planned: &&Known| !cells.iter().any(|known| known.is((planned.cell.lamp, planned.cell.node)));
            let new: Vec<Cell> = plan.cells.iter().filter(is_new).map(|planned| planned.cell.clone()).collect();
            if new.is_empty() && round > 0 {
                break;
            }
            cells.extend(self.solve_cells(&field, mode, new, &mut buffer, &mut report));
            if mode == Mode::Corrected {
                report.delta_e_bound = plan.worst();
                break;
            }
            self.note(mode, &cells, &mut report);
            if report.delta_e_bound <= settings.threshold || !bounded {
                break;
            }
            plan.split(split_by_patches(mode, &cells, settings.threshold), &spectra, &lamps);
        }
        Ok(self.assembled(mode, lamps, cells, report))
    }

    /// Solves for some cells, and notes residuals and balance.
    fn solve_cells(
        &self,
        field: &Field<'_>,
        mode: Mode,
        cells: Vec<Cell>,
        buffer: &mut Buffer,
        report: &mut Report,
    ) -> impl Iterator<Item = Known> + use<> {
        let mut told = |passes: usize, values: Option<(&[Cell], &Values<'_>)>| {
            report.passes += passes;
            if let Some((cells, values)) = values {
                let emitted = field.of_lamps(mode, cells, |lamp| &lamp.emitted);
                let Values { system, solved, irradiance } = values;
                self.judge(&Judged::new(system, &emitted, solved, irradiance), report);
            }
        };
        let tolerance = self.settings.residual;
        let mut work = Work { tolerance, buffer: core::mem::take(buffer), report: &mut told };
        let rows = field.solve(mode, &cells, &mut work);
        *buffer = work.buffer;
        cells.into_iter().zip(rows).map(|(cell, rows)| Known { cell, rows })
    }

    /// The leaves of the palette that lights have.
    fn lamps(&self) -> Vec<Option<u32>> {
        let of_sides = self.patches.sides.iter().filter_map(|side| side.emission);
        let mut lamps = Vec::new();
        for factor in of_sides.chain(self.sources.iter().map(|source| source.spectrum)) {
            if !lamps.contains(&factor.leaf) {
                lamps.push(factor.leaf);
            }
        }
        lamps
    }

    /// What all leaves receive from each lamp.
    fn field(
        &self,
        lamps: &[Option<u32>],
        spectra: &Spectra<'_>,
        buffer: &mut Buffer,
    ) -> Result<Field<'_>, RadiosityError> {
        let sides = &self.patches.sides;
        let reflectances: Vec<Factor> = sides.iter().map(|side| side.reflectance).collect();
        if self.settings.bounces.is_none() && self.balance.closed >= 1.0 && spectra.reflects_all(&reflectances) {
            return Err(RadiosityError::NoSolution);
        }
        let surface =
            self.transport.leaves.iter().map(|leaf| self.patches.nodes[*leaf as usize].side as usize).collect();
        let mut field = Field {
            transport: &self.transport,
            surface,
            lamps: Vec::new(),
            largest_sum: self.balance.largest,
            amplification: Vec::new(),
            bounces: self.settings.bounces,
            reflectances,
        };
        for lamp in lamps {
            let number = |factor: Factor| if factor.leaf == *lamp { factor.scale } else { 0.0 };
            let lights = Lights {
                emission: sides.iter().map(|s| core::f64::consts::PI * s.emission.map_or(0.0, number)).collect(),
                sources: self.sources.iter().map(|source| number(source.spectrum)).collect(),
            };
            let emitted: Vec<f64> = field.surface.iter().map(|side| lights.emission[*side]).collect();
            let mut all = vec![0.0; emitted.len()];
            self.transport.apply(&emitted, &mut all, 1, buffer);
            let direct = self.direct(&lights.sources, 1, 0, 1);
            all.iter_mut().zip(&direct).for_each(|(h, d)| *h += d);
            field.lamps.push(Lit { emitted, direct, all });
        }
        let greatest: Vec<f64> = field.reflectances.iter().map(|factor| spectra.greatest(*factor)).collect();
        field.amplify(&greatest, buffer);
        Ok(field)
    }

    /// The transport between groups of leaves of one reflectance, and the group of each leaf: by faces where these are few.
    fn model(&self, field: &Field<'_>, buffer: &mut Buffer) -> (Transport, Vec<usize>) {
        let groups = if self.patches.roots <= MOST_FACES { self.faces() } else { self.kinds(field) };
        let count = groups.iter().max().map_or(0, |most| most + 1);
        (self.transport.condensed(&groups, count, buffer), groups)
    }

    /// The face of each leaf.
    fn faces(&self) -> Vec<usize> {
        let mut faces: Vec<usize> = (0..self.patches.nodes.len()).collect();
        for (index, node) in self.patches.nodes.iter().enumerate() {
            node.children().into_iter().flatten().for_each(|child| faces[child] = faces[index]);
        }
        self.transport.leaves.iter().map(|leaf| faces[*leaf as usize]).collect()
    }

    /// The reflectance of each leaf, by number; those beyond some share these numbers.
    fn kinds(&self, field: &Field<'_>) -> Vec<usize> {
        let mut known: Vec<(Factor, bool)> = Vec::new();
        let group = |side: &usize| {
            let kind = (field.reflectances[*side], self.patches.sides[*side].emission.is_some());
            let place = known.iter().position(|k| *k == kind).unwrap_or_else(|| {
                known.push(kind);
                known.len() - 1
            });
            place % MOST_GROUPS
        };
        field.surface.iter().map(group).collect()
    }

    /// Notes the bounds of all patches.
    fn note(&self, mode: Mode, cells: &[Known], report: &mut Report) {
        let leaves = (0..self.transport.leaves.len()).into_par_iter();
        let bounds: Vec<f64> = leaves.map(|leaf| bound(mode, cells, leaf).delta_e).collect();
        report.delta_e_bound = bounds.iter().fold(0.0, |m, b| m.max(*b));
        let area: f64 = self.transport.areas.iter().sum();
        report.mean_delta_e_bound = bounds.iter().zip(&self.transport.areas).map(|(b, a)| b * a / area).sum();
    }

    /// The solution of all cells, in order of wavelength.
    fn assembled(
        &self,
        mode: Mode,
        lamps: Vec<Option<u32>>,
        mut cells: Vec<Known>,
        mut report: Report,
    ) -> Solution<'_> {
        let key = |known: &Known| (known.cell.lamp, known.cell.node.limits::<f64>()[0]);
        cells.sort_by(|a, b| key(a).partial_cmp(&key(b)).unwrap_or(core::cmp::Ordering::Equal));
        let rows = IntervalRows { mode, lamps, cells: cells.iter().map(|known| known.cell.clone()).collect() };
        let width = rows.width();
        let mut reflected = vec![0.0; self.transport.leaves.len() * width];
        for (index, known) in cells.into_iter().enumerate() {
            for (row, numbers) in reflected.chunks_mut(width).zip(known.rows) {
                rows.put(row, index, &numbers);
            }
        }
        report.intervals = rows.cells.len();
        Solution::new(self, Arc::new(rows), &reflected, report)
    }
}

/// The model of a field: means over groups of leaves.
fn model_field<'m>(
    field: &Field<'_>,
    model: &'m Transport,
    groups: &[usize],
    spectra: &Spectra<'_>,
    buffer: &mut Buffer,
) -> Field<'m> {
    let count = model.areas.len();
    let mean = |values: &[f64]| {
        let mut means = vec![0.0; count];
        for ((value, group), area) in values.iter().zip(groups).zip(&field.transport.areas) {
            means[*group] += value * area / model.areas[*group];
        }
        means
    };
    let of_lamp = |lit: &Lit| Lit { emitted: mean(&lit.emitted), direct: mean(&lit.direct), all: mean(&lit.all) };
    let mut reflectances = vec![Factor { scale: 0.0, leaf: None }; count];
    for (group, side) in groups.iter().zip(&field.surface) {
        reflectances[*group] = field.reflectances[*side];
    }
    let greatest: Vec<f64> = reflectances.iter().map(|factor| spectra.greatest(*factor)).collect();
    let mut result = Field {
        transport: model,
        surface: (0..count).collect(),
        reflectances,
        lamps: field.lamps.iter().map(of_lamp).collect(),
        largest_sum: field.largest_sum,
        amplification: Vec::new(),
        bounces: field.bounces,
    };
    result.amplify(&greatest, buffer);
    result
}
