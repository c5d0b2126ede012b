//! One slice: the mean of emission and visibility along a chord, with shadow edges found by bisection.

use spectral_core::Real;

use super::rule::{GAUSS_5, Gauss3};
use super::slices::{Slice, Slices};
use super::{Aim, EstimateError, Response};
use crate::shape::Disk;

/// Values with and without visibility, and how far the former may be off.
#[derive(Clone, Copy, Debug)]
pub(super) struct Light<R> {
    pub(super) lit: R,
    pub(super) full: R,
    pub(super) error: R,
}

impl<R: Real> Light<R> {
    pub(super) const NONE: Self = Self { lit: R::ZERO, full: R::ZERO, error: R::ZERO };

    pub(super) fn add(&mut self, other: Self, weight: R) {
        self.lit += weight * other.lit;
        self.full += weight * other.full;
        self.error += weight * other.error;
    }
}

/// The light as the caller's closure gives it.
pub(super) struct Source<'a, R, F> {
    pub(super) disk: &'a Disk<R>,
    pub(super) slices: Slices<R>,
    pub(super) respond: F,
    pub(super) samples: usize,
    pub(super) max_samples: usize,
    /// The relative error allowed within a slice.
    pub(super) tolerance: R,
    pub(super) strata: usize,
    /// Whether only the ratio of lit to full matters.
    pub(super) is_ratio: bool,
}

/// The largest number of intervals of a slice that wait.
const WAITING: usize = 64;

/// Visibilities further apart than this have an edge between them.
const EDGE: f64 = 0.1;

impl<R: Real, F: FnMut(&Aim<R>) -> Response<R>> Source<'_, R, F> {
    /// Asks for a point of a slice.
    pub(super) fn ask(&mut self, slice: &Slice<R>, fraction: R) -> Result<Response<R>, EstimateError> {
        let ([across, along], cosine) = slice.sample(fraction);
        let on_disk = self.slices.point(across, along);
        let aim = Aim { on_disk, point: self.disk.point(on_disk), cosine: slice.cosine(cosine, &self.slices) };
        self.samples += 1;
        let response = (self.respond)(&aim);
        let valid = |x: R| x >= R::ZERO && x.is_finite();
        if valid(response.emission) && valid(response.visibility) { Ok(response) } else { Err(EstimateError::Response) }
    }

    pub(super) const fn is_spent(&self) -> bool {
        self.samples >= self.max_samples
    }

    /// The mean over a slice by its measure cos²ξ dξ.
    pub(super) fn mean(&mut self, slice: &Slice<R>) -> Result<Light<R>, EstimateError> {
        let mut waiting = Waiting::over(self.strata);
        let mut total = Light::NONE;
        while let Some([from, to]) = waiting.pop() {
            let share = slice.share(from, to);
            if !(share > R::ZERO) {
                continue;
            }
            let Some(rule) = interval_rule(slice, from, to) else { continue };
            let place = |node: R| from + (to - from) * R::HALF * (node + R::ONE);
            let mut responses = [Response { emission: R::ZERO, visibility: R::ZERO }; 3];
            for (response, node) in responses.iter_mut().zip(rule.nodes) {
                *response = self.ask(slice, place(node))?;
            }
            let edge = (0..2).find(|i| is_edge(&responses[*i], &responses[i + 1]));
            let light = self.judge(&rule, &responses);
            let scale = total.lit + share * light.lit;
            let allowed = self.tolerance * scale;
            let can_split = waiting.has_room() && to - from > R::from_f64(64.0) * R::EPSILON && !self.is_spent();
            if let (Some(i), true) = (edge, can_split) {
                let bracket = [place(rule.nodes[i]), place(rule.nodes[i + 1])];
                let (place, error) = self.find_edge(slice, bracket, [responses[i], responses[i + 1]], allowed)?;
                total.error += error;
                waiting.push([from, place]);
                waiting.push([place, to]);
            } else if light.error * share > allowed * share.max(R::from_f64(0.1)) && can_split {
                let middle = R::HALF * (from + to);
                waiting.push([from, middle]);
                waiting.push([middle, to]);
            } else {
                total.add(light, share);
            }
        }
        Ok(total)
    }

    /// The mean of three responses, and its error as far as it matters.
    pub(super) fn judge(&self, rule: &Gauss3<R>, responses: &[Response<R>; 3]) -> Light<R> {
        let lights = responses.map(|r| Light { lit: r.emission * r.visibility, full: r.emission, error: R::ZERO });
        self.combine(rule, &lights)
    }

    /// The mean of three lights.
    pub(super) fn combine(&self, rule: &Gauss3<R>, lights: &[Light<R>; 3]) -> Light<R> {
        let lit = rule.mean(lights.map(|light| light.lit));
        let full = rule.mean(lights.map(|light| light.full)).value;
        let noise = (0..3).fold(R::ZERO, |sum, i| sum + rule.weights[i] * lights[i].error);
        let error = if self.is_ratio && full > R::ZERO {
            let ratio = lit.value / full;
            let rest = lights.map(|light| light.lit - ratio * light.full);
            rule.deviation(rest, lit.value)
        } else {
            lit.error
        };
        Light { lit: lit.value, full, error: error + noise }
    }

    /// The place of an edge between two points of a slice, and how much the uncertainty of the place matters.
    fn find_edge(
        &mut self,
        slice: &Slice<R>,
        mut bracket: [R; 2],
        mut ends: [Response<R>; 2],
        allowed: R,
    ) -> Result<(R, R), EstimateError> {
        loop {
            let middle = R::HALF * (bracket[0] + bracket[1]);
            let lit = ends.map(|end| end.emission * end.visibility);
            let error = R::HALF * slice.share(bracket[0], bracket[1]) * (lit[0] - lit[1]).abs();
            let is_narrow = !(middle > bracket[0] && middle < bracket[1]);
            if error <= allowed || is_narrow || self.is_spent() {
                return Ok((middle, error));
            }
            let response = self.ask(slice, middle)?;
            let distance = |end: &Response<R>| (end.visibility - response.visibility).abs();
            let side = usize::from(!(distance(&ends[0]) <= distance(&ends[1])));
            bracket[side] = middle;
            ends[side] = response;
        }
    }
}

fn is_edge<R: Real>(a: &Response<R>, b: &Response<R>) -> bool {
    (a.visibility - b.visibility).abs() > R::from_f64(EDGE)
}

/// The rule for cos²ξ between two fractions of a slice.
fn interval_rule<R: Real>(slice: &Slice<R>, from: R, to: R) -> Option<Gauss3<R>> {
    let points = GAUSS_5.map(|(node, weight)| {
        let node = R::from_f64(node);
        let (_, cosine) = slice.sample(from + (to - from) * R::HALF * (node + R::ONE));
        (node, R::from_f64(weight) * cosine)
    });
    Gauss3::of(&points)
}

/// Intervals of a slice yet to be summed.
struct Waiting<R> {
    intervals: [[R; 2]; WAITING],
    count: usize,
}

impl<R: Real> Waiting<R> {
    /// Equal parts of [0, 1], at most half of the room.
    fn over(strata: usize) -> Self {
        let strata = strata.clamp(1, WAITING / 2);
        let mut waiting = Self { intervals: [[R::ZERO; 2]; WAITING], count: 0 };
        let place = |i: usize| R::from_usize(i) / R::from_usize(strata);
        for i in (0..strata).rev() {
            waiting.push([place(i), place(i + 1)]);
        }
        waiting
    }

    const fn has_room(&self) -> bool {
        self.count + 2 <= WAITING
    }

    fn push(&mut self, interval: [R; 2]) {
        if let Some(slot) = self.intervals.get_mut(self.count) {
            *slot = interval;
            self.count += 1;
        }
    }

    fn pop(&mut self) -> Option<[R; 2]> {
        self.count = self.count.checked_sub(1)?;
        self.intervals.get(self.count).copied()
    }
}
