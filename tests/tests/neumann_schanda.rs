//! Interreflections in a room and the colour rendering of light (Neumann and Schanda 2006): three pairs of lamp and paint with which the
//! index rises, falls and stays, each by a closed form and by the built-in scene.
#![allow(clippy::unwrap_used, reason = "helpers of tests fail by panicking")]
#![allow(clippy::print_stdout, reason = "tables for people who run the test with --nocapture")]

use renderers::illuminance::{self, ColourMeter, LightColour, Meter, Nanometres, SpectralIndirect};
use renderers::radiosity::{IndirectRadiosity, Radiosity, Settings};
use renderers::scene::builtin;
use renderers::scene::glam::DVec3;
use renderers::spectral::{Palette, UniformBins};
use spectral_core::light::{GeneralIndices, measure_indices};
use spectral_core::spectrum::{Outside, RadiationConstant};
use spectral_core::summation::SumGrid;
use spectral_core::tables::UniformTable;
use spectral_core::tables::colorchecker::{ORANGE_YELLOW, RED};
use spectral_core::tables::fluorescent::{FL2, FL3_14};
use spectral_core::tables::led::LED_V2;

const GRID: SumGrid<81> = SumGrid::CIE_5NM;
type Samples = [f64; 81];

struct Pair {
    lamp: (&'static str, &'static UniformTable),
    paint: (&'static str, &'static UniformTable),
    /// What R_a does: +1, −1 or 0.
    change: i8,
}

const PAIRS: [Pair; 3] = [
    Pair { lamp: ("fl2", &FL2), paint: ("red", &RED), change: 1 },
    Pair { lamp: ("led_v2", &LED_V2), paint: ("red", &RED), change: -1 },
    Pair { lamp: ("fl3_14", &FL3_14), paint: ("orange_yellow", &ORANGE_YELLOW), change: 0 },
];
/// R_a stays if it moves by less than this; 1 is about what can be told apart side by side, and the others move by ten times that.
const STAYS: f64 = 1.0;

fn samples(table: &UniformTable) -> Samples {
    GRID.sample(&table.spectrum(Outside::Zero))
}

fn indices(light: &Samples) -> LightColour {
    let GeneralIndices { chromaticity, ra, cri00 } = measure_indices(GRID, light, RadiationConstant::Its1990).unwrap();
    LightColour { cct: chromaticity.cct.temperature, duv: chromaticity.cct.duv, ra, cri00_munsell: cri00 }
}

/// (a) The mean irradiance of an enclosure of one paint, Φ/(S(1 − ρ)): direct light Φ/S and reflected light Φρ/(S(1 − ρ)). Up to Φ/S.
fn closed_form(pair: &Pair) -> Samples {
    let (lamp, paint) = (samples(pair.lamp.1), samples(pair.paint.1));
    core::array::from_fn(|i| lamp[i] / (1.0 - paint[i]))
}

/// (b) The built-in scene.
struct Cube {
    /// Mean irradiance over all that is inside.
    mean: Samples,
    /// Mean of readings at Gauss–Legendre nodes on all sides.
    of_readings: Samples,
    floor_centre: LightColour,
    /// At the ceiling there is reflected light alone.
    ceiling: LightColour,
    corner: LightColour,
}

/// Nodes and weights of the rule of 4 points on [−1, 1].
const GAUSS: [(f64, f64); 4] = [
    (-0.861_136_311_594_052_6, 0.347_854_845_137_453_9),
    (-0.339_981_043_584_856_3, 0.652_145_154_862_546_1),
    (0.339_981_043_584_856_3, 0.652_145_154_862_546_1),
    (0.861_136_311_594_052_6, 0.347_854_845_137_453_9),
];

/// Places on the six sides of the cube with their inward normals and weights, whose sum is 1. Walls are alike.
fn places() -> Vec<(DVec3, DVec3, f64)> {
    let mut places = Vec::new();
    for (a, wa) in GAUSS {
        for (b, wb) in GAUSS {
            let weight = wa * wb / 24.0;
            let [a, b] = [1.5 * a, 1.5 * b];
            places.push((DVec3::new(a, b, 0.0), DVec3::Z, weight));
            places.push((DVec3::new(a, b, 3.0), DVec3::NEG_Z, weight));
            places.push((DVec3::new(1.5, a, 1.5 + b), DVec3::NEG_X, 4.0 * weight));
        }
    }
    places
}

fn cube(pair: &Pair) -> Cube {
    let parameters = [("lamp", pair.lamp.0), ("paint", pair.paint.0)].map(|(n, v)| (n.to_owned(), v.to_owned()));
    let scene = builtin::load("neumann-schanda", &parameters).unwrap();
    let mut palette = Palette::default();
    let radiosity = Radiosity::new(&scene, &Settings::default(), &mut palette, &|_| {}).unwrap();
    let (bins, nanometres) = (UniformBins::new(&palette, 81).unwrap(), Nanometres::new(&palette).unwrap());
    let (coarse, fine) = (radiosity.solve(&bins).unwrap(), radiosity.solve(&nanometres).unwrap());
    assert!((fine.report().closed - 1.0).abs() <= 1e-12 && fine.report().iteration_error <= 1e-6);
    // What is reflected is ρ times what arrives.
    let (paint, mut mean, mut area) = (samples(pair.paint.1), [0.0; 81], 0.0);
    for (row, of_patch) in fine.patches() {
        area += of_patch;
        mean.iter_mut().zip(row.iter().step_by(5)).for_each(|(m, b)| *m += b * of_patch);
    }
    let mean = core::array::from_fn(|i| mean[i] / (area * paint[i]));
    let lux = IndirectRadiosity::new(&coarse, &bins).unwrap();
    let light = SpectralIndirect::new(&lux, &fine).unwrap();
    let meter = Meter::new(&scene, illuminance::Settings::default(), Some(&light)).unwrap();
    let colours = ColourMeter::default();
    let at = |position: DVec3, normal: DVec3| colours.measure(&meter, &meter.read(position, normal).unwrap()).unwrap();
    let mut of_readings = [0.0; 81];
    for (position, normal, weight) in places() {
        let reading = meter.read(position, normal).unwrap();
        for (i, sum) in of_readings.iter_mut().enumerate() {
            *sum += weight * meter.irradiance(&reading, GRID.wavelength(i));
        }
    }
    Cube {
        mean,
        of_readings,
        floor_centre: at(DVec3::ZERO, DVec3::Z),
        ceiling: at(DVec3::new(0.9, 0.9, 3.0), DVec3::NEG_Z),
        corner: at(DVec3::new(1.45, 1.45, 0.0), DVec3::Z),
    }
}

fn show(place: &str, colour: &LightColour, lamp: &LightColour) {
    let ra = colour.ra.unwrap();
    println!(
        "  {place:34} CCT {:6.0} K  Duv {:+.4}  R_a {ra:6.2} ({:+.2})  CRI00 {:7.2}",
        colour.cct,
        colour.duv,
        ra - lamp.ra.unwrap(),
        colour.cri00_munsell.unwrap()
    );
}

#[test]
fn the_index_rises_falls_or_stays() {
    for pair in &PAIRS {
        let lamp = indices(&samples(pair.lamp.1));
        let exact = closed_form(pair);
        let (a, cube) = (indices(&exact), cube(pair));
        let (b, c) = (indices(&cube.mean), indices(&cube.of_readings));
        println!("{} on {}", pair.lamp.0, pair.paint.0);
        for (place, colour) in [
            ("lamp", &lamp),
            ("mean, closed form", &a),
            ("mean, scene's patches", &b),
            ("mean, readings on all sides", &c),
            ("floor, centre", &cube.floor_centre),
            ("floor, corner", &cube.corner),
            ("ceiling, reflected light alone", &cube.ceiling),
        ] {
            show(place, colour, &lamp);
        }
        agree(pair, &exact, &cube);
        let change = |colour: &LightColour| colour.ra.unwrap() - lamp.ra.unwrap();
        for colour in [&a, &b, &c, &cube.floor_centre, &cube.corner] {
            match pair.change {
                1 => assert!(change(colour) >= 5.0 * STAYS, "{colour:?}"),
                -1 => assert!(change(colour) <= -5.0 * STAYS, "{colour:?}"),
                _ => assert!(change(colour).abs() <= STAYS, "{colour:?}"),
            }
            // Reddish and yellowish paints make all light warmer, also where the index stays.
            assert!(colour.cct <= 0.9 * lamp.cct, "{colour:?}");
        }
    }
}

/// Both ways give one spectrum and one index.
fn agree(pair: &Pair, exact: &Samples, cube: &Cube) {
    // Φ/S of the scene: π × 0.36 m² of lamp, 54 m² of sides; its lamps are tables of six digits.
    let lamp = samples(pair.lamp.1);
    let scale = |spectrum: &Samples| spectrum.iter().sum::<f64>() / exact.iter().sum::<f64>();
    for (name, spectrum, tolerance) in [("patches", &cube.mean, 2e-5), ("readings", &cube.of_readings, 5e-3)] {
        let scale = scale(spectrum);
        for i in 0..81 {
            let error = (spectrum[i] / scale - exact[i]).abs();
            assert!(error <= tolerance * exact[i] || lamp[i] == 0.0, "{name}, sample {i}: {error}, {}", exact[i]);
        }
    }
    let (a, b, c) = (indices(exact), indices(&cube.mean), indices(&cube.of_readings));
    // 2e-5 of a spectrum moves an index of 100 by less than that.
    assert!((a.ra.unwrap() - b.ra.unwrap()).abs() <= 2e-3, "{a:?} {b:?}");
    assert!((a.cri00_munsell.unwrap() - b.cri00_munsell.unwrap()).abs() <= 2e-3, "{a:?} {b:?}");
    assert!((a.ra.unwrap() - c.ra.unwrap()).abs() <= 0.2, "{a:?} {c:?}");
}

/// A paint that is grey changes nothing: here the closed form alone, as the scene's is the same at each wavelength.
#[test]
fn a_grey_paint_changes_nothing() {
    let lamp = samples(&FL2);
    let (before, after) = (indices(&lamp), indices(&lamp.map(|s| s / (1.0 - 0.6))));
    assert!((before.ra.unwrap() - after.ra.unwrap()).abs() <= 1e-9 && (before.cct / after.cct - 1.0).abs() <= 1e-12);
}
