//! Coefficients from colour-matching functions.

use super::EstimateError;
use super::tensor::Tensor;
use crate::array::{transposed, zip};
use crate::colour::RgbSpace;
use crate::integrate::Sum;
use crate::matrix::{Factored, Matrix, norm};
use crate::{Observer, Real};

/// Estimated coefficients of the bilinear model.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate<R> {
    /// ⟨b_d b_e, b̄_c⟩ as it comes from the integrals, `raw[e][c][d]`: symmetric to rounding, not coherent.
    pub raw: [[[R; 3]; 3]; 3],
    /// The symmetric and coherent tensor nearest to it.
    pub tensor: Tensor<R>,
}

/// The bilinear coefficients for any three colour-matching functions, given at `count` equidistant wavelengths.
///
/// `node(i)` is (r̄, ḡ, b̄) at the i-th wavelength, i < `count`; it is asked for some three times each. The functions are
/// linear between the nodes and 0 outside; they may be negative, but their integrals must be positive. The step doesn't matter.
///
/// 1. Each function is normalised to unit integral, so that white is (1, 1, 1) under equal energy. To have white mean
///    another light, multiply the functions by its spectral power.
/// 2. The dual basis b = M b̄ has M⁻¹ = ⟨b̄_i, b̄_j⟩ (eq. 12).
/// 3. k^c_{d,e} = ⟨b_d b_e, b̄_c⟩ (eq. 4); these integrals of cubic polynomials are exact but for rounding.
/// 4. The coefficients are changed as little as possible, in the sum of squares over all 27, so that they become symmetric
///    and coherent (section 5.2). The change is not small: up to 0.09 for the functions of ISO RGB.
///
/// Works in `f32`: for the spaces of this crate the result is within 1e-7 of that in `f64`.
///
/// # Errors
/// [`EstimateError`]: fewer than two nodes, nodes that aren't finite, integrals that aren't positive, dependent functions.
///
/// Source: Granier and Damez 2004, section 5.2.
pub fn estimate<R: Real>(count: usize, node: impl Fn(usize) -> [R; 3]) -> Result<Estimate<R>, EstimateError> {
    let integrals = integrals(count, &node)?;
    for (channel, integral) in integrals.iter().enumerate() {
        if !(*integral >= R::MIN_POSITIVE && integral.is_finite()) {
            return Err(EstimateError::Integral { channel });
        }
    }
    let normalised = |index: usize| {
        let cmf = node(index);
        zip(cmf, integrals, |cmf, integral| cmf / integral)
    };
    let (gram, triple) = moments(count, normalised);
    let factors = Factored::new(&gram);
    let inverse = factors.inverse();
    if !(norm(&gram) * norm(&inverse) * R::EPSILON < R::ONE) {
        return Err(EstimateError::Dependent);
    }
    let raw = coefficients(&inverse, &triple);
    let tensor = Tensor::nearest(&raw);
    Tensor::new(tensor.transfer()).map_err(|_| EstimateError::Dependent)?;
    Ok(Estimate { raw, tensor })
}

/// The bilinear coefficients for an RGB space, by the recipe that reproduces the printed ones of ISO RGB for Rec. 709.
///
/// The functions are M diag(W) (x̄/∫x̄, ȳ/∫ȳ, z̄/∫z̄), with x̄, ȳ, z̄ those of CIE 1931 at 10 nm over 380–780 nm, W the XYZ
/// of the space's white and M its matrix from XYZ: equal energy is moved to the space's white by a scaling in XYZ.
///
/// # Errors
/// As [`estimate`]; none for the spaces of this crate.
pub fn estimate_rgb<R: Real>(space: &RgbSpace) -> Result<Estimate<R>, EstimateError> {
    const COUNT: usize = 41;
    let observer = Observer::<R>::cie_1931_2deg();
    let xyz = |index: usize| observer.value(R::from_usize(380 + 10 * index));
    let white = space.white().map(R::from_f64);
    let integrals = integrals(COUNT, &xyz)?;
    estimate(COUNT, |index| {
        let cmf = xyz(index);
        space.from_xyz(zip(zip(cmf, integrals, |cmf, integral| cmf / integral), white, |share, white| share * white))
    })
}

/// ∫ of each function in units of the step, by the trapezoidal rule, exact for piecewise linear functions.
fn integrals<R: Real>(count: usize, node: &impl Fn(usize) -> [R; 3]) -> Result<[R; 3], EstimateError> {
    if count < 2 {
        return Err(EstimateError::TooFewNodes { count });
    }
    let mut sums = [Sum::<R>::default(); 3];
    for index in 0..count {
        let weight = if index == 0 || index == count - 1 { R::HALF } else { R::ONE };
        for (sum, value) in sums.iter_mut().zip(node(index)) {
            if !value.is_finite() {
                return Err(EstimateError::Node { index });
            }
            sum.add(weight * value);
        }
    }
    Ok(sums.map(Sum::value))
}

/// ⟨b̄_a, b̄_b⟩ and ⟨b̄_a b̄_b, b̄_c⟩ by Simpson's rule, exact for polynomials of degree 3.
fn moments<R: Real>(count: usize, node: impl Fn(usize) -> [R; 3]) -> (Matrix<R>, [Matrix<R>; 3]) {
    let mut gram = [[Sum::<R>::default(); 3]; 3];
    let mut triple = [[[Sum::<R>::default(); 3]; 3]; 3];
    let mut add = |weight: R, v: [R; 3]| {
        for a in 0..3 {
            for b in 0..3 {
                let product = weight * v[a] * v[b];
                gram[a][b].add(product);
                for c in 0..3 {
                    triple[a][b][c].add(product * v[c]);
                }
            }
        }
    };
    let (sixth, two_thirds) = (R::ONE / R::from_f64(6.0), R::TWO / R::from_f64(3.0));
    let mut before = node(0);
    for index in 1..count {
        let after = node(index);
        add(sixth, before);
        add(two_thirds, zip(before, after, |before, after| R::HALF * (before + after)));
        add(sixth, after);
        before = after;
    }
    (gram.map(|row| row.map(Sum::value)), triple.map(|matrix| matrix.map(|row| row.map(Sum::value))))
}

/// k^c_{d,e} = Σ_{a,b} M_{d,a} M_{e,b} ⟨b̄_a b̄_b, b̄_c⟩, as `[e][c][d]`.
fn coefficients<R: Real>(dual: &Matrix<R>, triple: &[Matrix<R>; 3]) -> [Matrix<R>; 3] {
    let dot = |[a, b, c]: [R; 3], [x, y, z]: [R; 3]| a * x + b * y + c * z;
    dual.map(|by_e| {
        let inner = triple.map(|by_a| transposed(by_a).map(|by_c| dot(by_e, by_c)));
        transposed(inner).map(|by_c| dual.map(|by_d| dot(by_d, by_c)))
    })
}
