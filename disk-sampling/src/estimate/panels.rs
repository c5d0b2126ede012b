//! Panels, strips of the disk between two slices: the sum over slices, refined where its error is.

use spectral_core::Real;

use super::adaptive::AIM;
use super::rule::{FINEST, Light, NODES_ALL, Nested, Node, added, node};
use super::slice::{Known, Mean, Pattern, Source};
use super::slices::{Slice, Slices};
use super::{Aim, EstimateError, Response, Status};

/// A strip of the disk between two chords; callers only hand in room for some.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Panel<R> {
    from: R,
    to: R,
    rule: Nested<R>,
    patterns: [Pattern; NODES_ALL],
    /// Whether the panel ends at a known kink on either side.
    closed: [bool; 2],
    /// Error of the slices, which more slices don't make smaller.
    noise: R,
    is_sampled: bool,
}

/// The share of the requested error that the place of a kink may make.
const KINK_SHARE: f64 = 0.1;
/// The largest number of kinks that are looked for.
const KINKS: usize = 16;

/// Two neighbouring slices of different pattern.
#[derive(Clone, Copy, Debug)]
struct Kink<R> {
    bracket: [R; 2],
    patterns: [Pattern; 2],
    lights: [Light<R>; 2],
}

impl<R: Real> Panel<R> {
    fn half(&self) -> R {
        R::HALF * (self.to - self.from)
    }

    /// A panel with the measures of slices at all nodes, without light.
    fn measured(slices: &Slices<R>, from: R, to: R) -> Self {
        let mut panel = Self { from, to, ..Self::default() };
        let half = panel.half();
        panel.rule.measure_to(FINEST, |place| {
            let chi = from + half * (place + R::ONE);
            let slice = slices.at(chi);
            Node::new(slice.mass, chi.cos(), [slice.slant, slice.across])
        });
        panel
    }

    /// The panel divided at χ, without light; `None` where that leaves next to nothing on a side.
    fn divided(&self, slices: &Slices<R>, chi: R) -> Option<[Self; 2]> {
        let is_wide = (chi - self.from).min(self.to - chi) > R::from_f64(64.0) * R::EPSILON;
        is_wide.then(|| [Self::measured(slices, self.from, chi), Self::measured(slices, chi, self.to)])
    }

    /// The sampled slice with the smallest χ above a given one: χ, pattern and light.
    fn next(&self, above: R) -> Option<(R, Pattern, Light<R>)> {
        self.slices().filter(|slice| slice.0 > above).reduce(|a, b| if b.0 < a.0 { b } else { a })
    }

    fn last(&self) -> Option<(R, Pattern, Light<R>)> {
        self.slices().reduce(|a, b| if b.0 > a.0 { b } else { a })
    }

    fn slices(&self) -> impl Iterator<Item = (R, Pattern, Light<R>)> {
        let count = if self.is_sampled { added(self.rule.level).end } else { 0 };
        self.patterns
            .iter()
            .enumerate()
            .take(count)
            .map(|(number, pattern)| (self.place(number), *pattern, self.rule.light(number)))
    }

    fn place(&self, number: usize) -> R {
        let (node, _) = node::<R>(number);
        self.from + self.half() * (node + R::ONE)
    }

    fn measure(&self) -> R {
        self.half() * self.rule.measure()
    }

    /// The error that more slices make smaller.
    fn error(&self, ratio: R, mismatch: R, is_mixed: bool) -> R {
        self.half() * self.rule.error(ratio, mismatch, is_mixed)
    }
}

/// The panels in use.
pub(super) struct Panels<'a, 'b, R, F> {
    panels: &'b mut [Panel<R>],
    count: usize,
    /// The disk's configuration factor in closed form.
    factor: R,
    /// How many more kinks are looked for.
    kinks_left: usize,
    pub(super) source: Source<'a, R, F>,
}

impl<'a, 'b, R: Real, F: FnMut(&Aim<R>) -> Response<R>> Panels<'a, 'b, R, F> {
    pub(super) const fn new(panels: &'b mut [Panel<R>], factor: R, source: Source<'a, R, F>) -> Self {
        Self { panels, count: 0, factor, kinks_left: KINKS, source }
    }

    fn used(&self) -> &[Panel<R>] {
        self.panels.get(..self.count).unwrap_or_default()
    }

    pub(super) fn light(&self) -> Light<R> {
        let mut light = Light::default();
        for panel in self.used() {
            light.add(panel.rule.integral(), panel.half());
        }
        light
    }

    pub(super) fn error(&self, ratio: R) -> R {
        let mismatch = self.mismatch();
        self.used()
            .iter()
            .fold(R::ZERO, |sum, panel| sum + panel.error(ratio, mismatch, self.source.is_mixed) + panel.noise)
    }

    /// The disk's configuration factor by the panels' rules.
    fn measure(&self) -> R {
        self.used().iter().fold(R::ZERO, |sum, panel| sum + panel.measure())
    }

    /// How far that is from the closed form, relatively.
    fn mismatch(&self) -> R {
        if self.source.slices.is_blurred {
            return R::ZERO;
        }
        let relative = (self.measure() / self.factor - R::ONE).abs();
        if relative <= R::ONE { relative } else { R::ONE }
    }

    fn push(&mut self, panel: Panel<R>) {
        if let Some(slot) = self.panels.get_mut(self.count) {
            *slot = panel;
            self.count += 1;
        }
    }

    /// Divides the disk, without samples, into panels whose measures sum to its configuration factor within a relative
    /// error.
    pub(super) fn measure_all(&mut self, strata: usize, relative: R) {
        let end = self.source.slices.end;
        let place = |i: usize| end * R::from_usize(i) / R::from_usize(strata);
        for i in 0..strata {
            self.push(Panel::measured(&self.source.slices, place(i), place(i + 1)));
        }
        while self.mismatch() > relative && self.count < self.panels.len() {
            let index = self.largest(|panel| (panel.rule.measure_at(FINEST) - panel.rule.measure_at(FINEST - 1)).abs());
            let Some((index, panel)) = index else { return };
            let middle = R::HALF * (panel.from + panel.to);
            let Some([left, right]) = panel.divided(&self.source.slices, middle) else { return };
            self.replace(index, left);
            self.push(right);
        }
    }

    /// Where the first samples see only darkness, or light and shadow, samples anew: more finely, and with an eye for
    /// edges.
    pub(super) fn look_again(&mut self, strata: usize, relative: R) -> Result<(), EstimateError> {
        let is_dark = !(self.light().lit > R::ZERO);
        if !(self.source.is_mixed || is_dark) || self.source.is_spent() {
            return Ok(());
        }
        let strata = (strata * if is_dark { 3 } else { 1 }).min(self.panels.len());
        self.count = 0;
        self.source.strata = strata;
        self.measure_all(strata, relative);
        self.sample_all()
    }

    pub(super) fn sample_all(&mut self) -> Result<(), EstimateError> {
        for index in 0..self.count {
            let Some(mut panel) = self.panels.get(index).copied() else { continue };
            self.sample(&mut panel)?;
            self.replace(index, panel);
        }
        Ok(())
    }

    /// Adds the slices of the panel's level.
    fn sample(&mut self, panel: &mut Panel<R>) -> Result<(), EstimateError> {
        let (mut light, mut mass) = (self.light(), self.sampled_measure());
        for number in added(panel.rule.level) {
            let (_, weights) = node::<R>(number);
            let slice = self.source.slices.at(panel.place(number));
            let mean = self.slice(&slice, light, mass)?;
            panel.rule.set_light(number, mean.light);
            if let Some(slot) = panel.patterns.get_mut(number) {
                *slot = mean.pattern;
            }
            let weight = weights.get(panel.rule.level).copied().unwrap_or_default() * panel.half() * slice.mass;
            panel.noise += weight * mean.error;
            light.add(mean.light, weight);
            mass += weight;
        }
        panel.rule.summarise();
        panel.is_sampled = true;
        Ok(())
    }

    /// The mean of a slice, with what the panels know of `light` and its `mass`.
    fn slice(&mut self, slice: &Slice<R>, light: Light<R>, mass: R) -> Result<Mean<R>, EstimateError> {
        let ratio = (light.full > R::ZERO).then_some(light.ratio());
        let typical = if mass > R::ZERO { light.lit / mass } else { R::ZERO };
        self.source.mean(slice, Known { ratio, typical })
    }

    fn sampled_measure(&self) -> R {
        self.used().iter().filter(|panel| panel.is_sampled).fold(R::ZERO, |sum, panel| sum + panel.measure())
    }

    fn replace(&mut self, index: usize, panel: Panel<R>) {
        if let Some(slot) = self.panels.get_mut(index) {
            *slot = panel;
        }
    }

    /// The panel with the largest of something that is above 0.
    fn largest(&self, of: impl Fn(&Panel<R>) -> R) -> Option<(usize, Panel<R>)> {
        let mut best = (None, R::ZERO);
        for (index, panel) in self.used().iter().enumerate() {
            let value = of(panel);
            if value > best.1 {
                best = (Some((index, *panel)), value);
            }
        }
        best.0
    }

    /// Gives the panel of the largest error a finer rule, or divides it, until the sum is as requested.
    pub(super) fn refine(&mut self, relative: R) -> Result<Status, EstimateError> {
        loop {
            let light = self.light();
            let ratio = light.ratio();
            if self.source.is_spent() {
                return Ok(if self.is_met(relative) { Status::Met } else { Status::Samples });
            }
            let allowed = R::from_f64(KINK_SHARE) * relative * light.lit;
            if let Some(kink) = self.kink(ratio, allowed) {
                let is_split = self.split_at_kink(kink, ratio, allowed)?;
                self.kinks_left = if is_split { self.kinks_left - 1 } else { 0 };
                continue;
            }
            if self.is_met(relative) {
                return Ok(Status::Met);
            }
            let mismatch = self.mismatch();
            let worst = self.largest(|panel| panel.error(ratio, mismatch, self.source.is_mixed));
            let Some((index, mut panel)) = worst else { return Ok(Status::Resolution) };
            if panel.rule.is_smooth(ratio) {
                panel.rule.level += 1;
                // The coarser rule's slices weigh less in the finer one.
                panel.noise *= R::HALF;
                self.sample(&mut panel)?;
                self.replace(index, panel);
            } else if self.count >= self.panels.len() {
                return Ok(Status::Panels);
            } else if !self.divide(index, R::HALF * (panel.from + panel.to), false)? {
                return Ok(Status::Resolution);
            }
        }
    }

    fn is_met(&self, relative: R) -> bool {
        let light = self.light();
        self.error(light.ratio()) <= R::from_f64(AIM) * relative * light.lit
    }

    /// Divides a panel at χ and samples both; false where there is no room or the panel is too narrow.
    fn divide(&mut self, index: usize, chi: R, at_kink: bool) -> Result<bool, EstimateError> {
        let Some(panel) = self.used().get(index).copied() else { return Ok(false) };
        let Some([mut left, mut right]) = panel.divided(&self.source.slices, chi) else { return Ok(false) };
        if self.count >= self.panels.len() {
            return Ok(false);
        }
        (left.closed, right.closed) = ([panel.closed[0], at_kink], [at_kink, panel.closed[1]]);
        self.sample(&mut left)?;
        self.sample(&mut right)?;
        self.replace(index, left);
        self.push(right);
        Ok(true)
    }

    /// The first neighbours of different pattern that matter by more than `allowed`.
    fn kink(&self, ratio: R, allowed: R) -> Option<Kink<R>> {
        if !self.source.is_mixed || self.kinks_left == 0 {
            return None;
        }
        self.used().iter().find_map(|panel| {
            let before = self.used().iter().find(|before| before.to == panel.from && !panel.closed[0]);
            let mut last = before.and_then(Panel::last);
            while let Some(next) = panel.next(last.map_or(-R::ONE, |slice| slice.0)) {
                let kink = last.filter(|last| last.1 != next.1).map(|last| Kink {
                    bracket: [last.0, next.0],
                    patterns: [last.1, next.1],
                    lights: [last.2, next.2],
                });
                if let Some(kink) = kink.filter(|kink| self.weight(kink, ratio) > allowed) {
                    return Some(kink);
                }
                last = Some(next);
            }
            None
        })
    }

    /// How much the mean light between two slices may be off.
    fn weight(&self, kink: &Kink<R>, ratio: R) -> R {
        let [from, to] = kink.bracket;
        let mass = self.source.slices.at(R::HALF * (from + to)).mass * (to - from);
        mass * (kink.lights[0].excess(ratio) - kink.lights[1].excess(ratio)).abs()
    }

    /// Finds a kink by bisection and divides the panel that it is in; false where that leads nowhere.
    fn split_at_kink(&mut self, mut kink: Kink<R>, ratio: R, allowed: R) -> Result<bool, EstimateError> {
        let (light, mass) = (self.light(), self.sampled_measure());
        let middle = |kink: &Kink<R>| R::HALF * (kink.bracket[0] + kink.bracket[1]);
        while self.weight(&kink, ratio) > allowed && !self.source.is_spent() {
            let chi = middle(&kink);
            if !(chi > kink.bracket[0] && chi < kink.bracket[1]) {
                break;
            }
            let mean = self.slice(&self.source.slices.at(chi), light, mass)?;
            let side = usize::from(mean.pattern != kink.patterns[0]);
            kink.bracket[side] = chi;
            kink.lights[side] = mean.light;
        }
        let chi = middle(&kink);
        let Some(index) = self.used().iter().position(|panel| panel.from < chi && chi < panel.to) else {
            return Ok(false);
        };
        self.divide(index, chi, true)
    }
}
