//! What is known of a cell's bounds once its values are.

use super::cell::{Cell, LEAST_SHARE, Part, ROUNDING, Row};
use super::field::Field;

/// What a cell's norms were found for.
#[derive(Clone, Debug, Default)]
pub(super) struct Slopes {
    /// For each leaf: its slope, K times slopes, the source of norms, its mean radiosity in all channels, nearly, and K times that. Empty where
    /// there are no norms.
    pub(super) leaves: Vec<[f64; 5]>,
    /// Whether slopes are of no use: all are 0.
    pub(super) flat: bool,
}

impl Slopes {
    /// K times the slopes at a leaf.
    pub(super) fn irradiance(&self, leaf: usize) -> f64 {
        self.leaves.get(leaf).map_or(0.0, |[_, k, ..]| *k)
    }

    /// The greatest slope.
    pub(super) fn most(&self) -> f64 {
        self.leaves.iter().fold(0.0, |m: f64, [s, ..]| m.max(s.abs()))
    }

    /// The share that a channel's source of norms has of what these were found for, where it is greatest, from the irradiance of its values.
    ///
    /// That source is ‖ε‖ H + ‖δφ − cov‖ |Kσ| + ‖φ‖ |slope H + mean Kσ − σ|, or ‖δ‖ H without slopes.
    pub(super) fn share(
        &self,
        cell: &Cell,
        (parts, kind): (&[&Part], &[usize]),
        (channel, rounding): (usize, f64),
        irradiance: impl Iterator<Item = f64>,
    ) -> f64 {
        let (norm, greatest) = (cell.ramp.norm[channel], rounding * self.most());
        let mut share = 0.0_f64;
        for (([slope, light, source, ..], kind), h) in self.leaves.iter().zip(kind).zip(irradiance) {
            let part = parts[*kind];
            let h = h.abs();
            let needed = if self.flat {
                part.deviation * h
            } else {
                let off = (part.slope * h + part.mean[channel] * light - slope).abs();
                // What rounding of K σ, of products and of their sum may change of that.
                let unsure = part.most * greatest + rounding * (part.slope.abs() * h + slope.abs());
                part.rest * h + part.product * (light.abs() + greatest) + norm * (off + 2.0 * unsure)
            };
            if needed > 0.0 {
                share = share.max(needed / source);
            }
        }
        share
    }
}

/// What is known of a cell's bounds once its values are.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Left {
    /// The greatest share that the values' sources of norms have of what these were found for.
    share: f64,
    /// What iteration and rounding leave of values as a residual.
    residual: f64,
}

impl Left {
    pub(super) fn note(&mut self, share: f64, residual: f64) {
        self.share = self.share.max(share);
        self.residual = self.residual.max(residual);
    }

    /// Norms are linear in their source, and radii in the norms: what was found for another source holds for the greatest share of that. Both then
    /// cover what is left of values.
    pub(super) fn cover(&self, rows: &mut [Row], (cell, slopes): (&Cell, &Slopes), parts: &[&Part], field: &Field<'_>) {
        let norm = cell.ramp.most();
        let (mut unsure, mut loose) = (0.0_f64, 0.0_f64);
        for (([_, light, source, ..], amplified), kind) in
            slopes.leaves.iter().zip(&field.amplified).zip(&field.surface)
        {
            let part = parts[*kind];
            let per_light = if slopes.flat { part.deviation } else { part.rest + norm * part.slope.abs() };
            if per_light > 0.0 {
                unsure = unsure.max(per_light * amplified / source);
            }
            loose = loose.max(part.unsure * light.abs());
        }
        let share = if slopes.leaves.is_empty() {
            1.0
        } else {
            self.share * (1.0 + ROUNDING + 2.0 * field.rounding) + unsure * self.residual
        };
        let share = if share.is_finite() { share } else { f64::INFINITY };
        // What is left is in all channels alike, whatever their shares; covariances are known as well as their rounding lets them be.
        let [left, loose] = [self.residual / LEAST_SHARE, loose];
        for (row, amplification) in rows.iter_mut().zip(&field.amplification) {
            // Nothing times any share is nothing.
            let scaled = |bound: f64| if bound > 0.0 { share * bound } else { bound };
            row.norm = scaled(row.norm) + amplification * left;
            row.radius = scaled(row.radius) + amplification * (left + loose);
        }
    }
}
