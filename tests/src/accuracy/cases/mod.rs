//! The functions' domains and oracles, by subject.

pub mod colour;
pub mod elementary;
