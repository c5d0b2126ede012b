//! From a pixel's spectrum to its numbers.

use spectral_core::action::{ActionSpectra, MAXIMUM_LUMINOUS_EFFICACY};
use spectral_core::cct::CctStatus;
use spectral_core::light::{GeneralIndices, IndexMeter};
use spectral_core::spectrum::RadiationConstant;
use spectral_core::summation::{SumGrid, tristimulus_sum};
use spectral_core::tables::observers::CIE_1931_2;

use super::Quantity;

/// A number that isn't there.
pub(super) const NOTHING: f32 = f32::NAN;

/// What became of a pixel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Found {
    /// Nothing is there.
    #[default]
    Nowhere,
    /// There is no light, or less than none.
    Dark,
    /// Light, whether all measures have a value for it or not.
    Light,
}

/// Makes numbers of spectra.
pub(super) trait Measure: Sync {
    /// Writes a number for each quantity; [`NOTHING`] where there is none.
    fn measure(&self, spectrum: &[f64], values: &mut [f32]) -> Found;
}

/// Luminous quantities: ȳ over the bins of a spectrum.
pub(super) struct Luminous {
    pub(super) weights: Vec<f64>,
}

impl Measure for Luminous {
    fn measure(&self, spectrum: &[f64], values: &mut [f32]) -> Found {
        let sum: f64 = spectrum.iter().zip(&self.weights).map(|(s, w)| s * w).sum();
        let luminous = MAXIMUM_LUMINOUS_EFFICACY * sum;
        if !(luminous >= 0.0 && luminous.is_finite()) {
            values.fill(NOTHING);
            return Found::Dark;
        }
        values.fill(single(luminous));
        if luminous > 0.0 { Found::Light } else { Found::Dark }
    }
}

/// Colour temperature, indices and action factors by sums over a grid.
pub(super) struct Colours<const N: usize> {
    quantities: Vec<Quantity>,
    indices: Option<Box<IndexMeter<f64, N>>>,
    actions: Option<Box<ActionSpectra<f64, N>>>,
    observer: Box<[[f64; 3]; N]>,
}

impl<const N: usize> Colours<N> {
    pub(super) fn new(grid: SumGrid<N>, quantities: &[Quantity]) -> Self {
        let asks = |some: &[Quantity]| quantities.iter().any(|q| some.contains(q));
        let indices = asks(&[Quantity::Cct, Quantity::Duv, Quantity::Ra, Quantity::Cri00]);
        let actions = asks(&[Quantity::Acv, Quantity::Sy, Quantity::Melanopic]);
        Self {
            quantities: quantities.to_vec(),
            // The constant that `spectral light` takes.
            indices: indices.then(|| Box::new(IndexMeter::new(grid, RadiationConstant::Its1990))),
            actions: actions.then(|| Box::new(ActionSpectra::new(grid))),
            observer: Box::new(grid.observer(&CIE_1931_2)),
        }
    }

    fn fill(&self, values: &mut [f32], value: impl Fn(Quantity) -> Option<f64>) {
        for (to, quantity) in values.iter_mut().zip(&self.quantities) {
            *to = value(*quantity).filter(|v| v.is_finite()).map_or(NOTHING, single);
        }
    }
}

impl<const N: usize> Measure for Colours<N> {
    fn measure(&self, spectrum: &[f64], values: &mut [f32]) -> Found {
        let Ok(light) = <&[f64; N]>::try_from(spectrum) else { return Found::Nowhere };
        if light.iter().all(|power| *power == 0.0) {
            self.fill(values, |quantity| quantity.has_zero().then_some(0.0));
            return Found::Dark;
        }
        if !light.iter().all(|power| (0.0..f64::INFINITY).contains(power)) {
            values.fill(NOTHING);
            return Found::Dark;
        }
        let indices = self.indices.as_ref().and_then(|meter| meter.measure(light).ok());
        let actions = self
            .actions
            .as_ref()
            .and_then(|spectra| spectra.measure(light, tristimulus_sum(&self.observer, light), 1.0));
        self.fill(values, |quantity| match quantity {
            Quantity::Acv => Some(actions?.acv),
            Quantity::Sy => Some(actions?.sy),
            Quantity::Melanopic => Some(actions?.alpha_opic.melanopic_der()),
            _ => index(quantity, indices.as_ref()?),
        });
        Found::Light
    }
}

/// An index within its domain.
fn index(quantity: Quantity, found: &GeneralIndices<f64>) -> Option<f64> {
    let cct = found.chromaticity.cct;
    let valid = cct.status == CctStatus::Valid;
    match quantity {
        Quantity::Cct => valid.then_some(cct.temperature),
        Quantity::Duv => cct.is_in_range().then_some(cct.duv),
        Quantity::Ra => found.ra.filter(|_| valid),
        Quantity::Cri00 => found.cri00.filter(|_| valid),
        _ => None,
    }
}

#[allow(clippy::cast_possible_truncation, reason = "maps are kept in f32")]
const fn single(value: f64) -> f32 {
    value as f32
}
