//! Final gathers from a global photon map: the light that reaches a place from what surfaces around it reflect.
//!
//! Radiosity is estimated beforehand, at places where photons of a pass of their own landed (Christensen, "Faster Photon Map Global
//! Illumination", 1999): not at those of the map's photons, where density is more than its mean. A ray of a gather finds the nearest of these
//! places on the surface that it meets.

use glam::DVec3;
use rayon::prelude::*;

use super::density::region;
use super::global::{Global, Released, Spot, reflectance};
use super::map::Near;
use super::{Balance, Density, Estimate, Extents, Photon, PhotonMap, Place, Shades};
use crate::direct::single;
use crate::geometry::sampling::{SobolSequence, combine, square_to_disk};
use crate::geometry::{Hit, SurfacePoint};
use crate::material::Material;
use crate::radiosity::{Found, Gather, Representation, added_up, follow};
use crate::scene::Scene;
use crate::whitted::Whitted;

/// As many photons are there for each place where radiosity is estimated.
const PHOTONS_OF_A_PLACE: u64 = 8;

/// The pass of photons whose places these are.
const PLACING: u32 = 1;

/// How radiosity is estimated and gathered.
#[derive(Clone, Copy, Debug)]
pub(crate) struct GatherSettings {
    /// How many photons are emitted.
    pub(crate) photons: u64,
    /// Rays of a gather.
    pub(crate) rays: u32,
    /// How radiosity is estimated from photons.
    pub(crate) density: Density,
    /// Gathers with other seeds have other rays.
    pub(crate) seed: u32,
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
    /// The radiosity of all places, row by row.
    radiosity: Vec<f64>,
    /// Photons in the map, products of spectra, and what became of all light.
    pub(crate) photons: usize,
    pub(crate) products: usize,
    pub(crate) balance: Balance,
}

impl<'s> Gatherer<'s> {
    /// Emits photons and estimates radiosity. `progress` is told of photons that were sent, of [`steps`](Self::steps).
    pub(crate) fn new(
        (data, scene): (&Scene, &'s Whitted),
        global: &Global<'s>,
        representation: &'s dyn Representation,
        settings: GatherSettings,
        progress: &(dyn Fn(u64) + Sync),
    ) -> Self {
        let [count, places] = counts(settings.photons);
        let extents = Extents::new(data.shapes.iter().map(|shape| &shape.geometry));
        let Released { photons, shades, balance, .. } = global.emit(count, 0, progress);
        let brightness = global.brightness(&shades);
        let map = PhotonMap::new(photons);
        let Released { photons: others, spots, .. } = global.emit(places, PLACING, progress);
        let mut gatherer = Self {
            scene,
            materials: scene.materials().collect(),
            representation,
            settings,
            extents,
            places: PhotonMap::new(others),
            radiosity: Vec::new(),
            photons: map.len(),
            products: shades.len(),
            balance,
        };
        gatherer.radiosity = gatherer.radiosities(&map, (&shades, &brightness), &spots);
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
        self.places.bytes() + size_of_val(self.radiosity.as_slice())
    }

    fn radiosities(&self, map: &PhotonMap, spectra: (&Shades, &[f32]), spots: &[Spot]) -> Vec<f64> {
        let width = self.representation.width();
        let at = |estimate: &mut Estimate, (photon, origin): (&Photon, &u32)| {
            let mut row = vec![0.0; width];
            if let Some(spot) = spots.get(*origin as usize) {
                self.estimate(map, spectra, (photon, spot), estimate, &mut row);
            }
            row
        };
        let places = self.places.photons().par_iter().zip(self.places.origins());
        let rows: Vec<Vec<f64>> = places.map_init(Estimate::default, at).collect();
        rows.concat()
    }

    /// The radiosity at a place from the photons about it.
    fn estimate(
        &self,
        map: &PhotonMap,
        (shades, brightness): (&Shades, &[f32]),
        (at, spot): (&Photon, &Spot),
        estimate: &mut Estimate,
        row: &mut [f64],
    ) {
        let (shape, front) = (at.surface / 2, at.surface % 2 == 1);
        let material = self.materials.get(shape as usize).and_then(|material| material.side(front));
        let Some(factor) = material.and_then(reflectance) else { return };
        let place = self.place((at.position, spot.normal), shape, at.surface, spot.primitive);
        let worth = |photon: &Photon| photon.flux * brightness.get(photon.spectrum as usize).copied().unwrap_or(1.0);
        self.settings.density.estimate(map, &place, worth, estimate);
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
        self.representation.reflect(factor, row);
    }

    fn place(&self, (position, normal): ([f32; 3], [f32; 3]), shape: u32, surface: u32, primitive: u32) -> Place<'_> {
        let first = self.scene.world().primitives(shape as usize).start;
        Place { position, normal, surface, face: self.extents.face(shape, primitive.wrapping_sub(first)) }
    }

    /// The nearest place with a radiosity to what was hit, on the same surface.
    fn nearest(&self, hit: &Hit, near: &mut Vec<Near>) -> Option<u32> {
        let surface = super::surface(hit.shape, hit.front);
        let position = hit.position.to_array();
        let place = self.place((position, hit.facing_normal().to_array()), hit.shape, surface, hit.primitive);
        let coordinate = position.iter().fold(0.0, |most: f32, x| most.max(x.abs()));
        self.places.nearest(surface, &region(&place, f32::INFINITY, coordinate), 1, near);
        near.first().map(|near| near.photon)
    }

    /// Writes the irradiance that reaches a point from what surfaces reflect, on the side of a unit normal.
    ///
    /// Rays are distributed as the cosine, Owen-scrambled Sobol points for each position by itself: errors of different places are
    /// independent of each other, and the same for the same place. Where rays meet mirrors or glass they go on, at the helium d line.
    pub(crate) fn irradiance(&self, point: &SurfacePoint, normal: DVec3, row: &mut [f64]) {
        let seed = point.position.to_array().iter().fold(self.settings.seed, |seed, x| combine(seed, x.to_bits()));
        let (points, choices) = (SobolSequence::new(seed), SobolSequence::new(combine(seed, 1)));
        let (u, v) = normal.any_orthonormal_pair();
        let mut near = Vec::new();
        let mut found = Vec::with_capacity(self.settings.rays as usize);
        for index in 0..self.settings.rays {
            let disk = square_to_disk(points.point(index, 0)).as_dvec2();
            let height = (1.0 - disk.length_squared()).max(0.0).sqrt();
            let ray = point.ray(single(u * disk.x + v * disk.y + normal * height));
            let Some(end) = follow((self.scene, self.scene.world()), &choices, ray, index) else { continue };
            if let Some(part) = self.nearest(&end.hit, &mut near) {
                found.push(Found { part, tint: end.tint, share: end.weight });
            }
        }
        let key = |found: &Found| (found.tint, found.part);
        found.sort_by_key(key);
        let count = f64::from(self.settings.rays);
        let sum = |same: &[Found]| Found { share: same.iter().map(|f| f.share).sum::<f64>() / count, ..same[0] };
        let found: Vec<Found> = found.chunk_by(|a, b| key(a) == key(b)).map(sum).collect();
        row.copy_from_slice(&added_up(&found, &self.radiosity, self.representation));
    }
}

impl Gather for Gatherer<'_> {
    fn width(&self) -> usize {
        self.representation.width()
    }

    fn values(&self) -> usize {
        self.representation.values()
    }

    fn gather(&self, position: DVec3, normal: DVec3, primitive: u32, row: &mut [f64]) -> [f64; 3] {
        let point = SurfacePoint { primitive, ..SurfacePoint::new(single(position), single(normal)) };
        self.irradiance(&point, normal, row);
        self.representation.colour(&[], row).value
    }
}

/// How many photons the map has, and how many others say where radiosity is estimated.
fn counts(photons: u64) -> [u64; 2] {
    [photons, photons.div_ceil(PHOTONS_OF_A_PLACE)]
}
