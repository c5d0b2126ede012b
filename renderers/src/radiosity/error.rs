//! What the radiosity solver refuses.

use core::fmt;

use crate::geometry::GeometryError;

/// Why a scene has no radiosity solution here.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum RadiosityError {
    /// A surface is neither diffuse nor two-sided diffuse.
    Material {
        /// The material's name and place.
        label: String,
    },
    /// A light is of a kind that this solver doesn't know.
    Light {
        /// What kind.
        label: String,
    },
    /// A face has no area.
    Degenerate {
        /// The shape's name and place.
        label: String,
    },
    /// No surface reflects diffusely or shines.
    NothingDiffuse,
    /// The surfaces are not fit for rays.
    Geometry(GeometryError),
    /// Light comes to no end: the surfaces around a closed space reflect all of it.
    NoSolution,
    /// More memory would be needed than is allowed.
    TooLarge {
        /// Patches.
        patches: usize,
        /// Links between them.
        links: usize,
        /// An estimate of the memory in bytes.
        bytes: usize,
    },
    /// A spectrum can't be represented.
    Spectrum(String),
}

impl fmt::Display for RadiosityError {
    #[allow(clippy::cast_precision_loss, reason = "megabytes")]
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Material { label } => {
                write!(f, "{label}: radiosity has diffuse and two-sided diffuse surfaces alone")
            }
            Self::Light { label } => {
                write!(f, "radiosity has no {label} lights: use area, point or directional emitters")
            }
            Self::Degenerate { label } => write!(f, "{label}: a face has no area"),
            Self::NothingDiffuse => write!(f, "the scene has no surface that reflects diffusely or shines"),
            Self::Geometry(error) => error.fmt(f),
            Self::NoSolution => {
                write!(f, "the surfaces around a closed space reflect all light: there is no radiosity solution")
            }
            Self::TooLarge { patches, links, bytes } => write!(
                f,
                "{patches} patches with {links} links would need about {:.0} MB, more than is allowed",
                *bytes as f64 / 1e6
            ),
            Self::Spectrum(text) => f.write_str(text),
        }
    }
}

impl core::error::Error for RadiosityError {}
