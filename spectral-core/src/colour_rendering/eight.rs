//! R_a and CRI00 of the eight samples that both average, in lockstep and without the stages in between.

use super::Cri00;
use super::cri::uniform;
use crate::Real;
use crate::adaptation::{Adaptation, VonKries};
use crate::cct::xyz_to_uv;
use crate::colour::{differences, xyz_to_lab};
use crate::lanes::Lanes;
use crate::spectrum::Outside;
use crate::summation::SumGrid;
use crate::tables::observers::CIE_1931_2;
use crate::tables::{UniformTable, test_colours as tcs};

/// x̄, ȳ, z̄ times each of the eight reflectances, x̄, ȳ, z̄ themselves, and a zero that makes the number of sums even: at one
/// wavelength.
pub(crate) type Products<R> = [R; 28];

/// The first eight Munsell samples: CIE 13.3-1995's test colours.
static SAMPLES: [UniformTable; 8] =
    [tcs::TCS01, tcs::TCS02, tcs::TCS03, tcs::TCS04, tcs::TCS05, tcs::TCS06, tcs::TCS07, tcs::TCS08];

/// The products of the first eight Munsell samples and the 2° observer of 1931, formed where they are needed: nothing is kept.
#[derive(Clone, Copy, Debug)]
pub(crate) struct EightSamples<const N: usize> {
    grid: SumGrid<N>,
}

impl<const N: usize> EightSamples<N> {
    pub(crate) const fn new(grid: SumGrid<N>) -> Self {
        Self { grid }
    }

    pub(crate) fn products<R: Real>(&self, index: usize) -> Products<R> {
        let cmf = self.grid.cmf(&CIE_1931_2, index);
        let nanometres = self.grid.nanometres(index);
        let reflectances = SAMPLES.each_ref().map(|table| table.at_whole(nanometres, Outside::Hold));
        let mut products = [R::ZERO; 28];
        let (samples, white) = products.split_at_mut(24);
        for (channel, c) in samples.chunks_exact_mut(8).zip(cmf) {
            for (product, reflectance) in channel.iter_mut().zip(reflectances) {
                *product = c * reflectance;
            }
        }
        for (product, c) in white.iter_mut().zip(cmf) {
            *product = c;
        }
        products
    }
}

/// Tristimulus sums of a light and of the eight samples under it, by channel.
#[derive(Clone, Copy, Debug)]
pub(crate) struct EightSums<R> {
    pub(crate) white: [R; 3],
    samples: [[R; 8]; 3],
}

impl<R: Real> EightSums<R> {
    /// Plain sums in the order of the wavelengths.
    #[inline]
    pub(crate) fn new(light: impl Iterator<Item = R>, rows: impl Iterator<Item = Products<R>>) -> Self {
        let sums = weighted_rows(light, rows);
        let at = |first: usize| core::array::from_fn(|sample| sums[first + sample]);
        Self { white: [sums[24], sums[25], sums[26]], samples: [at(0), at(8), at(16)] }
    }
}

/// Σ lightᵢ rowᵢ.
///
/// Not inlined: what is done with the sums would otherwise decide how they lie in vector registers, and they
/// would not all find room.
#[inline(never)]
fn weighted_rows<R: Real>(light: impl Iterator<Item = R>, rows: impl Iterator<Item = Products<R>>) -> Products<R> {
    let mut sums = [R::ZERO; 28];
    for (power, row) in light.zip(rows) {
        for (sum, product) in sums.iter_mut().zip(row) {
            *sum += power * product;
        }
    }
    sums
}

/// What the indices need of a reference light: all smooth functions of its temperature.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ReferenceColours<R> {
    /// X and Z of the light, relative to Y = 1.
    pub(crate) white: [[R; 2]; 1],
    /// L\*, a\*, b\* of the eight samples, relative to the light.
    pub(crate) lab: [[R; 8]; 3],
    /// W\*, U\*, V\* of the eight samples.
    pub(crate) uniform: [[R; 8]; 3],
}

/// White, CIELAB and CIE 1964 colours in one list.
pub(super) const COMPONENTS: usize = 2 + 24 + 24;

impl<R: Real> ReferenceColours<R> {
    pub(crate) const fn zero() -> Self {
        Self { white: [[R::ZERO; 2]], lab: [[R::ZERO; 8]; 3], uniform: [[R::ZERO; 8]; 3] }
    }

    /// All components in a list.
    pub(super) fn list(&self) -> [R; COMPONENTS] {
        let values = self.white.as_flattened().iter().chain(self.lab.as_flattened()).chain(self.uniform.as_flattened());
        let mut list = [R::ZERO; COMPONENTS];
        for (place, &value) in list.iter_mut().zip(values) {
            *place = value;
        }
        list
    }

    /// The colours that a list is of.
    pub(super) fn from_list(list: &[R; COMPONENTS]) -> Self {
        let mut found = Self::zero();
        let Self { white, lab, uniform } = &mut found;
        let places =
            white.as_flattened_mut().iter_mut().chain(lab.as_flattened_mut()).chain(uniform.as_flattened_mut());
        for (place, &value) in places.zip(list) {
            *place = value;
        }
        found
    }

    /// The colours from the sums of the reference light, which must have luminance.
    pub(crate) fn new(sums: &EightSums<R>) -> Self {
        let y = sums.white[1];
        let white = sums.white.map(|c| c / y);
        let uv = xyz_to_uv(white);
        let mut found = Self { white: [[white[0], white[2]]], ..Self::zero() };
        for sample in 0..8 {
            let xyz = sums.samples.map(|channel| channel[sample] / y);
            for (channel, value) in found.lab.iter_mut().zip(xyz_to_lab(xyz, white)) {
                channel[sample] = value;
            }
            for (channel, value) in found.uniform.iter_mut().zip(uniform(xyz_to_uv(xyz), xyz[1], uv)) {
                channel[sample] = value;
            }
        }
        found
    }
}

/// R_a and CRI00: what [`cie_13_3`](super::cie_13_3) and [`cri00`](super::cri00) give to rounding.
pub(crate) fn general_indices<R: Real>(test: &EightSums<R>, reference: &ReferenceColours<R>) -> [R; 2] {
    let [[x, z]] = reference.white;
    let white = [x, R::ONE, z];
    let relative = R::ONE / test.white[1];
    let samples = test.samples.map(Lanes);

    let von_kries = VonKries::new(test.white, white);
    let colours = uniform_colours(&von_kries, &samples, relative, xyz_to_uv(white));
    let ra = distances(&reference.uniform.map(Lanes), &colours);

    let bradford = Adaptation::bradford(test.white.map(|c| c * relative), white);
    let rows = bradford.matrix();
    let rows = core::array::from_fn(|channel| rows[channel].map(|m| m * (relative / white[channel])));
    let cri00 = differences(&reference.lab.map(Lanes), &lab_colours(&rows, &samples), [R::ONE; 3]);
    [general(4.6, &ra), general(Cri00::MUNSELL.factor, &cri00)]
}

/// 100 less the mean of the differences times a factor.
fn general<R: Real>(factor: f64, differences: &Lanes<R, 8>) -> R {
    let mut sum = R::ZERO;
    for difference in differences.0 {
        sum += difference;
    }
    R::from_f64(100.0) - R::from_f64(factor) * (sum * R::from_f64(0.125))
}

#[inline(never)]
fn distances<R: Real, const W: usize>(first: &[Lanes<R, W>; 3], second: &[Lanes<R, W>; 3]) -> Lanes<R, W> {
    let [x, y, z] = core::array::from_fn(|channel| first[channel] - second[channel]);
    (x * x + y * y + z * z).sqrt()
}

/// Adapted W\*, U\*, V\* of tristimulus sums, which times `relative` are relative to the white.
#[inline(never)]
fn uniform_colours<R: Real, const W: usize>(
    adaptation: &VonKries<R>,
    xyz: &[Lanes<R, W>; 3],
    relative: R,
    [u0, v0]: [R; 2],
) -> [Lanes<R, W>; 3] {
    let constant = Lanes::<R, W>::constant;
    let [u, v] = adaptation.apply(*xyz);
    let root = (xyz[1] * Lanes::all(R::from_f64(100.0) * relative)).cbrt();
    let lightness = constant(25.0) * root - constant(17.0);
    let scale = constant(13.0) * lightness;
    [lightness, scale * (u - Lanes::all(u0)), scale * (v - Lanes::all(v0))]
}

/// CIELAB of tristimulus sums by a matrix that adapts them and divides them by the white.
fn lab_colours<R: Real, const W: usize>(rows: &[[R; 3]; 3], xyz: &[Lanes<R, W>; 3]) -> [Lanes<R, W>; 3] {
    let constant = Lanes::<R, W>::constant;
    let [fx, fy, fz] = [lab_f(&rows[0], xyz), lab_f(&rows[1], xyz), lab_f(&rows[2], xyz)];
    [constant(116.0) * fy - constant(16.0), constant(500.0) * (fx - fy), constant(200.0) * (fy - fz)]
}

/// The function f of CIELAB of a combination of tristimulus values: only within 2 ε of [`crate::colour::lab_f`], and not
/// monotone to the last bit.
#[inline(never)]
fn lab_f<R: Real, const W: usize>([a, b, c]: &[R; 3], [x, y, z]: &[Lanes<R, W>; 3]) -> Lanes<R, W> {
    let t = Lanes::all(*a) * *x + Lanes::all(*b) * *y + Lanes::all(*c) * *z;
    let line = t * Lanes::constant(841.0 / 108.0) + Lanes::constant(4.0 / 29.0);
    t.if_above(R::from_f64(216.0 / 24_389.0), t.cbrt(), line)
}
