//! Lights: colour temperature, colour rendering, action quantities.

use core::hint::black_box;

use spectral_core::Real;
use spectral_core::action::{ActionMeasures, ActionSpectra, Projection, Weighting};
use spectral_core::cct::{Cct, Locus, LocusTable, Node, PlanckianLocus, correlated_colour_temperature, xyz_to_uv};
use spectral_core::colour_rendering::{
    Cri00, Fidelity, R96_TCC_LAB, ReferenceLight, Rendering, cie_13_3, colorchecker_samples, colour_evaluation_samples,
    cri00, fidelity, fidelity_reference, munsell_samples, nearest_r96_reference, r96,
};
use spectral_core::light::{
    Chromaticity, FidelityMeter, GeneralIndices, IndexMeter, LightMeasures, LightMeter, measure, measure_fidelity,
    measure_indices,
};
use spectral_core::spectrum::{Outside, RadiationConstant, Spectrum};
use spectral_core::summation::{
    DirectColours, Illuminated, PreparedColours, SumGrid, TestColours, tristimulus_sum, weighted_sum,
};
use spectral_core::tables::alpha_opic::MELANOPIC;
use spectral_core::tables::observers::CIE_1931_2;

use crate::Run;

const CONSTANT: RadiationConstant = RadiationConstant::Its1990;

/// 380 nm to 780 nm at 5 nm, of which the optimiser knows nothing.
fn grid() -> SumGrid<81> {
    black_box(SumGrid::CIE_5NM)
}

/// A light: a smooth one with a line or two, now and then a faulty one.
fn light<R: Real>(run: &mut Run) -> [R; 81] {
    let (first, last) = (run.within::<R>(0.2, 1.0), run.within::<R>(0.2, 1.0));
    let [near, far] = [run.index(81), run.index(200)];
    core::array::from_fn(|index| {
        let base = first + (last - first) * R::from_usize(index) / R::from_usize(81);
        if index == near {
            base + R::from_usize(3)
        } else if index == far {
            -base
        } else {
            base
        }
    })
}

/// A light without faults.
fn fine_light<R: Real>(run: &mut Run) -> [R; 81] {
    light(run).map(R::abs)
}

fn put_cct<R: Real>(run: &mut Run, cct: &Cct<R>) {
    run.put_all(&[cct.temperature, cct.duv]);
    run.put_bits(cct.status as u64 + 16 * u64::from(cct.is_in_range()));
}

fn put_chromaticity<R: Real>(run: &mut Run, found: &Chromaticity<R>) {
    run.put_all(&found.xyz);
    run.put_all(&found.xy);
    run.put_all(&found.uv);
    put_cct(run, &found.cct);
    run.put_option(found.reference, |run, reference| run.put(reference.temperature));
}

fn put_rendering<R: Real, const M: usize>(run: &mut Run, found: &Rendering<R, M>) {
    run.put(found.general);
    run.put_all(&found.special);
    run.put_all(found.test_colours.as_flattened());
}

fn put_indices<R: Real>(run: &mut Run, found: &GeneralIndices<R>) {
    put_chromaticity(run, &found.chromaticity);
    run.put_option(found.ra, Run::put);
    run.put_option(found.cri00, Run::put);
}

fn put_action<R: Real>(run: &mut Run, found: &ActionMeasures<R>) {
    run.put_all(&[found.luminous_efficacy, found.acv, found.sy, found.sy_ratio, found.alpha_opic.melanopic_der()]);
    run.put_all(&found.alpha_opic.efficacy);
}

fn put_measures<R: Real>(run: &mut Run, found: &LightMeasures<R>) {
    run.put(found.power);
    put_chromaticity(run, &found.chromaticity);
    run.put_option(found.rendering, |run, rendering| {
        put_rendering(run, &rendering.ra);
        put_rendering(run, &rendering.cri00_munsell);
        put_rendering(run, &rendering.cri00_colorchecker);
        put_rendering(run, &rendering.r96_tcc_lab);
    });
    run.put_bits(found.r96_c.reference as u64);
    put_action(run, &found.action);
}

fn put_fidelity<R: Real>(run: &mut Run, found: &Fidelity<R, 99>) {
    run.put_all(&[found.rf, found.rg]);
    run.put_all(&found.special);
}

/// Colours of samples under some light.
fn illuminated<R: Real, const M: usize>(run: &mut Run) -> Illuminated<R, M> {
    let white = [run.within(0.8, 1.2), R::ONE, run.within(0.3, 1.4)];
    Illuminated { white, samples: core::array::from_fn(|_| run.array(0.02, 0.9)) }
}

/// A locus that needs no memory: a straight line in u and v.
struct Straight;

impl<R: Real> Locus<R> for Straight {
    fn node(&self, _: usize) -> Node<R> {
        Node::default()
    }
}

entries! {
    light_measure_indices 8 ["light::measure_indices"] |run, R| {
        let light = light::<R>(run);
        let found = run.time_call(|| measure_indices(grid(), &light, CONSTANT));
        run.put_option(found.ok(), |run, found| put_indices(run, &found));
    }
    light_index_meter 1 ["light::IndexMeter::new", "light::IndexMeter::measure"] |run, R| {
        let light = fine_light::<R>(run);
        let meter = IndexMeter::new(grid(), CONSTANT);
        let found = run.time_call(|| meter.measure(&light));
        run.put_option(found.ok(), |run, found| put_indices(run, &found));
    }
    light_measure 1 ["light::measure", "action::AlphaOpic::melanopic_der"] |run, R| {
        let light = fine_light::<R>(run);
        let found = run.time_call(|| measure(grid(), &light, CONSTANT));
        run.put_option(found.ok(), |run, found| put_measures(run, &found));
    }
    light_meter 1 [
        "light::LightMeter::new", "light::LightMeter::measure", "light::LightMeter::chromaticity",
        "light::LightMeter::munsell",
    ] |run, R| {
        let light = fine_light::<R>(run);
        let meter = LightMeter::new(grid(), CONSTANT);
        let found = run.time_call(|| meter.measure(&light));
        run.put_option(found.ok(), |run, found| put_measures(run, &found));
        run.put_option(meter.chromaticity(&light).ok(), |run, found| put_chromaticity(run, &found));
        run.put_option(meter.munsell(&light).ok(), |run, (found, renderings)| {
            put_chromaticity(run, &found);
            run.put_option(renderings, |run, [ra, _]| put_rendering(run, &ra));
        });
    }
    light_measure_fidelity 1 ["light::measure_fidelity"] |run, R| {
        let light = fine_light::<R>(run);
        let found = run.time_call(|| measure_fidelity(grid(), &light, CONSTANT));
        run.put_option(found.ok().flatten(), |run, found| put_fidelity(run, &found));
    }
    light_fidelity_meter 1 ["light::FidelityMeter::new", "light::FidelityMeter::measure"] |run, R| {
        let light = fine_light::<R>(run);
        let meter = FidelityMeter::new(grid(), CONSTANT);
        let found = run.time_call(|| meter.measure(&light));
        run.put_option(found.ok().flatten(), |run, found| put_fidelity(run, &found));
    }
    cct_xyz_to_uv 24 ["cct::xyz_to_uv"] |run, R| {
        let xyz = run.array::<R, 3>(0.0, 1.2);
        let uv = run.time_call(|| xyz_to_uv(xyz));
        run.put_all(&uv);
    }
    cct_correlated_colour_temperature 4 [
        "cct::correlated_colour_temperature", "cct::Cct::is_in_range", "cct::PlanckianLocus::new",
        "cct::PlanckianLocus::observer", "cct::Locus for PlanckianLocus",
    ] |run, R| {
        let observer = grid().observer(&CIE_1931_2);
        let locus = PlanckianLocus::<R, 81>::new(grid(), &observer, CONSTANT);
        let uv = [run.within(0.17, 0.35), run.within(0.28, 0.40)];
        let found = run.time_call(|| correlated_colour_temperature(uv, &locus));
        run.put_option(found, |run, cct| put_cct(run, &cct));
        run.put_option(correlated_colour_temperature(uv, &Straight), |run, cct| put_cct(run, &cct));
        let index = run.index(81);
        run.put_option(locus.observer().get(index), |run, cmf| run.put_all(cmf));
    }
    cct_locus_spectrum 2 ["cct::PlanckianLocus::spectrum", "cct::PlanckianLocus::uv"] |run, R| {
        let observer = grid().observer(&CIE_1931_2);
        let locus = PlanckianLocus::<R, 81>::new(grid(), &observer, CONSTANT);
        let temperature = run.within(800.0, 20_000.0);
        let spectrum = run.time_call(|| locus.spectrum(temperature));
        run.put_all(&spectrum);
        run.put_all(&locus.uv(temperature));
    }
    cct_locus_table 1 ["cct::LocusTable::new", "cct::Locus for LocusTable"] |run, R| {
        let observer = grid().observer(&CIE_1931_2);
        let table = LocusTable::new(&PlanckianLocus::<R, 81>::new(grid(), &observer, CONSTANT));
        for _ in 0..24 {
            let uv = [run.within(0.17, 0.35), run.within(0.28, 0.40)];
            let found = run.time_call(|| correlated_colour_temperature(uv, &table));
            run.put_option(found, |run, cct| put_cct(run, &cct));
        }
    }
    summation_grid 12 [
        "summation::SumGrid::new", "summation::SumGrid::first", "summation::SumGrid::step",
        "summation::SumGrid::wavelength", "summation::SumGrid::sample", "summation::SumGrid::observer",
    ] |run, R| {
        let (first, step) = (run.short() % 450, run.short() % 24);
        let found = run.time_call(|| SumGrid::<41>::new(first, step));
        run.put_option(found.ok(), |run, grid| {
            run.put_bits(u64::from(grid.first()) + (u64::from(grid.step()) << 32));
            let index = run.index(100);
            run.put(grid.wavelength::<R>(index));
            run.put_all(&grid.sample(&MELANOPIC.spectrum::<R>(Outside::Zero)));
            run.put_all(grid.observer::<R>(&CIE_1931_2).as_flattened());
        });
    }
    summation_sums 8 ["summation::tristimulus_sum", "summation::weighted_sum"] |run, R| {
        let light = fine_light::<R>(run);
        let observer = grid().observer(&CIE_1931_2);
        let sums = run.time_call(|| tristimulus_sum(&observer, &light));
        run.put_all(&sums);
        run.put(weighted_sum(&light, &light));
    }
    summation_direct_colours 1 [
        "summation::DirectColours::new", "summation::TestColours for DirectColours",
        "colour_rendering::munsell_samples",
    ] |run, R| {
        let light = fine_light::<R>(run);
        let (observer, samples) = (grid().observer(&CIE_1931_2), munsell_samples::<R>());
        let colours = DirectColours::new(grid(), &observer, &samples);
        let found = run.time_call(|| colours.illuminate(&light));
        run.put_option(found, |run, found| run.put_all(found.samples.as_flattened()));
    }
    summation_prepared_colours 1 [
        "summation::PreparedColours::new", "summation::TestColours for PreparedColours",
        "colour_rendering::colorchecker_samples",
    ] |run, R| {
        let light = fine_light::<R>(run);
        let observer = grid().observer(&CIE_1931_2);
        let colours = PreparedColours::<R, 81, 10>::new(grid(), &observer, &colorchecker_samples::<R>());
        let found = run.time_call(|| colours.illuminate(&light));
        run.put_option(found, |run, found| run.put_all(found.samples.as_flattened()));
    }
    colour_rendering_cie_13_3 4 ["colour_rendering::cie_13_3"] |run, R| {
        let (test, reference) = (illuminated::<R, 14>(run), illuminated(run));
        let found = run.time_call(|| cie_13_3(&test, &reference));
        put_rendering(run, &found);
    }
    colour_rendering_cri00 4 ["colour_rendering::cri00"] |run, R| {
        let (test, reference) = (illuminated::<R, 14>(run), illuminated(run));
        let method = black_box(Cri00::MUNSELL);
        let found = run.time_call(|| cri00(&test, &reference, &method));
        put_rendering(run, &found);
    }
    colour_rendering_r96 4 ["colour_rendering::r96", "colour_rendering::nearest_r96_reference"] |run, R| {
        let (test, reference) = (illuminated::<R, 10>(run), illuminated(run));
        let found = run.time_call(|| r96(&test, &reference, R96_TCC_LAB));
        put_rendering(run, &found);
        let references = core::array::from_fn(|_| run.array::<R, 3>(0.5, 1.2));
        run.put_bits(nearest_r96_reference(test.white, &references) as u64);
    }
    colour_rendering_fidelity 2 [
        "colour_rendering::fidelity", "colour_rendering::colour_evaluation_samples",
    ] |run, R| {
        let (test, reference) = (illuminated::<R, 20>(run), illuminated(run));
        let found = run.time_call(|| fidelity(&test, &reference));
        run.put_all(&[found.rf, found.rg]);
        run.put_all(&found.special);
        let samples = colour_evaluation_samples::<R>();
        let (sample, wavelength) = (run.index(99), run.within(380.0, 780.0));
        run.put_option(samples.get(sample), |run, sample| run.put(sample.value(wavelength)));
    }
    colour_rendering_reference 2 [
        "colour_rendering::ReferenceLight::for_temperature", "colour_rendering::ReferenceLight::spectrum",
        "colour_rendering::fidelity_reference",
    ] |run, R| {
        let observer = grid().observer(&CIE_1931_2);
        let locus = PlanckianLocus::<R, 81>::new(grid(), &observer, CONSTANT);
        let temperature = run.within(400.0, 8000.0);
        let found = run.time_call(|| ReferenceLight::for_temperature(temperature)?.spectrum(grid(), &locus));
        run.put_option(found, |run, spectrum| run.put_all(&spectrum));
        run.put_option(fidelity_reference(temperature, grid(), &locus, &observer), |run, spectrum| {
            run.put_all(&spectrum);
        });
    }
    action_measure 1 ["action::ActionSpectra::new", "action::ActionSpectra::measure"] |run, R| {
        let light = fine_light::<R>(run);
        let (spectra, sums) = (ActionSpectra::new(grid()), run.array(0.0, 20.0));
        let found = run.time_call(|| spectra.measure(&light, sums, R::ONE));
        run.put_option(found, |run, found| put_action(run, &found));
    }
    action_projection 1 [
        "action::Weighting::new", "action::Weighting::weights", "action::Weighting::apply", "action::Projection::new",
        "action::Projection::apply", "action::Projection::rgb", "action::Projection::relative_error",
    ] |run, R| {
        let light = fine_light::<R>(run);
        let observer = grid().observer(&CIE_1931_2);
        let weighting = Weighting::new(grid(), &MELANOPIC.spectrum::<R>(Outside::Zero));
        run.put(weighting.apply(&light));
        run.put_all(weighting.weights());
        let found = run.time_call(|| Projection::new(&observer, &weighting));
        run.put_option(found, |run, found| {
            run.put_all(&found.coefficients);
            let xyz = run.array(0.0, 1.0);
            run.put_all(&[found.residual, found.apply(xyz), found.relative_error(&observer, &weighting, &light)]);
            run.put_all(&found.rgb(&black_box(spectral_core::action::RADIANCE_RGB_TO_XYZ)));
        });
    }
}
