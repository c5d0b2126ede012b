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
use crate::tables::{TableGrid, test_colours as tcs};

/// x̄, ȳ, z̄ times each of the eight reflectances, x̄, ȳ, z̄ themselves, and a zero that makes the number of sums even: at one
/// wavelength.
pub(crate) type Products<R> = [R; 28];

/// The grid of the tables of CIE 13.3-1995's test colours, of which the samples are the first eight.
const GRID: TableGrid = TableGrid { first: tcs::TCS01.first, step: tcs::TCS01.step };

/// The products of the first eight Munsell samples and the 2° observer of 1931, formed where they are needed: nothing is kept.
#[derive(Clone, Copy, Debug)]
pub(crate) struct EightSamples<const N: usize> {
    grid: SumGrid<N>,
}

impl<const N: usize> EightSamples<N> {
    pub(crate) const fn new(grid: SumGrid<N>) -> Self {
        Self { grid }
    }

    /// x̄, ȳ, z̄ and the reflectances at one wavelength.
    fn row<R: Real>(&self, index: usize) -> ([R; 3], [R; 8]) {
        let cmf = self.grid.cmf(&CIE_1931_2, index);
        let nanometres = self.grid.nanometres(index);
        // Each by name and in this precision: so the other one is not linked, however code is built.
        let samples: [&[R]; 8] = [
            R::samples(&tcs::TCS01.samples),
            R::samples(&tcs::TCS02.samples),
            R::samples(&tcs::TCS03.samples),
            R::samples(&tcs::TCS04.samples),
            R::samples(&tcs::TCS05.samples),
            R::samples(&tcs::TCS06.samples),
            R::samples(&tcs::TCS07.samples),
            R::samples(&tcs::TCS08.samples),
        ];
        (cmf, samples.map(|samples| GRID.at_whole(samples, nanometres, Outside::Hold)))
    }

    /// What [`EightSums::new`] gives with all products, to the bit, in less memory.
    #[inline(never)]
    pub(crate) fn sum<R: Real>(&self, light: impl Iterator<Item = R>, sums: &mut EightSums<R>) {
        *sums = EightSums::zero();
        for (index, power) in light.enumerate() {
            let (cmf, reflectances) = self.row::<R>(index);
            for ((white, channel), c) in sums.white.iter_mut().zip(&mut sums.samples).zip(cmf) {
                *white += power * c;
                for (sum, reflectance) in channel.iter_mut().zip(reflectances) {
                    *sum += power * (c * reflectance);
                }
            }
        }
    }

    pub(crate) fn products<R: Real>(&self, index: usize) -> Products<R> {
        let (cmf, reflectances) = self.row(index);
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

    pub(crate) const fn zero() -> Self {
        Self { white: [R::ZERO; 3], samples: [[R::ZERO; 8]; 3] }
    }

    /// XYZ of the light, relative to Y = 1.
    pub(super) fn relative_white(&self) -> [R; 3] {
        let [_, y, _] = self.white;
        self.white.map(|c| c / y)
    }

    /// XYZ of a sample under the light, relative to the light's Y.
    fn relative(&self, sample: usize) -> [R; 3] {
        let [_, y, _] = self.white;
        self.samples.map(|channel| channel.get(sample).copied().unwrap_or(R::ZERO) / y)
    }

    /// L\*, a\*, b\* of a sample under the light, relative to the light.
    pub(super) fn lab(&self, sample: usize) -> [R; 3] {
        xyz_to_lab(self.relative(sample), self.relative_white())
    }

    /// W\*, U\*, V\* of a sample under the light, relative to the light.
    pub(super) fn uniform(&self, sample: usize) -> [R; 3] {
        let xyz = self.relative(sample);
        uniform(xyz_to_uv(xyz), xyz[1], xyz_to_uv(self.relative_white()))
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

impl<R: Real> ReferenceColours<R> {
    pub(crate) const fn zero() -> Self {
        Self { white: [[R::ZERO; 2]], lab: [[R::ZERO; 8]; 3], uniform: [[R::ZERO; 8]; 3] }
    }

    /// The colours from the sums of the reference light, which must have luminance.
    pub(crate) fn new(sums: &EightSums<R>) -> Self {
        let [x, _, z] = sums.relative_white();
        let mut found = Self { white: [[x, z]], ..Self::zero() };
        for sample in 0..8 {
            set(&mut found.lab, sample, sums.lab(sample));
            set(&mut found.uniform, sample, sums.uniform(sample));
        }
        found
    }
}

/// Sets the colour of a sample, by channel.
pub(super) fn set<R: Real>(colours: &mut [[R; 8]; 3], sample: usize, colour: [R; 3]) {
    for (channel, value) in colours.iter_mut().zip(colour) {
        if let Some(place) = channel.get_mut(sample) {
            *place = value;
        }
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
