//! Colour temperature, adaptation, colour rendering and action: whole chains in 106 bits.

use spectral_core::action::{ActionSpectra, CIRCADIAN_XYZ, Projection, RADIANCE_RGB_TO_XYZ, Weighting};
use spectral_core::adaptation::{Adaptation, BRADFORD, Cie1994, Cie1994Conditions, VON_KRIES, von_kries_uv};
use spectral_core::cct::{LocusTable, PlanckianLocus, correlated_colour_temperature, xyz_to_uv};
use spectral_core::colour::{self, xyz};
use spectral_core::colour_rendering::{self as rendering, Cri00, ReferenceKind, ReferenceLight, Rendering};
use spectral_core::light::{self, FidelityMeter, IndexMeter, LightMeter};
use spectral_core::spectrum::{Outside, RadiationConstant};
use spectral_core::summation::{DirectColours, Illuminated, PreparedColours, SumGrid, TestColours};
use spectral_core::summation::{tristimulus_sum, weighted_sum};
use spectral_core::tables::{self, UniformTable, observers};
use spectral_core::{Real, Spectrum};

use super::colour::{ciede2000, lab};
use super::spectra::{LIGHTS, daylight};
use crate::accuracy::gauge::{Axis, Gauge};
use crate::accuracy::lines::Polyline;
use crate::accuracy::wide::{Wide, apply, dot, inverse, wide, wides};

type Colour = [Wide; 3];

/// 380–780 nm at 5 nm.
const N: usize = 81;
const GRID: SumGrid<N> = SumGrid::CIE_5NM;

fn wavelength(index: usize) -> Wide {
    Wide::from(380.0 + 5.0 * index as f64)
}

fn sampled(line: &Polyline) -> Vec<Wide> {
    (0..N).map(|index| line.value(wavelength(index))).collect()
}

/// The tables that everything is summed with, in `f64`'s decimals.
struct Sums {
    cmf: Vec<Colour>,
}

impl Sums {
    fn of(table: &tables::ObserverTable) -> Self {
        let lines = Polyline::of_observer(table);
        Self { cmf: (0..N).map(|i| lines.each_ref().map(|line| line.value(wavelength(i)))).collect() }
    }

    fn new() -> Self {
        Self::of(&observers::CIE_1931_2)
    }

    fn xyz(&self, light: &[Wide]) -> Colour {
        let ones = vec![Wide::ONE; N];
        self.under(light, &ones)
    }

    fn under(&self, light: &[Wide], reflectance: &[Wide]) -> Colour {
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
fn black_body(temperature: Wide) -> Vec<Wide> {
    let power = |w: Wide| 1.0 / (w.powi(5) * (constant() / (w * temperature)).exp_m1());
    let unit = power(560.0.into());
    (0..N).map(|i| power(wavelength(i)) / unit).collect()
}

/// Daylight, its factors not rounded.
fn daylight_power(temperature: Wide) -> Vec<Wide> {
    let [m1, m2] = daylight(temperature).1;
    let basis = [&tables::daylight::S0, &tables::daylight::S1, &tables::daylight::S2];
    let [a, b, c] = basis.map(|table| sampled(&Polyline::of_table(table, false)));
    (0..N).map(|i| a[i] + m1 * b[i] + m2 * c[i]).collect()
}

fn uv([x, y, z]: Colour) -> [Wide; 2] {
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
fn nearest(sums: &Sums, point: [Wide; 2]) -> Option<(Wide, Wide)> {
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

fn observer<R: Real>() -> [[R; 3]; N] {
    GRID.observer(&observers::CIE_1931_2)
}

fn locus<R: Real>() -> PlanckianLocus<R, N> {
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

fn whites<R: Real>() -> [[R; 3]; 4] {
    [xyz::WHITE_D65, xyz::WHITE_A, xyz::WHITE_E, [1.0, 1.0, 0.15]].map(colour::in_precision)
}

/// Calls for each pair of whites with their cone responses.
fn each_adaptation<R: Real>(mut each: impl FnMut([R; 3], [R; 3])) {
    for from in whites() {
        for to in whites() {
            each(from, to);
        }
    }
}

fn exact_matrix(matrix: &[[f64; 3]; 3]) -> [Colour; 3] {
    matrix.map(|row| row.map(Wide::from))
}

/// M⁻¹ diag(ρ′/ρ) M XYZ.
fn scaled(matrix: &[[f64; 3]; 3], from: Colour, to: Colour, xyz: Colour) -> Colour {
    let m = exact_matrix(matrix);
    let (before, after, cones) = (apply(&m, from), apply(&m, to), apply(&m, xyz));
    apply(&inverse(&m), core::array::from_fn(|i| cones[i] * after[i] / before[i]))
}

fn colours() -> [Axis; 3] {
    ["X", "Y", "Z"].map(|name| Axis::linear(name, 0.0, 1.2).list(&[0.5]))
}

fn measure_adaptation<R: Real>(
    gauge: &mut Gauge,
    matrix: &[[f64; 3]; 3],
    make: impl Fn([R; 3], [R; 3]) -> Adaptation<R>,
) {
    gauge.effort(0.2);
    gauge.note("between D65, A, E and a yellow light");
    each_adaptation(|from: [R; 3], to| {
        let adaptation = make(from, to);
        gauge.each(&colours(), |gauge, xyz: [R; 3]| {
            let exact = scaled(matrix, wides(from), wides(to), wides(xyz));
            for (got, exact) in adaptation.apply(xyz).into_iter().zip(exact) {
                gauge.compare_to(got, exact, Wide::from(1.5));
            }
        });
    });
}

/// Bradford's.
pub fn bradford<R: Real>(gauge: &mut Gauge) {
    measure_adaptation::<R>(gauge, &BRADFORD, Adaptation::bradford);
}

/// Von Kries's.
pub fn von_kries<R: Real>(gauge: &mut Gauge) {
    measure_adaptation::<R>(gauge, &VON_KRIES, Adaptation::von_kries);
}

/// CIE 13.3's, equations of its section on adaptation.
fn adapted_uv(sample: [Wide; 2], test: [Wide; 2], reference: [Wide; 2]) -> [Wide; 2] {
    let d = Wide::decimal;
    let ratios = |[u, v]: [Wide; 2]| [(4.0 - u - v * 10.0) / v, (d("1.708") * v + d("0.404") - d("1.481") * u) / v];
    let ([c_s, d_s], [c_t, d_t], [c_r, d_r]) = (ratios(sample), ratios(test), ratios(reference));
    let (c, e) = (c_r / c_t * c_s, d_r / d_t * d_s);
    let below = d("16.518") + d("1.481") * c - e;
    [(d("10.872") + d("0.404") * c - e * 4.0) / below, d("5.520") / below]
}

/// Chromaticities between fluorescent lamps' and the locus.
pub fn von_kries_uv_case<R: Real>(gauge: &mut Gauge) {
    let axes = [
        Axis::linear("u", 0.15, 0.35),
        Axis::linear("v", 0.27, 0.36),
        Axis::linear("u_t", 0.19, 0.27),
        Axis::linear("v_t", 0.30, 0.35),
        Axis::linear("u_r", 0.19, 0.27),
        Axis::linear("v_r", 0.30, 0.35),
    ];
    gauge.each(&axes, |gauge, [a, b, c, d, e, f]: [R; 6]| {
        let exact = adapted_uv(wides([a, b]), wides([c, d]), wides([e, f]));
        for (got, exact) in von_kries_uv([a, b], [c, d], [e, f]).into_iter().zip(exact) {
            gauge.compare_to(got, exact, Wide::from(0.375));
        }
    });
}

/// CIE 109-1994 at 1000 lux, Y_o = 20, n = 1 (Nayatani, Sobagaki and Hashimoto 1997; CIE 109, section 3).
fn nayatani(from: Colour, to: Colour, xyz: Colour) -> Colour {
    let d = Wide::decimal;
    let m = exact_matrix(&VON_KRIES);
    let (percent, noise) = (20.0, Wide::ONE);
    let xi = [from, to].map(|white| apply(&m, white).map(|c| c / white[1]));
    let luminance = Wide::from(20.0 * 1000.0) / (Wide::PI * 100.0);
    let beta_1 = |r: Wide| {
        let power = r.powf(d("0.4495"));
        (d("6.469") + d("6.362") * power) / (d("6.469") + power)
    };
    let beta_2 = |r: Wide| {
        let power = r.powf(d("0.5128"));
        d("0.7844") * (d("8.414") + d("8.091") * power) / (d("8.414") + power)
    };
    let beta = xi.map(|[r, g, b]| [beta_1(r * luminance), beta_1(g * luminance), beta_2(b * luminance)]);
    let part = |field: usize, cone: usize, share: f64| {
        let x = xi[field][cone];
        ((x * percent + noise) / (x * 20.0 + noise)).powf(beta[field][cone] * share / 3.0)
    };
    let k = part(0, 0, 2.0) / part(1, 0, 2.0) * part(0, 1, 1.0) / part(1, 1, 1.0);
    let cones = apply(&m, xyz.map(|c| c * 100.0));
    let adapted = core::array::from_fn(|i| {
        let ratio = (cones[i] + noise) / (xi[0][i] * percent + noise);
        let level = xi[1][i] * percent + noise;
        let power = if ratio > 0.0 { ratio.powf(beta[0][i] / beta[1][i]) } else { Wide::ZERO };
        level * k.powf(1.0 / beta[1][i]) * power - noise
    });
    apply(&inverse(&m), adapted).map(|c| c / 100.0)
}

/// CIE 109's non-linear transform.
pub fn cie_1994<R: Real>(gauge: &mut Gauge) {
    gauge.effort(0.1);
    gauge.note("between D65, A, E and a yellow light, background 0.2, 1000 lux");
    each_adaptation(|from: [R; 3], to| {
        // The same conditions in both precisions: 0.2 isn't a binary number.
        let conditions = Cie1994Conditions { background: R::from_f64(0.2), ..Cie1994Conditions::default() };
        let transform = Cie1994::new(from, to, &conditions);
        gauge.each(&colours(), |gauge, xyz: [R; 3]| {
            let exact = nayatani(wides(from), wides(to), wides(xyz));
            for (got, exact) in transform.apply(xyz).into_iter().zip(exact) {
                gauge.compare_to(got, exact, Wide::from(1.5));
            }
        });
    });
}

/// Lights that indices are measured of: the five, and two more kinds.
fn lights<R: Real>() -> Vec<[R; N]> {
    let more = [&tables::fluorescent::FL7, &tables::led::ALL[0]];
    LIGHTS.iter().copied().chain(more).map(|table| GRID.sample(&table.spectrum(Outside::Zero))).collect()
}

const LAMPS: &str = "D65, A, FL2, FL11, HP1, FL7 and an LED at 5 nm";

fn exact_light<R: Real>(light: &[R; N]) -> Vec<Wide> {
    light.iter().map(|power| wide(*power)).collect()
}

/// Reflectances of the samples on the grid, in `f64`'s decimals.
fn reflectances<const M: usize>(samples: &[impl Spectrum<f64>; M]) -> Vec<Vec<Wide>> {
    let value = |sample: &dyn Spectrum<f64>, i: usize| Wide::from(sample.value(wavelength(i).to_f64()));
    samples.iter().map(|sample| (0..N).map(|i| value(sample, i)).collect()).collect()
}

/// A white and samples under it, relative to Y = 1.
struct Lit {
    white: Colour,
    samples: Vec<Colour>,
}

impl Lit {
    fn new(sums: &Sums, light: &[Wide], samples: &[Vec<Wide>]) -> Self {
        let white = sums.xyz(light);
        let relative = |xyz: Colour| xyz.map(|c| c / white[1]);
        Self { white: relative(white), samples: samples.iter().map(|r| relative(sums.under(light, r))).collect() }
    }

    fn of<R: Real, const M: usize>(lit: &Illuminated<R, M>) -> Self {
        Self { white: wides(lit.white), samples: lit.samples.iter().map(|xyz| wides(*xyz)).collect() }
    }
}

/// R_i of CIE 13.3.
fn special_13_3(test: &Lit, reference: &Lit) -> Vec<Wide> {
    let (from, to) = (uv(test.white), uv(reference.white));
    let lightness = |y: Wide| (y * 100.0).cbrt() * 25.0 - 17.0;
    let point = |[u, v]: [Wide; 2], y: Wide| {
        let w = lightness(y);
        [w, w * 13.0 * (u - to[0]), w * 13.0 * (v - to[1])]
    };
    // The printed constants: the adapted white of the test light is the reference's, by definition.
    let each = |(t, r): (&Colour, &Colour)| {
        let (a, b) = (point(adapted_uv(uv(*t), from, to), t[1]), point(uv(*r), r[1]));
        let square = (0..3).fold(Wide::ZERO, |sum, i| sum + (a[i] - b[i]).squared());
        100.0 - Wide::decimal("4.6") * square.sqrt()
    };
    test.samples.iter().zip(&reference.samples).map(each).collect()
}

fn special_cri00(test: &Lit, reference: &Lit, factor: f64) -> Vec<Wide> {
    let colour = |xyz: Colour| lab(xyz, reference.white);
    let each = |(t, r): (&Colour, &Colour)| {
        let adapted = scaled(&BRADFORD, test.white, reference.white, *t);
        100.0 - ciede2000(colour(*r), colour(adapted), [Wide::ONE; 3]).0 * factor
    };
    test.samples.iter().zip(&reference.samples).map(each).collect()
}

fn special_r96(test: &Lit, reference: &Lit, factor: f64) -> Vec<Wide> {
    let white = xyz::WHITE_D65.map(Wide::from);
    let each = |(t, r): (&Colour, &Colour)| {
        let (a, b) = (lab(nayatani(test.white, white, *t), white), lab(nayatani(reference.white, white, *r), white));
        let square = (0..3).fold(Wide::ZERO, |sum, i| sum + (a[i] - b[i]).squared());
        100.0 - square.sqrt() * factor
    };
    test.samples.iter().zip(&reference.samples).map(each).collect()
}

fn mean(values: &[Wide], count: usize) -> Wide {
    values.iter().take(count).fold(Wide::ZERO, |sum, x| sum + *x) / count as f64
}

/// What rendering is measured with: the reference that the light's own temperature asks for.
fn reference_of(sums: &Sums, light: &[Wide]) -> Option<Vec<Wide>> {
    let (temperature, _) = nearest(sums, uv(sums.xyz(light)))?;
    Some(if temperature < 5000.0 { black_body(temperature) } else { daylight_power(temperature) })
}

fn compare_rendering<R: Real, const M: usize>(
    gauge: &mut Gauge,
    found: &Rendering<R, M>,
    special: &[Wide],
    averaged: usize,
) {
    for (got, exact) in found.special.into_iter().zip(special) {
        gauge.compare(got, *exact);
    }
    gauge.compare(found.general, mean(special, averaged));
}

/// Both lights of each test lamp with the Munsell samples, as the core sees them.
fn each_munsell<R: Real>(
    gauge: &mut Gauge,
    mut measure: impl FnMut(&mut Gauge, &Illuminated<R, 14>, &Illuminated<R, 14>),
) {
    gauge.note(LAMPS);
    let (observer, samples) = (observer::<R>(), rendering::munsell_samples::<R>());
    let colours = DirectColours::new(GRID, &observer, &samples);
    let sums = Sums::new();
    for light in lights::<R>() {
        let Some(reference) = reference_of(&sums, &exact_light(&light)) else { return gauge.require(false) };
        let reference = core::array::from_fn(|i| R::from_f64(reference[i].to_f64()));
        let (Some(test), Some(reference)) = (colours.illuminate(&light), colours.illuminate(&reference)) else {
            return gauge.require(false);
        };
        measure(gauge, &test, &reference);
    }
}

/// R_i and R_a from given tristimulus values.
pub fn cie_13_3<R: Real>(gauge: &mut Gauge) {
    each_munsell(gauge, |gauge, test: &Illuminated<R, 14>, reference| {
        let special = special_13_3(&Lit::of(test), &Lit::of(reference));
        compare_rendering(gauge, &rendering::cie_13_3(test, reference), &special, 8);
    });
}

/// CRI00 from given tristimulus values.
pub fn cri00<R: Real>(gauge: &mut Gauge) {
    each_munsell(gauge, |gauge, test: &Illuminated<R, 14>, reference| {
        let special = special_cri00(&Lit::of(test), &Lit::of(reference), 9.097);
        compare_rendering(gauge, &rendering::cri00(test, reference, &Cri00::MUNSELL), &special, 8);
    });
}

/// R96 from given tristimulus values.
pub fn r96<R: Real>(gauge: &mut Gauge) {
    each_munsell(gauge, |gauge, test: &Illuminated<R, 14>, reference| {
        let special = special_r96(&Lit::of(test), &Lit::of(reference), rendering::R96C);
        compare_rendering(gauge, &rendering::r96(test, reference, rendering::R96C), &special, 14);
    });
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

/// The reference light on the grid.
pub fn reference_spectrum<R: Real>(gauge: &mut Gauge) {
    gauge.effort(0.1);
    let locus = locus::<R>();
    let axes = [Axis::linear("T", 1000.0, 25_000.0).edges(&[5000.0]).list(&[6500.0])];
    gauge.each(&axes, |gauge, [t]: [R; 1]| {
        let Some(light) = ReferenceLight::for_temperature(t) else { return gauge.require(false) };
        let planckian = light.kind == ReferenceKind::Planckian;
        gauge.require(planckian == (t.to_f64() < 5000.0));
        let exact = if planckian { black_body(wide(t)) } else { daylight_power(wide(t)) };
        let Some(found) = light.spectrum(GRID, &locus) else { return gauge.require(false) };
        let largest = exact.iter().fold(Wide::ZERO, |m, x| m.max(*x));
        for (got, exact) in found.into_iter().zip(exact) {
            gauge.compare_to(got, exact, largest);
        }
    });
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

/// CAM02-UCS in the conditions of CIE 224 (CIE 159:2004; Luo, Cui and Li 2006).
fn cam02(white: Colour, xyz: Colour) -> Colour {
    let d = Wide::decimal;
    let row = |texts: [&str; 3]| texts.map(Wide::decimal);
    let cat = [
        row(["0.7328", "0.4296", "-0.1624"]),
        row(["-0.7036", "1.6975", "0.0061"]),
        row(["0.0030", "0.0136", "0.9834"]),
    ];
    let hpe = [row(["0.38971", "0.68898", "-0.07868"]), row(["-0.22981", "1.18340", "0.04641"]), row(["0", "0", "1"])];
    let k = 1.0 / Wide::from(501.0);
    let level = k.powi(4) * 500.0 / 5.0 + (1.0 - k.powi(4)).squared() * Wide::from(500.0).cbrt() / 10.0;
    let induction = d("0.725") * Wide::from(5.0).powf(d("0.2"));
    let base = d("1.48") + d("0.2").sqrt();
    let scale = apply(&cat, white);
    let respond = |xyz: Colour| {
        let cones = apply(&cat, xyz);
        let adapted = core::array::from_fn(|i| cones[i] / scale[i] * 100.0);
        apply(&hpe, apply(&inverse(&cat), adapted)).map(|c| {
            let power = (level * c.abs() / 100.0).powf(d("0.42"));
            let compressed = power * 400.0 / (power + d("27.13"));
            (if c < 0.0 { -compressed } else { compressed }) + d("0.1")
        })
    };
    let achromatic = |[r, g, b]: Colour| (r * 2.0 + g + b / 20.0 - d("0.305")) * induction;
    let [r, g, b] = respond(xyz);
    let (x, y) = (r - g * 12.0 / 11.0 + b / 11.0, (r + g - b * 2.0) / 9.0);
    let hue = y.atan2(x);
    let eccentricity = ((hue + 2.0).cos() + d("3.8")) / 4.0;
    let t = Wide::from(50_000.0) / 13.0 * induction * eccentricity * x.hypot(y) / (r + g + b * 21.0 / 20.0);
    let lightness = (achromatic([r, g, b]) / achromatic(respond(white))).powf(d("0.69") * base) * 100.0;
    let contrast = (d("1.64") - d("0.29").powf(d("0.2"))).powf(d("0.73"));
    let chroma = t.powf(d("0.9")) * (lightness / 100.0).sqrt() * contrast;
    let colourfulness = chroma * level.sqrt().sqrt();
    let compressed = (d("0.0228") * colourfulness + 1.0).ln() / d("0.0228");
    let lightness = d("1.7") * lightness / (d("0.007") * lightness + 1.0);
    [lightness, compressed * hue.cos(), compressed * hue.sin()]
}

/// R_f and R_g.
fn exact_fidelity(test: &Lit, reference: &Lit) -> [Wide; 2] {
    let place = |lit: &Lit| lit.samples.iter().map(|xyz| cam02(lit.white, *xyz)).collect::<Vec<_>>();
    let (a, b) = (place(test), place(reference));
    let difference =
        |(p, q): (&Colour, &Colour)| (0..3).fold(Wide::ZERO, |sum, i| sum + (p[i] - q[i]).squared()).sqrt();
    let sum = a.iter().zip(&b).map(difference).fold(Wide::ZERO, |sum, d| sum + d);
    let linear = 100.0 - Wide::decimal("6.73") * sum / a.len() as f64;
    let rf = ((linear / 10.0).exp() + 1.0).ln() * 10.0;
    let mut corners = [[[Wide::ZERO; 2]; 16]; 2];
    let mut counts = [0.0; 16];
    for (p, q) in a.iter().zip(&b) {
        let turn = q[2].atan2(q[1]) / (Wide::PI * 2.0);
        let turn = if turn < 0.0 { turn + 1.0 } else { turn };
        let sector = (turn * 16.0).to_f64() as usize % 16;
        counts[sector] += 1.0;
        for (corners, colour) in corners.iter_mut().zip([p, q]) {
            corners[sector][0] += colour[1];
            corners[sector][1] += colour[2];
        }
    }
    let area = |corners: &[[Wide; 2]; 16]| {
        let at = |s: usize| corners[s % 16].map(|sum| sum / counts[s % 16]);
        (0..16).fold(Wide::ZERO, |sum, s| sum + at(s)[0] * at(s + 1)[1] - at(s)[1] * at(s + 1)[0])
    };
    [rf, area(&corners[0]) / area(&corners[1]) * 100.0]
}

/// R_f and R_g from given tristimulus values.
pub fn fidelity<R: Real>(gauge: &mut Gauge) {
    gauge.note(LAMPS);
    let (observer, samples) =
        (GRID.observer::<R>(&observers::CIE_1964_10), rendering::colour_evaluation_samples::<R>());
    let colours = DirectColours::new(GRID, &observer, &samples);
    let (narrow, sums) = (Sums::new(), Sums::of(&observers::CIE_1964_10));
    for light in lights::<R>() {
        let exact = exact_light(&light);
        let Some((temperature, _)) = nearest(&narrow, uv(narrow.xyz(&exact))) else { return gauge.require(false) };
        let reference = blended(&sums, temperature);
        let reference = core::array::from_fn(|i| R::from_f64(reference[i].to_f64()));
        let (Some(test), Some(reference)) = (colours.illuminate(&light), colours.illuminate(&reference)) else {
            return gauge.require(false);
        };
        let (found, exact) =
            (rendering::fidelity(&test, &reference), exact_fidelity(&Lit::of(&test), &Lit::of(&reference)));
        gauge.compare(found.rf, exact[0]);
        gauge.compare(found.rg, exact[1]);
    }
}

/// A black body to 4000 K, daylight from 5000 K, a blend of equal luminances between.
fn blended(wide_sums: &Sums, temperature: Wide) -> Vec<Wide> {
    let of = |power: Vec<Wide>| {
        let y = wide_sums.xyz(&power)[1];
        power.into_iter().map(|p| p / y).collect::<Vec<_>>()
    };
    let share = (temperature - 4000.0) / 1000.0;
    if share <= 0.0 {
        return of(black_body(temperature));
    }
    let day = of(daylight_power(temperature));
    if share >= 1.0 {
        return day;
    }
    of(black_body(temperature)).into_iter().zip(day).map(|(p, d)| p * (1.0 - share) + d * share).collect()
}

/// The blend.
pub fn fidelity_reference<R: Real>(gauge: &mut Gauge) {
    gauge.effort(0.1);
    let (locus, observer) = (locus::<R>(), GRID.observer::<R>(&observers::CIE_1964_10));
    let sums = Sums::of(&observers::CIE_1964_10);
    let axes = [Axis::linear("T", 1000.0, 25_000.0).edges(&[4000.0, 5000.0]).list(&[4500.0])];
    gauge.each(&axes, |gauge, [t]: [R; 1]| {
        let Some(found) = rendering::fidelity_reference(t, GRID, &locus, &observer) else {
            return gauge.require(false);
        };
        let exact = blended(&sums, wide(t));
        let largest = exact.iter().fold(Wide::ZERO, |m, x| m.max(*x));
        for (got, exact) in found.into_iter().zip(exact) {
            gauge.compare_to(got, exact, largest);
        }
    });
}

/// Calls for each lamp with exact R_f and R_g.
fn each_fidelity<R: Real>(gauge: &mut Gauge, mut measure: impl FnMut(&[R; N]) -> Option<[R; 2]>) {
    gauge.note(LAMPS);
    let (narrow, sums) = (Sums::new(), Sums::of(&observers::CIE_1964_10));
    let samples = reflectances(&rendering::colour_evaluation_samples::<f64>());
    for light in lights::<R>() {
        let exact = exact_light(&light);
        let Some((temperature, _)) = nearest(&narrow, uv(narrow.xyz(&exact))) else { return gauge.require(false) };
        let reference = Lit::new(&sums, &blended(&sums, temperature), &samples);
        let exact = exact_fidelity(&Lit::new(&sums, &exact, &samples), &reference);
        let Some(found) = measure(&light) else { return gauge.require(false) };
        for (got, exact) in found.into_iter().zip(exact) {
            gauge.compare(got, exact);
        }
    }
}

/// R_f and R_g of a lamp.
pub fn measure_fidelity<R: Real>(gauge: &mut Gauge) {
    each_fidelity(gauge, |lamp: &[R; N]| {
        let found = light::measure_fidelity(GRID, lamp, RadiationConstant::Its1990).ok()??;
        Some([found.rf, found.rg])
    });
}

/// R_f and R_g of a lamp, prepared.
pub fn fidelity_meter<R: Real>(gauge: &mut Gauge) {
    let meter = Box::new(FidelityMeter::<R, N>::new(GRID, RadiationConstant::Its1990));
    each_fidelity(gauge, |lamp: &[R; N]| {
        let found = meter.measure(lamp).ok()??;
        Some([found.rf, found.rg])
    });
}

/// Luminous efficacy, a_cv, photosynthesis and α-opic ratios.
pub fn action<R: Real>(gauge: &mut Gauge) {
    gauge.note(LAMPS);
    let (spectra, observer, sums) = (ActionSpectra::<R, N>::new(GRID), observer::<R>(), Sums::new());
    let table = |table: &UniformTable| sampled(&Polyline::of_table(table, false));
    let (pas, melanopic) = (table(&tables::action::PAS), table(&tables::alpha_opic::MELANOPIC));
    for light in lights::<R>() {
        let exact = exact_light(&light);
        let [x, y, z] = sums.xyz(&exact);
        let total = |weights: &[Wide]| exact.iter().zip(weights).fold(Wide::ZERO, |sum, (a, b)| sum + *a * *b);
        let Some(found) = spectra.measure(&light, tristimulus_sum(&observer, &light), R::ONE) else {
            return gauge.require(false);
        };
        let [a, b, c] = CIRCADIAN_XYZ.map(Wide::from);
        let efficacy = Wide::decimal("683.002");
        gauge.compare(found.luminous_efficacy, efficacy * y / total(&[Wide::ONE; N]));
        gauge.compare_to(found.acv, (a * x + b * y + c * z) / y, (b * y + c * z) / y);
        gauge.compare(found.sy, total(&pas) * 5.0);
        gauge.compare(found.sy_ratio, total(&pas) / y);
        let ratio = total(&melanopic) / y / efficacy * 1000.0;
        gauge.compare(found.alpha_opic.efficacy[4], ratio);
        gauge.compare(found.alpha_opic.melanopic_der(), ratio / Wide::decimal("1.3262"));
    }
}

fn weighting<R: Real>() -> Weighting<R, N> {
    Weighting::new(GRID, &tables::alpha_opic::MELANOPIC.spectrum::<R>(Outside::Zero))
}

/// Ω of a light.
pub fn weighting_apply<R: Real>(gauge: &mut Gauge) {
    gauge.note(LAMPS);
    let weighting = weighting::<R>();
    for light in lights::<R>() {
        let terms = weighting.weights().iter().zip(&light).map(|(w, s)| wide(*w) * wide(*s));
        gauge.compare(weighting.apply(&light), terms.fold(Wide::ZERO, |sum, x| sum + x) * 5.0);
    }
}

/// The projection by the Gramian matrix of the rounded functions.
fn projected<R: Real>(observer: &[[R; 3]; N], weighting: &Weighting<R, N>) -> (Colour, Wide) {
    let column = |a: usize| observer.iter().map(move |cmf| wide(cmf[a])).collect::<Vec<_>>();
    let columns = [column(0), column(1), column(2)];
    let weights: Vec<Wide> = weighting.weights().iter().map(|w| wide(*w)).collect();
    let inner = |a: &[Wide], b: &[Wide]| a.iter().zip(b).fold(Wide::ZERO, |sum, (a, b)| sum + *a * *b);
    let gram = core::array::from_fn(|i| core::array::from_fn(|j| inner(&columns[i], &columns[j])));
    let k = apply(&inverse(&gram), core::array::from_fn(|i| inner(&columns[i], &weights)));
    let rest: Vec<Wide> = (0..N).map(|n| weights[n] - dot(k, [columns[0][n], columns[1][n], columns[2][n]])).collect();
    (k, (inner(&rest, &rest) / inner(&weights, &weights)).sqrt())
}

/// k_x, k_y, k_z of the melanopic function.
pub fn projection<R: Real>(gauge: &mut Gauge) {
    gauge.note("the melanopic function at 5 nm");
    let (observer, weighting) = (observer::<R>(), weighting::<R>());
    let (k, residual) = projected(&observer, &weighting);
    let Some(found) = Projection::new(&observer, &weighting) else { return gauge.require(false) };
    gauge.compare_all(found.coefficients, k);
    gauge.compare(found.residual, residual);
}

/// Ψ of tristimulus values, in ULP of its terms.
pub fn projection_apply<R: Real>(gauge: &mut Gauge) {
    let Some(found) = Projection::new(&observer::<R>(), &weighting::<R>()) else { return gauge.require(false) };
    gauge.each(&colours(), |gauge, xyz: [R; 3]| {
        let terms: Colour = core::array::from_fn(|i| wide(found.coefficients[i]) * wide(xyz[i]));
        let size = terms.map(Wide::abs);
        gauge.compare_to(found.apply(xyz), terms[0] + terms[1] + terms[2], size[0] + size[1] + size[2]);
    });
}

/// (r, g, b) of Ψ, in ULP of their terms.
pub fn projection_rgb<R: Real>(gauge: &mut Gauge) {
    gauge.note("the melanopic function at 5 nm, Radiance's primaries");
    let Some(found) = Projection::new(&observer::<R>(), &weighting::<R>()) else { return gauge.require(false) };
    for (channel, got) in found.rgb(&RADIANCE_RGB_TO_XYZ).into_iter().enumerate() {
        let terms: Colour = core::array::from_fn(|i| wide(found.coefficients[i]) * RADIANCE_RGB_TO_XYZ[i][channel]);
        let size = terms.map(Wide::abs);
        gauge.compare_to(got, terms[0] + terms[1] + terms[2], size[0] + size[1] + size[2]);
    }
}

/// (Ψ − Ω)/Ω.
pub fn projection_error<R: Real>(gauge: &mut Gauge) {
    gauge.note(LAMPS);
    let (observer, weighting) = (observer::<R>(), weighting::<R>());
    let Some(found) = Projection::new(&observer, &weighting) else { return gauge.require(false) };
    for light in lights::<R>() {
        let exact = exact_light(&light);
        let sum = |weight: &dyn Fn(usize) -> Wide| (0..N).fold(Wide::ZERO, |sum, n| sum + weight(n) * exact[n]);
        let omega = sum(&|n| wide(weighting.weights()[n]));
        let psi = sum(&|n| dot(wides(found.coefficients), wides(observer[n])));
        gauge.compare_to(found.relative_error(&observer, &weighting, &light), (psi - omega) / omega, Wide::ONE);
    }
}
