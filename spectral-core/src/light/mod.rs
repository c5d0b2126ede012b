//! Everything there is to say of a light, in one call: chromaticity, colour temperature, colour rendering, action
//! quantities.
//!
//! | what | one light | many lights on a grid |
//! |---|---|---|
//! | everything | [`measure`] | [`LightMeter`] (70 KB in `f64`) |
//! | colour temperature, R_a and CRI00 alone | [`measure_indices`] | [`IndexMeter`] (64 KB in `f64`) |
//! | R_f and R_g, with their 99 samples | [`measure_fidelity`] | [`FidelityMeter`] |
//!
//! The functions need no memory beyond their result and form every product as they go: for one light, or a lamp's own
//! microcontroller. The meters precompute products of samples, observer and action spectra, the Planckian locus, and
//! the colours under reference lights: for every pixel of a picture. Both of a row give the same bits; in `f32` meters are half
//! as large.
//!
//! The indices of the second row are not the bits of those of the first one: their reference lights are interpolated and
//! their samples are treated in lockstep. They are within 1e-10 of them in `f64`; see [`measure_indices`] for exceptions.
//!
//! **Grid.** A light is `N` samples on a [`SumGrid`], used as they are: sums over 380–780 nm at 5 nm for the tables of the
//! CIE ([`SumGrid::CIE_5NM`]), as CIE 13.3 prescribes; tables at another step are best brought to 1 nm.
//!
//! **Scale.** Everything but [`ActionMeasures::sy`] and `power` is independent of the light's scale. A light is divided by
//! a power of two near its largest sample first, so that scales from 1e-37 to 1e37 do as well in `f32` as in `f64`.
//!
//! **Constant.** Black bodies are those of c₂ = 1.4388 × 10⁻² m K ([`RadiationConstant::Its1990`]) unless another one is
//! asked for: that is what CIE 15 and CIE 13.3 are tabulated with.

mod fidelity;
mod index;
mod meter;

use core::fmt;

use crate::Real;
use crate::action::{ActionMeasures, ActionSpectra};
use crate::cct::{Cct, Locus, PlanckianLocus, correlated_colour_temperature, xyz_to_uv};
use crate::colour::xyz_to_xyy;
use crate::colour_rendering::{
    Cri00, R96_REFERENCES, R96_TCC_LAB, R96C, ReferenceLight, Rendering, cie_13_3, colorchecker_samples, cri00,
    munsell_samples, nearest_r96_reference, r96,
};
use crate::spectrum::RadiationConstant;
use crate::summation::{DirectColours, Illuminated, SumGrid, TestColours, tristimulus_sum};
use crate::tables::observers::CIE_1931_2;
pub use fidelity::{FidelityMeter, measure_fidelity};
pub use index::{GeneralIndices, IndexMeter, measure_indices};
pub use meter::LightMeter;

/// Why a light was refused; an index is that of the first sample at fault, from 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum LightError {
    /// A sample is infinite or NaN.
    Value {
        /// Which one.
        index: usize,
    },
    /// A sample is below zero.
    Negative {
        /// Which one.
        index: usize,
    },
    /// The light has no power where the eye sees: no colour.
    Dark,
}

impl fmt::Display for LightError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Value { index } => write!(f, "sample {index} of the light is not finite"),
            Self::Negative { index } => write!(f, "sample {index} of the light is negative"),
            Self::Dark => f.write_str("the light has no power in the visible range"),
        }
    }
}

impl core::error::Error for LightError {}

/// What is known of a light's colour before any index.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Chromaticity<R> {
    /// CIE 1931 XYZ, relative to Y = 1.
    pub xyz: [R; 3],
    /// CIE 1931 (x, y).
    pub xy: [R; 2],
    /// CIE 1960 (u, v).
    pub uv: [R; 2],
    /// Correlated colour temperature, Duv, and what they are worth.
    pub cct: Cct<R>,
    /// The reference light of the indices; `None` where none is defined: outside 500 K to 25 000 K.
    pub reference: Option<ReferenceLight<R>>,
}

/// The colour-rendering indices that share the reference light of a light's colour temperature.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ColourRendering<R> {
    /// R_a and R_1–R_14 of CIE 13.3-1995.
    pub ra: Rendering<R, 14>,
    /// CRI00 with the 14 Munsell samples.
    pub cri00_munsell: Rendering<R, 14>,
    /// CRI00 with the ColorChecker patches and skin tones.
    pub cri00_colorchecker: Rendering<R, 10>,
    /// R96(TCC/LAB)_a.
    pub r96_tcc_lab: Rendering<R, 10>,
}

/// R96_a(c) and which of [`R96_REFERENCES`] it took.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct R96Nearest<R> {
    /// The index of the reference light.
    pub reference: usize,
    /// The index with its stages.
    pub rendering: Rendering<R, 10>,
}

/// Everything there is to say of a light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightMeasures<R> {
    /// Radiant power Σ S Δλ over the grid, in the light's unit times nm.
    pub power: R,
    /// Chromaticity and colour temperature.
    pub chromaticity: Chromaticity<R>,
    /// The indices whose reference follows from the colour temperature; `None` where there is no reference.
    pub rendering: Option<ColourRendering<R>>,
    /// R96_a(c).
    pub r96_c: R96Nearest<R>,
    /// Luminous efficacy, a_cv, photosynthesis, α-opic quantities.
    pub action: ActionMeasures<R>,
}

/// Measures one light without precomputed tables; see the [module](self) for grid, scale and constant.
///
/// # Errors
/// [`LightError`] when a sample is negative or not finite, or the light has no power in the visible range.
///
/// ```
/// use spectral_core::light::measure;
/// use spectral_core::spectrum::{Outside, RadiationConstant};
/// use spectral_core::summation::SumGrid;
/// use spectral_core::tables::fluorescent::FL2;
///
/// let grid = SumGrid::CIE_5NM;
/// let lamp = grid.sample::<f64, _>(&FL2.spectrum(Outside::Zero));
/// let found = measure(grid, &lamp, RadiationConstant::Its1990)?;
/// let rendering = found.rendering.ok_or("no reference")?;
/// assert!((rendering.ra.general - 64.16).abs() <= 0.01);
/// assert!((found.chromaticity.cct.temperature - 4225.0).abs() <= 1.0);
/// # Ok::<(), Box<dyn core::error::Error>>(())
/// ```
pub fn measure<R: Real, const N: usize>(
    grid: SumGrid<N>,
    light: &[R; N],
    constant: RadiationConstant,
) -> Result<LightMeasures<R>, LightError> {
    let observer = grid.observer::<R>(&CIE_1931_2);
    let locus = PlanckianLocus::new(grid, &observer, constant);
    let (munsell, colorchecker) = (munsell_samples::<R>(), colorchecker_samples::<R>());
    let parts = Parts {
        grid,
        locus: &locus,
        nodes: &locus,
        munsell: &DirectColours::new(grid, &observer, &munsell),
        colorchecker: &DirectColours::new(grid, &observer, &colorchecker),
        actions: &ActionSpectra::new(grid),
    };
    parts.measure(light)
}

/// What a measurement is made with; the one implementation of it for both forms.
struct Parts<'a, R, L, M, C, const N: usize> {
    grid: SumGrid<N>,
    locus: &'a PlanckianLocus<R, N>,
    nodes: &'a L,
    munsell: &'a M,
    colorchecker: &'a C,
    actions: &'a ActionSpectra<R, N>,
}

impl<R: Real, L: Locus<R>, M: TestColours<R, N, 14>, C: TestColours<R, N, 10>, const N: usize>
    Parts<'_, R, L, M, C, N>
{
    fn measure(&self, light: &[R; N]) -> Result<LightMeasures<R>, LightError> {
        let (light, scale) = normalise(light)?;
        let sums = tristimulus_sum(self.locus.observer(), &light);
        let action = self.actions.measure(&light, sums, scale).ok_or(LightError::Dark)?;
        let chromaticity = chromaticity(sums, self.nodes)?;
        let rendering = match chromaticity.reference {
            Some(reference) => Some(self.rendering(&light, reference)?),
            None => None,
        };
        let mut power = R::ZERO;
        for &sample in &light {
            power += sample;
        }
        let power = power * R::from_usize(usize::from(self.grid.step())) * scale;
        Ok(LightMeasures { power, chromaticity, rendering, r96_c: self.r96_nearest(&light)?, action })
    }

    fn rendering(&self, light: &[R; N], reference: ReferenceLight<R>) -> Result<ColourRendering<R>, LightError> {
        let reference = reference.spectrum(self.grid, self.locus).ok_or(LightError::Dark)?;
        let [test, under_reference] = pair(self.munsell, light, &reference)?;
        let [patches, patches_under_reference] = pair(self.colorchecker, light, &reference)?;
        Ok(ColourRendering {
            ra: cie_13_3(&test, &under_reference),
            cri00_munsell: cri00(&test, &under_reference, &Cri00::MUNSELL),
            cri00_colorchecker: cri00(&patches, &patches_under_reference, &Cri00::COLORCHECKER),
            r96_tcc_lab: r96(&patches, &patches_under_reference, R96_TCC_LAB),
        })
    }

    fn r96_nearest(&self, light: &[R; N]) -> Result<R96Nearest<R>, LightError> {
        let mut spectra = [[R::ZERO; N]; 6];
        for (spectrum, reference) in spectra.iter_mut().zip(R96_REFERENCES) {
            let reference = ReferenceLight { kind: reference.kind, temperature: R::from_f64(reference.temperature) };
            *spectrum = reference.spectrum(self.grid, self.locus).ok_or(LightError::Dark)?;
        }
        let white = |light: &[R; N]| {
            let sums = tristimulus_sum(self.locus.observer(), light);
            sums.map(|sum| sum / sums[1])
        };
        let reference = nearest_r96_reference(white(light), &spectra.each_ref().map(white));
        let spectrum = spectra.get(reference).ok_or(LightError::Dark)?;
        let [test, under_reference] = pair(self.colorchecker, light, spectrum)?;
        Ok(R96Nearest { reference, rendering: r96(&test, &under_reference, R96C) })
    }
}

/// Colour, colour temperature and reference light from tristimulus sums.
///
/// Not inlined, so that its stack is free again before that of colour rendering is needed.
#[inline(never)]
fn chromaticity<R: Real>(sums: [R; 3], nodes: &impl Locus<R>) -> Result<Chromaticity<R>, LightError> {
    let xyz = sums.map(|sum| sum / sums[1]);
    let uv = xyz_to_uv(xyz);
    let [x, y, _] = xyz_to_xyy(xyz).ok_or(LightError::Dark)?;
    let cct = correlated_colour_temperature(uv, nodes).ok_or(LightError::Dark)?;
    let reference = if cct.is_in_range() { ReferenceLight::for_temperature(cct.temperature) } else { None };
    Ok(Chromaticity { xyz, xy: [x, y], uv, cct, reference })
}

/// The samples under the light and under its reference.
fn pair<R: Real, T: TestColours<R, N, M>, const N: usize, const M: usize>(
    samples: &T,
    light: &[R; N],
    reference: &[R; N],
) -> Result<[Illuminated<R, M>; 2], LightError> {
    match (samples.illuminate(light), samples.illuminate(reference)) {
        (Some(test), Some(reference)) => Ok([test, reference]),
        _ => Err(LightError::Dark),
    }
}

/// How many samples are looked at at once.
const LANES: usize = 8;

/// The light divided by the power of two below its largest sample, exactly, and that power.
fn normalise<R: Real, const N: usize>(light: &[R; N]) -> Result<([R; N], R), LightError> {
    let unit = unit(light)?;
    let scale = R::ONE / unit;
    Ok((light.map(|sample| sample * scale), unit))
}

/// The power of two below the largest sample of a light that is fit to be measured; it and its reciprocal are normal numbers.
fn unit<R: Real, const N: usize>(light: &[R; N]) -> Result<R, LightError> {
    // The largest sample of every eighth, and one that is negative or NaN: without branches, so that it costs little.
    let (mut largest, mut faulty) = ([R::ZERO; LANES], [R::ZERO; LANES]);
    let (chunks, rest) = light.as_chunks::<LANES>();
    let mut last = [R::ZERO; LANES];
    for (last, &sample) in last.iter_mut().zip(rest) {
        *last = sample;
    }
    for chunk in chunks.iter().chain([&last]) {
        for lane in 0..LANES {
            let sample = chunk[lane];
            largest[lane] = sample.max(largest[lane]);
            faulty[lane] = if sample >= R::ZERO { faulty[lane] } else { sample };
        }
    }
    let fine = largest.iter().all(|&sample| sample <= R::MAX) && faulty == [R::ZERO; LANES];
    if !fine {
        return Err(first_fault(light));
    }
    let largest = largest.into_iter().fold(R::ZERO, R::max);
    if largest == R::ZERO {
        return Err(LightError::Dark);
    }
    Ok(largest.binade().max(R::MIN_POSITIVE).min(R::ONE / R::MIN_POSITIVE))
}

/// What is wrong with a light that has a sample below zero or not finite.
#[cold]
fn first_fault<R: Real, const N: usize>(light: &[R; N]) -> LightError {
    for (index, &sample) in light.iter().enumerate() {
        if !sample.is_finite() {
            return LightError::Value { index };
        }
        if sample < R::ZERO {
            return LightError::Negative { index };
        }
    }
    LightError::Dark
}
