//! Measured BRDFs, models of the Ward family fitted to them, and what these models reflect.
//!
//! - [`parse_readings`], [`read_readings`], [`linoleum`]: measured data;
//! - [`fit`]: the reflectance and roughness of a [`Variant`](spectral_core::brdf::Variant) for which the weighted squared differences are least;
//! - [`albedo`]: the directional albedo of a model, by quadrature;
//! - [`plot_fits`], [`plot_albedo`]: both as pictures.

mod albedo;
mod data;
mod fit;
mod fitted;
mod least_squares;
mod model;
mod plot;
mod symmetric;

pub use albedo::{Albedo, AlbedoError, albedo, sampling_albedo};
pub use data::{DataError, LINOLEUM_NAME, LINOLEUM_REFLECTANCE, Reading, linoleum, parse_readings, read_readings};
pub use fit::{ALPHA_RANGE, FitError, FitSettings, fit};
pub use fitted::{Fit, FittedReading, Incidence, LocalMinimum};
pub use least_squares::Loss;
pub use plot::{AlbedoCurve, plot_albedo, plot_fits};
