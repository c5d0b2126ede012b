//! Whether patches see each other.

use glam::DVec3;

use super::mesh::Patches;
use super::polygon::Polygon;
use crate::geometry::{NO_PRIMITIVE, ShaftEnd, SurfacePoint};

/// What is known of the ways between two things.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Sight {
    /// One polygon blocks all of them, for certain.
    Blocked,
    /// Some may be blocked.
    Mixed,
}

/// A point that is or isn't on a surface, for rays.
pub(super) fn surface_point(position: DVec3, normal: DVec3, primitive: u32) -> SurfacePoint {
    SurfacePoint::new(position.as_vec3a(), normal.as_vec3a()).on(primitive)
}

/// A patch as the end of a shaft.
pub(super) fn shaft_end(polygon: &Polygon, primitive: u32) -> ShaftEnd {
    ShaftEnd::polygon(polygon.corners(), polygon.normal, primitive)
}

impl Patches {
    /// [`Sight::Blocked`] if the polygon of a primitive blocks all ways between two convex sets with these corners: it does if it blocks
    /// those between the corners, as the others cross its plane within the convex hull of where these do.
    pub(super) fn sight_past(&self, blocker: u32, from: &[DVec3], to: &[DVec3]) -> Sight {
        let Some(blocker) = self.blockers.get(blocker as usize) else { return Sight::Mixed };
        let height = |x: &DVec3| (*x - blocker.centre).dot(blocker.normal);
        // What lies in its plane isn't behind it.
        if [from, to].iter().any(|end| end.iter().all(|x| height(x).abs() <= 10.0 * self.slack)) {
            return Sight::Mixed;
        }
        let mut crossed = false;
        for a in from {
            for b in to {
                let (above, below) = (height(a), height(b));
                if above.abs() <= self.slack && below.abs() <= self.slack {
                    continue;
                }
                let t = above / (above - below);
                if !(above * below <= self.slack * self.slack) || !(-1e-9..=1.0 + 1e-9).contains(&t) {
                    return Sight::Mixed;
                }
                let place = *a + (*b - *a) * t;
                let is_inside =
                    |[c, d]: [DVec3; 2]| (d - c).cross(place - c).dot(blocker.normal) >= -self.slack * (d - c).length();
                if !blocker.edges().all(is_inside) {
                    return Sight::Mixed;
                }
                crossed = true;
            }
        }
        if crossed { Sight::Blocked } else { Sight::Mixed }
    }

    /// The primitive that a point lies on, its normal on the side of the given one; [`NO_PRIMITIVE`] if there is none.
    pub(super) fn primitive_at(&self, position: DVec3, normal: DVec3) -> u32 {
        let above = (1e5 * self.slack).max(f64::MIN_POSITIVE);
        let origin = position + normal * above;
        let mut ray = crate::geometry::Ray::new(origin.as_vec3a(), (-normal * above).as_vec3a());
        ray.t_max = 1.5;
        match self.world.closest_hit(&ray) {
            Some(hit) if (f64::from(hit.t) - 1.0).abs() <= 0.5 => hit.primitive,
            _ => NO_PRIMITIVE,
        }
    }
}

/// Point `index` of a sequence in four dimensions without clusters (M. Roberts, "The unreasonable effectiveness of quasirandom
/// sequences", 2018): multiples of the powers of 1/g, g⁵ = g + 1.
pub(super) fn spread(index: u32) -> [f64; 4] {
    const STEPS: [f64; 4] =
        [0.856_674_883_854_502_9, 0.733_891_856_627_126, 0.628_706_721_037_810_9, 0.538_597_257_223_612_9];
    STEPS.map(|step| (0.5 + step * f64::from(index + 1)).fract())
}
