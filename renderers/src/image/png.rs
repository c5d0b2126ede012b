//! PNG files: 8-bit sRGB to look at, and reading them back to linear light.

use super::raster::area;
use super::{ImageError, Picture, write_atomic};
use ::image::codecs::png::{PngDecoder, PngEncoder};
use ::image::{DynamicImage, ExtendedColorType, ImageDecoder, ImageEncoder, ImageError as Codec};
use spectral_core::colour::{decode_srgb, linear_rgb_to_srgb8};
use std::fs::File;
use std::io::{self, BufReader};
use std::path::Path;

/// Writes a picture as 8-bit sRGB PNG.
///
/// The only tone mapping is a factor: linear values are multiplied by `exposure`, clipped to [0, 1], encoded
/// (IEC 61966-2-1) and rounded to nearest.
///
/// # Errors
/// [`ImageError::Exposure`] unless the exposure is positive and finite; [`ImageError::NotFinite`] for a pixel that is
/// not; [`ImageError::Io`].
pub fn write_png(path: &Path, picture: &Picture, exposure: f32) -> Result<(), ImageError> {
    if !(exposure > 0.0 && exposure.is_finite()) {
        return Err(ImageError::Exposure(exposure));
    }
    check_finite(path, picture)?;
    let mut bytes = Vec::with_capacity(3 * picture.pixels().len());
    for pixel in picture.pixels() {
        bytes.extend(linear_rgb_to_srgb8(pixel.map(|component| component * exposure)));
    }
    write_rgb8(path, picture.width(), picture.height(), &bytes)
}

/// Refuses a picture with an infinite component or NaN.
pub(super) fn check_finite(file: &Path, picture: &Picture) -> Result<(), ImageError> {
    for (index, pixel) in picture.pixels().iter().enumerate() {
        if let Some((_, name)) = pixel.iter().zip(["R", "G", "B"]).find(|(component, _)| !component.is_finite()) {
            let (x, y) = picture.position(index);
            return Err(ImageError::NotFinite { file: file.to_owned(), channel: name.to_owned(), x, y });
        }
    }
    Ok(())
}

/// Writes 8-bit sRGB pixels, three bytes each.
pub(super) fn write_rgb8(path: &Path, width: usize, height: usize, bytes: &[u8]) -> Result<(), ImageError> {
    // The encoder panics on a wrong length.
    let size = (u32::try_from(width), u32::try_from(height), area(width, height)? * 3 == bytes.len());
    let (Ok(columns), Ok(rows), true) = size else {
        return Err(ImageError::Size { width, height });
    };
    write_atomic(path, |file| {
        PngEncoder::new(file).write_image(bytes, columns, rows, ExtendedColorType::Rgb8).map_err(|error| match error {
            Codec::IoError(source) => source,
            other => io::Error::other(other),
        })
    })
}

/// Reads a PNG file, of 8 or 16 bits a channel, in colour or grey, to linear light.
///
/// Code values are taken to be sRGB; `gAMA`, `cHRM` and `iCCP` chunks are not looked at. The result is in [0, 1].
///
/// # Errors
/// [`ImageError::Io`]; [`ImageError::Malformed`]; [`ImageError::Size`]; [`ImageError::Unsupported`] if a pixel is not
/// opaque, since what is behind it is not known.
pub fn read_png(path: &Path) -> Result<Picture, ImageError> {
    let file = File::open(path).map_err(|source| ImageError::io(path, source))?;
    let refuse = |error| match error {
        // The decoder reports a truncated file as an error of the operating system.
        Codec::IoError(source) if source.kind() != io::ErrorKind::UnexpectedEof => ImageError::io(path, source),
        Codec::Unsupported(error) => ImageError::unsupported(path, error),
        other => ImageError::malformed(path, other),
    };
    let decoder = PngDecoder::new(BufReader::new(file)).map_err(refuse)?;
    let (width, height) = decoder.dimensions();
    let (width, height) = (usize::try_from(width).unwrap_or(usize::MAX), usize::try_from(height).unwrap_or(usize::MAX));
    area(width, height)?;
    let decoded = DynamicImage::from_decoder(decoder).map_err(refuse)?;
    if decoded.color().has_alpha() && decoded.to_rgba16().pixels().any(|pixel| pixel.0[3] != u16::MAX) {
        return Err(ImageError::unsupported(path, "transparent pixels"));
    }
    let pixels = decoded.into_rgb32f().pixels().map(|pixel| pixel.0.map(decode_srgb)).collect();
    Picture::from_pixels(width, height, pixels)
}
