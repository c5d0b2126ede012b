//! The Whitted renderer against closed forms: direct light on a Lambertian floor, and where glass sends a ray.
#![allow(clippy::panic, clippy::unwrap_used, reason = "helpers of tests fail by panicking")]

use core::f64::consts::PI;

use renderers::geometry::sampling::SobolSequence;
use renderers::render::{Options, Spectra, render};
use renderers::scene::{Scene, Source, load};
use renderers::spectral::{Band, FactorOrder, IntervalSettings, Palette, Radiance, Tracer};
use renderers::whitted::{Whitted, Worker};
use spectral_core::colour::rgb::linear_rgb_to_xyz;

/// Rays, hits and pixels are f32: some roundings of each.
const ROUNDING: f64 = 16.0 * f32::EPSILON as f64;
/// Reflectance of the floor, radiance of the lights.
const REFLECTANCE: f64 = 0.625;
const RADIANCE: f64 = 7.0;

const FLOOR: &str = "<shape type='rectangle'>
    <transform name='to_world'><rotate x='1' angle='-90'/><scale value='50'/></transform>
    <bsdf type='diffuse'><spectrum name='reflectance' value='0.625'/></bsdf></shape>";
/// In the plane z = 0, facing +z; turned to face down.
const DOWN: &str = "<rotate x='1' angle='90'/>";

/// A camera with so narrow a view that its one pixel is a point, at `eye`, looking at `target`.
fn scene(eye: [f64; 3], target: [f64; 3], body: &str) -> Scene {
    let [eye, target] = [eye, target].map(|p| p.map(|x| x.to_string()).join(" "));
    let xml = format!(
        "<scene version='3.0.0'>
        <integrator type='whitted'><integer name='max_depth' value='2'/></integrator>
        <sensor type='perspective'><float name='fov' value='1e-4'/>
        <transform name='to_world'><lookat origin='{eye}' target='{target}' up='0 0 1'/></transform>
        <sampler type='independent'><integer name='sample_count' value='1'/></sampler>
        <film type='hdrfilm'><integer name='width' value='1'/><integer name='height' value='1'/>
        <rfilter type='box'/></film></sensor>{FLOOR}{body}</scene>"
    );
    load(&Source::text("test.xml", xml), &[]).unwrap()
}

/// Luminance Y of the floor at (x, 0, 0) from straight above, by every representation: they must agree where all
/// spectra are flat.
fn floor_luminance(x: f64, body: &str) -> f64 {
    let scene = scene([x, 0.25, 0.0], [x, 0.0, 0.0], body);
    let found = [Spectra::Interval(IntervalSettings::default()), Spectra::Uniform(81), Spectra::Rgb].map(|spectra| {
        let options = Options { spectra, ..Options::default() };
        let picture = render(&scene, &options, &|_| {}).unwrap().picture;
        linear_rgb_to_xyz(picture.pixels()[0].map(f64::from))[1]
    });
    for other in found {
        assert!((other - found[0]).abs() <= ROUNDING * found[0], "{found:?}");
    }
    found[0]
}

#[track_caller]
fn assert_near(found: f64, expected: f64, tolerance: f64) {
    assert!((found - expected).abs() <= tolerance, "{found}, expected {expected} within {tolerance}");
}

fn area_light(shape: &str, transform: &str) -> String {
    format!(
        "<shape type='{shape}'><transform name='to_world'>{transform}</transform>
        <emitter type='area'><spectrum name='radiance' value='{RADIANCE}'/></emitter></shape>"
    )
}

/// Configuration factor of a rectangle parallel to the receiver at distance h, by its corners' differences in position
/// (Howell, catalogue of configuration factors, B-3, by superposition).
fn rectangle_factor(h: f64, [x1, x2]: [f64; 2], [z1, z2]: [f64; 2]) -> f64 {
    let corner = |a: f64, b: f64| {
        let (p, q) = (h.hypot(a), h.hypot(b));
        (a / p * (b / p).atan() + b / q * (a / q).atan()) / (2.0 * PI)
    };
    corner(x2, z2) - corner(x1, z2) - corner(x2, z1) + corner(x1, z1)
}

#[test]
fn a_rectangle_lights_the_floor_as_its_closed_form() {
    for h in [0.5, 2.0, 10.0] {
        let light = area_light("rectangle", &format!("{DOWN}<scale x='1.5' z='0.75'/><translate y='{h}'/>"));
        for x in [0.0, 1.0, 1.5, 4.0, 20.0] {
            let expected = RADIANCE * REFLECTANCE * rectangle_factor(h, [-1.5 - x, 1.5 - x], [-0.75, 0.75]);
            // A hit off by some roundings of its coordinates sees the light at another place.
            assert_near(floor_luminance(x, &light), expected, ROUNDING * expected * (1.0 + x / h));
        }
    }
}

#[test]
fn a_light_that_faces_away_lights_nothing() {
    for shape in ["rectangle", "disk"] {
        let light = area_light(shape, "<rotate x='1' angle='-90'/><translate y='2'/>");
        assert_eq!(floor_luminance(1.0, &light), 0.0, "{shape}");
    }
}

/// Hamilton and Morgan 1952: a disk parallel to the receiver at distance h, its axis at distance x; on the axis r²/(r² + h²).
fn disk_factor(r: f64, h: f64, x: f64) -> f64 {
    let sum = h * h + x * x;
    0.5 * (1.0 - (sum - r * r) / ((sum + r * r).powi(2) - 4.0 * r * r * x * x).sqrt())
}

#[test]
fn a_disk_lights_the_floor_as_its_closed_form() {
    assert_near(disk_factor(0.4, 3.55, 0.0), 0.16 / (0.16 + 3.55 * 3.55), 1e-15);
    for (r, h) in [(0.4, 3.55), (1.0, 1.0), (1.0, 0.5), (2.0, 30.0)] {
        let light = area_light("disk", &format!("{DOWN}<scale value='{r}'/><translate y='{h}'/>"));
        for x in [0.0, 0.5, 1.0, 3.0] {
            let expected = disk_factor(r, h, x);
            let found = floor_luminance(x, &light) / (RADIANCE * REFLECTANCE);
            assert_near(found, expected, ROUNDING * expected * (1.0 + x / h));
        }
    }
}

#[test]
fn a_sphere_lights_the_floor_as_its_closed_form() {
    for (r, h) in [(0.25_f64, 1.0_f64), (1.0, 1.5), (1.0, 20.0)] {
        let light = format!(
            "<shape type='sphere'><point name='center' value='0 {h} 0'/><float name='radius' value='{r}'/>
            <emitter type='area'><spectrum name='radiance' value='{RADIANCE}'/></emitter></shape>"
        );
        for x in [0.0_f64, 0.5, 1.0, 3.0] {
            let distance = h.hypot(x);
            let expected = (r / distance).powi(2) * h / distance;
            let found = floor_luminance(x, &light) / (RADIANCE * REFLECTANCE);
            assert_near(found, expected, ROUNDING * expected * (1.0 + x / h));
        }
    }
}

#[test]
fn lights_without_area_follow_cosine_and_inverse_square() {
    for h in [0.5_f64, 2.0, 16.0] {
        let light = format!(
            "<emitter type='point'><point name='position' value='0 {h} 0'/>
            <spectrum name='intensity' value='{RADIANCE}'/></emitter>"
        );
        for x in [0.0_f64, 1.0, 8.0] {
            let distance = h.hypot(x);
            let expected = REFLECTANCE / PI * RADIANCE * (h / distance) / (distance * distance);
            assert_near(floor_luminance(x, &light), expected, ROUNDING * expected * (1.0 + x / h));
        }
    }
    for angle in [0.0_f64, 30.0, 85.0] {
        let (sin, cos) = angle.to_radians().sin_cos();
        let light = format!(
            "<emitter type='directional'><vector name='direction' x='{sin}' y='{}' z='0'/>
            <spectrum name='irradiance' value='{RADIANCE}'/></emitter>",
            -cos
        );
        let expected = REFLECTANCE / PI * RADIANCE * cos;
        assert_near(floor_luminance(3.0, &light), expected, ROUNDING * expected);
    }
}

#[test]
fn the_ambient_term_is_radiance_times_reflectance() {
    let ambient = format!("<emitter type='ambient'><spectrum name='radiance' value='{RADIANCE}'/></emitter>");
    let expected = REFLECTANCE * RADIANCE;
    assert_near(floor_luminance(0.0, &ambient), expected, ROUNDING * expected);
}

/// N-BK7 at the lines F and C: wavelength in nm, index (`published`: Schott's data sheet), and half its last digit.
const LINES: [(f64, f64); 2] = [(486.1327, 1.52238), (656.2725, 1.51432)];
const HALF_DIGIT: f64 = 5e-6;

/// The light at a wavelength that comes back through glass from the floor, under a point light near where the ray
/// arrives: its illuminance there tells the place.
fn through_glass(scene: &Scene, wavelength: f64) -> f64 {
    let mut palette = Palette::default();
    let whitted = Whitted::new(scene, [1, 1], &mut palette).unwrap();
    let mut worker = Worker::new(&whitted, FactorOrder::Free);
    let mut radiance = Radiance::default();
    worker.start_pixel(SobolSequence::new(0));
    worker.sample(0.5, 0.5, 1.0, &mut radiance);
    let [(deferred, _, weight)] = *radiance.deferred() else { panic!("not one deferred path: {radiance:?}") };
    let traced = worker.trace(deferred, Band::single(wavelength));
    weight * traced.terms().iter().map(|(_, w)| w).sum::<f64>()
}

/// The largest coordinate of these scenes: what the roundings of a hit are relative to.
const SIZE: f64 = 5.0;
/// The most that the illuminance below changes with the place, relative and per unit: 3/2 over the lamp's height.
const STEEPEST: f64 = 5.0;

/// The floor's radiance at x under a point light at (`lamp`, 0.3, 0).
fn spot_radiance(x: f64, lamp: f64) -> f64 {
    let squared = (x - lamp).powi(2) + 0.09;
    REFLECTANCE / PI * RADIANCE * 0.3 / squared.powf(1.5)
}

fn lamp(x: f64) -> String {
    format!(
        "<emitter type='point'><point name='position' value='{x} 0.3 0'/>
        <spectrum name='intensity' value='{RADIANCE}'/></emitter>"
    )
}

const GLASS: &str =
    "<bsdf type='dielectric'><string name='int_ior' value='N-BK7'/><float name='ext_ior' value='1'/></bsdf>";

/// What passes a boundary at angles of incidence and refraction: Fresnel's formulae in angles, unpolarised.
fn transmittance(incidence: f64, refraction: f64) -> f64 {
    let (difference, sum) = (incidence - refraction, incidence + refraction);
    let (s, p) = (difference.sin() / sum.sin(), difference.tan() / sum.tan());
    1.0 - (s * s + p * p) / 2.0
}

/// Compares what is found at each line with the expectation for its index, which is known to half a digit.
#[track_caller]
fn assert_spots(scene: &Scene, expected: impl Fn(f64) -> f64) {
    for (wavelength, index) in LINES {
        let [least, spot, most] = [-HALF_DIGIT, 0.0, HALF_DIGIT].map(|d| expected(index + d));
        let tolerance = (most - least).abs() / 2.0 + ROUNDING * SIZE * STEEPEST * spot;
        assert_near(through_glass(scene, wavelength), spot, tolerance);
    }
    // The lines are told apart.
    let [f, c] = LINES.map(|(_, index)| expected(index));
    assert!((f / c - 1.0).abs() >= 0.02, "{f}, {c}");
}

#[test]
fn a_slab_shifts_each_wavelength_as_snell_says() {
    // From (0, 3) at 60° through glass between y = 2 and 1.
    let incidence = 60.0_f64.to_radians();
    let (sin, cos) = incidence.sin_cos();
    let slab = format!(
        "<shape type='cube'><transform name='to_world'><scale x='40' y='0.5' z='40'/><translate y='1.5'/></transform>
        {GLASS}</shape>{}",
        lamp(4.45)
    );
    let scene = scene([0.0, 3.0, 0.0], [sin, 3.0 - cos, 0.0], &slab);
    assert_spots(&scene, |index| {
        let refraction = (sin / index).asin();
        let x = 2.0 * incidence.tan() + refraction.tan();
        transmittance(incidence, refraction).powi(2) * spot_radiance(x, 4.45)
    });
}

#[test]
fn a_sphere_focuses_each_wavelength_as_snell_says() {
    // Straight down at x = 0.6 on a sphere of radius 1 around (0, 2.5).
    let sphere = format!("<shape type='sphere'><point name='center' value='0 2.5 0'/>{GLASS}</shape>{}", lamp(-0.3));
    let scene = scene([0.6, 5.0, 0.0], [0.6, 0.0, 0.0], &sphere);
    let incidence = 0.6_f64.asin();
    assert_spots(&scene, |index| {
        let refraction = (0.6 / index).asin();
        // The chord turns the point of exit by π − 2 θ′, and both boundaries the ray by 2 (θ − θ′).
        let (x, y) = (2.0 * refraction - incidence).sin_cos();
        let arrival = x - (2.5 - y) * (2.0 * (incidence - refraction)).tan();
        transmittance(incidence, refraction).powi(2) * spot_radiance(arrival, -0.3)
    });
}
