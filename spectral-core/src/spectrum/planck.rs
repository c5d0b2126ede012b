//! Black bodies.

use super::grid::interpolate;
use super::{Segment, Spectrum, SpectrumError};
use crate::Real;

/// The second radiation constant c₂ = h c / k in m K, as it was taken to be when a colour temperature was defined.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum RadiationConstant {
    /// 1.4350 × 10⁻² m K, with which CIE defined illuminant A in 1931 as 2848 K (CIE 15).
    Cie1931,
    /// 1.4380 × 10⁻² m K, of the International Practical Temperature Scale of 1948, in force when CIE defined the
    /// D illuminants by nominal temperatures.
    Ipts1948,
    /// 1.4388 × 10⁻² m K, of the scales of 1968 and 1990 (ITS-90), which CIE 15 uses.
    Its1990,
    /// 1.438 776 877 × 10⁻² m K, from the exact h, c and k of the SI of 2019.
    #[default]
    Si2019,
}

impl RadiationConstant {
    /// The constant in m K.
    #[must_use]
    pub const fn metre_kelvin(self) -> f64 {
        match self {
            Self::Cie1931 => 1.4350e-2,
            Self::Ipts1948 => 1.4380e-2,
            Self::Its1990 => 1.4388e-2,
            Self::Si2019 => 1.438_776_877e-2,
        }
    }
}

/// First radiation constant for radiance, 2 h c² of the SI of 2019, as W nm⁴ m⁻² sr⁻¹: λ in nm, radiance per nm.
const FIRST: f64 = 1.191_042_972_397_188_4e20;

/// Last wavelength in nm at which a [`Planck`] spectrum isn't zero: 1 mm.
const LAST: usize = 1_000_000;

/// Spectral radiance of a black body in W m⁻² sr⁻¹ nm⁻¹.
///
/// `L(λ) = 2 h c² λ⁻⁵ / (exp(c₂ / (λ T)) − 1)` at whole nanometres, and *defined* as linear between them, so that the
/// spectrum is piecewise linear like every other. Zero below 0 and above 10⁶ nm.
///
/// Over 380–780 nm the interpolation differs from Planck's law itself, [`radiance`](Planck::radiance), by at most
/// (measured at 41 points a nanometre):
///
/// | T (K) | 1000 | 2000 | 2856 | 5000 | 6504 | 10000 | 25000 |
/// |---|---|---|---|---|---|---|---|
/// | relative error | 8.7e-4 | 1.4e-4 | 4.1e-5 | 3.7e-6 | 5.1e-6 | 2.1e-6 | 9.8e-6 |
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Planck<R> {
    temperature: R,
    /// c₂ / T in nm.
    scale: R,
}

impl<R: Real> Planck<R> {
    /// A black body of the given temperature in K.
    ///
    /// # Errors
    /// [`SpectrumError::Temperature`] unless the temperature is above 0 K and at most 10⁹ K.
    pub fn new(temperature: R, constant: RadiationConstant) -> Result<Self, SpectrumError> {
        if !(temperature > R::ZERO && temperature <= R::from_f64(1e9)) {
            return Err(SpectrumError::Temperature);
        }
        let scale = R::from_f64(constant.metre_kelvin() * 1e9) / temperature;
        Ok(Self { temperature, scale })
    }

    /// The temperature in K.
    #[must_use]
    pub const fn temperature(&self) -> R {
        self.temperature
    }

    /// Planck's law at any wavelength in nm, without interpolation; zero at and below 0 nm.
    ///
    /// Accuracy: (6 + c₂ / (λ T)) EPSILON, relative, where the result is a normal number.
    pub fn radiance(&self, wavelength: R) -> R {
        if wavelength <= R::ZERO {
            return R::ZERO;
        }
        let square = wavelength * wavelength;
        let (fifth, argument) = (square * square * wavelength, self.scale / wavelength);
        let first = R::from_f64(FIRST);
        // Far into the infrared the power overflows, far into the ultraviolet the exponential does, long before the radiance underflows.
        let front = if fifth.is_finite() { first / fifth } else { first / square / square / wavelength };
        if argument < R::from_f64(64.0) {
            return front / argument.exp_m1();
        }
        let half = (-argument * R::HALF).exp();
        front * half * half
    }
}

impl<R: Real> Spectrum<R> for Planck<R> {
    fn segment(&self, wavelength: R) -> Segment<R> {
        let flat = |end| Segment { end, first: R::ZERO, last: R::ZERO };
        if wavelength < R::ZERO {
            return flat(R::ZERO);
        }
        if wavelength >= R::from_usize(LAST) || wavelength.is_nan() {
            return flat(R::INFINITY);
        }
        let start = wavelength.floor();
        let end = start + R::ONE;
        let (first, last) = (self.radiance(start), self.radiance(end));
        Segment { end, first: interpolate(first, last, wavelength - start, end - wavelength), last }
    }
}
