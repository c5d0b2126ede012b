//! Radiosity: all light between diffuse surfaces.
//!
//! [`Radiosity::new`] makes patches of a scene's diffuse and shining surfaces and links between them; all of that is free of wavelength.
//! [`Radiosity::solve`] then finds the radiosity of every patch for all numbers of a spectral [`Representation`] at once,
//! [`Radiosity::solve_intervals`] splits the spectrum until the colour of every patch is known, and [`Solution::indirect`] finds the
//! irradiance of reflected light anywhere; [`Field`] does so for the places that a camera sees.
//!
//! What is exact and what isn't: form factors where nothing blocks have closed forms (relative error 10⁻¹⁰); shadows are cut out exactly
//! at some points of each patch; patches have one radiosity each, and links one form factor for a group of patches, split until the
//! unevenness that this hides is small. The operator is scaled so that each patch receives from
//! all around it what it must, and that in closed spaces no light is lost. Where something may block, radiosity is then computed again at
//! three or four points of each patch, between which it is linear: what [`Solution::indirect`] sees. Disks and
//! spheres are polyhedra of the same area: 24-sided and of 320 triangles. Surfaces that are neither diffuse nor two-sided diffuse are refused or
//! simplified: [`Others`].

mod adapt;
mod balance;
mod bounds;
mod build;
mod caustics;
mod cell;
mod cells;
mod charts;
mod cluster;
mod coarse;
mod contour;
mod coupled;
mod error;
mod exchange;
mod field;
mod gather;
mod gauss;
mod intervals;
mod light;
mod link;
mod majorant;
mod mesh;
mod model;
mod moments;
mod mosaic;
mod picture;
mod polish;
mod polygon;
mod ramp;
mod rays;
mod reflection;
mod remote;
mod representation;
mod rough;
mod scalar;
mod shade;
mod sight;
mod slopes;
mod solution;
mod solve;
mod source;
mod specular;
mod start;
mod system;
mod transport;
mod view;

pub use caustics::{Caustics, Deposit};
pub(crate) use cells::Gather;
pub use error::RadiosityError;
pub use light::IndirectRadiosity;
pub(crate) use mosaic::Mosaic;
pub use picture::{Field, FieldSettings};
pub(crate) use rays::Found;
pub(crate) use reflection::added_up;
pub use representation::{Flat, Representation, Tristimulus};
pub(crate) use specular::follow;

use balance::{Balance, balance};
use build::Builder;
use mesh::Patches;
use remote::HitLeaves;
pub use solution::Solution;
use source::Source;
use transport::{Buffer, Transport};

use glam::DVec3;

use crate::scene::{Integrator, Scene};
use crate::spectral::Palette;

/// What a solution aims at.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// Relative error of irradiance that refinement aims at; in (0, 1]. It is no bound: in a cube with a point light the largest error found at
    /// 600 places was 3 times that; for the Cornell box see [`Solution::indirect`].
    pub accuracy: f64,
    /// The relative error that the iteration may leave, by the bound residual / (1 − ρ); in (0, 1].
    pub residual: f64,
    /// The most diffuse reflections of light that reaches a receiver; `None` for no limit.
    pub bounces: Option<u32>,
    /// Whether radiosity is computed at points of patches, too, for [`Solution::indirect`]: without it, this is coarser where something may block.
    pub points: bool,
    /// The most memory in bytes.
    pub memory: usize,
    /// What becomes of surfaces that are neither diffuse nor two-sided diffuse.
    pub others: Others,
}

/// What becomes of surfaces that are neither diffuse nor two-sided diffuse.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Others {
    /// [`RadiosityError::Material`].
    #[default]
    Refused,
    /// Schlick's model counts as diffuse but for its specular share, Ward's by its base alone. Between patches, light passes smooth boundaries
    /// of transparent media as if nothing were there, and mirrors are diffuse surfaces that reflect as much of an even light: its total is
    /// nearly right, but not its way. A [`Field`] follows mirrors and glass as they are.
    Simplified,
}

impl Default for Settings {
    fn default() -> Self {
        Self { accuracy: 3e-3, residual: 1e-8, bounces: None, points: true, memory: 2 << 30, others: Others::Refused }
    }
}

impl Settings {
    /// The same with the limit that a scene asks for: a path of `max_depth` n reaches a receiver by n − 2 diffuse reflections, as the first
    /// of its segments comes from the eye and the last from a light.
    #[must_use]
    pub fn limited_by(mut self, integrator: Integrator) -> Self {
        self.bounces = match integrator {
            Integrator::Path { max_depth: None, .. } => self.bounces,
            Integrator::Path { max_depth: Some(depth), .. } => Some(depth.saturating_sub(2)),
            _ => Some(0),
        };
        self
    }
}

/// What came out, for reports.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Report {
    /// Patches of one radiosity.
    pub patches: usize,
    /// Links between patches and groups of them, each for both ways.
    pub links: usize,
    /// Those that are partly blocked, or may be; with pairs between which nothing was seen to pass, which have no link.
    pub uncertain_links: usize,
    /// Points on patches at which radiosity was computed again; 0 if that isn't needed, asked for or affordable.
    pub points: usize,
    /// Bytes of the operator and of the patches.
    pub bytes: usize,
    /// Share of the patches' area that belongs to closed spaces.
    pub closed: f64,
    /// Largest difference from 1 of a patch's sum of form factors in closed spaces, before they were scaled.
    pub row_sum_error: f64,
    /// The same afterwards.
    pub scaled_row_sum_error: f64,
    /// Steps of the iteration: the most for any component.
    pub iterations: usize,
    /// Largest residual, relative to the largest radiosity of the same component.
    pub residual: f64,
    /// Bound of the error that the iteration leaves, relative to the largest radiosity: residual / (1 − ρ ΣF); infinite if that is not positive.
    pub iteration_error: f64,
    /// How often a component of the spectrum was carried through the operator.
    pub passes: usize,
    /// Intervals, bins or components of the spectrum.
    pub intervals: usize,
    /// Bytes of the radiosities of all patches and groups of them.
    pub row_bytes: usize,
    /// Largest bound over all patches of the ΔE*ab that the spectral representation leaves in the colour of what they reflect; 0 where none is
    /// known. The white is that of Rec. 709, with Y = 1 for a flat radiance of 1.
    pub delta_e_bound: f64,
    /// The mean over the patches' area of that bound.
    pub mean_delta_e_bound: f64,
    /// (Light sent out − light absorbed − light that leaves) / light sent out: the component where this is worst.
    pub energy_balance: f64,
}

/// The most corners of polygons that light is exchanged between.
const MOST_CORNERS: usize = 8;

/// A₁F₁₂ = ∫∫ cos θ₁ cos θ₂ / (π r²) over two convex planar polygons between which nothing stands, in the square of the length unit: area times
/// form factor, the same both ways.
///
/// Corners run anticlockwise as seen from the front, 3 to 8 of them; parts behind the other's plane don't count, and what lies in it within
/// 10⁻¹⁰ of the largest coordinate sees nothing of it. `None` for polygons with fewer or more corners, without area or not finite; corners off
/// their plane or a polygon that isn't convex give a meaningless number. Relative error 10⁻¹²; up to
/// 5·10⁻¹² was found for pairs some diameters apart that see each other askew (Sparrow 1963; Schröder & Hanrahan 1993).
#[must_use]
pub fn polygon_exchange(one: &[[f64; 3]], other: &[[f64; 3]]) -> Option<f64> {
    let mut largest = 0.0_f64;
    let mut polygon = |given: &[[f64; 3]]| {
        let mut buffer = [DVec3::ZERO; MOST_CORNERS];
        let corners = buffer.get_mut(..given.len())?;
        corners.iter_mut().zip(given).for_each(|(corner, c)| *corner = DVec3::from_array(*c));
        let first = *corners.first()?;
        largest = corners.iter().fold(largest, |l, c| l.max(c.abs().max_element()));
        let normal = corners.windows(2).fold(DVec3::ZERO, |n, pair| n + (pair[0] - first).cross(pair[1] - first));
        polygon::Polygon::new(corners, normal.try_normalize()?)
    };
    let (one, other) = (polygon(one)?, polygon(other)?);
    Some(exchange::exchange(&one, &other, mesh::RELATIVE_SLACK * largest, 1e-14))
}

/// The patches of a scene and the transport between them, free of wavelength.
#[derive(Clone, Debug)]
pub struct Radiosity {
    settings: Settings,
    patches: Patches,
    sources: Vec<Source>,
    /// Irradiance from each source on each leaf.
    lit: Vec<f64>,
    transport: Transport,
    /// Where faces are many.
    hit: HitLeaves,
    balance: Balance,
    /// ΣF of each leaf.
    sums: Vec<f64>,
    links: usize,
    uncertain: usize,
}

impl Radiosity {
    /// Makes patches and links; the scene's spectra are added to the palette. `progress` is told the share that is done.
    ///
    /// The result doesn't depend on the number of threads.
    ///
    /// # Errors
    /// [`RadiosityError`] for what this solver can't do, and for what would take more memory than allowed.
    pub fn new(
        scene: &Scene,
        settings: &Settings,
        palette: &mut Palette,
        progress: &(dyn Fn(f64) + Sync),
    ) -> Result<Self, RadiosityError> {
        let patches = Patches::new(scene, settings.others, palette)?;
        let is_idle = |node: &mesh::Node| {
            let side = &patches.sides[node.side as usize];
            side.mirror && side.emission.is_none()
        };
        if patches.nodes[..patches.roots].iter().all(is_idle) && !mesh::is_diffuse_somewhere(scene) {
            return Err(RadiosityError::NothingDiffuse);
        }
        let sources = Source::all(scene, palette)?;
        Self::between(patches, sources, settings, palette, progress)
    }

    /// The same from patches that are not yet refined.
    fn between(
        mut patches: Patches,
        sources: Vec<Source>,
        settings: &Settings,
        palette: &Palette,
        progress: &(dyn Fn(f64) + Sync),
    ) -> Result<Self, RadiosityError> {
        let mut links = Builder::new(settings, &patches, &sources, palette)?.build(&mut patches, progress)?;
        let uncertain = links.iter().filter(|l| !l.clear).count();
        links.retain(|link| link.seen > 0.0);
        let mut buffer = Buffer::default();
        let mut transport = Transport::new(&patches, &links);
        let balance = balance(&patches, &links, &mut transport, &mut buffer);
        let lit = source::irradiances(&patches, &sources, &transport.leaves);
        let sums = transport.row_sums(&mut buffer);
        progress(1.0);
        let hit = HitLeaves::new(&patches);
        Ok(Self {
            settings: *settings,
            patches,
            sources,
            lit,
            transport,
            hit,
            balance,
            sums,
            links: links.len(),
            uncertain,
        })
    }

    fn report(&self) -> Report {
        Report {
            patches: self.transport.leaves.len(),
            links: self.links,
            uncertain_links: self.uncertain,
            bytes: self.transport.bytes() + self.patches.bytes(),
            closed: self.balance.closed,
            row_sum_error: self.balance.before,
            scaled_row_sum_error: self.balance.after,
            ..Report::default()
        }
    }
}
