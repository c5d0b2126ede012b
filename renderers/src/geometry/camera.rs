//! A perspective camera with the conventions of Mitsuba 3.

use glam::{DAffine3, DVec3, Vec3A};

use super::GeometryError;
use super::ray::Ray;

/// How far the camera's axes may be from perpendicular unit vectors.
const RIGIDITY: f64 = 1e-3;

/// Which extent of the image the field of view spans.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum FovAxis {
    /// The width.
    #[default]
    X,
    /// The height.
    Y,
    /// The diagonal.
    Diagonal,
    /// The width or the height, whichever is smaller.
    Smaller,
    /// The width or the height, whichever is larger.
    Larger,
}

/// A pinhole camera: it looks along its +z, its +y is up in the image and its +x is *left* in the image.
///
/// Positions on the film are in pixels: (0, 0) is the top left corner of the image, (width, height) the bottom right
/// one. Rays start at the pinhole: there is no near plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    origin: DVec3,
    /// Directions, at unit distance along the axis, of the top left corner, and of a step of one pixel.
    corner: DVec3,
    step_x: DVec3,
    step_y: DVec3,
    axes: [DVec3; 3],
    half_width: f64,
    size: [u32; 2],
}

impl Camera {
    /// A camera with the camera-to-world transform, the field of view in degrees along `axis`, and the image size in
    /// pixels.
    ///
    /// # Errors
    /// [`BadImageSize`](GeometryError::BadImageSize), [`BadFieldOfView`](GeometryError::BadFieldOfView) or, where the
    /// linear part is not a rotation or a mirrored rotation to within 10⁻³,
    /// [`BadCameraTransform`](GeometryError::BadCameraTransform).
    pub fn new(
        to_world: &DAffine3,
        fov_degrees: f64,
        axis: FovAxis,
        width: u32,
        height: u32,
    ) -> Result<Self, GeometryError> {
        const MOST_PIXELS: u32 = 1 << 24;
        if !(1..=MOST_PIXELS).contains(&width) || !(1..=MOST_PIXELS).contains(&height) {
            return Err(GeometryError::BadImageSize);
        }
        if !(fov_degrees > 0.0 && fov_degrees < 180.0) {
            return Err(GeometryError::BadFieldOfView);
        }
        let m = to_world.matrix3;
        let deviation = m.transpose() * m - glam::DMat3::IDENTITY;
        let rigid = deviation.to_cols_array().iter().all(|x| x.abs() <= RIGIDITY);
        if !(rigid && to_world.translation.is_finite()) {
            return Err(GeometryError::BadCameraTransform);
        }
        let (columns, rows) = (f64::from(width), f64::from(height));
        let half_width = half_width(fov_degrees.to_radians() / 2.0, axis, columns / rows);
        let axes = [m.x_axis, m.y_axis, m.z_axis];
        let pixel = 2.0 * half_width / columns;
        let (step_x, step_y) = (axes[0] * -pixel, axes[1] * -pixel);
        let corner = axes[2] - (step_x * columns + step_y * rows) / 2.0;
        Ok(Self {
            origin: to_world.translation,
            corner,
            step_x,
            step_y,
            axes,
            half_width,
            size: [width, height],
        })
    }

    /// The image size in pixels, width and height.
    #[must_use]
    pub const fn size(&self) -> [u32; 2] {
        self.size
    }

    /// The position of the pinhole, in scene units.
    #[must_use]
    pub fn position(&self) -> Vec3A {
        self.origin.as_vec3a()
    }

    /// The ray, with a direction of unit length, through a continuous film position in pixels.
    #[inline]
    #[must_use]
    pub fn ray(&self, x: f32, y: f32) -> Ray {
        let direction = self.corner + self.step_x * f64::from(x) + self.step_y * f64::from(y);
        Ray::new(self.origin.as_vec3a(), direction.normalize().as_vec3a())
    }

    /// The film position in pixels where a point in front of the camera is seen, inside the image or not; `None` for a
    /// point that is not in front.
    #[must_use]
    #[allow(clippy::cast_possible_truncation, reason = "film positions are f32")]
    pub fn project(&self, point: Vec3A) -> Option<[f32; 2]> {
        let offset = point.as_dvec3() - self.origin;
        let [x, y, z] = self.axes.map(|axis| axis.dot(offset));
        let scale = f64::from(self.size[0]) / (2.0 * self.half_width);
        let [column, row] =
            [(self.size[0], x), (self.size[1], y)].map(|(n, c)| f64::from(n) / 2.0 - c / z * scale);
        (z > 0.0).then_some([column as f32, row as f32])
    }
}

/// Half the width of the image at unit distance, from half the field of view in radians.
fn half_width(half_fov: f64, axis: FovAxis, aspect: f64) -> f64 {
    let tangent = half_fov.tan();
    let from_height = tangent * aspect;
    match axis {
        FovAxis::X => tangent,
        FovAxis::Y => from_height,
        FovAxis::Diagonal => tangent * aspect / aspect.hypot(1.0),
        FovAxis::Smaller => tangent.max(from_height),
        FovAxis::Larger => tangent.min(from_height),
    }
}
