//! The meter: a scene made ready for readings.

use core::f64::consts::PI;
use core::fmt;

use glam::DVec3;
use spectral_core::action::MAXIMUM_LUMINOUS_EFFICACY;
use spectral_core::spectrum::Spectrum as _;
use spectral_core::{Observer, tristimulus};

use super::indirect::{IndirectLight, IndirectPart};
use crate::direct::{
    self, Blockers, Estimate, Light, Part, Receiver, Scratch, Surroundings, visible_configuration_factor, visible_sky,
};
use crate::geometry::{MAX_COORDINATE, World};
use crate::scene::{Emitter, Scene};
use crate::spectral::{Factor, Palette, Role};

/// How readings are taken.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// The relative error that is asked for in the direct part of each light, from 10⁻⁵ to 0.5. Closed forms are better; shadow rays stop when
    /// they estimate to have reached it.
    pub accuracy: f64,
}

impl Default for Settings {
    fn default() -> Self {
        Self { accuracy: 1e-3 }
    }
}

/// Why a scene or a point can't be measured: one line.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum MeterError {
    /// The accuracy is not from 10⁻⁵ to 0.5.
    Accuracy(f64),
    /// What the scene asks for and a meter can't do, by the name the scene gives it.
    Scene(String),
    /// A coordinate is infinite, NaN or beyond the largest that scenes have, or a normal has no direction.
    Point,
}

impl fmt::Display for MeterError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Accuracy(accuracy) => write!(f, "the accuracy must be from 1e-5 to 0.5, not {accuracy}"),
            Self::Scene(message) => f.write_str(message),
            Self::Point => write!(f, "a point needs coordinates up to {MAX_COORDINATE:e} and a normal that isn't zero"),
        }
    }
}

impl core::error::Error for MeterError {}

/// What was measured at one point.
#[derive(Clone, Debug, PartialEq)]
pub struct Reading {
    /// Where, scene units.
    pub position: DVec3,
    /// The unit normal.
    pub normal: DVec3,
    /// Illuminance E = 683.002 lm/W ∫E(λ) ȳ dλ, lx; the direct part alone where the indirect one is unknown.
    pub lux: f64,
    /// The part that comes straight from lights, lx.
    pub direct_lux: f64,
    /// The part that comes by way of other surfaces, lx; `None` if the scene asks for it and it was not computed.
    pub indirect_lux: Option<f64>,
    /// The error of `lux` as far as it is known: bounds, and three standard deviations of what shadow rays estimate.
    pub error: f64,
    /// Shadow rays, without those to points and parallel lights.
    pub samples: u64,
    /// The direct irradiance as numbers of the meter's spectra.
    weights: Vec<f64>,
    indirect_spectrum: Option<crate::spectral::Tabulated>,
}

/// A scene made ready for readings, which may be taken by many threads at once.
pub struct Meter<'i> {
    world: World,
    blockers: Blockers,
    lights: Vec<Light>,
    sky: Option<Factor>,
    ambient: Option<Factor>,
    palette: Palette,
    /// Illuminance for an irradiance of 1 times each spectrum, lx.
    efficacies: Vec<f64>,
    indirect: Option<&'i dyn IndirectLight>,
    part: IndirectPart,
    settings: Settings,
}

impl fmt::Debug for Meter<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Meter").field("lights", &self.lights).field("indirect", &self.part).finish_non_exhaustive()
    }
}

impl<'i> Meter<'i> {
    /// Makes a scene ready. Where it asks for light between surfaces, that is what `indirect` says.
    ///
    /// # Errors
    /// [`MeterError`] for an accuracy out of range, lights that shine to the inside of a sphere, or surfaces that can't be traced.
    pub fn new(scene: &Scene, settings: Settings, indirect: Option<&'i dyn IndirectLight>) -> Result<Self, MeterError> {
        if !(1e-5..=0.5).contains(&settings.accuracy) {
            return Err(MeterError::Accuracy(settings.accuracy));
        }
        let world = direct::world(scene).map_err(|error| MeterError::Scene(error.to_string()))?;
        let mut meter = Self {
            world,
            blockers: Blockers::new(scene),
            lights: Vec::new(),
            sky: None,
            ambient: None,
            palette: Palette::default(),
            efficacies: Vec::new(),
            indirect,
            part: IndirectPart::of(scene, indirect),
            settings,
        };
        for emitter in &scene.emitters {
            meter.add(scene, emitter)?;
        }
        let observer = Observer::cie_1931_2deg();
        for (leaf, _) in meter.palette.leaves() {
            let spectrum = leaf.spectrum().map_err(MeterError::Scene)?;
            let [_, y, _] = tristimulus(&observer, &spectrum, 380.0, 780.0);
            meter.efficacies.push(MAXIMUM_LUMINOUS_EFFICACY * y);
        }
        Ok(meter)
    }

    fn add(&mut self, scene: &Scene, emitter: &Emitter) -> Result<(), MeterError> {
        let mut light = |spectrum| self.palette.factor(scene.spectrum(spectrum), Role::Light);
        match emitter {
            Emitter::Area { shape, radiance } => {
                let radiance = light(*radiance);
                let (first, data) = (self.world.primitives(shape.0).start, scene.shapes.get(shape.0));
                let data = data.ok_or_else(|| MeterError::Scene("a light has no shape".to_owned()))?;
                let sources = direct::sources(data, first).ok_or_else(|| {
                    MeterError::Scene(format!(
                        "{}: illuminance of lights on the inside of spheres is not supported",
                        data.label
                    ))
                })?;
                self.lights.extend(sources.into_iter().map(|source| Light::Area { source, radiance }));
            }
            Emitter::Point { position, intensity } => {
                self.lights.push(Light::Point { position: *position, intensity: light(*intensity) });
            }
            Emitter::Directional { direction, irradiance } => {
                self.lights.push(Light::Directional { direction: *direction, irradiance: light(*irradiance) });
            }
            Emitter::Luminaire { luminaire, spectrum, .. } => {
                self.lights.push(Light::Luminaire { luminaire: luminaire.clone(), intensity: light(*spectrum) });
            }
            Emitter::Constant { radiance, .. } => self.sky = Some(light(*radiance)),
            Emitter::Ambient { radiance } => self.ambient = Some(light(*radiance)),
        }
        Ok(())
    }

    /// Where the indirect part of readings comes from.
    #[must_use]
    pub const fn indirect_part(&self) -> &IndirectPart {
        &self.part
    }

    /// The illuminance at a position on the side of a normal of any length but zero.
    ///
    /// # Errors
    /// [`MeterError::Point`].
    pub fn read(&self, position: DVec3, normal: DVec3) -> Result<Reading, MeterError> {
        let largest = normal.abs().max_element();
        let within = position.abs().max_element() <= f64::from(MAX_COORDINATE);
        // Dividing by the largest component first keeps squares in range.
        let unit = (normal / largest).try_normalize();
        let (true, true, Some(normal)) = (within, normal.is_finite(), unit) else { return Err(MeterError::Point) };
        let mut sum = Sum { meter: self, weights: vec![0.0; self.efficacies.len()], error: 0.0, samples: 0 };
        self.gather(&Receiver::new(position, normal, &self.world), &mut sum);
        let direct_lux = sum.weights.iter().zip(&self.efficacies).map(|(weight, efficacy)| weight * efficacy).sum();
        let mut reading = Reading {
            position,
            normal,
            lux: direct_lux,
            direct_lux,
            indirect_lux: Some(0.0),
            error: sum.error,
            samples: sum.samples,
            weights: sum.weights,
            indirect_spectrum: None,
        };
        self.add_indirect(&mut reading);
        Ok(reading)
    }

    /// Adds the light of everything that shines.
    fn gather(&self, receiver: &Receiver, sum: &mut Sum<'_, '_>) {
        let around = Surroundings { world: &self.world, blockers: &self.blockers };
        let mut scratch = Scratch::default();
        let accuracy = self.settings.accuracy;
        for light in &self.lights {
            if let Light::Area { source, radiance } = light {
                let found = visible_configuration_factor(source, around, receiver, accuracy, &mut scratch);
                sum.add_area(*radiance, &found);
            } else {
                let nobody_knows = || direct::Cover::Unknown;
                light.illuminate(around, receiver, 0, nobody_knows, &mut scratch, |Part { irradiance, .. }| {
                    sum.add(light.factor(), irradiance);
                });
            }
        }
        if let Some(radiance) = self.sky {
            sum.add_area(radiance, &visible_sky(around, receiver, accuracy, &mut scratch));
        }
    }

    fn add_indirect(&self, reading: &mut Reading) {
        match (&self.part, self.indirect, self.ambient) {
            (IndirectPart::NotComputed, ..) => reading.indirect_lux = None,
            (IndirectPart::Computed(_), Some(light), _) => {
                let found = light.irradiance(reading.position, reading.normal);
                reading.indirect_lux = Some(found.lux);
                reading.lux += found.lux;
                reading.error += found.error;
                reading.indirect_spectrum = found.spectrum;
            }
            (IndirectPart::Ambient, _, Some(Factor { scale, leaf: Some(leaf) })) => {
                let lux = PI * scale * self.efficacies.get(leaf as usize).copied().unwrap_or(0.0);
                reading.indirect_lux = Some(lux);
                reading.lux += lux;
                let leaf = self.palette.leaves().get(leaf as usize);
                reading.indirect_spectrum = leaf.map(|(leaf, _)| leaf.scaled(PI * scale));
            }
            _ => {}
        }
    }

    /// The spectrum of a reading of this meter at a wavelength in nm, W m⁻² nm⁻¹: of the direct part alone where that of the indirect part isn't
    /// known.
    #[must_use]
    pub fn irradiance(&self, reading: &Reading, wavelength: f64) -> f64 {
        let value = |leaf: &crate::spectral::Tabulated| leaf.spectrum().map_or(0.0, |s| s.value(wavelength));
        let leaves = self.palette.leaves().iter().zip(&reading.weights);
        let direct: f64 =
            leaves.map(|((leaf, _), weight)| if *weight == 0.0 { 0.0 } else { weight * value(leaf) }).sum();
        direct + reading.indirect_spectrum.as_ref().map_or(0.0, value)
    }
}

/// A reading under way.
struct Sum<'m, 'i> {
    meter: &'m Meter<'i>,
    weights: Vec<f64>,
    error: f64,
    samples: u64,
}

impl Sum<'_, '_> {
    /// Adds a light's spectrum times a number.
    fn add(&mut self, factor: Factor, weight: f64) {
        if let Some(sum) = factor.leaf.and_then(|leaf| self.weights.get_mut(leaf as usize)) {
            *sum += factor.scale * weight;
        }
    }

    fn add_area(&mut self, radiance: Factor, found: &Estimate) {
        self.add(radiance, PI * found.factor);
        let efficacy = radiance.leaf.and_then(|leaf| self.meter.efficacies.get(leaf as usize)).copied().unwrap_or(0.0);
        self.error += PI * found.error * radiance.scale * efficacy;
        self.samples += found.rays;
    }
}
