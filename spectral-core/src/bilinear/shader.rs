//! The product as a function for graphics hardware.

use core::fmt::{self, Write};

use super::Tensor;
use crate::Real;

/// A language that [`write_operator`] writes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum ShaderLanguage {
    /// WGSL, the language of WebGPU.
    Wgsl,
    /// GLSL, any version with `mat3` (1.10, ES 1.00 and later).
    Glsl,
}

/// Why a shader function couldn't be written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum ShaderError {
    /// The name of the function isn't an identifier: an ASCII letter followed by ASCII letters, digits and single underscores.
    Name,
    /// The writer failed.
    Write,
}

impl fmt::Display for ShaderError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Name => "the name of the shader function is not an identifier",
            Self::Write => "the text of the shader function could not be written",
        })
    }
}

impl core::error::Error for ShaderError {}

impl From<fmt::Error> for ShaderError {
    fn from(_: fmt::Error) -> Self {
        Self::Write
    }
}

/// Writes ⊗ for a tensor as a function of two three-component vectors, `vec3 name(vec3 c, vec3 d)`.
///
/// The text has 4 lines and needs no heap. Coefficients are rounded to `f32` and written with nine digits, so that they are
/// read back as the same numbers.
///
/// **Cost**: 7 vector instructions (2 SUB, 2 MUL, 3 MAD; swizzles and signs are free) against 1 for the classical product:
/// 6 more. Counted in scalars: 6 subtractions, 6 multiplications and 9 fused multiply–adds against 3 multiplications.
///
/// # Errors
/// [`ShaderError`]: the name isn't an identifier, or the writer fails. Reserved words are the caller's to avoid.
///
/// ```
/// use spectral_core::bilinear::{ShaderLanguage, Tensor, write_operator};
/// let mut text = String::new();
/// write_operator(&mut text, ShaderLanguage::Wgsl, "reflect_colour", &Tensor::<f32>::iso_rgb())?;
/// assert!(text.starts_with("fn reflect_colour(c: vec3<f32>, d: vec3<f32>) -> vec3<f32> {"));
/// # Ok::<(), spectral_core::bilinear::ShaderError>(())
/// ```
pub fn write_operator<R: Real>(
    writer: &mut impl Write,
    language: ShaderLanguage,
    name: &str,
    tensor: &Tensor<R>,
) -> Result<(), ShaderError> {
    if !is_identifier(name) {
        return Err(ShaderError::Name);
    }
    let [before, after, variable, matrix] = match language {
        ShaderLanguage::Wgsl => {
            ["fn ", "(c: vec3<f32>, d: vec3<f32>) -> vec3<f32> {\n", "let differences =", "mat3x3<f32>("]
        }
        ShaderLanguage::Glsl => ["vec3 ", "(vec3 c, vec3 d) {\n", "vec3 differences =", "mat3("],
    };
    for text in [before, name, after, "    ", variable, " (c - c.yzx) * (d - d.yzx);\n    return c * d - ", matrix] {
        writer.write_str(text)?;
    }
    // Both languages take matrices column by column: a column is what one pair transfers into red, green and blue.
    let mut separator = "";
    let [red, green, blue] = tensor.transfer();
    for ((r, g), b) in red.into_iter().zip(green).zip(blue) {
        for coefficient in [r, g, b] {
            writer.write_str(separator)?;
            write_number(writer, single(coefficient))?;
            separator = ", ";
        }
    }
    writer.write_str(") * differences;\n}\n")?;
    Ok(())
}

/// Writes a finite number with up to nine digits, as -1.25e-3.
///
/// The formatting of floats in `core` has checks that panic, which no optimiser proves away: this has none. Scaling by
/// tens loses less than 1e-14, relatively, and neighbours in `f32` are 6e-8 apart: nine digits bring the number back.
fn write_number(writer: &mut impl Write, value: f32) -> fmt::Result {
    if value < 0.0 {
        writer.write_char('-')?;
    }
    let (mut mantissa, mut tens) = (f64::from(value.abs()), 0_i8);
    if mantissa > 0.0 {
        // At most 45 turns each: no number is below 1e-45 or above 4e38.
        while mantissa >= 10.0 && tens < 45 {
            mantissa /= 10.0;
            tens += 1;
        }
        while mantissa < 1.0 && tens > -46 {
            mantissa *= 10.0;
            tens -= 1;
        }
    }
    let mut digits = (mantissa * 1e8 + 0.5).to_usize();
    if digits >= 1_000_000_000 {
        digits /= 10;
        tens += 1;
    }
    let mut place = 100_000_000;
    write_digit(writer, digits / place)?;
    writer.write_char('.')?;
    loop {
        digits %= place;
        place /= 10;
        write_digit(writer, digits.checked_div(place).unwrap_or(0))?;
        if place <= 1 || digits % place == 0 {
            break;
        }
    }
    if tens != 0 {
        writer.write_str(if tens < 0 { "e-" } else { "e" })?;
        let tens = usize::from(tens.unsigned_abs());
        if tens >= 10 {
            write_digit(writer, tens / 10)?;
        }
        write_digit(writer, tens)?;
    }
    Ok(())
}

/// Writes the last digit of a number.
fn write_digit(writer: &mut impl Write, number: usize) -> fmt::Result {
    let digits = b"0123456789";
    writer.write_char(char::from(digits[number % 10]))
}

#[allow(clippy::cast_possible_truncation, reason = "shaders compute in f32")]
fn single<R: Real>(value: R) -> f32 {
    value.to_f64() as f32
}

fn is_identifier(name: &str) -> bool {
    let plain = name.bytes().all(|b| b.is_ascii_alphanumeric() || b == b'_');
    // GLSL reserves names with two underscores in a row.
    plain
        && name.bytes().next().is_some_and(|b| b.is_ascii_alphabetic())
        && !name.as_bytes().windows(2).any(|pair| pair == b"__")
}
