//! Oracles and statistics shared by the tests; nothing in the workspace depends on this crate.

extern crate alloc;

pub mod accuracy;
pub mod bodies;
pub mod certify;
pub mod comparisons;
pub mod dense;
pub mod generators;
pub mod irradiance;
pub mod light_tracing;
pub mod meshes;
pub mod program;
pub mod quadrature;
pub mod receiver;
pub mod snell;
pub mod statistics;
pub mod tables;

/// The README's example is compiled and run.
#[cfg(doctest)]
#[doc = include_str!("../../README.md")]
pub struct Readme;
