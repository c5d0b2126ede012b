//! How photons move with the wavelength, from where they were thrown at one.

use core::f64::consts::{PI, TAU};
use std::collections::HashMap;

use glam::DVec3;

use super::paths::room;
use super::{Stage, emit, glass, point, settings, surroundings};
use crate::photon::waves::Waves;
use crate::photon::{Bundle, Density, Drifting, Emission, Maps, Rethrow, Scattered, lines};
use crate::scene::Mesh;
use crate::spectral::{place_of, wavelength_at};

/// How far derivatives may be off, of nineteen in twenty photons and of half of them: relative to themselves, and to what all have on average.
const MOST_OFF: [f64; 2] = [0.005, 0.0005];

/// How many standard errors two estimates may differ by: more by chance once in 10⁵ comparisons.
const MOST_ERRORS: f64 = 4.5;

/// A unit sphere of many triangles, with its normals.
fn ball(rings: u32) -> Mesh {
    let sectors = 2 * rings;
    let place = |ring: u32, sector: u32| {
        let (polar, azimuth) = (PI * f64::from(ring) / f64::from(rings), TAU * f64::from(sector) / f64::from(sectors));
        DVec3::new(polar.sin() * azimuth.cos(), polar.sin() * azimuth.sin(), polar.cos())
    };
    let positions: Vec<_> = (0..=rings).flat_map(|ring| (0..sectors).map(move |sector| place(ring, sector))).collect();
    let mut triangles = Vec::new();
    for (ring, sector) in (0..rings).flat_map(|ring| (0..sectors).map(move |sector| (ring, sector))) {
        let number = |ring: u32, sector: u32| ring * sectors + sector % sectors;
        let [a, b] = [number(ring, sector), number(ring, sector + 1)];
        let [c, d] = [number(ring + 1, sector), number(ring + 1, sector + 1)];
        // At the poles all of a ring are one point.
        triangles.extend([[a, c, d]].into_iter().filter(|_| ring + 1 < rings));
        triangles.extend([[a, d, b]].into_iter().filter(|_| ring > 0));
    }
    Mesh { normals: Some(positions.clone()), positions, triangles }
}

type Landed = HashMap<(u32, u32), Scattered>;

fn by_branch(photons: Vec<Scattered>) -> Landed {
    photons.into_iter().map(|s| ((s.path, s.branch), s)).collect()
}

/// Derivatives of photons that are on the same surface at wavelengths on both sides, with those by differences; of how many photons.
fn derivatives(emission: &Emission<'_>) -> (Vec<[DVec3; 2]>, Vec<[f64; 2]>, usize) {
    const WIDTH: f64 = 0.005;
    let mut emitted = emit(emission, 20_000, 0);
    let (mut ways, mut fluxes, mut all) = (Vec::new(), Vec::new(), 0);
    for place in [0.2, 0.5, 0.8] {
        let mut throw = |place: f64| {
            let wavelength = wavelength_at(place);
            by_branch(emission.throw(&emitted.prefixes, |_| wavelength, &mut emitted.spectra).photons())
        };
        let [before, after] = [place - WIDTH, place + WIDTH].map(&mut throw);
        let own = emission.throw_drifting(&emitted.prefixes, |_| wavelength_at(place), &mut emitted.spectra).photons();
        for Drifting { scattered, line } in own {
            assert!((f64::from(line.at) - place).abs() <= 1e-6);
            all += 1;
            let key = (scattered.path, scattered.branch);
            let (Some(before), Some(after)) = (before.get(&key), after.get(&key)) else { continue };
            let [from, to] = [before, after].map(|s| s.photon);
            if from.surface != scattered.photon.surface || to.surface != from.surface {
                continue;
            }
            let [a, b] = [from.position, to.position].map(|p| DVec3::from_array(p.map(f64::from)));
            ways.push([DVec3::from_array(line.position.map(f64::from)), (b - a) / (2.0 * WIDTH)]);
            let flux = f64::from(scattered.photon.flux);
            fluxes.push([line.flux.into(), f64::from(to.flux) - f64::from(from.flux)].map(|change: f64| change / flux));
            fluxes.last_mut().into_iter().for_each(|[_, change]| *change /= 2.0 * WIDTH);
        }
    }
    (ways, fluxes, all)
}

/// What so large a share of numbers doesn't exceed.
fn quantile(numbers: &mut [f64], share: f64) -> f64 {
    numbers.sort_by(f64::total_cmp);
    #[allow(clippy::cast_precision_loss, clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a place")]
    let place = (share * numbers.len() as f64) as usize;
    numbers[place]
}

#[allow(clippy::cast_precision_loss, reason = "counts")]
fn mean(numbers: impl ExactSizeIterator<Item = f64>) -> f64 {
    let count = numbers.len() as f64;
    numbers.sum::<f64>() / count
}

/// Derivatives are differences of paths thrown at neighbouring wavelengths: through spheres, meshes with interpolated normals, plates and prisms, off mirrors
/// among them, and through glass that absorbs.
#[test]
fn derivatives_are_differences() {
    let absorbing = r#"<spectrum name="absorption" value="0.5"/>"#;
    let coloured = r#"<spectrum name="absorption" value="380:0.1, 780:0.2"/>"#;
    let smooth =
        format!(r#"<shape type="cube">{}</shape>{}{}"#, glass("SF10", ""), surroundings(4.0), point("2, 1, 3"));
    let stages = [
        ("room", room("SF11", absorbing), true),
        ("coloured", room("SF11", coloured), true),
        ("box", Stage::built_in("cornell-box-spheres"), true),
        ("prism", Stage::built_in("prism"), true),
        // What shading normals do to fluxes isn't followed.
        ("mesh", Stage::with_mesh(&smooth, ball(24)), false),
    ];
    for (name, stage, has_fluxes) in stages {
        // Chances are those of the own wavelength: here all ways are followed.
        let emission = stage.emission(settings(3, 6, 0.0));
        let (ways, fluxes, all) = derivatives(&emission);
        assert!(ways.len() > 5000 && ways.len() * 10 > all * 9, "{name}: {} of {all}", ways.len());
        // Those are left that stay where they are, as too little is known: most of them reflected several times in a prism of flint.
        let known: Vec<_> =
            ways.iter().zip(&fluxes).filter(|([own, _], [by, _])| *own != DVec3::ZERO || *by != 0.0).collect();
        assert!(known.len() * 2 > ways.len(), "{name}: {} of {}", known.len(), ways.len());
        let usual = mean(known.iter().map(|([_, expected], _)| expected.length()));
        let mut off: Vec<f64> = known
            .iter()
            .map(|([own, expected], _)| (*own - *expected).length() / (expected.length() + usual))
            .collect();
        let [most, half] = [0.95, 0.5].map(|share| quantile(&mut off, share));
        assert!(usual > 0.0 && most <= MOST_OFF[0] && half <= MOST_OFF[1], "{name}: {most}, {half} of {usual}");
        let usual = mean(known.iter().map(|(_, [_, expected])| expected.abs()));
        let mut off: Vec<f64> =
            known.iter().map(|(_, [own, expected])| (own - expected).abs() / (expected.abs() + usual)).collect();
        let [most, half] = [0.95, 0.5].map(|share| quantile(&mut off, share));
        assert!(
            !has_fluxes || (usual > 0.0 && most <= MOST_OFF[0] && half <= MOST_OFF[1]),
            "{name}: {most}, {half} of {usual}"
        );
    }
}

/// Paths are followed once where that says where light of other waves lands: not in a prism's spectrum.
#[test]
fn spectra_are_thrown_at_several_wavelengths() {
    let waves = Waves::new(Bundle::Continuous);
    for (name, is_once) in [("cornell-box-spheres", true), ("prism", false)] {
        let stage = Stage::built_in(name);
        let (emission, density) = (stage.emission(settings(0, 32, 0.25)), Density::default());
        let usual = [50_000, 200_000].map(|count| lines::usual_radius(&emission, count, &density, &waves));
        assert_eq!(usual.map(|usual| usual.is_some()), [is_once; 2], "{name}");
        // Four times the photons are half as far apart.
        if let [Some(few), Some(many)] = usual {
            assert!((few / many - 2.0).abs() <= 1e-3 && many > 0.0);
        }
        let maps = Maps::new(
            (&stage.scene, &stage.whitted),
            &emission,
            (50_000, 0, &|_| ()),
            (density, 1.0),
            (Bundle::Continuous, Rethrow::Interpolated),
        );
        let (_, _, dispersed) = maps.counts();
        assert_eq!(maps.keys().is_empty(), is_once, "{name}");
        assert!(dispersed > 5000);
    }
}

/// Where ways end by chance, those that go on have the light of all, at every wavelength: not only at that at which it was decided.
#[test]
fn chances_leave_spectra_as_they_are() {
    let stage = room("SF11", "");
    let flux = |share: f64, count: u64, seed: u32, place: f32| {
        let emission = stage.emission(settings(seed, 6, share));
        let estimates: Vec<f64> = (0..24)
            .map(|pass| {
                let mut emitted = emit(&emission, count, pass);
                let numbers: Vec<u32> = emitted.prefixes.iter().map(crate::photon::Prefix::number).collect();
                let own = |n: usize| wavelength_at(f64::from(numbers[n] % 1009) / 1009.0);
                let thrown = emission.throw_drifting(&emitted.prefixes, own, &mut emitted.spectra).photons();
                thrown.iter().map(|d| f64::from(d.line.moved(&d.scattered.photon, place).flux)).sum()
            })
            .collect();
        super::mean(&estimates)
    };
    for place in [0.0, 0.5, 1.0] {
        let (expected, error) = flux(0.0, 20_000, 1, place);
        // Even what was emitted goes on in one of two cases at most.
        let (found, deviation) = flux(2.0, 40_000, 2, place);
        let tolerance = MOST_ERRORS * error.hypot(deviation);
        assert!(tolerance < 0.01 * expected, "too few photons to tell: {expected} ± {error}, {found} ± {deviation}");
        assert!((found - expected).abs() <= tolerance, "{place}: {found} ± {deviation}, {expected} ± {error}");
    }
}

/// Paths that go on at once land where they do from where they wait.
#[test]
fn paths_that_go_on_at_once_are_the_same() {
    let stage = room("SF11", "");
    let emission = stage.emission(settings(5, 8, 0.25));
    let wavelength_of = |number: u32| 400.0 + f64::from(number % 300);
    let mut emitted = emit(&emission, 20_000, 1);
    let numbers: Vec<u32> = emitted.prefixes.iter().map(crate::photon::Prefix::number).collect();
    let waited = emission.throw_drifting(&emitted.prefixes, |n| wavelength_of(numbers[n]), &mut emitted.spectra);
    let at_once = emission.emit_drifting(20_000, 1, &wavelength_of, &|_| ());
    assert_eq!((at_once.drifted, at_once.prefixes.len()), (emitted.prefixes.len(), 0));
    assert_eq!(at_once.photons.len(), emitted.photons.len());
    assert_eq!(at_once.account, emitted.account);
    let named = |drifting: Vec<Drifting>, spectra: &crate::photon::Spectra| -> Vec<(String, Vec<u32>)> {
        let name = |d: &Drifting| {
            let photon = crate::photon::Photon { spectrum: 0, ..d.scattered.photon };
            (format!("{photon:?} {:?}", d.line), spectra.leaves(d.scattered.photon.spectrum).to_vec())
        };
        let mut all: Vec<_> = drifting.iter().map(name).collect();
        all.sort();
        all
    };
    let [waited, at_once] =
        [named(waited.photons(), &emitted.spectra), named(at_once.drifting.concat(), &at_once.spectra)];
    assert!(waited.len() > 5000 && waited == at_once);
}

/// Places are by 1/λ², from the first wavelength to the last.
#[test]
fn places_are_those_of_wavelengths() {
    assert_eq!([380.0, 780.0].map(place_of), [0.0, 1.0]);
    for place in [0.0, 0.1, 0.5, 0.9, 1.0] {
        assert!((place_of(wavelength_at(place)) - place).abs() <= 1e-14);
    }
}
