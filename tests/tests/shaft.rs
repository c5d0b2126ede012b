//! Shaft culling against shadow rays: a shaft that is called clear lets every ray through, and pictures don't change by it.
#![allow(clippy::unwrap_used, reason = "helpers of tests fail by panicking")]

use std::collections::HashMap;

use renderers::geometry::glam::{DMat3, DQuat, DVec3, Vec3A};
use renderers::geometry::sampling::SobolSequence;
use renderers::geometry::{
    Disk, Hit, Mesh, NO_PRIMITIVE, Parallelogram, Ray, Shaft, ShaftEnd, Sphere, Surface, SurfacePoint, World,
};
use renderers::scene::builtin;
use renderers::spectral::{FactorOrder, Palette, Radiance, Tracer};
use renderers::whitted::{Whitted, Worker};
use spectral_tests::statistics::Rng;

/// Voxels along the longest side of a random scene.
const VOXELS: f64 = 12.0;

/// A light of a random scene, in `f64` as renderers have it.
#[derive(Clone, Copy, Debug)]
enum Light {
    Rectangle { centre: DVec3, u: DVec3, v: DVec3 },
    Disk { centre: DVec3, u: DVec3, v: DVec3 },
    Ball { centre: DVec3, radius: f64 },
}

/// A random scene: surfaces, and the light that is the last of them.
struct Setting {
    surfaces: Vec<(u32, Surface)>,
    light: Light,
}

fn between(rng: &mut Rng, low: f64, high: f64) -> f64 {
    low + (high - low) * rng.unit()
}

fn vector(rng: &mut Rng, size: f64) -> DVec3 {
    DVec3::from_array([0; 3].map(|_| between(rng, -size, size)))
}

/// Where a scene stands in the world: turned, scaled and moved as a whole, or not at all.
#[derive(Clone, Copy)]
struct Place {
    linear: DMat3,
    offset: DVec3,
}

impl Place {
    fn random(rng: &mut Rng) -> Self {
        let turn = DQuat::from_axis_angle(DVec3::from_array(rng.direction()), between(rng, 0.0, 3.0));
        match rng.bits() % 3 {
            0 => Self { linear: DMat3::IDENTITY, offset: DVec3::ZERO },
            1 => Self { linear: DMat3::from_quat(turn), offset: DVec3::ZERO },
            _ => Self { linear: DMat3::from_quat(turn) * 300.0, offset: vector(rng, 400.0) },
        }
    }

    fn point(&self, p: DVec3) -> DVec3 {
        self.linear * p + self.offset
    }

    fn scale(&self) -> f64 {
        self.linear.x_axis.length()
    }

    fn mesh(&self, positions: &[DVec3], triangles: &[[u32; 3]]) -> Surface {
        let positions = positions.iter().map(|p| self.point(*p).as_vec3a()).collect();
        Surface::Mesh(Mesh { positions, triangles: triangles.to_vec(), normals: Vec::new() })
    }

    fn parallelogram(&self, corner: DVec3, u: DVec3, v: DVec3) -> Surface {
        let [edge_u, edge_v] = [u, v].map(|e| (self.linear * e).as_vec3a());
        Surface::Parallelogram(Parallelogram { corner: self.point(corner).as_vec3a(), edge_u, edge_v })
    }
}

/// A block with its base on y = `base`, turned about the vertical.
fn block(rng: &mut Rng, base: f64) -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let turn = DQuat::from_rotation_y(between(rng, 0.0, 3.0));
    let half = DVec3::new(between(rng, 0.05, 0.3), between(rng, 0.05, 0.4), between(rng, 0.05, 0.3));
    let centre = DVec3::new(between(rng, -0.7, 0.7), base + half.y, between(rng, -0.7, 0.7));
    let corner = |i: u32| {
        let sign = |bit: u32| if i >> bit & 1 == 0 { -1.0 } else { 1.0 };
        let mut corner = centre + turn * (half * DVec3::new(sign(0), sign(1), sign(2)));
        corner.y = if sign(1) < 0.0 { base } else { base + 2.0 * half.y };
        corner
    };
    let faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let triangles = faces.iter().flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]]).collect();
    ((0..8).map(corner).collect(), triangles)
}

/// A room from −1 to 1 with an opening in the ceiling, which blocks, balls and sheets are put in.
fn setting(rng: &mut Rng) -> Setting {
    let place = Place::random(rng);
    let mut surfaces = Vec::new();
    let corner = |x: f64, y: f64, z: f64| DVec3::new(x, y, z);
    let floor = [corner(-1.0, -1.0, -1.0), corner(-1.0, -1.0, 1.0), corner(1.0, -1.0, 1.0), corner(1.0, -1.0, -1.0)];
    surfaces.push(place.mesh(&floor, &[[0, 1, 2], [0, 2, 3]]));
    surfaces.push(place.parallelogram(corner(-1.0, -1.0, -1.0), DVec3::X * 2.0, DVec3::Y * 2.0));
    surfaces.push(place.parallelogram(corner(-1.0, -1.0, -1.0), DVec3::Y * 2.0, DVec3::Z * 2.0));
    surfaces.push(place.parallelogram(corner(1.0, -1.0, -1.0), DVec3::Z * 2.0, DVec3::Y * 2.0));
    let hole = between(rng, 0.1, 0.5);
    let ring: Vec<DVec3> = [1.0, hole]
        .into_iter()
        .flat_map(|r| [(-r, -r), (r, -r), (r, r), (-r, r)].map(|(x, z)| corner(x, 1.0, z)))
        .collect();
    let frame: Vec<[u32; 3]> =
        (0..4).flat_map(|i: u32| [[i, (i + 1) % 4, i + 4], [(i + 1) % 4, (i + 1) % 4 + 4, i + 4]]).collect();
    surfaces.push(place.mesh(&ring, &frame));
    for _ in 0..rng.bits() % 3 {
        let (positions, triangles) = block(rng, -1.0);
        surfaces.push(place.mesh(&positions, &triangles));
    }
    for _ in 0..rng.bits() % 3 {
        let radius = between(rng, 0.05, 0.2);
        let centre = DVec3::new(between(rng, -0.7, 0.7), radius - 1.0, between(rng, -0.7, 0.7));
        #[allow(clippy::cast_possible_truncation, reason = "surfaces are f32")]
        let radius = (radius * place.scale()) as f32;
        surfaces.push(Surface::Sphere(Sphere { centre: place.point(centre).as_vec3a(), radius, inward: false }));
    }
    for _ in 0..rng.bits() % 3 {
        surfaces.push(place.parallelogram(vector(rng, 0.7), vector(rng, 0.3), vector(rng, 0.3)));
    }
    if rng.bits().is_multiple_of(3) {
        let (centre, normal) = (place.point(vector(rng, 0.7)), DVec3::from_array(rng.direction()));
        #[allow(clippy::cast_possible_truncation, reason = "surfaces are f32")]
        let radius = (0.2 * place.scale()) as f32;
        surfaces.push(Surface::Disk(Disk::new(centre.as_vec3a(), normal.as_vec3a(), radius)));
    }
    let light = light(rng, hole, place);
    surfaces.push(surface_of(&light));
    Setting { surfaces: (0..).zip(surfaces).collect(), light }
}

fn light(rng: &mut Rng, hole: f64, place: Place) -> Light {
    let (centre, u, v) = match rng.bits() % 4 {
        // Fills the opening of the ceiling.
        0 => (DVec3::Y, DVec3::X * hole, DVec3::Z * hole),
        // Stands on the floor.
        1 => (DVec3::new(0.0, -0.8, -0.5), DVec3::X * 0.3, DVec3::Y * 0.2),
        _ => {
            let (u, v) = DVec3::from_array(rng.direction()).any_orthonormal_pair();
            (vector(rng, 0.6), u * between(rng, 0.05, 0.3), v * between(rng, 0.05, 0.3))
        }
    };
    let (centre, u, v) = (place.point(centre), place.linear * u, place.linear * v);
    match rng.bits() % 3 {
        0 => Light::Rectangle { centre, u, v },
        1 => {
            let radius = u.length().min(v.length());
            Light::Disk { centre, u: u.normalize() * radius, v: v.normalize() * radius }
        }
        _ => Light::Ball { centre, radius: 0.4 * u.length().min(v.length()) },
    }
}

#[allow(clippy::cast_possible_truncation, reason = "surfaces are f32")]
fn surface_of(light: &Light) -> Surface {
    match *light {
        Light::Rectangle { centre, u, v } => Surface::Parallelogram(Parallelogram {
            corner: (centre - u - v).as_vec3a(),
            edge_u: (u * 2.0).as_vec3a(),
            edge_v: (v * 2.0).as_vec3a(),
        }),
        Light::Disk { centre, u, v } => {
            Surface::Disk(Disk { centre: centre.as_vec3a(), axis_u: u.as_vec3a(), axis_v: v.as_vec3a() })
        }
        Light::Ball { centre, radius } => {
            Surface::Sphere(Sphere { centre: centre.as_vec3a(), radius: radius as f32, inward: false })
        }
    }
}

impl Light {
    /// The end of shafts to it.
    fn end(&self, primitive: u32) -> ShaftEnd {
        match *self {
            Self::Rectangle { centre, u, v } => {
                let corners = [centre - u - v, centre + u - v, centre + u + v, centre - u + v];
                ShaftEnd::polygon(&corners, u.cross(v).normalize(), primitive)
            }
            Self::Disk { centre, u, v } => {
                let corners = [centre - u - v, centre + u - v, centre + u + v, centre - u + v];
                ShaftEnd::polygon(&corners, u.cross(v).normalize(), primitive)
            }
            Self::Ball { centre, radius } => ShaftEnd::within(centre - radius, centre + radius, primitive),
        }
    }

    /// A random point of it that may be seen from `from`, with its normal; often at the rim.
    fn point(&self, rng: &mut Rng, from: DVec3) -> (DVec3, DVec3) {
        let coordinate = |rng: &mut Rng| match rng.bits() % 4 {
            0 => 0.999,
            1 => -0.999,
            _ => between(rng, -0.999, 0.999),
        };
        let (a, b) = (coordinate(rng), coordinate(rng));
        match *self {
            Self::Rectangle { centre, u, v } => (centre + u * a + v * b, u.cross(v).normalize()),
            Self::Disk { centre, u, v } => {
                let (sin, cos) = (b * core::f64::consts::PI).sin_cos();
                (centre + (u * cos + v * sin) * a, u.cross(v).normalize())
            }
            Self::Ball { centre, radius } => {
                let normal = DVec3::from_array(rng.direction());
                let normal = if normal.dot(from - centre) < 0.0 { -normal } else { normal };
                (centre + normal * radius, normal)
            }
        }
    }
}

/// A random point of a planar surface, as a hit of a short ray against it; `None` if something else is in the way.
fn receiver(rng: &mut Rng, world: &World, setting: &Setting) -> Option<Hit> {
    let index = usize::try_from(rng.bits()).unwrap() % (setting.surfaces.len() - 1);
    let (a, b) = (rng.unit(), rng.unit());
    let (point, normal) = match &setting.surfaces[index].1 {
        Surface::Mesh(mesh) => {
            let triangle = mesh.triangles[usize::try_from(rng.bits()).unwrap() % mesh.triangles.len()];
            let [p, q, r] = triangle.map(|i| mesh.positions[i as usize].as_dvec3());
            let (a, b) = if a + b > 1.0 { (1.0 - a, 1.0 - b) } else { (a, b) };
            (p + (q - p) * a + (r - p) * b, (q - p).cross(r - p))
        }
        Surface::Parallelogram(p) => {
            let (u, v) = (p.edge_u.as_dvec3(), p.edge_v.as_dvec3());
            (p.corner.as_dvec3() + u * a + v * b, u.cross(v))
        }
        _ => return None,
    };
    let side =
        if rng.bits().is_multiple_of(4) { -normal } else { normal }.normalize() * (1e-3 * point.length().max(0.1));
    let hit = world.closest_hit(&Ray::new((point + side).as_vec3a(), (-side).as_vec3a()))?;
    (hit.shape as usize == index).then_some(hit)
}

/// The voxel of a point, as its low corner and width.
fn voxel(world: &World, position: Vec3A) -> ([i32; 3], DVec3, f64) {
    let [low, high] = world.bounds().map(Vec3A::as_dvec3);
    let width = (high - low).max_element() / VOXELS;
    let place = ((position.as_dvec3() - low) / width).floor();
    (place.as_ivec3().to_array(), low + place * width, width)
}

/// Whether a ray goes to the light, by more than rounding, and whether it is blocked.
fn shadow_ray(world: &World, hit: &Hit, light: (DVec3, DVec3), primitive: u32, scale: f64) -> Option<bool> {
    let way = light.0 - hit.position.as_dvec3();
    let least = 1e-5 * scale;
    let is_above = way.dot(hit.facing_normal().as_dvec3()) > least && -way.dot(light.1) > least;
    let target = SurfacePoint::new(light.0.as_vec3a(), light.1.as_vec3a()).on(primitive);
    is_above.then(|| world.occluded(&hit.point(), &target))
}

#[derive(Default)]
struct Cell {
    clear: bool,
    rays: u32,
    blocked: u32,
}

#[derive(Debug, Default)]
struct Tally {
    /// Rays in clear cells, blocked rays elsewhere.
    free: u32,
    blocked: u32,
    /// Cells where many rays all came through, and those of them that were called clear.
    open: u32,
    open_clear: u32,
    /// Blockers put into clear shafts.
    controls: u32,
}

/// A triangle about a point, across a direction.
fn obstacle(rng: &mut Rng, centre: DVec3, along: DVec3, size: f64) -> Surface {
    let (u, v) = along.normalize().any_orthonormal_pair();
    let tilt = DVec3::from_array(rng.direction()) * 0.3;
    let corners = [u + tilt, -0.5 * u + 0.8 * v, -0.5 * u - 0.8 * v - tilt].map(|c| (centre + c * size).as_vec3a());
    Surface::Mesh(Mesh { positions: corners.to_vec(), triangles: vec![[0, 1, 2]], normals: Vec::new() })
}

/// The negative control: with an obstacle on the way, neither the ray nor the shaft is free.
fn check_control(rng: &mut Rng, setting: &Setting, hit: &Hit, target: (DVec3, DVec3), scale: f64) {
    let from = hit.position.as_dvec3();
    let way = target.0 - from;
    let middle = from + way * between(rng, 0.2, 0.8);
    let mut surfaces = setting.surfaces.clone();
    let light = surfaces.pop().unwrap();
    // The numbers of primitives before it don't change.
    surfaces.push((1000, obstacle(rng, middle, way, 1e-4 * scale)));
    surfaces.push(light);
    let world = World::new(&surfaces).unwrap();
    let primitive = light_primitive(&world, setting, 1);
    let (_, low, width) = voxel(&world, hit.position);
    let end = world.shaft_end(hit.primitive, hit.front, low, low + width).unwrap();
    assert!(!world.shaft_is_clear(&Shaft::between(&end, &setting.light.end(primitive))));
    assert_eq!(shadow_ray(&world, hit, target, NO_PRIMITIVE, scale), Some(true));
}

fn light_primitive(world: &World, setting: &Setting, more: usize) -> u32 {
    world.primitives(setting.surfaces.len() - 1 + more).start
}

fn check_setting(rng: &mut Rng, tally: &mut Tally) {
    let setting = setting(rng);
    let world = World::new(&setting.surfaces).unwrap();
    let primitive = light_primitive(&world, &setting, 0);
    // Rays to a ball end on its surface, so that it isn't left out.
    let target_primitive = if matches!(setting.light, Light::Ball { .. }) { NO_PRIMITIVE } else { primitive };
    let to = setting.light.end(primitive);
    let [low, high] = world.bounds().map(Vec3A::as_dvec3);
    let scale = (high - low).max_element().max(low.abs().max(high.abs()).max_element());
    let mut cells: HashMap<(u32, bool, [i32; 3]), Cell> = HashMap::new();
    for _ in 0..6000 {
        let Some(hit) = receiver(rng, &world, &setting) else { continue };
        let (number, low, width) = voxel(&world, hit.position);
        let cell = cells.entry((hit.primitive, hit.front, number)).or_insert_with(|| {
            let from = world.shaft_end(hit.primitive, hit.front, low, low + width);
            let clear = from.is_some_and(|from| world.shaft_is_clear(&Shaft::between(&from, &to)));
            Cell { clear, ..Cell::default() }
        });
        for _ in 0..6 {
            let target = setting.light.point(rng, hit.position.as_dvec3());
            let Some(blocked) = shadow_ray(&world, &hit, target, target_primitive, scale) else { continue };
            assert!(!(cell.clear && blocked), "{hit:?} to {target:?} of {:?}", setting.light);
            cell.rays += 1;
            cell.blocked += u32::from(blocked);
            if cell.clear && rng.bits().is_multiple_of(256) {
                check_control(rng, &setting, &hit, target, scale);
                tally.controls += 1;
            }
        }
    }
    for cell in cells.values() {
        tally.free += if cell.clear { cell.rays } else { 0 };
        tally.blocked += cell.blocked;
        let is_open = cell.rays >= 20 && cell.blocked == 0;
        tally.open += u32::from(is_open);
        tally.open_clear += u32::from(is_open && cell.clear);
    }
}

/// `independent`: shadow rays, in scenes with contacts, coplanar neighbours and lights in every position.
#[test]
fn no_ray_of_a_clear_shaft_is_blocked() {
    let mut tally = Tally::default();
    for seed in 0..150 {
        check_setting(&mut Rng::new(seed), &mut tally);
    }
    println!("{tally:?}");
    // Enough of each kind to have found a fault, and shafts that are tight: most cells that look open are known to be.
    assert!(tally.free > 100_000 && tally.blocked > 100_000 && tally.controls > 500, "{tally:?}");
    assert!(10 * tally.open_clear > 7 * tally.open, "{tally:?}");
}

/// A wall that only touches a floor, at its edge, is no blocker; the same wall moved over the floor is.
#[test]
fn contact_at_an_edge_does_not_block() {
    let sheet = |corner: DVec3, u: DVec3, v: DVec3| {
        let [corner, edge_u, edge_v] = [corner, u, v].map(DVec3::as_vec3a);
        Surface::Parallelogram(Parallelogram { corner, edge_u, edge_v })
    };
    let lamp = [(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)].map(|(x, z)| DVec3::new(x + 1.0, 2.0, z + 0.5));
    let to = ShaftEnd::polygon(&lamp, -DVec3::Y, NO_PRIMITIVE);
    for (shift, expected) in [(0.0, true), (1e-3, false)] {
        let floor = sheet(DVec3::ZERO, DVec3::Z, DVec3::X * 2.0);
        let wall = sheet(DVec3::X * shift, DVec3::Y * 3.0, DVec3::Z);
        let world = World::new(&[(0, floor), (1, wall)]).unwrap();
        let from = world.shaft_end(0, true, DVec3::splat(-1.0), DVec3::new(0.25, 1.0, 1.0)).unwrap();
        assert_eq!(world.shaft_is_clear(&Shaft::between(&from, &to)), expected);
    }
}

/// Products of spectra, by their leaves, with their weights.
type Gathered = Vec<(Vec<u32>, f64)>;

/// The light gathered for each pixel, in the order of `pixels`: numbers of products depend on it, their leaves don't.
fn gather(scene: &Whitted, pixels: impl Iterator<Item = (u32, u32)>) -> HashMap<(u32, u32), Gathered> {
    let mut worker = Worker::new(scene, FactorOrder::Free);
    let sample = |(x, y): (u32, u32)| {
        let mut radiance = Radiance::default();
        worker.start_pixel(SobolSequence::new(0));
        worker.sample(f64::from(x) + 0.5, f64::from(y) + 0.5, 1.0, &mut radiance);
        let leaves = |monomial| worker.monomials().leaves(monomial).to_vec();
        ((x, y), radiance.terms().iter().map(|(monomial, weight)| (leaves(*monomial), *weight)).collect())
    };
    pixels.map(sample).collect()
}

fn total(light: &Gathered) -> f64 {
    light.iter().map(|(_, weight)| weight).sum()
}

/// How far the lattice of shadow rays is off where a light is partly hidden, relative to the brightest pixel: a few of its 256 cells are
/// taken wrongly, more where the shadow's edge is thinner than the coarsest cells.
const LATTICE: f64 = 0.03;
/// Its error on the average over all pixels, signs counted.
const BIAS: f64 = 3e-4;

/// Where nothing is in the way, closed forms and shadow rays give the same; along shadows' edges they differ by the lattice's error.
#[test]
fn pictures_are_the_same_without_culling() {
    const SIZE: u32 = 96;
    for name in ["cornell-box", "cornell-box-paper", "cornell-box-spheres"] {
        let scene = builtin::load(name, &[]).unwrap();
        let whitted = || Whitted::new(&scene, [SIZE; 2], &mut Palette::default()).unwrap();
        let pixels = || (0..SIZE * SIZE).map(|i| (i % SIZE, i / SIZE));
        let with = gather(&whitted(), pixels());
        let without = gather(&whitted().without_shaft_culling(), pixels());
        // What is known of cells doesn't depend on who asked first.
        assert!(with == gather(&whitted(), pixels().collect::<Vec<_>>().into_iter().rev()), "{name}");
        let brightest = without.values().map(total).fold(0.0, f64::max);
        let (mut differing, mut bias) = (0, 0.0);
        for pixel in pixels().filter(|pixel| with[pixel] != without[pixel]) {
            let more = (total(&with[&pixel]) - total(&without[&pixel])) / brightest;
            assert!(more.abs() <= LATTICE, "{name} {pixel:?}: {more}");
            bias += more / f64::from(SIZE * SIZE);
            differing += 1;
        }
        println!("{name}: {differing} of {} pixels differ, by {bias:e} on average", SIZE * SIZE);
        assert!(bias.abs() <= BIAS && 3 * differing < SIZE * SIZE, "{name}: {differing} {bias}");
    }
}
