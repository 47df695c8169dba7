//! Columns of the table: the only list of them.

use super::row::RigRow;

/// Column of the table.
#[derive(Debug)]
pub struct Column {
    /// Name, which ends in the unit.
    pub name: &'static str,
    /// Unit; empty for a number without one.
    pub unit: &'static str,
    /// Meaning.
    pub about: &'static str,
    pub(super) field: Field,
}

/// Place of the value in a row, for reading and writing.
#[derive(Clone, Copy, Debug)]
pub(super) enum Field {
    /// Number of the rig, or number of steps.
    Count(fn(&mut RigRow) -> &mut u32),
    /// Seed.
    Seed(fn(&mut RigRow) -> &mut u64),
    /// Whether something is true.
    Flag(fn(&mut RigRow) -> &mut bool),
    /// Names, separated by commas.
    Names(fn(&mut RigRow) -> &mut String),
    /// Condition of the run.
    Condition(fn(&mut RigRow) -> &mut Option<f64>),
    /// Figure of the loop; a larger one is worse.
    Figure(fn(&mut RigRow) -> &mut Option<f64>),
}

const fn column(
    name: &'static str,
    unit: &'static str,
    about: &'static str,
    field: Field,
) -> Column {
    Column {
        name,
        unit,
        about,
        field,
    }
}

/// All columns, in the order of the file.
pub const COLUMNS: [Column; 21] = [
    column(
        "rig",
        "",
        "number of the rig, from 0",
        Field::Count(|row| &mut row.rig),
    ),
    column(
        "seed",
        "",
        "seed of the rig",
        Field::Seed(|row| &mut row.seed),
    ),
    column(
        "supply_voltage_v",
        "V",
        "supply voltage; at time 0, if it changes",
        Field::Condition(|row| &mut row.supply_voltage_v),
    ),
    column(
        "coil_temperature_c",
        "°C",
        "temperature of the coils; at the start, if it changes",
        Field::Condition(|row| &mut row.coil_temperature_c),
    ),
    column(
        "holds",
        "",
        "whether every binding requirement is met",
        Field::Flag(|row| &mut row.holds),
    ),
    column(
        "failed_checks",
        "",
        "names of the binding requirements that fail, separated by commas",
        Field::Names(|row| &mut row.failed_checks),
    ),
    column(
        "confirmed_faults",
        "",
        "names of the faults that the ECU confirmed, separated by commas",
        Field::Names(|row| &mut row.confirmed_faults),
    ),
    column(
        "steps",
        "",
        "number of steps to references of the operating range",
        Field::Count(|row| &mut row.steps),
    ),
    column(
        "late_steps",
        "",
        "number of these steps that settle after T_req or never",
        Field::Count(|row| &mut row.late_steps),
    ),
    column(
        "never_settled_steps",
        "",
        "number of these steps that never settle while their reference is constant",
        Field::Count(|row| &mut row.never_settled_steps),
    ),
    column(
        "settling_mean_samples",
        "samples",
        "mean settling time of these steps that settle",
        Field::Figure(|row| &mut row.settling_mean_samples),
    ),
    column(
        "settling_p90_samples",
        "samples",
        "time within which 90 % of these steps settle; none if more than 10 % never do",
        Field::Figure(|row| &mut row.settling_p90_samples),
    ),
    column(
        "settling_worst_samples",
        "samples",
        "settling time of the slowest of these steps; none if one never settles",
        Field::Figure(|row| &mut row.settling_worst_samples),
    ),
    column(
        "steady_error_bar",
        "bar",
        "largest steady-state error from T_req on",
        Field::Figure(|row| &mut row.steady_error_bar),
    ),
    column(
        "overshoot_bar",
        "bar",
        "largest pressure beyond a new reference",
        Field::Figure(|row| &mut row.overshoot_bar),
    ),
    column(
        "fill_time_samples",
        "samples",
        "longest time of the filling, in the reading that binds",
        Field::Figure(|row| &mut row.fill_time_samples),
    ),
    column(
        "vent_time_samples",
        "samples",
        "longest time of the venting, in the reading that binds",
        Field::Figure(|row| &mut row.vent_time_samples),
    ),
    column(
        "both_valves_samples",
        "samples",
        "number of samples in which both valves are energised",
        Field::Figure(|row| &mut row.both_valves_samples),
    ),
    column(
        "duty_limits_samples",
        "samples",
        "number of samples in which a duty cycle is outside of its limits",
        Field::Figure(|row| &mut row.duty_limits_samples),
    ),
    column(
        "rest_actuations",
        "",
        "largest number of valve actuations within a second at rest",
        Field::Figure(|row| &mut row.rest_actuations),
    ),
    column(
        "lifts_per_s",
        "1/s",
        "mean number of lifts of both valves",
        Field::Figure(|row| &mut row.lifts_per_s),
    ),
];
