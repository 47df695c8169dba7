//! Search for the ECU sample within the PWM pattern at which a log begins.
//!
//! Samples of the ECU and its PWM come from one timer. Where a sample time is a whole number of PWM periods, each sample lies at the same
//! place of a period, which the delay of the commands accounts for. Otherwise a log may begin at any sample of the common pattern, for
//! example five samples with 20 Hz and 10 ms. A wrong one shifts every pulse by a part of the period.

use plant_sim::PlantParameters;
use plant_sim::parameters::EcuParameters;

use super::{CLEAR, Delay, Tries, WIDE_DELAY_STEP_S};
use crate::diagnosis::evidence::log::Log;

/// Largest number of samples that are tried. In a longer pattern they lie close together, and the delay of the commands compensates for
/// one.
const LEADS_MAX: usize = 12;
/// Largest distance of samples and PWM periods, as a share of a period, at which they coincide.
const COINCIDE: f64 = 0.01;

/// Finds the sample of the ECU within its pattern of PWM periods at which `log` begins, with the present `plant`. Unchanged where no other
/// one is clearly better.
pub(super) fn find_pwm_lead(plant: &PlantParameters, log: &mut Log, delay: Delay) {
    let leads_ns = leads_ns(&plant.ecu);
    if !(2..=LEADS_MAX).contains(&leads_ns.len()) {
        return;
    }
    let (there_ns, clock) = (log.conditions.pwm_lead_ns, log.conditions.clock);
    let mut loss_of = |lead_ns: u64| {
        log.conditions.pwm_lead_ns = lead_ns;
        let delays_s = delay.candidates_s(plant, WIDE_DELAY_STEP_S);
        Tries::on(plant, log).best(&[clock], &delays_s).whole.loss
    };
    let before = loss_of(there_ns);
    let losses = leads_ns.iter().map(|&lead_ns| (loss_of(lead_ns), lead_ns));
    let found = losses.min_by(|a, b| a.0.total_cmp(&b.0));
    let clear = found.filter(|(loss, _)| *loss <= CLEAR * before);
    log.conditions.pwm_lead_ns = clear.map_or(there_ns, |(_, lead_ns)| lead_ns);
    if let Some(clock) = clock {
        log.set_clock(clock, plant);
    }
}

/// Returns the times (ns) from a sample of the ECU that begins a PWM period to those before the next one that does.
fn leads_ns(ecu: &EcuParameters) -> Vec<u64> {
    let (sample_ns, period_ns) = (ecu.sample_time_ns(), ecu.pwm_period_ns());
    let apart_ns = |lead_ns: u64| {
        let after_ns = lead_ns % period_ns;
        after_ns.min(period_ns - after_ns)
    };
    let coincide = |lead_ns: &u64| apart_ns(*lead_ns) as f64 <= COINCIDE * period_ns as f64;
    let others = (1..).map(|samples| samples * sample_ns);
    let others = others.take_while(|lead_ns| !coincide(lead_ns));
    core::iter::once(0).chain(others).collect()
}

#[cfg(test)]
mod tests {
    use plant_sim::logger_clock::LoggerClock;

    use super::*;
    use crate::bench::{logged, pressure_alone, without_rows};
    use crate::diagnosis::evidence::Evidence;
    use crate::diagnosis::fit::gather::gather;
    use crate::diagnosis::fit::vector::square;
    use crate::result::Horizon;

    fn ecu(sample_time_s: f64, pwm_frequency_hz: f64) -> EcuParameters {
        EcuParameters {
            sample_time_s,
            pwm_frequency_hz,
            ..EcuParameters::default()
        }
    }

    #[test]
    fn the_pattern_of_samples_and_periods_ends_where_both_coincide() {
        let ms = |leads_ns: Vec<u64>| {
            leads_ns
                .into_iter()
                .map(|ns| ns / 1_000_000)
                .collect::<Vec<_>>()
        };
        assert_eq!(ms(leads_ns(&ecu(0.01, 100.0))), [0]);
        assert_eq!(ms(leads_ns(&ecu(0.01, 500.0))), [0]);
        assert_eq!(ms(leads_ns(&ecu(0.01, 20.0))), [0, 10, 20, 30, 40]);
        assert_eq!(ms(leads_ns(&ecu(0.01, 60.0))), [0, 10, 20, 30, 40]);
    }

    /// A valve driven at 20 Hz by an ECU that samples at 100 Hz: the log begins anywhere in a period.
    #[test]
    fn a_log_that_begins_within_a_slow_pwm_period_has_the_error_of_the_sensor() {
        let mut plant = PlantParameters::nominal();
        plant.ecu.pwm_frequency_hz = 20.0;
        let whole = pressure_alone(&logged(&plant, LoggerClock::default(), 0.01, 1));
        let log = without_rows(&whole, 0..3);
        let mut evidence = gather(&plant, [&log]).unwrap();
        let mean_square = |evidence: &Evidence| {
            let residuals = evidence.residuals(&plant, Horizon::OneStepAhead).unwrap();
            square(&residuals) / evidence.counted_samples()
        };
        let found = mean_square(&evidence);
        evidence.logs[0].conditions.pwm_lead_ns = 0;
        let at_a_beginning = mean_square(&evidence);
        assert!(found < 1.5, "{found} {at_a_beginning}");
        assert!(at_a_beginning > 20.0, "{at_a_beginning}");
    }
}
