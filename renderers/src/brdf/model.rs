//! The models' values.

use spectral_core::brdf::{Brdf as _, Variant, Ward};

/// The BRDF in 1/sr with ρ_s = 1 for unit vectors to the light and the viewer, z along the normal and x along which α_u
/// is the roughness; NaN for a roughness that the model refuses, which is outside [`ALPHA_RANGE`](super::ALPHA_RANGE).
pub(super) fn evaluate(model: Variant, [alpha_u, alpha_v]: [f64; 2], light: [f64; 3], view: [f64; 3]) -> f64 {
    Ward::new(model, alpha_u, alpha_v).map_or(f64::NAN, |ward| ward.evaluate(light, view))
}
