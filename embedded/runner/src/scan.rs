//! Which public functions the two crates have, read from their sources.

use std::collections::BTreeSet;
use std::path::Path;
use std::{fs, io};

/// Traits of the crates whose implementations are rows of their own, and those of `core` that compute something.
const TRAITS: [&str; 9] =
    ["Spectrum", "Brdf", "Dispersion", "Sources", "Locus", "TestColours", "Real", "Iterator", "FromStr"];

/// All public functions below a crate's `src`, as `module::Type::function`, and implementations of traits, as
/// `module::Trait for Type`; the module is the outermost one.
pub(crate) fn public_functions(source: &Path) -> io::Result<BTreeSet<String>> {
    let (mut found, mut types) = (BTreeSet::new(), BTreeSet::new());
    for entry in fs::read_dir(source)? {
        let path = entry?.path();
        let module = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        visit(&path, &mut |text| {
            scan(text, &module, &mut found);
            types.extend(text.lines().filter_map(public_type));
        })?;
    }
    found
        .retain(|name| name.split_once(" for ").is_none_or(|(_, of)| of.starts_with(['&', '$']) || types.contains(of)));
    Ok(found)
}

/// The name of the type that a line declares public.
fn public_type(line: &str) -> Option<String> {
    let name = line.strip_prefix("pub struct ").or_else(|| line.strip_prefix("pub enum "))?;
    name.split(|letter: char| !letter.is_alphanumeric()).next().map(String::from)
}

fn visit(path: &Path, then: &mut impl FnMut(&str)) -> io::Result<()> {
    if path.is_dir() {
        for entry in fs::read_dir(path)? {
            visit(&entry?.path(), then)?;
        }
    } else if path.extension().is_some_and(|extension| extension == "rs") {
        then(&fs::read_to_string(path)?);
    }
    Ok(())
}

/// The sources are formatted: a block's head starts a line and its end is a brace at the same depth.
fn scan(text: &str, module: &str, found: &mut BTreeSet<String>) {
    // The type whose methods follow, and where its block ends.
    let mut block: Option<(String, usize)> = None;
    for line in text.lines().take_while(|line| !line.starts_with("#[cfg(test)]")) {
        let depth = line.len() - line.trim_start().len();
        let words = line.trim_start();
        if block.as_ref().is_some_and(|(_, end)| words.starts_with('}') && depth == *end) {
            block = None;
        }
        if let Some(head) = words.strip_prefix("impl").filter(|head| head.starts_with([' ', '<'])) {
            let head = without_generics(head);
            match head.split_once(" for ") {
                None => block = Some((type_name(&head), depth)),
                Some((of, target)) if TRAITS.contains(&type_name(of).as_str()) => {
                    let target = target.split(" where ").next().unwrap_or_default().trim_end_matches(['{', ' ', '}']);
                    let target = if target.starts_with('&') { target.to_string() } else { type_name(target) };
                    let prefix = if ["Iterator", "FromStr"].contains(&type_name(of).as_str()) {
                        String::new()
                    } else {
                        format!("{module}::")
                    };
                    found.insert(format!("{prefix}{} for {target}", type_name(of)));
                }
                Some(_) => {}
            }
        }
        let function = words.strip_prefix("pub fn ").or_else(|| words.strip_prefix("pub const fn "));
        if let Some(name) = function {
            let name = name.split(['(', '<']).next().unwrap_or_default();
            match &block {
                Some((of, _)) => found.insert(format!("{module}::{of}::{name}")),
                None => found.insert(format!("{module}::{name}")),
            };
        }
    }
}

/// What follows the list of generic parameters at the start.
fn without_generics(head: &str) -> String {
    let mut depth = 0_usize;
    for (place, letter) in head.char_indices() {
        match letter {
            '<' => depth += 1,
            '>' => depth = depth.saturating_sub(1),
            _ => {}
        }
        if depth == 0 {
            return head.get(place + 1..).unwrap_or_default().trim().to_string();
        }
    }
    String::new()
}

/// The last name of a path, without arguments.
fn type_name(path: &str) -> String {
    let path = path.trim().split(['<', ' ', '{']).next().unwrap_or_default();
    path.rsplit("::").next().unwrap_or_default().to_string()
}
