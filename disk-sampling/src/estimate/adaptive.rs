//! The sum over slices, refined where its error is.

use spectral_core::Real;

use super::rule::{Gauss3, POINTS, kronrod};
use super::slice::{Light, Source};
use super::slices::Slices;
use super::{Aim, Estimate, EstimateError, Request, Response, Status};
use crate::shape::{Disk, Receiver};

/// A strip of the disk between two chords; callers only hand in room for some.
#[derive(Clone, Copy, Debug, Default)]
pub struct Panel<R> {
    from: R,
    to: R,
    /// The strip's configuration factor, and how far it may be off.
    mass: R,
    mass_error: R,
    lit: R,
    full: R,
    /// Error that finer panels make smaller, and error that they don't.
    error: R,
    noise: R,
}

/// The share of the requested error that is left to the disk and the cosines, to slices, and to panels too small to matter.
const MASS_SHARE: f64 = 0.1;
const SLICE_SHARE: f64 = 0.2;
const SMALL_SHARE: f64 = 0.02;

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
    mut emission: impl FnMut(&Aim<R>) -> R,
) -> Result<Estimate<R>, EstimateError> {
    let respond = |aim: &Aim<R>| Response { emission: emission(aim), visibility: R::ONE };
    Ok(run(disk, receiver, request, panels, respond, false)?.estimate())
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
    let outcome = run(disk, receiver, request, panels, respond, true)?;
    let scale = if outcome.full > R::ZERO { exact / outcome.full } else { R::ZERO };
    let Estimate { value, error, samples, status } = outcome.estimate();
    Ok(Estimate { value: value * scale, error: error * scale, samples, status })
}

struct Outcome<R> {
    lit: R,
    full: R,
    error: R,
    samples: usize,
    status: Status,
}

impl<R: Real> Outcome<R> {
    fn estimate(self) -> Estimate<R> {
        Estimate { value: self.lit, error: self.error, samples: self.samples, status: self.status }
    }
}

fn run<R: Real>(
    disk: &Disk<R>,
    receiver: &Receiver<R>,
    request: &Request<R>,
    panels: &mut [Panel<R>],
    respond: impl FnMut(&Aim<R>) -> Response<R>,
    is_ratio: bool,
) -> Result<Outcome<R>, EstimateError> {
    let relative = request.relative_error;
    if !(relative > R::ZERO && relative < R::ONE) {
        return Err(EstimateError::RelativeError);
    }
    let strata = request.strata.max(1);
    if panels.len() < strata {
        return Err(EstimateError::NoPanels);
    }
    let Some(slices) = Slices::new(disk, receiver) else {
        return Ok(Outcome { lit: R::ZERO, full: R::ZERO, error: R::ZERO, samples: 0, status: Status::Met });
    };
    let tolerance = relative * R::from_f64(SLICE_SHARE);
    let max_samples = request.max_samples;
    let source = Source { disk, slices, respond, samples: 0, max_samples, tolerance, strata, is_ratio };
    let mut panels = Panels { panels, count: 0, source };
    panels.measure(strata, relative * R::from_f64(MASS_SHARE));
    panels.sample_all(relative)?;
    panels.refine(relative)
}

/// The panels in use.
struct Panels<'a, 'b, R, F> {
    panels: &'b mut [Panel<R>],
    count: usize,
    source: Source<'a, R, F>,
}

impl<R: Real, F: FnMut(&Aim<R>) -> Response<R>> Panels<'_, '_, R, F> {
    fn used(&self) -> &[Panel<R>] {
        self.panels.get(..self.count).unwrap_or_default()
    }

    fn sum(&self, of: impl Fn(&Panel<R>) -> R) -> R {
        self.used().iter().fold(R::ZERO, |sum, panel| sum + of(panel))
    }

    /// Divides the disk into panels whose masses are known to a relative error, without samples.
    fn measure(&mut self, strata: usize, relative: R) {
        let end = self.source.slices.end;
        let place = |i: usize| end * R::from_usize(i) / R::from_usize(strata);
        for i in 0..strata {
            self.push(measured(&self.source.slices, place(i), place(i + 1)));
        }
        loop {
            let mass = self.sum(|panel| panel.mass);
            if self.sum(|panel| panel.mass_error) <= relative * mass {
                return;
            }
            let Some(index) = self.largest(|panel| panel.mass_error) else { return };
            let Some([left, right]) = self.halves(index) else { return };
            self.replace(index, left, right);
        }
    }

    fn push(&mut self, panel: Panel<R>) {
        if let Some(slot) = self.panels.get_mut(self.count) {
            *slot = panel;
            self.count += 1;
        }
    }

    fn replace(&mut self, index: usize, left: Panel<R>, right: Panel<R>) {
        if let Some(slot) = self.panels.get_mut(index) {
            *slot = left;
        }
        self.push(right);
    }

    /// The panel with the largest of something that is above 0.
    fn largest(&self, of: impl Fn(&Panel<R>) -> R) -> Option<usize> {
        let mut best = (None, R::ZERO);
        for (index, panel) in self.used().iter().enumerate() {
            if of(panel) > best.1 {
                best = (Some(index), of(panel));
            }
        }
        best.0
    }

    /// A panel's halves, measured; `None` where there is no room or nothing to halve.
    fn halves(&self, index: usize) -> Option<[Panel<R>; 2]> {
        let panel = self.used().get(index)?;
        let middle = R::HALF * (panel.from + panel.to);
        let is_wide = panel.to - panel.from > R::from_f64(256.0) * R::EPSILON;
        if self.count >= self.panels.len() || !is_wide {
            return None;
        }
        let slices = &self.source.slices;
        Some([measured(slices, panel.from, middle), measured(slices, middle, panel.to)])
    }

    fn sample_all(&mut self, relative: R) -> Result<(), EstimateError> {
        let small = self.sum(|panel| panel.mass) * relative * R::from_f64(SMALL_SHARE);
        for index in 0..self.count {
            let Some(mut panel) = self.panels.get(index).copied() else { continue };
            self.sample(&mut panel, small)?;
            if let Some(slot) = self.panels.get_mut(index) {
                *slot = panel;
            }
        }
        Ok(())
    }

    /// Estimates a panel: by three slices, or by one point when its mass is at most `small`.
    fn sample(&mut self, panel: &mut Panel<R>, small: R) -> Result<(), EstimateError> {
        let (mass, half) = (panel.mass, R::HALF * (panel.to - panel.from));
        if !(mass > R::ZERO) {
            return Ok(());
        }
        let rule = if mass > small { panel_rule(&self.source.slices, panel) } else { None };
        let place = |node: R| panel.from + half * (node + R::ONE);
        let Some(rule) = rule else {
            let slice = self.source.slices.at(place(R::ZERO));
            let response = self.source.ask(&slice, R::HALF)?;
            let lit = response.emission * response.visibility;
            (panel.lit, panel.full, panel.error) = (mass * lit, mass * response.emission, mass * response.emission);
            panel.noise = panel.mass_error * lit;
            return Ok(());
        };
        let mut lights = [Light::NONE; 3];
        for (light, node) in lights.iter_mut().zip(rule.nodes) {
            let slice = self.source.slices.at(place(node));
            *light = self.source.mean(&slice)?;
        }
        let noise = (0..3).fold(R::ZERO, |sum, i| sum + rule.weights[i] * lights[i].error);
        let light = self.source.combine(&rule, &lights);
        panel.lit = mass * light.lit;
        panel.full = mass * light.full;
        panel.error = mass * (light.error - noise).max(R::ZERO);
        panel.noise = mass * noise + if self.source.is_ratio { R::ZERO } else { panel.mass_error * light.lit };
        Ok(())
    }

    /// Halves the panel of the largest error until the sum is as requested.
    fn refine(mut self, relative: R) -> Result<Outcome<R>, EstimateError> {
        let status = loop {
            let lit = self.sum(|panel| panel.lit);
            let (error, noise) = (self.sum(|panel| panel.error), self.sum(|panel| panel.noise));
            if error + noise <= relative * lit {
                break Status::Met;
            }
            if self.source.is_spent() {
                break Status::Samples;
            }
            let Some(index) = self.largest(|panel| panel.error) else { break Status::Resolution };
            let Some([mut left, mut right]) = self.halves(index) else {
                break if self.count >= self.panels.len() { Status::Panels } else { Status::Resolution };
            };
            let small = R::from_f64(SMALL_SHARE) * relative * lit;
            self.sample(&mut left, small)?;
            self.sample(&mut right, small)?;
            self.replace(index, left, right);
        };
        let error = self.sum(|panel| panel.error + panel.noise);
        let (lit, full) = (self.sum(|panel| panel.lit), self.sum(|panel| panel.full));
        Ok(Outcome { lit, full, error, samples: self.source.samples, status })
    }
}

/// A panel with its mass by Kronrod's rule; the error is judged from how far Gauss's is from it.
fn measured<R: Real>(slices: &Slices<R>, from: R, to: R) -> Panel<R> {
    let half = R::HALF * (to - from);
    let (mut mass, mut coarse) = (R::ZERO, R::ZERO);
    for index in 0..POINTS {
        let (node, weight, gauss) = kronrod::<R>(index);
        let value = half * slices.at(from + half * (node + R::ONE)).mass;
        mass += weight * value;
        coarse += gauss * value;
    }
    // Kronrod's rule has more than twice the degree of Gauss's: its error is about the power 3/2 of the other's.
    let difference = (mass - coarse).abs();
    let relative = if mass > R::ZERO { difference / mass } else { R::ZERO };
    let mass_error = difference * (R::from_f64(30.0) * relative).sqrt().min(R::ONE);
    Panel { from, to, mass, mass_error, ..Panel::default() }
}

/// The rule for a panel's masses.
fn panel_rule<R: Real>(slices: &Slices<R>, panel: &Panel<R>) -> Option<Gauss3<R>> {
    let half = R::HALF * (panel.to - panel.from);
    let points: [(R, R); POINTS] = core::array::from_fn(|index| {
        let (node, weight, _) = kronrod::<R>(index);
        (node, weight * slices.at(panel.from + half * (node + R::ONE)).mass)
    });
    Gauss3::of(&points)
}
