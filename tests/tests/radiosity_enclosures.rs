//! Radiosity in closed spaces, where conservation of energy gives the answer.
#![allow(clippy::unwrap_used, clippy::panic, reason = "helpers of tests fail by panicking")]

use core::f64::consts::PI;

use disk_sampling::Receiver;
use renderers::radiosity::{Flat, Radiosity, RadiosityError, Settings};
use renderers::scene::{Scene, Source, load};
use renderers::spectral::Palette;

const FLUX: f64 = 10_000.0;
/// Radiant intensity of an isotropic point source of that flux.
const INTENSITY: f64 = FLUX / (4.0 * PI);

fn scene(body: &str) -> Scene {
    let xml = format!(
        "<scene version='3.0.0'><sensor type='perspective'><float name='fov' value='40'/></sensor>{body}</scene>"
    );
    load(&Source::text("test.xml", xml), &[]).unwrap()
}

/// The cube of CIE 171 5.8: 4 m, all surfaces of one reflectance, seen from inside.
fn cube(reflectance: f64, rest: &str) -> Scene {
    scene(&format!(
        "<shape type='cube'><transform name='to_world'><scale value='2'/></transform>
        <boolean name='flip_normals' value='true'/>
        <bsdf type='diffuse'><spectrum name='reflectance' value='{reflectance}'/></bsdf></shape>{rest}"
    ))
}

fn lamp(position: [f64; 3]) -> String {
    let [x, y, z] = position;
    format!(
        "<emitter type='point'><point name='position' x='{x}' y='{y}' z='{z}'/><spectrum name='intensity' value='{INTENSITY}'/></emitter>"
    )
}

/// A side² grid of points on each face of the cube, nearer to each other at the edges, each with its share of the area: the midpoint
/// rule in t, where x is −2 + 4 t³ (6t² − 15t + 10), which is good at the edges, where irradiance changes like s ln s.
fn points_on_cube(side: u32) -> Vec<(Receiver<f64>, f64)> {
    let along = |i: u32| {
        let t = (f64::from(i) + 0.5) / f64::from(side);
        (4.0 * t.powi(3) * (t * (6.0 * t - 15.0) + 10.0) - 2.0, 30.0 * (t * (1.0 - t)).powi(2) / f64::from(side))
    };
    let mut points = Vec::new();
    for (axis, sign) in [(0, 1.0), (0, -1.0), (1, 1.0), (1, -1.0), (2, 1.0), (2, -1.0)] {
        for i in 0..side * side {
            let ((x, share_x), (y, share_y)) = (along(i % side), along(i / side));
            let (mut position, mut normal) = ([0.0; 3], [0.0; 3]);
            position[axis] = 2.0 * sign;
            position[(axis + 1) % 3] = x;
            position[(axis + 2) % 3] = y;
            normal[axis] = -sign;
            points.push((Receiver::new(position, normal).unwrap(), share_x * share_y));
        }
    }
    let all: f64 = points.iter().map(|(_, share)| share).sum();
    points.iter_mut().for_each(|(_, share)| *share /= all);
    points
}

fn build(scene: &Scene, settings: &Settings) -> Radiosity {
    Radiosity::new(scene, settings, &mut Palette::default(), &|_| {}).unwrap()
}

#[test]
fn a_cube_keeps_all_light_at_every_reflectance() {
    for rho in [0.0, 0.05, 0.3, 0.7, 0.95, 0.99, 0.999] {
        for place in [[0.0; 3], [1.2, 0.7, -1.1]] {
            let radiosity = build(&cube(rho, &lamp(place)), &Settings::default());
            let solution = radiosity.solve(&Flat).unwrap();
            let exact = FLUX * rho / (96.0 * (1.0 - rho));
            let patches: f64 = solution.patches().map(|(b, area)| b[0] * area).sum::<f64>() / 96.0;
            // The iteration's own tolerance.
            assert!((patches - exact).abs() <= 1e-8 * exact, "{rho}: {patches} {exact}");
            let report = solution.report();
            assert!(report.energy_balance.abs() <= 1e-8 && report.iteration_error <= 1e-8, "{rho}: {report:?}");
            assert!(rho == 0.0 || (report.closed == 1.0 && report.uncertain_links == 0), "{rho}: {report:?}");
            let mean: f64 = points_on_cube(24).iter().map(|(p, share)| share * solution.indirect(p)[0]).sum();
            assert!((mean - exact).abs() <= 5e-4 * exact, "{rho}: {mean} {exact} {:e}", mean / exact - 1.0);
        }
    }
}

/// A closed room of faces that all send out radiance 1 and reflect ρ, with or without blocks in it that do the same.
fn furnace(rho: f64, with_blocks: bool) -> Scene {
    let material = format!(
        "<bsdf type='diffuse'><spectrum name='reflectance' value='{rho}'/></bsdf>
        <emitter type='area'><spectrum name='radiance' value='1'/></emitter>"
    );
    let block = |transform: &str| {
        format!("<shape type='cube'><transform name='to_world'>{transform}</transform>{material}</shape>")
    };
    let blocks = block("<scale value='0.3'/><rotate y='1' angle='17'/><translate x='-0.4' y='-1.2' z='0.5'/>")
        + &block("<scale value='0.4'/><translate x='0.6' y='0.2' z='-0.1'/>");
    scene(&format!(
        "<shape type='cube'><transform name='to_world'><scale x='2' y='1.5' z='1'/></transform>
        <boolean name='flip_normals' value='true'/>{material}</shape>{}",
        if with_blocks { blocks.as_str() } else { "" }
    ))
}

#[test]
fn furnaces_are_as_bright_as_they_must_be() {
    for (with_blocks, tolerance) in [(false, 1e-9), (true, 1e-6)] {
        for rho in [0.2, 0.8, 0.99, 0.999] {
            let settings = Settings { residual: 1e-11, accuracy: 3e-2, ..Settings::default() };
            let radiosity = build(&furnace(rho, with_blocks), &settings);
            let solution = radiosity.solve(&Flat).unwrap();
            let exact = PI * rho / (1.0 - rho);
            let mut hidden = 0.0;
            for (b, area) in solution.patches() {
                if b[0] == 0.0 {
                    hidden += area;
                } else {
                    let error = (b[0] / exact - 1.0).abs();
                    assert!(error <= tolerance, "{rho}: {} {exact} {:?}", b[0], solution.report());
                }
            }
            // One block stands on the floor: nothing gets between.
            let expected = if with_blocks { 2.0 * 0.36 } else { 0.0 };
            assert!((hidden - expected).abs() <= 1e-9, "{hidden} {expected}");
            // The reflected light arrives everywhere, too: exactly, as the factors of all patches are.
            let receiver = Receiver::new([0.3, -0.9, -1.0], [0.0, 0.0, 1.0]).unwrap();
            let found = solution.indirect(&receiver)[0];
            assert!((found - exact).abs() <= (10.0 * tolerance).max(2e-3 * f64::from(u8::from(with_blocks))) * exact);
        }
    }
}

#[test]
fn so_many_reflections_as_are_asked_for() {
    let rho: f64 = 0.6;
    for bounces in 0..4 {
        let settings = Settings { bounces: Some(bounces), accuracy: 3e-2, ..Settings::default() };
        let radiosity = build(&furnace(rho, false), &settings);
        let exact: f64 = (1..=bounces).map(|k| PI * rho.powi(i32::try_from(k).unwrap())).sum();
        for (b, _) in radiosity.solve(&Flat).unwrap().patches() {
            assert!((b[0] - exact).abs() <= 1e-9, "{bounces}: {} {exact}", b[0]);
        }
    }
}

#[test]
fn a_sphere_is_evenly_lit() {
    let rho = 0.7;
    let body = format!(
        "<shape type='sphere'><float name='radius' value='2'/><boolean name='flip_normals' value='true'/>
        <bsdf type='diffuse'><spectrum name='reflectance' value='{rho}'/></bsdf></shape>{}",
        lamp([0.0; 3])
    );
    let solution = build(&scene(&body), &Settings::default());
    let solution = solution.solve(&Flat).unwrap();
    let exact = FLUX * rho / (16.0 * PI * (1.0 - rho));
    for direction in [[1.0, 0.0, 0.0], [0.48, -0.6, 0.64], [0.0, 0.6, 0.8]] {
        let position = direction.map(|x: f64| 1.9 * x);
        let receiver = Receiver::new(position, direction.map(|x| -x)).unwrap();
        let found = solution.indirect(&receiver)[0];
        // The polyhedron's 320 faces are not at one distance: a per mille or two.
        assert!((found - exact).abs() <= 5e-3 * exact, "{direction:?}: {found} {exact}");
    }
}

/// Two rooms in one hull, with a wall between them that is a sheet: nothing passes, though floor and walls go through under it.
fn two_rooms(rest: &str) -> Scene {
    scene(&format!(
        "<shape type='cube'><transform name='to_world'><scale x='2' y='1.5' z='1'/></transform>
        <boolean name='flip_normals' value='true'/>
        <bsdf type='diffuse'><spectrum name='reflectance' value='0.8'/></bsdf></shape>
        <shape type='rectangle'><transform name='to_world'><scale x='1' y='1.5' z='1'/><rotate y='1' angle='90'/>
        <translate x='0.37'/></transform><bsdf type='twosided'><bsdf type='diffuse'>
        <spectrum name='reflectance' value='0.8'/></bsdf></bsdf></shape>{rest}{}",
        lamp([-0.5, 0.3, 0.2])
    ))
}

#[test]
fn no_light_through_walls() {
    let radiosity = build(&two_rooms(""), &Settings { accuracy: 1e-2, ..Settings::default() });
    let solution = radiosity.solve(&Flat).unwrap();
    let (dark, lit): (Vec<_>, Vec<_>) = solution.patches().partition(|(b, _)| b[0] == 0.0);
    let area = |patches: &[(&[f64], f64)]| patches.iter().map(|(_, area)| area).sum::<f64>();
    // 1.63 × 3 × 2 m, seen from inside.
    let expected = 2.0 * (1.63 * 3.0 + 1.63 * 2.0 + 3.0 * 2.0);
    assert!((area(&dark) - expected).abs() <= 1e-6 * expected, "{} {expected}", area(&dark));
    let beyond = Receiver::new([0.5, 0.1, -1.0], [0.0, 0.0, 1.0]).unwrap();
    assert_eq!(solution.indirect(&beyond), [0.0]);
    // On the bright side all light is kept.
    let surface = 2.0 * (2.37 * 3.0 + 2.37 * 2.0 + 3.0 * 2.0);
    assert!((area(&lit) - surface).abs() <= 1e-6 * surface);
    let sum: f64 = lit.iter().map(|(b, area)| b[0] * area).sum();
    let exact = FLUX * 0.8 / 0.2;
    assert!((sum - exact).abs() <= 1e-6 * exact, "{sum} {exact} {:?}", solution.report());
}

/// The same with a block that goes through the wall and stands on the floor: no light gets past its edges.
#[test]
fn no_light_along_a_block_in_a_wall() {
    let block =
        "<shape type='cube'><transform name='to_world'><scale x='0.5' y='0.3' z='0.4'/><rotate z='1' angle='30'/>
        <translate x='0.3' y='0.1' z='-0.6'/></transform>
        <bsdf type='diffuse'><spectrum name='reflectance' value='0.8'/></bsdf></shape>";
    let radiosity = build(&two_rooms(block), &Settings { accuracy: 1e-2, ..Settings::default() });
    let solution = radiosity.solve(&Flat).unwrap();
    for [x, y, z] in [[0.5, 0.9, -1.0], [0.371, 0.6, -1.0], [0.371, -0.4, -1.0], [1.2, 0.1, -1.0]] {
        let beyond = Receiver::new([x, y, z], [0.0, 0.0, 1.0]).unwrap();
        assert_eq!(solution.indirect(&beyond), [0.0], "{x} {y} {z}");
    }
    let before = Receiver::new([-0.5, 0.1, -1.0], [0.0, 0.0, 1.0]).unwrap();
    assert!(solution.indirect(&before)[0] > 0.0);
    // Nothing shines in the dark room: half of the surfaces and more, but for what is inside the block.
    let dark: f64 = solution.patches().filter(|(b, _)| b[0] == 0.0).map(|(_, area)| area).sum();
    assert!(dark > 0.9 * 2.0 * (1.63 * 3.0 + 1.63 * 2.0 + 3.0 * 2.0), "{dark}");
}

#[test]
fn threads_change_nothing() {
    let scene = furnace(0.8, true);
    let settings = Settings { accuracy: 3e-2, ..Settings::default() };
    let run = |threads: usize| {
        let pool = rayon_pool(threads);
        pool.install(|| {
            let radiosity = build(&scene, &settings);
            let solution = radiosity.solve(&Flat).unwrap();
            let receiver = Receiver::new([0.3, -0.9, -1.0], [0.0, 0.0, 1.0]).unwrap();
            let mut bits: Vec<u64> = solution.patches().map(|(b, _)| b[0].to_bits()).collect();
            bits.push(solution.indirect(&receiver)[0].to_bits());
            bits
        })
    };
    let one = run(1);
    assert!(one.len() > 100);
    for threads in [2, 3, 7] {
        assert!(run(threads) == one, "{threads} threads");
    }
}

fn rayon_pool(threads: usize) -> rayon::ThreadPool {
    rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap()
}

#[test]
fn what_has_no_solution_is_refused() {
    let new = |body: &str, settings: &Settings| {
        Radiosity::new(&scene(body), settings, &mut Palette::default(), &|_| {}).err()
    };
    let settings = Settings::default();
    let mirror = "<shape type='cube'><bsdf type='conductor'/></shape>";
    assert!(matches!(new(mirror, &settings), Some(RadiosityError::Material { .. })));
    assert!(matches!(new("", &settings), Some(RadiosityError::NothingDiffuse)));
    let sky = "<shape type='cube'/><emitter type='constant'/>";
    assert!(matches!(new(sky, &settings), Some(RadiosityError::Light { .. })));
    let small = Settings { memory: 1000, ..settings };
    let error = new("<shape type='cube'/>", &small).unwrap();
    assert!(matches!(error, RadiosityError::TooLarge { .. }) && error.to_string().contains("6 patches"), "{error}");
    // All light comes back for ever in a closed white room, though not in one of which a face is missing.
    let white = build(&cube(1.0, &lamp([0.0; 3])), &settings);
    assert_eq!(white.solve(&Flat).err(), Some(RadiosityError::NoSolution));
    let open = "<shape type='rectangle'><bsdf type='diffuse'><spectrum name='reflectance' value='1'/></bsdf></shape>
        <shape type='rectangle'><transform name='to_world'><rotate x='1' angle='180'/><translate z='1'/></transform>
        <bsdf type='diffuse'><spectrum name='reflectance' value='1'/></bsdf></shape>";
    let open = build(&scene(&(open.to_owned() + &lamp([0.0, 0.0, 0.5]))), &settings);
    assert!(open.solve(&Flat).unwrap().patches().all(|(b, _)| b[0] > 0.0 && b[0].is_finite()));
}
