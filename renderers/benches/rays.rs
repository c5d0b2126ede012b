//! Millions of rays a second, on one thread: closest hit and any hit, by this crate's hierarchy and by obvhs's own
//! traversals of its binary and its compressed wide hierarchy with its default triangle test.
//! `cargo bench -p renderers --bench rays`.
//!
//! The Cornell box is 36 triangles (6 rectangles and two blocks), the mesh an icosphere of 81 920 triangles and the box
//! around it. Coherent rays are those of a camera, row by row; random ones go between points in the box.

#![allow(clippy::expect_used, reason = "the scenes are constants")]

fn main() {
    divan::main();
}

use core::time::Duration;

use divan::counter::ItemsCount;
use divan::{Bencher, black_box};
use obvhs::bvh2::{Bvh2, builder::build_bvh2_from_tris};
use obvhs::cwbvh::{CwBvh, builder::build_cwbvh_from_tris};
use obvhs::{BvhBuildParams, ray::RayHit, triangle::Triangle};
use renderers::geometry::glam::{DAffine3, DVec3, Vec3A};
use renderers::geometry::{Camera, FovAxis, Mesh, Parallelogram, Ray, Surface, World};

const SIDE: u32 = 256;
const SCENES: [Scene; 2] = [Scene::Cornell, Scene::Mesh];
const KINDS: [Kind; 2] = [Kind::Coherent, Kind::Random];

#[derive(Clone, Copy, Debug)]
enum Scene {
    Cornell,
    Mesh,
}

#[derive(Clone, Copy, Debug)]
enum Kind {
    Coherent,
    Random,
}

fn v(x: f32, y: f32, z: f32) -> Vec3A {
    Vec3A::new(x, y, z)
}

fn rectangle(corner: Vec3A, edge_u: Vec3A, edge_v: Vec3A) -> (u32, Surface) {
    (0, Surface::Parallelogram(Parallelogram { corner, edge_u, edge_v }))
}

/// A block on the floor as twelve triangles, turned by `angle`.
fn block(centre: Vec3A, half: Vec3A, angle: f32) -> (u32, Surface) {
    let turn = renderers::geometry::glam::Mat3A::from_rotation_y(angle);
    let corner = |i: u32| {
        let sign = |bit: u32| if i >> bit & 1 == 0 { -1.0 } else { 1.0 };
        centre + turn * (half * v(sign(0), sign(1), sign(2)))
    };
    let positions = (0..8).map(corner).collect();
    let faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let triangles = faces.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    (1, Surface::Mesh(Mesh { positions, triangles, normals: Vec::new() }))
}

fn walls() -> Vec<(u32, Surface)> {
    vec![
        rectangle(v(0.0, 0.0, 0.0), v(0.0, 0.0, 559.0), v(556.0, 0.0, 0.0)),
        rectangle(v(0.0, 549.0, 0.0), v(556.0, 0.0, 0.0), v(0.0, 0.0, 559.0)),
        rectangle(v(0.0, 0.0, 559.0), v(0.0, 549.0, 0.0), v(556.0, 0.0, 0.0)),
        rectangle(v(0.0, 0.0, 0.0), v(0.0, 549.0, 0.0), v(0.0, 0.0, 559.0)),
        rectangle(v(556.0, 0.0, 0.0), v(0.0, 0.0, 559.0), v(0.0, 549.0, 0.0)),
        rectangle(v(213.0, 548.8, 227.0), v(130.0, 0.0, 0.0), v(0.0, 0.0, 105.0)),
    ]
}

fn surfaces(scene: Scene) -> Vec<(u32, Surface)> {
    let mut all = walls();
    match scene {
        Scene::Cornell => {
            all.push(block(v(186.0, 82.5, 169.0), v(82.5, 82.5, 82.5), 0.29));
            all.push(block(v(368.0, 165.0, 351.0), v(82.5, 165.0, 82.5), -0.29));
        }
        Scene::Mesh => all.push((2, Surface::Mesh(icosphere(v(278.0, 274.0, 280.0), 200.0, 6)))),
    }
    all
}

/// A sphere of 20·4ⁿ triangles: the subdivided icosahedron.
fn icosphere(centre: Vec3A, radius: f32, levels: u32) -> Mesh {
    let g = (1.0 + 5.0_f32.sqrt()) / 2.0;
    let mut positions: Vec<Vec3A> = [0, 1, 2]
        .into_iter()
        .flat_map(|axis| [(1.0, g), (-1.0, g), (1.0, -g), (-1.0, -g)].map(|(a, b)| (axis, a, b)))
        .map(|(axis, a, b)| match axis {
            0 => v(0.0, a, b),
            1 => v(b, 0.0, a),
            _ => v(a, b, 0.0),
        })
        .collect();
    let mut triangles = Vec::new();
    for i in 0..12_u32 {
        for j in i + 1..12 {
            for k in j + 1..12 {
                let near = |p: u32, q: u32| positions[p as usize].distance(positions[q as usize]) < 2.1;
                if near(i, j) && near(j, k) && near(i, k) {
                    triangles.push([i, j, k]);
                }
            }
        }
    }
    for _ in 0..levels {
        let mut middles = std::collections::HashMap::new();
        let mut finer = Vec::new();
        for [a, b, c] in triangles {
            let mut middle = |p: u32, q: u32| {
                *middles.entry((p.min(q), p.max(q))).or_insert_with(|| {
                    positions.push((positions[p as usize] + positions[q as usize]) / 2.0);
                    u32::try_from(positions.len() - 1).unwrap_or(0)
                })
            };
            let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
            finer.extend([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]);
        }
        triangles = finer;
    }
    let positions = positions.into_iter().map(|p| centre + p.normalize() * radius).collect();
    Mesh { positions, triangles, normals: Vec::new() }
}

fn triangles(surfaces: &[(u32, Surface)]) -> Vec<Triangle> {
    let mut all = Vec::new();
    for (_, surface) in surfaces {
        match surface {
            Surface::Mesh(mesh) => all.extend(mesh.triangles.iter().map(|t| {
                let [v0, v1, v2] = t.map(|i| mesh.positions[i as usize]);
                Triangle { v0, v1, v2 }
            })),
            Surface::Parallelogram(p) => {
                let [a, b, c, d] = p.corners();
                all.extend([Triangle { v0: a, v1: b, v2: c }, Triangle { v0: a, v1: c, v2: d }]);
            }
            _ => {}
        }
    }
    all
}

/// Uniform in [0, 1), from a counter.
fn unit(counter: &mut u64) -> f32 {
    *counter = counter.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let x = (*counter ^ (*counter >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    f32::from(u16::try_from(x >> 48).unwrap_or(0)) / 65_536.0
}

fn rays(kind: Kind) -> Vec<Ray> {
    match kind {
        Kind::Coherent => {
            let to_world = DAffine3::from_translation(DVec3::new(278.0, 273.0, -800.0));
            let camera = Camera::new(&to_world, 39.3077, FovAxis::Smaller, SIDE, SIDE).expect("a valid camera");
            let position = |i: u32| f32::from(u16::try_from(i).unwrap_or(0)) + 0.5;
            (0..SIDE * SIDE).map(|i| camera.ray(position(i % SIDE), position(i / SIDE))).collect()
        }
        Kind::Random => {
            let mut counter = 7;
            let mut point = || v(unit(&mut counter), unit(&mut counter), unit(&mut counter)) * v(556.0, 548.0, 559.0);
            (0..SIDE * SIDE)
                .map(|_| {
                    let origin = point();
                    Ray::new(origin, (point() - origin).normalize_or(Vec3A::X))
                })
                .collect()
        }
    }
}

/// From the first hits towards the light: what the shadow rays of a Whitted renderer are.
fn shadow_rays(world: &World, kind: Kind) -> Vec<Ray> {
    let mut counter = 11;
    rays(kind)
        .iter()
        .filter_map(|ray| world.closest_hit(ray))
        .map(|hit| {
            let light = v(213.0 + 130.0 * unit(&mut counter), 548.7, 227.0 + 105.0 * unit(&mut counter));
            hit.point().ray_to(light)
        })
        .collect()
}

fn theirs(ray: &Ray) -> obvhs::ray::Ray {
    obvhs::ray::Ray::new(ray.origin, ray.direction, 0.0, ray.t_max)
}

struct Case {
    world: World,
    triangles: Vec<Triangle>,
    bvh2: Bvh2,
    cwbvh: CwBvh,
}

impl Case {
    fn new(scene: Scene) -> Self {
        let surfaces = surfaces(scene);
        let triangles = triangles(&surfaces);
        let parameters = BvhBuildParams { pre_split: false, ..BvhBuildParams::slow_build() };
        Self {
            world: World::new(&surfaces).expect("a valid world"),
            bvh2: build_bvh2_from_tris(&triangles, parameters, &mut Duration::default()),
            cwbvh: build_cwbvh_from_tris(&triangles, parameters, &mut Duration::default()),
            triangles,
        }
    }
}

fn cases() -> impl Iterator<Item = (Scene, Kind)> {
    SCENES.into_iter().flat_map(|scene| KINDS.map(|kind| (scene, kind)))
}

#[derive(Clone, Copy)]
struct Named(Scene, Kind);

impl core::fmt::Debug for Named {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        write!(f, "{:?}_{:?}", self.0, self.1)
    }
}

impl core::fmt::Display for Named {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        write!(f, "{self:?}")
    }
}

fn args() -> Vec<Named> {
    cases().map(|(scene, kind)| Named(scene, kind)).collect()
}

#[divan::bench(args = args())]
fn closest_here(bencher: Bencher, case: Named) {
    let built = Case::new(case.0);
    let rays = rays(case.1);
    bencher
        .counter(ItemsCount::new(rays.len()))
        .bench_local(|| rays.iter().filter(|ray| black_box(built.world.closest_hit(ray)).is_some()).count());
}

#[divan::bench(args = args())]
fn closest_obvhs_bvh2(bencher: Bencher, case: Named) {
    let built = Case::new(case.0);
    let rays: Vec<_> = rays(case.1).iter().map(theirs).collect();
    bencher.counter(ItemsCount::new(rays.len())).bench_local(|| {
        let hits = rays.iter().filter(|ray| {
            let mut hit = RayHit::none();
            let index = &built.bvh2.primitive_indices;
            built.bvh2.ray_traverse(**ray, &mut hit, |r, i| built.triangles[index[i] as usize].intersect(r));
            black_box(hit).t < f32::INFINITY
        });
        hits.count()
    });
}

#[divan::bench(args = args())]
fn closest_obvhs_cwbvh(bencher: Bencher, case: Named) {
    let built = Case::new(case.0);
    let rays: Vec<_> = rays(case.1).iter().map(theirs).collect();
    bencher.counter(ItemsCount::new(rays.len())).bench_local(|| {
        let hits = rays.iter().filter(|ray| {
            let mut hit = RayHit::none();
            let index = &built.cwbvh.primitive_indices;
            built.cwbvh.ray_traverse(**ray, &mut hit, |r, i| built.triangles[index[i] as usize].intersect(r));
            black_box(hit).t < f32::INFINITY
        });
        hits.count()
    });
}

#[divan::bench(args = args())]
fn any_here(bencher: Bencher, case: Named) {
    let built = Case::new(case.0);
    let rays = shadow_rays(&built.world, case.1);
    bencher
        .counter(ItemsCount::new(rays.len()))
        .bench_local(|| rays.iter().filter(|ray| black_box(built.world.any_hit(ray))).count());
}

#[divan::bench(args = args())]
fn any_obvhs_bvh2(bencher: Bencher, case: Named) {
    let built = Case::new(case.0);
    let rays: Vec<_> = shadow_rays(&built.world, case.1).iter().map(theirs).collect();
    bencher.counter(ItemsCount::new(rays.len())).bench_local(|| {
        let index = &built.bvh2.primitive_indices;
        let free = |ray: &&obvhs::ray::Ray| {
            built.bvh2.ray_traverse_miss(**ray, |r, i| built.triangles[index[i] as usize].intersect(r))
        };
        rays.iter().filter(|ray| black_box(free(ray))).count()
    });
}

#[divan::bench(args = args())]
fn any_obvhs_cwbvh(bencher: Bencher, case: Named) {
    let built = Case::new(case.0);
    let rays: Vec<_> = shadow_rays(&built.world, case.1).iter().map(theirs).collect();
    bencher.counter(ItemsCount::new(rays.len())).bench_local(|| {
        let index = &built.cwbvh.primitive_indices;
        let free = |ray: &&obvhs::ray::Ray| {
            built.cwbvh.ray_traverse_miss(**ray, |r, i| built.triangles[index[i] as usize].intersect(r))
        };
        rays.iter().filter(|ray| black_box(free(ray))).count()
    });
}
