//! Round trips of sigmoid upsampling: over the gamut of sRGB, at its corners and edges, in the dark; reflectances and lights.
#![allow(clippy::unwrap_used, clippy::cast_possible_truncation, clippy::float_cmp, reason = "helpers of tests")]

use spectral_core::colour::{RgbSpace, decode_srgb};
use spectral_core::spectrum::{Constant, Outside, Scaled, Spectrum};
use spectral_core::tables::{self, UniformTable, illuminants};
use spectral_core::upsampling::{LightUpsampler, Sigmoid, Upsampler, UpsamplerError, UpsamplingError};
use spectral_core::{Observer, Real, tristimulus};
use spectral_tests::generators::Draw;

/// What the round trip may be off in each component: as documented.
const F64: f64 = 1e-12;
const F32: f64 = 1e-5;

fn worst_of_round_trips<R: Real>(upsampler: &Upsampler<R>, values: &[f64]) -> f64 {
    let mut worst = 0.0_f64;
    for &r in values {
        for &g in values {
            for &b in values {
                let rgb = [r, g, b].map(R::from_f64);
                let sigmoid = upsampler.reflectance(rgb).unwrap();
                for (back, c) in upsampler.colour(&sigmoid).into_iter().zip(rgb) {
                    let error = (back - c).abs().to_f64();
                    assert!(error.is_finite(), "{rgb:?}");
                    worst = worst.max(error);
                }
            }
        }
    }
    worst
}

/// 32³ colours, equidistant in linear components and in sRGB codes.
#[test]
fn the_gamut_of_srgb_comes_back() {
    let linear: Vec<f64> = (0..32).map(|i| f64::from(i) / 31.0).collect();
    let coded: Vec<f64> = linear.iter().map(|v| decode_srgb(*v)).collect();
    for values in [linear, coded] {
        let double = worst_of_round_trips(&Upsampler::<f64>::d65(&RgbSpace::REC_709).unwrap(), &values);
        let single = worst_of_round_trips(&Upsampler::<f32>::d65(&RgbSpace::REC_709).unwrap(), &values);
        println!("worst round trip: f64 {double:e}, f32 {single:e}");
        assert!(double <= F64 && single <= F32, "{double:e} {single:e}");
    }
}

/// Where Newton's method has the hardest time: next to the faces, edges and corners of the cube.
#[test]
fn the_borders_of_the_gamut_come_back() {
    let mut values = vec![0.0, 0.5, 1.0];
    for exponent in 1..=12 {
        let near = 10.0_f64.powi(-exponent);
        values.extend([near, 1.0 - near]);
    }
    let double = worst_of_round_trips(&Upsampler::<f64>::d65(&RgbSpace::REC_709).unwrap(), &values);
    let single = worst_of_round_trips(&Upsampler::<f32>::d65(&RgbSpace::REC_709).unwrap(), &values);
    println!("worst round trip: f64 {double:e}, f32 {single:e}");
    assert!(double <= F64 && single <= F32, "{double:e} {single:e}");
}

#[test]
fn every_dark_colour_comes_back_relatively() {
    let mut draw = Draw::new(3);
    let double = Upsampler::<f64>::d65(&RgbSpace::REC_709).unwrap();
    let single = Upsampler::<f32>::d65(&RgbSpace::REC_709).unwrap();
    let mut worst = [0.0_f64; 2];
    for _ in 0..3000 {
        let size = draw.magnitude(1e-30, 0.1);
        let rgb = core::array::from_fn(|_| if draw.once_in(4) { 0.0 } else { size * draw.unit() });
        let most = rgb.into_iter().fold(0.0, f64::max);
        let back = double.colour(&double.reflectance(rgb).unwrap());
        let narrow = single.colour(&single.reflectance(rgb.map(|c| c as f32)).unwrap());
        for channel in 0..3 {
            worst[0] = worst[0].max((back[channel] - rgb[channel]).abs() / most);
            worst[1] = worst[1].max((f64::from(narrow[channel]) - rgb[channel]).abs() / most);
        }
    }
    println!("worst relative error in the dark: {worst:?}");
    assert!(worst[0] <= 1e-7 && worst[1] <= 0.03, "{worst:?}");
}

/// The prepared weights against the crate's integrals of the spectrum times the light, by a route that shares nothing: 1/50 nm
/// steps of Simpson's rule, exact for cubic pieces whose ends are on the grid.
#[test]
fn the_colour_is_that_of_the_spectrum() {
    let upsampler = Upsampler::<f64>::d65(&RgbSpace::REC_709).unwrap();
    let (observer, light) = (Observer::<f64>::cie_1931_2deg(), illuminants::D65.spectrum::<f64>(Outside::Zero));
    for rgb in [[0.8, 0.3, 0.05], [0.0, 0.0, 1.0], [0.2, 0.9, 0.9]] {
        let sigmoid = upsampler.reflectance(rgb).unwrap();
        let [mut seen, mut white] = [[0.0; 3]; 2];
        for cell in 380..780 {
            for (offset, weight) in [(0.0, 1.0), (0.5, 4.0), (1.0, 1.0)] {
                let wavelength = f64::from(cell) + offset;
                let cmf = observer.value(wavelength);
                for a in 0..3 {
                    let part = weight * light.value(wavelength) * cmf[a];
                    white[a] += part;
                    seen[a] += part * sigmoid.value(wavelength);
                }
            }
        }
        let [seen, white] = [seen, white].map(|xyz| RgbSpace::REC_709.from_xyz(xyz));
        for channel in 0..3 {
            assert!((seen[channel] / white[channel] - rgb[channel]).abs() <= 1e-12, "{rgb:?}");
        }
    }
}

/// The documented distance of the white from that of the standard.
#[test]
fn white_is_nearly_that_of_srgb() {
    let light = illuminants::D65.spectrum::<f64>(Outside::Zero);
    let xyz = tristimulus(&Observer::cie_1931_2deg(), &light, 380.0, 780.0);
    let [r, g, b] = RgbSpace::REC_709.from_xyz(xyz.map(|v| v / xyz[1]));
    assert!((r - 1.0).abs() <= 1.3e-4 && (g - 1.0).abs() <= 2e-5 && (b - 1.0).abs() <= 5.1e-4, "{r} {g} {b}");
    let sum: f64 = xyz.iter().sum();
    assert!((xyz[0] / sum - 0.31274).abs() <= 5e-6 && (xyz[1] / sum - 0.32906).abs() <= 5e-6);
}

#[test]
fn greys_are_flat_and_black_and_white_exact() {
    let upsampler = Upsampler::<f32>::d65(&RgbSpace::REC_709).unwrap();
    for grey in [0.0, 1e-30, 1e-6, 0.18, 0.5, 0.999, 1.0_f32] {
        let sigmoid = upsampler.reflectance([grey; 3]).unwrap();
        for wavelength in [0.0, 380.0, 561.3, 780.0, 1e6] {
            assert!((sigmoid.value(wavelength) - grey).abs() <= 4.0 * f32::EPSILON * grey, "{grey}");
        }
    }
    assert_eq!(upsampler.reflectance([0.0; 3]).unwrap().value(555.0), 0.0);
    assert_eq!(upsampler.reflectance([1.0; 3]).unwrap().value(555.0), 1.0);
}

/// σ(−U) = 1 − σ(U): complements have complementary spectra.
#[test]
fn complements_have_complementary_spectra() {
    let upsampler = Upsampler::<f64>::d65(&RgbSpace::REC_709).unwrap();
    let mut draw = Draw::new(5);
    for _ in 0..200 {
        let rgb: [f64; 3] = core::array::from_fn(|_| draw.unit());
        let [this, other] = [rgb, rgb.map(|c| 1.0 - c)].map(|rgb| upsampler.reflectance(rgb).unwrap());
        for wavelength in [400.0, 500.0, 580.0, 700.0] {
            assert!((this.value(wavelength) + other.value(wavelength) - 1.0).abs() <= 1e-6, "{rgb:?}");
        }
    }
}

/// As documented: how far the piecewise linear spectrum is from the sigmoid itself.
#[test]
fn the_sigmoid_is_smooth_between_nodes() {
    let upsampler = Upsampler::<f64>::d65(&RgbSpace::REC_709).unwrap();
    let distance = |rgb| {
        let sigmoid = upsampler.reflectance(rgb).unwrap();
        let at = |tenth: i32| {
            let wavelength = 380.0 + 0.1 * f64::from(tenth);
            (sigmoid.smooth(wavelength) - sigmoid.value(wavelength)).abs()
        };
        (0..4000).map(at).fold(0.0, f64::max)
    };
    let (mut inner, mut all) = (0.0_f64, 0.0_f64);
    for r in 0..=10 {
        for g in 0..=10 {
            for b in 0..=10 {
                let found = distance([r, g, b].map(|c| f64::from(c) / 10.0));
                all = all.max(found);
                if [r, g, b].iter().all(|c| (1..=9).contains(c)) {
                    inner = inner.max(found);
                }
            }
        }
    }
    println!("sigmoid against its pieces: {inner} inside, {all} anywhere");
    assert!(inner <= 0.003 && all <= 0.03, "{inner} {all}");
}

/// Other spaces, lights and observers: what surfaces can reach comes back, the rest is refused by type.
#[test]
fn other_spaces_and_lights_are_served() {
    let lights: [UniformTable; 3] = [illuminants::A, tables::fluorescent::FL11, tables::led::LED_B3];
    let mut draw = Draw::new(9);
    for space in [RgbSpace::REC_709, RgbSpace::REC_2020, RgbSpace::ACESCG] {
        for light in lights {
            let light = light.spectrum::<f64>(Outside::Zero);
            let upsampler = Upsampler::new(&Observer::cie_1964_10deg(), &light, &space).unwrap();
            let (mut reached, mut refused) = (0, 0);
            for _ in 0..300 {
                let rgb: [f64; 3] = core::array::from_fn(|_| draw.unit());
                match upsampler.reflectance(rgb) {
                    Ok(sigmoid) => {
                        reached += 1;
                        for (back, c) in upsampler.colour(&sigmoid).into_iter().zip(rgb) {
                            assert!((back - c).abs() <= 5e-5, "{rgb:?} {back}");
                        }
                    }
                    Err(error) => {
                        refused += 1;
                        assert_eq!(error, UpsamplingError::Unreachable);
                    }
                }
            }
            println!("{reached} reached, {refused} refused");
            assert!(reached >= 200);
        }
    }
    let wide = Upsampler::<f64>::d65(&RgbSpace::REC_2020).unwrap();
    assert_eq!(wide.reflectance([0.0, 1.0, 0.0]), Err(UpsamplingError::Unreachable));
}

#[test]
fn colours_out_of_range_are_refused() {
    let upsampler = Upsampler::<f64>::d65(&RgbSpace::REC_709).unwrap();
    let lights = LightUpsampler::<_, f64>::d65(&RgbSpace::REC_709).unwrap();
    for bad in [-1e-12, 1.0 + 1e-12, f64::NAN, f64::INFINITY] {
        assert_eq!(upsampler.reflectance([0.5, bad, 0.5]), Err(UpsamplingError::Component { channel: 1 }));
    }
    for bad in [-1e-12, f64::NAN, f64::INFINITY, f64::MAX] {
        assert!(lights.emission([0.5, 0.5, bad]).is_err_and(|e| e == UpsamplingError::Component { channel: 2 }));
    }
    let (observer, space) = (Observer::cie_1931_2deg(), RgbSpace::REC_709);
    for dark in [0.0, -1.0] {
        let light = Constant::new(dark).unwrap();
        assert_eq!(Upsampler::<f64>::new(&observer, &light, &space), Err(UpsamplerError::White));
    }
    assert_eq!(Sigmoid::new([0.0, f32::NAN, 0.0]), None);
}

/// The light that comes back is the one of the crate's integrals, with luminance relative to ∫ȳ.
#[test]
fn lights_come_back() {
    let observer = Observer::<f64>::cie_1931_2deg();
    let lights = LightUpsampler::<_, f64>::d65(&RgbSpace::REC_709).unwrap();
    let one = tristimulus(&observer, &Constant::new(1.0).unwrap(), 380.0, 780.0)[1];
    let colour = |spectrum: &dyn Spectrum<f64>| {
        RgbSpace::REC_709.from_xyz(tristimulus(&observer, spectrum, 380.0, 780.0).map(|v| v / one))
    };
    let white = colour(&lights.emission([1.0; 3]).unwrap());
    let d65 = illuminants::D65.spectrum::<f64>(Outside::Zero);
    let [x, y, z] = tristimulus(&observer, &d65, 380.0, 780.0);
    let expected = RgbSpace::REC_709.from_xyz([x / y, 1.0, z / y]);
    for (white, expected) in white.iter().zip(expected) {
        assert!((white - expected).abs() <= 1e-9);
    }
    for rgb in [[1.0, 1.0, 1.0], [3.0, 0.1, 7.0], [0.0, 0.0, 1e20], [1e-20, 0.0, 0.0], [0.0, 5.0, 0.0]] {
        let emission = lights.emission(rgb).unwrap();
        let most = rgb.into_iter().fold(0.0, f64::max);
        for (((seen, white), own), c) in colour(&emission).iter().zip(white).zip(lights.colour(&emission)).zip(rgb) {
            assert!(
                (seen / white - c).abs() <= 1e-12 * most && (own - c).abs() <= 1e-12 * most,
                "{rgb:?} {seen} {own}"
            );
        }
    }
    let black = lights.emission([0.0; 3]).unwrap();
    assert_eq!(black.value(555.0), 0.0);
    // White is D65 itself, scaled: both are linear between the same nodes.
    let scaled = Scaled::new(d65, one / y).unwrap();
    let white = lights.emission([1.0; 3]).unwrap();
    for wavelength in 380..=780 {
        let (a, b) = (white.value(f64::from(wavelength)), scaled.value(f64::from(wavelength)));
        assert!((a - b).abs() <= 16.0 * f64::EPSILON * b, "{wavelength}");
    }
}

/// A spectrum that can be asked anywhere, in order, as integrals ask.
#[test]
fn segments_advance_and_meet() {
    let upsampler = Upsampler::<f32>::d65(&RgbSpace::REC_709).unwrap();
    let sigmoid = upsampler.reflectance([0.9, 0.2, 0.1]).unwrap();
    let mut wavelength = 300.0_f32;
    let mut last = None;
    while wavelength < 900.0 {
        let segment = sigmoid.segment(wavelength);
        assert!(segment.end > wavelength);
        assert!(last.is_none_or(|last: f32| (last - segment.first).abs() <= 4.0 * f32::EPSILON));
        last = Some(segment.last);
        wavelength = segment.end;
    }
    for just in [365.0_f32, 400.0, 555.0, 825.0, 830.0] {
        let below = f32::from_bits(just.to_bits() - 1);
        assert!(sigmoid.segment(below).end > below && sigmoid.segment(just).end > just);
        assert!((sigmoid.value(below) - sigmoid.value(just)).abs() <= 1e-5);
    }
    let coefficients = sigmoid.nanometre_coefficients();
    for wavelength in [400.0, 555.0, 640.0] {
        let u = (coefficients[0] * wavelength + coefficients[1]) * wavelength + coefficients[2];
        let value = 0.5 + u / (2.0 * (1.0 + u * u).sqrt());
        assert!((value - f64::from(sigmoid.smooth(wavelength as f32))).abs() <= 1e-5);
    }
}
