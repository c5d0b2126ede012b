//! Irradiance at any place from the patches, each in closed form.

use disk_sampling::Receiver;
use glam::DVec3;

use super::Solution;
use super::mesh::{Node, Patches};
use super::polygon::Polygon;
use super::shade::{Eye, MOST_BLOCKERS};
use super::sight::{Sight, shaft_end, spread, surface_point};
use crate::geometry::{Shaft, ShaftEnd, SurfacePoint};

/// How finely patches that are partly seen are split for that.
const DEPTH: u32 = 24;
/// Rays for a part that is too small to be split.
const RAYS: u32 = 4;
/// Patches that may be taken for one are those that change the result by less than this share of the accuracy each.
const SHARE: f64 = 0.01;

/// The same for what near patches receive.
const SHARE_AGAIN: f64 = 0.3;
/// Leaves that give more than this share of what is received are near.
const LARGE: f64 = 2e-3;
/// Their parts give at most so many times that.
const PARTS: f64 = 4.0;

/// A receiver, ready for rays.
pub(super) struct Place<'s> {
    patches: &'s Patches,
    position: DVec3,
    normal: DVec3,
    point: SurfacePoint,
    end: ShaftEnd,
}

impl<'s> Place<'s> {
    pub(super) fn new(patches: &'s Patches, receiver: &Receiver<f64>) -> Self {
        let (position, normal) = (DVec3::from_array(receiver.position()), DVec3::from_array(receiver.normal()));
        Self::on(patches, position, normal, patches.primitive_at(position, normal))
    }

    /// A place on a primitive.
    fn on(patches: &'s Patches, position: DVec3, normal: DVec3, primitive: u32) -> Self {
        let point = surface_point(position, normal, primitive);
        Self { patches, position, normal, point, end: ShaftEnd::within(position, position, primitive) }
    }

    /// The configuration factor of a polygon that nothing hides: 0 from behind or from its plane.
    fn factor(&self, polygon: &Polygon) -> f64 {
        let height = (self.position - polygon.centre).dot(polygon.normal);
        if height <= 10.0 * self.patches.slack {
            return 0.0;
        }
        polygon.configuration_factor(self.position, self.normal)
    }

    /// Whether one blocker hides all of a polygon.
    fn is_hidden(&self, polygon: &Polygon, primitive: u32) -> bool {
        let to = surface_point(polygon.centre, polygon.normal, primitive);
        let hit = self.patches.world.closest_hit(&self.point.ray_between(&to));
        hit.is_some_and(|hit| {
            self.patches.sight_past(hit.primitive, &[self.position], polygon.corners()) == Sight::Blocked
        })
    }

    /// What may be in the way of a polygon; `None` if that is much.
    fn blockers(&self, polygon: &Polygon, primitive: u32) -> Option<Vec<u32>> {
        let shaft = Shaft::between(&self.end, &shaft_end(polygon, primitive));
        let mut blockers = self.patches.world.shaft_blockers(&shaft, MOST_BLOCKERS, false)?;
        // Those first that may hide all of it.
        let area = |primitive: &u32| self.patches.world.area(*primitive);
        blockers.sort_by(|a, b| area(b).total_cmp(&area(a)));
        Some(blockers)
    }

    /// The configuration factor of the parts of a polygon that are seen among so many blockers.
    fn seen_factor(&self, polygon: &Polygon, primitive: u32, blockers: Option<&[u32]>, least: f64, depth: u32) -> f64 {
        let parts = blockers.and_then(|found| self.patches.seen_parts(polygon, Eye::At(self.position), found));
        if let Some(parts) = parts {
            return parts.iter().map(|part| part.configuration_factor(self.position, self.normal)).sum();
        }
        let factor = self.factor(polygon);
        if factor > least
            && depth > 0
            && let Some(halves) = polygon.halves()
        {
            let half = |half: &Polygon| {
                let blockers = self.blockers(half, primitive);
                self.seen_factor(half, primitive, blockers.as_deref(), least, depth - 1)
            };
            return halves.iter().map(half).sum();
        }
        let seen = (0..RAYS).filter(|index| {
            let [u, v, ..] = spread(*index);
            let to = surface_point(polygon.point([u, v]), polygon.normal, primitive);
            !self.patches.world.occluded(&self.point, &to)
        });
        factor * f64::from(u32::try_from(seen.count()).unwrap_or(0)) / f64::from(RAYS)
    }
}

/// How a place is looked at.
struct Look<'l> {
    place: &'l Place<'l>,
    /// Radiosity relative to the scene's mean times configuration factor: what is less than this is small.
    small: f64,
    /// The same: leaves that give more than this and are near are looked at again.
    large: f64,
}

/// A part of a near leaf, with the configuration factor of what is seen of it.
struct Near {
    polygon: Polygon,
    node: usize,
    seen: f64,
}

impl Solution<'_> {
    /// Indirect irradiance at a place: that of light which surfaces have reflected diffusely at least once. One value for each
    /// component of the spectrum, in the unit of the lights' radiance times sr.
    ///
    /// The patches' configuration factors are exact where nothing blocks, so that the result is exact under patches of uniform radiosity;
    /// groups of patches count as one where that changes little for the accuracy that was asked for. The radiosity of near patches is
    /// computed anew from what all others send to them, part by part, where something may block and the number of reflections isn't limited
    /// (M. C. Reichert,
    /// "A two-pass radiosity method driven by lights and viewer position", Cornell University, 1992).
    #[must_use]
    pub fn indirect(&self, receiver: &Receiver<f64>) -> Vec<f64> {
        let place = Place::new(&self.radiosity.patches, receiver);
        let settings = &self.radiosity.settings;
        // Where nothing blocks, the means over patches are as good and keep all light.
        let again = settings.bounces.is_none() && self.radiosity.uncertain > 0;
        let (mut sum, near) = self.look(&place, SHARE, if again { LARGE } else { f64::INFINITY });
        for part in near {
            let radiosity = self.radiosity_of(&part);
            sum.iter_mut().zip(radiosity).for_each(|(s, b)| *s += part.seen * b);
        }
        sum
    }

    /// Irradiance at a place, without that of the near parts.
    fn look(&self, place: &Place<'_>, share: f64, large: f64) -> (Vec<f64>, Vec<Near>) {
        let (mut sum, mut near) = (vec![0.0; self.width], Vec::new());
        let nodes = &self.radiosity.patches.nodes;
        let roots = 0..self.radiosity.patches.roots;
        // What the roots as a whole would give tells what is small.
        let whole: f64 = roots.clone().map(|root| place.factor(&nodes[root].polygon) * self.levels[root]).sum();
        let look = Look { place, small: self.radiosity.settings.accuracy * share * whole, large: large * whole };
        if whole > 0.0 {
            for root in roots {
                self.add(&look, root, false, &mut sum, &mut near);
            }
        }
        (sum, near)
    }

    /// The reflected radiosity of a part of a leaf: its mean light from sources, the rest as it is in its middle.
    fn radiosity_of(&self, part: &Near) -> Vec<f64> {
        let radiosity = self.radiosity;
        let patches = &radiosity.patches;
        let node = Node { polygon: part.polygon, ..patches.nodes[part.node] };
        let place = Place::on(patches, node.polygon.centre, node.polygon.normal, node.primitive);
        let (mut sum, _) = self.look(&place, SHARE_AGAIN, f64::INFINITY);
        let mut add = |factor: f64, row: &[f64]| sum.iter_mut().zip(row).for_each(|(s, l)| *s += factor * l);
        for (source, spectrum) in radiosity.sources.iter().zip(self.lights.sources.chunks(self.width)) {
            add(source.irradiance(patches, &node), spectrum);
        }
        for lamp in patches.nodes[..patches.roots].iter().filter(|n| patches.sides[n.side as usize].emission.is_some())
        {
            let factor = place.factor(&lamp.polygon);
            if factor > 0.0 {
                let blockers = place.blockers(&lamp.polygon, lamp.primitive);
                let least = radiosity.settings.accuracy * factor;
                let seen = place.seen_factor(&lamp.polygon, lamp.primitive, blockers.as_deref(), least, DEPTH);
                add(seen, &self.lights.emission[lamp.side as usize * self.width..][..self.width]);
            }
        }
        self.representation.reflect(patches.sides[node.side as usize].reflectance, &mut sum);
        sum
    }

    /// Adds what a group of patches gives; whether it is certain that nothing hides it is known or not.
    fn add(&self, look: &Look<'_>, index: usize, clear: bool, sum: &mut [f64], near: &mut Vec<Near>) {
        let (place, small) = (look.place, look.small);
        let node: &Node = &self.radiosity.patches.nodes[index];
        if !(self.levels[index] > 0.0) {
            return;
        }
        let factor = place.factor(&node.polygon);
        if !(factor > 0.0) {
            return;
        }
        let blockers = if clear { Some(Vec::new()) } else { place.blockers(&node.polygon, node.primitive) };
        let clear = blockers.as_ref().is_some_and(Vec::is_empty);
        if !clear && place.is_hidden(&node.polygon, node.primitive) {
            return;
        }
        let varies = match blockers {
            // With few blockers the parts that are seen are known.
            Some(_) => self.spreads[index],
            None => self.spreads[index] + self.levels[index],
        };
        if let Some(children) = node.children()
            && factor * varies > small
        {
            children.into_iter().for_each(|child| self.add(look, child, clear, sum, near));
            return;
        }
        let least = small / (self.levels[index] + self.spreads[index]);
        if node.children().is_none() && factor * self.levels[index] > look.large {
            self.add_near(look, index, &node.polygon, least, near);
            return;
        }
        let seen = if clear {
            factor
        } else {
            place.seen_factor(&node.polygon, node.primitive, blockers.as_deref(), least, DEPTH)
        };
        let radiosity = &self.nodes[index * self.width..][..self.width];
        sum.iter_mut().zip(radiosity).for_each(|(s, b)| *s += seen * b);
    }

    /// Lists the parts of a near leaf.
    fn add_near(&self, look: &Look<'_>, node: usize, polygon: &Polygon, least: f64, near: &mut Vec<Near>) {
        let factor = look.place.factor(polygon);
        if factor * self.levels[node] > PARTS * look.large
            && let Some(halves) = polygon.halves()
        {
            halves.iter().for_each(|half| self.add_near(look, node, half, least, near));
            return;
        }
        let primitive = self.radiosity.patches.nodes[node].primitive;
        let blockers = look.place.blockers(polygon, primitive);
        let seen = look.place.seen_factor(polygon, primitive, blockers.as_deref(), least, DEPTH);
        if seen > 0.0 {
            near.push(Near { polygon: *polygon, node, seen });
        }
    }
}
