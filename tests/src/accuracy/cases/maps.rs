//! Maps between square, hexagon and disk.

use disk_sampling as ds;
use spectral_core::Real;

use crate::accuracy::gauge::{Axis, Gauge};
use crate::accuracy::wide::{Wide, wide, wides};

fn square() -> [Axis; 2] {
    ["u", "v"].map(|name| Axis::linear(name, 0.0, 1.0).edges(&[0.5]).list(&[0.25, 0.75, 1e-9]))
}

/// Points of the disk, from a radius and an angle: those that rounding puts outside are left out.
fn each_of_disk<R: Real>(gauge: &mut Gauge, mut measure: impl FnMut(&mut Gauge, [R; 2])) {
    let eighth = core::f64::consts::FRAC_PI_4;
    let axes = [
        Axis::linear("r", 0.0, 1.0).list(&[1e-9, 0.5]),
        Axis::linear("φ", -core::f64::consts::PI, core::f64::consts::PI).edges(&[0.0, eighth, 2.0 * eighth, -eighth]),
    ];
    gauge.each(&axes, |gauge, [r, angle]: [R; 2]| {
        let point = [r * angle.cos(), r * angle.sin()];
        let [x, y] = wides(point);
        if x.squared() + y.squared() <= 1.0 {
            measure(gauge, point);
        }
    });
}

/// A point as radius and angle in turns.
fn at(radius: Wide, turns: Wide) -> [Wide; 2] {
    let (sin, cos) = (turns * 2.0 * Wide::PI).sin_cos();
    [radius * cos, radius * sin]
}

fn compare<R: Real>(gauge: &mut Gauge, got: [R; 2], exact: [Wide; 2]) {
    for (got, exact) in got.into_iter().zip(exact) {
        gauge.compare_to(got, exact, Wide::from(0.75));
    }
}

/// Shirley and Chiu 1997.
fn concentric([u, v]: [Wide; 2]) -> [Wide; 2] {
    let (x, y) = (u * 2.0 - 1.0, v * 2.0 - 1.0);
    if x == 0.0 && y == 0.0 {
        return [Wide::ZERO; 2];
    }
    if x.abs() > y.abs() { at(x, y / x / 8.0) } else { at(y, 0.25 - x / y / 8.0) }
}

/// The concentric map.
pub fn square_to_disk<R: Real>(gauge: &mut Gauge) {
    gauge.each(&square(), |gauge, uv: [R; 2]| compare(gauge, ds::square_to_disk(uv), concentric(wides(uv))));
}

/// Its inverse: the radius is along the larger coordinate, the angle within the quarter along the other.
pub fn disk_to_square<R: Real>(gauge: &mut Gauge) {
    each_of_disk(gauge, |gauge, point: [R; 2]| {
        let [x, y] = wides(point);
        let radius = x.hypot(y);
        let share = |across: Wide, along: Wide| across.atan2(along) / (Wide::PI / 4.0);
        let [a, b] = if x.abs() > y.abs() {
            let side = if x < 0.0 { -radius } else { radius };
            [side, radius * share(y, x.abs())]
        } else if y == 0.0 {
            [Wide::ZERO; 2]
        } else {
            let side = if y < 0.0 { -radius } else { radius };
            [radius * share(x, y.abs()), side]
        };
        compare(gauge, ds::disk_to_square(point), [(a + 1.0) * 0.5, (b + 1.0) * 0.5]);
    });
}

/// √u, 2πv.
pub fn square_to_disk_polar<R: Real>(gauge: &mut Gauge) {
    gauge.each(&square(), |gauge, uv: [R; 2]| {
        let [u, v] = wides(uv);
        compare(gauge, ds::square_to_disk_polar(uv), at(u.sqrt(), v));
    });
}

/// x² + y² and the angle in turns.
pub fn disk_to_square_polar<R: Real>(gauge: &mut Gauge) {
    each_of_disk(gauge, |gauge, point: [R; 2]| {
        let [x, y] = wides(point);
        let turn = y.atan2(x) / (Wide::PI * 2.0);
        let v = if turn < 0.0 { turn + 1.0 } else { turn };
        let got = ds::disk_to_square_polar(point);
        // Next to the axis v may be that of the other side.
        let v = if got[1] == R::ZERO && v > 0.5 { v - 1.0 } else { v };
        compare(gauge, got, [x.squared() + y.squared(), v]);
    });
}

/// (s √(1 − t²/2), t √(1 − s²/2)).
pub fn square_to_disk_elliptical<R: Real>(gauge: &mut Gauge) {
    gauge.each(&square(), |gauge, uv: [R; 2]| {
        let [s, t] = wides(uv).map(|x| x * 2.0 - 1.0);
        let side = |x: Wide| (1.0 - x.squared() * 0.5).sqrt();
        compare(gauge, ds::square_to_disk_elliptical(uv), [s * side(t), t * side(s)]);
    });
}

/// (s², t²) of a point of the disk. With d = x² − y² = s² − t² and m = s² + t², x² + y² = m − (m² − d²)/4, and so
/// m = 2 − √(4 + d² − 4 (x² + y²)), without the difference; the smaller one from x² = s² (1 − t²/2).
fn squares([x, y]: [Wide; 2]) -> [Wide; 2] {
    if y.abs() < x.abs() {
        let [t2, s2] = squares([y, x]);
        return [s2, t2];
    }
    let (p, d) = (x.squared() + y.squared(), x.squared() - y.squared());
    let root = (4.0 + d.squared() - p * 4.0).max(Wide::ZERO).sqrt();
    let t2 = ((p * 4.0 - d.squared()) / (root + 2.0) - d) * 0.5;
    [x.squared() / (1.0 - t2 * 0.5), t2]
}

/// Points of the disk away from the four where the map's corners are: there s has the error of a square root.
fn each_inside<R: Real>(gauge: &mut Gauge, mut measure: impl FnMut(&mut Gauge, [R; 2], [Wide; 2])) {
    gauge.note("but for 0.05 about the images of the square's corners");
    each_of_disk(gauge, |gauge, point: [R; 2]| {
        let [x, y] = point.map(|x| x.to_f64().abs() - core::f64::consts::FRAC_1_SQRT_2);
        if x.hypot(y) > 0.05 {
            measure(gauge, point, squares(wides(point)));
        }
    });
}

/// The inverse of the elliptical map.
pub fn disk_to_square_elliptical<R: Real>(gauge: &mut Gauge) {
    each_inside(gauge, |gauge, point: [R; 2], [s2, t2]| {
        let [x, y] = wides(point);
        let signed = |square: Wide, like: Wide| {
            let root = square.max(Wide::ZERO).sqrt();
            if like < 0.0 { -root } else { root }
        };
        let exact = [signed(s2, x), signed(t2, y)].map(|s| (s + 1.0) * 0.5);
        compare(gauge, ds::disk_to_square_elliptical(point), exact);
    });
}

/// 1 over the Jacobian's determinant.
pub fn square_to_disk_elliptical_pdf<R: Real>(gauge: &mut Gauge) {
    each_inside(gauge, |gauge, point: [R; 2], [s2, t2]| {
        let ab = ((1.0 - t2 * 0.5) * (1.0 - s2 * 0.5)).sqrt();
        let exact = 1.0 / ((ab - s2 * t2 / (ab * 4.0)) * 4.0);
        gauge.compare_to(ds::square_to_disk_elliptical_pdf(point), exact, exact / (1.0 - (s2 + t2) * 0.5));
    });
}

fn uniform<R: Real>(gauge: &mut Gauge, function: impl Fn([R; 2]) -> R) {
    each_of_disk(gauge, |gauge, point: [R; 2]| gauge.compare(function(point), 1.0 / Wide::PI));
    gauge.require(function([R::ONE, R::ONE]) == R::ZERO && function([R::from_f64(1.001), R::ZERO]) == R::ZERO);
}

/// 1/π.
pub fn square_to_disk_pdf<R: Real>(gauge: &mut Gauge) {
    uniform::<R>(gauge, ds::square_to_disk_pdf);
}

/// 1/π.
pub fn square_to_disk_polar_pdf<R: Real>(gauge: &mut Gauge) {
    uniform::<R>(gauge, ds::square_to_disk_polar_pdf);
}

/// 1/π.
pub fn hexagon_to_disk_pdf<R: Real>(gauge: &mut Gauge) {
    uniform::<R>(gauge, ds::hexagon_to_disk_pdf);
}

/// √(2π/(3√3)): a regular hexagon of this side has the area π.
fn side() -> Wide {
    (Wide::PI * 2.0 / (Wide::from(3.0).sqrt() * 3.0)).sqrt()
}

/// Ring and place along the ring's edge of a point of the plane: by its angle, and its distance along the edge's normal.
pub(super) fn hexagonal([x, y]: [Wide; 2]) -> [Wide; 2] {
    if x == 0.0 && y == 0.0 {
        return [Wide::ZERO; 2];
    }
    let sixth = Wide::PI / 3.0;
    let turn = y.atan2(x) / sixth;
    let turn = if turn < 0.0 { turn + 6.0 } else { turn };
    let sector = turn.to_f64().floor();
    // The edge's normal is at 30° + 60° sector.
    let (sin, cos) = (sixth * (sector + 0.5)).sin_cos();
    let apothem = side() * Wide::from(3.0).sqrt() * 0.5;
    let ring = (x * cos + y * sin) / apothem;
    let along = (y * cos - x * sin) / (side() * ring) + 0.5;
    at(ring, (along + sector) / 6.0)
}

/// The map of the hexagon.
pub fn hexagon_to_disk<R: Real>(gauge: &mut Gauge) {
    let inside = 0.95;
    let axes = ["x", "y"].map(|name| Axis::linear(name, -inside, inside).edges(&[0.0]).list(&[1e-9, 0.5]));
    gauge.note("within the apothem, 0.95");
    gauge.each(&axes, |gauge, point: [R; 2]| {
        let [x, y] = point.map(R::to_f64);
        if x.hypot(y) <= inside {
            compare(gauge, ds::hexagon_to_disk(point), hexagonal(wides(point)));
        }
    });
}

/// Its inverse.
pub fn disk_to_hexagon<R: Real>(gauge: &mut Gauge) {
    each_of_disk(gauge, |gauge, point: [R; 2]| {
        let [x, y] = wides(point);
        let (radius, sixth) = (x.hypot(y), Wide::PI / 3.0);
        let turn = y.atan2(x) / sixth;
        let turn = if turn < 0.0 { turn + 6.0 } else { turn };
        let sector = turn.to_f64().floor();
        let corner = |index: f64| at(side(), Wide::from(index) / 6.0);
        let (a, b, along) = (corner(sector), corner(sector + 1.0), turn - sector);
        let exact = core::array::from_fn(|i| radius * (a[i] + (b[i] - a[i]) * along));
        compare(gauge, ds::disk_to_hexagon(point), exact);
    });
}

/// Scalars of the disk's frame.
fn disk<R: Real>(values: [R; 7]) -> Option<ds::Disk<R>> {
    let [a, b, c, x, y, z, r] = values;
    ds::Disk::new([a, b, c], [x, y, z], r).ok()
}

fn disks() -> [Axis; 7] {
    let coordinate = |name| Axis::linear(name, -5.0, 5.0).list(&[0.0, 1.0]);
    let normal = |name| Axis::linear(name, -1.0, 1.0).list(&[0.0]);
    let [a, b, c] = ["c₁", "c₂", "c₃"].map(coordinate);
    let [x, y, z] = ["N₁", "N₂", "N₃"].map(normal);
    [a, b, c, x, y, z, Axis::log("r", 0.01, 10.0)]
}

/// Lengths of the normal and its direction.
pub fn disk_normal<R: Real>(gauge: &mut Gauge) {
    gauge.each(&disks(), |gauge, values: [R; 7]| {
        let Some(disk) = disk(values) else { return };
        let [.., x, y, z, _] = wides(values);
        let length = (x.squared() + y.squared() + z.squared()).sqrt();
        for (got, exact) in disk.normal().into_iter().zip([x, y, z]) {
            gauge.compare_to(got, exact / length, Wide::from(0.75));
        }
    });
}

/// How far the frame is from orthonormal.
pub fn disk_frame<R: Real>(gauge: &mut Gauge) {
    gauge.each(&disks(), |gauge, values: [R; 7]| {
        let Some(disk) = disk(values) else { return };
        let ([u, v], n) = (disk.frame().map(wides), wides(disk.normal()));
        let dot = crate::accuracy::wide::dot;
        for (product, exact) in
            [(dot(u, u), 1.0), (dot(v, v), 1.0), (dot(u, v), 0.0), (dot(u, n), 0.0), (dot(v, n), 0.0)]
        {
            gauge.record((product - exact).abs().to_f64() / R::EPSILON.to_f64());
        }
    });
}

/// Points by the frame that the disk states, in units of the coordinates' size.
pub fn disk_point<R: Real>(gauge: &mut Gauge) {
    gauge.each(&disks(), |gauge, values: [R; 7]| {
        let Some(disk) = disk(values) else { return };
        let place = [R::from_f64(0.6), R::from_f64(-0.7)];
        let ([x, y], [u, v], c) = (wides(place), disk.frame().map(wides), wides(disk.centre()));
        for i in 0..3 {
            let offset = wide(disk.radius()) * (x * u[i] + y * v[i]);
            gauge.compare_to(disk.point(place)[i], c[i] + offset, c[i].abs() + wide(disk.radius()));
        }
    });
}

/// The same, back.
pub fn disk_local<R: Real>(gauge: &mut Gauge) {
    let dot = crate::accuracy::wide::dot;
    gauge.each(&disks(), |gauge, values: [R; 7]| {
        let Some(disk) = disk(values) else { return };
        let point = [1.5, -2.0, 0.25].map(R::from_f64);
        let (c, p, r) = (wides(disk.centre()), wides(point), wide(disk.radius()));
        let offset: [Wide; 3] = core::array::from_fn(|i| p[i] - c[i]);
        let size = (dot(offset, offset)).sqrt() / r;
        let [u, v] = disk.frame();
        for (got, axis) in disk.local(point).into_iter().zip([u, v, disk.normal()]) {
            gauge.compare_to(got, dot(offset, wides(axis)) / r, size);
        }
    });
}

/// A direction in the disk's frame.
pub fn disk_direction<R: Real>(gauge: &mut Gauge) {
    let dot = crate::accuracy::wide::dot;
    gauge.each(&disks(), |gauge, values: [R; 7]| {
        let Some(disk) = disk(values) else { return };
        let direction = [0.36, -0.48, 0.8].map(R::from_f64);
        let [u, v] = disk.frame();
        for (got, axis) in disk.direction(direction).into_iter().zip([u, v, disk.normal()]) {
            gauge.compare_to(got, dot(wides(direction), wides(axis)), Wide::from(0.75));
        }
    });
}
