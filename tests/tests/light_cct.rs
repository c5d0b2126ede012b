//! Correlated colour temperature against a brute-force search over the Planckian locus.
#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    clippy::cast_precision_loss,
    clippy::cast_possible_truncation,
    reason = "helpers of tests"
)]

use spectral_core::Real;
use spectral_core::cct::{CctStatus, DUV_LIMIT, LocusTable, PlanckianLocus, correlated_colour_temperature, xyz_to_uv};
use spectral_core::spectrum::RadiationConstant;
use spectral_core::summation::SumGrid;
use spectral_core::tables::observers::CIE_1931_2;

const GRID: SumGrid<81> = SumGrid::CIE_5NM;
const SECOND_RADIATION_CONSTANT: f64 = 1.4388e7;

/// `independent`: (u, v) of a black body from the formula, with the standard library's functions.
fn uv_of(mired: f64, observer: &[[f64; 3]; 81]) -> [f64; 2] {
    let mut xyz = [0.0; 3];
    for (i, cmf) in observer.iter().enumerate() {
        let wavelength = 380.0 + 5.0 * i as f64;
        let power = (wavelength / 500.0).powi(-5) / (SECOND_RADIATION_CONSTANT / wavelength * mired * 1e-6).exp_m1();
        for (sum, weight) in xyz.iter_mut().zip(cmf) {
            *sum += power * weight;
        }
    }
    xyz_to_uv(xyz)
}

fn square([u, v]: [f64; 2], [a, b]: [f64; 2]) -> f64 {
    (u - a).powi(2) + (v - b).powi(2)
}

/// The temperature of the nearest point of the locus: a dense scan from 10 to 2000 mired, then bisection on the slope of
/// the squared distance.
fn brute_force(uv: [f64; 2], scan: &[(f64, [f64; 2])], observer: &[[f64; 3]; 81]) -> f64 {
    let (nearest, _) =
        scan.iter().map(|(mired, point)| (*mired, square(uv, *point))).min_by(|a, b| a.1.total_cmp(&b.1)).unwrap();
    let slope = |mired: f64| square(uv, uv_of(mired + 1e-3, observer)) - square(uv, uv_of(mired - 1e-3, observer));
    let (mut low, mut high) = (nearest - 1.0, nearest + 1.0);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if slope(middle) < 0.0 { low = middle } else { high = middle }
    }
    2e6 / (low + high)
}

/// Points at the given temperature and Duv.
fn beside_locus(mired: f64, duv: f64, observer: &[[f64; 3]; 81]) -> [f64; 2] {
    let [a, b] = [uv_of(mired - 0.01, observer), uv_of(mired + 0.01, observer)];
    let (du, dv) = (b[0] - a[0], b[1] - a[1]);
    let length = du.hypot(dv);
    let [u, v] = uv_of(mired, observer);
    [u - dv / length * duv, v + du / length * duv]
}

fn mireds(count: u32) -> impl Iterator<Item = f64> {
    // Equidistant in 1/T from 25 000 K to 1000 K.
    (0..=count).map(move |k| 40.0 + 960.0 * f64::from(k) / f64::from(count))
}

#[test]
fn temperature_is_that_of_a_brute_force_search() {
    let observer = GRID.observer::<f64>(&CIE_1931_2);
    let locus = PlanckianLocus::new(GRID, &observer, RadiationConstant::Its1990);
    let table = LocusTable::new(&locus);
    let scan: Vec<_> = (0..=3980).map(|k| 10.0 + 0.5 * f64::from(k)).map(|m| (m, uv_of(m, &observer))).collect();
    let mut worst: f64 = 0.0;
    for mired in mireds(300) {
        for duv in [0.0, 1e-4, -1e-4, 0.005, -0.005, 0.02, -0.02, 0.0499, -0.0499] {
            let uv = beside_locus(mired, duv, &observer);
            let found = correlated_colour_temperature(uv, &table).unwrap();
            let expected = brute_force(uv, &scan, &observer);
            let error = (found.temperature - expected).abs();
            assert!(error <= 0.01, "{expected} K, Duv {duv}: {} K", found.temperature);
            let nearest = square(uv, uv_of(1e6 / expected, &observer)).sqrt();
            assert!((found.duv.abs() - nearest).abs() <= 1e-10, "{expected} K: Duv {}", found.duv);
            assert!(duv.abs() < 1e-3 || found.duv.signum() == duv.signum(), "{expected} K: Duv {}", found.duv);
            assert_eq!(found.status, CctStatus::Valid, "{expected} K, Duv {duv}");
            assert_eq!(correlated_colour_temperature(uv, &locus), Some(found), "table and locus differ");
            worst = worst.max(error);
        }
    }
    println!("largest error: {worst:e} K");
}

/// A chromaticity in `f32` is off by rounding of two sums of 81 terms at most; the temperature follows by the locus's slope.
#[test]
fn single_precision_is_off_by_its_rounding() {
    let (double, single) = (GRID.observer::<f64>(&CIE_1931_2), GRID.observer::<f32>(&CIE_1931_2));
    let exact = PlanckianLocus::new(GRID, &double, RadiationConstant::Its1990);
    let rounded = PlanckianLocus::new(GRID, &single, RadiationConstant::Its1990);
    let (exact, rounded) = (LocusTable::new(&exact), LocusTable::new(&rounded));
    for mired in mireds(200) {
        for duv in [0.0, 0.01, -0.01] {
            let uv = beside_locus(mired, duv, &double);
            let expected = correlated_colour_temperature(uv, &exact).unwrap();
            let found = correlated_colour_temperature(uv.map(|c| c as f32), &rounded).unwrap();
            let slope = square(uv_of(mired + 0.5, &double), uv_of(mired - 0.5, &double)).sqrt();
            let rounding = 81.0 * f64::from(f32::EPSILON) * 0.4;
            let tolerance = expected.temperature.powi(2) * 1e-6 * rounding / slope;
            let error = (f64::from(found.temperature) - expected.temperature).abs();
            assert!(error <= tolerance, "{} K: {error} > {tolerance}", expected.temperature);
            assert!((f64::from(found.duv) - expected.duv).abs() <= rounding);
        }
    }
}

#[test]
fn every_radiation_constant_gives_back_its_own_black_bodies() {
    let observer = GRID.observer::<f64>(&CIE_1931_2);
    for constant in
        [RadiationConstant::Cie1931, RadiationConstant::Ipts1948, RadiationConstant::Its1990, RadiationConstant::Si2019]
    {
        let locus = PlanckianLocus::new(GRID, &observer, constant);
        for temperature in [600.0, 1000.0, 2856.0, 6504.0, 25_000.0, 90_000.0] {
            let found = correlated_colour_temperature(locus.uv(temperature), &locus).unwrap();
            // Beyond 25 000 K by the error in 1/T: 2e-8 mired.
            let tolerance = 1e-3_f64.max(temperature * temperature * 2e-14);
            assert!((found.temperature - temperature).abs() <= tolerance, "{constant:?}: {found:?}");
            assert!(found.duv.abs() <= 1e-9);
        }
    }
}

fn status<R: Real>(uv: [f64; 2]) -> CctStatus {
    let observer = GRID.observer::<R>(&CIE_1931_2);
    let locus = PlanckianLocus::new(GRID, &observer, RadiationConstant::Its1990);
    correlated_colour_temperature(uv.map(R::from_f64), &locus).unwrap().status
}

#[test]
fn what_has_no_temperature_is_said_to_have_none() {
    let observer = GRID.observer::<f64>(&CIE_1931_2);
    for (uv, expected) in [
        (beside_locus(200.0, DUV_LIMIT * 1.01, &observer), CctStatus::FarFromLocus),
        (beside_locus(200.0, -DUV_LIMIT * 1.01, &observer), CctStatus::FarFromLocus),
        (beside_locus(200.0, DUV_LIMIT * 0.99, &observer), CctStatus::Valid),
        (uv_of(2100.0, &observer), CctStatus::BelowRange),
        ([0.6, 0.34], CctStatus::BelowRange),
        ([0.17, 0.22], CctStatus::AboveRange),
    ] {
        assert_eq!(status::<f64>(uv), expected, "{uv:?}");
        assert_eq!(status::<f32>(uv), expected, "{uv:?}");
    }
    let locus = PlanckianLocus::new(GRID, &observer, RadiationConstant::Its1990);
    for uv in [[f64::NAN, 0.3], [0.2, f64::INFINITY]] {
        assert_eq!(correlated_colour_temperature(uv, &locus), None);
    }
}
