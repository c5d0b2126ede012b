//! Dense integration: the true tristimulus values of a rendering expression, in `f64`, as an `independent` oracle.
//!
//! It shares no code with the core's integration: colour-matching functions and spectra are node lists of its own, the domain is
//! split at every node of every factor, and on each of these cells, where everything is a polynomial, Gauss–Legendre
//! quadrature with enough points is exact but for rounding. Sums are compensated, and what rounding can have cost is bounded
//! ([`Integral::error`]).

use core::iter::zip;

use spectral_core::Real;
use spectral_core::expression::Op;

use crate::tables::Csv;

/// The unit roundoff of `f64`.
const UNIT: f64 = f64::EPSILON / 2.0;
/// Points that are evaluated together; also the granularity of the buffers.
const BLOCK: usize = 64;
/// Compensated sums that run side by side.
const LANES: usize = 8;

/// What a [`Polyline`] is outside its nodes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Beyond {
    /// Zero, with a jump at the first and last node.
    Zero,
    /// The value of the nearest node.
    Hold,
}

/// A piecewise linear function of the wavelength in nm, as a list of nodes.
#[derive(Clone, Debug, PartialEq)]
pub struct Polyline {
    wavelengths: Vec<f64>,
    values: Vec<f64>,
    beyond: Beyond,
}

impl Polyline {
    /// A polyline through nodes (wavelength, value), of which there is at least one, in increasing order of wavelength.
    #[must_use]
    pub fn new(nodes: &[(f64, f64)], beyond: Beyond) -> Self {
        let (wavelengths, values) = nodes.iter().copied().unzip();
        Self { wavelengths, values, beyond }
    }

    /// The same value everywhere.
    #[must_use]
    pub fn constant(value: f64) -> Self {
        Self::new(&[(580.0, value)], Beyond::Hold)
    }

    /// A column of a data file over its first column.
    ///
    /// # Errors
    /// As [`Csv::read`]'s and [`Csv::numbers`]'s.
    pub fn read(file: &str, column: &str, beyond: Beyond) -> Result<Self, String> {
        let (wavelengths, values) = Csv::read(file)?.numbers(column)?;
        Ok(Self { wavelengths, values, beyond })
    }

    /// The same with every value multiplied.
    #[must_use]
    pub fn scaled(&self, factor: f64) -> Self {
        let values = self.values.iter().map(|v| v * factor).collect();
        Self { values, wavelengths: self.wavelengths.clone(), beyond: self.beyond }
    }

    /// The wavelengths of the nodes in nm.
    #[must_use]
    pub fn wavelengths(&self) -> &[f64] {
        &self.wavelengths
    }

    /// The limits from inside at both ends of a stretch that has no node in its interior.
    #[must_use]
    pub fn ends(&self, from: f64, to: f64) -> [f64; 2] {
        let next = self.wavelengths.partition_point(|w| *w <= from);
        if next == 0 || next == self.wavelengths.len() {
            let nearest = if next == 0 { self.values[0] } else { self.values[next - 1] };
            return [if self.beyond == Beyond::Hold { nearest } else { 0.0 }; 2];
        }
        let (start, end) = (self.wavelengths[next - 1], self.wavelengths[next]);
        let (first, last) = (self.values[next - 1], self.values[next]);
        [from, to].map(|w| (first * (end - w) + last * (w - start)) / (end - start))
    }
}

/// The colour-matching functions x̄, ȳ, z̄ of the CIE 1931 2° observer, from the data file, zero outside it.
///
/// # Errors
/// The data file can't be read.
pub fn cie_1931() -> Result<[Polyline; 3], String> {
    let read = |column| Polyline::read("cie_1931_2deg_cmf_1nm.csv", column, Beyond::Zero);
    Ok([read("xbar")?, read("ybar")?, read("zbar")?])
}

/// The abscissae in [0, 1] and weights of Gauss–Legendre quadrature: exact for polynomials of degree 2 `points` − 1.
///
/// Newton's iteration on the Legendre polynomial by its three-term recurrence.
#[must_use]
pub fn gauss_legendre(points: usize) -> Vec<[f64; 2]> {
    let n = small(points);
    let rule = |k: usize| {
        let mut x = (core::f64::consts::PI * (small(k) + 0.75) / (n + 0.5)).cos();
        let mut slope = 1.0;
        for _ in 0..8 {
            let (mut before, mut value) = (1.0, x);
            for j in 2..=points {
                let j = small(j);
                (before, value) = (value, ((2.0 * j - 1.0) * x * value - (j - 1.0) * before) / j);
            }
            slope = n * (x * value - before) / (x * x - 1.0);
            x -= value / slope;
        }
        [(1.0 - x) / 2.0, 1.0 / ((1.0 - x * x) * slope * slope)]
    };
    (0..points).map(rule).collect()
}

fn small(n: usize) -> f64 {
    u32::try_from(n).map_or(f64::INFINITY, f64::from)
}

/// A sum with Knuth's error-free transformation, side by side in lanes.
#[derive(Clone, Copy, Debug, Default)]
struct Lanes {
    total: [f64; LANES],
    lost: [f64; LANES],
}

impl Lanes {
    #[inline]
    fn add(&mut self, terms: &[f64; LANES]) {
        for (k, term) in terms.iter().enumerate() {
            let next = self.total[k] + term;
            let part = next - self.total[k];
            self.lost[k] += (self.total[k] - (next - part)) + (term - part);
            self.total[k] = next;
        }
    }

    fn value(&self) -> f64 {
        let mut joined = Self::default();
        for term in self.total.iter().chain(&self.lost) {
            joined.add(&core::array::from_fn(|k| if k == 0 { *term } else { 0.0 }));
        }
        joined.total[0] + joined.lost[0]
    }
}

/// The integral of an expression times the colour-matching functions.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Integral {
    /// ∫Sā.
    pub xyz: [f64; 3],
    /// At most so far from the exact value.
    pub error: [f64; 3],
}

/// Moments of an expression on an interval, for comparison with the bounds that the core keeps.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Moments {
    /// ∫Sā and its error.
    pub integral: Integral,
    /// (∫(S − μ_a)² ā)^½ about the channel's own mean.
    pub norm: [f64; 3],
    /// At most ∫|S − μ_a| ā: the sum over the cells of |∫(S − μ_a) ā|.
    pub absolute: [f64; 3],
    /// The least and the greatest value at the points of quadrature.
    pub range: [f64; 2],
    /// ∫ā.
    pub weight: [f64; 3],
    /// The relative rounding error of a value of S, times the greatest |S| (all terms counted as positive).
    pub value_error: f64,
}

/// Spectra on the points of a quadrature over [from, to] that is exact for products of them.
#[derive(Clone, Debug, Default)]
pub struct Dense {
    points: usize,
    used: usize,
    /// Quadrature weight times colour-matching function at each point; zeros from `used` on.
    weights: [Vec<f64>; 3],
    /// The spectra at each point.
    values: Vec<Vec<f64>>,
    /// Whether a spectrum has values below zero, which can cancel.
    signed: bool,
}

impl Dense {
    /// Splits [`from`, `to`] in nm at every node of `observer` and `spectra`, with so many points a cell: polynomials of
    /// degree 2 `points` − 1 are integrated exactly, so that `points` has to be above half the number of factors.
    #[must_use]
    pub fn new(observer: &[Polyline; 3], spectra: &[&Polyline], [from, to]: [f64; 2], points: usize) -> Self {
        let mut limits: Vec<f64> = observer
            .iter()
            .chain(spectra.iter().copied())
            .flat_map(|line| line.wavelengths.iter().copied())
            .filter(|w| *w > from && *w < to)
            .chain([from, to])
            .collect();
        limits.sort_unstable_by(f64::total_cmp);
        limits.dedup();
        let cells: Vec<[f64; 2]> = limits.windows(2).map(|w| [w[0], w[1]]).collect();
        let rule = gauss_legendre(points);
        let used = cells.len() * points;
        let length = used.next_multiple_of(BLOCK);
        let sample = |line: &Polyline, scale: &dyn Fn(f64, [f64; 2]) -> f64| {
            let mut samples = Vec::with_capacity(length);
            for &[start, end] in &cells {
                let [first, last] = line.ends(start, end);
                samples.extend(
                    rule.iter().map(|&[x, weight]| (first * (1.0 - x) + last * x) * scale(weight, [start, end])),
                );
            }
            samples.resize(length, 0.0);
            samples
        };
        let signed = spectra.iter().any(|line| line.values.iter().any(|value| *value < 0.0));
        Self {
            points,
            used,
            signed,
            weights: [0, 1, 2].map(|a| sample(&observer[a], &|w, [start, end]| w * (end - start))),
            values: spectra.iter().map(|line| sample(line, &|_, _| 1.0)).collect(),
        }
    }

    /// How many points a cell has.
    #[must_use]
    pub const fn points(&self) -> usize {
        self.points
    }

    /// Evaluates a postfix program at the points from `start` on; with `positive`, all its numbers as their absolute values.
    fn block<R: Real>(
        &self,
        ops: &[Op<R>],
        start: usize,
        positive: bool,
        stack: &mut Vec<[f64; BLOCK]>,
    ) -> [f64; BLOCK] {
        stack.clear();
        for op in ops {
            match *op {
                Op::Leaf(id) | Op::Deferred(id) => {
                    stack.push([0.0; BLOCK]);
                    let values = &self.values[id as usize][start..start + BLOCK];
                    if let Some(top) = stack.last_mut() {
                        top.copy_from_slice(values);
                    }
                    if positive {
                        each(stack, f64::abs);
                    }
                }
                Op::Scale(factor) => {
                    let factor = factor.to_f64();
                    let factor = if positive { factor.abs() } else { factor };
                    each(stack, |v| v * factor);
                }
                Op::Schlick(fresnel) => {
                    // In the positive program, the terms count separately: C (1 − f) + f.
                    let f = fresnel.to_f64();
                    each(stack, |v| v * (1.0 - f) + f);
                }
                Op::Sum => both(stack, |a, b| a + b),
                Op::Product => both(stack, |a, b| a * b),
            }
        }
        stack.pop().unwrap_or([f64::NAN; BLOCK])
    }

    /// The relative rounding error of a value and of its weight, in units of 2⁻⁵³: 8 for each interpolated leaf, 3 for each
    /// operation, 24 for the colour-matching functions, the rule and the sums.
    fn roundings<R: Real>(ops: &[Op<R>]) -> f64 {
        let units = |op: &Op<R>| if matches!(op, Op::Leaf(_) | Op::Deferred(_)) { 8.0 } else { 3.0 };
        ops.iter().map(units).sum::<f64>() + 24.0
    }

    /// ∫Sā of a postfix program whose leaves, deferred or not, are the spectra that this was made of.
    #[must_use]
    pub fn integrate<R: Real>(&self, ops: &[Op<R>]) -> Integral {
        let xyz = self.sums(ops, false);
        // Where nothing can cancel, the value is the sum of the sizes of its terms.
        let cancels = self.signed || ops.iter().any(|op| matches!(op, Op::Scale(f) if *f < R::ZERO));
        let size = if cancels { self.sums(ops, true) } else { xyz };
        Integral { xyz, error: size.map(|s| s * Self::roundings(ops) * UNIT + f64::MIN_POSITIVE) }
    }

    fn sums<R: Real>(&self, ops: &[Op<R>], positive: bool) -> [f64; 3] {
        let mut sums = [Lanes::default(); 3];
        let mut stack = Vec::new();
        for start in (0..self.weights[0].len()).step_by(BLOCK) {
            let values = self.block(ops, start, positive, &mut stack);
            for (sum, weights) in zip(&mut sums, &self.weights) {
                let weights = &weights[start..start + BLOCK];
                for (w, v) in zip(weights.as_chunks::<LANES>().0, values.as_chunks::<LANES>().0) {
                    sum.add(&core::array::from_fn(|k| w[k] * v[k]));
                }
            }
        }
        sums.map(|s| s.value())
    }

    /// The moments of a program on [from, to]; `points` must be above the number of factors, since the square counts.
    #[must_use]
    pub fn moments<R: Real>(&self, ops: &[Op<R>]) -> Moments {
        let integral = self.integrate(ops);
        let mut stack = Vec::new();
        let mut values = Vec::with_capacity(self.weights[0].len());
        let mut largest = 0.0_f64;
        for start in (0..self.weights[0].len()).step_by(BLOCK) {
            values.extend(self.block(ops, start, false, &mut stack));
            largest = self.block(ops, start, true, &mut stack).into_iter().fold(largest, f64::max);
        }
        values.truncate(self.used);
        let weight = [0, 1, 2].map(|a| compensated(self.weights[a].iter().copied()));
        let mut moments = Moments {
            integral,
            weight,
            range: values.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |r, v| [r[0].min(*v), r[1].max(*v)]),
            value_error: largest * Self::roundings(ops) * UNIT,
            ..Moments::default()
        };
        // Relative to the largest value, so that squares don't underflow.
        let unit = if largest > 0.0 { largest } else { 1.0 };
        for (a, weights) in self.weights.iter().enumerate() {
            let mean = if weight[a] > 0.0 { integral.xyz[a] / weight[a] } else { 0.0 };
            let deviations = || zip(&values, weights).map(|(v, w)| (v - mean, *w));
            let squares = compensated(deviations().map(|(d, w)| (d / unit) * (d / unit) * w));
            moments.norm[a] = squares.sqrt() * unit;
            let terms: Vec<f64> = deviations().map(|(d, w)| d * w).collect();
            moments.absolute[a] = compensated(terms.chunks(self.points).map(|c| c.iter().sum::<f64>().abs()));
        }
        moments
    }
}

fn each(stack: &mut [[f64; BLOCK]], f: impl Fn(f64) -> f64) {
    for value in stack.last_mut().into_iter().flatten() {
        *value = f(*value);
    }
}

fn both(stack: &mut Vec<[f64; BLOCK]>, f: impl Fn(f64, f64) -> f64) {
    if let [.., left, right] = stack.as_mut_slice() {
        for (a, b) in zip(left, right) {
            *a = f(*a, *b);
        }
        stack.pop();
    }
}

fn compensated(terms: impl Iterator<Item = f64>) -> f64 {
    let mut sum = Lanes::default();
    for term in terms {
        sum.add(&core::array::from_fn(|k| if k == 0 { term } else { 0.0 }));
    }
    sum.value()
}

/// CIELAB's f (ISO/CIE 11664-4, equations 4 to 9), written independently of the core's.
#[must_use]
pub fn lab_f(t: f64) -> f64 {
    if t > (6.0_f64 / 29.0).powi(3) { t.cbrt() } else { (29.0_f64 / 6.0).powi(2) * t / 3.0 + 4.0 / 29.0 }
}

/// CIELAB L\*, a\*, b\* of tristimulus values.
#[must_use]
pub fn lab(xyz: [f64; 3], white: [f64; 3]) -> [f64; 3] {
    let [x, y, z] = [0, 1, 2].map(|a| lab_f(xyz[a] / white[a]));
    [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
}

/// ΔE\*ab between a colour and an [`Integral`]: the least that the integral's own error admits.
///
/// The error in f is that of the argument times the slope, at most (29/6)²/3, plus 4 roundings of f itself.
#[must_use]
pub fn least_delta_e(xyz: [f64; 3], truth: &Integral, white: [f64; 3]) -> f64 {
    let [from, to] = [lab(xyz, white), lab(truth.xyz, white)];
    let distance = zip(from, to).map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt();
    let doubt = [0, 1, 2].map(|a| {
        let (t, e) = (truth.xyz[a] / white[a], truth.error[a] / white[a]);
        let f = lab_f(t).abs().max(lab_f(xyz[a] / white[a]).abs()).max(4.0 / 29.0);
        lab_f(t) - lab_f(t - e) + 8.0 * UNIT * f
    });
    let [x, y, z] = doubt;
    distance * (1.0 - 8.0 * UNIT) - (116.0 * y + 500.0 * (x + y) + 200.0 * (y + z))
}

#[cfg(test)]
mod tests {
    use super::*;

    const DOMAIN: [f64; 2] = [380.0, 780.0];

    /// Flat colour-matching functions 1, 2, 3, as an observer whose integrals are known.
    fn flat() -> [Polyline; 3] {
        [1.0, 2.0, 3.0].map(Polyline::constant)
    }

    fn ramp() -> Polyline {
        Polyline::new(&[(380.0, 0.0), (780.0, 1.0)], Beyond::Zero)
    }

    #[test]
    fn quadrature_is_exact_up_to_its_degree_and_not_beyond() {
        for points in 1..=9 {
            let rule = gauss_legendre(points);
            let moment = |k: usize| rule.iter().map(|[x, w]| w * x.powi(i32::try_from(k).unwrap())).sum::<f64>();
            for k in 0..2 * points {
                let exact = 1.0 / small(k + 1);
                assert!((moment(k) - exact).abs() <= 8.0 * f64::EPSILON, "{points} points, x^{k}");
            }
            let exact = 1.0 / small(2 * points + 1);
            assert!((moment(2 * points) - exact).abs() >= 1e-12, "{points} points");
        }
    }

    /// Closed form: ∫ xᵏ = 400 / (k + 1) for the ramp x from 0 to 1 over 400 nm.
    #[test]
    fn powers_of_a_ramp_have_their_closed_form() {
        let ramp = ramp();
        let dense = Dense::new(&flat(), &[&ramp], DOMAIN, 4);
        let mut ops = vec![Op::Leaf(0_u32)];
        for k in 1..=6_u32 {
            let integral = dense.integrate::<f64>(&ops);
            for (a, xyz) in integral.xyz.iter().enumerate() {
                let exact = small(a + 1) * 400.0 / f64::from(k + 1);
                assert!((xyz - exact).abs() <= integral.error[a], "x^{k}: {xyz}, not {exact}");
                assert!(integral.error[a] <= 1e-12 * exact);
            }
            ops.extend([Op::Leaf(0), Op::Product]);
        }
    }

    /// Closed form: (1 − f) x + f of the ramp, minus half of it: 400 (½ (1 − f) + f − ¼); its spread about the mean by hand.
    #[test]
    fn schlick_terms_sums_and_moments_have_their_closed_form() {
        let ramp = ramp();
        let dense = Dense::new(&flat(), &[&ramp], DOMAIN, 4);
        let ops = [Op::Leaf(0), Op::Schlick(0.25), Op::Deferred(0), Op::Scale(-0.5), Op::Sum];
        let moments = dense.moments::<f64>(&ops);
        // The value is ¼ + ¼ x, between ¼ and ½, with mean 3/8 and variance (1/16)/12.
        for a in 0..3 {
            let weight = 400.0 * small(a + 1);
            let close = |value: f64, exact: f64| assert!((value - exact).abs() <= 1e-13 * weight);
            close(moments.weight[a], weight);
            close(moments.integral.xyz[a], 0.375 * weight);
            close(moments.norm[a], (weight / 192.0).sqrt());
            // The observer's node at 580 nm, where the deviation changes sign, parts the cells: exact.
            close(moments.absolute[a], weight / 16.0);
        }
        assert!(moments.range[0] >= 0.25 && moments.range[1] <= 0.5);
        assert!(moments.range[0] <= 0.27 && moments.range[1] >= 0.48);
    }

    /// `independent`: the midpoint rule at a thousandth of a nanometre, for narrow, jumping and real spectra.
    #[test]
    fn agrees_with_a_brute_midpoint_rule() {
        let observer = cie_1931().unwrap();
        let light = Polyline::read("cie_fl1_fl12_5nm.csv", "FL11", Beyond::Zero).unwrap();
        let spike = Polyline::new(&[(544.0, 0.0), (544.7, 3.0), (546.0, 0.5)], Beyond::Zero);
        let step = Polyline::new(&[(500.0, 0.2), (500.001, 0.9), (700.0, 0.4)], Beyond::Hold);
        let spectra = [&light, &spike, &step];
        let ops = [
            Op::Leaf(0),
            Op::Leaf(1),
            Op::Leaf(2),
            Op::Product,
            Op::Schlick(0.1),
            Op::Product,
            Op::Leaf(2),
            Op::Product,
        ];
        let exact = Dense::new(&observer, &spectra, DOMAIN, 3).integrate::<f64>(&ops);
        let at = |line: &Polyline, w: f64| line.ends(w, w)[0];
        let step_width = 1e-3;
        let mut sums = [0.0; 3];
        for k in 0..400_000_u32 {
            let w = 380.0 + (f64::from(k) + 0.5) * step_width;
            let [l, s, t] = spectra.map(|line| at(line, w));
            let value = l * (s * t * 0.9 + 0.1) * t;
            for a in 0..3 {
                sums[a] += value * at(&observer[a], w) * step_width;
            }
        }
        // The cell with the step in it: 0.7 high, 1e-3 wide; elsewhere the rule's error is of second order.
        for (sum, xyz) in zip(sums, exact.xyz) {
            assert!((sum - xyz).abs() <= 1e-7 * xyz, "{sum} against {xyz}");
        }
    }

    /// `published`: the sums of the 1 nm table over 360–830 nm are 106.8655, 106.8569 and 106.8923 (CIE 15:2004, table T.4);
    /// the integrals are less by half the outermost values, which are below 3.1e-4 together.
    #[test]
    fn the_observer_has_its_published_integral() {
        let observer = cie_1931().unwrap();
        let one = Polyline::constant(1.0);
        let dense = Dense::new(&observer, &[&one], [360.0, 830.0], 1);
        let xyz = dense.integrate::<f64>(&[Op::Leaf(0)]).xyz;
        for (value, sum) in zip(xyz, [106.865_5, 106.856_9, 106.892_3]) {
            assert!(value <= sum + 5e-5 && value >= sum - 5e-5 - 3.1e-4, "{xyz:?}");
        }
    }

    /// `independent`: colour-science 0.4.7's `XYZ_to_Lab`, and a distance by hand.
    #[test]
    fn lab_and_its_distance() {
        let white = [0.95047, 1.0, 1.08883];
        let lab = lab([0.2, 0.12, 0.05], white);
        for (value, expected) in zip(lab, [41.216_120_124_466_91, 50.773_931_171_631_396, 27.028_649_916_043_545]) {
            assert!((value - expected).abs() <= 1e-11, "{lab:?}");
        }
        let truth = Integral { xyz: white, error: [0.0; 3] };
        let black = least_delta_e([0.0; 3], &truth, white);
        assert!((black - 100.0).abs() <= 1e-10, "{black}");
        let doubtful = Integral { error: [0.01; 3], ..truth };
        assert!(least_delta_e(white, &doubtful, white) < 0.0);
    }
}
