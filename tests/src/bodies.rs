//! Bodies of glass for scenes in tests: meshes as OBJ text.

use core::f64::consts::PI;

use crate::snell::Prism;

/// A dome of triangles with the unit sphere's own normals, and the flat disk that closes it, as one body above or below y = 0: the scene's
/// elements with a material, and the mesh, which they call `dome.obj`.
#[must_use]
pub fn hemisphere(up: bool, rings: u32, bsdf: &str) -> (String, String) {
    let segments = 4 * rings;
    let mut text = String::new();
    for ring in 0..=rings {
        for segment in 0..segments {
            let (from, around) =
                (PI / 2.0 * f64::from(ring) / f64::from(rings), 2.0 * PI * f64::from(segment) / f64::from(segments));
            let [x, y, z] = [from.sin() * around.cos(), from.cos(), from.sin() * around.sin()];
            let y = if up { y } else { -y };
            text += &format!("v {x} {y} {z}\nvn {x} {y} {z}\n");
        }
    }
    for ring in 0..rings {
        for segment in 0..segments {
            let next = (segment + 1) % segments;
            let [a, b] = [segment, next].map(|s| ring * segments + s + 1);
            let [c, d] = [a, b].map(|corner| corner + segments);
            for face in [[a, d, c], [a, b, d]] {
                // At the pole the first ring is a point.
                if ring == 0 && face == [a, b, d] {
                    continue;
                }
                let [p, q, r] = if up { face } else { [face[0], face[2], face[1]] };
                text += &format!("f {p}//{p} {q}//{q} {r}//{r}\n");
            }
        }
    }
    let turn = if up { 90 } else { -90 };
    let body = format!(
        "<shape type='obj'><string name='filename' value='dome.obj'/>{bsdf}</shape>
        <shape type='disk'><transform name='to_world'><rotate x='1' angle='{turn}'/></transform>{bsdf}</shape>"
    );
    (body, text)
}

/// A closed prism from z = −1 to 1, with its edge along z at the origin and faces of this length.
#[must_use]
pub fn prism(prism: Prism, length: f64) -> String {
    let [left, right] = [-1.0, 1.0].map(|side| prism.face(side, length));
    let mut text = String::new();
    for z in [-1.0, 1.0] {
        for [x, y] in [[0.0, 0.0], left, right] {
            text += &format!("v {x} {y} {z}\n");
        }
    }
    text + "f 1 3 2\nf 4 5 6\nf 1 2 5 4\nf 2 3 6 5\nf 3 1 4 6\n"
}

/// A horizontal square of half side 1.5 that sees up and is shaded as if it were tilted.
#[must_use]
pub fn tilted_square() -> String {
    let (x, y) = (0.4_f64.sin(), 0.4_f64.cos());
    let corners = [(-1.5, -1.5), (-1.5, 1.5), (1.5, 1.5), (1.5, -1.5)];
    let vertices: String = corners.iter().map(|(a, b)| format!("v {a} 0 {b}\nvn {x} {y} 0\n")).collect();
    vertices + "f 1//1 2//2 3//3\nf 1//1 3//3 4//4\n"
}
