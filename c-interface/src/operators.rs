//! Products of three components with less loss, and spectra for three components.

use spectral_core::bilinear::Tensor;
use spectral_core::colour::RgbSpace;
use spectral_core::upsampling::smits::Basis;
use spectral_core::upsampling::{Sigmoid, Upsampler};
use spectral_core::{Real, Spectrum};

use crate::boundary::{Outcome, Output, finite, not_negative, numbers, read, representable};
use crate::{SpectralRgbSpace, SpectralSmits, SpectralTensorKind};

/// The coefficients of a bilinear product (Granier and Damez 2004) off the diagonal; the others follow from them.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct SpectralTensor<R> {
    /// For each channel c: k^c of red and green, of green and blue, of blue and red.
    pub transfer: [[R; 3]; 3],
}

/// A reflectance by three numbers (Jakob and Hanika 2019).
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct SpectralSigmoid<R> {
    /// c₀, c₁, c₂ of ρ(λ) = ½ + U / (2 √(1 + U²)), U = c₀ + c₁ z + c₂ z², z = (λ − 580 nm) / 200 nm.
    pub coefficients: [R; 3],
}

unsafe fn coefficients<R: Real>(pointer: *const SpectralTensor<R>) -> Outcome<Tensor<R>> {
    let transfer = read(pointer)?.transfer;
    finite(transfer.as_flattened())?;
    Ok(Tensor::new(transfer).unwrap_or_default())
}

unsafe fn tensor<R: Real>(kind: i32, found: *mut SpectralTensor<R>) -> Outcome {
    let output = Output::at(found)?;
    let transfer = SpectralTensorKind::meaning(kind)?.tensor().transfer();
    output.put(SpectralTensor { transfer })
}

unsafe fn product_of<R: Real>(
    tensor: *const SpectralTensor<R>,
    first: *const R,
    second: *const R,
    found: *mut R,
) -> Outcome {
    let output = Output::at(found.cast::<[R; 3]>())?;
    let result = coefficients(tensor)?.product(numbers(first)?, numbers(second)?);
    representable(&result)?;
    output.put(result)
}

unsafe fn reflection<R: Real>(tensor: *const SpectralTensor<R>, reflectance: *const R, matrix: *mut R) -> Outcome {
    let output = Output::at(matrix.cast::<[[R; 3]; 3]>())?;
    let result = coefficients(tensor)?.reflection(numbers(reflectance)?).matrix();
    representable(result.as_flattened())?;
    output.put(result)
}

unsafe fn reflect<R: Real>(
    tensor: *const SpectralTensor<R>,
    reflectance: *const R,
    light: *const R,
    found: *mut R,
) -> Outcome {
    let output = Output::at(found.cast::<[R; 3]>())?;
    let result = coefficients(tensor)?.reflection(numbers(reflectance)?).apply(numbers(light)?);
    representable(&result)?;
    output.put(result)
}

unsafe fn upsample<R: Real>(rgb: *const R, space: i32, found: *mut SpectralSigmoid<R>) -> Outcome {
    let output = Output::at(found)?;
    let space: RgbSpace = SpectralRgbSpace::meaning(space)?;
    let sigmoid = Upsampler::<R>::d65(&space)?.reflectance(numbers(rgb)?)?;
    output.put(SpectralSigmoid { coefficients: sigmoid.coefficients() })
}

unsafe fn sigmoid_value<R: Real>(sigmoid: *const SpectralSigmoid<R>, wavelength: R, value: *mut R) -> Outcome {
    let output = Output::at(value)?;
    let coefficients = read(sigmoid)?.coefficients;
    finite(&coefficients)?;
    finite(&[wavelength])?;
    let result = Sigmoid::new(coefficients).map_or(R::ZERO, |sigmoid| sigmoid.value(wavelength));
    representable(&[result])?;
    output.put(result)
}

unsafe fn smits<R: Real>(rgb: *const R, kind: i32, bins: *mut R) -> Outcome {
    let output = Output::at(bins.cast::<[R; 10]>())?;
    let basis = if SpectralSmits::meaning(kind)? { Basis::lights() } else { Basis::reflectances() };
    let rgb = numbers(rgb)?;
    not_negative(&rgb)?;
    let result = basis.spectrum(rgb)?.values();
    representable(&result)?;
    output.put(result)
}

macro_rules! exports {
    ($R:ident) => {
        pastey::paste! { mod [<exports_ $R>] {
            use super::*;
            use crate::boundary::export;

            export! {
                /// The coefficients of a bilinear product for a kind of components.
                ///
                /// @param kind a SpectralTensorKind
                /// @return NULL, MISALIGNED, CODE
                [<spectral_tensor_ $R>] = tensor(kind: i32, tensor: *mut SpectralTensor<$R>);

                /// The bilinear product of two colours: of light and reflectance, or of two filters. Linear components; it commutes to the bit.
                ///
                /// @param first, second, product 3 numbers each
                /// @return NULL, MISALIGNED, NOT_FINITE; RANGE when it overflows
                [<spectral_bilinear_product_ $R>] = product_of(
                    tensor: *const SpectralTensor<$R>,
                    first: *const $R,
                    second: *const $R,
                    product: *mut $R,
                );

                /// The matrix by which a material of one colour maps light to what it reflects, row by row: the bilinear product with it.
                ///
                /// @param[out] matrix 9 numbers
                /// @return NULL, MISALIGNED, NOT_FINITE; RANGE when it overflows
                [<spectral_bilinear_reflection_ $R>] = reflection(
                    tensor: *const SpectralTensor<$R>,
                    reflectance: *const $R,
                    matrix: *mut $R,
                );

                /// Light after a bilinear reflection: the matrix of spectral_bilinear_reflection times the light.
                ///
                /// @param reflectance, light, reflected 3 numbers each
                /// @return NULL, MISALIGNED, NOT_FINITE; RANGE when it overflows
                [<spectral_bilinear_reflect_ $R>] = reflect(
                    tensor: *const SpectralTensor<$R>,
                    reflectance: *const $R,
                    light: *const $R,
                    reflected: *mut $R,
                );

                /// The smooth reflectance that has a colour under CIE D65 (Jakob and Hanika 2019, solved without a table).
                ///
                /// @param rgb linear components in [0, 1]
                /// @param space a SpectralRgbSpace
                /// @return NULL, MISALIGNED, NOT_FINITE, CODE; RANGE for components outside [0, 1]; UNREACHABLE
                [<spectral_upsample_ $R>] = upsample(rgb: *const $R, space: i32, sigmoid: *mut SpectralSigmoid<$R>);

                /// The value in [0, 1] of such a reflectance at a wavelength in nm: linear between 360, 365, …, 830 nm, held outside.
                ///
                /// @return NULL, MISALIGNED, NOT_FINITE; RANGE when it overflows
                [<spectral_sigmoid_value_ $R>] = sigmoid_value(
                    sigmoid: *const SpectralSigmoid<$R>,
                    wavelength: $R,
                    value: *mut $R,
                );

                /// The spectrum that Smits' bases (1999) have for a colour.
                ///
                /// @param rgb linear components, not negative; of a reflectance at most 1, which is not checked
                /// @param kind a SpectralSmits
                /// @param[out] bins 10 numbers: the spectrum's values in 10 equal parts of 380–720 nm
                /// @return NULL, MISALIGNED, NOT_FINITE, NEGATIVE, CODE; RANGE when it overflows
                [<spectral_smits_ $R>] = smits(rgb: *const $R, kind: i32, bins: *mut $R);
            }
        } pub use [<exports_ $R>]::*; }
    };
}
exports!(f32);
exports!(f64);
