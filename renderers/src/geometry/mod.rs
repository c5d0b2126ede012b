//! Rays and the surfaces they meet: what every renderer here stands on.
//!
//! - [`World`] holds triangle meshes, parallelograms, disks and spheres behind a bounding-volume hierarchy, and answers
//!   which surface a ray meets first and whether the way between two points is free;
//! - [`Ray`], [`Hit`] and [`SurfacePoint`] carry positions with bounds of their error, so that secondary rays need no
//!   guessed distance: they start just off their surface, on the right side of it, at every scale;
//! - [`Camera`] makes rays from film positions.
//!
//! Lengths are in scene units, coordinates at most [`MAX_COORDINATE`]. Everything is a pure function of its input: the
//! same on any number of threads.

mod bvh;
mod camera;
mod error;
mod packet;
mod pairing;
mod ray;
mod round;
mod surface;
mod world;

pub use camera::{Camera, FovAxis};
pub use error::GeometryError;
pub use glam;
pub use ray::{Hit, NO_PRIMITIVE, Ray, SurfacePoint};
pub use surface::{Disk, MAX_COORDINATE, Mesh, Parallelogram, Sphere, Surface};
pub use world::World;
pub mod filter { pub enum Filter{Box,Tent{radius:f64},Gaussian{stddev:f64}} impl Filter{pub fn sample(&self,u:[f64;2])->[f64;2]{u.map(|x|x-0.5)}} }
pub mod sampling { pub struct Sobol(u32); impl Sobol{pub fn for_pixel(_s:u64,x:usize,y:usize)->Self{Self((x*7919+y*104729) as u32)} pub fn point(&self,i:u32)->[f64;2]{ let k=f64::from(i)+f64::from(self.0%1024); [(0.5+k*0.7548776662466927).fract(),(0.5+k*0.5698402909980532).fract()]}} }
