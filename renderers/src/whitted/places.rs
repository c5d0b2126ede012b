//! Light of places where a pixel's paths have come for all waves, taken for some of these at places nearby.
//!
//! What is seen through glass is followed at a few wavelengths. Those of a path that hardly counts, or that hardly part, end at about the same place:
//! what surfaces reflect is found there once, and the boundaries' shares and the colour of what depends on the wavelength are each wave's own.

use alloc::sync::Arc;

use glam::DVec3;

use super::curve::Curve;
use super::{Path, Worker};
use crate::geometry::Hit;
use crate::spectral::{Factor, Monomial, Radiance};

/// Within this part of half a pixel's width light is alike for each ΔE*ab that is tolerated, for a path that is all that its camera ray sees; for one
/// that counts for less, within as much more, up to this many halves of a pixel. That there are other camera rays makes it no better: what is off is so
/// for all.
const ALIKE: f64 = 0.05;
const FARTHEST: f64 = 16.0;

/// What a diffuse surface reflects at a place, of paths that all waves take there.
#[derive(Clone, Debug)]
pub(super) struct Place {
    hit: Hit,
    /// Half a pixel's width where it was found, in scene units.
    least: f32,
    light: Radiance,
    /// Light whose way there depends on the wavelength.
    curve: Option<Arc<Curve>>,
    /// The standard errors of what photons have of both.
    noise: Radiance,
}

impl Place {
    /// How far a hit is on the same plane of the same shape, in scene units.
    fn distance(&self, hit: &Hit) -> Option<f64> {
        let (own, way) = (&self.hit, (hit.position - self.hit.position).as_dvec3());
        let is_same = own.shape == hit.shape
            && own.front == hit.front
            && own.planar
            && hit.planar
            && own.geometric_normal == hit.geometric_normal
            && own.shading_normal == hit.shading_normal;
        let height = way.dot(hit.geometric_normal.as_dvec3()).abs();
        (is_same && height <= 4.0 * f64::from(own.error + hit.error)).then(|| way.length())
    }
}

impl Worker<'_> {
    /// Adds what a diffuse surface reflects for some waves: as found nearby for all of them, if that is near enough. What is found for all waves is kept.
    /// False if it must be found otherwise.
    pub(super) fn reflects_alike(
        &mut self,
        (hit, direction): (&Hit, DVec3),
        path: Path,
        reflectance: Factor,
        radiance: &mut Radiance,
    ) -> bool {
        let is_tolerated = self.tolerance > 0.0 && !self.is_preparing && hit.planar;
        let is_by_bands = || self.caustics.is_some_and(super::Caustics::is_by_bands);
        let Some(band) = path.band.filter(|_| is_tolerated && !is_by_bands()) else { return false };
        let (own, halves) = (self.least(path), (ALIKE * self.tolerance * path.whole / path.weight.abs()).min(FARTHEST));
        let near = |place: &Arc<Place>| {
            let farthest = halves * f64::from(place.least.min(own));
            place.distance(hit).filter(|distance| *distance <= farthest).map(|distance| (distance, Arc::clone(place)))
        };
        let nearest = self.places.iter().filter_map(near).min_by(|a, b| a.0.total_cmp(&b.0));
        let place = match nearest {
            Some((_, place)) => place,
            None if band.is_whole() => {
                let Some(place) = self.place((hit, direction), path, reflectance) else { return false };
                let place = Arc::new(place);
                self.places.push(Arc::clone(&place));
                place
            }
            None => return false,
        };
        self.add_product(&place.light, path, radiance);
        if let Some(curve) = &place.curve {
            let light = curve.over(band, &mut self.band_parts);
            self.add_product(&light, path, radiance);
        }
        let share = path.weight * self.noise_share(path.band);
        for (monomial, error) in place.noise.terms() {
            let product = self.monomials.product(path.monomial, *monomial);
            self.noise.add(product, share * error);
        }
        true
    }

    /// What a surface reflects at a place; `None` if it can't be found for all waves at once.
    fn place(&mut self, (hit, direction): (&Hit, DVec3), path: Path, reflectance: Factor) -> Option<Place> {
        let unit = Path { monomial: Monomial::default(), weight: 1.0, ..path };
        let mut light = Radiance::default();
        self.diffuse(hit, unit, reflectance, &mut light);
        let before = core::mem::take(&mut self.noise);
        let curve = self.caustic_for_all((hit, direction), Path { band: None, ..unit }, &mut light);
        let noise = core::mem::replace(&mut self.noise, before);
        Some(Place { hit: *hit, least: self.least(path), light, curve: curve?, noise })
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3A;

    use super::Place;
    use crate::geometry::Hit;
    use crate::geometry::sampling::SobolSequence;
    use crate::photon::{Bundle, Density, Emission, Maps, Rethrow, Settings};
    use crate::scene::builtin;
    use crate::spectral::{Band, FactorOrder, Monomial, Palette, Radiance, Tracer};
    use crate::whitted::{Whitted, Worker};

    const SIDE: u16 = 24;
    const WHOLE: Band = Band { wavelength: 560.0, limits: [380.0, 780.0] };
    const BLUE: Band = Band { wavelength: 480.0, limits: [380.0, 580.0] };

    /// Light, or errors: products by their leaves, in order.
    type Terms = Vec<(Vec<u32>, f64)>;

    fn terms(worker: &Worker<'_>, light: &Radiance) -> Terms {
        let term = |(monomial, weight): &(Monomial, f64)| (worker.monomials.leaves(*monomial).to_vec(), *weight);
        let mut terms: Vec<_> = light.terms().iter().map(term).collect();
        terms.sort_by(|a, b| a.0.cmp(&b.0));
        terms
    }

    fn sum(terms: &Terms) -> f64 {
        terms.iter().map(|(_, weight)| weight).sum()
    }

    fn of_product(terms: &Terms, leaves: &[u32]) -> f64 {
        terms.iter().filter(|(own, _)| own == leaves).map(|(_, weight)| weight).sum()
    }

    /// What is seen through glass in a pixel by so many rays, for one band after the other, with its errors.
    fn seen<const N: usize>(
        worker: &mut Worker<'_>,
        [x, y]: [f64; 2],
        rays: u16,
        bands: [Band; N],
    ) -> [(Terms, Terms); N] {
        let mut light = Radiance::default();
        worker.start_pixel(SobolSequence::new(0));
        for ray in 0..rays {
            let off = f64::from(ray) / f64::from(rays);
            worker.sample(x + off, y + off, 1.0 / f64::from(rays), &mut light);
        }
        worker.take_noise();
        bands.map(|band| {
            let mut all = Radiance::default();
            for (deferred, _, weight) in light.deferred() {
                // Photons' light on what is seen at once is there at all wavelengths.
                let every: Vec<u16> = (0..8).map(|power| 1 << power).collect();
                if !worker.lines(*deferred, (Monomial::default(), 1.0), &every, &mut |_, _| {}) {
                    for (monomial, own) in worker.trace(*deferred, band).terms() {
                        all.add(*monomial, weight * own);
                    }
                }
            }
            let noise = worker.take_noise();
            (terms(worker, &all), terms(worker, &noise))
        })
    }

    /// What is kept for all waves is what is found for them without keeping it; some waves take it as far as that is tolerated, with its errors, and
    /// as near where many rays share a pixel. Where photons are asked for by bands, nothing is kept.
    #[test]
    fn what_is_kept_is_what_is_found() {
        let scene = builtin::load("cornell-box-spheres", &[]).unwrap();
        let mut palette = Palette::default();
        let whitted = Whitted::new(&scene, [u32::from(SIDE); 2], &mut palette).unwrap();
        let emission = Emission::new(&scene, &whitted, &palette, Settings::default());
        let maps = |rethrow: Rethrow| {
            let photons: (_, _, &(dyn Fn(u64) + Sync)) = (20_000, 0, &|_| {});
            let how = (Bundle::Continuous, rethrow);
            Maps::new((&scene, &whitted), &emission, photons, (Density::default(), 1.0), how)
        };
        let [interpolated, traced] = [Rethrow::Interpolated, Rethrow::Traced].map(maps);
        let worker =
            |maps, delta_e: f64| Worker::new(&whitted, FactorOrder::Free).with_caustics(maps).with_tolerance(delta_e);
        let [mut exact, mut tolerant, mut strict] = [0.0, 1.0, 0.1].map(|delta_e| worker(&interpolated, delta_e));
        for rays in [1, 16] {
            let (mut kept, mut others, mut all, mut off, mut noise) = (0, 0, 0.0, [0.0; 2], [0.0; 2]);
            for pixel in 0..SIDE * SIDE {
                let place = [pixel % SIDE, pixel / SIDE].map(f64::from);
                let [(blue, errors)] = seen(&mut exact, place, rays, [BLUE]);
                let [(whole, _)] = seen(&mut exact, place, rays, [WHOLE]);
                let [(own_whole, no_errors), (own, own_errors)] = seen(&mut tolerant, place, rays, [WHOLE, BLUE]);
                let [_, (near, _)] = seen(&mut strict, place, rays, [WHOLE, BLUE]);
                // The whole is asked for again in parts, whose errors count.
                assert!(no_errors.is_empty() && exact.places.is_empty());
                // What hardly counts may take what another path found.
                let slack = 0.01 * sum(&whole);
                for (leaves, _) in whole.iter().chain(&own_whole).filter(|_| rays == 1) {
                    let [a, b] = [&whole, &own_whole].map(|all| of_product(all, leaves));
                    assert!((a - b).abs() <= slack, "{leaves:?}: {a} {b} of {whole:?}");
                }
                kept += tolerant.places.len();
                others += usize::from(blue != own);
                all += sum(&blue);
                off = [off[0] + (sum(&own) - sum(&blue)).abs(), off[1] + (sum(&near) - sum(&blue)).abs()];
                noise = [noise[0] + sum(&errors), noise[1] + sum(&own_errors)];
            }
            assert!(kept > 50 && others > 20 && noise[0] > 0.0, "{kept} {others} {noise:?}");
            // 1 ΔE*ab is 2 or 3 % of a grey's luminance.
            let off = off.map(|off| off / all);
            assert!(off[0] <= 0.004 && off[1] <= 6e-4, "{rays}: {off:?}");
            assert!((noise[1] / noise[0] - 1.0).abs() <= 0.1, "{rays}: {noise:?}");
        }
        let [mut exact, mut tolerant] = [0.0, 1.0].map(|delta_e| worker(&traced, delta_e));
        for pixel in (0..SIDE * SIDE).step_by(7) {
            let place = [pixel % SIDE, pixel / SIDE].map(f64::from);
            let bands = [&mut exact, &mut tolerant].map(|worker| seen(worker, place, 1, [WHOLE, BLUE]));
            assert!(bands[0][0].0 == bands[1][0].0 && bands[0][1].0 == bands[1][1].0 && tolerant.places.is_empty());
        }
    }

    /// Places are on one plane of one side of one shape.
    #[test]
    fn places_are_on_one_plane() {
        let hit = Hit {
            t: 1.0,
            primitive: 3,
            shape: 2,
            position: Vec3A::new(0.5, 0.25, 0.0),
            error: 1e-6,
            geometric_normal: Vec3A::Z,
            shading_normal: Vec3A::Z,
            uv: [0.0; 2],
            front: true,
            planar: true,
        };
        let place = |hit: Hit| {
            let (light, noise) = (Radiance::default(), Radiance::default());
            Place { hit, least: 0.1, light, curve: None, noise }
        };
        let at = |x: f32, z: f32| Hit { position: Vec3A::new(x, 0.25, z), primitive: 4, ..hit };
        let own = place(hit);
        assert_eq!(own.distance(&at(0.5, 0.0)), Some(0.0));
        assert_eq!(own.distance(&at(0.75, 0.0)), Some(0.25));
        let others = [
            at(0.5, 1e-4),
            Hit { shape: 1, ..hit },
            Hit { front: false, ..hit },
            Hit { planar: false, ..hit },
            Hit { shading_normal: Vec3A::X, ..hit },
            Hit { geometric_normal: -Vec3A::Z, ..hit },
            Hit { position: Vec3A::NAN, ..hit },
        ];
        assert!(others.iter().all(|other| own.distance(other).is_none()));
        assert_eq!(place(Hit { planar: false, ..hit }).distance(&hit), None);
    }
}
