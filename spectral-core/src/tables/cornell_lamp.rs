// Generated from data/cornell_box_light.csv by generate_tables of spectral-tests: not to be edited.
//! The lamp of the Cornell box.
#![allow(
    clippy::approx_constant,
    clippy::excessive_precision,
    clippy::unreadable_literal,
    reason = "decimals as they are in the source"
)]

use super::UniformTable;

/// `cornell_lamp`: relative spectral radiance, 400–700 nm at 100 nm.
pub const CORNELL_LAMP: UniformTable = UniformTable {
    name: "cornell_lamp",
    first: 400,
    step: 100,
    samples: samples!(4;
        0.0, 8.0, 15.6, 18.4,
    ),
};

/// All of these tables, in the order of their source.
pub static ALL: [UniformTable; 1] = [
    CORNELL_LAMP,
];
