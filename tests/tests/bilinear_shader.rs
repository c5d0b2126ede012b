//! The product as shader text: what is written, and that it says the same as the operator.
#![allow(clippy::unwrap_used, clippy::float_cmp, reason = "helpers of tests; exact values are what is stated")]

use core::fmt;

use spectral_core::bilinear::{ShaderError, ShaderLanguage, Tensor, write_operator};
use spectral_tests::generators::Draw;

fn text(language: ShaderLanguage, tensor: &Tensor<f64>) -> String {
    let mut text = String::new();
    write_operator(&mut text, language, "bilinear", tensor).unwrap();
    text
}

/// The nine numbers between the brackets of the matrix.
fn numbers(text: &str, constructor: &str) -> Vec<f32> {
    let (_, rest) = text.split_once(constructor).unwrap();
    let (inside, _) = rest.split_once(')').unwrap();
    inside.split(", ").map(|number| number.parse().unwrap()).collect()
}

#[test]
fn the_functions_are_as_short_as_stated() {
    let wgsl = text(ShaderLanguage::Wgsl, &Tensor::iso_rgb());
    let expected = "fn bilinear(c: vec3<f32>, d: vec3<f32>) -> vec3<f32> {
    let differences = (c - c.yzx) * (d - d.yzx);
    return c * d - mat3x3<f32>(2.70856768e-1, -4.13179286e-2, 5.53666672e-4, -5.73309548e-2, 4.69318405e-2, \
                    3.95946316e-2, 7.58388415e-2, -1.81189273e-2, 1.06368996e-2) * differences;
}
";
    assert_eq!(wgsl, expected);
    let glsl = text(ShaderLanguage::Glsl, &Tensor::iso_rgb());
    let expected = expected
        .replace("fn bilinear(c: vec3<f32>, d: vec3<f32>) -> vec3<f32>", "vec3 bilinear(vec3 c, vec3 d)")
        .replace("let differences", "vec3 differences")
        .replace("mat3x3<f32>", "mat3");
    assert_eq!(glsl, expected);
    // The instructions: differences and products, and the matrix, which is three multiply–adds.
    assert_eq!(wgsl.matches(" - ").count() - 1, 2);
    assert_eq!(wgsl.matches(" * ").count() - 1, 2);
}

/// The text computed as the languages define it: matrices by columns, swizzles, in `f32`.
#[test]
fn the_text_computes_the_product() {
    let mut draw = Draw::new(11);
    for tensor in [Tensor::<f64>::iso_rgb(), Tensor::acescg(), Tensor::classical()] {
        let k = numbers(&text(ShaderLanguage::Wgsl, &tensor), "mat3x3<f32>(");
        assert_eq!(k, numbers(&text(ShaderLanguage::Glsl, &tensor), "mat3("));
        for _ in 0..1000 {
            let [c, d]: [[f64; 3]; 2] = core::array::from_fn(|_| core::array::from_fn(|_| draw.between(-1.0, 2.0)));
            let yzx = [1, 2, 0];
            let differences: [f64; 3] = core::array::from_fn(|i| (c[i] - c[yzx[i]]) * (d[i] - d[yzx[i]]));
            let expected = tensor.product(c, d);
            for row in 0..3 {
                let sum: f64 = (0..3).map(|column| f64::from(k[3 * column + row]) * differences[column]).sum();
                // Three coefficients, at most 0.3, rounded to f32, times differences up to 9.
                assert!((c[row] * d[row] - sum - expected[row]).abs() <= 5e-7, "{c:?} {d:?}");
            }
        }
    }
}

/// Every magnitude of `f32`, subnormal numbers and powers of ten included, is read back to the bit.
#[test]
fn coefficients_are_read_back() {
    let mut draw = Draw::new(3);
    let edges = [0.0, 1.0, 0.1, 10.0, 9.999_999e9, f32::MAX, f32::MIN_POSITIVE, f32::from_bits(1), 0.999_999_94, 123.0];
    for case in 0..3000 {
        let transfer: [[f32; 3]; 3] = core::array::from_fn(|_| {
            core::array::from_fn(|_| {
                let random = f32::from_bits(u32::try_from(draw.bits() >> 32).unwrap());
                let value = edges.get(case).copied().unwrap_or(random);
                if value.is_finite() { value } else { -1.5 }
            })
        });
        let mut text = String::new();
        write_operator(&mut text, ShaderLanguage::Glsl, "f", &Tensor::new(transfer).unwrap()).unwrap();
        let read = numbers(&text, "mat3(");
        for pair in 0..3 {
            for channel in 0..3 {
                let (read, written) = (read[3 * pair + channel], transfer[channel][pair]);
                assert_eq!(read, written, "{text}");
            }
        }
        // A decimal point, without which GLSL ES takes a number for an integer.
        assert_eq!(text.matches('.').count(), 9 + 2, "{text}");
    }
}

#[test]
fn bad_names_and_failing_writers_are_refused() {
    struct Full(usize);
    impl fmt::Write for Full {
        fn write_str(&mut self, s: &str) -> fmt::Result {
            self.0 = self.0.checked_sub(s.len()).ok_or(fmt::Error)?;
            Ok(())
        }
    }
    let tensor = Tensor::<f32>::iso_rgb();
    for name in ["", "3d", "_x", "a b", "a;b", "é", "a__b"] {
        let mut text = String::new();
        assert_eq!(write_operator(&mut text, ShaderLanguage::Wgsl, name, &tensor), Err(ShaderError::Name), "{name}");
        assert!(text.is_empty());
    }
    for room in [0, 10, 100] {
        let error = write_operator(&mut Full(room), ShaderLanguage::Glsl, "f", &tensor);
        assert_eq!(error, Err(ShaderError::Write), "{room}");
    }
    assert_eq!(write_operator(&mut Full(400), ShaderLanguage::Glsl, "f", &tensor), Ok(()));
}
