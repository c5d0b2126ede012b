//! The photon map's light on receivers against closed forms of geometrical optics: how much there is, where, and of which colour.
#![allow(clippy::panic, clippy::unwrap_used, reason = "helpers of tests fail by panicking")]

use core::f64::consts::PI;

use renderers::geometry::glam::DVec3;
use renderers::render::{Between, Options, PhotonCount, PhotonOptions, Spectra};
use renderers::scene::Scene;
use renderers::spectral::Y_INTEGRAL;
use spectral_core::Observer;
use spectral_core::spectrum::Spectrum;
use spectral_core::tables::metals;
use spectral_tests::bodies::hemisphere;
use spectral_tests::light_tracing::Estimate;
use spectral_tests::receiver::{Irradiance, Receiver};
use spectral_tests::snell::{Focus, Lens, Plate, Way, reflectance};

/// How far fluxes may be from their closed forms.
const TOLERANCE: f64 = 0.005;
/// The largest radius of estimates.
const RADIUS: f64 = 0.05;
/// Pixels along a side.
const SIDE: u32 = 64;
const SEEDS: u64 = 5;

fn directional(direction: DVec3, irradiance: &str) -> String {
    let DVec3 { x, y, z } = direction;
    format!(
        "<emitter type='directional'><vector name='direction' x='{x}' y='{y}' z='{z}'/>
        <spectrum name='irradiance' value='{irradiance}'/></emitter>"
    )
}

fn down() -> String {
    directional(DVec3::NEG_Y, "1")
}

fn glass(inside: &str) -> String {
    format!("<bsdf type='dielectric'>{inside}<float name='ext_ior' value='1'/></bsdf>")
}

fn constant(index: f64) -> String {
    glass(&format!("<float name='int_ior' value='{index}'/>"))
}

fn options(count: u64, bins: usize) -> Options {
    let photons = PhotonOptions {
        count: PhotonCount::Count(count),
        radius: Some(RADIUS),
        // The same radius everywhere.
        nearest: 1 << 24,
        adaptive: false,
        between: Between::Ambient,
        ..PhotonOptions::default()
    };
    let spectra = Spectra::Uniform(bins);
    Options { spectra, size: Some([SIDE; 2]), samples: Some(4), photons, ..Options::default() }
}

/// What several seeds find.
fn maps(receiver: &Receiver, scene: &Scene, options: &Options, seeds: u64) -> Vec<Irradiance> {
    let map = |seed| receiver.caustics(scene, &Options { seed: Some(seed), ..*options }).unwrap().0;
    (0..seeds).map(map).collect()
}

/// The mean over seeds is within [`TOLERANCE`] of what is expected, and the standard error small enough to tell.
#[track_caller]
fn assert_flux(name: &str, maps: &[Irradiance], expected: f64, of: impl Fn(&Irradiance) -> f64) {
    let found = Estimate::of(&maps.iter().map(of).collect::<Vec<_>>());
    assert!((found.mean / expected - 1.0).abs() <= TOLERANCE, "{name}: {found:?}, expected {expected}");
    assert!(found.error <= TOLERANCE / 2.0 * expected, "{name}: {found:?}, expected {expected}");
}

/// Closed forms: the trigonometric trace of balls and of a hemisphere that is a mesh with smooth normals.
#[test]
fn lenses_light_is_their_closed_form() {
    let (dome, mesh) = hemisphere(true, 64, &constant(1.5));
    let ball = |index: f64| format!("<shape type='sphere'>{}</shape>", constant(index));
    let through: Vec<Way> = (0..6).map(Way::Through).chain([Way::Reflected]).collect();
    for (lens, index, distance, body, ways) in [
        (Lens::Ball, 1.5, 2.0, ball(1.5), &through[..]),
        (Lens::Ball, 1.8, 1.6, ball(1.8), &through[..]),
        // What its round face reflects near the rim comes down beside it.
        (Lens::RoundFirst, 1.5, 1.8, dome, &[Way::Through(0), Way::Reflected][..]),
    ] {
        let receiver = Receiver::floor(-distance, 1.5, (0.9 * (distance - 1.0)).min(0.8));
        let scene = receiver.scene(&format!("{}{body}", down()), &[("dome.obj", &mesh)]).unwrap();
        let maps = maps(&receiver, &scene, &options(100_000, 1), SEEDS);
        let focus = Focus { lens, radius: 1.0, index, distance };
        for radius in [0.4, 0.8, 1.3] {
            let expected = ways.iter().map(|way| focus.flux(*way, radius)).sum();
            assert_flux(&format!("{lens:?} {index} {radius}"), &maps, expected, |map| map.flux_within(radius)[1]);
        }
        for map in &maps {
            let [x, z] = map.centroid(1);
            assert!(x.hypot(z) <= RADIUS, "{lens:?} {index}: {x} {z}");
        }
    }
}

/// Closed form: the density of the ball's rays on rings, smoothed by the kernel: Epanechnikov's has the variance R²/6 along each axis, so that
/// irradiance gains R²/12 of its Laplacian, whose integral within a radius r is 2πr E′(r).
#[test]
fn a_balls_irradiance_is_its_closed_form() {
    const STEP: f64 = 1e-4;
    let receiver = Receiver::floor(-2.0, 1.5, 0.8);
    let body = format!("{}<shape type='sphere'>{}</shape>", down(), constant(1.5));
    let maps = maps(&receiver, &receiver.scene(&body, &[]).unwrap(), &options(100_000, 1), SEEDS);
    let focus = Focus { lens: Lens::Ball, radius: 1.0, index: 1.5, distance: 2.0 };
    let ways: Vec<Way> = (0..6).map(Way::Through).chain([Way::Reflected]).collect();
    let irradiance = |r: f64| ways.iter().map(|way| focus.irradiance(*way, r)).sum::<f64>();
    let smoothed = |r: f64| {
        let slope = (irradiance(r + STEP) - irradiance(r - STEP)) / (2.0 * STEP);
        ways.iter().map(|way| focus.flux(*way, r)).sum::<f64>() + RADIUS * RADIUS / 12.0 * 2.0 * PI * r * slope
    };
    for [inner, outer] in (3..14).map(|k| [0.1 * f64::from(k), 0.1 * f64::from(k + 1)]) {
        let of_ring = |map: &Irradiance| map.flux_within(outer)[1] - map.flux_within(inner)[1];
        assert_flux(&format!("ring {inner} {outer}"), &maps, smoothed(outer) - smoothed(inner), of_ring);
    }
}

/// The place where a profile first passes a value, between middles of columns.
fn crossing(map: &Irradiance, profile: &[f64], value: f64) -> f64 {
    let first = profile.windows(2).position(|p| (p[0] - value) * (p[1] - value) <= 0.0).unwrap();
    let part = (value - profile[first]) / (profile[first + 1] - profile[first]);
    #[allow(clippy::cast_precision_loss, reason = "a few columns")]
    map.place(first as f64 + 0.5 + part)
}

fn luminance(profile: &[[f64; 3]]) -> Vec<f64> {
    profile.iter().map(|xyz| xyz[1]).collect()
}

fn cube(scale: DVec3, bsdf: &str) -> String {
    format!(
        "<shape type='cube'><transform name='to_world'><scale x='{}' y='{}' z='{}'/></transform>{bsdf}</shape>",
        scale.x, scale.y, scale.z
    )
}

/// Closed forms: all that passes a plate, clear or not, and the edge of a shadow, which the plate moves aside.
#[test]
fn a_plate_transmits_and_shifts_by_its_closed_form() {
    let receiver = Receiver::floor(-0.5, 1.0, 0.2);
    for (degrees, absorption) in [(0.0, 0.4), (35.0, 0.7), (60.0, 0.0)] {
        let angle = f64::to_radians(degrees);
        let plate = Plate { thickness: 0.5, index: 1.6, absorption };
        let bsdf =
            glass(&format!("<float name='int_ior' value='1.6'/><spectrum name='absorption' value='{absorption}'/>"));
        let light = directional(DVec3::new(angle.sin(), -angle.cos(), 0.0), "1");
        let body = format!("{light}{}", cube(DVec3::new(6.0, 0.25, 6.0), &bsdf));
        // Most photons meet the plate far from where the receiver sees it.
        let settings = options(400_000, 1);
        let lit = maps(&receiver, &receiver.scene(&body, &[]).unwrap(), &settings, SEEDS);
        let expected = angle.cos() * plate.shares(angle)[0];
        assert_flux(&format!("{degrees}°"), &lit, 4.0 * expected, |map| map.flux()[1]);
        // An edge above the plate, whose shadow's edge would be at x = −0.3 without it.
        let shade = format!(
            "<shape type='rectangle'><transform name='to_world'><rotate x='1' angle='-90'/><scale value='20'/>
            <translate x='{}' y='2'/></transform></shape>",
            -20.3 - 2.5 * angle.tan()
        );
        let shaded = receiver.scene(&format!("{body}{shade}"), &[]).unwrap();
        for map in maps(&receiver, &shaded, &settings, 2) {
            let profile = luminance(&map.profile(&(-0.9..0.9)));
            let found = crossing(&map, &profile, expected / 2.0);
            let edge = -0.3 - plate.shift(angle) / angle.cos();
            assert!((found - edge).abs() <= RADIUS, "{degrees}°: {found}, expected {edge}");
        }
    }
}

/// A mirror at 45° that sends light coming along x down: a square that is seen as large by both.
fn mirror(bsdf: &str) -> String {
    format!(
        "{}<shape type='rectangle'><transform name='to_world'>
        <lookat origin='0, 2, 0' target='-1, 1, 0' up='0, 0, 1'/></transform>{bsdf}</shape>",
        directional(DVec3::X, "1")
    )
}

/// XYZ of a flat radiance of 1 times a spectrum, by the trapezium rule at whole nanometres.
fn tristimulus(spectrum: impl Fn(f64) -> f64) -> [f64; 3] {
    let observer = Observer::<f64>::cie_1931_2deg();
    let mut sum = [0.0; 3];
    for wavelength in (380..=780_u32).map(f64::from) {
        let end = if wavelength == 380.0 || wavelength == 780.0 { 0.5 } else { 1.0 };
        let value = end * spectrum(wavelength) / Y_INTEGRAL;
        sum = core::array::from_fn(|c| sum[c] + value * observer.value(wavelength)[c]);
    }
    sum
}

/// Closed forms: flux, edges and colour of what mirrors send, by geometry and Fresnel's formulae for metals.
#[test]
fn a_mirrors_light_is_its_closed_form() {
    let receiver = Receiver::floor(0.0, 1.25, 0.5);
    let perfect = "<bsdf type='conductor'><spectrum name='specular_reflectance' value='0.75'/></bsdf>";
    let gold = "<bsdf type='conductor'><string name='material' value='Au'/></bsdf>";
    let (n, k) = (metals::AU.n::<f64>(), metals::AU.k::<f64>());
    let sloped = |w: f64| spectral_core::fresnel::conductor((PI / 4.0).cos(), n.value(w), k.value(w));
    for (name, bsdf, expected) in [("perfect", perfect, tristimulus(|_| 0.75)), ("gold", gold, tristimulus(sloped))] {
        let scene = receiver.scene(&mirror(bsdf), &[]).unwrap();
        let maps = maps(&receiver, &scene, &options(50_000, 80), SEEDS);
        let (half, area) = (0.5_f64.sqrt(), 2.0 * 2.0_f64.sqrt());
        for (c, expected) in expected.iter().enumerate() {
            assert_flux(&format!("{name} {c}"), &maps, area * expected, |map| map.flux()[c]);
        }
        for map in &maps {
            let profile = luminance(&map.profile(&(-0.5..0.5)));
            let found = crossing(map, &profile, expected[1] / 2.0);
            assert!((found + half).abs() <= RADIUS, "{name}: {found}");
            let [x, z] = map.centroid(1);
            assert!(x.hypot(z) <= RADIUS, "{name}: {x} {z}");
        }
    }
}

/// Closed form: coloured glass has Bouguer's law at every wavelength, boundaries Fresnel's.
#[test]
fn coloured_glass_absorbs_by_wavelength() {
    let receiver = Receiver::floor(-1.0, 0.5, 0.2);
    let absorption = |w: f64| if w <= 400.0 { 0.2 } else { 0.2 + 2.0 * (w - 400.0) / 300.0 };
    let bsdf = glass(
        "<float name='int_ior' value='1.5'/><spectrum name='absorption' value='300:0.2, 400:0.2, 700:2.2, 1000:4.2'/>",
    );
    let scene = receiver.scene(&format!("{}{}", down(), cube(DVec3::new(1.5, 0.5, 1.5), &bsdf)), &[]).unwrap();
    let maps = maps(&receiver, &scene, &options(100_000, 40), SEEDS);
    let plate = |w| Plate { thickness: 1.0, index: 1.5, absorption: absorption(w) };
    let expected = tristimulus(|w| plate(w).shares(0.0)[0]);
    for (c, expected) in expected.into_iter().enumerate() {
        assert_flux(&format!("coloured {c}"), &maps, expected, |map| map.flux()[c]);
    }
}

/// Closed form: an absorbing body within an absorbing body, of the same index, so that light goes straight.
#[test]
fn nested_media_absorb_each_on_its_way() {
    let receiver = Receiver::floor(-1.0, 0.25, 0.2);
    let outer = glass("<float name='int_ior' value='1.5'/><spectrum name='absorption' value='0.5'/>");
    let inner = "<bsdf type='dielectric'><float name='int_ior' value='1.5'/><float name='ext_ior' value='1.5'/>
        <spectrum name='absorption' value='1.5'/></bsdf>";
    let bodies = format!("{}{}", cube(DVec3::new(1.0, 0.5, 1.0), &outer), cube(DVec3::new(0.8, 0.2, 0.8), inner));
    let scene = receiver.scene(&format!("{}{bodies}", down()), &[]).unwrap();
    let maps = maps(&receiver, &scene, &options(100_000, 1), SEEDS);
    // The same way as through a plate of thickness 1 with the mean absorption.
    let plate = Plate { thickness: 1.0, index: 1.5, absorption: 0.6 * 0.5 + 0.4 * 1.5 };
    assert_flux("nested", &maps, 0.25 * plate.shares(0.0)[0], |map| map.flux()[1]);
}

/// Closed form: a right-angled prism turns light by total reflection; what its faces reflect goes back the same way, so that it acts as a
/// plate.
#[test]
fn total_reflection_takes_all() {
    let receiver = Receiver { centre: DVec3::new(0.0, -3.0, 0.0), ..Receiver::floor(0.0, 1.25, 0.8) };
    // Light along x comes in at the left, meets the slope and leaves by the base.
    let corners = [[-0.5, -0.5], [0.5, -0.5], [-0.5, 0.5]];
    let mut mesh = String::new();
    for z in [-1.0, 1.0] {
        for [x, y] in corners {
            mesh += &format!("v {x} {y} {z}\n");
        }
    }
    mesh += "f 1 3 2\nf 4 5 6\nf 1 2 5 4\nf 2 3 6 5\nf 3 1 4 6\n";
    let body = format!(
        "{}<shape type='obj'><string name='filename' value='prism.obj'/><boolean name='face_normals' value='true'/>{}</shape>",
        directional(DVec3::X, "1"),
        constant(1.5)
    );
    let maps = maps(&receiver, &receiver.scene(&body, &[("prism.obj", &mesh)]).unwrap(), &options(50_000, 1), SEEDS);
    let r = reflectance(0.0, 1.5);
    let expected = 2.0 * (1.0 - r) / (1.0 + r);
    assert_flux("total reflection", &maps, expected, |map| map.flux()[1]);
}
