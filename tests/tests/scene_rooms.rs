//! The built-in rooms, in which light is reflected many times: closed, lit as their comments say, and of the materials that they name.
#![allow(clippy::panic, clippy::unwrap_used, reason = "how helpers of tests fail")]

use core::f64::consts::PI;

use renderers::direct;
use renderers::geometry::SurfacePoint;
use renderers::geometry::sampling::square_to_cosine_hemisphere;
use renderers::scene::glam::DVec3;
use renderers::scene::{BsdfKind, Emitter, Geometry, Integrator, Scene, Shape, SpectrumKind, builtin};
use spectral_core::spectrum::Outside;
use spectral_core::summation::{SumGrid, tristimulus_sum};
use spectral_core::tables::UniformTable;
use spectral_core::tables::fluorescent::{FL2, FL3_14, FL3_15, FL7};
use spectral_core::tables::illuminants::A;
use spectral_core::tables::led::LED_V2;
use spectral_core::tables::observers::CIE_1931_2;
use spectral_tests::generators::Draw;

const ROOMS: [&str; 8] = [
    "cie-171-5-8",
    "furnace",
    "lounge",
    "cri-room",
    "neumann-schanda",
    "fluorescent-spheres",
    "seminar-room",
    "office",
];

fn with(name: &str, parameters: &[(&str, &str)]) -> Scene {
    let parameters: Vec<_> = parameters.iter().map(|(n, v)| ((*n).to_owned(), (*v).to_owned())).collect();
    builtin::load(name, &parameters).unwrap_or_else(|error| panic!("{error}"))
}

fn shape<'s>(scene: &'s Scene, id: &str) -> &'s Shape {
    let found = scene.shapes.iter().find(|shape| shape.label.split(' ').next() == Some(id));
    found.unwrap_or_else(|| panic!("{} has no {id}", scene.name))
}

fn reflectance<'s>(scene: &'s Scene, shape: &Shape) -> &'s SpectrumKind {
    match scene.bsdf(shape.bsdf).kind {
        BsdfKind::Diffuse { reflectance } => &scene.spectrum(reflectance).kind,
        ref other => panic!("{}: {other:?}", shape.label),
    }
}

/// Light that is reflected at random never leaves a room and never sees the back of anything.
#[test]
#[allow(clippy::cast_possible_truncation, reason = "rays are traced in f32")]
fn rooms_are_closed_and_face_inward() {
    for name in ROOMS {
        let scene = with(name, &[]);
        assert_eq!(scene.integrator, Integrator::Path { max_depth: None, rr_depth: 5 }, "{name}");
        let world = direct::world(&scene).unwrap();
        let camera = scene.camera.to_world;
        let mut random = Draw::new(0x10ad);
        let (mut normal, mut point) = (
            camera.matrix3.z_axis.as_vec3a(),
            SurfacePoint::new(camera.translation.as_vec3a(), camera.matrix3.z_axis.as_vec3a()),
        );
        let mut met = vec![false; scene.shapes.len()];
        for step in 0..30_000 {
            let way = square_to_cosine_hemisphere([random.unit() as f32, random.unit() as f32]);
            let (u, v) = normal.any_orthonormal_pair();
            let hit = world.closest_hit(&point.ray(u * way.x + v * way.y + normal * way.z));
            let hit = hit.unwrap_or_else(|| panic!("{name}: nothing is hit, step {step}"));
            let label = &scene.shapes[hit.shape as usize].label;
            assert!(hit.front, "{name}: {label} is seen from behind at {}", hit.position);
            met[hit.shape as usize] = true;
            (point, normal) = (hit.point(), hit.geometric_normal);
        }
        assert!(met.iter().all(|met| *met), "{name}: some shape is seen from nowhere: {met:?}");
    }
}

#[test]
fn the_cie_cube_has_its_size_light_and_reflectance() {
    let scene = with("cie-171-5-8", &[("reflectance", "0.95")]);
    let sides = shape(&scene, "sides");
    assert!((sides.geometry.area() - 96.0).abs() <= 1e-12);
    assert_eq!(reflectance(&scene, sides), &SpectrumKind::Constant(0.95));
    let [Emitter::Point { position, intensity }] = &scene.emitters[..] else { panic!("{:?}", scene.emitters) };
    assert_eq!(*position, DVec3::new(0.0, 0.0, 2.0));
    let flux = 4.0 * PI * scene.spectrum(*intensity).kind.photometric();
    assert!((flux / 1e4 - 1.0).abs() <= 1e-12, "{flux} lm");
}

#[test]
fn all_sides_of_the_furnace_shine_alike() {
    let scene = with("furnace", &[("reflectance", "0.9"), ("radiance", "0.1")]);
    assert_eq!((scene.shapes.len(), scene.emitters.len()), (6, 6));
    for (shape, emitter) in scene.shapes.iter().zip(&scene.emitters) {
        let Emitter::Area { radiance, .. } = emitter else { panic!("{emitter:?}") };
        assert_eq!(scene.spectrum(*radiance).kind, SpectrumKind::Constant(0.1));
        assert_eq!(reflectance(&scene, shape), &SpectrumKind::Constant(0.9));
        assert!((shape.geometry.area() - 4.0).abs() <= 1e-12);
    }
}

/// The lamps of the lounge send light straight to the ceiling, and a little to the tops of the walls.
#[test]
fn the_lounge_is_lit_by_way_of_its_ceiling() {
    let scene = with("lounge", &[]);
    let lamps: Vec<_> = scene.shapes.iter().filter(|shape| shape.emitter.is_some()).collect();
    assert_eq!(lamps.len(), 4);
    for lamp in lamps {
        let Geometry::Rectangle { center, normal, .. } = lamp.geometry else { panic!("{}", lamp.label) };
        assert!((normal - DVec3::Y).length() <= 1e-12, "{}", lamp.label);
        // From the far edge of the pot's bottom over its rim, 0.4 m up and as far across, to the ceiling 1 m further up.
        let reach = 0.2 + 1.0;
        for wall in [center.x, 6.0 - center.x, center.z, 5.0 - center.z] {
            assert!(wall + 1e-12 >= reach, "{}: a wall {wall} m away has direct light", lamp.label);
        }
    }
    let paints = |id: &str| reflectance(&scene, shape(&scene, id)).clone();
    let is = |id: &str, file: &str| {
        let BsdfKind::Diffuse { reflectance } = scene.bsdf(shape(&scene, id).bsdf).kind else { panic!("{id}") };
        let label = &scene.spectrum(reflectance).label;
        assert!(label.starts_with(&format!("spectra/colorchecker_{file}.spd ")), "{id}: {label}");
    };
    is("ceiling", "blue");
    is("sofa", "red");
    assert_eq!(paints("sofa"), paints("painting_left"));
    is("back_wall", "light_skin");
}

fn table(kind: &SpectrumKind) -> [f64; 81] {
    let SpectrumKind::Table { wavelengths, values } = kind else { panic!("{kind:?}") };
    assert_eq!(wavelengths.len(), 81);
    assert!(wavelengths.iter().zip((380..).step_by(5)).all(|(w, nm)| *w == f64::from(nm)));
    core::array::from_fn(|i| values[i])
}

/// The linoleum reflects the 17.5 % under illuminant A that the thesis states, plaster 80 %; four luminaires have the flux that is asked for.
#[test]
fn the_room_for_colour_rendering_has_what_is_known_of_it() {
    let grid = SumGrid::CIE_5NM;
    let (observer, light) = (grid.observer::<f64>(&CIE_1931_2), grid.sample::<f64, _>(&A.spectrum(Outside::Zero)));
    let luminous = |paint: &[f64; 81]| {
        let seen = core::array::from_fn(|i| light[i] * paint[i]);
        tristimulus_sum(&observer, &seen)[1] / tristimulus_sum(&observer, &light)[1]
    };
    for linoleum in ["red", "moderate_red"] {
        let scene = with("cri-room", &[("linoleum", linoleum), ("flux", "3000")]);
        // The file's factor is from the integral, this is the sum at 5 nm: 1e-3 apart.
        assert!((luminous(&table(reflectance(&scene, shape(&scene, "floor")))) / 0.175 - 1.0).abs() <= 1e-3);
        for id in ["ceiling", "wall_plus_x", "wall_minus_x", "wall_plus_y", "wall_minus_y"] {
            assert!((luminous(&table(reflectance(&scene, shape(&scene, id)))) / 0.8 - 1.0).abs() <= 1e-3, "{id}");
        }
        assert_eq!(scene.emitters.len(), 4);
        for emitter in &scene.emitters {
            let Emitter::Luminaire { luminaire, spectrum, .. } = emitter else { panic!("{emitter:?}") };
            assert!((luminaire.intensity().flux() / 3000.0 - 1.0).abs() <= 1e-12);
            // Nothing beyond the cut-off: ceiling and upper walls are dark but for reflected light.
            assert_eq!(luminaire.intensity().zonal_flux(70.0, 180.0), 0.0);
            let quarter = luminaire.position.abs();
            assert_eq!((quarter.x, quarter.y, luminaire.position.z), (1.5, 1.5, 2.98));
            assert!((scene.spectrum(*spectrum).kind.photometric() - 1.0).abs() <= 1e-9);
        }
    }
}

/// The lamps' files are the CIE's tables, all of the same luminance.
#[test]
fn lamps_are_those_of_the_cie() {
    let lamps: [(&str, &UniformTable); 5] =
        [("fl2", &FL2), ("fl7", &FL7), ("fl3_14", &FL3_14), ("fl3_15", &FL3_15), ("led_v2", &LED_V2)];
    for (name, cie) in lamps {
        let scene = with("neumann-schanda", &[("lamp", name)]);
        let [Emitter::Area { radiance, .. }] = &scene.emitters[..] else { panic!("{:?}", scene.emitters) };
        let kind = &scene.spectrum(*radiance).kind;
        let (found, cie) = (table(kind), SumGrid::CIE_5NM.sample::<f64, _>(&cie.spectrum(Outside::Zero)));
        let scale = found.iter().sum::<f64>() / cie.iter().sum::<f64>();
        // Six digits are written.
        assert!(found.iter().zip(cie).all(|(f, c)| (f - scale * c).abs() <= 1e-5 * f), "{name}");
        // ∫Lȳ = 40 × 106.7502594 nm, as for the lamps of the Cornell boxes.
        let luminance = kind.photometric() / 683.002 / 106.750_259_4;
        assert!((luminance / 40.0 - 1.0).abs() <= 1e-5, "{name}: {luminance}");
    }
}

/// Every paint and lamp that the comments name is there, and others are refused.
#[test]
fn the_cube_takes_the_paints_that_its_comment_names() {
    let paints = "red, orange_yellow, yellow, yellow_green, green, foliage, blue, purplish_blue, magenta, light_skin, dark_skin, neutral_8, white_9_5";
    for paint in paints.split(", ") {
        let scene = with("neumann-schanda", &[("paint", paint)]);
        let first = reflectance(&scene, &scene.shapes[0]).clone();
        assert!(scene.shapes.iter().all(|shape| *reflectance(&scene, shape) == first), "{paint}");
        let area: f64 = scene.shapes.iter().map(|shape| shape.geometry.area()).sum();
        assert!((area - 54.0).abs() <= 1e-12, "{area} m²");
    }
    let parameters = [("paint".to_owned(), "mauve".to_owned())];
    let error = builtin::load("neumann-schanda", &parameters).unwrap_err().to_string();
    assert!(error.contains("cannot read \"spectra/colorchecker_mauve.spd\""), "{error}");
}
