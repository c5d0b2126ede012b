//! Time of reflectance models: a value, a sample, a density, an albedo.
#![allow(missing_docs, reason = "a benchmark")]
#![allow(clippy::unwrap_used, reason = "the input is constant")]

use divan::{Bencher, black_box};
use spectral_core::Real;
use spectral_core::brdf::{Brdf, Schlick, Variant, Ward};
use spectral_tests::statistics::Rng;

fn main() {
    divan::main();
}

/// Directions and random numbers, so that no branch is foreseen.
const INPUTS: usize = 1024;
const NAMES: [&str; 4] = ["ward", "ward-duer", "ward-neumann", "balanced"];

struct Input<R> {
    light: [R; 3],
    view: [R; 3],
    u: [R; 3],
}

/// Views anywhere, lights within the lobe: of the model's own samples.
fn inputs<R: Real>(model: &Ward<R>) -> Vec<Input<R>> {
    let mut rng = Rng::new(1);
    let mut draw = || {
        let view = rng.direction().map(R::from_f64);
        let view = [view[0], view[1], view[2].abs()];
        let u = [(); 3].map(|()| R::from_f64(rng.unit()));
        let light = model.sample(view, u).unwrap().direction;
        Input { light, view, u }
    };
    (0..INPUTS).map(|_| draw()).collect()
}

fn model<R: Real>(name: &str) -> Ward<R> {
    Ward::new(name.parse().unwrap(), R::from_f64(0.1), R::from_f64(0.2)).unwrap()
}

fn run<R: Real, T>(bencher: Bencher, inputs: &[Input<R>], work: impl Fn(&Input<R>) -> T) {
    let mut next = 0;
    bencher.bench_local(|| {
        next = (next + 1) % INPUTS;
        work(black_box(&inputs[next]))
    });
}

#[divan::bench(types = [f32, f64], args = NAMES)]
fn evaluate<R: Real>(bencher: Bencher, name: &str) {
    let model = black_box(model::<R>(name));
    run(bencher, &inputs(&model), |i| model.evaluate(i.light, i.view));
}

#[divan::bench(types = [f32, f64], args = NAMES)]
fn sample<R: Real>(bencher: Bencher, name: &str) {
    let model = black_box(model::<R>(name));
    run(bencher, &inputs(&model), |i| model.sample(i.view, i.u));
}

#[divan::bench(types = [f32, f64], args = NAMES)]
fn sample_half_vector<R: Real>(bencher: Bencher, name: &str) {
    let model = black_box(model::<R>(name));
    run(bencher, &inputs(&model), |i| model.sample_half_vector(i.view, [i.u[0], i.u[1]]));
}

#[divan::bench(types = [f32, f64])]
fn pdf<R: Real>(bencher: Bencher) {
    let model = black_box(model::<R>("balanced"));
    run(bencher, &inputs(&model), |i| model.pdf(i.light, i.view));
}

#[divan::bench(types = [f32, f64])]
fn schlick_evaluate<R: Real>(bencher: Bencher) {
    let schlick = black_box(Schlick::new(R::from_f64(0.1), R::from_f64(0.5)).unwrap());
    run(bencher, &inputs(&model("balanced")), |i| schlick.evaluate(i.light, i.view));
}

#[divan::bench(types = [f32, f64])]
fn schlick_sample<R: Real>(bencher: Bencher) {
    let schlick = black_box(Schlick::new(R::from_f64(0.1), R::from_f64(0.5)).unwrap());
    run(bencher, &inputs(&model("balanced")), |i| schlick.sample(i.view, i.u));
}

#[divan::bench(types = [f32, f64])]
fn albedo_fit<R: Real>(bencher: Bencher) {
    let round = black_box(Ward::new(Variant::Balanced, R::from_f64(0.1), R::from_f64(0.1)).unwrap());
    run(bencher, &inputs(&round), |i| round.albedo(i.view));
}

#[divan::bench(types = [f32, f64])]
fn albedo_quadrature<R: Real>(bencher: Bencher) {
    let model = black_box(model::<R>("balanced"));
    run(bencher, &inputs(&model), |i| model.albedo(i.view));
}
