//! Rays from inside closed meshes must all hit them: at random, in rows of pixels, and exactly at edges and vertices.
#![allow(clippy::unwrap_used, reason = "the input is constant")]

mod geometry_meshes;

use geometry_meshes::{cube, general_turn, icosphere, placed};
use renderers::geometry::glam::{DMat3, DVec3, Vec3A};
use renderers::geometry::{Mesh, Ray, Surface, World};
use spectral_tests::statistics::Rng;

fn world(mesh: &Mesh) -> World {
    let world = World::new(&[(0, Surface::Mesh(mesh.clone()))]).unwrap();
    world.validate().unwrap();
    world
}

/// Both kinds of query must see the mesh.
fn lost(world: &World, rays: impl Iterator<Item = Ray>) -> (usize, usize) {
    let (mut lost, mut shot) = (0, 0);
    for ray in rays {
        shot += 1;
        lost += usize::from(world.closest_hit(&ray).is_none()) + usize::from(!world.any_hit(&ray));
    }
    (lost, shot)
}

fn random_rays(seed: u64, count: u32, radius: f64, centre: DVec3) -> impl Iterator<Item = Ray> {
    let mut rng = Rng::new(seed);
    (0..count).map(move |_| {
        let inside = DVec3::from_array(rng.direction()) * rng.unit().cbrt() * radius;
        let direction = DVec3::from_array(rng.direction());
        Ray::new((centre + inside).as_vec3a(), direction.as_vec3a())
    })
}

/// A cube map of n × n pixels a side seen from `origin`, with the centres of pixels on simple fractions.
fn coherent_rays(origin: Vec3A, n: u16) -> impl Iterator<Item = Ray> {
    let axes = [Vec3A::X, Vec3A::Y, Vec3A::Z, -Vec3A::X, -Vec3A::Y, -Vec3A::Z];
    (0..6_usize).flat_map(move |side| {
        (0..n).flat_map(move |i| {
            (0..n).map(move |j| {
                let film = |k: u16| 2.0 * f32::from(k) / f32::from(n) - 1.0;
                let direction = axes[side] + axes[(side + 1) % 3] * film(i) + axes[(side + 2) % 3] * film(j);
                Ray::new(origin, direction)
            })
        })
    })
}

/// From `origin` to every vertex, and to five points of every edge.
fn rays_to_edges(mesh: &Mesh, origin: Vec3A) -> impl Iterator<Item = Ray> {
    mesh.triangles.iter().flat_map(move |triangle| {
        (0..3).flat_map(move |side| {
            let [p, q] = [side, (side + 1) % 3].map(|i| mesh.positions[triangle[i] as usize]);
            [0.0, 0.1, 0.25, 0.5, 0.75, 0.9].into_iter().map(move |s| Ray::new(origin, p + (q - p) * s - origin))
        })
    })
}

/// Along the axes through the vertices themselves: two direction components are zero and the ray starts in the planes
/// of boxes and edges.
fn axis_rays(mesh: &Mesh) -> impl Iterator<Item = Ray> {
    let axes = [Vec3A::X, Vec3A::Y, Vec3A::Z];
    mesh.positions.iter().flat_map(move |p| {
        axes.into_iter().filter(move |axis| p.dot(*axis).abs() < 0.5).flat_map(move |axis| {
            let other = *p * (Vec3A::ONE - axis);
            [Ray::new(other, axis), Ray::new(other, -axis)]
        })
    })
}

#[test]
fn no_ray_leaves_a_closed_mesh() {
    let mut total = 0;
    let placements = [
        (DMat3::IDENTITY, 1.0, DVec3::ZERO),
        (general_turn(), 1.0, DVec3::new(3.0, -7.0, 11.0)),
        (general_turn(), 1e-3, DVec3::ZERO),
        (general_turn(), 550.0, DVec3::splat(270.0)),
        (DMat3::IDENTITY, 1e6, DVec3::new(1e6, 0.0, -3e5)),
    ];
    for (number, mesh) in [icosphere(4), cube(20)].into_iter().enumerate() {
        for (turn, scale, shift) in placements {
            let mesh = placed(mesh.clone(), turn, scale, shift);
            let world = world(&mesh);
            let centre = shift.as_vec3a();
            let aside = (shift + turn * DVec3::new(0.3, -0.2, 0.1) * scale).as_vec3a();
            let runs = [
                lost(&world, random_rays(17, 40_000, 0.95 * scale, shift)),
                lost(&world, coherent_rays(centre, 90)),
                lost(&world, coherent_rays(aside, 60)),
                lost(&world, rays_to_edges(&mesh, centre)),
                lost(&world, rays_to_edges(&mesh, aside)),
            ];
            assert_eq!(runs.map(|run| run.0), [0; 5], "mesh {number}, scale {scale}");
            total += runs.iter().map(|run| run.1).sum::<usize>();
        }
    }
    assert!(total >= 1_000_000, "{total} rays are too few");
}

#[test]
fn no_ray_along_an_axis_leaves_through_an_edge() {
    for mesh in [cube(1), cube(2), cube(7), cube(32), icosphere(0), icosphere(4)] {
        let (lost, shot) = lost(&world(&mesh), axis_rays(&mesh));
        assert_eq!(lost, 0, "{} triangles", mesh.triangles.len());
        assert!(shot > 0 || mesh.triangles.len() == 12);
    }
}

/// The control: the test of Möller and Trumbore in `f32` loses some of the rays above, so that a leak would be seen.
#[test]
fn a_test_that_is_not_watertight_would_fail() {
    let mesh = placed(cube(10), general_turn(), 1.0, DVec3::new(3.0, -7.0, 11.0));
    let origin = DVec3::new(3.2, -7.1, 11.1).as_vec3a();
    let triangle = |t: &[u32; 3]| t.map(|i| mesh.positions[i as usize]);
    let hit = |ray: &Ray| mesh.triangles.iter().any(|t| moeller_trumbore(ray, triangle(t)));
    let lost = rays_to_edges(&mesh, origin).filter(|ray| !hit(ray)).count();
    assert!(lost > 0);
}

fn moeller_trumbore(ray: &Ray, [a, b, c]: [Vec3A; 3]) -> bool {
    let (e1, e2, s) = (b - a, c - a, ray.origin - a);
    let p = ray.direction.cross(e2);
    let inverse = 1.0 / e1.dot(p);
    let u = s.dot(p) * inverse;
    let q = s.cross(e1);
    let v = ray.direction.dot(q) * inverse;
    u >= 0.0 && v >= 0.0 && u + v <= 1.0 && e2.dot(q) * inverse >= 0.0
}
