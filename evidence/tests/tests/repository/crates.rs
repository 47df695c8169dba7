//! Crates of the repository: what they use, the drawing and the table of ARCHITECTURE.md, and the order of a release.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Component, Path, PathBuf};

use super::read;
use retarder_tests::bench_log::repository;

/// A crate, by its folder in the repository.
struct Crate {
    manifest: toml::Table,
    /// Folders of the crates of the repository that it uses, also in its tests and its build script.
    uses: BTreeSet<String>,
}

impl Crate {
    fn read(folder: &str, workspace: &toml::Table) -> Self {
        let manifest = read(&format!("{folder}/Cargo.toml"));
        let manifest: toml::Table = manifest.parse().unwrap();
        let uses = dependencies(&manifest)
            .filter_map(|(name, dependency)| {
                let path =
                    |dependency: &toml::Value| Some(dependency.get("path")?.as_str()?.to_owned());
                if dependency.get("workspace").is_some() {
                    return path(&workspace["dependencies"][name]);
                }
                Some(resolved(&Path::new(folder).join(path(dependency)?)))
            })
            .collect();
        Self { manifest, uses }
    }

    fn name(&self) -> &str {
        self.manifest["package"]["name"].as_str().unwrap()
    }

    fn is_published(&self) -> bool {
        self.manifest["package"].get("publish").is_none()
    }
}

/// Returns the names and values under each table of dependencies, for any target.
fn dependencies(manifest: &toml::Table) -> impl Iterator<Item = (&str, &toml::Value)> {
    let targets = manifest.get("target").and_then(toml::Value::as_table);
    let targets = targets.into_iter().flat_map(toml::Table::values);
    let parents = std::iter::once(manifest).chain(targets.filter_map(toml::Value::as_table));
    parents
        .flat_map(|parent| {
            ["dependencies", "dev-dependencies", "build-dependencies"]
                .into_iter()
                .filter_map(|table| parent.get(table)?.as_table())
        })
        .flatten()
        .map(|(name, value)| (name.as_str(), value))
}

/// Returns a relative path without `..`.
fn resolved(path: &Path) -> String {
    let mut folder = PathBuf::new();
    for part in path.components() {
        match part {
            Component::ParentDir => {
                assert!(folder.pop(), "{} leaves the repository", path.display())
            }
            part => folder.push(part),
        }
    }
    folder.to_str().unwrap().to_owned()
}

fn workspace() -> toml::Table {
    let manifest: toml::Table = read("Cargo.toml").parse().unwrap();
    manifest["workspace"].as_table().unwrap().clone()
}

/// Returns the members of the workspace and the fuzz targets, by folder.
fn crates() -> BTreeMap<String, Crate> {
    let workspace = workspace();
    let members = workspace["members"].as_array().unwrap();
    let members = members.iter().map(|member| member.as_str().unwrap());
    members
        .chain(["fuzz"])
        .map(|folder| (folder.to_owned(), Crate::read(folder, &workspace)))
        .collect()
}

/// Returns the section `## Crates` of ARCHITECTURE.md.
fn section() -> String {
    let architecture = read("ARCHITECTURE.md");
    let section = architecture.split_once("\n## Crates\n").unwrap().1;
    section.split_once("\n## ").unwrap().0.to_owned()
}

/// The README's first command is `cargo run`: the default members need exactly one default program.
#[test]
fn cargo_run_means_one_program() {
    let crates = crates();
    let workspace = workspace();
    let members = workspace["default-members"].as_array().unwrap();
    let programs: Vec<_> = members
        .iter()
        .filter_map(|member| {
            crates[member.as_str().unwrap()].manifest["package"].get("default-run")
        })
        .collect();
    assert_eq!(programs, [&toml::Value::from("retarder")]);
}

/// The table of ARCHITECTURE.md has a row for each crate, and the row lists exactly the crates that it uses.
#[test]
fn crates_use_each_other_as_the_architecture_says() {
    let section = section();
    let names = |cell: &str| -> BTreeSet<String> {
        cell.split('`')
            .skip(1)
            .step_by(2)
            .map(str::to_owned)
            .collect()
    };
    let rows = section.lines().filter(|line| line.starts_with("| `"));
    let rows = rows.map(|row| row.split('|').collect::<Vec<_>>());
    // The folders that are no crates have a table of two columns.
    let table: BTreeMap<_, _> = rows
        .filter(|cells| cells.len() == 6)
        .map(|cells| (names(cells[1]).pop_first().unwrap(), names(cells[3])))
        .collect();
    let manifests: BTreeMap<_, _> = crates()
        .into_iter()
        .map(|(folder, one)| (folder, one.uses))
        .collect();
    assert_eq!(table, manifests);
}

/// The drawing of ARCHITECTURE.md has every crate once, one line above the highest crate that it uses.
#[test]
fn the_drawing_of_the_architecture_has_every_crate_above_those_it_uses() {
    let section = section();
    let drawing = section.split_once("```text\n").unwrap().1;
    let drawing = drawing.split_once("```").unwrap().0;
    let crates = crates();
    let mut heights = BTreeMap::new();
    for (height, line) in drawing.lines().rev().enumerate() {
        for word in line
            .split_whitespace()
            .filter(|word| crates.contains_key(*word))
        {
            let second = heights.insert(word, height);
            assert_eq!(second, None, "{word} stands in the drawing twice");
        }
    }
    for (folder, one) in &crates {
        let lines_above = |used: &String| heights[used.as_str()] + 1;
        let expected = one.uses.iter().map(lines_above).max().unwrap_or(0);
        assert_eq!(
            heights.get(folder.as_str()),
            Some(&expected),
            "{folder}, from below"
        );
    }
}

/// Each row under `[workspace.dependencies]` is used by a crate.
#[test]
fn the_workspace_lists_no_dependency_that_no_crate_uses() {
    let crates = crates();
    let used: BTreeSet<_> = crates
        .values()
        .flat_map(|one| dependencies(&one.manifest))
        .filter(|(_, dependency)| dependency.get("workspace").is_some())
        .map(|(name, _)| name)
        .collect();
    let workspace = workspace();
    let listed = workspace["dependencies"].as_table().unwrap();
    let listed: BTreeSet<_> = listed.keys().map(String::as_str).collect();
    assert_eq!(listed, used);
}

/// Each dependency of a member is named by its code. The fuzz targets share code with the tests of other crates.
#[test]
fn no_crate_has_a_dependency_that_its_code_does_not_name() {
    for (folder, one) in crates().into_iter().filter(|(folder, _)| folder != "fuzz") {
        let mut code = String::new();
        append_code(&repository().join(&folder), &mut code);
        let words: BTreeSet<_> = code
            .split(|character: char| !character.is_alphanumeric() && character != '_')
            .collect();
        for (name, _) in dependencies(&one.manifest) {
            let is_named = words.contains(name.replace('-', "_").as_str());
            assert!(is_named, "{folder} does not use {name}");
        }
    }
}

fn append_code(folder: &Path, code: &mut String) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            let name = path.file_name().unwrap();
            if name != "target" {
                append_code(&path, code);
            }
        } else if path.extension().is_some_and(|end| end == "rs") {
            *code += &fs::read_to_string(&path).unwrap();
        }
    }
}

/// Every dependency from outside has a comment above it that states its benefit.
#[test]
fn every_outside_dependency_has_its_reason() {
    for folder in crates().into_keys() {
        let text = read(&format!("{folder}/Cargo.toml"));
        let mut in_dependencies = false;
        let mut last = "";
        for line in text.lines() {
            if line.starts_with('[') {
                in_dependencies = line.contains("dependencies]");
            } else if in_dependencies && !line.starts_with('#') && line.contains('=') {
                let ours = line.contains("workspace = true") || line.contains("path =");
                let explained = last.starts_with('#');
                assert!(ours || explained, "{folder}: {line}");
            }
            // The comment has to be directly above each dependency, also above the second of two.
            last = line;
        }
    }
}

/// The order of a release in CONTRIBUTING.md has every published crate after those that it uses.
#[test]
fn the_release_order_has_every_published_crate_after_those_it_uses() {
    let contributing = read("CONTRIBUTING.md");
    let step = contributing
        .split_once("`cargo publish --workspace`")
        .unwrap()
        .1;
    let order = step.split_once("dependencies:").unwrap().1;
    let order = order.split_once('.').unwrap().0;
    let order: Vec<_> = order.split('`').skip(1).step_by(2).collect();
    let crates = crates();
    let place = |one: &Crate| order.iter().position(|name| *name == one.name());
    let published = crates.values().filter(|one| one.is_published());
    assert_eq!(order.len(), published.clone().count(), "{order:?}");
    for one in published {
        let own_place = place(one);
        assert!(own_place.is_some(), "{} is missing", one.name());
        for used in &one.uses {
            let used = &crates[used];
            let comes_before = place(used).is_some_and(|used| Some(used) < own_place);
            assert!(
                comes_before,
                "{} needs {} before it",
                one.name(),
                used.name()
            );
        }
    }
}
