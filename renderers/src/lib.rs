//! Reference renderers on `spectral-core`, with scenes, images and reports: what the `spectral` command is made of.

pub mod geometry;
pub mod image;
pub mod render;
pub mod scene;
pub mod spectral;
pub mod whitted;
