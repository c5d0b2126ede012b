//! Light that reaches surfaces by way of mirrors and glass, from whatever finds it.

use alloc::sync::Arc;

use glam::DVec3;
use spectral_core::brdf::Schlick;

use super::schlick::schlick_terms;
use super::{Later, Path, Worker, receiver};
use crate::direct::{Part, Receiver};
use crate::frame::Frame;
use crate::geometry::Hit;
use crate::material::{Glossy, Lobe, Material};
use crate::photon::{Estimate, Near, Spectra};
use crate::spectral::{Band, Deferred, Factor, Monomial, Radiance};

/// Light that reaches surfaces by way of mirrors and glass: paths L S⁺ D.
pub(crate) trait Caustics: Sync {
    /// Finds the light that reaches a place on a surface: on the side that was hit, by ways that are the same for all waves if there is no
    /// band, or by those that are not, for the waves of a band, within the reach for that place. Light within `least` of the place counts alike,
    /// as far as that matters. What is found is added to `found`; returned are the products of spectra that it refers to.
    fn arriving(&self, hit: &Hit, least: f32, band: Option<(Band, Reach)>, found: &mut Arrived) -> Arc<Spectra>;

    /// From how far light counts for a place that reaches it by ways that depend on the wavelength; `None` if none does.
    /// What may be used again for bands is left in `found`.
    fn reach(&self, hit: &Hit, least: f32, found: &mut Arrived) -> Option<Reach>;
}

/// From how far light counts for a place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Reach {
    /// In scene units.
    pub(crate) radius: f32,
    /// The bias that comes of it, relative to the light.
    pub(crate) bias: f64,
    /// How far photons move at most from where they were found, in scene units, if all that may count are known.
    pub(crate) farthest: Option<f32>,
    /// Whether none moves so far that it matters.
    pub(crate) is_still: bool,
}

/// What was found at a place, with memory to find it.
#[derive(Debug, Default)]
pub(crate) struct Arrived {
    pub(crate) list: Vec<Arriving>,
    pub(crate) scratch: Estimate,
    /// Photons that may count at some wavelength, by their numbers.
    pub(crate) candidates: Vec<u32>,
    pub(crate) near: Vec<Near>,
    pub(crate) distances: Vec<f32>,
    /// Where candidates are, and their fluxes.
    pub(crate) moved: Vec<(Near, f32)>,
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
#[derive(Clone, Debug)]
pub(super) struct Dispersed {
    hit: Hit,
    /// The direction in which the surface is looked at.
    direction: DVec3,
    path: Path,
    reach: Reach,
    candidates: Arc<[u32]>,
}

/// The same where no photon moves: what the surface reflects at two wavelengths, between which it changes in proportion to 1/λ².
#[derive(Clone, Debug)]
pub(super) struct Still {
    ends: [Radiance; 2],
}

/// These wavelengths, in nm.
const ENDS: [f64; 2] = [450.0, 620.0];

impl Still {
    /// The light at a wavelength in nm.
    pub(super) fn at(&self, wavelength: f64) -> Radiance {
        let [first, last, own] = [ENDS[0], ENDS[1], wavelength].map(|w| 1.0 / (w * w));
        let share = (own - last) / (first - last);
        let mut light = Radiance::default();
        for (end, share) in self.ends.iter().zip([share, 1.0 - share]) {
            for (monomial, weight) in end.terms() {
                light.add(*monomial, share * weight);
            }
        }
        light
    }
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
        self
    }

    /// The standard errors of the pixel's light by way of mirrors and glass, by products of spectra; they are forgotten.
    pub(crate) fn take_noise(&mut self) -> Radiance {
        core::mem::take(&mut self.noise)
    }

    /// Adds what a surface reflects of light that comes by way of mirrors and glass; what depends on the wavelength is deferred.
    pub(super) fn caustic(&mut self, hit: &Hit, direction: DVec3, path: Path, radiance: &mut Radiance) {
        let Some(caustics) = self.caustics else { return };
        let noise = self.noise_share(path.band);
        self.arriving(hit, direction, (path, noise), None, radiance);
        let least = self.least(path);
        let Some(reach) = caustics.reach(hit, least, &mut self.arriving) else { return };
        if let Some(band) = path.band {
            self.arriving(hit, direction, (path, noise), Some((band, reach)), radiance);
            return;
        }
        let later = if reach.is_still {
            Later::Still(self.still(hit, direction, path, reach))
        } else {
            let candidates = self.arriving.candidates.as_slice().into();
            Later::Dispersed(Dispersed { hit: *hit, direction, path, reach, candidates })
        };
        let number = u32::try_from(self.deferred.len()).unwrap_or(u32::MAX);
        self.deferred.push(later);
        radiance.defer(Deferred(number), path.monomial, 1.0);
    }

    /// The light of a place whose photons have just been found.
    fn still(&mut self, hit: &Hit, direction: DVec3, path: Path, reach: Reach) -> Still {
        let unit = Path { monomial: Monomial::default(), ..path };
        let ends = ENDS.map(|wavelength| {
            let mut light = Radiance::default();
            // The errors of both are those of the same photons.
            self.arriving(hit, direction, (unit, 0.5), Some((Band::single(wavelength), reach)), &mut light);
            light
        });
        Still { ends }
    }

    /// Half of a pixel's width where a path is, if nothing magnifies: smaller details are not asked for.
    #[allow(clippy::cast_possible_truncation, reason = "a radius")]
    fn least(&self, path: Path) -> f32 {
        (0.5 * self.scene.pixel_angle * path.length) as f32
    }

    /// The light of a place for a band.
    pub(super) fn dispersed(&mut self, place: &Dispersed, band: Band) -> Radiance {
        let mut light = Radiance::default();
        let path = Path { monomial: Monomial::default(), ..place.path };
        let noise = self.noise_share(Some(band));
        self.arriving.candidates.clear();
        self.arriving.candidates.extend_from_slice(&place.candidates);
        self.arriving(&place.hit, place.direction, (path, noise), Some((band, place.reach)), &mut light);
        light
    }

    /// Adds what a surface reflects of the light that reaches it for some waves; this share of its errors is counted.
    fn arriving(
        &mut self,
        hit: &Hit,
        direction: DVec3,
        (path, noise): (Path, f64),
        band: Option<(Band, Reach)>,
        radiance: &mut Radiance,
    ) {
        let Some(caustics) = self.caustics else { return };
        let mut found = core::mem::take(&mut self.arriving);
        found.list.clear();
        let spectra = caustics.arriving(hit, self.least(path), band, &mut found);
        if let (false, Some(response)) = (found.list.is_empty(), self.response(hit, direction)) {
            self.reflected((&found.list, &spectra), &response, (path, noise), radiance);
        }
        self.arriving = found;
    }

    /// The part of a band's errors that counts: light that was asked for in some bands is asked for again in others.
    fn noise_share(&mut self, band: Option<Band>) -> f64 {
        let share = match band {
            None => return 1.0,
            Some(band) if band.share() == 0.0 => 1.0,
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
