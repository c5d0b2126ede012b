//! Spectra for colours.

use std::sync::OnceLock;

use spectral_core::Real;
use spectral_core::colour::RgbSpace;
use spectral_core::spectrum::{Spectrum, Uniform};
use spectral_core::upsampling::smits::Basis;
use spectral_core::upsampling::{LightUpsampler, Sigmoid, Upsampler, UpsamplingError};

use crate::numbers::{Numbers, assert_in};

/// Finds reflectances and lights for colours made of the bytes, which must come back.
pub fn upsampling(bytes: &[u8]) {
    static DOUBLE: OnceLock<Setup<f64>> = OnceLock::new();
    static SINGLE: OnceLock<Setup<f32>> = OnceLock::new();
    check(DOUBLE.get_or_init(Setup::new), &mut Numbers::new(bytes), 1e-12);
    check(SINGLE.get_or_init(Setup::new), &mut Numbers::new(bytes), 1e-5);
}

struct Setup<R: Real> {
    reflectances: Upsampler<R>,
    lights: LightUpsampler<Uniform<'static, R>, R>,
    bases: [Basis<R>; 2],
}

impl<R: Real> Setup<R> {
    fn new() -> Self {
        Self {
            reflectances: Upsampler::d65(&RgbSpace::REC_709).expect("D65 is white"),
            lights: LightUpsampler::d65(&RgbSpace::REC_709).expect("D65 is white"),
            bases: [Basis::reflectances(), Basis::lights()],
        }
    }
}

fn check<R: Real>(setup: &Setup<R>, numbers: &mut Numbers, accuracy: f64) {
    let any: [R; 3] = numbers.any_vector();
    match setup.reflectances.reflectance(any) {
        Ok(found) => come_back(setup, any, &found, accuracy),
        Err(UpsamplingError::Component { channel }) => assert!(!(any[channel] >= R::ZERO && any[channel] <= R::ONE)),
        Err(_) => {}
    }
    // No smaller than what has all its digits.
    let rgb = numbers.units::<R, 3>().map(|c| if c.to_f64() >= 1e-30 { c } else { R::ZERO });
    let found = setup.reflectances.reflectance(rgb).unwrap_or_else(|error| panic!("{error} for {rgb:?}"));
    come_back(setup, rgb, &found, accuracy);

    let scale: R = numbers.positive(20);
    let light = rgb.map(|c| c * scale);
    let emission = setup.lights.emission(light).unwrap_or_else(|error| panic!("{error} for {light:?}"));
    let most = light.iter().fold(0.0, |most: f64, c| most.max(c.to_f64()));
    for (back, c) in setup.lights.colour(&emission).into_iter().zip(light) {
        let error = accuracy.max(if size_of::<R>() == 4 { 0.03 } else { 1e-7 }) * most + R::MIN_POSITIVE.to_f64();
        assert_in(back - c, -error, error, "light");
    }
    assert_in(emission.value(R::from_f64(555.0)), 0.0, f64::MAX, "emission");

    for basis in &setup.bases {
        if let Ok(bins) = basis.spectrum(any) {
            bins.values().into_iter().for_each(|value| assert!(value >= R::ZERO, "{value} for {any:?}"));
        }
        let (bins, twice) = (basis.spectrum(rgb), basis.spectrum(rgb.map(|c| c + c)));
        let doubled = bins.expect("a colour").values().map(|v| v + v);
        assert_eq!(doubled, twice.expect("a colour").values(), "linear in scale");
    }
    if let Some(sigmoid) = Sigmoid::new(any) {
        let value = sigmoid.value(numbers.within(1e6));
        assert!(value.is_nan() || (value >= R::ZERO && value <= R::ONE), "{value} of {sigmoid:?}");
    }
}

fn come_back<R: Real>(setup: &Setup<R>, rgb: [R; 3], found: &Sigmoid<R>, accuracy: f64) {
    for (back, c) in setup.reflectances.colour(found).into_iter().zip(rgb) {
        assert_in(back - c, -accuracy, accuracy, "reflectance");
    }
    for wavelength in [380.0, 444.4, 555.0, 780.0] {
        assert_in(found.value(R::from_f64(wavelength)), 0.0, 1.0, "reflectance");
    }
}
