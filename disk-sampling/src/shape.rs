//! What shines and what receives: [`Disk`], [`Sphere`], [`Receiver`].

use core::fmt;

use spectral_core::Real;

use crate::vector::{Vector, dot, normalized, perpendicular_frame, scale, subtract};

/// Why a disk, a sphere or a receiver was refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum ShapeError {
    /// A coordinate is infinite or NaN.
    NotFinite,
    /// A normal has no direction: all its components are zero.
    ZeroNormal,
    /// A radius is zero, negative, infinite or NaN.
    Radius,
}

impl fmt::Display for ShapeError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::NotFinite => "a coordinate is infinite or not a number",
            Self::ZeroNormal => "the normal is zero",
            Self::Radius => "the radius is not positive and finite",
        })
    }
}

impl core::error::Error for ShapeError {}

/// A flat circular light of uniform radiance that shines on the side of its normal. All lengths in one unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Disk<R> {
    centre: Vector<R>,
    normal: Vector<R>,
    radius: R,
    frame: [Vector<R>; 2],
}

impl<R: Real> Disk<R> {
    /// A disk by its centre, a normal of any length but zero, and its radius.
    ///
    /// # Errors
    /// [`ShapeError`] for coordinates that are not finite, a zero normal, or a radius that is not positive and finite.
    pub fn new(centre: [R; 3], normal: [R; 3], radius: R) -> Result<Self, ShapeError> {
        let normal = checked_normal(centre, normal)?;
        if !(radius > R::ZERO && radius.is_finite()) {
            return Err(ShapeError::Radius);
        }
        Ok(Self { centre, normal, radius, frame: perpendicular_frame(normal) })
    }

    /// The centre.
    pub const fn centre(&self) -> [R; 3] {
        self.centre
    }

    /// The unit normal on the side that shines.
    pub const fn normal(&self) -> [R; 3] {
        self.normal
    }

    /// The radius.
    pub const fn radius(&self) -> R {
        self.radius
    }

    /// The point at (`x`, `y`) of the unit disk: centre + radius · (x u + y v), with [`frame`](Self::frame)'s u and v.
    pub fn point(&self, [x, y]: [R; 2]) -> [R; 3] {
        let [u, v] = self.frame;
        core::array::from_fn(|i| self.centre[i] + self.radius * (x * u[i] + y * v[i]))
    }

    /// The inverse of [`point`](Self::point), with the height over the disk on the side that shines as third
    /// coordinate, all in radii.
    ///
    /// A point too far away for that to be a number gives an infinite coordinate.
    pub fn local(&self, point: [R; 3]) -> [R; 3] {
        let away = subtract(point, self.centre);
        // Halves can be subtracted where the whole overflows.
        let (away, unit) = if away.iter().all(|x| x.is_finite()) {
            (away, self.radius)
        } else {
            let half = |x: [R; 3]| scale(x, R::HALF);
            (subtract(half(point), half(self.centre)), self.radius * R::HALF)
        };
        self.direction(away).map(|x| x / unit)
    }

    /// A direction's components along u, v and the normal.
    pub fn direction(&self, direction: [R; 3]) -> [R; 3] {
        [self.frame[0], self.frame[1], self.normal].map(|axis| dot(axis, direction))
    }

    /// Two unit vectors u, v in the disk's plane with u × v = normal; they depend on the normal alone.
    pub const fn frame(&self) -> [[R; 3]; 2] {
        self.frame
    }
}

/// A spherical light of uniform radiance. All lengths in one unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sphere<R> {
    centre: Vector<R>,
    radius: R,
}

impl<R: Real> Sphere<R> {
    /// A sphere by its centre and radius.
    ///
    /// # Errors
    /// [`ShapeError`] for a centre that is not finite or a radius that is not positive and finite.
    pub fn new(centre: [R; 3], radius: R) -> Result<Self, ShapeError> {
        if !centre.iter().all(|x| x.is_finite()) {
            return Err(ShapeError::NotFinite);
        }
        if !(radius > R::ZERO && radius.is_finite()) {
            return Err(ShapeError::Radius);
        }
        Ok(Self { centre, radius })
    }

    /// The centre.
    pub const fn centre(&self) -> [R; 3] {
        self.centre
    }

    /// The radius.
    pub const fn radius(&self) -> R {
        self.radius
    }
}

/// A surface element that receives light on the side of its normal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Receiver<R> {
    position: Vector<R>,
    normal: Vector<R>,
}

impl<R: Real> Receiver<R> {
    /// A surface element by its position and a normal of any length but zero.
    ///
    /// # Errors
    /// [`ShapeError`] for coordinates that are not finite or a zero normal.
    pub fn new(position: [R; 3], normal: [R; 3]) -> Result<Self, ShapeError> {
        Ok(Self { position, normal: checked_normal(position, normal)? })
    }

    /// Where it is.
    pub const fn position(&self) -> [R; 3] {
        self.position
    }

    /// The unit normal on the side that receives.
    pub const fn normal(&self) -> [R; 3] {
        self.normal
    }
}

fn checked_normal<R: Real>(position: Vector<R>, normal: Vector<R>) -> Result<Vector<R>, ShapeError> {
    if !position.iter().chain(&normal).all(|x| x.is_finite()) {
        return Err(ShapeError::NotFinite);
    }
    normalized(normal).ok_or(ShapeError::ZeroNormal)
}
