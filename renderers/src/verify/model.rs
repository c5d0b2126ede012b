//! Geometry and lights of a case, in photometric units, independent of any renderer's file format.

/// A point or a direction; lengths in metres.
pub type Vec3 = [f64; 3];

/// A shape; its front is the side that a normal points to.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Shape {
    /// `centre` ± `half_u` ± `half_v`, the halves perpendicular; the normal is along `half_u` × `half_v`.
    Rectangle {
        /// Middle.
        centre: Vec3,
        /// From the middle to the middle of one edge.
        half_u: Vec3,
        /// From the middle to the middle of the next edge.
        half_v: Vec3,
    },
    /// A flat disk.
    Disk {
        /// Centre.
        centre: Vec3,
        /// Unit normal.
        normal: Vec3,
        /// Radius.
        radius: f64,
    },
    /// A sphere.
    Sphere {
        /// Centre.
        centre: Vec3,
        /// Radius.
        radius: f64,
        /// Whether the front is the inside.
        inward: bool,
    },
}

/// A surface: Lambertian on its front, black on its back, opaque.
#[derive(Clone, Debug, PartialEq)]
pub struct Surface {
    /// Where it is.
    pub shape: Shape,
    /// Reflectance of the front, 0 to 1.
    pub reflectance: f64,
    /// Luminous exitance of the front on its own, lm/m².
    pub exitance: f64,
}

/// A light that is no surface.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Light {
    /// An isotropic point.
    Point {
        /// Where it is.
        position: Vec3,
        /// Luminous intensity, cd.
        intensity: f64,
    },
    /// Parallel light.
    Directional {
        /// Unit vector along which the light travels.
        direction: Vec3,
        /// Illuminance on a plane perpendicular to it, lx.
        illuminance: f64,
    },
    /// A luminaire by a photometric file, hanging upright.
    Photometric {
        /// Photometric centre.
        position: Vec3,
        /// IES LM-63 or EULUMDAT file.
        file: std::path::PathBuf,
    },
}

/// A scene.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Model {
    /// Surfaces.
    pub surfaces: Vec<Surface>,
    /// Lights that are no surfaces.
    pub lights: Vec<Light>,
}

/// A point where illuminance is asked for.
#[derive(Clone, Debug, PartialEq)]
pub struct SensorPoint {
    /// The point's name within its case; no comma and no white space.
    pub name: String,
    /// Where it is.
    pub position: Vec3,
    /// Unit normal of the receiving side.
    pub normal: Vec3,
}

impl SensorPoint {
    /// A named point.
    pub fn new(name: impl Into<String>, position: Vec3, normal: Vec3) -> Self {
        Self { name: name.into(), position, normal }
    }
}

impl Model {
    /// Adds a black surface that shines.
    pub fn shine(&mut self, shape: Shape, exitance: f64) {
        self.surfaces.push(Surface { shape, reflectance: 0.0, exitance });
    }

    /// Adds a surface that reflects.
    pub fn reflect(&mut self, shape: Shape, reflectance: f64) {
        self.surfaces.push(Surface { shape, reflectance, exitance: 0.0 });
    }

    /// Adds a closed box seen from inside; reflectances in the order floor, ceiling, walls at low x, high x, low y,
    /// high y.
    pub fn room(&mut self, low: Vec3, high: Vec3, reflectances: [f64; 6]) {
        let [floor, ceiling, walls @ ..] = reflectances;
        let sides = [(2, 1.0, floor), (2, -1.0, ceiling), (0, 1.0, walls[0]), (0, -1.0, walls[1]), (1, 1.0, walls[2])];
        for (axis, facing, reflectance) in sides.into_iter().chain([(1, -1.0, walls[3])]) {
            self.reflect(box_side(low, high, axis, facing, true), reflectance);
        }
    }

    /// Adds a black closed box seen from outside.
    pub fn block(&mut self, low: Vec3, high: Vec3) {
        for (axis, facing) in [(0, 1.0), (0, -1.0), (1, 1.0), (1, -1.0), (2, 1.0), (2, -1.0)] {
            self.reflect(box_side(low, high, axis, facing, false), 0.0);
        }
    }
}

/// The side of a box whose front faces along `facing` times an axis, towards the inside or the outside.
fn box_side(low: Vec3, high: Vec3, axis: usize, facing: f64, inside: bool) -> Shape {
    let mut centre: Vec3 = core::array::from_fn(|i| f64::midpoint(low[i], high[i]));
    centre[axis] = if (facing > 0.0) == inside { low[axis] } else { high[axis] };
    let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
    let half = |i: usize| (high[i] - low[i]) / 2.0;
    let (mut half_u, mut half_v) = ([0.0; 3], [0.0; 3]);
    half_u[u] = half(u) * facing;
    half_v[v] = half(v);
    Shape::Rectangle { centre, half_u, half_v }
}

/// A rectangle in the plane `axis` = `at`, spanning the ranges of the next two axes (cyclically), its front facing
/// along `facing` times the axis.
#[must_use]
pub fn flat(axis: usize, at: f64, first: [f64; 2], second: [f64; 2], facing: f64) -> Shape {
    let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
    let (mut centre, mut half_u, mut half_v) = ([0.0; 3], [0.0; 3], [0.0; 3]);
    centre[axis] = at;
    centre[u] = f64::midpoint(first[0], first[1]);
    centre[v] = f64::midpoint(second[0], second[1]);
    half_u[u] = (first[1] - first[0]) / 2.0 * facing;
    half_v[v] = (second[1] - second[0]) / 2.0;
    Shape::Rectangle { centre, half_u, half_v }
}

/// Cross product.
pub(crate) fn cross(a: Vec3, b: Vec3) -> Vec3 {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// Scalar product.
pub(crate) fn dot(a: Vec3, b: Vec3) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// a + s b.
pub(crate) fn along(a: Vec3, s: f64, b: Vec3) -> Vec3 {
    core::array::from_fn(|i| a[i] + s * b[i])
}

/// A vector of length 1 along one that is not zero.
pub(crate) fn unit(a: Vec3) -> Vec3 {
    let length = dot(a, a).sqrt();
    a.map(|x| x / length)
}

#[cfg(test)]
mod tests {
    use super::{Model, Shape, cross, dot, flat};

    #[test]
    fn boxes_face_as_asked() {
        let (mut room, mut block) = (Model::default(), Model::default());
        room.room([0.0; 3], [4.0, 3.0, 2.0], [0.5; 6]);
        block.block([0.0; 3], [4.0, 3.0, 2.0]);
        for (model, sign) in [(room, 1.0), (block, -1.0)] {
            assert_eq!(model.surfaces.len(), 6);
            let mut area = 0.0;
            for surface in model.surfaces {
                let Shape::Rectangle { centre, half_u, half_v } = surface.shape else { unreachable!() };
                let normal = cross(half_u, half_v);
                let inwards: [f64; 3] = core::array::from_fn(|i| [2.0, 1.5, 1.0][i] - centre[i]);
                assert!(dot(normal, inwards) * sign > 0.0, "{centre:?}");
                area += 4.0 * dot(normal, normal).sqrt();
            }
            assert!((area - 52.0).abs() < 1e-12);
        }
    }

    #[test]
    fn flat_rectangles_face_as_asked() {
        for axis in 0..3 {
            for facing in [1.0, -1.0] {
                let Shape::Rectangle { centre, half_u, half_v } = flat(axis, 2.0, [0.0, 1.0], [3.0, 5.0], facing)
                else {
                    unreachable!()
                };
                assert!(cross(half_u, half_v)[axis] * facing > 0.0);
                assert_eq!(centre[axis], 2.0);
                assert_eq!(centre[(axis + 2) % 3], 4.0);
            }
        }
    }
}
