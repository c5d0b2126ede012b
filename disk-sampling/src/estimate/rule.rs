//! Quadrature rules: Gauss–Kronrod on [−1, 1], and the three-point Gauss rule of a measure that is known at points.

use spectral_core::Real;

/// Points of the inner rule, the Kronrod rule of 15 points.
pub(super) const POINTS: usize = 15;

/// Kronrod's nodes on [−1, 1] from the outermost to the middle, his weights, and the weights of Gauss's rule on every second node
/// (Piessens et al., QUADPACK, 1983).
const KRONROD: [(f64, f64, f64); 8] = [
    (0.991_455_371_120_812_6, 0.022_935_322_010_529_224, 0.0),
    (0.949_107_912_342_758_5, 0.063_092_092_629_978_55, 0.129_484_966_168_869_7),
    (0.864_864_423_359_769_1, 0.104_790_010_322_250_18, 0.0),
    (0.741_531_185_599_394_4, 0.140_653_259_715_525_92, 0.279_705_391_489_276_64),
    (0.586_087_235_467_691_1, 0.169_004_726_639_267_9, 0.0),
    (0.405_845_151_377_397_2, 0.190_350_578_064_785_4, 0.381_830_050_505_118_93),
    (0.207_784_955_007_898_47, 0.204_432_940_075_298_9, 0.0),
    (0.0, 0.209_482_141_084_727_82, 0.417_959_183_673_469_4),
];

/// Node, Kronrod's weight and Gauss's weight number `index` of 15, from left to right.
pub(super) fn kronrod<R: Real>(index: usize) -> (R, R, R) {
    let mirrored = if index < 8 { index } else { POINTS - 1 - index };
    let (node, weight, gauss) = KRONROD.get(mirrored).copied().unwrap_or_default();
    let node = if index < 8 { -node } else { node };
    (R::from_f64(node), R::from_f64(weight), R::from_f64(gauss))
}

/// Gauss–Legendre's five points on [−1, 1], node and weight (Abramowitz & Stegun, table 25.4).
pub(super) const GAUSS_5: [(f64, f64); 5] = [
    (-0.906_179_845_938_664, 0.236_926_885_056_189_08),
    (-0.538_469_310_105_683, 0.478_628_670_499_366_47),
    (0.0, 0.568_888_888_888_888_9),
    (0.538_469_310_105_683, 0.478_628_670_499_366_47),
    (0.906_179_845_938_664, 0.236_926_885_056_189_08),
];

/// The Gauss rule of three points of a positive measure on [−1, 1]: exact for polynomials of degree 5 times the measure.
#[derive(Clone, Copy, Debug)]
pub(super) struct Gauss3<R> {
    /// In ascending order.
    pub(super) nodes: [R; 3],
    /// They sum to 1.
    pub(super) weights: [R; 3],
    /// The orthonormal polynomials of degree 1 and 2 at the nodes.
    linear: [R; 3],
    quadratic: [R; 3],
}

/// The mean of three values by the rule, and how far it may be off.
#[derive(Clone, Copy, Debug)]
pub(super) struct Mean<R> {
    pub(super) value: R,
    pub(super) error: R,
}

impl<R: Real> Gauss3<R> {
    /// The rule of a measure given by `N` points (Stieltjes' procedure, then the eigenvalues of the Jacobi matrix); `None` where the measure
    /// has no more than two points of weight.
    pub(super) fn of<const N: usize>(points: &[(R, R); N]) -> Option<Self> {
        let mass = points.iter().fold(R::ZERO, |sum, (_, w)| sum + *w);
        if !(mass > R::ZERO && mass.is_finite()) {
            return None;
        }
        let mean = |f: &dyn Fn(R) -> R| points.iter().fold(R::ZERO, |sum, (x, w)| sum + *w * f(*x)) / mass;
        let a0 = mean(&|x| x);
        let b1 = mean(&|x| (x - a0) * (x - a0));
        if !(b1 > R::ZERO) {
            return None;
        }
        let p1 = |x: R| x - a0;
        let a1 = mean(&|x| x * p1(x) * p1(x)) / b1;
        let p2 = |x: R| (x - a1) * p1(x) - b1;
        let n2 = mean(&|x| p2(x) * p2(x));
        if !(n2 > R::EPSILON * R::EPSILON * b1 * b1) {
            return None;
        }
        let b2 = n2 / b1;
        let a2 = mean(&|x| x * p2(x) * p2(x)) / n2;
        let nodes = eigenvalues([a0, a1, a2], [b1, b2]);
        let linear = nodes.map(|x| p1(x) / b1.sqrt());
        let quadratic = nodes.map(|x| p2(x) / n2.sqrt());
        let weights = core::array::from_fn(|i| R::ONE / (R::ONE + linear[i] * linear[i] + quadratic[i] * quadratic[i]));
        let sum = weights[0] + weights[1] + weights[2];
        let rule = Self { nodes, weights: weights.map(|w: R| w / sum), linear, quadratic };
        rule.nodes.iter().chain(&rule.weights).all(|x| x.is_finite()).then_some(rule)
    }

    /// The mean of a function with these values at the nodes.
    ///
    /// The error is judged by how fast the coefficients in the measure's own orthonormal polynomials fall: the last one known, of degree 2, times
    /// the square of the rate. The rule's own error begins with degree 6, so that a function with geometric fall is met with room to spare.
    pub(super) fn mean(&self, values: [R; 3]) -> Mean<R> {
        let value = self.project(&[R::ONE; 3], values);
        Mean { value, error: self.deviation(values, value) }
    }

    fn project(&self, polynomial: &[R; 3], values: [R; 3]) -> R {
        (0..3).fold(R::ZERO, |sum, i| sum + self.weights[i] * polynomial[i] * values[i])
    }

    /// The error of the mean of a function with these values, judged as in [`mean`](Self::mean), against a mean of `size`.
    pub(super) fn deviation(&self, values: [R; 3], size: R) -> R {
        let (c1, c2) = (self.project(&self.linear, values).abs(), self.project(&self.quadratic, values).abs());
        let scale = size.abs().max(c1).max(c2);
        if !(scale > R::ZERO) {
            return R::ZERO;
        }
        let rate = (c1 / scale * (c1 / scale)).max(c2 / scale).min(R::ONE);
        // Equal values give coefficients of rounding errors.
        let noise = R::from_f64(8.0) * R::EPSILON * scale;
        if c2 <= noise { R::ZERO } else { c2 * rate }
    }
}

/// The eigenvalues, ascending, of the symmetric tridiagonal matrix with this diagonal and these squares beside it (trigonometric solution of the
/// cubic; Smith 1961).
fn eigenvalues<R: Real>(a: [R; 3], b: [R; 2]) -> [R; 3] {
    let three = R::from_f64(3.0);
    let mean = (a[0] + a[1] + a[2]) / three;
    let d = a.map(|x| x - mean);
    let p = ((d[0] * d[0] + d[1] * d[1] + d[2] * d[2] + R::TWO * (b[0] + b[1])) / R::from_f64(6.0)).sqrt();
    if !(p > R::ZERO) {
        return [mean; 3];
    }
    let determinant = d[0] * (d[1] * d[2] - b[1]) - b[0] * d[2];
    let cosine = (determinant / (R::TWO * p * p * p)).clamp(-R::ONE, R::ONE);
    let angle = cosine.acos() / three;
    let largest = mean + R::TWO * p * angle.cos();
    let smallest = mean + R::TWO * p * (angle + R::TWO * R::PI / three).cos();
    [smallest, three * mean - largest - smallest, largest]
}
