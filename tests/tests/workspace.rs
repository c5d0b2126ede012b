//! What the core crates depend on, as cargo sees it, and that they build without features.
#![allow(clippy::panic, clippy::unwrap_used, reason = "helpers of tests fail by panicking")]

use std::path::{Path, PathBuf};
use std::process::Command;

use serde_json::Value;

/// The crates for embedders, each with all that it may depend on.
const CORE: [(&str, &[&str]); 2] = [("spectral-core", &["libm"]), ("disk-sampling", &["libm", "spectral-core"])];

fn cargo(arguments: &[&str]) -> Command {
    let mut cargo = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    cargo.args(arguments).current_dir(root());
    cargo
}

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap().to_owned()
}

/// What a command prints on stdout, if it ends well.
fn output(mut command: Command) -> String {
    let output = command.output().unwrap();
    assert!(output.status.success(), "{command:?}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

fn packages() -> Vec<Value> {
    let text = output(cargo(&["metadata", "--format-version", "1", "--no-deps"]));
    let metadata: Value = serde_json::from_str(&text).unwrap();
    metadata["packages"].as_array().unwrap().clone()
}

fn package<'p>(packages: &'p [Value], name: &str) -> &'p Value {
    packages.iter().find(|package| package["name"] == name).unwrap_or_else(|| panic!("no package {name}"))
}

/// Dependencies of every target and behind every feature, build dependencies too; dev-dependencies don't reach embedders.
#[test]
fn the_core_crates_depend_on_libm_alone() {
    let packages = packages();
    for (name, allowed) in CORE {
        let dependencies = package(&packages, name)["dependencies"].as_array().unwrap();
        let dependencies: Vec<_> = dependencies.iter().filter(|d| d["kind"] != "dev").collect();
        let mut found: Vec<_> = dependencies.iter().map(|d| d["name"].as_str().unwrap()).collect();
        found.sort_unstable();
        assert_eq!(found, allowed, "{name}");
        for dependency in dependencies {
            assert!(dependency["kind"].is_null(), "{name} has a build dependency: {dependency}");
            if dependency["name"] == "libm" {
                assert_eq!(dependency["uses_default_features"], false, "{name}: {dependency}");
            }
        }
    }
}

/// The same for what cargo would compile, dependencies of dependencies included.
#[test]
fn nothing_else_is_compiled_for_them() {
    for (name, allowed) in CORE {
        let tree = output(cargo(&[
            "tree",
            "-p",
            name,
            "-e",
            "normal,build",
            "--target",
            "all",
            "--prefix",
            "none",
            "-f",
            "{lib}",
        ]));
        let mut found: Vec<_> = tree.lines().map(|line| line.trim_end_matches(" (*)").replace('_', "-")).collect();
        found.sort_unstable();
        found.dedup();
        let mut expected: Vec<_> = allowed.iter().copied().chain([name]).collect();
        expected.sort_unstable();
        assert_eq!(found, expected, "{name}:\n{tree}");
    }
}

#[test]
fn the_core_crates_build_without_features() {
    let target = Path::new(env!("CARGO_TARGET_TMPDIR")).join("no_features");
    for (name, _) in CORE {
        let mut build = cargo(&["build", "--quiet", "-p", name, "--no-default-features"]);
        build.arg("--target-dir").arg(&target);
        output(build);
    }
}

/// No feature brings a dependency, so that none can change a number by another library.
#[test]
fn their_features_only_switch() {
    let packages = packages();
    for (name, _) in CORE {
        for (feature, enables) in package(&packages, name)["features"].as_object().unwrap() {
            let dependencies = enables.as_array().unwrap().iter().filter(|e| e.as_str().unwrap().contains([':', '/']));
            assert_eq!(dependencies.count(), 0, "{name}, feature {feature}");
        }
    }
}

/// Data flows one way: nothing depends on the tests, and the core crates on no other member.
#[test]
fn nothing_depends_on_the_tests() {
    for package in packages() {
        let dependencies = package["dependencies"].as_array().unwrap();
        assert!(dependencies.iter().all(|d| d["name"] != "spectral-tests"), "{}", package["name"]);
    }
}
