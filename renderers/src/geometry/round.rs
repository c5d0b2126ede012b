//! Disks and spheres, intersected in `f64`: the rounding of the given `f32` numbers is all that is left of the error.

use glam::{DVec3, Vec3A};

use super::ray::Ray;
use super::surface::{Disk, Sphere};

/// A surface that is not made of triangles.
#[derive(Clone, Copy, Debug)]
pub(super) enum Round {
    Disk(DiskFrame),
    Sphere(Sphere),
}

/// A disk with what its intersection needs.
#[derive(Clone, Copy, Debug)]
pub(super) struct DiskFrame {
    centre: DVec3,
    axes: [DVec3; 2],
    /// Dual vectors: the coordinates of a point are their products with its offset from the centre.
    duals: [DVec3; 2],
    normal: DVec3,
}

/// A round surface met by a ray: position, unit normal as oriented, and its two coordinates.
#[derive(Clone, Copy, Debug)]
pub(super) struct RoundHit {
    pub(super) position: DVec3,
    pub(super) normal: DVec3,
    pub(super) uv: [f64; 2],
}

impl DiskFrame {
    pub(super) fn new(disk: &Disk) -> Self {
        let axes = [disk.axis_u.as_dvec3(), disk.axis_v.as_dvec3()];
        let normal = axes[0].cross(axes[1]);
        let scale = 1.0 / normal.length_squared();
        let duals = [axes[1].cross(normal) * scale, normal.cross(axes[0]) * scale];
        Self { centre: disk.centre.as_dvec3(), axes, duals, normal: normal.normalize() }
    }

    fn coordinates(&self, offset: DVec3) -> [f64; 2] {
        self.duals.map(|dual| dual.dot(offset))
    }

    #[inline]
    fn distance(&self, ray: &Ray, t_max: f32) -> Option<f64> {
        let (origin, direction) = (ray.origin.as_dvec3() - self.centre, ray.direction.as_dvec3());
        let (height, slope) = (self.normal.dot(origin), self.normal.dot(direction));
        let t = -height / slope;
        // As for triangles, a ray that starts on the plane meets it only if it enters through the front.
        let within = t > 0.0 || (t == 0.0 && slope < 0.0);
        let [a, b] = self.coordinates(origin + direction * t);
        (within && t < f64::from(t_max) && a * a + b * b <= 1.0).then_some(t)
    }

    fn hit(&self, ray: &Ray, t: f64) -> RoundHit {
        let [a, b] = self.coordinates(ray.origin.as_dvec3() - self.centre + ray.direction.as_dvec3() * t);
        let position = self.centre + self.axes[0] * a + self.axes[1] * b;
        RoundHit { position, normal: self.normal, uv: [a.hypot(b).min(1.0), turn(b, a)] }
    }
}

/// The azimuth of (x, y) in turns, in [0, 1).
fn turn(y: f64, x: f64) -> f64 {
    let turns = y.atan2(x) / core::f64::consts::TAU;
    if turns < 0.0 { (turns + 1.0).min(1.0 - f64::EPSILON) } else { turns }
}

/// The nearest ray parameter in 0 < t < `t_max`. A ray that starts on the sphere doesn't meet it there again.
#[inline]
fn sphere_distance(sphere: &Sphere, ray: &Ray, t_max: f32) -> Option<f64> {
    let radius = f64::from(sphere.radius);
    let direction = ray.direction.as_dvec3();
    let offset = ray.origin.as_dvec3() - sphere.centre.as_dvec3();
    let a = direction.length_squared();
    let half_b = -offset.dot(direction);
    // The foot of the perpendicular from the centre: its distance from the centre decides, without cancellation.
    let foot = offset + direction * (half_b / a);
    let discriminant = radius * radius - foot.length_squared();
    if discriminant < 0.0 || discriminant.is_nan() {
        return None;
    }
    let power = (offset.length() - radius) * (offset.length() + radius);
    let q = half_b + (a * discriminant).sqrt().copysign(half_b);
    let (t1, t2) = if q == 0.0 { (0.0, 0.0) } else { (power / q, q / a) };
    let in_range = |t: f64| t > 0.0 && t < f64::from(t_max);
    let (near, far) = (t1.min(t2), t1.max(t2));
    [near, far].into_iter().find(|t| in_range(*t))
}

fn sphere_hit(sphere: &Sphere, ray: &Ray, t: f64) -> RoundHit {
    let centre = sphere.centre.as_dvec3();
    let outward = (ray.origin.as_dvec3() - centre + ray.direction.as_dvec3() * t).normalize_or(DVec3::Z);
    let normal = if sphere.inward { -outward } else { outward };
    let polar = outward.truncate().length().atan2(outward.z) / core::f64::consts::PI;
    let uv = [turn(outward.y, outward.x), polar];
    RoundHit { position: centre + outward * f64::from(sphere.radius), normal, uv }
}

impl Round {
    /// The nearest ray parameter in 0 ≤ t < `t_max`.
    #[inline]
    pub(super) fn distance(&self, ray: &Ray, t_max: f32) -> Option<f64> {
        match self {
            Self::Disk(disk) => disk.distance(ray, t_max),
            Self::Sphere(sphere) => sphere_distance(sphere, ray, t_max),
        }
    }

    /// The hit at a parameter found by [`distance`](Self::distance).
    pub(super) fn hit(&self, ray: &Ray, t: f64) -> RoundHit {
        match self {
            Self::Disk(disk) => disk.hit(ray, t),
            Self::Sphere(sphere) => sphere_hit(sphere, ray, t),
        }
    }

    /// The axis-aligned box, with a relative margin far above the rounding of its computation.
    pub(super) fn bounds(&self) -> [Vec3A; 2] {
        let (centre, half) = match self {
            Self::Disk(disk) => (disk.centre, (disk.axes[0].powf(2.0) + disk.axes[1].powf(2.0)).powf(0.5)),
            Self::Sphere(sphere) => (sphere.centre.as_dvec3(), DVec3::splat(f64::from(sphere.radius))),
        };
        let half = half * (1.0 + 1e-12);
        let (low, high) = ((centre - half).as_vec3a(), (centre + half).as_vec3a());
        let down = Vec3A::new(low.x.next_down(), low.y.next_down(), low.z.next_down());
        let up = Vec3A::new(high.x.next_up(), high.y.next_up(), high.z.next_up());
        [down, up]
    }

    /// The largest x·`normal` of its points.
    pub(super) fn furthest(&self, normal: DVec3) -> f64 {
        match self {
            Self::Disk(disk) => disk.centre.dot(normal) + disk.axes[0].dot(normal).hypot(disk.axes[1].dot(normal)),
            Self::Sphere(sphere) => sphere.centre.as_dvec3().dot(normal) + f64::from(sphere.radius) * normal.length(),
        }
    }

    /// A point and the unit normal of the plane that a flat one is in.
    pub(super) fn plane(&self) -> Option<(DVec3, DVec3)> {
        match self {
            Self::Disk(disk) => Some((disk.centre, disk.normal)),
            Self::Sphere(_) => None,
        }
    }

    /// The area, in square scene units.
    pub(super) fn area(&self) -> f64 {
        match self {
            Self::Disk(disk) => disk.axes[0].cross(disk.axes[1]).length() * core::f64::consts::PI,
            Self::Sphere(sphere) => 4.0 * core::f64::consts::PI * f64::from(sphere.radius).powi(2),
        }
    }
}
