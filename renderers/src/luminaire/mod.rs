//! Luminous intensity distributions: the photometry of luminaires as laboratories measure it and manufacturers publish it.
//!
//! A [`LuminousIntensity`] gives candela for every direction in C-planes × γ. It comes from an IES LM-63 file
//! ([`parse_ies`]), an EULUMDAT file ([`parse_eulumdat`]), [`read`] for either, or from the constructors of idealised
//! sources ([`LuminousIntensity::isotropic`], [`LuminousIntensity::lambertian`]). [`PhotometricFile::to_ies`] writes it.
//! A [`PlacedLuminaire`] is a distribution somewhere in a scene; it shines as a point, so receivers should be five times
//! its size away or more (the photometric distance at which a Lambertian disk is within 1 % of the inverse square law).
//!
//! # Directions
//! The luminaire's frame is right-handed with the light's main direction along −z, as it hangs from a ceiling:
//! - γ is the angle from the nadir −z: 0 straight down, 90° horizontal, 180° straight up;
//! - C is the angle about the vertical from +x towards +y, anticlockwise seen from above: C0 is +x, C90 +y (LM-63-2002,
//!   definitions 3.0: anticlockwise for type C).
//!
//! C-planes are taken as the file numbers them. EULUMDAT's lamp axis is in the plane C90–C270 and LM-63's length in
//! C0–C180, so that the same luminaire may be turned by 90° between its two files.
//!
//! ```
//! use renderers::luminaire::{LuminousIntensity, parse_ies};
//!
//! let text = "IESNA:LM-63-2002\n[TEST] 1\n[TESTLAB] x\n[ISSUEDATE] x\n[MANUFAC] x\nTILT=NONE\n\
//!             1 -1 1 3 1 1 2 0 0 0\n1 1 10\n0 45 90\n0\n100 80 0\n";
//! let file = parse_ies("lamp.ies", text)?;
//! assert_eq!(file.intensity.candela(30.0, 22.5), 90.0);
//! assert_eq!(file.intensity.candela_towards([0.0, 0.0, -2.0]), 100.0);
//!
//! let error = parse_ies("lamp.ies", &text.replace("80", "-80")).unwrap_err();
//! assert_eq!(error.to_string(), "lamp.ies:11: candela at C 0, γ 45: must not be negative, but is -80");
//!
//! let sphere = LuminousIntensity::isotropic(100.0)?;
//! assert!((sphere.flux() - 400.0 * std::f64::consts::PI).abs() < 1e-12 * sphere.flux());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod error;
mod eulumdat;
mod file;
mod ies;
mod intensity;
mod placed;
mod write;

pub use error::{Fault, PhotometricFileError};
pub use eulumdat::parse as parse_eulumdat;
pub use file::{FluxCheck, Format, LampSet, Opening, PhotometricFile, Tilt, parse, read};
pub use ies::parse as parse_ies;
pub use intensity::{IntensityError, LuminousIntensity, Place, Symmetry};
pub use placed::PlacedLuminaire;

/// The largest file that is read, in bytes: 16 MiB, some four million values.
pub const LARGEST_FILE: usize = 16 << 20;
