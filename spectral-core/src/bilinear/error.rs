//! Why a tensor, a control or a divisor was refused.

use core::fmt;

/// Why a [`Tensor`](super::Tensor) was refused; a channel is 0, 1, 2 for red, green, blue.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum TensorError {
    /// A coefficient is infinite or NaN.
    NotFinite,
    /// k^c_{d,e} and k^c_{e,d} differ by more than the tolerance.
    Asymmetric {
        /// c.
        channel: usize,
        /// d and e.
        pair: [usize; 2],
    },
    /// Σ_e k^c_{d,e} differs from 1 (c = d) or 0 by more than the tolerance.
    Incoherent {
        /// c.
        channel: usize,
        /// d.
        column: usize,
    },
}

impl fmt::Display for TensorError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotFinite => f.write_str("a coefficient of the tensor is not finite"),
            Self::Asymmetric { channel, pair: [d, e] } => {
                write!(f, "the tensor is not symmetric: channel {channel}, coefficients {d},{e} and {e},{d}")
            }
            Self::Incoherent { channel, column } => {
                write!(
                    f,
                    "the tensor is not coherent: K_r + K_g + K_b differs from I in row {channel}, column {column}"
                )
            }
        }
    }
}

impl core::error::Error for TensorError {}

/// Why a control α was refused; a channel is 0, 1, 2 for red, green, blue.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum AlphaError {
    /// α is negative, infinite or NaN.
    Value {
        /// Which α.
        channel: usize,
    },
    /// α is above 0, but the tensor's 1 − k^c_{c,c} is not: there is no transfer into the channel to be scaled.
    NoTransfer {
        /// Which α.
        channel: usize,
    },
}

impl fmt::Display for AlphaError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Value { channel } => write!(f, "alpha of channel {channel} is negative or not finite"),
            Self::NoTransfer { channel } => {
                write!(f, "alpha of channel {channel} is above 0, but the tensor transfers nothing into that channel")
            }
        }
    }
}

impl core::error::Error for AlphaError {}

/// Why a colour can't be divided by.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum DivisorError {
    /// A component is infinite or NaN.
    NotFinite,
    /// The colour is a singular divisor to the precision of the number type.
    Singular,
}

impl fmt::Display for DivisorError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::NotFinite => "a component of the divisor is not finite",
            Self::Singular => "the divisor is singular: many colours have the same product with it",
        })
    }
}

impl core::error::Error for DivisorError {}

/// Why no tensor could be estimated; a channel is 0, 1, 2 for red, green, blue.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum EstimateError {
    /// Colour-matching functions need at least two nodes.
    TooFewNodes {
        /// How many there are.
        count: usize,
    },
    /// A node is infinite or NaN.
    Node {
        /// Which one, from 0.
        index: usize,
    },
    /// The integral of a colour-matching function isn't positive, or so small that normalising overflows.
    Integral {
        /// Which one.
        channel: usize,
    },
    /// The colour-matching functions are linearly dependent to the precision of the number type.
    Dependent,
}

impl fmt::Display for EstimateError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::TooFewNodes { count } => write!(f, "colour-matching functions need at least 2 nodes, not {count}"),
            Self::Node { index } => write!(f, "node {index} of the colour-matching functions is not finite"),
            Self::Integral { channel } => {
                write!(f, "the integral of colour-matching function {channel} is not positive and of usable size")
            }
            Self::Dependent => f.write_str("the colour-matching functions are linearly dependent"),
        }
    }
}

impl core::error::Error for EstimateError {}
