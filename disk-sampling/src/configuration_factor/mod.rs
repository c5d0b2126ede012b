//! Configuration factors in closed form: irradiance over π times radiance of an unobstructed light of uniform radiance.

mod angle;
mod cone;
mod disk;
mod double_word;
mod gauss;
mod polygon;
mod rectangle;
mod scale;
mod sphere;
mod triangle;

use spectral_core::Real;

pub use disk::{
    disk_configuration_factor, disk_irradiance_vector, disk_parallel_factor, disk_perpendicular_factor,
    on_axis_disk_factor,
};
pub use polygon::{polygon_configuration_factor, polygon_irradiance_vector};
pub use rectangle::{rectangle_parallel_factor, rectangle_perpendicular_factor};
pub use sphere::sphere_configuration_factor;

/// Whether a sum of terms of the given total size keeps enough digits where it comes out as `sum`: all but 5 bits of 24, all but 7 of 53.
fn keeps_digits<R: Real>(sum: R, terms: R) -> bool {
    let loss = R::from_f64(if R::EPSILON.to_f64() < 1e-10 { 128.0 } else { 32.0 });
    sum > R::ZERO && sum * loss >= terms
}
