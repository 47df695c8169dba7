//! Keys of a requirements file, defined once for reader, errors and tests.

use crate::requirement::{BothValves, Requirement};

/// Key of a requirements file.
#[derive(Debug)]
pub struct Key {
    /// Table.
    pub table: &'static str,
    /// Name within the table, which ends in the unit.
    pub name: &'static str,
    /// Meaning.
    pub about: &'static str,
    pub(super) kind: Kind,
    /// Stores a value: a number, or the index of a word.
    pub(super) set: fn(&mut Requirement, f64),
}

/// Values of a key.
#[derive(Debug)]
pub(super) enum Kind {
    /// Number, from the first to the second bound.
    Number(f64, f64),
    /// Whole number, from the first to the second bound.
    Whole(u32, u32),
    /// One of these words.
    Word(&'static [&'static str]),
    /// `true` or `false`.
    Flag,
}

impl Key {
    /// Returns `table.name`.
    pub fn path(&self) -> String {
        format!("{}.{}", self.table, self.name)
    }
}

/// Words for the rule of both valves, in the order of [`BothValves::ALL`].
const BOTH_VALVES: &[&str] = &["as_the_scheme", "never", "allowed"];
/// Words for the begin of a timed passage.
const COUNTED_FROM: &[&str] = &["first_motion", "step"];
/// Words for the end of a timed passage.
const ENDS: &[&str] = &["within_tolerance", "at_level"];

const fn key(
    table: &'static str,
    name: &'static str,
    kind: Kind,
    about: &'static str,
    set: fn(&mut Requirement, f64),
) -> Key {
    Key {
        table,
        name,
        about,
        kind,
        set,
    }
}

/// All keys, in the order of the file.
pub const KEYS: &[Key] = &[
    key(
        "settling",
        "t_req_samples",
        Kind::Whole(1, 100_000),
        "T_req: time within which a reference is reached",
        |to, value| to.t_req_samples = value as u32,
    ),
    key(
        "settling",
        "p_tol_bar",
        Kind::Number(0.001, 5.0),
        "P_tol: distance at which a reference counts as reached",
        |to, value| to.p_tol_bar = value,
    ),
    key(
        "settling",
        "supply_pressure_bar",
        Kind::Number(0.5, 15.0),
        "p_sup, gauge: unit of the levels below",
        |to, value| to.supply_pressure_bar = value,
    ),
    key(
        "settling",
        "lowest_psup",
        Kind::Number(0.0, 1.0),
        "lowest reference of the operating range",
        |to, value| to.operating_range_psup[0] = value,
    ),
    key(
        "settling",
        "highest_psup",
        Kind::Number(0.0, 1.0),
        "highest reference of the operating range",
        |to, value| to.operating_range_psup[1] = value,
    ),
    key(
        "overshoot",
        "max_bar",
        Kind::Number(0.0, 15.0),
        "largest pressure beyond a new reference",
        |to, value| to.overshoot_bar = value,
    ),
    key(
        "overshoot",
        "binding",
        Kind::Flag,
        "whether a larger overshoot fails the loop",
        |to, value| to.is_overshoot_binding = value != 0.0,
    ),
    key(
        "fill",
        "to_psup",
        Kind::Number(0.01, 1.0),
        "end of the filling from ambient pressure",
        |to, value| to.fill_to_psup = value,
    ),
    key(
        "fill",
        "max_t_req",
        Kind::Number(0.0001, 100.0),
        "upper limit of its time, exclusive, in T_req",
        |to, value| to.fill_max_t_req = value,
    ),
    key(
        "fill",
        "counted_from",
        Kind::Word(COUNTED_FROM),
        "begin: the first motion of the pressure (without dead time), or the step of the reference",
        |to, value| to.fill_reading.with_dead_time = value != 0.0,
    ),
    key(
        "fill",
        "ends",
        Kind::Word(ENDS),
        "end: P_tol before the reference if that comes before the level, or the level itself",
        |to, value| to.fill_reading.to_level = value != 0.0,
    ),
    key(
        "vent",
        "from_psup",
        Kind::Number(0.0, 1.0),
        "begin of the venting",
        |to, value| to.vent_from_psup = value,
    ),
    key(
        "vent",
        "to_psup",
        Kind::Number(0.0, 1.0),
        "end of the venting",
        |to, value| to.vent_to_psup = value,
    ),
    key(
        "vent",
        "max_t_req",
        Kind::Number(0.0001, 100.0),
        "upper limit of its time, exclusive, in T_req",
        |to, value| to.vent_max_t_req = value,
    ),
    key(
        "vent",
        "counted_from",
        Kind::Word(COUNTED_FROM),
        "begin: as for the filling",
        |to, value| to.vent_reading.with_dead_time = value != 0.0,
    ),
    key(
        "vent",
        "ends",
        Kind::Word(ENDS),
        "end: as for the filling",
        |to, value| to.vent_reading.to_level = value != 0.0,
    ),
    key(
        "valves",
        "both_energised",
        Kind::Word(BOTH_VALVES),
        "both valves energised in one sample: never, allowed, or never unless Scheme 2 distributes the duty cycle",
        |to, value| {
            to.both_valves = *BothValves::ALL
                .get(value as usize)
                .unwrap_or(&BothValves::Never);
        },
    ),
    key(
        "valves",
        "duty_min_fill_pct",
        Kind::Number(0.0, 100.0),
        "lowest duty cycle of the fill valve, apart from 0",
        |to, value| to.duty_fill_pct[0] = value,
    ),
    key(
        "valves",
        "duty_max_fill_pct",
        Kind::Number(0.0, 100.0),
        "highest duty cycle of the fill valve",
        |to, value| to.duty_fill_pct[1] = value,
    ),
    key(
        "valves",
        "duty_min_vent_pct",
        Kind::Number(0.0, 100.0),
        "lowest duty cycle of the vent valve, apart from 0",
        |to, value| to.duty_vent_pct[0] = value,
    ),
    key(
        "valves",
        "duty_max_vent_pct",
        Kind::Number(0.0, 100.0),
        "highest duty cycle of the vent valve",
        |to, value| to.duty_vent_pct[1] = value,
    ),
    key(
        "lifts",
        "at_rest_per_s",
        Kind::Whole(0, 10_000),
        "largest number of lifts of both valves within any second from T_req on",
        |to, value| to.rest_actuations_per_s = value as u32,
    ),
    key(
        "lifts",
        "at_rest_binding",
        Kind::Flag,
        "whether more lifts at rest fail the loop",
        |to, value| to.is_rest_binding = value != 0.0,
    ),
    key(
        "lifts",
        "mean_per_s",
        Kind::Number(0.0, 10_000.0),
        "largest mean number of lifts of both valves; binding where it is given",
        |to, value| to.lifts_per_s = Some(value),
    ),
];

/// Returns the names of the tables, in the order of the file.
pub(super) fn tables() -> Vec<&'static str> {
    let mut tables: Vec<&str> = KEYS.iter().map(|key| key.table).collect();
    tables.dedup();
    tables
}
