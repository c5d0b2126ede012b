//! Where photons land as a function of the wavelength, of each from one wavelength and the derivatives there alone.
//!
//! Where ways are nearly straight by 1/λ², it costs less than throwing paths at several wavelengths ([`Curves`](super::curves::Curves)), and each photon
//! is exactly where it landed at its own. Ways end nowhere: what changes with the wavelength but by degrees isn't known. It is decided for all of a scene
//! at once whether that will do: a prism beside a glass ball that most photons meet has each of its photons on one line, too.

use super::curves::Misfit;
use super::maps::{NEAR, WHOLE};
use super::motion::{self, Line, Motion, Moving};
use super::waves::Waves;
use super::{Density, Drifting, Emission, Emitted, Photon, PhotonMap, Scattered};
use crate::spectral::place_of;

/// The photons of pieces, and how they move.
pub(super) fn parted(pieces: Vec<Vec<Drifting>>) -> (Vec<Photon>, Vec<Line>) {
    let count = pieces.iter().map(Vec::len).sum();
    let (mut photons, mut lines) = (Vec::with_capacity(count), Vec::with_capacity(count));
    let all = || pieces.iter().flatten();
    rayon::join(
        || photons.extend(all().map(|drifting| drifting.scattered.photon)),
        || lines.extend(all().map(|drifting| drifting.line)),
    );
    drop(pieces);
    (photons, lines)
}

/// How photons of a map move about where they are, for the whole of the ways of those that it was made of; and the rest of these. No part is longer than
/// so many spacings between photons, unless there would be more than eight.
pub(super) fn cut(map: &PhotonMap, lines: &[Line], longest: f32, rest: &mut Moving) -> Vec<Motion> {
    let spacings = map.spacings();
    let parts = |number: usize, rest: &mut Moving| {
        let line = lines[map.origins()[number] as usize];
        let motion = line.motion();
        let mut own = motion;
        motion.parts([0.0, 1.0], longest * spacings[number], |_, part| {
            let [from, to] = part.limits;
            if part.at >= from && (part.at < to || to >= 1.0) {
                own = part;
            } else {
                let part = part.about(f64::midpoint(f64::from(from), f64::from(to)));
                rest.0.push(line.moved(&map.photons()[number], part.at));
                rest.1.push(part);
            }
        });
        own
    };
    motion::cut(map.len(), parts, rest)
}

/// The number of the trial among passes.
const TRIAL: u32 = u32::MAX - 3;

/// Photons of the trial.
const TRIED: u64 = 2048;

/// About the radius of an estimate where there are photons whose ways depend on the wavelength, of so many, if each may be thrown once: nine of ten of some
/// are near enough to where they were thrown at other wavelengths, both as the eye sees them.
#[allow(clippy::cast_precision_loss, clippy::cast_possible_truncation, reason = "as precise as radii")]
pub(super) fn usual_radius(emission: &Emission<'_>, count: u64, density: &Density, waves: &Waves) -> Option<f32> {
    if !emission.is_dispersive() {
        return None;
    }
    let tried = count.min(TRIED);
    let Emitted { prefixes, mut spectra, .. } = emission.emit(tried, TRIAL, &|_| {});
    let path = |number: usize| u32::try_from(number).unwrap_or(u32::MAX);
    let some = emission.throw_drifting(&prefixes, |n| waves.spread(WHOLE, path(n)), &mut spectra).photons();
    let others = emission.throw(&prefixes, |n| waves.spread_anew(WHOLE, path(n)), &mut spectra).photons();
    let moved = |to: &dyn Fn(u32) -> f64| -> Vec<Scattered> {
        let moved = |Drifting { scattered, line }: &Drifting| {
            let photon = line.moved(&scattered.photon, place_of(to(scattered.path)) as f32);
            Scattered { photon, ..*scattered }
        };
        some.iter().map(moved).collect()
    };
    let map = PhotonMap::new(moved(&|_| WHOLE.wavelength).into_iter().map(|s| s.photon).collect());
    let usual = density.usual_radius(&map) * (tried as f32 / count.max(1) as f32).sqrt();
    let misfit = Misfit::of(&moved(&|path| waves.spread_anew(WHOLE, path)), &others);
    (!some.is_empty() && misfit.is_within(NEAR * usual)).then_some(usual)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::photon::random::Random;

    /// Photons all over a unit square that move along it, each thrown somewhere between the first wavelength and the last.
    fn drifting(count: u32, speed: f32) -> Vec<Drifting> {
        let mut random = Random::new(3);
        let mut photon = |path: u32| {
            let [x, y, _] = random.vector();
            let [u, v, at] = random.vector();
            let photon = Photon { position: [x, y, 0.0], flux: 1.0, surface: 1, ..Photon::default() };
            let line = Line { position: [speed * u, speed * v, 0.0], flux: 0.5, at: 0.5 + 0.5 * at };
            Drifting { scattered: Scattered { photon, path, branch: 0 }, line }
        };
        (0..count).map(&mut photon).collect()
    }

    /// At every wavelength each photon is there once, on the line that leads through where it was thrown, whatever its way is cut into.
    #[test]
    fn parts_of_lines_are_lines() {
        let all = drifting(500, 0.5);
        let (photons, lines) = parted(vec![all[..200].to_vec(), all[200..].to_vec()]);
        assert!(photons.len() == 500 && lines.len() == 500);
        let map = PhotonMap::new(photons.clone());
        for (longest, fewest, most) in [(f32::INFINITY, 0, 0), (0.3, 200, 3000), (0.0, 3500, 3500)] {
            let mut rest = Moving::default();
            let own = cut(&map, &lines, longest, &mut rest);
            assert!((fewest..=most).contains(&rest.0.len()), "{longest}: {}", rest.0.len());
            for to in [0.0, 0.01, 0.49, 0.75, 1.0] {
                let parts = map.photons().iter().zip(&own).chain(rest.0.iter().zip(&rest.1));
                let there =
                    parts.map(|(photon, motion)| motion.at(photon, to)).filter(|(_, _, present)| *present > 0.0);
                let mut found: Vec<_> = there.collect();
                assert!((found.iter().map(|(_, _, present)| present).sum::<f32>() - 500.0).abs() <= 1e-3);
                let place = |([x, y, _], flux, _): &([f32; 3], f32, f32)| (*x, *y, *flux);
                let mut expected: Vec<_> = photons
                    .iter()
                    .zip(&lines)
                    .map(|(photon, line)| {
                        let moved = line.moved(photon, to);
                        (moved.position, moved.flux, 1.0)
                    })
                    .collect();
                for list in [&mut found, &mut expected] {
                    list.sort_by(|a, b| a.0[0].total_cmp(&b.0[0]));
                }
                // Where parts meet, both halves are there.
                found.dedup_by(|a, b| (a.0[0] - b.0[0]).abs() + (a.0[1] - b.0[1]).abs() <= 1e-5);
                assert_eq!(found.len(), expected.len());
                for (found, expected) in found.iter().zip(&expected).map(|(a, b)| (place(a), place(b))) {
                    let off =
                        (found.0 - expected.0).abs() + (found.1 - expected.1).abs() + (found.2 - expected.2).abs();
                    assert!(off <= 1e-5, "{found:?} {expected:?}");
                }
            }
        }
    }
}
