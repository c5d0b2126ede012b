//! Pictures: linear-light rasters, their files, and false-colour maps with a legend.
//!
//! - [`Raster`], as [`Picture`] (linear Rec. 709 RGB) and [`ScalarMap`];
//! - [`write_spectral_exr`] and [`read_spectral_exr`]: a [`SpectralPicture`], with a radiance for each wavelength;
//! - [`write_exr`] and [`read_exr`]: to compute with; [`write_exr_channels`] and [`read_channels`]: without colours;
//!   [`write_png`] and [`read_png`]: to look at; [`read_picture`]
//!   tells them apart; [`write_hdr`] and [`read_hdr`] for Radiance;
//! - [`FalseColour`]: a map of numbers drawn with a legend, in the colours of a [`Palette`];
//! - [`write_atomic`]: a file that is either complete or not there.
//!
//! Every function that touches a file names it in its error.

mod atomic;
mod canvas;
pub(crate) mod chart;
mod contours;
mod error;
mod exr;
mod false_colour;
mod font;
mod hdr;
mod palette;
mod png;
mod raster;
mod spectral_exr;
mod ticks;

pub use atomic::write_atomic;
pub use canvas::{Anchor, Canvas, Rgb8};
pub(crate) use canvas::{position, whole};
pub use error::ImageError;
pub use exr::{Channels, ExrPicture, read_channels, read_exr, write_exr, write_exr_channels};
pub use false_colour::{FalseColour, Levels};
pub use hdr::{read_hdr, write_hdr};
pub use palette::Palette;
pub use png::{read_png, write_png};
pub use raster::{MAX_PIXELS, Picture, Raster, ScalarMap};
pub use spectral_exr::{SpectralExr, SpectralPicture, read_spectral_exr, write_spectral_exr};
pub use ticks::{Scale, Tick, ticks};

use std::fs::File;
use std::io::Read;
use std::path::Path;

/// A picture from an `OpenEXR` or PNG file, told apart by their first bytes, not by the name.
///
/// # Errors
/// As [`read_exr`] and [`read_png`]; [`ImageError::Unsupported`] for any other kind of file.
pub fn read_picture(path: &Path) -> Result<Picture, ImageError> {
    let mut magic = Vec::with_capacity(8);
    File::open(path)
        .and_then(|file| file.take(8).read_to_end(&mut magic))
        .map_err(|source| ImageError::io(path, source))?;
    match magic.as_slice() {
        [0x76, 0x2f, 0x31, 0x01, ..] => Ok(read_exr(path)?.picture),
        [0x89, b'P', b'N', b'G', ..] => read_png(path),
        _ => Err(ImageError::unsupported(path, "neither an OpenEXR nor a PNG file")),
    }
}
