//! Configuration factors in closed form.

use disk_sampling::{
    Disk, Receiver, Sphere, disk_configuration_factor, polygon_configuration_factor, rectangle_parallel_factor,
    rectangle_perpendicular_factor, sphere_configuration_factor,
};
use spectral_core::Real;

use crate::SpectralStatus;
use crate::boundary::{Outcome, Output, finite, read, representable, slice, within};

/// A flat circular light of uniform radiance that shines on the side of its normal. All lengths in one unit.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct SpectralDisk<R> {
    /// The centre.
    pub centre: [R; 3],
    /// The normal, of any length but zero.
    pub normal: [R; 3],
    /// The radius, above 0.
    pub radius: R,
}

/// A spherical light of uniform radiance.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct SpectralSphere<R> {
    /// The centre.
    pub centre: [R; 3],
    /// The radius, above 0.
    pub radius: R,
}

/// A surface element that light falls on.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct SpectralReceiver<R> {
    /// Where it is.
    pub position: [R; 3],
    /// Its normal, of any length but zero.
    pub normal: [R; 3],
}

/// The most corners of a polygon.
pub const SPECTRAL_MOST_CORNERS: usize = 1 << 16;

pub(crate) unsafe fn shape<R: Real>(pointer: *const SpectralDisk<R>) -> Outcome<Disk<R>> {
    let SpectralDisk { centre, normal, radius } = read(pointer)?;
    finite(&[radius])?;
    Ok(Disk::new(centre, normal, radius)?)
}

pub(crate) unsafe fn element<R: Real>(pointer: *const SpectralReceiver<R>) -> Outcome<Receiver<R>> {
    let SpectralReceiver { position, normal } = read(pointer)?;
    Ok(Receiver::new(position, normal)?)
}

unsafe fn disk<R: Real>(
    light: *const SpectralDisk<R>,
    receiver: *const SpectralReceiver<R>,
    factor: *mut R,
) -> Outcome {
    let output = Output::at(factor)?;
    let result = disk_configuration_factor(&shape(light)?, &element(receiver)?);
    representable(&[result])?;
    output.put(result)
}

unsafe fn sphere<R: Real>(
    light: *const SpectralSphere<R>,
    receiver: *const SpectralReceiver<R>,
    factor: *mut R,
) -> Outcome {
    let output = Output::at(factor)?;
    let SpectralSphere { centre, radius } = read(light)?;
    finite(&[radius])?;
    let result = sphere_configuration_factor(&Sphere::new(centre, radius)?, &element(receiver)?);
    representable(&[result])?;
    output.put(result)
}

unsafe fn polygon<R: Real>(
    corners: *const R,
    count: usize,
    receiver: *const SpectralReceiver<R>,
    factor: *mut R,
) -> Outcome {
    let output = Output::at(factor)?;
    if !(3..=SPECTRAL_MOST_CORNERS).contains(&count) {
        return Err(SpectralStatus::Length);
    }
    let corners = slice(corners.cast::<[R; 3]>(), count)?;
    finite(corners.as_flattened())?;
    let receiver = element(receiver)?;
    let result = polygon_configuration_factor(receiver.position(), receiver.normal(), corners);
    representable(&[result])?;
    output.put(result)
}

unsafe fn rectangle<R: Real>(sides: [R; 3], factor: *mut R, of: fn(R, R, R) -> R) -> Outcome {
    let output = Output::at(factor)?;
    finite(&sides)?;
    let [a, b, h] = sides;
    within(h >= R::ZERO && sides.iter().any(|&side| side != R::ZERO))?;
    let result = of(a, b, h);
    representable(&[result])?;
    output.put(result)
}

unsafe fn parallel<R: Real>(a: R, b: R, h: R, factor: *mut R) -> Outcome {
    rectangle([a, b, h], factor, rectangle_parallel_factor)
}

unsafe fn perpendicular<R: Real>(a: R, b: R, h: R, factor: *mut R) -> Outcome {
    rectangle([a, b, h], factor, rectangle_perpendicular_factor)
}

macro_rules! exports {
    ($R:ident) => {
        pastey::paste! { mod [<exports_ $R>] {
            use super::*;
            use crate::boundary::export;

            export! {
                /// The configuration factor from a receiver to a disk, clipped at the receiver's horizon: times the light's luminous
                /// exitance in lm/m² (π times its luminance), the illuminance in lx.
                ///
                /// Relative accuracy 1e-12 (f32: 1e-5). 0 behind the disk, and in its plane outside the rim.
                ///
                /// @return NULL, MISALIGNED, NOT_FINITE; RANGE for a radius that is not positive or a normal of zero length
                [<spectral_disk_factor_ $R>] = disk(
                    light: *const SpectralDisk<$R>,
                    receiver: *const SpectralReceiver<$R>,
                    factor: *mut $R,
                );

                /// The configuration factor from a receiver to a sphere, clipped at the receiver's horizon; 1 inside the sphere.
                ///
                /// @return as spectral_disk_factor
                [<spectral_sphere_factor_ $R>] = sphere(
                    light: *const SpectralSphere<$R>,
                    receiver: *const SpectralReceiver<$R>,
                    factor: *mut $R,
                );

                /// The configuration factor from a receiver to a planar convex polygon that shines on both sides, clipped at the receiver's horizon.
                ///
                /// @param corners x, y, z of each corner, 3 · `count` numbers, around the polygon either way
                /// @param count 3 to SPECTRAL_MOST_CORNERS
                /// @return NULL, MISALIGNED, LENGTH, NOT_FINITE; RANGE for a normal of zero length
                [<spectral_polygon_factor_ $R>] = polygon(
                    corners: *const $R,
                    count: usize,
                    receiver: *const SpectralReceiver<$R>,
                    factor: *mut $R,
                );

                /// The configuration factor from an element to a parallel rectangle `a` × `b` at distance `h` that has a corner on the
                /// element's normal. Odd in `a` and in `b`, so that rectangles anywhere are sums of four.
                ///
                /// @return NULL, MISALIGNED, NOT_FINITE; RANGE for `h` below 0, or all of them 0
                [<spectral_rectangle_parallel_factor_ $R>] = parallel(a: $R, b: $R, h: $R, factor: *mut $R);

                /// The configuration factor from an element to a rectangle in a perpendicular plane at distance `h`, `a` high and `b` wide,
                /// that has a corner on the element's horizon, straight in front of it. Even in `a`, odd in `b`.
                ///
                /// @return as spectral_rectangle_parallel_factor
                [<spectral_rectangle_perpendicular_factor_ $R>] = perpendicular(a: $R, b: $R, h: $R, factor: *mut $R);
            }
        } pub use [<exports_ $R>]::*; }
    };
}
exports!(f32);
exports!(f64);
