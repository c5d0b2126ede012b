//! Continuous maps between the unit square, the hexagon and the unit disk: each with its density and its inverse.
//!
//! Square means [0, 1]², disk means the unit disk; a pdf is per unit area of the unit disk, at a point of it, and 0
//! outside.

mod concentric;
mod elliptical;
mod hexagonal;
mod polar;

pub use concentric::{disk_to_square, square_to_disk, square_to_disk_pdf};
pub use elliptical::{disk_to_square_elliptical, square_to_disk_elliptical, square_to_disk_elliptical_pdf};
pub(crate) use hexagonal::{HEXAGON_SIDE, triangle_to_disk, triangle_to_hexagon};
pub use hexagonal::{disk_to_hexagon, hexagon_to_disk, hexagon_to_disk_pdf};
pub use polar::{disk_to_square_polar, square_to_disk_polar, square_to_disk_polar_pdf};

use spectral_core::Real;

/// 1/π inside the unit disk, rim included; 0 outside.
fn uniform_pdf<R: Real>([x, y]: [R; 2]) -> R {
    if x.hypot(y) <= R::ONE + R::TWO * R::EPSILON { R::ONE / R::PI } else { R::ZERO }
}
