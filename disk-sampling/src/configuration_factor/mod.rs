//! Configuration factors in closed form: irradiance over π times radiance of an unobstructed light of uniform radiance.

mod angle;
mod cone;
mod disk;
mod double_word;
mod gauss;
mod polygon;
mod scale;
mod sphere;
mod triangle;

pub use disk::{disk_configuration_factor, disk_irradiance_vector};
pub use polygon::{polygon_configuration_factor, polygon_irradiance_vector};
pub use sphere::sphere_configuration_factor;
