//! Text of a table of rigs.

use std::cmp::Reverse;
use std::collections::BTreeMap;

use hil_harness::monte_carlo::{COLUMNS, RigRow, Summary};

use super::number::significant;
use super::table::{Align, Table};
use super::{Colour, Terminal, painted_paragraph, paragraph, title};
use crate::run::monte_carlo::{Cost, RigTable};

/// Returns the summary of the table.
pub(super) fn rig_table(table: &RigTable, terminal: &Terminal) -> String {
    let RigTable {
        summary,
        out,
        batch,
    } = table;
    let rigs = counted(summary.rigs, "rig");
    let mut text = match batch {
        Some(batch) => title(&format!("{rigs} of {}", batch.title), terminal),
        None => title(&format!("{rigs}, merged"), terminal),
    };
    let written = format!("\nWritten: {}", out.display());
    if summary.rigs == 0 {
        text += &paragraph("No rigs: the batch has fewer rigs than shards.", terminal);
        return text + &written;
    }
    text += &conditions(summary, terminal);
    text += "\n";
    text += &figures(summary, terminal);
    if let Some(shares) = shares("Failed", &summary.failed_checks, summary.rigs) {
        text += &paragraph(&shares, terminal);
    }
    if let Some(shares) = shares("Confirmed faults", &summary.confirmed_faults, summary.rigs) {
        text += &paragraph(&shares, terminal);
    }
    if let Some(worst) = &summary.worst {
        text += &paragraph(&worst_rig(worst), terminal);
        // A command is one line, however long.
        text += &match batch {
            Some(batch) => format!("Repeat it:\n  {} --rig {}\n", batch.command, worst.rig),
            None => paragraph(
                &format!(
                    "Repeat it with the command of its shard, and `--rig {}` in place of --rigs, --rigs-out and --shard.",
                    worst.rig
                ),
                terminal,
            ),
        };
    }
    if let Some(batch) = batch {
        text += &paragraph(&cost(&batch.cost), terminal);
    }
    let colour = match summary.holds() {
        true => Colour::Good,
        false => Colour::Bad,
    };
    let answer = format!(
        "{} of {rigs} meet every binding requirement.",
        summary.rigs_that_hold
    );
    text += "\n";
    text += &painted_paragraph(colour, &answer, terminal);
    text + &written
}

fn counted(count: u32, what: &str) -> String {
    match count {
        1 => format!("1 {what}"),
        _ => format!("{count} {what}s"),
    }
}

fn conditions(summary: &Summary, terminal: &Terminal) -> String {
    let of = |name| summary.conditions.get(name);
    match of("supply_voltage_v").zip(of("coil_temperature_c")) {
        Some((volt, celsius)) => paragraph(
            &format!(
                "Supply voltage {:.1} to {:.1} V, coils at {:.0} to {:.0} °C.",
                volt.low, volt.high, celsius.low, celsius.high
            ),
            terminal,
        ),
        None => String::new(),
    }
}

/// Returns mean and worst of each figure, and the distribution of the slowest steps.
fn figures(summary: &Summary, terminal: &Terminal) -> String {
    let mut table = Table::new(
        [
            ("figure of a rig", Align::Left),
            ("mean", Align::Right),
            ("worst", Align::Right),
            ("unit", Align::Left),
            ("worst rig", Align::Right),
            ("rigs", Align::Right),
        ],
        terminal,
    );
    for column in &COLUMNS {
        let Some(figure) = summary.figures.get(column.name) else {
            continue;
        };
        table.row([
            column.name.into(),
            significant(figure.mean, 3).into(),
            significant(figure.worst, 3).into(),
            column.unit.into(),
            figure.worst_rig.to_string().into(),
            figure.rigs.to_string().into(),
        ]);
    }
    let quantile = |share| match summary.settling_quantile(share) {
        Some(samples) => samples.to_string(),
        None => "never".to_owned(),
    };
    let sentence = format!(
        "Slowest step of a rig, in samples: median {}, 90 % {}, 99 % {}, all {}.",
        quantile(0.5),
        quantile(0.9),
        quantile(0.99),
        quantile(1.0)
    );
    let sentence = match summary.settling_worst_samples.is_empty() {
        true => String::new(),
        false => paragraph(&sentence, terminal),
    };
    table.to_string() + &sentence
}

/// Returns the share of the rigs of each name, the largest first; `None` if there are no names.
fn shares(what: &str, counts: &BTreeMap<String, u32>, rigs: u32) -> Option<String> {
    let mut counts: Vec<(&String, u32)> =
        counts.iter().map(|(name, &count)| (name, count)).collect();
    counts.sort_by_key(|&(_, count)| Reverse(count));
    let share = |count| significant(100.0 * f64::from(count) / f64::from(rigs), 3);
    let shares: Vec<String> = counts
        .iter()
        .map(|&(name, count)| format!("{name} on {} ({} %)", counted(count, "rig"), share(count)))
        .collect();
    (!shares.is_empty()).then(|| format!("{what}: {}.", shares.join(", ")))
}

/// Returns the worst rig in a sentence.
fn worst_rig(worst: &RigRow) -> String {
    let RigRow { rig, seed, .. } = worst;
    let mut text = format!("Worst: rig {rig} (seed {seed})");
    if let Some((volt, celsius)) = worst.supply_voltage_v.zip(worst.coil_temperature_c) {
        text += &format!(", {volt:.1} V, coils at {celsius:.0} °C");
    }
    text += &format!(
        ": {} of {} late",
        worst.late_steps,
        counted(worst.steps, "step")
    );
    if !worst.failed_checks.is_empty() {
        text += &format!("; fails {}", worst.failed_checks.replace(',', ", "));
    }
    if !worst.confirmed_faults.is_empty() {
        text += &format!(
            "; the ECU confirmed {}",
            worst.confirmed_faults.replace(',', ", ")
        );
    }
    text + "."
}

fn cost(cost: &Cost) -> String {
    if cost.rigs == 0 {
        return "No rig was run: all were finished before.".to_owned();
    }
    let speed = cost.rig_seconds_per_s();
    format!(
        "{} of {:.1} s in {} s on {}: {:.0} rig-seconds per second, {:.0} per thread.",
        counted(cost.rigs, "rig"),
        cost.rig_s,
        significant(cost.elapsed_s, 3),
        match cost.jobs.get() {
            1 => "1 thread".to_owned(),
            jobs => format!("{jobs} threads"),
        },
        speed,
        speed / cost.jobs.get() as f64
    )
}
