//! A scene's surfaces as charts that irradiance is interpolated on.

use std::collections::HashMap;

use glam::DVec3;

use super::cells::{Chart, Form};
use super::mesh::{Patches, icosahedron};
use crate::geometry::{Hit, NO_PRIMITIVE};
use crate::scene::{Geometry, Scene};

/// Where the patches of a shape are among all of them.
#[derive(Clone, Copy, Debug)]
pub(super) enum Patched {
    /// Primitive by primitive: from the first of the shape in the world of rays to the first in that of patches.
    Same([u32; 2]),
    /// A polygon stands for it, from this primitive of the patches on.
    Disk(u32),
    /// Nothing does: light passes.
    Nothing,
    /// A polyhedron stands for it. Light is gathered at a distance from the centre where all of its faces are behind.
    Sphere { first: u32, centre: DVec3, radius: f64, reach: f64 },
}

/// Which surface is which chart.
#[derive(Clone, Debug)]
pub(super) struct Charts {
    pub(super) shapes: Vec<Patched>,
    numbers: HashMap<(u32, bool), u32>,
}

/// Where light is gathered for spheres, over their radius: outside, and inside.
pub(super) type Reach = [f64; 2];

/// Where all faces of the polyhedron for a sphere are behind.
pub(super) const BEYOND_FACES: Reach = [1.02, 0.97];

impl Charts {
    /// No charts yet.
    pub(super) fn new(scene: &Scene, patches: &Patches, reach: Reach) -> Self {
        Self { shapes: patched(scene, patches, reach), numbers: HashMap::new() }
    }

    /// The first primitive of the face of the patches and the side that was hit; the first primitive for polyhedra.
    pub(super) fn key(&self, patches: &Patches, hit: &Hit) -> Option<(u32, bool)> {
        match self.shapes.get(hit.shape as usize)? {
            Patched::Same([from, to]) => {
                let primitive = hit.primitive - from + to;
                Some((*patches.face.get(primitive as usize)?, hit.front))
            }
            Patched::Nothing => None,
            Patched::Disk(first) | Patched::Sphere { first, .. } => Some((*first, hit.front)),
        }
    }

    /// The number of the chart that was hit.
    pub(super) fn number(&self, patches: &Patches, hit: &Hit) -> Option<u32> {
        self.numbers.get(&self.key(patches, hit)?).copied()
    }

    /// Numbers the surfaces that reflect.
    pub(super) fn list(&mut self, scene: &Scene, patches: &Patches) -> Vec<Chart> {
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
            let number = *self.numbers.entry((first, front)).or_insert(next);
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
}

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

/// What stands for each shape among the patches.
fn patched(scene: &Scene, patches: &Patches, [beyond, within]: Reach) -> Vec<Patched> {
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
                let reach = radius * if *inward { within } else { beyond };
                Patched::Sphere { first: to, centre: *center, radius: *radius, reach }
            }
            Geometry::Rectangle { .. } | Geometry::Mesh(_) => Patched::Same([first, to]),
        }
    };
    scene.shapes.iter().enumerate().map(|(number, shape)| of_shape((number, &shape.geometry))).collect()
}
