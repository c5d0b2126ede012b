//! `<rgb>` in scenes: the spectra found for components have them.
#![allow(clippy::panic, clippy::unwrap_used, reason = "helpers of tests fail by panicking")]

use renderers::scene::{BsdfKind, D65_NORMALISATION, Emitter, Scene, Source, SpectrumKind, load};
use spectral_core::colour::RgbSpace;
use spectral_core::spectrum::{Outside, PiecewiseLinear, Spectrum};
use spectral_core::tables::illuminants::D65;
use spectral_core::{Observer, tristimulus};

fn scene(reflectance: [f64; 3], radiance: [f64; 3]) -> Scene {
    let text = |[r, g, b]: [f64; 3]| format!("{r:e} {g:e} {b:e}");
    let (reflectance, radiance) = (text(reflectance), text(radiance));
    let xml = format!(
        "<scene version='3.0.0'><sensor type='perspective'><float name='fov' value='40'/></sensor><shape type='sphere'>
         <bsdf type='diffuse'><rgb name='reflectance' value='{reflectance}'/></bsdf>
         <emitter type='area'><rgb name='radiance' value='{radiance}'/></emitter></shape></scene>"
    );
    load(&Source::text("rgb.xml", &xml), &[]).unwrap()
}

/// Tristimulus values of a table, times D65 for reflectances: summed at 0.25 nm.
fn xyz(kind: &SpectrumKind, under_d65: bool) -> [f64; 3] {
    let SpectrumKind::Table { wavelengths, values } = kind else { panic!("{kind:?}") };
    let spectrum = PiecewiseLinear::new(wavelengths, values, Outside::Zero).unwrap();
    let (observer, d65) = (Observer::cie_1931_2deg(), D65.spectrum::<f64>(Outside::Zero));
    let nodes: Vec<f64> = (0..=1600).map(|i| 380.0 + 0.25 * f64::from(i)).collect();
    let value = |w: &f64| spectrum.value(*w) * if under_d65 { d65.value(*w) / D65_NORMALISATION } else { 1.0 };
    let products: Vec<f64> = nodes.iter().map(value).collect();
    tristimulus(&observer, &PiecewiseLinear::new(&nodes, &products, Outside::Zero).unwrap(), 380.0, 780.0)
}

/// Components relative to those of D65 with Y = 1.
fn components(xyz: [f64; 3]) -> [f64; 3] {
    let white: Vec<f64> = D65.samples.double.iter().map(|v| v / D65_NORMALISATION).collect();
    let wavelengths =
        (0..u32::try_from(white.len()).unwrap()).map(|i| f64::from(D65.first) + 5.0 * f64::from(i)).collect();
    let white = self::xyz(&SpectrumKind::Table { wavelengths, values: white }, false);
    let [rgb, white] = [xyz, white].map(|v| RgbSpace::REC_709.from_xyz(v));
    core::array::from_fn(|c| rgb[c] / white[c])
}

fn close(found: [f64; 3], expected: [f64; 3], tolerance: f64) {
    for c in 0..3 {
        assert!((found[c] - expected[c]).abs() <= tolerance, "{found:?}, expected {expected:?}");
    }
}

#[test]
fn colours_come_back() {
    for rgb in [[0.8, 0.3, 0.05], [0.0, 1.0, 1.0], [1.0, 0.0, 0.0], [0.1, 0.1, 0.1001], [1e-3, 2e-3, 0.999]] {
        let light = rgb.map(|c| 40.0 * c);
        let scene = scene(rgb, light);
        let BsdfKind::Diffuse { reflectance } = scene.bsdfs[0].kind else { panic!("{:?}", scene.bsdfs) };
        let Emitter::Area { radiance, .. } = scene.emitters[0] else { panic!("{:?}", scene.emitters) };
        // The sums' step leaves 1e-6 of what is within 1e-12.
        close(components(xyz(&scene.spectrum(reflectance).kind, true)), rgb, 2e-6);
        close(components(xyz(&scene.spectrum(radiance).kind, false)), light, 8e-5);
    }
}

#[test]
fn greys_are_constants_and_multiples_of_d65() {
    let scene = scene([0.25; 3], [3.0; 3]);
    let kinds: Vec<_> = scene.spectra.iter().map(|s| s.kind.clone()).collect();
    assert_eq!(kinds, [SpectrumKind::Constant(0.25), SpectrumKind::D65 { scale: 3.0 }]);
}
