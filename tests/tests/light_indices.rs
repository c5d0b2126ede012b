//! Colour temperature, R_a and CRI00 alone, with interpolated reference lights: against the whole measurement, which has none.
#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "helpers of tests")]

use spectral_core::Real;
use spectral_core::light::{GeneralIndices, IndexMeter, LightError, LightMeter, measure_indices};
use spectral_core::spectrum::{Daylight, Outside, Planck, RadiationConstant, Rounding};
use spectral_core::summation::SumGrid;
use spectral_core::tables::{find_light, fluorescent, high_pressure, illuminants, led};

const GRID: SumGrid<81> = SumGrid::CIE_5NM;
const CONSTANT: RadiationConstant = RadiationConstant::Its1990;
fn both<R: Real>(found: &GeneralIndices<R>) -> [f64; 2] {
    [found.ra, found.cri00].map(|index| index.unwrap().to_f64())
}

/// A lamp's lines on a black body or daylight of a temperature in K, so that the colour temperature is near it.
fn lined(temperature: f64, lines: &[f64; 81]) -> [f64; 81] {
    let base: [f64; 81] = if temperature < 5000.0 {
        let planck = Planck::new(temperature, CONSTANT).unwrap();
        core::array::from_fn(|i| planck.radiance(GRID.wavelength(i)))
    } else {
        GRID.sample(&Daylight::new(temperature, Rounding::None).unwrap())
    };
    let scale = base.iter().sum::<f64>() / lines.iter().sum::<f64>();
    // Few lines where these, bluer or redder by far, would change the temperature a lot.
    let share = 0.2 * (temperature / 5000.0).min(1.0).powi(5) * (5000.0 / temperature).min(1.0).powi(2);
    core::array::from_fn(|i| base[i] + share * scale * lines[i])
}

/// The interpolation of the reference light is as good as stated at all temperatures, next to the joints of its pieces too.
#[test]
fn indices_are_those_of_the_whole_measurement_at_all_temperatures() {
    let (meter, whole) = (IndexMeter::<f64, 81>::new(GRID, CONSTANT), Box::new(LightMeter::new(GRID, CONSTANT)));
    let lines = GRID.sample(&find_light("FL11").unwrap().spectrum(Outside::Zero));
    let mut worst: f64 = 0.0;
    let (mut coldest, mut hottest) = (f64::INFINITY, 0.0_f64);
    for step in 0..4000 {
        // Equidistant in 1/T from 750 K to 24 000 K; at 698 K a black body's blue response in Bradford's transform, which
        // it is scaled by, passes through zero.
        let temperature = 1.0 / (1.0 / 750.0 + (1.0 / 24_000.0 - 1.0 / 750.0) * f64::from(step) / 3999.0);
        let light = lined(temperature, &lines);
        let found = meter.measure(&light).unwrap();
        let expected = whole.munsell(&light).unwrap();
        assert_eq!(found.chromaticity, expected.0);
        let expected = expected.1.unwrap().map(|index| index.general);
        for (index, expected) in both(&found).into_iter().zip(expected) {
            worst = worst.max((index - expected).abs());
            assert!((index - expected).abs() <= 1e-10, "{temperature} K: {index}, {expected}");
        }
        coldest = coldest.min(found.chromaticity.cct.temperature);
        hottest = hottest.max(found.chromaticity.cct.temperature);
    }
    assert!(coldest < 1000.0 && hottest > 20_000.0, "{coldest} K to {hottest} K");
    println!("largest distance from the whole measurement: {worst:e}");
}

#[test]
fn single_precision_is_as_accurate_as_stated() {
    let (double, single) = (IndexMeter::<f64, 81>::new(GRID, CONSTANT), IndexMeter::<f32, 81>::new(GRID, CONSTANT));
    let mut worst: f64 = 0.0;
    for table in [&illuminants::ALL[..], &fluorescent::ALL, &high_pressure::ALL, &led::ALL].concat() {
        let exact = both(&double.measure(&GRID.sample(&table.spectrum(Outside::Zero))).unwrap());
        let found = both(&single.measure(&GRID.sample(&table.spectrum(Outside::Zero))).unwrap());
        for (found, exact) in found.into_iter().zip(exact) {
            worst = worst.max((found - exact).abs());
            assert!((found - exact).abs() <= 5e-4, "{}: {found}, {exact}", table.name);
        }
    }
    println!("largest distance from double precision: {worst:e}");
}

fn black_bodies_rate_100<R: Real>(tolerance: f64) {
    let meter = IndexMeter::<R, 81>::new(GRID, CONSTANT);
    let mut worst: f64 = 0.0;
    for step in 0..400 {
        // Below 1000 K reference lights are not interpolated.
        let temperature = R::from_f64(800.0 + 4199.0 * f64::from(step) / 399.0);
        let planck = Planck::new(temperature, CONSTANT).unwrap();
        let light = core::array::from_fn(|i| planck.radiance(GRID.wavelength(i)));
        for index in both(&meter.measure(&light).unwrap()) {
            worst = worst.max((100.0 - index).abs());
            assert!((100.0 - index).abs() <= tolerance, "{temperature} K: {index}");
        }
    }
    println!("largest deviation from 100: {worst:e}");
}

#[test]
fn black_bodies_below_5000_k_rate_100() {
    black_bodies_rate_100::<f64>(1e-4);
    black_bodies_rate_100::<f32>(1e-2);
}

fn lines_have_numbers_or_a_status<R: Real>() {
    let meter = IndexMeter::<R, 81>::new(GRID, CONSTANT);
    let mut rated = 0;
    for index in 0..81 {
        for level in [1e-30, 1.0, 1e30] {
            let mut light = [R::ZERO; 81];
            light[index] = R::from_f64(level);
            let found = meter.measure(&light).unwrap();
            assert_eq!(found.ra.is_some(), found.chromaticity.reference.is_some());
            assert_eq!(found.cri00.is_some(), found.ra.is_some());
            for general in [found.ra, found.cri00].into_iter().flatten() {
                assert!(general.is_finite() && general < R::from_f64(100.0), "line {index}: {general}");
                rated += 1;
            }
        }
    }
    assert!(rated > 100, "{rated}");
}

#[test]
fn monochromatic_lights_have_numbers_or_a_status() {
    lines_have_numbers_or_a_status::<f64>();
    lines_have_numbers_or_a_status::<f32>();
}

/// Under one line all samples are grey, or have a chroma C of some 1e-14 from rounding and with it any hue. Against a
/// reference colour of chroma 20 that is a ΔH′ of 2 √(20 C), about 1e-6, which the coupling R_T ΔC′ ΔH′ carries into ΔE00.
#[test]
fn lines_are_those_of_the_whole_measurement() {
    let (meter, whole) = (IndexMeter::<f64, 81>::new(GRID, CONSTANT), Box::new(LightMeter::new(GRID, CONSTANT)));
    for index in 0..81 {
        let mut light = [0.0; 81];
        light[index] = 1.0;
        let (found, expected) = (meter.measure(&light).unwrap(), whole.munsell(&light).unwrap());
        assert_eq!(found.chromaticity, expected.0);
        let Some(expected) = expected.1 else { continue };
        let [ra, cri00] = both(&found);
        assert!((ra - expected[0].general).abs() <= 1e-10, "line {index}: R_a {ra}");
        assert!((cri00 - expected[1].general).abs() <= 5e-6, "line {index}: CRI00 {cri00}");
    }
}

#[test]
fn bad_lights_are_refused() {
    let with = |index: usize, value: f64| {
        let mut light = [1.0; 81];
        light[index] = value;
        light
    };
    let meter = IndexMeter::new(GRID, CONSTANT);
    for (light, expected) in [
        ([0.0; 81], LightError::Dark),
        ([-0.0; 81], LightError::Dark),
        (with(7, f64::NAN), LightError::Value { index: 7 }),
        (with(79, f64::NAN), LightError::Value { index: 79 }),
        (with(80, f64::NAN), LightError::Value { index: 80 }),
        (with(80, f64::INFINITY), LightError::Value { index: 80 }),
        (with(33, f64::NEG_INFINITY), LightError::Value { index: 33 }),
        (with(0, -1e-300), LightError::Negative { index: 0 }),
        (with(80, -5e-324), LightError::Negative { index: 80 }),
    ] {
        assert_eq!(meter.measure(&light).unwrap_err(), expected);
        assert_eq!(measure_indices(GRID, &light, CONSTANT).unwrap_err(), expected);
    }
    assert!(meter.measure(&with(3, -0.0)).is_ok());
}

/// The extremes of the range that a light is scaled from.
#[test]
fn the_smallest_and_largest_lights_are_measured() {
    let double = IndexMeter::new(GRID, CONSTANT).measure(&[1.0_f64; 81]).unwrap();
    for level in [f64::MAX, 2.0_f64.powi(1023), f64::MIN_POSITIVE, 1e-310] {
        let found = IndexMeter::new(GRID, CONSTANT).measure(&[level; 81]).unwrap();
        assert!((found.ra.unwrap() - double.ra.unwrap()).abs() <= 1e-10, "{level:e}");
    }
    let single = IndexMeter::new(GRID, CONSTANT).measure(&[1.0_f32; 81]).unwrap();
    for level in [f32::MAX, f32::MIN_POSITIVE, 1e-41] {
        let found = IndexMeter::new(GRID, CONSTANT).measure(&[level; 81]).unwrap();
        assert!((found.ra.unwrap() - single.ra.unwrap()).abs() <= 1e-3, "{level:e}");
    }
}

#[test]
fn the_meter_is_as_small_as_stated() {
    assert!(size_of::<IndexMeter<f64, 81>>() <= 65_536);
    assert!(size_of::<IndexMeter<f32, 81>>() <= 32_768);
}
