//! Searches against those of all photons.

use rayon::ThreadPoolBuilder;

use super::{Near, PhotonMap, Region, square};
use crate::photon::Photon;
use crate::photon::random::Random;

fn photon(position: [f32; 3], surface: u32) -> Photon {
    Photon { position, direction: [0.0, 0.0, 1.0], flux: 1.0, spectrum: 0, surface }
}

/// Photons on a few surfaces of very different numbers; `steps` puts them on a grid, where many distances are equal.
fn photons(count: usize, steps: Option<f32>, seed: u64) -> Vec<Photon> {
    let mut random = Random::new(seed);
    let mut coordinate = || {
        let x = random.next() * 2.0 - 1.0;
        steps.map_or(x, |steps| (x * steps).round() / steps)
    };
    let position = |flat: bool| [coordinate(), coordinate(), if flat { 0.0 } else { coordinate() }];
    let positions: Vec<_> = (0..count).map(|i| i % 3 == 0).map(position).collect();
    positions.into_iter().zip([5, 5, 2, 5, 5, 900, 5].into_iter().cycle()).map(|(p, s)| photon(p, s)).collect()
}

fn naive(map: &PhotonMap, surface: u32, region: &Region, count: usize) -> Vec<Near> {
    let mut found = Vec::new();
    for (photon, number) in map.photons().iter().zip(0..) {
        let d = [0, 1, 2].map(|i| photon.position[i] - region.position[i]);
        let n = region.normal;
        let height = n[0] * d[0] + n[1] * d[1] + n[2] * d[2];
        let distance2 = square(d);
        let slab = region.thickness * region.thickness + region.slope * region.slope * distance2;
        if photon.surface == surface && distance2 <= region.radius * region.radius && height * height <= slab {
            found.push(Near { distance2, photon: number });
        }
    }
    found.sort_by_key(Near::key);
    found.truncate(count);
    found
}

#[test]
fn nearest_are_those_of_a_search_of_all() {
    let mut found = Vec::new();
    for (count, steps) in [(1, None), (16, None), (17, None), (300, Some(4.0)), (5000, None), (5000, Some(12.0))] {
        let map = PhotonMap::new(photons(count, steps, 1));
        assert_eq!(map.len(), count);
        let places = photons(60, steps, 2);
        for (i, place) in places.iter().enumerate() {
            let slab =
                Region { normal: [0.6, 0.0, 0.8], thickness: 0.05, slope: 0.2, ..Region::ball(place.position, 0.7) };
            for region in [slab, Region::ball(place.position, 0.3), Region::ball(place.position, f32::INFINITY)] {
                for (surface, many) in [(5, 50), (2, 1), (900, 7), (5, usize::MAX), (4, 3), (5, 0)] {
                    if many == usize::MAX {
                        map.within(surface, &region, &mut found);
                        found.sort_unstable_by_key(Near::key);
                        assert_eq!(found, naive(&map, surface, &region, many));
                    }
                    map.nearest(surface, &region, many, &mut found);
                    assert_eq!(found, naive(&map, surface, &region, many), "{count} {i} {surface} {many} {region:?}");
                }
            }
        }
    }
}

/// The leaf of a photon's place is its own, as no two have the same coordinate.
#[test]
fn photons_are_in_the_leaves_of_their_places() {
    let mut input = photons(5000, None, 4);
    let mut random = Random::new(5);
    input.iter_mut().for_each(|photon| photon.position[2] = random.next());
    let map = PhotonMap::new(input);
    for (leaf, numbers) in map.leaves_photons().enumerate() {
        let own = &map.photons()[numbers.clone()];
        let is_here = |photon: &&Photon| map.leaf_at(photon.surface, photon.position) == Some(leaf);
        assert_eq!(own.iter().filter(is_here).count(), own.len(), "{leaf}");
        assert!(numbers.clone().all(|photon| map.leaf_of(u32::try_from(photon).unwrap()) == Some(leaf)));
        let (middle, photon) = map.middle_of(numbers.clone()).unwrap();
        assert!(numbers.contains(&(middle as usize)) && map.photons()[middle as usize] == *photon);
    }
    assert_eq!(map.leaf_at(4, [0.0; 3]), None);
}

#[test]
fn a_map_is_the_same_on_any_number_of_threads() -> Result<(), rayon::ThreadPoolBuildError> {
    let input = photons(60_000, Some(50.0), 3);
    let build = |threads| {
        let pool = ThreadPoolBuilder::new().num_threads(threads).build()?;
        Ok(pool.install(|| PhotonMap::new(input.clone())))
    };
    let (one, four) = (build(1)?, build(4)?);
    assert_eq!(one.photons(), four.photons());
    assert_eq!(one.origins(), four.origins());
    assert_eq!(one.leaves, four.leaves);
    for (photon, origin) in one.photons().iter().zip(one.origins()) {
        assert_eq!(*photon, input[*origin as usize]);
    }
    let mut origins = one.origins().to_vec();
    origins.sort_unstable();
    assert!(origins.into_iter().eq(0..60_000));
    assert!(one.bytes() >= 60_000 * (size_of::<Photon>() + 12));
    Ok(())
}

#[test]
fn numbers_that_are_none_are_left_out() {
    let bad = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 1e13];
    let mut input: Vec<_> = bad.iter().map(|x| photon([0.0, *x, 0.0], 1)).collect();
    input.push(Photon { flux: f32::NAN, ..photon([0.0; 3], 1) });
    input.push(photon([1.0, 2.0, 3.0], 1));
    let map = PhotonMap::new(input);
    assert_eq!((map.len(), map.origins()), (1, &[5][..]));
    let mut found = vec![Near { distance2: 0.0, photon: 0 }];
    map.nearest(1, &Region::ball([f32::NAN, 0.0, 0.0], 10.0), 5, &mut found);
    assert!(found.is_empty());
    map.nearest(1, &Region::ball([1.0, 2.0, 2.0], f32::NAN), 5, &mut found);
    assert!(found.is_empty());
    assert!(PhotonMap::new(Vec::new()).is_empty());
    PhotonMap::new(Vec::new()).nearest(0, &Region::ball([0.0; 3], 1.0), 5, &mut found);
    assert!(found.is_empty());
}

#[test]
fn sizes_make_no_difference() {
    let mut found = Vec::new();
    for scale in [1e-42, 1e-30, 1e-10, 1.0, 1e12] {
        let mut input = photons(2000, None, 7);
        input.iter_mut().for_each(|photon| photon.position = photon.position.map(|x| x * scale));
        let map = PhotonMap::new(input);
        let region = Region::ball(map.photons()[100].position, scale);
        map.nearest(5, &region, 20, &mut found);
        assert_eq!(found, naive(&map, 5, &region, 20), "{scale}");
        assert_eq!(found.len(), 20);
    }
}
