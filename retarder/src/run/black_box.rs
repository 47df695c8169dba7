//! Black box of a device.

use ecu::{Fault, FaultSet, Mode};
use hil_harness::ecu_under_test::carry_out;
use hil_harness::link::{Link, LinkError};
use hil_harness::wire;
use hil_protocol::{BlackBoxPage, BlackBoxRecord, BlackBoxStatus, Reply, Request};
use schemars::JsonSchema;
use serde::Serialize;

use crate::cli::BlackBoxArgs;
use crate::failure::Failure;

/// Name and version of the JSON form of [`BlackBox`].
pub(crate) const SCHEMA: &str = "retarder.black-box/1";

/// Records of a device's black box.
#[derive(Debug, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct BlackBox {
    /// Name and version of this format, `retarder.black-box/1`.
    pub(crate) schema: &'static str,
    /// Identity of the device.
    pub(crate) device: String,
    /// State of the box.
    pub(crate) status: Status,
    /// Number of the record with the first fault; null if there is none.
    pub(crate) first_fault_in: Option<u32>,
    /// Faults in that record.
    pub(crate) first_faults: Vec<String>,
    /// Number of records that a reset damaged; they are left out.
    pub(crate) torn: u32,
    /// Records, one for each sample, oldest first.
    pub(crate) records: Vec<Record>,
}

/// State of a black box.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Status {
    /// Recording; no fault occurred.
    Recording,
    /// Recording for a short time after the first fault.
    Triggered,
    /// Stopped after the first fault; the records are kept until the box is cleared.
    Frozen,
    /// Stopped by a reset of the device; the records are kept until the box is cleared.
    FrozenByReset,
}

/// One sample.
#[derive(Debug, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct Record {
    /// Number of the record, counted since the box was cleared.
    pub(crate) number: u32,
    /// Reference (bar gauge); null if there was no valid message.
    pub(crate) reference_bar: Option<f64>,
    /// Pressure (bar gauge); null if the converter did not answer.
    pub(crate) pressure_bar: Option<f64>,
    /// Duty cycle of the fill valve's coil (%).
    pub(crate) duty_fill_pct: f64,
    /// Duty cycle of the vent valve's coil (%).
    pub(crate) duty_vent_pct: f64,
    /// Control signal (%).
    pub(crate) u_pct: f64,
    /// Mode of the supervisor.
    pub(crate) mode: String,
    /// Faults that are present or latched.
    pub(crate) faults: Vec<String>,
}

/// Reads the whole box, then empties it if requested.
pub(crate) fn run(args: &BlackBoxArgs) -> Result<BlackBox, Failure> {
    let mut session = args.device.dut.session(args.device.image.as_deref())?;
    let device = session.identity();
    let black_box = read(session.as_mut(), device)?;
    if args.clear {
        carry_out(session.as_mut(), &Request::ClearBlackBox)?;
    }
    Ok(black_box)
}

fn read(link: &mut (impl Link + ?Sized), device: String) -> Result<BlackBox, LinkError> {
    let first = page(link, 0)?;
    let (status, trigger) = match first.status {
        BlackBoxStatus::Recording => (Status::Recording, None),
        BlackBoxStatus::Triggered { number, faults } => (Status::Triggered, Some((number, faults))),
        BlackBoxStatus::Frozen { number, faults } => (Status::Frozen, Some((number, faults))),
        BlackBoxStatus::FrozenByReset => (Status::FrozenByReset, None),
    };
    let mut torn = u32::from(first.torn);
    let mut records: Vec<Record> = first.records.iter().map(record).collect();
    for number in 1..first.pages {
        let page = page(link, number)?;
        torn += u32::from(page.torn);
        records.extend(page.records.iter().map(record));
    }
    Ok(BlackBox {
        schema: SCHEMA,
        device,
        status,
        first_fault_in: trigger.map(|(number, _)| number),
        first_faults: trigger.map_or_else(Vec::new, |(_, faults)| fault_names(faults)),
        torn,
        records,
    })
}

fn page(link: &mut (impl Link + ?Sized), page: u16) -> Result<BlackBoxPage, LinkError> {
    let request = Request::BlackBox { page };
    match link.ask(&request)? {
        Reply::BlackBox(page) => Ok(page),
        other => Err(LinkError::unexpected(&request, &other)),
    }
}

fn record(record: &BlackBoxRecord) -> Record {
    let mode = Mode::ALL.get(usize::from(record.mode));
    Record {
        number: record.number,
        reference_bar: record.reference.map(wire::bar),
        pressure_bar: record.pressure.map(wire::measured_bar),
        duty_fill_pct: wire::duty_pct(record.duty_fill),
        duty_vent_pct: wire::duty_pct(record.duty_vent),
        u_pct: wire::control_signal_pct(record.control_signal),
        mode: mode.map_or_else(|| record.mode.to_string(), |mode| format!("{mode:?}")),
        faults: fault_names(record.faults),
    }
}

fn fault_names(bits: u32) -> Vec<String> {
    FaultSet::from_bits(bits)
        .iter()
        .map(|fault: Fault| format!("{fault:?}"))
        .collect()
}

impl BlackBox {
    /// Returns one line per record, with units in the header.
    pub(crate) fn csv(&self) -> String {
        let number = |value: Option<f64>| value.map_or_else(String::new, |value| value.to_string());
        let header = "record,p_ref_bar_gauge,p_ch_measured_bar_gauge,duty_fill_pct,duty_vent_pct,u_pct,mode,faults\n";
        self.records.iter().fold(header.to_owned(), |text, record| {
            text + &format!(
                "{},{},{},{},{},{},{},{}\n",
                record.number,
                number(record.reference_bar),
                number(record.pressure_bar),
                record.duty_fill_pct,
                record.duty_vent_pct,
                record.u_pct,
                record.mode,
                record.faults.join(" ")
            )
        })
    }
}

#[cfg(test)]
mod tests {
    use hil_harness::sensor_walk::SensorWalk;
    use hil_harness::wire::Actuators;
    use hil_harness::{DeviceUnderTest as _, InProcess};

    use super::*;

    #[test]
    fn a_box_that_saw_a_fault_names_it_and_has_every_sample_before_it() {
        let settings = ecu::EcuSettings::bench();
        let mut device = InProcess::new();
        device.start(&settings).unwrap();
        let mut walk = SensorWalk::new(5, settings.vent_valve);
        let mut driven = Actuators::OFF;
        for _ in 0..3000 {
            driven = device.exchange(&walk.next(driven)).unwrap().actuators;
        }
        let read = read(device.link_mut(), "test".to_owned()).unwrap();
        assert_eq!(read.status, Status::Frozen);
        assert!(!read.first_faults.is_empty());
        let first = read.first_fault_in.unwrap();
        let at_fault = read.records.iter().find(|record| record.number == first);
        assert_eq!(at_fault.unwrap().faults, read.first_faults);
        let numbers: Vec<u32> = read.records.iter().map(|record| record.number).collect();
        assert!(numbers.windows(2).all(|pair| pair[1] == pair[0] + 1));
        let csv = read.csv();
        assert_eq!(csv.lines().count(), read.records.len() + 1);
        assert!(csv.contains(&read.first_faults[0]), "{csv}");
    }
}
