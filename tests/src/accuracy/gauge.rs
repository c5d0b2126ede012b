//! Where functions are measured, and how errors are counted.

use spectral_core::Real;

use super::wide::{Wide, wide};
use crate::statistics::Rng;

/// What an error is counted in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unit {
    /// Units in the last place of the exact result: the distance to the next number of its binade, or of the least normal one below it.
    Ulp,
    /// Units in the last place of the exact result's largest component.
    UlpOfLargest,
    /// Units in the last place of something else, named here.
    UlpOf(&'static str),
    /// Relative to the exact result.
    Relative,
    /// Relative to something else, named here.
    RelativeTo(&'static str),
    /// The difference itself, in the unit named here.
    Absolute(&'static str),
    /// The error over what the function states as its bound.
    OfBound,
}

/// How a point was chosen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Choice {
    /// Special values.
    List,
    /// Within some units in the last place of a limit, a branch point or a joint of formulas.
    Edge,
    /// A linear or logarithmic grid.
    Spaced,
    /// Random numbers from a fixed seed.
    Random,
}

/// The range of one argument.
#[derive(Clone, Debug)]
pub struct Axis {
    name: &'static str,
    limits: [f64; 2],
    scale: Scale,
    list: Vec<f64>,
    edges: Vec<f64>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Scale {
    Linear,
    Logarithmic,
    /// Of either sign.
    Signed,
}

impl Axis {
    /// An argument in [low, high], spread evenly.
    #[must_use]
    pub fn linear(name: &'static str, low: f64, high: f64) -> Self {
        Self { name, limits: [low, high], scale: Scale::Linear, list: vec![low, high], edges: vec![low, high] }
    }

    /// An argument in [low, high], both positive, its logarithm spread evenly.
    #[must_use]
    pub fn log(name: &'static str, low: f64, high: f64) -> Self {
        Self { scale: Scale::Logarithmic, ..Self::linear(name, low, high) }
    }

    /// An argument of either sign whose magnitude is in [low, high], its logarithm spread evenly, and 0.
    #[must_use]
    pub fn signed(name: &'static str, low: f64, high: f64) -> Self {
        let list = vec![-high, -low, 0.0, low, high];
        Self { name, limits: [low, high], scale: Scale::Signed, list, edges: vec![-high, high] }
    }

    /// Special values, beside the limits.
    #[must_use]
    pub fn list(mut self, values: &[f64]) -> Self {
        self.list.extend_from_slice(values);
        self
    }

    /// Values around which to walk number by number, beside the limits.
    #[must_use]
    pub fn edges(mut self, values: &[f64]) -> Self {
        self.edges.extend_from_slice(values);
        self.list.extend_from_slice(values);
        self
    }

    /// The place of a share of the way; by `libm`, so that points are the same everywhere.
    fn at(&self, share: f64) -> f64 {
        let [low, high] = self.limits;
        let between = |share: f64| Real::exp(Real::ln(low) + (Real::ln(high) - Real::ln(low)) * share);
        match self.scale {
            Scale::Linear => low + (high - low) * share,
            Scale::Logarithmic => between(share),
            Scale::Signed if share < 0.5 => -between(1.0 - 2.0 * share),
            Scale::Signed => between(2.0 * share - 1.0),
        }
    }

    /// Within the limits, also after rounding.
    fn keep<R: Real>(&self, value: R) -> Option<R> {
        let x = value.to_f64();
        let [low, high] = self.limits;
        let inside = match self.scale {
            Scale::Signed => x.abs() <= high && (x == 0.0 || x.abs() >= low),
            _ => x >= low && x <= high,
        };
        inside.then_some(value)
    }

    /// As the table prints it.
    fn describe(&self) -> String {
        let [low, high] = self.limits.map(plain);
        match self.scale {
            Scale::Linear => format!("{} {low} … {high}", self.name),
            Scale::Logarithmic => format!("{} {low} … {high} (log)", self.name),
            Scale::Signed => format!("{} 0, ±{low} … ±{high} (log)", self.name),
        }
    }
}

/// A number in a few characters.
fn plain(x: f64) -> String {
    let (fixed, scientific) = (format!("{x}"), format!("{x:e}"));
    let text = if fixed.len() <= scientific.len() + 2 { fixed } else { scientific };
    text.replace('-', "−")
}

/// How many numbers to either side of an edge.
const WALK: u64 = 12;
/// Points by each choice at full effort.
const POINTS: f64 = 1000.0;
/// The most combinations of special values.
const COMBINATIONS: usize = 1500;

/// Collects the errors of one function in one precision.
#[derive(Clone, Debug)]
pub struct Gauge {
    unit: Unit,
    effort: f64,
    rng: Rng,
    choice: Choice,
    point: Vec<f64>,
    found: Found,
}

/// The largest error of a function, and where it was found.
#[derive(Clone, Debug, PartialEq)]
pub struct Found {
    /// The largest error; infinite for a result that isn't a number.
    pub worst: f64,
    /// How its point was chosen.
    pub choice: Choice,
    /// The arguments there.
    pub point: Vec<f64>,
    /// How many points were measured.
    pub points: u64,
    /// The ranges of the arguments.
    pub domain: String,
}

impl Gauge {
    /// For a unit, and random numbers of its own.
    #[must_use]
    pub fn new(unit: Unit, seed: u64) -> Self {
        let found = Found { worst: 0.0, choice: Choice::List, point: Vec::new(), points: 0, domain: String::new() };
        Self { unit, effort: 1.0, rng: Rng::new(seed), choice: Choice::List, point: Vec::new(), found }
    }

    /// What was found.
    #[must_use]
    pub fn found(self) -> Found {
        self.found
    }

    /// Random numbers.
    pub fn rng(&mut self) -> &mut Rng {
        &mut self.rng
    }

    /// How many points to measure, as a share of the usual number.
    pub fn effort(&mut self, share: f64) {
        self.effort = share;
    }

    /// Something to say of the domain beside the axes.
    pub fn note(&mut self, text: &str) {
        if !self.found.domain.is_empty() {
            self.found.domain += "; ";
        }
        self.found.domain += text;
    }

    /// Sets a special point that isn't one of an axis.
    pub fn special(&mut self, point: &[f64]) {
        self.choice = Choice::List;
        self.point = point.to_vec();
    }

    /// Measures without adding to the domain's description.
    pub fn quietly(&mut self, measure: impl FnOnce(&mut Self)) {
        let domain = self.found.domain.clone();
        measure(self);
        self.found.domain = domain;
    }

    /// Calls `measure` at points of the axes' product, chosen in all four ways.
    pub fn each<R: Real, const N: usize>(&mut self, axes: &[Axis; N], mut measure: impl FnMut(&mut Self, [R; N])) {
        let text: Vec<_> = axes.iter().map(Axis::describe).collect();
        let text = text.join(", ");
        if !self.found.domain.contains(&text) {
            self.note(&text);
        }
        self.lists(axes, &mut measure);
        self.walks(axes, &mut measure);
        self.grid(axes, &mut measure);
        self.choice = Choice::Random;
        for _ in 0..self.budget() {
            let point = self.anywhere(axes);
            self.visit(axes, point, &mut measure);
        }
    }

    fn budget(&self) -> u64 {
        (POINTS * self.effort).max(24.0) as u64
    }

    fn anywhere<R: Real, const N: usize>(&mut self, axes: &[Axis; N]) -> [R; N] {
        core::array::from_fn(|i| R::from_f64(axes[i].at(self.rng.unit())))
    }

    fn visit<R: Real, const N: usize>(
        &mut self,
        axes: &[Axis; N],
        point: [R; N],
        measure: &mut impl FnMut(&mut Self, [R; N]),
    ) {
        if axes.iter().zip(point).any(|(axis, x)| axis.keep(x).is_none()) {
            return;
        }
        self.point = point.iter().map(|x| x.to_f64()).collect();
        measure(self, point);
    }

    fn lists<R: Real, const N: usize>(&mut self, axes: &[Axis; N], measure: &mut impl FnMut(&mut Self, [R; N])) {
        self.choice = Choice::List;
        let all: usize = axes.iter().map(|axis| axis.list.len()).product();
        let most = (COMBINATIONS as f64 * self.effort).max(64.0).to_usize();
        for index in 0..all.min(most) {
            let mut rest = index;
            let point = core::array::from_fn(|i| {
                let list = &axes[i].list;
                let place = if all <= most { rest } else { self.rng.bits() as usize };
                rest /= list.len();
                R::from_f64(list[place % list.len()])
            });
            self.visit(axes, point, measure);
        }
    }

    fn walks<R: Real, const N: usize>(&mut self, axes: &[Axis; N], measure: &mut impl FnMut(&mut Self, [R; N])) {
        self.choice = Choice::Edge;
        let walk = if self.effort < 0.5 { WALK / 4 } else { WALK };
        for (i, axis) in axes.iter().enumerate() {
            for edge in &axis.edges {
                let (mut up, mut down) = (R::from_f64(*edge), R::from_f64(*edge));
                for _ in 0..=walk {
                    for x in [up, down] {
                        let mut point = self.anywhere(axes);
                        point[i] = x;
                        self.visit(axes, point, measure);
                    }
                    (up, down) = (next(up, true), next(down, false));
                }
            }
        }
    }

    fn grid<R: Real, const N: usize>(&mut self, axes: &[Axis; N], measure: &mut impl FnMut(&mut Self, [R; N])) {
        self.choice = Choice::Spaced;
        let side = ((self.budget() as f64).powf(1.0 / N as f64) + 1e-9).floor().max(2.0).to_usize();
        for index in 0..side.pow(u32::try_from(N).unwrap_or(1)) {
            let mut rest = index;
            let point = core::array::from_fn(|i| {
                let place = rest % side;
                rest /= side;
                R::from_f64(axes[i].at(place as f64 / (side - 1) as f64))
            });
            self.visit(axes, point, measure);
        }
    }

    /// A result with its exact value; for [`Unit::UlpOf`] use [`Gauge::compare_to`].
    pub fn compare<R: Real>(&mut self, got: R, exact: Wide) {
        self.compare_to(got, exact, exact);
    }

    /// A result, its exact value and what the error is relative to.
    pub fn compare_to<R: Real>(&mut self, got: R, exact: Wide, scale: Wide) {
        let beyond = exact.to_f64().abs() > R::MAX.to_f64();
        if beyond && got.to_f64().abs() >= R::MAX.to_f64() && got.to_f64().signum() == exact.to_f64().signum() {
            return self.record(0.0);
        }
        let error = (wide(got) - exact).abs().to_f64();
        self.record(match self.unit {
            Unit::Ulp | Unit::UlpOfLargest | Unit::UlpOf(_) => error / ulp::<R>(scale),
            Unit::Relative if error == 0.0 => 0.0,
            Unit::Relative | Unit::RelativeTo(_) | Unit::OfBound => error / scale.to_f64().abs(),
            Unit::Absolute(_) => error,
        });
    }

    /// A vector with its exact value.
    pub fn compare_all<R: Real, const N: usize>(&mut self, got: [R; N], exact: [Wide; N]) {
        let largest = exact.into_iter().fold(Wide::ZERO, |m, x| m.max(x.abs()));
        for (got, exact) in got.into_iter().zip(exact) {
            self.compare_to(got, exact, if self.unit == Unit::UlpOfLargest { largest } else { exact });
        }
    }

    /// What must hold; an infinite error if it doesn't.
    pub fn require(&mut self, holds: bool) {
        self.record(if holds { 0.0 } else { f64::INFINITY });
    }

    /// An error in the unit.
    pub fn record(&mut self, error: f64) {
        self.found.points += 1;
        let error = if error.is_nan() { f64::INFINITY } else { error };
        if error > self.found.worst || self.found.points == 1 {
            self.found.worst = error;
            self.found.choice = self.choice;
            self.found.point.clone_from(&self.point);
        }
    }
}

/// The unit in the last place of R for a number.
fn ulp<R: Real>(x: Wide) -> f64 {
    let size = x.to_f64().abs().max(R::MIN_POSITIVE.to_f64());
    f64::from_bits(size.to_bits() & 0x7ff0_0000_0000_0000) * R::EPSILON.to_f64()
}

/// The next number of R, up or down.
fn next<R: Real>(x: R, up: bool) -> R {
    let x = x.to_f64();
    if R::EPSILON.to_f64() < 1e-10 {
        return R::from_f64(if up { x.next_up() } else { x.next_down() });
    }
    #[allow(clippy::cast_possible_truncation, reason = "it came from `f32`")]
    let x = x as f32;
    R::from_f64(f64::from(if up { x.next_up() } else { x.next_down() }))
}
