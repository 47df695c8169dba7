//! Text of a simulation.

use super::diagnosis::conditions;
use super::number::significant;
use super::{Colour, Terminal, painted_paragraph, paragraph, title};
use crate::run::simulate::Simulation;

/// Returns plant, log, speed, steps and defects of the simulation.
pub(crate) fn simulation(simulation: &Simulation, terminal: &Terminal) -> String {
    let mut text = title(
        &format!("{} driven by {}", simulation.plant, simulation.log),
        terminal,
    );
    let mut facts = format!(
        "{} rows, {} s in {} s: {} times faster than real time, with reading and writing.",
        simulation.rows,
        significant(simulation.duration_s, 4),
        significant(simulation.elapsed_s, 2),
        significant(simulation.times_real_time, 3),
    );
    if let Some(steps) = simulation.steps_per_pwm_period {
        facts += &format!(
            " {} integration steps per PWM period; {} accepted, {} repeated, {} intervals by formula, {} events located.",
            significant(steps, 3),
            simulation.steps,
            simulation.rejected_steps,
            simulation.exact_intervals,
            simulation.events
        );
    }
    if simulation.held_commands > 0 {
        facts += &format!(
            " In {} rows a duty cycle is missing and the last one was held.",
            simulation.held_commands
        );
    }
    if simulation.start_pressure_bar_gauge != 0.0 {
        facts += &format!(" It begins {}.", simulation.start);
    }
    text += &paragraph(&facts, terminal);
    text += &conditions(&simulation.clock, &simulation.start_gas, terminal);
    for sentence in &simulation.defects.sentences {
        text += &painted_paragraph(Colour::Notice, &format!("Log: {sentence}."), terminal);
    }
    if let Some(path) = &simulation.recording {
        text += &format!("Written: {path}\n");
    }
    text
}
