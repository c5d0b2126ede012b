//! Spectrum files.

use renderers::scene::{SpectrumKind, parse_spectrum_file};
use spectral_core::spectrum::{Outside, PiecewiseLinear};
use spectral_core::{Observer, tristimulus};

/// Reads the bytes as a spectrum file: what is accepted must be a spectrum for the core's integrals.
pub fn spectrum_file(bytes: &[u8]) {
    let text = String::from_utf8_lossy(bytes);
    match parse_spectrum_file("fuzz.spd", &text) {
        Err(error) => {
            assert_one_line(&error.to_string(), &text, error.line);
        }
        Ok(SpectrumKind::Table { wavelengths, values }) => check(&wavelengths, &values),
        Ok(other) => panic!("not a table: {other:?}"),
    }
}

fn assert_one_line(error: &str, text: &str, line: u32) {
    super::assert_one_line(error);
    assert!(error.starts_with(&format!("fuzz.spd:{line}: ")), "{error}");
    let lines = text.lines().count().max(1);
    assert!((1..=lines).contains(&(line as usize)), "line {line} of {lines}: {error}");
}

fn check(wavelengths: &[f64], values: &[f64]) {
    assert!(wavelengths.len() >= 2 && wavelengths.len() == values.len());
    assert!(wavelengths.iter().all(|w| *w > 0.0 && w.is_finite()));
    assert!(wavelengths.windows(2).all(|pair| pair[0] < pair[1]));
    assert!(values.iter().all(|v| *v >= 0.0 && v.is_finite()));
    let spectrum = PiecewiseLinear::new(wavelengths, values, Outside::Zero).expect("a spectrum");
    let largest = values.iter().copied().fold(0.0, f64::max);
    // ∫ā is at most 107 nm: where its product with the largest value is in range, so are all integrals.
    if largest <= 1e300 {
        for xyz in tristimulus(&Observer::cie_1931_2deg(), &spectrum, 380.0, 780.0) {
            assert!(xyz >= 0.0 && xyz <= 107.0 * largest * (1.0 + 1e-9), "{xyz}, values up to {largest}");
        }
    }
}
