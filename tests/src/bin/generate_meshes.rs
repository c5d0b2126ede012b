//! Writes the generated meshes of `renderers/scenes/meshes`.

use std::fs;

fn main() -> Result<(), String> {
    for (path, text) in spectral_tests::meshes::generate() {
        fs::write(&path, text).map_err(|error| format!("{}: {error}", path.display()))?;
    }
    Ok(())
}
