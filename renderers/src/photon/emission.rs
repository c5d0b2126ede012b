//! Photons from all lights towards all mirrors and glass: how many each beam has, and their tracing by many threads.

use rayon::prelude::*;

use super::account::Account;
use super::aim::Lamp;
use super::beam::{Attempt, Beam};
use super::points::Points;
use super::products::Products;
use super::target::Target;
use super::trace::{Limits, Prefix, Start, Surroundings, Walk};
use super::{Photon, Scattered, Spectra};
use crate::material::Material;
use crate::scene::Scene;
use crate::spectral::{Factor, Palette, Tabulated, Y_INTEGRAL};
use crate::whitted::Whitted;

/// Attempts, or paths thrown, that are one piece of work.
const CHUNK: u32 = 8192;
const THROWN: usize = 2048;

/// Attempts by which it is found how much photons and paths there will be.
const SAMPLE: u32 = 1024;
const SAMPLING: u32 = u32::MAX - 2;

/// Bytes that a path takes about whose way depends on the wavelength: the photons that it becomes, and the parts of their ways.
const WAYS: f64 = 512.0;

/// How photons are emitted and followed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Settings {
    /// Different seeds give independent photons.
    pub(crate) seed: u32,
    /// How far they are followed.
    pub(crate) limits: Limits,
}

impl Default for Settings {
    fn default() -> Self {
        Self { seed: 0, limits: Limits { max_depth: 32, share: 0.25 } }
    }
}

/// Photons of a pass.
#[derive(Clone, Debug, Default)]
pub(crate) struct Emitted {
    /// Photons whose paths met no boundary where wavelengths part.
    pub(crate) photons: Vec<Photon>,
    /// Paths up to the first such boundary; each one's number is its place here.
    pub(crate) prefixes: Vec<Prefix>,
    /// The products of both.
    pub(crate) spectra: Spectra,
    pub(crate) account: Account,
}

/// Photons thrown again, and what became of the rest.
#[derive(Clone, Debug, Default)]
pub(crate) struct Thrown {
    /// Photons of as many paths each, whatever the wavelength.
    pub(crate) pieces: Vec<Vec<Scattered>>,
    pub(crate) account: Account,
}

impl Thrown {
    /// All photons, in order.
    pub(crate) fn photons(&self) -> Vec<Scattered> {
        self.pieces.concat()
    }
}

/// All beams of a scene.
#[derive(Debug)]
pub(crate) struct Emission<'s> {
    scene: &'s Whitted,
    materials: Vec<&'s Material>,
    pub(super) means: Vec<f64>,
    settings: Settings,
    /// For each shape.
    targets: Vec<Option<Target>>,
    beams: Vec<Beam>,
    /// Photons and prefixes for each photon that meets its target.
    yields: [f64; 2],
}

impl<'s> Emission<'s> {
    /// Finds which lights see which mirrors and glass, and how much of them. The scene's lights and materials are in the palette.
    ///
    /// A beam of which none of 2¹⁵ trial rays meets its target is left out.
    pub(crate) fn new(data: &Scene, scene: &'s Whitted, palette: &Palette, settings: Settings) -> Self {
        let materials: Vec<&Material> = scene.materials().collect();
        let target = |(number, (shape, material))| Target::new(shape, number, material, scene.world());
        let targets = data.shapes.iter().zip(materials.iter().copied()).enumerate().map(target).collect();
        let means = palette.leaves().iter().map(|(leaf, _)| mean(leaf)).collect();
        let mut emission = Self { scene, materials, means, settings, targets, beams: Vec::new(), yields: [0.0; 2] };
        emission.beams = emission.find_beams();
        emission.yields = emission.find_yields();
        emission
    }

    fn find_beams(&self) -> Vec<Beam> {
        let pairs: Vec<[u32; 2]> = (0..)
            .zip(self.scene.lights())
            .flat_map(|(light, _)| (0..).zip(&self.targets).filter(|(_, t)| t.is_some()).map(move |(s, _)| [light, s]))
            .collect();
        let found = |pair: &[u32; 2]| {
            let [light, shape] = pair.map(|number| number as usize);
            let target = self.targets.get(shape)?.as_ref()?;
            let beam = Beam::new(*pair, (self.lamp(light)?, target), &self.around(), self.settings.seed)?;
            (beam.luminous(self.scene.lights().get(light)?, &self.around()) > 0.0).then_some(beam)
        };
        pairs.par_iter().filter_map(found).collect()
    }

    /// Photons and prefixes for each photon that meets its target, each beam by its part of all photons.
    fn find_yields(&self) -> [f64; 2] {
        let shares = self.shares();
        let yields = self.beams.iter().zip(&shares).zip(0..).map(|((beam, share), number)| {
            let task = Task { beam: number, first: 0, count: SAMPLE, of: SAMPLE };
            let walk: Walk<'_, Photon> = self.run(beam, task, SAMPLING);
            let met = count(walk.account.sent).max(1.0);
            [walk.landed.len(), walk.prefixes.len()].map(|found| share * length(found) / met)
        });
        yields.fold([0.0; 2], |[a, b], [c, d]| [a + c, b + d])
    }

    /// The part of all photons that each beam has: that of the flux.
    fn shares(&self) -> Vec<f64> {
        let lights = self.scene.lights();
        let flux = |beam: &Beam| lights.get(beam.light as usize).map_or(0.0, |l| beam.luminous(l, &self.around()));
        let fluxes: Vec<f64> = self.beams.iter().map(flux).collect();
        let total: f64 = fluxes.iter().sum();
        fluxes.iter().map(|flux| flux / total).collect()
    }

    fn around(&self) -> Surroundings<'_> {
        Surroundings { scene: self.scene, materials: &self.materials, means: &self.means, limits: self.settings.limits }
    }

    fn lamp(&self, light: usize) -> Option<Lamp<'s>> {
        Some(Lamp { light: self.scene.lights().get(light)?, world: self.scene.world() })
    }

    /// What was found: lights, shapes, fluxes and shares.
    #[cfg(test)]
    pub(crate) fn beams(&self) -> &[Beam] {
        &self.beams
    }

    /// The numbers of the lights that see no mirror or glass.
    pub(crate) fn idle_lights(&self) -> Vec<usize> {
        let aims = |light: &usize| self.beams.iter().any(|beam| beam.light as usize == *light);
        (0..self.scene.lights().len()).filter(|light| !aims(light)).collect()
    }

    /// What a photon's flux is worth by luminance, for each product: the product of its factors' means.
    #[allow(clippy::cast_possible_truncation, reason = "as precise as fluxes")]
    pub(crate) fn brightness(&self, spectra: &Spectra) -> Vec<f32> {
        let mean = |leaf: &u32| self.means.get(*leaf as usize).copied().unwrap_or(1.0);
        let product = |number: usize| {
            let number = u32::try_from(number).unwrap_or(u32::MAX);
            spectra.leaves(number).iter().map(mean).product::<f64>() as f32
        };
        (0..spectra.len()).map(product).collect()
    }

    /// The luminance of a spectrum, relative to that of a flat one of 1.
    pub(super) fn luminance(&self, spectrum: Factor) -> f64 {
        spectrum.scale * self.around().mean(spectrum)
    }

    /// About how many bytes it takes to emit so many photons and to keep them, while their parts are put together; more than there are for absurd counts.
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "an estimate")]
    pub(crate) fn bytes_for(&self, count: u64) -> u64 {
        let [photons, prefixes] = self.yields;
        let each = photons * length(size_of::<Photon>()) + prefixes * (length(size_of::<Prefix>()) + WAYS);
        (2.0 * each * self::count(count)) as u64
    }

    /// Emits photons of which about `count` meet mirrors or glass: each beam has as many as is its part of the flux. All the scene's
    /// light is in each pass; passes are independent (the three highest numbers are taken). The result doesn't depend on the number of threads.
    pub(crate) fn emit(&self, count: u64, pass: u32, progress: &(dyn Fn(u64) + Sync)) -> Emitted {
        let tasks = self.tasks(count);
        let walks: Vec<Walk<'_, Photon>> = tasks
            .par_iter()
            .filter_map(|task| {
                let walk = self.run(self.beams.get(task.beam as usize)?, *task, pass);
                progress(u64::from(task.count));
                Some(walk)
            })
            .collect();
        let mut emitted = Emitted::default();
        emitted.photons.reserve_exact(walks.iter().map(|walk| walk.landed.len()).sum());
        emitted.prefixes.reserve_exact(walks.iter().map(|walk| walk.prefixes.len()).sum());
        for walk in walks {
            let numbers = walk.products.into_spectra(&mut emitted.spectra);
            emitted.account.add(&walk.account);
            for photon in walk.landed {
                emitted.photons.push(Photon { spectrum: numbers.number(photon.spectrum), ..photon });
            }
            for mut prefix in walk.prefixes {
                prefix.path = u32::try_from(emitted.prefixes.len()).unwrap_or(u32::MAX);
                prefix.product = numbers.number(prefix.product);
                emitted.prefixes.push(prefix);
            }
        }
        emitted
    }

    /// How many steps [`emit`](Self::emit) tells its progress of.
    pub(crate) fn attempts(&self, count: u64) -> u64 {
        self.tasks(count).iter().map(|task| u64::from(task.count)).sum()
    }

    /// The work of a pass, in pieces.
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "limited to the range")]
    fn tasks(&self, count: u64) -> Vec<Task> {
        let mut tasks = Vec::new();
        for ((number, beam), share) in (0..).zip(&self.beams).zip(self.shares()) {
            let attempts = (share * self::count(count) / beam.share_of_attempts).ceil();
            let of = attempts.clamp(1.0, f64::from(u32::MAX)) as u32;
            let mut first = 0;
            while first < of {
                let count = CHUNK.min(of - first);
                tasks.push(Task { beam: number, first, count, of });
                first += count;
            }
        }
        tasks
    }

    /// One piece of work.
    fn run(&self, beam: &Beam, task: Task, pass: u32) -> Walk<'_, Photon> {
        let around = self.around();
        let mut walk = Walk::new(around, Products::of(&Spectra::default()));
        let target = self.targets.get(beam.shape as usize).and_then(Option::as_ref);
        let (Some(lamp), Some(target)) = (self.lamp(beam.light as usize), target) else { return walk };
        let factor = lamp.light.factor();
        let product = walk.products.times(0, factor.leaf);
        let mean = around.mean(factor);
        let points = Points::new(self.settings.seed, pass, task.beam);
        walk.account.attempts = u64::from(task.count);
        for index in task.first..task.first + task.count {
            match beam.attempt((lamp, target), &around, points, index) {
                Attempt::None => {}
                Attempt::Missed => walk.account.rays += 1,
                Attempt::Met(aim, hit) => {
                    walk.account.rays += 1;
                    let flux = aim.flux * factor.scale / f64::from(task.of);
                    walk.emitted(Start { points, index, flux, luminous: flux * mean, product }, aim.ray, &hit);
                }
            }
        }
        walk
    }

    /// Follows paths again from the first boundary where wavelengths part, each at a wavelength in nm; new products are added to those of
    /// the paths. Photons come in the order of the paths and their branches; their flux is that at the wavelength, their spectra left out.
    ///
    /// A path takes the same decisions at all wavelengths where it can: photons of the same path and branch at different wavelengths
    /// correspond to each other. The result doesn't depend on the number of threads.
    pub(crate) fn throw(
        &self,
        prefixes: &[Prefix],
        wavelength_of: impl Fn(usize) -> f64 + Sync,
        spectra: &mut Spectra,
    ) -> Thrown {
        let products = Products::of(spectra);
        let walks: Vec<Walk<'_, Scattered>> = prefixes
            .par_chunks(THROWN)
            .enumerate()
            .map(|(chunk, prefixes)| {
                let mut walk: Walk<'_, Scattered> = Walk::new(self.around(), products.clone());
                for (number, prefix) in prefixes.iter().enumerate() {
                    walk.throw(prefix, wavelength_of(chunk * THROWN + number));
                }
                for own in walk.landed.chunk_by_mut(|a, b| a.path == b.path) {
                    own.sort_by_key(|photon| photon.branch);
                }
                walk
            })
            .collect();
        let mut thrown = Thrown::default();
        let number = |walk: Walk<'_, Scattered>| {
            thrown.account.add(&walk.account);
            (walk.products.into_spectra(spectra), walk.landed)
        };
        let numbered: Vec<_> = walks.into_iter().map(number).collect();
        let landed = numbered.into_par_iter().map(|(numbers, mut landed)| {
            landed.iter_mut().for_each(|s| s.photon.spectrum = numbers.number(s.photon.spectrum));
            landed
        });
        Thrown { pieces: landed.collect(), ..thrown }
    }
}

/// Attempts of a beam.
#[derive(Clone, Copy, Debug)]
struct Task {
    beam: u32,
    first: u32,
    count: u32,
    /// How many there are in all.
    of: u32,
}

/// The mean of a spectrum under the luminosity function, relative to a flat spectrum of 1.
fn mean(leaf: &Tabulated) -> f64 {
    let observer = spectral_core::Observer::cie_1931_2deg();
    let y = |spectrum| spectral_core::tristimulus(&observer, &spectrum, 380.0, 780.0)[1];
    leaf.spectrum().map_or(0.0, y) / Y_INTEGRAL
}

#[allow(clippy::cast_precision_loss, reason = "counts")]
const fn count(number: u64) -> f64 {
    number as f64
}

#[allow(clippy::cast_precision_loss, reason = "counts")]
const fn length(number: usize) -> f64 {
    number as f64
}
