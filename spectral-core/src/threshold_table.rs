//! Tolerances in XYZ for a threshold in CIELAB, by cells of the unit cube (Iehl–Péroche appendix A.3): for those who cannot
//! afford cube roots for every colour.

use crate::Real;
use crate::bound::delta_e_majorant;

/// For each of N³ cells of the cube [0, 1]³ of XYZ relative to white: how far each tristimulus value may be off with ΔE*ab at or
/// under a threshold, wherever in the cell the colour is.
///
/// Iehl and Péroche estimate the tolerances; here they are certain. CIELAB's f is concave, so that a cell's darkest corner is its
/// most sensitive colour, and a tolerance that serves there serves all over the cell. For the same reason colours beyond the cube
/// are served by the cells on its surface.
#[derive(Clone, Copy, Debug)]
pub struct ThresholdTable<'a, R> {
    cells: &'a [R],
    cells_per_side: usize,
    threshold: R,
    inverse_white: [R; 3],
}

impl<'a, R: Real> ThresholdTable<'a, R> {
    /// Fills the caller's `buffer` of at least `cells_per_side`³ entries for a threshold in ΔE*ab; `None` when it is smaller,
    /// `cells_per_side` is 0, `threshold` is negative or NaN, or `white` is not positive and finite.
    pub fn build(cells_per_side: usize, threshold: R, white: [R; 3], buffer: &'a mut [R]) -> Option<Self> {
        let count = cells_per_side.checked_mul(cells_per_side)?.checked_mul(cells_per_side)?;
        let positive = white.iter().all(|w| *w > R::ZERO && w.is_finite());
        let defined = threshold >= R::ZERO;
        if cells_per_side == 0 || !positive || !defined {
            return None;
        }
        let cells = buffer.get_mut(..count)?;
        let side = R::from_usize(cells_per_side);
        for (place, cell) in cells.iter_mut().enumerate() {
            let index = [
                place % cells_per_side,
                place / cells_per_side % cells_per_side,
                place / cells_per_side / cells_per_side,
            ];
            *cell = tolerance(index.map(|i| R::from_usize(i) / side), threshold);
        }
        Some(Self { cells, cells_per_side, threshold, inverse_white: white.map(|w| R::ONE / w) })
    }

    /// The threshold in ΔE*ab that the tolerances are for.
    pub const fn threshold(&self) -> R {
        self.threshold
    }

    /// One over white's tristimulus values.
    pub(crate) const fn inverse_white(&self) -> [R; 3] {
        self.inverse_white
    }

    /// How far each of the tristimulus values may be off at a colour, relative to white's.
    ///
    /// Negative and undefined values are taken as 0, values above white as the cube's surface.
    #[inline]
    pub fn tolerance(&self, xyz: [R; 3]) -> R {
        let side = R::from_usize(self.cells_per_side);
        let last = self.cells_per_side - 1;
        let mut place = 0;
        for a in (0..3).rev() {
            let index = (xyz[a] * self.inverse_white[a] * side).to_usize().min(last);
            place = place * self.cells_per_side + index;
        }
        self.cells.get(place).copied().unwrap_or(R::ZERO)
    }

    /// Whether any colour within `radius` of `xyz` differs from it by at most the threshold; no cube root is taken.
    #[inline]
    pub fn accepts(&self, xyz: [R; 3], radius: [R; 3]) -> bool {
        let tolerance = self.tolerance(xyz);
        (0..3).all(|a| radius[a] * self.inverse_white[a] <= tolerance && xyz[a].is_finite())
    }
}

/// The largest common radius of a colour relative to white with a majorant at or under the threshold, to 2⁻²⁰ of itself from below.
fn tolerance<R: Real>(corner: [R; 3], threshold: R) -> R {
    let white = [R::ONE; 3];
    // A cell's colour is not below its corner but for the rounding of the look-up.
    let corner = corner.map(|c| c * (R::ONE - R::from_f64(4.0) * R::EPSILON));
    let enough = |radius: R| {
        let reach = radius * (R::ONE + R::from_f64(4.0) * R::EPSILON);
        delta_e_majorant(corner, [reach; 3], white) <= threshold
    };
    let (mut low, mut high) = (R::ZERO, R::ONE);
    while enough(high) && high < R::from_f64(1e6) {
        low = high;
        high *= R::TWO;
    }
    for _ in 0..40 {
        let middle = (low + high) * R::HALF;
        if enough(middle) {
            low = middle;
        } else {
            high = middle;
        }
    }
    low
}
