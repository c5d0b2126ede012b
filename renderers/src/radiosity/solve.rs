//! The linear system, for several components of the spectrum at once.
//!
//! Reflected radiosity X satisfies X = ρ (H₀ + K X), with H₀ the irradiance of what is sent out by lights. With A K symmetric, so is
//! the matrix of (I − √ρ K √ρ) in the unknowns √(A/ρ) X, positive definite where there is a solution: conjugate gradients need some
//! ten steps even at ρ = 0.999, where Jacobi's iteration would need thousands.

use super::transport::{Buffer, Transport};

/// The most steps.
const MOST_STEPS: usize = 2000;

/// The system for `width` components, leaf by leaf.
pub(super) struct System<'t> {
    pub(super) transport: &'t Transport,
    pub(super) width: usize,
    /// ρ.
    pub(super) reflectance: Vec<f64>,
    /// The part of H₀ from lights without area.
    pub(super) direct: Vec<f64>,
    /// H₀.
    pub(super) lit: Vec<f64>,
    /// The largest row sum of K.
    pub(super) largest_sum: f64,
}

/// The reflected radiosity, and what is known of it.
pub(super) struct Solved {
    pub(super) reflected: Vec<f64>,
    pub(super) steps: usize,
    /// For each component, the largest residual.
    pub(super) residual: Vec<f64>,
}

impl System<'_> {
    /// The result of so many diffuse reflections.
    pub(super) fn bounces(&self, count: u32, buffer: &mut Buffer) -> Solved {
        let mut reflected = vec![0.0; self.lit.len()];
        for step in 0..count {
            reflected = if step == 0 { self.product(&self.lit) } else { self.next(&reflected, buffer) };
        }
        Solved { reflected, steps: count as usize, residual: vec![0.0; self.width] }
    }

    /// All reflections: the error is at most the residual over 1 − ρ ΣF, `tolerance` times the largest radiosity or less.
    pub(super) fn solve(&self, tolerance: f64, buffer: &mut Buffer) -> Solved {
        let symmetric = self.reflectance.iter().all(|r| *r >= 0.0);
        let (found, steps) =
            if symmetric { self.conjugate_gradients(tolerance, buffer) } else { (self.product(&self.lit), 0) };
        self.finish(found, steps, tolerance, if symmetric { 3 } else { MOST_STEPS }, buffer)
    }

    /// 1 / (1 − ρ ΣF) for each component, 1 where this doesn't bound anything.
    pub(super) fn amplification(&self) -> Vec<f64> {
        let mut most = vec![0.0_f64; self.width];
        for row in self.reflectance.chunks(self.width) {
            most.iter_mut().zip(row).for_each(|(m, r)| *m = m.max(r.abs()));
        }
        let bound = |most: f64| if most * self.largest_sum < 1.0 { 1.0 / (1.0 - most * self.largest_sum) } else { 1.0 };
        most.into_iter().map(bound).collect()
    }

    fn product(&self, irradiance: &[f64]) -> Vec<f64> {
        irradiance.iter().zip(&self.reflectance).map(|(h, r)| h * r).collect()
    }

    /// ρ (H₀ + K X).
    fn next(&self, reflected: &[f64], buffer: &mut Buffer) -> Vec<f64> {
        let mut irradiance = vec![0.0; reflected.len()];
        self.transport.apply(reflected, &mut irradiance, self.width, buffer);
        irradiance.iter().zip(&self.lit).zip(&self.reflectance).map(|((k, h), r)| r * (h + k)).collect()
    }

    /// Jacobi's steps, for a residual that is small everywhere.
    fn finish(&self, mut found: Vec<f64>, steps: usize, tolerance: f64, most: usize, buffer: &mut Buffer) -> Solved {
        let amplification = self.amplification();
        let mut residual = vec![0.0; self.width];
        for step in 1..=most {
            let next = self.next(&found, buffer);
            residual = largest_difference(&next, &found, self.width);
            let size = largest_difference(&next, &vec![0.0; next.len()], self.width);
            found = next;
            let good = |i: usize| residual[i] * amplification[i] <= tolerance * size[i];
            if (0..self.width).all(good) {
                return Solved { reflected: found, steps: steps + step, residual };
            }
        }
        Solved { reflected: found, steps: steps + most, residual }
    }

    fn conjugate_gradients(&self, tolerance: f64, buffer: &mut Buffer) -> (Vec<f64>, usize) {
        let width = self.width;
        // √(ρ A), and √(ρ / A): from the unknowns to radiosity.
        let each = |f: &dyn Fn(f64, f64) -> f64| -> Vec<f64> {
            let rows = self.reflectance.chunks(width).zip(&self.transport.areas);
            rows.flat_map(|(row, area)| row.iter().map(|r| f(*r, *area))).collect()
        };
        let weight = each(&|r, a| (r * a).sqrt());
        let to_radiosity = each(&|r, a| (r / a).sqrt());
        let mut residual: Vec<f64> = self.lit.iter().zip(&weight).map(|(h, w)| h * w).collect();
        let mut found = vec![0.0; residual.len()];
        let mut direction = residual.clone();
        let mut squared = dots(&residual, &residual, width);
        let start = squared.clone();
        // The residual's part along the slowest mode is what it is for the final solution.
        let goals: Vec<f64> = self.amplification().iter().map(|a| (0.1 * tolerance / a).powi(2)).collect();
        let mut radiosity = vec![0.0; residual.len()];
        let mut image = vec![0.0; residual.len()];
        for step in 0..MOST_STEPS {
            if (0..width).all(|i| squared[i] <= goals[i] * start[i]) {
                return (scaled(&found, &to_radiosity), step);
            }
            radiosity.iter_mut().zip(&direction).zip(&to_radiosity).for_each(|((b, d), t)| *b = d * t);
            self.transport.apply(&radiosity, &mut image, width, buffer);
            image.iter_mut().zip(&direction).zip(&weight).for_each(|((k, d), w)| *k = d - *k * w);
            let curvature = dots(&direction, &image, width);
            let length: Vec<f64> =
                squared.iter().zip(&curvature).map(|(s, c)| if *c > 0.0 { s / c } else { 0.0 }).collect();
            add(&mut found, &direction, &length, 1.0);
            add(&mut residual, &image, &length, -1.0);
            let next = dots(&residual, &residual, width);
            let turn: Vec<f64> = next.iter().zip(&squared).map(|(n, s)| if *s > 0.0 { n / s } else { 0.0 }).collect();
            for (d_row, r_row) in direction.chunks_mut(width).zip(residual.chunks(width)) {
                d_row.iter_mut().zip(r_row).zip(&turn).for_each(|((d, r), t)| *d = r + t * *d);
            }
            squared = next;
        }
        (scaled(&found, &to_radiosity), MOST_STEPS)
    }
}

fn scaled(values: &[f64], by: &[f64]) -> Vec<f64> {
    values.iter().zip(by).map(|(v, b)| v * b).collect()
}

fn add(to: &mut [f64], from: &[f64], factors: &[f64], sign: f64) {
    for (to, from) in to.chunks_mut(factors.len()).zip(from.chunks(factors.len())) {
        to.iter_mut().zip(from).zip(factors).for_each(|((t, f), k)| *t += sign * k * f);
    }
}

fn dots(a: &[f64], b: &[f64], width: usize) -> Vec<f64> {
    let mut sums = vec![0.0; width];
    for (a, b) in a.chunks(width).zip(b.chunks(width)) {
        sums.iter_mut().zip(a).zip(b).for_each(|((s, a), b)| *s += a * b);
    }
    sums
}

fn largest_difference(a: &[f64], b: &[f64], width: usize) -> Vec<f64> {
    let mut most = vec![0.0_f64; width];
    for (a, b) in a.chunks(width).zip(b.chunks(width)) {
        most.iter_mut().zip(a).zip(b).for_each(|((m, a), b)| *m = m.max((a - b).abs()));
    }
    most
}
