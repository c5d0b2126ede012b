//! What is refused.

use core::fmt;

/// Why a partition was refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum PartitionError {
    /// The depth is above [`MAX_DEPTH`](super::MAX_DEPTH).
    Depth,
    /// The threshold of size over distance is negative, infinite or NaN.
    Threshold,
    /// The receiver's position is infinite or NaN.
    NotFinite,
    /// The buffer is smaller than the partition.
    Buffer {
        /// How many subsources there are.
        needed: u64,
    },
}

impl fmt::Display for PartitionError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Depth => write!(f, "the depth is above {}", super::MAX_DEPTH),
            Self::Threshold => f.write_str("the threshold of size over distance is negative, infinite or not a number"),
            Self::NotFinite => f.write_str("the receiver's position is infinite or not a number"),
            Self::Buffer { needed } => write!(f, "the buffer is too small: there are {needed} subsources"),
        }
    }
}

impl core::error::Error for PartitionError {}
