//! Photons from all lights towards all mirrors and glass: how many each beam has, and their tracing by many threads.

use rayon::prelude::*;

use super::account::Account;
use super::aim::Lamp;
use super::beam::{Attempt, Beam};
use super::points::Points;
use super::products::{Products, Renumbered};
use super::target::Target;
use super::trace::{Landing, Limits, Prefix, Start, Surroundings, Walk};
use super::{Drifting, Photon, Scattered, Spectra};
use crate::material::Material;
use crate::scene::Scene;
use crate::spectral::{Factor, Palette, Tabulated, Y_INTEGRAL};
use crate::whitted::Whitted;

/// Attempts, or paths thrown, that are one piece of work.
const CHUNK: u32 = 2048;
const THROWN: usize = 512;

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
    /// In the place of these, if they were asked for: their photons, in pieces, and how many paths there were.
    pub(crate) drifting: Vec<Vec<Drifting>>,
    pub(crate) drifted: usize,
    /// The products of all.
    pub(crate) spectra: Spectra,
    pub(crate) account: Account,
}

/// At which wavelength in nm a path goes on, by its number.
pub(super) type WavelengthOf<'f> = &'f (dyn Fn(u32) -> f64 + Sync);

/// What comes of some attempts.
#[derive(Debug)]
struct Run<'s> {
    walk: Walk<'s, Photon>,
    /// The same paths behind the first boundary where wavelengths part, if they go on there, and how many do.
    onward: Walk<'s, Drifting>,
    drifted: usize,
}

impl Run<'_> {
    /// Lets all paths go on that wait.
    fn go_on(&mut self, wavelength_of: WavelengthOf<'_>) {
        let Self { walk, onward, drifted } = self;
        core::mem::swap(&mut walk.products, &mut onward.products);
        for prefix in walk.prefixes.drain(..) {
            onward.throw(&prefix, wavelength_of(prefix.number()));
            *drifted += 1;
        }
        core::mem::swap(&mut walk.products, &mut onward.products);
    }
}

/// Photons thrown again, and what became of the rest.
#[derive(Clone, Debug)]
pub(crate) struct Thrown<L = Scattered> {
    /// Photons of as many paths each, whatever the wavelength.
    pub(crate) pieces: Vec<Vec<L>>,
    #[cfg_attr(not(test), allow(dead_code, reason = "whether all flux is accounted for is asked by tests alone"))]
    pub(crate) account: Account,
}

impl<L: Clone> Thrown<L> {
    /// All photons, in order.
    pub(crate) fn photons(&self) -> Vec<L> {
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
            let walk = self.run(beam, task, SAMPLING, None).walk;
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

    /// Whether some of the paths of a trial depend on the wavelength.
    pub(super) fn is_dispersive(&self) -> bool {
        self.yields[1] > 0.0
    }

    /// About how many bytes it takes to emit so many photons and to keep them, while their parts are put together; more than there are for absurd counts.
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "an estimate")]
    pub(crate) fn bytes_for(&self, count: u64) -> u64 {
        let [photons, prefixes] = self.yields;
        let each = photons * length(size_of::<Photon>()) + prefixes * (length(size_of::<Prefix>()) + WAYS);
        (2.0 * each * self::count(count)) as u64
    }

    /// Emits photons of which about `count` meet mirrors or glass: each beam has as many as is its part of the flux. All the scene's
    /// light is in each pass; passes are independent (the four highest numbers are taken). The result doesn't depend on the number of threads.
    pub(crate) fn emit(&self, count: u64, pass: u32, progress: &(dyn Fn(u64) + Sync)) -> Emitted {
        self.emit_all((count, pass), None, progress)
    }

    /// The same, and paths go on where wavelengths part, each at one: it is known of their photons how they move with it.
    pub(super) fn emit_drifting(
        &self,
        count: u64,
        pass: u32,
        wavelength_of: WavelengthOf<'_>,
        progress: &(dyn Fn(u64) + Sync),
    ) -> Emitted {
        self.emit_all((count, pass), Some(wavelength_of), progress)
    }

    fn emit_all(
        &self,
        (count, pass): (u64, u32),
        wavelength_of: Option<WavelengthOf<'_>>,
        progress: &(dyn Fn(u64) + Sync),
    ) -> Emitted {
        let tasks = self.tasks(count);
        let runs: Vec<Run<'_>> = tasks
            .par_iter()
            .filter_map(|task| {
                let run = self.run(self.beams.get(task.beam as usize)?, *task, pass, wavelength_of);
                progress(u64::from(task.count));
                Some(run)
            })
            .collect();
        let mut emitted = Emitted::default();
        emitted.photons.reserve_exact(runs.iter().map(|run| run.walk.landed.len()).sum());
        emitted.prefixes.reserve_exact(runs.iter().map(|run| run.walk.prefixes.len()).sum());
        let mut drifting = Vec::with_capacity(runs.len());
        for Run { walk, onward, drifted } in runs {
            let numbers = walk.products.into_spectra(&mut emitted.spectra);
            emitted.account.add(&walk.account);
            emitted.drifted += drifted;
            for photon in walk.landed {
                emitted.photons.push(Photon { spectrum: numbers.number(photon.spectrum), ..photon });
            }
            for mut prefix in walk.prefixes {
                prefix.path = u32::try_from(emitted.prefixes.len()).unwrap_or(u32::MAX);
                prefix.product = numbers.number(prefix.product);
                emitted.prefixes.push(prefix);
            }
            drifting.push((numbers, onward.landed));
        }
        emitted.drifting = drifting.into_par_iter().map(|(numbers, landed)| renumbered(landed, &numbers)).collect();
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
    fn run(&self, beam: &Beam, task: Task, pass: u32, wavelength_of: Option<WavelengthOf<'_>>) -> Run<'_> {
        let around = self.around();
        let none = || Products::of(&Spectra::default());
        let mut run = Run { walk: Walk::new(around, none()), onward: Walk::new(around, none()), drifted: 0 };
        if wavelength_of.is_some() {
            run.onward.landed.reserve(task.count as usize);
        }
        let walk = &mut run.walk;
        let target = self.targets.get(beam.shape as usize).and_then(Option::as_ref);
        let (Some(lamp), Some(target)) = (self.lamp(beam.light as usize), target) else { return run };
        let factor = lamp.light.factor();
        let product = walk.products.times(0, factor.leaf);
        let mean = around.mean(factor);
        let points = Points::new(self.settings.seed, pass, task.beam);
        walk.account.attempts = u64::from(task.count);
        for index in task.first..task.first + task.count {
            match beam.attempt((lamp, target), &around, points, index) {
                Attempt::None => {}
                Attempt::Missed => run.walk.account.rays += 1,
                Attempt::Met(aim, hit) => {
                    run.walk.account.rays += 1;
                    let flux = aim.flux * factor.scale / f64::from(task.of);
                    run.walk.emitted(Start { points, index, flux, luminous: flux * mean, product }, aim.ray, &hit);
                    wavelength_of.into_iter().for_each(|wavelength_of| run.go_on(wavelength_of));
                }
            }
        }
        run
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
        self.throw_again(prefixes, wavelength_of, spectra)
    }

    /// The same with how photons move with the wavelength.
    pub(super) fn throw_drifting(
        &self,
        prefixes: &[Prefix],
        wavelength_of: impl Fn(usize) -> f64 + Sync,
        spectra: &mut Spectra,
    ) -> Thrown<Drifting> {
        self.throw_again(prefixes, wavelength_of, spectra)
    }

    fn throw_again<L: Landing + Send + AsRef<Scattered> + AsMut<Scattered>>(
        &self,
        prefixes: &[Prefix],
        wavelength_of: impl Fn(usize) -> f64 + Sync,
        spectra: &mut Spectra,
    ) -> Thrown<L> {
        let products = Products::of(spectra);
        let walks: Vec<Walk<'_, L>> = prefixes
            .par_chunks(THROWN)
            .enumerate()
            .map(|(chunk, prefixes)| {
                let mut walk: Walk<'_, L> = Walk::new(self.around(), products.clone());
                for (number, prefix) in prefixes.iter().enumerate() {
                    walk.throw(prefix, wavelength_of(chunk * THROWN + number));
                }
                for own in walk.landed.chunk_by_mut(|a, b| a.as_ref().path == b.as_ref().path) {
                    own.sort_by_key(|photon| photon.as_ref().branch);
                }
                walk
            })
            .collect();
        let mut account = Account::default();
        let number = |walk: Walk<'_, L>| {
            account.add(&walk.account);
            (walk.products.into_spectra(spectra), walk.landed)
        };
        let numbered: Vec<_> = walks.into_iter().map(number).collect();
        let landed = numbered.into_par_iter().map(|(numbers, landed)| renumbered(landed, &numbers));
        Thrown { pieces: landed.collect(), account }
    }
}

/// Photons with the numbers that their spectra have among all.
fn renumbered<L: AsMut<Scattered>>(mut landed: Vec<L>, numbers: &Renumbered) -> Vec<L> {
    landed.iter_mut().map(L::as_mut).for_each(|s| s.photon.spectrum = numbers.number(s.photon.spectrum));
    landed
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
