//! Interval spectra with certified colour error, colour and light metrics, for anything from a game engine to a
//! microcontroller: `no_std`, no heap, no panic, `libm` only.
//!
//! Everything works in `f32` and in `f64` through one sealed trait, [`Real`]; vectors cross the boundary as `[R; 3]`; buffers
//! are the caller's. Wavelengths are in nm in standard air, and the visible domain is 380–780 nm.
//!
//! | to | see |
//! |---|---|
//! | have a spectrum: measured, uniform, Planck, daylight, lines | [`spectrum`], built-in ones in [`tables`] |
//! | integrate it with colour-matching functions, exactly | [`tristimulus`], [`Observer`] |
//! | keep it on adaptive intervals, with bounds | [`interval`] |
//! | write light times reflectances as a program, and evaluate it to a bound of ΔE\*ab | [`expression`], [`adaptive`] |
//! | share the work among colours that differ in scale, or do without cube roots | [`subdivision`], [`threshold_table`] |
//! | have colours and their differences | [`colour`], [`bound`] |
//! | bend light, and reflect it at smooth boundaries | [`dispersion`], [`fresnel`] |
//! | reflect it glossily: evaluate, sample, integrate | [`brdf`] |
//! | multiply and divide three-component colours with less loss | [`bilinear`] |
//! | have a spectrum for three components | [`upsampling`] |
//! | filter materials for a dominant light | [`prefilter`] |
//!
//! # Example
//! The colour of a green paint under D65 within ΔE\*ab 3, certainly (Iehl and Péroche's example, figure 5):
//!
//! ```
//! use spectral_core::adaptive::{Mode, Piece, Target, evaluate};
//! use spectral_core::expression::{Op, Program};
//! use spectral_core::interval::{Domain, Interval, Pyramid, Weight, node_count};
//! use spectral_core::spectrum::Outside;
//! use spectral_core::{Observer, tables};
//!
//! const DEPTH: u8 = 6;
//! const NODES: usize = node_count(DEPTH);
//! let mut weights = [Weight::default(); NODES];
//! let domain = Domain::<f64>::build(Observer::cie_1931_2deg(), DEPTH, &mut weights)?;
//!
//! let (light, paint) = (tables::illuminants::D65, tables::colorchecker::GREEN);
//! let mut buffers = [[Interval::zero(); NODES]; 2];
//! let [first, second] = &mut buffers;
//! let leaves = [
//!     Pyramid::build(&light.spectrum(Outside::Zero), &domain, first)?,
//!     Pyramid::build(&paint.spectrum(Outside::Hold), &domain, second)?,
//! ];
//!
//! let ops = [Op::Leaf(0), Op::Leaf(1), Op::Product];
//! let program = Program::new(&ops)?;
//! let white = spectral_core::tristimulus(domain.observer(), &light.spectrum(Outside::Zero), 380.0, 780.0);
//! let target = Target { mode: Mode::Certified, threshold: 3.0, white };
//! let mut stack = [Interval::zero(); 2];
//! let mut pieces = [Piece::default(); 64];
//! let found = evaluate(&program, &domain, &target, &mut leaves.as_slice(), &mut stack, &mut pieces)?;
//! assert!(found.delta_e <= 3.0 && found.intervals <= 3);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
#![no_std]

#[cfg(feature = "std")]
extern crate std;

pub mod action;
pub mod adaptation;
pub mod adaptive;
mod array;
pub mod bilinear;
pub mod bound;
pub mod brdf;
pub mod cct;
pub mod colour;
pub mod colour_rendering;
pub mod dispersion;
pub mod expression;
pub mod fresnel;
mod integrate;
pub mod interval;
mod lanes;
pub mod light;
mod matrix;
mod observer;
pub mod prefilter;
mod real;
pub mod spectrum;
pub mod subdivision;
pub mod summation;
pub mod tables;
pub mod threshold_table;
pub mod upsampling;

pub use integrate::tristimulus;
pub use observer::{Observer, ObserverError};
pub use real::Real;
pub use spectrum::Spectrum;
pub use tables::Samples;
