//! The scene's spectra as the leaves of rendering expressions.

use spectral_core::spectrum::{Outside, Planck, RadiationConstant, Spectrum};
use spectral_core::tables;

use crate::scene::{SpectrumData, SpectrumKind};

/// What a spectrum stands for; the three-component representation depends on it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// Radiance, intensity or irradiance of a light.
    Light,
    /// A reflectance or transmittance.
    Reflectance,
}

/// A spectrum that is linear between nodes and 0 outside them.
#[derive(Clone, Debug, PartialEq)]
pub struct Tabulated {
    /// Wavelengths of the nodes in nm, increasing; at least two.
    pub wavelengths: Vec<f64>,
    /// Values at the nodes.
    pub values: Vec<f64>,
}

/// A spectrum in an expression: a number times a leaf of the palette, or a number alone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Factor {
    /// The number.
    pub scale: f64,
    /// The leaf; `None` for the constant 1.
    pub leaf: Option<u32>,
}

/// All spectra that expressions may refer to, each shape and role once.
#[derive(Clone, Debug, Default)]
pub struct Palette {
    leaves: Vec<(Tabulated, Role)>,
}

impl Palette {
    /// The leaves, in the order of their numbers.
    pub fn leaves(&self) -> &[(Tabulated, Role)] {
        &self.leaves
    }

    /// The factor for a spectrum of the scene in a role; new leaves are added as they are met.
    pub fn factor(&mut self, spectrum: &SpectrumData, role: Role) -> Factor {
        let (scale, tabulated) = match &spectrum.kind {
            SpectrumKind::Constant(value) if role == Role::Reflectance => {
                return Factor { scale: *value, leaf: None };
            }
            SpectrumKind::Constant(value) => (*value, Tabulated::flat()),
            SpectrumKind::Table { wavelengths, values } => {
                (1.0, Tabulated { wavelengths: wavelengths.clone(), values: values.clone() })
            }
            SpectrumKind::D65 { scale } => (scale / crate::scene::D65_NORMALISATION, Tabulated::d65()),
            SpectrumKind::Blackbody { temperature, scale, wavelength_min, wavelength_max } => {
                (*scale, Tabulated::blackbody(*temperature, *wavelength_min, *wavelength_max))
            }
        };
        self.leaf(tabulated, scale, role)
    }

    /// The factor `scale` times a spectrum, equal up to a number or not to one that is there already.
    pub fn leaf(&mut self, spectrum: Tabulated, scale: f64, role: Role) -> Factor {
        for (number, (known, known_role)) in (0..).zip(&self.leaves) {
            if *known_role == role
                && let Some(ratio) = spectrum.ratio_to(known)
            {
                return Factor { scale: scale * ratio, leaf: Some(number) };
            }
        }
        let leaf = u32::try_from(self.leaves.len()).ok();
        self.leaves.push((spectrum, role));
        Factor { scale, leaf }
    }
}

impl Tabulated {
    /// A function of the wavelength in nm at whole nanometres over 360–830 nm.
    pub fn sampled(function: impl Fn(f64) -> f64) -> Self {
        let wavelengths: Vec<f64> = (360..=830).map(f64::from).collect();
        let values = wavelengths.iter().map(|w| function(*w)).collect();
        Self { wavelengths, values }
    }

    /// The spectrum times a number.
    pub fn scaled(&self, factor: f64) -> Self {
        Self { wavelengths: self.wavelengths.clone(), values: self.values.iter().map(|v| v * factor).collect() }
    }

    fn flat() -> Self {
        Self { wavelengths: vec![360.0, 830.0], values: vec![1.0, 1.0] }
    }

    /// CIE standard illuminant D65, 100 at 560 nm.
    pub fn d65() -> Self {
        let table = &tables::illuminants::D65;
        let wavelengths = (0..table.samples.double.len())
            .map(|i| f64::from(table.first) + f64::from(table.step) * f64::from(u32::try_from(i).unwrap_or(0)))
            .collect();
        Self { wavelengths, values: table.samples.double.to_vec() }
    }

    /// Planck's radiance at whole nanometres, W m⁻² sr⁻¹ nm⁻¹, over the part of the range that is near the visible one.
    fn blackbody(temperature: f64, from: f64, to: f64) -> Self {
        let [from, to] = [from, to].map(|limit| limit.clamp(360.0, 830.0));
        if from >= to {
            return Self { wavelengths: vec![360.0, 830.0], values: vec![0.0; 2] };
        }
        let mut wavelengths = vec![from];
        let mut next = from.floor() + 1.0;
        while next < to {
            wavelengths.push(next);
            next += 1.0;
        }
        wavelengths.push(to);
        let values = match Planck::new(temperature, RadiationConstant::Si2019) {
            Ok(planck) => wavelengths.iter().map(|w| planck.value(*w)).collect(),
            Err(_) => vec![0.0; wavelengths.len()],
        };
        Self { wavelengths, values }
    }

    /// The number that makes this of `other`, if there is one.
    fn ratio_to(&self, other: &Self) -> Option<f64> {
        if self.wavelengths != other.wavelengths {
            return None;
        }
        if self.values == other.values {
            return Some(1.0);
        }
        let place = other.values.iter().position(|v| *v != 0.0)?;
        let ratio = self.values[place] / other.values[place];
        let same = |(mine, theirs): (&f64, &f64)| (mine - ratio * theirs).abs() <= 2.0 * f64::EPSILON * mine.abs();
        (ratio > 0.0 && self.values.iter().zip(&other.values).all(same)).then_some(ratio)
    }

    /// The product with another spectrum, taken at the nodes of both and linear between them.
    ///
    /// Between nodes the true product is quadratic: the error is a quarter of the product of both factors' differences
    /// between neighbouring nodes, at most.
    pub fn times(&self, other: &Self) -> Self {
        let mut wavelengths: Vec<f64> = self.wavelengths.iter().chain(&other.wavelengths).copied().collect();
        wavelengths.sort_by(f64::total_cmp);
        wavelengths.dedup();
        let values = wavelengths.iter().map(|w| self.value(*w) * other.value(*w)).collect();
        Self { wavelengths, values }
    }

    fn value(&self, wavelength: f64) -> f64 {
        self.spectrum().map_or(0.0, |s| s.value(wavelength))
    }

    /// The spectrum for the core's integrals.
    ///
    /// # Errors
    /// A text that says what is wrong with the nodes.
    pub fn spectrum(&self) -> Result<spectral_core::spectrum::PiecewiseLinear<'_, f64>, String> {
        spectral_core::spectrum::PiecewiseLinear::new(&self.wavelengths, &self.values, Outside::Zero)
            .map_err(|e| e.to_string())
    }
}
