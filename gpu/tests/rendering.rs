//! Pictures of the graphics device against the processor's.
//!
//! Where no Vulkan device exists the tests say so and pass, unless `SPECTRAL_GPU_REQUIRED` is set.
#![allow(clippy::panic, clippy::unwrap_used, reason = "helpers of tests fail by panicking")]

use std::io::Write;

use spectral_core::bilinear::Tensor;
use spectral_gpu::model::Scene;
use spectral_gpu::renderer::{Fragment, Gpu, GpuError};
use spectral_gpu::shader::{Product, glsl_chart, sphere};

/// Largest difference of a component between the device and the processor, both in `f32`, for colours up to about 1.
const TOLERANCE: f32 = 1e-5;
/// Not a multiple of 16: rows are padded.
const SIZE: u16 = 150;
const LIGHTS: [[f32; 3]; 3] = [[0.1, 0.9, 1.0], [1.0; 3], [1.0, 0.05, 0.4]];

/// The device; none where there is none, which is told past the capture of the test's output.
fn gpu() -> Option<Gpu> {
    match Gpu::new() {
        Ok(gpu) => Some(gpu),
        Err(error @ GpuError::NoAdapter(_)) if std::env::var_os("SPECTRAL_GPU_REQUIRED").is_none() => {
            // In one piece, so that other tests' lines stay apart.
            let line = format!("SKIPPED, nothing was rendered: {error}\n");
            std::io::stderr().write_all(line.as_bytes()).unwrap();
            None
        }
        Err(error) => panic!("{error}"),
    }
}

fn render(gpu: &Gpu, product: &Product, scene: &Scene) -> Vec<[f32; 4]> {
    let text = sphere(product).unwrap();
    let pass = gpu.prepare(Fragment::Wgsl(&text), Some(scene.uniforms().as_flattened()), scene.size).unwrap();
    gpu.render(&pass).unwrap()
}

/// Columns and rows in the order of the pixels.
fn pixels(size: u16) -> impl Iterator<Item = (u16, u16)> {
    (0..size).flat_map(move |row| (0..size).map(move |column| (column, row)))
}

/// The largest difference between a picture and what a function gives for each column and row.
fn error(picture: &[[f32; 4]], size: u16, expected: impl Fn(usize, (u16, u16)) -> [f32; 3]) -> f32 {
    assert_eq!(picture.len(), usize::from(size) * usize::from(size));
    let mut largest = 0.0_f32;
    for (i, (got, at)) in picture.iter().zip(pixels(size)).enumerate() {
        for (got, expected) in got.iter().zip(expected(i, at)) {
            let error = (got - expected).abs();
            assert!(error <= TOLERANCE, "{got} instead of {expected} at {at:?}");
            largest = largest.max(error);
        }
    }
    largest
}

#[test]
fn the_sphere_is_the_processors() {
    let Some(gpu) = gpu() else { return };
    println!("device: {}", gpu.name());
    for light in LIGHTS {
        let scene = Scene::new(SIZE, light);
        for (name, product) in [
            ("classical", Product::Classical),
            ("bilinear", Product::Bilinear(Tensor::iso_rgb())),
            ("bilinear, Rec. 2020", Product::Bilinear(Tensor::rec_2020())),
            ("difference", Product::Difference(Tensor::iso_rgb())),
        ] {
            let picture = render(&gpu, &product, &scene);
            let largest = error(&picture, SIZE, |_, (x, y)| product.of(light, scene.reflected_colour(x, y)));
            println!("{name} under {light:?}: {largest:.1e}");
        }
    }
}

#[test]
fn the_operator_is_the_processors() {
    let Some(gpu) = gpu() else { return };
    let reflected = render(&gpu, &Product::Classical, &Scene::new(SIZE, [1.0; 3]));
    let product = Product::Bilinear(Tensor::iso_rgb());
    for light in LIGHTS {
        let picture = render(&gpu, &product, &Scene::new(SIZE, light));
        let expected = |i: usize, _| {
            let [red, green, blue, _] = reflected[i];
            product.of(light, [red, green, blue])
        };
        let largest = error(&picture, SIZE, expected);
        println!("operator under {light:?}: {largest:.1e}");
        // Both operators have the same input: a handful of roundings of numbers up to 1 is left.
        assert!(largest <= 8.0 * f32::EPSILON);
    }
}

#[test]
fn the_red_highlight_is_kept() {
    let Some(gpu) = gpu() else { return };
    let scene = Scene::new(SIZE, LIGHTS[0]);
    let white = render(&gpu, &Product::Classical, &Scene::new(SIZE, [1.0; 3]));
    let classical = render(&gpu, &Product::Classical, &scene);
    let bilinear = render(&gpu, &Product::Bilinear(Tensor::iso_rgb()), &scene);
    // The reddest place under white light.
    let redness = |p: &[f32; 4]| p[0] - p[1].max(p[2]);
    let (reddest, pixel) = white.iter().enumerate().max_by(|a, b| redness(a.1).total_cmp(&redness(b.1))).unwrap();
    assert!(redness(pixel) > 0.1, "{pixel:?}");
    assert!(redness(&classical[reddest]) < 0.0);
    assert!(bilinear[reddest][0] > 2.5 * classical[reddest][0], "{:?}", bilinear[reddest]);
}

#[test]
fn the_glsl_operator_is_the_processors() {
    let Some(gpu) = gpu() else { return };
    for tensor in [Tensor::iso_rgb(), Tensor::rec_709(), Tensor::rec_2020(), Tensor::acescg()] {
        let text = glsl_chart(&tensor, SIZE).unwrap();
        let picture = gpu.render(&gpu.prepare(Fragment::Glsl(&text), None, SIZE).unwrap()).unwrap();
        let fraction = |pixel: u16| (f32::from(pixel) + 0.5) / f32::from(SIZE);
        let largest = error(&picture, SIZE, |_, (column, row)| {
            let (x, y) = (fraction(column), fraction(row));
            tensor.product([y, x, 1.0 - x], [x, 1.0 - y, y])
        });
        println!("GLSL: {largest:.1e}");
    }
}

#[test]
fn a_shader_with_a_mistake_is_refused() {
    let Some(gpu) = gpu() else { return };
    let text = sphere(&Product::Classical).unwrap().replace("dot(", "dott(");
    let uniforms = Scene::new(SIZE, [1.0; 3]).uniforms();
    let refused = gpu.prepare(Fragment::Wgsl(&text), Some(uniforms.as_flattened()), SIZE);
    assert!(matches!(refused, Err(GpuError::Invalid(_))));
}
