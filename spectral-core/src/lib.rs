//! Interval spectra with certified colour error, colour and light metrics, for anything from a game engine to a
//! microcontroller: `no_std`, no heap, no panic, `libm` only.
#![no_std]
#![warn(clippy::pedantic)]
#![allow(clippy::many_single_char_names, clippy::similar_names, reason = "the papers' own symbols")]

#[cfg(feature = "std")]
extern crate std;

pub mod colour;
mod real;
pub mod spectrum;
pub mod tables;

pub use real::Real;
