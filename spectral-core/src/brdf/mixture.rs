//! Sums of models.

use super::direction::unit;
use super::{Brdf, BrdfError, Lambert, Sample, Ward};
use crate::Real;

/// A weighted sum of Lambert's and another model, ρ_d/π + ρ_s f, sampled in proportion to the weights.
pub(super) struct Mixture<'a, R, M> {
    pub(super) diffuse: R,
    pub(super) specular: R,
    pub(super) model: &'a M,
}

impl<R: Real, M: Brdf<R>> Mixture<'_, R, M> {
    /// The probability of the Lambertian part; 1 if there is none at all.
    fn chance(&self) -> R {
        if self.specular > R::ZERO { self.diffuse / (self.diffuse + self.specular) } else { R::ONE }
    }

    pub(super) fn evaluate(&self, light: [R; 3], view: [R; 3]) -> R {
        let diffuse = self.diffuse * Lambert.evaluate(light, view);
        if self.specular > R::ZERO { diffuse + self.specular * self.model.evaluate(light, view) } else { diffuse }
    }

    pub(super) fn sample(&self, view: [R; 3], u: [R; 3]) -> Option<Sample<R>> {
        let chance = self.chance();
        let u2 = unit(u[2]);
        if !(self.specular > R::ZERO) {
            let sample = Lambert.sample(view, u)?;
            return Some(Sample { weight: self.diffuse, ..sample });
        }
        if !(self.diffuse > R::ZERO) {
            let sample = self.model.sample(view, u)?;
            return Some(Sample { weight: self.specular * sample.weight, ..sample });
        }
        let (drawn, glossy) = if u2 < chance {
            let drawn = Lambert.sample(view, [u[0], u[1], u2 / chance])?;
            (drawn, self.glossy(drawn.direction, view))
        } else {
            let drawn = self.model.sample(view, [u[0], u[1], (u2 - chance) / (R::ONE - chance)])?;
            (drawn, (drawn.pdf, drawn.weight))
        };
        let diffuse = Lambert.pdf(drawn.direction, view);
        Some(self.combine(drawn.direction, diffuse, glossy))
    }

    /// The glossy part's density and weight of a direction that it didn't draw.
    fn glossy(&self, light: [R; 3], view: [R; 3]) -> (R, R) {
        let pdf = self.model.pdf(light, view);
        let weight = if pdf > R::ZERO { self.model.evaluate(light, view) * light[2] / pdf } else { R::ZERO };
        (pdf, weight)
    }

    /// The weight is the parts' mean weight, by their densities at the direction: it can't be above the largest.
    fn combine(&self, direction: [R; 3], diffuse: R, (glossy, weight): (R, R)) -> Sample<R> {
        let chance = self.chance();
        let (of_diffuse, of_glossy) = (chance * diffuse, (R::ONE - chance) * glossy);
        let share = if of_glossy > R::ZERO { R::ONE / (R::ONE + of_diffuse / of_glossy) } else { R::ZERO };
        let mean = (R::ONE - share) + share * weight;
        Sample { direction, pdf: (of_diffuse + of_glossy).min(R::MAX), weight: (self.diffuse + self.specular) * mean }
    }

    pub(super) fn pdf(&self, light: [R; 3], view: [R; 3]) -> R {
        let chance = self.chance();
        let diffuse = chance * Lambert.pdf(light, view);
        if self.specular > R::ZERO { diffuse + (R::ONE - chance) * self.model.pdf(light, view) } else { diffuse }
    }

    /// By the Lambertian part if there is one.
    pub(super) fn invert(&self, light: [R; 3], view: [R; 3]) -> Option<[R; 3]> {
        let chance = self.chance();
        if chance > R::ZERO {
            let [u0, u1, u2] = Lambert.invert(light, view)?;
            return Some([u0, u1, u2 * chance]);
        }
        self.model.invert(light, view)
    }

    pub(super) fn albedo(&self, view: [R; 3]) -> R {
        let diffuse = self.diffuse * Lambert.albedo(view);
        if self.specular > R::ZERO { diffuse + self.specular * self.model.albedo(view) } else { diffuse }
    }
}

/// A glossy coat over a diffuse body: ρ_d/π + ρ_s f in 1/sr, with f of the Ward family.
///
/// Sampled by both parts in proportion to ρ_d and ρ_s; a black one (both 0) as a diffuse one, with weight 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Glossy<R> {
    diffuse: R,
    specular: R,
    model: Ward<R>,
}

impl<R: Real> Glossy<R> {
    /// The sum of a diffuse part of reflectance `diffuse` and `specular` times `model`.
    ///
    /// # Errors
    /// [`BrdfError::Reflectance`] for one outside [0, 1], [`BrdfError::Energy`] for a sum above 1 by more than rounding (4 ε).
    pub fn new(diffuse: R, specular: R, model: Ward<R>) -> Result<Self, BrdfError> {
        let valid = |rho: R| rho >= R::ZERO && rho <= R::ONE;
        if !(valid(diffuse) && valid(specular)) {
            return Err(BrdfError::Reflectance);
        }
        if !(diffuse + specular <= R::ONE + R::from_f64(4.0) * R::EPSILON) {
            return Err(BrdfError::Energy);
        }
        Ok(Self { diffuse, specular, model })
    }

    /// The diffuse and the specular reflectance.
    pub const fn reflectances(&self) -> [R; 2] {
        [self.diffuse, self.specular]
    }

    /// The glossy part.
    pub const fn model(&self) -> &Ward<R> {
        &self.model
    }

    const fn mixture(&self) -> Mixture<'_, R, Ward<R>> {
        Mixture { diffuse: self.diffuse, specular: self.specular, model: &self.model }
    }
}

impl<R: Real> Brdf<R> for Glossy<R> {
    fn evaluate(&self, light: [R; 3], view: [R; 3]) -> R {
        self.mixture().evaluate(light, view)
    }

    fn sample(&self, view: [R; 3], u: [R; 3]) -> Option<Sample<R>> {
        self.mixture().sample(view, u)
    }

    fn pdf(&self, light: [R; 3], view: [R; 3]) -> R {
        self.mixture().pdf(light, view)
    }

    fn invert(&self, light: [R; 3], view: [R; 3]) -> Option<[R; 3]> {
        self.mixture().invert(light, view)
    }

    fn albedo(&self, view: [R; 3]) -> R {
        self.mixture().albedo(view)
    }
}
