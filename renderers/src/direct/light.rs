//! Lights as a pixel sees them: exact where the surfaces between are few and flat-sided, by shadow rays elsewhere.

use core::f64::consts::PI;

use glam::DVec3;

use super::blocker::{Blockers, Outline};
use super::lattice::{Lattice, Shadows};
use super::source::{Receiver, Seen, Source, single};
use super::visible::{Cover, Scratch, unblocked_factor, visible_factor};
use crate::geometry::{NO_PRIMITIVE, World};
use crate::luminaire::PlacedLuminaire;
use crate::spectral::Factor;

/// A light.
#[derive(Clone, Debug)]
pub enum Light {
    /// A light with an area, and its radiance.
    Area {
        /// Shape and primitive.
        source: Source,
        /// Radiance.
        radiance: Factor,
    },
    /// A point light.
    Point {
        /// Where it is.
        position: DVec3,
        /// Intensity.
        intensity: Factor,
    },
    /// A point light with a distribution of its own.
    Luminaire {
        /// Where and how it hangs, and its intensity in cd by direction.
        luminaire: PlacedLuminaire,
        /// Intensity for each candela.
        intensity: Factor,
    },
    /// Parallel light.
    Directional {
        /// The unit vector along which it travels.
        direction: DVec3,
        /// Irradiance on a plane across it.
        irradiance: Factor,
    },
}

/// Direct light from one part of a light on a surface, where it is visible.
#[derive(Clone, Copy, Debug)]
pub struct Part {
    /// The direction to the part, a unit vector.
    pub direction: DVec3,
    /// Irradiance divided by the light's radiance (by its intensity or irradiance for lights without area).
    pub irradiance: f64,
}

/// What may be between lights and receivers: the same surfaces for rays and for closed forms.
#[derive(Clone, Copy, Debug)]
pub struct Surroundings<'w> {
    /// For shadow rays.
    pub world: &'w World,
    /// For closed forms.
    pub blockers: &'w Blockers,
}

impl Light {
    /// The factor of the light's spectrum.
    #[must_use]
    pub const fn factor(&self) -> Factor {
        match self {
            Self::Area { radiance, .. } => *radiance,
            Self::Point { intensity, .. } | Self::Luminaire { intensity, .. } => *intensity,
            Self::Directional { irradiance, .. } => *irradiance,
        }
    }

    /// Calls `receive` for each visible part of the light; a light with an area is in at least 4^`least` parts, whose irradiances add up to
    /// that of the visible light: in closed form where `cover` knows of all that may be in the way, by the visible share of shadow rays
    /// (the ratio estimator) elsewhere.
    pub fn illuminate<'c>(
        &self,
        around: Surroundings<'_>,
        receiver: &Receiver,
        least: u32,
        cover: impl FnOnce() -> Cover<'c>,
        scratch: &mut Scratch,
        mut receive: impl FnMut(Part),
    ) {
        match self {
            Self::Area { source, .. } => illuminate_area(source, around, receiver, least, cover, scratch, receive),
            Self::Point { position, .. } => {
                if let Some(part) = from_point(*position, around.world, receiver) {
                    receive(part);
                }
            }
            Self::Luminaire { luminaire, .. } => {
                if let Some(Part { direction, irradiance }) = from_point(luminaire.position, around.world, receiver) {
                    receive(Part { direction, irradiance: irradiance * luminaire.candela(-direction) });
                }
            }
            Self::Directional { direction, .. } => {
                if let Some(part) = from_direction(*direction, around.world, receiver) {
                    receive(part);
                }
            }
        }
    }
}

/// The light of a point of intensity 1, if it is visible.
fn from_point(position: DVec3, world: &World, receiver: &Receiver) -> Option<Part> {
    let way = position - receiver.position;
    let squared = way.length_squared();
    let direction = way / squared.sqrt();
    let cosine = direction.dot(receiver.normal);
    let above = cosine > 0.0 && direction.dot(receiver.geometric) > 0.0;
    let visible = above && !world.occluded_point(&receiver.point, single(position));
    visible.then_some(Part { direction, irradiance: cosine / squared })
}

/// Parallel light of irradiance 1, if it is visible.
fn from_direction(along: DVec3, world: &World, receiver: &Receiver) -> Option<Part> {
    let direction = -along;
    let cosine = direction.dot(receiver.normal);
    let above = cosine > 0.0 && direction.dot(receiver.geometric) > 0.0;
    let visible = above && !world.occluded_direction(&receiver.point, single(direction));
    visible.then_some(Part { direction, irradiance: cosine })
}

fn illuminate_area<'c>(
    source: &Source,
    around: Surroundings<'_>,
    receiver: &Receiver,
    least: u32,
    cover: impl FnOnce() -> Cover<'c>,
    scratch: &mut Scratch,
    mut receive: impl FnMut(Part),
) {
    if source.primitive == receiver.point.primitive && source.primitive != NO_PRIMITIVE {
        // What is flat doesn't light itself, even where rounding lifts the receiver off its plane.
        return;
    }
    let Some(seen) = Seen::new(&source.shape, receiver.position) else { return };
    let cover = cover();
    let exact = match cover {
        Cover::Clear => Some(unblocked_factor(receiver, &seen, scratch)),
        Cover::Few(candidates) => {
            visible_factor(receiver, &seen, around.blockers, candidates, Outline::Inscribed(3), scratch)
        }
        Cover::Unknown => None,
    };
    let most = exact.unwrap_or_else(|| unblocked_factor(receiver, &seen, scratch));
    if most <= 0.0 {
        return;
    }
    if let (Some(factor), 0) = (exact, least) {
        return receive(Part { direction: seen.middle().normalize_or_zero(), irradiance: PI * factor });
    }
    let mut parts = Vec::new();
    let mut keep = |point: DVec3, weight: f64, share: f64| {
        if least > 0 && weight * share > 0.0 {
            parts.push((point, weight * share));
        }
    };
    let shadows = match (cover, exact) {
        (Cover::Clear, _) => Shadows::None,
        (Cover::Few(_), Some(_)) => Shadows::Cones(scratch.cones()),
        _ => Shadows::Rays,
    };
    let share = Lattice::new(around.world, receiver, source, shadows).share(least, &mut keep);
    let irradiance = PI * exact.unwrap_or(most * share);
    if least == 0 {
        if share > 0.0 {
            receive(Part { direction: seen.middle().normalize_or_zero(), irradiance });
        }
        return;
    }
    let total: f64 = parts.iter().map(|(_, weight)| weight).sum();
    for (point, weight) in parts {
        let direction = (point - receiver.position).normalize_or_zero();
        receive(Part { direction, irradiance: irradiance * (weight / total) });
    }
}
