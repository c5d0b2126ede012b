//! Convex polygons: what patches are made of.

use disk_sampling::polygon_configuration_factor;
use glam::DVec3;

/// The most corners of a polygon.
pub(super) const MOST_CORNERS: usize = 8;
/// The most corners of a patch, so that it may be clipped by a plane and still be a polygon.
pub(super) const MOST_PATCH_CORNERS: usize = MOST_CORNERS - 2;

/// A convex planar polygon with a front; its corners run anticlockwise as seen from there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Polygon {
    corners: [DVec3; MOST_CORNERS],
    count: usize,
    /// Unit normal of the front.
    pub(super) normal: DVec3,
    /// The centroid.
    pub(super) centre: DVec3,
    /// Largest distance of a corner from the centroid.
    pub(super) radius: f64,
    /// Positive.
    pub(super) area: f64,
}

impl Polygon {
    /// The polygon with these corners and the unit normal of their plane; `None` unless it has 3 to [`MOST_CORNERS`] corners and an area.
    pub(super) fn new(corners: &[DVec3], normal: DVec3) -> Option<Self> {
        let count = corners.len();
        let mut own = [DVec3::ZERO; MOST_CORNERS];
        own.get_mut(..count)?.copy_from_slice(corners);
        let first = *corners.first()?;
        let (mut area, mut moment) = (0.0, DVec3::ZERO);
        for pair in corners.windows(2) {
            let (u, v) = (pair[0] - first, pair[1] - first);
            let part = u.cross(v).dot(normal) / 2.0;
            area += part;
            moment += (u + v) * part;
        }
        if !(area > 0.0 && area.is_finite()) {
            return None;
        }
        let centre = first + moment / (3.0 * area);
        let radius = corners.iter().fold(0.0_f64, |r, c| r.max((*c - centre).length()));
        Some(Self { corners: own, count, normal, centre, radius, area })
    }

    /// The corners in order.
    pub(super) fn corners(&self) -> &[DVec3] {
        &self.corners[..self.count]
    }

    /// The same polygon seen from behind.
    pub(super) fn flipped(&self) -> Self {
        let mut flipped = *self;
        flipped.corners[..self.count].reverse();
        flipped.normal = -self.normal;
        flipped
    }

    /// The edges, each by its ends, in order.
    pub(super) fn edges(&self) -> impl Iterator<Item = [DVec3; 2]> + '_ {
        (0..self.count).map(|i| [self.corners[i], self.corners[(i + 1) % self.count]])
    }

    /// The part where (x − `point`)·`axis` > 0. What is within `slack` of the plane counts as on it; a part without area or with too many
    /// corners to be kept is `None`.
    pub(super) fn above(&self, point: DVec3, axis: DVec3, slack: f64) -> Option<Self> {
        let mut heights = [0.0; MOST_CORNERS];
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for (height, corner) in heights.iter_mut().zip(self.corners()) {
            *height = (*corner - point).dot(axis);
            if height.abs() <= slack {
                *height = 0.0;
            }
            (low, high) = (low.min(*height), high.max(*height));
        }
        if low >= 0.0 {
            return (high > 0.0).then_some(*self);
        }
        if high <= 0.0 {
            return None;
        }
        let mut part = [DVec3::ZERO; MOST_CORNERS + 1];
        let mut count = 0;
        for i in 0..self.count {
            let before = (i + self.count - 1) % self.count;
            let (from, to) = (heights[before], heights[i]);
            if (from < 0.0 && to > 0.0) || (from > 0.0 && to < 0.0) {
                part[count] = self.corners[before] + (self.corners[i] - self.corners[before]) * (from / (from - to));
                count += 1;
            }
            if to >= 0.0 {
                part[count] = self.corners[i];
                count += 1;
            }
        }
        Self::new(&part[..count], self.normal)
    }

    /// Two halves of about equal size, cut across the longest edge. `None` for what is too small to be split.
    pub(super) fn halves(&self) -> Option<[Self; 2]> {
        let n = self.count;
        let length = |i: usize| (self.corners[(i + 1) % n] - self.corners[i]).length_squared();
        // The first of equal ones, whatever their rounding.
        self.halves_across((1..n).fold(0, |best, i| if length(i) > length(best) * (1.0 + 1e-9) { i } else { best }))
    }

    /// Two halves: a triangle is cut from the middle of an edge to the opposite corner, others from there to the middle of the opposite edge.
    /// Rectangles stay rectangles. The cut is between the last and the first of the first half's corners. `None` for what is too small to be
    /// split.
    pub(super) fn halves_across(&self, edge: usize) -> Option<[Self; 2]> {
        let (n, edge) = (self.count, edge % self.count);
        let middle = |i: usize| (self.corners[i % n] + self.corners[(i + 1) % n]) / 2.0;
        let half = n / 2;
        let (cut, end) = (middle(edge), if n == 3 { self.corners[(edge + 2) % n] } else { middle(edge + half) });
        // From the cut over the corners to the end, and from the end over the others to the cut.
        let mut first = vec![cut];
        first.extend((1..=half).map(|k| self.corners[(edge + k) % n]));
        first.push(end);
        let mut second = vec![end];
        second.extend((half + 1..=n).map(|k| self.corners[(edge + k) % n]));
        second.push(cut);
        if n == 3 {
            first = vec![cut, self.corners[(edge + 1) % n], end];
            second = vec![end, self.corners[edge], cut];
        }
        Some([Self::new(&first, self.normal)?, Self::new(&second, self.normal)?])
    }

    /// A triangle's corner, cut off along the middles of the two edges there, and the rest. `None` for others. As for halves, the cut is
    /// between the last and the first of the first part's corners.
    pub(super) fn corner_and_rest(&self, corner: usize) -> Option<[Self; 2]> {
        if self.count != 3 {
            return None;
        }
        let [a, b, c] = [0, 1, 2].map(|k| self.corners[(corner + k) % 3]);
        let (ab, ac) = ((a + b) / 2.0, (a + c) / 2.0);
        Some([Self::new(&[ac, a, ab], self.normal)?, Self::new(&[ab, b, c, ac], self.normal)?])
    }

    /// The triangles of the fan about the first corner.
    pub(super) fn triangles(&self) -> impl Iterator<Item = [DVec3; 3]> + '_ {
        self.corners().windows(2).skip(1).map(|pair| [self.corners[0], pair[0], pair[1]])
    }

    /// A point for each point of the unit square, evenly spread.
    pub(super) fn point(&self, [u, v]: [f64; 2]) -> DVec3 {
        let mut rest = u * self.area;
        let mut found = None;
        for [a, b, c] in self.triangles() {
            let area = (b - a).cross(c - a).dot(self.normal) / 2.0;
            found = Some((a, b, c, (rest / area).clamp(0.0, 1.0)));
            if rest <= area {
                break;
            }
            rest -= area;
        }
        let Some((a, b, c, u)) = found else { return self.centre };
        // Uniform on the triangle: the root makes the density constant.
        let root = u.sqrt();
        a + (b - a) * (root * (1.0 - v)) + (c - a) * (root * v)
    }

    /// The solid angle in sr that the front subtends at a point, 0 from behind (van Oosterom & Strackee 1983).
    pub(super) fn solid_angle(&self, point: DVec3) -> f64 {
        if (point - self.centre).dot(self.normal) <= 0.0 {
            return 0.0;
        }
        let mut sum = 0.0;
        for corners in self.triangles() {
            let [a, b, c] = corners.map(|x| x - point);
            let [x, y, z] = [a, b, c].map(DVec3::length);
            let volume = a.dot(b.cross(c)).abs();
            sum += 2.0 * volume.atan2(x * y * z + a.dot(b) * z + b.dot(c) * x + c.dot(a) * y);
        }
        sum
    }

    /// The configuration factor at an element that nothing hides it from: irradiance over π times radiance. The point must be in front.
    ///
    /// Lambert's formula, over the edges; what the element's horizon cuts off is left to the general function.
    pub(super) fn configuration_factor(&self, point: DVec3, normal: DVec3) -> f64 {
        let mut ways = [DVec3::ZERO; MOST_CORNERS];
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for (way, corner) in ways.iter_mut().zip(self.corners()) {
            *way = *corner - point;
            let height = way.dot(normal);
            (low, high) = (low.min(height), high.max(height));
        }
        if !(high > 0.0) {
            return 0.0;
        }
        let ways = &ways[..self.count];
        if low < 0.0 {
            let mut corners = [[0.0; 3]; MOST_CORNERS];
            corners.iter_mut().zip(self.corners()).for_each(|(to, from)| *to = from.to_array());
            return polygon_configuration_factor(point.to_array(), normal.to_array(), &corners[..self.count]);
        }
        let mut sum = 0.0;
        let Some(mut before) = ways.last() else { return 0.0 };
        for way in ways {
            let across = before.cross(*way);
            let sine = across.length();
            if sine > 0.0 {
                sum += sine.atan2(before.dot(*way)) * across.dot(normal) / sine;
            }
            before = way;
        }
        sum.abs() / core::f64::consts::TAU
    }

    /// Least distance of a point from the polygon.
    pub(super) fn distance(&self, point: DVec3) -> f64 {
        let inside = self.edges().all(|[a, b]| (b - a).cross(point - a).dot(self.normal) >= 0.0);
        if inside {
            return (point - self.centre).dot(self.normal).abs();
        }
        self.edges().fold(f64::INFINITY, |least, [a, b]| {
            let along = b - a;
            let t = ((point - a).dot(along) / along.length_squared()).clamp(0.0, 1.0);
            least.min((point - a - along * t).length())
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square() -> Polygon {
        let corners = [[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0]].map(|[x, y]| DVec3::new(x, y, 0.0));
        Polygon::new(&corners, DVec3::Z).unwrap()
    }

    #[test]
    fn what_is_cut_lies_on_both_sides_of_the_cut() {
        let triangle = Polygon::new(&[DVec3::ZERO, DVec3::X * 3.0, DVec3::Y], DVec3::Z).unwrap();
        let cuts = (0..3).flat_map(|k| [triangle.corner_and_rest(k), triangle.halves_across(k)]);
        for [first, second] in cuts.chain((0..4).map(|k| square().halves_across(k))).flatten() {
            let (from, to) = (first.corners()[0], *first.corners().last().unwrap());
            let beyond = |polygon: &Polygon| first.normal.cross(from - to).dot(polygon.centre - to);
            assert!(beyond(&first) > 0.0 && beyond(&second) < 0.0, "{first:?} {second:?}");
        }
    }

    #[test]
    fn halves_share_the_area_and_stay_in_shape() {
        let triangle = Polygon::new(&[DVec3::ZERO, DVec3::X * 3.0, DVec3::Y], DVec3::Z).unwrap();
        let pentagon = square().above(DVec3::new(1.5, 1.5, 0.0), DVec3::new(-1.0, -1.0, 0.0), 0.0).unwrap();
        assert_eq!(pentagon.corners().len(), 5);
        for whole in [square(), triangle, pentagon] {
            let mut parts = vec![whole];
            for _ in 0..7 {
                parts = parts.iter().flat_map(|p| p.halves().unwrap()).collect();
                let sum: f64 = parts.iter().map(|p| p.area).sum();
                assert!((sum - whole.area).abs() <= 1e-13 * whole.area);
                assert!(parts.iter().all(|p| p.corners().len() <= MOST_PATCH_CORNERS));
            }
            assert!(parts.iter().all(|p| p.radius * p.radius <= 4.0 * p.area), "thin parts");
        }
    }

    #[test]
    fn solid_angles_of_a_cube_from_its_middle() {
        let angle = square().solid_angle(DVec3::new(1.0, 1.0, 1.0));
        assert!((angle - 4.0 * core::f64::consts::PI / 6.0).abs() <= 1e-14);
        assert_eq!(square().solid_angle(DVec3::new(1.0, 1.0, -1.0)), 0.0);
        // A corner of the cube sees an eighth of the sphere in three faces.
        let angle = square().solid_angle(DVec3::new(0.0, 0.0, 2.0));
        assert!((angle - 4.0 * core::f64::consts::PI / 24.0).abs() <= 1e-14);
    }

    #[test]
    fn what_is_on_the_plane_is_neither_above_nor_below() {
        let s = square();
        assert!(s.above(DVec3::ZERO, DVec3::Z, 1e-12).is_none());
        assert!(s.above(DVec3::new(0.0, 0.0, 1.0), DVec3::Z, 1e-12).is_none());
        assert_eq!(s.above(DVec3::new(0.0, 0.0, -1.0), DVec3::Z, 1e-12), Some(s));
        let half = s.above(DVec3::X, DVec3::X, 1e-12).unwrap();
        assert!((half.area - 2.0).abs() <= 1e-15 && half.corners().len() == 4);
    }
}
