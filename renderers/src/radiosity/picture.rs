//! Radiosity as the indirect light of pictures: a final gather where the camera looks, or interpolated between such gathers.

use std::collections::HashMap;

use glam::DVec3;

use super::Solution;
use super::cells::{Cells, Chart, Form, GENERATIONS, Gather, Goal, Seen};
use super::gather::Place;
use super::mesh::icosahedron;
use super::rays::Lookup;
use crate::geometry::{Hit, NO_PRIMITIVE};
use crate::scene::{Geometry, Scene};
use crate::whitted::Indirect;

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

/// The colour of a row on white: tristimulus values.
type ColourOf<'c> = dyn Fn(&[f64]) -> [f64; 3] + Sync + 'c;

/// Indirect irradiance on the surfaces of a scene.
pub struct Field<'s> {
    solution: &'s Solution<'s>,
    /// Patches that count as one in a final gather.
    share: f64,
    /// Rays of other gathers, and how they find patches.
    rays: u32,
    lookup: Lookup,
    shapes: Vec<Patched>,
    charts: HashMap<(u32, bool), u32>,
    cells: Option<Cells>,
}

impl<'s> Field<'s> {
    /// How many steps it takes to make one.
    pub const STEPS: u64 = GENERATIONS as u64;

    /// Prepares for the places that the camera sees; `progress` is told of steps that are done. `colour` gives the tristimulus values of a row of the solution on white.
    #[must_use]
    pub fn new(
        scene: &Scene,
        solution: &'s Solution<'s>,
        settings: FieldSettings,
        seen: &[Hit],
        colour: &ColourOf<'_>,
        progress: &(dyn Fn(u64) + Sync),
    ) -> Self {
        let mut field = Self {
            solution,
            share: SHARE * settings.accuracy,
            rays: std::env::var("RAYS").map_or(512, |r| r.parse().unwrap_or(512)),
            lookup: Lookup::new(&solution.radiosity.patches),
            shapes: patched(scene, solution),
            charts: HashMap::new(),
            cells: None,
        };
        if settings.exact {
            return field;
        }
        let charts = field.chart(scene);
        let seen: Vec<Seen> = seen
            .iter()
            .filter_map(|hit| Some((*field.charts.get(&field.key(hit)?)?, hit.position.as_dvec3())))
            .collect();
        let goal = Goal {
            tolerance: std::env::var("BEND").map_or(BEND, |r| r.parse().unwrap_or(BEND)) * settings.accuracy,
            floor: FLOOR,
            crowd: CROWD,
        };
        field.cells = Some(Cells::new(&charts, &seen, goal, &Gathering { field: &field, colour }, progress));
        field
    }

    /// How many gathers interpolation is between; 0 without it.
    #[must_use]
    pub fn gathers(&self) -> usize {
        self.cells.as_ref().map_or(0, Cells::gathers)
    }

    /// The primitive of the solution and the side that was hit; the first primitive for polyhedra.
    fn key(&self, hit: &Hit) -> Option<(u32, bool)> {
        match self.shapes.get(hit.shape as usize)? {
            Patched::Same([from, to]) => Some((hit.primitive - from + to, hit.front)),
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

    /// The final gather at a place.
    fn gather(&self, position: DVec3, normal: DVec3, primitive: u32, row: &mut [f64]) {
        if self.rays > 0 {
            row.copy_from_slice(&self.solution.by_rays(&self.lookup, position, normal, primitive, self.rays));
            return;
        }
        let place = Place::on(&self.solution.radiosity.patches, position, normal, primitive);
        row.copy_from_slice(&self.solution.gathered(&place, self.share));
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

/// Gathers of a field, with the colours that tell how good interpolation is.
struct Gathering<'f, 's> {
    field: &'f Field<'s>,
    colour: &'f ColourOf<'f>,
}

impl Gather for Gathering<'_, '_> {
    fn width(&self) -> usize {
        self.field.solution.width()
    }
    fn gather(&self, position: DVec3, normal: DVec3, primitive: u32, row: &mut [f64]) {
        self.field.gather(position, normal, primitive, row);
    }
    fn colour(&self, row: &[f64]) -> [f64; 3] {
        (self.colour)(row)
    }
}

/// Patches that count as one change a gather by at most this share of the accuracy, each.
const SHARE: f64 = 0.05;
/// The bend of irradiance along an edge of cells, over the accuracy: they are interpolated by quadratics, which are closer than that.
const BEND: f64 = 1.0;
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
            Geometry::Sphere { center, radius, inward } => {
                let reach = radius * if *inward { WITHIN_FACES } else { BEYOND_CORNERS };
                Patched::Sphere { first: to, centre: *center, radius: *radius, reach }
            }
            Geometry::Rectangle { .. } | Geometry::Mesh(_) => Patched::Same([first, to]),
        }
    };
    scene.shapes.iter().enumerate().map(|(number, shape)| of_shape((number, &shape.geometry))).collect()
}
