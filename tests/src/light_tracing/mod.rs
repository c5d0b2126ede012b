//! Light tracing: caustics by particles from the lights, an `independent` oracle for photon maps and for path tracing.
//!
//! Particles leave the lights, follow mirrors and smooth dielectrics, and end at the first diffuse surface they meet: paths L S* D. There they
//! are binned ([`Grid`]), connected to the eye ([`Film`]), or handed to any function as a [`Landing`]. With at least one S these are caustics.
//! Sampling, refraction, Fresnel's formulae for glass and metals, media and the camera are this module's own; intersections are those of
//! [`renderers::geometry::World`].
//!
//! A particle carries `W` wavelengths together until it meets glass whose index depends on the wavelength. There it splits into one particle
//! for each wavelength, which are refracted each by its own index, so that dispersion is continuous and shows no bins. At a boundary a
//! particle is reflected or refracted at random, as often as Fresnel's reflectance says: what it carries doesn't change.
//!
//! Where meshes have smooth normals, particles count as the adjoint of radiance does (E. Veach, *Robust Monte Carlo Methods for Light
//! Transport Simulation*, 1997, §5.3), so that pictures have the path tracer's mean. Flux isn't kept there, which [`Balance::bent`] counts.
//!
//! Not emitted: light of the environment and the ambient term. Refused: surfaces that scatter otherwise than Lambert's.

mod emission;
mod film;
mod particle;
mod surface;
mod waves;

use core::fmt;

use rayon::prelude::*;
use renderers::direct;
use renderers::geometry::glam::{DVec3, Vec3A};
use renderers::geometry::{SurfacePoint, World};
use renderers::scene::{Geometry, Scene};

use crate::statistics::Rng;
use emission::Lights;
pub use film::Film;
use particle::Walk;
use surface::{Side, sides};
pub use waves::Waves;

/// Particles of a batch: their places on a light and their directions are each spread over as many cells.
pub const PARTICLES: u32 = 1 << 16;

/// Why a scene can't be traced.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum TraceError {
    /// A surface that scatters light otherwise than Lambert's: its material's label.
    Material(String),
    /// There is no light that particles could leave.
    NoLight,
    /// The surfaces are not fit for rays.
    Geometry(renderers::geometry::GeometryError),
    /// A built-in glass that isn't there, or a spectrum without values.
    Spectrum(String),
    /// A grid is wanted on a shape that is no rectangle, or has no cells.
    Grid,
    /// A picture has no pixels, or a filter that isn't fit.
    Picture,
}

impl fmt::Display for TraceError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Material(label) => write!(f, "{label}: light tracing knows Lambertian surfaces, mirrors and glass"),
            Self::NoLight => write!(f, "the scene has no light that particles could leave"),
            Self::Geometry(error) => write!(f, "{error}"),
            Self::Spectrum(label) => write!(f, "{label}: no such spectrum or glass"),
            Self::Grid => write!(f, "a grid takes a rectangle and at least one cell"),
            Self::Picture => write!(f, "a picture takes at least one pixel and a filter of positive width"),
        }
    }
}

impl core::error::Error for TraceError {}

/// Where particles go.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Aim {
    /// Wherever the lights shine.
    #[default]
    Everywhere,
    /// To the spheres around mirrors and glass, where caustics come from: flux that goes elsewhere is left out, and caustics have less noise.
    Specular,
}

/// A scene ready for particles.
#[derive(Debug)]
pub struct LightTracer<'s> {
    scene: &'s Scene,
    world: World,
    /// For each shape, its front and its back.
    sides: Vec<[Side; 2]>,
    lights: Lights,
}

/// A particle that has met a diffuse surface.
#[derive(Clone, Copy, Debug)]
pub struct Landing<const W: usize> {
    /// The shape's number.
    pub shape: u32,
    /// Where, with the geometric normal.
    pub point: SurfacePoint,
    /// The unit direction in which it came.
    pub direction: DVec3,
    /// The unit geometric and shading normals on the side that it came to.
    pub normals: [DVec3; 2],
    /// The surface's reflectance there.
    pub reflectance: [f64; W],
    /// How often it was reflected or refracted on its way.
    pub specular: u32,
    /// Spectral flux for each nm; the sum over a batch estimates that of all light. 0 for wavelengths that go other ways.
    pub flux: [f64; W],
}

/// What has become of the flux of some particles, in means over their wavelengths. What is emitted and bent is the sum of all else.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Balance {
    /// Left the lights.
    pub emitted: f64,
    /// Added where shading normals are not the geometric ones; may be negative.
    pub bent: f64,
    /// Landed on diffuse surfaces straight from the lights.
    pub direct: f64,
    /// Landed there by way of mirrors or glass.
    pub caustic: f64,
    /// Absorbed by media, by mirrors and boundaries that reflect less than all, and by black sides of surfaces.
    pub absorbed: f64,
    /// Left the scene.
    pub escaped: f64,
    /// Went on for more than a thousand boundaries, or to the wrong side of a surface with shading normals.
    pub lost: f64,
}

impl Balance {
    /// How far it is from closing, relative to what was emitted: rounding alone.
    #[must_use]
    pub fn gap(&self) -> f64 {
        let found = self.direct + self.caustic + self.absorbed + self.escaped + self.lost;
        ((self.emitted + self.bent - found) / self.emitted).abs()
    }

    /// The sums of two.
    #[must_use]
    pub fn plus(self, other: Self) -> Self {
        Self {
            emitted: self.emitted + other.emitted,
            bent: self.bent + other.bent,
            direct: self.direct + other.direct,
            caustic: self.caustic + other.caustic,
            absorbed: self.absorbed + other.absorbed,
            escaped: self.escaped + other.escaped,
            lost: self.lost + other.lost,
        }
    }

    fn scaled(self, by: f64) -> Self {
        Self {
            emitted: self.emitted * by,
            bent: self.bent * by,
            direct: self.direct * by,
            caustic: self.caustic * by,
            absorbed: self.absorbed * by,
            escaped: self.escaped * by,
            lost: self.lost * by,
        }
    }
}

/// A mean with its standard error.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Estimate {
    /// The mean.
    pub mean: f64,
    /// The standard deviation of the mean.
    pub error: f64,
}

impl Estimate {
    /// Of independent values, at least two.
    #[must_use]
    #[allow(clippy::cast_precision_loss, reason = "counts are far below 2⁵³")]
    pub fn of(values: &[f64]) -> Self {
        let count = values.len() as f64;
        let mean = values.iter().sum::<f64>() / count;
        let squares = values.iter().map(|v| (v - mean).powi(2)).sum::<f64>();
        Self { mean, error: (squares / (count * (count - 1.0))).sqrt() }
    }

    /// How many standard errors it is from a value that is known to `tolerance`.
    #[must_use]
    pub fn z(&self, expected: f64, tolerance: f64) -> f64 {
        let excess = ((self.mean - expected).abs() - tolerance).max(0.0);
        if excess == 0.0 { 0.0 } else { excess / self.error }
    }
}

impl<'s> LightTracer<'s> {
    /// Makes a scene ready.
    ///
    /// # Errors
    /// What [`TraceError`] lists.
    pub fn new(scene: &'s Scene, aim: Aim) -> Result<Self, TraceError> {
        let world = direct::world(scene).map_err(TraceError::Geometry)?;
        let sides = sides(scene)?;
        let lights = Lights::new(scene, &world, &sides, aim)?;
        Ok(Self { scene, world, sides, lights })
    }

    /// Traces the particles of a batch, which its number and the seed alone decide, and hands all that land to `landed`.
    pub fn batch<const W: usize>(
        &self,
        waves: &Waves<W>,
        [seed, number]: [u64; 2],
        mut landed: impl FnMut(&Landing<W>),
    ) -> Balance {
        let mut walk = Walk::new(self, waves, &mut landed);
        let mut random = random(seed, number);
        let strata = Strata::new(&mut random);
        for particle in 0..PARTICLES {
            if let Some(start) = self.lights.emit(waves, strata.cells(particle), &mut random) {
                walk.follow(start, &mut random);
            }
        }
        walk.balance()
    }

    /// Runs batches `first`… on all threads; results come in the batches' order.
    pub fn batches<T: Send>(&self, first: u64, count: u64, run: impl Fn(u64) -> T + Send + Sync) -> Vec<T> {
        (first..first + count).into_par_iter().map(run).collect()
    }

    /// The mean balance of some batches at a wavelength in nm.
    ///
    /// # Errors
    /// [`TraceError::Spectrum`].
    pub fn balance(&self, wavelength: f64, batches: u64, seed: u64) -> Result<Balance, TraceError> {
        let waves = Waves::single(self.scene, wavelength)?;
        let all = self.batches(0, batches, |number| self.batch(&waves, [seed, number], |_| {}));
        #[allow(clippy::cast_precision_loss, reason = "batches are few")]
        let share = 1.0 / batches as f64;
        Ok(all.into_iter().fold(Balance::default(), Balance::plus).scaled(share))
    }

    /// The caustics' spectral irradiance at a wavelength in nm: its means over a grid's cells.
    ///
    /// # Errors
    /// [`TraceError::Spectrum`].
    pub fn irradiance(
        &self,
        grid: &Grid,
        wavelength: f64,
        batches: u64,
        seed: u64,
    ) -> Result<Vec<Estimate>, TraceError> {
        let waves = Waves::single(self.scene, wavelength)?;
        let maps = self.batches(0, batches, |number| {
            let mut map = vec![0.0; grid.cells[0] * grid.cells[1]];
            self.batch(&waves, [seed, number], |landing: &Landing<1>| {
                if let (Some(cell), true) = (grid.cell(landing), landing.specular > 0) {
                    map[cell] += landing.flux[0] / grid.cell_area();
                }
            });
            map
        });
        let cell = |cell: usize| Estimate::of(&maps.iter().map(|map| map[cell]).collect::<Vec<_>>());
        Ok((0..grid.cells[0] * grid.cells[1]).map(cell).collect())
    }

    /// The scene.
    #[must_use]
    pub const fn scene(&self) -> &'s Scene {
        self.scene
    }
}

/// The generator of a batch.
fn random(seed: u64, number: u64) -> Rng {
    let mixed = Rng::new(seed).bits() ^ number.wrapping_mul(0xd134_2543_de82_ef95);
    Rng::new(Rng::new(mixed).bits())
}

/// Cells of places and directions, so that each of both is spread evenly over its unit square and their pairing is random.
#[derive(Clone, Copy, Debug)]
struct Strata([u32; 4]);

impl Strata {
    /// Cells along a side.
    const SIDE: u32 = 256;

    #[allow(clippy::cast_possible_truncation, reason = "bits are chosen")]
    fn new(random: &mut Rng) -> Self {
        let bits = random.bits();
        Self([0, 16, 32, 48].map(|shift| (bits >> shift) as u32 & 0xffff))
    }

    /// The cells of place and direction of a particle.
    const fn cells(&self, particle: u32) -> [[u32; 2]; 2] {
        let Self([a, b, c, offset]) = *self;
        // A permutation of 16 bits. The offset makes every cell of the one as likely for each cell of the other: no bias.
        let mut x = (particle.wrapping_mul(a | 1).wrapping_add(b)) & 0xffff;
        x ^= x >> 7;
        x = x.wrapping_mul(c | 1) & 0xffff;
        x ^= x >> 9;
        x = x.wrapping_add(offset) & 0xffff;
        [[x % Self::SIDE, x / Self::SIDE], [particle % Self::SIDE, particle / Self::SIDE]]
    }

    /// A point of a cell.
    fn point(cell: [u32; 2], random: &mut Rng) -> [f64; 2] {
        cell.map(|c| (f64::from(c) + random.unit()) / f64::from(Self::SIDE))
    }
}

/// Cells of a rectangle of the scene.
#[derive(Clone, Debug)]
pub struct Grid {
    shape: u32,
    centre: DVec3,
    halves: [DVec3; 2],
    cells: [usize; 2],
}

impl Grid {
    /// So many cells along the first and the second edge of a rectangle, given by its number.
    ///
    /// # Errors
    /// [`TraceError::Grid`].
    pub fn new(scene: &Scene, shape: usize, cells: [usize; 2]) -> Result<Self, TraceError> {
        let geometry = scene.shapes.get(shape).map(|shape| &shape.geometry);
        let (Some(Geometry::Rectangle { center, half_u, half_v, .. }), Ok(shape)) = (geometry, u32::try_from(shape))
        else {
            return Err(TraceError::Grid);
        };
        if cells.contains(&0) {
            return Err(TraceError::Grid);
        }
        Ok(Self { shape, centre: *center, halves: [*half_u, *half_v], cells })
    }

    /// The number of the cell where a particle has landed, row by row; the first edge is along rows.
    #[must_use]
    pub fn cell<const W: usize>(&self, landing: &Landing<W>) -> Option<usize> {
        let offset = landing.point.position.as_dvec3() - self.centre;
        let [column, row] = [0, 1].map(|axis: usize| {
            let half = self.halves[axis];
            let place = (offset.dot(half) / half.length_squared() + 1.0) / 2.0;
            floor(place * count(self.cells[axis])).min(self.cells[axis] - 1)
        });
        (landing.shape == self.shape).then_some(row * self.cells[0] + column)
    }

    /// The area of a cell.
    #[must_use]
    pub fn cell_area(&self) -> f64 {
        4.0 * self.halves[0].cross(self.halves[1]).length() / count(self.cells[0] * self.cells[1])
    }
}

#[allow(clippy::cast_precision_loss, reason = "counts are small")]
const fn count(n: usize) -> f64 {
    n as f64
}

#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "saturates, and is limited by the callers")]
const fn floor(x: f64) -> usize {
    x as usize
}

#[allow(clippy::cast_possible_truncation, reason = "rays are traced in f32")]
const fn single(v: DVec3) -> Vec3A {
    Vec3A::new(v.x as f32, v.y as f32, v.z as f32)
}
