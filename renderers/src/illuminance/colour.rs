//! The colour of the light at a point and how it renders colours.

use spectral_core::light::{GeneralIndices, IndexMeter};
use spectral_core::spectrum::RadiationConstant;
use spectral_core::summation::SumGrid;

use super::{Meter, Reading};

const GRID: SumGrid<81> = SumGrid::CIE_5NM;

/// The colour of light at a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightColour {
    /// Correlated colour temperature in K.
    pub cct: f64,
    /// The distance of the chromaticity from the Planckian locus in CIE 1960 (u, v), positive above it.
    pub duv: f64,
    /// R_a of CIE 13.3-1995; `None` where there is no reference light.
    pub ra: Option<f64>,
    /// CRI00 with the Munsell samples; `None` where there is no reference light.
    pub cri00_munsell: Option<f64>,
}

/// Colour temperatures and colour-rendering indices of readings, by sums over 380–780 nm at 5 nm, the grid of the CIE's method. 64 KB.
#[derive(Clone, Debug)]
pub struct ColourMeter(Box<IndexMeter<f64, 81>>);

impl Default for ColourMeter {
    /// With the constants of the lights of `spectral light`: those of the ITS-90.
    fn default() -> Self {
        Self(Box::new(IndexMeter::new(GRID, RadiationConstant::Its1990)))
    }
}

impl ColourMeter {
    /// The colour of the light of a reading of a meter; `None` in the dark, and where the chromaticity is beyond the ends of the locus.
    ///
    /// How true it is depends on the spectrum of the indirect part: exact for light wavelength by wavelength
    /// ([`SpectralIndirect`](super::SpectralIndirect)); means over bins blunt the lines of lamps.
    #[must_use]
    pub fn measure(&self, meter: &Meter<'_>, reading: &Reading) -> Option<LightColour> {
        let light = core::array::from_fn(|index| meter.irradiance(reading, GRID.wavelength(index)));
        let GeneralIndices { chromaticity, ra, cri00 } = self.0.measure(&light).ok()?;
        let cct = chromaticity.cct;
        cct.is_in_range().then_some(LightColour { cct: cct.temperature, duv: cct.duv, ra, cri00_munsell: cri00 })
    }
}
