//! Choice of the part that lags in proportional valves, where the plant file leaves it open.

use plant_sim::PlantParameters;
use plant_sim::parameters::LagOf;
use recording::Recording;

use super::rounds::{ROUNDS, Start, begin_at_delay, forgiving_fitter, in_rounds};
use super::unknowns_of;
use crate::diagnosis::error::DiagnoseError;
use crate::diagnosis::evidence::errors::Errors;
use crate::diagnosis::evidence::logged_supply::with_logged_supply;
use crate::diagnosis::fit::Fitter;
use crate::diagnosis::fit::logger_time::best_delay_s;
use crate::diagnosis::fit::split::Split;
use crate::diagnosis::knowledge::state_first_file;
use crate::diagnosis::search::Watch;
use crate::result::Horizon;

/// Share of the cost that a lag of the opening must save.
const BETTER: f64 = 0.05;

/// Returns the part that lags in the proportional valves of `plant`, as `logs` show it; none where no valve leaves it open.
///
/// Data sheets do not state it. With the wrong part, errors of 25 noise floors remained that looked like a missing effect.
///
/// # Errors
/// [`DiagnoseError`]: a log cannot be used, or `watch` stopped the fits.
pub(crate) fn lag_of_logs(
    plant: &PlantParameters,
    logs: &[Recording],
    check: &[Recording],
    watch: Watch,
) -> Result<Option<LagOf>, DiagnoseError> {
    if logs.is_empty() || plant.with_open_lag().next().is_none() {
        return Ok(None);
    }
    let fitted = |lag_of| fitted(&plant.with_lag_of(Some(lag_of)), logs, check, watch);
    let of_spool = fitted(LagOf::Spool)?;
    let is_of_opening =
        of_spool.is_material && fitted(LagOf::Opening)?.cost < (1.0 - BETTER) * of_spool.cost;
    Ok(Some(match is_of_opening {
        true => LagOf::Opening,
        false => LagOf::Spool,
    }))
}

/// Outcome of a quick fit.
struct Fitted {
    /// Robust loss.
    cost: f64,
    /// Whether more than the noise remains.
    is_material: bool,
}

fn fitted(
    plant: &PlantParameters,
    logs: &[Recording],
    check: &[Recording],
    watch: Watch,
) -> Result<Fitted, DiagnoseError> {
    let mut plant = with_logged_supply(plant, logs.iter().chain(check));
    state_first_file(&mut plant);
    let mut split = Split::as_given(&plant, logs, check)?;
    let mut start = Start::of(unknowns_of(&plant, &split.fitting));
    begin_at_delay(&mut start, best_delay_s(&plant, &split.fitting));
    let Start { unknowns, z } = in_rounds(&plant, &mut split, start, ROUNDS, watch)?;
    let robust = forgiving_fitter(&split.fitting, &unknowns).at(z.clone());
    let plain = Fitter::new(&split.fitting, &unknowns).at(z);
    let (robust, plain) = robust.zip(plain).ok_or_else(|| split.not_simulated())?;
    let errors = Errors::new(&split.fitting, &plain.residuals, Horizon::OneStepAhead);
    Ok(Fitted {
        cost: robust.cost,
        is_material: errors.is_material(),
    })
}
