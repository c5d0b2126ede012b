//! The linear system, for several components of the spectrum at once.
//!
//! Reflected radiosity X satisfies X = ρ (H₀ + K X), with H₀ the irradiance of what is sent out by lights. With A K symmetric, I − ρ K is
//! symmetric and positive definite in the inner product weighted by A/ρ, where there is a solution: conjugate gradients need some
//! ten steps even at ρ = 0.999, where Jacobi's iteration would need thousands.

use alloc::borrow::Cow;

use rayon::prelude::*;

use super::transport::{Buffer, Buffers, Transport};

/// The most steps.
const MOST_STEPS: usize = 2000;
/// Components that one task solves for: as many as fit in registers and caches.
const LANES: usize = 8;
/// Reflectances below this have no weight in inner products, which would be infinite; what they reflect is far below rounding.
const BLACK: f64 = 1e-100;

/// The system for `width` components, leaf by leaf.
pub(super) struct System<'t> {
    pub(super) transport: &'t Transport,
    pub(super) width: usize,
    /// ρ.
    pub(super) reflectance: Vec<f64>,
    /// H₀.
    pub(super) lit: Vec<f64>,
    /// The largest row sum of K.
    pub(super) largest_sum: f64,
}

/// The reflected radiosity X, and what is known of it.
pub(super) struct Solved {
    pub(super) reflected: Vec<f64>,
    /// K X.
    pub(super) irradiance: Vec<f64>,
    pub(super) steps: usize,
    /// How often a component was carried through the operator.
    pub(super) passes: usize,
    /// For each component, the largest residual.
    pub(super) residual: Vec<f64>,
}

impl Solved {
    /// The components of several solutions, one after the other.
    pub(super) fn side_by_side(some: &[&Self]) -> Self {
        let width: usize = some.iter().map(|some| some.residual.len()).sum();
        let length: usize = some.iter().map(|some| some.reflected.len()).sum();
        let rows = |of: fn(&Self) -> &[f64]| {
            let mut all = Vec::with_capacity(length);
            let mut rows: Vec<_> = some.iter().map(|some| of(some).chunks(some.residual.len().max(1))).collect();
            for _ in 0..length / width.max(1) {
                rows.iter_mut().filter_map(Iterator::next).for_each(|row| all.extend_from_slice(row));
            }
            all
        };
        Self {
            reflected: rows(|some| &some.reflected),
            irradiance: rows(|some| &some.irradiance),
            steps: some.iter().map(|some| some.steps).max().unwrap_or(0),
            passes: some.iter().map(|some| some.passes).sum(),
            residual: some.iter().flat_map(|some| some.residual.iter().copied()).collect(),
        }
    }
}

/// Some components, in rows of a width that is known in advance.
struct Lanes<'b, const W: usize> {
    reflectance: Cow<'b, [[f64; W]]>,
    lit: Cow<'b, [[f64; W]]>,
    amplification: [f64; W],
    buffer: &'b mut Buffer,
}

impl System<'_> {
    /// The result of so many diffuse reflections.
    pub(super) fn bounces(&self, count: u32, buffer: &mut Buffer) -> Solved {
        let mut reflected = vec![0.0; self.lit.len()];
        let mut irradiance = vec![0.0; self.lit.len()];
        for _ in 0..count {
            let all = reflected.iter_mut().zip(&irradiance).zip(&self.lit).zip(&self.reflectance);
            all.for_each(|(((x, k), h), r)| *x = r * (h + k));
            self.transport.apply(&reflected, &mut irradiance, self.width, buffer);
        }
        let steps = count as usize;
        Solved { reflected, irradiance, steps, passes: steps * self.width, residual: vec![0.0; self.width] }
    }

    /// All reflections: the error is at most the residual over 1 − ρ ΣF, `tolerance` times the largest radiosity or less.
    ///
    /// Components are shared out among threads, always the same ones together.
    pub(super) fn solve(&self, tolerance: f64, buffers: &Buffers) -> Solved {
        self.solve_from(None, tolerance, buffers)
    }

    /// The same from what may be near to X, and K times that.
    pub(super) fn solve_from(&self, start: Option<&[Vec<f64>; 2]>, tolerance: f64, buffers: &Buffers) -> Solved {
        let tasks = self.width.div_ceil(LANES);
        let solve = |some| buffers.lend(|buffer| self.solve_some(some, start, tolerance, buffer));
        if tasks == 1 {
            return solve([0, self.width]);
        }
        let solved: Vec<Solved> = (0..tasks)
            .into_par_iter()
            .map(|task| solve([task * LANES, LANES.min(self.width - task * LANES)]))
            .collect();
        Solved::side_by_side(&solved.iter().collect::<Vec<_>>())
    }

    /// Up to [`LANES`] components.
    fn solve_some(
        &self,
        [first, width]: [usize; 2],
        start: Option<&[Vec<f64>; 2]>,
        tolerance: f64,
        buffer: &mut Buffer,
    ) -> Solved {
        match width {
            1 => self.solve_lanes::<1>(first, start, tolerance, buffer),
            2 => self.solve_lanes::<2>(first, start, tolerance, buffer),
            3 => self.solve_lanes::<3>(first, start, tolerance, buffer),
            4 => self.solve_lanes::<4>(first, start, tolerance, buffer),
            5 => self.solve_lanes::<5>(first, start, tolerance, buffer),
            6 => self.solve_lanes::<6>(first, start, tolerance, buffer),
            7 => self.solve_lanes::<7>(first, start, tolerance, buffer),
            _ => self.solve_lanes::<LANES>(first, start, tolerance, buffer),
        }
    }

    fn solve_lanes<const W: usize>(
        &self,
        first: usize,
        start: Option<&[Vec<f64>; 2]>,
        tolerance: f64,
        buffer: &mut Buffer,
    ) -> Solved {
        let reflectance: Cow<'_, [[f64; W]]> = self.lanes(&self.reflectance, first);
        let symmetric = reflectance.as_flattened().iter().all(|r| *r >= 0.0);
        let amplification = amplification(&reflectance, self.largest_sum);
        let mut lanes = Lanes { reflectance, lit: self.lanes(&self.lit, first), amplification, buffer };
        if symmetric {
            let (found, steps) = lanes.conjugate_gradients(
                self.transport,
                start.map(|[x, k]| [self.lanes(x, first), self.lanes(k, first)]),
                tolerance,
            );
            lanes.finish(self.transport, found, steps, tolerance, 3)
        } else {
            let once = lanes.reflectance.iter().zip(&*lanes.lit).map(|(r, h)| each(|i| r[i] * h[i])).collect();
            lanes.finish(self.transport, once, 0, tolerance, MOST_STEPS)
        }
    }

    /// Some components of all rows, which aren't copied where there are no others.
    fn lanes<'r, const W: usize>(&self, rows: &'r [f64], first: usize) -> Cow<'r, [[f64; W]]> {
        if self.width == W {
            return Cow::Borrowed(rows.as_chunks().0);
        }
        Cow::Owned(rows.chunks(self.width).map(|row| each(|i| row[first + i])).collect())
    }

    /// 1 / (1 − ρ ΣF) for each component, 1 where this doesn't bound anything.
    pub(super) fn amplification(&self) -> Vec<f64> {
        let mut most = vec![0.0_f64; self.width];
        for row in self.reflectance.chunks(self.width) {
            most.iter_mut().zip(row).for_each(|(m, r)| *m = m.max(r.abs()));
        }
        most.into_iter().map(|most| amplified(most * self.largest_sum)).collect()
    }
}

fn each<const W: usize>(f: impl FnMut(usize) -> f64) -> [f64; W] {
    core::array::from_fn(f)
}

/// 1 / (1 − `most`), 1 where this doesn't bound anything.
fn amplified(most: f64) -> f64 {
    if most < 1.0 { 1.0 / (1.0 - most) } else { 1.0 }
}

fn amplification<const W: usize>(reflectance: &[[f64; W]], largest_sum: f64) -> [f64; W] {
    let most = reflectance.iter().fold([0.0_f64; W], |most, row| each(|i| most[i].max(row[i].abs())));
    most.map(|most| amplified(most * largest_sum))
}

impl<const W: usize> Lanes<'_, W> {
    /// Jacobi's steps, for a residual that is small everywhere; at least one is made to know it, at most `most`.
    fn finish(
        &mut self,
        transport: &Transport,
        mut found: Vec<[f64; W]>,
        steps: usize,
        tolerance: f64,
        most: usize,
    ) -> Solved {
        let mut irradiance = vec![[0.0; W]; found.len()];
        let mut step = 0;
        loop {
            step += 1;
            transport.apply_rows(&found, &mut irradiance, self.buffer);
            let (mut residual, mut size) = ([0.0_f64; W], [0.0_f64; W]);
            let next = |place: usize| -> [f64; W] {
                let (rho, lit, k) = (&self.reflectance[place], &self.lit[place], &irradiance[place]);
                each(|i| rho[i] * (lit[i] + k[i]))
            };
            for (place, x) in found.iter().enumerate() {
                let next = next(place);
                residual = each(|i| residual[i].max((next[i] - x[i]).abs()));
                size = each(|i| size[i].max(next[i].abs()));
            }
            let good = |i: usize| residual[i] * self.amplification[i] <= tolerance * size[i];
            if (0..W).all(good) || step >= most {
                let passes = (steps + step) * W;
                let [reflected, irradiance] = [found, irradiance].map(Vec::into_flattened);
                return Solved { reflected, irradiance, steps: steps + step, passes, residual: residual.to_vec() };
            }
            found.iter_mut().enumerate().for_each(|(place, x)| *x = next(place));
        }
    }

    /// An approximate solution and the number of steps; all rows are preconditioned with ρ/A, so that residuals are those of Jacobi's iteration.
    fn conjugate_gradients(
        &mut self,
        transport: &Transport,
        start: Option<[Cow<'_, [[f64; W]]>; 2]>,
        tolerance: f64,
    ) -> (Vec<[f64; W]>, usize) {
        let weight: Vec<[f64; W]> = self
            .reflectance
            .iter()
            .zip(&transport.areas)
            .map(|(row, area)| row.map(|r| if r > BLACK { area / r } else { 0.0 }))
            .collect();
        let mut residual: Vec<[f64; W]> =
            self.reflectance.iter().zip(&*self.lit).map(|(r, h)| each(|i| r[i] * h[i])).collect();
        let length_of = |rows: &[[f64; W]]| {
            rows.iter().zip(&weight).fold([0.0; W], |sum, (r, w)| each(|i| sum[i] + r[i] * r[i] * w[i]))
        };
        let mut squared = length_of(&residual);
        // The residual's part along the slowest mode is what it is for the final solution.
        let goals: [f64; W] = each(|i| (0.1 * tolerance / self.amplification[i]).powi(2) * squared[i]);
        let mut found = vec![[0.0; W]; residual.len()];
        if let Some([x, k]) = start {
            for (((residual, x), k), rho) in residual.iter_mut().zip(&*x).zip(&*k).zip(&*self.reflectance) {
                *residual = each(|i| residual[i] + rho[i] * k[i] - x[i]);
            }
            squared = length_of(&residual);
            found.copy_from_slice(&x);
        }
        let mut direction = residual.clone();
        let mut image = vec![[0.0; W]; residual.len()];
        for step in 0..MOST_STEPS {
            if (0..W).all(|i| squared[i] <= goals[i]) {
                return (found, step);
            }
            transport.apply_rows(&direction, &mut image, self.buffer);
            let mut curvature = [0.0; W];
            for (((k, d), r), w) in image.iter_mut().zip(&direction).zip(&*self.reflectance).zip(&weight) {
                *k = each(|i| d[i] - r[i] * k[i]);
                curvature = each(|i| curvature[i] + d[i] * k[i] * w[i]);
            }
            let length: [f64; W] = each(|i| if curvature[i] > 0.0 { squared[i] / curvature[i] } else { 0.0 });
            let mut next = [0.0; W];
            let rows = found.iter_mut().zip(&mut residual).zip(&direction).zip(&image).zip(&weight);
            for ((((x, r), d), k), w) in rows {
                *x = each(|i| x[i] + length[i] * d[i]);
                *r = each(|i| r[i] - length[i] * k[i]);
                next = each(|i| next[i] + r[i] * r[i] * w[i]);
            }
            let turn: [f64; W] = each(|i| if squared[i] > 0.0 { next[i] / squared[i] } else { 0.0 });
            for (d, r) in direction.iter_mut().zip(&residual) {
                *d = each(|i| r[i] + turn[i] * d[i]);
            }
            squared = next;
        }
        (found, MOST_STEPS)
    }
}
