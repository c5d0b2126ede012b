//! Cases as Mitsuba 3 XML: plain for Mitsuba, or with this project's photometric extensions for its own reader.

use core::fmt::Write as _;

use super::case::Work;
use super::model::{Light, Model, SensorPoint, Shape, Vec3, cross, unit};

/// Half the side of the white patch that stands for a point, m: small against every distance in the cases.
const PATCH: f64 = 2e-4;
/// How far the patch is in front of the point, m: surfaces that the point lies on must not hide it.
const LIFT: f64 = 2e-5;
/// How far the meter is from the patch, m.
const REACH: f64 = 1e-3;

/// The scene for this project's own reader, lights in photometric quantities. Files of luminaires are named by their
/// index: `luminaire-0`, `luminaire-1` …, with the extension kept.
#[must_use]
pub fn own_scene(model: &Model, work: &Work) -> String {
    let mut xml = head(None);
    xml += &format!("  <integrator type=\"{}\"/>\n", if *work == Work::Global { "path" } else { "direct" });
    for surface in &model.surfaces {
        let emitter = photometric("area", "luminance", surface.exitance / core::f64::consts::PI);
        shape(&mut xml, &surface.shape, surface.reflectance, if surface.exitance > 0.0 { &emitter } else { "" });
    }
    for (index, light) in model.lights.iter().enumerate() {
        let _ = match light {
            Light::Point { position, intensity } => writeln!(
                xml,
                "  <emitter type=\"point\">{}<float name=\"luminous_intensity\" value=\"{intensity}\"/></emitter>",
                point("position", *position)
            ),
            Light::Directional { direction, illuminance } => writeln!(
                xml,
                "  <emitter type=\"directional\">{}<float name=\"illuminance\" value=\"{illuminance}\"/></emitter>",
                vector("direction", *direction)
            ),
            Light::Photometric { position: [x, y, z], file } => writeln!(
                xml,
                "  <emitter type=\"luminaire\"><string name=\"filename\" value=\"{}\"/><transform name=\"to_world\">\
                 <translate x=\"{x}\" y=\"{y}\" z=\"{z}\"/></transform></emitter>",
                luminaire_name(index, file)
            ),
        };
    }
    xml += "  <sensor type=\"perspective\"><float name=\"fov\" value=\"40\"/></sensor>\n</scene>\n";
    xml
}

/// The name under which [`own_scene`] looks for the file of the light with this index.
#[must_use]
pub fn luminaire_name(index: usize, file: &std::path::Path) -> String {
    let extension = file.extension().and_then(|extension| extension.to_str()).unwrap_or("ies");
    format!("luminaire-{index}.{extension}")
}

/// The scene for Mitsuba 3; numbers are photometric (a radiance of 1 is 1 cd/m²). `None` if a light can't be said in
/// plain Mitsuba.
///
/// The parameter `place` is a point's frame ([`place`]). A small white patch lies there, and a radiance meter looks at
/// it: π times what it reads is illuminance. Mitsuba's irradiance meters find no light but what a random ray hits, so
/// that points and parallel light are dark to them; and meters of one scene would shade each other.
#[must_use]
pub fn plain_scene(model: &Model, first: &SensorPoint, about: &str, depth: i32) -> Option<String> {
    let mut xml = head(Some((about, depth, first)));
    for surface in &model.surfaces {
        let emitter = spectral("area", "radiance", surface.exitance / core::f64::consts::PI);
        shape(&mut xml, &surface.shape, surface.reflectance, if surface.exitance > 0.0 { &emitter } else { "" });
    }
    for light in &model.lights {
        let _ = match light {
            Light::Point { position, intensity } => writeln!(
                xml,
                "  <emitter type=\"point\">{}<spectrum name=\"intensity\" value=\"{intensity}\"/></emitter>",
                point("position", *position)
            ),
            Light::Directional { direction, illuminance } => writeln!(
                xml,
                "  <emitter type=\"directional\">{}<spectrum name=\"irradiance\" value=\"{illuminance}\"/></emitter>",
                vector("direction", *direction)
            ),
            Light::Photometric { .. } => return None,
        };
    }
    xml += &meter();
    xml += "</scene>\n";
    Some(xml)
}

/// Everything before the shapes; for Mitsuba with the integrator and what the case is about.
fn head(mitsuba: Option<(&str, i32, &SensorPoint)>) -> String {
    let Some((about, depth, first)) = mitsuba else { return "<scene version=\"3.0.0\">\n".to_owned() };
    let about = about.replace('&', "and").replace('<', "below").replace("--", "-");
    format!(
        "<!-- {about} -->\n<scene version=\"3.0.0\">\n  <default name=\"spp\" value=\"4096\"/>\n  \
         <default name=\"place\" value=\"{}\"/>\n  \
         <integrator type=\"path\"><integer name=\"max_depth\" value=\"{depth}\"/></integrator>\n",
        place(first)
    )
}

fn photometric(kind: &str, quantity: &str, value: f64) -> String {
    format!("<emitter type=\"{kind}\"><float name=\"{quantity}\" value=\"{value}\"/></emitter>")
}

fn spectral(kind: &str, quantity: &str, value: f64) -> String {
    format!("<emitter type=\"{kind}\"><spectrum name=\"{quantity}\" value=\"{value}\"/></emitter>")
}

fn point(name: &str, [x, y, z]: Vec3) -> String {
    format!("<point name=\"{name}\" x=\"{x}\" y=\"{y}\" z=\"{z}\"/>")
}

fn vector(name: &str, [x, y, z]: Vec3) -> String {
    format!("<vector name=\"{name}\" x=\"{x}\" y=\"{y}\" z=\"{z}\"/>")
}

fn diffuse(reflectance: f64) -> String {
    format!("<bsdf type=\"diffuse\"><spectrum name=\"reflectance\" value=\"{reflectance}\"/></bsdf>")
}

fn shape(xml: &mut String, shape: &Shape, reflectance: f64, emitter: &str) {
    let (kind, place) = match *shape {
        Shape::Rectangle { centre, half_u, half_v } => {
            ("rectangle", matrix(half_u, half_v, unit(cross(half_u, half_v)), centre))
        }
        Shape::Disk { centre, normal, radius } => {
            let (u, v) = frame(normal);
            let scaled = |a: Vec3| a.map(|x| x * radius);
            ("disk", matrix(scaled(u), scaled(v), scaled(normal), centre))
        }
        Shape::Sphere { centre, radius, inward } => {
            let flip = if inward { "<boolean name=\"flip_normals\" value=\"true\"/>" } else { "" };
            ("sphere", format!("{}<float name=\"radius\" value=\"{radius}\"/>{flip}", point("center", centre)))
        }
    };
    let bsdf = diffuse(reflectance);
    let _ = writeln!(xml, "  <shape type=\"{kind}\">\n    {place}\n    {bsdf}{emitter}\n  </shape>");
}

/// The white patch at the place that the scene is given, and the meter that looks at it.
fn meter() -> String {
    format!(
        "  <shape type=\"rectangle\">\n    <transform name=\"to_world\"><scale value=\"{PATCH}\"/><translate z=\"{LIFT}\"/>\
         <matrix value=\"$place\"/></transform>\n    {}\n  </shape>\n  <sensor type=\"radiancemeter\">\n    <transform \
         name=\"to_world\"><lookat origin=\"0, 0, {REACH}\" target=\"0, 0, 0\" up=\"0, 1, 0\"/><matrix value=\"$place\"/>\
         </transform>\n    <sampler type=\"independent\"><integer name=\"sample_count\" value=\"$spp\"/></sampler>\n    <film \
         type=\"hdrfilm\"><integer name=\"width\" value=\"1\"/><integer name=\"height\" value=\"1\"/><string \
         name=\"pixel_format\" value=\"luminance\"/><rfilter type=\"box\"/></film>\n  </sensor>\n",
        diffuse(1.0)
    )
}

/// The frame of a point as the 16 numbers of a matrix, row by row: its normal is the third column, its position the
/// last.
#[must_use]
pub fn place(point: &SensorPoint) -> String {
    let (u, v) = frame(point.normal);
    rows(u, v, point.normal, point.position)
}

/// Two unit vectors u, v with u × v = a unit normal.
fn frame(normal: Vec3) -> (Vec3, Vec3) {
    let helper = if normal[0].abs() < 0.7 { [1.0, 0.0, 0.0] } else { [0.0, 1.0, 0.0] };
    let v = unit(cross(normal, helper));
    (cross(v, normal), v)
}

/// `to_world` by its columns.
fn matrix(u: Vec3, v: Vec3, w: Vec3, origin: Vec3) -> String {
    format!("<transform name=\"to_world\"><matrix value=\"{}\"/></transform>", rows(u, v, w, origin))
}

/// A matrix by its columns, as its rows.
fn rows(u: Vec3, v: Vec3, w: Vec3, origin: Vec3) -> String {
    let row = |i: usize| format!("{} {} {} {}", u[i], v[i], w[i], origin[i]);
    format!("{} {} {} 0 0 0 1", row(0), row(1), row(2))
}

#[cfg(test)]
mod tests {
    use super::{own_scene, place, plain_scene};
    use crate::scene::{Geometry, Source, load};
    use crate::verify::model::{Shape, cross, unit};

    #[test]
    fn every_case_is_a_scene_that_says_the_same() {
        for case in crate::verify::cases(None) {
            let scene = load(&Source::text("case.xml", own_scene(&case.model, &case.work)), &[]).unwrap();
            assert_eq!(scene.shapes.len(), case.model.surfaces.len(), "{}", case.name);
            for (shape, surface) in scene.shapes.iter().zip(&case.model.surfaces) {
                assert_eq!(shape.emitter.is_some(), surface.exitance > 0.0);
                match (&shape.geometry, &surface.shape) {
                    (Geometry::Rectangle { center, normal, .. }, Shape::Rectangle { centre, half_u, half_v }) => {
                        assert_eq!(center.to_array(), *centre);
                        let expected = unit(cross(*half_u, *half_v));
                        assert!((0..3).all(|i| (normal[i] - expected[i]).abs() < 1e-12));
                    }
                    (Geometry::Disk { center, radius, normal }, Shape::Disk { centre, radius: r, normal: n }) => {
                        assert_eq!(center.to_array(), *centre);
                        assert!((radius - r).abs() < 1e-12 && (0..3).all(|i| (normal[i] - n[i]).abs() < 1e-12));
                    }
                    (Geometry::Sphere { radius, inward, .. }, Shape::Sphere { radius: r, inward: i, .. }) => {
                        assert_eq!((radius, inward), (r, i));
                    }
                    other => panic!("{other:?}"),
                }
            }
        }
    }

    #[test]
    fn places_are_frames_of_their_points() {
        for case in crate::verify::cases(None) {
            assert!(plain_scene(&case.model, &case.points[0], &case.about, -1).is_some());
            for point in &case.points {
                let m: Vec<f64> = place(point).split(' ').map(|number| number.parse().unwrap()).collect();
                let column = |j: usize| [m[j], m[4 + j], m[8 + j]];
                assert_eq!((m.len(), column(2), column(3)), (16, point.normal, point.position));
                let right_handed = cross(column(0), column(1));
                assert!((0..3).all(|i| (right_handed[i] - point.normal[i]).abs() <= 1e-12), "{}", case.name);
            }
        }
    }
}
