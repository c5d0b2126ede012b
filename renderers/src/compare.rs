//! Comparing two pictures: colour difference and relative brightness, pixel by pixel.

use crate::image::{FalseColour, ImageError, Picture, Raster, ScalarMap, read_picture, write_exr};
use core::fmt;
use rayon::prelude::*;
use serde::Serialize;
use spectral_core::colour::rgb::WHITE;
use spectral_core::colour::{delta_e_00, linear_rgb_to_xyz, xyz_to_lab};
use std::path::{Path, PathBuf};

/// Luminances below this, relative to diffuse white, count as this in the ratio: a step and a half of 8-bit sRGB at the
/// black end, and less than a screen in a lit room can show.
pub const DARK_FLOOR: f32 = 1e-3;

/// How pictures are compared.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CompareOptions {
    /// The factor on both pictures that makes diffuse white Y = 1.
    pub exposure: f32,
    /// The least luminance Y in the ratio of brightnesses, after the exposure.
    pub floor: f32,
}

impl Default for CompareOptions {
    /// Pictures as they are, and [`DARK_FLOOR`].
    fn default() -> Self {
        Self { exposure: 1.0, floor: DARK_FLOOR }
    }
}

/// Two pictures' difference at each pixel.
#[derive(Clone, Debug, PartialEq)]
pub struct Difference {
    /// The first picture minus the second one, in linear RGB, without exposure.
    pub linear: Picture,
    /// CIEDE2000 between the pixels, relative to the white of Rec. 709 (D65) at Y = 1.
    pub delta_e00: ScalarMap,
    /// max(Y of the first, floor) / max(Y of the second, floor) − 1.
    pub relative_brightness: ScalarMap,
}

/// A comparison in figures, as it is reported.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Comparison {
    /// Pixels in a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Colour differences.
    pub delta_e00: DeltaEStatistics,
    /// Relative brightness of the first picture to the second one.
    pub relative_brightness: BrightnessRange,
    /// The files that were written.
    pub files: Vec<PathBuf>,
}

/// CIEDE2000 over all pixels.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct DeltaEStatistics {
    /// The mean.
    pub mean: f64,
    /// The 95th percentile, with straight lines between order statistics (type 7 of Hyndman and Fan 1996).
    pub p95: f64,
    /// The largest.
    pub max: f64,
}

/// The extremes of the relative brightness; 0 where both pictures are as bright.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct BrightnessRange {
    /// The least, above −1.
    pub min: f64,
    /// The largest.
    pub max: f64,
}

/// Why two pictures can't be compared.
#[derive(Debug)]
#[non_exhaustive]
pub enum CompareError {
    /// One of them can't be read, or a result can't be written.
    Image(ImageError),
    /// They differ in size.
    Size {
        /// Width and height of the first picture.
        first: (usize, usize),
        /// Width and height of the second picture.
        second: (usize, usize),
    },
    /// Two files differ in size.
    FileSize {
        /// The first file.
        first: PathBuf,
        /// The second file.
        second: PathBuf,
        /// Width and height of the first and of the second picture.
        sizes: [(usize, usize); 2],
    },
    /// The exposure or the floor is not a positive finite number.
    Option {
        /// Its name.
        name: &'static str,
        /// What was given.
        value: f32,
    },
    /// A pixel of a picture is not finite.
    NotFinite {
        /// The pixel's column.
        x: usize,
        /// The pixel's row.
        y: usize,
    },
}

impl fmt::Display for CompareError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Image(error) => error.fmt(f),
            Self::Size { first: (a, b), second: (c, d) } => {
                write!(f, "the pictures differ in size: {a} × {b} and {c} × {d} pixels")
            }
            Self::FileSize { first, second, sizes: [(a, b), (c, d)] } => {
                let (first, second) = (first.display(), second.display());
                write!(f, "{first} has {a} × {b} pixels, {second} has {c} × {d}")
            }
            Self::Option { name, value } => {
                write!(f, "the {name} must be positive and finite, not {value}")
            }
            Self::NotFinite { x, y } => write!(f, "a picture is not finite at pixel ({x}, {y})"),
        }
    }
}

impl core::error::Error for CompareError {
    fn source(&self) -> Option<&(dyn core::error::Error + 'static)> {
        match self {
            Self::Image(error) => Some(error),
            _ => None,
        }
    }
}

impl From<ImageError> for CompareError {
    fn from(error: ImageError) -> Self {
        Self::Image(error)
    }
}

/// Compares two picture files (`OpenEXR` or PNG, also one of each), and writes maps into a directory, which is made if it
/// is not there: `delta_e00.png` and `relative_brightness.png` to look at, `difference.exr` with the numbers.
///
/// # Errors
/// [`CompareError`]: a file that can't be read or written, pictures of different size, options out of range.
pub fn compare(
    first: &Path,
    second: &Path,
    directory: &Path,
    options: &CompareOptions,
) -> Result<Comparison, CompareError> {
    let pictures = [read_picture(first)?, read_picture(second)?];
    let difference = difference(&pictures[0], &pictures[1], options).map_err(|error| match error {
        CompareError::Size { first: a, second: b } => {
            CompareError::FileSize { first: first.to_owned(), second: second.to_owned(), sizes: [a, b] }
        }
        other => other,
    })?;
    let mut comparison = difference.statistics();
    comparison.files = difference.write(directory)?;
    Ok(comparison)
}

/// The difference of two pictures at each pixel.
///
/// ΔE00 is between the CIELAB colours of the exposed pixels relative to the white of Rec. 709 with Y = 1; highlights
/// above white are compared as they are, not clipped. The relative brightness is that of luminances of at least the
/// floor, so that pixels dark in both pictures differ by 0, and no ratio is infinite.
///
/// # Errors
/// [`CompareError::Size`], [`CompareError::Option`], [`CompareError::NotFinite`].
pub fn difference(first: &Picture, second: &Picture, options: &CompareOptions) -> Result<Difference, CompareError> {
    for (name, value) in [("exposure", options.exposure), ("floor", options.floor)] {
        if !(value > 0.0 && value.is_finite()) {
            return Err(CompareError::Option { name, value });
        }
    }
    if !first.same_size(second) {
        let size = |picture: &Picture| (picture.width(), picture.height());
        return Err(CompareError::Size { first: size(first), second: size(second) });
    }
    let pairs = || first.pixels().par_iter().zip(second.pixels());
    if let Some(index) = pairs().position_first(|pair| !finite(pair)) {
        let (x, y) = first.position(index);
        return Err(CompareError::NotFinite { x, y });
    }
    let raster = |pixels| Raster::from_pixels(first.width(), first.height(), pixels);
    Ok(Difference {
        linear: Raster::from_pixels(first.width(), first.height(), pairs().map(subtract).collect())?,
        delta_e00: raster(pairs().map(|pair| colour_difference(pair, options)).collect())?,
        relative_brightness: raster(pairs().map(|pair| relative_brightness(pair, options)).collect())?,
    })
}

type Pair<'p> = (&'p [f32; 3], &'p [f32; 3]);

fn finite((first, second): Pair<'_>) -> bool {
    first.iter().chain(second).all(|component| component.is_finite())
}

/// Numbers too large for `f32` become its largest: everything that is written must be finite.
#[allow(clippy::cast_possible_truncation, reason = "limited to the range, and meant to be rounded")]
fn narrow(value: f64) -> f32 {
    value.clamp(f64::from(f32::MIN), f64::from(f32::MAX)) as f32
}

fn subtract((first, second): Pair<'_>) -> [f32; 3] {
    [0, 1, 2].map(|c| narrow(f64::from(first[c]) - f64::from(second[c])))
}

fn xyz(pixel: &[f32; 3], options: &CompareOptions) -> [f64; 3] {
    linear_rgb_to_xyz(pixel.map(|component| f64::from(component) * f64::from(options.exposure)))
}

fn colour_difference((first, second): Pair<'_>, options: &CompareOptions) -> f32 {
    let lab = |pixel| xyz_to_lab(xyz(pixel, options), WHITE);
    narrow(delta_e_00(lab(first), lab(second)))
}

fn relative_brightness((first, second): Pair<'_>, options: &CompareOptions) -> f32 {
    let luminance = |pixel| xyz(pixel, options)[1].max(f64::from(options.floor));
    narrow(luminance(first) / luminance(second) - 1.0)
}

/// Names of the files that [`Difference::write`] writes.
const NAMES: [&str; 3] = ["delta_e00.png", "relative_brightness.png", "difference.exr"];

impl Difference {
    /// The figures, without files.
    #[must_use]
    pub fn statistics(&self) -> Comparison {
        let mut sorted: Vec<f64> = self.delta_e00.pixels().iter().map(|&value| f64::from(value)).collect();
        sorted.par_sort_unstable_by(f64::total_cmp);
        let brightness = self.relative_brightness.pixels();
        Comparison {
            width: self.delta_e00.width(),
            height: self.delta_e00.height(),
            delta_e00: DeltaEStatistics {
                mean: mean(&sorted),
                p95: percentile(&sorted, 0.95),
                max: percentile(&sorted, 1.0),
            },
            relative_brightness: BrightnessRange {
                min: f64::from(brightness.iter().copied().fold(f32::INFINITY, f32::min)),
                max: f64::from(brightness.iter().copied().fold(f32::NEG_INFINITY, f32::max)),
            },
            files: Vec::new(),
        }
    }

    /// Writes both maps in false colour and the numbers as `OpenEXR` (linear difference in `R`, `G`, `B`, and the channels
    /// `delta_e00` and `relative_brightness`) into a directory, and returns the files' names.
    ///
    /// The palettes cover 99 % of the pixels; the legend says where more is beyond.
    ///
    /// # Errors
    /// [`ImageError::Io`].
    pub fn write(&self, directory: &Path) -> Result<Vec<PathBuf>, ImageError> {
        std::fs::create_dir_all(directory).map_err(|source| ImageError::io(directory, source))?;
        let files = NAMES.map(|name| directory.join(name));
        let figures = self.statistics();
        let DeltaEStatistics { mean, p95, max } = figures.delta_e00;
        let title = format!("ΔE00: mean {mean:.3}, p95 {p95:.3}, max {max:.3}");
        FalseColour::new(&title, 0.0, round_up(covering(&self.delta_e00)).max(0.1))
            .write_png(&files[0], &self.delta_e00)?;

        let BrightnessRange { min, max } = figures.relative_brightness;
        let title = format!("Relative brightness Ya / Yb − 1: {min:+.4} to {max:+.4}");
        let limit = round_up(covering(&self.relative_brightness)).max(1e-3);
        FalseColour::signed(&title, limit).write_png(&files[1], &self.relative_brightness)?;

        let channels = [("delta_e00", &self.delta_e00), ("relative_brightness", &self.relative_brightness)];
        let comments = "R, G, B: the first picture minus the second one, linear Rec. 709";
        write_exr(&files[2], &self.linear, &channels, &[("comments", comments)])?;
        Ok(files.into())
    }
}

/// The magnitude that 99 % of the pixels don't exceed.
fn covering(map: &ScalarMap) -> f64 {
    let mut sorted: Vec<f64> = map.pixels().iter().map(|&value| f64::from(value).abs()).collect();
    sorted.par_sort_unstable_by(f64::total_cmp);
    percentile(&sorted, 0.99)
}

/// The next of 1, 2, 5 times a power of ten; 0 for 0.
fn round_up(value: f64) -> f64 {
    if value <= 0.0 {
        return 0.0;
    }
    let decade = 10.0_f64.powf(value.log10().floor());
    [1.0, 2.0, 5.0].into_iter().map(|factor| factor * decade).find(|&limit| limit >= value).unwrap_or(10.0 * decade)
}

/// The mean of numbers in a fixed order, so that it does not depend on threads.
#[allow(clippy::cast_precision_loss, reason = "numbers of pixels are far below 2^53")]
fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len().max(1) as f64
}

/// A quantile of sorted numbers, type 7 of Hyndman and Fan: linear between order statistics. 0 for none.
#[allow(
    clippy::cast_precision_loss,
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "numbers of pixels are far below 2^53"
)]
fn percentile(sorted: &[f64], fraction: f64) -> f64 {
    let Some(last) = sorted.len().checked_sub(1) else { return 0.0 };
    let position = fraction * last as f64;
    let below = (position.floor() as usize).min(last);
    let above = (below + 1).min(last);
    sorted[below] + (sorted[above] - sorted[below]) * (position - below as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grey(value: f32) -> Picture {
        Picture::filled(4, 3, [value; 3]).unwrap()
    }

    #[test]
    fn equal_pictures_do_not_differ() {
        for value in [0.0, -0.5, 0.18, 1.0, 1e6, f32::MAX] {
            let comparison = difference(&grey(value), &grey(value), &CompareOptions::default()).unwrap().statistics();
            assert_eq!(comparison.delta_e00, DeltaEStatistics { mean: 0.0, p95: 0.0, max: 0.0 });
            assert_eq!(comparison.relative_brightness, BrightnessRange { min: 0.0, max: 0.0 });
        }
    }

    #[test]
    fn greys_differ_as_their_lightness() {
        // L* of 0.18 is 49.496; between greys ΔE00 is ΔL*/S_L with S_L from the mean lightness.
        let map = difference(&grey(1.0), &grey(0.18), &CompareOptions::default()).unwrap();
        let lightness = 116.0 * 0.18_f64.cbrt() - 16.0;
        let offset = (0.5 * (100.0 + lightness) - 50.0).powi(2);
        let expected = (100.0 - lightness) / (1.0 + 0.015 * offset / (20.0 + offset).sqrt());
        for &value in map.delta_e00.pixels() {
            assert!((f64::from(value) - expected).abs() <= 1e-5, "{value}, expected {expected}");
        }
        for &value in map.relative_brightness.pixels() {
            assert!((value - (1.0 / 0.18 - 1.0)).abs() <= 1e-5);
        }
    }

    #[test]
    fn dark_pixels_are_not_divided_by() {
        let options = CompareOptions::default();
        let ratio = |a, b| difference(&grey(a), &grey(b), &options).unwrap().relative_brightness.pixels()[0];
        assert_eq!(ratio(0.0, 1e-9), 0.0);
        assert_eq!(ratio(-3.0, 0.0), 0.0);
        assert!((ratio(1.0, 0.0) - 999.0).abs() <= 1e-3);
        assert!((ratio(0.0, 1.0) + 0.999).abs() <= 1e-6);
        assert_eq!(ratio(f32::MAX, 0.0), f32::MAX);
    }

    #[test]
    fn the_exposure_makes_white() {
        let options = CompareOptions { exposure: 0.01, ..CompareOptions::default() };
        let exposed = difference(&grey(100.0), &grey(50.0), &options).unwrap();
        let plain = difference(&grey(1.0), &grey(0.5), &CompareOptions::default()).unwrap();
        for (a, b) in exposed.delta_e00.pixels().iter().zip(plain.delta_e00.pixels()) {
            assert!((a - b).abs() <= 1e-4);
        }
    }

    #[test]
    fn percentiles_lie_between_order_statistics() {
        let sorted: Vec<f64> = (0..=10).map(f64::from).collect();
        assert_eq!(percentile(&sorted, 0.95), 9.5);
        assert_eq!(percentile(&sorted, 1.0), 10.0);
        assert_eq!(percentile(&sorted, 0.0), 0.0);
        assert_eq!(percentile(&[3.0], 0.95), 3.0);
    }

    #[test]
    fn limits_are_round() {
        for (value, limit) in [(0.0, 0.0), (0.99, 1.0), (1.01, 2.0), (2.5, 5.0), (7.0, 10.0), (3e-4, 5e-4)] {
            assert!((round_up(value) - limit).abs() <= 1e-12 * limit, "{value}");
        }
    }

    #[test]
    fn impossible_comparisons_are_refused() {
        let options = CompareOptions::default();
        let turned = Picture::filled(3, 4, [0.0; 3]).unwrap();
        let error = difference(&grey(0.0), &turned, &options).unwrap_err();
        assert_eq!(error.to_string(), "the pictures differ in size: 4 × 3 and 3 × 4 pixels");
        let mut bad = grey(0.5);
        bad.pixels_mut()[6][1] = f32::NAN;
        for (a, b) in [(&bad, &grey(0.5)), (&grey(0.5), &bad)] {
            assert!(matches!(difference(a, b, &options), Err(CompareError::NotFinite { x: 2, y: 1 })));
        }
        for value in [0.0, -1.0, f32::NAN, f32::INFINITY] {
            let exposure = CompareOptions { exposure: value, ..options };
            assert!(matches!(difference(&bad, &bad, &exposure), Err(CompareError::Option { name: "exposure", .. })));
            let floor = CompareOptions { floor: value, ..options };
            assert!(matches!(difference(&bad, &bad, &floor), Err(CompareError::Option { name: "floor", .. })));
        }
    }

    #[test]
    fn the_report_has_its_keys() {
        let comparison = difference(&grey(0.5), &grey(0.25), &CompareOptions::default()).unwrap().statistics();
        let json = serde_json::to_value(&comparison).unwrap();
        for key in ["/delta_e00/mean", "/delta_e00/p95", "/delta_e00/max"] {
            assert!(json.pointer(key).unwrap().as_f64().unwrap() > 0.0, "{key}");
        }
        for key in ["/relative_brightness/min", "/relative_brightness/max"] {
            assert!((json.pointer(key).unwrap().as_f64().unwrap() - 1.0).abs() <= 1e-6, "{key}");
        }
        assert!(json["files"].is_array());
    }
}
