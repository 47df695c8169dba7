//! Requirements on the loop, defined in one place, with their source.

use controller::{Distributor, Settings};
use ecu::VentValve;

/// Requirements on the loop. Pressures that the thesis gives in p_sup keep this unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Requirement {
    /// T_req (samples): the time within which a reference is reached (section 1.4).
    pub t_req_samples: u32,
    /// P_tol (bar): the distance at which a reference counts as reached (section 1.4; the value is that of figure 6.8).
    pub p_tol_bar: f64,
    /// p_sup (bar gauge), the unit of the following shares (working value, see data/thesis/measurements.toml).
    pub supply_pressure_bar: f64,
    /// Lowest and highest reference of the retarder (p_sup), section 6.4.2.
    pub operating_range_psup: [f64; 2],
    /// End of the filling from ambient pressure (p_sup), section 1.4.
    pub fill_to_psup: f64,
    /// Upper limit of the time of this filling, exclusive (T_req).
    pub fill_max_t_req: f64,
    /// Reading of the time of this filling that binds.
    pub fill_reading: Reading,
    /// Begin of the venting (p_sup), section 1.4.
    pub vent_from_psup: f64,
    /// End of the venting (p_sup).
    pub vent_to_psup: f64,
    /// Upper limit of the time of this venting, exclusive (T_req).
    pub vent_max_t_req: f64,
    /// Reading of the time of this venting that binds.
    pub vent_reading: Reading,
    /// Largest pressure beyond a new reference (bar). Assumed: the thesis sets no limit, but beyond P_tol a correction
    /// is needed.
    pub overshoot_bar: f64,
    /// Whether a larger overshoot fails the loop.
    pub is_overshoot_binding: bool,
    /// Rule for both valves energised in one sample.
    pub both_valves: BothValves,
    /// Lowest and highest duty cycle of the fill valve, apart from 0 (%). The lowest of all conditions is that of the
    /// thesis' Scheme 1 (section 6.4.1), the highest fully opens (table 4.1).
    pub duty_fill_pct: [f64; 2],
    /// Lowest and highest duty cycle of the vent valve, apart from 0 (%), tables 4.1 and 4.2.
    pub duty_vent_pct: [f64; 2],
    /// Smallest and largest factor by which the loop may multiply these duty cycles: 1 without compensation of supply
    /// voltage and coil resistance.
    pub duty_factors: [f64; 2],
    /// Whether model-based pulses drive the valves: a pulse has no limits of the duty cycle.
    pub is_pulsed: bool,
    /// Position of the vent valve without current. The duty cycle that opens a normally open one is 100 % less that of its
    /// coil, and tables 4.1 and 4.2 have no limits for it.
    pub vent_valve: VentValve,
    /// Whether the fill and the vent valve have a coil: the duty cycles of another valve have no such limits.
    pub has_coil: [bool; 2],
    /// Largest number of valve actuations within any one second at rest, both valves together. Assumed, because the
    /// thesis gives no number: it asks for "a minimum use of the valves" (section 6.3.1). One correction may take a few
    /// pulses; more is a limit cycle.
    pub rest_actuations_per_s: u32,
    /// Whether more actuations at rest fail the loop.
    pub is_rest_binding: bool,
    /// Largest mean number of lifts of both valves (1/s), binding; `None`: not judged.
    pub lifts_per_s: Option<f64>,
}

/// Reading of the time of a timed passage, such as the filling from ambient pressure to 0.26 p_sup.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Reading {
    /// Whether it begins with the step of the reference; otherwise with the first motion of the pressure, as in table
    /// 4.3.
    pub with_dead_time: bool,
    /// Whether it ends at the level itself; otherwise P_tol before the reference, if that comes before the level.
    pub to_level: bool,
}

impl Reading {
    /// All readings: the two to within P_tol first.
    pub const ALL: [Self; 4] = [
        Self::new(false, false),
        Self::new(true, false),
        Self::new(false, true),
        Self::new(true, true),
    ];

    const fn new(with_dead_time: bool, to_level: bool) -> Self {
        Self {
            with_dead_time,
            to_level,
        }
    }
}

/// Rule for both valves energised in one sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BothValves {
    /// Never, unless Scheme 2 distributes the duty cycle: it energises both on purpose (section 6.3.2).
    AsTheScheme,
    /// Never, as in Scheme 1 (section 6.3.1).
    Never,
    /// Allowed.
    Allowed,
}

impl BothValves {
    /// All rules.
    pub const ALL: [Self; 3] = [Self::AsTheScheme, Self::Never, Self::Allowed];
}

impl Requirement {
    /// Requirements of the thesis.
    pub const THESIS: Self = Self {
        t_req_samples: 50,
        p_tol_bar: 0.1,
        supply_pressure_bar: 8.4,
        operating_range_psup: [0.18, 0.71],
        fill_to_psup: 0.26,
        fill_max_t_req: 0.10,
        fill_reading: Reading::new(false, false),
        vent_from_psup: 0.88,
        vent_to_psup: 0.71,
        vent_max_t_req: 0.05,
        vent_reading: Reading::new(false, false),
        overshoot_bar: 0.1,
        is_overshoot_binding: false,
        both_valves: BothValves::AsTheScheme,
        duty_fill_pct: [25.5, 82.0],
        duty_vent_pct: [25.5, 80.0],
        duty_factors: [1.0, 1.0],
        is_pulsed: false,
        vent_valve: VentValve::NormallyClosed,
        has_coil: [true; 2],
        rest_actuations_per_s: 3,
        is_rest_binding: false,
        lifts_per_s: None,
    };

    /// Returns the requirement on a loop with this controller: pulses or a distributor of the control signal.
    #[must_use]
    pub fn with_controller(&self, controller: &Settings) -> Self {
        let is_pulsed = controller.pulses.is_some();
        let is_scheme_2 =
            matches!(controller.distributor, Distributor::Scheme2 { .. }) && !is_pulsed;
        Self {
            is_pulsed,
            both_valves: match self.both_valves {
                BothValves::AsTheScheme if is_scheme_2 => BothValves::Allowed,
                other => other,
            },
            ..*self
        }
    }

    /// Returns the requirement on a loop with this kind of vent valve, and with or without coils.
    #[must_use]
    pub const fn with_valves(&self, vent_valve: VentValve, has_coil: [bool; 2]) -> Self {
        Self {
            vent_valve,
            has_coil,
            ..*self
        }
    }

    /// Returns the requirement on a loop that may multiply its duty limits by these factors.
    #[must_use]
    pub const fn with_duty_factors(&self, duty_factors: [f64; 2]) -> Self {
        Self {
            duty_factors,
            ..*self
        }
    }

    /// Returns the place in the thesis that a text cites, in round brackets; nothing for other requirements.
    pub(crate) fn cite(&self, place: &str) -> String {
        let of_thesis = Self {
            both_valves: self.both_valves,
            duty_factors: self.duty_factors,
            is_pulsed: self.is_pulsed,
            vent_valve: self.vent_valve,
            has_coil: self.has_coil,
            ..Self::THESIS
        };
        match *self == of_thesis {
            true => format!(" ({place})"),
            false => String::new(),
        }
    }

    /// Returns a share of the supply pressure (bar gauge).
    pub fn psup(&self, share: f64) -> f64 {
        share * self.supply_pressure_bar
    }

    /// Returns whether the retarder uses this reference (bar gauge); the ends belong to the range.
    pub fn is_operating_reference(&self, reference_bar: f64) -> bool {
        let [low, high] = self.operating_range_psup.map(|share| self.psup(share));
        // A reference is a multiple of 2⁻¹⁶ bar on the wire: the ends are compared within one of these.
        (low - RESOLUTION_BAR..=high + RESOLUTION_BAR).contains(&reference_bar)
    }
}

/// Resolution of pressures on the wire (bar).
const RESOLUTION_BAR: f64 = 1.0 / 65536.0;

impl Default for Requirement {
    fn default() -> Self {
        Self::THESIS
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Compares the figures with their source, so that this crate cannot deviate from it.
    #[test]
    fn the_requirement_is_the_one_in_the_thesis_data() {
        let path = concat!(
            env!("CARGO_MANIFEST_DIR"),
            "/../data/thesis/measurements.toml"
        );
        let text = std::fs::read_to_string(path).unwrap();
        let document: toml_edit::DocumentMut = text.parse().unwrap();
        let number = |table: &str, key: &str| {
            let item = &document[table][key];
            item.as_float()
                .or(item.as_integer().map(|n| n as f64))
                .unwrap()
        };
        let requirement = Requirement::THESIS;
        assert_eq!(
            f64::from(requirement.t_req_samples),
            number("requirement", "t_req_samples")
        );
        assert_eq!(requirement.p_tol_bar, number("requirement", "p_tol_bar"));
        assert_eq!(
            requirement.fill_max_t_req,
            number("requirement", "fill_0_to_026_psup_max_t_req")
        );
        assert_eq!(
            requirement.vent_max_t_req,
            number("requirement", "vent_088_to_071_psup_max_t_req")
        );
        let range = document["requirement"]["operating_range_psup"]
            .as_array()
            .unwrap();
        let range: Vec<f64> = range
            .iter()
            .filter_map(toml_edit::Value::as_float)
            .collect();
        assert_eq!(requirement.operating_range_psup.to_vec(), range);
        assert_eq!(
            requirement.duty_vent_pct[0],
            number("duty_limits_percent", "vent_open_with_supply_pressure")
        );
        assert_eq!(
            requirement.duty_fill_pct[1],
            number("duty_limits_percent", "fill_hold")
        );
        assert_eq!(
            requirement.duty_vent_pct[1],
            number("duty_limits_percent", "vent_hold")
        );
    }

    #[test]
    fn the_operating_range_includes_its_ends_and_nothing_beyond() {
        let requirement = Requirement::THESIS;
        for (reference_bar, expected) in [
            (1.50, false),
            (1.512, true),
            (3.0, true),
            (5.964, true),
            (5.97, false),
        ] {
            assert_eq!(
                requirement.is_operating_reference(reference_bar),
                expected,
                "{reference_bar} bar"
            );
        }
    }
}
