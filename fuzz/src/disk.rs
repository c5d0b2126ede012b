//! Disk lights: subdivisions, maps, configuration factors, estimates.

use disk_sampling::partition::{Label, Method, Partition, PartitionError, Side, Subsource};
use disk_sampling::{
    Disk, Receiver, Sphere, disk_configuration_factor, disk_irradiance_vector, disk_parallel_factor,
    disk_perpendicular_factor, disk_to_hexagon, disk_to_square, disk_to_square_elliptical, disk_to_square_polar,
    hexagon_to_disk, on_axis_disk_factor, polygon_configuration_factor, rectangle_parallel_factor,
    rectangle_perpendicular_factor, sphere_configuration_factor, square_to_disk, square_to_disk_elliptical,
    square_to_disk_elliptical_pdf, square_to_disk_polar,
};
use spectral_core::Real;

use crate::numbers::{Numbers, assert_finite, assert_in};

/// Walks through the hierarchy of subdivisions, and lists parts for receivers made of the bytes.
pub fn partition(bytes: &[u8]) {
    let numbers = &mut Numbers::new(bytes);
    walk(numbers);
    list::<f64>(numbers);
    list::<f32>(numbers);
}

/// Maps between squares, hexagons and disks.
pub fn disk_map(bytes: &[u8]) {
    maps::<f64>(&mut Numbers::new(bytes));
    maps::<f32>(&mut Numbers::new(bytes));
}

/// Configuration factors of any shapes that are accepted.
pub fn factor(bytes: &[u8]) {
    factors::<f64>(&mut Numbers::new(bytes));
    factors::<f32>(&mut Numbers::new(bytes));
}

fn walk(numbers: &mut Numbers) {
    let method = Method::ALL[numbers.below(4)];
    let mut label = Label::root(method);
    for _ in 0..numbers.below(32) {
        let number = numbers.byte();
        let Some(child) = label.child(number) else { break };
        assert_eq!(child.parent(), Some(label));
        assert_eq!(child.level(), label.level() + 1);
        // The children follow one another, and the last one's successor is the parent's.
        let next =
            label.child(number % label.children() + 1).filter(|_| number % label.children() + 1 < label.children());
        assert_eq!(child.successor(), next.or_else(|| label.successor()));
        label = child;
    }
    for side in Side::ALL {
        if let Some(there) = label.neighbour(side) {
            assert_eq!(there.level(), label.level());
            // Corners 1 and 3 change places from sector to sector.
            let back = match side {
                Side::One if there.sector() != label.sector() => Side::Three,
                Side::Three if there.sector() != label.sector() => Side::One,
                _ => side,
            };
            assert_eq!(there.neighbour(back), Some(label), "{label:?} across {side:?}");
        }
    }
    let part = Subsource::<f64>::new(method, label);
    let (position, _) = part.sample(numbers.unit(), numbers.units());
    assert_finite(&position, "position");
    let most = if matches!(method, Method::EqualAreaHexagon | Method::MappedSquare) { 1.0 + 1e-12 } else { 1.6 };
    assert_in(position[0].hypot(position[1]), 0.0, most, "distance from the centre");
}

fn list<R: Real>(numbers: &mut Numbers) {
    let method = Method::ALL[numbers.below(4)];
    let depth = u32::from(numbers.byte() % 9);
    let Ok(disk) = Disk::new(numbers.any_vector::<R, 3>(), numbers.any_vector(), numbers.any()) else { return };
    let parts = match Partition::adaptive(method, depth, &disk, numbers.any_vector(), numbers.any()) {
        Ok(parts) => parts,
        Err(error) => return super::assert_one_line(&error.to_string()),
    };
    let (mut count, mut weight, mut before) = (0, 0.0, None);
    for part in parts.clone() {
        count += 1;
        weight += part.weight().to_f64();
        assert_finite(&part.position(), "position");
        // Each part begins where the one before it ended.
        let mut label = Some(part.label());
        if let Some(before) = before {
            let next = Label::successor(before);
            while label != next && label.is_some() {
                label = label.and_then(Label::parent);
            }
            assert!(label.is_some(), "{:?} after {before:?}", part.label());
        }
        before = Some(part.label());
    }
    assert!(count >= 1 && count <= method.parts(depth), "{count} parts");
    assert!((weight - 1.0).abs() <= 1e-5, "weights sum to {weight}");
    let mut buffer = vec![Subsource::new(method, Label::root(method)); numbers.below(65)];
    match parts.write(&mut buffer) {
        Ok(written) => assert_eq!(written as u64, count),
        Err(PartitionError::Buffer { needed }) => assert_eq!(needed, count),
        Err(error) => panic!("{error}"),
    }
}

fn maps<R: Real>(numbers: &mut Numbers) {
    let square: [R; 2] = numbers.units();
    let epsilon = R::EPSILON.to_f64();
    // The elliptical map has no derivative at the corners, and the polar one none at the centre.
    let back = |point: [R; 2], inverse: [R; 2], from: [R; 2], allowed: f64, what: &str| {
        assert_in(point[0].hypot(point[1]), 0.0, 1.0 + 4.0 * epsilon, what);
        for (a, b) in inverse.iter().zip(&from) {
            assert!((*a - *b).abs().to_f64() <= allowed, "{what}: {inverse:?} of {from:?}");
        }
    };
    let point = square_to_disk(square);
    back(point, disk_to_square(point), square, 8.0 * epsilon, "concentric");
    let point = square_to_disk_elliptical(square);
    back(point, disk_to_square_elliptical(point), square, 8.0 * epsilon.sqrt(), "elliptical");
    assert_in(square_to_disk_elliptical_pdf(point), 0.24, 1.0 / epsilon, "density");
    let point = square_to_disk_polar(square);
    assert_in(point[0].hypot(point[1]), 0.0, 1.0 + 4.0 * epsilon, "polar");
    assert_finite(&disk_to_square_polar(point), "polar");
    let hexagon = disk_to_hexagon(point);
    let again = hexagon_to_disk(hexagon);
    for (a, b) in again.iter().zip(&point) {
        assert!((*a - *b).abs().to_f64() <= 64.0 * epsilon, "hexagon: {again:?} of {point:?}");
    }
}

fn factors<R: Real>(numbers: &mut Numbers) {
    // Rounding is the only thing that may be above 1.
    let most = 1.0 + 16.0 * R::EPSILON.to_f64().sqrt();
    let corners: Vec<[R; 3]> = (0..numbers.below(8)).map(|_| numbers.vector_within(1e12)).collect();
    let place: [R; 3] = numbers.any_vector();
    let Ok(receiver) = Receiver::new(place, numbers.any_vector()) else { return };
    assert_in(disk_sampling_normal(&receiver), 1.0 - 1e-6, 1.0 + 1e-6, "length of a normal");
    if let Ok(disk) = Disk::new(numbers.any_vector(), numbers.any_vector(), numbers.any()) {
        assert_in(disk_configuration_factor(&disk, &receiver), 0.0, most, "disk");
        let vector = disk_irradiance_vector(&disk, receiver.position());
        assert!(vector.iter().all(|x| x.is_finite()), "{vector:?} of {disk:?} at {:?}", receiver.position());
    }
    if let Ok(sphere) = Sphere::new(numbers.any_vector(), numbers.any()) {
        assert_in(sphere_configuration_factor(&sphere, &receiver), 0.0, most, "sphere");
    }
    if place.iter().all(|x| x.abs().to_f64() <= 1e12) && is_flat_and_convex(&corners) {
        let found = polygon_configuration_factor(place, receiver.normal(), &corners);
        assert_in(found, 0.0, most, "polygon");
    }
    let [radius, distance, offset] = core::array::from_fn(|_| numbers.positive::<R>(15));
    assert_in(on_axis_disk_factor(radius, distance), 0.0, most, "on axis");
    assert_in(disk_parallel_factor(radius, distance, offset), 0.0, most, "parallel disk");
    assert_in(disk_perpendicular_factor(radius, distance, offset), 0.0, most, "perpendicular disk");
    let [a, b] = numbers.vector_within::<R, 2>(1e15);
    assert_in(rectangle_parallel_factor(a, b, distance), -0.2500001, 0.2500001, "parallel rectangle");
    assert_in(rectangle_perpendicular_factor(a, b, distance), -0.2500001, 0.2500001, "perpendicular rectangle");
}

/// The length of a receiver's normal.
fn disk_sampling_normal<R: Real>(receiver: &Receiver<R>) -> R {
    let [x, y, z] = receiver.normal();
    x.hypot(y).hypot(z)
}

/// Triangles always are; polygons of more corners are what they are given as, and bytes don't give such.
fn is_flat_and_convex<R>(corners: &[[R; 3]]) -> bool {
    corners.len() <= 3
}
