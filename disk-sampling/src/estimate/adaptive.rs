//! The sum over slices, refined where its error is.

use spectral_core::Real;

use super::rule::{FINEST, Light, Nested, Node, added, node};
use super::slice::{Known, Source};
use super::slices::Slices;
use super::{Aim, Estimate, EstimateError, Request, Response, Status};
use crate::configuration_factor::disk_configuration_factor;
use crate::shape::{Disk, Receiver};

/// A strip of the disk between two chords; callers only hand in room for some.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Panel<R> {
    from: R,
    to: R,
    rule: Nested<R>,
    /// Error of the slices, which more slices don't make smaller.
    noise: R,
    is_sampled: bool,
}

/// The shares of the requested error that are left to the measure of panels and to slices.
const MEASURE_SHARE: f64 = 0.1;
const SLICE_SHARE: f64 = 0.1;
/// Refinement goes on until the estimated error is this share of the requested one, because errors are sometimes underestimated.
const AIM: f64 = 0.5;

/// (1/π) ∫ f cosθ cosθ′/d² dA to a requested relative error, asking for f (emission times visibility) at as few points as will do.
///
/// The disk's visible part is cut into slices whose cosines and distances are integrated without samples; f is sampled by three-point Gauss rules
/// for that very measure, in each slice and over the slices, and divided where the fall of its coefficients shows an error. Light that is
/// the same everywhere takes 9 samples wherever the receiver is, near contact and grazing included. Edges of visibility are found by bisection along
/// the slices.
///
/// Domain: all receivers; 0 with no samples behind or in the plane of the disk and below the receiver's horizon. What is smaller than the distance
/// between samples can be missed: [`Request::strata`] sets the least number. The answer is the best within `panels` and `max_samples`, with a
/// [`Status`] that says whether it meets the request; `max_samples` may be exceeded by the last slice's.
///
/// # Errors
/// [`EstimateError`] for a request out of range, no panels, or a closure that answers with a negative number, ∞ or NaN.
pub fn integrate<R: Real>(
    disk: &Disk<R>,
    receiver: &Receiver<R>,
    request: &Request<R>,
    panels: &mut [Panel<R>],
    respond: impl FnMut(&Aim<R>) -> Response<R>,
) -> Result<Estimate<R>, EstimateError> {
    run(disk, receiver, None, request, panels, respond)
}

/// The ratio estimator: exact · ∫ f V k / ∫ f k, with k = cosθ cosθ′/d² and `exact` the unoccluded value (1/π) ∫ f k dA in closed form.
///
/// Receivers that nothing occludes are exact with any number of samples; else samples follow the shadow's edge until the requested relative error of the
/// result is met. Domain, status and errors as [`integrate`]'s; [`EstimateError::Exact`] for a negative or infinite `exact`.
///
/// # Errors
/// [`EstimateError`].
pub fn ratio<R: Real>(
    disk: &Disk<R>,
    receiver: &Receiver<R>,
    exact: R,
    request: &Request<R>,
    panels: &mut [Panel<R>],
    respond: impl FnMut(&Aim<R>) -> Response<R>,
) -> Result<Estimate<R>, EstimateError> {
    if !(exact >= R::ZERO && exact.is_finite()) {
        return Err(EstimateError::Exact);
    }
    run(disk, receiver, Some(exact), request, panels, respond)
}

fn run<R: Real>(
    disk: &Disk<R>,
    receiver: &Receiver<R>,
    exact: Option<R>,
    request: &Request<R>,
    panels: &mut [Panel<R>],
    respond: impl FnMut(&Aim<R>) -> Response<R>,
) -> Result<Estimate<R>, EstimateError> {
    let relative = request.relative_error;
    if !(relative > R::ZERO && relative < R::ONE) {
        return Err(EstimateError::RelativeError);
    }
    let strata = request.strata.max(1);
    if panels.len() < strata {
        return Err(EstimateError::NoPanels);
    }
    let Some(slices) = Slices::new(disk, receiver) else {
        return Ok(Estimate { value: R::ZERO, error: R::ZERO, samples: 0, status: Status::Met });
    };
    let tolerance = relative * R::from_f64(SLICE_SHARE);
    let max_samples = request.max_samples;
    let source = Source {
        disk,
        slices,
        respond,
        samples: 0,
        max_samples,
        tolerance,
        strata,
        is_ratio: exact.is_some(),
        first: None,
        is_mixed: false,
    };
    let factor = disk_configuration_factor(disk, receiver);
    let exact = exact.unwrap_or(factor);
    let mut panels = Panels { panels, count: 0, factor, source };
    panels.measure_all(strata, relative * R::from_f64(MEASURE_SHARE));
    panels.sample_all()?;
    panels.look_again(strata, relative * R::from_f64(MEASURE_SHARE))?;
    let status = panels.refine(relative)?;
    let light = panels.light();
    let error = panels.error(light.ratio());
    let scale = if light.full > R::ZERO { exact / light.full } else { R::ZERO };
    let samples = panels.source.samples;
    Ok(Estimate { value: exact * light.ratio(), error: error * scale, samples, status })
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

    fn halves(&self, slices: &Slices<R>) -> Option<[Self; 2]> {
        let middle = R::HALF * (self.from + self.to);
        let is_wide = self.half() > R::from_f64(128.0) * R::EPSILON;
        is_wide.then(|| [Self::measured(slices, self.from, middle), Self::measured(slices, middle, self.to)])
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
struct Panels<'a, 'b, R, F> {
    panels: &'b mut [Panel<R>],
    count: usize,
    /// The disk's configuration factor in closed form.
    factor: R,
    source: Source<'a, R, F>,
}

impl<R: Real, F: FnMut(&Aim<R>) -> Response<R>> Panels<'_, '_, R, F> {
    fn used(&self) -> &[Panel<R>] {
        self.panels.get(..self.count).unwrap_or_default()
    }

    fn light(&self) -> Light<R> {
        let mut light = Light::default();
        for panel in self.used() {
            light.add(panel.rule.integral(), panel.half());
        }
        light
    }

    fn error(&self, ratio: R) -> R {
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
        let relative = (self.measure() / self.factor - R::ONE).abs();
        if relative <= R::ONE { relative } else { R::ONE }
    }

    fn push(&mut self, panel: Panel<R>) {
        if let Some(slot) = self.panels.get_mut(self.count) {
            *slot = panel;
            self.count += 1;
        }
    }

    /// Divides the disk, without samples, into panels whose measures sum to its configuration factor within a relative error.
    fn measure_all(&mut self, strata: usize, relative: R) {
        let end = self.source.slices.end;
        let place = |i: usize| end * R::from_usize(i) / R::from_usize(strata);
        for i in 0..strata {
            self.push(Panel::measured(&self.source.slices, place(i), place(i + 1)));
        }
        while self.mismatch() > relative && self.count < self.panels.len() {
            let index = self.largest(|panel| (panel.rule.measure_at(FINEST) - panel.rule.measure_at(FINEST - 1)).abs());
            let Some((index, panel)) = index else { return };
            let Some([left, right]) = panel.halves(&self.source.slices) else { return };
            self.replace(index, left);
            self.push(right);
        }
    }

    /// Where the first samples see only darkness, or light and shadow, samples anew: more finely, and with an eye for edges.
    fn look_again(&mut self, strata: usize, relative: R) -> Result<(), EstimateError> {
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

    fn sample_all(&mut self) -> Result<(), EstimateError> {
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
            let ratio = (light.full > R::ZERO).then_some(light.ratio());
            let typical = if mass > R::ZERO { light.lit / mass } else { R::ZERO };
            let mean = self.source.mean(&slice, Known { ratio, typical })?;
            panel.rule.set_light(number, mean.light);
            let weight = weights.get(panel.rule.level).copied().unwrap_or_default() * panel.half() * slice.mass;
            panel.noise += weight * mean.error;
            light.add(mean.light, weight);
            mass += weight;
        }
        panel.rule.summarise();
        panel.is_sampled = true;
        Ok(())
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

    /// Gives the panel of the largest error a finer rule, or halves it, until the sum is as requested.
    fn refine(&mut self, relative: R) -> Result<Status, EstimateError> {
        loop {
            let light = self.light();
            let ratio = light.ratio();
            if self.error(ratio) <= R::from_f64(AIM) * relative * light.lit {
                return Ok(Status::Met);
            }
            if self.source.is_spent() {
                return Ok(Status::Samples);
            }
            let mismatch = self.mismatch();
            let worst = self.largest(|panel| panel.error(ratio, mismatch, self.source.is_mixed));
            let Some((index, mut panel)) = worst else { return Ok(Status::Resolution) };
            if panel.rule.is_smooth(ratio) {
                panel.rule.level += 1;
                // The coarser rule's slices weigh less in the finer one.
                panel.noise *= R::HALF;
                self.sample(&mut panel)?;
            } else {
                if self.count >= self.panels.len() {
                    return Ok(Status::Panels);
                }
                let Some([mut left, mut right]) = panel.halves(&self.source.slices) else {
                    return Ok(Status::Resolution);
                };
                self.sample(&mut left)?;
                self.sample(&mut right)?;
                self.push(right);
                panel = left;
            }
            self.replace(index, panel);
        }
    }
}
