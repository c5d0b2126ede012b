//! Where photons land, against closed forms.

use core::f64::consts::PI;

use glam::{DVec2, DVec3};
use spectral_core::dispersion::{Dispersion, Glass};

use super::{Stage, directional, emit, glass, point, settings, surroundings};
use crate::photon::{Emission, Prefix, Scattered, Spectra};
use crate::scene::Mesh;

const WAVELENGTHS: [f64; 10] = [390.0, 430.0, 470.0, 510.0, 550.0, 590.0, 630.0, 670.0, 710.0, 770.0];

/// Positions are f32 and a few units from the origin; each of some operations rounds them.
const ROUNDING: f64 = 8.0 * 8.0 * f32::EPSILON as f64;

/// In by one refraction, out by another.
const THROUGH: u32 = 0b111;

/// The reflectance of a boundary by Fresnel's formulae in terms of both angles.
fn reflectance(incident: f64, refracted: f64) -> f64 {
    let s = (incident - refracted).sin() / (incident + refracted).sin();
    let p = (incident - refracted).tan() / (incident + refracted).tan();
    (s * s + p * p) / 2.0
}

/// The photons that passed two boundaries at a wavelength, with their paths.
fn through(emission: &Emission<'_>, prefixes: &[Prefix], wavelength: f64) -> Vec<(Prefix, Scattered)> {
    let thrown = emission.throw(prefixes, |_| wavelength, &mut Spectra::default());
    let passed = thrown.photons().into_iter().filter(|photon| photon.branch == THROUGH);
    passed.map(|photon| (prefixes[photon.path as usize], photon)).collect()
}

fn vector(v: [f32; 3]) -> DVec3 {
    DVec3::from_array(v.map(f64::from))
}

#[test]
fn a_plate_moves_light_aside() {
    let incident = 0.7_f64;
    let along = DVec3::new(incident.sin(), 0.0, -incident.cos());
    let (top, bottom, floor) = (0.25, -0.25, -1.0);
    let stage = Stage::of(&format!(
        r#"<shape type="cube"><transform name="to_world"><scale x="3" y="3" z="0.25"/></transform>{}</shape>
        <shape type="rectangle"><transform name="to_world"><scale value="9"/><translate z="-1"/></transform></shape>{}"#,
        glass("SF11", ""),
        directional(along)
    ));
    let emission = stage.emission(settings(1, 8, 0.1));
    let emitted = emit(&emission, 4000, 0);
    assert!(emitted.photons.is_empty());
    let index = Glass::<f64>::find("SF11").unwrap();
    for wavelength in WAVELENGTHS {
        let refracted = (incident.sin() / index.index(wavelength)).asin();
        let shift = (top - bottom) * refracted.tan() + (bottom - floor) * incident.tan();
        let transmitted = (1.0 - reflectance(incident, refracted)).powi(2);
        let mut checked = 0;
        for (prefix, photon) in through(&emission, &emitted.prefixes, wavelength) {
            let entry = vector(prefix.position());
            // Those that neither came in nor went out through the sides.
            if !((entry.z - top).abs() <= 1e-6 && entry.x + (top - bottom) * refracted.tan() < 2.99) {
                continue;
            }
            let expected = DVec3::new(entry.x + shift, entry.y, floor);
            let landed = vector(photon.photon.position);
            assert!(landed.distance(expected) <= ROUNDING, "{wavelength}: {landed}, expected {expected}");
            assert!(vector(photon.photon.direction).distance(-along) <= ROUNDING);
            let share = f64::from(photon.photon.flux) / prefix.flux();
            assert!((share / transmitted - 1.0).abs() <= 1e-5, "{wavelength}: {share}, expected {transmitted}");
            checked += 1;
        }
        assert!(checked > 2000, "{checked}");
    }
}

/// An equilateral prism of side 2 along y, its base on z = 0.
fn prism() -> Mesh {
    let top = 3.0_f64.sqrt();
    let ends = |y: f64| [DVec3::new(-1.0, y, 0.0), DVec3::new(1.0, y, 0.0), DVec3::new(0.0, y, top)];
    let positions = [ends(-1.0), ends(1.0)].concat();
    let triangles = vec![[0, 1, 2], [5, 4, 3], [0, 3, 4], [0, 4, 1], [1, 4, 5], [1, 5, 2], [2, 5, 3], [2, 3, 0]];
    Mesh { positions, normals: None, triangles }
}

#[test]
fn a_prism_deviates_light_by_snells_law() {
    let elevation = 0.55_f64;
    let along = DVec3::new(elevation.cos(), 0.0, elevation.sin());
    let wall = r#"<shape type="rectangle"><transform name="to_world"><scale value="20"/>
        <lookat origin="6, 0, 0" target="0, 0, 0" up="0, 1, 0"/></transform></shape>"#;
    let elements = format!(r#"<shape type="cube">{}</shape>{wall}{}"#, glass("SF10", ""), directional(along));
    let stage = Stage::with_mesh(&elements, prism());
    let emission = stage.emission(settings(5, 8, 0.1));
    let emitted = emit(&emission, 8000, 0);
    let index = Glass::<f64>::find("SF10").unwrap();
    let apex = DVec2::new(0.0, 3.0_f64.sqrt());
    // The right face's outward normal; the left one's is its mirror image.
    let right = DVec2::from_angle(PI / 6.0);
    let incident = elevation + PI / 6.0;
    let mut last = f64::INFINITY;
    for wavelength in WAVELENGTHS {
        let n = index.index(wavelength);
        let first = (incident.sin() / n).asin();
        let second = PI / 3.0 - first;
        let emergent = (n * second.sin()).asin();
        let deviation = incident + emergent - PI / 3.0;
        assert!(deviation < last, "the deviation falls with the wavelength");
        last = deviation;
        let inside = DVec2::from_angle(elevation - (incident - first));
        let outside = DVec2::from_angle(elevation - deviation);
        let transmitted = (1.0 - reflectance(incident, first)) * (1.0 - reflectance(second, emergent));
        let mut checked = 0;
        for (prefix, photon) in through(&emission, &emitted.prefixes, wavelength) {
            let entry = vector(prefix.position());
            let [from, y] = [DVec2::new(entry.x, entry.z), DVec2::new(entry.y, 0.0)];
            let exit = from + inside * ((apex - from).dot(right) / inside.dot(right));
            let from_left = (from - apex).dot(DVec2::new(-right.x, right.y)).abs() <= 1e-6;
            if !(from_left && exit.y > 1e-3 && y.x.abs() < 0.999) {
                continue;
            }
            let end = exit + outside * ((6.0 - exit.x) / outside.x);
            let landed = vector(photon.photon.position);
            let expected = DVec3::new(end.x, y.x, end.y);
            // Between the refractions, errors of angles grow by the steepness of asin.
            assert!(landed.distance(expected) <= 4.0 * ROUNDING, "{wavelength}: {landed}, expected {expected}");
            let back = DVec3::new(-outside.x, 0.0, -outside.y);
            assert!(vector(photon.photon.direction).distance(back) <= ROUNDING);
            let share = f64::from(photon.photon.flux) / prefix.flux();
            assert!((share / transmitted - 1.0).abs() <= 1e-5, "{wavelength}: {share}, expected {transmitted}");
            checked += 1;
        }
        assert!(checked > 2000, "{checked}");
    }
}

/// The solid angle of a triangle (Van Oosterom and Strackee 1983).
fn solid_angle([a, b, c]: [DVec3; 3]) -> f64 {
    let [a, b, c] = [a, b, c].map(DVec3::normalize);
    2.0 * a.dot(b.cross(c)).abs().atan2(1.0 + a.dot(b) + b.dot(c) + c.dot(a))
}

#[test]
fn a_mirror_shows_the_lights_image() {
    // The mirror faces +x in the plane x = −1.
    let mirror = r#"<shape type="rectangle"><transform name="to_world"><scale value="0.5"/><rotate y="1" angle="90"/>
        <translate x="-1"/></transform><bsdf type="conductor"/></shape>"#;
    let stage = Stage::of(&format!("{mirror}{}{}", surroundings(5.0), point("0.5 0.2 0.1")));
    let emission = stage.emission(settings(2, 8, 0.1));
    let emitted = emit(&emission, 5000, 0);
    let image = DVec3::new(-2.5, 0.2, 0.1);
    assert!(emitted.prefixes.is_empty() && emitted.photons.len() > 4900);
    for photon in &emitted.photons {
        let towards = (image - vector(photon.position)).normalize();
        let found = vector(photon.direction);
        assert!(towards.distance(found) <= 2e-6, "{towards}, found {found}");
    }
    let corner = |y: f64, z: f64| DVec3::new(-1.0, y, z) - DVec3::new(0.5, 0.2, 0.1);
    let [a, b, c, d] = [corner(-0.5, -0.5), corner(0.5, -0.5), corner(0.5, 0.5), corner(-0.5, 0.5)];
    let exact = solid_angle([a, b, c]) + solid_angle([a, c, d]);
    let flux: f64 = emitted.photons.iter().map(|photon| f64::from(photon.flux)).sum();
    // Well-distributed points of a smooth function: far better than 1/√n.
    assert!((flux / exact - 1.0).abs() <= 5e-3, "{flux}, expected {exact}");
    assert!((emitted.account.deposited / flux - 1.0).abs() <= 1e-6);
}

/// Light from the middle of a ball goes to and fro along its radii.
#[test]
fn light_leaves_glass_that_it_is_made_in() {
    let radius = 0.8;
    let expected = |index: f64, absorption: f64| {
        let reflected = ((index - 1.0) / (index + 1.0)).powi(2);
        let out = (-absorption * radius).exp();
        4.0 * PI * (1.0 - reflected) * out / (1.0 - reflected * out * out)
    };
    let ball = |bsdf: &str| {
        let shape = format!(r#"<shape type="sphere"><float name="radius" value="{radius}"/>{bsdf}</shape>"#);
        Stage::of(&format!("{shape}{}{}", surroundings(5.0), point("0 0 0")))
    };
    let stage = ball(&glass("1.5", r#"<spectrum name="absorption" value="0.7"/>"#));
    let emitted = emit(&stage.emission(settings(0, 32, 1e-9)), 2000, 0);
    let found = emitted.account.deposited;
    assert!((found / expected(1.5, 0.7) - 1.0).abs() <= 1e-6, "{found}, expected {}", expected(1.5, 0.7));

    // The same for a colour, which waits at the boundary with the way to it.
    let stage = ball(&glass("1.5", r#"<spectrum name="absorption" value="380:0.2, 780:1.0"/>"#));
    let emission = stage.emission(settings(0, 32, 1e-9));
    let emitted = emit(&emission, 2000, 0);
    assert!(emitted.photons.is_empty());
    for (wavelength, absorption) in [(380.0, 0.2), (480.0, 0.4), (680.0, 0.8)] {
        let thrown = emission.throw(&emitted.prefixes, |_| wavelength, &mut Spectra::default());
        let found: f64 = thrown.photons().iter().map(|photon| f64::from(photon.photon.flux)).sum();
        let expected = expected(1.5, absorption);
        assert!((found / expected - 1.0).abs() <= 1e-5, "{wavelength}: {found}, expected {expected}");
    }
}
