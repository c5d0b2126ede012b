//! Radiosity as the indirect light of pictures: a final gather where the camera looks, or interpolated between such gathers.

use glam::DVec3;

use super::Solution;

use super::caustics::{Caustics, Landed};
use super::cells::{Cells, GENERATIONS, Gather, Seen};
use super::charts::{BEYOND_FACES, Charts, Patched};
use super::mosaic::goal;
use super::rays::{Found, Lookup, Rays};
use super::reflection::{Reflection, added_up};
use super::specular::Specular;
use crate::geometry::{Hit, NO_PRIMITIVE};
use crate::scene::Scene;
use crate::whitted::{Indirect, Whitted};

/// How indirect light is gathered for pictures.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FieldSettings<'c> {
    /// The relative error that is aimed at.
    pub accuracy: f64,
    /// Whether light is gathered anew at every place that the camera sees, instead of being interpolated.
    pub exact: bool,
    /// What is known of light that has come straight from lights by way of mirrors and glass.
    pub caustics: Caustics<'c>,
}

/// Indirect irradiance on the surfaces of a scene.
pub struct Field<'s> {
    solution: &'s Solution<'s>,
    /// Rays of a gather, how they find parts of patches, and mirrors and glass on their way.
    rays: u32,
    lookup: Lookup,
    specular: Option<Specular<'s>>,
    /// Whether gathers find lamps by way of these.
    lamps: bool,
    /// The radiosity of these, row by row.
    radiosity: Vec<f64>,
    /// What each number of a row is worth in luminance.
    luminances: Vec<f64>,
    charts: Charts,
    cells: Option<Cells>,
}

impl<'s> Field<'s> {
    /// How many steps it takes to make one.
    pub const STEPS: u64 = GENERATIONS as u64;

    /// Prepares for the places that the camera sees; `progress` is told of steps that are done.
    ///
    /// Rays of gathers follow mirrors, glass and absorption by it, at 587.56 nm where that depends on the wavelength; the spectra of metals
    /// and of coloured boundaries tint their light.
    ///
    /// `guide`, a solution for the same patches, tells where light is to be gathered: with the same guide, the places are the same for all
    /// representations of spectra. `whitted` is the same scene, for direct light.
    #[must_use]
    pub fn new(
        scene: &Scene,
        whitted: &'s Whitted,
        [solution, guide]: [&'s Solution<'s>; 2],
        settings: FieldSettings<'_>,
        seen: &[Hit],
        progress: &(dyn Fn(u64) + Sync),
    ) -> Self {
        let patches = &solution.radiosity.patches;
        let area: f64 = solution.radiosity.transport.areas.iter().sum();
        let mut charts = Charts::new(scene, patches, BEYOND_FACES);
        let lookup = Lookup::new(patches, [area / PARTS, area / GROUPS]);
        let specular = Specular::new(scene, whitted);
        let (rays, lamps) = (rays(settings), settings.caustics == Caustics::Gathered);
        let list = if settings.exact { Vec::new() } else { charts.list(scene, patches) };
        let luminances = solution.representation().luminances();
        let radiosity = Vec::new();
        let mut field = Self { solution, rays, lookup, specular, lamps, radiosity, luminances, charts, cells: None };
        let landed = Landed::new(settings.caustics, patches, &field.lookup);
        let reflection = Reflection::new(patches, &field.charts.shapes, field.all_rays(), whitted, landed);
        field.radiosity = reflection.radiosity(solution, &field.lookup);
        if settings.exact {
            return field;
        }
        let place = |hit: &Hit| Some((field.charts.number(patches, hit)?, hit.position.as_dvec3()));
        let seen: Vec<Seen> = seen.iter().filter_map(place).collect();
        let rows = reflection.radiosity(guide, &field.lookup);
        let colour = |row: &[f64]| guide.representation().colour(&[], row).value;
        let colours = rows.chunks(guide.width()).map(colour).collect();
        let gathering = Gathering { field: &field, guide, rows, colours };
        field.cells = Some(Cells::new(&list, &seen, goal(settings.accuracy), &gathering, progress));
        field
    }

    /// How many gathers interpolation is between; 0 without it.
    #[must_use]
    pub fn gathers(&self) -> usize {
        self.cells.as_ref().map_or(0, Cells::gathers)
    }

    const fn all_rays(&self) -> Rays<'_> {
        Rays { lookup: &self.lookup, specular: self.specular.as_ref(), lamps: self.lamps, count: self.rays }
    }

    /// The parts of patches that rays from a place find.
    fn found(&self, position: DVec3, normal: DVec3, primitive: u32) -> Vec<Found> {
        self.solution.radiosity.patches.found_by_rays(self.all_rays(), position, normal, primitive)
    }

    /// Adds up the radiosity of parts of patches.
    fn add_up(&self, found: &[Found], row: &mut [f64]) {
        row.copy_from_slice(&added_up(found, &self.radiosity, self.solution.representation()));
    }

    /// The irradiance at a place.
    fn gather(&self, position: DVec3, normal: DVec3, primitive: u32, row: &mut [f64]) {
        self.add_up(&self.found(position, normal, primitive), row);
    }
}

impl Indirect for Field<'_> {
    fn width(&self) -> usize {
        self.solution.width()
    }

    fn luminances(&self) -> &[f64] {
        &self.luminances
    }

    fn irradiance(&self, hit: &Hit, row: &mut [f64]) {
        let position = hit.position.as_dvec3();
        let patches = &self.solution.radiosity.patches;
        if let (Some(cells), Some(chart)) = (&self.cells, self.charts.number(patches, hit))
            && cells.interpolate(chart, position, row)
        {
            return;
        }
        let side = if hit.front { 1.0 } else { -1.0 };
        let normal = hit.shading_normal.as_dvec3() * side;
        match self.charts.shapes.get(hit.shape as usize) {
            Some(Patched::Sphere { centre, reach, .. }) => {
                let outward = (position - *centre).normalize_or_zero();
                self.gather(*centre + outward * *reach, normal, NO_PRIMITIVE, row);
            }
            Some(Patched::Disk(_)) => self.gather(position, normal, patches.primitive_at(position, normal), row),
            _ => {
                let key = self.charts.key(patches, hit);
                self.gather(position, normal, key.map_or(NO_PRIMITIVE, |(primitive, _)| primitive), row);
            }
        }
    }
}

/// Gathers of a field, with the colours of all parts of patches, which tell how good interpolation is.
struct Gathering<'f, 's> {
    field: &'f Field<'s>,
    guide: &'f Solution<'s>,
    /// The guide's radiosity of all parts.
    rows: Vec<f64>,
    colours: Vec<[f64; 3]>,
}

impl Gather for Gathering<'_, '_> {
    fn width(&self) -> usize {
        self.field.solution.width()
    }
    fn values(&self) -> usize {
        self.field.solution.representation().linear()
    }
    fn gather(&self, position: DVec3, normal: DVec3, primitive: u32, row: &mut [f64]) -> [f64; 3] {
        let found = self.field.found(position, normal, primitive);
        self.field.add_up(&found, row);
        found.iter().fold([0.0; 3], |sum, found| {
            let colour = self.colour(found);
            core::array::from_fn(|a| sum[a] + found.share * colour[a])
        })
    }
}

impl Gathering<'_, '_> {
    /// The colour of what was found.
    fn colour(&self, found: &Found) -> [f64; 3] {
        let part = found.part as usize;
        if found.tint.is_none() {
            return self.colours.get(part).copied().unwrap_or_default();
        }
        let leaves: Vec<u32> = found.tint.leaves().collect();
        let width = self.guide.width();
        self.guide.representation().colour(&leaves, &self.rows[part * width..][..width]).value
    }
}

/// Rays of a gather: between cells they may be fewer, as neighbours' errors differ.
#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "from 128 to 65536")]
fn rays(settings: FieldSettings<'_>) -> u32 {
    let count = RAYS / settings.accuracy * if settings.exact { 4.0 } else { 1.0 };
    count.clamp(128.0, 65536.0) as u32
}

/// Rays of a gather times the accuracy.
const RAYS: f64 = 16.0;
/// About as many parts are patches in, for their direct light, and as many groups for other light.
const PARTS: f64 = 16384.0;
const GROUPS: f64 = 1024.0;
