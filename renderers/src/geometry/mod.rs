//! Rays and the surfaces they meet: what every renderer here stands on.
//!
//! - [`World`] holds triangle meshes, parallelograms, disks and spheres behind a bounding-volume hierarchy, and answers
//!   which surface a ray meets first and whether the way between two points is free;
//! - [`Ray`], [`Hit`] and [`SurfacePoint`] carry positions with bounds of their error, so that secondary rays need no
//!   guessed distance: they start just off their surface, on the right side of it, at every scale;
//! - [`Shaft`] holds all ways between two surfaces: the world can tell for certain that nothing blocks any of them;
//! - [`Camera`] makes rays from film positions, and [`Filter`] moves those about the pixel;
//! - [`sampling`] has the points, and the maps to lights and directions.
//!
//! Lengths are in scene units, coordinates at most [`MAX_COORDINATE`]. Everything is a pure function of its input: the
//! same on any number of threads.

mod bvh;
mod camera;
mod error;
mod filter;
mod packet;
mod pairing;
mod ray;
mod round;
pub mod sampling;
mod shaft;
mod surface;
mod world;

pub use camera::{Camera, FovAxis};
pub use error::GeometryError;
pub use filter::Filter;
pub use glam;
pub use ray::{Hit, NO_PRIMITIVE, Ray, SurfacePoint};
pub use shaft::{Shaft, ShaftEnd};
pub use surface::{Disk, MAX_COORDINATE, Mesh, Parallelogram, Sphere, Surface};
pub use world::World;
