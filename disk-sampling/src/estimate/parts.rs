//! The ratio estimator on a given subdivision.

use spectral_core::Real;

use super::{Aim, EstimateError, Response};
use crate::partition::Subsource;
use crate::shape::{Disk, Receiver};

/// exact · Σ w k f V / Σ w k f over the subsources that hit, with k = cosθ cosθ′/d²: the unoccluded value times the
/// visible share, so that receivers that nothing occludes are exact with any number of samples (0 when no sample is
/// above the horizon).
///
/// `exact` is the value with V = 1: for f = 1 the configuration factor in closed form. Returned are the value and the
/// number of samples asked for; subsources that miss or lie below the horizon are not.
///
/// # Errors
/// [`EstimateError::Exact`], [`EstimateError::Response`].
pub fn ratio_of_parts<R: Real>(
    parts: impl Iterator<Item = Subsource<R>>,
    disk: &Disk<R>,
    receiver: &Receiver<R>,
    exact: R,
    mut respond: impl FnMut(&Aim<R>) -> Response<R>,
) -> Result<(R, usize), EstimateError> {
    if !(exact >= R::ZERO && exact.is_finite()) {
        return Err(EstimateError::Exact);
    }
    let [x, y, height] = disk.local(receiver.position());
    let normal = disk.direction(receiver.normal());
    let (mut lit, mut full, mut samples) = (R::ZERO, R::ZERO, 0);
    if !(height > R::ZERO) {
        return Ok((R::ZERO, 0));
    }
    for part in parts.filter(Subsource::hits) {
        let on_disk = part.position();
        let away = [on_disk[0] - x, on_disk[1] - y];
        let distance = away[0].hypot(away[1]).hypot(height);
        // Divided step by step: d⁴ would overflow long before its parts do.
        let cosine = height / distance;
        let towards = (normal[0] * away[0] + normal[1] * away[1] - normal[2] * height) / distance;
        if !(towards > R::ZERO) {
            continue;
        }
        let scale = height / distance;
        let kernel = part.weight() * towards * cosine * scale * scale;
        let response = respond(&Aim { on_disk, point: disk.point(on_disk), cosine });
        samples += 1;
        response.check()?;
        full += kernel * response.emission;
        lit += kernel * response.emission * response.visibility;
    }
    Ok((if full > R::ZERO { exact * (lit / full) } else { R::ZERO }, samples))
}
