//! Meshes of the built-in scenes that are made by a formula.

use core::f64::consts::TAU;
use core::fmt::Write as _;
use std::path::PathBuf;

/// A ring about the z axis, its middle at the origin, whose cross-section is a superellipse: the points at a distance ρ from the axis
/// and a height z with |(ρ − `radius`)/`half_thickness`|³ + |z/`half_height`|³ = 1. Lengths in scene units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ring {
    /// Distance of the cross-section's middle from the axis.
    pub radius: f64,
    /// Half its extent across.
    pub half_thickness: f64,
    /// Half its extent along the axis.
    pub half_height: f64,
    /// Quadrilaterals around the axis.
    pub around: usize,
    /// Quadrilaterals around the cross-section.
    pub across: usize,
}

/// The ring of the scenes `caustic-ring` and `caustic-ring-mirror`: 3.6 units across, 0.8 high, 3840 triangles.
pub const RING: Ring = Ring { radius: 1.6, half_thickness: 0.2, half_height: 0.4, around: 96, across: 20 };

/// The folder of the built-in scenes' meshes.
#[must_use]
pub fn mesh_directory() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../renderers/scenes/meshes")
}

/// All generated files with their texts.
#[must_use]
pub fn generate() -> Vec<(PathBuf, String)> {
    vec![(mesh_directory().join("ring.obj"), RING.obj())]
}

impl Ring {
    /// A point of the surface and its outward unit normal, each as distance from the axis and height: at the angle `t` in turns
    /// around the cross-section, from the outside upwards.
    fn section(&self, t: f64) -> [[f64; 2]; 2] {
        let (sine, cosine) = (t * TAU).sin_cos();
        let scale = (cosine.abs().powi(3) + sine.abs().powi(3)).cbrt();
        let (x, z) = (cosine / scale, sine / scale);
        // The gradient of |x|³ + |z|³, in the ring's lengths.
        let (along, up) = (x * x.abs() / self.half_thickness, z * z.abs() / self.half_height);
        let length = along.hypot(up);
        [[self.radius + self.half_thickness * x, self.half_height * z], [along / length, up / length]]
    }

    /// The mesh as a Wavefront OBJ text: vertices with normals, quadrilaterals anticlockwise from outside.
    #[must_use]
    pub fn obj(&self) -> String {
        let mut text = "# A ring about the z axis, of superelliptic cross-section; written by generate_meshes of spectral-tests: not to be edited.\n"
            .to_owned();
        for (keyword, which) in [("v", 0), ("vn", 1)] {
            for i in 0..self.around {
                let (sine, cosine) = (turn(i, self.around) * TAU).sin_cos();
                for j in 0..self.across {
                    let [out, up] = self.section(turn(j, self.across))[which];
                    let [x, y, z] = [out * cosine, out * sine, up].map(decimal);
                    let _ = writeln!(text, "{keyword} {x} {y} {z}");
                }
            }
        }
        for i in 0..self.around {
            for j in 0..self.across {
                let vertex = |i: usize, j: usize| i % self.around * self.across + j % self.across + 1;
                let [a, b, c, d] = [vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1), vertex(i, j + 1)];
                let _ = writeln!(text, "f {a}//{a} {b}//{b} {c}//{c} {d}//{d}");
            }
        }
        text
    }
}

/// The part of a turn.
#[allow(clippy::cast_precision_loss, reason = "a mesh has few vertices")]
fn turn(i: usize, count: usize) -> f64 {
    i as f64 / count as f64
}

/// Six decimals, without a negative zero.
fn decimal(value: f64) -> String {
    let text = format!("{value:.6}");
    if text == "-0.000000" { text[1..].to_owned() } else { text }
}
