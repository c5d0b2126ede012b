//! Properties that every spectrum must have, for random spectra of both precisions at ordinary and at awkward
//! wavelengths.
#![allow(clippy::unwrap_used, clippy::panic, reason = "helpers of tests fail by panicking")]

use proptest::prelude::*;
use proptest::test_runner::{Config, RngSeed};
use spectral_core::Real;
use spectral_core::spectrum::{
    Constant, Daylight, Line, Lines, Outside, PiecewiseLinear, Planck, RadiationConstant, Rounding, Scaled, Spectrum,
    Uniform,
};
use spectral_core::tables;

fn config(cases: u32) -> Config {
    Config { cases, rng_seed: RngSeed::Fixed(0x5eed), failure_persistence: None, ..Config::default() }
}

/// A scalar with neighbours, of any bits.
trait Float: Real {
    fn up(self) -> Self;
    fn down(self) -> Self;
    fn of_bits(bits: u64) -> Self;
}

impl Float for f32 {
    fn up(self) -> Self {
        self.next_up()
    }
    fn down(self) -> Self {
        self.next_down()
    }
    fn of_bits(bits: u64) -> Self {
        let [low, _] = [bits & 0xffff_ffff, bits >> 32];
        Self::from_bits(u32::try_from(low).unwrap())
    }
}

impl Float for f64 {
    fn up(self) -> Self {
        self.next_up()
    }
    fn down(self) -> Self {
        self.next_down()
    }
    fn of_bits(bits: u64) -> Self {
        Self::from_bits(bits)
    }
}

/// The segment at a wavelength keeps what the trait promises.
fn check_at<R: Float>(spectrum: &impl Spectrum<R>, wavelength: R) {
    if !wavelength.is_finite() {
        return;
    }
    let piece = spectrum.segment(wavelength);
    assert!(piece.end > wavelength, "{piece:?} at {wavelength:?} does not advance");
    assert!(piece.first.is_finite() && piece.last.is_finite(), "{piece:?} at {wavelength:?}");
    assert!(piece.end.is_finite() || piece.first == piece.last, "{piece:?} at {wavelength:?} is not constant");
    assert!(spectrum.value(wavelength).is_finite());
}

/// Checks around the given wavelengths, at their neighbours and opposites, at extreme ones and at any bits.
fn check_everywhere<R: Float>(spectrum: &impl Spectrum<R>, nodes: &[R], bits: &[u64]) {
    let extremes = [R::ZERO, -R::ZERO, R::MIN_POSITIVE, R::MAX, -R::MAX, R::ONE, R::of_bits(1)];
    let any = bits.iter().map(|&bits| R::of_bits(bits));
    for wavelength in nodes.iter().copied().chain(extremes).chain(any) {
        for near in [wavelength, wavelength.up(), wavelength.down(), -wavelength] {
            check_at(spectrum, near);
        }
    }
}

/// The mean of two values by their distances: a form of linear interpolation without cancellation.
fn weighted(first: f64, last: f64, below: f64, above: f64) -> f64 {
    first * (above / (below + above)) + last * (below / (below + above))
}

/// Within a piece the spectrum is the line between its ends, up to rounding: relative where nothing is negative,
/// otherwise relative to `scale`, the largest magnitude.
fn check_linear<R: Float>(spectrum: &impl Spectrum<R>, wavelength: R, t: R, scale: f64) {
    let piece = spectrum.segment(wavelength);
    let inside = wavelength + (piece.end - wavelength) * t;
    if !piece.end.is_finite() || inside >= piece.end {
        return;
    }
    let there = spectrum.segment(inside);
    assert!(there.end == piece.end, "{there:?} at {inside:?} of {piece:?} from {wavelength:?}");
    let (first, last) = (piece.first.to_f64(), piece.last.to_f64());
    let expected = weighted(first, last, inside.to_f64() - wavelength.to_f64(), piece.end.to_f64() - inside.to_f64());
    let magnitude = if first >= 0.0 && last >= 0.0 && scale == 0.0 { expected } else { scale };
    // Four for the value, four for the first end, and the oracle's own; what underflows is lost.
    let tolerance = 10.0 * R::EPSILON.to_f64() * magnitude + R::MIN_POSITIVE.to_f64();
    let error = (there.first.to_f64() - expected).abs();
    assert!(error <= tolerance, "{error:e} above {tolerance:e} at {inside:?} of {piece:?} from {wavelength:?}");
}

/// Increasing nodes from a start and steps, so far as the type can tell them apart.
fn nodes<R: Float>(start: f64, steps: &[f64], values: &[f64]) -> (Vec<R>, Vec<R>) {
    let mut position = start;
    let mut found = vec![R::from_f64(position)];
    for step in steps {
        position += step;
        let next = R::from_f64(position);
        if next > found[found.len() - 1] {
            found.push(next);
        }
    }
    while found.len() < 2 {
        found.push(found[found.len() - 1].up());
    }
    let values = found.iter().zip(values.iter().cycle()).map(|(_, &value)| R::from_f64(value)).collect();
    (found, values)
}

/// The value by a scan over the nodes, in f64.
fn naive<R: Float>(wavelengths: &[R], values: &[R], outside: Outside, at: R) -> f64 {
    let (w, v): (Vec<f64>, Vec<f64>) = wavelengths.iter().zip(values).map(|(w, v)| (w.to_f64(), v.to_f64())).unzip();
    let (at, last) = (at.to_f64(), w.len() - 1);
    if at < w[0] || at > w[last] {
        let held = if at < w[0] { v[0] } else { v[last] };
        return if outside == Outside::Hold { held } else { 0.0 };
    }
    let i = (0..last).find(|&i| at >= w[i] && at <= w[i + 1]).unwrap();
    weighted(v[i], v[i + 1], at - w[i], w[i + 1] - at)
}

fn check_piecewise<R: Float>(wavelengths: &[R], values: &[R], outside: Outside, t: R, bits: &[u64]) {
    let spectrum = PiecewiseLinear::new(wavelengths, values, outside).unwrap();
    check_everywhere(&spectrum, wavelengths, bits);
    let largest = values.iter().fold(0.0_f64, |m, v| m.max(v.to_f64().abs()));
    let negative = values.iter().any(|&value| value < R::ZERO);
    let scale = if negative { largest } else { 0.0 };
    for (pair, value) in wavelengths.windows(2).zip(values) {
        assert!(spectrum.value(pair[0]) == *value, "not exact at a node");
        let inside = pair[0] + (pair[1] - pair[0]) * t;
        let expected = naive(wavelengths, values, outside, inside);
        let error = (spectrum.value(inside).to_f64() - expected).abs();
        let magnitude = if negative { largest } else { expected };
        // Four as documented, one more for the oracle.
        let tolerance = 5.0 * R::EPSILON.to_f64() * magnitude + R::MIN_POSITIVE.to_f64();
        assert!(error <= tolerance, "{error:e} above {tolerance:e} at {inside:?}");
        check_linear(&spectrum, pair[0], t, scale);
        check_linear(&spectrum, inside, t, scale);
    }
    assert_eq!(spectrum.check_non_negative().is_ok(), !negative);
    if !negative {
        assert!(wavelengths.iter().all(|&w| spectrum.value(w.down()) >= R::ZERO && spectrum.value(w.up()) >= R::ZERO));
    }
}

fn check_uniform<R: Float>(first: f64, step: f64, values: &[f64], outside: Outside, t: R, bits: &[u64]) {
    let (first, step) = (R::from_f64(first), R::from_f64(step));
    let values: Vec<R> = values.iter().map(|&value| R::from_f64(value)).collect();
    let Ok(uniform) = Uniform::new(first, step, &values, outside) else {
        return; // Nodes that the type can't tell apart are refused.
    };
    let wavelengths: Vec<R> = (0..values.len()).map(|index| first + step * R::from_usize(index)).collect();
    let general = PiecewiseLinear::new(&wavelengths, &values, outside).unwrap();
    check_everywhere(&uniform, &wavelengths, bits);
    for &node in &wavelengths {
        for near in [node, node.up(), node.down(), node + step * t, -node] {
            assert_eq!(uniform.segment(near), general.segment(near), "at {near:?}");
            assert_eq!(uniform.value(near), general.value(near), "at {near:?}");
        }
    }
}

fn outside() -> impl Strategy<Value = Outside> {
    prop_oneof![Just(Outside::Zero), Just(Outside::Hold)]
}

/// A magnitude spread evenly over its exponent.
fn magnitude(exponents: core::ops::Range<f64>) -> impl Strategy<Value = f64> {
    exponents.prop_map(|exponent| 10_f64.powf(exponent))
}

fn ordinate() -> impl Strategy<Value = f64> {
    prop_oneof![
        3 => 0.0..1.0_f64,
        1 => Just(0.0),
        1 => magnitude(-30.0..30.0),
        1 => magnitude(-30.0..30.0).prop_map(|value| -value),
    ]
}

proptest! {
    #![proptest_config(config(2000))]

    #[test]
    fn piecewise_linear(
        start in prop_oneof![-1000.0..1000.0_f64, Just(0.0), magnitude(0.0..20.0).prop_map(|w| -w)],
        steps in prop::collection::vec(magnitude(-6.0..6.0), 1..20),
        values in prop::collection::vec(ordinate(), 1..20),
        outside in outside(),
        t in 0.0..1.0_f64,
        bits in prop::collection::vec(any::<u64>(), 8),
    ) {
        let (wavelengths, ordinates) = nodes::<f64>(start, &steps, &values);
        check_piecewise(&wavelengths, &ordinates, outside, t, &bits);
        let (wavelengths, ordinates) = nodes::<f32>(start, &steps, &values);
        check_piecewise(&wavelengths, &ordinates, outside, f32::from_f64(t), &bits);
    }

    #[test]
    fn uniform(
        first in prop_oneof![-1000.0..1000.0_f64, Just(360.0), magnitude(0.0..20.0).prop_map(|w| -w)],
        step in prop_oneof![magnitude(-6.0..20.0), Just(0.1), Just(1.0), Just(5.0)],
        values in prop::collection::vec(ordinate(), 2..100),
        outside in outside(),
        t in 0.0..1.0_f64,
        bits in prop::collection::vec(any::<u64>(), 8),
    ) {
        check_uniform::<f64>(first, step, &values, outside, t, &bits);
        check_uniform::<f32>(first, step, &values, outside, f32::from_f64(t), &bits);
    }

    #[test]
    fn formulas(
        temperature in magnitude(0.0..9.0),
        daylight in 4000.0..25000.0_f64,
        at in -10.0..1_000_010.0_f64,
        t in 0.0..1.0_f64,
        bits in prop::collection::vec(any::<u64>(), 32),
    ) {
        check_formulas::<f64>(temperature, daylight, at, t, &bits);
        check_formulas::<f32>(temperature, daylight, at, t, &bits);
    }

    #[test]
    fn lines(
        centres in prop::collection::vec(prop_oneof![380.0..780.0_f64, 589.0..590.0_f64], 1..8),
        powers in prop::collection::vec(magnitude(-30.0..30.0), 8),
        width in magnitude(-2.0..3.0),
        t in 0.0..1.0_f64,
        bits in prop::collection::vec(any::<u64>(), 8),
    ) {
        check_lines::<f64>(&centres, &powers, width, t, &bits);
        check_lines::<f32>(&centres, &powers, width, t, &bits);
    }
}

fn check_formulas<R: Float>(temperature: f64, daylight: f64, at: f64, t: f64, bits: &[u64]) {
    let (at, t) = (R::from_f64(at), R::from_f64(t));
    let planck = Planck::new(R::from_f64(temperature), RadiationConstant::Si2019).unwrap();
    let whole = [at.floor(), at, R::ZERO, R::from_f64(1e6), R::from_f64(360.0), R::from_f64(830.0)];
    check_everywhere(&planck, &whole, bits);
    check_linear(&planck, at, t, 0.0);
    let daylight = Daylight::new(R::from_f64(daylight), Rounding::ThreeDecimals).unwrap();
    let nodes: Vec<R> = (0..107).map(|index| R::from_f64(300.0 + 5.0 * f64::from(index))).collect();
    check_everywhere(&daylight, &nodes, bits);
    nodes.iter().for_each(|&node| check_linear(&daylight, node + t, t, 0.0));
    let scaled = Scaled::new(daylight, R::from_f64(1e-3)).unwrap();
    check_everywhere(&scaled, &nodes, bits);
    check_everywhere(&Constant::new(t).unwrap(), &[at], bits);
}

fn check_lines<R: Float>(centres: &[f64], powers: &[f64], width: f64, t: f64, bits: &[u64]) {
    let (width, half) = (R::from_f64(width), R::from_f64(0.5 * width));
    let t = R::from_f64(t);
    let centres: Vec<R> = centres.iter().map(|&centre| R::from_f64(centre)).collect();
    let powers: Vec<R> = powers[..centres.len()].iter().map(|&power| R::from_f64(power)).collect();
    let lines = Lines::new(&centres, &powers, width).unwrap();
    let corners: Vec<R> = centres.iter().flat_map(|&centre| [centre - half, centre, centre + half]).collect();
    check_everywhere(&lines, &corners, bits);
    let single = Line::new(centres[0], width, powers[0]).unwrap();
    check_everywhere(&single, &corners, bits);
    let inside = single.segment(centres[0] - half);
    assert!(inside.end == centres[0] && inside.last == single.peak());
    for &corner in &corners {
        let sum = lines.iter().fold(0.0, |sum, line| sum + line.value(corner).to_f64());
        let error = (lines.value(corner).to_f64() - sum).abs();
        assert!(error <= 8.0 * R::EPSILON.to_f64() * sum, "{error:e} of {sum:e}");
        check_walk(&lines, corner, t);
    }
}

/// The sum of lines is linear up to the end it states: no corner of a line is inside.
fn check_walk<R: Float>(lines: &Lines<'_, R>, from: R, t: R) {
    let piece = lines.segment(from);
    if piece.end.is_finite() {
        let inside = from + (piece.end - from) * t;
        assert!(inside >= piece.end || lines.segment(inside).end == piece.end);
    }
}

#[test]
fn built_in_tables() {
    for table in tables::lights().chain(&tables::daylight::ALL) {
        let nodes: Vec<f64> = (0..table.samples.double.len())
            .map(|index| f64::from(table.first) + f64::from(table.step) * f64::from_usize(index))
            .collect();
        let single: Vec<f32> = nodes.iter().map(|&node| f32::from_f64(node)).collect();
        for outside in [Outside::Zero, Outside::Hold] {
            check_everywhere(&table.spectrum::<f64>(outside), &nodes, &[]);
            check_everywhere(&table.spectrum::<f32>(outside), &single, &[]);
        }
    }
    for metal in &tables::metals::ALL {
        check_everywhere(&metal.n::<f32>(), metal.wavelengths.single, &[]);
        check_everywhere(&metal.k::<f64>(), metal.wavelengths.double, &[]);
    }
}
