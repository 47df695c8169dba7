//! Text of the diagnosis: the missing physical effect, and the decrease of the error with it.

use std::collections::BTreeMap;

use model_lab::diagnosis::result::{
    Candidate, Cost, DetectionLimit, Diagnosis, FittedParameter, FoundClock, FoundStart, Horizon,
    NuisanceValue, Regime, Step, StepKind, Verdict,
};
use model_lab::result::{LogDefects, NotCompared, Warning};
use plant_sim::parameters::LagOf;

use super::comparison::warnings;
use super::number::{percent, significant};
use super::table::{Align, Entry, Table, bar, painted};
use super::{Colour, Terminal, painted_paragraph, paragraph, title};
use crate::run::diagnose::{Diagnosed, RefinedPlant};
use crate::targets::Targets;
use report::{SmallUnit, pressure_first, unit_of};

/// Width of the longest bar of the error steps (characters).
const BAR: usize = 24;

/// Returns the whole diagnosis, the answer first.
pub(super) fn diagnosis(diagnosed: &Diagnosed, targets: &Targets, terminal: &Terminal) -> String {
    let found = &diagnosed.diagnosis;
    let plant = &diagnosed.task.plant.name;
    let mut text = title(&headline(plant, &found.logs, &found.check), terminal);
    text += &painted_paragraph(
        colour_of(found.verdict),
        &capital(&found.sentence),
        terminal,
    );
    for candidate in named(found) {
        text += &paragraph(
            &format!("{}: {}", candidate.effect, candidate.physics),
            terminal,
        );
    }
    text += &doubted(&found.warnings, terminal);
    text += &excluded(&found.not_compared, terminal);
    text += &defects(&found.defects, terminal);
    text += &conditions(&found.clocks, &found.starts, terminal);
    text += &lag(found.lag_of.as_deref(), terminal);
    text += "\n";
    text += &error_steps(&found.error_steps, found.horizon, terminal);
    text += "\n";
    text += &candidates(found, terminal);
    text += "\n";
    text += &limits(found, terminal);
    text += "\n";
    text += &neighbours(found, terminal);
    text += &nuisance(&found.nuisance, terminal);
    text += &location(found, terminal);
    for sentence in &found.remaining.sentences {
        text += &paragraph(&format!("Unexplained residual: {sentence}."), terminal);
    }
    text += "\n";
    text += &painted_paragraph(Colour::Faint, &cost(&found.cost), terminal);
    let written = targets.plant.as_deref();
    let next = written.map_or_else(
        || diagnosed.next_command(),
        |plant| diagnosed.adding_flow(plant),
    );
    if let Some(next) = next {
        text += &format!("\nNext:\n  {}    # {}\n", next.command, next.purpose);
    }
    text
}

/// Returns the summary of a refined plant.
pub(super) fn refinement(refined: &RefinedPlant, terminal: &Terminal) -> String {
    let found = &refined.refined.refinement;
    let plant = &refined.task.plant.name;
    let mut text = title(&headline(plant, &found.logs, &found.check), terminal);
    text += &paragraph(&(capital(&found.sentence) + "."), terminal);
    text += &doubted(&found.warnings, terminal);
    text += &excluded(&found.not_compared, terminal);
    text += &defects(&found.defects, terminal);
    text += "\n";
    text += &error_steps(&found.error_steps, Horizon::OneStepAhead, terminal);
    text += "\n";
    let mut table = Table::new(
        [
            ("effect", Align::Left),
            ("fitted", Align::Right),
            ("95 % interval", Align::Left),
            ("unit", Align::Left),
            ("", Align::Left),
        ],
        terminal,
    );
    for effect in &found.effects {
        table.heading(&format!("{}, {}", effect.effect, effect.variant));
        for parameter in &effect.parameters {
            table.row([
                format!("  {}", parameter.key).into(),
                significant(parameter.value, 4).into(),
                interval(parameter).into(),
                parameter.unit.as_str().into(),
                bound(parameter),
            ]);
        }
        table.remark(&format!("{}.", capital(&effect.plausibility)));
    }
    text += &table.to_string();
    text += "\n";
    text += &nuisance(&found.nuisance, terminal);
    text + &painted_paragraph(Colour::Faint, &cost(&found.cost), terminal)
}

/// Returns the clocks of the loggers and the states at the start, one sentence each.
pub(super) fn conditions<'a>(
    clocks: impl IntoIterator<Item = &'a FoundClock>,
    starts: impl IntoIterator<Item = &'a FoundStart>,
    terminal: &Terminal,
) -> String {
    let of_clock = |clock: &FoundClock| format!("{}: {}.", clock.log, clock.statement);
    let of_start = |start: &FoundStart| format!("{}: {}.", start.log, start.statement);
    let warm = starts.into_iter().filter(|start| start.is_warm());
    let sentences = clocks.into_iter().map(of_clock).chain(warm.map(of_start));
    sentences
        .map(|sentence| painted_paragraph(Colour::Faint, &sentence, terminal))
        .collect()
}

/// Returns the part of the proportional valves that lags according to the logs; empty where the plant file states it.
fn lag(found: Option<&str>, terminal: &Terminal) -> String {
    let lag_of = found.and_then(LagOf::of_word);
    lag_of.map_or_else(String::new, |lag_of| {
        let (statement, word) = (lag_of.statement(), lag_of.word());
        let sentence =
            format!("Proportional valves: {statement} (`lag_of = \"{word}\"`); found in the logs.");
        painted_paragraph(Colour::Faint, &sentence, terminal)
    })
}

/// Returns the gaps and missing cells of each log.
pub(super) fn defects(found: &BTreeMap<String, LogDefects>, terminal: &Terminal) -> String {
    let sentences = found.iter().flat_map(|(log, defects)| {
        let sentences = defects.sentences.iter();
        sentences.map(move |sentence| format!("{log}: {sentence}."))
    });
    sentences
        .map(|sentence| painted_paragraph(Colour::Notice, &sentence, terminal))
        .collect()
}

/// Returns the warnings about columns that are probably declared wrongly.
fn doubted(of_logs: &BTreeMap<String, Vec<Warning>>, terminal: &Terminal) -> String {
    let of_log = |(log, found): (&String, &Vec<Warning>)| {
        let mut found = found.clone();
        for warning in &mut found {
            warning.statement.insert_str(0, &format!("{log}: "));
        }
        warnings(&found, terminal)
    };
    of_logs.iter().map(of_log).collect()
}

/// Returns the data that the fit excluded, with the reason.
pub(super) fn excluded(
    of_logs: &BTreeMap<String, Vec<NotCompared>>,
    terminal: &Terminal,
) -> String {
    let all = of_logs
        .iter()
        .flat_map(|(log, signals)| signals.iter().map(move |signal| (log, signal)));
    all.map(|(log, NotCompared { name, reason })| {
        let sentence = format!("{name} of {log} is excluded from the fit: {reason}.");
        painted_paragraph(Colour::Notice, &sentence, terminal)
    })
    .collect()
}

pub(super) fn headline(plant: &str, logs: &[String], check: &[String]) -> String {
    let judged = if check.is_empty() {
        "blocks of the log".to_owned()
    } else {
        check.join(", ")
    };
    format!(
        "{plant} compared with {}; validation: {judged}",
        logs.join(", ")
    )
}

fn colour_of(verdict: Verdict) -> Colour {
    match verdict {
        Verdict::Adequate | Verdict::Found => Colour::Good,
        Verdict::FormWrong | Verdict::PlantFileWrong => Colour::Notice,
        Verdict::NotInLibrary => Colour::Bad,
    }
}

fn named(found: &Diagnosis) -> impl Iterator<Item = &Candidate> {
    found
        .effects
        .iter()
        .filter_map(|id| found.candidates.iter().find(|one| one.effect == *id))
}

/// Returns the error steps: one falling bar per signal and step.
fn error_steps(steps: &[Step], horizon: Horizon, terminal: &Terminal) -> String {
    let (free_run, rms) = match horizon {
        Horizon::OneStepAhead => (
            "free run",
            "one-step-ahead prediction; free run: driven by the commands alone",
        ),
        Horizon::FreeRun => (
            "",
            "free-run simulation, driven by the commands alone, in which the errors of all pulses add up",
        ),
    };
    let mut table = Table::new(
        [
            ("How the error falls", Align::Left),
            ("×noise", Align::Right),
            ("", Align::Left),
            ("rms", Align::Right),
            ("floor", Align::Right),
            ("unit", Align::Left),
            (free_run, Align::Right),
        ],
        terminal,
    );
    let longest = steps.iter().map(Step::worst_in_noise).fold(1.0, f64::max);
    for step in steps {
        table.heading(&step_name(step));
        for (signal, rms) in pressure_first(&step.check_rms) {
            let unit = SmallUnit::of_errors_in(unit_of(signal));
            let scaled = |value: f64| significant(value * unit.per_unit, 3);
            let times = step.in_noise(signal);
            let colour = if times > 1.5 {
                Colour::Notice
            } else {
                Colour::Good
            };
            let free = step.free_run_check_rms.get(signal).copied();
            let free = free.filter(|_| horizon == Horizon::OneStepAhead);
            table.row([
                format!("  {signal}").into(),
                format!("{times:.2}").into(),
                painted(colour, bar(times / longest, BAR)),
                scaled(rms).into(),
                scaled(step.noise_floor[signal]).into(),
                unit.symbol.into(),
                free.map_or_else(String::new, scaled).into(),
            ]);
        }
    }
    let explanation = format!(
        "On the validation data. ×noise: error divided by the noise floor; 1.0 is a perfect model. rms: {rms}."
    );
    table.to_string() + &painted_paragraph(Colour::Faint, &explanation, terminal)
}

/// Returns the name of an error step in words.
fn step_name(step: &Step) -> String {
    match step.kind {
        StepKind::EffectAdded => {
            let explained = percent(step.explained_share);
            format!("{}: {explained} explained", step.name())
        }
        _ => step.name(),
    }
}

/// Returns the effects that explain part of the error, ranked.
fn candidates(found: &Diagnosis, terminal: &Terminal) -> String {
    let mut table = Table::new(
        [
            ("candidate", Align::Left),
            ("explains", Align::Right),
            ("fitted (95 % interval)", Align::Left),
            ("", Align::Left),
        ],
        terminal,
    );
    for candidate in found.contenders() {
        let name = format!("{} ({})", candidate.effect, candidate.variant);
        let name: Entry = if found.effects.contains(&candidate.effect) {
            painted(Colour::Title, name)
        } else {
            name.into()
        };
        let fitted: Vec<String> = candidate.parameters.iter().map(fitted).collect();
        table.row([
            name,
            percent(candidate.explained_share.max(0.0)).into(),
            fitted.join("\n").into(),
            plausibility(candidate),
        ]);
    }
    let left_out = found.candidates.len() - found.contenders().count();
    let explanation = format!(
        "explains: share of the plain model's excess error, each effect alone, everything refitted. \
         The other {left_out} effects of the library explain less than 5 %."
    );
    table.to_string() + &painted_paragraph(Colour::Faint, &explanation, terminal)
}

/// Returns the detection limit of each effect.
fn limits(found: &Diagnosis, terminal: &Terminal) -> String {
    let mut table = Table::new(
        [
            ("detection limit", Align::Left),
            ("at", Align::Right),
            ("", Align::Left),
        ],
        terminal,
    );
    let mut not_excited = Vec::new();
    for candidate in &found.candidates {
        match &candidate.detection_limit {
            DetectionLimit::Size { key, value, .. } => table.row([
                candidate.effect.as_str().into(),
                format!("{} {}", beyond(candidate), significant(*value, 2)).into(),
                painted(Colour::Faint, key),
            ]),
            DetectionLimit::NotExcited { test_signal } => {
                not_excited.push((candidate.effect.as_str(), test_signal));
            }
        }
    }
    let mut text = table.to_string();
    if !not_excited.is_empty() && !found.not_compared.is_empty() {
        let caution = "A log may contain the following already: a signal that is excluded from the fit (above) shows nothing.";
        text += &painted_paragraph(Colour::Notice, caution, terminal);
    }
    for (id, test_signal) in not_excited {
        let sentence = format!("Not excited: {id}. To see it: {test_signal}.");
        text += &painted_paragraph(Colour::Notice, &sentence, terminal);
    }
    text
}

/// Returns the relation sign: an effect is detected on this side of its detection limit.
fn beyond(candidate: &Candidate) -> char {
    if candidate.is_stronger_below() {
        '≤'
    } else {
        '≥'
    }
}

fn fitted(parameter: &FittedParameter) -> String {
    format!(
        "{} = {} ({})",
        parameter.key,
        significant(parameter.value, 3),
        interval(parameter)
    )
}

fn interval(parameter: &FittedParameter) -> String {
    format!(
        "{} to {}",
        significant(parameter.low, 3),
        significant(parameter.high, 3)
    )
}

fn bound(parameter: &FittedParameter) -> Entry {
    if parameter.at_bound {
        painted(Colour::Notice, "at its limit")
    } else {
        String::new().into()
    }
}

/// Returns the first word of the plausibility; the JSON and the report have the full text.
fn plausibility(candidate: &Candidate) -> Entry {
    let word = candidate.plausibility.split(':').next().unwrap_or_default();
    let colour = match word {
        "plausible" => Colour::Good,
        _ => Colour::Notice,
    };
    painted(colour, word)
}

/// Returns the effects that can be confused with the named ones.
fn neighbours(found: &Diagnosis, terminal: &Terminal) -> String {
    let sentences = found.alternatives();
    let paragraphs = sentences.iter().map(|one| paragraph(one, terminal));
    paragraphs.collect()
}

/// Returns the parameters that left their tolerance, or the sentence that none did.
fn nuisance(values: &[NuisanceValue], terminal: &Terminal) -> String {
    let alarms: Vec<&NuisanceValue> = values
        .iter()
        .filter(|value| value.alarm.is_some())
        .collect();
    if alarms.is_empty() {
        let sentence = format!(
            "{} ordinary parameters were refitted; all are within their tolerances.",
            values.len()
        );
        return paragraph(&sentence, terminal);
    }
    alarms
        .into_iter()
        .map(|value| {
            let sentence = format!(
                "{} = {} {} (plant file {}, allowed ±{}, plain model {}): {}.",
                value.name,
                significant(value.fitted, 3),
                value.unit,
                significant(value.datasheet, 3),
                significant(value.tolerance, 2),
                significant(value.plain, 3),
                value.alarm.as_deref().unwrap_or_default()
            );
            painted_paragraph(Colour::Notice, &sentence, terminal)
        })
        .collect()
}

/// Returns the regimes with the excess error, before and after.
fn location(found: &Diagnosis, terminal: &Terminal) -> String {
    let placed = |regimes: &[Regime]| -> Vec<String> {
        let placed = regimes.iter().filter(|regime| regime.regime.is_some());
        placed
            .map(|regime| format!("{}, {}: {}", regime.log, regime.signal, regime.sentence))
            .collect()
    };
    let mut text = String::new();
    for sentence in &found.location.of_compare {
        text += &paragraph(&format!("{sentence}."), terminal);
    }
    for sentence in placed(&found.location.before) {
        text += &paragraph(&format!("Refitted: {sentence}."), terminal);
    }
    if !found.effects.is_empty() {
        let after = placed(&found.location.after);
        if let (true, Some(last)) = (after.is_empty(), found.error_steps.last()) {
            let left = format!(
                "With the named effects: {:.2} times the noise is left, in no particular regime.",
                last.worst_in_noise()
            );
            text += &paragraph(&left, terminal);
        }
        for sentence in after {
            text += &paragraph(&format!("With the named effects: {sentence}."), terminal);
        }
    }
    text
}

pub(super) fn cost(cost: &Cost) -> String {
    let real_time = cost.log_s / (1e-3 * cost.per_simulation_ms);
    format!(
        "{} simulations of {} s of log in {} s; one takes {} ms, {} times real time.",
        cost.simulations,
        significant(cost.log_s, 3),
        significant(cost.elapsed_s, 3),
        significant(cost.per_simulation_ms, 3),
        significant(real_time, 2),
    )
}

fn capital(sentence: &str) -> String {
    report::capitalised(sentence)
}

#[cfg(test)]
mod tests {
    use super::*;

    const EXAMPLE: &str = include_str!(concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../docs/schema/diagnosis.example.json"
    ));

    /// Defect seen: the sentence "Nearest, in standard deviations of the noise: ." with an empty list.
    #[test]
    fn an_effect_without_a_neighbour_has_no_empty_list_of_them() {
        let mut found: Diagnosis = serde_json::from_str(EXAMPLE).unwrap();
        let mut text = |nearest: &[(&str, f64)]| {
            let nearest = nearest.iter().map(|(id, far)| ((*id).to_owned(), *far));
            found.distinguishability = [("chamber_leak".to_owned(), nearest.collect())].into();
            let terminal = Terminal {
                width: 100,
                is_coloured: false,
            };
            let text = neighbours(&found, &terminal);
            text.split_whitespace().collect::<Vec<_>>().join(" ")
        };
        let (list, none) = ("Nearest, in standard", "No other effect explains anything.");
        let with = text(&[("dead_volume", 7.5)]);
        assert!(with.contains(list) && with.contains("dead volume 7.5") && !with.contains(none));
        let without = text(&[]);
        assert!(
            !without.contains(list) && without.contains(none),
            "{without}"
        );
    }

    /// Defect seen: "no excess error is left" stood beside an unexplained residual of 1.1 times the noise.
    #[test]
    fn what_the_named_effects_leave_is_said_in_noise_floors() {
        let mut found: Diagnosis = serde_json::from_str(EXAMPLE).unwrap();
        found.location.after.clear();
        let terminal = Terminal {
            width: 200,
            is_coloured: false,
        };
        let floors = found.error_steps.last().unwrap().worst_in_noise();
        let expected = format!("With the named effects: {floors:.2} times the noise is left");
        let text = location(&found, &terminal);
        assert!(text.contains(&expected), "{text}");
    }
}
