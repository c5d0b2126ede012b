//! What relighting does to a colour.

use core::iter::Sum;
use core::ops::Add;

use serde::Serialize;
use spectral_core::bilinear::{DivisorError, Reflection, Tensor};

/// From one light to another: X ↦ (X ⊘ from) ⊗ to, as two matrices.
///
/// Source: Granier and Damez 2004, section 7.2.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Relighting {
    relit: Reflection<f64>,
    reflectance: Reflection<f64>,
    condition: f64,
}

impl Relighting {
    /// By the product of a tensor; [`Tensor::classical`] is that of components.
    ///
    /// The lights are linear RGB of any scale, and may have negative components, as those outside the gamut do.
    ///
    /// # Errors
    /// [`DivisorError`] when `from` can't be divided by: by the classical product when a component is 0.
    pub fn new(tensor: &Tensor<f64>, from: [f64; 3], to: [f64; 3]) -> Result<Self, DivisorError> {
        let divisor = tensor.divisor(from)?;
        Ok(Self {
            relit: divisor.relighting(tensor, to),
            reflectance: divisor.relighting(tensor, [1.0; 3]),
            condition: divisor.condition(),
        })
    }

    /// The colour under the new light.
    #[inline]
    #[must_use]
    pub fn relit(&self, colour: [f64; 3]) -> [f64; 3] {
        self.relit.apply(colour)
    }

    /// The colour of what was lit, and scaled as it was: the quotient by the first light.
    #[inline]
    #[must_use]
    pub fn reflectance(&self, colour: [f64; 3]) -> [f64; 3] {
        self.reflectance.apply(colour)
    }

    /// How much the division may magnify errors of a pixel, relative to its largest component; at least 1.
    #[must_use]
    pub fn condition(&self) -> f64 {
        self.condition
    }

    /// Whether no pixel of finite `f32` overflows on the way.
    pub(super) fn is_usable(&self) -> bool {
        let matrices = [self.relit.matrix(), self.reflectance.matrix()];
        matrices.as_flattened().as_flattened().iter().all(|entry| entry.abs() <= 1e200)
    }

    /// Relights a row of pixels in place, within ±`limit`; or says which pixel and component is not finite.
    pub(super) fn relight_row(&self, row: &mut [[f32; 3]], limit: f32) -> Result<Tally, [usize; 2]> {
        let mut tally = Tally::default();
        for (x, pixel) in row.iter_mut().enumerate() {
            if let Some(component) = pixel.iter().position(|c| !c.is_finite()) {
                return Err([x, component]);
            }
            let colour = pixel.map(f64::from);
            tally.impossible += u64::from(self.reflectance(colour).iter().any(|c| *c < 0.0));
            let relit = self.relit(colour);
            let range = f64::from(limit);
            tally.limited += u64::from(!relit.iter().all(|c| c.abs() <= range));
            #[allow(clippy::cast_possible_truncation, reason = "rounded to what files hold")]
            let rounded = relit.map(|c| (c as f32).clamp(-limit, limit));
            tally.negative += u64::from(rounded.iter().any(|c| *c < 0.0));
            *pixel = rounded;
        }
        Ok(tally)
    }
}

/// Pixels for which the operator has no good answer.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Tally {
    /// Pixels whose reflectance comes out with a negative component: by this operator no surface looks so under the first light.
    pub impossible: u64,
    /// Pixels with a negative component under the new light: kept in `OpenEXR`, 0 in Radiance pictures.
    pub negative: u64,
    /// Pixels with a component out of the range of the file, which became the largest that it holds.
    pub limited: u64,
}

impl Add for Tally {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self {
            impossible: self.impossible + other.impossible,
            negative: self.negative + other.negative,
            limited: self.limited + other.limited,
        }
    }
}

impl Sum for Tally {
    fn sum<I: Iterator<Item = Self>>(tallies: I) -> Self {
        tallies.fold(Self::default(), Add::add)
    }
}
