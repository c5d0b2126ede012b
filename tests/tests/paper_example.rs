//! Iehl and Péroche's own example, and the tristimulus values of lights whose white points are published.
#![allow(clippy::unwrap_used, reason = "a test stops at the first thing that should not be")]

use spectral_core::adaptive::{Evaluation, Mode, Piece, Target, evaluate};
use spectral_core::expression::{Op, Program};
use spectral_core::interval::{Domain, Interval, Node, Pyramid, Weight, node_count};
use spectral_core::spectrum::{Outside, Planck, RadiationConstant};
use spectral_core::tables::{UniformTable, colorchecker, find_light};
use spectral_core::{Observer, Real, Spectrum, tristimulus};
use spectral_tests::dense::{Beyond, Dense, Polyline, cie_1931};

const DEPTH: u8 = 10;

fn pyramid<'a, R: Real>(
    table: &UniformTable,
    domain: &Domain<'_, R>,
    buffer: &'a mut Vec<Interval<R>>,
) -> Pyramid<'a, R> {
    buffer.resize(node_count(DEPTH), Interval::zero());
    Pyramid::build(&table.spectrum(Outside::Hold), domain, buffer).unwrap()
}

/// The evaluations of D65 times each of the patches, with D65's own white over 380–780 nm.
fn patches<R: Real>(patches: &[UniformTable], mode: Mode, threshold: f64) -> Vec<Evaluation<R>> {
    let mut weights = vec![Weight::default(); node_count(DEPTH)];
    let domain = Domain::build(Observer::cie_1931_2deg(), DEPTH, &mut weights).unwrap();
    let mut buffer = Vec::new();
    let light = pyramid(find_light("D65").unwrap(), &domain, &mut buffer);
    let white = light.get(Node::ROOT).unwrap().tristimulus(&domain.weight(Node::ROOT));
    let target = Target { mode, threshold: R::from_f64(threshold), white };
    let ops = [Op::Leaf(0), Op::Leaf(1), Op::Product];
    let program = Program::new(&ops).unwrap();
    let evaluate_patch = |table: &UniformTable| {
        let mut buffer = Vec::new();
        let pyramids = [light, pyramid(table, &domain, &mut buffer)];
        let mut stack = [Interval::zero(); 2];
        let mut pieces = [Piece::default(); 64];
        let sources = &mut pyramids.as_slice();
        evaluate(&program, &domain, &target, sources, &mut stack, &mut pieces).unwrap()
    };
    patches.iter().map(evaluate_patch).collect()
}

fn mean_intervals<R: Real>(threshold: f64) -> f64 {
    let evaluations = patches::<R>(&colorchecker::ALL, Mode::Certified, threshold);
    assert_eq!(evaluations.len(), 24);
    assert!(evaluations.iter().all(|e| e.delta_e <= R::from_f64(threshold)));
    let intervals: usize = evaluations.iter().map(|e| e.intervals).sum();
    f64::from(u32::try_from(intervals).unwrap()) / 24.0
}

fn intervals_of_green<R: Real>(mode: Mode) -> usize {
    let green = &colorchecker::ALL[13];
    assert_eq!(green.name, "green");
    patches::<R>(core::slice::from_ref(green), mode, 3.0)[0].intervals
}

/// `published`: figure 5 of Iehl and Péroche (2000) shows nine intervals for D65 on ColorChecker green at threshold 3.
#[test]
fn green_under_d65_takes_the_papers_nine_intervals_or_three_certified_ones() {
    assert_eq!(intervals_of_green::<f64>(Mode::Paper), 9);
    assert_eq!(intervals_of_green::<f32>(Mode::Paper), 9);
    assert!(intervals_of_green::<f64>(Mode::Certified) <= 3);
    assert!(intervals_of_green::<f32>(Mode::Certified) <= 3);
}

#[test]
fn the_colour_checker_under_d65_takes_few_intervals() {
    let mean = [3.0, 1.0].map(|threshold| [mean_intervals::<f32>(threshold), mean_intervals::<f64>(threshold)]);
    println!("mean certified intervals at thresholds 3 and 1: {mean:?}");
    assert!(mean[0].iter().all(|m| *m <= 2.6) && mean[1].iter().all(|m| *m <= 4.9), "{mean:?}");
}

/// The white point over 360–830 nm relative to Y = 1, and its chromaticity.
fn white<S: Spectrum<f64> + ?Sized>(light: &S) -> ([f64; 3], [f64; 2]) {
    let [x, y, z] = tristimulus(&Observer::cie_1931_2deg(), light, 360.0, 830.0);
    ([x / y, 1.0, z / y], [x / (x + y + z), y / (x + y + z)])
}

fn assert_printed<const N: usize>(name: &str, found: [f64; N], printed: [f64; N], half_unit: f64) {
    for (value, printed) in found.iter().zip(printed) {
        assert!((value - printed).abs() <= half_unit, "{name}: {found:?}, printed {printed}");
    }
}

/// Illuminant A by its definition: Planck's law at 2848 K on the scale of 1931, at 1 nm.
fn illuminant_a() -> Planck<f64> {
    Planck::new(2848.0, RadiationConstant::Cie1931).unwrap()
}

/// `published`: CIE 15:2004, table T.3, to four digits; the fifth depends on the range and the step of the sums. The D illuminants
/// and C are linear between their nodes at 5 nm.
#[test]
fn illuminants_have_their_published_chromaticities() {
    let published = [
        ("D50", [0.3457, 0.3585]),
        ("D55", [0.3324, 0.3474]),
        ("D65", [0.3127, 0.3290]),
        ("D75", [0.2990, 0.3149]),
        ("C", [0.3101, 0.3162]),
    ];
    for (name, printed) in published {
        let light = find_light(name).unwrap().spectrum::<f64>(Outside::Zero);
        assert_printed(name, white(&light).1, printed, 5e-5);
    }
    assert_printed("A", white(&illuminant_a()).1, [0.4476, 0.4074], 5e-5);
}

/// The white point by sums of values at whole nanometres over 360–830 nm.
fn white_by_sums(light: &impl Spectrum<f64>) -> [f64; 3] {
    let observer = Observer::cie_1931_2deg();
    let mut sums = [0.0; 3];
    for nanometre in 360..=830 {
        let w = f64::from(nanometre);
        for (sum, cmf) in sums.iter_mut().zip(observer.value(w)) {
            *sum += light.value(w) * cmf;
        }
    }
    sums.map(|s| s / sums[1])
}

/// `published`: ASTM E308-01, table 5, whose five digits are of sums at 1 nm over 360–830 nm; integrals of the piecewise linear
/// functions differ from the sums by 1.3e-5.
#[test]
fn d65_and_a_have_their_published_tristimulus_values() {
    let d65 = find_light("D65").unwrap().spectrum::<f64>(Outside::Zero);
    assert_printed("D65", white_by_sums(&d65), [0.950_47, 1.0, 1.088_83], 5e-6);
    assert_printed("A", white_by_sums(&illuminant_a()), [1.098_50, 1.0, 0.355_85], 5e-6);
    assert_printed("D65", white(&d65).0, [0.9505, 1.0, 1.0888], 5e-5);
    assert_printed("A", white(&illuminant_a()).0, [1.0985, 1.0, 0.3559], 5e-5);
}

/// `independent`: what a leaf keeps at the root, from dense integration: the mean of Iehl and Péroche's equation 1 and the
/// first-order errors of equation 2.
#[test]
fn a_leaf_has_the_mean_and_errors_of_the_papers_equations() {
    let file = "cie_illuminants_A_D50_D55_D65_D75_C_5nm.csv";
    let truth = Polyline::read(file, "D65", Beyond::Hold).unwrap();
    let observer = cie_1931().unwrap();
    let dense = Dense::new(&observer, &[&truth], [380.0, 780.0], 2).moments::<f64>(&[Op::Leaf(0)]);
    let (i, v) = (dense.weight, dense.integral.xyz);
    let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let mean = dot(i, v) / dot(i, i);

    let mut weights = vec![Weight::<f64>::default(); node_count(DEPTH)];
    let domain = Domain::build(Observer::cie_1931_2deg(), DEPTH, &mut weights).unwrap();
    let mut buffer = Vec::new();
    let root = *pyramid(find_light("D65").unwrap(), &domain, &mut buffer).get(Node::ROOT).unwrap();
    // Sums of a thousand terms each; 64 ε is twice the margin that the leaf itself claims.
    assert!((root.mean - mean).abs() <= 64.0 * f64::EPSILON * mean);
    for a in 0..3 {
        let error = v[a] - mean * i[a];
        assert!((root.error[a] - error).abs() <= 64.0 * f64::EPSILON * v[a], "{root:?}");
        assert!(root.radius[a] <= 64.0 * f64::EPSILON * v[a], "{root:?}");
    }
}
