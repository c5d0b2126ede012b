//! How far photons count: within a radius that is chosen for each few of them, about where they landed or all along their ways.
//!
//! An estimate with a radius of the place where light is wanted takes light from beyond an edge, and nothing gives it back: the nearest photons of
//! a dark place are those of a bright one. Where radii belong to photons instead (sample smoothing estimators: Terrell and Scott, "Variable Kernel
//! Density Estimation", 1992), all light of a photon is on the surface once, whatever its radius (away from the ends of faces), and where photons are
//! evenly dense the estimate is without bias, however radii are chosen.

use core::ops::Range;

use glam::Vec3A;
use rayon::prelude::*;

use super::Photon;
use super::density::{Density, Estimate, Place};
use super::map::{Near, PhotonMap, Region, Tree, WAITING};
use super::motion::Motion;
use super::ways::Ways;

/// How far the photons of a leaf of a map count.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Footprint {
    /// In scene units; 0 if they don't count.
    pub(super) radius: f32,
    /// How much of the light where they landed is there because it is not the same all over the radius, relative to it.
    pub(super) bias: f32,
}

/// Photons by the places where they count: a hierarchy of boxes over the leaves of a map's trees.
#[derive(Clone, Debug, Default)]
pub(super) struct Footprints {
    /// One for each leaf.
    radii: Vec<Footprint>,
    /// The same; none if no photon moves.
    ways: Vec<Ways>,
    /// For the node that parts two leaves the boxes of both its parts, by the index of the second leaf.
    nodes: Vec<[Box3; 2]>,
}

/// The least and the largest coordinates.
#[derive(Clone, Copy, Debug)]
struct Box3 {
    low: Vec3A,
    high: Vec3A,
}

impl Box3 {
    const EMPTY: Self = Self { low: Vec3A::INFINITY, high: Vec3A::NEG_INFINITY };

    fn with(self, other: Self) -> Self {
        Self { low: self.low.min(other.low), high: self.high.max(other.high) }
    }

    /// About a way by its middle and from there to its end, and a little rounding.
    fn around(middle: [f32; 3], half: [f32; 3]) -> Self {
        let [middle, half] = [middle, half].map(Vec3A::from_array);
        let half = half.abs() + 4.0 * f32::EPSILON * middle.abs().max_element();
        Self { low: middle - half, high: middle + half }
    }

    /// With all that is nearer than a distance, and a little more.
    fn wider(self, distance: f32) -> Self {
        let distance = Vec3A::splat(distance * (1.0 + 4.0 * f32::EPSILON));
        Self { low: self.low - distance, high: self.high + distance }
    }

    /// The square of the distance from a point.
    fn distance2(&self, p: Vec3A) -> f32 {
        (self.low - p).max(p - self.high).max(Vec3A::ZERO).length_squared()
    }
}

/// Leaves of photons whose radii a thread chooses or evens out together.
pub(super) const LEAVES: usize = 64;

/// The radii of a map's leaves, each the geometric mean of those of the photons within it: where radii change at once, light that is even would have
/// a step.
pub(super) fn evened(map: &PhotonMap, radii: &[Footprint]) -> Vec<Footprint> {
    let even = |near: &mut Vec<Near>, (numbers, own): (Range<usize>, &Footprint)| {
        let mean = || {
            let (_, photon) = map.middle_of(numbers)?;
            map.within(photon.surface, &Region::ball(photon.position, own.radius), near);
            let radius = |near: &Near| radii.get(map.leaf_of(near.photon)?).map(|footprint| footprint.radius);
            let (mut sum, mut count) = (0.0, 0.0_f32);
            for radius in near.iter().filter_map(radius).filter(|radius| *radius > 0.0) {
                sum += radius.ln();
                count += 1.0;
            }
            (count > 0.0 && own.radius > 0.0).then(|| (sum / count).exp())
        };
        let Some(radius) = mean() else { return *own };
        // Biases go with the square, while they are small.
        Footprint { radius, bias: own.bias * (radius / own.radius).powi(2).min(1.0) }
    };
    let leaves: Vec<_> = map.leaves_photons().zip(radii).collect();
    leaves.into_par_iter().with_min_len(LEAVES).map_init(Vec::new, even).collect()
}

impl Footprints {
    /// Those of the photons of a map, with the radii of its leaves, and how photons move, in the map's order, with the least number of steps in which
    /// their light is found.
    pub(super) fn new(map: &PhotonMap, radii: Vec<Footprint>, moving: Option<(&[Motion], u16)>) -> Self {
        let motions_of = |numbers: &Range<usize>| {
            let (motions, least) = moving?;
            Some((motions.get(numbers.clone()).unwrap_or_default(), least))
        };
        let photons_of = |numbers: &Range<usize>| map.photons().get(numbers.clone()).unwrap_or_default();
        let around = |(numbers, footprint): &(Range<usize>, &Footprint)| {
            let photons = photons_of(numbers).iter();
            let around = match motions_of(numbers) {
                Some((motions, _)) => photons.zip(motions).fold(Box3::EMPTY, |around, (photon, motion)| {
                    let (middle, half) = motion.middle(photon);
                    around.with(Box3::around(middle, half))
                }),
                None => {
                    photons.fold(Box3::EMPTY, |around, photon| around.with(Box3::around(photon.position, [0.0; 3])))
                }
            };
            if footprint.radius > 0.0 { around.wider(footprint.radius) } else { Box3::EMPTY }
        };
        let leaves: Vec<_> = map.leaves_photons().zip(&radii).collect();
        let in_turn = || leaves.par_iter().with_min_len(LEAVES);
        let boxes: Vec<Box3> = in_turn().map(around).collect();
        let ways = in_turn().filter_map(|(numbers, footprint)| {
            let (motions, least) = motions_of(numbers)?;
            Some(Ways::new(photons_of(numbers), motions, footprint.radius, least))
        });
        let ways = if moving.is_some() { ways.collect() } else { Vec::new() };
        let mut footprints = Self { nodes: vec![[Box3::EMPTY; 2]; radii.len()], radii, ways };
        for tree in map.trees() {
            footprints.fill(&boxes, tree.leaves.start, tree.leaves.end);
        }
        footprints
    }

    fn fill(&mut self, boxes: &[Box3], first: usize, end: usize) -> Box3 {
        if end - first <= 1 {
            return boxes.get(first).copied().unwrap_or(Box3::EMPTY);
        }
        let middle = usize::midpoint(first, end);
        let parts = [self.fill(boxes, first, middle), self.fill(boxes, middle, end)];
        self.nodes[middle] = parts;
        parts[0].with(parts[1])
    }

    /// How far photons count about a position; `None` if the surface has none.
    pub(super) fn at(&self, map: &PhotonMap, surface: u32, position: [f32; 3]) -> Option<Footprint> {
        self.radii.get(map.leaf_at(surface, position)?).copied()
    }

    /// Calls with the photons of a surface that don't move and may count in a region, in an order that depends on the map and the region alone: their
    /// numbers, the squares of their distances, and how far they count, at least within the region's radius.
    pub(super) fn counting(
        &self,
        map: &PhotonMap,
        surface: u32,
        region: &Region,
        mut call: impl FnMut(Near, Footprint),
    ) {
        let Some(tree) = map.tree(surface) else { return };
        self.leaves(tree, region, |leaf, footprint| {
            let (distances, mut mask) =
                map.distances(leaf, region, (footprint.radius * footprint.radius).min(f32::MAX));
            let first = tree.first_of(leaf);
            while mask != 0 {
                let i = mask.trailing_zeros();
                call(Near { distance2: distances[i as usize], photon: first + i }, footprint);
                mask &= mask - 1;
            }
        });
    }

    /// The same with all photons of a leaf of those that move, and the number of the first.
    pub(super) fn passing(
        &self,
        map: &PhotonMap,
        surface: u32,
        region: &Region,
        mut call: impl FnMut(&Ways, u32, Footprint),
    ) {
        let Some(tree) = map.tree(surface) else { return };
        self.leaves(tree, region, |leaf, footprint| {
            if let Some(ways) = self.ways.get(leaf) {
                call(ways, tree.first_of(leaf), footprint);
            }
        });
    }

    /// Calls with the leaves of a tree whose photons may count in a region.
    fn leaves(&self, tree: &Tree, region: &Region, mut call: impl FnMut(usize, Footprint)) {
        let limit = (region.radius * region.radius).clamp(0.0, f32::MAX);
        let position = Vec3A::from_array(region.position);
        let mut branch = tree.leaves.start..tree.leaves.end;
        let mut waiting = [(0, 0); WAITING];
        let mut depth = 0;
        loop {
            while branch.len() > 1 {
                let middle = usize::midpoint(branch.start, branch.end);
                match self.nodes[middle].map(|part| part.distance2(position) <= limit) {
                    [true, true] => {
                        waiting[depth] = (middle, branch.end);
                        depth += 1;
                        branch.end = middle;
                    }
                    [true, false] => branch.end = middle,
                    [false, true] => branch.start = middle,
                    [false, false] => branch.end = branch.start,
                }
            }
            if let Some(own) = self.radii.get(branch.start).filter(|own| !branch.is_empty() && own.radius > 0.0) {
                call(branch.start, Footprint { radius: own.radius.max(region.radius), ..*own });
            }
            if depth == 0 {
                return;
            }
            depth -= 1;
            branch = waiting[depth].0..waiting[depth].1;
        }
    }

    pub(super) const fn bytes(&self) -> usize {
        size_of::<Footprint>() * self.radii.capacity()
            + size_of::<Ways>() * self.ways.capacity()
            + size_of::<[Box3; 2]>() * self.nodes.capacity()
    }
}

impl Density {
    /// Estimates the irradiance at a place from the photons of its surface that don't move: each counts within a radius r of its own, at least
    /// that of the region, at the distance d for its flux times K(d/r) / (r² m). m is the kernel's share on the face of the place for the mean of the radii, by
    /// flux.
    pub(super) fn estimate_by(
        &self,
        (map, footprints): (&PhotonMap, &Footprints),
        (place, region): (&Place<'_>, &Region),
        brightness: impl Fn(&Photon) -> f32,
        estimate: &mut Estimate,
    ) {
        estimate.clear();
        footprints.counting(map, place.surface, region, |near, footprint| {
            if let Some(photon) = map.photons().get(near.photon as usize).filter(|photon| place.sees(photon)) {
                let Footprint { radius, bias } = footprint;
                let weight = self.kernel.value(near.distance2 / (radius * radius)) / (radius * radius);
                estimate.add(near.photon, weight, (brightness(photon), photon.flux), (radius, bias));
            }
        });
        let mass = self.mass_within(place, f64::from(estimate.mean_radius()));
        estimate.finish(1.0 / mass);
    }
}

#[cfg(test)]
mod tests;
