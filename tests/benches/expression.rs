//! What one rendering expression of one pixel costs, in each representation of spectra: times are per expression.
//!
//! The expressions are those of a Cornell box's pixels: D65 on one ColorChecker patch, on two of them (light that was reflected
//! once more), and the sum of these with an ambient term. Every pixel has its own scale, so that nothing is computed
//! once for all.
#![allow(clippy::unwrap_used, reason = "nothing is measured when the set-up fails")]

use divan::{Bencher, black_box};
use spectral_core::adaptive::{Mode, Piece, Target, evaluate};
use spectral_core::expression::{Op, Program};
use spectral_core::interval::{Domain, Interval, Node, Pyramid, Weight, node_count};
use spectral_core::spectrum::Outside;
use spectral_core::subdivision::{Stage, Subdivision};
use spectral_core::tables::{UniformTable, colorchecker, find_light};
use spectral_core::{Observer, tristimulus};

fn main() {
    divan::main();
}

/// Scales of successive pixels, relative to white; samples are whole rounds of these.
const SCALES: [f64; 8] = [0.9, 0.35, 0.6, 0.2, 0.75, 0.5, 0.1, 0.4];
const DEPTH: u8 = 8;
const THRESHOLDS: [f64; 2] = [1.0, 3.0];

/// Which expression.
#[derive(Clone, Copy, Debug)]
enum Case {
    OnePatch,
    TwoPatches,
    Ambient,
}

const CASES: [Case; 3] = [Case::OnePatch, Case::TwoPatches, Case::Ambient];

impl Case {
    /// The program at a scale; leaves are D65 and two patches.
    fn ops(self, scale: f64) -> Vec<Op<f64>> {
        let one = [Op::Leaf(0), Op::Leaf(1), Op::Product, Op::Scale(scale)];
        let two = [Op::Leaf(0), Op::Leaf(1), Op::Product, Op::Leaf(2), Op::Product, Op::Scale(scale)];
        let ambient = [Op::Leaf(0), Op::Leaf(1), Op::Product, Op::Scale(0.1 * scale), Op::Sum];
        match self {
            Self::OnePatch => one.to_vec(),
            Self::TwoPatches => two.to_vec(),
            Self::Ambient => [&two[..], &ambient].concat(),
        }
    }
}

/// All pairs of a case and a threshold.
fn settings() -> impl Iterator<Item = (Case, f64)> {
    CASES.into_iter().flat_map(|case| THRESHOLDS.map(|threshold| (case, threshold)))
}

/// D65, ColorChecker green and moderate red.
fn tables() -> [&'static UniformTable; 3] {
    let [light, green, red] = [find_light("D65").unwrap(), &colorchecker::ALL[13], &colorchecker::ALL[8]];
    [light, green, red]
}

/// Builds the pyramids and hands them over with the domain and white.
fn with_pyramids(run: impl FnOnce(&Domain<'_, f64>, &[Pyramid<'_, f64>], [f64; 3])) {
    let mut weights = vec![Weight::default(); node_count(DEPTH)];
    let domain = Domain::build(Observer::cie_1931_2deg(), DEPTH, &mut weights).unwrap();
    let mut buffers = vec![vec![Interval::zero(); node_count(DEPTH)]; 3];
    let pyramids: Vec<_> = buffers
        .iter_mut()
        .zip(tables())
        .map(|(buffer, table)| Pyramid::build(&table.spectrum(Outside::Hold), &domain, buffer).unwrap())
        .collect();
    let white = pyramids[0].get(Node::ROOT).unwrap().tristimulus(&domain.weight(Node::ROOT));
    run(&domain, &pyramids, white);
}

fn adaptive(bencher: Bencher<'_, '_>, mode: Mode, case: Case, threshold: f64) {
    with_pyramids(|domain, pyramids, white| {
        let ops = SCALES.map(|scale| case.ops(scale));
        let programs: Vec<_> = ops.iter().map(|ops| Program::new(ops).unwrap()).collect();
        let target = Target { mode, threshold, white };
        let mut stack = [Interval::zero(); 4];
        let mut pieces = [Piece::default(); 64];
        let mut pixel = 0;
        bencher.bench_local(|| {
            pixel = (pixel + 1) % SCALES.len();
            let program = black_box(&programs[pixel]);
            evaluate(program, domain, &target, &mut &*pyramids, &mut stack, &mut pieces)
        });
    });
}

#[divan::bench(args = settings(), sample_size = 800)]
fn certified(bencher: Bencher<'_, '_>, (case, threshold): (Case, f64)) {
    adaptive(bencher, Mode::Certified, case, threshold);
}

#[divan::bench(args = settings(), sample_size = 800)]
fn paper(bencher: Bencher<'_, '_>, (case, threshold): (Case, f64)) {
    adaptive(bencher, Mode::Paper, case, threshold);
}

/// A look-up in a recorded subdivision, with the bound of what it finds.
#[divan::bench(args = settings(), sample_size = 800)]
fn subdivision(bencher: Bencher<'_, '_>, (case, threshold): (Case, f64)) {
    with_pyramids(|domain, pyramids, white| {
        let ops = case.ops(1.0);
        let program = Program::new(&ops).unwrap();
        let (mut stack, mut pieces) = ([Interval::zero(); 4], [Piece::default(); 64]);
        let mut stages = [Stage::default(); 64];
        let recorded = Subdivision::record(
            &program,
            domain,
            Mode::Certified,
            threshold,
            white,
            1.0,
            &mut &*pyramids,
            &mut stack,
            &mut pieces,
            &mut stages,
        )
        .unwrap();
        let mut pixel = 0;
        bencher.bench_local(|| {
            pixel = (pixel + 1) % SCALES.len();
            recorded.at_scale(black_box(SCALES[pixel]))
        });
    });
}

/// 81 bins with each spectrum's mean: a loop over the bins for the product, and three dot products.
#[divan::bench(args = CASES, sample_size = 8000)]
fn uniform_81(bencher: Bencher<'_, '_>, case: Case) {
    const BINS: usize = 81;
    let observer = Observer::<f64>::cie_1931_2deg();
    let width = 400.0 / 81.0;
    let limits = |bin: usize| {
        let from = 380.0 + width * f64::from(u32::try_from(bin).unwrap());
        (from, from + width)
    };
    // Means of the spectra weighted by ȳ serve as well as any here.
    let [light, first, second] = tables().map(|table| {
        core::array::from_fn::<f64, BINS, _>(|bin| {
            let (from, to) = limits(bin);
            let one = spectral_core::spectrum::Constant::new(1.0).unwrap();
            tristimulus(&observer, &table.spectrum(Outside::Hold), from, to)[1]
                / tristimulus(&observer, &one, from, to)[1]
        })
    });
    let cmf: [[f64; BINS]; 3] = core::array::from_fn(|a| {
        core::array::from_fn(|bin| {
            let (from, to) = limits(bin);
            tristimulus(&observer, &spectral_core::spectrum::Constant::new(1.0).unwrap(), from, to)[a]
        })
    });
    let mut pixel = 0;
    bencher.bench_local(|| {
        pixel = (pixel + 1) % SCALES.len();
        let scale = black_box(SCALES[pixel]);
        let (light, first, second) = (black_box(&light), black_box(&first), black_box(&second));
        let mut radiance = [0.0; BINS];
        for bin in 0..BINS {
            radiance[bin] = match case {
                Case::OnePatch => light[bin] * first[bin] * scale,
                Case::TwoPatches => light[bin] * first[bin] * second[bin] * scale,
                Case::Ambient => light[bin] * first[bin] * (second[bin] * scale + 0.1 * scale),
            };
        }
        let mut xyz = [0.0; 3];
        for (sum, weights) in xyz.iter_mut().zip(black_box(&cmf)) {
            *sum = weights.iter().zip(&radiance).map(|(w, v)| w * v).sum();
        }
        xyz
    });
}

/// Three components: their products.
#[divan::bench(args = CASES, sample_size = 8000)]
fn rgb(bencher: Bencher<'_, '_>, case: Case) {
    let [light, first, second] = [[0.95, 1.0, 1.09], [0.15, 0.24, 0.10], [0.31, 0.20, 0.14]];
    let mut pixel = 0;
    bencher.bench_local(|| {
        pixel = (pixel + 1) % SCALES.len();
        let scale = black_box(SCALES[pixel]);
        let (light, first, second): ([f64; 3], [f64; 3], [f64; 3]) =
            (black_box(light), black_box(first), black_box(second));
        core::array::from_fn::<f64, 3, _>(|c| match case {
            Case::OnePatch => light[c] * first[c] * scale,
            Case::TwoPatches => light[c] * first[c] * second[c] * scale,
            Case::Ambient => light[c] * first[c] * (second[c] * scale + 0.1 * scale),
        })
    });
}
