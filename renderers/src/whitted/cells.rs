//! Where whole lights are certainly visible: planar surfaces in cells, and what is known of each cell and light.

use core::hash::BuildHasherDefault;
use std::collections::HashMap;

use glam::{DVec3, Vec3A};

use super::light::{AreaLight, AreaShape, Light, Receiver};
use crate::geometry::{Shaft, ShaftEnd, World};
use crate::spectral::PairHasher;

/// Voxels along the longest side of the scene, from coarse to fine: where the light is not visible from a whole coarse cell, it is asked
/// for again from the finer one.
const LEVELS: [u32; 2] = [16, 64];
/// Bits of a voxel's coordinate in a key.
const COORDINATE_BITS: u32 = 10;
/// A circle is within the regular polygon around it with this many corners.
const AROUND_DISK: u32 = 8;

/// The cells of a scene: where regular grids of voxels cut its planar primitives.
#[derive(Debug)]
pub(super) struct Cells {
    low: DVec3,
    /// Width of voxels, level by level.
    widths: [f64; LEVELS.len()],
    /// Whether the primitive is large enough to have cells that many receivers share.
    large: Vec<bool>,
    /// What shafts to each light end at; `None` for lights without area.
    ends: Vec<Option<ShaftEnd>>,
}

/// What one thread knows of the cells: whether the whole light is visible from the whole cell, light by light. It is found when it is first
/// asked for, from the scene alone, so that it doesn't matter who asks and when.
#[derive(Debug, Default)]
pub(super) struct ClearCells {
    lights: Vec<Known>,
}

type Key = (u32, u32);

#[derive(Clone, Debug, Default)]
struct Known {
    cells: HashMap<Key, bool, BuildHasherDefault<PairHasher>>,
    /// The cell that was last found, as neighbouring receivers are mostly in one.
    last: [Option<(Key, bool)>; LEVELS.len()],
}

impl Cells {
    /// The cells for a world and its lights.
    pub(super) fn new(world: &World, lights: &[Light]) -> Self {
        let [low, high] = world.bounds().map(Vec3A::as_dvec3);
        let longest = (high - low).max_element().max(f64::MIN_POSITIVE);
        let widths = LEVELS.map(|count| longest / f64::from(count));
        // A cell costs as much as the shadow rays of some receivers, which smaller primitives may not have.
        let least_area = widths[LEVELS.len() - 1].powi(2);
        let count = u32::try_from(world.len()).unwrap_or(u32::MAX);
        let large = (0..count).map(|primitive| world.area(primitive) >= least_area).collect();
        let end = |light: &Light| match light {
            Light::Area(area) => Some(shaft_end(area)),
            _ => None,
        };
        Self { low, widths, large, ends: lights.iter().map(end).collect() }
    }

    /// The voxel of a level that a point is in.
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "clamped to a few hundred")]
    fn voxel(&self, level: usize, position: DVec3) -> [u32; 3] {
        let last = f64::from(LEVELS[level] - 1);
        let place = (position - self.low) / self.widths[level];
        place.to_array().map(|x| x.clamp(0.0, last) as u32)
    }

    /// Whether certainly nothing is between a cell and a light.
    fn find(&self, world: &World, receiver: (u32, bool), level: usize, voxel: [u32; 3], light: usize) -> bool {
        let Some(to) = self.ends.get(light).and_then(Option::as_ref) else { return false };
        let width = self.widths[level];
        let low = self.low + DVec3::from_array(voxel.map(f64::from)) * width;
        let from = world.shaft_end(receiver.0, receiver.1, low, low + width);
        from.is_some_and(|from| world.shaft_is_clear(&Shaft::between(&from, to)))
    }
}

impl ClearCells {
    /// Whether a whole light is certainly visible from the receiver and its surroundings: `false` if that isn't known.
    pub(super) fn sees_whole(&mut self, cells: &Cells, world: &World, receiver: &Receiver, light: usize) -> bool {
        let primitive = receiver.point.primitive;
        let is_flat = receiver.normal == receiver.geometric;
        if !is_flat || !cells.large.get(primitive as usize).is_some_and(|large| *large) {
            return false;
        }
        if self.lights.len() <= light {
            self.lights.resize_with(light + 1, Known::default);
        }
        let front = receiver.geometric.dot(receiver.point.normal.as_dvec3()) > 0.0;
        (0..LEVELS.len()).any(|level| {
            let voxel = cells.voxel(level, receiver.position);
            let place = voxel.iter().fold(u32::try_from(level).unwrap_or(0), |key, x| key << COORDINATE_BITS | x);
            let key = (primitive << 1 | u32::from(front), place);
            let known = &mut self.lights[light];
            match known.last[level] {
                Some((last, clear)) if last == key => clear,
                _ => {
                    let find = || cells.find(world, (primitive, front), level, voxel, light);
                    let clear = *known.cells.entry(key).or_insert_with(find);
                    known.last[level] = Some((key, clear));
                    clear
                }
            }
        })
    }
}

/// The light as the end of shafts.
fn shaft_end(light: &AreaLight) -> ShaftEnd {
    match light.shape {
        AreaShape::Rectangle(flat) => {
            let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]].map(|c| flat.at(c));
            ShaftEnd::polygon(&corners, flat.normal, light.primitive)
        }
        AreaShape::Disk(flat) => {
            let step = core::f64::consts::TAU / f64::from(AROUND_DISK);
            let radius = 1.0 / (0.5 * step).cos();
            let corner = |i: u32| {
                let (sin, cos) = (step * f64::from(i)).sin_cos();
                flat.at([radius * cos, radius * sin])
            };
            let corners: Vec<DVec3> = (0..AROUND_DISK).map(corner).collect();
            ShaftEnd::polygon(&corners, flat.normal, light.primitive)
        }
        AreaShape::Sphere { centre, radius } => ShaftEnd::within(centre - radius, centre + radius, light.primitive),
    }
}
