//! The illuminance of a receiver by few samples: adaptive where the error is, exact where nothing is in the way.
//!
//! What is estimated is (1/π) ∫ f V cosθ cosθ′/d² dA over the part of a disk above the receiver's horizon: times π and
//! a radiance, an irradiance; with f = V = 1 the configuration factor. f is what the light sends towards the receiver,
//! relative to that radiance, V the visibility; both are given as a closure that is asked for single points of the disk
//! ([`Aim`]). Disk and cosines are integrated without asking it.
//!
//! - [`integrate`] aims at a requested relative error for any f and V, by its own estimate of it.
//! - [`ratio`] also knows the unoccluded value in closed form, and only estimates what share of it arrives.
//! - [`ratio_of_parts`] does so with a given [partition](crate::partition) instead.
//!
//! Accuracy, over random receivers with heights from a thousandth to ten radii, at the rim, grazing and cut by their
//! horizon: uniform light is exact; for light in proportion to the cosine, up to 0.2 % of receivers are outside a
//! requested 1 %, 0.1 % or 0.01 % (94, 130, 174 samples in the mean), because what no sample sees cannot be estimated.
//! Shadows with one straight edge: 0.4 % outside 1 % with 2 strata (744 samples), 0.6 % outside 0.1 % with 4 strata
//! (2017 samples).
//!
//! Callers hand in room for [`Panel`]s, 0.9 kB each in `f64`: 16 are enough for smooth light, hundreds for shadows of
//! many edges. A call keeps the parts of one slice on the stack, about 16 kB in `f64`; `f32` takes half of both.

mod adaptive;
mod panels;
mod parts;
mod rule;
mod slice;
mod slices;

use core::fmt;

use spectral_core::Real;

pub use adaptive::{integrate, ratio};
pub use panels::Panel;
pub use parts::ratio_of_parts;

/// A point of the disk that light is asked of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Aim<R> {
    /// The point on the unit disk, along [`Disk::frame`](crate::Disk::frame).
    pub on_disk: [R; 2],
    /// The point in space.
    pub point: [R; 3],
    /// cosθ′ between the disk's normal and the direction to the receiver.
    pub cosine: R,
}

/// What a point of the disk sends to the receiver.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Response<R> {
    /// Radiance towards the receiver as if nothing were in the way, relative to the caller's unit; not negative.
    pub emission: R,
    /// The share that arrives, 0 to 1.
    pub visibility: R,
}

impl<R: Real> Response<R> {
    /// Light that nothing is in the way of.
    pub const fn unoccluded(emission: R) -> Self {
        Self { emission, visibility: R::ONE }
    }

    fn check(&self) -> Result<(), EstimateError> {
        let is_valid = |x: R| x >= R::ZERO && x.is_finite();
        if is_valid(self.emission) && is_valid(self.visibility) { Ok(()) } else { Err(EstimateError::Response) }
    }
}

/// What is asked for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Request<R> {
    /// The relative error of the result, above 0 and below 1.
    pub relative_error: R,
    /// The largest number of samples.
    pub max_samples: usize,
    /// The least number of strata in each of the two directions, each sampled by 3 × 3 points: 1 for light without
    /// obstacles, more to find small ones. 0 is taken as 1.
    pub strata: usize,
}

/// An estimate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate<R> {
    /// (1/π) ∫ f V cosθ cosθ′/d² dA.
    pub value: R,
    /// How far the value may be off, estimated.
    pub error: R,
    /// How often the closure was asked.
    pub samples: usize,
    /// Whether the request was met.
    pub status: Status,
}

/// How an estimate ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Status {
    /// The estimated error is at most the requested one.
    Met,
    /// The caller's panels are used up; the estimate is the best that they allow.
    Panels,
    /// The largest number of samples is reached; likewise.
    Samples,
    /// Nothing can be divided further in this number type; likewise.
    Resolution,
}

/// Why an estimate was refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum EstimateError {
    /// The requested relative error is not between 0 and 1.
    RelativeError,
    /// There are fewer panels than strata, or none.
    NoPanels,
    /// The unoccluded value is negative, infinite or NaN.
    Exact,
    /// The closure answered with a number that is infinite, NaN or negative.
    Response,
}

impl fmt::Display for EstimateError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::RelativeError => "the requested relative error is not between 0 and 1",
            Self::NoPanels => "there are fewer panels than strata",
            Self::Exact => "the unoccluded value is negative or not finite",
            Self::Response => "the emission or visibility of a point is negative or not finite",
        })
    }
}

impl core::error::Error for EstimateError {}
