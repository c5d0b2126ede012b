//! Starts for conjugate gradients where similar systems have been solved: the combination of those solutions whose error is least in
//! the energy norm (Galerkin's method in a reduced basis: A. K. Noor & J. M. Peters, AIAA Journal 18, 1980).
//!
//! X = ρ (h + K X) in the inner product weighted by A/ρ: Σⱼ (Xᵢ, Xⱼ − ρ K Xⱼ) aⱼ = (Xᵢ, ρ h). As ρ is one number for all leaves of one kind, sums
//! over these serve for all ρ.

use rayon::prelude::*;

use super::solve::Solved;

/// A solution is left out where its squared distance from those before it is less than this share of its square.
const ALIKE: f64 = 1e-13;
/// Reflectances below this aren't divided by.
const BLACK: f64 = 1e-100;

/// The leaves that all systems have in common.
#[derive(Clone, Copy)]
pub(super) struct Leaves<'l> {
    pub(super) areas: &'l [f64],
    /// The kind of each leaf.
    pub(super) kind: &'l [usize],
    pub(super) kinds: usize,
}

/// Solutions, and their sums over leaves.
pub(super) struct Basis<'s> {
    solved: &'s Solved,
    count: usize,
    /// For each kind, Σ A Xᵢ Xⱼ for i ≤ j.
    products: Vec<f64>,
    /// Σ A Xᵢ K Xⱼ over all leaves.
    exchanged: Vec<f64>,
    /// For each light, Σ A Xᵢ h.
    received: Vec<Vec<f64>>,
}

impl<'s> Basis<'s> {
    /// From solutions under some lights h.
    pub(super) fn new(solved: &'s Solved, leaves: Leaves<'_>, lights: &[&[f64]]) -> Self {
        let count = solved.residual.len();
        let rows = |of: &'s [f64]| of.chunks(count.max(1)).zip(leaves.areas).zip(leaves.kind);
        let sums = |of: &'s [f64], by_kind: bool| {
            let kinds = if by_kind { leaves.kinds } else { 1 };
            let mut sums = vec![0.0; kinds * count * count];
            for (((other, area), kind), row) in rows(of).zip(solved.reflected.chunks(count.max(1))) {
                let place = if by_kind { kind * count * count } else { 0 };
                for (i, x) in row.iter().enumerate() {
                    let to = &mut sums[place + i * count..][i..count];
                    to.iter_mut().zip(&other[i..]).for_each(|(s, y)| *s += area * x * y);
                }
            }
            sums
        };
        let (products, exchanged) = rayon::join(|| sums(&solved.reflected, true), || sums(&solved.irradiance, false));
        let received = |light: &&[f64]| {
            let mut sums = vec![0.0; count];
            for (((row, area), _), h) in rows(&solved.reflected).zip(*light) {
                sums.iter_mut().zip(row).for_each(|(s, x)| *s += area * x * h);
            }
            sums
        };
        Self { solved, count, products, exchanged, received: lights.iter().map(received).collect() }
    }

    /// The factors of the solutions for the reflectance of each kind and a light by number; none where a kind is black that isn't in all of them.
    pub(super) fn factors(&self, reflectance: &[f64], light: usize) -> Vec<f64> {
        let count = self.count;
        let mut matrix: Vec<f64> = self.exchanged.iter().map(|v| -v).collect();
        for (sums, rho) in self.products.chunks((count * count).max(1)).zip(reflectance) {
            if *rho > BLACK {
                matrix.iter_mut().zip(sums).for_each(|(m, s)| *m += s / rho);
            } else if sums.iter().any(|s| *s != 0.0) {
                return vec![0.0; count];
            }
        }
        let factors = symmetric(&mut matrix, self.received[light].clone());
        if factors.iter().all(|f| f.is_finite()) { factors } else { vec![0.0; count] }
    }

    /// X and K X for some columns of factors.
    pub(super) fn combined(&self, columns: &[Vec<f64>]) -> [Vec<f64>; 2] {
        let width = columns.len();
        // For each solution, its factors in all columns.
        let by_solution: Vec<Vec<f64>> =
            (0..self.count).map(|solution| columns.iter().map(|column| column[solution]).collect()).collect();
        [&self.solved.reflected, &self.solved.irradiance].map(|rows| {
            let mut combined = vec![0.0; rows.len() / self.count.max(1) * width];
            let pairs = combined.par_chunks_mut(width.max(1)).zip(rows.par_chunks(self.count.max(1)));
            pairs.with_min_len(64).for_each(|(to, from)| {
                for (x, factors) in from.iter().zip(&by_solution) {
                    to.iter_mut().zip(factors).for_each(|(t, f)| *t += x * f);
                }
            });
            combined
        })
    }
}

/// Solves a system whose matrix is symmetric and not indefinite, row by row from the diagonal on, by Cholesky's method. What is alike gets 0.
fn symmetric(matrix: &mut [f64], mut right: Vec<f64>) -> Vec<f64> {
    let count = right.len();
    let mut kept = vec![false; count];
    // The upper factor, in place.
    for pivot in 0..count {
        let whole = matrix[pivot * count + pivot];
        let above = (0..pivot).filter(|row| kept[*row]).map(|row| matrix[row * count + pivot].powi(2)).sum::<f64>();
        let left = whole - above;
        kept[pivot] = left > ALIKE * whole;
        if !kept[pivot] {
            continue;
        }
        let root = left.sqrt();
        matrix[pivot * count + pivot] = root;
        for column in pivot + 1..count {
            let known = |row: &usize| matrix[row * count + pivot] * matrix[row * count + column];
            let sum: f64 = (0..pivot).filter(|row| kept[*row]).map(|row| known(&row)).sum();
            matrix[pivot * count + column] = (matrix[pivot * count + column] - sum) / root;
        }
    }
    for row in 0..count {
        let sum: f64 = (0..row).filter(|r| kept[*r]).map(|r| matrix[r * count + row] * right[r]).sum();
        right[row] = if kept[row] { (right[row] - sum) / matrix[row * count + row] } else { 0.0 };
    }
    for row in (0..count).rev().filter(|row| kept[*row]) {
        let sum: f64 = (row + 1..count).filter(|c| kept[*c]).map(|c| matrix[row * count + c] * right[c]).sum();
        right[row] = (right[row] - sum) / matrix[row * count + row];
    }
    right
}

#[cfg(test)]
mod tests {
    use super::{Basis, Leaves};
    use crate::radiosity::majorant::tests::{LEAVES, number, transport};
    use crate::radiosity::solve::System;
    use crate::radiosity::transport::{Buffer, Buffers, Transport};

    /// The reflectances of two kinds of leaves.
    type Pair = [f64; 2];

    fn kinds() -> Vec<usize> {
        (0..LEAVES).map(|leaf| leaf % 2).collect()
    }

    fn light() -> Vec<f64> {
        (0..LEAVES).map(|leaf| number(leaf + 9000)).collect()
    }

    fn system<'t>(transport: &'t Transport, pairs: &[Pair]) -> System<'t> {
        let rows = |leaf: usize| pairs.iter().map(move |pair| pair[leaf % 2]);
        System {
            transport,
            width: pairs.len(),
            reflectance: (0..LEAVES).flat_map(rows).collect(),
            lit: light().iter().flat_map(|h| vec![*h; pairs.len()]).collect(),
            largest_sum: 1.0,
        }
    }

    fn largest(values: impl Iterator<Item = f64>) -> f64 {
        values.fold(0.0, |m: f64, v| m.max(v.abs()))
    }

    /// What a combination leaves is orthogonal to all solutions that it is made of; it is much nearer than any of them, its irradiance is that of
    /// its radiosity, and a solution that is known comes out again.
    #[test]
    fn combinations_are_near_what_has_not_been_solved_for() {
        let (transport, mut buffer) = (transport(), Buffer::default());
        let known: [Pair; 4] = [[0.2, 0.8], [0.4, 0.7], [0.6, 0.5], [0.8, 0.2]];
        let solved = system(&transport, &known).solve(1e-13, &Buffers::default());
        let (kinds, light) = (kinds(), light());
        let basis = Basis::new(&solved, Leaves { areas: &transport.areas, kind: &kinds, kinds: 2 }, &[&light]);
        let of_one = |one: usize| solved.reflected.iter().skip(one).step_by(known.len());
        for pair in [[0.5, 0.6], [0.7, 0.4], known[1]] {
            let exact = system(&transport, &[pair]).solve(1e-13, &Buffers::default()).reflected;
            let [found, irradiance] = basis.combined(&[basis.factors(&pair, 0)]);
            let size = largest(exact.iter().copied());
            for one in 0..known.len() {
                let left = |leaf: usize| light[leaf] + irradiance[leaf] - found[leaf] / pair[leaf % 2];
                let terms = |of: &dyn Fn(usize) -> f64| -> f64 {
                    of_one(one).zip(&transport.areas).enumerate().map(|(leaf, (x, area))| area * x * of(leaf)).sum()
                };
                let (left, whole) = (terms(&left), terms(&|leaf| light[leaf]));
                assert!(left.abs() <= 1e-9 * whole, "{pair:?}, {one}: {left} of {whole}");
            }
            let off = largest(found.iter().zip(&exact).map(|(a, b)| a - b));
            let nearest = (0..known.len()).map(|one| largest(of_one(one).zip(&exact).map(|(a, b)| a - b)));
            let nearest = nearest.fold(f64::INFINITY, f64::min);
            assert!(off <= 0.05 * nearest || off <= 1e-9 * size, "{pair:?}: {off} {nearest}");
            let mut exchanged = vec![0.0; LEAVES];
            transport.apply(&found, &mut exchanged, 1, &mut buffer);
            assert!(largest(exchanged.iter().zip(&irradiance).map(|(a, b)| a - b)) <= 1e-11 * size);
        }
        let found = basis.combined(&[basis.factors(&known[1], 0)]);
        assert!(largest(found[0].iter().zip(of_one(1)).map(|(a, b)| a - b)) <= 1e-9);
    }

    /// A kind that reflects nothing isn't near to solutions where it does.
    #[test]
    fn black_starts_from_nothing() {
        let transport = transport();
        let solved = system(&transport, &[[0.5, 0.5], [0.2, 0.7]]).solve(1e-13, &Buffers::default());
        let (kinds, light) = (kinds(), light());
        let basis = Basis::new(&solved, Leaves { areas: &transport.areas, kind: &kinds, kinds: 2 }, &[&light]);
        assert_eq!(basis.factors(&[0.5, 0.0], 0), [0.0; 2]);
        assert!(basis.factors(&[0.5, 0.4], 0).iter().any(|f| *f > 0.0));
    }
}
