//! Time of a whole picture by each spectral representation: interleaved runs, medians and ratios.
//!
//! `cargo bench -p renderers --bench representations [-- SCENE [SIDE [SPP [RUNS]]]]`, by default `cornell-box` at 512 × 512 with the
//! scene's rays per pixel in 7 runs. The preparation of the spectra counts.
#![allow(clippy::print_stdout, reason = "a benchmark prints its table")]

use renderers::render::{Options, Spectra, render};
use renderers::report::Table;
use renderers::scene::builtin;
use renderers::spectral::IntervalSettings;

fn main() -> Result<(), Box<dyn core::error::Error>> {
    let words: Vec<String> = std::env::args().skip(1).filter(|word| !word.starts_with("--")).collect();
    let number = |place: usize, default: u32| words.get(place).map_or(Ok(default), |word| word.parse());
    let scene = builtin::load(words.first().map_or(builtin::DEFAULT, String::as_str), &[])?;
    let (side, samples, runs) = (number(1, 512)?, number(2, scene.sampler.sample_count)?, number(3, 7)?);
    let interval = |threshold| Spectra::Interval(IntervalSettings { threshold, ..IntervalSettings::default() });
    let ways = [
        ("rgb", Spectra::Rgb),
        ("rgb-prefiltered", Spectra::RgbPrefiltered),
        ("bilinear", Spectra::Bilinear),
        ("smits", Spectra::Smits),
        ("interval, threshold 1", interval(1.0)),
        ("interval, threshold 3", interval(3.0)),
        ("uniform:81", Spectra::Uniform(81)),
        ("uniform:401", Spectra::Uniform(401)),
    ];
    let mut seconds = vec![Vec::new(); ways.len()];
    for _ in 0..runs {
        for ((_, spectra), times) in ways.iter().zip(&mut seconds) {
            let options =
                Options { spectra: *spectra, size: Some([side, side]), samples: Some(samples), ..Options::default() };
            let rendering = render(&scene, &options, &|_| {})?;
            times.push(rendering.seconds + rendering.preparation_seconds);
        }
    }
    let medians: Vec<f64> = seconds.iter_mut().map(|times| median(times)).collect();
    let mut table = Table::new(["representation", "seconds", "to rgb", "to uniform:81", "ns a pixel over rgb"]);
    for ((name, _), time) in ways.iter().zip(&medians) {
        let pixels = f64::from(side) * f64::from(side);
        table.row([
            (*name).to_owned(),
            format!("{time:.4}"),
            format!("{:.3}", time / medians[0]),
            format!("{:.3}", time / medians[6]),
            format!("{:.0}", (time - medians[0]) / pixels * 1e9),
        ]);
    }
    println!("{}, {side} × {side}, {samples} rays a pixel, medians of {runs} interleaved runs\n{table}", scene.name);
    Ok(())
}

fn median(times: &mut [f64]) -> f64 {
    times.sort_by(f64::total_cmp);
    times.get(times.len() / 2).copied().unwrap_or(f64::NAN)
}
