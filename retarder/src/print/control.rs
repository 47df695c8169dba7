//! Text of the closed loop.

use ecu::PressureSensor;
use hil_harness::checks::{Bound, Check, CheckId};
use hil_harness::operating_conditions::REFERENCE_TEMPERATURE_C;
use hil_harness::rigs::RigVerdict;
use hil_harness::{ConfirmedFault, Requirement, Verdict};
use recording::{Recording, Trace};

use super::chart::{Chart, Line};
use super::device;
use super::number::{significant, value};
use super::table::{Align, Entry, Table, painted};
use super::{Colour, Terminal, painted_paragraph, paragraph, title};
use crate::run::control::Controlled;

/// Returns the run, its verdict and its rigs.
pub(super) fn control(controlled: &Controlled, terminal: &Terminal) -> String {
    let mut text = head(controlled, terminal);
    text += "\n";
    text += &plots(&controlled.run.recording, terminal);
    text += "\n";
    if let Some(report) = &controlled.device {
        text += &device::report(report, terminal);
        text += "\n";
    }
    text += &requirements(&[controlled], terminal);
    if !controlled.rigs.is_empty() {
        text += "\n";
        text += &rigs(controlled, terminal);
    }
    text += "\n";
    text + &answer(controlled, None, terminal)
}

fn head(controlled: &Controlled, terminal: &Terminal) -> String {
    let scenario = &controlled.scenario.scenario;
    let mut text = title(
        &format!(
            "{}: {} on {}",
            scenario.name, controlled.scenario.controller, controlled.scenario.plant
        ),
        terminal,
    );
    let seconds = f64::from(scenario.duration_samples) * scenario.plant.ecu.sample_time_s;
    text += &paragraph(
        &format!(
            "{} samples, {seconds:.1} s from {} bar; sensor noise {} mbar rms, seed {}.",
            scenario.duration_samples,
            scenario.start_pressure_bar,
            scenario.sensor_noise_mbar_rms,
            scenario.seed
        ),
        terminal,
    );
    let conditions = controlled.scenario.conditions_text();
    if !conditions.is_empty() {
        text += &paragraph(&conditions, terminal);
    }
    text
}

/// Plots reference and chamber pressure, and the duty cycles below.
pub(super) fn plots(recording: &Recording, terminal: &Terminal) -> String {
    let Some(times) = recording.time_base_of("p_ch") else {
        return String::new();
    };
    let span_s = [times.start_s(), times.end_s()];
    let line = |name, signal: &str, colour, mark| {
        let trace = Trace::of(recording, signal)?;
        Some(Line {
            name,
            colour,
            mark,
            trace,
        })
    };
    let pressure = Chart {
        title: "pressure [bar gauge]",
        lines: [
            line("reference", "p_ref", Colour::Second, Some('×')),
            line("chamber", "p_ch", Colour::First, None),
        ]
        .into_iter()
        .flatten()
        .collect(),
        band: None,
        height: 12,
        span_s,
        at_least: Some([0.0, 1.0]),
    };
    // The vent valve lowers the pressure, so its duty cycle is drawn downwards.
    let vent = line("vent (downwards)", "duty_vent", Colour::Second, None).map(|line| Line {
        trace: line.trace.times(-1.0),
        ..line
    });
    let duty = Chart {
        title: "duty cycle [%]",
        lines: line("fill", "duty_fill", Colour::First, None)
            .into_iter()
            .chain(vent)
            .collect(),
        band: None,
        height: 7,
        span_s,
        at_least: Some([-100.0, 100.0]),
    };
    pressure.draw(terminal) + "\n" + &duty.draw(terminal)
}

/// Returns the requirements with the worst result of all runs.
pub(super) fn requirements(runs: &[&Controlled], terminal: &Terminal) -> String {
    let mut table = Table::new(
        [
            ("requirement", Align::Left),
            ("reached", Align::Right),
            ("limit", Align::Left),
            ("", Align::Left),
        ],
        terminal,
    );
    let requirement = runs.first().map_or(Requirement::THESIS, |run| {
        run.scenario.requirements.requirement
    });
    let required = match requirement == Requirement::THESIS {
        true => "Required by the thesis",
        false => "Required",
    };
    for (heading, is_binding) in [(required, true), ("Also looked at", false)] {
        table.heading(heading);
        for id in CheckId::ALL {
            let checks = runs
                .iter()
                .filter_map(|run| Some((*run, run.verdict.check(id)?)));
            let Some((run, check)) =
                checks.max_by(|(_, a), (_, b)| severity(a).total_cmp(&severity(b)))
            else {
                continue;
            };
            if check.binding != is_binding {
                continue;
            }
            let evidence = match runs {
                [_] => check.evidence.clone(),
                _ => format!("{}: {}", run.scenario.scenario.name, check.evidence),
            };
            table.row([
                in_short(id, &requirement).into(),
                check
                    .reached
                    .map_or_else(|| "never".to_owned(), |reached| significant(reached, 3))
                    .into(),
                limit(check).into(),
                word(check),
            ]);
            table.remark(&evidence);
        }
    }
    let mut text = table.to_string();
    for run in runs {
        text += &ecu_and_sensor(run, terminal);
    }
    if let Some(missing) = not_exercised(runs, &requirement) {
        text += &paragraph(
            &format!("Not exercised by this profile: {missing}."),
            terminal,
        );
    }
    text
}

/// Returns the faults that the ECU confirmed, and the error of the sensor if it is more than noise.
fn ecu_and_sensor(run: &Controlled, terminal: &Terminal) -> String {
    let mut text = String::new();
    let name = &run.scenario.scenario.name;
    if let Some(faults) = run.verdict.confirmed_faults.as_deref()
        && !faults.is_empty()
    {
        let faults: Vec<String> = faults
            .iter()
            .map(
                |ConfirmedFault {
                     fault,
                     first_s,
                     samples,
                 }| { format!("{fault} at {first_s:.2} s, for {samples} samples") },
            )
            .collect();
        let sentence = format!(
            "{name}: the ECU confirmed {}. docs/safety.md has the rule and the reaction of each fault.",
            faults.join("; ")
        );
        text += &painted_paragraph(Colour::Bad, &sentence, terminal);
    }
    if let Some(error) = run.verdict.sensor_error {
        let noise_bar = 1e-3 * run.scenario.scenario.sensor_noise_mbar_rms + SENSOR_STEP_BAR;
        let sentence = format!(
            "{name}: the sensor's error (measured minus true pressure) is {} bar on average, {} bar rms, {} bar at most; \
             the requirements are judged by the true pressure.",
            significant(error.mean_bar, 2),
            significant(error.rms_bar, 2),
            significant(error.largest_bar, 2),
        );
        if error.rms_bar > 2.0 * noise_bar {
            text += &painted_paragraph(Colour::Notice, &sentence, terminal);
        }
    }
    if let Some(plunger) = run.verdict.plunger {
        let sentence = format!(
            "{name}: after a step, the plunger of the regulating valve breaks free {} times on average; at one reference, its \
             rest positions differ by up to {} mm, {} % of its travel, by its friction and the tolerance of the pressure.",
            significant(plunger.starts_per_step, 2),
            significant(plunger.rest_spread_mm, 2),
            significant(100.0 * plunger.rest_spread_share, 2),
        );
        text += &paragraph(&sentence, terminal);
    }
    text
}

/// Step of the pressure sensor's code (bar).
const SENSOR_STEP_BAR: f64 = PressureSensor::STEP_PA as f64 * 1e-5;

/// Returns the result divided by its limit; a check that never passed is the worst.
fn severity(check: &Check) -> f64 {
    check.reached.map_or(f64::INFINITY, |reached| {
        if check.limit > 0.0 {
            reached / check.limit
        } else {
            reached
        }
    })
}

/// Returns the requirement in a few words; the JSON has the full text.
fn in_short(id: CheckId, requirement: &Requirement) -> String {
    let Requirement {
        operating_range_psup: [low, high],
        fill_to_psup,
        vent_from_psup,
        vent_to_psup,
        p_tol_bar,
        ..
    } = *requirement;
    match id {
        CheckId::SettlingTime => format!("reach {low} to {high} p_sup, stay"),
        CheckId::SettlingTimeBeyondOperatingRange => "reach what is beyond, stay".to_owned(),
        CheckId::SteadyError => "error after T_req".to_owned(),
        CheckId::Overshoot => "overshoot".to_owned(),
        CheckId::FillTime => format!("fill 0 to {fill_to_psup} p_sup, ±{p_tol_bar} bar"),
        CheckId::FillTimeWithDeadTime => "fill, with dead time".to_owned(),
        CheckId::FillTimeToLevel => format!("fill 0 to {fill_to_psup} p_sup itself"),
        CheckId::FillTimeToLevelWithDeadTime => "fill itself, with dead time".to_owned(),
        CheckId::VentTime => {
            format!("vent {vent_from_psup} to {vent_to_psup} p_sup, ±{p_tol_bar} bar")
        }
        CheckId::VentTimeWithDeadTime => "vent, with dead time".to_owned(),
        CheckId::VentTimeToLevel => format!("vent {vent_from_psup} to {vent_to_psup} p_sup itself"),
        CheckId::VentTimeToLevelWithDeadTime => "vent itself, with dead time".to_owned(),
        CheckId::NeverBothValves => "both valves energised".to_owned(),
        CheckId::DutyLimits => "duty outside its limits".to_owned(),
        CheckId::RestActuations => "valve lifts in 1 s at rest".to_owned(),
        CheckId::Lifts => "valve lifts per second".to_owned(),
    }
}

/// Returns whether the check is another reading of a passage that is already listed.
fn is_secondary_reading(id: CheckId) -> bool {
    matches!(
        id,
        CheckId::FillTimeWithDeadTime
            | CheckId::FillTimeToLevel
            | CheckId::FillTimeToLevelWithDeadTime
            | CheckId::VentTimeWithDeadTime
            | CheckId::VentTimeToLevel
            | CheckId::VentTimeToLevelWithDeadTime
    )
}

/// Returns the sentence about checks that no run exercises.
fn not_exercised(runs: &[&Controlled], requirement: &Requirement) -> Option<String> {
    let names: Vec<String> = CheckId::ALL
        .into_iter()
        .filter(|id| {
            runs.iter()
                .all(|run| run.verdict.not_exercised.contains(id))
        })
        .filter(|id| !is_secondary_reading(*id))
        .map(|id| in_short(id, requirement))
        .collect();
    (!names.is_empty()).then(|| names.join("; "))
}

fn limit(check: &Check) -> String {
    let relation = match check.bound {
        Bound::AtMost => "≤",
        Bound::LessThan => "<",
    };
    format!("{relation} {} {}", value(check.limit), check.unit)
}

fn word(check: &Check) -> Entry {
    match (check.holds, check.binding) {
        (true, _) => painted(Colour::Good, "pass"),
        (false, true) => painted(Colour::Bad, "FAIL"),
        (false, false) => painted(Colour::Notice, "beyond"),
    }
}

/// Returns the ranges of the operating conditions that differ from rig to rig.
fn scattered_conditions(controlled: &Controlled, terminal: &Terminal) -> String {
    let range = |of: fn(&RigVerdict) -> Option<f64>| {
        let values = controlled.rigs.iter().filter_map(of);
        let [low, high] = [f64::INFINITY, f64::NEG_INFINITY];
        values.fold([low, high], |[low, high], value| {
            [low.min(value), high.max(value)]
        })
    };
    let [volt_min, volt_max] = range(|rig| rig.supply_voltage_v);
    let [celsius_min, celsius_max] = range(|rig| rig.coil_temperature_c);
    let conditions = controlled.scenario.conditions;
    let has_coil = volt_min <= volt_max;
    if !has_coil || conditions.supply.is_some() && conditions.coil_temperature_c.is_some() {
        return String::new();
    }
    let bench_v = controlled.scenario.scenario.plant.ecu.supply_voltage_v;
    paragraph(
        &format!(
            "Supply voltage {volt_min:.1} to {volt_max:.1} V, coils at {celsius_min:.0} to {celsius_max:.0} °C; \
             `--supply-voltage {bench_v} --coil-temperature {REFERENCE_TEMPERATURE_C}` gives every rig the conditions of \
             the bench."
        ),
        terminal,
    )
}

/// Returns the results of the checks over all rigs.
fn rigs(controlled: &Controlled, terminal: &Terminal) -> String {
    let count = controlled.rigs.len();
    let mut text = title(&format!("{count} rigs scattered about the plant"), terminal);
    text += &scattered_conditions(controlled, terminal);
    let mut table = Table::new(
        [
            ("worst of a rig", Align::Left),
            ("median", Align::Right),
            ("90 %", Align::Right),
            ("all", Align::Right),
            ("limit", Align::Left),
            ("pass", Align::Right),
        ],
        terminal,
    );
    for id in CheckId::ALL {
        let checks: Vec<&Check> = controlled
            .rigs
            .iter()
            .filter_map(|rig| rig.verdict.check(id))
            .collect();
        let Some(first) = checks.first() else {
            continue;
        };
        let mut reached: Vec<f64> = checks
            .iter()
            .map(|check| check.reached.unwrap_or(f64::INFINITY))
            .collect();
        reached.sort_by(f64::total_cmp);
        let quantile = |share: f64| {
            let reached = reached[(share * (reached.len() - 1) as f64).round() as usize];
            if reached.is_finite() {
                significant(reached, 3)
            } else {
                "never".to_owned()
            }
        };
        let holding = checks.iter().filter(|check| check.holds).count();
        let colour = match (holding == checks.len(), first.binding) {
            (true, _) => Colour::Good,
            (false, true) => Colour::Bad,
            (false, false) => Colour::Notice,
        };
        table.row([
            in_short(id, &controlled.scenario.requirements.requirement).into(),
            quantile(0.5).into(),
            quantile(0.9).into(),
            quantile(1.0).into(),
            limit(first).into(),
            painted(colour, format!("{holding} of {}", checks.len())),
        ]);
    }
    text += &table.to_string();
    if let Some(rig) = controlled.rigs.iter().find(|rig| !rig.verdict.holds) {
        text += &paragraph(
            &format!(
                "Rig {} (seed {}) is the first that fails{}{}.",
                rig.rig,
                rig.seed,
                match rig.supply_voltage_v.zip(rig.coil_temperature_c) {
                    Some((volt, celsius)) => format!(": {volt:.1} V, coils at {celsius:.0} °C"),
                    None => String::new(),
                },
                match faults_of(&rig.verdict).as_str() {
                    "" => String::new(),
                    faults => format!("; the ECU confirmed {faults}"),
                }
            ),
            terminal,
        );
    }
    let with_fault = controlled
        .rigs
        .iter()
        .filter(|rig| !faults_of(&rig.verdict).is_empty());
    let with_fault = with_fault.count();
    if with_fault > 0 {
        text += &paragraph(
            &format!("The ECU confirmed a fault on {with_fault} of {count} rigs."),
            terminal,
        );
    }
    text
}

/// Returns the names of the confirmed faults; empty if there are none.
fn faults_of(verdict: &Verdict) -> String {
    let faults = verdict.confirmed_faults.as_deref().unwrap_or_default();
    let names: Vec<&str> = faults.iter().map(|fault| fault.fault.as_str()).collect();
    names.join(", ")
}

/// Returns the verdict as a sentence; with several runs it begins with the name of the run.
pub(super) fn answer(controlled: &Controlled, name: Option<&str>, terminal: &Terminal) -> String {
    let mut sentence = name.map(|name| format!("{name}: ")).unwrap_or_default()
        + &sentence(
            &controlled.verdict,
            &controlled.scenario.requirements.requirement,
        );
    if !controlled.rigs.is_empty() {
        sentence += &format!(
            " {} of {} rigs meet every binding requirement.",
            controlled.rigs_that_hold(),
            controlled.rigs.len()
        );
    }
    let colour = if controlled.holds() {
        Colour::Good
    } else {
        Colour::Bad
    };
    painted_paragraph(colour, &sentence, terminal)
}

fn sentence(verdict: &Verdict, requirement: &Requirement) -> String {
    let failing: Vec<String> = verdict
        .checks
        .iter()
        .filter(|check| check.binding && !check.holds)
        .map(|check| in_short(check.id, requirement))
        .collect();
    if verdict.holds {
        "The loop meets every binding requirement.".to_owned()
    } else if verdict.steps.is_empty() {
        "No verdict: no step of the reference lasts T_req, so no requirement was checked."
            .to_owned()
    } else {
        let faults = match faults_of(verdict).as_str() {
            "" => String::new(),
            faults => format!(" The ECU confirmed {faults}."),
        };
        format!("The loop fails: {}.{faults}", failing.join(", "))
    }
}
