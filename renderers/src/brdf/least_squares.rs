//! Nonlinear least squares with bounds: Levenberg and Marquardt's method for a handful of parameters.

use super::symmetric::{Matrix, solve};

/// The most parameters there may be.
pub(super) const N: usize = 4;

/// Iterations after which a start is given up.
const MAX_ITERATIONS: usize = 500;

/// How much a residual r counts: ½ C² l((r/C)²) with a scale C in the unit of r.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Loss {
    /// l(z) = z: least squares, the most likely parameters when errors are normal.
    #[default]
    Linear,
    /// l(z) = 2(√(1 + z) − 1): beyond the scale, errors count by their size.
    SoftL1,
    /// l(z) = ln(1 + z): gross errors hardly count.
    Cauchy,
}

impl Loss {
    /// l, l′ and l″ at z = (r/C)².
    fn derivatives(self, z: f64) -> [f64; 3] {
        match self {
            Self::Linear => [z, 1.0, 0.0],
            Self::SoftL1 => {
                let root = (1.0 + z).sqrt();
                [2.0 * z / (root + 1.0), 1.0 / root, -0.5 / (root * root * root)]
            }
            Self::Cauchy => [z.ln_1p(), 1.0 / (1.0 + z), -1.0 / ((1.0 + z) * (1.0 + z))],
        }
    }
}

/// Residuals, and their derivatives by the parameters.
#[derive(Clone, Debug, Default)]
pub(super) struct Rows {
    pub(super) residuals: Vec<f64>,
    pub(super) jacobian: Vec<[f64; N]>,
}

/// A sum of losses to be made least, within bounds.
pub(super) struct Problem<'f> {
    /// Residuals and derivatives at some parameters.
    pub(super) rows: &'f dyn Fn(&[f64; N]) -> Rows,
    pub(super) lower: [f64; N],
    pub(super) upper: [f64; N],
    /// Which parameters are sought; the others stay as they are.
    pub(super) sought: [bool; N],
    pub(super) loss: Loss,
    /// The scale of the loss, in the unit of the residuals; of no effect on [`Loss::Linear`].
    pub(super) scale: f64,
}

/// Where a descent ended.
#[derive(Clone, Debug)]
pub(super) struct Minimum {
    pub(super) parameters: [f64; N],
    /// Half the sum of losses.
    pub(super) cost: f64,
    pub(super) rows: Rows,
    /// Second derivatives of the cost, after Gauss and Newton.
    pub(super) hessian: Matrix<N>,
    /// Σ l′² r² J Jᵀ: what the residuals' spread makes of the gradient.
    pub(super) spread: Matrix<N>,
    /// Parameters that are sought, not at a bound, and on which the residuals depend.
    pub(super) free: [bool; N],
    pub(super) iterations: usize,
    /// Whether the gradient vanished but for rounding.
    pub(super) converged: bool,
}

/// The cost and its derivatives at a point.
#[derive(Clone)]
struct State {
    parameters: [f64; N],
    rows: Rows,
    cost: f64,
    gradient: [f64; N],
    hessian: Matrix<N>,
    spread: Matrix<N>,
}

impl Problem<'_> {
    /// Descends from a start to the nearest minimum; `None` when the cost isn't finite there.
    pub(super) fn descend(&self, start: [f64; N]) -> Option<Minimum> {
        let mut state = self.state(self.clamp(start))?;
        let mut damping = Damping { lambda: 1e-3, growth: 2.0 };
        let mut iterations = 0;
        let mut converged = false;
        while iterations < MAX_ITERATIONS {
            iterations += 1;
            let free = self.free(&state);
            if !free.contains(&true) {
                converged = true;
                break;
            }
            let step = solve(&state.hessian, &state.gradient.map(|g| -g), &free, damping.lambda);
            let next = step.map(|step| self.clamp(core::array::from_fn(|i| state.parameters[i] + step[i])));
            let Some(next) = next else {
                damping.refuse();
                continue;
            };
            let moved: [f64; N] = core::array::from_fn(|i| next[i] - state.parameters[i]);
            let promised = promise(&state, &moved);
            if is_tiny(&moved, &state.parameters) {
                converged = true;
                break;
            }
            match self.state(next) {
                Some(candidate) if self.accepts(&state, &candidate, promised) => {
                    damping.accept((state.cost - candidate.cost) / promised);
                    state = candidate;
                }
                _ => damping.refuse(),
            }
            if damping.lambda > 1e16 {
                // No way down is left that rounding lets us see.
                converged = true;
                break;
            }
        }
        let free = self.free(&state);
        let State { parameters, rows, cost, hessian, spread, .. } = state;
        Some(Minimum { parameters, cost, rows, hessian, spread, free, iterations, converged })
    }

    /// A step down; or, where the cost is level but for rounding, one to a smaller gradient.
    fn accepts(&self, from: &State, to: &State, promised: f64) -> bool {
        if promised > 1e-13 * from.cost {
            return from.cost - to.cost > 1e-4 * promised;
        }
        let size = |state: &State| {
            let free = self.free(state);
            let part = |i: usize| state.gradient[i] * state.gradient[i] / state.hessian[i][i].max(f64::MIN_POSITIVE);
            (0..N).filter(|&i| free[i]).map(part).sum::<f64>()
        };
        to.cost <= from.cost * (1.0 + 1e-13) && size(to) < 0.5 * size(from)
    }

    fn clamp(&self, parameters: [f64; N]) -> [f64; N] {
        core::array::from_fn(|i| parameters[i].max(self.lower[i]).min(self.upper[i]))
    }

    fn free(&self, state: &State) -> [bool; N] {
        core::array::from_fn(|i| {
            let (p, g) = (state.parameters[i], state.gradient[i]);
            let held = (p <= self.lower[i] && g >= 0.0) || (p >= self.upper[i] && g <= 0.0);
            self.sought[i] && !held && state.hessian[i][i] > 0.0
        })
    }

    fn state(&self, parameters: [f64; N]) -> Option<State> {
        let rows = (self.rows)(&parameters);
        let mut cost = 0.0;
        let mut gradient = [0.0; N];
        let (mut hessian, mut spread) = ([[0.0; N]; N], [[0.0; N]; N]);
        for (&r, j) in rows.residuals.iter().zip(&rows.jacobian) {
            let ratio = r / self.scale;
            let z = ratio * ratio;
            let [value, first, second] = self.loss.derivatives(z);
            // For the plain loss without the round trip through the scale, so that it can't change a digit.
            cost += if self.loss == Loss::Linear { 0.5 * r * r } else { 0.5 * self.scale * self.scale * value };
            // A negative curvature would lead uphill.
            let curvature = (first + 2.0 * second * z).max(0.0);
            for i in 0..N {
                gradient[i] += first * r * j[i];
                for k in 0..N {
                    hessian[i][k] += curvature * j[i] * j[k];
                    spread[i][k] += first * first * r * r * j[i] * j[k];
                }
            }
        }
        let finite = cost.is_finite() && hessian.iter().flatten().all(|h| h.is_finite());
        finite.then_some(State { parameters, rows, cost, gradient, hessian, spread })
    }
}

/// By how much the quadratic model says that the cost falls.
fn promise(state: &State, step: &[f64; N]) -> f64 {
    let bend = |i: usize| (0..N).map(|k| state.hessian[i][k] * step[k]).sum::<f64>();
    -(0..N).map(|i| step[i] * (state.gradient[i] + 0.5 * bend(i))).sum::<f64>()
}

fn is_tiny(step: &[f64; N], at: &[f64; N]) -> bool {
    (0..N).all(|i| step[i].abs() <= 4.0 * f64::EPSILON * (at[i].abs() + f64::EPSILON))
}

/// Marquardt's factor, changed after each step as K. Madsen, H. B. Nielsen and O. Tingleff do (Methods for Non-Linear
/// Least Squares Problems, 2004, §3.2).
struct Damping {
    lambda: f64,
    growth: f64,
}

impl Damping {
    fn accept(&mut self, gain: f64) {
        let gain = gain.clamp(0.0, 1.0);
        self.lambda = (self.lambda * (1.0 - (2.0 * gain - 1.0).powi(3)).max(1.0 / 3.0)).max(1e-15);
        self.growth = 2.0;
    }

    fn refuse(&mut self) {
        self.lambda *= self.growth;
        self.growth *= 2.0;
    }
}
