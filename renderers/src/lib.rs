//! Reference renderers on `spectral-core`, with scenes, images and reports: what the `spectral` command is made of.

extern crate alloc;

pub mod compare;
pub mod geometry;
pub mod image;
pub mod light;
pub mod luminaire;
pub mod progress;
pub mod relight;
pub mod render;
pub mod report;
pub mod scene;
pub mod spectral;
pub mod whitted;
