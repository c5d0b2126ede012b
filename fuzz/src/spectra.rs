//! Spectra of every kind, and their integrals.

use spectral_core::spectrum::{
    Constant, Daylight, Line, Lines, Outside, PiecewiseLinear, Planck, RadiationConstant, Rounding, Scaled, Spectrum,
    Uniform,
};
use spectral_core::{Observer, Real, tristimulus};

use crate::numbers::Numbers;

/// Makes a spectrum of the bytes, if they are taken, walks over its pieces and integrates it.
pub fn spectra(bytes: &[u8]) {
    check::<f64>(&mut Numbers::new(bytes));
    check::<f32>(&mut Numbers::new(bytes));
}

fn check<R: Real>(numbers: &mut Numbers) {
    let outside = if numbers.byte().is_multiple_of(2) { Outside::Zero } else { Outside::Hold };
    match numbers.below(8) {
        0 => accept(&Constant::new(numbers.any::<R>()), numbers),
        1 => accept(&Planck::<R>::new(numbers.any(), RadiationConstant::Its1990), numbers),
        2 => {
            let kelvin: R = R::from_f64(3900.0 + 21_200.0 * numbers.unit::<R>().to_f64());
            accept(&Daylight::new(kelvin, Rounding::ThreeDecimals), numbers);
        }
        3 => accept(&Line::<R>::new(wavelength(numbers), wavelength(numbers), numbers.any()), numbers),
        4 => {
            let centres = [near_visible(numbers), near_visible(numbers), near_visible(numbers)];
            let powers: [R; 3] = numbers.any_vector();
            accept(&Lines::new(&centres, &powers, wavelength(numbers)), numbers);
        }
        5 => {
            let values: Vec<R> = nodes(numbers);
            accept(&Uniform::new(wavelength(numbers), wavelength(numbers), &values, outside), numbers);
        }
        6 => {
            let values: Vec<R> = nodes(numbers);
            let wavelengths: Vec<R> = values.iter().map(|_| wavelength(numbers)).collect();
            accept(&PiecewiseLinear::new(&wavelengths, &values, outside), numbers);
        }
        _ => {
            let values: Vec<R> = nodes(numbers);
            let mut wavelength = near_visible::<R>(numbers);
            let wavelengths: Vec<R> = values
                .iter()
                .map(|_| {
                    let here = wavelength;
                    wavelength += numbers.positive::<R>(2);
                    here
                })
                .collect();
            let (spectrum, factor) = (PiecewiseLinear::new(&wavelengths, &values, outside), numbers.any::<R>());
            accept_scaled(&spectrum.and_then(|spectrum| Scaled::new(spectrum, factor)), factor, numbers);
        }
    }
}

/// Values at nodes may be up to half the largest number: what is larger is halved.
fn nodes<R: Real>(numbers: &mut Numbers) -> Vec<R> {
    let within = |value: R| if value.is_finite() && value.abs() > R::MAX * R::HALF { value * R::HALF } else { value };
    (0..numbers.below(7)).map(|_| within(numbers.any())).collect()
}

/// A millimetre at most: what is far larger has no nanometres.
fn wavelength<R: Real>(numbers: &mut Numbers) -> R {
    let any: R = numbers.any();
    if any.abs().to_f64() <= 1e6 || !any.is_finite() { any } else { R::ZERO }
}

fn near_visible<R: Real>(numbers: &mut Numbers) -> R {
    R::from_f64(350.0 + 450.0 * numbers.unit::<R>().to_f64())
}

fn accept<R: Real, S: Spectrum<R>, E: core::fmt::Display>(spectrum: &Result<S, E>, numbers: &mut Numbers) {
    accept_scaled(spectrum, R::ONE, numbers);
}

/// The same for one that is a factor times another, whose values may be subnormal.
fn accept_scaled<R: Real, S: Spectrum<R>, E: core::fmt::Display>(
    spectrum: &Result<S, E>,
    factor: R,
    numbers: &mut Numbers,
) {
    match spectrum {
        Err(error) => super::assert_one_line(&error.to_string()),
        Ok(spectrum) => judge(spectrum, factor.abs().max(R::ONE).to_f64() * R::MIN_POSITIVE.to_f64(), numbers),
    }
}

/// `normal` is how small values of the spectrum may be without being coarse.
fn judge<R: Real>(spectrum: &impl Spectrum<R>, normal: f64, numbers: &mut Numbers) {
    let [from, to] = [380.0, 780.0].map(R::from_f64);
    let (mut largest, mut pieces) = (R::ZERO, 0);
    let mut wavelength = from;
    while wavelength < to {
        let piece = spectrum.segment(wavelength);
        assert!(piece.end > wavelength, "the walk stands still at {wavelength}: {piece:?}");
        // A value at a node may be that of either side; between nodes there is one.
        let middle = wavelength + (piece.end.min(to) - wavelength) * R::HALF;
        assert_eq!(spectrum.segment(middle).first, spectrum.value(middle), "at {middle}");
        largest = largest.max(piece.first.abs()).max(piece.last.abs());
        wavelength = piece.end;
        pieces += 1;
        assert!(pieces < 10_000, "endless pieces");
    }
    let any: R = numbers.any();
    if any.is_finite() {
        let piece = spectrum.segment(any);
        assert!(piece.end > any, "the walk stands still at {any}: {piece:?}");
    }
    // ∫ā is at most 107 nm.
    if !(largest.to_f64() <= R::MAX.to_f64() / 1e6) {
        return;
    }
    let observer = Observer::cie_1931_2deg();
    let whole = tristimulus(&observer, spectrum, from, to);
    let cut = R::from_f64(380.0 + 400.0 * numbers.unit::<R>().to_f64());
    let parts = [tristimulus(&observer, spectrum, from, cut), tristimulus(&observer, spectrum, cut, to)];
    for a in 0..3 {
        let sum = parts[0][a] + parts[1][a];
        let most = 64.0 * R::EPSILON.to_f64() * 110.0 * largest.to_f64() + 1e3 * normal;
        assert!((sum - whole[a]).abs().to_f64() <= most, "{parts:?} isn't {whole:?}, cut at {cut}");
    }
}
