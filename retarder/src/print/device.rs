//! Text of a device: identity, log, records and settings.

use std::io::Write as _;

use controller::SettingSpec;
use ecu::calibration::SettingId;
use hil_harness::signals;

use super::number::{or_dash, value};
use super::table::{Align, Entry, Table, painted};
use super::{Colour, Terminal, painted_paragraph, paragraph, title};
use crate::run::black_box::{BlackBox, Record, Status};
use crate::run::calibrate::Settings;
use crate::run::device_report::DeviceReport;
use crate::run::measurement::Measurement;

/// Lines of a device's log that are shown; the JSON has all.
const LOG_LINES: usize = 20;

/// Returns the device, its log, and whether its bits equal those of the ECU in process.
pub(super) fn report(report: &DeviceReport, terminal: &Terminal) -> String {
    let mut text = title("Device", terminal);
    text += &paragraph(&report.identity, terminal);
    text += &match &report.difference {
        None => format!(
            "{} Output and state equal those of the ECU in process, bit for bit, at all {} samples.\n",
            terminal.paint(Colour::Good, "same bits."),
            report.samples
        ),
        Some(difference) => format!(
            "{} The device does not do what the ECU in process does.\n{difference}\n",
            terminal.paint(Colour::Bad, "other bits.")
        ),
    };
    if !report.log.is_empty() {
        text += "\n";
        text += &title("Its log", terminal);
        let left_out = report.log.len().saturating_sub(LOG_LINES);
        if left_out > 0 {
            text += &terminal.paint(Colour::Faint, &format!("  ... {left_out} lines before ..."));
            text += "\n";
        }
        for line in &report.log[left_out..] {
            text += &format!("  {line}\n");
        }
    }
    text
}

/// Prints to the standard error that measuring has begun, since it may take long.
pub(crate) fn measuring() {
    // A closed standard error is not a failure.
    let _ = writeln!(
        anstream::stderr(),
        "Measuring; Ctrl-C ends it and keeps every sample until then."
    );
}

/// Returns the number of samples that came, and which of the requested ones are missing.
pub(crate) fn measured(measurement: &Measurement, terminal: &Terminal) -> String {
    let Measurement {
        samples,
        wanted,
        lost,
        ..
    } = *measurement;
    let mut text = match samples < wanted {
        true => format!("{samples} samples of {wanted}: it was ended before.\n"),
        false => format!("{samples} samples.\n"),
    };
    if lost > 0 {
        let lost = format!(
            "{lost} samples in between are missing: they came faster than this machine took them. time_s has the gaps."
        );
        text += &painted_paragraph(Colour::Notice, &lost, terminal);
    }
    text
}

/// Records of a black box that are shown without --out: those around the first fault.
const RECORDS_SHOWN: usize = 24;

/// Returns the box, with the records around the first fault.
pub(super) fn black_box(black_box: &BlackBox, terminal: &Terminal) -> String {
    let mut text = title("Black box", terminal);
    text += &paragraph(&black_box.device, terminal);
    let count = black_box.records.len();
    let state = match black_box.status {
        Status::Recording => "It records; no fault came.",
        Status::Triggered => "A first fault came; it records for a second more.",
        Status::Frozen => "A first fault came; it keeps what it has until it is cleared.",
        Status::FrozenByReset => {
            "The device was reset while it recorded; it keeps what it has until it is cleared."
        }
    };
    text += &paragraph(&format!("{state} {count} samples of 10 ms."), terminal);
    if black_box.torn > 0 {
        let torn = format!(
            "{} records were torn by a reset and are left out.",
            black_box.torn
        );
        text += &paragraph(&torn, terminal);
    }
    if let Some(number) = black_box.first_fault_in {
        text += &terminal.paint(
            Colour::Bad,
            &format!(
                "First fault: {} in record {number}.",
                black_box.first_faults.join(", ")
            ),
        );
        text += "\n";
    }
    if count == 0 {
        return text;
    }
    text += "\n";
    let shown = around(black_box);
    text += &records(
        &black_box.records[shown.clone()],
        black_box.first_fault_in,
        terminal,
    );
    if shown.len() < count {
        text += &format!(
            "{} of {count} records; --out FILE writes all as CSV.\n",
            shown.len()
        );
    }
    text
}

/// Returns the range of records to show: around the first fault, or the last ones.
fn around(black_box: &BlackBox) -> std::ops::Range<usize> {
    let count = black_box.records.len();
    let first = black_box.first_fault_in;
    let fault = first.and_then(|number| {
        black_box
            .records
            .iter()
            .position(|record| record.number == number)
    });
    let end = fault.map_or(count, |at| (at + RECORDS_SHOWN / 2).min(count));
    end.saturating_sub(RECORDS_SHOWN)..end
}

fn records(records: &[Record], first_fault: Option<u32>, terminal: &Terminal) -> String {
    let mut table = Table::new(
        [
            ("record", Align::Right),
            ("p_ref [bar]", Align::Right),
            ("p_ch [bar]", Align::Right),
            ("fill [%]", Align::Right),
            ("vent [%]", Align::Right),
            ("u [%]", Align::Right),
            ("mode", Align::Left),
            ("faults", Align::Left),
        ],
        terminal,
    );
    let short = |number: f64| format!("{number:.2}");
    for record in records {
        let number: Entry = if Some(record.number) == first_fault {
            painted(Colour::Bad, record.number)
        } else {
            record.number.into()
        };
        table.row([
            number,
            or_dash(record.reference_bar, short).into(),
            or_dash(record.pressure_bar, short).into(),
            format!("{:.1}", record.duty_fill_pct).into(),
            format!("{:.1}", record.duty_vent_pct).into(),
            format!("{:.1}", record.u_pct).into(),
            record.mode.as_str().into(),
            record.faults.join(", ").into(),
        ]);
    }
    table.to_string()
}

/// Returns the settings with their units and choices.
pub(super) fn settings(settings: &Settings, terminal: &Terminal) -> String {
    let mut text = title("Settings of the device", terminal);
    text += &paragraph(&settings.device, terminal);
    text += &paragraph(&settings.note, terminal);
    if settings.rows.is_empty() {
        return text;
    }
    text += "\n";
    for (id, value) in &settings.rows {
        let assignment = format!("{} = {value}", id.spec().name);
        let meaning = terminal.paint(Colour::Faint, &meaning(*id));
        text += &format!("{assignment:40}  {meaning}\n");
    }
    text
}

fn meaning(id: SettingId) -> String {
    let SettingSpec {
        unit,
        range: [min, max],
        choices,
        ..
    } = id.spec();
    match choices.is_empty() {
        true => format!("{min} to {max} {unit}"),
        false => choices.join(", "),
    }
}

/// Returns the list of all signals of a device.
pub(super) fn signals(terminal: &Terminal) -> String {
    let mut text = title("Signals of a device, one number in every sample", terminal);
    let columns = [
        ("signal", Align::Left),
        ("unit", Align::Left),
        ("resolution", Align::Right),
    ];
    let mut table = Table::new(columns, terminal);
    for (_, signal) in signals::all() {
        let resolution = (-f64::from(signal.fraction_bits)).exp2();
        table.row([
            signal.name.into(),
            signal.unit.into(),
            value(resolution).into(),
        ]);
    }
    text += &table.to_string();
    text + "\nMeasure up to 16: retarder calibrate measure --dut DEVICE SIGNAL...\n"
}
