//! Scenes: a documented subset of Mitsuba 3's XML, read into plain data, and the built-in scenes.

mod data;
mod error;

pub use data::*;
pub use error::SceneError;
