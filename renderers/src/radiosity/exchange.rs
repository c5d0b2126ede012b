//! The light that two unblocked polygons exchange, by the cheapest formula that is accurate enough.

use glam::DVec3;

use super::contour::{contour_exchange, far_exchange};
use super::gauss::{nodes_for, rule};
use super::polygon::Polygon;

/// Rounding of the sum over the contours, in ε d⁴/(A₁A₂).
const CANCELLATION: f64 = 4.0 * f64::EPSILON;
/// Rounding that is put up with: rules that do better take several times as long.
const ROUNDING: f64 = 6e-13;
/// Rules with so many nodes a side, or fewer, beat the contours.
const FEW_NODES: usize = 3;
/// Rules with so many nodes a side, or fewer, beat closed forms for the inner integral.
const MORE_NODES: usize = 5;

/// A₁F₁₂ = ∫∫ cos θ₁ cos θ₂ / (π r²) over the fronts of two polygons between which nothing stands, in the square of the length unit:
/// area times form factor, the same both ways. Parts behind the other's plane don't count; what is within `slack` (a length) of that
/// plane is in it, and sees nothing of it: 0 exactly.
///
/// Relative error about `tolerance` (at least 6·10⁻¹³).
pub(super) fn exchange(p: &Polygon, q: &Polygon, slack: f64, tolerance: f64) -> f64 {
    let (Some(p), Some(q)) = (p.above(q.centre, q.normal, slack), q.above(p.centre, p.normal, slack)) else {
        return 0.0;
    };
    let (small, large) = if p.radius <= q.radius { (&p, &q) } else { (&q, &p) };
    let distance = (p.centre - q.centre).length();
    let gap = if distance > 4.0 * large.radius { distance - large.radius } else { large.distance(small.centre) };
    let ellipse = ellipse_beyond(small, gap - small.radius);
    let nodes = nodes_for(ellipse, tolerance);
    if nodes > FEW_NODES {
        let rounding = CANCELLATION * distance.powi(4) / (p.area * q.area);
        if nodes > 2 * FEW_NODES || rounding <= tolerance.max(ROUNDING) {
            return contour_exchange(&p, &q, tolerance);
        }
    }
    let other_ellipse = ellipse_beyond(large, distance - large.radius - small.radius);
    let others = nodes_for(other_ellipse, tolerance);
    if nodes.max(others) > FEW_NODES {
        let gap = large.distance(small.centre) - small.radius;
        let ellipses = [small, large].map(|polygon| ellipse_beyond(polygon, gap));
        if let Some(sum) = far_exchange(small, large, ellipses, tolerance.max(ROUNDING)) {
            return sum;
        }
    }
    if others <= MORE_NODES
        && let Some(sum) = by_points(small, nodes, large, others)
    {
        return sum;
    }
    over_points(small, nodes, |x, w| w * large.configuration_factor(x, small.normal))
}

/// The ellipse of analyticity along a polygon whose points are at least `gap` from what makes the integrand large.
fn ellipse_beyond(polygon: &Polygon, gap: f64) -> f64 {
    // A patch is little wider than √2 radii in either direction.
    let distance = gap.max(0.0) / (polygon.radius * core::f64::consts::FRAC_1_SQRT_2);
    distance + (distance * distance + 1.0).sqrt()
}

/// Σ f(x, w) over a product rule on a polygon; the weights add up to its area.
pub(super) fn over_points(polygon: &Polygon, nodes: usize, mut f: impl FnMut(DVec3, f64) -> f64) -> f64 {
    let points = &rule(nodes).points;
    let mut sum = 0.0;
    if let [a, b, c, d] = *polygon.corners()
        && ((a + c) - (b + d)).length() <= 1e-12 * polygon.radius
    {
        for (u, wu) in points {
            for (v, wv) in points {
                sum += f(a + (b - a) * *u + (d - a) * *v, wu * wv * polygon.area);
            }
        }
        return sum;
    }
    for [a, b, c] in polygon.triangles() {
        let twice = (b - a).cross(c - a).dot(polygon.normal);
        for (u, wu) in points {
            for (v, wv) in points {
                // The square with one side drawn together in a corner.
                sum += f(a + ((b - a) * (1.0 - *v) + (c - a) * *v) * *u, wu * wv * u * twice);
            }
        }
    }
    sum
}

/// Room for the points of one polygon.
const MOST_POINTS: usize = 64;

/// Points that are summed side by side.
const LANES: usize = 4;

/// The sum over points of both; `None` if these are too many.
fn by_points(p: &Polygon, nodes_p: usize, q: &Polygon, nodes_q: usize) -> Option<f64> {
    // Spare places have no weight, and are like any other.
    let mut points =
        [[[q.centre.x; LANES], [q.centre.y; LANES], [q.centre.z; LANES], [0.0; LANES]]; MOST_POINTS / LANES];
    let mut count = 0;
    over_points(q, nodes_q, |y, w| {
        if let Some(block) = points.get_mut(count / LANES) {
            for (row, value) in block.iter_mut().zip([y.x, y.y, y.z, w]) {
                row[count % LANES] = value;
            }
        }
        count += 1;
        0.0
    });
    let blocks = points.get(..count.div_ceil(LANES))?;
    let (n, m) = (p.normal, q.normal);
    let positive = |x: f64| if x > 0.0 { x } else { 0.0 };
    let sum = over_points(p, nodes_p, |x, wx| {
        let mut sums = [0.0; LANES];
        for [ys, yt, yu, weights] in blocks {
            for lane in 0..LANES {
                let (dx, dy, dz) = (ys[lane] - x.x, yt[lane] - x.y, yu[lane] - x.z);
                let squared = dx * dx + dy * dy + dz * dz;
                let near = positive(dx * n.x + dy * n.y + dz * n.z);
                sums[lane] += weights[lane] * near / (squared * squared);
            }
        }
        // All of a plane's points are as far from another plane's point along its normal.
        wx * positive((x - q.centre).dot(m)) * sums.iter().sum::<f64>()
    });
    Some(sum / core::f64::consts::PI)
}

#[cfg(test)]
mod tests {
    use core::f64::consts::PI;

    use super::*;

    const TOLERANCE: f64 = 1e-14;

    fn polygon(corners: &[[f64; 3]]) -> Polygon {
        let corners: Vec<DVec3> = corners.iter().map(|c| DVec3::from_array(*c)).collect();
        let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]).normalize();
        Polygon::new(&corners, normal).unwrap()
    }

    fn square_at(h: f64) -> Polygon {
        polygon(&[[0.0, 0.0, h], [0.0, 1.0, h], [1.0, 1.0, h], [1.0, 0.0, h]])
    }

    fn floor() -> Polygon {
        polygon(&[[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]])
    }

    /// Turned and moved, so that nothing is along an axis.
    fn turned(p: &Polygon) -> Polygon {
        let turn = glam::DQuat::from_euler(glam::EulerRot::XYZ, 0.3, 1.1, -0.7);
        let corners: Vec<DVec3> = p.corners().iter().map(|c| turn * *c + DVec3::new(0.3, -2.0, 5.0)).collect();
        Polygon::new(&corners, turn * p.normal).unwrap()
    }

    /// Opposite equal squares of side 1 at distance h (Howell, catalogue of configuration factors, C-11).
    fn opposite(h: f64) -> f64 {
        let x = 1.0 / h;
        let root = (1.0 + x * x).sqrt();
        let log = ((1.0 + x * x).powi(2) / (1.0 + 2.0 * x * x)).ln() / 2.0;
        2.0 / (PI * x * x) * (log + 2.0 * x * root * (x / root).atan() - 2.0 * x * x.atan())
    }

    #[test]
    fn faces_of_a_cube_exchange_the_published_shares() {
        let wall = polygon(&[[0.0; 3], [0.0, 1.0, 0.0], [0.0, 1.0, 1.0], [0.0, 0.0, 1.0]]);
        for (a, b) in [(floor(), wall), (turned(&floor()), turned(&wall))] {
            // Howell C-14; the six-digit values are those of the unit cube.
            let side = exchange(&a, &b, 1e-12, TOLERANCE);
            assert!((side - 0.200_043_776_075_4).abs() <= 5e-13, "{side}");
            assert_eq!(format!("{side:.6}"), "0.200044");
        }
        let top = exchange(&floor(), &square_at(1.0), 1e-12, TOLERANCE);
        assert_eq!(format!("{top:.6}"), "0.199825");
        assert!((top - opposite(1.0)).abs() <= 1e-14, "{top}");
    }

    #[test]
    fn opposite_squares_at_every_distance() {
        for h in [1e-3, 0.01, 0.1, 0.5, 1.0, 2.0, 3.0, 5.0, 7.0, 10.0, 20.0, 50.0, 100.0] {
            // The closed form itself loses h⁴ε by cancellation: beyond 3 the series in 1/h² of the kernel is as good.
            let (exact, slack) = (opposite(h), 1e-12_f64.max(4.0 * f64::EPSILON * h.powi(4)));
            for (a, b) in [(floor(), square_at(h)), (turned(&floor()), turned(&square_at(h)))] {
                let found = exchange(&a, &b, 1e-12, TOLERANCE);
                assert!((found / exact - 1.0).abs() <= slack, "{h}: {found} {exact} {:e}", found / exact - 1.0);
            }
        }
    }

    /// Triangles and quadrilaterals at some diameters of each other, turned any way, against a far finer rule over one of them.
    #[test]
    fn far_polygons_of_all_turns() {
        let shapes = [
            polygon(&[[0.0; 3], [1.0, 0.0, 0.0], [0.2, 1.0, 0.0]]),
            polygon(&[[0.0; 3], [1.0, 0.0, 0.0], [0.9, 0.8, 0.0], [0.1, 0.6, 0.0]]),
            floor(),
        ];
        let mut count = 0;
        for index in 0_u32..300 {
            let [a, b, c, d] = crate::radiosity::sight::spread(index).map(|x| 2.0 * PI * x);
            let way = DVec3::new(a.sin(), a.cos(), 1.0 + b.sin()) * (4.0 + f64::from(index % 11));
            let turn = glam::DQuat::from_euler(glam::EulerRot::XYZ, b, c, d);
            let (p, q) = (shapes[index as usize % 3], shapes[index as usize / 3 % 3]);
            let corners: Vec<DVec3> = q.corners().iter().map(|x| turn * *x + way).collect();
            let q = Polygon::new(&corners, turn * q.normal).unwrap();
            let found = exchange(&p, &q, 1e-12, TOLERANCE);
            // Where a horizon cuts, rules are not so good.
            let above = |p: &Polygon, q: &Polygon| p.corners().iter().all(|x| (*x - q.centre).dot(q.normal) > 0.1);
            if above(&p, &q) && above(&q, &p) {
                let fine = over_points(&p, 12, |x, w| w * q.configuration_factor(x, p.normal));
                assert!((found / fine - 1.0).abs() <= 5e-12, "{index}: {found} {fine} {:e}", found / fine - 1.0);
                count += 1;
            }
        }
        assert!(count > 50, "{count}");
    }

    #[test]
    fn nothing_passes_in_a_plane_or_behind() {
        let beside = polygon(&[[1.0, 0.0, 0.0], [2.0, 0.0, 0.0], [2.0, 1.0, 0.0], [1.0, 1.0, 0.0]]);
        let below = square_at(-0.5);
        assert_eq!(exchange(&floor(), &beside, 1e-12, TOLERANCE), 0.0);
        assert_eq!(exchange(&floor(), &below, 1e-12, TOLERANCE), 0.0);
        assert_eq!(exchange(&floor(), &square_at(1.0).flipped(), 1e-12, TOLERANCE), 0.0);
    }

    /// Triangles, obtuse and touching, against the sum over parts: nothing is shared but the definition.
    #[test]
    fn parts_add_up() {
        let a = polygon(&[[0.0; 3], [1.0, 0.0, 0.0], [0.2, 1.0, 0.0]]);
        for b in [
            polygon(&[[0.0; 3], [0.3, 0.2, 1.0], [1.0, 0.0, 0.0]]),
            polygon(&[[0.0; 3], [1.0, -0.4, 0.05], [1.0, 0.0, 0.0]]).flipped(),
            polygon(&[[0.1, 0.1, 1e-6], [0.2, 0.3, 0.7], [0.9, 0.1, 1e-6]]),
            polygon(&[[0.1, 0.1, 3.0], [0.2, 0.9, 3.3], [0.9, 0.1, 2.7]]),
            polygon(&[[0.1, 0.1, -1.0], [0.2, 0.3, 0.7], [0.9, 0.1, 2.0]]),
        ] {
            for b in [b, b.flipped()] {
                let whole = exchange(&a, &b, 1e-12, TOLERANCE);
                let mut parts = vec![(a, b)];
                for level in 0..6 {
                    let split = |(p, q): &(Polygon, Polygon)| -> Vec<(Polygon, Polygon)> {
                        if level % 2 == 0 {
                            p.halves().unwrap().map(|p| (p, *q)).to_vec()
                        } else {
                            q.halves().unwrap().map(|q| (*p, q)).to_vec()
                        }
                    };
                    parts = parts.iter().flat_map(split).collect();
                    let sum: f64 = parts.iter().map(|(p, q)| exchange(p, q, 1e-12, TOLERANCE)).sum();
                    assert!(
                        (sum - whole).abs() <= 1e-11 * whole + 1e-16,
                        "{level}: {sum} {whole} {:e}",
                        sum / whole - 1.0
                    );
                }
            }
        }
    }
}
