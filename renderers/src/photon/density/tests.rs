//! Estimates from synthetic photons whose density is known.

use core::f32::consts::TAU;

use glam::DVec3;

use super::{Choice, Density, DensityError, Estimate, Place};
use crate::photon::Photon;
use crate::photon::extent::Extents;
use crate::photon::kernel::Kernel;
use crate::photon::map::PhotonMap;
use crate::photon::random::Random;
use crate::scene::{Geometry, Mesh};

fn photon(position: [f32; 3], flux: f32) -> Photon {
    Photon { position, direction: [0.0, 0.0, 1.0], flux, spectrum: 0, surface: 0 }
}

/// The square [−1, 1]² at z = 0.
pub(in crate::photon) fn square() -> Extents {
    let [center, half_u, half_v, normal] = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
    Extents::new([&Geometry::Rectangle { center, half_u, half_v, normal }])
}

/// Photons on the square, of which `thrown` were thrown at it: their irradiance is `density` (at most `most`).
pub(in crate::photon) fn on_square(thrown: u32, most: f32, seed: u64, density: impl Fn(f32, f32) -> f32) -> PhotonMap {
    let mut random = Random::new(seed);
    #[allow(clippy::cast_precision_loss, reason = "test sizes are small")]
    let flux = 4.0 * most / thrown as f32;
    let mut thrown = (0..thrown).map(|_| [random.next() * 2.0 - 1.0, random.next() * 2.0 - 1.0, random.next()]);
    let hits = thrown.by_ref().filter(|[x, y, z]| z * most < density(*x, *y));
    PhotonMap::new(hits.map(|[x, y, _]| photon([x, y, 0.0], flux)).collect())
}

pub(in crate::photon) fn place(extents: &Extents, x: f32, y: f32) -> Place<'_> {
    Place { position: [x, y, 0.0], normal: [0.0, 0.0, 1.0], surface: 0, face: extents.face(0, 0) }
}

fn by_count(count: usize, radius: f32) -> Density {
    Density { count, radius, choice: Choice::Count, ..Density::default() }
}

fn estimate(density: &Density, map: &PhotonMap, place: &Place<'_>) -> Estimate {
    let mut estimate = Estimate::default();
    density.estimate(map, place, |photon| photon.flux, &mut estimate);
    let sum: f64 =
        estimate.photons().map(|(i, weight)| f64::from(weight) * f64::from(map.photons()[i as usize].flux)).sum();
    assert!((sum - estimate.value).abs() <= 1e-12 * sum.abs());
    estimate
}

/// Mean of values, its standard error, and the standard deviation of a value.
#[allow(clippy::cast_precision_loss, reason = "test sizes are small")]
pub(in crate::photon) fn statistics(values: &[f64]) -> [f64; 3] {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let variance = values.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / (n - 1.0);
    [mean, (variance / n).sqrt(), variance.sqrt()]
}

/// The seeds are fixed: an unbiased estimate fails once in 70 000 choices of them.
fn assert_unbiased(values: &[f64], truth: f64, what: &str) {
    let [mean, error, _] = statistics(values);
    assert!((mean - truth).abs() <= 4.3 * error, "{what}: {mean} ± {error}, not {truth}");
}

#[test]
fn uniform_irradiance_is_unbiased_everywhere_and_its_error_known() {
    let extents = square();
    let maps: Vec<_> = (0..600).map(|seed| on_square(4000, 1.0, seed, |_, _| 1.0)).collect();
    // The last radius holds 20 photons on average: now the number ends the search, now the radius does.
    for (kernel, radius) in Kernel::ALL.into_iter().map(|k| (k, f32::INFINITY)).chain([(Kernel::Epanechnikov, 0.08)]) {
        for (x, y) in [(0.1, 0.2), (0.97, 0.0), (-1.0, 0.3), (0.99, -0.98), (1.0, 1.0)] {
            let density = Density { kernel, ..by_count(20, radius) };
            let estimates: Vec<_> = maps.iter().map(|map| estimate(&density, map, &place(&extents, x, y))).collect();
            let values: Vec<_> = estimates.iter().map(|e| e.value).collect();
            assert_unbiased(&values, 1.0, &format!("{kernel:?} {radius} at {x} {y}"));
            let [_, _, deviation] = statistics(&values);
            let stated = statistics(&estimates.iter().map(|e| e.standard_error.powi(2)).collect::<Vec<_>>())[0].sqrt();
            // Both come from 600 values whose relative deviation is some 0.3; in corners, the photons' own radius scatters as well.
            assert!((0.85..=1.2).contains(&(stated / deviation)), "{kernel:?} at {x} {y}: {stated} {deviation}");
        }
    }
}

#[test]
fn uniform_irradiance_is_unbiased_on_disks_and_spheres() {
    let shapes = [
        Geometry::Disk { center: DVec3::ZERO, radius: 1.0, normal: DVec3::Z },
        Geometry::Sphere { center: DVec3::ZERO, radius: 1.0, inward: false, axis: DVec3::Z },
    ];
    let extents = Extents::new(&shapes);
    for (shape, area) in [(0, core::f32::consts::PI), (1, 2.0 * TAU)] {
        let map = |seed| {
            let mut random = Random::new(seed);
            let mut throw = || {
                let (u, angle) = (random.next(), random.next() * TAU);
                let (height, radius) =
                    if shape == 0 { (0.0, u.sqrt()) } else { (2.0 * u - 1.0, 2.0 * (u * (1.0 - u)).sqrt()) };
                let position = [radius * angle.cos(), radius * angle.sin(), height];
                let direction = if shape == 0 { [0.0, 0.0, 1.0] } else { position };
                Photon { direction, surface: 2 * shape, ..photon(position, area / 2000.0) }
            };
            PhotonMap::new((0..2000).map(|_| throw()).collect())
        };
        let position = if shape == 0 { [0.0, 0.99, 0.0] } else { [0.0, 0.6, 0.8] };
        let normal = if shape == 0 { [0.0, 0.0, 1.0] } else { position };
        let place = Place { position, normal, surface: 2 * shape, face: extents.face(shape, 0) };
        let values: Vec<_> = (0..600).map(|seed| estimate(&by_count(30, 1.0), &map(seed), &place).value).collect();
        assert_unbiased(&values, 1.0, &format!("shape {shape}"));
    }
}

#[test]
fn a_gradient_makes_no_bias_and_a_bump_that_of_its_laplacian() {
    let extents = square();
    let radius = 0.2;
    let fixed = by_count(usize::MAX, radius);
    let at_middle = |maps: &[PhotonMap]| -> Vec<_> {
        maps.iter().map(|map| estimate(&fixed, map, &place(&extents, 0.0, 0.0)).value).collect()
    };
    let maps: Vec<_> = (0..400).map(|seed| on_square(6000, 2.0, seed, |x, _| 1.0 + x)).collect();
    assert_unbiased(&at_middle(&maps), 1.0, "gradient");
    // The Laplacian of 1 − x² − y² is −4, that times r² and a quarter of the second moment of the kernel the bias.
    let maps: Vec<_> = (0..400).map(|seed| on_square(6000, 1.0, seed, |x, y| 1.0 - x * x - y * y)).collect();
    let bias = -f64::from(radius * radius) * Kernel::Epanechnikov.second_moment();
    assert_unbiased(&at_middle(&maps), 1.0 + bias, "bump");
}

#[test]
fn bias_of_a_bump_is_stated() {
    let extents = square();
    let peak = |x: f32, y: f32| (-(x * x + y * y) / 0.02).exp();
    let density = by_count(usize::MAX, 0.15);
    let [mut stated, mut values] = [Vec::new(), Vec::new()];
    for seed in 0..100 {
        let estimate = estimate(&density, &on_square(200_000, 1.0, seed, peak), &place(&extents, 0.0, 0.0));
        stated.push(estimate.bias);
        values.push(estimate.value);
    }
    let bias = statistics(&values)[0] - 1.0;
    // Extrapolation from two radii finds most of it: the next power of the radius counts as well here.
    assert!(bias <= -0.25, "{bias}");
    let ratio = statistics(&stated)[0] / bias;
    assert!((0.6..=1.0).contains(&ratio), "{bias} {ratio}");
}

/// Root of the mean square error, and the mean radius, over places along x and seeds.
fn profile(density: &Density, from: f32, to: f32, most: f32, truth: impl Fn(f32, f32) -> f32) -> [f64; 2] {
    let extents = square();
    let [mut squares, mut radii] = [Vec::new(), Vec::new()];
    for seed in 0..8 {
        let map = on_square(40_000, most, seed, &truth);
        for i in 0..100 {
            #[allow(clippy::cast_precision_loss, reason = "test sizes are small")]
            let x = from + (to - from) * (i as f32 + 0.5) / 100.0;
            let estimate = estimate(density, &map, &place(&extents, x, 0.01));
            squares.push((estimate.value - f64::from(truth(x, 0.01))).powi(2));
            radii.push(f64::from(estimate.radius));
        }
    }
    [statistics(&squares)[0].sqrt(), statistics(&radii)[0]]
}

#[test]
fn radii_shrink_at_a_step_and_stay_elsewhere() {
    let step = |x: f32, _: f32| if x < 0.0 { 1.0 } else { 0.0 };
    let (fixed, adaptive) = (by_count(800, 0.5), Density { count: 800, radius: 0.5, ..Density::default() });
    let [error, radius] = profile(&fixed, -0.1, 0.1, 1.0, step);
    let [adapted_error, adapted_radius] = profile(&adaptive, -0.1, 0.1, 1.0, step);
    assert!(adapted_radius <= 0.85 * radius, "{adapted_radius} {radius}");
    assert!(adapted_error <= 0.8 * error, "{adapted_error} {error}");
    let [error, radius] = profile(&fixed, -0.8, -0.3, 1.0, step);
    let [adapted_error, adapted_radius] = profile(&adaptive, -0.8, -0.3, 1.0, step);
    assert!(adapted_radius >= 0.97 * radius, "{adapted_radius} {radius}");
    assert!(adapted_error <= 1.1 * error, "{adapted_error} {error}");
}

#[test]
fn radii_shrink_at_a_fold() {
    // The square root's singularity of a fold caustic, cut off at twice the spread that a light of some width gives it.
    let fold = |x: f32, _: f32| if x < 0.0 { 0.2 } else { 0.2 + 0.3 / x.max(4e-3).sqrt() };
    let [error, radius] = profile(&by_count(400, 0.5), -0.2, 0.4, 5.0, fold);
    let adaptive = Density { count: 400, radius: 0.5, ..Density::default() };
    let [adapted_error, adapted_radius] = profile(&adaptive, -0.2, 0.4, 5.0, fold);
    assert!(adapted_radius <= 0.9 * radius && adapted_error <= 0.85 * error, "{adapted_error} {error}");
}

#[test]
fn adapting_biases_uniform_irradiance_by_a_hundredth_at_most() {
    let extents = square();
    let adaptive = Density { count: 200, radius: 0.5, ..Density::default() };
    let value = |seed| estimate(&adaptive, &on_square(4000, 1.0, seed, |_, _| 1.0), &place(&extents, 0.1, 0.2)).value;
    let [mean, error, deviation] = statistics(&(0..600).map(value).collect::<Vec<_>>());
    assert!((mean - 1.0).abs() <= 0.01 + 3.0 * error, "{mean} ± {error}");
    // Without adapting it is the root of 4/3 over 200.
    assert!(deviation <= 1.1 * (4.0_f64 / 600.0).sqrt(), "{deviation}");
}

#[test]
fn estimates_converge_at_the_rate_of_theory() {
    // With n photons and the n^⅔ nearest, variance goes with n^−⅔ and so does the square of the bias.
    let bump = |x: f32, y: f32| 0.2 + 0.8 * (-(x * x + y * y) / 0.08).exp();
    let extents = square();
    let error = |thrown: u32| {
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a positive number")]
        let count = (0.3 * f64::from(thrown).powf(2.0 / 3.0)) as usize;
        let density = by_count(count, f32::INFINITY);
        let mut squares = Vec::new();
        for seed in 0..20 {
            let map = on_square(thrown, 1.0, seed, bump);
            for (x, y) in [(0.0, 0.0), (0.2, 0.1), (-0.3, 0.2), (0.0, 0.5), (-0.6, -0.6), (0.9, 0.1)] {
                squares.push((estimate(&density, &map, &place(&extents, x, y)).value - f64::from(bump(x, y))).powi(2));
            }
        }
        statistics(&squares)[0].sqrt()
    };
    let slope = (error(128_000) / error(2000)).ln() / 64.0_f64.ln();
    // The scatter of a mean of 120 squares makes ± 0.02.
    assert!((slope + 1.0 / 3.0).abs() <= 0.06, "{slope}");
}

#[test]
fn photons_around_a_corner_do_not_count() {
    // Two walls of one mesh that meet at a right angle, the second with photons that are ten times as bright.
    let positions = [[0., 0., 0.], [1., 0., 0.], [1., 1., 0.], [0., 1., 0.], [0., 0., 1.], [0., 1., 1.]];
    let positions = positions.map(DVec3::from_array).to_vec();
    let triangles = vec![[0, 1, 2], [0, 2, 3], [0, 3, 5], [0, 5, 4]];
    let extents = Extents::new([&Geometry::Mesh(Mesh { positions, normals: None, triangles })]);
    let map = |seed| {
        let mut random = Random::new(seed);
        let photons = (0..4000).map(|i| {
            let [u, v] = [random.next(), random.next()];
            if i % 2 == 0 { photon([u, v, 0.0], 1.0 / 2000.0) } else { photon([0.0, v, u], 10.0 / 2000.0) }
        });
        PhotonMap::new(photons.collect())
    };
    let place = Place { position: [0.01, 0.4, 0.0], normal: [0.0, 0.0, 1.0], surface: 0, face: extents.face(0, 1) };
    let values: Vec<_> = (0..400).map(|seed| estimate(&by_count(40, 1.0), &map(seed), &place).value).collect();
    assert_unbiased(&values, 1.0, "corner");
}

#[test]
fn few_photons_and_dark_ones_are_no_trouble() {
    let extents = square();
    let middle = place(&extents, 0.0, 0.0);
    for density in [by_count(50, 0.3), Density::default(), Density { radius: 0.3, ..Density::default() }] {
        let none = estimate(&density, &PhotonMap::default(), &middle);
        assert_eq!((none.value, none.standard_error, none.bias, none.radius), (0.0, 0.0, 0.0, 0.0));
        assert_eq!((none.photons().count(), none.relative_error()), (0, 0.0));
        let dark = estimate(&density, &on_square(3000, 1.0, 1, |_, _| 1.0), &middle);
        let mut dark_again = dark.clone();
        density.estimate(&on_square(3000, 1.0, 1, |_, _| 1.0), &middle, |_| 0.0, &mut dark_again);
        assert_eq!((dark_again.value, dark_again.standard_error, dark_again.bias), (0.0, 0.0, 0.0));
        assert!(dark.value > 0.5 && dark_again.radius >= dark.radius);
    }
    let one = PhotonMap::new(vec![photon([0.1, 0.0, 0.0], 3.0)]);
    let alone = estimate(&by_count(50, 0.3), &one, &middle);
    let t2 = 0.01_f64 / 0.09;
    let expected = 3.0 * 2.0 / core::f64::consts::PI * (1.0 - t2) / 0.09;
    assert!((alone.value - expected).abs() <= 1e-6 * expected && (alone.relative_error() - 1.0).abs() <= 1e-12);
    // With no limit to the radius, the only photon defines it and doesn't count.
    assert_eq!(estimate(&by_count(50, f32::INFINITY), &one, &middle).value, 0.0);
}

#[test]
fn photons_in_one_point_are_spread_over_the_smallest_radius() {
    let extents = square();
    let map = PhotonMap::new(vec![photon([0.5, 0.25, 0.0], 2.0); 300]);
    for choice in [Choice::Count, Choice::Agreement(3.0)] {
        let density = Density { choice, radius: 0.1, ..Density::default() };
        let estimate = estimate(&density, &map, &place(&extents, 0.5, 0.25));
        // 1e-6 of the largest coordinate.
        let expected = 600.0 * 2.0 / core::f64::consts::PI / (5e-7 * 5e-7);
        assert!((estimate.value / expected - 1.0).abs() <= 1e-5, "{} {expected}", estimate.value);
        assert_eq!(estimate.photons().count(), 300);
    }
}

#[test]
fn scale_makes_no_difference() {
    let unit = estimate(&Density::default(), &on_square(3000, 1.0, 5, |_, _| 1.0), &place(&square(), 0.9, 0.2));
    for scale in [1e-12_f32, 1e-3, 1e11] {
        let mut photons = on_square(3000, 1.0, 5, |_, _| 1.0).photons().to_vec();
        photons.iter_mut().for_each(|photon| photon.position = photon.position.map(|x| x * scale));
        let [half_u, half_v] = [DVec3::X * f64::from(scale), DVec3::Y * f64::from(scale)];
        let extents = Extents::new([&Geometry::Rectangle { center: DVec3::ZERO, half_u, half_v, normal: DVec3::Z }]);
        let place = place(&extents, 0.9 * scale, 0.2 * scale);
        let scaled = estimate(&Density::default(), &PhotonMap::new(photons), &place);
        let ratio = scaled.value * f64::from(scale).powi(2) / unit.value;
        assert!((ratio - 1.0).abs() <= 1e-5, "{scale}: {ratio}");
    }
    // Coordinates that are hardly numbers any more: everything is within the smallest radius, and finite.
    let tiny: Vec<_> = (0..100).map(|i| photon([f32::from_bits(i), 0.0, 0.0], 1e-30)).collect();
    let estimate = estimate(&Density::default(), &PhotonMap::new(tiny), &place(&square(), 0.0, 0.0));
    assert!(estimate.value > 0.0 && estimate.value.is_finite() && estimate.photons().count() == 100);
}

#[test]
fn settings_outside_their_domains_are_refused() {
    assert_eq!(Density::default().check(), Ok(()));
    let with = |change: fn(&mut Density)| {
        let mut density = Density::default();
        change(&mut density);
        density.check()
    };
    assert_eq!(with(|d| d.count = 1), Err(DensityError::Count(1)));
    assert_eq!(with(|d| d.radius = 0.0), Err(DensityError::Radius(0.0)));
    assert!(matches!(with(|d| d.radius = f32::NAN), Err(DensityError::Radius(x)) if x.is_nan()));
    assert_eq!(with(|d| d.choice = Choice::Agreement(f32::INFINITY)), Err(DensityError::Agreement(f32::INFINITY)));
    assert_eq!(with(|d| d.choice = Choice::Agreement(0.0)), Err(DensityError::Agreement(0.0)));
    let line = DensityError::Count(1).to_string();
    assert_eq!(line, "density is estimated from 2 photons or more, not 1");
}
