//! Estimates to a requested relative error: what callers call.

use spectral_core::Real;

use super::panels::{Panel, Panels};
use super::slice::{REMEMBERED, Source};
use super::slices::Slices;
use super::{Aim, Estimate, EstimateError, Request, Response, Status};
use crate::configuration_factor::disk_configuration_factor;
use crate::shape::{Disk, Receiver};
use crate::vector::{normalized, subtract};

/// The shares of the requested error that are left to the measure of panels and to slices.
const MEASURE_SHARE: f64 = 0.1;
const SLICE_SHARE: f64 = 0.1;
/// Refinement goes on until the estimated error is this share of the requested one, because errors are sometimes
/// underestimated.
pub(super) const AIM: f64 = 0.5;

/// (1/π) ∫ f cosθ cosθ′/d² dA to a requested relative error, asking for f (emission times visibility) at as few points
/// as will do.
///
/// The disk's visible part is cut into slices, planes through the receiver, in which cosines and distances are
/// integrated without samples; f is sampled in slices and over slices by nested rules of 3, 7 and 15 points, exact for
/// polynomials times that very measure, and divided where the changes from rule to rule, or the rule's errors for
/// functions of known mean, show an error. The sum is scaled by the closed form, so that light that is the same
/// everywhere is exact from 9 samples on wherever the receiver is, near contact and grazing included. Edges of
/// visibility are found by bisection along the slices, and the slices where their pattern changes by bisection over the
/// slices.
///
/// Domain: all receivers; 0 with no samples behind or in the plane of the disk and below the receiver's horizon. What
/// is smaller than the distance between samples can be missed: [`Request::strata`] sets the least number. The answer is
/// the best within `panels` and `max_samples`, with a [`Status`] that says whether it meets the request; `max_samples`
/// may be exceeded by the last slice's.
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

/// The ratio estimator: exact · ∫ f V k / ∫ f k, with k = cosθ cosθ′/d² and `exact` the unoccluded value (1/π) ∫ f k dA
/// in closed form.
///
/// Receivers that nothing occludes are exact with any number of samples; else samples follow the shadow's edge until
/// the requested relative error of the result is met. Domain, status and errors as [`integrate`]'s;
/// [`EstimateError::Exact`] for a negative or infinite `exact`.
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
    mut respond: impl FnMut(&Aim<R>) -> Response<R>,
) -> Result<Estimate<R>, EstimateError> {
    let relative = request.relative_error;
    if !(relative > R::ZERO && relative < R::ONE) {
        return Err(EstimateError::RelativeError);
    }
    let strata = request.strata.max(1);
    if panels.len() < strata {
        return Err(EstimateError::NoPanels);
    }
    let factor = disk_configuration_factor(disk, receiver);
    let slices = Slices::new(disk, receiver).filter(|_| factor > R::ZERO);
    let Some(slices) = slices else {
        return from_afar(disk, receiver, factor, exact, respond);
    };
    let tolerance = relative * R::from_f64(SLICE_SHARE);
    let max_samples = request.max_samples;
    let source = Source {
        disk,
        slices,
        respond: &mut respond,
        samples: 0,
        max_samples,
        tolerance,
        strata,
        is_ratio: exact.is_some(),
        first: None,
        is_mixed: false,
        narrow: [None; REMEMBERED],
        next: 0,
    };
    let mut panels = Panels::new(panels, factor, source);
    panels.measure_all(strata, relative * R::from_f64(MEASURE_SHARE));
    panels.sample_all()?;
    panels.look_again(strata, relative * R::from_f64(MEASURE_SHARE))?;
    let status = panels.refine(relative)?;
    let light = panels.light();
    let error = panels.error(light.ratio());
    let samples = panels.source.samples;
    let scale = exact.unwrap_or(factor) / light.full;
    let is_number = [light.full, light.lit, scale, error * scale].iter().all(|x| x.is_finite());
    if !(light.full > R::ZERO && is_number) {
        // Seen so nearly edge-on that squares underflow.
        let estimate = from_afar(disk, receiver, factor, exact, respond)?;
        return Ok(Estimate { samples: samples + estimate.samples, ..estimate });
    }
    // Coarse rules have weights of either sign.
    let ratio = light.ratio().max(R::ZERO);
    let value = exact.map_or_else(|| factor * ratio, |exact| exact * ratio.min(R::ONE));
    Ok(Estimate { value, error: error * scale, samples, status })
}

/// The estimate where slices cannot be had: nothing, or a disk so far away that its centre stands for all of it.
fn from_afar<R: Real>(
    disk: &Disk<R>,
    receiver: &Receiver<R>,
    factor: R,
    exact: Option<R>,
    mut respond: impl FnMut(&Aim<R>) -> Response<R>,
) -> Result<Estimate<R>, EstimateError> {
    if !(factor > R::ZERO) {
        return Ok(Estimate { value: R::ZERO, error: R::ZERO, samples: 0, status: Status::Met });
    }
    let [_, _, cosine] = normalized(subtract(receiver.position(), disk.centre()))
        .map_or([R::ZERO, R::ZERO, R::ONE], |direction| disk.direction(direction));
    let response = respond(&Aim { on_disk: [R::ZERO; 2], point: disk.centre(), cosine: cosine.max(R::ZERO) });
    response.check()?;
    let value = match exact {
        Some(exact) if response.emission > R::ZERO => exact * response.visibility,
        Some(_) => R::ZERO,
        None => factor * response.emission * response.visibility,
    };
    Ok(Estimate { value, error: R::ZERO, samples: 1, status: Status::Met })
}
