//! Estimates of photons that count within radii of their own, and of those that move.

use super::{Footprint, Footprints, evened};
use crate::photon::density::region_of;
use crate::photon::density::tests::{on_square, place, square, statistics};
use crate::photon::extent::Extents;
use crate::photon::kernel::Kernel;
use crate::photon::map::{LEAF, Region};
use crate::photon::motion::Motion;
use crate::photon::random::Random;
use crate::photon::ways::About;
use crate::photon::{Choice, Density, Estimate, Photon, PhotonMap};

/// With the radius of each leaf as about the photon in its middle.
fn footprints(density: &Density, map: &PhotonMap, extents: &Extents) -> Footprints {
    let mut scratch = Estimate::default();
    let radius = |numbers| {
        let (number, photon) = map.middle_of(numbers).unwrap();
        let place = place(extents, photon.position[0], photon.position[1]);
        density.footprint(map, (&place, number), |photon| photon.flux, &mut scratch)
    };
    let radii: Vec<Footprint> = map.leaves_photons().map(radius).collect();
    Footprints::new(map, evened(map, &radii), None)
}

/// Where photons are evenly dense, estimates are right on average, however radii are chosen and also beside the end of the face; so is what they say
/// of their error.
#[test]
fn uniform_irradiance_is_unbiased() {
    let extents = square();
    for (choice, count) in [(Choice::Count, 30), (Choice::Agreement(2.5), 50), (Choice::Agreement(2.5), 200)] {
        let density = Density { choice, count, ..Density::default() };
        for (x, y) in [(0.1, -0.2), (0.995, 0.3), (0.93, -0.93)] {
            let place = place(&extents, x, y);
            let (mut values, mut errors) = (Vec::new(), 0.0);
            for seed in 0..200 {
                let map = on_square(4000, 1.0, seed, |_, _| 1.0);
                let footprints = footprints(&density, &map, &extents);
                let mut found = Estimate::default();
                density.estimate_by(
                    (&map, &footprints),
                    (&place, &region_of(&place, 0.0)),
                    |photon| photon.flux,
                    &mut found,
                );
                values.push(found.value);
                errors += found.standard_error * found.standard_error / 200.0;
            }
            let [mean, error, scatter] = statistics(&values);
            // Beside an edge the mean of radii stands for all.
            let tolerance = if x > 0.9 { 0.01 } else { 0.0 };
            assert!((mean - 1.0).abs() <= 4.3 * error + tolerance, "{choice:?} {count} {x} {y}: {mean} ± {error}");
            assert!((0.7..=1.4).contains(&(errors.sqrt() / scatter)), "{choice:?} {x}: {} {scatter}", errors.sqrt());
        }
    }
}

/// A lit band on a dark square: all of its light is there, and none more, though radii at its edge are larger than what is left of it.
#[test]
fn all_light_is_there_once_beside_edges() {
    let extents = square();
    for choice in [Choice::Count, Choice::Agreement(2.5)] {
        let density = Density { choice, ..Density::default() };
        let (mut fluxes, mut truths) = (Vec::new(), Vec::new());
        for seed in 0..24 {
            let map = on_square(20_000, 1.0, seed, |x, y| f32::from(u8::from(x.abs() <= 0.1 && y.abs() <= 0.8)));
            let footprints = footprints(&density, &map, &extents);
            let mut found = Estimate::default();
            let mut sum = 0.0;
            for i in 0_u8..100 {
                for j in 0_u8..100 {
                    let [x, y] = [i, j].map(|k| (f32::from(k) + 0.5) / 50.0 - 1.0);
                    let place = place(&extents, x, y);
                    density.estimate_by(
                        (&map, &footprints),
                        (&place, &region_of(&place, 0.0)),
                        |photon| photon.flux,
                        &mut found,
                    );
                    sum += found.value / 2500.0;
                }
            }
            fluxes.push(sum);
            truths.push(map.photons().iter().map(|photon| f64::from(photon.flux)).sum::<f64>());
        }
        let ratios: Vec<f64> = fluxes.iter().zip(&truths).map(|(a, b)| a / b - 1.0).collect();
        let [mean, error, _] = statistics(&ratios);
        assert!(mean.abs() <= 4.3 * error && error <= 2e-3, "{choice:?}: {mean} ± {error}");
    }
}

/// Radii are the geometric mean of those of the photons within reach, those that don't count left out; what is nearer has no say beyond that.
#[test]
#[allow(clippy::cast_precision_loss, reason = "few photons")]
fn radii_are_evened_out_within_their_reach() {
    const RADII: [f32; 3] = [0.0, 10.0, 1e-3];
    let map = on_square(2000, 1.0, 3, |_, _| 1.0);
    let radii: Vec<Footprint> =
        (0..map.leaves_photons().count()).map(|leaf| Footprint { radius: RADII[leaf % 3], bias: 0.5 }).collect();
    let evened = evened(&map, &radii);
    let photons = |of: usize| {
        map.leaves_photons()
            .enumerate()
            .filter(|(leaf, _)| leaf % 3 == of)
            .map(|(_, photons)| photons.len())
            .sum::<usize>()
    };
    let [far, near] = [photons(1) as f32, photons(2) as f32];
    let mean = ((far * RADII[1].ln() + near * RADII[2].ln()) / (far + near)).exp();
    assert!(far > 500.0 && near > 500.0);
    for (leaf, (own, before)) in evened.iter().zip(&radii).enumerate() {
        match leaf % 3 {
            1 => {
                assert!((own.radius / mean - 1.0).abs() <= 1e-4, "{leaf}: {} {mean}", own.radius);
                let bias = 0.5 * (mean / 10.0).powi(2);
                assert!((own.bias / bias - 1.0).abs() <= 1e-3, "{leaf}: {} {bias}", own.bias);
            }
            // About itself alone, and not at all.
            _ => assert!((own.radius - before.radius).abs() <= 1e-5 * before.radius, "{leaf}: {own:?}"),
        }
    }
}

/// Light of photons that move is at each wavelength that of photons that are where these are then, by all kernels; no leaf is forgotten. Some are fast,
/// and there for a short while only; on one surface all are in its plane, on others they leave it.
#[test]
#[allow(clippy::cast_precision_loss, clippy::cast_possible_truncation, reason = "few nodes, and as the kernel has it")]
fn photons_that_move_are_where_they_are_at_each_wavelength() {
    const RADII: [f32; 4] = [0.02, 0.1, 0.0, 0.4];
    let mut random = Random::new(5);
    let mut next = |size: f32| [0; 2].map(|_| size * (random.next() * 2.0 - 1.0));
    let (mut photons, mut motions) = (Vec::new(), Vec::new());
    for number in 0..3000_u32 {
        let ([x, y], size) = (next(1.0), [0.0, 1e-20, 0.01, 0.3, 60.0][number as usize % 5]);
        let ([u, v], [change, _]) = (next(size), next(0.5));
        let [z, w] =
            if number % 3 == 2 { [0.0; 2] } else { [[0.0; 2], [0.02, 0.05], [0.2, 0.0]][number as usize / 3 % 3] };
        photons.push(Photon { position: [x, y, z], flux: 1.0, surface: number % 3, ..Photon::default() });
        let limits = if size > 1.0 { [0.875, 1.0] } else { [[0.0, 1.0], [0.25, 0.5]][number as usize % 2] };
        motions.push(Motion { position: [u, v, w], flux: change, at: 0.9, limits });
    }
    let map = PhotonMap::new(photons);
    let in_order: Vec<Motion> = map.origins().iter().map(|origin| motions[*origin as usize]).collect();
    let radii = (0..map.leaves_photons().count()).map(|leaf| Footprint { radius: RADII[leaf % 4], bias: 0.0 });
    let footprints = Footprints::new(&map, radii.collect(), Some((&in_order, 4)));
    let (mut compared, mut high, mut too_high) = (0, 0, 0);
    for number in 0..60_u32 {
        let [x, y] = next(1.2);
        let (least, kernel) = ([0.0, 0.05][number as usize % 2], Kernel::ALL[number as usize % 5]);
        let [thickness, slope] = [[1e-6, 0.0], [0.03, 0.0], [1e-6, 0.35]][number as usize / 3 % 3];
        let region = Region { normal: [0.0, 0.0, 1.0], thickness, slope, ..Region::ball([x, y, 0.0], least) };
        let (mut found, mut table) = (vec![Vec::new(); map.len()], Vec::new());
        footprints.passing(&map, number % 3, &region, |ways, first, footprint| {
            table.clear();
            // All that is asked for, or some.
            let nodes = [[0, ways.steps + 1], [ways.steps / 4, ways.steps / 2 + 1]][number as usize / 2 % 2];
            let start = ways.light(About { region: &region, radius: footprint.radius, kernel }, nodes, &mut table);
            assert!(ways.steps >= 4 && table.len() <= usize::from(ways.steps) + 1);
            // All ways of a leaf end at ends of its steps: so nothing is lost between these.
            let own = (first as usize..).take(LEAF).zip(map.photons().iter().skip(first as usize));
            for (lane, (photon, _)) in own.filter(|(_, photon)| photon.surface == number % 3).enumerate() {
                let limits = in_order[photon].limits.map(|limit| limit * f32::from(ways.steps));
                assert!(limits.iter().all(|limit| limit.fract() == 0.0), "{}", ways.steps);
                assert_eq!(f32::from(ways.first(lane)), limits[0]);
                let mut lights = vec![f64::NAN; usize::from(ways.steps) + 1];
                for node in nodes[0]..nodes[1] {
                    let row = node.checked_sub(ways.first(lane)).and_then(|since| since.checked_sub(start));
                    let row = row.and_then(|row| table.get(usize::from(row)));
                    lights[usize::from(node)] = row.map_or(0.0, |row| f64::from(row[lane]));
                }
                found[photon] = lights;
            }
        });
        for (leaf, numbers) in map.leaves_photons().enumerate() {
            for photon in numbers {
                let (own, motion, light) = (&map.photons()[photon], &in_order[photon], &found[photon]);
                let radius = f64::from(if RADII[leaf % 4] > 0.0 { RADII[leaf % 4].max(least) } else { 0.0 });
                let is_looked_at = own.surface == number % 3 && radius > 0.0;
                // Where a leaf wasn't looked at, none of it may count.
                let nodes = if light.is_empty() { 129 } else { light.len() };
                for node in 0..nodes {
                    let at = node as f64 / (nodes - 1) as f64;
                    let [from, to] = motion.limits.map(f64::from);
                    let (is_first, is_last) = (from <= 0.0 && at == 0.0, to >= 1.0 && at == 1.0);
                    let present = match at {
                        _ if is_first || is_last => 1.0,
                        at if at == from || at == to => 0.5,
                        at => f64::from(u8::from(at > from && at < to)),
                    };
                    let moved = |i: usize| f64::from(own.position[i]) + (at - 0.9) * f64::from(motion.position[i]);
                    let height2 = moved(2).powi(2);
                    let distance2 = (moved(0) - f64::from(x)).powi(2) + (moved(1) - f64::from(y)).powi(2) + height2;
                    let highest2 = f64::from(thickness).powi(2) + f64::from(slope).powi(2) * distance2;
                    let t2 = distance2 / (radius * radius);
                    let value = f64::from(kernel.value(t2 as f32)) / (radius * radius);
                    let flux = (f64::from(own.flux) + (at - 0.9) * f64::from(motion.flux)) * present;
                    let truth = if is_looked_at && t2 < 1.0 && height2 <= highest2 { flux * value } else { 0.0 };
                    let light = light.get(node).copied().unwrap_or(0.0);
                    if light.is_nan() {
                        continue;
                    }
                    // A ten thousandth of the way across, of a place that is known to some 1e-6.
                    let tolerance = if radius > 0.0 { 1e-3 / (radius * radius) } else { 0.0 };
                    let is_rim = (t2 - 1.0).abs() <= 1e-3 || (height2 - highest2).abs() <= 1e-3 * highest2.max(1e-6);
                    assert!((light - truth).abs() <= tolerance || is_rim, "{number} {photon} {at}: {light} {truth}");
                    compared += u32::from(truth > 0.0);
                    high += u32::from(height2 > 1e-6 && truth > 0.0);
                    too_high += u32::from(height2 > highest2 && t2 < 1.0 && is_looked_at);
                }
            }
        }
    }
    assert!(compared > 20_000 && high > 1000 && too_high > 1000, "{compared} {high} {too_high}");
}
