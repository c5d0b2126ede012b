//! Configuration factors of pieces of lights, by Lambert's contour integral: F = 1/(2π) ∮ n·(r × dr)/|r|².
//!
//! Along a straight edge the integral is the angle it subtends times the cosine between the receiver's normal and the normal of the
//! plane through edge and receiver. Along an arc of a circle it is that of a quotient of trigonometric polynomials.

use core::f64::consts::TAU;

use glam::DVec3;

/// Arcs that come so near to a whole turn between different edges are none: their ends are one corner on the circle.
const WHOLE_TURN: f64 = TAU - 1e-9;

/// A circle as seen from the origin: `centre` + cos φ `u` + sin φ `v`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Circle {
    pub(super) centre: DVec3,
    pub(super) u: DVec3,
    pub(super) v: DVec3,
    /// The unit normal of its plane, away from the origin, and the plane's distance.
    pub(super) normal: DVec3,
    pub(super) distance: f64,
}

/// 2π times the configuration factor of a polygon around the origin, which must be above the horizon of `normal`.
pub(super) fn polygon(corners: &[DVec3], normal: DVec3) -> f64 {
    let Some(last) = corners.last() else { return 0.0 };
    let mut before = *last;
    let mut sum = 0.0;
    for corner in corners {
        sum += edge(before, *corner, normal);
        before = *corner;
    }
    sum
}

/// The integral along a straight edge.
fn edge(a: DVec3, b: DVec3, normal: DVec3) -> f64 {
    let across = a.cross(b);
    let sine = across.length();
    if sine > 0.0 { sine.atan2(a.dot(b)) * (across.dot(normal) / sine) } else { 0.0 }
}

/// The part of an edge within the unit circle.
struct Chord {
    from: [f64; 2],
    to: [f64; 2],
    /// Whether it starts and ends on the circle, not within.
    enters: bool,
    leaves: bool,
}

impl Circle {
    /// A direction's place in the circle's plane, in radii.
    fn place(&self, direction: DVec3) -> [f64; 2] {
        let offset = direction * (self.distance / self.normal.dot(direction)) - self.centre;
        [self.u, self.v].map(|axis| offset.dot(axis) / axis.length_squared())
    }

    fn at(&self, [x, y]: [f64; 2]) -> DVec3 {
        self.centre + self.u * x + self.v * y
    }

    /// 2π times the configuration factor of a polygon's part within the circle; the polygon runs round as u, v do.
    pub(super) fn part(&self, corners: &[DVec3], normal: DVec3) -> f64 {
        let Some(last) = corners.last() else { return 0.0 };
        let mut before = self.place(*last);
        let mut surrounds = true;
        let mut sum = 0.0;
        let mut first: Option<f64> = None;
        let mut leaving: Option<f64> = None;
        let mut chords = 0_u32;
        for corner in corners {
            let here = self.place(*corner);
            surrounds &= before[0] * here[1] - before[1] * here[0] > 0.0;
            if let Some(chord) = chord(before, here) {
                chords += 1;
                sum += edge(self.at(chord.from), self.at(chord.to), normal);
                if chord.enters {
                    let angle = angle(chord.from);
                    match leaving.take() {
                        Some(left) => sum += self.arc(left, turn(left, angle, false), normal),
                        None => first = Some(angle),
                    }
                }
                if chord.leaves {
                    leaving = Some(angle(chord.to));
                }
            }
            before = here;
        }
        match (leaving, first) {
            (Some(left), Some(entered)) => sum + self.arc(left, turn(left, entered, chords == 1), normal),
            _ if chords == 0 && surrounds => self.arc(0.0, TAU, normal),
            _ => sum,
        }
    }

    /// The integral along an arc from one angle over a turn.
    fn arc(&self, from: f64, turn: f64, normal: DVec3) -> f64 {
        // n·(r × r′) = area + along cos φ + across sin φ, |r|² = squared + 2 (p cos φ + q sin φ).
        let Self { centre, u, v, .. } = self;
        let area = u.cross(*v).dot(normal);
        let (along, across) = (centre.cross(*v).dot(normal), u.cross(*centre).dot(normal));
        let squared = centre.length_squared() + u.length_squared();
        let (p, q) = (2.0 * centre.dot(*u), 2.0 * centre.dot(*v));
        let integrand = |sin: f64, cos: f64| (area + along * cos + across * sin) / (squared + p * cos + q * sin);
        // The nearest pole is at the angle arcosh(squared / amplitude) off the real axis.
        let amplitude = p.hypot(q);
        let nearest = self.nearest();
        let off = (nearest / amplitude).min(1e6);
        let pole = (off + (off * (off + 2.0)).sqrt()).ln_1p();
        let parts = (turn / (2.0 * REACH * pole)).ceil();
        if parts > MOST_PARTS {
            return self.near_arc([area, along, across], [squared, p, q], from, turn);
        }
        let half = turn / (2.0 * parts);
        let mut sum = 0.0;
        let mut middle = from + half;
        while middle < from + turn {
            for (node, weight) in GAUSS {
                for signed in [-node, *node] {
                    let (sin, cos) = (middle + half * signed).sin_cos();
                    sum += weight * integrand(sin, cos);
                }
            }
            middle += 2.0 * half;
        }
        sum * half
    }

    /// The squared distance of the circle's nearest point.
    fn nearest(&self) -> f64 {
        let [x, y] = [self.u, self.v].map(|axis| self.centre.dot(axis) / axis.length());
        let across = self.u.length() - x.hypot(y);
        across * across + self.distance * self.distance
    }

    /// The integral along an arc in closed form, for points near the circle.
    fn near_arc(&self, [area, along, across]: [f64; 3], [squared, p, q]: [f64; 3], from: f64, turn: f64) -> f64 {
        // With ψ from the farthest point on: (area + b cos ψ + c sin ψ) / (squared + amplitude cos ψ).
        let amplitude = p.hypot(q);
        let start = q.atan2(p);
        let (b, c) = ((along * p + across * q) / amplitude, (across * p - along * q) / amplitude);
        let (far, near) = (squared + amplitude, self.nearest().max(f64::MIN_POSITIVE));
        let root = (far * near).sqrt();
        let (first, last) = (from - start, from - start + turn);
        // ∫dψ / (squared + amplitude cos ψ), continued over ψ = π.
        let angle = |psi: f64| {
            let turns = (psi / TAU).round();
            2.0 * (((psi - turns * TAU) / 2.0).tan() * (near / far).sqrt()).atan() + turns * TAU
        };
        let logarithm = |psi: f64| (near + 2.0 * amplitude * (psi / 2.0).cos().powi(2)).ln();
        let straight = (area - squared * b / amplitude) / root * (angle(last) - angle(first));
        b / amplitude * turn + straight - c / amplitude * (logarithm(last) - logarithm(first))
    }
}

/// Arcs are cut so that half of each is at most this many times as long as its nearest pole is far: then the rule is exact to rounding.
const REACH: f64 = 0.75;
/// More parts than these cost more than the closed form, which is accurate where they would be needed.
const MOST_PARTS: f64 = 8.0;
/// Positive nodes and weights of the Gauss–Legendre rule with 16 points.
const GAUSS: &[(f64, f64)] = &[
    (0.095_012_509_837_637_44, 0.189_450_610_455_068_5),
    (0.281_603_550_779_258_9, 0.182_603_415_044_923_6),
    (0.458_016_777_657_227_4, 0.169_156_519_395_002_54),
    (0.617_876_244_402_643_7, 0.149_595_988_816_576_73),
    (0.755_404_408_355_003, 0.124_628_971_255_533_87),
    (0.865_631_202_387_831_7, 0.095_158_511_682_492_78),
    (0.944_575_023_073_232_6, 0.062_253_523_938_647_89),
    (0.989_400_934_991_649_9, 0.027_152_459_411_754_095),
];

fn angle([x, y]: [f64; 2]) -> f64 {
    y.atan2(x)
}

/// The turn from one angle forwards to another. Almost a whole turn is none, unless `whole`.
fn turn(from: f64, to: f64, whole: bool) -> f64 {
    let turn = (to - from).rem_euclid(TAU);
    if turn > WHOLE_TURN && !whole { 0.0 } else { turn }
}

/// The part of a segment within the unit circle, if it is more than a touch.
fn chord(from: [f64; 2], to: [f64; 2]) -> Option<Chord> {
    let way = [to[0] - from[0], to[1] - from[1]];
    let squared = way[0] * way[0] + way[1] * way[1];
    let foot = -(from[0] * way[0] + from[1] * way[1]) / squared;
    let distance = (from[0] * way[1] - from[1] * way[0]) / squared.sqrt();
    let half = ((1.0 - distance) * (1.0 + distance) / squared).sqrt();
    // NaN, for a segment outside or without length, is in no range.
    let (start, end) = (foot - half, foot + half);
    let (enters, leaves) = (start > 0.0, end < 1.0);
    let (start, end) = (start.max(0.0), end.min(1.0));
    if !(half > 0.0 && start < end) {
        return None;
    }
    let at = |t: f64| [from[0] + way[0] * t, from[1] + way[1] * t];
    Some(Chord { from: if enters { at(start) } else { from }, to: if leaves { at(end) } else { to }, enters, leaves })
}

/// The configuration factor of a sum of contour integrals.
pub(super) fn factor(sum: f64) -> f64 {
    (sum / TAU).abs().min(1.0)
}
