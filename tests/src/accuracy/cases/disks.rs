//! Subdivisions of disks, and estimates of their illuminance.

use disk_sampling::estimate::{self, Aim, Panel, Request, Response};
use disk_sampling::partition::{Method, Partition, Subsource};
use disk_sampling::{Disk, Receiver, disk_configuration_factor};
use spectral_core::Real;

use super::factors::{exact_factor, least};
use super::maps::hexagonal;
use crate::accuracy::gauge::{Axis, Gauge};
use crate::accuracy::wide::{Wide, dot, wide, wides};

/// Parts of all depths of a method.
fn each_part<R: Real>(method: Method, mut each: impl FnMut(u32, Subsource<R>)) {
    for depth in 0..=10 {
        if let Ok(parts) = Partition::full(method, depth) {
            parts.for_each(|part| each(depth, part));
        }
    }
}

const DEPTHS: &str = "all parts of depths 0 to 10";

/// A part of a method as that of another one with the same label.
fn like<R: Real>(part: &Subsource<R>, method: Method) -> [Wide; 2] {
    wides(Subsource::<f64>::new(method, part.label()).position())
}

/// Centres: of squares from their places in the grid, of triangles from their children's, and both mapped.
pub fn position<R: Real>(gauge: &mut Gauge) {
    gauge.note(DEPTHS);
    for method in Method::ALL {
        each_part(method, |_, part: Subsource<R>| {
            let exact = match method {
                Method::MappedSquare => {
                    let unit = (Wide::PI.sqrt() * 0.5, Wide::ONE);
                    let [s, t] = like(&part, Method::Square).map(|x| x / unit.0);
                    let side = |x: Wide| (unit.1 - x.squared() * 0.5).sqrt();
                    [s * side(t), t * side(s)]
                }
                Method::EqualAreaHexagon if part.label().level() > 0 => hexagonal(like(&part, Method::Hexagon)),
                _ => centre(&part, method),
            };
            for (got, exact) in part.position().into_iter().zip(exact) {
                gauge.compare_to(got, exact, Wide::from(0.75));
            }
        });
    }
}

/// The mean of the children's centres, in `f64`.
fn centre<R: Real>(part: &Subsource<R>, method: Method) -> [Wide; 2] {
    let label = part.label();
    let children: Vec<_> = (0..label.children()).filter_map(|number| label.child(number)).collect();
    let mut sum = [Wide::ZERO; 2];
    for child in &children {
        for (sum, x) in sum.iter_mut().zip(wides(Subsource::<f64>::new(method, *child).position())) {
            *sum += x;
        }
    }
    sum.map(|x| x / children.len() as f64)
}

/// 1 over the number of parts.
pub fn weight<R: Real>(gauge: &mut Gauge) {
    gauge.note(DEPTHS);
    for method in Method::ALL {
        each_part(method, |depth, part: Subsource<R>| {
            gauge.compare(part.weight(), Wide::ONE / method.parts(depth) as f64);
        });
    }
}

/// The square's and the hexagon's sides.
pub fn extent<R: Real>(gauge: &mut Gauge) {
    gauge.note(DEPTHS);
    let side = (Wide::PI * 2.0 / (Wide::from(3.0).sqrt() * 3.0)).sqrt();
    for method in Method::ALL {
        each_part(method, |_, part: Subsource<R>| {
            let level = part.label().level();
            let halves = |n: u32| Wide::ONE / f64::from(1_u32 << n);
            let exact = match method {
                Method::Square | Method::MappedSquare => Wide::PI.sqrt() * halves(level / 2),
                _ if level == 0 => side * 2.0,
                _ => side * halves(level - 1),
            };
            gauge.compare(part.extent(), exact);
        });
    }
}

/// Jittered samples of squares: the centre plus what (½ − u, ½ − v) is of the sides.
pub fn sample<R: Real>(gauge: &mut Gauge) {
    gauge.note("squares of depths 0 to 10");
    each_part(Method::Square, |_, part: Subsource<R>| {
        let level = part.label().level();
        let [u, v, jitter] = [0; 3].map(|_| R::from_f64(gauge.rng().unit()));
        let centre = wides(Subsource::<f64>::new(Method::Square, part.label()).position());
        let side = |n: u32| Wide::PI.sqrt() / f64::from(1_u32 << n);
        let sides = [side(level.div_ceil(2)), side(level / 2)];
        let (found, _) = part.sample(jitter, [u, v]);
        for (i, random) in [u, v].into_iter().enumerate() {
            let exact = centre[i] + (0.5 - wide(random)) * wide(jitter) * sides[i];
            gauge.compare_to(found[i], exact, Wide::from(0.75));
        }
    });
}

/// A cubature of degree 8: means of 1, r² and r⁴, which are polynomials in the triangles' coordinates, too.
pub fn cubature<R: Real>(gauge: &mut Gauge) {
    gauge.note("means of 1, r² and r⁴ over full partitions of depths 5, 7 and 9");
    for depth in [5, 7, 9] {
        let Ok(parts) = Partition::<R>::full(Method::EqualAreaHexagon, depth) else { return gauge.require(false) };
        let mut means = [Wide::ZERO; 3];
        for part in parts {
            let (point, weight) = part.cubature();
            let [x, y] = wides(point);
            let square = x.squared() + y.squared();
            for (mean, value) in means.iter_mut().zip([Wide::ONE, square, square.squared()]) {
                *mean += value * wide(weight);
            }
        }
        for (mean, exact) in means.into_iter().zip([1.0, 1.0 / 2.0, 1.0 / 3.0]) {
            gauge.record((mean - exact).abs().to_f64());
        }
    }
}

/// Receivers before a disk of radius 1, some of them cut by their horizon.
fn each_receiver<R: Real>(gauge: &mut Gauge, mut measure: impl FnMut(&mut Gauge, &Disk<R>, &Receiver<R>, Wide)) {
    let axes = [
        Axis::log("h", 0.01, 100.0).list(&[1.0]),
        Axis::log("a", 0.01, 100.0).edges(&[1.0]),
        Axis::linear("θ_n", 0.0, 3.14),
        Axis::linear("φ_n", -3.14, 3.14),
    ];
    gauge.note("a disk of radius 1");
    gauge.effort(0.1);
    gauge.each(&axes, |gauge, [h, a, polar, azimuth]: [R; 4]| {
        let disk = Disk::new([R::ZERO; 3], [R::ZERO, R::ZERO, R::ONE], R::ONE);
        let normal = [polar.sin() * azimuth.cos(), polar.sin() * azimuth.sin(), polar.cos()];
        let receiver = Receiver::new([a, R::ZERO, h], normal);
        let (Ok(disk), Ok(receiver)) = (disk, receiver) else { return gauge.require(false) };
        if let Some(exact) = exact_factor(&disk, &receiver).filter(|f| f.to_f64() > least::<R>()) {
            measure(gauge, &disk, &receiver, exact);
        }
    });
}

fn request<R: Real>() -> Request<R> {
    Request { relative_error: R::from_f64(1e-3), max_samples: 10_000, strata: 1 }
}

/// Uniform light that nothing is in the way of: the closed form.
pub fn integrate<R: Real>(gauge: &mut Gauge) {
    let mut panels = vec![Panel::default(); 64];
    each_receiver(gauge, |gauge, disk: &Disk<R>, receiver, exact| {
        let respond = |_: &Aim<R>| Response::unoccluded(R::ONE);
        match estimate::integrate(disk, receiver, &request(), &mut panels, respond) {
            Ok(found) => gauge.compare(found.value, exact),
            Err(_) => gauge.require(false),
        }
    });
}

/// Light of any emission, half of which arrives everywhere.
pub fn ratio<R: Real>(gauge: &mut Gauge) {
    let mut panels = vec![Panel::default(); 64];
    each_receiver(gauge, |gauge, disk: &Disk<R>, receiver, exact| {
        let respond = |aim: &Aim<R>| Response { emission: R::ONE + aim.cosine, visibility: R::HALF };
        let closed = disk_configuration_factor(disk, receiver);
        match estimate::ratio(disk, receiver, closed, &request(), &mut panels, respond) {
            Ok(found) => gauge.compare(found.value, exact * 0.5),
            Err(_) => gauge.require(false),
        }
    });
}

/// exact · Σ w k f V/Σ w k f, with half of the disk in shadow.
pub fn ratio_of_parts<R: Real>(gauge: &mut Gauge) {
    each_receiver(gauge, |gauge, disk: &Disk<R>, receiver, _| {
        let shadow = |[x, y]: [R; 2]| if x + y > R::ZERO { R::ONE } else { R::from_f64(0.25) };
        let respond = |aim: &Aim<R>| Response { emission: R::ONE, visibility: shadow(aim.on_disk) };
        let parts = || Partition::<R>::full(Method::EqualAreaHexagon, 5);
        let (Ok(mine), Ok(theirs)) = (parts(), parts()) else { return gauge.require(false) };
        let (n, p) = (wides(receiver.normal()), wides(receiver.position()));
        let (mut lit, mut full, mut clear) = (Wide::ZERO, Wide::ZERO, true);
        for part in mine {
            let point = wides(disk.point(part.position()));
            let way: [Wide; 3] = core::array::from_fn(|i| point[i] - p[i]);
            let square = dot(way, way);
            let (towards, height) = (dot(n, way), dot(wides(disk.normal()), way.map(|x| -x)));
            // A part within rounding of the horizon may count or not.
            clear &= towards.abs().to_f64() > 1e3 * R::EPSILON.to_f64() * square.sqrt().to_f64();
            if towards > 0.0 {
                let kernel = wide(part.weight()) * towards * height / square.squared();
                full += kernel;
                lit += kernel * wide(shadow(part.position()));
            }
        }
        match estimate::ratio_of_parts(theirs, disk, receiver, R::ONE, respond) {
            Ok((found, _)) if clear && full > 0.0 => gauge.compare(found, lit / full),
            found => gauge.require(found.is_ok()),
        }
    });
}
