//! Colours by three components: the ways that fall short of spectra, for comparison.

use spectral_core::bilinear::{Reflection, Tensor};
use spectral_core::colour::RgbSpace;
use spectral_core::prefilter::Prefilter;
use spectral_core::{Observer, tristimulus};

use super::{Band, Colour, Monomial, Monomials, Palette, Radiance, Resolver, Role, Tabulated, Tracer, Y_INTEGRAL};

/// The wavelength in nm at which refraction is taken: the helium d line, where glass catalogues state the index.
pub(crate) const MEAN_WAVELENGTH: f64 = 587.5618;

type Rgb = [f64; 3];

/// Each spectrum's components in a linear RGB space, and how light and reflectances are multiplied.
///
/// A light has the components of its own colour. What those of a reflectance are depends on the way; so does the product.
#[derive(Clone, Debug)]
pub struct Components {
    space: RgbSpace,
    leaves: Vec<Rgb>,
    /// For each leaf, what it does as a factor; `None` where components are multiplied one by one.
    reflections: Option<Vec<Reflection<f64>>>,
}

impl Components {
    /// The naive way, in Rec. 709: a reflectance has its colour under D65 relative to white, and components are multiplied
    /// one by one.
    ///
    /// # Errors
    /// A text that says what is wrong with which leaf.
    pub fn naive(palette: &Palette) -> Result<Self, String> {
        Self::relative_to(palette, &Tabulated::d65(), rec_709()?)
    }

    /// Spectral prefiltering (Ward and Eydelberg-Vileshin 2002) in their sharp primaries: what the dominant light's direct light becomes
    /// on diffuse surfaces is exact. Components are multiplied one by one.
    ///
    /// # Errors
    /// A text that says what is wrong with which leaf, or that the dominant light has no positive component in this space.
    pub fn prefiltered(palette: &Palette, dominant: &Tabulated) -> Result<Self, String> {
        Self::relative_to(palette, dominant, RgbSpace::SHARP)
    }

    /// Any such way: a reflectance has the components of its colour under a light, relative to those of that light, in any space. With the
    /// space's white it is a naive way, with a scene's light a prefiltered one. Components are multiplied one by one.
    ///
    /// # Errors
    /// A text that says what is wrong with which leaf, or that the light has no positive component in this space.
    pub fn relative_to(palette: &Palette, light: &Tabulated, space: RgbSpace) -> Result<Self, String> {
        let (observer, light) = (Observer::cie_1931_2deg(), light.spectrum()?);
        let prefilter = Prefilter::new(&observer, &light, space).map_err(|e| e.to_string())?;
        let leaves = leaves(palette, &space, |reflectance| Ok(prefilter.material(&reflectance.spectrum()?)))?;
        Ok(Self { space, leaves, reflections: None })
    }

    /// The bilinear way of Granier and Damez: the components of the naive one, multiplied by a tensor for linear Rec. 709.
    ///
    /// The product isn't associative, so that factors must be [kept](super::FactorOrder::Kept) in order: light meets one surface after the
    /// other.
    ///
    /// # Errors
    /// A text that says what is wrong with which leaf.
    pub fn bilinear(palette: &Palette, tensor: &Tensor<f64>) -> Result<Self, String> {
        let naive = Self::naive(palette)?;
        let reflections = naive.leaves.iter().map(|colour| tensor.reflection(*colour)).collect();
        Ok(Self { reflections: Some(reflections), ..naive })
    }

    /// The components of a leaf of the palette; `None` if there is no such leaf.
    pub fn components(&self, leaf: u32) -> Option<&[f64; 3]> {
        self.leaves.get(leaf as usize)
    }

    /// The space of the components.
    pub(crate) const fn space(&self) -> &RgbSpace {
        &self.space
    }

    /// What a leaf does as a factor where components aren't multiplied one by one: a matrix.
    pub(crate) fn matrix(&self, leaf: u32) -> Option<[Rgb; 3]> {
        self.reflections.as_ref().and_then(|r| r.get(leaf as usize)).map(Reflection::matrix)
    }

    /// Whether components are multiplied one by one.
    pub(crate) const fn multiplies_one_by_one(&self) -> bool {
        self.reflections.is_none()
    }

    fn apply(&self, leaf: u32, light: Rgb) -> Rgb {
        let leaf = leaf as usize;
        if let Some(reflection) = self.reflections.as_ref().and_then(|r| r.get(leaf)) {
            return reflection.apply(light);
        }
        self.leaves.get(leaf).map_or(light, |factor| core::array::from_fn(|a| factor[a] * light[a]))
    }

    /// Light that meets the factors of a monomial, the last one first.
    pub(crate) fn through(&self, factors: &[u32], light: Rgb) -> Rgb {
        factors.iter().rev().fold(light, |light, leaf| self.apply(*leaf, light))
    }

    /// The colour of a product: its last factor is the light.
    fn product(&self, factors: &[u32]) -> Rgb {
        match factors.split_last() {
            None => [1.0; 3],
            Some((light, factors)) => {
                self.through(factors, self.leaves.get(*light as usize).copied().unwrap_or([1.0; 3]))
            }
        }
    }
}

/// The components of all leaves: lights by their own colour, reflectances by `reflectance`.
fn leaves(
    palette: &Palette,
    space: &RgbSpace,
    reflectance: impl Fn(&Tabulated) -> Result<Rgb, String>,
) -> Result<Vec<Rgb>, String> {
    let colour = |(leaf, role): &(Tabulated, Role)| match role {
        Role::Light => Ok(space.from_xyz(light_colour(leaf)?)),
        Role::Reflectance => reflectance(leaf),
    };
    palette.leaves().iter().map(colour).collect()
}

/// XYZ of a light, Y = 1 for a flat radiance of 1.
pub(super) fn light_colour(light: &Tabulated) -> Result<[f64; 3], String> {
    let observer = Observer::cie_1931_2deg();
    Ok(tristimulus(&observer, &light.spectrum()?, 380.0, 780.0).map(|v| v / Y_INTEGRAL))
}

/// Linear Rec. 709 with the white of the table of CIE D65, which the four digits of the standard round: so D65 has equal components.
pub(super) fn rec_709() -> Result<RgbSpace, String> {
    let [x, y, z] = light_colour(&Tabulated::d65())?;
    let sum = x + y + z;
    RgbSpace::new(RgbSpace::REC_709.primaries(), [x / sum, y / sum]).map_err(|e| e.to_string())
}

/// The components of a reflectance: its colour under D65, which has equal components in this space.
pub(super) fn surface_colour(reflectance: &Tabulated, space: RgbSpace) -> Result<Rgb, String> {
    let (observer, white) = (Observer::cie_1931_2deg(), Tabulated::d65());
    let white = white.spectrum()?;
    let prefilter = Prefilter::new(&observer, &white, space).map_err(|e| e.to_string())?;
    Ok(prefilter.material(&reflectance.spectrum()?))
}

/// Colours by three components: what one thread remembers of products.
#[derive(Clone, Debug)]
pub struct ComponentResolver<'a> {
    components: &'a Components,
    products: Vec<Option<Rgb>>,
}

impl<'a> ComponentResolver<'a> {
    /// A resolver that has met no product.
    pub const fn new(components: &'a Components) -> Self {
        Self { components, products: Vec::new() }
    }

    fn product(&mut self, monomials: &Monomials, monomial: Monomial) -> Rgb {
        if self.products.len() <= monomial.index() {
            self.products.resize(monomials.len(), None);
        }
        let product = || self.components.product(monomials.leaves(monomial));
        match self.products.get_mut(monomial.index()) {
            Some(known) => *known.get_or_insert_with(product),
            None => product(),
        }
    }

    fn sum(&mut self, radiance: &Radiance, monomials: &Monomials) -> Rgb {
        let mut sum = [0.0; 3];
        for (monomial, weight) in radiance.terms() {
            let product = self.product(monomials, *monomial);
            sum = core::array::from_fn(|a| sum[a] + weight * product[a]);
        }
        sum
    }
}

impl Resolver for ComponentResolver<'_> {
    fn resolve(&mut self, radiance: &Radiance, tracer: &mut dyn Tracer) -> Colour {
        let mut sum = self.sum(radiance, tracer.monomials());
        for (deferred, through, weight) in radiance.deferred() {
            let traced = tracer.trace(*deferred, Band::single(MEAN_WAVELENGTH));
            let light = self.sum(&traced, tracer.monomials());
            let seen = self.components.through(tracer.monomials().leaves(*through), light);
            sum = core::array::from_fn(|a| sum[a] + weight * seen[a]);
        }
        Colour { xyz: self.components.space.to_xyz(sum), intervals: 3, ..Colour::default() }
    }
}

#[cfg(test)]
mod tests {
    use super::{Components, Reflection, RgbSpace, Tensor};

    /// The product isn't associative: what is nearest to the eye comes last.
    #[test]
    fn light_meets_one_surface_after_the_other() {
        let tensor = Tensor::rec_709();
        let [near, far, light] = [[0.8, 0.1, 0.3], [0.2, 0.7, 0.1], [0.4, 0.9, 1.0]];
        let leaves = vec![near, far, light];
        let reflections: Vec<Reflection<f64>> = leaves.iter().map(|colour| tensor.reflection(*colour)).collect();
        let components = Components { space: RgbSpace::REC_709, leaves, reflections: Some(reflections) };
        let close = |a: [f64; 3], b: [f64; 3]| a.iter().zip(b).all(|(a, b)| (a - b).abs() <= 1e-15);
        let expected = tensor.product(near, tensor.product(far, light));
        assert!(close(components.product(&[0, 1, 2]), expected));
        assert!(close(components.through(&[0, 1], light), expected));
        assert!(!close(components.product(&[1, 0, 2]), expected));
    }
}
