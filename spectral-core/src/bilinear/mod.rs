//! Products and quotients of three-component colours that keep more of their appearance than component by component.
//!
//! The bilinear model of Granier and Damez (INRIA RR-5227, 2004): a light and a reflectance of known colour are each
//! represented by a combination of three basis functions, and the colour of their product is C_c = Σ k^c_{d,e} L_d ρ_e
//! with 27 coefficients k that depend on the colour space alone. The same model with no transfer between the
//! components is the classical product, and its quality depends on the space (Borges 1991).
//!
//! - [`Tensor`]: the coefficients, [`product`](Tensor::product) ⊗, [`reflection`](Tensor::reflection) matrices;
//! - [`Divisor`]: division ⊘, with a condition number;
//! - [`estimate()`]: coefficients from any colour-matching functions;
//! - [`write_operator`]: ⊗ as a function for graphics hardware.
//!
//! # Nine numbers
//! Of the 27 coefficients, symmetry (k^c_{d,e} = k^c_{e,d}) leaves 18, and coherence (K_r + K_g + K_b = I: under white,
//! a surface has its own colour) leaves 9: those off the diagonals. What is on them follows, and ⊗ becomes
//!
//! (C ⊗ D)_c = C_c D_c − Σ_{(d,e)} k^c_{d,e} (C_d − C_e)(D_d − D_e), over the pairs (r, g), (g, b), (b, r),
//!
//! which is what this module stores and computes. So both conditions hold by construction, white is exact to the last
//! bit, and a product takes 21 operations with fused multiply–add (36 by equations 6 and 7).
//!
//! # Domain
//! Colours may be any finite numbers, negative and above 1 included, as long as products of differences of their
//! components neither overflow nor underflow. A bilinear product of non-negative colours can have negative components:
//! they are kept.
//!
//! # Which tensor
//! Mean ΔE00 of the 24 ColorChecker patches (Ohta's measurements) under a light, by the classical product and by the
//! bilinear one, in spaces whose components are relative to D65's:
//!
//! | light | Rec. 709 | Rec. 2020 | ACEScg |
//! |---|---|---|---|
//! | D50 | 0.82, 0.58 | 0.53, 0.63 | 0.56, 0.61 |
//! | A | 4.18, 2.46 | 1.78, 2.57 | 1.87, 2.57 |
//! | FL2 | 4.95, 3.33 | 3.54, 3.23 | 3.39, 3.30 |
//! | FL11 | 3.53, 2.17 | 2.15, 2.18 | 1.98, 2.29 |
//! | LED-B1 | 5.73, 2.72 | 2.29, 2.61 | 2.02, 2.56 |
//! | HP1 (sodium) | 18.36, 8.75 | 7.56, 6.97 | 6.40, 6.76 |
//!
//! So the bilinear product makes up for the narrow primaries of Rec. 709; in a wide space there is nothing to gain.
//!
//! # Singular divisors
//! With the printed tensor of ISO RGB no 8-bit colour but black has a determinant of exactly 0, as the paper states; but a surface
//! of singular colours runs through the saturated reds and purples, near (1, 0.055, 0.1): 1.2 % of the 8-bit colours are beyond it,
//! with a determinant below 0, and division by colours next to it magnifies errors up to 10⁷ times. The
//! [`condition`](Divisor::condition) tells.
//!
//! ```
//! use spectral_core::bilinear::Tensor;
//! let iso = Tensor::<f64>::iso_rgb();
//! let (cyan_light, red_wall) = ([0.1, 1.0, 1.0], [0.6, 0.05, 0.05]);
//! let seen = iso.product(cyan_light, red_wall);
//! assert!(seen[0] > 2.0 * 0.1 * 0.6); // more of its red is left than by the classical product
//! assert_eq!(iso.product([0.5; 3], red_wall), red_wall.map(|c| 0.5 * c)); // and white is white
//!
//! let light = iso.divisor(cyan_light)?;
//! for (back, c) in light.quotient(seen).into_iter().zip(red_wall) {
//!     assert!((back - c).abs() <= 8.0 * light.condition() * f64::EPSILON);
//! }
//! # Ok::<(), spectral_core::bilinear::DivisorError>(())
//! ```

mod division;
mod error;
mod estimate;
mod shader;
mod tensor;
mod tensors;

pub use division::Divisor;
pub use error::{AlphaError, DivisorError, EstimateError, TensorError};
pub use estimate::{Estimate, estimate, estimate_rgb};
pub use shader::{ShaderError, ShaderLanguage, write_operator};
pub use tensor::{Reflection, Tensor};
pub use tensors::ISO_RGB_PRINTED;
