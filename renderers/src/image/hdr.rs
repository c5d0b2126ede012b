//! Radiance pictures (`.hdr`): linear RGB in eight bits of mantissa with a common exponent.

use super::png::check_finite;
use super::{ImageError, Picture, write_atomic};
use crate::relight::radiance::{RadianceHeader, RadianceReader, Resolution, encode_scanline};
use std::fs::File;
use std::io::{BufReader, Write};
use std::path::Path;

/// Writes a picture as a Radiance file: `FORMAT=32-bit_rle_rgbe`, rows from the top, run-length encoded, with the primaries and the white of
/// Rec. 709 in the header.
///
/// The error of a component is less than 1/128 of the largest of its pixel; negative components become 0. Values are as in
/// [`write_exr`](super::write_exr): Y = 1 for diffuse white, where Radiance's own pictures are in W m⁻² sr⁻¹.
///
/// # Errors
/// [`ImageError::NotFinite`]; [`ImageError::Io`].
pub fn write_hdr(path: &Path, picture: &Picture) -> Result<(), ImageError> {
    check_finite(path, picture)?;
    let mut header = RadianceHeader::new(Resolution::rows(picture.width(), picture.height()));
    header.lines = vec![
        b"SOFTWARE=spectral".to_vec(),
        b"PRIMARIES=0.6400 0.3300 0.3000 0.6000 0.1500 0.0600 0.3127 0.3290".to_vec(),
    ];
    write_atomic(path, |file| {
        header.write(file)?;
        picture.pixels().chunks(picture.width()).try_for_each(|row| file.write_all(&encode_scanline(row)))
    })
}

/// Reads a Radiance file of rows from the top; `EXPOSURE` and `COLORCORR` are divided out.
///
/// # Errors
/// [`ImageError::Io`]; [`ImageError::Malformed`]; [`ImageError::Unsupported`], also for other orientations; [`ImageError::Size`].
pub fn read_hdr(path: &Path) -> Result<Picture, ImageError> {
    let file = File::open(path).map_err(|source| ImageError::io(path, source))?;
    let mut reader = RadianceReader::new(path, BufReader::new(file))?;
    let resolution = reader.header().resolution;
    let [width, height] = resolution.size();
    if resolution != Resolution::rows(width, height) {
        return Err(ImageError::unsupported(path, format_args!("scanlines in the order {resolution}")));
    }
    super::raster::area(width, height)?;
    let mut pixels = Vec::new();
    while reader.next_scanline(&mut pixels)? {}
    let picture = Picture::from_pixels(width, height, pixels)?;
    check_finite(path, &picture)?;
    Ok(picture)
}
