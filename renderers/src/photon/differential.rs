//! How a photon's path changes with the wavelength, to the first order: what it meets, and the ways it takes there, stay the same.
//!
//! Ray differentials (H. Igehy, "Tracing ray differentials", SIGGRAPH 1999) by the wavelength instead of by places on the film (O. Elek et al., "Spectral ray
//! differentials", EGSR 2014): one path says where those of all other waves land. Derivatives are by any measure that grows with the wavelength.

use core::fmt::Debug;

use glam::DVec3;

use crate::geometry::{Hit, World};
use crate::whitted::receiver;

/// What is known of how a path changes.
pub(super) trait Change: Copy + Debug + Default + Send {
    /// Whether anything is.
    const IS_KNOWN: bool;

    /// Goes a free way along a unit direction to a hit; by how much the way's length changes.
    fn arrive(&mut self, hit: &Hit, direction: DVec3, length: f64) -> f64;

    /// Changes the logarithm of the flux by so much more.
    fn brighten(&mut self, by: f64);

    /// Mirrored at a hit to which a unit direction led.
    fn mirrored(self, world: &World, hit: &Hit, direction: DVec3) -> Self;

    /// Mirrored at and led through a smooth boundary, for the index of the interior relative to the exterior and its derivative; what goes each way counts.
    fn parted(self, world: &World, hit: &Hit, direction: DVec3, index: [f64; 2]) -> [Self; 2];
}

/// Nothing is known.
impl Change for () {
    const IS_KNOWN: bool = false;

    fn arrive(&mut self, _: &Hit, _: DVec3, _: f64) -> f64 {
        0.0
    }

    fn brighten(&mut self, _: f64) {}

    fn mirrored(self, _: &World, _: &Hit, _: DVec3) -> Self {}

    fn parted(self, _: &World, _: &Hit, _: DVec3, _: [f64; 2]) -> [Self; 2] {
        [(); 2]
    }
}

/// Derivatives of a path.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Differential {
    /// Of where the path is, in scene units.
    pub(super) position: DVec3,
    /// Of the unit vector along which it goes.
    direction: DVec3,
    /// Of the logarithm of its flux. How likely it went on by chance was decided at its own wavelength: that is the same for all. What shading normals
    /// add or take doesn't count, nor that mirrors reflect more or less by the angle.
    pub(super) flux: f64,
}

/// By how many radians a path may turn from the first wavelength to the last: where it turns farther, mostly near the angle of total reflection, its
/// derivatives say too little about other waves.
const MOST_TURN: f64 = 0.2;

impl Differential {
    /// Whether it says how a path changes from the first wavelength to the last, if derivatives are by a measure that goes from 0 to 1 there.
    pub(super) fn is_known(&self) -> bool {
        self.direction.length() <= MOST_TURN && self.flux.abs() <= 1.0
    }

    /// The unit shading normal on the side of a hit that was met, its derivative, and that of the cosine of incidence.
    fn at_normal(&self, world: &World, hit: &Hit, direction: DVec3) -> (DVec3, DVec3, f64) {
        let normal = receiver(hit).normal;
        let change = world.normal_change(hit, self.position) * if hit.front { 1.0 } else { -1.0 };
        (normal, change, -(self.direction.dot(normal) + direction.dot(change)))
    }

    fn mirrored_at(self, (normal, change, by): (DVec3, DVec3, f64), direction: DVec3) -> Self {
        let cosine = -direction.dot(normal);
        Self { direction: self.direction + (normal * by + change * cosine) * 2.0, ..self }
    }
}

impl Change for Differential {
    const IS_KNOWN: bool = true;

    fn arrive(&mut self, hit: &Hit, direction: DVec3, length: f64) -> f64 {
        let normal = hit.geometric_normal.as_dvec3();
        let moved = self.position + self.direction * length;
        let longer = -normal.dot(moved) / normal.dot(direction);
        self.position = moved + direction * longer;
        longer
    }

    fn brighten(&mut self, by: f64) {
        self.flux += by;
    }

    fn mirrored(self, world: &World, hit: &Hit, direction: DVec3) -> Self {
        self.mirrored_at(self.at_normal(world, hit, direction), direction)
    }

    fn parted(self, world: &World, hit: &Hit, direction: DVec3, [index, by]: [f64; 2]) -> [Self; 2] {
        let (normal, turned, cosine_by) = self.at_normal(world, hit, direction);
        let cosine = (-direction.dot(normal)).clamp(0.0, 1.0);
        let mirrored = self.mirrored_at((normal, turned, cosine_by), direction);
        let [eta, eta_by] = if hit.front { [index, by] } else { [1.0 / index, -by / (index * index)] };
        let Some(Boundary { refracted: [refracted, refracted_by], ways }) =
            Boundary::new([cosine, cosine_by], [eta, eta_by])
        else {
            return [mirrored, self];
        };
        let along = cosine / eta - refracted;
        let along_by = (cosine_by - cosine * eta_by / eta) / eta - refracted_by;
        let direction = (self.direction - direction * (eta_by / eta)) / eta + normal * along_by + turned * along;
        [Self { flux: mirrored.flux + ways[0], ..mirrored }, Self { direction, flux: self.flux + ways[1], ..self }]
    }
}

/// What happens to light at a smooth boundary.
#[derive(Clone, Copy, Debug)]
struct Boundary {
    /// The cosine of the angle of refraction, and its derivative.
    refracted: [f64; 2],
    /// The derivatives of the logarithms of what is reflected and of what goes on.
    ways: [f64; 2],
}

impl Boundary {
    /// For the cosine of the angle of incidence and the index of what is beyond relative to what is before, each with its derivative; `None` if all is
    /// reflected.
    fn new([cosine, cosine_by]: [f64; 2], [eta, eta_by]: [f64; 2]) -> Option<Self> {
        let sine2 = (1.0 - cosine) * (1.0 + cosine);
        let onward2 = 1.0 - sine2 / (eta * eta);
        if !(onward2 > 0.0) {
            return None;
        }
        // Snell: eta² (1 − onward²) = 1 − cosine².
        let onward = onward2.sqrt();
        let onward_by = (cosine * cosine_by + sine2 * eta_by / eta) / (eta * eta * onward);
        let [s, s_by] = unlike([cosine, cosine_by], [eta * onward, eta_by * onward + eta * onward_by]);
        let [p, p_by] = unlike([eta * cosine, eta_by * cosine + eta * cosine_by], [onward, onward_by]);
        let (reflected, by) = ((s * s + p * p) / 2.0, s * s_by + p * p_by);
        let by_part = |by: f64, part: f64| if part > 0.0 { by / part } else { 0.0 };
        Some(Self { refracted: [onward, onward_by], ways: [by_part(by, reflected), by_part(-by, 1.0 - reflected)] })
    }
}

/// Fresnel's (a − b) / (a + b) for two numbers and their derivatives, and its derivative.
fn unlike([a, a_by]: [f64; 2], [b, b_by]: [f64; 2]) -> [f64; 2] {
    let sum = a + b;
    [(a - b) / sum, 2.0 * (b * a_by - a * b_by) / (sum * sum)]
}
