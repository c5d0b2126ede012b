//! Radiance pictures.

use std::path::Path;

use renderers::relight::radiance::{RadianceHeader, RadianceReader, encode_scanline};

/// Pixels that are read of a picture: a few bytes can stand for very many.
const ENOUGH: usize = 1 << 18;

/// Reads the bytes as a Radiance picture: what is accepted must come back when it is written and read again.
pub fn radiance(bytes: &[u8]) {
    let name = Path::new("fuzz.hdr");
    let (header, pixels) = match read(name, bytes) {
        Ok(read) => read,
        Err(error) => {
            super::assert_one_line(&error);
            return assert!(error.starts_with("fuzz.hdr: "), "{error}");
        }
    };
    assert!(pixels.as_flattened().iter().all(|component| *component >= 0.0));
    // Without the factors, which round.
    if header.exposure != 1.0 || header.colour_correction != [1.0; 3] {
        return;
    }
    let mut copy = Vec::new();
    header.write(&mut copy).expect("memory");
    let written = pixels.chunks(header.resolution.length).map(encode_scanline);
    written.for_each(|scanline| copy.extend(scanline));
    let (again, seen) = read(name, &copy).expect("what has been written");
    assert_eq!(again, header);
    for (seen, pixel) in seen.iter().zip(&pixels) {
        // Pixels of other writers need not have a mantissa above 127, nor be above the smallest number.
        let most = pixel.iter().copied().fold(0.0, f32::max);
        for (a, b) in seen.iter().zip(pixel) {
            assert!((a - b).abs() <= (most / 100.0).max(1e-32), "{seen:?}, {pixel:?}");
        }
    }
}

type Pixels = Vec<[f32; 3]>;

fn read(name: &Path, bytes: &[u8]) -> Result<(RadianceHeader, Pixels), String> {
    let mut reader = RadianceReader::new(name, bytes).map_err(|error| error.to_string())?;
    let header = reader.header().clone();
    let mut pixels = Vec::new();
    while pixels.len() < ENOUGH && reader.next_scanline(&mut pixels).map_err(|error| error.to_string())? {}
    Ok((header, pixels))
}
