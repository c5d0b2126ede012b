//! Disk lights: shapes, maps, partitions, configuration factors and estimates.

use core::hint::black_box;

use disk_sampling as disk;
use disk_sampling::estimate::{Panel, Request, Response, integrate, ratio, ratio_of_parts};
use disk_sampling::partition::{Label, Method, Partition, Side, Subsource};
use disk_sampling::{Disk, Receiver, Sphere};
use spectral_core::Real;

use crate::Run;

/// A disk above the floor, tilted.
fn disk<R: Real>(run: &mut Run) -> Option<Disk<R>> {
    let (centre, normal) = ([run.within(-1.0, 1.0), run.within(-1.0, 1.0), run.within(0.0, 3.0)], run.direction(false));
    Disk::new(centre, normal, run.within(-0.02, 1.5)).ok()
}

/// A receiver near the floor.
fn receiver<R: Real>(run: &mut Run) -> Option<Receiver<R>> {
    let (position, normal) = (run.array(-1.0, 1.0), run.direction(false));
    Receiver::new(position, normal).ok()
}

/// One of the methods.
fn method(run: &mut Run) -> Method {
    Method::ALL.get(run.index(4)).copied().unwrap_or(Method::Square)
}

/// Any part of a disk.
fn label(run: &mut Run, method: Method) -> Label {
    let mut label = Label::root(method);
    for _ in 0..run.below(20) {
        let number = run.byte();
        label = label.child(number).unwrap_or(label);
    }
    label
}

fn put_label(run: &mut Run, label: Label) {
    run.put_bits(u64::from(label.path()) | u64::from(label.level()) << 32 | (label.sector() as u64) << 40);
}

/// An estimate of a light with a lobe and, half of the time, an edge of shadow.
fn put_estimate<R: Real>(run: &mut Run, has_exact: bool) {
    let (found, at) = (disk::<R>(run), receiver(run));
    let (Some(light), Some(receiver)) = (found, at) else { return };
    let mut panels = [Panel::default(); 8];
    let room = run.index(9);
    let panels = panels.get_mut(..room).unwrap_or_default();
    let request = black_box(Request { relative_error: R::from_f64(0.05), max_samples: 60, strata: 1 });
    let edge = run.within::<R>(-1.0, 3.0);
    let respond = |aim: &disk_sampling::estimate::Aim<R>| Response {
        emission: aim.cosine,
        visibility: if aim.on_disk[0] < edge { R::ONE } else { R::ZERO },
    };
    let exact = disk::disk_configuration_factor(&light, &receiver);
    let found = run.time_call(|| {
        if has_exact {
            ratio(&light, &receiver, exact, &request, panels, respond)
        } else {
            integrate(&light, &receiver, &request, panels, respond)
        }
    });
    run.put_option(found.ok(), |run, found| {
        run.put_all(&[found.value, found.error]);
        run.put_bits(found.samples as u64 + ((found.status as u64) << 32));
    });
}

entries! {
    shape_disk 24 [
        "shape::Disk::new", "shape::Disk::centre", "shape::Disk::normal", "shape::Disk::radius", "shape::Disk::point",
        "shape::Disk::local", "shape::Disk::direction", "shape::Disk::frame", "shape::Receiver::new",
        "shape::Receiver::position", "shape::Receiver::normal", "shape::Sphere::new", "shape::Sphere::centre",
        "shape::Sphere::radius",
    ] |run, R| {
        let (centre, normal, radius) = (run.array(-2.0, 2.0), run.array(-1.0, 1.0), run.within::<R>(-0.1, 2.0));
        let found = run.time_call(|| Disk::new(centre, normal, radius));
        run.put_option(found.ok(), |run, disk| {
            for vector in [disk.centre(), disk.normal(), disk.point([R::HALF, -R::HALF]), disk.local(normal)] {
                run.put_all(&vector);
            }
            run.put_all(&disk.direction(centre));
            run.put_all(disk.frame().as_flattened());
            run.put(disk.radius());
        });
        run.put_option(Receiver::new(centre, normal).ok(), |run, receiver| {
            run.put_all(&receiver.position());
            run.put_all(&receiver.normal());
        });
        run.put_option(Sphere::new(centre, radius).ok(), |run, sphere| {
            run.put_all(&sphere.centre());
            run.put(sphere.radius());
        });
    }
    map_concentric 24 ["map::square_to_disk", "map::square_to_disk_pdf", "map::disk_to_square"] |run, R| {
        let point = run.array::<R, 2>(0.0, 1.0);
        let mapped = run.time_call(|| disk::square_to_disk(point));
        run.put_all(&mapped);
        run.put_all(&disk::disk_to_square(mapped));
        let point = run.array::<R, 2>(-1.0, 1.0);
        run.put(disk::square_to_disk_pdf(point));
    }
    map_polar 24 [
        "map::square_to_disk_polar", "map::square_to_disk_polar_pdf", "map::disk_to_square_polar",
    ] |run, R| {
        let point = run.array::<R, 2>(0.0, 1.0);
        let mapped = run.time_call(|| disk::square_to_disk_polar(point));
        run.put_all(&mapped);
        run.put_all(&disk::disk_to_square_polar(mapped));
        let point = run.array::<R, 2>(-1.0, 1.0);
        run.put(disk::square_to_disk_polar_pdf(point));
    }
    map_elliptical 24 [
        "map::square_to_disk_elliptical", "map::square_to_disk_elliptical_pdf", "map::disk_to_square_elliptical",
    ] |run, R| {
        let point = run.array::<R, 2>(0.0, 1.0);
        let mapped = run.time_call(|| disk::square_to_disk_elliptical(point));
        run.put_all(&mapped);
        run.put_all(&disk::disk_to_square_elliptical(mapped));
        let point = run.array::<R, 2>(-1.0, 1.0);
        run.put(disk::square_to_disk_elliptical_pdf(point));
    }
    map_hexagonal 24 ["map::hexagon_to_disk", "map::hexagon_to_disk_pdf", "map::disk_to_hexagon"] |run, R| {
        let point = run.array::<R, 2>(-0.7, 0.7);
        let mapped = run.time_call(|| disk::hexagon_to_disk(point));
        run.put_all(&mapped);
        run.put_all(&disk::disk_to_hexagon(point));
        run.put(disk::hexagon_to_disk_pdf(point));
    }
    partition_label 48 [
        "partition::Label::root", "partition::Label::level", "partition::Label::sector", "partition::Label::path",
        "partition::Label::children", "partition::Label::child", "partition::Label::parent",
        "partition::Label::successor", "partition::Label::neighbour", "partition::Method::parts",
    ] |run, R| {
        let method = method(run);
        let label = label(run, method);
        put_label(run, label);
        run.put(R::from_usize(usize::from(label.children())));
        run.put_option(label.parent(), put_label);
        let side = Side::ALL.get(run.index(3)).copied().unwrap_or(Side::Zero);
        let next = run.time_call(|| (label.successor(), label.neighbour(side)));
        run.put_option(next.0, put_label);
        run.put_option(next.1, put_label);
        let depth = run.bits() >> run.below(32);
        run.put_bits(method.parts(depth));
    }
    partition_subsource 48 [
        "partition::Subsource::new", "partition::Subsource::position", "partition::Subsource::label",
        "partition::Subsource::weight", "partition::Subsource::extent", "partition::Subsource::hits",
        "partition::Subsource::sample", "partition::Subsource::cubature",
    ] |run, R| {
        let (method, other) = (method(run), method(run));
        let label = label(run, other);
        let part = run.time_call(|| Subsource::<R>::new(method, label));
        run.put_all(&part.position());
        put_label(run, part.label());
        run.put_all(&[part.weight(), part.extent()]);
        let (jitter, random) = (run.unit(), run.array(0.0, 1.0));
        let (position, is_hit) = part.sample(jitter, random);
        run.put_all(&position);
        run.put_bits(u64::from(is_hit) + 2 * u64::from(part.hits()));
        let (position, weight) = part.cubature();
        run.put_all(&position);
        run.put(weight);
    }
    partition_cursor 8 [
        "partition::Partition::full", "partition::Partition::adaptive", "partition::Partition::write",
        "Iterator for Partition",
    ] |run, R| {
        let (method, depth, threshold) = (method(run), run.below(6), run.within(-0.05, 1.0));
        let position = run.array(-1.0, 2.0);
        let mut buffer = [Subsource::<R>::new(method, Label::root(method)); 24];
        let light = disk::<R>(run);
        run.put_option(light, |run, disk| {
            let parts = Partition::adaptive(method, depth, &disk, position, threshold);
            run.put_option(parts.ok(), |run, parts| run.put_bits(parts.count() as u64));
            let parts = Partition::full(method, depth);
            run.put_option(parts.ok(), |run, parts| {
                let written = run.time_call(|| parts.write(&mut buffer));
                run.put_option(written.ok(), |run, written| {
                    run.put_bits(written as u64);
                    run.put_option(buffer.get(..written), |run, parts| {
                        for part in parts {
                            run.put_all(&part.position());
                        }
                    });
                });
            });
        });
    }
    factor_disk 32 ["configuration_factor::disk_configuration_factor"] |run, R| {
        let (disk, receiver) = (disk::<R>(run), receiver(run));
        run.put_option(disk.zip(receiver), |run, (disk, receiver)| {
            let factor = run.time_call(|| disk::disk_configuration_factor(&disk, &receiver));
            run.put(factor);
        });
    }
    factor_disk_vector 24 ["configuration_factor::disk_irradiance_vector"] |run, R| {
        let (disk, position) = (disk::<R>(run), run.array(-1.0, 1.0));
        run.put_option(disk, |run, disk| {
            let vector = run.time_call(|| disk::disk_irradiance_vector(&disk, position));
            run.put_all(&vector);
        });
    }
    factor_disk_special 24 [
        "configuration_factor::on_axis_disk_factor", "configuration_factor::disk_parallel_factor",
        "configuration_factor::disk_perpendicular_factor",
    ] |run, R| {
        let (radius, distance, offset) = (run.within::<R>(0.0, 2.0), run.within(0.01, 3.0), run.within(0.0, 3.0));
        let on_axis = run.time_call(|| disk::on_axis_disk_factor(radius, distance));
        run.put_all(&[on_axis, disk::disk_parallel_factor(radius, distance, offset)]);
        run.put(disk::disk_perpendicular_factor(radius, distance, offset));
    }
    factor_sphere 24 ["configuration_factor::sphere_configuration_factor"] |run, R| {
        let sphere = Sphere::new(run.array(-1.0, 1.0), run.within::<R>(0.0, 1.0)).ok();
        let receiver = receiver(run);
        run.put_option(sphere.zip(receiver), |run, (sphere, receiver)| {
            let factor = run.time_call(|| disk::sphere_configuration_factor(&sphere, &receiver));
            run.put(factor);
        });
    }
    factor_rectangle 24 [
        "configuration_factor::rectangle_parallel_factor", "configuration_factor::rectangle_perpendicular_factor",
    ] |run, R| {
        let [a, b, h] = run.array::<R, 3>(0.0, 2.0);
        let factor = run.time_call(|| disk::rectangle_parallel_factor(a, b, h));
        run.put_all(&[factor, disk::rectangle_perpendicular_factor(a, b, h)]);
    }
    factor_polygon 24 [
        "configuration_factor::polygon_configuration_factor", "configuration_factor::polygon_irradiance_vector",
    ] |run, R| {
        let corners: [[R; 3]; 5] = core::array::from_fn(|_| run.array(-1.0, 1.0));
        let (point, normal, count) = (run.array(-1.0, 1.0), run.direction(false), run.index(6));
        let corners = corners.get(..count).unwrap_or_default();
        let factor = run.time_call(|| disk::polygon_configuration_factor(point, normal, corners));
        run.put(factor);
        run.put_all(&disk::polygon_irradiance_vector(point, corners));
    }
    estimate_integrate 4 ["estimate::integrate"] |run, R| {
        put_estimate::<R>(run, false);
    }
    estimate_ratio 4 ["estimate::ratio"] |run, R| {
        put_estimate::<R>(run, true);
    }
    estimate_ratio_of_parts 6 ["estimate::ratio_of_parts", "estimate::Response::unoccluded"] |run, R| {
        let (light, receiver, exact) = (disk::<R>(run), receiver::<R>(run), run.within(-0.02, 1.0));
        let (method, depth) = (method(run), run.below(5));
        run.put_option(light.zip(receiver), |run, (disk, receiver)| {
            let Ok(parts) = Partition::full(method, depth) else { return };
            let found = run.time_call(|| {
                ratio_of_parts(parts, &disk, &receiver, exact, |aim| Response::unoccluded(aim.cosine))
            });
            run.put_option(found.ok(), |run, (value, samples)| {
                run.put(value);
                run.put_bits(samples as u64);
            });
        });
    }
}
