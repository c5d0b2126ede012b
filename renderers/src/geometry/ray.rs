//! Rays, hits, and the points between which light is carried.

use glam::Vec3A;

/// The number that stands for "no primitive" in [`Ray::exclude`] and [`SurfacePoint::primitive`].
pub const NO_PRIMITIVE: u32 = u32::MAX;

/// A half-line or segment `origin + t·direction`, 0 ≤ t < `t_max`; t is in units of the direction's length.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// Where it starts.
    pub origin: Vec3A,
    /// Where it goes; of any length but zero.
    pub direction: Vec3A,
    /// Where it ends; infinite for a half-line.
    pub t_max: f32,
    /// Planar primitives that it can't hit, because it starts or ends on them; [`NO_PRIMITIVE`] for none.
    pub exclude: [u32; 2],
}

impl Ray {
    /// The half-line from `origin` along `direction`.
    #[must_use]
    pub const fn new(origin: Vec3A, direction: Vec3A) -> Self {
        Self { origin, direction, t_max: f32::INFINITY, exclude: [NO_PRIMITIVE; 2] }
    }

    /// The point at parameter `t`, in scene units.
    #[must_use]
    pub fn at(&self, t: f32) -> Vec3A {
        self.origin + self.direction * t
    }
}

/// A point on a surface from which, or to which, rays go.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfacePoint {
    /// The position, in scene units.
    pub position: Vec3A,
    /// A bound of the position's error along each axis, in scene units.
    pub error: f32,
    /// The unit geometric normal.
    pub normal: Vec3A,
    /// The primitive that it is on, if it is planar, so that no ray from here can hit it again; otherwise
    /// [`NO_PRIMITIVE`].
    pub primitive: u32,
}

impl SurfacePoint {
    /// A point given by a few `f32` operations on coordinates of the size of its own (a point sampled on a light, say):
    /// the error is taken as 8 units in the last place of its largest coordinate.
    #[must_use]
    pub fn new(position: Vec3A, normal: Vec3A) -> Self {
        let error = 8.0 * f32::EPSILON * position.abs().max_element();
        Self { position, error, normal, primitive: NO_PRIMITIVE }
    }

    /// The same point, known to be on the planar primitive with this index.
    #[must_use]
    pub const fn on(mut self, primitive: u32) -> Self {
        self.primitive = primitive;
        self
    }

    /// The point moved off the surface to the side where `direction` points, by no more than the error bound and one
    /// unit in the last place (Pharr, Jakob & Humphreys, *Physically Based Rendering*, 4th ed., section 6.8.6).
    #[must_use]
    pub fn offset(&self, direction: Vec3A) -> Vec3A {
        self.offset_by(direction, self.error)
    }

    fn offset_by(&self, direction: Vec3A, error: f32) -> Vec3A {
        let distance = error * self.normal.abs().element_sum() + f32::MIN_POSITIVE;
        let side = if direction.dot(self.normal) < 0.0 { -distance } else { distance };
        let step = self.normal * side;
        let moved = self.position + step;
        let away = |x: f32, s: f32| {
            if s > 0.0 {
                x.next_up()
            } else if s < 0.0 {
                x.next_down()
            } else {
                x
            }
        };
        Vec3A::new(away(moved.x, step.x), away(moved.y, step.y), away(moved.z, step.z))
    }

    /// The ray that leaves the surface along `direction`.
    #[must_use]
    pub fn ray(&self, direction: Vec3A) -> Ray {
        Ray {
            exclude: [self.primitive, NO_PRIMITIVE],
            ..Ray::new(self.offset(direction), direction)
        }
    }

    /// The segment to a point that is on no surface, such as a point light.
    #[must_use]
    pub fn ray_to(&self, target: Vec3A) -> Ray {
        let origin = self.offset(target - self.position);
        Ray {
            t_max: 1.0,
            exclude: [self.primitive, NO_PRIMITIVE],
            ..Ray::new(origin, target - origin)
        }
    }

    /// The segment to a point of another surface (or the same), which ends just before that surface: neither blocks it.
    #[must_use]
    pub fn ray_between(&self, target: &Self) -> Ray {
        let towards = target.position - self.position;
        let origin = self.offset(towards);
        // The rounding of the direction moves the end of the segment by as much as the rounding of its coordinates.
        let end =
            target.offset_by(-towards, target.error + f32::EPSILON * towards.abs().max_element());
        Ray {
            t_max: 1.0,
            exclude: [self.primitive, target.primitive],
            ..Ray::new(origin, end - origin)
        }
    }
}

/// Where a ray meets a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Ray parameter, in units of the ray direction's length, computed in `f64`.
    pub t: f32,
    /// Index of the primitive, in the order of the surfaces given to [`World::new`](super::World::new).
    pub primitive: u32,
    /// The identifier given with the surface.
    pub shape: u32,
    /// The position in scene units, on the surface to within [`error`](Self::error): not origin + t·direction.
    pub position: Vec3A,
    /// A bound of the position's error along each axis, in scene units.
    pub error: f32,
    /// The unit normal of the surface as it is oriented, whichever side the ray comes from.
    pub geometric_normal: Vec3A,
    /// The unit interpolated normal of a mesh that has vertex normals; otherwise the geometric normal.
    pub shading_normal: Vec3A,
    /// Triangle: the barycentric weights of its second and third vertex. Parallelogram: its own u and v. Disk: radius
    /// and azimuth/2π. Sphere: azimuth/2π and polar angle/π. All in [0, 1].
    pub uv: [f32; 2],
    /// Whether the ray comes from the side that the geometric normal points to.
    pub front: bool,
    /// Whether the primitive is planar, so that a ray from here can't hit it again.
    pub planar: bool,
}

impl Hit {
    /// The point as one that rays leave from.
    #[must_use]
    pub fn point(&self) -> SurfacePoint {
        let primitive = if self.planar { self.primitive } else { NO_PRIMITIVE };
        SurfacePoint {
            position: self.position,
            error: self.error,
            normal: self.geometric_normal,
            primitive,
        }
    }

    /// The geometric normal turned to the side that the ray came from.
    #[must_use]
    pub fn facing_normal(&self) -> Vec3A {
        if self.front { self.geometric_normal } else { -self.geometric_normal }
    }
}
