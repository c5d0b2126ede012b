//! Spheres of uniform radiance.

use spectral_core::Real;

use super::cone::{Cone, Horizon};
use super::double_word::{DoubleWord, wide_difference, wide_dot, widened};
use super::scale::power_of_two;
use crate::shape::{Receiver, Sphere};
use crate::vector::{cross, length};

/// The configuration factor from a receiver to a sphere, clipped at the receiver's horizon: irradiance over π times the sphere's
/// radiance.
///
/// (r/d)² cos θ for a sphere above the horizon, θ being the angle between the receiver's normal and the direction of the centre; the
/// contour integral over arc and chord where the horizon cuts the sphere, or an integral with positive terms where that cancels; 0
/// below.
///
/// Domain: everything that [`Sphere`] and [`Receiver`] take. From inside the sphere, where light comes from everywhere, 1; on the
/// sphere (1 + cos θ)/2, the limit from outside. Relative accuracy: 1e-12 (`f32`: 1e-5) of the factor for the rounded coordinates that
/// the shapes hold, for distances from the surface down to 1e-9 (`f32`: 1e-5) radii, for factors from 1e-60 (`f32`: 1e-20).
///
/// Source: Howell, "A Catalog of Radiation Heat Transfer Configuration Factors".
pub fn sphere_configuration_factor<R: Real>(sphere: &Sphere<R>, receiver: &Receiver<R>) -> R {
    let offset = wide_difference(sphere.centre(), receiver.position());
    let Some(scale) = power_of_two(offset.iter().fold(sphere.radius(), |m, x| m.max(x.value().abs()))) else {
        return R::ZERO;
    };
    let offset = offset.map(|x| x.scaled(scale));
    let radius = sphere.radius() * scale;
    let radius2 = DoubleWord::product(radius, radius);
    let distance2 = wide_dot(offset, offset);
    let outside = (distance2 - radius2).value();
    if !(outside >= R::ZERO) {
        return R::ONE;
    }
    let distance = distance2.value().sqrt();
    let normal = receiver.normal();
    let middle = wide_dot(offset, widened(normal));
    let cut = (radius2 * wide_dot(widened(normal), widened(normal)) - middle * middle).value();
    let (sine, cosine) = (radius / distance, outside.sqrt() / distance);
    let along = middle.value() / distance;
    if !(cut > R::ZERO) {
        return along.max(R::ZERO) * sine * sine;
    }
    let across = length(cross(offset.map(DoubleWord::value), normal)) / distance;
    if !(outside > R::ZERO) {
        // On the surface: half of (1 + cos θ), without the difference.
        let factor = if along < R::ZERO { across * across / (R::ONE - along) } else { R::ONE + along };
        return R::HALF * factor;
    }
    let cone = Cone { narrow: [sine, cosine], wide: [sine, cosine] };
    let chord = cosine * cut.sqrt() / distance;
    cone.cut(&Horizon { normal: [across, R::ZERO, along], chord, ends: -chord * chord })
}
