//! Table of measured and simulated figures.

use plant_sim::PlantParameters;
use plant_sim::experiment::{self, ValveId};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::measurements::{FillingAndVenting, Measurements};

/// Schema of [`ThesisTable`] as JSON.
pub const THESIS_SCHEMA: &str = "retarder.thesis/1";

/// Allowed deviation of a duty limit (% duty).
const DUTY_LIMIT_PCT: f64 = 1.5;
/// Allowed deviation of a time (samples): the resolution of the measurement.
const TIME_LIMIT_SAMPLES: f64 = 1.0;
/// Allowed deviation of a current (%).
const CURRENT_LIMIT_PCT: f64 = 1.0;
/// Bore of the valve itself (mm); smaller orifices were inserted into the housing upstream of it.
pub(super) const VALVE_BORE_MM: f64 = 1.9;

/// All rows.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ThesisTable {
    /// Name and version of this format, `retarder.thesis/1`.
    pub schema: String,
    /// Figures in the order of the thesis.
    pub rows: Vec<Row>,
    /// Whether every row with a limit is within it.
    pub holds: bool,
}

/// Row with one figure.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Row {
    /// Table or section of the thesis.
    pub source: String,
    /// Rig, where the figure belongs to one.
    pub rig: Option<String>,
    /// Measured quantity.
    pub quantity: String,
    /// Unit of `measured` and `simulated`.
    pub unit: String,
    /// Value as printed.
    pub measured: f64,
    /// Simulated value; none where the model never reaches the figure.
    pub simulated: Option<f64>,
    /// Simulated minus measured.
    pub deviation: Option<Deviation>,
    /// Allowed deviation of the plain model, in the unit of the deviation; none where the figure is for information.
    pub limit: Option<f64>,
    /// Whether the deviation is within the limit; none without a limit.
    pub holds: Option<bool>,
    /// Remark for the reader.
    pub note: Option<String>,
}

/// Deviation of the model.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Deviation {
    /// Simulated minus measured.
    pub value: f64,
    /// `samples`, `% duty` or `%`.
    pub unit: String,
}

/// Runs every experiment of the thesis on the model.
pub fn compare_with_model(
    parameters: &PlantParameters,
    measurements: &Measurements,
) -> ThesisTable {
    let mut rows = duty_limits(parameters, measurements);
    rows.extend(full_stroke(parameters, measurements));
    rows.extend(currents(parameters, measurements));
    for rig in &measurements.filling_and_venting {
        rows.extend(filling_and_venting(parameters, measurements, rig));
    }
    ThesisTable {
        schema: THESIS_SCHEMA.to_owned(),
        holds: rows.iter().all(|row| row.holds != Some(false)),
        rows,
    }
}

fn duty_limits(parameters: &PlantParameters, measurements: &Measurements) -> Vec<Row> {
    let limits = &measurements.duty_limits_percent;
    let opening =
        |valve, with_pressure| experiment::opening_duty_pct(parameters, valve, with_pressure);
    let holding = |valve| experiment::holding_duty_pct(parameters, valve);
    let (fill, vent) = (ValveId::Fill, ValveId::Vent);
    let both = "tables 4.1, 4.2";
    [
        (
            "table 4.1",
            "fill valve opens, supply pressure across it",
            limits.fill_open_with_supply_pressure,
            opening(fill, true),
        ),
        (
            "table 4.2",
            "fill valve opens, no pressure",
            limits.fill_open_without_pressure,
            opening(fill, false),
        ),
        (
            both,
            "fill valve stays open",
            limits.fill_hold,
            holding(fill),
        ),
        (
            "table 4.1",
            "vent valve opens, supply pressure across it",
            limits.vent_open_with_supply_pressure,
            opening(vent, true),
        ),
        (
            "table 4.2",
            "vent valve opens, no pressure",
            limits.vent_open_without_pressure,
            opening(vent, false),
        ),
        (
            both,
            "vent valve stays open",
            limits.vent_hold,
            holding(vent),
        ),
    ]
    .into_iter()
    .map(|(source, quantity, measured, simulated)| duty_row(source, quantity, measured, simulated))
    .map(|row| row.held_to(DUTY_LIMIT_PCT))
    .map(|row| match row.quantity.ends_with("stays open") {
        true => row.with_note(STAYS_OPEN),
        false => row,
    })
    .collect()
}

/// Returns the row of a duty cycle (%), not judged.
fn duty_row(source: &str, quantity: &str, measured: f64, simulated: Option<f64>) -> Row {
    Row {
        source: source.to_owned(),
        rig: None,
        quantity: quantity.to_owned(),
        unit: "%".to_owned(),
        measured,
        simulated,
        deviation: simulated.map(|simulated| Deviation {
            value: simulated - measured,
            unit: "% duty".to_owned(),
        }),
        limit: None,
        holds: None,
        note: None,
    }
}

/// Criterion of the rows of DC_max.
const STAYS_OPEN: &str = "judged by a travel of 5 % of the stroke: the armature no longer returns to its seat, which ends \
                          the sound by which the thesis found the limit";

/// Returns the strict reading of DC_max: the armature rests at full stroke.
fn full_stroke(parameters: &PlantParameters, measurements: &Measurements) -> [Row; 2] {
    let limits = &measurements.duty_limits_percent;
    let row = |quantity: &str, measured: f64, valve| {
        let simulated = experiment::full_stroke_duty_pct(parameters, valve);
        duty_row("tables 4.1, 4.2", quantity, measured, simulated).with_note(
            "strict reading of the same limit: the armature rests at full stroke and moves no more",
        )
    };
    [
        row(
            "fill valve rests at full stroke",
            limits.fill_hold,
            ValveId::Fill,
        ),
        row(
            "vent valve rests at full stroke",
            limits.vent_hold,
            ValveId::Vent,
        ),
    ]
}

fn currents(parameters: &PlantParameters, measurements: &Measurements) -> Vec<Row> {
    let coil = &measurements.coil;
    let [full, ..] = experiment::steady_current(parameters, 100.0);
    let [_, least, _] = experiment::steady_current(parameters, 40.0);
    let current = |source: &str, quantity: &str, measured: f64, amperes: f64| Row {
        source: source.to_owned(),
        rig: None,
        quantity: quantity.to_owned(),
        unit: "mA".to_owned(),
        measured,
        simulated: Some(amperes * 1e3),
        deviation: Some(Deviation {
            value: 100.0 * (amperes * 1e3 / measured - 1.0),
            unit: "%".to_owned(),
        }),
        limit: None,
        holds: None,
        note: None,
    };
    vec![
        current("section 4.2.4", "steady current at 100 %", coil.current_at_100_percent_mA, full)
            .held_to(CURRENT_LIMIT_PCT),
        current("figure 5.3", "current after 60 s at 100 %", coil.current_after_60_s_at_100_percent_mA, full)
            .with_note("the plain model's coil does not warm up: effect coil_heating"),
        current(
            "figure 4.4",
            "least current at 40 %, the thesis' own model",
            coil.modelled_minimum_current_at_40_percent_mA,
            least,
        )
        .with_note("read off a figure, and of a model: the measured current ripples less (effect iron_saturation)"),
    ]
}

fn filling_and_venting(
    parameters: &PlantParameters,
    measurements: &Measurements,
    rig: &FillingAndVenting,
) -> Vec<Row> {
    let plant = rig_parameters(parameters, rig);
    let supply = plant.gas.supply_pressure_bar_gauge;
    let tolerance = measurements.requirement.p_tol_bar;
    let samples_per_t_req = f64::from(measurements.requirement.t_req_samples);
    let t_req_s = samples_per_t_req * plant.ecu.sample_time_s;
    let filling = |to: f64| experiment::pressure_step(&plant, ValveId::Fill, 100.0, 0.0, to);
    // Vented with the duty cycle that keeps the valve open, as in figure 4.2.
    let venting = |from: f64, to: f64| {
        let duty_pct = measurements.duty_limits_percent.fill_hold;
        experiment::pressure_step(&plant, ValveId::Vent, duty_pct, from, to)
    };
    let row = |source: &str, quantity: &str, measured: f64, seconds: Option<f64>| Row {
        source: source.to_owned(),
        rig: Some(rig_name(rig)),
        quantity: quantity.to_owned(),
        unit: "T_req".to_owned(),
        measured,
        simulated: seconds.map(|seconds| seconds / t_req_s),
        deviation: seconds.map(|seconds| Deviation {
            value: (seconds / t_req_s - measured) * samples_per_t_req,
            unit: "samples".to_owned(),
        }),
        limit: None,
        holds: None,
        note: None,
    };
    let short_fill = filling(0.26 * supply);
    let short = [
        row(
            "table 4.3",
            "filling, ambient to 0.26 P_sup",
            rig.fill_0_to_026_psup_t_req,
            short_fill.map(|step| step.duration_s),
        ),
        row(
            "table 4.3",
            "venting, 0.88 to 0.71 P_sup",
            rig.vent_088_to_071_psup_t_req,
            venting(0.88 * supply, 0.71 * supply).map(|step| step.duration_s),
        ),
    ];
    let long = [
        row(
            "table 4.4",
            "filling, ambient to P_sup",
            rig.fill_full_t_req,
            filling(supply - tolerance).map(|step| step.duration_s),
        ),
        row(
            "table 4.4",
            "venting, P_sup to ambient",
            rig.vent_full_t_req,
            venting(supply, tolerance).map(|step| step.duration_s),
        ),
    ];
    let own_bore = rig.orifice_mm >= VALVE_BORE_MM;
    let dead_time = row(
        "table 4.3",
        "dead time before filling",
        rig.delay_t_req,
        short_fill.map(|step| step.dead_time_s),
    )
    .with_note("varies with the phase of the command in the ECU sample");
    let inserted = "an orifice inserted into the housing (figure 4.12), whose own discharge coefficient is not known; the bench is faster than the model";
    let ends = "ends within the tolerance of 0.1 bar; the last part depends on supply line and flow law: effects supply_line_droop, critical_ratio";
    let mut rows = vec![dead_time];
    rows.extend(short.map(|row| {
        if own_bore {
            row.held_to(TIME_LIMIT_SAMPLES)
        } else {
            row.with_note(inserted)
        }
    }));
    rows.extend(long.map(|row| row.with_note(ends)));
    rows
}

pub(super) fn rig_name(rig: &FillingAndVenting) -> String {
    format!(
        "prototype {}, {} cm³, {} mm",
        rig.prototype, rig.volume_cm3, rig.orifice_mm
    )
}

/// Returns the plant as it was on the bench for tables 4.3 and 4.4.
pub(super) fn rig_parameters(
    parameters: &PlantParameters,
    rig: &FillingAndVenting,
) -> PlantParameters {
    let mut plant = parameters.clone();
    plant.chamber.volume_m3 = rig.volume_cm3 * 1e-6;
    plant.flow.orifice_fill_m = rig.orifice_mm * 1e-3;
    plant.flow.orifice_vent_m = rig.orifice_mm * 1e-3;
    plant
}

impl Row {
    fn held_to(self, limit: f64) -> Self {
        let within = |deviation: &Deviation| deviation.value.abs() <= limit;
        Self {
            limit: Some(limit),
            holds: Some(self.deviation.as_ref().is_some_and(within)),
            ..self
        }
    }

    fn with_note(self, note: &str) -> Self {
        Self {
            note: Some(note.to_owned()),
            ..self
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The requirement on the nominal parameters: duty limits within 1.5 % duty, currents within 1 %, and the short filling and venting
    /// times of the 1.9 mm rigs within one sample.
    #[test]
    fn the_nominal_plant_reaches_every_figure_that_it_is_held_to() {
        let table = compare_with_model(&PlantParameters::nominal(), &Measurements::bundled());
        let missed: Vec<_> = table
            .rows
            .iter()
            .filter(|row| row.holds == Some(false))
            .collect();
        assert!(missed.is_empty() && table.holds, "{missed:#?}");
        assert_eq!(
            table.rows.iter().filter(|row| row.holds.is_some()).count(),
            6 + 1 + 4
        );
    }

    /// The plain model is known to fill the large orifices too fast in the end; the table must report it.
    #[test]
    fn full_filling_of_the_large_orifice_is_shown_to_be_off() {
        let table = compare_with_model(&PlantParameters::nominal(), &Measurements::bundled());
        let row = table
            .rows
            .iter()
            .rfind(|row| row.quantity == "filling, ambient to P_sup")
            .unwrap();
        assert!(row.deviation.as_ref().unwrap().value < -10.0, "{row:?}");
        assert!(row.note.is_some());
    }

    #[test]
    fn a_wrong_plant_does_not_hold() {
        let mut plant = PlantParameters::nominal();
        plant.armature.preload_fill_n *= 1.2;
        assert!(!compare_with_model(&plant, &Measurements::bundled()).holds);
    }
}
