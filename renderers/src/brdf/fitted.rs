//! What a fit found.

use core::f64::consts::FRAC_1_PI;

use serde::Serialize;
use spectral_core::brdf::Variant;

use super::model::evaluate;

/// A fitted model: the BRDF is ρ (ρ_s f + (1 − ρ_s)/π), with f the model for ρ_s = 1.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Fit {
    /// The model's name.
    pub model: &'static str,
    /// The specular share ρ_s of the total reflectance, in [0, 1].
    pub rho_s: f64,
    /// The roughness; √(α_u α_v) when there are two.
    pub alpha: f64,
    /// The roughness along x.
    pub alpha_u: f64,
    /// The roughness along y.
    pub alpha_v: f64,
    /// The total reflectance ρ.
    pub reflectance: f64,
    /// Whether ρ was fitted.
    pub reflectance_fitted: bool,
    /// ρ ρ_s, the reflectance that multiplies f.
    pub specular_reflectance: f64,
    /// ρ (1 − ρ_s).
    pub diffuse_reflectance: f64,
    /// Σ g² with g = (reading − model) cos θ_l, in 1/sr² (2.36, 2.37), whatever the loss.
    pub residual: f64,
    /// The sum of losses that is least; `residual` for the plain loss.
    pub cost: f64,
    /// The scale of a robust loss in 1/sr.
    pub loss_scale: Option<f64>,
    /// The parameters that the readings determine, for the next four.
    pub parameters: Vec<&'static str>,
    /// Their standard errors, if residuals are independent and of equal spread after weighting.
    pub standard_errors: Vec<f64>,
    /// Their covariance.
    pub covariance: Vec<Vec<f64>>,
    /// Their correlation.
    pub correlation: Vec<Vec<f64>>,
    /// The ratio of the extreme singular values of the Jacobian with its columns scaled to unit length; infinite (`null`
    /// in JSON) when they depend on each other.
    pub condition_number: f64,
    /// Descents of this fit.
    pub starts: usize,
    /// How many of them ended here.
    pub starts_agreeing: usize,
    /// Steps of the descent that ended lowest.
    pub iterations: usize,
    /// Whether that descent ended at a vanishing gradient.
    pub converged: bool,
    /// Where the descents ended, the lowest first.
    pub minima: Vec<LocalMinimum>,
    /// Whether the readings determine all parameters that were sought.
    pub determined: bool,
    /// If not, why.
    pub reason: Option<String>,
    /// Residuals by direction of light.
    pub incidences: Vec<Incidence>,
    /// Every reading with the model's value.
    pub readings: Vec<FittedReading>,
}

/// An end of descents.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LocalMinimum {
    /// How many descents ended here.
    pub starts: usize,
    /// The sum of losses.
    pub cost: f64,
    /// The total reflectance.
    pub reflectance: f64,
    /// The specular share.
    pub rho_s: f64,
    /// The roughness along x.
    pub alpha_u: f64,
    /// The roughness along y.
    pub alpha_v: f64,
    /// The range of √(α_u α_v) where descents ended with this cost: wide in a valley.
    pub alpha_range: [f64; 2],
}

/// The readings for one direction of light.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Incidence {
    /// The polar angle of the light in degrees.
    pub theta_l_deg: f64,
    /// The azimuth of the light in degrees.
    pub phi_l_deg: f64,
    /// How many readings there are.
    pub readings: usize,
    /// Σ g² of these.
    pub residual: f64,
    /// The share of it that comes from views at the horizon.
    pub residual_at_horizon: f64,
    /// The largest reading in 1/sr.
    pub peak: f64,
    /// The model at this reading in 1/sr.
    pub model_at_peak: f64,
}

/// A reading with the model's value.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct FittedReading {
    /// Polar angle of the light in degrees.
    pub theta_l_deg: f64,
    /// Azimuth of the light in degrees.
    pub phi_l_deg: f64,
    /// Polar angle of the view in degrees.
    pub theta_v_deg: f64,
    /// Azimuth of the view in degrees.
    pub phi_v_deg: f64,
    /// The reading in 1/sr.
    pub value: f64,
    /// The model in 1/sr.
    pub model: f64,
    /// g in 1/sr.
    pub residual: f64,
}

impl Fit {
    /// The standard error of a parameter; `None` when the readings don't determine it.
    #[must_use]
    pub fn standard_error(&self, parameter: &str) -> Option<f64> {
        let place = self.parameters.iter().position(|&name| name == parameter)?;
        self.standard_errors.get(place).copied()
    }

    /// The fitted BRDF in 1/sr for unit vectors to the light and the viewer.
    #[must_use]
    pub fn evaluate(&self, model: Variant, light: [f64; 3], view: [f64; 3]) -> f64 {
        self.specular_reflectance * evaluate(model, [self.alpha_u, self.alpha_v], light, view)
            + self.diffuse_reflectance * FRAC_1_PI
    }
}
