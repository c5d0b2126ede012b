//! Points on lights, for estimates that weigh light by more than its irradiance.

use core::f64::consts::PI;

use glam::DVec3;

use super::lattice::{Panel, Sight};
use super::source::{Receiver, Seen, Shape, Source};
use crate::geometry::World;

/// The share that a direction counts if two techniques may find it, this one with the density `own`: Veach's power heuristic with exponent 2
/// (*Robust Monte Carlo Methods for Light Transport Simulation*, 1997, §9.2).
pub(crate) fn power_heuristic(own: f64, other: f64) -> f64 {
    // As a ratio, which neither overflows nor is 0/0 where a density is infinite.
    let ratio = other / own;
    1.0 / (1.0 + ratio * ratio)
}

/// A light with an area as seen from one position: points are evenly distributed over the area of what is seen of it (for spheres, of
/// the disk that fills the same cone).
#[derive(Clone, Copy, Debug)]
pub(crate) struct SampledLight {
    panel: Panel,
    position: DVec3,
    area: f64,
    primitive: u32,
}

/// A point of a light.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LightPoint {
    position: DVec3,
    /// The unit vector towards it.
    pub(crate) direction: DVec3,
    /// Density of such directions per steradian, without regard to what is in the way.
    pub(crate) pdf: f64,
}

impl SampledLight {
    /// The light from a position; `None` from behind or from within it.
    pub(crate) fn new(source: &Source, position: DVec3) -> Option<Self> {
        let seen = Seen::new(&source.shape, position)?;
        let area = match (&source.shape, &seen.circle) {
            (Shape::Rectangle(flat), _) => 4.0 * flat.u.cross(flat.v).length(),
            (Shape::Triangle([a, b, c]), _) => (*b - *a).cross(*c - *a).length() / 2.0,
            (_, Some(circle)) => PI * circle.u.cross(circle.v).length(),
            _ => return None,
        };
        Some(Self { panel: Panel::new(&source.shape, position), position, area, primitive: source.primitive })
    }

    /// The point for a point of the unit square.
    pub(crate) fn square_to_point(&self, square: [f64; 2]) -> LightPoint {
        let position = self.panel.point(square, 0.0);
        let direction = (position - self.position).normalize_or_zero();
        LightPoint { position, direction, pdf: self.pdf(direction) }
    }

    /// The density of [`square_to_point`](Self::square_to_point) per steradian in a direction in which the light is.
    pub(crate) fn pdf(&self, direction: DVec3) -> f64 {
        let normal = self.panel.normal();
        let cosine = -normal.dot(direction);
        let distance = -normal.dot(self.panel.middle() - self.position) / cosine;
        if cosine > 0.0 { distance * distance / (cosine * self.area) } else { 0.0 }
    }

    /// Whether a receiver at the position sees a point.
    pub(crate) fn sees(&self, point: &LightPoint, receiver: &Receiver, world: &World) -> bool {
        self.panel.sees(point.position, self.primitive, receiver, world) == Sight::Visible
    }
}

#[cfg(test)]
mod tests {
    use core::f64::consts::{PI, TAU};

    use glam::DVec3;

    use super::SampledLight;
    use crate::direct::{Flat, Shape, Source};
    use crate::geometry::NO_PRIMITIVE;

    fn flat() -> Flat {
        Flat { centre: DVec3::new(0.2, -0.4, 1.5), u: DVec3::X * 0.7, v: DVec3::Y * 0.7, normal: DVec3::NEG_Z }
    }

    fn sampled(shape: Shape) -> Option<SampledLight> {
        SampledLight::new(&Source { shape, primitive: NO_PRIMITIVE }, DVec3::ZERO)
    }

    /// The mean of 1/pdf is the solid angle: in closed form for each shape (rectangle: Van Oosterom and Strackee 1983 by triangles;
    /// the disk's on its axis; the sphere's cone).
    #[test]
    fn densities_are_per_steradian() {
        let on_axis = Flat { centre: DVec3::Z * 1.5, ..flat() };
        let corner = |x: f64, y: f64| flat().at([x, y]);
        let rectangle = triangle([corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0)])
            + triangle([corner(-1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)]);
        let disk = TAU * (1.0 - 1.5 / 1.5_f64.hypot(0.7));
        let (centre, radius) = (DVec3::new(1.0, 0.5, -2.0), 0.8_f64);
        let sphere = TAU * (1.0 - (1.0 - radius * radius / centre.length_squared()).sqrt());
        for (shape, expected) in [
            (Shape::Rectangle(flat()), rectangle),
            (Shape::Disk(on_axis), disk),
            (Shape::Sphere { centre, radius }, sphere),
        ] {
            let light = sampled(shape).unwrap();
            let steps = 400;
            let mut sum = 0.0;
            for i in 0..steps * steps {
                let square = [i % steps, i / steps].map(|k| (f64::from(k) + 0.5) / f64::from(steps));
                let point = light.square_to_point(square);
                assert!((point.direction.length() - 1.0).abs() <= 1e-12);
                sum += 1.0 / point.pdf;
            }
            let found = sum / f64::from(steps * steps);
            // The midpoint rule's error is a share h² of the integrand's curvature, which is of its own size.
            assert!((found / expected - 1.0).abs() <= 1e-4, "{shape:?}: {found}, expected {expected}");
        }
    }

    fn triangle(corners: [DVec3; 3]) -> f64 {
        let [a, b, c] = corners.map(DVec3::normalize);
        2.0 * a.dot(b.cross(c)).abs().atan2(1.0 + a.dot(b) + b.dot(c) + c.dot(a)).rem_euclid(PI)
    }

    #[test]
    fn lights_from_behind_and_within_have_no_points() {
        assert!(sampled(Shape::Rectangle(Flat { normal: DVec3::Z, ..flat() })).is_none());
        assert!(sampled(Shape::Disk(Flat { normal: DVec3::Z, ..flat() })).is_none());
        assert!(sampled(Shape::Sphere { centre: DVec3::X, radius: 1.5 }).is_none());
    }
}
