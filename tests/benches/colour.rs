//! Time of the colour operators: products of a thousand colours, classical and bilinear; quotients; spectra for colours.
#![allow(missing_docs, clippy::unwrap_used, reason = "a benchmark")]

use divan::counter::ItemsCount;
use divan::{Bencher, black_box};
use spectral_core::Real;
use spectral_core::bilinear::{Tensor, estimate_rgb};
use spectral_core::colour::RgbSpace;
use spectral_core::upsampling::Upsampler;
use spectral_core::upsampling::smits::Basis;
use spectral_tests::generators::Draw;

const COUNT: usize = 1000;

fn main() {
    divan::main();
}

fn colours<R: Real>(seed: u64) -> Vec<[R; 3]> {
    let mut draw = Draw::new(seed);
    (0..COUNT).map(|_| core::array::from_fn(|_| R::from_f64(draw.unit()))).collect()
}

/// Runs an operator on pairs of colours, into a buffer.
fn on_pairs<R: Real>(bencher: Bencher, operator: impl Fn([R; 3], [R; 3]) -> [R; 3] + Sync) {
    let (lights, surfaces, mut out) = (colours::<R>(1), colours::<R>(2), vec![[R::ZERO; 3]; COUNT]);
    bencher.counter(ItemsCount::new(COUNT)).bench_local(|| {
        for ((out, light), surface) in out.iter_mut().zip(black_box(&lights)).zip(black_box(&surfaces)) {
            *out = operator(*light, *surface);
        }
        black_box(&mut out);
    });
}

#[divan::bench(types = [f32, f64])]
fn product_classical<R: Real>(bencher: Bencher) {
    on_pairs::<R>(bencher, |c, d| [c[0] * d[0], c[1] * d[1], c[2] * d[2]]);
}

#[divan::bench(types = [f32, f64])]
fn product_bilinear<R: Real>(bencher: Bencher) {
    let tensor = black_box(Tensor::<R>::iso_rgb());
    on_pairs::<R>(bencher, |c, d| tensor.product(c, d));
}

#[divan::bench(types = [f32, f64])]
fn product_reflection<R: Real>(bencher: Bencher) {
    let material = black_box(Tensor::<R>::iso_rgb().reflection([0.2, 0.5, 0.7].map(R::from_f64)));
    on_pairs::<R>(bencher, |c, _| material.apply(c));
}

/// A new divisor for each colour.
#[divan::bench(types = [f32, f64])]
fn quotient_any<R: Real>(bencher: Bencher) {
    let tensor = black_box(Tensor::<R>::iso_rgb());
    on_pairs::<R>(bencher, |c, d| tensor.divisor(d).map_or([R::ZERO; 3], |d| d.quotient(c)));
}

/// One divisor for all.
#[divan::bench(types = [f32, f64])]
fn quotient_one<R: Real>(bencher: Bencher) {
    let divisor = black_box(Tensor::<R>::iso_rgb().divisor([0.4, 0.9, 1.0].map(R::from_f64)).unwrap());
    on_pairs::<R>(bencher, |c, _| divisor.quotient(c));
}

#[divan::bench(types = [f32, f64])]
fn estimate_tensor<R: Real>() -> bool {
    estimate_rgb::<R>(black_box(&RgbSpace::REC_709)).is_ok()
}

#[divan::bench(types = [f32, f64])]
fn sigmoid_set_up<R: Real>() -> bool {
    Upsampler::<R>::d65(black_box(&RgbSpace::REC_709)).is_ok()
}

/// Random colours of the cube.
#[divan::bench(types = [f32, f64], sample_count = 20)]
fn sigmoid_solve<R: Real>(bencher: Bencher) {
    let (upsampler, colours) = (Upsampler::<R>::d65(&RgbSpace::REC_709).unwrap(), colours::<R>(3));
    bencher.counter(ItemsCount::new(COUNT)).bench_local(|| {
        for rgb in &colours {
            let _ = black_box(upsampler.reflectance(*black_box(rgb)));
        }
    });
}

#[divan::bench(types = [f32, f64])]
fn smits<R: Real>(bencher: Bencher) {
    let (basis, colours) = (Basis::<R>::lights(), colours::<R>(3));
    bencher.counter(ItemsCount::new(COUNT)).bench_local(|| {
        for rgb in &colours {
            let _ = black_box(basis.spectrum(*black_box(rgb)));
        }
    });
}
