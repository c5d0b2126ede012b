//! A luminous intensity distribution somewhere in a scene.

use alloc::sync::Arc;

use glam::{DAffine3, DMat3, DVec3};

use super::LuminousIntensity;

/// A luminaire as a point source in the world.
#[derive(Clone, Debug, PartialEq)]
pub struct PlacedLuminaire {
    /// Where it is.
    pub position: DVec3,
    /// From the world to the luminaire's frame: a rotation, possibly with a mirroring.
    to_local: DMat3,
    /// The distribution in its own frame.
    intensity: Arc<LuminousIntensity>,
}

impl PlacedLuminaire {
    /// Places a distribution by the map from the [luminaire's frame](super) to the world, a rigid motion, possibly with a
    /// mirroring; any scaling in it is left out.
    #[must_use]
    pub fn new(intensity: Arc<LuminousIntensity>, to_world: &DAffine3) -> Self {
        let axes = [to_world.matrix3.x_axis, to_world.matrix3.y_axis, to_world.matrix3.z_axis];
        let [x, y, z] = axes.map(DVec3::normalize_or_zero);
        Self { position: to_world.translation, to_local: DMat3::from_cols(x, y, z).transpose(), intensity }
    }

    /// Luminous intensity in cd along a direction of the world, away from the luminaire, of any length.
    #[must_use]
    pub fn candela(&self, direction: DVec3) -> f64 {
        self.intensity.candela_towards((self.to_local * direction).to_array())
    }

    /// The distribution.
    #[must_use]
    pub fn intensity(&self) -> &LuminousIntensity {
        &self.intensity
    }
}
