//! Signals of a run, as a recording.

use recording::{AddSignalError, Provenance, Recording, TimeBase, TimeBaseError, Unit};

use crate::checks::PLUNGER;
use crate::scenario::Scenario;
use crate::wire::{self, Exchange};
use crate::world::World;

/// Displacement of the plunger over its stroke: the brake torque follows it (section 2.1.2), and no other signal shows it.
const TORQUE_PROXY: &str = "torque_proxy";

/// Reason why simulated data gives no recording.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum NotRecorded {
    /// The instants give no time base.
    #[error(transparent)]
    TimeBase(#[from] TimeBaseError),
    /// The simulated values give no signal.
    #[error(transparent)]
    Signal(#[from] AddSignalError),
}

/// Signals of a run from time 0 on, by name and unit.
pub(crate) struct Trace {
    columns: [(&'static str, Unit, Vec<f64>); 12],
    /// Position of the plunger (m); empty if the plant has none.
    plunger_m: Vec<f64>,
    /// Number of lifts of the valves before time 0.
    lifts_before: Option<[u64; 2]>,
}

impl Trace {
    pub(crate) fn for_samples(samples: u32) -> Self {
        let columns = [
            ("p_ref", Unit::BarGauge),
            ("p_ch", Unit::BarGauge),
            ("p_ch_measured", Unit::BarGauge),
            ("duty_fill", Unit::Percent),
            ("duty_vent", Unit::Percent),
            ("u", Unit::Percent),
            ("i_fill", Unit::Milliampere),
            ("i_vent", Unit::Milliampere),
            ("x_fill", Unit::Millimetre),
            ("x_vent", Unit::Millimetre),
            ("actuations_fill", Unit::Count),
            ("actuations_vent", Unit::Count),
        ];
        Self {
            columns: columns.map(|(name, unit)| (name, unit, Vec::with_capacity(samples as usize))),
            plunger_m: Vec::new(),
            lifts_before: None,
        }
    }

    pub(crate) fn add(&mut self, world: &World<'_>, exchange: &Exchange) {
        let Exchange { sensors, answer } = exchange;
        let shown = world.shown();
        let lifts = world.lifts();
        let before = *self.lifts_before.get_or_insert(lifts);
        let row = [
            sensors.reference.map_or(f64::NAN, wire::bar),
            world.pressure_bar(),
            sensors.pressure.map_or(f64::NAN, wire::measured_bar),
            wire::duty_pct(answer.actuators.duty_fill),
            wire::duty_pct(answer.actuators.duty_vent),
            wire::control_signal_pct(answer.telemetry.control_signal),
            1e3 * shown.mean_current[0],
            1e3 * shown.mean_current[1],
            1e3 * shown.position[0],
            1e3 * shown.position[1],
            (lifts[0] - before[0]) as f64,
            (lifts[1] - before[1]) as f64,
        ];
        for ((_, _, column), value) in self.columns.iter_mut().zip(row) {
            column.push(value);
        }
        self.plunger_m.extend(world.plunger_m());
    }

    pub(crate) fn into_recording(
        self,
        scenario: &Scenario,
        device: &str,
    ) -> Result<Recording, NotRecorded> {
        let mut provenance = Provenance::from_source(format!("scenario {}", scenario.name))
            .with_note("device", device)
            .with_note("seed", scenario.seed.to_string());
        provenance.producer = Some(concat!("hil-harness ", env!("CARGO_PKG_VERSION")).to_owned());
        let mut recording = Recording::new(provenance);
        let samples = scenario.duration_samples as usize;
        let time_base = TimeBase::uniform(0.0, scenario.plant.ecu.sample_time_s, samples)?;
        let time_base = recording.add_time_base(time_base);
        for (name, unit, column) in self.columns {
            recording.add_signal(name, unit, time_base, column)?;
        }
        if let Some(valve) = &scenario.plant.regulating_valve {
            let scaled = |factor: f64| self.plunger_m.iter().map(|m| factor * m).collect();
            recording.add_signal(PLUNGER, Unit::Millimetre, time_base, scaled(1e3))?;
            let percent = scaled(100.0 / valve.stroke_m);
            recording.add_signal(TORQUE_PROXY, Unit::Percent, time_base, percent)?;
        }
        Ok(recording)
    }
}
