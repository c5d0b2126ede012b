//! Paths that part, end by chance, and are thrown again.

use std::collections::HashMap;

use super::{Stage, area, emit, glass, mean, settings, surroundings};
use crate::photon::emission::Thrown;
use crate::photon::{Account, Emission, Emitted, Spectra};

/// How many standard errors two estimates may differ by: more by chance once in 10⁵ comparisons.
const MOST: f64 = 4.5;

/// Glass, gold, a partial mirror and black sides, with a floor.
pub(super) fn room(index: &str, more: &str) -> Stage {
    let light = area("rectangle", r#"<rotate x="1" angle="180"/><scale value="0.4"/><translate z="3"/>"#);
    let gold = r#"<bsdf type="conductor"><string name="material" value="Au"/></bsdf>"#;
    let partial = r#"<bsdf type="schlick"><spectrum name="reflectance" value="400:0.2, 700:0.6"/>
        <float name="roughness" value="0.2"/></bsdf>"#;
    let shape = |kind: &str, place: &str, bsdf: &str| {
        format!(r#"<shape type="{kind}"><transform name="to_world">{place}</transform>{bsdf}</shape>"#)
    };
    let elements = [
        shape("sphere", r#"<scale value="0.5"/><translate z="0.6"/>"#, &glass(index, more)),
        shape("cube", r#"<scale value="0.3"/><rotate z="1" angle="30"/><translate x="1" z="0.5"/>"#, &glass("1.6", "")),
        shape("sphere", r#"<scale value="0.4"/><translate y="1.1" z="0.5"/>"#, gold),
        shape("rectangle", r#"<scale value="0.6"/><rotate y="1" angle="40"/><translate x="-1.2" z="0.6"/>"#, partial),
        shape("rectangle", r#"<scale value="2"/>"#, ""),
        shape("rectangle", r#"<rotate y="1" angle="90"/><translate x="1.9" z="1"/>"#, ""),
    ];
    Stage::of(&(elements.concat() + &light))
}

#[test]
fn all_flux_is_accounted_for() {
    let absorbing = r#"<spectrum name="absorption" value="0.5"/><spectrum name="specular_transmittance" value="0.9"/>"#;
    let stage = room("1.5", absorbing);
    let emission = stage.emission(settings(0, 3, 0.3));
    let Account { emitted, deposited, escaped, media, mirrors, boundaries, black, too_deep, roulette, .. } =
        emit(&emission, 20_000, 0).account;
    let parts = [deposited, escaped, media, mirrors, boundaries, black, too_deep];
    assert!(parts.iter().all(|part| *part > 1e-4 * emitted), "{parts:?} of {emitted}");
    assert!(roulette != 0.0 && roulette.abs() < 0.05 * emitted, "{roulette} of {emitted}");
    let account = emit(&emission, 20_000, 0).account;
    assert!(account.missing().abs() <= 1e-9 * emitted, "{account:?}");

    // With dispersion: what waits is what is thrown, and all of that is accounted for.
    let stage = room("SF11", "");
    let emission = stage.emission(settings(0, 8, 0.3));
    let emitted = emit(&emission, 20_000, 0);
    let Emitted { prefixes, mut spectra, account, .. } = emitted;
    assert!(account.missing().abs() <= 1e-9 * account.emitted && account.waiting > 0.1 * account.emitted);
    let thrown = emission.throw(&prefixes, |_| 450.0, &mut spectra).account;
    assert!(thrown.missing().abs() <= 1e-9 * thrown.emitted);
    assert!((thrown.emitted / account.waiting - 1.0).abs() <= 1e-6, "{} of {}", thrown.emitted, account.waiting);
}

#[test]
fn the_photons_have_the_flux_of_the_account() {
    let light = area("rectangle", r#"<rotate x="1" angle="180"/><translate z="3"/>"#);
    let coloured = glass("1.5", r#"<spectrum name="specular_transmittance" value="300:0.2, 900:0.8"/>"#);
    let stage = Stage::of(&format!(r#"<shape type="sphere">{coloured}</shape>{}{light}"#, surroundings(9.0)));
    let emission = stage.emission(settings(0, 8, 0.1));
    let emitted = emit(&emission, 5000, 0);
    // Each leaf of a product by its mean: the light's is flat, the glass's is (0.2 + 0.8)/2 + 0.001 (λ − 600 nm) at ȳ's centroid.
    let means: Vec<f64> = (0..emitted.spectra.len())
        .map(|number| {
            let leaves = emitted.spectra.leaves(u32::try_from(number).unwrap());
            leaves.iter().map(|leaf| emission.means[*leaf as usize]).product()
        })
        .collect();
    assert!(emission.means.iter().any(|mean| (mean - 0.46).abs() <= 0.005), "{:?}", emission.means);
    let sum: f64 = emitted.photons.iter().map(|p| f64::from(p.flux) * means[p.spectrum as usize]).sum();
    assert!((sum / emitted.account.deposited - 1.0).abs() <= 1e-6, "{sum}: {:?}", emitted.account);
    // From the eye to the light: the glass's leaf as often as light passed it, then the light's.
    let passes: Vec<usize> = (0..).take(emitted.spectra.len()).map(|n| emitted.spectra.leaves(n).len()).collect();
    assert!(passes.contains(&3), "{passes:?}");
}

/// Flux kept, and the part of it that is near the middle of the floor.
fn kept(photons: impl Iterator<Item = ([f32; 3], f32)>) -> [f64; 2] {
    photons.fold([0.0; 2], |[all, near], ([x, y, _], flux)| {
        let flux = f64::from(flux);
        [all + flux, near + if x * x + y * y < 0.3 { flux } else { 0.0 }]
    })
}

#[test]
fn roulette_is_unbiased() {
    let flux = |index: &str, more: &str, share: f64, count: u64, first: u32, wavelength: Option<f64>| {
        let stage = room(index, more);
        let emission = stage.emission(settings(first, 6, share));
        let estimate = |pass: u32| {
            let mut emitted = emit(&emission, count, pass);
            match wavelength {
                None => kept(emitted.photons.iter().map(|p| (p.position, p.flux))),
                Some(wavelength) => {
                    let thrown = emission.throw(&emitted.prefixes, |_| wavelength, &mut emitted.spectra);
                    kept(thrown.photons().iter().map(|s| (s.photon.position, s.photon.flux)))
                }
            }
        };
        let estimates: Vec<[f64; 2]> = (0..24).map(estimate).collect();
        [0, 1].map(|k| mean(&estimates.iter().map(|e| e[k]).collect::<Vec<_>>()))
    };
    let absorbing = r#"<spectrum name="absorption" value="380:0.1, 580:3, 780:0.5"/>"#;
    for (index, more, wavelength) in [
        ("1.5", "", None),
        ("SF11", "", Some(420.0)),
        ("SF11", absorbing, Some(400.0)),
        ("1.5", absorbing, Some(600.0)),
    ] {
        let all = flux(index, more, 0.0, 4000, 1, wavelength);
        // Even what was emitted goes on in one of two cases at most.
        let chance = flux(index, more, 2.0, 20_000, 2, wavelength);
        for ((expected, error), (found, deviation)) in all.into_iter().zip(chance) {
            let tolerance = MOST * error.hypot(deviation);
            assert!(
                tolerance < 0.05 * expected,
                "too few photons to tell: {expected} ± {error}, {found} ± {deviation}"
            );
            assert!(
                (found - expected).abs() <= tolerance,
                "{index} {more}: {found} ± {deviation}, {expected} ± {error}"
            );
        }
    }
}

/// Photons thrown by path and branch.
fn by_branch(thrown: &Thrown) -> HashMap<(u32, u32), ([f32; 3], f32, u32)> {
    let entry =
        |s: &crate::photon::Scattered| ((s.path, s.branch), (s.photon.position, s.photon.flux, s.photon.spectrum));
    let map: HashMap<_, _> = thrown.photons().iter().map(entry).collect();
    assert_eq!(map.len(), thrown.photons().len(), "each path and branch lands once");
    map
}

#[test]
fn paths_take_the_same_decisions_at_all_wavelengths() {
    let stage = Stage::built_in("cornell-box-spheres");
    let emission = stage.emission(settings(4, 16, 0.25));
    let mut emitted = emit(&emission, 20_000, 0);
    assert!(!emitted.photons.is_empty() && emitted.prefixes.len() > 5000);
    let [blue, red] =
        [450.0, 650.0].map(|w| by_branch(&emission.throw(&emitted.prefixes, |_| w, &mut emitted.spectra)));
    assert!(blue.len() > emitted.prefixes.len());
    let mut far = 0;
    let mut same = 0;
    for (key, (position, flux, _)) in &blue {
        let Some((other, other_flux, _)) = red.get(key) else { continue };
        same += 1;
        // The glass's index changes by 0.011, of 1.52; but for grazing light, reflectances by some percent.
        let distance = (0..3).map(|i| (position[i] - other[i]).powi(2)).sum::<f32>().sqrt();
        far += usize::from(distance > 30.0 || !((flux / other_flux - 1.0).abs() < 0.15));
        assert!(*flux > 0.0);
    }
    let missing = blue.len() + red.len() - 2 * same;
    // From the second boundary on, likelihoods follow reflectances that differ by some percent.
    assert!(missing * 20 < blue.len(), "{missing} of {} have no counterpart", blue.len());
    assert!(far * 20 < same, "{far} of {same} are far from their counterparts");
}

/// Each path may have a wavelength of its own.
#[test]
fn wavelengths_are_asked_for_by_path() {
    let stage = room("SF11", "");
    let emission = stage.emission(settings(4, 8, 0.25));
    let mut emitted = emit(&emission, 20_000, 0);
    let mut throw = |wavelength: &(dyn Fn(usize) -> f64 + Sync)| {
        emission.throw(&emitted.prefixes, wavelength, &mut emitted.spectra).photons()
    };
    let (blue, red) = (throw(&|_| 420.0), throw(&|_| 680.0));
    let mixed = throw(&|path| if path % 3 == 0 { 420.0 } else { 680.0 });
    let expected: Vec<_> = {
        let mut both: Vec<_> =
            blue.iter().filter(|s| s.path % 3 == 0).chain(red.iter().filter(|s| s.path % 3 != 0)).collect();
        both.sort_by_key(|s| s.path);
        both.into_iter().copied().collect()
    };
    assert!(mixed == expected && mixed != red);
    // In the order of paths and of their branches, of which some paths have several.
    assert!(mixed.is_sorted_by_key(|s| (s.path, s.branch)));
    assert!(mixed.windows(2).any(|pair| pair[0].path == pair[1].path));
}

#[test]
fn photons_do_not_depend_on_threads() {
    let stage = room("SF11", "");
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let emission: Emission<'_> = stage.emission(settings(9, 8, 0.2));
            let mut emitted = emit(&emission, 50_000, 2);
            let thrown = emission.throw(
                &emitted.prefixes,
                |path| if path % 2 == 0 { 400.0 } else { 530.0 },
                &mut emitted.spectra,
            );
            (emitted, thrown)
        })
    };
    let ((one, one_thrown), (three, three_thrown)) = (run(1), run(3));
    assert!(one.photons.len() > 10_000 && one.prefixes.len() > 10_000 && one.spectra.len() > 40);
    assert!(one.photons == three.photons && one.prefixes == three.prefixes);
    assert!(one_thrown.pieces == three_thrown.pieces);
    assert_eq!((one.account, one_thrown.account), (three.account, three_thrown.account));
    let leaves = |spectra: &Spectra| -> Vec<Vec<u32>> {
        (0..).take(spectra.len()).map(|number| spectra.leaves(number).to_vec()).collect()
    };
    assert_eq!(leaves(&one.spectra), leaves(&three.spectra));
    // Another pass is another estimate.
    let emission = stage.emission(settings(9, 8, 0.2));
    assert!(emit(&emission, 50_000, 3).photons != one.photons);
}
