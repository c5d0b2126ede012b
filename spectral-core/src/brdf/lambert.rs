//! Ideal diffuse reflection.

use super::direction::{above, floor, unit};
use super::{Brdf, Sample};
use crate::Real;

/// Lambert's model of reflectance 1: 1/π in 1/sr; sampled by the cosine.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Lambert;

impl<R: Real> Brdf<R> for Lambert {
    fn evaluate(&self, light: [R; 3], view: [R; 3]) -> R {
        if above(light).is_some() && above(view).is_some() { R::ONE / R::PI } else { R::ZERO }
    }

    fn sample(&self, view: [R; 3], u: [R; 3]) -> Option<Sample<R>> {
        above(view)?;
        let u0 = unit(u[0]);
        let (radius, angle) = (u0.sqrt(), R::TWO * R::PI * unit(u[1]));
        let z = (R::ONE - u0).sqrt().max(floor());
        let direction = [radius * angle.cos(), radius * angle.sin(), z];
        Some(Sample { direction, pdf: z / R::PI, weight: R::ONE })
    }

    fn pdf(&self, light: [R; 3], view: [R; 3]) -> R {
        match (above(light), above(view)) {
            (Some(light), Some(_)) => light[2] / R::PI,
            _ => R::ZERO,
        }
    }

    fn invert(&self, light: [R; 3], view: [R; 3]) -> Option<[R; 3]> {
        above(view)?;
        let [x, y, _] = above(light)?;
        Some([unit(x * x + y * y), turn(x, y), R::HALF])
    }

    /// 1 exactly, for a view above the surface.
    fn albedo(&self, view: [R; 3]) -> R {
        if above(view).is_some() { R::ONE } else { R::ZERO }
    }
}

/// The angle of a point in turns, in [0, 1).
#[inline]
pub(super) fn turn<R: Real>(x: R, y: R) -> R {
    let turn = y.atan2(x) / (R::TWO * R::PI);
    unit(if turn < R::ZERO { turn + R::ONE } else { turn })
}
