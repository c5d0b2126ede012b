//! Beams hold all the light that meets mirrors and glass first, once.

use core::f64::consts::{PI, TAU};

use glam::DVec3;

use super::{Stage, area, directional, emit, glass, mean, point, ring, settings};
use crate::direct::{Light, Shape, single};
use crate::geometry::sampling::{SobolSequence, square_to_cosine_hemisphere, square_to_disk};
use crate::geometry::{Ray, SurfacePoint};

/// How many standard errors two estimates may differ by: more by chance once in 10⁵ comparisons.
const MOST: f64 = 4.5;

/// The flux that meets one of the first `targets` shapes before anything else, found without aiming: by rays from all of the light in all
/// directions. With its standard error.
fn unaimed(stage: &Stage, targets: u32) -> (f64, f64) {
    let light = &stage.whitted.lights()[0];
    let points = SobolSequence::new(77);
    let count = 1 << 18;
    let (mut sum, mut squares) = (0.0, 0.0);
    for index in 0..count {
        let [u, v] = [0, 1].map(|dimension| points.point(index, dimension));
        let (ray, flux) = ray_of(light, u, v);
        let hit = stage.whitted.world().closest_hit(&ray);
        // Their black sides are none of it.
        if hit.is_some_and(|hit| hit.shape < targets && stage.whitted.material(&hit).is_some()) {
            sum += flux;
            squares += flux * flux;
        }
    }
    let count = f64::from(count);
    let mean = sum / count;
    (mean, ((squares / count - mean * mean) / count).sqrt())
}

fn over_sphere([u, v]: [f32; 2]) -> DVec3 {
    let (z, (sin, cos)) = (1.0 - 2.0 * f64::from(u), (TAU * f64::from(v)).sin_cos());
    let across = (1.0 - z * z).sqrt();
    DVec3::new(across * cos, across * sin, z)
}

fn ray_of(light: &Light, u: [f32; 2], v: [f32; 2]) -> (Ray, f64) {
    match light {
        Light::Area { source, .. } => {
            let (from, normal, area) = match &source.shape {
                Shape::Rectangle(flat) => {
                    (flat.at(u.map(|u| 2.0 * f64::from(u) - 1.0)), flat.normal, 4.0 * flat.u.cross(flat.v).length())
                }
                Shape::Disk(flat) => {
                    let place = square_to_disk(u).as_dvec2().to_array();
                    (flat.at(place), flat.normal, PI * flat.u.cross(flat.v).length())
                }
                Shape::Sphere { centre, radius } => {
                    let normal = over_sphere(u);
                    (*centre + normal * *radius, normal, 4.0 * PI * radius * radius)
                }
                Shape::Triangle(_) => unreachable!(),
            };
            let local = square_to_cosine_hemisphere(v).as_dvec3();
            let (x, y) = normal.any_orthonormal_pair();
            let direction = x * local.x + y * local.y + normal * local.z;
            let point = SurfacePoint::new(single(from), single(normal)).on(source.primitive);
            (point.ray(single(direction)), PI * area)
        }
        Light::Point { position, .. } => (Ray::new(single(*position), single(over_sphere(v))), 4.0 * PI),
        Light::Luminaire { luminaire, .. } => {
            let direction = over_sphere(v);
            (Ray::new(single(luminaire.position), single(direction)), 4.0 * PI * luminaire.candela(direction))
        }
        Light::Directional { direction, .. } => {
            let (x, y) = direction.any_orthonormal_pair();
            let place = square_to_disk(v).as_dvec2() * 3.0;
            let from = x * place.x + y * place.y - *direction * 9.0;
            (Ray::new(single(from), single(*direction)), 9.0 * PI)
        }
    }
}

/// The flux emitted in independent passes.
fn aimed(stage: &Stage) -> (f64, f64) {
    let emission = stage.emission(settings(3, 1, 1.0));
    let fluxes: Vec<f64> = (0..16).map(|pass| emit(&emission, 4096, pass).account.emitted).collect();
    mean(&fluxes)
}

fn assert_same(stage: &Stage, targets: u32, what: &str) {
    let ((expected, error), (found, deviation)) = (unaimed(stage, targets), aimed(stage));
    assert!(expected > 10.0 * error, "{what}: the oracle says {expected} ± {error}");
    assert!(
        (found - expected).abs() <= MOST * error.hypot(deviation),
        "{what}: {found} ± {deviation}, expected {expected} ± {error}"
    );
    // Aiming is what beams are for; the oracle has four times the rays.
    assert!(deviation < 2.0 * error, "{what}: {found} ± {deviation}, {expected} ± {error} without aiming");
}

fn sphere(centre: &str, radius: f64, bsdf: &str) -> String {
    format!(
        r#"<shape type="sphere"><point name="center" value="{centre}"/><float name="radius" value="{radius}"/>{bsdf}</shape>"#
    )
}

fn lights() -> [(&'static str, String); 8] {
    let down = r#"<rotate x="1" angle="180"/>"#;
    let turned = r#"<rotate x="1" angle="140"/>"#;
    [
        ("rectangle", area("rectangle", &format!(r#"{turned}<scale value="0.6"/><translate y="-0.5" z="2"/>"#))),
        ("near rectangle", area("rectangle", &format!(r#"{down}<scale x="1.5" y="1.2"/><translate z="0.75"/>"#))),
        ("near disk", area("disk", &format!(r#"{down}<scale value="1.4"/><translate x="0.3" z="0.8"/>"#))),
        ("sphere", area("sphere", r#"<scale value="0.7"/><translate x="1.2" z="1.5"/>"#)),
        ("large sphere", area("sphere", r#"<scale value="2"/><translate x="-1" z="3"/>"#)),
        ("point", point("0.3 -0.2 1.1")),
        ("point in the hole", point("0.1 0 0.3")),
        ("directional", directional(DVec3::new(0.3, 0.5, -0.7))),
    ]
}

#[test]
fn beams_towards_a_mesh_have_all_of_its_light() {
    for (name, light) in lights() {
        let elements = format!(r#"<shape type="cube">{}</shape>{light}"#, glass("1.5", ""));
        assert_same(&Stage::with_mesh(&elements, ring(48, [0.5, 0.7, 0.6])), 1, name);
    }
}

#[test]
fn beams_towards_spheres_that_overlap_share_their_light() {
    let balls = sphere("0.2 0 0.1", 0.4, &glass("1.5", "")) + &sphere("-0.2 0.1 0", 0.5, r#"<bsdf type="conductor"/>"#);
    for (name, light) in lights() {
        assert_same(&Stage::of(&format!("{balls}{light}")), 2, name);
    }
    // Two discs' worth of directions that overlap, by a fine grid of directions.
    let stage = Stage::of(&format!("{balls}{}", point("0 0 2")));
    let centres = [(DVec3::new(0.2, 0.0, -1.9), 0.4), (DVec3::new(-0.2, 0.1, -2.0), 0.5)];
    let steps = 1500;
    let mut inside = 0;
    for i in 0..steps * steps {
        let [x, y] = [i % steps, i / steps].map(|k| (f64::from(k) + 0.5) / f64::from(steps));
        // A cap of 0.2 about −z, by equal areas.
        let (z, (sin, cos)) = (-1.0 + 0.2 * x, (TAU * y).sin_cos());
        let across = (1.0 - z * z).sqrt();
        let direction = DVec3::new(across * cos, across * sin, z);
        let meets = |(centre, radius): &(DVec3, f64)| centre.cross(direction).length_squared() < radius * radius;
        inside += i32::from(centres.iter().any(meets));
    }
    let exact = TAU * 0.2 * f64::from(inside) / f64::from(steps * steps);
    let (found, error) = aimed(&stage);
    // The grid errs by some of its cells along the outline.
    assert!((found - exact).abs() <= MOST * error + 1e-4 * exact, "{found} ± {error}, expected {exact}");
}

#[test]
fn beams_stop_at_what_is_in_front() {
    let half = r#"<shape type="rectangle"><transform name="to_world"><translate x="1" z="1"/></transform></shape>"#;
    for (name, light) in [
        ("point", point("0 0 2.2")),
        ("rectangle", area("rectangle", r#"<rotate x="1" angle="180"/><scale value="0.4"/><translate z="2"/>"#)),
    ] {
        let cube = format!(
            r#"<shape type="cube"><transform name="to_world"><scale value="0.4"/></transform>{}</shape>"#,
            glass("1.5", "")
        );
        assert_same(&Stage::of(&format!("{cube}{half}{light}")), 1, name);
        let ball = sphere("0 0 0", 0.5, &glass("1.5", ""));
        assert_same(&Stage::of(&format!("{ball}{half}{light}")), 1, name);
    }
}

#[test]
fn lights_within_glass_shine_on_all_of_it() {
    let ball = sphere("0 0 0", 1.0, &glass("1.5", ""));
    for (light, exact) in [
        (point("0.3 0.2 0.1"), 4.0 * PI),
        (area("disk", r#"<scale value="0.5"/><translate x="0.1"/>"#), PI * PI * 0.25),
        (area("sphere", r#"<scale value="0.3"/><translate x="0.4"/>"#), PI * 4.0 * PI * 0.09),
    ] {
        let cube = format!(r#"<shape type="cube">{}</shape>"#, glass("1.5", ""));
        for around in [&ball, &cube] {
            let stage = Stage::of(&format!("{around}{light}"));
            let (found, error) = aimed(&stage);
            assert!((found - exact).abs() <= MOST * error + 1e-5 * exact, "{found} ± {error}, expected {exact}");
        }
    }
}

#[test]
fn a_light_without_mirrors_and_glass_is_named() {
    let matt = r#"<shape type="sphere"/>"#;
    let stage = Stage::of(&format!("{matt}{}", point("0 0 3")));
    let emission = stage.emission(settings(0, 8, 0.1));
    assert_eq!((emission.idle_lights(), emission.beams().len()), (vec![0], 0));
    let emitted = emit(&emission, 1000, 0);
    assert!(emitted.photons.is_empty() && emitted.prefixes.is_empty() && emitted.account.emitted == 0.0);
    assert_eq!((emission.bytes_for(1 << 40), emission.attempts(1000)), (0, 0));
    // One of two sees glass: the other one is behind a wall that faces it.
    let ball = sphere("0 0 0", 1.0, &glass("1.5", ""));
    let wall = r#"<shape type="rectangle"><transform name="to_world"><scale value="100"/><translate z="-2"/></transform></shape>"#;
    let stage = Stage::of(&format!("{ball}{wall}{}{}", point("0 0 -3"), point("0 0 3")));
    assert_eq!(stage.emission(settings(0, 8, 0.1)).idle_lights(), [0]);
    let nothing = Stage::of("");
    assert!(emit(&nothing.emission(settings(0, 8, 0.1)), 10, 0).photons.is_empty());
}
