//! The light exchanged between two polygons as an integral over both contours.
//!
//! A₁F₁₂ = 1/(2π) ∮∮ ln r dx₁·dx₂ (E. M. Sparrow, "A new and simpler formulation for radiative angle factors", J. Heat Transfer 85, 1963),
//! a sum over pairs of edges. The inner integral has a closed form, and for parallel edges the outer one too (P. Schröder & P. Hanrahan,
//! "On the form factor between two polygons", SIGGRAPH 1993). Otherwise the outer one is taken by Gauss–Legendre rules on stretches
//! chosen by where the integrand stops being analytic.

use glam::DVec3;

use super::gauss::{nodes_for, rule};
use super::polygon::Polygon;

/// Edges whose directions differ by less are parallel.
const PARALLEL: f64 = 1e-14;
/// Products of unit directions below this are 0.
const PERPENDICULAR: f64 = 1e-15;
/// The largest rule for one stretch.
const MOST_NODES: usize = 20;
/// How often a stretch is halved.
const DEPTH: u32 = 48;
/// A singularity nearer to the end of a stretch than this share of its length is at the end.
const TOUCHING: f64 = 1e-13;

/// ∫∫ cos θ₁ cos θ₂ / (π r²) over two polygons that are in front of each other's planes and don't block each other, in the square of the
/// length unit; relative error about `tolerance`, and ε d⁴/(A₁A₂) by cancellation for far ones (d: distance).
pub(super) fn contour_exchange(p: &Polygon, q: &Polygon, tolerance: f64) -> f64 {
    // Logarithms of lengths near 1 lose least by cancellation.
    let unit = (p.centre - q.centre).length() + p.radius + q.radius;
    let origin = (p.centre + q.centre) / 2.0;
    let local = |x: DVec3| (x - origin) / unit;
    let mut sum = 0.0;
    for e in p.edges() {
        let e = Edge::new(e.map(local));
        for f in q.edges() {
            sum += e.against(&Edge::new(f.map(local)), tolerance);
        }
    }
    (sum * unit * unit / (2.0 * core::f64::consts::PI)).max(0.0)
}

/// An edge: where it starts, its unit direction and its length.
#[derive(Clone, Copy)]
struct Edge {
    start: DVec3,
    direction: DVec3,
    length: f64,
}

impl Edge {
    fn new([from, to]: [DVec3; 2]) -> Self {
        let along = to - from;
        let length = along.length();
        Self { start: from, direction: along / length, length }
    }

    /// ∫∫ ln r dx·dy over this edge and another.
    fn against(&self, other: &Self, tolerance: f64) -> f64 {
        let cosine = self.direction.dot(other.direction);
        if cosine.abs() <= PERPENDICULAR {
            return 0.0;
        }
        let sine = self.direction.cross(other.direction).length();
        if sine <= PARALLEL {
            return self.against_parallel(other);
        }
        let inner = Inner::new(self, other, sine);
        cosine * inner.integral(0.0, self.length, tolerance, DEPTH)
    }

    /// The same in closed form for parallel edges.
    fn against_parallel(&self, other: &Self) -> f64 {
        let axis = self.direction;
        let between = other.start - self.start;
        let t0 = between.dot(axis);
        let t1 = t0 + other.length * other.direction.dot(axis).signum();
        let h = (between - axis * t0).length();
        let s1 = self.length;
        potential(s1 - t0, h) + potential(t1, h) - potential(s1 - t1, h) - potential(t0, h) - 1.5 * s1 * (t1 - t0)
    }
}

/// A function Φ(u), even in u, with Φ″ = ln √(u² + h²) + 3/2.
fn potential(u: f64, h: f64) -> f64 {
    let (u2, h2) = (u * u, h * h);
    let squared = u2 + h2;
    if squared <= 0.0 {
        return 0.0;
    }
    0.25 * (u2 - h2) * squared.ln() + h * u.abs() * u.abs().atan2(h)
}

/// The inner integral ∫ ln r over an edge, as a function of the place on another edge.
struct Inner<'e> {
    outer: &'e Edge,
    inner: &'e Edge,
    /// Where, on the complex line through the outer edge, it isn't analytic: real and imaginary part.
    singular: [[f64; 2]; 3],
}

impl<'e> Inner<'e> {
    fn new(outer: &'e Edge, inner: &'e Edge, sine: f64) -> Self {
        // The ends of the inner edge, and the point nearest to its line.
        let foot = |x: DVec3| {
            let way = x - outer.start;
            let along = way.dot(outer.direction);
            [along, (way - outer.direction * along).length()]
        };
        let ends = [foot(inner.start), foot(inner.start + inner.direction * inner.length)];
        let across = outer.direction.cross(inner.direction) / sine;
        let between = inner.start - outer.start;
        let nearest = between.cross(inner.direction).dot(across) / sine;
        let gap = between.dot(across).abs();
        Self { outer, inner, singular: [ends[0], ends[1], [nearest, gap / sine]] }
    }

    fn at(&self, place: f64) -> f64 {
        let way = self.inner.start - (self.outer.start + self.outer.direction * place);
        let from = way.dot(self.inner.direction);
        let to = from + self.inner.length;
        let h2 = (way - self.inner.direction * from).length_squared();
        let part = |u: f64| {
            let squared = u * u + h2;
            if squared > 0.0 { 0.5 * u * squared.ln() } else { 0.0 }
        };
        let h = h2.sqrt();
        let angle = (h * self.inner.length).atan2(h2 + from * to);
        part(to) - part(from) + h * angle - self.inner.length
    }

    /// The integral over a stretch of the outer edge.
    fn integral(&self, from: f64, to: f64, tolerance: f64, depth: u32) -> f64 {
        let touching = TOUCHING * self.outer.length;
        let touches = |end: f64| self.singular.iter().any(|[x, y]| (x - end).abs().max(*y) <= touching);
        let (ends, middle) = ([touches(from), touches(to)], (from + to) / 2.0);
        // Measured from the end where the integrand is singular, if there is one.
        let [start, end] = if ends[1] { [to, from] } else { [from, to] };
        let is_singular = ends[0] || ends[1];
        let (mut ellipse, mut cut) = (f64::INFINITY, middle);
        for [x, y] in self.singular {
            let (place, height) = ((x - start) / (end - start), y / (end - start).abs());
            let own = if !is_singular {
                half_axes(2.0 * place - 1.0, 2.0 * height)
            } else if (x - start).abs().max(y) <= touching {
                f64::INFINITY
            } else {
                half_axes_of_root(place, height)
            };
            if own < ellipse {
                ellipse = own;
                cut = if place > 0.05 && place < 0.95 && height < 0.25 { x } else { middle };
            }
        }
        let nodes = nodes_for(ellipse, tolerance);
        if depth > 0 && ((ends[0] && ends[1]) || nodes > MOST_NODES) {
            return self.integral(from, cut, tolerance, depth - 1) + self.integral(cut, to, tolerance, depth - 1);
        }
        if is_singular {
            return self.away_from_singular_end([start, end]);
        }
        let points = &rule(nodes.clamp(2, MOST_NODES)).points;
        points.iter().map(|(x, w)| w * self.at(from + (to - from) * x)).sum::<f64>() * (to - from)
    }

    /// The integral over a stretch from an end where the integrand behaves like s ln s: with s = x⁴ it is smooth.
    fn away_from_singular_end(&self, [singular, other]: [f64; 2]) -> f64 {
        let way = other - singular;
        let points = &rule(MOST_NODES).points;
        let sum: f64 = points.iter().map(|(x, w)| w * 4.0 * x.powi(3) * self.at(singular + way * x.powi(4))).sum();
        sum * way.abs()
    }
}

/// The sum of the half axes of the ellipse with foci ±1 through x + iy.
fn half_axes(x: f64, y: f64) -> f64 {
    let major = ((x - 1.0).hypot(y) + (x + 1.0).hypot(y)) / 2.0;
    major + (major * major - 1.0).max(0.0).sqrt()
}

/// The same for the fourth root of x + iy, y ≥ 0, and the stretch [0, 1].
fn half_axes_of_root(x: f64, y: f64) -> f64 {
    let (radius, angle) = (x.hypot(y).sqrt().sqrt(), y.atan2(x) / 4.0);
    half_axes(2.0 * radius * angle.cos() - 1.0, 2.0 * radius * angle.sin())
}
