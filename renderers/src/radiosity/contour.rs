//! The light exchanged between two polygons as an integral over both contours.
//!
//! A₁F₁₂ = 1/(2π) ∮∮ ln r dx₁·dx₂ (E. M. Sparrow, "A new and simpler formulation for radiative angle factors", J. Heat Transfer 85, 1963),
//! a sum over pairs of edges. The inner integral has a closed form, and for parallel edges the outer one too (P. Schröder & P. Hanrahan,
//! "On the form factor between two polygons", SIGGRAPH 1993). Otherwise the outer one is taken by Gauss–Legendre rules on stretches
//! chosen by where the integrand stops being analytic.

use glam::DVec3;

use super::gauss::{nodes_for, rule};
use super::polygon::{MOST_CORNERS, Polygon};

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

/// The error of a rule for the logarithm of the distance, over the power of the ellipse: its coefficients fall like 1/n.
const LOGARITHM: f64 = 0.1;
/// The largest rule for an edge in [`far_exchange`].
const MOST_FAR_NODES: usize = 6;
/// Room for the points of one contour there.
const ROOM: usize = MOST_FAR_NODES * MOST_CORNERS;
/// Room for their pairs with the points of one edge, a multiple of [`LANES`].
const MOST_PAIRS: usize = (MOST_FAR_NODES * ROOM).next_multiple_of(LANES);
/// The most terms of the series of the logarithm.
const MOST_TERMS: u8 = 24;

/// The points of a rule on edges, from the polygon's centre, each with a weight and with what it alone adds to the square of the
/// distance between the centres.
struct Contour {
    axes: [[f64; ROOM]; 3],
    squares: [f64; ROOM],
    weights: [f64; ROOM],
    count: usize,
}

impl Contour {
    const fn empty() -> Self {
        Self { axes: [[0.0; ROOM]; 3], squares: [0.0; ROOM], weights: [0.0; ROOM], count: 0 }
    }

    /// `towards` is the vector to the other centre.
    fn new(polygon: &Polygon, nodes: usize, towards: DVec3) -> Self {
        let mut contour = Self::empty();
        for [from, to] in polygon.edges() {
            for (x, weight) in &rule(nodes).points {
                let point = from - polygon.centre + (to - from) * *x;
                contour.push(point.to_array(), point.length_squared() - 2.0 * towards.dot(point), *weight);
            }
        }
        contour
    }

    fn push(&mut self, point: [f64; 3], square: f64, weight: f64) {
        let place = self.count;
        self.axes.iter_mut().zip(point).for_each(|(axis, x)| axis[place] = x);
        (self.squares[place], self.weights[place]) = (square, weight);
        self.count += 1;
    }

    fn point(&self, place: usize) -> [f64; 3] {
        let [xs, ys, zs] = &self.axes;
        [xs[place], ys[place], zs[place]]
    }

    /// The largest distance from the centre, and the largest of the squares.
    fn largest(&self) -> [f64; 2] {
        let size = |place| DVec3::from_array(self.point(place)).length_squared();
        let most = (0..self.count).fold([0.0_f64; 2], |[a, b], i| [a.max(size(i)), b.max(self.squares[i].abs())]);
        [most[0].sqrt(), most[1]]
    }

    /// A part of the points.
    fn each(&self, places: core::ops::Range<usize>) -> impl Iterator<Item = ([f64; 3], f64, f64)> + '_ {
        places.map(|place| (self.point(place), self.squares[place], self.weights[place]))
    }
}

/// Logarithms that are summed side by side.
const LANES: usize = 8;

/// Pairs of points, for the logarithm of their distance r over the centres' d: t / (2 + t) with r² = d² (1 + t), and weights.
struct Pairs {
    arguments: [f64; MOST_PAIRS],
    weights: [f64; MOST_PAIRS],
    count: usize,
}

impl Pairs {
    /// Adds the pairs of one point with points.
    fn add(&mut self, ([x, y, z], square, weight): ([f64; 3], f64, f64), others: &Contour, squared: f64) {
        let range = self.count..self.count + others.count;
        let [xs, ys, zs] = &others.axes;
        let points = xs.iter().zip(ys).zip(zs).zip(&others.squares).zip(&others.weights);
        let places = self.arguments[range.clone()].iter_mut().zip(&mut self.weights[range]);
        for ((argument, own), ((((a, b), c), other), w)) in places.zip(points) {
            let t = square + other - 2.0 * (x * a + y * b + z * c);
            *argument = t / (2.0 * squared + t);
            *own = weight * w;
        }
        self.count += others.count;
    }

    /// The sum of weights times ln(r/d) = ½ ln(1 + t) = artanh(t / (2 + t)).
    fn logarithms(&mut self, terms: usize) -> f64 {
        let (last, others) = COEFFICIENTS[..terms].split_last().unwrap_or((&1.0, &[]));
        // Lanes after the last pair are left from other edges, and count nothing.
        let filled = self.count.next_multiple_of(LANES);
        self.weights[self.count..filled].fill(0.0);
        let (arguments, _) = self.arguments[..filled].as_chunks::<LANES>();
        let (weights, _) = self.weights[..filled].as_chunks::<LANES>();
        let mut sums = [0.0; LANES];
        for (arguments, weights) in arguments.iter().zip(weights) {
            let powers = arguments.map(|s| s * s);
            let mut series = [*last; LANES];
            for coefficient in others.iter().rev() {
                series.iter_mut().zip(&powers).for_each(|(sum, power)| *sum = *sum * power + coefficient);
            }
            for (((sum, one), s), weight) in sums.iter_mut().zip(series).zip(arguments).zip(weights) {
                *sum += one * s * weight;
            }
        }
        sums.iter().sum()
    }
}

/// 1, 1/3, 1/5, …
const COEFFICIENTS: [f64; MOST_TERMS as usize] = {
    let mut all = [1.0; MOST_TERMS as usize];
    let (mut term, mut odd) = (0, 1.0);
    while term < all.len() {
        all[term] = 1.0 / odd;
        (term, odd) = (term + 1, odd + 2.0);
    }
    all
};

/// The same for far polygons by Gauss–Legendre rules on the edges, along each of which the integrand is analytic within an ellipse
/// ([`nodes_for`]). Only the logarithm of the distance over that of the centres counts, which loses little. `None` where rules with few nodes
/// are worse than `tolerance`, as for light at grazing angles.
pub(super) fn far_exchange(p: &Polygon, q: &Polygon, ellipses: [f64; 2], tolerance: f64) -> Option<f64> {
    let between = q.centre - p.centre;
    let squared = between.length_squared();
    let lengths = [p, q].map(|polygon| polygon.edges().map(|[from, to]| (to - from).length()).sum::<f64>());
    let cosines = between.dot(p.normal) * -between.dot(q.normal) / squared;
    // What rules make of edges doesn't cancel as the integrals do: their error counts in proportion to what is left of these.
    let left = 2.0 * cosines * p.area * q.area / (squared * lengths[0] * lengths[1]);
    let size = p.radius.max(q.radius) / squared.sqrt();
    let nodes = ellipses.map(|ellipse| nodes_for(ellipse, tolerance * left / (LOGARITHM * size)));
    if !(left > 0.0) || nodes.iter().any(|n| *n > MOST_FAR_NODES) {
        return None;
    }
    let (one, other) = (Contour::new(p, nodes[0], between), Contour::new(q, nodes[1], -between));
    let ([a, b], [c, d]) = (one.largest(), other.largest());
    let most = (b + d + 2.0 * a * c) / squared;
    let argument = most / (2.0 - most);
    let terms = (1.0 + (0.1 * tolerance * left).ln() / argument.ln()) / 2.0;
    let lost = f64::EPSILON * argument / left;
    if !(most < 1.0 && terms <= f64::from(MOST_TERMS) && lost <= tolerance) {
        return None;
    }
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "at most MOST_TERMS")]
    let terms = terms.ceil().max(1.0) as usize;
    let mut pairs = Pairs { arguments: [0.0; MOST_PAIRS], weights: [0.0; MOST_PAIRS], count: 0 };
    let (mut along, mut sum) = (Contour::empty(), 0.0);
    for (i, [from, to]) in p.edges().enumerate() {
        let edge = to - from;
        (along.count, pairs.count) = (0, 0);
        for (j, [from, to]) in q.edges().enumerate() {
            let product = edge.dot(to - from);
            if product.abs() > PERPENDICULAR * lengths[0] * lengths[1] {
                let points = other.each(j * nodes[1]..(j + 1) * nodes[1]);
                points.for_each(|(point, square, weight)| along.push(point, square, weight * product));
            }
        }
        one.each(i * nodes[0]..(i + 1) * nodes[0]).for_each(|point| pairs.add(point, &along, squared));
        sum += pairs.logarithms(terms);
    }
    Some((sum / (2.0 * core::f64::consts::PI)).max(0.0))
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
