//! The colours of the samples under a reference light as piecewise polynomials in its reciprocal temperature.

use super::eight::{EightSums, ReferenceColours, set};
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
        sums: impl FnMut(ReferenceLight<R>, &mut EightSums<R>) -> Option<()>,
    ) -> Option<Self> {
        let mut nodes = [EightSums::zero(); ORDER];
        sum_nodes(&mut nodes, PIECES.get(piece)?, sums)?;
        let mut coefficients = [ReferenceColours::zero(); ORDER];
        let white = powers_of(&nodes, super::eight::EightSums::relative_white);
        for (power, colours) in coefficients.iter_mut().enumerate() {
            let [x, _, z] = at(&white, power);
            colours.white = [[x, z]];
        }
        for sample in 0..8 {
            let (lab, uniform) = (powers_of(&nodes, |s| s.lab(sample)), powers_of(&nodes, |s| s.uniform(sample)));
            for (power, colours) in coefficients.iter_mut().enumerate() {
                set(&mut colours.lab, sample, at(&lab, power));
                set(&mut colours.uniform, sample, at(&uniform, power));
            }
        }
        Some(Self { coefficients })
    }

    /// The colours under a reference light of the piece.
    #[inline]
    pub(crate) fn at(&self, piece: usize, temperature: R) -> Option<ReferenceColours<R>> {
        let position = position(PIECES.get(piece)?, temperature);
        Some(ReferenceColours {
            white: self.horner(position, |colours| &colours.white),
            lab: self.horner(position, |colours| &colours.lab),
            uniform: self.horner(position, |colours| &colours.uniform),
        })
    }

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

/// What [`ReferencePiece::at`] gives, to the bit, without keeping the polynomials.
#[inline(never)]
pub(crate) fn interpolated<R: Real>(
    piece: usize,
    temperature: R,
    sums: impl FnMut(ReferenceLight<R>, &mut EightSums<R>) -> Option<()>,
) -> Option<ReferenceColours<R>> {
    let piece = PIECES.get(piece)?;
    let mut nodes = [EightSums::zero(); ORDER];
    sum_nodes(&mut nodes, piece, sums)?;
    let position = position(piece, temperature);
    let [x, _, z] = values_at(position, &nodes, super::eight::EightSums::relative_white);
    let mut found = ReferenceColours { white: [[x, z]], ..ReferenceColours::zero() };
    for sample in 0..8 {
        set(&mut found.lab, sample, values_at(position, &nodes, |sums| sums.lab(sample)));
        set(&mut found.uniform, sample, values_at(position, &nodes, |sums| sums.uniform(sample)));
    }
    Some(found)
}

/// The place of a temperature in a piece, from −1 to 1.
fn position<R: Real>(&(_, first, last): &(ReferenceKind, f64, f64), temperature: R) -> R {
    let mired = R::from_f64(1e6) / temperature;
    (mired - R::from_f64(0.5 * (first + last))) * R::from_f64(2.0 / (last - first))
}

/// Writes the sums under the reference lights at the Chebyshev nodes of a piece.
fn sum_nodes<R: Real>(
    nodes: &mut [EightSums<R>; ORDER],
    &(kind, first, last): &(ReferenceKind, f64, f64),
    mut sums: impl FnMut(ReferenceLight<R>, &mut EightSums<R>) -> Option<()>,
) -> Option<()> {
    for (node, place) in nodes.iter_mut().enumerate() {
        let mired = R::from_f64(0.5 * (first + last)) + R::from_f64(0.5 * (last - first)) * wave(2 * node + 1);
        sums(ReferenceLight { kind, temperature: R::from_f64(1e6) / mired }, place)?;
    }
    Some(())
}

/// The polynomials of three functions of the sums, which are known at all nodes.
fn powers_of<R: Real>(nodes: &[EightSums<R>; ORDER], functions: impl Fn(&EightSums<R>) -> [R; 3]) -> [[R; ORDER]; 3] {
    let mut columns = [[R::ZERO; ORDER]; 3];
    for (node, sums) in nodes.iter().enumerate() {
        for (column, value) in columns.iter_mut().zip(functions(sums)) {
            if let Some(place) = column.get_mut(node) {
                *place = value;
            }
        }
    }
    for column in &mut columns {
        power_coefficients(column);
    }
    columns
}

/// The values of such polynomials at a position.
#[inline(never)]
fn values_at<R: Real>(
    position: R,
    nodes: &[EightSums<R>; ORDER],
    functions: impl Fn(&EightSums<R>) -> [R; 3],
) -> [R; 3] {
    let horner = |powers: &[R; ORDER]| powers.iter().rev().fold(R::ZERO, |sum, &power| sum * position + power);
    powers_of(nodes, functions).each_ref().map(horner)
}

/// The entry of each list at an index.
fn at<R: Real>(lists: &[[R; ORDER]; 3], index: usize) -> [R; 3] {
    lists.each_ref().map(|list| list.get(index).copied().unwrap_or(R::ZERO))
}

/// cos(π m / 26) of whole numbers up to 13: the cosines of Chebyshev's nodes times the degrees are among them.
const WAVES: [f64; ORDER + 1] = [
    1.0,
    0.992_708_874_098_054,
    0.970_941_817_426_052,
    0.935_016_242_685_414_8,
    0.885_456_025_653_209_9,
    0.822_983_865_893_656_4,
    0.748_510_748_171_101_1,
    0.663_122_658_240_795_2,
    0.568_064_746_731_155_8,
    0.464_723_172_043_768_56,
    0.354_604_887_042_535_6,
    0.239_315_664_287_557_77,
    0.120_536_680_255_323_05,
    0.0,
];

/// cos(π m / 26) of any whole number.
fn wave<R: Real>(m: usize) -> R {
    let turn = m % (4 * ORDER);
    let half = turn.min(4 * ORDER - turn);
    let cosine = WAVES.get(half.min(2 * ORDER - half)).copied().unwrap_or(0.0);
    R::from_f64(if half > ORDER { -cosine } else { cosine })
}

/// Turns the values at the nodes into the coefficients of the powers of the position.
///
/// Those of the Chebyshev series fall so fast here that the large coefficients of Chebyshev polynomials of high degree do
/// not matter.
#[inline(never)]
fn power_coefficients<R: Real>(values: &mut [R; ORDER]) {
    let mut powers = [R::ZERO; ORDER];
    for (degree, chebyshev) in CHEBYSHEV.iter().enumerate() {
        let mut sum = R::ZERO;
        for (node, &value) in values.iter().enumerate() {
            sum += value * wave(degree * (2 * node + 1));
        }
        let weight = if degree == 0 { R::ONE } else { R::TWO };
        let coefficient = sum * (weight / R::from_usize(ORDER));
        // Every other power is absent, and those above the degree.
        for (power, &factor) in powers.iter_mut().zip(chebyshev).take(degree + 1).skip(degree % 2).step_by(2) {
            *power += coefficient * R::from_f64(f64::from(factor));
        }
    }
    *values = powers;
}

/// The coefficients of the Chebyshev polynomials by degree and power: T₀ = 1, T₁ = x, Tₙ₊₁ = 2 x Tₙ − Tₙ₋₁.
static CHEBYSHEV: [[i16; ORDER]; ORDER] = chebyshev();

const fn chebyshev() -> [[i16; ORDER]; ORDER] {
    let mut table = [[0; ORDER]; ORDER];
    table[0][0] = 1;
    table[1][1] = 1;
    let mut degree = 2;
    while degree < ORDER {
        let mut power = 0;
        while power <= degree {
            let raised = if power > 0 { 2 * table[degree - 1][power - 1] } else { 0 };
            table[degree][power] = raised - table[degree - 2][power];
            power += 1;
        }
        degree += 1;
    }
    table
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cct::PlanckianLocus;
    use crate::colour_rendering::EightSamples;
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
        let samples = EightSamples::new(grid);
        let sums = |light: ReferenceLight<R>, sums: &mut EightSums<R>| {
            samples.sum(light.spectrum(grid, &locus)?.into_iter(), sums);
            Some(())
        };
        let exact_colours = |light: ReferenceLight<f64>| {
            let rows = (0..81).map(|index| samples.products(index));
            Some(ReferenceColours::new(&EightSums::new(light.spectrum(grid, &exact_locus)?.into_iter(), rows)))
        };
        let mut worst = [0.0_f64; PIECE_COUNT];
        for (piece, worst) in worst.iter_mut().enumerate() {
            let (kind, first, last) = PIECES[piece];
            let polynomials = ReferencePiece::new(piece, sums).unwrap();
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

    /// `independent`: the cosine of `libm`, and the recursion in floating point.
    #[test]
    fn waves_and_chebyshev_polynomials_are_what_they_say() {
        for m in 0..200_usize {
            let expected = (f64::PI * f64::from_usize(m) / 26.0).cos();
            assert!((wave::<f64>(m) - expected).abs() <= 1e-13, "{m}");
        }
        for (degree, row) in CHEBYSHEV.iter().enumerate() {
            let x = 0.3_f64;
            let value = row.iter().rev().fold(0.0, |sum, &factor| sum * x + f64::from(factor));
            let expected = (f64::from_usize(degree) * x.acos()).cos();
            assert!((value - expected).abs() <= 1e-11, "{degree}: {value}, not {expected}");
        }
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
