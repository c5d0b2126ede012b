//! Where light comes whose way depends on the wavelength: at any wavelength, roughly.

use std::collections::HashSet;

/// Cells that photons come to.
#[derive(Clone, Debug, Default)]
pub(crate) struct Reached {
    /// The side of a cell, in scene units.
    side: f32,
    cells: HashSet<[i32; 3]>,
}

/// The most steps in which a line is walked along.
const MOST_STEPS: f32 = 64.0;

impl Reached {
    /// None yet, with cells of this side in scene units.
    pub(crate) fn new(side: f32) -> Self {
        Self { side, cells: HashSet::new() }
    }

    /// Adds what a photon comes to on a line, as it does between two wavelengths.
    pub(crate) fn add(&mut self, from: [f32; 3], to: [f32; 3]) {
        let [from, to] = [from, to].map(glam::Vec3A::from_array);
        let steps = (from.distance(to) / self.side).ceil().clamp(1.0, MOST_STEPS);
        let mut step = 0.0;
        while step <= steps {
            self.cells.insert(self.cell(from.lerp(to, step / steps)));
            step += 1.0;
        }
    }

    /// Whether photons come to the cell of a position or to one of its neighbours.
    pub(crate) fn is_near(&self, position: glam::Vec3A) -> bool {
        let [x, y, z] = self.cell(position);
        let around = |c: i32| c.saturating_sub(1)..=c.saturating_add(1);
        !self.cells.is_empty()
            && around(x).any(|x| around(y).any(|y| around(z).any(|z| self.cells.contains(&[x, y, z]))))
    }

    #[allow(clippy::cast_possible_truncation, reason = "saturates")]
    fn cell(&self, position: glam::Vec3A) -> [i32; 3] {
        position.to_array().map(|x| (x / self.side).floor() as i32)
    }
}

#[cfg(test)]
mod tests {
    use super::Reached;
    use glam::Vec3A;

    #[test]
    fn what_is_near_a_line_is_reached() {
        let mut reached = Reached::new(0.5);
        assert!(!reached.is_near(Vec3A::ZERO));
        reached.add([-2.0, 0.1, 0.0], [3.0, 0.1, 1.0]);
        for step in 0..=100_u8 {
            let t = f32::from(step) / 100.0;
            let place = Vec3A::new(-2.0, 0.1, 0.0).lerp(Vec3A::new(3.0, 0.1, 1.0), t);
            assert!(reached.is_near(place) && reached.is_near(place + Vec3A::new(0.0, 0.35, -0.35)), "{t}");
            assert!(!reached.is_near(place + Vec3A::new(0.0, 1.6, 0.0)), "{t}");
        }
        // A photon that stays where it is.
        reached.add([9.0; 3], [9.0; 3]);
        assert!(reached.is_near(Vec3A::splat(9.2)) && !reached.is_near(Vec3A::splat(7.0)));
    }
}
