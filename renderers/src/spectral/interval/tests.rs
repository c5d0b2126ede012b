use spectral_core::Observer;
use spectral_core::colour::{delta_e_ab, xyz_to_lab};

use super::{IntervalMemory, IntervalSettings, Intervals, SharedIntervals, measure, parts};
use crate::spectral::{
    Band, Deferred, FactorOrder, Monomial, Monomials, Palette, Radiance, Resolver, Role, Tabulated, Tracer, Y_INTEGRAL,
};

/// Straight lines in 1/λ² through light at the ends of even steps.
#[allow(clippy::cast_precision_loss, clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "few steps")]
fn on_lines(ends: &[f64], wavelength: f64) -> f64 {
    let [first, last] = [380.0, 780.0].map(measure);
    let place = (measure(wavelength) - first) / (last - first) * (ends.len() - 1) as f64;
    let step = (place.max(0.0) as usize).min(ends.len() - 2);
    ends[step] + (ends[step + 1] - ends[step]) * (place - step as f64)
}

/// The same, linear between whole nm, as hats are.
fn by_nm(ends: &[f64], wavelength: f64) -> f64 {
    let below = wavelength.floor();
    let [from, to] = [below, below + 1.0].map(|nm| on_lines(ends, nm));
    from + (to - from) * (wavelength - below)
}

#[allow(clippy::cast_precision_loss, clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "whole nm")]
fn value(leaf: &Tabulated, wavelength: f64) -> f64 {
    let step = (wavelength - 360.0) as usize;
    let t = wavelength - 360.0 - step as f64;
    leaf.values[step] + t * (leaf.values[step + 1] - leaf.values[step])
}

/// Dense integration: Gauss' rule of three points on each nm, exact for polynomials of the fifth degree.
fn integrated(spectrum: impl Fn(f64) -> f64) -> [f64; 3] {
    let observer = Observer::<f64>::cie_1931_2deg();
    let offset = 0.5 * 0.6_f64.sqrt();
    let mut sums = [0.0; 3];
    for nm in 380_u16..780 {
        for (part, weight) in [(0.5 - offset, 5.0), (0.5, 8.0), (0.5 + offset, 5.0)] {
            let wavelength = f64::from(nm) + part;
            let scale = spectrum(wavelength) * weight / (18.0 * Y_INTEGRAL);
            let more = observer.value(wavelength);
            sums = core::array::from_fn(|a| sums[a] + scale * more[a]);
        }
    }
    sums
}

/// Deferred light that is on lines: products, with what they are at the ends of steps.
struct Lit {
    monomials: Monomials,
    light: Vec<Vec<(Monomial, Vec<f64>)>>,
}

impl Tracer for Lit {
    fn monomials(&self) -> &Monomials {
        &self.monomials
    }

    fn trace(&mut self, deferred: Deferred, band: Band) -> Radiance {
        let mut light = Radiance::default();
        for (monomial, ends) in &self.light[deferred.0 as usize] {
            light.add(*monomial, on_lines(ends, band.wavelength));
        }
        light
    }

    fn lines(
        &mut self,
        deferred: Deferred,
        (by, weight): (Monomial, f64),
        steps: &[u16],
        add: &mut dyn FnMut(Monomial, &[f64]),
    ) -> bool {
        let light = self.light[deferred.0 as usize].clone();
        let is_known =
            |(_, ends): &(Monomial, Vec<f64>)| steps.iter().any(|steps| usize::from(*steps) + 1 == ends.len());
        if !light.iter().all(is_known) {
            return false;
        }
        for (monomial, ends) in light {
            let scaled: Vec<f64> = ends.iter().map(|end| weight * end).collect();
            add(self.monomials.product(by, monomial), &scaled);
        }
        true
    }
}

/// Light on lines has the colour of dense integration, within the certified radius, from summed subdivisions and afresh.
#[test]
fn light_on_lines_has_its_colour_and_its_bound() -> Result<(), String> {
    let spectra = [37.0, 90.0].map(|period| Tabulated::sampled(|w| 0.5 + 0.4 * (w / period).sin()));
    let mut palette = Palette::default();
    let [a, b] = [0, 1].map(|k: usize| palette.leaf(spectra[k].clone(), 1.0, Role::Reflectance).leaf.unwrap_or(0));
    let mut monomials = Monomials::new(FactorOrder::Free);
    let [of_a, of_b] = [a, b].map(|leaf| monomials.times_leaf(Monomial::default(), leaf));
    let ends = [vec![1.0, 0.2], vec![0.0, 0.5, 0.0, 3.0, 0.7], vec![0.4, 0.1, 0.9]];
    let light = vec![
        vec![(Monomial::default(), ends[0].clone())],
        vec![(Monomial::default(), ends[1].clone()), (of_b, ends[2].clone())],
    ];
    let mut lit = Lit { monomials, light };
    let settings = IntervalSettings::default();
    let white = settings.white();
    let mut memory = IntervalMemory::default();
    let shared = SharedIntervals::new(&palette, settings, &mut memory)?;
    let mut intervals = Intervals::new(&shared);
    let mut sums = 0;
    for scale in [1e-3, 0.01, 0.1, 1.0] {
        let mut radiance = Radiance::default();
        radiance.add(of_b, 0.3 * scale);
        radiance.defer(Deferred(0), of_a, scale);
        radiance.defer(Deferred(1), of_a, 2.0 * scale);
        let spectrum = |w: f64, line: &dyn Fn(&[f64], f64) -> f64| {
            let [a, b] = [0, 1].map(|k: usize| value(&spectra[k], w));
            let [first, second, third] = [0, 1, 2].map(|k: usize| line(&ends[k], w));
            scale * (0.3 * b + a * first + 2.0 * a * (second + b * third))
        };
        let truth = integrated(|w| spectrum(w, &by_nm));
        let curve = integrated(|w| spectrum(w, &on_lines));
        let (terms, groups) = parts(&radiance, &mut lit);
        assert_eq!((terms.len(), groups.len()), (1 + 5 + 3, 0));
        let summed = intervals.summed(lit.monomials(), &terms);
        sums += usize::from(summed.is_some());
        let afresh = intervals.general((&terms, &groups), &mut lit);
        let resolved = intervals.resolve(&radiance, &mut lit);
        for found in [Some(afresh), Some(resolved), summed].into_iter().flatten() {
            for k in 0..3 {
                let off = (found.xyz[k] - truth[k]).abs();
                assert!(off <= found.radius[k] + 1e-12 * truth[k], "{scale}: {found:?}, not {truth:?}");
                // Hats are linear between whole nm: off by a quarter of the change of slope at each of a few bends.
                assert!((curve[k] - truth[k]).abs() <= 1e-3 * truth[k], "{scale}: {curve:?} {truth:?}");
            }
            let off = delta_e_ab(xyz_to_lab(found.xyz, white), xyz_to_lab(truth, white));
            assert!(off <= found.delta_e + 1e-9 && found.delta_e <= settings.threshold, "{scale}: {off} {found:?}");
        }
    }
    assert!(sums >= 1, "recorded subdivisions are enough: {sums} of 4");
    Ok(())
}

/// Lines of other numbers of steps are traced; light that is nothing is dark, and that is certain. Also without any spectrum.
#[test]
fn other_light_is_traced_and_no_light_is_dark() -> Result<(), String> {
    let palette = Palette::default();
    let one = Monomial::default();
    let light = vec![vec![(one, vec![0.2, 1.0, 0.4, 0.3])], Vec::new(), vec![(one, vec![1.0, 1.0])]];
    let mut lit = Lit { monomials: Monomials::new(FactorOrder::Free), light };
    let mut memory = IntervalMemory::default();
    let shared = SharedIntervals::new(&palette, IntervalSettings::default(), &mut memory)?;
    let mut intervals = Intervals::new(&shared);
    let [other, nothing, flat] = [0, 1, 2].map(|number| {
        let mut radiance = Radiance::default();
        radiance.defer(Deferred(number), one, 1.0);
        radiance
    });
    let (terms, groups) = parts(&other, &mut lit);
    assert_eq!((terms.len(), groups.len()), (0, 1));
    let dark = intervals.resolve(&nothing, &mut lit);
    assert_eq!((dark.xyz, dark.radius, dark.delta_e.to_bits()), ([0.0; 3], [0.0; 3], 0));
    // All hats together are 1.
    let flat = intervals.resolve(&flat, &mut lit);
    assert!((flat.xyz[1] - 1.0).abs() <= flat.radius[1] + 1e-12, "{flat:?}");
    Ok(())
}
