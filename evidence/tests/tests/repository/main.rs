//! Requirements of the repository itself.

mod crates;

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;

use plant_sim::PlantParameters;
use plant_sim::own_effects::{POINTS, VARIABLES};
use plant_sim::valve::ValveFunction;
use recording::csv;
use retarder_tests::bench_log::repository;

fn read(path: &str) -> String {
    fs::read_to_string(repository().join(path)).unwrap_or_else(|error| panic!("{path}: {error}"))
}

/// A crate must contain the files that it bundles, and users look for them under `data/`: the copies are equal.
#[test]
fn bundled_files_are_the_ones_under_data() {
    for (bundled, data) in [
        (
            "plant-sim/models/nominal-plant.toml",
            "data/nominal-plant.toml",
        ),
        (
            "model-lab/data/measurements.toml",
            "data/thesis/measurements.toml",
        ),
    ] {
        assert_eq!(read(bundled), read(data), "{bundled} and {data}");
    }
}

/// A module of a library can be read with only the modules below it: `use` between the modules of a crate has no cycle.
#[test]
fn modules_of_a_crate_use_each_other_one_way() {
    for crate_name in [
        "controller",
        "ecu",
        "hil-protocol",
        "recording",
        "plant-sim",
        "model-lab",
        "hil-harness",
        "report",
        "retarder",
        "workbench",
    ] {
        let source = repository().join(crate_name).join("src");
        let mut uses = BTreeMap::new();
        used_modules(&source, &source, &|_| vec!["crate::".to_owned()], &mut uses);
        assert_one_way(crate_name, uses);
    }
}

/// One convention for modules, so that the root of a module is where one looks for it.
#[test]
fn a_module_with_files_of_its_own_is_a_folder_with_mod_rs() {
    let mut folders = vec![repository()];
    let mut found = 0;
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            let name = path.file_name().unwrap().to_str().unwrap();
            if !path.is_dir() || name == "target" || name.starts_with('.') {
                continue;
            }
            let has_modules = fs::read_dir(&path).unwrap().any(|part| {
                part.unwrap()
                    .path()
                    .extension()
                    .is_some_and(|end| end == "rs")
            });
            let beside = path.with_extension("rs");
            assert!(
                !has_modules || !beside.exists(),
                "{} stands beside the folder of its module: move it to mod.rs in that folder",
                beside.display()
            );
            found += usize::from(path.join("mod.rs").exists());
            folders.push(path);
        }
    }
    assert!(found > 50, "the modules were found: {found}");
}

/// The groups of the diagnosis, which is as large as a crate, also have no cycle, and neither have the files of a group.
#[test]
fn modules_of_the_diagnosis_use_each_other_one_way() {
    let diagnosis = repository().join("model-lab/src/diagnosis");
    for group in ["", "evidence", "fit", "search"] {
        let source = diagnosis.join(group);
        let from_root = ["crate", "diagnosis", group].join("::");
        let from_root = format!("{}::", from_root.trim_end_matches(':'));
        let ways_down = |path: &Path| {
            let is_face = path.file_name().unwrap() == "mod.rs";
            let up = "super::".repeat(path.iter().count() - usize::from(is_face));
            vec![up, from_root.clone()]
        };
        let mut uses = BTreeMap::new();
        used_modules(&source, &source, &ways_down, &mut uses);
        assert_one_way(&format!("diagnosis/{group}"), uses);
    }
}

fn assert_one_way(whole: &str, mut uses: BTreeMap<String, BTreeSet<String>>) {
    // The root of a module may name all of its parts, and so may its tests.
    for face in ["lib", "mod", "main", "tests"] {
        uses.remove(face);
    }
    assert!(uses.len() > 3, "the modules were found: {uses:?}");
    // Removes modules without remaining dependencies, until there are none.
    while let Some(lowest) = uses
        .iter()
        .find(|(_, used)| !used.iter().any(|name| uses.contains_key(name)))
    {
        let lowest = lowest.0.clone();
        uses.remove(&lowest);
    }
    assert!(uses.is_empty(), "{whole}, in a circle: {uses:?}");
}

/// Collects the modules in `source`, each a file or a folder, with those that its code names after one of `ways_down`
/// of its path; tests may name any.
fn used_modules(
    source: &Path,
    folder: &Path,
    ways_down: &dyn Fn(&Path) -> Vec<String>,
    uses: &mut BTreeMap<String, BTreeSet<String>>,
) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            used_modules(source, &path, ways_down, uses);
            continue;
        }
        if path.extension().is_none_or(|end| end != "rs") {
            continue;
        }
        if path.file_stem().unwrap() == "tests" {
            continue;
        }
        let inner = path.strip_prefix(source).unwrap();
        let module = inner.iter().next().unwrap();
        let module = module.to_str().unwrap().trim_end_matches(".rs").to_owned();
        let text = fs::read_to_string(&path).unwrap();
        let code = text.split("#[cfg(test)]").next().unwrap().lines();
        let code = code.filter(|line| !line.trim_start().starts_with("//"));
        let used = uses.entry(module.clone()).or_default();
        let ways_down = ways_down(inner);
        for line in code {
            for way_down in ways_down.iter().filter(|way| !way.is_empty()) {
                let places = line.match_indices(way_down);
                let whole = places.filter(|(at, _)| !line[..*at].ends_with("super::"));
                for (at, _) in whole {
                    let rest = &line[at + way_down.len()..];
                    let end = rest.find(|c: char| c != '_' && !c.is_ascii_lowercase());
                    let name = &rest[..end.unwrap_or(rest.len())];
                    if !name.is_empty() && name != module {
                        used.insert(name.to_owned());
                    }
                }
            }
        }
    }
}

/// Returns the block of TOML with `words` in `docs/your-rig.md`.
fn block_of_your_rig(words: &str) -> String {
    let page = read("docs/your-rig.md");
    let blocks = page.split("```toml\n").skip(1);
    let mut blocks = blocks.filter_map(|block| Some(block.split_once("```")?.0));
    let block = blocks.find(|block| block.contains(words));
    block.expect("a block of TOML").to_owned()
}

/// The datasheet file in the document is a whole rig, and each of its uncertainties is read.
#[test]
fn the_data_sheet_of_the_page_for_your_rig_is_read() {
    let sheet = block_of_your_rig("fill_C_dm3_per_s_bar");
    let plant = PlantParameters::from_datasheet(&sheet, "your-rig.md");
    let plant = plant.unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(plant.functions, [ValveFunction::OnOff; 2]);
    assert_eq!(plant.knowledge.len(), sheet.matches(" = ").count());
}

/// The short datasheet file of two solenoid valves is a whole rig.
#[test]
fn the_solenoids_of_the_page_for_your_rig_are_read() {
    let sheet = block_of_your_rig("fill_valve_opens_at_ma");
    let plant = PlantParameters::from_datasheet(&sheet, "your-rig.md");
    let plant = plant.unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(plant.functions, [ValveFunction::NormallyClosed; 2]);
    assert_eq!(plant.provenance["armature.mass_kg"], "assumed");
}

/// The mapping on the page about your own rig can be copied unchanged.
#[test]
fn the_mapping_of_the_page_for_your_rig_is_read() {
    let mapping = block_of_your_rig("PWM1");
    let mapping =
        csv::Mapping::parse("your-rig.md", &mapping).unwrap_or_else(|error| panic!("{error}"));
    let log = "a logger\nof two lines\nZeit;PWM1;U_sensor;Comment\n\
               6190;0,0;0,50;\n6200;40,0;0,75;on\n6210;40,0;---;on\n";
    let options = csv::Options {
        mapping,
        ..csv::Options::default()
    };
    let log =
        csv::read("log.csv", log.as_bytes(), &options).unwrap_or_else(|error| panic!("{error}"));
    let values = |name: &str| log.signal(name).unwrap().values_or_nan().to_vec();
    assert_eq!(values("duty_fill"), [40.0, 40.0]);
    assert_eq!(values("duty_vent"), [0.0, 0.0]);
    assert_eq!(values("p_ch")[0], 0.125);
    assert!(values("p_ch")[1].is_nan());
}

/// The own effect of the page is a definition that is read, and the two tables are those of the simulator.
#[test]
fn the_own_effect_of_the_page_for_your_rig_is_read_and_its_tables_are_complete() {
    let definition = block_of_your_rig("[own_effects.");
    let file = format!("{}\n{definition}", PlantParameters::nominal().to_toml());
    let plant = PlantParameters::from_toml(&file, "your-rig.md");
    let plant = plant.unwrap_or_else(|error| panic!("{error}"));
    let about = plant.candidate("own.lifting_seal").unwrap().about();
    assert!(
        about.source.ends_with("its units are checked"),
        "{}",
        about.source
    );

    let page = read("docs/your-rig.md");
    let section = page.split_once("## An effect of your own").unwrap().1;
    let section = section.split_once("\n## ").unwrap().0;
    let rows = |head: &str| -> Vec<Vec<&str>> {
        let table = section.split_once(head).unwrap().1;
        let lines = table
            .lines()
            .skip(2)
            .take_while(|line| line.starts_with('|'));
        lines
            .map(|line| line.trim_matches('|').split(" | ").map(str::trim).collect())
            .collect()
    };
    let points = rows("| `acts_on` | value");
    assert_eq!(points.len(), POINTS.len());
    for (row, point) in points.iter().zip(&POINTS) {
        assert_eq!(
            row[..],
            [&format!("`{}`", point.name), point.about, point.unit]
        );
    }
    let variables = rows("| variable | meaning");
    assert_eq!(variables.len(), VARIABLES.len());
    for (row, variable) in variables.iter().zip(&VARIABLES) {
        let name = format!("`{}`", variable.name);
        assert_eq!(row[..3], [&name, variable.about, variable.unit]);
        let (least, most) = row[3].split_once(" to ").unwrap();
        let range = (least.parse().unwrap(), most.parse().unwrap());
        assert_eq!(variable.range, range, "{name}");
    }
}

/// Links in documents lead to existing files.
#[test]
fn links_between_documents_lead_somewhere() {
    let mut documents = vec![
        repository().join("README.md"),
        repository().join("ARCHITECTURE.md"),
    ];
    documents.push(repository().join("CONTRIBUTING.md"));
    for entry in fs::read_dir(repository().join("docs")).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_some_and(|extension| extension == "md") {
            documents.push(path);
        }
    }
    for document in documents {
        let text = fs::read_to_string(&document).unwrap();
        for target in text
            .split("](")
            .skip(1)
            .filter_map(|rest| rest.split(')').next())
        {
            let file = target.split('#').next().unwrap_or("");
            if file.is_empty() || file.contains("://") {
                continue;
            }
            let folder = document.parent().unwrap_or(Path::new("."));
            assert!(
                folder.join(file).exists(),
                "{}: {target}",
                document.display()
            );
        }
    }
}
