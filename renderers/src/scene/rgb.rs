//! `<rgb>`: spectra for components.

use std::sync::LazyLock;

use spectral_core::colour::RgbSpace;
use spectral_core::spectrum::{Outside, Spectrum};
use spectral_core::tables::illuminants;
use spectral_core::upsampling::{LightUpsampler, Upsampler, UpsamplerError, UpsamplingError};

use super::props::parse_list;
use super::spectrum::{Role, bare_number};
use super::xml::Node;
use super::{D65_NORMALISATION, SceneError, SpectrumKind};

/// Nodes in nm at which an upsampled spectrum is kept, as the core defines it.
const NODES: core::ops::RangeInclusive<u16> = 360..=830;
const STEP: usize = 5;

static REFLECTANCES: LazyLock<Result<Upsampler<f64>, UpsamplerError>> =
    LazyLock::new(|| Upsampler::d65(&RgbSpace::REC_709));

/// Reads `<rgb>`, linear Rec. 709 components (or one number for all three): greys are what a bare number is; for colours a sigmoid
/// is found (Jakob and Hanika 2019), times D65 for light. The components come back within 1e-12 under D65.
pub(crate) fn parse(node: Node<'_>, role: Role) -> Result<SpectrumKind, SceneError> {
    node.allow_attributes(&["name", "value"])?;
    node.no_children()?;
    let values = parse_list(node, node.require("value")?)?;
    match values.as_slice() {
        &[value] => Ok(bare_number(value, role)),
        &[r, g, b] if r == g && g == b => Ok(bare_number(r, role)),
        &[r, g, b] => coloured(node, [r, g, b], role),
        other => Err(node.error(format!("expected one or three numbers, not {}", other.len()))),
    }
}

fn coloured(node: Node<'_>, rgb: [f64; 3], role: Role) -> Result<SpectrumKind, SceneError> {
    let fail = |error: UpsamplingError| node.error(error.to_string());
    match role {
        Role::Fraction => {
            let upsampler = REFLECTANCES.as_ref().map_err(|error| node.error(error.to_string()))?;
            let sigmoid = upsampler.reflectance(rgb).map_err(fail)?;
            Ok(table(|wavelength| sigmoid.value(wavelength)))
        }
        Role::Emission => {
            let upsampler = LightUpsampler::<_, f64>::d65(&RgbSpace::REC_709);
            let upsampler = upsampler.map_err(|error| node.error(error.to_string()))?;
            let emission = upsampler.emission(rgb).map_err(fail)?;
            let d65 = illuminants::D65.spectrum::<f64>(Outside::Zero);
            // The scale of a grey <rgb>, so that colours pass into greys without a step.
            let scale = 2.0 * rgb.into_iter().fold(0.0, f64::max) / D65_NORMALISATION;
            Ok(table(|wavelength| scale * emission.sigmoid().value(wavelength) * d65.value(wavelength)))
        }
        Role::Index | Role::Extinction | Role::Absorption => {
            Err(node.error("a coloured <rgb> is a reflectance or a light: give a <spectrum>"))
        }
    }
}

fn table(value: impl Fn(f64) -> f64) -> SpectrumKind {
    let wavelengths: Vec<f64> = NODES.step_by(STEP).map(f64::from).collect();
    let values = wavelengths.iter().map(|wavelength| value(*wavelength)).collect();
    SpectrumKind::Table { wavelengths, values }
}
