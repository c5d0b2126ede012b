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
    /// Where slices had their narrowest parts, the latest ones in turns.
    pub(super) narrow: [Option<Narrow<R>>; REMEMBERED],
    pub(super) next: usize,
}

/// The middle of a slice's narrowest part between two edges: across and along the slice on the unit disk; and how many
/// edges the slice had.
#[derive(Clone, Copy, Debug)]
pub(super) struct Narrow<R> {
    across: R,
    along: R,
    edges: u8,
}

/// The number of slices whose narrowest parts are remembered.
pub(super) const REMEMBERED: usize = 16;

/// The mean light of a slice, how far its excess may be off, and how light and shadow follow each other.
#[derive(Clone, Copy, Debug)]
pub(super) struct Mean<R> {
    pub(super) light: Light<R>,
    pub(super) error: R,
    pub(super) pattern: Pattern,
}

/// How light and shadow follow each other along a slice: the number of edges, and whether it begins in the light. Where
/// neighbouring slices differ in it, the mean light has a kink.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Pattern {
    pub(super) edges: u8,
    begins_lit: bool,
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

/// The share of the error of other slices that is allowed to slices that edges may cross: places of edges jump from
/// slice to slice, and would be taken for kinks.
const EDGE_SHARE: f64 = 0.2;

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
        response.check()?;
        Ok(response)
    }

    fn light(&self, response: &Response<R>) -> Light<R> {
        let full = if self.is_ratio { response.emission } else { R::ONE };
        Light { lit: response.emission * response.visibility, full }
    }

    pub(super) const fn is_spent(&self) -> bool {
        self.samples >= self.max_samples
    }

    /// The mean over a slice by its measure cos²ξ dξ: the part with the largest error gets a finer rule or is divided,
    /// at an edge of visibility if there is one.
    pub(super) fn mean(&mut self, slice: &Slice<R>, known: Known<R>) -> Result<Mean<R>, EstimateError> {
        let mut parts = Parts { parts: [Part::default(); PARTS], count: 0 };
        let strata = self.strata.min(PARTS / 2);
        let place = |i: usize| R::from_usize(i) / R::from_usize(strata);
        for i in 0..strata {
            let part = self.part(slice, place(i), place(i + 1))?;
            parts.push(part);
        }
        let mut has_looked = !self.is_mixed;
        loop {
            let light = parts.light();
            let ratio = known.ratio.unwrap_or(light.ratio());
            let error = parts.error(ratio, self.is_mixed);
            let tolerance = if self.is_mixed { self.tolerance * R::from_f64(EDGE_SHARE) } else { self.tolerance };
            let allowed = tolerance * light.lit.max(known.typical);
            let is_settled = match parts.hidden_edge() {
                Some(edge) => !self.split_at_edge(slice, &mut parts, edge, allowed)?,
                None => error <= allowed || !self.improve(slice, &mut parts, ratio, allowed)?,
            };
            if !is_settled && !self.is_spent() {
                continue;
            }
            let pattern = parts.pattern();
            if !has_looked {
                has_looked = true;
                if self.look_for_narrow_parts(slice, &mut parts, pattern.edges, allowed)? {
                    continue;
                }
            }
            if let (Some(along), Some(slot)) = (parts.narrowest(slice), self.narrow.get_mut(self.next)) {
                *slot = Some(Narrow { across: slice.across, along, edges: pattern.edges });
                self.next = (self.next + 1) % REMEMBERED;
            }
            return Ok(Mean { light, error, pattern });
        }
    }

    /// Looks where a part between two edges should be by slices nearby that had more `edges`, too narrow perhaps to
    /// have been met: on the straight line through the two nearest, which is where it is between straight edges, and
    /// beside the nearest. Returns whether there was one.
    fn look_for_narrow_parts(
        &mut self,
        slice: &Slice<R>,
        parts: &mut Parts<R>,
        edges: u8,
        allowed: R,
    ) -> Result<bool, EstimateError> {
        for fraction in self.expected(slice, edges).into_iter().flatten() {
            let Some(part) = parts.used().iter().find(|part| part.from < fraction && fraction < part.to) else {
                continue;
            };
            let middle = (fraction, self.ask(slice, fraction)?);
            let nodes = part.samples;
            let lower = nodes.iter().rfind(|sample| sample.0 < fraction);
            let upper = nodes.iter().find(|sample| sample.0 > fraction);
            let found =
                [lower.and_then(|lower| between(lower, &middle)), upper.and_then(|upper| between(&middle, upper))];
            if found.iter().any(Option::is_some) {
                for edge in found.into_iter().flatten() {
                    self.split_at_edge(slice, parts, edge, allowed)?;
                }
                return Ok(true);
            }
        }
        Ok(false)
    }

    /// Fractions of a slice at which a narrow part is expected.
    fn expected(&self, slice: &Slice<R>, edges: u8) -> [Option<R>; 2] {
        let distance = |narrow: &Narrow<R>| (narrow.across - slice.across).abs();
        let (mut nearest, mut second): (Option<Narrow<R>>, Option<Narrow<R>>) = (None, None);
        for narrow in self.narrow.iter().flatten().filter(|narrow| narrow.edges > edges) {
            if nearest.is_none_or(|near| distance(narrow) < distance(&near)) {
                (nearest, second) = (Some(*narrow), nearest);
            } else if second.is_none_or(|near| distance(narrow) < distance(&near)) {
                second = Some(*narrow);
            }
        }
        let straight = nearest
            .zip(second)
            .filter(|(a, b)| a.across != b.across)
            .map(|(a, b)| a.along + (slice.across - a.across) / (b.across - a.across) * (b.along - a.along));
        [straight, nearest.map(|narrow| narrow.along)].map(|along| along.map(|along| slice.fraction(along)))
    }

    /// Finds an edge and divides the part that it is in; false where there is no room or nothing to divide.
    fn split_at_edge(
        &mut self,
        slice: &Slice<R>,
        parts: &mut Parts<R>,
        (bracket, ends): Edge<R>,
        allowed: R,
    ) -> Result<bool, EstimateError> {
        let (place, error) = self.find_edge(slice, bracket, ends, R::HALF * allowed)?;
        let Some(part) = parts.used_mut().iter_mut().find(|part| part.from < place && place < part.to) else {
            // The edge is where parts meet anyway.
            parts.close(place);
            return Ok(parts.hidden_edge().is_none_or(|(other, _)| other != bracket));
        };
        let (from, to, rest, closed) = (part.from, part.to, part.rest, part.closed);
        *part = self.part(slice, from, place)?;
        (part.rest, part.closed) = (rest + error, [closed[0], true]);
        let mut right = self.part(slice, place, to)?;
        right.closed = [true, closed[1]];
        Ok(parts.push(right))
    }

    /// Betters the worst part; false where it cannot be.
    fn improve(&mut self, slice: &Slice<R>, parts: &mut Parts<R>, ratio: R, allowed: R) -> Result<bool, EstimateError> {
        let is_mixed = self.is_mixed;
        let has_room = parts.count < PARTS;
        let Some(worst) = parts.worst(ratio, is_mixed) else { return Ok(false) };
        if worst.edge.is_none() && worst.rule.is_smooth(ratio) {
            worst.rule.level += 1;
            self.sample(slice, worst)?;
            return Ok(true);
        }
        let Part { from, to, rest, closed, edge, .. } = *worst;
        if !has_room || !(to - from > R::from_f64(64.0) * R::EPSILON) {
            return Ok(false);
        }
        if let Some(edge) = edge {
            return self.split_at_edge(slice, parts, edge, allowed);
        }
        let middle = R::HALF * (from + to);
        *worst = self.part(slice, from, middle)?;
        (worst.rest, worst.closed) = (rest, [closed[0], false]);
        let mut right = self.part(slice, middle, to)?;
        right.closed = [false, closed[1]];
        Ok(parts.push(right))
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
            part.samples = responses;
            part.edge = self.look_for_edge(slice, part, &responses)?;
        }
        Ok(())
    }

    /// The first two neighbours among the coarsest rule's nodes with an edge of visibility between them. Where
    /// visibility is known to change somewhere on the disk, the ends of the slice are looked at as well.
    fn look_for_edge(
        &mut self,
        slice: &Slice<R>,
        part: &Part<R>,
        responses: &[(R, Response<R>); 3],
    ) -> Result<Option<Edge<R>>, EstimateError> {
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

/// The edge between two points, if there is one.
fn between<R: Real>(a: &(R, Response<R>), b: &(R, Response<R>)) -> Option<Edge<R>> {
    differ(a.1.visibility, b.1.visibility).then_some(([a.0, b.0], [a.1, b.1]))
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
    /// The coarsest rule's samples, and whether the part ends at a known edge on either side.
    samples: [(R, Response<R>); 3],
    closed: [bool; 2],
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

    fn used_mut(&mut self) -> &mut [Part<R>] {
        self.parts.get_mut(..self.count).unwrap_or_default()
    }

    /// Adds a part; false where there is no room.
    fn push(&mut self, part: Part<R>) -> bool {
        let Some(slot) = self.parts.get_mut(self.count) else { return false };
        *slot = part;
        self.count += 1;
        true
    }

    /// An edge that is not within the samples of a part, but between those of two parts that meet.
    fn hidden_edge(&self) -> Option<Edge<R>> {
        if self.count >= PARTS {
            return None;
        }
        self.used().iter().filter(|left| !left.closed[1]).find_map(|left| {
            let right = self.used().iter().find(|right| right.from == left.to)?;
            between(&left.samples[2], &right.samples[0])
        })
    }

    /// Remembers that parts that meet at a place meet at an edge.
    fn close(&mut self, place: R) {
        let near = |x: R| (x - place).abs() <= R::from_f64(4.0) * R::EPSILON;
        for part in self.used_mut() {
            part.closed = [part.closed[0] || near(part.from), part.closed[1] || near(part.to)];
        }
    }

    /// The middle of the narrowest part between two edges, along the slice on the unit disk.
    fn narrowest(&self, slice: &Slice<R>) -> Option<R> {
        let width = |part: &Part<R>| part.to - part.from;
        let inner = self.used().iter().filter(|part| part.closed == [true; 2]);
        let narrowest = inner.reduce(|a, b| if width(a) <= width(b) { a } else { b })?;
        let [a, b] = [narrowest.from, narrowest.to].map(|fraction| slice.sample(fraction).0[1]);
        Some(R::HALF * (a + b))
    }

    fn pattern(&self) -> Pattern {
        let count = |part: &Part<R>| u8::from(part.closed[1]).saturating_add(u8::from(part.edge.is_some()));
        let edges = self.used().iter().fold(0_u8, |sum, part| sum.saturating_add(count(part)));
        let first = self.used().iter().find(|part| part.from <= R::ZERO);
        Pattern { edges, begins_lit: first.is_some_and(|part| part.samples[0].1.visibility > R::HALF) }
    }

    fn worst(&mut self, ratio: R, is_mixed: bool) -> Option<&mut Part<R>> {
        let used = self.used_mut();
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
