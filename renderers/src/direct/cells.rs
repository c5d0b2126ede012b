//! Where whole lights are certainly visible: planar surfaces in cells, and what is known of each cell and light.

use core::hash::BuildHasherDefault;
use std::collections::HashMap;

use glam::{DVec3, Vec3A};

use super::light::{Light, Surroundings};
use super::source::{Receiver, Shape, Source};
use super::visible::Cover;
use crate::geometry::{Shaft, ShaftEnd, World};
use crate::spectral::PairHasher;

/// Voxels along the longest side of the scene, from coarse to fine: where the light is not visible from a whole coarse cell, it is asked
/// for again from the finer one.
const LEVELS: [u32; 2] = [16, 64];
/// Bits of a voxel's coordinate in a key.
const COORDINATE_BITS: u32 = 10;
/// A cell with more surfaces in the way than these is not known, level by level: finer ones have fewer.
const MOST_BLOCKERS: [usize; LEVELS.len()] = [0, 32];
/// A circle is within the regular polygon around it with this many corners.
const AROUND_DISK: u32 = 8;

/// The cells of a scene: where regular grids of voxels cut its planar primitives.
#[derive(Debug)]
pub(crate) struct Cells {
    low: DVec3,
    /// Width of voxels, level by level.
    widths: [f64; LEVELS.len()],
    /// Whether the primitive is large enough to have cells that many receivers share.
    large: Vec<bool>,
    /// What shafts to each light end at; `None` for lights without area.
    ends: Vec<Option<ShaftEnd>>,
}

/// What one thread knows of the cells: which surfaces may be between the whole cell and the whole light, light by light. It is found when it
/// is first asked for, from the scene alone, so that it doesn't matter who asks and when.
#[derive(Debug, Default)]
pub(crate) struct KnownCells {
    lights: Vec<Known>,
    /// The primitives of all covers.
    primitives: Vec<u32>,
}

type Key = (u32, u32);

#[derive(Clone, Debug, Default)]
struct Known {
    cells: HashMap<Key, Found, BuildHasherDefault<PairHasher>>,
    /// The cell that was last found, as neighbouring receivers are mostly in one.
    last: [Option<(Key, Found)>; LEVELS.len()],
}

/// What is between a cell and a light.
#[derive(Clone, Copy, Debug)]
enum Found {
    Clear,
    /// A run of [`KnownCells::primitives`].
    Few(u32, u32),
    Unknown,
}

impl Cells {
    /// The cells for a world and its lights.
    pub(crate) fn new(world: &World, lights: &[Light]) -> Self {
        let [low, high] = world.bounds().map(Vec3A::as_dvec3);
        let longest = (high - low).max_element().max(f64::MIN_POSITIVE);
        let widths = LEVELS.map(|count| longest / f64::from(count));
        // A cell costs as much as the shadow rays of some receivers, which smaller primitives may not have.
        let least_area = widths[LEVELS.len() - 1].powi(2);
        let count = u32::try_from(world.len()).unwrap_or(u32::MAX);
        let large = (0..count).map(|primitive| world.area(primitive) >= least_area).collect();
        let end = |light: &Light| match light {
            Light::Area { source, .. } => Some(shaft_end(source)),
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

    /// What may be between a cell and a light, largest first; `None` if that is too much or has no closed form.
    fn find(
        &self,
        around: Surroundings<'_>,
        receiver: (u32, bool),
        level: usize,
        voxel: [u32; 3],
        light: usize,
    ) -> Option<Vec<u32>> {
        let to = self.ends.get(light)?.as_ref()?;
        let width = self.widths[level];
        let low = self.low + DVec3::from_array(voxel.map(f64::from)) * width;
        let world = around.world;
        let from = world.shaft_end(receiver.0, receiver.1, low, low + width)?;
        let mut found = world.shaft_blockers(&Shaft::between(&from, to), MOST_BLOCKERS[level], true)?;
        found.sort_by(|a, b| world.area(*b).total_cmp(&world.area(*a)));
        Some(found)
    }
}

impl KnownCells {
    /// What may be between a light and the receiver and its surroundings.
    pub(crate) fn cover(
        &mut self,
        cells: &Cells,
        around: Surroundings<'_>,
        receiver: &Receiver,
        light: usize,
    ) -> Cover<'_> {
        let primitive = receiver.point.primitive;
        let is_flat = receiver.normal == receiver.geometric;
        if !is_flat || !cells.large.get(primitive as usize).is_some_and(|large| *large) {
            return Cover::Unknown;
        }
        if self.lights.len() <= light {
            self.lights.resize_with(light + 1, Known::default);
        }
        let front = receiver.geometric.dot(receiver.point.normal.as_dvec3()) > 0.0;
        for level in 0..LEVELS.len() {
            let voxel = cells.voxel(level, receiver.position);
            let place = voxel.iter().fold(u32::try_from(level).unwrap_or(0), |key, x| key << COORDINATE_BITS | x);
            let key = (primitive << 1 | u32::from(front), place);
            let known = &mut self.lights[light];
            let found = match known.last[level] {
                Some((last, found)) if last == key => found,
                _ => {
                    let all = &mut self.primitives;
                    let find = || match cells.find(around, (primitive, front), level, voxel, light) {
                        None => Found::Unknown,
                        Some(none) if none.is_empty() => Found::Clear,
                        Some(some) => append(all, &some),
                    };
                    let found = *known.cells.entry(key).or_insert_with(find);
                    known.last[level] = Some((key, found));
                    found
                }
            };
            match found {
                Found::Clear => return Cover::Clear,
                Found::Few(start, end) => {
                    return self.primitives.get(start as usize..end as usize).map_or(Cover::Unknown, Cover::Few);
                }
                Found::Unknown => {}
            }
        }
        Cover::Unknown
    }
}

/// Adds primitives to those of all covers.
fn append(all: &mut Vec<u32>, some: &[u32]) -> Found {
    let start = all.len();
    all.extend_from_slice(some);
    match (u32::try_from(start), u32::try_from(all.len())) {
        (Ok(start), Ok(end)) => Found::Few(start, end),
        _ => Found::Unknown,
    }
}

/// The light as the end of shafts.
pub(super) fn shaft_end(source: &Source) -> ShaftEnd {
    match source.shape {
        Shape::Rectangle(flat) => {
            let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]].map(|c| flat.at(c));
            ShaftEnd::polygon(&corners, flat.normal, source.primitive)
        }
        Shape::Triangle(corners) => {
            let [a, b, c] = corners;
            ShaftEnd::polygon(&corners, (b - a).cross(c - a).normalize_or_zero(), source.primitive)
        }
        Shape::Disk(flat) => {
            let step = core::f64::consts::TAU / f64::from(AROUND_DISK);
            let radius = 1.0 / (0.5 * step).cos();
            let corner = |i: u32| {
                let (sin, cos) = (step * f64::from(i)).sin_cos();
                flat.at([radius * cos, radius * sin])
            };
            let corners: Vec<DVec3> = (0..AROUND_DISK).map(corner).collect();
            ShaftEnd::polygon(&corners, flat.normal, source.primitive)
        }
        Shape::Sphere { centre, radius } => ShaftEnd::within(centre - radius, centre + radius, source.primitive),
    }
}
