//! Lights of a given colour.

use super::solver::Upsampler;
use super::{Sigmoid, UpsamplerError, UpsamplingError};
use crate::colour::RgbSpace;
use crate::integrate::tristimulus;
use crate::matrix::largest;
use crate::spectrum::{Constant, Outside, Segment, Spectrum, Uniform};
use crate::tables::illuminants;
use crate::{Observer, Real};

/// Finds light spectra for colours: sigmoids times a light that is taken to be white.
#[derive(Clone, Debug)]
pub struct LightUpsampler<L, R> {
    upsampler: Upsampler<R>,
    light: L,
    /// What the light is multiplied by so that its luminance is 1.
    unit: R,
}

impl<R: Real> LightUpsampler<Uniform<'static, R>, R> {
    /// For lights that are white like CIE D65, to the 2° observer of 1931.
    ///
    /// # Errors
    /// None for D65.
    pub fn d65(space: &RgbSpace) -> Result<Self, UpsamplerError> {
        Self::new(&Observer::cie_1931_2deg(), illuminants::D65.spectrum(Outside::Zero), space)
    }
}

impl<R: Real, L: Spectrum<R> + Copy> LightUpsampler<L, R> {
    /// For lights of which `light` is the white one.
    ///
    /// # Errors
    /// [`UpsamplerError::White`] unless the tristimulus values of the light, and its components in the RGB space, are positive.
    pub fn new(observer: &Observer<R>, light: L, space: &RgbSpace) -> Result<Self, UpsamplerError> {
        let upsampler = Upsampler::at_nodes(observer, |wavelength| light.value(wavelength), space)?;
        let flat = Constant::new(R::ONE).map_err(|_| UpsamplerError::White)?;
        let white = Emission { sigmoid: Sigmoid::grey(R::ONE), light, scale: R::ONE };
        let (from, to) = (R::from_f64(380.0), R::from_f64(780.0));
        let [own, equal] = [tristimulus(observer, &white, from, to)[1], tristimulus(observer, &flat, from, to)[1]];
        let unit = equal / own;
        if unit.is_finite() { Ok(Self { upsampler, light, unit }) } else { Err(UpsamplerError::White) }
    }

    /// The light with the given linear RGB, each component 0 or above.
    ///
    /// S(λ) = 2 m σ(λ) L(λ) k, where m is the largest component, σ the [`Sigmoid`] for RGB / (2 m), L the light that is white,
    /// and k such that ∫ k L ȳ = ∫ ȳ: (1, 1, 1) is the white light with luminance 1. Half the largest component is aimed at, as Mitsuba
    /// does, because there sigmoids are smoothest.
    ///
    /// Accurate as [`Upsampler::reflectance`], relative to m. Black is 0 at every wavelength.
    ///
    /// # Errors
    /// [`UpsamplingError::Component`] when a component is negative or not finite, or twice the largest isn't;
    /// [`UpsamplingError::Unreachable`] where no sigmoid has this colour.
    pub fn emission(&self, rgb: [R; 3]) -> Result<Emission<L, R>, UpsamplingError> {
        if let Some(channel) = rgb.iter().position(|c| !(*c >= R::ZERO && (R::TWO * *c).is_finite())) {
            return Err(UpsamplingError::Component { channel });
        }
        let most = largest(rgb);
        if most == R::ZERO {
            return Ok(Emission { sigmoid: Sigmoid::grey(R::HALF), light: self.light, scale: R::ZERO });
        }
        let sigmoid = self.upsampler.reflectance(rgb.map(|c| R::HALF * (c / most)))?;
        Ok(Emission { sigmoid, light: self.light, scale: R::TWO * most * self.unit })
    }

    /// The RGB of an emission of this upsampler.
    #[must_use]
    pub fn colour(&self, emission: &Emission<L, R>) -> [R; 3] {
        let factor = emission.scale / self.unit;
        self.upsampler.colour(&emission.sigmoid).map(|c| c * factor)
    }
}

/// A light of a given colour: a sigmoid times a light, scaled; from [`LightUpsampler::emission`].
///
/// *Defined* as linear between its values at 360, 365, …, 830 nm, and 0 outside.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Emission<L, R> {
    sigmoid: Sigmoid<R>,
    light: L,
    scale: R,
}

impl<R: Real, L: Spectrum<R>> Emission<L, R> {
    /// The sigmoid that the light is multiplied by.
    #[must_use]
    pub const fn sigmoid(&self) -> &Sigmoid<R> {
        &self.sigmoid
    }

    /// What their product is multiplied by.
    #[must_use]
    pub fn scale(&self) -> R {
        self.scale
    }

    /// The value at a node.
    fn at(&self, wavelength: R) -> R {
        self.scale * (self.sigmoid.smooth(wavelength) * self.light.value(wavelength))
    }
}

impl<R: Real, L: Spectrum<R>> Spectrum<R> for Emission<L, R> {
    fn segment(&self, wavelength: R) -> Segment<R> {
        super::sigmoid::between_nodes(wavelength, |node| self.at(node), Outside::Zero)
    }
}
