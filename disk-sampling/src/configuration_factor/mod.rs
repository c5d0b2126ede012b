//! Configuration factors in closed form: irradiance over π times radiance of an unobstructed light of uniform radiance.

mod cone;
mod disk;
mod double_word;
mod gauss;
mod polygon;
mod scale;
mod sphere;

pub use disk::{disk_configuration_factor, disk_irradiance_vector};
pub use polygon::polygon_configuration_factor;
pub use sphere::sphere_configuration_factor;
