//! Who may know whom: the crate graph of ARCHITECTURE.md, section 4, read from the manifests and held.
//!
//! Also held: one set of lints, one Rust version, no wildcard versions, no licence that would bind the program.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::process::Command;

/// Each package and the packages of this repository that it must know: no more, no less.
const GRAPH: [(&str, &str, &[&str]); 5] = [
    (".", "poligon", &["poligon-sim", "poligon-terrain", "poligon-vegetation", "poligon-visual"]),
    ("terrain", "poligon-terrain", &[]),
    ("vegetation", "poligon-vegetation", &["poligon-terrain"]),
    ("sim", "poligon-sim", &["poligon-terrain"]),
    ("visual", "poligon-visual", &["poligon-terrain", "poligon-vegetation"]),
];

/// Beginnings of package names that a package must not reach, not even through others.
const BANNED: [(&str, &[&str]); 4] = [
    ("poligon-terrain", &["wgpu", "naga", "winit", "rapier", "parry", "gilrs", "hecs"]),
    ("poligon-vegetation", &["wgpu", "naga", "winit", "rapier", "parry", "gilrs", "hecs"]),
    ("poligon-sim", &["wgpu", "naga", "winit"]),
    ("poligon-visual", &["rapier", "gilrs", "hecs"]),
];

const RUST_VERSION: &str = "1.95";

fn root() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
}

fn manifest(folder: &str) -> toml::Table {
    let path = root().join(folder).join("Cargo.toml");
    let text = std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    text.parse().unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// Every table of dependencies with its name, those for one platform too.
fn dependency_tables(manifest: &toml::Table) -> Vec<(String, toml::Table)> {
    let mut tables = Vec::new();
    let targets = manifest.get("target").and_then(toml::Value::as_table);
    let holders =
        std::iter::once(manifest).chain(targets.into_iter().flat_map(|t| t.values().filter_map(toml::Value::as_table)));
    for holder in holders {
        for kind in ["dependencies", "build-dependencies", "dev-dependencies"] {
            if let Some(table) = holder.get(kind).and_then(toml::Value::as_table) {
                tables.push((kind.to_owned(), table.clone()));
            }
        }
    }
    tables
}

/// The package that an entry of a dependency table means: its key, unless it is renamed.
fn package_of(key: &str, entry: &toml::Value) -> String {
    entry.get("package").and_then(toml::Value::as_str).unwrap_or(key).to_owned()
}

#[test]
fn every_package_knows_whom_it_must_and_no_other() {
    for (folder, name, expected) in GRAPH {
        let manifest = manifest(folder);
        assert_eq!(manifest["package"]["name"].as_str(), Some(name));
        let known: BTreeSet<String> = dependency_tables(&manifest)
            .iter()
            .flat_map(|(_, table)| table.iter().map(|(key, entry)| package_of(key, entry)))
            .filter(|package| package.starts_with("poligon"))
            .collect();
        assert_eq!(known, expected.iter().map(|&p| p.to_owned()).collect(), "whom {name} knows");
    }
}

#[test]
fn the_workspace_is_the_packages_of_the_graph() {
    let workspace = &manifest(".")["workspace"];
    let members: BTreeSet<&str> =
        workspace["members"].as_array().unwrap().iter().map(|m| m.as_str().unwrap()).collect();
    assert_eq!(members, GRAPH.iter().map(|g| g.0).filter(|&folder| folder != ".").collect());
}

#[test]
fn lints_version_and_licence_are_stated_once() {
    let workspace = &manifest(".")["workspace"];
    assert_eq!(workspace["package"]["rust-version"].as_str(), Some(RUST_VERSION));
    assert_eq!(workspace["package"]["license"].as_str(), Some("MIT OR Apache-2.0"));
    assert_eq!(workspace["lints"]["rust"]["unsafe_code"].as_str(), Some("forbid"));
    for (folder, name, _) in GRAPH {
        let manifest = manifest(folder);
        let lints = manifest["lints"].as_table().unwrap();
        assert_eq!(
            lints.iter().collect::<Vec<_>>(),
            [(&"workspace".to_owned(), &toml::Value::Boolean(true))],
            "lints of {name}"
        );
        for key in ["rust-version", "edition", "license", "version"] {
            assert_eq!(manifest["package"][key].get("workspace"), Some(&toml::Value::Boolean(true)), "{key} of {name}");
        }
    }
}

#[test]
fn every_version_is_named() {
    let mut tables: Vec<(String, toml::Table)> = GRAPH
        .iter()
        .flat_map(|(folder, name, _)| {
            dependency_tables(&manifest(folder)).into_iter().map(move |(kind, t)| (format!("{name} {kind}"), t))
        })
        .collect();
    tables.push(("workspace".to_owned(), manifest(".")["workspace"]["dependencies"].as_table().unwrap().clone()));
    for (table, entries) in &tables {
        for (key, entry) in entries {
            let version = entry.as_str().or_else(|| entry.get("version").and_then(toml::Value::as_str));
            let elsewhere = entry.get("workspace").is_some() || entry.get("path").is_some();
            assert!(entry.get("git").is_none(), "{table}: {key} comes from a repository, not from a release");
            match version {
                Some(version) => assert!(!version.contains('*'), "{table}: {key} = `{version}` is a wildcard"),
                None => assert!(elsewhere, "{table}: {key} names no version"),
            }
        }
    }
    assert!(root().join("Cargo.lock").is_file(), "Cargo.lock is part of the repository");
}

/// What `cargo metadata` says, or why it says nothing (a dependency of another platform that was never fetched).
fn metadata() -> Result<serde_json::Value, String> {
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let answer = Command::new(cargo)
        .args(["metadata", "--offline", "--locked", "--format-version", "1", "--manifest-path"])
        .arg(root().join("Cargo.toml"))
        .output()
        .map_err(|error| error.to_string())?;
    if !answer.status.success() {
        return Err(String::from_utf8_lossy(&answer.stderr).trim().to_owned());
    }
    serde_json::from_slice(&answer.stdout).map_err(|error| error.to_string())
}

#[test]
fn no_crate_reaches_what_it_must_not() {
    let metadata = match metadata() {
        Ok(metadata) => metadata,
        Err(reason) => return println!("skipped: cargo metadata does not answer: {reason}"),
    };
    let mut names = BTreeMap::new();
    for package in metadata["packages"].as_array().unwrap() {
        names.insert(package["id"].as_str().unwrap(), package["name"].as_str().unwrap());
    }
    let mut needs: BTreeMap<&str, Vec<&str>> = BTreeMap::new();
    for node in metadata["resolve"]["nodes"].as_array().unwrap() {
        for dependency in node["deps"].as_array().unwrap() {
            // A null kind is a normal dependency; what tests alone need does not count.
            if dependency["dep_kinds"].as_array().unwrap().iter().any(|kind| kind["kind"] != "dev") {
                needs.entry(node["id"].as_str().unwrap()).or_default().push(dependency["pkg"].as_str().unwrap());
            }
        }
    }
    for (name, banned) in BANNED {
        let start = *names.iter().find(|(_, n)| **n == name).unwrap().0;
        let (mut reached, mut open) = (BTreeSet::from([start]), vec![start]);
        while let Some(id) = open.pop() {
            for &next in needs.get(id).into_iter().flatten() {
                if reached.insert(next) {
                    open.push(next);
                }
            }
        }
        for id in &reached {
            let package = names[id];
            assert!(!banned.iter().any(|b| package.starts_with(b)), "{name} must not reach {package}");
        }
    }
}

#[test]
fn no_licence_binds_the_program() {
    let metadata = match metadata() {
        Ok(metadata) => metadata,
        Err(reason) => return println!("skipped: cargo metadata does not answer: {reason}"),
    };
    let packages = metadata["packages"].as_array().unwrap();
    assert!(packages.len() > GRAPH.len());
    for package in packages {
        let (name, licence) = (&package["name"], package["license"].as_str());
        assert!(licence.is_some_and(may_be_linked), "{name} is under {licence:?}");
    }
}

/// Whether an SPDX expression leaves a choice that is free of the GPL and its kin.
fn may_be_linked(licence: &str) -> bool {
    // The old form `MIT/Apache-2.0` means a choice.
    let spaced = licence.replace('/', " OR ").replace('(', " ( ").replace(')', " ) ");
    let mut words = spaced.split_whitespace().peekable();
    let fine = any_choice(&mut words);
    fine && words.next().is_none()
}

type Words<'w> = std::iter::Peekable<std::str::SplitWhitespace<'w>>;

fn any_choice(words: &mut Words<'_>) -> bool {
    let mut fine = all_parts(words);
    while words.next_if_eq(&"OR").is_some() {
        fine |= all_parts(words);
    }
    fine
}

fn all_parts(words: &mut Words<'_>) -> bool {
    let mut fine = one_part(words);
    while words.next_if_eq(&"AND").is_some() {
        fine &= one_part(words);
    }
    fine
}

fn one_part(words: &mut Words<'_>) -> bool {
    let fine = match words.next() {
        Some("(") => {
            let fine = any_choice(words);
            fine & words.next_if_eq(&")").is_some()
        }
        Some(name) => !name.contains("GPL"),
        None => false,
    };
    if words.next_if_eq(&"WITH").is_some() {
        words.next();
    }
    fine
}

#[test]
fn licence_expressions_are_judged_by_their_best_choice() {
    for fine in [
        "MIT",
        "MIT OR GPL-3.0",
        "MIT/Apache-2.0",
        "(MIT OR GPL-2.0) AND Zlib",
        "Apache-2.0 WITH LLVM-exception OR MIT",
    ] {
        assert!(may_be_linked(fine), "{fine}");
    }
    for bad in
        ["GPL-3.0", "AGPL-3.0-only", "LGPL-2.1", "MIT AND GPL-3.0", "GPL-2.0 AND (MIT OR Zlib)", "", "(MIT", "MIT)"]
    {
        assert!(!may_be_linked(bad), "{bad}");
    }
}

#[test]
fn every_source_file_says_what_it_is() {
    let mut files = Vec::new();
    for folder in ["src", "tests", "terrain", "vegetation", "sim", "visual"] {
        rust_files(&root().join(folder), &mut files);
    }
    assert!(files.len() > 10);
    for file in files {
        let text = std::fs::read_to_string(&file).unwrap();
        assert!(text.starts_with("//! "), "{} must begin with `//! ` and what it is", file.display());
        let stem = file.file_stem().and_then(|stem| stem.to_str()).unwrap();
        assert!(!["utils", "helpers", "common", "manager"].contains(&stem), "{} names no concept", file.display());
    }
}

fn rust_files(folder: &Path, files: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).into_iter().flatten().flatten() {
        let path = entry.path();
        if path.is_dir() && path.file_name().is_some_and(|name| name != "target") {
            rust_files(&path, files);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            files.push(path);
        }
    }
}
