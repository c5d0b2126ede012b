//! Luminous intensity distributions: interpolation, flux, symmetry, directions and round trips.
#![allow(clippy::unwrap_used, reason = "a test stops at the first thing that should not be")]

extern crate alloc;

use alloc::sync::Arc;
use core::f64::consts::PI;

use proptest::prelude::*;
use proptest::test_runner::{Config, RngSeed};
use renderers::luminaire::{
    Format, IntensityError, LuminousIntensity, PhotometricFile, Place, PlacedLuminaire, Symmetry, parse_ies,
};
use renderers::scene::glam::{DAffine3, DVec3};
use spectral_tests::dense::gauss_legendre;

/// Flux in closed form: sums of some hundred cells of either sign of rounding.
const FLUX: f64 = 1e-12;

fn table(planes: &[f64], gammas: &[f64], candela: &[f64]) -> LuminousIntensity {
    LuminousIntensity::table(planes.to_vec(), gammas.to_vec(), candela.to_vec()).unwrap()
}

#[track_caller]
fn assert_near(found: f64, expected: f64, relative: f64) {
    assert!((found - expected).abs() <= relative * expected.abs(), "{found}, expected {expected}");
}

#[test]
fn the_flux_of_idealised_sources_is_their_closed_form() {
    let isotropic = LuminousIntensity::isotropic(123.0).unwrap();
    assert_near(isotropic.flux(), 4.0 * PI * 123.0, FLUX);
    assert_near(isotropic.zonal_flux(60.0, 90.0), PI * 123.0, FLUX);
    let lambertian = LuminousIntensity::lambertian(123.0).unwrap();
    assert_near(lambertian.flux(), PI * 123.0, FLUX);
    assert_near(lambertian.zonal_flux(0.0, 30.0), PI * 123.0 / 4.0, FLUX);
    assert_eq!(lambertian.zonal_flux(90.0, 180.0), 0.0);
    assert_near(lambertian.candela(77.0, 60.0), 61.5, 4.0 * f64::EPSILON);
    assert_eq!((lambertian.candela(0.0, 90.1), isotropic.candela(0.0, 180.0)), (0.0, 123.0));
    // As tables: the isotropic one is exact; chords of a cosine, h wide, are below it by h²/12 of it on average.
    assert_near(isotropic.expanded().flux(), 4.0 * PI * 123.0, FLUX);
    let step = 1.0_f64.to_radians();
    assert_near(lambertian.expanded().flux(), PI * 123.0 * (1.0 - step * step / 12.0), step.powi(4));
}

/// ∫ (a + b γ) sin γ dγ over a half turn is 2 a + b π, and a table of any steps is that function exactly.
#[test]
fn the_flux_of_a_linear_table_is_its_closed_form() {
    let (a, b) = (50.0, 30.0);
    for steps in [1, 2, 7, 36, 180, 3600] {
        let gammas: Vec<f64> = (0..=steps).map(|i| 180.0 * f64::from(i) / f64::from(steps)).collect();
        let candela: Vec<f64> = gammas.iter().map(|g| a + b * g.to_radians()).collect();
        let found = table(&[0.0], &gammas, &candela).flux();
        assert_near(found, 2.0 * PI * (2.0 * a + b * PI), FLUX);
    }
}

#[test]
fn interpolation_is_bilinear_and_ends_with_the_table() {
    let found = table(&[0.0, 90.0], &[0.0, 45.0, 90.0], &[10.0, 8.0, 1.0, 20.0, 4.0, 2.0]);
    for (c, gamma, expected) in [
        (0.0, 0.0, 10.0),
        (90.0, 45.0, 4.0),
        (45.0, 0.0, 15.0),
        (0.0, 22.5, 9.0),
        (45.0, 22.5, 10.5),
        (-45.0, 22.5, 10.5),
        (180.0, 45.0, 8.0),
        (270.0, 90.0, 2.0),
        (360.0 * 1000.0 + 90.0, 90.0, 2.0),
        (-1e-300, 90.0, 1.0),
        (0.0, 90.000_001, 0.0),
        (0.0, -1e-9, 0.0),
        (0.0, 180.0, 0.0),
    ] {
        assert_eq!(found.candela(c, gamma), expected, "C {c}, γ {gamma}");
    }
    for (c, gamma) in [(f64::NAN, 0.0), (0.0, f64::NAN), (f64::INFINITY, 0.0), (0.0, f64::NEG_INFINITY)] {
        assert!(found.candela(c, gamma).is_nan());
    }
}

/// Planes 0, 90, 180 and 270 of 1, 2, 3 and 4 cd along the horizontal; 9 up and 5 down.
fn compass() -> LuminousIntensity {
    let planes = [0.0, 90.0, 180.0, 270.0, 360.0];
    let candela = [1.0, 2.0, 3.0, 4.0, 1.0].map(|side| [5.0, side, 9.0]);
    table(&planes, &[0.0, 90.0, 180.0], candela.as_flattened())
}

#[test]
fn c0_is_x_and_c90_is_y_and_gamma_0_is_down() {
    let compass = compass();
    for (direction, expected) in [
        ([0.0, 0.0, -1.0], 5.0),
        ([0.0, 0.0, 7.0], 9.0),
        ([1.0, 0.0, 0.0], 1.0),
        ([0.0, 1.0, 0.0], 2.0),
        ([-1e-3, 0.0, 0.0], 3.0),
        ([0.0, -1e3, 0.0], 4.0),
        ([1.0, 1.0, 0.0], 1.5),
        ([-1.0, 1.0, 0.0], 2.5),
        ([1.0, 0.0, -1.0], 3.0),
        ([1.0, 0.0, 1.0], 5.0),
    ] {
        assert_near(compass.candela_towards(direction), expected, 4.0 * f64::EPSILON);
    }
}

#[test]
fn a_placed_luminaire_turns_with_its_frame() {
    let place = |to_world: DAffine3| PlacedLuminaire::new(Arc::new(compass()), &to_world);
    let at = DVec3::new(1.0, 2.0, 3.0);
    // y is up: the luminaire's z becomes y, its x stays, its y becomes −z.
    let hung = place(DAffine3::from_translation(at) * DAffine3::from_rotation_x(-PI / 2.0));
    assert_eq!(hung.position, at);
    for (direction, expected) in [
        (DVec3::NEG_Y, 5.0),
        (DVec3::Y, 9.0),
        (DVec3::X, 1.0),
        (DVec3::NEG_Z, 2.0),
        (DVec3::NEG_X, 3.0),
        (DVec3::Z, 4.0),
    ] {
        assert_near(hung.candela(direction), expected, 16.0 * f64::EPSILON);
    }
    let mirrored = place(DAffine3::from_scale(DVec3::new(1.0, -1.0, 1.0)));
    assert_near(mirrored.candela(DVec3::Y), 4.0, 16.0 * f64::EPSILON);
}

#[test]
fn numbers_that_are_no_distribution_are_refused() {
    let make = |planes: &[f64], gammas: &[f64], candela: &[f64]| {
        LuminousIntensity::table(planes.to_vec(), gammas.to_vec(), candela.to_vec()).unwrap_err()
    };
    let half = [0.0, 90.0];
    assert_eq!(make(&[0.0], &half, &[1.0]), IntensityError::Counts { expected: 2, found: 1 });
    assert!(matches!(make(&[], &half, &[]), IntensityError::PlaneRange { .. }));
    assert!(matches!(make(&[0.0], &[], &[]), IntensityError::GammaRange { .. }));
    assert!(matches!(make(&[0.0], &[90.0], &[1.0]), IntensityError::GammaRange { .. }));
    assert!(matches!(make(&[0.0, 45.0], &half, &[1.0; 4]), IntensityError::PlaneRange { .. }));
    let place = Place::Candela(1, 0);
    assert_eq!(make(&half, &half, &[1.0, 1.0, -1.0, 1.0]), IntensityError::Negative { place, value: -1.0 });
    let nan = make(&[0.0, f64::NAN], &half, &[1.0; 4]);
    assert!(matches!(nan, IntensityError::NotFinite { place: Place::Plane(1), .. }));
    assert!(matches!(
        make(&[0.0], &[0.0, 0.0], &[1.0; 2]),
        IntensityError::NotIncreasing { place: Place::Gamma(1), .. }
    ));
    assert_eq!(make(&[0.0], &half, &[1.7e308; 2]), IntensityError::Flux);
    for bad in [-1.0, f64::NAN, f64::INFINITY, 1.7e308] {
        assert!(LuminousIntensity::isotropic(bad).is_err() && LuminousIntensity::lambertian(-bad.abs()).is_err());
        assert!(compass().scaled(bad).is_err() && compass().with_flux(-bad.abs()).is_err());
    }
    let dark = table(&[0.0], &half, &[0.0; 2]);
    assert_eq!((dark.flux(), dark.with_flux(1.0)), (0.0, Err(IntensityError::Flux)));
}

fn gauss(rule: &[[f64; 2]], from: f64, to: f64, function: impl Fn(f64) -> f64) -> f64 {
    (to - from) * rule.iter().map(|[x, w]| w * function(from + (to - from) * x)).sum::<f64>()
}

/// ∫ I sin γ dγ dC by quadrature over each cell of the whole circle, through `candela` alone.
fn flux_by_quadrature(intensity: &LuminousIntensity) -> f64 {
    let expanded = intensity.expanded();
    let (planes, gammas, _) = expanded.as_table().unwrap();
    let rule = gauss_legendre(8);
    let mut sum = 0.0;
    for c in planes.windows(2) {
        // Pieces of at most 15°, for the sine.
        for cell in gammas.windows(2) {
            let pieces = ((cell[1] - cell[0]) / 15.0).ceil();
            let width = (cell[1] - cell[0]) / pieces;
            let mut low = cell[0];
            while low < cell[1] - width / 2.0 {
                let ring =
                    |gamma: f64| gauss(&rule, c[0], c[1], |c| intensity.candela(c, gamma)) * gamma.to_radians().sin();
                sum += gauss(&rule, low, low + width, ring);
                low += width;
            }
        }
    }
    sum * (PI / 180.0) * (PI / 180.0)
}

/// Increasing angles between two ends.
fn angles(first: f64, last: f64) -> impl Strategy<Value = Vec<f64>> {
    proptest::collection::vec(0.05..1.0_f64, 1..7).prop_map(move |steps| {
        let total: f64 = steps.iter().sum();
        let mut at = first;
        let mut all = vec![first];
        for step in &steps[..steps.len() - 1] {
            at += step / total * (last - first);
            all.push(at);
        }
        all.push(last);
        all
    })
}

fn any_planes() -> impl Strategy<Value = Vec<f64>> {
    prop_oneof![
        Just(vec![0.0]),
        angles(0.0, 90.0),
        angles(0.0, 180.0),
        angles(90.0, 270.0),
        angles(0.0, 360.0),
        Just((0..=24).map(|i| 15.0 * f64::from(i)).collect()),
    ]
}

fn any_gammas() -> impl Strategy<Value = Vec<f64>> {
    prop_oneof![angles(0.0, 90.0), angles(0.0, 180.0), angles(90.0, 180.0)]
}

prop_compose! {
    fn any_intensity()(planes in any_planes(), gammas in any_gammas())(
        candela in proptest::collection::vec(prop_oneof![Just(0.0), 0.0..1e4_f64], planes.len() * gammas.len()),
        planes in Just(planes), gammas in Just(gammas),
    ) -> LuminousIntensity {
        table(&planes, &gammas, &candela)
    }
}

/// An IES text as some program might write it, and nothing read yet.
fn any_file() -> impl Strategy<Value = String> {
    let edition = prop_oneof![
        Just(""),
        Just("IESNA91\n"),
        Just("IESNA:LM-63-1995\n"),
        Just("IESNA:LM-63-2002\r\n"),
        Just("IES:LM-63-2019\n")
    ];
    let label = prop_oneof!["\\[[A-Z]{1,8}\\] [ -~é]{0,20}", "[a-z]{1,12}"];
    let tilt = prop_oneof![Just("NONE\n"), Just("INCLUDE\n2\n3\n0,45,90\n1 0.95\n0.9\n")];
    let labels = proptest::collection::vec(label, 0..4).prop_map(|labels| labels.join("\n"));
    let lamps = (1..9_u32, prop_oneof![Just(-1.0), 1.0..9e4_f64], 0.01..50.0_f64, 1..=2_u8);
    let opening = (-1.0..1.0_f64, -1.0..1.0_f64, 0.0..1.0_f64, 0.1..1.2_f64, 0.0..900.0_f64);
    (edition, labels, tilt, lamps, opening, any_intensity(), 1..9_usize).prop_map(
        |(
            edition,
            labels,
            tilt,
            (number, lumens, multiplier, units),
            (w, l, h, ballast, watts),
            intensity,
            per_line,
        )| {
            let (planes, gammas, candela) = intensity.as_table().unwrap();
            let (rows, columns) = (gammas.len(), planes.len());
            let mut text =
                format!("{edition}{labels}\nTILT={tilt}{number} {lumens} {multiplier:e}\n{rows} {columns} 1 ");
            text += &format!("{units} {w},{l}, {h}\n{ballast} 1 {watts}\n");
            for values in [gammas, planes, candela] {
                for line in values.chunks(per_line) {
                    text += &line.iter().map(|v| format!("{v} ")).collect::<String>();
                    text.push('\n');
                }
            }
            text
        },
    )
}

proptest! {
    #![proptest_config(Config { cases: 512, rng_seed: RngSeed::Fixed(0x1e5), failure_persistence: None, ..Config::default() })]

    #[test]
    fn what_is_read_and_written_is_read_as_the_same(text in any_file()) {
        let first = parse_ies("a.ies", &text).unwrap();
        let written = first.to_ies();
        let second = parse_ies("b.ies", &written).unwrap();
        prop_assert_eq!(&second, &PhotometricFile { format: Format::Ies2002, ..first });
        prop_assert_eq!(second.to_ies(), written);
    }

    #[test]
    fn the_flux_is_the_integral_of_the_interpolant(intensity in any_intensity()) {
        let (found, expected) = (intensity.flux(), flux_by_quadrature(&intensity));
        prop_assert!((found - expected).abs() <= FLUX * expected.max(1e-300), "{found} {expected}");
    }

    #[test]
    fn zones_add_up(intensity in any_intensity(), a in -10.0..190.0_f64, b in -10.0..190.0_f64) {
        let (low, high) = (a.min(b), a.max(b));
        let parts = [(-5.0, low), (low, high), (high, 200.0)].map(|(from, to)| intensity.zonal_flux(from, to));
        let flux = intensity.flux();
        prop_assert!((parts.iter().sum::<f64>() - flux).abs() <= FLUX * flux, "{parts:?} {flux}");
        prop_assert!(parts.iter().all(|part| *part >= 0.0));
    }

    /// Also that symmetric files are their expansions.
    #[test]
    fn expansion_changes_nothing(intensity in any_intensity(), c in -720.0..720.0_f64, gamma in 0.0..180.0_f64) {
        let expanded = intensity.expanded();
        prop_assert_eq!(expanded.symmetry(), Symmetry::None);
        // Folding rounds C by some 1e-13 degrees; the steepest plane rises by the peak within 0.05/7 of 90°.
        let steep = 1e-12 * intensity.peak();
        let (a, b) = (intensity.candela(c, gamma), expanded.candela(c, gamma));
        prop_assert!((a - b).abs() <= steep, "{a} {b}");
        let (a, b) = (intensity.flux(), expanded.flux());
        prop_assert!((a - b).abs() <= FLUX * a, "{a} {b}");
        let written = parse_ies("a.ies", &PhotometricFile::new(expanded.clone(), "x").to_ies()).unwrap();
        prop_assert_eq!(written.intensity, expanded);
    }

    #[test]
    fn symmetry_holds(intensity in any_intensity(), c in 0.0..360.0_f64, gamma in 0.0..180.0_f64) {
        let about_c0 = matches!(intensity.symmetry(), Symmetry::Axial | Symmetry::Quadrant | Symmetry::AboutC0);
        let about_c90 = matches!(intensity.symmetry(), Symmetry::Axial | Symmetry::Quadrant | Symmetry::AboutC90);
        let (here, tolerance) = (intensity.candela(c, gamma), 1e-12 * intensity.peak());
        for (holds, mirror) in [(about_c0, -c), (about_c90, 180.0 - c)] {
            prop_assert!(!holds || (intensity.candela(mirror, gamma) - here).abs() <= tolerance);
        }
    }

    #[test]
    fn a_stated_flux_is_reached(intensity in any_intensity(), lumen in 1e-3..1e6_f64) {
        prop_assume!(intensity.flux() > 0.0);
        let scaled = intensity.with_flux(lumen).unwrap();
        prop_assert!((scaled.flux() - lumen).abs() <= FLUX * lumen);
    }
}
