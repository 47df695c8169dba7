//! Residual of a compared signal and its unit.

use model_lab::result::Residual;
use recording::TimeBase;

use crate::refusal::Refusal;
use crate::results::Compared;

/// Returns the residual of a compared signal with its time base.
pub(super) fn residual_of<'a>(
    compared: &'a Compared,
    name: &str,
) -> Result<(&'a TimeBase, Residual<'a>), Refusal> {
    let traces = &compared.comparison.traces;
    let base = traces.free_run.time_base_of(name);
    let found = base.zip(traces.free_run_residual(name));
    found.ok_or_else(|| Refusal::not_found("compared signal"))
}

/// Returns the unit of the signal's errors.
pub(super) fn unit_of_errors(compared: &Compared, name: &str) -> String {
    let signals = &compared.comparison.signals;
    let signal = signals.iter().find(|signal| signal.name == name);
    signal.map_or_else(String::new, |signal| signal.unit.clone())
}
