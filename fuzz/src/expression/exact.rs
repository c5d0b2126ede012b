//! Integrals of expressions of spectra that are linear between whole nanometres: a polynomial on each of them, which
//! Gauss's rule integrates exactly.

use spectral_core::expression::Op;
use spectral_core::tables::{Samples, UniformTable, observers};

use super::Code;

const FIRST: usize = 380;
const CELLS: usize = 400;
/// Gauss–Legendre with five nodes is exact to degree 9: eight spectra and a colour-matching function.
const NODES: [(f64, f64); 5] = [
    (0.0, 0.568_888_888_888_888_9),
    (-0.538_469_310_105_683_1, 0.478_628_670_499_366_47),
    (0.538_469_310_105_683_1, 0.478_628_670_499_366_47),
    (-0.906_179_845_938_664, 0.236_926_885_056_189_08),
    (0.906_179_845_938_664, 0.236_926_885_056_189_08),
];

/// All spectra at all points of the rule, in the precision of their tables.
pub(super) struct Exact {
    leaves: Vec<Vec<f64>>,
    observer: [Vec<f64>; 3],
    /// The least normal number of the precision.
    least: f64,
}

/// The tristimulus values of an expression.
pub(super) struct Integral {
    pub(super) xyz: [f64; 3],
    /// How far rounding may have put them off.
    pub(super) rounding: [f64; 3],
    /// The largest magnitude that any step of the expression takes, without cancellation; what underflows counts as the least normal number, of
    /// whose size bounds are there.
    pub(super) magnitude: f64,
}

impl Exact {
    pub(super) fn new(tables: &[&UniformTable], single: bool) -> Self {
        let values = |samples: &Samples| -> Vec<f64> {
            if single { samples.single.iter().map(|v| f64::from(*v)).collect() } else { samples.double.to_vec() }
        };
        let leaf = |table: &&UniformTable| sampled(&values(&table.samples), table.first, table.step);
        let observer = &observers::CIE_1931_2;
        Self {
            leaves: tables.iter().map(leaf).collect(),
            least: if single { f64::from(f32::MIN_POSITIVE) } else { f64::MIN_POSITIVE },
            observer: observer.columns.each_ref().map(|column| sampled(&values(column), observer.first, observer.step)),
        }
    }

    pub(super) fn integrate(&self, codes: &[Code], count: u32) -> Integral {
        let mut result = Integral { xyz: [0.0; 3], rounding: [0.0; 3], magnitude: 0.0 };
        for point in 0..CELLS * NODES.len() {
            let (value, majorant) = self.value(codes, count, point, &mut result.magnitude);
            let weight = NODES[point % NODES.len()].1 / 2.0;
            for a in 0..3 {
                let sensitivity = weight * self.observer[a][point];
                result.xyz[a] += sensitivity * value;
                result.rounding[a] += sensitivity * majorant;
            }
        }
        // One rounding for each term of the sum, and some for each instruction and interpolation.
        let roundings = f64::EPSILON * (CELLS * NODES.len() + 4 * codes.len() + 32) as f64;
        result.rounding = result.rounding.map(|r| r * roundings + f64::MIN_POSITIVE);
        result
    }

    /// The expression at a point, and the same with all terms taken by magnitude.
    fn value(&self, codes: &[Code], count: u32, point: usize, magnitude: &mut f64) -> (f64, f64) {
        // Beside both, the magnitude that bounds have.
        let mut stack: Vec<[f64; 3]> = Vec::with_capacity(codes.len());
        for code in codes {
            let top = match *code {
                Op::Leaf(id) => {
                    let value = self.leaves[(id % count) as usize][point];
                    [value, value.abs(), value.abs()]
                }
                Op::Deferred(_) => [0.0; 3],
                Op::Sum | Op::Product => {
                    let (b, a) = (stack.pop().unwrap_or_default(), stack.pop().unwrap_or_default());
                    std::array::from_fn(|i| if matches!(code, Op::Sum) { a[i] + b[i] } else { a[i] * b[i] })
                }
                Op::Scale(factor) => {
                    let ([value, majorant, bound], f) = (stack.pop().unwrap_or_default(), f64::from(factor));
                    [value * f, majorant * f.abs(), bound * f.abs()]
                }
                Op::Schlick(fresnel) => {
                    let f = f64::from(fresnel);
                    stack.pop().unwrap_or_default().map(|v| v * (1.0 - f) + f)
                }
            };
            let bound = top[2].max(self.least);
            *magnitude = magnitude.max(bound);
            stack.push([top[0], top[1], bound]);
        }
        let [value, majorant, _] = stack.pop().unwrap_or_default();
        (value, majorant)
    }
}

/// A table at all points, linear between its nodes and 0 outside them.
fn sampled(values: &[f64], first: u16, step: u16) -> Vec<f64> {
    let (first, step) = (usize::from(first), usize::from(step));
    let mut points = Vec::with_capacity(CELLS * NODES.len());
    for cell in FIRST..FIRST + CELLS {
        let place = cell.checked_sub(first).map(|offset| (offset / step, offset % step));
        let ends = place.and_then(|(node, part)| Some((*values.get(node)?, *values.get(node + 1)?, part)));
        for (node, _) in NODES {
            points.push(ends.map_or(0.0, |(low, high, part)| {
                let t = (part as f64 + (node + 1.0) / 2.0) / step as f64;
                low * (1.0 - t) + high * t
            }));
        }
    }
    points
}
