//! The built-in scenes of caustics: closed bodies, the shapes that their comments state, and light that goes where their formulas say.
#![allow(clippy::panic, clippy::unwrap_used, reason = "how helpers of tests fail")]

use std::collections::HashMap;
use std::fs;

use renderers::direct;
use renderers::geometry::{Ray, World};
use renderers::scene::glam::{DVec3, Vec3A};
use renderers::scene::{
    BsdfKind, ConductorFresnel, Emitter, Geometry, Ior, Mesh, Metal, Scene, Shape, SpectrumKind, builtin,
};
use spectral_core::dispersion::{Dispersion, Glass};
use spectral_tests::generators::Draw;
use spectral_tests::meshes;

fn with(name: &str, parameters: &[(&str, &str)]) -> Scene {
    let parameters: Vec<_> = parameters.iter().map(|(n, v)| ((*n).to_owned(), (*v).to_owned())).collect();
    builtin::load(name, &parameters).unwrap_or_else(|error| panic!("{error}"))
}

fn id(shape: &Shape) -> &str {
    shape.label.split(' ').next().unwrap_or_default()
}

fn shape<'s>(scene: &'s Scene, wanted: &str) -> &'s Shape {
    scene.shapes.iter().find(|shape| id(shape) == wanted).unwrap_or_else(|| panic!("{} has no {wanted}", scene.name))
}

fn mesh<'s>(scene: &'s Scene, id: &str) -> &'s Mesh {
    match &shape(scene, id).geometry {
        Geometry::Mesh(mesh) => mesh,
        other => panic!("{id} is {other:?}"),
    }
}

#[test]
fn committed_meshes_are_current() {
    for (path, expected) in meshes::generate() {
        let committed = fs::read_to_string(&path).unwrap();
        assert!(
            committed == expected,
            "{} is out of date: run cargo run -p spectral-tests --bin generate_meshes",
            path.display()
        );
    }
}

#[test]
fn no_built_in_scene_gives_a_warning() {
    for name in builtin::names() {
        assert_eq!(with(name, &[]).warnings(), [], "{name}");
    }
}

/// Every edge belongs to two triangles that run along it in opposite directions, told by the vertices' numbers.
fn assert_closed(mesh: &Mesh) {
    let mut edges = HashMap::new();
    for [a, b, c] in &mesh.triangles {
        for edge in [(a, b), (b, c), (c, a)] {
            assert!(edges.insert(edge, ()).is_none(), "{edge:?} is run along twice");
        }
    }
    for (a, b) in edges.keys() {
        assert!(edges.contains_key(&(b, a)), "nothing lies beyond the edge from {a} to {b}");
    }
}

/// Volume and area of a mesh, by its triangles.
fn volume_and_area(mesh: &Mesh) -> [f64; 2] {
    let part = |t| {
        let [a, b, c] = mesh.corners(t);
        [a.dot(b.cross(c)) / 6.0, mesh.face_cross(t).length() / 2.0]
    };
    (0..mesh.triangles.len()).map(part).fold([0.0; 2], |[v, a], [dv, da]| [v + dv, a + da])
}

#[test]
fn rings_are_closed_and_superelliptic() {
    let (glass, mirror) = (with("caustic-ring", &[]), with("caustic-ring-mirror", &[]));
    let ring = mesh(&glass, "ring");
    assert_eq!(ring, mesh(&mirror, "ring"));
    assert_eq!(ring.triangles.len(), 3840);
    assert_closed(ring);
    for (p, n) in ring.positions.iter().zip(ring.normals.as_ref().unwrap()) {
        let (out, up) = (p.truncate().length(), p.z - 0.401);
        let [x, z] = [(out - 1.6) / 0.2, up / 0.4];
        // Six decimals are written: a distance is right to √2/2 1e-6, a height to half of 1e-6, at slopes of 3/0.2 and 3/0.4.
        let err = (x.abs().powi(3) + z.abs().powi(3) - 1.0).abs();
        assert!(err <= 15e-6, "{p}: {err}");
        let across = p.truncate() / out * (x * x.abs() / 0.2);
        let gradient = DVec3::new(across.x, across.y, z * z.abs() / 0.4).normalize();
        // Slopes of the gradient are 2/0.2² at most, its length is 2.5 at least.
        assert!((gradient - *n).length() <= 2e-5, "{p}: {n} is not {gradient}");
    }
    // By Pappus, 2π·1.6 times the section's area 4ab Γ(4/3)²/Γ(5/3); polygons are inscribed, of 20 corners and 96.
    let section = 4.0 * 0.2 * 0.4 * 0.892_979_511_569_249_2_f64.powi(2) / 0.902_745_292_950_933_6;
    let [volume, _] = volume_and_area(ring);
    let share = volume / (core::f64::consts::TAU * 1.6 * section);
    assert!(share < 1.0 && share > 0.97, "{share}");
}

#[test]
fn rings_differ_in_their_material_alone() {
    let (glass, mirror) = (with("caustic-ring", &[]), with("caustic-ring-mirror", &[]));
    assert_eq!((glass.camera, glass.film, glass.shapes.len()), (mirror.camera, mirror.film, mirror.shapes.len()));
    for (a, b) in glass.shapes.iter().zip(&mirror.shapes) {
        assert_eq!(a.geometry, b.geometry, "{}", a.label);
    }
    let BsdfKind::Dielectric { int_ior: Ior::Glass(code), ext_ior, absorption, .. } =
        &glass.bsdf(shape(&glass, "ring").bsdf).kind
    else {
        panic!("no glass")
    };
    assert_eq!((code.as_str(), ext_ior), ("437907", &Ior::Constant(1.0)));
    assert_eq!(glass.spectrum(absorption.unwrap()).kind, SpectrumKind::Constant(0.1));
    // The code says n_d = 1.437 and an Abbe number of 90.7.
    let found = Glass::<f64>::find(code).unwrap();
    assert!((found.index(587.5618) - 1.437).abs() <= 5e-4 && (found.abbe_number() - 90.7).abs() <= 0.05);
    for (name, expected) in [
        ("none", ConductorFresnel::Perfect),
        ("Ag", ConductorFresnel::Metal(Metal::Ag)),
        ("Au", ConductorFresnel::Metal(Metal::Au)),
    ] {
        let scene = with("caustic-ring-mirror", &[("metal", name)]);
        let BsdfKind::Conductor { fresnel, .. } = &scene.bsdf(shape(&scene, "ring").bsdf).kind else { panic!() };
        assert_eq!(fresnel, &expected);
    }
    // The lamp sees the ring, and nothing is in the way.
    let Geometry::Disk { center, normal, radius } = shape(&glass, "light").geometry else { panic!() };
    assert!((radius - 0.5).abs() <= 1e-12 && (center.length() - 14.0).abs() <= 0.2);
    assert!((normal - (DVec3::Z * 0.4 - center).normalize()).length() <= 1e-12);
}

#[test]
fn the_glass_sphere_hovers_in_the_cornell_box_and_takes_any_glass() {
    let (scene, bare) = (with("cornell-box-glass", &[]), with("cornell-box", &[]));
    assert_eq!((scene.camera, scene.film), (bare.camera, bare.film));
    for wall in bare.shapes.iter().filter(|shape| !id(shape).ends_with("_block")) {
        assert_eq!(shape(&scene, id(wall)).geometry, wall.geometry, "{}", wall.label);
    }
    assert_eq!(scene.shapes.len(), bare.shapes.len() - 1);
    let sphere = shape(&scene, "glass_sphere");
    let Geometry::Sphere { center, radius, inward: false, .. } = sphere.geometry else { panic!() };
    assert!((center.y - radius - 40.0).abs() <= 1e-12);
    let index = |glass: &str| {
        let scene = with("cornell-box-glass", &[("glass", glass)]);
        match &scene.bsdf(shape(&scene, "glass_sphere").bsdf).kind {
            BsdfKind::Dielectric { int_ior, ext_ior: Ior::Constant(1.0), .. } => int_ior.clone(),
            other => panic!("{other:?}"),
        }
    };
    assert_eq!(index("1.5"), Ior::Constant(1.5));
    for glass in ["N-BK7", "SF10", "437907"] {
        assert_eq!(index(glass), Ior::Glass(glass.to_owned()));
    }
    let parameters = [("glass".to_owned(), "SF100".to_owned())];
    let error = builtin::load("cornell-box-glass", &parameters).unwrap_err().to_string();
    assert!(error.contains("\"SF100\" is not a number"), "{error}");
}

/// A glass that the comment of the prism's scene names.
const GLASSES: [&str; 4] = ["SF10", "SF11", "N-SF11", "N-BK7"];

#[test]
fn prisms_differ_in_their_light_alone() {
    let (sun, lamp) = (with("prism", &[]), with("prism-lamp", &[]));
    assert_eq!((sun.camera, sun.film), (lamp.camera, lamp.film));
    for (a, b) in sun.shapes.iter().zip(&lamp.shapes) {
        let kind = |scene: &Scene, shape: &Shape| scene.bsdf(shape.bsdf).kind.clone();
        assert_eq!((id(a), &a.geometry), (id(b), &b.geometry));
        assert_eq!(core::mem::discriminant(&kind(&sun, a)), core::mem::discriminant(&kind(&lamp, b)), "{}", a.label);
    }
    assert_eq!(sun.shapes.len() + 1, lamp.shapes.len());
    let [Emitter::Directional { direction, irradiance }] = sun.emitters[..] else { panic!("{:?}", sun.emitters) };
    let [Emitter::Area { radiance, .. }] = lamp.emitters[..] else { panic!("{:?}", lamp.emitters) };
    let Geometry::Disk { center, normal, radius } = shape(&lamp, "lamp").geometry else { panic!() };
    // From the slit's middle, 100 back along the beam, facing along it; the lamp's place has six decimals.
    let slit = DVec3::new(-3.0, 0.0, 1.5);
    assert!((slit - direction * 100.0 - center).length() <= 1e-6 && (normal - direction).length() <= 1e-8);
    let scale = |scene: &Scene, id| match scene.spectrum(id).kind {
        SpectrumKind::D65 { scale } => scale,
        ref other => panic!("{other:?}"),
    };
    let share = scale(&lamp, radiance) * core::f64::consts::PI * (radius / 100.0).powi(2) / scale(&sun, irradiance);
    assert!((share - 1.0).abs() <= 2e-3, "{share}");
}

#[test]
fn the_prism_is_closed_and_equilateral() {
    let scene = with("prism", &[]);
    let prism = mesh(&scene, "prism");
    assert!(prism.normals.is_none() && prism.triangles.len() == 8);
    assert_closed(prism);
    for i in 0..3 {
        let side = prism.corners(0)[i] - prism.corners(0)[(i + 1) % 3];
        // Six decimals are written.
        assert!((side.length() - 2.0).abs() <= 1e-6, "{side}");
    }
    let [volume, area] = volume_and_area(prism);
    assert!((volume - 3.0 * 3.0_f64.sqrt()).abs() <= 1e-5, "{volume}");
    assert!((area - (18.0 + 2.0 * 3.0_f64.sqrt())).abs() <= 1e-5, "{area}");
}

/// Where the middle of the beam meets the wall at a wavelength in nm, along x; the formula of the scene's comment.
fn place_on_wall(glass: &Glass<f64>, wavelength: f64) -> f64 {
    let upright = 0.01 / 1.01;
    let index = ((glass.index(wavelength).powi(2) - upright) / (1.0 - upright)).sqrt();
    let sixty = 60.0_f64.to_radians();
    let a = (sixty.sin() / index).asin();
    let b = sixty - a;
    let e = (index * b.sin()).asin();
    0.577_350 + (7.0 - 0.866_025 * b.tan()) / e.tan()
}

/// Snell's law in vectors: the way on of light along `way` (a unit vector) at a surface, from index `from` to index `to`.
fn refract(way: DVec3, normal: DVec3, from: f64, to: f64) -> Option<DVec3> {
    let normal = if way.dot(normal) < 0.0 { normal } else { -normal };
    let along = (way - normal * way.dot(normal)) * (from / to);
    let rest = 1.0 - along.length_squared();
    (rest > 0.0).then(|| along - normal * rest.sqrt())
}

struct Beam<'s> {
    scene: &'s Scene,
    world: World,
    glass: Glass<f64>,
}

impl Beam<'_> {
    /// What parallel light meets that passes the plane x = −3.5 at these places, going through glass: the shapes, and the last place.
    fn follow(&self, y: f64, z: f64, wavelength: f64) -> (Vec<&str>, DVec3) {
        let Emitter::Directional { direction, .. } = self.scene.emitters[0] else { panic!("no parallel light") };
        let mut way = direction;
        let mut ray = Ray::new(DVec3::new(-3.5, y, z).as_vec3a(), way.as_vec3a());
        let (mut met, mut inside) = (Vec::new(), false);
        while let Some(hit) = self.world.closest_hit(&ray) {
            met.push(id(&self.scene.shapes[hit.shape as usize]));
            if met.last() != Some(&"prism") || met.len() > 8 {
                return (met, hit.position.as_dvec3());
            }
            let index = self.glass.index(wavelength);
            let (from, to) = if inside { (index, 1.0) } else { (1.0, index) };
            let normal = hit.geometric_normal.as_dvec3().normalize();
            match refract(way, normal, from, to) {
                Some(onward) => (way, inside) = (onward, !inside),
                None => way -= normal * (2.0 * way.dot(normal)),
            }
            ray = hit.point().ray(way.as_vec3a());
        }
        (met, ray.origin.as_dvec3())
    }
}

/// Rays through the scene's surfaces, by Snell's law in vectors, come where the closed form says, for ten wavelengths of each glass.
#[test]
fn the_spectrum_falls_where_the_closed_form_says() {
    for name in GLASSES {
        let scene = with("prism", &[("glass", name)]);
        let BsdfKind::Dielectric { int_ior: Ior::Glass(found), .. } = &scene.bsdf(shape(&scene, "prism").bsdf).kind
        else {
            panic!("no glass")
        };
        assert_eq!(found, name);
        let beam = Beam { world: direct::world(&scene).unwrap(), scene: &scene, glass: Glass::find(name).unwrap() };
        let mut last = f64::NEG_INFINITY;
        for wavelength in (0..10).map(|i| 400.0 + 40.0 * f64::from(i)) {
            let (met, place) = beam.follow(0.0, 2.5, wavelength);
            assert_eq!(met, ["prism", "prism", "wall"], "{name}, {wavelength} nm");
            let expected = place_on_wall(&beam.glass, wavelength);
            // Places of hits are in f32, and corners of the prism in six decimals.
            assert!((place.x - expected).abs() <= 2e-5, "{name}, {wavelength} nm: {} is not {expected}", place.x);
            assert!((place.y + 7.0).abs() <= 1e-5 && place.z > 0.0 && place.z < 2.0, "{place}");
            assert!(expected > last && expected < 9.0, "{name}: from violet to red, on the wall");
            last = expected;
        }
    }
}

/// Through the slit, light meets the front of the prism; beside it, the blockers; low down, the spectrum falls on the floor.
#[test]
fn the_slit_lets_light_to_the_prism_alone() {
    let scene = with("prism", &[]);
    let beam = Beam { world: direct::world(&scene).unwrap(), scene: &scene, glass: Glass::find("SF10").unwrap() };
    let mut random = Draw::new(0x51d);
    let mut floor = 0;
    for _ in 0..2000 {
        let (y, z, wavelength) =
            (random.unit() * 0.0998 - 0.0499, 0.06 + 2.9 * random.unit(), 380.0 + 400.0 * random.unit());
        let (met, place) = beam.follow(y, z, wavelength);
        match met.as_slice() {
            ["floor"] => assert!(place.x < -0.2 && z < 0.4, "{place}"),
            ["prism", .., "wall"] => assert!(place.x > 3.0 && place.x < 5.0 && place.z < 2.0, "{place}"),
            ["prism", .., "floor"] => floor += 1,
            other => panic!("{other:?} at {place}"),
        }
        let beside = (0.0501 + 1.1 * random.unit()).copysign(y);
        let blocker = if beside > 0.0 { "left_blocker" } else { "right_blocker" };
        assert_eq!(beam.follow(beside, z, wavelength).0, [blocker]);
    }
    assert!(floor > 400, "{floor}");
}

/// The light that the exit face reflects leaves by the base and comes to the rear of the right blocker.
#[test]
fn a_caustic_is_hidden_on_the_rear_of_the_right_blocker() {
    let scene = with("prism", &[]);
    let world = direct::world(&scene).unwrap();
    let glass = Glass::<f64>::find("SF10").unwrap();
    for wavelength in [450.0, 550.0, 650.0] {
        let Emitter::Directional { direction, .. } = scene.emitters[0] else { panic!("no parallel light") };
        let index = glass.index(wavelength);
        let mut way = direction;
        let mut ray = Ray::new(Vec3A::new(-2.9, 0.0, 2.5), way.as_vec3a());
        for step in 0..3 {
            let hit = world.closest_hit(&ray).unwrap();
            assert_eq!(id(&scene.shapes[hit.shape as usize]), "prism", "{wavelength} nm, step {step}");
            let normal = hit.geometric_normal.as_dvec3().normalize();
            way = match step {
                0 => refract(way, normal, 1.0, index).unwrap(),
                1 => way - normal * (2.0 * way.dot(normal)),
                _ => refract(way, normal, index, 1.0).unwrap(),
            };
            ray = hit.point().ray(way.as_vec3a());
        }
        let hit = world.closest_hit(&ray).unwrap();
        assert_eq!(id(&scene.shapes[hit.shape as usize]), "right_blocker", "{wavelength} nm");
        // The side away from the light, and from the camera.
        assert!(way.x < 0.0 && scene.camera.to_world.translation.x < f64::from(hit.position.x));
    }
}
