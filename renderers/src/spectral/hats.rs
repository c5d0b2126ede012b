//! Light that changes with the wavelength in few straight lines, as a sum of products of spectra.

use spectral_core::interval::{FIRST_WAVELENGTH, LAST_WAVELENGTH};

use super::{Monomial, Tabulated};

/// Light that changes with 1/λ² in straight lines, by so many steps over the visible wavelengths, is a sum of hats: what it is at the ends of the steps
/// counts for the wavelengths between.
pub(super) const STEPS: [u16; 3] = [1, 2, 4];

/// The most ends of steps.
pub(super) const MOST_ENDS: usize = 5;

/// The hats for each of these numbers of steps.
pub(super) fn hats() -> Vec<Tabulated> {
    let [first, last] = [FIRST_WAVELENGTH, LAST_WAVELENGTH].map(measure);
    let place = |wavelength: f64| ((measure(wavelength) - first) / (last - first)).clamp(0.0, 1.0);
    let hat = |steps: u16, end: u16| {
        let height = |wavelength: f64| 1.0 - (place(wavelength) * f64::from(steps) - f64::from(end)).abs();
        Tabulated::sampled(|wavelength| height(wavelength).max(0.0))
    };
    STEPS.iter().flat_map(|steps| (0..=*steps).map(|end| hat(*steps, end))).collect()
}

/// A hat by its number among all.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Hat(pub(super) u32);

impl Hat {
    /// Those for one of the numbers of steps.
    pub(super) fn all(steps: u16) -> impl Iterator<Item = Self> {
        let before: u16 = STEPS.iter().take_while(|other| **other < steps).map(|other| other + 1).sum();
        (before..=before + steps).map(|number| Self(u32::from(number)))
    }

    /// A number for a hat or none.
    pub(super) const fn code(hat: Option<Self>) -> u32 {
        match hat {
            None => 0,
            Some(Self(number)) => number + 1,
        }
    }
}

/// Light on straight lines: a product, the steps, and what it is at their ends.
#[derive(Clone, Copy, Debug)]
pub(super) struct Lines {
    pub(super) monomial: Monomial,
    pub(super) steps: u16,
    pub(super) ends: [f64; MOST_ENDS],
}

impl Lines {
    /// The same in more steps, a multiple of its own.
    fn in_steps(self, steps: u16) -> Self {
        let times = steps / self.steps;
        let end = |number: usize| {
            let (before, part) = (number / usize::from(times), number % usize::from(times));
            let [from, to] = [before, before + 1].map(|end| self.ends.get(end).copied().unwrap_or_default());
            #[allow(clippy::cast_precision_loss, reason = "a few")]
            let part = part as f64 / f64::from(times);
            if number <= usize::from(steps) { from + (to - from) * part } else { 0.0 }
        };
        Self { steps, ends: core::array::from_fn(end), ..self }
    }

    /// The sum of this and other light of the same product.
    pub(super) fn plus(self, other: Self) -> Self {
        let steps = self.steps.max(other.steps);
        let [a, b] = [self, other].map(|lines| lines.in_steps(steps));
        Self { ends: core::array::from_fn(|end| a.ends[end] + b.ends[end]), ..a }
    }
}

/// What paths change with, about in proportion: Cauchy's index does.
pub(crate) fn measure(wavelength: f64) -> f64 {
    1.0 / (wavelength * wavelength)
}

/// Where a wavelength in nm is between the first visible one (0) and the last (1), by that measure.
pub(crate) fn place_of(wavelength: f64) -> f64 {
    let [first, last] = [FIRST_WAVELENGTH, LAST_WAVELENGTH].map(measure);
    (measure(wavelength) - first) / (last - first)
}

/// The wavelength in nm at such a place.
pub(crate) fn wavelength_at(place: f64) -> f64 {
    let [first, last] = [FIRST_WAVELENGTH, LAST_WAVELENGTH].map(measure);
    (first + (last - first) * place).sqrt().recip()
}

#[cfg(test)]
mod tests {
    use super::{Hat, Lines, STEPS, hats, measure};
    use crate::spectral::{Monomial, Tabulated};

    /// Straight lines in 1/λ² through light at the ends of even steps.
    #[allow(
        clippy::cast_precision_loss,
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "few steps"
    )]
    fn on_lines(ends: &[f64], wavelength: f64) -> f64 {
        let [first, last] = [380.0, 780.0].map(measure);
        let place = (measure(wavelength) - first) / (last - first) * (ends.len() - 1) as f64;
        let step = (place.max(0.0) as usize).min(ends.len() - 2);
        ends[step] + (ends[step + 1] - ends[step]) * (place - step as f64)
    }

    fn lines(steps: u16, ends: &[f64]) -> Lines {
        let end = |number: usize| ends.get(number).copied().unwrap_or(0.0);
        Lines { monomial: Monomial::default(), steps, ends: core::array::from_fn(end) }
    }

    #[test]
    fn lines_of_different_steps_add() {
        let sum = lines(1, &[1.0, 3.0]).plus(lines(4, &[0.0, 1.0, 2.0, 5.0, 8.0]));
        assert_eq!((sum.steps, sum.ends), (4, [1.0, 2.5, 4.0, 7.5, 11.0]));
        let sum = lines(2, &[0.0, 4.0, 2.0]).plus(lines(1, &[1.0, 3.0]));
        assert_eq!((sum.steps, sum.ends), (2, [1.0, 6.0, 5.0, 0.0, 0.0]));
    }

    /// At whole nm, hats times what light is at the ends of steps are the light.
    #[test]
    fn hats_make_lines() {
        let hats = hats();
        for steps in STEPS {
            let ends: Vec<f64> = (0..=steps).map(|end| 0.3 + f64::from((end * 7) % 4)).collect();
            let own: Vec<&Tabulated> = Hat::all(steps).map(|hat| &hats[hat.0 as usize]).collect();
            assert_eq!(own.len(), ends.len());
            for nm in 380_u16..=780 {
                let value = |hat: &Tabulated| hat.values[usize::from(nm) - 360];
                let found: f64 = own.iter().zip(&ends).map(|(hat, end)| end * value(hat)).sum();
                assert!((found - on_lines(&ends, f64::from(nm))).abs() <= 1e-12, "{steps} {nm}: {found}");
            }
        }
    }
}
