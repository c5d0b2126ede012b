//! The committed header is what the source gives.

use std::error::Error;
use std::path::{Path, PathBuf};
use std::process::Command;

/// The library's source with its macros expanded, which cbindgen can't do itself.
fn expanded() -> Result<PathBuf, Box<dyn Error>> {
    let output = Command::new(env!("CARGO"))
        .args(["rustc", "--release", "--lib", "--quiet", "--", "-Zunpretty=expanded"])
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        // The option is an unstable one; with this, the compiler that is there will do.
        .env("RUSTC_BOOTSTRAP", "1")
        .output()?;
    if !output.status.success() {
        return Err(String::from_utf8_lossy(&output.stderr).into());
    }
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join("expanded.rs");
    std::fs::write(&path, output.stdout)?;
    Ok(path)
}

/// With `SPECTRAL_UPDATE_HEADER` set, the header is written instead.
#[test]
fn the_header_is_current() -> Result<(), Box<dyn Error>> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR"));
    let config = cbindgen::Config::from_file(folder.join("cbindgen.toml"))?;
    let bindings = cbindgen::Builder::new().with_src(expanded()?).with_config(config).generate()?;
    let mut generated = Vec::new();
    bindings.write(&mut generated);
    let path = folder.join("include/spectral.h");
    if std::env::var_os("SPECTRAL_UPDATE_HEADER").is_some() {
        std::fs::write(&path, &generated)?;
    }
    let committed = std::fs::read(&path)?;
    let command = "SPECTRAL_UPDATE_HEADER=1 cargo test --release --test header";
    assert!(committed == generated, "include/spectral.h is not current: {command}");
    Ok(())
}
