//! The text of the fragment shaders.

use spectral_core::bilinear::{ShaderError, ShaderLanguage, Tensor, write_operator};

/// How the colour of the light and the reflected one are put together.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Product {
    /// Component by component.
    Classical,
    /// Bilinear, with a tensor.
    Bilinear(Tensor<f32>),
    /// The absolute difference of the two.
    Difference(Tensor<f32>),
}

impl Product {
    /// The product of two colours on the processor.
    #[must_use]
    pub fn of(&self, c: [f32; 3], d: [f32; 3]) -> [f32; 3] {
        match self {
            Self::Classical => Tensor::classical().product(c, d),
            Self::Bilinear(tensor) => tensor.product(c, d),
            Self::Difference(tensor) => {
                let (p, q) = (tensor.product(c, d), Tensor::classical().product(c, d));
                core::array::from_fn(|i| (p[i] - q[i]).abs())
            }
        }
    }

    /// The product as WGSL, `fn product(c: vec3<f32>, d: vec3<f32>) -> vec3<f32>`.
    ///
    /// # Errors
    /// Those of [`write_operator`].
    pub fn wgsl(&self) -> Result<String, ShaderError> {
        let mut text = String::new();
        match self {
            Self::Classical => text.push_str(&function("c * d")),
            Self::Bilinear(tensor) => write_operator(&mut text, ShaderLanguage::Wgsl, "product", tensor)?,
            Self::Difference(tensor) => {
                write_operator(&mut text, ShaderLanguage::Wgsl, "bilinear", tensor)?;
                text.push_str(&function("abs(bilinear(c, d) - c * d)"));
            }
        }
        Ok(text)
    }
}

fn function(body: &str) -> String {
    format!("fn product(c: vec3<f32>, d: vec3<f32>) -> vec3<f32> {{\n    return {body};\n}}\n")
}

/// The whole fragment shader of the sphere with a product, in WGSL, with the entry point `shade`.
///
/// # Errors
/// Those of [`write_operator`].
pub fn sphere(product: &Product) -> Result<String, ShaderError> {
    Ok(format!("{}\n{}", product.wgsl()?, include_str!("sphere.wgsl")))
}

/// A GLSL fragment shader that multiplies two colours that change over the picture: (y, x, 1 − x) by (x, 1 − y, y), x and y
/// in (0, 1) at the centres of `size` × `size` pixels, counted from the upper left.
///
/// # Errors
/// Those of [`write_operator`].
pub fn glsl_chart(tensor: &Tensor<f32>, size: u16) -> Result<String, ShaderError> {
    let mut operator = String::new();
    write_operator(&mut operator, ShaderLanguage::Glsl, "product", tensor)?;
    Ok(format!(
        "#version 450
{operator}
layout(location = 0) out vec4 colour;

void main() {{
    float x = gl_FragCoord.x / {size}.0;
    float y = gl_FragCoord.y / {size}.0;
    colour = vec4(product(vec3(y, x, 1.0 - x), vec3(x, 1.0 - y, y)), 1.0);
}}
"
    ))
}
