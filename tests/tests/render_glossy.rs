//! Ward's family in the Whitted renderer against closed forms: lights without area, enclosures, and what mirrors what.
#![allow(clippy::unwrap_used, reason = "helpers of tests fail by panicking")]

use core::f64::consts::PI;

use renderers::geometry::sampling::SobolSequence;
use renderers::scene::{Source, load};
use renderers::spectral::{FactorOrder, Palette, Radiance};
use renderers::whitted::{GlossyLight, Whitted, Worker};
use spectral_core::brdf::{Brdf, Variant, Ward, direction};
use spectral_tests::statistics::upper_gamma;

/// Reflectances of the highlight and of its base.
const SPECULAR: f64 = 0.75;
const DIFFUSE: f64 = 0.125;
const RADIANCE: f64 = 3.0;
/// Hits and directions are f32: some roundings, times what a lobe's value changes by.
const ROUNDING: f64 = 32.0 * f32::EPSILON as f64;

/// The probability that an estimate of one test fails by chance.
const SIGNIFICANCE: f64 = 1e-3;
const REPLICATES: u32 = 60;

/// A mean and its standard error.
#[derive(Clone, Copy, Debug)]
struct Estimate {
    mean: f64,
    error: f64,
}

impl Estimate {
    #[track_caller]
    fn assert_is(&self, expected: f64, tests: u32, what: &str) {
        let z = (self.mean - expected) / self.error;
        let p_value = upper_gamma(0.5, z * z / 2.0);
        let least = 1.0 - (1.0 - SIGNIFICANCE).powf(1.0 / f64::from(tests));
        let exact = (self.mean - expected).abs() <= ROUNDING * expected;
        assert!(exact || p_value >= least, "{what}: {self:?}, expected {expected}, z = {z}");
    }
}

/// A small surface of Ward's family in the plane z = 0, its tangent turned from x by so many degrees.
fn surface(variant: &str, [alpha_u, alpha_v]: [f64; 2], turn: f64) -> String {
    format!(
        "<shape type='rectangle'><transform name='to_world'><scale value='0.01'/><rotate z='1' angle='{turn}'/></transform>
        <bsdf type='twosided'><bsdf type='ward'><string name='variant' value='{variant}'/>
        <float name='alpha_u' value='{alpha_u}'/><float name='alpha_v' value='{alpha_v}'/>
        <spectrum name='specular_reflectance' value='{SPECULAR}'/>
        <spectrum name='diffuse_reflectance' value='{DIFFUSE}'/></bsdf></bsdf></shape>"
    )
}

/// What is seen of the origin from `eye`: radiances are flat, so that all weights add up.
fn seen(eye: [f64; 3], body: &str, light: GlossyLight, rays: u32) -> Estimate {
    let eye = eye.map(|x| x.to_string()).join(" ");
    let xml = format!(
        "<scene version='3.0.0'><integrator type='whitted'><integer name='max_depth' value='16'/></integrator>
        <sensor type='perspective'><float name='fov' value='1e-4'/><transform name='to_world'>
        <lookat origin='{eye}' target='0 0 0' up='0.1 0.2 0.3'/></transform></sensor>{body}</scene>"
    );
    let scene = load(&Source::text("test.xml", xml), &[]).unwrap();
    let mut palette = Palette::default();
    let whitted = Whitted::new(&scene, [1, 1], &mut palette).unwrap().with_glossy_light(light);
    let mut worker = Worker::new(&whitted, FactorOrder::Free);
    let values: Vec<f64> = (0..REPLICATES)
        .map(|replicate| {
            let mut radiance = Radiance::default();
            worker.start_pixel(SobolSequence::new(replicate));
            for _ in 0..rays {
                worker.sample(0.5, 0.5, 1.0 / f64::from(rays), &mut radiance);
            }
            radiance.terms().iter().map(|(_, weight)| weight).sum()
        })
        .collect();
    let count = f64::from(REPLICATES);
    let mean = values.iter().sum::<f64>() / count;
    let squares: f64 = values.iter().map(|v| (v - mean).powi(2)).sum();
    Estimate { mean, error: (squares / (count - 1.0) / count).sqrt() }
}

/// The direction at an angle from z and an azimuth, degrees.
fn towards(theta: f64, azimuth: f64) -> [f64; 3] {
    let ((sin, cos), (sine, cosine)) = (theta.to_radians().sin_cos(), azimuth.to_radians().sin_cos());
    direction([sin * cosine, sin * sine, cos]).unwrap()
}

const VARIANTS: [Variant; 4] = Variant::ALL;

#[test]
fn lights_without_area_are_evaluated_in_the_frame_of_the_surface() {
    for variant in VARIANTS {
        for (alpha, turn) in [([0.2, 0.2], 0.0), ([0.1, 0.4], 0.0), ([0.1, 0.4], 30.0), ([0.4, 0.1], 30.0)] {
            let model = Ward::new(variant, alpha[0], alpha[1]).unwrap();
            for (theta, azimuth) in [(30.0, 200.0), (60.0, 170.0), (10.0, 80.0)] {
                let (eye, light) = (towards(40.0, 10.0), towards(theta, azimuth));
                let lamp = format!(
                    "<emitter type='point'><point name='position' value='{}'/>
                    <spectrum name='intensity' value='{RADIANCE}'/></emitter>",
                    light.map(|x| (2.0 * x).to_string()).join(" ")
                );
                let body = surface(variant.name(), alpha, turn) + &lamp;
                let found = seen(eye, &body, GlossyLight::Both, 1);
                // Directions in the surface's own frame.
                let value = model.evaluate(towards(theta, azimuth - turn), towards(40.0, 10.0 - turn));
                let expected = RADIANCE / 4.0 * light[2] * (SPECULAR * value + DIFFUSE / PI);
                let off = (found.mean - expected).abs();
                assert!(off <= ROUNDING / alpha[0].min(alpha[1]) * expected, "{variant}: {found:?}, {expected}");
            }
        }
    }
}

/// Four walls and a ceiling around the origin that face inwards; the eye is within.
fn room(content: &str) -> String {
    let wall = |axis: &str, angle: u32, place: &str| {
        format!(
            "<shape type='rectangle'><transform name='to_world'><scale value='4'/><rotate {axis} angle='{angle}'/>
            <translate {place}/></transform>{content}</shape>"
        )
    };
    [
        wall("x='1'", 180, "z='4'"),
        wall("y='1'", 90, "x='-4'"),
        wall("y='1'", 270, "x='4'"),
        wall("x='1'", 90, "y='4'"),
        wall("x='1'", 270, "y='-4'"),
    ]
    .concat()
}

/// From where rooms are looked at: degrees from the normal.
const ANGLES: [f64; 4] = [5.0, 60.0, 85.0, 89.0];

/// Under uniform light from everywhere a surface sends out its albedo times the radiance.
#[test]
fn a_furnace_shows_the_albedo() {
    let content = format!(
        "<bsdf type='diffuse'><spectrum name='reflectance' value='0'/></bsdf>
        <emitter type='area'><spectrum name='radiance' value='{RADIANCE}'/></emitter>"
    );
    let ways = [GlossyLight::Both, GlossyLight::Reflections, GlossyLight::Lights];
    let tests = 4 * (2 * 3 * 4 + 2 * 2);
    for variant in VARIANTS {
        for alpha in [[0.05, 0.3], [0.2, 0.2], [0.6, 0.6]] {
            let model = Ward::new(variant, alpha[0], alpha[1]).unwrap();
            let body = surface(variant.name(), alpha, 20.0) + &room(&content);
            for angle in ANGLES {
                let expected = RADIANCE * (SPECULAR * model.albedo(towards(angle, 50.0 - 20.0)) + DIFFUSE);
                for way in ways {
                    // Few points of lights meet a narrow lobe: their mean is far from normal.
                    if way == GlossyLight::Lights && (angle > 70.0 || alpha[0] < 0.1) {
                        continue;
                    }
                    // The eye must be within the walls.
                    let found = seen(towards(angle, 50.0).map(|x| 3.0 * x), &body, way, 4);
                    found.assert_is(expected, tests, &format!("{variant} {alpha:?} {angle} {way:?}"));
                }
            }
        }
    }
}

/// Under walls that do not shine but reflect the ambient term, a surface reflects what they send out.
#[test]
fn a_highlight_reflects_other_surfaces() {
    let content = "<bsdf type='diffuse'><spectrum name='reflectance' value='0.5'/></bsdf>";
    let ambient = format!("<emitter type='ambient'><spectrum name='radiance' value='{RADIANCE}'/></emitter>");
    for variant in VARIANTS {
        for alpha in [[0.05, 0.3], [0.2, 0.2]] {
            let model = Ward::new(variant, alpha[0], alpha[1]).unwrap();
            let body = surface(variant.name(), alpha, 20.0) + &room(content) + &ambient;
            for angle in ANGLES {
                let albedo = model.albedo(towards(angle, 50.0 - 20.0));
                let expected = RADIANCE * (SPECULAR * albedo * 0.5 + DIFFUSE);
                let found = seen(towards(angle, 50.0).map(|x| 3.0 * x), &body, GlossyLight::Both, 4);
                found.assert_is(expected, 4 * 2 * 4, &format!("{variant} {alpha:?} {angle}"));
            }
        }
    }
}

/// A light that mirrors show is found by reflection rays alone, once, whatever the way of finding lights.
#[test]
fn light_by_way_of_mirrors_counts_once() {
    // The disk is below the surface's horizon and faces up: whatever leaves the surface comes to it by the ceiling.
    let light = format!(
        "<shape type='disk'><transform name='to_world'><scale value='8'/><translate z='-1'/></transform>
        <bsdf type='diffuse'><spectrum name='reflectance' value='0'/></bsdf>
        <emitter type='area'><spectrum name='radiance' value='{RADIANCE}'/></emitter></shape>"
    );
    let alpha = [0.1, 0.1];
    let body = surface("balanced", alpha, 0.0) + &room("<bsdf type='conductor'/>") + &light;
    let eye = towards(20.0, 50.0);
    let expected = RADIANCE * SPECULAR * Ward::new(Variant::Balanced, alpha[0], alpha[1]).unwrap().albedo(eye);
    for way in [GlossyLight::Both, GlossyLight::Reflections, GlossyLight::Lights] {
        seen(eye.map(|x| 3.0 * x), &body, way, 8).assert_is(expected, 3, &format!("{way:?}"));
    }
}

#[test]
fn samples_of_a_pixel_are_the_same_whatever_came_before() {
    let body = surface("balanced", [0.1, 0.1], 0.0)
        + &room("<emitter type='area'><spectrum name='radiance' value='1'/></emitter>");
    let once = seen(towards(30.0, 0.0), &body, GlossyLight::Both, 2);
    let again = seen(towards(30.0, 0.0), &body, GlossyLight::Both, 2);
    assert_eq!((once.mean, once.error), (again.mean, again.error));
    assert!(once.error > 0.0);
}
