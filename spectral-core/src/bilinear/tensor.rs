//! The coefficients of the bilinear model, and products with them.

use super::{AlphaError, TensorError};
use crate::Real;
use crate::array::{transposed, zip};
use crate::matrix::{Matrix, apply};

/// The pairs of components whose differences enter a product: red–green, green–blue, blue–red.
const PAIRS: [[usize; 2]; 3] = [[0, 1], [1, 2], [2, 0]];

/// The 27 coefficients k^c_{d,e} of the bilinear model, symmetric in d and e, and coherent: K_r + K_g + K_b = I.
///
/// Both conditions hold by construction, because only the nine coefficients with d ≠ e are stored; the others follow
/// from them: k^c_{d,d} = δ_cd − Σ_{e≠d} k^c_{d,e}.
///
/// Source: Granier and Damez 2004, equations 4, 5 and 9.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tensor<R> {
    /// For each channel c: k^c_{r,g}, k^c_{g,b}, k^c_{b,r}.
    transfer: Matrix<R>,
}

impl<R: Real> Default for Tensor<R> {
    fn default() -> Self {
        Self::classical()
    }
}

impl<R: Real> Tensor<R> {
    /// The classical product, component by component: no transfer.
    ///
    /// Right when the light is white, and in spaces whose colour-matching functions don't overlap (Borges 1991).
    #[must_use]
    pub const fn classical() -> Self {
        Self { transfer: [[R::ZERO; 3]; 3] }
    }

    /// A tensor from its coefficients off the diagonal: for each channel c, k^c_{r,g}, k^c_{g,b} and k^c_{b,r}.
    ///
    /// Every such tensor is symmetric and coherent.
    ///
    /// # Errors
    /// [`TensorError::NotFinite`] when a coefficient isn't finite.
    pub fn new(transfer: [[R; 3]; 3]) -> Result<Self, TensorError> {
        let finite = transfer.as_flattened().iter().all(|k| k.is_finite());
        if finite { Ok(Self { transfer }) } else { Err(TensorError::NotFinite) }
    }

    /// A tensor of the crate's own constants.
    pub(super) fn known(transfer: &Matrix<f64>) -> Self {
        Self { transfer: transfer.map(|row| row.map(R::from_f64)) }
    }

    /// A tensor from the matrices K_r, K_g, K_b as the paper prints them: `matrices[e][c][d]` = k^c_{e,d}.
    ///
    /// Where symmetry or coherence fail by rounding, up to `tolerance`, they are restored with the least change
    /// in the sum of squares over all 27 coefficients.
    ///
    /// # Errors
    /// [`TensorError`] when a coefficient isn't finite, or one of the two conditions fails by more than `tolerance`, which
    /// must be 0 or positive: the error says where.
    pub fn from_matrices(matrices: &[[[R; 3]; 3]; 3], tolerance: R) -> Result<Self, TensorError> {
        if !matrices.as_flattened().as_flattened().iter().all(|k| k.is_finite()) {
            return Err(TensorError::NotFinite);
        }
        let [red, green, blue] = matrices;
        for (channel, ((r, g), b)) in red.iter().zip(green).zip(blue).enumerate() {
            let ([_, rg, rb], [gr, _, gb], [br, bg, _]) = (*r, *g, *b);
            for (pair, difference) in PAIRS.into_iter().zip([rg - gr, gb - bg, br - rb]) {
                if !(difference.abs() <= tolerance) {
                    return Err(TensorError::Asymmetric { channel, pair });
                }
            }
            for (column, ((r, g), b)) in r.iter().zip(g).zip(b).enumerate() {
                let sum = *r + *g + *b;
                let unit = if channel == column { R::ONE } else { R::ZERO };
                if !((sum - unit).abs() <= tolerance) {
                    return Err(TensorError::Incoherent { channel, column });
                }
            }
        }
        Ok(Self::nearest(matrices))
    }

    /// The symmetric and coherent tensor nearest to any coefficients, `matrices[e][c][d]`: with the least sum of squared
    /// changes over all 27.
    ///
    /// For each channel the coefficients are a matrix A that must be symmetric with A·1 = u (the unit vector of the channel).
    /// With A made symmetric and r = u − A·1, the least change is (r 1ᵀ + 1 rᵀ) / 3 − (Σ r) 1 1ᵀ / 9.
    pub(super) fn nearest(matrices: &[[[R; 3]; 3]; 3]) -> Self {
        let (three, nine) = (R::from_f64(3.0), R::from_f64(9.0));
        let mean = |a: R, b: R| R::HALF * (a + b);
        let transfer =
            zip(transposed(*matrices), units::<R>(), |[[rr, rg, rb], [gr, gg, gb], [br, bg, bb]], [ur, ug, ub]| {
                let (rr, gg, bb) = (mean(rr, rr), mean(gg, gg), mean(bb, bb));
                let (rg, gb, br) = (mean(rg, gr), mean(gb, bg), mean(br, rb));
                let (r, g, b) = (ur - (rr + rg + br), ug - (rg + gg + gb), ub - (br + gb + bb));
                let common = (r + g + b) / nine;
                [rg + ((r + g) / three - common), gb + ((g + b) / three - common), br + ((b + r) / three - common)]
            });
        Self { transfer }
    }

    /// The coefficients off the diagonal: for each channel c, k^c_{r,g}, k^c_{g,b} and k^c_{b,r}.
    #[must_use]
    pub const fn transfer(&self) -> [[R; 3]; 3] {
        self.transfer
    }

    /// All coefficients as the matrices K_r, K_g, K_b: `matrices()[e][c][d]` = k^c_{e,d}.
    ///
    /// Symmetric to the bit; coherent within 2 ε times the largest coefficient of the channel.
    #[must_use]
    pub fn matrices(&self) -> [[[R; 3]; 3]; 3] {
        transposed(zip(self.transfer, units::<R>(), |[rg, gb, br], [r, g, b]| {
            [[r - (rg + br), rg, br], [rg, g - (rg + gb), gb], [br, gb, b - (gb + br)]]
        }))
    }

    /// C ⊗ D: the colour of light C reflected by a surface of colour D, or of two filters.
    ///
    /// (C ⊗ D)_c = Σ_{d,e} k^c_{d,e} C_d D_e, computed as the [module](super) says.
    ///
    /// - It commutes to the bit, and a white factor (k, k, k) gives k·D to the bit. Without transfer into a channel (α = 0)
    ///   the component is C_c D_c to the bit.
    /// - |computed − exact| ≤ 4 ε (|C_c D_c| + Σ |k^c_{d,e} (C_d − C_e)(D_d − D_e)|), where nothing underflows.
    /// - Defined while |C_d − C_e| |D_d − D_e| doesn't overflow; beyond that the result is infinite or NaN.
    ///
    /// Source: Granier and Damez 2004, section 4.1.
    #[inline]
    #[must_use]
    pub fn product(&self, c: [R; 3], d: [R; 3]) -> [R; 3] {
        let [p, q, r] = differences(c);
        let [s, t, u] = differences(d);
        let products = [p * s, q * t, r * u];
        core::array::from_fn(|channel| {
            let [rg, gb, br] = self.transfer[channel];
            // The first 0 is positive, whatever the signs of the products: subtracting it keeps the sign of a zero.
            let transferred = R::ZERO + rg * products[0] + gb * products[1] + br * products[2];
            c[channel] * d[channel] - transferred
        })
    }

    /// The matrix R = Σ ρ_e K_e of a material, so that [`apply`](Reflection::apply) does ⊗ ρ with 9 multiplications:
    /// for diffuse materials, and those whose directional part has no colour.
    ///
    /// Source: Granier and Damez 2004, equation 7 and section 4.3.
    #[must_use]
    pub fn reflection(&self, reflectance: [R; 3]) -> Reflection<R> {
        let [p, q, r] = differences(reflectance);
        let matrix = core::array::from_fn(|channel| {
            let [rg, gb, br] = self.transfer[channel];
            let (rg, gb, br) = (rg * p, gb * q, br * r);
            let mut row = [br - rg, rg - gb, gb - br];
            row[channel] += reflectance[channel];
            row
        });
        Reflection { matrix }
    }

    /// The tensor with k^c_{c,c} = 1 − α_c for each channel c, and the channel's other coefficients in proportion: the
    /// user's control of how much is transferred into a channel.
    ///
    /// β_c = α_c / (1 − k^c_{c,c}), and the channel's coefficients but k^c_{c,c} are multiplied by β_c. α_c = 0 gives the
    /// classical product in that channel, to the bit; as α grows from 0 the product changes continuously (linearly in α).
    ///
    /// # Errors
    /// [`AlphaError`] when an α is negative or not finite, and when α_c > 0 while 1 − k^c_{c,c} ≤ 0, as it is in
    /// the classical tensor and, for red, green and blue alike, in those of wide spaces such as Rec. 2020: there the transfer
    /// already is "negative", and [`scaled`](Self::scaled) is the control that serves.
    ///
    /// Source: Granier and Damez 2004, section 6.2.
    pub fn with_alpha(&self, alpha: [R; 3]) -> Result<Self, AlphaError> {
        let mut factors = [R::ZERO; 3];
        for (channel, ((factor, alpha), transferred)) in factors.iter_mut().zip(alpha).zip(self.alpha()).enumerate() {
            if !(alpha >= R::ZERO && alpha.is_finite()) {
                return Err(AlphaError::Value { channel });
            }
            if alpha > R::ZERO {
                *factor = alpha / transferred;
                if !(*factor > R::ZERO && factor.is_finite()) {
                    return Err(AlphaError::NoTransfer { channel });
                }
            }
        }
        self.scaled(factors).map_err(|_| AlphaError::Value { channel: 0 })
    }

    /// The α of each channel, 1 − k^c_{c,c}: how much is transferred into it from the others; can be negative.
    #[must_use]
    pub fn alpha(&self) -> [R; 3] {
        let [[red_green, _, blue_red], [green_red, green_blue, _], [_, blue_green, red_blue]] = self.transfer;
        [red_green + blue_red, green_red + green_blue, blue_green + red_blue]
    }

    /// The tensor with the transfer into each channel multiplied by a factor β: 0 is the classical product, 1 this
    /// tensor, and the product is linear in β in between.
    ///
    /// # Errors
    /// [`TensorError::NotFinite`] when a coefficient comes out infinite or NaN.
    pub fn scaled(&self, factors: [R; 3]) -> Result<Self, TensorError> {
        let mut transfer = self.transfer;
        for (row, beta) in transfer.iter_mut().zip(factors) {
            *row = row.map(|k| beta * k);
        }
        Self::new(transfer)
    }
}

/// The rows of the unit matrix.
fn units<R: Real>() -> [[R; 3]; 3] {
    let (one, none) = (R::ONE, R::ZERO);
    [[one, none, none], [none, one, none], [none, none, one]]
}

/// The differences of the [`PAIRS`].
#[inline]
fn differences<R: Real>([r, g, b]: [R; 3]) -> [R; 3] {
    [r - g, g - b, b - r]
}

/// What a material of one colour does to the light: a matrix; see [`Tensor::reflection`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reflection<R> {
    matrix: Matrix<R>,
}

impl<R: Real> Reflection<R> {
    /// The colour of the reflected light, R L.
    ///
    /// Equal to [`Tensor::product`] of light and reflectance but for rounding, within
    /// 4 ε (|L_c ρ_c| + Σ |k^c_{d,e} (ρ_d − ρ_e)| (|L_d| + |L_e|)).
    #[inline]
    #[must_use]
    pub fn apply(&self, light: [R; 3]) -> [R; 3] {
        apply(&self.matrix, light)
    }

    /// The matrix R, row by row.
    #[must_use]
    pub const fn matrix(&self) -> [[R; 3]; 3] {
        self.matrix
    }

    /// What two reflections do, one after the other: the matrix product, this one being the later.
    ///
    /// With the matrix of a division it makes one matrix of a relighting; see
    /// [`Divisor::relighting`](super::Divisor::relighting).
    #[must_use]
    pub fn after(&self, [a, b, c]: [[R; 3]; 3]) -> Self {
        let combine = |[p, q, r]: [R; 3]| core::array::from_fn(|k| p * a[k] + q * b[k] + r * c[k]);
        Self { matrix: self.matrix.map(combine) }
    }
}
