//! Pixels and scanlines of Radiance pictures: three mantissas and a common exponent.

use core::fmt;
use std::io::{self, Read};

/// The shortest and the longest scanline that may be run-length encoded component by component.
const ENCODED_LENGTHS: core::ops::RangeInclusive<usize> = 8..=32_767;

/// Repeated bytes worth a run of their own.
const SHORTEST_RUN: usize = 4;

/// The largest number that a pixel can hold: the last one below 2¹²⁷.
pub const LARGEST: f32 = f32::from_bits((254 << 23) - 1);

/// Numbers up to this are 0, as Radiance has them.
const SMALLEST: f32 = 1e-32;

/// The colour of a pixel: (mantissa + ½) · 2^(exponent − 136), and 0 for exponent 0.
///
/// The half is Radiance's, whose writers cut off: it makes the mean error 0. Exact in `f64`.
#[must_use]
pub fn decode([r, g, b, exponent]: [u8; 4]) -> [f64; 3] {
    if exponent == 0 {
        return [0.0; 3];
    }
    let unit = power_of_two(i32::from(exponent) - 136);
    [r, g, b].map(|mantissa| (f64::from(mantissa) + 0.5) * unit)
}

/// The pixel nearest below a colour, whose negative components become 0 and whose components above [`LARGEST`] become that.
///
/// The error of a component is less than 1/128 of the largest one; pixels decoded by [`decode`] come back to the bit.
/// A colour with no component above 1e-32 is black; a component that is NaN becomes 0.
#[must_use]
pub fn encode(colour: [f32; 3]) -> [u8; 4] {
    let colour = colour.map(|c| c.clamp(0.0, LARGEST));
    let most = colour.into_iter().fold(0.0, f32::max);
    if most <= SMALLEST {
        return [0; 4];
    }
    // most = m · 2^e with ½ ≤ m < 1; it isn't subnormal.
    let exponent = (most.to_bits() >> 23) + 2;
    #[allow(clippy::cast_possible_wrap, reason = "at most 255")]
    let unit = power_of_two(136 - exponent as i32);
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 to 255, and cut off on purpose")]
    let [r, g, b] = colour.map(|c| (f64::from(c) * unit) as u8);
    #[allow(clippy::cast_possible_truncation, reason = "at most 255")]
    let exponent = exponent as u8;
    [r, g, b, exponent]
}

/// 2 to a power from −1022 to 1023.
fn power_of_two(power: i32) -> f64 {
    f64::from_bits(u64::from((power + 1023).unsigned_abs()) << 52)
}

/// Why a scanline can't be read.
#[derive(Debug)]
pub(super) enum ScanlineError {
    Io(io::Error),
    /// It is encoded with another length than the picture's.
    Length(usize),
    /// A run or a piece goes beyond the end.
    TooLong,
    /// A run of pixels before the first one.
    NothingToRepeat,
}

impl From<io::Error> for ScanlineError {
    fn from(error: io::Error) -> Self {
        Self::Io(error)
    }
}

impl fmt::Display for ScanlineError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Io(error) if error.kind() == io::ErrorKind::UnexpectedEof => f.write_str("the file ends too early"),
            Self::Io(error) => error.fmt(f),
            Self::Length(length) => write!(f, "it is encoded as one of {length} pixels"),
            Self::TooLong => f.write_str("a run goes beyond its end"),
            Self::NothingToRepeat => f.write_str("it begins with a run of what was before it"),
        }
    }
}

/// Reads a scanline of any of the three encodings: runs of bytes, component by component; runs of pixels; none.
pub(super) fn read_scanline(input: &mut impl Read, pixels: &mut [[u8; 4]]) -> Result<(), ScanlineError> {
    let mut first = [0; 4];
    let Some((head, tail)) = pixels.split_first_mut() else { return Ok(()) };
    input.read_exact(&mut first)?;
    let [two, second, high, low] = first;
    let encoded = two == 2 && second == 2 && high < 128;
    if !(encoded && ENCODED_LENGTHS.contains(&(tail.len() + 1))) {
        if is_run(first) {
            return Err(ScanlineError::NothingToRepeat);
        }
        *head = first;
        return read_pixels(input, first, tail);
    }
    let length = usize::from(high) << 8 | usize::from(low);
    if length != pixels.len() {
        return Err(ScanlineError::Length(length));
    }
    (0..4).try_for_each(|component| read_component(input, pixels, component))
}

/// Whether a pixel says how often the one before it is repeated.
fn is_run(pixel: [u8; 4]) -> bool {
    pixel[..3] == [1, 1, 1]
}

/// Pixels one by one, and runs of them, where the digits of a long count follow each other, the lowest first.
fn read_pixels(input: &mut impl Read, first: [u8; 4], mut rest: &mut [[u8; 4]]) -> Result<(), ScanlineError> {
    let (mut before, mut shift) = (first, 0);
    while !rest.is_empty() {
        let mut pixel = [0; 4];
        input.read_exact(&mut pixel)?;
        let count = if is_run(pixel) {
            let count = usize::from(pixel[3]).checked_shl(shift).filter(|count| *count <= rest.len() && shift <= 16);
            shift += 8;
            count.ok_or(ScanlineError::TooLong)?
        } else {
            (before, shift) = (pixel, 0);
            1
        };
        let (these, others) = rest.split_at_mut(count);
        these.fill(before);
        rest = others;
    }
    Ok(())
}

fn read_component(input: &mut impl Read, pixels: &mut [[u8; 4]], component: usize) -> Result<(), ScanlineError> {
    let mut rest = pixels;
    while !rest.is_empty() {
        let (mut code, mut bytes) = ([0], [0; 128]);
        input.read_exact(&mut code)?;
        let code = usize::from(code[0]);
        let count = if code > 128 { code - 128 } else { code };
        if !(1..=rest.len()).contains(&count) {
            return Err(ScanlineError::TooLong);
        }
        if code > 128 {
            let mut value = [0];
            input.read_exact(&mut value)?;
            bytes[..count].fill(value[0]);
        } else {
            input.read_exact(&mut bytes[..count])?;
        }
        let (these, others) = rest.split_at_mut(count);
        for (pixel, byte) in these.iter_mut().zip(bytes) {
            pixel[component] = byte;
        }
        rest = others;
    }
    Ok(())
}

/// Appends a scanline: runs of bytes, component by component, where its length allows that, else pixel by pixel.
pub(super) fn write_scanline(pixels: &[[u8; 4]], out: &mut Vec<u8>) {
    if !ENCODED_LENGTHS.contains(&pixels.len()) {
        out.extend(pixels.as_flattened());
        return;
    }
    #[allow(clippy::cast_possible_truncation, reason = "at most 32767")]
    out.extend([2, 2, (pixels.len() >> 8) as u8, pixels.len() as u8]);
    let mut bytes = Vec::with_capacity(pixels.len());
    for component in 0..4 {
        bytes.clear();
        bytes.extend(pixels.iter().map(|pixel| pixel[component]));
        write_component(&bytes, out);
    }
}

fn write_component(bytes: &[u8], out: &mut Vec<u8>) {
    let mut plain = 0;
    let mut at = 0;
    while at < bytes.len() {
        let run = bytes[at..].iter().take(127).take_while(|byte| **byte == bytes[at]).count();
        if run >= SHORTEST_RUN {
            write_plain(&bytes[plain..at], out);
            #[allow(clippy::cast_possible_truncation, reason = "at most 255")]
            out.extend([(128 + run) as u8, bytes[at]]);
            plain = at + run;
        }
        at += run;
    }
    write_plain(&bytes[plain..], out);
}

fn write_plain(bytes: &[u8], out: &mut Vec<u8>) {
    for piece in bytes.chunks(128) {
        #[allow(clippy::cast_possible_truncation, reason = "at most 128")]
        out.push(piece.len() as u8);
        out.extend(piece);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_pixels_that_writers_make_come_back() {
        for exponent in 0..=255 {
            for mantissa in 128..=255 {
                let pixel = if exponent < 24 { [0; 4] } else { [mantissa, 0, 255 - mantissa, exponent] };
                #[allow(clippy::cast_possible_truncation, reason = "exact")]
                let colour = decode(pixel).map(|c| c as f32);
                assert_eq!(encode(colour), pixel);
            }
        }
    }

    #[test]
    fn colours_out_of_range_become_the_nearest() {
        assert_eq!(encode([f32::MAX, 1.0, -1.0]), [255, 0, 0, 255]);
        assert_eq!(encode([LARGEST; 3]), [255, 255, 255, 255]);
        assert_eq!(encode([f32::NAN, 1e-33, -f32::MAX]), [0; 4]);
        assert_eq!(encode([1.0, 0.5, 0.25]), [128, 64, 32, 129]);
    }

    #[test]
    fn scanlines_of_all_lengths_and_runs_come_back() {
        for length in [1, 2, 7, 8, 9, 127, 128, 129, 130, 260, 32_767, 32_768] {
            for period in [1, 2, 3, 4, 5, 126, 127, 128, 129, 1000] {
                #[allow(clippy::cast_possible_truncation, reason = "any byte will do")]
                let pixel = |i: usize| [(i / period) as u8, (i % period) as u8 | 128, 7, 128 + (i / 300) as u8];
                let pixels: Vec<_> = (0..length).map(pixel).collect();
                let (mut bytes, mut back) = (Vec::new(), vec![[0; 4]; length]);
                write_scanline(&pixels, &mut bytes);
                let mut rest = bytes.as_slice();
                read_scanline(&mut rest, &mut back).unwrap();
                assert_eq!((back, rest.len()), (pixels, 0));
            }
        }
    }
}
