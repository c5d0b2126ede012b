//! The photon maps of a scene: one for light that all waves share, one for all that depends on the wavelength, and, if asked for, one for each bundle
//! of waves.

use alloc::sync::Arc;
use core::ops::Range;

use rayon::prelude::*;

use super::bands::{BandReport, Bands, Slot, Thrown};
use super::curves::{self, Curves};
use super::density::region_of;
use super::footprints::{Footprint, LEAVES, evened};
use super::lines;
use super::map::Region;
use super::passing::Wanted;
use super::reached::Reached;
use super::waves::{Bundle, Waves};
use super::{
    Account, Density, Emission, Emitted, Estimate, Extents, Photon, PhotonMap, Place, Prefix, Scattered, Spectra,
    surface,
};
use crate::geometry::{Hit, Ray};
use crate::radiosity::Deposit;
use crate::scene::Scene;
use crate::spectral::{Band, Factor};
use crate::whitted::{Arrived, Arriving, Caustics, Dispersion, How, Whitted};
use spectral_core::interval::{FIRST_WAVELENGTH, LAST_WAVELENGTH};

/// How photons that depend on the wavelength are thrown for a band.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Rethrow {
    /// They are not: each is traced at one wavelength with its derivatives, or, where these say too little, all at a few, the more the more they bend; they
    /// are found at all others by one search.
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
    /// How many paths depend on the wavelength.
    dispersed: usize,
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

/// How far, relative to the radius of an estimate, photons may be from where they are thought to be.
pub(super) const NEAR: f32 = 0.1;

/// Light is taken to differ between the thirds of all waves by this part of itself at least.
const EVEN: f64 = 0.1;

impl<'s> Maps<'s> {
    /// Makes the maps that are certain to be asked for, of so many photons that meet mirrors or glass.
    ///
    /// Where it is known from one wavelength how photons move, paths are followed to their end at once; otherwise they are thrown again, behind the
    /// first boundary where wavelengths part.
    pub(crate) fn new(
        (data, scene): (&Scene, &'s Whitted),
        emission: &'s Emission<'s>,
        (count, pass, progress): (u64, u32, &(dyn Fn(u64) + Sync)),
        (density, shrink): (Density, f32),
        (bundle, rethrow): (Bundle, Rethrow),
    ) -> Self {
        let waves = Waves::new(bundle);
        let are_bands_asked = rethrow == Rethrow::Traced || !waves.is_continuous();
        let lines = if are_bands_asked { None } else { lines::usual_radius(emission, count, &density, &waves) };
        let emitted = match lines {
            None => emission.emit(count, pass, progress),
            Some(_) => emission.emit_drifting(count, pass, &|number| waves.spread(WHOLE, number), progress),
        };
        let Emitted { photons, prefixes, drifting, drifted, spectra, account } = emitted;
        let mut maps = Self {
            scene,
            extents: Extents::new(data.shapes.iter().map(|shape| &shape.geometry)),
            density,
            shrink,
            waves,
            even: Thrown::new(photons, Arc::new(spectra), emission),
            dispersed: drifted + prefixes.len(),
            prefixes,
            curves: None,
            usual: lines.unwrap_or(0.0),
            shift: 0.0,
            steepest: 0.0,
            reached: Reached::default(),
            bands: Bands::default(),
            whole: None,
            sent: account.sent,
            account,
            emission,
        };
        let radii = maps.radii(&maps.even);
        maps.even = core::mem::take(&mut maps.even).spread(radii, maps.alone());
        if drifted > 0 {
            let spectra = Arc::clone(&maps.even.spectra);
            let thrown = Thrown::drifting(drifting, maps.waves.thirds(WHOLE), spectra, emission);
            maps.know_whole(thrown);
        }
        if !maps.prefixes.is_empty() {
            maps.usual = maps.usual_radius();
            if are_bands_asked {
                maps.shift = maps.shift();
                (maps.steepest, maps.reached) = maps.probe();
            }
            if rethrow == Rethrow::Interpolated {
                maps.curves = Some(maps.interpolated(NEAR * maps.usual));
            }
            maps.know_whole(maps.throw(WHOLE));
            if !are_bands_asked && let Some(known) = &mut maps.curves {
                // All is in the map.
                known.curves = Curves::default();
            }
        }
        maps
    }

    /// Keeps the map for all waves.
    fn know_whole(&mut self, thrown: Thrown) {
        let whole = self.bands.get(WHOLE);
        whole.thrown(|_| self.spread(thrown));
        self.whole = Some(whole);
    }

    /// About so many of the paths, thrown at a wavelength.
    fn tried(&self, paths: usize, wavelength: f64) -> Vec<Scattered> {
        let stride = self.prefixes.len().div_ceil(paths).max(1);
        let some: Vec<Prefix> = self.prefixes.iter().step_by(stride).copied().collect();
        self.emission.throw(&some, |_| wavelength, &mut (*self.even.spectra).clone()).photons()
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
        let mut thrown =
            |wavelength: &f64| (*wavelength, self.emission.throw(&self.prefixes, |_| *wavelength, &mut spectra).pieces);
        let curves = Curves::new(&keys.iter().map(&mut thrown).collect::<Vec<_>>());
        Interpolated { keys, curves, spectra: Arc::new(spectra) }
    }

    /// About the radius of an estimate where there are photons: that of some of them, among which photons are farther apart.
    #[allow(clippy::cast_precision_loss, reason = "as precise as radii")]
    fn usual_radius(&self) -> f32 {
        let some = self.tried(TRIED, WHOLE.wavelength);
        let map = PhotonMap::new(some.into_iter().map(|s| s.photon).collect());
        let stride = self.prefixes.len().div_ceil(TRIED).max(1);
        self.density.usual_radius(&map) / (stride as f32).sqrt()
    }

    /// How far photons count about a hit whose ways depend on the wavelength.
    fn radius_at(&self, hit: &Hit) -> f32 {
        let whole = self.whole.as_ref().and_then(|slot| slot.thrown.get());
        let surface = surface(hit.shape, hit.front);
        let known = whole.and_then(|whole| whole.footprints.at(&whole.map, surface, hit.position.to_array()));
        known.unwrap_or(self.alone()).radius
    }

    /// The photons of a band.
    fn throw(&self, band: Band) -> Thrown {
        // The map of all waves says where light is: it has all of them in any case.
        let is_whole = band.limits == WHOLE.limits;
        let wavelength_of =
            |path: u32| if is_whole { self.waves.spread(band, path) } else { self.waves.of_path(band, path) };
        if let Some(Interpolated { curves, spectra, .. }) = &self.curves {
            if is_whole && self.waves.is_continuous() {
                let waves = (wavelength_of, self.waves.thirds(band));
                return Thrown::moving((curves, self.usual), waves, Arc::clone(spectra), self.emission);
            }
            let photons = curves.photons(band.limits, wavelength_of);
            return Thrown::new(photons, Arc::clone(spectra), self.emission);
        }
        // Beginning with those of all waves, products have the same numbers in all maps, but for rare ones.
        let whole = self.whole.as_ref().and_then(|slot| slot.thrown.get());
        let mut spectra = Spectra::clone(&whole.unwrap_or(&self.even).spectra);
        #[allow(clippy::cast_possible_truncation, reason = "paths have numbers of 32 bits")]
        let thrown = self.emission.throw(&self.prefixes, |path| wavelength_of(path as u32), &mut spectra);
        let photons: Vec<Photon> = thrown.pieces.iter().flatten().map(|s| s.photon).collect();
        Thrown::new(photons, Arc::new(spectra), self.emission)
    }

    /// The same with how far they count: by themselves, if they are the first that depend on the wavelength, or else as far as these, so that estimates
    /// for bands differ by nothing else.
    fn spread(&self, thrown: Thrown) -> Thrown {
        let whole = self.whole.as_ref().and_then(|slot| slot.thrown.get());
        let radii = match whole {
            None => self.radii(&thrown),
            Some(whole) => {
                let radius = |numbers: Range<usize>| {
                    let (_, photon) = thrown.map.middle_of(numbers)?;
                    whole.footprints.at(&whole.map, photon.surface, photon.position)
                };
                thrown.map.leaves_photons().map(|numbers| radius(numbers).unwrap_or(self.alone())).collect()
            }
        };
        thrown.spread(radii, self.alone())
    }

    /// How far photons count, for each leaf of a map: as is best about one in its middle, and evened out.
    fn radii(&self, thrown: &Thrown) -> Vec<Footprint> {
        let map = &thrown.map;
        let radius = |scratch: &mut Estimate, numbers: Range<usize>| {
            let (number, photon) = map.middle_of(numbers)?;
            // Beside an edge it may not be found again: the others tell without the plane, then.
            let alone = Place { position: photon.position, normal: [0.0; 3], surface: photon.surface, face: None };
            let place = self.hit(photon).map_or(alone, |hit| self.place(&hit));
            let worth = |photon: &Photon| thrown.worth(photon);
            let Footprint { radius, bias } = self.density.footprint(map, (&place, number), worth, scratch);
            Some(Footprint { radius: radius * self.shrink, bias: bias * self.shrink * self.shrink })
        };
        let leaves: Vec<Range<usize>> = map.leaves_photons().collect();
        let leaves = leaves.into_par_iter().with_min_len(LEAVES);
        evened(
            map,
            &leaves
                .map_init(Estimate::default, |s, numbers| radius(s, numbers).unwrap_or(self.alone()))
                .collect::<Vec<_>>(),
        )
    }

    /// How far photons count that are alone.
    fn alone(&self) -> Footprint {
        let Footprint { radius, bias } = self.density.alone();
        Footprint { radius: radius * self.shrink, bias }
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

    /// Whether light at a place is slight enough to be taken as white, if the standard deviation between thirds of the waves may be so much: the light is
    /// found, then, and that is an error of the photons' like the others.
    fn is_slight(&self, thrown: &Thrown, place: (&Place<'_>, &Region), most: f64, found: &mut Arrived) -> bool {
        found.list.clear();
        self.find((thrown, 1.0), place, found);
        let Arrived { list, scratch, .. } = found;
        if scratch.value * EVEN > most {
            return false;
        }
        let uneven = scratch.value * thrown.unevenness(scratch.photons());
        let more = scratch.error_with(uneven);
        list.iter_mut().for_each(|arriving| arriving.error *= more);
        uneven <= most
    }

    /// Finds a share of the light that reaches a hit by photons, each of them where it landed at a wavelength of its own.
    fn find_at(&self, from: (&Thrown, f64), hit: &Hit, least: f32, found: &mut Arrived) -> Arc<Spectra> {
        let place = self.place(hit);
        self.find(from, (&place, &region_of(&place, least)), found)
    }

    /// The same at a place.
    fn find(&self, (thrown, share): (&Thrown, f64), place: (&Place<'_>, &Region), found: &mut Arrived) -> Arc<Spectra> {
        let Thrown { map, spectra, footprints, .. } = thrown;
        let worth = |photon: &Photon| thrown.worth(photon);
        self.density.estimate_by((map, footprints), place, worth, &mut found.scratch);
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
                let (place, worth) = (self.place(&hit), |photon: &Photon| thrown.worth(photon));
                self.density.estimate_by(
                    (map, &thrown.footprints),
                    (&place, &region_of(&place, 0.0)),
                    worth,
                    &mut estimate,
                );
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

    /// The hit of the ray that brought a photon. Photons that are interpolated may be below a surface that bends.
    fn hit(&self, photon: &Photon) -> Option<Hit> {
        let bent = (self.usual > 0.0).then_some(2.0 * NEAR * self.usual);
        self.hit_from(photon, 0.0).or_else(|| self.hit_from(photon, bent?))
    }

    /// The same of its last part: a short one and some more, in scene units.
    fn hit_from(&self, photon: &Photon, more: f32) -> Option<Hit> {
        let world = self.scene.world();
        let [low, high] = world.bounds();
        let direction = glam::Vec3A::from_array(photon.direction);
        let above = SHORT * (high - low).length() + more;
        let origin = glam::Vec3A::from_array(photon.position) + direction * above;
        let hit = world.closest_hit(&Ray::new(origin, -direction))?;
        (surface(hit.shape, hit.front) == photon.surface).then_some(hit)
    }

    /// The maps of bands that were made, wider ones first.
    pub(crate) fn bands(&self) -> Vec<BandReport> {
        self.bands.used()
    }

    /// The wavelengths in nm between which photons are interpolated; none if each path was followed at one.
    pub(crate) fn keys(&self) -> &[f64] {
        self.curves.as_ref().map_or(&[], |curves| &curves.keys)
    }

    /// Photons that met mirrors or glass; those kept whose way was the same for all waves; paths that depend on the wavelength.
    pub(crate) fn counts(&self) -> (u64, usize, usize) {
        (self.sent, self.even.map.len(), self.dispersed)
    }

    /// What became of the light.
    pub(crate) const fn account(&self) -> &Account {
        &self.account
    }

    /// Bytes of all photons and paths.
    pub(crate) fn bytes(&self) -> usize {
        let bands: usize = self.bands().iter().map(|band| band.bytes).sum();
        let curves = self.curves.as_ref().map_or(0, |i| i.curves.bytes());
        self.even.bytes() + self.prefixes.capacity() * size_of::<Prefix>() + bands + curves
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

impl Caustics for Maps<'_> {
    fn arriving(&self, hit: &Hit, least: f32, band: Option<Band>, found: &mut Arrived) -> Arc<Spectra> {
        let Some(band) = band else { return self.find_at((&self.even, 1.0), hit, least, found) };
        let mut spectra = None;
        for (band, share) in self.standing_for(band, self.radius_at(hit), least).into_iter().flatten() {
            let (slot, before) = (self.bands.get(band), found.list.len());
            let own = self.find_at((slot.thrown(|band| self.spread(self.throw(band))), share), hit, least, found);
            spectra = Some(match spectra {
                None => own,
                Some(first) => renumbered(&mut found.list[before..], &own, first),
            });
        }
        spectra.unwrap_or_else(|| Arc::clone(&self.even.spectra))
    }

    fn luminance(&self, spectrum: Factor) -> f64 {
        self.emission.luminance(spectrum)
    }

    fn is_dispersed(&self) -> bool {
        self.whole.as_ref().and_then(|slot| slot.thrown.get()).is_some_and(Thrown::is_moving)
    }

    fn is_by_bands(&self) -> bool {
        self.whole.as_ref().and_then(|slot| slot.thrown.get()).is_some_and(|thrown| !thrown.is_moving())
    }

    fn dispersed(&self, hit: &Hit, how: How, band: Option<Band>, found: &mut Arrived) -> Dispersion {
        let How { least, alike, slight } = how;
        let Some(thrown) = self.whole.as_ref().and_then(|slot| slot.thrown.get()) else { return Dispersion::None };
        let place = self.place(hit);
        let mut region = region_of(&place, least);
        if thrown.is_moving() {
            // As far as photons are from where they are thought to be: on curved surfaces, and by rounding.
            region.thickness = 2.0 * region.thickness + if place.face.is_none() { NEAR * self.usual } else { 0.0 };
            // The more passes there are, the less is taken as white: their mean is to have all colours.
            let slight = slight * f64::from(self.shrink) * f64::from(self.shrink);
            if slight > 0.0 && self.is_slight(thrown, (&place, &region), slight, found) {
                return Dispersion::Slight(Arc::clone(&thrown.spectra));
            }
            found.passed.find(thrown, (&place, &region), &self.density, Wanted { band, alike });
            return Dispersion::Known(Arc::clone(&thrown.spectra));
        }
        let mut may_come = self.reached.is_near(hit.position);
        if !may_come {
            thrown.footprints.counting(&thrown.map, place.surface, &region, |_, _| may_come = true);
        }
        if may_come { Dispersion::ByBands } else { Dispersion::None }
    }
}
