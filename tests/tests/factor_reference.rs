//! Configuration factors against 90-digit arithmetic at receivers that are hard to compute (independent).
#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "the input is constant; the errors found are of interest")]

extern crate alloc;

use alloc::collections::BTreeMap;
use std::path::Path;

use disk_sampling::{
    Disk, Receiver, Sphere, disk_configuration_factor, polygon_configuration_factor, polygon_irradiance_vector,
    sphere_configuration_factor,
};
use spectral_core::Real;

/// Largest relative error allowed.
const TOLERANCE_F64: f64 = 1e-12;
const TOLERANCE_F32: f64 = 1e-5;

struct Row {
    family: String,
    numbers: Vec<f64>,
    factor: f64,
}

fn rows(name: &str, precision: &str) -> Vec<Row> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("data").join(format!("factor_{name}.csv"));
    let text = std::fs::read_to_string(path).unwrap();
    let mut rows = Vec::new();
    for line in text.lines().filter(|line| !line.starts_with('#')) {
        let cells: Vec<&str> = line.split(',').collect();
        if cells[0] == precision {
            let mut numbers: Vec<f64> = cells[2..].iter().map(|cell| cell.parse().unwrap()).collect();
            let factor = numbers.pop().unwrap();
            rows.push(Row { family: cells[1].to_owned(), numbers, factor });
        }
    }
    rows
}

fn vectors<R: Real>(numbers: &[f64]) -> Vec<[R; 3]> {
    numbers.chunks(3).map(|v| core::array::from_fn(|i| R::from_f64(v[i]))).collect()
}

fn receiver<R: Real>(position: [R; 3], normal: [R; 3]) -> Receiver<R> {
    let receiver = Receiver::new(position, normal).unwrap();
    assert_eq!(receiver.normal(), normal, "normals of the table are those that are stored");
    receiver
}

fn disk<R: Real>(row: &Row) -> f64 {
    let (shape, seen) = (vectors(&row.numbers[..6]), vectors(&row.numbers[7..]));
    let disk = Disk::new(shape[0], shape[1], R::from_f64(row.numbers[6])).unwrap();
    assert_eq!(disk.normal(), shape[1]);
    disk_configuration_factor(&disk, &receiver(seen[0], seen[1])).to_f64()
}

fn sphere<R: Real>(row: &Row) -> f64 {
    let (centre, seen) = (vectors(&row.numbers[..3]), vectors(&row.numbers[4..]));
    let sphere = Sphere::new(centre[0], R::from_f64(row.numbers[3])).unwrap();
    sphere_configuration_factor(&sphere, &receiver(seen[0], seen[1])).to_f64()
}

fn polygon<R: Real>(row: &Row) -> f64 {
    let all = vectors::<R>(&row.numbers);
    polygon_configuration_factor(all[0], all[1], &all[2..]).to_f64()
}

/// Checks each row and prints the largest error of each family.
fn check(name: &str, precision: &str, families: usize, tolerance: f64, factor: impl Fn(&Row) -> f64) {
    let mut worst: BTreeMap<String, f64> = BTreeMap::new();
    let mut failures = Vec::new();
    for row in rows(name, precision) {
        let found = factor(&row);
        let error = if row.factor == 0.0 { found.abs() } else { (found / row.factor - 1.0).abs() };
        let entry = worst.entry(row.family.clone()).or_insert(0.0);
        *entry = entry.max(error);
        if !(error <= tolerance) {
            failures.push(format!("{} {:?}: {found:e}, not {:e}", row.family, row.numbers, row.factor));
        }
    }
    println!("{name} {precision}: {worst:?}");
    assert_eq!(worst.len(), families, "families in the table");
    assert!(failures.is_empty(), "{name} {precision}, tolerance {tolerance:e}:\n{}", failures.join("\n"));
}

#[test]
fn disks() {
    check("disk", "f64", 7, TOLERANCE_F64, disk::<f64>);
    check("disk", "f32", 7, TOLERANCE_F32, disk::<f32>);
}

#[test]
fn spheres() {
    check("sphere", "f64", 2, TOLERANCE_F64, sphere::<f64>);
    check("sphere", "f32", 2, TOLERANCE_F32, sphere::<f32>);
}

#[test]
fn polygons() {
    check("polygon", "f64", 7, TOLERANCE_F64, polygon::<f64>);
    check("polygon", "f32", 7, TOLERANCE_F32, polygon::<f32>);
}

/// The vector's component along a normal is the factor of a polygon above the horizon.
#[test]
fn polygon_vectors() {
    let mut whole = 0;
    for row in rows("polygon", "f64") {
        let all = vectors::<f64>(&row.numbers);
        let heights = all[2..].iter().map(|c| (0..3).map(|i| (c[i] - all[0][i]) * all[1][i]).sum::<f64>());
        if heights.fold(f64::INFINITY, f64::min) <= 0.0 {
            continue;
        }
        whole += 1;
        let vector = polygon_irradiance_vector(all[0], &all[2..]);
        let length = vector.iter().map(|x| x * x).sum::<f64>().sqrt();
        let found: f64 = vector.iter().zip(all[1]).map(|(v, n)| v * n).sum();
        assert!((found - row.factor).abs() <= TOLERANCE_F64 * length, "{} {found} {}", row.family, row.factor);
    }
    assert!(whole >= 10, "{whole}");
}
