//! The global photon map's photons: from all lights in all directions, by mirrors and glass and from surface to surface (Jensen 1996).
//!
//! A photon is kept wherever it meets a surface that scatters, but not where it comes straight from a light, as that light is found otherwise. It
//! goes on from there, in a direction
//! distributed as the cosine, as often as the surface reflects light (Russian roulette): so that photons that go on carry as much light as
//! before. At mirrors and glass it takes one of the ways on, at the helium d line (587.56 nm) where they depend on the wavelength. As between
//! patches, Schlick's model counts as diffuse but for its specular share, which is mirrored, and Ward's by its base alone.

use rayon::prelude::*;

use glam::DVec3;
use spectral_core::brdf::Schlick;
use spectral_core::fresnel;

use super::aim::{Lamp, cosine_hemisphere};
use super::points::{Points, Purpose};
use super::shades::Shades;
use super::{Photon, surface};
use crate::direct::single;
use crate::geometry::sampling::{SobolSequence, combine};
use crate::geometry::{Hit, Ray, SurfacePoint};
use crate::material::{Lobe, Material};
use crate::radiosity::follow;
use crate::spectral::{Factor, FactorOrder, Monomial, Monomials, Palette};
use crate::whitted::{Whitted, mirror_ray, receiver};

/// Photons that are one piece of work.
const CHUNK: u32 = 8192;

/// Reflections after which a photon ends where the scene sets no limit.
const MOST_REFLECTIONS: u32 = 1024;

/// Reflectances in a product: as many as give at most so many different products, but in these limits.
const PRODUCTS: u64 = 1 << 14;
const LENGTHS: [usize; 2] = [4, 16];

/// How photons are emitted and followed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct GlobalSettings {
    /// Different seeds give independent photons.
    pub(crate) seed: u32,
    /// Diffuse reflections after which photons end, so that the last place is still kept; `None` for no limit.
    pub(crate) reflections: Option<u32>,
    /// Whether products of spectra may be reordered.
    pub(crate) order: FactorOrder,
}

/// Which photons of a pass are kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kept {
    /// Not those that came straight from a light.
    Indirect,
    /// And a quarter of those that did: so that there are not too few in the shade.
    Spread,
}

/// One of so many photons that came straight from a light counts for [`Kept::Spread`].
const SPREAD: u32 = 4;

/// A place where a photon landed, as far as the photon doesn't say.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Spot {
    pub(crate) primitive: u32,
    /// The place, with the unit geometric normal on the side that was met.
    pub(crate) point: SurfacePoint,
}

/// What becomes of photons' light. Each photon counts by its share of what it had at first, its spectra by their means; in photons.
///
/// `emitted` = `absorbed` + `gone` + `too_deep` + `roulette`, to rounding.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Balance {
    /// Photons emitted.
    pub(crate) emitted: f64,
    /// Absorbed by surfaces, mirrors and media.
    pub(crate) absorbed: f64,
    /// Out of the scene, or lost between mirrors.
    pub(crate) gone: f64,
    /// Ended by the limit of reflections.
    pub(crate) too_deep: f64,
    /// What roulette ended, less what it gave to the others: 0 on average.
    pub(crate) roulette: f64,
}

impl Balance {
    fn add(&mut self, other: &Self) {
        self.emitted += other.emitted;
        self.absorbed += other.absorbed;
        self.gone += other.gone;
        self.too_deep += other.too_deep;
        self.roulette += other.roulette;
    }
}

/// Photons of a pass.
#[derive(Clone, Debug, Default)]
pub(crate) struct Released {
    pub(crate) photons: Vec<Photon>,
    /// One for each photon.
    pub(crate) spots: Vec<Spot>,
    /// For each photon, whether it came from a light by way of mirrors or glass alone.
    pub(crate) caustic: Vec<bool>,
    pub(crate) shades: Shades,
    pub(crate) balance: Balance,
}

/// All lights of a scene, ready to send photons.
#[derive(Debug)]
pub(crate) struct Global<'s> {
    scene: &'s Whitted,
    /// The mean of each leaf of the palette.
    means: Vec<f64>,
    /// Reflectances in a product; those of further surfaces count by their means.
    longest: usize,
    settings: GlobalSettings,
}

impl<'s> Global<'s> {
    /// The lights and materials of a scene, whose spectra are in the palette.
    pub(crate) fn new(scene: &'s Whitted, palette: &Palette, settings: GlobalSettings) -> Self {
        let means = palette.leaves().iter().map(|(leaf, _)| super::shades::mean(leaf)).collect();
        Self { scene, means, longest: longest(scene, settings.order), settings }
    }

    /// What a spectrum counts for where one number stands for it.
    fn mean(&self, leaf: u32) -> f64 {
        self.means.get(leaf as usize).copied().unwrap_or(1.0)
    }

    /// What a photon's flux is worth, for each product.
    #[allow(clippy::cast_possible_truncation, reason = "as precise as fluxes")]
    pub(crate) fn brightness(&self, shades: &Shades) -> Vec<f32> {
        let product = |leaves: &[u32]| leaves.iter().map(|leaf| self.mean(*leaf)).product::<f64>();
        shades.iter().map(|(light, leaves)| (light.map_or(1.0, |l| self.mean(l)) * product(leaves)) as f32).collect()
    }

    /// Emits photons, about `count` altogether, all of about the same flux. Passes are independent of each other. The result doesn't depend on the number
    /// of threads. `progress` is told of attempts, of which there are [`attempts`](Self::attempts).
    pub(crate) fn emit(&self, count: u64, (pass, kept): (u32, Kept), progress: &(dyn Fn(u64) + Sync)) -> Released {
        let tasks = self.tasks(count);
        let walks: Vec<Walk<'_>> = tasks
            .par_iter()
            .filter_map(|task| {
                let walk = self.run(*task, (pass, kept))?;
                progress(u64::from(task.count));
                Some(walk)
            })
            .collect();
        let mut released = Released::default();
        let stored = walks.iter().map(|walk| walk.landed.len()).sum();
        released.photons.reserve_exact(stored);
        released.spots.reserve_exact(stored);
        released.caustic.reserve_exact(stored);
        for walk in walks {
            released.balance.add(&walk.balance);
            let mut numbers = vec![None; walk.products.len()];
            for Landed { photon, product, spot, caustic } in &walk.landed {
                let number = numbers.get_mut(product.index()).map(|known| {
                    *known.get_or_insert_with(|| released.shades.number(walk.light, walk.products.leaves(*product)))
                });
                released.photons.push(Photon { spectrum: number.unwrap_or_default(), ..*photon });
                released.spots.push(*spot);
                released.caustic.push(*caustic);
            }
        }
        released
    }

    /// How many steps [`emit`](Self::emit) tells its progress of.
    pub(crate) fn attempts(&self, count: u64) -> u64 {
        self.tasks(count).iter().map(|task| u64::from(task.count)).sum()
    }

    fn lamp(&self, light: u32) -> Option<Lamp<'s>> {
        Some(Lamp { light: self.scene.lights().get(light as usize)?, world: self.scene.world() })
    }

    /// The work of a pass, in pieces: attempts of each light by its part of the flux.
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "limited to the range")]
    #[allow(clippy::cast_precision_loss, reason = "counts")]
    fn tasks(&self, count: u64) -> Vec<Task> {
        let bright = |light: u32| {
            let Some(lamp) = self.lamp(light) else { return [0.0; 2] };
            let factor = lamp.light.factor();
            let scale = factor.scale * factor.leaf.map_or(1.0, |leaf| self.mean(leaf));
            [lamp.flux() * scale, lamp.attempted_flux() * scale]
        };
        let fluxes: Vec<[f64; 2]> = (0..).zip(self.scene.lights()).map(|(light, _)| bright(light)).collect();
        let total: f64 = fluxes.iter().map(|[flux, _]| flux).sum();
        let mut tasks = Vec::new();
        if count == 0 {
            return tasks;
        }
        for (light, [flux, attempted]) in (0..).zip(fluxes) {
            if !(flux > 0.0 && attempted.is_finite()) {
                continue;
            }
            let of = (attempted / total * count as f64).ceil().clamp(1.0, f64::from(u32::MAX)) as u32;
            let mut first = 0;
            while first < of {
                let count = CHUNK.min(of - first);
                tasks.push(Task { light, first, count, of });
                first += count;
            }
        }
        tasks
    }

    /// One piece of work.
    fn run(&self, task: Task, (pass, kept): (u32, Kept)) -> Option<Walk<'_>> {
        let lamp = self.lamp(task.light)?;
        let factor = lamp.light.factor();
        let flux = lamp.attempted_flux() * factor.scale / f64::from(task.of);
        let mut walk = Walk {
            around: self,
            kept,
            light: factor.leaf,
            products: Monomials::new(self.settings.order),
            landed: Vec::new(),
            balance: Balance::default(),
        };
        // No pass of photons towards mirrors and glass has such numbers.
        let pass = combine(pass, 0x676c_6f62);
        let points = Points::new(self.settings.seed, pass, task.light);
        let seed = combine(combine(combine(0x676c_6f62, self.settings.seed), pass), task.light);
        for index in task.first..task.first + task.count {
            let decision = points.decision(index, 0, Purpose::Start);
            if let Some(ray) = lamp.release(points.place(index), decision) {
                walk.follow(Chance { seed, index }, ray, flux);
            }
        }
        Some(walk)
    }
}

/// Attempts of a light.
#[derive(Clone, Copy, Debug)]
struct Task {
    light: u32,
    first: u32,
    count: u32,
    /// How many there are in all.
    of: u32,
}

/// A photon as it is kept.
#[derive(Clone, Copy, Debug)]
struct Landed {
    photon: Photon,
    product: Monomial,
    spot: Spot,
    caustic: bool,
}

/// The random numbers of a photon under way.
#[derive(Clone, Copy, Debug)]
struct Chance {
    seed: u32,
    index: u32,
}

impl Chance {
    /// The numbers of its way after so many reflections.
    const fn after(self, reflections: u32) -> SobolSequence {
        SobolSequence::new(combine(self.seed, reflections))
    }
}

/// Dimensions of a photon's numbers, beyond those of boundaries.
const SCATTER: u32 = 1 << 20;

/// Where a photon is.
#[derive(Clone, Copy, Debug)]
struct State {
    ray: Ray,
    flux: f64,
    /// Light relative to the emitted photon's, spectra by their means.
    weight: f64,
    product: Monomial,
}

/// Follows photons of one light, for one thread.
#[derive(Debug)]
struct Walk<'s> {
    around: &'s Global<'s>,
    kept: Kept,
    /// The light's spectrum.
    light: Option<u32>,
    /// Reflectances, in the order in which they were met where that matters.
    products: Monomials,
    landed: Vec<Landed>,
    balance: Balance,
}

impl Walk<'_> {
    /// Follows a photon until it ends.
    fn follow(&mut self, chance: Chance, ray: Ray, flux: f64) {
        let scene = self.around.scene;
        let most = self.around.settings.reflections.unwrap_or(MOST_REFLECTIONS);
        self.balance.emitted += 1.0;
        let mut state = State { ray, flux, weight: 1.0, product: Monomial::default() };
        for reflections in 0.. {
            let numbers = chance.after(reflections);
            let Some(end) = follow((scene, scene.world()), &numbers, state.ray, chance.index) else {
                self.balance.gone += state.weight;
                return;
            };
            let before = state.weight;
            self.multiply(&mut state, Factor { scale: end.weight, leaf: None });
            for leaf in end.tint.leaves() {
                self.multiply(&mut state, Factor { scale: 1.0, leaf: Some(leaf) });
            }
            self.balance.absorbed += before - state.weight;
            let Some(material) = scene.material(&end.hit) else {
                self.balance.absorbed += state.weight;
                return;
            };
            let is_first = reflections == 0;
            let spread = self.kept == Kept::Spread && chance.index.is_multiple_of(SPREAD);
            if end.bent || !is_first || spread {
                self.keep((&end.hit, end.direction), &state, is_first && end.bent);
            }
            if reflections >= most {
                self.balance.too_deep += state.weight;
                return;
            }
            let [choice, survival] = numbers.point(chance.index, SCATTER).map(f64::from);
            let Some((factor, ray)) = scattered(material, &end.hit, end.direction, choice, || {
                numbers.point(chance.index, SCATTER + 1).map(f64::from)
            }) else {
                self.balance.absorbed += state.weight;
                return;
            };
            let before = state.weight;
            self.multiply(&mut state, factor);
            self.balance.absorbed += before - state.weight;
            if !self.survives(&mut state, survival) {
                return;
            }
            state.ray = ray;
        }
    }

    /// Multiplies a photon's light by a factor; products that are long enough are multiplied by its mean.
    fn multiply(&mut self, state: &mut State, factor: Factor) {
        let mean = factor.leaf.map_or(1.0, |leaf| self.around.mean(leaf));
        state.weight *= factor.scale * mean;
        state.flux *= factor.scale;
        let Some(leaf) = factor.leaf else { return };
        if self.products.leaves(state.product).len() < self.around.longest {
            state.product = self.products.times_leaf(state.product, leaf);
        } else {
            state.flux *= mean;
        }
    }

    /// Ends a photon, or gives it back the light that it had at first.
    fn survives(&mut self, state: &mut State, number: f64) -> bool {
        let before = state.weight;
        if before < 1.0 {
            let survives = number < before;
            let share = if survives { 1.0 / before } else { 0.0 };
            state.flux *= share;
            state.weight *= share;
        }
        self.balance.roulette += before - state.weight;
        state.weight > 0.0
    }

    fn keep(&mut self, (hit, direction): (&Hit, DVec3), state: &State, caustic: bool) {
        #[allow(clippy::cast_possible_truncation, reason = "photons are f32")]
        let photon = Photon {
            position: hit.position.to_array(),
            direction: single(-direction).to_array(),
            flux: state.flux as f32,
            spectrum: 0,
            surface: surface(hit.shape, hit.front),
        };
        let point = SurfacePoint { normal: hit.facing_normal(), ..hit.point() };
        let spot = Spot { primitive: hit.primitive, point };
        self.landed.push(Landed { photon, product: state.product, spot, caustic });
    }
}

/// The reflectance of a surface for light that goes in all directions; `None` for mirrors and glass.
pub(super) fn reflectance(material: &Material) -> Option<Factor> {
    match material {
        Material::Diffuse(factor) => Some(*factor),
        Material::Schlick { reflectance, roughness, isotropy } => {
            let specular = specular_share(*roughness, *isotropy);
            Some(Factor { scale: reflectance.scale * (1.0 - specular), ..*reflectance })
        }
        Material::Ward(_) => {
            let base = material.lobes().into_iter().flatten().find(|(_, lobe)| matches!(lobe, Lobe::Lambert));
            base.map(|(factor, _)| factor)
        }
        Material::Mirror(_) | Material::Dielectric(_) | Material::TwoSided(_) => None,
    }
}

fn specular_share(roughness: f64, isotropy: f64) -> f64 {
    Schlick::new(roughness, isotropy).map_or(0.0, |model| model.weights()[2])
}

/// The way on from a surface, chosen by the shares of its ways, and what light is multiplied by there.
fn scattered(
    material: &Material,
    hit: &Hit,
    direction: DVec3,
    choice: f64,
    u: impl FnOnce() -> [f64; 2],
) -> Option<(Factor, Ray)> {
    if let Material::Schlick { reflectance, roughness, isotropy } = material {
        let specular = specular_share(*roughness, *isotropy);
        if choice < specular {
            let white = Factor { scale: 1.0, leaf: None };
            let is_white = choice < specular * fresnel::schlick_factor(-direction.dot(receiver(hit).normal));
            return Some((if is_white { white } else { *reflectance }, mirror_ray(hit, direction)));
        }
        return Some((*reflectance, diffuse_ray(hit, u())));
    }
    Some((reflectance(material)?, diffuse_ray(hit, u())))
}

fn diffuse_ray(hit: &Hit, u: [f64; 2]) -> Ray {
    hit.point().ray(single(cosine_hemisphere(hit.facing_normal().as_dvec3(), u)))
}

/// How many reflectances a product of photons has at most.
fn longest(scene: &Whitted, order: FactorOrder) -> usize {
    let mut leaves: Vec<u32> = Vec::new();
    let mut note = |material: &Material| leaves.extend(reflectance(material).and_then(|factor| factor.leaf));
    for material in scene.materials() {
        match material {
            Material::TwoSided(sides) => sides.iter().for_each(&mut note),
            material => note(material),
        }
    }
    leaves.sort_unstable();
    leaves.dedup();
    let kinds = leaves.len() as u64;
    let [least, most] = LENGTHS;
    // Products of `length` factors or less: (kinds + length over length) of them, or kinds to the power of length if the order matters.
    let mut products = 1;
    for length in 1..=most {
        let longer = length as u64;
        products = match order {
            FactorOrder::Free => products * (kinds + longer) / longer,
            FactorOrder::Kept => products * kinds.max(1),
        };
        if products > PRODUCTS {
            return (length - 1).max(least);
        }
    }
    most
}

#[cfg(test)]
mod tests;
