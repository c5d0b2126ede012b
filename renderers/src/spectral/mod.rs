//! The spectral side of rendering: what light a pixel gathers, as a sum of products of spectra, and the ways to make a colour of it.
//!
//! Light transport writes a [`Radiance`] for each pixel: coefficients of [monomials](Monomial) (products of the scene's
//! spectra, collected in a [`Palette`]) and of [deferred](Deferred) light whose path depends on the wavelength. A
//! [`Resolver`] turns it into a colour: by adaptive intervals, by uniform bins or by three components. Transport is the
//! same for all of them.

mod components;
mod gathered;
mod hats;
mod interval;
mod palette;
mod radiance;
mod steering;
mod uniform;

pub(crate) use components::MEAN_WAVELENGTH;
pub use components::{ComponentResolver, Components};
pub use gathered::{RowColour, WithGathered};
pub(crate) use hats::{measure, place_of, wavelength_at};
pub use interval::{IntervalMemory, IntervalSettings, Intervals, SharedIntervals};
pub use palette::{Factor, Palette, Role, Tabulated};
pub use radiance::{Deferred, FactorOrder, Gathered, Monomial, Monomials, Radiance};
pub(crate) use radiance::{PairBuild, PairHasher};
pub use steering::{Functional, Steering};
pub use uniform::{Uniform, UniformBins};
pub(crate) use uniform::{is_on_grid, wavelengths};

/// ∫ȳ of the CIE 1931 observer over 380–780 nm in nm, at 1 nm, exact for its linear interpolation: what divides ∫Lȳ so that a flat
/// radiance of 1 has Y = 1.
pub const Y_INTEGRAL: f64 = 106.856_399_282_88;

/// A pixel's colour and what is known of its error.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Colour {
    /// Tristimulus values, with Y = 1 for a flat radiance of 1.
    pub xyz: [f64; 3],
    /// How far each of them may be off, by the spectral representation; 0 for representations without a bound.
    pub radius: [f64; 3],
    /// The bound of ΔE*ab from the spectral representation: certain in the certified mode where no light is deferred, an
    /// estimate otherwise; 0 for representations without a bound.
    pub delta_e: f64,
    /// The part of the bound that comes of deferred light's paths: an estimate. Light that changes in straight lines in 1/λ² by the wavelength has none.
    /// What paths for some waves take from places nearby isn't in it.
    pub path_delta_e: f64,
    /// What a standard error of the light found by photons counts for: a ΔE*ab, not part of the bound.
    pub photon_delta_e: f64,
    /// How many intervals, bins or components it took.
    pub intervals: usize,
}

impl Colour {
    /// No light, no error, and nothing done for it.
    pub(crate) const DARK: Self =
        Self { xyz: [0.0; 3], radius: [0.0; 3], delta_e: 0.0, path_delta_e: 0.0, photon_delta_e: 0.0, intervals: 0 };
}

/// Waves that deferred light is traced for together.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Band {
    /// The wavelength that stands for them, in nm.
    pub wavelength: f64,
    /// From where to where they go, in nm.
    pub limits: [f64; 2],
}

impl Band {
    /// The part of 380–780 nm that they are, from 0 to 1.
    pub(crate) const fn share(&self) -> f64 {
        let [from, to] = self.limits;
        (to - from) / (spectral_core::interval::LAST_WAVELENGTH - spectral_core::interval::FIRST_WAVELENGTH)
    }

    /// Whether these are all waves.
    pub(crate) const fn is_whole(&self) -> bool {
        self.share() == 1.0
    }

    /// A single wavelength in nm.
    #[must_use]
    pub const fn single(wavelength: f64) -> Self {
        Self { wavelength, limits: [wavelength; 2] }
    }
}

/// Light transport, as far as making colours needs it.
pub trait Tracer {
    /// The products of spectra that radiances refer to.
    fn monomials(&self) -> &Monomials;

    /// The radiance of deferred light for some waves; nothing in it is deferred.
    fn trace(&mut self, deferred: Deferred, band: Band) -> Radiance;

    /// Calls with the products of deferred light times another product and a weight, and with their weights at the ends of as many steps as one of these
    /// numbers, evenly spaced by 1/λ² from 380 to 780 nm, if between them it changes in proportion to that; otherwise it is false.
    fn lines(
        &mut self,
        _: Deferred,
        _by: (Monomial, f64),
        _steps: &[u16],
        _: &mut dyn FnMut(Monomial, &[f64]),
    ) -> bool {
        false
    }

    /// The gathered light in deferred light, along the path of one wavelength.
    fn trace_gathered(&mut self, deferred: Deferred) -> Radiance {
        self.trace(deferred, Band::single(MEAN_WAVELENGTH))
    }

    /// The irradiance of gathered light, a row of the representation that it was computed in.
    fn row(&self, _: Gathered) -> &[f64] {
        &[]
    }
}

/// Makes colours of radiance; one for each thread.
pub trait Resolver {
    /// The colour of a pixel.
    fn resolve(&mut self, radiance: &Radiance, tracer: &mut dyn Tracer) -> Colour;

    /// The ΔE*ab that colours may be off by; 0 if nothing is left out on purpose.
    fn tolerance(&self) -> f64 {
        0.0
    }

    /// Adds gathered light to the spectrum of the pixel that was resolved last: a row of the same representation times a product of
    /// leaves and a weight. Nothing without spectra.
    fn add_gathered(&mut self, _leaves: &[u32], _row: &[f64], _weight: f64) {}

    /// The spectrum of the pixel that was resolved last, a number for each bin; empty without spectra.
    fn spectrum(&self) -> &[f64] {
        &[]
    }
}

/// Tristimulus values ∫Lā relative to [`Y_INTEGRAL`].
pub(crate) fn normalised(tristimulus: [f64; 3]) -> [f64; 3] {
    tristimulus.map(|v| v / Y_INTEGRAL)
}
