//! The functions' domains and oracles, by subject.

pub mod action;
pub mod adaptation;
pub mod albedo;
pub mod bilinear;
pub mod colour;
pub mod disks;
pub mod elementary;
pub mod factors;
pub mod fidelity;
pub mod intervals;
pub mod lights;
pub mod maps;
pub mod optics;
pub mod prefilter;
pub mod reflectance;
pub mod rendering;
pub mod spectra;
pub mod upsampling;
