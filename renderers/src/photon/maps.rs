//! The photon maps of a scene: one for light that all waves share, one for all that depends on the wavelength, and, if asked for, one for each bundle
//! of waves.

use alloc::sync::Arc;

use super::bands::{BandReport, Bands, Slot, Thrown};
use super::curves::{self, Curves};
use super::density::region_of;
use super::reached::Reached;
use super::waves::{Bundle, Waves};
use super::{
    Account, Density, Emission, Emitted, Estimate, Extents, Moving, Photon, PhotonMap, Place, Prefix, Scattered,
    Spectra, surface,
};
use crate::geometry::{Hit, Ray};
use crate::radiosity::Deposit;
use crate::scene::Scene;
use crate::spectral::Band;
use crate::whitted::{Arrived, Arriving, Caustics, Passing, Reach, Whitted};
use spectral_core::interval::{FIRST_WAVELENGTH, LAST_WAVELENGTH};

/// How photons that depend on the wavelength are thrown for a band.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Rethrow {
    /// They are not: all are traced at a few wavelengths, the more the more they bend, and found at all others by one search.
    #[default]
    Interpolated,
    /// All are traced for every band, as Iehl and Péroche have it.
    Traced,
}

/// The photons of a scene.
pub(crate) struct Maps<'s> {
    scene: &'s Whitted,
    extents: Extents,
    emission: &'s Emission<'s>,
    density: Density,
    /// What radii are multiplied by: less than 1 where many passes are averaged.
    shrink: f32,
    waves: Waves,
    even: Thrown,
    prefixes: Vec<Prefix>,
    curves: Option<Interpolated>,
    /// About the radius of an estimate where there are photons, in scene units.
    usual: f32,
    /// How far nine of ten photons move at most for each nm, where glass is the most dispersive.
    shift: f64,
    /// How much fluxes change in [`PROBES`] nm where they change the most, relative to themselves.
    steepest: f64,
    /// Where paths that depend on the wavelength come to.
    reached: Reached,
    bands: Bands,
    /// The map for all waves, if paths depend on them.
    whole: Option<Arc<Slot>>,
    /// How many photons met mirrors or glass.
    sent: u64,
    account: Account,
}

/// Photons between the wavelengths at which they were thrown.
#[derive(Debug)]
struct Interpolated {
    keys: Vec<f64>,
    curves: Curves,
    /// In how many even steps there is one between any two keys.
    steps: u16,
    spectra: Arc<Spectra>,
}

/// All waves, for which stands the helium d line.
pub(crate) const WHOLE: Band =
    Band { wavelength: crate::spectral::MEAN_WAVELENGTH, limits: [FIRST_WAVELENGTH, LAST_WAVELENGTH] };

/// Paths by which it is found at how many wavelengths they are thrown.
const TRIED: usize = 4096;

/// Bands are at least so wide, in nm: a 64th of all waves.
const NARROWEST: f64 = 6.25;

/// Of how many photons' places errors are taken.
const PLACES: usize = 1024;

/// The last part of a photon's way that is traced again to find what it met, relative to the scene's diagonal.
const SHORT: f32 = 1e-4;

/// Wavelengths in nm between which glass is as dispersive as anywhere in the visible.
const MOST_DISPERSIVE: [f64; 2] = [390.0, 410.0];

/// Steps in nm in which it is looked at how fluxes change and where photons come to, and by how many paths.
const PROBES: u32 = 20;
const PROBED: usize = 512;

/// How much fluxes may change, relative to themselves, within a band whose parts don't have photons of their own.
const CHANGE: f64 = 0.02;

/// In how many steps light is found at a place while photons move by the radius of its estimate, and in how many at most: a power of two.
const STEPS: f32 = 2.0;
const MOST_STEPS: u16 = 128;

/// How far, relative to the radius of an estimate, photons may be from where they are thought to be.
const NEAR: f32 = 0.1;

impl<'s> Maps<'s> {
    /// Makes the maps that are certain to be asked for, of photons that were emitted.
    pub(crate) fn new(
        (data, scene): (&Scene, &'s Whitted),
        emission: &'s Emission<'s>,
        emitted: Emitted,
        (density, shrink): (Density, f32),
        (bundle, rethrow): (Bundle, Rethrow),
    ) -> Self {
        let Emitted { photons, prefixes, spectra, account } = emitted;
        let mut maps = Self {
            scene,
            extents: Extents::new(data.shapes.iter().map(|shape| &shape.geometry)),
            density,
            shrink,
            waves: Waves::new(bundle),
            even: Thrown::new(photons, Arc::new(spectra), emission),
            prefixes,
            curves: None,
            usual: 0.0,
            shift: 0.0,
            steepest: 0.0,
            reached: Reached::default(),
            bands: Bands::default(),
            whole: None,
            sent: account.sent,
            account,
            emission,
        };
        if !maps.prefixes.is_empty() {
            maps.usual = maps.usual_radius();
            let are_bands_asked = rethrow == Rethrow::Traced || !maps.waves.is_continuous();
            if are_bands_asked {
                maps.shift = maps.shift();
                (maps.steepest, maps.reached) = maps.probe();
            }
            if rethrow == Rethrow::Interpolated {
                maps.curves = Some(maps.interpolated(NEAR * maps.usual));
            }
            let whole = maps.bands.get(WHOLE);
            whole.thrown(|band| maps.throw(band));
            maps.whole = Some(whole);
            if !are_bands_asked && let Some(known) = &mut maps.curves {
                // All is in the map.
                known.curves = Curves::default();
            }
        }
        maps
    }

    /// About so many of the paths, thrown at a wavelength.
    fn tried(&self, paths: usize, wavelength: f64) -> Vec<Scattered> {
        let stride = self.prefixes.len().div_ceil(paths).max(1);
        let some: Vec<Prefix> = self.prefixes.iter().step_by(stride).copied().collect();
        sorted(self.emission.throw(&some, |_| wavelength, &mut (*self.even.spectra).clone()).photons)
    }

    /// How far nine of ten photons move at most for each nm.
    fn shift(&self) -> f64 {
        let [first, last] = MOST_DISPERSIVE;
        f64::from(curves::shift(&self.tried(TRIED, first), &self.tried(TRIED, last))) / (last - first)
    }

    /// How much fluxes change in a step where they change the most, relative to themselves, and where photons come to.
    fn probe(&self) -> (f64, Reached) {
        let wavelengths = (0..).map(|step| FIRST_WAVELENGTH + f64::from(PROBES * step));
        let mut before = self.tried(PROBED, FIRST_WAVELENGTH);
        let (mut steepest, mut reached) = (0.0, Reached::new(self.density.radius));
        for wavelength in wavelengths.skip(1).take_while(|w| *w <= LAST_WAVELENGTH) {
            let next = self.tried(PROBED, wavelength);
            steepest = f64::max(steepest, f64::from(curves::change(&before, &next)));
            curves::places(&before, &next, |from, to| reached.add(from, to));
            before = next;
        }
        (steepest, reached)
    }

    /// The bands whose photons stand for those of a band, with their shares of it: the band itself, or those of the halves, quarters, … of all
    /// waves that it is in, if it is so narrow that photons of one map will do for these: as each photon has a wavelength of its own, they may
    /// move by half of a radius or of a pixel, which is twice `least`. Dispersion is taken to fall like
    /// Cauchy's, and fluxes change little.
    ///
    /// A narrow band across a limit takes photons from both sides: from one alone, it would have the place of waves that are not its own, and
    /// these would be missing on the other side of the limit, so that bands would show.
    fn standing_for(&self, band: Band, radius: f32, least: f32) -> [Option<(Band, f64)>; 2] {
        let whole = LAST_WAVELENGTH - FIRST_WAVELENGTH;
        let [from, to] = band.limits;
        let shift = self.shift * (MOST_DISPERSIVE[0] / f64::midpoint(from, to)).powi(3);
        let by_flux = CHANGE * f64::from(PROBES) / self.steepest;
        let narrowest = (0.5 * f64::from(radius.max(2.0 * least)) / shift).min(by_flux).clamp(NARROWEST, whole);
        if to == from || to - from >= narrowest {
            return [Some((band, 1.0)), None];
        }
        let width = whole / (whole / narrowest).log2().floor().exp2();
        let first = FIRST_WAVELENGTH + width * ((from - FIRST_WAVELENGTH) / width).floor();
        let wide = |from: f64| Band { wavelength: from + width / 2.0, limits: [from, from + width] };
        // It is not as wide as these: there is one limit in it at most.
        let share = self.waves.share(band, first + width);
        let is_part = |(_, share): &(Band, f64)| *share > 0.0;
        [Some((wide(first), share)).filter(is_part), Some((wide(first + width), 1.0 - share)).filter(is_part)]
    }

    /// Throws all paths at as many wavelengths as it takes for interpolation.
    fn interpolated(&self, near: f32) -> Interpolated {
        let mut spectra = (*self.even.spectra).clone();
        let keys = curves::keys([FIRST_WAVELENGTH, LAST_WAVELENGTH], near, &|wavelength| self.tried(TRIED, wavelength));
        let mut thrown = |wavelength: &f64| {
            let photons = self.emission.throw(&self.prefixes, |_| *wavelength, &mut spectra).photons;
            (*wavelength, sorted(photons))
        };
        let curves = Curves::new(&keys.iter().map(&mut thrown).collect::<Vec<_>>());
        Interpolated { keys, steps: curves.steps(), curves, spectra: Arc::new(spectra) }
    }

    /// About the radius of an estimate where there are photons: that of some of them, among which photons are farther apart.
    #[allow(clippy::cast_precision_loss, reason = "as precise as radii")]
    fn usual_radius(&self) -> f32 {
        let some = self.tried(TRIED, WHOLE.wavelength);
        let map = PhotonMap::new(some.into_iter().map(|s| s.photon).collect());
        self.density.usual_radius(&map) / (self.stride() as f32).sqrt()
    }

    /// One path in so many is tried.
    fn stride(&self) -> usize {
        self.prefixes.len().div_ceil(TRIED).max(1)
    }

    /// The photons of a band.
    fn throw(&self, band: Band) -> Thrown {
        // The map of all waves says where light is: it has all of them in any case.
        let is_whole = band.limits == WHOLE.limits;
        let wavelength_of =
            |path: u32| if is_whole { self.waves.spread(band, path) } else { self.waves.of_path(band, path) };
        if let Some(Interpolated { curves, spectra, .. }) = &self.curves {
            if is_whole && self.waves.is_continuous() {
                return Thrown::moving((curves, self.usual), wavelength_of, Arc::clone(spectra), self.emission);
            }
            let photons = curves.photons(band.limits, wavelength_of);
            return Thrown::new(photons, Arc::clone(spectra), self.emission);
        }
        // Beginning with those of all waves, products have the same numbers in all maps, but for rare ones.
        let whole = self.whole.as_ref().and_then(|slot| slot.thrown.get());
        let mut spectra = Spectra::clone(&whole.unwrap_or(&self.even).spectra);
        #[allow(clippy::cast_possible_truncation, reason = "paths have numbers of 32 bits")]
        let thrown = self.emission.throw(&self.prefixes, |path| wavelength_of(path as u32), &mut spectra);
        let photons: Vec<Photon> = thrown.photons.into_iter().map(|s| s.photon).collect();
        Thrown::new(photons, Arc::new(spectra), self.emission)
    }

    /// What there is about a hit.
    fn place(&self, hit: &Hit) -> Place<'_> {
        let side = if hit.front { 1.0 } else { -1.0 };
        let first = self.scene.world().primitives(hit.shape as usize).start;
        Place {
            position: hit.position.to_array(),
            normal: (hit.geometric_normal * side).to_array(),
            surface: surface(hit.shape, hit.front),
            face: self.extents.face(hit.shape, hit.primitive.wrapping_sub(first)),
        }
    }

    /// Estimates the light of a place, and chooses the reach by that.
    fn reach_in(&self, thrown: &Thrown, place: &Place<'_>, least: f32, scratch: &mut Estimate) -> Option<Reach> {
        let density = Density { smallest: least.min(self.density.radius), ..self.density };
        density.estimate(&thrown.map, place, |photon| thrown.worth(photon), scratch);
        let bias = if scratch.value > 0.0 { scratch.bias / scratch.value } else { 0.0 };
        let shrink = self.shrink;
        let reach = Reach {
            radius: scratch.radius * shrink,
            value: scratch.value,
            bias: bias * f64::from(shrink * shrink),
            error: scratch.error_of_a_photon(),
        };
        (reach.radius > 0.0).then_some(reach)
    }

    /// Finds the light of the photons that pass a place, at as many wavelengths as it takes for how fast they are.
    fn find_passing(&self, thrown: &Thrown, place: &Place<'_>, reach: Reach, found: &mut Arrived) {
        let Arrived { candidates, distances, passing, irradiances, .. } = found;
        candidates.clear();
        passing.clear();
        irradiances.clear();
        distances.clear();
        let position = glam::Vec3A::from_array(place.position);
        let mut region = region_of(place, reach.radius);
        if place.face.is_none() {
            // On a curved surface photons are this far from where they are thought to be.
            region.thickness += NEAR * self.usual;
        }
        thrown.passing(place.surface, &region, |photon, motion| {
            if place.sees(photon) {
                candidates.push(motion.past(photon, position));
            }
        });
        distances.extend(candidates.iter().map(Moving::speed));
        let radii = curves::of_nine_in_ten(distances) / reach.radius;
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "within limits")]
        let steps = ((STEPS * radii).ceil().clamp(1.0, f32::from(MOST_STEPS)) as u16).next_power_of_two();
        // Fluxes change from key to key, too, where photons hardly move.
        let steps = steps.max(self.curves.as_ref().map_or(1, |known| known.steps));
        found.steps = steps;
        let (kernel, scale) = (self.density.kernel, self.density.scale_within(place, reach.radius));
        #[allow(clippy::cast_possible_truncation, reason = "numbers of this size")]
        let (scale, by_radius) = (scale as f32, 1.0 / (reach.radius * reach.radius));
        for moving in candidates.iter() {
            let start = irradiances.len();
            let [first, end] = moving.nodes(steps);
            for node in first..end {
                let (distance2, flux) = moving.at(f32::from(node) / f32::from(steps));
                irradiances.push(flux * scale * kernel.value(distance2 * by_radius));
            }
            let direction = glam::Vec3A::from_array(moving.direction).as_dvec3();
            passing.push(Passing {
                direction,
                spectrum: moving.spectrum,
                first,
                irradiances: start..irradiances.len(),
            });
        }
    }

    /// Finds a share of the light that reaches a hit, within a reach or by one that is chosen, with the least radius.
    fn find(
        &self,
        (thrown, share): (&Thrown, f64),
        hit: &Hit,
        reach: Result<Reach, f32>,
        found: &mut Arrived,
    ) -> Arc<Spectra> {
        let Thrown { map, spectra, .. } = thrown;
        let (place, scratch, worth) = (self.place(hit), &mut found.scratch, |photon: &Photon| thrown.worth(photon));
        match reach {
            Err(least) => {
                let Some(Reach { radius, bias, .. }) = self.reach_in(thrown, &place, least, scratch) else {
                    return Arc::clone(spectra);
                };
                if self.shrink < 1.0 {
                    self.density.estimate_within(map, &place, radius, worth, scratch);
                    scratch.bias = bias * scratch.value;
                }
            }
            Ok(Reach { radius, bias, .. }) => {
                self.density.estimate_within(map, &place, radius, worth, scratch);
                scratch.bias = bias * scratch.value;
            }
        }
        let (photons, error) = (map.photons(), found.scratch.error_of_a_photon());
        for (number, weight) in found.scratch.photons() {
            let Some(photon) = photons.get(number as usize) else { continue };
            let irradiance = share * f64::from(weight) * f64::from(photon.flux);
            found.list.push(Arriving {
                direction: glam::Vec3A::from_array(photon.direction).as_dvec3(),
                irradiance,
                error: error * irradiance,
                spectrum: photon.spectrum,
            });
        }
        Arc::clone(spectra)
    }

    /// The relative error of estimates, the bias that shows included: the root of its mean square at some places where photons landed.
    pub(crate) fn error(&self) -> f64 {
        let mut estimate = Estimate::default();
        let (mut squares, mut places) = (0.0, 0.0);
        for thrown in self.whole() {
            let map = &thrown.map;
            let stride = map.len().div_ceil(PLACES).max(1);
            for photon in map.photons().iter().step_by(stride) {
                let Some(hit) = self.hit(photon) else { continue };
                self.density.estimate(map, &self.place(&hit), |photon| thrown.worth(photon), &mut estimate);
                if estimate.value > 0.0 {
                    let error = estimate.relative_error().hypot(estimate.bias / estimate.value);
                    squares += error * error;
                    places += 1.0;
                }
            }
        }
        if places > 0.0 { (squares / places).sqrt() } else { 0.0 }
    }

    /// All light: that whose way is the same for all waves, and the rest with all waves together.
    fn whole(&self) -> impl Iterator<Item = &Thrown> {
        core::iter::once(&self.even).chain(self.whole.iter().filter_map(|slot| slot.thrown.get()))
    }

    /// All photons, for all waves together.
    pub(crate) fn deposits(&self) -> Vec<Deposit<'_>> {
        let mut deposits = Vec::new();
        for Thrown { map, spectra, .. } in self.whole() {
            deposits.extend(map.photons().iter().map(|photon| Deposit {
                position: glam::Vec3A::from_array(photon.position).as_dvec3(),
                direction: glam::Vec3A::from_array(photon.direction).as_dvec3(),
                flux: f64::from(photon.flux),
                leaves: spectra.leaves(photon.spectrum),
            }));
        }
        deposits
    }

    /// The hit of the ray that brought a photon.
    fn hit(&self, photon: &Photon) -> Option<Hit> {
        let world = self.scene.world();
        let [low, high] = world.bounds();
        let direction = glam::Vec3A::from_array(photon.direction);
        let origin = glam::Vec3A::from_array(photon.position) + direction * (SHORT * (high - low).length());
        let hit = world.closest_hit(&Ray::new(origin, -direction))?;
        (surface(hit.shape, hit.front) == photon.surface).then_some(hit)
    }

    /// The maps of bands that were made, wider ones first.
    pub(crate) fn bands(&self) -> Vec<BandReport> {
        self.bands.used()
    }

    /// The wavelengths in nm between which photons are interpolated.
    pub(crate) fn keys(&self) -> &[f64] {
        self.curves.as_ref().map_or(&[], |curves| &curves.keys)
    }

    /// Photons that met mirrors or glass; those kept whose way was the same for all waves; paths that depend on the wavelength.
    pub(crate) fn counts(&self) -> (u64, usize, usize) {
        (self.sent, self.even.map.len(), self.prefixes.len())
    }

    /// What became of the light.
    pub(crate) const fn account(&self) -> &Account {
        &self.account
    }

    /// Bytes of all photons and paths.
    pub(crate) fn bytes(&self) -> usize {
        let bands: usize = self.bands().iter().map(|band| band.bytes).sum();
        let curves = self.curves.as_ref().map_or(0, |i| i.curves.bytes());
        self.even.map.bytes() + self.prefixes.capacity() * size_of::<Prefix>() + bands + curves
    }
}

/// Gives light that refers to its own products of spectra the numbers that these have in a table, which is extended if need be.
fn renumbered(list: &mut [Arriving], own: &Arc<Spectra>, mut table: Arc<Spectra>) -> Arc<Spectra> {
    if Arc::ptr_eq(own, &table) {
        return table;
    }
    for arriving in list {
        let leaves = own.leaves(arriving.spectrum);
        if table.leaves(arriving.spectrum) != leaves || table.len() <= arriving.spectrum as usize {
            let from_light: Vec<u32> = leaves.iter().rev().copied().collect();
            arriving.spectrum = Arc::make_mut(&mut table).number(&from_light);
        }
    }
    table
}

/// Photons in the order of their paths and branches.
fn sorted(mut photons: Vec<Scattered>) -> Vec<Scattered> {
    photons.sort_by_key(|s| (s.path, s.branch));
    photons
}

impl Caustics for Maps<'_> {
    fn arriving(&self, hit: &Hit, least: f32, asked: Option<(Band, Reach)>, found: &mut Arrived) -> Arc<Spectra> {
        let Some((band, reach)) = asked else { return self.find((&self.even, 1.0), hit, Err(least), found) };
        let mut spectra = None;
        for (band, share) in self.standing_for(band, reach.radius, least).into_iter().flatten() {
            let (slot, before) = (self.bands.get(band), found.list.len());
            let own = self.find((slot.thrown(|band| self.throw(band)), share), hit, Ok(reach), found);
            spectra = Some(match spectra {
                None => own,
                Some(first) => renumbered(&mut found.list[before..], &own, first),
            });
        }
        spectra.unwrap_or_else(|| Arc::clone(&self.even.spectra))
    }

    /// The radius is that for all waves, so that estimates for bands of them differ by nothing else. Where there are too few for that, as at
    /// the ends of a spectrum, it is the largest.
    fn reach(&self, hit: &Hit, least: f32, found: &mut Arrived) -> Option<Reach> {
        let thrown = self.whole.as_ref()?.thrown.get()?;
        if let Some(reach) = self.reach_in(thrown, &self.place(hit), least, &mut found.scratch) {
            return Some(reach);
        }
        let radius = self.density.radius * self.shrink;
        let may_come = thrown.is_moving() || self.reached.is_near(hit.position);
        may_come.then_some(Reach { radius, value: 0.0, bias: 0.0, error: 1.0 })
    }

    fn passing(&self, hit: &Hit, reach: Reach, found: &mut Arrived) -> Option<Arc<Spectra>> {
        let thrown = self.whole.as_ref()?.thrown.get().filter(|thrown| thrown.is_moving())?;
        self.find_passing(thrown, &self.place(hit), reach, found);
        Some(Arc::clone(&thrown.spectra))
    }
}
