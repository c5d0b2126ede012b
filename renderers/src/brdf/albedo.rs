//! What a model reflects of light from one direction: quadrature with an estimate of its error.

use core::f64::consts::{FRAC_PI_2, PI};
use core::fmt;

use spectral_core::brdf::Variant;

use super::data::direction;
use super::model::evaluate;

/// The error that is asked for: this share of the albedo, or as much absolutely if that is more.
const TOLERANCE: f64 = 1e-9;
/// Intervals after which an integral in one dimension is given up.
const MAX_INTERVALS: usize = 2000;
/// Slopes of half vectors count up to so many times the roughness: e^(−81) lies beyond.
const FARTHEST: f64 = 9.0;

/// A directional albedo and its uncertainty.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Albedo {
    /// The share of the light that is reflected, for ρ_s = 1.
    pub value: f64,
    /// An estimate of the quadrature's error, absolute; usually far too large.
    pub error: f64,
}

/// Why there is no albedo.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum AlbedoError {
    /// A roughness outside [`ALPHA_RANGE`](super::ALPHA_RANGE).
    Alpha(f64),
    /// A polar angle outside [0°, 90°), in degrees: at 90° two of the models are infinite.
    Theta(f64),
}

impl fmt::Display for AlbedoError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Alpha(value) => {
                let [low, high] = super::ALPHA_RANGE;
                write!(f, "the roughness must be from {low} to {high}, not {value}")
            }
            Self::Theta(value) => write!(f, "the polar angle must be in [0°, 90°), not {value}°"),
        }
    }
}

impl core::error::Error for AlbedoError {}

/// The directional albedo a = ∫ f cos θ_v dω_v of a model with ρ_s = 1, for light from a polar angle and an azimuth in
/// degrees (2.30).
///
/// Over slopes m of the half vector h, with dω_v = 4 (l·h) h_z³ dm, in polar coordinates scaled by the roughnesses. The
/// views above the horizon are those with slopes within a circle about (tan θ, 0) of radius 1/cos θ, so that each radius
/// has one interval; adaptive rules of Gauss and Kronrod with 15 points go along radii and about the origin. Error below
/// about 1e-9, relative or absolute, and estimated; the estimate is returned.
///
/// # Errors
/// [`AlbedoError`].
pub fn albedo(model: Variant, alphas: [f64; 2], [theta, phi]: [f64; 2]) -> Result<Albedo, AlbedoError> {
    check(alphas, theta)?;
    let light = direction([theta, phi]);
    Ok(over_slopes(alphas, [theta, phi], &|slope| {
        let length = (1.0 + slope[0] * slope[0] + slope[1] * slope[1]).sqrt();
        let half = [slope[0] / length, slope[1] / length, 1.0 / length];
        let cosine = light[0] * half[0] + light[1] * half[1] + light[2] * half[2];
        let view: [f64; 3] = core::array::from_fn(|i| 2.0 * cosine * half[i] - light[i]);
        if !(view[2] > 0.0 && cosine > 0.0) {
            return 0.0;
        }
        evaluate(model, alphas, light, view) * view[2] * 4.0 * cosine / (length * length * length)
    }))
}

/// The share of directions that Ward's sampling method finds above the horizon, which is the albedo of its probability
/// density (2.22); the rest is rejected.
///
/// # Errors
/// [`AlbedoError`].
pub fn sampling_albedo(alphas: [f64; 2], [theta, phi]: [f64; 2]) -> Result<Albedo, AlbedoError> {
    check(alphas, theta)?;
    let [u, v] = alphas;
    let density = |slope: [f64; 2]| (-(slope[0] / u).powi(2) - (slope[1] / v).powi(2)).exp() / (PI * u * v);
    Ok(over_slopes(alphas, [theta, phi], &density))
}

fn check(alphas: [f64; 2], theta: f64) -> Result<(), AlbedoError> {
    let [low, high] = super::ALPHA_RANGE;
    if let Some(&alpha) = alphas.iter().find(|alpha| !(**alpha >= low && **alpha <= high)) {
        return Err(AlbedoError::Alpha(alpha));
    }
    if (0.0..90.0).contains(&theta) { Ok(()) } else { Err(AlbedoError::Theta(theta)) }
}

/// ∫ f(m) dm over the slopes of half vectors whose views are above the horizon.
fn over_slopes([u, v]: [f64; 2], [theta, phi]: [f64; 2], f: &dyn Fn([f64; 2]) -> f64) -> Albedo {
    let tangent = theta.to_radians().tan();
    let (sine, cosine) = phi.to_radians().sin_cos();
    let along = |psi: f64| {
        let (y, x) = psi.sin_cos();
        let slope = [u * x, v * y];
        let length = slope[0].hypot(slope[1]);
        let t = tangent * (slope[0] * cosine + slope[1] * sine) / length;
        // The longer root of r² − 2 t r − 1, without cancellation.
        let horizon = if t > 0.0 { t + t.hypot(1.0) } else { 1.0 / (t.hypot(1.0) - t) };
        let last = (horizon / length).min(FARTHEST);
        // Towards the horizon some models go like a root: 1 − s² along the way makes that smooth.
        let along_radius = |s: f64| {
            let r = last * (1.0 - s * s);
            f([slope[0] * r, slope[1] * r]) * u * v * r * 2.0 * last * s
        };
        integrate(&along_radius, &[0.0, 1.0], 0.1 * TOLERANCE).value
    };
    // Near grazing the horizon comes close quickly where slopes point across the plane of incidence.
    let across = (u * cosine).atan2(v * sine).rem_euclid(PI);
    let start = -across;
    let places = [start, start + FRAC_PI_2, start + PI, start + 3.0 * FRAC_PI_2, start + 2.0 * PI];
    integrate(&along, &places, TOLERANCE)
}

/// Nodes and weights of Kronrod's rule with 15 points, and the weights of Gauss's with 7 within it (QUADPACK, `qk15`).
const RULE: [[f64; 3]; 8] = [
    [0.0, 0.209_482_141_084_727_83, 0.417_959_183_673_469_4],
    [0.207_784_955_007_898_47, 0.204_432_940_075_298_9, 0.0],
    [0.405_845_151_377_397_2, 0.190_350_578_064_785_4, 0.381_830_050_505_118_9],
    [0.586_087_235_467_691_1, 0.169_004_726_639_267_9, 0.0],
    [0.741_531_185_599_394_4, 0.140_653_259_715_525_92, 0.279_705_391_489_276_67],
    [0.864_864_423_359_769_1, 0.104_790_010_322_250_19, 0.0],
    [0.949_107_912_342_758_5, 0.063_092_092_629_978_55, 0.129_484_966_168_869_7],
    [0.991_455_371_120_812_6, 0.022_935_322_010_529_224, 0.0],
];

/// An interval, its integral and the difference of the two rules there.
#[derive(Clone, Copy)]
struct Interval {
    ends: [f64; 2],
    value: f64,
    error: f64,
}

impl Interval {
    fn new(f: &dyn Fn(f64) -> f64, ends: [f64; 2]) -> Self {
        let (middle, half) = (0.5 * (ends[0] + ends[1]), 0.5 * (ends[1] - ends[0]));
        let (mut fine, mut coarse) = (0.0, 0.0);
        for [node, weight, gauss] in RULE {
            let value = if node == 0.0 { f(middle) } else { f(middle - half * node) + f(middle + half * node) };
            fine += weight * value;
            coarse += gauss * value;
        }
        Self { ends, value: half * fine, error: (half * (fine - coarse)).abs() }
    }
}

/// Halves the interval of the largest error until the errors together are within the tolerance.
fn integrate(f: &dyn Fn(f64) -> f64, places: &[f64], tolerance: f64) -> Albedo {
    let mut intervals: Vec<_> = places.windows(2).map(|pair| Interval::new(f, [pair[0], pair[1]])).collect();
    loop {
        let sum = |part: fn(&Interval) -> f64| intervals.iter().map(part).sum::<f64>();
        let total = Albedo { value: sum(|i| i.value), error: sum(|i| i.error) };
        let worst = (0..intervals.len()).max_by(|&a, &b| intervals[a].error.total_cmp(&intervals[b].error));
        let (Some(worst), true) = (worst, intervals.len() < MAX_INTERVALS) else { return total };
        let Interval { ends: [first, last], .. } = intervals[worst];
        let middle = 0.5 * (first + last);
        let divisible = first < middle && middle < last;
        if total.error <= tolerance * total.value.abs().max(1.0) || !divisible {
            return total;
        }
        intervals[worst] = Interval::new(f, [first, middle]);
        intervals.push(Interval::new(f, [middle, last]));
    }
}
