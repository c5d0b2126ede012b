//! Trials of the certified colour bound: random expressions, evaluated by the core and by [`dense`](crate::dense) integration.
//!
//! A statement of the core fails here when it is false by more than the oracle's own rounding error, which the oracle bounds;
//! there is no other tolerance. In `f32` that error is negligible; in `f64` it is of the size of the core's margins for rounding.

use alloc::collections::BTreeMap;
use core::fmt;
use core::ops::Range;

use spectral_core::adaptive::{Mode, Piece, Status, Target, evaluate, evaluate_by_table};
use spectral_core::expression::{Op, Order, Program};
use spectral_core::interval::{Domain, Interval, Node, Weight, node_count};
use spectral_core::subdivision::{Stage, Subdivision};
use spectral_core::threshold_table::ThresholdTable;
use spectral_core::{Observer, Real};

use crate::dense::{Dense, Integral, Moments, Polyline, cie_1931, least_delta_e};
use crate::generators::{Draw, Expression, MAX_FACTORS, Palette, expression};

/// The deepest level of the spectra.
const DEPTH: u8 = 10;
/// How many cases share random spectra and a table of thresholds.
const BATCH: u64 = 8192;
/// How many random lights and reflectances a batch has.
const RANDOM_SPECTRA: usize = 16;
/// How many intervals an evaluation may use.
const PIECES: usize = 160;
/// Each of the costlier checks is made for one case of so many.
const EVERY: usize = 8;

/// What trials found.
#[derive(Clone, Debug, Default)]
pub struct Tally {
    /// How many expressions were evaluated.
    pub cases: u64,
    /// How many checks of each statement were made, and how many of them failed.
    pub checks: BTreeMap<&'static str, [u64; 2]>,
    /// The first failures, in words.
    pub examples: Vec<String>,
    /// In how many cases the threshold was reached.
    pub reached: u64,
    /// In how many cases the bound was infinite: an overflow.
    pub unbounded: u64,
    /// The sum of the numbers of intervals.
    pub intervals: u64,
    /// The largest true ΔE*ab in terms of its bound.
    pub closest: f64,
}

impl Tally {
    /// How many statements were false.
    #[must_use]
    pub fn violations(&self) -> u64 {
        self.checks.values().map(|[_, failed]| failed).sum()
    }

    /// How many checks of one statement failed.
    #[must_use]
    pub fn failed(&self, statement: &str) -> u64 {
        self.checks.get(statement).map_or(0, |[_, failed]| *failed)
    }

    /// Counts a check.
    fn check(&mut self, statement: &'static str, holds: bool, describe: impl FnOnce() -> String) {
        let [made, failed] = self.checks.entry(statement).or_default();
        *made += 1;
        if !holds {
            *failed += 1;
            if *failed <= 3 && self.examples.len() < 24 {
                self.examples.push(format!("{statement}: {}", describe()));
            }
        }
    }
}

impl fmt::Display for Tally {
    #[allow(clippy::cast_precision_loss, reason = "counts are far below 2⁵³")]
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mean = self.intervals as f64 / self.cases.max(1) as f64;
        writeln!(
            f,
            "{} cases, {} reached, {} unbounded, {mean:.1} intervals on average, true / bound up to {:.4}",
            self.cases, self.reached, self.unbounded, self.closest
        )?;
        for (statement, [made, failed]) in &self.checks {
            writeln!(f, "  {statement}: {failed} of {made} failed")?;
        }
        self.examples.iter().try_for_each(|example| writeln!(f, "  {example}"))
    }
}

/// Evaluates so many random expressions in a mode; a seed and a number of cases decide all.
///
/// # Errors
/// A spectrum or program that should be accepted was refused, or a data file can't be read.
pub fn run<R: Real>(seed: u64, cases: u64, mode: Mode) -> Result<Tally, String> {
    let mut buffers: Vec<Vec<Weight<R>>> =
        (0..=DEPTH).map(|depth| vec![Weight::default(); node_count(depth)]).collect();
    let mut domains = Vec::new();
    for (depth, buffer) in (0..=DEPTH).zip(&mut buffers) {
        let domain = Domain::build(Observer::cie_1931_2deg(), depth, buffer);
        domains.push(domain.map_err(|error| error.to_string())?);
    }
    let palette = Palette::new(&domains[usize::from(DEPTH)])?;
    let mut trial = Trial { observer: cie_1931()?, domains, palette, rules: Vec::new(), mode, tally: Tally::default() };
    for first in (0..cases).step_by(usize::try_from(BATCH).unwrap_or(1)) {
        trial.batch(seed, first..cases.min(first + BATCH))?;
    }
    Ok(trial.tally)
}

struct Trial<'a, R> {
    observer: [Polyline; 3],
    domains: Vec<Domain<'a, R>>,
    palette: Palette<R>,
    /// The palette on quadratures of increasing numbers of points.
    rules: Vec<Dense>,
    mode: Mode,
    tally: Tally,
}

/// A random expression with what an evaluation needs.
struct Case<'a, R> {
    label: &'a str,
    expression: Expression<R>,
    truth: Integral,
    white: [R; 3],
    threshold: R,
    depth: u8,
}

impl<R: Real> Case<'_, R> {
    fn describe(&self, found: &dyn fmt::Debug) -> String {
        format!(
            "{}: depth {}, threshold {}, white {:?}, {:?}: {found:?}, truth {:?}",
            self.label, self.depth, self.threshold, self.white, self.expression.ops, self.truth
        )
    }
}

impl<R: Real> Trial<'_, R> {
    fn redraw(&mut self, draw: &mut Draw<'_>) -> Result<(), String> {
        self.palette.redraw(draw, &self.domains[usize::from(DEPTH)], RANDOM_SPECTRA)?;
        let truths: Vec<_> = self.palette.spectra().iter().map(|s| &s.truth).collect();
        let rule = |points| Dense::new(&self.observer, &truths, [380.0, 780.0], points);
        self.rules = [2, 3, MAX_FACTORS.div_ceil(2) + 1].map(rule).into();
        Ok(())
    }

    /// Evaluates the cases of these numbers, with random spectra and a table of thresholds of their own.
    fn batch(&mut self, seed: u64, cases: Range<u64>) -> Result<(), String> {
        let mut draw = Draw::new(seed ^ (cases.start << 20));
        self.redraw(&mut draw)?;
        let light = draw.pick(self.palette.lights()).unwrap_or(0);
        let white = self.white_or_d65(self.truth(&[Op::Leaf(light)], 1).xyz.map(R::from_f64));
        let side = draw.index(1..9);
        let threshold = R::from_f64(draw.magnitude(0.05, 10.0));
        let mut cells = vec![R::ZERO; side * side * side];
        let table =
            ThresholdTable::build(side, threshold, white, &mut cells).ok_or("a table of thresholds was refused")?;
        for case in cases {
            // Seeds apart, so that the sequences of neighbouring cases don't overlap.
            let mut draw = Draw::new(Draw::new(seed.wrapping_add(case)).bits());
            self.case(&mut draw, &format!("seed {seed}, case {case}"), (&table, white))?;
        }
        Ok(())
    }

    /// The true integral of a program of so many factors.
    fn truth(&self, ops: &[Op<R>], factors: usize) -> Integral {
        let exact = |rule: &&Dense| 2 * rule.points() > factors + 1;
        self.rules.iter().find(exact).map_or_else(Integral::default, |rule| rule.integrate(ops))
    }

    /// A white point, if it is far enough from underflow, or else that of D65.
    fn white_or_d65(&self, white: [R; 3]) -> [R; 3] {
        let least = R::MIN_POSITIVE * R::from_f64(1e6);
        if white.iter().all(|w| *w > least && w.is_finite()) {
            return white;
        }
        let d65 = self.palette.find("D65").unwrap_or(0);
        self.truth(&[Op::Leaf(d65)], 1).xyz.map(R::from_f64)
    }

    /// The light's own white or that of D65, usually such that the colour is of some luminance in its terms.
    fn white(&self, draw: &mut Draw<'_>, expression: &Expression<R>, truth: &Integral) -> [R; 3] {
        let d65 = self.palette.find("D65").unwrap_or(0);
        let light = if draw.once_in(3) { d65 } else { expression.light };
        let white = self.truth(&[Op::Leaf(light)], 1).xyz;
        let luminance = draw.magnitude(1e-4, 3.0);
        let scale = truth.xyz[1].abs() / (luminance * white[1]);
        let scale = if draw.once_in(8) { 1.0 } else { scale };
        self.white_or_d65(white.map(|w| R::from_f64(w * scale)))
    }

    fn case(
        &mut self,
        draw: &mut Draw<'_>,
        label: &str,
        table: (&ThresholdTable<'_, R>, [R; 3]),
    ) -> Result<(), String> {
        let expression = expression(draw, &self.palette);
        let truth = self.truth(&expression.ops, expression.factors);
        let case = Case {
            label,
            white: self.white(draw, &expression, &truth),
            expression,
            truth,
            threshold: R::from_f64(draw.magnitude(0.01, 10.0)),
            depth: u8::try_from(draw.index(4..usize::from(DEPTH) + 1)).unwrap_or(DEPTH),
        };
        self.tally.cases += 1;
        self.evaluate(draw, &case)?;
        if self.mode == Mode::Certified {
            match draw.index(0..EVERY) {
                0 => self.interval(draw, &case)?,
                1 => self.subdivision(draw, &case)?,
                2 => self.table(draw, &case, table)?,
                _ => {}
            }
        }
        Ok(())
    }

    /// The statements of a result: its radius holds, and its bound holds.
    fn colour(
        &mut self,
        statements: [&'static str; 2],
        case: &Case<'_, R>,
        truth: &Integral,
        (xyz, radius, delta_e): ([R; 3], [R; 3], R),
    ) {
        let white = case.white.map(R::to_f64);
        let found = xyz.map(R::to_f64);
        for a in 0..3 {
            let off = (found[a] - truth.xyz[a]).abs();
            // Beyond the range of the type, radii may be infinite or NaN, but the bound is then infinite.
            let holds =
                off <= radius[a].to_f64() + truth.error[a] || (!radius[a].is_finite() && delta_e == R::INFINITY);
            self.tally.check(statements[0], holds, || {
                case.describe(&format!("channel {a}: off by {off:e}, {xyz:?} ± {radius:?}"))
            });
        }
        let least = least_delta_e(found, truth, white);
        let holds = least <= delta_e.to_f64() || delta_e == R::INFINITY;
        self.tally
            .check(statements[1], holds, || case.describe(&format!("{least} against {delta_e}, {xyz:?} ± {radius:?}")));
        if delta_e.is_finite() {
            self.tally.closest = self.tally.closest.max(least / delta_e.to_f64());
        }
    }

    fn evaluate(&mut self, draw: &mut Draw<'_>, case: &Case<'_, R>) -> Result<(), String> {
        let program = program(case)?;
        let mut stack = vec![Interval::zero(); program.stack_size()];
        let mut pieces = vec![Piece::default(); draw.index(1..PIECES)];
        let target = Target { mode: self.mode, threshold: case.threshold, white: case.white };
        let domain = &self.domains[usize::from(case.depth)];
        let found = evaluate(&program, domain, &target, &mut &self.palette, &mut stack, &mut pieces)
            .map_err(|error| error.to_string())?;
        self.tally.intervals += found.intervals as u64;
        self.tally.unbounded += u64::from(!found.delta_e.is_finite());
        let reached = found.status == Status::Reached;
        self.tally.reached += u64::from(reached);
        self.tally.check("reached means so", reached == (found.delta_e <= case.threshold), || case.describe(&found));
        let result = (found.xyz, found.radius, found.delta_e);
        self.colour(["radius", "bound"], case, &case.truth, result);
        Ok(())
    }

    /// What an interval of the expression keeps, on a random part of the domain.
    fn interval(&mut self, draw: &mut Draw<'_>, case: &Case<'_, R>) -> Result<(), String> {
        let level = draw.index(0..usize::from(DEPTH) + 1);
        let index = u16::try_from(draw.index(0..1 << level)).unwrap_or(0);
        let node = Node::new(u8::try_from(level).unwrap_or(0), index).ok_or("no such node")?;
        let program = program(case)?;
        let weight = self.domains[usize::from(DEPTH)].weight(node);
        let mut stack = vec![Interval::zero(); program.stack_size()];
        let found = program
            .evaluate(node, &weight, Order::Certified, &mut &self.palette, &mut stack)
            .map_err(|error| error.to_string())?;

        let (ops, truths) = self.renumbered(&case.expression.ops);
        let limits = node.limits::<f64>();
        let points = case.expression.factors + 1;
        let truth = Dense::new(&self.observer, &truths, limits, points).moments(&ops);
        let failed = shortfalls(&found, &weight, &truth);
        let finite = found.radius.iter().all(|r| r.is_finite());
        self.tally.check("interval", failed.is_empty() || !finite, || {
            case.describe(&format!("{failed:?} of {found:?} on {node:?}, {weight:?}, not {truth:?}"))
        });
        Ok(())
    }

    /// The program with its leaves numbered from 0, and the spectra that they are.
    fn renumbered(&self, ops: &[Op<R>]) -> (Vec<Op<R>>, Vec<&Polyline>) {
        let mut truths = Vec::new();
        let mut number = |id: u32| {
            truths.push(&self.palette.spectra()[id as usize].truth);
            u32::try_from(truths.len() - 1).unwrap_or(u32::MAX)
        };
        let ops = ops
            .iter()
            .map(|op| match *op {
                Op::Leaf(id) | Op::Deferred(id) => Op::Leaf(number(id)),
                other => other,
            })
            .collect();
        (ops, truths)
    }

    fn subdivision(&mut self, draw: &mut Draw<'_>, case: &Case<'_, R>) -> Result<(), String> {
        let program = program(case)?;
        let mut stack = vec![Interval::zero(); program.stack_size()];
        let count = draw.index(1..PIECES / 2);
        let mut pieces = vec![Piece::default(); count];
        let mut stages = vec![Stage::default(); count];
        let largest = R::from_f64(draw.magnitude(1e-2, 1e30));
        let recorded = Subdivision::record(
            &program,
            &self.domains[usize::from(case.depth)],
            Mode::Certified,
            case.threshold,
            case.white,
            largest,
            &mut &self.palette,
            &mut stack,
            &mut pieces,
            &mut stages,
        )
        .map_err(|error| error.to_string())?;
        let anywhere = draw.magnitude(1e-30, 1e30);
        let luminance = draw.magnitude(1e-3, 10.0) * case.white[1].to_f64();
        let visible = luminance / case.truth.xyz[1].abs();
        for scale in [anywhere, visible, 1.0, 0.0] {
            let scale = R::from_f64(scale);
            if !scale.is_finite() {
                continue;
            }
            let found = recorded.at_scale(scale);
            let c = scale.to_f64();
            let truth = Integral {
                xyz: case.truth.xyz.map(|v| v * c),
                error: case.truth.error.map(|e| e * c + case.truth.xyz[1].abs() * c * 1e-16),
            };
            let statements = ["radius of a subdivision", "bound of a subdivision"];
            self.colour(statements, case, &truth, (found.xyz, found.radius, found.delta_e));
            let enough = recorded.stages().iter().any(|s| scale <= s.max_scale);
            let holds = !enough || found.delta_e <= case.threshold;
            self.tally.check("a stage is enough up to its scale", holds, || {
                case.describe(&format!("scale {scale}, {found:?}"))
            });
            let met = recorded.status() != Status::Reached || scale > largest || enough;
            self.tally.check("a subdivision serves its scales", met, || {
                case.describe(&format!("scale {scale} of {largest}, {:?}", recorded.stages()))
            });
        }
        Ok(())
    }

    /// What the table of thresholds accepts is within its threshold.
    fn table(
        &mut self,
        draw: &mut Draw<'_>,
        case: &Case<'_, R>,
        (table, white): (&ThresholdTable<'_, R>, [R; 3]),
    ) -> Result<(), String> {
        let threshold = table.threshold();
        // Bring the colour to some luminance in terms of the table's white.
        let luminance = draw.magnitude(1e-3, 3.0) * white[1].to_f64();
        let scale = R::from_f64(luminance / case.truth.xyz[1]);
        if !scale.is_finite() {
            return Ok(());
        }
        let mut ops = case.expression.ops.clone();
        ops.push(Op::Scale(scale));
        let program = Program::new(&ops).map_err(|error| error.to_string())?;
        let mut stack = vec![Interval::zero(); program.stack_size()];
        let mut pieces = vec![Piece::default(); draw.index(1..PIECES)];
        let domain = &self.domains[usize::from(case.depth)];
        let mode = Mode::Certified;
        let found = evaluate_by_table(&program, domain, mode, table, &mut &self.palette, &mut stack, &mut pieces)
            .map_err(|error| error.to_string())?;
        let accepted = found.status == Status::Reached;
        let bound = if accepted { threshold } else { R::INFINITY };
        self.tally.check("accepted means so", found.delta_e == bound, || case.describe(&found));
        let truth = self.truth(&ops, case.expression.factors);
        if accepted {
            let least = least_delta_e(found.xyz.map(R::to_f64), &truth, white.map(R::to_f64));
            self.tally.check("bound by table", least <= threshold.to_f64(), || {
                case.describe(&format!("{least} against {threshold}, scale {scale}, {found:?}"))
            });
        }
        Ok(())
    }
}

fn program<'a, R: Real>(case: &'a Case<'_, R>) -> Result<Program<'a, R>, String> {
    Program::new(&case.expression.ops).map_err(|error| error.to_string())
}

/// What an interval states of a spectrum that is not so.
#[must_use]
pub fn shortfalls<R: Real>(found: &Interval<R>, weight: &Weight<R>, truth: &Moments) -> Vec<&'static str> {
    let doubt = 2.0 * truth.value_error;
    let xyz = found.tristimulus(weight).map(R::to_f64);
    let covers = |bounds: [R; 3], exact: [f64; 3], doubt: &dyn Fn(usize) -> f64| {
        (0..3).all(|a| bounds[a].to_f64() >= exact[a] - doubt(a))
    };
    let off = core::array::from_fn(|a| (xyz[a] - truth.integral.xyz[a]).abs());
    let [low, high] = truth.range;
    let mean = found.mean.to_f64();
    let deviation = (high - mean).max(mean - low);
    let statements = [
        ("radius", covers(found.radius, off, &|a| truth.integral.error[a])),
        ("norm", covers(found.norm, truth.norm, &|a| doubt * truth.weight[a].sqrt())),
        ("absolute", covers(found.absolute, truth.absolute, &|a| doubt * truth.weight[a])),
        ("low", found.low.to_f64() <= low + doubt),
        ("high", found.high.to_f64() >= high - doubt),
        ("deviation", found.deviation().to_f64() >= deviation - 2.0 * doubt),
    ];
    statements.into_iter().filter(|(_, holds)| !holds).map(|(name, _)| name).collect()
}
