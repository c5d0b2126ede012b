//! CIE daylight.

use super::grid::Grid;
use super::{Outside, Segment, Spectrum, SpectrumError};
use crate::Real;
use crate::tables::daylight::{S0, S1, S2};

/// Whether the coefficients M₁ and M₂ of a [`Daylight`] are rounded to three decimals.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Rounding {
    /// To three decimals, as in the calculation of the D illuminants that CIE 15 tabulates.
    #[default]
    ThreeDecimals,
    /// Not at all, so that the spectrum is a smooth function of the temperature.
    None,
}

/// Relative spectral power of a phase of daylight: the CIE D series, 100 at 560 nm.
///
/// `S(λ) = S₀(λ) + M₁ S₁(λ) + M₂ S₂(λ)` at 5 nm over 300–830 nm, linear in between, zero outside (CIE 15:2004, section 3):
/// from the correlated colour temperature T the chromaticity x = a polynomial in 1/T of two branches that meet at 7000 K
/// (which belongs to the lower one), y = −3.000 x² + 2.870 x − 0.275, and from them M₁ and M₂.
///
/// D50, D55, D65 and D75 are defined at nominal temperatures of an older scale: see [`nominal`](Daylight::nominal).
#[derive(Clone, Copy, Debug)]
pub struct Daylight<R: Real> {
    chromaticity: [R; 2],
    factors: [R; 2],
    grid: Grid<R>,
    basis: [&'static [R]; 3],
}

impl<R: Real> Daylight<R> {
    /// Daylight of a correlated colour temperature in K, in 4000 K to 25000 K.
    ///
    /// Chromaticity and factors are computed in `f64` and rounded to `R`.
    ///
    /// # Errors
    /// [`SpectrumError::ColourTemperature`] outside that range.
    pub fn new(temperature: R, rounding: Rounding) -> Result<Self, SpectrumError> {
        Self::from_f64(temperature.to_f64(), rounding)
    }

    /// Daylight of a nominal temperature, as in D65 = 6500 K: the temperature is multiplied by 1.4388 / 1.4380 for the
    /// change of the second radiation constant since the D illuminants were named (CIE 15:2004, section 3).
    ///
    /// # Errors
    /// [`SpectrumError::ColourTemperature`] when the product is outside 4000 K to 25000 K.
    pub fn nominal(temperature: R, rounding: Rounding) -> Result<Self, SpectrumError> {
        Self::from_f64(temperature.to_f64() * (1.4388 / 1.4380), rounding)
    }

    fn from_f64(temperature: f64, rounding: Rounding) -> Result<Self, SpectrumError> {
        if !(4000.0..=25000.0).contains(&temperature) {
            return Err(SpectrumError::ColourTemperature);
        }
        let (x, y) = chromaticity(temperature);
        let [m1, m2] = factors(x, y).map(|m| match rounding {
            Rounding::ThreeDecimals => libm::round(m * 1000.0) / 1000.0,
            Rounding::None => m,
        });
        let basis = [&S0, &S1, &S2].map(|table| R::samples(&table.samples));
        Ok(Self {
            chromaticity: [R::from_f64(x), R::from_f64(y)],
            factors: [R::from_f64(m1), R::from_f64(m2)],
            grid: Grid {
                first: R::from_f64(f64::from(S0.first)),
                step: R::from_f64(f64::from(S0.step)),
                count: basis[0].len(),
            },
            basis,
        })
    }

    /// The chromaticity x, y of CIE 1931 that the temperature stands for.
    #[must_use]
    pub const fn chromaticity(&self) -> [R; 2] {
        self.chromaticity
    }

    /// The factors M₁ and M₂.
    #[must_use]
    pub const fn factors(&self) -> [R; 2] {
        self.factors
    }

    /// The value at a whole wavelength in nm: as [`value`](Spectrum::value), without a search where it is a node.
    pub(crate) fn at_whole(&self, wavelength: usize) -> R {
        let (first, step) = (usize::from(S0.first), usize::from(S0.step));
        match wavelength.checked_sub(first) {
            Some(offset) if offset % step == 0 => self.node(offset / step),
            _ => self.value(R::from_usize(wavelength)),
        }
    }

    fn node(&self, index: usize) -> R {
        let [s0, s1, s2] = self.basis.map(|samples| samples.get(index).copied().unwrap_or(R::ZERO));
        let [m1, m2] = self.factors;
        s0 + m1 * s1 + m2 * s2
    }
}

/// Chromaticity of daylight of a temperature in K: CIE 15:2004, section 3.
fn chromaticity(temperature: f64) -> (f64, f64) {
    let [c0, c1, c2, c3] = if temperature <= 7000.0 {
        [0.244_063, 0.099_11, 2.967_8, -4.607_0]
    } else {
        [0.237_040, 0.247_48, 1.901_8, -2.006_4]
    };
    let inverse = 1000.0 / temperature;
    let x = c0 + inverse * (c1 + inverse * (c2 + inverse * c3));
    (x, -3.000 * x * x + 2.870 * x - 0.275)
}

/// M₁ and M₂ for a chromaticity: CIE 15:2004, section 3.
fn factors(x: f64, y: f64) -> [f64; 2] {
    let m = 0.0241 + 0.2562 * x - 0.7341 * y;
    [(-1.3515 - 1.7703 * x + 5.9114 * y) / m, (0.0300 - 31.4424 * x + 30.0717 * y) / m]
}

impl<R: Real> Spectrum<R> for Daylight<R> {
    fn segment(&self, wavelength: R) -> Segment<R> {
        let place = self.grid.locate(wavelength);
        place.segment(wavelength, self.grid.count, Outside::Zero, |index| self.node(index))
    }

    fn value(&self, wavelength: R) -> R {
        let last = self.grid.count.saturating_sub(1);
        if wavelength == self.grid.node(last) { self.node(last) } else { self.segment(wavelength).first }
    }
}
