//! Configuration factors: contour integrals in 106 bits where these keep enough of them, and the table of 90-digit values where they don't.

use std::path::Path;

use disk_sampling as ds;
use disk_sampling::{Disk, Receiver, Sphere};
use spectral_core::Real;

use crate::accuracy::gauge::{Axis, Gauge};
use crate::accuracy::wide::{Wide, cross, dot, wide, wides};

/// How many times larger than a sum its terms may be: of 31 digits, 16 are left.
const CANCELLATION: f64 = 1e15;

type Vector = [Wide; 3];

fn minus(a: Vector, b: Vector) -> Vector {
    core::array::from_fn(|i| a[i] - b[i])
}

fn times(a: Vector, s: Wide) -> Vector {
    a.map(|x| x * s)
}

fn unit(a: Vector) -> Vector {
    times(a, 1.0 / dot(a, a).sqrt())
}

/// A sum, unless it is too small for its terms.
struct Sum(Wide, Wide);

impl Sum {
    fn of(terms: &[Wide]) -> Self {
        Self(terms.iter().fold(Wide::ZERO, |s, x| s + *x), terms.iter().fold(Wide::ZERO, |s, x| s + x.abs()))
    }

    fn kept(&self) -> Option<Wide> {
        (self.0.abs().to_f64() * CANCELLATION > self.1.to_f64()).then_some(self.0)
    }
}

/// The receiver in the frame of a disk: x towards the axis, z against the disk's normal.
struct Seen {
    height: Wide,
    rho: Wide,
    radius: Wide,
    frame: [Vector; 3],
}

impl Seen {
    fn new(centre: Vector, normal: Vector, radius: Wide, position: Vector) -> Self {
        let normal = unit(normal);
        let d = minus(centre, position);
        let height = -dot(d, normal);
        let q: Vector = core::array::from_fn(|i| d[i] + height * normal[i]);
        let rho = dot(q, q).sqrt();
        let aside = if normal[0].abs() < 0.9 { [1.0, 0.0, 0.0] } else { [0.0, 1.0, 0.0] };
        let x = if rho > 0.0 { times(q, 1.0 / rho) } else { unit(cross(normal, aside.map(Wide::from))) };
        let z = normal.map(|c| -c);
        Self { height, rho, radius, frame: [x, cross(z, x), z] }
    }

    /// The contour integral 1/(2π) ∮ n·(x × dx)/x² over the whole rim, of either sign: with x = (ρ + r cos f, r sin f, h), the integrand is
    /// (c₀ + c₁ cos f)/(b + a cos f).
    fn whole(&self, n: Vector) -> Wide {
        let [nx, _, nz] = self.frame.map(|axis| dot(axis, n));
        let Self { height: h, rho, radius: r, .. } = *self;
        let (c0, c1) = (nz * r * r, nz * r * rho - nx * h * r);
        let (a, b, root) = self.denominator();
        (c0 - c1 * a / (b + root)) / root
    }

    fn denominator(&self) -> (Wide, Wide, Wide) {
        let Self { height: h, rho, radius: r, .. } = *self;
        // b − a and b + a are sums of squares.
        let (near, far) = (h.squared() + (rho - r).squared(), h.squared() + (rho + r).squared());
        (rho * r * 2.0, (near + far) * 0.5, (near * far).sqrt())
    }

    /// The factor for a unit normal, clipped; `None` where the arithmetic doesn't serve.
    fn factor(&self, n: Vector) -> Option<Wide> {
        let [nx, ny, nz] = self.frame.map(|axis| dot(axis, n));
        let Self { height: h, rho, radius: r, .. } = *self;
        if h <= 0.0 {
            return (h < 0.0).then_some(Wide::ZERO);
        }
        let (s, g) = (h * nz + rho * nx, nx.hypot(ny));
        if s + r * g <= 0.0 {
            return Some(Wide::ZERO);
        }
        if s >= r * g {
            let (a, b, root) = self.denominator();
            let (c0, c1) = (nz * r * r, nz * r * rho - nx * h * r);
            return Sum::of(&[c0 / root, -(c1 * a / (b + root) / root)]).kept();
        }
        self.cut(nx, ny, nz, s, g)
    }

    /// The arc above the horizon, and the chord along it.
    fn cut(&self, nx: Wide, ny: Wide, nz: Wide, s: Wide, g: Wide) -> Option<Wide> {
        let Self { height: h, rho, radius: r, .. } = *self;
        let (a, b, root) = self.denominator();
        if a.to_f64() < 1e-6 * b.to_f64() {
            return None;
        }
        let (c0, c1, c2) = (nz * r * r, nz * r * rho - nx * h * r, -(ny * h * r));
        let shape = ((b - a) / (b + a)).sqrt();
        let terms = |f: Wide, sign: f64| {
            let turns = ((f + Wide::PI) / (Wide::PI * 2.0)).to_f64().floor();
            let (sin, cos) = ((f - Wide::PI * 2.0 * turns) * 0.5).sin_cos();
            let i0 = ((shape * sin).atan2(cos) + Wide::PI * turns) * 2.0 / root;
            let log = (b + a * f.cos()).ln();
            [c0 * i0, c1 * f / a, -(c1 * b * i0 / a), -(c2 * log / a)].map(|term| term * sign)
        };
        let (middle, width) = (ny.atan2(nx), (-(s / (r * g))).acos());
        let (first, last) = (middle - width, middle + width);
        let point = |f: Wide| {
            let (sin, cos) = f.sin_cos();
            [rho + r * cos, r * sin, h]
        };
        let (from, to) = (point(last), point(first));
        let chord = dot(cross(from, to), [nx, ny, nz]).atan2(dot(from, to));
        let all: Vec<Wide> = terms(last, 1.0).into_iter().chain(terms(first, -1.0)).chain([chord]).collect();
        Some(Sum::of(&all).kept()? / (Wide::PI * 2.0))
    }
}

/// What a sphere sends, clipped.
fn sphere_exact(centre: Vector, r: Wide, position: Vector, n: Vector) -> Option<Wide> {
    let d = minus(centre, position);
    let (d2, s) = (dot(d, d), dot(d, n));
    if d2 < r * r {
        return Some(Wide::ONE);
    }
    let length = d2.sqrt();
    if s.abs() >= r {
        return Some((r * r * s / (d2 * length)).max(Wide::ZERO));
    }
    let (cos_t, sin_a, cos_a) = (s / length, r / length, (d2 - r * r).sqrt() / length);
    let sin_t = (1.0 - cos_t.squared()).sqrt();
    let w = (-(cos_t * cos_a / (sin_a * sin_t))).acos();
    let (sin_w, cos_w) = w.sin_cos();
    let (x, y) = ([sin_a * cos_w, sin_a * sin_w, cos_a], [sin_a * cos_w, -(sin_a * sin_w), cos_a]);
    let chord = dot(cross(x, y), [sin_t, Wide::ZERO, cos_t]).atan2(dot(x, y));
    let terms = [w * sin_a * sin_a * cos_t * 2.0, -(sin_w * sin_a * cos_a * sin_t * 2.0), chord];
    Some(Sum::of(&terms).kept()? / (Wide::PI * 2.0))
}

/// Lambert's sum over the edges of a closed polygon: what it adds to each axis.
fn lambert(corners: &[Vector]) -> [Vec<Wide>; 3] {
    let mut terms = [const { Vec::new() }; 3];
    for (i, a) in corners.iter().enumerate() {
        let b = corners[(i + 1) % corners.len()];
        let across = cross(*a, b);
        let sine = dot(across, across).sqrt();
        if sine > 0.0 {
            let angle = sine.atan2(dot(*a, b)) / (sine * Wide::PI * 2.0);
            for (terms, across) in terms.iter_mut().zip(across) {
                terms.push(angle * across);
            }
        }
    }
    terms
}

/// The part of a polygon above the horizon.
fn above(corners: &[Vector], n: Vector) -> Vec<Vector> {
    let mut cut = Vec::new();
    for (i, a) in corners.iter().enumerate() {
        let b = corners[(i + 1) % corners.len()];
        let (high, low) = (dot(*a, n), dot(b, n));
        if high > 0.0 {
            cut.push(*a);
        }
        if (high > 0.0) != (low > 0.0) {
            let share = high / (high - low);
            cut.push(core::array::from_fn(|k| a[k] + (b[k] - a[k]) * share));
        }
    }
    cut
}

fn polygon_exact(position: Vector, n: Vector, corners: &[Vector]) -> Option<Wide> {
    let seen: Vec<Vector> = corners.iter().map(|c| minus(*c, position)).collect();
    let terms = lambert(&above(&seen, n));
    if terms[0].is_empty() {
        return Some(Wide::ZERO);
    }
    let all: Vec<Wide> = (0..3).flat_map(|k| terms[k].iter().map(move |t| (k, *t))).map(|(k, t)| t * n[k]).collect();
    Sum::of(&all).kept().map(Wide::abs)
}

/// Rows of the table of 90-digit values in a precision: coordinates and factor.
fn each_row<R: Real>(gauge: &mut Gauge, name: &str, mut measure: impl FnMut(&mut Gauge, &[R], Wide)) {
    gauge.note("hard receivers of tests/data");
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("data").join(format!("factor_{name}.csv"));
    let text = std::fs::read_to_string(path).unwrap_or_default();
    let precision = if R::EPSILON.to_f64() < 1e-10 { "f64," } else { "f32," };
    let mut rows = 0;
    for line in text.lines().filter(|line| line.starts_with(precision)) {
        let cells: Vec<&str> = line.split(',').skip(2).collect();
        let Some((factor, numbers)) = cells.split_last() else { continue };
        let numbers: Vec<f64> = numbers.iter().map(|cell| cell.parse().unwrap_or(f64::NAN)).collect();
        gauge.special(&numbers);
        let numbers: Vec<R> = numbers.into_iter().map(R::from_f64).collect();
        measure(gauge, &numbers, Wide::decimal(factor));
        rows += 1;
    }
    gauge.require(rows >= 50);
}

fn vector<R: Real>(numbers: &[R], at: usize) -> [R; 3] {
    core::array::from_fn(|i| numbers.get(at + i).copied().unwrap_or_default())
}

fn angles(names: [&'static str; 2]) -> [Axis; 2] {
    let [polar, azimuth] = names;
    [Axis::linear(polar, 0.0, 3.14), Axis::linear(azimuth, -3.14, 3.14).list(&[0.0])]
}

/// A unit vector, before rounding.
fn direction<R: Real>(polar: R, azimuth: R) -> [R; 3] {
    [polar.sin() * azimuth.cos(), polar.sin() * azimuth.sin(), polar.cos()]
}

/// Disks and receivers in general position.
fn each_disk<R: Real>(gauge: &mut Gauge, mut measure: impl FnMut(&mut Gauge, &Disk<R>, &Receiver<R>)) {
    let [tilt, turn] = angles(["θ_N", "φ_N"]);
    let [polar, azimuth] = angles(["θ_n", "φ_n"]);
    let axes = [
        Axis::log("r", 1e-3, 1e3).edges(&[1.0]),
        Axis::log("h", 1e-3, 1e3).list(&[1.0]),
        Axis::log("a", 1e-3, 1e3).edges(&[1.0]),
        polar,
        azimuth,
        tilt,
        turn,
    ];
    gauge.note("radius r, receiver h before the disk's plane and a off its axis");
    gauge.each(&axes, |gauge, [r, h, a, polar, azimuth, tilt, turn]: [R; 7]| {
        let normal = direction(tilt, turn);
        let side = direction(tilt + R::PI * R::HALF, turn);
        let position = core::array::from_fn(|i| normal[i] * h + side[i] * a);
        let (disk, receiver) = (Disk::new([R::ZERO; 3], normal, r), Receiver::new(position, direction(polar, azimuth)));
        if let (Ok(disk), Ok(receiver)) = (disk, receiver) {
            measure(gauge, &disk, &receiver);
        }
    });
}

fn seen<R: Real>(disk: &Disk<R>, position: [R; 3]) -> Seen {
    Seen::new(wides(disk.centre()), wides(disk.normal()), wide(disk.radius()), wides(position))
}

/// The factor of a disk for a receiver, where the arithmetic serves.
pub(super) fn exact_factor<R: Real>(disk: &Disk<R>, receiver: &Receiver<R>) -> Option<Wide> {
    seen(disk, receiver.position()).factor(unit(wides(receiver.normal())))
}

/// Factors below this are out of the stated domain.
pub(super) fn least<R: Real>() -> f64 {
    if R::EPSILON.to_f64() < 1e-10 { 1e-60 } else { 1e-20 }
}

/// A disk, anywhere.
pub fn disk_configuration_factor<R: Real>(gauge: &mut Gauge) {
    each_row(gauge, "disk", |gauge, numbers: &[R], exact| {
        let disk = Disk::new(vector(numbers, 0), vector(numbers, 3), numbers[6]);
        let receiver = Receiver::new(vector(numbers, 7), vector(numbers, 10));
        let (Ok(disk), Ok(receiver)) = (disk, receiver) else { return gauge.require(false) };
        gauge.compare(ds::disk_configuration_factor(&disk, &receiver), exact);
    });
    each_disk(gauge, |gauge, disk: &Disk<R>, receiver| {
        if let Some(exact) = exact_factor(disk, receiver).filter(|f| *f == 0.0 || f.to_f64() > least::<R>()) {
            gauge.compare(ds::disk_configuration_factor(disk, receiver), exact);
        }
    });
}

/// The whole disk's vector.
pub fn disk_irradiance_vector<R: Real>(gauge: &mut Gauge) {
    each_disk(gauge, |gauge, disk: &Disk<R>, receiver| {
        let seen = seen(disk, receiver.position());
        if seen.height > 0.0 {
            let axes = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
            let exact = axes.map(|axis| seen.whole(axis.map(Wide::from)));
            gauge.compare_all(ds::disk_irradiance_vector(disk, receiver.position()), exact);
        }
    });
}

fn straight(radius: Wide, distance: Wide, offset: Wide) -> Seen {
    let normal = [0.0, 0.0, -1.0].map(Wide::from);
    Seen::new([Wide::ZERO, Wide::ZERO, distance], normal, radius, [offset, Wide::ZERO, Wide::ZERO])
}

fn lengths() -> [Axis; 3] {
    let axis = |name| Axis::log(name, 1e-4, 1e4).edges(&[1.0]);
    ["r", "h", "a"].map(axis)
}

/// (r² / (r² + h²)).
pub fn on_axis_disk_factor<R: Real>(gauge: &mut Gauge) {
    let ends = if R::EPSILON.to_f64() < 1e-10 { [1e-60, 1e60] } else { [1e-8, 1e8] };
    let axes = ["r", "h"].map(|name| Axis::log(name, ends[0], ends[1]).edges(&[1.0]));
    gauge.each(&axes, |gauge, [r, h]: [R; 2]| {
        let (a, b) = (wide(r), wide(h));
        gauge.compare(ds::on_axis_disk_factor(r, h), a.squared() / (a.squared() + b.squared()));
    });
}

/// An element in a parallel plane.
pub fn disk_parallel_factor<R: Real>(gauge: &mut Gauge) {
    gauge.each(&lengths(), |gauge, [r, h, a]: [R; 3]| {
        let exact = straight(wide(r), wide(h), wide(a)).whole([0.0, 0.0, 1.0].map(Wide::from));
        gauge.compare(ds::disk_parallel_factor(r, h, a), exact);
    });
}

/// An element in a perpendicular plane.
pub fn disk_perpendicular_factor<R: Real>(gauge: &mut Gauge) {
    gauge.each(&lengths(), |gauge, [r, h, a]: [R; 3]| {
        let exact = straight(wide(r), wide(h), wide(a)).factor([-1.0, 0.0, 0.0].map(Wide::from));
        if let Some(exact) = exact {
            gauge.compare(ds::disk_perpendicular_factor(r, h, a), exact);
        }
    });
}

/// A sphere, anywhere.
pub fn sphere_configuration_factor<R: Real>(gauge: &mut Gauge) {
    each_row(gauge, "sphere", |gauge, numbers: &[R], exact| {
        let sphere = Sphere::new(vector(numbers, 0), numbers[3]);
        let receiver = Receiver::new(vector(numbers, 4), vector(numbers, 7));
        let (Ok(sphere), Ok(receiver)) = (sphere, receiver) else { return gauge.require(false) };
        gauge.compare(ds::sphere_configuration_factor(&sphere, &receiver), exact);
    });
    let [polar, azimuth] = angles(["θ_n", "φ_n"]);
    let [tilt, turn] = angles(["θ", "φ"]);
    let axes = [Axis::log("r", 1e-2, 1e2), Axis::log("gap/r", 1e-4, 1e4).list(&[1.0]), polar, azimuth, tilt, turn];
    gauge.each(&axes, |gauge, [r, gap, polar, azimuth, tilt, turn]: [R; 6]| {
        let distance = r + r * gap;
        let position = direction(tilt, turn).map(|x| x * distance);
        let (sphere, receiver) = (Sphere::new([R::ZERO; 3], r), Receiver::new(position, direction(polar, azimuth)));
        let (Ok(sphere), Ok(receiver)) = (sphere, receiver) else { return gauge.require(false) };
        let exact = sphere_exact([Wide::ZERO; 3], wide(r), wides(position), unit(wides(receiver.normal())));
        if let Some(exact) = exact.filter(|f| *f == 0.0 || f.to_f64() > least::<R>()) {
            gauge.compare(ds::sphere_configuration_factor(&sphere, &receiver), exact);
        }
    });
}

/// Triangles and parallelograms before a receiver at the origin.
fn each_polygon<R: Real>(gauge: &mut Gauge, mut measure: impl FnMut(&mut Gauge, [R; 3], &[[R; 3]])) {
    let [polar, azimuth] = angles(["θ_n", "φ_n"]);
    let coordinate = |name| Axis::linear(name, -1.0, 1.0).list(&[0.0]);
    let axes = [
        Axis::log("size", 1e-2, 1e2),
        Axis::log("distance", 1e-2, 1e2),
        polar,
        azimuth,
        coordinate("x₁"),
        coordinate("y₁"),
        coordinate("z₁"),
        coordinate("x₂"),
        coordinate("y₂"),
        coordinate("z₂"),
    ];
    gauge.note("a triangle of two random sides times size");
    gauge.effort(2.0);
    gauge.each(&axes, |gauge, [size, distance, polar, azimuth, a, b, c, x, y, z]: [R; 10]| {
        let first = [R::ZERO, R::ZERO, distance];
        let corner = |v: [R; 3]| core::array::from_fn(|i| first[i] + size * v[i]);
        let corners = [first, corner([a, b, c]), corner([x, y, z])];
        // How near the receiver is to the triangle's plane, over the triangle's size: the stated domain.
        let [p, q, r] = corners.map(wides);
        let across = cross(minus(q, p), minus(r, p));
        let area = dot(across, across).sqrt();
        let reach = area.sqrt().to_f64().max(size.to_f64());
        let least = if R::EPSILON.to_f64() < 1e-10 { 1e-6 } else { 1e-3 };
        if (dot(across, p) / area).abs().to_f64() > least * reach {
            measure(gauge, direction(polar, azimuth), &corners);
        }
    });
}

/// A polygon, anywhere.
pub fn polygon_configuration_factor<R: Real>(gauge: &mut Gauge) {
    each_row(gauge, "polygon", |gauge, numbers: &[R], exact| {
        let corners: Vec<[R; 3]> = (2..numbers.len() / 3).map(|k| vector(numbers, 3 * k)).collect();
        let got = ds::polygon_configuration_factor(vector(numbers, 0), vector(numbers, 3), &corners);
        gauge.compare(got, exact);
    });
    each_polygon(gauge, |gauge, normal: [R; 3], corners| {
        let (seen, n): (Vec<Vector>, _) = (corners.iter().map(|c| wides(*c)).collect(), wides(normal));
        let got = ds::polygon_configuration_factor([R::ZERO; 3], normal, corners);
        // Of a normal whose length isn't quite 1 the factor is that much larger.
        if let Some(exact) = polygon_exact([Wide::ZERO; 3], n, &seen).filter(|f| *f == 0.0 || f.to_f64() > 1e-20) {
            gauge.compare(got, exact);
        }
    });
}

/// A whole polygon's vector.
pub fn polygon_irradiance_vector<R: Real>(gauge: &mut Gauge) {
    each_polygon(gauge, |gauge, _: [R; 3], corners| {
        let seen: Vec<Vector> = corners.iter().map(|c| wides(*c)).collect();
        let terms = lambert(&seen).map(|terms| Sum::of(&terms));
        let size = terms.iter().fold(0.0_f64, |m, sum| m.max(sum.1.to_f64()));
        let exact = [terms[0].0, terms[1].0, terms[2].0];
        let length = dot(exact, exact).sqrt().to_f64();
        // Towards the polygon.
        let forward = seen.iter().fold(Wide::ZERO, |sum, corner| sum + dot(exact, *corner));
        let exact = if forward < 0.0 { exact.map(|x| -x) } else { exact };
        if length * CANCELLATION > size && length > 1e-20 {
            gauge.compare_all(ds::polygon_irradiance_vector([R::ZERO; 3], corners), exact);
        }
    });
}

fn sides() -> [Axis; 3] {
    ["a", "b", "h"].map(|name| Axis::log(name, 1e-4, 1e4).edges(&[1.0]))
}

/// CIE 171:2006: 1/(2π) (X/√(1+X²) arctan(Y/√(1+X²)) + Y/√(1+Y²) arctan(X/√(1+Y²))).
pub fn rectangle_parallel_factor<R: Real>(gauge: &mut Gauge) {
    gauge.each(&sides(), |gauge, [a, b, h]: [R; 3]| {
        let (x, y) = (wide(a) / wide(h), wide(b) / wide(h));
        let part = |x: Wide, y: Wide| {
            let root = (x.squared() + 1.0).sqrt();
            x / root * (y / root).atan()
        };
        gauge.compare(ds::rectangle_parallel_factor(a, b, h), (part(x, y) + part(y, x)) / (Wide::PI * 2.0));
    });
}

/// CIE 171:2006: 1/(2π) (arctan Y − 1/√(1+X²) arctan(Y/√(1+X²))).
pub fn rectangle_perpendicular_factor<R: Real>(gauge: &mut Gauge) {
    gauge.each(&sides(), |gauge, [a, b, h]: [R; 3]| {
        let (x, y) = (wide(a) / wide(h), wide(b) / wide(h));
        let root = (x.squared() + 1.0).sqrt();
        let sum = Sum::of(&[y.atan(), -((y / root).atan() / root)]);
        if let Some(difference) = sum.kept() {
            gauge.compare(ds::rectangle_perpendicular_factor(a, b, h), difference / (Wide::PI * 2.0));
        }
    });
}
