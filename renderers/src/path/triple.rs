//! Paths that carry three components: products one by one, or by matrices.

use super::carrier::{Carrier, Term};
use crate::spectral::{Components, Factor, Functional, MEAN_WAVELENGTH};

type Matrix = [[f64; 3]; 3];

const IDENTITY: Matrix = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

/// Three components of light: refraction is that of one wavelength, the same for all of them.
#[derive(Clone, Debug)]
pub(super) struct Triple<'a> {
    components: &'a Components,
    scale: f64,
    /// From light at the path's end to light at the eye: diagonal where components are multiplied one by one.
    matrix: Matrix,
    light: [f64; 3],
}

impl<'a> Triple<'a> {
    pub(super) const fn new(components: &'a Components) -> Self {
        Self { components, scale: 1.0, matrix: IDENTITY, light: [0.0; 3] }
    }

    fn of_leaf(&self, leaf: u32) -> Matrix {
        if let Some(matrix) = self.components.matrix(leaf) {
            return matrix;
        }
        let [r, g, b] = self.components.components(leaf).copied().unwrap_or([1.0; 3]);
        [[r, 0.0, 0.0], [0.0, g, 0.0], [0.0, 0.0, b]]
    }
}

impl Triple<'_> {
    fn sum(&self, terms: &[Term]) -> Matrix {
        let mut sum = [[0.0; 3]; 3];
        for (factor, share) in terms {
            let scale = share * factor.map_or(1.0, |f| f.scale);
            let matrix = factor.and_then(|f| f.leaf).map_or(IDENTITY, |leaf| self.of_leaf(leaf));
            for (to, from) in sum.iter_mut().flatten().zip(matrix.as_flattened()) {
                *to += scale * from;
            }
        }
        sum
    }
}

fn apply(matrix: &Matrix, light: [f64; 3]) -> [f64; 3] {
    matrix.map(|row| row.iter().zip(&light).map(|(m, l)| m * l).sum())
}

impl Carrier for Triple<'_> {
    fn start(&mut self, _: [f32; 2]) {
        *self = Self::new(self.components);
    }

    fn multiply(&mut self, terms: &[Term]) {
        let sum = self.sum(terms);
        self.matrix = if self.components.multiplies_one_by_one() {
            core::array::from_fn(|a| core::array::from_fn(|b| self.matrix[a][b] * sum[a][b]))
        } else {
            self.matrix.map(|row| core::array::from_fn(|c| (0..3).map(|k| row[k] * sum[k][c]).sum()))
        };
    }

    fn multiply_by(&mut self, function: &dyn Fn(f64) -> f64) {
        self.scale *= function(MEAN_WAVELENGTH);
    }

    fn scale(&mut self, share: f64) {
        self.scale *= share;
    }

    fn wavelength(&self) -> Option<f64> {
        Some(MEAN_WAVELENGTH)
    }

    fn choose_wavelength(&mut self) -> f64 {
        MEAN_WAVELENGTH
    }

    fn gather(&mut self, terms: &[Term], light: Factor, weight: f64) {
        let colour = light.leaf.and_then(|leaf| self.components.components(leaf)).copied().unwrap_or([1.0; 3]);
        let seen = apply(&self.matrix, apply(&self.sum(terms), colour));
        let weight = weight * self.scale * light.scale;
        self.light = core::array::from_fn(|a| self.light[a] + weight * seen[a]);
    }

    fn strength(&self, function: Functional) -> f64 {
        let space = self.components.space();
        let luminances = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(|unit| space.to_xyz(unit)[1]);
        let most = self.matrix.map(|row| row.iter().fold(0.0, |a: f64, m| a.max(m.abs())));
        self.scale.abs() * function.of_components(luminances, most)
    }

    fn xyz(&self) -> [f64; 3] {
        self.components.space().to_xyz(self.light)
    }
}
