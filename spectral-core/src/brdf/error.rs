//! Why a reflectance model or a direction was refused.

use core::fmt;

/// Why a reflectance model or a direction was refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum BrdfError {
    /// A roughness is outside its domain: 10⁻⁶ … 10² for the Ward family, 0 … 1 for Schlick's model.
    Roughness,
    /// A reflectance isn't in 0 … 1.
    Reflectance,
    /// The specular and the diffuse reflectance add up to more than 1.
    Energy,
    /// An isotropy isn't in 0 (exclusive) … 1.
    Isotropy,
    /// A direction's vector is zero, infinite or NaN.
    Direction,
    /// There is no model of this name.
    Name,
}

impl fmt::Display for BrdfError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Roughness => {
                "a roughness is outside its domain (1e-6 to 100 for the Ward family, 0 to 1 for Schlick's)"
            }
            Self::Reflectance => "a reflectance must be between 0 and 1",
            Self::Energy => "the specular and the diffuse reflectance add up to more than 1",
            Self::Isotropy => "an isotropy must be above 0 and at most 1",
            Self::Direction => "a direction's vector must be finite and not zero",
            Self::Name => "the model must be one of ward, ward-duer, ward-neumann, balanced",
        })
    }
}

impl core::error::Error for BrdfError {}
