//! What the fuzz targets do with any bytes: each function returns unless it found a fault, and then it panics.
//!
//! - `cargo test --manifest-path fuzz/Cargo.toml` replays the seeds and thousands of their mutations, on any compiler.
//! - `cargo +nightly fuzz run scene_xml fuzz/corpus/scene_xml fuzz/seeds/scene_xml` looks for new ones, likewise `spectrum_file`,
//!   `ies_file`, `ldt_file`, `radiance` and `expression`.
//! - `cargo run --manifest-path fuzz/Cargo.toml --bin scene_xml FILE…` runs a target on files, such as the fuzzer's finds.

mod expression;
mod photometry;
mod radiance;
mod scene;
mod spectrum;

pub use expression::expression;
pub use photometry::{ies_file, ldt_file};
pub use radiance::radiance;
pub use scene::scene_xml;
pub use spectrum::spectrum_file;

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
