//! The transport between groups of leaves, as if each group had one radiosity: what smooths out slowly is solved for there.

use super::transport::{Buffer, Transport};

/// Groups that are looked at together.
const WIDTH: usize = 16;

/// Groups of leaves and the operator between them.
#[derive(Clone, Debug)]
pub(super) struct Coarse {
    /// The group of each leaf.
    pub(super) group: Vec<usize>,
    pub(super) areas: Vec<f64>,
    /// Row by row: the mean over a group of K times the indicator of another.
    pub(super) between: Vec<f64>,
    /// Leaf by leaf: K times the indicator of each group, once it has been [found](Self::spread_out).
    pub(super) spread: Vec<f64>,
}

impl Coarse {
    /// From the group of each leaf of a transport, below `count`.
    pub(super) fn new(transport: &Transport, group: Vec<usize>, count: usize, buffer: &mut Buffer) -> Self {
        let mut areas = vec![0.0; count];
        group.iter().zip(&transport.areas).for_each(|(g, a)| areas[*g] += a);
        let mut coarse = Self { group, areas, between: Vec::new(), spread: Vec::new() };
        if let Some(between) = transport.exchanged(&coarse.group, &coarse.areas) {
            coarse.between = between;
        } else {
            coarse.spread_out(transport, buffer);
            coarse.between = coarse.means_of_spread(transport);
        }
        coarse
    }

    /// The means over groups of what leaves receive.
    fn means_of_spread(&self, transport: &Transport) -> Vec<f64> {
        let count = self.count();
        let mut means = vec![0.0; count * count];
        for ((row, group), area) in self.spread.chunks(count.max(1)).zip(&self.group).zip(&transport.areas) {
            let share = area / self.areas[*group];
            means[group * count..][..count].iter_mut().zip(row).for_each(|(m, k)| *m += share * k);
        }
        means
    }

    /// Finds what each leaf receives from each group.
    pub(super) fn spread_out(&mut self, transport: &Transport, buffer: &mut Buffer) {
        if !self.spread.is_empty() {
            return;
        }
        let (leaves, count) = (self.group.len(), self.count());
        self.spread = vec![0.0; leaves * count];
        for first in (0..count).step_by(WIDTH) {
            let width = WIDTH.min(count - first);
            let mut indicator = vec![0.0; leaves * width];
            for (row, g) in indicator.chunks_mut(width).zip(&self.group) {
                if (first..first + width).contains(g) {
                    row[g - first] = 1.0;
                }
            }
            let mut irradiance = vec![0.0; indicator.len()];
            transport.apply(&indicator, &mut irradiance, width, buffer);
            for (row, spread) in irradiance.chunks(width).zip(self.spread.chunks_mut(count)) {
                spread[first..first + width].copy_from_slice(row);
            }
        }
    }

    /// The groups of the groups themselves: each is one.
    pub(super) fn of_itself(&self) -> Self {
        Self {
            group: (0..self.areas.len()).collect(),
            areas: self.areas.clone(),
            between: self.between.clone(),
            spread: self.between.clone(),
        }
    }

    pub(super) fn count(&self) -> usize {
        self.areas.len()
    }
}

/// I − K ρ between groups, in triangular factors, for some components at once.
pub(super) struct Factored<const W: usize> {
    count: usize,
    /// The lower factor, whose diagonal is 1, and the upper one, whose diagonal is inverted.
    factors: Vec<[f64; W]>,
}

impl<const W: usize> Factored<W> {
    /// For the reflectance of each group. Without pivots: columns are dominated by the diagonal where light comes to an end.
    pub(super) fn new(coarse: &Coarse, reflectance: &[[f64; W]]) -> Self {
        let count = coarse.count();
        let mut factors = Vec::with_capacity(count * count);
        for (place, k) in coarse.between.iter().enumerate() {
            let (row, column) = (place / count.max(1), place % count.max(1));
            let one = if row == column { 1.0 } else { 0.0 };
            factors.push(reflectance[column].map(|r| one - k * r));
        }
        for pivot in 0..count {
            let (above, below) = factors.split_at_mut((pivot + 1) * count);
            let row = &mut above[pivot * count..];
            row[pivot] = row[pivot].map(|v| 1.0 / v);
            for other in below.chunks_mut(count) {
                let factor: [f64; W] = core::array::from_fn(|i| other[pivot][i] * row[pivot][i]);
                other[pivot] = factor;
                for (o, r) in other[pivot + 1..].iter_mut().zip(&row[pivot + 1..]) {
                    *o = core::array::from_fn(|i| o[i] - factor[i] * r[i]);
                }
            }
        }
        Self { count, factors }
    }

    /// Solves for a right side, in place.
    pub(super) fn solve(&self, values: &mut [[f64; W]]) {
        let count = self.count;
        let less = |values: &[[f64; W]], from: [f64; W], row: usize, columns: core::ops::Range<usize>| {
            columns.fold(from, |sum, column| {
                let factor = &self.factors[row * count + column];
                core::array::from_fn(|i| sum[i] - factor[i] * values[column][i])
            })
        };
        for row in 0..count {
            values[row] = less(values, values[row], row, 0..row);
        }
        for row in (0..count).rev() {
            let sum = less(values, values[row], row, row + 1..count);
            let inverse = &self.factors[row * count + row];
            values[row] = core::array::from_fn(|i| sum[i] * inverse[i]);
        }
    }
}
