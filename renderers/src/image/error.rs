//! What can be wrong with a picture or its file.

use core::fmt;
use std::io;
use std::path::{Path, PathBuf};

/// Why a picture could not be made, read or written. The text of every variant is one line and names the file.
#[derive(Debug)]
#[non_exhaustive]
pub enum ImageError {
    /// The operating system refused to open, read, write or rename the file.
    Io {
        /// The file.
        file: PathBuf,
        /// Its reason.
        source: io::Error,
    },
    /// The file is damaged or truncated.
    Malformed {
        /// The file.
        file: PathBuf,
        /// What the decoder found.
        reason: String,
    },
    /// The file is of a kind, or uses a feature, that is not read here.
    Unsupported {
        /// The file.
        file: PathBuf,
        /// The feature.
        reason: String,
    },
    /// The file lacks a colour channel.
    MissingChannel {
        /// The file.
        file: PathBuf,
        /// The channel's name.
        channel: String,
    },
    /// A channel's name or an attribute can't be written: empty, given twice, too long, or with characters outside
    /// Latin-1.
    Name {
        /// The file.
        file: PathBuf,
        /// The name or text.
        name: String,
        /// What is wrong with it.
        reason: &'static str,
    },
    /// A channel is not as large as the picture it goes with.
    ChannelSize {
        /// The file.
        file: PathBuf,
        /// The channel's name.
        channel: String,
    },
    /// A pixel is infinite or not a number.
    NotFinite {
        /// The file.
        file: PathBuf,
        /// The channel's name.
        channel: String,
        /// The pixel's column, from 0 at the left.
        x: usize,
        /// The pixel's row, from 0 at the top.
        y: usize,
    },
    /// A raster of this size can't be: a side is 0, there are more pixels than [`MAX_PIXELS`](super::MAX_PIXELS), or
    /// their number is not width times height.
    Size {
        /// Pixels in a row.
        width: usize,
        /// Rows.
        height: usize,
    },
    /// An exposure that is not a positive finite number.
    Exposure(f32),
    /// The limits of a scale that are not finite, not increasing, or not positive although the scale is logarithmic.
    Range {
        /// The lower limit.
        low: f64,
        /// The upper limit.
        high: f64,
    },
}

impl ImageError {
    pub(crate) fn io(file: &Path, source: io::Error) -> Self {
        Self::Io { file: file.to_owned(), source }
    }

    pub(crate) fn malformed(file: &Path, reason: impl fmt::Display) -> Self {
        Self::Malformed { file: file.to_owned(), reason: one_line(&reason) }
    }

    pub(crate) fn unsupported(file: &Path, reason: impl fmt::Display) -> Self {
        Self::Unsupported { file: file.to_owned(), reason: one_line(&reason) }
    }
}

/// A decoder's message may have several lines.
fn one_line(reason: &impl fmt::Display) -> String {
    reason.to_string().split_whitespace().collect::<Vec<_>>().join(" ")
}

impl fmt::Display for ImageError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Io { file, source } => write!(f, "{}: {source}", file.display()),
            Self::Malformed { file, reason } => {
                write!(f, "{}: damaged image: {reason}", file.display())
            }
            Self::Unsupported { file, reason } => {
                write!(f, "{}: not supported: {reason}", file.display())
            }
            Self::MissingChannel { file, channel } => {
                write!(f, "{}: no channel `{channel}`", file.display())
            }
            Self::Name { file, name, reason } => {
                write!(f, "{}: `{name}`: {reason}", file.display())
            }
            Self::ChannelSize { file, channel } => {
                write!(f, "{}: channel `{channel}` differs in size from the picture", file.display())
            }
            Self::NotFinite { file, channel, x, y } => {
                write!(f, "{}: channel `{channel}` is not finite at pixel ({x}, {y})", file.display())
            }
            Self::Size { width, height } => {
                write!(f, "no picture can be {width} × {height} pixels")
            }
            Self::Exposure(exposure) => {
                write!(f, "an exposure must be positive and finite, not {exposure}")
            }
            Self::Range { low, high } => write!(f, "no scale goes from {low} to {high}"),
        }
    }
}

impl core::error::Error for ImageError {
    fn source(&self) -> Option<&(dyn core::error::Error + 'static)> {
        match self {
            Self::Io { source, .. } => Some(source),
            _ => None,
        }
    }
}
