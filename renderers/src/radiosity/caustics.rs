//! Light that comes straight from lights by way of mirrors and glass, as a source of other light between surfaces.

use std::collections::HashMap;

use glam::DVec3;

use super::mesh::Patches;
use super::rays::Lookup;
use super::representation::Representation;
use crate::geometry::Ray;
use crate::spectral::Factor;

/// What a [`Field`](super::Field) takes to be known of light that comes from lights by way of mirrors and glass, and is then reflected
/// diffusely: paths L S⁺ D. More than two diffuse reflections later, it is taken as the patches' solution has it: passing glass straight,
/// and reflected by mirrors in all directions.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub enum Caustics<'c> {
    /// Nothing: such light is left out, both where it arrives and where it is reflected to.
    #[default]
    LeftOut,
    /// Rays of gathers find it as they find other light. Good where lamps are large; small ones make noise, and lights without area aren't found.
    Gathered,
    /// This light arrives. It counts for what it is reflected to, but not itself: whoever found it adds it to the picture.
    Given(&'c [Deposit<'c>]),
}

/// Light of a path L S⁺ D where it meets a surface that reflects diffusely: a photon.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Deposit<'c> {
    /// Where it lands, in scene units, within 10⁻⁶ of the largest coordinate. On round surfaces, which are polyhedra here, it is ignored.
    pub position: DVec3,
    /// The unit vector to where it comes from.
    pub direction: DVec3,
    /// Its flux over its spectrum, in the unit of the light's radiance times m² sr.
    pub flux: f64,
    /// Its spectrum: a product of leaves of the palette, from the surface to the light, whose own is last.
    pub leaves: &'c [u32],
}

/// Deposits on parts of patches.
#[derive(Clone, Debug, Default)]
pub(super) struct Landed {
    /// Products of leaves.
    spectra: Vec<Vec<u32>>,
    /// For each part that has any: irradiance over each spectrum.
    of_part: HashMap<u32, Vec<(u32, f64)>>,
}

impl Landed {
    pub(super) fn new(caustics: Caustics<'_>, patches: &Patches, lookup: &Lookup) -> Self {
        let mut landed = Self::default();
        let Caustics::Given(deposits) = caustics else { return landed };
        let mut numbers: HashMap<&[u32], u32> = HashMap::new();
        for deposit in deposits {
            let Some(part) = part(deposit, patches, lookup) else { continue };
            let next = u32::try_from(landed.spectra.len()).unwrap_or(u32::MAX);
            let spectrum = *numbers.entry(deposit.leaves).or_insert(next);
            if spectrum == next {
                landed.spectra.push(deposit.leaves.to_vec());
            }
            let irradiance = deposit.flux / lookup.parts[part as usize].polygon.area;
            let sums = landed.of_part.entry(part).or_default();
            match sums.iter_mut().find(|(known, _)| *known == spectrum) {
                Some((_, sum)) => *sum += irradiance,
                None => sums.push((spectrum, irradiance)),
            }
        }
        landed
    }

    pub(super) fn is_empty(&self) -> bool {
        self.of_part.is_empty()
    }

    /// The rows of all spectra.
    pub(super) fn rows(&self, representation: &dyn Representation) -> Vec<Vec<f64>> {
        let row = |leaves: &Vec<u32>| {
            let mut row = vec![0.0; representation.width()];
            let factor = |leaf: u32| Factor { scale: 1.0, leaf: Some(leaf) };
            let Some((lamp, others)) = leaves.split_last() else { return row };
            representation.light(factor(*lamp), &mut row);
            others.iter().rev().for_each(|leaf| representation.reflect(factor(*leaf), &mut row));
            row
        };
        self.spectra.iter().map(row).collect()
    }

    /// Adds the irradiance on a part, with the rows of all spectra.
    pub(super) fn add(&self, part: usize, rows: &[Vec<f64>], row: &mut [f64]) {
        let sums = u32::try_from(part).ok().and_then(|part| self.of_part.get(&part));
        for (spectrum, irradiance) in sums.into_iter().flatten() {
            row.iter_mut().zip(&rows[*spectrum as usize]).for_each(|(r, s)| *r += irradiance * s);
        }
    }
}

/// The part that a deposit is on.
fn part(deposit: &Deposit<'_>, patches: &Patches, lookup: &Lookup) -> Option<u32> {
    // Coordinates of photons may have been rounded.
    let near = 1e5 * patches.slack;
    let away = deposit.direction * near;
    let mut ray = Ray::new((deposit.position + away).as_vec3a(), (-away).as_vec3a());
    ray.t_max = 2.0;
    lookup.part(patches, &patches.world.closest_hit(&ray)?)
}
