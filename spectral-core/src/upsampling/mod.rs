//! Spectra for colours that are known by three components only.
//!
//! - [`Upsampler`] finds the [`Sigmoid`] reflectance of Jakob and Hanika (2019) for a colour, without a table;
//! - [`LightUpsampler`] finds an [`Emission`]: a sigmoid times a light, scaled;
//! - [`smits`]: the older sums of basis spectra of Smits (1999), for reflectances and for lights.
//!
//! # Conventions
//! Integrals are the crate's: exact, of piecewise linear functions, over 380–780 nm.
//!
//! A reflectance has the colour it shows under a light that is taken to be white: RGB = M ∫ ρ L x̄ … / M ∫ L x̄ …, channel
//! by channel, with M the matrix of the RGB space. So ρ = 1 is (1, 1, 1) exactly. With CIE D65 as the light and the
//! primaries of sRGB this is sRGB with its white taken from D65's table (x = 0.31274, y = 0.32906 over 380–780 nm) instead of
//! the four-digit chromaticity of the standard, from which it differs by 5e-4 in blue, 1.2e-4 in red and 2e-5 in green.
//!
//! The components are linear ones, not encoded: decode sRGB first.
//!
//! ```
//! use spectral_core::colour::RgbSpace;
//! use spectral_core::spectrum::Spectrum;
//! use spectral_core::upsampling::Upsampler;
//! let upsampler = Upsampler::<f64>::d65(&RgbSpace::REC_709)?;
//! let orange = upsampler.reflectance([0.8, 0.3, 0.05])?;
//! assert!(orange.value(650.0) > 0.7 && orange.value(450.0) < 0.1);
//! for (back, c) in upsampler.colour(&orange).into_iter().zip([0.8, 0.3, 0.05]) {
//!     assert!((back - c).abs() <= 1e-12);
//! }
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod emission;
mod error;
mod sigmoid;
pub mod smits;
mod solver;

pub use emission::{Emission, LightUpsampler};
pub use error::{UpsamplerError, UpsamplingError};
pub use sigmoid::Sigmoid;
pub use solver::Upsampler;
