//! Writes the generated files of `spectral-core/src/tables`.

use std::fs;

fn main() -> Result<(), String> {
    for (path, text) in spectral_tests::tables::generate()? {
        fs::write(&path, text).map_err(|error| format!("{}: {error}", path.display()))?;
    }
    Ok(())
}
