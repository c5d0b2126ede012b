//! The scattered photon map: light that reaches surfaces by way of mirrors and glass (Iehl–Péroche 2000, sections 2 and 5).
//!
//! Photons are traced from the lights towards mirrors and glass, and kept where they meet a surface that scatters: paths L S⁺ D. Until a path
//! meets a medium in which light behaves differently by wavelength, it stands for the whole spectrum, as a product of spectra. Behind such a
//! medium it goes on at a wavelength of its own, with derivatives that say where it would be at all others; or, where these say too little, it is
//! thrown at a few wavelengths, between which it is found (or, if asked for, thrown again for each interval that a pixel asks for). Each photon
//! counts within a radius of its own, so that all of its light is there once.

mod account;
mod aim;
mod bands;
mod beam;
mod curves;
mod density;
mod differential;
mod emission;
mod extent;
mod footprints;
mod gather;
mod global;
mod indices;
mod kernel;
mod lines;
mod map;
mod maps;
mod motion;
mod passing;
mod points;
mod products;
#[cfg(test)]
mod random;
mod reached;
mod release;
mod shades;
mod spectra;
mod target;
mod thin;
mod trace;
mod waves;
mod ways;

pub(crate) use account::Account;
pub use bands::BandReport;
pub(crate) use density::{Choice, Density, Estimate, Place};
pub(crate) use emission::{Emission, Emitted, Settings};
pub(crate) use extent::Extents;
pub(crate) use gather::{GatherSettings, Gatherer};
pub(crate) use global::{Balance, Global, GlobalSettings};
pub use kernel::Kernel;
pub(crate) use map::PhotonMap;
pub(crate) use maps::Maps;
pub use maps::Rethrow;
use motion::Line;
pub(crate) use passing::Passed;
pub(crate) use shades::Shades;
pub(crate) use spectra::Spectra;
pub(crate) use trace::Prefix;
pub use waves::Bundle;

/// Light where it met a surface that scatters it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Photon {
    /// Where, in scene units.
    pub(crate) position: [f32; 3],
    /// The unit vector to where it came from.
    pub(crate) direction: [f32; 3],
    /// Its flux for a spectrum of 1: in the unit of its light's factor (radiance, intensity or irradiance) times m² sr, sr or m².
    pub(crate) flux: f32,
    /// The product of spectra that its flux is multiplied by, by its number among [`Spectra`].
    pub(crate) spectrum: u32,
    /// The shape that it met and the side: see [`surface`].
    pub(crate) surface: u32,
}

/// A shape and its side, as one number.
pub(crate) const fn surface(shape: u32, front: bool) -> u32 {
    shape * 2 + front as u32
}

/// A photon that was thrown for some waves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Scattered {
    /// Where it landed. Its flux is that at its wavelength, the spectra of its factors left out.
    pub(crate) photon: Photon,
    /// The path that was thrown: the same number for all wavelengths. Of paths that go on at once, numbers begin anew with each of their emissions.
    pub(crate) path: u32,
    /// Which reflections and refractions it took: photons of one path and the same branch, at different wavelengths, correspond to each other.
    pub(crate) branch: u32,
}

/// A photon that was thrown at a wavelength, and how it moves from there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Drifting {
    pub(crate) scattered: Scattered,
    pub(crate) line: Line,
}

impl AsRef<Self> for Scattered {
    fn as_ref(&self) -> &Self {
        self
    }
}

impl AsMut<Self> for Scattered {
    fn as_mut(&mut self) -> &mut Self {
        self
    }
}

impl AsRef<Scattered> for Drifting {
    fn as_ref(&self) -> &Scattered {
        &self.scattered
    }
}

impl AsMut<Scattered> for Drifting {
    fn as_mut(&mut self) -> &mut Scattered {
        &mut self.scattered
    }
}

#[cfg(test)]
mod tests;
