//! The committed tables are what the generator makes of the data files, to the byte.

use std::fs;

use spectral_tests::tables::{generate, table_directory};

#[test]
fn committed_tables_are_current() {
    for (path, expected) in generate().unwrap() {
        let committed = fs::read_to_string(&path).unwrap();
        assert!(
            committed == expected,
            "{} is out of date: run cargo run -p spectral-tests --bin generate_tables",
            path.display()
        );
    }
}

#[test]
fn every_table_file_is_generated_or_known() {
    let generated: Vec<_> = generate().unwrap().into_iter().map(|(path, _)| path).collect();
    for entry in fs::read_dir(table_directory()).unwrap() {
        let path = table_directory().join(entry.unwrap().file_name());
        let by_hand = ["mod.rs", "lookup.rs"].iter().any(|name| path.ends_with(name));
        assert!(by_hand || generated.contains(&path), "{} has no generator", path.display());
    }
}
