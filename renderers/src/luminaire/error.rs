//! What is wrong with a photometric file, and where.

use core::fmt;

use super::intensity::IntensityError;

/// A refused photometric file: the file, line and field at fault, and what is wrong.
///
/// [`Display`](fmt::Display) gives one line, `file:line: field: fault`; the line is left out when the fault is the whole
/// file's.
#[derive(Clone, Debug, PartialEq)]
pub struct PhotometricFileError {
    /// The file's name, as it was given; without control characters.
    pub file: String,
    /// The line at fault, from 1; 0 if the fault belongs to the whole file.
    pub line: u32,
    /// The field at fault by its name in the format, such as `candela at C 45, γ 10`; empty if it is no single one.
    pub field: String,
    /// What is wrong.
    pub fault: Fault,
}

/// What can be wrong with a field of a photometric file.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Fault {
    /// The file can't be read, for this reason.
    Unreadable(String),
    /// The file has more than [`LARGEST_FILE`](super::LARGEST_FILE) bytes.
    TooLarge,
    /// The file ends before the field.
    Truncated,
    /// This text stands where a number should.
    NotANumber(String),
    /// The number, or what it leads to, is NaN, infinite or leaves the range of numbers.
    NotFinite(String),
    /// This number stands where a whole number should.
    NotWhole(f64),
    /// The number is not what the field needs.
    Domain {
        /// The number.
        value: f64,
        /// What it must be, as in "must be positive".
        wanted: &'static str,
    },
    /// The format has this, but it is not supported here, or the format doesn't have it.
    Unsupported {
        /// What was found.
        found: String,
        /// What there may be.
        supported: &'static str,
    },
    /// Angles must increase; equal ones are refused, too.
    NotIncreasing {
        /// The angle.
        value: f64,
        /// The one before it.
        before: f64,
    },
    /// A negative luminous intensity.
    Negative(f64),
    /// Angles from `first` to `last` are none of the ranges that the format has.
    Range {
        /// First angle, degrees.
        first: f64,
        /// Last angle, degrees.
        last: f64,
        /// The ranges that there may be.
        allowed: &'static str,
    },
    /// The luminous flux leaves the range of numbers.
    Flux,
    /// Something stands after the last value.
    Trailing(String),
}

impl PhotometricFileError {
    pub(super) fn new(file: &str, line: u32, field: impl Into<String>, fault: Fault) -> Self {
        let file = file.chars().map(|c| if c.is_control() { ' ' } else { c }).collect();
        Self { file, line, field: field.into(), fault }
    }

    /// Field and fault without the place.
    pub(crate) fn what(&self) -> String {
        if self.field.is_empty() { self.fault.to_string() } else { format!("{}: {}", self.field, self.fault) }
    }
}

/// A piece of the file for messages: not too long.
pub(super) fn excerpt(text: &str) -> String {
    const LONGEST: usize = 32;
    let mut short: String = text.chars().take(LONGEST).collect();
    if short.len() < text.len() {
        short.push('…');
    }
    short
}

impl From<&IntensityError> for Fault {
    fn from(error: &IntensityError) -> Self {
        match *error {
            IntensityError::NotFinite { value, .. } => Self::NotFinite(value.to_string()),
            IntensityError::Negative { value, .. } => Self::Negative(value),
            IntensityError::NotIncreasing { value, before, .. } => Self::NotIncreasing { value, before },
            IntensityError::PlaneRange { first, last } => {
                Self::Range { first, last, allowed: super::intensity::PLANES }
            }
            IntensityError::GammaRange { first, last } => {
                Self::Range { first, last, allowed: super::intensity::GAMMAS }
            }
            IntensityError::Counts { .. } => Self::Truncated,
            IntensityError::Flux => Self::Flux,
        }
    }
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Unreadable(why) => {
                let clean: String = why.chars().map(|c| if c.is_control() { ' ' } else { c }).collect();
                write!(f, "cannot read the file: {clean}")
            }
            Self::TooLarge => write!(f, "the file has more than {} MiB", super::LARGEST_FILE >> 20),
            Self::Truncated => f.write_str("the file ends before it"),
            Self::NotANumber(text) => write!(f, "{text:?} is not a number"),
            Self::NotFinite(text) => write!(f, "{text:?} is not finite"),
            Self::NotWhole(value) => write!(f, "{value:?} is not a whole number"),
            Self::Domain { value, wanted } => write!(f, "must be {wanted}, not {value:?}"),
            Self::Unsupported { found, supported } => write!(f, "{found:?} is not supported (supported: {supported})"),
            Self::NotIncreasing { value, before } => {
                write!(f, "{value:?} is not above {before:?}, the angle before it")
            }
            Self::Negative(value) => write!(f, "must not be negative, but is {value}"),
            Self::Range { first, last, allowed } => {
                write!(f, "{first:?} to {last:?} degrees is not a range of this format ({allowed})")
            }
            Self::Flux => f.write_str("the luminous flux leaves the range of numbers"),
            Self::Trailing(text) => write!(f, "{text:?} stands after the last value"),
        }
    }
}

impl fmt::Display for PhotometricFileError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.file)?;
        if self.line > 0 {
            write!(f, ":{}", self.line)?;
        }
        write!(f, ": {}", self.what())
    }
}

impl core::error::Error for PhotometricFileError {}
