//! Time of the closed forms, by the way they are computed: whole lights, cut lights in closed form, and slivers by integration.
#![allow(missing_docs, reason = "a benchmark")]
#![allow(clippy::unwrap_used, reason = "the input is constant")]

use disk_sampling::{
    Disk, Receiver, Sphere, disk_configuration_factor, disk_irradiance_vector, polygon_configuration_factor,
    rectangle_parallel_factor, sphere_configuration_factor,
};
use divan::{Bencher, black_box};
use spectral_core::Real;

fn main() {
    divan::main();
}

fn vector<R: Real>(v: [f64; 3]) -> [R; 3] {
    v.map(R::from_f64)
}

fn receiver<R: Real>(position: [f64; 3], normal: [f64; 3]) -> Receiver<R> {
    Receiver::new(vector(position), vector(normal)).unwrap()
}

fn disk<R: Real>() -> Disk<R> {
    Disk::new(vector([0.0; 3]), vector([0.0, 0.0, 1.0]), R::ONE).unwrap()
}

/// Name, position and normal of a receiver of the disk of radius 1 at the origin.
const DISK: [(&str, [f64; 3], [f64; 3]); 5] = [
    ("behind", [0.3, 0.2, -1.0], [0.0, 0.0, 1.0]),
    ("whole", [1.3, 0.2, 1.5], [-0.3, 0.1, -1.0]),
    ("cut", [1.3, 0.2, 1.0], [1.0, 0.1, -0.7]),
    ("cut_far", [13.0, 2.0, 30.0], [30.0, 0.5, -12.8]),
    ("contact", [0.999, 0.0, 0.001], [0.9, 0.02, -0.01]),
];

#[divan::bench(types = [f32, f64], args = DISK.map(|case| case.0))]
fn disk_factor<R: Real>(bencher: Bencher, name: &str) {
    let (_, position, normal) = DISK.into_iter().find(|case| case.0 == name).unwrap();
    let (disk, receiver) = (disk::<R>(), receiver::<R>(position, normal));
    bencher.bench_local(|| disk_configuration_factor(black_box(&disk), black_box(&receiver)));
}

#[divan::bench(types = [f32, f64])]
fn disk_vector<R: Real>(bencher: Bencher) {
    let disk = disk::<R>();
    let position = vector::<R>(DISK[1].1);
    bencher.bench_local(|| disk_irradiance_vector(black_box(&disk), black_box(position)));
}

/// Whole, cut, sliver.
#[divan::bench(types = [f32, f64], args = 0..3)]
fn sphere_factor<R: Real>(bencher: Bencher, case: usize) {
    let sphere = Sphere::new(vector::<R>([0.0, 0.0, 3.0]), R::ONE).unwrap();
    let normal = [[0.2, 0.3, 1.0], [0.0, 1.0, 0.1], [0.0, 1.0, -0.33]][case];
    let receiver = receiver::<R>([0.0; 3], normal);
    bencher.bench_local(|| sphere_configuration_factor(black_box(&sphere), black_box(&receiver)));
}

/// A square near by, cut by the horizon, and 40 times its size away.
#[divan::bench(types = [f32, f64], args = 0..3)]
fn polygon_factor<R: Real>(bencher: Bencher, case: usize) {
    let corners = [[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [1.0, 1.0, 0.0], [-1.0, 1.0, 0.0]].map(vector::<R>);
    let position = vector([[0.3, 0.2, 1.0], [0.3, 0.2, 1.0], [20.0, 3.0, 78.0]][case]);
    let normal = vector([[0.0, 0.0, -1.0], [0.8, 0.0, -0.6], [0.0, 0.6, -0.8]][case]);
    bencher.bench_local(|| polygon_configuration_factor(black_box(position), black_box(normal), black_box(&corners)));
}

#[divan::bench(types = [f32, f64])]
fn rectangle<R: Real>(bencher: Bencher) {
    let [a, b, h] = [0.7, 1.3, 2.0].map(R::from_f64);
    bencher.bench_local(|| rectangle_parallel_factor(black_box(a), black_box(b), black_box(h)));
}
