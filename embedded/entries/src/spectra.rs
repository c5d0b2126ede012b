//! Spectra, observers, tables and integrals.

use core::hint::black_box;

use spectral_core::spectrum::{
    Constant, Daylight, Line, Lines, Outside, PiecewiseLinear, Planck, RadiationConstant, Rounding, Scaled, Segment,
    Spectrum, Uniform,
};
use spectral_core::tables::{self, fluorescent, illuminants, lines, metals, observers};
use spectral_core::{Observer, Real, tristimulus};

use crate::Run;

/// Takes a linear piece into the digest.
fn put_segment<R: Real>(run: &mut Run, segment: Segment<R>) {
    run.put_all(&[segment.end, segment.first, segment.last]);
}

/// Value and piece of a spectrum at a wavelength in and around the visible range.
pub(crate) fn put_spectrum<R: Real, S: Spectrum<R> + ?Sized>(run: &mut Run, spectrum: &S) {
    let wavelength = run.within(300.0, 900.0);
    let (value, segment) = run.time_call(|| (spectrum.value(wavelength), spectrum.segment(wavelength)));
    run.put(value);
    put_segment(run, segment);
}

/// What the spectrum is outside of its nodes.
fn outside(run: &mut Run) -> Outside {
    if run.below(2) == 0 { Outside::Zero } else { Outside::Hold }
}

/// Increasing wavelengths from about 350 nm on, as many as there are.
fn wavelengths<R: Real, const N: usize>(run: &mut Run) -> [R; N] {
    let mut wavelength = run.within::<R>(340.0, 360.0);
    core::array::from_fn(|_| {
        wavelength += run.within(1.0, 60.0);
        wavelength
    })
}

entries! {
    spectrum_piecewise_linear 24 [
        "spectrum::PiecewiseLinear::new", "spectrum::PiecewiseLinear::wavelengths", "spectrum::PiecewiseLinear::values",
        "spectrum::PiecewiseLinear::check_non_negative", "spectrum::Spectrum for PiecewiseLinear",
    ] |run, R| {
        let nodes: [R; 12] = wavelengths(run);
        let values: [R; 12] = run.array(-0.1, 1.0);
        let count = run.index(13);
        let (nodes, values) = (nodes.get(..count).unwrap_or_default(), values.get(..count).unwrap_or_default());
        let found = PiecewiseLinear::new(nodes, values, outside(run));
        run.put_option(found.ok(), |run, spectrum| {
            put_spectrum(run, &spectrum);
            run.put_all(spectrum.wavelengths());
            run.put_all(spectrum.values());
            run.put_bits(u64::from(spectrum.check_non_negative().is_ok()));
        });
    }
    spectrum_uniform 24 [
        "spectrum::Uniform::new", "spectrum::Uniform::first", "spectrum::Uniform::step", "spectrum::Uniform::values",
        "spectrum::Uniform::check_non_negative", "spectrum::Spectrum for Uniform",
    ] |run, R| {
        let values: [R; 12] = run.array(-0.1, 1.0);
        let count = run.index(13);
        let (first, step) = (run.within(300.0, 500.0), run.within(-1.0, 50.0));
        let found = Uniform::new(first, step, values.get(..count).unwrap_or_default(), outside(run));
        run.put_option(found.ok(), |run, spectrum| {
            put_spectrum(run, &spectrum);
            run.put_all(&[spectrum.first(), spectrum.step()]);
            run.put_all(spectrum.values());
            run.put_bits(u64::from(spectrum.check_non_negative().is_ok()));
        });
    }
    spectrum_constant_and_scaled 12 [
        "spectrum::Constant::new", "spectrum::Scaled::new", "spectrum::Spectrum for Constant",
        "spectrum::Spectrum for Scaled", "spectrum::Spectrum for &S",
    ] |run, R| {
        let (value, factor) = (run.within::<R>(0.0, 1.0), run.within::<R>(-2.0, 2.0));
        run.put_option(Constant::new(value).ok(), |run, spectrum| {
            put_spectrum(run, &spectrum);
            run.put_option(Scaled::new(&spectrum, factor).ok(), |run, scaled| put_spectrum(run, &&scaled));
        });
    }
    spectrum_planck 24 [
        "spectrum::Planck::new", "spectrum::Planck::temperature", "spectrum::Planck::radiance",
        "spectrum::RadiationConstant::metre_kelvin", "spectrum::Spectrum for Planck",
    ] |run, R| {
        let constant = black_box(RadiationConstant::Its1990);
        let temperature = run.within::<R>(-100.0, 20_000.0);
        let wavelength = run.within::<R>(200.0, 2000.0);
        run.put(R::from_f64(constant.metre_kelvin()));
        run.put_option(Planck::new(temperature, constant).ok(), |run, planck| {
            run.put_all(&[planck.temperature(), planck.radiance(wavelength)]);
            put_spectrum(run, &planck);
        });
    }
    spectrum_daylight 24 [
        "spectrum::Daylight::new", "spectrum::Daylight::nominal", "spectrum::Daylight::chromaticity",
        "spectrum::Daylight::factors", "spectrum::Spectrum for Daylight",
    ] |run, R| {
        let temperature = run.within::<R>(3000.0, 26_000.0);
        let rounding = if run.below(2) == 0 { Rounding::None } else { Rounding::ThreeDecimals };
        run.put_option(Daylight::new(temperature, rounding).ok(), |run, daylight| {
            run.put_all(&daylight.chromaticity());
            put_spectrum(run, &daylight);
        });
        run.put_option(Daylight::nominal(temperature, rounding).ok(), |run, daylight| {
            run.put_all(&daylight.factors());
        });
    }
    spectrum_lines 24 [
        "spectrum::Line::new", "spectrum::Line::centre", "spectrum::Line::peak", "spectrum::Lines::new",
        "spectrum::Lines::iter", "spectrum::Spectrum for Line", "spectrum::Spectrum for Lines",
        "tables::LineTable::spectrum",
    ] |run, R| {
        let (centre, width, power) = (run.within::<R>(400.0, 700.0), run.within::<R>(-1.0, 9.0), run.unit::<R>());
        run.put_option(Line::new(centre, width, power).ok(), |run, line| {
            run.put_all(&[line.centre(), line.peak()]);
            put_spectrum(run, &line);
        });
        let (centres, powers): ([R; 6], [R; 6]) = (wavelengths(run), run.array(0.0, 1.0));
        run.put_option(Lines::new(&centres, &powers, width).ok(), |run, lines| {
            put_spectrum(run, &lines);
            for line in lines.iter() {
                run.put(line.peak());
            }
        });
        run.put_option(black_box(&lines::MERCURY).spectrum(width).ok(), |run, lines| put_spectrum(run, &lines));
    }
    tables_light 12 ["tables::UniformTable::spectrum"] |run, R| {
        let spectrum = black_box(illuminants::D65).spectrum::<R>(outside(run));
        put_spectrum(run, &spectrum);
    }
    tables_metal 12 ["tables::MetalTable::n", "tables::MetalTable::k"] |run, R| {
        let metal = black_box(&metals::AU);
        put_spectrum(run, &metal.n::<R>());
        put_spectrum(run, &metal.k::<R>());
    }
    tables_observer 12 ["tables::ObserverTable::cmf"] |run, R| {
        let index = run.index(600);
        let result = run.time_call(|| observers::CIE_1931_2.cmf::<R>(index));
        run.put_all(&result);
    }
    tables_find 2 [
        "tables::find_light", "tables::find_lines", "tables::find_metal", "tables::find_glass", "tables::lights",
    ] |run, R| {
        let name = ["FL2", "fl3.1", "mercury", "Au", "N-BK7", "d65", "", "é"];
        for name in name {
            let name = black_box(name);
            run.put_option(tables::find_light(name), |run, table| put_spectrum(run, &table.spectrum::<R>(Outside::Hold)));
            run.put_option(tables::find_lines(name), |run, table| run.put_text(table.name));
            run.put_option(tables::find_metal(name), |run, table| run.put_text(table.name));
            run.put_option(tables::find_glass(name), |run, table| run.put_text(table.name));
        }
        run.put_bits(tables::lights().count() as u64);
    }
    observer_value 24 [
        "observer::Observer::value", "observer::Observer::cie_1931_2deg", "observer::Observer::cie_1964_10deg",
    ] |run, R| {
        let wavelength = run.within::<R>(350.0, 840.0);
        let observer = if run.below(2) == 0 { Observer::cie_1931_2deg() } else { Observer::cie_1964_10deg() };
        let result = run.time_call(|| observer.value(wavelength));
        run.put_all(&result);
    }
    observer_new 12 ["observer::Observer::new"] |run, R| {
        let columns: [[R; 9]; 3] = [run.array(0.0, 1.0), run.array(0.0, 1.0), run.array(0.0, 1.0)];
        let count = run.index(10);
        let columns = columns.each_ref().map(|column| column.get(..count).unwrap_or_default());
        let (first, step) = (run.within(350.0, 500.0), run.within(-10.0, 60.0));
        let found = run.time_call(|| Observer::<R>::new(first, step, columns));
        run.put_option(found.ok(), |run, observer| {
            let wavelength = run.within(350.0, 800.0);
            run.put_all(&observer.value(wavelength));
        });
    }
    integrate_tristimulus 2 ["integrate::tristimulus"] |run, R| {
        let light = fluorescent::FL2.spectrum::<R>(Outside::Zero);
        let (from, to) = (run.within(360.0, 500.0), run.within(550.0, 800.0));
        let result = run.time_call(|| tristimulus(&Observer::cie_1931_2deg(), &light, from, to));
        run.put_all(&result);
    }
    real_functions 64 ["real::Real for $float"] |run, R| {
        let (x, y) = (run.within::<R>(-8.0, 8.0), run.within::<R>(0.0, 2.0));
        let (a, b) = (run.within::<R>(-1.0, 1.0), run.within::<R>(0.0, 1e4));
        run.put_all(&[x.sin(), x.cos(), x.tan(), b.sin(), b.cos(), b.tan(), x.atan(), y.atan2(x), x.hypot(b)]);
        run.put_all(&[a.asin(), a.acos(), x.exp(), a.exp_m1(), b.ln(), y.powf(x), b.powf(a), x.cbrt(), b.sqrt()]);
        run.put_all(&[x.abs(), x.floor(), x.min(y), x.max(a), x.clamp(a, y), y.binade(), R::from_usize(b.to_usize())]);
        run.put_bits(u64::from(x.is_finite()) + 2 * u64::from(x.is_nan()));
        let scale = R::from_f64(b.to_f64() * 1e-7);
        run.put_all(&[scale.sqrt(), scale.cbrt(), scale.ln(), scale.exp_m1(), y.reciprocal_cbrt_estimate()]);
    }
}
