//! Pairs of adjacent triangles: two are tested for less than twice the price of one, and boxes are half as many.

use std::collections::HashMap;

use glam::Vec3A;

use super::packet::{Half, Pair};
use super::surface::Mesh;

/// A pair's box may have at most this many times the area of its triangles' boxes together.
const MOST_GROWTH: f32 = 1.1;

/// The pairs of a mesh whose first triangle is primitive `first`: each triangle with the unpaired neighbour that makes
/// the smallest box, in the order of the triangles. The indices must have been checked.
pub(super) fn pair_up(mesh: &Mesh, first: u32) -> Vec<Pair> {
    let edges = directed_edges(mesh);
    let mut paired = vec![false; mesh.triangles.len()];
    let mut pairs = Vec::with_capacity(mesh.triangles.len() / 2 + 1);
    for triangle in 0..mesh.triangles.len() {
        if paired[triangle] {
            continue;
        }
        paired[triangle] = true;
        let neighbours = (0..3).filter_map(|side| neighbour(mesh, &edges, triangle, side));
        let free = neighbours.filter(|n| !paired[n.triangle] && n.growth <= MOST_GROWTH);
        let best = free.min_by(|a, b| a.growth.total_cmp(&b.growth));
        if let Some(other) = &best {
            paired[other.triangle] = true;
        }
        pairs.push(pair(mesh, triangle, best.as_ref(), first));
    }
    pairs
}

/// A triangle across an edge.
struct Neighbour {
    triangle: usize,
    /// The vertex of the first triangle after which the shared edge starts.
    side: usize,
    /// The vertex of the neighbour at which the shared edge starts, seen from there.
    start: usize,
    growth: f32,
}

/// Which triangle, and which side of it, has each directed edge. Where several have it, the last.
fn directed_edges(mesh: &Mesh) -> HashMap<(u32, u32), (usize, usize)> {
    let mut edges = HashMap::with_capacity(3 * mesh.triangles.len());
    for (triangle, vertices) in mesh.triangles.iter().enumerate() {
        for side in 0..3 {
            edges.insert((vertices[side], vertices[(side + 1) % 3]), (triangle, side));
        }
    }
    edges
}

fn neighbour(
    mesh: &Mesh,
    edges: &HashMap<(u32, u32), (usize, usize)>,
    triangle: usize,
    side: usize,
) -> Option<Neighbour> {
    let vertices = mesh.triangles[triangle];
    let (other, start) = *edges.get(&(vertices[(side + 1) % 3], vertices[side]))?;
    let (ours, theirs) = (corners(mesh, triangle), corners(mesh, other));
    let growth = half_area(&[ours, theirs].concat()) / (half_area(&ours) + half_area(&theirs));
    (other != triangle).then_some(Neighbour { triangle: other, side, start, growth })
}

fn corners(mesh: &Mesh, triangle: usize) -> [Vec3A; 3] {
    mesh.triangles[triangle].map(|i| mesh.positions[i as usize])
}

fn half_area(points: &[Vec3A]) -> f32 {
    let low = points.iter().fold(Vec3A::INFINITY, |low, p| low.min(*p));
    let high = points.iter().fold(Vec3A::NEG_INFINITY, |high, p| high.max(*p));
    let d = high - low;
    d.x * d.y + d.y * d.z + d.z * d.x
}

/// The shared edge goes from vertex 2 to vertex 0 of the first triangle, and from vertex 0 to vertex 1 of the second.
fn pair(mesh: &Mesh, triangle: usize, neighbour: Option<&Neighbour>, first: u32) -> Pair {
    let primitive = |triangle: usize| first + u32::try_from(triangle).unwrap_or(0);
    let rotation = neighbour.map_or(0, |n| (n.side + 1) % 3);
    let number = |rotation: usize| u32::try_from(rotation).unwrap_or(0);
    let rotate = |v: [Vec3A; 3], r: usize| [v[r % 3], v[(r + 1) % 3], v[(r + 2) % 3]];
    let [a, b, c] = rotate(corners(mesh, triangle), rotation);
    let (d, other) = match neighbour {
        Some(n) => {
            let half = Half { primitive: primitive(n.triangle), rotation: number(n.start) };
            (rotate(corners(mesh, n.triangle), n.start)[2], half)
        }
        None => (c, Half::MISSING),
    };
    Pair {
        vertices: [a, b, c, d],
        halves: [Half { primitive: primitive(triangle), rotation: number(rotation) }, other],
    }
}
