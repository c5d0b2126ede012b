//! What of a scene is not wrong but hardly meant: surfaces of transparent media that enclose none.

use core::fmt;
use std::collections::HashMap;

use glam::DVec3;

use super::{BsdfKind, Geometry, Mesh, Scene, Shape};

/// A shape that is hardly meant as it is.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub struct Warning {
    /// The shape's label: type or id, and file with line.
    pub shape: String,
    /// What is odd about it.
    pub flaw: Flaw,
}

/// Why the surface of a transparent medium encloses none.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Flaw {
    /// Light gets in or out beside the surface: a flat shape, or a mesh with edges where it ends.
    Open {
        /// Edges that an odd number of triangles share; 0 for flat shapes.
        edges: usize,
    },
    /// Front and back change along edges between neighbouring triangles.
    TwoFaced {
        /// Edges that two triangles run along in the same direction.
        edges: usize,
    },
    /// It is closed and its two sides coincide.
    ZeroVolume,
    /// Its front is inside, so that the medium is all the space around it.
    InsideOut,
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: the dielectric {}", self.shape, self.flaw)
    }
}

impl fmt::Display for Flaw {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Open { edges: 0 } => {
                f.write_str("is flat and encloses nothing: light enters its medium and never leaves it")
            }
            Self::Open { edges: 1 } => f.write_str("is open along 1 edge: light leaves its medium without meeting it"),
            Self::Open { edges } => {
                write!(f, "is open along {edges} edges: light leaves its medium without meeting it")
            }
            Self::TwoFaced { edges } => {
                write!(f, "has triangles that face opposite sides ({edges} edges between them)")
            }
            Self::ZeroVolume => f.write_str("has no volume: its front and back coincide"),
            Self::InsideOut => f.write_str("is inside out: its medium is the space around it"),
        }
    }
}

impl Scene {
    /// What of this scene is allowed but hardly meant, in the order of its shapes: those with a dielectric that are open, two-faced,
    /// without volume, or inside out, the first of these that applies.
    ///
    /// Vertices of a mesh are one where they are equal in `f32`, as rays see them, whatever their normals. A mesh is closed where each edge
    /// is run along as often one way as the other. It has no volume where the signed volume is within its rounding error of 0.
    #[must_use]
    pub fn warnings(&self) -> Vec<Warning> {
        let transparent = |shape: &&Shape| matches!(self.bsdf(shape.bsdf).kind, BsdfKind::Dielectric { .. });
        let warning = |shape: &Shape| Some(Warning { shape: shape.label.clone(), flaw: flaw(&shape.geometry)? });
        self.shapes.iter().filter(transparent).filter_map(warning).collect()
    }
}

fn flaw(geometry: &Geometry) -> Option<Flaw> {
    match geometry {
        Geometry::Rectangle { .. } | Geometry::Disk { .. } => Some(Flaw::Open { edges: 0 }),
        Geometry::Sphere { inward, .. } => inward.then_some(Flaw::InsideOut),
        Geometry::Mesh(mesh) => boundary_flaw(mesh).or_else(|| volume_flaw(mesh)),
    }
}

/// What is wrong with a mesh as the boundary of a body.
fn boundary_flaw(mesh: &Mesh) -> Option<Flaw> {
    let (mut open, mut two_faced) = (0, 0);
    for [forwards, backwards] in edges(mesh).into_values() {
        open += (forwards + backwards) % 2;
        two_faced += usize::from((forwards + backwards) % 2 == 0 && forwards != backwards);
    }
    match (open, two_faced) {
        (0, 0) => None,
        (0, edges) => Some(Flaw::TwoFaced { edges }),
        (edges, _) => Some(Flaw::Open { edges }),
    }
}

/// The position of a vertex as rays see it; the two zeros are one.
type Place = [u32; 3];

/// How often triangles run along each edge, from its lesser end to the other and back.
fn edges(mesh: &Mesh) -> HashMap<[Place; 2], [usize; 2]> {
    let mut edges = HashMap::new();
    for t in 0..mesh.triangles.len() {
        let places = mesh.corners(t).map(|p| p.as_vec3().to_array().map(|x| (x + 0.0).to_bits()));
        for (a, b) in [(0, 1), (1, 2), (2, 0)].map(|(i, j)| (places[i], places[j])) {
            let counts: &mut [usize; 2] = edges.entry([a.min(b), a.max(b)]).or_default();
            counts[usize::from(b < a)] += 1;
        }
    }
    edges
}

/// What is wrong with the volume of a closed mesh: a sixth of the sum of its corners' determinants.
fn volume_flaw(mesh: &Mesh) -> Option<Flaw> {
    let single = |p: DVec3| p.as_vec3().as_dvec3();
    let origin = single(*mesh.positions.get(*mesh.triangles.first()?.first()? as usize)?);
    let (mut volume, mut magnitude, mut count) = (0.0, 0.0, 0.0);
    for t in 0..mesh.triangles.len() {
        let [a, b, c] = mesh.corners(t).map(single);
        let (from, u, v) = (a - origin, b - a, c - a);
        volume += from.dot(u.cross(v));
        magnitude += from.length() * u.length() * v.length();
        count += 1.0;
    }
    // Each determinant is right to some EPSILON of the product of its lengths, and each addition to one of the sum of these.
    let rounding = (count + 16.0) * f64::EPSILON * magnitude;
    if volume > rounding {
        None
    } else if volume < -rounding {
        Some(Flaw::InsideOut)
    } else {
        Some(Flaw::ZeroVolume)
    }
}
