//! Direct light with controlled accuracy: what part of a light a surface element sees, and how much of its light arrives.
//!
//! Three ways, in this order:
//! - nothing is in the way for certain (a [shaft](crate::geometry::Shaft) says so): the light's closed form;
//! - the surfaces that may be in the way are known: each hides a convex cone, which is cut out of the light, and what is left is summed
//!   in closed form ([`visible_configuration_factor`]). Lights are polygons, disks and spheres; blockers are polygons;
//! - otherwise shadow rays, which estimate only the visible share of the closed form (the ratio estimator).
//!
//! Closed forms work in `f64` from the scene's own geometry; shadow rays in the precision of the [`World`](crate::geometry::World).

mod adaptive;
mod blocker;
mod cells;
mod contour;
mod estimate;
mod lattice;
mod light;
mod pieces;
mod sampled;
mod scene;
mod sky;
mod source;
mod visible;

pub use blocker::Blockers;
pub(crate) use cells::{Cells, KnownCells};
pub use estimate::{Estimate, Way, visible_configuration_factor};
pub use light::{Light, Part, Surroundings};
pub(crate) use sampled::{SampledLight, power_heuristic};
pub(crate) use scene::surface;
pub use scene::{sources, world};
pub use sky::visible_sky;
pub(crate) use source::single;
pub use source::{Flat, Receiver, Shape, Source};
pub use visible::{Cover, Scratch};
