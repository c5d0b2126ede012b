//! At which wavelengths the photons of a bundle of waves are thrown.

use spectral_core::Observer;
use spectral_core::interval::{FIRST_WAVELENGTH, LAST_WAVELENGTH};

use crate::spectral::Band;

/// Steps of the table in nm.
const STEP: f64 = 1.0;

/// The share of a turn between neighbouring paths: the golden section, so that any run of paths is spread evenly over a band.
const GOLDEN: f64 = 0.618_033_988_749_894_9;

/// Where the photons of a band are thrown.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Bundle {
    /// Each photon at a wavelength of its own, spread over the band like x̄ + ȳ + z̄, so that no limits between bands show.
    #[default]
    Continuous,
    /// All at the wavelength that stands for the band, as Iehl and Péroche have it.
    Single,
}

/// Wavelengths spread like the eye's sensitivity x̄ + ȳ + z̄.
#[derive(Clone, Debug)]
pub(crate) struct Waves {
    /// ∫ from 380 nm to each step.
    cumulative: Vec<f64>,
    /// For equal parts of the whole integral the step that they begin in.
    nearby: Vec<usize>,
    bundle: Bundle,
}

/// How many such parts there are.
const PARTS: u32 = 1024;

impl Waves {
    pub(crate) fn new(bundle: Bundle) -> Self {
        let observer = Observer::cie_1931_2deg();
        let sensitivity = |wavelength: f64| observer.value(wavelength).iter().sum::<f64>();
        let (mut cumulative, mut sum, mut wavelength) = (vec![0.0], 0.0, FIRST_WAVELENGTH);
        while wavelength < LAST_WAVELENGTH {
            sum += STEP * f64::midpoint(sensitivity(wavelength), sensitivity(wavelength + STEP));
            cumulative.push(sum);
            wavelength += STEP;
        }
        let nearby = (0..PARTS).map(|part| {
            let value = sum * f64::from(part) / f64::from(PARTS);
            // A part may begin a little earlier, by rounding.
            cumulative.partition_point(|c| *c <= value).saturating_sub(2)
        });
        Self { nearby: nearby.collect(), cumulative, bundle }
    }

    /// Whether each photon has a wavelength of its own.
    pub(crate) fn is_continuous(&self) -> bool {
        self.bundle == Bundle::Continuous
    }

    /// The wavelength in nm, inside a band, of the path with this number.
    pub(crate) fn of_path(&self, band: Band, path: u32) -> f64 {
        match self.bundle {
            Bundle::Single => band.wavelength,
            Bundle::Continuous => self.spread(band, path),
        }
    }

    /// The same for photons that are spread over the band.
    pub(crate) fn spread(&self, band: Band, path: u32) -> f64 {
        self.at(band, (f64::from(path) * GOLDEN).fract())
    }

    /// The same, whatever [`spread`](Self::spread) says.
    pub(crate) fn spread_anew(&self, band: Band, path: u32) -> f64 {
        self.at(band, (f64::from(path) * core::f64::consts::SQRT_2).fract())
    }

    /// The wavelengths in nm that part a band into thirds.
    pub(crate) fn thirds(&self, band: Band) -> [f64; 2] {
        [1.0 / 3.0, 2.0 / 3.0].map(|share| self.at(band, share))
    }

    /// The share of a band's sensitivity that is below a wavelength in nm.
    pub(crate) fn share(&self, band: Band, wavelength: f64) -> f64 {
        let [from, to] = band.limits;
        let [below, at, above] = [from, wavelength.clamp(from, to), to].map(|w| self.below(w));
        let share = if above > below { (at - below) / (above - below) } else { (wavelength - from) / (to - from) };
        share.clamp(0.0, 1.0)
    }

    /// The wavelength in nm below which this share of a band's sensitivity is.
    fn at(&self, band: Band, share: f64) -> f64 {
        let [from, to] = band.limits;
        if !(to > from) {
            return band.wavelength;
        }
        let [below, above] = [from, to].map(|w| self.below(w));
        let total = above - below;
        if !(total > 0.0) {
            return from + share * (to - from);
        }
        self.inverse(below + share * total).clamp(from, to)
    }

    /// ∫ up to a wavelength.
    fn below(&self, wavelength: f64) -> f64 {
        let (step, t) = self.place((wavelength - FIRST_WAVELENGTH) / STEP);
        self.cumulative[step] + t * (self.cumulative[step + 1] - self.cumulative[step])
    }

    fn inverse(&self, value: f64) -> f64 {
        let last = self.cumulative.len() - 2;
        let step = self.step_of(value).min(last);
        let width = self.cumulative[step + 1] - self.cumulative[step];
        let t = if width > 0.0 { (value - self.cumulative[step]) / width } else { 0.0 };
        #[allow(clippy::cast_precision_loss, reason = "400 steps")]
        let wavelength = FIRST_WAVELENGTH + STEP * (step as f64 + t);
        wavelength
    }

    /// The last step whose integral doesn't exceed a value: a few steps from one that is known for values nearby.
    #[allow(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        clippy::cast_precision_loss,
        reason = "some hundred steps"
    )]
    fn step_of(&self, value: f64) -> usize {
        let total = self.cumulative.last().copied().unwrap_or(0.0);
        let near = if total > 0.0 { (value / total * self.nearby.len() as f64).max(0.0) as usize } else { 0 };
        let mut step = self.nearby.get(near.min(self.nearby.len().saturating_sub(1))).copied().unwrap_or(0);
        while self.cumulative.get(step + 1).is_some_and(|c| *c <= value) {
            step += 1;
        }
        step
    }

    /// The step that a place in the table is in, and where in it.
    #[allow(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        clippy::cast_precision_loss,
        reason = "400 steps"
    )]
    fn place(&self, place: f64) -> (usize, f64) {
        let last = self.cumulative.len() - 2;
        let step = (place.max(0.0) as usize).min(last);
        (step, (place - step as f64).clamp(0.0, 1.0))
    }
}

#[cfg(test)]
mod tests {
    use spectral_core::{Observer, tristimulus};

    use super::{Bundle, Waves};
    use crate::spectral::Band;

    /// The share of photons below a wavelength is that of the sensitivity: a quadrature of the table itself, and exact integrals.
    #[test]
    fn photons_are_spread_like_the_eyes_sensitivity() {
        let waves = Waves::new(Bundle::Continuous);
        let flat = spectral_core::spectrum::Constant::new(1.0).unwrap();
        let observer = Observer::cie_1931_2deg();
        let integral = |from, to| tristimulus(&observer, &flat, from, to).iter().sum::<f64>();
        for limits in [[380.0, 780.0], [480.0, 530.0], [505.5, 507.25]] {
            let band = Band { wavelength: 500.0, limits };
            let mut before = limits[0];
            for path in 0..1000_u32 {
                let wavelength = waves.of_path(band, path);
                assert!((limits[0]..=limits[1]).contains(&wavelength));
            }
            for step in 1..=20 {
                let share = f64::from(step) / 20.0;
                let wavelength = waves.at(band, share);
                assert!(wavelength >= before);
                before = wavelength;
                let below = integral(limits[0], wavelength) / integral(limits[0], limits[1]);
                assert!((waves.share(band, wavelength) - share).abs() <= 1e-12, "{limits:?} {share}");
                // The table takes the sensitivity as constant within a step, where it changes by less than 5 %; it is nowhere more than
                // four times the band's mean.
                assert!(
                    (below - share).abs() <= 4.0 * 0.05 / 8.0 / (limits[1] - limits[0]),
                    "{limits:?} {share}: {below}"
                );
            }
        }
    }

    #[test]
    fn a_single_wavelength_stands_for_itself() {
        for bundle in [Bundle::Continuous, Bundle::Single] {
            assert_eq!(Waves::new(bundle).of_path(Band::single(587.56), 17), 587.56);
        }
        let band = Band { wavelength: 555.0, limits: [500.0, 600.0] };
        assert_eq!(Waves::new(Bundle::Single).of_path(band, 17), 555.0);
    }

    #[test]
    fn where_nothing_is_seen_all_waves_are_alike() {
        let waves = Waves { cumulative: vec![0.0; 401], nearby: Vec::new(), bundle: Bundle::Continuous };
        let band = Band { wavelength: 500.0, limits: [400.0, 600.0] };
        assert_eq!(waves.at(band, 0.25), 450.0);
        assert_eq!([300.0, 450.0, 700.0].map(|wavelength| waves.share(band, wavelength)), [0.0, 0.25, 1.0]);
    }
}
