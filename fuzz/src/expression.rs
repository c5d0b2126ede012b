//! Rendering expressions: certified values against exact integrals.

mod exact;

use std::sync::OnceLock;

use exact::Exact;
use spectral_core::adaptive::{Evaluation, Mode, Piece, Status, Target, evaluate};
use spectral_core::colour::{delta_e_ab, xyz_to_lab};
use spectral_core::expression::{Op, Program};
use spectral_core::interval::{Domain, Interval, Pyramid, Weight, node_count};
use spectral_core::spectrum::Outside;
use spectral_core::tables::{self, UniformTable};
use spectral_core::{Observer, Real};

/// Parts of 6.25 nm are small enough to refine and few enough to be fast.
const DEPTH: u8 = 6;
const MAX_PIECES: usize = 1 << DEPTH;
const MAX_OPS: usize = 32;
/// Factors in one product; the exact integrals are exact up to here.
const MAX_DEGREE: u32 = 8;

/// Builds an expression of built-in spectra from the bytes and evaluates it in both precisions: certified values must be within
/// their radius of the exact integral, coarse and fine, and the colour within its bound.
pub fn expression(bytes: &[u8]) {
    let Some((threshold, ops)) = decode(bytes) else { return };
    static DOUBLE: OnceLock<Setup<f64>> = OnceLock::new();
    static SINGLE: OnceLock<Setup<f32>> = OnceLock::new();
    DOUBLE.get_or_init(Setup::new).judge(&ops, threshold, 1e100);
    SINGLE.get_or_init(Setup::new).judge(&ops, threshold, 1e12);
}

/// All leaves: lights of every family that is tabulated, and paints. Their nodes are at whole nanometres.
fn leaves() -> Vec<&'static UniformTable> {
    tables::lights().chain(&tables::colorchecker::ALL).chain(&tables::cornell::ALL).collect()
}

/// An instruction, whatever the precision: its numbers are exact in `f32`.
type Code = Op<f32>;

/// What is on the decoder's stack: the number of factors in the longest product.
struct Decoder {
    ops: Vec<Code>,
    degrees: Vec<u32>,
}

/// A threshold and a balanced program; `None` for bytes that hold no leaf.
fn decode(bytes: &[u8]) -> Option<(f64, Vec<Code>)> {
    let (first, rest) = bytes.split_first()?;
    let threshold = 0.01 * 2.0_f64.powi(i32::from(first % 12));
    let mut decoder = Decoder { ops: Vec::new(), degrees: Vec::new() };
    let mut bytes = rest.iter().copied();
    while let (Some(code), true) = (bytes.next(), decoder.ops.len() < MAX_OPS) {
        decoder.push(code, &mut || bytes.next().unwrap_or_default());
    }
    while decoder.degrees.len() > 1 {
        decoder.join(false);
    }
    (!decoder.degrees.is_empty()).then_some((threshold, decoder.ops))
}

impl Decoder {
    /// Adds an instruction, if the stack allows it.
    fn push(&mut self, code: u8, next: &mut dyn FnMut() -> u8) {
        let empty = self.degrees.is_empty();
        match code % 8 {
            3 if !empty => self.ops.push(Op::Scale(f32::from(next()) / 64.0)),
            4 if !empty => {
                let decade = i32::from(next() % 31) - 15;
                self.ops.push(Op::Scale(10.0_f32.powi(decade)));
            }
            5 if !empty => self.ops.push(Op::Schlick(f32::from(next()) / 255.0)),
            6 if self.degrees.len() > 1 => self.join(false),
            7 if self.degrees.len() > 1 => self.join(true),
            2 if !empty => self.ops.push(Op::Scale(-f32::from(next()) / 64.0)),
            _ => {
                self.ops.push(Op::Leaf(u32::from(next())));
                self.degrees.push(1);
            }
        }
    }

    /// The sum of the two topmost spectra, or their product if it does not get too long.
    fn join(&mut self, product: bool) {
        let (Some(second), Some(first)) = (self.degrees.pop(), self.degrees.pop()) else { return };
        let multiply = product && first + second <= MAX_DEGREE;
        self.ops.push(if multiply { Op::Product } else { Op::Sum });
        self.degrees.push(if multiply { first + second } else { first.max(second) });
    }
}

/// The spectra in one precision: integrated for the core, and as they are for the exact integrals.
struct Setup<R: Real> {
    domain: Domain<'static, R>,
    pyramids: Vec<Pyramid<'static, R>>,
    exact: Exact,
}

impl<R: Real + Default + 'static> Setup<R> {
    /// Integrates all leaves; their memory is never given back.
    fn new() -> Self {
        let count = node_count(DEPTH);
        let weights = vec![Weight::default(); count].leak();
        let domain = Domain::build(Observer::cie_1931_2deg(), DEPTH, weights).expect("a domain");
        let pyramid = |table: &&'static UniformTable| {
            let spectrum = table.spectrum::<R>(Outside::Zero);
            Pyramid::build(&spectrum, &domain, vec![Interval::zero(); count].leak()).expect("a pyramid")
        };
        let pyramids = leaves().iter().map(pyramid).collect();
        Self { domain, pyramids, exact: Exact::new(&leaves(), size_of::<R>() == 4) }
    }

    /// Evaluates a program in all modes. What comes of intermediate magnitudes beyond `range` may be infinite or NaN.
    fn judge(&self, codes: &[Code], threshold: f64, range: f64) {
        let count = u32::try_from(self.pyramids.len()).unwrap_or(u32::MAX);
        let ops: Vec<Op<R>> = codes.iter().map(|code| translate(*code, count)).collect();
        let program = Program::new(&ops).expect("a balanced program");
        let truth = self.exact.integrate(codes, count);
        let in_range = truth.magnitude <= range;
        for mode in [Mode::Paper, Mode::Corrected] {
            let found = self.evaluate(&program, mode, threshold);
            assert!(to_f64(found.delta_e) >= 0.0 || !in_range, "{codes:?}: {mode:?} {found:?}");
        }
        for threshold in [threshold, 1e-9] {
            let found = self.evaluate(&program, Mode::Certified, threshold);
            let excused = |limit: f64| !in_range && !limit.is_finite();
            for a in 0..3 {
                let error = (to_f64(found.xyz[a]) - truth.xyz[a]).abs();
                let limit = to_f64(found.radius[a]) + truth.rounding[a];
                assert!(
                    error <= limit || excused(limit),
                    "{codes:?}, channel {a}: {error} off, {found:?}, {:?}",
                    truth.xyz
                );
            }
            let (error, limit) = (self.true_difference(&found, &truth), to_f64(found.delta_e));
            assert!(error <= limit || excused(limit), "{codes:?}: {error} above {limit}, {found:?}, {:?}", truth.xyz);
            let reached = found.delta_e <= R::from_f64(threshold);
            assert_eq!(found.status == Status::Reached, reached, "{codes:?}: {threshold}, {found:?}");
        }
    }

    fn evaluate(&self, program: &Program<'_, R>, mode: Mode, threshold: f64) -> Evaluation<R> {
        let mut stack = vec![Interval::zero(); program.stack_size()];
        let mut pieces = vec![Piece::default(); MAX_PIECES];
        let target = Target { mode, threshold: R::from_f64(threshold), white: self.white() };
        let mut sources = self.pyramids.as_slice();
        evaluate(program, &self.domain, &target, &mut sources, &mut stack, &mut pieces).expect("an evaluation")
    }

    /// Equal energy.
    fn white(&self) -> [R; 3] {
        [R::from_f64(106.86); 3]
    }

    /// The true ΔE*ab, less what the exact integral's own rounding may be worth at the steepest of CIELAB.
    fn true_difference(&self, found: &Evaluation<R>, truth: &exact::Integral) -> f64 {
        let white = self.white().map(to_f64);
        let (lab, exact) = (xyz_to_lab(found.xyz.map(to_f64), white), xyz_to_lab(truth.xyz, white));
        let steepest = 3.0 * 500.0 * (841.0 / 108.0) / white[0];
        let integral = steepest * truth.rounding.iter().copied().fold(0.0, f64::max);
        let conversion = 8.0 * f64::EPSILON * lab.iter().chain(&exact).map(|v| v.abs()).sum::<f64>();
        delta_e_ab(lab, exact) - integral - conversion
    }
}

fn translate<R: Real>(code: Code, count: u32) -> Op<R> {
    match code {
        Op::Leaf(id) => Op::Leaf(id % count),
        Op::Deferred(id) => Op::Deferred(id),
        Op::Scale(factor) => Op::Scale(R::from_f64(f64::from(factor))),
        Op::Schlick(fresnel) => Op::Schlick(R::from_f64(f64::from(fresnel))),
        Op::Sum => Op::Sum,
        Op::Product => Op::Product,
    }
}

fn to_f64<R: Real>(value: R) -> f64 {
    value.to_f64()
}
