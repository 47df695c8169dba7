//! Logs become evidence: the noise of a sensor is told by all of them, a supply that was shut off is found, and where no
//! log is for checking, blocks are held out.

use plant_sim::PlantParameters;
use recording::Recording;

use super::error::DiagnoseError;
use super::evidence::Evidence;
use super::log::{Log, Read};
use super::sensor_noise::SensorNoise;
use super::supply::find_supply;

/// Blocks of a log, of which every third is held out.
const BLOCKS: usize = 12;

/// The evidence of `logs`.
pub(super) fn gather<'a>(
    parameters: &PlantParameters,
    logs: impl IntoIterator<Item = &'a Recording>,
) -> Result<Evidence, DiagnoseError> {
    let mut noise = SensorNoise::default();
    let read = logs.into_iter().map(|log| {
        let read = Read::of(parameters, log)?;
        read.tell(&mut noise);
        Ok((log, read))
    });
    let read = read.collect::<Result<Vec<_>, DiagnoseError>>()?;
    let logs = read.into_iter().map(|(log, read)| {
        let mut alone = Evidence::of(vec![Log::new(parameters, log, read, &noise)?]);
        find_supply(parameters, &mut alone);
        Ok(alone.logs)
    });
    let logs: Vec<_> = logs.collect::<Result<_, DiagnoseError>>()?;
    Ok(Evidence::of(logs.into_iter().flatten().collect()))
}

/// Evidence for fitting and for checking: `check`, or where there is none, blocks of `logs`.
pub(super) fn fitting_and_checking(
    parameters: &PlantParameters,
    logs: &[Recording],
    check: &[Recording],
) -> Result<[Evidence; 2], DiagnoseError> {
    if check.is_empty() {
        let mut fitting = gather(parameters, logs)?;
        let mut checking = gather(parameters, logs)?;
        hold_out(&mut fitting, &mut checking);
        return Ok([fitting, checking]);
    }
    let mut fitting = gather(parameters, logs.iter().chain(check))?;
    let checking = Evidence::of(fitting.logs.split_off(logs.len()));
    Ok([fitting, checking])
}

/// Of two copies of the same logs, one counts the blocks that the other does not.
fn hold_out(fitting: &mut Evidence, checking: &mut Evidence) {
    for (kept, out) in fitting.logs.iter_mut().zip(&mut checking.logs) {
        let rows = kept.counted.len();
        for row in 0..rows {
            let is_out = row * BLOCKS / rows.max(1) % 3 == 2;
            kept.counted[row] = !is_out;
            out.counted[row] = is_out;
        }
    }
}

/// What was not fitted, for people: logs of their own, or blocks; where only these show that something is missing,
/// they were fitted instead.
pub(super) fn held_out(has_check_logs: bool, is_exchanged: bool) -> &'static str {
    match (has_check_logs, is_exchanged) {
        (true, false) => "the logs given for checking, which were not fitted",
        (true, true) => {
            "the logs given for fitting: only those given for checking show that something is missing, so they were fitted"
        }
        (false, false) => "every third of twelve blocks of each log, which was not fitted",
        (false, true) => {
            "two of every three of twelve blocks of each log: only the third shows that something is missing, so it was fitted"
        }
    }
}
