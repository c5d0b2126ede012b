//! Interval spectra: errors over the radii that are stated for them, and exactness where the operators are exact.

use spectral_core::adaptive::{Mode, Piece, Target, evaluate, evaluate_by_table};
use spectral_core::expression::{Op, Program};
use spectral_core::interval::{Domain, Interval, Node, Pyramid, Weight, node_count};
use spectral_core::spectrum::Outside;
use spectral_core::subdivision::{Stage, Subdivision};
use spectral_core::tables::{UniformTable, colorchecker, observers};
use spectral_core::threshold_table::ThresholdTable;
use spectral_core::{Observer, Real, Spectrum, bound};

use super::spectra::LIGHTS;
use crate::accuracy::gauge::{Axis, Gauge};
use crate::accuracy::lines::{Polyline, integral};
use crate::accuracy::wide::{Wide, wide, wides};

const DEPTH: u8 = 4;
const NODES: usize = node_count(DEPTH);
const PAINTS: [&UniformTable; 4] =
    [&colorchecker::GREEN, &colorchecker::RED, &colorchecker::BLUE, &colorchecker::DARK_SKIN];

/// A domain of 31 parts, and the colour-matching functions.
fn with_domain<R: Real>(each: impl FnOnce(&Domain<'_, R>, &[Polyline; 3])) {
    let mut weights = [Weight::default(); NODES];
    if let Ok(domain) = Domain::build(Observer::cie_1931_2deg(), DEPTH, &mut weights) {
        each(&domain, &Polyline::of_observer(&observers::CIE_1931_2));
    }
}

fn parts() -> impl Iterator<Item = Node> {
    spectral_core::interval::nodes(DEPTH)
}

/// ∫ of a product over a part.
fn exactly(factors: &[&Polyline], cmf: &[Polyline; 3], node: Node) -> [Wide; 3] {
    let limits = node.limits::<f64>();
    cmf.each_ref().map(|cmf| {
        let all: Vec<&Polyline> = factors.iter().copied().chain([cmf]).collect();
        integral(&all, limits)
    })
}

const ALL: &str = "D65, A, FL2, FL11, HP1 and four ColorChecker patches on 31 parts of 380–780 nm";

/// Calls for each light and paint on each part.
fn each_pair<R: Real>(
    gauge: &mut Gauge,
    mut measure: impl FnMut(&mut Gauge, &Domain<'_, R>, Node, [Interval<R>; 2], [&dyn Spectrum<R>; 2], [Wide; 3]),
) {
    gauge.note(ALL);
    with_domain::<R>(|domain, cmf| {
        for light in LIGHTS {
            for paint in PAINTS {
                let spectra = (light.spectrum::<R>(Outside::Zero), paint.spectrum::<R>(Outside::Hold));
                let lines = (Polyline::of_table(light, false), Polyline::of_table(paint, true));
                for node in parts() {
                    let own = [
                        Interval::of_spectrum(&spectra.0, domain, node),
                        Interval::of_spectrum(&spectra.1, domain, node),
                    ];
                    let exact = exactly(&[&lines.0, &lines.1], cmf, node);
                    measure(gauge, domain, node, own, [&spectra.0, &spectra.1], exact);
                }
            }
        }
    });
}

/// An interval's tristimulus values over its radius.
fn over_radius<R: Real>(gauge: &mut Gauge, interval: &Interval<R>, weight: &Weight<R>, exact: [Wide; 3]) {
    for ((got, exact), radius) in interval.tristimulus(weight).into_iter().zip(exact).zip(interval.radius) {
        gauge.compare_to(got, exact, wide(radius));
    }
}

/// I_a, its reciprocal and its root.
pub fn weights<R: Real>(gauge: &mut Gauge) {
    gauge.note("31 parts of 380–780 nm");
    with_domain::<R>(|domain, cmf| {
        for node in parts() {
            let (weight, exact) = (domain.weight(node), exactly(&[], cmf, node));
            for (a, exact) in exact.into_iter().enumerate() {
                gauge.compare(weight.integral[a], exact);
                gauge.compare(weight.root[a], exact.sqrt());
                if exact > 0.0 {
                    gauge.compare(weight.inverse[a], 1.0 / exact);
                }
            }
        }
    });
}

/// Limits in nm.
pub fn limits<R: Real>(gauge: &mut Gauge) {
    gauge.note("8191 parts of 380–780 nm");
    for node in spectral_core::interval::nodes(12) {
        let width = Wide::from(400.0) / f64::from(1_u32 << node.level());
        let first = width * f64::from(node.index()) + 380.0;
        gauge.compare_all(node.limits::<R>(), [first, first + width]);
    }
}

/// A leaf.
pub fn of_spectrum<R: Real>(gauge: &mut Gauge) {
    gauge.note(ALL);
    with_domain::<R>(|domain, cmf| {
        let lights = LIGHTS.iter().map(|table| (table, false));
        for (table, hold) in lights.chain(PAINTS.iter().map(|table| (table, true))) {
            let spectrum = table.spectrum::<R>(if hold { Outside::Hold } else { Outside::Zero });
            let line = Polyline::of_table(table, hold);
            for node in parts() {
                let interval = Interval::of_spectrum(&spectrum, domain, node);
                over_radius(gauge, &interval, &domain.weight(node), exactly(&[&line], cmf, node));
            }
        }
    });
}

/// A product, integrated.
pub fn of_product<R: Real>(gauge: &mut Gauge) {
    each_pair(gauge, |gauge, domain: &Domain<'_, R>, node, own, spectra, exact| {
        let weight = domain.weight(node);
        let product = Interval::of_product(&spectra, domain, node, &own[0].product(&own[1], &weight));
        over_radius(gauge, &product, &weight, exact);
    });
}

/// A product by the operator: what the first and the second order leave, over the bound of it.
pub fn product<R: Real>(gauge: &mut Gauge) {
    each_pair(gauge, |gauge, domain: &Domain<'_, R>, node, own, _, exact| {
        let weight = domain.weight(node);
        over_radius(gauge, &own[0].product(&own[1], &weight), &weight, exact);
    });
}

/// Measures an operator that is linear in two leaves: the exact integrals are `combine` of the leaves' and of the weights.
fn linear<R: Real>(
    gauge: &mut Gauge,
    operate: impl Fn([Interval<R>; 2], &Weight<R>) -> Interval<R>,
    combine: impl Fn([Wide; 2], Wide) -> Wide,
) {
    gauge.note(ALL);
    with_domain::<R>(|domain, cmf| {
        for (light, paint) in LIGHTS.iter().zip(PAINTS.iter().cycle()) {
            let spectra = (light.spectrum::<R>(Outside::Zero), paint.spectrum::<R>(Outside::Hold));
            let lines = (Polyline::of_table(light, false), Polyline::of_table(paint, true));
            for node in parts() {
                let own =
                    [Interval::of_spectrum(&spectra.0, domain, node), Interval::of_spectrum(&spectra.1, domain, node)];
                let (a, b) = (exactly(&[&lines.0], cmf, node), exactly(&[&lines.1], cmf, node));
                let ones = exactly(&[], cmf, node);
                let weight = domain.weight(node);
                let exact = core::array::from_fn(|c| combine([a[c], b[c]], ones[c]));
                over_radius(gauge, &operate(own, &weight), &weight, exact);
            }
        }
    });
}

/// S₁ + S₂.
pub fn sum<R: Real>(gauge: &mut Gauge) {
    linear::<R>(gauge, |[a, b], weight| a.sum(&b, weight), |[a, b], _| a + b);
}

/// −0.3 S.
pub fn scale<R: Real>(gauge: &mut Gauge) {
    let factor = R::from_f64(-0.3);
    linear::<R>(gauge, |[a, _], weight| a.scale(factor, weight), |[a, _], _| a * wide(factor));
}

/// S + (1 − S) f.
pub fn schlick<R: Real>(gauge: &mut Gauge) {
    let factor = R::from_f64(0.2);
    let exact = |[_, b]: [Wide; 2], one: Wide| b + (one - b) * wide(factor);
    linear::<R>(gauge, |[_, b], weight| b.schlick(factor, weight), exact);
}

/// A constant.
pub fn constant<R: Real>(gauge: &mut Gauge) {
    let value = R::from_f64(0.7);
    linear::<R>(gauge, |_, weight| Interval::constant(value, weight), |_, one| one * wide(value));
}

/// m I and m I + e, in ULP of their terms.
fn measure_tristimulus<R: Real>(
    gauge: &mut Gauge,
    function: impl Fn(&Interval<R>, &Weight<R>) -> [R; 3],
    first_order: bool,
) {
    each_pair(gauge, |gauge, domain: &Domain<'_, R>, node, own, _, _| {
        let weight = domain.weight(node);
        for interval in own {
            for (a, got) in function(&interval, &weight).into_iter().enumerate() {
                let (mean, error) = (wide(interval.mean) * wide(weight.integral[a]), wide(interval.error[a]));
                let exact = if first_order { mean + error } else { mean };
                gauge.compare_to(got, exact, mean.abs() + error.abs());
            }
        }
    });
}

/// m I + e.
pub fn tristimulus<R: Real>(gauge: &mut Gauge) {
    measure_tristimulus::<R>(gauge, Interval::tristimulus, true);
}

/// m I.
pub fn mean_tristimulus<R: Real>(gauge: &mut Gauge) {
    measure_tristimulus::<R>(gauge, Interval::mean_tristimulus, false);
}

/// sup |S − m|, which may not be less than exact.
pub fn deviation<R: Real>(gauge: &mut Gauge) {
    each_pair(gauge, |gauge, _: &Domain<'_, R>, _, own, _, _| {
        for interval in own {
            let exact = (wide(interval.high) - wide(interval.mean)).max(wide(interval.mean) - wide(interval.low));
            gauge.require(wide(interval.deviation()) >= exact);
            gauge.compare_to(interval.deviation(), exact, exact.max(wide(R::MIN_POSITIVE)));
        }
    });
}

/// Measures the first-order operators, means and errors, in ULP of their terms.
fn first_order<R: Real>(
    gauge: &mut Gauge,
    operate: impl Fn(&Interval<R>, &Interval<R>) -> Interval<R>,
    exact: impl Fn([Wide; 2], [Wide; 2]) -> [[Wide; 2]; 2],
) {
    each_pair(gauge, |gauge, _: &Domain<'_, R>, _, [a, b], _, _| {
        let result = operate(&a, &b);
        for c in 0..3 {
            let [mean, error] = exact(wides([a.mean, b.mean]), wides([a.error[c], b.error[c]]));
            gauge.compare_to(result.mean, mean[0], mean[1]);
            gauge.compare_to(result.error[c], error[0], error[1]);
        }
    });
}

/// m₁m₂ and m₁e₂ + m₂e₁.
pub fn product_first_order<R: Real>(gauge: &mut Gauge) {
    first_order::<R>(gauge, Interval::product_first_order, |[m, n], [e, f]| {
        [[m * n, m * n], [m * f + n * e, (m * f).abs() + (n * e).abs()]]
    });
}

/// m₁ + m₂ and e₁ + e₂.
pub fn sum_first_order<R: Real>(gauge: &mut Gauge) {
    first_order::<R>(gauge, Interval::sum_first_order, |[m, n], [e, f]| [[m + n, m + n], [e + f, e.abs() + f.abs()]]);
}

/// c m and c e.
pub fn scale_first_order<R: Real>(gauge: &mut Gauge) {
    let c = R::from_f64(0.3);
    first_order::<R>(
        gauge,
        |a, _| a.scale_first_order(c),
        |[m, _], [e, _]| {
            let c = wide(c);
            [[m * c, m * c], [e * c, e * c]]
        },
    );
}

/// m + (1 − m) f and (1 − f) e.
pub fn schlick_first_order<R: Real>(gauge: &mut Gauge) {
    let f = R::from_f64(0.3);
    first_order::<R>(
        gauge,
        |_, b| b.schlick_first_order(f),
        |[_, n], [_, e]| {
            let f = wide(f);
            let mean = n + (1.0 - n) * f;
            [[mean, n.abs() + f], [e * (1.0 - f), e * (1.0 - f)]]
        },
    );
}

/// A light times a paint as a program, to a threshold; the colour's error over its radius.
fn evaluations<R: Real>(
    gauge: &mut Gauge,
    mut run: impl FnMut(&Domain<'_, R>, &Program<'_, R>, [R; 3], &mut [Pyramid<'_, R>]) -> Option<([R; 3], [R; 3])>,
) {
    gauge.note("D65, A, FL2, FL11, HP1 times four ColorChecker patches");
    with_domain::<R>(|domain, cmf| {
        let ops = [Op::Leaf(0), Op::Leaf(1), Op::Product];
        let Ok(program) = Program::new(&ops) else { return gauge.require(false) };
        for (light, paint) in LIGHTS.iter().flat_map(|light| PAINTS.iter().map(move |paint| (light, paint))) {
            let spectra = (light.spectrum::<R>(Outside::Zero), paint.spectrum::<R>(Outside::Hold));
            let mut buffers = [[Interval::zero(); NODES]; 2];
            let [first, second] = &mut buffers;
            let leaves = (Pyramid::build(&spectra.0, domain, first), Pyramid::build(&spectra.1, domain, second));
            let (Ok(a), Ok(b)) = leaves else { return gauge.require(false) };
            let white =
                spectral_core::tristimulus(domain.observer(), &spectra.0, R::from_f64(380.0), R::from_f64(780.0));
            let lines = (Polyline::of_table(light, false), Polyline::of_table(paint, true));
            let exact = exactly(&[&lines.0, &lines.1], cmf, Node::ROOT);
            let Some((xyz, radius)) = run(domain, &program, white, &mut [a, b]) else { return gauge.require(false) };
            for a in 0..3 {
                gauge.compare_to(xyz[a], exact[a], wide(radius[a]));
            }
        }
    });
}

fn target<R: Real>(white: [R; 3]) -> Target<R> {
    Target { mode: Mode::Certified, threshold: R::ONE, white }
}

/// To a bound of ΔE*ab 1.
pub fn evaluated<R: Real>(gauge: &mut Gauge) {
    evaluations(gauge, |domain: &Domain<'_, R>, program, white, leaves| {
        let (mut stack, mut pieces) = ([Interval::zero(); 4], [Piece::default(); 64]);
        let mut sources: &[Pyramid<'_, R>] = leaves;
        let found = evaluate(program, domain, &target(white), &mut sources, &mut stack, &mut pieces).ok()?;
        Some((found.xyz, found.radius))
    });
}

/// To the tolerances of a table.
pub fn evaluated_by_table<R: Real>(gauge: &mut Gauge) {
    evaluations(gauge, |domain: &Domain<'_, R>, program, white, leaves| {
        let (mut stack, mut pieces) = ([Interval::zero(); 4], [Piece::default(); 64]);
        let mut cells = [R::ZERO; 64];
        let table = ThresholdTable::build(4, R::ONE, white, &mut cells)?;
        let mut sources: &[Pyramid<'_, R>] = leaves;
        let found =
            evaluate_by_table(program, domain, Mode::Certified, &table, &mut sources, &mut stack, &mut pieces).ok()?;
        Some((found.xyz, found.radius))
    });
}

/// A recorded subdivision at scale 1.
pub fn recorded<R: Real>(gauge: &mut Gauge) {
    evaluations(gauge, |domain: &Domain<'_, R>, program, white, leaves| {
        let (mut stack, mut pieces) = ([Interval::zero(); 4], [Piece::default(); 64]);
        let mut stages = [Stage::default(); 64];
        let mut sources: &[Pyramid<'_, R>] = leaves;
        let found = Subdivision::record(
            program,
            domain,
            Mode::Certified,
            R::ONE,
            white,
            R::ONE,
            &mut sources,
            &mut stack,
            &mut pieces,
            &mut stages,
        )
        .ok()?;
        let colour = found.at_scale(R::ONE);
        Some((colour.xyz, colour.radius))
    });
}

/// The largest ΔE*ab over the box's corners, exactly.
fn corners(xyz: [Wide; 3], radius: [Wide; 3], white: [Wide; 3]) -> Wide {
    let f = |t: Wide| {
        let delta = Wide::from(6.0) / 29.0;
        if t > delta.powi(3) { t.cbrt() } else { t / (delta.squared() * 3.0) + Wide::from(4.0) / 29.0 }
    };
    let lab = |xyz: [Wide; 3]| {
        let [x, y, z]: [Wide; 3] = core::array::from_fn(|a| f(xyz[a] / white[a]));
        [y * 116.0, (x - y) * 500.0, (y - z) * 200.0]
    };
    let centre = lab(xyz);
    (0..8).fold(Wide::ZERO, |most, bits| {
        let corner =
            lab(core::array::from_fn(|a| if bits >> a & 1 == 0 { xyz[a] - radius[a] } else { xyz[a] + radius[a] }));
        let square = (0..3).fold(Wide::ZERO, |sum, i| sum + (corner[i] - centre[i]).squared());
        most.max(square.sqrt())
    })
}

/// What a bound has above the exact one, which it may not be below.
fn measure_bound<R: Real>(gauge: &mut Gauge, function: impl Fn([R; 3], [R; 3], [R; 3]) -> R) {
    let colour = |name| Axis::log(name, 1e-4, 2.0).list(&[0.0, 216.0 / 24_389.0, 1.0]);
    let radius = |name| Axis::log(name, 1e-4, 0.1);
    let [x, y, z] = ["X", "Y", "Z"].map(colour);
    let [p, q, r] = ["r_X", "r_Y", "r_Z"].map(radius);
    gauge.effort(2.0);
    gauge.each(&[x, y, z, p, q, r], |gauge, [x, y, z, p, q, r]: [R; 6]| {
        let white = [0.95, 1.0, 1.09].map(R::from_f64);
        let (xyz, radius) = ([x, y, z], [p, q, r]);
        let (got, exact) = (function(xyz, radius, white), corners(wides(xyz), wides(radius), wides(white)));
        gauge.require(wide(got) >= exact);
        gauge.compare(got, exact);
    });
}

/// The bound at the corners.
pub fn delta_e_bound<R: Real>(gauge: &mut Gauge) {
    measure_bound::<R>(gauge, |xyz, radius, white| bound::delta_e_bound(xyz, radius, white).delta_e);
}

/// The monotone bound.
pub fn delta_e_majorant<R: Real>(gauge: &mut Gauge) {
    measure_bound::<R>(gauge, bound::delta_e_majorant);
}

/// Tolerances of a table of 4³ cells for ΔE*ab 1: the largest difference that one admits, over the threshold.
pub fn threshold_tolerance<R: Real>(gauge: &mut Gauge) {
    let white = [0.95, 1.0, 1.09].map(R::from_f64);
    let mut cells = [R::ZERO; 64];
    let Some(table) = ThresholdTable::build(4, R::ONE, white, &mut cells) else { return gauge.require(false) };
    let axes = ["X", "Y", "Z"].map(|name| Axis::linear(name, 0.0, 1.2).edges(&[0.25, 0.5, 0.75]));
    gauge.each(&axes, |gauge, xyz: [R; 3]| {
        let tolerance = table.tolerance(xyz);
        let radius = white.map(|w| wide(w) * wide(tolerance));
        gauge.record(corners(wides(xyz), radius, wides(white)).to_f64());
    });
}
