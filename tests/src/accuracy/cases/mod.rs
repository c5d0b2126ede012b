//! The functions' domains and oracles, by subject.

pub mod albedo;
pub mod colour;
pub mod components;
pub mod disks;
pub mod elementary;
pub mod factors;
pub mod intervals;
pub mod lights;
pub mod maps;
pub mod optics;
pub mod reflectance;
pub mod spectra;
