//! One number for a spectrum: what the mesh is refined by.

use spectral_core::{Observer, tristimulus};

use crate::spectral::{Factor, Palette, Y_INTEGRAL};

/// ∫Sȳ / ∫ȳ over 380–780 nm: luminous value of a light, or reflectance under a flat light.
pub(super) fn luminous(palette: &Palette, factor: Factor) -> Result<f64, String> {
    let Some((leaf, _)) = factor.leaf.and_then(|leaf| palette.leaves().get(leaf as usize)) else {
        return Ok(factor.scale);
    };
    let [_, y, _] = tristimulus(&Observer::cie_1931_2deg(), &leaf.spectrum()?, 380.0, 780.0);
    Ok(factor.scale * y / Y_INTEGRAL)
}
