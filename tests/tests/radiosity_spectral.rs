//! Spectra in radiosity: the bounds of adaptive intervals against many uniform bins on every patch, closed forms, and bilinear products.
//!
//! All representations of a scene share one transport, so that differences are of the spectra alone.
#![allow(clippy::unwrap_used, clippy::panic, reason = "helpers of tests fail by panicking")]
#![allow(clippy::print_stdout, reason = "the figures behind the verdict are shown with --nocapture")]

use core::f64::consts::{FRAC_1_PI, PI};

use renderers::radiosity::{Radiosity, RadiosityError, Settings, Solution};
use renderers::scene::{Scene, Source, builtin, load};
use renderers::spectral::{Components, IntervalSettings, Palette, Tabulated, UniformBins, Y_INTEGRAL};
use spectral_core::Observer;
use spectral_core::adaptive::Mode;
use spectral_core::bilinear::Tensor;
use spectral_core::bound::delta_e_bound;
use spectral_core::colour::rgb::WHITE;
use spectral_core::colour::{delta_e_ab, xyz_to_lab};
use spectral_core::spectrum::Spectrum;
use spectral_core::tables::{UniformTable, colorchecker, fluorescent, illuminants};
use spectral_tests::generators::Draw;

/// Bins of a reference, and of a finer one: that one's error is less than the difference between both.
const BINS: [usize; 2] = [1600, 6400];

fn scene(body: &str) -> Scene {
    let xml = format!(
        "<scene version='3.0.0'><sensor type='perspective'><float name='fov' value='40'/></sensor>{body}</scene>"
    );
    load(&Source::text("test.xml", xml), &[]).unwrap()
}

fn listed(wavelengths: &[f64], values: &[f64]) -> String {
    let pairs = wavelengths.iter().zip(values).map(|(w, v)| format!("{w}:{v}"));
    pairs.collect::<Vec<_>>().join(", ")
}

/// A table's values times a number, as the scene's files have them.
fn table(table: &UniformTable, scale: f64) -> String {
    let (mut wavelengths, mut values) = (Vec::new(), Vec::new());
    for (index, value) in (0_u32..).zip(table.samples.double) {
        wavelengths.push(f64::from(table.first) + f64::from(table.step) * f64::from(index));
        values.push(value * scale);
    }
    listed(&wavelengths, &values)
}

/// A closed cube of 2 m with four paints on its six faces, with a point light off its middle.
fn cube(paints: [usize; 4], lamp: &str) -> Scene {
    let turns = [("x", 0), ("x", 180), ("x", 90), ("x", -90), ("y", 90), ("y", -90)];
    let faces = turns.iter().zip(paints.iter().cycle()).map(|((axis, angle), paint)| {
        format!(
            "<shape type='rectangle'><transform name='to_world'><translate z='-1'/><rotate {axis}='1' angle='{angle}'/>
            </transform><bsdf type='diffuse'><spectrum name='reflectance' value='{}'/></bsdf></shape>",
            table(&colorchecker::ALL[*paint], 1.0)
        )
    });
    scene(&format!(
        "{}<emitter type='point'><point name='position' x='0.2' y='0.1' z='0.3'/>
        <spectrum name='intensity' value='{lamp}'/></emitter>",
        faces.collect::<String>()
    ))
}

/// The patches, the transport between them, and the spectra.
struct Case {
    radiosity: Radiosity,
    palette: Palette,
}

impl Case {
    fn new(scene: &Scene, settings: &Settings) -> Self {
        let mut palette = Palette::default();
        let radiosity = Radiosity::new(scene, settings, &mut palette, &|_| {}).unwrap();
        Self { radiosity, palette }
    }

    fn rough(scene: &Scene) -> Self {
        Self::new(scene, &Settings { accuracy: 3e-2, ..Settings::default() })
    }

    fn intervals(&self, mode: Mode, threshold: f64) -> Solution<'_> {
        self.radiosity.solve_intervals(&self.palette, &IntervalSettings { mode, threshold, white: 1.0 }).unwrap()
    }

    /// The colours of all patches by so many uniform bins.
    fn uniform(&self, bins: usize) -> Vec<[f64; 3]> {
        let bins = UniformBins::new(&self.palette, bins).unwrap();
        colours(&self.radiosity.solve(&bins).unwrap()).into_iter().map(|(value, _)| value).collect()
    }
}

/// The colour of each patch, and its radius.
fn colours(solution: &Solution<'_>) -> Vec<([f64; 3], [f64; 3])> {
    let colour = |(row, _): (&[f64], f64)| {
        let colour = solution.representation().colour(&[], row);
        (colour.value.map(|v| v * FRAC_1_PI), colour.radius.map(|v| v * FRAC_1_PI))
    };
    solution.patches().map(colour).collect()
}

fn difference(one: [f64; 3], other: [f64; 3]) -> f64 {
    delta_e_ab(xyz_to_lab(one, WHITE), xyz_to_lab(other, WHITE))
}

fn largest(values: impl Iterator<Item = f64>) -> f64 {
    values.fold(0.0, f64::max)
}

/// How much of a radius the error needs, at most, beyond what the truth itself may be off: 1 is all of it.
fn used((value, radius): ([f64; 3], [f64; 3]), truth: [f64; 3], off: [f64; 3]) -> f64 {
    largest((0..3).map(|a| ((value[a] - truth[a]).abs() - off[a]) / radius[a]))
}

/// Checks the bounds of all patches; returns the largest share of a radius that was needed.
fn holds(name: &str, case: &Case, thresholds: &[f64]) -> f64 {
    let [coarse, truth] = BINS.map(|bins| case.uniform(bins));
    let discretisation = largest(coarse.iter().zip(&truth).map(|(a, b)| difference(*a, *b)));
    let mut most = 0.0_f64;
    for threshold in thresholds {
        let solution = case.intervals(Mode::Certified, *threshold);
        let report = solution.report();
        assert!(report.delta_e_bound <= *threshold, "{name}: {report:?}");
        assert!(report.iteration_error <= 1e-8 && report.energy_balance.abs() <= 1e-8, "{name}: {report:?}");
        let (mut error, mut bound) = (0.0_f64, 0.0_f64);
        for (patch, ((value, radius), (coarse, truth))) in
            colours(&solution).into_iter().zip(coarse.iter().zip(&truth)).enumerate()
        {
            let here = delta_e_bound(value, radius, WHITE).delta_e;
            let found = difference(value, *truth);
            assert!(
                found <= here + difference(*coarse, *truth),
                "{name}, {threshold}, patch {patch}: {found} > {here}"
            );
            (error, bound) = (error.max(found), bound.max(here));
            most = most.max(used((value, radius), *truth, core::array::from_fn(|a| (coarse[a] - truth[a]).abs())));
        }
        assert!((bound - report.delta_e_bound).abs() <= 1e-9 * bound, "{name}: {bound} {report:?}");
        println!(
            "{name}: threshold {threshold}, {} intervals, bound {bound:.3}, largest error {error:.3} (reference within {discretisation:.4})",
            report.intervals
        );
    }
    most
}

#[test]
fn bounds_hold_on_all_patches_of_the_cornell_box() {
    for name in ["cornell-box", "cornell-box-lamp"] {
        let case = Case::rough(&builtin::load(name, &[]).unwrap());
        // So many that most start as combinations of others.
        assert!(case.intervals(Mode::Certified, 0.3).report().intervals >= 12, "{name}");
        let used = holds(name, &case, &[0.3, 1.0, 5.0]);
        // A radius that is left out, or is a tenth of what it should be, would fail here.
        println!("{name}: {used:.3} of a radius used");
        assert!(used > 0.1 && used <= 1.0, "{name}: {used}");
    }
}

/// Lines: bins say little, the bound says all. One interval is enough.
#[test]
fn lines_take_one_interval() {
    let case = Case::rough(&builtin::load("cornell-box-sodium", &[]).unwrap());
    let solution = case.intervals(Mode::Certified, 1.0);
    assert_eq!(solution.report().intervals, 1);
    let [coarse, fine] = BINS.map(|bins| case.uniform(bins));
    for ((value, radius), (coarse, fine)) in colours(&solution).into_iter().zip(coarse.iter().zip(&fine)) {
        // What bins put the lines off by is of the first order in their width: the finer ones' error is a third of the difference.
        let reference = difference(*coarse, *fine);
        let bound = delta_e_bound(value, radius, WHITE).delta_e;
        assert!(difference(value, *fine) <= bound + reference, "{bound} {reference}");
    }
}

/// Four paints at random on the faces of a closed cube, under daylight and a fluorescent lamp with lines.
#[test]
fn bounds_hold_between_random_paints() {
    let mut draw = Draw::new(0x4_0000);
    let mut used = 0.0_f64;
    for (lamp, unit) in [(&illuminants::D65, 0.04), (&fluorescent::FL11, 0.3)] {
        for _ in 0..3 {
            let paints = core::array::from_fn(|_| draw.index(0..24));
            let case = Case::rough(&cube(paints, &table(lamp, unit)));
            used = used.max(holds(&format!("{paints:?}"), &case, &[0.5, 1.0]));
        }
    }
    assert!(used > 0.1 && used <= 1.0, "{used}");
}

/// In a closed space where all surfaces have one reflectance ρ(λ) and send out E(λ), all reflect E ρ / (1 − ρ), also where that
/// is a thousand times what is sent out.
#[test]
fn furnace_has_its_closed_form() {
    for top in [0.5, 0.9, 0.999] {
        let (wavelengths, values) = ([380.0, 450.0, 560.0, 610.0, 780.0], [0.2, 0.5 * top, top, 0.4 * top, 0.3]);
        let light = ([380.0, 500.0, 780.0], [0.1, 1.0, 0.4].map(|v| v * 0.5 * (1.0 - top)));
        let furnace = scene(&format!(
            "<shape type='cube'><boolean name='flip_normals' value='true'/>
            <bsdf type='diffuse'><spectrum name='reflectance' value='{}'/></bsdf>
            <emitter type='area'><spectrum name='radiance' value='{}'/></emitter></shape>",
            listed(&wavelengths, &values),
            listed(&light.0, &light.1),
        ));
        let case = Case::rough(&furnace);
        let reflectance = Tabulated { wavelengths: wavelengths.to_vec(), values: values.to_vec() };
        let radiance = Tabulated { wavelengths: light.0.to_vec(), values: light.1.to_vec() };
        let truth = closed_form(&reflectance, &radiance);
        // At 0.999 light is a resonance of 0.2 nm, which the smallest parts just resolve.
        for threshold in if top < 0.99 { [0.1, 1.0] } else { [2.0, 5.0] } {
            let solution = case.intervals(Mode::Certified, threshold);
            let report = solution.report();
            println!(
                "ρ up to {top}: threshold {threshold}, {} intervals, {} steps, bound {:.4}",
                report.intervals, report.iterations, report.delta_e_bound
            );
            assert!(report.delta_e_bound <= threshold, "{report:?}");
            for (value, radius) in colours(&solution) {
                let used = used((value, radius), truth, [0.0; 3]);
                assert!(used <= 1.0, "{top}: {value:?} ± {radius:?}, {truth:?}");
                assert!(difference(value, truth) <= report.delta_e_bound);
            }
        }
    }
}

/// ∫E ρ/(1−ρ) ā over 380–780 nm by Simpson's rule on hundredths of a nanometre: all nodes are at whole nanometres.
fn closed_form(reflectance: &Tabulated, radiance: &Tabulated) -> [f64; 3] {
    const PARTS: u32 = 100;
    let (reflectance, radiance) = (reflectance.spectrum().unwrap(), radiance.spectrum().unwrap());
    let observer = Observer::cie_1931_2deg();
    let mut sums = [0.0; 3];
    for part in 0..400 * PARTS {
        let at = |offset: f64| 380.0 + (f64::from(part) + offset) / f64::from(PARTS);
        for (wavelength, weight) in [(at(0.0), 1.0), (at(0.5), 4.0), (at(1.0), 1.0)] {
            let rho = reflectance.value(wavelength);
            let value = radiance.value(wavelength) * rho / (1.0 - rho) * weight / (6.0 * f64::from(PARTS));
            let cmf = observer.value(wavelength);
            sums = core::array::from_fn(|a| sums[a] + value * cmf[a] / Y_INTEGRAL);
        }
    }
    sums
}

/// More steps are needed as ρ grows, but the result is as exact.
#[test]
fn results_do_not_drift_as_reflectance_grows() {
    let mut steps = Vec::new();
    for rho in [0.5, 0.9, 0.99, 0.999] {
        // One face that reflects less makes more than one mode count.
        let face = |turn: &str, rho: f64| {
            format!(
                "<shape type='rectangle'><transform name='to_world'><translate z='-1'/>{turn}</transform>
                <bsdf type='diffuse'><spectrum name='reflectance' value='400:{rho}, 700:{}'/></bsdf></shape>",
                0.9 * rho
            )
        };
        let turns = ["", "<rotate x='1' angle='180'/>", "<rotate x='1' angle='90'/>", "<rotate x='1' angle='-90'/>"];
        let body = turns.map(|turn| face(turn, rho)).join("")
            + &face("<rotate y='1' angle='90'/>", rho)
            + &face("<rotate y='1' angle='-90'/>", 0.5 * rho)
            + "<emitter type='point'><spectrum name='intensity' value='0.3'/></emitter>";
        let rough = Case::new(&scene(&body), &Settings { accuracy: 3e-2, residual: 1e-5, ..Settings::default() });
        let fine = Case::new(&scene(&body), &Settings { accuracy: 3e-2, residual: 1e-12, ..Settings::default() });
        let bins = UniformBins::new(&rough.palette, 16).unwrap();
        let [rough, fine] = [&rough, &fine].map(|case| case.radiosity.solve(&bins).unwrap());
        steps.push(fine.report().iterations);
        assert!(fine.report().iteration_error <= 1e-12, "{:?}", fine.report());
        assert!(fine.report().energy_balance.abs() <= 1e-11, "{:?}", fine.report());
        for bin in 0..16 {
            let size = largest(fine.patches().map(|(b, _)| b[bin]));
            for ((b, _), (c, _)) in rough.patches().zip(fine.patches()) {
                assert!((b[bin] - c[bin]).abs() <= rough.report().iteration_error * size, "{rho}, {bin}");
            }
        }
        assert!(rough.report().iteration_error <= 1e-5);
    }
    println!("steps: {steps:?}");
    assert!(steps.windows(2).all(|pair| pair[1] >= pair[0]) && steps[3] > steps[0], "{steps:?}");
    assert!(steps[3] <= 100, "{steps:?}");
}

#[test]
fn closed_spaces_that_reflect_everything_are_refused() {
    let white = |values: &str| {
        scene(&format!(
            "<shape type='cube'><boolean name='flip_normals' value='true'/>
            <bsdf type='diffuse'><spectrum name='reflectance' value='{values}'/></bsdf></shape>
            <emitter type='point'><spectrum name='intensity' value='1'/></emitter>"
        ))
    };
    let settings = IntervalSettings::default();
    // At one wavelength is enough.
    let case = Case::rough(&white("380:0.5, 550:1, 780:0.5"));
    assert_eq!(case.radiosity.solve_intervals(&case.palette, &settings).err(), Some(RadiosityError::NoSolution));
    let case = Case::rough(&white("380:0.5, 550:0.99, 780:0.5"));
    assert!(case.radiosity.solve_intervals(&case.palette, &settings).is_ok());
}

/// The first order: what Iehl and Péroche take as value is further off than with the error that is known.
#[test]
fn corrected_values_are_nearer_than_those_of_the_paper() {
    let case = Case::rough(&builtin::load("cornell-box", &[]).unwrap());
    let reference = case.uniform(BINS[0]);
    let mean = |mode: Mode| {
        let solution = case.intervals(mode, 10.0);
        let found: Vec<f64> =
            colours(&solution).iter().zip(&reference).map(|((value, _), truth)| difference(*value, *truth)).collect();
        let report = solution.report();
        #[allow(clippy::cast_precision_loss, reason = "patches are few")]
        let mean = found.iter().sum::<f64>() / found.len() as f64;
        println!(
            "{mode:?}: {} intervals, estimate {:.2}, mean error {mean:.3}",
            report.intervals, report.delta_e_bound
        );
        assert!(report.delta_e_bound <= 10.0 && report.intervals < 12, "{report:?}");
        mean
    };
    let (paper, corrected) = (mean(Mode::Paper), mean(Mode::Corrected));
    assert!(corrected < 0.5 * paper && corrected <= 1.0, "{corrected} {paper}");
}

/// A limited number of reflections is bounded, too.
#[test]
fn bounds_hold_for_few_reflections() {
    for bounces in [0, 1, 3] {
        let settings = Settings { accuracy: 3e-2, bounces: Some(bounces), ..Settings::default() };
        let case = Case::new(&cube([2, 14, 16, 19], &table(&illuminants::D65, 0.04)), &settings);
        let reference = case.uniform(BINS[0]);
        let solution = case.intervals(Mode::Certified, 1.0);
        for ((value, radius), truth) in colours(&solution).into_iter().zip(&reference) {
            let bound = delta_e_bound(value, radius, WHITE).delta_e;
            // Bins of a quarter of a nanometre are off by less than 10⁻³.
            assert!(difference(value, *truth) <= bound + 1e-3, "{bounces}: {value:?} {truth:?}");
        }
    }
}

/// Bilinear products by GMRES against the sum of many reflections, and the classical tensor against components one by one.
#[test]
fn bilinear_solutions_are_sums_of_reflections() {
    let lit = cube([3, 7, 11, 18], &table(&illuminants::D65, 0.04));
    let settings = Settings { accuracy: 3e-2, residual: 1e-11, ..Settings::default() };
    let case = Case::new(&lit, &settings);
    let many = Case::new(&lit, &Settings { bounces: Some(400), ..settings });
    for tensor in [Tensor::rec_709(), Tensor::rec_709().with_alpha([0.0, 0.0, 1.0]).unwrap()] {
        let [components, others] = [&case, &many].map(|case| Components::bilinear(&case.palette, &tensor).unwrap());
        let (solution, sum) = (case.radiosity.solve(&components).unwrap(), many.radiosity.solve(&others).unwrap());
        let size = largest(sum.patches().map(|(b, _)| largest(b.iter().map(|v| v.abs()))));
        for ((b, _), (c, _)) in solution.patches().zip(sum.patches()) {
            assert!(b.iter().zip(c).all(|(b, c)| (b - c).abs() <= 1e-9 * size), "{b:?} {c:?}");
        }
        println!("bilinear: {} steps, {:e}", solution.report().iterations, solution.report().iteration_error);
    }
    let classical = Components::bilinear(&case.palette, &Tensor::classical()).unwrap();
    let naive = Components::naive(&case.palette).unwrap();
    let [one, other] = [&classical, &naive].map(|components| case.radiosity.solve(components).unwrap());
    let size = largest(other.patches().map(|(b, _)| b[0]));
    for ((b, _), (c, _)) in one.patches().zip(other.patches()) {
        assert!(b.iter().zip(c).all(|(b, c)| (b - c).abs() <= 1e-9 * size), "{b:?} {c:?}");
    }
}

/// What a solution's rows say of the light that arrives somewhere is what bins say, within the radius: the same sums of rows.
#[test]
fn gathered_rows_keep_their_bounds() {
    let case = Case::rough(&builtin::load("cornell-box", &[]).unwrap());
    let bins = UniformBins::new(&case.palette, BINS[0]).unwrap();
    let reference = case.radiosity.solve(&bins).unwrap();
    let solution = case.intervals(Mode::Certified, 1.0);
    let leaves: Vec<u32> = (0..).take(case.palette.leaves().len()).collect();
    // Sums of patches by their areas, seen by surfaces of each reflectance.
    let sum = |solution: &Solution<'_>| {
        let mut sum = vec![0.0; solution.width()];
        for (row, area) in solution.patches() {
            sum.iter_mut().zip(row).for_each(|(s, b)| *s += b * area * 1e-6 / PI);
        }
        sum
    };
    for leaf in leaves {
        let found = solution.representation().colour(&[leaf], &sum(&solution));
        let truth = reference.representation().colour(&[leaf], &sum(&reference));
        if case.palette.leaves()[leaf as usize].1 == renderers::spectral::Role::Light {
            continue;
        }
        for a in 0..3 {
            let off = (found.value[a] - truth.value[a]).abs();
            // The reference's bins are off by less than 10⁻⁵.
            assert!(off <= found.radius[a] + 1e-5 * truth.value[a], "{leaf}: {found:?} {truth:?}");
            assert!(found.radius[a] <= 0.05 * found.value[a], "{leaf}: {found:?}");
        }
    }
}
