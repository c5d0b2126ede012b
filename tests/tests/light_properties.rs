//! Properties of the measures of a light, for random lights: smooth, peaked, with lines.
#![allow(
    clippy::unwrap_used,
    clippy::cast_precision_loss,
    clippy::cast_possible_truncation,
    reason = "helpers of tests"
)]

use proptest::prelude::*;
use proptest::test_runner::{Config, RngSeed};
use spectral_core::colour_rendering::{Cri00, Rendering, cie_13_3, cri00, munsell_samples};
use spectral_core::light::{
    FidelityMeter, IndexMeter, LightMeasures, LightMeter, measure, measure_fidelity, measure_indices,
};
use spectral_core::spectrum::RadiationConstant;
use spectral_core::summation::{DirectColours, Illuminated, PreparedColours, SumGrid, TestColours};
use spectral_core::tables::observers::CIE_1931_2;

const GRID: SumGrid<81> = SumGrid::CIE_5NM;
const CONSTANT: RadiationConstant = RadiationConstant::Its1990;

/// A slope with bumps of any width, down to single samples.
fn any_light() -> impl Strategy<Value = [f64; 81]> {
    let bump = (0.0..80.0_f64, 0.2..30.0_f64, 0.0..5.0_f64);
    (0.01..1.0_f64, 0.01..1.0_f64, proptest::collection::vec(bump, 0..5)).prop_map(|(first, last, bumps)| {
        core::array::from_fn(|i| {
            let t = i as f64;
            let base = first + (last - first) * t / 80.0;
            base + bumps.iter().map(|(c, w, h)| h * (-((t - c) / w).powi(2)).exp()).sum::<f64>()
        })
    })
}

fn in_single(light: &[f64; 81]) -> [f32; 81] {
    light.map(|power| power as f32)
}

/// The scalar results of a measurement that don't depend on the light's scale.
fn scalars(found: &LightMeasures<f64>) -> Vec<f64> {
    let mut all = vec![found.chromaticity.cct.duv, found.action.luminous_efficacy];
    all.extend([found.action.acv, found.action.sy_ratio, found.chromaticity.cct.temperature * 1e-3]);
    all.extend(found.chromaticity.xy);
    all.extend(found.action.alpha_opic.daylight_ratio);
    if let Some(rendering) = &found.rendering {
        all.extend(rendering.ra.special);
        all.extend(rendering.cri00_munsell.special);
        all.extend(rendering.cri00_colorchecker.special);
        all.extend(rendering.r96_tcc_lab.special);
    }
    all
}

fn bits(value: &impl core::fmt::Debug) -> String {
    // The shortest decimals that are read back as the same number: equal texts are equal bits.
    format!("{value:?}")
}

proptest! {
    #![proptest_config(Config { cases: 256, rng_seed: RngSeed::Fixed(0x5eed), failure_persistence: None, ..Config::default() })]

    #[test]
    fn the_batch_form_is_the_single_form_to_the_bit(light in any_light(), level in -30..=30_i32) {
        let light = light.map(|power| power * 10.0_f64.powi(level));
        let meter = Box::new(LightMeter::new(GRID, CONSTANT));
        let single = measure(GRID, &light, CONSTANT).unwrap();
        prop_assert_eq!(bits(&meter.measure(&light).unwrap()), bits(&single));
        let (chromaticity, indices) = meter.munsell(&light).unwrap();
        prop_assert_eq!(bits(&chromaticity), bits(&single.chromaticity));
        prop_assert_eq!(bits(&indices), bits(&single.rendering.map(|r| [r.ra, r.cri00_munsell])));

        let narrow = in_single(&light);
        let meter = Box::new(LightMeter::new(GRID, CONSTANT));
        let single = measure(GRID, &narrow, CONSTANT).unwrap();
        prop_assert_eq!(bits(&meter.measure(&narrow).unwrap()), bits(&single));
    }

    /// The general indices alone: both forms to the bit, and R_a and CRI00 of `measure`, which has them without
    /// interpolation, to rounding of its and of these.
    #[test]
    fn general_indices_are_those_of_a_whole_measurement(light in any_light(), level in -30..=30_i32) {
        let light = light.map(|power| power * 10.0_f64.powi(level));
        let found = IndexMeter::new(GRID, CONSTANT).measure(&light).unwrap();
        prop_assert_eq!(bits(&found), bits(&measure_indices(GRID, &light, CONSTANT).unwrap()));
        let whole = measure(GRID, &light, CONSTANT).unwrap();
        prop_assert_eq!(bits(&found.chromaticity), bits(&whole.chromaticity));
        prop_assert_eq!(found.ra.is_some(), whole.rendering.is_some());
        if let (Some(whole), Some(ra), Some(cri00)) = (&whole.rendering, found.ra, found.cri00) {
            prop_assert!((ra - whole.ra.general).abs() <= 1e-9, "R_a {ra}, {}", whole.ra.general);
            let expected = whole.cri00_munsell.general;
            prop_assert!((cri00 - expected).abs() <= 1e-9, "CRI00 {cri00}, {expected}");
        }

        let narrow = in_single(&light);
        let found = IndexMeter::new(GRID, CONSTANT).measure(&narrow).unwrap();
        prop_assert_eq!(bits(&found), bits(&measure_indices(GRID, &narrow, CONSTANT).unwrap()));
    }

    #[test]
    fn powers_of_two_change_no_bit_and_other_scales_only_rounding(light in any_light(), scale in -90.0..90.0_f64) {
        let meter = Box::new(LightMeter::new(GRID, CONSTANT));
        let found = meter.measure(&light).unwrap();
        let doubled = meter.measure(&light.map(|power| power * scale.floor().exp2())).unwrap();
        prop_assert_eq!(bits(&scalars(&found)), bits(&scalars(&doubled)));
        let ratio = scale.floor().exp2();
        prop_assert_eq!(found.action.sy * ratio, doubled.action.sy);
        prop_assert_eq!(found.power * ratio, doubled.power);
        let scaled = meter.measure(&light.map(|power| power * scale.exp2())).unwrap();
        for (a, b) in scalars(&found).iter().zip(scalars(&scaled)) {
            // Rounding of the samples, ε each, through differences of colours of about 100 and factors of about 10.
            prop_assert!((a - b).abs() <= 1e-10 * (1.0 + a.abs()), "{a} {b}");
        }
    }

    /// Ratios of linear functionals of a mixture lie between those of its parts; its chromaticity on the line between.
    #[test]
    fn a_mixture_is_between_its_parts(first in any_light(), second in any_light(), share in 0.0..1.0_f64) {
        let mixed: [f64; 81] = core::array::from_fn(|i| first[i] * share + second[i] * (1.0 - share));
        let [a, b, m] = [first, second, mixed].map(|light| measure(GRID, &light, CONSTANT).unwrap());
        let ratios = |found: &LightMeasures<f64>| {
            let mut all = vec![found.action.luminous_efficacy, found.action.acv, found.action.sy_ratio];
            all.extend(found.action.alpha_opic.efficacy);
            all.extend(found.chromaticity.xy);
            all
        };
        for ((a, b), m) in ratios(&a).into_iter().zip(ratios(&b)).zip(ratios(&m)) {
            let slack = 1e-13 * (a.abs() + b.abs());
            prop_assert!(m >= a.min(b) - slack && m <= a.max(b) + slack, "{a} {b}: {m}");
        }
        let sum = a.action.sy * share + b.action.sy * (1.0 - share);
        prop_assert!((m.action.sy - sum).abs() <= 1e-13 * sum);
    }

    #[test]
    fn the_order_of_samples_does_not_matter(test in any_light(), reference in any_light(), shift in 1..14_usize) {
        let observer = GRID.observer::<f64>(&CIE_1931_2);
        let samples = munsell_samples::<f64>();
        let permuted = core::array::from_fn(|i| samples[(i * 3 + shift) % 14]);
        let (plain, permuted) =
            (DirectColours::new(GRID, &observer, &samples), DirectColours::new(GRID, &observer, &permuted));
        let all = Cri00 { factor: 9.097, averaged: 14 };
        let pair = |colours: &dyn TestColours<f64, 81, 14>| -> [Illuminated<f64, 14>; 2] {
            [colours.illuminate(&test).unwrap(), colours.illuminate(&reference).unwrap()]
        };
        let ([t, r], [u, s]) = (pair(&plain), pair(&permuted));
        let (a, b) = (cri00(&t, &r, &all), cri00(&u, &s, &all));
        let (c, d) = (cie_13_3(&t, &r), cie_13_3(&u, &s));
        for i in 0..14 {
            prop_assert_eq!(bits(&a.special[(i * 3 + shift) % 14]), bits(&b.special[i]));
            prop_assert_eq!(bits(&c.special[(i * 3 + shift) % 14]), bits(&d.special[i]));
        }
        prop_assert!((a.general - b.general).abs() <= 14.0 * f64::EPSILON * (100.0 + a.general.abs()));
    }

    #[test]
    fn single_and_double_precision_agree(light in any_light()) {
        let double = measure(GRID, &light, CONSTANT).unwrap();
        let single = measure(GRID, &in_single(&light), CONSTANT).unwrap();
        for (a, b) in double.chromaticity.xy.iter().zip(single.chromaticity.xy) {
            prop_assert!((a - f64::from(b)).abs() <= SUM_ERROR);
        }
        let ratio = |a: f64, b: f32| (a - f64::from(b)).abs() <= SUM_ERROR * a.abs();
        prop_assert!(ratio(double.action.luminous_efficacy, single.action.luminous_efficacy));
        prop_assert!(ratio(double.action.sy_ratio, single.action.sy_ratio));
        prop_assert!(ratio(double.action.alpha_opic.melanopic_der(), single.action.alpha_opic.melanopic_der()));
        if let (Some(a), Some(b)) = (&double.rendering, &single.rendering) {
            let tolerances = tolerances(&a.ra);
            for ((x, y), tolerance) in a.ra.special.iter().zip(b.ra.special).zip(tolerances) {
                prop_assert!((x - f64::from(y)).abs() <= tolerance, "{x} {y} {tolerance}");
            }
        }
    }
}

/// The relative error of a tristimulus value in `f32`: two sums of 81 terms, the value's and that of Y it is divided by.
const SUM_ERROR: f64 = 2.0 * 81.0 * f32::EPSILON as f64;

/// How far special indices of CIE 13.3 move when every tristimulus value is off by its rounding: the sum of what each one
/// of them does alone, computed in `f64`.
fn tolerances(found: &Rendering<f64, 14>) -> [f64; 14] {
    let mut moved = [0.0; 14];
    for light in 0..2 {
        for target in 0..2 {
            for channel in 0..3 {
                let mut pair = [found.test, found.reference];
                let off = |xyz: &mut [f64; 3]| xyz[channel] *= 1.0 + SUM_ERROR;
                if target == 0 {
                    off(&mut pair[light].white);
                } else {
                    pair[light].samples.iter_mut().for_each(off);
                }
                let index = cie_13_3(&pair[0], &pair[1]);
                for (moved, (a, b)) in moved.iter_mut().zip(index.special.iter().zip(found.special)) {
                    *moved += (a - b).abs();
                }
            }
        }
    }
    moved
}

#[test]
fn fidelity_is_the_same_in_both_forms() {
    let meter = Box::new(FidelityMeter::<f32, 81>::new(GRID, CONSTANT));
    for level in 1..20_u16 {
        let light = core::array::from_fn(|i| 1.0 + f32::from(level) * ((i * 7 + usize::from(level)) % 11) as f32);
        let found = meter.measure(&light).unwrap();
        assert_eq!(bits(&found), bits(&measure_fidelity(GRID, &light, CONSTANT).unwrap()));
    }
}

#[test]
fn a_prepared_set_of_any_size_is_the_direct_one() {
    let observer = GRID.observer::<f64>(&CIE_1931_2);
    let samples = munsell_samples::<f64>();
    let light = core::array::from_fn(|i| 1.0 + ((i * 13) % 7) as f64);
    macro_rules! sizes {
        ($($size:literal),*) => {$({
            let some: [_; $size] = core::array::from_fn(|i| samples[i]);
            let direct = DirectColours::new(GRID, &observer, &some).illuminate(&light);
            let prepared = PreparedColours::new(GRID, &observer, &some).illuminate(&light);
            assert_eq!(bits(&direct), bits(&prepared), "{} samples", $size);
        })*};
    }
    sizes!(1, 2, 3, 5, 7, 8, 11, 14);
}
