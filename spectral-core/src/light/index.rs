//! Colour temperature, R_a and CRI00 alone, as fast as they can be had.
//!
//! What depends on the temperature of the reference light alone is a piecewise polynomial in 1 / T; sums, cube roots and
//! colour differences are made of the eight samples in lockstep.

use super::{Chromaticity, LightError, chromaticity, unit};
use crate::Real;
use crate::cct::{LeanLocus, Locus, LocusTable, PlanckianLocus};
use crate::colour_rendering::{
    EightSamples, EightSums, PIECE_COUNT, Products, ReferenceColours, ReferenceLight, ReferencePiece, general_indices,
    interpolated, piece_of,
};
use crate::spectrum::RadiationConstant;
use crate::summation::SumGrid;
use crate::tables::observers::CIE_1931_2;

/// The general indices of a light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GeneralIndices<R> {
    /// Chromaticity and colour temperature.
    pub chromaticity: Chromaticity<R>,
    /// R_a of CIE 13.3-1995; `None` where there is no reference light.
    pub ra: Option<R>,
    /// CRI00 with the Munsell samples; `None` where there is no reference light.
    pub cri00: Option<R>,
}

/// Colour temperature, R_a and CRI00 of one light without precomputed tables: what an [`IndexMeter`] gives, to the bit.
///
/// The chromaticity is that of [`measure`](super::measure), to the bit. R_a and CRI00 are within 1e-10 of its in `f64` from
/// 750 K on (measured: 3e-11). The exception is CRI00 of a single line, under which all samples are grey to
/// rounding: ΔH′ grows with the square root of a chroma, so that it is off by some 1e-6. In `f32` those of the CIE's lights are within 5e-4 of those in `f64`. It computes
/// reference lights of 13 temperatures, and keeps the colours of the samples under them meanwhile: it needs less than 4 KB of
/// stack in `f32` on a Cortex-M, 8 KB in `f64`.
///
/// # Errors
/// [`LightError`] when a sample is negative or not finite, or the light has no power in the visible range.
pub fn measure_indices<R: Real, const N: usize>(
    grid: SumGrid<N>,
    light: &[R; N],
    constant: RadiationConstant,
) -> Result<GeneralIndices<R>, LightError> {
    let scale = R::ONE / unit(light)?;
    let (locus, samples) = (LeanLocus::new(grid, constant), EightSamples::new(grid));
    let mut sums = EightSums::zero();
    samples.sum(light.iter().map(|&sample| sample * scale), &mut sums);
    general(&sums, &locus, |reference| {
        let sum = |reference: ReferenceLight<R>, sums: &mut EightSums<R>| {
            samples.sum((0..N).map(reference.powers(grid, &locus)?), sums);
            has_luminance(sums)
        };
        if let Some(piece) = piece_of(reference) {
            return interpolated(piece, reference.temperature, sum);
        }
        let mut sums = EightSums::zero();
        sum(reference, &mut sums)?;
        Some(ReferenceColours::new(&sums))
    })
}

/// Measures colour temperature, R_a and CRI00 of many lights on one grid, and nothing else: for pictures.
///
/// Results are those of [`measure_indices`], to the bit; see there for their accuracy. 64 KB in `f64` for 81 wavelengths, half
/// of it in `f32`. A reference light below 1000 K is not interpolated and takes about twice the time.
///
/// ```
/// use spectral_core::light::IndexMeter;
/// use spectral_core::spectrum::{Outside, RadiationConstant};
/// use spectral_core::summation::SumGrid;
/// use spectral_core::tables::fluorescent::FL2;
///
/// let grid = SumGrid::CIE_5NM;
/// let meter = IndexMeter::<f64, 81>::new(grid, RadiationConstant::Its1990);
/// let found = meter.measure(&grid.sample(&FL2.spectrum(Outside::Zero)))?;
/// assert!((found.ra.ok_or("no reference")? - 64.16).abs() <= 0.01);
/// assert!((found.cri00.ok_or("no reference")? - 65.68).abs() <= 0.01);
/// # Ok::<(), Box<dyn core::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct IndexMeter<R, const N: usize> {
    grid: SumGrid<N>,
    locus: PlanckianLocus<R, N>,
    nodes: LocusTable<R>,
    products: [Products<R>; N],
    pieces: [Option<ReferencePiece<R>>; PIECE_COUNT],
}

impl<R: Real, const N: usize> IndexMeter<R, N> {
    /// A meter for lights on a grid.
    #[must_use]
    pub fn new(grid: SumGrid<N>, constant: RadiationConstant) -> Self {
        let observer = grid.observer::<R>(&CIE_1931_2);
        let locus = PlanckianLocus::new(grid, &observer, constant);
        let samples = EightSamples::new(grid);
        let products: [_; N] = core::array::from_fn(|index| samples.products(index));
        let sum = |reference, sums: &mut EightSums<R>| {
            *sums = sums_under(reference, grid, &locus, products.iter().copied())?;
            Some(())
        };
        let pieces = core::array::from_fn(|piece| ReferencePiece::new(piece, sum));
        Self { grid, locus, nodes: LocusTable::new(&locus), products, pieces }
    }

    /// The general indices of a light.
    ///
    /// # Errors
    /// [`LightError`] when a sample is negative or not finite, or the light has no power in the visible range.
    pub fn measure(&self, light: &[R; N]) -> Result<GeneralIndices<R>, LightError> {
        let rows = || self.products.iter().copied();
        let scale = R::ONE / unit(light)?;
        let sums = EightSums::new(light.iter().map(|&sample| sample * scale), rows());
        general(&sums, &self.nodes, |reference| match piece_of(reference) {
            Some(piece) => self.pieces.get(piece)?.as_ref()?.at(piece, reference.temperature),
            None => sums_under(reference, self.grid, &self.locus, rows()).as_ref().map(ReferenceColours::new),
        })
    }
}

/// The one implementation of both forms.
#[inline]
fn general<R: Real>(
    sums: &EightSums<R>,
    nodes: &impl Locus<R>,
    colours: impl FnOnce(ReferenceLight<R>) -> Option<ReferenceColours<R>>,
) -> Result<GeneralIndices<R>, LightError> {
    let chromaticity = chromaticity(sums.white, nodes)?;
    let Some(reference) = chromaticity.reference else {
        return Ok(GeneralIndices { chromaticity, ra: None, cri00: None });
    };
    let [ra, cri00] = general_indices(sums, &colours(reference).ok_or(LightError::Dark)?);
    Ok(GeneralIndices { chromaticity, ra: Some(ra), cri00: Some(cri00) })
}

/// The samples under a reference light, summed.
fn sums_under<R: Real, const N: usize>(
    reference: ReferenceLight<R>,
    grid: SumGrid<N>,
    locus: &PlanckianLocus<R, N>,
    rows: impl Iterator<Item = Products<R>>,
) -> Option<EightSums<R>> {
    let spectrum = reference.spectrum(grid, locus)?;
    let sums = EightSums::new(spectrum.iter().copied(), rows);
    has_luminance(&sums).map(|()| sums)
}

/// `None` for a light without luminance.
fn has_luminance<R: Real>(sums: &EightSums<R>) -> Option<()> {
    (sums.white[1] > R::ZERO).then_some(())
}
