//! Photons that were thrown, with their ways where these are known at all wavelengths, and the maps of bands of wavelengths, each made once by
//! whoever asks first.

use alloc::sync::Arc;
use core::sync::atomic::{AtomicBool, Ordering};
use std::collections::HashMap;
use std::sync::{Mutex, OnceLock};

use super::curves::{Curves, Source};
use super::footprints::{Footprint, Footprints};
use super::lines;
use super::map::Region;
use super::motion::{Motion, Moving};
use super::ways::Ways;
use super::{Drifting, Emission, Photon, PhotonMap, Spectra};
use crate::spectral::{Band, place_of};

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
#[derive(Debug, Default)]
pub(super) struct Thrown {
    pub(super) map: PhotonMap,
    pub(super) spectra: Arc<Spectra>,
    /// What a flux is worth, for each product.
    brightness: Vec<f32>,
    /// How far they count where they are in the map.
    pub(super) footprints: Footprints,
    /// How photons move with the wavelength, if that is known: those of the map, and of another the parts of their ways where these have no photon.
    moving: Option<Box<Motions>>,
}

/// How the photons of a map move (until it is said how far they count), and others that do.
#[derive(Debug)]
struct Motions {
    motions: Vec<Motion>,
    others: PhotonMap,
    of_others: Vec<Motion>,
    /// How far photons count along their ways: those of the map, and others.
    footprints: [Footprints; 2],
    /// For each photon of the map, in which third of all waves its own is.
    thirds: Vec<u8>,
    /// The least number of steps in which their light is found.
    steps: u16,
}

impl Thrown {
    /// Photons that don't count anywhere until it is said how far they do.
    pub(super) fn new(photons: Vec<Photon>, spectra: Arc<Spectra>, emission: &Emission<'_>) -> Self {
        let brightness = emission.brightness(&spectra);
        Self { map: PhotonMap::new(photons), spectra, brightness, footprints: Footprints::default(), moving: None }
    }

    /// The photons of all paths, each at a wavelength in nm of its own, that are known at all others, too: where they move far, their ways are
    /// cut into parts.
    pub(super) fn moving(
        (curves, usual): (&Curves, f32),
        (wavelength_of, limits): (impl Fn(u32) -> f64 + Sync, [f64; 2]),
        spectra: Arc<Spectra>,
        emission: &Emission<'_>,
    ) -> Self {
        let (photons, sources) = curves.placed(&wavelength_of);
        let mut thrown = Self::new(photons, spectra, emission);
        let source = |origin: &u32| sources.get(*origin as usize).copied().unwrap_or_default();
        let longest = thrown.map.spacings().into_iter().map(|spacing| PARTS * spacing);
        let placed: Vec<_> = thrown.map.origins().iter().map(source).zip(longest).collect();
        let limits = limits.map(|wavelength| curves.between(wavelength));
        let third = |(source, _): &(Source, f32)| u8::from(source.at >= limits[0]) + u8::from(source.at >= limits[1]);
        let thirds = placed.iter().map(third).collect();
        let mut rest = Moving::default();
        let motions = curves.moving(&placed, &mut rest);
        // Ends of ways without a photon of their own, at other keys than that.
        curves.others(&wavelength_of, PARTS * usual, &mut rest);
        thrown.with_ways(motions, rest, thirds, curves.steps());
        thrown
    }

    /// The same of photons whose ways are known from one wavelength each.
    #[allow(clippy::cast_possible_truncation, reason = "as precise as their ways")]
    pub(super) fn drifting(
        pieces: Vec<Vec<Drifting>>,
        limits: [f64; 2],
        spectra: Arc<Spectra>,
        emission: &Emission<'_>,
    ) -> Self {
        let (photons, ways) = lines::parted(pieces);
        let mut thrown = Self::new(photons, spectra, emission);
        let mut rest = Moving::default();
        let motions = lines::cut(&thrown.map, &ways, PARTS, &mut rest);
        let limits = limits.map(|wavelength| place_of(wavelength) as f32);
        let third = |motion: &Motion| u8::from(motion.at >= limits[0]) + u8::from(motion.at >= limits[1]);
        let thirds = motions.iter().map(third).collect();
        thrown.with_ways(motions, rest, thirds, 1);
        thrown
    }

    /// Says how its photons move, and others, in at least so many steps.
    fn with_ways(&mut self, motions: Vec<Motion>, rest: Moving, thirds: Vec<u8>, steps: u16) {
        let others = PhotonMap::new(rest.0);
        let of_others = others.origins().iter().filter_map(|origin| rest.1.get(*origin as usize).copied()).collect();
        let footprints = Default::default();
        self.moving = Some(Box::new(Motions { motions, others, of_others, footprints, thirds, steps }));
    }

    /// The same, with how far photons count: for each leaf of the map. Parts of ways count as far as the photons do that are there; where there are
    /// none, as far as is said.
    pub(super) fn spread(self, radii: Vec<Footprint>, alone: Footprint) -> Self {
        let Self { map, moving, .. } = &self;
        let still = || Footprints::new(map, radii.clone(), None);
        let Some(Motions { motions, others, of_others, steps, .. }) = moving.as_deref() else {
            return Self { footprints: still(), ..self };
        };
        let (footprints, own) = rayon::join(still, || Footprints::new(map, radii.clone(), Some((motions, *steps))));
        let radius = |numbers: core::ops::Range<usize>| {
            let (_, photon) = others.middle_of(numbers)?;
            footprints.at(map, photon.surface, photon.position)
        };
        let radii = others.leaves_photons().map(|numbers| radius(numbers).unwrap_or(alone)).collect();
        let rest = Footprints::new(others, radii, Some((of_others, *steps)));
        let known = |moving: Box<Motions>| {
            Box::new(Motions { motions: Vec::new(), of_others: Vec::new(), footprints: [own, rest], ..*moving })
        };
        Self { footprints, moving: self.moving.map(known), ..self }
    }

    /// Whether it is known how photons move.
    pub(super) const fn is_moving(&self) -> bool {
        self.moving.is_some()
    }

    /// How light differs between the thirds of all waves: the standard deviation of theirs over its mean, from 0 to √2, for photons of the map by their
    /// numbers and weights. What is there by chance, as there are few photons, is in it.
    pub(super) fn unevenness(&self, photons: impl Iterator<Item = (u32, f32)>) -> f64 {
        let Some(moving) = &self.moving else { return 0.0 };
        let mut sums = [0.0; 3];
        for (number, weight) in photons {
            let number = number as usize;
            if let (Some(photon), Some(third)) = (self.map.photons().get(number), moving.thirds.get(number)) {
                sums[usize::from(*third)] += f64::from(weight) * f64::from(self.worth(photon));
            }
        }
        let mean: f64 = sums.iter().sum::<f64>() / 3.0;
        let squares: f64 = sums.iter().map(|sum| (sum / mean - 1.0).powi(2)).sum();
        if mean > 0.0 { (squares / 3.0).sqrt() } else { 0.0 }
    }

    /// Calls with photons that may count in a region of a surface at some wavelength, of which some are in the order of the leaf, and how far they
    /// count.
    pub(super) fn passing(&self, surface: u32, region: &Region, mut call: impl FnMut(&Ways, &[Photon], Footprint)) {
        let Some(moving) = &self.moving else { return };
        for (map, footprints) in [&self.map, &moving.others].into_iter().zip(&moving.footprints) {
            footprints.passing(map, surface, region, |ways, first, footprint| {
                call(ways, map.photons().get(first as usize..).unwrap_or_default(), footprint);
            });
        }
    }

    /// The luminous flux of a photon.
    pub(super) fn worth(&self, photon: &Photon) -> f32 {
        photon.flux * self.brightness.get(photon.spectrum as usize).copied().unwrap_or(1.0)
    }

    pub(super) fn bytes(&self) -> usize {
        self.map.bytes() + self.footprints.bytes() + self.moving.as_ref().map_or(0, |moving| moving.bytes())
    }
}

impl Motions {
    fn bytes(&self) -> usize {
        let motions = size_of_val(self.motions.as_slice()) + size_of_val(self.of_others.as_slice());
        let footprints: usize = self.footprints.iter().map(Footprints::bytes).sum();
        motions + self.others.bytes() + footprints + self.thirds.len()
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
