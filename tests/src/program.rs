//! The `spectral` program, for tests that run it.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::OnceLock;

use serde_json::Value;

/// The program, built once in the profile of the tests, beside them; `scratch` is the caller's `CARGO_TARGET_TMPDIR`.
///
/// # Panics
/// If it can't be built: a test that needs it can't pass.
#[allow(clippy::panic, clippy::expect_used, reason = "tests stop at the first thing that should not be")]
pub fn spectral(scratch: &str) -> &'static Path {
    static PROGRAM: OnceLock<PathBuf> = OnceLock::new();
    PROGRAM.get_or_init(|| {
        let target = Path::new(scratch).parent().expect("a folder within the target folder");
        let mut cargo = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
        cargo.args(["build", "--quiet", "-p", "renderers", "--bin", "spectral", "--message-format=json"]);
        cargo.arg("--target-dir").arg(target).current_dir(env!("CARGO_MANIFEST_DIR"));
        if !cfg!(debug_assertions) {
            cargo.arg("--release");
        }
        let built = cargo.output().expect("cargo runs");
        assert!(built.status.success(), "{}", String::from_utf8_lossy(&built.stderr));
        let messages = String::from_utf8_lossy(&built.stdout).into_owned();
        let executable =
            |line: &str| serde_json::from_str::<Value>(line).ok()?["executable"].as_str().map(PathBuf::from);
        messages.lines().find_map(executable).expect("cargo names the program")
    })
}
