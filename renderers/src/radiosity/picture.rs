//! Radiosity as the indirect light of pictures: a final gather where the camera looks, or interpolated between such gathers.

use std::collections::HashMap;

use glam::DVec3;

use super::Solution;

use super::caustics::{Caustics, Landed};
use super::cells::{Cells, Chart, Form, GENERATIONS, Gather, Goal, Seen};
use super::mesh::icosahedron;
use super::rays::{Found, Lookup, Rays};
use super::reflection::{Reflection, added_up};
use super::specular::Specular;
use crate::geometry::{Hit, NO_PRIMITIVE};
use crate::scene::{Geometry, Scene};
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

/// Where the patches of a shape are among those of the solution.
#[derive(Clone, Copy, Debug)]
pub(super) enum Patched {
    /// Primitive by primitive: from the first of the shape in the world of rays to the first in that of the solution.
    Same([u32; 2]),
    /// A polygon stands for it, from this primitive of the solution on.
    Disk(u32),
    /// Nothing does: light passes.
    Nothing,
    /// A polyhedron stands for it. Light is gathered at a distance from the centre where all of its faces are behind.
    Sphere { first: u32, centre: DVec3, radius: f64, reach: f64 },
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
    shapes: Vec<Patched>,
    charts: HashMap<(u32, bool), u32>,
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
        let shapes = patched(scene, solution);
        let lookup = Lookup::new(patches, [area / PARTS, area / GROUPS]);
        let specular = Specular::new(scene, whitted);
        let (charts, rays, lamps) = (HashMap::new(), rays(settings), settings.caustics == Caustics::Gathered);
        let mut field =
            Self { solution, rays, lookup, specular, lamps, radiosity: Vec::new(), shapes, charts, cells: None };
        let landed = Landed::new(settings.caustics, patches, &field.lookup);
        let reflection = Reflection::new(patches, &field.shapes, field.all_rays(), whitted, landed);
        field.radiosity = reflection.radiosity(solution, &field.lookup);
        if settings.exact {
            return field;
        }
        let charts = field.chart(scene);
        let place = |hit: &Hit| Some((*field.charts.get(&field.key(hit)?)?, hit.position.as_dvec3()));
        let seen: Vec<Seen> = seen.iter().filter_map(place).collect();
        let goal = Goal { tolerance: (BEND * settings.accuracy).min(MOST_BEND), floor: FLOOR, crowd: CROWD };
        let rows = reflection.radiosity(guide, &field.lookup);
        let colour = |row: &[f64]| guide.representation().colour(&[], row).value;
        let colours = rows.chunks(guide.width()).map(colour).collect();
        let gathering = Gathering { field: &field, guide, rows, colours };
        field.cells = Some(Cells::new(&charts, &seen, goal, &gathering, progress));
        field
    }

    /// How many gathers interpolation is between; 0 without it.
    #[must_use]
    pub fn gathers(&self) -> usize {
        self.cells.as_ref().map_or(0, Cells::gathers)
    }

    /// The first primitive of the face of the solution and the side that was hit; the first primitive for polyhedra.
    fn key(&self, hit: &Hit) -> Option<(u32, bool)> {
        match self.shapes.get(hit.shape as usize)? {
            Patched::Same([from, to]) => {
                let primitive = hit.primitive - from + to;
                Some((*self.solution.radiosity.patches.face.get(primitive as usize)?, hit.front))
            }
            Patched::Nothing => None,
            Patched::Disk(first) | Patched::Sphere { first, .. } => Some((*first, hit.front)),
        }
    }

    /// Numbers the surfaces that reflect.
    fn chart(&mut self, scene: &Scene) -> Vec<Chart> {
        let patches = &self.solution.radiosity.patches;
        let mut charts: Vec<Chart> = Vec::new();
        for node in &patches.nodes[..patches.roots] {
            let whole = &patches.blockers[node.primitive as usize];
            let front = whole.normal.dot(node.polygon.normal) > 0.0;
            let Some(shape) = patches.world.shape(node.primitive) else { continue };
            let patched = self.shapes.get(shape as usize);
            let first = match patched {
                Some(Patched::Disk(first) | Patched::Sphere { first, .. }) => *first,
                _ => node.primitive,
            };
            let next = u32::try_from(charts.len()).unwrap_or(u32::MAX);
            let number = *self.charts.entry((first, front)).or_insert(next);
            if number == next {
                charts.push(match patched {
                    Some(Patched::Sphere { centre, radius, reach, .. }) => sphere(*centre, *radius, *reach, first),
                    _ => Chart {
                        polygons: Vec::new(),
                        apex: whole.centre - node.polygon.normal * whole.radius,
                        form: form(scene, shape, node.primitive - patches.starts[shape as usize], node.polygon.normal),
                    },
                });
            }
            let chart = &mut charts[number as usize];
            if !matches!(chart.form, Form::Sphere { .. }) {
                chart.polygons.push((node.polygon.corners().to_vec(), node.primitive));
            }
        }
        charts
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

    fn irradiance(&self, hit: &Hit, row: &mut [f64]) {
        let position = hit.position.as_dvec3();
        let key = self.key(hit);
        if let (Some(cells), Some(chart)) = (&self.cells, key.and_then(|key| self.charts.get(&key)))
            && cells.interpolate(*chart, position, row)
        {
            return;
        }
        let side = if hit.front { 1.0 } else { -1.0 };
        let normal = hit.shading_normal.as_dvec3() * side;
        let patches = &self.solution.radiosity.patches;
        match self.shapes.get(hit.shape as usize) {
            Some(Patched::Sphere { centre, reach, .. }) => {
                let outward = (position - *centre).normalize_or_zero();
                self.gather(*centre + outward * *reach, normal, NO_PRIMITIVE, row);
            }
            Some(Patched::Disk(_)) => self.gather(position, normal, patches.primitive_at(position, normal), row),
            _ => self.gather(position, normal, key.map_or(NO_PRIMITIVE, |(primitive, _)| primitive), row),
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
        self.field.solution.representation().values()
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
/// The bend of irradiance along an edge of cells, over the accuracy: they are interpolated by quadratics, which are closer than that.
const BEND: f64 = 2.5;
const MOST_BEND: f64 = 0.1;
/// What is darker than this share of the mean irradiance is interpolated as if it were as bright as that.
const FLOOR: f64 = 0.1;
/// The most of the picture that one cell covers.
const CROWD: f64 = 1.0 / 128.0;

/// Where all faces of the polyhedron for a sphere of radius 1 are behind: outside, and inside.
const BEYOND_CORNERS: f64 = 1.02;
const WITHIN_FACES: f64 = 0.97;

/// The chart of a whole sphere.
fn sphere(centre: DVec3, radius: f64, reach: f64, primitive: u32) -> Chart {
    let inward = reach < radius;
    let (positions, triangles) = icosahedron();
    let face = |corners: &[u32; 3]| corners.map(|i| centre + positions[i as usize] * radius).to_vec();
    let polygons = triangles.iter().map(|corners| (face(corners), primitive)).collect();
    Chart { polygons, apex: centre, form: Form::Sphere { radius, reach, inward } }
}

/// The form of a flat primitive, by its number in its shape.
fn form(scene: &Scene, shape: u32, number: u32, normal: DVec3) -> Form {
    let Some(Geometry::Mesh(mesh)) = scene.shapes.get(shape as usize).map(|s| &s.geometry) else {
        return Form::Flat(normal);
    };
    let (Some(normals), Some(triangle)) = (&mesh.normals, mesh.triangles.get(number as usize)) else {
        return Form::Flat(normal);
    };
    let own = triangle.map(|i| normals[i as usize]);
    let side = if own.iter().sum::<DVec3>().dot(normal) < 0.0 { -1.0 } else { 1.0 };
    Form::Smooth(mesh.corners(number as usize), own.map(|n| n * side))
}

/// What stands for each shape in the solution.
fn patched(scene: &Scene, solution: &Solution<'_>) -> Vec<Patched> {
    let patches = &solution.radiosity.patches;
    let mut next = 0;
    let mut of_shape = |(number, geometry): (usize, &Geometry)| {
        let first = next;
        next += match geometry {
            Geometry::Mesh(mesh) => u32::try_from(mesh.triangles.len()).unwrap_or(0),
            _ => 1,
        };
        let to = patches.starts[number];
        match geometry {
            _ if to == NO_PRIMITIVE => Patched::Nothing,
            Geometry::Disk { .. } => Patched::Disk(to),
            Geometry::Sphere { center, radius, inward, .. } => {
                let reach = radius * if *inward { WITHIN_FACES } else { BEYOND_CORNERS };
                Patched::Sphere { first: to, centre: *center, radius: *radius, reach }
            }
            Geometry::Rectangle { .. } | Geometry::Mesh(_) => Patched::Same([first, to]),
        }
    };
    scene.shapes.iter().enumerate().map(|(number, shape)| of_shape((number, &shape.geometry))).collect()
}
