//! Files of lights, and reports on them: the very source that `spectral light` is made of, without the renderers' dependencies.
#![allow(dead_code, unreachable_pub, reason = "the command line reads and draws more of it than the page")]

#[path = "../../renderers/src/light/file.rs"]
mod file;
#[path = "../../renderers/src/light/report.rs"]
mod report;

pub(crate) use file::{LightFileError, SpectralTable, parse_light};
pub(crate) use report::{LightReport, report};
