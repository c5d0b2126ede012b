//! Radiosity as the indirect light of pictures: a final gather where the camera looks, or interpolated between such gathers.

use std::collections::HashMap;

use glam::DVec3;

use super::Solution;
use rayon::prelude::*;

use super::cells::{Cells, Chart, Form, GENERATIONS, Gather, Goal, Seen};
use super::mesh::{Patches, icosahedron};
use super::rays::{Lookup, Part};
use super::representation::light;
use super::sight::surface_point;
use super::transport::Buffer;
use crate::direct::Receiver;
use crate::geometry::{Hit, NO_PRIMITIVE};
use crate::scene::{Geometry, Scene};
use crate::spectral::{Factor, FactorOrder};
use crate::whitted::{Indirect, Whitted, Worker};

/// How indirect light is gathered for pictures.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FieldSettings {
    /// The relative error that is aimed at.
    pub accuracy: f64,
    /// Whether light is gathered anew at every place that the camera sees, instead of being interpolated.
    pub exact: bool,
}

/// Where the patches of a shape are among those of the solution.
#[derive(Clone, Copy, Debug)]
enum Patched {
    /// Primitive by primitive: from the first of the shape in the world of rays to the first in that of the solution.
    Same([u32; 2]),
    /// A polygon stands for it, from this primitive of the solution on.
    Disk(u32),
    /// A polyhedron stands for it. Light is gathered at a distance from the centre where all of its faces are behind.
    Sphere { first: u32, centre: DVec3, radius: f64, reach: f64 },
}

/// Indirect irradiance on the surfaces of a scene.
pub struct Field<'s> {
    solution: &'s Solution<'s>,
    /// Rays of a gather, and how they find parts of patches.
    rays: u32,
    lookup: Lookup,
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
    /// `guide`, a solution for the same patches, tells where light is to be gathered: with the same guide, the places are the same for all
    /// representations of spectra. `whitted` is the same scene, for direct light.
    #[must_use]
    pub fn new(
        scene: &Scene,
        whitted: &Whitted,
        [solution, guide]: [&'s Solution<'s>; 2],
        settings: FieldSettings,
        seen: &[Hit],
        progress: &(dyn Fn(u64) + Sync),
    ) -> Self {
        let patches = &solution.radiosity.patches;
        let area: f64 = solution.radiosity.transport.areas.iter().sum();
        let shapes = patched(scene, solution);
        let lookup = Lookup::new(patches, [area / PARTS, area / GROUPS]);
        let reflection = Reflection::new(patches, &shapes, &lookup, whitted);
        let radiosity = reflection.radiosity(solution, &lookup);
        let (charts, rays) = (HashMap::new(), rays(settings));
        let mut field = Self { solution, rays, lookup, radiosity, shapes, charts, cells: None };
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
        field.cells = Some(Cells::new(&charts, &seen, goal, &Gathering { field: &field, colours }, progress));
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
                        form: form(
                            scene,
                            shape,
                            node.primitive - patches.world.primitives(shape as usize).start,
                            node.polygon.normal,
                        ),
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

    /// The parts of patches that rays from a place find.
    fn found(&self, position: DVec3, normal: DVec3, primitive: u32) -> Vec<(u32, f64)> {
        self.solution.radiosity.patches.found_by_rays(&self.lookup, position, normal, primitive, self.rays)
    }

    /// Adds up the radiosity of parts of patches.
    fn add_up(&self, found: &[(u32, f64)], row: &mut [f64]) {
        row.copy_from_slice(&added_up(found, &self.radiosity, self.solution.width()));
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
        let colour = |part: u32| self.colours.get(part as usize).copied().unwrap_or_default();
        found.iter().fold([0.0; 3], |sum, (part, share)| core::array::from_fn(|a| sum[a] + share * colour(*part)[a]))
    }
}

/// Rays of a gather: between cells they may be fewer, as neighbours' errors differ.
#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "from 128 to 65536")]
fn rays(settings: FieldSettings) -> u32 {
    let count = RAYS / settings.accuracy * if settings.exact { 4.0 } else { 1.0 };
    count.clamp(128.0, 65536.0) as u32
}

/// What parts of patches receive, free of wavelength.
struct Reflection {
    /// For each part, the irradiance that comes straight from each light, over the light's radiance; nothing for parts of polyhedra that
    /// stand for round shapes.
    direct: Vec<Option<Vec<f64>>>,
    /// The lights' spectra.
    lights: Vec<Factor>,
    /// For each group of parts, the parts that rays from its middle find.
    found: Vec<Vec<(u32, f64)>>,
}

impl Reflection {
    fn new(patches: &Patches, shapes: &[Patched], lookup: &Lookup, whitted: &Whitted) -> Self {
        let same = |part: &Part| {
            let primitive = patches.nodes[part.node as usize].primitive;
            match shapes.get(patches.world.shape(primitive)? as usize) {
                Some(Patched::Same([to, from])) => Some((primitive, primitive - from + to)),
                _ => None,
            }
        };
        let of_part = |worker: &mut Worker<'_>, part: &Part| {
            let (_, primitive) = same(part)?;
            let (position, normal) = (part.polygon.centre, part.polygon.normal);
            let point = surface_point(position, normal, primitive);
            let contact = 2.0 * f64::from(point.error);
            Some(worker.direct(&Receiver { point, position, normal, geometric: normal, contact }))
        };
        let of_group = |part: &Part| match same(part) {
            Some((primitive, _)) => {
                patches.found_by_rays(lookup, part.polygon.centre, part.polygon.normal, primitive, GROUP_RAYS)
            }
            None => Vec::new(),
        };
        Self {
            direct: lookup.parts.par_iter().map_init(|| Worker::new(whitted, FactorOrder::Free), of_part).collect(),
            lights: whitted.light_factors().collect(),
            found: lookup.groups.par_iter().map(of_group).collect(),
        }
    }

    /// The radiosity of each part of a patch: what it reflects of direct light, as it is in its middle, and of what its group receives from
    /// all others. That is gathered once more, since patches of one radiosity spread light into the shadows of contacts.
    fn radiosity(&self, solution: &Solution<'_>, lookup: &Lookup) -> Vec<f64> {
        let (radiosity, width) = (solution.radiosity, solution.width());
        let of_node = |node: u32| &solution.nodes[node as usize * width..][..width];
        let of_part = |part: &Part| of_node(part.node).to_vec();
        let whole: Vec<f64> = lookup.parts.par_iter().flat_map_iter(of_part).collect();
        match radiosity.settings.bounces {
            None => {
                let transport = &radiosity.transport;
                let reflected: Vec<f64> = transport.leaves.iter().flat_map(|leaf| of_node(*leaf)).copied().collect();
                let mut between = vec![0.0; reflected.len()];
                transport.apply(&reflected, &mut between, width, &mut Buffer::default());
                let mut numbers = vec![0; radiosity.patches.nodes.len()];
                for (number, leaf) in transport.leaves.iter().enumerate() {
                    numbers[*leaf as usize] = number;
                }
                let once = self.reflected(solution, lookup, &whole, |part| {
                    &between[numbers[part.node as usize] * width..][..width]
                });
                let of_group = |found: &Vec<(u32, f64)>| added_up(found, &once, width);
                let again: Vec<f64> = self.found.par_iter().flat_map_iter(of_group).collect();
                self.reflected(solution, lookup, &whole, |part| &again[part.group as usize * width..][..width])
            }
            Some(1) => {
                let nothing = vec![0.0; width];
                self.reflected(solution, lookup, &whole, |_| &nothing)
            }
            // What a limited number of reflections leaves is known for whole patches only.
            Some(_) => whole,
        }
    }

    /// What parts reflect of direct light and of other light.
    fn reflected<'o>(
        &self,
        solution: &Solution<'_>,
        lookup: &Lookup,
        whole: &[f64],
        other: impl Fn(&Part) -> &'o [f64] + Sync,
    ) -> Vec<f64> {
        let (representation, width) = (solution.representation(), solution.width());
        let patches = &solution.radiosity.patches;
        let lights: Vec<Vec<f64>> = self.lights.iter().map(|factor| light(representation, *factor)).collect();
        let of_part = |((part, direct), whole): ((&Part, &Option<Vec<f64>>), &[f64])| {
            let Some(factors) = direct else { return whole.to_vec() };
            let mut row = other(part).to_vec();
            for (factor, spectrum) in factors.iter().zip(&lights) {
                row.iter_mut().zip(spectrum).for_each(|(r, s)| *r += factor * s);
            }
            let side = patches.nodes[part.node as usize].side;
            representation.reflect(patches.sides[side as usize].reflectance, &mut row);
            row
        };
        lookup.parts.par_iter().zip(&self.direct).zip(whole.par_chunks(width)).flat_map_iter(of_part).collect()
    }
}

/// The sum of rows, each times its share.
fn added_up(found: &[(u32, f64)], rows: &[f64], width: usize) -> Vec<f64> {
    let mut sum = vec![0.0; width];
    for (number, share) in found {
        let row = &rows[*number as usize * width..][..width];
        sum.iter_mut().zip(row).for_each(|(s, r)| *s += share * r);
    }
    sum
}

/// Rays of a gather times the accuracy.
const RAYS: f64 = 16.0;
/// About as many parts are patches in, for their direct light, and as many groups for other light.
const PARTS: f64 = 16384.0;
const GROUPS: f64 = 1024.0;
/// Rays of a gather for a group: errors of groups cancel in later gathers.
const GROUP_RAYS: u32 = 256;
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
    let world = &solution.radiosity.patches.world;
    let mut next = 0;
    let mut of_shape = |(number, geometry): (usize, &Geometry)| {
        let first = next;
        next += match geometry {
            Geometry::Mesh(mesh) => u32::try_from(mesh.triangles.len()).unwrap_or(0),
            _ => 1,
        };
        let to = world.primitives(number).start;
        match geometry {
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
