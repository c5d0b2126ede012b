//! What parts of patches reflect: of direct light as it is in their middles, and of other light as rays find it.

use rayon::prelude::*;

use super::Solution;
use super::caustics::Landed;
use super::charts::Patched;
use super::mesh::{Node, Patches};
use super::rays::{Found, Lookup, Part, Rays};
use super::representation::{Representation, light};
use super::sight::surface_point;
use super::transport::Buffer;
use crate::direct::Receiver;
use crate::spectral::{Factor, FactorOrder};
use crate::whitted::{Whitted, Worker};

/// Rays of a gather for a group: errors of groups cancel in later gathers.
const GROUP_RAYS: u32 = 256;
/// Gathers for groups where there are mirrors or glass, which the patches' solution has only roughly: each corrects what is one reflection
/// further away. Without them, one is enough.
const SPECULAR_ROUNDS: u32 = 5;

/// What parts of patches receive, free of wavelength.
pub(super) struct Reflection {
    /// For each part, the irradiance that comes straight from each light, over the light's radiance; nothing for parts of polyhedra that
    /// stand for round shapes.
    direct: Vec<Option<Vec<f64>>>,
    /// The lights' spectra.
    lights: Vec<Factor>,
    /// For each group of parts, the parts that rays from its middle find.
    found: Vec<Vec<Found>>,
    /// How often what groups receive is gathered.
    rounds: u32,
    /// Whether rays find lamps by way of mirrors and glass.
    lamps: bool,
    /// What else comes from lights.
    landed: Landed,
}

impl Reflection {
    /// The rays are those of a gather.
    pub(super) fn new(
        patches: &Patches,
        shapes: &[Patched],
        rays: Rays<'_>,
        whitted: &Whitted,
        landed: Landed,
    ) -> Self {
        let lookup = rays.lookup;
        let rays = Rays { count: GROUP_RAYS, ..rays };
        let same = |part: &Part| {
            let Node { primitive, side, .. } = patches.nodes[part.node as usize];
            if patches.sides[side as usize].mirror {
                // No ray ends there.
                return None;
            }
            match shapes.get(patches.world.shape(primitive)? as usize) {
                Some(Patched::Same([to, from])) => Some((primitive, primitive - from + to)),
                _ => None,
            }
        };
        let of_part = |worker: &mut Worker<'_>, part: &Part| {
            let (_, primitive) = same(part)?;
            let (position, normal) = (part.polygon.centre, part.polygon.normal);
            let point = surface_point(position, normal, primitive);
            let contact = 2.0 * f64::from(point.error);
            Some(worker.direct(&Receiver { point, position, normal, geometric: normal, contact }))
        };
        let of_group = |part: &Part| match same(part) {
            Some((primitive, _)) => patches.found_by_rays(rays, part.polygon.centre, part.polygon.normal, primitive),
            None => Vec::new(),
        };
        Self {
            direct: lookup.parts.par_iter().map_init(|| Worker::new(whitted, FactorOrder::Free), of_part).collect(),
            lights: whitted.light_factors().collect(),
            found: lookup.groups.par_iter().map(of_group).collect(),
            rounds: if rays.specular.is_some() { SPECULAR_ROUNDS } else { 1 },
            lamps: rays.lamps,
            landed,
        }
    }

    /// The radiosity of each part of a patch: what it reflects of direct light, as it is in its middle, and of what its group receives from
    /// all others. That is gathered again, since patches of one radiosity spread light into the shadows of contacts.
    pub(super) fn radiosity(&self, solution: &Solution<'_>, lookup: &Lookup) -> Vec<f64> {
        let (radiosity, width) = (solution.radiosity, solution.width());
        let of_node = |node: u32| &solution.nodes[node as usize * width..][..width];
        let of_part = |part: &Part| of_node(part.node).to_vec();
        let whole: Vec<f64> = lookup.parts.par_iter().flat_map_iter(of_part).collect();
        let mut found = match radiosity.settings.bounces {
            None => {
                let transport = &radiosity.transport;
                let mut reflected: Vec<f64> =
                    transport.leaves.iter().flat_map(|leaf| of_node(*leaf)).copied().collect();
                if self.lamps || !self.landed.is_empty() {
                    without_caustics(solution, &mut reflected);
                }
                let mut between = vec![0.0; reflected.len()];
                transport.apply(&reflected, &mut between, width, &mut Buffer::default());
                let mut numbers = vec![0; radiosity.patches.nodes.len()];
                for (number, leaf) in transport.leaves.iter().enumerate() {
                    numbers[*leaf as usize] = number;
                }
                let straight = self.caustics(solution, lookup);
                let mut once = self.reflected(solution, lookup, &whole, |part| {
                    let mut row = between[numbers[part.node as usize] * width..][..width].to_vec();
                    let more = straight.get(part.group as usize * width..).unwrap_or_default();
                    row.iter_mut().zip(more).for_each(|(r, m)| *r += m);
                    row
                });
                for _ in 0..self.rounds {
                    self.add_lamps(solution, &mut once);
                    let of_group = |found: &Vec<Found>| added_up(found, &once, solution.representation());
                    let again: Vec<f64> = self.found.par_iter().flat_map_iter(of_group).collect();
                    once = self.reflected(solution, lookup, &whole, |part| {
                        again[part.group as usize * width..][..width].to_vec()
                    });
                }
                once
            }
            Some(1) => {
                let straight = self.caustics(solution, lookup);
                self.reflected(solution, lookup, &whole, |part| {
                    let row = straight.get(part.group as usize * width..).unwrap_or_default().iter();
                    row.copied().chain(core::iter::repeat(0.0)).take(width).collect()
                })
            }
            // What a limited number of reflections leaves is known for whole patches only.
            Some(_) => whole,
        };
        self.add_lamps(solution, &mut found);
        found
    }

    /// What groups of parts receive from lamps by way of mirrors and glass, row by row; nothing at all where rays don't find that.
    fn caustics(&self, solution: &Solution<'_>, lookup: &Lookup) -> Vec<f64> {
        if !self.lamps {
            return Vec::new();
        }
        let mut rows = vec![0.0; lookup.parts.len() * solution.width()];
        self.add_lamps(solution, &mut rows);
        let of_group = |found: &Vec<Found>| added_up(found, &rows, solution.representation());
        self.found.par_iter().flat_map_iter(of_group).collect()
    }

    /// After the parts, what sides send out by themselves, where rays find that.
    fn add_lamps(&self, solution: &Solution<'_>, rows: &mut Vec<f64>) {
        if self.lamps {
            rows.extend(&solution.lights.emission);
        }
    }

    /// What parts reflect of direct light and of other light.
    fn reflected(
        &self,
        solution: &Solution<'_>,
        lookup: &Lookup,
        whole: &[f64],
        other: impl Fn(&Part) -> Vec<f64> + Sync,
    ) -> Vec<f64> {
        let (representation, width) = (solution.representation(), solution.width());
        let patches = &solution.radiosity.patches;
        let lights: Vec<Vec<f64>> = self.lights.iter().map(|factor| light(representation, *factor)).collect();
        let landed = self.landed.rows(representation);
        let of_part = |number: usize| {
            let (part, direct) = (&lookup.parts[number], &self.direct[number]);
            let Some(factors) = direct else { return whole[number * width..][..width].to_vec() };
            let mut row = other(part);
            for (factor, spectrum) in factors.iter().zip(&lights) {
                row.iter_mut().zip(spectrum).for_each(|(r, s)| *r += factor * s);
            }
            self.landed.add(number, &landed, &mut row);
            let side = patches.nodes[part.node as usize].side;
            representation.reflect(patches.sides[side as usize].reflectance, &mut row);
            row
        };
        (0..lookup.parts.len()).into_par_iter().flat_map_iter(of_part).collect()
    }
}

/// Takes from what mirrors reflect what they reflect of lights, where that is known better.
fn without_caustics(solution: &Solution<'_>, reflected: &mut [f64]) {
    let (radiosity, width) = (solution.radiosity, solution.width());
    let sides = &radiosity.patches.sides;
    if !sides.iter().any(|side| side.mirror) {
        return;
    }
    let leaves = &radiosity.transport.leaves;
    let side_of = |leaf: &u32| radiosity.patches.nodes[*leaf as usize].side as usize;
    let emitted: Vec<f64> =
        leaves.iter().flat_map(|leaf| &solution.lights.emission[side_of(leaf) * width..][..width]).copied().collect();
    let mut lit = vec![0.0; emitted.len()];
    radiosity.transport.apply(&emitted, &mut lit, width, &mut Buffer::default());
    let direct = radiosity.direct(&solution.lights.sources, width, 0, width);
    let linear = solution.representation().linear();
    let rows = reflected.chunks_mut(width).zip(lit.chunks_mut(width)).zip(direct.chunks(width));
    for (leaf, ((row, lit), direct)) in leaves.iter().zip(rows) {
        let side = &sides[side_of(leaf)];
        if side.mirror {
            lit.iter_mut().zip(direct).for_each(|(h, d)| *h += d);
            solution.representation().reflect(side.reflectance, lit);
            // Bounds of errors stay.
            row[..linear].iter_mut().zip(lit).for_each(|(r, h)| *r -= *h);
        }
    }
}

/// The sum of rows, each times its share and with its tint.
pub(crate) fn added_up(found: &[Found], rows: &[f64], representation: &dyn Representation) -> Vec<f64> {
    let width = representation.width();
    let mut sum = vec![0.0; width];
    for same in found.chunk_by(|a, b| a.tint == b.tint) {
        if same[0].tint.is_none() {
            add(same, rows, &mut sum);
            continue;
        }
        let mut tinted = vec![0.0; width];
        add(same, rows, &mut tinted);
        for leaf in same[0].tint.leaves().rev() {
            representation.reflect(Factor { scale: 1.0, leaf: Some(leaf) }, &mut tinted);
        }
        sum.iter_mut().zip(tinted).for_each(|(s, t)| *s += t);
    }
    sum
}

fn add(found: &[Found], rows: &[f64], sum: &mut [f64]) {
    for Found { part, share, .. } in found {
        let row = &rows[*part as usize * sum.len()..][..sum.len()];
        sum.iter_mut().zip(row).for_each(|(s, r)| *s += share * r);
    }
}
