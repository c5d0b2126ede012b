//! Piecewise linear functions of wavelength, and exact integrals of their products.

use spectral_core::tables::{ObserverTable, UniformTable};

use super::wide::Wide;

/// A piecewise linear function of wavelength in nm.
#[derive(Clone, Debug)]
pub struct Polyline {
    wavelengths: Vec<f64>,
    values: Vec<Wide>,
    hold: bool,
}

impl Polyline {
    /// Through values at increasing wavelengths; held outside, or 0 there.
    #[must_use]
    pub fn new(wavelengths: Vec<f64>, values: Vec<Wide>, hold: bool) -> Self {
        Self { wavelengths, values, hold }
    }

    /// A built-in table with its decimals in `f64`.
    #[must_use]
    pub fn of_table(table: &UniformTable, hold: bool) -> Self {
        Self::uniform(table.first, table.step, table.samples.double, hold)
    }

    fn uniform(first: u16, step: u16, samples: &[f64], hold: bool) -> Self {
        let wavelength = |i: usize| f64::from(first) + f64::from(step) * i as f64;
        let values = samples.iter().map(|v| Wide::from(*v)).collect();
        Self { wavelengths: (0..samples.len()).map(wavelength).collect(), values, hold }
    }

    /// x̄, ȳ, z̄ of a built-in observer.
    #[must_use]
    pub fn of_observer(table: &ObserverTable) -> [Self; 3] {
        table.columns.each_ref().map(|column| Self::uniform(table.first, table.step, column.double, false))
    }

    /// The value at a wavelength; at the last node that node's.
    #[must_use]
    pub fn value(&self, wavelength: Wide) -> Wide {
        let last = self.wavelengths.len() - 1;
        if wavelength == self.wavelengths[last] { self.values[last] } else { self.piece(wavelength, wavelength) }
    }

    /// The linear piece that holds one wavelength, taken at another.
    fn piece(&self, within: Wide, at: Wide) -> Wide {
        let above = self.wavelengths.partition_point(|node| within >= *node);
        if above == 0 || above == self.wavelengths.len() {
            let end = if above == 0 { 0 } else { above - 1 };
            return if self.hold { self.values[end] } else { Wide::ZERO };
        }
        let (from, to) = (self.wavelengths[above - 1], self.wavelengths[above]);
        let (first, last) = (self.values[above - 1], self.values[above]);
        first + (last - first) * ((at - from) / (to - from))
    }
}

/// ∫ of a product from one wavelength to another: on each cell where all factors are linear, the polynomial's integral.
#[must_use]
pub fn integral(factors: &[&Polyline], [from, to]: [f64; 2]) -> Wide {
    let mut limits: Vec<f64> = factors.iter().flat_map(|line| line.wavelengths.iter().copied()).collect();
    limits.retain(|w| *w > from && *w < to);
    limits.extend([from, to]);
    limits.sort_by(f64::total_cmp);
    limits.dedup();
    limits.windows(2).fold(Wide::ZERO, |sum, cell| sum + over_cell(factors, cell[0], cell[1]))
}

fn over_cell(factors: &[&Polyline], from: f64, to: f64) -> Wide {
    let (first, last) = (Wide::from(from), Wide::from(to));
    let middle = (first + last) * 0.5;
    // Coefficients of the product in t from 0 to 1.
    let mut product = vec![Wide::ONE];
    for line in factors {
        let (start, end) = (line.piece(middle, first), line.piece(middle, last));
        let slope = end - start;
        let mut next = vec![Wide::ZERO; product.len() + 1];
        for (power, coefficient) in product.iter().enumerate() {
            next[power] += *coefficient * start;
            next[power + 1] += *coefficient * slope;
        }
        product = next;
    }
    let sum = product.iter().enumerate().fold(Wide::ZERO, |sum, (n, c)| sum + *c / (n + 1) as f64);
    sum * (last - first)
}
