//! Radiosity as the indirect part of illuminances.

use disk_sampling::Receiver;
use glam::DVec3;
use spectral_core::action::MAXIMUM_LUMINOUS_EFFICACY;

use super::Solution;
use crate::illuminance::{IndirectIrradiance, IndirectLight};
use crate::spectral::{Tabulated, UniformBins};

/// A solution for the bins of a spectrum, as what [`Meter`](crate::illuminance::Meter)s ask for indirect light.
#[derive(Clone, Copy, Debug)]
pub struct IndirectRadiosity<'s> {
    solution: &'s Solution<'s>,
    bins: &'s UniformBins,
}

impl<'s> IndirectRadiosity<'s> {
    /// The light of a solution for these bins; `None` if it is one for another number of components.
    #[must_use]
    pub fn new(solution: &'s Solution<'s>, bins: &'s UniformBins) -> Option<Self> {
        (solution.width() == bins.len()).then_some(Self { solution, bins })
    }
}

impl IndirectLight for IndirectRadiosity<'_> {
    fn name(&self) -> &str {
        "radiosity"
    }

    /// Illuminance by the means of light and ȳ over each bin; its error is that which the refinement aimed at, and the iteration's, and, among more
    /// than 512 faces, that of counting far ones by rays. NaN in all of it for a position or normal that is none.
    fn irradiance(&self, position: DVec3, normal: DVec3) -> IndirectIrradiance {
        let Ok(receiver) = Receiver::new(position.to_array(), normal.to_array()) else {
            return IndirectIrradiance { lux: f64::NAN, error: f64::NAN, spectrum: None };
        };
        let values = self.solution.indirect(&receiver);
        let [_, luminous, _] = self.bins.weights();
        let lux = MAXIMUM_LUMINOUS_EFFICACY * values.iter().zip(luminous).map(|(v, w)| v * w).sum::<f64>();
        let wavelengths: Vec<f64> = (0..self.bins.len()).map(|bin| self.bins.centre(bin)).collect();
        // A table has two nodes or more.
        let spectrum = (values.len() > 1).then_some(Tabulated { wavelengths, values });
        let error = lux * self.solution.relative_error();
        IndirectIrradiance { lux, error, spectrum }
    }
}
