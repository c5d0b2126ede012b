//! Products of three-component colours, prefiltering and upsampling.

use core::fmt::Write;
use core::hint::black_box;

use spectral_core::bilinear::{ShaderLanguage, Tensor, estimate, estimate_rgb, write_operator};
use spectral_core::colour::RgbSpace;
use spectral_core::prefilter::Prefilter;
use spectral_core::spectrum::Outside;
use spectral_core::tables::{colorchecker, fluorescent, illuminants};
use spectral_core::upsampling::{LightUpsampler, Sigmoid, Upsampler, smits};
use spectral_core::{Observer, Real};

use crate::Run;
use crate::spectra::put_spectrum;

/// One of the built-in operators.
fn tensor<R: Real>(run: &mut Run) -> Tensor<R> {
    black_box(match run.below(4) {
        0 => Tensor::iso_rgb(),
        1 => Tensor::rec_709(),
        2 => Tensor::rec_2020(),
        _ => Tensor::acescg(),
    })
}

fn put_tensor<R: Real>(run: &mut Run, tensor: &Tensor<R>) {
    run.put_all(tensor.transfer().as_flattened());
}

/// Text into a digest.
struct Digest<'a>(&'a mut Run);

impl Write for Digest<'_> {
    fn write_str(&mut self, text: &str) -> core::fmt::Result {
        self.0.put_text(text);
        Ok(())
    }
}

entries! {
    bilinear_product 48 ["bilinear::Tensor::product"] |run, R| {
        let (tensor, c, d) = (tensor::<R>(run), run.array(0.0, 1.0), run.array(0.0, 1.0));
        let result = run.time_call(|| tensor.product(c, d));
        run.put_all(&result);
    }
    bilinear_reflection 32 [
        "bilinear::Tensor::reflection", "bilinear::Reflection::apply", "bilinear::Reflection::matrix",
        "bilinear::Reflection::after",
    ] |run, R| {
        let (tensor, reflectance, light) = (tensor::<R>(run), run.array(0.0, 1.0), run.array(0.0, 1.0));
        let result = run.time_call(|| tensor.reflection(reflectance).apply(light));
        run.put_all(&result);
        let matrix = core::array::from_fn(|_| run.array(-1.0, 1.0));
        run.put_all(tensor.reflection(reflectance).after(matrix).matrix().as_flattened());
    }
    bilinear_tensor 12 [
        "bilinear::Tensor::classical", "bilinear::Tensor::new", "bilinear::Tensor::from_matrices",
        "bilinear::Tensor::transfer", "bilinear::Tensor::matrices", "bilinear::Tensor::with_alpha",
        "bilinear::Tensor::alpha", "bilinear::Tensor::scaled", "bilinear::Tensor::iso_rgb", "bilinear::Tensor::rec_709",
        "bilinear::Tensor::rec_2020", "bilinear::Tensor::acescg",
    ] |run, R| {
        let built_in = tensor::<R>(run);
        put_tensor(run, &built_in);
        put_tensor(run, &Tensor::<R>::classical());
        let (alpha, factors) = (run.array(-0.5, 1.5), run.array(-0.1, 2.0));
        let altered = run.time_call(|| built_in.with_alpha(alpha));
        run.put_option(altered.ok(), |run, tensor| run.put_all(&tensor.alpha()));
        run.put_option(built_in.scaled(factors).ok(), |run, tensor| put_tensor(run, &tensor));
        let matrices = built_in.matrices();
        run.put_option(Tensor::from_matrices(&matrices, R::from_f64(1e-4)).ok(), |run, tensor| put_tensor(run, &tensor));
        let transfer = core::array::from_fn(|_| run.array(-0.2, 0.2));
        run.put_option(Tensor::<R>::new(transfer).ok(), |run, tensor| put_tensor(run, &tensor));
    }
    bilinear_division 24 [
        "bilinear::Tensor::divisor", "bilinear::Divisor::quotient", "bilinear::Divisor::condition",
        "bilinear::Divisor::relighting",
    ] |run, R| {
        let (tensor, colour, light) = (tensor::<R>(run), run.array(-0.01, 1.0), run.array(0.0, 1.0));
        let divisor = run.time_call(|| tensor.divisor(colour));
        run.put_option(divisor.ok(), |run, divisor| {
            run.put(divisor.condition());
            run.put_all(&divisor.quotient(light));
            run.put_all(divisor.relighting(&tensor, light).matrix().as_flattened());
        });
    }
    bilinear_estimate 3 ["bilinear::estimate", "bilinear::estimate_rgb"] |run, R| {
        let nodes: [[R; 3]; 6] = core::array::from_fn(|_| run.array(0.0, 1.0));
        let count = run.index(9);
        let found = run.time_call(|| {
            estimate(count, |index| nodes.get(index).copied().unwrap_or([R::HALF; 3]))
        });
        run.put_option(found.ok(), |run, found| put_tensor(run, &found.tensor));
        run.put_option(estimate_rgb::<R>(black_box(&RgbSpace::REC_709)).ok(), |run, found| {
            put_tensor(run, &found.tensor);
            run.put_all(found.raw.as_flattened().as_flattened());
        });
    }
    bilinear_shader 2 ["bilinear::write_operator"] |run, R| {
        let tensor = tensor::<R>(run);
        let language = if run.below(2) == 0 { ShaderLanguage::Wgsl } else { ShaderLanguage::Glsl };
        let name = black_box("reflect");
        let result = write_operator(&mut Digest(run), language, name, &tensor);
        run.put_bits(u64::from(result.is_ok()));
    }
    prefilter 1 [
        "prefilter::Prefilter::new", "prefilter::Prefilter::light", "prefilter::Prefilter::luminance",
        "prefilter::Prefilter::material", "prefilter::Prefilter::other_light", "prefilter::Prefilter::balanced",
    ] |run, R| {
        let observer = Observer::<R>::cie_1931_2deg();
        let (light, other) = (fluorescent::FL2.spectrum(Outside::Zero), illuminants::D65.spectrum(Outside::Zero));
        let paint = colorchecker::GREEN.spectrum(Outside::Hold);
        let space = black_box(RgbSpace::REC_709);
        run.put_option(Prefilter::new(&observer, &light, space).ok(), |run, prefilter| {
            run.put_all(&prefilter.light());
            run.put(prefilter.luminance());
            let material = run.time_call(|| prefilter.material(&paint));
            run.put_all(&material);
            run.put_all(&prefilter.other_light(&other));
            run.put_all(&prefilter.balanced(material));
        });
    }
    upsampling_reflectance 1 [
        "upsampling::Upsampler::d65", "upsampling::Upsampler::new", "upsampling::Upsampler::colour",
        "upsampling::Upsampler::reflectance",
    ] |run, R| {
        let space = black_box(RgbSpace::REC_709);
        let light = illuminants::D65.spectrum::<R>(Outside::Zero);
        run.put_bits(u64::from(Upsampler::new(&Observer::cie_1931_2deg(), &light, &space).is_ok()));
        run.put_option(Upsampler::<R>::d65(&space).ok(), |run, upsampler| {
            for _ in 0..2 {
                let rgb = run.array(0.0, 1.0);
                let found = run.time_call(|| upsampler.reflectance(rgb));
                run.put_option(found.ok(), |run, sigmoid| {
                    run.put_all(&sigmoid.coefficients());
                    run.put_all(&upsampler.colour(&sigmoid));
                });
            }
        });
    }
    upsampling_emission 1 [
        "upsampling::LightUpsampler::d65", "upsampling::LightUpsampler::new", "upsampling::LightUpsampler::emission",
        "upsampling::LightUpsampler::colour", "upsampling::Emission::sigmoid", "upsampling::Emission::scale",
        "upsampling::Spectrum for Emission",
    ] |run, R| {
        let space = black_box(RgbSpace::REC_709);
        let light = illuminants::A.spectrum::<R>(Outside::Zero);
        run.put_bits(u64::from(LightUpsampler::new(&Observer::cie_1931_2deg(), light, &space).is_ok()));
        run.put_option(LightUpsampler::<_, R>::d65(&space).ok(), |run, upsampler| {
            let rgb = run.array(0.0, 3.0);
            let found = run.time_call(|| upsampler.emission(rgb));
            run.put_option(found.ok(), |run, emission| {
                run.put(emission.scale());
                run.put_all(&emission.sigmoid().coefficients());
                run.put_all(&upsampler.colour(&emission));
                put_spectrum(run, &emission);
            });
        });
    }
    upsampling_sigmoid 24 [
        "upsampling::Sigmoid::new", "upsampling::Sigmoid::grey", "upsampling::Sigmoid::coefficients",
        "upsampling::Sigmoid::nanometre_coefficients", "upsampling::Sigmoid::smooth",
        "upsampling::Spectrum for Sigmoid",
    ] |run, R| {
        let coefficients = run.array::<R, 3>(-5.0, 5.0);
        run.put_option(Sigmoid::new(coefficients), |run, sigmoid| {
            let wavelength = run.within(300.0, 900.0);
            let value = run.time_call(|| sigmoid.smooth(wavelength));
            run.put(value);
            run.put_all(&sigmoid.nanometre_coefficients());
            put_spectrum(run, &sigmoid);
        });
        let value = run.within(-0.1, 1.1);
        run.put_all(&Sigmoid::<R>::grey(value).coefficients());
    }
    upsampling_smits 24 [
        "upsampling::Bins::values", "upsampling::Basis::reflectances", "upsampling::Basis::lights",
        "upsampling::Basis::spectrum", "upsampling::Spectrum for Bins",
    ] |run, R| {
        let rgb = run.array::<R, 3>(-0.02, 1.0);
        let basis = if run.below(2) == 0 { smits::Basis::reflectances() } else { smits::Basis::lights() };
        let found = run.time_call(|| basis.spectrum(rgb));
        run.put_option(found.ok(), |run, bins| {
            run.put_all(&bins.values());
            put_spectrum(run, &bins);
        });
    }
}
