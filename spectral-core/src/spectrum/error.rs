//! Why a spectrum was refused.

use core::fmt;

/// Why a spectrum was refused; an index is that of the first node, line or value at fault, from 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum SpectrumError {
    /// A spectrum needs at least two nodes.
    TooFewNodes {
        /// How many there are.
        count: usize,
    },
    /// There must be as many values as wavelengths.
    LengthMismatch {
        /// How many wavelengths there are.
        wavelengths: usize,
        /// How many values there are.
        values: usize,
    },
    /// A wavelength is infinite or NaN.
    Wavelength {
        /// Which one.
        index: usize,
    },
    /// A wavelength isn't above the one before.
    Order {
        /// Which one.
        index: usize,
    },
    /// The wavelengths span more than the number type can hold.
    Range,
    /// A value is infinite or NaN.
    Value {
        /// Which one.
        index: usize,
    },
    /// A value is below zero.
    Negative {
        /// Which one.
        index: usize,
    },
    /// The step isn't positive and finite, or too small to tell the nodes apart in the number type.
    Step,
    /// The width isn't positive and finite, or too narrow for the number type at that line's wavelength.
    Width {
        /// Which line.
        index: usize,
    },
    /// A black body's temperature must be above 0 K and at most 10⁹ K.
    Temperature,
    /// A daylight's correlated colour temperature must be in 4000 K to 25000 K.
    ColourTemperature,
}

impl fmt::Display for SpectrumError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::TooFewNodes { count } => {
                write!(f, "a spectrum needs at least 2 nodes, not {count}")
            }
            Self::LengthMismatch { wavelengths, values } => {
                write!(f, "{wavelengths} wavelengths but {values} values")
            }
            Self::Wavelength { index } => write!(f, "wavelength {index} is not finite"),
            Self::Order { index } => write!(f, "wavelength {index} is not above the one before"),
            Self::Range => f.write_str("the wavelengths span more than the number type can hold"),
            Self::Value { index } => write!(f, "value {index} is not finite"),
            Self::Negative { index } => write!(f, "value {index} is negative"),
            Self::Step => f.write_str("the step between wavelengths is not positive and finite, or too small"),
            Self::Width { index } => {
                write!(f, "the width of line {index} is not positive and finite, or too narrow")
            }
            Self::Temperature => f.write_str("the temperature is not above 0 K and at most 1e9 K"),
            Self::ColourTemperature => f.write_str("the correlated colour temperature is not in 4000 K to 25000 K"),
        }
    }
}

impl core::error::Error for SpectrumError {}
