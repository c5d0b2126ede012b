//! Oracles and statistics shared by the tests; nothing in the workspace depends on this crate.

pub mod statistics;
pub mod tables;
