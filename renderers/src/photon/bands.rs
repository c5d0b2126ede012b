//! Photons that were thrown, with their ways where these are known at all wavelengths, and the maps of bands of wavelengths, each made once by
//! whoever asks first.

use alloc::sync::Arc;
use core::sync::atomic::{AtomicBool, Ordering};
use std::collections::HashMap;
use std::sync::{Mutex, OnceLock};

use super::curves::Curves;
use super::map::Region;
use super::motion::Motion;
use super::passing::Ways;
use super::{Emission, Photon, PhotonMap, Spectra};
use crate::spectral::Band;

/// The photons of one band, for reports.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BandReport {
    /// From where to where it goes, in nm.
    pub limits: [f64; 2],
    /// How many photons its map has; parts of the ways of photons that move are not counted.
    pub photons: usize,
    /// Bytes of the map.
    pub bytes: usize,
}

/// How long parts of photons' ways are, relative to how far apart photons are of an estimate.
const PARTS: f32 = 3.0;

/// Photons to be found, and the products of spectra that they refer to.
#[derive(Debug)]
pub(super) struct Thrown {
    pub(super) map: PhotonMap,
    pub(super) spectra: Arc<Spectra>,
    /// What a flux is worth, for each product.
    brightness: Vec<f32>,
    /// How photons move with the wavelength, if that is known: those of the map, and of another the parts of their ways where these have no photon.
    ways: Option<Box<[Moving; 2]>>,
}

/// How the photons of a map move.
#[derive(Debug)]
struct Moving {
    /// The map, unless it is that of all photons.
    others: Option<PhotonMap>,
    motions: Vec<Motion>,
    ways: Ways,
}

impl Moving {
    /// The motions are in the order of the map.
    fn new(map: &PhotonMap, motions: Vec<Motion>) -> Self {
        Self { others: None, ways: Ways::new(map, &motions), motions }
    }

    fn bytes(&self) -> usize {
        self.others.as_ref().map_or(0, PhotonMap::bytes) + size_of_val(self.motions.as_slice()) + self.ways.bytes()
    }
}

impl Thrown {
    pub(super) fn new(photons: Vec<Photon>, spectra: Arc<Spectra>, emission: &Emission<'_>) -> Self {
        let brightness = emission.brightness(&spectra);
        Self { map: PhotonMap::new(photons), spectra, brightness, ways: None }
    }

    /// The photons of all paths, each at a wavelength in nm of its own, that are known at all others, too: where they move far, their ways are
    /// cut into parts.
    pub(super) fn moving(
        (curves, usual): (&Curves, f32),
        wavelength_of: impl Fn(u32) -> f64,
        spectra: Arc<Spectra>,
        emission: &Emission<'_>,
    ) -> Self {
        let (photons, sources) = curves.placed(&wavelength_of);
        let mut thrown = Self::new(photons, spectra, emission);
        let (mut motions, mut rest) = (Vec::with_capacity(thrown.map.len()), (Vec::new(), Vec::new()));
        for (origin, spacing) in thrown.map.origins().iter().zip(thrown.map.spacings()) {
            let source = sources.get(*origin as usize).copied().unwrap_or_default();
            motions.push(curves.parts(source, PARTS * spacing, &mut rest));
        }
        // Ends of ways without a photon of their own, at other keys than that.
        curves.others(&wavelength_of, PARTS * usual, &mut rest);
        let others = PhotonMap::new(rest.0);
        let of_others = others.origins().iter().filter_map(|origin| rest.1.get(*origin as usize).copied()).collect();
        let of_others = Moving::new(&others, of_others);
        let own = Moving::new(&thrown.map, motions);
        thrown.ways = Some(Box::new([own, Moving { others: Some(others), ..of_others }]));
        thrown
    }

    /// Whether it is known how photons move.
    pub(super) const fn is_moving(&self) -> bool {
        self.ways.is_some()
    }

    /// Calls with photons that may come into a region of a surface, and how they move.
    pub(super) fn passing(&self, surface: u32, region: &Region, mut call: impl FnMut(&Photon, &Motion)) {
        for Moving { others, motions, ways } in self.ways.iter().flat_map(|ways| ways.iter()) {
            let map = others.as_ref().unwrap_or(&self.map);
            ways.passing(map, surface, region, |number| {
                if let (Some(photon), Some(motion)) = (map.photons().get(number as usize), motions.get(number as usize))
                {
                    call(photon, motion);
                }
            });
        }
    }

    /// The luminous flux of a photon.
    pub(super) fn worth(&self, photon: &Photon) -> f32 {
        photon.flux * self.brightness.get(photon.spectrum as usize).copied().unwrap_or(1.0)
    }

    pub(super) fn bytes(&self) -> usize {
        self.map.bytes() + self.ways.iter().flat_map(|ways| ways.iter()).map(Moving::bytes).sum::<usize>()
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
