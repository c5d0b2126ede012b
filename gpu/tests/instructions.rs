//! What the bilinear product adds to the shader.
#![allow(clippy::unwrap_used, reason = "helpers of tests fail by panicking")]

use std::collections::BTreeMap;

use spectral_core::bilinear::Tensor;
use spectral_gpu::instructions::{count, extra, vector_instructions};
use spectral_gpu::renderer::Fragment;
use spectral_gpu::shader::{Product, glsl_chart, sphere};

/// The paper's shader grew by this many instructions (section 7.3).
const PAPER: usize = 11;

fn sphere_counts(product: &Product) -> BTreeMap<String, usize> {
    count(Fragment::Wgsl(&sphere(product).unwrap())).unwrap()
}

#[test]
fn the_bilinear_product_adds_seven_vector_instructions() {
    let classical = sphere_counts(&Product::Classical);
    let bilinear = sphere_counts(&Product::Bilinear(Tensor::iso_rgb()));
    assert!(extra(&classical, &bilinear).is_empty());
    let extra = extra(&bilinear, &classical);
    let expected = [("FMul", 1), ("FSub", 3), ("MatrixTimesVector", 1), ("VectorShuffle", 2)];
    assert_eq!(extra, expected.map(|(name, n)| (name.to_owned(), n)).into());

    let vectors: usize = extra.iter().map(|(name, n)| n * vector_instructions(name)).sum();
    assert_eq!(vectors, 7);
    assert!(vectors < PAPER);
}

#[test]
fn naga_accepts_the_glsl() {
    for tensor in [Tensor::classical(), Tensor::iso_rgb(), Tensor::rec_2020(), Tensor::acescg()] {
        let counts = count(Fragment::Glsl(&glsl_chart(&tensor, 16).unwrap())).unwrap();
        assert_eq!(counts["MatrixTimesVector"], 1);
    }
}

#[test]
fn a_shader_with_a_mistake_is_refused() {
    let glsl = glsl_chart(&Tensor::iso_rgb(), 16).unwrap();
    assert!(count(Fragment::Glsl(&glsl.replace("d.yzx", "d.yz"))).is_err());
    let wgsl = sphere(&Product::Bilinear(Tensor::iso_rgb())).unwrap();
    assert!(count(Fragment::Wgsl(&wgsl.replace("d.yzx", "d.yz"))).is_err());
}
