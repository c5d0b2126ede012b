//! Disk lights and closed-form illuminance: `no_std`, no heap, no panic, `libm` only.
//!
//! What is here: the configuration factor of polygonal lights ([`polygon_configuration_factor`]) and the area-preserving map of the
//! square to the disk ([`square_to_disk`]). Adaptive subdivision of disks and the closed forms of disks and spheres are to come.
#![no_std]
extern crate std;

mod configuration_factor;
mod map;
mod shape;
mod vector;

pub use configuration_factor::{
    disk_configuration_factor, disk_irradiance_vector, polygon_configuration_factor, sphere_configuration_factor,
};
pub use map::{disk_to_square, square_to_disk};
pub use shape::{Disk, Receiver, ShapeError, Sphere};
