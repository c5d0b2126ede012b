//! Representations of spectra: what a pixel's colour costs by each, and how far off it is.

use alloc::collections::BTreeMap;
use alloc::rc::Rc;

use spectral_core::adaptive::Mode;
use spectral_core::bilinear::Tensor;
use spectral_core::colour::rgb::WHITE;
use spectral_core::colour::{delta_e_ab, xyz_to_lab};

use super::picture;
use super::plan::{Plan, Run, Setting, count, mean_and_worst, timed_items};
use super::products::{Known, Pixels, lamp, scene_under};
use crate::render::Spectra;
use crate::spectral::{
    Colour, ComponentResolver, Components, IntervalMemory, IntervalSettings, Intervals, Monomials, Radiance, Resolver,
    SharedIntervals, Uniform, UniformBins,
};

/// All tasks.
pub(super) fn plans(quick: bool) -> Vec<Plan> {
    let direct: &[(&str, &str, Option<&str>)] = if quick {
        &[("d65", "cornell-box", None), ("fl11", "cornell-box", Some("FL11"))]
    } else {
        &[
            ("d65", "cornell-box", None),
            ("lamp", "cornell-box-lamp", None),
            ("fl2", "cornell-box", Some("FL2")),
            ("fl11", "cornell-box", Some("FL11")),
            ("sodium", "cornell-box-sodium", None),
        ]
    };
    let side = if quick { 64 } else { 256 };
    let mut all: Vec<Plan> = direct
        .iter()
        .map(|&(name, scene, light)| {
            let pixels = move || {
                let light = light.map(|light| lamp(light, 40.0)).transpose()?;
                Pixels::of_scene(&scene_under(scene, light.as_ref())?, side)
            };
            let lamp = light.unwrap_or(scene);
            plan(name, format!("direct light in the Cornell box, {lamp}, {side} × {side} pixels"), quick, pixels)
        })
        .collect();
    for (name, light) in [("twice-d65", "D65"), ("twice-fl11", "FL11")] {
        let title = format!("{light} reflected by two patches of the ColorChecker, all 576 pairs at 16 brightnesses");
        all.push(plan(name, title, quick, move || Pixels::of_patches(lamp(light, 1.0)?, 2, 16)));
    }
    let title = "FL11 and sodium light in 100 mixtures, each reflected by 24 patches of the ColorChecker".to_owned();
    let lamps = || Ok::<_, String>([lamp("FL11", 1.0)?, lamp("HP1", 1.0)?]);
    all.push(plan("two-lamps", title, quick, move || Pixels::of_mixtures(lamps()?, 100)));
    if quick {
        all.retain(|plan| plan.name != "twice-d65");
    }
    all.extend(picture::plans(quick));
    all
}

fn plan(
    name: &'static str,
    title: String,
    quick: bool,
    pixels: impl FnOnce() -> Result<Pixels, String> + 'static,
) -> Plan {
    Plan {
        name,
        title,
        error: "mean ΔE*ab",
        operations: "numbers touched",
        truth: "integrals of the products of piecewise linear spectra, exact but for rounding".to_owned(),
        floor: 1e-6,
        rounds: if quick { 3 } else { 7 },
        weight: if quick { 3.0 } else { 25.0 },
        build: Box::new(move || {
            let pixels = Rc::new(pixels()?);
            let setting = |spectra: &Spectra| setting(*spectra, &pixels);
            Ok(representations(quick).iter().map(setting).collect())
        }),
    }
}

/// The representations that are compared.
pub(super) fn representations(quick: bool) -> Vec<Spectra> {
    let mut all = vec![Spectra::Rgb, Spectra::RgbPrefiltered, Spectra::Bilinear, Spectra::Smits];
    let bins: &[usize] = if quick { &[4, 16, 81, 401] } else { &[4, 6, 9, 12, 16, 24, 40, 81, 161, 401] };
    all.extend(bins.iter().map(|bins| Spectra::Uniform(*bins)));
    let thresholds: &[f64] = if quick { &[10.0, 3.0, 1.0, 0.1] } else { &[30.0, 10.0, 5.0, 3.0, 1.0, 0.3, 0.1, 0.03] };
    for mode in [Mode::Paper, Mode::Corrected, Mode::Certified] {
        let settings =
            |threshold: &f64| Spectra::Interval(IntervalSettings { mode, threshold: *threshold, white: 1.0 });
        all.extend(thresholds.iter().map(settings));
    }
    all
}

/// What a user types, the method's name, and whether it is the project's own.
pub(super) fn naming(spectra: Spectra) -> (String, &'static str, bool) {
    match spectra {
        Spectra::Interval(IntervalSettings { mode, threshold, .. }) => {
            let (bound, method, own) = match mode {
                Mode::Paper => ("paper", "intervals, paper", false),
                Mode::Corrected => ("corrected", "intervals, corrected", true),
                Mode::Certified => ("certified", "intervals, certified", true),
            };
            (format!("--bound {bound} --threshold {threshold}"), method, own)
        }
        Spectra::Uniform(_) => (format!("--spectra {spectra}"), "uniform bins", false),
        Spectra::Wavelengths(step) => (format!("--spectral-exr {step}nm"), "single wavelengths", false),
        Spectra::Rgb => ("--spectra rgb".to_owned(), "rgb", false),
        Spectra::RgbPrefiltered => ("--spectra rgb-prefiltered".to_owned(), "rgb, prefiltered", false),
        Spectra::Smits => ("--spectra smits".to_owned(), "smits", false),
        Spectra::Bilinear | Spectra::BilinearAlpha(_) => (format!("--spectra {spectra}"), "bilinear", false),
    }
}

fn setting(spectra: Spectra, pixels: &Rc<Pixels>) -> Setting {
    let (name, method, own) = naming(spectra);
    let pixels = Rc::clone(pixels);
    let mut known: Option<[f64; 3]> = None;
    Setting::new(name, method, own, move |_| {
        let (colours, seconds) = colours(spectra, &pixels)?;
        // Results are the same to the bit in all rounds.
        if known.is_none() {
            let lab = |xyz: [f64; 3]| xyz_to_lab(xyz, WHITE);
            let errors = colours.iter().zip(&pixels.truth).map(|(c, t)| delta_e_ab(lab(c.xyz), lab(*t)));
            let [mean, worst] = mean_and_worst(errors);
            known = Some([operations(spectra, &pixels, &colours)?, mean, worst]);
        }
        let [operations, error, worst] = known.unwrap_or([f64::NAN; 3]);
        Ok(Run { seconds, operations, error, worst })
    })
}

/// Colours of all pixels, and how long they took without preparing the spectra.
fn colours(spectra: Spectra, pixels: &Pixels) -> Result<(Vec<Colour>, f64), String> {
    let palette = &pixels.palette;
    let components = |components: &Components, kept: bool| {
        let (monomials, radiances) = if kept { &pixels.kept } else { &pixels.free };
        resolve(|| ComponentResolver::new(components), monomials, radiances)
    };
    let bins = |bins: &UniformBins| {
        let (monomials, radiances) = &pixels.free;
        resolve(|| Uniform::new(bins), monomials, radiances)
    };
    Ok(match spectra {
        Spectra::Rgb => components(&Components::naive(palette)?, false),
        Spectra::RgbPrefiltered => components(&Components::prefiltered(palette, &pixels.dominant)?, false),
        Spectra::Bilinear | Spectra::BilinearAlpha(_) => {
            components(&Components::bilinear(palette, &Tensor::rec_709())?, true)
        }
        Spectra::Smits => bins(&UniformBins::smits(palette)?),
        Spectra::Uniform(count) => bins(&UniformBins::new(palette, count)?),
        Spectra::Wavelengths(step) => bins(&UniformBins::at_wavelengths(palette, step)?),
        Spectra::Interval(settings) => {
            let mut memory = IntervalMemory::default();
            let shared = SharedIntervals::new(palette, settings, &mut memory)?;
            let (monomials, radiances) = &pixels.free;
            resolve(|| Intervals::new(&shared), monomials, radiances)
        }
    })
}

/// Pixels whose time is taken together.
const CHUNK: usize = 256;

fn resolve<R: Resolver>(new: impl Fn() -> R, monomials: &Monomials, radiances: &[Radiance]) -> (Vec<Colour>, f64) {
    let state = || (new(), Known(monomials));
    timed_items(radiances, CHUNK, state, |(resolver, tracer), radiance| resolver.resolve(radiance, tracer))
}

/// How many numbers an interval has to first order (mean, three errors), and with its bounds.
const INTERVAL_NUMBERS: [usize; 2] = [4, 15];
/// Numbers of a colour that is read from a recorded subdivision: XYZ, their radii, the bound.
const LOOK_UP: usize = 7;

/// How much brighter than white the subdivisions of single products are recorded for.
const BRIGHTEST: f64 = 63.0;

/// The numbers that finding `n` intervals touches: 2n − 1 of them are evaluated, each with its terms, and after every split the pieces'
/// sum and its bound are taken again.
fn interval_numbers(n: usize, mode: Mode, terms: usize) -> usize {
    let numbers = INTERVAL_NUMBERS[usize::from(mode == Mode::Certified)];
    (2 * n.max(1) - 1) * numbers * terms + 7 * n * (n + 1) / 2 + 24 * n
}

/// Counts the numbers that the colours of all pixels are made from.
///
/// A term of three components touches three, and each pixel nine of the matrix to XYZ; bins touch one for each bin, factor and term, and
/// three times the bins for XYZ. Intervals: see [`interval_numbers`], but a single product is read from its recorded subdivision, which is
/// made once, for the brightest pixel that there may be.
fn operations(spectra: Spectra, pixels: &Pixels, colours: &[Colour]) -> Result<f64, String> {
    let (monomials, radiances) = &pixels.free;
    let factors = |radiance: &Radiance| radiance.terms().iter().map(|(m, _)| monomials.leaves(*m).len()).sum::<usize>();
    let own = |radiance: &Radiance| match spectra {
        Spectra::Uniform(bins) => bins * (factors(radiance) + 3),
        Spectra::Wavelengths(step) => (400 / usize::from(step) + 1) * (factors(radiance) + 3),
        Spectra::Smits => 10 * (factors(radiance) + 3),
        _ => 3 * radiance.terms().len() + 9,
    };
    let Spectra::Interval(settings) = spectra else {
        return Ok(count(radiances.iter().map(own).sum()));
    };
    let mut recorded: BTreeMap<usize, Radiance> = BTreeMap::new();
    let mut sum = 0;
    for (radiance, colour) in radiances.iter().zip(colours) {
        match radiance.terms() {
            [(monomial, weight)] => {
                let mut brightest = Radiance::default();
                brightest.add(*monomial, weight * BRIGHTEST / colour.xyz[1].max(f64::MIN_POSITIVE));
                recorded.entry(monomial.index()).or_insert(brightest);
                sum += LOOK_UP;
            }
            terms => sum += interval_numbers(colour.intervals, settings.mode, terms.len()),
        }
    }
    let mut memory = IntervalMemory::default();
    let shared = SharedIntervals::new(&pixels.palette, settings, &mut memory)?;
    let recorded: Vec<Radiance> = recorded.into_values().collect();
    let (colours, _) = resolve(|| Intervals::new(&shared), monomials, &recorded);
    for (colour, radiance) in colours.iter().zip(&recorded) {
        sum += interval_numbers(colour.intervals, settings.mode, factors(radiance));
    }
    Ok(count(sum))
}
