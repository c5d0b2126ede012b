//! The linear system where a reflectance is an operator on the whole row: the bilinear product's 3×3 matrices.
//!
//! X = R (H₀ + K X) has no symmetric form, as the matrices R of different materials don't commute: it is solved by GMRES (Y. Saad and
//! M. H. Schultz, SIAM J. Sci. Stat. Comput. 7, 1986) in the inner product weighted by area, restarted.

use super::solve::Solved;
use super::transport::{Buffer, Transport};

/// Steps between restarts, and the most steps of all.
const RESTART: usize = 40;
const MOST_STEPS: usize = 4000;

/// The system for rows of `width` numbers.
pub(super) struct Coupled<'t> {
    pub(super) transport: &'t Transport,
    pub(super) width: usize,
    /// For each leaf, the index of its matrix; the matrices, row by row.
    pub(super) surface: Vec<usize>,
    pub(super) matrices: Vec<Vec<f64>>,
    /// H₀.
    pub(super) lit: Vec<f64>,
    pub(super) largest_sum: f64,
}

impl Coupled<'_> {
    /// 1 / (1 − ‖R‖ ΣF) in the maximum norm, 1 where this doesn't bound anything.
    pub(super) fn amplification(&self) -> f64 {
        let sum = |row: &[f64]| row.iter().map(|v| v.abs()).sum::<f64>();
        let rows = self.surface.iter().flat_map(|surface| self.matrices[*surface].chunks(self.width));
        let norm = rows.map(sum).fold(0.0, f64::max) * self.largest_sum;
        if norm < 1.0 { 1.0 / (1.0 - norm) } else { 1.0 }
    }

    /// R times an irradiance.
    pub(super) fn reflected(&self, irradiance: &[f64]) -> Vec<f64> {
        let mut reflected = vec![0.0; irradiance.len()];
        let rows = reflected.chunks_mut(self.width).zip(irradiance.chunks(self.width));
        for ((to, from), surface) in rows.zip(&self.surface) {
            for (to, row) in to.iter_mut().zip(self.matrices[*surface].chunks(self.width)) {
                *to = row.iter().zip(from).map(|(r, h)| r * h).sum();
            }
        }
        reflected
    }

    /// R (H₀ + K X).
    fn next(&self, radiosity: &[f64], buffer: &mut Buffer) -> Vec<f64> {
        let mut irradiance = vec![0.0; radiosity.len()];
        self.transport.apply(radiosity, &mut irradiance, self.width, buffer);
        irradiance.iter_mut().zip(&self.lit).for_each(|(k, h)| *k += h);
        self.reflected(&irradiance)
    }

    /// X − R K X.
    fn image(&self, radiosity: &[f64], buffer: &mut Buffer) -> Vec<f64> {
        let mut irradiance = vec![0.0; radiosity.len()];
        self.transport.apply(radiosity, &mut irradiance, self.width, buffer);
        radiosity.iter().zip(self.reflected(&irradiance)).map(|(x, r)| x - r).collect()
    }

    /// The result of so many reflections.
    pub(super) fn bounces(&self, count: u32, buffer: &mut Buffer) -> Solved {
        let mut reflected = vec![0.0; self.lit.len()];
        for step in 0..count {
            reflected = if step == 0 { self.reflected(&self.lit) } else { self.next(&reflected, buffer) };
        }
        self.solved(reflected, count as usize, vec![0.0; self.width], buffer)
    }

    fn solved(&self, reflected: Vec<f64>, steps: usize, residual: Vec<f64>, buffer: &mut Buffer) -> Solved {
        let mut irradiance = vec![0.0; reflected.len()];
        self.transport.apply(&reflected, &mut irradiance, self.width, buffer);
        Solved { reflected, irradiance, steps, passes: (steps + 1) * self.width, residual }
    }

    /// All reflections, until the residual times the amplification is at most `tolerance` times the largest radiosity, or stays as it is.
    pub(super) fn solve(&self, tolerance: f64, buffer: &mut Buffer) -> Solved {
        let amplification = self.amplification();
        let mut found = self.reflected(&self.lit);
        let (mut steps, mut before) = (0, f64::INFINITY);
        loop {
            let next = self.next(&found, buffer);
            let error: Vec<f64> = next.iter().zip(&found).map(|(n, x)| n - x).collect();
            let residual = largest(&error, self.width);
            let worst = residual.iter().fold(0.0, |m: f64, r| m.max(*r));
            let size = largest(&next, self.width).iter().fold(0.0, |m: f64, r| m.max(*r));
            steps += 1;
            let goal = tolerance * size / amplification;
            if worst <= goal || !(worst < 0.5 * before) || steps >= MOST_STEPS {
                return self.solved(next, steps, residual, buffer);
            }
            before = worst;
            steps += self.cycle(&mut found, error, 0.1 * goal / worst, buffer);
        }
    }

    /// Up to [`RESTART`] steps from `found`, whose residual is `error`, until that is less by a factor; returns how many.
    fn cycle(&self, found: &mut [f64], error: Vec<f64>, factor: f64, buffer: &mut Buffer) -> usize {
        let start = self.dot(&error, &error).sqrt();
        let mut basis = vec![scaled(&error, 1.0 / start)];
        // The Hessenberg matrix by columns, made triangular by rotations.
        let (mut columns, mut rotations): (Vec<Vec<f64>>, Vec<[f64; 2]>) = (Vec::new(), Vec::new());
        let mut right = vec![start];
        while columns.len() < RESTART && right.last().is_some_and(|last| last.abs() > factor * start) {
            let mut image = self.image(&basis[basis.len() - 1], buffer);
            let mut column = Vec::with_capacity(basis.len() + 1);
            for vector in &basis {
                let part = self.dot(&image, vector);
                image.iter_mut().zip(vector).for_each(|(i, v)| *i -= part * v);
                column.push(part);
            }
            let rest = self.dot(&image, &image).sqrt();
            for (row, [c, s]) in rotations.iter().enumerate() {
                let (a, b) = (column[row], column[row + 1]);
                (column[row], column[row + 1]) = (c * a + s * b, c * b - s * a);
            }
            let last = column.len() - 1;
            let length = column[last].hypot(rest);
            if !(length > 0.0) {
                break;
            }
            let [c, s] = [column[last] / length, rest / length];
            column[last] = length;
            let value = right[last];
            right[last] = c * value;
            right.push(-s * value);
            rotations.push([c, s]);
            columns.push(column);
            if !(rest > f64::EPSILON * length) {
                break;
            }
            basis.push(scaled(&image, 1.0 / rest));
        }
        let mut weights = vec![0.0; columns.len()];
        for row in (0..columns.len()).rev() {
            let known: f64 = (row + 1..columns.len()).map(|column| columns[column][row] * weights[column]).sum();
            weights[row] = (right[row] - known) / columns[row][row];
        }
        for (weight, vector) in weights.iter().zip(&basis) {
            found.iter_mut().zip(vector).for_each(|(x, v)| *x += weight * v);
        }
        columns.len()
    }

    fn dot(&self, a: &[f64], b: &[f64]) -> f64 {
        let rows = a.chunks(self.width).zip(b.chunks(self.width)).zip(&self.transport.areas);
        rows.map(|((a, b), area)| area * a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>()).sum()
    }
}

fn scaled(values: &[f64], factor: f64) -> Vec<f64> {
    values.iter().map(|v| v * factor).collect()
}

/// The largest size of each component.
fn largest(rows: &[f64], width: usize) -> Vec<f64> {
    let mut most = vec![0.0_f64; width];
    for row in rows.chunks(width) {
        most.iter_mut().zip(row).for_each(|(m, v)| *m = m.max(v.abs()));
    }
    most
}
