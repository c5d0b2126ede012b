//! One part of a subdivided disk.

use spectral_core::Real;

use super::{Label, Method};
use crate::map::{
    HEXAGON_SIDE, square_to_disk_elliptical, square_to_disk_polar, triangle_to_disk, triangle_to_hexagon,
};

/// One part of a subdivided disk: where to aim at, and what it stands for.
///
/// Positions and sizes are in units of the disk's radius, from its centre, along [`Disk::frame`](crate::Disk::frame);
/// [`Disk::point`](crate::Disk::point) turns a position into a point of space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Subsource<R> {
    method: Method,
    label: Label,
    position: [R; 2],
}

impl<R: Real> Subsource<R> {
    /// The part of `method`'s hierarchy with this label, in constant time. A label of the other kind (triangles,
    /// squares) gives the undivided disk.
    pub fn new(method: Method, label: Label) -> Self {
        let label = if label.is_triangular() == method.is_triangular() { label } else { Label::root(method) };
        Self { method, label, position: place(method, label, [R::ZERO; 2]) }
    }

    /// The sample position at the part's centre (dj = 0): of the square or triangle before it is mapped.
    pub const fn position(&self) -> [R; 2] {
        self.position
    }

    /// The label.
    pub const fn label(&self) -> Label {
        self.label
    }

    /// The share of the disk's area that the sample stands for: one over the number of parts of this level. Parts that
    /// miss keep their weight (their contribution is 0), so the weights of a partition always sum to 1.
    pub fn weight(&self) -> R {
        let level = self.label.level();
        if !self.method.is_triangular() {
            return half_to(level);
        }
        if level == 0 { R::ONE } else { half_to::<R>(2 * (level - 1)) / R::from_f64(6.0) }
    }

    /// The longest axis, in disk radii: of the square or hexagon as a whole, the longer side of a rectangle, the side
    /// of a triangle. For the mapped methods this is the size before the map.
    pub fn extent(&self) -> R {
        let level = self.label.level();
        if !self.method.is_triangular() {
            return R::PI.sqrt() * half_to(level / 2);
        }
        let side = R::from_f64(HEXAGON_SIDE);
        if level == 0 { R::TWO * side } else { side * half_to(level - 1) }
    }

    /// Whether the sample at the centre hits the disk; a miss is Radiance's "aiming failure".
    pub fn hits(&self) -> bool {
        self.is_hit(self.position)
    }

    /// A sample position, jittered: `jitter` (dj) 0 is the centre, 1 spreads samples over the whole part as `random` in
    /// [0, 1)² is uniform (eq. 2.1 for rectangles, 2.8 for an undivided hexagon, 2.9 for triangles), and whether it
    /// hits the disk.
    ///
    /// Equation 2.9 as printed adds dj (y √(1 − x) u + (1 − √(1 − x)) w) to the midpoint, which for dj > 0 leaves the
    /// triangle; here the mean of what is added, dj (u + w)/3, is taken off, so that the triangle is covered exactly at
    /// dj = 1, as the thesis's expected 3.72 % of misses assumes. The two methods whose name says so never miss,
    /// whatever dj in [0, 1].
    pub fn sample(&self, jitter: R, random: [R; 2]) -> ([R; 2], bool) {
        let [x, y] = random;
        let offset = if !self.method.is_triangular() {
            [(R::ONE - R::TWO * x) * R::HALF, (R::ONE - R::TWO * y) * R::HALF]
        } else if self.label.level() == 0 {
            square_to_disk_polar(random)
        } else {
            let root = (R::ONE - x).max(R::ZERO).sqrt();
            let third = R::ONE / R::from_f64(3.0);
            [y * root - third, (R::ONE - root) - third]
        };
        let position = place(self.method, self.label, offset.map(|x| x * jitter));
        (position, self.is_hit(position))
    }

    /// The sample position and weight of a cubature of degree 8 on the same hierarchy (Dunavant 1985): for parts of a
    /// full [`Method::EqualAreaHexagon`] partition of depth 5 or more, in place of [`position`](Self::position) and
    /// [`weight`](Self::weight).
    ///
    /// Sixteen parts that share a grandparent are the sixteen points of the rule, one point in each of them; the
    /// weights are positive and sum to 1 over the disk. Other parts give their centre and weight. The rule only makes
    /// sense where all sixteen are summed.
    pub fn cubature(&self) -> ([R; 2], R) {
        let ancestor = self.label.parent().and_then(Label::parent).filter(|ancestor| ancestor.level() > 0);
        let (Some(ancestor), Method::EqualAreaHexagon) = (ancestor, self.method) else {
            return (self.position, self.weight());
        };
        let ([x, y], share) = dunavant(self.label.within(2));
        let third = 1.0 / 3.0;
        let inside = triangle_point(ancestor, [x - third, y - third].map(R::from_f64));
        (triangle_to_disk(ancestor.sector(), inside), self.weight() * R::from_f64(16.0 * share))
    }

    fn is_hit(&self, [x, y]: [R; 2]) -> bool {
        match self.method {
            // By construction; only rounding could say otherwise.
            Method::MappedSquare | Method::EqualAreaHexagon => true,
            _ => x * x + y * y <= R::ONE,
        }
    }
}

/// The point and weight of Dunavant's rule of degree 8 that lie in one of the sixteen parts of a triangle.
///
/// Which orbit of the rule it is follows from the quarter of each barycentric coordinate's range that the part is in.
fn dunavant(part: Label) -> ([f64; 2], f64) {
    let ([x, y], reversed) = part.corner();
    let quarters = if reversed { [4 - x - y, x - 1, y - 1] } else { [3 - x - y, x, y] };
    let largest = quarters.into_iter().fold(0, i32::max);
    let (values, weight): ([f64; 4], f64) = match (reversed, largest) {
        (false, 3) => ([0.050_547_228_317_031, 0.0, 0.0, 0.898_905_543_365_938], 0.032_458_497_623_198),
        (false, 2) => {
            ([0.008_394_777_409_958, 0.263_112_829_634_638, 0.728_492_392_955_404, 0.0], 0.027_230_314_174_435)
        }
        (false, _) => ([0.0, 1.0 / 3.0, 0.0, 0.0], 0.144_315_607_677_787),
        (true, 2) => ([0.170_569_307_751_760, 0.0, 0.658_861_384_496_480, 0.0], 0.103_217_370_534_718),
        (true, _) => ([0.081_414_823_414_554, 0.459_292_588_292_723, 0.0, 0.0], 0.095_091_634_267_285),
    };
    let value = |quarter: i32| usize::try_from(quarter).ok().and_then(|i| values.get(i)).copied().unwrap_or(0.0);
    ([value(quarters[1]), value(quarters[2])], weight)
}

/// The point of a part at an offset from its centre: in sides of a rectangle, in legs of a triangle, in radii for an
/// undivided hexagon.
fn place<R: Real>(method: Method, label: Label, offset: [R; 2]) -> [R; 2] {
    match method {
        Method::Square => square_point(label, offset).map(|x| x * R::PI.sqrt() * R::HALF),
        // As [0, 1]², which the map expects.
        Method::MappedSquare => square_to_disk_elliptical(square_point(label, offset).map(|x| (x + R::ONE) * R::HALF)),
        Method::Hexagon | Method::EqualAreaHexagon if label.level() == 0 => offset,
        Method::Hexagon => triangle_to_hexagon(label.sector(), triangle_point(label, offset)),
        Method::EqualAreaHexagon => triangle_to_disk(label.sector(), triangle_point(label, offset)),
    }
}

/// A point of the square [−1, 1]².
fn square_point<R: Real>(label: Label, offset: [R; 2]) -> [R; 2] {
    let [column, row] = label.cell().map(|x| R::from_f64(f64::from(x)));
    let sides = [half_to::<R>(label.level().div_ceil(2)), half_to::<R>(label.level() / 2)];
    // From the middle, so that mirrored parts have mirrored positions to the last bit.
    [(column, sides[0], offset[0]), (row, sides[1], offset[1])]
        .map(|(index, side, offset)| ((R::TWO * index + R::ONE) * side - R::ONE) + R::TWO * offset * side)
}

/// A point of the right triangle x, y ≥ 0, x + y ≤ 1 (eq. 2.3 to 2.7).
fn triangle_point<R: Real>(label: Label, offset: [R; 2]) -> [R; 2] {
    let ([x, y], reversed) = label.corner();
    let sign = if reversed { -R::ONE } else { R::ONE };
    let leg = half_to::<R>(label.level() - 1);
    let third = R::ONE / R::from_f64(3.0);
    [(x, offset[0]), (y, offset[1])]
        .map(|(o, offset)| ((from_i32::<R>(o) + sign * (third + offset)) * leg).max(R::ZERO))
}

/// 2^−n for n up to 62.
fn half_to<R: Real>(n: u32) -> R {
    #[allow(clippy::cast_precision_loss, reason = "a power of two")]
    let power = (1_u64 << n.min(62)) as f64;
    R::from_f64(1.0 / power)
}

fn from_i32<R: Real>(x: i32) -> R {
    R::from_f64(f64::from(x))
}
