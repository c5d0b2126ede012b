//! Closed meshes for the geometry tests.
#![allow(dead_code, reason = "each test uses some of it")]
#![allow(clippy::unwrap_used, reason = "the meshes are constants")]

use std::collections::HashMap;

use renderers::geometry::Mesh;
use renderers::geometry::glam::{DMat3, DVec3, Vec3A};

/// A sphere of 20·4ⁿ triangles, subdivided from the icosahedron, of radius 1.
pub(crate) fn icosphere(levels: u32) -> Mesh {
    let g = (1.0 + 5.0_f64.sqrt()) / 2.0;
    let signs = [(1.0, g), (-1.0, g), (1.0, -g), (-1.0, -g)];
    let mut points: Vec<DVec3> = Vec::new();
    for (a, b) in signs {
        points.extend([DVec3::new(0.0, a, b), DVec3::new(b, 0.0, a), DVec3::new(a, b, 0.0)]);
    }
    let mut triangles = icosahedron_faces(&points);
    for _ in 0..levels {
        triangles = subdivide(&triangles, &mut points);
    }
    Mesh { positions: points.iter().map(|p| p.normalize().as_vec3a()).collect(), triangles, normals: Vec::new() }
}

fn icosahedron_faces(points: &[DVec3]) -> Vec<[u32; 3]> {
    let mut faces = Vec::new();
    let near = |p: usize, q: usize| points[p].distance(points[q]) < 2.1;
    for (i, j, k) in (0..12).flat_map(|i| (0..12).flat_map(move |j| (0..12).map(move |k| (i, j, k)))) {
        let outward = points[i].dot((points[j] - points[i]).cross(points[k] - points[i])) > 0.0;
        if i < j && i < k && j != k && near(i, j) && near(j, k) && near(i, k) && outward {
            faces.push([i, j, k].map(|n| u32::try_from(n).unwrap()));
        }
    }
    faces
}

fn subdivide(triangles: &[[u32; 3]], points: &mut Vec<DVec3>) -> Vec<[u32; 3]> {
    let mut middles = HashMap::new();
    let mut finer = Vec::new();
    for &[a, b, c] in triangles {
        let mut middle = |p: u32, q: u32| {
            *middles.entry((p.min(q), p.max(q))).or_insert_with(|| {
                points.push((points[p as usize] + points[q as usize]) / 2.0);
                u32::try_from(points.len() - 1).unwrap()
            })
        };
        let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
        finer.extend([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]);
    }
    finer
}

/// The cube [−1, 1]³ with n × n squares of two triangles on each side.
pub(crate) fn cube(n: u32) -> Mesh {
    let mut index = HashMap::new();
    let mut mesh = Mesh::default();
    for side in 0..6_u32 {
        let mut vertex = |i: u32, j: u32| {
            let mut p = [0; 3];
            p[(side % 3) as usize] = if side < 3 { 0 } else { n };
            p[((side + 1) % 3) as usize] = i;
            p[((side + 2) % 3) as usize] = j;
            *index.entry(p).or_insert_with(|| {
                let x = p.map(|k| 2.0 * f64::from(k) / f64::from(n) - 1.0);
                mesh.positions.push(DVec3::from_array(x).as_vec3a());
                u32::try_from(mesh.positions.len() - 1).unwrap()
            })
        };
        for (i, j) in (0..n).flat_map(|i| (0..n).map(move |j| (i, j))) {
            let [a, b, c, d] = [vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1), vertex(i, j + 1)];
            // Outward: axes i, j follow the side's axis cyclically.
            let two = if side < 3 { [[a, c, b], [a, d, c]] } else { [[a, b, c], [a, c, d]] };
            mesh.triangles.extend(two);
        }
    }
    mesh
}

/// The mesh turned by a general rotation, scaled, moved.
pub(crate) fn placed(mut mesh: Mesh, turn: DMat3, scale: f64, shift: DVec3) -> Mesh {
    let place = |p: &Vec3A| (turn * p.as_dvec3() * scale + shift).as_vec3a();
    mesh.positions = mesh.positions.iter().map(place).collect();
    mesh
}

/// A rotation with no axis among the coordinate axes.
pub(crate) fn general_turn() -> DMat3 {
    DMat3::from_axis_angle(DVec3::new(1.0, 2.0, -3.0).normalize(), 0.7)
}
