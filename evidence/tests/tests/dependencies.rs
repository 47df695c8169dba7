//! Linked crates (rule 12 of the local page): licences, sources and bans of `deny.toml`, for every crate in the tree.
//!
//! `cargo deny check` also checks known advisories, which need the network.

use std::collections::BTreeSet;

use cargo_metadata::{CargoOpt, Metadata, MetadataCommand, Package};
use retarder_tests::bench_log::repository;
use serde::Deserialize;

#[derive(Deserialize)]
struct Rules {
    licenses: Licences,
    bans: Bans,
}

#[derive(Deserialize)]
struct Licences {
    allow: BTreeSet<String>,
    exceptions: Vec<Exception>,
}

#[derive(Deserialize)]
struct Exception {
    #[serde(rename = "crate")]
    name: String,
    allow: BTreeSet<String>,
}

#[derive(Deserialize)]
struct Bans {
    deny: Vec<Banned>,
}

#[derive(Deserialize)]
struct Banned {
    #[serde(rename = "crate")]
    name: String,
}

fn rules() -> Rules {
    let text = std::fs::read_to_string(repository().join("deny.toml")).unwrap();
    toml::from_str(&text).unwrap()
}

/// Returns everything that is built for the tested targets, with each feature on.
fn tree() -> Metadata {
    let platforms = ["x86_64-unknown-linux-gnu", "thumbv7em-none-eabihf"];
    let platform = |target: &str| format!("--filter-platform={target}");
    let mut command = MetadataCommand::new();
    command
        .manifest_path(repository().join("Cargo.toml"))
        .features(CargoOpt::AllFeatures)
        .other_options([&["--locked".to_owned()][..], &platforms.map(platform)].concat());
    command.exec().unwrap()
}

fn from_outside(tree: &Metadata) -> impl Iterator<Item = &Package> {
    let linked = tree.resolve.iter().flat_map(|graph| &graph.nodes);
    let packages = linked.map(|node| &tree[&node.id]);
    packages.filter(|package| !tree.workspace_members.contains(&package.id))
}

fn is_allowed(package: &Package, rules: &Licences) -> bool {
    let exception = rules
        .exceptions
        .iter()
        .find(|one| one.name == *package.name);
    let extra = exception.map(|one| &one.allow);
    let allows = |licence: &str| {
        rules.allow.contains(licence) || extra.is_some_and(|extra| extra.contains(licence))
    };
    let expression = package.license.as_deref().unwrap_or_default();
    spdx::Expression::parse_mode(expression, spdx::ParseMode::LAX)
        .is_ok_and(|expression| expression.evaluate(|term| allows(&term.to_string())))
}

#[test]
fn every_licence_is_an_allowed_one() {
    let (tree, rules) = (tree(), rules());
    let mut count = 0;
    for package in from_outside(&tree) {
        assert!(
            is_allowed(package, &rules.licenses),
            "{} {}: {:?} is not in deny.toml",
            package.name,
            package.version,
            package.license
        );
        count += 1;
    }
    assert!(count > 100, "the tree was found: {count} crates");
    let first = from_outside(&tree).next().unwrap();
    let strict = Licences {
        allow: BTreeSet::new(),
        exceptions: vec![],
    };
    assert!(!is_allowed(first, &strict), "the licence is read");
}

#[test]
fn every_exception_is_needed() {
    let (tree, mut rules) = (tree(), rules());
    for exception in std::mem::take(&mut rules.licenses.exceptions) {
        let needed = from_outside(&tree)
            .any(|one| *one.name == exception.name && !is_allowed(one, &rules.licenses));
        assert!(needed, "{} needs no exception", exception.name);
    }
}

#[test]
fn every_source_is_the_registry_and_nothing_banned_is_linked() {
    let (tree, rules) = (tree(), rules());
    for package in from_outside(&tree) {
        let source = package.source.as_ref();
        assert!(
            source.is_some_and(cargo_metadata::Source::is_crates_io),
            "{}: {source:?}",
            package.name
        );
        let is_banned = rules.bans.deny.iter().any(|one| one.name == *package.name);
        assert!(!is_banned, "{} is banned by deny.toml", package.name);
    }
}
