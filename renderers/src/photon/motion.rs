//! How photons move with the wavelength.

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
    /// The same of the photon somewhere else.
    #[allow(clippy::cast_possible_truncation, reason = "photons are kept in f32")]
    pub(super) const fn about(self, at: f64) -> Self {
        Self { at: at as f32, ..self }
    }

    /// The middle of its way, and from there to its end, in scene units.
    pub(crate) fn middle(&self, photon: &Photon) -> ([f32; 3], [f32; 3]) {
        let [from, to] = self.limits;
        let (middle, half) = (0.5 * (from + to) - self.at, 0.5 * (to - from));
        (core::array::from_fn(|i| photon.position[i] + middle * self.position[i]), self.position.map(|way| half * way))
    }

    /// Where the photon would be at 0, and its flux there.
    pub(super) fn start(&self, photon: &Photon) -> ([f32; 3], f32) {
        let back = |now: f32, change: f32| now - self.at * change;
        (core::array::from_fn(|i| back(photon.position[i], self.position[i])), back(photon.flux, self.flux))
    }

    /// Where the photon is somewhere on its way, and its flux there; `None` where it isn't.
    #[cfg(test)]
    pub(super) fn at(&self, photon: &Photon, to: f32) -> Option<([f32; 3], f32)> {
        let [from, end] = self.limits;
        let (start, flux) = self.start(photon);
        let is_there = to >= from && (to < end || end >= 1.0);
        is_there.then(|| (core::array::from_fn(|i| start[i] + to * self.position[i]), flux + to * self.flux))
    }

    /// How fast it is: how far it would go from 0 to 1, in scene units.
    pub(super) fn speed(&self) -> f32 {
        glam::Vec3A::from_array(self.position).length()
    }
}
