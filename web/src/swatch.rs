//! Colours as the page shows them.

use spectral_core::adaptation::Adaptation;
use spectral_core::colour::{linear_rgb_to_srgb8, xyz_to_linear_rgb};
use spectral_core::{Observer, Spectrum, tristimulus};

use crate::light::SpectralTable;

/// The white of sRGB.
const WHITE: [f64; 3] = [0.950_455_927_051_671_8, 1.0, 1.089_057_750_759_878_4];

/// XYZ of a spectrum, in its unit times nm.
pub(crate) fn xyz(spectrum: &dyn Spectrum<f64>) -> [f64; 3] {
    tristimulus(&Observer::cie_1931_2deg(), spectrum, 380.0, 780.0)
}

/// How colours under a light are shown.
pub(crate) struct Display {
    adaptation: Adaptation<f64>,
    luminance: f64,
    brightest: f64,
}

impl Display {
    /// For a light of this XYZ.
    pub(crate) fn new(white: [f64; 3]) -> Self {
        let luminance = white[1];
        let relative = white.map(|value| value / luminance);
        let brightest = xyz_to_linear_rgb(relative).into_iter().fold(f64::MIN_POSITIVE, f64::max);
        Self { adaptation: Adaptation::bradford(relative, WHITE), luminance, brightest }
    }

    /// A colour as a camera balanced for daylight has it: the light itself is as bright as sRGB can be.
    pub(crate) fn as_is(&self, xyz: [f64; 3]) -> [u8; 3] {
        linear_rgb_to_srgb8(xyz_to_linear_rgb(xyz.map(|value| value / self.luminance)).map(|c| c / self.brightest))
    }

    /// A colour as an eye that is adapted to the light sees it: the light itself is white.
    pub(crate) fn adapted(&self, xyz: [f64; 3]) -> [u8; 3] {
        let adapted = self.adaptation.apply(xyz.map(|value| value / self.luminance));
        linear_rgb_to_srgb8(xyz_to_linear_rgb(adapted).map(|c| if c.is_finite() { c } else { 0.0 }))
    }
}

/// A light's own colour, as bright as sRGB can be.
pub(crate) fn brightest(light: &SpectralTable) -> Option<[u8; 3]> {
    let white = xyz(&light.spectrum()?);
    (white[1] > 0.0).then(|| Display::new(white).as_is(white))
}
