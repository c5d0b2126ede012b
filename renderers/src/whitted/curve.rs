//! Light at all wavelengths, by steps between which it changes in proportion to 1/λ².

use alloc::sync::Arc;
use std::collections::HashMap;
use std::sync::LazyLock;

use spectral_core::Observer;
use spectral_core::interval::{FIRST_WAVELENGTH, LAST_WAVELENGTH};

use crate::spectral::{Band, Monomial, Radiance, place_of, wavelength_at};

/// What a surface reflects of light whose way there depends on the wavelength, where it is known at all of them: between neighbouring ones it changes in
/// proportion to 1/λ².
#[derive(Clone, Debug, Default)]
pub(super) struct Curve {
    /// How many steps there are between the first and the last visible wavelength.
    pub(super) steps: u16,
    pub(super) monomials: Vec<Monomial>,
    /// For each product a weight at each wavelength, one after the other.
    pub(super) weights: Vec<f64>,
}

/// The eye's sensitivity x̄ + ȳ + z̄ at whole nm from the first visible wavelength on, and the integrals up to there of it and of it times the place
/// of the wavelength.
struct Sensitivity(Vec<(f64, [f64; 2])>);

static SENSITIVITY: LazyLock<Sensitivity> = LazyLock::new(|| {
    let observer = Observer::cie_1931_2deg();
    let at = |wavelength: f64| observer.value(wavelength).iter().sum::<f64>();
    let (mut steps, mut wavelength) = (vec![(at(FIRST_WAVELENGTH), [0.0; 2])], FIRST_WAVELENGTH);
    while wavelength < LAST_WAVELENGTH {
        let (before, sums) = steps.last().copied().unwrap_or_default();
        let here = at(wavelength + 1.0);
        let more = Sensitivity::part([(before, wavelength), (here, wavelength + 1.0)]);
        steps.push((here, [0, 1].map(|k| sums[k] + more[k])));
        wavelength += 1.0;
    }
    Sensitivity(steps)
});

impl Sensitivity {
    /// Both integrals between two sensitivities and their wavelengths in nm, by Simpson's rule.
    fn part([(a, from), (b, to)]: [(f64, f64); 2]) -> [f64; 2] {
        let (width, middle) = (to - from, f64::midpoint(from, to));
        let moment = a * place_of(from) + 2.0 * (a + b) * place_of(middle) + b * place_of(to);
        [width * f64::midpoint(a, b), width * moment / 6.0]
    }

    /// Both integrals up to a wavelength in nm.
    fn up_to(&self, wavelength: f64) -> [f64; 2] {
        let place = (wavelength.min(LAST_WAVELENGTH) - FIRST_WAVELENGTH).max(0.0);
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a visible wavelength")]
        let step = (place as usize).min(self.0.len().saturating_sub(2));
        let Some(&[(a, sums), (b, _)]) = self.0.get(step..step + 2) else { return [0.0; 2] };
        #[allow(clippy::cast_precision_loss, reason = "400 at most")]
        let before = step as f64;
        let here = (a + (b - a) * (place - before), FIRST_WAVELENGTH + place);
        let more = Self::part([(a, FIRST_WAVELENGTH + before), here]);
        [0, 1].map(|k| sums[k] + more[k])
    }
}

/// The step that a place is in, of so many from the first visible wavelength to the last.
#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "the number of a step")]
fn step_at(place: f64, steps: u16) -> u16 {
    ((place * f64::from(steps)).max(0.0) as u16).min(steps.saturating_sub(1))
}

/// From which to which end of steps, the last not included, light must be known for the mean over a band.
pub(crate) fn nodes_of(band: Band, steps: u16) -> [u16; 2] {
    let [from, to] = band.limits;
    let [first, last] = if to > from { [from, to] } else { [band.wavelength; 2] };
    let [first, last] = [first, last].map(|wavelength| step_at(place_of(wavelength), steps));
    [first, last + 2]
}

/// What a band has of the steps that it goes over: what the light at either end of each counts for.
type Parts = [(usize, [f64; 2])];

/// What bands that were asked for have of steps: there are few of them, and each is asked for again and again.
#[derive(Debug, Default)]
pub(super) struct BandParts(HashMap<([u64; 3], u16), Arc<Parts>>);

impl BandParts {
    fn of(&mut self, band: Band, steps: u16) -> Arc<Parts> {
        let [from, to] = band.limits;
        let key = ([band.wavelength, from, to].map(f64::to_bits), steps);
        Arc::clone(self.0.entry(key).or_insert_with(|| parts(band, steps).into()))
    }
}

fn parts(band: Band, steps: u16) -> Vec<(usize, [f64; 2])> {
    let step_at = |place: f64| usize::from(step_at(place, steps));
    let steps = f64::from(steps);
    let [from, to] = band.limits;
    let [before, after] = [from, to].map(|limit| SENSITIVITY.up_to(limit));
    let total = after[0] - before[0];
    #[allow(clippy::cast_precision_loss, reason = "the number of a step")]
    let number = |step: usize| step as f64;
    if !(to > from && total > 0.0) {
        let place = place_of(band.wavelength);
        let step = step_at(place);
        let t = place * steps - number(step);
        return vec![(step, [1.0 - t, t])];
    }
    let [first, last] = [from, to].map(|limit| step_at(place_of(limit)));
    let mut known = before;
    let share = |step: usize| {
        let end = if step == last { after } else { SENSITIVITY.up_to(wavelength_at(number(step + 1) / steps)) };
        let [sum, moment] = [0, 1].map(|k| (end[k] - known[k]) / total);
        known = end;
        let of_last = moment * steps - sum * number(step);
        (step, [sum - of_last, of_last])
    };
    (first..=last).map(share).collect()
}

impl Curve {
    /// The light of a band: the mean over its waves, by the eye's sensitivity x̄ + ȳ + z̄; that of a single wavelength if there are no others.
    pub(super) fn over(&self, band: Band, known: &mut BandParts) -> Radiance {
        let parts = known.of(band, self.steps);
        let mut light = Radiance::default();
        for (monomial, weights) in self.terms() {
            let of = |(step, [first, last]): &(usize, [f64; 2])| first * weights[*step] + last * weights[step + 1];
            light.add(monomial, parts.iter().map(of).sum());
        }
        light
    }

    /// How many steps there are between the first and the last visible wavelength.
    pub(super) const fn steps(&self) -> u16 {
        self.steps
    }

    /// The products with their weights at the ends of all steps.
    pub(super) fn terms(&self) -> impl Iterator<Item = (Monomial, &[f64])> {
        self.monomials.iter().copied().zip(self.weights.chunks(usize::from(self.steps) + 1))
    }
}

#[cfg(test)]
mod tests {
    use spectral_core::Observer;

    use super::{BandParts, Curve, nodes_of, place_of, wavelength_at};
    use crate::spectral::{Band, Monomial, measure};

    /// A curve through the light at nodes, of which there is one more than steps.
    fn curve(steps: u16, light: impl Fn(f64) -> f64) -> Curve {
        let at = |step: u16| wavelength_at(f64::from(step) / f64::from(steps));
        let weights = (0..=steps).map(|step| light(at(step))).collect();
        Curve { steps, monomials: vec![Monomial::default()], weights }
    }

    fn of(curve: &Curve, band: Band) -> f64 {
        curve.over(band, &mut BandParts::default()).terms().iter().map(|(_, weight)| weight).sum()
    }

    /// What is kept of bands is theirs alone: of each band, or single wavelength, and of each number of steps.
    #[test]
    fn bands_keep_their_own_parts() {
        let mut known = BandParts::default();
        for _ in 0..2 {
            for steps in [1, 2, 8] {
                for (wavelength, limits) in
                    [(500.0, [480.0, 520.0]), (500.0, [380.0, 780.0]), (500.0, [500.0; 2]), (600.0, [500.0; 2])]
                {
                    let (band, own) = (Band { wavelength, limits }, curve(steps, |w| (w / 50.0).sin()));
                    let kept = own.over(band, &mut known);
                    assert_eq!(kept, own.over(band, &mut BandParts::default()), "{steps} {band:?}");
                }
            }
        }
    }

    /// A band has the same light where only what it asks for is known.
    #[test]
    fn bands_ask_for_all_that_they_need() {
        let light = |wavelength: f64| 2.0 + (9.0 * place_of(wavelength)).sin();
        for steps in [1, 2, 4, 32, 128] {
            let whole = curve(steps, light);
            for (from, to) in
                [(380.0, 780.0), (380.0, 381.0), (779.0, 780.0), (480.0, 600.0), (555.0, 555.0), (380.0, 380.0)]
            {
                let band = Band { wavelength: f64::midpoint(from, to), limits: [from, to] };
                let [first, end] = nodes_of(band, steps);
                assert!(first < end && end <= steps + 1);
                let mut part = whole.clone();
                let unasked = |(node, _): &(usize, &mut f64)| !(usize::from(first)..usize::from(end)).contains(node);
                part.weights.iter_mut().enumerate().filter(unasked).for_each(|(_, weight)| *weight = f64::NAN);
                assert_eq!(of(&part, band), of(&whole, band), "{steps} {from} {to}");
            }
        }
    }

    /// Light at a single wavelength is found exactly where it is a line in 1/λ²; over a band it is the mean by x̄ + ȳ + z̄.
    #[test]
    fn bands_have_their_mean() {
        let light = |wavelength: f64| 2.0 + 3e5 * measure(wavelength);
        let tent = |wavelength: f64| (1.0 - 9.0 * (place_of(wavelength) - 4.0 / 9.0).abs()).max(0.0);
        for steps in [1, 2, 7, 9, 128] {
            let (line, hat) = (curve(steps, light), curve(steps, tent));
            for wavelength in [380.0, 381.0, 450.0, 500.0, 550.0, 700.0, 779.0, 780.0] {
                let found = of(&line, Band::single(wavelength));
                assert!((found - light(wavelength)).abs() <= 1e-12, "{steps} {wavelength}: {found}");
                for half in [0.2, 3.0, 20.0, 100.0] {
                    let limits = [wavelength - half, wavelength + half].map(|limit| limit.clamp(380.0, 780.0));
                    let band = Band { wavelength, limits };
                    let mean = |curve: &Curve| {
                        let (mut sum, mut total) = (0.0, 0.0);
                        for step in 0..4000_u32 {
                            let at = limits[0] + (limits[1] - limits[0]) * (f64::from(step) + 0.5) / 4000.0;
                            let sensitivity: f64 = Observer::<f64>::cie_1931_2deg().value(at).iter().sum();
                            sum += sensitivity * of(curve, Band::single(at));
                            total += sensitivity;
                        }
                        sum / total
                    };
                    for (curve, tolerance) in [(&line, 1e-4), (&hat, 4e-3)] {
                        let (found, mean) = (of(curve, band), mean(curve));
                        assert!((found - mean).abs() <= tolerance, "{steps} {limits:?}: {found} {mean}");
                    }
                }
            }
        }
    }
}
