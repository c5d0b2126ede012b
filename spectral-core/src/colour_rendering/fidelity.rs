//! The colour fidelity index R_f of CIE 224:2017 and the gamut index R_g of ANSI/IES TM-30.

use super::cam02::Cam02;
use super::reference::{ReferenceKind, ReferenceLight};
use crate::Real;
use crate::cct::PlanckianLocus;
use crate::summation::Illuminated;
use crate::summation::{SumGrid, tristimulus_sum};

/// How many sectors of hue R_g averages over.
const SECTORS: usize = 16;
/// c of R_f′ = 100 − c ΔE (CIE 224:2017).
const FACTOR: f64 = 6.73;

/// R_f and R_g of `M` samples with their stages.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fidelity<R, const M: usize> {
    /// J′, a′, b′ of the samples under the test light.
    pub test_colours: [[R; 3]; M],
    /// J′, a′, b′ of the samples under the reference light.
    pub reference_colours: [[R; 3]; M],
    /// The colour difference of each sample in CAM02-UCS.
    pub differences: [R; M],
    /// The special fidelity index of each sample, above 0.
    pub special: [R; M],
    /// The general colour fidelity index R_f, in 0 to 100.
    pub rf: R,
    /// The gamut index R_g: 100 times the ratio of the areas of the mean (a′, b′) of 16 sectors of hue. NaN when a sector
    /// has no sample; the 99 samples of CIE 224 leave none empty under any light near daylight.
    pub rg: R,
}

/// The relative spectral power of the reference light of CIE 224:2017 on a grid: a black body up to 4000 K, daylight from
/// 5000 K, and in between a blend in which both have the same luminance and daylight a share of (T − 4000 K) / 1000 K.
///
/// `observer` is that of 10°, for which the luminances are made equal. `None` outside 500 K to 25 000 K.
#[must_use]
pub fn fidelity_reference<R: Real, const N: usize>(
    temperature: R,
    grid: SumGrid<N>,
    locus: &PlanckianLocus<R, N>,
    observer: &[[R; 3]; N],
) -> Option<[R; N]> {
    let of = |kind| {
        let spectrum = ReferenceLight { kind, temperature }.spectrum(grid, locus)?;
        let y = tristimulus_sum(observer, &spectrum)[1];
        Some(spectrum.map(|power| power / y))
    };
    let share = (temperature - R::from_f64(4000.0)) / R::from_f64(1000.0);
    ReferenceLight::for_temperature(temperature)?;
    if share <= R::ZERO {
        return of(ReferenceKind::Planckian);
    }
    let daylight = of(ReferenceKind::Daylight)?;
    if share >= R::ONE {
        return Some(daylight);
    }
    let planckian = of(ReferenceKind::Planckian)?;
    Some(core::array::from_fn(|i| planckian[i] * (R::ONE - share) + daylight[i] * share))
}

/// R_f of CIE 224:2017 and R_g of TM-30: CIECAM02 and CAM02-UCS with the observer of 10°, under which both lights must
/// have been summed.
///
/// R = 10 ln(1 + exp((100 − 6.73 ΔE) / 10)), for each sample and for the mean difference.
#[must_use]
pub fn fidelity<R: Real, const M: usize>(test: &Illuminated<R, M>, reference: &Illuminated<R, M>) -> Fidelity<R, M> {
    let colours = |light: &Illuminated<R, M>| {
        let cam = Cam02::new(light.white);
        light.samples.map(|xyz| cam.uniform(xyz))
    };
    let (test_colours, reference_colours) = (colours(test), colours(reference));
    let differences: [R; M] =
        core::array::from_fn(|i| crate::colour::delta_e_ab(test_colours[i], reference_colours[i]));
    let mut sum = R::ZERO;
    for &difference in &differences {
        sum += difference;
    }
    Fidelity {
        test_colours,
        reference_colours,
        differences,
        special: differences.map(index),
        rf: index(sum / R::from_usize(M)),
        rg: gamut_index(&test_colours, &reference_colours),
    }
}

/// The index of a colour difference. The exponent is at most 10, so that nothing overflows.
fn index<R: Real>(difference: R) -> R {
    let ten = R::from_f64(10.0);
    let linear = R::from_f64(100.0) - R::from_f64(FACTOR) * difference;
    ten * ((linear / ten).exp() + R::ONE).ln()
}

fn gamut_index<R: Real, const M: usize>(test: &[[R; 3]; M], reference: &[[R; 3]; M]) -> R {
    let mut sums = [[[R::ZERO; 2]; SECTORS]; 2];
    let mut counts = [R::ZERO; SECTORS];
    for (test, reference) in test.iter().zip(reference) {
        let turn = R::TWO * R::PI;
        let angle = reference[2].atan2(reference[1]);
        let angle = if angle < R::ZERO { angle + turn } else { angle };
        let sector = (angle / turn * R::from_usize(SECTORS)).to_usize().min(SECTORS - 1);
        counts[sector] += R::ONE;
        for (sums, colour) in sums.iter_mut().zip([test, reference]) {
            sums[sector][0] += colour[1];
            sums[sector][1] += colour[2];
        }
    }
    let [test, reference] = sums.map(|sums| area(sums.into_iter().zip(counts)));
    R::from_f64(100.0) * test / reference
}

/// Twice the signed area of the polygon of the means of sectors, given by sums and counts. Sectors without samples have no corner.
fn area<R: Real>(sectors: impl Iterator<Item = ([R; 2], R)>) -> R {
    let mut corners = sectors.filter(|(_, count)| *count > R::ZERO).map(|(sum, count)| sum.map(|sum| sum / count));
    let Some(first) = corners.next() else { return R::ZERO };
    let triangle = |a: [R; 2], b: [R; 2]| a[0] * b[1] - a[1] * b[0];
    let (sum, last) = corners.fold((R::ZERO, first), |(sum, corner), next| (sum + triangle(corner, next), next));
    sum + triangle(last, first)
}
