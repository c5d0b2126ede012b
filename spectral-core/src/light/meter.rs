//! The batch form: everything that does not depend on the light, computed once.

use super::{Chromaticity, LightError, LightMeasures, Parts, chromaticity, normalise, pair};
use crate::Real;
use crate::action::ActionSpectra;
use crate::cct::{LocusTable, PlanckianLocus};
use crate::colour_rendering::{Cri00, Rendering, cie_13_3, colorchecker_samples, cri00, munsell_samples};
use crate::spectrum::RadiationConstant;
use crate::summation::{PreparedColours, SumGrid, tristimulus_sum};
use crate::tables::observers::CIE_1931_2;

/// Measures many lights on one grid: a light costs some dot products.
///
/// Results are those of [`measure`](super::measure), to the bit. The meter is a plain value without references: it can be
/// kept in a `static`, in a box or on the stack.
#[derive(Clone, Copy, Debug)]
pub struct LightMeter<R, const N: usize> {
    grid: SumGrid<N>,
    locus: PlanckianLocus<R, N>,
    nodes: LocusTable<R>,
    munsell: PreparedColours<R, N, 14>,
    colorchecker: PreparedColours<R, N, 10>,
    actions: ActionSpectra<R, N>,
}

type MeterParts<'a, R, const N: usize> =
    Parts<'a, R, LocusTable<R>, PreparedColours<R, N, 14>, PreparedColours<R, N, 10>, N>;

impl<R: Real, const N: usize> LightMeter<R, N> {
    /// A meter for lights on a grid.
    #[must_use]
    pub fn new(grid: SumGrid<N>, constant: RadiationConstant) -> Self {
        let observer = grid.observer::<R>(&CIE_1931_2);
        let locus = PlanckianLocus::new(grid, &observer, constant);
        Self {
            grid,
            locus,
            nodes: LocusTable::new(&locus),
            munsell: PreparedColours::new(grid, &observer, &munsell_samples()),
            colorchecker: PreparedColours::new(grid, &observer, &colorchecker_samples()),
            actions: ActionSpectra::new(grid),
        }
    }

    fn parts(&self) -> MeterParts<'_, R, N> {
        Parts {
            grid: self.grid,
            locus: &self.locus,
            nodes: &self.nodes,
            munsell: &self.munsell,
            colorchecker: &self.colorchecker,
            actions: &self.actions,
        }
    }

    /// Measures a light.
    ///
    /// # Errors
    /// [`LightError`] when a sample is negative or not finite, or the light has no power in the visible range.
    pub fn measure(&self, light: &[R; N]) -> Result<LightMeasures<R>, LightError> {
        self.parts().measure(light)
    }

    /// Chromaticity and colour temperature alone.
    ///
    /// # Errors
    /// As [`measure`](Self::measure).
    pub fn chromaticity(&self, light: &[R; N]) -> Result<Chromaticity<R>, LightError> {
        let (light, _) = normalise(light)?;
        chromaticity(tristimulus_sum(self.locus.observer(), &light), &self.nodes)
    }

    /// Chromaticity, and R_a and CRI00 with the 14 Munsell samples; no indices where there is no reference light.
    ///
    /// # Errors
    /// As [`measure`](Self::measure).
    #[allow(clippy::type_complexity, reason = "a pair of indices that may be absent needs no name")]
    pub fn munsell(&self, light: &[R; N]) -> Result<(Chromaticity<R>, Option<[Rendering<R, 14>; 2]>), LightError> {
        let parts = self.parts();
        let (light, _) = normalise(light)?;
        let chromaticity = chromaticity(tristimulus_sum(self.locus.observer(), &light), &self.nodes)?;
        let Some(reference) = chromaticity.reference else { return Ok((chromaticity, None)) };
        let reference = reference.spectrum(self.grid, parts.locus).ok_or(LightError::Dark)?;
        let [test, reference] = pair(&self.munsell, &light, &reference)?;
        let indices = [cie_13_3(&test, &reference), cri00(&test, &reference, &Cri00::MUNSELL)];
        Ok((chromaticity, Some(indices)))
    }
}
