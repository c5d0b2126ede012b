//! Intervals, expressions, adaptive evaluation and bounds.

use core::hint::black_box;

use spectral_core::adaptive::{Evaluation, Mode, Piece, Target, evaluate, evaluate_by_table};
use spectral_core::bound::{delta_e_bound, delta_e_majorant};
use spectral_core::expression::{Op, Order, Program, Sources};
use spectral_core::interval::{Domain, Interval, Node, Pyramid, Weight, node_count, nodes};
use spectral_core::spectrum::{Outside, Spectrum};
use spectral_core::subdivision::{Stage, Subdivision};
use spectral_core::tables::{colorchecker, fluorescent};
use spectral_core::threshold_table::ThresholdTable;
use spectral_core::{Observer, Real};

use crate::Run;

/// Levels of intervals below the whole domain, and their number: what 16 KB of RAM have room for.
const DEPTH: u8 = 3;
const NODES: usize = node_count(DEPTH);

/// Takes an interval into the digest.
fn put_interval<R: Real>(run: &mut Run, interval: &Interval<R>) {
    run.put_all(&[interval.mean, interval.low, interval.high]);
    for values in [interval.error, interval.norm, interval.absolute, interval.radius] {
        run.put_all(&values);
    }
}

/// Any interval with some weight, of the sizes that occur.
fn interval<R: Real>(run: &mut Run) -> Interval<R> {
    let mean = run.within::<R>(0.0, 1.0);
    Interval {
        mean,
        error: run.array(-1.0, 1.0),
        norm: run.array(0.0, 1.0),
        absolute: run.array(0.0, 1.0),
        low: mean - run.within(0.0, 0.5),
        high: mean + run.within(0.0, 0.5),
        radius: run.array(0.0, 0.01),
    }
}

/// Any weight.
fn weight<R: Real>(run: &mut Run) -> Weight<R> {
    let integral: [R; 3] = run.array(0.0, 50.0);
    Weight { integral, inverse: integral.map(|i| R::ONE / i), root: integral.map(R::sqrt) }
}

/// Any node, mostly valid ones.
fn node(run: &mut Run) -> Node {
    let (level, index) = (run.byte() % 5, run.short() % 16);
    Node::new(level, index).unwrap_or_default()
}

/// A light and a paint in intervals, for what follows.
fn with_leaves<R: Real>(then: impl FnOnce(&Domain<'_, R>, &[Pyramid<'_, R>])) {
    let mut weights = [Weight::default(); NODES];
    let Ok(domain) = Domain::<R>::build(Observer::cie_1931_2deg(), DEPTH, &mut weights) else { return };
    let mut buffers = [[Interval::zero(); NODES]; 2];
    let [first, second] = &mut buffers;
    let light = Pyramid::build(&fluorescent::FL2.spectrum(Outside::Zero), &domain, first);
    let paint = Pyramid::build(&colorchecker::GREEN.spectrum(Outside::Hold), &domain, second);
    if let (Ok(light), Ok(paint)) = (light, paint) {
        then(&domain, black_box(&[light, paint]));
    }
}

/// Takes an evaluation into the digest.
fn put_evaluation<R: Real>(run: &mut Run, found: &Evaluation<R>) {
    run.put_all(&found.xyz);
    run.put_all(&found.radius);
    run.put(found.delta_e);
    run.put_bits(found.intervals as u64);
    run.put_bits(found.status as u64);
}

/// A program of all kinds of steps, which may be faulty.
fn program<R: Real>(run: &mut Run) -> [Op<R>; 5] {
    let last = match run.below(4) {
        0 => Op::Scale(run.within(-1.0, 2.0)),
        1 => Op::Schlick(run.within(-0.1, 1.0)),
        2 => Op::Deferred(run.bits()),
        _ => Op::Schlick(run.within(0.0, 1.0)),
    };
    let step = match run.below(6) {
        0 => Op::Sum,
        1 => Op::Scale(run.within(-1.0, 2.0)),
        _ => Op::Product,
    };
    [Op::Leaf(run.below(2)), Op::Scale(run.within(0.0, 0.1)), Op::Leaf(run.below(3)), step, last]
}

/// A mode of evaluation.
fn mode(run: &mut Run) -> Mode {
    match run.below(3) {
        0 => Mode::Paper,
        1 => Mode::Corrected,
        _ => Mode::Certified,
    }
}

entries! {
    interval_product 48 [
        "interval::Interval::product", "interval::Interval::deviation", "interval::Interval::mean_tristimulus",
        "interval::Interval::tristimulus",
    ] |run, R| {
        let (first, second, weight) = (interval::<R>(run), interval::<R>(run), weight::<R>(run));
        let result = run.time_call(|| first.product(&second, &weight));
        put_interval(run, &result);
        run.put(result.deviation());
        run.put_all(&result.mean_tristimulus(&weight));
        run.put_all(&result.tristimulus(&weight));
    }
    interval_sum 24 ["interval::Interval::sum"] |run, R| {
        let (first, second, weight) = (interval::<R>(run), interval::<R>(run), weight::<R>(run));
        let result = run.time_call(|| first.sum(&second, &weight));
        put_interval(run, &result);
    }
    interval_scale 24 ["interval::Interval::scale"] |run, R| {
        let (first, factor, weight) = (interval::<R>(run), run.within(-2.0, 2.0), weight::<R>(run));
        let result = run.time_call(|| first.scale(factor, &weight));
        put_interval(run, &result);
    }
    interval_schlick 24 ["interval::Interval::schlick"] |run, R| {
        let (first, fresnel, weight) = (interval::<R>(run), run.unit(), weight::<R>(run));
        let result = run.time_call(|| first.schlick(fresnel, &weight));
        put_interval(run, &result);
    }
    interval_constant 12 ["interval::Interval::constant", "interval::Interval::zero"] |run, R| {
        let (value, weight) = (run.within(-1.0, 1.0), weight::<R>(run));
        let result = run.time_call(|| Interval::constant(value, &weight));
        put_interval(run, &result);
        put_interval(run, &Interval::<R>::zero());
    }
    interval_first_order 24 [
        "interval::Interval::product_first_order", "interval::Interval::scale_first_order",
        "interval::Interval::sum_first_order", "interval::Interval::schlick_first_order",
    ] |run, R| {
        let (first, second, factor) = (interval::<R>(run), interval::<R>(run), run.unit());
        let product = run.time_call(|| first.product_first_order(&second));
        for result in [
            product,
            first.scale_first_order(factor),
            first.sum_first_order(&second),
            first.schlick_first_order(factor),
        ] {
            run.put(result.mean);
            run.put_all(&result.error);
        }
    }
    interval_node 64 [
        "interval::Node::new", "interval::Node::level", "interval::Node::index", "interval::Node::children",
        "interval::Node::parent", "interval::Node::position", "interval::Node::limits", "interval::node_count",
        "interval::nodes",
    ] |run, R| {
        let (level, index) = (run.byte() % 16, run.short());
        let found = run.time_call(|| Node::new(level, index));
        run.put_option(found, |run, node| {
            run.put_bits(node.position() as u64);
            run.put_all(&node.limits::<R>());
            for node in node.parent().into_iter().chain(node.children().into_iter().flatten()) {
                run.put_bits(u64::from(node.level()) << 16 | u64::from(node.index()));
            }
        });
        let depth = run.byte() % 8;
        run.put_bits(nodes(depth).count() as u64 + ((node_count(depth) as u64) << 32));
    }
    interval_domain 1 [
        "interval::Domain::build", "interval::Domain::depth", "interval::Domain::observer", "interval::Domain::weight",
    ] |run, R| {
        let mut weights = [Weight::<R>::default(); NODES];
        let (depth, count) = (black_box(2), black_box(NODES));
        let observer = Observer::cie_1931_2deg();
        let weights = weights.get_mut(..count).unwrap_or_default();
        let found = run.time_call(|| Domain::<R>::build(observer, depth, weights));
        run.put_option(found.ok(), |run, domain| {
            let weight = domain.weight(node(run));
            for values in [weight.integral, weight.inverse, weight.root] {
                run.put_all(&values);
            }
            run.put_bits(u64::from(domain.depth()));
            let wavelength = run.within(400.0, 700.0);
            run.put_all(&domain.observer().value(wavelength));
        });
    }
    interval_pyramid 1 [
        "interval::Pyramid::build", "interval::Pyramid::get", "interval::Pyramid::depth",
        "interval::Interval::of_spectrum",
    ] |run, R| {
        let mut weights = [Weight::<R>::default(); NODES];
        let depth = black_box(2);
        let Ok(domain) = Domain::<R>::build(Observer::cie_1931_2deg(), depth, &mut weights) else { return };
        let mut buffer = [Interval::<R>::zero(); NODES];
        let light = fluorescent::FL2.spectrum(Outside::Zero);
        let found = run.time_call(|| Pyramid::build(&light, &domain, &mut buffer));
        run.put_option(found.ok(), |run, pyramid| {
            run.put_bits(u64::from(pyramid.depth()));
            for _ in 0..6 {
                let node = node(run);
                run.put_option(pyramid.get(node), |run, interval| put_interval(run, interval));
            }
        });
        let interval = Interval::of_spectrum(&light, &domain, node(run));
        put_interval(run, &interval);
    }
    interval_of_product 1 ["interval::Interval::of_product"] |run, R| {
        let mut weights = [Weight::<R>::default(); NODES];
        let depth = black_box(2);
        let Ok(domain) = Domain::<R>::build(Observer::cie_1931_2deg(), depth, &mut weights) else { return };
        let (light, paint) = (fluorescent::FL2.spectrum(Outside::Zero), colorchecker::GREEN.spectrum(Outside::Hold));
        let factors: [&dyn Spectrum<R>; 3] = [&light, &paint, &paint];
        let count = run.index(4);
        let (node, estimate) = (node(run), interval(run));
        let factors = factors.get(..count).unwrap_or_default();
        let result = run.time_call(|| Interval::of_product(factors, &domain, node, &estimate));
        put_interval(run, &result);
    }
    expression_program 16 [
        "expression::Program::new", "expression::Program::ops", "expression::Program::stack_size",
        "expression::Program::evaluate",
    ] |run, R| {
        let (ops, leaves, weight) = (program::<R>(run), [interval(run), interval(run)], weight::<R>(run));
        let mut leaves = Leaves(&leaves);
        let (count, room) = (run.index(6), run.index(4));
        let mut stack = [Interval::zero(); 3];
        let stack = stack.get_mut(..room).unwrap_or_default();
        let order = if run.below(2) == 0 { Order::First } else { Order::Certified };
        let node = node(run);
        run.put_option(Program::new(ops.get(..count).unwrap_or_default()).ok(), |run, program| {
            run.put_bits(program.stack_size() as u64 + ((program.ops().len() as u64) << 32));
            let found = run.time_call(|| program.evaluate(node, &weight, order, &mut leaves, stack));
            run.put_option(found.ok(), |run, found| put_interval(run, &found));
        });
    }
    adaptive_evaluate 1 [
        "adaptive::evaluate", "adaptive::Mode::order",
        "expression::Sources for &[crate::interval::Pyramid<'_, R>]",
    ] |run, R| {
        with_leaves::<R>(|domain, mut leaves| for _ in 0..4 {
            let ops = [Op::Leaf(0), Op::Scale(run.within(0.002, 0.02)), Op::Leaf(run.below(2)), Op::Product];
            let Ok(program) = Program::new(black_box(&ops)) else { return };
            let white = run.array(0.5, 1.5);
            let target = Target { mode: mode(run), threshold: run.within(0.1, 20.0), white };
            run.put_bits(target.mode.order() as u64);
            let mut stack = [Interval::zero(); 2];
            let mut pieces = [Piece::default(); 6];
            let room = run.index(7);
            let pieces = pieces.get_mut(..room).unwrap_or_default();
            let found =
                run.time_call(|| evaluate(&program, domain, &target, &mut leaves, &mut stack, pieces));
            run.put_option(found.ok(), |run, found| put_evaluation(run, &found));
        });
    }
    adaptive_evaluate_by_table 1 ["adaptive::evaluate_by_table"] |run, R| {
        let mut cells = [R::ZERO; 8];
        let white = run.array(0.5, 1.5);
        let Some(table) = ThresholdTable::build(black_box(2), R::from_f64(3.0), white, &mut cells) else { return };
        with_leaves::<R>(|domain, mut leaves| {
            let ops = [Op::Leaf(0), Op::Scale(R::from_f64(0.01)), Op::Leaf(1), Op::Product];
            let Ok(program) = Program::new(black_box(&ops)) else { return };
            let mode = mode(run);
            let mut stack = [Interval::zero(); 2];
            let mut pieces = [Piece::default(); 6];
            let pieces = pieces.get_mut(..black_box(6)).unwrap_or_default();
            let found = run
                .time_call(|| evaluate_by_table(&program, domain, mode, &table, &mut leaves, &mut stack, pieces));
            run.put_option(found.ok(), |run, found| put_evaluation(run, &found));
        });
    }
    subdivision 1 [
        "subdivision::Subdivision::record", "subdivision::Subdivision::from_stages",
        "subdivision::Subdivision::stages", "subdivision::Subdivision::status", "subdivision::Subdivision::at_scale",
    ] |run, R| {
        let white = run.array(0.5, 1.5);
        with_leaves::<R>(|domain, mut leaves| {
            let ops = [Op::Leaf(0), Op::Scale(R::from_f64(0.01)), Op::Leaf(1), Op::Product];
            let Ok(program) = Program::new(black_box(&ops)) else { return };
            let mode = mode(run);
            let mut stack = [Interval::zero(); 2];
            let (mut pieces, mut stages) = ([Piece::default(); 6], [Stage::default(); 6]);
            let pieces = pieces.get_mut(..black_box(6)).unwrap_or_default();
            let stages = stages.get_mut(..black_box(5)).unwrap_or_default();
            let threshold = run.within(0.5, 5.0);
            let found = run.time_call(|| Subdivision::record(
                &program, domain, mode, threshold, white, R::ONE, &mut leaves, &mut stack, pieces, stages,
            ));
            run.put_option(found.ok(), |run, found| {
                let again = Subdivision::from_stages(found.stages(), white, found.status());
                for _ in 0..4 {
                    let scale = run.within(0.0, 2.0);
                    let scaled = again.at_scale(scale);
                    run.put_all(&scaled.xyz);
                    run.put_all(&scaled.radius);
                    run.put(scaled.delta_e);
                    run.put_bits(scaled.intervals as u64);
                }
            });
        });
    }
    threshold_table 2 [
        "threshold_table::ThresholdTable::build", "threshold_table::ThresholdTable::threshold",
        "threshold_table::ThresholdTable::tolerance", "threshold_table::ThresholdTable::accepts",
    ] |run, R| {
        let mut cells = [R::ZERO; 27];
        let (side, threshold, white) = (run.index(5), run.within(-0.1, 6.0), run.array(0.5, 1.5));
        let found = run.time_call(|| ThresholdTable::<R>::build(side, threshold, white, &mut cells));
        run.put_option(found, |run, table| {
            let (xyz, radius) = (run.array(-0.1, 1.2), run.array(0.0, 0.05));
            run.put_all(&[table.threshold(), table.tolerance(xyz)]);
            run.put_bits(u64::from(table.accepts(xyz, radius)));
        });
    }
    bound_delta_e 32 ["bound::delta_e_bound"] |run, R| {
        let (xyz, radius, white) = (run.array(-0.05, 1.0), run.array(0.0, 0.02), run.array(0.5, 1.5));
        let bound = run.time_call(|| delta_e_bound::<R>(xyz, radius, white));
        run.put(bound.delta_e);
        run.put_all(&bound.gradient);
    }
    bound_delta_e_majorant 32 ["bound::delta_e_majorant"] |run, R| {
        let (xyz, radius, white) = (run.array(-0.05, 1.0), run.array(0.0, 0.02), run.array(0.5, 1.5));
        let bound = run.time_call(|| delta_e_majorant::<R>(xyz, radius, white));
        run.put(bound);
    }
}

/// Leaves that are the same on every interval, and one deferred spectrum.
struct Leaves<'a, R>(&'a [Interval<R>]);

impl<R: Real> Sources<R> for Leaves<'_, R> {
    fn leaf(&self, id: u32, _: Node) -> Option<&Interval<R>> {
        self.0.get(id as usize)
    }

    fn deferred(&mut self, id: u32, _: Node) -> Option<Interval<R>> {
        (id.is_multiple_of(2)).then(Interval::zero)
    }
}
