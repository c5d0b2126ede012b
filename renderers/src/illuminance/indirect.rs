//! Light that comes by way of other surfaces.

use glam::DVec3;

use crate::scene::{Emitter, Integrator, Scene};
use crate::spectral::Tabulated;

/// What arrives at a place by way of other surfaces.
#[derive(Clone, Debug, PartialEq)]
pub struct IndirectIrradiance {
    /// Illuminance, lx.
    pub lux: f64,
    /// The estimated error of it, lx.
    pub error: f64,
    /// The spectrum in W m⁻² nm⁻¹, if it is known.
    pub spectrum: Option<Tabulated>,
}

/// Something that knows the light between a scene's surfaces.
pub trait IndirectLight: Sync {
    /// Its name, for reports, such as `radiosity`.
    fn name(&self) -> &str;

    /// The indirect irradiance at a position on the side of a unit normal.
    fn irradiance(&self, position: DVec3, normal: DVec3) -> IndirectIrradiance;
}

/// Where the indirect part of illuminances comes from.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum IndirectPart {
    /// The scene asks for direct light alone: 0.
    NotAsked,
    /// The scene's constant ambient term stands for it: π times its radiance.
    Ambient,
    /// From an [`IndirectLight`] of this name.
    Computed(String),
    /// The scene asks for it, and nobody computed it: it is unknown.
    NotComputed,
}

impl IndirectPart {
    /// What a scene asks for: light between surfaces, by a `path` longer than two segments; the ambient term, by `whitted`.
    pub(super) fn of(scene: &Scene, light: Option<&dyn IndirectLight>) -> Self {
        let has_ambient = scene.emitters.iter().any(|emitter| matches!(emitter, Emitter::Ambient { .. }));
        match (scene.integrator, light) {
            (Integrator::Path { max_depth: Some(0..=2), .. } | Integrator::Direct, _) => Self::NotAsked,
            (Integrator::Whitted { .. }, _) if has_ambient => Self::Ambient,
            (Integrator::Whitted { .. }, _) => Self::NotAsked,
            (Integrator::Path { .. }, Some(light)) => Self::Computed(light.name().to_owned()),
            (Integrator::Path { .. }, None) => Self::NotComputed,
        }
    }
}

impl core::fmt::Display for IndirectPart {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::NotAsked => f.write_str("not asked for by the scene"),
            Self::Ambient => f.write_str("the scene's ambient term"),
            Self::Computed(name) => f.write_str(name),
            Self::NotComputed => f.write_str("not computed"),
        }
    }
}
