//! Measures the core crates' functions and writes `tests/ACCURACY.md`; with a part of a name, prints what was found
//! of such functions instead; with `--missing`, the public functions that are neither measured nor exempt.

use std::fs;
use std::path::Path;

use spectral_tests::accuracy::{measure, report, scan};

#[allow(clippy::print_stdout, reason = "it is what the command is for")]
fn main() -> Result<(), String> {
    if let Some(name) = std::env::args().nth(1) {
        if name == "--missing" {
            scan::unlisted()?.iter().for_each(|name| println!("{name}"));
            return Ok(());
        }
        for row in measure(&name) {
            println!("{}: tolerance {:?}", row.entry.name, row.entry.tolerance);
            for found in &row.found {
                println!("    {:.4e} {:?} {:?}, {} points", found.worst, found.choice, found.point, found.points);
            }
        }
        return Ok(());
    }
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(report::PATH);
    let text = report::markdown(&measure(""))?;
    fs::write(&path, text).map_err(|error| format!("{}: {error}", path.display()))
}
