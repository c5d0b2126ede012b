//! The grid on which lights are summed: tristimulus values as sums over equidistant wavelengths, as CIE tables
//! prescribe.
//!
//! Indices of lights are defined by sums, not by integrals: CIE 13.3 sums at 5 nm, and a lamp with lines changes its
//! R_a by up to 0.12 when the same table is interpolated to 1 nm first. So the grid is explicit: a light is `N` samples
//! on a [`SumGrid`], taken as they are, and everything else (colour-matching functions, reflectances, reference lights)
//! is evaluated at the same wavelengths. Sums have no trapezoidal end corrections, as in CIE 15.

use core::fmt;

use crate::Real;
use crate::integrate::Sum;
use crate::spectrum::Spectrum;
use crate::tables::ObserverTable;

/// `N` equidistant whole nanometres at which lights are sampled and products are summed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SumGrid<const N: usize> {
    first: u16,
    step: u16,
}

/// Why a [`SumGrid`] was refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum SumGridError {
    /// The step is 0 or above 20 nm, too coarse for a colour.
    Step,
    /// The grid does not reach from 400 nm or below to 700 nm or above, or it goes beyond 4000 nm.
    Range,
}

impl fmt::Display for SumGridError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Step => "the step of the grid is not in 1 nm to 20 nm",
            Self::Range => "the grid does not span 400 nm to 700 nm, or goes beyond 4000 nm",
        })
    }
}

impl core::error::Error for SumGridError {}

impl SumGrid<81> {
    /// 380–780 nm at 5 nm: the grid of CIE 13.3-1995 and of the tables of CIE 15.
    pub const CIE_5NM: Self = Self { first: 380, step: 5 };
}

impl SumGrid<401> {
    /// 380–780 nm at 1 nm.
    pub const CIE_1NM: Self = Self { first: 380, step: 1 };
}

impl<const N: usize> SumGrid<N> {
    /// A grid of `N` wavelengths from `first` nm at `step` nm.
    ///
    /// # Errors
    /// [`SumGridError`] when the step is not in 1 nm to 20 nm, or the grid does not span 400–700 nm.
    pub fn new(first: u16, step: u16) -> Result<Self, SumGridError> {
        if !(1..=20).contains(&step) {
            return Err(SumGridError::Step);
        }
        let last = usize::from(first) + usize::from(step) * N.saturating_sub(1);
        if first == 0 || first > 400 || !(700..=4000).contains(&last) {
            return Err(SumGridError::Range);
        }
        Ok(Self { first, step })
    }

    /// The first wavelength in nm.
    #[must_use]
    pub const fn first(&self) -> u16 {
        self.first
    }

    /// The distance between wavelengths in nm.
    #[must_use]
    pub const fn step(&self) -> u16 {
        self.step
    }

    /// A wavelength in nm, exactly.
    #[inline]
    #[must_use]
    pub fn wavelength<R: Real>(&self, index: usize) -> R {
        R::from_usize(usize::from(self.first) + usize::from(self.step) * index)
    }

    /// A function of wavelength at the grid's wavelengths.
    ///
    /// A table on the same grid comes back as it is; others are interpolated linearly, and nothing is averaged: what a
    /// spectrum does between the grid's wavelengths is lost.
    #[must_use]
    pub fn sample<R: Real, S: Spectrum<R> + ?Sized>(&self, spectrum: &S) -> [R; N] {
        core::array::from_fn(|index| spectrum.value(self.wavelength(index)))
    }

    /// x̄, ȳ, z̄ at the grid's wavelengths; zeros where the table, at 1 nm, has none.
    #[must_use]
    pub fn observer<R: Real>(&self, table: &ObserverTable) -> [[R; 3]; N] {
        core::array::from_fn(|index| self.cmf(table, index))
    }

    /// One wavelength of [`observer`](Self::observer).
    #[inline]
    pub(crate) fn cmf<R: Real>(&self, table: &ObserverTable, index: usize) -> [R; 3] {
        let offset = self.nanometres(index).checked_sub(usize::from(table.first));
        let row = offset.filter(|o| o % usize::from(table.step.max(1)) == 0);
        row.map_or([R::ZERO; 3], |row| table.cmf(row / usize::from(table.step.max(1))))
    }

    /// A wavelength as a whole number of nm.
    #[inline]
    pub(crate) const fn nanometres(&self, index: usize) -> usize {
        self.first as usize + self.step as usize * index
    }
}

/// Tristimulus values of a light and of `M` samples under it, relative to Y = 1 of the light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Illuminated<R, const M: usize> {
    /// XYZ of the light, Y = 1.
    pub white: [R; 3],
    /// XYZ of each sample under the light.
    pub samples: [[R; 3]; M],
}

impl<R: Real, const M: usize> Illuminated<R, M> {
    /// Scales sums so that Y of the light is 1; `None` when the light has no luminance.
    fn normalised(white: [R; 3], samples: [[R; 3]; M]) -> Option<Self> {
        let y = white[1];
        if !(y > R::ZERO && y.is_finite()) {
            return None;
        }
        let scale = |xyz: [R; 3]| xyz.map(|c| c / y);
        Some(Self { white: scale(white), samples: samples.map(scale) })
    }
}

/// A set of `M` test-colour samples, seen by an observer on a grid of `N` wavelengths.
///
/// Both implementors sum the same products in the same order, so that their results are identical to the bit.
pub trait TestColours<R: Real, const N: usize, const M: usize> {
    /// The tristimulus values of the samples under a light; `None` when the light has no luminance.
    fn illuminate(&self, light: &[R; N]) -> Option<Illuminated<R, M>>;
}

/// Test-colour samples whose products with the observer are formed at each use: needs no memory.
#[derive(Clone, Copy, Debug)]
pub struct DirectColours<'a, S, R, const N: usize, const M: usize> {
    grid: SumGrid<N>,
    observer: &'a [[R; 3]; N],
    samples: &'a [S; M],
}

impl<'a, R: Real, S: Spectrum<R>, const N: usize, const M: usize> DirectColours<'a, S, R, N, M> {
    /// The samples' reflectances as functions of wavelength, and x̄, ȳ, z̄ on the grid.
    pub const fn new(grid: SumGrid<N>, observer: &'a [[R; 3]; N], samples: &'a [S; M]) -> Self {
        Self { grid, observer, samples }
    }

    fn products(&self, index: usize) -> [[R; 3]; M] {
        let wavelength = self.grid.wavelength(index);
        let cmf = self.observer.get(index).copied().unwrap_or([R::ZERO; 3]);
        core::array::from_fn(|sample| {
            let reflectance = self.samples[sample].value(wavelength);
            cmf.map(|c| c * reflectance)
        })
    }
}

impl<R: Real, S: Spectrum<R>, const N: usize, const M: usize> TestColours<R, N, M> for DirectColours<'_, S, R, N, M> {
    fn illuminate(&self, light: &[R; N]) -> Option<Illuminated<R, M>> {
        let mut sums = [[R::ZERO; 3]; M];
        for (index, &power) in light.iter().enumerate() {
            let products = self.products(index);
            for (sum, product) in sums.as_flattened_mut().iter_mut().zip(products.as_flattened()) {
                *sum += power * *product;
            }
        }
        Illuminated::normalised(tristimulus_sum(self.observer, light), sums)
    }
}

/// Test-colour samples whose products with the observer are precomputed: a light costs 3 `M` sums of `N` products.
#[derive(Clone, Copy, Debug)]
pub struct PreparedColours<R, const N: usize, const M: usize> {
    observer: [[R; 3]; N],
    products: [[[R; 3]; M]; N],
}

impl<R: Real, const N: usize, const M: usize> PreparedColours<R, N, M> {
    /// The products of the samples' reflectances with x̄, ȳ, z̄ on the grid.
    pub fn new<S: Spectrum<R>>(grid: SumGrid<N>, observer: &[[R; 3]; N], samples: &[S; M]) -> Self {
        let direct = DirectColours::new(grid, observer, samples);
        Self { observer: *observer, products: core::array::from_fn(|index| direct.products(index)) }
    }
}

/// How many sums are kept in registers at once.
const LANES: usize = 8;

impl<R: Real, const N: usize, const M: usize> TestColours<R, N, M> for PreparedColours<R, N, M> {
    fn illuminate(&self, light: &[R; N]) -> Option<Illuminated<R, M>> {
        let mut sums = [[R::ZERO; 3]; M];
        for (block, sums) in sums.as_flattened_mut().chunks_mut(LANES).enumerate() {
            let columns = block * LANES..block * LANES + sums.len();
            let rows = self.products.iter().map(|row| row.as_flattened().get(columns.clone()).unwrap_or_default());
            let mut lanes = [R::ZERO; LANES];
            for (row, &power) in rows.zip(light) {
                if let Ok(row) = <&[R; LANES]>::try_from(row) {
                    // The same as below; the fixed length lets the compiler keep the sums in vector registers.
                    for (sum, product) in lanes.iter_mut().zip(row) {
                        *sum += power * *product;
                    }
                } else {
                    for (sum, product) in lanes.iter_mut().zip(row) {
                        *sum += power * *product;
                    }
                }
            }
            for (sum, lane) in sums.iter_mut().zip(lanes) {
                *sum = lane;
            }
        }
        Illuminated::normalised(tristimulus_sum(&self.observer, light), sums)
    }
}

/// Σ S x̄, Σ S ȳ, Σ S z̄ over the grid: tristimulus values without the step's factor.
///
/// Plain sums in the order of the wavelengths: the relative error is below `N` ε for non-negative lights.
#[must_use]
pub fn tristimulus_sum<R: Real, const N: usize>(observer: &[[R; 3]; N], light: &[R; N]) -> [R; 3] {
    let mut sums = [R::ZERO; 3];
    for (cmf, &power) in observer.iter().zip(light) {
        for (sum, &weight) in sums.iter_mut().zip(cmf) {
            *sum += power * weight;
        }
    }
    sums
}

/// Σ S ω over the grid, with compensation: within 4 ε Σ|S ω|.
#[must_use]
pub fn weighted_sum<R: Real, const N: usize>(weights: &[R; N], light: &[R; N]) -> R {
    let mut sum = Sum::default();
    for (&weight, &power) in weights.iter().zip(light) {
        sum.add(power * weight);
    }
    sum.value()
}
