//! Light from points and from far away on patches. Area lights are patches themselves.

use glam::DVec3;
use rayon::prelude::*;

use super::error::RadiosityError;
use super::mesh::{Node, Patches};
use super::scalar::luminous;
use super::sight::{Sight, point_is_hidden, shaft_end, spread, surface_point};
use crate::geometry::{NO_PRIMITIVE, Shaft, ShaftEnd};
use crate::scene::{Emitter, Scene};
use crate::spectral::{Factor, Palette, Role};

/// Rays that tell how much of a patch is lit.
const RAYS: u32 = 64;

/// A light without area.
#[derive(Clone, Copy, Debug)]
pub(super) struct Source {
    place: Place,
    /// Intensity, or irradiance across the light.
    pub(super) spectrum: Factor,
    /// Its luminous value.
    weight: f64,
}

#[derive(Clone, Copy, Debug)]
enum Place {
    At(DVec3),
    /// Light travels along this unit vector.
    Along(DVec3),
}

impl Source {
    /// The lights of a scene that have no area.
    pub(super) fn all(scene: &Scene, palette: &mut Palette) -> Result<Vec<Self>, RadiosityError> {
        let mut sources = Vec::new();
        for emitter in &scene.emitters {
            let (place, spectrum) = match emitter {
                Emitter::Point { position, intensity } => (Place::At(*position), *intensity),
                Emitter::Directional { direction, irradiance } => (Place::Along(*direction), *irradiance),
                Emitter::Area { .. } | Emitter::Ambient { .. } => continue,
                Emitter::Constant { label, .. } => return Err(RadiosityError::Light { label: label.clone() }),
            };
            let spectrum = palette.factor(scene.spectrum(spectrum), Role::Light);
            let weight = luminous(palette, spectrum).map_err(RadiosityError::Spectrum)?;
            sources.push(Self { place, spectrum, weight });
        }
        Ok(sources)
    }

    /// Mean irradiance on a patch that nothing shades, over intensity (or over irradiance).
    fn unshaded(&self, node: &Node) -> f64 {
        match self.place {
            Place::At(position) => node.polygon.solid_angle(position) / node.polygon.area,
            Place::Along(direction) => (-direction.dot(node.polygon.normal)).max(0.0),
        }
    }

    /// Variation of that over the patch, as a share of it.
    fn variation(&self, node: &Node) -> f64 {
        match self.place {
            Place::At(position) => {
                let height = (position - node.polygon.centre).dot(node.polygon.normal);
                let distance = (position - node.polygon.centre).length().max(height);
                (node.polygon.radius / distance).min(1.0)
            }
            Place::Along(_) => 0.0,
        }
    }

    fn sight(&self, patches: &Patches, node: &Node) -> Sight {
        let polygon = &node.polygon;
        let end = match self.place {
            Place::At(position) => ShaftEnd::within(position, position, NO_PRIMITIVE),
            Place::Along(direction) => {
                let [low, high] = patches.world.bounds().map(|b| b.as_dvec3());
                let away = -direction * ((high - low).length() * 1.01 + patches.slack);
                let corners: Vec<DVec3> = polygon.corners().iter().map(|c| *c + away).collect();
                ShaftEnd::polygon(&corners, direction, NO_PRIMITIVE)
            }
        };
        if patches.world.shaft_is_clear(&Shaft::between(&shaft_end(polygon, node.primitive), &end)) {
            return Sight::Clear;
        }
        let from = surface_point(polygon.centre, polygon.normal, node.primitive);
        let (ray, far) = match self.place {
            Place::At(position) => (from.ray_to(position.as_vec3a()), vec![position]),
            Place::Along(direction) => {
                let [low, high] = patches.world.bounds().map(|b| b.as_dvec3());
                let away = -direction * (high - low).length();
                let far = polygon.corners().iter().map(|c| *c + away).collect();
                (from.ray((-direction).as_vec3a()), far)
            }
        };
        let blocker = patches.world.closest_hit(&ray).map_or(NO_PRIMITIVE, |hit| hit.primitive);
        match self.place {
            Place::At(_) => patches.sight_past(blocker, polygon.corners(), &far),
            // Parallel ways: each corner to its own copy.
            Place::Along(_) => {
                let each = polygon.corners().iter().zip(&far);
                let mut sights = each.map(|(a, b)| patches.sight_past(blocker, &[*a], &[*b]));
                if sights.all(|s| s == Sight::Blocked) { Sight::Blocked } else { Sight::Mixed }
            }
        }
    }

    fn is_hidden(&self, patches: &Patches, node: &Node, place: DVec3) -> bool {
        match self.place {
            Place::At(position) => point_is_hidden(&patches.world, node, place, position),
            Place::Along(direction) => {
                let from = surface_point(place, node.polygon.normal, node.primitive);
                patches.world.occluded_direction(&from, (-direction).as_vec3a())
            }
        }
    }

    /// Mean irradiance on a patch over intensity (or irradiance).
    fn irradiance(&self, patches: &Patches, node: &Node) -> f64 {
        let unshaded = self.unshaded(node);
        if unshaded <= 0.0 {
            return 0.0;
        }
        match self.sight(patches, node) {
            Sight::Clear => unshaded,
            Sight::Blocked => 0.0,
            Sight::Mixed => {
                let mut lit = 0;
                for index in 0..RAYS {
                    let [u, v, ..] = spread(index);
                    lit += u32::from(!self.is_hidden(patches, node, node.polygon.point([u, v])));
                }
                unshaded * f64::from(lit) / f64::from(RAYS)
            }
        }
    }

    /// The luminous flux that is put in the wrong place, about, when a patch counts as evenly lit.
    fn error(&self, patches: &Patches, node: &Node) -> f64 {
        let flux = self.unshaded(node) * node.polygon.area * self.weight;
        if flux <= 0.0 {
            return 0.0;
        }
        match self.sight(patches, node) {
            Sight::Clear => flux * self.variation(node),
            Sight::Blocked => 0.0,
            Sight::Mixed => flux,
        }
    }
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
    let on = |node: &Node| sources.iter().map(|s| s.unshaded(node) * node.polygon.area * s.weight).sum::<f64>();
    patches.nodes[..patches.roots].iter().map(on).sum()
}
