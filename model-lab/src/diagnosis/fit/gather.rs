//! Conversion of logs to evidence: the noise of a sensor is estimated from all of them, and a supply that was shut off is found.

use plant_sim::PlantParameters;
use recording::Recording;

use super::logger_time::{Delay, find_clock, find_sampling};
use super::supply::find_supply;
use crate::diagnosis::error::DiagnoseError;
use crate::diagnosis::evidence::Evidence;
use crate::diagnosis::evidence::log::Log;
use crate::diagnosis::evidence::read_log::Read;
use crate::diagnosis::evidence::sensor_noise::SensorNoise;

/// Returns the evidence of `logs`.
pub(crate) fn gather<'a>(
    parameters: &PlantParameters,
    logs: impl IntoIterator<Item = &'a Recording>,
) -> Result<Evidence, DiagnoseError> {
    let mut noise = SensorNoise::default();
    let read = logs.into_iter().map(|log| {
        let read = Read::of(parameters, log)?;
        read.add_noise_to(&mut noise);
        Ok((log, read))
    });
    let read = read.collect::<Result<Vec<_>, DiagnoseError>>()?;
    let logs = read.into_iter().map(|(log, read)| {
        let mut log = Log::new(parameters, log, read, &noise)?.thinned(parameters);
        find_clock(parameters, &mut log, Delay::Searched, &[]);
        let mut alone = Evidence::of(vec![log]);
        find_supply(parameters, &mut alone);
        Ok(alone.logs)
    });
    let logs: Vec<_> = logs.collect::<Result<_, DiagnoseError>>()?;
    let mut evidence = Evidence::of(logs.into_iter().flatten().collect());
    find_sampling(parameters, &mut evidence, Delay::Searched);
    Ok(evidence)
}
