// Generated from data/lines_sodium_d.csv, data/lines_mercury.csv by generate_tables of spectral-tests: not to be edited.
//! Spectral lines of sodium and mercury: wavelengths in air and relative powers.
#![allow(
    clippy::approx_constant,
    clippy::excessive_precision,
    clippy::unreadable_literal,
    reason = "decimals as they are in the source"
)]

use super::LineTable;

/// The lines of sodium-D: wavelengths in nm, relative powers.
pub const SODIUM_D: LineTable = LineTable {
    name: "sodium-D",
    wavelengths: samples!(2;
        588.9950, 589.5924,
    ),
    powers: samples!(2;
        0.666666667, 0.333333333,
    ),
};

/// The lines of mercury: wavelengths in nm, relative powers.
pub const MERCURY: LineTable = LineTable {
    name: "mercury",
    wavelengths: samples!(5;
        404.656, 435.833, 546.074, 576.960, 579.066,
    ),
    powers: samples!(5;
        0.4197, 0.7864, 1.0, 0.5857, 0.5857,
    ),
};

/// All of these tables, in the order of their source.
pub static ALL: [LineTable; 2] = [
    SODIUM_D,
    MERCURY,
];
