//! Reference renderers on `spectral-core`, with scenes, images and reports: what the `spectral` command is made of.

pub mod image;
