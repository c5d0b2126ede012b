//! Final gathers from a global photon map: the light that reaches a place from what surfaces around it reflect.
//!
//! Radiosity is found beforehand, at places where photons of a pass of their own landed (Christensen, "Faster Photon Map Global
//! Illumination", 1999): not at those of the map's photons, where density is more than its mean; and evenly. Light that comes straight from lights is
//! known exactly there, that which comes by way of mirrors and glass alone is estimated from photons. So is other light, at first; then it is
//! gathered at some of the places, since a gather near a corner sees hardly more than one place, and with it the noise of a few photons. A ray
//! of a gather finds the nearest place on the surface that it meets.

use glam::DVec3;
use rayon::prelude::*;

use super::density::region_of;
use super::global::{Global, Kept, Released, Spot, reflectance};
use super::map::Near;
use super::thin::thinned;
use super::{Balance, Density, Estimate, Extents, Photon, PhotonMap, Place, Shades};
use crate::direct::{Receiver, single};
use crate::geometry::sampling::{SobolSequence, combine, square_to_disk};
use crate::geometry::{Hit, SurfacePoint};
use crate::material::Material;
use crate::radiosity::{Found, Gather, Representation, added_up, follow};
use crate::scene::Scene;
use crate::spectral::{Factor, FactorOrder};
use crate::whitted::{Whitted, Worker};

/// As many photons are sent for each that is sent to find places, and for each place that is kept of those found.
const PHOTONS_OF_A_PLACE: [u64; 2] = [2, 8];

/// The pass of photons whose places these are.
const PLACING: u32 = 1;

/// One of so many places has a gather, with so many rays.
const GROUP: usize = 4;
const GROUP_RAYS: u32 = 128;

/// How radiosity is found and gathered.
#[derive(Clone, Copy, Debug)]
pub(crate) struct GatherSettings {
    /// How many photons are emitted.
    pub(crate) photons: u64,
    /// Rays of a gather.
    pub(crate) rays: u32,
    /// How irradiance is estimated from photons.
    pub(crate) density: Density,
    /// Gathers with other seeds have other rays.
    pub(crate) seed: u32,
    /// Whether the light that photons brought may be reflected twice more before it reaches a receiver.
    pub(crate) twice: bool,
}

/// Radiosity at places all over a scene.
pub(crate) struct Gatherer<'s> {
    scene: &'s Whitted,
    /// One for each shape.
    materials: Vec<&'s Material>,
    representation: &'s dyn Representation,
    settings: GatherSettings,
    extents: Extents,
    places: PhotonMap,
    /// What the photons don't say of the places.
    spots: Vec<Spot>,
    /// The radiosity of all places, row by row.
    radiosity: Vec<f64>,
    /// Photons in the map, products of spectra, and what became of all light.
    pub(crate) photons: usize,
    pub(crate) products: usize,
    pub(crate) balance: Balance,
}

/// Photons, and what is worth what.
struct Known<'k> {
    map: PhotonMap,
    shades: &'k Shades,
    brightness: &'k [f32],
}

impl<'s> Gatherer<'s> {
    /// Emits photons and finds radiosity. `progress` is told of photons that were sent, of [`steps`](Self::steps).
    pub(crate) fn new(
        (data, scene): (&Scene, &'s Whitted),
        global: &Global<'s>,
        representation: &'s dyn Representation,
        settings: GatherSettings,
        progress: &(dyn Fn(u64) + Sync),
    ) -> Self {
        let [count, others] = counts(settings.photons);
        let Released { photons, caustic, shades, balance, .. } = global.emit(count, (0, Kept::Indirect), progress);
        let brightness = global.brightness(&shades);
        let known = |is_caustic: bool| {
            let some = photons.iter().zip(&caustic).filter(|(_, caustic)| **caustic == is_caustic);
            let map = PhotonMap::new(some.map(|(photon, _)| *photon).collect());
            Known { map, shades: &shades, brightness: &brightness }
        };
        let Released { photons: others, spots, .. } = global.emit(others, (PLACING, Kept::Spread), progress);
        let wanted = usize::try_from(settings.photons.div_ceil(PHOTONS_OF_A_PLACE[1])).unwrap_or(usize::MAX);
        let chosen = thinned(&others, wanted);
        let places = PhotonMap::new(chosen.iter().map(|number| others[*number]).collect());
        let spot = |origin: &u32| spots.get(*chosen.get(*origin as usize)?).copied();
        let mut gatherer = Self {
            scene,
            materials: scene.materials().collect(),
            representation,
            settings,
            extents: Extents::new(data.shapes.iter().map(|shape| &shape.geometry)),
            spots: places.origins().iter().filter_map(spot).collect(),
            places,
            radiosity: Vec::new(),
            photons: photons.len(),
            products: shades.len(),
            balance,
        };
        gatherer.find([&known(true), &known(false)]);
        gatherer
    }

    /// How many steps [`new`](Self::new) tells its progress of.
    pub(crate) fn steps(global: &Global<'_>, photons: u64) -> u64 {
        counts(photons).into_iter().map(|count| global.attempts(count)).sum()
    }

    /// How many numbers there are in a row.
    pub(crate) fn row_width(&self) -> usize {
        self.representation.width()
    }

    /// At how many places radiosity is known.
    pub(crate) fn places(&self) -> usize {
        self.places.len()
    }

    /// Bytes of places and radiosities.
    pub(crate) fn bytes(&self) -> usize {
        self.places.bytes() + size_of_val(self.spots.as_slice()) + size_of_val(self.radiosity.as_slice())
    }

    /// Finds the radiosity of all places, from photons that came by mirrors and glass alone and from all others.
    fn find(&mut self, [caustic, other]: [&Known<'_>; 2]) {
        let lights: Vec<Factor> = self.scene.light_factors().collect();
        let new = || (Estimate::default(), Worker::new(self.scene, FactorOrder::Free));
        let first = self.rows(new, |(estimate, worker), place, spot, row| {
            self.estimate(caustic, place, estimate, row);
            self.add_direct((worker, &lights), &spot.point, row);
        });
        let estimated = self.rows(Estimate::default, |estimate, place, _, row| {
            self.estimate(other, place, estimate, row);
        });
        self.radiosity = self.reflected(&first, &estimated);
        if self.settings.twice {
            let gathered = self.gathered(estimated);
            self.radiosity = self.reflected(&first, &gathered);
        }
    }

    /// A row for each place, by threads with memory of their own.
    fn rows<M>(
        &self,
        memory: impl Fn() -> M + Sync + Send,
        fill: impl Fn(&mut M, &Place<'_>, &Spot, &mut [f64]) + Sync + Send,
    ) -> Vec<f64> {
        let width = self.row_width();
        let mut rows = vec![0.0; self.spots.len() * width];
        let places = self.places.photons().par_iter().zip(&self.spots).zip(rows.par_chunks_mut(width.max(1)));
        places.for_each_init(memory, |memory, ((photon, spot), row)| {
            fill(memory, &self.place_of(photon, spot), spot, row);
        });
        rows
    }

    /// What the places reflect of all that reaches them.
    fn reflected(&self, first: &[f64], second: &[f64]) -> Vec<f64> {
        let width = self.row_width().max(1);
        let mut rows: Vec<f64> = first.iter().zip(second).map(|(a, b)| a + b).collect();
        let places = self.places.photons().par_iter().zip(rows.par_chunks_mut(width));
        places.for_each(|(photon, row)| {
            let (shape, front) = (photon.surface / 2, photon.surface % 2 == 1);
            let material = self.materials.get(shape as usize).and_then(|material| material.side(front));
            match material.and_then(reflectance) {
                Some(factor) => self.representation.reflect(factor, row),
                None => row.fill(0.0),
            }
        });
        rows
    }

    /// The irradiance of all places as gathers at some of them have it, where there is one on the same surface.
    fn gathered(&self, mut rows: Vec<f64>) -> Vec<f64> {
        let width = self.row_width().max(1);
        let some: Vec<(Photon, Spot)> =
            self.places.photons().iter().copied().zip(self.spots.iter().copied()).step_by(GROUP).collect();
        let gather = |(_, spot): &(Photon, Spot)| {
            let mut row = vec![0.0; width];
            self.gather_at(&spot.point, spot.point.normal.as_dvec3(), GROUP_RAYS, &mut row);
            row
        };
        let gathers: Vec<Vec<f64>> = some.par_iter().map(gather).collect();
        let map = PhotonMap::new(some.into_iter().map(|(photon, _)| photon).collect());
        let places = self.places.photons().par_iter().zip(&self.spots).zip(rows.par_chunks_mut(width));
        places.for_each_init(Vec::new, |near, ((photon, spot), row)| {
            let number = nearest(&map, &self.place_of(photon, spot), near);
            let origin = number.and_then(|number| map.origins().get(number as usize));
            if let Some(gathered) = origin.and_then(|origin| gathers.get(*origin as usize)) {
                row.copy_from_slice(gathered);
            }
        });
        rows
    }

    /// Adds the irradiance at a place straight from lights.
    fn add_direct(&self, (worker, lights): (&mut Worker<'_>, &[Factor]), point: &SurfacePoint, row: &mut [f64]) {
        let (position, normal) = (point.position.as_dvec3(), point.normal.as_dvec3());
        let contact = 2.0 * f64::from(point.error);
        let receiver = Receiver { point: *point, position, normal, geometric: normal, contact };
        let mut spectrum = vec![0.0; row.len()];
        for (factor, irradiance) in lights.iter().zip(worker.direct(&receiver)) {
            if irradiance > 0.0 {
                self.representation.light(*factor, &mut spectrum);
                row.iter_mut().zip(&spectrum).for_each(|(r, s)| *r += irradiance * s);
            }
        }
    }

    /// Adds the irradiance at a place from the photons about it.
    fn estimate(&self, known: &Known<'_>, place: &Place<'_>, estimate: &mut Estimate, row: &mut [f64]) {
        let Known { map, shades, brightness } = known;
        if map.is_empty() {
            return;
        }
        let worth = |photon: &Photon| photon.flux * brightness.get(photon.spectrum as usize).copied().unwrap_or(1.0);
        self.settings.density.estimate(map, place, worth, estimate);
        let irradiance = |(number, weight): (u32, f32)| {
            let photon = map.photons().get(number as usize)?;
            Some((photon.spectrum, f64::from(weight) * f64::from(photon.flux)))
        };
        let mut found: Vec<(u32, f64)> = estimate.photons().filter_map(irradiance).collect();
        found.sort_by_key(|(spectrum, _)| *spectrum);
        let mut product = vec![0.0; row.len()];
        for same in found.chunk_by(|a, b| a.0 == b.0) {
            let sum: f64 = same.iter().map(|(_, irradiance)| irradiance).sum();
            shades.row(same[0].0, self.representation, &mut product);
            row.iter_mut().zip(&product).for_each(|(r, p)| *r += sum * p);
        }
    }

    fn place_of(&self, photon: &Photon, spot: &Spot) -> Place<'_> {
        self.place((photon.position, spot.point.normal.to_array()), photon.surface, spot.primitive)
    }

    fn place(&self, (position, normal): ([f32; 3], [f32; 3]), surface: u32, primitive: u32) -> Place<'_> {
        let shape = surface / 2;
        let first = self.scene.world().primitives(shape as usize).start;
        Place { position, normal, surface, face: self.extents.face(shape, primitive.wrapping_sub(first)) }
    }

    /// The place with a radiosity for what was hit.
    fn found(&self, hit: &Hit, near: &mut Vec<Near>) -> Option<u32> {
        let surface = super::surface(hit.shape, hit.front);
        let place = self.place((hit.position.to_array(), hit.facing_normal().to_array()), surface, hit.primitive);
        nearest(&self.places, &place, near)
    }

    /// Writes the irradiance that reaches a point from what surfaces reflect, on the side of a unit normal.
    ///
    /// Rays are distributed as the cosine, Owen-scrambled Sobol points for each position by itself: errors of different places are
    /// independent of each other, and the same for the same place. Where rays meet mirrors or glass they go on, at the helium d line.
    pub(crate) fn irradiance(&self, point: &SurfacePoint, normal: DVec3, row: &mut [f64]) {
        self.gather_at(point, normal, self.settings.rays, row);
    }

    fn gather_at(&self, point: &SurfacePoint, normal: DVec3, rays: u32, row: &mut [f64]) {
        let seed = point.position.to_array().iter().fold(self.settings.seed, |seed, x| combine(seed, x.to_bits()));
        let (points, choices) = (SobolSequence::new(seed), SobolSequence::new(combine(seed, 1)));
        let (u, v) = normal.any_orthonormal_pair();
        let mut near = Vec::new();
        let mut found = Vec::with_capacity(rays as usize);
        for index in 0..rays {
            let disk = square_to_disk(points.point(index, 0)).as_dvec2();
            let height = (1.0 - disk.length_squared()).max(0.0).sqrt();
            let ray = point.ray(single(u * disk.x + v * disk.y + normal * height));
            let Some(end) = follow((self.scene, self.scene.world()), &choices, ray, index) else { continue };
            if let Some(part) = self.found(&end.hit, &mut near) {
                found.push(Found { part, tint: end.tint, share: end.weight });
            }
        }
        let key = |found: &Found| (found.tint, found.part);
        found.sort_by_key(key);
        let count = f64::from(rays);
        let sum = |same: &[Found]| Found { share: same.iter().map(|f| f.share).sum::<f64>() / count, ..same[0] };
        let found: Vec<Found> = found.chunk_by(|a, b| key(a) == key(b)).map(sum).collect();
        row.copy_from_slice(&added_up(&found, &self.radiosity, self.representation));
    }
}

impl Gather for Gatherer<'_> {
    fn width(&self) -> usize {
        self.row_width()
    }

    fn values(&self) -> usize {
        self.representation.linear()
    }

    fn gather(&self, position: DVec3, normal: DVec3, primitive: u32, row: &mut [f64]) -> [f64; 3] {
        let point = SurfacePoint { primitive, ..SurfacePoint::new(single(position), single(normal)) };
        self.irradiance(&point, normal, row);
        self.representation.colour(&[], row).value
    }
}

/// The nearest photon to a place, on the same face or where the surface hasn't bent much.
fn nearest(map: &PhotonMap, place: &Place<'_>, near: &mut Vec<Near>) -> Option<u32> {
    map.nearest(place.surface, &region_of(place, f32::INFINITY), 1, near);
    near.first().map(|near| near.photon)
}

/// How many photons the map has, and how many others say where radiosity is found.
fn counts(photons: u64) -> [u64; 2] {
    [photons, photons.div_ceil(PHOTONS_OF_A_PLACE[0])]
}
