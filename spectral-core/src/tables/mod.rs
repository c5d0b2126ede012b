//! Built-in tables, generated from the CSV files of `spectral-core/data`.
//!
//! Every table is a `const` that refers to its samples in both precisions; [`Real::samples`] picks one, and the other
//! one isn't linked. The lists (`ALL` in each module, [`lights`]) and the look-ups by name refer to whole families in
//! both precisions: they serve command lines rather than firmware.
//!
//! The samples are the decimals of the CSV files, rounded once to `f32` and once to `f64`. Each file says in its header
//! where it comes from; `data/SOURCES.md` sums that up.

mod lookup;

/// One list of decimals as [`Samples`] in both precisions.
macro_rules! samples {
    ($count:literal; $($value:literal),* $(,)?) => {{
        static SINGLE: [f32; $count] = [$($value),*];
        static DOUBLE: [f64; $count] = [$($value),*];
        $crate::tables::Samples { single: &SINGLE, double: &DOUBLE }
    }};
}

#[rustfmt::skip]
pub mod action;
#[rustfmt::skip]
pub mod alpha_opic;
#[rustfmt::skip]
pub mod babelcolor;
#[rustfmt::skip]
pub mod ces;
#[rustfmt::skip]
pub mod colorchecker;
#[rustfmt::skip]
pub mod cornell;
#[rustfmt::skip]
pub mod cornell_lamp;
#[rustfmt::skip]
pub mod daylight;
#[rustfmt::skip]
pub mod fluorescent;
#[rustfmt::skip]
pub mod glasses;
#[rustfmt::skip]
pub mod high_pressure;
#[rustfmt::skip]
pub mod illuminants;
#[rustfmt::skip]
pub mod led;
#[rustfmt::skip]
pub mod lines;
#[rustfmt::skip]
pub mod metals;
#[rustfmt::skip]
pub mod narrowband;
#[rustfmt::skip]
pub mod observers;
#[rustfmt::skip]
pub mod smits;
#[rustfmt::skip]
pub mod test_colours;

use crate::Real;
use crate::spectrum::{Lines, Outside, PiecewiseLinear, Spectrum, SpectrumError, Uniform};
pub use lookup::{find_glass, find_light, find_lines, find_metal, lights};

/// The samples of one column of a built-in table, in both precisions; only the one that is used gets linked.
///
/// [`Real::samples`] picks the precision.
#[derive(Clone, Copy, Debug)]
pub struct Samples {
    /// The samples in `f32`.
    pub single: &'static [f32],
    /// The samples in `f64`.
    pub double: &'static [f64],
}

/// A built-in spectrum sampled at equal steps of wavelength.
#[derive(Clone, Copy, Debug)]
pub struct UniformTable {
    /// The name the source gives to the column, such as `FL2` or `D65`.
    pub name: &'static str,
    /// Wavelength of the first sample in nm.
    pub first: u16,
    /// Distance between samples in nm.
    pub step: u16,
    /// The samples; at least two.
    pub samples: Samples,
}

impl UniformTable {
    /// The table as a piecewise linear spectrum, in the table's own units, with the given behaviour outside its range.
    #[must_use]
    pub fn spectrum<R: Real>(&self, outside: Outside) -> Uniform<'static, R> {
        let (first, step) = (R::from_f64(f64::from(self.first)), R::from_f64(f64::from(self.step)));
        Uniform::from_table(first, step, R::samples(&self.samples), outside)
    }
}

/// Where the samples of a table are.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TableGrid {
    pub(crate) first: u16,
    pub(crate) step: u16,
}

impl TableGrid {
    /// The value of a table's samples at a whole number of nm: that of its [spectrum](UniformTable::spectrum), without
    /// computing the place of samples.
    #[inline]
    pub(crate) fn at_whole<R: Real>(self, samples: &'static [R], wavelength: usize, outside: Outside) -> R {
        let (first, step) = (usize::from(self.first), usize::from(self.step.max(1)));
        let offset = wavelength.checked_sub(first).filter(|offset| offset % step == 0);
        let sample = offset.and_then(|offset| samples.get(offset / step));
        sample.copied().unwrap_or_else(|| {
            let spectrum = Uniform::from_table(R::from_usize(first), R::from_usize(step), samples, outside);
            spectrum.value(R::from_usize(wavelength))
        })
    }
}

/// The colour-matching functions of a standard observer, at equal steps of wavelength.
#[derive(Clone, Copy, Debug)]
pub struct ObserverTable {
    /// The observer's name.
    pub name: &'static str,
    /// Wavelength of the first row in nm.
    pub first: u16,
    /// Distance between rows in nm; 1 for the built-in observers.
    pub step: u16,
    /// The columns x̄, ȳ and z̄, of one length.
    pub columns: [Samples; 3],
}

impl ObserverTable {
    /// x̄, ȳ, z̄ (dimensionless) at the wavelength `first` + `index` · `step`; zeros beyond the last row.
    #[inline]
    #[must_use]
    pub fn cmf<R: Real>(&self, index: usize) -> [R; 3] {
        // Each column by name, not in a loop: that lets the other precision go also where code is built for size.
        let [x, y, z] = &self.columns;
        let value = |column: &[R]| column.get(index).copied().unwrap_or(R::ZERO);
        [value(R::samples(x)), value(R::samples(y)), value(R::samples(z))]
    }
}

/// A built-in function that is constant over bins of equal width.
#[derive(Clone, Copy, Debug)]
pub struct BinTable {
    /// The name the source gives to the column.
    pub name: &'static str,
    /// Lower edge of the first bin in nm.
    pub lower: u16,
    /// Width of a bin in nm.
    pub width: u16,
    /// One value a bin.
    pub samples: Samples,
}

/// Spectral lines and their relative powers.
#[derive(Clone, Copy, Debug)]
pub struct LineTable {
    /// Name of the element or lamp.
    pub name: &'static str,
    /// Wavelengths of the lines in air, in nm, increasing.
    pub wavelengths: Samples,
    /// Relative radiant powers of the lines.
    pub powers: Samples,
}

impl LineTable {
    /// The lines as triangles of the given full base width in nm, each with its power as integral.
    ///
    /// # Errors
    /// [`SpectrumError::Width`] when `width` isn't positive and finite, or too narrow for `R`.
    pub fn spectrum<R: Real>(&self, width: R) -> Result<Lines<'static, R>, SpectrumError> {
        Lines::new(R::samples(&self.wavelengths), R::samples(&self.powers), width)
    }
}

/// The complex refractive index n + i k of a metal at wavelengths of its own.
#[derive(Clone, Copy, Debug)]
pub struct MetalTable {
    /// Chemical symbol, followed by the author when there is more than one table of the metal.
    pub name: &'static str,
    /// Wavelengths in nm, increasing.
    pub wavelengths: Samples,
    /// Refractive index n at these wavelengths.
    pub n: Samples,
    /// Extinction coefficient k at these wavelengths.
    pub k: Samples,
}

impl MetalTable {
    /// The refractive index n as a function of wavelength, held outside the table's range.
    #[must_use]
    pub fn n<R: Real>(&self) -> PiecewiseLinear<'static, R> {
        PiecewiseLinear::from_table(R::samples(&self.wavelengths), R::samples(&self.n), Outside::Hold)
    }

    /// The extinction coefficient k as a function of wavelength, held outside the table's range.
    #[must_use]
    pub fn k<R: Real>(&self) -> PiecewiseLinear<'static, R> {
        PiecewiseLinear::from_table(R::samples(&self.wavelengths), R::samples(&self.k), Outside::Hold)
    }
}

/// The dispersion formula that a [`GlassTable`]'s coefficients belong to; see [`crate::dispersion`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Formula {
    /// n² − 1 = Σ Bᵢ λ² / (λ² − Cᵢ), λ in µm; coefficients B₁, C₁, B₂, C₂, …, four pairs, absent ones zero.
    Sellmeier,
    /// n = A + B / λ², λ in µm; coefficients A, B.
    Cauchy,
}

/// The coefficients of the dispersion formula of a transparent material.
#[derive(Clone, Copy, Debug)]
pub struct GlassTable {
    /// The material's name.
    pub name: &'static str,
    /// Which formula the coefficients are for.
    pub formula: Formula,
    /// The coefficients in the order of the formula.
    pub coefficients: Samples,
    /// Shortest and longest wavelength in nm for which the source states the coefficients.
    pub valid: [u16; 2],
}
