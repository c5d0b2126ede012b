//! Irradiance on a scene's surfaces, interpolated between places where anything gathers it.

use glam::DVec3;

use super::cells::{Cells, GENERATIONS, Gather, Goal, Seen};
use super::charts::{Charts, Patched};
use super::mesh::Patches;
use super::{Others, RadiosityError};
use crate::geometry::{Hit, NO_PRIMITIVE, World};
use crate::scene::Scene;
use crate::spectral::Palette;

/// The bend of irradiance along an edge of cells, over the accuracy: they are interpolated by quadratics, which are closer than that.
const BEND: f64 = 2.5;
const MOST_BEND: f64 = 0.1;
/// What is darker than this share of the mean irradiance is interpolated as if it were as bright as that.
const FLOOR: f64 = 0.1;
/// The most of the picture that one cell covers.
const CROWD: f64 = 1.0 / 128.0;

/// Where light is gathered for spheres, over their radius: as near as rounding allows.
const BESIDE: [f64; 2] = [1.0 + 1e-4, 1.0 - 1e-4];

/// When cells are good enough for a relative error of irradiance.
pub(super) const fn goal(accuracy: f64) -> Goal {
    Goal { tolerance: (BEND * accuracy).min(MOST_BEND), floor: FLOOR, crowd: CROWD }
}

/// The surfaces of a scene, and cells on them.
pub(crate) struct Mosaic {
    patches: Patches,
    charts: Charts,
    cells: Cells,
}

impl Mosaic {
    /// How many steps it takes to make the cells.
    pub(crate) const STEPS: u64 = GENERATIONS as u64;

    /// The surfaces alone; the scene's spectra are added to the palette.
    pub(crate) fn new(scene: &Scene, palette: &mut Palette) -> Result<Self, RadiosityError> {
        let patches = Patches::new(scene, Others::Simplified, palette)?;
        let charts = Charts::new(scene, &patches, BESIDE);
        Ok(Self { patches, charts, cells: Cells::default() })
    }

    /// Makes cells for the places that the camera sees. `gather` is asked at positions on surfaces of the world, by its primitives, or
    /// beside curved ones.
    pub(crate) fn fill(
        &mut self,
        (scene, world): (&Scene, &World),
        seen: &[Hit],
        accuracy: f64,
        gather: &dyn Gather,
        progress: &dyn Fn(u64),
    ) {
        let charts = self.charts.list(scene, &self.patches);
        let place = |hit: &Hit| Some((self.charts.number(&self.patches, hit)?, hit.position.as_dvec3()));
        let seen: Vec<Seen> = seen.iter().filter_map(place).collect();
        let gather = Renumbered { patches: &self.patches, charts: &self.charts, world, gather };
        self.cells = Cells::new(&charts, &seen, goal(accuracy), &gather, progress);
    }

    /// Adds the irradiance on a surface that was hit; false if none is known there.
    pub(crate) fn interpolate(&self, hit: &Hit, row: &mut [f64]) -> bool {
        let number = self.charts.number(&self.patches, hit);
        number.is_some_and(|chart| self.cells.interpolate(chart, hit.position.as_dvec3(), row))
    }

    /// How many gathers were made.
    pub(crate) fn gathers(&self) -> usize {
        self.cells.gathers()
    }
}

/// Gathers by primitives of the world instead of those of patches.
struct Renumbered<'g> {
    patches: &'g Patches,
    charts: &'g Charts,
    world: &'g World,
    gather: &'g dyn Gather,
}

impl Renumbered<'_> {
    fn primitive(&self, of_patches: u32) -> u32 {
        let Some(shape) = self.patches.world.shape(of_patches) else { return NO_PRIMITIVE };
        match self.charts.shapes.get(shape as usize) {
            Some(Patched::Same([from, to])) => of_patches - to + from,
            Some(Patched::Disk(_)) => self.world.primitives(shape as usize).start,
            Some(Patched::Sphere { .. } | Patched::Nothing) | None => NO_PRIMITIVE,
        }
    }
}

impl Gather for Renumbered<'_> {
    fn width(&self) -> usize {
        self.gather.width()
    }

    fn values(&self) -> usize {
        self.gather.values()
    }

    fn gather(&self, position: DVec3, normal: DVec3, primitive: u32, row: &mut [f64]) -> [f64; 3] {
        self.gather.gather(position, normal, self.primitive(primitive), row)
    }
}
