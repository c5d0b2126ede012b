//! Frames on surfaces: where anisotropic materials have their axes.

use glam::DVec3;

use crate::geometry::Hit;
use crate::scene::Geometry;

/// How a shape is parametrised: what its points' derivative by the first coordinate is, up to its length.
///
/// The conventions are those of Mitsuba 3, whose frames start from `dp_du`.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Parametrisation {
    /// The same direction everywhere: along the first axis of a rectangle.
    Along(DVec3),
    /// Away from the middle of a disk.
    Radial { centre: DVec3 },
    /// Along the parallels of a sphere.
    Polar { centre: DVec3, axis: DVec3 },
    /// Along the first edge of each triangle of a mesh; its first primitive.
    Edges { first: u32, edges: Vec<DVec3> },
}

impl Parametrisation {
    /// `first` is the number of the shape's first primitive in the world.
    pub(crate) fn new(geometry: &Geometry, first: u32) -> Self {
        match geometry {
            Geometry::Rectangle { half_u, .. } => Self::Along(*half_u),
            Geometry::Disk { center, .. } => Self::Radial { centre: *center },
            Geometry::Sphere { center, axis, .. } => Self::Polar { centre: *center, axis: *axis },
            Geometry::Mesh(mesh) => {
                let edge = |triangle| {
                    let [a, b, _] = mesh.corners(triangle);
                    b - a
                };
                Self::Edges { first, edges: (0..mesh.triangles.len()).map(edge).collect() }
            }
        }
    }

    /// The frame at a hit on the shape, around the shading normal on the side that was seen.
    pub(crate) fn frame(&self, hit: &Hit) -> Frame {
        let normal = hit.shading_normal.as_dvec3() * if hit.front { 1.0 } else { -1.0 };
        let position = hit.position.as_dvec3();
        let tangent = match self {
            Self::Along(direction) => *direction,
            Self::Radial { centre } => position - *centre,
            Self::Polar { centre, axis } => axis.cross(position - *centre),
            Self::Edges { first, edges } => {
                let triangle = hit.primitive.wrapping_sub(*first) as usize;
                edges.get(triangle).copied().unwrap_or_default()
            }
        };
        Frame::new(normal, tangent)
    }
}

/// Three perpendicular unit vectors: z is the normal, x the tangent.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Frame {
    x: DVec3,
    y: DVec3,
    z: DVec3,
}

impl Frame {
    /// The frame around a unit normal whose x axis is the part of `tangent` across it, or any if there is none.
    pub(crate) fn new(normal: DVec3, tangent: DVec3) -> Self {
        let along = tangent.normalize_or_zero();
        let across = along - normal * along.dot(normal);
        // What is left of a tangent along the normal is rounding.
        let x = if across.length_squared() > 1e-12 { across.normalize() } else { normal.any_orthonormal_pair().0 };
        Self { x, y: normal.cross(x), z: normal }
    }

    /// A direction of the world by its components in this frame.
    pub(crate) fn to_local(&self, direction: DVec3) -> [f64; 3] {
        [self.x, self.y, self.z].map(|axis| axis.dot(direction))
    }

    /// The direction of the world with these components.
    pub(crate) fn to_world(&self, [x, y, z]: [f64; 3]) -> DVec3 {
        self.x * x + self.y * y + self.z * z
    }
}

#[cfg(test)]
mod tests {
    use super::{Frame, Parametrisation};
    use crate::direct;
    use crate::geometry::{Hit, Ray};
    use crate::scene::{Source, load};
    use glam::{DVec3, Vec3A};

    const TURN: &str = "<rotate x='1' y='2' z='-1' angle='50'/>";

    /// The shape under a rotation, met by a ray along −z of its own frame that is off its middle by `offset`.
    fn hit(shape: &str, offset: DVec3) -> (Hit, Parametrisation) {
        let xml = format!(
            "<scene version='3.0.0'><sensor type='perspective'><float name='fov' value='40'/></sensor>
            <shape type='{shape}'><transform name='to_world'>{TURN}</transform></shape></scene>"
        );
        let scene = load(&Source::text("test.xml", xml), &[]).unwrap();
        let axis = DVec3::new(1.0, 2.0, -1.0).normalize();
        let turn = glam::DMat3::from_axis_angle(axis, 50.0_f64.to_radians());
        let (from, along) = (turn * (offset + DVec3::Z * 3.0), turn * DVec3::NEG_Z);
        let world = direct::world(&scene).unwrap();
        let hit = world.closest_hit(&Ray::new(from.as_vec3a(), along.as_vec3a())).unwrap();
        (hit, Parametrisation::new(&scene.shapes[0].geometry, 0))
    }

    #[track_caller]
    fn assert_frame(frame: &Frame, tangent: [f64; 3], normal: [f64; 3]) {
        let tangent = DVec3::from_array(tangent);
        let tangent = tangent * tangent.dot(frame.x).signum();
        let across = frame.z.cross(frame.x);
        for (found, expected) in [(frame.x, tangent), (frame.z, DVec3::from_array(normal)), (across, frame.y)] {
            let off = (found - expected).length();
            assert!(off <= 1e-6, "{found} is not {expected}");
        }
    }

    /// A place off the middle, and the tangent and normal there.
    const MITSUBA: [(&str, [f64; 3], [f64; 3], [f64; 3]); 5] = [
        ("rectangle", [0.3, 0.2, 0.0], [0.702_323, -0.193_665_5, -0.685_008_1], NORMAL),
        ("disk", [0.3, -0.2, 0.0], [0.344_844_4, -0.649_791_2, -0.677_387_5], NORMAL),
        ("sphere", [0.3, 0.2, 0.0], [-0.030_293_4, 0.840_403_7, 0.541_113_6], [0.824_929_6, -0.284_676_7, 0.488_314]),
        ("sphere", [-0.5, 0.4, 0.0], [-0.775_922_4, -0.566_908_2, 0.276_693_8], [0.256_266, 0.117_527_1, 0.959_434_9]),
        ("cube", [0.1, 0.2, 0.0], [-0.431_807_1, -0.880_929_2, -0.193_665_5], NORMAL),
    ];
    const NORMAL: [f64; 3] = [0.565_937_3, -0.431_807_1, 0.702_323];

    /// `independent`: Mitsuba 3.9.1's `sh_frame` for the same shapes and rays, in `f32`; the sign of a tangent is of no account to materials.
    #[test]
    fn frames_are_those_of_mitsuba() {
        for (shape, offset, tangent, normal) in MITSUBA {
            let (hit, parametrisation) = hit(shape, DVec3::from_array(offset));
            assert_frame(&parametrisation.frame(&hit), tangent, normal);
        }
    }

    #[test]
    fn directions_come_back_and_a_tangent_along_the_normal_does_no_harm() {
        let normal = DVec3::new(0.6, 0.0, 0.8);
        for tangent in [DVec3::X, DVec3::ZERO, normal, normal * -3.0] {
            let frame = Frame::new(normal, tangent);
            let direction = DVec3::new(0.1, -0.7, 0.4);
            let back = frame.to_world(frame.to_local(direction));
            assert!((back - direction).length() <= 4.0 * f64::EPSILON, "{tangent}");
            assert!(frame.to_local(normal)[2] >= 1.0 - 4.0 * f64::EPSILON);
        }
        let seen_from_behind = Hit { front: false, ..hit("disk", DVec3::ZERO).0 };
        let frame = Parametrisation::Along(DVec3::X).frame(&seen_from_behind);
        assert_eq!(frame.z.as_vec3a(), -seen_from_behind.geometric_normal);
        assert_ne!(frame.x.as_vec3a(), Vec3A::ZERO);
    }
}
