//! Prefiltered materials against the spectral truth.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use spectral_core::colour::RgbSpace;
use spectral_core::prefilter::{Prefilter, PrefilterError};
use spectral_core::spectrum::{Constant, Outside, Scaled, Spectrum};
use spectral_core::tables::{UniformTable, colorchecker, cornell, fluorescent, high_pressure, illuminants, led, lines};
use spectral_core::{Observer, Real};

/// The colour of light times reflectance by Simpson's rule at half nanometres: exact for these tables, whose nodes are at whole
/// nanometres, but for the product of three linear functions, which is cubic.
fn truth(light: &dyn Spectrum<f64>, reflectance: &dyn Spectrum<f64>, space: &RgbSpace) -> [f64; 3] {
    let observer = Observer::<f64>::cie_1931_2deg();
    let (mut xyz, mut equal) = ([0.0; 3], 0.0);
    for cell in 380..780 {
        for (offset, weight) in [(0.0, 1.0), (0.5, 4.0), (1.0, 1.0)] {
            let wavelength = f64::from(cell) + offset;
            let cmf = observer.value(wavelength);
            equal += weight * cmf[1];
            for a in 0..3 {
                xyz[a] += weight * light.value(wavelength) * reflectance.value(wavelength) * cmf[a];
            }
        }
    }
    space.from_xyz(xyz.map(|v| v / equal))
}

fn lights() -> Vec<UniformTable> {
    let mut lights = vec![illuminants::D65, illuminants::A, high_pressure::ALL[0], led::LED_B1];
    lights.extend(fluorescent::ALL.iter().copied());
    lights
}

fn materials() -> Vec<UniformTable> {
    colorchecker::ALL.iter().chain(cornell::ALL.iter()).copied().collect()
}

/// The direct term of every light and material, relative to the light's luminance.
fn assert_direct_terms_exact<R: Real>(space: RgbSpace, tolerance: f64) {
    let observer = Observer::<R>::cie_1931_2deg();
    for table in lights() {
        let light = table.spectrum::<R>(Outside::Zero);
        let prefilter = match Prefilter::new(&observer, &light, space) {
            Ok(prefilter) => prefilter,
            Err(error) => {
                // High-pressure sodium is beyond Rec. 709.
                assert_eq!((table.name, error), ("HP1", PrefilterError::Light { channel: 2 }));
                continue;
            }
        };
        let scale = prefilter.luminance().to_f64();
        for material in materials() {
            let exact = truth(&table.spectrum::<f64>(Outside::Zero), &material.spectrum::<f64>(Outside::Hold), &space);
            let filtered = prefilter.material(&material.spectrum::<R>(Outside::Hold));
            for channel in 0..3 {
                let seen = (prefilter.light()[channel] * filtered[channel]).to_f64();
                let error = (seen - exact[channel]).abs() / scale;
                assert!(error <= tolerance, "{} {}: {error:e}", table.name, material.name);
            }
        }
    }
}

#[test]
fn direct_terms_are_those_of_the_spectra() {
    for space in [RgbSpace::REC_709, RgbSpace::REC_2020, RgbSpace::ACESCG] {
        assert_direct_terms_exact::<f64>(space, 1e-13);
        assert_direct_terms_exact::<f32>(space, 1e-6);
    }
}

/// The dominant light turns grey, and a white material shows that grey.
#[test]
fn white_balance_makes_the_light_grey() {
    let observer = Observer::<f64>::cie_1931_2deg();
    let light = fluorescent::FL4.spectrum::<f64>(Outside::Zero);
    let prefilter = Prefilter::new(&observer, &light, RgbSpace::REC_709).unwrap();
    for component in prefilter.balanced(prefilter.light()) {
        assert!((component / prefilter.luminance() - 1.0).abs() <= 4.0 * f64::EPSILON);
    }
    let white = prefilter.material(&Constant::new(1.0).unwrap());
    assert!(white.iter().all(|c| (c - 1.0).abs() <= 32.0 * f64::EPSILON), "{white:?}");
    // The dominant light as another one: the same colour.
    for (other, own) in prefilter.other_light(&light).iter().zip(prefilter.light()) {
        assert!((other - own).abs() <= 32.0 * f64::EPSILON * own);
    }
    let brighter = Scaled::new(light, 1e6).unwrap();
    let brighter = Prefilter::new(&observer, &brighter, RgbSpace::REC_709).unwrap();
    let paint = colorchecker::BLUE.spectrum(Outside::Hold);
    for (a, b) in brighter.material(&paint).iter().zip(prefilter.material(&paint)) {
        assert!((a - b).abs() <= 64.0 * f64::EPSILON, "{a} {b}");
    }
}

#[test]
fn lights_without_a_component_are_refused() {
    let observer = Observer::<f64>::cie_1931_2deg();
    let black = Constant::new(0.0).unwrap();
    let refused = |light: &dyn Spectrum<f64>, space| Prefilter::new(&observer, light, space).err();
    assert_eq!(refused(&black, RgbSpace::REC_709), Some(PrefilterError::Light { channel: 0 }));
    let sodium = lines::SODIUM_D.spectrum::<f64>(2.0).unwrap();
    assert_eq!(refused(&sodium, RgbSpace::REC_709), Some(PrefilterError::Light { channel: 2 }));
    // Primaries on the far side of the spectral locus take every light.
    let wide = RgbSpace::new([[0.74, 0.27], [0.0, 1.0], [0.0, -0.08]], [1.0 / 3.0, 1.0 / 3.0]).unwrap();
    assert_eq!(refused(&sodium, wide), None);
}
