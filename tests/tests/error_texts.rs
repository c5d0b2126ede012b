//! What is refused is refused with words: each error of the cores is one line that says what is wrong, and where.
#![allow(clippy::unwrap_used, reason = "the input is constant")]

use core::fmt::{Display, Write};

use disk_sampling::{Disk, Receiver, ShapeError, Sphere};
use spectral_core::Observer;
use spectral_core::bilinear::{self, ShaderError, ShaderLanguage, Tensor, write_operator};
use spectral_core::brdf::{Glossy, Schlick, Variant, Ward};
use spectral_core::colour::RgbSpace;
use spectral_core::dispersion::{Cauchy, Sellmeier};
use spectral_core::light::IndexMeter;
use spectral_core::prefilter::Prefilter;
use spectral_core::spectrum::Uniform;
use spectral_core::spectrum::{
    Constant, Daylight, Lines, Outside, PiecewiseLinear, Planck, RadiationConstant, Rounding,
};
use spectral_core::summation::SumGrid;
use spectral_core::upsampling::Upsampler;

const NAN: f64 = f64::NAN;

/// The text of what was refused.
#[track_caller]
fn assert_refused<T, E: Display>(result: Result<T, E>, text: &str) {
    assert_eq!(result.err().map(|error| error.to_string()).as_deref(), Some(text));
}

#[test]
fn tensors_say_which_coefficient() {
    let mut transfer = Tensor::<f64>::iso_rgb().transfer();
    transfer[1][2] = NAN;
    assert_refused(Tensor::new(transfer), "a coefficient of the tensor is not finite");
    let mut matrices = Tensor::<f64>::iso_rgb().matrices();
    matrices[0][1][2] += 0.1;
    let text = "the tensor is not symmetric: channel 1, coefficients ";
    assert!(Tensor::from_matrices(&matrices, 0.01).unwrap_err().to_string().starts_with(text));
    let mut matrices = Tensor::<f64>::iso_rgb().matrices();
    matrices[2][1][2] += 0.1;
    let text = "the tensor is not coherent: K_r + K_g + K_b differs from I in row 1, column 2";
    assert_refused(Tensor::from_matrices(&matrices, 0.01), text);

    let text = "alpha of channel 2 is negative or not finite";
    assert_refused(Tensor::<f64>::iso_rgb().with_alpha([0.1, 0.1, -0.1]), text);
    let text = "alpha of channel 0 is above 0, but the tensor transfers nothing into that channel";
    assert_refused(Tensor::<f64>::classical().with_alpha([0.1, 0.0, 0.0]), text);
    assert_refused(Tensor::iso_rgb().divisor([1.0, NAN, 1.0]), "a component of the divisor is not finite");
    let text = "the divisor is singular: many colours have the same product with it";
    assert_refused(Tensor::iso_rgb().divisor([0.0; 3]), text);
}

#[test]
fn estimates_of_tensors_say_which_function() {
    let text = "colour-matching functions need at least 2 nodes, not 1";
    assert_refused(bilinear::estimate(1, |_| [1.0; 3]), text);
    let text = "node 3 of the colour-matching functions is not finite";
    assert_refused(bilinear::estimate(5, |i| [1.0, 1.0, if i == 3 { NAN } else { 1.0 }]), text);
    let text = "the integral of colour-matching function 1 is not positive and of usable size";
    assert_refused(bilinear::estimate(5, |i| [f64::from(u8::try_from(i).unwrap()), 0.0, 1.0]), text);
    assert_refused(bilinear::estimate(5, |_| [1.0; 3]), "the colour-matching functions are linearly dependent");
}

/// A writer without room.
struct Full;

impl Write for Full {
    fn write_str(&mut self, _: &str) -> core::fmt::Result {
        Err(core::fmt::Error)
    }
}

#[test]
fn shaders_say_whether_the_name_or_the_writer_is_at_fault() {
    let tensor = Tensor::<f64>::rec_709();
    let name = write_operator(&mut String::new(), ShaderLanguage::Glsl, "2d", &tensor);
    assert_refused(name, "the name of the shader function is not an identifier");
    let written = write_operator(&mut Full, ShaderLanguage::Glsl, "product", &tensor);
    assert_eq!(written, Err(ShaderError::Write));
    assert_refused(written, "the text of the shader function could not be written");
}

#[test]
fn glasses_say_which_term() {
    let visible = [380.0, 780.0];
    let terms = |first: [f64; 2]| [first, [0.0; 2], [0.0; 2], [0.0; 2]];
    assert_refused(Sellmeier::new(terms([1.0, NAN]), visible), "dispersion coefficient 1 is not finite");
    assert_refused(Cauchy::new(NAN, 0.0, visible), "dispersion coefficient 0 is not finite");
    let range = "the range of validity is not two positive, increasing wavelengths";
    assert_refused(Cauchy::new(1.5, 0.0, [780.0, 380.0]), range);
    let resonance = "the resonance of term 0 lies in the range of validity";
    assert_refused(Sellmeier::new(terms([1.0, 0.25]), visible), resonance);
    let index = "the index is not positive and finite over the range of validity";
    assert_refused(Cauchy::new(-1.5, 0.0, visible), index);
    assert_refused(Sellmeier::new(terms([-3.0, 0.01]), visible), index);
}

#[test]
fn shapes_say_which_part() {
    let coordinate = "a coordinate is infinite or not a number";
    assert_refused(Sphere::new([0.0, NAN, 0.0], 1.0), coordinate);
    assert_refused(Receiver::new([0.0; 3], [0.0; 3]), "the normal is zero");
    assert_eq!(Disk::new([0.0; 3], [0.0, 0.0, 1.0], 0.0), Err(ShapeError::Radius));
    assert_refused(Disk::new([0.0; 3], [0.0, 0.0, 1.0], 0.0), "the radius is not positive and finite");
}

#[test]
fn spectra_say_which_node() {
    let through = |w: &[f64], v: &[f64]| PiecewiseLinear::new(w, v, Outside::Zero).map(|_| ());
    assert_refused(through(&[400.0], &[1.0]), "a spectrum needs at least 2 nodes, not 1");
    assert_refused(through(&[400.0, 500.0], &[1.0]), "2 wavelengths but 1 values");
    assert_refused(through(&[400.0, NAN], &[1.0; 2]), "wavelength 1 is not finite");
    assert_refused(
        through(&[-f64::MAX, f64::MAX], &[1.0; 2]),
        "the wavelengths span more than the number type can hold",
    );
    assert_refused(through(&[400.0, 500.0], &[1.0, NAN]), "value 1 is not finite");
    let negative = [1.0, -1.0];
    let spectrum = PiecewiseLinear::new(&[400.0, 500.0], &negative, Outside::Zero).unwrap();
    assert_refused(spectrum.check_non_negative(), "value 1 is negative");
    let step = "the step between wavelengths is not positive and finite, or too small";
    assert_refused(Uniform::new(380.0, 0.0, &[1.0, 1.0], Outside::Zero), step);
    let width = "the width of line 1 is not positive and finite, or too narrow";
    assert_refused(Lines::new(&[500.0, f64::MAX], &[1.0; 2], 1.0), width);
    let kelvin = "the temperature is not above 0 K and at most 1e9 K";
    assert_refused(Planck::new(0.0, RadiationConstant::Its1990), kelvin);
    let daylight = "the correlated colour temperature is not in 4000 K to 25000 K";
    assert_refused(Daylight::new(3000.0, Rounding::ThreeDecimals), daylight);
    assert_refused(SumGrid::<81>::new(380, 0), "the step of the grid is not in 1 nm to 20 nm");
    let grid = "the grid does not span 400 nm to 700 nm, or goes beyond 4000 nm";
    assert_refused(SumGrid::<81>::new(500, 5), grid);
}

#[test]
fn lights_say_which_sample() {
    let meter = Box::new(IndexMeter::<f64, 81>::new(SumGrid::CIE_5NM, RadiationConstant::Its1990));
    let with = |sample: f64| core::array::from_fn(|i| if i == 7 { sample } else { 1.0 });
    assert_refused(meter.measure(&with(NAN)), "sample 7 of the light is not finite");
    assert_refused(meter.measure(&with(-1.0)), "sample 7 of the light is negative");
    assert_refused(meter.measure(&[0.0; 81]), "the light has no power in the visible range");
    let (observer, dark) = (Observer::<f64>::cie_1931_2deg(), Constant::new(0.0).unwrap());
    let text = "component 0 of the dominant light is not positive and finite in this RGB space";
    assert_refused(Prefilter::new(&observer, &dark, RgbSpace::REC_709).map(|_| ()), text);
}

#[test]
fn colours_and_models_say_what_is_out_of_range() {
    let point = [0.3, 0.3];
    let chromaticity = "a chromaticity of the RGB space is not finite, or its y is 0";
    assert_refused(RgbSpace::new([[0.6, 0.0], [0.3, 0.6], [0.1, 0.1]], point), chromaticity);
    let degenerate = "the primaries lie on one line, or white on a line through two of them";
    assert_refused(RgbSpace::new([[0.2, 0.2], [0.3, 0.3], [0.4, 0.4]], [0.3, 0.4]), degenerate);
    let upsampler = Upsampler::<f64>::d65(&RgbSpace::REC_709).unwrap();
    assert_refused(upsampler.reflectance([0.5, 1.5, 0.5]), "component 1 of the colour is outside its range");
    let ward = Ward::new(Variant::Balanced, 0.1, 0.1).unwrap();
    assert_refused(Glossy::new(1.5, 0.0, ward), "a reflectance must be between 0 and 1");
    assert_refused(Glossy::new(0.6, 0.6, ward), "the specular and the diffuse reflectance add up to more than 1");
    assert_refused(Schlick::new(0.5, 0.0), "an isotropy must be above 0 and at most 1");
}
