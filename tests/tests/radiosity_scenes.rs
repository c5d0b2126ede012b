//! Radiosity in scenes with shadows and colours: against paths traced at random, and component by component.
#![allow(clippy::unwrap_used, reason = "helpers of tests fail by panicking")]

use disk_sampling::Receiver;
use renderers::direct;
use renderers::geometry::glam::Vec3A;
use renderers::geometry::sampling::square_to_cosine_hemisphere;
use renderers::geometry::{Hit, SurfacePoint, World};
use renderers::radiosity::{Flat, IndirectRadiosity, Radiosity, Representation, Settings, Tristimulus};
use renderers::scene::{Scene, Source, builtin, load};
use renderers::spectral::{Components, Factor, Palette, UniformBins};
use spectral_tests::generators::Draw;
use spectral_tests::irradiance::{Walker, spectra};

/// A room of 2 m, open to −y, with a block on the floor and a lamp under the ceiling; all surfaces reflect the same.
const RHO: f64 = 0.6;

fn room() -> Scene {
    let material = format!("<bsdf type='diffuse'><spectrum name='reflectance' value='{RHO}'/></bsdf>");
    let face = |turn: &str, centre: &str, more: &str| {
        format!(
            "<shape type='rectangle'><transform name='to_world'>{turn}<translate {centre}/></transform>{material}{more}</shape>"
        )
    };
    let body = face("", "z='-1'", "")
        + &face("<rotate x='1' angle='180'/>", "z='1'", "")
        + &face("<rotate y='1' angle='90'/>", "x='-1'", "")
        + &face("<rotate y='1' angle='-90'/>", "x='1'", "")
        + &face("<rotate x='1' angle='90'/>", "y='1'", "")
        + &face(
            "<scale value='0.4'/><rotate x='1' angle='180'/>",
            "z='0.98'",
            "<emitter type='area'><spectrum name='radiance' value='1'/></emitter>",
        );
    let block = format!(
        "<shape type='cube'><transform name='to_world'><scale x='0.3' y='0.3' z='0.5'/><rotate z='1' angle='20'/>
        <translate x='0.2' y='0.1' z='-0.5'/></transform>{material}</shape>"
    );
    let xml = format!(
        "<scene version='3.0.0'><sensor type='perspective'><float name='fov' value='40'/></sensor>{body}{block}</scene>"
    );
    load(&Source::text("room.xml", xml), &[]).unwrap()
}

/// Indirect irradiance by random walks that end at the first surface without a front or by absorption: independent of patches, links and
/// form factors. Mean and standard deviation of the mean.
#[allow(clippy::cast_possible_truncation, reason = "rays are traced in f32")]
fn traced(world: &World, lamp: u32, position: [f64; 3], normal: [f64; 3], paths: u32) -> (f64, f64) {
    let vector = |v: [f64; 3]| Vec3A::from_array(v.map(|x| x as f32));
    let start = SurfacePoint::new(vector(position), vector(normal));
    let mut random = Draw::new(0x5eed);
    let (mut sum, mut squares) = (0.0, 0.0);
    for _ in 0..paths {
        let (mut point, mut normal, mut weight, mut found) = (start, vector(normal), 1.0, 0.0);
        for bounce in 0..60 {
            let way = square_to_cosine_hemisphere([random.unit() as f32, random.unit() as f32]);
            let (u, v) = normal.any_orthonormal_pair();
            let Some(hit) = world.closest_hit(&point.ray(u * way.x + v * way.y + normal * way.z)) else { break };
            let hit: Hit = hit;
            if !hit.front {
                break;
            }
            if hit.shape == lamp && bounce > 0 {
                found += weight * core::f64::consts::PI;
            }
            weight *= RHO;
            (point, normal) = (hit.point(), hit.geometric_normal);
        }
        sum += found;
        squares += found * found;
    }
    let n = f64::from(paths);
    let mean = sum / n;
    (mean, ((squares / n - mean * mean) / n).sqrt())
}

#[test]
fn agrees_with_random_walks() {
    let scene = room();
    let world = direct::world(&scene).unwrap();
    let settings = Settings { accuracy: 3e-3, ..Settings::default() };
    let radiosity = Radiosity::new(&scene, &settings, &mut Palette::default(), &|_| {}).unwrap();
    let solution = radiosity.solve(&Flat).unwrap();
    for (position, normal) in [
        ([-0.5, -0.3, -1.0], [0.0, 0.0, 1.0]),
        // Beside the block, in its shade.
        ([0.6, 0.4, -1.0], [0.0, 0.0, 1.0]),
        ([0.2, 0.1, 0.0], [0.0, 0.0, 1.0]),
        ([-1.0, 0.0, -0.4], [1.0, 0.0, 0.0]),
    ] {
        let found = solution.indirect(&Receiver::new(position, normal).unwrap())[0];
        let (exact, deviation) = traced(&world, 5, position, normal, 400_000);
        let tolerance = 4.0 * deviation + 3.0 * settings.accuracy * exact;
        assert!((found - exact).abs() <= tolerance, "{position:?}: {found}, by paths {exact} ± {deviation}");
    }
}

/// One component of another representation.
#[derive(Debug)]
struct Single<'b>(&'b dyn Representation, usize);

impl Single<'_> {
    fn with(&self, row: &mut [f64], change: impl Fn(&mut [f64])) {
        let mut all = vec![row[0]; self.0.width()];
        change(&mut all);
        row[0] = all[self.1];
    }
}

impl Representation for Single<'_> {
    fn width(&self) -> usize {
        1
    }
    fn light(&self, factor: Factor, row: &mut [f64]) {
        self.with(row, |all| self.0.light(factor, all));
    }
    fn reflect(&self, factor: Factor, row: &mut [f64]) {
        self.with(row, |all| self.0.reflect(factor, all));
    }
    fn colour(&self, _: &[u32], _: &[f64]) -> Tristimulus {
        Tristimulus::default()
    }
}

#[test]
fn one_operator_serves_all_spectra() {
    let scene = builtin::load("cornell-box", &[]).unwrap();
    let mut palette = Palette::default();
    let settings = Settings { accuracy: 3e-2, ..Settings::default() };
    let radiosity = Radiosity::new(&scene, &settings, &mut palette, &|_| {}).unwrap();
    let (bins, rgb) = (UniformBins::new(&palette, 81).unwrap(), Components::naive(&palette).unwrap());
    for (basis, components) in [(&bins as &dyn Representation, [0, 15, 16, 40, 80]), (&rgb, [0, 1, 2, 0, 1])] {
        let all = radiosity.solve(basis).unwrap();
        let report = all.report();
        assert!(report.iteration_error <= 1e-8 && report.energy_balance.abs() <= 1e-8, "{report:?}");
        for component in components {
            let single = Single(basis, component);
            let one = radiosity.solve(&single).unwrap();
            let largest = one.patches().fold(0.0_f64, |m, (b, _)| m.max(b[0]));
            for ((b, _), (c, _)) in all.patches().zip(one.patches()) {
                assert!((b[component] - c[0]).abs() <= 2e-8 * largest, "{component}: {} {}", b[component], c[0]);
            }
        }
    }
    // Red and green walls: what comes from them is coloured.
    let solution = radiosity.solve(&rgb).unwrap();
    let beside = |x: f64| solution.indirect(&Receiver::new([x, 100.0, 250.0], [0.0, 1.0, 0.0]).unwrap());
    let (left, right) = (beside(540.0), beside(10.0));
    assert!(left[0] / left[1] > 1.2 * right[0] / right[1], "{left:?} {right:?}");
    // The meter's interface gives the same light.
    let solution = radiosity.solve(&bins).unwrap();
    assert!(IndirectRadiosity::new(&solution, &UniformBins::new(&palette, 4).unwrap()).is_none());
    let light = IndirectRadiosity::new(&solution, &bins).unwrap();
    let place = renderers::scene::glam::DVec3::new(270.0, 0.0, 50.0);
    let found = renderers::illuminance::IndirectLight::irradiance(&light, place, renderers::scene::glam::DVec3::Y);
    let values = solution.indirect(&Receiver::new(place.to_array(), [0.0, 1.0, 0.0]).unwrap());
    assert!(found.lux > 0.0 && found.error <= 0.2 * found.lux);
    assert_eq!(found.spectrum.unwrap().values, values);
}

/// `independent`: indirect illuminance in lx with its standard deviation, by random walks (tests/src/bin/trace_irradiance.rs).
const WALKS: &str = include_str!("../data/cornell_irradiance.csv");

/// Position, normal, lux, deviation.
fn walks() -> impl Iterator<Item = [f64; 8]> {
    let row = |line: &str| line.split(", ").map(|x| x.parse().unwrap()).collect::<Vec<f64>>().try_into().unwrap();
    WALKS.lines().filter(|line| !line.starts_with('#')).map(row)
}

/// The bins that the walks were weighted with.
fn walked_bins(scene: &Scene, palette: &mut Palette) -> UniformBins {
    spectra(scene, palette);
    UniformBins::new(palette, 8).unwrap()
}

#[test]
fn cornell_box_is_as_accurate_as_asked_for() {
    let scene = builtin::load("cornell-box", &[]).unwrap();
    for accuracy in [3e-2, 1e-2] {
        let mut palette = Palette::default();
        let settings = Settings { accuracy, ..Settings::default() };
        let radiosity = Radiosity::new(&scene, &settings, &mut palette, &|_| {}).unwrap();
        let bins = walked_bins(&scene, &mut palette);
        let solution = radiosity.solve(&bins).unwrap();
        assert!(solution.report().points > 0);
        let light = IndirectRadiosity::new(&solution, &bins).unwrap();
        let mut count = 0;
        for [x, y, z, nx, ny, nz, lux, deviation] in walks() {
            let vector = renderers::scene::glam::DVec3::new;
            let found = renderers::illuminance::IndirectLight::irradiance(&light, vector(x, y, z), vector(nx, ny, nz));
            let off = (found.lux - lux).abs();
            assert!(off <= 4.0 * deviation + 3.0 * accuracy * lux, "{accuracy}: {x} {y} {z}: {} {lux}", found.lux);
            assert!(
                off <= 4.0 * deviation + found.error,
                "{accuracy}: {x} {y} {z}: {} ± {} {lux}",
                found.lux,
                found.error
            );
            count += 1;
        }
        assert!(count >= 48);
    }
}

/// A closed room with a lamp and 125 turned boxes: more faces than are linked all to all.
fn crowded_room() -> Scene {
    let grey = |rho: f64| format!("<bsdf type='diffuse'><spectrum name='reflectance' value='{rho}'/></bsdf>");
    let cube = |transform: &str, rest: &str| {
        format!("<shape type='cube'><transform name='to_world'>{transform}</transform>{rest}</shape>")
    };
    let mut body = cube("<scale value='2'/>", &(grey(0.7) + "<boolean name='flip_normals' value='true'/>"));
    body += "<shape type='rectangle'><transform name='to_world'><scale value='0.5'/><rotate x='1' angle='180'/>
        <translate z='1.9'/></transform><emitter type='area'><spectrum name='radiance' value='10'/></emitter></shape>";
    for index in 0..125 {
        let at = [index % 5, index / 5 % 5, index / 25].map(|i| f64::from(i) * 0.68 - 1.36);
        let (turn, axis) = (f64::from(index) * 137.5, (f64::from(index) * 0.618).fract());
        let transform = format!(
            "<scale value='0.14'/><rotate x='1' y='{axis}' z='0.5' angle='{turn}'/><translate x='{}' y='{}' z='{}'/>",
            at[0], at[1], at[2]
        );
        body += &cube(&transform, &grey(if index % 3 == 0 { 0.8 } else { 0.3 }));
    }
    let xml = format!(
        "<scene version='3.0.0'><sensor type='perspective'><float name='fov' value='40'/></sensor>{body}</scene>"
    );
    load(&Source::text("crowded.xml", xml), &[]).unwrap()
}

#[test]
fn a_crowded_room_agrees_with_random_walks() {
    let scene = crowded_room();
    let mut palette = Palette::default();
    let settings = Settings { accuracy: 1e-2, ..Settings::default() };
    let radiosity = Radiosity::new(&scene, &settings, &mut palette, &|_| {}).unwrap();
    let bins = walked_bins(&scene, &mut palette);
    let solution = radiosity.solve(&bins).unwrap();
    let light = IndirectRadiosity::new(&solution, &bins).unwrap();
    let walker = Walker::new(&scene, &mut palette, &bins).unwrap();
    eprintln!("{:?}", solution.report());
    for (position, normal) in [
        ([0.3, -0.4, -2.0], [0.0, 0.0, 1.0]),
        ([-1.7, 1.8, -2.0], [0.0, 0.0, 1.0]),
        ([2.0, 0.2, 0.1], [-1.0, 0.0, 0.0]),
        ([-0.9, 0.6, 2.0], [0.0, 0.0, -1.0]),
        ([0.34, 0.34, 0.34], [0.0, 0.6, 0.8]),
        ([-1.0, -1.0, -1.0], [0.6, -0.8, 0.0]),
    ] {
        let vector = |[x, y, z]: [f64; 3]| renderers::scene::glam::DVec3::new(x, y, z);
        let found = renderers::illuminance::IndirectLight::irradiance(&light, vector(position), vector(normal)).lux;
        let walked = walker.indirect(&Receiver::new(position, normal).unwrap(), 16);
        eprintln!(
            "{position:?}: {found} {walked:?} {:.4} ± {:.4}",
            found / walked.mean - 1.0,
            walked.deviation / walked.mean
        );
        let tolerance = 4.0 * walked.deviation + 3.0 * settings.accuracy * walked.mean;
        assert!((found - walked.mean).abs() <= tolerance, "{position:?}: {found}, by walks {walked:?}");
    }
}

/// The table of walks is what they find, up to chance.
#[test]
fn walks_find_what_is_in_their_table() {
    let scene = builtin::load("cornell-box", &[]).unwrap();
    let mut palette = Palette::default();
    let bins = walked_bins(&scene, &mut palette);
    let walker = Walker::new(&scene, &mut palette, &bins).unwrap();
    for [x, y, z, nx, ny, nz, lux, deviation] in walks().step_by(5) {
        let found = walker.indirect(&Receiver::new([x, y, z], [nx, ny, nz]).unwrap(), 16);
        let score = (found.mean - lux) / found.deviation.hypot(deviation);
        assert!(score.abs() <= 4.5, "{x} {y} {z}: {found:?} {lux}");
    }
}

/// `independent`: illuminance in lx with its standard deviation, by 1.6e7 paths of Mitsuba 3.9.1 for each point
/// (tests/peers/cornell_irradiance.py), and its direct part, which is exact.
#[test]
fn walks_agree_with_mitsuba() {
    let scene = builtin::load("cornell-box", &[]).unwrap();
    let mut palette = Palette::default();
    spectra(&scene, &mut palette);
    let bins = UniformBins::new(&palette, 81).unwrap();
    let walker = Walker::new(&scene, &mut palette, &bins).unwrap();
    for (position, normal, total, deviation, direct) in [
        ([278.0, 1.0, 279.5], [0.0, 1.0, 0.0], 138_897.1, 171.0, 96_420.5),
        ([100.0, 1.0, 100.0], [0.0, 1.0, 0.0], 17_609.7, 9.0, 0.0),
        ([400.0, 1.0, 120.0], [0.0, 1.0, 0.0], 122_617.8, 256.0, 102_152.0),
        ([100.0, 1.0, 450.0], [0.0, 1.0, 0.0], 148_177.0, 258.6, 91_159.6),
        ([278.0, 274.4, 558.0], [0.0, 0.0, -1.0], 178_629.2, 216.6, 127_835.0),
        ([1.5, 300.0, 200.0], [1.0, 0.0, 0.0], 180_203.7, 295.9, 129_919.0),
        ([188.0, 166.0, 165.0], [0.0, 1.0, 0.0], 241_475.9, 385.1, 203_651.0),
        ([550.0, 1.0, 279.0], [0.0, 1.0, 0.0], 13_896.5, 13.4, 196.316),
    ] {
        let found = walker.indirect(&Receiver::new(position, normal).unwrap(), 64);
        let indirect: f64 = total - direct;
        let score = (found.mean - indirect) / found.deviation.hypot(deviation);
        assert!(score.abs() <= 4.0, "{position:?}: {found:?}, by paths {indirect} ± {deviation}");
    }
}
