// Generated from data/smits1999_basis_10bins.csv by generate_tables of spectral-tests: not to be edited.
//! Basis reflectances of Smits (1999) for sRGB, constant over ten bins from 380 nm to 720 nm.
#![allow(
    clippy::approx_constant,
    clippy::excessive_precision,
    clippy::unreadable_literal,
    reason = "decimals as they are in the source"
)]

use super::BinTable;

/// `white`: reflectance, bins of 34 nm from 380 nm.
pub const WHITE: BinTable = BinTable {
    name: "white",
    lower: 380,
    width: 34,
    samples: samples!(10;
        1.0, 1.0, 0.9999, 0.9993, 0.9992, 0.9998, 1.0, 1.0, 1.0, 1.0,
    ),
};

/// `cyan`: reflectance, bins of 34 nm from 380 nm.
pub const CYAN: BinTable = BinTable {
    name: "cyan",
    lower: 380,
    width: 34,
    samples: samples!(10;
        0.971, 0.9426, 1.0007, 1.0007, 1.0007, 1.0007, 0.1564, 0.0, 0.0, 0.0,
    ),
};

/// `magenta`: reflectance, bins of 34 nm from 380 nm.
pub const MAGENTA: BinTable = BinTable {
    name: "magenta",
    lower: 380,
    width: 34,
    samples: samples!(10;
        1.0, 1.0, 0.9685, 0.2229, 0.0, 0.0458, 0.8369, 1.0, 1.0, 0.9959,
    ),
};

/// `yellow`: reflectance, bins of 34 nm from 380 nm.
pub const YELLOW: BinTable = BinTable {
    name: "yellow",
    lower: 380,
    width: 34,
    samples: samples!(10;
        0.0001, 0.0, 0.1088, 0.6651, 1.0, 1.0, 0.9996, 0.9586, 0.9685, 0.984,
    ),
};

/// `red`: reflectance, bins of 34 nm from 380 nm.
pub const RED: BinTable = BinTable {
    name: "red",
    lower: 380,
    width: 34,
    samples: samples!(10;
        0.1012, 0.0515, 0.0, 0.0, 0.0, 0.0, 0.8325, 1.0149, 1.0149, 1.0149,
    ),
};

/// `green`: reflectance, bins of 34 nm from 380 nm.
pub const GREEN: BinTable = BinTable {
    name: "green",
    lower: 380,
    width: 34,
    samples: samples!(10;
        0.0, 0.0, 0.0273, 0.7937, 1.0, 0.9418, 0.1719, 0.0, 0.0, 0.0025,
    ),
};

/// `blue`: reflectance, bins of 34 nm from 380 nm.
pub const BLUE: BinTable = BinTable {
    name: "blue",
    lower: 380,
    width: 34,
    samples: samples!(10;
        1.0, 1.0, 0.8916, 0.3323, 0.0, 0.0, 0.0003, 0.0369, 0.0483, 0.0496,
    ),
};

/// All of these tables, in the order of their source.
pub static ALL: [BinTable; 7] = [
    WHITE,
    CYAN,
    MAGENTA,
    YELLOW,
    RED,
    GREEN,
    BLUE,
];
