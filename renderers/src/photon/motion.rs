//! How photons move with the wavelength, and what is needed of one that passes a place.

use super::Photon;

/// How a photon moves with the wavelength: on a straight line, in proportion to 1/λ², from which the place between the first key (0) and the last (1)
/// is told.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Motion {
    /// What its position, in scene units, and its flux change by from 0 to 1.
    pub(super) position: [f32; 3],
    pub(super) flux: f32,
    /// Where the photon is that moves, and from where to where it does; it is there up to the second, or up to 1 with that.
    pub(super) at: f32,
    pub(super) limits: [f32; 2],
}

impl Motion {
    #[cfg(test)]
    pub(crate) const fn new(position: [f32; 3], flux: f32, at: f32, limits: [f32; 2]) -> Self {
        Self { position, flux, at, limits }
    }

    /// The same of the photon somewhere else.
    #[allow(clippy::cast_possible_truncation, reason = "photons are kept in f32")]
    pub(super) const fn about(self, at: f64) -> Self {
        Self { at: at as f32, ..self }
    }

    /// What the position of the photon changes by from 0 to 1, in scene units.
    #[cfg(test)]
    pub(crate) const fn way(&self) -> [f32; 3] {
        self.position
    }

    /// The middle of its way, and from there to its end, in scene units.
    pub(crate) fn middle(&self, photon: &Photon) -> ([f32; 3], [f32; 3]) {
        let [from, to] = self.limits;
        let (middle, half) = (0.5 * (from + to) - self.at, 0.5 * (to - from));
        (core::array::from_fn(|i| photon.position[i] + middle * self.position[i]), self.position.map(|way| half * way))
    }

    /// What is needed of the photon about a place.
    pub(crate) fn past(&self, photon: &Photon, place: glam::Vec3A) -> Moving {
        let (way, offset) = (glam::Vec3A::from_array(self.position), glam::Vec3A::from_array(photon.position) - place);
        Moving {
            square: [offset.length_squared(), 2.0 * offset.dot(way), way.length_squared()],
            flux: photon.flux,
            change: self.flux,
            at: self.at,
            limits: self.limits,
            direction: photon.direction,
            spectrum: photon.spectrum,
        }
    }
}

/// A photon that moves with the wavelength past a place: what is needed of it again and again is together.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Moving {
    /// The coefficients of the square of its distance, in square scene units, by how far it is from where it was found.
    square: [f32; 3],
    flux: f32,
    change: f32,
    at: f32,
    limits: [f32; 2],
    /// The unit vector to where it came from.
    pub(crate) direction: [f32; 3],
    /// The product of spectra that its flux is multiplied by.
    pub(crate) spectrum: u32,
}

impl Moving {
    /// From which node to which, the last not included, it is on its way, of nodes that are evenly spaced between the keys, by so many steps.
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "between 0 and the number of nodes")]
    pub(crate) fn nodes(&self, steps: u16) -> [u16; 2] {
        let [from, to] = self.limits.map(|limit| (limit * f32::from(steps)).ceil() as u16);
        [from, if self.limits[1] >= 1.0 { steps + 1 } else { to }]
    }

    /// How fast it is: how far it would go from the first to the last key, in scene units.
    pub(crate) fn speed(&self) -> f32 {
        self.square[2].sqrt()
    }

    /// The square of the photon's distance from the place, and its flux, somewhere on its way.
    pub(crate) fn at(&self, to: f32) -> (f32, f32) {
        let t = to - self.at;
        let [constant, linear, quadratic] = self.square;
        ((constant + t * (linear + t * quadratic)).max(0.0), (self.flux + self.change * t).max(0.0))
    }
}
