//! R_a and CRI00 of the eight samples that both average, in lockstep and without the stages in between.

use super::cri::uniform;
use super::{Cri00, munsell_samples};
use crate::Real;
use crate::adaptation::{Adaptation, VonKries};
use crate::cct::xyz_to_uv;
use crate::colour::{differences, xyz_to_lab};
use crate::lanes::Lanes;
use crate::spectrum::{Spectrum, Uniform};
use crate::summation::SumGrid;

/// x̄, ȳ, z̄ times each of the eight reflectances, x̄, ȳ, z̄ themselves, and a zero that makes the number of sums even: at one
/// wavelength.
pub(crate) type Products<R> = [R; 28];

/// The products of the first eight Munsell samples and an observer, formed where they are needed.
#[derive(Clone, Copy, Debug)]
pub(crate) struct EightSamples<'a, R: 'static, const N: usize> {
    grid: SumGrid<N>,
    observer: &'a [[R; 3]; N],
    samples: [Uniform<'static, R>; 8],
}

impl<'a, R: Real, const N: usize> EightSamples<'a, R, N> {
    pub(crate) fn new(grid: SumGrid<N>, observer: &'a [[R; 3]; N]) -> Self {
        let samples = munsell_samples();
        Self { grid, observer, samples: core::array::from_fn(|sample| samples[sample]) }
    }

    pub(crate) fn products(&self, index: usize) -> Products<R> {
        let cmf = self.observer.get(index).copied().unwrap_or([R::ZERO; 3]);
        let wavelength = self.grid.wavelength(index);
        let reflectances: [R; 8] = core::array::from_fn(|sample| self.samples[sample].value(wavelength));
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
    pub(crate) fn new(light: &[R], rows: impl Iterator<Item = Products<R>>) -> Self {
        let sums = weighted_rows(light, rows);
        let at = |first: usize| core::array::from_fn(|sample| sums[first + sample]);
        Self { white: [sums[24], sums[25], sums[26]], samples: [at(0), at(8), at(16)] }
    }
}

/// Σ powerᵢ rowᵢ.
///
/// Not inlined: what is done with the sums would otherwise decide how they lie in vector registers, and they
/// would not all find room.
#[inline(never)]
fn weighted_rows<R: Real>(light: &[R], rows: impl Iterator<Item = Products<R>>) -> Products<R> {
    let mut sums = [R::ZERO; 28];
    for (&power, row) in light.iter().zip(rows) {
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
    pub(crate) white: [R; 2],
    /// L\*, a\*, b\* relative to the light, and W\*, U\*, V\*, of the eight samples.
    pub(crate) colours: [[R; 8]; 6],
}

impl<R: Real> ReferenceColours<R> {
    pub(crate) const fn zero() -> Self {
        Self { white: [R::ZERO; 2], colours: [[R::ZERO; 8]; 6] }
    }

    /// Adds the other one's values times a factor.
    pub(crate) fn add(&mut self, other: &Self, factor: R) {
        let add = |sums: &mut [R], values: &[R]| {
            for (sum, &value) in sums.iter_mut().zip(values) {
                *sum += value * factor;
            }
        };
        add(&mut self.white, &other.white);
        add(self.colours.as_flattened_mut(), other.colours.as_flattened());
    }

    /// The colours from the sums of the reference light, which must have luminance.
    pub(crate) fn new(sums: &EightSums<R>) -> Self {
        let y = sums.white[1];
        let white = sums.white.map(|c| c / y);
        let uv = xyz_to_uv(white);
        let mut colours = [[R::ZERO; 8]; 6];
        for sample in 0..8 {
            let xyz = sums.samples.map(|channel| channel[sample] / y);
            let found = [xyz_to_lab(xyz, white), uniform(xyz_to_uv(xyz), xyz[1], uv)];
            for (channel, value) in colours.iter_mut().zip(found.as_flattened()) {
                channel[sample] = *value;
            }
        }
        Self { white: [white[0], white[2]], colours }
    }
}

/// How many samples go in lockstep: as many as leave all intermediate values in vector registers of 128 bits.
const LOCKSTEP: usize = 8;

/// R_a and CRI00: what [`cie_13_3`](super::cie_13_3) and [`cri00`](super::cri00) give to rounding.
#[inline]
pub(crate) fn general_indices<R: Real>(test: &EightSums<R>, reference: &ReferenceColours<R>) -> [R; 2] {
    let white = [reference.white[0], R::ONE, reference.white[1]];
    let relative = R::ONE / test.white[1];
    let von_kries = VonKries::new(test.white, white);
    let white_uv = xyz_to_uv(white);
    let bradford = Adaptation::bradford(test.white.map(|c| c * relative), white);
    let rows = bradford.matrix();
    let rows = core::array::from_fn(|channel| rows[channel].map(|m| m * (relative / white[channel])));

    let (mut ra, mut cri00) = ([R::ZERO; 8], [R::ZERO; 8]);
    let results = ra.as_chunks_mut::<LOCKSTEP>().0.iter_mut().zip(cri00.as_chunks_mut::<LOCKSTEP>().0);
    for (part, (ra, cri00)) in results.enumerate() {
        let xyz = lanes(&test.samples, part);
        let [l, a, b, w, u, v] = lanes(&reference.colours, part);
        *ra = distances([w, u, v], uniform_colours(&von_kries, xyz, relative, white_uv)).0;
        *cri00 = differences(&[l, a, b], &lab_colours(&rows, xyz), [R::ONE; 3]).0;
    }
    [
        mean(ra.map(|difference| R::from_f64(4.6) * difference)),
        mean(cri00.map(|difference| R::from_f64(Cri00::MUNSELL.factor) * difference)),
    ]
}

/// One part of each channel.
#[inline(always)]
fn lanes<R: Real, const C: usize>(channels: &[[R; 8]; C], part: usize) -> [Lanes<R, LOCKSTEP>; C] {
    channels.each_ref().map(|values| Lanes(values.as_chunks().0.get(part).copied().unwrap_or([R::ZERO; LOCKSTEP])))
}

/// 100 less the mean.
fn mean<R: Real>(values: [R; 8]) -> R {
    let mut sum = R::ZERO;
    for value in values {
        sum += value;
    }
    R::from_f64(100.0) - sum * R::from_f64(0.125)
}

#[inline(always)]
fn distances<R: Real, const W: usize>(first: [Lanes<R, W>; 3], second: [Lanes<R, W>; 3]) -> Lanes<R, W> {
    let [x, y, z] = core::array::from_fn(|channel| first[channel] - second[channel]);
    (x * x + y * y + z * z).sqrt()
}

/// Adapted W\*, U\*, V\* of tristimulus sums, which times `relative` are relative to the white.
#[inline(always)]
fn uniform_colours<R: Real, const W: usize>(
    adaptation: &VonKries<R>,
    xyz: [Lanes<R, W>; 3],
    relative: R,
    [u0, v0]: [R; 2],
) -> [Lanes<R, W>; 3] {
    let constant = Lanes::<R, W>::constant;
    let [u, v] = adaptation.apply(xyz);
    let root = (xyz[1] * Lanes::all(R::from_f64(100.0) * relative)).cbrt();
    let lightness = constant(25.0) * root - constant(17.0);
    let scale = constant(13.0) * lightness;
    [lightness, scale * (u - Lanes::all(u0)), scale * (v - Lanes::all(v0))]
}

/// CIELAB of tristimulus sums by a matrix that adapts them and divides them by the white.
#[inline(always)]
fn lab_colours<R: Real, const W: usize>(rows: &[[R; 3]; 3], [x, y, z]: [Lanes<R, W>; 3]) -> [Lanes<R, W>; 3] {
    let constant = Lanes::<R, W>::constant;
    let [fx, fy, fz] = rows.map(|[a, b, c]| {
        let t = Lanes::all(a) * x + Lanes::all(b) * y + Lanes::all(c) * z;
        // The function f of CIELAB; only within 2 ε of `lab_f`, and not monotone to the last bit.
        let line = t * constant(841.0 / 108.0) + constant(4.0 / 29.0);
        t.if_above(R::from_f64(216.0 / 24_389.0), t.cbrt(), line)
    });
    [constant(116.0) * fy - constant(16.0), constant(500.0) * (fx - fy), constant(200.0) * (fy - fz)]
}
