//! Cases as Radiance scene descriptions.

use core::f64::consts::PI;
use core::fmt::Write as _;

use super::model::{Light, Model, Shape, Vec3, along};

/// Radius of the sphere that stands for a point light, m: CIE 171 test case 5.8 as the thesis models it.
const POINT_RADIUS: f64 = 0.01;
/// Full angle of the source that stands for parallel light, degrees: CIE 171 test case 5.6 as the thesis models it.
const SUN_ANGLE: f64 = 1.0;

/// The scene; numbers are photometric (a radiance of 1 is 1 cd/m², in all three channels alike), so that any channel of
/// `rtrace -I` is illuminance in lx. `None` if something can't be said in Radiance: surfaces that shine and reflect,
/// and photometric files, which `ies2rad` converts.
#[must_use]
pub fn scene(model: &Model, about: &str) -> Option<String> {
    let mut rad = format!("# {about}\n");
    for (index, surface) in model.surfaces.iter().enumerate() {
        if surface.exitance > 0.0 && surface.reflectance > 0.0 {
            return None;
        }
        let material = if surface.exitance > 0.0 {
            let radiance = surface.exitance / PI;
            format!("void light material{index} 0 0 3 {radiance} {radiance} {radiance}\n")
        } else {
            let r = surface.reflectance;
            format!("void plastic material{index} 0 0 5 {r} {r} {r} 0 0\n")
        };
        let _ = writeln!(rad, "{material}material{index} {}", shape(index, &surface.shape));
    }
    for (index, light) in model.lights.iter().enumerate() {
        let (radiance, source) = match light {
            Light::Point { position: [x, y, z], intensity } => (
                intensity / (PI * POINT_RADIUS * POINT_RADIUS),
                format!("sphere lamp{index} 0 0 4 {x} {y} {z} {POINT_RADIUS}"),
            ),
            Light::Directional { direction, illuminance } => {
                let sine = (SUN_ANGLE / 2.0).to_radians().sin();
                let [x, y, z] = direction.map(|x| -x);
                (illuminance / (PI * sine * sine), format!("source lamp{index} 0 0 4 {x} {y} {z} {SUN_ANGLE}"))
            }
            Light::Photometric { .. } => return None,
        };
        let _ = writeln!(rad, "void light glow{index} 0 0 3 {radiance} {radiance} {radiance}\nglow{index} {source}");
    }
    Some(rad)
}

fn shape(index: usize, shape: &Shape) -> String {
    match *shape {
        Shape::Rectangle { centre, half_u, half_v } => {
            // Anticlockwise seen from the front.
            let corners = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)];
            let corner = |(a, b): (f64, f64)| spaced(along(along(centre, a, half_u), b, half_v));
            format!("polygon shape{index} 0 0 12 {}", corners.map(corner).join("  "))
        }
        Shape::Disk { centre, normal, radius } => {
            format!("ring shape{index} 0 0 8 {}  {}  0 {radius}", spaced(centre), spaced(normal))
        }
        Shape::Sphere { centre, radius, inward } => {
            let kind = if inward { "bubble" } else { "sphere" };
            format!("{kind} shape{index} 0 0 4 {} {radius}", spaced(centre))
        }
    }
}

/// Coordinates with spaces between them.
pub(super) fn spaced([x, y, z]: Vec3) -> String {
    format!("{x} {y} {z}")
}
