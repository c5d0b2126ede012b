//! Exact integrals of piecewise linear functions, up to rounding: the walk over the pieces that a spectrum and the
//! colour-matching functions share.

use crate::spectrum::{Segment, interpolate};
use crate::{Observer, Real, Spectrum};

/// A running sum with Neumaier's compensation: the result is within 2 ulp of the exact sum of the rounded terms as long
/// as their number is far below 1/ε.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Sum<R> {
    total: R,
    lost: R,
}

impl<R: Real> Sum<R> {
    pub(crate) fn add(&mut self, term: R) {
        let next = self.total + term;
        self.lost +=
            if self.total.abs() >= term.abs() { (self.total - next) + term } else { (term - next) + self.total };
        self.total = next;
    }
    pub(crate) fn value(self) -> R {
        self.total + self.lost
    }
}

/// A stretch of wavelengths on which both the spectrum and the colour-matching functions are linear.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Piece<R> {
    /// Width in nm.
    pub(crate) width: R,
    /// The spectrum at both ends.
    pub(crate) value: [R; 2],
    /// The colour-matching functions at both ends.
    pub(crate) cmf: [[R; 3]; 2],
}

impl<R: Real> Piece<R> {
    /// The weights of `f(first end)` and `f(last end)` in ∫ f ā over the piece, for f linear and channel `a`.
    fn weights(&self, a: usize) -> [R; 2] {
        let [first, last] = self.channel(a);
        let sixth = self.width / R::from_f64(6.0);
        [sixth * (R::TWO * first + last), sixth * (first + R::TWO * last)]
    }

    fn channel(&self, a: usize) -> [R; 2] {
        // Not by index: a panic would stay where this is not inlined.
        self.cmf.map(|[x, y, z]| match a {
            0 => x,
            1 => y,
            _ => z,
        })
    }

    /// ∫ S ā.
    pub(crate) fn integral(&self, a: usize) -> R {
        let [first, last] = self.weights(a);
        first * self.value[0] + last * self.value[1]
    }

    /// ∫ ā.
    pub(crate) fn weight(&self, a: usize) -> R {
        let [first, last] = self.channel(a);
        self.width * R::HALF * (first + last)
    }

    /// ∫ |S| ā.
    pub(crate) fn magnitude(&self, a: usize) -> R {
        self.absolute(a, R::ZERO)
    }

    /// ∫ |S − centre| ā.
    pub(crate) fn absolute(&self, a: usize, centre: R) -> R {
        let first = self.value[0] - centre;
        let last = self.value[1] - centre;
        let [w0, w1] = self.weights(a);
        // By signs: the product of small numbers underflows.
        if (first >= R::ZERO) == (last >= R::ZERO) {
            return (first * w0 + last * w1).abs();
        }
        // The difference changes sign inside: two triangles, each against a linear weight.
        let [a0, a1] = self.channel(a);
        let crossing = first / (first - last);
        let middle = a0 + (a1 - a0) * crossing;
        let left = first.abs() * crossing * (R::TWO * a0 + middle);
        let right = last.abs() * (R::ONE - crossing) * (middle + R::TWO * a1);
        (left + right) * self.width / R::from_f64(6.0)
    }

    /// ∫ ((S − centre) / unit)² ā: with a unit of S's size, squares neither overflow nor underflow.
    pub(crate) fn square(&self, a: usize, centre: R, unit: R) -> R {
        let first = (self.value[0] - centre) / unit;
        let last = (self.value[1] - centre) / unit;
        let [a0, a1] = self.channel(a);
        let three = R::from_f64(3.0);
        let sum =
            first * first * (three * a0 + a1) + R::TWO * first * last * (a0 + a1) + last * last * (a0 + three * a1);
        (sum * self.width / R::from_f64(12.0)).max(R::ZERO)
    }
}

/// Calls `visit` for each piece of [`from`, `to`] (nm, finite, `from` ≤ `to`), in increasing order of wavelength.
pub(crate) fn for_each_piece<R: Real, S: Spectrum<R> + ?Sized>(
    observer: &Observer<R>,
    spectrum: &S,
    from: R,
    to: R,
    mut visit: impl FnMut(Piece<R>),
) {
    let mut position = from;
    let mut start = from;
    let mut segment = spectrum.segment(from);
    while position < to {
        let (cell_end, cmf) = observer.cell(position);
        let end = to.min(segment.end).min(cell_end);
        let at = |wavelength: R| {
            if segment.end.is_finite() {
                let (below, above) = (wavelength - start, segment.end - wavelength);
                interpolate(segment.first, segment.last, below, above)
            } else {
                segment.first
            }
        };
        visit(Piece { width: end - position, value: [at(position), at(end)], cmf: [cmf(position), cmf(end)] });
        if end >= segment.end {
            start = segment.end;
            segment = spectrum.segment(segment.end);
        }
        position = end;
    }
}

/// Abscissae in [0, 1], their distances from 1, and weights of Gauss–Legendre quadrature with five points: exact to degree 9.
const GAUSS: [[f64; 3]; 5] = [
    [0.046_910_077_030_668, 0.953_089_922_969_332, 0.118_463_442_528_094_54],
    [0.230_765_344_947_158_46, 0.769_234_655_052_841_5, 0.239_314_335_249_683_23],
    [0.5, 0.5, 0.284_444_444_444_444_44],
    [0.769_234_655_052_841_5, 0.230_765_344_947_158_46, 0.239_314_335_249_683_23],
    [0.953_089_922_969_332, 0.046_910_077_030_668, 0.118_463_442_528_094_54],
];

/// The most factors of a product that are integrated exactly: with a colour-matching function, a polynomial of degree 9.
pub(crate) const MAX_FACTORS: usize = 8;

/// The integrals of a product of spectra.
pub(crate) struct ProductIntegrals<R> {
    /// ∫ S₁S₂… ā.
    pub(crate) values: [R; 3],
    /// ∫ |S₁S₂…| ā.
    pub(crate) sizes: [R; 3],
    /// At least the factor by which what underflows in a partial product can have grown.
    pub(crate) growth: R,
}

/// The integrals of a product over [`from`, `to`] in nm, exact but for rounding; at most [`MAX_FACTORS`] factors count.
///
/// On each piece where all is linear, functions are interpolated between the piece's ends by the abscissae themselves:
/// wavelengths would be too coarse on pieces of a narrow line.
pub(crate) fn product_integrals<R: Real>(
    observer: &Observer<'_, R>,
    factors: &[&dyn Spectrum<R>],
    from: R,
    to: R,
) -> ProductIntegrals<R> {
    let mut sums = [[Sum::<R>::default(); 3]; 2];
    let mut growth = R::ONE;
    let mut position = from;
    while position < to {
        let (cell_end, cmf) = observer.cell(position);
        let end = factors.iter().take(MAX_FACTORS).fold(to.min(cell_end), |end, f| end.min(f.segment(position).end));
        let mut ends = [[R::ONE; 2]; MAX_FACTORS];
        let mut grown = R::ONE;
        for (ends, factor) in ends.iter_mut().zip(factors) {
            *ends = ends_of(&factor.segment(position), position, end);
            grown = R::ONE.max(grown * ends[0].abs().max(ends[1].abs()));
        }
        growth = growth.max(grown);
        let cmf = [cmf(position), cmf(end)];
        for [below, above, weight] in GAUSS.map(|three| three.map(R::from_f64)) {
            let product = ends
                .iter()
                .take(factors.len())
                .fold((end - position) * weight, |product, [first, last]| product * (*first * above + *last * below));
            for a in 0..3 {
                let term = product * (cmf[0][a] * above + cmf[1][a] * below);
                sums[0][a].add(term);
                sums[1][a].add(term.abs());
            }
        }
        position = end;
    }
    let [values, sizes] = sums.map(|three| three.map(Sum::value));
    ProductIntegrals { values, sizes, growth }
}

/// The values of a linear piece that starts at `start`, there and at `end` in it.
fn ends_of<R: Real>(segment: &Segment<R>, start: R, end: R) -> [R; 2] {
    let last = if segment.end.is_finite() {
        interpolate(segment.first, segment.last, end - start, segment.end - end)
    } else {
        segment.first
    };
    [segment.first, last]
}

/// ∫ S ā over [`from`, `to`] in nm for the three colour-matching functions of an observer: tristimulus values in the
/// spectrum's unit times nm, without any normalisation.
///
/// Exact for the piecewise linear functions but for rounding: the relative error is below 16 ε for non-negative
/// spectra. The observer is 0 outside its table. Returns zeros when `from` ≥ `to` or a limit is not finite.
pub fn tristimulus<R: Real, S: Spectrum<R> + ?Sized>(observer: &Observer<R>, spectrum: &S, from: R, to: R) -> [R; 3] {
    let mut sums = [Sum::<R>::default(); 3];
    if from.is_finite() && to.is_finite() {
        for_each_piece(observer, spectrum, from, to, |piece| {
            for (a, sum) in sums.iter_mut().enumerate() {
                sum.add(piece.integral(a));
            }
        });
    }
    sums.map(Sum::value)
}
