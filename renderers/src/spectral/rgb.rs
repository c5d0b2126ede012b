//! Colours by three components: the naive way, for comparison.

use spectral_core::colour::rgb;
use spectral_core::{Observer, tristimulus};

use super::{Colour, Monomial, Monomials, Palette, Radiance, Resolver, Role, Tabulated, Tracer, Y_INTEGRAL};

/// The wavelength in nm at which refraction is taken: the helium d line, where glass catalogues state the index.
const MEAN_WAVELENGTH: f64 = 587.5618;

/// Each spectrum's linear Rec. 709 components: a light's of its own colour, a reflectance's of its colour under D65 relative to white. Light
/// and reflectances are multiplied component by component.
#[derive(Clone, Debug)]
pub struct Components {
    leaves: Vec<[f64; 3]>,
}

impl Components {
    /// Takes the components of the spectra of a palette.
    ///
    /// # Errors
    /// A text that says what is wrong with which leaf.
    pub fn new(palette: &Palette) -> Result<Self, String> {
        let observer = Observer::cie_1931_2deg();
        let d65 = Tabulated::d65();
        let [_, white, _] = tristimulus(&observer, &d65.spectrum()?, 380.0, 780.0);
        let mut leaves = Vec::new();
        for (leaf, role) in palette.leaves() {
            let xyz = match role {
                Role::Light => tristimulus(&observer, &leaf.spectrum()?, 380.0, 780.0).map(|v| v / Y_INTEGRAL),
                Role::Reflectance => {
                    let lit = leaf.times(&d65);
                    tristimulus(&observer, &lit.spectrum()?, 380.0, 780.0).map(|v| v / white)
                }
            };
            leaves.push(rgb::xyz_to_linear_rgb(xyz));
        }
        Ok(Self { leaves })
    }

    /// The components of a leaf of the palette; `None` if there is no such leaf.
    pub fn components(&self, leaf: u32) -> Option<&[f64; 3]> {
        self.leaves.get(leaf as usize)
    }

    fn product(&self, monomials: &Monomials, monomial: Monomial) -> [f64; 3] {
        let factors = monomials.leaves(monomial).iter().filter_map(|leaf| self.leaves.get(*leaf as usize));
        factors.fold([1.0; 3], |p, f| core::array::from_fn(|a| p[a] * f[a]))
    }

    fn sum(&self, radiance: &Radiance, monomials: &Monomials) -> [f64; 3] {
        let mut sum = [0.0; 3];
        for (monomial, weight) in radiance.terms() {
            let product = self.product(monomials, *monomial);
            sum = core::array::from_fn(|a| sum[a] + weight * product[a]);
        }
        sum
    }
}

impl Resolver for &Components {
    fn resolve(&mut self, radiance: &Radiance, tracer: &mut dyn Tracer) -> Colour {
        let mut sum = self.sum(radiance, tracer.monomials());
        for (deferred, through, weight) in radiance.deferred() {
            let traced = tracer.trace(*deferred, MEAN_WAVELENGTH);
            let light = self.sum(&traced, tracer.monomials());
            let through = self.product(tracer.monomials(), *through);
            sum = core::array::from_fn(|a| sum[a] + weight * light[a] * through[a]);
        }
        Colour { xyz: rgb::linear_rgb_to_xyz(sum), intervals: 3, ..Colour::default() }
    }
}
