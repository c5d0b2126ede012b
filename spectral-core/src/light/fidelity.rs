//! R_f and R_g of a light, single and in the batch form; apart from the other measures for the size of their tables.

use super::{LightError, normalise, pair};
use crate::Real;
use crate::cct::{Locus, LocusTable, PlanckianLocus, correlated_colour_temperature, xyz_to_uv};
use crate::colour_rendering::{Fidelity, colour_evaluation_samples, fidelity, fidelity_reference};
use crate::spectrum::RadiationConstant;
use crate::summation::{DirectColours, PreparedColours, SumGrid, TestColours, tristimulus_sum};
use crate::tables::observers::{CIE_1931_2, CIE_1964_10};

/// R_f of CIE 224:2017 and R_g of TM-30 of one light, with the 99 samples; without precomputed tables.
///
/// The samples are tabulated at 5 nm and interpolated linearly on other grids. `None` where there is no reference light:
/// colour temperatures outside 500 K to 25 000 K; and where CIECAM02 has no colour for a sample, because its cone responses
/// sum to less than zero, as under some lights of 500 to 600 K.
///
/// # Errors
/// [`LightError`] when a sample is negative or not finite, or the light has no power in the visible range.
pub fn measure_fidelity<R: Real, const N: usize>(
    grid: SumGrid<N>,
    light: &[R; N],
    constant: RadiationConstant,
) -> Result<Option<Fidelity<R, 99>>, LightError> {
    let (observer, wide) = (grid.observer::<R>(&CIE_1931_2), grid.observer::<R>(&CIE_1964_10));
    let samples = colour_evaluation_samples::<R>();
    let locus = PlanckianLocus::new(grid, &observer, constant);
    let samples = DirectColours::new(grid, &wide, &samples);
    evaluate(light, grid, &locus, &locus, &wide, &samples)
}

/// Measures R_f and R_g of many lights on one grid, with precomputed products: 210 KB in `f64`, half of it in `f32`.
///
/// Results are those of [`measure_fidelity`], to the bit.
#[derive(Clone, Copy, Debug)]
pub struct FidelityMeter<R, const N: usize> {
    grid: SumGrid<N>,
    locus: PlanckianLocus<R, N>,
    wide: [[R; 3]; N],
    nodes: LocusTable<R>,
    samples: PreparedColours<R, N, 99>,
}

impl<R: Real, const N: usize> FidelityMeter<R, N> {
    /// A meter for lights on a grid.
    #[must_use]
    pub fn new(grid: SumGrid<N>, constant: RadiationConstant) -> Self {
        let (observer, wide) = (grid.observer::<R>(&CIE_1931_2), grid.observer::<R>(&CIE_1964_10));
        let locus = PlanckianLocus::new(grid, &observer, constant);
        Self {
            grid,
            locus,
            wide,
            nodes: LocusTable::new(&locus),
            samples: PreparedColours::new(grid, &wide, &colour_evaluation_samples()),
        }
    }

    /// R_f and R_g of a light.
    ///
    /// # Errors
    /// As [`measure_fidelity`].
    pub fn measure(&self, light: &[R; N]) -> Result<Option<Fidelity<R, 99>>, LightError> {
        evaluate(light, self.grid, &self.locus, &self.nodes, &self.wide, &self.samples)
    }
}

fn evaluate<R: Real, const N: usize>(
    light: &[R; N],
    grid: SumGrid<N>,
    locus: &PlanckianLocus<R, N>,
    nodes: &impl Locus<R>,
    wide: &[[R; 3]; N],
    samples: &impl TestColours<R, N, 99>,
) -> Result<Option<Fidelity<R, 99>>, LightError> {
    let (light, _) = normalise(light)?;
    let uv = xyz_to_uv(tristimulus_sum(locus.observer(), &light));
    let cct = correlated_colour_temperature(uv, nodes).ok_or(LightError::Dark)?;
    if !cct.is_in_range() {
        return Ok(None);
    }
    let Some(reference) = fidelity_reference(cct.temperature, grid, locus, wide) else { return Ok(None) };
    let [test, reference] = pair(samples, &light, &reference)?;
    Ok(Some(fidelity(&test, &reference)).filter(|found| found.rf.is_finite() && found.rg.is_finite()))
}
