//! Illuminance at points: closed forms for every kind of light, with spectra integrated exactly.
#![allow(clippy::panic, clippy::unwrap_used, reason = "helpers of tests fail by panicking")]

use core::f64::consts::PI;

use renderers::geometry::glam::DVec3;
use renderers::illuminance::{IndirectIrradiance, IndirectLight, IndirectPart, Meter, MeterError, Reading, Settings};
use renderers::scene::{Scene, Source, load};
use spectral_core::action::MAXIMUM_LUMINOUS_EFFICACY;
use spectral_core::{Observer, spectrum::Constant, tristimulus};

const DIRECT: &str = "<integrator type='direct'/>";

fn scene(integrator: &str, body: &str) -> Scene {
    let xml = format!(
        "<scene version='3.0.0'>{integrator}<sensor type='perspective'><float name='fov' value='40'/></sensor>{body}</scene>"
    );
    load(&Source::text("test.xml", xml), &[]).unwrap()
}

fn read(scene: &Scene, position: [f64; 3], normal: [f64; 3]) -> Reading {
    let meter = Meter::new(scene, Settings::default(), None).unwrap();
    meter.read(DVec3::from(position), DVec3::from(normal)).unwrap()
}

/// Luminous efficacy times nm of a flat spectrum, by the core's integral.
fn flat() -> f64 {
    let [_, y, _] = tristimulus(&Observer::cie_1931_2deg(), &Constant::new(1.0).unwrap(), 380.0, 780.0);
    MAXIMUM_LUMINOUS_EFFICACY * y
}

#[track_caller]
fn assert_near(found: f64, expected: f64, relative: f64) {
    assert!((found - expected).abs() <= relative * expected.abs(), "{found}, expected {expected} within {relative}");
}

/// One light in a scene, with the irradiance that it must give at the origin, facing up, relative to its own unit.
fn lights() -> Vec<(&'static str, String, f64)> {
    let area = |kind: &str, transform: &str| {
        format!(
            "<shape type='{kind}'><transform name='to_world'>{transform}</transform>
            <emitter type='area'><spectrum name='radiance' value='1'/></emitter></shape>"
        )
    };
    let down = "<rotate x='1' angle='180'/>";
    let square = 4.0 * {
        let p = 2.0_f64.sqrt();
        (1.0 / p * (1.0 / p).atan() * 2.0) / 2.0
    };
    // The top of a cube from above is the same square.
    let cube = area("cube", &format!("{down}<translate z='2'/>"));
    vec![
        ("rectangle", area("rectangle", &format!("{down}<translate z='1'/>")), square),
        ("mesh", cube, square),
        ("disk", area("disk", &format!("{down}<translate z='1'/>")), PI / 2.0),
        ("sphere", area("sphere", "<scale value='0.5'/><translate z='2'/>"), PI / 16.0),
        (
            "point",
            "<emitter type='point'><point name='position' x='0' y='3' z='4'/><spectrum name='intensity' value='1'/></emitter>"
                .to_owned(),
            0.8 / 25.0,
        ),
        (
            "directional",
            "<emitter type='directional'><vector name='direction' x='3' y='0' z='-4'/><spectrum name='irradiance' value='1'/></emitter>"
                .to_owned(),
            0.8,
        ),
        ("constant", "<emitter type='constant'><spectrum name='radiance' value='1'/></emitter>".to_owned(), PI),
    ]
}

#[test]
fn every_kind_of_light_is_its_closed_form() {
    for (name, light, irradiance) in lights() {
        let reading = read(&scene(DIRECT, &light), [0.0; 3], [0.0, 0.0, 7.0]);
        assert_near(reading.lux, irradiance * flat(), 1e-12);
        assert!(reading.indirect_lux == Some(0.0) && reading.samples == 0, "{name}: {reading:?}");
        assert!(reading.error <= 1e-11 * reading.lux, "{name}: {reading:?}");
        let away = read(&scene(DIRECT, &light), [0.0; 3], [0.0, 0.0, -1.0]);
        // An environment is everywhere.
        assert!(if name == "constant" { away.lux == reading.lux } else { away.lux == 0.0 }, "{name}: {away:?}");
    }
    // All at once, their sum: none of them hides another from here, but for the environment, which they stand before.
    let all: String = ["rectangle", "point", "directional"]
        .iter()
        .map(|wanted| lights().into_iter().find(|(name, ..)| name == wanted).unwrap().1)
        .collect();
    let parts: f64 = lights().iter().filter(|(name, ..)| *name == "rectangle").map(|l| l.2).sum();
    let reading = read(&scene(DIRECT, &all), [0.0; 3], [0.0, 0.0, 1.0]);
    // The rectangle, from −1 to 1 at height 1, is in the way of both: of (0, 3, 4) at (0, 3/4, 1), of the parallel light at (−3/4, 0, 1).
    assert_near(reading.lux, parts * flat(), 1e-12);
}

/// Under a sky, before an infinite wall there is half of it; what a disk overhead hides is its configuration factor.
#[test]
fn a_sky_is_hidden_by_what_stands_before_it() {
    let sky = "<emitter type='constant'><spectrum name='radiance' value='1'/></emitter>";
    let wall = "<shape type='rectangle'><transform name='to_world'><rotate y='1' angle='90'/><scale value='1e5'/>
        <translate x='1'/></transform></shape>";
    let reading = read(&scene(DIRECT, &format!("{sky}{wall}")), [0.0; 3], [0.0, 0.0, 1.0]);
    assert_near(reading.lux, PI / 2.0 * flat(), 2e-5);
    let square = "<shape type='rectangle'><transform name='to_world'><translate z='1'/></transform></shape>";
    let p = 2.0_f64.sqrt();
    let hidden = 4.0 * (1.0 / p * (1.0 / p).atan());
    let reading = read(&scene(DIRECT, &format!("{sky}{square}")), [0.0; 3], [0.0, 0.0, 1.0]);
    assert_near(reading.lux, (PI - hidden) * flat(), 1e-12);
    let disk = "<shape type='disk'><transform name='to_world'><translate z='1'/></transform></shape>";
    let reading = read(&scene(DIRECT, &format!("{sky}{disk}")), [0.0; 3], [0.0, 0.0, 1.0]);
    assert!(reading.error <= 1e-3 * reading.lux);
    assert!((reading.lux - PI / 2.0 * flat()).abs() <= reading.error);
    // Inside a closed room nothing of it is seen.
    let room = "<shape type='cube'/>";
    assert_eq!(read(&scene(DIRECT, &format!("{sky}{room}")), [0.3, 0.2, 0.1], [0.6, 0.0, 0.8]).lux, 0.0);
}

/// The spectrum is the light's own times the irradiance, and lux is its integral.
#[test]
fn spectra_are_those_of_the_lights() {
    let body = "<shape type='disk'><transform name='to_world'><rotate x='1' angle='180'/><translate z='1'/></transform>
        <emitter type='area'><spectrum name='radiance' value='400:0, 500:2, 600:0'/></emitter></shape>
        <emitter type='point'><point name='position' x='0' y='0' z='0.5'/><spectrum name='intensity' value='3'/></emitter>";
    let scene = scene(DIRECT, body);
    let meter = Meter::new(&scene, Settings::default(), None).unwrap();
    let reading = meter.read(DVec3::ZERO, DVec3::Z).unwrap();
    for (wavelength, value) in [(390.0, 0.0), (450.0, 1.0), (500.0, 2.0), (550.0, 1.0), (700.0, 0.0)] {
        assert_near(meter.irradiance(&reading, wavelength), PI / 2.0 * value + 3.0 / 0.25, 1e-13);
    }
    // Simpson's rule between whole nanometres, of functions that are linear between them.
    let observer = Observer::cie_1931_2deg();
    let product = |w: f64| meter.irradiance(&reading, w) * observer.value(w)[1];
    let sum: f64 =
        (380..780).map(f64::from).map(|w| (product(w) + 4.0 * product(w + 0.5) + product(w + 1.0)) / 6.0).sum();
    assert_near(reading.lux, MAXIMUM_LUMINOUS_EFFICACY * sum, 1e-12);
}

struct Known(f64);

impl IndirectLight for Known {
    fn name(&self) -> &str {
        "known"
    }

    fn irradiance(&self, _: DVec3, _: DVec3) -> IndirectIrradiance {
        IndirectIrradiance { lux: self.0, error: 0.5, spectrum: None }
    }
}

#[test]
fn indirect_light_is_what_the_scene_asks_for() {
    let light = "<emitter type='point'><point name='position' x='0' y='0' z='1'/><spectrum name='intensity' value='1'/></emitter>";
    let ambient = "<emitter type='ambient'><spectrum name='radiance' value='0.25'/></emitter>";
    let path = |depth: i32| format!("<integrator type='path'><integer name='max_depth' value='{depth}'/></integrator>");
    let whitted = "<integrator type='whitted'/>".to_owned();
    for (integrator, body, part, indirect) in [
        (DIRECT.to_owned(), light.to_owned(), IndirectPart::NotAsked, Some(0.0)),
        (path(2), light.to_owned(), IndirectPart::NotAsked, Some(0.0)),
        (path(3), light.to_owned(), IndirectPart::NotComputed, None),
        (path(-1), light.to_owned(), IndirectPart::NotComputed, None),
        (whitted.clone(), light.to_owned(), IndirectPart::NotAsked, Some(0.0)),
        (whitted, light.to_owned() + ambient, IndirectPart::Ambient, Some(PI / 4.0 * flat())),
    ] {
        let scene = scene(&integrator, &body);
        let meter = Meter::new(&scene, Settings::default(), None).unwrap();
        assert_eq!(*meter.indirect_part(), part, "{integrator}");
        let reading = meter.read(DVec3::ZERO, DVec3::Z).unwrap();
        assert_near(reading.direct_lux, flat(), 1e-12);
        assert_eq!(reading.indirect_lux.is_some(), indirect.is_some(), "{integrator}");
        assert_near(reading.lux, flat() + indirect.unwrap_or(0.0), 1e-12);
        let known = Known(100.0);
        let meter = Meter::new(&scene, Settings::default(), Some(&known)).unwrap();
        let reading = meter.read(DVec3::ZERO, DVec3::Z).unwrap();
        let computed = *meter.indirect_part() == IndirectPart::Computed("known".to_owned());
        assert_eq!(computed, part == IndirectPart::NotComputed, "{integrator}");
        if computed {
            assert!(reading.indirect_lux == Some(100.0) && reading.error >= 0.5);
            assert_near(reading.lux, flat() + 100.0, 1e-12);
        }
    }
}

#[test]
fn bad_input_is_refused() {
    let inward =
        "<shape type='sphere' id='globe'><boolean name='flip_normals' value='true'/><emitter type='area'/></shape>";
    let refused = Meter::new(&scene(DIRECT, inward), Settings::default(), None).unwrap_err();
    assert!(
        matches!(refused, MeterError::Scene(_)) && refused.to_string().starts_with("globe (test.xml:1): "),
        "{refused}"
    );
    let empty = scene(DIRECT, "");
    for accuracy in [0.0, -1.0, 1e-6, 0.6, f64::NAN, f64::INFINITY] {
        assert!(matches!(Meter::new(&empty, Settings { accuracy }, None), Err(MeterError::Accuracy(_))), "{accuracy}");
    }
    let meter = Meter::new(&empty, Settings::default(), None).unwrap();
    for (position, normal) in [
        (DVec3::NAN, DVec3::Z),
        (DVec3::INFINITY, DVec3::Z),
        (DVec3::splat(1e13), DVec3::Z),
        (DVec3::ZERO, DVec3::ZERO),
        (DVec3::ZERO, DVec3::NAN),
        (DVec3::ZERO, DVec3::new(0.0, f64::INFINITY, 1.0)),
    ] {
        assert_eq!(meter.read(position, normal), Err(MeterError::Point), "{position} {normal}");
    }
    for size in [1e-300, 1e300] {
        assert_eq!(meter.read(DVec3::ZERO, DVec3::new(0.0, 0.0, size)).unwrap().normal, DVec3::Z);
    }
}
