//! What points of a patch see of another one: how much, and how much that varies over the patch.

use super::mesh::{Cut, Node, Patches};
use super::polygon::Polygon;
use super::shade::{Eye, MOST_BLOCKERS};
use super::sight::{Sight, shaft_end, spread, surface_point};
use crate::geometry::Shaft;
use glam::DVec3;

/// Nodes of the Gauss–Legendre rule with two points on [0, 1].
const GAUSS: [f64; 2] = [0.211_324_865_405_187_1, 0.788_675_134_594_812_9];
/// The most points on a patch.
pub(super) const MOST_POINTS: usize = 6;
/// Patches so many times as long as wide are not split across their width.
const SLIM: f64 = 8.0;
/// How far from the middle towards the corners the points of polygons with many corners are.
const OUTWARDS: f64 = 0.6;
/// Rays from a point where blockers are too many to be cut out.
const RAYS: u32 = 8;

/// Whether patches see each other.
pub(super) enum Between {
    Clear,
    Blocked,
    /// These primitives may be in the way, and no others.
    Few(Vec<u32>),
    Many,
}

/// What points of a patch see of another.
#[derive(Clone, Copy, Debug)]
pub(super) struct View {
    /// Mean configuration factor at the points as if nothing blocked.
    pub(super) open: f64,
    /// Mean configuration factor of what is seen.
    pub(super) seen: f64,
    /// Mean distance of that from its mean over the points.
    pub(super) varies: f64,
    /// The cut that leaves least of this.
    pub(super) cut: Cut,
}

/// Points on a patch, with weights that add up to 1.
#[derive(Clone, Copy, Debug)]
pub(super) struct Points {
    points: [(DVec3, f64); MOST_POINTS],
    count: usize,
}

impl Points {
    pub(super) fn on(polygon: &Polygon) -> Self {
        let mut points = [(polygon.centre, 0.0); MOST_POINTS];
        match *polygon.corners() {
            [a, b, c, d] => {
                let mut all = 0.0;
                for (i, (point, weight)) in points.iter_mut().take(4).enumerate() {
                    let (u, v) = (GAUSS[i / 2], GAUSS[i % 2]);
                    let (along_u, along_v) = ((b - a) * (1.0 - v) + (c - d) * v, (d - a) * (1.0 - u) + (c - b) * u);
                    *point = a + (b - a) * (u * (1.0 - v)) + (c - a) * (u * v) + (d - a) * ((1.0 - u) * v);
                    *weight = along_u.cross(along_v).dot(polygon.normal);
                    all += *weight;
                }
                points.iter_mut().for_each(|(_, weight)| *weight /= all);
                Self { points, count: 4 }
            }
            [a, b, c] => {
                for (point, corner) in points.iter_mut().zip([a, b, c]) {
                    // Exact for polynomials of the second degree.
                    *point = (polygon.centre + (corner - polygon.centre) * 0.5, 1.0 / 3.0);
                }
                Self { points, count: 3 }
            }
            ref corners => {
                let count = corners.len().min(MOST_POINTS);
                for (point, corner) in points.iter_mut().zip(corners) {
                    #[allow(clippy::cast_precision_loss, reason = "at most 6")]
                    let weight = 1.0 / count as f64;
                    *point = (polygon.centre + (*corner - polygon.centre) * OUTWARDS, weight);
                }
                Self { points, count }
            }
        }
    }

    pub(super) fn iter(&self) -> impl Iterator<Item = &(DVec3, f64)> {
        self.points[..self.count].iter()
    }
}

impl Patches {
    /// What is known of the ways between two patches.
    pub(super) fn between(&self, p: &Node, q: &Node) -> Between {
        let shaft = Shaft::between(&shaft_end(&p.polygon, p.primitive), &shaft_end(&q.polygon, q.primitive));
        let Some(blockers) = self.world.shaft_blockers(&shaft, MOST_BLOCKERS, false) else { return Between::Many };
        if blockers.is_empty() {
            return Between::Clear;
        }
        let hides =
            |blocker: &u32| self.sight_past(*blocker, p.polygon.corners(), q.polygon.corners()) == Sight::Blocked;
        if blockers.iter().any(hides) { Between::Blocked } else { Between::Few(blockers) }
    }

    /// What points of one patch see of another.
    pub(super) fn view(&self, from: &Node, of: &Node, between: &Between) -> View {
        let points = Points::on(&from.polygon);
        let mut values = [0.0; MOST_POINTS];
        let (mut open, mut seen) = (0.0, 0.0);
        for (value, (point, weight)) in values.iter_mut().zip(points.iter()) {
            let factor = self.factor(&of.polygon, *point, from.polygon.normal);
            *value = if factor > 0.0 { self.seen_factor(from, of, *point, factor, between) } else { 0.0 };
            open += weight * factor;
            seen += weight * *value;
        }
        let varies = values.iter().zip(points.iter()).map(|(v, (_, w))| w * (v - seen).abs()).sum();
        View { open, seen, varies, cut: best_cut(&from.polygon, &values) }
    }

    /// The configuration factor of a polygon that nothing hides: 0 from behind or from its plane.
    pub(super) fn factor(&self, polygon: &Polygon, point: DVec3, normal: DVec3) -> f64 {
        if (point - polygon.centre).dot(polygon.normal) <= self.slack {
            return 0.0;
        }
        polygon.configuration_factor(point, normal)
    }

    fn seen_factor(&self, from: &Node, of: &Node, point: DVec3, factor: f64, between: &Between) -> f64 {
        let normal = from.polygon.normal;
        let parts = match between {
            Between::Clear => return factor,
            Between::Blocked => return 0.0,
            Between::Few(blockers) => self.seen_parts(&of.polygon, Eye::At(point), blockers),
            Between::Many => None,
        };
        if let Some(parts) = parts {
            return parts.iter().map(|part| part.configuration_factor(point, normal)).sum();
        }
        let start = surface_point(point, normal, from.primitive);
        let (mut seen, mut all) = (0.0, 0.0);
        for index in 0..RAYS {
            let [u, v, ..] = spread(index);
            let target = of.polygon.point([u, v]);
            let way = target - point;
            let weight =
                way.dot(normal).max(0.0) * (-way.dot(of.polygon.normal)).max(0.0) / way.length_squared().powi(2);
            if weight > 0.0 {
                all += weight;
                let end = surface_point(target, of.polygon.normal, of.primitive);
                seen += if self.world.occluded(&start, &end) { 0.0 } else { weight };
            }
        }
        if all > 0.0 { factor * seen / all } else { 0.0 }
    }
}

/// The cut across the direction in which values at the points vary most.
pub(super) fn best_cut(polygon: &Polygon, values: &[f64; MOST_POINTS]) -> Cut {
    match *polygon.corners() {
        [a, b, c, d] => {
            let along_u = (values[0] - values[2]).abs() + (values[1] - values[3]).abs();
            let along_v = (values[0] - values[1]).abs() + (values[2] - values[3]).abs();
            let (width, height) = ((b - a).length() + (c - d).length(), (d - a).length() + (c - b).length());
            let across_u = if width > SLIM * height {
                true
            } else if height > SLIM * width {
                false
            } else {
                // Equal variation: the longer one.
                along_u * (1.0 + 1e-9) + 1e-300 * width > along_v + 1e-300 * height
            };
            Cut::Across(u8::from(!across_u))
        }
        [_, _, _] => {
            let lone = |i: usize| {
                let (own, one, other) = (values[i], values[(i + 1) % 3], values[(i + 2) % 3]);
                (own - 0.5 * (one + other)).abs() > 2.0 * (one - other).abs()
            };
            (0_u8..3).find(|i| lone(usize::from(*i))).map_or(Cut::Longest, Cut::Corner)
        }
        _ => Cut::Longest,
    }
}
