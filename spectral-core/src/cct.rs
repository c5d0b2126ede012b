//! Correlated colour temperature and Duv: the nearest point of the Planckian locus in CIE 1960 (u, v).
//!
//! The locus is that of the grid: black bodies are summed at the same wavelengths as the light, so that a black body's
//! own temperature comes back. It is kept as 257 nodes equidistant in reciprocal temperature with first and second
//! derivatives, between which it is a quintic; nodes are either tabulated ([`LocusTable`]) or computed where they are
//! needed ([`PlanckianLocus`]), with the same bits.

use crate::Real;
use crate::spectrum::RadiationConstant;
use crate::summation::{SumGrid, tristimulus_sum};
use crate::tables::observers::CIE_1931_2;

/// Intervals between the nodes of the locus.
const INTERVALS: usize = 256;
/// Nodes between those that are looked at first.
const STRIDE: usize = 16;
/// Reciprocal temperature in MK⁻¹ (mired) of the hot end: 100 000 K.
const HOT_END: f64 = 10.0;
/// Reciprocal temperature in MK⁻¹ (mired) of the cold end: 500 K.
const COLD_END: f64 = 2000.0;
/// Distance between nodes in mired.
const SPACING: f64 = (COLD_END - HOT_END) / 256.0;
/// |Duv| up to which a colour temperature means something (CIE 15:2004, clause on correlated colour temperature).
pub const DUV_LIMIT: f64 = 0.05;

/// CIE 1960 (u, v) of tristimulus values: u = 4X / (X + 15Y + 3Z), v = 6Y / (X + 15Y + 3Z).
///
/// NaN or infinite when the denominator is 0 or not finite.
#[inline]
#[must_use]
pub fn xyz_to_uv<R: Real>([x, y, z]: [R; 3]) -> [R; 2] {
    let sum = x + R::from_f64(15.0) * y + R::from_f64(3.0) * z;
    [R::from_f64(4.0) * x / sum, R::from_f64(6.0) * y / sum]
}

/// What a correlated colour temperature is worth.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum CctStatus {
    /// |Duv| ≤ 0.05 and 500 K ≤ T ≤ 100 000 K.
    Valid,
    /// |Duv| > 0.05: the nearest temperature is given, but it does not describe the colour.
    FarFromLocus,
    /// The nearest point of the locus is colder than 500 K: 500 K is given, and the distance to it.
    BelowRange,
    /// The nearest point of the locus is hotter than 100 000 K: 100 000 K is given, and the distance to it.
    AboveRange,
}

/// A correlated colour temperature.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cct<R> {
    /// The temperature in K of the nearest point of the Planckian locus in CIE 1960 (u, v).
    pub temperature: R,
    /// The distance to the locus in (u, v): positive on the green side, above it.
    pub duv: R,
    /// Whether the temperature means something.
    pub status: CctStatus,
}

impl<R> Cct<R> {
    /// Whether the nearest point of the locus is within its ends: the status is neither `BelowRange` nor `AboveRange`.
    #[must_use]
    pub const fn is_in_range(&self) -> bool {
        !matches!(self.status, CctStatus::BelowRange | CctStatus::AboveRange)
    }
}

/// A node of the locus: (u, v) and its first and second derivatives by reciprocal temperature in mired.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Node<R> {
    point: [R; 2],
    first: [R; 2],
    second: [R; 2],
}

/// Where the nodes of a Planckian locus come from.
pub trait Locus<R: Real> {
    /// The node of an index in `0 ..= 256`.
    fn node(&self, index: usize) -> Node<R>;
}

/// The Planckian locus of a grid and an observer: black bodies of any temperature.
#[derive(Clone, Copy, Debug)]
pub struct PlanckianLocus<R, const N: usize> {
    observer: [[R; 3]; N],
    /// c₂ / λ by mired, at each wavelength.
    rates: [R; N],
    /// (560 nm / λ)⁵.
    weights: [R; N],
    /// c₂ / 560 nm by mired.
    rate_at_560: R,
}

impl<R: Real, const N: usize> PlanckianLocus<R, N> {
    /// The locus for x̄, ȳ, z̄ on a grid, with a second radiation constant.
    #[must_use]
    pub fn new(grid: SumGrid<N>, observer: &[[R; 3]; N], constant: RadiationConstant) -> Self {
        let body = BlackBody::new(constant);
        Self {
            observer: *observer,
            rates: core::array::from_fn(|index| body.rate(grid.wavelength(index))),
            weights: core::array::from_fn(|index| BlackBody::weight(grid.wavelength(index))),
            rate_at_560: body.rate(R::from_f64(560.0)),
        }
    }

    /// x̄, ȳ, z̄ on the grid.
    #[must_use]
    pub const fn observer(&self) -> &[[R; 3]; N] {
        &self.observer
    }

    /// The relative spectral power of a black body on the grid, 1 at 560 nm.
    ///
    /// λ⁻⁵ / (exp(c₂ / (λ T)) − 1), with relative error below 10 ε (1 + c₂ / (λ T)). The temperature, in K, must be at
    /// least 500 K and finite; below, values may underflow.
    #[must_use]
    pub fn spectrum(&self, temperature: R) -> [R; N] {
        let mired = R::from_f64(1e6) / temperature;
        let scale = exp_minus_1(self.rate_at_560 * mired);
        core::array::from_fn(|index| self.weights[index] * scale / exp_minus_1(self.rates[index] * mired))
    }

    /// CIE 1960 (u, v) of a black body of a temperature in K.
    #[must_use]
    pub fn uv(&self, temperature: R) -> [R; 2] {
        xyz_to_uv(tristimulus_sum(&self.observer, &self.spectrum(temperature)))
    }
}

/// What a black body's spectrum is made of.
#[derive(Clone, Copy, Debug)]
struct BlackBody<R> {
    /// c₂ in nm MK, so that it goes with reciprocal temperatures in mired.
    constant: R,
}

impl<R: Real> BlackBody<R> {
    fn new(constant: RadiationConstant) -> Self {
        Self { constant: R::from_f64(constant.metre_kelvin() * 1e3) }
    }

    /// c₂ / λ by mired, at a wavelength in nm.
    fn rate(&self, wavelength: R) -> R {
        self.constant / wavelength
    }

    /// (560 nm / λ)⁵.
    fn weight(wavelength: R) -> R {
        fifth_power(R::from_f64(560.0) / wavelength)
    }
}

/// A [`PlanckianLocus`] of the 2° observer of 1931 that keeps nothing: to the bit the same, for a single light in little
/// memory.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LeanLocus<R, const N: usize> {
    grid: SumGrid<N>,
    body: BlackBody<R>,
}

impl<R: Real, const N: usize> LeanLocus<R, N> {
    pub(crate) fn new(grid: SumGrid<N>, constant: RadiationConstant) -> Self {
        Self { grid, body: BlackBody::new(constant) }
    }

    /// The powers of [`PlanckianLocus::spectrum`].
    pub(crate) fn powers(&self, temperature: R) -> impl Fn(usize) -> R + use<R, N> {
        let (grid, body) = (self.grid, self.body);
        let mired = R::from_f64(1e6) / temperature;
        let scale = exp_minus_1(body.rate(R::from_f64(560.0)) * mired);
        move |index| {
            let wavelength = grid.wavelength(index);
            BlackBody::weight(wavelength) * scale / exp_minus_1(body.rate(wavelength) * mired)
        }
    }
}

/// XYZ of a black body and its first two derivatives by reciprocal temperature; rows are x̄, ȳ, z̄, c₂ / λ and (560 nm / λ)⁵.
fn tristimulus<R: Real>(rows: impl Iterator<Item = ([R; 3], R, R)>, mired: R) -> [[R; 3]; 3] {
    let mut sums = [[R::ZERO; 3]; 3];
    for (cmf, rate, weight) in rows {
        // q = 1 / (eˣ − 1) has q′ = −q (1 + q) and q″ = q (1 + q) (1 + 2 q).
        let q = R::ONE / exp_minus_1(rate * mired);
        let value = weight * q;
        let first = -rate * value * (R::ONE + q);
        let second = rate * rate * value * (R::ONE + q) * (R::ONE + q + q);
        for (sum, value) in sums.iter_mut().zip([value, first, second]) {
            for (sum, weight) in sum.iter_mut().zip(cmf) {
                *sum += value * weight;
            }
        }
    }
    sums
}

/// eˣ − 1 for x > 0, within 3 ε: from 1 on the plain difference, which is faster, loses less than a factor of 1.6.
fn exp_minus_1<R: Real>(x: R) -> R {
    if x < R::ONE { x.exp_m1() } else { x.exp() - R::ONE }
}

fn fifth_power<R: Real>(value: R) -> R {
    let square = value * value;
    square * square * value
}

impl<R: Real, const N: usize> Locus<R> for PlanckianLocus<R, N> {
    fn node(&self, index: usize) -> Node<R> {
        let rows = self.observer.iter().zip(&self.rates).zip(&self.weights);
        Node::of_tristimulus(tristimulus(rows.map(|((cmf, rate), weight)| (*cmf, *rate, *weight)), node_mired(index)))
    }
}

impl<R: Real, const N: usize> Locus<R> for LeanLocus<R, N> {
    fn node(&self, index: usize) -> Node<R> {
        let rows = (0..N).map(|index| {
            let wavelength = self.grid.wavelength(index);
            let cmf = self.grid.cmf(&CIE_1931_2, index);
            (cmf, self.body.rate(wavelength), BlackBody::weight(wavelength))
        });
        Node::of_tristimulus(tristimulus(rows, node_mired(index)))
    }
}

impl<R: Real> Node<R> {
    /// From XYZ and its first two derivatives.
    fn of_tristimulus([value, first, second]: [[R; 3]; 3]) -> Self {
        let denominator = |[x, y, z]: [R; 3]| x + R::from_f64(15.0) * y + R::from_f64(3.0) * z;
        let [d, d1, d2] = [value, first, second].map(denominator);
        // f = n / d: f′ = (n′ − f d′) / d, f″ = (n″ − 2 f′ d′ − f d″) / d.
        let quotient = |factor: R, channel: usize| {
            let f = factor * value[channel] / d;
            let f1 = (factor * first[channel] - f * d1) / d;
            let f2 = (factor * second[channel] - R::TWO * f1 * d1 - f * d2) / d;
            [f, f1, f2]
        };
        let (u, v) = (quotient(R::from_f64(4.0), 0), quotient(R::from_f64(6.0), 1));
        Self { point: [u[0], v[0]], first: [u[1], v[1]], second: [u[2], v[2]] }
    }
}

/// The nodes of a Planckian locus, computed once: 12 KB in `f64`, 6 KB in `f32`.
#[derive(Clone, Copy, Debug)]
pub struct LocusTable<R> {
    nodes: [Node<R>; INTERVALS + 1],
}

impl<R: Real> LocusTable<R> {
    /// Tabulates a locus.
    pub fn new(locus: &impl Locus<R>) -> Self {
        Self { nodes: core::array::from_fn(|index| locus.node(index)) }
    }
}

impl<R: Real> Locus<R> for LocusTable<R> {
    fn node(&self, index: usize) -> Node<R> {
        self.nodes.get(index).copied().unwrap_or_default()
    }
}

fn node_mired<R: Real>(index: usize) -> R {
    R::from_f64(HOT_END) + R::from_f64(SPACING) * R::from_usize(index)
}

/// The correlated colour temperature and Duv of a CIE 1960 chromaticity (u, v).
///
/// The nearest point of the locus between 500 K and 100 000 K. Against a brute-force search over the locus itself the
/// temperature is within 1e-4 K in `f64` between 1000 K and 25 000 K for |Duv| ≤ 0.05. In `f32` the error is that of rounding
/// in u and v; measured against `f64`, on the locus: 0.04 K up to 6500 K, 0.14 K up to 25 000 K; at |Duv| = 0.02 up to 5e-5 of the
/// temperature.
///
/// `None` when the chromaticity is not finite.
#[must_use]
pub fn correlated_colour_temperature<R: Real>(uv: [R; 2], locus: &impl Locus<R>) -> Option<Cct<R>> {
    if !(uv[0].is_finite() && uv[1].is_finite()) {
        return None;
    }
    Some(find_nearby(uv, locus).unwrap_or_else(|| search(uv, locus)))
}

/// The nearest point from a guess, when that is certain to be found so: two to four nodes instead of twenty.
///
/// Within [`DUV_LIMIT`] a chromaticity has one perpendicular to the locus, whose radius of curvature is 0.1 and more. So
/// the first one that is found is that of [`search`], to the bit; `None` further off and at the ends.
fn find_nearby<R: Real>(uv: [R; 2], locus: &impl Locus<R>) -> Option<Cct<R>> {
    let guess = (guess_mired(uv) - R::from_f64(HOT_END)) / R::from_f64(SPACING);
    // 0 for NaN and negative numbers.
    let mut index = guess.to_usize().min(INTERVALS - 1);
    let ahead = |node: &Node<R>| towards(uv, node.point, node.first) >= R::ZERO;
    let (mut low, mut high) = (locus.node(index), locus.node(index + 1));
    for _ in 0..GUESS_STEPS {
        match (ahead(&low), ahead(&high)) {
            (true, false) => {
                let found = foot(uv, index, &low, &high);
                return (found.status == CctStatus::Valid).then_some(found);
            }
            (_, true) if index + 1 < INTERVALS => {
                index += 1;
                (low, high) = (high, locus.node(index + 1));
            }
            (false, false) if index > 0 => {
                index -= 1;
                (low, high) = (locus.node(index), low);
            }
            _ => return None,
        }
    }
    None
}

/// How many intervals are tried from a guess.
const GUESS_STEPS: usize = 6;

/// Reciprocal temperature in mired as a polynomial in the slope of the line to (0.33, 0.20), where the perpendiculars of the
/// locus nearly meet, as in McCamy's formula; off by 15 at most between 1000 K and 25 000 K for |Duv| ≤ 0.01.
fn guess_mired<R: Real>([u, v]: [R; 2]) -> R {
    let slope = (u - R::from_f64(0.33)) / (v - R::from_f64(0.20));
    let mut sum = R::ZERO;
    for coefficient in [3.9, 12.7, -14.4, -68.0, 82.7, 513.1, 577.0] {
        sum = sum * slope + R::from_f64(coefficient);
    }
    sum
}

/// The nearest point anywhere on the locus.
fn search<R: Real>(uv: [R; 2], locus: &impl Locus<R>) -> Cct<R> {
    let nearest = nearest_coarse_node(uv, locus);
    let node = locus.node(nearest);
    let ahead = towards(uv, node.point, node.first);
    if nearest == 0 && ahead < R::ZERO {
        return end(uv, &node, HOT_END, CctStatus::AboveRange);
    }
    if nearest == INTERVALS && ahead > R::ZERO {
        return end(uv, &node, COLD_END, CctStatus::BelowRange);
    }
    let colder = (ahead >= R::ZERO && nearest < INTERVALS) || nearest == 0;
    let low = if colder { nearest } else { nearest - STRIDE };
    let index = bisect_nodes(uv, locus, low);
    foot(uv, index, &locus.node(index), &locus.node(index + 1))
}

/// The nearest point between two nodes.
fn foot<R: Real>(uv: [R; 2], index: usize, low: &Node<R>, high: &Node<R>) -> Cct<R> {
    let piece = Quintic::new(low, high);
    let position = piece.nearest(uv, first_position(uv, low, high));
    let [point, tangent, _] = piece.at(position);
    let mired = node_mired::<R>(index) + R::from_f64(SPACING) * position;
    let duv = signed_distance(uv, point, tangent);
    let far = duv.abs() > R::from_f64(DUV_LIMIT);
    let status = if far { CctStatus::FarFromLocus } else { CctStatus::Valid };
    Cct { temperature: R::from_f64(1e6) / mired, duv, status }
}

/// The position between two nodes from the distances to their perpendiculars, as in Robertson's method: within 1e-3.
///
/// The distances are projections divided by the tangents' lengths, whose ratio is taken as (3 l + m) / (l + 3 m) with their
/// squares l and m, right to second order.
fn first_position<R: Real>(uv: [R; 2], low: &Node<R>, high: &Node<R>) -> R {
    let square = |node: &Node<R>| node.first[0] * node.first[0] + node.first[1] * node.first[1];
    let (l, m) = (square(low), square(high));
    let three = R::from_f64(3.0);
    let from_low = towards(uv, low.point, low.first) * (l + three * m);
    let from_high = towards(uv, high.point, high.first) * (three * l + m);
    from_low / (from_low - from_high)
}

fn end<R: Real>(uv: [R; 2], node: &Node<R>, mired: f64, status: CctStatus) -> Cct<R> {
    let duv = signed_distance(uv, node.point, node.first);
    Cct { temperature: R::from_f64(1e6 / mired), duv, status }
}

/// The projection of the way from `point` to `uv` on a tangent: positive when the nearest point is further along it.
fn towards<R: Real>(uv: [R; 2], point: [R; 2], tangent: [R; 2]) -> R {
    (uv[0] - point[0]) * tangent[0] + (uv[1] - point[1]) * tangent[1]
}

/// The distance, positive to the left of the tangent (which points to colder lights): the green side.
fn signed_distance<R: Real>(uv: [R; 2], point: [R; 2], tangent: [R; 2]) -> R {
    let (du, dv) = (uv[0] - point[0], uv[1] - point[1]);
    let distance = (du * du + dv * dv).sqrt();
    if tangent[0] * dv - tangent[1] * du < R::ZERO { -distance } else { distance }
}

fn nearest_coarse_node<R: Real>(uv: [R; 2], locus: &impl Locus<R>) -> usize {
    let mut best = (R::INFINITY, 0);
    for index in (0..=INTERVALS).step_by(STRIDE) {
        let point = locus.node(index).point;
        let (du, dv) = (uv[0] - point[0], uv[1] - point[1]);
        let square = du * du + dv * dv;
        if square < best.0 {
            best = (square, index);
        }
    }
    best.1
}

/// The interval between `low` and `low + STRIDE` in which the foot of the perpendicular lies.
fn bisect_nodes<R: Real>(uv: [R; 2], locus: &impl Locus<R>, low: usize) -> usize {
    let (mut low, mut high) = (low, low + STRIDE);
    while high - low > 1 {
        let middle = usize::midpoint(low, high);
        let node = locus.node(middle);
        if towards(uv, node.point, node.first) >= R::ZERO {
            low = middle;
        } else {
            high = middle;
        }
    }
    low
}

/// The quintic between two nodes that has their values and derivatives, for positions in [0, 1].
struct Quintic<R> {
    coefficients: [[R; 6]; 2],
}

impl<R: Real> Quintic<R> {
    fn new(start: &Node<R>, end: &Node<R>) -> Self {
        let h = R::from_f64(SPACING);
        let [half, ten, fifteen] = [0.5, 10.0, 15.0].map(R::from_f64);
        let [three, four, six, seven, eight] = [3.0, 4.0, 6.0, 7.0, 8.0].map(R::from_f64);
        let coefficients = core::array::from_fn(|c| {
            let rise = end.point[c] - start.point[c];
            let (d0, d1) = (start.first[c] * h, end.first[c] * h);
            let (s0, s1) = (start.second[c] * h * h * half, end.second[c] * h * h * half);
            [
                start.point[c],
                d0,
                s0,
                ten * rise - six * d0 - four * d1 - three * s0 + s1,
                eight * d0 + seven * d1 + three * s0 - R::TWO * s1 - fifteen * rise,
                six * rise - three * (d0 + d1) - s0 + s1,
            ]
        });
        Self { coefficients }
    }

    /// The point and its first two derivatives by position.
    fn at(&self, t: R) -> [[R; 2]; 3] {
        let mut result = [[R::ZERO; 2]; 3];
        for (c, coefficients) in self.coefficients.iter().enumerate() {
            let [mut value, mut first, mut second] = [R::ZERO; 3];
            for &coefficient in coefficients.iter().rev() {
                second = second * t + first;
                first = first * t + value;
                value = value * t + coefficient;
            }
            result[0][c] = value;
            result[1][c] = first;
            result[2][c] = second + second;
        }
        result
    }

    /// The position in [0, 1] nearest to a chromaticity: Newton's method from a first guess, within a bracket that halves
    /// otherwise.
    fn nearest(&self, uv: [R; 2], guess: R) -> R {
        let (mut low, mut high) = (R::ZERO, R::ONE);
        // Far from the locus the guess may be anywhere, or NaN.
        let mut t = if guess >= low && guess <= high { guess } else { R::HALF };
        // The error after a step is less than the square of the step.
        let enough = R::EPSILON.sqrt() * R::from_f64(0.25);
        for _ in 0..12 {
            let [point, first, second] = self.at(t);
            let slope = towards(uv, point, second) - first[0] * first[0] - first[1] * first[1];
            let value = towards(uv, point, first);
            if value >= R::ZERO {
                low = t;
            } else {
                high = t;
            }
            let newton = t - value / slope;
            let inside = newton >= low && newton <= high;
            let next = if inside { newton } else { (low + high) * R::HALF };
            let done = (next - t).abs() <= if inside { enough } else { R::TWO * R::EPSILON };
            t = next;
            if done {
                break;
            }
        }
        t
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tables::observers::CIE_1931_2;

    /// What is found from a guess is what the search of the whole locus finds, and it is found wherever lamps are.
    #[test]
    fn a_nearby_point_is_that_of_the_whole_search() {
        let grid = SumGrid::CIE_5NM;
        let locus = PlanckianLocus::new(grid, &grid.observer::<f64>(&CIE_1931_2), RadiationConstant::Its1990);
        let table = LocusTable::new(&locus);
        for step in 0..1000 {
            let mired = 10.5 + 1989.0 * f64::from(step) / 1000.0;
            let index = ((mired - HOT_END) / SPACING).to_usize();
            let [point, tangent, _] = Quintic::new(&table.node(index), &table.node(index + 1)).at(0.3);
            let length = (tangent[0] * tangent[0] + tangent[1] * tangent[1]).sqrt();
            for offset in -60..=60 {
                let duv = f64::from(offset) * 1e-3;
                let uv = [point[0] - tangent[1] / length * duv, point[1] + tangent[0] / length * duv];
                let nearby = find_nearby(uv, &table);
                assert!(nearby.is_none() || nearby == Some(search(uv, &table)), "{mired} mired, {duv}");
                let common = (40.0..900.0).contains(&mired) && duv.abs() <= 0.02;
                assert!(nearby.is_some() || !common, "{mired} mired, {duv}");
                assert!(nearby.is_none() || duv.abs() < 0.0501, "{mired} mired, {duv}");
            }
        }
    }
}
