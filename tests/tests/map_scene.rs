//! Maps against closed forms, against `spectral light` and against what `spectral illuminance` computes at points.
#![allow(clippy::unwrap_used, reason = "helpers of tests fail by panicking")]
#![allow(clippy::print_stdout, reason = "tables for people who run the test with --nocapture")]

use core::f64::consts::PI;
use core::fmt::Write as _;

use renderers::geometry::{Camera, FovAxis};
use renderers::illuminance::{self, ColourMeter, Meter, Nanometres, SpectralIndirect};
use renderers::light::{LightReport, SpectralTable, report};
use renderers::map::{Map, MapOptions, Maps, Of, Quantity, of_scene};
use renderers::radiosity::{IndirectRadiosity, Radiosity, Settings};
use renderers::render::{BetweenOptions, Renderer, Watch};
use renderers::scene::glam::DVec3;
use renderers::scene::{Scene, Source, builtin, load};
use renderers::spectral::{Palette, UniformBins};
use spectral_core::tables::find_light;

struct Silent;

impl Watch for Silent {
    fn stage(&self, _: &str, _: u64) {}
    fn add(&self, _: u64) {}
}

fn options(quantities: &[Quantity], size: [u32; 2]) -> MapOptions {
    MapOptions {
        quantities: quantities.to_vec(),
        of: None,
        renderer: None,
        size: Some(size),
        samples: None,
        between: BetweenOptions::default(),
        step: None,
    }
}

fn maps(scene: &Scene, options: &MapOptions) -> Maps {
    of_scene(scene, options, &Silent).unwrap()
}

fn value(map: &Map, x: usize, y: usize) -> f64 {
    f64::from(*map.values.get(x, y).unwrap())
}

fn scene(lamp: &str, integrator: &str) -> Scene {
    seen_at(lamp, integrator, 40)
}

fn seen_at(lamp: &str, integrator: &str, angle: u32) -> Scene {
    let xml = format!(
        "<scene version='3.0.0'><integrator type='{integrator}'/>
        <sensor type='perspective'><float name='fov' value='{angle}'/>
        <transform name='to_world'><lookat origin='4 0 3' target='0 0 0' up='0 0 1'/></transform></sensor>
        <shape type='rectangle'><transform name='to_world'><scale value='2'/></transform>
        <bsdf type='diffuse'><spectrum name='reflectance' value='0.5'/></bsdf></shape>
        <shape type='disk'><transform name='to_world'><scale value='0.5'/><rotate x='1' angle='180'/><translate z='2'/></transform>
        <emitter type='area'><spectrum name='radiance' value='{lamp}'/></emitter></shape></scene>"
    );
    load(&Source::text("plane.xml", &xml), &[]).unwrap()
}

/// The nodes of a table as a scene has them, and what `spectral light` says of it.
fn lamp(name: &str) -> (String, LightReport) {
    let table = find_light(name).unwrap();
    let mut nodes = String::new();
    for (index, power) in table.samples.double.iter().enumerate() {
        let comma = if index > 0 { ", " } else { "" };
        write!(nodes, "{comma}{}:{power}", usize::from(table.first) + usize::from(table.step) * index).unwrap();
    }
    (nodes, report(name, &SpectralTable::from(table)).unwrap())
}

const MEASURES: [Quantity; 7] = [
    Quantity::Illuminance,
    Quantity::Cct,
    Quantity::Duv,
    Quantity::Ra,
    Quantity::Cri00,
    Quantity::Acv,
    Quantity::Melanopic,
];

/// A lamp alone above a plane: all measures of colour are those of the lamp everywhere, at 5 nm and, for a light of lines, at 1 nm.
#[test]
fn one_lamp_has_its_own_measures_everywhere() {
    for name in ["FL2", "FL11", "HP1", "D65"] {
        let (nodes, light) = lamp(name);
        let scene = scene(&nodes, "direct");
        let made = maps(&scene, &options(&MEASURES, [33, 25]));
        assert_eq!(made.renderer, Renderer::Whitted);
        assert_eq!(made.step, Some(light.grid.step));
        let expected =
            [light.cct, light.duv, light.ra.unwrap(), light.cri00_munsell.unwrap(), light.acv, light.melanopic_der];
        for (map, expected) in made.maps[1..].iter().zip(expected) {
            let found = &map.statistics;
            // Maps are in f32; R_a and CRI00 by the interpolated reference lights are within 1e-10.
            let tolerance = 4.0 * f64::from(f32::EPSILON) * expected.abs().max(1.0);
            for value in [found.min, found.max, found.mean, found.median] {
                assert!((value - expected).abs() <= tolerance, "{name}, {}: {value}, {expected}", map.quantity);
            }
            assert!(found.without_surface > 0 && found.without_value == found.without_surface, "{found:?}");
        }
        // The middle of the picture is the origin: r²/(r² + h²) of π L.
        let lux = PI * light.luminous_efficacy * light.power * 0.25 / (0.25 + 4.0);
        let found = value(&made.maps[0], 16, 12);
        // The integral over 1 nm colour-matching functions against sums over the lamp's grid; and rays in f32.
        assert!((found - lux).abs() <= 2e-3 * lux, "{name}: {found} {lux}");
    }
}

/// Luminance of a diffuse plane is its reflectance times illuminance over π, and colours are those of the light, as the plane is grey.
#[test]
fn radiance_is_what_a_diffuse_plane_makes_of_irradiance() {
    let (nodes, _) = lamp("FL2");
    let scene = scene(&nodes, "direct");
    let both = maps(&scene, &options(&[Quantity::Illuminance, Quantity::Luminance], [33, 25]));
    let colour = |of| maps(&scene, &MapOptions { of: Some(of), ..options(&[Quantity::Ra, Quantity::Sy], [33, 25]) });
    let (falling, seen) = (colour(Of::Irradiance), colour(Of::Radiance));
    for (x, y) in [(16, 12), (10, 12), (20, 16), (16, 8)] {
        let expected = 0.5 / PI * value(&both.maps[0], x, y);
        let found = value(&both.maps[1], x, y);
        // Four rays in a pixel against its middle.
        assert!((found - expected).abs() <= 0.02 * expected, "{x}, {y}: {found} {expected}");
        assert!((value(&falling.maps[0], x, y) - value(&seen.maps[0], x, y)).abs() <= 1e-4);
        let photosynthesis = 0.5 / PI * value(&falling.maps[1], x, y);
        assert!((value(&seen.maps[1], x, y) - photosynthesis).abs() <= 0.02 * photosynthesis);
    }
}

/// Where a measure has no meaning, there is no value, and the reason is counted.
#[test]
fn what_has_no_meaning_has_no_value() {
    let quantities = [Quantity::Illuminance, Quantity::Sy, Quantity::Cct, Quantity::Duv, Quantity::Ra, Quantity::Acv];
    // Green light is far from the locus, which is still the nearest to some temperature.
    let green = seen_at("500:0, 520:1, 540:0", "direct", 80);
    let made = maps(&green, &options(&quantities, [33, 25]));
    let of = |quantity| made.maps.iter().find(|map| map.quantity == quantity).unwrap().statistics;
    for quantity in [Quantity::Cct, Quantity::Ra] {
        let found = of(quantity);
        assert!(found.without_value == found.pixels && found.mean.is_nan() && found.min.is_nan() && found.max.is_nan());
        assert!(found.without_light < found.pixels - found.without_surface);
    }
    assert!(of(Quantity::Duv).min > 0.05 && of(Quantity::Acv).min.is_finite() && of(Quantity::Illuminance).max > 0.0);
    // The lamp's back, seen from above, is lit by nothing: 0 lx, and no colour.
    let [lux, sy, colour] = [Quantity::Illuminance, Quantity::Sy, Quantity::Acv].map(of);
    assert!(lux.min == 0.0 && sy.min == 0.0 && lux.without_light == 0 && colour.without_light > 0);
    assert_eq!(colour.without_value, colour.without_light + colour.without_surface);
}

/// What sees no surface is not dark: there is no value, and that is the reason, for luminance and for measures of colour.
#[test]
fn what_sees_nothing_is_no_darkness() {
    let (nodes, _) = lamp("FL2");
    let quantities = [Quantity::Luminance, Quantity::Acv, Quantity::Luminance];
    let made = maps(&scene(&nodes, "direct"), &MapOptions { of: Some(Of::Radiance), ..options(&quantities, [33, 25]) });
    // A quantity that is asked for twice is measured once.
    assert_eq!(made.maps.len(), 2);
    for map in &made.maps {
        let found = &map.statistics;
        assert!(found.without_surface > 0 && found.without_value >= found.without_surface, "{found:?}");
        let (corner, seen) = (value(map, 0, 0), value(map, 16, 12));
        assert!(corner.is_nan() && seen > 0.0, "{}: {corner} {seen}", map.quantity);
        let background = map.values.pixels().iter().filter(|v| v.is_nan()).count();
        assert_eq!((found.without_value, found.without_light), (background, background - found.without_surface));
    }
    assert_eq!(made.maps[0].statistics.without_light, 0);
}

#[test]
fn what_makes_no_map_is_refused() {
    let (nodes, _) = lamp("FL2");
    let plane = scene(&nodes, "direct");
    let refused = |scene: &Scene, options: &MapOptions| of_scene(scene, options, &Silent).unwrap_err().to_string();
    let ra = options(&[Quantity::Ra], [8, 8]);
    for (said, options) in [
        (
            "illuminance is not a quantity of radiance",
            MapOptions { of: Some(Of::Radiance), ..options(&[Quantity::Illuminance], [8, 8]) },
        ),
        (
            "luminance is not a quantity of irradiance",
            MapOptions { of: Some(Of::Irradiance), ..options(&[Quantity::Luminance], [8, 8]) },
        ),
        ("no quantity to map", options(&[], [8, 8])),
        ("colour measures are sums at 1 or 5 nm, not at 3", MapOptions { step: Some(3), ..ra.clone() }),
        (
            "maps are made by whitted and radiosity, not by path",
            MapOptions { renderer: Some(Renderer::Path), ..ra.clone() },
        ),
        (
            "the accuracy must be in (0, 1], not 0",
            MapOptions {
                renderer: Some(Renderer::Radiosity),
                between: BetweenOptions { accuracy: 0.0, exact: false },
                ..ra.clone()
            },
        ),
    ] {
        assert_eq!(refused(&plane, &options), said);
    }
    let empty = "<scene version='3.0.0'><integrator type='direct'/><sensor type='perspective'><float name='fov' value='40'/></sensor>
        <emitter type='point'><spectrum name='intensity' value='1'/></emitter></scene>";
    let empty = load(&Source::text("empty.xml", empty), &[]).unwrap();
    assert_eq!(refused(&empty, &ra), "the scene has no surfaces, so that there is nothing to map");
}

/// The results are the same bits on one thread.
#[test]
fn threads_do_not_matter() {
    let room = builtin::load("cri-room", &[]).unwrap();
    let options = options(&[Quantity::Ra, Quantity::Illuminance], [24, 24]);
    let all = maps(&room, &options);
    let one = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap().install(|| maps(&room, &options));
    for (a, b) in all.maps.iter().zip(&one.maps) {
        let bits = |map: &Map| map.values.pixels().iter().map(|v| v.to_bits()).collect::<Vec<_>>();
        assert_eq!(bits(a), bits(b));
    }
}

/// Where the ray through the middle of a pixel meets the walls of the room of 6 m × 6 m × 3 m, and the wall's normal.
fn place(camera: &Camera, [x, y]: [f32; 2]) -> (DVec3, DVec3) {
    let ray = camera.ray(x + 0.5, y + 0.5);
    let (origin, direction) = (ray.origin.as_dvec3(), ray.direction.as_dvec3());
    let mut best = (f64::INFINITY, DVec3::ZERO);
    for (axis, ends) in [[-3.0, 3.0], [-3.0, 3.0], [0.0, 3.0]].into_iter().enumerate() {
        let end = if direction[axis] > 0.0 { ends[1] } else { ends[0] };
        let t = (end - origin[axis]) / direction[axis];
        if t > 0.0 && t < best.0 {
            let mut normal = DVec3::ZERO;
            normal[axis] = -direction[axis].signum();
            best = (t, normal);
        }
    }
    (origin + direction * best.0, best.1)
}

/// Pixels of a map show what `spectral illuminance --spectral` says of the place that they see: the room of figure 3.7, floor, walls and
/// ceiling.
#[test]
fn pixels_are_what_the_meter_reads_at_their_places() {
    const SIDE: u32 = 128;
    let room = builtin::load("cri-room", &[]).unwrap();
    let quantities = [Quantity::Illuminance, Quantity::Cct, Quantity::Ra, Quantity::Cri00];
    let made = maps(&room, &options(&quantities, [SIDE; 2]));
    assert_eq!((made.renderer, made.step), (Renderer::Radiosity, Some(5)));
    let mut palette = Palette::default();
    let radiosity = Radiosity::new(&room, &Settings::default(), &mut palette, &|_| {}).unwrap();
    let (bins, nanometres) = (UniformBins::new(&palette, 81).unwrap(), Nanometres::new(&palette).unwrap());
    let (coarse, fine) = (radiosity.solve(&bins).unwrap(), radiosity.solve(&nanometres).unwrap());
    let lux = IndirectRadiosity::new(&coarse, &bins).unwrap();
    let light = SpectralIndirect::new(&lux, &fine).unwrap();
    let meter = Meter::new(&room, illuminance::Settings::default(), Some(&light)).unwrap();
    let colours = ColourMeter::default();
    let camera = Camera::new(&room.camera.to_world, room.camera.fov, FovAxis::X, SIDE, SIDE).unwrap();
    for at in [[64, 120], [20, 110], [64, 92], [30, 85], [100, 72], [64, 62], [10, 60], [64, 30], [20, 10], [120, 5]] {
        let (position, normal) = place(&camera, at.map(|c: u16| f32::from(c)));
        let reading = meter.read(position, normal).unwrap();
        let colour = colours.measure(&meter, &reading).unwrap();
        let expected = [reading.lux, colour.cct, colour.ra.unwrap(), colour.cri00_munsell.unwrap()];
        let [x, y] = at.map(usize::from);
        let found: Vec<f64> = made.maps.iter().map(|map| value(map, x, y)).collect();
        println!("{at:?} {position:.2}: {found:.2?}, by the meter {expected:.2?}");
        // Radiosity aims at 2 % of indirect light; what that changes of the mixture of direct and red light is less.
        assert!((found[0] - expected[0]).abs() <= 0.02 * expected[0], "{at:?}");
        assert!((found[1] - expected[1]).abs() <= 0.01 * expected[1], "{at:?}");
        assert!((found[2] - expected[2]).abs() <= 0.5 && (found[3] - expected[3]).abs() <= 0.5, "{at:?}");
    }
}
