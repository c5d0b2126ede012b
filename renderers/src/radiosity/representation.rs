//! What the numbers of a solution's rows mean.

use core::fmt::Debug;

use crate::spectral::{Components, Factor, UniformBins, Y_INTEGRAL};

/// Tristimulus values with Y = 1 for a flat radiance of 1, and how far the spectral representation may put each off.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Tristimulus {
    /// X, Y, Z.
    pub value: [f64; 3],
    /// Certain for certified intervals; the first-order error for Iehl and Péroche's; 0 for all others.
    pub radius: [f64; 3],
}

/// How a solution's rows of numbers are made of lights, multiplied by reflectances, and seen as colour.
///
/// A sum of rows with factors that aren't negative is the row of the sum of light: bounds among the numbers are upper bounds that add up.
pub trait Representation: Debug + Sync {
    /// Numbers in a row.
    fn width(&self) -> usize;

    /// The row of a light's spectrum: a radiance, an irradiance or an intensity, in the spectrum's unit. A leaf that is none gives 0.
    fn light(&self, factor: Factor, row: &mut [f64]);

    /// Multiplies a row by a reflectance, in place. A leaf that is none counts as 1.
    fn reflect(&self, factor: Factor, row: &mut [f64]);

    /// The colour of a radiance: of a row times a product of leaves of the palette, from the eye to the light.
    fn colour(&self, leaves: &[u32], row: &[f64]) -> Tristimulus;

    /// The luminances of rows in which one number is 1 and all others are 0: where these add up, that of a row is the sum of its numbers times them.
    fn luminances(&self) -> Vec<f64> {
        let mut row = vec![0.0; self.width()];
        let mut luminance = |place: usize| {
            row.fill(0.0);
            row[place] = 1.0;
            self.colour(&[], &row).value[1]
        };
        (0..self.width()).map(&mut luminance).collect()
    }

    /// Intervals, bins or components.
    fn intervals(&self) -> usize {
        self.width()
    }

    /// How many of a row's numbers, the first ones, are light.
    fn values(&self) -> usize {
        self.width()
    }

    /// How many of a row's numbers, the first ones, are those of a difference of lights where they are subtracted; the others bound errors.
    fn linear(&self) -> usize {
        self.values()
    }

    /// Whether a reflectance multiplies number by number.
    fn is_diagonal(&self) -> bool {
        true
    }
}

impl<T: Representation + ?Sized> Representation for &T {
    fn width(&self) -> usize {
        (**self).width()
    }

    fn light(&self, factor: Factor, row: &mut [f64]) {
        (**self).light(factor, row);
    }

    fn reflect(&self, factor: Factor, row: &mut [f64]) {
        (**self).reflect(factor, row);
    }

    fn colour(&self, leaves: &[u32], row: &[f64]) -> Tristimulus {
        (**self).colour(leaves, row)
    }

    fn luminances(&self) -> Vec<f64> {
        (**self).luminances()
    }

    fn intervals(&self) -> usize {
        (**self).intervals()
    }

    fn values(&self) -> usize {
        (**self).values()
    }

    fn linear(&self) -> usize {
        (**self).linear()
    }

    fn is_diagonal(&self) -> bool {
        (**self).is_diagonal()
    }
}

/// Means over bins of wavelength, multiplied bin by bin.
impl Representation for UniformBins {
    fn width(&self) -> usize {
        self.len()
    }

    fn light(&self, factor: Factor, row: &mut [f64]) {
        match factor.leaf.map(|leaf| self.means(leaf)) {
            None => row.fill(factor.scale),
            Some(Some(means)) => row.iter_mut().zip(means).for_each(|(r, m)| *r = factor.scale * m),
            Some(None) => row.fill(0.0),
        }
    }

    fn reflect(&self, factor: Factor, row: &mut [f64]) {
        match factor.leaf.and_then(|leaf| self.means(leaf)) {
            None => row.iter_mut().for_each(|r| *r *= factor.scale),
            Some(means) => row.iter_mut().zip(means).for_each(|(r, m)| *r *= factor.scale * m),
        }
    }

    fn colour(&self, leaves: &[u32], row: &[f64]) -> Tristimulus {
        let mut sums = [0.0; 3];
        let [x, y, z] = self.weights();
        for (bin, value) in row.iter().enumerate() {
            let means = leaves.iter().filter_map(|leaf| self.means(*leaf));
            let product = means.fold(*value, |product, means| product * means[bin]);
            sums = [sums[0] + x[bin] * product, sums[1] + y[bin] * product, sums[2] + z[bin] * product];
        }
        Tristimulus { value: sums.map(|s| s / Y_INTEGRAL), radius: [0.0; 3] }
    }
}

/// Three components, multiplied one by one or by the operators of the bilinear model.
impl Representation for Components {
    fn width(&self) -> usize {
        3
    }

    fn light(&self, factor: Factor, row: &mut [f64]) {
        match factor.leaf.map(|leaf| self.components(leaf)) {
            None => row.fill(factor.scale),
            Some(Some(colour)) => row.iter_mut().zip(colour).for_each(|(r, c)| *r = factor.scale * c),
            Some(None) => row.fill(0.0),
        }
    }

    fn reflect(&self, factor: Factor, row: &mut [f64]) {
        let light = core::array::from_fn(|a| row.get(a).copied().unwrap_or(0.0));
        let reflected = factor.leaf.map_or(light, |leaf| self.through(&[leaf], light));
        row.iter_mut().zip(reflected).for_each(|(r, c)| *r = factor.scale * c);
    }

    fn colour(&self, leaves: &[u32], row: &[f64]) -> Tristimulus {
        let light = core::array::from_fn(|a| row.get(a).copied().unwrap_or(0.0));
        Tristimulus { value: self.space().to_xyz(self.through(leaves, light)), radius: [0.0; 3] }
    }

    fn is_diagonal(&self) -> bool {
        self.multiplies_one_by_one()
    }
}

/// One component alone, of spectra that are flat: their numbers. Leaves of the palette count as 1.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Flat;

impl Representation for Flat {
    fn width(&self) -> usize {
        1
    }

    fn light(&self, factor: Factor, row: &mut [f64]) {
        row.fill(factor.scale);
    }

    fn reflect(&self, factor: Factor, row: &mut [f64]) {
        row.iter_mut().for_each(|r| *r *= factor.scale);
    }

    fn colour(&self, _: &[u32], row: &[f64]) -> Tristimulus {
        Tristimulus { value: [row.first().copied().unwrap_or(0.0); 3], radius: [0.0; 3] }
    }
}

/// The row of a light.
pub(super) fn light(representation: &dyn Representation, factor: Factor) -> Vec<f64> {
    let mut row = vec![0.0; representation.width()];
    representation.light(factor, &mut row);
    row
}

/// What a reflectance multiplies each number by, in a representation where it does.
pub(super) fn reflectance(representation: &dyn Representation, factor: Factor) -> Vec<f64> {
    let mut row = vec![1.0; representation.width()];
    representation.reflect(factor, &mut row);
    row
}

/// What a reflectance does to a row, as a matrix, row by row.
pub(super) fn matrix(representation: &dyn Representation, factor: Factor) -> Vec<f64> {
    let width = representation.width();
    let mut matrix = vec![0.0; width * width];
    for column in 0..width {
        let mut unit = vec![0.0; width];
        unit[column] = 1.0;
        representation.reflect(factor, &mut unit);
        unit.iter().enumerate().for_each(|(row, value)| matrix[row * width + column] = *value);
    }
    matrix
}
