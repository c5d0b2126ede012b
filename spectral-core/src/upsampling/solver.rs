//! Finding the sigmoid of a colour.

use super::sigmoid::{argument, polynomial, position, sigmoid_and_slope};
use super::{Sigmoid, UpsamplerError, UpsamplingError};
use crate::array::{transposed, zip};
use crate::colour::RgbSpace;
use crate::integrate::product_integrals;
use crate::matrix::{Factored, Matrix, apply, largest};
use crate::spectrum::{Constant, Outside, PiecewiseLinear};
use crate::tables::illuminants;
use crate::{Observer, Real, Spectrum};

/// Nodes of a [`Sigmoid`] in 380–780 nm, every 5 nm.
pub(super) const NODES: usize = 81;
/// The largest component from which a dark colour is approached.
const START: f64 = 0.05;
/// Below this many ε a colour is as good as black, and sigmoids are scaled: ρ is about 1 / (4 U²).
const DARKEST: f64 = 0.125;
/// How much darker a colour may be than the one whose solution is the first guess.
const STRIDE: f64 = 0.125;
/// That ratio is taken to its square root where Newton's method fails, but not beyond this.
const SHORTEST_STRIDE: f64 = 0.9;
/// The most steps of Newton's method at one level; 3 to 6 are usual.
const MOST_STEPS: usize = 40;
/// What a round trip may be off, relative to the largest component, for a colour to count as reached.
const REACHED: f64 = 5e-5;
/// The same, absolutely: in `f32` the sigmoids of very dark pure colours, narrow and steep, are no better than that.
const REACHED_ABSOLUTE: f64 = 1e-7;
/// Relative error of a dark colour at which it still is the colour meant.
const REACHED_ROUGHLY: f64 = 0.01;

/// Finds spectra for colours: the exact integrals of sigmoids, prepared for one observer, light and RGB space.
///
/// A sigmoid is piecewise linear, so that its tristimulus values are sums of its values at nodes, with weights
/// w_n = ∫ h_n L x̄ for the hat functions h_n: exact, not a quadrature. An upsampler is those 243 numbers and a matrix.
#[derive(Clone, Debug, PartialEq)]
pub struct Upsampler<R> {
    /// ∫ h_n L ā / ∫ L ā for each node and channel of XYZ.
    weights: [[R; 3]; NODES],
    /// From XYZ relative to white to RGB, and back; white is (1, 1, 1) in both.
    to_rgb: Matrix<R>,
    from_rgb: Matrix<R>,
}

impl<R: Real> Upsampler<R> {
    /// For reflectances seen under CIE D65 by the 2° observer of 1931.
    ///
    /// # Errors
    /// None for D65: the set-up only fails for lights.
    pub fn d65(space: &RgbSpace) -> Result<Self, UpsamplerError> {
        Self::new(&Observer::cie_1931_2deg(), &illuminants::D65.spectrum::<R>(Outside::Zero), space)
    }

    /// For reflectances seen under `light`, whose colour is taken to be white.
    ///
    /// # Errors
    /// [`UpsamplerError::White`] unless the tristimulus values of the light, and its components in the RGB space, are positive.
    pub fn new<S: Spectrum<R>>(observer: &Observer<R>, light: &S, space: &RgbSpace) -> Result<Self, UpsamplerError> {
        let mut weights = [[R::ZERO; 3]; NODES];
        for (index, weight) in weights.iter_mut().enumerate() {
            *weight = hat_integral(observer, light, index);
        }
        Self::of_weights(weights, space)
    }

    /// For spectra that are linear between products with a light at the nodes.
    pub(super) fn at_nodes(
        observer: &Observer<R>,
        light: impl Fn(R) -> R,
        space: &RgbSpace,
    ) -> Result<Self, UpsamplerError> {
        let flat = Constant::new(R::ONE).map_err(|_| UpsamplerError::White)?;
        let mut weights = [[R::ZERO; 3]; NODES];
        for (index, weight) in weights.iter_mut().enumerate() {
            let power = light(wavelength(index));
            *weight = hat_integral(observer, &flat, index).map(|integral| integral * power);
        }
        Self::of_weights(weights, space)
    }

    fn of_weights(mut weights: [[R; 3]; NODES], space: &RgbSpace) -> Result<Self, UpsamplerError> {
        let white = weights.iter().fold([R::ZERO; 3], |sum, weight| zip(sum, *weight, |sum, w| sum + w));
        let rgb = space.from_xyz(white.map(|v| v / white[1]));
        if !white.iter().chain(&rgb).all(|v| *v > R::ZERO && v.is_finite()) {
            return Err(UpsamplerError::White);
        }
        for weight in &mut weights {
            *weight = zip(*weight, white, |weight, white| weight / white);
        }
        let (none, [x, y, z]) = (R::ZERO, white.map(|v| v / white[1]));
        let columns = [[x, none, none], [none, y, none], [none, none, z]].map(|unit| space.from_xyz(unit));
        let to_rgb = zip(transposed(columns), rgb, |row, rgb| row.map(|value| value / rgb));
        Ok(Self { weights, to_rgb, from_rgb: Factored::new(&to_rgb).inverse() })
    }

    /// The RGB of a sigmoid: its colour under the light, relative to the light's own.
    #[must_use]
    pub fn colour(&self, sigmoid: &Sigmoid<R>) -> [R; 3] {
        apply(&self.to_rgb, self.evaluate(sigmoid.coefficients()).relative)
    }

    /// The sigmoid with the given linear RGB in [0, 1]³.
    ///
    /// The round trip is within 1e-12 (`f64`) or 1e-5 (`f32`) in each component over the whole of [0, 1]³ of sRGB under D65,
    /// corners and edges included (measured: 8e-15, 4e-6), and for dark colours, down to 1e-30, within 1e-7 (`f64`) or 3 % (`f32`) of the
    /// largest component. For another space or light, an answer is within 5e-5 of the largest component (of 1 minus the smallest,
    /// for bright colours) or 1e-7.
    ///
    /// **Method**: Gauss–Newton with step halving, which for three unknowns and three equations is Newton's method, on
    /// the residual σ⁻¹(X) − σ⁻¹(X₀) of the three tristimulus values relative to white, where σ is the sigmoid itself. Those are
    /// always in (0, 1), and nearly linear in the coefficients, as they would be exactly for a narrow-band observer: so it
    /// converges from grey where residuals in RGB or CIELAB need continuation. As σ(−U) = 1 − σ(U), bright colours are solved by
    /// their complements. Very dark saturated colours are approached from lighter ones, with U scaled like 1 / √ρ.
    ///
    /// # Errors
    /// [`UpsamplingError::Component`] outside [0, 1], and [`UpsamplingError::Unreachable`] where no sigmoid has this colour.
    ///
    /// Source: Jakob and Hanika 2019, with a residual of this crate's own.
    pub fn reflectance(&self, rgb: [R; 3]) -> Result<Sigmoid<R>, UpsamplingError> {
        if let Some(channel) = rgb.iter().position(|c| !(*c >= R::ZERO && *c <= R::ONE)) {
            return Err(UpsamplingError::Component { channel });
        }
        let [r, g, b] = rgb;
        if r == g && g == b {
            return Ok(Sigmoid::grey(r));
        }
        if r + g + b > R::from_f64(1.5) {
            let complement = self.dark(rgb.map(|c| R::ONE - c))?;
            return Ok(Sigmoid::known(complement.map(|c| -c)));
        }
        self.dark(rgb).map(Sigmoid::known)
    }

    /// The coefficients for a colour whose mean component is at most ½.
    fn dark(&self, rgb: [R; 3]) -> Result<[R; 3], UpsamplingError> {
        let size = largest(rgb);
        let target = size.max(R::from_f64(DARKEST) * R::EPSILON);
        let mut level = size.max(R::from_f64(START));
        // Divided first: the product of small numbers underflows.
        let wanted = |level: R| apply(&self.from_rgb, rgb.map(|c| c / size * level));
        let grey = [argument(wanted(level)[1]), R::ZERO, R::ZERO];
        let mut coefficients = self.solve(grey, wanted(level), level)?;
        let mut stride = R::from_f64(STRIDE);
        while level > target {
            let next = target.max(level * stride);
            match self.solve(scale(coefficients, level / next), wanted(next), next) {
                Ok(found) => (coefficients, level) = (found, next),
                Err(error) if stride > R::from_f64(SHORTEST_STRIDE) => return Err(error),
                Err(_) => stride = stride.sqrt(),
            }
        }
        Ok(if size < target { scale(coefficients, target / size) } else { coefficients })
    }

    /// Newton's method from a first guess to relative XYZ `wanted`, of a colour whose largest component is `level`.
    fn solve(&self, guess: [R; 3], wanted: [R; 3], level: R) -> Result<[R; 3], UpsamplingError> {
        if !wanted.iter().all(|v| *v > R::ZERO && *v < R::ONE) {
            return Err(UpsamplingError::Unreachable);
        }
        let finest = R::from_f64(16.0) * R::EPSILON;
        let arguments = wanted.map(argument);
        let mut best = guess;
        let mut here = self.evaluate(guess);
        let mut error = self.error(&here, wanted, level);
        for _ in 0..MOST_STEPS {
            if error <= finest {
                break;
            }
            let Some((next, there)) = self.step(best, &here, arguments) else { break };
            (best, here) = (next, there);
            error = self.error(&here, wanted, level);
        }
        let roughly = error <= R::from_f64(REACHED_ROUGHLY) && error * level <= R::from_f64(REACHED_ABSOLUTE);
        if roughly || error <= R::from_f64(REACHED) { Ok(best) } else { Err(UpsamplingError::Unreachable) }
    }

    /// One step, halved until the residual falls; `None` when it doesn't.
    fn step(&self, from: [R; 3], here: &Point<R>, arguments: [R; 3]) -> Option<([R; 3], Point<R>)> {
        let residual: [R; 3] = core::array::from_fn(|a| argument(here.relative[a]) - arguments[a]);
        let jacobian: Matrix<R> = core::array::from_fn(|a| {
            let value = here.relative[a];
            // d σ⁻¹(v) / d v = 1 / (4 (v (1 − v))^(3/2)), in two parts that don't underflow.
            let root = value.sqrt() * (R::ONE - value).sqrt();
            here.slope[a].map(|slope| R::from_f64(0.25) * slope / root / (value * (R::ONE - value)))
        });
        let full = Factored::new(&jacobian).solve(residual);
        let before = square(residual);
        let mut part = R::ONE;
        for _ in 0..12 {
            let coefficients = core::array::from_fn(|k| from[k] - part * full[k]);
            let there = self.evaluate(coefficients);
            let after = square(core::array::from_fn(|a| argument(there.relative[a]) - arguments[a]));
            if after < before {
                return Some((coefficients, there));
            }
            part *= R::HALF;
        }
        None
    }

    /// The largest error of a component of RGB, relative to `level`; infinite when it isn't a number.
    fn error(&self, here: &Point<R>, wanted: [R; 3], level: R) -> R {
        let differences = core::array::from_fn(|a| here.relative[a] - wanted[a]);
        largest(apply(&self.to_rgb, differences)) / level
    }

    fn evaluate(&self, coefficients: [R; 3]) -> Point<R> {
        let mut relative = [R::ZERO; 3];
        let mut slope = [[R::ZERO; 3]; 3];
        for (index, weight) in self.weights.iter().enumerate() {
            let z = position::<R>(wavelength(index));
            let [value, derivative] = sigmoid_and_slope(polynomial(coefficients, z));
            for a in 0..3 {
                let steep = weight[a] * derivative;
                relative[a] += weight[a] * value;
                slope[a][0] += steep;
                slope[a][1] += steep * z;
                slope[a][2] += steep * z * z;
            }
        }
        Point { relative, slope }
    }
}

/// XYZ relative to white of a sigmoid, and its derivatives by the coefficients.
struct Point<R> {
    relative: [R; 3],
    slope: Matrix<R>,
}

/// The wavelength of a node in nm.
pub(super) fn wavelength<R: Real>(index: usize) -> R {
    R::from_usize(380 + 5 * index)
}

/// ∫ h L ā over 380–780 nm for the hat function of a node.
fn hat_integral<R: Real, S: Spectrum<R>>(observer: &Observer<R>, light: &S, index: usize) -> [R; 3] {
    let nodes = [375, 380, 385].map(|node| R::from_usize(node + 5 * index));
    let hat = [R::ZERO, R::ONE, R::ZERO];
    let hat = PiecewiseLinear::from_table(&nodes, &hat, Outside::Zero);
    let (from, to) = (nodes[0].max(R::from_f64(380.0)), nodes[2].min(R::from_f64(780.0)));
    product_integrals(observer, &[&hat, light], from, to).values
}

/// The coefficients that give a dark reflectance divided by `factor`: ρ is about 1 / (4 U²).
fn scale<R: Real>(coefficients: [R; 3], factor: R) -> [R; 3] {
    let root = factor.sqrt();
    coefficients.map(|c| c * root)
}

fn square<R: Real>([x, y, z]: [R; 3]) -> R {
    x * x + y * y + z * z
}
