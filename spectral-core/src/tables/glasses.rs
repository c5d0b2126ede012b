// Generated from data/sellmeier_coefficients.csv, data/cauchy_coefficients.csv by generate_tables of spectral-tests: not to be edited.
//! Dispersion coefficients of transparent materials: see [`crate::dispersion`].
#![allow(
    clippy::approx_constant,
    clippy::excessive_precision,
    clippy::unreadable_literal,
    reason = "decimals as they are in the source"
)]

use super::{Formula, GlassTable};

/// N-BK7: index 1.5168 at 587.56 nm, Abbe number 64.167. Source: Schott catalogue 2017 (specs/schott/optical/N-BK7).
pub const N_BK7: GlassTable = GlassTable {
    name: "N-BK7",
    formula: Formula::Sellmeier,
    valid: [300, 2500],
    coefficients: samples!(8;
        1.03961212, 0.00600069867, 0.231792344, 0.0200179144, 1.01046945, 103.560653, 0.0, 0.0,
    ),
};

/// SF10: index 1.72825 at 587.56 nm, Abbe number 28.41. Source: Schott catalogue 2017 (specs/schott/optical/SF10).
pub const SF10: GlassTable = GlassTable {
    name: "SF10",
    formula: Formula::Sellmeier,
    valid: [380, 2500],
    coefficients: samples!(8;
        1.61625977, 0.0127534559, 0.259229334, 0.0581983954, 1.07762317, 116.60768, 0.0, 0.0,
    ),
};

/// SF11: index 1.78472 at 587.56 nm, Abbe number 25.757. Source: Schott catalogue 2017 (specs/schott/optical/SF11).
pub const SF11: GlassTable = GlassTable {
    name: "SF11",
    formula: Formula::Sellmeier,
    valid: [390, 2500],
    coefficients: samples!(8;
        1.73848403, 0.0136068604, 0.311168974, 0.0615960463, 1.17490871, 121.922711, 0.0, 0.0,
    ),
};

/// N-SF11: index 1.78472 at 587.56 nm, Abbe number 25.68. Source: Schott catalogue 2017 (specs/schott/optical/N-SF11).
pub const N_SF11: GlassTable = GlassTable {
    name: "N-SF11",
    formula: Formula::Sellmeier,
    valid: [370, 2500],
    coefficients: samples!(8;
        1.73759695, 0.013188707, 0.313747346, 0.0623068142, 1.89878101, 155.23629, 0.0, 0.0,
    ),
};

/// fused-silica: index 1.458464 at 587.56 nm, Abbe number 67.821. Source: Malitson 1965 (main/SiO2/nk/Malitson).
pub const FUSED_SILICA: GlassTable = GlassTable {
    name: "fused-silica",
    formula: Formula::Sellmeier,
    valid: [210, 6700],
    coefficients: samples!(8;
        0.6961663, 0.00467914825849, 0.4079426, 0.01351206307396, 0.8974794, 97.934002537921, 0.0, 0.0,
    ),
};

/// water-20C: index 1.333403 at 587.56 nm, Abbe number 55.76. Source: Daimon & Masumura 2007 (main/H2O/nk/Daimon-20.0C).
pub const WATER_20C: GlassTable = GlassTable {
    name: "water-20C",
    formula: Formula::Sellmeier,
    valid: [182, 1129],
    coefficients: samples!(8;
        0.5684027565, 0.005101829712, 0.1726177391, 0.01821153936, 0.02086189578, 0.02620722293, 0.1130748688,
        10.69792721,
    ),
};

/// diamond: index 2.417486 at 587.56 nm, Abbe number 55.301. Source: Peter 1923 (main/C/nk/Peter).
pub const DIAMOND: GlassTable = GlassTable {
    name: "diamond",
    formula: Formula::Sellmeier,
    valid: [226, 760],
    coefficients: samples!(8;
        0.3306, 0.030625, 4.3356, 0.011236, 0.0, 0.0, 0.0, 0.0,
    ),
};

/// CaF2: index 1.433849 at 587.56 nm, Abbe number 94.996. Source: Malitson 1963 (main/CaF2/nk/Malitson).
pub const CAF2: GlassTable = GlassTable {
    name: "CaF2",
    formula: Formula::Sellmeier,
    valid: [230, 9700],
    coefficients: samples!(8;
        0.5675888, 0.002526429987596025, 0.4710914, 0.01007833280281, 3.8484723, 1200.5559729216, 0.0, 0.0,
    ),
};

/// S-FPL53: index 1.43875 at 587.56 nm, Abbe number 94.946. Source: Ohara (specs/ohara/optical/S-FPL53).
pub const S_FPL53: GlassTable = GlassTable {
    name: "S-FPL53",
    formula: Formula::Sellmeier,
    valid: [280, 2400],
    coefficients: samples!(8;
        0.983532327, 0.00492234955, 0.069568814, 0.0193581091, 1.11409238, 264.275294, 0.0, 0.0,
    ),
};

/// 437907: index 1.437 at 587.56 nm, Abbe number 90.7. Source: Iehl & Peroche 2000.
pub const GLASS_437907: GlassTable = GlassTable {
    name: "437907",
    formula: Formula::Cauchy,
    valid: [360, 830],
    coefficients: samples!(2;
        1.4296916550, 0.0025230517,
    ),
};

/// All of these tables, in the order of their source.
pub static ALL: [GlassTable; 10] = [
    N_BK7,
    SF10,
    SF11,
    N_SF11,
    FUSED_SILICA,
    WATER_20C,
    DIAMOND,
    CAF2,
    S_FPL53,
    GLASS_437907,
];
