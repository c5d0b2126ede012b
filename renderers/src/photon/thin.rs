//! Places spread evenly over surfaces, from photons that landed where there is light.

use std::collections::HashSet;

use glam::Vec3A;

use super::Photon;

/// How often the distance between places is halved to find the right one.
const STEPS: u32 = 12;

/// A surface and a cube in space.
type Cube = (u32, [i32; 3]);

/// The numbers of about as many photons as are wanted, fewer rather than more: the first on each surface in each cube of a grid. All of them if
/// that is no more.
///
/// Photons are dense where there is much light. Where they are few, as in the shade, all are taken.
pub(super) fn thinned(photons: &[Photon], wanted: usize) -> Vec<usize> {
    if photons.len() <= wanted {
        return (0..photons.len()).collect();
    }
    let position = |photon: &Photon| Vec3A::from_array(photon.position);
    let low = photons.iter().map(position).fold(Vec3A::INFINITY, Vec3A::min);
    let high = photons.iter().map(position).fold(Vec3A::NEG_INFINITY, Vec3A::max);
    let size = (high - low).max_element();
    let mut best = Vec::new();
    // Of grids with 1 to 2¹² cubes a side, by bisection of the logarithm.
    let (mut coarse, mut fine) = (0.0, f32::from(u16::try_from(STEPS).unwrap_or(0)));
    for _ in 0..STEPS {
        let level = f32::midpoint(coarse, fine);
        let first = firsts(photons, low, level.exp2() / size);
        if first.len() > wanted {
            fine = level;
        } else {
            (coarse, best) = (level, first);
        }
    }
    best
}

/// The numbers of the first photons in each cube.
fn firsts(photons: &[Photon], low: Vec3A, scale: f32) -> Vec<usize> {
    let mut cubes: HashSet<Cube> = HashSet::new();
    let mut is_first = |photon: &Photon| {
        let place = (Vec3A::from_array(photon.position) - low) * scale;
        #[allow(clippy::cast_possible_truncation, reason = "the number of a cube")]
        let cube = place.to_array().map(|x| x.floor() as i32);
        cubes.insert((photon.surface, cube))
    };
    let all = photons.iter().enumerate();
    all.filter(|(_, photon)| is_first(photon)).map(|(number, _)| number).collect()
}

#[cfg(test)]
mod tests {
    use super::thinned;
    use crate::photon::Photon;
    use crate::photon::random::Random;

    /// A square of which one half has a hundred times as many photons as the other: of places, both have as many.
    #[test]
    fn places_are_even_where_photons_are_not() {
        let mut random = Random::new(3);
        let mut photon = |half: f32| Photon {
            position: [0.5 * (random.next() + half), random.next(), 0.0],
            direction: [0.0, 0.0, 1.0],
            flux: 1.0,
            spectrum: 0,
            surface: 1,
        };
        let bright: Vec<Photon> = (0..200_000).map(|_| photon(0.0)).collect();
        let dark: Vec<Photon> = (0..2_000).map(|_| photon(1.0)).collect();
        let photons = [bright, dark].concat();
        for wanted in [100, 1000] {
            let chosen = thinned(&photons, wanted);
            assert!(chosen.len() <= wanted && chosen.len() >= wanted * 3 / 4, "{wanted}: {}", chosen.len());
            let dark = chosen.iter().filter(|number| photons[**number].position[0] >= 0.5).count();
            // At a thousand places, there are four photons in the shade for each, and an e⁻⁴th of the cubes have none.
            assert!(dark * 100 >= chosen.len() * 45, "{wanted}: {dark} of {}", chosen.len());
        }
        assert_eq!(thinned(&photons[..50], 60), (0..50).collect::<Vec<_>>());
    }
}
