//! Light of places where a pixel's paths have come for all waves, taken for some of these at places nearby.
//!
//! What is seen through glass is followed at a few wavelengths. Those of a path that hardly counts, or that hardly part, end at about the same place:
//! what surfaces reflect is found there once, and the boundaries' shares and the colour of what depends on the wavelength are each wave's own.

use alloc::sync::Arc;

use glam::DVec3;

use super::caustic::Curve;
use super::{Path, Worker};
use crate::geometry::Hit;
use crate::spectral::{Factor, Monomial, Radiance};

/// Within this part of half a pixel's width light is alike for each ΔE*ab that is tolerated, for a path that is all that its pixel sees; for one that
/// counts for less, within as much more, up to the other number.
const ALIKE: f64 = 0.05;
const FARTHEST: f64 = 16.0;

/// What a diffuse surface reflects at a place, of paths that all waves take there.
#[derive(Clone, Debug)]
pub(super) struct Place {
    hit: Hit,
    light: Radiance,
    /// Light whose way there depends on the wavelength.
    curve: Option<Arc<Curve>>,
    /// The standard errors of what photons have of both.
    noise: Radiance,
}

impl Place {
    /// Whether a hit is on the same plane of the same shape, and not farther than a distance in scene units.
    fn is_near(&self, hit: &Hit, distance: f64) -> bool {
        let (own, way) = (&self.hit, (hit.position - self.hit.position).as_dvec3());
        let is_same = own.shape == hit.shape
            && own.front == hit.front
            && own.planar
            && hit.planar
            && own.geometric_normal == hit.geometric_normal
            && own.shading_normal == hit.shading_normal;
        let height = way.dot(hit.geometric_normal.as_dvec3()).abs();
        is_same && way.length() <= distance && height <= 4.0 * f64::from(own.error + hit.error)
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
        let Some(band) = path.band.filter(|_| self.tolerance > 0.0 && !self.is_preparing && hit.planar) else {
            return false;
        };
        let distance = (ALIKE * self.tolerance / path.weight.abs()).min(FARTHEST) * f64::from(self.least(path));
        let number = match self.places.iter().position(|place| place.is_near(hit, distance)) {
            Some(number) => number,
            None if band.is_whole() => {
                let Some(place) = self.place((hit, direction), path, reflectance) else { return false };
                self.places.push(place);
                self.places.len() - 1
            }
            None => return false,
        };
        let Some(Place { light, curve, noise, .. }) = self.places.get(number).cloned() else { return false };
        self.add_product(&light, path, radiance);
        if let Some(curve) = curve {
            let light = curve.over(band, &mut self.band_parts);
            self.add_product(&light, path, radiance);
        }
        let share = path.weight * self.noise_share(path.band);
        for (monomial, error) in noise.terms() {
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
        Some(Place { hit: *hit, light, curve: curve?, noise })
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3A;

    use super::Place;
    use crate::geometry::Hit;
    use crate::photon::{Bundle, Density, Emission, Maps, Rethrow, Settings};
    use crate::scene::builtin;
    use crate::spectral::{Band, FactorOrder, Palette, Radiance, Tracer};
    use crate::whitted::{Whitted, Worker};

    const SIDE: u32 = 24;
    const WHOLE: Band = Band { wavelength: 560.0, limits: [380.0, 780.0] };
    const BLUE: Band = Band { wavelength: 480.0, limits: [380.0, 580.0] };

    /// Products by their leaves, in order.
    fn terms(worker: &Worker<'_>, light: &Radiance) -> Vec<(Vec<u32>, f64)> {
        let term = |(monomial, weight): &(_, f64)| (worker.monomials.leaves(*monomial).to_vec(), *weight);
        let mut terms: Vec<_> = light.terms().iter().map(term).collect();
        terms.sort_by(|a, b| a.0.cmp(&b.0));
        terms
    }

    fn assert_alike(a: &[(Vec<u32>, f64)], b: &[(Vec<u32>, f64)], tolerance: f64) {
        assert_eq!(a.len(), b.len(), "{a:?} {b:?}");
        for ((of_a, a), (of_b, b)) in a.iter().zip(b) {
            assert!(of_a == of_b && (a - b).abs() <= tolerance * a.abs().max(b.abs()), "{of_a:?} {of_b:?}: {a} {b}");
        }
    }

    /// What is kept for all waves is what is found for them without keeping it, with photons and their errors; some waves take it as far as that is
    /// tolerated.
    #[test]
    fn what_is_kept_is_what_is_found() {
        let scene = builtin::load("cornell-box-spheres", &[]).unwrap();
        let mut palette = Palette::default();
        let whitted = Whitted::new(&scene, [SIDE, SIDE], &mut palette).unwrap();
        let emission = Emission::new(&scene, &whitted, &palette, Settings::default());
        let emitted = emission.emit(20_000, 0, &|_| {});
        let density = Density { count: 50, ..Density::default() };
        let maps = Maps::new(
            (&scene, &whitted),
            &emission,
            emitted,
            (density, 1.0),
            (Bundle::Continuous, Rethrow::Interpolated),
        );
        let worker =
            |delta_e: f64| Worker::new(&whitted, FactorOrder::Free).with_caustics(&maps).with_tolerance(delta_e);
        let [mut exact, mut tolerant, mut strict] = [0.0, 1.0, 0.1].map(worker);
        let (mut kept, mut lit, mut others, mut all, mut off) = (0, 0, 0, 0.0, [0.0; 2]);
        for pixel in 0..SIDE * SIDE {
            let [x, y] = [pixel % SIDE, pixel / SIDE].map(|i| f64::from(i) + 0.5);
            let found = [&mut exact, &mut tolerant, &mut strict].map(|worker| {
                let mut light = Radiance::default();
                worker.start_pixel(crate::geometry::sampling::SobolSequence::new(0));
                worker.sample(x, y, 1.0, &mut light);
                worker.take_noise();
                let mut of_band = |band: Band| {
                    let mut sum = Radiance::default();
                    for (deferred, _, weight) in light.deferred() {
                        // Light of photons at places that are seen at once is no path of waves.
                        if !worker.lines(*deferred, Default::default(), &[1, 2, 4, 8, 16, 32, 64, 128], &mut |_, _| {})
                        {
                            let traced = worker.trace(*deferred, band);
                            traced.terms().iter().for_each(|(monomial, own)| sum.add(*monomial, weight * own));
                        }
                    }
                    let noise = worker.take_noise();
                    (terms(worker, &sum), terms(worker, &noise))
                };
                [of_band(WHOLE), of_band(BLUE)]
            });
            let [[whole, blue], [own_whole, own_blue], [_, strict_blue]] = found;
            assert_alike(&whole.0, &own_whole.0, 1e-12);
            assert_alike(&whole.1, &own_whole.1, 1e-9);
            kept += tolerant.places.len();
            lit += usize::from(!whole.1.is_empty());
            others += usize::from(blue.0 != own_blue.0);
            let sum = |terms: &[(Vec<u32>, f64)]| terms.iter().map(|(_, weight)| weight).sum::<f64>();
            all += sum(&blue.0);
            let far = |own: &[_]| (sum(own) - sum(&blue.0)).abs();
            off = [off[0] + far(&own_blue.0), off[1] + far(&strict_blue.0)];
            assert!(exact.places.is_empty());
        }
        assert!(kept > 100 && lit > 20 && others > 20, "{kept} {lit} {others}");
        // 1 ΔE*ab is 2 or 3 % of a grey's luminance.
        let off = off.map(|off| off / all);
        assert!(off[0] <= 0.01 && off[1] <= 0.001, "{off:?}");
    }

    /// Places are on one plane of one side of one shape, and as near as asked for.
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
        let place = |hit: Hit| Place { hit, light: Radiance::default(), curve: None, noise: Radiance::default() };
        let at = |x: f32, z: f32| Hit { position: Vec3A::new(x, 0.25, z), primitive: 4, ..hit };
        let own = place(hit);
        assert!(own.is_near(&at(0.5, 0.0), 0.0) && own.is_near(&at(0.75, 0.0), 0.25));
        assert!(!own.is_near(&at(0.75, 0.0), 0.249) && !own.is_near(&at(0.5, 1e-4), 0.25));
        let others = [
            Hit { shape: 1, ..hit },
            Hit { front: false, ..hit },
            Hit { planar: false, ..hit },
            Hit { shading_normal: Vec3A::X, ..hit },
            Hit { geometric_normal: -Vec3A::Z, ..hit },
            Hit { position: Vec3A::NAN, ..hit },
        ];
        assert!(others.iter().all(|other| !own.is_near(other, 1.0)));
        assert!(!place(Hit { planar: false, ..hit }).is_near(&hit, 1.0));
        assert!(!own.is_near(&hit, f64::NAN));
    }
}
