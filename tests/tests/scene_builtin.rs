//! The built-in scenes: complete, right way round, and the same when exported.
#![allow(clippy::panic, reason = "how helpers of tests fail")]

use std::path::PathBuf;

use renderers::scene::glam::DVec3;
use renderers::scene::{
    BsdfKind, ConductorFresnel, Emitter, Filter, Geometry, Integrator, Ior, Mesh, Metal, Scene, Shape, Source,
    SpectrumKind, builtin, load,
};

/// A point in the empty middle of the box, between the blocks and the ceiling.
const MIDDLE: DVec3 = DVec3::new(278.0, 400.0, 280.0);

fn built_in(name: &str) -> Scene {
    builtin::load(name, &[]).unwrap_or_else(|error| panic!("{error}"))
}

/// The scenes that are Cornell boxes.
fn shape<'s>(scene: &'s Scene, id: &str) -> &'s Shape {
    let found = scene.shapes.iter().find(|shape| shape.label.split(' ').next() == Some(id));
    found.unwrap_or_else(|| panic!("{} has no {id}", scene.name))
}

fn mesh<'s>(scene: &'s Scene, id: &str) -> &'s Mesh {
    match &shape(scene, id).geometry {
        Geometry::Mesh(mesh) => mesh,
        other => panic!("{id} is {other:?}"),
    }
}

fn centroid(mesh: &Mesh, triangle: usize) -> DVec3 {
    mesh.corners(triangle).iter().sum::<DVec3>() / 3.0
}

const CORNELL_BOXES: [&str; 5] =
    ["cornell-box", "cornell-box-sodium", "cornell-box-lamp", "cornell-box-spheres", "cornell-box-paper"];

#[test]
fn all_scenes_are_listed_the_default_first() {
    let names: Vec<_> = builtin::names().collect();
    assert_eq!(names[0], builtin::DEFAULT);
    let others = ["cie-171-5-8", "furnace", "lounge", "cri-room", "neumann-schanda", "grazing"];
    let caustics = ["caustic-ring", "caustic-ring-mirror", "prism", "prism-lamp", "cornell-box-glass"];
    let thesis = ["fluorescent-spheres", "seminar-room", "office"];
    for name in CORNELL_BOXES.iter().chain(&others).chain(&caustics).chain(&thesis) {
        assert!(names.contains(name), "{name}");
    }
}

#[test]
fn cornell_boxes_have_the_same_box_camera_and_light() {
    for name in CORNELL_BOXES {
        let scene = built_in(name);
        assert_eq!(scene.name, name);
        assert_eq!(scene.shapes.len(), 8, "{name}");
        let area_lights = scene.emitters.iter().filter(|e| matches!(e, Emitter::Area { .. })).count();
        assert_eq!(area_lights, 1, "{name}");
        assert_eq!((scene.film.width, scene.film.height, scene.film.filter), (512, 512, Filter::Box));
        // Focal length 0.035 and film width 0.025; the angle in the file is rounded to 1e-5 degrees.
        let half_width = scene.camera.half_width(512, 512);
        assert!((half_width - 0.0125 / 0.035).abs() <= 1e-7, "{name}: {half_width}");
        let camera = scene.camera.to_world;
        assert_eq!(camera.translation, DVec3::new(278.0, 273.0, -800.0));
        assert_eq!((camera.matrix3.x_axis, camera.matrix3.z_axis), (DVec3::X, DVec3::Z));
    }
}

#[test]
fn parameters_set_resolution_and_samples() {
    let parameters = [("resolution".to_owned(), "64".to_owned()), ("spp".to_owned(), "3".to_owned())];
    for name in builtin::names() {
        let scene = builtin::load(name, &parameters).unwrap();
        assert_eq!((scene.film.width, scene.film.height, scene.sampler.sample_count), (64, 64, 3));
    }
}

#[test]
fn walls_face_inward_blocks_outward_and_the_light_down() {
    for name in CORNELL_BOXES {
        let scene = built_in(name);
        for id in ["floor", "ceiling", "back_wall", "right_wall", "left_wall"] {
            let mesh = mesh(&scene, id);
            assert!(mesh.normals.is_none(), "{id} is smoothed");
            for t in 0..mesh.triangles.len() {
                let inward = mesh.face_cross(t).dot(MIDDLE - centroid(mesh, t));
                assert!(inward > 0.0, "{name}: {id}, triangle {t} faces outward");
            }
        }
        let Geometry::Rectangle { normal, .. } = shape(&scene, "light").geometry else { panic!("no rectangle") };
        assert!((normal - DVec3::NEG_Y).length() <= 1e-12, "{name}: the light faces {normal}");
    }
    let scene = built_in("cornell-box");
    for id in ["short_block", "tall_block"] {
        let mesh = mesh(&scene, id);
        let inside = mesh.positions.iter().sum::<DVec3>() / 8.0;
        assert_eq!((mesh.positions.len(), mesh.triangles.len()), (8, 10), "{id}");
        for t in 0..10 {
            assert!(mesh.face_cross(t).dot(centroid(mesh, t) - inside) > 0.0, "{id}, triangle {t} faces inward");
        }
    }
}

#[test]
fn the_box_has_its_measured_size_and_the_light_fills_the_opening() {
    let scene = built_in("cornell-box");
    let area = |id: &str| shape(&scene, id).geometry.area();
    // Areas of the published quadrilaterals by the trapezium rule, in mm².
    let floor = (552.8 + 549.6) / 2.0 * 559.2;
    let back_wall = (549.6 + 556.0) / 2.0 * 548.8;
    let ceiling = 556.0 * 559.2;
    let light = 130.0 * 105.0;
    for (id, expected) in [
        ("floor", floor),
        ("back_wall", back_wall),
        ("right_wall", 548.8 * 559.2),
        ("light", light),
        ("ceiling", ceiling - light),
    ] {
        let err = (area(id) - expected).abs();
        assert!(err <= 1e-12 * expected, "{id}: {} is not {expected}", area(id));
    }
    let Geometry::Rectangle { center, half_u, half_v, .. } = shape(&scene, "light").geometry else { panic!() };
    let extent = half_u.abs() + half_v.abs();
    assert!((center - extent - DVec3::new(213.0, 548.8, 227.0)).length() <= 1e-12);
    assert!((center + extent - DVec3::new(343.0, 548.8, 332.0)).length() <= 1e-12);
}

#[test]
fn paints_and_lights_are_the_measured_ones() {
    let scene = built_in("cornell-box");
    assert_eq!(scene.integrator, Integrator::Direct);
    let paint = |id: &str| {
        let BsdfKind::Diffuse { reflectance } = scene.bsdf(shape(&scene, id).bsdf).kind else { panic!("{id}") };
        let SpectrumKind::Table { wavelengths, values } = &scene.spectrum(reflectance).kind else { panic!("{id}") };
        assert_eq!(wavelengths.len(), 76, "{id}");
        assert!(wavelengths.iter().zip((400..).step_by(4)).all(|(&w, expected)| w == f64::from(expected)), "{id}");
        (values[0], values[75], reflectance)
    };
    // First and last published value of each paint.
    let (white, red, green) = (paint("floor"), paint("left_wall"), paint("right_wall"));
    assert_eq!((white.0, white.1), (0.343, 0.737));
    assert_eq!((red.0, red.1), (0.04, 0.642));
    assert_eq!((green.0, green.1), (0.092, 0.159));
    for id in ["ceiling", "back_wall", "short_block", "tall_block"] {
        assert_eq!(paint(id).2, white.2, "{id}");
    }
    // Three paints, the lamp's own reflectance, D65.
    assert_eq!(scene.spectra.len(), 5);
    assert_eq!(light(&scene), SpectrumKind::D65 { scale: 40.0 });
}

/// The radiance of the area light.
fn light(scene: &Scene) -> SpectrumKind {
    let Some(emitter) = shape(scene, "light").emitter else { panic!("the light is dark") };
    let Emitter::Area { radiance, shape: id } = scene.emitter(emitter) else { panic!("no area light") };
    assert_eq!(scene.shapes[id.0].emitter, Some(emitter));
    scene.spectrum(*radiance).kind.clone()
}

#[test]
fn sodium_is_two_lines_with_power_two_to_one_and_the_luminance_of_d65() {
    let SpectrumKind::Table { wavelengths, values } = light(&built_in("cornell-box-sodium")) else { panic!() };
    assert_eq!(wavelengths, [588.895, 588.995, 589.095, 589.492, 589.592, 589.692]);
    let power = |first: usize| values[first + 1] * (wavelengths[first + 2] - wavelengths[first]) / 2.0;
    assert!((power(0) / power(3) - 2.0).abs() <= 1e-5, "{} : {}", power(0), power(3));
    // CIE 1931 ȳ at 588, 589 and 590 nm, linear between; Y = ∫ L ȳ dλ over 106.7502594, rounded as the file is.
    let y_bar = |x: f64| {
        if x < 589.0 { Y[0] + (Y[1] - Y[0]) * (x - 588.0) } else { Y[1] + (Y[2] - Y[1]) * (x - 589.0) }
    };
    let luminance = (power(0) * y_bar(588.995) + power(3) * y_bar(589.592)) / 106.750_259_4;
    assert!((luminance / 40.0 - 1.0).abs() <= 1e-5, "{luminance}");
}

const Y: [f64; 3] = [0.781192, 0.7691547, 0.757];

#[test]
fn the_lamp_keeps_the_published_shape() {
    let SpectrumKind::Table { wavelengths, values } = light(&built_in("cornell-box-lamp")) else { panic!() };
    assert_eq!(wavelengths, [400.0, 500.0, 600.0, 700.0]);
    for (value, published) in values.iter().zip([0.0, 8.0, 15.6, 18.4]) {
        // Six digits are written.
        assert!((value * 8.0 / values[1] - published).abs() <= 2e-5 * published, "{value}");
    }
}

#[test]
fn spheres_are_of_dispersive_glass_and_gold() {
    let scene = built_in("cornell-box-spheres");
    let glass = &scene.bsdf(shape(&scene, "glass_sphere").bsdf).kind;
    assert!(
        matches!(glass, BsdfKind::Dielectric { int_ior: Ior::Glass(name), ext_ior: Ior::Constant(_), .. } if name == "N-BK7")
    );
    let gold = &scene.bsdf(shape(&scene, "gold_sphere").bsdf).kind;
    assert!(matches!(gold, BsdfKind::Conductor { fresnel: ConductorFresnel::Metal(Metal::Au), .. }));
    let sphere = |id: &str| match shape(&scene, id).geometry {
        Geometry::Sphere { center, radius, inward: false, .. } => (center, radius),
        ref other => panic!("{id} is {other:?}"),
    };
    let ((a, r), (b, s)) = (sphere("glass_sphere"), sphere("gold_sphere"));
    assert!(a.y >= r && b.y >= s && a.distance(b) > r + s, "the spheres reach into each other or the floor");
    assert!(scene.emitters.iter().any(|emitter| matches!(emitter, Emitter::Ambient { .. })));
}

#[test]
fn the_paper_scene_has_colorchecker_walls_with_schlick_brdfs() {
    let scene = built_in("cornell-box-paper");
    for (id, file) in [
        ("left_wall", "blue"),
        ("right_wall", "red"),
        ("floor", "white_9_5"),
        ("short_block", "neutral_8"),
        ("tall_block", "green"),
    ] {
        let BsdfKind::Schlick { reflectance, roughness, isotropy } = scene.bsdf(shape(&scene, id).bsdf).kind else {
            panic!("{id}")
        };
        assert_eq!((roughness, isotropy), (0.8, 1.0));
        let spectrum = scene.spectrum(reflectance);
        assert!(spectrum.label.starts_with(&format!("spectra/colorchecker_{file}.spd ")), "{}", spectrum.label);
        let SpectrumKind::Table { wavelengths, .. } = &spectrum.kind else { panic!("{id}") };
        assert_eq!((wavelengths.len(), wavelengths[0], wavelengths[80]), (81, 380.0, 780.0));
    }
    assert_eq!(light(&scene), SpectrumKind::D65 { scale: 40.0 });
}

#[test]
fn exported_scenes_load_from_disk_as_the_same_data() {
    for name in builtin::names() {
        let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(format!("export-{name}"));
        let files = builtin::export(name, &folder).unwrap();
        assert_eq!(files[0], folder.join(format!("{name}.xml")));
        let (here, there) = (built_in(name), load(&Source::disk(&files[0]), &[]).unwrap());
        assert_eq!((here.camera, here.film, here.integrator), (there.camera, there.film, there.integrator));
        let geometry = |scene: &Scene| scene.shapes.iter().map(|s| (s.geometry.clone(), s.bsdf)).collect::<Vec<_>>();
        assert_eq!(geometry(&here), geometry(&there));
        let kinds = |scene: &Scene| scene.spectra.iter().map(|s| s.kind.clone()).collect::<Vec<_>>();
        assert_eq!(kinds(&here), kinds(&there));
        let materials = |scene: &Scene| scene.bsdfs.iter().map(|b| b.kind.clone()).collect::<Vec<_>>();
        assert_eq!(materials(&here), materials(&there));
        assert_eq!(unlabelled(here), unlabelled(there));
    }
}

/// The lights without their labels, which say where a scene was read from.
fn unlabelled(scene: Scene) -> Vec<Emitter> {
    let unlabelled = |mut emitter| {
        if let Emitter::Luminaire { label, .. } | Emitter::Constant { label, .. } = &mut emitter {
            label.clear();
        }
        emitter
    };
    scene.emitters.into_iter().map(unlabelled).collect()
}

/// Every file in the scenes' folder is compiled in and used, so that none is forgotten or left over.
#[test]
fn every_scene_file_is_embedded() {
    let root = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../renderers/scenes");
    let list = |folder: &str| {
        let entries = std::fs::read_dir(root.join(folder)).unwrap();
        entries.map(|e| e.unwrap().file_name().into_string().unwrap()).filter(|n| n.contains('.')).collect::<Vec<_>>()
    };
    let mut on_disk: Vec<_> = list("")
        .into_iter()
        .chain(
            ["luminaires", "meshes", "spectra"]
                .into_iter()
                .flat_map(|folder| list(folder).into_iter().map(move |name| format!("{folder}/{name}"))),
        )
        .collect();
    let mut embedded: Vec<_> = builtin::names()
        .flat_map(|name| {
            let Some(Source::Memory { name, assets, .. }) = builtin::source(name) else { panic!("{name}") };
            core::iter::once(name).chain(assets.into_iter().map(|(asset, _)| asset)).collect::<Vec<_>>()
        })
        .collect();
    on_disk.sort();
    embedded.sort();
    embedded.dedup();
    assert_eq!(on_disk, embedded);
}
