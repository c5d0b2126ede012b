//! Properties of the parts that the certified bound is made of, at the edges of their domains.
#![allow(clippy::unwrap_used, reason = "a test stops at the first thing that should not be")]

use spectral_core::adaptive::{Mode, Piece, Target, evaluate, evaluate_by_table};
use spectral_core::bound::{delta_e_bound, delta_e_majorant};
use spectral_core::expression::{ExpressionError, Op, Order, Program};
use spectral_core::interval::{BuildError, Domain, Interval, MAX_DEPTH, Node, Pyramid, Weight, node_count};
use spectral_core::spectrum::{Constant, Line, Outside, PiecewiseLinear, Segment};
use spectral_core::subdivision::{Stage, Subdivision};
use spectral_core::threshold_table::ThresholdTable;
use spectral_core::{Observer, ObserverError, Real, Spectrum};
use spectral_tests::dense::{Beyond, Dense, Polyline, cie_1931, lab};
use spectral_tests::generators::Draw;

/// Small enough to build quickly, deep enough for a threshold of ½ with spectra that have a step.
const DEPTH: u8 = 8;

fn with_domain<R: Real>(test: impl FnOnce(&Domain<'_, R>)) {
    let mut weights = vec![Weight::default(); node_count(DEPTH)];
    test(&Domain::build(Observer::cie_1931_2deg(), DEPTH, &mut weights).unwrap());
}

fn distance(first: [f64; 3], second: [f64; 3], white: [f64; 3]) -> f64 {
    let (a, b) = (lab(first, white), lab(second, white));
    (0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>().sqrt()
}

/// A corner or an inner point of a box, in `f64`.
fn in_box<R: Real>(draw: &mut Draw<'_>, xyz: [R; 3], radius: [R; 3]) -> [f64; 3] {
    core::array::from_fn(|a| {
        let inside = draw.between(-1.0, 1.0);
        let t = draw.pick(&[-1.0, 1.0, inside]).unwrap();
        xyz[a].to_f64() + t * radius[a].to_f64()
    })
}

/// The error of ΔE*ab by [`distance`]: each f to 2 ε, and the product with t before it.
fn doubt(xyz: [f64; 3], white: [f64; 3]) -> f64 {
    let f: f64 = (0..3).map(|a| (xyz[a] / white[a]).abs().cbrt().max(1.0)).sum();
    700.0 * 8.0 * f64::EPSILON * f
}

fn bound_covers_the_box_and_majorant_covers_the_bound<R: Real>(seed: u64) {
    let mut draw = Draw::new(seed);
    for _ in 0..20_000 {
        let unit = draw.magnitude(1e-25, 1e25);
        let white = [0.9, 1.0, 1.1].map(|w| R::from_f64(w * unit));
        let size = draw.magnitude(1e-6, 1e2);
        let sign = if draw.once_in(10) { -0.1 } else { 1.0 };
        let xyz: [R; 3] = core::array::from_fn(|_| R::from_f64(unit * size * draw.unit() * sign));
        let reach = draw.magnitude(1e-9, 2.0);
        let radius: [R; 3] = core::array::from_fn(|_| R::from_f64(unit * size * reach * draw.unit()));
        let bound = delta_e_bound(xyz, radius, white).delta_e;
        let majorant = delta_e_majorant(xyz, radius, white);
        assert!(bound.is_finite() && majorant.is_finite());
        let white = white.map(R::to_f64);
        for _ in 0..8 {
            let other = in_box(&mut draw, xyz, radius);
            let actual = distance(xyz.map(R::to_f64), other, white) - doubt(other, white);
            assert!(actual <= bound.to_f64(), "{actual} > {bound}: {xyz:?} ± {radius:?}, {white:?}");
            assert!(actual <= majorant.to_f64(), "{actual} > {majorant}: {xyz:?} ± {radius:?}");
        }
        // Both have the same margins for rounding; that of the bound is for greater f's.
        let slack = 64.0 * R::EPSILON.to_f64() * 900.0 * (size * (1.0 + reach)).cbrt().max(1.0);
        assert!(bound.to_f64() <= majorant.to_f64() + slack, "{bound} > {majorant}");
    }
}

#[test]
fn bounds_cover_their_box() {
    bound_covers_the_box_and_majorant_covers_the_bound::<f32>(1);
    bound_covers_the_box_and_majorant_covers_the_bound::<f64>(2);
}

fn majorant_grows_with_scale<R: Real>(seed: u64) {
    let mut draw = Draw::new(seed);
    for _ in 0..5_000 {
        let xyz: [f64; 3] = core::array::from_fn(|_| draw.magnitude(1e-6, 1.0));
        let reach = draw.magnitude(1e-6, 1.0);
        let radius = xyz.map(|v| v * reach * draw.unit());
        let mut before = R::ZERO;
        for k in -30..=30 {
            let scale = 10_f64.powf(f64::from(k) / 6.0);
            let at = |v: [f64; 3]| v.map(|v| R::from_f64(v * scale));
            let majorant = delta_e_majorant(at(xyz), at(radius), [R::ONE; 3]);
            // Rounding of f and of the arguments: 16 ε of the greatest f, counted as the majorant does.
            let slack = 32.0 * R::EPSILON.to_f64() * 1516.0 * scale.cbrt().max(1.0);
            assert!(before.to_f64() <= majorant.to_f64() + slack, "falls at {scale}: {xyz:?}");
            before = majorant;
            // Alone, each radius makes it grow, and a greater colour lets it fall.
            let grown = delta_e_majorant(at(xyz), at(radius.map(|r| 1.1 * r)), [R::ONE; 3]);
            assert!(majorant.to_f64() <= grown.to_f64() + slack);
            let brighter = delta_e_majorant(at(xyz.map(|v| 1.1 * v)), at(radius), [R::ONE; 3]);
            assert!(brighter.to_f64() <= majorant.to_f64() + slack);
        }
    }
}

#[test]
fn the_majorant_is_monotone() {
    majorant_grows_with_scale::<f32>(3);
    majorant_grows_with_scale::<f64>(4);
}

#[test]
fn what_is_not_finite_has_no_bound() {
    let good = [0.3_f64, 0.4, 0.5];
    let small = [0.01; 3];
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        for a in 0..3 {
            let spoil = |v: [f64; 3]| core::array::from_fn(|k| if k == a { bad } else { v[k] });
            let white = [1.0; 3];
            for (xyz, radius, white) in
                [(spoil(good), small, white), (good, spoil(small), white), (good, small, spoil(white))]
            {
                // A radius of −∞ is outside the domain.
                if radius[a] < 0.0 {
                    continue;
                }
                assert_eq!(delta_e_bound(xyz, radius, white).delta_e, f64::INFINITY);
                assert_eq!(delta_e_majorant(xyz, radius, white), f64::INFINITY);
            }
        }
    }
    for white in [[1.0, 0.0, 1.0], [1.0, 1.0, -1.0]] {
        assert_eq!(delta_e_bound(good, small, white).delta_e, f64::INFINITY);
        assert_eq!(delta_e_majorant(good, small, white), f64::INFINITY);
    }
}

/// Numbers at, just below and just above a cell's border, and beyond the cube on either side.
fn component(draw: &mut Draw<'_>, side: usize) -> f64 {
    let side = f64::from(u32::try_from(side).unwrap());
    let border = (draw.unit() * (side + 1.0)).floor() / side;
    match draw.index(0..6) {
        0 => border,
        1 => border * (1.0 + f64::EPSILON * draw.between(-4.0, 4.0)),
        2 => border * (1.0 + f64::from(f32::EPSILON) * draw.between(-4.0, 4.0)),
        3 => draw.magnitude(1.0, 1e3),
        4 => -draw.magnitude(1e-6, 0.1),
        _ => draw.unit(),
    }
}

fn table_is_certain<R: Real>(seed: u64) {
    let mut draw = Draw::new(seed);
    for _ in 0..40 {
        let side = draw.index(1..12);
        let threshold = R::from_f64(draw.magnitude(0.05, 20.0));
        let unit = draw.magnitude(1e-25, 1e25);
        let white = [0.95, 1.0, 1.09].map(|w| R::from_f64(w * unit));
        let mut cells = vec![R::ZERO; side.pow(3)];
        let table = ThresholdTable::build(side, threshold, white, &mut cells).unwrap();
        assert_eq!(table.threshold(), threshold);
        let exact = white.map(R::to_f64);
        for _ in 0..2_000 {
            let xyz: [R; 3] = core::array::from_fn(|a| R::from_f64(component(&mut draw, side) * exact[a]));
            let tolerance = table.tolerance(xyz).to_f64();
            assert!(tolerance > 0.0);
            let below = 1.0 - 4.0 * R::EPSILON.to_f64();
            let radius = exact.map(|w| R::from_f64(w * tolerance * below));
            assert!(table.accepts(xyz, radius), "{xyz:?} ± {radius:?}: {tolerance}");
            let other = in_box(&mut draw, xyz, radius);
            let actual = distance(xyz.map(R::to_f64), other, exact) - doubt(other, exact);
            assert!(actual <= threshold.to_f64(), "{actual} > {threshold}: {xyz:?} ± {radius:?}");
            assert!(!table.accepts(xyz, exact.map(|w| R::from_f64(w * tolerance * 1.001))));
        }
        for bad in [R::from_f64(f64::NAN), R::INFINITY, -R::INFINITY] {
            assert!(!table.accepts([bad, white[1], white[2]], [R::ZERO; 3]));
            assert!(!table.accepts(white, [R::ZERO, bad.abs(), R::ZERO]));
        }
    }
}

#[test]
fn the_table_of_thresholds_is_certain_at_borders_and_outside_the_cube() {
    table_is_certain::<f32>(5);
    table_is_certain::<f64>(6);
}

#[test]
fn tables_of_thresholds_refuse_bad_input() {
    let mut cells = [0.0_f64; 27];
    let white = [1.0; 3];
    assert!(ThresholdTable::build(3, 1.0, white, &mut cells).is_some());
    assert!(ThresholdTable::build(3, 1.0, white, &mut cells[..26]).is_none());
    assert!(ThresholdTable::build(0, 1.0, white, &mut cells).is_none());
    assert!(ThresholdTable::build(usize::MAX, 1.0, white, &mut cells).is_none());
    for bad in [f64::NAN, 0.0, -1.0, f64::INFINITY] {
        assert!(ThresholdTable::build(3, 1.0, [1.0, bad, 1.0], &mut cells).is_none(), "{bad}");
    }
    for bad in [f64::NAN, -1.0] {
        assert!(ThresholdTable::build(3, bad, white, &mut cells).is_none(), "{bad}");
    }
}

/// One light through one step, read at scales across the range of the type.
fn any_scale<R: Real>(exponents: core::ops::RangeInclusive<i32>) {
    with_domain::<R>(|domain| {
        let (wavelengths, values) =
            ([400.0, 590.0, 600.0, 700.0].map(R::from_f64), [0.1, 0.2, 0.9, 0.8].map(R::from_f64));
        let step = PiecewiseLinear::new(&wavelengths, &values, Outside::Hold).unwrap();
        let mut buffer = vec![Interval::zero(); node_count(DEPTH)];
        let pyramids = [Pyramid::build(&step, domain, &mut buffer).unwrap()];
        let ops = [Op::Leaf(0), Op::Leaf(0), Op::Product];
        let program = Program::new(&ops).unwrap();
        let nodes: Vec<_> = wavelengths.iter().zip(values).map(|(w, v)| (w.to_f64(), v.to_f64())).collect();
        let truth = Polyline::new(&nodes, Beyond::Hold);
        let dense = Dense::new(&cie_1931().unwrap(), &[&truth], [380.0, 780.0], 2);
        let truth = dense.integrate(&ops).xyz;
        for exponent in exponents {
            // The white of a picture in which this scale is of middling brightness.
            let unit = 10_f64.powi(exponent);
            let white = [100.0 * unit; 3];
            let threshold = R::from_f64(0.5);
            let (mut stack, mut pieces) = ([Interval::zero(); 2], [Piece::default(); 64]);
            let mut stages = [Stage::default(); 64];
            let recorded = Subdivision::record(
                &program,
                domain,
                Mode::Certified,
                threshold,
                white.map(R::from_f64),
                R::from_f64(4.0 * unit),
                &mut pyramids.as_slice(),
                &mut stack,
                &mut pieces,
                &mut stages,
            )
            .unwrap();
            for part in [1e-3, 0.1, 1.0, 4.0] {
                let scale = R::from_f64(part * unit);
                let found = recorded.at_scale(scale);
                assert!(found.delta_e <= threshold, "1e{exponent}: {found:?}");
                let exact = truth.map(|v| v * scale.to_f64());
                let white = white.map(|w| R::from_f64(w).to_f64());
                let actual = distance(found.xyz.map(R::to_f64), exact, white);
                assert!(actual - doubt(exact, white) <= found.delta_e.to_f64(), "1e{exponent}");
            }
            // Brightness has its price: a dark pixel takes fewer intervals than a bright one.
            let intervals = |part: f64| recorded.at_scale(R::from_f64(part * unit)).intervals;
            assert!(intervals(1e-4) < intervals(4.0), "1e{exponent}");
        }
    });
}

#[test]
fn a_subdivision_serves_any_scale() {
    any_scale::<f32>(-30..=30);
    any_scale::<f64>(-30..=30);
    any_scale::<f64>(-200..=-190);
    any_scale::<f64>(190..=200);
}

/// A spectrum that is `value` on [from, to) nm and 1 elsewhere.
struct Spoilt {
    from: f64,
    to: f64,
    value: f64,
}

impl Spectrum<f64> for Spoilt {
    fn segment(&self, wavelength: f64) -> Segment<f64> {
        let (end, value) = if wavelength < self.from {
            (self.from, 1.0)
        } else if wavelength < self.to {
            (self.to, self.value)
        } else {
            (f64::INFINITY, 1.0)
        };
        Segment { end, first: value, last: value }
    }
}

#[test]
fn pyramids_refuse_what_is_not_finite() {
    with_domain::<f64>(|domain| {
        let build = |from, to, value| {
            let mut buffer = vec![Interval::zero(); node_count(DEPTH)];
            Pyramid::build(&Spoilt { from, to, value }, domain, &mut buffer).map(|p| p.depth())
        };
        for value in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, f64::MAX, f64::MIN] {
            for (from, to) in [(380.0, 380.1), (500.0, 500.5), (779.0, 780.0), (0.0, 1000.0)] {
                assert_eq!(build(from, to, value), Err(BuildError::NotFinite), "{value}, {from}");
            }
            for (from, to) in [(0.0, 380.0), (780.0, 800.0)] {
                assert_eq!(build(from, to, value), Ok(DEPTH), "{value} from {from} to {to}");
            }
        }
        assert_eq!(build(500.0, 600.0, 1e300), Ok(DEPTH));
    });
}

#[test]
fn domains_and_pyramids_say_what_they_lack() {
    let observer = Observer::<f64>::cie_1931_2deg();
    let needed = node_count(DEPTH);
    let mut weights = vec![Weight::default(); needed];
    let build =
        |depth, buffer: &mut [Weight<f64>]| Domain::build(observer, depth, buffer).map(|d| d.depth()).unwrap_err();
    assert_eq!(build(MAX_DEPTH + 1, &mut weights), BuildError::TooDeep);
    assert_eq!(build(255, &mut weights), BuildError::TooDeep);
    assert_eq!(build(DEPTH, &mut weights[1..]), BuildError::BufferTooSmall { needed });
    let domain = Domain::build(observer, DEPTH, &mut weights).unwrap();
    let mut short = vec![Interval::zero(); needed - 1];
    let flat = Constant::new(1.0).unwrap();
    let error = Pyramid::build(&flat, &domain, &mut short).unwrap_err();
    assert_eq!(error, BuildError::BufferTooSmall { needed });
}

#[test]
fn programs_say_what_is_wrong_with_them() {
    use ExpressionError::{Factor, Unbalanced, Underflow};
    let refused = |ops: &[Op<f64>]| Program::new(ops).map(|p| p.stack_size());
    let leaf = Op::Leaf(0);
    assert_eq!(refused(&[]), Err(Unbalanced));
    assert_eq!(refused(&[leaf, leaf]), Err(Unbalanced));
    assert_eq!(refused(&[leaf, Op::Deferred(1), leaf, Op::Sum]), Err(Unbalanced));
    for (index, ops) in [
        (0, &[Op::Sum][..]),
        (0, &[Op::Scale(1.0)]),
        (0, &[Op::Schlick(0.5)]),
        (1, &[leaf, Op::Product]),
        (3, &[leaf, leaf, Op::Sum, Op::Sum]),
    ] {
        assert_eq!(refused(ops), Err(Underflow { index }), "{ops:?}");
    }
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        assert_eq!(refused(&[leaf, Op::Scale(bad)]), Err(Factor { index: 1 }));
        assert_eq!(refused(&[leaf, Op::Schlick(bad)]), Err(Factor { index: 1 }));
    }
    for bad in [-f64::MIN_POSITIVE, -1.0, 1.0 + f64::EPSILON] {
        assert_eq!(refused(&[leaf, Op::Schlick(bad)]), Err(Factor { index: 1 }));
    }
    for good in [-0.0, 0.0, 1.0] {
        assert_eq!(refused(&[leaf, Op::Schlick(good)]), Ok(1));
    }
    assert_eq!(refused(&[leaf, leaf, leaf, Op::Product, Op::Sum, Op::Scale(-f64::MAX)]), Ok(3));
}

#[test]
fn evaluations_say_what_they_lack() {
    use ExpressionError::{MissingSource, NoPieces, StackTooSmall};
    with_domain::<f64>(|domain| {
        let mut buffer = vec![Interval::zero(); node_count(DEPTH)];
        let pyramids = [Pyramid::build(&Constant::new(0.5).unwrap(), domain, &mut buffer).unwrap()];
        let target = Target { mode: Mode::Certified, threshold: 1.0, white: [107.0; 3] };
        let mut cells = [0.0];
        let table = ThresholdTable::build(1, 1.0, target.white, &mut cells).unwrap();
        let run = |ops: &[Op<f64>], stack: usize, pieces: usize, stages: usize| {
            let program = Program::new(ops).unwrap();
            let mut stack = vec![Interval::zero(); stack];
            let mut pieces = vec![Piece::default(); pieces];
            let mut stages = vec![Stage::default(); stages];
            let sources = &mut pyramids.as_slice();
            let adaptive = evaluate(&program, domain, &target, sources, &mut stack, &mut pieces).map(|_| ());
            let tabled = evaluate_by_table(&program, domain, Mode::Certified, &table, sources, &mut stack, &mut pieces)
                .map(|_| ());
            let recorded = Subdivision::record(
                &program,
                domain,
                Mode::Certified,
                1.0,
                target.white,
                1.0,
                sources,
                &mut stack,
                &mut pieces,
                &mut stages,
            )
            .map(|_| ());
            let node =
                program.evaluate(Node::ROOT, &domain.weight(Node::ROOT), Order::First, sources, &mut stack).map(|_| ());
            [adaptive, tabled, recorded, node]
        };
        let (leaf, ops) = (Op::Leaf(0), [Op::Leaf(0), Op::Leaf(0), Op::Product]);
        assert_eq!(run(&ops, 2, 1, 1), [Ok(()); 4]);
        assert_eq!(run(&ops, 1, 1, 1), [Err(StackTooSmall { needed: 2 }); 4]);
        assert_eq!(run(&ops, 0, 1, 1), [Err(StackTooSmall { needed: 2 }); 4]);
        assert_eq!(run(&[leaf], 1, 0, 1), [Err(NoPieces), Err(NoPieces), Err(NoPieces), Ok(())]);
        assert_eq!(run(&[leaf], 1, 1, 0), [Ok(()), Ok(()), Err(NoPieces), Ok(())]);
        assert_eq!(run(&[Op::Leaf(1)], 1, 1, 1), [Err(MissingSource { id: 1 }); 4]);
        assert_eq!(run(&[Op::Deferred(7)], 1, 1, 1), [Err(MissingSource { id: 7 }); 4]);
        let below = Node::new(DEPTH + 1, 0).unwrap();
        let program = Program::new(core::slice::from_ref(&leaf)).unwrap();
        let mut stack = [Interval::zero()];
        let missing = program
            .evaluate(below, &domain.weight(below), Order::First, &mut pyramids.as_slice(), &mut stack)
            .unwrap_err();
        assert_eq!(missing, MissingSource { id: 0 });
    });
}

#[test]
fn every_error_says_something_of_its_own_in_one_line() {
    use ExpressionError::{Factor, MissingSource, NoPieces, StackTooSmall, Unbalanced, Underflow};
    let texts = [
        BuildError::TooDeep.to_string(),
        BuildError::BufferTooSmall { needed: 7 }.to_string(),
        BuildError::NotFinite.to_string(),
        Unbalanced.to_string(),
        Underflow { index: 7 }.to_string(),
        Factor { index: 7 }.to_string(),
        StackTooSmall { needed: 7 }.to_string(),
        MissingSource { id: 7 }.to_string(),
        NoPieces.to_string(),
        ObserverError::Grid.to_string(),
        ObserverError::Length.to_string(),
        ObserverError::Value { channel: 1, index: 7 }.to_string(),
    ];
    for (place, text) in texts.iter().enumerate() {
        assert!(!text.is_empty() && !text.contains('\n'));
        assert!(!texts[..place].contains(text), "{text}");
    }
    assert_eq!(texts.iter().filter(|text| text.contains('7')).count(), 6);
}

#[test]
fn observers_refuse_grids_on_which_a_walk_would_not_advance() {
    let ones = [1.0_f32; 500];
    let columns = [&ones[..]; 3];
    for step in [0.0, -1.0, f32::NAN, f32::INFINITY, 1e-6, 1e-4, f32::MAX] {
        assert_eq!(Observer::new(380.0, step, columns).unwrap_err(), ObserverError::Grid, "{step}");
    }
    assert_eq!(Observer::new(f32::NAN, 1.0, columns).unwrap_err(), ObserverError::Grid);
    assert_eq!(Observer::new(380.0, 1.0, [&ones[..1]; 3]).unwrap_err(), ObserverError::Length);
    assert_eq!(Observer::new(380.0, 1.0, [&ones, &ones, &ones[1..]]).unwrap_err(), ObserverError::Length);
    let mut bad = ones;
    bad[3] = -1.0;
    let error = Observer::new(380.0, 1.0, [&ones, &ones, &bad]).unwrap_err();
    assert_eq!(error, ObserverError::Value { channel: 2, index: 3 });
    // The finest step that is let through, and steps that are rounded: a walk ends, and finds the right area.
    for step in [0.001_f32, 0.1, 0.7] {
        let observer = Observer::new(379.9, step, columns).unwrap();
        let mut weights = [Weight::default(); node_count(0)];
        let domain = Domain::build(observer, 0, &mut weights).unwrap();
        let last = (379.9_f32 + step * 499.0).min(780.0);
        let area = f64::from(last) - 380.0;
        let found = f64::from(domain.weight(Node::ROOT).integral[0]);
        assert!((found - area).abs() <= 8.0 * f64::from(f32::EPSILON) * area, "{found}, {area}");
    }
}

/// A line where z̄ is a thousandth of x̄: m I_z is far greater than ∫Sz̄, and its rounding counts.
#[test]
fn a_channel_that_sees_little_of_a_line_has_a_radius_for_it() {
    with_domain::<f32>(|domain| {
        let observer = cie_1931().unwrap();
        for centre in [570.0_f32, 589.0, 600.0, 620.0, 640.0] {
            let line = Line::new(centre, 1.0, 3.0).unwrap();
            let nodes = [(centre - 0.5, 0.0), (centre, 6.0), (centre + 0.5, 0.0)];
            let truth = Polyline::new(&nodes.map(|(w, v)| (f64::from(w), v)), Beyond::Zero);
            let mut buffer = vec![Interval::zero(); node_count(DEPTH)];
            let pyramid = Pyramid::build(&line, domain, &mut buffer).unwrap();
            for node in spectral_core::interval::nodes(DEPTH) {
                let exact = Dense::new(&observer, &[&truth], node.limits(), 2).integrate::<f32>(&[Op::Leaf(0)]);
                let found = pyramid.get(node).unwrap();
                let xyz = found.tristimulus(&domain.weight(node));
                for (a, xyz) in xyz.into_iter().enumerate() {
                    let off = (f64::from(xyz) - exact.xyz[a]).abs();
                    assert!(off <= f64::from(found.radius[a]) + exact.error[a], "{centre}, {node:?}");
                }
            }
        }
    });
}

/// Spectra in units in which their squares underflow or overflow `f32`.
#[test]
fn the_unit_of_a_spectrum_is_of_no_account() {
    with_domain::<f32>(|domain| {
        let wavelengths = [380.0, 500.0, 520.0, 780.0];
        let of_unit = |unit: f32| {
            let values = [1.0, 0.2, 0.9, 0.4].map(|v| v * unit);
            let spectrum = PiecewiseLinear::new(&wavelengths, &values, Outside::Zero).unwrap();
            let mut buffer = vec![Interval::zero(); node_count(DEPTH)];
            let pyramid = Pyramid::build(&spectrum, domain, &mut buffer).unwrap();
            *pyramid.get(Node::ROOT).unwrap()
        };
        let one = of_unit(1.0);
        for unit in [1e-30_f32, 1e-20, 1e20, 1e30] {
            let other = of_unit(unit);
            for a in 0..3 {
                for (found, expected) in
                    [(other.norm[a], one.norm[a]), (other.absolute[a], one.absolute[a]), (other.mean, one.mean)]
                {
                    let ratio = found / unit / expected;
                    assert!(
                        (ratio - 1.0).abs() <= 64.0 * f32::EPSILON,
                        "{unit:e}, {a}: {found:e} {expected:e} {ratio}"
                    );
                }
            }
        }
    });
}

/// A constant's integral is that of the weight, whose rounding the radius has to cover on every part.
#[test]
fn a_constant_is_as_exact_as_the_weights() {
    with_domain::<f32>(|domain| {
        let observer = cie_1931().unwrap();
        for node in spectral_core::interval::nodes(DEPTH) {
            let one = Polyline::constant(1.0);
            let exact = Dense::new(&observer, &[&one], node.limits(), 1).integrate::<f32>(&[Op::Leaf(0)]);
            let weight = domain.weight(node);
            let found = Interval::constant(0.3_f32, &weight);
            for (a, xyz) in found.tristimulus(&weight).into_iter().enumerate() {
                let off = (f64::from(xyz) - exact.xyz[a] * f64::from(0.3_f32)).abs();
                assert!(off <= f64::from(found.radius[a]), "{node:?}, {a}");
                let least = 4.0 * f32::MIN_POSITIVE;
                assert!(found.radius[a] <= 16.0 * f32::EPSILON * xyz + least, "{node:?}, {a}");
            }
        }
    });
}

/// A flank that ends just after a boundary: what is left of it there is far less than the rounding error of its height.
#[test]
fn the_foot_of_a_flank_is_exact_relative_to_itself() {
    with_domain::<f32>(|domain| {
        let observer = cie_1931().unwrap();
        // 561.25 nm is a boundary at a depth of 8, and 2⁻¹³ nm are two units in the last place beyond it.
        let foot = 561.25 + 2.0_f32.powi(-13);
        for start in [400.3, 520.7, 551.9_f32] {
            let (wavelengths, values) = ([start, foot], [0.9, 0.0]);
            let flank = PiecewiseLinear::new(&wavelengths, &values, Outside::Zero).unwrap();
            let nodes = [(f64::from(start), f64::from(0.9_f32)), (f64::from(foot), 0.0)];
            let truth = Polyline::new(&nodes, Beyond::Zero);
            let mut buffer = vec![Interval::zero(); node_count(DEPTH)];
            let pyramid = Pyramid::build(&flank, domain, &mut buffer).unwrap();
            let node = Node::new(8, 116).unwrap();
            assert_eq!(node.limits::<f32>()[0], 561.25);
            let dense = Dense::new(&observer, &[&truth], node.limits(), 2);
            let exact = dense.integrate::<f32>(&[Op::Leaf(0)]).xyz;
            let found = pyramid.get(node).unwrap();
            for (a, xyz) in found.tristimulus(&domain.weight(node)).into_iter().enumerate() {
                assert!((f64::from(xyz) - exact[a]).abs() <= f64::from(found.radius[a]), "{start}");
                assert!(f64::from(found.radius[a]) <= 1e-5 * exact[1], "{start}");
            }
        }
    });
}

/// Whichever signs the limits have, both the least and the greatest product of values are in the range.
#[test]
fn ranges_of_products_hold_for_values_of_any_sign() {
    with_domain::<f64>(|domain| {
        let weight = domain.weight(Node::ROOT);
        let limits = [[-3.0, -1.0], [-3.0, 1.0], [-1.0, 3.0], [1.0, 3.0], [-2.0, 5.0]];
        for [a, b] in limits {
            for [c, d] in limits {
                let of = |low, high| Interval { low, high, ..Interval::zero() };
                let product = of(a, b).product(&of(c, d), &weight);
                let corners = [a * c, a * d, b * c, b * d];
                let (least, most) = corners.iter().fold((f64::MAX, f64::MIN), |(l, m), x| (x.min(l), x.max(m)));
                let name = format!("[{a}, {b}] [{c}, {d}]: {} to {}", product.low, product.high);
                assert!(product.low <= least && product.low >= least - 1e-13, "{name}");
                assert!(product.high >= most && product.high <= most + 1e-13, "{name}");
            }
        }
    });
}
