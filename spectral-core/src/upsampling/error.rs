//! Why a colour or a set-up was refused.

use core::fmt;

/// Why no spectrum could be found for a colour.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum UpsamplingError {
    /// A component is infinite, NaN, negative, or, for a reflectance, above 1.
    Component {
        /// Which one: 0, 1, 2 for red, green, blue.
        channel: usize,
    },
    /// No spectrum of the family has this colour: it is outside the reach of surface colours, as some of wide RGB spaces are.
    Unreachable,
}

impl fmt::Display for UpsamplingError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Component { channel } => write!(f, "component {channel} of the colour is outside its range"),
            Self::Unreachable => f.write_str("no spectrum of the family has this colour"),
        }
    }
}

impl core::error::Error for UpsamplingError {}

/// Why an upsampler could not be set up.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum UpsamplerError {
    /// A tristimulus value of the white light isn't positive and finite.
    White,
}

impl fmt::Display for UpsamplerError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a tristimulus value of the light that is to be white is not positive and finite")
    }
}

impl core::error::Error for UpsamplerError {}
