//! Irradiance at any place from the patches: each in closed form up to 512 polygons; of more, those that are near.

use core::cell::RefCell;

use disk_sampling::Receiver;
use glam::DVec3;

use super::Solution;
use super::mesh::{Node, Patches};
use super::polygon::Polygon;
use super::shade::{Cone, Eye, MOST_BLOCKERS};
use super::sight::{Sight, shaft_end, spread, surface_point};
use crate::geometry::{Shaft, ShaftEnd, SurfacePoint};

/// How finely patches that are partly seen are split for that.
const DEPTH: u32 = 24;
/// Rays for a part that is too small to be split.
const RAYS: u32 = 4;
/// Patches that may be taken for one are those that change the result by less than this share of the accuracy each.
const SHARE: f64 = 0.01;

/// Leaves that give more than this share of what is received, times the root of the accuracy, are near.
const LARGE: f64 = 8e-3;
/// Their parts give at most so many times that.
const PARTS: f64 = 2.0;
/// How much more the unevenness of what is partly hidden counts: what is hidden is rarely like what is seen.
const PARTLY: f64 = 4.0;

/// What counting far faces by rays may add to the error at a place, as a share of the accuracy.
pub(super) const TOLERANCE: f64 = 0.2;

/// A receiver, ready for rays.
pub(super) struct Place<'s> {
    pub(super) patches: &'s Patches,
    pub(super) position: DVec3,
    pub(super) normal: DVec3,
    pub(super) point: SurfacePoint,
    end: ShaftEnd,
    /// What the faces hide that were looked at so far.
    cones: RefCell<Vec<(u32, Cone)>>,
}

impl<'s> Place<'s> {
    pub(super) fn new(patches: &'s Patches, receiver: &Receiver<f64>) -> Self {
        let (position, normal) = (DVec3::from_array(receiver.position()), DVec3::from_array(receiver.normal()));
        Self::on(patches, position, normal, patches.primitive_at(position, normal))
    }

    /// A place on a primitive.
    pub(super) fn on(patches: &'s Patches, position: DVec3, normal: DVec3, primitive: u32) -> Self {
        let point = surface_point(position, normal, primitive);
        Self {
            patches,
            position,
            normal,
            point,
            end: ShaftEnd::within(position, position, primitive),
            cones: RefCell::default(),
        }
    }

    /// The configuration factor of a polygon that nothing hides: 0 from behind or from its plane.
    pub(super) fn factor(&self, polygon: &Polygon) -> f64 {
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

    /// Those of some blockers that may be in the way of a part of what they were found for.
    fn among(&self, blockers: &[u32], polygon: &Polygon) -> Vec<u32> {
        blockers.iter().copied().filter(|blocker| self.may_hide(*blocker, polygon)).collect()
    }

    fn may_hide(&self, blocker: u32, polygon: &Polygon) -> bool {
        let Some(face) = self.patches.face.get(blocker as usize) else { return true };
        let known = self.cones.borrow().iter().position(|(of, _)| of == face);
        let index = known.unwrap_or_else(|| {
            let cone = Cone::new(Eye::At(self.position), &self.patches.blockers[*face as usize]);
            self.cones.borrow_mut().push((*face, cone));
            self.cones.borrow().len() - 1
        });
        self.cones.borrow()[index].1.may_reach(polygon, self.patches.slack)
    }

    /// Whether one of some blockers hides all of a polygon; without a list, whichever is before its middle.
    fn is_behind_one(&self, polygon: &Polygon, primitive: u32, blockers: Option<&[u32]>) -> bool {
        let Some(blockers) = blockers else { return self.is_hidden(polygon, primitive) };
        let hides = |b: &u32| self.patches.sight_past(*b, &[self.position], polygon.corners()) == Sight::Blocked;
        blockers.iter().any(hides)
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
pub(super) struct Look<'l> {
    pub(super) place: &'l Place<'l>,
    /// Radiosity relative to the scene's mean times configuration factor: what is less than this is small.
    pub(super) small: f64,
    /// The same: leaves that give more than this and are near are looked at again.
    pub(super) large: f64,
}

/// The configuration factor of what is seen of something with a radiosity.
#[derive(Clone, Copy, Debug)]
pub(super) enum Entry {
    /// Of a patch or a group of them.
    Node(u32, f64),
    /// Counted for a point of a patch.
    Point(u32, f64),
}

impl Solution<'_> {
    /// Indirect irradiance at a place: that of light which surfaces have reflected diffusely at least once. One value for each
    /// component of the spectrum, in the unit of the lights' radiance times sr.
    ///
    /// Up to 512 polygons, the patches' configuration factors are exact where nothing blocks, so that the result is exact under patches of uniform
    /// radiosity; of more, far ones are counted by rays ([`indirect_within`](Self::indirect_within)). Groups of patches count as one where that
    /// changes little for the accuracy that was asked for. Where something may block and the number of reflections isn't limited, radiosity is
    /// linear on near patches, and computed at points of theirs as here ([`Settings::points`]).
    ///
    /// The largest relative error at 48 places of the Cornell box, 22 of which are in narrow gaps, in deep shade and 3 to 5 mm beside contacts:
    /// 1.5 % at an accuracy of 0.01, 2 % at 0.003 (0.5 % at all but one) and 0.6 % at 0.001 (0.3 % at all but one).
    /// At 0.05 and coarser, patches may be larger than shadows on them: a place 1 cm above the floor, beside a block and in its shadow, gets up to
    /// three times its light (`spectral trade radiosity`).
    ///
    /// [`Settings::points`]: super::Settings::points
    #[must_use]
    pub fn indirect(&self, receiver: &Receiver<f64>) -> Vec<f64> {
        self.indirect_within(receiver, TOLERANCE * self.radiosity.settings.accuracy)
    }

    /// The same with a tolerance for what [`indirect`](Self::indirect) has a fifth of the accuracy for: where there are more than 512 faces, those
    /// that are close, nearer than a quarter of their radius, and give more than 3 % of the light are seen in closed form, all others by as many
    /// rays (512 to 65 536) as leave a standard error of at most this share of the light, estimated from eight parts of the rays. Less light than
    /// 1 % of that under the scene's mean radiosity counts as 1 %. Where the most rays are too few, and with a tolerance of 0 or what isn't
    /// positive, every face is seen in closed form, which takes as long as there are faces; an infinite tolerance means 512 rays.
    ///
    /// Among more than 512 faces, light from patches that are small and far brighter than the mean may be missed: rays that don't meet them tell
    /// nothing of the error that this is. A tolerance of 0 misses none.
    #[must_use]
    pub fn indirect_within(&self, receiver: &Receiver<f64>, tolerance: f64) -> Vec<f64> {
        let place = Place::new(&self.radiosity.patches, receiver);
        let mut sum = vec![0.0; self.width];
        self.add_entries(&self.look(&place, SHARE, tolerance.max(0.0)), &mut sum);
        sum
    }

    /// Where the light at a place comes from; a tolerance for far faces where these are many.
    pub(super) fn look(&self, place: &Place<'_>, share: f64, tolerance: f64) -> Vec<Entry> {
        let patches = &self.radiosity.patches;
        if !patches.clusters.is_empty() {
            return self.look_far(place, share, tolerance);
        }
        let mut list = Vec::new();
        let roots = 0..patches.roots;
        // What the roots as a whole would give tells what is small.
        let whole: f64 = roots.clone().map(|root| place.factor(&patches.nodes[root].polygon) * self.levels[root]).sum();
        if whole > 0.0 {
            let look = self.at_first(place, share, whole);
            roots.for_each(|root| self.add(&look, root, None, &mut list));
        }
        list
    }

    /// How a place is looked at that receives about so much.
    pub(super) fn at_first<'l>(&self, place: &'l Place<'l>, share: f64, whole: f64) -> Look<'l> {
        let accuracy = self.radiosity.settings.accuracy;
        let large = if self.polished.is_empty() { f64::INFINITY } else { LARGE * accuracy.sqrt() * whole };
        Look { place, small: accuracy * share * whole, large }
    }

    /// Adds the light that a list stands for.
    pub(super) fn add_entries(&self, list: &[Entry], sum: &mut [f64]) {
        for entry in list {
            let (row, factor) = match *entry {
                Entry::Node(node, factor) => (&self.nodes[node as usize * self.width..][..self.width], factor),
                Entry::Point(point, factor) => (self.polished.row(point, self.width), factor),
            };
            sum.iter_mut().zip(row).for_each(|(s, b)| *s += factor * b);
        }
    }

    /// Multiplies irradiance by the reflectance of a side.
    pub(super) fn reflect(&self, side: u32, row: &mut [f64]) {
        self.representation.reflect(self.radiosity.patches.sides[side as usize].reflectance, row);
    }

    /// Adds the light of lamps at a place.
    pub(super) fn add_lamps(&self, place: &Place<'_>, sum: &mut [f64]) {
        let patches = &self.radiosity.patches;
        for lamp in patches.lamps.iter().map(|root| &patches.nodes[*root as usize]) {
            let factor = place.factor(&lamp.polygon);
            if factor > 0.0 {
                let blockers = place.blockers(&lamp.polygon, lamp.primitive);
                let least = self.radiosity.settings.accuracy * factor;
                let seen = place.seen_factor(&lamp.polygon, lamp.primitive, blockers.as_deref(), least, DEPTH);
                let row = &self.lights.emission[lamp.side as usize * self.width..][..self.width];
                sum.iter_mut().zip(row).for_each(|(s, l)| *s += seen * l);
            }
        }
    }

    /// Adds what a group of patches gives; what may hide the group that it is a part of may be known.
    pub(super) fn add(&self, look: &Look<'_>, index: usize, known: Option<&[u32]>, list: &mut Vec<Entry>) {
        let (place, small) = (look.place, look.small);
        let node: &Node = &self.radiosity.patches.nodes[index];
        if !(self.levels[index] > 0.0) {
            return;
        }
        let factor = place.factor(&node.polygon);
        if !(factor > 0.0) {
            return;
        }
        let blockers = match known {
            Some(known) => Some(place.among(known, &node.polygon)),
            None => place.blockers(&node.polygon, node.primitive),
        };
        let clear = blockers.as_ref().is_some_and(Vec::is_empty);
        if !clear && place.is_behind_one(&node.polygon, node.primitive, blockers.as_deref()) {
            return;
        }
        let varies = match blockers {
            // With few blockers the parts that are seen are known.
            Some(_) => self.spreads[index] * if clear { 1.0 } else { PARTLY },
            None => self.spreads[index] + self.levels[index],
        };
        if let Some(children) = node.children()
            && factor * varies > small
        {
            children.into_iter().for_each(|child| self.add(look, child, blockers.as_deref(), list));
            return;
        }
        let least = small / (self.levels[index] + self.spreads[index]);
        if node.children().is_none() && factor * self.levels[index] > look.large {
            let first = list.len();
            self.add_near(look, index, &node.polygon, blockers.as_deref(), least, list);
            sum_up(list, first);
            return;
        }
        let seen = if clear {
            factor
        } else {
            place.seen_factor(&node.polygon, node.primitive, blockers.as_deref(), least, DEPTH)
        };
        if seen > 0.0 {
            list.push(Entry::Node(u32::try_from(index).unwrap_or(0), seen));
        }
    }

    /// Lists the parts of a near leaf.
    fn add_near(
        &self,
        look: &Look<'_>,
        node: usize,
        part: &Polygon,
        known: Option<&[u32]>,
        least: f64,
        list: &mut Vec<Entry>,
    ) {
        let factor = look.place.factor(part);
        if factor * self.levels[node] > PARTS * look.large
            && let Some(halves) = part.halves()
        {
            halves.iter().for_each(|half| self.add_near(look, node, half, known, least, list));
            return;
        }
        let primitive = self.radiosity.patches.nodes[node].primitive;
        let blockers = match known {
            Some(known) => Some(look.place.among(known, part)),
            None => look.place.blockers(part, primitive),
        };
        let seen = match blockers.as_deref() {
            Some([]) => factor,
            blockers => look.place.seen_factor(part, primitive, blockers, least, DEPTH),
        };
        if seen > 0.0
            && let Some(stencil) = self.polished.stencil(node)
        {
            list.extend(stencil.at(part.centre).map(|(point, weight)| Entry::Point(point, seen * weight)));
        }
    }
}

/// Adds up the factors of each point from an index of a list on, where there are few points.
fn sum_up(list: &mut Vec<Entry>, first: usize) {
    let mut sums: Vec<(u32, f64)> = Vec::new();
    for entry in list.drain(first..) {
        if let Entry::Point(point, factor) = entry {
            match sums.iter_mut().find(|(other, _)| *other == point) {
                Some((_, sum)) => *sum += factor,
                None => sums.push((point, factor)),
            }
        }
    }
    list.extend(sums.into_iter().map(|(point, sum)| Entry::Point(point, sum)));
}
