//! Colour temperature, sums and whole measurements of lights, in 106 bits, and what other measures of lights are built of.

use spectral_core::cct::{LocusTable, PlanckianLocus, correlated_colour_temperature, xyz_to_uv};
use spectral_core::colour_rendering as rendering;
use spectral_core::light::{self, IndexMeter, LightMeter};
use spectral_core::spectrum::{Outside, RadiationConstant};
use spectral_core::summation::{DirectColours, Illuminated, PreparedColours, SumGrid, TestColours};
use spectral_core::summation::{tristimulus_sum, weighted_sum};
use spectral_core::tables::{self, observers};
use spectral_core::{Real, Spectrum};

use super::rendering::{mean, reference_of, special_13_3, special_cri00};
use super::spectra::{LIGHTS, daylight};
use crate::accuracy::gauge::{Axis, Gauge};
use crate::accuracy::lines::Polyline;
use crate::accuracy::wide::{Wide, wide, wides};

pub(super) type Colour = [Wide; 3];

/// 380–780 nm at 5 nm.
pub(super) const N: usize = 81;
pub(super) const GRID: SumGrid<N> = SumGrid::CIE_5NM;

fn wavelength(index: usize) -> Wide {
    Wide::from(380.0 + 5.0 * index as f64)
}

pub(super) fn sampled(line: &Polyline) -> Vec<Wide> {
    (0..N).map(|index| line.value(wavelength(index))).collect()
}

/// The tables that everything is summed with, in `f64`'s decimals.
pub(super) struct Sums {
    cmf: Vec<Colour>,
}

impl Sums {
    pub(super) fn of(table: &tables::ObserverTable) -> Self {
        let lines = Polyline::of_observer(table);
        Self { cmf: (0..N).map(|i| lines.each_ref().map(|line| line.value(wavelength(i)))).collect() }
    }

    pub(super) fn new() -> Self {
        Self::of(&observers::CIE_1931_2)
    }

    pub(super) fn xyz(&self, light: &[Wide]) -> Colour {
        let ones = vec![Wide::ONE; N];
        self.under(light, &ones)
    }

    pub(super) fn under(&self, light: &[Wide], reflectance: &[Wide]) -> Colour {
        let mut sums = [Wide::ZERO; 3];
        for ((cmf, power), reflected) in self.cmf.iter().zip(light).zip(reflectance) {
            let stimulus = *power * *reflected;
            for (sum, c) in sums.iter_mut().zip(cmf) {
                *sum += *c * stimulus;
            }
        }
        sums
    }
}

/// c₂ of ITS-90 in nm K.
fn constant() -> Wide {
    Wide::decimal("1.4388e7")
}

/// A black body, 1 at 560 nm.
pub(super) fn black_body(temperature: Wide) -> Vec<Wide> {
    let power = |w: Wide| 1.0 / (w.powi(5) * (constant() / (w * temperature)).exp_m1());
    let unit = power(560.0.into());
    (0..N).map(|i| power(wavelength(i)) / unit).collect()
}

/// Daylight, its factors not rounded.
pub(super) fn daylight_power(temperature: Wide) -> Vec<Wide> {
    let [m1, m2] = daylight(temperature).1;
    let basis = [&tables::daylight::S0, &tables::daylight::S1, &tables::daylight::S2];
    let [a, b, c] = basis.map(|table| sampled(&Polyline::of_table(table, false)));
    (0..N).map(|i| a[i] + m1 * b[i] + m2 * c[i]).collect()
}

pub(super) fn uv([x, y, z]: Colour) -> [Wide; 2] {
    let sum = x + y * 15.0 + z * 3.0;
    [x * 4.0 / sum, y * 6.0 / sum]
}

/// The distance's derivative by reciprocal temperature in MK⁻¹, from a central difference of the locus: its zero is the nearest point.
fn slope(sums: &Sums, point: [Wide; 2], mired: Wide) -> Wide {
    let step = Wide::from(1.0 / 1_048_576.0);
    let at = |mired: Wide| uv(sums.xyz(&black_body(1e6 / mired)));
    let (here, before, after) = (at(mired), at(mired - step), at(mired + step));
    (0..2).fold(Wide::ZERO, |sum, i| sum + (here[i] - point[i]) * (after[i] - before[i]))
}

/// Temperature and distance of the nearest point of the locus, by the secant method about the nearest of 64 points; `None` at its ends.
pub(super) fn nearest(sums: &Sums, point: [Wide; 2]) -> Option<(Wide, Wide)> {
    let coarse = |index: usize| 15.0 * libm_power(130.0, index as f64 / 63.0);
    let distance = |mired: f64| {
        let here = uv(sums.xyz(&black_body(1e6 / Wide::from(mired))));
        (here[0] - point[0]).hypot(here[1] - point[1]).to_f64()
    };
    let best = (0..64).min_by(|a, b| distance(coarse(*a)).total_cmp(&distance(coarse(*b))))?;
    if best == 0 || best == 63 {
        return None;
    }
    let (mut a, mut b) = (Wide::from(coarse(best - 1)), Wide::from(coarse(best + 1)));
    let (mut f, mut g) = (slope(sums, point, a), slope(sums, point, b));
    for _ in 0..12 {
        if (b - a).abs() < b * 1e-20 || f == g {
            break;
        }
        let next = b - g * (b - a) / (g - f);
        (a, f, b) = (b, g, next);
        g = slope(sums, point, b);
    }
    let here = uv(sums.xyz(&black_body(1e6 / b)));
    Some((1e6 / b, (here[0] - point[0]).hypot(here[1] - point[1])))
}

fn libm_power(base: f64, power: f64) -> f64 {
    Real::powf(base, power)
}

pub(super) fn observer<R: Real>() -> [[R; 3]; N] {
    GRID.observer(&observers::CIE_1931_2)
}

pub(super) fn locus<R: Real>() -> PlanckianLocus<R, N> {
    PlanckianLocus::new(GRID, &observer(), RadiationConstant::Its1990)
}

/// (u, v) of tristimulus values.
pub fn xyz_to_uv_case<R: Real>(gauge: &mut Gauge) {
    gauge.each(&["X", "Y", "Z"].map(|name| Axis::log(name, 1e-6, 1e6).list(&[0.0])), |gauge, xyz: [R; 3]| {
        if xyz.iter().any(|c| *c > R::ZERO) {
            gauge.compare_all(xyz_to_uv(xyz), uv(wides(xyz)));
        }
    });
}

fn temperature() -> Axis {
    Axis::log("T", 500.0, 1e5).list(&[2856.0, 5000.0, 6500.0])
}

/// Black bodies on the grid.
pub fn locus_spectrum<R: Real>(gauge: &mut Gauge) {
    gauge.effort(0.1);
    let locus = locus::<R>();
    gauge.each(&[temperature()], |gauge, [t]: [R; 1]| {
        for (i, (got, exact)) in locus.spectrum(t).into_iter().zip(black_body(wide(t))).enumerate() {
            if exact > R::MIN_POSITIVE.to_f64() {
                gauge.compare_to(got, exact, exact * (constant() / (wavelength(i) * wide(t)) + 1.0));
            }
        }
    });
}

/// Their chromaticities.
pub fn locus_uv<R: Real>(gauge: &mut Gauge) {
    gauge.effort(0.2);
    let (locus, sums) = (locus::<R>(), Sums::new());
    gauge.each(&[temperature()], |gauge, [t]: [R; 1]| {
        gauge.compare_all(locus.uv(t), uv(sums.xyz(&black_body(wide(t)))));
    });
}

/// Temperatures of chromaticities up to 0.02 off the locus.
pub fn cct<R: Real>(gauge: &mut Gauge) {
    gauge.effort(0.05);
    let (table, sums) = (LocusTable::new(&locus::<R>()), Sums::new());
    let axes = [Axis::log("T", 1000.0, 25_000.0).list(&[5000.0]), Axis::linear("Duv", -0.02, 0.02).list(&[0.0])];
    gauge.note("for the locus at 5 nm, Duv's own error included");
    gauge.each(&axes, |gauge, [t, away]: [R; 2]| {
        let on = |t: Wide| uv(sums.xyz(&black_body(t)));
        let ([u, v], [p, q]) = (on(wide(t)), on(wide(t) * 1.0001));
        let length = (u - p).hypot(v - q);
        let point = [u - (q - v) / length * wide(away), v + (p - u) / length * wide(away)];
        let point = point.map(|c| R::from_f64(c.to_f64()));
        let Some(found) = correlated_colour_temperature(point, &table) else { return gauge.require(false) };
        match nearest(&sums, wides(point)) {
            Some((exact, duv)) => {
                gauge.compare(found.temperature, exact);
                // The distance itself, as if it were a temperature's relative error.
                gauge.record((wide(found.duv).abs() - duv).abs().to_f64());
            }
            None => gauge.require(false),
        }
    });
}

/// Lights that indices are measured of: the five, and two more kinds.
pub(super) fn lights<R: Real>() -> Vec<[R; N]> {
    let more = [&tables::fluorescent::FL7, &tables::led::ALL[0]];
    LIGHTS.iter().copied().chain(more).map(|table| GRID.sample(&table.spectrum(Outside::Zero))).collect()
}

pub(super) const LAMPS: &str = "D65, A, FL2, FL11, HP1, FL7 and an LED at 5 nm";

pub(super) fn exact_light<R: Real>(light: &[R; N]) -> Vec<Wide> {
    light.iter().map(|power| wide(*power)).collect()
}

/// Reflectances of the samples on the grid, in `f64`'s decimals.
pub(super) fn reflectances<const M: usize>(samples: &[impl Spectrum<f64>; M]) -> Vec<Vec<Wide>> {
    let value = |sample: &dyn Spectrum<f64>, i: usize| Wide::from(sample.value(wavelength(i).to_f64()));
    samples.iter().map(|sample| (0..N).map(|i| value(sample, i)).collect()).collect()
}

/// A white and samples under it, relative to Y = 1.
pub(super) struct Lit {
    pub(super) white: Colour,
    pub(super) samples: Vec<Colour>,
}

impl Lit {
    pub(super) fn new(sums: &Sums, light: &[Wide], samples: &[Vec<Wide>]) -> Self {
        let white = sums.xyz(light);
        let relative = |xyz: Colour| xyz.map(|c| c / white[1]);
        Self { white: relative(white), samples: samples.iter().map(|r| relative(sums.under(light, r))).collect() }
    }

    pub(super) fn of<R: Real, const M: usize>(lit: &Illuminated<R, M>) -> Self {
        Self { white: wides(lit.white), samples: lit.samples.iter().map(|xyz| wides(*xyz)).collect() }
    }
}

/// White and samples, in ULP of the largest component.
fn measure_illuminate<R: Real>(gauge: &mut Gauge, illuminate: impl Fn(&[R; N]) -> Option<Illuminated<R, 14>>) {
    gauge.note(LAMPS);
    let (sums, samples) = (Sums::new(), reflectances(&rendering::munsell_samples::<f64>()));
    for light in lights::<R>() {
        let exact = Lit::new(&sums, &exact_light(&light), &samples);
        let Some(found) = illuminate(&light) else { return gauge.require(false) };
        gauge.compare_all(found.white, exact.white);
        for (got, exact) in found.samples.into_iter().zip(exact.samples) {
            gauge.compare_all(got, exact);
        }
    }
}

/// Products formed at each use.
pub fn direct_illuminate<R: Real>(gauge: &mut Gauge) {
    let (observer, samples) = (observer::<R>(), rendering::munsell_samples::<R>());
    measure_illuminate(gauge, |light| DirectColours::new(GRID, &observer, &samples).illuminate(light));
}

/// Products kept.
pub fn prepared_illuminate<R: Real>(gauge: &mut Gauge) {
    let prepared = PreparedColours::new(GRID, &observer::<R>(), &rendering::munsell_samples::<R>());
    measure_illuminate(gauge, |light| prepared.illuminate(light));
}

/// Σ S x̄, with x̄ as rounded.
pub fn tristimulus_sums<R: Real>(gauge: &mut Gauge) {
    gauge.note(LAMPS);
    let observer = observer::<R>();
    for light in lights::<R>() {
        let exact: Colour = core::array::from_fn(|a| {
            observer.iter().zip(&light).fold(Wide::ZERO, |sum, (cmf, s)| sum + wide(cmf[a]) * wide(*s))
        });
        gauge.compare_all(tristimulus_sum(&observer, &light), exact);
    }
}

/// Random weights of either sign.
pub fn weighted_sums<R: Real>(gauge: &mut Gauge) {
    gauge.note("1000 pairs of 81 random numbers in [−1, 1]");
    for _ in 0..1000 {
        let mut draw = || core::array::from_fn(|_| R::from_f64(2.0 * gauge.rng().unit() - 1.0));
        let (a, b): ([R; N], [R; N]) = (draw(), draw());
        let terms = wides(a).into_iter().zip(wides(b)).map(|(a, b)| a * b);
        let (sum, size) = terms.fold((Wide::ZERO, Wide::ZERO), |(s, t), x| (s + x, t + x.abs()));
        gauge.compare_to(weighted_sum(&a, &b), sum, size);
    }
}

/// Values of lights and colour-matching functions on a grid of 1 nm.
pub fn sampled_values<R: Real>(gauge: &mut Gauge) {
    gauge.note("D65, A, FL2, FL11, HP1 at 1 nm");
    for table in LIGHTS {
        let line = Polyline::of_table(table, false);
        let samples: [R; 401] = SumGrid::CIE_1NM.sample(&table.spectrum(Outside::Zero));
        for (i, got) in samples.into_iter().enumerate() {
            gauge.compare(got, line.value((380.0 + i as f64).into()));
        }
    }
}

/// The light's own chain: temperature, reference, R_a, CRI00.
struct Exact {
    temperature: Wide,
    xy: [Wide; 2],
    ra: Wide,
    cri00: Wide,
}

fn exact_indices<R: Real>(sums: &Sums, light: &[R; N], samples: &[Vec<Wide>]) -> Option<Exact> {
    let light = exact_light(light);
    let [x, y, z] = sums.xyz(&light);
    let (temperature, _) = nearest(sums, uv([x, y, z]))?;
    let reference = reference_of(sums, &light)?;
    let (test, reference) = (Lit::new(sums, &light, samples), Lit::new(sums, &reference, samples));
    Some(Exact {
        temperature,
        xy: [x / (x + y + z), y / (x + y + z)],
        ra: mean(&special_13_3(&test, &reference), 8),
        cri00: mean(&special_cri00(&test, &reference, 9.097), 8),
    })
}

/// Calls for each lamp with its exact figures.
fn each_lamp<R: Real>(gauge: &mut Gauge, mut measure: impl FnMut(&mut Gauge, &[R; N], &Exact)) {
    gauge.note(LAMPS);
    let (sums, samples) = (Sums::new(), reflectances(&rendering::munsell_samples::<f64>()));
    for light in lights::<R>() {
        let Some(exact) = exact_indices(&sums, &light, &samples) else { return gauge.require(false) };
        measure(gauge, &light, &exact);
    }
}

fn compare_general<R: Real>(gauge: &mut Gauge, found: [Option<R>; 2], exact: &Exact) {
    let [Some(ra), Some(cri00)] = found else { return gauge.require(false) };
    gauge.compare(ra, exact.ra);
    gauge.compare(cri00, exact.cri00);
}

/// R_a and CRI00 of `measure`.
pub fn measure<R: Real>(gauge: &mut Gauge) {
    each_lamp(gauge, |gauge, lamp: &[R; N], exact| {
        let Ok(found) = light::measure(GRID, lamp, RadiationConstant::Its1990) else { return gauge.require(false) };
        let indices = found.rendering.map(|r| (r.ra.general, r.cri00_munsell.general));
        compare_general(gauge, [indices.map(|i| i.0), indices.map(|i| i.1)], exact);
    });
}

/// R_a and CRI00 of the fast form.
pub fn measure_indices<R: Real>(gauge: &mut Gauge) {
    each_lamp(gauge, |gauge, lamp: &[R; N], exact| {
        match light::measure_indices(GRID, lamp, RadiationConstant::Its1990) {
            Ok(found) => compare_general(gauge, [found.ra, found.cri00], exact),
            Err(_) => gauge.require(false),
        }
    });
}

/// R_a and CRI00 of the prepared form.
pub fn index_meter<R: Real>(gauge: &mut Gauge) {
    let meter = IndexMeter::<R, N>::new(GRID, RadiationConstant::Its1990);
    each_lamp(gauge, |gauge, lamp: &[R; N], exact| match meter.measure(lamp) {
        Ok(found) => compare_general(gauge, [found.ra, found.cri00], exact),
        Err(_) => gauge.require(false),
    });
}

/// R_a and CRI00 of the prepared form with all else.
pub fn light_meter<R: Real>(gauge: &mut Gauge) {
    let meter = LightMeter::<R, N>::new(GRID, RadiationConstant::Its1990);
    each_lamp(gauge, |gauge, lamp: &[R; N], exact| match meter.measure(lamp).map(|found| found.rendering) {
        Ok(Some(r)) => compare_general(gauge, [Some(r.ra.general), Some(r.cri00_munsell.general)], exact),
        _ => gauge.require(false),
    });
}

/// R_a and CRI00 of the two alone.
pub fn light_meter_munsell<R: Real>(gauge: &mut Gauge) {
    let meter = LightMeter::<R, N>::new(GRID, RadiationConstant::Its1990);
    each_lamp(gauge, |gauge, lamp: &[R; N], exact| match meter.munsell(lamp) {
        Ok((_, Some([ra, cri00]))) => compare_general(gauge, [Some(ra.general), Some(cri00.general)], exact),
        _ => gauge.require(false),
    });
}

/// x, y and the temperature of lamps, relatively.
pub fn light_meter_chromaticity<R: Real>(gauge: &mut Gauge) {
    let meter = LightMeter::<R, N>::new(GRID, RadiationConstant::Its1990);
    each_lamp(gauge, |gauge, lamp: &[R; N], exact| match meter.chromaticity(lamp) {
        Ok(found) => {
            gauge.compare_all(found.xy, exact.xy);
            gauge.compare(found.cct.temperature, exact.temperature);
        }
        Err(_) => gauge.require(false),
    });
}
