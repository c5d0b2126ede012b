//! Splitting the spectrum until the colour of every patch is known well enough.
//!
//! Where to split is decided in a model of the scene in which all patches of one reflectance have one radiosity: that costs next to
//! nothing, but its bounds are not those of the patches. So it only plans a coarse start; from there on, what contributes most to the bounds of
//! patches is split, a share of all cells at a time, until these bounds are at or under the threshold.

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
/// What splitting by patches aims at.
const AIM: f64 = 0.98;
/// The error of the model's iteration. What that leaves in a bound must be far below any threshold, or no split would help.
const ROUGH: f64 = 1e-9;
/// The model isn't followed where twice as many cells leave more of its bound than this.
const STUCK: f64 = 0.75;

/// How a subdivision is found.
#[derive(Clone, Copy, Debug)]
struct Pace {
    /// What the model plans the start for, as a multiple of the threshold.
    start: f64,
    /// The most cells split at a time because of what patches need, as a share of all; at least one is.
    share: f64,
}

/// Four fifths of the cells or so are planned, as bounds fall with the square of their number: the model may say too much by half.
const PACE: Pace = Pace { start: 1.5, share: 0.4 };

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

    /// Splits what contributes most to the worst colour until that is good enough, or splitting no longer helps.
    fn refine(&mut self, target: f64, spectra: &Spectra<'_>, lamps: &[Option<u32>]) {
        let mut before = (self.cells.len(), f64::INFINITY);
        while self.cells.len() < MOST_CELLS {
            let leaves = 0..self.field.surface.len();
            let bounds = leaves.map(|leaf| (bound(self.mode, &self.cells, leaf), leaf));
            let worst = bounds.max_by(|(a, _), (b, _)| a.delta_e.total_cmp(&b.delta_e));
            let Some((worst, leaf)) = worst.filter(|(worst, _)| !(worst.delta_e <= target)) else { return };
            // By the corrected mode the model's estimate is what counts.
            if self.mode != Mode::Corrected && self.cells.len() >= 2 * before.0 {
                if worst.delta_e > STUCK * before.1 {
                    return;
                }
                before = (self.cells.len(), worst.delta_e);
            }
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
/// and a covariance to its square. No more than `most`, those first that the worst patches need most.
fn split_by_patches(mode: Mode, cells: &[Known], threshold: f64, most: usize) -> Vec<(usize, Node)> {
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
    while chosen.len() < most {
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
        self.adapted(palette, settings, PACE)
    }

    fn adapted(
        &self,
        palette: &Palette,
        settings: &IntervalSettings,
        pace: Pace,
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
        let start = if planned == Mode::Corrected { 1.0 } else { pace.start };
        plan.refine(start * settings.threshold, &spectra, &lamps);
        loop {
            cells.retain(|known| plan.cells.iter().any(|planned| planned.is((known.cell.lamp, known.cell.node))));
            let is_new = |planned: &&Known| !cells.iter().any(|known| known.is((planned.cell.lamp, planned.cell.node)));
            let new: Vec<Cell> = plan.cells.iter().filter(is_new).map(|planned| planned.cell.clone()).collect();
            cells.extend(self.solve_cells(&field, mode, new, &mut buffer, &mut report));
            if mode == Mode::Corrected {
                report.delta_e_bound = plan.worst();
                break;
            }
            self.note(mode, &cells, &mut report);
            if report.delta_e_bound <= settings.threshold || !bounded {
                break;
            }
            #[allow(
                clippy::cast_precision_loss,
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "cells are few"
            )]
            let share = ((cells.len() as f64 * pace.share) as usize).max(1);
            let most = share.min(MOST_CELLS.saturating_sub(cells.len()));
            let split = split_by_patches(mode, &cells, settings.threshold, most);
            if split.is_empty() {
                break;
            }
            plan.split(split, &spectra, &lamps);
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

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "tests fail by panicking")]
#[allow(clippy::print_stdout, reason = "the figures behind the verdict are shown with --nocapture")]
mod tests {
    use core::fmt::Write;

    use spectral_core::adaptive::Mode;
    use spectral_core::tables::{UniformTable, colorchecker, fluorescent, illuminants};

    use super::{PACE, Pace};
    use crate::radiosity::{Radiosity, Report, Settings};
    use crate::scene::{Scene, Source, builtin, load};
    use crate::spectral::{IntervalSettings, Palette};

    /// From nothing, whatever the worst patch needs most, one at a time.
    const GREEDY: Pace = Pace { start: f64::INFINITY, share: 0.0 };

    fn listed(table: &UniformTable, scale: f64) -> String {
        let mut list = String::new();
        for (index, value) in (0_u32..).zip(table.samples.double) {
            let comma = if index > 0 { ", " } else { "" };
            write!(list, "{comma}{}:{}", u32::from(table.first) + u32::from(table.step) * index, value * scale)
                .unwrap();
        }
        list
    }

    /// A closed cube of 2 m with four paints on its six faces, with a point light off its middle.
    fn cube(paints: [usize; 4], lamp: &str) -> Scene {
        let turns = [("x", 0), ("x", 180), ("x", 90), ("x", -90), ("y", 90), ("y", -90)];
        let mut xml =
            String::from("<scene version='3.0.0'><sensor type='perspective'><float name='fov' value='40'/></sensor>");
        for ((axis, angle), paint) in turns.iter().zip(paints.iter().cycle()) {
            write!(
                xml,
                "<shape type='rectangle'><transform name='to_world'><translate z='-1'/><rotate {axis}='1' angle='{angle}'/>
                </transform><bsdf type='diffuse'><spectrum name='reflectance' value='{}'/></bsdf></shape>",
                listed(&colorchecker::ALL[*paint], 1.0)
            )
            .unwrap();
        }
        write!(
            xml,
            "<emitter type='point'><point name='position' x='0.2' y='0.1' z='0.3'/>
            <spectrum name='intensity' value='{lamp}'/></emitter></scene>"
        )
        .unwrap();
        load(&Source::text("test.xml", xml), &[]).unwrap()
    }

    /// Planning by a model and splitting many at a time costs no more than half as many intervals again.
    #[test]
    fn intervals_are_nearly_as_few_as_by_greedy_splitting() {
        let daylight = |paints| cube(paints, &listed(&illuminants::D65, 0.04));
        let tube = |paints| cube(paints, &listed(&fluorescent::FL11, 0.3));
        let builtin = |name| builtin::load(name, &[]).unwrap();
        let cases = [
            ("cornell-box", builtin("cornell-box")),
            ("cornell-box-lamp", builtin("cornell-box-lamp")),
            ("18 20 12 23", daylight([18, 20, 12, 23])),
            ("20 15 17 17", daylight([20, 15, 17, 17])),
            ("14 19 17 15", daylight([14, 19, 17, 15])),
            ("0 22 4 2", tube([0, 22, 4, 2])),
            ("16 17 14 18", tube([16, 17, 14, 18])),
            ("9 14 5 5", tube([9, 14, 5, 5])),
        ];
        for (name, scene) in cases {
            let mut palette = Palette::default();
            let settings = Settings { accuracy: 3e-2, ..Settings::default() };
            let radiosity = Radiosity::new(&scene, &settings, &mut palette, &|_| {}).unwrap();
            for threshold in [0.3, 0.5, 1.0, 5.0] {
                let settings = IntervalSettings { mode: Mode::Certified, threshold };
                let reports =
                    [PACE, GREEDY].map(|pace| *radiosity.adapted(&palette, &settings, pace).unwrap().report());
                let [found, greedy] = &reports;
                let told = |report: &Report| (report.intervals, report.delta_e_bound, report.passes);
                println!("{name}, {threshold}: {:?}, greedily {:?}", told(found), told(greedy));
                assert!(
                    reports.iter().all(|report| report.delta_e_bound <= threshold),
                    "{name}, {threshold}: {reports:?}"
                );
                assert!(2 * found.intervals <= 3 * greedy.intervals, "{name}, {threshold}: {reports:?}");
            }
        }
    }
}
