//! Colour rendering: reference lights rate 100, bad lights are refused or rated, special cases.
#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "helpers of tests")]

use spectral_core::Real;
use spectral_core::adaptation::{Cie1994, Cie1994Conditions};
use spectral_core::cct::CctStatus;
use spectral_core::colour::xyz::{WHITE_A, WHITE_D65};
use spectral_core::colour_rendering::{ReferenceKind, ReferenceLight, fidelity};
use spectral_core::light::{FidelityMeter, LightError, LightMeter, measure, measure_fidelity};
use spectral_core::spectrum::{Daylight, Outside, Planck, RadiationConstant, Rounding};
use spectral_core::summation::{Illuminated, SumGrid};
use spectral_core::tables::find_light;

const GRID: SumGrid<81> = SumGrid::CIE_5NM;
const CONSTANT: RadiationConstant = RadiationConstant::Its1990;

/// The general indices that share the reference light of the colour temperature, and the lowest special one of R_a.
fn indices<R: Real>(meter: &LightMeter<R, 81>, light: &[R; 81]) -> [f64; 5] {
    let rendering = meter.measure(light).unwrap().rendering.unwrap();
    let lowest = rendering.ra.special.iter().fold(R::INFINITY, |a, &b| a.min(b));
    [
        rendering.ra.general,
        lowest,
        rendering.cri00_munsell.general,
        rendering.cri00_colorchecker.general,
        rendering.r96_tcc_lab.general,
    ]
    .map(R::to_f64)
}

fn black_bodies_rate_100<R: Real>(tolerance: f64) {
    let meter = Box::new(LightMeter::<R, 81>::new(GRID, CONSTANT));
    let mut worst: f64 = 0.0;
    for step in 0..200 {
        let temperature = R::from_f64(1000.0 + 3999.0 * f64::from(step) / 199.0);
        let planck = Planck::new(temperature, CONSTANT).unwrap();
        let light = core::array::from_fn(|i| planck.radiance(GRID.wavelength(i)));
        for index in indices(&meter, &light) {
            worst = worst.max((100.0 - index).abs());
            assert!((100.0 - index).abs() <= tolerance, "{temperature} K: {index}");
        }
    }
    println!("largest deviation from 100: {worst:e}");
}

#[test]
fn black_bodies_below_5000_k_rate_100() {
    black_bodies_rate_100::<f64>(1e-4);
}

#[test]
fn black_bodies_below_5000_k_rate_100_in_single_precision() {
    black_bodies_rate_100::<f32>(1e-2);
}

/// Daylight of T has a colour temperature that differs from T by a few K, since the locus of the daylights is a fit; so
/// the reference is the daylight of another temperature. That is all of the rest.
#[test]
fn daylights_from_5000_k_rate_nearly_100() {
    let meter = Box::new(LightMeter::<f64, 81>::new(GRID, CONSTANT));
    let mut worst: f64 = 0.0;
    for step in 0..=200 {
        let temperature = 5010.0 + 19_000.0 * f64::from(step) / 200.0;
        let light = GRID.sample(&Daylight::new(temperature, Rounding::None).unwrap());
        let found = meter.measure(&light).unwrap();
        assert_eq!(found.chromaticity.reference.unwrap().kind, ReferenceKind::Daylight, "{temperature} K");
        for index in indices(&meter, &light) {
            worst = worst.max((100.0 - index).abs());
            assert!((100.0 - index).abs() <= 0.1, "{temperature} K: {index}");
        }
        let own = found.chromaticity.reference.unwrap().temperature;
        let again = GRID.sample(&Daylight::new(own, Rounding::None).unwrap());
        let difference = light.iter().zip(&again).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(difference > 0.0 || own == temperature, "the rest would have no cause");
    }
    println!("largest deviation from 100: {worst:e}");
}

#[test]
fn the_reference_changes_at_5000_k_exactly() {
    let kind = |t: f64| ReferenceLight::for_temperature(t).map(|light| light.kind);
    assert_eq!(kind(5000.0_f64.next_down()), Some(ReferenceKind::Planckian));
    assert_eq!(kind(5000.0), Some(ReferenceKind::Daylight));
    assert_eq!(kind(25_000.0), Some(ReferenceKind::Daylight));
    assert_eq!(kind(25_000.0_f64.next_up()), None);
    assert_eq!(kind(500.0), Some(ReferenceKind::Planckian));
    assert_eq!(kind(500.0_f64.next_down()), None);
    assert_eq!(kind(f64::NAN), None);
    // The same through a whole measurement, a little to both sides.
    for (temperature, expected) in [(4999.9, ReferenceKind::Planckian), (5000.1, ReferenceKind::Daylight)] {
        let planck = Planck::new(temperature, CONSTANT).unwrap();
        let light = core::array::from_fn(|i| planck.radiance(GRID.wavelength(i)));
        let found = measure(GRID, &light, CONSTANT).unwrap();
        assert_eq!(found.chromaticity.reference.unwrap().kind, expected, "{temperature} K");
    }
}

fn lines_have_numbers_or_a_status<R: Real>() {
    let meter = Box::new(LightMeter::<R, 81>::new(GRID, CONSTANT));
    for index in 0..81 {
        for level in [1e-30, 1.0, 1e30] {
            let mut light = [R::ZERO; 81];
            light[index] = R::from_f64(level);
            let found = meter.measure(&light).unwrap();
            let cct = found.chromaticity.cct;
            assert!(cct.temperature.is_finite() && cct.duv.is_finite(), "line {index}");
            assert!(found.chromaticity.xy.iter().all(|c| c.is_finite()));
            assert!(found.action.luminous_efficacy.is_finite() && found.action.acv.is_finite());
            if let Some(rendering) = found.rendering {
                for general in [rendering.ra.general, rendering.cri00_munsell.general] {
                    assert!(general.is_finite(), "line {index}: {general}");
                    assert!(general < R::from_f64(100.0), "line {index}: {general}");
                }
            } else {
                assert!(!cct.is_in_range() || cct.temperature > R::from_f64(25_000.0));
            }
            let near = cct.duv.abs() <= R::from_f64(0.05) && cct.is_in_range();
            assert_eq!(cct.status == CctStatus::Valid, near, "line {index}: {cct:?}");
            // Blue and green lines, up to 560 nm, are far from the locus or beyond its ends.
            assert!(!near || index > 36, "line {index}: {cct:?}");
        }
    }
}

#[test]
fn monochromatic_lights_have_numbers_or_a_status() {
    lines_have_numbers_or_a_status::<f64>();
    lines_have_numbers_or_a_status::<f32>();
}

#[test]
fn bad_lights_are_refused() {
    let good = [1.0; 81];
    let with = |index: usize, value: f64| {
        let mut light = good;
        light[index] = value;
        light
    };
    for (light, expected) in [
        ([0.0; 81], LightError::Dark),
        (with(7, f64::NAN), LightError::Value { index: 7 }),
        (with(80, f64::INFINITY), LightError::Value { index: 80 }),
        (with(0, -1e-300), LightError::Negative { index: 0 }),
    ] {
        assert_eq!(measure(GRID, &light, CONSTANT).unwrap_err(), expected);
        assert_eq!(LightMeter::new(GRID, CONSTANT).chromaticity(&light).unwrap_err(), expected);
        assert_eq!(measure_fidelity(GRID, &light, CONSTANT).unwrap_err(), expected);
    }
    assert!(measure(GRID, &with(3, -0.0), CONSTANT).is_ok());
}

/// `independent`: `colour_fidelity_index_ANSIIESTM3018` of colour-science 0.4.7, with its colour temperature and reference
/// light brought to the same convention: the Planckian locus summed at 5 nm (it takes 1 nm) and the factors of daylight not
/// rounded. As it is, its R_f differ by up to 0.005 and its R_g by up to 0.001. What is left is its colour temperature, off
/// by up to 0.01 K.
#[test]
fn fidelity_agrees_with_colour_science() {
    let meter = Box::new(FidelityMeter::<f64, 81>::new(GRID, CONSTANT));
    for (name, rf, rg) in FIDELITY {
        let light = GRID.sample(&find_light(name).unwrap().spectrum(Outside::Zero));
        let found = meter.measure(&light).unwrap().unwrap();
        assert!((found.rf - rf).abs() <= 1e-4, "{name}: R_f {}", found.rf);
        assert!((found.rg - rg).abs() <= 1e-4, "{name}: R_g {}", found.rg);
        let single = measure_fidelity(GRID, &light, CONSTANT).unwrap().unwrap();
        assert_eq!(format!("{single:?}"), format!("{found:?}"));
    }
}

const FIDELITY: [(&str, f64, f64); 13] = [
    ("A", 100.000422, 99.999986),
    ("D65", 99.994944, 100.000155),
    ("FL1", 80.640277, 89.831821),
    ("FL2", 70.120979, 86.416300),
    ("FL4", 56.699052, 83.491155),
    ("FL7", 91.476402, 98.897237),
    ("FL11", 80.040718, 101.056659),
    ("FL3.1", 55.330595, 83.981778),
    ("FL3.9", 77.400878, 99.960423),
    ("HP1", 34.192113, 53.966899),
    ("HP3", 83.190245, 97.168301),
    ("LED-B1", 84.082034, 96.148058),
    ("LED-RGB1", 71.000702, 107.008181),
];

/// Saturated colours have negative cone responses, of which there is no power.
#[test]
fn non_linear_adaptation_of_negative_responses_is_finite() {
    let transform = Cie1994::new(WHITE_A, WHITE_D65, &Cie1994Conditions::default());
    for xyz in [[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, -1.0], [-1.0; 3]] {
        let adapted: [f64; 3] = transform.apply(xyz);
        assert!(adapted.iter().all(|c| c.is_finite()), "{xyz:?}: {adapted:?}");
    }
}

/// `independent`: `XYZ_to_CIECAM02` (L_A = 100, Y_b = 20, average surround, illuminant discounted) and
/// `JMh_CIECAM02_to_CAM02UCS` of colour-science 0.4.7. All but the first sample have a cone response below zero under one of the lights.
#[test]
fn uniform_colours_agree_with_colour_science_also_where_a_cone_response_is_negative() {
    let samples = [[0.3, 0.4, 0.2], [0.3, 0.08, 0.0], [0.1, 0.3, -0.02], [0.06, 0.012, 0.3], [0.25, 0.03, 0.2]];
    let [daylight, blue] = [[0.95047, 1.0, 1.08883], [0.9, 1.0, 3.0]].map(|white| Illuminated { white, samples });
    let found = fidelity(&daylight, &blue);
    let expected = [
        [
            [71.7465795521, -16.4806271644, 21.0939903811],
            [42.1361360313, 76.1376283067, 29.1430977570],
            [61.1799765564, -47.8232500922, 61.2645706428],
            [12.7607204149, 1.8491434968, -38.1672390816],
            [21.3776033007, 96.9201158029, -13.1900082006],
        ],
        [
            [78.5736959319, 8.1928616415, 37.4187086869],
            [54.2349743117, 69.4699554056, 39.7318332364],
            [67.0307596711, -28.5103945078, 63.4538530301],
            [0.3095750554, 20.4067651795, -11.0310561127],
            [39.6100426597, 82.6125498411, 0.0995048646],
        ],
    ];
    for (found, expected) in [found.test_colours, found.reference_colours].iter().zip(expected) {
        for (found, expected) in found.iter().zip(expected) {
            for (found, expected) in found.iter().zip(expected) {
                let error: f64 = found - expected;
                assert!(error.abs() <= 1e-9, "{found} is not {expected}");
            }
        }
    }
}
