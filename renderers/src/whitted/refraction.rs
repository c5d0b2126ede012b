//! Light at smooth boundaries of transparent media, and what becomes of it where the index depends on the wavelength.

use glam::DVec3;
use spectral_core::fresnel;

use super::{Later, Path, Surface, Worker, mirror_ray, receiver};
use crate::direct::single;
use crate::geometry::Hit;
use crate::material::{Dielectric, Material};
use crate::spectral::{Band, Deferred, Monomial, Radiance};

/// Where light met a boundary between media with a wavelength-dependent index.
#[derive(Clone, Debug)]
pub(super) struct Interface {
    hit: Hit,
    direction: DVec3,
    /// The light mirrored there, which is wavelength-free but for its share.
    reflected: Radiance,
    /// The path that came there.
    path: Path,
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
            self.deferred.push(Later::Boundary(interface));
            // The interface's own light already counts for the path's weight.
            radiance.defer(Deferred(number), path.monomial, 1.0);
            return;
        }
        let (share, refracted) = boundary(dielectric, &hit, direction, path.band.map_or(0.0, |band| band.wavelength));
        let mirrored = self.times(Path { weight: path.weight * share, ..path }, dielectric.reflectance);
        self.follow(&mirror_ray(&hit, direction), mirrored, path.interior_before(&hit), radiance);
        if let Some(onward) = refracted {
            self.refract(&hit, onward, Path { weight: path.weight * (1.0 - share), ..path }, dielectric, radiance);
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
            None => Radiance::default(),
            Some(Later::Boundary(interface)) => self.expand_boundary(&interface, band),
            Some(Later::Dispersed(place)) => self.dispersed(&place, band),
            Some(Later::Still(light)) => light.at(band.wavelength),
        }
    }

    fn expand_boundary(&mut self, interface: &Interface, band: Band) -> Radiance {
        let mut light = Radiance::default();
        let scene = self.scene;
        let Some(Surface { material: Material::Dielectric(dielectric), .. }) =
            scene.surfaces.get(interface.hit.shape as usize)
        else {
            return light;
        };
        let (share, refracted) = boundary(dielectric, &interface.hit, interface.direction, band.wavelength);
        for (monomial, weight) in interface.reflected.terms() {
            light.add(*monomial, share * weight);
        }
        for (gathered, monomial, weight) in interface.reflected.gathered() {
            light.gather(*gathered, *monomial, share * weight);
        }
        for (nested, monomial, weight) in interface.reflected.deferred() {
            let inner = self.expand(nested.0 as usize, band);
            for (gathered, factor, inner_weight) in inner.gathered() {
                let product = self.monomials.product(*monomial, *factor);
                light.gather(*gathered, product, share * weight * inner_weight);
            }
            for (factor, inner_weight) in inner.terms() {
                let product = self.monomials.product(*monomial, *factor);
                light.add(product, share * weight * inner_weight);
            }
        }
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
    let normal = receiver(hit).normal;
    let relative = dielectric.relative_index(wavelength);
    let eta = if hit.front { relative } else { 1.0 / relative };
    let cosine = (-direction.dot(normal)).clamp(0.0, 1.0);
    match fresnel::dielectric(cosine, eta) {
        None => (1.0, None),
        Some((share, refracted)) => {
            (share, Some((direction / eta + normal * (cosine / eta - refracted)).normalize_or_zero()))
        }
    }
}
