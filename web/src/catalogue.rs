//! What there is to choose from, and the colours of what is drawn.

use serde::Serialize;
use spectral_core::colour::{linear_rgb_to_srgb8, xyz_to_linear_rgb};
use spectral_core::colour_rendering::munsell_samples;
use spectral_core::interval::{Domain, Interval, Node, Weight};
use spectral_core::spectrum::{Outside, Uniform};
use spectral_core::tables::{colorchecker, illuminants, lights};
use spectral_core::{Observer, Spectrum};

use crate::swatch::{Display, xyz};

/// A name and a colour as bytes of sRGB.
#[derive(Serialize)]
pub(crate) struct Named {
    name: String,
    srgb: [u8; 3],
}

/// What there is to choose from.
#[derive(Serialize)]
pub(crate) struct Catalogue {
    lights: Vec<&'static str>,
    /// The ColorChecker, with its colours under D65.
    paints: Vec<Named>,
    /// The samples of R_1 to R_14, under D65.
    samples: Vec<[u8; 3]>,
    /// What wavelengths from 380 nm on in steps of 5 nm look like.
    hues: Vec<[u8; 3]>,
}

pub(crate) fn catalogue() -> Catalogue {
    let paints = colorchecker::ALL
        .iter()
        .map(|table| Named { name: table.name.replace('_', " "), srgb: under_daylight(table.spectrum(Outside::Hold)) });
    Catalogue {
        lights: lights().map(|table| table.name).collect(),
        paints: paints.collect(),
        samples: munsell_samples().into_iter().map(under_daylight).collect(),
        hues: (0..=80).map(|index| hue(f64::from(380 + 5 * index))).collect(),
    }
}

/// The colour of a reflectance under D65.
fn under_daylight(reflectance: Uniform<'_, f64>) -> [u8; 3] {
    let light = illuminants::D65.spectrum(Outside::Zero);
    Display::new(xyz(&light)).adapted(product(&[&light, &reflectance]).unwrap_or_default())
}

/// XYZ of a product of spectra, exact but for rounding.
pub(crate) fn product(factors: &[&dyn Spectrum<f64>]) -> Option<[f64; 3]> {
    let mut weights = [Weight::default(); 1];
    let domain = Domain::build(Observer::cie_1931_2deg(), 0, &mut weights).ok()?;
    let found = Interval::of_product(factors, &domain, Node::ROOT, &Interval::zero());
    Some(found.tristimulus(&domain.weight(Node::ROOT)))
}

/// The hue of a wavelength as bright as can be, darker where eyes see little; greens that sRGB has not get as much white as they need.
fn hue(wavelength: f64) -> [u8; 3] {
    let rgb = xyz_to_linear_rgb(Observer::cie_1931_2deg().value(wavelength));
    let white = -rgb[0].min(0.0);
    let largest = rgb.into_iter().fold(f64::MIN_POSITIVE, f64::max) + white;
    let seen = ((wavelength - 350.0) / 70.0).min((800.0 - wavelength) / 110.0).clamp(0.0, 1.0);
    linear_rgb_to_srgb8(rgb.map(|c| (c + white) / largest * seen))
}
