//! The analytic bench: scenes with references in closed form or from publications, for this project's renderers and others.
mod case;
mod disk;
mod model;
mod oracle;

pub use case::{Answer, Case, Check, Outcome, Provenance, Reduction, Standing, Status, Tolerance, Work, half_printed_unit};
pub use disk::{Method, Sampling};
pub use model::{Light, Model, SensorPoint, Shape, Surface, Vec3, flat};

/// All cases, in the order in which they are shown.
#[must_use]
pub fn cases() -> Vec<Case> {
    disk::cases()
}
