//! Rust source of the tables.

use std::fmt::Write as _;

use plant_sim::PlantParameters;
use plant_sim::experiment::ValveId;

use super::flow::flow_table;
use super::measured::{OPEN_TIMES, ValveTimes, open_time_ms, table_error};
use super::{Shipped, VALVES};

/// Unit of the flow coordinate in the tables.
const FLOW_BITS: u32 = 14;

/// Returns the source of a table of on-times.
pub fn source(shipped: &Shipped) -> String {
    let plant = shipped.plant();
    let all = VALVES.map(|valve| (valve, ValveTimes::of(&plant, valve)));
    let mut text = format!(
        "//! Pulses of the nominal plant with orifices of {:.1} mm. Written by\n\
         //! `BLESS=1 cargo nextest run -p hil-harness pulse_tables`; do not edit.\n//!\n\
         //! Error of the open time halfway between the points of the table:\n",
        1e3 * shipped.orifice_m
    );
    for (valve, times) in &all {
        let error = table_error(&plant, *valve, times);
        let _ = writeln!(
            text,
            "//! {} valve {:.2} ms rms, {:.2} ms at most.",
            name(*valve),
            error.rms_ms,
            error.max_ms
        );
    }
    text += "\nuse crate::pulses::pulse_table::{PulseTable, ValveTable};\n\n";
    text += "pub(crate) static TABLE: PulseTable = PulseTable {\n";
    for (valve, times) in &all {
        let _ = writeln!(text, "    {}: ValveTable {{", name(*valve));
        text += "        on_time_us: [\n";
        for index in 0..OPEN_TIMES {
            let _ = writeln!(text, "            // {:.3} ms open", open_time_ms(index));
            write_block(&mut text, "            ", &times.on_ms[index]);
        }
        text += "        ],\n";
        for (key, block) in [
            ("one_period_us", &times.one_period_ms),
            ("two_periods_us", &times.two_periods_ms),
            ("opening_us", &times.opening_ms),
        ] {
            let _ = write!(text, "        {key}: ");
            write_block(&mut text, "        ", block);
        }
        text += "    },\n";
    }
    text += "};\n";
    text
}

fn name(valve: ValveId) -> &'static str {
    match valve {
        ValveId::Fill => "fill",
        ValveId::Vent => "vent",
    }
}

fn write_block(text: &mut String, indent: &str, rows: &[[f64; 5]; 5]) {
    if !text.ends_with(": ") {
        *text += indent;
    }
    *text += "[\n";
    for row in rows {
        let cells = row.map(|ms| format!("{}", (1e3 * ms).round() as u16));
        let _ = writeln!(text, "{indent}    [{}],", cells.join(", "));
    }
    let _ = writeln!(text, "{indent}],");
}

/// Returns the source of the tables of the flow coordinate.
pub fn flow_source(plant: &PlantParameters) -> String {
    let mut text = "//! Flow coordinate of both valves (docs/equations.md), 2⁻¹⁴. Written by\n\
                    //! `BLESS=1 cargo nextest run -p hil-harness pulse_tables`; do not edit.\n"
        .to_owned();
    for (valve, about) in VALVES.into_iter().zip([
        "Fill valve, over p/p_sup (absolute) from 0 to 1.",
        "Vent valve, over p/p_amb from 0 to 16.",
    ]) {
        let table = flow_table(plant, valve);
        let _ = write!(
            text,
            "\n/// {about}\npub(crate) static {}: [u16; {}] = [\n",
            name(valve).to_uppercase(),
            table.len()
        );
        for cells in table.chunks(8) {
            let scaled =
                |value: &f64| format!("{}", (value * f64::from(1 << FLOW_BITS)).round() as u16);
            let cells: Vec<String> = cells.iter().map(scaled).collect();
            let _ = writeln!(text, "    {},", cells.join(", "));
        }
        text += "];\n";
    }
    text
}
