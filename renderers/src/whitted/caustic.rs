//! Light that reaches surfaces by way of mirrors and glass, from whatever finds it.

use alloc::sync::Arc;

use glam::DVec3;
use spectral_core::brdf::Schlick;

use super::curve::{Curve, nodes_of};
use super::schlick::schlick_terms;
use super::{Later, Path, Worker, receiver};
use crate::direct::{Part, Receiver};
use crate::frame::Frame;
use crate::geometry::Hit;
use crate::material::{Glossy, Lobe, Material};
use crate::photon::{Estimate, Passed, Spectra};
use crate::spectral::{Band, Deferred, Factor, Monomial, Radiance};

/// Light whose way depends on the wavelength may be taken as white where the standard deviation between its thirds (of all waves, by the eye's
/// sensitivity) is no more than this part of the illuminance by lights and other surfaces, for each ΔE*ab that is tolerated. X alone off by a
/// hundredth is 1.7 ΔE*ab, Y alone 0.4 in lightness, Z alone 0.7; what is measured is in `MEASURED.md`.
const SLIGHT: f64 = 0.01;

/// Light that reaches surfaces by way of mirrors and glass: paths L S⁺ D.
pub(crate) trait Caustics: Sync {
    /// Finds the light that reaches a place on a surface: on the side that was hit, by ways that are the same for all waves if no band is asked
    /// for, or by those that are not, for the waves of a band. Light within `least` of the place counts alike, as far as that matters. What is found
    /// is added to `found`; returned are the products of spectra that it refers to.
    fn arriving(&self, hit: &Hit, least: f32, band: Option<Band>, found: &mut Arrived) -> Arc<Spectra>;

    /// Whether light whose ways depend on the wavelength must be asked for by bands, wherever there is any.
    fn is_by_bands(&self) -> bool;

    /// Whether there is light whose way depends on the wavelength.
    fn is_dispersed(&self) -> bool;

    /// Finds the light that reaches a place by ways that depend on the wavelength: at all wavelengths, or at those that it takes for a band. What was
    /// found of any light before is forgotten.
    fn dispersed(&self, hit: &Hit, how: How, band: Option<Band>, found: &mut Arrived) -> Dispersion;

    /// The luminance of a spectrum, relative to that of a flat one of 1.
    fn luminance(&self, spectrum: Factor) -> f64;
}

/// How light whose way depends on the wavelength is looked for.
#[derive(Clone, Copy, Debug)]
pub(crate) struct How {
    /// Light within this distance of the place counts alike, in scene units.
    pub(crate) least: f32,
    /// Whether light from all directions counts alike.
    pub(crate) alike: bool,
    /// The light's mean over all waves does for each of them where the standard deviation between their thirds is no more than this illuminance, relative
    /// to that of a flat spectrum of 1.
    pub(crate) slight: f64,
}

/// What is known of light whose way to a place depends on the wavelength.
pub(crate) enum Dispersion {
    /// That there is none.
    None,
    /// How it changes, and the products of spectra that it refers to.
    Known(Arc<Spectra>),
    /// That it is slight: its mean over all waves was found, as light that is the same for all of them is, and refers to these products of spectra.
    /// How uneven it is, is among its errors.
    Slight(Arc<Spectra>),
    /// That it must be asked for by bands.
    ByBands,
}

/// What was found at a place, with memory to find it.
#[derive(Debug, Default)]
pub(crate) struct Arrived {
    pub(crate) list: Vec<Arriving>,
    pub(crate) scratch: Estimate,
    /// Light that passes the place as the wavelength changes.
    pub(crate) passed: Passed,
}

/// Light that reaches a surface from one direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Arriving {
    /// The unit vector to where it comes from.
    pub(crate) direction: DVec3,
    /// Its irradiance for a spectrum of 1.
    pub(crate) irradiance: f64,
    /// Its part of the standard error: the squares of the parts of all that was found together add up to that of the sum.
    pub(crate) error: f64,
    /// The product of spectra that it is multiplied by.
    pub(crate) spectrum: u32,
}

/// Light at a surface whose way there depends on the wavelength.
#[derive(Clone, Copy, Debug)]
pub(super) struct Dispersed {
    hit: Hit,
    /// The direction in which the surface is looked at.
    direction: DVec3,
    path: Path,
}

/// Sums of light at a wavelength, of each of a surface's two spectra, and the squares of its parts.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Node {
    sums: [f64; 2],
    squares: [f64; 2],
}

/// What a surface makes of light from a direction: a sum of two spectra, each times a BRDF in 1/sr.
enum Response<'m> {
    Diffuse(Factor),
    Layered { frame: Frame, view: [f64; 3], base: Option<Factor>, lobe: Glossy<'m>, specular: Factor },
    Schlick { model: Schlick<f64>, receiver: Receiver, view: DVec3, tangent: DVec3, reflectance: Factor },
}

impl Response<'_> {
    /// The factors of the two spectra; `None` for a spectrum of 1.
    const fn factors(&self) -> [Option<Factor>; 2] {
        match self {
            Self::Diffuse(factor) => [Some(*factor), None],
            Self::Layered { base, specular, .. } => [*base, Some(*specular)],
            Self::Schlick { reflectance, .. } => [Some(*reflectance), None],
        }
    }

    /// The BRDF for light from a direction.
    fn towards(&self, direction: DVec3) -> [f64; 2] {
        let lambert = core::f64::consts::FRAC_1_PI;
        match self {
            Self::Diffuse(_) => [lambert, 0.0],
            Self::Layered { frame, view, base, lobe, .. } => {
                let light = frame.to_local(direction);
                let glossy = if light[2] > 0.0 { lobe.evaluate(light, *view) } else { 0.0 };
                [if base.is_some() { lambert } else { 0.0 }, glossy]
            }
            Self::Schlick { model, receiver, view, tangent, .. } => {
                let part = Part { direction, irradiance: 1.0 };
                let (geometric, fresnel) = schlick_terms(model, receiver, *view, *tangent, &part);
                [geometric * (1.0 - fresnel), geometric * fresnel]
            }
        }
    }
}

impl<'s> Worker<'s> {
    /// The same with light by way of mirrors and glass on surfaces.
    #[must_use]
    pub(crate) fn with_caustics(mut self, caustics: &'s dyn Caustics) -> Self {
        self.caustics = Some(caustics);
        self.is_dispersed = caustics.is_dispersed();
        self
    }

    /// The standard errors of the pixel's light by way of mirrors and glass, by products of spectra; they are forgotten.
    pub(crate) fn take_noise(&mut self) -> Radiance {
        core::mem::take(&mut self.noise)
    }

    /// Adds what a surface reflects of light that comes by way of mirrors and glass; what depends on the wavelength is deferred.
    pub(super) fn caustic(&mut self, hit: &Hit, direction: DVec3, path: Path, radiance: &mut Radiance) {
        // Light between surfaces alone is wanted where nothing is kept.
        if self.is_preparing && path.band.is_some() {
            return;
        }
        let Some(curve) = self.caustic_for_all((hit, direction), path, radiance) else {
            return self.by_bands(Dispersed { hit: *hit, direction, path }, radiance);
        };
        match (curve, path.band) {
            (None, _) => {}
            (Some(curve), Some(band)) => {
                let light = curve.over(band, &mut self.band_parts);
                self.add_product(&light, Path { weight: 1.0, ..path }, radiance);
            }
            (Some(curve), None) => {
                let number = u32::try_from(self.deferred.len()).unwrap_or(u32::MAX);
                self.deferred.push(Later::Curve(curve));
                radiance.defer(Deferred(number), path.monomial, 1.0);
            }
        }
    }

    /// Adds what a surface reflects of such light that is the same for all waves, and finds the rest: `None` if that must be asked for by bands.
    pub(super) fn caustic_for_all(
        &mut self,
        (hit, direction): (&Hit, DVec3),
        path: Path,
        radiance: &mut Radiance,
    ) -> Option<Option<Arc<Curve>>> {
        let Some(caustics) = self.caustics else { return Some(None) };
        let noise = self.noise_share(path.band);
        self.arriving(hit, direction, (path, noise), None, radiance);
        let alike = matches!(self.scene.material(hit), Some(Material::Diffuse(_)));
        let slight = if alike { SLIGHT * self.tolerance * self.illuminance } else { 0.0 };
        let how = How { least: self.least(path), alike, slight };
        let spectra = match caustics.dispersed(hit, how, path.band, &mut self.arriving) {
            Dispersion::None => return Some(None),
            Dispersion::Slight(spectra) => {
                self.reflect_found(hit, direction, (path, noise), &spectra, radiance);
                return Some(None);
            }
            Dispersion::Known(spectra) => spectra,
            Dispersion::ByBands => return None,
        };
        if self.arriving.passed.list.is_empty() {
            return Some(None);
        }
        let curve = self.curve(&Dispersed { hit: *hit, direction, path }, &spectra, noise);
        Some((!curve.monomials.is_empty()).then(|| Arc::new(curve)))
    }

    /// Adds the light of a place that must be asked for by bands.
    fn by_bands(&mut self, place: Dispersed, radiance: &mut Radiance) {
        let path = place.path;
        if let Some(band) = path.band {
            let light = self.dispersed(&place, band);
            return self.add_product(&light, Path { weight: 1.0, ..path }, radiance);
        }
        let number = u32::try_from(self.deferred.len()).unwrap_or(u32::MAX);
        self.deferred.push(Later::Dispersed(Arc::new(place)));
        radiance.defer(Deferred(number), path.monomial, 1.0);
    }

    /// The light of a place whose passing photons have just been found; a share of its errors is counted.
    fn curve(&mut self, place: &Dispersed, spectra: &Spectra, share: f64) -> Curve {
        let Dispersed { hit, direction, path } = *place;
        let passed = &self.arriving.passed;
        let mut curve = Curve { steps: passed.steps, ..Curve::default() };
        let Some(response) = self.response(&hit, direction) else { return curve };
        let nodes = usize::from(curve.steps) + 1;
        let asked = path.band.map_or([0, curve.steps + 1], |band| nodes_of(band, curve.steps));
        self.numbers.clear();
        self.nodes.clear();
        for passing in &passed.list {
            let slot = self.numbers.iter().position(|known| *known == passing.spectrum).unwrap_or_else(|| {
                self.numbers.push(passing.spectrum);
                self.nodes.resize(self.numbers.len() * nodes, Node::default());
                self.numbers.len() - 1
            });
            let shares = response.towards(passing.direction).map(|share| share * passed.share);
            for number in asked[0]..asked[1] {
                let Some(node) = self.nodes.get_mut(slot * nodes + usize::from(number)) else { continue };
                let light = passing.at(&passed.irradiances, number, curve.steps);
                let squares = passing.at(&passed.squares, number, curve.steps);
                for ((sum, square), share) in node.sums.iter_mut().zip(&mut node.squares).zip(shares) {
                    *sum += share * light;
                    *square += share * share * squares;
                }
            }
        }
        let unit = Path { monomial: Monomial::default(), ..path };
        // As if all wavelengths had the same photons: where these are fast, that is more than the error.
        let share = share * self.arriving.passed.error / f64::from(asked[1] - asked[0]);
        for slot in 0..self.numbers.len() {
            let spectrum = self.numbers[slot];
            for (which, factor) in response.factors().into_iter().enumerate() {
                let sums = slot * nodes..(slot + 1) * nodes;
                if self.nodes[sums.clone()].iter().all(|node| node.sums[which] == 0.0) {
                    continue;
                }
                let through = factor.map_or(unit, |factor| self.times(unit, factor));
                let leaves = spectra.leaves(spectrum).iter();
                let monomial = leaves.fold(through.monomial, |m, leaf| self.monomials.times_leaf(m, *leaf));
                curve.monomials.push(monomial);
                curve.weights.extend(self.nodes[sums.clone()].iter().map(|node| through.weight * node.sums[which]));
                let error: f64 = self.nodes[sums].iter().map(|node| node.squares[which].sqrt()).sum();
                self.noise.add(self.monomials.product(path.monomial, monomial), share * through.weight * error);
            }
        }
        curve
    }

    /// Half of a pixel's width where a path is, if nothing magnifies: smaller details are not asked for.
    #[allow(clippy::cast_possible_truncation, reason = "a radius")]
    pub(super) fn least(&self, path: Path) -> f32 {
        (0.5 * self.scene.pixel_angle * path.length) as f32
    }

    /// The light of a place for a band.
    pub(super) fn dispersed(&mut self, place: &Dispersed, band: Band) -> Radiance {
        let mut light = Radiance::default();
        let path = Path { monomial: Monomial::default(), ..place.path };
        let noise = self.noise_share(Some(band));
        self.arriving(&place.hit, place.direction, (path, noise), Some(band), &mut light);
        light
    }

    /// Adds what a surface reflects of the light that reaches it for some waves; this share of its errors is counted.
    fn arriving(
        &mut self,
        hit: &Hit,
        direction: DVec3,
        (path, noise): (Path, f64),
        band: Option<Band>,
        radiance: &mut Radiance,
    ) {
        let Some(caustics) = self.caustics else { return };
        self.arriving.list.clear();
        let spectra = caustics.arriving(hit, self.least(path), band, &mut self.arriving);
        self.reflect_found(hit, direction, (path, noise), &spectra, radiance);
    }

    /// Adds what a surface reflects of the light that was found there.
    fn reflect_found(
        &mut self,
        hit: &Hit,
        direction: DVec3,
        (path, noise): (Path, f64),
        spectra: &Spectra,
        radiance: &mut Radiance,
    ) {
        let found = core::mem::take(&mut self.arriving);
        if let (false, Some(response)) = (found.list.is_empty(), self.response(hit, direction)) {
            self.reflected((&found.list, spectra), &response, (path, noise), radiance);
        }
        self.arriving = found;
    }

    /// The part of a band's errors that counts: light that was asked for in some bands is asked for again in others.
    pub(super) fn noise_share(&mut self, band: Option<Band>) -> f64 {
        let share = match band {
            None => return 1.0,
            Some(band) if band.share() == 0.0 => 1.0,
            // The whole is asked for again in parts.
            Some(band) if band.is_whole() && self.tolerance > 0.0 => return 0.0,
            Some(band) => band.share(),
        };
        // Equal bands may differ by rounding.
        let counted = *self.noise_counted.get_or_insert(share);
        if (share - counted).abs() <= 0.01 * counted { share } else { 0.0 }
    }

    fn reflected(
        &mut self,
        (found, spectra): (&[Arriving], &Spectra),
        response: &Response<'_>,
        (path, noise): (Path, f64),
        radiance: &mut Radiance,
    ) {
        self.sums.clear();
        for Arriving { direction, irradiance, error, spectrum } in found {
            let shares = response.towards(*direction);
            let place = self.sums.iter().position(|(known, ..)| known == spectrum).unwrap_or_else(|| {
                self.sums.push((*spectrum, [0.0; 2], [0.0; 2]));
                self.sums.len() - 1
            });
            let (_, sums, errors) = &mut self.sums[place];
            for (share, (sum, squares)) in shares.iter().zip(sums.iter_mut().zip(errors)) {
                *sum += share * irradiance;
                *squares += (share * error) * (share * error);
            }
        }
        for number in 0..self.sums.len() {
            let (spectrum, sums, squares) = self.sums[number];
            for ((factor, sum), squares) in response.factors().into_iter().zip(sums).zip(squares) {
                if sum == 0.0 {
                    continue;
                }
                let through = factor.map_or(path, |factor| self.times(path, factor));
                let leaves = spectra.leaves(spectrum).iter();
                let monomial = leaves.fold(through.monomial, |m, leaf| self.monomials.times_leaf(m, *leaf));
                radiance.add(monomial, through.weight * sum);
                self.noise.add(monomial, noise * through.weight * squares.sqrt());
            }
        }
    }

    /// What the surface that was hit makes of light; `None` if it scatters none.
    fn response(&self, hit: &Hit, direction: DVec3) -> Option<Response<'s>> {
        let scene = self.scene;
        let material = scene.material(hit)?;
        if let Material::Schlick { reflectance, roughness, isotropy } = material {
            let model = Schlick::new(*roughness, *isotropy).ok()?;
            let receiver = receiver(hit);
            let (tangent, _) = receiver.normal.any_orthonormal_pair();
            return Some(Response::Schlick { model, receiver, view: -direction, tangent, reflectance: *reflectance });
        }
        match material.lobes() {
            [Some((factor, Lobe::Lambert)), None] => Some(Response::Diffuse(factor)),
            [base, Some((specular, Lobe::Glossy(lobe)))] => {
                let frame = scene.frame(hit)?;
                let view = frame.to_local(-direction);
                let base = base.map(|(factor, _)| factor);
                (view[2] > 0.0).then_some(Response::Layered { frame, view, base, lobe, specular })
            }
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::geometry::Hit;
    use crate::geometry::sampling::SobolSequence;
    use crate::photon::{Bundle, Density, Emission, Maps, Rethrow, Settings};
    use crate::scene::builtin;
    use crate::spectral::{Band, Factor, FactorOrder, Palette, Radiance, Tracer};
    use crate::whitted::{Indirect, Later, Whitted, Worker};

    /// Light that hardly counts is white, the more of it the more is tolerated: what is seen in blue and in red differs by as little.
    #[test]
    fn slight_light_is_taken_as_white() {
        const SIDE: u16 = 24;
        let scene = builtin::load("cornell-box-spheres", &[]).unwrap();
        let mut palette = Palette::default();
        let whitted = Whitted::new(&scene, [u32::from(SIDE); 2], &mut palette).unwrap();
        let emission = Emission::new(&scene, &whitted, &palette, Settings::default());
        let how = (Bundle::Continuous, Rethrow::Interpolated);
        let photons: (_, _, &(dyn Fn(u64) + Sync)) = (100_000, 0, &|_| {});
        let maps = Maps::new((&scene, &whitted), &emission, photons, (Density::default(), 1.0), how);
        let bands = [[380.0, 480.0], [600.0, 780.0]];
        let seen = |delta_e: f64| {
            let mut worker = Worker::new(&whitted, FactorOrder::Free).with_caustics(&maps).with_tolerance(delta_e);
            let (mut curves, mut all) = (0, Vec::new());
            for pixel in 0..SIDE * SIDE {
                let [x, y] = [pixel % SIDE, pixel / SIDE].map(|place| f64::from(place) + 0.5);
                let mut light = Radiance::default();
                worker.start_pixel(SobolSequence::new(0));
                worker.sample(x, y, 1.0, &mut light);
                let own = worker.deferred.iter().filter(|later| matches!(later, Later::Curve(_))).count();
                curves += own;
                let even: f64 = light.terms().iter().map(|(_, weight)| weight).sum();
                all.extend(bands.map(|limits| {
                    let band = Band { wavelength: f64::midpoint(limits[0], limits[1]), limits };
                    let of = |(deferred, _, weight): &(_, _, f64)| {
                        weight * worker.trace(*deferred, band).terms().iter().map(|(_, own)| own).sum::<f64>()
                    };
                    even + light.deferred().iter().map(of).sum::<f64>()
                }));
            }
            (curves, all)
        };
        let (most, exact) = seen(0.0);
        let mut before = most;
        for delta_e in [0.1, 1.0] {
            let (curves, light) = seen(delta_e);
            let off = exact.iter().zip(&light).map(|(a, b)| (a - b).abs() / a.max(1e-300));
            let (sum, worst) = off.fold((0.0, 0.0), |(sum, most), x| (sum + x, f64::max(most, x)));
            let mean = sum / (2.0 * f64::from(SIDE) * f64::from(SIDE));
            assert!(
                2 * curves < before && mean <= 1e-3 * delta_e && worst <= 0.03 * delta_e,
                "{delta_e}: {curves} of {most}, {mean} {worst}"
            );
            before = curves;
        }
    }

    /// The same irradiance everywhere, by rows of two numbers.
    struct Everywhere;

    impl Indirect for Everywhere {
        fn width(&self) -> usize {
            2
        }

        fn irradiance(&self, _: &Hit, row: &mut [f64]) {
            row.copy_from_slice(&[2.0, 5.0]);
        }

        fn luminances(&self) -> &[f64] {
            &[0.25, 0.5]
        }
    }

    /// Light is compared with that of all lights, and with light between surfaces or the ambient term in its place; with none where nothing is tolerated.
    #[test]
    fn all_other_light_is_compared() {
        let scene = builtin::load("cornell-box-spheres", &[]).unwrap();
        let mut palette = Palette::default();
        let mut whitted = Whitted::new(&scene, [24; 2], &mut palette).unwrap();
        whitted.ambient = vec![Factor { scale: 0.75, leaf: None }];
        let emission = Emission::new(&scene, &whitted, &palette, Settings::default());
        let how = (Bundle::Continuous, Rethrow::Interpolated);
        let photons: (_, _, &(dyn Fn(u64) + Sync)) = (10_000, 0, &|_| {});
        let maps = Maps::new((&scene, &whitted), &emission, photons, (Density::default(), 1.0), how);
        let worker = || Worker::new(&whitted, FactorOrder::Free).with_caustics(&maps);
        // The middle of the rear wall.
        let found = |mut worker: Worker<'_>| {
            worker.start_pixel(SobolSequence::new(0));
            worker.sample(12.0, 9.0, 1.0, &mut Radiance::default());
            worker.illuminance
        };
        let ambient = found(worker().with_tolerance(1.0));
        let indirect = found(worker().with_tolerance(1.0).with_indirect(&Everywhere));
        let lights = indirect - 3.0;
        assert!(lights > 0.0 && (ambient - lights - 0.75 * core::f64::consts::PI).abs() <= 1e-12 * ambient);
        assert_eq!(found(worker()), 0.0);
    }
}
