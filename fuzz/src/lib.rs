//! What the fuzz targets do with any bytes: each function returns unless it found a fault, and then it panics.
//!
//! | targets | judge |
//! |---|---|
//! | `scene_xml`, `spectrum_file`, `ies_file`, `ldt_file`, `radiance`, `light_file`, `points_file`, `readings_file`, `answers_file` | parsers: one line that names the fault, or data in their domain |
//! | `expression`, `operators` | interval spectra: the exact integral is within the radius |
//! | `colour`, `bilinear`, `upsampling`, `spectra` | colours and spectra: finite, symmetric, monotone, and back again |
//! | `cct`, `light` | light metrics: finite, in range, the same bits by meters and functions |
//! | `brdf`, `boundary` | reflection and refraction: not negative, reciprocal, no energy gained |
//! | `partition`, `disk_map`, `factor`, `estimate` | disk lights: weights sum to 1, maps come back, factors in 0 … 1 |
//!
//! - `cargo test --manifest-path fuzz/Cargo.toml --release` replays the seeds and thousands of their mutations, without a fuzzer.
//! - `fuzz/run 60` fuzzes each target for 60 seconds with libFuzzer on the stable compiler and tells how many inputs that were;
//!   `fuzz/run 600 colour cct` only these. Finds are kept in `fuzz/artifacts`. `cargo fuzz run TARGET` works, too.
//! - `cargo run --manifest-path fuzz/Cargo.toml --bin scene_xml FILE…` runs a target on files, such as the fuzzer's finds.

mod bilinear;
mod brdf;
mod colour;
mod disk;
mod estimate;
mod expression;
mod light;
mod numbers;
mod operators;
#[cfg(feature = "parsers")]
mod photometry;
#[cfg(feature = "parsers")]
mod radiance;
#[cfg(feature = "parsers")]
mod scene;
mod spectra;
#[cfg(feature = "parsers")]
mod spectrum;
#[cfg(feature = "parsers")]
mod table;
mod upsampling;

pub use bilinear::bilinear;
pub use brdf::{boundary, brdf};
pub use colour::colour;
pub use disk::{disk_map, factor, partition};
pub use estimate::estimate;
pub use expression::expression;
pub use light::{cct, light};
pub use operators::operators;
#[cfg(feature = "parsers")]
pub use photometry::{ies_file, ldt_file};
#[cfg(feature = "parsers")]
pub use radiance::radiance;
#[cfg(feature = "parsers")]
pub use scene::scene_xml;
pub use spectra::spectra;
#[cfg(feature = "parsers")]
pub use spectrum::spectrum_file;
#[cfg(feature = "parsers")]
pub use table::{answers_file, light_file, points_file, readings_file};
pub use upsampling::upsampling;

/// Runs a target on the files that the program was called with.
///
/// # Errors
/// A file that can't be read.
pub fn replay_arguments(target: fn(&[u8])) -> std::io::Result<()> {
    for file in std::env::args_os().skip(1) {
        target(&std::fs::read(file)?);
    }
    Ok(())
}

/// An error's text must be one line that says something.
fn assert_one_line(text: &str) {
    assert!(text.len() > 3 && !text.contains(char::is_control), "{text:?}");
}
