//! Lights as people have them, files of measured spectra or names of built-in ones, and everything there is to say of
//! them: see [`spectral_core::light`].

mod file;
mod plot;
mod report;

pub use file::{LightFileError, SpectralTable, parse_csv, parse_light, parse_spdx, read_light};
pub use plot::plot;
pub use report::{ApproximationErrors, GridUsed, LightReport, Reference, Stages, report};
