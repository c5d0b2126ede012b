//! Exact integrals of piecewise linear functions, up to rounding: the walk over the pieces that a spectrum and the
//! colour-matching functions share.

use crate::spectrum::interpolate;
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
        let [first, last] = &self.cmf;
        [first[a], last[a]]
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

/// Abscissae (of the half [0, 1]) and weights of Gauss–Legendre quadrature with five points on [−1, 1]: exact to degree 9.
const GAUSS: [[f64; 2]; 3] = [
    [0.0, 0.568_888_888_888_888_9],
    [0.538_469_310_105_683_1, 0.478_628_670_499_366_47],
    [0.906_179_845_938_664, 0.236_926_885_056_189_08],
];

/// The most factors of a product that are integrated exactly: with a colour-matching function, a polynomial of degree 9.
pub(crate) const MAX_FACTORS: usize = 8;

/// ∫ S₁S₂… ā and ∫ |S₁S₂…| ā over [`from`, `to`] in nm, exactly but for rounding; at most [`MAX_FACTORS`] factors count.
pub(crate) fn product_integrals<R: Real>(
    observer: &Observer<'_, R>,
    factors: &[&dyn Spectrum<R>],
    from: R,
    to: R,
) -> [[R; 3]; 2] {
    let mut sums = [[Sum::<R>::default(); 3]; 2];
    let mut position = from;
    while position < to {
        let (cell_end, cmf) = observer.cell(position);
        let mut end = to.min(cell_end);
        for factor in factors.iter().take(MAX_FACTORS) {
            end = end.min(factor.segment(position).end);
        }
        let width = end - position;
        let [first_cmf, last_cmf] = [cmf(position), cmf(end)];
        for [abscissa, gauss_weight] in GAUSS.map(|pair| pair.map(R::from_f64)) {
            // By its share of the way, a point is known far better than by its wavelength.
            let (near, far) = ((R::ONE - abscissa) * R::HALF, (R::ONE + abscissa) * R::HALF);
            let points = [[far, near], [near, far]];
            for [before, after] in points.into_iter().take(if abscissa > R::ZERO { 2 } else { 1 }) {
                let mut product = width * R::HALF * gauss_weight;
                for factor in factors.iter().take(MAX_FACTORS) {
                    let segment = factor.segment(position);
                    let last = interpolate(segment.first, segment.last, width, segment.end - end);
                    product *= segment.first * before + last * after;
                }
                for a in 0..3 {
                    let term = product * (first_cmf[a] * before + last_cmf[a] * after);
                    sums[0][a].add(term);
                    sums[1][a].add(term.abs());
                }
            }
        }
        position = end;
    }
    sums.map(|three| three.map(Sum::value))
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
