//! Light at smooth boundaries of transparent media, and what becomes of it where the index depends on the wavelength.

use alloc::sync::Arc;

use glam::DVec3;
use spectral_core::fresnel;

use super::{Later, Path, Surface, Worker, mirror_ray, receiver};
use crate::direct::single;
use crate::geometry::Hit;
use crate::material::{Dielectric, Material};
use crate::spectral::{Band, Deferred, MEAN_WAVELENGTH, Monomial, Radiance};

/// Where light met a boundary between media with a wavelength-dependent index.
#[derive(Clone, Debug)]
pub(super) struct Interface {
    pub(super) hit: Hit,
    pub(super) direction: DVec3,
    /// The light mirrored there, which is wavelength-free but for its share.
    pub(super) reflected: Radiance,
    /// The path that came there.
    pub(super) path: Path,
}

impl Path {
    /// The shape in whose interior the path is before a boundary that it has met.
    const fn interior_before(&self, hit: &Hit) -> Option<u32> {
        if hit.front { self.interior } else { Some(hit.shape) }
    }
}

impl Worker<'_> {
    pub(super) fn dielectric(
        &mut self,
        hit: Hit,
        direction: DVec3,
        path: Path,
        dielectric: &Dielectric,
        radiance: &mut Radiance,
    ) {
        if path.band.is_none() && !dielectric.is_wavelength_free() {
            let mut reflected = Radiance::default();
            let unit = Path { monomial: Monomial::default(), ..path };
            let by = self.times(unit, dielectric.reflectance);
            self.follow(&mirror_ray(&hit, direction), by, path.interior_before(&hit), &mut reflected);
            let interface = Interface { hit, direction, reflected, path };
            let number = u32::try_from(self.deferred.len()).unwrap_or(u32::MAX);
            self.deferred.push(Later::Boundary(Arc::new(interface)));
            // The interface's own light already counts for the path's weight.
            radiance.defer(Deferred(number), path.monomial, 1.0);
            return;
        }
        let (share, refracted) = boundary(dielectric, &hit, direction, path.band.map_or(0.0, |band| band.wavelength));
        let reflected = Path { weight: path.weight * share, ..path };
        let mirrored = self.times(reflected, dielectric.reflectance);
        self.follow(&mirror_ray(&hit, direction), mirrored, path.interior_before(&hit), radiance);
        if let Some(onward) = refracted {
            let refracted = Path { weight: path.weight * (1.0 - share), ..path };
            self.refract(&hit, onward, refracted, dielectric, radiance);
        }
    }

    /// Follows the light that passes a boundary. Radiance seen from the other side counts as it is: what it gains by
    /// entering a medium it loses by leaving it, and camera and lights are outside.
    fn refract(&mut self, hit: &Hit, onward: DVec3, path: Path, dielectric: &Dielectric, radiance: &mut Radiance) {
        let through = self.times(path, dielectric.transmittance);
        let interior = hit.front.then_some(hit.shape);
        self.follow(&hit.point().ray(single(onward)), through, interior, radiance);
    }

    /// Deferred light for some waves: nothing in it is deferred.
    pub(super) fn expand(&mut self, number: usize, band: Band) -> Radiance {
        match self.deferred.get(number).cloned() {
            Some(Later::Boundary(interface)) => {
                self.prepare(number, &interface, Band::single(MEAN_WAVELENGTH));
                self.expand_boundary(&interface, band)
            }
            // Nothing in these is gathered.
            Some(Later::Dispersed(place)) if !self.is_preparing => self.dispersed(&place, band),
            Some(Later::Curve(light)) if !self.is_preparing => light.over(band, &mut self.band_parts),
            _ => Radiance::default(),
        }
    }

    pub(super) fn expand_boundary(&mut self, interface: &Interface, band: Band) -> Radiance {
        let mut light = Radiance::default();
        let scene = self.scene;
        let Some(Surface { material: Material::Dielectric(dielectric), .. }) =
            scene.surfaces.get(interface.hit.shape as usize)
        else {
            return light;
        };
        let (share, refracted) = boundary(dielectric, &interface.hit, interface.direction, band.wavelength);
        let mirrored = Path { monomial: Monomial::default(), weight: share, ..interface.path };
        self.add_for(band, &interface.reflected, mirrored, &mut light);
        if let Some(onward) = refracted {
            let path = Path {
                monomial: Monomial::default(),
                weight: interface.path.weight * (1.0 - share),
                band: Some(band),
                interior: None,
                ..interface.path
            };
            self.refract(&interface.hit, onward, path, dielectric, &mut light);
        }
        light
    }
}

/// The share of light that a boundary reflects at a wavelength, and the direction in which the rest goes on.
pub(crate) fn boundary(dielectric: &Dielectric, hit: &Hit, direction: DVec3, wavelength: f64) -> (f64, Option<DVec3>) {
    boundary_of(dielectric.relative_index(wavelength), hit, direction)
}

/// The same where the index of the interior relative to the exterior is known.
pub(crate) fn boundary_of(relative: f64, hit: &Hit, direction: DVec3) -> (f64, Option<DVec3>) {
    let normal = receiver(hit).normal;
    let (cosine, eta) = incident(relative, hit, -direction.dot(normal));
    match fresnel::dielectric(cosine, eta) {
        None => (1.0, None),
        Some((share, refracted)) => {
            (share, Some((direction / eta + normal * (cosine / eta - refracted)).normalize_or_zero()))
        }
    }
}

/// The share alone.
pub(crate) fn reflected_by(relative: f64, hit: &Hit, direction: DVec3) -> f64 {
    let (cosine, eta) = incident(relative, hit, -direction.dot(receiver(hit).normal));
    fresnel::dielectric(cosine, eta).map_or(1.0, |(share, _)| share)
}

/// The cosine of the angle at which light comes to a boundary, and the index of what is beyond relative to what is before.
fn incident(relative: f64, hit: &Hit, cosine: f64) -> (f64, f64) {
    (cosine.clamp(0.0, 1.0), if hit.front { relative } else { 1.0 / relative })
}
