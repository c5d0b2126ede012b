//! The public functions of the core crates, read from their sources: what the table must be complete for.

use alloc::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

use super::table::{ENTRIES, EXEMPT};
use syn::{ImplItem, Item, ItemImpl, TraitItem, Type, Visibility};

/// The crates that are scanned.
pub const CRATES: [&str; 2] = ["spectral-core", "disk-sampling"];

/// The public functions of both crates by the paths that users call them by, such as `colour::lab::lab_f` or `brdf::Ward::evaluate`: free
/// functions, methods, methods of public traits, and their implementations for the crates' own types.
///
/// A private module's functions are named without it, since they can only be public by a re-export there. What a macro writes isn't seen.
///
/// # Errors
/// A source file can't be read or parsed.
pub fn public_functions() -> Result<BTreeMap<String, &'static str>, String> {
    let mut found = BTreeMap::new();
    for name in CRATES {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(name).join("src");
        let mut modules = Vec::new();
        collect(&root.join("lib.rs"), &root, &[], &mut modules)?;
        let public: BTreeSet<String> = modules.iter().flat_map(|(_, items)| public_names(items)).collect();
        for (path, items) in &modules {
            for function in items.iter().flat_map(|item| functions(item, &public)) {
                found.insert(path.iter().cloned().chain([function]).collect::<Vec<_>>().join("::"), name);
            }
        }
    }
    Ok(found)
}

/// The public functions that are neither measured nor exempt.
///
/// # Errors
/// As [`public_functions`].
pub fn unlisted() -> Result<Vec<String>, String> {
    let exempt = EXEMPT.iter().flat_map(|(_, names)| names.iter().copied());
    let listed: BTreeSet<&str> = ENTRIES.iter().map(|entry| entry.name).chain(exempt).collect();
    Ok(public_functions()?.into_keys().filter(|name| !listed.contains(name.as_str())).collect())
}

type Module = (Vec<String>, Vec<Item>);

/// A file's items and those of the modules below it.
fn collect(file: &Path, folder: &Path, path: &[String], modules: &mut Vec<Module>) -> Result<(), String> {
    let text = fs::read_to_string(file).map_err(|error| format!("{}: {error}", file.display()))?;
    let parsed = syn::parse_file(&text).map_err(|error| format!("{}: {error}", file.display()))?;
    for item in &parsed.items {
        let Item::Mod(module) = item else { continue };
        let conditional = module.attrs.iter().any(|attribute| attribute.path().is_ident("cfg"));
        if module.content.is_some() || conditional {
            continue; // only tests are written in line or compiled on a condition
        }
        let name = module.ident.to_string();
        let mut below = path.to_vec();
        if matches!(module.vis, Visibility::Public(_)) {
            below.push(name.clone());
        }
        let (flat, nested) = (folder.join(format!("{name}.rs")), folder.join(&name));
        let source: PathBuf = if flat.exists() { flat } else { nested.join("mod.rs") };
        collect(&source, &nested, &below, modules)?;
    }
    modules.push((path.to_vec(), parsed.items));
    Ok(())
}

/// The traits and types that a module makes public.
fn public_names(items: &[Item]) -> Vec<String> {
    let name = |item: &Item| {
        let (visibility, name) = match item {
            Item::Trait(item) => (&item.vis, &item.ident),
            Item::Struct(item) => (&item.vis, &item.ident),
            Item::Enum(item) => (&item.vis, &item.ident),
            _ => return None,
        };
        matches!(visibility, Visibility::Public(_)).then(|| name.to_string())
    };
    items.iter().filter_map(name).collect()
}

/// The functions of an item, by name within its module.
fn functions(item: &Item, public: &BTreeSet<String>) -> Vec<String> {
    match item {
        Item::Fn(item) if matches!(item.vis, Visibility::Public(_)) => vec![item.sig.ident.to_string()],
        Item::Trait(item) if public.contains(&item.ident.to_string()) => {
            let name = |function: &TraitItem| match function {
                TraitItem::Fn(function) => Some(format!("{}::{}", item.ident, function.sig.ident)),
                _ => None,
            };
            item.items.iter().filter_map(name).collect()
        }
        Item::Impl(item) => methods(item, public),
        _ => Vec::new(),
    }
}

/// The public methods of an implementation for a public type; those of a reference are the referent's.
fn methods(item: &ItemImpl, public: &BTreeSet<String>) -> Vec<String> {
    let Type::Path(of) = &*item.self_ty else { return Vec::new() };
    let Some(of) = of.path.segments.last().map(|segment| segment.ident.to_string()) else { return Vec::new() };
    let of_trait = item.trait_.as_ref().and_then(|(_, path, _)| path.segments.last()).map(|s| s.ident.to_string());
    if !public.contains(&of) || of_trait.as_ref().is_some_and(|name| !public.contains(name)) {
        return Vec::new();
    }
    let name = |function: &ImplItem| match function {
        ImplItem::Fn(function) if of_trait.is_some() || matches!(function.vis, Visibility::Public(_)) => {
            Some(format!("{of}::{}", function.sig.ident))
        }
        _ => None,
    };
    item.items.iter().filter_map(name).collect()
}
