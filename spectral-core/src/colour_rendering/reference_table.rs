//! The colours of the samples under a reference light as piecewise polynomials in its reciprocal temperature.

use super::eight::ReferenceColours;
use super::{ReferenceKind, ReferenceLight};
use crate::Real;

/// Coefficients of a polynomial.
const ORDER: usize = 13;

/// How many pieces there are.
pub(crate) const PIECE_COUNT: usize = 6;

/// The pieces: the family, and the reciprocal temperatures in mired where it begins and ends.
///
/// They meet where the functions are not smooth: at 5000 K, where the family changes, and at 7000 K, where the two branches of
/// the locus of daylight do. The others keep the error alike. Black bodies below 1000 K, too steep for a
/// polynomial, have no piece.
const PIECES: [(ReferenceKind, f64, f64); PIECE_COUNT] = [
    (ReferenceKind::Daylight, 40.0, 1000.0 / 7.0),
    (ReferenceKind::Daylight, 1000.0 / 7.0, 200.0),
    (ReferenceKind::Planckian, 200.0, 300.0),
    (ReferenceKind::Planckian, 300.0, 450.0),
    (ReferenceKind::Planckian, 450.0, 670.0),
    (ReferenceKind::Planckian, 670.0, 1000.0),
];

/// The piece that a reference light belongs to.
pub(crate) fn piece_of<R: Real>(light: ReferenceLight<R>) -> Option<usize> {
    let above = |mired: f64| light.temperature > R::from_f64(1e6 / mired);
    match light.kind {
        ReferenceKind::Daylight => Some(usize::from(!above(1000.0 / 7.0))),
        ReferenceKind::Planckian if above(300.0) => Some(2),
        ReferenceKind::Planckian if above(450.0) => Some(3),
        ReferenceKind::Planckian if above(670.0) => Some(4),
        ReferenceKind::Planckian if light.temperature >= R::from_f64(1000.0) => Some(5),
        ReferenceKind::Planckian => None,
    }
}

/// The colours under the reference lights of one piece.
///
/// The polynomials take on the values at 13 Chebyshev nodes. They are within 1e-11 of the functions, whose values are up to 100.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ReferencePiece<R> {
    /// By power of the position in [−1, 1].
    coefficients: [ReferenceColours<R>; ORDER],
}

impl<R: Real> ReferencePiece<R> {
    /// Interpolates the colours in a piece; `None` when they are not known somewhere in it.
    pub(crate) fn new(
        piece: usize,
        mut colours: impl FnMut(ReferenceLight<R>) -> Option<ReferenceColours<R>>,
    ) -> Option<Self> {
        let &(kind, first, last) = PIECES.get(piece)?;
        let angle = |node: usize| R::PI * (R::from_usize(node) + R::HALF) / R::from_usize(ORDER);
        let mut series = [ReferenceColours::zero(); ORDER];
        for node in 0..ORDER {
            let position = angle(node).cos();
            let mired = R::from_f64(0.5 * (first + last)) + R::from_f64(0.5 * (last - first)) * position;
            let value = colours(ReferenceLight { kind, temperature: R::from_f64(1e6) / mired })?;
            for (degree, sum) in series.iter_mut().enumerate() {
                let weight = if degree == 0 { R::ONE } else { R::TWO };
                let wave = (R::from_usize(degree) * angle(node)).cos();
                sum.add(&value, weight * wave / R::from_usize(ORDER));
            }
        }
        Some(Self { coefficients: powers(&series) })
    }

    /// The colours under a reference light of the piece.
    #[inline]
    pub(crate) fn at(&self, piece: usize, temperature: R) -> Option<ReferenceColours<R>> {
        let &(_, first, last) = PIECES.get(piece)?;
        let mired = R::from_f64(1e6) / temperature;
        let position = (mired - R::from_f64(0.5 * (first + last))) * R::from_f64(2.0 / (last - first));
        Some(ReferenceColours {
            white: self.horner(position, |colours| &colours.white),
            lab: self.horner(position, |colours| &colours.lab),
            uniform: self.horner(position, |colours| &colours.uniform),
        })
    }

    /// Not inlined, so that all sums of a part find room in vector registers.
    #[inline(never)]
    fn horner<const W: usize, const C: usize>(
        &self,
        position: R,
        part: impl Fn(&ReferenceColours<R>) -> &[[R; W]; C],
    ) -> [[R; W]; C] {
        let mut sums = [[R::ZERO; W]; C];
        for coefficients in self.coefficients.iter().rev() {
            let coefficients = part(coefficients).as_flattened();
            for (sum, &coefficient) in sums.as_flattened_mut().iter_mut().zip(coefficients) {
                *sum = *sum * position + coefficient;
            }
        }
        sums
    }
}

/// The coefficients of powers from those of a Chebyshev series.
///
/// These fall so fast here that the large coefficients of the Chebyshev polynomials of high degree do not matter.
fn powers<R: Real>(series: &[ReferenceColours<R>; ORDER]) -> [ReferenceColours<R>; ORDER] {
    let mut result = [ReferenceColours::zero(); ORDER];
    let (mut chebyshev, mut next) = ([R::ZERO; ORDER], [R::ZERO; ORDER]);
    chebyshev[0] = R::ONE;
    next[1] = R::ONE;
    for value in series {
        for (sum, &weight) in result.iter_mut().zip(&chebyshev) {
            sum.add(value, weight);
        }
        let mut after = [R::ZERO; ORDER];
        for (power, after) in after.iter_mut().enumerate() {
            let raised = if power == 0 { R::ZERO } else { next[power - 1] };
            *after = R::TWO * raised - chebyshev[power];
        }
        (chebyshev, next) = (next, after);
    }
    result
}
