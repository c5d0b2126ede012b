//! Lights by photometric quantities: the factor that gives a spectrum the stated luminance, intensity or illuminance.

use core::f64::consts::PI;

use spectral_core::action::MAXIMUM_LUMINOUS_EFFICACY;
use spectral_core::{Observer, tristimulus};

use super::props::Props;
use super::xml::Node;
use super::{Emitter, Scene, SceneError, SpectrumData, SpectrumId, SpectrumKind};
use crate::spectral::{Palette, Role, Tabulated};

/// Where photometric quantities are summed, nm.
const VISIBLE: [f64; 2] = [380.0, 780.0];
/// How far the scaled spectrum may be from what was stated, relative: some roundings of each node; more is underflow.
const TOLERANCE: f64 = 1e-9;

impl SpectrumKind {
    /// The photometric quantity of a radiometric spectrum, K_m ∫ S ȳ dλ with K_m = 683.002 lm/W: luminance in cd/m² of
    /// radiance in W m⁻² sr⁻¹ nm⁻¹, luminous intensity in cd of radiant intensity, illuminance in lx of irradiance.
    ///
    /// ȳ is that of CIE 1931 over 380–780 nm; the integral is exact for linear interpolation between nodes (of ȳ at 1 nm, of
    /// tables at their own nodes, of D65 at 5 nm, of black bodies at whole nanometres), as in every renderer.
    #[must_use]
    pub fn photometric(&self) -> f64 {
        let mut palette = Palette::default();
        let light = SpectrumData { kind: self.clone(), label: String::new() };
        let factor = palette.factor(&light, Role::Light);
        let Some((leaf, _)) = palette.leaves().first() else { return 0.0 };
        factor.scale * MAXIMUM_LUMINOUS_EFFICACY * luminous(leaf)
    }

    /// The function times a number.
    #[must_use]
    pub fn scaled(&self, factor: f64) -> Self {
        match self {
            Self::Constant(value) => Self::Constant(value * factor),
            Self::Table { wavelengths, values } => {
                let values = values.iter().map(|value| value * factor).collect();
                Self::Table { wavelengths: wavelengths.clone(), values }
            }
            Self::D65 { scale } => Self::D65 { scale: scale * factor },
            &Self::Blackbody { temperature, scale, wavelength_min, wavelength_max } => {
                Self::Blackbody { temperature, scale: scale * factor, wavelength_min, wavelength_max }
            }
        }
    }
}

impl Scene {
    /// The spectrum of the light with the largest luminous flux; `None` in a scene without lights.
    ///
    /// What parallel light and a uniform environment send into the scene is counted on a quarter of the area of its surfaces, the mean
    /// shadow of a convex body (Cauchy). The constant ambient term counts only where there is nothing else.
    #[must_use]
    pub fn dominant_light(&self) -> Option<SpectrumId> {
        let flux = |emitter: &Emitter| {
            let (spectrum, factor) = self.flux_factor(emitter);
            (spectrum, factor * self.spectrum(spectrum).kind.photometric())
        };
        let is_ambient = |emitter: &&Emitter| matches!(emitter, Emitter::Ambient { .. });
        let strongest = self.emitters.iter().filter(|e| !is_ambient(e)).map(flux).max_by(|a, b| a.1.total_cmp(&b.1));
        strongest.or_else(|| self.emitters.iter().find(is_ambient).map(flux)).map(|(spectrum, _)| spectrum)
    }

    /// The spectrum of a light, and its luminous flux for each unit of the spectrum's photometric quantity.
    fn flux_factor(&self, emitter: &Emitter) -> (SpectrumId, f64) {
        let shadow = || self.shapes.iter().map(|shape| shape.geometry.area()).sum::<f64>() / 4.0;
        match emitter {
            Emitter::Area { shape, radiance } => {
                let area = self.shapes.get(shape.0).map_or(0.0, |shape| shape.geometry.area());
                (*radiance, PI * area)
            }
            Emitter::Point { intensity, .. } => (*intensity, 4.0 * PI),
            Emitter::Luminaire { luminaire, spectrum, .. } => (*spectrum, luminaire.intensity().flux()),
            Emitter::Directional { irradiance, .. } => (*irradiance, shadow()),
            Emitter::Constant { radiance, .. } => (*radiance, 4.0 * PI * shadow()),
            Emitter::Ambient { radiance } => (*radiance, PI),
        }
    }
}

/// ∫ S ȳ dλ.
fn luminous(leaf: &Tabulated) -> f64 {
    match leaf.spectrum() {
        Ok(spectrum) => tristimulus(&Observer::cie_1931_2deg(), &spectrum, VISIBLE[0], VISIBLE[1])[1],
        Err(_) => 0.0,
    }
}

/// What a light is to have: the photometric quantity of its own spectrum, and the element that states it.
pub(crate) struct Stated<'a> {
    node: Node<'a>,
    value: f64,
}

impl<'a> Stated<'a> {
    /// Takes the one property of several that is there: its name, and how much of it the light has for each unit of its own
    /// photometric quantity (π times the area for the luminous flux of a light whose own quantity is luminance).
    pub(crate) fn take(props: &mut Props<'a>, quantities: &[(&str, f64)]) -> Result<Option<Self>, SceneError> {
        let mut found: Option<(Self, &str)> = None;
        for &(name, unit) in quantities {
            let Some((node, quantity)) = positive(props, name)? else { continue };
            if let Some((_, other)) = found {
                return Err(node.error(format!("{name:?} excludes {other:?}")));
            }
            let value = quantity / unit;
            if !(value > 0.0 && value.is_finite()) {
                return Err(node.error(format!("{name:?} leaves the range of numbers here")));
            }
            found = Some((Self { node, value }, name));
        }
        Ok(found.map(|(stated, _)| stated))
    }

    /// The unit of a quantity, for a light that has its own value elsewhere.
    pub(crate) const fn unit(node: Node<'a>) -> Self {
        Self { node, value: 1.0 }
    }

    /// The spectrum scaled to the stated value.
    pub(crate) fn apply(&self, kind: &SpectrumKind) -> Result<SpectrumKind, SceneError> {
        let given = kind.photometric();
        if given <= 0.0 {
            return Err(self.node.error("the light's spectrum has nothing between 380 and 780 nm to be scaled"));
        }
        let scaled = kind.scaled(self.value / given);
        let error = (scaled.photometric() / self.value - 1.0).abs();
        if error <= TOLERANCE {
            Ok(scaled)
        } else {
            Err(self.node.error("the light's scaled spectrum leaves the range of numbers"))
        }
    }
}

/// Takes a positive number and the element that holds it.
pub(crate) fn positive<'a>(props: &mut Props<'a>, name: &str) -> Result<Option<(Node<'a>, f64)>, SceneError> {
    let Some(node) = props.peek(name) else { return Ok(None) };
    let Some(value) = props.float(name)? else { return Ok(None) };
    if value > 0.0 {
        Ok(Some((node, value)))
    } else {
        Err(node.error(format!("{name:?} must be positive, not {value}")))
    }
}
