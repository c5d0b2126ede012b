//! Configuration factors in closed form: irradiance over π times radiance of an unobstructed light of uniform radiance.

mod polygon;

pub use polygon::polygon_configuration_factor;
