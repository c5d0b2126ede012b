//! Light from points and from far away on patches. Area lights are patches themselves.

use glam::{DVec3, Vec3A};
use rayon::prelude::*;

use super::error::RadiosityError;
use super::exchange::over_points;
use super::mesh::{Node, Patches};
use super::polygon::Polygon;
use super::scalar::luminous;
use super::shade::{Eye, MOST_BLOCKERS};
use super::sight::{shaft_end, spread, surface_point};
use crate::geometry::{NO_PRIMITIVE, Shaft, ShaftEnd};
use crate::luminaire::PlacedLuminaire;
use crate::scene::{Emitter, Scene};
use crate::spectral::{Factor, Palette, Role};

/// Points that tell how much of a patch is lit where that has no closed form.
const RAYS: u32 = 64;
/// Nodes a side of the rule for luminaires.
const NODES: usize = 3;

/// A light without area.
#[derive(Clone, Debug)]
pub(super) struct Source {
    eye: Eye,
    /// For luminaires: luminous intensity in cd by direction.
    luminaire: Option<PlacedLuminaire>,
    /// Intensity (for each candela, for luminaires), or irradiance across the light.
    pub(super) spectrum: Factor,
    /// Its luminous value.
    weight: f64,
}

/// What is known of the ways from a source to a patch.
enum Ways {
    Clear,
    /// These primitives may be in the way, and no others.
    Few(Vec<u32>),
    Many,
}

impl Source {
    /// The lights of a scene that have no area.
    pub(super) fn all(scene: &Scene, palette: &mut Palette) -> Result<Vec<Self>, RadiosityError> {
        let mut sources = Vec::new();
        for emitter in &scene.emitters {
            let (eye, spectrum, luminaire) = match emitter {
                Emitter::Point { position, intensity } => (Eye::At(*position), *intensity, None),
                Emitter::Directional { direction, irradiance } => (Eye::Along(*direction), *irradiance, None),
                Emitter::Luminaire { luminaire, spectrum, .. } => {
                    (Eye::At(luminaire.position), *spectrum, Some(luminaire.clone()))
                }
                Emitter::Area { .. } | Emitter::Ambient { .. } => continue,
                Emitter::Constant { label, .. } => return Err(RadiosityError::Light { label: label.clone() }),
            };
            let spectrum = palette.factor(scene.spectrum(spectrum), Role::Light);
            let weight = luminous(palette, spectrum).map_err(RadiosityError::Spectrum)?;
            sources.push(Self { eye, luminaire, spectrum, weight });
        }
        Ok(sources)
    }

    /// Mean irradiance on a polygon that nothing shades times its area, over intensity (or over irradiance).
    fn unshaded(&self, polygon: &Polygon) -> f64 {
        match (self.eye, &self.luminaire) {
            (Eye::At(position), None) => polygon.solid_angle(position),
            (Eye::At(position), Some(luminaire)) => {
                let angle = polygon.solid_angle(position);
                if angle > 0.0 { angle * mean_candela(polygon, luminaire)[0] } else { 0.0 }
            }
            (Eye::Along(direction), _) => polygon.area * (-direction.dot(polygon.normal)).max(0.0),
        }
    }

    /// Variation of that over a polygon, as a share of it.
    fn variation(&self, polygon: &Polygon) -> f64 {
        match (self.eye, &self.luminaire) {
            (Eye::Along(_), _) => 0.0,
            (Eye::At(position), luminaire) => {
                let smooth = polygon.radius / (position - polygon.centre).length();
                let [mean, range] = luminaire.as_ref().map_or([1.0, 0.0], |l| mean_candela(polygon, l));
                (smooth + if mean > 0.0 { range / mean } else { 1.0 }).min(1.0)
            }
        }
    }

    fn ways(&self, patches: &Patches, node: &Node) -> Ways {
        let polygon = &node.polygon;
        let end = match self.eye {
            Eye::At(position) => ShaftEnd::within(position, position, NO_PRIMITIVE),
            Eye::Along(direction) => {
                // A copy of the patch beyond everything.
                let [low, high] = patches.world.bounds().map(Vec3A::as_dvec3);
                let away = -direction * ((high - low).length() * 1.01 + patches.slack);
                let corners: Vec<DVec3> = polygon.corners().iter().map(|c| *c + away).collect();
                ShaftEnd::polygon(&corners, direction, NO_PRIMITIVE)
            }
        };
        let shaft = Shaft::between(&shaft_end(polygon, node.primitive), &end);
        match patches.world.shaft_blockers(&shaft, MOST_BLOCKERS, false) {
            Some(blockers) if blockers.is_empty() => Ways::Clear,
            Some(blockers) => Ways::Few(blockers),
            None => Ways::Many,
        }
    }

    /// What of [`unshaded`](Self::unshaded) arrives.
    fn arriving(&self, patches: &Patches, node: &Node, ways: &Ways) -> f64 {
        let unshaded = self.unshaded(&node.polygon);
        if unshaded <= 0.0 {
            return 0.0;
        }
        let parts = match ways {
            Ways::Clear => return unshaded,
            Ways::Few(blockers) => patches.seen_parts(&node.polygon, self.eye, blockers),
            Ways::Many => None,
        };
        if let Some(parts) = parts {
            return parts.iter().map(|part| self.unshaded(part)).sum();
        }
        let lit = (0..RAYS).filter(|index| {
            let [u, v, ..] = spread(*index);
            let from = surface_point(node.polygon.point([u, v]), node.polygon.normal, node.primitive);
            !match self.eye {
                Eye::At(position) => patches.world.occluded_point(&from, position.as_vec3a()),
                Eye::Along(direction) => patches.world.occluded_direction(&from, (-direction).as_vec3a()),
            }
        });
        unshaded * f64::from(u32::try_from(lit.count()).unwrap_or(0)) / f64::from(RAYS)
    }

    /// Mean irradiance on a patch over intensity (or irradiance).
    pub(super) fn irradiance(&self, patches: &Patches, node: &Node) -> f64 {
        if self.unshaded(&node.polygon) <= 0.0 {
            return 0.0;
        }
        self.arriving(patches, node, &self.ways(patches, node)) / node.polygon.area
    }

    /// The luminous flux that is put in the wrong place, about, when a patch counts as evenly lit.
    fn error(&self, patches: &Patches, node: &Node) -> f64 {
        let unshaded = self.unshaded(&node.polygon);
        if unshaded <= 0.0 {
            return 0.0;
        }
        let ways = self.ways(patches, node);
        let arriving = self.arriving(patches, node, &ways);
        // Light and shadow on one patch: as much is in the wrong place as either has, at most.
        let shadow = arriving.min(unshaded - arriving).max(0.0);
        let unknown = if matches!(ways, Ways::Many) { 0.125 * unshaded } else { 0.0 };
        (arriving * self.variation(&node.polygon)).max(shadow).max(unknown) * self.weight
    }
}

/// Mean over a polygon of a luminaire's intensity in cd, each direction weighted by its share of the solid angle, and the range.
fn mean_candela(polygon: &Polygon, luminaire: &PlacedLuminaire) -> [f64; 2] {
    let (mut sum, mut all) = (0.0, 0.0);
    let (mut low, mut high) = (f64::INFINITY, 0.0_f64);
    over_points(polygon, NODES, |x, w| {
        let way = x - luminaire.position;
        let squared = way.length_squared();
        let weight = w * way.dot(polygon.normal).abs() / (squared * squared.sqrt());
        let candela = luminaire.candela(way);
        (low, high) = (low.min(candela), high.max(candela));
        sum += weight * candela;
        all += weight;
        0.0
    });
    if all > 0.0 { [sum / all, high - low] } else { [0.0; 2] }
}

/// Splits leaves where they are unevenly lit: where the flux they reflect that is in the wrong place is more than `most`.
pub(super) fn refine(patches: &mut Patches, sources: &[Source], reflectance: &[f64], most: f64) {
    let mut open: Vec<usize> = patches.leaves().collect();
    while !open.is_empty() {
        let known = &*patches;
        let uneven = |index: &usize| {
            let node = &known.nodes[*index];
            let error: f64 = sources.iter().map(|s| s.error(known, node)).sum();
            error * reflectance[node.side as usize] > most
        };
        let split: Vec<usize> = open.into_par_iter().filter(uneven).collect();
        open = Vec::new();
        for node in split {
            if patches.split(node) {
                open.extend(patches.nodes[node].children().into_iter().flatten());
            }
        }
    }
}

/// For each leaf and each source, the mean irradiance over intensity (or irradiance); row by row.
pub(super) fn irradiances(patches: &Patches, sources: &[Source], leaves: &[u32]) -> Vec<f64> {
    let of_leaf = |leaf: &u32| {
        let node = &patches.nodes[*leaf as usize];
        sources.iter().map(move |s| s.irradiance(patches, node)).collect::<Vec<f64>>()
    };
    leaves.par_iter().flat_map_iter(of_leaf).collect()
}

/// Luminous irradiance on each leaf, from the values of [`irradiances`].
pub(super) fn luminous_irradiances(sources: &[Source], values: &[f64], leaves: usize) -> Vec<f64> {
    if sources.is_empty() {
        return vec![0.0; leaves];
    }
    values.chunks(sources.len()).map(|row| row.iter().zip(sources).map(|(v, s)| v * s.weight).sum()).collect()
}

/// The luminous flux of all sources on the patches, at most: what the roots would receive unshaded.
pub(super) fn luminous_flux(patches: &Patches, sources: &[Source]) -> f64 {
    let on = |node: &Node| sources.iter().map(|s| s.unshaded(&node.polygon) * s.weight).sum::<f64>();
    patches.nodes[..patches.roots].iter().map(on).sum()
}
