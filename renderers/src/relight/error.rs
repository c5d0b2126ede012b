//! Why a picture can't be relit.

use core::fmt;
use std::path::PathBuf;

use spectral_core::bilinear::DivisorError;

use super::radiance::Resolution;
use crate::image::ImageError;

/// Why a picture can't be relit. The text of every variant is one line; it names the file where one is at fault.
#[derive(Debug)]
#[non_exhaustive]
pub enum RelightError {
    /// A file can't be read or written, or a pixel is not finite.
    Image(ImageError),
    /// The picture can't be divided by the light that it was made under.
    Divisor {
        /// The picture.
        file: PathBuf,
        /// Its light.
        from: [f64; 3],
        /// How many pixels would have to be divided by it.
        pixels: u64,
        /// What is wrong with it.
        reason: DivisorError,
    },
    /// A component of the new light is infinite or NaN.
    Light([f64; 3]),
    /// The ratio of the lights is out of the range of numbers.
    Range,
    /// The output's name doesn't end in that of a format that can be written.
    Extension(PathBuf),
    /// A Radiance picture that is stored by columns can't be written by rows without holding it in memory.
    Columns {
        /// The picture.
        file: PathBuf,
        /// Its size and orientation.
        resolution: Resolution,
    },
}

impl fmt::Display for RelightError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Image(error) => error.fmt(f),
            Self::Divisor { file, from: [r, g, b], pixels, reason } => {
                write!(f, "{}: none of the {pixels} pixels can be divided by {r},{g},{b}: {reason}", file.display())
            }
            Self::Light([r, g, b]) => write!(f, "a light must be of finite components, not {r},{g},{b}"),
            Self::Range => f.write_str("the ratio of the lights is out of the range of numbers"),
            Self::Extension(file) => write!(f, "{}: the name must end in .exr, .hdr or .pic", file.display()),
            Self::Columns { file, resolution } => {
                write!(f, "{}: stored by columns ({resolution}), which can only be written as .hdr", file.display())
            }
        }
    }
}

impl core::error::Error for RelightError {
    fn source(&self) -> Option<&(dyn core::error::Error + 'static)> {
        match self {
            Self::Image(error) => Some(error),
            Self::Divisor { reason, .. } => Some(reason),
            _ => None,
        }
    }
}

impl From<ImageError> for RelightError {
    fn from(error: ImageError) -> Self {
        Self::Image(error)
    }
}
