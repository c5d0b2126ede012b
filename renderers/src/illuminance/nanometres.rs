//! Light between surfaces wavelength by wavelength, for the colour of what arrives.

use glam::DVec3;
use spectral_core::spectrum::Spectrum as _;
use spectral_core::summation::{SumGrid, tristimulus_sum};
use spectral_core::tables::observers::CIE_1931_2;

use super::{IndirectIrradiance, IndirectLight};
use crate::radiosity::{Representation, Solution, Tristimulus};
use crate::spectral::{Factor, Palette, Tabulated, Y_INTEGRAL};

const GRID: SumGrid<401> = SumGrid::CIE_1NM;

/// Spectra by their values at whole nanometres from 380 to 780 nm.
///
/// Reflection multiplies wavelength by wavelength, so that these values are exact however often light was reflected: what means
/// over bins lose, the ups and downs of two spectra within a bin, is not lost. Indices of colour rendering, which are sums over every fifth
/// of these wavelengths, are those of the true light. Integrals are not as good for spectra with lines narrower than 1 nm, which fall
/// between the values: lux is better had from [`UniformBins`](crate::spectral::UniformBins).
#[derive(Clone, Debug)]
pub struct Nanometres {
    leaves: Vec<Vec<f64>>,
}

impl Nanometres {
    /// How many wavelengths there are.
    pub const COUNT: usize = 401;

    /// Takes the values of a palette's spectra.
    ///
    /// # Errors
    /// A text that says what is wrong with which leaf.
    pub fn new(palette: &Palette) -> Result<Self, String> {
        let values = |leaf: &Tabulated| -> Result<Vec<f64>, String> {
            let spectrum = leaf.spectrum()?;
            Ok(wavelengths().map(|wavelength| spectrum.value(wavelength)).collect())
        };
        Ok(Self { leaves: palette.leaves().iter().map(|(leaf, _)| values(leaf)).collect::<Result<_, _>>()? })
    }

    fn leaf(&self, leaf: u32) -> Option<&[f64]> {
        self.leaves.get(leaf as usize).map(Vec::as_slice)
    }
}

/// 380, 381, … 780 nm.
fn wavelengths() -> impl Iterator<Item = f64> {
    (0..Nanometres::COUNT).map(|index| GRID.wavelength(index))
}

impl Representation for Nanometres {
    fn width(&self) -> usize {
        Self::COUNT
    }

    fn light(&self, factor: Factor, row: &mut [f64]) {
        match factor.leaf.map(|leaf| self.leaf(leaf)) {
            None => row.fill(factor.scale),
            Some(Some(values)) => row.iter_mut().zip(values).for_each(|(r, v)| *r = factor.scale * v),
            Some(None) => row.fill(0.0),
        }
    }

    fn reflect(&self, factor: Factor, row: &mut [f64]) {
        match factor.leaf.and_then(|leaf| self.leaf(leaf)) {
            None => row.iter_mut().for_each(|r| *r *= factor.scale),
            Some(values) => row.iter_mut().zip(values).for_each(|(r, v)| *r *= factor.scale * v),
        }
    }

    /// By sums over the wavelengths.
    fn colour(&self, leaves: &[u32], row: &[f64]) -> Tristimulus {
        let mut seen = [0.0; Self::COUNT];
        for (index, (to, value)) in seen.iter_mut().zip(row).enumerate() {
            let factors = leaves.iter().filter_map(|leaf| self.leaf(*leaf)).filter_map(|values| values.get(index));
            *to = factors.fold(*value, |product, factor| product * factor);
        }
        let sums = tristimulus_sum(&GRID.observer(&CIE_1931_2), &seen);
        Tristimulus { value: sums.map(|sum| sum / Y_INTEGRAL), radius: [0.0; 3] }
    }
}

/// Indirect light whose lux is that of one source and whose spectrum is that of a solution by [`Nanometres`].
pub struct SpectralIndirect<'s> {
    lux: &'s dyn IndirectLight,
    solution: &'s Solution<'s>,
}

impl core::fmt::Debug for SpectralIndirect<'_> {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_struct("SpectralIndirect").field("lux", &self.lux.name()).finish_non_exhaustive()
    }
}

impl<'s> SpectralIndirect<'s> {
    /// The light of both; `None` if the solution is not one by [`Nanometres`].
    #[must_use]
    pub fn new(lux: &'s dyn IndirectLight, solution: &'s Solution<'s>) -> Option<Self> {
        (solution.width() == Nanometres::COUNT).then_some(Self { lux, solution })
    }
}

impl IndirectLight for SpectralIndirect<'_> {
    fn name(&self) -> &str {
        self.lux.name()
    }

    /// The spectrum is unknown for a position or normal that is none.
    fn irradiance(&self, position: DVec3, normal: DVec3) -> IndirectIrradiance {
        let receiver = disk_sampling::Receiver::new(position.to_array(), normal.to_array());
        let spectrum = receiver.ok().map(|receiver| Tabulated {
            wavelengths: wavelengths().collect(),
            values: self.solution.indirect(&receiver),
        });
        IndirectIrradiance { spectrum, ..self.lux.irradiance(position, normal) }
    }
}
