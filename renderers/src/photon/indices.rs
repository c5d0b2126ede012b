//! Indices of refraction as photons ask for them, and how they change with the wavelength.

use spectral_core::dispersion::LINE_D;

use crate::material::Dielectric;
use crate::spectral::{place_of, wavelength_at};

/// Relative indices of refraction by shapes, so far as they have been asked for.
#[derive(Debug, Default)]
pub(super) struct Indices {
    known: Vec<Option<Known>>,
}

/// The index of a shape.
#[derive(Clone, Debug)]
struct Known {
    /// At which wavelength in nm it was asked for last, and the index there.
    wavelength: Option<f64>,
    index: f64,
    at_d: f64,
    /// At the ends of even steps by [`place_of`], if its derivative was asked for.
    course: Option<Box<[f64; STEPS + 1]>>,
}

/// How far beside a place derivatives of absorption are found: half a step.
const NEARBY: f64 = 1.0 / 64.0;

/// In how many steps derivatives of indices are found: those of N-BK7 and SF11 within 0.1 %, where a parabola through three would be 6 % off.
const STEPS: usize = 32;

/// The derivative of what is known at the ends of even steps from 0 to 1: between the middles of steps on a line.
#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, clippy::cast_precision_loss, reason = "some steps")]
fn slope(course: &[f64; STEPS + 1], place: f64) -> f64 {
    let at = place * STEPS as f64 - 0.5;
    let step = (at.max(0.0) as usize).min(STEPS - 2);
    let [first, middle, last] = [0, 1, 2].map(|end| course[step + end]);
    let t = at - step as f64;
    STEPS as f64 * ((middle - first) * (1.0 - t) + (last - middle) * t)
}

impl Indices {
    /// At a wavelength in nm and at the d line; and, if it is asked for, the derivative by [`place_of`] at the wavelength.
    pub(super) fn of(
        &mut self,
        shape: u32,
        dielectric: &Dielectric,
        wavelength: Option<f64>,
        has_slope: bool,
    ) -> [f64; 3] {
        let place = shape as usize;
        self.known.resize(self.known.len().max(place + 1), None);
        let index = |wavelength| dielectric.relative_index(wavelength);
        let own = || index(wavelength.unwrap_or(LINE_D));
        let first = || Known { wavelength, index: own(), at_d: index(LINE_D), course: None };
        let known = self.known[place].get_or_insert_with(first);
        if known.wavelength != wavelength {
            (known.wavelength, known.index) = (wavelength, own());
        }
        let slope = match wavelength {
            Some(wavelength) if has_slope => {
                #[allow(clippy::cast_precision_loss, reason = "some steps")]
                let end = |step: usize| index(wavelength_at(step as f64 / STEPS as f64));
                let course = known.course.get_or_insert_with(|| Box::new(core::array::from_fn(end)));
                slope(course, place_of(wavelength))
            }
            _ => 0.0,
        };
        [known.index, known.at_d, slope]
    }
}

/// The derivative by [`place_of`] of what depends on the wavelength, by a difference about one in nm.
pub(super) fn slope_of(value: impl Fn(f64) -> f64, wavelength: f64) -> f64 {
    let place = place_of(wavelength);
    let [from, to] = [place - NEARBY, place + NEARBY].map(|place| place.clamp(0.0, 1.0));
    (value(wavelength_at(to)) - value(wavelength_at(from))) / (to - from)
}
