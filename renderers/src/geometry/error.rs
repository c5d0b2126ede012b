//! What the geometry kernel refuses.

use core::fmt;

/// Why a surface, a world or a camera was refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum GeometryError {
    /// A coordinate of surface `surface` is NaN, infinite or beyond ±[`MAX_COORDINATE`](super::MAX_COORDINATE).
    BadCoordinate {
        /// Index of the surface in the list given to [`World::new`](super::World::new).
        surface: usize,
        /// Index of the triangle or vertex in its mesh; 0 for other surfaces.
        element: usize,
    },
    /// A triangle, parallelogram, disk or sphere has no area.
    ZeroArea {
        /// Index of the surface in the list given to [`World::new`](super::World::new).
        surface: usize,
        /// Index of the triangle in its mesh; 0 for other surfaces.
        element: usize,
    },
    /// A triangle names a vertex that its mesh doesn't have.
    BadIndex {
        /// Index of the surface in the list given to [`World::new`](super::World::new).
        surface: usize,
        /// Index of the triangle in its mesh.
        element: usize,
    },
    /// A mesh has vertex normals, but not one for each vertex, or one that is zero or not finite.
    BadNormals {
        /// Index of the surface in the list given to [`World::new`](super::World::new).
        surface: usize,
        /// Index of the vertex at fault; the number of normals when that is what is wrong.
        element: usize,
    },
    /// There are more primitives than a `u32` can number (2³¹ are allowed).
    TooManyPrimitives,
    /// The image has no pixels, or more than 2²⁴ in a row or column.
    BadImageSize,
    /// The field of view is not inside (0°, 180°).
    BadFieldOfView,
    /// The camera-to-world transform is not finite, or its linear part is not made of perpendicular unit vectors.
    BadCameraTransform,
    /// The width of a reconstruction filter is not positive and finite.
    BadFilterWidth,
    /// [`World::validate`](super::World::validate) found that the hierarchy and the primitives disagree.
    BrokenHierarchy,
}

impl fmt::Display for GeometryError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::BadCoordinate { surface, element } => {
                write!(f, "surface {surface}, element {element}: a coordinate is not finite or too large")
            }
            Self::ZeroArea { surface, element } => {
                write!(f, "surface {surface}, element {element}: the area is zero")
            }
            Self::BadIndex { surface, element } => {
                write!(f, "surface {surface}, triangle {element}: no such vertex")
            }
            Self::BadNormals { surface, element } => {
                write!(f, "surface {surface}, vertex {element}: the vertex normal is missing, zero or not finite")
            }
            Self::TooManyPrimitives => write!(f, "there are more than 2^31 primitives"),
            Self::BadImageSize => {
                write!(f, "the image must have 1 to 2^24 pixels in each direction")
            }
            Self::BadFieldOfView => {
                write!(f, "the field of view must be between 0 and 180 degrees")
            }
            Self::BadCameraTransform => {
                write!(f, "the camera transform must be a rigid motion or a mirrored one")
            }
            Self::BadFilterWidth => {
                write!(f, "the width of a reconstruction filter must be positive and finite")
            }
            Self::BrokenHierarchy => {
                write!(f, "the bounding-volume hierarchy does not match its primitives")
            }
        }
    }
}

impl core::error::Error for GeometryError {}
