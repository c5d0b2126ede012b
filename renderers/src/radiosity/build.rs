//! From roots to patches and links that are fine enough.

use super::Settings;
use super::error::RadiosityError;
use super::link::{self, Oracle, Values};
use super::mesh::Patches;
use super::scalar::luminous;
use super::solve::System;
use super::source::{self, Source};
use super::transport::{Buffer, Buffers, Link, Transport};
use crate::spectral::Palette;

/// Passes of refinement, each to a quarter of the flux of the one before.
const PASSES: i32 = 3;
/// The error of the solutions that refinement looks at.
const ROUGH: f64 = 1e-3;
/// The relative error of irradiance times area that a link may cause, over the accuracy asked for and the lit area.
const LINK_SHARE: f64 = 0.015;
/// The relative error of irradiance that a link with a cluster may cause at either end, over the accuracy asked for.
const CLUSTER_SHARE: f64 = 0.25;
/// How much the unevenness of light that comes straight from lamps counts: it is computed point by point.
const LAMP: f64 = 0.2;
/// Irradiance under this share of what is typical counts as this share.
const DARKNESS: f64 = 0.03;
/// The same for a light and a patch.
const SOURCE_SHARE: f64 = 0.03;

/// Luminous values of sides and lights: what refinement looks at.
pub(super) struct Builder<'s> {
    settings: &'s Settings,
    reflectance: Vec<f64>,
    /// Radiosity that sides send out by themselves.
    emission: Vec<f64>,
    sources: &'s [Source],
}

impl<'s> Builder<'s> {
    pub(super) fn new(
        settings: &'s Settings,
        patches: &Patches,
        sources: &'s [Source],
        palette: &Palette,
    ) -> Result<Self, RadiosityError> {
        let mut builder = Self { settings, reflectance: Vec::new(), emission: Vec::new(), sources };
        for side in &patches.sides {
            let value = |factor| luminous(palette, factor).map_err(RadiosityError::Spectrum);
            builder.reflectance.push(value(side.reflectance)?);
            let radiance = side.emission.map_or(Ok(0.0), value)?;
            builder.emission.push(core::f64::consts::PI * radiance);
        }
        Ok(builder)
    }

    /// Splits patches and makes links.
    pub(super) fn build(
        &self,
        patches: &mut Patches,
        progress: &(dyn Fn(f64) + Sync),
    ) -> Result<Vec<Link>, RadiosityError> {
        let emitted: f64 = patches.nodes[..patches.roots]
            .iter()
            .map(|node| self.emission[node.side as usize] * node.polygon.area)
            .sum();
        let sent = emitted + source::luminous_flux(patches, self.sources);
        let most = SOURCE_SHARE * self.settings.accuracy * sent;
        source::refine(patches, self.sources, &self.reflectance, most);
        // Links carry what area lights send, and what is reflected more than once.
        let reflections = self.settings.bounces.unwrap_or(u32::MAX);
        if reflections == 0 || (reflections == 1 && emitted <= 0.0) {
            return Ok(Vec::new());
        }
        let mut buffer = Buffer::default();
        let of_node = |index: usize| self.reflectance[patches.nodes[index].side as usize];
        let mut oracle = Oracle {
            radiosity: Values::default(),
            irradiance: Values::default(),
            reflectance: Values { patches: (0..patches.nodes.len()).map(of_node).collect(), clusters: Vec::new() },
            uneven: Vec::new(),
            most: f64::INFINITY,
            most_in_cluster: f64::INFINITY,
            memory: self.settings.memory,
        };
        let pairs = link::all_pairs(patches, &oracle)?;
        let mut links = link::refine(patches, Vec::new(), pairs, &mut oracle)?;
        for pass in 1..=PASSES {
            let area = self.look(patches, &links, &mut oracle, &mut buffer);
            let coarse = 4.0_f64.powi(PASSES - pass);
            oracle.most = LINK_SHARE * self.settings.accuracy * area * coarse;
            oracle.most_in_cluster = CLUSTER_SHARE * self.settings.accuracy * coarse;
            links = link::refine(patches, links, Vec::new(), &mut oracle)?;
            progress(f64::from(pass) / f64::from(PASSES + 1));
        }
        Ok(links)
    }

    /// Tells the oracle the luminous radiosity and irradiance of all nodes, the latter at least as much as darkness; the area that is lit.
    fn look(&self, patches: &Patches, links: &[Link], oracle: &mut Oracle, buffer: &mut Buffer) -> f64 {
        let transport = Transport::new(patches, links);
        let of_side = |values: &[f64]| -> Vec<f64> {
            transport.leaves.iter().map(|leaf| values[patches.nodes[*leaf as usize].side as usize]).collect()
        };
        let (of_leaf, emitted) = (of_side(&self.reflectance), of_side(&self.emission));
        let values = source::irradiances(patches, self.sources, &transport.leaves);
        let direct = source::luminous_irradiances(self.sources, &values, transport.leaves.len());
        let mut lit = vec![0.0; emitted.len()];
        transport.apply(&emitted, &mut lit, 1, buffer);
        lit.iter_mut().zip(&direct).for_each(|(h, d)| *h += d);
        let largest_sum = transport.row_sums(buffer).iter().fold(1.0, |m: f64, s| m.max(*s));
        // Coarse links may send more than there is.
        let reflectance = of_leaf.iter().map(|r| (r / largest_sum).min(0.9995)).collect();
        let system = System { transport: &transport, width: 1, reflectance, lit, largest_sum };
        let solved = match self.settings.bounces {
            Some(count) => system.bounces(count, buffer),
            None => system.solve(ROUGH, &Buffers::default()),
        };
        let total: Vec<f64> = solved.reflected.iter().zip(&emitted).map(|(x, e)| x + e).collect();
        let weighted: Vec<f64> = solved.reflected.iter().zip(&emitted).map(|(x, e)| x + LAMP * e).collect();
        let mut irradiance = vec![0.0; total.len()];
        transport.apply(&total, &mut irradiance, 1, buffer);
        irradiance.iter_mut().zip(&direct).for_each(|(e, d)| *e += d);
        let moment = |power| irradiance.iter().zip(&transport.areas).map(|(e, a)| a * e.powi(power)).sum::<f64>();
        let (flux, square) = (moment(1), moment(2));
        // Mean irradiance, each place weighted with its own.
        let typical = if flux > 0.0 { square / flux } else { 1.0 };
        let pull = |leaves: &[f64]| {
            let mut rows = Vec::new();
            transport.pull(leaves, 1, |_| 1.0, &mut rows);
            Values::new(rows, patches.nodes.len())
        };
        oracle.radiosity = pull(&weighted);
        oracle.irradiance = pull(&irradiance);
        oracle.irradiance.raise(DARKNESS * typical);
        oracle.reflectance = pull(&of_leaf);
        let squares: Vec<f64> = weighted.iter().map(|b| b * b).collect();
        let deviation = |(square, mean): (&f64, &f64)| (square - mean * mean).max(0.0).sqrt();
        oracle.uneven = pull(&squares).clusters.iter().zip(&oracle.radiosity.clusters).map(deviation).collect();
        flux / typical
    }
}
