//! Interval spectra with certified colour error, colour and light metrics, for anything from a game engine to a
//! microcontroller: `no_std`, no heap, no panic, `libm` only.
#![no_std]

#[cfg(feature = "std")]
extern crate std;

pub mod action;
pub mod adaptation;
pub mod adaptive;
pub mod bound;
pub mod cct;
pub mod colour;
pub mod colour_rendering;
pub mod dispersion;
pub mod expression;
mod integrate;
pub mod interval;
pub mod light;
mod observer;
mod real;
pub mod schlick;
pub mod spectrum;
pub mod subdivision;
pub mod summation;
pub mod tables;
pub mod threshold_table;

pub use integrate::tristimulus;
pub use observer::{Observer, ObserverError};
pub use real::Real;
pub use spectrum::Spectrum;
pub use tables::Samples;
