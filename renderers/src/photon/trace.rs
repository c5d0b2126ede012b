//! Photons on their way through mirrors and glass: paths that part are both followed, as long as each of them counts for enough.

use glam::{DVec3, Vec3A};
use spectral_core::brdf::Schlick;
use spectral_core::dispersion::LINE_D;
use spectral_core::fresnel;

use super::account::Account;
use super::differential::{Change, Differential};
use super::indices::{Indices, slope_of};
use super::motion::Line;
use super::points::{Points, Purpose};
use super::products::Products;
use super::{Drifting, Photon, Scattered, surface};
use crate::direct::single;
use crate::geometry::sampling::combine;
use crate::geometry::{Hit, NO_PRIMITIVE, Ray};
use crate::material::{Dielectric, Material, mirror_factors};
use crate::spectral::{Factor, place_of};
use crate::whitted::{Whitted, boundary_of, mirror_ray, receiver, reflected_by};

/// Where the likelihood to go on that is the same at all wavelengths is less than this part of what a path's weight asks for, the path's
/// own counts.
const MOST_EXCESS: f64 = 2.0;

/// A branch with this bit set is a hash: it took more decisions than there are bits.
const HASHED: u32 = 1 << 31;

/// The branch of a photon that has met nothing yet.
pub(super) const ROOT: u32 = 1;

/// How paths are followed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Limits {
    /// The longest chain of reflections and refractions.
    pub(crate) max_depth: u32,
    /// Where a path parts, both ways are followed for certain while each has at least this share of the emitted photon's flux. What has
    /// less goes on by chance (Russian roulette), with this share.
    pub(crate) share: f64,
}

/// A path that waits at the first boundary where wavelengths part, the boundary included.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Prefix {
    position: [f32; 3],
    error: f32,
    geometric_normal: [f32; 3],
    shading_normal: [f32; 3],
    primitive: u32,
    shape: u32,
    front: bool,
    planar: bool,
    depth: u16,
    /// The unit vector along which the path came.
    direction: [f32; 3],
    /// The way through the interior of the shape whose absorption isn't counted yet, in scene units.
    inside: f32,
    /// The number of the shape in whose interior the path is, or [`NO_PRIMITIVE`].
    interior: u32,
    /// Flux for a spectrum of 1, as a photon's.
    flux: f64,
    /// Flux relative to the emitted photon's, spectra included, and that photon's flux in the unit of accounts.
    weight: f32,
    luminous: f32,
    /// The product of spectra, by its number among [`Spectra`](super::Spectra).
    pub(super) product: u32,
    branch: u32,
    points: Points,
    index: u32,
    /// The number of the path: its photons have the same one, whatever the wavelength.
    pub(crate) path: u32,
}

impl Prefix {
    /// Where the path meets the boundary, in scene units.
    #[cfg(test)]
    pub(crate) const fn position(&self) -> [f32; 3] {
        self.position
    }

    /// Its flux for a spectrum of 1, in the unit of [`Photon::flux`].
    #[cfg(test)]
    pub(crate) const fn flux(&self) -> f64 {
        self.flux
    }

    /// A number by which the path may get a wavelength before it is known how many paths there are.
    pub(super) const fn number(&self) -> u32 {
        self.points.number(self.index, self.branch)
    }

    fn hit(&self) -> Hit {
        Hit {
            t: 0.0,
            primitive: self.primitive,
            shape: self.shape,
            position: Vec3A::from_array(self.position),
            error: self.error,
            geometric_normal: Vec3A::from_array(self.geometric_normal),
            shading_normal: Vec3A::from_array(self.shading_normal),
            uv: [0.0; 2],
            front: self.front,
            planar: self.planar,
        }
    }
}

/// What is kept of a photon that met a surface.
pub(super) trait Landing: Sized {
    /// What is to be known of how its path changes with the wavelength.
    type Change: Change;

    /// For the wavelength in nm at which it was thrown, if it was.
    fn new(scattered: Scattered, change: Self::Change, wavelength: Option<f64>) -> Self;
}

impl Landing for Photon {
    type Change = ();

    fn new(scattered: Scattered, (): (), _: Option<f64>) -> Self {
        scattered.photon
    }
}

impl Landing for Scattered {
    type Change = ();

    fn new(scattered: Self, (): (), _: Option<f64>) -> Self {
        scattered
    }
}

impl Landing for Drifting {
    type Change = Differential;

    #[allow(clippy::cast_possible_truncation, reason = "photons are f32")]
    fn new(scattered: Scattered, change: Differential, wavelength: Option<f64>) -> Self {
        let mut line = Line { at: wavelength.map_or(0.0, |wavelength| place_of(wavelength) as f32), ..Line::default() };
        let (position, flux) = (change.position.as_vec3(), scattered.photon.flux * change.flux as f32);
        // What isn't known to move stays: it is white, on average over all photons, where it might have colours.
        if change.is_known() && position.is_finite() && flux.is_finite() {
            (line.position, line.flux) = (position.to_array(), flux);
        }
        Self { scattered, line }
    }
}

/// A photon as it starts.
#[derive(Clone, Copy, Debug)]
pub(super) struct Start {
    pub(super) points: Points,
    pub(super) index: u32,
    /// Its flux for a spectrum of 1, the light's scale included.
    pub(super) flux: f64,
    /// The same with the light's spectrum as a number: the unit of weights.
    pub(super) luminous: f64,
    /// The light's spectrum.
    pub(super) product: u32,
}

/// Where a path is.
#[derive(Clone, Copy, Debug)]
struct State<C> {
    ray: Ray,
    flux: f64,
    /// Flux relative to the emitted photon's, each spectrum by its mean.
    weight: f64,
    /// The same as it would be at the d line: what decides where paths of all wavelengths should be the same. Its own where it is known how the path
    /// changes: there are no others, then.
    guide: f64,
    product: u32,
    /// The way's length counts for absorption by the interior of this shape.
    interior: Option<u32>,
    /// How many reflections and refractions there were.
    depth: u32,
    branch: u32,
    /// How it changes with the wavelength.
    change: C,
}

/// What a path's flux is multiplied by where it takes one of the ways on.
#[derive(Clone, Copy, Debug, Default)]
struct Share {
    flux: f64,
    weight: f64,
    guide: f64,
}

/// One of the ways on from where a path was.
#[derive(Clone, Copy, Debug)]
struct Way<C> {
    ray: Ray,
    product: u32,
    interior: Option<u32>,
    change: C,
    share: Share,
}

/// What all paths need.
#[derive(Clone, Copy, Debug)]
pub(super) struct Surroundings<'s> {
    pub(super) scene: &'s Whitted,
    /// One for each shape.
    pub(super) materials: &'s [&'s Material],
    /// The mean of each leaf of the palette.
    pub(super) means: &'s [f64],
    pub(super) limits: Limits,
}

impl<'s> Surroundings<'s> {
    /// What the side of a shape that was hit does with light; `None` where it is black.
    pub(super) fn material(&self, hit: &Hit) -> Option<&'s Material> {
        self.scene.material(hit)
    }

    /// The number that stands for a factor's leaf.
    pub(super) fn mean(&self, factor: Factor) -> f64 {
        factor.leaf.map_or(1.0, |leaf| self.means.get(leaf as usize).copied().unwrap_or(0.0))
    }
}

/// Follows photons, one after the other, and keeps those that land, for one thread.
#[derive(Debug)]
pub(super) struct Walk<'s, L: Landing> {
    around: Surroundings<'s>,
    pub(super) products: Products,
    pub(super) landed: Vec<L>,
    pub(super) prefixes: Vec<Prefix>,
    pub(super) account: Account,
    /// Ways still to be followed.
    ways: Vec<State<L::Change>>,
    start: Start,
    /// In nm, for paths that are thrown.
    wavelength: Option<f64>,
    indices: Indices,
    path: u32,
}

impl<'s, L: Landing> Walk<'s, L> {
    pub(super) fn new(around: Surroundings<'s>, products: Products) -> Self {
        let start = Start { points: Points::new(0, 0, 0), index: 0, flux: 0.0, luminous: 0.0, product: 0 };
        Self {
            around,
            products,
            landed: Vec::new(),
            prefixes: Vec::new(),
            account: Account::default(),
            ways: Vec::new(),
            start,
            wavelength: None,
            indices: Indices::default(),
            path: 0,
        }
    }

    /// Follows a photon from the mirror or glass that its ray from the light met.
    pub(super) fn emitted(&mut self, start: Start, ray: Ray, hit: &Hit) {
        self.start = start;
        self.wavelength = None;
        let direction = ray.direction.as_dvec3().normalize_or_zero();
        let Start { flux, product, .. } = start;
        let material = self.around.material(hit);
        // A light within glass: the way to the boundary is through its interior.
        let within = !hit.front && matches!(material, Some(Material::Dielectric(_)));
        let interior = within.then_some(hit.shape);
        let mut state = State {
            ray,
            flux,
            weight: 1.0,
            guide: 1.0,
            product,
            interior,
            depth: 0,
            branch: ROOT,
            change: L::Change::default(),
        };
        self.account.sent += 1;
        self.account.emitted += start.luminous * material.map_or(0.0, mirrored);
        let inside = if within { way(&state, hit) } else { 0.0 };
        self.meet(hit, direction, &mut state, [inside, 0.0]);
        self.follow();
    }

    /// Follows a path from the boundary where it waits, at a wavelength in nm.
    #[allow(clippy::cast_possible_truncation, reason = "paths are short and shares are f32")]
    pub(super) fn throw(&mut self, prefix: &Prefix, wavelength: f64) {
        let Prefix { points, index, flux, product, path, branch, .. } = *prefix;
        self.start = Start { points, index, flux, luminous: f64::from(prefix.luminous), product };
        self.wavelength = Some(wavelength);
        self.path = path;
        let hit = prefix.hit();
        let weight = f64::from(prefix.weight);
        let direction = Vec3A::from_array(prefix.direction);
        let mut state = State {
            ray: Ray::new(hit.position, direction),
            flux,
            weight,
            guide: weight,
            product,
            interior: (prefix.interior != NO_PRIMITIVE).then_some(prefix.interior),
            depth: u32::from(prefix.depth),
            branch,
            // At that boundary it is the same for all waves.
            change: L::Change::default(),
        };
        self.account.sent += 1;
        self.account.emitted += weight * self.start.luminous;
        self.meet(&hit, direction.as_dvec3().normalize_or_zero(), &mut state, [f64::from(prefix.inside), 0.0]);
        self.follow();
    }

    fn follow(&mut self) {
        while let Some(mut state) = self.ways.pop() {
            self.account.rays += 1;
            let Some(hit) = self.around.scene.world().closest_hit(&state.ray) else {
                self.account.lost += 1;
                self.account.escaped += self.luminous(state.weight);
                continue;
            };
            let direction = state.ray.direction.as_dvec3().normalize_or_zero();
            let length = way(&state, &hit);
            let longer = state.change.arrive(&hit, direction, length);
            // What is left from inside is the medium, whatever was entered before: there may be bodies in bodies.
            if !hit.front && matches!(self.around.material(&hit), Some(Material::Dielectric(_))) {
                self.meet(&hit, direction, &mut state, [length, longer]);
                continue;
            }
            let medium = state.interior.and_then(|shape| self.around.materials.get(shape as usize));
            if let Some(Material::Dielectric(medium)) = medium {
                self.absorb(&mut state, medium, [length, longer]);
            }
            self.meet(&hit, direction, &mut state, [0.0; 2]);
        }
    }

    fn luminous(&self, weight: f64) -> f64 {
        weight * self.start.luminous
    }

    /// What a way through a medium takes from a path, for its length and by how much that changes.
    fn absorb(&mut self, state: &mut State<L::Change>, medium: &Dielectric, [distance, longer]: [f64; 2]) {
        let Some(evenly) = medium.absorbs_evenly() else { return };
        let remaining = medium.remaining(distance, self.wavelength.unwrap_or(LINE_D));
        let at_d = if evenly || L::Change::IS_KNOWN { remaining } else { medium.remaining(distance, LINE_D) };
        self.account.media += self.luminous(state.weight * (1.0 - remaining));
        if let Some(wavelength) = self.wavelength.filter(|_| L::Change::IS_KNOWN) {
            let by = if evenly { 0.0 } else { slope_of(|wavelength| medium.absorption(wavelength), wavelength) };
            state.change.brighten(-medium.absorption(wavelength) * longer - by * distance);
        }
        state.flux *= remaining;
        state.weight *= remaining;
        state.guide *= at_d;
    }

    /// A path where it meets a surface; `inside` is the length of its way through that surface's own interior that hasn't been counted, and
    /// by how much it changes.
    fn meet(&mut self, hit: &Hit, direction: DVec3, state: &mut State<L::Change>, inside: [f64; 2]) {
        let Some(material) = self.around.material(hit) else {
            self.account.black += self.luminous(state.weight);
            return;
        };
        match material {
            Material::Diffuse(_) | Material::Ward(_) => self.keep(hit, direction, state, 1.0),
            Material::TwoSided(_) => self.account.black += self.luminous(state.weight),
            Material::Mirror(factors) => {
                let cosine = -direction.dot(receiver(hit).normal);
                self.mirror(hit, direction, state, mirror_factors(factors, cosine));
            }
            Material::Schlick { reflectance, roughness, isotropy } => {
                let specular = specular_part(*roughness, *isotropy);
                if state.depth > 0 && specular < 1.0 {
                    self.keep(hit, direction, state, 1.0 - specular);
                }
                if specular > 0.0 {
                    let factor = fresnel::schlick_factor(-direction.dot(receiver(hit).normal));
                    let white = Factor { scale: 1.0, leaf: None };
                    state.flux *= specular;
                    state.weight *= specular;
                    state.guide *= specular;
                    self.mirror(hit, direction, state, [(*reflectance, 1.0 - factor), (white, factor)]);
                }
            }
            Material::Dielectric(dielectric) => {
                if self.wavelength.is_none() && !dielectric.is_wavelength_free() {
                    self.wait(hit, direction, state, inside[0]);
                    return;
                }
                self.absorb(state, dielectric, inside);
                self.part(hit, direction, state, dielectric);
            }
        }
    }

    /// Keeps a photon; `share` is the part of it that isn't mirrored further.
    fn keep(&mut self, hit: &Hit, direction: DVec3, state: &State<L::Change>, share: f64) {
        let bent = arriving(hit, direction);
        self.account.bent += self.luminous(state.weight * share * (bent - 1.0));
        if !(bent > 0.0) {
            return;
        }
        self.account.kept += 1;
        self.account.deposited += self.luminous(state.weight * share * bent);
        #[allow(clippy::cast_possible_truncation, reason = "photons are f32")]
        let photon = Photon {
            position: hit.position.to_array(),
            direction: single(-direction).to_array(),
            flux: (state.flux * bent) as f32,
            spectrum: state.product,
            surface: surface(hit.shape, hit.front),
        };
        let scattered = Scattered { photon, path: self.path, branch: state.branch };
        self.landed.push(L::new(scattered, state.change, self.wavelength));
    }

    /// Keeps a path for throwing.
    fn wait(&mut self, hit: &Hit, direction: DVec3, state: &State<L::Change>, inside: f64) {
        #[allow(clippy::cast_possible_truncation, reason = "what needs no more digits")]
        let (weight, luminous, inside) = (state.weight as f32, self.start.luminous as f32, inside as f32);
        self.account.waiting += self.luminous(state.weight);
        self.prefixes.push(Prefix {
            position: hit.position.to_array(),
            error: hit.error,
            geometric_normal: hit.geometric_normal.to_array(),
            shading_normal: hit.shading_normal.to_array(),
            primitive: hit.primitive,
            shape: hit.shape,
            front: hit.front,
            planar: hit.planar,
            depth: u16::try_from(state.depth).unwrap_or(u16::MAX),
            direction: single(direction).to_array(),
            inside,
            interior: state.interior.unwrap_or(NO_PRIMITIVE),
            flux: state.flux,
            weight,
            luminous,
            product: state.product,
            branch: state.branch,
            points: self.start.points,
            index: self.start.index,
            path: u32::try_from(self.prefixes.len()).unwrap_or(u32::MAX),
        });
    }

    /// Goes on from a mirror with one of two factors, chosen by their shares.
    fn mirror(&mut self, hit: &Hit, direction: DVec3, state: &State<L::Change>, factors: [(Factor, f64); 2]) {
        let [first, second] = factors.map(|(factor, share)| factor.scale * share);
        let total = first + second;
        let takes_first = second == 0.0 || {
            let Start { points, index, .. } = self.start;
            points.decision(index, state.branch, Purpose::Factor) * total < first
        };
        let factor = factors[usize::from(!takes_first)].0;
        let mean = total * self.around.mean(factor);
        self.account.mirrors += self.luminous(state.weight * (1.0 - mean));
        let ray = mirror_ray(hit, direction);
        let share =
            self.bent(Share { flux: total, weight: mean, guide: mean }, state.weight, leaving(hit, direction, &ray));
        let product = self.products.times(state.product, factor.leaf);
        let change = state.change.mirrored(self.around.scene.world(), hit, direction);
        self.go_on([Some(Way { ray, product, interior: state.interior, change, share }), None], state);
    }

    /// Goes on from a boundary of transparent media, both ways.
    fn part(&mut self, hit: &Hit, direction: DVec3, state: &State<L::Change>, dielectric: &Dielectric) {
        let [index, index_at_d, slope] = self.indices.of(hit.shape, dielectric, self.wavelength, L::Change::IS_KNOWN);
        let [mirrored, led] = state.change.parted(self.around.scene.world(), hit, direction, [index, slope]);
        let (reflected, onward) = boundary_of(index, hit, direction);
        let is_at_d = index == index_at_d || L::Change::IS_KNOWN;
        let at_d = if is_at_d { reflected } else { reflected_by(index_at_d, hit, direction) };
        let Dielectric { reflectance, transmittance, .. } = dielectric;
        let mut way =
            |factor: Factor, [part, guide]: [f64; 2], (ray, change): (Ray, L::Change), interior: Option<u32>| {
                let mean = factor.scale * self.around.mean(factor);
                self.account.boundaries += self.start.luminous * state.weight * part * (1.0 - mean);
                let share = Share { flux: part * factor.scale, weight: part * mean, guide: guide * mean };
                let share = self.bent(share, state.weight, leaving(hit, direction, &ray));
                let product = self.products.times(state.product, factor.leaf);
                Way { ray, product, interior, change, share }
            };
        let interior = if hit.front { state.interior } else { Some(hit.shape) };
        let mirrored = way(*reflectance, [reflected, at_d], (mirror_ray(hit, direction), mirrored), interior);
        let through = onward.map(|onward| {
            let interior = hit.front.then_some(hit.shape);
            way(*transmittance, [1.0 - reflected, 1.0 - at_d], (hit.point().ray(single(onward)), led), interior)
        });
        self.go_on([Some(mirrored), through], state);
    }

    /// A share where shading normals count. Decisions that should be alike at all wavelengths don't depend on it.
    fn bent(&mut self, share: Share, weight: f64, by: f64) -> Share {
        self.account.bent += self.luminous(weight * share.weight * (by - 1.0));
        Share { flux: share.flux * by, weight: share.weight * by, guide: share.guide }
    }

    /// Follows the ways on from where a path was, each unless roulette or the limit of reflections and refractions ends it.
    fn go_on(&mut self, ways: [Option<Way<L::Change>>; 2], from: &State<L::Change>) {
        let mut chance = None;
        for (way, number) in ways.into_iter().zip(0..) {
            let Some(Way { ray, product, interior, change, share }) = way else { continue };
            let (weight, guide) = (from.weight * share.weight, from.guide * share.guide);
            if !(weight > 0.0) {
                continue;
            }
            if from.depth >= self.around.limits.max_depth {
                self.account.too_deep += self.luminous(weight);
                continue;
            }
            let likely = self.likely(weight, guide);
            if likely < 1.0 {
                let Start { points, index, .. } = self.start;
                let u = *chance.get_or_insert_with(|| points.decision(index, from.branch, Purpose::Survival));
                // One number for both ways: where one of them must go on, it is as often as possible only one.
                let survives = if number == 0 { u < likely } else { u >= 1.0 - likely };
                let given = if survives { weight / likely } else { 0.0 };
                self.account.roulette += self.luminous(weight - given);
                if !survives {
                    continue;
                }
            }
            self.ways.push(State {
                ray,
                flux: from.flux * share.flux / likely,
                weight: weight / likely,
                guide: guide / likely,
                product,
                interior,
                depth: from.depth + 1,
                branch: branch(from.branch, number),
                change,
            });
        }
    }

    /// How likely a path goes on: by its weight at the d line, so that paths of all wavelengths do alike, if that isn't far too little.
    fn likely(&self, weight: f64, guide: f64) -> f64 {
        let share = self.around.limits.share;
        let [alike, own] = [guide, weight].map(|weight| if weight < share { weight / share } else { 1.0 });
        if own <= MOST_EXCESS * alike { alike } else { own }
    }
}

/// The branch that takes a way, 0 for reflection and 1 for refraction.
const fn branch(from: u32, way: u32) -> u32 {
    if from < HASHED { from << 1 | way } else { HASHED | combine(from, way) }
}

/// What light that comes along a direction to a surface counts for where its irradiance is by the shading normal and the flux on its area by
/// the geometric one: the ratio of both cosines; 0 for light from behind the shading normal.
fn arriving(hit: &Hit, direction: DVec3) -> f64 {
    let ratio = cosines(hit, direction);
    if ratio.is_finite() { ratio.max(0.0) } else { 0.0 }
}

/// What light counts for that comes along a direction to a mirror or boundary and leaves it along a ray, where the shading normal isn't the
/// geometric one: light is the adjoint of what is seen (E. Veach, *Robust Monte Carlo Methods for Light Transport Simulation*, 1997, §5.3).
/// 0 where it would leave by the wrong side.
fn leaving(hit: &Hit, direction: DVec3, onward: &Ray) -> f64 {
    let ratio = cosines(hit, direction) / cosines(hit, onward.direction.as_dvec3());
    if ratio.is_finite() { ratio.max(0.0) } else { 0.0 }
}

/// The cosine of a direction to the shading normal over that to the geometric normal.
fn cosines(hit: &Hit, direction: DVec3) -> f64 {
    if hit.geometric_normal == hit.shading_normal {
        return 1.0;
    }
    let [geometric, shading] = [hit.geometric_normal, hit.shading_normal].map(|n| direction.dot(n.as_dvec3()));
    shading / geometric
}

/// The length of a path's way to a hit.
fn way<C>(state: &State<C>, hit: &Hit) -> f64 {
    f64::from((hit.position - state.ray.origin).length())
}

/// The ideal specular part of Schlick's model.
fn specular_part(roughness: f64, isotropy: f64) -> f64 {
    Schlick::new(roughness, isotropy).map_or(0.0, |model| model.weights()[2])
}

/// The part of light that a material mirrors or lets through; the rest is scattered.
pub(super) fn mirrored(material: &Material) -> f64 {
    match material {
        Material::Mirror(_) | Material::Dielectric(_) => 1.0,
        Material::Schlick { roughness, isotropy, .. } => specular_part(*roughness, *isotropy),
        _ => 0.0,
    }
}
