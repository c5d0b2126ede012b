//! Time of the measures of a light: an 81-sample spectrum, both precisions, batch and single form.
#![allow(missing_docs, reason = "a benchmark")]

use divan::{Bencher, black_box};
use spectral_core::Real;
use spectral_core::colour::delta_e_00;
use spectral_core::light::{FidelityMeter, IndexMeter, LightMeter, measure, measure_indices};
use spectral_core::spectrum::{Outside, RadiationConstant};
use spectral_core::summation::SumGrid;
use spectral_core::tables::find_light;

const GRID: SumGrid<81> = SumGrid::CIE_5NM;
const CONSTANT: RadiationConstant = RadiationConstant::Its1990;
/// One lamp whose reference is a black body, one with daylight.
const LAMPS: [&str; 2] = ["FL2", "FL7"];

fn main() {
    divan::main();
}

fn lamp<R: Real>(name: &str) -> [R; 81] {
    find_light(name).map_or([R::ZERO; 81], |table| GRID.sample(&table.spectrum(Outside::Zero)))
}

#[divan::bench(types = [f32, f64], args = LAMPS)]
fn cct<R: Real>(bencher: Bencher, name: &str) {
    let (meter, light) = (Box::new(LightMeter::<R, 81>::new(GRID, CONSTANT)), lamp::<R>(name));
    bencher.bench_local(|| meter.chromaticity(black_box(&light)));
}

#[divan::bench(types = [f32, f64], args = LAMPS)]
fn cct_ra_cri00_general<R: Real>(bencher: Bencher, name: &str) {
    let (meter, light) = (Box::new(IndexMeter::<R, 81>::new(GRID, CONSTANT)), lamp::<R>(name));
    bencher.bench_local(|| meter.measure(black_box(&light)));
}

#[divan::bench(types = [f32, f64], args = LAMPS)]
fn cct_ra_cri00_general_single<R: Real>(bencher: Bencher, name: &str) {
    let light = lamp::<R>(name);
    bencher.bench_local(|| measure_indices(GRID, black_box(&light), CONSTANT));
}

#[divan::bench(types = [f32, f64], args = LAMPS)]
fn cct_ra_cri00<R: Real>(bencher: Bencher, name: &str) {
    let (meter, light) = (Box::new(LightMeter::<R, 81>::new(GRID, CONSTANT)), lamp::<R>(name));
    bencher.bench_local(|| meter.munsell(black_box(&light)));
}

#[divan::bench(types = [f32, f64], args = LAMPS)]
fn everything<R: Real>(bencher: Bencher, name: &str) {
    let (meter, light) = (Box::new(LightMeter::<R, 81>::new(GRID, CONSTANT)), lamp::<R>(name));
    bencher.bench_local(|| meter.measure(black_box(&light)));
}

#[divan::bench(types = [f32, f64], args = LAMPS)]
fn everything_single<R: Real>(bencher: Bencher, name: &str) {
    let light = lamp::<R>(name);
    bencher.bench_local(|| measure(GRID, black_box(&light), CONSTANT));
}

#[divan::bench(types = [f32, f64], args = LAMPS)]
fn rf_rg<R: Real>(bencher: Bencher, name: &str) {
    let (meter, light) = (Box::new(FidelityMeter::<R, 81>::new(GRID, CONSTANT)), lamp::<R>(name));
    bencher.bench_local(|| meter.measure(black_box(&light)));
}

#[divan::bench(types = [f32, f64])]
fn delta_e<R: Real>(bencher: Bencher) {
    let [first, second] = [[22.72, 20.09, -46.69], [23.03, 14.97, -42.56]].map(|lab: [f64; 3]| lab.map(R::from_f64));
    bencher.bench_local(|| delta_e_00(black_box(first), black_box(second)));
}
