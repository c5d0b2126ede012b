//! How photons move with the wavelength.

use super::Photon;

/// How a photon moves with the wavelength: on a straight line, in proportion to 1/λ², from which the place between the first key (0) and the last (1)
/// is told.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Motion {
    /// What its position, in scene units, and its flux change by from 0 to 1.
    pub(super) position: [f32; 3],
    pub(super) flux: f32,
    /// Where the photon is that moves, and from where to where it does.
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

    /// Its place and flux at the middle of its way, and where that is: whatever is said about it from there is off by little, though it be fast.
    pub(super) fn halfway(&self, photon: &Photon) -> ([f32; 3], f32, f32) {
        let [from, to] = self.limits;
        let middle = 0.5 * (from + to);
        let to = middle - self.at;
        (core::array::from_fn(|i| photon.position[i] + to * self.position[i]), photon.flux + to * self.flux, middle)
    }

    /// Where the photon is somewhere on its way, its flux there, and how much of it.
    #[cfg(test)]
    pub(super) fn at(&self, photon: &Photon, to: f32) -> ([f32; 3], f32, f32) {
        let (place, flux, middle) = self.halfway(photon);
        let (t, [from, end]) = (to - middle, self.limits);
        let there = |is_there: bool| if is_there { 0.5 } else { 0.0 };
        // Half of it at the limits of its way, but for 0 and 1.
        let inside = (to > from || from <= 0.0) && (to < end || end >= 1.0);
        let presence = there(to >= from && to <= end) + there(inside && to >= from && to <= end);
        (core::array::from_fn(|i| place[i] + t * self.position[i]), flux + t * self.flux, presence)
    }

    /// How fast it is: how far it would go from 0 to 1, in scene units.
    pub(super) fn speed(&self) -> f32 {
        glam::Vec3A::from_array(self.position).length()
    }
}
