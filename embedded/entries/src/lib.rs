//! Every public function of the two core crates, with arguments, as one table: the digests of all targets, the proof that
//! nothing panics, and the sizes and times are all made of it.
#![no_std]

#[macro_use]
mod table;

mod colour;
mod control;
mod disk;
mod interval;
mod light;
mod product;
mod reflection;
mod run;
mod spectra;

pub use run::Run;
pub use table::{Entry, Linked};

/// All rows, module by module.
pub const ENTRIES: [&[Entry]; 7] = [
    spectra::ENTRIES,
    interval::ENTRIES,
    colour::ENTRIES,
    light::ENTRIES,
    reflection::ENTRIES,
    product::ENTRIES,
    disk::ENTRIES,
];

/// Rows that are no part of digests and tables: one without any content, and one that may panic, which must not link.
pub const CONTROLS: &[Entry] = control::ENTRIES;
