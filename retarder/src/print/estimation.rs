//! Table of estimated parameters.

use model_lab::diagnosis::{Determination, EstimatedParameter};

use super::diagnosis::{conditions, cost, defects, excluded, headline};
use super::number::significant;
use super::table::{Align, Table, painted};
use super::{Colour, Terminal, painted_paragraph, paragraph, title};
use crate::run::diagnose::EstimatedPlant;
use crate::targets::Targets;

/// Returns the errors before and after, and all parameters.
pub(super) fn estimation(
    estimated: &EstimatedPlant,
    targets: &Targets,
    terminal: &Terminal,
) -> String {
    let found = &estimated.estimated.estimation;
    let plant = &estimated.task.plant.name;
    let mut text = title(&headline(plant, &found.logs, &found.check), terminal);
    text += &paragraph(&(report::capitalised(&found.sentence) + "."), terminal);
    text += &excluded(&found.not_compared, terminal);
    text += &defects(&found.defects, terminal);
    text += &conditions(&found.clocks, &found.starts, terminal);
    text += "\n";
    text += &errors(estimated, terminal);
    text += "\n";
    text += &parameters(&found.parameters, found.is_adequate, terminal);
    if !found.explains_fitted_logs {
        text += &paragraph(
            "Estimate again once the missing effect is in the plant file: until then its error widens the intervals.",
            terminal,
        );
    }
    text += "\n";
    text += &painted_paragraph(Colour::Faint, &cost(&found.cost), terminal);
    if let Some(plant) = &targets.plant {
        text += "\nNext:\n";
        for (command, reason) in estimated.next_commands(plant) {
            text += &format!("  {command}    # {reason}\n");
        }
    }
    text
}

fn errors(estimated: &EstimatedPlant, terminal: &Terminal) -> String {
    let columns = [
        ("error / noise floor", Align::Left),
        ("training", Align::Right),
        ("validation", Align::Right),
        ("free run", Align::Right),
    ];
    let mut table = Table::new(columns, terminal);
    for step in &estimated.estimated.estimation.steps {
        table.heading(step.kind.name());
        for (signal, floor) in &step.noise_floor {
            let over = |rms: Option<&f64>| {
                rms.map_or_else(|| "-".to_owned(), |rms| format!("{:.2}", rms / floor))
            };
            table.row([
                format!("  {signal}").into(),
                over(step.fit_rms.get(signal)).into(),
                over(step.check_rms.get(signal)).into(),
                over(step.free_run_check_rms.get(signal)).into(),
            ]);
        }
    }
    table.to_string()
}

fn parameters(parameters: &[EstimatedParameter], is_adequate: bool, terminal: &Terminal) -> String {
    let columns = [
        ("parameter", Align::Left),
        ("before", Align::Right),
        ("after", Align::Right),
        ("95 % interval", Align::Left),
        ("unit", Align::Left),
        ("", Align::Left),
    ];
    let mut table = Table::new(columns, terminal);
    for parameter in parameters {
        let (colour, word) = match &parameter.determination {
            Determination::Determined => (Colour::Good, "determined"),
            Determination::OnlyTogetherWith { .. } => (Colour::Notice, "only with others"),
            Determination::NotExcited => (Colour::Faint, "not excited"),
            Determination::AtLimit => (Colour::Bad, "AT LIMIT"),
        };
        table.row([
            parameter.name.as_str().into(),
            significant(parameter.before, 4).into(),
            significant(parameter.after, 4).into(),
            format!(
                "{} to {}",
                significant(parameter.low, 3),
                significant(parameter.high, 3)
            )
            .into(),
            parameter.unit.as_str().into(),
            painted(colour, word),
        ]);
        for remark in remarks(parameter, is_adequate) {
            table.remark(&remark);
        }
    }
    table.to_string()
}

/// Returns the remarks about a value. If an effect is missing, another log would not determine the parameter.
fn remarks(parameter: &EstimatedParameter, is_adequate: bool) -> Vec<String> {
    let mut remarks = Vec::new();
    match &parameter.determination {
        Determination::OnlyTogetherWith { parameters } if is_adequate => {
            remarks.push(format!(
                "Only a combination with {} is determined.",
                parameters.join(", ")
            ));
        }
        Determination::AtLimit => remarks
            .push("Ended at its limit: widen it with --free, or physics is missing.".to_owned()),
        Determination::OnlyTogetherWith { .. }
        | Determination::NotExcited
        | Determination::Determined => {}
    }
    if let Some(determined_by) = parameter.determined_by.as_ref().filter(|_| is_adequate) {
        remarks.push(format!("To determine it, {determined_by}."));
    }
    if parameter.is_beyond_usual {
        remarks.push(
            "Beyond the usual tolerance of the part: the plant file is wrong here.".to_owned(),
        );
    }
    remarks
}
