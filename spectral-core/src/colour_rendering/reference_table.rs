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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cct::PlanckianLocus;
    use crate::colour_rendering::{EightSamples, EightSums};
    use crate::spectrum::RadiationConstant;
    use crate::summation::SumGrid;
    use crate::tables::observers::CIE_1931_2;

    /// The largest distance of interpolated colours from the functions, over each piece and at its very ends.
    fn largest_error<R: Real>() -> [f64; PIECE_COUNT] {
        let grid = SumGrid::CIE_5NM;
        let observer = grid.observer::<R>(&CIE_1931_2);
        let exact = grid.observer::<f64>(&CIE_1931_2);
        let locus = PlanckianLocus::new(grid, &observer, RadiationConstant::Its1990);
        let exact_locus = PlanckianLocus::new(grid, &exact, RadiationConstant::Its1990);
        let (samples, exact_samples) = (EightSamples::new(grid, &observer), EightSamples::new(grid, &exact));
        let colours = |light: ReferenceLight<R>| {
            let rows = (0..81).map(|index| samples.products(index));
            Some(ReferenceColours::new(&EightSums::new(&light.spectrum(grid, &locus)?, rows)))
        };
        let exact_colours = |light: ReferenceLight<f64>| {
            let rows = (0..81).map(|index| exact_samples.products(index));
            Some(ReferenceColours::new(&EightSums::new(&light.spectrum(grid, &exact_locus)?, rows)))
        };
        let mut worst = [0.0_f64; PIECE_COUNT];
        for (piece, worst) in worst.iter_mut().enumerate() {
            let (kind, first, last) = PIECES[piece];
            let polynomials = ReferencePiece::new(piece, colours).unwrap();
            for step in 0..=500 {
                let mired = first + (last - first) * f64::from(step) / 500.0;
                let temperature = R::from_f64(1e6 / mired);
                if piece_of(ReferenceLight { kind, temperature }) != Some(piece) {
                    // The joint belongs to the piece on its other side; the daylight locus jumps by 1e-4 at 7000 K.
                    continue;
                }
                let found = polynomials.at(piece, temperature).unwrap();
                let expected = exact_colours(ReferenceLight { kind, temperature: temperature.to_f64() }).unwrap();
                let pairs = |found: &[R], expected: &[f64]| {
                    let errors = found.iter().zip(expected).map(|(found, expected)| (found.to_f64() - expected).abs());
                    errors.fold(0.0, f64::max)
                };
                *worst = worst.max(100.0 * pairs(found.white.as_flattened(), expected.white.as_flattened()));
                *worst = worst.max(pairs(found.lab.as_flattened(), expected.lab.as_flattened()));
                *worst = worst.max(pairs(found.uniform.as_flattened(), expected.uniform.as_flattened()));
            }
        }
        worst
    }

    #[test]
    fn polynomials_are_as_accurate_as_stated() {
        let worst = largest_error::<f64>();
        assert!(worst.iter().all(|&error| error <= 1e-11), "{worst:?}");
        let worst = largest_error::<f32>();
        assert!(worst.iter().all(|&error| error <= 3e-4), "{worst:?}");
    }

    /// Every temperature that has a reference light has the piece that it lies in, the joints included.
    #[test]
    fn temperatures_find_their_piece() {
        for step in 0..=240_000 {
            let temperature = 1000.0 + f64::from(step) * 0.1;
            let light = ReferenceLight::for_temperature(temperature).unwrap();
            let (kind, first, last) = PIECES[piece_of(light).unwrap()];
            let mired = 1e6 / temperature;
            assert!(kind == light.kind && mired >= first - 1e-12 && mired <= last + 1e-12, "{temperature} K");
        }
        let piece = |t: f64| piece_of(ReferenceLight::for_temperature(t).unwrap());
        assert_eq!(piece(1000.0_f64.next_down()), None);
        assert_eq!((piece(5000.0_f64.next_down()), piece(5000.0)), (Some(2), Some(1)));
        // 7000 K belongs to the colder branch of the daylight locus.
        assert_eq!((piece(7000.0), piece(7000.0_f64.next_up())), (Some(1), Some(0)));
    }
}
