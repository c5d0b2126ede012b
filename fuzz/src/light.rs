//! Light metrics.

use std::sync::OnceLock;

use spectral_core::Real;
use spectral_core::cct::{LocusTable, PlanckianLocus, correlated_colour_temperature};
use spectral_core::light::{
    GeneralIndices, IndexMeter, LightError, LightMeasures, LightMeter, measure, measure_fidelity, measure_indices,
};
use spectral_core::spectrum::RadiationConstant;
use spectral_core::summation::SumGrid;
use spectral_core::tables::observers::CIE_1931_2;

use crate::numbers::{Numbers, assert_finite, assert_in};

const GRID: SumGrid<81> = SumGrid::CIE_5NM;
const CONSTANT: RadiationConstant = RadiationConstant::Its1990;

/// The colour temperature of any chromaticity.
pub fn cct(bytes: &[u8]) {
    static DOUBLE: OnceLock<Loci<f64>> = OnceLock::new();
    static SINGLE: OnceLock<Loci<f32>> = OnceLock::new();
    DOUBLE.get_or_init(Loci::new).check(&mut Numbers::new(bytes));
    SINGLE.get_or_init(Loci::new).check(&mut Numbers::new(bytes));
}

/// Everything there is to say of a light made of the bytes; meters must agree with the functions.
pub fn light(bytes: &[u8]) {
    static DOUBLE: OnceLock<Box<Meters<f64>>> = OnceLock::new();
    static SINGLE: OnceLock<Box<Meters<f32>>> = OnceLock::new();
    DOUBLE.get_or_init(Meters::new).check(&mut Numbers::new(bytes));
    SINGLE.get_or_init(Meters::new).check(&mut Numbers::new(bytes));
}

struct Loci<R> {
    locus: PlanckianLocus<R, 81>,
    nodes: LocusTable<R>,
}

impl<R: Real> Loci<R> {
    fn new() -> Self {
        let locus = PlanckianLocus::new(GRID, &GRID.observer(&CIE_1931_2), CONSTANT);
        Self { locus, nodes: LocusTable::new(&locus) }
    }

    fn check(&self, numbers: &mut Numbers) {
        let any: [R; 2] = numbers.any_vector();
        let near: [R; 2] = numbers.units();
        for uv in [any, near] {
            let found = correlated_colour_temperature(uv, &self.nodes);
            assert_eq!(found, correlated_colour_temperature(uv, &self.locus), "tabulated nodes");
            let Some(found) = found else {
                assert!(!(uv[0].abs() < R::ONE && uv[1].abs() < R::ONE), "refused: {uv:?}");
                continue;
            };
            assert_in(found.temperature, 499.999, 100_001.0, "temperature");
            assert!(!found.duv.is_nan(), "{uv:?}: {found:?}");
        }
        // A black body's own temperature comes back.
        let mired = 11.0 + 1900.0 * numbers.unit::<R>().to_f64();
        let temperature = R::from_f64(1e6 / mired);
        let found = correlated_colour_temperature(self.locus.uv(temperature), &self.nodes).expect("on the locus");
        let error = (1e6 / found.temperature.to_f64() - 1e6 / temperature.to_f64()).abs();
        // Towards cold and hot ends the locus hardly moves: a chromaticity's rounding is many mired.
        let allowed = if size_of::<R>() == 4 { 0.5 } else { 1e-3 };
        assert!(error <= allowed && found.duv.abs().to_f64() <= allowed * 1e-3, "{temperature} K: {found:?}");
    }
}

struct Meters<R> {
    light: LightMeter<R, 81>,
    index: IndexMeter<R, 81>,
}

impl<R: Real> Meters<R> {
    fn new() -> Box<Self> {
        Box::new(Self { light: LightMeter::new(GRID, CONSTANT), index: IndexMeter::new(GRID, CONSTANT) })
    }

    fn check(&self, numbers: &mut Numbers) {
        let any = numbers.byte().is_multiple_of(16);
        let samples: [R; 81] = if any { refused(numbers) } else { decode(numbers) };
        let (found, indices) = (self.light.measure(&samples), self.index.measure(&samples));
        let (found, indices) = match (found, indices) {
            (Ok(found), Ok(indices)) => (found, indices),
            (Err(first), Err(second)) => {
                assert_eq!(first, second);
                return check_error(first, &samples);
            }
            (found, indices) => panic!("one of both: {:?}, {indices:?}", found.map(|f| f.chromaticity)),
        };
        let light_sum: f64 = samples.iter().map(|s| s.to_f64()).sum();
        if light_sum * 5.0 <= R::MAX.to_f64() / 1e6 && light_sum >= R::MIN_POSITIVE.to_f64() * 1e9 {
            finite(&found, &indices);
        }
        // The functions without tables cost a hundred times more.
        if numbers.byte().is_multiple_of(64) {
            assert_eq!(measure(GRID, &samples, CONSTANT), Ok(found));
            assert_eq!(measure_indices(GRID, &samples, CONSTANT), Ok(indices));
            let fidelity = measure_fidelity(GRID, &samples, CONSTANT).expect("a light");
            if let Some(fidelity) = fidelity {
                assert_in(fidelity.rf, 0.0, 100.0, "R_f");
            }
        }
    }
}

/// Lines, steps and a continuum.
fn decode<R: Real>(numbers: &mut Numbers) -> [R; 81] {
    let scale: R = numbers.positive(20);
    let base: R = numbers.unit();
    let mut samples = [base; 81];
    for _ in 0..1 + numbers.below(12) {
        let (from, width, value) = (numbers.below(81), numbers.below(81), numbers.unit::<R>());
        samples.iter_mut().skip(from).take(1 + width).for_each(|sample| *sample += value);
    }
    samples.map(|sample| sample * scale)
}

/// Anything at all.
fn refused<R: Real>(numbers: &mut Numbers) -> [R; 81] {
    core::array::from_fn(|_| if numbers.byte() < 128 { R::ONE } else { numbers.any() })
}

fn check_error<R: Real>(error: LightError, samples: &[R; 81]) {
    match error {
        LightError::Value { index } => assert!(!samples[index].is_finite()),
        LightError::Negative { index } => assert!(samples[index] < R::ZERO),
        LightError::Dark => {
            let most = samples.iter().fold(R::ZERO, |most, s| most.max(*s));
            assert!(most <= R::MIN_POSITIVE * R::from_f64(1e9), "called dark: {most}");
        }
        other => panic!("{other}"),
    }
}

fn finite<R: Real>(found: &LightMeasures<R>, indices: &GeneralIndices<R>) {
    let chromaticity = &found.chromaticity;
    assert_finite(&chromaticity.xyz, "XYZ");
    assert_finite(&chromaticity.xy, "xy");
    assert_finite(&[chromaticity.cct.temperature, chromaticity.cct.duv, found.power], "temperature, power");
    assert_eq!(indices.chromaticity, *chromaticity);
    assert_in(found.r96_c.rendering.general, -1e4, 100.0, "R96");
    let action = &found.action;
    assert_in(action.luminous_efficacy, 0.0, 683.1, "luminous efficacy");
    assert_finite(&[action.acv, action.sy, action.sy_ratio], "action factors");
    assert_finite(&action.alpha_opic.efficacy, "α-opic efficacies");
    assert_finite(&action.alpha_opic.daylight_ratio, "α-opic ratios");
    assert_eq!(found.rendering.is_some(), indices.ra.is_some());
    let Some(rendering) = &found.rendering else { return };
    assert_in(rendering.ra.general, -1e4, 100.0, "R_a");
    assert_finite(&rendering.ra.special, "R_i");
    assert_in(rendering.cri00_munsell.general, -1e4, 100.0, "CRI00");
    assert_in(rendering.cri00_colorchecker.general, -1e4, 100.0, "CRI00");
    assert_in(rendering.r96_tcc_lab.general, -1e4, 100.0, "R96");
    let (ra, cri00) = (indices.ra.expect("R_a"), indices.cri00.expect("CRI00"));
    assert_finite(&[ra, cri00], "indices");
    if size_of::<R>() == 8 && chromaticity.cct.temperature.to_f64() >= 750.0 {
        assert_in(ra - rendering.ra.general, -1e-9, 1e-9, "R_a of the table");
        // Under one line all samples are grey to rounding.
        assert_in(cri00 - rendering.cri00_munsell.general, -1e-4, 1e-4, "CRI00 of the table");
    }
}
