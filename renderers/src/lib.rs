//! Reference renderers on `spectral-core`, with scenes, images and reports: what the `spectral` command is made of.

pub mod compare;
pub mod image;
pub mod progress;
pub mod report;
