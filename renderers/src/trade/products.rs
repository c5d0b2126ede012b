//! Pixels as sums of products of spectra, with their colours in truth.

use alloc::collections::BTreeMap;

use spectral_core::spectrum::{Outside, Spectrum as _};
use spectral_core::tables::{UniformTable, colorchecker, find_light};
use spectral_core::{Observer, tristimulus};

use crate::geometry::sampling::SobolSequence;
use crate::scene::{Emitter, Scene, SpectrumKind, builtin};
use crate::spectral::{
    Band, Deferred, Factor, FactorOrder, Monomial, Monomials, Palette, Radiance, Role, Tabulated, Tracer, Y_INTEGRAL,
};
use crate::verify::oracle::gauss_legendre;
use crate::whitted::{Whitted, Worker};

/// What a pixel's light is, in both orders of factors.
pub(super) struct Pixels {
    pub(super) palette: Palette,
    /// Products and pixels whose factors may be reordered.
    pub(super) free: (Monomials, Vec<Radiance>),
    /// The same with factors in the order from the eye to the light.
    pub(super) kept: (Monomials, Vec<Radiance>),
    /// XYZ of each pixel.
    pub(super) truth: Vec<[f64; 3]>,
    /// The light that counts most.
    pub(super) dominant: Tabulated,
}

/// Products alone: nothing is left to trace.
pub(super) struct Known<'m>(pub(super) &'m Monomials);

impl Tracer for Known<'_> {
    fn monomials(&self) -> &Monomials {
        self.0
    }
    fn trace(&mut self, _: Deferred, _: Band) -> Radiance {
        Radiance::default()
    }
}

/// A built-in table as nodes and values.
pub(super) fn tabulated(table: &UniformTable) -> Tabulated {
    let values = table.samples.double.to_vec();
    let wavelengths = (0_u32..).take(values.len());
    let wavelengths = wavelengths.map(|i| f64::from(table.first) + f64::from(table.step) * f64::from(i)).collect();
    Tabulated { wavelengths, values }
}

/// ∫Sȳ / ∫ȳ.
fn luminance(spectrum: &Tabulated) -> Result<f64, String> {
    Ok(tristimulus(&Observer::cie_1931_2deg(), &spectrum.spectrum()?, 380.0, 780.0)[1] / Y_INTEGRAL)
}

/// A built-in light by its name, scaled to a luminance.
pub(super) fn lamp(name: &str, level: f64) -> Result<Tabulated, String> {
    let table = find_light(name).ok_or_else(|| format!("no built-in light is called {name}"))?;
    let lamp = tabulated(table);
    Ok(lamp.scaled(level / luminance(&lamp)?))
}

/// A built-in scene whose lamps are another one.
pub(super) fn scene_under(name: &str, light: Option<&Tabulated>) -> Result<Scene, String> {
    let mut scene = builtin::load(name, &[]).map_err(|e| e.to_string())?;
    let Some(light) = light else { return Ok(scene) };
    for emitter in &scene.emitters {
        if let Emitter::Area { radiance, .. } = emitter {
            let Tabulated { wavelengths, values } = light.clone();
            scene.spectra[radiance.0].kind = SpectrumKind::Table { wavelengths, values };
        }
    }
    Ok(scene)
}

/// The `ColorChecker`'s patches as leaves of a palette.
fn patches(palette: &mut Palette) -> Vec<Factor> {
    let patch = |table: &&UniformTable| {
        let spectrum = table.spectrum::<f64>(Outside::Hold);
        palette.leaf(Tabulated::sampled(|w| spectrum.value(w)), 1.0, Role::Reflectance)
    };
    let all: Vec<&UniformTable> = colorchecker::ALL.iter().collect();
    all.iter().map(patch).collect()
}

impl Pixels {
    /// Direct light in a picture of a scene, one camera ray through the middle of each of side × side pixels.
    pub(super) fn of_scene(scene: &Scene, side: u32) -> Result<Self, String> {
        let mut palette = Palette::default();
        let whitted = Whitted::new(scene, [side; 2], &mut palette).map_err(|e| e.to_string())?;
        let seen = |order: FactorOrder| {
            let mut worker = Worker::new(&whitted, order);
            let mut radiances = Vec::new();
            for (x, y) in (0..side).flat_map(|y| (0..side).map(move |x| (x, y))) {
                let mut radiance = Radiance::default();
                worker.start_pixel(SobolSequence::for_pixel(x, y, 0));
                worker.sample(f64::from(x) + 0.5, f64::from(y) + 0.5, 1.0, &mut radiance);
                radiances.push(radiance);
            }
            (worker.monomials().clone(), radiances)
        };
        let (free, kept) = (seen(FactorOrder::Free), seen(FactorOrder::Kept));
        Self::new(palette, free, kept)
    }

    /// Light of a lamp that one of the `ColorChecker`'s patches reflected, or two of them one after the other, all of them, each at some
    /// brightnesses.
    pub(super) fn of_patches(light: Tabulated, reflections: u32, brightnesses: u32) -> Result<Self, String> {
        let mut palette = Palette::default();
        let light = palette.leaf(light, 1.0, Role::Light);
        let patches = patches(&mut palette);
        let rows = |order: FactorOrder| {
            let (mut monomials, mut radiances) = (Monomials::new(order), Vec::new());
            for (i, near) in patches.iter().enumerate() {
                for far in &patches[if reflections > 1 { 0 } else { patches.len() - 1 }..] {
                    let mut product = monomials.times(Monomial::default(), 1.0, *near);
                    if reflections > 1 {
                        product = monomials.times(product.0, product.1, *far);
                    }
                    product = monomials.times(product.0, product.1, light);
                    // Every pixel has another brightness.
                    for k in 0..brightnesses {
                        let mut radiance = Radiance::default();
                        let part = [0.9, 0.35, 0.6, 0.2, 0.75][(i + radiances.len()) % 5];
                        radiance
                            .add(product.0, product.1 * part * (1.0 - 0.9 * f64::from(k) / f64::from(brightnesses)));
                        radiances.push(radiance);
                    }
                }
            }
            (monomials, radiances)
        };
        let (free, kept) = (rows(FactorOrder::Free), rows(FactorOrder::Kept));
        Self::new(palette, free, kept)
    }

    /// Light of two lamps, mixed in another way in each pixel, that one of the `ColorChecker`'s patches reflected.
    pub(super) fn of_mixtures(lamps: [Tabulated; 2], mixtures: u32) -> Result<Self, String> {
        let mut palette = Palette::default();
        let lamps = lamps.map(|lamp| palette.leaf(lamp, 1.0, Role::Light));
        let patches = patches(&mut palette);
        let rows = |order: FactorOrder| {
            let (mut monomials, mut radiances) = (Monomials::new(order), Vec::new());
            for (patch, k) in patches.iter().flat_map(|patch| (0..mixtures).map(move |k| (patch, k))) {
                let share = (f64::from(k) + 0.5) / f64::from(mixtures);
                let mut radiance = Radiance::default();
                for (lamp, share) in lamps.iter().zip([share, 1.0 - share]) {
                    let (product, weight) = monomials.times(Monomial::default(), 0.8 * share, *patch);
                    let (product, weight) = monomials.times(product, weight, *lamp);
                    radiance.add(product, weight);
                }
                radiances.push(radiance);
            }
            (monomials, radiances)
        };
        let (free, kept) = (rows(FactorOrder::Free), rows(FactorOrder::Kept));
        Self::new(palette, free, kept)
    }

    fn new(
        palette: Palette,
        free: (Monomials, Vec<Radiance>),
        kept: (Monomials, Vec<Radiance>),
    ) -> Result<Self, String> {
        let lights = palette.leaves().iter().filter(|(_, role)| *role == Role::Light);
        let mut dominant = (0.0, None);
        for (light, _) in lights {
            let own = luminance(light)?;
            if own > dominant.0 {
                dominant = (own, Some(light.clone()));
            }
        }
        let dominant = dominant.1.ok_or("the pixels have no light")?;
        let mut exact = Exact { palette: &palette, known: BTreeMap::new() };
        let truth = free.1.iter().map(|radiance| exact.colour(&free.0, radiance)).collect::<Result<_, _>>()?;
        Ok(Self { palette, free, kept, truth, dominant })
    }
}

/// Integrals of products of spectra, piece by piece between the nodes of all of them and of the observer, by Gauss's rule, which is
/// exact for polynomials of a degree that no product here has.
struct Exact<'p> {
    palette: &'p Palette,
    known: BTreeMap<Vec<u32>, [f64; 3]>,
}

impl Exact<'_> {
    fn colour(&mut self, monomials: &Monomials, radiance: &Radiance) -> Result<[f64; 3], String> {
        let mut sum = [0.0; 3];
        for (monomial, weight) in radiance.terms() {
            let leaves = monomials.leaves(*monomial);
            let product = match self.known.get(leaves) {
                Some(known) => *known,
                None => {
                    let product = product_tristimulus(self.palette, leaves)?;
                    self.known.insert(leaves.to_vec(), product);
                    product
                }
            };
            sum = core::array::from_fn(|a| sum[a] + weight * product[a]);
        }
        Ok(sum)
    }
}

/// XYZ of a product of leaves, Y = 1 for a flat radiance of 1.
fn product_tristimulus(palette: &Palette, leaves: &[u32]) -> Result<[f64; 3], String> {
    let factors: Vec<&Tabulated> =
        leaves.iter().filter_map(|leaf| palette.leaves().get(*leaf as usize)).map(|(leaf, _)| leaf).collect();
    let spectra = factors.iter().map(|factor| factor.spectrum()).collect::<Result<Vec<_>, _>>()?;
    let mut nodes: Vec<f64> = (380..=780).map(f64::from).collect();
    nodes.extend(factors.iter().flat_map(|f| &f.wavelengths).filter(|w| **w > 380.0 && **w < 780.0));
    nodes.sort_by(f64::total_cmp);
    nodes.dedup();
    let (observer, rule) = (Observer::<f64>::cie_1931_2deg(), gauss_legendre(4));
    let mut sum = [0.0; 3];
    for pair in nodes.windows(2) {
        for &(node, weight) in &rule {
            let wavelength = pair[0] + (pair[1] - pair[0]) * node;
            let value = spectra.iter().map(|s| s.value(wavelength)).product::<f64>() * weight * (pair[1] - pair[0]);
            let matching = observer.value(wavelength);
            sum = core::array::from_fn(|a| sum[a] + value * matching[a]);
        }
    }
    Ok(sum.map(|v| v / Y_INTEGRAL))
}
