//! Spectral pictures in `OpenEXR` files, in the layout of Fichet, Pacanowski and Wilkie, "An OpenEXR Layout for Spectral Images" (Journal of
//! Computer Graphics Techniques 10(3), 2021).
//!
//! A channel for each wavelength, `S0.550,000000nm`, has a spectral radiance; `R`, `G`, `B` are a preview; the header says
//! `spectralLayoutVersion` 1.0 and `emissiveUnits` W.m^-2.sr^-1, which is the layout's name for what is here W m⁻² sr⁻¹ nm⁻¹.

use super::exr::{Channels, read_channels, write_layer};
use super::raster::area;
use super::{ImageError, Picture, ScalarMap};
use std::path::Path;

/// The speed of light in a vacuum in nm/s.
const LIGHT_SPEED: f64 = 299_792_458e9;
/// The most samples of all wavelengths together: 4 GB.
const MAX_SAMPLES: usize = 1 << 30;

/// A spectral radiance for every pixel, at some wavelengths.
#[derive(Clone, Debug, PartialEq)]
pub struct SpectralPicture {
    width: usize,
    height: usize,
    wavelengths: Vec<f64>,
    /// One for each wavelength.
    planes: Vec<ScalarMap>,
}

impl SpectralPicture {
    /// A black picture at increasing wavelengths in nm.
    ///
    /// # Errors
    /// [`ImageError::Size`] if a side is 0, or if there are more than 2³⁰ samples; [`ImageError::Range`] if the wavelengths don't increase.
    pub fn black(width: usize, height: usize, wavelengths: &[f64]) -> Result<Self, ImageError> {
        check_samples(width, height, wavelengths.len())?;
        let planes = wavelengths.iter().map(|_| ScalarMap::filled(width, height, 0.0)).collect::<Result<_, _>>()?;
        Self::new(width, height, wavelengths.to_vec(), planes)
    }

    fn new(width: usize, height: usize, wavelengths: Vec<f64>, planes: Vec<ScalarMap>) -> Result<Self, ImageError> {
        match wavelengths.windows(2).find(|pair| !(pair[0] < pair[1])) {
            Some(pair) => Err(ImageError::Range { low: pair[0], high: pair[1] }),
            None => Ok(Self { width, height, wavelengths, planes }),
        }
    }

    /// Pixels in a row.
    #[must_use]
    pub fn width(&self) -> usize {
        self.width
    }

    /// Rows.
    #[must_use]
    pub fn height(&self) -> usize {
        self.height
    }

    /// The wavelengths in nm, increasing.
    #[must_use]
    pub fn wavelengths(&self) -> &[f64] {
        &self.wavelengths
    }

    /// The radiances at the wavelength with this index, W m⁻² sr⁻¹ nm⁻¹.
    #[must_use]
    pub fn plane(&self, index: usize) -> Option<&ScalarMap> {
        self.planes.get(index)
    }

    /// A row of it.
    #[must_use]
    pub fn row(&self, index: usize, y: usize) -> Option<&[f32]> {
        self.planes.get(index)?.pixels().chunks(self.width).nth(y)
    }

    /// The spectrum of a pixel.
    #[must_use]
    pub fn spectrum(&self, x: usize, y: usize) -> Option<Vec<f32>> {
        self.planes.iter().map(|plane| plane.get(x, y).copied()).collect()
    }

    /// Adds a share of a spectrum to a pixel; nothing outside the picture.
    pub fn add(&mut self, [x, y]: [usize; 2], spectrum: &[f64], share: f64) {
        let inside = x < self.width && y < self.height;
        let index = y * self.width + x;
        for (plane, value) in self.planes.iter_mut().zip(spectrum).filter(|_| inside) {
            if let Some(pixel) = plane.pixels_mut().get_mut(index) {
                #[allow(clippy::cast_possible_truncation, reason = "pictures are kept in f32")]
                let sum = (f64::from(*pixel) + share * value) as f32;
                *pixel = sum.clamp(f32::MIN, f32::MAX);
            }
        }
    }
}

fn check_samples(width: usize, height: usize, wavelengths: usize) -> Result<(), ImageError> {
    match area(width, height)?.checked_mul(wavelengths) {
        Some(samples) if samples <= MAX_SAMPLES => Ok(()),
        _ => Err(ImageError::Size { width, height }),
    }
}

/// A spectral picture with what goes with it in a file.
#[derive(Clone, Debug, PartialEq)]
pub struct SpectralExr {
    /// The radiances.
    pub picture: SpectralPicture,
    /// The preview, if there is one: linear RGB.
    pub preview: Option<Picture>,
    /// Names of channels that were not read: other components of polarised light, reflectances and whatever else.
    pub others: Vec<String>,
    /// The attributes that are texts, with their names, sorted.
    pub attributes: Vec<(String, String)>,
}

/// Writes a spectral picture with its preview in the layout of Fichet et al. 2021, in 32-bit floats, bit for bit, compressed without loss.
///
/// `attributes` (name, text) go into the header beside the layout's own.
///
/// # Errors
/// [`ImageError::ChannelSize`] if the preview has another size; [`ImageError::NotFinite`]; [`ImageError::Name`]; [`ImageError::Io`].
pub fn write_spectral_exr(
    path: &Path,
    picture: SpectralPicture,
    preview: &Picture,
    attributes: &[(&str, &str)],
) -> Result<(), ImageError> {
    let SpectralPicture { width, height, wavelengths, planes } = picture;
    let mut channels = Vec::with_capacity(planes.len() + 3);
    for (index, name) in ["R", "G", "B"].into_iter().enumerate() {
        channels.push((name.to_owned(), preview.map(|pixel| pixel[index])));
    }
    channels.extend(wavelengths.iter().map(|wavelength| channel_name(*wavelength)).zip(planes));
    if let Some((name, map)) = channels.iter().find(|(_, map)| (map.width(), map.height()) != (width, height)) {
        let _ = map;
        return Err(ImageError::ChannelSize { file: path.to_owned(), channel: name.clone() });
    }
    for (name, map) in &channels {
        finite(path, name, map)?;
    }
    let own =
        [("spectralLayoutVersion", "1.0"), ("emissiveUnits", "W.m^-2.sr^-1"), ("polarisationHandedness", "right")];
    let attributes: Vec<_> = own.into_iter().chain(attributes.iter().copied()).collect();
    write_layer(path, [width, height], channels, &attributes)
}

/// The layout's name of a wavelength in nm.
fn channel_name(wavelength: f64) -> String {
    format!("S0.{wavelength:.6}nm").replacen("S0.", "S0|", 1).replace('.', ",").replacen('|', ".", 1)
}

fn finite(file: &Path, name: &str, map: &ScalarMap) -> Result<(), ImageError> {
    match map.pixels().iter().position(|value| !value.is_finite()) {
        Some(index) => {
            let (x, y) = map.position(index);
            Err(ImageError::NotFinite { file: file.to_owned(), channel: name.to_owned(), x, y })
        }
        None => Ok(()),
    }
}

/// Reads the unpolarised radiance of a spectral picture in the layout of Fichet et al. 2021: channels `S0`, by wavelength or frequency in any
/// unit of the layout, in any order.
///
/// # Errors
/// [`ImageError::Io`]; [`ImageError::Malformed`]: damaged, or a wavelength given twice; [`ImageError::Unsupported`]: no such channels;
/// [`ImageError::NotFinite`]; [`ImageError::Size`] for more than 2³⁰ samples.
pub fn read_spectral_exr(path: &Path) -> Result<SpectralExr, ImageError> {
    let Channels { size: [width, height], channels, attributes } =
        read_channels(path).map_err(|error| match error {
            // Its size is the file's fault.
            ImageError::Size { .. } => ImageError::malformed(path, error),
            other => other,
        })?;
    let (mut found, mut others, mut colours) = (Vec::new(), Vec::new(), [const { None }; 3]);
    for (name, map) in channels {
        if let Some(wavelength) = wavelength(&name) {
            finite(path, &name, &map)?;
            found.push((wavelength, name, map));
        } else if let Some(index) = ["R", "G", "B"].iter().position(|colour| *colour == name) {
            colours[index] = Some(map);
        } else {
            others.push(name);
        }
    }
    if found.is_empty() {
        return Err(ImageError::unsupported(path, "no spectral radiance (channels like S0.550,000000nm)"));
    }
    check_samples(width, height, found.len())?;
    found.sort_by(|(a, ..), (b, ..)| a.total_cmp(b));
    if let Some(pair) = found.windows(2).find(|pair| pair[0].0 == pair[1].0) {
        let same = format_args!("channels `{}` and `{}` have the same wavelength", pair[0].1, pair[1].1).to_string();
        return Err(ImageError::malformed(path, same));
    }
    let (wavelengths, planes) = found.into_iter().map(|(wavelength, _, map)| (wavelength, map)).unzip();
    let preview = match colours {
        [Some(r), Some(g), Some(b)] => {
            let colour = |x, y| [&r, &g, &b].map(|map: &ScalarMap| map.get(x, y).copied().unwrap_or(0.0));
            Some(Picture::from_fn(width, height, colour)?)
        }
        _ => None,
    };
    let picture = SpectralPicture::new(width, height, wavelengths, planes)?;
    Ok(SpectralExr { picture, preview, others, attributes })
}

/// The wavelength in nm of a channel of unpolarised radiance: `S0.` or `S0`, a number with a decimal comma, and a unit of length or frequency.
fn wavelength(name: &str) -> Option<f64> {
    let rest = name.strip_prefix("S0")?.trim_start_matches('.');
    let (number, is_frequency) = match rest.strip_suffix("Hz") {
        Some(rest) => (rest, true),
        None => (rest.strip_suffix('m')?, false),
    };
    let digits = number.trim_end_matches(|c: char| c.is_ascii_alphabetic());
    let exponent = multiplier(number.get(digits.len()..)?)?;
    let value: f64 = digits.replace(',', ".").parse().ok()?;
    let nm = match (is_frequency, exponent) {
        // Nothing is rounded.
        (false, -9) => value,
        (false, exponent) => value * 10.0_f64.powi(exponent + 9),
        (true, exponent) => LIGHT_SPEED / (value * 10.0_f64.powi(exponent)),
    };
    (nm > 0.0 && nm.is_finite()).then_some(nm)
}

/// The power of ten of a prefix.
fn multiplier(prefix: &str) -> Option<i32> {
    const PREFIXES: [(&str, i32); 16] = [
        ("", 0),
        ("Y", 24),
        ("Z", 21),
        ("E", 18),
        ("P", 15),
        ("T", 12),
        ("G", 9),
        ("M", 6),
        ("k", 3),
        ("h", 2),
        ("da", 1),
        ("d", -1),
        ("c", -2),
        ("m", -3),
        ("u", -6),
        ("n", -9),
    ];
    let pico = ("p", -12);
    PREFIXES.into_iter().chain([pico]).find(|(known, _)| *known == prefix).map(|(_, exponent)| exponent)
}

#[cfg(test)]
mod tests {
    use super::{channel_name, wavelength};

    #[test]
    fn names_are_those_of_the_layout() {
        assert_eq!(channel_name(550.0), "S0.550,000000nm");
        assert_eq!(channel_name(382.469_135_802), "S0.382,469136nm");
    }

    #[test]
    fn wavelengths_are_read_in_all_units() {
        for (name, expected) in [
            ("S0.550,000000nm", 550.0),
            ("S0550nm", 550.0),
            ("S0.5,5e2nm", 550.0),
            ("S0.0,55um", 550.0),
            ("S0.5.5nm", 5.5),
            ("S0.545,077196364THz", 550.0),
        ] {
            let found = wavelength(name).unwrap_or(f64::NAN);
            assert!((found - expected).abs() <= 1e-9 * expected, "{name}: {found}");
        }
        for name in [
            "S1.550,000000nm",
            "T.550,000000nm",
            "S0.nm",
            "S0.550",
            "S0.550nmm",
            "S0.-550nm",
            "S0.0nm",
            "S0.infnm",
            "S0",
            "R",
        ] {
            assert_eq!(wavelength(name), None, "{name}");
        }
    }
}
