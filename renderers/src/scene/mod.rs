//! Scenes: a documented subset of Mitsuba 3's XML, read into plain data, and the built-in scenes.

mod bsdf;
mod data;
mod emitter;
mod error;
mod load;
mod obj;
mod props;
mod sensor;
mod shape;
mod source;
mod spectrum;
mod transform;
mod xml;

pub use bsdf::DISPERSIVE_GLASSES;
pub use data::*;
pub use error::SceneError;
pub use load::load;
pub use source::Source;
pub use spectrum::parse_file as parse_spectrum_file;
