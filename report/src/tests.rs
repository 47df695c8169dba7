//! Claims about whole reports: a log contributes text only, a report loads nothing, and equal contents give equal
//! bytes.

use hil_harness::{ConfirmedFault, Requirement, Run, Scenario, Verdict, run_in_process};
use model_lab::diagnosis::Diagnosis;
use model_lab::diagnosis::result::{FlowCurve, FlowPoint, Verdict as DiagnosisVerdict};
use model_lab::result::{LogDefects, NotCompared};
use model_lab::thesis::{Measurements, ThesisTable, compare_with_model};
use model_lab::{CompareOptions, Comparison, compare};
use plant_sim::PlantParameters;
use recording::{Clock, Recording, StartTime, csv};

use super::*;
use crate::plot;

const ROOT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/..");
const LOG: &str = "practice-01-id.csv";
const DIAGNOSIS: &str = include_str!("../../docs/schema/diagnosis.example.json");

/// Hostile text of a log or a file name.
const HOSTILE: &str = "</title></svg><script>alert(1)</script><img src=x onerror='alert(2)'>\" onload=\"x &lt; \u{0}\u{1b}[31m\u{202e}";

struct Bench {
    log: Recording,
    plant: PlantParameters,
    comparison: Comparison,
    run: Run,
    verdict: Verdict,
    thesis: ThesisTable,
}

impl Bench {
    fn new() -> Self {
        let path = format!("{ROOT}/data/synthetic/{LOG}");
        let log = csv::read_file(path, &csv::Options::default()).unwrap();
        let nominal = PlantParameters::nominal();
        let run = run_in_process(&Scenario::built_in("figure-6.5").unwrap()).unwrap();
        Self {
            comparison: compare(&nominal, &log, &CompareOptions::default()).unwrap(),
            log,
            verdict: run.verdict(&Requirement::THESIS).unwrap(),
            run,
            thesis: compare_with_model(&nominal, &Measurements::bundled()),
            plant: nominal,
        }
    }

    /// Creates a report in which every foreign text is `text`.
    fn report(&self, text: &str) -> String {
        let input = Input {
            role: text.to_owned(),
            name: text.to_owned(),
            identity: Some((17, text.to_owned())),
        };
        let control = ControlPart {
            recording: &self.run.recording,
            requirement: &Requirement::THESIS,
            verdict: &self.verdict,
            plant: text,
            controller: text,
            conditions: text,
            rigs: &[],
        };
        html(&Contents {
            title: text,
            logs: &[
                LogPart {
                    name: text,
                    recording: Some(&self.log),
                    problems: &[],
                },
                LogPart {
                    name: text,
                    recording: None,
                    problems: &[text.to_owned()],
                },
            ],
            plant: Some(PlantPart {
                name: text,
                parameters: &self.plant,
            }),
            models: &[ModelPart {
                log: &self.log,
                comparison: &self.comparison,
                is_explained: false,
            }],
            history: Some(HistoryPart {
                steps: &[HistoryStep {
                    what: text.to_owned(),
                    log: text.to_owned(),
                    errors: vec![(text.to_owned(), 0.1, Some(0.01))],
                }],
                current: 0,
            }),
            control: &[control],
            thesis: Some(&self.thesis),
            next_steps: &[text.to_owned()],
            origin: Origin {
                command_line: text,
                inputs: &[input, Input::of_recording("log", self.log.provenance())],
                versions: &[(text.to_owned(), text.to_owned())],
            },
            ..Contents::default()
        })
    }
}

/// Goal: text of a log is shown and never interpreted. Method: every text of every part is hostile.
#[test]
fn hostile_text_stays_text() {
    let mut bench = Bench::new();
    let hostile = || HOSTILE.to_owned();
    bench.comparison.verdict.rule = hostile();
    bench.comparison.start.statement = hostile();
    for signal in &mut bench.comparison.signals {
        signal.finding.sentence = hostile();
        signal.noise_floor.statement = hostile();
        signal.unit = hostile();
        signal.error_map.duty_bands.fill(hostile());
        signal.error_map.pressure_bands.fill(hostile());
        for shares in &mut signal.regimes {
            shares.title = hostile();
            shares.bins.iter_mut().for_each(|bin| bin.label = hostile());
        }
    }
    bench.comparison.signals[1].name = hostile();
    bench.comparison.defects.sentences = vec![hostile()];
    bench.verdict.source = hostile();
    for check in &mut bench.verdict.checks {
        (check.requirement, check.evidence, check.unit) = (hostile(), hostile(), hostile());
    }
    bench.verdict.confirmed_faults = Some(vec![ConfirmedFault {
        fault: hostile(),
        first_s: 1.0,
        samples: 2,
    }]);
    for row in &mut bench.thesis.rows {
        (row.quantity, row.unit, row.source) = (hostile(), hostile(), hostile());
        (row.rig, row.note) = (Some(hostile()), Some(hostile()));
    }
    assert_harmless(&bench.report(HOSTILE));
}

#[test]
fn the_loop_shows_the_error_of_its_sensor_and_the_faults_that_the_ecu_confirmed() {
    let mut bench = Bench::new();
    let sound = bench.report("bench");
    assert!(sound.contains("Error of the pressure sensor") && !sound.contains("The ECU confirmed"));
    bench.verdict.confirmed_faults = Some(vec![ConfirmedFault {
        fault: "NoFall".to_owned(),
        first_s: 1.25,
        samples: 300,
    }]);
    let report = bench.report("bench");
    let said = report
        .split("The ECU confirmed: ")
        .nth(1)
        .unwrap_or_default();
    assert!(
        said.starts_with("<code>") && said[..100].contains("NoFall"),
        "{}",
        &said[..100]
    );
    assert!(said[..200].contains("for 300 samples."), "{}", &said[..200]);
}

/// Defect seen: with a pause of 0.7 s and a missing cell, the table of logs said "none".
#[test]
fn gaps_and_missing_cells_are_problems_of_the_log() {
    let path = format!("{ROOT}/data/synthetic/{LOG}");
    let text = std::fs::read_to_string(path).unwrap();
    let mut rows: Vec<&str> = text.lines().collect();
    let header = rows
        .iter()
        .position(|row| row.starts_with("time_s"))
        .unwrap();
    rows.drain(header + 301..header + 371);
    let damaged: String = rows
        .iter()
        .enumerate()
        .map(
            |(row, text)| match (row == header + 200, text.rsplit_once(',')) {
                (true, Some((rest, _))) => format!("{rest},\n"),
                _ => format!("{text}\n"),
            },
        )
        .collect();
    let mut bench = Bench::new();
    assert!(!bench.report("plain").contains("no rows from"));
    bench.log = csv::read(LOG, damaged.as_bytes(), &csv::Options::default()).unwrap();
    bench.comparison = compare(&bench.plant, &bench.log, &CompareOptions::default()).unwrap();
    let report = bench.report("plain");
    assert_eq!(report.matches("no rows from").count(), 1);
    assert_eq!(report.matches("No rows from").count(), 1);
    assert!(
        report.contains("cells of u_bat are missing"),
        "{:?}",
        bench.comparison.defects
    );
    assert!(report.contains("the model begins again at the measured"));
}

/// Goal: text in a diagnosis is shown and never interpreted. Method: the published example with every text hostile.
#[test]
fn hostile_text_in_a_diagnosis_stays_text() {
    let bench = Bench::new();
    let mut diagnosis: Diagnosis = serde_json::from_str(DIAGNOSIS).unwrap();
    let hostile = || HOSTILE.to_owned();
    diagnosis.sentence = hostile();
    let signal = NotCompared {
        name: hostile(),
        reason: hostile(),
    };
    diagnosis.not_compared = [(hostile(), vec![signal])].into();
    let defects = LogDefects {
        sentences: vec![hostile()],
        ..LogDefects::default()
    };
    diagnosis.defects = [(hostile(), defects)].into();
    diagnosis.held_out = hostile();
    diagnosis.remaining.sentences = vec![hostile()];
    let point = |at| FlowPoint {
        at,
        bar_per_s: 0.1 * at,
        standard_error: 0.01,
        samples: 50,
    };
    diagnosis.remaining.missing_flow = vec![FlowCurve {
        against: hostile(),
        unit: hostile(),
        condition: hostile(),
        explained_share: 0.5,
        points: vec![point(1.0), point(2.0)],
    }];
    for candidate in &mut diagnosis.candidates {
        (candidate.variant, candidate.physics) = (hostile(), hostile());
        candidate.plausibility = hostile();
    }
    for step in &mut diagnosis.error_steps {
        step.variant = Some(hostile());
    }
    for regime in &mut diagnosis.location.before {
        (regime.log, regime.sentence) = (hostile(), hostile());
    }
    for value in &mut diagnosis.nuisance {
        (value.name, value.alarm) = (hostile(), Some(hostile()));
    }
    let runs = BeforeAndAfter {
        log: &bench.log,
        before: bench.comparison.clone(),
        after: Some(bench.comparison.clone()),
    };
    let next = NextCommand {
        purpose: "add the effect to the plant file",
        command: hostile(),
    };
    let report = html(&Contents {
        title: HOSTILE,
        diagnosis: Some(DiagnosisPart {
            diagnosis: &diagnosis,
            runs: Some(&runs),
            next_command: Some(&next),
        }),
        ..Contents::default()
    });
    assert_harmless(&report);
}

/// Creates the page of a diagnosis of the bundled log, as `retarder diagnose --html` does.
fn page_of(bench: &Bench, diagnosis: &Diagnosis) -> String {
    let runs = BeforeAndAfter::worst(diagnosis, &bench.plant, &[&bench.log]);
    html(&Contents {
        title: "diagnosis",
        diagnosis: Some(DiagnosisPart {
            diagnosis,
            runs: runs.as_ref(),
            next_command: None,
        }),
        ..Contents::default()
    })
}

/// Defect seen: the sentence "Nearest, in standard deviations of the noise: ." with an empty list.
#[test]
fn an_effect_without_a_neighbour_has_no_empty_list_of_them() {
    let bench = Bench::new();
    let mut diagnosis: Diagnosis = serde_json::from_str(DIAGNOSIS).unwrap();
    let (list, none) = (
        "Nearest, in standard deviations",
        "No other effect explains anything",
    );
    let neighbours = [("dead_volume".to_owned(), 7.5)].into();
    diagnosis.distinguishability = [("chamber_leak".to_owned(), neighbours)].into();
    let with = page_of(&bench, &diagnosis);
    assert!(with.contains(list) && !with.contains(none));
    diagnosis.distinguishability = [("chamber_leak".to_owned(), [].into())].into();
    let without = page_of(&bench, &diagnosis);
    assert!(!without.contains(list) && without.contains(none));
}

/// Defect seen: a verdict without a named effect had no plot. Now every compared signal is plotted as measured and as
/// modelled by the plain model.
#[test]
fn a_diagnosis_that_names_nothing_shows_measured_and_modelled() {
    let bench = Bench::new();
    let mut diagnosis: Diagnosis = serde_json::from_str(DIAGNOSIS).unwrap();
    let named = page_of(&bench, &diagnosis).matches("<svg").count();
    diagnosis.verdict = DiagnosisVerdict::NotInLibrary;
    diagnosis.effects.clear();
    diagnosis.error_steps.truncate(1);
    let page = page_of(&bench, &diagnosis);
    assert!(page.contains("not in the library"));
    let plots = page.matches("<svg").count();
    assert!(plots >= 3 && plots == named, "{plots} of {named} plots");
    assert_well_formed(&page);
}

fn assert_harmless(report: &str) {
    for forbidden in [
        "<script",
        "<img",
        "</title></svg>",
        "\" onload=\"",
        "\0",
        "\u{1b}",
    ] {
        assert!(!report.contains(forbidden), "{forbidden:?} got through");
    }
    assert!(report.contains("&lt;script&gt;alert(1)&lt;/script&gt;"));
    assert_well_formed(report);
}

#[test]
fn every_tag_is_closed_in_its_place() {
    assert_well_formed(&Bench::new().report("bench"));
}

#[test]
fn the_report_names_no_other_machine_and_forbids_to_load_or_run() {
    let report = Bench::new().report("bench");
    for forbidden in [
        "http://", "https://", "src=", "@import", "url(", "<script", "<link", "<iframe",
    ] {
        assert!(!report.contains(forbidden), "{forbidden:?}");
    }
    assert!(
        report.contains("http-equiv=\"Content-Security-Policy\" content=\"default-src 'none';")
    );
}

#[test]
fn a_log_that_knows_when_it_began_says_so() {
    let mut bench = Bench::new();
    assert!(!bench.report("bench").contains("recorded "));
    bench.log.provenance_mut().start = Some(StartTime {
        since_1970_ns: 1_714_745_527_000_000_000,
        clock: Clock::Utc { ahead_min: 0 },
    });
    let report = bench.report("bench");
    assert!(report.contains("recorded 2024-05-03 14:12:07 UTC"));
}

#[test]
fn equal_contents_give_equal_bytes() {
    assert_eq!(Bench::new().report("bench"), Bench::new().report("bench"));
}

#[test]
fn a_minute_of_log_and_a_run_make_less_than_a_megabyte_and_a_half() {
    let bytes = Bench::new().report("bench").len();
    assert!(bytes < 1_500_000, "{bytes} bytes");
}

#[test]
fn the_verdict_is_the_one_of_the_comparison_and_open_where_it_is_unknown() {
    let Bench {
        log,
        mut comparison,
        ..
    } = Bench::new();
    let badge_if = |comparison: &Comparison, is_explained| {
        let part = ModelPart {
            log: &log,
            comparison,
            is_explained,
        };
        model::standing(&part).badge().into_string()
    };
    let badge = |comparison: &Comparison| badge_if(comparison, false);
    assert!(badge(&comparison).contains("fail"));
    // Defect seen: a model whose error a diagnosis explains had a red mark.
    let explained = badge_if(&comparison, true);
    assert!(
        explained.contains("explained") && !explained.contains("fail"),
        "{explained}"
    );
    assert!(model::headline(&comparison).starts_with("The model misses the chamber pressure by "));
    comparison.verdict.failing.clear();
    comparison.verdict.undecided = vec!["p_ch".to_owned()];
    comparison
        .signals
        .iter_mut()
        .for_each(|signal| signal.holds = None);
    assert!(badge(&comparison).contains("open"));
    comparison.verdict.undecided.clear();
    comparison.verdict.holds = true;
    assert!(badge_if(&comparison, true).contains("✓ pass"));
}

#[test]
fn a_report_of_nothing_is_still_a_page() {
    let report = html(&Contents {
        title: "empty",
        ..Contents::default()
    });
    assert_well_formed(&report);
    assert!(!report.contains("id=\"model\"") && !report.contains("id=\"next\""));
}

/// The figure in the README has the texts of the current figure. `BLESS=1 cargo nextest run -p report
/// picture_of_the_readme` draws it again; check it before the commit.
///
/// Only its texts are compared: a small change of a line by the solver does not require a new figure.
#[test]
fn the_picture_of_the_readme_has_the_texts_of_the_figure() {
    let bench = Bench::new();
    let signal = &bench.comparison.signals[0];
    let window_s = plot::excerpt(&bench.comparison, &signal.name, 10.0);
    let picture = plot::comparison(&bench.log, &bench.comparison, signal, window_s)
        .unwrap()
        .svg_file();
    assert_well_formed(&picture);
    let path = format!("{ROOT}/docs/pictures/comparison.svg");
    if std::env::var_os("BLESS").is_some() {
        std::fs::write(&path, &picture).unwrap();
    }
    let blessed = std::fs::read_to_string(&path).unwrap();
    assert_eq!(
        texts(&blessed),
        texts(&picture),
        "look at it, then bless it"
    );
}

/// Returns the texts between tags, in their order.
fn texts(svg: &str) -> Vec<&str> {
    svg.split('<')
        .filter_map(|piece| piece.split_once('>'))
        .map(|(_, text)| text.trim())
        .filter(|text| !text.is_empty())
        .collect()
}

/// Asserts that every tag is closed by its counterpart, and that `<`, `>` and `"` occur in markup only.
fn assert_well_formed(markup: &str) {
    const VOID: [&str; 3] = ["meta", "br", "!DOCTYPE"];
    let mut open = Vec::new();
    for piece in markup.split('<').skip(1) {
        let (tag, text) = piece
            .split_once('>')
            .unwrap_or_else(|| panic!("no end of <{piece}"));
        assert!(
            open.last() == Some(&"style") || !text.contains('>'),
            "stray > in {text:?}"
        );
        assert_eq!(tag.matches('"').count() % 2, 0, "odd quotes in <{tag}>");
        let name = tag.split_ascii_whitespace().next().unwrap_or_default();
        if let Some(name) = name.strip_prefix('/') {
            assert_eq!(open.pop(), Some(name), "</{name}> closes another tag");
        } else if !tag.ends_with('/') && !VOID.contains(&name) {
            open.push(name);
        }
    }
    assert!(open.is_empty(), "never closed: {open:?}");
}
