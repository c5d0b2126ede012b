//! Time of disk lights a point: closed form, ratio estimator, adaptive estimates, subdivisions, maps.
#![allow(missing_docs, reason = "a benchmark")]
#![allow(clippy::unwrap_used, reason = "the input is constant")]

use disk_sampling::estimate::{Aim, Panel, Request, Response, integrate, ratio, ratio_of_parts};
use disk_sampling::partition::{Method, Partition};
use disk_sampling::{Disk, Receiver, disk_configuration_factor, square_to_disk};
use divan::{Bencher, black_box};
use spectral_core::Real;

fn main() {
    divan::main();
}

/// Below the axis, 1 m off it, tilted by 60°, and close to the disk.
const RECEIVERS: [([f64; 3], [f64; 3]); 4] = [
    ([0.0, 0.0, 1.0], [0.0, 0.0, -1.0]),
    ([1.0, 0.0, 1.0], [0.0, 0.0, -1.0]),
    ([1.0, 0.0, 1.0], [0.866, 0.0, -0.5]),
    ([0.5, 0.2, 0.01], [0.5, 0.5, -0.7]),
];

fn disk<R: Real>() -> Disk<R> {
    Disk::new([R::ZERO; 3], [R::ZERO, R::ZERO, R::ONE], R::ONE).unwrap()
}

fn receiver<R: Real>(index: usize) -> Receiver<R> {
    let (position, normal) = RECEIVERS[index];
    Receiver::new(position.map(R::from_f64), normal.map(R::from_f64)).unwrap()
}

fn request<R: Real>(relative: f64) -> Request<R> {
    Request { relative_error: R::from_f64(relative), max_samples: 100_000, strata: 1 }
}

#[divan::bench(args = 0..4, types = [f32, f64])]
fn closed_form<R: Real>(bencher: Bencher<'_, '_>, index: usize) {
    let (disk, receiver) = (disk::<R>(), receiver::<R>(index));
    bencher.bench_local(|| disk_configuration_factor(black_box(&disk), black_box(&receiver)));
}

/// The unoccluded receiver within 0.1 %: closed form and nine samples of visibility.
#[divan::bench(args = 0..4, types = [f32, f64])]
fn unoccluded_ratio<R: Real>(bencher: Bencher<'_, '_>, index: usize) {
    let (disk, receiver) = (disk::<R>(), receiver::<R>(index));
    let mut panels = [Panel::default(); 16];
    bencher.bench_local(|| {
        let exact = disk_configuration_factor(black_box(&disk), black_box(&receiver));
        ratio(&disk, &receiver, exact, &request(1e-3), &mut panels, |_| Response::unoccluded(R::ONE)).unwrap()
    });
}

/// The same with 24 samples of the equal-area hexagon.
#[divan::bench(args = 0..4)]
fn unoccluded_ratio_of_24_parts(bencher: Bencher<'_, '_>, index: usize) {
    let (disk, receiver) = (disk::<f64>(), receiver::<f64>(index));
    bencher.bench_local(|| {
        let exact = disk_configuration_factor(black_box(&disk), black_box(&receiver));
        let parts = Partition::full(Method::EqualAreaHexagon, 3).unwrap();
        ratio_of_parts(parts, &disk, &receiver, exact, |_| Response::unoccluded(1.0)).unwrap()
    });
}

#[divan::bench(args = 0..4)]
fn cosine_light_to_a_thousandth(bencher: Bencher<'_, '_>, index: usize) {
    let (disk, receiver) = (disk::<f64>(), receiver::<f64>(index));
    let mut panels = [Panel::default(); 64];
    let respond = |aim: &Aim<f64>| Response::unoccluded(aim.cosine);
    bencher.bench_local(|| integrate(black_box(&disk), &receiver, &request(1e-3), &mut panels, respond).unwrap());
}

#[divan::bench(args = Method::ALL)]
fn subdivision_of_depth_6(method: Method) -> f64 {
    Partition::<f64>::full(black_box(method), 6).unwrap().map(|part| part.position()[0]).sum()
}

#[divan::bench]
fn concentric_map() -> [f64; 2] {
    square_to_disk(black_box([0.3, 0.8]))
}
