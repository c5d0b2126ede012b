//! Reference renderers on `spectral-core`, with scenes, images and reports: what the `spectral` command is made of.

extern crate alloc;

pub mod brdf;
pub mod compare;
pub mod direct;
mod frame;
pub mod geometry;
pub mod illuminance;
pub mod image;
pub mod light;
pub mod luminaire;
pub mod map;
mod material;
pub mod path;
pub mod photon;
pub mod progress;
pub mod radiosity;
pub mod relight;
pub mod render;
pub mod report;
pub mod scene;
pub mod spectral;
pub mod trade;
pub mod verify;
pub mod whitted;
