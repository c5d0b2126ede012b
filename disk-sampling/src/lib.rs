//! Disk lights and closed-form illuminance: `no_std`, no heap, no panic, `libm` only.
//!
//! - [`partition`]: subdivision of a disk into subsources by four methods, uniform or by size over distance.
//! - Continuous maps with densities and inverses: [`square_to_disk`] and its relatives.
//! - [`estimate`]: illuminance with any emission and visibility, by few samples, to a requested relative error.
//! - Configuration factors of disks, spheres, rectangles and polygons, clipped at the horizon:
//!   [`disk_configuration_factor`] and its relatives.
#![no_std]

mod configuration_factor;
pub mod estimate;
mod map;
pub mod partition;
mod shape;
mod vector;

pub use configuration_factor::{
    disk_configuration_factor, disk_irradiance_vector, disk_parallel_factor, disk_perpendicular_factor,
    on_axis_disk_factor, polygon_configuration_factor, polygon_irradiance_vector, rectangle_parallel_factor,
    rectangle_perpendicular_factor, sphere_configuration_factor,
};
pub use map::{
    disk_to_hexagon, disk_to_square, disk_to_square_elliptical, disk_to_square_polar, hexagon_to_disk,
    hexagon_to_disk_pdf, square_to_disk, square_to_disk_elliptical, square_to_disk_elliptical_pdf, square_to_disk_pdf,
    square_to_disk_polar, square_to_disk_polar_pdf,
};
pub use shape::{Disk, Receiver, ShapeError, Sphere};
