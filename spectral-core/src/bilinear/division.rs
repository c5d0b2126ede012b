//! Division of colours.

use super::DivisorError;
use super::tensor::{Reflection, Tensor};
use crate::Real;
use crate::matrix::{Factored, largest, norm};

/// A colour D to divide by: ⊘ D undoes ⊗ D.
///
/// The matrix Σ D_e K_e of the divisor, scaled by the largest component of D, is factored once by rotations; a
/// quotient solves with the factors.
///
/// Source: Granier and Damez 2004, section 4.1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Divisor<R> {
    factors: Factored<R>,
    scale: R,
    condition: R,
}

impl<R: Real> Tensor<R> {
    /// A colour to divide by, of any scale.
    ///
    /// # Errors
    /// [`DivisorError::Singular`] when [`condition`](Divisor::condition) · ε ≥ 1: black; by the classical product, each
    /// colour with a component 0; otherwise the neighbourhood of a cubic surface in the space of colours.
    /// [`DivisorError::NotFinite`] when a component isn't finite.
    pub fn divisor(&self, colour: [R; 3]) -> Result<Divisor<R>, DivisorError> {
        let scale = largest(colour);
        if !scale.is_finite() {
            return Err(DivisorError::NotFinite);
        }
        if scale == R::ZERO {
            return Err(DivisorError::Singular);
        }
        let unit = colour.map(|c| c / scale);
        let factors = Factored::new(&self.reflection(unit).matrix());
        let condition = self.size(unit) * norm(&factors.inverse());
        if !(condition * R::EPSILON < R::ONE) {
            return Err(DivisorError::Singular);
        }
        Ok(Divisor { factors, scale, condition })
    }

    /// The norm of the matrix of a colour, with all terms taken by their magnitudes: what its rounding is relative to.
    fn size(&self, colour: [R; 3]) -> R {
        let [r, g, b] = colour;
        let differences = [(r - g).abs(), (g - b).abs(), (b - r).abs()];
        let transfer = self.transfer();
        largest(core::array::from_fn(|c| {
            let terms = transfer[c].iter().zip(differences).fold(R::ZERO, |sum, (k, d)| sum + k.abs() * d);
            colour[c].abs() + R::TWO * terms
        }))
    }
}

impl<R: Real> Divisor<R> {
    /// C ⊘ D: the colour X with X ⊗ D = C.
    ///
    /// For C = X ⊗ D as computed, the largest error of a component of X is at most 16 ε
    /// [`condition`](Self::condition) times the largest component of X, where nothing overflows or underflows.
    #[inline]
    #[must_use]
    pub fn quotient(&self, colour: [R; 3]) -> [R; 3] {
        self.factors.solve(colour).map(|c| c / self.scale)
    }

    /// The condition number of the division, at least 1: ‖|R|‖∞ ‖R⁻¹‖∞ with R the divisor's matrix and |R| the same with the
    /// terms of its entries taken by their magnitudes, so that it also covers how R itself was rounded.
    ///
    /// 1 for white. At most about 1/ε: above that a divisor is singular.
    #[must_use]
    pub const fn condition(&self) -> R {
        self.condition
    }

    /// The matrix that takes a colour seen under this light to that under another, X ↦ (X ⊘ D) ⊗ `light`: relighting of a picture
    /// costs 9 multiplications a pixel.
    ///
    /// `tensor` is the one of the division. Source: Granier and Damez 2004, section 7.2.
    #[must_use]
    pub fn relighting(&self, tensor: &Tensor<R>, light: [R; 3]) -> Reflection<R> {
        let inverse = self.factors.inverse().map(|row| row.map(|entry| entry / self.scale));
        tensor.reflection(light).after(inverse)
    }
}
