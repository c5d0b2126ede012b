//! Splitting the spectrum until the colour of every patch is known well enough.
//!
//! Where to split is decided in a model of the scene in which all patches of one face, or of one reflectance, have one radiosity: that costs
//! next to nothing, but its bounds are not those of the patches. So it only plans a start; from there on, what contributes most to the
//! bounds of patches is split, a share of all cells at a time, until these bounds are at or under the threshold. In the certified mode bounds
//! are known without the values, which are solved for last.

use alloc::collections::BTreeMap;
use alloc::sync::Arc;

use spectral_core::adaptive::Mode;
use spectral_core::interval::Node;

use super::bounds::{Bounds, Known, MOST_CELLS, bound, seen};
use super::cell::{Cell, DEPTH, Row, Spectra};
use super::coarse::Coarse;
use super::field::{Estimate, Field, Lit, Work};
use super::intervals::IntervalRows;
use super::model::model_field;
use super::representation::Representation;
use super::slopes::Slopes;
use super::solution::Lights;
use super::system::Judgement;
use super::transport::{Buffer, Buffers, Transport};
use super::{Others, Radiosity, RadiosityError, Report, Solution};
use crate::spectral::{Factor, IntervalSettings, Palette};

/// The most reflectances that the model keeps apart.
const MOST_GROUPS: usize = 64;
/// The most faces that the model keeps apart.
const MOST_FACES: usize = 32;
/// The error of the model's iteration, which is needed where elimination fails. What that leaves in a bound must be far below any threshold, or no split would help.
const ROUGH: f64 = 1e-9;
/// The model isn't followed where twice as many cells leave more of its bound than this, once there are some.
const STUCK: f64 = 0.75;
const SURE_CELLS: usize = 4;

/// What the model plans for in the paper's mode, whose estimates fall more slowly than bounds, as a multiple of the threshold.
const PAPER_START: f64 = 0.62;

/// How a subdivision is found.
#[derive(Clone, Copy, Debug)]
struct Pace {
    /// What the model plans the start for, as a multiple of the threshold.
    start: f64,
    /// The most cells split at a time because of what patches need, as a share of all; at least one is.
    share: f64,
}

/// Nearly all cells are planned: the worst patch's bound is up to twice what the model has, where it is dark in a corner.
const PACE: Pace = Pace { start: 0.5, share: 0.6 };

/// A subdivision that is refined in a model of the scene.
struct Plan<'f> {
    field: Field<'f>,
    buffers: Buffers,
    /// Of the plan, whose mode may differ from that of the solution.
    settings: IntervalSettings,
    cells: Vec<Known>,
}

impl Plan<'_> {
    /// The greatest bound of any group of patches.
    fn worst(&self) -> f64 {
        let leaves = 0..self.field.surface.len();
        leaves.map(|leaf| bound(&self.settings, &self.cells, leaf).delta_e).fold(0.0, f64::max)
    }

    /// Splits what contributes most to the worst colour until that is good enough, or splitting no longer helps.
    fn refine(&mut self, target: f64, spectra: &Spectra<'_>, lamps: &[Option<u32>]) {
        let mut before = (self.cells.len().max(SURE_CELLS), f64::INFINITY);
        while self.cells.len() < MOST_CELLS {
            let leaves = 0..self.field.surface.len();
            let bounds = leaves.map(|leaf| (bound(&self.settings, &self.cells, leaf), leaf));
            let worst = bounds.max_by(|(a, _), (b, _)| a.delta_e.total_cmp(&b.delta_e));
            let Some((worst, leaf)) = worst.filter(|(worst, _)| !(worst.delta_e <= target)) else { return };
            // By the corrected mode the model's estimate is what counts.
            if self.settings.mode != Mode::Corrected && self.cells.len() >= 2 * before.0 {
                if worst.delta_e > STUCK * before.1 {
                    return;
                }
                before = (self.cells.len(), worst.delta_e);
            }
            let score = |known: &Known| {
                let (_, radius) = seen(self.settings.mode, known, leaf);
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
        let mut work = Work { tolerance: ROUGH, buffers: &self.buffers, report: &mut |_, _| {} };
        // What errors are estimated by is needed here, whatever the rows keep.
        let own = self.settings.mode;
        let mode = if own == Mode::Corrected { Mode::Paper } else { own };
        let alone = |rows| (rows, Slopes::default());
        let rows: Vec<Estimate> = match (self.field.bounces, mode) {
            (Some(_), _) => self.field.solve(mode, &cells, &mut work).into_iter().map(alone).collect(),
            (None, Mode::Certified) => self.field.estimate(&cells, &mut work),
            (None, _) => self.field.planned(&cells, &mut work).into_iter().map(alone).collect(),
        };
        let known = |(cell, (rows, slopes))| Known { cell, rows, slopes, settled: false };
        self.cells.extend(cells.into_iter().zip(rows).map(known));
    }
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
        // On one of the threads that share the work: to hand over each of its short parts from outside takes longer than they do.
        rayon::scope(|_| self.adapted(palette, settings, PACE))
    }

    fn adapted(
        &self,
        palette: &Palette,
        settings: &IntervalSettings,
        pace: Pace,
    ) -> Result<Solution<'_>, RadiosityError> {
        let mode = settings.mode;
        let mut spectra = Spectra::new(palette, mode == Mode::Certified).map_err(RadiosityError::Spectrum)?;
        let buffers = Buffers::default();
        let lamps = self.lamps();
        spectra.tabulate(&lamps);
        let field = buffers.lend(|buffer| self.field(mode, &lamps, &spectra, buffer))?;
        // Without an amplification there is no bound to go by.
        let bounded = mode != Mode::Certified || field.is_bounded();
        let planned = if bounded { mode } else { Mode::Corrected };
        let model = Transport::between(&field.coarse);
        let mut plan = Plan {
            field: buffers.lend(|buffer| model_field(&field, planned, &model, &spectra, buffer)),
            buffers: Buffers::default(),
            settings: IntervalSettings { mode: planned, ..*settings },
            cells: Vec::new(),
        };
        for lamp in 0..lamps.len() {
            plan.add(lamp, [Node::ROOT], &spectra, &lamps);
        }
        let mut report = self.report();
        let mut cells: Vec<Known> = Vec::new();
        let start = match planned {
            Mode::Corrected => 1.0,
            Mode::Paper => PAPER_START,
            Mode::Certified => pace.start,
        };
        plan.refine(start * settings.threshold, &spectra, &lamps);
        loop {
            cells.retain(|known| plan.cells.iter().any(|planned| planned.is((known.cell.lamp, known.cell.node))));
            let is_new = |planned: &&Known| !cells.iter().any(|known| known.is((planned.cell.lamp, planned.cell.node)));
            let new: Vec<Cell> = plan.cells.iter().filter(is_new).map(|planned| planned.cell.clone()).collect();
            let estimated = mode == Mode::Certified && bounded && field.bounces.is_none();
            cells.extend(self.solve_cells(&field, (mode, estimated), new, &buffers, &mut report));
            if mode == Mode::Corrected {
                report.delta_e_bound = plan.worst();
                break;
            }
            let mut judged = Bounds::new(settings, &cells);
            let mut places = judged.places_to_split(&cells, settings.threshold, pace.share);
            let open = cells.iter().any(|known| !known.settled);
            if places.is_empty() && open {
                self.settle(&field, mode, &mut cells, &buffers, &mut report);
                judged = Bounds::new(settings, &cells);
                places = judged.places_to_split(&cells, settings.threshold, pace.share);
            }
            if places.is_empty() || !bounded {
                self.note(&judged, &mut report);
                break;
            }
            plan.split(places, &spectra, &lamps);
        }
        // Rows have nothing to say where all is dark; but by mirrors and glass light may come to where the solution has none.
        if self.settings.others == Others::Refused {
            cells.retain(|known| !field.is_dark(&known.cell));
        }
        Ok(self.assembled(mode, lamps, cells, report))
    }

    /// Solves for some cells, or for their bounds alone.
    fn solve_cells(
        &self,
        field: &Field<'_>,
        (mode, estimated): (Mode, bool),
        cells: Vec<Cell>,
        buffers: &Buffers,
        report: &mut Report,
    ) -> Vec<Known> {
        let (dark, cells): (Vec<Cell>, Vec<Cell>) = cells.into_iter().partition(|cell| field.is_dark(cell));
        let rows = self.working(buffers, report, |work| {
            if estimated {
                return field.estimate(&cells, work);
            }
            let solved = field.solve(mode, &cells, work);
            solved.into_iter().map(|rows| (rows, Slopes::default())).collect()
        });
        let settled = !estimated;
        let found = cells.into_iter().zip(rows).map(|(cell, (rows, slopes))| Known { cell, rows, slopes, settled });
        let dark = dark.into_iter().map(|cell| Known {
            cell,
            rows: vec![Row::default(); field.surface.len()],
            slopes: Slopes::default(),
            settled: true,
        });
        found.chain(dark).collect()
    }

    /// Solves for the values of cells that have estimates.
    fn settle(&self, field: &Field<'_>, mode: Mode, cells: &mut [Known], buffers: &Buffers, report: &mut Report) {
        let (mut open, mut estimates) = (Vec::new(), Vec::new());
        for known in cells.iter_mut().filter(|known| !known.settled) {
            known.settled = true;
            open.push(known.cell.clone());
            estimates.push((&mut known.rows, &known.slopes));
        }
        self.working(buffers, report, |work| field.settle(mode, &open, estimates, work));
        cells.iter_mut().for_each(|known| known.slopes = Slopes::default());
    }

    /// Does something that is told of in a report: passes, residuals and balance.
    fn working<T>(&self, buffers: &Buffers, report: &mut Report, what: impl FnOnce(&mut Work<'_>) -> T) -> T {
        let mut told = |passes: usize, judgement: Option<&Judgement>| {
            report.passes += passes;
            if let Some(judgement) = judgement {
                judgement.note(report);
            }
        };
        what(&mut Work { tolerance: self.settings.residual, buffers, report: &mut told })
    }

    /// The leaves of the palette that lights have.
    pub(super) fn lamps(&self) -> Vec<Option<u32>> {
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
    pub(super) fn field(
        &self,
        mode: Mode,
        lamps: &[Option<u32>],
        spectra: &Spectra<'_>,
        buffer: &mut Buffer,
    ) -> Result<Field<'_>, RadiosityError> {
        let sides = &self.patches.sides;
        let (reflectances, kind) = different(sides.iter().map(|side| side.reflectance));
        if self.settings.bounces.is_none() && self.balance.closed >= 1.0 && spectra.reflects_all(&reflectances) {
            return Err(RadiosityError::NoSolution);
        }
        let side_of = |leaf: &u32| self.patches.nodes[*leaf as usize].side as usize;
        let side: Vec<usize> = self.transport.leaves.iter().map(side_of).collect();
        let surface: Vec<usize> = side.iter().map(|side| kind[*side]).collect();
        let group = if self.patches.roots <= MOST_FACES { self.faces() } else { self.kinds(&side) };
        let count = group.iter().max().map_or(0, |most| most + 1);
        let mut of_groups = vec![0; count];
        group.iter().zip(&surface).for_each(|(group, surface)| of_groups[*group] = *surface);
        let mut field = Field {
            transport: &self.transport,
            surface,
            lamps: Vec::new(),
            largest_sum: self.balance.largest,
            sums: &self.sums,
            coarse: Coarse::new(&self.transport, group, count, buffer),
            of_groups,
            amplification: Vec::new(),
            amplified: Vec::new(),
            rounding: self.transport.rounding(),
            bounces: self.settings.bounces,
            reflectances,
        };
        for lamp in lamps {
            let number = |factor: Factor| if factor.leaf == *lamp { factor.scale } else { 0.0 };
            let lights = Lights {
                emission: sides.iter().map(|s| core::f64::consts::PI * s.emission.map_or(0.0, number)).collect(),
                sources: self.sources.iter().map(|source| number(source.spectrum)).collect(),
            };
            let emitted: Vec<f64> = side.iter().map(|side| lights.emission[*side]).collect();
            let mut all = vec![0.0; emitted.len()];
            if emitted.iter().any(|e| *e != 0.0) {
                self.transport.apply(&emitted, &mut all, 1, buffer);
            }
            let direct = self.direct(&lights.sources, 1, 0, 1);
            all.iter_mut().zip(&direct).for_each(|(h, d)| *h += d);
            field.lamps.push(Lit { emitted, direct, all });
        }
        if mode == Mode::Certified {
            field.coarse.spread_out(&self.transport, buffer);
            let greatest: Vec<f64> = field.reflectances.iter().map(|factor| spectra.greatest(*factor)).collect();
            field.amplify(&greatest, buffer);
        }
        Ok(field)
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
    fn kinds(&self, surface: &[usize]) -> Vec<usize> {
        let mut known: Vec<(Factor, bool)> = Vec::new();
        let group = |side: &usize| {
            let side = &self.patches.sides[*side];
            let kind = (side.reflectance, side.emission.is_some());
            let place = known.iter().position(|k| *k == kind).unwrap_or_else(|| {
                known.push(kind);
                known.len() - 1
            });
            place % MOST_GROUPS
        };
        surface.iter().map(group).collect()
    }

    /// Notes the bounds of all patches.
    fn note(&self, bounds: &Bounds, report: &mut Report) {
        report.delta_e_bound = bounds.delta_e.iter().fold(0.0, |m, b| m.max(*b));
        let area: f64 = self.transport.areas.iter().sum();
        report.mean_delta_e_bound = bounds.delta_e.iter().zip(&self.transport.areas).map(|(b, a)| b * a / area).sum();
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

/// All factors that differ, and the number of each among them.
fn different(factors: impl Iterator<Item = Factor>) -> (Vec<Factor>, Vec<usize>) {
    let (mut different, mut known) = (Vec::new(), BTreeMap::new());
    let number = |factor: Factor| {
        *known.entry((factor.scale.to_bits(), factor.leaf)).or_insert_with(|| {
            different.push(factor);
            different.len() - 1
        })
    };
    let numbers = factors.map(number).collect();
    (different, numbers)
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "tests fail by panicking")]
#[allow(clippy::print_stdout, reason = "the figures behind the verdict are shown with --nocapture")]
mod tests {
    use core::fmt::Write;

    use spectral_core::tables::{UniformTable, colorchecker, fluorescent, illuminants};

    use super::{Mode, PACE, Pace};
    use crate::radiosity::{Others, Radiosity, Report, Settings};
    use crate::scene::{Scene, Source, builtin, load};
    use crate::spectral::{Components, IntervalSettings, Palette, UniformBins};

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
                let settings = IntervalSettings { threshold, ..IntervalSettings::default() };
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

    /// Beyond 705 nm only the lamp itself reflects light, and it doesn't see itself. Where mirrors might show it some, those parts are kept.
    #[test]
    fn dark_parts_have_no_rows_and_no_light() {
        let scene = builtin::load("cornell-box", &[]).unwrap();
        let [without, with] = [Others::Refused, Others::Simplified].map(|others| {
            let mut palette = Palette::default();
            let settings = Settings { accuracy: 3e-2, others, ..Settings::default() };
            let radiosity = Radiosity::new(&scene, &settings, &mut palette, &|_| {}).unwrap();
            let solution = radiosity.solve_intervals(&palette, &IntervalSettings::default()).unwrap();
            let leaves = radiosity.transport.leaves.iter();
            let colours: Vec<[f64; 3]> = leaves
                .map(|leaf| {
                    let row = &solution.nodes[*leaf as usize * solution.width..][..solution.width];
                    solution.representation().colour(&[], row).value
                })
                .collect();
            (solution.report().intervals, colours)
        });
        assert!(without.0 < with.0, "{} {}", without.0, with.0);
        assert!(without.1.iter().flatten().any(|v| *v > 0.0));
        assert_eq!(without.1, with.1);
    }

    /// What each number of a row is worth in luminance makes up that of its colour, in all representations.
    #[test]
    fn luminances_of_numbers_add_up() {
        let scene = builtin::load("cornell-box", &[]).unwrap();
        let mut palette = Palette::default();
        let radiosity = Radiosity::new(&scene, &Settings::default(), &mut palette, &|_| {}).unwrap();
        let bins = UniformBins::new(&palette, 12).unwrap();
        let components = Components::naive(&palette).unwrap();
        let modes = [Mode::Paper, Mode::Corrected, Mode::Certified];
        let by_mode = |mode| {
            radiosity.solve_intervals(&palette, &IntervalSettings { mode, ..IntervalSettings::default() }).unwrap()
        };
        let others = [radiosity.solve(&bins).unwrap(), radiosity.solve(&components).unwrap()];
        for solution in modes.map(by_mode).iter().chain(&others) {
            let (representation, mut lit) = (solution.representation(), 0);
            let luminances = representation.luminances();
            for row in solution.nodes.chunks(solution.width) {
                let sum: f64 = luminances.iter().zip(row).map(|(each, number)| each * number).sum();
                let luminance = representation.colour(&[], row).value[1];
                assert!((sum - luminance).abs() <= 1e-12 * luminance.abs(), "{sum} {luminance}");
                lit += u32::from(luminance > 0.0);
            }
            assert!(lit > 10, "{lit}");
        }
    }
}
