//! Jumps of an error: where a delay of an on/off valve passes the length of a commanded pulse or pause.
//!
//! A pulse that is shorter than the opening delay moves nothing. A slightly longer one opens the valve, which then stays open for the closing
//! delay. So the error of a model jumps there, and a descent, which follows slopes, ends on the wrong side.

use plant_sim::parameters::ParameterSpec;

use super::log::Log;

/// Tables of the on/off valves in a plant file.
const VALVES: [&str; 2] = ["on_off_fill", "on_off_vent"];
/// Difference of two lengths of pulses up to which they are the same (s): the resolution of the simulator.
const SAME_S: f64 = 1e-9;

/// Returns the values of the parameter `spec` at which the error of the model jumps, ascending, in its unit (s); none unless it is a delay of
/// an on/off valve.
pub(crate) fn jumps(spec: &ParameterSpec, logs: &[Log]) -> Vec<f64> {
    let is_of_pauses = match spec.key {
        "opening_delay_s" => false,
        "closing_delay_s" => true,
        _ => return Vec::new(),
    };
    let Some(valve) = VALVES.iter().position(|valve| *valve == spec.section) else {
        return Vec::new();
    };
    let lengths_s = logs.iter().flat_map(|log| {
        let shares = log.commands.duty_pct[valve].iter().map(|pct| pct / 100.0);
        let is_pulsed = |share: &f64| 0.0 < *share && *share < 1.0;
        let lengths = shares.filter(is_pulsed);
        let of_period = lengths.map(move |share| if is_of_pauses { 1.0 - share } else { share });
        of_period.map(|share| share * log.commands.pwm_period_s)
    });
    let mut lengths_s: Vec<f64> = lengths_s.collect();
    lengths_s.sort_by(f64::total_cmp);
    lengths_s.dedup_by(|a, b| *a - *b < SAME_S);
    lengths_s
}
