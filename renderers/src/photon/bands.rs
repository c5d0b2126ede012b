//! Photons that were thrown, and the maps of bands of wavelengths, each made once by whoever asks first.

use alloc::sync::Arc;
use core::sync::atomic::{AtomicBool, Ordering};
use std::collections::HashMap;
use std::sync::{Mutex, OnceLock};

use super::curves::Motion;
use super::{Emission, Photon, PhotonMap, Spectra};
use crate::spectral::Band;

/// The photons of one band, for reports.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BandReport {
    /// From where to where it goes, in nm.
    pub limits: [f64; 2],
    /// How many photons its map has.
    pub photons: usize,
    /// Bytes of the map.
    pub bytes: usize,
}

/// Photons to be found, and the products of spectra that they refer to.
#[derive(Debug)]
pub(super) struct Thrown {
    pub(super) map: PhotonMap,
    pub(super) spectra: Arc<Spectra>,
    /// What a flux is worth, for each product.
    brightness: Vec<f32>,
    /// How each photon of the map moves with the wavelength, if that is known.
    pub(super) motions: Vec<Motion>,
}

impl Thrown {
    pub(super) fn new(photons: Vec<Photon>, spectra: Arc<Spectra>, emission: &Emission<'_>) -> Self {
        let brightness = emission.brightness(&spectra);
        Self { map: PhotonMap::new(photons), spectra, brightness, motions: Vec::new() }
    }

    /// The same with how the photons move, in the order in which they were given.
    pub(super) fn with_motions(mut self, motions: &[Motion]) -> Self {
        self.motions = self.map.origins().iter().filter_map(|origin| motions.get(*origin as usize).copied()).collect();
        self
    }

    /// The luminous flux of a photon.
    pub(super) fn worth(&self, photon: &Photon) -> f32 {
        photon.flux * self.worth_of(photon.spectrum)
    }

    /// What a flux with the spectrum of this number is worth.
    pub(super) fn worth_of(&self, spectrum: u32) -> f32 {
        self.brightness.get(spectrum as usize).copied().unwrap_or(1.0)
    }

    pub(super) fn bytes(&self) -> usize {
        self.map.bytes() + size_of_val(self.motions.as_slice())
    }
}

/// The maps of bands of wavelengths, each made when it is first asked for.
#[derive(Debug, Default)]
pub(super) struct Bands {
    slots: Mutex<HashMap<[u64; 2], Arc<Slot>>>,
}

/// A map that is made once.
#[derive(Debug)]
pub(super) struct Slot {
    band: Band,
    begun: AtomicBool,
    pub(super) thrown: OnceLock<Thrown>,
}

impl Bands {
    pub(super) fn get(&self, band: Band) -> Arc<Slot> {
        let key = band.limits.map(f64::to_bits);
        let new = || Arc::new(Slot { band, begun: AtomicBool::new(false), thrown: OnceLock::new() });
        match self.slots.lock() {
            Ok(mut slots) => Arc::clone(slots.entry(key).or_insert_with(new)),
            // Only a thread that panics with the lock in its hands could poison it.
            Err(_) => new(),
        }
    }

    pub(super) fn used(&self) -> Vec<BandReport> {
        let Ok(slots) = self.slots.lock() else { return Vec::new() };
        let made = |slot: &Arc<Slot>| {
            let thrown = slot.thrown.get()?;
            Some(BandReport { limits: slot.band.limits, photons: thrown.map.len(), bytes: thrown.bytes() })
        };
        let mut used: Vec<_> = slots.values().filter_map(made).collect();
        let width = |band: &BandReport| band.limits[1] - band.limits[0];
        used.sort_by(|a, b| width(b).total_cmp(&width(a)).then(a.limits[0].total_cmp(&b.limits[0])));
        used
    }
}

impl Slot {
    /// The photons, thrown by whoever asks first; all others help.
    pub(super) fn thrown(&self, throw: impl FnOnce(Band) -> Thrown) -> &Thrown {
        if let Some(thrown) = self.thrown.get() {
            return thrown;
        }
        if !self.begun.swap(true, Ordering::AcqRel) {
            return self.thrown.get_or_init(|| throw(self.band));
        }
        loop {
            if let Some(thrown) = self.thrown.get() {
                return thrown;
            }
            // Another thread is at it: this one takes some of its work, if it is of the same pool.
            if rayon::yield_now() != Some(rayon::Yield::Executed) {
                std::thread::yield_now();
            }
        }
    }
}
