//! One slice: the mean light along a chord, with shadow edges found by bisection.

use spectral_core::Real;

use super::rule::{FINEST, Light, Nested, Node, added, node};
use super::slices::{Slice, Slices};
use super::{Aim, EstimateError, Response};
use crate::shape::Disk;

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
    /// Whether light is compared with the emission instead of with 1.
    pub(super) is_ratio: bool,
    /// The first visibility seen, and whether another one was seen since.
    pub(super) first: Option<R>,
    pub(super) is_mixed: bool,
}

/// The mean light of a slice, and how far its excess may be off.
#[derive(Clone, Copy, Debug)]
pub(super) struct Mean<R> {
    pub(super) light: Light<R>,
    pub(super) error: R,
}

/// What is known of the disk as a whole before a slice is sampled.
#[derive(Clone, Copy, Debug)]
pub(super) struct Known<R> {
    /// Lit over full; none before the first slice.
    pub(super) ratio: Option<R>,
    /// The mean light: darker slices need not be better known than that.
    pub(super) typical: R,
}

/// The largest number of parts of a slice.
const PARTS: usize = 16;

/// Visibilities further apart than this have an edge between them.
const EDGE: f64 = 0.1;

/// How far within a part its end is looked at.
const END: f64 = 1.0 / 256.0;

impl<R: Real, F: FnMut(&Aim<R>) -> Response<R>> Source<'_, R, F> {
    /// Asks for a point of a slice.
    fn ask(&mut self, slice: &Slice<R>, fraction: R) -> Result<Response<R>, EstimateError> {
        let ([across, along], cosine) = slice.sample(fraction);
        let on_disk = self.slices.point(across, along);
        let aim = Aim { on_disk, point: self.disk.point(on_disk), cosine: slice.slant * cosine };
        self.samples += 1;
        let response = (self.respond)(&aim);
        let first = *self.first.get_or_insert(response.visibility);
        self.is_mixed |= differ(first, response.visibility);
        let valid = |x: R| x >= R::ZERO && x.is_finite();
        if valid(response.emission) && valid(response.visibility) { Ok(response) } else { Err(EstimateError::Response) }
    }

    fn light(&self, response: &Response<R>) -> Light<R> {
        let full = if self.is_ratio { response.emission } else { R::ONE };
        Light { lit: response.emission * response.visibility, full }
    }

    pub(super) const fn is_spent(&self) -> bool {
        self.samples >= self.max_samples
    }

    /// The mean over a slice by its measure cos²ξ dξ: the part with the largest error gets a finer rule or is divided, at an edge of visibility if
    /// there is one.
    pub(super) fn mean(&mut self, slice: &Slice<R>, known: Known<R>) -> Result<Mean<R>, EstimateError> {
        let mut parts = Parts { parts: [Part::default(); PARTS], count: 0 };
        let strata = self.strata.min(PARTS / 2);
        let place = |i: usize| R::from_usize(i) / R::from_usize(strata);
        for i in 0..strata {
            let part = self.part(slice, place(i), place(i + 1))?;
            parts.push(part);
        }
        loop {
            let light = parts.light();
            let ratio = known.ratio.unwrap_or(light.ratio());
            let error = parts.error(ratio, self.is_mixed);
            let allowed = self.tolerance * light.lit.max(known.typical);
            if error <= allowed || self.is_spent() || !self.improve(slice, &mut parts, ratio, allowed)? {
                return Ok(Mean { light, error });
            }
        }
    }

    /// Betters the worst part; false where it cannot be.
    fn improve(&mut self, slice: &Slice<R>, parts: &mut Parts<R>, ratio: R, allowed: R) -> Result<bool, EstimateError> {
        let has_room = parts.count < PARTS;
        let is_mixed = self.is_mixed;
        let Some(worst) = parts.worst(ratio, is_mixed) else { return Ok(false) };
        if worst.edge.is_none() && worst.rule.is_smooth(ratio) {
            worst.rule.level += 1;
            self.sample(slice, worst)?;
            return Ok(true);
        }
        let (from, to, rest) = (worst.from, worst.to, worst.rest);
        let (place, error) = match worst.edge {
            Some((bracket, ends)) => self.find_edge(slice, bracket, ends, R::HALF * allowed)?,
            None => (R::HALF * (from + to), R::ZERO),
        };
        let is_wide = place > from && place < to && to - from > R::from_f64(64.0) * R::EPSILON;
        if !has_room || !is_wide {
            return Ok(false);
        }
        *worst = self.part(slice, from, place)?;
        worst.rest = rest + error;
        let right = self.part(slice, place, to)?;
        parts.push(right);
        Ok(true)
    }

    /// A part of a slice, by fractions of its angle, with the coarsest rule's samples.
    fn part(&mut self, slice: &Slice<R>, from: R, to: R) -> Result<Part<R>, EstimateError> {
        let mut part = Part { from, to, share: slice.share(from, to), ..Part::default() };
        self.sample(slice, &mut part)?;
        Ok(part)
    }

    /// Adds the samples of the part's level, and densities at the next one's nodes.
    fn sample(&mut self, slice: &Slice<R>, part: &mut Part<R>) -> Result<(), EstimateError> {
        part.measure(slice, FINEST.min(part.rule.level + 1));
        let mut responses = [(R::ZERO, Response::default()); 3];
        for number in added(part.rule.level) {
            let fraction = part.place(number);
            let response = self.ask(slice, fraction)?;
            part.rule.set_light(number, self.light(&response));
            if let Some(slot) = responses.get_mut(number) {
                *slot = (fraction, response);
            }
        }
        part.rule.summarise();
        if part.rule.level == 0 {
            part.edge = self.look_for_edge(slice, part, &responses)?;
        }
        Ok(())
    }

    /// The first two neighbours among the coarsest rule's nodes with an edge of visibility between them. Where visibility is known to change somewhere on
    /// the disk, the ends of the slice are looked at as well.
    fn look_for_edge(
        &mut self,
        slice: &Slice<R>,
        part: &Part<R>,
        responses: &[(R, Response<R>); 3],
    ) -> Result<Option<Edge<R>>, EstimateError> {
        let between = |a: &(R, Response<R>), b: &(R, Response<R>)| {
            differ(a.1.visibility, b.1.visibility).then_some(([a.0, b.0], [a.1, b.1]))
        };
        let [left, middle, right] = responses;
        if let Some(edge) = between(left, middle).or_else(|| between(middle, right)) {
            return Ok(Some(edge));
        }
        let margin = (part.to - part.from) * R::from_f64(END);
        if self.is_mixed && part.from <= R::ZERO {
            let place = part.from + margin;
            let end = (place, self.ask(slice, place)?);
            if let Some(edge) = between(&end, left) {
                return Ok(Some(edge));
            }
        }
        if self.is_mixed && part.to >= R::ONE {
            let place = part.to - margin;
            let end = (place, self.ask(slice, place)?);
            return Ok(between(right, &end));
        }
        Ok(None)
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

fn differ<R: Real>(a: R, b: R) -> bool {
    (a - b).abs() > R::from_f64(EDGE)
}

/// An edge of visibility: between which fractions of a slice, and what is there.
type Edge<R> = ([R; 2], [Response<R>; 2]);

/// A part of a slice.
#[derive(Clone, Copy, Debug, Default)]
struct Part<R> {
    from: R,
    to: R,
    /// Its share of the slice's measure.
    share: R,
    rule: Nested<R>,
    /// Error that stays: what is left of the places of edges.
    rest: R,
    edge: Option<Edge<R>>,
}

impl<R: Real> Part<R> {
    fn place(&self, number: usize) -> R {
        let (node, _) = node::<R>(number);
        self.from + (self.to - self.from) * R::HALF * (node + R::ONE)
    }

    /// Takes the densities cos²ξ at the nodes up to a level.
    fn measure(&mut self, slice: &Slice<R>, level: usize) {
        let (from, half) = (self.from, R::HALF * (self.to - self.from));
        self.rule.measure_to(level, |place| {
            let ([_, along], cosine) = slice.sample(from + half * (place + R::ONE));
            Node::new(cosine * cosine, place, [cosine, along])
        });
    }

    /// The part of the slice's mean, and the error that more samples make smaller.
    fn mean(&self) -> Light<R> {
        self.rule.integral().scaled(self.scale())
    }

    fn error(&self, ratio: R, is_mixed: bool) -> R {
        let seen = self.rule.error(ratio, R::ZERO, is_mixed) * self.scale();
        // Between an end and the outermost node lies at least a tenth of the part's measure or of its emission.
        let [a, b] = self.edge.map_or([R::ZERO; 2], |(_, ends)| ends.map(|end| end.emission * end.visibility));
        seen.max(self.share * R::from_f64(0.1) * (a - b).abs())
    }

    fn scale(&self) -> R {
        let measure = self.rule.measure();
        if measure > R::ZERO { self.share / measure } else { R::ZERO }
    }
}

/// The parts of a slice.
struct Parts<R> {
    parts: [Part<R>; PARTS],
    count: usize,
}

impl<R: Real> Parts<R> {
    fn used(&self) -> &[Part<R>] {
        self.parts.get(..self.count).unwrap_or_default()
    }

    fn light(&self) -> Light<R> {
        let mut light = Light::default();
        for part in self.used() {
            light.add(part.mean(), R::ONE);
        }
        light
    }

    fn error(&self, ratio: R, is_mixed: bool) -> R {
        self.used().iter().fold(R::ZERO, |sum, part| sum + part.error(ratio, is_mixed) + part.rest)
    }

    fn push(&mut self, part: Part<R>) {
        if let Some(slot) = self.parts.get_mut(self.count) {
            *slot = part;
            self.count += 1;
        }
    }

    fn worst(&mut self, ratio: R, is_mixed: bool) -> Option<&mut Part<R>> {
        let used = self.parts.get_mut(..self.count)?;
        let mut worst: Option<(&mut Part<R>, R)> = None;
        for part in used {
            let error = part.error(ratio, is_mixed);
            if error > worst.as_ref().map_or(R::ZERO, |w| w.1) {
                worst = Some((part, error));
            }
        }
        worst.map(|(part, _)| part)
    }
}
