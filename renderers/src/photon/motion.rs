//! How photons move with the wavelength.

use rayon::prelude::*;

use super::Photon;

/// Ways that a thread looks at together.
const TOGETHER: usize = 4096;

/// The most parts that a way is cut into.
const MOST_PARTS: f32 = 8.0;

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

/// The same from the first wavelength to the last, of a photon that was thrown somewhere between.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Line {
    pub(super) position: [f32; 3],
    pub(super) flux: f32,
    pub(super) at: f32,
}

impl Line {
    /// The whole of it.
    pub(super) const fn motion(self) -> Motion {
        let Self { position, flux, at } = self;
        Motion { position, flux, at, limits: [0.0, 1.0] }
    }

    /// The photon somewhere else on it.
    pub(super) fn moved(&self, photon: &Photon, to: f32) -> Photon {
        let by = to - self.at;
        Photon {
            position: core::array::from_fn(|i| photon.position[i] + by * self.position[i]),
            flux: photon.flux + by * self.flux,
            ..*photon
        }
    }
}

/// Photons that move, and how.
pub(super) type Moving = (Vec<Photon>, Vec<Motion>);

/// How so many photons move about where they are, for what says it of one by its number and adds the rest of its way to others.
pub(super) fn cut(count: usize, parts: impl Fn(usize, &mut Moving) -> Motion + Sync, rest: &mut Moving) -> Vec<Motion> {
    let mut motions = vec![Motion::default(); count];
    let some = |(piece, own): (usize, &mut [Motion])| {
        let mut rest = Moving::default();
        for (number, motion) in (piece * TOGETHER..).zip(own) {
            *motion = parts(number, &mut rest);
        }
        rest
    };
    let pieces: Vec<Moving> = motions.par_chunks_mut(TOGETHER).enumerate().map(some).collect();
    rest.0.reserve(pieces.iter().map(|(photons, _)| photons.len()).sum());
    rest.1.reserve(pieces.iter().map(|(_, motions)| motions.len()).sum());
    for (photons, motions) in pieces {
        rest.0.extend(photons);
        rest.1.extend(motions);
    }
    motions
}

impl Motion {
    /// The same of the photon somewhere else.
    #[allow(clippy::cast_possible_truncation, reason = "photons are kept in f32")]
    pub(super) const fn about(self, at: f64) -> Self {
        Self { at: at as f32, ..self }
    }

    /// Calls with the parts of the way from one place to another, none longer than a distance in scene units, unless there would be more than
    /// [`MOST_PARTS`]: from where to where each goes, and the motion there.
    #[allow(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "photons are kept in f32, and there are few parts"
    )]
    pub(super) fn parts(self, [from, to]: [f64; 2], longest: f32, mut call: impl FnMut([f64; 2], Self)) {
        let width = to - from;
        let length = self.speed() * width as f32;
        // Ends of parts are ends of steps.
        let parts =
            if length > longest { ((length / longest).ceil().min(MOST_PARTS) as u16).next_power_of_two() } else { 1 };
        let limit = |part: u16| if part == parts { to } else { from + width * f64::from(part) / f64::from(parts) };
        for part in 0..parts {
            let limits = [limit(part), limit(part + 1)];
            call(limits, Self { limits: limits.map(|limit| limit as f32), ..self });
        }
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
