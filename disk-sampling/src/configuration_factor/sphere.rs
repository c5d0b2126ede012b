//! Spheres of uniform radiance.

use spectral_core::Real;

use super::cone::Cone;
use super::double_word::{DoubleWord, wide_difference, wide_dot, widened};
use super::scale::power_of_two;
use crate::shape::{Receiver, Sphere};
use crate::vector::{cross, length};

/// The configuration factor from a receiver to a sphere, clipped at the receiver's horizon.
pub fn sphere_configuration_factor<R: Real>(sphere: &Sphere<R>, receiver: &Receiver<R>) -> R {
    let offset = wide_difference(sphere.centre(), receiver.position());
    let Some(scale) = power_of_two(offset.iter().fold(sphere.radius(), |m, x| m.max(x.value().abs()))) else {
        return R::ZERO;
    };
    let offset = offset.map(|x| x * scale);
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
    let cone = Cone { narrow: [sine, cosine], wide: [sine, cosine] };
    cone.cut([across, R::ZERO, along], cosine * cut.sqrt() / distance)
}
