//! Hits against a naive oracle, secondary rays at every scale, shadow rays to lights of every kind, refused input.

mod geometry_meshes;

use geometry_meshes::{cube, general_turn, icosphere, placed};
use renderers::geometry::glam::{DMat3, DVec3, Vec3A};
use renderers::geometry::sampling::square_to_cosine_hemisphere;
use renderers::geometry::{
    Disk, GeometryError, Hit, Mesh, NO_PRIMITIVE, Parallelogram, Ray, Sphere, Surface, SurfacePoint, World,
};
use spectral_tests::statistics::Rng;

const SCALES: [f64; 4] = [1e-3, 1.0, 550.0, 1e6];

fn v(x: f32, y: f32, z: f32) -> Vec3A {
    Vec3A::new(x, y, z)
}

fn random_point(rng: &mut Rng) -> Vec3A {
    v(rng.unit_f32() - 0.5, rng.unit_f32() - 0.5, rng.unit_f32() - 0.5)
}

fn random_direction(rng: &mut Rng) -> Vec3A {
    DVec3::from_array(rng.direction()).as_vec3a()
}

/// Around `normal`, with a cosine density.
fn bounce(normal: Vec3A, rng: &mut Rng) -> Vec3A {
    let local = square_to_cosine_hemisphere([rng.unit_f32(), rng.unit_f32()]);
    let (x, y) = normal.any_orthonormal_pair();
    x * local.x + y * local.y + normal * local.z
}

/// A few of everything, in the unit cube about the origin.
fn clutter(rng: &mut Rng) -> Vec<(u32, Surface)> {
    let mut surfaces = Vec::new();
    for shape in 0..12 {
        let (p, small) = (random_point(rng), 0.4);
        let surface = match shape % 4 {
            0 => {
                let positions = (0..6).map(|_| random_point(rng)).collect();
                let triangles = vec![[0, 1, 2], [2, 1, 3], [3, 4, 5], [5, 0, 2], [1, 0, 4]];
                Surface::Mesh(Mesh { positions, triangles, normals: Vec::new() })
            }
            1 => Surface::Parallelogram(Parallelogram {
                corner: p,
                edge_u: random_point(rng) * small,
                edge_v: random_point(rng) * small,
            }),
            2 => Surface::Disk(Disk::new(p, random_direction(rng), 0.1 + rng.unit_f32() * 0.2)),
            _ => Surface::Sphere(Sphere { centre: p, radius: 0.05 + rng.unit_f32() * 0.2, inward: shape == 7 }),
        };
        surfaces.push((100 + shape, surface));
    }
    surfaces
}

/// Every hit along a ray, primitive by primitive in `f64`: parameter, primitive, shape.
fn all_hits(surfaces: &[(u32, Surface)], ray: &Ray) -> Vec<(f64, u32, u32)> {
    let (o, d) = (ray.origin.as_dvec3(), ray.direction.as_dvec3());
    let mut hits = Vec::new();
    let mut primitive = 0;
    let mut add = |t: Option<f64>, primitive: u32, shape: u32| {
        hits.extend(t.filter(|t| *t > 0.0).map(|t| (t, primitive, shape)));
    };
    for (shape, surface) in surfaces {
        match surface {
            Surface::Mesh(mesh) => {
                for triangle in &mesh.triangles {
                    let [a, b, c] = triangle.map(|i| mesh.positions[i as usize].as_dvec3());
                    add(oblique(o, d, a, b - a, c - a, |u, v| u >= 0.0 && v >= 0.0 && u + v <= 1.0), primitive, *shape);
                    primitive += 1;
                }
                continue;
            }
            Surface::Parallelogram(p) => {
                let [c, u, v] = [p.corner, p.edge_u, p.edge_v].map(Vec3A::as_dvec3);
                let inside = |u: f64, v: f64| (0.0..=1.0).contains(&u) && (0.0..=1.0).contains(&v);
                add(oblique(o, d, c, u, v, inside), primitive, *shape);
            }
            Surface::Disk(disk) => {
                let [c, u, v] = [disk.centre, disk.axis_u, disk.axis_v].map(Vec3A::as_dvec3);
                add(oblique(o, d, c, u, v, |u, v| u * u + v * v <= 1.0), primitive, *shape);
            }
            Surface::Sphere(sphere) => {
                let offset = o - sphere.centre.as_dvec3();
                let (b, c) = (offset.dot(d), offset.length_squared() - f64::from(sphere.radius).powi(2));
                let root = (b * b - d.length_squared() * c).sqrt();
                for sign in [-1.0, 1.0] {
                    add(Some((-b + sign * root) / d.length_squared()).filter(|t| t.is_finite()), primitive, *shape);
                }
            }
            _ => unreachable!(),
        }
        primitive += 1;
    }
    hits.sort_by(|a, b| a.0.total_cmp(&b.0));
    hits
}

/// Solves o + t d = p + u·e + v·f by Cramer's rule.
fn oblique(o: DVec3, d: DVec3, p: DVec3, e: DVec3, f: DVec3, inside: impl Fn(f64, f64) -> bool) -> Option<f64> {
    let system = DMat3::from_cols(-d, e, f);
    let determinant = system.determinant();
    let solution = system.inverse() * (o - p);
    (determinant != 0.0 && inside(solution.y, solution.z)).then_some(solution.x)
}

#[test]
fn the_first_hit_is_that_of_the_naive_oracle() {
    let mut rng = Rng::new(3);
    let (mut hits, mut misses) = (0, 0);
    for _ in 0..40 {
        let surfaces = clutter(&mut rng);
        let world = World::new(&surfaces).unwrap();
        world.validate().unwrap();
        for _ in 0..2_000 {
            let mut ray = Ray::new(random_point(&mut rng), random_direction(&mut rng) * (0.1 + rng.unit_f32()));
            let expected = all_hits(&surfaces, &ray);
            // Rays that graze an edge to within rounding are left out by comparing with slightly different rays.
            let mut nudged = ray;
            nudged.origin += random_direction(&mut rng) * 3e-6;
            let ids = |hits: &[(f64, u32, u32)]| hits.iter().map(|h| h.1).collect::<Vec<_>>();
            if ids(&expected) != ids(&all_hits(&surfaces, &nudged)) {
                continue;
            }
            let found = world.closest_hit(&ray);
            assert_eq!(found.map(|h| (h.primitive, h.shape)), expected.first().map(|h| (h.1, h.2)));
            assert_eq!(world.any_hit(&ray), found.is_some());
            let (Some(hit), Some(first)) = (found, expected.first()) else {
                misses += 1;
                continue;
            };
            hits += 1;
            // At grazing incidence the parameter is as uncertain as the ray's rounding makes it.
            let slope = f64::from(hit.geometric_normal.dot(ray.direction.normalize())).abs();
            assert!((f64::from(hit.t) - first.0).abs() <= 1e-5 * (1.0 + first.0) / slope, "{hit:?} {first:?}");
            assert!(hit.position.distance(ray.at(hit.t)) <= 1e-5 / hit.geometric_normal.dot(ray.direction).abs());
            ray.t_max = hit.t * 0.999;
            assert!(world.closest_hit(&ray).is_none() && !world.any_hit(&ray));
            ray.t_max = hit.t * 1.001;
            assert!(world.any_hit(&ray));
            ray.t_max = f32::INFINITY;
            ray.exclude[0] = hit.primitive;
            let next = expected.iter().find(|h| h.1 != hit.primitive);
            assert_eq!(world.closest_hit(&ray).map(|h| h.primitive), next.map(|h| h.1));
        }
    }
    assert!(hits > 20_000 && misses > 10_000, "{hits} hits, {misses} misses");
}

#[test]
fn coordinates_and_normals_describe_the_position() {
    let mut rng = Rng::new(4);
    let mut seen = [0; 4];
    for _ in 0..200 {
        let surfaces = clutter(&mut rng);
        let world = World::new(&surfaces).unwrap();
        for _ in 0..2_000 {
            let ray = Ray::new(random_point(&mut rng) * 2.0, random_direction(&mut rng));
            let Some(hit) = world.closest_hit(&ray) else { continue };
            let (index, surface) =
                surfaces.iter().enumerate().find(|(_, s)| s.0 == hit.shape).map(|(i, s)| (i, &s.1)).unwrap();
            let first = world.primitives(index).start;
            let ([a, b], p) = (hit.uv, hit.position);
            let (expected, normal, kind) = match surface {
                Surface::Mesh(mesh) => {
                    let corners = mesh.triangles[(hit.primitive - first) as usize].map(|i| mesh.positions[i as usize]);
                    let [e, f] = [corners[1] - corners[0], corners[2] - corners[0]];
                    (corners[0] + e * a + f * b, e.cross(f), 0)
                }
                Surface::Parallelogram(p) => (p.corner + p.edge_u * a + p.edge_v * b, p.edge_u.cross(p.edge_v), 1),
                Surface::Disk(d) => {
                    let (sin, cos) = (b * core::f32::consts::TAU).sin_cos();
                    (d.centre + (d.axis_u * cos + d.axis_v * sin) * a, d.axis_u.cross(d.axis_v), 2)
                }
                Surface::Sphere(s) => {
                    let (azimuth, polar) = (a * core::f32::consts::TAU, b * core::f32::consts::PI);
                    let outward = v(polar.sin() * azimuth.cos(), polar.sin() * azimuth.sin(), polar.cos());
                    (s.centre + outward * s.radius, if s.inward { -outward } else { outward }, 3)
                }
                _ => unreachable!(),
            };
            seen[kind] += 1;
            assert!(p.distance(expected) <= 2e-6, "{hit:?}: {expected}");
            assert!((hit.geometric_normal.length() - 1.0).abs() <= 4.0 * f32::EPSILON);
            assert!(hit.geometric_normal.dot(normal.normalize()) >= 1.0 - 1e-5);
            assert_eq!(hit.front, hit.geometric_normal.dot(ray.direction) < 0.0);
            assert_eq!(hit.shading_normal, hit.geometric_normal);
            assert!(hit.facing_normal().dot(ray.direction) <= 0.0);
        }
    }
    assert!(seen.iter().all(|n| *n > 1_000), "{seen:?}");
}

#[test]
fn smooth_normals_of_a_sphere_mesh_point_outward() {
    let mesh = icosphere(4).with_smooth_normals();
    let world = World::new(&[(0, Surface::Mesh(mesh.clone()))]).unwrap();
    let flat = World::new(&[(0, Surface::Mesh(mesh.with_face_normals()))]).unwrap();
    let mut rng = Rng::new(5);
    for _ in 0..5_000 {
        let ray = Ray::new(Vec3A::ZERO, random_direction(&mut rng));
        let hit = world.closest_hit(&ray).unwrap();
        assert!(hit.shading_normal.dot(ray.direction) >= 1.0 - 1e-5);
        assert!(!hit.front && hit.geometric_normal.dot(ray.direction) >= 0.99);
        let hit = flat.closest_hit(&ray).unwrap();
        assert_eq!(hit.shading_normal, hit.geometric_normal);
    }
}

/// The convex bodies, seen from outside and inside, whose surface a secondary ray must leave.
fn bodies(scale: f64) -> Vec<(Surface, DVec3)> {
    let shift = DVec3::new(0.7, -1.3, 2.1) * scale;
    let mesh = |mesh: Mesh, turn: DMat3| (Surface::Mesh(placed(mesh, turn, scale, shift)), shift);
    let sphere = Sphere {
        centre: shift.as_vec3a(),
        radius: DVec3::X.as_vec3a().x * DVec3::splat(scale).as_vec3a().x,
        inward: false,
    };
    vec![
        mesh(icosphere(3), DMat3::IDENTITY),
        mesh(cube(1), DMat3::IDENTITY),
        mesh(cube(3), general_turn()),
        (Surface::Sphere(sphere), shift),
    ]
}

#[test]
fn secondary_rays_neither_hit_their_own_surface_nor_leak() {
    let mut rng = Rng::new(6);
    for scale in SCALES {
        for (number, (body, centre)) in bodies(scale).into_iter().enumerate() {
            let world = World::new(&[(0, body)]).unwrap();
            for _ in 0..20_000 {
                let aside = (centre + DVec3::from_array(rng.direction()) * 3.0 * scale).as_vec3a();
                let inside = (centre + DVec3::from_array(rng.direction()) * 0.5 * scale).as_vec3a();
                let hit = world.closest_hit(&Ray::new(aside, inside - aside)).unwrap();
                assert!(hit.front);
                // Reflected: away from a convex body, nothing more is met.
                let away = bounce(hit.geometric_normal, &mut rng);
                assert!(!world.any_hit(&hit.point().ray(away)), "scale {scale}, body {number}: {hit:?}");
                // Transmitted: the far side is met once, from behind, and then nothing.
                let through = world.closest_hit(&hit.point().ray(bounce(-hit.geometric_normal, &mut rng)));
                let Some(far) = through else { panic!("scale {scale}, body {number}: leak at {hit:?}") };
                assert!(!far.front && far.t > 0.0);
                let out = bounce(far.geometric_normal, &mut rng);
                assert!(!world.any_hit(&far.point().ray(out)), "scale {scale}, body {number}: {far:?}");
            }
        }
    }
}

#[test]
fn rays_from_hits_on_edges_and_vertices_stay_in_the_room() {
    let mut rng = Rng::new(7);
    for scale in SCALES {
        for turn in [DMat3::IDENTITY, general_turn()] {
            let shift = DVec3::new(0.7, -1.3, 2.1) * scale;
            let mesh = placed(cube(4), turn, scale, shift);
            let world = World::new(&[(0, Surface::Mesh(mesh.clone()))]).unwrap();
            for triangle in &mesh.triangles {
                for side in 0..3 {
                    let [p, q] = [side, (side + 1) % 3].map(|i| mesh.positions[triangle[i] as usize]);
                    for s in [0.0, 0.25, 0.5, 0.9] {
                        let origin = (shift + DVec3::from_array(rng.direction()) * 0.5 * scale).as_vec3a();
                        let hit = world.closest_hit(&Ray::new(origin, p + (q - p) * s - origin)).unwrap();
                        for _ in 0..8 {
                            let next = hit.point().ray(bounce(hit.facing_normal(), &mut rng));
                            assert!(world.any_hit(&next), "scale {scale}: leak at {hit:?}");
                        }
                    }
                }
            }
        }
    }
}

/// A block on the floor shades floor points at its foot from everything behind it, however near the foot they are.
#[test]
fn no_light_leaks_under_a_block_on_the_floor() {
    let mut rng = Rng::new(8);
    for scale in SCALES.map(|s| DVec3::splat(s).as_vec3a().x) {
        let floor = Parallelogram {
            corner: v(-4.0, 0.0, -4.0) * scale,
            edge_u: v(0.0, 0.0, 8.0) * scale,
            edge_v: v(8.0, 0.0, 0.0) * scale,
        };
        let mut block = cube(1);
        for p in &mut block.positions {
            *p = (*p + Vec3A::Y) * scale;
        }
        let world = World::new(&[(0, Surface::Parallelogram(floor)), (1, Surface::Mesh(block))]).unwrap();
        for step in 0..2_000_u16 {
            let gap = if step % 2 == 0 { f32::from(step / 2) * f32::EPSILON } else { rng.unit_f32() * 1e-3 };
            let position = v(-1.0 - gap, 0.0, rng.unit_f32() - 0.5) * scale;
            let hit = world.closest_hit(&Ray::new(position + Vec3A::Y * (0.5 * scale), -Vec3A::Y));
            let Some(hit) = hit.filter(|h| h.primitive == 0) else {
                assert!(step == 0, "{position}");
                continue;
            };
            let target = v(4.0, 0.2 + rng.unit_f32(), rng.unit_f32() - 0.5) * scale;
            assert!(world.occluded_point(&hit.point(), target), "scale {scale}, gap {gap}");
            assert!(!world.occluded_point(&hit.point(), v(-4.0, 0.2, 0.0) * scale));
        }
    }
}

/// Points of a light with normals, for each kind of light; all face down from about y = 1.
fn light(kind: usize, rng: &mut Rng) -> (Surface, Vec<SurfacePoint>) {
    let points = 4_000;
    match kind {
        0 => {
            let p =
                Parallelogram { corner: v(-0.3, 0.99, -0.2), edge_u: v(0.6, 0.01, 0.0), edge_v: v(0.0, -0.02, 0.4) };
            let normal = p.edge_u.cross(p.edge_v).normalize();
            let point = |_| p.corner + p.edge_u * rng.unit_f32() + p.edge_v * rng.unit_f32();
            (Surface::Parallelogram(p), (0..points).map(point).map(|x| SurfacePoint::new(x, normal)).collect())
        }
        1 => {
            let disk = Disk::new(v(0.1, 0.95, 0.0), v(0.1, -1.0, 0.2), 0.3);
            let point = |_| disk.centre + disk.axis_u * (rng.unit_f32() - 0.5) + disk.axis_v * (rng.unit_f32() - 0.5);
            let normal = disk.axis_u.cross(disk.axis_v).normalize();
            (Surface::Disk(disk), (0..points).map(point).map(|x| SurfacePoint::new(x, normal)).collect())
        }
        2 => {
            let sphere = Sphere { centre: v(0.0, 0.7, 0.1), radius: 0.2, inward: false };
            let normal = |_| {
                let d = random_direction(rng);
                v(d.x, -d.y.abs().max(0.8), d.z).normalize()
            };
            let point = |n: Vec3A| SurfacePoint::new(sphere.centre + n * sphere.radius, n);
            (Surface::Sphere(sphere), (0..points).map(normal).map(point).collect())
        }
        _ => {
            let turn = general_turn();
            let mesh = placed(cube(3), turn, 0.15, DVec3::new(0.0, 0.7, 0.0));
            let points = (0..points).filter_map(|i| {
                let t = mesh.triangles[i % mesh.triangles.len()].map(|j| mesh.positions[j as usize]);
                let (a, b) = (rng.unit_f32() / 2.0, rng.unit_f32() / 2.0);
                let normal = (t[1] - t[0]).cross(t[2] - t[0]).normalize();
                (normal.y < -0.3).then(|| SurfacePoint::new(t[0] + (t[1] - t[0]) * a + (t[2] - t[0]) * b, normal))
            });
            let points = points.collect();
            (Surface::Mesh(mesh), points)
        }
    }
}

fn scaled(surface: &Surface, k: f32) -> Surface {
    match surface {
        Surface::Mesh(m) => {
            let positions = m.positions.iter().map(|p| *p * k).collect();
            Surface::Mesh(Mesh { positions, ..m.clone() })
        }
        Surface::Parallelogram(p) => {
            Surface::Parallelogram(Parallelogram { corner: p.corner * k, edge_u: p.edge_u * k, edge_v: p.edge_v * k })
        }
        Surface::Disk(d) => Surface::Disk(Disk { centre: d.centre * k, axis_u: d.axis_u * k, axis_v: d.axis_v * k }),
        Surface::Sphere(s) => Surface::Sphere(Sphere { centre: s.centre * k, radius: s.radius * k, ..*s }),
        _ => unreachable!(),
    }
}

#[test]
fn a_light_does_not_block_its_own_light_and_a_blocker_does() {
    let mut rng = Rng::new(9);
    for scale in SCALES.map(|s| DVec3::splat(s).as_vec3a().x) {
        for kind in 0..4 {
            let (lamp, points) = light(kind, &mut rng);
            let mut surfaces = vec![(0, scaled(&Surface::Mesh(cube(2)), scale)), (1, scaled(&lamp, scale))];
            let open = World::new(&surfaces).unwrap();
            let half = Parallelogram { corner: v(-0.9, 0.4, -0.9), edge_u: v(0.0, 0.0, 1.8), edge_v: v(1.8, 0.0, 0.0) };
            surfaces.push((2, scaled(&Surface::Parallelogram(half), scale)));
            let closed = World::new(&surfaces).unwrap();
            assert!(points.len() > 500);
            for target in &points {
                let target = SurfacePoint::new(target.position * scale, target.normal);
                let below = v(rng.unit_f32() - 0.5, 0.0, rng.unit_f32() - 0.5) * scale;
                let hit = open.closest_hit(&Ray::new(below, -Vec3A::Y)).unwrap();
                let known = target.on(if kind < 2 { open.primitives(1).start } else { NO_PRIMITIVE });
                for to in [target, known] {
                    assert!(!open.occluded(&hit.point(), &to), "scale {scale}, light {kind}: {hit:?} {to:?}");
                    assert!(!open.occluded(&to, &hit.point()), "scale {scale}, light {kind}: {hit:?} {to:?}");
                    assert!(closed.occluded(&hit.point(), &to) && closed.occluded(&to, &hit.point()));
                }
                assert!(open.occluded_direction(&hit.point(), target.position - hit.position));
            }
        }
    }
}

#[test]
fn areas_and_bounds_are_those_of_the_surfaces() {
    let disk = Disk::new(v(5.0, 0.0, 0.0), v(1.0, 2.0, 2.0), 2.0);
    let sphere = Sphere { centre: v(0.0, -7.0, 0.0), radius: 1.5, inward: true };
    let rectangle = Parallelogram { corner: v(0.0, 3.0, 0.0), edge_u: v(2.0, 0.0, 0.0), edge_v: v(1.0, 0.0, 3.0) };
    let world = World::new(&[
        (7, Surface::Mesh(cube(3))),
        (8, Surface::Disk(disk)),
        (9, Surface::Sphere(sphere)),
        (9, Surface::Parallelogram(rectangle)),
    ])
    .unwrap();
    world.validate().unwrap();
    assert_eq!(
        (world.len(), world.primitives(0), world.primitives(3), world.primitives(4)),
        (111, 0..108, 110..111, 0..0)
    );
    assert_eq!((world.shape(0), world.shape(110), world.shape(111)), (Some(7), Some(9), None));
    let pi = core::f64::consts::PI;
    let cube_area: f64 = world.primitives(0).map(|p| world.area(p)).sum();
    for (area, expected) in
        [(cube_area, 24.0), (world.area(108), 4.0 * pi), (world.area(109), 9.0 * pi), (world.area(110), 6.0)]
    {
        assert!((area / expected - 1.0).abs() <= 1e-6, "{area} {expected}");
    }
    assert!((world.total_area() - (30.0 + 13.0 * pi)).abs() <= 1e-4);
    let [low, high] = world.bounds();
    // The disk's half extents are r·√(1 − n²) for the unit normal (1, 2, 2)/3.
    let expected = [v(-1.5, -8.5, -1.5), v(5.0 + 2.0 * (8.0_f32 / 9.0).sqrt(), 3.0, 3.0)];
    assert!(low.distance(expected[0]) <= 1e-5 && high.distance(expected[1]) <= 1e-5, "{low} {high}");
}

#[test]
fn worlds_of_every_small_size_are_whole() {
    let mut rng = Rng::new(10);
    for count in (0..40).chain([1_000]) {
        let tiny = |rng: &mut Rng| Sphere { centre: random_point(rng) * 10.0, radius: 0.01, inward: false };
        let same = Surface::Mesh(cube(1));
        let mut surfaces: Vec<_> = (0..count).map(|i| (i, Surface::Sphere(tiny(&mut rng)))).collect();
        World::new(&surfaces).unwrap().validate().unwrap();
        surfaces.extend((0..count).map(|i| (i, same.clone())));
        let world = World::new(&surfaces).unwrap();
        world.validate().unwrap();
        assert_eq!(world.any_hit(&Ray::new(Vec3A::ZERO, v(0.3, 0.2, 0.9))), count > 0);
        assert_eq!(world.is_empty(), count == 0);
    }
}

#[test]
fn rays_that_are_not_numbers_hit_nothing() {
    let mut rng = Rng::new(12);
    let world = World::new(&clutter(&mut rng)).unwrap();
    let nan = f32::NAN;
    for ray in [
        Ray::new(v(nan, 0.0, 0.0), Vec3A::X),
        Ray::new(Vec3A::ZERO, v(1.0, nan, 0.0)),
        Ray::new(Vec3A::ZERO, Vec3A::ZERO),
        Ray { t_max: nan, ..Ray::new(Vec3A::ZERO, Vec3A::X) },
        Ray { t_max: -1.0, ..Ray::new(Vec3A::ZERO, Vec3A::X) },
    ] {
        assert!(world.closest_hit(&ray).map(|h: Hit| h.t).is_none() && !world.any_hit(&ray), "{ray:?}");
    }
}

#[test]
fn bad_surfaces_are_refused_by_name() {
    let nan = f32::NAN;
    let good = (0, Surface::Mesh(cube(1)));
    let mesh = |change: &dyn Fn(&mut Mesh)| {
        let mut mesh = cube(1).with_smooth_normals();
        change(&mut mesh);
        Surface::Mesh(mesh)
    };
    let flat = |edge_v: Vec3A| Surface::Parallelogram(Parallelogram { corner: Vec3A::ONE, edge_u: Vec3A::X, edge_v });
    let round = |radius: f32| Surface::Sphere(Sphere { centre: Vec3A::ONE, radius, inward: false });
    let (surface, element) = (1, 0);
    for (bad, expected) in [
        (mesh(&|m| m.positions[5].y = nan), GeometryError::BadCoordinate { surface, element: 5 }),
        (mesh(&|m| m.positions[3].x = 2e12), GeometryError::BadCoordinate { surface, element: 3 }),
        (mesh(&|m| m.triangles[4] = [0, 8, 1]), GeometryError::BadIndex { surface, element: 4 }),
        (mesh(&|m| m.triangles[6] = [2, 2, 1]), GeometryError::ZeroArea { surface, element: 6 }),
        (mesh(&|m| m.normals.truncate(7)), GeometryError::BadNormals { surface, element: 7 }),
        (mesh(&|m| m.normals[2] = Vec3A::ZERO), GeometryError::BadNormals { surface, element: 2 }),
        (mesh(&|m| m.normals[2].z = nan), GeometryError::BadNormals { surface, element: 2 }),
        (flat(Vec3A::X * -2.0), GeometryError::ZeroArea { surface, element }),
        (flat(Vec3A::ZERO), GeometryError::ZeroArea { surface, element }),
        (flat(Vec3A::Y * f32::INFINITY), GeometryError::BadCoordinate { surface, element }),
        (round(0.0), GeometryError::ZeroArea { surface, element }),
        (round(-1.0), GeometryError::ZeroArea { surface, element }),
        (round(nan), GeometryError::BadCoordinate { surface, element }),
        (Surface::Disk(Disk::new(Vec3A::ZERO, Vec3A::Z, 0.0)), GeometryError::ZeroArea { surface, element }),
        (Surface::Disk(Disk::new(Vec3A::ZERO, Vec3A::Z, nan)), GeometryError::BadCoordinate { surface, element }),
    ] {
        let error = World::new(&[good.clone(), (1, bad)]).map(|_| ()).unwrap_err();
        assert_eq!(error, expected);
        assert!(error.to_string().starts_with("surface 1, ") && error.to_string().lines().count() == 1);
    }
}

/// How normals change along a surface is by how much they differ at hits beside each other: of spheres from both sides, of meshes with interpolated normals,
/// and not at all where shading is flat.
#[test]
fn normals_change_as_they_differ_nearby() {
    let mut rng = Rng::new(41);
    let sphere = |inward: bool| Surface::Sphere(Sphere { centre: v(0.1, -0.2, 0.3), radius: 0.7, inward });
    let smooth = icosphere(2).with_smooth_normals();
    let surfaces = [
        (sphere(false), true),
        (sphere(true), true),
        (Surface::Mesh(smooth), true),
        (Surface::Mesh(icosphere(2)), false),
        (
            Surface::Parallelogram(Parallelogram {
                corner: v(-1.0, -1.0, 0.0),
                edge_u: v(2.0, 0.1, 0.0),
                edge_v: v(0.0, 2.0, 0.3),
            }),
            false,
        ),
        (Surface::Disk(Disk::new(v(0.0, 0.0, 0.1), v(0.1, 0.2, 1.0), 1.0)), false),
    ];
    for (number, (surface, is_curved)) in surfaces.into_iter().enumerate() {
        let world = World::new(&[(3, surface)]).unwrap();
        let (mut asked, mut largest) = (0, 0.0_f64);
        for _ in 0..2000 {
            let from = random_point(&mut rng) * 3.0;
            let towards = random_point(&mut rng) * 0.5 - from;
            let ray = Ray::new(from, towards.normalize());
            let Some(hit) = world.closest_hit(&ray) else { continue };
            // Not along the edge of vision, where steps are long.
            if hit.geometric_normal.dot(ray.direction).abs() < 0.3 {
                continue;
            }
            let aside = random_direction(&mut rng) * 2e-3;
            let ends = [-1.0, 1.0].map(|side| world.closest_hit(&Ray::new(from + aside * side, ray.direction)));
            let [Some(before), Some(after)] = ends else { continue };
            if before.primitive != hit.primitive || after.primitive != hit.primitive {
                continue;
            }
            let step = after.position.as_dvec3() - before.position.as_dvec3();
            let expected = after.shading_normal.as_dvec3() - before.shading_normal.as_dvec3();
            let found = world.normal_change(&hit, step);
            assert!((found - expected).length() <= 1e-3 * step.length(), "{number}: {found} {expected} for {step}");
            let twice = world.normal_change(&hit, step * 2.0);
            assert!(
                (twice - found * 2.0).length() <= 1e-12 * found.length()
                    && world.normal_change(&hit, DVec3::ZERO) == DVec3::ZERO
            );
            largest = largest.max(found.length() / step.length());
            asked += 1;
        }
        assert!(asked > 300, "{number}: {asked}");
        assert!(if is_curved { (0.5..3.0).contains(&largest) } else { largest == 0.0 }, "{number}: {largest}");
    }
}
